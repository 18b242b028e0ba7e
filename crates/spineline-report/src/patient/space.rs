//! The erect spine in space, from the erect and the lateral film.

use spineline::analysis::Analysis;
use spineline::measure::SpatialOutline;

use crate::document::{Column, Section, Table};

/// What the two films give together; `None` without a lateral film.
pub fn both_films(analysis: &Analysis) -> Option<Section> {
    let found = analysis.space.as_ref()?;
    let mut section = Section::new("both-films", "The erect and the lateral film together");
    section.paragraph(found.alignment_words(analysis.scale()));
    section.table(pitches(found));
    Some(section)
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
