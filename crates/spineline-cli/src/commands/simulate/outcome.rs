//! A simulation from its loads to its outputs.

use std::ops::Deref;

use spineline::analysis::PersonalisedModel;
use spineline::anatomy::{Region, Side};
use spineline::multibody::Goal;
use spineline::response::{OnSignedPoint, measure_angles};
use spineline::spatial::Angle;
use spineline::uncertainty::LoadedUncertainty;
use spineline::warning::WarningCode;
use spineline_files::{LoadFile, Simulated, SimulationError, SimulationFile, SimulationWarning};
use spineline_report::figures::loaded_spine;
use spineline_report::loaded_tables::LoadedTables;
use spineline_tables::{LoadedShape, Table, loaded_measures_table, path_table};

use super::args::SimulateArgs;
use super::replicates::Source;
use crate::analysis::replicates::interruption_text;
use crate::run::failure::Failure;
use crate::run::provenance::generator;

const INTERRUPTED: WarningCode = WarningCode::ReplicatesInterrupted;

/// A model, its loads, and its response.
pub struct Outcome {
    simulated: Simulated,
    /// The case of the model, where replicates are asked for.
    pub source: Option<Source>,
    /// Their statistics; `None` if none was finished.
    pub uncertainty: Option<LoadedUncertainty>,
}

impl Deref for Outcome {
    type Target = Simulated;

    fn deref(&self) -> &Simulated {
        &self.simulated
    }
}

impl Outcome {
    /// Loads a model; the callback gets every shape and may interrupt the search.
    pub fn of(
        args: &SimulateArgs,
        model: PersonalisedModel,
        loads: LoadFile,
        notes: Vec<SimulationWarning>,
        on_point: OnSignedPoint<'_>,
    ) -> Result<Self, Failure> {
        let goal = goal(args)?;
        // Without a load file, errors name the model file.
        let place_name = args.load.as_deref().unwrap_or(&args.model);
        let found = Simulated::of(model, loads, goal, args.largest_factor, notes, on_point);
        let outcome = |simulated| Self { simulated, source: None, uncertainty: None };
        found.map(outcome).map_err(|error| match &error {
            SimulationError::Loads(error) => Failure::file(place_name, error),
            SimulationError::NothingGrows => Failure::usage(
                "--amplitude needs proportional loads, and all loads of this file are constant",
            ),
            SimulationError::LargestFactor(text) => Failure::usage(text),
            SimulationError::Springs(text) => {
                Failure::input(args.model.display(), text, error.help())
            }
            _ => Failure::of(place_name.display(), &error),
        })
    }

    /// Runs the replicates that are asked for under the same loads; their interruption is a warning of the simulation.
    pub fn with_replicates(
        mut self,
        args: &SimulateArgs,
        source: Option<Source>,
    ) -> Result<Self, Failure> {
        self.source = source;
        if let Some(source) = &self.source {
            self.uncertainty = source.run(args, &self.simulated, &self.tables().measures())?;
            let asked = source.asked.count;
            let done = self.uncertainty.as_ref().map_or(0, |found| found.done);
            if done < asked {
                let (code, text) = (INTERRUPTED, interruption_text(done, asked));
                self.simulated.warnings.push(SimulationWarning::new(code, text));
            }
        }
        Ok(self)
    }

    pub fn has_interrupted_replicates(&self) -> bool {
        self.warnings.iter().any(|warning| warning.code == INTERRUPTED)
    }

    /// What is measured before and under the loads, as a table.
    pub fn measures(&self) -> Table {
        let measures = self.tables().measures();
        loaded_measures_table(&self.simulated, &measures, self.uncertainty.as_ref())
    }

    /// The shapes of both paths as a table. Positive Cobb angles, tilt ranges and Ferguson angles are convex to the patient's
    /// left.
    pub fn path(&self) -> Table {
        let points = self.response.paths.iter().flat_map(|of| {
            let sign = of.sign;
            of.path.points.iter().map(move |point| (sign, point))
        });
        let shapes = points.map(|(sign, point)| LoadedShape {
            case_id: &self.model.case_id,
            synthetic: self.model.synthetic,
            absolute: self.model.absolute,
            status: self.response.ending.key(),
            sign,
            point,
            angles: measure_angles(&point.deformed, &self.places),
        });
        let shapes: Vec<LoadedShape<'_>> = shapes.collect();
        let top = self.model.levels.last().map(|level| level.name().to_lowercase());
        let regions: Vec<Region> = self.places.iter().map(|place| place.bounds.region).collect();
        path_table(&top.unwrap_or_default(), &regions, &shapes)
    }

    pub fn file(&self) -> SimulationFile {
        let file = self.simulated.file(&generator());
        match &self.uncertainty {
            Some(found) => file.with_uncertainty(found),
            None => file,
        }
    }

    /// Its texts and tables.
    pub fn tables(&self) -> LoadedTables<'_> {
        LoadedTables {
            simulated: &self.simulated,
            film: self.source.as_ref().map(Source::film),
            uncertainty: self.uncertainty.as_ref(),
        }
    }

    pub fn svg(&self) -> String {
        loaded_spine(&self.simulated)
    }
}

fn goal(args: &SimulateArgs) -> Result<Goal, Failure> {
    let (Some(degrees), Some(towards)) = (args.amplitude, args.towards) else {
        if args.largest_factor.is_some_and(|factor| factor < 1.0) {
            return Err(Failure::usage(
                "--largest-factor below 1 excludes the full loads; omit it, or give --amplitude",
            ));
        }
        return Ok(Goal::FullLoad);
    };
    let tilt = Angle::from_deg(degrees);
    Ok(Goal::LateralTilt(match towards {
        Side::Right => tilt,
        Side::Left => -tilt,
    }))
}
