//! Random anatomy of a column: erect curve, bodies and springs.

use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Normal, StandardNormal, Uniform};
use spineline::anatomy::{Level, Morphometry};
use spineline::spatial::{Angle, Frontal, Mat3, Vec3};

use super::{Column, ElasticSample, Link, Place, Spring};
use crate::build::{Build, Construction, own_stiffness, regional_means};
use crate::{PhantomError, TableRow, erect, proportions};

/// Steps of the integration between two stations.
const STEPS: usize = 8;
/// Bending stiffness of a joint of the typical length, before it varies: 2 N·m per degree (assumption).
const NMM_PER_RAD: f64 = 115_000.0;

/// A drawn spine.
#[derive(Debug, Clone)]
pub(crate) struct Anatomy {
    /// Length of the erect curve from L4 to T2.
    pub length_mm: f64,
    pub column: Column,
    /// `ln` of every joint's stiffness at rest over the nominal one, caudal first.
    pub joint_logs: Vec<f64>,
    /// Their means over the regions between the erect inflections.
    pub multipliers: [f64; 3],
}

impl Anatomy {
    pub fn draw(
        row: &TableRow,
        build: &Build,
        rng: &mut ChaCha12Rng,
    ) -> Result<Self, PhantomError> {
        let turns_rad = erect::curve_turns_rad(row, rng);
        let curve = (0..20).find_map(|_| Curve::draw(turns_rad, rng));
        let curve = curve.ok_or(PhantomError::NoCurve { number: row.number })?;
        let length_mm = erect::draw_length_mm(rng);
        let vertebra_s_mm = erect::vertebra_s_mm(length_mm);
        let inflection_s_mm = curve.inflections.map(|part| part * length_mm);
        let place = Stations::new(&vertebra_s_mm, inflection_s_mm);
        let of_column = |column: Column, nmm_per_rad: Vec<f64>| {
            let joint_logs = erect::logs_over_nominal(nmm_per_rad.into_iter());
            let multipliers = regional_means(&joint_logs, &vertebra_s_mm, inflection_s_mm);
            Self { length_mm, column, joint_logs, multipliers }
        };
        let elastic = build.construction == Construction::Elastica;
        // Stiffness at a part of the length, against `NMM_PER_RAD`.
        let field = Field::draw(0.5, 0.2, rng);
        let own = own_stiffness(
            if elastic { build.joint_log_sd } else { build.joint_log_sd.hypot(0.2) },
            rng,
        );
        let ribs = Uniform::new(2.0, 4.0).expect("a range").sample(rng);
        let mean_mm = length_mm / own.len() as f64;
        let per_nmm2 = |joint: usize, part: f64| {
            (NMM_PER_RAD * mean_mm * own[joint] * field.at(part).exp()).recip()
        };
        let rod = place.elastica(&curve, length_mm, per_nmm2);
        if elastic {
            let stiffness = place.joint_stiffness(&rod);
            return Ok(of_column(rod, stiffness));
        }
        // Joint 4 is T12-T11, the lowest one whose ribs meet the sternum.
        let stiffness: Vec<f64> = (0..own.len())
            .map(|joint| NMM_PER_RAD * own[joint] * if joint < 4 { 1.0 } else { ribs })
            .collect();
        let stiffening_rad = match build.construction {
            Construction::Stiffening => Angle::from_deg(8.0).rad(),
            _ => f64::INFINITY,
        };
        let springs = |joint: usize| Spring { nmm_per_rad: stiffness[joint], stiffening_rad };
        let column = place.bodies(&rod, length_mm, springs, rng);
        Ok(of_column(column, stiffness))
    }
}

/// A smooth Gaussian random field with squared exponential covariance, by random cosines.
struct Field {
    size: f64,
    /// Frequency and phase.
    waves: [[f64; 2]; 24],
}

