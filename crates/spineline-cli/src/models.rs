//! Other loads and bases than the lines, fitted and left out, as text.

use spineline::analysis::Analysis;
use spineline::hypothesis::{Hypothesis, HypothesisFit, Role};

use crate::table::Table;

/// The hypotheses that were asked for, over one patient or several; nothing where none was.
pub fn text(analyses: &[Analysis]) -> String {
    let mut names: Vec<Hypothesis> = Vec::new();
    for fit in analyses.iter().flat_map(|a| &a.hypotheses) {
        if !names.contains(&fit.hypothesis) {
            names.push(fit.hypothesis);
        }
    }
    if names.is_empty() {
        return String::new();
    }
    let mut table = Table::new([
        "Load and base",
        "free",
        "fitted",
        "left out",
        "load fitted",
        "held out",
        "rotation",
        "left out",
        "against",
        "AICc",
        "BIC",
        "n",
    ]);
    for hypothesis in names {
        table.row(row(hypothesis, analyses));
    }
    table.text()
}

fn row(hypothesis: Hypothesis, analyses: &[Analysis]) -> Vec<String> {
    let fits: Vec<(&Analysis, &HypothesisFit)> = analyses
        .iter()
        .filter_map(|a| Some((a, a.hypotheses.iter().find(|f| f.hypothesis == hypothesis)?)))
        .collect();
    let mean = |value: &dyn Fn(&HypothesisFit) -> Option<f64>, digits: usize| {
        let values: Vec<f64> = fits.iter().filter_map(|(_, fit)| value(fit)).collect();
        let n = values.len();
        if n == 0 {
            return "-".to_owned();
        }
        format!("{:.digits$}", values.iter().sum::<f64>() / n as f64)
    };
    let paper = |a: &Analysis| {
        let own = a.hypotheses.iter().find(|f| f.hypothesis == a.hypotheses[0].hypothesis)?;
        Some(own.criteria)
    };
    let delta = |value: &dyn Fn(&spineline::hypothesis::Criteria) -> f64| {
        let all: Vec<f64> =
            fits.iter().filter_map(|(a, f)| Some(value(&f.criteria) - value(&paper(a)?))).collect();
        format!("{:+.0}", all.iter().sum::<f64>() / all.len() as f64)
    };
    let location = |role| mean(&|fit: &HypothesisFit| fit.mean_location_error_mm(role), 1);
    let rotation = |role| {
        mean(&|fit: &HypothesisFit| fit.mean_rotation_rms(role).map(|a| a.deg()), 2)
    };
    vec![
        hypothesis.to_string(),
        fits.first().map_or(0, |(_, f)| f.criteria.fitted - 1).to_string(),
        location(Role::Fitted),
        location(Role::LeftOut),
        location(Role::LeftOutLoadFitted),
        location(Role::HeldOut),
        rotation(Role::Fitted),
        rotation(Role::LeftOut),
        mean(
            &|fit: &HypothesisFit| {
                let of: Vec<f64> =
                    fit.of_role(Role::Fitted).map(|p| p.against.joints as f64).collect();
                (!of.is_empty()).then(|| of.iter().sum::<f64>() / of.len() as f64)
            },
            1,
        ),
        delta(&|c| c.aicc),
        delta(&|c| c.bic),
        fits.len().to_string(),
    ]
}
