//! Vertebrae on a frontal radiograph of an erect spine: picture in, four corners of every vertebra with their uncertainty out.
//!
//! Two small networks, trained from scratch on public films, run here in plain arithmetic: the same picture gives the same bits on
//! every machine. The first one sees the whole film on a small grid and gives centres, rough corners and levels; vertebrae are the chain
//! of centres that looks most like a spine. The second one sees a patch around each vertebra and places its corners.
//!
//! The training films show erect adolescents with scoliosis only: no bends, no lateral films, no adults, no implants.
//! `crates/spineline-weights/README.md` is their model card. A person must check the proposals.
//!
//! ```
//! use spineline::anatomy::ImageSide;
//! use spineline_detect::{Picture, Refusal, detect};
//!
//! // An empty picture shows no spine.
//! let values = vec![0.0; 400 * 800];
//! let picture = Picture { columns: 400, rows: 800, pixel_aspect: 1.0, patient_left: ImageSide::Right, values: &values };
//! assert!(matches!(detect(&picture, None), Err(Refusal::NoSpine { .. })));
//! ```

#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare with exact values"))]

mod chain;
mod count;
mod grid;
mod kernel;
mod patches;
mod peaks;
mod picture;
#[cfg(test)]
mod reference;
mod weights;

use spineline::anatomy::Level;
use spineline::measure::{Corners, IliacCrests};
use spineline::spatial::Pixel;

use chain::{Chain, chain_of};
pub use count::LevelCount;
use grid::{Grid, coarse_input};
use peaks::peaks_of;
pub use picture::Picture;

/// A film with fewer consecutive vertebrae is refused.
const MIN_VERTEBRAE: usize = 12;
/// A film whose lowest vertebra lies above L2 is refused, because chest films also show a part of the spine. T1 is
/// zero.
const MIN_LAST_LEVEL: usize = 13;
/// A film whose vertebrae are found with a smaller mean probability is refused.
const MIN_MEAN_PROBABILITY: f64 = 0.30;
/// Largest size of the film from which patches are taken.
const FINE: [usize; 2] = [512, 896];
/// Confidence falls to 1/e where the deviation of the corners is this part of the height.
const CONFIDENCE_SD_SHARE: f64 = 0.25;
/// Largest standard deviation of a corner, as a part of the height, of a vertebra that is clearly found. On 54 validation films the corners
/// of 28 % of the vertebrae with 13 to 15 % are on average wrong by more than a quarter of the height, of 52 % with 16 to 18 %, and of
/// 85 % with 19 to 22 %. Where 45 % are wrong, a look and a correction take as long as two clicks.
const CLEAR_SD_SHARE: f64 = 0.155;
/// Minimum side of a film.
const MIN_SIDE_PX: usize = 64;

/// A vertebra that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectedVertebra {
    /// Level by the count of the whole chain.
    pub level: Level,
    /// Its corners.
    pub corners: Corners<Pixel>,
    /// Standard deviation of a coordinate of a corner, as a part of the height of the body.
    pub sd_share: f64,
    /// From 0 to 1.
    pub confidence: f64,
    /// Whether it was seen; else it was interpolated.
    pub is_seen: bool,
    /// Probabilities of its levels by itself, from L5 to T1.
    pub votes: [f64; Level::ALL.len()],
}

impl DetectedVertebra {
    /// Whether a person may accept it together with others after a look.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.is_seen && self.sd_share <= CLEAR_SD_SHARE
    }
}

/// The body of a vertebra in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenBody {
    /// Its corners.
    pub corners: Corners<Pixel>,
    /// Standard deviation of a coordinate of a corner, as a part of the height of the body.
    pub sd_share: f64,
}

/// The vertebrae of a film.
#[derive(Debug, Clone, PartialEq)]
pub struct Detection {
    /// Vertebrae, caudal first.
    pub vertebrae: Vec<DetectedVertebra>,
    /// How sure their levels are.
    pub count: LevelCount,
    /// Vertebrae that would lie beyond the edge of the film, and are left out.
    pub beyond_edge: usize,
}

impl Detection {
    /// Which vertebrae are left out, in words.
    #[must_use]
    pub fn left_out(&self) -> Option<String> {
        let count = self.beyond_edge;
        (count > 0).then(|| format!("vertebrae left out beyond the edge of the film: {count}"))
    }
}

/// Why the program proposes nothing for a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The program was built without the feature `weights`.
    #[error(
        "this program was built without the networks that find vertebrae; place the landmarks by hand"
    )]
    NoNetworks,
    /// The picture shows no frontal spine.
    #[error(
        "no frontal spine was found: {vertebrae} vertebrae in a row, and {} down to L2 or lower are needed at least; place the landmarks by hand",
        MIN_VERTEBRAE
    )]
    NoSpine {
        /// Vertebrae in a row.
        vertebrae: usize,
    },
    /// The picture has too few pixels, or its values do not fill it.
    #[error(
        "a picture of {columns} × {rows} pixels is too small for a film (at least {} × {}), or lacks values",
        MIN_SIDE_PX,
        MIN_SIDE_PX
    )]
    NoFilm {
        /// Columns.
        columns: usize,
        /// Rows.
        rows: usize,
    },
}

