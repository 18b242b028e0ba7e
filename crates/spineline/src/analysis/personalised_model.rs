//! A personalised model by itself, and its response to loads.

use serde::{Deserialize, Serialize};

use super::{Analysis, AxialSource, LineModel, PitchSource, Reference};
use crate::action::{Application, LineKind};
use crate::anatomy::{Level, Levels, Posture};
use crate::clinical::CurvePlaces;
use crate::evaluate::Simulation;
use crate::multibody::{
    GeneralStatics, Goal, Joint, Loading, LoadingError, PathEnding, SpineModel, SpringError,
    Support,
};
use crate::number::scientific;
use crate::response::{OnSignedPoint, Response, go_on, respond, usual_limit};
use crate::spatial::{Mat3, Vec3};

/// A personalised model by itself: vertebrae, joints, springs, and the loads that were found. Frame `G`: x anterior, y left, z cranial,
/// origin at the midpoint of the lowest vertebra; mm. Forces and springs are in N and N·mm/rad where `absolute`, else relative.
#[derive(Debug, Clone, PartialEq)]
pub struct PersonalisedModel {
    /// Case that it was made from.
    pub case_id: String,
    /// Whether that case is synthetic.
    pub synthetic: bool,
    /// Line of action that the stiffness was fitted with.
    pub line: LineKind,
    /// Whether forces and springs are absolute; else only their ratios are meaningful.
    pub absolute: bool,
    /// Mass of the body whose trunk the springs carry in the erect shape ([`Reference`]); `None` where they carry nothing.
    pub carried_body_mass_kg: Option<f64>,
    /// The vertebrae, the fixed one first.
    pub levels: Vec<Level>,
    /// Where pitch and depth of each come from, in their order; `None` where that is not stated.
    pub pitch_from: Vec<Option<PitchSource>>,
    /// Where the axial rotation of each comes from; `None` where that is not stated.
    pub axial_from: Vec<Option<AxialSource>>,
    /// Width of each body between its corners on the erect film; `None` where it is not known.
    pub widths_mm: Vec<Option<f64>>,
    /// Vertebrae and joints, erect.
    pub spine: SpineModel,
    /// Springs of every joint about x, y and z.
    pub stiffness_nmm_per_rad: Vec<[f64; 3]>,
    /// The same as matrices: diagonal, except for joints with coupled hinges.
    pub stiffness: Vec<Mat3>,
    /// Where Cobb and Ferguson angles are measured; `None` where that is not stated.
    pub curves: Option<Vec<CurvePlaces>>,
    /// Support of the patient.
    pub support: Support,
    /// Loads that were found, one per simulated posture; empty where the erect film alone carries the weight of the trunk.
    pub loads: Vec<FilmLoad>,
    /// Doubts that the films raise about this model, one sentence each.
    pub doubts: Vec<String>,
}

/// The force on the uppermost vertebra that a model needs for a film.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FilmLoad {
    /// Posture of the film.
    pub posture: Posture,
    /// How the search for the force ended.
    pub status: PathEnding,
    /// Signed force along the direction: newtons where the model is `absolute`, else relative.
    #[serde(rename = "force")]
    pub force_n: f64,
    /// Point of the line in `G`; x is its sagittal place.
    pub point_mm: [f64; 3],
    /// Unit vector in `G`.
    pub direction: [f64; 3],
    /// `fixed` in space, or `at_t2`: through T2's midpoint wherever that goes.
    pub application: Application,
}

impl FilmLoad {
    /// The force as a vector in `G`.
    #[must_use]
    pub fn force_vector_n(&self) -> Vec3 {
        Vec3::from(self.direction) * self.force_n
    }
}

impl Analysis {
    /// The personalised model of a line of action.
    #[must_use]
    pub fn personalised_model(&self, line: &LineModel) -> PersonalisedModel {
        let movement = &self.movement;
        let levels = movement.levels();
        let levels = levels.as_slice();
        let spine = &movement.spine;
        // Through `G`, where the file states them: the model that is read from its file is the same to the last bit.
        let inferior = spine.midpoints_mm.iter().zip(&spine.axes);
        let centre = |(joint, (place_mm, axes)): (&Joint, (&Vec3, &Mat3))| {
            let centre_mm = place_mm + axes * joint.centre_in_inferior_mm;
            axes.transpose() * (centre_mm - place_mm)
        };
        let centres: Vec<Vec3> = spine.joints.iter().zip(inferior).map(centre).collect();
        let known_widths = movement.widths_mm.iter().copied().chain(std::iter::repeat(None));
        PersonalisedModel {
            case_id: self.case_id.clone(),
            synthetic: self.synthetic,
            line: line.kind,
            absolute: line.is_absolute(self.options.gauge),
            carried_body_mass_kg: match self.options.reference {
                Reference::Unloaded => None,
                Reference::Loaded { body_mass_kg } => Some(body_mass_kg),
            },
            levels: levels.to_vec(),
            pitch_from: levels.iter().map(|&level| Some(self.pitch_source(level))).collect(),
            axial_from: levels.iter().map(|&level| Some(self.axial_source(level))).collect(),
            widths_mm: known_widths.take(levels.len()).collect(),
            spine: SpineModel::from_poses(spine.midpoints_mm.clone(), spine.axes.clone(), &centres),
            stiffness_nmm_per_rad: line.stiffness_nmm_per_rad(&movement.library),
            stiffness: line.stiffness_matrices(&movement.library),
            curves: Some(movement.curve_places()),
            support: self.options.support,
            loads: self.film_loads(line),
            doubts: self.doubts(line),
        }
    }

