//! Warnings of one or many patients by their codes.

use std::collections::{BTreeMap, BTreeSet};

use spineline::action::LineKind;
use spineline::analysis::Analysis;
use spineline::warning::{WarningCode, counted};

use crate::document::{Notice, NoticeKind, Table};

/// Lines of text that a terminal shows; the others are counted in one more line.
const MOST_LINES: usize = 9;

/// How many patients have which warning, the most severe first.
#[derive(Debug, Clone, Default)]
pub struct WarningCounts {
    patients: usize,
    codes: BTreeMap<(NoticeKind, &'static str), CodeCount>,
}

#[derive(Debug, Clone)]
struct CodeCount {
    patients: usize,
    lines: BTreeSet<LineKind>,
    /// The first of them.
    example: Notice,
    /// Warnings of this code beyond the first of each patient.
    others: usize,
}

impl WarningCounts {
    /// Adds a patient.
    pub fn add(&mut self, analysis: &Analysis) {
        self.patients += 1;
        let mut seen = BTreeSet::new();
        for warning in analysis.all_warnings() {
            let key = (NoticeKind::from(warning.code.severity()), warning.code.key());
            let count = self.codes.entry(key).or_insert_with(|| CodeCount {
                patients: 0,
                lines: BTreeSet::new(),
                example: warning.into(),
                others: 0,
            });
            count.lines.extend(warning.line);
            if seen.insert(key) {
                count.patients += 1;
            } else {
                count.others += 1;
            }
        }
    }

    /// One line per code, such as `Contradiction: 12 patients, iliac line [joints_contradict_line]`; of one patient the first text of
    /// each code. `all` says how a user gets every warning.
    #[must_use]
    pub fn lines(&self, all: &str) -> Vec<Notice> {
        // The run itself says how many replicates finished.
        let said = WarningCode::ReplicatesInterrupted.key();
        let codes = self.codes.iter().filter(|((_, code), _)| *code != said);
        let codes: Vec<&CodeCount> = codes.map(|(_, count)| count).collect();
        let mut lines: Vec<Notice> = codes.iter().map(|count| self.line(count)).collect();
        let more = lines.len().saturating_sub(MOST_LINES);
        let has_others = codes.iter().any(|count| count.others > 0 || self.patients > 1);
        lines.truncate(MOST_LINES);
        if more > 0 {
            let text = format!("{} of warning more: {all}", counted(more, "kind"));
            lines.push(Notice::new(NoticeKind::Note, text));
        } else if has_others {
            lines.push(Notice::new(NoticeKind::Note, format!("every warning: {all}")));
        }
        lines
    }

    fn line(&self, count: &CodeCount) -> Notice {
        let example = count.example.clone();
        if self.patients == 1 {
            let others = match count.others {
                0 => String::new(),
                others => format!(" (and {others} more)"),
            };
            return Notice { text: format!("{}{others}", example.text), ..example };
        }
        let lines = count.lines.iter().map(|line| format!(", {line}")).collect::<String>();
        let text = format!("{}{lines}", counted(count.patients, "patient"));
        Notice { place: String::new(), text, ..example }
    }

    /// One row per code.
    #[must_use]
    pub fn table(&self) -> Table {
        Table::of("Contradictions, warnings and notes over patients", &self.codes, |add| {
            add.words("Severity", |((kind, _), _)| kind.word());
            add.words("Code", |((_, code), _)| *code);
            add.numbers("Patients", |(_, count)| count.patients.to_string());
            add.words("Example", |(_, count)| count.example.text.clone());
        })
    }
}

/// Contradictions, warnings and notes of one patient in the order of the analysis, each with the case in front of its place.
#[must_use]
pub fn warnings(analysis: &Analysis) -> Vec<Notice> {
    let with_case = |notice: Notice| {
        let place = [analysis.case_id.as_str(), &notice.place];
        let place: Vec<&str> = place.into_iter().filter(|part| !part.is_empty()).collect();
        Notice { place: place.join(", "), ..notice }
    };
    analysis.all_warnings().map(|warning| with_case(warning.into())).collect()
}
