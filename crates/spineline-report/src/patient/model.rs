//! The personalised models: shapes, springs, errors, and the lines side by side.

use spineline::analysis::{
    Analysis, BAND_COVERAGE, FilmPredictor, FilmRole, LineModel, LinesCompared, Reference,
};
use spineline::anatomy::Posture;
use spineline::evaluate::Simulation;
use spineline::multibody::StiffnessLibrary;
use spineline::number::{fixed, interval};
use spineline::personalize::{FitStatus, MULTIPLIER_COVERAGE, STIFFNESS_COVERAGE};
use spineline::uncertainty::{QuantityKind, Uncertainty};

use super::Patient;
use super::uncertainty;
use crate::document::{Column, Figure, Notice, NoticeKind, Section, Table};
use crate::figures;
use crate::phrases::{FITTED, GIVE_SCALE, HELD_OUT, no_model, none, numbers, sentence_case};

/// Parts of the force at which figure 11 shows the spine.
const PARTS: [f64; 4] = [0.0, 0.5, 1.0, 1.25];

/// Figures 9 and 11 of the paper, for every posture.
pub fn simulated(analysis: &Analysis) -> Section {
    let mut section = Section::new("simulated", "Measured and simulated spines");
    if analysis.models.is_empty() {
        section.paragraph(no_model(analysis));
    }
    for posture in Posture::MOVED {
        let Some(svg) = figures::measured_and_simulated(analysis, posture) else { continue };
        section.heading(sentence_case(&posture.to_string()));
        let caption = format!(
            "Measured and simulated spine, {posture}, one panel per line of action (figure 9 of the paper)."
        );
        section.figure(Figure::new(format!("simulated-{}", posture.key()), caption, svg));
        let Some(model) = analysis.models.first() else { continue };
        let Some(shapes) = analysis.force_path(model, posture, &PARTS) else { continue };
        let unit = "of the force found";
        let svg = figures::force_path(analysis, posture, model.kind, &shapes, unit);
        let caption = format!(
            "The spine under increasing force along the {}, {posture} (figure 11 of the paper).",
            model.kind
        );
        section.figure(Figure::new(format!("force-{}", posture.key()), caption, svg));
    }
    section
}

/// The model from three sides.
pub fn space(analysis: &Analysis) -> Section {
    let mut section = Section::new("space", "The model in space");
    let Some((svg, space)) = figures::spine_in_space(analysis) else {
        section.paragraph(format!("The model is not drawn: its vertebrae come from the erect film, which has no scale, so their size in millimetres is not known. {GIVE_SCALE}"));
        return section;
    };
    let caption = format!("The multibody model from three sides; {}.", analysis.profile_words());
    let mut figure = Figure::new("space", caption, svg);
    figure.space = Some(space);
    section.figure(figure);
    section
}

/// Springs with their sources, and the intervals of every multiplier.
pub fn stiffness(patient: &Patient<'_>) -> Section {
    let analysis = patient.analysis;
    let mut section = Section::new("stiffness", "Stiffness");
    if analysis.models.is_empty() {
        section.paragraph(no_model(analysis));
        return section;
    }
    section.paragraph(format!("Scale constraint (gauge): {}.", analysis.gauge_words()));
    section.table(multipliers(patient));
    section.table(springs(analysis));
    if let Some(found) = patient.identifiability {
        uncertainty::identifiability(&mut section, analysis, found);
        uncertainty::profiles(&mut section, analysis, found);
    }
    section
}

/// The multipliers of all lines side by side, with the scale constraint and the fits that did not converge.
pub fn multipliers_in_short(section: &mut Section, analysis: &Analysis) {
    let Some(first) = analysis.models.first() else { return };
    let caption = format!("Lateral stiffness relative to the table ({})", analysis.gauge_words());
    // All lines have the same groups.
    section.table(Table::of(caption, first.groups.titles().enumerate(), |add| {
        add.words("Joints", |(_, name)| name.clone());
        for model in &analysis.models {
            let values: Vec<f64> = model.multipliers().collect();
            let verdicts = model.verdicts(analysis);
            let head = format!("{} (1)", sentence_case(&model.kind.to_string()));
            add.words(head, |&(group, _)| {
                let value = values[group] * model.fit.absolute_scale;
                let refusal = verdicts[group].ending.refusal();
                let note = refusal.map_or_else(String::new, |text| format!(" ({text})"));
                format!("{}{note}", fixed(value, 2))
            });
        }
    }));
    for model in analysis.models.iter().filter(|m| m.fit.status != FitStatus::Converged) {
        let status = model.fit.status.key().replace('_', " ");
        let text = format!("{}: the fit is NOT CONVERGED ({status}).", model.kind);
        section.notice(Notice::new(NoticeKind::Warning, text));
    }
}

