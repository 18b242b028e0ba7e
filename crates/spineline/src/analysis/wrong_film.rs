//! Films that do not show what they are named after: another posture, the same film twice, or another patient.

use super::film_likelihood::{FilmDifference, Taken, is_clear};
use crate::anatomy::{Level, Levels, Side};
use crate::evaluate::statistics::Summary;
use crate::measure::{Film, FilmLandmarks, Outline, body_shapes, median};
use crate::number::fixed;
use crate::spatial::Angle;
use crate::warning::{WarningCode, Warnings};

/// Largest lateral tilt of the line from L4 to T2 on an erect film, to the film's vertical or to the iliac normal.
///
/// Of 433 erect films of [wu-boostnet-2017] without a known fault of their landmarks, 1 % exceed 9.6°, and the largest
/// has 14.2°.
const MAX_ERECT_TILT: Angle = Angle::from_deg(15.0);

/// Least change of the lateral tilt of L4 to T2 towards the side of a bend; the smallest of 30 bends of 15 patients, measured on midlines
/// of the back, is 5.6°.
const MIN_BEND_TILT: Angle = Angle::from_deg(3.0);

/// A bend that is tilted away by more is most likely one to the other side.
///
/// Of bends to the stated side 3 % are tilted away, by 4° in the mean; bends to the other side by 5 to 40°, uniformly (assumptions:
/// from here on, the second is 20 times as probable).
const MAX_LEANING_AWAY: Angle = Angle::from_deg(7.0);

/// Bodies that both films must show before they are compared.
const MIN_BODIES: usize = 8;

/// Ratio of two films' medians of height over width of the bodies, above which the films may show two patients.
///
/// In 366 pairs of films of one patient of [wu-boostnet-2017] 3 exceed it; in 20 000 pairs of two patients 10 %.
const MAX_SHAPE_RATIO: f64 = 1.35;

/// Median deviation of the logarithm of the widths' ratios from their median, above which films may show two patients.
///
/// In the same 366 pairs of one patient the largest is 0.176; 1 % of the pairs of two patients exceed the limit.
const MAX_WIDTH_DEVIATION: f64 = 0.18;

/// Both limits of bodies are widened by this number of standard deviations of corners that a program found.
const PROGRAM_FACTOR: f64 = 2.0;

/// Films and their outlines in the same order, the erect one first.
///
/// The lateral tilt of the erect spine is checked on patients only: phantoms of the paper's Table 1 have up to 45° by construction.
pub(super) fn warn_of_wrong_films(
    films: &[&Film],
    outlines: &[Outline],
    is_synthetic: bool,
    warnings: &mut Warnings,
) {
    let Some((erect, others)) = outlines.split_first() else { return };
    if !is_synthetic {
        warn_of_leaning_erect(erect, warnings);
    }
    for (i, film) in others.iter().enumerate() {
        match film.posture.bend() {
            Some(side) => warn_of_no_bend(erect, film, side, warnings),
            None => warn_of_rest(erect, film, warnings),
        }
        for other in &others[..i] {
            warn_of_one_picture(other, film, warnings);
        }
    }
    if let Some((first, films)) = films.split_first() {
        for (film, outline) in films.iter().zip(others) {
            warn_of_another_patient([first, film], [erect, outline], warnings);
        }
    }
}

/// A film may be turned as a whole, so that the smaller of the two angles counts where the iliac crests are marked.
fn warn_of_leaning_erect(erect: &Outline, warnings: &mut Warnings) {
    let on_film = (erect.top().lateral_tilt() + erect.l4_on_film).wrapped();
    let against_crests = erect.iliac_normal.map(|normal| erect.top().lateral_tilt() - normal);
    let tilt = match against_crests {
        Some(tilt) if tilt.abs() < on_film.abs() => tilt,
        _ => on_film,
    };
    if tilt.abs() > MAX_ERECT_TILT {
        let text = format!(
            "the lateral tilt of the line from {} to {} is {} (limit {}): check that the film shows the erect posture and is not turned",
            erect.levels().base(),
            erect.levels().top(),
            tilt.leaning(),
            MAX_ERECT_TILT.text(0)
        );
        warnings.film(WarningCode::ErectLeans, erect.posture, text);
    }
}

