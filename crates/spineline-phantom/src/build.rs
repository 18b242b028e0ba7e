//! Construction of synthetic spines: flexible parts, and variation of stiffness.

use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Normal, Uniform};
use spineline::anatomy::Level;
use spineline::multibody::StiffnessLibrary;

use crate::Scenario;

/// Segments of the fine chain.
pub(crate) const SEGMENTS: usize = 998;
const JOINTS: usize = Level::MODEL.len() - 1;

spineline::named! {
    /// Construction of a synthetic spine. Constructions differ in the erect curve, the flexible parts and the
    /// stiffness, so that a claim that holds on one can be tried on the others.
    #[default(Rod)]
    pub enum Construction {
        /// A continuous rod that bends everywhere. Its erect curve is a polynomial; its stiffness steps at the inflections.
        Rod = "rod",
        /// Rigid vertebrae and discs that bend evenly over their thickness. The curvature of the erect spine is three half sines;
        /// stiffness rises smoothly from the lumbar spine to the rib cage.
        Discs = "discs",
        /// Rigid vertebrae and hinges, at random heights within their discs. The curvature of the erect spine has three
        /// half-waves, each with its maximum at another place; stiffness follows a random walk from joint to joint.
        Hinges = "hinges",
        /// A continuous elastica whose stiffness is a smooth random field, without steps at inflections or regions. Its erect
        /// curvature is a random field that vanishes at two places.
        Elastica = "elastica",
        /// Rigid wedged bodies with hinges, each anywhere in its disc and 3 mm (standard deviation) beside the midline.
        /// Joints differ by 20 %.
        Wedges = "wedges",
        /// As `wedges`, with springs that stiffen: at 8° they carry twice the moment of a linear spring.
        Stiffening = "stiffening",
    }
}

impl Construction {
    /// Whether it has the statics of the module `column`.
    pub(crate) const fn is_column(self) -> bool {
        matches!(self, Self::Elastica | Self::Wedges | Self::Stiffening)
    }

    /// Whether a loading scenario can move it: only a rod takes prescribed rotations.
    #[must_use]
    pub const fn takes(self, scenario: Scenario) -> bool {
        use Scenario as S;
        match self {
            Self::Rod => true,
            Self::Discs | Self::Hinges => scenario.is_elastic(),
            Self::Elastica | Self::Wedges | Self::Stiffening => matches!(
                scenario,
                S::Rod | S::Pull | S::Weight | S::Couple | S::WeightAndCouple | S::Pads
            ),
        }
    }
}

/// Construction of a synthetic spine, and variation of its joints.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Build {
    /// Construction.
    pub construction: Construction,
    /// Standard deviation of the logarithm of each joint's stiffness about the value of its region or place.
    pub joint_log_sd: f64,
}

#[derive(Debug, Clone)]
pub(crate) struct Springs {
    /// Lateral stiffness of every joint over the nominal one: mean of logarithms per region, caudal first.
    pub multipliers: [f64; 3],
    /// For every segment of the fine chain; infinite for rigid segments.
    pub nmm_per_rad: Vec<f64>,
}

impl Springs {
    pub fn draw(
        build: &Build,
        vertebra_s_mm: &[f64],
        inflection_s_mm: [f64; 2],
        rng: &mut ChaCha12Rng,
    ) -> Self {
        let place = Place { vertebra_s_mm, inflection_s_mm };
        match build.construction {
            Construction::Rod => place.rod(build.joint_log_sd, rng),
            Construction::Discs => {
                let along = rising(rng);
                place.jointed(build.joint_log_sd, along, |disc, _| disc, rng)
            }
            Construction::Hinges => {
                let along = wandering(rng);
                let offset = Normal::new(0.0, 0.25).expect("a positive deviation");
                let hinge = |[from, to]: [f64; 2], rng: &mut ChaCha12Rng| {
                    let middle = 0.5 * (from + to) + offset.sample(rng) * (to - from);
                    [middle, middle]
                };
                place.jointed(build.joint_log_sd, along, hinge, rng)
            }
            Construction::Elastica | Construction::Wedges | Construction::Stiffening => {
                unreachable!("the module `column` draws them")
            }
        }
    }
}

/// Region of an arc length: caudal, middle or cranial of the inflections.
pub(crate) fn region(inflection_s_mm: [f64; 2], s_mm: f64) -> usize {
    inflection_s_mm.iter().filter(|&&end| s_mm > end).count()
}

/// Geometric means of multipliers over regions; a joint belongs to the region of its middle.
pub(crate) fn regional_means(
    joint_logs: &[f64],
    vertebra_s_mm: &[f64],
    inflection_s_mm: [f64; 2],
) -> [f64; 3] {
    let mut regions = [[0.0; 2]; 3];
    for (log, ends) in joint_logs.iter().zip(vertebra_s_mm.windows(2)) {
        let [sum, count] = &mut regions[region(inflection_s_mm, 0.5 * (ends[0] + ends[1]))];
        (*sum, *count) = (*sum + log, *count + 1.0);
    }
    regions.map(|[sum, count]| f64::exp(sum / f64::max(count, 1.0)))
}

