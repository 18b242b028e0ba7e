//! The answer of a reproduction on one screen.

use spineline::action::LineKind;
use spineline::analysis::FilmRole;
use spineline::number::p_value;

use super::Scenarios;
use super::claims::{Evidence, answer, ending_words, evidence, rejected};
use super::fair::{PAIRS, difference, pair_words, test};
use crate::document::{Column, Document, Section, Table};

const QUESTION: &str =
    "Question: do the paper's claims hold on films of known cause, whatever bent the spines?";
const CLAIMS_CAPTION: &str = "The paper's claims (Model-1: force through the inflections; Model-2: parallel to the iliac line)";
const CLAIMS_NOTE: &str = "Errors: Model-1, Model-2. Claims 1 and 2 hold above 90 %, claim 3 in most patients (fitted) or by Holm's p below 0.05 (not fitted). Open: the 95 % interval has both sides. Scenarios are SYNTHETIC.";
const FAIR_CAPTION: &str = "Films that were not fitted (SYNTHETIC): location error of the first line minus the error of the second, in mm, with its 95 % interval over patients; below zero the first line is nearer";
const LIMITS: &str = "What this cannot show: how the spines of patients move. All films are SYNTHETIC, the phantoms are ours, and each scenario has its line of action built in: rod the paper's, pull Petit's, bend neither. A smaller error on them shows which line made the films.";

/// The claims with their endings, the lines on films that were not fitted, and what follows. A document without figures.
#[must_use]
pub fn short(scenarios: &Scenarios<'_>, subjects: usize, seed: u64) -> Document {
    let names = scenarios.each_ref().map(|one| one.name);
    let evidence = evidence(scenarios);
    let mut head = Section::new("answer", "");
    head.paragraph(QUESTION);
    head.paragraph(format!("Answer: {}", answer(&evidence, names)));
    let meanings = scenarios.each_ref().map(|one| format!("{}, {}", one.name, one.meaning));
    head.paragraph(format!("Loading scenarios: {}.", meanings.join("; ")));
    let mut claims = Section::new("claims", "");
    claims.table(claims_table(&evidence, names));
    let mut rest = Section::new("lines", "");
    rest.table(differences(scenarios));
    rest.paragraph(rejections(scenarios));
    rest.paragraph(LIMITS);
    Document {
        title: "Reproduction of Jalalian et al. 2016".to_owned(),
        subject: format!(
            "{subjects} subjects, {} loading scenarios, seed {seed} · SYNTHETIC",
            names.len()
        ),
        generator: String::new(),
        banners: Vec::new(),
        sections: vec![head, claims, rest],
        analysis: String::new(),
    }
}

/// Two rows per number: the number itself, and its endings.
fn claims_table(evidence: &[Evidence], names: [&str; 3]) -> Table {
    let heads = ["Paper"].into_iter().chain(names).map(Column::numbers);
    let columns = [Column::words("Claim")].into_iter().chain(heads).collect();
    let mut table = Table::new(CLAIMS_CAPTION, columns);
    let mut before = 0;
    for Evidence { claim, words: [first, second], paper, ours } in evidence {
        let number = if *claim == before { " ".to_owned() } else { claim.to_string() };
        before = *claim;
        let numbers = ours.iter().map(|found| found.number.clone());
        let lead = [format!("{number} {first}"), (*paper).to_owned()];
        table.row(lead.into_iter().chain(numbers).collect());
        let endings = ours.iter().map(|found| ending_words(found.ending));
        let lead = [format!("  {second}"), String::new()];
        table.row(lead.into_iter().chain(endings).collect());
    }
    table.note = CLAIMS_NOTE.to_owned();
    table
}

/// The differences between the lines on films that were not fitted.
fn differences(scenarios: &Scenarios<'_>) -> Table {
    let mut columns = vec![Column::words("")];
    for films in ["Bends left out", "Neutral, traction"] {
        columns.extend([Column::numbers(films), Column::numbers("Holm's p")]);
    }
    let mut table = Table::new(FAIR_CAPTION, columns);
    for one in scenarios {
        for lines in PAIRS {
            let mut row = vec![format!("{:4} {}", one.name, pair_words(lines))];
            for role in FilmRole::PREDICTED {
                let found = test(one.free, lines, role);
                row.push(difference(found.map(|test| &test.comparison)).text);
                row.push(p_value(found.and_then(|test| test.holm_p)));
            }
            table.row(row);
        }
    }
    table.note = "The estimated line takes two more numbers from each film; a smaller error does not speak for it.".to_owned();
    table
}

/// For how many patients the bends contradict each line.
fn rejections(scenarios: &Scenarios<'_>) -> String {
    let of = |kind: LineKind| {
        let counts =
            scenarios.each_ref().map(|one| format!("{} {}", one.name, rejected(one.free, kind)));
        format!("along the {kind}, {}", counts.join(", "))
    };
    format!(
        "Tested patients (SYNTHETIC) whose bends reject a single force: {}; {}.",
        of(LineKind::Inflection),
        of(LineKind::Iliac)
    )
}
