//! Writes the seeds of the fuzz targets to a folder: `seeds FOLDER`.

use std::fs;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder: PathBuf = std::env::args_os().nth(1).ok_or("usage: seeds FOLDER")?.into();
    for seed in spineline_fuzz_checks::seeds()? {
        let own = folder.join(seed.target);
        fs::create_dir_all(&own)?;
        fs::write(own.join(seed.name), seed.bytes)?;
    }
    Ok(())
}
