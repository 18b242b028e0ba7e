//! Step 1: the readings and the outlines of all films.

use std::borrow::Cow;

use super::Case;
use super::checks::{
    check_age, check_outlines, check_postures, warn_of_length, warn_of_shifted_levels,
};
use super::wrong_film::warn_of_wrong_films;
use crate::anatomy::{Levels, Posture};
use crate::error::Error;
use crate::measure::{
    Film, FilmLengthRule, FilmReadings, InterpolationError, MeasuredVertebra, Outline,
    OutlineNoise, TiltRule, body_widths, common_levels, outline_of, seen_levels, shown_levels,
    warn_of_alike_observers, warn_of_implausible_landmarks, warn_of_shortened_chain,
};
use crate::warning::{WarningCode, Warnings};

/// What a replicate takes beside its moved landmarks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Replicated<'a> {
    /// Standard deviations of the films' measured values, in the order of the postures: the case's.
    pub noise: &'a [OutlineNoise],
    /// Errors of interpolated vertebrae.
    pub errors: &'a [InterpolationError],
}

/// The films of a case, the erect one first.
pub(super) struct Measured {
    pub readings: Vec<FilmReadings>,
    /// Between the vertebrae of the model, which all films show.
    pub outlines: Vec<Outline>,
    /// Between the vertebrae that each film shows; `None` where all show the same.
    pub whole: Option<Vec<Outline>>,
}

/// Step 1: the readings and the outlines of every film.
pub(super) fn measure(
    case: &Case,
    tilt: TiltRule,
    replicated: Option<Replicated<'_>>,
    warnings: &mut Warnings,
) -> Result<Measured, Error> {
    check_age(case.subject.age_years)?;
    check_postures(&case.films, case.lateral.as_ref())?;
    let mut marked: Vec<&Film> = case.films.iter().collect();
    marked.sort_by_key(|film| film.posture);
    warnings.check_films(marked.iter().filter(|film| film.checked).map(|film| film.posture));
    let measure = |film: &&Film| FilmReadings::measure(film, tilt);
    let readings: Vec<FilmReadings> = marked.iter().map(measure).collect::<Result<_, _>>()?;
    let once: Vec<Cow<'_, Film>> = marked.iter().map(|film| film.with_copies_as_one()).collect();
    let films: Vec<&Film> = once.iter().map(|film| &**film).collect();
    let seen: Vec<_> =
        readings.iter().map(|film| (film.posture, seen_levels(&film.readings))).collect();
    let levels = common_levels(&seen)?;
    warn_of_shortened_chain(levels, &seen, warnings);
    let shown: Vec<Levels> = seen.iter().map(|film| shown_levels(film, levels)).collect();
    let is_cut = shown.iter().any(|film| *film != levels);
    // Replicates skip doubts about their films, which take a tenth of their time.
    let reports_doubts = replicated.is_none();
    let mut held = replicated.iter().flat_map(|held| held.noise);
    let (mut outlines, mut whole): (Vec<Outline>, Vec<Outline>) = (Vec::new(), Vec::new());
    for (((film, marked), measured), shown) in films.iter().zip(&marked).zip(&readings).zip(shown) {
        let noise = held.next().map(|noise| noise.film);
        let mut outline = outline_of(film, &measured.readings, shown, tilt, noise, warnings)?;
        if is_cut {
            whole.push(outline.clone());
        }
        if shown != levels {
            // The whole film gave the warnings about its landmarks already.
            let repeated = &mut Warnings::default();
            outline = outline_of(film, &measured.readings, levels, tilt, noise, repeated)?;
        }
        outlines.push(match outlines.first() {
            Some(erect) => outline.in_millimetres_of(erect),
            None => outline,
        });
        if reports_doubts {
            warn_of_implausible_landmarks(marked, warnings);
        }
    }
    if let Some(held) = replicated {
        for (outline, noise) in outlines.iter_mut().zip(held.noise) {
            noise.give_to(outline);
            held.errors.iter().for_each(|error| error.add_to(outline));
        }
        for outline in &mut whole {
            held.errors.iter().for_each(|error| error.add_to(outline));
        }
    }
    if reports_doubts {
        for film in &films[1..] {
            warn_of_shifted_levels(films[0], film, warnings);
        }
        warn_of_alike_observers(&readings, warnings);
        if is_read_once(&readings) {
            let text = "every film was read once, so the reliability of the readings is not known: add readings of a second observer, or repeat the reading";
            warnings.push(WarningCode::ReliabilityOneReading, text);
        }
    }
    check_outlines(&outlines, warnings)?;
    if reports_doubts {
        warn_of_wrong_films(&films, &outlines, case.synthetic, warnings);
    }
    Ok(Measured { readings, outlines, whole: is_cut.then_some(whole) })
}

/// Brings all films to the length of the erect one.
pub(super) fn at_erect_length(
    outlines: Vec<Outline>,
    rule: FilmLengthRule,
    warnings: &mut Warnings,
) -> Vec<Outline> {
    let erect = outlines[0].clone();
    let scaled: Vec<Outline> = outlines
        .into_iter()
        .map(|film| match film.posture {
            Posture::Erect => film,
            _ => film.at_erect_length(&erect, rule),
        })
        .collect();
    scaled.iter().for_each(|film| warn_of_length(film, warnings));
    scaled
}

/// Whether no film has a second reading.
pub(super) fn is_read_once(films: &[FilmReadings]) -> bool {
    films.iter().all(|film| film.readings.len() < 2)
}

/// Widths of the bodies of the model between their corners on the erect film, means over the readings; `None` where a person did not
/// place these: proposals of a program follow a typical vertebra too.
///
/// A vertebra with axial rotation looks narrower or wider by its depth: by 1 % at 20° where it is a tenth wider than deep.
pub(super) fn widths_mm(case: &Case, erect: &Outline) -> Vec<Option<f64>> {
    let film = case.film(Posture::Erect).map(Film::with_copies_as_one);
    let widths = film.map(|film| body_widths(&film, erect.levels())).unwrap_or_default();
    let per_mm = erect.scale.units_per_mm;
    let own = |(vertebra, width): (&MeasuredVertebra, Option<f64>)| {
        width.filter(|_| vertebra.program.is_none()).map(|width| width / per_mm)
    };
    erect.vertebrae.iter().zip(widths).map(own).collect()
}
