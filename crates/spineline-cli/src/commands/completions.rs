//! `spineline completions`: a completion script for a shell.

use clap::{Args, Command};
use clap_complete::{Shell, generate};

use crate::run::failure::{Ending, Failure};
use crate::run::outputs::print_data;

#[derive(Args)]
pub struct CompletionsArgs {
    /// Your shell
    shell: Shell,
}

pub fn run(args: &CompletionsArgs, command: &mut Command) -> Result<Ending, Failure> {
    let mut script = Vec::new();
    generate(args.shell, command, "spineline", &mut script);
    print_data(&String::from_utf8_lossy(&script))
}
