use spineline::action::LineKind;
use spineline::analysis::{Analysis, FilmMovement};
use spineline::evaluate::Simulation;
use spineline::measure::MeasuredVertebra;

use crate::Patient;
use crate::define::{
    Column, Definition, LENGTHS, Row, Unit, chosen, keyed, number, refused, text, truth, written,
};
use crate::table::{NumberFormat, Table};

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
        models.filter_map(|model| Some(Some((model.kind, model.posture(posture)?)))).collect();
    if found.is_empty() {
        found.push(None);
    }
    found
}

/// One row per patient, posture, line and vertebra; of a posture without a model, one per vertebra.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let mut rows: Vec<VertebraRow<'_>> = Vec::new();
    for patient in patients {
        for posture in &patient.analysis.movement.films {
            for simulated in simulations(patient.analysis, posture) {
                let of_level = |index| Vertebra { posture, index, simulated };
                rows.extend(
                    (0..posture.outline.vertebrae.len()).map(|index| patient.row(of_level(index))),
                );
            }
        }
    }
    let row = "patient × posture × line × vertebra; measured values are repeated in the rows of every line, and `line` is empty without a model";
    keyed("vertebrae", row, [measured(), simulated()]).fill(&rows)
}

/// The columns of [`errors_table`], in its order.
const OF_ERRORS: [&str; 16] = [
    "case_id",
    "synthetic",
    "posture",
    "level",
    "measured_y_mm",
    "measured_z_mm",
    "measured_tilt_deg",
    "line",
    "fitted",
    "status",
    "simulated_y_mm",
    "simulated_z_mm",
    "simulated_tilt_deg",
    "location_error_mm",
    "lengths",
    "interpolated",
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
    let all = keyed("errors", row, [measured(), simulated()]);
    let columns = chosen(all.columns, &OF_ERRORS).into_iter();
    let columns = columns.map(|column| written(NumberFormat::Places(4), column));
    let columns = columns.chain([refused()]).collect();
    Definition { columns, ..all }.fill(&rows)
}

fn measured<'a>() -> Vec<Column<VertebraRow<'a>>> {
    vec![
        text("posture", "film", |row| Some(row.item.posture.outline.posture.key().to_owned())),
        text("line", "line of action of the model", |row| {
            row.item.simulated.map(|(kind, _)| kind.key().to_owned())
        }),
        text("level", "vertebra", |row| Some(row.item.measured().level.to_string())),
        text("lengths", LENGTHS, |row| Some(row.item.posture.outline.scale.plane.key().to_owned())),
        number(
            "measured_y",
            Unit::Millimetres,
            "measured midpoint relative to the base's midpoint, positive to the patient's left",
            |row| row.item.mm(|vertebra| vertebra.location.y_mm),
        ),
        number(
            "measured_z",
            Unit::Millimetres,
            "measured midpoint relative to the base's midpoint, positive upwards",
            |row| row.item.mm(|vertebra| vertebra.location.z_mm),
        ),
        number("measured_y", Unit::Pixels, "the same on films without a spacing", |row| {
            row.item.px(|vertebra| vertebra.location.y_mm)
        }),
        number("measured_z", Unit::Pixels, "the same on films without a spacing", |row| {
            row.item.px(|vertebra| vertebra.location.z_mm)
        }),
        number(
            "measured_tilt",
            Unit::Degrees,
            "measured tilt; positive to the patient's right",
            |row| Some(row.item.measured().tilt.deg()),
        ),
        truth(
            "interpolated",
            "whether the film does not show the vertebra, so that its measured values are interpolated between its neighbours",
            |row| Some(!row.item.measured().is_measured()),
        ),
        text(
            "origin",
            "how its corners came about: `clicked`, `completed`, `detected`, `accepted` or `adjusted`, and `mixed` where corners or readings differ; empty where no corners are known",
            |row| row.item.measured().origin.map(|origin| origin.key().to_owned()),
        ),
    ]
}

fn simulation<'a>(row: &VertebraRow<'a>) -> Option<&'a Simulation> {
    row.item.simulated.map(|(_, simulation)| simulation)
}

fn simulated<'a>() -> Vec<Column<VertebraRow<'a>>> {
    vec![
        truth(
            "fitted",
            "whether the stiffness was fitted to this film; else the film was held out",
            |row| simulation(row).map(|s| s.fitted),
        ),
        text(
            "status",
            "`converged`, `unreachable`, `beyond_human_range` or `not_converged`; only the first is a result",
            |row| simulation(row).map(|s| s.status.key().to_owned()),
        ),
        number(
            "simulated_y",
            Unit::Millimetres,
            "simulated midpoint, positive to the patient's left",
            |row| simulation(row).map(|s| s.locations[row.item.index].y_mm),
        ),
        number("simulated_z", Unit::Millimetres, "simulated midpoint, positive upwards", |row| {
            simulation(row).map(|s| s.locations[row.item.index].z_mm)
        }),
        number(
            "simulated_tilt",
            Unit::Degrees,
            "simulated tilt; positive to the patient's right",
            |row| simulation(row).map(|s| s.tilts[row.item.index].deg()),
        ),
        number(
            "location_error",
            Unit::Millimetres,
            "location error: distance of the two midpoints (E_LOC); empty for the base, which is fixed, for interpolated vertebrae, and without a result",
            |row| {
                let found = simulation(row).filter(|s| s.is_usable())?;
                found.location_error_mm(row.item.measured().level)
            },
        ),
    ]
}
