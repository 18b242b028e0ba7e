//! `spineline film`: metadata, reliability of spacing and view, and previews of radiographs.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};
use spineline::number::fixed;
use spineline_files::{FilmOrigin, InputFile, Provenance};
use spineline_films::{FilmFile, ModalityTransform, Voi, Window, WindowFunction};
use spineline_marking::{judge_spacing, judge_view};
use spineline_report::terminal::Lines;

use crate::options::values::number;
use crate::run::failure::{Ending, Failure};
use crate::run::film_decoder::{Decoder, film_bytes};
use crate::run::messages::say;
use crate::run::outputs::{Outputs, OverwriteArgs, print, print_data};
use crate::run::provenance::{shown_name, this_run};

pub const EXAMPLES: &str = "\
Examples:
  spineline film erect.dcm                             size, spacing, view, and their sources
  spineline film films/*.dcm --json
  spineline film erect.dcm --png erect.png --window 2048,4096";

#[derive(Args)]
pub struct FilmArgs {
    /// DICOM, PNG, JPEG or TIFF files
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Write a preview as PNG, with its provenance beside it; for one film only
    #[arg(long, value_name = "OUT")]
    png: Option<PathBuf>,
    /// Invert black and white in the preview
    #[arg(long, requires = "png")]
    invert: bool,
    /// Display window of stored values, instead of the window in the file
    #[arg(long, value_name = "CENTER,WIDTH", requires = "png", value_parser = window, allow_hyphen_values = true)]
    window: Option<Window>,
    /// Print one JSON object per film instead of text
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    overwrite: OverwriteArgs,
}

fn window(text: &str) -> Result<Window, String> {
    let (center, width) = text
        .split_once(',')
        .ok_or_else(|| "expected CENTER,WIDTH, such as 2048,4096".to_owned())?;
    let function = WindowFunction::Linear;
    let window = Window { center: number(center)?, width: number(width)?, function };
    if window.is_valid() { Ok(window) } else { Err("the width must be at least 1".to_owned()) }
}

pub fn run(args: &FilmArgs) -> Result<Ending, Failure> {
    if args.png.is_some() && args.files.len() > 1 {
        return Err(Failure::usage("--png takes one film"));
    }
    let outputs = Outputs::new(args.overwrite, args.files.iter().map(PathBuf::as_path));
    if let Some(out) = &args.png {
        outputs.table(out)?;
    }
    let decoder = Decoder::new()?;
    let mut ending = Ending::Done;
    for path in &args.files {
        let bytes = film_bytes(path)?;
        let input = InputFile::of(shown_name(path), &bytes);
        let film = match decoder.decode(bytes) {
            Ok(film) => film,
            Err(error) => {
                say(&Failure::of(path.display(), &error));
                ending = Ending::BadInput;
                continue;
            }
        };
        if args.json {
            print_data(&format!("{}\n", as_json(path, &film)))?;
        } else {
            print(as_text(path, &film))?;
        }
        if let Some(out) = &args.png {
            let png = film.display(args.window.as_ref(), args.invert).to_png();
            let origin = FilmOrigin::of([film.tags.is_phantom]);
            let provenance = Provenance::new(this_run()?, origin, vec![input]);
            outputs.write_table(out, png, &provenance)?;
        }
    }
    outputs.commit_and_say()?;
    Ok(ending)
}

fn as_text(path: &Path, film: &FilmFile) -> Lines {
    let mut text = Lines::of(format!("{}:", path.display()));
    let tags = &film.tags;
    let modality = tags.modality.as_deref().unwrap_or("modality not stated");
    let syntax =
        tags.transfer_syntax.as_deref().map_or_else(String::new, |name| format!(", {name}"));
    let mut line = |label: &str, value: &str| {
        text.line(format!("  {label:<9} {value}"));
    };
    let synthetic = if tags.is_phantom { " · SYNTHETIC" } else { "" };
    line("kind", &format!("{} {modality}{syntax}{synthetic}", film.kind));
    line(
        "size",
        &format!("{} columns, {} rows, {} bits", film.columns, film.rows, tags.bits_stored),
    );
    let bright = if film.is_inverted() { "small" } else { "large" };
    line("polarity", &format!("{}: {bright} values are bright", tags.photometric.name()));
    line("window", &voi_text(film));
    let spacing = judge_spacing(&tags.spacing);
    line(
        "spacing",
        &match spacing.spacing {
            Some(s) => format!(
                "columns {}, rows {} {}; {}",
                fixed(s.column_mm, 4),
                fixed(s.row_mm, 4),
                s.plane.unit(),
                s.source
            ),
            None => "none".to_owned(),
        },
    );
    let view = judge_view(&tags.view, None);
    let side = view.patient_left.map_or_else(String::new, |side| {
        format!(
            "; the patient's left is on the {} of the picture",
            format!("{side:?}").to_lowercase()
        )
    });
    line(
        "view",
        &match view.view {
            Some(found) => format!("{}{side}", format!("{found:?}").to_lowercase()),
            None => "not known".to_owned(),
        },
    );
    for remark in &spacing.remarks {
        line("!", &remark.to_string());
    }
    for remark in &film.remarks {
        line("!", &remark.to_string());
    }
    for question in &view.questions {
        line("?", &question.to_string());
    }
    text
}

fn voi_text(film: &FilmFile) -> String {
    let modality = match &film.look.modality {
        ModalityTransform::Lut(lut) => format!(", after a table of {} values", lut.values.len()),
        ModalityTransform::Rescale { slope, intercept } if (*slope, *intercept) != (1.0, 0.0) => {
            format!(", after {slope} · value + {intercept}")
        }
        ModalityTransform::Rescale { .. } => String::new(),
    };
    let shown = match film.look.voi.first() {
        Some(Voi::Lut(lut)) => format!("a table of {} values", lut.values.len()),
        Some(Voi::Window(window)) => format!("{} wide around {}", window.width, window.center),
        None => "the whole range of values".to_owned(),
    };
    shown + &modality
}

fn as_json(path: &Path, film: &FilmFile) -> Value {
    let tags = &film.tags;
    let spacing = judge_spacing(&tags.spacing);
    let view = judge_view(&tags.view, None);
    let texts = |items: Vec<String>| Value::from(items);
    json!({
        "file": shown_name(path),
        "kind": film.kind.to_string(),
        "synthetic": tags.is_phantom,
        "modality": tags.modality,
        "transfer_syntax": tags.transfer_syntax,
        "columns": film.columns,
        "rows": film.rows,
        "bits_stored": tags.bits_stored,
        "photometric": tags.photometric.name(),
        "small_values_are_bright": film.is_inverted(),
        "spacing": spacing.spacing.map(|s| json!({
            "column_mm": s.column_mm,
            "row_mm": s.row_mm,
            "plane": s.plane.unit(),
            "source": s.source.key(),
        })),
        "spacing_remarks": texts(spacing.remarks.iter().map(ToString::to_string).collect()),
        "view": view.view.map(|view| format!("{view:?}").to_lowercase()),
        "patient_left": view.patient_left.map(|side| format!("{side:?}").to_lowercase()),
        "view_questions": texts(view.questions.iter().map(ToString::to_string).collect()),
        "remarks": texts(film.remarks.iter().map(ToString::to_string).collect()),
    })
}
