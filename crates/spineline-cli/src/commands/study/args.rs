//! The command line of `study`.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use spineline_store::{Head, Name};

use crate::options::values::store_name;
use crate::run::outputs::OverwriteArgs;

/// Shown below the options.
pub const EXAMPLES: &str = "\
Examples:
  spineline study create clinic.spineline
  spineline study add clinic.spineline p07/case.json
  spineline study plan clinic.spineline P07 --observers A,B --repeats 3 --washout-days 14
  spineline study next clinic.spineline P07 --observer A
  spineline study release clinic.spineline P07 --by lead
  spineline study list clinic.spineline P07
  spineline study withdraw clinic.spineline 12 --reason \"T6 lies on T7\" --by lead
  spineline study correct clinic.spineline 12 --by A
  spineline study rename clinic.spineline P07 \"before brace\"
  spineline study archive clinic.spineline P07
  spineline study export clinic.spineline P07 --out p07-read.json
  spineline study verify clinic.spineline
  spineline study backup clinic.spineline clinic-2026-11-21.spineline
  spineline study restore clinic-2026-11-21.spineline clinic.spineline";

#[derive(Args)]
pub struct StudyArgs {
    #[command(subcommand)]
    pub command: StudyCommand,
    /// Your code for the log, in commands that change the store; not a patient's name [default: cli]
    #[arg(long, global = true, value_name = "NAME", value_parser = store_name)]
    pub by: Option<Name>,
}

