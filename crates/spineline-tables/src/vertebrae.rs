use spineline::action::LineKind;
use spineline::analysis::{Analysis, FilmMovement};
use spineline::evaluate::Simulation;
use spineline::measure::MeasuredVertebra;

use crate::Patient;
use crate::define::{Columns, LENGTHS, Row, keyed, rows};
use crate::table::{NumberFormat, REFUSED, Series, Table};

/// A vertebra on a film, and under one line of action.
#[derive(Clone, Copy)]
pub(crate) struct Vertebra<'a> {
    posture: &'a FilmMovement,
    /// Place among the vertebrae of the model.
    index: usize,
    simulated: Option<(LineKind, &'a Simulation)>,
}

impl Vertebra<'_> {
    fn measured(&self) -> &MeasuredVertebra {
        &self.posture.outline.vertebrae[self.index]
    }

    fn mm(&self, length: fn(&MeasuredVertebra) -> f64) -> Option<f64> {
        self.posture.outline.scale.mm(length(self.measured()))
    }

    fn px(&self, length: fn(&MeasuredVertebra) -> f64) -> Option<f64> {
        self.posture.outline.scale.px(length(self.measured()))
    }
}

type VertebraRow<'a> = Row<'a, Vertebra<'a>>;

/// The models' results on a film; one `None` without a model.
pub(crate) fn simulations<'a>(
    analysis: &'a Analysis,
    posture: &FilmMovement,
) -> Vec<Option<(LineKind, &'a Simulation)>> {
    let posture = posture.outline.posture;
    let models = analysis.models.iter();
    let mut found: Vec<_> =
        models.filter_map(|model| Some(Some((model.kind, model.simulation(posture)?)))).collect();
    if found.is_empty() {
        found.push(None);
    }
    found
}

/// One row per patient, posture, line and vertebra; of a posture without a model, one per vertebra.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| {
        let mut all = Vec::new();
        for posture in &patient.analysis.movement.films {
            for simulated in simulations(patient.analysis, posture) {
                let of_level = |index| Vertebra { posture, index, simulated };
                all.extend((0..posture.outline.vertebrae.len()).map(of_level));
            }
        }
        all
    });
    let row = "patient × posture × line × vertebra; measured values are repeated in the rows of every line, and `line` is empty without a model";
    keyed("vertebrae", row, &rows, |add| {
        measured(add);
        simulated(add);
    })
}

/// Columns that [`errors_table`] does not have.
const NOT_OF_ERRORS: [&str; 3] = ["measured_y_px", "measured_z_px", "origin"];
/// Its last columns, in their order.
const LAST_OF_ERRORS: [&str; 10] = [
    "line",
    "fitted",
    "status",
    "simulated_y_mm",
    "simulated_z_mm",
    "simulated_tilt_deg",
    "location_error_mm",
    "lengths",
    "interpolated",
    REFUSED,
];

/// `analyze --csv`: the vertebrae with lengths and angles of four decimal places, vertebra by vertebra.
#[must_use]
pub fn errors_table(analyses: &[Analysis]) -> Table {
    let mut rows: Vec<VertebraRow<'_>> = Vec::new();
    for analysis in analyses {
        for posture in &analysis.movement.films {
            let simulations = simulations(analysis, posture);
            for index in 0..posture.outline.vertebrae.len() {
                let of_line = |&simulated| Vertebra { posture, index, simulated };
                rows.extend(simulations.iter().map(of_line).map(|item| Row { analysis, item }));
            }
        }
    }
    let row = "patient × posture × vertebra × line; `line` is empty without a model";
    let mut table = keyed("errors", row, &rows, |add| {
        measured(add);
        simulated(add);
        add.refused();
    });
    table.columns.retain_mut(|column| {
        column.format = NumberFormat::Places(4);
        !NOT_OF_ERRORS.contains(&column.name.as_str())
    });
    let place = |column: &Series| LAST_OF_ERRORS.iter().position(|name| column.name == *name);
    table.columns.sort_by_key(place);
    table
}

fn measured(add: &mut Columns<'_, VertebraRow<'_>>) {
    add.text("posture", "film", |row| row.posture.outline.posture.key());
    add.text("line", "line of action of the model", |row| {
        row.simulated.map(|(kind, _)| kind.key())
    });
    add.text("level", "vertebra", |row| row.measured().level.to_string());
    add.text("lengths", LENGTHS, |row| row.posture.outline.scale.plane.key());
    add.number(
        "measured_y_mm",
        "measured midpoint relative to the base's midpoint, positive to the patient's left",
        |row| row.mm(|vertebra| vertebra.location.y_mm),
    );
    add.number(
        "measured_z_mm",
        "measured midpoint relative to the base's midpoint, positive upwards",
        |row| row.mm(|vertebra| vertebra.location.z_mm),
    );
    add.number("measured_y_px", "the same on films without a spacing", |row| {
        row.px(|vertebra| vertebra.location.y_mm)
    });
    add.number("measured_z_px", "the same on films without a spacing", |row| {
        row.px(|vertebra| vertebra.location.z_mm)
    });
    add.number("measured_tilt_deg", "measured tilt; positive to the patient's right", |row| {
        row.measured().tilt.deg()
    });
    add.truth(
        "interpolated",
        "whether the film does not show the vertebra, so that its measured values are interpolated between its neighbours",
        |row| !row.measured().is_measured(),
    );
    add.text(
        "origin",
        "how its corners came about: `clicked`, `completed`, `detected`, `accepted` or `adjusted`, and `mixed` where corners or readings differ; empty where no corners are known",
        |row| row.measured().origin.map(|origin| origin.key()),
    );
}

fn simulation<'a>(row: &VertebraRow<'a>) -> Option<&'a Simulation> {
    row.simulated.map(|(_, simulation)| simulation)
}

fn simulated(add: &mut Columns<'_, VertebraRow<'_>>) {
    add.truth(
        "fitted",
        "whether the stiffness was fitted to this film; else the film was held out",
        |row| simulation(row).map(|s| s.fitted),
    );
    add.text(
        "status",
        "`converged`, `unreachable`, `beyond_human_range`, `not_converged` or `fit_not_converged`; only the first is a result",
        |row| simulation(row).map(|s| s.status.key()),
    );
    add.number("simulated_y_mm", "simulated midpoint, positive to the patient's left", |row| {
        simulation(row).map(|s| s.shape.locations[row.index].y_mm)
    });
    add.number("simulated_z_mm", "simulated midpoint, positive upwards", |row| {
        simulation(row).map(|s| s.shape.locations[row.index].z_mm)
    });
    add.number("simulated_tilt_deg", "simulated tilt; positive to the patient's right", |row| {
        simulation(row).map(|s| s.tilts[row.index].deg())
    });
    add.number(
        "location_error_mm",
        "location error: distance of the two midpoints (E_LOC); empty for the base, which is fixed, for interpolated vertebrae, and without a result",
        |row| {
                let found = simulation(row).filter(|s| s.is_usable())?;
                found.shape.location_error_mm(row.measured().level)
            },
    );
}
