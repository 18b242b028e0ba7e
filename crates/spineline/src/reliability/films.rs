//! Marked films → quantities whose readings can be compared.

use std::collections::{BTreeMap, BTreeSet};

use super::RatedQuantity;
use crate::anatomy::Level;
use crate::measure::{FilmReadings, Placement, Reading, SpacingPlane};
use crate::spatial::Angle;

/// Name and meaning of a quantity; the first two rows of each unit are what the paper correlated.
const LENGTHS: [(&str, &str); 4] = [
    (
        "lateral_bow",
        "lateral distance of a midpoint from the middle of its two neighbours, film's frame; subjects: inner vertebrae on films",
    ),
    ("spacing", "distance of neighbouring midpoints; subjects: pairs of neighbours on films"),
    (
        "location_y_as_paper",
        "lateral coordinate of a midpoint, film's frame; subjects: vertebrae on films, pooled as the paper did: correlations include the place of the film and the posture of the patient",
    ),
    (
        "location_z_as_paper",
        "height of a midpoint, film's frame; subjects: vertebrae on films, pooled as the paper did: correlations include the length of the spine and are near 1 for any observers",
    ),
];
const ANGLES: [(&str, &str); 2] = [
    (
        "tilt_step",
        "tilt of a vertebra against the one below; subjects: pairs of neighbours on films",
    ),
    (
        "tilt_as_paper",
        "tilt of a vertebra against the film; subjects: vertebrae on films, pooled as the paper did: correlations include the posture of the patient",
    ),
];

/// The quantities of one or more cases, each given by its identifier and films.
///
/// The paper correlated locations and tilts over all vertebrae. Heights of vertebrae span 400 mm, so that any reader who
/// knows the order of the vertebrae has r = 0.999: such quantities are named `…_as_paper`, and of them only SEM, MDC95
/// and limits of agreement describe the observers. Local quantities are added, from which the position along the
/// spine and the film's frame have dropped out, and, but for the spacing, the patient's lateral tilt: their spread comes from the
/// spine's shape, with which an ICC should compare the error. (A lateral step from vertebra to vertebra would
/// still hold the lateral tilt: bends of both sides make it span 40 mm.) An error of these holds two or three vertebrae's errors.
///
/// Subjects are nested: vertebrae in films, films in cases. An observer of the same name is one observer in all cases.
/// Readings of one case that are given twice are left as they were first.
///
/// A vertebra with corners that a program found and no person reviewed is not a reading, and is left out: two readings by one model
/// agree whatever the film shows. Accepted corners count, and are counted, since readers share the model that proposed them.
///
/// Pixels are not added to millimetres: beside films with a scale, films in pixels count in angles alone.
#[must_use]
pub fn film_quantities(cases: &[(&str, &[FilmReadings])]) -> Vec<RatedQuantity> {
    let mut all = FilmQuantities::default();
    for (case, films) in cases {
        all.add(case, films);
    }
    all.finish()
}

/// [`film_quantities`] of cases that come one after the other, since a cohort's films need not be in memory together.
#[derive(Debug, Clone)]
pub struct FilmQuantities {
    all: Vec<RatedQuantity>,
    /// Lengths of the films in pixels.
    in_pixels: [RatedQuantity; LENGTHS.len()],
    films_in_pixels: BTreeSet<String>,
    /// Units of the other films.
    length_units: BTreeSet<String>,
    /// Readings with the landmarks of another one.
    copied: BTreeSet<String>,
}

impl Default for FilmQuantities {
    fn default() -> Self {
        let lengths = LENGTHS.map(|(key, meaning)| RatedQuantity::new(key, "", meaning));
        let angles = ANGLES.map(|(key, meaning)| RatedQuantity::new(key, "deg", meaning));
        Self {
            all: lengths.clone().into_iter().chain(angles).collect(),
            in_pixels: lengths,
            films_in_pixels: BTreeSet::new(),
            length_units: BTreeSet::new(),
            copied: BTreeSet::new(),
        }
    }
}

