//! Programs that are packages of the system: installed where that is allowed.

use std::process::{Command, Stdio};

/// Whether a program is there, or is after its Debian package has been installed.
pub fn provide(program: &str, package: &str) -> bool {
    if answers(program) {
        return true;
    }
    let root = Command::new("id").arg("-u").output().is_ok_and(|output| output.stdout == b"0\n");
    let install = ["install", "--yes", "--no-install-recommends", package];
    if !root {
        return false;
    }
    println!("» apt-get install {package}");
    works("apt-get", &install) || works("apt-get", &["update"]) && works("apt-get", &install)
}

fn answers(program: &str) -> bool {
    works(program, &["--version"])
}

fn works(program: &str, arguments: &[&str]) -> bool {
    let quiet =
        Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
    quiet.is_ok_and(|status| status.success())
}
