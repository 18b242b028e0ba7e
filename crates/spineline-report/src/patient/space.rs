//! The erect spine in space, from the erect and the lateral film.

use spineline::analysis::{Analysis, TemplateError};
use spineline::clinical::SpatialMeasures;
use spineline::measure::SpatialOutline;
use spineline::number::{fixed, interval};

use crate::document::{Figure, Section, Table};
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
    let numbers = found.numbers(analysis.movement.scale());
    let mut table = Table::of("The erect spine in space", numbers, |add| {
        add.words("Number", |number| {
            let curve = number.region.map(|region| format!("{region}: "));
            format!("{}{}", curve.unwrap_or_default(), number.label)
        });
        add.words("Between", |number| number.between.clone());
        add.words("2-D or 3-D", |number| number.dimension.key());
        add.words("Value ± sd", |number| number.text());
        add.words("95 % interval", |number| interval(number.interval_95(), 1));
    });
    table.note = "2-D: on one film. 3-D: in space. Endplates are read as clinicians do, from the superior endplate of the upper to the inferior one of the lower vertebra; they include the wedges of both bodies, axes do not. S1 is not a landmark.".to_owned();
    table
}

/// The pitch of every vertebra as the lateral film shows it, and in space.
fn pitches(found: &SpatialOutline, template: Option<&TemplateError>) -> Table {
    let assumed = |level| {
        let vertebra = template?.vertebrae.iter().find(|vertebra| vertebra.level == level)?;
        Some(fixed(vertebra.template.deg(), 1))
    };
    let caption = "Pitch of the vertebrae, flexion positive";
    let mut table = Table::of(caption, &found.vertebrae, |add| {
        add.words("Vertebra", |one| one.level.to_string());
        add.words("Tilt on the erect film (2-D)", |one| one.orientation.tilt.leaning());
        add.numbers("Pitch on the lateral film (2-D, °)", |one| fixed(one.lateral_pitch.deg(), 1));
        add.numbers("Pitch in space (3-D, °)", |one| fixed(one.orientation.pitch.deg(), 1));
        add.numbers("sd (°)", |one| fixed(found.pitch_sd(one).deg(), 1));
        add.numbers("Population's profile (°)", |one| assumed(one.level).unwrap_or_else(none));
    });
    table.note = "By the line through the centres of both endplates. A lateral film overstates the pitch of a tilted vertebra; its endplates depend on how they are read, that line does not. A model without a lateral film has the population's profile.".to_owned();
    table
}

/// Axial rotations from pedicles; `None` where none are marked.
pub fn axial(analysis: &Analysis) -> Option<Section> {
    let caption = "Axial rotation on the erect film (3-D)";
    let mut table = Table::of(caption, &analysis.movement.axial, |add| {
        add.words("Vertebra", |found| found.level.to_string());
        add.words("Front turned (Stokes)", |found| found.words());
        add.numbers("sd (°)", |found| fixed(found.sd.deg(), 1));
        add.words("Drerup (°, left positive)", |found| {
            found.drerup.map_or_else(none, |angle| fixed(angle.deg(), 1))
        });
        add.words("Nash–Moe", |found| found.grade.key());
    });
    table.note = "From the pedicles. Vertebrae without marked pedicles are not listed: their rotation is not known, and zero in the model. The ratio of the pedicles' places is the mean of 2,068 CTs (vid-ct) from L4 to T1, and UNVERIFIED at L5; people differ in it by 10 % (assumption).".to_owned();
    let mut section = Section::new("axial-rotation", "Axial rotation");
    section.table(table);
    (!analysis.movement.axial.is_empty()).then_some(section)
}
