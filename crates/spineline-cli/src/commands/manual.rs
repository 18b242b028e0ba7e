//! `spineline manual`: pages for `man`.

use clap::{Args, Command};
use clap_mangen::Man;

use crate::run::failure::{Ending, Failure};
use crate::run::outputs::print_data;

pub const EXAMPLES: &str = "\
Examples:
  spineline manual analyze | man -l -                # read the page of `analyze`
  spineline manual study add > spineline-study-add.1 # install it where `man` looks: share/man/man1";

#[derive(Args)]
pub struct ManualArgs {
    /// Command whose page is printed, such as `analyze` or `study add`; without it, the page of the program
    command: Vec<String>,
}

pub fn run(args: &ManualArgs, program: Command) -> Result<Ending, Failure> {
    let mut command = program;
    // Commands know the names and the options of their parents only then.
    command.build();
    for word in &args.command {
        let found = command.find_subcommand(word).cloned();
        command = found.ok_or_else(|| unknown(&args.command, &command))?;
    }
    let mut page = Vec::new();
    Man::new(command).render(&mut page).map_err(|error| {
        Failure::internal(format!("the manual page could not be written: {error}"))
    })?;
    print_data(&String::from_utf8_lossy(&page))
}

fn unknown(words: &[String], parent: &Command) -> Failure {
    let names: Vec<&str> = parent
        .get_subcommands()
        .filter(|command| !command.is_hide_set())
        .map(Command::get_name)
        .collect();
    let known = if names.is_empty() {
        format!("`{}` has no commands", parent.get_name())
    } else {
        format!("give one of {}", names.join(", "))
    };
    Failure::usage(format!("unknown command `{}`; {known}", words.join(" ")))
}
