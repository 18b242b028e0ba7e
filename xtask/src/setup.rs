//! Installation of what the checks need.

use std::path::Path;

use crate::command::run;
use crate::plan::{Extent, Plan};
use crate::tools::{Tool, has_nextest, install};
use crate::{outside, web};

/// `cargo xtask setup`: installs missing tools, and fills the folders of npm and Python.
pub fn setup(root: &Path) -> Result<(), String> {
    let missing: Vec<Tool> = Tool::ALL.into_iter().filter(|tool| !tool.is_there()).collect();
    install(root, &missing)?;
    if !has_nextest() {
        run(root, "cargo", &["install", "--locked", "cargo-nextest"], &[])?;
    }
    web::provide_packages(root)?;
    outside::provide_environments(&Plan::new(root, Extent::Full))
}
