//! The spacing of a film from the attributes of its file, without guesses.

use serde::{Deserialize, Serialize};
use spineline::measure::{Spacing, SpacingPlane, SpacingSource};
use spineline::number::fixed;

/// How Pixel Spacing was calibrated, if the file states it (DICOM 0028,0A02).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum CalibrationType {
    /// By the known geometry of the set-up, for some depth in the patient.
    Geometry,
    /// By an object of known size in the picture.
    Fiducial,
}

/// The attributes of a radiograph about its spacing. Pairs are `[row, column]` as DICOM writes them: the distance
/// between rows comes first.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpacingEvidence {
    /// Pixel Spacing (0028,0030).
    pub pixel_mm: Option<[f64; 2]>,
    /// Pixel Spacing Calibration Type (0028,0A02).
    pub calibration: Option<CalibrationType>,
    /// Imager Pixel Spacing (0018,1164), in the detector's plane.
    pub imager_mm: Option<[f64; 2]>,
    /// Estimated Radiographic Magnification Factor (0018,1114).
    pub magnification: Option<f64>,
    /// Distance Source to Detector (0018,1110).
    pub source_to_detector_mm: Option<f64>,
    /// Distance Source to Patient (0018,1111).
    pub source_to_patient_mm: Option<f64>,
    /// Nominal Scanned Pixel Spacing (0018,2010).
    pub scanned_mm: Option<[f64; 2]>,
    /// Height of a pixel over its width: Pixel Aspect Ratio (0028,0034), or the resolutions of a picture across and down.
    pub pixel_aspect: Option<f64>,
}

/// A remark on a film's spacing, and its consequence.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpacingRemark {
    /// An attribute with implausible values, such as zero; it is not used.
    #[error("{attribute} is {}\\{} mm, which is not a valid spacing; it is not used", values[0], values[1])]
    Unusable {
        /// Name of the attribute.
        attribute: &'static str,
        /// Its two values, row first; both the same for a single one.
        values: [f64; 2],
    },
    /// A magnification of 1 or less, or above 2; it is not used.
    #[error("the magnification {} is {}, and should be above 1 and at most 2; it is not used", if *stated { "stated" } else { "from the distances" }, fixed(*value, 3))]
    Magnification {
        /// The value.
        value: f64,
        /// Whether it was stated; else it follows from the distances.
        stated: bool,
    },
    /// The stated magnification and the distances contradict one another; neither is used.
    #[error("the stated magnification {} and the one from the distances {} disagree; both are ignored", fixed(*stated, 3), fixed(*by_distances, 3))]
    MagnificationsDisagree {
        /// As stated.
        stated: f64,
        /// The magnification by the distances.
        by_distances: f64,
    },
    /// Calibrated Pixel Spacing differs from the result of Imager Pixel Spacing and magnification; the calibrated one
    /// is used.
    #[error("the calibrated Pixel Spacing is {} times what Imager Pixel Spacing and magnification give; the calibrated one is used", fixed(*ratio, 3))]
    SpacingsDisagree {
        /// Calibrated over computed.
        ratio: f64,
    },
    /// Pixel Spacing equals Imager Pixel Spacing although it claims to be calibrated: it is taken as calibrated.
    #[error(
        "Pixel Spacing is labelled as calibrated but equals Imager Pixel Spacing: no magnification was corrected"
    )]
    CalibratedAsImager,
    /// Pixel Spacing differs from Imager Pixel Spacing without a calibration type: source and purpose of the correction
    /// are unknown.
    #[error("Pixel Spacing is Imager Pixel Spacing divided by {}, without a stated reason", fixed(*magnification, 3))]
    CorrectionNotStated {
        /// Imager over pixel spacing, the magnification that was corrected.
        magnification: f64,
    },
    /// The distances reach to the table or support, not to the spine: the correction by them is too small.
    #[error(
        "the distances reach to the table or support, not to the spine: lengths are still a few percent larger than the patient's"
    )]
    SupportNotSpine,
    /// Pixel Spacing without a calibration type differs from the spacing that is used.
    #[error("Pixel Spacing has no calibration type, is {} times the spacing that is used, and is not used", fixed(*ratio, 3))]
    PixelSpacingPassedOver {
        /// Pixel Spacing over the spacing that is used.
        ratio: f64,
    },
    /// Pixel Spacing alone: for a projection it may be the detector's or the patient's.
    #[error(
        "Pixel Spacing has no calibration type: its millimetres may be the detector's or the patient's"
    )]
    PlaneNotStated,
    /// Lengths are the detector's, larger than the patient's by an unknown magnification.
    #[error(
        "lengths are the detector's: larger than the patient's by a magnification that is not stated (usually 5 to 15 %)"
    )]
    DetectorPlane,
    /// Lengths are measured on the scanned film.
    #[error("lengths are measured on the scanned film and are not the patient's")]
    ScannedFilm,
    /// Pixels are not square; this is allowed, and rare.
    #[error("pixels are not square: {} times as high as wide", fixed(*aspect, 3))]
    NotSquare {
        /// Height over width.
        aspect: f64,
    },
    /// The shape of a pixel is stated in two contradicting ways; the spacing decides.
    #[error("pixels are {} times as high as wide by the spacing, and {} times by {by}; angles depend on it", fixed(*by_spacing, 3), fixed(*stated, 3))]
    AspectsDisagree {
        /// Height over width, by the spacing.
        by_spacing: f64,
        /// Height over width, by the other statement.
        stated: f64,
        /// Name of the other statement.
        by: &'static str,
    },
    /// Only the shape of a pixel is usable.
    #[error("the file has no usable spacing, but pixels are stated to be {} times as high as wide: angles use this shape, and lengths are in pixels", fixed(*aspect, 3))]
    AspectAlone {
        /// Height over width.
        aspect: f64,
    },
    /// An implausible shape of pixels; it is not used.
    #[error(
        "pixels are stated to be {aspect} times as high as wide, which is not plausible; it is not used"
    )]
    UnusableAspect {
        /// Height over width.
        aspect: f64,
    },
    /// The spacing is missing or not usable.
    #[error(
        "the file has no usable spacing: pixels are assumed square for angles, and lengths are in pixels"
    )]
    None,
}

