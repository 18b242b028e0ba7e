//! The sentences in which an analysis answers which line of action the films support.

use super::comparison::{FilmPredictor, FilmRole, LinesCompared, Ranking};
use super::compatibility::{BendEvidence, Compatibility};
use super::inflections::counted_inflections;
use super::{Analysis, FilmMovement, LineModel};
use crate::action::LineKind;
use crate::anatomy::Posture;
use crate::evaluate::{Baseline, Simulation};
use crate::number::{fixed, probability};
use crate::personalize::{FitStatus, TestOutcome};
use crate::warning::{Warning, WarningCode};

impl Analysis {
    /// Whether a warning doubts the posture or the patient of a film.
    #[must_use]
    pub fn has_doubted_film(&self) -> bool {
        self.film_doubts().next().is_some()
    }

    /// The warnings that doubt the posture or the patient of a film.
    pub fn film_doubts(&self) -> impl Iterator<Item = &Warning> {
        self.warnings.all().iter().filter(|warning| warning.code.doubts_film())
    }

    /// The findings on the lines of action, in sentences.
    ///
    /// First the films that may not show what they are named after: such films keep no line. Then, for
    /// every line that is not fitted to the films, whether the bends reject a single force along it
    /// ([`Analysis::compatibility`]), then how well each line predicts films that it was not fitted to, and last how small
    /// its error is on the fitted films, which proves nothing.
    #[must_use]
    pub fn verdict(&self) -> Vec<String> {
        let compared = self.comparison();
        let mut sentences: Vec<String> = self
            .film_doubts()
            .map(|warning| {
                let film =
                    warning.posture.map_or_else(String::new, |posture| format!("{posture} "));
                format!("The {film}film may be wrong: {}.", warning.message)
            })
            .collect();
        if !sentences.is_empty() {
            sentences.push(
                "Until these films are checked, no result of this patient is evidence.".to_owned(),
            );
        }
        if self.models.is_empty() {
            let why = if self.movement.film_without_scale().is_some() {
                "Not every film has a spacing: only angles are measured, and no model is fitted."
            } else {
                "No bending film: the curve is measured, but no stiffness can be fitted."
            };
            sentences.push(why.to_owned());
            return sentences;
        }
        if !self.models.iter().any(|model| model.kind == LineKind::Inflection) {
            sentences.push(self.no_inflection_line());
        }
        for model in self.testable_models() {
            sentences.extend(self.line_verdict(model));
        }
        let keeps_shape = |posture| {
            let mut warnings = self.warnings.all().iter();
            warnings
                .any(|one| one.code == WarningCode::BendKeepsShape && one.posture == Some(posture))
        };
        let bends = self.movement.films.iter().filter(|film| !keeps_shape(film.outline.posture));
        sentences.extend(bends.filter_map(turning_sentence));
        sentences.extend(compared.sentences());
        sentences
    }

    fn no_inflection_line(&self) -> String {
        if self.movement.inflections.pair.is_some() {
            return "The inflection line is missing: see the warnings.".to_owned();
        }
        format!(
            "The inflection line is missing: the erect curve has {} (minimum angle of a curve between inflections: {}).",
            counted_inflections(self.movement.inflections.all.len()),
            self.options.min_curve
        )
    }

