//! The request for a case, and its record in a provenance, sufficient to repeat it.

use spineline::analysis::AnalysisOptions;
use spineline::uncertainty::LandmarkNoise;

use crate::method_text::{OPTIONS, OptionError, set_in_order, set_option_of_text};
use crate::provenance::{OptionsRecord, ReplicatesRecord};
use crate::rotation_prior_record::RotationPriorRecord;
use crate::{FileError, Provenance, StiffnessFile};

/// Everything on which an analysis file depends, except for the case.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Request {
    /// Options of the analysis.
    pub options: AnalysisOptions,
    /// Monte Carlo replicates.
    pub replicates: Option<Replicates>,
    /// Whether identifiability is requested.
    pub identifiability: bool,
}

/// Monte Carlo replicates with perturbed landmarks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replicates {
    /// Number of replicates.
    pub count: u64,
    /// Size of the noise.
    pub noise: LandmarkNoise,
    /// Seed of all of them.
    pub seed: u64,
}

impl Provenance {
    /// The same with the request for every case.
    #[must_use]
    pub fn asking(self, request: &Request) -> Self {
        let mut this = self.with_published_numbers();
        this.options = Some(record(&request.options));
        this.identifiability = request.identifiability;
        this.seed = request.replicates.map(|asked| asked.seed).or(this.seed);
        this.replicates = request.replicates.map(|asked| ReplicatesRecord {
            count: asked.count,
            noise_px: match asked.noise {
                LandmarkNoise::Measured => None,
                LandmarkNoise::Pixels(px) => Some(px),
            },
        });
        this
    }

    /// The request for every case; `None` where nothing was analysed.
    ///
    /// # Errors
    /// [`FileError::Option`], [`FileError::Stiffness`], [`FileError::NoSeed`].
    pub fn request(&self) -> Result<Option<Request>, FileError> {
        let Some(options) = &self.options else { return Ok(None) };
        let replicates = self.replicates.as_ref().map(|asked| {
            Ok::<_, FileError>(Replicates {
                count: asked.count,
                noise: asked.noise_px.map_or(LandmarkNoise::Measured, LandmarkNoise::Pixels),
                seed: self.seed.ok_or(FileError::NoSeed)?,
            })
        });
        Ok(Some(Request {
            options: options_of(options)?,
            replicates: replicates.transpose()?,
            identifiability: self.identifiability,
        }))
    }
}

/// Every option whose value is a word, by its name; `None` where no value is given.
fn words_of(options: &AnalysisOptions) -> impl Iterator<Item = (String, Option<String>)> {
    let words = OPTIONS.iter().filter(|option| !option.takes_a_file());
    words.map(|option| {
        let text = Some(option.shown(options)).filter(|text| !text.is_empty());
        (option.name.to_owned(), text)
    })
}

fn record(options: &AnalysisOptions) -> OptionsRecord {
    OptionsRecord {
        words: words_of(options).collect(),
        rotation_prior: options.rotation_prior.as_ref().and_then(RotationPriorRecord::new),
        stiffness: StiffnessFile::from(&options.library),
    }
}

fn options_of(record: &OptionsRecord) -> Result<AnalysisOptions, FileError> {
    let refused = |error: OptionError| FileError::Option { reason: error.to_string() };
    let missing = |(name, _): &(String, _)| !record.words.contains_key(name);
    if let Some((name, _)) = words_of(&AnalysisOptions::default()).find(missing) {
        return Err(refused(OptionError::Missing { name }));
    }
    let words = record.words.iter();
    let given = words.filter_map(|(name, text)| Some((name.as_str(), text.as_deref()?)));
    // The text of a file opens no other file.
    let set = |options: &mut AnalysisOptions, name: &str, text: &str| {
        set_option_of_text(options, name, text, None).map(drop)
    };
    let options = set_in_order(given, set).map_err(refused)?;
    let rotation_prior = record.rotation_prior.as_ref().map(RotationPriorRecord::prior);
    Ok(AnalysisOptions {
        library: record.stiffness.clone().library()?,
        rotation_prior: rotation_prior.transpose()?,
        ..options
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method_text::all_others;

    #[test]
    fn every_option_of_the_method_is_in_the_file_and_read_from_it() {
        let options = all_others();
        let text = crate::to_text(&record(&options));
        let read = serde_json::from_str(&text).expect("our own text");
        assert!(options_of(&read).expect("sound options") == options, "an option is lost");
    }
}
