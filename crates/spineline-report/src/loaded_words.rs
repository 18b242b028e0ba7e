//! Numbers before and under loads as text: sides, never signs.

use spineline::clinical::convex_side;
use spineline::number::fixed;
use spineline::response::{LoadedMeasure, LoadedQuantity, LoadedState};
use spineline::spatial::{Angle, sideways_words};
use spineline::uncertainty::LoadedUncertainty;

/// Erect, under the loads, and the change; empty without a number.
pub(crate) fn measure_words(measure: &LoadedMeasure) -> [String; 3] {
    let words = |value: Option<f64>| value.map(|value| value_words(measure.quantity, value));
    let is_size = measure.quantity.region().is_some();
    let change = match (measure.erect, measure.loaded) {
        (Some(erect), Some(loaded)) if is_size => Some(size_change_words(erect, loaded)),
        _ => words(measure.value(LoadedState::Change)),
    };
    [words(measure.erect), words(measure.loaded), change].map(Option::unwrap_or_default)
}

fn value_words(quantity: LoadedQuantity, value: f64) -> String {
    let angle = Angle::from_deg(value);
    match quantity {
        LoadedQuantity::Cobb(_) | LoadedQuantity::TiltRange(_) | LoadedQuantity::Ferguson(_) => {
            let side = convex_side(angle).filter(|_| angle.shown_side().is_some());
            let side = side.map_or_else(String::new, |side| format!(" convex {side}"));
            format!("{}{side}", angle.abs())
        }
        LoadedQuantity::LateralTilt | LoadedQuantity::TopTilt => angle.leaning(),
        LoadedQuantity::TopOffset | LoadedQuantity::CoronalBalance => sideways_words(value),
        LoadedQuantity::Factor => fixed(value, 6),
    }
}

/// A curve has a size, which increases or decreases.
fn size_change_words(erect_deg: f64, loaded_deg: f64) -> String {
    if erect_deg * loaded_deg < 0.0 {
        return "reversed".to_owned();
    }
    let more_deg = loaded_deg.abs() - erect_deg.abs();
    let size = size_words(more_deg);
    match more_deg {
        _ if size == size_words(0.0) => size,
        less if less < 0.0 => format!("{size} less"),
        _ => format!("{size} more"),
    }
}

fn size_words(deg: f64) -> String {
    Angle::from_deg(deg).abs().to_string()
}

/// The 95 % interval of the number above it, such as `12.1° to 14.0°`; empty without one. It names its side where the number has
/// another side.
///
/// The change of a curve is the change of its size, in the direction of the erect curve.
pub(crate) fn interval_words(
    found: &LoadedUncertainty,
    quantity: LoadedQuantity,
    state: LoadedState,
    number: &str,
) -> String {
    let interval = |state| found.of(quantity, state).and_then(|number| number.interval_95());
    let Some([low, high]) = interval(state) else { return String::new() };
    let is_size_change = quantity.region().is_some() && state == LoadedState::Change;
    let erect = found.of(quantity, LoadedState::Erect).and_then(|number| number.nominal);
    let (low, high) = match erect {
        Some(erect) if is_size_change && erect < 0.0 => (-high, -low),
        _ => (low, high),
    };
    let [below, above] = match quantity {
        _ if is_size_change => [" less", " more"],
        LoadedQuantity::Cobb(_) | LoadedQuantity::TiltRange(_) | LoadedQuantity::Ferguson(_) => {
            [" convex right", " convex left"]
        }
        LoadedQuantity::LateralTilt | LoadedQuantity::TopTilt => [" left", " right"],
        LoadedQuantity::TopOffset | LoadedQuantity::CoronalBalance => [" right", " left"],
        LoadedQuantity::Factor => ["", ""],
    };
    let (unit, size): (_, &dyn Fn(f64) -> String) = match quantity {
        LoadedQuantity::Factor => ("", &|value| fixed(value, 4)),
        LoadedQuantity::TopOffset | LoadedQuantity::CoronalBalance => {
            (" mm", &|mm| fixed(mm.abs(), 1))
        }
        _ => ("", &size_words),
    };
    // A value that is written as zero has no side.
    let [low, high] = [low, high].map(|end| if size(end) == size(0.0) { 0.0 } else { end });
    if low == 0.0 && high == 0.0 {
        return format!("{} to {}{unit}", size(0.0), size(0.0));
    }
    if low < 0.0 && high > 0.0 {
        return format!("{}{unit}{below} to {}{unit}{above}", size(low), size(high));
    }
    // The smaller size first; a factor has its sign.
    let is_below = low < 0.0 && quantity != LoadedQuantity::Factor;
    let (ends, side) = if is_below { ([high, low], below) } else { ([low, high], above) };
    let side = if number.ends_with(side) { "" } else { side };
    format!("{} to {}{unit}{side}", size(ends[0]), size(ends[1]))
}

