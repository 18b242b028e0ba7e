//! The outputs of `analyze`.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use spineline::analysis::Analysis;
use spineline::cohort::RefusedCase;
use spineline_files::{AnalysisFile, CohortFile, ListText, RefusedFile, results_text};
use spineline_tables::{Table, cohort_tests_table};

use super::kept::{Analysed, Kept};
use crate::analysis::cohort::BOOTSTRAP_SEED;
use crate::analysis::figures::{figures_of, write_figures};
use crate::analysis::record::RunRecord;
use crate::run::failure::Failure;
use crate::run::outputs::{Outputs, Pieces};
use crate::run::provenance::generator;

/// A file or folder of results. It takes the cases one after the other, so that no analysis stays in memory.
pub trait Output: Sync {
    /// Prepares the part of a case, on several threads at a time; the returned step adds it to the output, in the order of the
    /// cases.
    fn case<'a>(&'a self, _case: Result<&Analysed, &RefusedCase>) -> Step<'a> {
        Box::new(|| ())
    }

    fn end(self: Box<Self>, run: &Kept<'_>);
}

pub type Step<'a> = Box<dyn FnOnce() + Send + 'a>;

/// An unfinished result, which a failure removes.
pub struct Growing<'a, T> {
    outputs: &'a Outputs,
    path: &'a Path,
    made: Mutex<Option<T>>,
}

impl<'a, T> Growing<'a, T> {
    /// A result that was begun.
    pub const fn new(outputs: &'a Outputs, path: &'a Path, begun: T) -> Self {
        Self { outputs, path, made: Mutex::new(Some(begun)) }
    }

    /// Its next step; a step that fails removes it.
    pub fn step(&self, step: impl FnOnce(&mut T) -> Result<(), Failure>) {
        // A step that panics ends the program.
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(one) = made.as_mut()
            && !self.outputs.attempt(self.path, || step(one))
        {
            *made = None;
        }
    }

    /// Its last step.
    pub fn end(self, end: impl FnOnce(T) -> Result<(), Failure>) {
        if let Some(made) = self.made.into_inner().unwrap_or_else(PoisonError::into_inner) {
            self.outputs.attempt(self.path, || end(made));
        }
    }
}

/// `--json`: one analysis, or a list of them.
pub struct Json<'a> {
    record: &'a RunRecord,
    is_list: bool,
    text: Growing<'a, JsonText<'a>>,
}

struct JsonText<'a> {
    pieces: Pieces<'a>,
    list: ListText,
}

impl<'a> Json<'a> {
    pub fn new(
        path: &'a Path,
        record: &'a RunRecord,
        is_list: bool,
        outputs: &'a Outputs,
    ) -> Result<Self, Failure> {
        let begun = JsonText { pieces: outputs.begin(path)?, list: ListText::default() };
        Ok(Self { record, is_list, text: Growing::new(outputs, path, begun) })
    }

    fn text<T: serde::Serialize>(&self, file: &T) -> String {
        if self.is_list { ListText::item(file) } else { results_text(file) }
    }
}

impl Output for Json<'_> {
    fn case<'a>(&'a self, case: Result<&Analysed, &RefusedCase>) -> Step<'a> {
        let text = match case {
            Ok(Analysed { input, analysis, confidence, .. }) => {
                let provenance = self.record.provenance_of(input);
                let file = AnalysisFile::new(analysis, input.file.clone(), provenance);
                self.text(&confidence.add_to(analysis, file))
            }
            Err(refused) => self.text(&RefusedFile::new(refused)),
        };
        Box::new(move || {
            self.text.step(|json| {
                if self.is_list {
                    json.pieces.add(json.list.before_item())?;
                }
                json.pieces.add(text)
            });
        })
    }

    fn end(self: Box<Self>, _run: &Kept<'_>) {
        let Self { is_list, text, .. } = *self;
        text.end(|JsonText { mut pieces, list }| {
            if is_list {
                pieces.add(list.end())?;
            }
            pieces.keep().map(|_| ())
        });
    }
}

/// `--csv` and `--chain`: a table with its provenance beside it.
pub struct Csv<'a> {
    path: &'a Path,
    outputs: &'a Outputs,
    table: fn(&[Analysis]) -> Table,
    text: Growing<'a, Pieces<'a>>,
}

impl<'a> Csv<'a> {
    pub fn new(
        path: &'a Path,
        table: fn(&[Analysis]) -> Table,
        outputs: &'a Outputs,
    ) -> Result<Self, Failure> {
        let mut pieces = outputs.begin(path)?;
        pieces.add(table(&[]).csv_heading()?)?;
        Ok(Self { path, outputs, table, text: Growing::new(outputs, path, pieces) })
    }
}

impl Output for Csv<'_> {
    fn case<'a>(&'a self, case: Result<&Analysed, &RefusedCase>) -> Step<'a> {
        let rows = match case {
            Ok(one) => (self.table)(std::slice::from_ref(&one.analysis)),
            Err(refused) => (self.table)(&[]).refused(refused),
        };
        let text = rows.csv_rows();
        Box::new(move || self.text.step(|pieces| pieces.add(text?)))
    }

    fn end(self: Box<Self>, run: &Kept<'_>) {
        let Self { path, outputs, text, .. } = *self;
        text.end(|pieces| outputs.write_provenance(path, pieces.keep()?, &run.provenance()));
    }
}

/// `--figures`: the figures of every patient.
pub struct Figures<'a> {
    pub folder: &'a Path,
    pub record: &'a RunRecord,
    pub outputs: &'a Outputs,
}

impl Output for Figures<'_> {
    fn case<'a>(&'a self, case: Result<&Analysed, &RefusedCase>) -> Step<'a> {
        let Ok(Analysed { input, analysis, .. }) = case else { return Box::new(|| ()) };
        let figures = figures_of(analysis, &self.record.provenance_of(input));
        Box::new(move || {
            self.outputs
                .attempt(self.folder, || write_figures(&figures, self.folder, self.outputs));
        })
    }

    fn end(self: Box<Self>, _run: &Kept<'_>) {}
}

/// `--cohort`: the statistics, as JSON or as a table of tests.
pub struct CohortStatistics<'a> {
    pub path: &'a Path,
    pub outputs: &'a Outputs,
}

impl CohortStatistics<'_> {
    /// Whether it is a table.
    pub fn is_csv(path: &Path) -> bool {
        path.extension().is_some_and(|end| end.eq_ignore_ascii_case("csv"))
    }
}

impl Output for CohortStatistics<'_> {
    fn end(self: Box<Self>, run: &Kept<'_>) {
        let Self { path, outputs } = *self;
        let Some(together) = &run.together else { return };
        outputs.attempt(path, || {
            if Self::is_csv(path) {
                let table = cohort_tests_table(together).to_csv()?;
                return outputs.write_table(path, table, &run.provenance());
            }
            let (ids, refused) = (run.read.ids(), &run.refused);
            let (generator, provenance) = (generator(), run.provenance());
            let file =
                CohortFile::new(together, ids, refused, BOOTSTRAP_SEED, &generator, provenance);
            outputs.write(path, results_text(&file))
        });
    }
}
