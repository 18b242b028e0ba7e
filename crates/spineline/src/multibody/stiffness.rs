use crate::anatomy::{Level, Levels, Region, named};
use crate::clinical::Regions;
use crate::fault::{ErrorPlace, faults};
use crate::measure::median;
use crate::number::significant;
use crate::spatial::{Angle, Mat3, Vec3};

/// The springs of one joint.
///
/// # Equation
/// Elastic energy of the hinge angles `θ`, in N·mm, with the springs `k` and the coupling `r`:
///
/// ```text
/// V = 1/2 (k_x θ_x² + k_y θ_y² + k_z (θ_z - r θ_x)²)
/// ```
///
/// It is positive for every `r`. A pure lateral moment turns the joint by `θ_x = m / k_x` and `θ_z = r θ_x`, so `k_x` is the stiffness that
/// a test with free coupled motion measures. Under any moment `m`, with the axes that the hinges have turned,
///
/// ```text
/// k_x θ_x         = m . e_x + r m . (R_x R_y e_z)
/// k_y θ_y         = m . (R_x e_y)
/// k_z (θ_z - r θ_x) = m . (R_x R_y e_z)
/// ```
///
/// The first is an equation for `θ_x`, which the march solves to rounding at each joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointStiffness {
    /// Lower vertebra.
    pub inferior: Level,
    /// Upper vertebra.
    pub superior: Level,
    /// Lateral, flexion and axial rotational stiffness, in N·mm/rad.
    pub nmm_per_rad: [f64; 3],
    /// Coupling: axial rotation (front to the left) per lateral rotation (to the right) under a pure lateral moment. Negative where a bend turns the
    /// front of the vertebra to its own side; zero without coupling.
    pub axial_per_lateral: f64,
    /// Where the values come from.
    pub source: String,
}

/// The springs of a joint about x, y and z, with a coupling, as a matrix: the second derivatives of the energy of [`JointStiffness`].
#[must_use]
pub fn coupled_matrix(nmm_per_rad: [f64; 3], axial_per_lateral: f64) -> Mat3 {
    let mut matrix = Mat3::from_diagonal(&Vec3::from(nmm_per_rad));
    if axial_per_lateral != 0.0 {
        let shared = axial_per_lateral * nmm_per_rad[2];
        matrix[(0, 0)] += axial_per_lateral * shared;
        matrix[(0, 2)] = -shared;
        matrix[(2, 0)] = -shared;
    }
    matrix
}

/// The springs of the joints before personalisation, caudal first: of all 14, or of the joints of a shorter spine.
#[derive(Debug, Clone, PartialEq)]
pub struct StiffnessLibrary {
    rows: Vec<JointStiffness>,
}

const HELP: &str = "give every joint from L4/L3 to T3/T2 one row with three positive values in N·m/rad, and a coupling between -2 and 2";

faults! {
    /// A stiffness table that cannot be used.
    pub enum StiffnessError {
        /// A joint of the model is not in the table.
        #[error("the stiffness of joint {inferior}/{superior} is missing")]
        #[code("stiffness")]
        #[help(HELP)]
        #[at(level = *superior)]
        Missing {
            inferior: Level,
            superior: Level,
        },
        /// A joint is in the table twice.
        #[error("the stiffness of joint {inferior}/{superior} is given twice")]
        #[code("stiffness")]
        #[help(HELP)]
        #[at(level = *superior)]
        Twice {
            inferior: Level,
            superior: Level,
        },
        /// A stiffness that is not positive and finite.
        #[error("joint {inferior}/{superior}: {axis} stiffness is {} N·m/rad, and must be positive and finite", significant(*nm_per_rad, 6))]
        #[code("stiffness")]
        #[help(HELP)]
        #[at(level = *superior, value = *nm_per_rad, limit = 0.0)]
        Value {
            inferior: Level,
            superior: Level,
            axis: &'static str,
            /// What was given.
            nm_per_rad: f64,
        },
        /// Lateral stiffness that is too small or too large as a whole.
        #[error("the median lateral stiffness of the joints is {} times the usual {USUAL_NM_PER_RAD} N·m/rad, outside of {LEAST_RATIO} to {MOST_RATIO} times{}", significant(*ratio, 3), match unit_of(*ratio) {
            Some(unit) => format!("; the values look like {unit}, not N·m/rad"),
            None => String::new(),
        })]
        #[code("stiffness")]
        #[help(HELP)]
        #[at(value = *ratio, limit = if *ratio < LEAST_RATIO { LEAST_RATIO } else { MOST_RATIO })]
        Unit {
            /// Median over the usual one.
            ratio: f64,
        },
        /// Lateral stiffness that no joint has.
        #[error("joint {inferior}/{superior}: lateral stiffness is {} N·m/rad, and must be {LEAST_OF_MEDIAN} to {MOST_OF_MEDIAN} times the median of all joints, {}", significant(*nm_per_rad, 6), significant(*median_nm_per_rad, 6))]
        #[code("stiffness")]
        #[help(HELP)]
        #[at(level = *superior, value = *nm_per_rad, limit = ErrorPlace::limit(*nm_per_rad, LEAST_OF_MEDIAN * median_nm_per_rad, MOST_OF_MEDIAN * median_nm_per_rad))]
        Lateral {
            /// Lower vertebra.
            inferior: Level,
            /// Upper vertebra.
            superior: Level,
            /// What was given.
            nm_per_rad: f64,
            /// Of all joints.
            median_nm_per_rad: f64,
        },
        /// A coupling that no joint has.
        #[error("joint {inferior}/{superior}: the axial rotation per lateral rotation is {value}, and must lie between -{MAX_COUPLING} and {MAX_COUPLING}; give 0 for a joint without coupling")]
        #[code("stiffness")]
        #[help(HELP)]
        #[at(level = *superior, value = *value, limit = ErrorPlace::limit(*value, -MAX_COUPLING, MAX_COUPLING))]
        Coupling {
            inferior: Level,
            superior: Level,
            value: f64,
        },
    }
}

