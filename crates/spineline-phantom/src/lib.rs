//! Synthetic spines with known true values, and the virtual observers who read their films.
//!
//! Real films of this protocol are not public, so the demonstration data are phantoms, and every result from one says
//! `synthetic`. The subjects follow Table 1 of the paper. The assumed loading scenario decides which line of action
//! predicts best, so there are several:
//!
//! - [`Scenario::Rod`]: an elastic rod of 998 planar segments, bent by a force through its own inflections, found
//!   self-consistently by continuation: the paper's hypothesis;
//! - [`Scenario::Bend`]: prescribed rotations of one sign at all levels, sized by published flexibility, vanishing at
//!   the inflections: the clinical bend;
//! - [`Scenario::Pull`]: the same rod under a horizontal force at T2, Petit's hypothesis; its traction is a cranial one;
//! - [`Scenario::Flatten`], [`Scenario::Offset`], [`Scenario::Spread`] and [`Scenario::Random`]: movements without a
//!   force through the inflections, as counter-examples.
//!
//! [`Scenario::LOADS`] bend the same rod by loads that no single line describes, or turn its base: for comparisons of loads.
//!
//! A [`Construction`] says how the spine is built. The constructions from [`Construction::Elastica`] on share neither
//! erect curve nor statics with the others.
//!
//! A [`TrueFilm`] is a posture on its film. The readers mark it, and [`Phantom::radiograph`] draws it, so that the two
//! agree to a part of a pixel.
//!
//! ```
//! use spineline_phantom::{Readers, Scenario, generate};
//! let phantom = generate(0, Scenario::Rod, &Readers::exact(), 1)?;
//! let analysis = spineline::analysis::analyze(&phantom.case, &Default::default())?;
//! assert!(analysis.synthetic && analysis.movement.inflections.all.len() == 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod build;
mod column;
mod counter;
mod erect;
mod error;
mod film;
mod film_lengths;
mod half_waves;
mod loads;
mod movement;
mod proportions;
mod radiograph;
mod readers;
mod rod;
mod scenario;
mod space;
mod subjects;
mod truth;

pub use build::{Build, Construction};
pub use error::PhantomError;
pub use film::{Polarity, TrueFilm, exchange_sides, mirror};
pub use radiograph::Radiograph;
pub use readers::Readers;
pub use space::{
    BentPhantom, EndplateHabit, SagittalShape, SpaceBending, SpacePhantom, SpaceSetup, TrueBody,
    generate_bends_in_space, generate_in_space,
};
pub use subjects::{SUBJECTS, TableRow};
pub use truth::{Scenario, TruePosture};

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use spineline::analysis::Case;
use spineline::anatomy::Posture;

use crate::scenario::Moves;

/// A synthetic patient: the read films, and the true values.
#[derive(Debug, Clone, PartialEq)]
pub struct Phantom {
    /// The case by the readers.
    pub case: Case,
    /// Loading scenario.
    pub scenario: Scenario,
    /// True postures, the erect one first.
    pub postures: Vec<TruePosture>,
    /// True lateral stiffness multipliers per region, caudal first.
    pub multipliers: [f64; 3],
    /// `ln` of the true lateral stiffness of every joint over the nominal one, caudal first.
    pub joint_logs: Vec<f64>,
    /// True places on the films, in the same order.
    pub films: Vec<TrueFilm>,
}

/// Makes one phantom: subject `index` (from 0) of Table 1.
///
/// The same arguments always make the same phantom: every subject and scenario has its own random stream.
pub fn generate(
    index: usize,
    scenario: Scenario,
    readers: &Readers,
    seed: u64,
) -> Result<Phantom, PhantomError> {
    generate_built(index, scenario, readers, seed, Build::default())
}

/// As [`generate`], for a spine of another construction. [`Phantom::multipliers`] are means of regions.
///
/// # Errors
/// [`PhantomError`].
///
/// # Panics
/// If the deviation is not a finite number.
pub fn generate_built(
    index: usize,
    scenario: Scenario,
    readers: &Readers,
    seed: u64,
    build: Build,
) -> Result<Phantom, PhantomError> {
    let readers = std::slice::from_ref(readers);
    let mut phantoms = generate_patient(index, 0, build, scenario, readers, seed)?;
    Ok(phantoms.pop().expect("one per kind of readers"))
}

