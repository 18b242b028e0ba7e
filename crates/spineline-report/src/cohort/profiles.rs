//! Sagittal profiles of the patients with a lateral film, beside a population's profile.

use spineline::analysis::{Analysis, TemplateError};
use spineline::evaluate::statistics::Summary;
use spineline::number::{interval, with_sd};

use crate::document::{Column, Figure, Section, Table};
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
    let columns = vec![
        Column::words("Error of the population's profile"),
        Column::numbers("Patients"),
        Column::numbers("Mean ± sd"),
        Column::words("Range"),
    ];
    let mut table = Table::new("Error of the population's profile, one value per patient", columns);
    let mut add = |name: &str, values: Vec<f64>| {
        if values.is_empty() {
            return;
        }
        let of = Summary::of(&values);
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        table.row(vec![
            name.to_owned(),
            of.n.to_string(),
            with_sd(of.mean, of.sd, 1),
            interval([low, high], 1),
        ]);
    };
    let all = |of: fn(&TemplateError) -> f64| found.iter().map(|(_, error)| of(error)).collect();
    add("Turn of a joint, root mean square (°)", all(|error| error.joint_rms.deg()));
    add("Pitch of a vertebra, root mean square (°)", all(|error| error.vertebra_rms.deg()));
    add("Pitch of the worst vertebra (°)", all(|error| error.worst().1.deg()));
    let depths =
        found.iter().filter_map(|(one, error)| one.movement.scale().mm(error.depth_rms_mm));
    add("Depth of a vertebra, root mean square (mm)", depths.collect());
    table.note = "Differences between what a model without the lateral film has and what both films show; they hold the errors of the landmarks too.".to_owned();
    table
}