#[cfg(test)]
mod tests {
    use spineline::anatomy::Region;
    use spineline::uncertainty::{LoadedSpread, Spread};

    use super::*;

    const COBB: LoadedQuantity = LoadedQuantity::Cobb(Region::MainThoracic);

    /// The interval below a number without a side.
    fn found(quantity: LoadedQuantity, erect: f64, state: LoadedState, ends: [f64; 2]) -> String {
        below("", quantity, erect, state, ends)
    }

    fn below(
        number: &str,
        quantity: LoadedQuantity,
        erect: f64,
        state: LoadedState,
        ends: [f64; 2],
    ) -> String {
        let [low, high] = ends;
        let quantiles = [low, low, (low + high) / 2.0, high, high];
        let spread = Some(Spread { mean: low, sd: Some(1.0), quantiles });
        let count = Spread::MIN_COUNT;
        let one = |state, nominal| LoadedSpread { quantity, state, nominal, count, spread };
        let found = LoadedUncertainty {
            seed: 1,
            requested: count,
            done: count,
            usable: count,
            endings: Vec::new(),
            noise: Vec::new(),
            numbers: vec![one(LoadedState::Erect, Some(erect)), one(state, None)],
        };
        interval_words(&found, quantity, state, number)
    }

    #[test]
    fn an_interval_has_a_side_or_two() {
        let loaded = LoadedState::Loaded;
        assert_eq!(found(COBB, 30.0, loaded, [20.0, 22.5]), "20.0° to 22.5° convex left");
        assert_eq!(found(COBB, -30.0, loaded, [-22.5, -20.0]), "20.0° to 22.5° convex right");
        assert_eq!(found(COBB, 30.0, loaded, [-1.0, 2.0]), "1.0° convex right to 2.0° convex left");
        assert_eq!(found(COBB, 30.0, loaded, [-0.01, 2.0]), "0.0° to 2.0° convex left");
        assert_eq!(value_words(COBB, 0.01), "0.0°");
        let offset = LoadedQuantity::TopOffset;
        assert_eq!(found(offset, 0.0, loaded, [-3.0, -1.0]), "1.0 to 3.0 mm right");
        let tilt = LoadedQuantity::LateralTilt;
        assert_eq!(found(tilt, 0.0, loaded, [1.0, 3.0]), "1.0° to 3.0° right");
        assert_eq!(found(LoadedQuantity::Factor, 0.0, loaded, [-1.5, -1.0]), "−1.5000 to −1.0000");
    }

    #[test]
    fn the_side_of_the_number_above_is_not_repeated() {
        let loaded = LoadedState::Loaded;
        let cobb = |number, ends| below(number, COBB, 30.0, loaded, ends);
        assert_eq!(cobb("21.0° convex left", [20.0, 22.5]), "20.0° to 22.5°");
        assert_eq!(cobb("0.1° convex right", [0.2, 2.5]), "0.2° to 2.5° convex left");
        assert_eq!(cobb("1.0° convex left", [-0.5, 2.5]), "0.5° convex right to 2.5° convex left");
        let offset = |number, ends| below(number, LoadedQuantity::TopOffset, 0.0, loaded, ends);
        assert_eq!(offset("2.0 mm right", [-3.0, -1.0]), "1.0 to 3.0 mm");
        assert_eq!(offset("2.0 mm right", [-3.0, 1.0]), "3.0 mm right to 1.0 mm left");
    }

    #[test]
    fn a_curve_gets_less_whatever_its_side() {
        let change = LoadedState::Change;
        // 30° convex left to 25° or 27°, and the mirror image.
        assert_eq!(found(COBB, 30.0, change, [-5.0, -3.0]), "3.0° to 5.0° less");
        assert_eq!(found(COBB, -30.0, change, [3.0, 5.0]), "3.0° to 5.0° less");
        assert_eq!(found(COBB, -30.0, change, [-1.0, 2.0]), "2.0° less to 1.0° more");
    }

    #[test]
    fn changes_of_a_size_are_words() {
        assert_eq!(size_change_words(-30.0, -27.5), "2.5° less");
        assert_eq!(size_change_words(30.0, 31.0), "1.0° more");
        assert_eq!(size_change_words(3.0, -1.0), "reversed");
    }

    #[test]
    fn a_written_zero_has_no_side() {
        assert_eq!(size_change_words(30.0, 30.01), "0.0°");
        assert_eq!(size_change_words(30.0, 29.99), "0.0°");
        let change = LoadedState::Change;
        assert_eq!(below("0.0°", COBB, 30.0, change, [-0.01, 0.02]), "0.0° to 0.0°");
        assert_eq!(below("0.0°", COBB, 30.0, change, [0.01, 0.2]), "0.0° to 0.2° more");
        let offset = LoadedQuantity::TopOffset;
        assert_eq!(found(offset, 0.0, change, [0.01, 0.02]), "0.0 to 0.0 mm");
    }
}
