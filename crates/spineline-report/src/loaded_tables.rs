//! A spine under loads as texts and tables.

use spineline::clinical::sacral_reference;
use spineline::measure::Outline;
use spineline::multibody::{Equilibrium, ForceSign, Goal, PathEnding};
use spineline::number::{fixed, scientific};
use spineline::response::{
    ActingKind, LoadedMeasure, LoadedQuantity, LoadedState, Verdict, acting_loads,
    largest_displacement_mm, largest_hinge, loaded_measures,
};
use spineline::spatial::{moment_words, vector_words};
use spineline::uncertainty::LoadedUncertainty;
use spineline_files::Simulated;

use crate::document::{Column, Table};
use crate::loaded_words::{interval_words, measure_words};
use crate::phrases::sentence_case;

/// A personalised spine and its response to loads.
#[derive(Debug, Clone, Copy)]
pub struct LoadedTables<'a> {
    /// Model, loads and response.
    pub simulated: &'a Simulated,
    /// The erect film, where it is known: its vertical gives the coronal balance.
    pub film: Option<&'a Outline>,
    /// Replicates with perturbed landmarks under the same loads, where there are any.
    pub uncertainty: Option<&'a LoadedUncertainty>,
}

/// The name of a row of intervals.
const INTERVAL: &str = "95 % interval";