/// Finds the vertebrae on a film. Iliac crests that a person marked help to name the vertebrae: in most people they lie beside L4.
///
/// # Errors
/// [`Refusal`] if the picture shows no frontal spine, or is not a film.
pub fn detect(picture: &Picture<'_>, crests: Option<IliacCrests>) -> Result<Detection, Refusal> {
    if !cfg!(feature = "weights") {
        return Err(Refusal::NoNetworks);
    }
    let &Picture { columns, rows, pixel_aspect, values, .. } = picture;
    let is_filled = columns.checked_mul(rows) == Some(values.len());
    let is_shaped = pixel_aspect.is_finite() && (0.1..=10.0).contains(&pixel_aspect);
    if columns.min(rows) < MIN_SIDE_PX || !is_filled || !is_shaped {
        return Err(Refusal::NoFilm { columns, rows });
    }
    let coarse = coarse_input(picture);
    let peaks = peaks_of(&weights::film(coarse.grid.clone()));
    // A crest beyond the picture is a mistake.
    let crests = crests.filter(|both| picture.holds(both.left) && picture.holds(both.right));
    let crests = crests.map(|both| {
        let [left, right] = [both.left, both.right].map(|crest| coarse.cell(crest));
        [0, 1].map(|axis| f64::midpoint(left[axis], right[axis]))
    });
    let chain = chain_of(&peaks, crests).ok_or(Refusal::NoSpine { vertebrae: 0 })?;
    let seen = chain.peaks.iter().filter(|peak| peak.is_seen).map(|peak| peak.probability);
    let count = seen.clone().count();
    let is_weak = seen.sum::<f64>() < MIN_MEAN_PROBABILITY * count as f64;
    let last_level = chain.first_level + chain.peaks.len() - 1;
    if count < MIN_VERTEBRAE || is_weak || last_level < MIN_LAST_LEVEL {
        return Err(Refusal::NoSpine { vertebrae: count });
    }
    let mut vertebrae = placed(picture, &coarse, &chain);
    vertebrae.reverse();
    let found = vertebrae.len();
    vertebrae.retain(|one| one.corners.points().into_iter().all(|corner| picture.holds(corner)));
    let beyond_edge = found - vertebrae.len();
    Ok(Detection { vertebrae, count: chain.count, beyond_edge })
}

/// The vertebrae of a chain with the corners that the second network places.
fn placed(picture: &Picture<'_>, coarse: &grid::Coarse, chain: &Chain) -> Vec<DetectedVertebra> {
    let centres: Vec<Pixel> = chain.peaks.iter().map(|peak| coarse.place(peak.centre)).collect();
    let bodies = chain.peaks.iter().zip(bodies_at(picture, &centres)).zip(chain.first_level..);
    bodies
        .map(|((peak, SeenBody { corners, sd_share }), level)| {
            let doubt = (sd_share / CONFIDENCE_SD_SHARE).powi(2);
            DetectedVertebra {
                level: Level::ALL[Level::ALL.len() - 1 - level],
                corners,
                sd_share,
                confidence: peak.probability * (-doubt).exp(),
                is_seen: peak.is_seen,
                votes: std::array::from_fn(|vote| peak.levels[peaks::LEVELS - 1 - vote]),
            }
        })
        .collect()
}

/// The corners of neighbouring vertebrae with these centres, cranial first, as the second network sees them; empty for fewer than
/// two centres.
///
/// # Panics
/// If the values of the picture do not fill it.
#[must_use]
pub fn bodies_at(picture: &Picture<'_>, centres: &[Pixel]) -> Vec<SeenBody> {
    if !cfg!(feature = "weights") || centres.len() < 2 {
        return Vec::new();
    }
    let fine = Grid::reduced(picture, FINE);
    let scale =
        [fine.columns as f64 / picture.columns as f64, fine.rows as f64 / picture.rows as f64];
    // The centre of the first pixel is at zero.
    let cell =
        |centre: &Pixel| [(centre.column_px + 0.5) * scale[0], (centre.row_px + 0.5) * scale[1]];
    let centres: Vec<[f64; 2]> = centres.iter().map(cell).collect();
    let pixel = |place: [f64; 2]| Pixel::new(place[0] / scale[0] - 0.5, place[1] / scale[1] - 0.5);
    let bodies = patches::corners(&fine, &centres).into_iter();
    bodies
        .map(|body| SeenBody {
            corners: Corners::from_image_sides(body.corners.map(pixel), picture.patient_left),
            sd_share: body.sd / body.height(),
        })
        .collect()
}
