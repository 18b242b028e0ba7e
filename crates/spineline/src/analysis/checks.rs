//! Consistency checks between the films of one patient, before they are analysed together.

use super::wrong_film::tilt_margin;
use super::{AnalysisOptions, Reference};
use crate::anatomy::{FilmView, Levels, Posture};
use crate::clinical::{ClinicalCurve, CobbEnds, UnmarkedNeighbour};
use crate::error::CaseError;
use crate::measure::{
    Film, FilmLength, LateralFilm, Outline, SpacingPlane, body_widths, same_landmarks,
};
use crate::multibody::StiffnessError;
use crate::number::fixed;
use crate::personalize::Gauge;
use crate::spatial::Angle;
use crate::warning::{WarningCode, Warnings};

/// No person is known to have lived longer than 122 years.
const MAX_AGE_YEARS: f64 = 125.0;

/// An age is a number of years that a person can have.
pub(super) fn check_age(age_years: Option<f64>) -> Result<(), CaseError> {
    match age_years.filter(|age| !(0.0..=MAX_AGE_YEARS).contains(age)) {
        Some(age_years) => Err(CaseError::Age { age_years, limit_years: MAX_AGE_YEARS }),
        None => Ok(()),
    }
}

/// Refuses springs in another unit where forces are in newtons. Elsewhere only ratios of springs count, and the unit is doubted.
pub(super) fn check_unit(
    options: &AnalysisOptions,
    warnings: &mut Warnings,
) -> Result<(), StiffnessError> {
    let known_force = matches!(options.gauge, Gauge::KnownForce { .. });
    let in_newtons = known_force || matches!(options.reference, Reference::Loaded { .. });
    match options.library.check_unit() {
        Err(error) if !in_newtons => {
            let text = format!("{error}: read only ratios of stiffness and force from the results");
            warnings.push(WarningCode::StiffnessUnusual, text);
            Ok(())
        }
        checked => checked,
    }
}

/// Refuses two postures with the same landmarks, of whichever vertebrae, and a lateral film with the corners of one of them.
///
/// # Errors
/// [`CaseError::FilmRepeated`].
pub fn check_repeated(films: &[Film], lateral: Option<&LateralFilm>) -> Result<(), CaseError> {
    for (i, film) in films.iter().enumerate() {
        let second = film.posture.into();
        if let Some(other) = films[..i].iter().find(|other| same_landmarks(other, film)) {
            return Err(CaseError::FilmRepeated { first: other.posture.into(), second });
        }
        if lateral.is_some_and(|lateral| lateral.has_corners_of(film)) {
            return Err(CaseError::FilmRepeated { first: second, second: FilmView::Lateral });
        }
    }
    Ok(())
}

/// One film per posture, one of them erect, and no film in two postures.
pub(super) fn check_postures(
    films: &[Film],
    lateral: Option<&LateralFilm>,
) -> Result<(), CaseError> {
    for (i, film) in films.iter().enumerate() {
        if films[..i].iter().any(|other| other.posture == film.posture) {
            return Err(CaseError::PostureTwice { posture: film.posture });
        }
    }
    check_repeated(films, lateral)?;
    if films.iter().any(|film| film.posture == Posture::Erect) {
        Ok(())
    } else {
        Err(CaseError::NoErectFilm)
    }
}

/// Sides and planes of the films against one another; the first outline is the erect one.
pub(super) fn check_outlines(
    outlines: &[Outline],
    warnings: &mut Warnings,
) -> Result<(), CaseError> {
    let of = |posture| outlines.iter().find(|outline| outline.posture == posture);
    let erect = &outlines[0];
    if let (Some(left), Some(right)) = (of(Posture::LeftBending), of(Posture::RightBending)) {
        let change = |film: &Outline| film.top().lateral_tilt() - erect.top().lateral_tilt();
        let [left_margin, right_margin] = [left, right].map(|film| tilt_margin(erect, film));
        // If only one is tilted to the wrong side, an exchange makes the other one wrong.
        if change(left) > left_margin && -change(right) > right_margin {
            let [left, right] = [left, right].map(change);
            return Err(CaseError::BendsExchanged { left, right });
        }
    }
    for film in &outlines[1..] {
        if film.scale.plane != erect.scale.plane {
            let planes = [film.scale.plane, erect.scale.plane];
            let how = if planes.contains(&SpacingPlane::Pixels) {
                "the spine is taken to be as long as on the erect film"
            } else {
                "they are compared without conversion"
            };
            let [own, erect] = planes.map(SpacingPlane::unit);
            let text = format!("its lengths are in {own}, and on the erect film in {erect}: {how}");
            warnings.film(WarningCode::SpacingPlanesDiffer, film.posture, text);
        }
    }
    Ok(())
}

/// The length of a spine on a film against the erect one. A scale per film corrects usual differences.
pub(super) fn warn_of_length(film: &Outline, warnings: &mut Warnings) {
    /// Where scales are fixed.
    const MAX_DIFFERENCE: f64 = 0.05;
    let FilmLength { measured, prior_log_sd, scale } = film.length;
    let is_unusual = if film.length.is_free() {
        film.length.is_unusual()
    } else {
        (measured.factor - 1.0).abs() > MAX_DIFFERENCE
    };
    if !is_unusual {
        return;
    }
    let effect = if film.length.is_free() {
        format!(
            "its scale is taken as {}, and the expected standard deviation is {} %",
            fixed(scale.factor, 3),
            fixed(100.0 * prior_log_sd, 1)
        )
    } else {
        "the lengths are compared as marked".to_owned()
    };
    let text = format!(
        "the spine is {} % {} than on the erect film ({effect}): check the spacing of both films, and that they show the same patient",
        fixed(100.0 * (measured.factor - 1.0).abs(), 1),
        if measured.factor > 1.0 { "longer" } else { "shorter" }
    );
    warnings.film(WarningCode::LengthsDiffer, film.posture, text);
}