impl LoadedTables<'_> {
    /// The shape in numbers.
    #[must_use]
    pub fn numbers(&self, result: &Equilibrium) -> Table {
        let model = &self.simulated.model;
        let levels = &model.levels;
        let (vertebra, moved_mm) = largest_displacement_mm(&model.spine, &result.deformed);
        let (joint, axis, turn) = largest_hinge(&result.deformed);
        let axis = ["lateral", "flexion", "axial"][axis];
        let mut table =
            Table::new("", vec![Column::words("Shape under load"), Column::words("Value")]);
        let mut add = |name: &str, value: String| table.row(vec![name.to_owned(), value]);
        add("Factor of proportional loads", fixed(result.factor, 6));
        let (factor, loaded) = (LoadedQuantity::Factor, LoadedState::Loaded);
        let interval = self.uncertainty.map(|found| interval_words(found, factor, loaded, ""));
        if let Some(interval) = interval.filter(|words| !words.is_empty()) {
            add(&format!("  {INTERVAL}"), interval);
        }
        add("Largest displacement", format!("{} mm, at {}", fixed(moved_mm, 1), levels[vertebra]));
        add(
            "Largest joint rotation",
            format!("{} ({axis}, {}/{})", turn.abs(), levels[joint], levels[joint + 1]),
        );
        add("Residual", format!("{} rad", scientific(result.residual_rad, 0)));
        add(
            "Smallest singular value",
            format!(
                "{} (1 unloaded, 0 at a limit or branch point)",
                fixed(result.smallest_singular_value, 3)
            ),
        );
        table
    }

    /// The force or moment of each load in the final shape; slices of gravity are left out.
    #[must_use]
    pub fn forces(&self, result: &Equilibrium) -> Table {
        let Simulated { model, placed, .. } = self.simulated;
        let columns = vec![
            Column::words("Load"),
            Column::words("Acts on"),
            Column::words(format!("Force in {}", model.force_unit())),
            Column::words("Moment (force × mm)"),
        ];
        let mut table = Table::new("", columns);
        let mut add = |load: usize, place: String, force: String, moment: String| {
            table.row(vec![(load + 1).to_string(), place, force, moment]);
        };
        let acting =
            acting_loads(&placed.loading, &result.deformed, result.factor, &result.spring_forces_n);
        for load in acting {
            let number = placed.load_of_item[load.item];
            if placed.load_of_item.iter().filter(|other| **other == number).count() > 1 {
                continue;
            }
            let (force, moment) = match load.kind {
                ActingKind::Force(force) => (vector_words(force.into()), String::new()),
                ActingKind::Moment(moment) => (String::new(), moment_words(moment.into())),
            };
            add(number, model.levels[load.vertebra].to_string(), force, moment);
        }
        for ((force, moment), (number, rod)) in
            result.rod_reactions.iter().zip(placed.load_of_rod.iter().zip(&placed.loading.rods))
        {
            let place = format!("{}, held by the rod", model.levels[rod.superior]);
            add(*number, place, vector_words((*force).into()), moment_words((*moment).into()));
        }
        table
    }

    /// What is measured before and under the loads.
    #[must_use]
    pub fn measures(&self) -> Vec<LoadedMeasure> {
        let Simulated { model, places, response, .. } = self.simulated;
        loaded_measures(&model.spine, places, self.film, response)
    }

    /// Angles and the place of the uppermost vertebra before and after, each with its interval below it where there are replicates.
    #[must_use]
    pub fn angles(&self) -> Table {
        let columns = vec![
            Column::words("Angle"),
            Column::numbers("Erect"),
            Column::numbers("Under load"),
            Column::numbers("Change"),
        ];
        let mut table = Table::new("", columns);
        for measure in self.measures() {
            let Some(name) = self.name(measure.quantity) else { continue };
            let [erect, loaded, change] = measure_words(&measure);
            table.row(vec![name, erect, loaded, change]);
            if let Some([erect, loaded, change]) = self.interval_words(&measure) {
                table.row(vec![format!("  {INTERVAL}"), erect, loaded, change]);
            }
        }
        table
    }

    /// The intervals of the numbers in the table of angles: the name of a row, and one text per state; empty without replicates.
    #[must_use]
    pub fn intervals(&self) -> Vec<(String, [String; 3])> {
        let row = |measure: &LoadedMeasure| {
            Some((self.name(measure.quantity)?, self.interval_words(measure)?))
        };
        self.measures().iter().filter_map(row).collect()
    }

    /// The name of a quantity's row in the table of angles; the factor has none.
    fn name(&self, quantity: LoadedQuantity) -> Option<String> {
        let [base, top] = self.end_names();
        Some(match quantity {
            LoadedQuantity::Cobb(region) => format!("Cobb, {region}"),
            LoadedQuantity::TiltRange(region) => format!("Tilt range, {region}"),
            LoadedQuantity::Ferguson(region) => format!("Ferguson, {region}"),
            LoadedQuantity::LateralTilt => sentence_case(&self.lateral_tilt()),
            LoadedQuantity::TopTilt => format!("Tilt of {top} against {base}"),
            LoadedQuantity::TopOffset => format!("{top} from the axis of {base}"),
            LoadedQuantity::CoronalBalance => {
                let reference =
                    self.film.map_or_else(String::new, |film| sacral_reference(film).to_string());
                format!("Coronal balance: {top} from the vertical through {reference}")
            }
            LoadedQuantity::Factor => return None,
        })
    }

    /// The intervals of a quantity in every state; `None` where it has none.
    fn interval_words(&self, measure: &LoadedMeasure) -> Option<[String; 3]> {
        let found = self.uncertainty?;
        let numbers = measure_words(measure);
        let words = |state, number: &str| interval_words(found, measure.quantity, state, number);
        let words = std::array::from_fn(|i| words(LoadedState::ALL[i], &numbers[i]));
        words.iter().any(|words| !words.is_empty()).then_some(words)
    }

    /// Every shape that meets the target, where there is a choice or no result.
    #[must_use]
    pub fn solutions(&self) -> Table {
        let response = &self.simulated.response;
        let is_one = response.goal == Goal::FullLoad && response.ending == PathEnding::Converged;
        let shapes = response.equilibria.iter().filter(|_| !is_one);
        Table::of("", shapes, |add| {
            add.words("Shapes that meet the target", |met| match met.sign {
                ForceSign::Positive => "loads along their direction",
                ForceSign::Negative => "loads against their direction",
            });
            add.numbers("Factor", |met| fixed(met.equilibrium.factor, 6));
            add.numbers("Limit points", |met| met.equilibrium.limit_points.to_string());
            add.numbers("Branch points", |met| met.equilibrium.branch_points.to_string());
            add.numbers("Largest joint rotation", |met| {
                largest_hinge(&met.equilibrium.deformed).2.abs().to_string()
            });
            add.numbers(sentence_case(&self.lateral_tilt()), |met| {
                met.equilibrium.deformed.lateral_tilt().leaning()
            });
            add.words("Verdict", |met| match met.verdict {
                Verdict::Reached => "chosen: smallest factor on the erect branch",
                Verdict::Later => "not chosen: larger factor, or later on the path",
                Verdict::BeyondLimitPoint => "not chosen: beyond a limit point (snapped)",
                Verdict::BeyondHumanRange => "not chosen: beyond the human range of motion",
                Verdict::BeyondBranchPoint => "not chosen: beyond a branch point (buckled)",
            });
        })
    }

    /// The status first, then what it means and what to do; without a result also the shape that is nearest to the target.
    #[must_use]
    pub fn ending(&self) -> Vec<String> {
        let response = &self.simulated.response;
        let ending = response.ending;
        let meaning = match ending {
            PathEnding::Converged if !response.is_complete() => {
                "a shape that meets the target, reached from the erect spine; the path was lost beyond it, where there may be more".to_owned()
            }
            PathEnding::Converged => {
                "the only shape that meets the target within the limits, reached from the erect spine".to_owned()
            }
            PathEnding::SeveralEquilibria => {
                "several shapes meet the target; the first one that the erect spine reaches is the result".to_owned()
            }
            PathEnding::Interrupted => {
                "NO RESULT: interrupted; the files hold the path so far".to_owned()
            }
            other => format!("NO RESULT: {}", other.meaning()),
        };
        let name = ending.key().replace('_', " ");
        let mut texts = vec![format!("{} · {meaning}", name.to_uppercase())];
        if let (None, Some(point)) = (response.result(), response.nearest()) {
            texts.push(format!(
                "Nearest shape on the path: factor {} of the {} loads, lateral tilt {} against {}'s axis, largest joint rotation {}",
                fixed(point.factor, 4),
                point.timing,
                point.deformed.lateral_tilt().leaning(),
                self.end_names()[0],
                largest_hinge(&point.deformed).2.abs()
            ));
        }
        texts
    }

    /// Limit and branch points on the way.
    #[must_use]
    pub fn events(&self) -> Vec<String> {
        let events = self.simulated.response.paths.iter().flat_map(|signed| {
            let way = match signed.sign {
                ForceSign::Positive => "",
                ForceSign::Negative => " (loads against their direction)",
            };
            signed.path.events.iter().map(move |event| {
                let name = event.kind.key().replace('_', " ");
                let (factor, timing) = (event.factor, event.timing);
                format!(
                    "Event: {name} at a factor of {} of the {timing} loads{way}",
                    fixed(factor, 4)
                )
            })
        });
        events.collect()
    }

    /// The lateral tilt with its reference, which is not the iliac line of films.
    #[must_use]
    pub fn lateral_tilt(&self) -> String {
        let names = self.end_names();
        format!("lateral tilt of {} against {}'s axis", names.join("-"), names[0])
    }

    fn end_names(&self) -> [&'static str; 2] {
        let levels = &self.simulated.model.levels;
        [levels.first(), levels.last()].map(|level| level.map_or("?", |l| l.name()))
    }
}
