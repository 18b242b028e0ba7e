//! From the command line to loads.

use spineline::analysis::{FilmLoad, PersonalisedModel};
use spineline::anatomy::Posture;
use spineline::multibody::Timing;
use spineline::spatial::Vec3;
use spineline_files::{AppliedLoad, LoadFile, SimulationWarning, parse_load, read_text};

use super::args::SimulateArgs;
use crate::run::failure::Failure;

/// Reference force of a search for a factor; its size only sets the steps of the path.
const REFERENCE_FORCE: f64 = 100.0;

/// The loads that are asked for, and warnings about them.
pub fn of(
    args: &SimulateArgs,
    model: &PersonalisedModel,
) -> Result<(LoadFile, Vec<SimulationWarning>), Failure> {
    if let Some(path) = &args.load {
        let file = read_text(path).and_then(|text| parse_load(&text));
        return file.map(|file| (file, Vec::new())).map_err(|error| Failure::file(path, &error));
    }
    if let Some(posture) = args.posture {
        return of_posture(args, model, posture);
    }
    let Some(push) = args.push else {
        return Err(Failure::usage("give --load, --push or --posture"));
    };
    let size = match (args.force, args.amplitude) {
        (Some(force), _) => force,
        (None, Some(_)) => REFERENCE_FORCE,
        (None, None) => {
            return Err(Failure::usage(
                "--push needs --force FORCE, or --amplitude DEG to find the force for a lateral tilt",
            ));
        }
    };
    let level = args.level.unwrap_or(model.top());
    let force = Vec3::from(push) * size;
    let load = if args.follow {
        let Some(vertebra) = model.levels.iter().position(|other| *other == level) else {
            return Err(Failure::usage(format!("--level {level} is not in the model")));
        };
        let in_vertebra = model.spine.axes[vertebra].transpose() * force;
        AppliedLoad::FollowerForce {
            level,
            force_in_vertebra_n: in_vertebra.into(),
            point_in_vertebra_mm: [0.0; 3],
            timing: Timing::Proportional,
        }
    } else {
        AppliedLoad::ForceAtPoint {
            level,
            force_n: force.into(),
            point_in_vertebra_mm: [0.0; 3],
            timing: Timing::Proportional,
        }
    };
    Ok((LoadFile::new(vec![load]), Vec::new()))
}

/// The load of a film in the model file.
fn of_posture(
    args: &SimulateArgs,
    model: &PersonalisedModel,
    posture: Posture,
) -> Result<(LoadFile, Vec<SimulationWarning>), Failure> {
    let Some(film) = model.loads.iter().find(|film| film.posture == posture) else {
        let place = args.model.display();
        if model.loads.is_empty() {
            let (text, help) = match model.carried_body_mass_kg {
                None => ("the model has no loads of films", "use --push or --load"),
                Some(_) => (
                    "the model has no loads of films: it was made with `--reference loaded`, so it is of the standing patient",
                    "use --push or --load, or a model of an analysis without --reference",
                ),
            };
            return Err(Failure::input(place, text, help));
        }
        let known: Vec<&str> = model.loads.iter().map(|film| film.posture.key()).collect();
        let text =
            format!("the model has no load for {}; it has {}", posture.key(), known.join(", "));
        let help = "choose one of these, or use --push";
        return Err(Failure::input(place, text, help));
    };
    let notes = SimulationWarning::not_found(film).into_iter().collect();
    let force_n = args.force.map_or(film.force_n, |force| force.copysign(film.force_n));
    let load = AppliedLoad::of_film(&FilmLoad { force_n, ..*film }, model.top());
    Ok((LoadFile::new(vec![load]), notes))
}
