use nalgebra::{DMatrix, DMatrixView, DVector, Matrix3, Vector3};

use super::series::{Series, for_each_basis};
use super::{Curve, CurveFit, CurveForm, MIN_TURN, find_inflections};
use crate::anatomy::{FilmView, Posture};
use crate::fault::{ErrorPlace, faults};
use crate::measure::{ErrorRate, Measured, MeasuredVertebra, Outline, Whitening};
use crate::spatial::{Angle, Frontal};
use crate::warning::{WarningCode, Warnings};

/// How the order of the polynomial is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OrderRule {
    /// The smallest order with an error on left-out vertebrae within 5 % of the best.
    #[default]
    LeaveOneOut,
    /// The paper's: the least residual of locations and tilts. The highest order nearly always has it.
    Paper,
    /// The least residual among the orders that give exactly two inflections; without such an order, the rule of [`Self::LeaveOneOut`]
    /// and a warning.
    TwoInflections,
    /// A given order, 4 to 12.
    Fixed(usize),
}

impl OrderRule {
    /// The name used in files: `leave_one_out`, `paper`, `two_inflections`, or the order.
    #[must_use]
    pub fn key(self) -> String {
        match self {
            Self::LeaveOneOut => "leave_one_out".to_owned(),
            Self::Paper => "paper".to_owned(),
            Self::TwoInflections => "two_inflections".to_owned(),
            Self::Fixed(order) => order.to_string(),
        }
    }
}

const ORDER_HELP: &str = "use an order from 4 to 12, or `leave-one-out`";

faults! {
    /// A curve that cannot be fitted.
    pub enum CurveError {
        /// An order outside of 4…12.
        #[error("polynomial order {order} is outside of {} to {limit}", ORDERS.start())]
        #[code("curve_order")]
        #[help(ORDER_HELP)]
        #[at(value = *order as f64, limit = ErrorPlace::limit(*order as f64, *ORDERS.start() as f64, *limit as f64))]
        Order {
            /// The requested value.
            order: usize,
            /// The largest for the vertebrae of the film: 12 where all are marked.
            limit: usize,
        },
        /// The equations of the fit are singular.
        #[error("{posture} film: these vertebrae do not determine a polynomial of order {order}")]
        #[code("curve_singular")]
        #[help(ORDER_HELP)]
        #[at(film = FilmView::from(*posture), value = *order as f64)]
        Singular {
            posture: Posture,
            /// Order tried.
            order: usize,
        },
    }
}

/// Films marked by hand stay below this by far (about 3° in the median).
const POOR_TILT: Angle = Angle::from_deg(10.0);
const ORDERS: std::ops::RangeInclusive<usize> = 4..=12;
/// The highest order is lower than the number of vertebrae by this number: a complete film has 15 vertebrae and orders up to 12.
const VERTEBRAE_ABOVE_ORDER: usize = 3;
/// Beyond this tilt the slope dy/dz says too little.
const GRAPH_LIMIT: Angle = Angle::from_deg(70.0);

/// Fits a curve to the measured vertebrae of one film: weighted least squares on locations and tilts, from L4 to T2, in `G`.
///
/// # Errors
/// [`CurveError`]: an order out of range, or vertebrae that do not determine a polynomial of the order.
///
/// ```
/// use spineline::curve::{OrderRule, fit_curve};
/// use spineline::measure::{TiltRule, measure_film};
/// use spineline::warning::Warnings;
/// use spineline_phantom::{Readers, Scenario, generate};
///
/// let case = generate(0, Scenario::Bend, &Readers::exact(), 1)?.case;
/// let mut warnings = Warnings::default();
/// let outline = measure_film(&case.films[0], TiltRule::default(), &mut warnings)?;
/// let fit = fit_curve(&outline, OrderRule::LeaveOneOut, &mut warnings)?;
/// assert!(fit.rmse_mm < 5.0);
/// // The parameter runs from L4 to T2.
/// let length_mm = fit.curve.length_mm(fit.curve.end_mm());
/// assert!(length_mm > outline.polygon_mm() - 5.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_curve(
    outline: &Outline,
    rule: OrderRule,
    warnings: &mut Warnings,
) -> Result<CurveFit, CurveError> {
    let form = if outline.vertebrae.iter().any(|v| v.tilt.abs() > GRAPH_LIMIT) {
        let text = "a tilt beyond 70°: the curve is fitted in parametric form";
        warnings.film(WarningCode::ParametricCurve, outline.posture, text);
        CurveForm::Parametric
    } else {
        CurveForm::Graph
    };
    let fit = fit_by_rule(outline, form, rule, warnings)?;
    if fit.rmse_tilt > POOR_TILT {
        let text = format!(
            "the tilts differ by {} from the curve through the locations: check their sign (positive is to the patient's right) and their unit (degrees)",
            fit.rmse_tilt
        );
        warnings.film(WarningCode::TiltsDisagreeWithLocations, outline.posture, text);
    }
    Ok(fit)
}

