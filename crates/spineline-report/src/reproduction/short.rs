//! The answer of a reproduction on one screen.

use spineline::action::LineKind;
use spineline::analysis::FilmRole;
use spineline::number::none;
use spineline::warning::counted;

use super::claims::{Evidence, answer, ending_words, evidence, rejected};
use super::fair::{PAIRS, difference, pair_words, test};
use super::{Films, Group, Reproduction};
use crate::document::{Column, Document, Section, Table};
use crate::phrases::holm_p;

const CLAIMS_CAPTION: &str = "The paper's claims (Model-1: force through the inflections; Model-2: parallel to the iliac line)";
const CLAIMS_NOTE: &str = "Errors: Model-1, Model-2. Claims 1 and 2 hold above 90 %, claim 3 in most patients (fitted) or by Holm's p below 0.05 (not fitted). Open: the 95 % interval has both sides.";
const FAIR_CAPTION: &str = ": location error of the first line minus the error of the second, in mm, with its 95 % interval over patients; below zero the first line is nearer";
const PHANTOMS_CANNOT_SHOW: &str = "What this cannot show: how the spines of patients move. All films are SYNTHETIC, the phantoms are ours, and each scenario has its line of action built in: rod the paper's, pull Petit's, bend neither. A smaller error on them shows which line made the films.";
const FITS_CANNOT_SHOW: &str = "What this cannot show: that a single force bent the spines. A model follows the bends that it was fitted to; errors on films that were not fitted, and the tests of each line (`spineline analyze CASES`), can speak against it.";

/// The claims with their endings, the lines on films that were not fitted, and what follows. A document without figures.
#[must_use]
pub fn short(reproduction: &Reproduction<'_>) -> Document {
    let evidence = evidence(reproduction);
    let (of, question, limits) = match reproduction.films {
        Films::Phantoms { subjects, seed } => (
            format!(
                "{subjects} subjects, {} loading scenarios, seed {seed}",
                reproduction.groups.len()
            ),
            "Question: do the paper's claims hold on films of known cause, whatever bent the spines?",
            PHANTOMS_CANNOT_SHOW,
        ),
        Films::Given => {
            let patients: usize = reproduction.groups.iter().map(|group| group.free.patients).sum();
            let question = "Question: do the paper's claims hold for these patients?";
            (counted(patients, "patient"), question, FITS_CANNOT_SHOW)
        }
    };
    let mut head = Section::new("answer", "");
    head.paragraph(question);
    head.paragraph(format!("Answer: {}", answer(&evidence, reproduction)));
    if let Films::Phantoms { .. } = reproduction.films {
        let meaning = |group: &Group<'_>| format!("{}, {}", group.name, group.meaning);
        let meanings: Vec<String> = reproduction.groups.iter().map(meaning).collect();
        head.paragraph(format!("Loading scenarios: {}.", meanings.join("; ")));
    }
    head.paragraph(reproduction.method_sentence());
    let mut claims = Section::new("claims", "");
    claims.table(claims_table(&evidence, reproduction));
    let mut rest = Section::new("lines", "");
    rest.table(differences(reproduction));
    rest.paragraph(rejections(reproduction));
    rest.paragraph(limits);
    let synthetic = if reproduction.synthetic().is_empty() { "" } else { " · SYNTHETIC" };
    let title = "Reproduction of Jalalian et al. 2016";
    Document::new(title, format!("{of}{synthetic}"), "", vec![head, claims, rest])
}

/// Two rows per number: the number itself, and its endings.
fn claims_table(evidence: &[Evidence], reproduction: &Reproduction<'_>) -> Table {
    // Patients of whom a claim can be counted may be few.
    let is_given = reproduction.films == Films::Given;
    let patients = is_given.then_some("Patients");
    let names = reproduction.names();
    let heads = ["Paper"].into_iter().chain(names).chain(patients).map(Column::numbers);
    let columns = [Column::words("Claim")].into_iter().chain(heads).collect();
    let mut table = Table::new(CLAIMS_CAPTION, columns);
    let mut before = 0;
    for Evidence { claim, words: [first, second], paper, ours } in evidence {
        let number = if *claim == before { " ".to_owned() } else { claim.to_string() };
        before = *claim;
        let numbers = ours.iter().map(|found| found.number.clone());
        let patients = ours.iter().filter(|_| is_given).map(|found| found.patients.to_string());
        let lead = [format!("{number} {first}"), (*paper).to_owned()];
        table.row(lead.into_iter().chain(numbers).chain(patients).collect());
        let endings = ours.iter().map(|found| ending_words(found.ending));
        let lead = [format!("  {second}"), String::new()];
        let blank = is_given.then(String::new);
        table.row(lead.into_iter().chain(endings).chain(blank).collect());
    }
    table.note = CLAIMS_NOTE.to_owned();
    table
}

/// The differences between the lines on films that were not fitted.
fn differences(reproduction: &Reproduction<'_>) -> Table {
    let mut columns = vec![Column::words("")];
    for films in ["Bends left out", "Neutral, traction"] {
        columns.extend([Column::numbers(films), Column::numbers("Holm's p")]);
    }
    let caption = format!("Films that were not fitted{}{FAIR_CAPTION}", reproduction.synthetic());
    let mut table = Table::new(&caption, columns);
    for one in &reproduction.groups {
        for lines in PAIRS {
            let mut row = vec![format!("{:4} {}", one.name, pair_words(lines))];
            for role in FilmRole::PREDICTED {
                let found = test(one.free, lines, role);
                row.push(difference(found.map(|test| &test.comparison)).text);
                row.push(found.map_or_else(none, |test| holm_p(test.holm_p)));
            }
            table.row(row);
        }
    }
    table.note = "The estimated line takes two more numbers from each film; a smaller error does not speak for it.".to_owned();
    table
}

/// For how many patients the bends contradict each line.
fn rejections(reproduction: &Reproduction<'_>) -> String {
    let of = |kind: LineKind| {
        let count = |one: &Group<'_>| format!("{} {}", one.name, rejected(one.free, kind));
        let counts: Vec<String> = reproduction.groups.iter().map(count).collect();
        format!("along the {kind}, {}", counts.join(", "))
    };
    format!(
        "Tested patients{} whose bends reject a single force: {}; {}.",
        reproduction.synthetic(),
        of(LineKind::Inflection),
        of(LineKind::Iliac)
    )
}