/// The spacing that a file supports, with remarks.
#[derive(Debug, Clone, PartialEq)]
pub struct SpacingJudgement {
    /// The spacing; `None` for pixels without a shape.
    pub spacing: Option<Spacing>,
    /// The remarks.
    pub remarks: Vec<SpacingRemark>,
}

impl SpacingJudgement {
    /// The remark that only a person can answer: angles would be wrong without the shape of a pixel, and the file's
    /// values are implausible or contradictory.
    #[must_use]
    pub fn question(&self) -> Option<&SpacingRemark> {
        self.remarks.iter().find(|remark| match remark {
            SpacingRemark::AspectsDisagree { .. } => true,
            SpacingRemark::Unusable { .. } | SpacingRemark::UnusableAspect { .. } => {
                self.spacing.is_none()
            }
            _ => false,
        })
    }
}

/// Shapes of pixels that a film can have (assumption); scans at half the resolution in one direction have 2 or 0.5.
const ASPECTS: std::ops::RangeInclusive<f64> = 0.2..=5.0;

/// Magnifications that a radiograph of a trunk can have; calibration beads of six systems showed 0.98 to 1.49
/// [bioengineering-2025]; at 1 an object would lie in the detector, below 1 behind it.
fn is_magnification(value: f64) -> bool {
    value > 1.0 && value <= 2.0
}

/// Largest relative difference of agreeing values.
const AGREEMENT: f64 = 0.01;

/// Names of the attributes with a distance of rows and one of columns.
const PIXEL: &str = "Pixel Spacing";
const IMAGER: &str = "Imager Pixel Spacing";
const SCANNED: &str = "Nominal Scanned Pixel Spacing";

