use super::{CurvePlaces, Regions, convex_side, ferguson_angle};
use crate::anatomy::{Level, Posture, Region, Side};
use crate::measure::Outline;
use crate::spatial::{Angle, Frontal};

/// The end vertebrae of a curve on the erect film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CobbEnds {
    /// Lower end vertebra.
    pub inferior: Level,
    /// Upper end vertebra.
    pub superior: Level,
}

/// One curve of the spine as clinicians describe it.
#[derive(Debug, Clone, PartialEq)]
pub struct ClinicalCurve {
    /// Region.
    pub region: Region,
    /// End vertebrae, chosen on the erect film as the most tilted ones of the region.
    pub ends: CobbEnds,
    /// Vertebra farthest from the line between the region's ends.
    pub apex: Level,
    /// The side to which the erect curve is convex; `None` where it does not turn.
    pub convex: Option<Side>,
    /// Cobb angle in every posture: how much the tilt grows from the lower to the upper end vertebra.
    pub cobb: Vec<(Posture, Angle)>,
    /// Ferguson angle in every posture.
    pub ferguson: Vec<(Posture, Angle)>,
    /// Distance of the apex from the line through L4 along its axis, on the erect film.
    pub apical_translation_mm: f64,
    /// Part of the erect Cobb angle that the bend to the convex side takes away; `None` without that film.
    pub flexibility: Option<f64>,
}

impl ClinicalCurve {
    /// Cobb angle of a posture.
    #[must_use]
    pub fn cobb_in(&self, posture: Posture) -> Option<Angle> {
        self.cobb.iter().find(|(p, _)| *p == posture).map(|(_, angle)| *angle)
    }

    /// Cobb angle on the film that bends to the convex side, in the direction of the erect curve.
    fn cobb_when_straightened(&self) -> Option<Angle> {
        let posture = match self.convex? {
            Side::Left => Posture::LeftBending,
            Side::Right => Posture::RightBending,
        };
        let erect = self.cobb_in(Posture::Erect)?;
        self.cobb_in(posture).map(|angle| angle * erect.rad().signum())
    }
}

/// Measures the curve of every region in every posture; the first outline is the erect one.
#[must_use]
pub fn measure_curves(regions: &Regions, outlines: &[&Outline]) -> Vec<ClinicalCurve> {
    let erect = outlines[0];
    let level = |i: usize| erect.vertebrae[i].level;
    regions
        .bounds
        .iter()
        .map(|bounds| {
            let tilts: Vec<Angle> = erect.vertebrae.iter().map(|v| v.tilt).collect();
            let places = CurvePlaces::choose(*bounds, &tilts);
            let [lower, upper] = places.cobb_ends;
            let cobb: Vec<_> = outlines
                .iter()
                .map(|o| (o.posture, o.vertebrae[upper].tilt - o.vertebrae[lower].tilt))
                .collect();
            let ferguson = outlines
                .iter()
                .map(|o| {
                    (o.posture, ferguson_angle(&o.locations().collect::<Vec<Frontal>>(), bounds))
                })
                .collect();
            let mut curve = ClinicalCurve {
                region: bounds.region,
                ends: CobbEnds { inferior: level(lower), superior: level(upper) },
                apex: level(bounds.apex),
                convex: convex_side(cobb[0].1),
                cobb,
                ferguson,
                apical_translation_mm: erect.vertebrae[bounds.apex].location.y_mm.abs(),
                flexibility: None,
            };
            let size = curve.cobb[0].1.abs().rad();
            curve.flexibility = curve
                .cobb_when_straightened()
                .filter(|_| size > Angle::from_deg(5.0).rad())
                .map(|bent| (size - bent.rad()) / size);
            curve
        })
        .collect()
}

/// The Lenke curve type, as far as frontal films show it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LenkeType {
    /// 1 to 6.
    pub number: u8,
}

/// Lenke's curve type from erect and bending Cobb angles.
///
/// A minor curve is structural when at least 25° remain on the bend to its convex side. Kyphosis, which may make a
/// curve structural too, the lumbar and the sagittal modifier need what these films do not show.
/// `None` where a bending film is missing, no curve reaches 10°, or the structural curves make no type.
///
/// # References
/// [lenke-2001].
#[must_use]
pub fn lenke_type(curves: &[ClinicalCurve]) -> Option<LenkeType> {
    const STRUCTURAL: Angle = Angle::from_deg(25.0);
    const SCOLIOSIS: Angle = Angle::from_deg(10.0);
    let [lumbar, main, proximal] = curves else { return None };
    let size = |curve: &ClinicalCurve| curve.cobb_in(Posture::Erect).map(Angle::abs);
    let stays = |curve: &ClinicalCurve| curve.cobb_when_straightened().map(|a| a >= STRUCTURAL);
    // The proximal thoracic curve is never the major one.
    let lumbar_is_major = size(lumbar)? > size(main)?;
    if size(lumbar)? < SCOLIOSIS && size(main)? < SCOLIOSIS {
        return None;
    }
    let lumbar_structural = lumbar_is_major || stays(lumbar)?;
    let main_structural = !lumbar_is_major || stays(main)?;
    let number = match (stays(proximal)?, main_structural, lumbar_structural) {
        (false, true, false) => 1,
        (true, true, false) => 2,
        (false, true, true) if !lumbar_is_major => 3,
        (true, true, true) => 4,
        (false, false, true) => 5,
        (false, true, true) => 6,
        _ => return None,
    };
    Some(LenkeType { number })
}
