use spineline::action::LineKind;
use spineline::analysis::FilmMovement;
use spineline::anatomy::Level;
use spineline::evaluate::Simulation;
use spineline::personalize::evidence::{ContradictedJoint, JointEvidence};

use crate::Patient;
use crate::define::{Columns, Row, keyed, rows};
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
        let (_, simulation) = self.simulated.filter(|(_, one)| one.is_usable())?;
        simulation
            .contradicted
            .iter()
            .find(|joint| (joint.inferior, joint.superior) == (self.inferior, self.superior))
    }
}

/// One row per patient, moved posture, line and joint; of a posture without a model, one per joint.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| {
        let mut all = Vec::new();
        for posture in &patient.analysis.movement.films {
            let Some(evidence) = &posture.evidence else { continue };
            for simulated in simulations(patient.analysis, posture) {
                let pairs = evidence.levels.joint_pairs();
                for ([inferior, superior], evidence) in pairs.zip(&evidence.joints) {
                    all.push(Joint { posture, inferior, superior, evidence, simulated });
                }
            }
        }
        all
    });
    let row = "patient × moved posture × line × joint; measured values are repeated in the rows of every line, and `line` is empty without a model";
    keyed("joints", row, &rows, columns_of_joints)
}

fn columns_of_joints(add: &mut Columns<'_, Row<'_, Joint<'_>>>) {
    add.text("posture", "film", |row| row.posture.outline.posture.key());
    add.text("line", "line of action of the model", |row| {
        row.simulated.map(|(kind, _)| kind.key())
    });
    add.text("inferior", "lower vertebra", |row| row.inferior.to_string());
    add.text("superior", "upper vertebra", |row| row.superior.to_string());
    add.number(
        "rotation_deg",
        "measured change of the tilt of the upper vertebra relative to the lower one from the erect film; positive to the patient's right",
        |row| row.evidence.rotation.deg(),
    );
    add.truth(
        "contradicted",
        "whether the joint turns against the moment of the force (counter-rotating joint): no positive stiffness explains it",
        |row| {
            let (_, simulation) = row.simulated?;
            simulation.is_usable().then(|| row.contradicted().is_some())
        },
    );
    add.number("lever_arm_mm", "lever arm of the force about a counter-rotating joint", |row| {
        row.contradicted().map(|joint| joint.lever_arm_mm)
    });
    add.number(
        "work_against",
        "share of a counter-rotating joint in the work of all joints",
        |row| row.contradicted().map(|joint| joint.weight),
    );
    add.truth(
        "beyond_noise",
        "whether the rotation of a counter-rotating joint exceeds two standard deviations",
        |row| row.contradicted().map(|joint| joint.beyond_noise),
    );
}
