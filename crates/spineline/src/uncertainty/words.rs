//! Names of the quantities, and noise in words.

use super::{AnalysisQuantity, FilmNoise, NoiseSource, VertebraNoise};
use crate::analysis::Analysis;
use crate::multibody::group_title;
use crate::number::fixed;

impl AnalysisQuantity {
    /// In words, with its place.
    #[must_use]
    pub fn label(self, analysis: &Analysis) -> String {
        let what = self.kind;
        let places = [
            self.line.map(|line| line.to_string()),
            self.posture.map(|posture| posture.to_string()),
            self.level.map(|level| level.to_string()),
            self.group(analysis).map(|group| group_title(&group)),
            self.end_name().map(str::to_owned),
        ];
        let places: Vec<String> = places.into_iter().flatten().collect();
        if places.is_empty() { what.to_string() } else { format!("{what} ({})", places.join(", ")) }
    }
}

/// Noise of films, a sentence for all films that have the same.
pub(super) fn noise_words(noise: &[FilmNoise]) -> Vec<String> {
    let mut sentences: Vec<(String, Vec<String>)> = Vec::new();
    for film in noise {
        let (words, posture) = (words_of(film), film.posture.to_string());
        match sentences.iter_mut().find(|(other, _)| *other == words) {
            Some((_, postures)) => postures.push(posture),
            None => sentences.push((words, vec![posture])),
        }
    }
    sentences.iter().map(|(words, postures)| format!("{}: {words}", postures.join(", "))).collect()
}

fn words_of(noise: &FilmNoise) -> String {
    let source = match noise.source {
        NoiseSource::Readings => "from the variation of the readings of this case",
        NoiseSource::Assumed => "assumed for one careful reading, because no film was read twice",
        NoiseSource::Given => "as given",
    };
    let size = match noise.landmarks {
        VertebraNoise::Corners { sd_px: [column, row], sd_mm, axis_sd } => {
            let mm = sd_mm.map_or_else(String::new, |[y, z]| {
                format!(" ({} × {} mm)", fixed(y, 2), fixed(z, 2))
            });
            let axis =
                axis_sd.map_or_else(String::new, |sd| format!(", axes set by hand {}", sd.text(2)));
            format!("corners {} × {} px{mm}{axis}", fixed(column, 2), fixed(row, 2))
        }
        VertebraNoise::Placements { location_sd_mm, tilt_sd } => {
            format!("locations {} mm, tilts {}", fixed(location_sd_mm, 2), tilt_sd.text(2))
        }
    };
    let program = match noise.program_corners {
        0 => String::new(),
        count => format!(
            "; {count} corners that a program found move together, by the covariance of the completion or their stated deviation"
        ),
    };
    format!("{size} per reading, {source}{program}")
}
