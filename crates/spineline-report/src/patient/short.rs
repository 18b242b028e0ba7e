//! The first page: which line, how sure, how stiff, what next.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, FilmPredictor, FilmRole, LineModel};
use spineline::number::{self, fixed};
use spineline::personalize::{Identifiability, IntervalVerdict, TestOutcome};
use spineline::uncertainty::Uncertainty;
use spineline::warning::counted;

use super::model::noise_interval;
use super::{Patient, measured, uncertainty};
use crate::document::{Figure, Section, Table};
use crate::figures;
use crate::phrases::{no_model, none, sentence_case};

/// Columns of errors that a page has room for, each with its band.
const MOST_ERRORS: usize = 3;
/// Multipliers that are shown one by one; of more, the smallest and the largest.
const MOST_MULTIPLIERS: usize = 4;

/// The sources of the intervals of multipliers, where the user asks for intervals.
#[derive(Clone, Copy, Default)]
pub struct Intervals<'a> {
    identifiability: Option<&'a [Option<Identifiability>]>,
    uncertainty: Option<&'a Uncertainty>,
}

impl<'a> Intervals<'a> {
    pub const fn of(patient: &Patient<'a>) -> Self {
        let Patient { identifiability, uncertainty, .. } = *patient;
        Self { identifiability, uncertainty }
    }

    /// The source for a model: its films, or else the replicates.
    fn of_model(self, analysis: &Analysis, model: &LineModel) -> Option<Source<'a>> {
        let found = self.identifiability.and_then(|all| analysis.entry_of(model.kind, all));
        found.map(Source::Films).or_else(|| self.uncertainty.map(Source::Replicates))
    }
}

/// The source of the intervals of one model.
#[derive(Clone, Copy)]
enum Source<'a> {
    Films(&'a Identifiability),
    Replicates(&'a Uncertainty),
}

impl Source<'_> {
    const fn words(self) -> &'static str {
        match self {
            Self::Films(_) => " (95 % interval of the mean of its joints)",
            Self::Replicates(_) => " (95 % interval by landmark noise, if the model is exact)",
        }
    }

    /// Whether the films identify a multiplier; replicates do not test it.
    fn identifies(self, group: usize) -> bool {
        match self {
            Self::Films(found) => found.multipliers[group].verdict() == IntervalVerdict::Interval,
            Self::Replicates(_) => true,
        }
    }

    /// Decimal places of a multiplier beside its interval.
    fn places(self, model: &LineModel, group: usize) -> usize {
        match self {
            Self::Films(found) => {
                uncertainty::places(&found.multipliers[group], model.fit.absolute_scale)
            }
            Self::Replicates(_) => 2,
        }
    }

    fn interval(self, model: &LineModel, group: usize) -> Option<String> {
        let scale = model.fit.absolute_scale;
        match self {
            Self::Films(found) => {
                let one = &found.multipliers[group];
                let outside = if one.is_outside() { "; the fit lies outside" } else { "" };
                Some(format!("{}{outside}", uncertainty::interval(one, scale)))
            }
            Self::Replicates(found) => noise_interval(found, model, group, scale),
        }
    }
}

/// Answers, a table and a picture.
pub fn short(analysis: &Analysis, intervals: Intervals<'_>) -> Section {
    let mut section = answers(analysis, intervals);
    section.table(table(analysis));
    if let Some(svg) = figures::predictions(analysis) {
        let caption = "The line with the smallest error and its 95 % band, and the best prediction without mechanics, on films that were not fitted.";
        section.figure(Figure::new("predictions", caption, svg));
    }
    section
}

/// The same for a terminal: without the picture, and with the options and commands that follow.
pub fn on_terminal(patient: &Patient<'_>) -> Section {
    let mut section = answers(patient.analysis, Intervals::of(patient));
    section.title = String::new();
    section.paragraph(format!("What next? {}", next(patient)));
    section.table(table(patient.analysis));
    section
}

fn answers(analysis: &Analysis, intervals: Intervals<'_>) -> Section {
    let mut section = Section::new("short", "In short");
    let headline = analysis.headline(intervals.identifiability);
    section.paragraph(format!("Which curve? {}", curve(analysis)));
    section.paragraph(format!("Which line? {}", headline.line));
    let noise = measured::noise_words(analysis);
    section.paragraph(format!("How sure? {}", joined([headline.prediction, Some(noise)])));
    let chosen = headline.kind.and_then(|kind| analysis.model(kind));
    if let Some(model) = chosen {
        let values = multipliers(analysis, model, intervals);
        section.paragraph(format!("How stiff? {}", joined([headline.stiffness, Some(values)])));
    }
    section
}

