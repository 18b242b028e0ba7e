//! The erect spine in space, from the erect and the lateral film.

use spineline::analysis::{Analysis, TemplateError};
use spineline::clinical::SpatialMeasures;
use spineline::measure::SpatialOutline;
use spineline::number::{fixed, interval};

use crate::document::{Column, Figure, Section, Table};
use crate::figures;
use crate::phrases::none;

/// Results of both films together; `None` without a lateral film.
pub fn both_films(analysis: &Analysis) -> Option<Section> {
    let movement = &analysis.movement;
    let found = movement.space.as_ref()?;
    let mut section = Section::new("both-films", "The erect and the lateral film together");
    section.paragraph(found.alignment_words(movement.scale()));
    section.table(measures(analysis, &movement.spatial_measures()?));
    let template = analysis.template_error();
    if let Some(error) = &template {
        section.paragraph(error.words(movement.scale()));
    }
    if let Some(svg) = figures::sagittal_profile(analysis) {
        let caption =
            "Sagittal profile of this patient from both films, beside a population's profile";
        section.figure(Figure::new("sagittal-profile", caption, svg));
    }
    section.table(pitches(found, template.as_ref()));
    Some(section)
}

/// Kyphosis, lordosis, planes of maximum curvature and length.
fn measures(analysis: &Analysis, found: &SpatialMeasures) -> Table {
    let columns = vec![
        Column::words("Number"),
        Column::words("Between"),
        Column::words("2-D or 3-D"),
        Column::words("Value ± sd"),
        Column::words("95 % interval"),
    ];
    let mut table = Table::new("The erect spine in space", columns);
    for number in found.numbers(analysis.movement.scale()) {
        let [low, high] = number.interval_95();
        let curve = number.region.map(|region| format!("{region}: "));
        table.row(vec![
            format!("{}{}", curve.unwrap_or_default(), number.label),
            number.between.clone(),
            number.dimension.key().to_owned(),
            number.text(),
            interval([low, high], 1),
        ]);
    }
    table.note = "2-D: on one film. 3-D: in space. Endplates are read as clinicians do, from the superior endplate of the upper to the inferior one of the lower vertebra; they include the wedges of both bodies, axes do not. S1 is not a landmark.".to_owned();
    table
}

/// The pitch of every vertebra as the lateral film shows it, and in space.
fn pitches(found: &SpatialOutline, template: Option<&TemplateError>) -> Table {
    let columns = vec![
        Column::words("Vertebra"),
        Column::words("Tilt on the erect film (2-D)"),
        Column::numbers("Pitch on the lateral film (2-D, °)"),
        Column::numbers("Pitch in space (3-D, °)"),
        Column::numbers("sd (°)"),
        Column::numbers("Population's profile (°)"),
    ];
    let mut table = Table::new("Pitch of the vertebrae, flexion positive", columns);
    let assumed = |level| {
        let vertebra = template?.vertebrae.iter().find(|vertebra| vertebra.level == level)?;
        Some(fixed(vertebra.template.deg(), 1))
    };
    for vertebra in &found.vertebrae {
        table.row(vec![
            vertebra.level.to_string(),
            vertebra.orientation.tilt.leaning(),
            fixed(vertebra.lateral_pitch.deg(), 1),
            fixed(vertebra.orientation.pitch.deg(), 1),
            fixed(found.pitch_sd(vertebra).deg(), 1),
            assumed(vertebra.level).unwrap_or_else(none),
        ]);
    }
    table.note = "By the line through the centres of both endplates. A lateral film overstates the pitch of a tilted vertebra; its endplates depend on how they are read, that line does not. A model without a lateral film has the population's profile.".to_owned();
    table
}

/// Axial rotations from pedicles; `None` where none are marked.
pub fn axial(analysis: &Analysis) -> Option<Section> {
    let columns = vec![
        Column::words("Vertebra"),
        Column::words("Front turned (Stokes)"),
        Column::numbers("sd (°)"),
        Column::words("Drerup (°, left positive)"),
        Column::words("Nash–Moe"),
    ];
    let mut table = Table::new("Axial rotation on the erect film (3-D)", columns);
    for found in &analysis.movement.axial {
        table.row(vec![
            found.level.to_string(),
            found.words(),
            fixed(found.sd.deg(), 1),
            found.drerup.map_or_else(none, |angle| fixed(angle.deg(), 1)),
            found.grade.key().to_owned(),
        ]);
    }
    table.note = "From the pedicles. Vertebrae without marked pedicles are not listed: their rotation is not known, and zero in the model. The ratio of the pedicles' places is the mean of 2,068 CTs (vid-ct) from L4 to T1, and UNVERIFIED at L5; people differ in it by 10 % (assumption).".to_owned();
    let mut section = Section::new("axial-rotation", "Axial rotation");
    section.table(table);
    (!analysis.movement.axial.is_empty()).then_some(section)
}
