//! `spineline stiffness`: the built-in stiffness table.

use spineline::multibody::StiffnessLibrary;
use spineline_files::{StiffnessFile, to_text};

use crate::run::failure::{Ending, Failure};
use crate::run::outputs::print;

pub fn run() -> Result<Ending, Failure> {
    print(&to_text(&StiffnessFile::from(&StiffnessLibrary::default())))
}
