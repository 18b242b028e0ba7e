//! How near a state is to a singular point, and on which side.

use super::balance::{Balance, RowsOf6, State, moment_by_twist};
use super::rods::prescribed;
use super::wrench::SpatialMatrix;
use crate::multibody::Support;
use crate::spatial::Mat3;

/// Signs of a tangent: they change where the branch turns or another one crosses it.
///
/// For loads with a potential `negative` counts the directions in which the shape is unstable. For others it may change
/// elsewhere too, so whoever finds a change looks at the smallest singular value there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Signs {
    negative: usize,
    positive_determinant: bool,
}

impl Signs {
    /// Signs of the springs alone.
    pub(super) const UNLOADED: Self = Self { negative: 0, positive_determinant: true };

    /// Adds a pivot block of the elimination: sign changes in the row of its leading minors.
    pub(super) fn add(&mut self, block: &Mat3) {
        let second = block[(0, 0)] * block[(1, 1)] - block[(0, 1)] * block[(1, 0)];
        let minors = [1.0, block[(0, 0)], second, block.determinant()];
        self.negative += minors.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
        self.positive_determinant ^= minors[3] < 0.0;
    }

    #[cfg(test)]
    pub(super) fn has_positive_determinant(&self) -> bool {
        self.positive_determinant
    }

    /// Signs of the tangent on the turns that rods allow.
    pub(super) fn within_rods(balance: &Balance<'_>, state: &State) -> Self {
        let tangent = allowed_tangent(balance, state);
        if tangent.is_empty() {
            return Self::UNLOADED;
        }
        let symmetric = (&tangent + tangent.transpose()) * 0.5;
        let values = symmetric.symmetric_eigenvalues();
        let negative = values.iter().filter(|value| **value < 0.0).count();
        Self { negative, positive_determinant: tangent.determinant() >= 0.0 }
    }
}

/// Smallest singular value of the scaled tangent, on the turns that the rods allow; one where they allow none.
pub(super) fn smallest_singular_value(balance: &Balance<'_>, state: &State) -> f64 {
    let tangent = allowed_tangent(balance, state);
    if tangent.is_empty() {
        return 1.0;
    }
    tangent.singular_values().min()
}

fn hinges_per_joint(balance: &Balance<'_>) -> usize {
    match balance.support {
        Support::Free => 3,
        Support::Frontal => 1,
    }
}

/// The scaled tangent on the turns that the rods allow.
fn allowed_tangent(balance: &Balance<'_>, state: &State) -> nalgebra::DMatrix<f64> {
    let mut tangent = scaled_tangent(balance, state);
    if balance.loading.rods.is_empty() {
        return tangent;
    }
    let each = prescribed(balance.support);
    let mut equations =
        nalgebra::DMatrix::zeros(each * balance.loading.rods.len(), tangent.nrows());
    for number in 0..balance.loading.rods.len() {
        let relative = scaled_twists(balance, state, number, Part::Between);
        let rows = state.rods[number].by_relative.rows(0, each) * &relative;
        equations.rows_mut(each * number, each).copy_from(&rows);
        if balance.support == Support::Frontal {
            tangent -= relative.tr_mul(&reaction_by_hinges(balance, state, number));
        }
    }
    let free = free_directions(&equations);
    free.transpose() * tangent * free
}

/// Which hinges of a chain with a rod.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Below,
    Between,
}

/// Twists by the hinges below or between the vertebrae of a rod, over all hinges, each divided by the root of its spring.
fn scaled_twists(
    balance: &Balance<'_>,
    state: &State,
    rod: usize,
    part: Part,
) -> nalgebra::OMatrix<f64, nalgebra::U6, nalgebra::Dyn> {
    let rod = &balance.loading.rods[rod];
    let joints = match part {
        Part::Below => 0..rod.inferior,
        Part::Between => rod.inferior..rod.superior,
    };
    let per_joint = hinges_per_joint(balance);
    let hinges = per_joint * balance.model.joints.len();
    let mut twists = nalgebra::OMatrix::<f64, nalgebra::U6, nalgebra::Dyn>::zeros(hinges);
    for column in joints.start * per_joint..joints.end * per_joint {
        let (j, a) = (column / per_joint, column % per_joint);
        let scaled = state.twists[j].column(a) / balance.stiffness[j][(a, a)].sqrt();
        twists.set_column(column, &scaled);
    }
    twists
}

/// How the reaction of a rod in a frontal support turns with the vertebrae, up to parts that do no work on what it leaves free.
fn reaction_by_hinges(
    balance: &Balance<'_>,
    state: &State,
    rod: usize,
) -> nalgebra::OMatrix<f64, nalgebra::U6, nalgebra::Dyn> {
    let equations = &state.rods[rod];
    let [relative, below] =
        [Part::Between, Part::Below].map(|part| scaled_twists(balance, state, rod, part));
    let change = equations.by_relative * relative + equations.by_both * below;
    let each = prescribed(balance.support);
    let by_reaction = equations.by_reaction.rows(each, 6 - each).into_owned();
    let inverse = by_reaction.pseudo_inverse(0.0).expect("zero is not negative");
    -inverse * change.rows(each, 6 - each)
}

/// An orthonormal basis of the directions that equations leave free.
fn free_directions(equations: &nalgebra::DMatrix<f64>) -> nalgebra::DMatrix<f64> {
    let eigen = (equations.transpose() * equations).symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    let free: Vec<_> = eigen
        .eigenvalues
        .iter()
        .enumerate()
        .filter(|(_, value)| **value <= 1e-12 * largest)
        .map(|(i, _)| eigen.eigenvectors.column(i))
        .collect();
    if free.is_empty() {
        return nalgebra::DMatrix::zeros(equations.ncols(), 0);
    }
    nalgebra::DMatrix::from_columns(&free)
}

/// The tangent as a matrix over the hinges that can turn, each row and column divided by the root of the hinge's spring.
///
/// Dimensionless: the identity for an unloaded spine with diagonal springs, singular where the branch turns or splits.
pub(super) fn scaled_tangent(balance: &Balance<'_>, state: &State) -> nalgebra::DMatrix<f64> {
    let joints = state.hinges.len();
    let per_joint = hinges_per_joint(balance);
    // Change of the wrench from above each joint with the twist of everything above it.
    let mut above = vec![SpatialMatrix::zeros(); joints + 1];
    for j in (0..joints).rev() {
        above[j] = above[j + 1] + state.load_tangents[j + 1].unwrap_or_else(SpatialMatrix::zeros);
    }
    let rows: Vec<RowsOf6> =
        (0..joints).map(|j| moment_by_twist(&state.twists[j], &state.above[j])).collect();
    nalgebra::DMatrix::from_fn(joints * per_joint, joints * per_joint, |row, column| {
        let ((i, a), (k, b)) =
            ((row / per_joint, row % per_joint), (column / per_joint, column % per_joint));
        let (own, other) = (state.twists[i].column(a), state.twists[k].column(b));
        let mut entry = if i == k { balance.stiffness[i][(a, b)] } else { 0.0 };
        if (k, b) < (i, a) {
            entry -= (rows[i].row(a) * other).x;
        }
        entry -= own.dot(&(above[i.max(k)] * other));
        entry / (balance.stiffness[i][(a, a)] * balance.stiffness[k][(b, b)]).sqrt()
    })
}
