//! The fits and predictions that compare the lines of one patient.

use super::endings::left_out_warnings;
use super::models::{FitTask, bending_loads, fit_model, free_load, geometric_line, settings_of};
use super::{
    Analysis, ComparedFilm, ComparedLine, FilmMovement, FilmRole, FreeNumbers, LeftOutBend,
    LineModel, LinesCompared,
};
use crate::action::LineKind;
use crate::anatomy::Posture;
use crate::evaluate::{
    Baseline, BaselinePrediction, BeforeTheFilm, FilmShape, RotationPrior, joint_rotations,
    predict_baseline, predict_cubic, predict_from_prior, published_lateral_bending,
};
use crate::measure::Outline;
use crate::multibody::Load;
use crate::personalize::{Base, FitStatus, FitTarget};
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
        let film = |posture, role, models: &[LineModel]| {
            let by_line = |line: &LineModel| models.iter().find(|model| model.kind == line.kind);
            let simulation = |line: &LineModel| {
                by_line(line)?.simulation(posture).filter(|s| s.is_usable()).cloned()
            };
            let predicted = self.movement.film(posture).filter(|_| role != FilmRole::Fitted);
            let predicted = predicted.filter(|film| self.has_lengths(&film.outline));
            let rotations = predicted.map(|film| self.rotation_prior(&film.outline));
            let with_tilt = |line: &LineModel| {
                self.predicted_with_tilt(line.kind, models, predicted?, rotations.as_ref()?)
            };
            ComparedFilm {
                posture,
                role,
                simulations: self.models.iter().map(simulation).collect(),
                with_tilt: self.models.iter().map(with_tilt).collect(),
                baselines: predicted.map_or_else(Vec::new, |film| self.baselines(&film.outline)),
            }
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
        let warnings = left_out_warnings(&left_out);
        LinesCompared { lines: lines.collect(), films, left_out, warnings }
    }

    /// Whether errors on a film are lengths: both it and the erect film have a scale.
    fn has_lengths(&self, film: &Outline) -> bool {
        let erect = &self.movement.erect().outline;
        [film, erect].iter().all(|one| one.scale.has_millimetres())
    }

    /// A film by a line's model, from T2's location and tilt and a distribution of joint rotations.
    fn predicted_with_tilt(
        &self,
        kind: LineKind,
        models: &[LineModel],
        film: &FilmMovement,
        rotations: &RotationPrior,
    ) -> Option<FilmShape> {
        let model = models.iter().find(|model| model.kind == kind)?;
        if model.fit.status != FitStatus::Converged {
            return None;
        }
        let movement = &self.movement;
        // The predictions from T2's location gave the warnings about the lines already.
        let mut repeated = Warnings::default();
        let line = match model.kind {
            LineKind::Estimated => None,
            kind => Some(geometric_line(&self.options, kind, film, &mut repeated)?),
        };
        let before = BeforeTheFilm {
            springs: movement.springs(&model.groups),
            log_multipliers: &model.fit.log_multipliers,
            support: self.options.support,
            rotations,
            base: Base::Fixed,
            knows_tilt: true,
        };
        let posture = film.outline.posture;
        let starts = if line.is_some() {
            let found = model.simulation(posture).filter(|found| found.is_usable());
            found.map(|found| vec![found.force_n / model.fit.absolute_scale]).into_iter().collect()
        } else {
            // The force of a free line comes from the rotations of the film; the others' forces come from T2's location.
            let others = models.iter().filter(|one| one.kind != LineKind::Estimated);
            others.filter_map(|one| Some(free_load(one, posture)?.to_vec())).collect()
        };
        before.predict(&film.outline, line, movement.depth_mm(), starts).ok()
    }

    /// The distribution of rotations that was given for a film, or else the published one.
    fn rotation_prior(&self, film: &Outline) -> RotationPrior {
        let given = self.options.rotation_prior_of(film);
        given.unwrap_or_else(|| RotationPrior::published(self.movement.levels()))
    }

    /// Predictions of a film that need no other patient.
    fn baselines(&self, film: &Outline) -> Vec<BaselinePrediction> {
        let movement = &self.movement;
        let erect = &movement.erect().outline;
        let other = match film.posture {
            Posture::LeftBending => movement.film(Posture::RightBending),
            Posture::RightBending => movement.film(Posture::LeftBending),
            _ => None,
        };
        let mirrored = other.map(|bend| joint_rotations(erect, &bend.outline));
        let published = published_lateral_bending(movement.levels());
        let patterns = mirrored.map(|pattern| (Baseline::MirroredBend, pattern));
        // A published distribution adds little to the published pattern where T2's location alone is known.
        let from_location = self.options.rotation_prior_of(film);
        let from_location = from_location.map(|prior| (Baseline::RotationPrior, prior));
        let with_tilt = (Baseline::RotationPriorWithTilt, self.rotation_prior(film));
        let from_priors = from_location.into_iter().chain([with_tilt]);
        patterns
            .into_iter()
            .chain([(Baseline::PublishedMobility, published)])
            .map(|(baseline, pattern)| predict_baseline(baseline, &pattern, erect, film))
            .chain(
                from_priors
                    .map(|(baseline, prior)| predict_from_prior(baseline, &prior, erect, film)),
            )
            .chain([predict_cubic(erect, film)])
            .collect()
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
