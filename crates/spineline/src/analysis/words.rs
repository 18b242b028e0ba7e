//! Texts that belong to the numbers of a model, shared by all front ends.

use std::fmt;

use super::{Analysis, LineModel, MultiplierEnding, MultiplierVerdict, Reference};
use crate::anatomy::Posture;
use crate::clinical::{ClinicalCurve, lenke_doubt};
use crate::curve::{Inflection, InflectionInterval};
use crate::evaluate::Simulation;
use crate::number::{self, fixed};
use crate::personalize::{FitStatus, Gauge, StiffnessBound};
use crate::warning::counted;

impl Analysis {
    /// The scale constraint, which fixes the overall level of stiffness and force.
    #[must_use]
    pub const fn gauge_words(&self) -> &'static str {
        match (self.options.gauge, self.options.reference) {
            (Gauge::GeometricMean, Reference::Unloaded) => {
                "only ratios are identified; their geometric mean is held at 1"
            }
            (Gauge::GeometricMean, Reference::Loaded { .. }) => {
                "the geometric mean is held at 1 (assumed); with a weight, the ratios depend on this level"
            }
            (Gauge::FrozenForce, _) => "forces fixed at their values with the nominal stiffness",
            (Gauge::KnownForce { .. }, _) => "scaled to the known force",
        }
    }

    /// Angles of the curves between inflections, and the inflections.
    #[must_use]
    pub fn inflection_words(&self) -> String {
        let movement = &self.movement;
        let curves: Vec<String> =
            movement.inflections.curves.iter().map(|l| l.turn.leaning()).collect();
        let turns = format!("Erect curve bends {}", curves.join(", "));
        let Some(pair) = &movement.inflections.pair else { return turns };
        let intervals = movement.inflection_intervals.as_ref();
        let places: Vec<String> = pair
            .iter()
            .enumerate()
            .map(|(i, inflection)| {
                let interval = intervals.map(|found| found.each[i].as_ref());
                self.inflection_place(inflection, interval)
            })
            .collect();
        let by = intervals.map_or(
            "",
            |_| " (95 % intervals by landmark noise and the unknown form of the curve)",
        );
        format!("{turns}\nInflections along the curve: {}{by}", places.join("; "))
    }

    /// How far along the curve from the base an inflection lies, and between which ends where the films limit it.
    fn inflection_place(
        &self,
        inflection: &Inflection,
        interval: Option<Option<&InflectionInterval>>,
    ) -> String {
        let scale = self.movement.scale();
        let along_mm = self.movement.erect().fit.curve.length_mm(inflection.t_mm);
        let base = self.movement.levels().base();
        let place = format!("{}, {} from {base}", inflection.place(), scale.text(along_mm, 0));
        match interval {
            None => place,
            Some(None) => format!("{place} (not limited)"),
            Some(Some(InflectionInterval {
                along_mm: [from, to],
                between: (below, above),
                ..
            })) => {
                let ends = [*from, *to].map(|mm| mm * scale.units_per_mm);
                let unit = if scale.has_millimetres() { "mm" } else { "px" };
                let ends = number::interval(ends, 0);
                format!("{place} ({ends} {unit}; between {below} and {above})")
            }
        }
    }

    /// The scale of every film against the erect one with its 95 % interval; `None` where all scales are fixed.
    #[must_use]
    pub fn film_scale_words(&self) -> Option<String> {
        let films: Vec<String> = self
            .movement
            .films
            .iter()
            .filter(|p| p.outline.length.is_free())
            .map(|p| {
                let scale = p.outline.length.scale;
                let [low, high] = scale.interval_95();
                format!(
                    "{} {} ({})",
                    p.outline.posture,
                    fixed(scale.factor, 3),
                    number::interval([low, high], 3)
                )
            })
            .collect();
        let words = || format!("Scales of the films against the erect film: {}", films.join(", "));
        (!films.is_empty()).then(words)
    }

    /// Lenke's type, or what is missing for it.
    #[must_use]
    pub fn lenke_words(&self) -> String {
        let movement = &self.movement;
        let mut missing = vec![Posture::LeftBending, Posture::RightBending];
        missing.retain(|&bend| movement.film(bend).is_none());
        let missing: Vec<_> = missing.iter().map(Posture::to_string).collect();
        match movement.lenke {
            Some(lenke) => format!(
                "Lenke type {} (by frontal films alone, no modifiers)",
                lenke.number
            ),
            None if !missing.is_empty() => {
                format!("No Lenke type: it needs the {} film", missing.join(" and "))
            }
            None if !movement.clinical.iter().all(ClinicalCurve::has_cobb) => {
                "No Lenke type: it needs Cobb angles, and the corners of the vertebrae are not known"
                    .to_owned()
            }
            None if movement.whole_curve.is_some() => {
                "No Lenke type: the erect curve does not have two inflections that separate three curves".to_owned()
            }
            None => lenke_doubt(&movement.clinical).map_or_else(
                || "No Lenke type: no curve reaches 10°, the structural curves match no type, or an end vertebra is unusual or missing on a bend".to_owned(),
                |curve| format!("No Lenke type: it depends on the {} curve, whose Cobb angle may be too small, because a vertebra beside its end is not marked", curve.region),
            ),
        }
    }

    /// The balance on the erect film, and the numbers that the landmarks do not give.
    #[must_use]
    pub fn balance_words(&self) -> String {
        let Some(balance) = &self.movement.balance else {
            return "No balance: the vertical of the erect film is not known".to_owned();
        };
        let beside = |mm: f64| {
            let scale = self.movement.scale();
            let size = scale.text(mm.abs(), 0);
            match fixed(scale.units_per_mm * mm, 0).as_str() {
                // A distance that rounds to zero has no side.
                "0" => format!("{size} from"),
                _ if mm < 0.0 => format!("{size} to the patient's right of"),
                _ => format!("{size} to the patient's left of"),
            }
        };
        let mut words = vec![format!(
            "Plumb line of {} {} the vertical line through {}",
            balance.plumb_level,
            beside(balance.coronal_balance_mm),
            balance.reference
        )];
        let tilts = [("T1", balance.t1_tilt), ("L4", balance.l4_tilt)];
        let known = tilts.into_iter().filter_map(|(level, tilt)| Some((level, tilt?)));
        words.extend(known.map(|(level, tilt)| format!("{level} tilt {}", tilt.leaning())));
        words.extend(balance.pelvic_obliquity.map(|tilt| match tilt.shown_side() {
            // The normal of the iliac line tilts away from the higher crest.
            Some(side) => {
                format!("pelvic obliquity {}, {} crest higher", tilt.abs(), side.opposite())
            }
            None => format!("pelvic obliquity {}", tilt.abs()),
        }));
        words.push(format!("stable vertebra {}", balance.stable));
        words.join("; ")
    }

    /// Where the sagittal shape comes from.
    #[must_use]
    pub const fn profile_words(&self) -> &'static str {
        if self.movement.space.is_some() {
            "sagittal profile of this patient, from the lateral and the erect film"
        } else {
            "sagittal profile from a population, not from this patient: no lateral film was measured"
        }
    }

    /// How a fit ended.
    #[must_use]
    pub fn fit_words(&self, model: &LineModel) -> String {
        let lost = model.simulations.iter().filter(|s| !s.is_usable()).count();
        let mut text = match model.fit.status {
            FitStatus::Converged => "fit converged".to_owned(),
            other => format!("fit NOT CONVERGED ({})", other.key().replace('_', " ")),
        };
        if lost > 0 {
            text.push_str(&format!(
                "; {lost} of {} without a result",
                counted(model.simulations.len(), "film")
            ));
        }
        text
    }

    /// A force along its line, with what its size means.
    #[must_use]
    pub fn force_words(&self, model: &LineModel, simulation: &Simulation) -> String {
        let size = simulation.force_n.abs();
        // A positive force runs along the line's direction.
        let along = simulation.line.direction * simulation.force_n.signum();
        let (way, upwards) =
            if along.z_mm < 0.0 { ("caudal", along * -1.0) } else { ("cranial", along) };
        let tilt = upwards.lateral_tilt().leaning();
        let way = format!("{way} along a line with a lateral tilt of {tilt}");
        if model.is_absolute(self.options.gauge) {
            format!("{} N, {way}", fixed(size, 0))
        } else {
            format!(
                "relative force {} (relative to the nominal stiffness, not newtons), {way}",
                fixed(size, 0)
            )
        }
    }

    /// Springs of a joint, by its place from the base, about its lateral, flexion and axial hinge: in N·m/rad where a force was
    /// measured, else relative to the nominal stiffness.
    ///
    /// # Panics
    /// If the joint does not exist.
    #[must_use]
    pub fn spring_words(&self, model: &LineModel, joint: usize) -> String {
        let springs = model.stiffness_nmm_per_rad(&self.movement.library)[joint];
        if model.is_absolute(self.options.gauge) {
            let [lateral, flexion, axial] = springs.map(|k| k / 1000.0);
            return format!(
                "lateral {}, flexion {}, axial {} N·m/rad (scaled to the known force)",
                fixed(lateral, 0),
                fixed(flexion, 0),
                fixed(axial, 0)
            );
        }
        let nominal = self.movement.library.rows()[joint].nmm_per_rad;
        let [lateral, flexion, axial] = [0, 1, 2].map(|axis| springs[axis] / nominal[axis]);
        let level = match self.options.reference {
            Reference::Unloaded => "only ratios are identified",
            Reference::Loaded { .. } => "the level is assumed",
        };
        format!(
            "lateral {}, flexion {}, axial {} of the nominal stiffness (no force was measured: {level})",
            fixed(lateral, 2),
            fixed(flexion, 2),
            fixed(axial, 2)
        )
    }
}

