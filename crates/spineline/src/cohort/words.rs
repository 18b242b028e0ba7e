//! A cohort in plain sentences, which all front ends share.

use super::{Cohort, Comparison};
use crate::analysis::probability;
use crate::evaluate::statistics::PairedT;

impl Cohort {
    /// What was found, one finding per sentence.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let mut all = vec![format!(
            "{} patients{}; {} with exactly two inflections",
            self.patients,
            if self.synthetic { " (synthetic)" } else { "" },
            self.two_inflections
        )];
        for line in &self.lines {
            for (films, errors) in [("fitted", &line.fitted), ("held out", &line.held_out)] {
                if errors.location_mm.patients.n == 0 {
                    continue;
                }
                let interval =
                    errors.location_mm.bootstrap.map_or_else(String::new, |[low, high]| {
                        format!(", 95 % interval over patients {low:.2} to {high:.2}")
                    });
                all.push(format!(
                    "{:15} {films:8}  location error {:.2} mm{interval}; Ferguson error {:.2}°; films without a result: {}",
                    line.kind.to_string(),
                    errors.location_mm.patients.mean,
                    errors.ferguson_deg.patients.mean,
                    errors.unusable
                ));
            }
        }
        let (rejected, tested) = self.line_rejected;
        if tested > 0 {
            all.push(format!(
                "In {rejected} of {tested} bends the load that the joints' rotations prefer does not run through the inflections"
            ));
        }
        if let Some(t) = self.location_test.patients {
            all.push(format!(
                "Inflection against iliac line, one mean per patient: {:+.2} mm (p {}, two-sided, n = {})",
                t.mean_difference,
                probability(t.p_two_sided),
                t.n
            ));
        }
        all
    }
}

impl Comparison {
    /// The paper's pooled test in words; values are in `unit`.
    #[must_use]
    pub fn pooled_words(&self, unit: &str) -> String {
        let pooled = self.pooled.map(|t| test_words(&t, unit, "pairs"));
        pooled.map_or_else(
            || "too few pairs to test".to_owned(),
            |words| format!("{words}, as if all were independent (the paper's)"),
        )
    }

    /// The test over one mean per patient in words.
    #[must_use]
    pub fn patient_words(&self, unit: &str) -> String {
        let patients = self.patients.map(|t| test_words(&t, unit, "patients"));
        patients.unwrap_or_else(|| "too few patients to test".to_owned())
    }
}

fn test_words(test: &PairedT, unit: &str, of: &str) -> String {
    format!(
        "{:+.3} {unit}, p {} (paired t, two-sided, {} {of})",
        test.mean_difference,
        probability(test.p_two_sided),
        test.n
    )
}
