//! Cases for a comparison with other engines, and Spineline's own times on them.
//!
//! `spineline-peers cases FILE` writes the cases; `spineline-peers time FILE NAME` prints the times of one as JSON, in the
//! form that every engine of the comparison prints. `benchmarks/peers/run.py` calls both.

mod case;
mod make;
mod time;

use std::error::Error;
use std::fs;
use std::process::ExitCode;

use case::Cases;

const HELP: &str = "\
spineline-peers cases FILE        writes the cases
spineline-peers time FILE NAME    prints the times of one case as JSON
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match arguments[..] {
        ["cases", file] => write_cases(file),
        ["time", file, name] => print_times(file, name),
        _ => {
            eprint!("{HELP}");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("spineline-peers: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn write_cases(file: &str) -> Result<(), Box<dyn Error>> {
    let cases = make::cases()?;
    fs::write(file, serde_json::to_string_pretty(&cases)? + "\n")?;
    Ok(())
}

fn print_times(file: &str, name: &str) -> Result<(), Box<dyn Error>> {
    let cases: Cases = serde_json::from_str(&fs::read_to_string(file)?)?;
    let case = cases.cases.iter().find(|case| case.name == name);
    let case = case.ok_or_else(|| format!("{file} has no case {name}"))?;
    println!("{}", serde_json::to_string(&time::times(case))?);
    Ok(())
}
