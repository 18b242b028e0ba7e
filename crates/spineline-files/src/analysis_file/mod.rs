//! The file of an analysis.

mod band;
mod comparison;
mod hypothesis;
mod identifiability;
mod model;
mod points;
mod posture;
mod space;
mod stored;
mod uncertainty;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::analysis::Analysis;
use spineline::anatomy::{Level, Posture};
use spineline::clinical::{Balance, ClinicalCurve, EndAngles};
use spineline::measure::LengthScale;
use spineline::personalize::Identifiability;
use spineline::spatial::Angle;

use crate::reliability_file::QuantityRecord;
use crate::{CaseFile, Provenance};
use comparison::ComparisonRecord;
pub(crate) use comparison::NumbersRecord;
use hypothesis::HypothesisRecord;
use identifiability::IdentifiabilityRecord;
use model::ModelRecord;
use points::{point_mm, point_px};
use posture::PostureRecord;
use space::{AxialRecord, SpaceRecord};
use spineline::uncertainty::Uncertainty;
use spineline::warning::{Step, Warning, WarningCode};
pub use stored::{StoredAnalysis, parse_analysis, parse_case_within, picture_warnings};
pub(crate) use uncertainty::NoiseRecord;
use uncertainty::UncertaintyRecord;

const FORMAT: &str = "spineline-analysis";
const VERSION: u32 = 1;