impl FilmQuantities {
    /// Adds the films of a case.
    pub fn add(&mut self, case: &str, films: &[FilmReadings]) {
        for film in films {
            let is_in_pixels = film.length_unit == SpacingPlane::Pixels.unit();
            if is_in_pixels {
                self.films_in_pixels.insert(format!("{case} ({})", film.posture));
                self.swap_lengths();
            } else if !self.length_units.contains(&film.length_unit) {
                self.length_units.insert(film.length_unit.clone());
            }
            let copied = film.copied.iter();
            self.copied.extend(copied.map(|id| format!("{case} ({}), {id}", film.posture)));
            let place = format!("{case}/{}/", film.posture.key());
            let references = references(&film.readings);
            for reading in &film.readings {
                let is_read = |vertebra: &&Placement| {
                    vertebra.program.is_none_or(|program| program.is_reviewed)
                };
                let read = reading.vertebrae.values().filter(is_read);
                let accepted = read.clone().filter(|vertebra| vertebra.program.is_some()).count();
                let not_reviewed = reading.vertebrae.len() - read.count();
                for quantity in &mut self.all {
                    quantity.not_reviewed += not_reviewed;
                    quantity.accepted += accepted;
                }
                let mut reading = reading.clone();
                reading.vertebrae.retain(|_, vertebra| is_read(&&*vertebra));
                insert(&mut self.all, &place, &reading, &references);
            }
            self.all.iter_mut().for_each(|quantity| quantity.shrink(&place));
            if is_in_pixels {
                self.swap_lengths();
            }
        }
    }

    fn swap_lengths(&mut self) {
        self.all[..LENGTHS.len()].swap_with_slice(&mut self.in_pixels);
    }

    /// The quantities of all cases.
    #[must_use]
    pub fn finish(mut self) -> Vec<RatedQuantity> {
        if self.length_units.is_empty() && !self.films_in_pixels.is_empty() {
            self.swap_lengths();
            self.length_units.insert(SpacingPlane::Pixels.unit().to_owned());
            self.films_in_pixels.clear();
        }
        let mut units = self.length_units.into_iter();
        let unit = match (units.next(), units.next()) {
            (Some(one), None) => one,
            _ => "mm (planes differ)".to_owned(),
        };
        let copied: Vec<String> = self.copied.into_iter().collect();
        self.all.iter_mut().for_each(|quantity| quantity.copied.clone_from(&copied));
        let left_out: Vec<String> = self.films_in_pixels.into_iter().collect();
        for quantity in &mut self.all[..LENGTHS.len()] {
            quantity.unit.clone_from(&unit);
            quantity.left_out_in_pixels.clone_from(&left_out);
        }
        self.all
    }
}

/// A tilt of each vertebra, against which all readings of it are unwrapped: a film may be held upside down.
fn references(readings: &[Reading<Placement>]) -> BTreeMap<Level, Angle> {
    let mut sorted: Vec<&Reading<Placement>> = readings.iter().collect();
    sorted.sort_by(|a, b| b.id.cmp(&a.id));
    sorted.iter().flat_map(|r| r.vertebrae.iter().map(|(&level, v)| (level, v.tilt))).collect()
}

/// One reading's values of all quantities.
fn insert(
    all: &mut [RatedQuantity],
    place: &str,
    reading: &Reading<Placement>,
    references: &BTreeMap<Level, Angle>,
) {
    let reader = (reading.id.observer.clone(), reading.id.repeat);
    let mut set = |key: &str, part: &str, value: f64| {
        let quantity = all.iter_mut().find(|quantity| quantity.key == key);
        let quantity = quantity.expect("every key is one of the table's");
        // A case that is given twice adds nothing.
        quantity.insert_part(place, part, &reader, value);
    };
    let tilt_deg = |level: Level, tilt: Angle| {
        let reference = references[&level];
        (reference + (tilt - reference).wrapped()).deg()
    };
    for (&level, vertebra) in &reading.vertebrae {
        let subject = level.name();
        set("location_y_as_paper", subject, vertebra.location.y_mm);
        set("location_z_as_paper", subject, vertebra.location.z_mm);
        set("tilt_as_paper", subject, tilt_deg(level, vertebra.tilt));
    }
    for pair in Level::ALL.windows(2) {
        let [below, above] = [pair[0], pair[1]].map(|level| reading.vertebrae.get(&level));
        let (Some(below), Some(above)) = (below, above) else { continue };
        let subject = format!("{}-{}", pair[0], pair[1]);
        set("spacing", &subject, above.location.distance_mm(below.location));
        set("tilt_step", &subject, (above.tilt - below.tilt).wrapped().deg());
    }
    for triple in Level::ALL.windows(3) {
        let places = [triple[0], triple[1], triple[2]].map(|level| reading.vertebrae.get(&level));
        let [Some(below), Some(inner), Some(above)] = places else { continue };
        let bow = inner.location - (below.location + above.location) * 0.5;
        set("lateral_bow", triple[1].name(), bow.y_mm);
    }
}
