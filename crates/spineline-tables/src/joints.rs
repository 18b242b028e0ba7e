use spineline::action::LineKind;
use spineline::analysis::FilmMovement;
use spineline::anatomy::Level;
use spineline::evaluate::Simulation;
use spineline::personalize::evidence::{ContradictedJoint, JointEvidence};

use crate::Patient;
use crate::define::{Column, Row, Unit, keyed, number, text, truth};
use crate::table::Table;
use crate::vertebrae::simulations;

/// A joint on a film, and under one line of action.
pub(crate) struct Joint<'a> {
    posture: &'a FilmMovement,
    inferior: Level,
    superior: Level,
    evidence: &'a JointEvidence,
    simulated: Option<(LineKind, &'a Simulation)>,
}

impl Joint<'_> {
    fn contradicted(&self) -> Option<&ContradictedJoint> {
        let (_, simulation) = self.simulated?;
        simulation
            .contradicted
            .iter()
            .find(|joint| (joint.inferior, joint.superior) == (self.inferior, self.superior))
    }
}

type JointRow<'a> = Row<'a, Joint<'a>>;

/// One row per patient, moved posture, line and joint; of a posture without a model, one per joint.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let mut rows: Vec<JointRow<'_>> = Vec::new();
    for patient in patients {
        for posture in &patient.analysis.movement.films {
            let Some(evidence) = &posture.evidence else { continue };
            for simulated in simulations(patient.analysis, posture) {
                let pairs = evidence.levels.joint_pairs();
                for ([inferior, superior], evidence) in pairs.zip(&evidence.joints) {
                    let item = Joint { posture, inferior, superior, evidence, simulated };
                    rows.push(patient.row(item));
                }
            }
        }
    }
    let row = "patient × moved posture × line × joint; measured values are repeated in the rows of every line, and `line` is empty without a model";
    keyed("joints", row, [columns_of_joints()]).fill(&rows)
}

fn columns_of_joints<'a>() -> Vec<Column<JointRow<'a>>> {
    vec![
        text("posture", "film", |row| Some(row.item.posture.outline.posture.key().to_owned())),
        text("line", "line of action of the model", |row| {
            row.item.simulated.map(|(kind, _)| kind.key().to_owned())
        }),
        text("inferior", "lower vertebra", |row| Some(row.item.inferior.to_string())),
        text("superior", "upper vertebra", |row| Some(row.item.superior.to_string())),
        number(
            "rotation",
            Unit::Degrees,
            "measured change of the tilt of the upper vertebra relative to the lower one from the erect film; positive to the patient's right",
            |row| Some(row.item.evidence.rotation.deg()),
        ),
        truth(
            "contradicted",
            "whether the joint turns against the moment of the force (counter-rotating joint): no positive stiffness explains it",
            |row| row.item.simulated.map(|_| row.item.contradicted().is_some()),
        ),
        number(
            "lever_arm",
            Unit::Millimetres,
            "lever arm of the force about a counter-rotating joint",
            |row| row.item.contradicted().map(|joint| joint.lever_arm_mm),
        ),
        number(
            "work_against",
            Unit::One,
            "share of a counter-rotating joint in the work of all joints",
            |row| row.item.contradicted().map(|joint| joint.weight),
        ),
        truth(
            "beyond_noise",
            "whether the rotation of a counter-rotating joint exceeds two standard deviations",
            |row| row.item.contradicted().map(|joint| joint.beyond_noise),
        ),
    ]
}