/// Judges the statements of a file about its spacing.
///
/// In this order: Pixel Spacing with a calibration type (patient); Imager Pixel Spacing reduced by the magnification
/// factor (patient) or by the distances (not stated: they reach to the support of the patient); Pixel Spacing that
/// differs from the imager's (not stated); Pixel Spacing equal to the imager's, or Imager Pixel Spacing alone
/// (detector); Pixel Spacing alone (not stated); Nominal Scanned Pixel Spacing (not stated); the shape of a pixel alone
/// (pixels). Values that are not positive and finite are ignored. A magnification keeps the shape of a pixel, so every
/// pair that is not used is compared with the spacing by its shape too.
///
/// # References
/// DICOM PS3.3, sections 10.7 and C.8.11; correction proposal 2380.
///
/// ```
/// use spineline::measure::SpacingPlane;
/// use spineline_marking::{SpacingEvidence, judge_spacing};
/// let evidence = SpacingEvidence {
///     imager_mm: Some([0.2, 0.1]), magnification: Some(1.25), ..Default::default()
/// };
/// let spacing = judge_spacing(&evidence).spacing.expect("both are there");
/// assert_eq!((spacing.row_mm, spacing.column_mm), (0.16, 0.08));
/// assert_eq!(spacing.plane, SpacingPlane::Patient);
/// ```
#[must_use]
pub fn judge_spacing(evidence: &SpacingEvidence) -> SpacingJudgement {
    let mut remarks = Vec::new();
    let pixel = usable(PIXEL, evidence.pixel_mm, &mut remarks);
    let imager = usable(IMAGER, evidence.imager_mm, &mut remarks);
    let scanned = usable(SCANNED, evidence.scanned_mm, &mut remarks);
    let magnification = magnification(evidence, &mut remarks);
    let spacing = if let Some((pixel, calibration)) = pixel.zip(evidence.calibration) {
        let source = match calibration {
            CalibrationType::Fiducial => SpacingSource::Fiducial,
            CalibrationType::Geometry => SpacingSource::Geometry,
        };
        let factor = magnification.map(|(factor, _)| factor);
        compare_with_imager(pixel, imager, factor, &mut remarks);
        Some((pixel, SpacingPlane::Patient, source))
    } else if let Some((imager, (factor, source))) = imager.zip(magnification) {
        let reduced = imager.map(|mm| mm / factor);
        if let Some(pixel) = pixel.filter(|pixel| !pixels_agree(pixel[1], reduced[1])) {
            let ratio = pixel[1] / reduced[1];
            remarks.push(SpacingRemark::PixelSpacingPassedOver { ratio });
        }
        let plane = if source == SpacingSource::Distances {
            remarks.push(SpacingRemark::SupportNotSpine);
            SpacingPlane::Unknown
        } else {
            SpacingPlane::Patient
        };
        Some((reduced, plane, source))
    } else if let Some((pixel, imager)) = pixel.zip(imager) {
        if pixels_agree(pixel[0], imager[0]) && pixels_agree(pixel[1], imager[1]) {
            remarks.push(SpacingRemark::DetectorPlane);
            Some((imager, SpacingPlane::Detector, SpacingSource::Imager))
        } else {
            let magnification = imager[1] / pixel[1];
            remarks.push(SpacingRemark::CorrectionNotStated { magnification });
            Some((pixel, SpacingPlane::Unknown, SpacingSource::Uncalibrated))
        }
    } else if let Some(imager) = imager {
        remarks.push(SpacingRemark::DetectorPlane);
        Some((imager, SpacingPlane::Detector, SpacingSource::Imager))
    } else if let Some(pixel) = pixel {
        remarks.push(SpacingRemark::PlaneNotStated);
        Some((pixel, SpacingPlane::Unknown, SpacingSource::PixelSpacing))
    } else if let Some(scanned) = scanned {
        remarks.push(SpacingRemark::ScannedFilm);
        Some((scanned, SpacingPlane::Unknown, SpacingSource::Scanned))
    } else {
        None
    };
    let spacing = spacing.map(|([row_mm, column_mm], plane, source)| Spacing {
        column_mm,
        row_mm,
        plane,
        source,
        relative_sd: None,
    });
    if let Some(spacing) = spacing.filter(|s| !pixels_agree(s.row_mm, s.column_mm)) {
        remarks.push(SpacingRemark::NotSquare { aspect: spacing.aspect() });
    }
    if let Some(spacing) = spacing {
        let pairs = [(PIXEL, pixel), (IMAGER, imager), (SCANNED, scanned)];
        compare_shapes(spacing.aspect(), pairs, &mut remarks);
    }
    let spacing = with_aspect(spacing, evidence.pixel_aspect, &mut remarks);
    SpacingJudgement { spacing, remarks }
}