fn multipliers(patient: &Patient<'_>) -> Table {
    let analysis = patient.analysis;
    let columns = vec![
        Column::words("Line of action"),
        Column::words("Joints"),
        Column::numbers("Multiplier of the table (1)"),
        Column::words("Mean of the joints (95 % interval by the films)"),
        Column::words("95 % interval if the model is exact (landmark noise)"),
        Column::words("Verdict"),
    ];
    let mut table = Table::new("Multipliers of the lateral stiffness", columns);
    for model in &analysis.models {
        let found = patient.identifiability.and_then(|all| analysis.entry_of(model.kind, all));
        let rows = model.groups.titles().zip(model.multipliers()).zip(model.verdicts(analysis));
        for (group, ((name, value), verdict)) in rows.enumerate() {
            let scale = model.fit.absolute_scale;
            let found = found.map(|found| &found.multipliers[group]);
            let by_films = found.map(|found| uncertainty::mean_of_joints(found, scale));
            let places = found.map_or(2, |found| uncertainty::places(found, scale));
            let noise =
                patient.uncertainty.and_then(|found| noise_interval(found, model, group, scale));
            table.row(vec![
                model.kind.to_string(),
                name,
                fixed(value * scale, places),
                by_films.unwrap_or_else(none),
                noise.unwrap_or_else(none),
                verdict.to_string(),
            ]);
        }
    }
    let asked = match (patient.identifiability.is_some(), patient.uncertainty.is_some()) {
        (true, true) => "",
        (false, true) => " `--identifiability` adds intervals from the films.",
        (true, false) => " `--replicates` adds intervals from landmark noise.",
        (false, false) => {
            " `--identifiability` adds intervals from the films, `--replicates` intervals from landmark noise."
        }
    };
    let coverage =
        if patient.identifiability.is_some() { STIFFNESS_COVERAGE } else { MULTIPLIER_COVERAGE };
    table.note = format!("{coverage}{asked}");
    table
}

/// The 95 % interval of a multiplier over the replicates, or why it has none.
pub fn noise_interval(
    found: &Uncertainty,
    model: &LineModel,
    group: usize,
    scale: f64,
) -> Option<String> {
    let multiplier = QuantityKind::LogMultiplier.of_case().along(model.kind).of_multiplier(group);
    let one = found.of(multiplier)?;
    let ends = one.interval_95().map(|ends| ends.map(|log| scale * log.exp()));
    ends.map(|ends| interval(ends, 2)).or_else(|| uncertainty::no_interval(one))
}

fn springs(analysis: &Analysis) -> Table {
    let library: &StiffnessLibrary = &analysis.movement.library;
    let absolute = |model: &LineModel| model.is_absolute(analysis.options.gauge);
    let shown = |nmm: f64| fixed(nmm / 1000.0, 0);
    let joints = library.rows().iter().enumerate();
    let mut table = Table::of("Springs of every joint, caudal first", joints, |add| {
        add.words("Joint", |(_, row)| format!("{}/{}", row.superior, row.inferior));
        add.words("Source of the table", |(_, row)| row.source.clone());
        add.numbers("Table: lateral (N·m/rad)", |(_, row)| shown(row.nmm_per_rad[0]));
        add.numbers("flexion (N·m/rad)", |(_, row)| shown(row.nmm_per_rad[1]));
        add.numbers("axial (N·m/rad)", |(_, row)| shown(row.nmm_per_rad[2]));
        for model in &analysis.models {
            let springs = model.stiffness_nmm_per_rad(library);
            let unit = if absolute(model) { "N·m/rad" } else { "of the table" };
            let head = format!("{}: lateral ({unit})", sentence_case(&model.kind.to_string()));
            add.numbers(head, |(joint, row)| {
                let lateral = springs[*joint][0];
                let relative = || fixed(lateral / row.nmm_per_rad[0], 2);
                if absolute(model) { shown(lateral) } else { relative() }
            });
        }
    });
    let known = match analysis.options.reference {
        Reference::Unloaded => "only their ratios are known",
        Reference::Loaded { .. } => "their level is assumed",
    };
    table.note = if analysis.models.iter().all(absolute) {
        "Springs are scaled to the known force, about all axes.".to_owned()
    } else {
        format!(
            "No force was measured: springs of the models are relative to the table, and {known}. Flexion and axial springs are as in the table."
        )
    };
    table
}

/// Fitted and held-out films in separate tables.
pub fn errors(analysis: &Analysis) -> Section {
    let mut section = Section::new("errors", "Errors of the models");
    if analysis.models.is_empty() {
        section.paragraph(no_model(analysis));
        return section;
    }
    section.heading("Fitted films");
    section.paragraph(FITTED);
    section.table(error_table(analysis, true));
    section.heading("Held-out films");
    let held_out = error_table(analysis, false);
    if held_out.rows.is_empty() {
        section.paragraph("No film was held out: the models' predictions cannot be assessed.");
    } else {
        section.paragraph(HELD_OUT);
    }
    section.table(held_out);
    section
}

