//! Image archives from which users of the browser app may open films.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;
use spineline_dicomweb::Archive;
use spineline_store::wider_permissions;

use crate::run::failure::Failure;
use crate::run::messages::say;

/// Archives and their logins.
#[derive(Debug, Clone, Args)]
pub struct ArchiveArgs {
    /// Image archive (PACS) from which users may open films, and the address of its DICOMweb service; may be repeated
    #[arg(long = "dicomweb", value_name = "NAME=ADDRESS", value_parser = Archive::parse)]
    archives: Vec<Archive>,

    /// File with the login of an archive: one line USER:PASSWORD; may be repeated
    #[arg(long = "dicomweb-login", value_name = "NAME=FILE", value_parser = named_file)]
    logins: Vec<(String, PathBuf)>,
}

fn named_file(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, file)) if !name.is_empty() && !file.is_empty() => {
            Ok((name.to_owned(), file.into()))
        }
        _ => Err("it must be NAME=FILE, such as clinic=clinic.login".to_owned()),
    }
}

impl ArchiveArgs {
    /// The archives with their logins; warns of what others can read.
    pub fn read(&self) -> Result<Vec<Archive>, Failure> {
        let mut names = BTreeSet::new();
        for archive in &self.archives {
            if !names.insert(archive.name()) {
                let text = format!("--dicomweb names `{}` twice; give each a name", archive.name());
                return Err(Failure::usage(text));
            }
        }
        if let Some((name, _)) = self.logins.iter().find(|(name, _)| !names.contains(&name[..])) {
            let text = format!("--dicomweb-login is for `{name}`, which no --dicomweb names");
            return Err(Failure::usage(text));
        }
        self.archives.iter().cloned().map(|archive| self.with_login(archive)).collect()
    }

    fn with_login(&self, archive: Archive) -> Result<Archive, Failure> {
        if archive.is_exposed() {
            say(format!(
                "warning: films and logins are not encrypted between this machine and the archive `{}`: others can read and change them; use an https:// address",
                archive.name()
            ));
        }
        let mut logins = self.logins.iter().filter(|(name, _)| name == archive.name());
        match (logins.next(), logins.next()) {
            (None, _) => Ok(archive),
            (Some((_, file)), None) => read_login(archive, file),
            (Some((name, _)), Some(_)) => {
                Err(Failure::usage(format!("--dicomweb-login is given twice for `{name}`")))
            }
        }
    }
}

fn read_login(archive: Archive, file: &Path) -> Result<Archive, Failure> {
    let place = file.display().to_string();
    let fail = |error: &dyn std::fmt::Display| {
        Failure::input(&place, error, "write the login as one line USER:PASSWORD of UTF-8 text")
    };
    let login = std::fs::read_to_string(file).map_err(|error| fail(&error))?;
    if let Some(mode) = wider_permissions(file) {
        say(format!(
            "warning: other users of this machine have access to {place} (permissions {mode}), which holds the login of the archive `{}`; close it with: chmod 600 {place}",
            archive.name()
        ));
    }
    archive.with_login(&login).map_err(|error| fail(&error))
}