fn joined<const N: usize>(sentences: [Option<String>; N]) -> String {
    sentences.into_iter().flatten().collect::<Vec<_>>().join(" ")
}

/// The main curve of the erect film and its inflections.
fn curve(analysis: &Analysis) -> String {
    let main = analysis.movement.main_curve().map(|curve| {
        let name = if curve.has_cobb() { "Cobb angle" } else { "tilt range" };
        let size = fixed(curve.erect_size().abs().deg(), 0);
        // A curve that rounds to zero has no side.
        let side = curve.convex.filter(|_| size != "0");
        let side = side.map_or_else(String::new, |side| format!(", convex to the {side}"));
        let (ends, apex) = (curve.ends, curve.apex);
        format!(
            "The {} curve has a {name} of {size}°{side} ({}–{}, apex {apex}).",
            curve.region, ends.superior, ends.inferior
        )
    });
    let place = |pair: &[spineline::curve::Inflection; 2]| {
        let [a, b] = pair.map(|one| one.place());
        format!("Inflections: {a} and {b}.")
    };
    let inflections = analysis.movement.inflections.pair.as_ref().map(place);
    joined([main, inflections, Some(format!("{}.", analysis.lenke_words()))])
}

/// The multipliers of a model, each with its interval where one was asked for and the films identify it.
fn multipliers(analysis: &Analysis, model: &LineModel, intervals: Intervals<'_>) -> String {
    let scale = model.fit.absolute_scale;
    let values: Vec<f64> = model.multipliers().map(|value| value * scale).collect();
    let verdicts = model.verdicts(analysis);
    let source = intervals.of_model(analysis, model);
    if values.len() > MOST_MULTIPLIERS {
        let has_value = |group: &usize| verdicts[*group].has_value();
        let groups: Vec<usize> = (0..values.len()).filter(has_value).collect();
        let found: Vec<f64> = groups.iter().map(|&group| values[group]).collect();
        let [low, high] = [f64::min, f64::max].map(|of| found.iter().copied().reduce(of));
        let ends = low.zip(high).map(|(low, high)| number::interval([low, high], 2));
        let outside = match source {
            Some(Source::Films(tested)) => {
                groups.iter().filter(|&&group| tested.multipliers[group].is_outside()).count()
            }
            _ => 0,
        };
        let outside = (outside > 0).then(|| {
            format!("; {outside} of {} fits lie outside of their 95 % intervals", found.len())
        });
        return format!(
            "Multiples of the table: {} over {}{}.",
            ends.unwrap_or_else(none),
            counted(found.len(), "joint"),
            outside.unwrap_or_default()
        );
    }
    let is_open = |group: usize| source.is_some_and(|source| !source.identifies(group));
    let refusal = |group: usize| {
        verdicts[group].ending.refusal().or_else(|| is_open(group).then_some("not identified"))
    };
    let interval =
        |group: usize| source.filter(|_| refusal(group).is_none())?.interval(model, group);
    let found: Vec<Option<String>> = (0..values.len()).map(interval).collect();
    let has_intervals = found.iter().any(Option::is_some);
    let words = source.filter(|_| has_intervals).map_or("", Source::words);
    let one = |(group, (name, value)): (usize, (String, f64))| {
        let note = refusal(group).map(str::to_owned).or_else(|| found[group].clone());
        let note = note.map_or_else(String::new, |text| format!(" ({text})"));
        let shown = source.filter(|_| found[group].is_some());
        let places = shown.map_or(2, |source| source.places(model, group));
        format!("{} {}{note}", name, fixed(value, places))
    };
    let all = model.groups.titles().zip(values).enumerate().map(one).collect::<Vec<_>>();
    let few = match source {
        Some(Source::Replicates(replicates)) if !has_intervals => replicates.few_words(),
        _ => None,
    };
    let few = few.map_or_else(String::new, |few| format!(" {few}"));
    format!("Multiples of the table{words}: {}.{few}", all.join(", "))
}

/// What a user may do now.
fn next(patient: &Patient<'_>) -> String {
    let analysis = patient.analysis;
    let doubted = analysis.has_doubted_film().then(|| {
        let films: Vec<String> = super::doubted_films(analysis);
        format!(
            "Compare these films with the patient's records: {}. Where they are right, set `checked` in the case file.",
            films.join(", ")
        )
    });
    let has_intervals = patient.uncertainty.is_some_and(|found| found.few_words().is_none());
    let missing = [
        (!has_intervals).then_some("--replicates 1000"),
        patient.identifiability.is_none().then_some("--identifiability"),
    ];
    let missing: Vec<&str> = missing.into_iter().flatten().collect();
    let intervals = (!missing.is_empty()).then(|| format!("Intervals: {}.", missing.join(" ")));
    let more = Some("Tables: --full. Page: spineline report.".to_owned());
    if analysis.models.is_empty() {
        return joined([doubted, Some(no_model(analysis)), more]);
    }
    joined([doubted, intervals, more])
}

