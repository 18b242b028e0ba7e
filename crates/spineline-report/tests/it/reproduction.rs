//! The answer of a reproduction follows its data.

use spineline::action::LineKind;
use spineline::analysis::{FilmRole, Method};
use spineline::cohort::{Claims, Cohort, ErrorKind, LinePairTest, PairedComparison, PatientClaims};
use spineline_report::reproduction::{Films, Group, Reproduction, full, parts, short};
use spineline_report::terminal;

/// How a constructed cohort answers the paper's claims.
#[derive(Clone, Copy)]
enum Says {
    Yes,
    No,
    Nothing,
}

/// Two hundred equal patients: with fewer, the share of inflections is open.
fn claims(says: Says) -> Claims {
    let (distance, rotation, errors) = match says {
        Says::Yes => (1.0, 0.01, [0.5, 1.4]),
        Says::No => (40.0, 0.9, [1.4, 0.5]),
        Says::Nothing => return Claims::of(&[], 1),
    };
    let patient = PatientClaims {
        distances_segments: vec![distance; 8],
        mean_rotation_deg: Some(1.0),
        inflection_rotation_deg: Some(rotation),
        fitted_mm: Some(errors),
        held_out_mm: Some(errors),
        ..PatientClaims::default()
    };
    Claims::of(&vec![patient; 200], 1)
}

/// A cohort whose inflection line is nearer by 2 mm on films that were not fitted, or farther.
fn cohort(says: Says) -> Cohort {
    let mut cohort = Cohort::of(&[], 1);
    let mean_difference = match says {
        Says::Yes => -2.0,
        Says::No => 2.0,
        Says::Nothing => return cohort,
    };
    let comparison = PairedComparison {
        pooled: None,
        patients: None,
        sign_flip: None,
        bootstrap: Some([mean_difference - 0.5, mean_difference + 0.5]),
        effect: None,
        mean_difference,
    };
    let test = |role| LinePairTest {
        lines: [LineKind::Inflection, LineKind::Iliac],
        role,
        error: ErrorKind::Location,
        films: 40,
        without_result: 0,
        comparison,
        holm_p: Some(0.001),
        per_predicted_film: [1, 1],
    };
    cohort.compared.tests = vec![test(FilmRole::LeftOutBend), test(FilmRole::HeldOut)];
    cohort
}

const PHANTOMS: Films = Films::Phantoms { subjects: 18, seed: 1 };

fn told(films: Films, says: &[Says]) -> [String; 2] {
    let cohorts: Vec<Cohort> = says.iter().copied().map(cohort).collect();
    let groups = ["rod", "bend", "pull"].into_iter().zip(says).zip(&cohorts);
    let groups = groups.map(|((name, &says), cohort)| Group {
        name,
        meaning: "constructed".to_owned(),
        free: cohort,
        frontal: cohort,
        claims: claims(says),
        readings: Vec::new(),
    });
    let reproduction = Reproduction { films, method: Method::Paper, groups: groups.collect() };
    let text = terminal(&short(&reproduction), 100);
    [text, full(&reproduction, &parts(&reproduction))]
}

fn answer(films: Films, says: &[Says]) -> String {
    let [text, _] = told(films, says);
    let from = text.find("Answer: ").expect("an answer");
    let next = if films == Films::Given { "Method: " } else { "Loading scenarios" };
    let to = text.find(next).expect("the method or the scenarios follow");
    text[from..to].split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn the_answer_follows_the_data() {
    assert_eq!(
        answer(PHANTOMS, &[Says::Yes; 3]),
        "Answer: Yes. All three claims hold in every loading scenario."
    );
    assert_eq!(
        answer(PHANTOMS, &[Says::No; 3]),
        "Answer: No. No claim holds in every loading scenario: claim 1 in none, claim 2 in none, claim 3 in none."
    );
    assert_eq!(
        answer(PHANTOMS, &[Says::Yes, Says::No, Says::Yes]),
        "Answer: No. No claim holds in every loading scenario: claim 1 in rod and pull, claim 2 in rod and pull, claim 3 in rod and pull."
    );
    let open = answer(PHANTOMS, &[Says::Yes, Says::Yes, Says::Nothing]);
    assert!(open.starts_with("Answer: Not decided. "), "{open}");
}

#[test]
fn patients_that_were_given_are_one_group_with_an_answer_of_their_own() {
    let given = |says| answer(Films::Given, &[says]);
    assert_eq!(given(Says::Yes), "Answer: Yes. All three claims hold.");
    assert_eq!(given(Says::No), "Answer: No. No claim holds.");
    assert_eq!(
        given(Says::Nothing),
        "Answer: Not tested. Each claim needs two patients with a result."
    );
    let [text, all] = told(Films::Given, &[Says::No]);
    for word in ["SYNTHETIC", "phantom", "scenario"] {
        assert!(!text.contains(word) && !all.contains(word), "{word} in\n{text}\n{all}");
    }
}

#[test]
fn endings_differences_and_their_p_stand_beside_the_claims() {
    let [text, _] = told(PHANTOMS, &[Says::Yes, Says::No, Says::Nothing]);
    let ending = text.lines().find(|line| line.contains("least-rotating")).expect("claim 1");
    let words: Vec<&str> = ending.split("  ").map(str::trim).filter(|w| !w.is_empty()).collect();
    assert_eq!(words[1..], ["holds", "does not hold", "not tested"], "{ending}");
    for number in ["−2.00 (−2.50 to −1.50)", "+2.00 (1.50 to 2.50)", "0.0010", "SYNTHETIC"] {
        assert!(text.contains(number), "{number} is missing in\n{text}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
}

#[test]
fn every_number_fits_the_width_and_says_what_its_words_mean() {
    let [_, all] = told(PHANTOMS, &[Says::Yes, Says::No, Says::Nothing]);
    assert!(all.lines().all(|line| line.chars().count() <= 120), "{all}");
    let all: String = all.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(all.contains("`same` means from 0.67 × to 1.5 × the paper's number"), "{all}");
    assert!(!all.contains("not given"), "{all}");
}
