//! The march of the design once more, written on plain arrays and for any kind of number.
//!
//! It shares no code with the library: arrays instead of nalgebra, rotation matrices instead of turned axes.

use num_dual::{Dual64, DualNum};
use spineline::multibody::SpineModel;

/// A number that can be differentiated.
pub trait Number: DualNum<f64> + Copy {}
impl<T: DualNum<f64> + Copy> Number for T {}

pub type Vector<T> = [T; 3];
/// Rows of a matrix.
pub type Matrix<T> = [[T; 3]; 3];

pub fn vector<T: Number>(v: [f64; 3]) -> Vector<T> {
    v.map(T::from)
}

pub fn add<T: Number>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn subtract<T: Number>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn dot<T: Number>(a: Vector<T>, b: Vector<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross<T: Number>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn apply<T: Number>(m: &Matrix<T>, v: Vector<T>) -> Vector<T> {
    [dot(m[0], v), dot(m[1], v), dot(m[2], v)]
}

pub fn transposed<T: Number>(m: &Matrix<T>) -> Matrix<T> {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

pub fn product<T: Number>(a: &Matrix<T>, b: &Matrix<T>) -> Matrix<T> {
    let columns = transposed(b);
    std::array::from_fn(|i| std::array::from_fn(|j| dot(a[i], columns[j])))
}

/// Right-handed rotation about axis 0, 1 or 2.
pub fn rotation<T: Number>(axis: usize, angle: T) -> Matrix<T> {
    let (s, c) = angle.sin_cos();
    let (one, zero) = (T::from(1.0), T::from(0.0));
    match axis {
        0 => [[one, zero, zero], [zero, c, -s], [zero, s, c]],
        1 => [[c, zero, s], [zero, one, zero], [-s, zero, c]],
        _ => [[c, -s, zero], [s, c, zero], [zero, zero, one]],
    }
}

/// A vertebra in space.
#[derive(Debug, Clone, Copy)]
pub struct Body<T> {
    pub midpoint: Vector<T>,
    pub axes: Matrix<T>,
}

fn rest<T: Number>(model: &SpineModel, i: usize) -> Body<T> {
    let (p, r) = (model.midpoints_mm[i], model.axes[i]);
    Body {
        midpoint: vector([p.x, p.y, p.z]),
        axes: std::array::from_fn(|row| std::array::from_fn(|column| T::from(r[(row, column)]))),
    }
}

/// Stacks the vertebrae; `hinges` gives a joint's three angles for its centre and its inferior vertebra's axes.
pub fn stack<T: Number>(
    model: &SpineModel,
    mut hinges: impl FnMut(usize, Vector<T>, &Matrix<T>) -> [T; 3],
) -> Vec<Body<T>> {
    let mut bodies: Vec<Body<T>> = vec![rest(model, 0)];
    for (j, joint) in model.joints.iter().enumerate() {
        let (lower, upper) = (rest::<T>(model, j), rest::<T>(model, j + 1));
        let offset = joint.centre_in_inferior_mm;
        let offset: Vector<T> = vector([offset.x, offset.y, offset.z]);
        // Where the upper vertebra stands against the lower one at rest, from the model's poses alone.
        let back = transposed(&lower.axes);
        let rise = subtract(apply(&back, subtract(upper.midpoint, lower.midpoint)), offset);
        let relative = product(&back, &upper.axes);
        let below = bodies[j];
        let centre = add(below.midpoint, apply(&below.axes, offset));
        let [x, y, z] = hinges(j, centre, &below.axes);
        let turn = product(&product(&rotation(0, x), &rotation(1, y)), &rotation(2, z));
        let turned = product(&below.axes, &turn);
        bodies.push(Body {
            midpoint: add(centre, apply(&turned, rise)),
            axes: product(&turned, &relative),
        });
    }
    bodies
}

/// Equilibrium under a force and its moment about the origin, both fixed in space (section 3 of the design).
pub fn march<T: Number>(
    model: &SpineModel,
    compliance: impl Fn(usize) -> [T; 3],
    force: Vector<T>,
    moment: Vector<T>,
) -> Vec<Body<T>> {
    stack(model, |j, centre, axes| {
        let about_joint = subtract(moment, cross(centre, force));
        // The moment in the inferior vertebra's axes.
        let m = apply(&transposed(axes), about_joint);
        let [cx, cy, cz] = compliance(j);
        let (one, zero) = (T::from(1.0), T::from(0.0));
        let x = cx * m[0];
        let first = rotation(0, x);
        let y = cy * dot(m, apply(&first, [zero, one, zero]));
        let second = product(&first, &rotation(1, y));
        let z = cz * dot(m, apply(&second, [zero, zero, one]));
        [x, y, z]
    })
}

/// Velocity of a midpoint, and rotation vector.
pub type Rates = ([f64; 3], [f64; 3]);

/// The derivatives that a body of dual numbers carries.
pub fn rates(body: &Body<Dual64>) -> Rates {
    let real = body.axes.map(|row| row.map(|x| x.re));
    let rate = body.axes.map(|row| row.map(|x| x.eps));
    // dR Rᵀ is the cross-product matrix of the rotation vector.
    let spin = product(&rate, &transposed(&real));
    (body.midpoint.map(|x| x.eps), [spin[2][1], spin[0][2], spin[1][0]])
}