fn fit_by_rule(
    outline: &Outline,
    form: CurveForm,
    rule: OrderRule,
    warnings: &mut Warnings,
) -> Result<CurveFit, CurveError> {
    let by_leaving_out =
        || fit_order(outline, form, best_left_out(&left_out_errors(outline, form)?));
    let all = || -> Result<Vec<CurveFit>, CurveError> {
        orders_of(outline).map(|order| fit_order(outline, form, order)).collect()
    };
    match rule {
        OrderRule::Fixed(order) if orders_of(outline).contains(&order) => {
            fit_order(outline, form, order)
        }
        OrderRule::Fixed(order) => {
            Err(CurveError::Order { order, limit: *orders_of(outline).end() })
        }
        OrderRule::LeaveOneOut => by_leaving_out(),
        OrderRule::Paper => Ok(least_residual(outline, all()?).expect("a film has an order")),
        OrderRule::TwoInflections => {
            let mut fits = all()?;
            fits.retain(|fit| find_inflections(fit, MIN_TURN).all.len() == 2);
            if let Some(fit) = least_residual(outline, fits) {
                return Ok(fit);
            }
            let text = format!(
                "no order from {} to {} gives exactly two inflections; the order is chosen by leaving vertebrae out",
                ORDERS.start(),
                orders_of(outline).end()
            );
            warnings.film(WarningCode::NoOrderWithTwoInflections, outline.posture, text);
            by_leaving_out()
        }
    }
}

/// Error of every order on vertebrae that were left out of its fit.
///
/// The basis of an order begins with the basis of the order below, so that one factorisation of the highest order serves all.
fn left_out_errors(outline: &Outline, form: CurveForm) -> Result<Vec<(usize, f64)>, CurveError> {
    if form == CurveForm::Parametric {
        // Two coordinates are side by side there, and the columns of an order are not the first ones of the next.
        return orders_of(outline)
            .map(|order| fit_order(outline, form, order).map(|fit| (order, fit.left_out)))
            .collect();
    }
    let t_mm = parameters_mm(outline, form);
    let orders = orders_of(outline);
    let rows = graph_rows(outline, &t_mm, orders.end() - 1);
    let (q, r) = rows.matrix.clone().qr().unpack();
    let mut residual = rows.target.clone();
    let mut errors = Vec::new();
    let by_blocks = rows.by_blocks();
    let q_by_blocks = by_blocks.as_ref().map(|by_blocks| by_blocks * &q);
    for order in 2..=*orders.end() {
        let column = q.column(order - 2);
        if r[(order - 2, order - 2)] == 0.0 {
            let order = order.max(*ORDERS.start());
            return Err(CurveError::Singular { posture: outline.posture, order });
        }
        residual.axpy(-column.dot(&rows.target), &column, 1.0);
        if orders.contains(&order) {
            let error = match by_blocks.as_ref().zip(q_by_blocks.as_ref()) {
                None => left_out_error(rows.block, &q.columns(0, order - 1), &residual),
                Some((by_blocks, q)) => {
                    left_out_error(rows.block, &q.columns(0, order - 1), &(by_blocks * &residual))
                }
            };
            errors.push((order, error));
        }
    }
    Ok(errors)
}

/// The order of the least error on vertebrae left out.
fn best_left_out(errors: &[(usize, f64)]) -> usize {
    let best = errors.iter().map(|(_, error)| *error).fold(f64::INFINITY, f64::min);
    // Differences below a thousandth of the noise are not evidence for a higher order.
    let good = errors.iter().find(|(_, error)| *error <= 1.05 * best + 1e-3);
    good.expect("the best is one of them").0
}

/// The fit with the least residual of locations and tilts, each over its noise.
fn least_residual(outline: &Outline, fits: Vec<CurveFit>) -> Option<CurveFit> {
    let combined = |fit: &CurveFit| {
        fit.rmse_mm / outline.noise.location_mm + fit.rmse_tilt.rad() / outline.noise.tilt.rad()
    };
    fits.into_iter().min_by(|a, b| combined(a).total_cmp(&combined(b)))
}

