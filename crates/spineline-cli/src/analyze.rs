//! `spineline analyze`: one patient, or a cohort.

use std::fs;
use std::path::{Path, PathBuf};

use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::anatomy::Posture;
use spineline::cohort::Cohort;
use spineline::personalize::Identifiability;
use spineline::uncertainty::Uncertainty;
use spineline_files::{
    AnalysisFile, FilmOrigin, InputFile, ModelFile, ProgramRun, Provenance, Request,
};
use spineline_report::figures;
use spineline_tables::Patient;

use crate::args::AnalyzeArgs;
use crate::failure::{Ending, Failure};
use crate::options::OptionArgs;
use crate::progress::map_all;
use crate::provenance::{Source, in_svg, read_input, this_run, write_table};
use crate::rows::{chain_text, csv_text};
use crate::uncertainty::UncertaintyArgs;
use crate::{
    cohort, comparison, identifiability, models, options, print, report, tables, uncertainty,
};

/// What wrote a file.
pub fn generator() -> String {
    format!("spineline {}", env!("CARGO_PKG_VERSION"))
}

pub fn run(args: &AnalyzeArgs) -> Result<Ending, Failure> {
    let mut origins = Origins::new(&args.options, &args.uncertainty)?;
    let options = &origins.request.options;
    let paths = case_files(&args.cases)?;
    let outputs = [&args.json, &args.csv, &args.chain, &args.cohort].into_iter().flatten();
    let to_stdout = outputs.filter(|path| path.as_os_str() == "-").count();
    if to_stdout > 1 {
        return Err(Failure::usage(
            "only one of --json, --csv, --chain and --cohort can go to the standard output",
        ));
    }
    if args.model.is_some() && paths.len() != 1 {
        return Err(Failure::usage("--model writes the model of one case; give one case file"));
    }
    let results = map_all("analysing", &paths, args.threads, |path| {
        let source = Source::read(path)?;
        Ok((analyze_case(path, &source.case, options)?, source))
    })?;
    let (mut analyses, mut sureness) = (Vec::<Analysis>::new(), Vec::new());
    let mut ending = Ending::Done;
    for result in results {
        match result.and_then(|one| origins.once(one)) {
            Ok((analysis, source)) => {
                sureness.push(Sureness::ask(
                    &source.case,
                    &analysis,
                    &origins.request,
                    args.threads,
                )?);
                origins.sources.push(source);
                analyses.push(analysis);
            }
            Err(failure) if paths.len() == 1 => return Err(failure),
            Err(failure) => {
                eprintln!("{failure}");
                ending = Ending::BadInput;
            }
        }
    }
    eprint!("{}", origins.warnings());
    for analysis in &analyses {
        eprint!("{}", report::warnings(analysis));
    }
    let is_one = paths.len() == 1;
    let together = (!is_one || args.cohort.is_some()).then(|| cohort::of(&analyses));
    let found = Found { analyses: &analyses, sureness: &sureness, together: together.as_ref() };
    write_files(args, &found, &origins, !is_one)?;
    if to_stdout == 0 {
        print(&match &analyses[..] {
            [one] if is_one => {
                let compared = Some(models::text(&analyses)).filter(|text| !text.is_empty());
                let sure = sureness.iter().flat_map(|sure| sure.texts(one));
                let parts = [report::text(one)].into_iter().chain(compared).chain(sure);
                parts.collect::<Vec<_>>().join("\n")
            }
            all => {
                let together = together.iter().map(|found| cohort::text(all, found));
                together.chain([models::text(all)]).collect()
            }
        })?;
    }
    if ending == Ending::Done && !analyses.iter().all(Analysis::is_converged) {
        ending = Ending::NotConverged;
    }
    Ok(ending)
}

/// What all outputs of a run come from.
pub struct Origins {
    run: ProgramRun,
    /// What is asked of every case.
    pub request: Request,
    /// Read for all cases.
    shared: Vec<InputFile>,
    /// In the order of the analyses.
    pub sources: Vec<Source>,
}

impl Origins {
    /// Of this run, with no case yet.
    ///
    /// # Errors
    /// If a stiffness table cannot be read.
    pub fn new(options: &OptionArgs, sureness: &UncertaintyArgs) -> Result<Self, Failure> {
        let request = options::request(options, sureness)?;
        let tables = options.stiffness.iter();
        let shared = tables.map(|path| read_input(path)).collect::<Result<_, _>>()?;
        Ok(Self { run: this_run()?, request, shared, sources: Vec::new() })
    }

    /// When this run began, as all of its outputs say.
    pub fn date_utc(&self) -> &str {
        &self.run.date_utc
    }

