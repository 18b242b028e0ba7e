//! The tables of a study, as `spineline analyze --tables` writes them.

use spineline::analysis::{Analysis, Case};
use spineline_files::to_text;
use spineline_tables::{OptionalTables, Patient, Table, TableError, dictionary, tables};

use super::archive::archive;
use super::file::{Download, internal, provenance};
use crate::jobs::Computed;
use crate::problem::Answer;

pub fn csv(analysis: &Analysis, case: &Case, found: &Computed) -> Answer<Download> {
    written(patient(analysis, case, found), "-tables-csv.zip", "csv", |table| {
        table.to_csv().map(String::into_bytes)
    })
}

pub fn parquet(analysis: &Analysis, case: &Case, found: &Computed) -> Answer<Download> {
    let origin = to_text(&provenance(analysis).of_listed_file());
    written(patient(analysis, case, found), "-tables-parquet.zip", "parquet", |table| {
        table.to_parquet(&[("spineline.provenance", &origin)])
    })
}

fn patient<'a>(analysis: &'a Analysis, case: &'a Case, found: &'a Computed) -> Patient<'a> {
    Patient {
        analysis,
        subject: &case.subject,
        identifiability: found.identifiability(),
        uncertainty: found.uncertainty(),
    }
}

fn written(
    patient: Patient<'_>,
    ending: &'static str,
    form: &str,
    write: impl Fn(&Table) -> Result<Vec<u8>, TableError>,
) -> Answer<Download> {
    let analysis = patient.analysis;
    let patients = [patient];
    let mut files = Vec::new();
    for table in tables(&patients) {
        let bytes = write(&table).map_err(|error| internal(&error))?;
        files.push((format!("{}.{form}", table.name), bytes));
    }
    let meanings = dictionary(OptionalTables::of(&patients));
    let text = meanings.to_csv().map_err(|error| internal(&error))?;
    files.push((format!("{}.csv", meanings.name), text.into_bytes()));
    archive(ending, files, provenance(analysis))
}
