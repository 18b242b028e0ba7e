//! The map of pads as the browser shows it.

use spineline::multibody::Timing;
use spineline::number::{fixed, signed};
use spineline::response::{CurveChange, PadEffect, PadTrial};
use spineline_files::AppliedLoad;

use crate::api::{FileLoad, PadMapCell, PadMapColumn, PadMapRow, PadMapView, Wire};
use crate::jobs::{PadMapJob, PadMapWork, progress};
use crate::words::patients;

/// Equal steps of the force up to the largest one.
pub const STEPS: u32 = 4;

/// State, progress and map of a computation.
pub fn view(job: Option<&PadMapJob>) -> PadMapView {
    let (progress, found) = progress(job);
    let mut view = PadMapView {
        progress,
        largest_force: job.map(|job| job.work.request.largest_force),
        columns: Vec::new(),
        rows: Vec::new(),
    };
    if let Some((job, found)) = job.zip(found) {
        let map = Map { job, largest_rad: largest_rad(found) };
        view.columns = columns(&job.work.trials);
        view.rows = map.rows(found);
        view.progress.texts = texts(&job.work, found);
    }
    view
}

fn largest_rad(found: &[PadEffect]) -> f64 {
    let changes = found.iter().filter_map(|effect| effect.reached?.curve);
    changes.map(|curve| curve.growth().rad().abs()).fold(f64::MIN_POSITIVE, f64::max)
}

/// Number of trials per level; one side comes after the other.
fn per_level() -> usize {
    2 * STEPS as usize
}

fn columns(trials: &[PadTrial]) -> Vec<PadMapColumn> {
    let column = |trial: &PadTrial| PadMapColumn {
        towards: Wire(trial.towards),
        force: force_text(trial.force_n),
    };
    trials.iter().take(per_level()).map(column).collect()
}

/// Three digits, without zeros at the end.
fn force_text(force: f64) -> String {
    let places = if force >= 100.0 {
        0
    } else if force >= 10.0 {
        1
    } else {
        2
    };
    let text = fixed(force, places);
    if places == 0 { text } else { text.trim_end_matches('0').trim_end_matches('.').to_owned() }
}

fn texts(work: &PadMapWork, found: &[PadEffect]) -> Vec<String> {
    let failed = found.iter().filter(|effect| effect.reached.is_none()).count();
    let curve = found.iter().find_map(|effect| effect.reached?.curve);
    let size = curve.map_or_else(
        || "no curve is measured on this model".to_owned(),
        |curve| {
            format!(
                "change of the {} of the largest erect curve ({}, {} without the pad)",
                curve.size_name(),
                curve.region,
                curve.before
            )
        },
    );
    let mut texts = vec![format!(
        "Each number: {size} by one pad {}, at the midpoint of the vertebra. Forces in {}.",
        beside(work.request.beside.len()),
        work.model.force_unit()
    )];
    if failed > 0 {
        texts.push(format!(
            "{failed} of {} pads have no result; their cells name the ending.",
            found.len()
        ));
    }
    texts
}

/// The other loads on the spine, in words.
fn beside(others: usize) -> String {
    match others {
        0 => "alone".to_owned(),
        1 => "beside the one load that the plan had".to_owned(),
        more => format!("beside the {more} loads that the plan had"),
    }
}

struct Map<'a> {
    job: &'a PadMapJob,
    largest_rad: f64,
}

impl Map<'_> {
    fn rows(&self, found: &[PadEffect]) -> Vec<PadMapRow> {
        let movable = self.job.work.model.levels.iter().skip(1);
        let rows = movable.zip(found.chunks(per_level())).map(|(level, effects)| PadMapRow {
            level: level.to_string(),
            cells: effects.iter().map(|effect| self.cell(level.name(), effect)).collect(),
        });
        let mut rows: Vec<PadMapRow> = rows.collect();
        rows.reverse();
        rows
    }

    fn cell(&self, level: &str, effect: &PadEffect) -> PadMapCell {
        let trial = effect.trial;
        let pad =
            format!("{} to {} on {level}", force_text(trial.force_n), patients(trial.towards));
        let Some(reached) = effect.reached else {
            return PadMapCell {
                text: effect.ending.key().replace('_', " "),
                title: format!("{pad}: no result; {}", effect.ending.meaning()),
                part: None,
                load: None,
            };
        };
        let load = self.load(effect);
        match reached.curve {
            Some(curve) => {
                let CurveChange { region, before, after, .. } = curve;
                let size = curve.size_name();
                PadMapCell {
                    text: format!("{}°", signed(curve.growth().deg(), 1)),
                    title: format!(
                        "{pad}: {region} {size} {after} instead of {before}; lateral tilt {} against {}'s axis",
                        reached.lateral_tilt.leaning(),
                        self.job.work.model.levels[0]
                    ),
                    part: Some(curve.growth().rad() / self.largest_rad),
                    load,
                }
            }
            None => PadMapCell { text: "no curve".to_owned(), title: pad, part: None, load },
        }
    }

    fn load(&self, effect: &PadEffect) -> Option<FileLoad> {
        let n_per_mm = self.job.work.request.n_per_mm;
        let level = *self.job.work.model.levels.get(effect.trial.vertebra)?;
        Some(FileLoad(AppliedLoad::Pad {
            level,
            point_in_vertebra_mm: [0.0; 3],
            direction: effect.trial.direction().into(),
            n_per_mm,
            advance_mm: effect.advance_mm(n_per_mm)?,
            timing: Timing::Proportional,
        }))
    }
}