    /// Refuses a case that was there before: a cohort would count its patient twice.
    ///
    /// # Errors
    /// If it was.
    pub fn once(
        &self,
        (analysis, source): (Analysis, Source),
    ) -> Result<(Analysis, Source), Failure> {
        if self.sources.iter().any(|earlier| earlier.case.id == source.case.id) {
            let text = format!("the case {} was given already", source.case.id);
            let help = "give every case a `case_id` of its own";
            return Err(Failure::input(&source.input.name, &text, help));
        }
        Ok((analysis, source))
    }

    /// Cases that were analysed before in another way.
    pub fn warnings(&self) -> String {
        let other = |asked: &Request| asked.options != self.request.options;
        let others = self.sources.iter().filter(|source| source.asked.as_ref().is_some_and(other));
        let warning = |source: &Source| {
            format!(
                "warning: {}: this analysis had other options; `spineline rerun` keeps its own [other_options]\n",
                source.input.name
            )
        };
        others.map(warning).collect()
    }

    /// Of an output that is made from some of the cases.
    pub fn of(&self, sources: &[Source]) -> Provenance {
        let films = FilmOrigin::of(sources.iter().map(|source| source.case.synthetic));
        let inputs = sources.iter().map(|source| source.input.clone());
        let inputs = inputs.chain(self.shared.iter().cloned()).collect();
        Provenance::new(self.run.clone(), films, inputs).asking(&self.request)
    }

    /// Of an output that is made from all of them.
    fn of_all(&self) -> Provenance {
        self.of(&self.sources)
    }
}

/// What was asked about how sure the numbers of one patient are.
pub struct Sureness {
    /// Of every model's multipliers, in the order of the models.
    pub identified: Option<Vec<Option<Identifiability>>>,
    /// Of every number.
    pub spread: Option<Uncertainty>,
}

impl Sureness {
    /// Asks it, on so many threads.
    ///
    /// # Errors
    /// If the noise cannot be laid on this case.
    pub fn ask(
        case: &Case,
        analysis: &Analysis,
        request: &Request,
        threads: usize,
    ) -> Result<Self, Failure> {
        let identified = request.identifiability.then(|| identifiability::run(analysis, threads));
        let spread =
            request.replicates.map(|asked| uncertainty::run(case, analysis, &asked, threads));
        Ok(Self { identified: identified.transpose()?, spread: spread.transpose()? })
    }

    /// What tables tell of the patient.
    fn patient<'a>(&'a self, analysis: &'a Analysis, case: &'a Case) -> Patient<'a> {
        Patient {
            analysis,
            subject: &case.subject,
            identified: self.identified.as_deref(),
            spread: self.spread.as_ref(),
        }
    }

    fn texts(&self, analysis: &Analysis) -> impl Iterator<Item = String> {
        let identified =
            self.identified.as_ref().map(|found| identifiability::text(analysis, found));
        let spread = self.spread.as_ref().map(|found| uncertainty::text(analysis, found));
        identified.into_iter().chain(spread)
    }

    /// The file of an analysis with the answers.
    pub fn write(&self, analysis: &Analysis, mut file: AnalysisFile) -> AnalysisFile {
        if let Some(found) = &self.identified {
            file = file.with_identifiability(analysis, found);
        }
        if let Some(found) = &self.spread {
            file = file.with_uncertainty(analysis, found);
        }
        file
    }
}

/// The case files behind files and folders, in order; a folder stands for the `.json` files in it.
pub fn case_files(given: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut files = Vec::new();
    for path in given {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let entries = fs::read_dir(path).and_then(Iterator::collect::<Result<Vec<_>, _>>).map_err(
            |error| Failure::input(&path.display().to_string(), &error, "check the folder"),
        )?;
        let mut inside: Vec<PathBuf> = entries
            .into_iter()
            .map(|entry| entry.path())
            .filter(|file| file.extension().is_some_and(|e| e == "json") && !is_truth(file))
            .collect();
        if inside.is_empty() {
            let place = path.display().to_string();
            return Err(Failure::input(
                &place,
                &"no .json file in this folder",
                "give a folder of case files",
            ));
        }
        inside.sort();
        files.append(&mut inside);
    }
    Ok(files)
}

/// The truth of a phantom lies beside its case.
fn is_truth(path: &Path) -> bool {
    path.to_string_lossy().ends_with(".truth.json")
}

pub fn analyze_file(path: &Path, options: &AnalysisOptions) -> Result<Analysis, Failure> {
    analyze_case(path, &Source::read(path)?.case, options)
}

/// Analyses a case; what stops it is told with the file.
///
/// # Errors
/// What stops the analysis.
pub fn analyze_case(
    path: &Path,
    case: &Case,
    options: &AnalysisOptions,
) -> Result<Analysis, Failure> {
    analyze(case, options)
        .map_err(|error| Failure::input(&path.display().to_string(), &error, error.help()))
}

