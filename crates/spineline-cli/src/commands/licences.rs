//! `spineline licences`: the licences of the program and of everything in it.

use std::io::Read;

use crate::run::failure::{Ending, Failure};
use crate::run::outputs::print_data;

/// The notices of all crates, compressed.
const CRATES: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/notices.zlib"));

pub fn run() -> Result<Ending, Failure> {
    let mut text = concat!(
        "Spineline is under the licences MIT or Apache 2.0, at your choice.\n\n",
        include_str!("../../LICENSE-MIT"),
    )
    .to_owned();
    #[cfg(feature = "weights")]
    text.push_str(&format!("\nWeights that propose landmarks:\n\n{}", spineline_weights::LICENCE));
    text.push_str(
        "\nThe program and the Python package contain the packages below, with their fonts.\n\n",
    );
    flate2::read::ZlibDecoder::new(CRATES)
        .read_to_string(&mut text)
        .map_err(|error| Failure::internal(format!("the notices are damaged: {error}")))?;
    text.push_str(&spineline_server::licences_of_app());
    print_data(&text)
}