/// Makes one phantom whose films several kinds of readers read, each starting with the same random numbers.
///
/// `copy` is 0 for the phantom of [`generate`]; every other number makes another patient of the same row of Table 1.
/// Readers who differ only in their standard deviations have errors in the same directions, of different size.
pub fn generate_read(
    index: usize,
    copy: u32,
    scenario: Scenario,
    readers: &[Readers],
    seed: u64,
) -> Result<Vec<Phantom>, PhantomError> {
    generate_patient(index, copy, Build::default(), scenario, readers, seed)
}

fn generate_patient(
    index: usize,
    copy: u32,
    build: Build,
    scenario: Scenario,
    readers: &[Readers],
    seed: u64,
) -> Result<Vec<Phantom>, PhantomError> {
    let row = SUBJECTS.get(index).ok_or(PhantomError::NoSubject { number: index + 1 })?;
    let construction = build.construction;
    if !construction.takes(scenario) {
        let (scenario, construction) = (scenario.key(), construction.key());
        return Err(PhantomError::Construction { scenario, construction });
    }
    let place = 8 * (index as u64 + SUBJECTS.len() as u64 * u64::from(copy));
    // Anatomy is the same for all scenarios; movement and readers have separate streams.
    let mut anatomy_rng = stream(seed, place);
    let (movement, look) = streams(place, scenario);
    let mut rng = stream(seed, movement);
    let made = if construction.is_column() {
        let anatomy = column::Anatomy::draw(row, &build, &mut anatomy_rng)?;
        scenario::of_column(row, scenario, anatomy, &mut rng)?
    } else {
        let spine = erect::ErectSpine::draw(row, &build, &mut anatomy_rng)?;
        scenario::of_chain(row, scenario, &spine, &mut rng)?
    };
    // Random parts of radiographs do not change landmarks.
    let phantoms = readers.iter().map(|readers| {
        let (mut case, films) = film::read_films(
            row,
            scenario,
            made.length_mm,
            &made.postures,
            readers,
            &mut rng.clone(),
            &mut stream(seed, look),
        );
        if construction != Construction::Rod {
            case.id = format!("{}-{}", case.id, construction.key());
        }
        if copy > 0 {
            case.id = format!("{}-copy-{copy}", case.id);
        }
        let Moves { postures, multipliers, joint_logs, .. } = made.clone();
        Phantom { case, scenario, postures, multipliers, joint_logs, films }
    });
    Ok(phantoms.collect())
}

/// Numbers of the streams of movement with readers, and of radiographs, for the patient whose anatomy has the stream
/// `place`.
///
/// The first three scenarios have eight streams per patient; the others have theirs beside and far behind all of these.
fn streams(place: u64, scenario: Scenario) -> (u64, u64) {
    let number = scenario as u64;
    if scenario <= Scenario::Pull {
        return (place + 1 + number, place + 5 + number);
    }
    match Scenario::LOADS.iter().position(|other| *other == scenario) {
        Some(other) => {
            let own = 1000 + 2 * (place + other as u64);
            (own, own + 1)
        }
        None => {
            let own = (1 << 40) + 2 * place;
            (own + 1 + number, own + 9 + number)
        }
    }
}

fn stream(seed: u64, number: u64) -> ChaCha12Rng {
    let mut rng = ChaCha12Rng::seed_from_u64(seed);
    rng.set_stream(number);
    rng
}

impl Phantom {
    /// The same patient on films with larger pixels: each replaces `factor` by `factor` old ones. All places stay
    /// where they are in the patient; whole pixels become parts of a pixel.
    #[must_use]
    pub fn coarser(mut self, factor: u32) -> Self {
        for film in &mut self.films {
            *film = film.coarser(factor);
        }
        for film in &mut self.case.films {
            film::coarsen_landmarks(&mut film.landmarks, factor);
        }
        self
    }

    /// One true posture.
    #[must_use]
    pub fn posture(&self, posture: Posture) -> Option<&TruePosture> {
        self.postures.iter().find(|p| p.posture == posture)
    }

    /// True places of a posture on its film.
    #[must_use]
    pub fn film(&self, posture: Posture) -> Option<&TrueFilm> {
        self.films.iter().find(|film| film.posture == posture)
    }

    /// The radiograph of a posture, drawn from its true film; fifteen million pixels or so.
    #[must_use]
    pub fn radiograph(&self, posture: Posture) -> Option<Radiograph> {
        self.film(posture).map(Radiograph::of)
    }
}

/// The example of the guide is tested with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/guide/src/library.md")]
struct Readme;