/// Errors of all lines on one kind of film.
pub fn error_table(analysis: &Analysis, fitted: bool) -> Table {
    let absolute = analysis.models.iter().all(|model| model.is_absolute(analysis.options.gauge));
    let films = if fitted { "fitted" } else { "held-out" };
    let simulations = analysis.models.iter().flat_map(|model| {
        let of_kind = model.simulations.iter().filter(move |s| s.fitted == fitted);
        of_kind.map(move |s| (model, s))
    });
    let or_none = |s: &Simulation, value: String| if s.is_usable() { value } else { none() };
    let mut table = Table::of(format!("Errors on {films} films"), simulations, |add| {
        add.words("Line of action", |(model, _)| model.kind.to_string());
        add.words("Film", |(_, s)| s.shape.posture.to_string());
        add.numbers("Mean location error (mm)", |(_, s)| {
            let status = || s.status.key().replace('_', " ");
            if s.is_usable() { fixed(s.shape.mean_location_error_mm(), 2) } else { status() }
        });
        add.numbers("Largest (mm)", |(_, s)| {
            let largest = s.shape.location_errors_mm.iter().copied().fold(0.0, f64::max);
            or_none(s, fixed(largest, 2))
        });
        add.numbers("Ferguson errors (°)", |(_, s)| {
            let angles = s.ferguson_difference.iter().map(|a| fixed(a.abs().deg(), 1));
            or_none(s, angles.collect::<Vec<_>>().join(" / "))
        });
        let force = if absolute { "Force (N)" } else { "Force (relative)" };
        add.numbers(force, |(_, s)| or_none(s, fixed(s.force_n, 0)));
        add.numbers("Counter-rotating joints", |(_, s)| {
            or_none(s, format!("{} of {}", s.contradicted.len(), s.joints()))
        });
    });
    let mut films = analysis.movement.films.iter();
    let interpolated = films.any(|film| film.outline.interpolated().next().is_some());
    let levels = analysis.movement.levels().as_slice();
    table.note = format!(
        "Location error: distance between simulated and measured midpoints, {} to {}{}. Ferguson errors: three regions, caudal first. Counter-rotating joints turn against the moment of the force.",
        levels[1],
        levels[levels.len() - 1],
        if interpolated { ", without interpolated vertebrae" } else { "" }
    );
    table
}

/// The lines on the same films, every bend left out once.
pub fn comparison(analysis: &Analysis) -> Section {
    let found = analysis.comparison();
    let mut section = Section::new("comparison", "Comparison of the lines");
    if analysis.models.is_empty() {
        section.paragraph(no_model(analysis));
        return section;
    }
    section.table(by_line(analysis));
    section.paragraph(found.choice_words().unwrap_or_default());
    let numbers = "Numbers fitted: free multipliers + forces + parameters of a free line. A bend that is left out is predicted with the stiffness fitted to the other bend.";
    for text in [numbers, other_data(found)].into_iter().filter(|text| !text.is_empty()) {
        section.notice(Notice::new(NoticeKind::Note, text));
    }
    section
}

/// Errors of every line by kind of film.
pub fn by_line(analysis: &Analysis) -> Table {
    let found = analysis.comparison();
    let bands = analysis.bands();
    let all = FilmRole::ALL.into_iter();
    let all = all.flat_map(|role| found.predictors().map(move |by| (by, role)));
    let rows = all.filter_map(|(by, role)| Some((by, role, found.error_mm(by, role)?)));
    let place = |by| found.lines.iter().position(|line| by == FilmPredictor::Line(line.kind));
    let mut table = Table::of("Every line on the films with a result", rows, |add| {
        add.words("Films", |(_, role, _)| role.to_string());
        add.words("Prediction", |(by, ..)| {
            let mark = if by.is_line() { "" } else { "* " };
            format!("{mark}{}", by.long_name())
        });
        add.numbers("Films", |&(by, role, _)| {
            format!("{} of {}", found.predicted_films(by, role), found.count(role))
        });
        add.numbers("Location error (mm)", |(.., mm)| fixed(*mm, 2));
        add.numbers("95 % band (± mm)", |&(by, role, _)| {
            bands.mean_radius_mm(by, role).map_or_else(none, |mm| fixed(mm, 1))
        });
        add.numbers("Ferguson error (°)", |&(by, role, _)| {
            let errors = place(by).and_then(|line| found.errors(line, role));
            errors.map_or_else(none, |errors| fixed(errors.ferguson_deg, 1))
        });
        add.words("Numbers taken from the films", |&(by, role, _)| match place(by) {
            Some(line) => numbers(&found.lines[line].numbers, role),
            None => format!("{} per film", found.per_predicted_film(by)),
        });
    });
    table.note = format!(
        "* without mechanics. Errors on fitted bends are not evidence for a line. {BAND_COVERAGE}"
    );
    table.note.extend(found.lost_fits().map(|lost| format!(" {lost}")));
    table
}

/// A sentence where the lines used different data; else empty.
pub fn other_data(found: &LinesCompared) -> &'static str {
    if found.same_data() {
        ""
    } else {
        "The free line was fitted to whole shapes, the others to Ferguson angles: not the same data."
    }
}
