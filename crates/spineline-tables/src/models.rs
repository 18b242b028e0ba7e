use spineline::analysis::{Analysis, LineModel};
use spineline::anatomy::Region;
use spineline::evaluate::{Band, Simulation};
use spineline::hypothesis::{HypothesisFit, ShapePrediction};
use spineline::multibody::JointStiffness;
use spineline::personalize::{
    MULTIPLIER_COVERAGE, MultiplierInformation, ProfileEnd, STIFFNESS_COVERAGE, StiffnessBound,
};

use crate::Patient;
use crate::define::{Columns, ENDS_95, Row, keyed, rows};
use crate::table::Table;

fn absolute(analysis: &Analysis, model: &LineModel) -> bool {
    model.is_absolute(analysis.options.gauge)
}

/// One row per patient and line.
pub(crate) fn models(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| &patient.analysis.models);
    keyed("models", "patient × line", &rows, columns_of_models)
}

fn columns_of_models(add: &mut Columns<'_, Row<'_, &LineModel>>) {
    add.text("line", "line of action that the stiffness was fitted with", |row| row.kind.key());
    add.text("fit_status", "`converged`, `iteration_limit`, `stalled` or `not_evaluable`", |row| {
        row.fit.status.key()
    });
    add.count("iterations", "iterations of the fit", |row| row.fit.iterations as usize);
    add.number(
        "residual_rms",
        "root mean square residual: degrees of Ferguson angles, or standard deviations of a shape (see `fit` in patients)",
        |row| row.fit.residual_rms,
    );
    add.truth(
        "absolute",
        "whether forces and stiffness are absolute; else only ratios are identified",
        |row| absolute(row.analysis, row.item),
    );
    add.number(
        "absolute_scale",
        "factor on springs about all axes; 1 unless a force is known",
        |row| row.fit.absolute_scale,
    );
    add.number(
        "mean_location_error_fitted_mm",
        "mean location error over the fitted films",
        |row| row.mean_location_error_mm(true),
    );
    add.number(
        "mean_location_error_held_out_mm",
        "mean location error over the held-out films",
        |row| row.mean_location_error_mm(false),
    );
}

pub(crate) struct Multiplier<'a> {
    model: &'a LineModel,
    group: usize,
    found: Option<&'a MultiplierInformation>,
}

/// One row per patient, line and group of joints.
pub(crate) fn multipliers(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| {
        let mut all = Vec::new();
        let analysis = patient.analysis;
        for model in &analysis.models {
            let identified =
                patient.identifiability.and_then(|found| analysis.entry_of(model.kind, found));
            all.extend((0..model.groups.len()).map(|group| {
                let found = identified.map(|identified| &identified.multipliers[group]);
                Multiplier { model, group, found }
            }));
        }
        all
    });
    let row = "patient × line × group of joints with one multiplier";
    keyed("multipliers", row, &rows, columns_of_multipliers)
}

fn columns_of_multipliers(add: &mut Columns<'_, Row<'_, Multiplier<'_>>>) {
    add.text("line", "line of action of the model", |row| row.model.kind.key());
    add.text("joints", "region, or joint", |row| row.model.groups.names()[row.group].clone());
    add.number(
        "multiplier",
        "multiplier of the lateral springs; under `geometric_mean` only ratios are identified",
        |row| row.model.multipliers().nth(row.group),
    );
    add.truth("at_bound", "whether it reached a limit and is therefore not identified", |row| {
        row.model.fit.bounds[row.group] != StiffnessBound::Inside
    });
    add.text(
        "verdict",
        "whether the films identify it: `interval`, `only_lower`, `only_upper`, `not_identified`, `disputed` (the multiplier differs from `mean_of_joints` by more than a factor of 1.5, and lies outside of its interval) or `unknown`; empty where not requested",
        |row| row.found.map(|found| found.verdict().key()),
    );
    add.number(
        "mean_of_joints",
        "geometric mean of its joints' stiffness over the table's, by the mixed model; empty where not requested or not determined",
        |row| Some(row.found?.stiffness?.log_mean.exp()),
    );
    add.interval(
        ["interval_95_low", "interval_95_high"],
        [
            "lower end of the 95 % interval of `mean_of_joints`; empty where the films set no lower limit",
            "upper end of the 95 % interval of `mean_of_joints`; empty where the films set no upper limit",
        ],
        |row| Some(row.found?.interval_95()?.map(ProfileEnd::multiplier)),
    );
    add.text("interval_coverage", STIFFNESS_COVERAGE, |row| {
        row.found.map(|_| STIFFNESS_COVERAGE.to_owned())
    });
    add.interval(
        ["interval_95_if_exact_low", "interval_95_if_exact_high"],
        [
            "lower end of its 95 % interval if the model is exact; empty where the films set no lower limit",
            "upper end of its 95 % interval if the model is exact; empty where the films set no upper limit",
        ],
        |row| {
            let profile = &row.found?.profile;
            Some([profile.lower, profile.upper].map(ProfileEnd::multiplier))
        },
    );
    add.text("interval_if_exact_coverage", MULTIPLIER_COVERAGE, |row| {
        row.found.map(|_| MULTIPLIER_COVERAGE.to_owned())
    });
    add.number("log_sd", "standard deviation of its logarithm from the films alone", |row| {
        row.found.map(|found| found.log_sd)
    });
    add.number("log_sd_with_prior", "the same with the prior", |row| {
        row.found.and_then(|found| found.log_sd_with_prior)
    });
}