/// How the bends test every line, and its errors beside predictions without mechanics.
fn table(analysis: &Analysis) -> Table {
    let compared = analysis.comparison();
    let bands = analysis.bands();
    let columns = [
        ("Left-out bends (mm)", FilmRole::LeftOutBend, false),
        ("With tilt (mm)", FilmRole::LeftOutBend, true),
        ("Neutral, traction (mm)", FilmRole::HeldOut, false),
        ("With tilt (mm)", FilmRole::HeldOut, true),
    ];
    let error_mm = |by: FilmPredictor, (_, role, with_tilt): (&str, FilmRole, bool)| {
        compared.error_mm(by, role).filter(|_| by.knows_tilt() == with_tilt)
    };
    let has_numbers = |&of: &_| compared.predictors().any(|by| error_mm(by, of).is_some());
    let columns = columns.into_iter().filter(has_numbers).take(MOST_ERRORS).collect::<Vec<_>>();
    // A prediction with the tilt of the top has the row of the one with the same name without it.
    let mut rows: Vec<(FilmPredictor, Vec<FilmPredictor>)> = Vec::new();
    for by in compared.predictors() {
        let is_shown = by.is_line() || columns.iter().any(|&of| error_mm(by, of).is_some());
        match rows.iter_mut().find(|(row, _)| row.to_string() == by.to_string()) {
            Some((_, same)) => same.push(by),
            None if is_shown => rows.push((by, vec![by])),
            None => {}
        }
    }
    let mm = |mm: Option<f64>| mm.map_or_else(none, |mm| fixed(mm, 1));
    let (title, line) = match (columns.is_empty(), analysis.movement.bends().count()) {
        (false, _) => ("Mean location errors on films that were not fitted", "Prediction"),
        (true, 1) => ("Lines tested by the bend", "Line"),
        (true, _) => ("Lines tested by the bends", "Line"),
    };
    let mut table = Table::of(title, rows, |add| {
        add.words(line, |(row, _)| prediction_words(analysis, *row));
        add.words("Bends", |(row, _)| match row {
            FilmPredictor::Line(kind) => {
                analysis.model(*kind).map_or_else(none, |model| outcome(analysis, model))
            }
            _ => none(),
        });
        for of @ (head, role, _) in columns {
            let shown = move |same: &[FilmPredictor]| {
                same.iter().find_map(|&by| Some((by, error_mm(by, of)?)))
            };
            add.numbers(head, move |(_, same)| mm(shown(same).map(|(_, mm)| mm)));
            add.numbers("95 % band (± mm)", move |(_, same)| {
                mm(shown(same).and_then(|(by, _)| bands.mean_radius_mm(by, role)))
            });
        }
    });
    let notes = [
        ("With tilt", "With tilt: the tilt of the top is known too."),
        ("*", "* without mechanics."),
        ("†", "† two more numbers per film."),
    ];
    let has = |mark: &str| {
        table.columns.iter().any(|column| column.head.contains(mark))
            || table.rows.iter().any(|row| row[0].contains(mark))
    };
    let shown = notes.into_iter().filter(|(mark, _)| has(mark)).map(|(_, note)| note);
    let shown = shown.map(str::to_owned).chain(compared.lost_fits());
    table.note = shown.collect::<Vec<_>>().join(" ");
    table
}

/// The name of a prediction with the marks of the table's note.
fn prediction_words(analysis: &Analysis, by: FilmPredictor) -> String {
    match by {
        FilmPredictor::Line(kind) if analysis.comparison().per_predicted_film(by) > 1 => {
            format!("{} †", sentence_case(&kind.to_string()))
        }
        by if by.is_line() => sentence_case(&by.to_string()),
        _ => format!("* {by}"),
    }
}

/// How the bends test a line. They cannot test a line that is fitted to them, and doubted films test no line.
pub fn outcome(analysis: &Analysis, model: &LineModel) -> String {
    let found = analysis.compatibility(model).outcome();
    match found {
        _ if model.kind == LineKind::Estimated => TestOutcome::NotTested.to_string(),
        TestOutcome::Kept | TestOutcome::Rejected if analysis.has_doubted_film() => {
            "film in doubt".to_owned()
        }
        _ => found.to_string(),
    }
}