/// The spacing with a separately stated shape of a pixel; without a spacing, the shape alone.
fn with_aspect(
    spacing: Option<Spacing>,
    stated: Option<f64>,
    remarks: &mut Vec<SpacingRemark>,
) -> Option<Spacing> {
    match (spacing, stated) {
        (spacing, Some(aspect)) if !ASPECTS.contains(&aspect) => {
            remarks.push(SpacingRemark::UnusableAspect { aspect });
            if spacing.is_none() {
                remarks.push(SpacingRemark::None);
            }
            spacing
        }
        (Some(spacing), Some(stated)) if !pixels_agree(spacing.aspect(), stated) => {
            let by_spacing = spacing.aspect();
            let by = "Pixel Aspect Ratio or by the resolutions";
            remarks.push(SpacingRemark::AspectsDisagree { by_spacing, stated, by });
            Some(spacing)
        }
        (None, Some(aspect)) => {
            remarks.push(SpacingRemark::AspectAlone { aspect });
            Some(Spacing::of_aspect(aspect, SpacingSource::PixelAspect))
        }
        (None, None) => {
            remarks.push(SpacingRemark::None);
            None
        }
        (spacing, _) => spacing,
    }
}

/// Remarks on every pair of distances with another shape of a pixel than the spacing has.
fn compare_shapes(
    by_spacing: f64,
    pairs: [(&'static str, Option<[f64; 2]>); 3],
    remarks: &mut Vec<SpacingRemark>,
) {
    for (by, pair) in pairs {
        let aspect = pair.map(|[row_mm, column_mm]| row_mm / column_mm);
        if let Some(stated) = aspect.filter(|aspect| !pixels_agree(by_spacing, *aspect)) {
            remarks.push(SpacingRemark::AspectsDisagree { by_spacing, stated, by });
        }
    }
}

/// Whether two sizes of a pixel, or two shapes, are equal within 1 %.
#[must_use]
pub fn pixels_agree(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() <= AGREEMENT
}

fn usable(
    attribute: &'static str,
    stated: Option<[f64; 2]>,
    remarks: &mut Vec<SpacingRemark>,
) -> Option<[f64; 2]> {
    let values = stated?;
    if values.into_iter().all(Spacing::is_possible) {
        return Some(values);
    }
    remarks.push(SpacingRemark::Unusable { attribute, values });
    None
}

/// The magnification to correct, if it is stated or follows from the distances, and is not contradicted.
fn magnification(
    evidence: &SpacingEvidence,
    remarks: &mut Vec<SpacingRemark>,
) -> Option<(f64, SpacingSource)> {
    let mut checked = |value: f64, stated: bool| {
        let good = is_magnification(value);
        if !good {
            remarks.push(SpacingRemark::Magnification { value, stated });
        }
        good.then_some(value)
    };
    let stated = evidence.magnification.and_then(|value| checked(value, true));
    let by_distances = evidence
        .source_to_detector_mm
        .zip(evidence.source_to_patient_mm)
        // Devices write zero for unknown distances.
        .filter(|(detector, patient)| *detector > 0.0 && *patient > 0.0)
        .and_then(|(detector, patient)| checked(detector / patient, false));
    match (stated, by_distances) {
        (Some(stated), Some(by_distances)) if (stated / by_distances - 1.0).abs() > 0.02 => {
            remarks.push(SpacingRemark::MagnificationsDisagree { stated, by_distances });
            None
        }
        (Some(stated), _) => Some((stated, SpacingSource::Magnification)),
        (None, Some(by_distances)) => Some((by_distances, SpacingSource::Distances)),
        (None, None) => None,
    }
}

fn compare_with_imager(
    pixel: [f64; 2],
    imager: Option<[f64; 2]>,
    magnification: Option<f64>,
    remarks: &mut Vec<SpacingRemark>,
) {
    let Some(imager) = imager else { return };
    if let Some(factor) = magnification {
        let ratio = pixel[1] * factor / imager[1];
        if (ratio - 1.0).abs() > 0.05 {
            remarks.push(SpacingRemark::SpacingsDisagree { ratio });
        }
    } else if pixels_agree(pixel[0], imager[0]) && pixels_agree(pixel[1], imager[1]) {
        remarks.push(SpacingRemark::CalibratedAsImager);
    }
}
