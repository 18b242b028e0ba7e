//! Cases made from phantoms.

use std::error::Error;

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, LineModel, analyze};
use spineline::anatomy::{Level, Posture};
use spineline::measure::Noise;
use spineline::multibody::{ForceSign, Solution, Statics, Support, match_amplitude};
use spineline::personalize::estimate::JointResponses;
use spineline::personalize::evidence::FilmEvidence;
use spineline::spatial::Vec3;
use spineline_phantom::{Readers, Scenario, generate};

use crate::case::{Bend, Case, CaseNoise, Cases, Joint, Start, Starts, Vertebra};

/// Name, and place in Table 1: main Cobb angles of 46°, 70° and 86°.
const SPINES: [(&str, usize); 3] = [("mild", 2), ("severe", 17), ("extreme", 9)];

const BENDS: [Posture; 2] = [Posture::LeftBending, Posture::RightBending];

const ABOUT: &str = "Synthetic spines. mm, N, N·mm/rad, rad; X anterior, Y left, Z cranial, origin at L4. \
The README of this comparison has the meaning of every field.";

/// All cases.
pub fn cases() -> Result<Cases, Box<dyn Error>> {
    let cases: Result<_, _> = SPINES.iter().map(|&(name, subject)| case(name, subject)).collect();
    Ok(Cases { about: ABOUT.to_owned(), cases: cases? })
}

/// The geometry, lines and forces that an analysis of the phantom found, and bends computed with the phantom's own
/// multipliers, brought to a geometric mean of one.
fn case(name: &str, subject: usize) -> Result<Case, Box<dyn Error>> {
    let phantom = generate(subject, Scenario::Rod, &Readers::exact(), 1)?;
    let options = AnalysisOptions { support: Support::Free, ..Default::default() };
    let analysis = analyze(&phantom.case, &options)?;
    let found = analysis.models.iter().find(|model| model.kind == LineKind::Inflection);
    let found = found.ok_or("the phantom has no inflection line")?;
    let level = phantom.multipliers.iter().product::<f64>().cbrt();
    let [left, right] = BENDS.map(|posture| line(found, posture));
    let nothing = || Start { log_multipliers: [0.0; 3], forces_n: [0.0; 2] };
    let mut case = Case {
        name: name.to_owned(),
        vertebrae: vertebrae(&analysis),
        joints: joints(&analysis, &options),
        regions: analysis.movement.regions.bounds.map(|b| [b.inferior, b.apex, b.superior]),
        multipliers: phantom.multipliers.map(|multiplier| multiplier / level),
        noise: CaseNoise {
            location_mm: Noise::ONE_READING.location_mm,
            tilt_rad: Noise::ONE_READING.tilt.rad(),
        },
        bends: [left?, right?],
        starts: Starts { nominal: nothing(), closed_form: nothing() },
    };
    bend(&mut case);
    case.starts = Starts { nominal: nominal_start(&case), closed_form: closed_form_start(&case) };
    Ok(case)
}

fn vertebrae(analysis: &Analysis) -> Vec<Vertebra> {
    let spine = &analysis.movement.spine;
    let poses = spine.midpoints_mm.iter().zip(&spine.axes);
    Level::MODEL
        .into_iter()
        .zip(poses)
        .map(|(level, (midpoint, axes))| Vertebra {
            level: level.to_string(),
            midpoint_mm: (*midpoint).into(),
            axes: axes.transpose().into(),
        })
        .collect()
}

fn joints(analysis: &Analysis, options: &AnalysisOptions) -> Vec<Joint> {
    let spine = &analysis.movement.spine;
    spine
        .joints
        .iter()
        .zip(options.library.rows())
        .enumerate()
        .map(|(j, (joint, row))| Joint {
            centre_mm: (spine.midpoints_mm[j] + spine.axes[j] * joint.centre_in_inferior_mm).into(),
            stiffness_nmm_per_rad: row.nmm_per_rad,
            region: analysis.movement.regions.of_joint(j).index(),
        })
        .collect()
}

