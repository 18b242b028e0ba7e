//! The words of `spineline account`.

use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand};
use spineline_server::store::Role;

/// What a user types.
pub const EXAMPLES: &str = "\
Examples:
  spineline account add lead --role admin clinic.spineline
  spineline account add reader-2 --role reader --password-stdin clinic.spineline < password.txt
  spineline account edit reader-2 --role editor clinic.spineline
  spineline account edit reader-2 --disable clinic.spineline
  spineline account grant reader-2 P07 --role editor clinic.spineline
  spineline account revoke reader-2 P07 clinic.spineline
  spineline account list clinic.spineline

A password is asked for in the terminal, or read from the standard input; it is never an argument, which others on the
machine could see. An admin leads every study. Editors and readers see the studies that they are granted.";

#[derive(Args)]
pub struct AccountArgs {
    #[command(subcommand)]
    pub command: AccountCommand,
    /// Who does this, for the log
    #[arg(long, global = true, value_name = "NAME", default_value = "cli")]
    pub by: String,
}

#[derive(Subcommand)]
pub enum AccountCommand {
    /// Make an account
    Add {
        /// Its name, which is also the observer's
        name: String,
        /// File of the store
        #[arg(default_value = "studies.spineline")]
        store: PathBuf,
        /// What it may do at most
        #[arg(long, value_name = "ROLE", value_parser = role(&Role::ALL))]
        role: Role,
        /// Read the password from the standard input, up to the end of its first line
        #[arg(long)]
        password_stdin: bool,
    },
    /// Change an account; a new password and --disable sign it out everywhere
    Edit {
        /// Its name
        name: String,
        /// File of the store
        #[arg(default_value = "studies.spineline")]
        store: PathBuf,
        /// What it may do at most
        #[arg(long, value_name = "ROLE", value_parser = role(&Role::ALL))]
        role: Option<Role>,
        /// Ask for a new password
        #[arg(long)]
        password: bool,
        /// Read a new password from the standard input, up to the end of its first line
        #[arg(long, conflicts_with = "password")]
        password_stdin: bool,
        /// Let it sign in again
        #[arg(long)]
        enable: bool,
        /// Keep it from signing in
        #[arg(long, conflicts_with = "enable")]
        disable: bool,
    },
    /// Tell which accounts there are, and what they are granted
    List {
        /// File of the store
        #[arg(default_value = "studies.spineline")]
        store: PathBuf,
    },
    /// Let an account into a study
    Grant {
        /// Name of the account
        name: String,
        /// Identifier of the study
        study: String,
        /// File of the store
        #[arg(default_value = "studies.spineline")]
        store: PathBuf,
        /// What it may do there
        #[arg(long, value_name = "ROLE", value_parser = role(&[Role::Reader, Role::Editor]))]
        role: Role,
    },
    /// Take a grant back
    Revoke {
        /// Name of the account
        name: String,
        /// Identifier of the study
        study: String,
        /// File of the store
        #[arg(default_value = "studies.spineline")]
        store: PathBuf,
    },
}

impl AccountCommand {
    pub fn store(&self) -> &Path {
        match self {
            Self::Add { store, .. }
            | Self::Edit { store, .. }
            | Self::List { store }
            | Self::Grant { store, .. }
            | Self::Revoke { store, .. } => store,
        }
    }
}

fn role(allowed: &[Role]) -> impl TypedValueParser<Value = Role> {
    PossibleValuesParser::new(allowed.iter().map(|role| role.key())).map(|word| {
        Role::ALL.into_iter().find(|role| role.key() == word).expect("one of the possible values")
    })
}
