//! The erect spine in space: frontal and lateral film together.

mod alignment;
mod heights;
mod marks;

pub use alignment::FilmAlignment;
pub use heights::{HeightLine, SharedHeights};

use nalgebra::DMatrix;

use super::bodies::crossing_sd;
use super::lateral::LateralVertebra;
use super::{Film, LateralFilm, LateralOutline, LengthScale, MeasureError, Noise, Outline};
use crate::anatomy::{Level, Levels, SagittalProfile};
use crate::number::{fixed, with_sd};
use crate::spatial::{Angle, Orientation, Vec3};
use crate::warning::{WarningCode, Warnings};
use alignment::{FrontalHeight, LateralSd};
use marks::{FrontalMark, frontal_marks};

/// One vertebra that the frontal and the lateral film show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpatialVertebra {
    /// Which one.
    pub level: Level,
    /// Midpoint from the lowest of these vertebrae, in the upright frame of the frontal film: anterior, left, cranial.
    pub place_mm: Vec3,
    /// How its axis stands in that frame; the axial rotation is zero because it is not known.
    pub orientation: Orientation,
    /// Angle of its axis from the vertical on the lateral film, with the film's turn taken out.
    pub lateral_pitch: Angle,
    /// Angles of the normals of its superior and inferior endplate there.
    pub endplates: [Angle; 2],
    /// Standard deviation of the tilt of the axis on the frontal film.
    pub tilt_sd: Angle,
    /// Standard deviation of the angle of the axis on the lateral film, without the deviation of the film's turn.
    pub lateral_sd: Angle,
    /// Standard deviation of the angle of an endplate there, likewise.
    pub endplate_sd: Angle,
    /// Standard deviations of the midpoint by the landmarks: to the front by the lateral film, to the left and upwards by the frontal one.
    pub place_sd_mm: Vec3,
}

/// The erect spine as far as both films show it.
///
/// # Definition
/// Tilt and pitch are the angles of the line through the centres of both endplates ([`Orientation`]). Endplates themselves look different
/// on an oblique view by how they are read: by the outline of their rim or by their middle line. The line through both centres does
/// not. Deviations follow from the deviations of landmarks and alignment by the delta method.
///
/// # Assumptions
/// The assumptions of [`FilmAlignment`]. Where nothing was read twice, a corner has the deviation of one careful reading
/// ([`Noise::ONE_READING`]).
///
/// # References
/// Why a lateral film misjudges the profile of a scoliotic spine: [hayashi-2009].
#[derive(Debug, Clone, PartialEq)]
pub struct SpatialOutline {
    /// The vertebrae on both films, caudal first; at least two.
    pub vertebrae: Vec<SpatialVertebra>,
    /// How the lateral film lies to the frontal one.
    pub alignment: FilmAlignment,
    /// Standard deviation of a coordinate of a corner on the lateral film, mean over its readings.
    pub corner_sd_mm: f64,
    /// Whether it was found from how readings differ; else it is an assumption.
    pub is_measured: bool,
}

impl SpatialOutline {
    /// The erect film and its outline with the lateral film; `None` where no two neighbouring vertebrae are marked on both.
    ///
    /// # Errors
    /// [`MeasureError`] names reading, vertebra and fault.
    pub fn measure(
        film: &Film,
        outline: &Outline,
        lateral: &LateralFilm,
        warnings: &mut Warnings,
    ) -> Result<Option<Self>, MeasureError> {
        let seen = lateral.measure(warnings)?;
        let found = Self::of(film, outline, &seen)?;
        let missing: Vec<String> = Levels::COMPLETE
            .joint_pairs()
            .filter(|[low, high]| found.as_ref().is_none_or(|f| !f.has(*low) || !f.has(*high)))
            .map(|[low, high]| format!("{low}/{high}"))
            .collect();
        let found = found.filter(|_| missing.len() < Levels::COMPLETE.joints());
        match &found {
            None => {
                let text = "the lateral film is not marked, or shows no two neighbouring vertebrae of the erect film: the sagittal profile comes from a population";
                warnings.push(WarningCode::LateralNotMarked, text);
            }
            Some(found) => {
                if !missing.is_empty() {
                    let text = format!(
                        "the lateral film does not show {}: the sagittal rotations there come from a population",
                        missing.join(", ")
                    );
                    warnings.push(WarningCode::LateralIncomplete, text);
                }
                found.warn_of_alignment(warnings);
            }
        }
        Ok(found)
    }

