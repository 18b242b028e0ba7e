//! How far the numbers of one patient can be trusted: identifiability and landmark noise.

use spineline::analysis::{Analysis, Case};
use spineline::personalize::Identifiability;
use spineline::uncertainty::Uncertainty;
use spineline::warning::WarningCode;
use spineline_files::{AnalysisFile, Request};
use spineline_report::document::Notice;
use spineline_report::patient::Patient as ReportedPatient;
use spineline_report::warnings;
use spineline_tables::Patient;

use super::replicates::{interruption_text, run_replicates};
use crate::run::failure::Failure;
use crate::run::threads::map_all;

/// The requested measures of confidence in the numbers of one patient.
#[derive(Default)]
pub struct Confidence {
    /// Identifiability of every model's multipliers, in the order of the models.
    pub identifiability: Option<Vec<Option<Identifiability>>>,
    /// Effect of landmark noise on every number.
    pub uncertainty: Option<Uncertainty>,
}

impl Confidence {
    /// Computes what the request asks for, on this number of threads; an interruption of the replicates is a warning of the analysis.
    ///
    /// # Errors
    /// If the noise cannot be applied to this case, or threads cannot be started.
    pub fn compute(
        case: &Case,
        analysis: &mut Analysis,
        request: &Request,
        threads: usize,
    ) -> Result<Self, Failure> {
        let identifiability = request.identifiability.then(|| identify(analysis, threads));
        let uncertainty =
            request.replicates.map(|asked| run_replicates(case, analysis, &asked, threads));
        let confidence = Self {
            identifiability: identifiability.transpose()?,
            uncertainty: uncertainty.transpose()?,
        };
        if let Some(found) = confidence.uncertainty.as_ref().filter(|_| confidence.is_cut_short()) {
            let text = interruption_text(found.done, found.requested);
            analysis.warnings.push(WarningCode::ReplicatesInterrupted, text);
        }
        Ok(confidence)
    }

    /// Whether Ctrl-C has ended the replicates early.
    pub fn is_cut_short(&self) -> bool {
        self.uncertainty.as_ref().is_some_and(|found| found.done < found.requested)
    }

    /// Whether any replicate was finished.
    pub fn has_replicates(&self) -> bool {
        self.uncertainty.as_ref().is_some_and(|found| found.done > 0)
    }

    /// The patient for reports; the caller adds images of films and the file to embed.
    pub fn report<'a>(
        &'a self,
        analysis: &'a Analysis,
        case: &'a Case,
        generator: &'a str,
    ) -> ReportedPatient<'a> {
        ReportedPatient {
            case,
            analysis,
            pictures: &[],
            identifiability: self.identifiability.as_deref(),
            uncertainty: self.uncertainty.as_ref(),
            generator,
            json: "",
        }
    }

    pub fn patient<'a>(&'a self, analysis: &'a Analysis, case: &'a Case) -> Patient<'a> {
        Patient {
            analysis,
            subject: &case.subject,
            identifiability: self.identifiability.as_deref(),
            uncertainty: self.uncertainty.as_ref(),
        }
    }

    /// Adds the results to the file of an analysis.
    pub fn add_to(&self, analysis: &Analysis, file: AnalysisFile) -> AnalysisFile {
        let file = file.with_identifiability(analysis, self.identifiability.as_deref());
        file.with_uncertainty(analysis, self.uncertainty.as_ref())
    }
}

/// The warning that the replicates were interrupted.
pub fn interruption(analysis: &Analysis) -> Option<Notice> {
    let code = WarningCode::ReplicatesInterrupted.key();
    warnings(analysis).into_iter().find(|notice| notice.code == code)
}

/// Profile likelihoods of the multipliers of every model.
fn identify(analysis: &Analysis, threads: usize) -> Result<Vec<Option<Identifiability>>, Failure> {
    map_all("profiles", &analysis.models, threads, |model| analysis.identifiability(model))
}