/// The result of an analysis, with all that is needed to repeat it. Lengths in mm of the films' plane, angles in degrees,
/// frontal points `[y, z]` with y
/// to the patient's left and z cranial; positive angles tilt to the patient's right.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(title = "Spineline analysis, version 1")]
pub struct AnalysisFile {
    format: String,
    version: u32,
    case_id: String,
    /// Whether the films, and so all results, are synthetic.
    synthetic: bool,
    /// Unit of the lengths of the erect film, its chain and its curves: mm in the patient, on the detector or in a plane that is not
    /// stated, or pixels.
    length_unit: String,
    /// Program, inputs, options and time.
    provenance: Provenance,
    chain: ChainRecord,
    /// The two inflections of the erect curve that carry the line; empty without such a pair.
    inflections: Vec<InflectionRecord>,
    /// Curves between inflections of the erect curve, caudal first.
    curves: Vec<TurnRecord>,
    clinical: ClinicalRecord,
    /// Where the spine's sagittal profile comes from: `measured` on the lateral film, or a `population`'s.
    sagittal_profile: String,
    /// The erect spine in space; absent without a lateral film.
    #[serde(skip_serializing_if = "Option::is_none")]
    space: Option<SpaceRecord>,
    /// Axial rotations of vertebrae whose pedicles are marked; absent without any, and then unknown.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    axial_rotation: BTreeMap<Level, AxialRecord>,
    postures: BTreeMap<Posture, PostureRecord>,
    /// Reliability of the readings, by quantity; `null` where every film was read once.
    reliability: Option<Vec<QuantityRecord>>,
    /// One model per line of action: `inflection_line`, `iliac_line`, `estimated_line`, `given_line`.
    models: BTreeMap<String, ModelRecord>,
    /// The lines on the same films, every bend left out once; `null` without a model.
    comparison: Option<ComparisonRecord>,
    /// Other loads and bases, such as `couple` or `inflection_line+free_base`; absent if not requested.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    hypotheses: BTreeMap<String, HypothesisRecord>,
    /// Uncertainty of every number from landmark noise; absent if not requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    uncertainty: Option<UncertaintyRecord>,
    warnings: Vec<WarningRecord>,
    /// The case itself, as it was read.
    case: CaseFile,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct ChainRecord {
    /// Number of segments on the erect curve: the paper's n.
    segments: usize,
    /// Length of a link: the paper's l; absent where films have no spacing.
    segment_mm: Option<f64>,
    /// Standard deviation from the scale of the erect film alone.
    segment_scale_sd_mm: Option<f64>,
    /// Segments by which the postures differ in sum.
    difference: u32,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct InflectionRecord {
    /// Segment of the chain, from 0.
    segment: usize,
    /// Vertebrae between which it lies, caudal first.
    between: [Level; 2],
    /// The vertebra at whose midpoint it was put by hand; absent for other inflections.
    #[serde(skip_serializing_if = "Option::is_none")]
    vertebra: Option<Level>,
    /// Absent where the erect film has no spacing.
    erect_mm: Option<[f64; 2]>,
    /// In pixels, where it has none.
    erect_px: Option<[f64; 2]>,
    /// 95 % interval along the erect curve, measured from the base (L4), by landmark noise and the unknown form of the curve. Absent
    /// where it reaches an end of the spine, where the erect film has no spacing, and where the inflections were picked by hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    interval_95_along_mm: Option<[f64; 2]>,
    /// The vertebrae between which that interval lies, caudal first.
    #[serde(skip_serializing_if = "Option::is_none")]
    interval_95_between: Option<[Level; 2]>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct TurnRecord {
    /// Positive where the spine turns to the patient's right as it rises.
    turn_deg: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct ClinicalRecord {
    /// Lenke's curve type as far as frontal films determine it.
    lenke_type: Option<u8>,
    /// Of the erect film; absent where its vertical is not known.
    balance: Option<BalanceRecord>,
    curves: BTreeMap<String, ClinicalCurveRecord>,
    /// The curve between the two vertebrae that turn most against each other, by the region of its apex, where the limits of `curves` are
    /// not inflections.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    whole_curve: BTreeMap<String, ClinicalCurveRecord>,
}

impl ClinicalRecord {
    fn new(analysis: &Analysis) -> Self {
        let movement = &analysis.movement;
        let (balance, scale) = (movement.balance.as_ref(), movement.scale());
        let curves = movement.clinical.iter();
        Self {
            lenke_type: movement.lenke.map(|lenke| lenke.number),
            balance: balance.map(|found| BalanceRecord::new(found, scale)),
            curves: curves.map(|curve| clinical_curve(curve, balance, scale)).collect(),
            // Balance has the translation of the regions' apices.
            whole_curve: movement
                .whole_curve
                .iter()
                .map(|curve| clinical_curve(curve, None, scale))
                .collect(),
        }
    }
}

/// The balance of the spine over the pelvis on the erect film. Distances are from the central sacral vertical line.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct BalanceRecord {
    /// Landmark that stands for the sacrum: `iliac_crests`, `l5` or `base`.
    reference: String,
    /// Vertebra from which the plumb line falls.
    plumb_level: Level,
    /// Positive to the patient's left.
    coronal_balance_mm: Option<f64>,
    coronal_balance_px: Option<f64>,
    /// Of the superior endplate against the horizontal, positive where its normal is tilted to the patient's right.
    t1_tilt_deg: Option<f64>,
    l4_tilt_deg: Option<f64>,
    /// Positive where the patient's left iliac crest is higher.
    pelvic_obliquity_deg: Option<f64>,
    stable_vertebra: Level,
}

impl BalanceRecord {
    fn new(balance: &Balance, scale: &LengthScale) -> Self {
        Self {
            reference: balance.reference.key().to_owned(),
            plumb_level: balance.plumb_level,
            coronal_balance_mm: scale.mm(balance.coronal_balance_mm),
            coronal_balance_px: scale.px(balance.coronal_balance_mm),
            t1_tilt_deg: balance.t1_tilt.map(Angle::deg),
            l4_tilt_deg: balance.l4_tilt.map(Angle::deg),
            pelvic_obliquity_deg: balance.pelvic_obliquity.map(Angle::deg),
            stable_vertebra: balance.stable,
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct ClinicalCurveRecord {
    /// Lower and upper end vertebra on the erect film.
    ends: [Level; 2],
    apex: Level,
    /// The patient's side to which the erect curve is convex.
    convex: Option<String>,
    /// Superior endplate of the upper against the inferior endplate of the lower end vertebra; films without corners have none.
    cobb_deg: BTreeMap<Posture, f64>,
    /// Tilt of the upper minus tilt of the lower end vertebra.
    tilt_range_deg: BTreeMap<Posture, f64>,
    ferguson_deg: BTreeMap<Posture, f64>,
    /// Distance of the apex from the central sacral vertical line, positive to the patient's left; absent where the erect film
    /// has no spacing or no known vertical.
    apical_translation_mm: Option<f64>,
    /// Standard deviation from the scale of the erect film alone.
    apical_translation_scale_sd_mm: Option<f64>,
    /// In pixels, where it has none.
    apical_translation_px: Option<f64>,
    /// Part of the erect Cobb angle, or of the tilt range without one, that the bend to the convex side corrects.
    flexibility: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct WarningRecord {
    code: WarningCode,
    step: Step,
    posture: Option<Posture>,
    level: Option<Level>,
    message: String,
}

impl WarningRecord {
    fn new(warning: &Warning) -> Self {
        Self {
            code: warning.code,
            step: warning.code.step(),
            posture: warning.posture,
            level: warning.level,
            message: warning.text(),
        }
    }
}

impl AnalysisFile {
    /// The file of an analysis of a case, with its provenance.
    #[must_use]
    pub fn new(analysis: &Analysis, case: CaseFile, provenance: Provenance) -> Self {
        let movement = &analysis.movement;
        let scale = movement.scale();
        let bands = analysis.bands();
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            case_id: analysis.case_id.clone(),
            synthetic: analysis.synthetic,
            length_unit: scale.plane.unit().to_owned(),
            provenance,
            chain: ChainRecord {
                segments: movement.chain.segments,
                segment_mm: scale.mm(movement.chain.segment_mm),
                segment_scale_sd_mm: scale.sd_mm(movement.chain.segment_mm),
                difference: movement.chain.difference,
            },
            inflections: inflections(analysis),
            curves: movement
                .inflections
                .curves
                .iter()
                .map(|part| TurnRecord { turn_deg: part.turn.deg() })
                .collect(),
            clinical: ClinicalRecord::new(analysis),
            sagittal_profile: if movement.space.is_some() { "measured" } else { "population" }
                .to_owned(),
            space: SpaceRecord::new(analysis),
            axial_rotation: movement.axial.iter().map(AxialRecord::new).collect(),
            postures: movement
                .films
                .iter()
                .map(|p| (p.outline.posture, PostureRecord::new(p, scale)))
                .collect(),
            reliability: Some(analysis.reliability())
                .filter(|found| !found.is_empty())
                .map(|found| found.iter().map(QuantityRecord::new).collect()),
            models: analysis
                .models
                .iter()
                .map(|m| (m.kind.key().to_owned(), ModelRecord::new(m, analysis)))
                .collect(),
            comparison: ComparisonRecord::new(analysis),
            hypotheses: analysis
                .hypotheses
                .iter()
                .zip(&bands.hypotheses)
                .map(|(fit, bands)| {
                    let record = HypothesisRecord::new(fit, bands, analysis.movement.levels());
                    (fit.hypothesis.key(), record)
                })
                .collect(),
            uncertainty: None,
            warnings: analysis.all_warnings().map(WarningRecord::new).collect(),
            case,
        }
    }

    /// The same file with the uncertainty of its numbers, where it was requested.
    #[must_use]
    pub fn with_uncertainty(mut self, analysis: &Analysis, found: Option<&Uncertainty>) -> Self {
        self.uncertainty = found.map(|found| UncertaintyRecord::new(found, analysis));
        self
    }

    /// The same file with the identifiability of every model's multipliers, in the order of the analysis' models, where it was requested.
    #[must_use]
    pub fn with_identifiability(
        mut self,
        analysis: &Analysis,
        found: Option<&[Option<Identifiability>]>,
    ) -> Self {
        for (model, found) in analysis.models.iter().zip(found.unwrap_or_default()) {
            if let Some(record) = self.models.get_mut(model.kind.key()) {
                record.identifiability =
                    found.as_ref().map(|found| IdentifiabilityRecord::new(found, &model.groups));
            }
        }
        self
    }
}

fn inflections(analysis: &Analysis) -> Vec<InflectionRecord> {
    let movement = &analysis.movement;
    let scale = movement.scale();
    let pairs = movement
        .inflections
        .pair
        .iter()
        .flatten()
        .zip(movement.inflection_segments.iter().flatten());
    let intervals = movement.inflection_intervals.map_or([None; 2], |found| found.each);
    pairs
        .zip(intervals)
        .map(|((inflection, &segment), interval)| InflectionRecord {
            segment,
            between: [inflection.between.0, inflection.between.1],
            vertebra: inflection.vertebra,
            erect_mm: point_mm(scale, inflection.erect),
            erect_px: point_px(scale, inflection.erect),
            interval_95_along_mm: interval.and_then(|found| {
                let [from, to] = found.along_mm.map(|mm| scale.mm(mm));
                Some([from?, to?])
            }),
            interval_95_between: interval.map(|found| [found.between.0, found.between.1]),
        })
        .collect()
}

fn clinical_curve(
    curve: &ClinicalCurve,
    balance: Option<&Balance>,
    scale: &LengthScale,
) -> (String, ClinicalCurveRecord) {
    let translation_mm = balance.map(|found| found.apical_translation_mm[curve.region.index()]);
    let angles = |all: &[(Posture, Angle)]| {
        all.iter().map(|(posture, angle)| (*posture, angle.deg())).collect()
    };
    let ends = |pick: &dyn Fn(&EndAngles) -> Option<Angle>| {
        let known = curve.angles.iter().filter_map(|(posture, all)| Some((posture, pick(all)?)));
        known.map(|(posture, angle)| (*posture, angle.deg())).collect()
    };
    let record = ClinicalCurveRecord {
        ends: [curve.ends.inferior, curve.ends.superior],
        apex: curve.apex,
        convex: curve.convex.map(|side| side.to_string()),
        cobb_deg: ends(&|angles| angles.cobb),
        tilt_range_deg: ends(&|angles| Some(angles.tilt_range)),
        ferguson_deg: angles(&curve.ferguson),
        apical_translation_mm: translation_mm.and_then(|mm| scale.mm(mm)),
        apical_translation_scale_sd_mm: translation_mm.and_then(|mm| scale.sd_mm(mm.abs())),
        apical_translation_px: translation_mm.and_then(|mm| scale.px(mm)),
        flexibility: curve.flexibility,
    };
    (curve.region.key().to_owned(), record)
}
