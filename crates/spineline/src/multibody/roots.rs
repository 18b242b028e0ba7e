//! Zeros of a function along a path that is known with its derivative.

/// A place along the path, the value there and its derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    pub at: f64,
    pub value: f64,
    pub rate: f64,
    /// Whether that is the whole derivative; else only its sign near a zero is relied on.
    pub exact: bool,
    /// Whether the value counts as zero.
    pub met: bool,
}

/// Why a zero was not found: the function could not be evaluated, or the search did not end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Lost;

/// A function along a path, and a callback for its zeros.
pub(super) trait Along {
    /// The function at a place; `None` where it cannot be evaluated.
    fn sample(&mut self, at: f64) -> Option<Sample>;

    /// Called for every zero, right after it was sampled, and for every one that was not found; whether the search goes on.
    fn found(&mut self, zero: Result<Sample, Lost>) -> bool;
}

/// Whether the value goes towards zero at first and away from it at last, without a change of sign.
fn turns_within(from: &Sample, to: &Sample) -> bool {
    let sense = (to.at - from.at).signum();
    from.value * from.rate * sense < 0.0 && to.value * to.rate * sense > 0.0
}

/// Where a bracket has no width left, a value that is not below this part of its ends is a jump.
const JUMP: f64 = 1e-6;

/// Newton between two places with values of opposite sign, or the secant where the derivative is not known exactly; by
/// bisection where that leaves the bracket or gains little; nothing where the value jumps.
fn bracketed_root(
    mut low: Sample,
    mut high: Sample,
    guess: f64,
    mut sample: impl FnMut(f64) -> Option<Sample>,
) -> Result<Option<Sample>, Lost> {
    let inside = |at: f64, low: f64, high: f64| (at - low) * (at - high) < 0.0;
    let mut at =
        if inside(guess, low.at, high.at) { guess } else { f64::midpoint(low.at, high.at) };
    let (mut before, mut last) = (f64::INFINITY, high);
    let small = JUMP * low.value.abs().max(high.value.abs());
    for _ in 0..120 {
        let now = sample(at).ok_or(Lost)?;
        if now.met {
            return Ok(Some(now));
        }
        if (high.at - low.at).abs() <= 4.0 * f64::EPSILON * at.abs() {
            // A jump, as of an angle past half a turn, changes the sign and is not a zero.
            return Ok((now.value.abs() <= small).then_some(now));
        }
        if now.value * low.value > 0.0 {
            low = now;
        } else {
            high = now;
        }
        let slope =
            if now.exact { now.rate } else { (now.value - last.value) / (now.at - last.at) };
        let newton = at - now.value / slope;
        last = now;
        let gains = now.value.abs() < 0.5 * before;
        before = now.value.abs();
        at = if gains && inside(newton, low.at, high.at) {
            newton
        } else {
            f64::midpoint(low.at, high.at)
        };
    }
    Err(Lost)
}

/// Where the value turns between two places: bisection on the sign of its derivative.
pub(super) fn turning_point(
    from: &Sample,
    to: &Sample,
    mut sample: impl FnMut(f64) -> Option<Sample>,
) -> Result<Sample, Lost> {
    let (mut low, mut high) = (from.at, to.at);
    let mut turn = *to;
    for _ in 0..30 {
        turn = sample(f64::midpoint(low, high)).ok_or(Lost)?;
        if turn.rate * from.rate > 0.0 {
            low = turn.at;
        } else {
            high = turn.at;
        }
    }
    Ok(turn)
}

/// Every zero between two places that a change of sign shows, or a turn beyond zero, in order.
pub(super) fn zeros_between(from: &Sample, to: &Sample, path: &mut impl Along) {
    if from.value * to.value < 0.0 {
        let guess = to.at - to.value / to.rate;
        let zero = bracketed_root(*from, *to, guess, |at| path.sample(at));
        report(zero, path);
    } else if turns_within(from, to) {
        let turn = match turning_point(from, to, |at| path.sample(at)) {
            Ok(turn) if turn.value * from.value < 0.0 => turn,
            Ok(_) => return,
            Err(lost) => {
                path.found(Err(lost));
                return;
            }
        };
        let middle = f64::midpoint(from.at, turn.at);
        let zero = bracketed_root(*from, turn, middle, |at| path.sample(at));
        if report(zero, path) {
            let middle = f64::midpoint(to.at, turn.at);
            let zero = bracketed_root(turn, *to, middle, |at| path.sample(at));
            report(zero, path);
        }
    }
}

/// Reports the outcome of a search for a zero; whether more are wanted.
fn report(zero: Result<Option<Sample>, Lost>, path: &mut impl Along) -> bool {
    zero.transpose().is_none_or(|zero| path.found(zero))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A function with its derivative, and the zeros that were found.
    struct Recorded<F>(F, bool, Vec<f64>);

    impl<F: Fn(f64) -> (f64, f64)> Along for Recorded<F> {
        fn sample(&mut self, at: f64) -> Option<Sample> {
            let (value, rate) = (self.0)(at);
            Some(Sample { at, value, rate, exact: self.1, met: value.abs() < 1e-12 })
        }

        fn found(&mut self, zero: Result<Sample, Lost>) -> bool {
            self.2.extend(zero.ok().map(|zero| zero.at));
            true
        }
    }

    fn zeros(from: f64, to: f64, function: impl Fn(f64) -> (f64, f64)) -> Vec<f64> {
        zeros_of(from, to, true, function)
    }

    fn zeros_of(from: f64, to: f64, exact: bool, function: impl Fn(f64) -> (f64, f64)) -> Vec<f64> {
        let mut recorded = Recorded(function, exact, Vec::new());
        let (from, to) =
            (recorded.sample(from).expect("a value"), recorded.sample(to).expect("a value"));
        zeros_between(&from, &to, &mut recorded);
        recorded.2
    }

    #[test]
    fn a_rate_that_is_only_nearly_right_leads_to_the_same_zero() {
        // Oracle: x³ - 2 by hand; the rate is off by a third.
        let [root] = zeros_of(0.5, 2.0, false, |x| (x * x * x - 2.0, 2.0 * x * x))[..] else {
            panic!("one zero")
        };
        assert!((root - 2_f64.cbrt()).abs() < 1e-12);
    }

    #[test]
    fn one_zero_or_two_beyond_a_turn_are_found() {
        // Oracle: x³ - 2 and (x - 1)² - 1/4 by hand.
        let [root] = zeros(0.5, 2.0, |x| (x * x * x - 2.0, 3.0 * x * x))[..] else {
            panic!("one zero")
        };
        assert!((root - 2_f64.cbrt()).abs() < 1e-12);
        let both = zeros(0.0, 2.5, |x| ((x - 1.0) * (x - 1.0) - 0.25, 2.0 * (x - 1.0)));
        assert!(both.len() == 2 && (both[0] - 0.5).abs() + (both[1] - 1.5).abs() < 1e-11);
        assert!(zeros(0.0, 2.5, |x| ((x - 1.0) * (x - 1.0) + 0.25, 2.0 * (x - 1.0))).is_empty());
    }

    #[test]
    fn a_jump_across_zero_is_not_a_zero_however_near_its_sides() {
        // Oracle: these functions have no zero.
        for (before, after) in [(3.0, -3.0), (0.5, -0.4), (1e-3, -1e-3)] {
            let jump = move |x: f64| {
                if x < 1.0 {
                    (before + 2.0 * (1.0 - x), -2.0)
                } else {
                    (after - 2.0 * (x - 1.0), -2.0)
                }
            };
            assert!(zeros(0.0, 2.3, jump).is_empty(), "{before} to {after}");
        }
    }
}
