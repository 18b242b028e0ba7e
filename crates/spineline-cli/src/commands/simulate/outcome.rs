//! A simulation from its loads to everything that is shown of it.

use spineline::anatomy::{Region, Side};
use spineline::clinical::CurvePlaces;
use spineline::multibody::{GeneralStatics, Goal, PathOptions, Timing};
use spineline::response::{
    OnSignedPoint, Response, erect_shape, largest_factor, measure_angles, respond,
};
use spineline::spatial::Angle;
use spineline_files::{LoadFile, PlacedLoads, SimulationFile, SimulationWarning, StoredModel};
use spineline_report::figures::{LoadedSpine, loaded_spine};
use spineline_tables::{LoadedShape, Table, path_table};

use super::args::SimulateArgs;
use super::warnings::{warning, warnings};
use super::words::load_words;
use crate::run::failure::Failure;
use crate::run::provenance::generator;

/// A model, its loads, and what it does.
pub struct Outcome {
    pub model: StoredModel,
    pub loads: LoadFile,
    pub placed: PlacedLoads,
    pub places: Vec<CurvePlaces>,
    pub response: Response,
    pub warnings: Vec<SimulationWarning>,
}

impl Outcome {
    /// Loads a model; the callback gets every shape and may interrupt the search.
    pub fn of(
        args: &SimulateArgs,
        model: StoredModel,
        loads: LoadFile,
        mut notes: Vec<SimulationWarning>,
        on_point: OnSignedPoint<'_>,
    ) -> Result<Self, Failure> {
        // What was not given as a file is a matter of the command line.
        let place_name = args.load.as_deref().unwrap_or(&args.model);
        let placed = loads.place(&model).map_err(|error| Failure::file(place_name, &error))?;
        let goal = goal(args, &placed)?;
        let statics = statics(args, &model)?;
        let places = places(&model, &mut notes);
        let factor = args.largest_factor.unwrap_or_else(|| match goal {
            Goal::FullLoad => PathOptions::default().largest_factor,
            Goal::LateralTilt(_) => largest_factor(&model.spine, &model.stiffness, &placed.loading),
        });
        let response =
            respond(&statics, &placed.loading, goal, factor, on_point).map_err(|error| {
                Failure::input(&place_name.display().to_string(), &error, error.help())
            })?;
        notes.extend(warnings(&model, &loads, &placed, &response));
        Ok(Self { model, loads, placed, places, response, warnings: notes })
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

    /// The simulation as a file.
    pub fn file(&self) -> SimulationFile {
        SimulationFile::new(
            &self.model,
            (&self.loads, &self.placed),
            &self.places,
            &self.response,
            self.warnings.clone(),
            &generator(),
        )
    }

    /// The picture.
    pub fn svg(&self) -> String {
        let words: Vec<String> = self.loads.loads.iter().map(load_words).collect();
        loaded_spine(&LoadedSpine {
            case_id: &self.model.case_id,
            synthetic: self.model.synthetic,
            force_unit: self.model.force_unit(),
            levels: &self.model.levels,
            model: &self.model.spine,
            loading: &self.placed.loading,
            load_of_item: &self.placed.load_of_item,
            load_words: &words,
            response: &self.response,
        })
    }
}

fn goal(args: &SimulateArgs, placed: &PlacedLoads) -> Result<Goal, Failure> {
    let (Some(degrees), Some(towards)) = (args.amplitude, args.towards) else {
        if args.largest_factor.is_some_and(|factor| factor < 1.0) {
            return Err(Failure::usage(
                "--largest-factor below 1 excludes the full loads; omit it, or give --amplitude",
            ));
        }
        return Ok(Goal::FullLoad);
    };
    let timings = placed.loading.items.iter().map(|item| item.timing);
    let mut timings = timings.chain(placed.loading.rods.iter().map(|rod| rod.timing));
    if !timings.any(|timing| timing == Timing::Proportional) {
        return Err(Failure::usage(
            "--amplitude needs proportional loads, and all loads of this file are constant",
        ));
    }
    let tilt = Angle::from_deg(degrees);
    Ok(Goal::LateralTilt(match towards {
        Side::Right => tilt,
        Side::Left => -tilt,
    }))
}

fn statics<'m>(args: &SimulateArgs, model: &'m StoredModel) -> Result<GeneralStatics<'m>, Failure> {
    let springs = model.stiffness.iter().copied();
    GeneralStatics::new(&model.spine, springs, model.support).map_err(|error| {
        let text = match &error {
            spineline::multibody::SpringError::NotPositive { joint } => format!(
                "the stiffness of joint {}/{} is not symmetric and positive definite",
                model.levels[*joint],
                model.levels[joint + 1]
            ),
            other => other.to_string(),
        };
        let help = "correct the stiffness, or write the model again with `analyze`";
        Failure::input(&args.model.display().to_string(), &text, help)
    })
}

/// Where Cobb and Ferguson angles are measured.
fn places(model: &StoredModel, notes: &mut Vec<SimulationWarning>) -> Vec<CurvePlaces> {
    if let Some(curves) = &model.curves {
        return curves.clone();
    }
    let erect = erect_shape(&model.spine);
    let count = model.levels.len();
    let locations: Vec<_> = (0..count).map(|i| erect.location(i)).collect();
    let tilts: Vec<_> = (0..count).map(|i| erect.tilt(i)).collect();
    let usual =
        model.known_levels().and_then(|levels| CurvePlaces::usual(levels, &locations, &tilts));
    let text = if usual.is_some() {
        "the model file has no regions; tilt ranges and Ferguson angles are measured with regions that end at T12 and T6, \
         which may not be those of its analysis; write the model again with `spineline analyze CASE --model FILE`"
    } else {
        "the model file has no regions and does not go from L4 to T2 or a part of it: there are no angles of curves"
    };
    notes.push(warning("usual_regions", text));
    usual.map_or_else(Vec::new, Vec::from)
}