    /// How the bends test a single force along a line that was not fitted to them: every kind of line by the same rule.
    fn line_verdict(&self, model: &LineModel) -> Vec<String> {
        let found = self.compatibility(model);
        let force = force_words(model.kind);
        let mut sentences: Vec<String> = found
            .without_force
            .iter()
            .map(|posture| {
                format!("No force {force} was found that reproduces the {}.", bend_name(*posture))
            })
            .collect();
        if !self.has_doubted_film() {
            sentences.extend(rejection(model.kind, &found));
        }
        match found.outcome() {
            TestOutcome::Kept if !self.has_doubted_film() => {
                let joints = match found.bends.iter().map(|bend| bend.against).sum::<usize>() {
                    0 => "no joint turns against it".to_owned(),
                    _ => format!(
                        "{} turn against it, within the noise of landmarks and line",
                        joints_against(&found.bends)
                    ),
                };
                let (bends, verb) = self.tested_by([model]);
                let films = if verb.is_empty() { "bending films" } else { bends.as_str() };
                sentences.push(format!(
                    "A single force {force} is kept by the {films}: {joints}. {}",
                    what_kept_means(model.kind)
                ));
            }
            TestOutcome::NotTested => sentences.push(format!(
                "A single force {force} is not tested: {}.",
                self.not_tested_words(model)
            )),
            TestOutcome::Kept | TestOutcome::Rejected => {}
        }
        sentences
    }

    /// The bends that test the lines of models, after "the", and the ending of their verb.
    pub(super) fn tested_by<'a>(
        &self,
        models: impl IntoIterator<Item = &'a LineModel>,
    ) -> (String, &'static str) {
        let all = models.into_iter().flat_map(|model| self.compatibility(model).bends);
        let tested = all.filter(|bend| bend.outcome() != TestOutcome::NotTested);
        let mut bends = tested.map(|bend| bend.posture);
        match bends.next() {
            Some(first) if bends.all(|other| other == first) => (bend_name(first), "s"),
            _ => ("bends".to_owned(), ""),
        }
    }

    /// Why no bend tests a model's line.
    pub(super) fn not_tested_words(&self, model: &LineModel) -> &'static str {
        let mut bends = model.simulations.iter().filter(|s| s.fitted && s.has_force());
        let lacks_crests = |s: &Simulation| {
            let film = self.movement.film(s.shape.posture);
            film.is_some_and(|film| film.outline.iliac_normal.is_none())
        };
        if !bends.clone().any(|_| true) {
            "the model reproduces no bend"
        } else if model.kind == LineKind::Iliac && bends.all(lacks_crests) {
            "the iliac crests are not marked on the bends"
        } else {
            "the line of best fit to the rotations was not found"
        }
    }
}

/// A force of a line, after "a single force".
const fn force_words(kind: LineKind) -> &'static str {
    match kind {
        LineKind::Inflection => "through the inflections",
        LineKind::Iliac => "along the iliac line",
        LineKind::Given => "along the given line",
        LineKind::Estimated => "along the estimated line",
    }
}

/// What the test cannot tell apart, where it keeps a line (`validation/claims.md`).
const fn what_kept_means(kind: LineKind) -> &'static str {
    match kind {
        LineKind::Iliac => {
            "The films are consistent with a horizontal load, and cannot tell a force at the top vertebra from a distributed load."
        }
        LineKind::Inflection | LineKind::Given | LineKind::Estimated => {
            "This does not prove such a force."
        }
    }
}

/// "left bend".
fn bend_name(posture: Posture) -> String {
    posture.bend().map_or_else(|| posture.to_string(), |side| format!("{side} bend"))
}

/// "9 of 14 joints in the left bend and 3 of 14 in the right bend".
fn joints_against(bends: &[BendEvidence]) -> String {
    let parts = bends.iter().enumerate().map(|(i, bend)| {
        let joints = if i == 0 { " joints" } else { "" };
        format!("{} of {}{joints} in the {}", bend.against, bend.joints, bend_name(bend.posture))
    });
    listed(&parts.collect::<Vec<_>>())
}

