//! Films of the model itself, with multipliers that were put into it.

use spineline::action::LineOfAction;
use spineline::analysis::analyze;
use spineline::anatomy::Posture;
use spineline::clinical::Regions;
use spineline::measure::Outline;
use spineline::multibody::{
    FittedSprings, JointGroups, Load, Solution, SpineModel, Statics, StiffnessLibrary, Support,
};
use spineline::personalize::evidence::FilmEvidence;
use spineline::personalize::{FitFilm, FitSettings, Personalization, personalize};
use spineline::spatial::{Angle, Frontal};
use spineline_phantom::{Readers, Scenario, generate};

/// The forces of the films.
pub const FORCES_N: [f64; 2] = [55.0, -40.0];

pub struct Patient {
    pub erect: Outline,
    pub model: SpineModel,
    pub regions: Regions,
    pub library: StiffnessLibrary,
}

pub fn patient(index: usize) -> Patient {
    let phantom = generate(index, Scenario::Bend, &Readers::exact(), 1).expect("18 subjects");
    let analysis = analyze(&phantom.case, &Default::default()).expect("a sound case");
    Patient {
        erect: analysis.movement.erect().outline.clone(),
        model: analysis.movement.spine,
        regions: analysis.movement.regions,
        library: StiffnessLibrary::default(),
    }
}

impl Patient {
    /// Along a line away from most joints, so that the force turns nearly all of them.
    fn load(&self) -> Load {
        let apex = self.erect.vertebrae[self.regions.bounds[1].apex].location;
        let place = Frontal::new(-0.8 * apex.y_mm, apex.z_mm);
        Load::along(LineOfAction::leaning(place, Angle::from_deg(7.0)), 8.0)
    }

    /// The films of a perfect reader of the model under the forces.
    pub fn films(&self, groups: &JointGroups, logs: &[f64], support: Support) -> [Outline; 2] {
        let statics = Statics::new(&self.model, &self.library, groups, logs, support);
        let load = self.load();
        let film = |posture, force_n| {
            let mut solution = Solution::default();
            statics.solve(&load, &[force_n], &[], &mut solution);
            assert!(solution.converged);
            let mut film = self.erect.clone();
            film.posture = posture;
            for (i, vertebra) in film.vertebrae.iter_mut().enumerate() {
                vertebra.location = solution.deformed.location(i);
                vertebra.tilt = solution.deformed.tilt(i);
            }
            film
        };
        [film(Posture::LeftBending, FORCES_N[0]), film(Posture::RightBending, FORCES_N[1])]
    }

    /// Whole shapes with frontal support, without a prior.
    pub fn settings(&self) -> FitSettings<'_> {
        FitSettings::of_shapes(&self.regions, Support::Frontal)
    }

    /// Fits the films, and returns the result of `of` on the fit.
    pub fn fitted<T>(
        &self,
        films: &[Outline; 2],
        erect: &Outline,
        groups: &JointGroups,
        settings: &FitSettings<'_>,
        of: impl FnOnce(&FittedSprings<'_>, &[FitFilm<'_>], Personalization) -> T,
    ) -> T {
        let (model, library) = (&self.model, &self.library);
        let evidence = films
            .each_ref()
            .map(|outline| FilmEvidence::measure(model, library, &self.erect, outline));
        let load = self.load();
        let film = |(outline, evidence)| FitFilm { outline, evidence, load };
        let films: Vec<FitFilm<'_>> = films.iter().zip(&evidence).map(film).collect();
        let springs = FittedSprings { model, erect, library, groups };
        let fit = personalize(springs, &films, settings, None);
        of(&springs, &films, fit)
    }
}