impl Field {
    /// `reach` is the distance, as a part of the length, over which values depend on each other.
    fn draw(sd: f64, reach: f64, rng: &mut ChaCha12Rng) -> Self {
        let phase = Uniform::new(0.0, std::f64::consts::TAU).expect("a range");
        let waves = std::array::from_fn(|_| {
            let unit: f64 = StandardNormal.sample(rng);
            [unit / reach, phase.sample(rng)]
        });
        Self { size: sd * (2.0 / 24.0_f64).sqrt(), waves }
    }

    fn at(&self, part: f64) -> f64 {
        self.size * self.waves.iter().map(|[rate, phase]| (rate * part + phase).cos()).sum::<f64>()
    }
}

/// Erect curvature over the length: `(x - p)(x - q) exp(a + b x + c x² + field)`, which vanishes at the two inflections
/// only.
struct Curve {
    inflections: [f64; 2],
    sizes: Vec3,
    field: Field,
}

impl Curve {
    /// A curve whose three parts turn by given angles, the first to the right; `None` if Newton's method does not find it.
    fn draw(turns_rad: [f64; 3], rng: &mut ChaCha12Rng) -> Option<Self> {
        let mut between =
            |low: f64, high: f64| Uniform::new(low, high).expect("a range upwards").sample(rng);
        let inflections = [between(0.26, 0.40), between(0.64, 0.78)];
        let mut curve =
            Self { inflections, sizes: Vec3::zeros(), field: Field::draw(0.3, 0.2, rng) };
        for _ in 0..50 {
            let mut rates = Mat3::zeros();
            let mut off = Vec3::zeros();
            for (region, turn_rad) in turns_rad.into_iter().enumerate() {
                let [sum, first, second] = curve.moments(region);
                off[region] = (turn_rad / sum.abs()).ln();
                rates.set_row(region, &Vec3::new(1.0, first / sum, second / sum).transpose());
            }
            if off.amax() < 1e-10 {
                return Some(curve);
            }
            curve.sizes += rates.lu().solve(&off)?;
        }
        None
    }

    fn at(&self, part: f64) -> f64 {
        let [p, q] = self.inflections;
        let size = self.sizes.dot(&Vec3::new(1.0, part, part * part)) + self.field.at(part);
        (part - p) * (part - q) * size.exp()
    }

    /// Integrals of the curvature times 1, x and x² over a region, by Simpson's rule.
    fn moments(&self, region: usize) -> [f64; 3] {
        const PIECES: usize = 100;
        let [p, q] = self.inflections;
        let ends = [0.0, p, q, 1.0];
        let step = (ends[region + 1] - ends[region]) / PIECES as f64;
        let mut sums = [0.0; 3];
        for i in 0..=PIECES {
            let part = ends[region] + i as f64 * step;
            let weight = match i {
                0 | PIECES => 1.0,
                _ if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let value = weight * step / 3.0 * self.at(part);
            for (power, sum) in sums.iter_mut().enumerate() {
                *sum += value * part.powi(power as i32);
            }
        }
        sums
    }
}

/// Arc lengths of vertebrae and inflections together.
struct Stations {
    s_mm: Vec<f64>,
    vertebrae: Vec<usize>,
    inflections: [usize; 2],
}

impl Stations {
    fn new(vertebra_s_mm: &[f64], inflection_s_mm: [f64; 2]) -> Self {
        let mut s_mm = [vertebra_s_mm, &inflection_s_mm].concat();
        s_mm.sort_by(f64::total_cmp);
        let station = |s: f64| s_mm.partition_point(|&other| other < s);
        Self {
            vertebrae: vertebra_s_mm.iter().map(|&s| station(s)).collect(),
            inflections: inflection_s_mm.map(station),
            s_mm,
        }
    }

    fn column(&self, links: Vec<Link>) -> Column {
        Column { links, vertebrae: self.vertebrae.clone(), inflections: self.inflections }
    }

    /// The joint to which the link above a station belongs.
    fn joint(&self, station: usize) -> usize {
        self.vertebrae.partition_point(|&v| v <= station) - 1
    }