/// Which bends reject the line, and why: joints that turn against it, and the place of the load.
fn rejection(kind: LineKind, found: &Compatibility) -> Option<String> {
    let rejects = |bend: &BendEvidence| bend.outcome() == TestOutcome::Rejected;
    let against: Vec<BendEvidence> = found.bends.iter().copied().filter(rejects).collect();
    if against.is_empty() {
        return None;
    }
    let whole = against.len() == found.bends.len() && against.len() > 1;
    let who = if whole {
        "the bends of this patient".to_owned()
    } else {
        let names: Vec<String> = against.iter().map(|bend| bend_name(bend.posture)).collect();
        format!("the {} of this patient", listed(&names))
    };
    let several = against.len() > 1;
    let joints: Vec<BendEvidence> =
        against.iter().copied().filter(BendEvidence::joints_reject).collect();
    let joints: Vec<String> =
        joints.iter().enumerate().map(|(i, bend)| joints_words(bend, i == 0, several)).collect();
    let joints = (!joints.is_empty()).then(|| listed(&joints));
    let places = against.iter().filter(|bend| bend.line_rejects());
    let places = places.filter_map(|bend| place_words(kind, bend, found.tests, several));
    let reasons: Vec<String> = joints.into_iter().chain(places).collect();
    Some(format!(
        "A single force {} is rejected by {who}: {}.",
        force_words(kind),
        reasons.join("; ")
    ))
}

fn joints_words(bend: &BendEvidence, is_first: bool, several: bool) -> String {
    let joints = if is_first { " joints" } else { "" };
    let place =
        if several { format!(" in the {}", bend_name(bend.posture)) } else { String::new() };
    format!(
        "{} of {}{joints}{place} turn against it ({} beyond noise, {} % of the work)",
        bend.against,
        bend.joints,
        bend.beyond_noise,
        fixed(100.0 * bend.weight, 0)
    )
}

/// Where the line of best fit to the rotations lies instead.
fn place_words(kind: LineKind, bend: &BendEvidence, tests: usize, several: bool) -> Option<String> {
    let (test, p) = bend.line_test.zip(bend.line_p)?;
    let place =
        if several { format!("in the {} ", bend_name(bend.posture)) } else { String::new() };
    let (distance, angle) = (fixed(test.distance_mm, 0), test.angle.text(0));
    let where_it_lies = match kind {
        LineKind::Iliac => {
            format!("at {angle} to the iliac line, {distance} mm from the top of the model")
        }
        LineKind::Inflection => format!(
            "{distance} mm from the midpoint of the inflections, at {angle} to the line through them"
        ),
        LineKind::Given | LineKind::Estimated => {
            format!("{distance} mm from this line, at {angle} to it")
        }
    };
    Some(format!(
        "{place}the line of best fit to the rotations is {where_it_lies} (p {}, corrected for {tests} tests)",
        probability(p)
    ))
}