/// Measured joints turn axially by less than they bend; twice that is an error of input (assumption).
const MAX_COUPLING: f64 = 2.0;

/// Lateral stiffness of a joint over the median: published tables have 78 to 318 N·m/rad (`StiffnessTable`); a fused joint is stiffer
/// and a destroyed one softer (assumption). Flexion and axial rotation may be locked by any stiffness.
const LEAST_OF_MEDIAN: f64 = 0.007;
const MOST_OF_MEDIAN: f64 = 70.0;

/// Lateral stiffness of a motion segment: 132 to 148 N·m/rad in `StiffnessTable::MotionSegments`.
const USUAL_NM_PER_RAD: f64 = 140.0;
/// Median of lateral stiffness over the usual one: published tables have 0.7 to 2.3, and every other unit is beyond these limits.
const LEAST_RATIO: f64 = 0.1;
const MOST_RATIO: f64 = 10.0;

/// The unit in which lateral stiffness would be near the usual one.
fn unit_of(ratio: f64) -> Option<&'static str> {
    // Published tables differ by less than this.
    const NEAR: f64 = 3.0;
    let degree = Angle::from_deg(1.0).rad();
    let units = [
        ("N·mm/rad", 1000.0),
        ("N·mm per degree", 1000.0 * degree),
        ("N·m per degree", degree),
        ("kN·m/rad", 0.001),
    ];
    let is_near = |factor: f64| (ratio / factor).ln().abs() < NEAR.ln();
    units.into_iter().find(|(_, factor)| is_near(*factor)).map(|(unit, _)| unit)
}

fn median_lateral_nm_per_rad(rows: &[JointStiffness]) -> f64 {
    median(rows.iter().map(|row| row.nmm_per_rad[0] / 1000.0).collect())
}

/// Refuses lateral stiffness of a size that no joint has beside the others.
fn check_sizes(rows: &[JointStiffness]) -> Result<(), StiffnessError> {
    let median_nm_per_rad = median_lateral_nm_per_rad(rows);
    for row in rows {
        let (inferior, superior) = (row.inferior, row.superior);
        let nm_per_rad = row.nmm_per_rad[0] / 1000.0;
        if !(LEAST_OF_MEDIAN..=MOST_OF_MEDIAN).contains(&(nm_per_rad / median_nm_per_rad)) {
            return Err(StiffnessError::Lateral {
                inferior,
                superior,
                nm_per_rad,
                median_nm_per_rad,
            });
        }
    }
    Ok(())
}