/// A film at rest that is the erect film, or a mirror image.
fn warn_of_rest(erect: &Outline, film: &Outline, warnings: &mut Warnings) {
    if !warn_of_one_picture(erect, film, warnings) && is_mirrored(erect, film) {
        let text = "the spine has the shape of the mirrored erect spine: check `patient_left` of this film and of the erect film";
        warnings.film(WarningCode::FilmLooksMirrored, film.posture, text);
    }
}

/// A bend whose film shows the erect shape, a mirror image, or a bend to the other side.
fn warn_of_no_bend(erect: &Outline, bend: &Outline, side: Side, warnings: &mut Warnings) {
    let as_stated = FilmDifference::between(erect, bend, Taken::AsStated).log_odds_of_no_bend();
    let mirrored =
        || FilmDifference::between(erect, bend, Taken::Mirrored).log_odds_of_one_picture();
    let shape = if is_clear(as_stated) {
        Some(("erect shape", 1.0))
    } else {
        is_clear(mirrored()).then_some(("mirrored erect shape", -1.0))
    };
    if let Some((shape, sign)) = shape {
        let text = format!(
            "it shows the {shape}: the tilts of its vertebrae differ by {} in the root mean square, as two readings of one film do: check that it is the film of the bend and carries its own landmarks",
            shape_difference(erect, bend, sign)
        );
        warnings.film(WarningCode::BendKeepsShape, bend.posture, text);
        return;
    }
    let change = bend.top().lateral_tilt() - erect.top().lateral_tilt();
    let towards = match side {
        Side::Left => -change,
        Side::Right => change,
    };
    let ends = format!("{} to {}", bend.levels().base(), bend.levels().top());
    let leans_away = -towards > tilt_margin(erect, bend);
    let is_mirrored = is_mirrored(erect, bend);
    if leans_away && (is_mirrored || -towards > MAX_LEANING_AWAY) {
        let text = format!(
            "the lateral tilt of {ends} is {} of the erect film's: the film may be mirrored or may show another posture",
            change.leaning()
        );
        warnings.film(WarningCode::BendLeansAway, bend.posture, text);
    } else if is_mirrored {
        let text = "its shape is nearer to a bend of the mirrored spine: check `patient_left` of this film and of the erect film";
        warnings.film(WarningCode::FilmLooksMirrored, bend.posture, text);
    } else if towards < MIN_BEND_TILT {
        let text = format!(
            "the lateral tilt of {ends} changes by {towards} towards the side of the bend from the erect film (usual: {} or more): check that the film shows a bend",
            MIN_BEND_TILT.text(0)
        );
        warnings.film(WarningCode::BendLeansLittle, bend.posture, text);
    }
}

/// Whether the mirror image of a film is clearly more probable than the film.
fn is_mirrored(erect: &Outline, film: &Outline) -> bool {
    let [as_stated, mirrored] = [Taken::AsStated, Taken::Mirrored].map(|taken| {
        let difference = FilmDifference::between(erect, film, taken);
        difference.log_density_of_posture(film.posture.bend())
    });
    is_clear(mirrored - as_stated)
}

/// Whether two postures are most likely one film, read twice.
fn warn_of_one_picture(first: &Outline, second: &Outline, warnings: &mut Warnings) -> bool {
    let difference = FilmDifference::between(first, second, Taken::AsStated);
    let is_one = is_clear(difference.log_odds_of_one_picture());
    if is_one {
        let text = format!(
            "it shows the shape of the {} film: the tilts of its vertebrae differ by {} in the root mean square, as two readings of one film do: check that the two are not one film",
            first.posture,
            shape_difference(first, second, 1.0)
        );
        warnings.film(WarningCode::FilmsShowOneShape, second.posture, text);
    }
    is_one
}

/// Change of the lateral tilt of L4 to T2 between two films that noise explains: three standard deviations of the difference of two
/// tilts of L4, in whose frame it is measured, and at least 2°.
pub(super) fn tilt_margin(a: &Outline, b: &Outline) -> Angle {
    const LEAST: Angle = Angle::from_deg(2.0);
    let [a, b] = [a, b].map(|film| film.noise_of(&film.vertebrae[0]).tilt.rad());
    let noise = Angle::from_rad(3.0 * a.hypot(b));
    if noise > LEAST { noise } else { LEAST }
}