/// Body widths of one film against the erect film: if every vertebra has the name of its neighbour, the sequence of widths is
/// the same, shifted by one level. A common factor, such as another magnification, makes no difference.
///
/// # References
/// Widths grow unevenly from T4 to L5 [panjabi-1991], [panjabi-1992], so a shifted sequence differs from a scaled one.
pub(super) fn warn_of_shifted_levels(erect: &Film, film: &Film, warnings: &mut Warnings) {
    /// Fewer widths than this would match by chance.
    const MIN_WIDTHS: usize = 8;
    let [reference, widths] = [erect, film].map(|film| body_widths(film, Levels::COMPLETE));
    let compared = reference.iter().zip(&widths).filter(|(a, b)| a.is_some() && b.is_some());
    if compared.count() < MIN_WIDTHS {
        return;
    }
    let misfit = |shift: isize| {
        let logs: Vec<f64> = reference
            .iter()
            .enumerate()
            .filter_map(|(i, erect)| {
                let other = (*widths.get(i.checked_add_signed(shift)?)?)?;
                Some((other / (*erect)?).ln())
            })
            .collect();
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / logs.len() as f64
    };
    for (shift, side) in [(1, "above"), (-1, "below")] {
        // A quarter of the variance is half of the deviation: far above landmark noise.
        if misfit(-shift) < 0.25 * misfit(0) {
            let text = format!(
                "the widths of its vertebrae match the neighbours {side} on the erect film: the names may be shifted by one level"
            );
            warnings.film(WarningCode::LevelsMayBeShifted, film.posture, text);
        }
    }
}

/// Angles that may be too small, with the vertebra that may be the end vertebra.
pub(super) fn warn_of_unmarked_ends(curves: &[ClinicalCurve], warnings: &mut Warnings) {
    for curve in curves {
        for &UnmarkedNeighbour { posture, end, level } in &curve.unmarked {
            let Some(size) = curve.size_in(posture) else { continue };
            let text = format!(
                "the {} curve ends at {end}, and {level} beside it is not marked: its {} of {} may be too small; mark {level} if the film shows it",
                curve.region,
                curve.size_name(),
                size.abs().text(0)
            );
            warnings.vertebra(WarningCode::EndVertebraNotMarked, posture, level, text);
        }
    }
}

/// Notes end vertebrae that were given. Whether every pair encloses the apex of its curve; regions that are not curves have no apex.
pub(super) fn note_given_ends(
    given: &[Option<CobbEnds>; 3],
    curves: &[ClinicalCurve],
    are_curves: bool,
    warnings: &mut Warnings,
) -> bool {
    let mut all_fit = true;
    for (curve, ends) in curves.iter().zip(given) {
        let Some(ends) = ends else { continue };
        let pair = |ends: &CobbEnds| format!("{}/{}", ends.inferior, ends.superior);
        let (own, region, apex) = (pair(ends), curve.region, curve.apex);
        if curve.ends != *ends {
            let used = pair(&curve.ends);
            let text = format!(
                "the erect film does not show both end vertebrae {own} that were given for the {region} curve, so {used} are used"
            );
            warnings.push(WarningCode::EndVertebraeUnusual, text);
            continue;
        }
        let text = format!("the end vertebrae {own} of the {region} curve were given");
        warnings.push(WarningCode::EndVertebraeByHand, text);
        if are_curves && !(ends.inferior..=ends.superior).contains(&apex) {
            all_fit = false;
            let text = format!(
                "the end vertebrae {own} that were given for the {region} curve lie on one side of its apex {apex}. They do not measure this curve, and Lenke's type is left out: give one vertebra below and one above {apex}"
            );
            warnings.push(WarningCode::EndVertebraeUnusual, text);
        }
    }
    all_fit
}

/// Apical rotation for every degree of a curve's size: 22° in curves of about 60° before surgery (assumption).
const ROTATION_PER_DEGREE: f64 = 0.37;
/// Size of a curve below which its vertebrae turn little.
const MIN_TURNING: Angle = Angle::from_deg(20.0);

/// Where a lateral film makes the model one in space, its axial rotation must not be taken for measured.
pub(super) fn warn_of_unknown_rotation(curves: &[ClinicalCurve], warnings: &mut Warnings) {
    let sizes = curves.iter().map(|curve| curve.erect_size().abs());
    let largest = sizes.fold(Angle::ZERO, |most, size| if size > most { size } else { most });
    if largest < MIN_TURNING {
        return;
    }
    let text = format!(
        "no pedicles are marked, so the axial rotation of the vertebrae is not known and is zero in the model: apices of curves of {} usually turn by about {}; mark both pedicles of the vertebrae around the apex",
        largest.text(0),
        (largest * ROTATION_PER_DEGREE).text(0)
    );
    warnings.film(WarningCode::AxialRotationUnknown, Posture::Erect, text);
}