/// The weighted rows of the fit: `matrix · coefficients ≈ target`, in blocks of one vertebra each. Where vertebrae share errors, they are
/// mixed to independent rows.
pub(super) struct Rows {
    pub matrix: DMatrix<f64>,
    pub target: DVector<f64>,
    block: usize,
    whitening: Option<Whitening>,
}

impl Rows {
    fn whitened(mut self, whitening: Option<Whitening>) -> Self {
        if let Some(whitening) = &whitening {
            whitening.apply_to_rows(&mut self.matrix, &mut self.target);
        }
        Self { whitening, ..self }
    }

    /// From these mixed rows to rows of one vertebra each; `None` if the rows are not mixed.
    fn by_blocks(&self) -> Option<DMatrix<f64>> {
        self.whitening.as_ref()?.by_blocks(self.block)
    }
}

pub(super) fn weighted_rows(
    outline: &Outline,
    form: CurveForm,
    t_mm: &[f64],
    order: usize,
) -> Rows {
    match form {
        CurveForm::Graph => graph_rows(outline, t_mm, order - 1),
        CurveForm::Parametric => parametric_rows(outline, t_mm, order - 1),
    }
}

fn fit_order(outline: &Outline, form: CurveForm, order: usize) -> Result<CurveFit, CurveError> {
    let singular = CurveError::Singular { posture: outline.posture, order };
    let terms = order - 1;
    let t_mm = parameters_mm(outline, form);
    let end_mm = t_mm[t_mm.len() - 1];
    let rows = weighted_rows(outline, form, &t_mm, order);
    let qr = rows.matrix.clone().qr();
    let q = qr.q();
    let solution =
        qr.r().solve_upper_triangular(&(q.transpose() * &rows.target)).ok_or(singular)?;
    let coefficients = solution.as_slice();
    let curve = Curve {
        form,
        y: Series::new(end_mm, coefficients[..terms].to_vec()),
        z: match form {
            CurveForm::Graph => Series::zero(end_mm),
            CurveForm::Parametric => Series::new(end_mm, coefficients[terms..].to_vec()),
        },
        end_mm,
    };
    let residual = &rows.target - &rows.matrix * &solution;
    let left_out = match rows.by_blocks() {
        None => left_out_error(rows.block, &q.columns(0, q.ncols()), &residual),
        Some(by_blocks) => {
            let q = &by_blocks * q;
            left_out_error(rows.block, &q.columns(0, q.ncols()), &(by_blocks * &residual))
        }
    };
    // L4 is met by construction and does not count.
    let count = outline.measured().count() - 1;
    let mean_square = |squares: f64| (squares / count as f64).sqrt();
    let (mut off_mm2, mut off_rad2) = (0.0, 0.0);
    for (vertebra, t) in outline.measured().map(|(i, vertebra)| (vertebra, t_mm[i])) {
        off_mm2 += vertebra.location.distance_mm(curve.point(t)).powi(2);
        off_rad2 += (vertebra.tilt - curve.tilt(t)).wrapped().rad().powi(2);
    }
    Ok(CurveFit {
        curve,
        order,
        rmse_mm: mean_square(off_mm2),
        rmse_tilt: Angle::from_rad(mean_square(off_rad2)),
        left_out,
        vertebra_t_mm: t_mm,
        levels: outline.levels(),
    })
}

/// Height of every vertebra, or the chord length up to it.
fn parameters_mm(outline: &Outline, form: CurveForm) -> Vec<f64> {
    match form {
        CurveForm::Graph => outline.locations().map(|location| location.z_mm).collect(),
        CurveForm::Parametric => {
            let mut length = 0.0;
            let mut before = Frontal::default();
            outline
                .locations()
                .map(|location| {
                    length += location.distance_mm(before);
                    before = location;
                    length
                })
                .collect()
        }
    }
}

/// The vertebrae that have rows, with their parameters: L4 is met exactly by the basis, and interpolated ones say nothing.
fn measured_above_base<'a>(outline: &'a Outline, t_mm: &[f64]) -> Vec<(&'a MeasuredVertebra, f64)> {
    outline.measured().skip(1).map(|(i, vertebra)| (vertebra, t_mm[i])).collect()
}

/// The orders that the marked vertebrae of a film may determine.
fn orders_of(outline: &Outline) -> std::ops::RangeInclusive<usize> {
    let most = outline.measured().count().saturating_sub(VERTEBRAE_ABOVE_ORDER);
    *ORDERS.start()..=most.clamp(*ORDERS.start(), *ORDERS.end())
}

