//! Which vertebrae the films of a patient give to the model.

use std::collections::BTreeSet;
use std::slice;

use super::interpolation::MAX_GAP;
use super::{MeasureError, MeasureFault, Placement, Reading};
use crate::anatomy::{Level, Levels, Posture};
use crate::warning::{WarningCode, Warnings};

/// The vertebrae of one film that some reading has.
pub(crate) fn seen_levels(readings: &[Reading<Placement>]) -> BTreeSet<Level> {
    readings.iter().flat_map(|reading| reading.vertebrae.keys().copied()).collect()
}

/// Whether a film with these vertebrae can take part in an analysis: it has a base, a top and no gap that is too wide.
#[must_use]
pub fn shows_enough(seen: &BTreeSet<Level>) -> bool {
    common_levels(&[(Posture::Erect, seen.clone())]).is_ok()
}

/// The lowest and the highest vertebra of the model on a film.
fn ends_on(posture: Posture, seen: &BTreeSet<Level>) -> Result<[Level; 2], MeasureError> {
    let mut of_model = seen.iter().copied().filter(|level| level.model_index().is_some());
    let lowest = of_model.next();
    let highest = of_model.next_back().or(lowest);
    match lowest.zip(highest) {
        Some((lowest, _)) if lowest > Levels::HIGHEST_BASE => {
            Err(MeasureFault::BaseMissing { lowest }.at(posture))
        }
        Some((lowest, highest)) if highest >= Levels::LOWEST_TOP => Ok([lowest, highest]),
        found => Err(MeasureFault::TopMissing { highest: found.map(|(_, top)| top) }.at(posture)),
    }
}

/// The vertebrae from the lowest to the highest one that all films show; any between them may be missing on some.
///
/// # Errors
/// [`MeasureError`] of a film that shows too little of the spine.
pub(crate) fn common_levels(films: &[(Posture, BTreeSet<Level>)]) -> Result<Levels, MeasureError> {
    let (mut base, mut top) = (Level::L4, Level::T2);
    for (posture, seen) in films {
        // An end that one film shows may be what another does not.
        let [low, high] = ends_on(*posture, seen)?;
        (base, top) = (base.max(low), top.min(high));
    }
    loop {
        let lacks = |level: Level| films.iter().any(|(_, seen)| !seen.contains(&level));
        match () {
            () if lacks(base) => match base.next_above().filter(|up| *up <= Levels::HIGHEST_BASE) {
                Some(up) => base = up,
                None => return Err(no_common_end(films, true)),
            },
            () if lacks(top) => match top.next_below().filter(|down| *down >= Levels::LOWEST_TOP) {
                Some(down) => top = down,
                None => return Err(no_common_end(films, false)),
            },
            () => break,
        }
    }
    let levels = Levels::between(base, top).expect("a base up to L2 lies below a top from T6");
    for (posture, seen) in films {
        check_gaps(*posture, levels, seen)?;
    }
    Ok(levels)
}

/// The vertebrae between the ends of one film. A gap that is too wide may lie outside of the model, whose vertebrae are then shown.
pub(crate) fn shown_levels(film: &(Posture, BTreeSet<Level>), of_model: Levels) -> Levels {
    common_levels(slice::from_ref(film)).unwrap_or(of_model)
}

/// No vertebra from which, or up to which, a model may reach is on all films: the film that lacks most is named.
fn no_common_end(films: &[(Posture, BTreeSet<Level>)], at_base: bool) -> MeasureError {
    let candidates: Vec<Level> =
        Level::MODEL
            .into_iter()
            .filter(|&level| {
                if at_base { level <= Levels::HIGHEST_BASE } else { level >= Levels::LOWEST_TOP }
            })
            .collect();
    let lacking = |seen: &BTreeSet<Level>| candidates.iter().filter(|l| !seen.contains(l)).count();
    let worst = films.iter().max_by_key(|(_, seen)| lacking(seen));
    let posture = worst.map_or(Posture::Erect, |(posture, _)| *posture);
    MeasureFault::NoCommonEnd { at_base }.at(posture)
}

fn check_gaps(
    posture: Posture,
    levels: Levels,
    seen: &BTreeSet<Level>,
) -> Result<(), MeasureError> {
    let mut inferior = levels.base();
    for superior in levels.iter().filter(|level| seen.contains(level)) {
        let step = superior as usize - inferior as usize;
        if step > MAX_GAP + 1 {
            let (missing, limit) = (step - 1, MAX_GAP);
            return Err(MeasureFault::Gap { inferior, superior, missing, limit }.at(posture));
        }
        inferior = superior;
    }
    Ok(())
}

/// Says which vertebrae the model lacks, which films are the cause, and what follows from it.
pub(crate) fn warn_of_shortened_chain(
    levels: Levels,
    films: &[(Posture, BTreeSet<Level>)],
    warnings: &mut Warnings,
) {
    let names =
        |missing: &[Level]| missing.iter().map(|level| level.name()).collect::<Vec<_>>().join(", ");
    let without = |missing: &[Level]| {
        let lacks = |seen: &BTreeSet<Level>| missing.iter().any(|level| !seen.contains(level));
        let lacking: Vec<&(Posture, BTreeSet<Level>)> =
            films.iter().filter(|(_, seen)| lacks(seen)).collect();
        if lacking.len() == films.len() {
            return "all films".to_owned();
        }
        lacking.iter().map(|(posture, _)| posture.to_string()).collect::<Vec<_>>().join(", ")
    };
    let (base, top) = (levels.base(), levels.top());
    let missing: Vec<Level> = Level::MODEL.into_iter().filter(|&level| level > top).collect();
    if !missing.is_empty() {
        let text = format!(
            "{} not marked on every film (missing on: {}): the model of all films ends at {top}, which carries the force; bends are matched at the lateral tilt of {base} to {top}, the proximal thoracic region is shorter, and results differ from results of a spine up to T2",
            subject(&names(&missing), missing.len()),
            without(&missing)
        );
        warnings.push(WarningCode::TopMissing, text);
    }
    let missing: Vec<Level> = Level::MODEL.into_iter().filter(|&level| level < base).collect();
    if !missing.is_empty() {
        let text = format!(
            "{} not marked on every film (missing on: {}): {base} is the fixed base, and locations, tilts and lines are relative to {base} instead of L4; the joints below have no stiffness, and results are not comparable in number with results of a spine from L4",
            subject(&names(&missing), missing.len()),
            without(&missing)
        );
        warnings.push(WarningCode::BaseMissing, text);
    }
}

fn subject(names: &str, count: usize) -> String {
    format!("{names} {}", if count == 1 { "is" } else { "are" })
}
