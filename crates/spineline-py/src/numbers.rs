//! Read-only arrays of numpy.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A row of numbers.
pub fn row<'py>(py: Python<'py>, values: Vec<f64>) -> Bound<'py, PyArray1<f64>> {
    let array = PyArray1::from_vec(py, values);
    // Only the flag of the array matters, not the borrow that comes with it.
    drop(array.readwrite().make_nonwriteable());
    array
}

/// Points, one per row.
///
/// # Errors
/// Never: all points have the same number of coordinates.
pub fn points<'py, const N: usize>(
    py: Python<'py>,
    points: impl ExactSizeIterator<Item = [f64; N]>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let count = points.len();
    let flat = PyArray1::from_vec(py, points.flatten().collect::<Vec<f64>>());
    let array =
        flat.reshape([count, N]).map_err(|error| PyValueError::new_err(error.to_string()))?;
    drop(array.readwrite().make_nonwriteable());
    drop(flat.readwrite().make_nonwriteable());
    Ok(array)
}