fn graph_rows(outline: &Outline, t_mm: &[f64], terms: usize) -> Rows {
    let end_mm = t_mm[t_mm.len() - 1];
    let measured = measured_above_base(outline, t_mm);
    let mut matrix = DMatrix::zeros(2 * measured.len(), terms);
    let mut target = DVector::zeros(2 * measured.len());
    for (i, (vertebra, t)) in measured.into_iter().enumerate() {
        let noise = outline.noise_of(vertebra);
        let slope = -vertebra.tilt.rad().tan();
        let slope_sd = noise.tilt.rad() * (1.0 + slope * slope);
        target[2 * i] = vertebra.location.y_mm / noise.location_mm;
        target[2 * i + 1] = slope / slope_sd;
        for_each_basis(end_mm, t, terms, |k, [value, derivative, _]| {
            matrix[(2 * i, k)] = value / noise.location_mm;
            matrix[(2 * i + 1, k)] = derivative / slope_sd;
        });
    }
    let rates = error_rates(outline, &[Measured::Left, Measured::Tilt]);
    let rows = Rows { matrix, target, block: 2, whitening: None };
    rows.whitened(outline.whitening_given_base(&rates))
}

fn parametric_rows(outline: &Outline, t_mm: &[f64], terms: usize) -> Rows {
    let end_mm = t_mm[t_mm.len() - 1];
    let measured = measured_above_base(outline, t_mm);
    let mut matrix = DMatrix::zeros(3 * measured.len(), 2 * terms);
    let mut target = DVector::zeros(3 * measured.len());
    for (i, (vertebra, t)) in measured.into_iter().enumerate() {
        // The tangent has no component across the measured axis: cos θ y' + sin θ (1 + z') = 0.
        let noise = outline.noise_of(vertebra);
        let (sin, cos) = vertebra.tilt.rad().sin_cos();
        target[3 * i] = vertebra.location.y_mm / noise.location_mm;
        target[3 * i + 1] = (vertebra.location.z_mm - t) / noise.location_mm;
        target[3 * i + 2] = -sin / noise.tilt.rad();
        for_each_basis(end_mm, t, terms, |k, [value, derivative, _]| {
            matrix[(3 * i, k)] = value / noise.location_mm;
            matrix[(3 * i + 1, terms + k)] = value / noise.location_mm;
            matrix[(3 * i + 2, k)] = cos * derivative / noise.tilt.rad();
            matrix[(3 * i + 2, terms + k)] = sin * derivative / noise.tilt.rad();
        });
    }
    let rates = error_rates(outline, &[Measured::Left, Measured::Cranial, Measured::Tilt]);
    let rows = Rows { matrix, target, block: 3, whitening: None };
    rows.whitened(outline.whitening_given_base(&rates))
}

/// How the rows of these numbers of all vertebrae above the base change with their errors. A tilt error turns the slope, and the tangent
/// across the axis, the other way.
fn error_rates(outline: &Outline, measured: &[Measured]) -> Vec<ErrorRate> {
    let of_vertebra = |(place, vertebra): (usize, &MeasuredVertebra)| {
        let noise = outline.noise_of(vertebra);
        let rate = move |of: &Measured| match of {
            Measured::Left | Measured::Cranial => (place, *of, 1.0 / noise.location_mm),
            Measured::Tilt => (place, *of, -1.0 / noise.tilt.rad()),
        };
        measured.iter().map(rate).collect::<Vec<_>>()
    };
    outline.measured().skip(1).flat_map(of_vertebra).collect()
}

/// Root mean square of the residuals of left-out vertebrae: `(I - H_ii)⁻¹ r_i` per block. Where vertebrae share errors, the errors
/// of the others predict a part of each error, and `H` and `r` are in units of the remaining error ([`Whitening::by_blocks`]).
///
/// T2 takes no part: without it, high orders would be judged by their values outside of the spine, which nothing uses.
fn left_out_error(size: usize, q: &DMatrixView<'_, f64>, residual: &DVector<f64>) -> f64 {
    let blocks = residual.len() / size - 1;
    let squared_error = |block: usize| {
        let first = block * size;
        // Blocks of two rows get a row of zeros.
        let own = |rows: &dyn Fn(usize) -> f64| {
            Vector3::from_fn(|i, _| if i < size { rows(first + i) } else { 0.0 })
        };
        let mut keep = Matrix3::identity();
        for column in q.column_iter() {
            let row = own(&|i| column[i]);
            keep -= row * row.transpose();
        }
        // A vertebra that alone determines a coefficient cannot be predicted at all.
        let error = keep.lu().solve(&own(&|i| residual[i]));
        error.map_or(f64::INFINITY, |error| error.norm_squared())
    };
    let total: f64 = (0..blocks).map(squared_error).sum();
    (total / (blocks * size) as f64).sqrt()
}