/// Root mean square of the differences of tilts about their mean: a lateral tilt of the whole patient makes no difference.
/// The first film is mirrored with a sign of -1.
fn shape_difference(a: &Outline, b: &Outline, sign: f64) -> String {
    let differences: Vec<f64> = a
        .vertebrae
        .iter()
        .zip(&b.vertebrae)
        .map(|(a, b)| b.tilt.deg() - sign * a.tilt.deg())
        .collect();
    format!("{}°", fixed(Summary::of(&differences).sd, 1))
}

/// Bodies of one film against the erect film. A common factor, such as another magnification, makes no difference.
///
/// Corners that a program found, such as those completed from two clicks, add noise, which widens the limits.
fn warn_of_another_patient(films: [&Film; 2], outlines: [&Outline; 2], warnings: &mut Warnings) {
    // Without a spacing, heights and widths are comparable in square pixels only.
    let scaled = |film: &Film| matches!(&film.landmarks, FilmLandmarks::Corners { image, .. } if image.scale().is_some());
    if scaled(films[0]) != scaled(films[1]) {
        return;
    }
    let [reference, bodies] = films.map(|film| body_shapes(film, Levels::COMPLETE));
    let pairs = Levels::COMPLETE.iter().zip(reference.into_iter().zip(bodies));
    let marked: Vec<(Level, [[f64; 2]; 2])> =
        pairs.filter_map(|(level, (a, b))| Some((level, [a?, b?]))).collect();
    // A median of few bodies is not reliable.
    if marked.len() < MIN_BODIES {
        return;
    }
    let logs = |of: &dyn Fn([f64; 2]) -> f64| -> Vec<f64> {
        marked.iter().map(|(_, [a, b])| (of(*b) / of(*a)).ln()).collect()
    };
    let [heights, widths] = [logs(&|[height, _]| height), logs(&|[_, width]| width)];
    let width = median(widths.clone());
    let ratio = (median(heights) - width).exp();
    let deviation = median(widths.iter().map(|log| (log - width).abs()).collect());
    let [height_sd, width_sd] = [0, 1].map(|side| program_log_sd(outlines, &marked, side));
    // Corners of one film that a program found err alike, so a median of many is not surer than one.
    let max_ratio = MAX_SHAPE_RATIO * (PROGRAM_FACTOR * height_sd.hypot(width_sd)).exp();
    let max_deviation = MAX_WIDTH_DEVIATION + PROGRAM_FACTOR * width_sd;
    let found = if ratio.max(1.0 / ratio) > max_ratio {
        format!(
            "its vertebral bodies are {} times as high for their width as on the erect film (limits {} and {})",
            fixed(ratio, 2),
            fixed(1.0 / max_ratio, 2),
            fixed(max_ratio, 2)
        )
    } else if deviation > max_deviation {
        format!(
            "the widths of its vertebral bodies grow differently than on the erect film (median deviation {} %, limit {} %)",
            fixed(100.0 * deviation, 0),
            fixed(100.0 * max_deviation, 0)
        )
    } else {
        return;
    };
    let text = format!(
        "{found}: check that both films show the same patient, and the spacing of their rows and columns"
    );
    warnings.film(WarningCode::AnotherPatient, films[1].posture, text);
}

/// Root mean square, over the bodies, of the errors that corners by a program add to the logarithm of a height (side 0) or a
/// width (side 1) in either film.
fn program_log_sd(outlines: [&Outline; 2], marked: &[(Level, [[f64; 2]; 2])], side: usize) -> f64 {
    // The mean of two opposite sides, with four corners, has the error of one corner.
    let square = |outline: &Outline, level: Level, size: f64| {
        let program = outline.vertebra(level).and_then(|vertebra| vertebra.program);
        let corner = |location_mm: f64| 2.0 * location_mm * outline.scale.units_per_mm;
        program.map_or(0.0, |noise| (corner(noise.location_mm) / size).powi(2))
    };
    let of_pair = |(level, sizes): &(Level, [[f64; 2]; 2])| -> f64 {
        outlines.iter().zip(sizes).map(|(outline, size)| square(outline, *level, size[side])).sum()
    };
    (marked.iter().map(of_pair).sum::<f64>() / marked.len() as f64).sqrt()
}