    fn elastica(
        &self,
        curve: &Curve,
        length_mm: f64,
        per_nmm2: impl Fn(usize, f64) -> f64,
    ) -> Column {
        let link = |(station, ends): (usize, &[f64])| {
            let step_mm = (ends[1] - ends[0]) / (2 * STEPS) as f64;
            let sample = |i: usize| {
                let part = (ends[0] + i as f64 * step_mm) / length_mm;
                ElasticSample {
                    curvature_per_mm: curve.at(part) / length_mm,
                    per_nmm2: per_nmm2(self.joint(station), part),
                }
            };
            let samples = (0..=2 * STEPS).map(sample).collect();
            Link::Elastic { length_mm: ends[1] - ends[0], samples }
        };
        self.column(self.s_mm.windows(2).enumerate().map(link).collect())
    }

    /// Stiffness of every joint of an elastica: its compliance is the integral over its length, by Simpson's rule.
    fn joint_stiffness(&self, rod: &Column) -> Vec<f64> {
        let mut compliance = vec![0.0; self.vertebrae.len() - 1];
        for (station, link) in rod.links.iter().enumerate() {
            let Link::Elastic { length_mm, samples } = link else { continue };
            let thirds = samples.windows(3).step_by(2);
            let sum: f64 =
                thirds.map(|s| s[0].per_nmm2 + 4.0 * s[1].per_nmm2 + s[2].per_nmm2).sum();
            compliance[self.joint(station)] += sum * length_mm / (6 * STEPS) as f64;
        }
        compliance.into_iter().map(f64::recip).collect()
    }

    /// Rigid bodies with the erect places of an elastica. Each hinge lies anywhere between the endplates of its disc and
    /// 3 mm (standard deviation) beside the midline.
    fn bodies(
        &self,
        rod: &Column,
        length_mm: f64,
        spring: impl Fn(usize) -> Spring,
        rng: &mut ChaCha12Rng,
    ) -> Column {
        let places = rod.erect().places;
        let scale = proportions::body_scale(length_mm);
        let beside = Normal::new(0.0, 3.0).expect("a positive deviation");
        let within = Uniform::new(0.0, 1.0).expect("0 is below 1");
        let axis = |place: Place| Frontal::leaning(Angle::from_rad(place.tilt_rad));
        let half_mm = |v: usize| 0.5 * scale * Morphometry::of(Level::MODEL[v]).body_height_mm;
        let hinges: Vec<Frontal> = (1..self.vertebrae.len())
            .map(|upper| {
                let [low, high] = [upper - 1, upper].map(|v| places[self.vertebrae[v]]);
                let from = low.point + axis(low) * half_mm(upper - 1);
                let disc = high.point - axis(high) * half_mm(upper) - from;
                let across = Frontal::new(disc.z_mm, -disc.y_mm) * disc.norm_mm().recip();
                from + disc * within.sample(rng) + across * beside.sample(rng)
            })
            .collect();
        // The vertebra whose body holds a station.
        let body = |station: usize| {
            let s = self.s_mm[station];
            let off = |v: &usize| (self.s_mm[self.vertebrae[*v]] - s).abs();
            (0..self.vertebrae.len()).min_by(|a, b| off(a).total_cmp(&off(b))).expect("vertebrae")
        };
        let tilt_rad = |station: usize| places[self.vertebrae[body(station)]].tilt_rad;
        let link = |station: usize| {
            let [low, high] = [station, station + 1];
            let [from, to] = [low, high].map(|s| places[s].point);
            let in_body =
                |v: Frontal, station: usize| v.rotated(Angle::from_rad(-tilt_rad(station)));
            let turn_rad = tilt_rad(high) - tilt_rad(low);
            if body(low) == body(high) {
                return Link::Rigid { to_next: in_body(to - from, low), turn_rad };
            }
            let joint = body(low);
            let hinge = hinges[joint];
            Link::Hinge {
                to_hinge: in_body(hinge - from, low),
                to_next: in_body(to - hinge, high),
                turn_rad,
                spring: spring(joint),
            }
        };
        self.column((0..self.s_mm.len() - 1).map(link).collect())
    }
}
