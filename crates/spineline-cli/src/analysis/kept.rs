//! The patients of a cohort outside memory, for statistics that go through them more than once.

use std::env;
use std::io::{self, BufReader, ErrorKind, Read, Seek, Write};
use std::num::NonZeroUsize;

use spineline::cohort::{CohortPatient, CohortSource};
use tempfile::SpooledTempFile;

use crate::run::failure::Failure;

/// Patients are in memory up to so many bytes, about a thousand patients; all are in a file from then on.
const IN_MEMORY_BYTES: usize = 8 << 20;

/// Patients one after the other, in memory or in a temporary file that has no name and is gone with this program.
pub struct KeptPatients(SpooledTempFile);

impl Default for KeptPatients {
    fn default() -> Self {
        Self(SpooledTempFile::new(IN_MEMORY_BYTES))
    }
}

impl KeptPatients {
    /// Keeps one more ([`CohortPatient::to_bytes`]).
    ///
    /// # Errors
    /// If there is no room for it.
    pub fn add(&mut self, patient: &[u8]) -> Result<(), Failure> {
        let size = (patient.len() as u64).to_le_bytes();
        let added = self.0.write_all(&size).and_then(|()| self.0.write_all(patient));
        added.map_err(|error| failed(&error))
    }
}

impl CohortSource for KeptPatients {
    type Error = Failure;

    fn each_part(
        &mut self,
        most: NonZeroUsize,
        take: &mut dyn FnMut(&[CohortPatient]),
    ) -> Result<(), Failure> {
        each_part(&mut self.0, most.get(), take).map_err(|error| failed(&error))
    }
}

fn each_part(
    file: &mut SpooledTempFile,
    most: usize,
    take: &mut dyn FnMut(&[CohortPatient]),
) -> io::Result<()> {
    file.rewind()?;
    let mut reader = BufReader::new(file);
    let (mut bytes, mut part) = (Vec::new(), Vec::with_capacity(most));
    while let Some(size) = size_of_next(&mut reader)? {
        bytes.resize(size, 0);
        reader.read_exact(&mut bytes)?;
        let damaged = || io::Error::new(ErrorKind::InvalidData, "it is not as it was written");
        part.push(CohortPatient::from_bytes(&bytes).ok_or_else(damaged)?);
        if part.len() == most {
            take(&part);
            part.clear();
        }
    }
    if !part.is_empty() {
        take(&part);
    }
    Ok(())
}

/// `None` after the last patient.
fn size_of_next(reader: &mut impl Read) -> io::Result<Option<usize>> {
    let mut size = [0; 8];
    match reader.read(&mut size[..1])? {
        0 => Ok(None),
        _ => {
            reader.read_exact(&mut size[1..])?;
            Ok(usize::try_from(u64::from_le_bytes(size)).ok())
        }
    }
}

fn failed(error: &io::Error) -> Failure {
    let place = format!("temporary file of the cohort in {}", env::temp_dir().display());
    let help = "a cohort needs about 10 kB per patient there: free some space, or name a folder of another disk by TMPDIR";
    Failure::input(&place, error, help)
}

#[cfg(test)]
mod tests {
    use spineline::analysis::{AnalysisOptions, analyze};
    use spineline_phantom::{Readers, Truth, generate};

    use super::*;

    #[test]
    fn patients_come_back_as_they_were_from_memory_and_from_a_file() {
        let case = generate(0, Truth::Rod, &Readers::scaled(1.0), 1).expect("a phantom").case;
        let analysis = analyze(&case, &AnalysisOptions::default()).expect("an analysis");
        let patient = CohortPatient::of(&analysis);
        let bytes = patient.to_bytes();
        let two = NonZeroUsize::new(2).expect("more than zero");
        for limit in [IN_MEMORY_BYTES, 1] {
            let mut kept = KeptPatients(SpooledTempFile::new(limit));
            let mut seen = Vec::new();
            kept.each_part(two, &mut |part| seen.push(part.len())).expect("nobody");
            assert!(seen.is_empty());
            for _ in 0..3 {
                kept.add(&bytes).expect("room");
            }
            for _ in 0..2 {
                kept.each_part(two, &mut |part| {
                    assert!(part.iter().all(|found| *found == patient));
                    seen.push(part.len());
                })
                .expect("they can be read");
            }
            assert_eq!(seen, [2, 1, 2, 1]);
        }
        assert!(bytes.len() < 12_000, "{} bytes", bytes.len());
        assert!(CohortPatient::from_bytes(&bytes[1..]).is_none());
    }
}
