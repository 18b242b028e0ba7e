use std::collections::BTreeMap;

use super::Undefined;

/// Who read, and the how-manieth time.
pub(super) type Reader = (String, u32);

/// Readings of one quantity: subjects × observers × repeats, with or without gaps.
#[derive(Debug, Clone, PartialEq)]
pub struct RatedQuantity {
    /// Stable name, such as `spacing`.
    pub key: String,
    /// Unit of the readings, such as `mm (patient)`.
    pub unit: String,
    /// What it is, and what its subjects are.
    pub meaning: String,
    /// Readings of a vertebra that were left out, since nobody has looked at what a program found.
    pub not_reviewed: usize,
    /// Readings of a vertebra with corners that a reader accepted from a program.
    pub accepted: usize,
    cells: BTreeMap<String, BTreeMap<Reader, f64>>,
}

impl RatedQuantity {
    /// A quantity without any reading.
    pub fn new(
        key: impl Into<String>,
        unit: impl Into<String>,
        meaning: impl Into<String>,
    ) -> Self {
        let (key, unit, meaning) = (key.into(), unit.into(), meaning.into());
        Self { key, unit, meaning, not_reviewed: 0, accepted: 0, cells: BTreeMap::new() }
    }

    /// Adds a reading; `false`, and nothing is changed, where this observer's repeat of this subject is there already.
    #[must_use]
    pub fn insert(&mut self, subject: &str, observer: &str, repeat: u32, value: f64) -> bool {
        let readings = self.cells.entry(subject.to_owned()).or_default();
        let reader = (observer.to_owned(), repeat);
        let free = !readings.contains_key(&reader);
        if free {
            readings.insert(reader, value);
        }
        free
    }

    /// Number of subjects that anybody read.
    #[must_use]
    pub fn subjects(&self) -> usize {
        self.cells.len()
    }

    /// Every observer with the repeats that he made of any subject, both in order.
    pub(super) fn readers(&self) -> BTreeMap<&str, Vec<u32>> {
        let mut readers: BTreeMap<&str, Vec<u32>> = BTreeMap::new();
        for (observer, repeat) in self.cells.values().flat_map(BTreeMap::keys) {
            let repeats = readers.entry(observer).or_default();
            if let Err(place) = repeats.binary_search(repeat) {
                repeats.insert(place, *repeat);
            }
        }
        readers
    }

    /// Every subject that all raters rated, one row each; a rater's value is the mean over his readings.
    pub(super) fn complete(&self, raters: &[Vec<Reader>]) -> Vec<Vec<f64>> {
        let mean = |readings: &BTreeMap<Reader, f64>, rater: &Vec<Reader>| {
            let values = rater.iter().map(|reader| readings.get(reader).copied());
            let values = values.collect::<Option<Vec<f64>>>()?;
            // Against the first, so that equal readings have exactly their own mean.
            let first = *values.first()?;
            let off: f64 = values.iter().map(|value| value - first).sum();
            Some(first + off / values.len() as f64)
        };
        self.cells
            .values()
            .filter_map(|readings| raters.iter().map(|rater| mean(readings, rater)).collect())
            .collect()
    }
}

/// A complete table of at least two subjects and two raters.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ratings {
    rows: Vec<Vec<f64>>,
    raters: usize,
}

impl Ratings {
    pub(super) fn new(rows: Vec<Vec<f64>>, subjects: usize) -> Result<Self, Undefined> {
        let raters = rows.first().map_or(0, Vec::len);
        if rows.len() < 2 {
            return Err(if subjects > rows.len() {
                Undefined::MissingCells { complete: rows.len(), subjects }
            } else {
                Undefined::TooFewSubjects { n: rows.len(), least: 2 }
            });
        }
        if rows.iter().flatten().any(|value| !value.is_finite()) {
            return Err(Undefined::NotFinite);
        }
        Ok(Self { rows, raters })
    }

    pub(super) fn subjects(&self) -> usize {
        self.rows.len()
    }

    pub(super) fn raters(&self) -> usize {
        self.raters
    }

    pub(super) fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }

    pub(super) fn column(&self, rater: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row[rater]).collect()
    }
}