    /// As [`SpatialOutline::measure`], of a lateral film that was measured; with all vertebrae on both films.
    fn of(
        film: &Film,
        outline: &Outline,
        lateral: &LateralOutline,
    ) -> Result<Option<Self>, MeasureError> {
        let marks = frontal_marks(film, outline)?;
        let height = |level: Level| {
            let mark = marks.get(&level)?;
            Some(FrontalHeight { height: mark.location_mm.z_mm, sd: mark.location_sd_mm[1] })
        };
        let corner = LateralSd::of(lateral, Noise::ONE_READING.corner_mm());
        let has_scale = outline.scale.has_millimetres();
        let Some(alignment) = FilmAlignment::of(lateral, corner, has_scale, height) else {
            return Ok(None);
        };
        let corner_sd_mm = corner.on_frontal(alignment.scale);
        let both: Vec<(FrontalMark, LateralVertebra)> = lateral
            .vertebrae
            .iter()
            .filter_map(|side| Some((*marks.get(&side.level)?, *side)))
            .collect();
        let Some(origin) = both.first().copied() else { return Ok(None) };
        let vertebra = |(mark, side): &(FrontalMark, LateralVertebra)| {
            let lateral_pitch = side.pitch - alignment.turn;
            let ahead = alignment.from_film_mm(side.location, origin.1.location);
            let frontal = mark.location_mm - origin.0.location_mm;
            SpatialVertebra {
                level: side.level,
                place_mm: Vec3::new(ahead.y_mm, frontal.y_mm, frontal.z_mm),
                orientation: Orientation::of_axis(mark.axis_tilt, lateral_pitch),
                lateral_pitch,
                endplates: side.endplates.map(|angle| angle - alignment.turn),
                tilt_sd: mark.tilt_sd,
                lateral_sd: Angle::from_rad(corner_sd_mm / (alignment.scale * side.height)),
                // Both ends of it have an error.
                endplate_sd: Angle::from_rad(
                    corner_sd_mm * f64::sqrt(2.0) / (alignment.scale * side.depth),
                ),
                place_sd_mm: {
                    let [left, up] = mark.location_sd_mm;
                    let [ahead, _] = crossing_sd(corner_sd_mm, side.depth, side.height);
                    Vec3::new(ahead, left, up)
                },
            }
        };
        Ok(Some(Self {
            vertebrae: both.iter().map(vertebra).collect(),
            alignment,
            corner_sd_mm,
            is_measured: lateral.corner_sd.is_some(),
        }))
    }

    /// The vertebra of a level.
    #[must_use]
    pub fn vertebra(&self, level: Level) -> Option<&SpatialVertebra> {
        self.vertebrae.iter().find(|vertebra| vertebra.level == level)
    }

    fn has(&self, level: Level) -> bool {
        self.vertebra(level).is_some()
    }

    /// The sagittal turns of the joints between vertebrae that both films show: differences of their pitches in space. The other joints
    /// keep the turns of `template`.
    #[must_use]
    pub fn profile(&self, template: &SagittalProfile) -> SagittalProfile {
        let mut profile = template.clone();
        let joints = Levels::COMPLETE.joint_pairs();
        for ([low, high], turn_deg) in joints.zip(&mut profile.turns_deg) {
            if let Some((low, high)) = self.vertebra(low).zip(self.vertebra(high)) {
                *turn_deg = (high.orientation.pitch - low.orientation.pitch).wrapped().deg();
            }
        }
        profile
    }

    /// Covariance of the pitches in space, in rad², in the order of the vertebrae: landmarks move each by itself, the turn of the lateral
    /// film moves all.
    #[must_use]
    pub fn pitch_covariance(&self) -> DMatrix<f64> {
        let turn_variance = self.alignment.covariance[(1, 1)];
        let rates: Vec<[f64; 2]> =
            self.vertebrae.iter().map(|v| v.orientation.pitch_rates()).collect();
        DMatrix::from_fn(rates.len(), rates.len(), |i, j| {
            let shared = rates[i][1] * rates[j][1] * turn_variance;
            if i == j { shared + self.vertebrae[i].own_pitch_variance() } else { shared }
        })
    }