#[derive(Subcommand)]
pub enum StudyCommand {
    /// Create an empty store
    Create {
        /// File of the store
        store: PathBuf,
    },
    /// Add cases with their films and readings to a store
    Add {
        /// File of the store
        store: PathBuf,
        /// Case files, as `import` writes them
        #[arg(required = true, value_name = "CASE")]
        cases: Vec<PathBuf>,
        /// Add films although their files state another part of the body, or two patients
        #[arg(long)]
        accept: bool,
    },
    /// List the films of a store, or the readings of one study with their numbers
    List {
        /// File of the store
        store: PathBuf,
        /// Identifier of the study whose readings are listed
        #[arg(value_name = "CASE_ID", value_parser = store_name)]
        study: Option<Name>,
    },
    /// Plan blinded readings: every observer reads every film repeatedly, in random order, with a washout period
    ///
    /// A plan whose first reading has not begun is replaced.
    Plan {
        /// File of the store
        store: PathBuf,
        /// Identifier of the study, which is the case's
        #[arg(value_name = "CASE_ID", value_parser = store_name)]
        study: Name,
        /// Codes of the observers
        #[arg(long, required = true, value_delimiter = ',', value_name = "NAME,NAME", value_parser = store_name)]
        observers: Vec<Name>,
        /// Readings of every film by every observer
        #[arg(long, default_value_t = 3)]
        repeats: u32,
        /// Washout period: days between two readings of one film by one observer
        #[arg(long, default_value_t = 14)]
        washout_days: u32,
        /// Show proposed vertebrae: observers who accept them share the program's model, and agree better than by clicks
        #[arg(long)]
        proposals: bool,
    },
    /// Print the code of the film that an observer reads next
    Next {
        /// File of the store
        store: PathBuf,
        /// Identifier of the study
        #[arg(value_name = "CASE_ID", value_parser = store_name)]
        study: Name,
        /// Code of the observer
        #[arg(long, value_name = "NAME", value_parser = store_name)]
        observer: Name,
    },
    /// End the washout of readings that a wrong clock dated into the future; the log says who did it
    Release {
        /// File of the store
        store: PathBuf,
        /// Identifier of the study
        #[arg(value_name = "CASE_ID", value_parser = store_name)]
        study: Name,
    },
    /// Withdraw a reading: the store keeps it, and results leave it out
    Withdraw {
        /// File of the store
        store: PathBuf,
        /// Number of the reading, as `list STORE CASE_ID` prints it
        reading: i64,
        /// Why; it stays with the reading
        #[arg(long, value_name = "TEXT")]
        reason: String,
    },
    /// Copy a finished reading for a correction; `--by` is its observer, who changes and finishes the copy in the browser
    ///
    /// When the copy is finished, it replaces the reading.
    Correct {
        /// File of the store
        store: PathBuf,
        /// Number of the reading, as `list STORE CASE_ID` prints it
        reading: i64,
    },
    /// Give a study another label; its identifier stays
    Rename {
        /// File of the store
        store: PathBuf,
        /// Identifier of the study
        #[arg(value_name = "CASE_ID", value_parser = store_name)]
        study: Name,
        /// The label, without the patient's name; "" removes it
        label: String,
    },
    /// Archive a study: it can be read, and not changed
    Archive {
        /// File of the store
        store: PathBuf,
        /// Identifier of the study
        #[arg(value_name = "CASE_ID", value_parser = store_name)]
        study: Name,
        /// Take an archived study back
        #[arg(long)]
        undo: bool,
    },
    /// Write a study with its finished readings as a case file
    Export {
        /// File of the store
        store: PathBuf,
        /// Identifier of the study
        #[arg(value_name = "CASE_ID", value_parser = store_name)]
        study: Name,
        /// File to write (`-`: standard output)
        #[arg(long, value_name = "FILE", default_value = "-")]
        out: PathBuf,
        #[command(flatten)]
        overwrite: OverwriteArgs,
    },
    /// Print the log of all changes
    Log {
        /// File of the store
        store: PathBuf,
    },
    /// Verify a store: find damage, and log entries that were edited, removed or replaced
    Verify {
        /// File of the store
        store: PathBuf,
        /// End of the log from an earlier `verify`, kept elsewhere
        #[arg(long, value_name = "N:HASH", value_parser = head)]
        head: Option<Head>,
    },
    /// Copy a store, even while it is in use, and verify the copy
    Backup {
        /// File of the store
        store: PathBuf,
        /// File to write; it must not exist yet
        #[arg(value_name = "FILE")]
        out: PathBuf,
    },
    /// Put a backup in the place of a store, and keep the earlier store under another name
    ///
    /// Stop the server first: a store that another program has open is not replaced. The backup is verified before. The earlier store,
    /// which may be damaged, stays as STORE.replaced-1 (or the next free number), with its log. A copy of the store's file with `cp`
    /// does less: the log of the earlier store stays beside it.
    Restore {
        /// File of the backup, as `backup` wrote it
        backup: PathBuf,
        /// File of the store
        store: PathBuf,
    },
}

impl StudyCommand {
    /// Whether it changes the store, and its log names an author.
    pub const fn has_author(&self) -> bool {
        !matches!(
            self,
            Self::List { .. }
                | Self::Next { .. }
                | Self::Export { .. }
                | Self::Log { .. }
                | Self::Verify { .. }
                | Self::Backup { .. }
                | Self::Restore { .. }
        )
    }

    pub fn store(&self) -> &Path {
        match self {
            Self::Create { store }
            | Self::Add { store, .. }
            | Self::List { store, .. }
            | Self::Plan { store, .. }
            | Self::Next { store, .. }
            | Self::Release { store, .. }
            | Self::Withdraw { store, .. }
            | Self::Correct { store, .. }
            | Self::Rename { store, .. }
            | Self::Archive { store, .. }
            | Self::Export { store, .. }
            | Self::Log { store }
            | Self::Verify { store, .. }
            | Self::Backup { store, .. }
            | Self::Restore { store, .. } => store,
        }
    }
}

fn head(text: &str) -> Result<Head, String> {
    let expected = || "expected N:HASH as `verify` prints it".to_owned();
    let (entries, hash) = text.split_once(':').ok_or_else(expected)?;
    Head::parse(entries, hash).ok_or_else(expected)
}
