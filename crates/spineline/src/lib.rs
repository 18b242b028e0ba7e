//! Spineline turns frontal radiographs of a scoliotic spine into a personalised multibody model.
//!
//! Data flows one way:
//!
//! 1. [`measure`]: landmarks on a film → location and tilt of every vertebra
//! 2. [`curve`]: → a smooth curve and its inflections ([`clinical`] reads Cobb and Ferguson angles beside it)
//! 3. [`chain`]: → a chain of equal micro-scale segments on every film
//! 4. [`motion`]: → how far every segment rotates, and which rotate least
//! 5. [`action`]: → candidates for the line along which the force acts
//! 6. [`multibody`]: → vertebrae, joints and springs in static equilibrium
//! 7. [`personalize`]: → stiffness multipliers that reproduce the bends
//! 8. [`evaluate`]: → errors on films that were fitted and separately on films that were not
//!
//! [`reliability`] asks how well the readings of step 1 repeat. [`uncertainty`] asks what their noise does to every result. [`response`] asks a personalised model what it would do under any loads.
//!
//! [`analysis::analyze`] does all eight steps. The library has no files, no clock, no printing and no hidden randomness.
//! [`prelude`] has the names of a usual program.
//!
//! # A case from the corners of vertebrae
//! The crate `spineline-files` reads case files. A program that has the corners makes its own case:
//!
//! ```
//! use spineline::prelude::*;
//!
//! /// A body 40 px wide and 28 px high, turned clockwise as the picture shows it. The patient's left is on the right.
//! fn body(column: f64, row: f64, clockwise_rad: f64) -> VertebraLandmarks {
//!     let corner = |right_px: f64, down_px: f64| {
//!         let (sin, cos) = clockwise_rad.sin_cos();
//!         Pixel::new(column + right_px * cos - down_px * sin, row + right_px * sin + down_px * cos)
//!     };
//!     VertebraLandmarks::clicked(Corners {
//!         superior_left: corner(20.0, -14.0),
//!         superior_right: corner(-20.0, -14.0),
//!         inferior_left: corner(20.0, 14.0),
//!         inferior_right: corner(-20.0, 14.0),
//!     })
//! }
//!
//! // L4 to T2, 36 px apart, on one wave over 540 px: its inflections lie at 135 px and at 405 px.
//! let wave = std::f64::consts::TAU / 540.0;
//! let bodies = Level::MODEL.iter().zip(0_u32..).map(|(&level, number)| {
//!     let up_px = 36.0 * f64::from(number);
//!     let slope = 25.0 * wave * (wave * up_px).sin();
//!     (level, body(400.0 - 25.0 * (wave * up_px).cos(), 900.0 - up_px, slope.atan()))
//! });
//! let landmarks = FilmLandmarks::Corners {
//!     image: ImageGeometry {
//!         columns: 800,
//!         rows: 1000,
//!         spacing: Some(Spacing::stated(0.8, 0.8, SpacingPlane::Patient)),
//!         patient_left: ImageSide::Right,
//!     },
//!     iliac_crests: None,
//!     readings: vec![Reading {
//!         id: ReadingId { observer: "A".into(), repeat: 1 },
//!         vertebrae: bodies.collect(),
//!     }],
//! };
//! let erect = Film::new(Posture::Erect, landmarks);
//! let case = Case {
//!     id: "wave".into(),
//!     synthetic: true,
//!     subject: Subject::default(),
//!     films: vec![erect],
//!     lateral: None,
//! };
//! let movement = analyze(&case, &AnalysisOptions::default())?.movement;
//! assert_eq!(movement.inflections.all.len(), 2);
//! # Ok::<(), Error>(())
//! ```
//!
//! # The paper's method on one case
//! The crate `spineline-phantom` makes synthetic cases.
//!
//! ```
//! use spineline::prelude::*;
//! use spineline_phantom::{Readers, Scenario, generate};
//!
//! let case = generate(0, Scenario::Rod, &Readers::exact(), 1)?.case;
//! let analysis = analyze(&case, &AnalysisOptions::default())?;
//! for model in &analysis.models {
//!     println!("{}: {:?} mm on fitted films", model.kind, model.mean_location_error_mm(true));
//! }
//! assert!(analysis.model(LineKind::Inflection).is_some_and(LineModel::is_converged));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A load on the personalised model
//!
//! ```
//! use spineline::prelude::*;
//! # use spineline_phantom::{Readers, Scenario, generate};
//! # let case = generate(0, Scenario::Rod, &Readers::exact(), 1)?.case;
//! # let analysis = analyze(&case, &AnalysisOptions::default())?;
//! let line = analysis.model(LineKind::Inflection).ok_or("the line has no model")?;
//! let model = analysis.personalised_model(line);
//! // A push of one unit of force to the patient's left at the midpoint of the highest vertebra.
//! let push = BodyLoad::at_midpoint(Vec3::new(0.0, 1.0, 0.0));
//! let loading = Loading::single(model.levels.len() - 1, push);
//! let response = model.simulate(&loading, Goal::FullLoad)?;
//! let shape = response.shape().ok_or("no equilibrium within the limits")?;
//! let (before, after) = (&model.spine.midpoints_mm, &shape.midpoints_mm);
//! assert!(after.last().zip(before.last()).is_some_and(|(new, old)| new.y > old.y));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What it is not
//! Research software, not a medical device. Bending films carry no force, so only ratios of stiffness are identified, until one force is known.

#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare with exact values"))]

#[cfg(feature = "schema")]
#[doc(hidden)]
pub use schemars;
#[doc(hidden)]
pub use serde;

pub mod action;
pub mod analysis;
pub mod anatomy;
pub mod chain;
pub mod clinical;
pub mod cohort;
pub mod curve;
pub mod error;
pub mod evaluate;
pub mod fault;
pub mod hypothesis;
pub(crate) mod least_squares;
pub mod measure;
pub mod motion;
pub mod multibody;
pub mod number;
pub mod personalize;
pub mod prelude;
pub mod reliability;
pub mod response;
pub mod spatial;
pub mod uncertainty;
pub mod warning;
