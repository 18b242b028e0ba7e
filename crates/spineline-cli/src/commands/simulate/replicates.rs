//! Replicates of a simulation: the case of the model, and the models of its replicates under the same loads.

use spineline::measure::Outline;
use spineline::response::LoadedMeasure;
use spineline::uncertainty::LoadedUncertainty;
use spineline_files::{ModelSource, Replicates, Request, Simulated, StoredModel};

use super::args::SimulateArgs;
use crate::analysis::replicates::{monte_carlo, run_loaded_replicates};
use crate::run::failure::Failure;
use crate::run::inputs::CaseInput;

/// The case that a model was made from, analysed again, and the replicates that are asked for.
pub struct Source {
    pub case: CaseInput,
    source: ModelSource,
    pub asked: Replicates,
}

impl Source {
    /// From the command line; `None` where no replicates are requested.
    ///
    /// # Errors
    /// If the case is missing, or the model is not made from it.
    pub fn of(args: &SimulateArgs, model: &StoredModel) -> Result<Option<Self>, Failure> {
        let Some(asked) = args.replicates.asked() else { return Ok(None) };
        let Some(path) = &args.case else {
            return Err(Failure::usage(
                "--replicates needs --case CASE, the case that the model was made from: a model holds no landmarks to perturb",
            ));
        };
        let case = CaseInput::read(path)?;
        let source = ModelSource::of(model, &case.case)
            .map_err(|error| Failure::of(path.display(), &error))?;
        Ok(Some(Self { case, source, asked }))
    }

    pub fn request(&self) -> Request {
        let options = self.source.analysis.options.clone();
        Request { options, replicates: Some(self.asked), identifiability: false }
    }

    /// The erect film.
    pub fn film(&self) -> &Outline {
        &self.source.analysis.movement.erect().outline
    }

    /// Runs the replicates under the loads of a simulation. Ctrl-C ends them early; `None` if none was finished then.
    pub fn run(
        &self,
        args: &SimulateArgs,
        simulated: &Simulated,
        measures: &[LoadedMeasure],
    ) -> Result<Option<LoadedUncertainty>, Failure> {
        let loads = simulated.on_replicates(self.source.kind, args.largest_factor);
        let monte_carlo = monte_carlo(&self.case.case, &self.source.analysis, &self.asked)?;
        let (count, threads) = (self.asked.count, args.threads);
        let found = run_loaded_replicates(&monte_carlo, &loads, measures, count, threads)?;
        Ok((found.done > 0).then_some(found))
    }
}
