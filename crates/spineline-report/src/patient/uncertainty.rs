//! The uncertainty of the numbers: from the films themselves, and from the noise of landmarks.

use spineline::analysis::{Analysis, FilmMovement, LineModel};
use spineline::anatomy::Level;
use spineline::number::fixed;
use spineline::personalize::{
    FitTarget, GroupStiffness, Identifiability, MULTIPLIER_COVERAGE, MultiplierInformation,
    ProfileEnd, STIFFNESS_COVERAGE,
};
use spineline::uncertainty::{
    AnalysisQuantity, QuantityKind, QuantitySpread, QuantityUnit, Uncertainty,
};
use spineline::warning::counted;

use crate::document::{Column, Figure, Notice, NoticeKind, Section, Table};
use crate::figures;
use crate::phrases::none;

/// The mean stiffness of a multiplier's joints with its 95 % interval, such as `0.71 (0.66 to 0.76)`.
pub fn mean_of_joints(one: &MultiplierInformation, scale: f64) -> String {
    let places = places(one, scale);
    let mean = |found: GroupStiffness| fixed(scale * found.log_mean.exp(), places);
    one.stiffness.map_or_else(none, |found| format!("{} ({})", mean(found), interval(one, scale)))
}

/// Decimal places of a multiplier and of the interval of its joints: two, or more where a fit outside of the interval would read as one of
/// its ends.
pub fn places(one: &MultiplierInformation, scale: f64) -> usize {
    let is_hidden = |places: &usize| {
        let at = |log: f64| fixed(scale * log.exp(), *places);
        let is_shown = |end: &ProfileEnd| matches!(end, ProfileEnd::At(log) if at(*log) == at(one.log_multiplier));
        one.is_outside() && one.interval_95().is_some_and(|ends| ends.iter().any(is_shown))
    };
    (2..5).find(|places| !is_hidden(places)).unwrap_or(5)
}

/// The 95 % interval of the mean stiffness of a multiplier's joints.
pub fn interval(one: &MultiplierInformation, scale: f64) -> String {
    let places = places(one, scale);
    let at = |log: f64| fixed(scale * log.exp(), places);
    match one.interval_95() {
        Some([ProfileEnd::At(low), ProfileEnd::At(high)]) => format!("{} to {}", at(low), at(high)),
        Some([ProfileEnd::At(low), ProfileEnd::Open]) => format!("above {}", at(low)),
        Some([ProfileEnd::Open, ProfileEnd::At(high)]) => format!("below {}", at(high)),
        Some([ProfileEnd::Open, ProfileEnd::Open]) => "not bounded".to_owned(),
        Some(_) | None => "unknown".to_owned(),
    }
}

/// Identifiability of every multiplier: the mean of its joints by all films, the rest by the bends.
pub fn identifiability(
    section: &mut Section,
    analysis: &Analysis,
    found: &[Option<Identifiability>],
) {
    let prior = analysis.options.prior;
    let mut columns = vec![
        Column::words("Line of action"),
        Column::words("Joints"),
        Column::numbers("Ratio to the geometric mean (1)"),
        Column::words("Mean of the joints (95 % interval) (1)"),
        Column::numbers("sd of ln if the model is exact (1)"),
        Column::words("What the films identify"),
    ];
    if prior.is_some() {
        columns.push(Column::numbers("sd of ln with prior (1)"));
        columns.push(Column::numbers("share from films (%)"));
    }
    let mut table = Table::new("Identifiability of the multipliers", columns);
    for (model, found) in analysis.models.iter().zip(found) {
        let Some(found) = found else {
            let text = format!("{}: the fit did not converge, so nothing is known.", model.kind);
            section.notice(Notice::new(NoticeKind::Warning, text));
            continue;
        };
        let rows = model.groups.titles().zip(model.multipliers()).zip(&found.multipliers);
        for ((name, value), one) in rows {
            let mut row = vec![
                model.kind.to_string(),
                name,
                fixed(value, places(one, 1.0)),
                mean_of_joints(one, 1.0),
                deviation(one.log_sd),
                one.verdict().to_string(),
            ];
            if let Some(prior) = prior {
                row.push(one.log_sd_with_prior.map_or_else(none, deviation));
                let share =
                    one.film_share(prior.log_sd, found.multipliers.len(), analysis.options.gauge);
                row.push(share.map_or_else(none, |share| fixed(100.0 * share, 0)));
            }
            table.row(row);
        }
        for notice in limits(analysis, model, found) {
            section.notice(notice);
        }
    }
    let is_free = |film: &FilmMovement| film.outline.length.is_free();
    table.note = STIFFNESS_COVERAGE.to_owned();
    if analysis.movement.films.iter().any(is_free) {
        table.note += " Intervals are conditional on the scales of the films against the erect one, which were found before the fit and are held. Their error is not in these intervals; `--replicates` finds them anew with every set of landmarks.";
    }
    section.table(table);
}

