//! Sentences about a cohort, shared by all front ends.

use super::films::{chains_sentence, doubted_sentence};
use super::{
    Cohort, ErrorKind, LineOutcomes, LinePairTest, LinesOverPatients, PairedComparison, RoleErrors,
    too_few_words,
};
use crate::analysis::{FilmRole, Ranking, listed, no_prediction_words};
use crate::evaluate::statistics::PairedT;
use crate::number::{fixed, interval, probability, signed};
use crate::warning::counted;

impl Cohort {
    /// Findings, one per sentence.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let mut all = vec![format!(
            "{}{}; {} with exactly two inflections",
            counted(self.patients, "patient"),
            if self.synthetic { " (synthetic)" } else { "" },
            self.two_inflections
        )];
        all.extend(self.verdict());
        all
    }

    /// The findings on the lines: whether the bends reject a single force along each, and which line predicts better. A difference on
    /// fitted films alone is never called better.
    #[must_use]
    pub fn verdict(&self) -> Vec<String> {
        let mut all = Vec::new();
        all.extend(doubted_sentence(&self.doubted_films, self.doubted, self.patients));
        all.extend((self.without_scale > 0).then(|| {
            format!(
                "Films of {} of {} patients have no scale: they do not count in lengths and location errors.",
                self.without_scale, self.patients
            )
        }));
        all.extend(chains_sentence(&self.chains));
        all.extend(self.outcomes.iter().flat_map(LineOutcomes::sentences));
        all.extend(self.compared.sentences());
        all.extend(self.baselines.sentences());
        all
    }
}

impl LinesOverPatients {
    /// Tests in the family that Holm's correction is over.
    #[must_use]
    pub fn family(&self) -> usize {
        self.tests.iter().filter(|test| test.comparison.is_compared()).count()
    }

    /// What the family is.
    #[must_use]
    pub fn family_words(&self) -> String {
        format!(
            "Holm's correction covers {}: every pair of lines, on fitted bends, on left-out bends and on neutral and traction films, by location error and by Ferguson error",
            counted(self.family(), "test")
        )
    }

    /// Which number to use, and why.
    #[must_use]
    pub const fn believe_words(&self) -> &'static str {
        "Use the interval over patients and Holm's p, on films that were not fitted: each patient counts once, the sign-flip test does not assume a normal distribution, and the correction covers all tests. The paper's pooled p treats 14 vertebrae of one spine as 14 patients. A percentile interval of fewer than twenty patients is somewhat narrow; d and its interval assume normally distributed differences"
    }

    /// Which line predicts significantly better, with equally many parameters.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let mut all = Vec::new();
        let family = self.family();
        if family == 0 {
            return all;
        }
        let location = || self.tests.iter().filter(|test| test.error == ErrorKind::Location);
        let predicted = || location().filter(|test| test.role != FilmRole::Fitted);
        all.extend(predicted().filter_map(better_sentence));
        let compared = || predicted().filter(|test| test.comparison.is_compared());
        let fair: Vec<&LinePairTest> = compared().filter(|test| test.is_fair()).collect();
        if compared().next().is_none() {
            all.push(
                "All films were fitted: it cannot be tested which line predicts better.".to_owned(),
            );
        } else if fair.is_empty() {
            all.push(
                "Lines with equally many parameters per film are not tested against each other: fewer than two patients have films that both predict.".to_owned(),
            );
        } else if fair.iter().any(|test| test.holm_p.is_some())
            && fair.iter().all(|test| test.predicts_better().is_none())
        {
            all.push(format!(
                "On films that were not fitted no line predicts significantly better than another with equally many parameters per film (Holm's correction over {family} tests)."
            ));
        }
        all.extend(self.no_prediction_sentences());
        let too_few = || compared().filter(|test| test.holm_p.is_none());
        let differences: Vec<String> = too_few().map(difference).collect();
        if !differences.is_empty() {
            all.push(format!(
                "Too few patients for any p to be significant ({}); the differences, without statistical evidence: {}.",
                too_few_words(family, too_few().map(|test| &test.comparison)),
                differences.join("; ")
            ));
        }
        all.extend(predicted().filter_map(|test| {
            let better = test.predicts_better()?;
            let other = predicted().find(|t| t.lines == test.lines && t.role != test.role)?;
            let divided = test.role == FilmRole::LeftOutBend
                && other.predicts_better().is_some_and(|kind| kind != better);
            let [first, second] = test.lines;
            divided.then(|| {
                format!("Between the {first} and the {second} the result depends on the films.")
            })
        }));
        all.extend(self.fitted_sentence());
        if !self.same_data {
            all.push(
                "A free line was fitted to whole shapes, the others to Ferguson angles: not the same data, so do not rank them on these films.".to_owned(),
            );
        }
        all
    }

    /// Kinds of films on which the mean error of every line with fewest parameters per film is above the limit of a prediction.
    fn no_prediction_sentences(&self) -> Vec<String> {
        let numbers = self.numbers.iter().map(|(_, free)| free.per_predicted_film);
        let Some(few) = numbers.min() else { return Vec::new() };
        let is_fair = |errors: &&RoleErrors| {
            let own = self.numbers.iter().find(|(kind, _)| *kind == errors.kind);
            errors.films > 0 && own.is_some_and(|(_, free)| free.per_predicted_film == few)
        };
        let of_role = |role| {
            let fair = self.of_role(role).filter(is_fair);
            let errors = fair.map(|errors| (errors.kind, errors.mean_location_mm()));
            let (best, mm) = errors.min_by(|a, b| a.1.total_cmp(&b.1))?;
            (mm > Ranking::MAX_PREDICTED_MM)
                .then(|| no_prediction_words(few, role.films_words(), best, mm))
        };
        FilmRole::PREDICTED.into_iter().filter_map(of_role).collect()
    }

    /// Lines with a smaller error on fitted bends that do not predict significantly better.
    fn fitted_sentence(&self) -> Option<String> {
        let location = || self.tests.iter().filter(|test| test.error == ErrorKind::Location);
        let nearer: Vec<String> = location()
            .filter(|test| test.role == FilmRole::Fitted)
            .filter_map(|test| {
                let nearer = test.nearer()?;
                let confirmed = location()
                    .any(|p| p.lines == test.lines && p.predicts_better() == Some(nearer));
                (!confirmed).then(|| {
                    let other = if nearer == test.lines[0] { test.lines[1] } else { test.lines[0] };
                    format!("the {nearer} has a smaller error than the {other}")
                })
            })
            .collect();
        (!nearer.is_empty()).then(|| {
            format!(
                "On fitted bends {}: this shows how well a line adapts to the data and is not evidence for it.",
                listed(&nearer)
            )
        })
    }
}

