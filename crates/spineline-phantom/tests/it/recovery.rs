//! The pipeline on films of known truth: results against true values, for all 18 subjects.
//!
//! Readers are exact here, so every difference is due to the method: a polynomial curve, and 14 joints instead of
//! 998 segments.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Grouping, LineModel, analyze};
use spineline::anatomy::Posture;
use spineline::multibody::Support;
use spineline_phantom::{Phantom, Readers, SUBJECTS, Scenario, generate};

const BENDS: [Posture; 2] = [Posture::LeftBending, Posture::RightBending];

/// The truth is a polynomial of degree 6 cut into vertebrae; half a millimetre is about one segment.
const INFLECTION_MM: f64 = 0.5;
/// Half a millimetre on either end of a line of some 150 mm.
const LINE_DEG: f64 = 0.3;
/// Fourteen joints cannot bend exactly as 998 segments, least of all with three multipliers.
const REGIONAL_MM: f64 = 1.0;
const PER_JOINT_MM: f64 = 0.5;
/// The estimated line has three numbers per film, the others have one; it may be worse only by the tolerance
/// of its minimisation.
const ESTIMATED_MARGIN_MM: f64 = 0.3;
/// Minimum number of the 14 joints that turn against a wrong line.
const CONTRADICTED: usize = 3;

/// The phantom of a subject, from 0, with exact readers.
pub fn exact(index: usize, scenario: Scenario) -> Phantom {
    generate(index, scenario, &Readers::exact(), 1).expect("all 18 subjects have phantoms")
}

fn on_a_table(grouping: Grouping) -> AnalysisOptions {
    AnalysisOptions { support: Support::Frontal, grouping, ..Default::default() }
}

fn analyzed(phantom: &Phantom, grouping: Grouping) -> Analysis {
    analyze(&phantom.case, &on_a_table(grouping)).expect("phantoms are sound cases")
}

fn model(analysis: &Analysis, kind: LineKind) -> &LineModel {
    analysis.model(kind).expect("a phantom has every line")
}

/// Mean location error of a usable simulation; infinite without one.
fn error_mm(model: &LineModel, posture: Posture) -> f64 {
    model
        .simulation(posture)
        .filter(|simulation| simulation.is_usable())
        .map_or(f64::INFINITY, |simulation| simulation.shape.mean_location_error_mm())
}

/// Collects errors, so that one run reports all subjects.
#[derive(Default)]
struct Misses(Vec<String>);

impl Misses {
    fn unless(&mut self, fine: bool, what: impl FnOnce() -> String) {
        if !fine {
            self.0.push(what());
        }
    }
}

impl Drop for Misses {
    fn drop(&mut self) {
        assert!(
            self.0.is_empty() || std::thread::panicking(),
            "{} misses:\n{}",
            self.0.len(),
            self.0.join("\n")
        );
    }
}

#[test]
fn inflections_and_lines_of_rod_phantoms_are_found() {
    // Oracle: material points and lines of the chain of 998 segments that made the films.
    let mut misses = Misses::default();
    for index in 0..SUBJECTS.len() {
        let phantom = exact(index, Scenario::Rod);
        let id = &phantom.case.id;
        let analysis = analyzed(&phantom, Grouping::Regional);
        for posture in &analysis.movement.films {
            let name = posture.outline.posture;
            let truth = phantom.posture(name).expect("a true posture");
            let found = posture.inflection_points.expect("inflections in every posture");
            for (found, truth) in found.iter().zip(truth.inflections) {
                let off_mm = found.distance_mm(truth);
                // The rod's curvature jumps with its stiffness, and a polynomial cannot follow: the inflection may
                // be wrong by as much as the curve at the vertebrae.
                let limit_mm = INFLECTION_MM + posture.fit.rmse_mm;
                misses.unless(off_mm <= limit_mm, || {
                    format!(
                        "{id}, {name}: an inflection is {off_mm:.3} mm off, {limit_mm:.3} allowed"
                    )
                });
            }
            let Some(line) = truth.line else { continue };
            let simulation = model(&analysis, LineKind::Inflection).simulation(name);
            let found = simulation.expect("every moved posture is simulated").line;
            let off_deg = found.angle_to(&line).deg();
            misses.unless(off_deg <= LINE_DEG, || format!("{id}, {name}: {off_deg:.3}° off"));
        }
        let erect = phantom.posture(Posture::Erect).expect("a true erect posture");
        let pair = analysis.movement.inflections.pair.expect("two inflections");
        for (found, truth) in pair.iter().zip(erect.inflections) {
            let off_mm = found.erect.distance_mm(truth);
            misses.unless(off_mm <= INFLECTION_MM, || {
                format!("{id}: an inflection of the erect curve is {off_mm:.3} mm off")
            });
        }
    }
}