impl LinesCompared {
    /// Comparison of the lines: predicted films first, fitted films last, with their limits as evidence.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        for (role, what) in [
            (FilmRole::LeftOutBend, "Bends left out of the fit in turn and predicted"),
            (FilmRole::HeldOut, "Neutral and traction films, predicted"),
        ] {
            sentences.extend(self.errors_words(role).map(|errors| {
                let baselines = self.baseline_words(role).unwrap_or_default();
                format!("{what}: {errors}{baselines}.")
            }));
            sentences.extend(self.with_tilt_words(role));
        }
        sentences.extend(self.lost_fits());
        if let Some(ranking) = self.ranking() {
            sentences.extend(self.behind_words(&ranking));
            sentences.extend(self.prediction_verdict(&ranking));
        }
        sentences.extend(self.errors_words(FilmRole::Fitted).map(|errors| {
            format!("Fitted bends: {errors}. A small fit error is not evidence for a line.")
        }));
        sentences
    }

    /// The fits without a bend that did not converge, one in a sentence.
    pub fn lost_fits(&self) -> impl Iterator<Item = String> {
        let models =
            self.left_out.iter().flat_map(|bend| bend.models.iter().map(move |m| (bend, m)));
        let lost = models.filter(|(_, model)| model.fit.status != FitStatus::Converged);
        lost.map(|(bend, model)| {
            format!(
                "Without the {} the fit of the {} did not converge, so it does not predict this bend.",
                bend_name(bend.posture),
                model.kind
            )
        })
    }

    /// Errors of the predictions without mechanics on the films of a role, from the location of the top vertebra.
    fn baseline_words(&self, role: FilmRole) -> Option<String> {
        let found = self.predicted_words(role, |by| !by.is_line() && !by.knows_tilt())?;
        Some(format!("; without mechanics: {found}"))
    }

    /// Errors of all predictions of the films of a role from location and tilt of the top vertebra.
    fn with_tilt_words(&self, role: FilmRole) -> Option<String> {
        let of =
            |is_line| self.predicted_words(role, |by| by.is_line() == is_line && by.knows_tilt());
        let without = of(false).map(|without| format!("without mechanics: {without}"));
        let parts: Vec<String> = of(true).into_iter().chain(without).collect();
        let words = || format!("With the tilt of the top vertebra too: {}.", parts.join("; "));
        (!parts.is_empty()).then(words)
    }

    /// Mean location errors of some predictors of the films of a role, the smallest first.
    fn predicted_words(
        &self,
        role: FilmRole,
        is_meant: impl Fn(FilmPredictor) -> bool,
    ) -> Option<String> {
        let meant = self.predictors().filter(|by| is_meant(*by));
        let mut found: Vec<(f64, FilmPredictor)> =
            meant.filter_map(|by| Some((self.error_mm(by, role)?, by))).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let words = |(mm, by): &(f64, FilmPredictor)| format!("{by} {} mm", fixed(*mm, 1));
        (!found.is_empty()).then(|| listed(&found.iter().map(words).collect::<Vec<_>>()))
    }

    /// Mean location errors by line, the smallest first, each over the films on which the line has a result; `None` where no
    /// line has one.
    fn errors_words(&self, role: FilmRole) -> Option<String> {
        let all = self.count(role);
        let mut found: Vec<(f64, String)> = self
            .lines
            .iter()
            .enumerate()
            .filter_map(|(i, line)| {
                let errors = self.errors(i, role)?;
                let mut remarks = Vec::new();
                if errors.films < all {
                    remarks.push(format!("{} of {all} films", errors.films));
                }
                if role == FilmRole::Fitted {
                    remarks.push(format!("{} parameters fitted", line.numbers.fitted()));
                } else if line.numbers.per_predicted_film > 1 {
                    let more = line.numbers.per_predicted_film - 1;
                    remarks.push(format!("with {more} more parameters from each of these films"));
                }
                let mm = errors.location_mm;
                let remarks = if remarks.is_empty() {
                    String::new()
                } else {
                    format!(" ({})", remarks.join(", "))
                };
                Some((mm, format!("{} {} mm{remarks}", line.kind, fixed(mm, 1))))
            })
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let parts: Vec<String> = found.into_iter().map(|(_, words)| words).collect();
        (!parts.is_empty()).then(|| listed(&parts))
    }

    /// Whether one of the ranked lines is the nearest on every one of their films.
    fn prediction_verdict(&self, ranking: &Ranking) -> Option<String> {
        let ranked: Vec<(usize, LineKind)> = self
            .lines
            .iter()
            .enumerate()
            .filter(|(_, line)| ranking.lines.iter().any(|(kind, _)| *kind == line.kind))
            .map(|(place, line)| (place, line.kind))
            .collect();
        let nearest: Vec<LineKind> = ranking
            .films
            .iter()
            .filter_map(|&film| {
                let film = &self.films[film];
                let error = |line: usize| {
                    film.simulations[line]
                        .as_ref()
                        .map_or(f64::INFINITY, |found| found.shape.mean_location_error_mm())
                };
                ranked.iter().min_by(|a, b| error(a.0).total_cmp(&error(b.0))).map(|one| one.1)
            })
            .collect();
        let films = nearest.len();
        if films == 0 || ranked.len() < 2 {
            return None;
        }
        let names: Vec<String> = ranked.iter().map(|(_, kind)| format!("the {kind}")).collect();
        let best = nearest[0];
        Some(if films > 1 && nearest.iter().all(|&line| line == best) {
            format!(
                "Of {}, which take one parameter from each predicted film, the {best} has the smallest error on all {films} predicted films. One patient has too few films for a test.",
                listed(&names)
            )
        } else if films == 1 {
            "One predicted film is not enough to compare the lines.".to_owned()
        } else {
            let counts: Vec<String> = ranked
                .iter()
                .map(|(_, kind)| {
                    let won = nearest.iter().filter(|line| *line == kind).count();
                    format!("the {kind} on {won}")
                })
                .collect();
            format!(
                "No line has the smallest error on all {films} predicted films: {}.",
                listed(&counts)
            )
        })
    }

    /// The lines that predict no better than joint rotations without mechanics, or that no line predicts the films.
    fn behind_words(&self, ranking: &Ranking) -> Option<String> {
        if !ranking.is_prediction() {
            return Some(self.no_prediction_words(ranking));
        }
        let (baseline, best_mm) = ranking.baseline?;
        let behind: Vec<String> = ranking
            .lines
            .iter()
            .filter(|(_, mm)| *mm >= best_mm)
            .map(|(kind, _)| format!("the {kind}"))
            .collect();
        (!behind.is_empty()).then(|| {
            format!(
                "Not better than without mechanics on the same films: {}.{}",
                listed(&behind),
                mirrored_words(baseline)
            )
        })
    }

    /// That no line predicts the films of a ranking, and by which limit.
    pub(super) fn no_prediction_words(&self, ranking: &Ranking) -> String {
        let (best, mm) = ranking.best();
        let numbers = self.per_predicted_film(FilmPredictor::Line(best));
        no_prediction_words(numbers, &self.ranked_films_words(ranking), best, mm)
    }

    /// The films of a ranking, after "on".
    pub(super) fn ranked_films_words(&self, ranking: &Ranking) -> String {
        let films = ranking.role.films_words();
        let (shared, all) = (ranking.films.len(), self.count(ranking.role));
        if shared == all {
            films.to_owned()
        } else {
            format!("{films} ({shared} of {all}, which all of these lines predict)")
        }
    }
}

