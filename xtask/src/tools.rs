//! Other programs that the checks need, and their installation.

use std::path::Path;
use std::process::Command;

use crate::command::{answers, run};

/// A program that a check needs.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tool {
    Npm,
    Python,
    Dcmtk,
    Orthanc,
}

/// The program of npm.
pub const NPM: &str = if cfg!(windows) { "npm.cmd" } else { "npm" };

/// Chromium of Debian, with and without windows; `web/e2e/browser.ts` looks for the same files.
const CHROMIUM: &str = "/usr/bin/chromium";
const CHROMIUM_SHELL: &str = "/usr/lib/chromium/chromium-headless-shell";

/// Files of Debian's Orthanc, which the tests look for.
const ORTHANC: [&str; 2] =
    ["/usr/sbin/Orthanc", "/usr/share/orthanc/plugins/libOrthancDicomWeb.so"];

impl Tool {
    pub const ALL: [Self; 4] = [Self::Npm, Self::Python, Self::Dcmtk, Self::Orthanc];

    pub fn name(self) -> &'static str {
        match self {
            Self::Npm => "Node.js with npm",
            Self::Python => "Python 3.11 with venv",
            Self::Dcmtk => "DCMTK",
            Self::Orthanc => "Orthanc with DICOMweb",
        }
    }

    /// Its purpose.
    pub fn purpose(self) -> &'static str {
        match self {
            Self::Npm => "builds and tests the browser app",
            Self::Python => "runs the programs that results are compared with",
            Self::Dcmtk => "reads exported DICOM reports",
            Self::Orthanc => "is the image archive that films are opened from",
        }
    }

    /// Whether a missing tool is only reported at the end.
    pub const fn is_optional(self) -> bool {
        matches!(self, Self::Dcmtk | Self::Orthanc)
    }

    /// The Debian packages that contain it.
    fn packages(self) -> &'static [&'static str] {
        match self {
            Self::Npm => &["nodejs", "npm"],
            Self::Python => &["python3", "python3-venv"],
            Self::Dcmtk => &["dcmtk"],
            Self::Orthanc => &["orthanc", "orthanc-dicomweb"],
        }
    }

    /// The command that installs it.
    pub fn install(self) -> String {
        format!("apt-get install --no-install-recommends {}", self.packages().join(" "))
    }

    pub fn is_there(self) -> bool {
        match self {
            Self::Npm => answers(NPM, &["--version"]),
            Self::Python => {
                std::env::var_os("PYTHON").is_some()
                    || answers("python3", &["-m", "venv", "--help"])
            }
            Self::Dcmtk => answers("dsrdump", &["--version"]),
            Self::Orthanc => ORTHANC.iter().all(|file| Path::new(file).exists()),
        }
    }
}

/// Whether the machine has a Chromium that `web/e2e/browser.ts` finds; otherwise npm's Chromium drives the app.
pub fn has_chromium() -> bool {
    std::env::var_os("CHROMIUM").is_some()
        || Path::new(CHROMIUM_SHELL).exists()
        || Path::new(CHROMIUM).exists()
}

/// Installs tools as Debian packages, as root or through `sudo`.
pub fn install(root: &Path, missing: &[Tool]) -> Result<(), String> {
    if missing.is_empty() {
        return Ok(());
    }
    let packages = missing.iter().flat_map(|tool| tool.packages()).copied();
    let install = ["apt-get", "install", "--yes", "--no-install-recommends"];
    let install: Vec<&str> = install.into_iter().chain(packages).collect();
    let is_root = Command::new("id").arg("-u").output().is_ok_and(|output| output.stdout == b"0\n");
    for command in [&["apt-get", "update"][..], &install] {
        let (program, arguments) =
            if is_root { (command[0], &command[1..]) } else { ("sudo", command) };
        run(root, program, arguments, &[("DEBIAN_FRONTEND", "noninteractive")])?;
    }
    Ok(())
}

pub fn has_nextest() -> bool {
    answers("cargo", &["nextest", "--version"])
}