/// The line and force of one bend, turned so that the force is positive.
fn line(found: &LineModel, posture: Posture) -> Result<Bend, Box<dyn Error>> {
    let simulation = found.simulation(posture).ok_or("the phantom has both bends")?;
    let (line, sign) = (simulation.line, simulation.force_n.signum());
    Ok(Bend {
        point_mm: [simulation.depth_mm, line.point.y_mm, line.point.z_mm],
        direction: [0.0, sign * line.direction.y_mm, sign * line.direction.z_mm],
        force_n: simulation.force_n.abs(),
        lean_rad: 0.0,
        locations_mm: Vec::new(),
        tilts_rad: Vec::new(),
    })
}

/// Fills in the shapes that the forces make with the true springs.
fn bend(case: &mut Case) {
    let (model, library, groups) = (case.model(), case.library(), case.groups());
    let logs = case.log_multipliers();
    let statics = Statics::new(&model, &library, &groups, &logs, Support::Free);
    let mut solution = Solution::default();
    for bend in &mut case.bends {
        statics.solve(&bend.load(), &[bend.force_n], &[], &mut solution);
        let shape = &solution.deformed;
        let all = 0..shape.midpoints_mm.len();
        bend.lean_rad = shape.lateral_tilt().rad();
        bend.tilts_rad = all.clone().map(|i| shape.tilt(i).rad()).collect();
        bend.locations_mm =
            all.map(|i| shape.location(i)).map(|location| [location.y_mm, location.z_mm]).collect();
    }
}

/// Nominal springs, and the forces with which they reach both leans.
fn nominal_start(case: &Case) -> Start {
    let (model, library, groups) = (case.model(), case.library(), case.groups());
    let statics = Statics::new(&model, &library, &groups, &[0.0; 3], Support::Free);
    let forces_n = case.bends.each_ref().map(|bend| {
        match_amplitude(&statics, &bend.load(), ForceSign::Positive, bend.lateral_tilt()).force_n
    });
    Start { log_multipliers: [0.0; 3], forces_n }
}

/// Springs and forces from the measured rotations and lever arms of every region: each gives a slope `F / α`.
///
/// A region whose rotations contradict a line tells nothing there, and takes part in no mean.
fn closed_form_start(case: &Case) -> Start {
    let (model, library, groups) = (case.model(), case.library(), case.groups());
    let erect = case.erect();
    let slopes: [[f64; 3]; 2] = std::array::from_fn(|i| {
        let evidence = FilmEvidence::measure(&model, &library, &erect, &case.bend(i));
        let sums = JointResponses::to(&case.bends[i].load(), &evidence).turns(&Vec3::x(), &groups);
        std::array::from_fn(|region| (sums[region].0 / sums[region].1).ln())
    });
    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let told: Vec<f64> = values.filter(|value| value.is_finite()).collect();
        told.iter().sum::<f64>() / told.len().max(1) as f64
    };
    let levels = slopes.map(|film| mean(&mut film.into_iter()));
    Start {
        log_multipliers: std::array::from_fn(|region| {
            mean(&mut (0..2).map(|film| levels[film] - slopes[film][region]))
        }),
        forces_n: levels.map(f64::exp),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::Fit;

    #[test]
    fn a_fit_to_a_case_as_written_finds_its_multipliers() {
        // Oracle: the phantom's multipliers, with which the bends were computed.
        let text =
            serde_json::to_string(&cases().expect("phantoms are sound")).expect("plain data");
        let cases: Cases = serde_json::from_str(&text).expect("what was written can be read");
        assert_eq!(cases.cases.len(), SPINES.len());
        for case in cases.cases {
            let found = Fit::of(&case).run();
            for (log, multiplier) in found.log_multipliers.iter().zip(case.multipliers) {
                assert!((log.exp() - multiplier).abs() < 1e-4, "{}: {multiplier}", case.name);
            }
        }
    }
}