/// "line with one number per film": the lines that take this count of numbers from a predicted film.
pub(super) fn line_with_numbers(per_film: usize) -> String {
    match per_film {
        1 => "line with one number per film".to_owned(),
        several => format!("line with {several} numbers per film"),
    }
}

/// That no line with this count of numbers per film predicts films, and by which limit.
pub(crate) fn no_prediction_words(per_film: usize, films: &str, best: LineKind, mm: f64) -> String {
    format!(
        "No {} predicts {films}: the smallest mean error, with the {best}, is {} mm, above the limit of {} mm.",
        line_with_numbers(per_film),
        fixed(mm, 1),
        fixed(Ranking::MAX_PREDICTED_MM, 0)
    )
}

/// "a", "a and b", "a, b and c".
pub(crate) fn listed(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [one] => one.clone(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

/// How many joints turn to the side of the bend. A single force that crosses the spine twice turns them both ways.
fn turning_sentence(posture: &FilmMovement) -> Option<String> {
    let side = posture.outline.posture.bend()?;
    let joints = &posture.evidence.as_ref()?.joints;
    let same = joints.iter().filter(|joint| joint.rotation.side() == Some(side)).count();
    let name = bend_name(posture.outline.posture);
    Some(format!("In the {name} {same} of {} joints turn to the {side}.", joints.len()))
}

/// What follows where the other bend, mirrored, predicts as well as a line.
pub(super) const fn mirrored_words(best: Baseline) -> &'static str {
    match best {
        Baseline::MirroredBend => " The bends mirror each other: no test of mechanics.",
        _ => "",
    }
}