impl StiffnessLibrary {
    /// A library from rows in any order.
    ///
    /// # Errors
    /// [`StiffnessError`] where a joint of the model is missing, doubled, not positive, or far from the others.
    pub fn from_rows(mut given: Vec<JointStiffness>) -> Result<Self, StiffnessError> {
        for row in &given {
            let (inferior, superior) = (row.inferior, row.superior);
            for (axis, &value) in ["lateral", "flexion", "axial"].into_iter().zip(&row.nmm_per_rad)
            {
                if !(value > 0.0 && value.is_finite()) {
                    let nm_per_rad = value / 1000.0;
                    return Err(StiffnessError::Value { inferior, superior, axis, nm_per_rad });
                }
            }
            let value = row.axial_per_lateral;
            if value.is_nan() || value.abs() > MAX_COUPLING {
                return Err(StiffnessError::Coupling { inferior, superior, value });
            }
        }
        given.sort_by_key(|row| (row.inferior, row.superior));
        if let Some(pair) = given
            .windows(2)
            .find(|p| (p[0].inferior, p[0].superior) == (p[1].inferior, p[1].superior))
        {
            return Err(StiffnessError::Twice {
                inferior: pair[0].inferior,
                superior: pair[0].superior,
            });
        }
        let rows = Level::MODEL
            .windows(2)
            .map(|pair| {
                let found = given.iter().find(|row| [row.inferior, row.superior] == pair);
                found
                    .cloned()
                    .ok_or(StiffnessError::Missing { inferior: pair[0], superior: pair[1] })
            })
            .collect::<Result<Vec<_>, _>>()?;
        check_sizes(&rows)?;
        Ok(Self { rows })
    }

    /// Whether the table may be in N·m/rad.
    ///
    /// # Errors
    /// [`StiffnessError::Unit`].
    pub fn check_unit(&self) -> Result<(), StiffnessError> {
        let ratio = median_lateral_nm_per_rad(&self.rows) / USUAL_NM_PER_RAD;
        let is_usual = (LEAST_RATIO..=MOST_RATIO).contains(&ratio);
        if is_usual { Ok(()) } else { Err(StiffnessError::Unit { ratio }) }
    }

    /// The rows of the joints between some vertebrae.
    #[must_use]
    pub fn between(&self, levels: Levels) -> Self {
        let inside = |row: &&JointStiffness| {
            levels.index_of(row.inferior).is_some() && levels.index_of(row.superior).is_some()
        };
        Self { rows: self.rows.iter().filter(inside).cloned().collect() }
    }

    /// The springs as a support lets them act: one that locks the axial hinges leaves no coupling.
    #[must_use]
    pub fn under(mut self, support: Support) -> Self {
        if support == Support::Frontal {
            self.rows.iter_mut().for_each(|row| row.axial_per_lateral = 0.0);
        }
        self
    }

    /// The rows, caudal first.
    #[must_use]
    pub fn rows(&self) -> &[JointStiffness] {
        &self.rows
    }
}

named! {
    /// What holds the patient.
    #[default(Frontal)]
    pub enum Support {
        /// Every joint rotates about three axes (the paper).
        ///
        /// Only L4 is held. Frontal films do not show whether joints flex or rotate axially; with this support, left-out bends are predicted
        /// worse (decision record 0032).
        Free = "free",
        /// In the frontal plane, as on a table: flexion and axial rotation are locked.
        Frontal = "frontal",
    }
}

/// The name of a group for people.
pub(crate) fn group_title(name: &str) -> String {
    name.parse::<Region>().map_or_else(|_| name.to_owned(), |region| region.to_string())
}

/// Which joints share one stiffness multiplier.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JointGroups {
    of_joint: Vec<usize>,
    names: Vec<String>,
}

impl JointGroups {
    /// One multiplier per region (Petit).
    #[must_use]
    pub fn regional(regions: &Regions) -> Self {
        let of_joint = (0..regions.joints()).map(|joint| regions.of_joint(joint).index()).collect();
        Self { of_joint, names: Region::ALL.map(|region| region.key().to_owned()).to_vec() }
    }

    /// One multiplier per joint.
    #[must_use]
    pub fn per_joint(levels: Levels) -> Self {
        let names = levels.joint_pairs().map(|[below, above]| format!("{below}/{above}"));
        Self { of_joint: (0..levels.joints()).collect(), names: names.collect() }
    }

    /// The group of every joint, caudal first.
    #[must_use]
    pub fn of_joint(&self) -> &[usize] {
        &self.of_joint
    }

    /// Names of the groups.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Names of the groups for people, such as `thoracolumbar/lumbar` and `L4/L3`.
    pub fn titles(&self) -> impl Iterator<Item = String> {
        self.names.iter().map(|name| group_title(name))
    }

    /// Number of groups.
    #[must_use]
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Whether it has no group.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }
}
