//! The patients of a cohort outside memory, for statistics that go through them more than once.

use std::env;
use std::io::{self, BufReader, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::num::NonZeroUsize;

use spineline::cohort::{CohortPatient, CohortRows, CohortSource, TakePart};
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
        take: &mut TakePart<'_, Failure>,
    ) -> Result<(), Failure> {
        self.0.rewind().map_err(|error| failed(&error))?;
        let mut reader = BufReader::new(&mut self.0);
        let (mut bytes, mut part) = (Vec::new(), Vec::with_capacity(most.get()));
        while let Some(patient) =
            next_patient(&mut reader, &mut bytes).map_err(|error| failed(&error))?
        {
            part.push(patient);
            if part.len() == most.get() {
                take(&part)?;
                part.clear();
            }
        }
        if part.is_empty() { Ok(()) } else { take(&part) }
    }
}

/// `None` after the last patient.
fn next_patient(reader: &mut impl Read, bytes: &mut Vec<u8>) -> io::Result<Option<CohortPatient>> {
    let Some(size) = size_of_next(reader)? else { return Ok(None) };
    bytes.resize(size, 0);
    reader.read_exact(bytes)?;
    let damaged = || io::Error::new(ErrorKind::InvalidData, "it is not as it was written");
    CohortPatient::from_bytes(bytes).map(Some).ok_or_else(damaged)
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

/// Numbers of the patients, in memory or in such a file.
pub struct KeptRows(BufWriter<SpooledTempFile>);

impl Default for KeptRows {
    fn default() -> Self {
        Self(BufWriter::new(SpooledTempFile::new(IN_MEMORY_BYTES)))
    }
}

impl CohortRows<Failure> for KeptRows {
    fn add(&mut self, row: &[f64]) -> Result<(), Failure> {
        let mut numbers = row.iter().map(|number| number.to_le_bytes());
        numbers.try_for_each(|number| self.0.write_all(&number)).map_err(|error| failed(&error))
    }

    fn each(&mut self, numbers: usize, take: &mut dyn FnMut(&[f64])) -> Result<(), Failure> {
        let read = self.0.flush().and_then(|()| each_row(self.0.get_mut(), numbers, take));
        read.map_err(|error| failed(&error))
    }
}

fn each_row(
    file: &mut SpooledTempFile,
    numbers: usize,
    take: &mut dyn FnMut(&[f64]),
) -> io::Result<()> {
    let size = numbers * size_of::<f64>();
    let rows = file.seek(SeekFrom::End(0))?.checked_div(size as u64);
    file.rewind()?;
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let (mut bytes, mut row) = (vec![0; size], vec![0.0; numbers]);
    for _ in 0..rows.unwrap_or_default() {
        reader.read_exact(&mut bytes)?;
        for (number, bytes) in row.iter_mut().zip(bytes.as_chunks().0) {
            *number = f64::from_le_bytes(*bytes);
        }
        take(&row);
    }
    Ok(())
}

fn failed(error: &io::Error) -> Failure {
    let place = format!("temporary file of the cohort in {}", env::temp_dir().display());
    let help = "a cohort needs about 12 kB per patient there: free some space, or name a folder of another disk by TMPDIR";
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
            kept.each_part(two, &mut |_| panic!("nobody is there")).expect("nobody");
            for _ in 0..3 {
                kept.add(&bytes).expect("room");
            }
            for _ in 0..2 {
                kept.each_part(two, &mut |part| {
                    assert!(part.iter().all(|found| *found == patient));
                    seen.push(part.len());
                    Ok(())
                })
                .expect("they can be read");
            }
            assert_eq!(seen, [2, 1, 2, 1]);
        }
        assert!(bytes.len() < 12_000, "{} bytes", bytes.len());
        assert!(CohortPatient::from_bytes(&bytes[1..]).is_none());
    }

    #[test]
    fn rows_come_back_to_the_bit_from_memory_and_from_a_file() {
        let written = [1.5, -0.0, f64::NAN, f64::from_bits(u64::MAX), 0.1, 1e-300];
        for limit in [IN_MEMORY_BYTES, 1] {
            let mut rows = KeptRows(BufWriter::new(SpooledTempFile::new(limit)));
            rows.each(3, &mut |_| panic!("no row is there")).expect("no row");
            written.chunks(3).for_each(|row| rows.add(row).expect("room"));
            for _ in 0..2 {
                let mut read = Vec::new();
                rows.each(3, &mut |row| read.extend(row.iter().map(|x| x.to_bits())))
                    .expect("rows");
                assert_eq!(read, written.map(f64::to_bits));
            }
        }
    }
}
