//! Effect of landmark noise on a personalised model under loads.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::anatomy::Posture;
use spineline::measure::CornerName;
use spineline::multibody::{
    BodyLoad, GeneralStatics, Goal, LoadItem, Loading, Rod, Support, Timing,
};
use spineline::response::{
    LoadedMeasure, LoadedQuantity, LoadedState, Response, go_on, loaded_measures, respond,
    usual_limit,
};
use spineline::spatial::{Angle, Vec3};
use spineline::uncertainty::{AppliedLoads, LandmarkNoise, LoadedUncertainty, MonteCarlo, Spread};
use spineline_phantom::{Readers, Scenario};

use crate::common::{all_landmarks, assert_near, phantom};

/// Place of the uppermost vertebra in the model.
const TOP: usize = 14;
/// As many replicates as an interval needs.
const MANY: u64 = Spread::MIN_COUNT;

/// Erect film and one bend, read once without an error, with tilts by the corners alone.
fn two_films() -> Case {
    let mut case = phantom(2, Scenario::Rod, &Readers::exact()).case;
    case.films.retain(|film| matches!(film.posture, Posture::Erect | Posture::LeftBending));
    for film in &mut case.films {
        all_landmarks(film).for_each(|body| body.axis_clockwise = None);
    }
    case
}

fn analysed(case: &Case) -> Analysis {
    analyze(case, &AnalysisOptions::default()).expect("a sound case")
}

fn force(force_n: Vec3) -> Loading {
    Loading::single(TOP, BodyLoad::at_midpoint(force_n))
}

/// A push at T2 to the patient's left.
fn push() -> Loading {
    force(Vec3::new(0.0, 15.0, 0.0))
}

fn loads(loading: &Loading, goal: Goal) -> AppliedLoads<'_> {
    let (kind, support) = (LineKind::Inflection, Support::Free);
    AppliedLoads { kind, support, loading, goal, largest_factor: None }
}

/// The model of an analysis under loads, step by step.
fn response(analysis: &Analysis, loads: &AppliedLoads<'_>) -> Response {
    let model = analysis.model(loads.kind).expect("a model");
    let springs = model.stiffness_matrices(&analysis.movement.library);
    let limit = usual_limit(&analysis.movement.spine, &springs, loads.loading, loads.goal);
    let statics =
        GeneralStatics::new(&analysis.movement.spine, springs, loads.support).expect("springs");
    respond(&statics, loads.loading, loads.goal, limit, &mut go_on).expect("sound loads")
}

fn measured(analysis: &Analysis, loads: &AppliedLoads<'_>) -> Vec<LoadedMeasure> {
    let film = &analysis.movement.erect().outline;
    let found = response(analysis, loads);
    loaded_measures(&analysis.movement.spine, &analysis.movement.curve_places(), Some(film), &found)
}

fn value(measures: &[LoadedMeasure], quantity: LoadedQuantity, state: LoadedState) -> f64 {
    let measure = measures.iter().find(|measure| measure.quantity == quantity);
    measure.and_then(|measure| measure.value(state)).expect("it is measured")
}

fn told(
    monte_carlo: &MonteCarlo<'_>,
    loads: &AppliedLoads<'_>,
    nominal: &[LoadedMeasure],
    count: u64,
) -> LoadedUncertainty {
    let mut tally = monte_carlo.loaded_tally(nominal);
    (0..count).for_each(|index| tally.add(&monte_carlo.loaded_replicate(index, loads)));
    tally.finish(count)
}

fn run(case: &Case, noise_px: f64, loads: &AppliedLoads<'_>, count: u64) -> LoadedUncertainty {
    let nominal = analysed(case);
    let noise = LandmarkNoise::Pixels(noise_px);
    let monte_carlo = MonteCarlo::new(case, &nominal, noise, 3).expect("sound noise");
    told(&monte_carlo, loads, &measured(&nominal, loads), count)
}

#[test]
fn without_noise_every_interval_is_the_number_of_the_simulation() {
    // Oracle: the simulation of the case itself.
    let case = phantom(3, Scenario::Rod, &Readers::default()).case;
    let nominal = analysed(&case);
    let noise = LandmarkNoise::Pixels(0.0);
    let monte_carlo = MonteCarlo::new(&case, &nominal, noise, 1).expect("sound noise");
    let loading = push();
    for goal in [Goal::FullLoad, Goal::LateralTilt(Angle::from_deg(-8.0))] {
        let loads = loads(&loading, goal);
        let measures = measured(&nominal, &loads);
        let found = told(&monte_carlo.clone().searching_anew(), &loads, &measures, MANY);
        assert_eq!((found.done, found.usable), (MANY, MANY));
        // Sizes and Ferguson angles of three curves, two tilts, offset and balance, each in three states.
        let factor = usize::from(goal != Goal::FullLoad);
        assert_eq!(found.numbers.len(), 3 * 10 + factor, "{:?}", found.numbers);
        for number in &found.numbers {
            let nominal = number.nominal.expect("the simulation has it");
            assert_eq!(nominal, value(&measures, number.quantity, number.state));
            assert_eq!(number.interval_95(), Some([nominal; 2]), "{:?}", number.quantity);
            assert_eq!(number.spread.expect("replicates").sd, Some(0.0));
        }
        // From the minima of the case, as replicates are computed: off by the tolerance of a fit.
        let found = told(&monte_carlo, &loads, &measures, MANY);
        for number in &found.numbers {
            let [low, high] = number.interval_95().expect("replicates");
            let nominal = number.nominal.expect("the simulation has it");
            assert_eq!(low, high);
            assert_near(low, nominal, 1e-4, number.quantity.key());
        }
    }
}

