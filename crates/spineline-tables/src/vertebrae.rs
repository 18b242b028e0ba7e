use spineline::action::LineKind;
use spineline::analysis::PostureAnalysis;
use spineline::evaluate::Simulation;
use spineline::measure::MeasuredVertebra;

use crate::Patient;
use crate::define::{Column, Definition, Row, Unit, keys, number, text, truth};
use crate::table::Table;

/// A vertebra on a film, and under one line of action.
#[derive(Clone, Copy)]
pub(crate) struct Vertebra<'a> {
    posture: &'a PostureAnalysis,
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

/// One row per patient, posture, line and vertebra; of a posture without a model, one per vertebra.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let mut rows: Vec<VertebraRow<'_>> = Vec::new();
    for patient in patients {
        for posture in &patient.analysis.postures {
            let models = patient.analysis.models.iter();
            let of_line = |m: &'_ spineline::analysis::LineModel| m.kind;
            let mut simulated: Vec<Option<(LineKind, &Simulation)>> = models
                .filter_map(|m| m.posture(posture.outline.posture).map(|s| Some((of_line(m), s))))
                .collect();
            if simulated.is_empty() {
                simulated.push(None);
            }
            for simulated in simulated {
                let of_level = |index| Vertebra { posture, index, simulated };
                rows.extend(
                    (0..posture.outline.vertebrae.len())
                        .map(|index| Row { patient, item: of_level(index) }),
                );
            }
        }
    }
    let mut columns = keys();
    columns.extend(measured());
    columns.extend(simulated());
    let row = "patient × posture × line × vertebra; measured values are repeated in the rows of every line, and `line` is empty where there is no model";
    Definition { name: "vertebrae", row, columns }.fill(&rows)
}

fn measured<'a>() -> Vec<Column<VertebraRow<'a>>> {
    vec![
        text("posture", "film", |row| Some(row.item.posture.outline.posture.key().to_owned())),
        text("line", "line of action of the model", |row| {
            row.item.simulated.map(|(kind, _)| kind.key().to_owned())
        }),
        text("level", "vertebra", |row| Some(row.item.measured().level.to_string())),
        text(
            "lengths",
            "plane of the lengths of this film: `patient`, `detector`, `unknown`, or `pixels` without a spacing",
            |row| Some(row.item.posture.outline.scale.plane.key().to_owned()),
        ),
        number(
            "measured_y",
            Unit::Millimetres,
            "measured midpoint relative to that of the base, positive to the patient's left",
            |row| row.item.mm(|vertebra| vertebra.location.y_mm),
        ),
        number(
            "measured_z",
            Unit::Millimetres,
            "measured midpoint relative to that of the base, positive upwards",
            |row| row.item.mm(|vertebra| vertebra.location.z_mm),
        ),
        number("measured_y", Unit::Pixels, "the same where the film has no spacing", |row| {
            row.item.px(|vertebra| vertebra.location.y_mm)
        }),
        number("measured_z", Unit::Pixels, "the same where the film has no spacing", |row| {
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
