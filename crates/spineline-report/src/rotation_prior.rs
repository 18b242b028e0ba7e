//! A learned distribution of joint rotations as a document.

use spineline::cohort::LearnedRotations;
use spineline::evaluate::{PriorSource, RotationPrior};
use spineline::number::fixed;
use spineline::spatial::Angle;
use spineline::warning::counted;

use crate::document::{Document, Section, Table};
use crate::phrases::{mean_words, none};

/// The rotations of the joints, and the errors on patients who were left out; a terminal shows it.
#[must_use]
pub fn summary(learned: &LearnedRotations, synthetic: bool, generator: &str) -> Document {
    let prior = &learned.prior;
    let mut section = Section::new("rotation_prior", "Joint rotations in bending films");
    section.table(joints(prior));
    section.table(errors(learned));
    let synthetic = if synthetic { " · SYNTHETIC films" } else { "" };
    let subject = match prior.source() {
        PriorSource::Published => "published".to_owned(),
        PriorSource::Learned { patients, bends, shrinkage } => format!(
            "{}, {}, correlations reduced by {} %; {} of a joint's erect angle is added",
            counted(patients, "patient"),
            counted(bends, "bend"),
            fixed(100.0 * shrinkage, 0),
            fixed(prior.erect_coefficient(), 2)
        ),
    };
    let subject = format!("{subject}{synthetic}");
    Document::new("Distribution of joint rotations", subject, generator, vec![section])
}

/// Mean, deviation and correlation of the rotations, joint by joint.
fn joints(prior: &RotationPrior) -> Table {
    let covariance = prior.covariance_rad2();
    let sd = |joint: usize| covariance[(joint, joint)].sqrt();
    let caption = "Rotation in a bend to the right, of a joint that is straight on the erect film";
    Table::of(caption, prior.levels().joint_pairs().enumerate(), |add| {
        add.words("Joint", |(_, [inferior, superior])| format!("{inferior}/{superior}"));
        add.numbers("Mean (°)", |&(joint, _)| fixed(prior.mean()[joint].deg(), 1));
        add.numbers("Standard deviation (°)", |&(joint, _)| {
            fixed(Angle::from_rad(sd(joint)).deg(), 1)
        });
        add.numbers("Correlation with the next joint", |&(joint, _)| {
            let next = joint + 1;
            let has_next = next < prior.mean().len();
            let correlation = has_next.then(|| covariance[(joint, next)] / (sd(joint) * sd(next)));
            correlation.map_or_else(none, |value| fixed(value, 2))
        });
    })
}

fn errors(learned: &LearnedRotations) -> Table {
    let rows = [
        ("location of the top vertebra", learned.from_location_mm),
        ("location and tilt of the top vertebra", learned.with_tilt_mm),
        (
            "location and tilt of the top vertebra, published mobility instead of other patients",
            learned.published_with_tilt_mm,
        ),
    ];
    let mut table = Table::of("Bends of patients who were left out", rows, |add| {
        add.words("Prediction from", |(what, _)| *what);
        add.numbers("Patients", |(_, errors)| errors.patients.n.to_string());
        add.words("Location error (mm, 95 %)", |(_, errors)| {
            if errors.patients.n == 0 { none() } else { mean_words(errors, 1) }
        });
    });
    table.note = "Without mechanics. The scale of a film is fitted where the film or the erect film does not state it exactly. A line of action uses only the location of the top vertebra.".to_owned();
    table
}
