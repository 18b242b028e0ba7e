//! Lines of action on the same films, with the numbers of their parameters and every bend left out once.

use super::models::{FitTask, bending_loads, fit_model, settings_of};
use super::{Analysis, LineModel};
use crate::action::LineKind;
use crate::anatomy::Posture;
use crate::evaluate::{
    Baseline, BaselinePrediction, RotationPrior, Simulation, joint_rotations, predict_baseline,
    predict_from_prior, published_lateral_bending,
};
use crate::measure::Outline;
use crate::multibody::Load;
use crate::personalize::{FitTarget, Gauge};
use crate::warning::Warnings;

/// What the stiffness knew of a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilmRole {
    /// It was fitted to it: a small error says how much the line can bend to data, not that it is right.
    Fitted,
    /// A bend, predicted with the stiffness that the other bend alone gave.
    LeftOutBend,
    /// A neutral or traction film, which no fit ever sees.
    HeldOut,
}

impl FilmRole {
    /// All, the fitted ones first.
    pub const ALL: [Self; 3] = [Self::Fitted, Self::LeftOutBend, Self::HeldOut];

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Fitted => "fitted",
            Self::LeftOutBend => "left_out_bend",
            Self::HeldOut => "held_out",
        }
    }
}

impl std::fmt::Display for FilmRole {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Fitted => "fitted bends",
            Self::LeftOutBend => "bends left out",
            Self::HeldOut => "neutral, traction",
        })
    }
}

/// Numbers that a model takes from films.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FreeNumbers {
    /// Stiffness multipliers; one less than there are groups, since their level changes no shape, but for
    /// [`Gauge::FrozenForce`].
    pub multipliers: usize,
    /// Forces, one per fitted film.
    pub forces: usize,
    /// Numbers that place and direct the fitted films' loads beside their force: none for a line that geometry gives, two
    /// per film for a free one.
    pub line: usize,
    /// Numbers that every further film gives before it is predicted: its force, and what places a free load.
    pub per_predicted_film: usize,
}

impl FreeNumbers {
    /// Of a fitted model.
    #[must_use]
    pub fn of(model: &LineModel, gauge: Gauge) -> Self {
        let level = usize::from(gauge != Gauge::FrozenForce);
        let components = model.fit.loads.iter().map(Vec::len);
        Self {
            multipliers: model.groups.len() - level,
            forces: components.len(),
            line: components.clone().map(|n| n.saturating_sub(1)).sum(),
            per_predicted_film: components.max().unwrap_or(1),
        }
    }

    /// Numbers that were fitted together.
    #[must_use]
    pub const fn fitted(&self) -> usize {
        self.multipliers + self.forces + self.line
    }
}

/// One line of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ComparedLine {
    /// The line.
    pub kind: LineKind,
    /// What it takes from films.
    pub numbers: FreeNumbers,
    /// What it was fitted to: a free load needs the whole shape, also where the others are fitted to Ferguson angles.
    pub target: FitTarget,
}

/// One film under every line.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedFilm {
    /// The posture.
    pub posture: Posture,
    /// What the stiffness knew of it.
    pub role: FilmRole,
    /// By line; `None` where a line has no result on it.
    pub simulations: Vec<Option<Simulation>>,
    /// Predictions without mechanics; none for a fitted film.
    pub baselines: Vec<BaselinePrediction>,
}

impl ComparedFilm {
    /// The prediction of a baseline, where it has a result.
    #[must_use]
    pub fn baseline(&self, baseline: Baseline) -> Option<&BaselinePrediction> {
        self.baselines.iter().find(|one| one.baseline == baseline && one.is_usable())
    }

    /// Whether every line has a result: lines are compared on such films only.
    #[must_use]
    pub fn is_common(&self) -> bool {
        self.simulations.iter().all(Option::is_some)
    }
}

/// A bend, and the models that were fitted to the other one.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOutBend {
    /// The bend that no part of these models has seen, but for its force and, for a free load, its line.
    pub posture: Posture,
    /// One model per line; its postures are the two bends.
    pub models: Vec<LineModel>,
}

/// The lines of one patient on the same films.
#[derive(Debug, Clone, PartialEq)]
pub struct LinesCompared {
    /// The lines that have a model.
    pub lines: Vec<ComparedLine>,
    /// Every film once per role: fitted, then left out, then held out.
    pub films: Vec<ComparedFilm>,
    /// The fits without one of the bends; empty where there is but one.
    pub left_out: Vec<LeftOutBend>,
}

