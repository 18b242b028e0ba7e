//! The erect spine in space, from the erect and the lateral film.

use spineline::analysis::Analysis;
use spineline::clinical::SpatialMeasures;
use spineline::measure::SpatialOutline;

use crate::document::{Column, Section, Table};
use crate::phrases::none;

/// What the two films give together; `None` without a lateral film.
pub fn both_films(analysis: &Analysis) -> Option<Section> {
    let found = analysis.space.as_ref()?;
    let mut section = Section::new("both-films", "The erect and the lateral film together");
    section.paragraph(found.alignment_words(analysis.scale()));
    section.table(measures(analysis, &analysis.spatial_measures()?));
    section.table(pitches(found));
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
    for number in found.numbers(analysis.scale()) {
        let [low, high] = number.interval_95();
        let curve = number.region.map(|region| format!("{region}: "));
        table.row(vec![
            format!("{}{}", curve.unwrap_or_default(), number.label),
            number.between.clone(),
            number.dimension.key().to_owned(),
            number.text(),
            format!("{low:.1} to {high:.1}"),
        ]);
    }
    table.note = "2-D: on one film. 3-D: in space. Endplates are read as clinicians do, from the superior endplate of the upper to the inferior one of the lower vertebra; they include the wedges of both bodies, axes do not. S1 is no landmark.".to_owned();
    table
}

/// The pitch of every vertebra as the lateral film shows it, and in space.
fn pitches(found: &SpatialOutline) -> Table {
    let columns = vec![
        Column::words("Vertebra"),
        Column::words("Tilt on the erect film (2-D)"),
        Column::numbers("Pitch on the lateral film (2-D, °)"),
        Column::numbers("Pitch in space (3-D, °)"),
        Column::numbers("sd (°)"),
    ];
    let mut table = Table::new("Pitch of the vertebrae, flexion positive", columns);
    for vertebra in &found.vertebrae {
        table.row(vec![
            vertebra.level.to_string(),
            vertebra.orientation.tilt.leaning(),
            format!("{:.1}", vertebra.lateral_pitch.deg()),
            format!("{:.1}", vertebra.orientation.pitch.deg()),
            format!("{:.1}", found.pitch_sd(vertebra).deg()),
        ]);
    }
    table.note = "By the line through the centres of both endplates. A lateral film overstates the pitch of a tilted vertebra; its endplates look different by how they are read, that line does not.".to_owned();
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
    for found in &analysis.axial {
        table.row(vec![
            found.level.to_string(),
            found.words(),
            format!("{:.1}", found.sd.deg()),
            found.drerup.map_or_else(none, |angle| format!("{:.1}", angle.deg())),
            found.grade.key().to_owned(),
        ]);
    }
    table.note = "From the pedicles. Vertebrae without marked pedicles are not listed: their rotation is not known, and zero in the model.".to_owned();
    let mut section = Section::new("axial-rotation", "Axial rotation");
    section.table(table);
    (!analysis.axial.is_empty()).then_some(section)
}
