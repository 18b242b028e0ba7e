//! `spineline rerun`: an analysis repeated from its file alone.

mod difference;

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;
use spineline::analysis::Analysis;
use spineline::number::{none, scientific};
use spineline_files::{
    AnalysisFile, Content, InputFile, MAX_ANALYSES_BYTES, Provenance, StoredAnalysis,
    parse_analysis, parse_json, picture_warnings, read_bytes, results_text,
};
use spineline_report::document::Table;
use spineline_report::terminal::Lines;
use spineline_report::{embedded, terminal};

use crate::analysis::case::analyze_case;
use crate::analysis::confidence::Confidence;
use crate::analysis::figures::{figures_of, write_figures};
use crate::options::values::{number, threads};
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{Outputs, OverwriteArgs, entry_width, is_stdout, print, width};
use crate::run::pdf::attached;
use crate::run::provenance::this_run;
use difference::{Found, differences};

pub const EXAMPLES: &str = "\
The case and the options come from FILE alone; films, case files and stiffness tables are not needed. Where these files still \
exist, their hashes are compared, and changes are reported.

Exit codes: 0 no differences, 4 differences, 3 FILE cannot be repeated, 130 interrupted.

Examples:
  spineline rerun analysis.json
  spineline rerun P07.html
  spineline rerun P07.pdf
  spineline rerun analysis.json --figures out/figures
  spineline rerun analysis.json --tolerance 1e-6 --json again.json";

#[derive(Args)]
pub struct RerunArgs {
    /// Analysis, or list of analyses, from `analyze --json`; or a report
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Tolerance: relative; absolute below 1
    #[arg(long, value_name = "NUMBER", default_value = "1e-9", value_parser = tolerance)]
    tolerance: f64,
    /// Write the new analysis as JSON (`-`: standard output); a list for a list
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draw the figures of the new analysis as SVG into this folder
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Threads for replicates; 0: all cores. The number does not change the results
    #[arg(long, default_value = "0", value_parser = threads)]
    threads: usize,
    #[command(flatten)]
    overwrite: OverwriteArgs,
}

fn tolerance(text: &str) -> Result<f64, String> {
    match number(text)? {
        part @ 0.0..=1.0 => Ok(part),
        _ => Err("expected 0 to 1".to_owned()),
    }
}

pub fn run(args: &RerunArgs) -> Result<Ending, Failure> {
    let outputs = Outputs::new(args.overwrite, [args.file.as_path()]);
    if let Some(path) = &args.json {
        outputs.file(path)?;
    }
    if let Some(folder) = &args.figures {
        outputs.folder(folder)?;
    }
    let stored = stored(&args.file)?;
    let to_stdout = args.json.as_ref().is_some_and(|path| is_stdout(path));
    let Origin { form, content } = stored.origin;
    // Whether the parts that are not compared are unchanged.
    let mut same = form == Form::Analysis || content != Content::Changed;
    let (mut text, mut again) = (Lines::default(), Vec::new());
    for old in &stored.analyses {
        let repeated = Repeated::of(args, old)?;
        same &= repeated.found.all.is_empty();
        outputs.of_case(&repeated.stored.case.id);
        if !text.as_str().is_empty() {
            text.line("");
        }
        repeated.add_to(&mut text, args, stored.origin);
        again.push(repeated);
    }
    if let Some(folder) = &args.figures {
        for repeated in &again {
            let Repeated { analysis, provenance, .. } = repeated;
            let figures = figures_of(analysis, provenance);
            outputs.attempt(folder, || write_figures(&figures, folder, &outputs));
        }
    }
    if let Some(path) = &args.json {
        let files: Vec<&Value> = again.iter().map(|repeated| &repeated.new).collect();
        let text = match &files[..] {
            [one] if !stored.is_list => results_text(one),
            all => results_text(&all),
        };
        outputs.attempt(path, || outputs.write(path, text));
    }
    let kept = outputs.commit_and_say();
    if !to_stdout {
        print(text)?;
    }
    kept?;
    Ok(if same { Ending::Done } else { Ending::Differs })
}

/// The analyses in a file.
struct Stored {
    analyses: Vec<Value>,
    is_list: bool,
    origin: Origin,
}

fn stored(path: &Path) -> Result<Stored, Failure> {
    let bytes =
        read_bytes(path, MAX_ANALYSES_BYTES).map_err(|error| Failure::file(path, &error))?;
    let (text, form) = analysis_text(path, &bytes)?;
    let origin = Origin { form, content: Content::of(&bytes) };
    let value = parse_json(&text).map_err(|error| Failure::file(path, &error))?;
    Ok(match value {
        Value::Array(analyses) => Stored { analyses, is_list: true, origin },
        one => Stored { analyses: vec![one], is_list: false, origin },
    })
}

/// The analysis JSON that a file is, or that a report holds.
fn analysis_text(path: &Path, bytes: &[u8]) -> Result<(String, Form), Failure> {
    let text = std::str::from_utf8(bytes).ok().map(|text| text.trim_start_matches('\u{feff}'));
    let is_json = |text: &&str| text.trim_start().starts_with(['{', '[']);
    if let Some(text) = text.filter(is_json) {
        return Ok((text.to_owned(), Form::Analysis));
    }
    if let Some(text) = embedded(bytes) {
        return Ok((text, Form::Report));
    }
    match attached(bytes)? {
        Some(text) => Ok((text, Form::Report)),
        None => Err(Failure::input(
            path.display(),
            "this file has no analysis",
            "give a file from `spineline analyze CASE --json FILE` or from `spineline report CASE`",
        )),
    }
}