/// Mean errors of one line over the films that all lines could simulate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanErrors {
    /// Films.
    pub films: usize,
    /// Mean location error of their vertebrae.
    pub location_mm: f64,
    /// Mean absolute Ferguson error of their regions, in degrees.
    pub ferguson_deg: f64,
}

impl LinesCompared {
    /// Films of a role, and how many of them are left out of the comparison, since some line has no result there.
    #[must_use]
    pub fn counted(&self, role: FilmRole) -> (usize, usize) {
        let films = || self.films.iter().filter(|film| film.role == role);
        (films().count(), films().filter(|film| !film.is_common()).count())
    }

    /// Mean errors of a line, by its place, over the common films of a role.
    #[must_use]
    pub fn errors(&self, line: usize, role: FilmRole) -> Option<MeanErrors> {
        let films = self.films.iter().filter(|film| film.role == role && film.is_common());
        let found: Vec<&Simulation> =
            films.filter_map(|film| film.simulations[line].as_ref()).collect();
        let films = found.len();
        let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
        let mm = found.iter().flat_map(|s| s.location_errors_mm.iter().copied()).collect();
        let deg = found.iter().flat_map(|s| ferguson_errors_deg(s)).collect();
        (films > 0).then(|| MeanErrors { films, location_mm: mean(mm), ferguson_deg: mean(deg) })
    }

    /// Mean location error of a baseline over the films of a role on which all lines and this baseline have a result.
    #[must_use]
    pub fn baseline_error_mm(&self, baseline: Baseline, role: FilmRole) -> Option<f64> {
        let films = self.films.iter().filter(|film| film.role == role && film.is_common());
        let all: Option<Vec<&BaselinePrediction>> =
            films.map(|film| film.baseline(baseline)).collect();
        let errors: Vec<f64> =
            all?.iter().flat_map(|film| film.location_errors_mm.iter().copied()).collect();
        (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / errors.len() as f64)
    }