/// The same as a picture.
pub fn profiles(section: &mut Section, analysis: &Analysis, found: &[Option<Identifiability>]) {
    if let Some(svg) = figures::profiles(analysis, found) {
        let caption = "Rise of the sum of squares where one multiplier is held at another value.";
        section.figure(Figure::new("profiles", caption, svg));
    }
}

fn limits(analysis: &Analysis, model: &LineModel, found: &Identifiability) -> Vec<Notice> {
    let note = |text: String| Notice::new(NoticeKind::Note, format!("{}: {text}", model.kind));
    let mut notices = Vec::new();
    if found.variance_factor > 1.0 {
        let times = fixed(found.variance_factor.sqrt(), 1);
        let mut lines = analysis.comparison().lines.iter();
        let left = match lines.find(|line| line.kind == model.kind).map(|line| line.target) {
            Some(FitTarget::Ferguson) => {
                format!("{times}° where 1° is assumed, which is not the noise of the films")
            }
            Some(FitTarget::Shape) | None => format!("{times} times what noise explains"),
        };
        notices.push(note(format!("the fit leaves {left}; intervals are widened by that factor.")));
    }
    if let Some(weakest) = found.directions.first() {
        let what = if weakest.gauge_share > 0.9 {
            "the level of all, which the scale constraint (gauge) fixes"
        } else {
            "a ratio"
        };
        let sd = deviation(weakest.log_sd);
        notices.push(note(format!("Least known: {what} (sd of ln {sd}).")));
    }
    if found.multipliers.iter().any(|one| one.profile.improves()) {
        let text =
            "a profile found a better fit than the fit itself: its minimum was not the lowest.";
        notices.push(Notice::new(NoticeKind::Warning, format!("{}: {text}", model.kind)));
    }
    notices
}

fn deviation(log_sd: f64) -> String {
    if log_sd < 100.0 { fixed(log_sd, 2) } else { "unlimited".to_owned() }
}

/// Every number of the report with its interval.
pub fn numbers(analysis: &Analysis, found: &Uncertainty) -> Section {
    let mut section = Section::new("uncertainty", "Effect of landmark noise on the results");
    section.paragraph(format!(
        "Monte Carlo over landmark noise: {}, seed {}; {} of them failed. Means and 95 % intervals are from the others.",
        counted(found.done, "replicate"),
        found.seed,
        found.failed
    ));
    let words = found.few_words().into_iter().chain(found.noise_words());
    for words in words.chain(found.failure_words()) {
        section.paragraph(words);
    }
    section.notice(Notice::new(NoticeKind::Note, Uncertainty::CAVEAT));
    section.notice(Notice::new(NoticeKind::Note, MULTIPLIER_COVERAGE));
    if found.done < found.requested {
        let text =
            format!("Interrupted: requested were {}.", counted(found.requested, "replicate"));
        section.notice(Notice::new(NoticeKind::Warning, text));
    }
    section.table(of_vertebrae(analysis, found));
    section.table(spreads(analysis, found));
    section
}

/// Standard deviations of the measured vertebrae, film by film.
fn of_vertebrae(analysis: &Analysis, found: &Uncertainty) -> Table {
    let columns = vec![
        Column::words("Film"),
        Column::words("Lateral, mean"),
        Column::words("Lateral, largest"),
        Column::words("Height, mean"),
        Column::words("Height, largest"),
        Column::words("Tilt (°), mean"),
        Column::words("Tilt (°), largest"),
    ];
    let mut table = Table::new("Standard deviation of the vertebrae", columns);
    for posture in analysis.movement.films.iter().map(|p| p.outline.posture) {
        let mut row = vec![posture.to_string()];
        for kind in [QuantityKind::LocationY, QuantityKind::LocationZ, QuantityKind::Tilt] {
            row.extend(mean_and_largest(found, kind.on(posture), analysis));
        }
        table.row(row);
    }
    table
}

fn mean_and_largest(
    found: &Uncertainty,
    of_film: AnalysisQuantity,
    analysis: &Analysis,
) -> [String; 2] {
    let levels = analysis.movement.levels();
    let sds: Vec<(f64, Level)> = levels
        .iter()
        .skip(1)
        .filter_map(|level| Some((found.spread(of_film.at(level))?.sd?, level)))
        .collect();
    let Some(&(largest, level)) = sds.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return [none(), none()];
    };
    let unit = match of_film.at(level).unit(analysis) {
        QuantityUnit::Degrees => String::new(),
        unit => format!(" {}", unit.key()),
    };
    let mean = sds.iter().map(|(sd, _)| sd).sum::<f64>() / sds.len() as f64;
    [format!("{}{unit}", fixed(mean, 2)), format!("{} ({level})", fixed(largest, 2))]
}