#[test]
fn the_inflection_line_reproduces_the_bends_of_rod_phantoms() {
    // Oracle: true locations, which exact readers return.
    let mut misses = Misses::default();
    for index in 0..SUBJECTS.len() {
        let phantom = exact(index, Scenario::Rod);
        for (grouping, limit_mm) in
            [(Grouping::Regional, REGIONAL_MM), (Grouping::PerJoint, PER_JOINT_MM)]
        {
            let analysis = analyzed(&phantom, grouping);
            for posture in BENDS {
                let off_mm = error_mm(model(&analysis, LineKind::Inflection), posture);
                misses.unless(off_mm <= limit_mm, || {
                    format!("{}, {posture}, {grouping:?}: {off_mm:.3} mm", phantom.case.id)
                });
            }
        }
    }
}

#[test]
fn pulled_phantoms_support_the_iliac_line_and_not_the_inflection_line() {
    // Oracle: the films were made by a horizontal force at T2.
    let mut misses = Misses::default();
    for index in 0..SUBJECTS.len() {
        let phantom = exact(index, Scenario::Pull);
        let id = &phantom.case.id;
        let analysis = analyzed(&phantom, Grouping::Regional);
        for posture in BENDS {
            let off_mm = error_mm(model(&analysis, LineKind::Iliac), posture);
            misses.unless(off_mm <= REGIONAL_MM, || {
                format!("{id}, {posture}: iliac line {off_mm:.3} mm")
            });
            let simulation = model(&analysis, LineKind::Inflection).simulation(posture);
            let against = simulation.map_or(0, |simulation| simulation.contradicted.len());
            misses.unless(against >= CONTRADICTED, || {
                format!("{id}, {posture}: {against} joints contradict the inflection line")
            });
        }
    }
}

fn estimated_line_is_as_good_as_the_better_other(scenario: Scenario) {
    let mut misses = Misses::default();
    for index in 0..SUBJECTS.len() {
        let phantom = exact(index, scenario);
        let analysis = analyzed(&phantom, Grouping::Regional);
        let mean = |kind| {
            let model = model(&analysis, kind);
            0.5 * (error_mm(model, BENDS[0]) + error_mm(model, BENDS[1]))
        };
        let [estimated, inflection, iliac] =
            [LineKind::Estimated, LineKind::Inflection, LineKind::Iliac].map(mean);
        misses.unless(estimated <= inflection.min(iliac) + ESTIMATED_MARGIN_MM, || {
            format!(
                "{}: estimated {estimated:.3} mm, inflection {inflection:.3} mm, iliac {iliac:.3} mm",
                phantom.case.id
            )
        });
    }
}

#[test]
fn the_estimated_line_is_as_good_as_the_better_other_one_on_rod_phantoms() {
    // Oracle: the estimated line may be either of the others, so its least squares cannot be larger.
    estimated_line_is_as_good_as_the_better_other(Scenario::Rod);
}

#[test]
fn the_estimated_line_is_as_good_as_the_better_other_one_on_bent_phantoms() {
    // Oracle: the estimated line may be either of the others, so its least squares cannot be larger.
    estimated_line_is_as_good_as_the_better_other(Scenario::Bend);
}

#[test]
fn the_estimated_line_is_as_good_as_the_better_other_one_on_pulled_phantoms() {
    // Oracle: the estimated line may be either of the others, so its least squares cannot be larger.
    estimated_line_is_as_good_as_the_better_other(Scenario::Pull);
}
