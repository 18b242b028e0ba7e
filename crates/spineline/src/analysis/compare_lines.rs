//! The fits and predictions that compare the lines of one patient.

use super::models::{FitTask, bending_loads, fit_model, settings_of};
use super::{
    Analysis, ComparedFilm, ComparedLine, FilmRole, FreeNumbers, LeftOutBend, LineModel,
    LinesCompared,
};
use crate::anatomy::Posture;
use crate::evaluate::{
    Baseline, BaselinePrediction, RotationPrior, joint_rotations, predict_baseline, predict_cubic,
    predict_from_prior, published_lateral_bending,
};
use crate::measure::Outline;
use crate::multibody::Load;
use crate::personalize::FitTarget;
use crate::warning::Warnings;

impl Analysis {
    /// All lines on the same films, every bend left out once.
    ///
    /// It is computed on first use, since it takes one more fit per line and bend, and kept: later changes of a field do not change
    /// it.
    #[must_use]
    pub fn comparison(&self) -> &LinesCompared {
        self.comparison.0.get_or_init(|| Box::new(self.compare_lines()))
    }

    fn compare_lines(&self) -> LinesCompared {
        let settings = settings_of(&self.movement, &self.options, &[]);
        let lines = self.models.iter().map(|model| {
            let numbers = FreeNumbers::of(model, self.options.gauge);
            let free = numbers.per_predicted_film > 1;
            let target = if free { FitTarget::Shape } else { settings.target };
            ComparedLine { kind: model.kind, numbers, target }
        });
        let left_out = self.leave_bends_out();
        let film = |posture, role, models: &[LineModel]| ComparedFilm {
            posture,
            role,
            simulations: self
                .models
                .iter()
                .map(|line| {
                    let model = models.iter().find(|model| model.kind == line.kind)?;
                    model.simulation(posture).filter(|s| s.is_usable()).cloned()
                })
                .collect(),
            baselines: self.baselines(posture, role),
        };
        let (mut fitted, mut held_out) = (Vec::new(), Vec::new());
        let moved = self.movement.films.iter().map(|p| p.outline.posture);
        for posture in moved.filter(|posture| *posture != Posture::Erect) {
            match posture.bend() {
                Some(_) => fitted.push(film(posture, FilmRole::Fitted, &self.models)),
                None => held_out.push(film(posture, FilmRole::HeldOut, &self.models)),
            }
        }
        let bends = left_out.iter().map(|b| film(b.posture, FilmRole::LeftOutBend, &b.models));
        let films = fitted.into_iter().chain(bends).chain(held_out).collect();
        LinesCompared { lines: lines.collect(), films, left_out }
    }

    /// Predictions of a film that need no other patient. Their errors are lengths, so both films have a scale.
    fn baselines(&self, posture: Posture, role: FilmRole) -> Vec<BaselinePrediction> {
        let movement = &self.movement;
        let film = movement.film(posture).filter(|_| role != FilmRole::Fitted);
        let Some(film) = film.map(|film| &film.outline) else { return Vec::new() };
        let erect = &movement.erect().outline;
        if ![film, erect].iter().all(|one| one.scale.has_millimetres()) {
            return Vec::new();
        }
        let other = match posture {
            Posture::LeftBending => movement.film(Posture::RightBending),
            Posture::RightBending => movement.film(Posture::LeftBending),
            _ => None,
        };
        let mirrored = other.map(|bend| joint_rotations(erect, &bend.outline));
        let published = published_lateral_bending(movement.levels());
        let patterns = mirrored.map(|pattern| (Baseline::MirroredBend, pattern));
        patterns
            .into_iter()
            .chain([(Baseline::PublishedMobility, published)])
            .map(|(baseline, pattern)| predict_baseline(baseline, &pattern, erect, film))
            .chain(self.predicted_from_priors(film))
            .chain([predict_cubic(erect, film)])
            .collect()
    }

    /// Predictions of a film from distributions of joint rotations: one that was given describes bends only.
    fn predicted_from_priors(&self, film: &Outline) -> Vec<BaselinePrediction> {
        let predict = |baseline, prior| {
            predict_from_prior(baseline, prior, &self.movement.erect().outline, film)
        };
        match self.options.rotation_prior_of(film) {
            Some(learned) => [Baseline::RotationPrior, Baseline::RotationPriorWithTilt]
                .map(|baseline| predict(baseline, &learned))
                .into(),
            None => {
                let published = RotationPrior::published(self.movement.levels());
                vec![predict(Baseline::RotationPriorWithTilt, &published)]
            }
        }
    }

    /// Fits every line to one bend and predicts the other by the rule of all films that are not fitted: only its force is free, and
    /// brings T2 to its place.
    fn leave_bends_out(&self) -> Vec<LeftOutBend> {
        let bends: Vec<Posture> = self.movement.bends().map(|film| film.outline.posture).collect();
        if bends.len() < 2 {
            return Vec::new();
        }
        let without = |posture: Posture| {
            // The fits to all bends gave the warnings about the lines already.
            let mut repeated = Warnings::default();
            let mut models = Vec::new();
            for line in &self.models {
                let mut seen: Vec<(_, Load)> =
                    bending_loads(&self.movement, &self.options, line.kind, &mut repeated);
                seen.retain(|(bend, _)| bend.outline.posture != posture);
                let task = FitTask { bends: &seen, films: &bends, models: &models, start: None };
                let model =
                    fit_model(&self.movement, &self.options, line.kind, task, &mut repeated);
                models.extend(model);
            }
            LeftOutBend { posture, models }
        };
        bends.iter().map(|&posture| without(posture)).collect()
    }
}
