//! Films that do not show what they are named after: another posture, the same film twice, or another patient.

use crate::anatomy::{Levels, Posture, Side};
use crate::measure::{Film, FilmLandmarks, Outline, body_shapes};
use crate::spatial::Angle;
use crate::warning::{Step, Warning, Warnings};

/// Largest lateral tilt of the line from L4 to T2 on an erect film, to the film's vertical or to the iliac normal.
///
/// Of 433 erect films of [wu-boostnet-2017] without a known fault of their landmarks, 1 % exceed 9.6°, and the largest
/// has 14.2°.
const MAX_ERECT_TILT: Angle = Angle::from_deg(15.0);

/// A bend whose tilts differ from those of the erect film by less than this shows no bend.
///
/// Root mean square over L4 to T2, about the mean. In 30 bends of 15 patients, measured on midlines of the back, the
/// smallest is 3.8°.
const MIN_BEND_DIFFERENCE: Angle = Angle::from_deg(3.0);

/// The same for any two films, in standard deviations of the difference of two tilts: with 14 degrees of freedom, noise
/// alone stays below it with a probability of 0.999.
const MAX_NOISE_FACTOR: f64 = 1.6;

/// Least change of the lateral tilt of L4 to T2 towards the side of a bend; the smallest of the same 30 bends is 5.6°.
const MIN_BEND_TILT: Angle = Angle::from_deg(3.0);

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

/// Codes of warnings that a film does not show what it is named after.
pub(crate) const WRONG_FILM: [&str; 10] = [
    "another_patient",
    "bend_keeps_shape",
    "bend_leans_away",
    "bend_leans_little",
    "erect_leans",
    "film_looks_mirrored",
    "films_show_one_shape",
    "levels_may_be_shifted",
    "other_body_part",
    "patient_differs",
];

/// Whether a warning says that a film does not show what it is named after.
pub(super) fn doubts_film(warning: &Warning) -> bool {
    WRONG_FILM.contains(&warning.code)
}

/// Films and their outlines in the same order, the erect one first.
///
/// The lateral tilt of the erect spine is checked on patients only: that of phantoms of the paper's Table 1 is up to 45° by construction.
pub(super) fn warn_of_wrong_films(
    (films, is_synthetic): (&[&Film], bool),
    outlines: &[Outline],
    warnings: &mut Warnings,
) {
    let Some((erect, others)) = outlines.split_first() else { return };
    if !is_synthetic {
        warn_of_leaning_erect(erect, warnings);
    }
    for film in others {
        match film.posture.bend() {
            Some(side) => warn_of_no_bend(erect, film, side, warnings),
            // An assumed noise may be far above that of these readings, and a neutral film may differ by less.
            None if erect.noise.is_measured() && film.noise.is_measured() => {
                warn_of_one_shape(erect, film, warnings);
            }
            None => {}
        }
    }
    for (i, film) in others.iter().enumerate() {
        for other in &others[..i] {
            warn_of_one_shape(other, film, warnings);
        }
    }
    if let Some((erect, others)) = films.split_first() {
        for film in others {
            warn_of_another_patient(erect, film, warnings);
        }
    }
}

/// A film may be turned as a whole, so that the smaller of the two angles counts where the iliac crests are marked.
fn warn_of_leaning_erect(erect: &Outline, warnings: &mut Warnings) {
    let on_film = (line_tilt(erect) + erect.l4_on_film).wrapped();
    let against_crests = erect.iliac_normal.map(|_| erect.amplitude());
    let tilt = match against_crests {
        Some(tilt) if tilt.abs() < on_film.abs() => tilt,
        _ => on_film,
    };
    if tilt.abs() > MAX_ERECT_TILT {
        let text = format!(
            "the lateral tilt of the line from {} to {} is {} (limit {:.0}°): check that the film shows the erect posture and is not turned",
            erect.levels().base(),
            erect.levels().top(),
            tilt.leaning(),
            MAX_ERECT_TILT.deg()
        );
        warnings.film(Step::Measure, "erect_leans", erect.posture, text);
    }
}

fn warn_of_no_bend(erect: &Outline, bend: &Outline, side: Side, warnings: &mut Warnings) {
    // A true bend may come near the mirror image: among the same 30 bends one does to 2.8°.
    let noise = noise_limit(erect, bend);
    let limit = noise.max(MIN_BEND_DIFFERENCE.rad());
    for (sign, shape, limit) in [(1.0, "erect shape", limit), (-1.0, "mirrored erect shape", noise)]
    {
        let difference = shape_difference(erect, bend, sign);
        if difference < limit {
            let text = format!(
                "it shows the {shape}: the tilts of its vertebrae differ by {:.1}° in the root mean square (limit {:.1}°): check that it is the film of the bend and carries its own landmarks",
                Angle::from_rad(difference).deg(),
                Angle::from_rad(limit).deg()
            );
            warnings.film(Step::Measure, "bend_keeps_shape", bend.posture, text);
            return;
        }
    }
    let change = line_tilt(bend) - line_tilt(erect);
    let towards = match side {
        Side::Left => -change,
        Side::Right => change,
    };
    // Further away than noise is a warning of its own.
    if towards.abs() < MIN_BEND_TILT && !doubted(warnings, "bend_leans_away", bend.posture) {
        let text = format!(
            "the lateral tilt of {} to {} changes by only {:.1}° from the erect film (limit {:.0}°): check that the film shows a bend",
            erect.levels().base(),
            erect.levels().top(),
            towards.abs().deg(),
            MIN_BEND_TILT.deg()
        );
        warnings.film(Step::Measure, "bend_leans_little", bend.posture, text);
    }
}