/// The springs of a joint in a model.
pub(crate) struct Springs<'a> {
    model: &'a LineModel,
    nominal: &'a JointStiffness,
    /// About the lateral, flexion and axial hinge.
    personal_nmm_per_rad: [f64; 3],
}

/// One row per patient, line and joint.
pub(crate) fn springs(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| {
        let library = &patient.analysis.movement.library;
        patient.analysis.models.iter().flat_map(move |model| {
            let personal = model.stiffness_nmm_per_rad(library);
            let joints = library.rows().iter().zip(personal);
            joints.map(move |(nominal, personal_nmm_per_rad)| Springs {
                model,
                nominal,
                personal_nmm_per_rad,
            })
        })
    });
    keyed("springs", "patient × line × joint", &rows, columns_of_springs)
}

fn newton_metres(nmm_per_rad: [f64; 3], axis: usize) -> f64 {
    nmm_per_rad[axis] / 1000.0
}

fn columns_of_springs(add: &mut Columns<'_, Row<'_, Springs<'_>>>) {
    add.text("line", "line of action of the model", |row| row.model.kind.key());
    add.text("inferior", "lower vertebra", |row| row.nominal.inferior.to_string());
    add.text("superior", "upper vertebra", |row| row.nominal.superior.to_string());
    add.number("nominal_lateral_nm_per_rad", "lateral stiffness before personalisation", |row| {
        newton_metres(row.nominal.nmm_per_rad, 0)
    });
    add.number(
        "lateral_relative",
        "personalised lateral stiffness relative to the nominal one; without a known force only ratios between joints are identified",
        |row| row.personal_nmm_per_rad[0] / row.nominal.nmm_per_rad[0],
    );
    let personalised = [
        ("lateral_nm_per_rad", "personalised lateral stiffness; empty where no force was measured"),
        ("flexion_nm_per_rad", "personalised stiffness about the flexion hinge, likewise"),
        ("axial_nm_per_rad", "personalised stiffness about the axial hinge, likewise"),
    ];
    for (axis, (name, meaning)) in personalised.into_iter().enumerate() {
        add.number(name, meaning, |row| {
            let known = absolute(row.analysis, row.model);
            known.then(|| newton_metres(row.personal_nmm_per_rad, axis))
        });
    }
    add.text("source", "source of the nominal values", |row| row.nominal.source.clone());
}

/// A line of action on a film.
pub(crate) struct Line<'a> {
    model: &'a LineModel,
    simulation: &'a Simulation,
}

type LineRow<'a> = Row<'a, Line<'a>>;

/// One row per patient, moved posture and line.
pub(crate) fn lines(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| {
        patient.analysis.models.iter().flat_map(|model| {
            model.simulations.iter().map(move |simulation| Line { model, simulation })
        })
    });
    let row = "patient × moved posture × line";
    keyed("lines", row, &rows, |add| {
        columns_of_lines(add);
        errors_of_lines(add);
    })
}

fn columns_of_lines(add: &mut Columns<'_, LineRow<'_>>) {
    add.text("posture", "film", |row| row.simulation.shape.posture.key());
    add.text("line", "line of action", |row| row.model.kind.key());
    add.truth(
        "fitted",
        "whether the stiffness was fitted to this film; else the film was held out",
        |row| row.simulation.fitted,
    );
    add.text(
        "status",
        "`converged`, `unreachable`, `beyond_human_range`, `not_converged` or `fit_not_converged`; only the first is a result",
        |row| row.simulation.status.key(),
    );
    add.number(
        "point_y_mm",
        "lateral coordinate of a point of the line, positive to the patient's left",
        |row| row.simulation.line.point.y_mm,
    );
    add.number("point_z_mm", "its height", |row| row.simulation.line.point.z_mm);
    add.number("lean_deg", "lateral tilt of the line; positive to the patient's right", |row| {
        row.simulation.line.lateral_tilt().deg()
    });
    add.text("application", "`fixed` in space, or `at_t2`", |row| {
        row.simulation.line.application.key()
    });
    add.number("force", "signed force along the line", |row| row.simulation.force_n).unit =
        "N where `absolute`, else relative";
    add.truth("absolute", "whether the force is in newtons; else it is relative", |row| {
        absolute(row.analysis, row.model)
    });
    add.text(
        "choice",
        "rule by which this force was chosen: `fitted`, `only_one`, `least_ferguson_error`, `smallest_near_t2` or `nearest_miss`",
        |row| row.simulation.choice.key(),
    );
    add.count("alternatives", "number of other forces that reach the same amplitude", |row| {
        row.simulation.alternatives.len()
    });
    add.number(
        "film_scale",
        "the film's scale against the erect film: from all vertebrae of a fitted film, from the top vertebra of a predicted one",
        |row| row.simulation.shape.scale.factor,
    );
    add.interval(
        ["film_scale_95_low", "film_scale_95_high"],
        ["lower end of its 95 % interval; empty where it is fixed", ENDS_95[1]],
        |row| {
            let scale = row.simulation.shape.scale;
            (scale.log_sd > 0.0).then(|| scale.interval_95())
        },
    );
}

