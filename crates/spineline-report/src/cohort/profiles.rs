//! Sagittal profiles of the patients with a lateral film, beside a population's profile.

use spineline::analysis::{Analysis, TemplateError};
use spineline::evaluate::statistics::Summary;
use spineline::number::{interval, with_sd};

use crate::document::{Figure, Section, Table};
use crate::figures;

/// Errors of the population's profile in these patients; `None` without lateral films.
pub fn section(analyses: &[Analysis]) -> Option<Section> {
    let found: Vec<(&Analysis, TemplateError)> =
        analyses.iter().filter_map(|one| Some((one, one.template_error()?))).collect();
    let svg = figures::sagittal_profiles(&found)?;
    let mut section = Section::new("profiles", "Sagittal profiles");
    section.paragraph(format!(
        "{} of {} patients have a lateral film. The models of the others have the sagittal profile of a population. Its errors are shown here for the patients with a lateral film.",
        found.len(),
        analyses.len()
    ));
    let caption =
        "Pitch of the vertebrae from both films, and error of the profile of a population";
    section.figure(Figure::new("sagittal-profiles", caption, svg));
    section.table(errors(&found));
    Some(section)
}

fn errors(found: &[(&Analysis, TemplateError)]) -> Table {
    let all = |of: fn(&TemplateError) -> f64| -> Vec<f64> {
        found.iter().map(|(_, error)| of(error)).collect()
    };
    let depths =
        found.iter().filter_map(|(one, error)| one.movement.scale().mm(error.depth_rms_mm));
    let rows = [
        ("Turn of a joint, root mean square (°)", all(|error| error.joint_rms.deg())),
        ("Pitch of a vertebra, root mean square (°)", all(|error| error.vertebra_rms.deg())),
        ("Pitch of the worst vertebra (°)", all(|error| error.worst().1.deg())),
        ("Depth of a vertebra, root mean square (mm)", depths.collect()),
    ];
    let rows = rows.into_iter().filter(|(_, values)| !values.is_empty());
    let caption = "Error of the population's profile, one value per patient";
    let mut table = Table::of(caption, rows, |add| {
        add.words("Error of the population's profile", |(name, _)| *name);
        add.numbers("Patients", |(_, values)| values.len().to_string());
        add.numbers("Mean ± sd", |(_, values)| {
            let Summary { mean, sd, .. } = Summary::of(values);
            with_sd(mean, sd, 1)
        });
        add.words("Range", |(_, values)| {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            interval([low, high], 1)
        });
    });
    table.note = "Differences between what a model without the lateral film has and what both films show; they hold the errors of the landmarks too.".to_owned();
    table
}