fn doubted(warnings: &Warnings, code: &str, posture: Posture) -> bool {
    warnings.all().iter().any(|one| one.code == code && one.posture == Some(posture))
}

/// Two postures of equal shape are most likely one film, read twice.
fn warn_of_one_shape(first: &Outline, second: &Outline, warnings: &mut Warnings) {
    let limit = noise_limit(first, second);
    let difference = shape_difference(first, second, 1.0);
    if difference < limit {
        let text = format!(
            "it shows the shape of the {} film: the tilts of its vertebrae differ by {:.1}° in the root mean square, which is within landmark noise (limit {:.1}°): check that the two are not one film",
            first.posture,
            Angle::from_rad(difference).deg(),
            Angle::from_rad(limit).deg()
        );
        warnings.film(Step::Measure, "films_show_one_shape", second.posture, text);
    }
}

fn line_tilt(outline: &Outline) -> Angle {
    outline.vertebrae[outline.vertebrae.len() - 1].location.lateral_tilt()
}

/// In rad.
fn noise_limit(a: &Outline, b: &Outline) -> f64 {
    let [a, b] = [a, b].map(|outline| outline.noise_over(&outline.vertebrae).tilt.rad());
    MAX_NOISE_FACTOR * a.hypot(b)
}

/// Root mean square of the differences of tilts about their mean, in rad: a lateral tilt of the whole patient makes no difference.
/// The first film is mirrored with a sign of -1.
fn shape_difference(a: &Outline, b: &Outline, sign: f64) -> f64 {
    let differences: Vec<f64> = a
        .vertebrae
        .iter()
        .zip(&b.vertebrae)
        .map(|(a, b)| b.tilt.rad() - sign * a.tilt.rad())
        .collect();
    let count = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / count;
    let squares: f64 = differences.iter().map(|one| (one - mean).powi(2)).sum();
    (squares / (count - 1.0)).sqrt()
}

/// Bodies of one film against those of the erect one. A common factor, such as another magnification, makes no difference.
fn warn_of_another_patient(erect: &Film, film: &Film, warnings: &mut Warnings) {
    // Without a spacing, heights and widths are comparable in square pixels only.
    let scaled = |film: &Film| matches!(&film.landmarks, FilmLandmarks::Corners { image, .. } if image.scale().is_some());
    if scaled(erect) != scaled(film) {
        return;
    }
    let [reference, bodies] = [erect, film].map(|film| body_shapes(film, Levels::COMPLETE));
    let seen: Vec<_> = reference.into_iter().zip(bodies).filter_map(|(a, b)| a.zip(b)).collect();
    // A median of few bodies says little.
    if seen.len() < MIN_BODIES {
        return;
    }
    let logs = |of: &dyn Fn([f64; 2]) -> f64| -> Vec<f64> {
        seen.iter().map(|(a, b)| (of(*b) / of(*a)).ln()).collect()
    };
    let [heights, widths] = [logs(&|[height, _]| height), logs(&|[_, width]| width)];
    let width = median(widths.clone());
    let ratio = (median(heights) - width).exp();
    let deviation = median(widths.iter().map(|log| (log - width).abs()).collect());
    let found = if ratio.max(1.0 / ratio) > MAX_SHAPE_RATIO {
        format!(
            "its vertebral bodies are {ratio:.2} times as high for their width as on the erect film (limits {:.2} and {MAX_SHAPE_RATIO})",
            1.0 / MAX_SHAPE_RATIO
        )
    } else if deviation > MAX_WIDTH_DEVIATION {
        format!(
            "the widths of its vertebral bodies grow differently from those of the erect film (median deviation {:.0} %, limit {:.0} %)",
            100.0 * deviation,
            100.0 * MAX_WIDTH_DEVIATION
        )
    } else {
        return;
    };
    let text = format!(
        "{found}: check that both films show the same patient, and the spacing of their rows and columns"
    );
    warnings.film(Step::Measure, "another_patient", film.posture, text);
}

/// Median of at least one value, all finite.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 {
        values[middle]
    } else {
        f64::midpoint(values[middle - 1], values[middle])
    }
}
