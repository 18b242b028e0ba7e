//! The page on credibility, in the order of ASME V&V 40: question of interest, context of use, model risk, evidence.

/// Kinds of evidence, by the beginning of their heading in `validation/README.md`, each with what it can show.
const EVIDENCE: [(&str, &str); 4] = [
    ("Verification", "the equations are solved correctly"),
    ("Calibration", "the method finds the truth that made synthetic films"),
    ("Held-out validation", "real spines do what the model predicts"),
    ("Uncertainty", "how far a number may be off"),
];

/// The parts that state the purpose of the evidence.
const FRAME: [&str; 3] = ["Question of interest", "Context of use", "Model risk"];

/// A part of the file below a heading of the second level.
struct Part<'a> {
    heading: &'a str,
    text: &'a str,
}

impl Part<'_> {
    /// Claims: rows of tables without their headings.
    fn claims(&self) -> usize {
        let lines = self.text.lines().collect::<Vec<_>>();
        let rules = lines.iter().filter(|line| line.starts_with("|---")).count();
        let rows = lines.iter().filter(|line| line.starts_with('|')).count();
        rows.saturating_sub(2 * rules)
    }
}

/// The page, from the text of `validation/README.md`.
pub fn page(evidence: &str) -> Result<String, String> {
    let parts: Vec<Part<'_>> = evidence
        .split("\n## ")
        .skip(1)
        .filter_map(|part| part.split_once('\n'))
        .map(|(heading, text)| Part { heading, text: text.trim() })
        .collect();
    let named = |name: &str| {
        let found = parts.iter().find(|part| part.heading.starts_with(name));
        found.ok_or_else(|| format!("validation/README.md: no part `{name}`"))
    };
    let mut page = String::from(
        "# Credibility\n\n\
         In the order of ASME V&V 40: the question, the context of use, the risk of a wrong answer, and the evidence, with \
         one line for each kind. One kind does not replace another.\n\n",
    );
    for name in FRAME {
        page.push_str(&format!("## {name}\n\n{}\n\n", named(name)?.text));
    }
    page.push_str(
        "## Credibility evidence\n\n| evidence | shows that | tested claims |\n|---|---|---|\n",
    );
    for (name, shows) in EVIDENCE {
        let claims = match named(name)?.claims() {
            0 => "**none**".to_owned(),
            number => number.to_string(),
        };
        page.push_str(&format!("| {name} | {shows} | {claims} |\n"));
    }
    page.push('\n');
    let rest = parts.iter().filter(|part| !FRAME.contains(&part.heading));
    for part in rest {
        page.push_str(&format!("## {}\n\n{}\n\n", part.heading, part.text));
    }
    Ok(page)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_evidence_has_its_line_and_a_missing_one_says_so() {
        let text = concat!(env!("CARGO_MANIFEST_DIR"), "/../validation/README.md");
        let page = page(&std::fs::read_to_string(text).expect("a file")).expect("a page");
        for (name, _) in EVIDENCE {
            let lines = page.lines().filter(|line| line.starts_with(&format!("| {name} |")));
            assert_eq!(lines.count(), 1, "{name}");
        }
        assert!(page.contains(
            "| Held-out validation | real spines do what the model predicts | **none** |"
        ));
        assert!(page.contains("## Context of use") && page.contains("## Known limits"));
        assert!(page.find("## Model risk") < page.find("## Credibility evidence"));
    }

    #[test]
    fn a_part_that_is_missing_is_named() {
        let error = page("# Title\n\n## Question of interest\n\nWhat?\n").expect_err("too short");
        assert!(error.contains("Context of use"), "{error}");
    }
}