/// Where the analysis stands.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// A file that has nothing else.
    Analysis,
    /// A page with its results as text and figures, which are not compared.
    Report,
}

/// The file, and whether it is as it was written.
#[derive(Clone, Copy)]
struct Origin {
    form: Form,
    content: Content,
}

impl Origin {
    const fn words(self) -> &'static str {
        match (self.form, self.content) {
            (Form::Analysis, Content::AsWritten) => "File: as it was written",
            (Form::Analysis, Content::Changed) => {
                "File: CHANGED since it was written; all but the provenance is compared"
            }
            (Form::Analysis, Content::NoHash) => "File: without a hash of its content",
            (Form::Report, Content::AsWritten) => {
                "Page: as it was written; pictures in other files are not checked"
            }
            (Form::Report, Content::Changed) => {
                "Page: CHANGED since it was written; the analysis in it is compared, its text and figures are not"
            }
            (Form::Report, Content::NoHash) => {
                "Page: NOT CHECKED, since it has no hash of its content; the analysis in it is compared"
            }
        }
    }
}

/// One analysis again.
struct Repeated {
    stored: StoredAnalysis,
    analysis: Analysis,
    provenance: Provenance,
    new: Value,
    found: Found,
}

impl Repeated {
    fn of(args: &RerunArgs, old: &Value) -> Result<Self, Failure> {
        let stored = parse_analysis(&old.to_string()).map_err(|e| Failure::file(&args.file, &e))?;
        let StoredAnalysis { case, request, .. } = &stored;
        let [done, asked] = ["done", "replicates"].map(|key| old["uncertainty"][key].as_u64());
        if let Some((done, asked)) = done.zip(asked).filter(|(done, asked)| done < asked) {
            let text = format!("its analysis was interrupted after {done} of {asked} replicates");
            let help = "only a whole analysis can be repeated; analyze the case again";
            return Err(Failure::input(args.file.display(), text, help));
        }
        let mut analysis = analyze_case(&args.file, case, &request.options)?;
        analysis.warnings.merge(&picture_warnings(old));
        let confidence = Confidence::compute(case, &mut analysis, request, args.threads)?;
        if confidence.is_cut_short() {
            // Fewer replicates than then would only look like a difference.
            return Err(Failure::interrupted());
        }
        let inputs = stored.provenance.inputs.clone();
        let provenance = Provenance::new(this_run()?, stored.provenance.films, inputs)
            .of_cases([case.id.clone()])
            .asking(request);
        let file = AnalysisFile::new(&analysis, stored.case_file.clone(), provenance.clone());
        let file = results_text(&confidence.add_to(&analysis, file));
        let new = parse_json(&file).map_err(|error| Failure::internal(error.to_string()))?;
        let found = differences(old, &new, args.tolerance);
        Ok(Self { stored, analysis, provenance, new, found })
    }

    fn add_to(&self, text: &mut Lines, args: &RerunArgs, origin: Origin) {
        let (then, now) = (&self.stored.provenance, &self.provenance);
        let synthetic = if self.stored.case.synthetic { " · SYNTHETIC" } else { "" };
        let (case, date) = (&self.stored.case.id, &then.date_utc);
        text.line(format!("{case}{synthetic} · analysed {date} by {}", then.program));
        let command = format!("Then: {}", then.command.join(" "));
        text.text(&terminal::paragraph(&command, width(), "  "));
        if then.program == now.program {
            text.line(format!("  Version: the same, {}", now.program));
        } else {
            text.line(format!("  Version: then {}, now {}", then.program, now.program));
        }
        text.text(&terminal::paragraph(origin.words(), width(), "  "));
        for input in &then.inputs {
            let said = format!("Input {}: {}", input.name, input_words(&args.file, input));
            text.text(&terminal::paragraph(&said, width(), "  "));
        }
        text.text(&found_text(&self.found, args.tolerance));
    }
}

/// The state of an input file, in words.
fn input_words(report: &Path, input: &InputFile) -> &'static str {
    let named = PathBuf::from(&input.name);
    let beside = report.with_file_name(named.file_name().unwrap_or_default());
    // The name comes from the analysis, and may name a device or a pipe.
    let read = |path: PathBuf| {
        let is_plain = path.is_file();
        is_plain.then(|| read_bytes(&path, MAX_ANALYSES_BYTES).ok()).flatten()
    };
    let bytes = [named, beside].into_iter().find_map(read);
    match bytes.map(|bytes| spineline_files::sha256_hex(&bytes) == input.sha256) {
        Some(true) => "unchanged",
        Some(false) => "CHANGED since; the stored content is repeated",
        None => "not here; not needed",
    }
}

fn found_text(found: &Found, tolerance: f64) -> String {
    let compared = format!("{} numbers and {} other values", found.numbers, found.others);
    if found.all.is_empty() {
        return format!("  Nothing differs: {compared} within {tolerance:e}\n");
    }
    let part = |relative: Option<f64>| relative.map_or_else(none, |part| scientific(part, 1));
    let table = Table::of("", &found.all, |add| {
        add.words("Where", |one| one.path.clone());
        add.numbers("Then", |one| one.then.clone());
        add.numbers("Now", |one| one.now.clone());
        add.numbers("Relative difference", |one| part(one.relative));
    });
    format!(
        "  {} of {compared} differ by more than {tolerance:e}\n\n{}",
        found.all.len(),
        terminal::table(&table, entry_width())
    )
}