/// Why a number has no interval over the replicates, where its fit is the reason.
pub fn no_interval(one: &QuantitySpread) -> Option<String> {
    if one.never_converged() {
        return Some("none: the fit did not converge".to_owned());
    }
    let (at_bound, count) = (one.replicates_at_bound, counted(one.count, "replicate"));
    one.at_bound.then(|| format!("none: at its bound in {at_bound} of {count}"))
}

/// Every other number that is reported.
fn spreads(analysis: &Analysis, found: &Uncertainty) -> Table {
    let number = |spread: &QuantitySpread, value: f64| match spread.quantity.unit(analysis) {
        QuantityUnit::Segments => fixed(value, 0),
        QuantityUnit::One | QuantityUnit::Millimetres => fixed(value, 2),
        _ => fixed(value, 1),
    };
    let reported = found.quantities.iter().filter(|spread| spread.quantity.is_reported());
    Table::of("Numbers over the replicates", reported, |add| {
        add.words("Number", |one| one.quantity.label(analysis));
        add.words("Unit", |one| one.quantity.unit(analysis).key());
        add.numbers("Value", |one| one.nominal.ok().map_or_else(none, |value| number(one, value)));
        add.numbers("Mean", |one| one.spread.map_or_else(none, |s| number(one, s.mean)));
        add.numbers("sd", |one| one.spread.and_then(|s| s.sd).map_or_else(none, |sd| fixed(sd, 2)));
        add.words("95 % interval", |one| match one.interval_95() {
            Some([low, high]) => {
                let caveat = one.quantity.interval_caveat();
                let caveat = caveat.map_or("", |_| " (if the model is exact)");
                format!("{} to {}{caveat}", number(one, low), number(one, high))
            }
            None => no_interval(one).unwrap_or_else(none),
        });
        add.numbers("In (%)", |one| fixed(100.0 * one.count as f64 / found.done.max(1) as f64, 1));
    })
}

#[cfg(test)]
mod tests {
    use spineline::action::LineKind;
    use spineline::personalize::Profile;
    use spineline::uncertainty::Absent;

    use super::*;

    #[test]
    fn a_number_without_an_interval_says_why() {
        let inside = QuantitySpread {
            quantity: QuantityKind::LogMultiplier.of_case().along(LineKind::Iliac).of_multiplier(0),
            nominal: Ok(0.2),
            count: 60,
            absent: Vec::new(),
            spread: None,
            replicates_at_bound: 1,
            at_bound: false,
        };
        assert_eq!(no_interval(&inside), None);
        let at_bound = QuantitySpread { replicates_at_bound: 7, at_bound: true, ..inside.clone() };
        let words = no_interval(&at_bound);
        assert_eq!(words.as_deref(), Some("none: at its bound in 7 of 60 replicates"));
        let lost = QuantitySpread {
            nominal: Err(Absent::FitNotConverged),
            count: 0,
            absent: vec![(Absent::FitNotConverged, 60)],
            replicates_at_bound: 0,
            ..inside
        };
        assert_eq!(no_interval(&lost).as_deref(), Some("none: the fit did not converge"));
    }

    #[test]
    fn a_fit_outside_of_its_interval_does_not_read_as_one_of_its_ends() {
        let profile =
            Profile { points: Vec::new(), lower: ProfileEnd::Open, upper: ProfileEnd::Open };
        let one = |multiplier: f64, [low, high]: [f64; 2]| {
            let [low, high] = [low, high].map(f64::ln);
            let (log_mean, log_reach) = (0.5 * (low + high), 0.5 * (high - low));
            MultiplierInformation {
                log_multiplier: multiplier.ln(),
                log_sd: 0.1,
                log_sd_with_prior: None,
                profile: profile.clone(),
                stiffness: Some(GroupStiffness { log_mean, log_sd: 0.1, log_reach }),
            }
        };
        let hidden = one(0.4672, [0.4714, 0.5701]);
        assert_eq!((places(&hidden, 1.0), interval(&hidden, 1.0).as_str()), (3, "0.471 to 0.570"));
        for usual in [one(0.4748, [0.4714, 0.5701]), one(0.41, [0.4714, 0.5701])] {
            assert_eq!((places(&usual, 1.0), interval(&usual, 1.0).as_str()), (2, "0.47 to 0.57"));
        }
    }
}