/// Random factors on the joints' stiffness.
pub(crate) fn own_stiffness(log_sd: f64, rng: &mut ChaCha12Rng) -> [f64; JOINTS] {
    let spread = Normal::<f64>::new(0.0, log_sd).expect("a deviation");
    std::array::from_fn(|_| spread.sample(rng).exp())
}

/// Logarithm of stiffness by joint: it rises from the lumbar spine without ribs to three to five times the value above
/// T11, where all ribs meet the sternum, with a slow wave of random phase.
fn rising(rng: &mut ChaCha12Rng) -> [f64; JOINTS] {
    let ribs = Uniform::<f64>::new(3.0, 5.0).expect("3 is below 5").sample(rng).ln();
    let phase = Uniform::new(0.0, std::f64::consts::TAU).expect("a range").sample(rng);
    std::array::from_fn(|joint| {
        let wave = 0.2 * (std::f64::consts::TAU * joint as f64 / JOINTS as f64 + phase).sin();
        // Joint 4 is T12-T11.
        ribs / (1.0 + (-(joint as f64 - 4.0) / 1.5).exp()) + wave
    })
}

/// Logarithm of stiffness by joint: the same rise, with steps of a random walk.
fn wandering(rng: &mut ChaCha12Rng) -> [f64; JOINTS] {
    let mut log = rising(rng);
    let step = Normal::new(0.0, 0.1).expect("a positive deviation");
    let mut sum = 0.0;
    for own in &mut log {
        sum += step.sample(rng);
        *own += sum;
    }
    log
}

/// Positions of vertebrae and inflections on the fine chain.
struct Place<'a> {
    vertebra_s_mm: &'a [f64],
    inflection_s_mm: [f64; 2],
}

impl Place<'_> {
    fn segment_mm(&self) -> f64 {
        self.vertebra_s_mm[JOINTS] / SEGMENTS as f64
    }

    /// Spreads every joint's spring over the segments between its two vertebrae.
    fn rod(&self, joint_log_sd: f64, rng: &mut ChaCha12Rng) -> Springs {
        let spread = Normal::<f64>::new(0.0, 0.25).expect("a positive deviation");
        let stiff = Uniform::<f64>::new(3.0, 5.0).expect("3 is below 5");
        // Ribs make the main thoracic region three to five times as stiff as segments without them.
        let multipliers =
            [spread.sample(rng).exp(), stiff.sample(rng), 1.6 * spread.sample(rng).exp()];
        let own = own_stiffness(joint_log_sd, rng);
        let library = StiffnessLibrary::default();
        let segment_mm = self.segment_mm();
        let spring = |k: usize| {
            let s = k as f64 * segment_mm;
            let joint = self.vertebra_s_mm.partition_point(|&v| v <= s).clamp(1, JOINTS) - 1;
            let span = self.vertebra_s_mm[joint + 1] - self.vertebra_s_mm[joint];
            let nominal = library.rows()[joint].nmm_per_rad[0];
            let multiplier = multipliers[region(self.inflection_s_mm, s)] * own[joint];
            nominal * multiplier * span / segment_mm
        };
        Springs { multipliers, nmm_per_rad: (0..SEGMENTS).map(spring).collect() }
    }

    /// Puts every joint's spring where `flexible` states, by the ends of the disc.
    fn jointed(
        &self,
        joint_log_sd: f64,
        along: [f64; JOINTS],
        flexible: impl Fn([f64; 2], &mut ChaCha12Rng) -> [f64; 2],
        rng: &mut ChaCha12Rng,
    ) -> Springs {
        /// Thickness of a disc in parts of the distance of two vertebrae, from the lumbar spine to the upper thoracic
        /// spine.
        const DISC: [f64; 2] = [0.28, 0.16];
        let own = own_stiffness(joint_log_sd, rng);
        let library = StiffnessLibrary::default();
        let segment_mm = self.segment_mm();
        let mut nmm_per_rad = vec![f64::INFINITY; SEGMENTS];
        let mut joint_logs = [0.0; JOINTS];
        for joint in 0..JOINTS {
            let [low, high] = [joint, joint + 1].map(|v| self.vertebra_s_mm[v]);
            let part = joint as f64 / (JOINTS - 1) as f64;
            let half = 0.5 * (high - low) * (DISC[0] + part * (DISC[1] - DISC[0]));
            let middle = 0.5 * (low + high);
            let [from, to] = flexible([middle - half, middle + half], rng)
                .map(|s| ((s.clamp(low, high) / segment_mm).round() as usize).min(SEGMENTS - 1));
            let segments = to.max(from + 1) - from;
            let multiplier = along[joint].exp() * own[joint];
            joint_logs[joint] = multiplier.ln();
            let spring = library.rows()[joint].nmm_per_rad[0] * multiplier * segments as f64;
            nmm_per_rad[from..from + segments].fill(spring);
        }
        let multipliers = regional_means(&joint_logs, self.vertebra_s_mm, self.inflection_s_mm);
        Springs { multipliers, nmm_per_rad }
    }
}
