//! Steps in their order: which tools they need, what is left out, and how long each took.

use std::io::{IsTerminal, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use crate::tools::{self, Tool};

/// How much is run.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// All but slow studies, typeset reports and what changes the machine for a moment.
    Usual,
    /// Everything; a missing tool is an error.
    Full,
}

/// One thing that must hold; the error says what does not.
pub type Check = fn(&Plan<'_>) -> Result<(), String>;

/// A named check and the tools that it needs.
pub struct Step {
    name: &'static str,
    tools: &'static [Tool],
    extent: Extent,
    check: Check,
}

impl Step {
    pub fn new(name: &'static str, tools: &'static [Tool], check: Check) -> Self {
        Self { name, tools, extent: Extent::Usual, check }
    }

    /// The same step, run by `--full` alone.
    pub fn full(self) -> Self {
        Self { extent: Extent::Full, ..self }
    }

    /// The same step, run always.
    pub fn usual(self) -> Self {
        Self { extent: Extent::Usual, ..self }
    }
}

/// What is run where.
pub struct Plan<'a> {
    pub root: &'a Path,
    pub extent: Extent,
}

/// How a step ended.
struct Ended {
    name: &'static str,
    time: Duration,
    /// Why it was left out, if it was.
    left_out: Option<String>,
}

impl<'a> Plan<'a> {
    pub fn new(root: &'a Path, extent: Extent) -> Self {
        Self { root, extent }
    }

    pub fn is_full(&self) -> bool {
        self.extent == Extent::Full
    }

    /// Runs the steps in their order, until one fails; says what each took.
    ///
    /// Missing tools are listed first. On a terminal they are offered for installation. Steps without their tools are
    /// left out and named, except where everything was asked for: then nothing begins.
    pub fn run(&self, steps: &[Step]) -> Result<(), String> {
        let steps: Vec<&Step> =
            steps.iter().filter(|step| self.is_full() || step.extent == Extent::Usual).collect();
        self.provide_tools(&steps)?;
        let mut ended = Vec::new();
        let mut result = Ok(());
        for step in steps {
            let missing: Vec<&str> =
                step.tools.iter().filter(|tool| !tool.is_there()).map(|tool| tool.name()).collect();
            let start = Instant::now();
            if missing.is_empty() {
                println!("\n━━ {}", step.name);
                result = (step.check)(self).map_err(|reason| format!("{}: {reason}", step.name));
            }
            let left_out = (!missing.is_empty()).then(|| missing.join(", "));
            ended.push(Ended { name: step.name, time: start.elapsed(), left_out });
            if result.is_err() {
                break;
            }
        }
        print_times(&ended);
        result
    }

    fn provide_tools(&self, steps: &[&Step]) -> Result<(), String> {
        let mut missing: Vec<Tool> = steps
            .iter()
            .flat_map(|step| step.tools)
            .copied()
            .filter(|tool| !tool.is_there())
            .collect();
        missing.sort_unstable();
        missing.dedup();
        if missing.is_empty() {
            return Ok(());
        }
        println!("missing tools:");
        for tool in &missing {
            println!("  {}: {} ({})", tool.name(), tool.purpose(), tool.install());
        }
        println!("  `cargo xtask setup` installs them all");
        if asked_to_install() {
            return tools::install(self.root, &missing);
        }
        if self.is_full() {
            return Err("everything was asked for, and tools are missing".to_owned());
        }
        Ok(())
    }
}

/// Whether somebody at a terminal wants the tools installed now.
fn asked_to_install() -> bool {
    if !std::io::stdin().is_terminal() {
        return false;
    }
    print!("Install them now? [y/N] ");
    let mut answer = String::new();
    let read = std::io::stdout().flush().and_then(|()| std::io::stdin().read_line(&mut answer));
    read.is_ok() && answer.trim().eq_ignore_ascii_case("y")
}

fn print_times(ended: &[Ended]) {
    println!("\n━━ times");
    for step in ended {
        match &step.left_out {
            None => println!("{:>7.1} s  {}", step.time.as_secs_f64(), step.name),
            Some(missing) => println!("NOT RUN    {}: {missing} is missing", step.name),
        }
    }
    let total: Duration = ended.iter().map(|step| step.time).sum();
    println!("{:>7.1} s  all", total.as_secs_f64());
}