/// The excess of the error of one line over another's, in words.
fn difference(test: &LinePairTest) -> String {
    let [first, second] = test.lines;
    let mean = test.comparison.mean_difference;
    let (more, less, sign) = if mean > 0.0 { (first, second, 1.0) } else { (second, first, -1.0) };
    format!(
        "on {} the error of the {more} is {} mm larger than the error of the {less} ({})",
        test.role.films_words(),
        fixed(mean.abs(), 1),
        test.comparison.patients_words(sign)
    )
}

/// A significant difference in prediction, and whether the comparison is fair.
fn better_sentence(test: &LinePairTest) -> Option<String> {
    let nearer = test.nearer()?;
    let [first, second] = test.lines;
    let (other, [own, its]) = if nearer == first {
        (second, test.per_predicted_film)
    } else {
        let [a, b] = test.per_predicted_film;
        (first, [b, a])
    };
    let films = test.role.films_words();
    let [low, high] = test.comparison.bootstrap?;
    let (least, most) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
    let interval = if low.signum() == high.signum() {
        format!("{} mm", interval([least, most], 1))
    } else {
        format!("{} to {} mm, first minus second", signed(low, 1), signed(high, 1))
    };
    let caveat = if own > its {
        format!(
            " It takes {} more parameters from each of these films, so the comparison is not fair.",
            own - its
        )
    } else {
        String::new()
    };
    Some(format!(
        "On {films} the error of the {nearer} is smaller than the error of the {other} by {} mm (95 % interval over {} patients {interval}; p {} after Holm's correction).{caveat}",
        fixed(test.comparison.mean_difference.abs(), 1),
        test.comparison.patients(),
        probability(test.holm_p?)
    ))
}

impl PairedComparison {
    /// The paper's pooled test in words; values are in `unit`.
    #[must_use]
    pub fn pooled_words(&self, unit: &str) -> String {
        let pooled = self.pooled.map(|t| test_words(&t, unit, "pairs"));
        pooled.map_or_else(
            || "too few pairs to test".to_owned(),
            |words| format!("{words}, all treated as independent (as in the paper)"),
        )
    }

    /// How many patients, and the 95 % interval of the difference, or of its negative, where they are enough.
    pub(super) fn patients_words(&self, sign: f64) -> String {
        let patients = self.patients();
        self.bootstrap.map_or_else(
            || format!("{patients} patients"),
            |[low, high]| {
                let [a, b] = [sign * low, sign * high];
                let ends = interval([a.min(b), a.max(b)], 1);
                format!("95 % interval over {patients} patients {ends} mm")
            },
        )
    }

    /// The numbers over one mean difference per patient in words: interval, chance and effect.
    #[must_use]
    pub fn patient_words(&self, unit: &str) -> String {
        let Some(test) = self.sign_flip else {
            return "fewer than two patients, not tested".to_owned();
        };
        let spread = self.bootstrap.map_or_else(String::new, |ends| {
            format!(", 95 % {} by bootstrap over patients", interval(ends, 3))
        });
        let effect = self.effect.map_or_else(String::new, |effect| {
            format!("; effect d {}, 95 % {}", fixed(effect.d, 2), interval(effect.interval, 2))
        });
        format!(
            "{} {unit}{spread}, p {} (sign-flip test{}, {} patients){effect}",
            signed(self.mean_difference, 3),
            probability(test.p_two_sided),
            if test.exact { ", exact" } else { "" },
            test.n
        )
    }
}

fn test_words(test: &PairedT, unit: &str, of: &str) -> String {
    format!(
        "{} {unit}, p {} (paired t, two-sided, {} {of})",
        signed(test.mean_difference, 3),
        probability(test.p_two_sided),
        test.n
    )
}
