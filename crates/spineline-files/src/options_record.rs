//! The options of an analysis in files, sufficient to repeat it.

use serde::{Deserialize, Serialize};
use spineline::action::{Application, LineOfAction};
use spineline::analysis::{AnalysisOptions, Grouping};
use spineline::anatomy::{Level, Posture, Region};
use spineline::clinical::{CobbEnds, EndChoice, EndRule};
use spineline::curve::{InflectionChoice, OrderRule, Site};
use spineline::hypothesis::Hypothesis;
use spineline::measure::{AmplitudeEnds, FilmLengthRule, TiltRule};
use spineline::multibody::Support;
use spineline::personalize::{FitTarget, Gauge, LogNormalPrior};
use spineline::spatial::{Angle, Frontal};

use crate::FileError;
use crate::rotation_prior_record::RotationPriorRecord;
use crate::stiffness_file::{StiffnessFile, degrees};

/// The options of an analysis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct OptionsRecord {
    /// From which landmarks tilts are measured.
    tilt: TiltRule,
    /// Between which vertebrae amplitudes are measured.
    amplitude: AmplitudeEnds,
    /// Standard deviation of a film's scale against the erect film, as a part of it, where the films do not state theirs;
    /// `null` where lengths are compared as marked.
    #[serde(deserialize_with = "Option::deserialize")]
    film_length_sd: Option<f64>,
    /// Where end vertebrae of Cobb angles are the most tilted ones.
    end_vertebrae: EndRule,
    /// End vertebrae picked by the user.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    given_end_vertebrae: Vec<GivenEndsRecord>,
    /// `leave_one_out`, `two_inflections`, `paper`, or an order.
    order_rule: OrderRuleKey,
    /// Picked by hand, caudal first; `null` where they come from the erect curve.
    #[serde(deserialize_with = "Option::deserialize")]
    inflections: Option<[SiteRecord; 2]>,
    /// Minimum angle of a curve between inflections of the erect curve, in degrees.
    min_curve_deg: f64,
    support: Support,
    /// Scale constraint of stiffness and force.
    gauge: GaugeKey,
    /// The force of the gauge `known_force`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    known_force: Option<KnownForceRecord>,
    fit: FitTarget,
    multipliers: Grouping,
    /// Standard deviation of `ln α` in the prior; `null` without a prior.
    #[serde(deserialize_with = "Option::deserialize")]
    prior_log_sd: Option<f64>,
    /// Distribution of joint rotations learned from other patients; absent for the published one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rotation_prior: Option<RotationPriorRecord>,
    /// Lines that the user gave.
    given_lines: Vec<GivenLineRecord>,
    /// Other requested loads and bases, such as `couple+free_base`.
    compared_models: Vec<HypothesisKey>,
    /// Springs before personalisation, each with its source.
    stiffness: StiffnessFile,
}

/// An order rule as one word.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(try_from = "String", into = "String")]
#[cfg_attr(test, schemars(with = "String"))]
struct OrderRuleKey(OrderRule);

impl TryFrom<String> for OrderRuleKey {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        Ok(Self(match text.as_str() {
            "leave_one_out" => OrderRule::LeaveOneOut,
            "paper" => OrderRule::Paper,
            "two_inflections" => OrderRule::TwoInflections,
            order => OrderRule::Fixed(order.parse().map_err(|_| {
                format!(
                    "`{text}` is neither `leave_one_out`, `two_inflections`, `paper`, nor an order"
                )
            })?),
        }))
    }
}

impl From<OrderRuleKey> for String {
    fn from(key: OrderRuleKey) -> Self {
        key.0.key()
    }
}

/// A load and a base as one word.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(try_from = "String", into = "String")]
#[cfg_attr(test, schemars(with = "String"))]
pub(crate) struct HypothesisKey(pub(crate) Hypothesis);

impl TryFrom<String> for HypothesisKey {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
            .map(Self)
            .map_err(|error: spineline::hypothesis::HypothesisNameError| error.to_string())
    }
}

impl From<HypothesisKey> for String {
    fn from(key: HypothesisKey) -> Self {
        key.0.key()
    }
}

/// A vertebra (twice the same), or the disc between two.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct SiteRecord {
    inferior: Level,
    superior: Level,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
