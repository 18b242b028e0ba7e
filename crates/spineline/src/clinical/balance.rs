use super::{ClinicalCurve, Regions};
use crate::anatomy::named;
use crate::anatomy::{Level, Region};
use crate::measure::Outline;
use crate::spatial::{Angle, Frontal};

named! {
    /// Landmark for the centre of the sacrum, through which the central sacral vertical line runs.
    pub enum SacralReference {
        /// Middle of the tips of the iliac crests.
        IliacCrests = "iliac_crests" as "the middle of the iliac crests",
        /// Midpoint of L5.
        L5 = "l5" as "L5",
        /// Midpoint of the model's lowest vertebra, which is L4 where that was seen; nothing lower was marked.
        Base = "base" as "the lowest vertebra of the model",
    }
}

/// Balance of the spine over the pelvis on the erect film.
///
/// The vertical is the film's. The sacrum is not marked: the central sacral vertical line runs through the
/// [`SacralReference`]. C7 is not marked either: the plumb line falls from T1, or from T2.
///
/// # References
/// Definitions of [o-brien-2008].
#[derive(Debug, Clone, PartialEq)]
pub struct Balance {
    /// Through what the central sacral vertical line runs.
    pub reference: SacralReference,
    /// The vertebra from whose midpoint the plumb line falls.
    pub plumb_level: Level,
    /// Coronal balance: distance of the plumb line from the central sacral vertical line; positive to the patient's left.
    pub coronal_balance_mm: f64,
    /// Distance of every curve's apex from the central sacral vertical line, by region; positive to the patient's left.
    pub apical_translation_mm: [f64; 3],
    /// Tilt of T1's superior endplate against the horizontal; positive where its normal is tilted to the right. `None` without T1.
    pub t1_tilt: Option<Angle>,
    /// Tilt of L4's superior endplate against the horizontal.
    pub l4_tilt: Option<Angle>,
    /// Tilt of the iliac line against the horizontal; positive where the patient's left crest is higher.
    pub pelvic_obliquity: Option<Angle>,
    /// Stable vertebra: of those below the apex of the main thoracic curve, the one nearest to the central sacral vertical line.
    pub stable: Level,
}

impl Balance {
    /// What cannot be measured from these landmarks, and why.
    pub const MISSING: &'static str = "Not measured: trunk shift (no rib margins are marked), shoulder obliquity (no clavicles or acromia are marked), and neutral vertebrae (no pedicles are marked)";
}

/// The landmark for the centre of the sacrum on an erect film, and its place.
fn sacral_centre(erect: &Outline) -> (SacralReference, Frontal) {
    let l5 = || erect.others.iter().find(|vertebra| vertebra.level == Level::L5);
    erect
        .iliac_middle
        .map(|middle| (SacralReference::IliacCrests, middle))
        .or_else(|| l5().map(|l5| (SacralReference::L5, l5.location)))
        .unwrap_or((SacralReference::Base, erect.vertebrae[0].location))
}

/// The landmark for the centre of the sacrum on an erect film.
#[must_use]
pub fn sacral_reference(erect: &Outline) -> SacralReference {
    sacral_centre(erect).0
}

/// Distance of a point from the central sacral vertical line of an erect film, positive to the patient's left; `None` for a film
/// whose vertical is not known.
///
/// The pelvis is fixed to the base of a model, so that this measures shapes under loads too.
#[must_use]
pub fn sacral_line_offset_mm(erect: &Outline, point: Frontal) -> Option<f64> {
    let (_, sacral) = sacral_centre(erect);
    // In a frame whose third axis is the film's vertical.
    Some((point - sacral).rotated(-erect.vertical?).y_mm)
}

/// Measures the balance of an erect film; `None` for a film whose vertical is not known.
#[must_use]
pub fn measure_balance(
    erect: &Outline,
    regions: &Regions,
    curves: &[ClinicalCurve],
) -> Option<Balance> {
    let vertical = erect.vertical?;
    let (reference, _) = sacral_centre(erect);
    let left_mm = |point: Frontal| sacral_line_offset_mm(erect, point);
    let t1 = erect.others.iter().find(|vertebra| vertebra.level == Level::T1);
    let top = t1.or(erect.vertebrae.last())?;
    let superior = |level: Level| {
        let endplates = erect.vertebra(level)?.endplates?;
        Some((endplates.superior - vertical).wrapped())
    };
    let place = |level: Level| erect.vertebra(level).map(|vertebra| vertebra.location);
    let mut apical_translation_mm = [0.0; 3];
    for curve in curves {
        apical_translation_mm[curve.region.index()] = left_mm(place(curve.apex)?)?;
    }
    let apex = regions.bounds[Region::MainThoracic.index()].apex;
    let off_mm = |i: &usize| left_mm(erect.vertebrae[*i].location).map_or(f64::INFINITY, f64::abs);
    let stable = (0..apex).min_by(|a, b| off_mm(a).total_cmp(&off_mm(b)))?;
    Some(Balance {
        reference,
        plumb_level: top.level,
        coronal_balance_mm: left_mm(top.location)?,
        apical_translation_mm,
        t1_tilt: superior(Level::T1),
        l4_tilt: superior(Level::L4),
        // The normal is tilted to the right where the left crest is higher.
        pelvic_obliquity: erect.iliac_normal.map(|normal| (normal - vertical).wrapped()),
        stable: erect.vertebrae[stable].level,
    })
}