/// What is written.
struct Found<'a> {
    analyses: &'a [Analysis],
    sureness: &'a [Sureness],
    /// Where it is a cohort, or asked as one.
    together: Option<&'a Cohort>,
}

fn write_files(
    args: &AnalyzeArgs,
    found: &Found<'_>,
    origins: &Origins,
    many: bool,
) -> Result<(), Failure> {
    let Found { analyses, sureness, together } = *found;
    if let Some(path) = &args.json {
        let files = analyses.iter().zip(sureness).zip(&origins.sources);
        let files: Vec<AnalysisFile> = files
            .map(|((one, sure), source)| {
                let provenance = origins.of(std::slice::from_ref(source));
                sure.write(one, AnalysisFile::new(one, source.file.clone(), provenance))
            })
            .collect();
        let text = match &files[..] {
            [one] if !many => spineline_files::to_text(one),
            all => spineline_files::to_text(&all),
        };
        write_or_print(path, &text)?;
    }
    if let Some(path) = &args.csv {
        write_table(path, &csv_text(analyses)?, &origins.of_all())?;
    }
    if let Some(path) = &args.chain {
        write_table(path, &chain_text(analyses)?, &origins.of_all())?;
    }
    if let (Some(path), Some(together)) = (&args.cohort, together) {
        if path.extension().is_some_and(|end| end == "csv") {
            write_table(path, &comparison::cohort_csv(together)?, &origins.of_all())?;
        } else {
            let file = cohort::file(analyses, together, &generator());
            let file = file.with_provenance(origins.of_all());
            write_or_print(path, &spineline_files::to_text(&file))?;
        }
    }
    if let (Some(path), [analysis]) = (&args.model, analyses) {
        write_model(path, args, analysis, origins)?;
    }
    if let Some(folder) = &args.tables.folder {
        let patients: Vec<Patient<'_>> = analyses
            .iter()
            .zip(sureness)
            .zip(&origins.sources)
            .map(|((analysis, sure), source)| sure.patient(analysis, &source.case))
            .collect();
        tables::write(folder, &args.tables.formats, &patients, &origins.of_all())?;
    }
    if let Some(folder) = &args.figures {
        for (analysis, source) in analyses.iter().zip(&origins.sources) {
            draw(analysis, &origins.of(std::slice::from_ref(source)), folder)?;
        }
    }
    Ok(())
}

fn write_model(
    path: &Path,
    args: &AnalyzeArgs,
    analysis: &Analysis,
    origins: &Origins,
) -> Result<(), Failure> {
    let kind = args.model_line.kind();
    let Some(model) = analysis.models.iter().find(|model| model.kind == kind) else {
        let text = format!("there is no model with the {kind}, so --model has nothing to write");
        return Err(Failure::input(
            &analysis.case_id,
            &text,
            "the warnings say why; try --model-line iliac",
        ));
    };
    let file = ModelFile::new(analysis, model, &generator()).with_provenance(origins.of_all());
    write_or_print(path, &spineline_files::to_text(&file))
}

/// Writes a file as a whole: a reader never sees half of it.
pub fn write_file(path: &Path, content: impl AsRef<[u8]>) -> Result<(), Failure> {
    let failed = |error: &std::io::Error| Failure::write(&path.display().to_string(), error);
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder).map_err(|error| failed(&error))?;
    }
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".part");
    let part = path.with_file_name(name);
    fs::write(&part, content).and_then(|()| fs::rename(&part, path)).map_err(|error| failed(&error))
}

/// Writes a file, or to the standard output for `-`.
pub fn write_or_print(path: &Path, text: &str) -> Result<(), Failure> {
    if path.as_os_str() == "-" { print(text).map(|_| ()) } else { write_file(path, text) }
}

/// The figures of one patient.
///
/// # Errors
/// If they cannot be written.
pub fn draw(analysis: &Analysis, provenance: &Provenance, folder: &Path) -> Result<(), Failure> {
    let save = |name: &str, svg: &str| {
        write_file(
            &folder.join(format!("{}-{name}.svg", analysis.case_id.replace(['/', '\\'], "_"))),
            in_svg(svg, provenance),
        )
    };
    save("overview", &figures::case_overview(analysis))?;
    if let Some(svg) = figures::rotations(analysis) {
        save("rotations", &svg)?;
    }
    for posture in Posture::MOVED {
        if let Some(svg) = figures::measured_and_simulated(analysis, posture) {
            save(&format!("simulated-{}", posture.key()), &svg)?;
        }
    }
    Ok(())
}