enum GaugeKey {
    GeometricMean,
    KnownForce,
    FrozenForce,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct KnownForceRecord {
    posture: Posture,
    force_n: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct GivenLineRecord {
    posture: Posture,
    point_mm: [f64; 2],
    direction: [f64; 2],
    application: Application,
}

impl From<&AnalysisOptions> for OptionsRecord {
    fn from(options: &AnalysisOptions) -> Self {
        // Every option is in the file: a new one does not compile here until it is.
        let AnalysisOptions {
            tilt,
            amplitude,
            film_lengths,
            order_rule,
            inflections,
            min_curve,
            ends,
            library,
            support,
            gauge,
            target,
            grouping,
            prior,
            rotation_prior,
            given_lines,
            hypotheses,
        } = options;
        let site = |site: Site| SiteRecord { inferior: site.inferior, superior: site.superior };
        Self {
            tilt: *tilt,
            amplitude: *amplitude,
            film_length_sd: match *film_lengths {
                FilmLengthRule::PerFilm { relative_sd } => Some(relative_sd),
                FilmLengthRule::AsMarked => None,
            },
            end_vertebrae: ends.rule,
            given_end_vertebrae: given_ends(ends),
            order_rule: OrderRuleKey(*order_rule),
            inflections: match *inflections {
                InflectionChoice::Automatic => None,
                InflectionChoice::ByHand(sites) => Some(sites.map(site)),
            },
            min_curve_deg: degrees(*min_curve),
            support: *support,
            gauge: match *gauge {
                Gauge::GeometricMean => GaugeKey::GeometricMean,
                Gauge::KnownForce { .. } => GaugeKey::KnownForce,
                Gauge::FrozenForce => GaugeKey::FrozenForce,
            },
            known_force: match *gauge {
                Gauge::KnownForce { posture, force_n } => {
                    Some(KnownForceRecord { posture, force_n })
                }
                Gauge::GeometricMean | Gauge::FrozenForce => None,
            },
            fit: *target,
            multipliers: *grouping,
            prior_log_sd: prior.map(|prior| prior.log_sd),
            rotation_prior: rotation_prior.as_ref().and_then(RotationPriorRecord::new),
            given_lines: given_lines.iter().map(GivenLineRecord::from).collect(),
            compared_models: hypotheses.iter().map(|&one| HypothesisKey(one)).collect(),
            stiffness: StiffnessFile::from(library),
        }
    }
}

/// End vertebrae of one region.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct GivenEndsRecord {
    region: Region,
    /// Lower end vertebra.
    inferior: Level,
    /// Upper end vertebra.
    superior: Level,
}

fn given_ends(choice: &EndChoice) -> Vec<GivenEndsRecord> {
    let given = Region::ALL.into_iter().zip(choice.given);
    let record = |(region, ends): (Region, Option<CobbEnds>)| {
        let CobbEnds { inferior, superior } = ends?;
        Some(GivenEndsRecord { region, inferior, superior })
    };
    given.filter_map(record).collect()
}

impl OptionsRecord {
    fn ends(&self) -> EndChoice {
        let mut choice = EndChoice { rule: self.end_vertebrae, ..EndChoice::default() };
        for ends in &self.given_end_vertebrae {
            let given = CobbEnds { inferior: ends.inferior, superior: ends.superior };
            choice.given[ends.region.index()] = Some(given);
        }
        choice
    }

    /// The library's options.
    pub fn options(&self) -> Result<AnalysisOptions, FileError> {
        let site = |site: SiteRecord| Site { inferior: site.inferior, superior: site.superior };
        Ok(AnalysisOptions {
            tilt: self.tilt,
            amplitude: self.amplitude,
            film_lengths: match self.film_length_sd {
                Some(relative_sd) => FilmLengthRule::PerFilm { relative_sd },
                None => FilmLengthRule::AsMarked,
            },
            ends: self.ends(),
            order_rule: self.order_rule.0,
            inflections: self.inflections.map_or(InflectionChoice::Automatic, |sites| {
                InflectionChoice::ByHand(sites.map(site))
            }),
            min_curve: Angle::from_deg(self.min_curve_deg),
            library: self.stiffness.clone().library()?,
            support: self.support,
            gauge: match (self.gauge, self.known_force) {
                (GaugeKey::GeometricMean, _) => Gauge::GeometricMean,
                (GaugeKey::FrozenForce, _) => Gauge::FrozenForce,
                (GaugeKey::KnownForce, Some(known)) => {
                    Gauge::KnownForce { posture: known.posture, force_n: known.force_n }
                }
                (GaugeKey::KnownForce, None) => return Err(FileError::NoKnownForce),
            },
            target: self.fit,
            grouping: self.multipliers,
            prior: self.prior_log_sd.map(|log_sd| LogNormalPrior { log_sd }),
            rotation_prior: self
                .rotation_prior
                .as_ref()
                .map(RotationPriorRecord::prior)
                .transpose()?,
            given_lines: self.given_lines.iter().map(GivenLineRecord::line).collect(),
            hypotheses: self.compared_models.iter().map(|key| key.0).collect(),
        })
    }
}

impl From<&(Posture, LineOfAction)> for GivenLineRecord {
    fn from((posture, line): &(Posture, LineOfAction)) -> Self {
        Self {
            posture: *posture,
            point_mm: [line.point.y_mm, line.point.z_mm],
            direction: [line.direction.y_mm, line.direction.z_mm],
            application: line.application,
        }
    }
}

impl GivenLineRecord {
    fn line(&self) -> (Posture, LineOfAction) {
        let line = LineOfAction {
            point: Frontal::new(self.point_mm[0], self.point_mm[1]),
            direction: Frontal::new(self.direction[0], self.direction[1]),
            application: self.application,
        };
        (self.posture, line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method_text::all_others;

    #[test]
    fn every_option_of_the_method_is_in_the_file_and_read_from_it() {
        let options = all_others();
        let read = OptionsRecord::from(&options).options().expect("sound options");
        // The file has the direction of a line, and the text its angle.
        assert!(read == options, "an option is lost in the file");
    }
}
