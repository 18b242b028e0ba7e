//! Soft tissue: trunk, lungs with their vessels, heart, liver, windpipe, and gas in stomach and bowel.

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use spineline::anatomy::Level;

use super::anatomy::{Anatomy, Profile};
use super::layer::{Layer, Patch, Point};
use super::skeleton::vessel;
use super::texture::rough;

/// Attenuation of water, per mm, at the energies of such films.
const WATER_PER_MM: f32 = 0.020;
/// Reduction of it by the air in the lungs.
const LUNG_AIR_PER_MM: f32 = 0.0145;

/// Soft tissue on one grid.
pub(super) fn draw(anatomy: &Anatomy, seed: u64) -> Layer {
    let trunk = Trunk::new(anatomy, seed);
    let mut layer = anatomy.layer();
    layer.fill(|point| trunk.attenuation(point));
    for patch in trunk.vessels(&layer) {
        layer.add(&patch);
    }
    layer
}

/// Rises from zero to one around an edge, towards `inside`.
pub(super) fn soft_edge(inside_mm: f32, width_mm: f32) -> f32 {
    let t = (0.5 + inside_mm / (2.0 * width_mm)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

struct Trunk<'a> {
    anatomy: &'a Anatomy,
    seed: u32,
    half_width: Profile,
    thickness: Profile,
    chest: Profile,
    /// Tops of the right and the left dome of the diaphragm.
    domes: [f32; 2],
    apex: f32,
    heart: f32,
    gas: Vec<Bubble>,
}

/// Gas in the bowel: an ellipse.
struct Bubble {
    centre: Point,
    half: [f32; 2],
    strength: f32,
}

impl<'a> Trunk<'a> {
    fn new(anatomy: &'a Anatomy, seed: u64) -> Self {
        use Level::{L1, L2, L4, L5, T1, T3, T5, T6, T8, T10, T12};
        let height = |level| anatomy.height_of(level);
        let scale = anatomy.scale;
        Self {
            anatomy,
            seed: seed as u32,
            half_width: anatomy.profile(
                &[
                    (L5, 172.0),
                    (L4, 160.0),
                    (L2, 146.0),
                    (T12, 148.0),
                    (T8, 158.0),
                    (T5, 186.0),
                    (T3, 255.0),
                    (T1, 215.0),
                ],
                48.0,
                66.0,
            ),
            thickness: anatomy.profile(
                &[
                    (L5, 195.0),
                    (L4, 180.0),
                    (L1, 185.0),
                    (T10, 195.0),
                    (T6, 185.0),
                    (T3, 150.0),
                    (T1, 122.0),
                ],
                40.0,
                112.0,
            ),
            chest: anatomy.profile(
                &[
                    (T12, 122.0),
                    (T10, 122.0),
                    (T8, 120.0),
                    (T6, 114.0),
                    (T5, 107.0),
                    (T3, 80.0),
                    (T1, 38.0),
                ],
                20.0,
                20.0,
            ),
            domes: [height(T10) + 8.0 * scale, height(T10) - 4.0 * scale],
            apex: height(T1) - 6.0 * scale,
            heart: height(T8) - 4.0 * scale,
            gas: bubbles(anatomy, seed),
        }
    }

    fn attenuation(&self, point: Point) -> f32 {
        let [y, z] = point;
        let scale = self.anatomy.scale;
        let x = y - self.anatomy.middle_at(z);
        let q = (x / self.half_width.at(z)).abs();
        if q >= 1.0 {
            return 0.0;
        }
        let body = self.thickness.at(z) * (1.0 - q * q * q).sqrt();
        let (air, heart) = (self.air(x, z), self.heart(x, z));
        let lung = air * (1.0 - 0.78 * heart) * 0.72 * body * LUNG_AIR_PER_MM;
        let mottle = rough(y / 14.0, z / 14.0, 4, self.seed);
        let fine = rough(y / 4.0, z / 4.0, 3, self.seed ^ 5);
        let below = 1.0 - air;
        let clutter = below * 0.05 * mottle + (0.02 + 0.05 * air) * fine;
        // The liver is denser than the bowel beside it, the psoas muscles stand beside the lumbar spine.
        let dome = self.dome(x, z);
        let under = soft_edge(dome - z, 3.0 * scale)
            * soft_edge(z - self.anatomy.height_of(Level::L2), 45.0);
        let liver = 0.22 * under * soft_edge(10.0 * scale - x, 30.0 * scale);
        (WATER_PER_MM * body - lung + clutter + liver + self.middle_parts(x, z) - self.bowel(point))
            .max(0.0)
    }

    /// Height of the diaphragm below a place.
    fn dome(&self, x: f32, z: f32) -> f32 {
        let scale = self.anatomy.scale;
        let top = if x < 0.0 { self.domes[0] } else { self.domes[1] };
        let chest = self.chest.at(z);
        let aside = (x.abs() - 0.46 * chest) / (0.62 * chest);
        top - 38.0 * scale * aside * aside
    }

    /// Part of the beam's way that is lung.
    fn air(&self, x: f32, z: f32) -> f32 {
        let scale = self.anatomy.scale;
        let a = x.abs();
        let chest = self.chest.at(z);
        let wall = soft_edge(chest - a, 7.0 * scale);
        let up = ((z - self.heart) / (self.apex - self.heart).max(1.0)).clamp(-1.0, 1.0);
        let middle = (27.0 - 5.0 * up) * scale;
        let beside = soft_edge(a - middle, 13.0 * scale);
        let dome = self.dome(x, z);
        // Lung extends down behind the domes, so the edge has a fainter foot.
        let over = 0.86 * soft_edge(z - dome, 1.6 * scale)
            + 0.14 * soft_edge(z - dome + 42.0 * scale, 34.0 * scale);
        let roof = self.apex - 0.010 * (a - 34.0 * scale).powi(2) / scale;
        wall * (0.12 + 0.88 * beside) * over * soft_edge(roof - z, 7.0 * scale)
    }

    /// The heart's shadow, most of it on the left, and the aorta's knob above.
    fn heart(&self, x: f32, z: f32) -> f32 {
        let scale = self.anatomy.scale;
        let (dx, dz) = ((x - 22.0 * scale) / scale, (z - self.heart) / scale);
        // Its long axis falls to the left.
        let (along, across) = (0.80 * dx - 0.60 * dz, 0.60 * dx + 0.80 * dz);
        let heart = soft_edge(1.0 - (along / 56.0).hypot(across / 41.0), 0.09);
        let knob = [20.0 * scale, self.heart + 74.0 * scale];
        let aorta = soft_edge(1.0 - ((x - knob[0]).hypot(z - knob[1])) / (17.0 * scale), 0.16);
        heart.max(0.8 * aorta)
    }

    /// Windpipe, aorta and psoas.
    fn middle_parts(&self, x: f32, z: f32) -> f32 {
        let scale = self.anatomy.scale;
        let height = |level| self.anatomy.height_of(level);
        let pipe = soft_edge(8.0 * scale - x.abs(), 2.5) * soft_edge(z - height(Level::T5), 8.0);
        let down = soft_edge(height(Level::T4) - z, 10.0) * soft_edge(z - height(Level::T12), 30.0);
        let aorta = soft_edge(11.0 * scale - (x - 16.0 * scale).abs(), 3.0) * down;
        let fall = (height(Level::T12) - z).max(0.0);
        let spine = self.spine_at(z) - self.anatomy.middle_at(z);
        let muscle = (26.0 + 0.26 * fall / scale) * scale - (x - spine).abs();
        let psoas = soft_edge(muscle, 2.5) * soft_edge(height(Level::L1) - z, 30.0);
        0.22 * aorta + 0.16 * psoas - 0.30 * pipe
    }

    /// Place of the spine at a height.
    fn spine_at(&self, z: f32) -> f32 {
        let bodies = &self.anatomy.bodies;
        let above =
            bodies.partition_point(|b| (b.centre.z_mm as f32) < z).clamp(1, bodies.len() - 1);
        let [low, high] = [bodies[above - 1].centre, bodies[above].centre];
        let part = ((f64::from(z) - low.z_mm) / (high.z_mm - low.z_mm)).clamp(0.0, 1.0);
        (low.y_mm + part * (high.y_mm - low.y_mm)) as f32
    }

    fn bowel(&self, point: Point) -> f32 {
        // A bubble ends at 1.6 times its half axes. Most places are outside of all, so the wobble of the edges is not
        // computed there.
        let near = self.gas.iter().filter_map(|gas| {
            let x = (point[0] - gas.centre[0]) / gas.half[0];
            let z = (point[1] - gas.centre[1]) / gas.half[1];
            let inside = if x.abs().max(z.abs()) > 1.6 { -1.0 } else { 1.0 - x.hypot(z) };
            (inside >= -0.6).then_some((gas.strength, inside))
        });
        let mut wobble = None;
        near.fold(0.0, |most, (strength, inside)| {
            let wobble = *wobble.get_or_insert_with(|| {
                0.22 * rough(point[0] / 13.0, point[1] / 13.0, 2, self.seed ^ 9)
            });
            most.max(strength * soft_edge(inside + wobble, 0.16))
        })
    }

    /// Branching vessels from the roots of the lungs.
    fn vessels(&self, layer: &Layer) -> Vec<Patch> {
        let mut rng = ChaCha12Rng::seed_from_u64(u64::from(self.seed) ^ 0x5645_5353);
        let unit = Uniform::new(0.0_f32, 1.0).expect("zero is below one");
        let scale = self.anatomy.scale;
        let root = self.heart + 34.0 * scale;
        let mut patches = Vec::new();
        for side in [1.0_f32, -1.0] {
            for _ in 0..26 {
                // Fanned from upwards over outwards to downwards.
                let mut heading = (unit.sample(&mut rng) - 0.52) * 2.9;
                let (mut x, mut z) =
                    (side * 30.0 * scale, root + (unit.sample(&mut rng) - 0.5) * 26.0);
                let mut axis = Vec::new();
                for k in 0..14 {
                    let part = k as f32 / 14.0;
                    let radius = (2.6 * (1.0 - part) + 0.8) * scale;
                    axis.push(([self.anatomy.middle_at(z) + x, z], radius));
                    heading += (unit.sample(&mut rng) - 0.5) * 0.55;
                    x += side * 6.2 * scale * heading.cos();
                    z += 6.2 * scale * heading.sin();
                    if self.air(x, z) < 0.5 && k > 2 {
                        break;
                    }
                }
                let strength = 0.05 + 0.10 * unit.sample(&mut rng);
                patches.push(vessel(layer, &axis, strength));
            }
        }
        patches
    }
}

/// Gas: a bubble in the stomach, below the left dome, and some in the bowel.
fn bubbles(anatomy: &Anatomy, seed: u64) -> Vec<Bubble> {
    let mut rng = ChaCha12Rng::seed_from_u64(seed ^ 0x4741_5300);
    let unit = Uniform::new(0.0_f32, 1.0).expect("zero is below one");
    let scale = anatomy.scale;
    let at = |left: f32, z: f32| [anatomy.middle_at(z) + left * scale, z];
    let stomach = anatomy.height_of(Level::T11) - 8.0 * scale;
    let mut all = vec![Bubble {
        centre: at(68.0, stomach),
        half: [30.0 * scale, 15.0 * scale],
        strength: 0.55,
    }];
    let (top, base) = (anatomy.height_of(Level::L2), anatomy.height_of(Level::L5) - 20.0 * scale);
    for _ in 0..15 {
        let side = if unit.sample(&mut rng) < 0.5 { -1.0 } else { 1.0 };
        let left = side * (48.0 + 72.0 * unit.sample(&mut rng));
        let z = base + (top - base) * unit.sample(&mut rng);
        let half = (7.0 + 11.0 * unit.sample(&mut rng)) * scale;
        all.push(Bubble {
            centre: at(left, z),
            half: [half * (0.8 + 0.7 * unit.sample(&mut rng)), half],
            strength: 0.16 + 0.26 * unit.sample(&mut rng),
        });
    }
    all
}
