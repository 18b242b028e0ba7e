//! `spineline check`: case files validated.

use std::path::{Path, PathBuf};

use clap::Args;
use spineline::analysis::{Analysis, AnalysisOptions};
use spineline_report::patient::{film_warnings, films_table};
use spineline_report::terminal::{self, Lines};

use crate::analysis::case::analyze_input;
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::{CaseInput, case_files};
use crate::run::messages::say;
use crate::run::outputs::{print, width};

pub const EXAMPLES: &str = "\
Examples:
  spineline check P07/case.json
  spineline check cases                                every case of a folder";

#[derive(Args)]
pub struct CheckArgs {
    /// Case files, or folders of them
    #[arg(required = true, value_name = "CASE")]
    pub cases: Vec<PathBuf>,
}

pub fn run(args: &CheckArgs) -> Result<Ending, Failure> {
    let mut ending = Ending::Done;
    for path in case_files(&args.cases)? {
        let analysis = CaseInput::read(&path)
            .and_then(|input| analyze_input(&path, &input, &AnalysisOptions::default()));
        match analysis {
            Ok(analysis) => {
                print(text(&path, &analysis, width()))?;
            }
            Err(failure) => {
                say(&failure);
                ending = Ending::BadInput;
            }
        }
    }
    Ok(ending)
}

/// The films of a case, its warnings, and the models that it supports, in lines of this width.
fn text(path: &Path, analysis: &Analysis, width: usize) -> Lines {
    let synthetic = if analysis.synthetic { " · SYNTHETIC" } else { "" };
    let mut text = Lines::of(format!("{}: {}{synthetic}", path.display(), analysis.case_id));
    text.text(&terminal::table(&films_table(analysis), width));
    let warnings: Vec<_> = film_warnings(analysis).collect();
    for warning in &warnings {
        let place = warning.posture.map_or_else(String::new, |p| format!("{p} film: "));
        let level = warning.level.map_or_else(String::new, |l| format!("{l}: "));
        let note = format!("! {place}{level}{}", warning.text());
        text.text(&terminal::paragraph(&note, width, "  "));
    }
    if warnings.is_empty() {
        text.line("  no warnings about these films");
    }
    let lines: Vec<String> = analysis.models.iter().map(|m| m.kind.to_string()).collect();
    let analyze = if lines.is_empty() {
        "`analyze` gives the curve and the clinical angles".to_owned()
    } else {
        format!("`analyze` can personalise with the {}", lines.join(", the "))
    };
    text.text(&terminal::paragraph(&analyze, width, "  "));
    text.line("");
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use spineline::analysis::analyze;
    use spineline_phantom::{Readers, Scenario, generate};

    #[test]
    fn no_line_is_wider_than_a_narrow_terminal() {
        const NARROW: usize = 80;
        let case = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("a subject").case;
        let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom is sound");
        let text = text(Path::new("case.json"), &analysis, NARROW);
        for line in text.as_str().lines() {
            assert!(line.chars().count() <= NARROW, "{line}");
        }
        let words = text.as_str().split_whitespace().collect::<Vec<_>>().join(" ");
        let lines = "`analyze` can personalise with the inflection line, the iliac line, the estimated line";
        assert!(words.contains(lines), "{words}");
    }
}