    /// The doubts that the films raise about the model of a line.
    fn doubts(&self, line: &LineModel) -> Vec<String> {
        let rejected = self.is_rejected(line).then(|| {
            let (bends, s) = self.tested_by([line]);
            format!(
                "the {bends} reject{s} a single force along the {}, with which its stiffness was fitted",
                line.kind
            )
        });
        let verdicts = line.groups.titles().zip(line.verdicts(self));
        let without_value = verdicts.filter(|(_, verdict)| !verdict.has_value());
        let stiffness =
            without_value.map(|(name, verdict)| format!("stiffness, {name}: {verdict}"));
        rejected.into_iter().chain(stiffness).collect()
    }

    /// Loads of the films; empty where the springs are stressed on the erect film alone.
    fn film_loads(&self, line: &LineModel) -> Vec<FilmLoad> {
        if self.movement.loaded_spine.is_some() {
            return Vec::new();
        }
        let top_x_mm = self.movement.spine.midpoints_mm.last().map_or(0.0, |top| top.x);
        let load = |film: &Simulation| {
            let line = self.line_in_model(film);
            let x_mm = match line.application {
                Application::Fixed => film.depth_mm,
                Application::AtT2 => top_x_mm,
            };
            FilmLoad {
                posture: film.shape.posture,
                status: film.status,
                force_n: film.force_n,
                point_mm: [x_mm, line.point.y_mm, line.point.z_mm],
                direction: [0.0, line.direction.y_mm, line.direction.z_mm],
                application: line.application,
            }
        };
        line.simulations.iter().map(load).collect()
    }
}

/// Why loads on a model give no path of shapes.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The stiffness of a joint is not symmetric and positive definite.
    #[error(transparent)]
    Springs(#[from] SpringError),
    /// A load cannot be applied.
    #[error(transparent)]
    Loading(#[from] LoadingError),
    /// A largest factor that loads cannot have.
    #[error("the largest factor {} is not above 0 and at most {}", scientific(*factor, 1), scientific(LARGEST_FACTOR, 0))]
    LargestFactor {
        /// What was given.
        factor: f64,
    },
}

/// The largest factor up to which a search may look.
const LARGEST_FACTOR: f64 = 1e9;

impl PersonalisedModel {
    /// The equilibrium equations of the model.
    ///
    /// # Errors
    /// [`SpringError`] where the stiffness of a joint is not symmetric and positive definite.
    pub fn statics(&self) -> Result<GeneralStatics<'_>, SpringError> {
        GeneralStatics::new(&self.spine, self.stiffness.iter().copied(), self.support)
    }

    /// The shapes that the model takes under loads, up to the load factor 1 or to what is sought.
    ///
    /// # Errors
    /// [`SimulationError`] where the springs or the loads cannot be used. A search that finds no shape is a [`Response`] that says so.
    pub fn simulate(&self, loading: &Loading, goal: Goal) -> Result<Response, SimulationError> {
        self.simulate_within(loading, goal, None, &mut go_on)
    }

    /// As [`PersonalisedModel::simulate`], up to a load factor (the usual one where `None`); the callback gets every shape and may
    /// interrupt the search.
    ///
    /// # Errors
    /// As [`PersonalisedModel::simulate`].
    pub fn simulate_within(
        &self,
        loading: &Loading,
        goal: Goal,
        largest_factor: Option<f64>,
        on_point: OnSignedPoint<'_>,
    ) -> Result<Response, SimulationError> {
        if let Some(factor) = largest_factor.filter(|&f| !(f > 0.0 && f <= LARGEST_FACTOR)) {
            return Err(SimulationError::LargestFactor { factor });
        }
        let statics = self.statics()?;
        let usual = || usual_limit(&self.spine, &self.stiffness, loading, goal);
        let factor = largest_factor.unwrap_or_else(usual);
        Ok(respond(&statics, loading, goal, factor, on_point)?)
    }

    /// Its vertebrae as levels of an analysis; `None` where they are not neighbours among L4 to T2.
    #[must_use]
    pub fn known_levels(&self) -> Option<Levels> {
        let levels = Levels::between(*self.levels.first()?, *self.levels.last()?)?;
        (levels.as_slice() == self.levels).then_some(levels)
    }

    /// The vertebra that carries the force of a film: the highest one.
    #[must_use]
    pub fn top(&self) -> Level {
        self.levels.last().copied().unwrap_or(Level::T2)
    }

    /// Unit of forces: `N`, or a text that warns where only ratios are known.
    #[must_use]
    pub const fn force_unit(&self) -> &'static str {
        if self.absolute { "N" } else { "relative units, not newtons" }
    }
}
