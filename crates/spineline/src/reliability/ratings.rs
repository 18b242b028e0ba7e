use std::borrow::Borrow;
use std::collections::BTreeMap;

use super::Undefined;
use crate::measure::alike_remark;
use crate::warning::NAMED;

/// Observer, and number of the repeat.
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
    /// Readings of a vertebra that were left out, since no person reviewed the program's corners.
    pub not_reviewed: usize,
    /// Readings of a vertebra with corners that a reader accepted from a program.
    pub accepted: usize,
    /// Readings that were left out, since they have the landmarks of another one of their film.
    pub copied: Vec<String>,
    /// Films in pixels whose lengths were left out beside millimetres.
    pub left_out_in_pixels: Vec<String>,
    /// Readers by number; a cohort has millions of readings by a few of them.
    readers: BTreeMap<Reader, u32>,
    /// Parts of places by number, such as the vertebrae of a film.
    parts: BTreeMap<String, u32>,
    /// A subject is a part of a place.
    places: BTreeMap<String, Vec<Cell>>,
    subjects: usize,
}

/// One reading.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    part: u32,
    reader: u32,
    value: f64,
}

/// The number of a name, in the order in which they come. A name that is known is not copied.
fn number<Owned: Ord + Borrow<Name>, Name: Ord + ?Sized>(
    names: &mut BTreeMap<Owned, u32>,
    name: &Name,
    owned: impl FnOnce() -> Owned,
) -> u32 {
    if let Some(&known) = names.get(name) {
        return known;
    }
    let next = names.len() as u32;
    names.insert(owned(), next);
    next
}

impl RatedQuantity {
    /// A quantity without any reading.
    pub fn new(
        key: impl Into<String>,
        unit: impl Into<String>,
        meaning: impl Into<String>,
    ) -> Self {
        Self {
            key: key.into(),
            unit: unit.into(),
            meaning: meaning.into(),
            not_reviewed: 0,
            accepted: 0,
            copied: Vec::new(),
            left_out_in_pixels: Vec::new(),
            readers: BTreeMap::new(),
            parts: BTreeMap::new(),
            places: BTreeMap::new(),
            subjects: 0,
        }
    }

    /// Adds a reading; `false`, and nothing is changed, where this observer's repeat of this subject is there already.
    #[must_use]
    pub fn insert(&mut self, subject: &str, observer: &str, repeat: u32, value: f64) -> bool {
        self.insert_part(subject, "", &(observer.to_owned(), repeat), value)
    }

    /// As [`RatedQuantity::insert`], of a subject that is one of a few parts of a place; a place and its parts are ordered as their names
    /// one after the other.
    pub(super) fn insert_part(
        &mut self,
        place: &str,
        part: &str,
        reader: &Reader,
        value: f64,
    ) -> bool {
        let reader = number(&mut self.readers, reader, || reader.clone());
        let part = number(&mut self.parts, part, || part.to_owned());
        if !self.places.contains_key(place) {
            self.places.insert(place.to_owned(), Vec::new());
        }
        let cells = self.places.get_mut(place).expect("it was put there");
        let of_part = || cells.iter().filter(|cell| cell.part == part);
        if of_part().any(|cell| cell.reader == reader) {
            return false;
        }
        self.subjects += usize::from(of_part().next().is_none());
        cells.push(Cell { part, reader, value });
        true
    }

    /// Frees the memory for more readings of a place.
    pub(super) fn shrink(&mut self, place: &str) {
        if let Some(cells) = self.places.get_mut(place) {
            cells.shrink_to_fit();
        }
    }

    /// Number of subjects with a reading.
    #[must_use]
    pub fn subjects(&self) -> usize {
        self.subjects
    }

    /// Every observer with the repeats that he made of any subject, both in order.
    pub(super) fn readers(&self) -> BTreeMap<&str, Vec<u32>> {
        let mut readers: BTreeMap<&str, Vec<u32>> = BTreeMap::new();
        for (observer, repeat) in self.readers.keys() {
            readers.entry(observer).or_default().push(*repeat);
        }
        readers
    }

    /// Every subject that all raters rated, one row each, and the names of the first of the others; a rater's value is the
    /// mean over his readings.
    pub(super) fn complete(&self, raters: &[Vec<Reader>]) -> (Vec<Vec<f64>>, Vec<String>) {
        let known = |rater: &Vec<Reader>| -> Vec<Option<u32>> {
            rater.iter().map(|reader| self.readers.get(reader).copied()).collect()
        };
        let raters: Vec<Vec<Option<u32>>> = raters.iter().map(known).collect();
        let mean = |cells: &[Cell], rater: &Vec<Option<u32>>| {
            let of = |reader: Option<u32>| cells.iter().find(|cell| Some(cell.reader) == reader);
            let values = rater.iter().map(|&reader| of(reader).map(|cell| cell.value));
            let values = values.collect::<Option<Vec<f64>>>()?;
            // Against the first, so that equal readings have exactly their own mean.
            let first = *values.first()?;
            let off: f64 = values.iter().map(|value| value - first).sum();
            Some(first + off / values.len() as f64)
        };
        // Rows in the order of names, whatever order the readings had.
        let named = (0_usize..).zip(&self.parts);
        let parts: BTreeMap<u32, (usize, &str)> =
            named.map(|(rank, (name, &part))| (part, (rank, name.as_str()))).collect();
        let (mut rows, mut left_out) = (Vec::new(), Vec::new());
        for (place, cells) in &self.places {
            let mut cells = cells.clone();
            cells.sort_by_key(|cell| parts[&cell.part]);
            for subject in cells.chunk_by(|a, b| a.part == b.part) {
                let row = raters.iter().map(|rater| mean(subject, rater));
                match row.collect::<Option<Vec<f64>>>() {
                    Some(row) => rows.push(row),
                    None if left_out.len() == NAMED => {}
                    None => {
                        let (_, part) = parts[&subject[0].part];
                        left_out.push(format!("{place}{part}"));
                    }
                }
            }
        }
        (rows, left_out)
    }

    /// The words on places whose names differ by capitals and marks alone.
    pub(super) fn alike_subjects(&self) -> Option<String> {
        alike_remark("subjects", self.places.keys().map(|place| place.trim_end_matches('/')))
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
