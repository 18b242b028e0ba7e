//! The force that brings T2 nearest to a place, beside a march in very small steps that looks everywhere.

use crate::common::{Draw, spine};
use spineline::action::{Application, LineOfAction};
use spineline::multibody::{
    ForceSign, Load, Parameter, PathEnding, Solution, SpineModel, Statics, Support, match_t2,
};
use spineline::spatial::{Angle, Frontal};

/// T2 moves by less from one look of the scan to the next.
const STEP_MM: f64 = 0.1;
/// Distances that differ by less are equally good.
const TOLERANCE_MM: f64 = 1.0;
const MAX_HINGE_RAD: f64 = 0.8;

/// Every least distance of T2 along the path of one sign, with its force, and the least of all shapes; nothing where the
/// path is lost or leaps.
fn scan(
    statics: &Statics<'_>,
    load: &Load,
    (sign, largest_n): (f64, f64),
    place: Frontal,
) -> Option<(Vec<[f64; 2]>, f64)> {
    let top = statics.model().midpoints_mm.len() - 1;
    let mut solution = Solution::default();
    let (mut force_n, mut looks, mut least_mm) = (0.0, Vec::new(), f64::INFINITY);
    let mut last: Option<Frontal> = None;
    loop {
        statics.solve(load, &[force_n], &[Parameter::Load(0)], &mut solution);
        let t2 = solution.deformed.location(top);
        if !solution.converged || last.is_some_and(|last| last.distance_mm(t2) > 2.0 * STEP_MM) {
            return None;
        }
        last = Some(t2);
        if solution.deformed.largest_hinge_rad() > MAX_HINGE_RAD {
            break;
        }
        least_mm = least_mm.min(t2.distance_mm(place));
        if force_n.abs() >= largest_n {
            break;
        }
        looks.push([force_n, t2.distance_mm(place)]);
        let rate = solution.location_rate(0, top).norm_mm();
        let step_n = (STEP_MM / rate).min(1.0).min(0.01 / solution.fastest_turn(0));
        force_n = sign * (force_n.abs() + step_n).min(largest_n);
    }
    let is_least = |three: &&[[f64; 2]]| three[1][1] < three[0][1] && three[1][1] <= three[2][1];
    Some((looks.windows(3).filter(is_least).map(|three| three[1]).collect(), least_mm))
}

fn line(draw: &mut Draw, model: &SpineModel) -> LineOfAction {
    let t2 = model.midpoints_mm[model.midpoints_mm.len() - 1];
    // Steep ones buckle: T2 hardly moves at first, and then fast.
    let tilt = Angle::from_deg(draw.between(-100.0, 100.0));
    let place = Frontal::new(t2.y + draw.between(-60.0, 60.0), t2.z * draw.between(0.3, 1.0));
    let line = LineOfAction::leaning(place, tilt);
    let application = if draw.below(2) == 0 { Application::Fixed } else { Application::AtT2 };
    LineOfAction { application, ..line }
}

#[test]
fn no_nearer_place_and_no_smaller_force_is_missed() {
    // Oracle: the scan. Distances agree to a step's square over the distance; forces that are about equally good may differ.
    let mut draw = Draw::new(5);
    let (mut matched, mut none, mut lost) = (0, 0, 0);
    for problem in 0..80 {
        let (_, model) = spine(draw.below(3));
        let rows: Vec<[f64; 3]> =
            (0..14).map(|_| [1.3e5, 1.3e5, 2e5].map(|k| k * draw.between(0.3, 2.0))).collect();
        let support = if draw.below(2) == 0 { Support::Free } else { Support::Frontal };
        let statics = Statics::from_stiffness(&model, rows, &[0; 14], support);
        let load = Load::along(line(&mut draw, &model), 0.0);
        let t2 = model.midpoints_mm[14];
        let place =
            Frontal::new(t2.y + draw.between(-120.0, 120.0), t2.z - draw.between(0.0, 80.0));
        let largest_n = 1500.0 / 144_000.0 * statics.mean_lateral_nmm_per_rad();
        let scans = [1.0, -1.0].map(|sign| scan(&statics, &load, (sign, largest_n), place));
        let [Some((mut minima, a)), Some((others, b))] = scans else {
            lost += 1;
            continue;
        };
        minima.extend(others);
        let enough_mm = a.min(b) + TOLERANCE_MM;
        let found = match_t2(&statics, &load, &ForceSign::ALL, place);
        let smallest = minima
            .iter()
            .filter(|[_, gap_mm]| *gap_mm <= enough_mm)
            .min_by(|a, b| a[0].abs().total_cmp(&b[0].abs()));
        match smallest {
            Some([force_n, gap_mm]) => {
                matched += 1;
                assert_eq!(found.status, PathEnding::Converged, "{problem}");
                let left_mm = found.residual.distance_mm().expect("a distance");
                assert!((left_mm - gap_mm).abs() < STEP_MM, "{problem}: {gap_mm} mm");
                assert!((found.force_n - force_n).abs() <= 2.0, "{problem}: {force_n} N");
            }
            None => {
                none += 1;
                assert_eq!(found.status, PathEnding::Unreachable, "{problem}");
                let left_mm = found.residual.distance_mm().expect("a distance");
                assert!(left_mm > a.min(b) - STEP_MM, "{problem}");
            }
        }
    }
    assert!(matched >= 70 && none >= 1 && lost <= 5, "{matched} {none} {lost}");
}