fn errors_of_lines(add: &mut Columns<'_, LineRow<'_>>) {
    add.number(
        "mean_location_error_mm",
        "mean location error over the vertebrae above the base",
        |row| {
            let found = row.simulation;
            found.is_usable().then(|| found.shape.mean_location_error_mm())
        },
    );
    let of_region = [
        "absolute error of the Ferguson angle of the thoracolumbar/lumbar curve",
        "the same of the main thoracic curve",
        "the same of the proximal thoracic curve",
    ];
    for (region, meaning) in Region::ALL.into_iter().zip(of_region) {
        let name = format!("ferguson_error_{}_deg", region.key());
        add.number(&name, meaning, |row| {
            let found = row.simulation;
            found.is_usable().then(|| found.ferguson_difference[region.index()].abs().deg())
        });
    }
    add.count("joints_against", "number of counter-rotating joints", |row| {
        row.simulation.is_usable().then(|| row.simulation.contradicted.len())
    });
    add.number("work_against", "share of these joints in the work of all joints", |row| {
        row.simulation.is_usable().then(|| row.simulation.contradicted_weight())
    });
}

/// A prediction of another load and base.
pub(crate) struct Predicted<'a> {
    fit: &'a HypothesisFit,
    prediction: &'a ShapePrediction,
    mean_radius_mm: Option<f64>,
}

/// One row per patient, load and base, film and role.
pub(crate) fn hypotheses(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| {
        let mut found = Vec::new();
        let fits = &patient.analysis.hypotheses;
        for (fit, bands) in fits.iter().zip(&patient.analysis.bands().hypotheses) {
            found.extend(fit.predictions.iter().zip(bands).map(|(prediction, band)| {
                let mean_radius_mm = band.as_ref().map(Band::mean_radius_mm);
                Predicted { fit, prediction, mean_radius_mm }
            }));
        }
        found
    });
    let row = "patient × load and base × posture × role";
    keyed("hypotheses", row, &rows, columns_of_hypotheses)
}

fn columns_of_hypotheses(add: &mut Columns<'_, Row<'_, Predicted<'_>>>) {
    add.text("load_and_base", "name of the load, with the base where it is not fixed", |row| {
        row.fit.hypothesis.key()
    });
    add.text("posture", "film", |row| row.prediction.shape.posture.key());
    add.text(
        "role",
        "`fitted`, `held_out`, `left_out`, `left_out_with_prior`, `left_out_with_tilt` or `left_out_load_fitted`",
        |row| row.prediction.role.key(),
    );
    add.text("fit_status", "how the fit to all bends ended", |row| row.fit.ending_key());
    add.number(
        "aicc",
        "Akaike's information criterion of that fit, corrected for small samples",
        |row| row.fit.criteria.aicc,
    );
    add.number("bic", "Bayesian information criterion of that fit", |row| row.fit.criteria.bic);
    add.number(
        "mean_location_error_mm",
        "mean location error over the vertebrae above the base",
        |row| row.prediction.shape.mean_location_error_mm(),
    );
    add.number(
        "mean_band_95_radius_mm",
        "mean radius of its 95 % band; empty where the load was fitted to the film",
        |row| row.mean_radius_mm,
    );
    add.number("rotation_rms_deg", "root mean square error of the joint rotations", |row| {
        row.prediction.rotation_rms.deg()
    });
    add.number(
        "base_deg",
        "rotation of the whole spine about the base; positive to the patient's right",
        |row| row.prediction.base.deg(),
    );
    add.count(
        "joints_against",
        "number of joints that turn against the moment of the load",
        |row| row.prediction.against.joints,
    );
    add.number("work_against", "share of these joints in the work of all joints", |row| {
        row.prediction.against.weight
    });
}