/// Of one number, the derivatives by every coordinate of every corner of a case, by central differences.
fn derivatives(case: &Case, of: impl Fn(&Analysis) -> [f64; 3]) -> Vec<[f64; 3]> {
    const STEP_PX: f64 = 0.02;
    let mut all = Vec::new();
    for film in 0..case.films.len() {
        for &level in case.films[film].landmarks.corner_readings()[0].vertebrae.keys() {
            for corner in CornerName::ALL {
                for is_column in [true, false] {
                    let moved = |by_px: f64| {
                        let mut case = case.clone();
                        let readings = case.films[film].landmarks.corner_readings_mut();
                        let body = readings[0].vertebrae.get_mut(&level).expect("a vertebra");
                        let place = corner.of_mut(&mut body.corners);
                        if is_column {
                            place.column_px += by_px;
                        } else {
                            place.row_px += by_px;
                        }
                        of(&analysed(&case))
                    };
                    let (up, down) = (moved(STEP_PX), moved(-STEP_PX));
                    all.push([0, 1, 2].map(|i| (up[i] - down[i]) / (2.0 * STEP_PX)));
                }
            }
        }
    }
    all
}

#[test]
fn the_standard_deviation_for_small_noise_matches_finite_differences() {
    // Oracle: linear propagation through a new analysis and simulation for each moved coordinate of a corner.
    let (sd_px, count) = (0.02, 400);
    let case = two_films();
    let loading = push();
    let loads = loads(&loading, Goal::FullLoad);
    let numbers = [
        (LoadedQuantity::TopOffset, LoadedState::Loaded),
        (LoadedQuantity::TopOffset, LoadedState::Change),
        (LoadedQuantity::TopTilt, LoadedState::Loaded),
    ];
    let of = |analysis: &Analysis| {
        let measures = measured(analysis, &loads);
        numbers.map(|(quantity, state)| value(&measures, quantity, state))
    };
    let slopes = derivatives(&case, of);
    let found = run(&case, sd_px, &loads, count);
    assert_eq!(found.usable, count);
    // Monte Carlo's own error of a deviation is one part in √(2n); four of these.
    let limit = 4.0 / (2.0 * count as f64).sqrt();
    for (place, (quantity, state)) in numbers.into_iter().enumerate() {
        let squares: f64 = slopes.iter().map(|slope| (slope[place] * sd_px).powi(2)).sum();
        let right = squares.sqrt();
        let spread = found.of(quantity, state).and_then(|number| number.spread);
        let sd = spread.and_then(|spread| spread.sd).expect("it is there");
        assert!((sd / right - 1.0).abs() < limit, "{quantity:?}, {state:?}: {sd} {right}");
    }
}

#[test]
fn a_rod_that_prescribes_the_top_leaves_no_spread_of_the_change() {
    // Oracle: the pose that the rod prescribes, 10 mm to the left and 5° to the right of the erect one, whatever the springs are.
    let turn = Angle::from_deg(5.0);
    let rod = Rod {
        inferior: 0,
        superior: TOP,
        shift_mm: Vec3::new(0.0, 10.0, 0.0),
        turn_rad: Vec3::new(-turn.rad(), 0.0, 0.0),
        timing: Timing::Proportional,
    };
    let loading = Loading { items: Vec::new(), rods: vec![rod] };
    let found = run(&two_films(), 2.0, &loads(&loading, Goal::FullLoad), 2 * MANY);
    assert!(found.usable >= MANY, "{:?}", found.endings);
    let number = |state| found.of(LoadedQuantity::TopOffset, state).expect("it is measured");
    let [low, high] = number(LoadedState::Change).interval_95().expect("replicates");
    assert_near(low, 10.0, 1e-6, "low end");
    assert_near(high, 10.0, 1e-6, "high end");
    let sd = |state| number(state).spread.and_then(|spread| spread.sd).expect("replicates");
    assert!(sd(LoadedState::Erect) > 0.1, "{}", sd(LoadedState::Erect));
    assert_near(sd(LoadedState::Loaded), sd(LoadedState::Erect), 1e-6, "deviation");
}