    /// The prediction without mechanics with the smallest mean location error over the films of a role, with that error, of
    /// those that know no more of a film than a line does.
    #[must_use]
    pub fn best_baseline(&self, role: FilmRole) -> Option<(Baseline, f64)> {
        let errors = Baseline::ALL
            .into_iter()
            .filter(|one| !one.knows_tilt())
            .filter_map(|one| Some((one, self.baseline_error_mm(one, role)?)));
        errors.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The line with the smallest mean location error on bends that were left out, or else on neutral and traction films,
    /// among those that take fewest numbers from a predicted film; with that role. `None` where no film was predicted by all.
    #[must_use]
    pub fn best_predictor(&self) -> Option<(LineKind, FilmRole)> {
        let (role, ranked) = self.ranked_predictors()?;
        Some((ranked.first()?.0, role))
    }

    /// All lines that [`Self::best_predictor`] chooses from, the best first, with the role of the films and their mean
    /// location errors in mm.
    #[must_use]
    pub fn ranked_predictors(&self) -> Option<(FilmRole, Vec<(LineKind, f64)>)> {
        let few = self.lines.iter().map(|line| line.numbers.per_predicted_film).min()?;
        let fair = |i: &usize| self.lines[*i].numbers.per_predicted_film == few;
        [FilmRole::LeftOutBend, FilmRole::HeldOut].into_iter().find_map(|role| {
            let lines = (0..self.lines.len()).filter(fair);
            let errors = |i: usize| Some((self.lines[i].kind, self.errors(i, role)?.location_mm));
            let mut ranked: Vec<(LineKind, f64)> = lines.filter_map(errors).collect();
            ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
            (!ranked.is_empty()).then_some((role, ranked))
        })
    }

    /// Why [`Self::best_predictor`] chooses its line: its error, that of the next line, and that of the best prediction
    /// without mechanics, in a sentence.
    #[must_use]
    pub fn choice_words(&self) -> Option<String> {
        let (role, ranked) = self.ranked_predictors()?;
        let films = match role {
            FilmRole::LeftOutBend => "bends left out of the fit",
            FilmRole::Fitted | FilmRole::HeldOut => "neutral and traction films",
        };
        let (kind, mm) = ranked.first()?;
        let next = ranked.get(1).map_or_else(
            || "no other line can be compared".to_owned(),
            |(kind, mm)| format!("the next, the {kind}, to {mm:.1} mm"),
        );
        let without = self.best_baseline(role).map_or_else(
            || "nothing is predicted without mechanics".to_owned(),
            |(baseline, mm)| format!("the best without mechanics ({baseline}) to {mm:.1} mm"),
        );
        Some(format!(
            "Of the lines that take fewest numbers from a predicted film, the {kind} predicts {films} best: to {mm:.1} mm; {next}; {without}."
        ))
    }

    /// Whether all lines were fitted to the same data.
    #[must_use]
    pub fn same_data(&self) -> bool {
        self.lines.windows(2).all(|pair| pair[0].target == pair[1].target)
    }
}

/// Absolute errors of the Ferguson angles.
pub(crate) fn ferguson_errors_deg(simulation: &Simulation) -> Vec<f64> {
    simulation.ferguson_difference.iter().map(|angle| angle.abs().deg()).collect()
}

impl Analysis {
    /// All lines on the same films, every bend left out once.
    ///
    /// Computed on request, because no other result depends on it: it takes one more fit per line and bend.
    #[must_use]
    pub fn compare_lines(&self) -> LinesCompared {
        let settings = settings_of(self.findings(), &[]);
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
                    model.posture(posture).filter(|s| s.is_usable()).cloned()
                })
                .collect(),
            baselines: self.baselines(posture, role),
        };
        let (mut fitted, mut held_out) = (Vec::new(), Vec::new());
        let moved = self.postures.iter().map(|p| p.outline.posture);
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

    /// Predictions of a film that need no other patient.
    fn baselines(&self, posture: Posture, role: FilmRole) -> Vec<BaselinePrediction> {
        let film = self.posture(posture).filter(|_| role != FilmRole::Fitted);
        let Some(film) = film.map(|film| &film.outline) else { return Vec::new() };
        let other = match posture {
            Posture::LeftBending => self.posture(Posture::RightBending),
            Posture::RightBending => self.posture(Posture::LeftBending),
            _ => None,
        };
        let erect = &self.erect().outline;
        let mirrored = other.map(|bend| joint_rotations(erect, &bend.outline));
        let published = published_lateral_bending(self.levels());
        let patterns = mirrored.map(|pattern| (Baseline::MirroredBend, pattern));
        patterns
            .into_iter()
            .chain([(Baseline::PublishedMobility, published)])
            .map(|(baseline, pattern)| predict_baseline(baseline, &pattern, erect, film))
            .chain(self.predicted_from_priors(film))
            .collect()
    }

    /// Predictions of a film from distributions of joint rotations: one that was given describes bends only.
    fn predicted_from_priors(&self, film: &Outline) -> Vec<BaselinePrediction> {
        let predict =
            |baseline, prior| predict_from_prior(baseline, prior, &self.erect().outline, film);
        let given = self.options.rotation_prior.as_ref().filter(|_| film.posture.bend().is_some());
        match given.and_then(|prior| prior.of(self.levels())) {
            Some(learned) => [Baseline::RotationPrior, Baseline::RotationPriorWithTilt]
                .map(|baseline| predict(baseline, &learned))
                .into(),
            None => {
                let published = RotationPrior::published(self.levels());
                vec![predict(Baseline::RotationPriorWithTilt, &published)]
            }
        }
    }

    /// Fits every line to one bend and predicts the other by the rule of all films that are not fitted: its force alone is
    /// free, and brings T2 where it was.
    fn leave_bends_out(&self) -> Vec<LeftOutBend> {
        let bends: Vec<Posture> = self
            .postures
            .iter()
            .map(|p| p.outline.posture)
            .filter(|posture| posture.bend().is_some())
            .collect();
        if bends.len() < 2 {
            return Vec::new();
        }
        let without = |posture: Posture| {
            // The fits to all bends gave the warnings about the lines already.
            let mut repeated = Warnings::default();
            let mut models = Vec::new();
            for line in &self.models {
                let mut seen: Vec<(_, Load)> =
                    bending_loads(self.findings(), line.kind, &mut repeated);
                seen.retain(|(bend, _)| bend.outline.posture != posture);
                let task = FitTask {
                    bends: &seen,
                    films: &bends,
                    models: &models,
                    estimate: None,
                    other: None,
                };
                let model = fit_model(self.findings(), line.kind, task, &mut repeated);
                models.extend(model);
            }
            LeftOutBend { posture, models }
        };
        bends.iter().map(|&posture| without(posture)).collect()
    }
}
