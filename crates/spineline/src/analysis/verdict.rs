use super::analyze::counted;
use super::comparison::{FilmRole, LinesCompared};
use super::compatibility::{BendEvidence, Compatibility};
use super::wrong_film::doubts_film;
use super::{Analysis, LineModel, PostureAnalysis};
use crate::action::LineKind;
use crate::anatomy::Posture;
use crate::evaluate::Baseline;
use crate::warning::Warning;

impl Analysis {
    /// Whether some film may not show the posture or the patient that it is named after, as far as its landmarks show.
    #[must_use]
    pub fn has_doubted_film(&self) -> bool {
        self.film_doubts().next().is_some()
    }

    /// The warnings of films that may not show the posture or the patient that they are named after.
    pub fn film_doubts(&self) -> impl Iterator<Item = &Warning> {
        self.warnings.all().iter().filter(|warning| doubts_film(warning))
    }

    /// The findings on the lines of action, in sentences.
    ///
    /// First the films that may not show what they are named after: then no line is called consistent with them. Then, for
    /// every line that is not fitted to the films, whether the bends are compatible with a single force along it
    /// ([`Analysis::compatibility`]), then how well each line predicts films that it was not fitted to, and last how small
    /// its error is on the fitted films, which proves nothing.
    ///
    /// `compared` is what [`Analysis::compare_lines`] gives.
    #[must_use]
    pub fn verdict(&self, compared: &LinesCompared) -> Vec<String> {
        let mut sentences: Vec<String> = self
            .film_doubts()
            .map(|warning| {
                let film =
                    warning.posture.map_or_else(String::new, |posture| format!("{posture} "));
                format!("The {film}film may be a wrong one: {}.", warning.message)
            })
            .collect();
        if !sentences.is_empty() {
            sentences.push(
                "Until these films are checked, no result of this patient is evidence.".to_owned(),
            );
        }
        if self.models.is_empty() {
            let why = if self.film_without_scale().is_some() {
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
        for model in self.models.iter().filter(|model| model.kind != LineKind::Estimated) {
            sentences.extend(self.line_verdict(model));
        }
        let keeps_shape = |posture| {
            let mut warnings = self.warnings.all().iter();
            warnings.any(|one| one.code == "bend_keeps_shape" && one.posture == Some(posture))
        };
        let bends = self.postures.iter().filter(|film| !keeps_shape(film.outline.posture));
        sentences.extend(bends.filter_map(turning_sentence));
        sentences.extend(compared.sentences());
        sentences
    }

    fn no_inflection_line(&self) -> String {
        if self.inflections.pair.is_some() {
            return "There is no inflection line: see the warnings.".to_owned();
        }
        format!(
            "There is no inflection line: the erect curve has {} (minimum angle of a curve between inflections: {}).",
            counted(self.inflections.all.len()),
            self.options.min_curve
        )
    }

    /// What the bends say of a single force along a line that was not fitted to them: every kind of line by the same rule.
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
        sentences.extend(rejection(model.kind, &found));
        if !found.rejects() && !found.bends.is_empty() && !self.has_doubted_film() {
            let joints = match found.bends.iter().map(|bend| bend.against).sum::<usize>() {
                0 => "no joint turns against it".to_owned(),
                _ => format!(
                    "{} turn against it, within the noise of landmarks and line",
                    joints_against(&found.bends)
                ),
            };
            let untested = if found.bends.iter().any(|bend| bend.line_p.is_some()) {
                ""
            } else {
                "; the line itself could not be tested"
            };
            sentences.push(format!(
                "The bending films are consistent with a single force {force}: {joints}{untested}. This does not prove such a force."
            ));
        }
        sentences
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

/// Which bends are not compatible with the line, and why: joints that turn against it, and the place of the load.
fn rejection(kind: LineKind, found: &Compatibility) -> Option<String> {
    let against: Vec<BendEvidence> =
        found.bends.iter().copied().filter(BendEvidence::rejects).collect();
    if against.is_empty() {
        return None;
    }
    let whole = against.len() == found.bends.len() && against.len() > 1;
    let who = if whole {
        "The bends of this patient are".to_owned()
    } else {
        let names: Vec<String> = against.iter().map(|bend| bend_name(bend.posture)).collect();
        let verb = if against.len() == 1 { "is" } else { "are" };
        format!("The {} of this patient {verb}", listed(&names))
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
        "{who} not compatible with a single force {}: {}.",
        force_words(kind),
        reasons.join("; ")
    ))
}

fn joints_words(bend: &BendEvidence, is_first: bool, several: bool) -> String {
    let joints = if is_first { " joints" } else { "" };
    let place =
        if several { format!(" in the {}", bend_name(bend.posture)) } else { String::new() };
    format!(
        "{} of {}{joints}{place} turn against it ({} beyond noise, {:.0} % of the work)",
        bend.against,
        bend.joints,
        bend.beyond_noise,
        100.0 * bend.weight
    )
}

/// Where the line of best fit to the rotations lies instead.
fn place_words(kind: LineKind, bend: &BendEvidence, tests: usize, several: bool) -> Option<String> {
    let (test, p) = bend.line_test.zip(bend.line_p)?;
    let place =
        if several { format!("in the {} ", bend_name(bend.posture)) } else { String::new() };
    let (mm, deg) = (test.distance_mm, test.angle.deg());
    let where_it_lies = match kind {
        LineKind::Iliac => {
            format!("at {deg:.0}° to the iliac line, {mm:.0} mm from the top of the model")
        }
        LineKind::Inflection => format!(
            "{mm:.0} mm from the midpoint of the inflections, at {deg:.0}° to the line through them"
        ),
        LineKind::Given | LineKind::Estimated => {
            format!("{mm:.0} mm from this line, at {deg:.0}° to it")
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
            let films = match self.counted(role) {
                (_, 0) => String::new(),
                (all, left) => {
                    format!(" (the {} of {all} on which every line has a result)", all - left)
                }
            };
            sentences.extend(self.errors_words(role).map(|errors| {
                let (baselines, behind) = self.baseline_words(role).unwrap_or_default();
                format!("{what}{films}: {errors}{baselines}.{behind}")
            }));
        }
        sentences.extend(self.prediction_verdict());
        sentences.extend(self.errors_words(FilmRole::Fitted).map(|errors| {
            format!("Fitted bends: {errors}. A small error there is no evidence for a line.")
        }));
        sentences
    }

    /// What joint rotations without mechanics predict of the same films, and a sentence on the lines that do no better.
    fn baseline_words(&self, role: FilmRole) -> Option<(String, String)> {
        let mut found: Vec<(f64, Baseline)> = Baseline::ALL
            .into_iter()
            .filter(|one| !one.knows_tilt())
            .filter_map(|one| Some((self.baseline_error_mm(one, role)?, one)))
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (best_mm, _) = *found.first()?;
        let parts: Vec<String> =
            found.iter().map(|(mm, baseline)| format!("{baseline} {mm:.1} mm")).collect();
        let is_behind =
            |i: &usize| self.errors(*i, role).is_some_and(|errors| errors.location_mm >= best_mm);
        let behind: Vec<String> = (0..self.lines.len())
            .filter(is_behind)
            .map(|i| format!("the {}", self.lines[i].kind))
            .collect();
        let sentence = if behind.is_empty() {
            String::new()
        } else {
            format!(" Not better than without mechanics: {}.", listed(&behind))
        };
        let tilt = self.baseline_error_mm(Baseline::RotationPriorWithTilt, role);
        let tilt = tilt.map_or_else(String::new, |mm| format!(" With T2's tilt too: {mm:.1} mm."));
        Some((format!("; without mechanics: {}", listed(&parts)), sentence + &tilt))
    }

    /// Mean location errors by line, the smallest first; `None` where no film is common to all.
    fn errors_words(&self, role: FilmRole) -> Option<String> {
        let mut found: Vec<(f64, String)> = self
            .lines
            .iter()
            .enumerate()
            .filter_map(|(i, line)| {
                let mm = self.errors(i, role)?.location_mm;
                let numbers = match role {
                    FilmRole::Fitted => format!(" ({} parameters fitted)", line.numbers.fitted()),
                    _ if line.numbers.per_predicted_film > 1 => {
                        let more = line.numbers.per_predicted_film - 1;
                        format!(" (with {more} more parameters from each of these films)")
                    }
                    _ => String::new(),
                };
                Some((mm, format!("{} {mm:.1} mm{numbers}", line.kind)))
            })
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let parts: Vec<String> = found.into_iter().map(|(_, words)| words).collect();
        (!parts.is_empty()).then(|| listed(&parts))
    }

    /// Whether one of the lines that take equally few numbers from a predicted film is the nearest on every one of them.
    fn prediction_verdict(&self) -> Option<String> {
        let few = self.lines.iter().map(|line| line.numbers.per_predicted_film).min()?;
        let fair: Vec<usize> = (0..self.lines.len())
            .filter(|&i| self.lines[i].numbers.per_predicted_film == few)
            .collect();
        let nearest: Vec<usize> = self
            .films
            .iter()
            .filter(|film| film.role != FilmRole::Fitted && film.is_common())
            .filter_map(|film| {
                let error =
                    |i: &usize| film.simulations[*i].as_ref().map(|s| s.mean_location_error_mm());
                fair.iter().copied().min_by(|a, b| {
                    error(a).unwrap_or(f64::INFINITY).total_cmp(&error(b).unwrap_or(f64::INFINITY))
                })
            })
            .collect();
        let films = nearest.len();
        if films == 0 || fair.len() < 2 {
            return None;
        }
        let names: Vec<String> =
            fair.iter().map(|&i| format!("the {}", self.lines[i].kind)).collect();
        let best = nearest[0];
        Some(if films > 1 && nearest.iter().all(|&line| line == best) {
            format!(
                "Of {}, which take one parameter from each predicted film, the {} has the smallest error on all {films}. So few films do not allow a statistical test.",
                listed(&names),
                self.lines[best].kind
            )
        } else if films == 1 {
            "One predicted film is not enough to compare the lines.".to_owned()
        } else {
            let counts: Vec<String> = fair
                .iter()
                .map(|&i| {
                    let won = nearest.iter().filter(|&&line| line == i).count();
                    format!("the {} on {won}", self.lines[i].kind)
                })
                .collect();
            format!(
                "No line has the smallest error on all {films} predicted films: {}.",
                listed(&counts)
            )
        })
    }
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
fn turning_sentence(posture: &PostureAnalysis) -> Option<String> {
    let side = posture.outline.posture.bend()?;
    let joints = &posture.evidence.as_ref()?.joints;
    let same = joints.iter().filter(|joint| joint.rotation.side() == Some(side)).count();
    let name = bend_name(posture.outline.posture);
    Some(format!("In the {name} {same} of {} joints turn to the {side}.", joints.len()))
}

/// A p value as text, never as zero.
#[must_use]
pub fn probability(p: f64) -> String {
    if p < 1e-4 { "< 0.0001".to_owned() } else { format!("= {p:.4}") }
}