impl MultiplierEnding {
    /// Why it is not a value, in a few words; `None` for a value. [`MultiplierVerdict`] says it in a sentence.
    #[must_use]
    pub const fn refusal(self) -> Option<&'static str> {
        match self {
            Self::Absolute | Self::Ratio => None,
            Self::AtBound(_) => Some("no value: at its bound"),
            Self::OthersAtBounds => Some("no value: the others are at their bounds"),
            Self::Contradicted => Some("no value: most joints turn against the force"),
            Self::NotConverged => Some("no value: not converged"),
        }
    }
}

impl fmt::Display for MultiplierVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { ending, against, joints } = self;
        match ending {
            MultiplierEnding::Absolute => f.write_str("fitted, because a force is known"),
            MultiplierEnding::Ratio => {
                f.write_str("fitted as a ratio to the others: bending films do not measure force")
            }
            MultiplierEnding::OthersAtBounds => {
                f.write_str("no value: all others reached their limits, and these fix it")
            }
            MultiplierEnding::AtBound(bound) => {
                let better = if *bound == StiffnessBound::Lower { "softer" } else { "stiffer" };
                write!(
                    f,
                    "reached its limit: the data favour a {better} value, so it is not identified"
                )
            }
            MultiplierEnding::Contradicted => write!(
                f,
                "{against} of {joints} joints on the fitted films turn against the force: no positive stiffness explains them"
            ),
            MultiplierEnding::NotConverged => f.write_str("no value: the fit did not converge"),
        }
    }
}
