//! Remarks on the pooled data: doubted films, and chains of different vertebrae.

use std::cmp::Reverse;

use crate::analysis::{Analysis, listed};
use crate::anatomy::{Levels, Posture};
use crate::warning::{WarningCode, counted, first_named};

/// A film that may not show what it is named after.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DoubtedFilm {
    /// The patient.
    pub case_id: String,
    /// The film; in files `null` for the lateral one.
    pub posture: Option<Posture>,
    /// The warning.
    pub code: WarningCode,
    /// Why it is doubted.
    pub reason: String,
}

impl DoubtedFilm {
    /// The films of a patient.
    pub(super) fn of(analysis: &Analysis) -> Vec<Self> {
        let doubts = analysis.film_doubts().map(|warning| Self {
            case_id: analysis.case_id.clone(),
            posture: warning.posture,
            code: warning.code,
            reason: warning.message.clone(),
        });
        doubts.collect()
    }

    /// The film by name.
    #[must_use]
    pub fn film(&self) -> String {
        self.posture.map_or_else(|| "lateral".to_owned(), |posture| posture.to_string())
    }
}

/// Patients whose models have the same vertebrae.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChainCount {
    /// The vertebrae.
    pub levels: Levels,
    /// How many patients.
    pub patients: usize,
}

impl ChainCount {
    /// Of all patients: the chain of most patients first; of chains of as many patients the longer one.
    pub(super) fn all(patients: impl Iterator<Item = Levels>) -> Vec<Self> {
        let mut counts: Vec<Self> = Vec::new();
        for levels in patients {
            match counts.iter_mut().find(|count| count.levels == levels) {
                Some(count) => count.patients += 1,
                None => counts.push(Self { levels, patients: 1 }),
            }
        }
        counts.sort_by_key(|count| {
            let levels = count.levels;
            (Reverse(count.patients), Reverse(levels.len()), levels.base())
        });
        counts
    }
}

/// Which films of which patients are doubted.
pub(super) fn doubted_sentence(
    films: &[DoubtedFilm],
    doubted: usize,
    patients: usize,
) -> Option<String> {
    // The films of a patient are neighbours.
    let by_patient = || films.chunk_by(|a, b| a.case_id == b.case_id);
    let name = |films: &[DoubtedFilm]| {
        let mut names: Vec<String> = Vec::new();
        for name in films.iter().map(DoubtedFilm::film) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        format!("{} ({})", films[0].case_id, names.join(", "))
    };
    (doubted > 0).then(|| {
        let named = first_named(by_patient().map(name), doubted);
        format!(
            "Films of {doubted} of {patients} patients may be wrong; check them first: {named}. Means and tests leave these patients out until then."
        )
    })
}

/// That the patients have different chains, and what is not comparable then.
pub(super) fn chains_sentence(chains: &[ChainCount]) -> Option<String> {
    let named: Vec<String> = chains
        .iter()
        .map(|chain| {
            let (patients, levels) = (counted(chain.patients, "patient"), chain.levels);
            format!("{patients} from {} to {}", levels.base(), levels.top())
        })
        .collect();
    (chains.len() > 1).then(|| {
        format!(
            "Warning: models of different vertebrae are pooled: {}. Location errors, amplitudes, numbers of joints and iliac lines of different chains are not comparable: analyse each chain separately as well.",
            listed(&named)
        )
    })
}