#[test]
fn replicates_under_loads_are_the_same_in_any_order_and_on_any_thread() {
    let case = phantom(0, Scenario::Bend, &Readers::default()).case;
    let nominal = analysed(&case);
    let monte_carlo =
        MonteCarlo::new(&case, &nominal, LandmarkNoise::Measured, 7).expect("sound noise");
    let loading = push();
    let loads = loads(&loading, Goal::FullLoad);
    let measures = measured(&nominal, &loads);
    let one_by_one = told(&monte_carlo, &loads, &measures, 6);
    let replicates = std::thread::scope(|scope| {
        let halves = [[5, 3, 1], [0, 4, 2]].map(|part| {
            let (monte_carlo, loads) = (&monte_carlo, &loads);
            scope.spawn(move || part.map(|i| (i, monte_carlo.loaded_replicate(i, loads))))
        });
        let mut all: Vec<_> = halves.into_iter().flat_map(|t| t.join().expect("ends")).collect();
        all.sort_by_key(|(index, _)| *index);
        all
    });
    let mut tally = monte_carlo.loaded_tally(&measures);
    replicates.iter().for_each(|(_, replicate)| tally.add(replicate));
    assert_eq!(tally.finish(6), one_by_one);
    let other = MonteCarlo::new(&case, &nominal, LandmarkNoise::Measured, 8).expect("as before");
    assert_ne!(told(&other, &loads, &measures, 6).numbers, one_by_one.numbers, "another seed");
}

/// A load on T2 to the feet that the case's own model just bears, by bisection.
fn nearly_buckling(nominal: &Analysis) -> Loading {
    let of = |down_n: f64| force(Vec3::new(0.0, 0.0, -down_n));
    let bears =
        |down_n: f64| response(nominal, &loads(&of(down_n), Goal::FullLoad)).result().is_some();
    let (mut low, mut high) = (1.0, 2000.0);
    assert!(bears(low) && !bears(high));
    for _ in 0..12 {
        let middle = (low + high) / 2.0;
        if bears(middle) { low = middle } else { high = middle }
    }
    of(low)
}

#[test]
fn replicates_that_buckle_are_counted_by_their_ending_and_are_in_no_interval() {
    let case = two_films();
    let nominal = analysed(&case);
    let loading = nearly_buckling(&nominal);
    let found = run(&case, 2.0, &loads(&loading, Goal::FullLoad), 30);
    let without: u64 = found.endings.iter().map(|(_, count)| count).sum();
    assert_eq!((found.done, found.usable + without), (30, 30));
    // At the limit itself, noise decides.
    assert!((3..=27).contains(&found.usable), "{} {:?}", found.usable, found.endings);
    let usual = ["limit_point", "branch_point", "beyond_human_range", "unreachable"];
    assert!(found.endings.iter().any(|(code, _)| usual.contains(&&**code)), "{:?}", found.endings);
    assert!(found.numbers.iter().all(|number| number.count == found.usable));
    let words = found.words();
    assert!(words[0].contains(&format!("with a result, {} of 30 ", found.usable)), "{words:?}");
    for (code, count) in &found.endings {
        assert!(words[1].contains(&format!("`{code}` in {count} of 30")), "{words:?}");
    }
    assert!(
        words.last().is_some_and(|words| words.contains("do not cover the errors of the model"))
    );
}

#[test]
fn few_replicates_have_no_interval() {
    // Oracle: of fewer than 40 replicates, 2.5 % are less than one replicate, so the ends rest on the two outermost values.
    let loading = push();
    let found = run(&two_films(), 1.0, &loads(&loading, Goal::FullLoad), MANY - 1);
    assert!(found.usable > 20, "{:?}", found.endings);
    assert!(found.numbers.iter().all(|number| number.interval_95().is_none()));
    let words = found.words();
    assert!(words[0].ends_with("a 95 % interval needs 40"), "{words:?}");
}

#[test]
fn loads_that_no_model_can_take_are_an_ending() {
    let item = LoadItem { vertebra: 99, ..push().items[0] };
    let impossible = Loading { items: vec![item], rods: Vec::new() };
    let case = two_films();
    let nominal = analysed(&case);
    let noise = LandmarkNoise::Pixels(1.0);
    let monte_carlo = MonteCarlo::new(&case, &nominal, noise, 3).expect("sound noise");
    let found = told(&monte_carlo, &loads(&impossible, Goal::FullLoad), &[], 2);
    assert_eq!((found.usable, &*found.endings[0].0), (0, "loads_not_applicable"));
    let given = AppliedLoads { kind: LineKind::Given, ..loads(&impossible, Goal::FullLoad) };
    let found = told(&monte_carlo, &given, &[], 2);
    assert_eq!((&*found.endings[0].0, found.endings[0].1), ("not_measured", 2));
}
