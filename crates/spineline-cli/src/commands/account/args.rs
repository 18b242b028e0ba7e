//! The command line of `account`.

use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand};
use spineline_store::{Name, Role};

use crate::options::values::store_name;

/// Shown below the options.
pub const EXAMPLES: &str = "\
Examples:
  spineline account add lead --role admin clinic.spineline
  spineline account add reader-2 --role reader --password-stdin clinic.spineline < password.txt
  spineline account edit reader-2 --role editor clinic.spineline
  spineline account edit reader-2 --disable clinic.spineline
  spineline account grant reader-2 P07 --role editor clinic.spineline
  spineline account revoke reader-2 P07 clinic.spineline
  spineline account list clinic.spineline

Passwords are entered in the terminal or read from the standard input, never given as arguments, which other users of the \
machine could see. Admins may do everything in every study. Editors and readers see the studies granted to them.";

#[derive(Args)]
pub struct AccountArgs {
    #[command(subcommand)]
    pub command: AccountCommand,
    /// Your name for the log, in commands that change the store [default: cli]
    #[arg(long, global = true, value_name = "NAME", value_parser = store_name)]
    pub by: Option<Name>,
}

#[derive(Subcommand)]
pub enum AccountCommand {
    /// Add an account
    Add {
        /// Name of the account and of the observer
        #[arg(value_parser = store_name)]
        name: Name,
        /// File of the store
        #[arg(default_value = "studies.spineline")]
        store: PathBuf,
        /// Highest role of the account
        #[arg(long, value_name = "ROLE", value_parser = role(&Role::ALL))]
        role: Role,
        /// Read the password from the standard input, which holds one line
        #[arg(long)]
        password_stdin: bool,
    },
    /// Edit an account; a new password and --disable end all its sessions
    Edit {
        /// Name of the account
        #[arg(value_parser = store_name)]
        name: Name,
        /// File of the store
        #[arg(default_value = "studies.spineline")]
        store: PathBuf,
        /// Highest role of the account
        #[arg(long, value_name = "ROLE", value_parser = role(&Role::ALL))]
        role: Option<Role>,
        /// Ask for a new password
        #[arg(long)]
        password: bool,
        /// Read a new password from the standard input, which holds one line
        #[arg(long, conflicts_with = "password")]
        password_stdin: bool,
        /// Allow sign-in again
        #[arg(long)]
        enable: bool,
        /// Prevent sign-in
        #[arg(long, conflicts_with = "enable")]
        disable: bool,
    },
    /// List accounts and their studies
    List {
        /// File of the store
        #[arg(default_value = "studies.spineline")]
        store: PathBuf,
    },
    /// Grant an account a role in a study
    Grant {
        /// Name of the account
        #[arg(value_parser = store_name)]
        name: Name,
        /// Identifier of the study
        #[arg(value_parser = store_name)]
        study: Name,
        /// File of the store
        #[arg(default_value = "studies.spineline")]
        store: PathBuf,
        /// Role in the study
        #[arg(long, value_name = "ROLE", value_parser = role(&[Role::Reader, Role::Editor]))]
        role: Role,
    },
    /// Revoke an account's role in a study
    Revoke {
        /// Name of the account
        #[arg(value_parser = store_name)]
        name: Name,
        /// Identifier of the study
        #[arg(value_parser = store_name)]
        study: Name,
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
    PossibleValuesParser::new(allowed.iter().map(|role| role.key()))
        .try_map(|word| word.parse::<Role>())
}
