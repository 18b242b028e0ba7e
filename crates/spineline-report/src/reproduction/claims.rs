//! The paper's three claims, tested in each group of patients.

use spineline::action::LineKind;
use spineline::analysis::FilmRole;
use spineline::cohort::{ClaimVerdict, Cohort, LinePairTest, NEAR_SEGMENTS};
use spineline::number::fixed;

use super::fair::{PAIRS, test};
use super::numbers::percent;
use super::{Films, Group, Reproduction};

/// The claims are numbered from one to this.
pub(super) const CLAIMS: usize = 3;

/// A number of the paper that supports a claim, beside ours.
pub(super) struct Evidence {
    /// Number of the claim.
    pub claim: usize,
    /// Two lines.
    pub words: [String; 2],
    /// The paper's number.
    pub paper: &'static str,
    /// By group.
    pub ours: Vec<Found>,
}

/// Our number with its ending; `None` is not tested.
pub(super) struct Found {
    pub number: String,
    /// Patients that it rests on.
    pub patients: usize,
    pub ending: Option<ClaimVerdict>,
}

/// The claims, one after the other. The third has two numbers: on fitted bends, and on films that are not fitted.
pub(super) fn evidence(reproduction: &Reproduction<'_>) -> Vec<Evidence> {
    let of = |found: fn(&Group<'_>) -> Found| reproduction.groups.iter().map(found).collect();
    let near = [
        format!("Inflections lie within {NEAR_SEGMENTS} segments of"),
        "the least-rotating segments".to_owned(),
    ];
    let below = ["Inflections rotate less than the mean of", "all segments, by"];
    let fitted = ["Fitted bends: error of Model-1 below", "the error of Model-2 (mm)"];
    let predicted =
        ["Neutral, traction (not fitted): error of", "Model-1 below the error of Model-2 (mm)"];
    let words = |words: [&str; 2]| words.map(str::to_owned);
    vec![
        Evidence { claim: 1, words: near, paper: "100 %", ours: of(near_share) },
        Evidence { claim: 2, words: words(below), paper: "93 %", ours: of(below_mean) },
        Evidence { claim: 3, words: words(fitted), paper: "0.51, 1.41", ours: of(fitted_errors) },
        Evidence {
            claim: 3,
            words: words(predicted),
            paper: "0.78, –",
            ours: of(predicted_errors),
        },
    ]
}

fn near_share(of: &Group<'_>) -> Found {
    Found {
        number: percent(100.0 * of.claims.near.share),
        patients: of.claims.near.n,
        ending: of.claims.verdicts()[0],
    }
}

fn below_mean(of: &Group<'_>) -> Found {
    Found {
        number: percent(100.0 * of.claims.below_mean),
        patients: of.claims.near.n,
        ending: of.claims.verdicts()[1],
    }
}

fn fitted_errors(of: &Group<'_>) -> Found {
    Found {
        number: pair(of.claims.errors_mm),
        patients: of.claims.better.n,
        ending: of.claims.verdicts()[2],
    }
}

fn predicted_errors(of: &Group<'_>) -> Found {
    let test = test(of.free, PAIRS[0], FilmRole::HeldOut);
    Found {
        number: pair(of.claims.held_out_errors_mm),
        patients: of.claims.better_held_out.n,
        ending: test.and_then(predicts_better),
    }
}

/// Whether the inflection line predicts better than the iliac line, by the test with Holm's correction.
fn predicts_better(test: &LinePairTest) -> Option<ClaimVerdict> {
    test.holm_p?;
    Some(match test.predicts_better() {
        Some(LineKind::Inflection) => ClaimVerdict::Holds,
        Some(_) => ClaimVerdict::Fails,
        None => ClaimVerdict::Open,
    })
}

fn pair(errors_mm: [f64; 2]) -> String {
    errors_mm.map(|error| fixed(error, 2)).join(", ")
}

pub(super) fn ending_words(ending: Option<ClaimVerdict>) -> String {
    ending.map_or_else(|| "not tested".to_owned(), |ending| ending.to_string())
}

/// The answer in one sentence or two, from the endings.
pub(super) fn answer(evidence: &[Evidence], reproduction: &Reproduction<'_>) -> String {
    let names = reproduction.names();
    let holds = |claim: usize, group: usize| {
        let mut own = evidence.iter().filter(|one| one.claim == claim);
        own.all(|one| one.ours[group].ending == Some(ClaimVerdict::Holds))
    };
    let held: Vec<Vec<&str>> = (1..=CLAIMS)
        .map(|claim| (0..names.len()).filter(|&s| holds(claim, s)).map(|s| names[s]).collect())
        .collect();
    let everywhere = held.iter().filter(|own| own.len() == names.len()).count();
    let place = match reproduction.films {
        Films::Phantoms { .. } => " in every loading scenario",
        Films::Given => "",
    };
    if everywhere == CLAIMS {
        return format!("Yes. All three claims hold{place}.");
    }
    let endings = || evidence.iter().flat_map(|one| &one.ours).filter_map(|found| found.ending);
    if endings().next().is_none() {
        return "Not tested. Each claim needs two patients with a result.".to_owned();
    }
    let is_contradicted = endings().any(|ending| ending == ClaimVerdict::Fails);
    let word = if is_contradicted { "No" } else { "Not decided" };
    let count = match everywhere {
        0 => "No claim holds".to_owned(),
        1 => format!("Only 1 of the {CLAIMS} claims holds"),
        _ => format!("Only {everywhere} of the {CLAIMS} claims hold"),
    };
    let numbered = held.iter().zip(1..);
    let each: Vec<String> = match reproduction.films {
        Films::Phantoms { .. } => {
            numbered.map(|(own, claim)| where_it_holds(claim, own, names.len())).collect()
        }
        Films::Given => {
            let own = numbered.filter(|(own, _)| !own.is_empty());
            own.map(|(_, claim)| format!("claim {claim}")).collect()
        }
    };
    let colon = if each.is_empty() { "" } else { ": " };
    format!("{word}. {count}{place}{colon}{}.", each.join(", "))
}

fn where_it_holds(claim: usize, scenarios: &[&str], all: usize) -> String {
    match scenarios.len() {
        0 => format!("claim {claim} in none"),
        n if n == all => format!("claim {claim} in all"),
        _ => format!("claim {claim} in {}", scenarios.join(" and ")),
    }
}

/// In how many patients the bends reject a single force along a line, such as `2 of 18`.
pub(super) fn rejected(cohort: &Cohort, kind: LineKind) -> String {
    let counts = cohort.outcomes(kind).map(|one| one.patients);
    match counts.filter(|counts| counts.tested() > 0) {
        Some(counts) => format!("{} of {}", counts.rejected, counts.tested()),
        None => "not tested".to_owned(),
    }
}
