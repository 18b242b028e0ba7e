use super::*;

/// Rounding of a solve of some ten unknowns.
const ROUNDING: f64 = 1e-10;

/// Two rows of five vertebrae above the base, with the deviations 0.5 mm and 0.02 rad.
fn rates() -> Vec<ErrorRate> {
    let of = |place| [(place, Measured::Left, 2.0), (place, Measured::Tilt, -50.0)];
    (1..6).flat_map(of).collect()
}

/// Independent errors of these deviations.
fn independent() -> DMatrix<f64> {
    let variances = (0..6).flat_map(|_| [0.25, 0.25, 4e-4]);
    DMatrix::from_diagonal(&DVector::from_iterator(18, variances))
}

/// The same with an error that all share.
fn shared() -> DMatrix<f64> {
    let common =
        DVector::from_fn(18, |row, _| if row % 3 == 2 { 0.01 } else { 0.3 + 0.02 * row as f64 });
    independent() + &common * common.transpose()
}

/// A linear fit with three unknowns.
fn linear() -> (DMatrix<f64>, DVector<f64>) {
    let matrix = DMatrix::from_fn(10, 3, |i, j| ((3 * i + 5 * j + i * j) % 7) as f64 - 2.0);
    (matrix, DVector::from_fn(10, |i, _| ((5 * i) % 8) as f64 - 3.0))
}

#[test]
fn whitening_by_independent_errors_changes_nothing() {
    // Oracle: residuals that are divided by their own deviations are independent already.
    let whitening = Whitening::of(&independent(), &rates()).expect("positive");
    let (mut matrix, mut target) = linear();
    whitening.apply_to_rows(&mut matrix, &mut target);
    let (before, aim) = linear();
    assert!((matrix - before).amax() < ROUNDING && (target - aim).amax() < ROUNDING);
    let by_blocks = whitening.by_blocks(2).expect("positive");
    assert!((by_blocks - DMatrix::identity(10, 10)).amax() < ROUNDING);
}

#[test]
fn whitened_least_squares_is_generalised_least_squares() {
    // Oracle: the normal equations with the inverse of the covariance.
    let covariance = shared();
    let rows = rate_matrix(&rates(), 18);
    let of_rows = &rows * &covariance * rows.transpose();
    let inverse = of_rows.try_inverse().expect("positive");
    let (matrix, target) = linear();
    let normal = matrix.transpose() * &inverse * &matrix;
    let expected = normal.lu().solve(&(matrix.transpose() * inverse * &target)).expect("regular");
    let whitening = Whitening::of(&covariance, &rates()).expect("positive");
    let (mut rows, mut aim) = (matrix, target);
    whitening.apply_to_rows(&mut rows, &mut aim);
    let found = rows.svd(true, true).solve(&aim, 1e-12).expect("of full rank");
    assert!((found - expected).amax() < ROUNDING);
}

#[test]
fn a_block_that_is_left_out_is_predicted_from_the_others_and_their_errors() {
    // Oracle: the fit without its rows, and the conditional mean of its error given the others' residuals.
    let whitening = Whitening::of(&shared(), &rates()).expect("positive");
    let by_errors = rate_matrix(&rates(), 18);
    let covariance = &by_errors * shared() * by_errors.transpose();
    let (matrix, target) = linear();
    let (mut rows, mut aim) = (matrix.clone(), target.clone());
    whitening.apply_to_rows(&mut rows, &mut aim);
    let q = rows.clone().qr().q();
    let residual = &aim - &q * q.tr_mul(&aim);
    let by_blocks = whitening.by_blocks(2).expect("positive");
    let (q, residual) = (&by_blocks * q, by_blocks * residual);
    let precision = covariance.clone().try_inverse().expect("positive");
    for block in 0..5 {
        let others: Vec<usize> = (0..10).filter(|row| row / 2 != block).collect();
        let own = [2 * block, 2 * block + 1];
        let (x, y) = (matrix.select_rows(&others), target.select_rows(&others));
        let between = covariance.select_rows(&others).select_columns(&others);
        let inverse = between.try_inverse().expect("positive");
        let normal = x.transpose() * &inverse * &x;
        let fit = normal.lu().solve(&(x.transpose() * &inverse * &y)).expect("regular");
        let from_others = covariance.select_rows(&own).select_columns(&others) * inverse;
        let error = from_others * (y - x * &fit);
        let off = target.select_rows(&own) - matrix.select_rows(&own) * fit - error;
        let weight = precision.view((2 * block, 2 * block), (2, 2)).into_owned();
        let expected = (off.transpose() * weight * off)[(0, 0)];
        let part = q.rows(2 * block, 2);
        let keep = DMatrix::identity(2, 2) - part * part.transpose();
        let found = keep.lu().solve(&residual.rows(2 * block, 2)).expect("regular").norm_squared();
        assert!((found - expected).abs() < ROUNDING * expected, "{block}: {found} {expected}");
    }
}

#[test]
fn an_error_shared_with_the_base_vanishes_given_the_base() {
    // Oracle: an error that all vertebrae have in common vanishes where the base has none.
    let common = DVector::from_element(18, 1.0);
    let tiny = DMatrix::identity(18, 18) * 1e-9;
    let given = given_base(tiny + &common * common.transpose());
    assert!(given.rows(0, 3).amax() == 0.0);
    assert!(given.amax() < 1e-8, "{}", given.amax());
}
