//! The request of a run and the inputs it has read.

use std::path::Path;

use indexmap::IndexMap;
use spineline::analysis::Analysis;
use spineline::anatomy::Level;
use spineline::cohort::KnownPatients;
use spineline::measure::AmplitudeEnds;
use spineline_files::{
    FilmOrigin, InputFile, ProgramRun, Provenance, Request, StoredRotationPrior,
};
use spineline_report::document::{Notice, NoticeKind};

use crate::options::method::MethodArgs;
use crate::options::uncertainty::UncertaintyArgs;
use crate::run::failure::Failure;
use crate::run::inputs::{CaseInput, count_once, read_input};
use crate::run::provenance::this_run;

/// The request of this run, and the files that it has read for all cases.
pub struct RunRecord {
    run: ProgramRun,
    /// The request for every case.
    pub request: Request,
    shared: Vec<InputFile>,
    /// The distribution of joint rotations that was given.
    rotation_prior: Option<StoredRotationPrior>,
    /// Whether the ends of amplitudes were given by themselves.
    gives_amplitude: bool,
}

/// The cases that outputs are made from.
#[derive(Default)]
pub struct ReadCases {
    /// By identifier, in the order in which they were added.
    cases: IndexMap<String, ReadCase>,
    known: KnownPatients,
}

struct ReadCase {
    input: InputFile,
    synthetic: bool,
    /// Read from an analysis that was made with other options.
    has_other_options: bool,
}

impl RunRecord {
    /// A record before any case is read.
    ///
    /// # Errors
    /// If a file that the options name cannot be read.
    pub fn new(method: &MethodArgs, uncertainty: &UncertaintyArgs) -> Result<Self, Failure> {
        let (options, rotation_prior) = method.options()?;
        let request = Request {
            options,
            replicates: uncertainty.replicates.asked(),
            identifiability: uncertainty.identifiability,
        };
        let shared = method.files().map(read_input).collect::<Result<_, _>>()?;
        let gives_amplitude = method.is_given("amplitude");
        Ok(Self { shared, rotation_prior, gives_amplitude, ..Self::asking(request)? })
    }

    /// A record of a request that names no file.
    ///
    /// # Errors
    /// If `SOURCE_DATE_EPOCH` is set and is not a time.
    pub fn asking(request: Request) -> Result<Self, Failure> {
        let (run, shared) = (this_run()?, Vec::new());
        Ok(Self { run, request, shared, rotation_prior: None, gives_amplitude: false })
    }

    /// Names the films that lack L5 or T1, where amplitudes between these were asked for.
    pub fn amplitude_note(&self, analysis: &Analysis) -> Option<Notice> {
        let asked = self.gives_amplitude && self.request.options.amplitude == AmplitudeEnds::T1L5;
        let films = analysis.movement.films.iter().map(|film| &film.outline).filter(|_| asked);
        let lacking = films.filter(|film| film.amplitude_levels() != [Level::L5, Level::T1]);
        let films: Vec<String> = lacking.map(|film| format!("{} film", film.posture)).collect();
        let words = || {
            let (case, films) = (&analysis.case_id, films.join(", "));
            format!(
                "{case}: L5 or T1 is missing, so that --amplitude t1-l5 does not count: {films}"
            )
        };
        (!films.is_empty()).then(|| Notice::new(NoticeKind::Note, words()))
    }

    /// Provenance of an output that is made from one case.
    pub fn provenance_of(&self, case: &CaseInput) -> Provenance {
        let from = [(case.case.synthetic, &case.input)];
        self.provenance_from(from).of_cases([case.case.id.clone()])
    }

    /// Refuses a case from which the given distribution of joint rotations was learned: it would predict its own data.
    ///
    /// # Errors
    /// Of such a case.
    pub fn check_learned(&self, source: &CaseInput) -> Result<(), Failure> {
        let Some(prior) = &self.rotation_prior else { return Ok(()) };
        let InputFile { name, sha256, .. } = &source.input;
        let known = prior.check_case(sha256, &source.case.id);
        known.map_err(|error| Failure::file(Path::new(name), &error))
    }

    /// Provenance of an output that is made from several cases.
    pub fn provenance_of_all(&self, read: &ReadCases) -> Provenance {
        let from = read.cases.values().map(|case| (case.synthetic, &case.input));
        self.provenance_from(from).of_cases(read.ids())
    }

    fn provenance_from<'a>(
        &self,
        cases: impl IntoIterator<Item = (bool, &'a InputFile)>,
    ) -> Provenance {
        let (synthetic, inputs): (Vec<bool>, Vec<&InputFile>) = cases.into_iter().unzip();
        let inputs = inputs.into_iter().chain(&self.shared).cloned().collect();
        Provenance::new(self.run.clone(), FilmOrigin::of(synthetic), inputs).asking(&self.request)
    }
}

impl ReadCases {
    /// Adds a case.
    ///
    /// # Errors
    /// If its patient was read before ([`KnownPatients`]).
    pub fn add(&mut self, source: &CaseInput, record: &RunRecord) -> Result<(), Failure> {
        let (name, id) = (&source.input.name, &source.case.id);
        count_once(&mut self.known, name, &source.case)?;
        let other = |asked: &Request| asked.options != record.request.options;
        let case = ReadCase {
            input: source.input.clone(),
            synthetic: source.case.synthetic,
            has_other_options: source.request.as_ref().is_some_and(other),
        };
        self.cases.insert(id.clone(), case);
        Ok(())
    }

    /// Identifiers of the cases.
    pub fn ids(&self) -> Vec<String> {
        self.cases.keys().cloned().collect()
    }

    /// Warnings about cases that were read from analyses with other options.
    pub fn warnings(&self) -> Vec<Notice> {
        let warning = |case: &ReadCase| Notice {
            kind: NoticeKind::Warning,
            place: case.input.name.clone(),
            text: "this analysis was made with other options; `spineline rerun` keeps them"
                .to_owned(),
            code: "other_options".to_owned(),
        };
        self.cases.values().filter(|case| case.has_other_options).map(warning).collect()
    }
}