    /// Standard deviation of the pitch of a vertebra in space.
    #[must_use]
    pub fn pitch_sd(&self, vertebra: &SpatialVertebra) -> Angle {
        let [_, lateral] = vertebra.orientation.pitch_rates();
        let turn_variance = self.alignment.covariance[(1, 1)];
        Angle::from_rad((vertebra.own_pitch_variance() + lateral.powi(2) * turn_variance).sqrt())
    }

    /// Standard deviation of the direction of a vertebra's axis in space: root mean square of the angle between the measured and the
    /// true axis.
    #[must_use]
    pub fn axis_sd(&self, vertebra: &SpatialVertebra) -> Angle {
        // A change of tilt turns the axis about the anterior direction, a change of pitch square to that.
        let sideways = vertebra.orientation.pitch.rad().cos() * vertebra.tilt_sd.rad();
        Angle::from_rad(self.pitch_sd(vertebra).rad().hypot(sideways))
    }

    /// How the lateral film lies to the erect one, and what was assumed, in words; `scale` belongs to the erect film.
    #[must_use]
    pub fn alignment_words(&self, scale: &LengthScale) -> String {
        let found = &self.alignment;
        let source = if self.is_measured { "from repeated readings" } else { "assumed" };
        let corners = format!(
            "A corner on the lateral film has a standard deviation of {} ({source}).",
            scale.residual_text(self.corner_sd_mm)
        );
        let residual = scale.residual_text(found.residual_mm);
        if found.simultaneous {
            return format!(
                "Both films were exposed together: one vertical and one scale. Heights differ by {residual} (root mean square). {corners}"
            );
        }
        format!(
            "The lateral film was aligned to the erect one by the heights of {} vertebrae: scale {}, turn {} ± {}; heights then differ by {residual} (root mean square). Assumed: the erect film hangs upright, and the patient keeps the shape between the films. {corners}",
            found.vertebrae,
            with_sd(found.scale, found.scale * found.relative_scale_sd(), 3),
            found.turn,
            found.turn_sd()
        )
    }

    fn warn_of_alignment(&self, warnings: &mut Warnings) {
        let found = &self.alignment;
        let mut warn = |code, text: String| warnings.push(code, text);
        let least_mm = if found.simultaneous { TOGETHER_DIFFER_MM } else { HEIGHTS_DIFFER_MM };
        if found.residual_mm > least_mm.max(3.0 * found.expected_mm) {
            warn(
                WarningCode::LateralHeightsDiffer,
                format!(
                    "the heights of vertebrae on the lateral film differ from those on the erect film by {} mm (root mean square), and {} mm are expected from the landmarks: the patient moved between the films, or vertebrae are named differently on them; check both films",
                    fixed(found.residual_mm, 1),
                    fixed(found.expected_mm, 1)
                ),
            );
        }
        if found.turn.abs() > TURNED && found.turn.abs() > found.turn_sd() * 2.0 {
            warn(
                WarningCode::LateralTurned,
                format!(
                    "the lateral film is turned by {} ± {} against the erect film, by the heights of the vertebrae: the turn is taken out of all angles; check that both films hang upright",
                    found.turn.abs(),
                    found.turn_sd()
                ),
            );
        }
    }
}

/// Differences of height between two films of a patient who stood still, up to which nothing is said (assumption).
const HEIGHTS_DIFFER_MM: f64 = 3.0;
/// The same for films that were exposed together: the patient does not move between them (assumption).
const TOGETHER_DIFFER_MM: f64 = 1.0;
/// A turn between the films up to which nothing is said (assumption).
const TURNED: Angle = Angle::from_deg(3.0);

impl SpatialVertebra {
    /// Variance of the pitch in space by the landmarks of this vertebra.
    fn own_pitch_variance(&self) -> f64 {
        let [tilt, lateral] = self.orientation.pitch_rates();
        (tilt * self.tilt_sd.rad()).powi(2) + (lateral * self.lateral_sd.rad()).powi(2)
    }
}
