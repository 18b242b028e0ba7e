//! The current state of a reading, with derived values.

use std::collections::BTreeMap;

use axum::http::StatusCode;
use spineline::anatomy::{FilmView, Level, Side};
use spineline::measure::completion::has_shape;
use spineline::measure::{CornerName, ImageGeometry, Origin};
use spineline::spatial::{Angle, Pixel};
use spineline_marking::{NextLandmark, PartialLandmarks, PartialReading, ProposedVertebra};
use spineline_store::{
    Corner, Event, ReadingState, SeenReading, Store, Withdrawal, WithdrawalCause,
};

use super::erect::erect_of;
use super::landmarks::landmarks;
use super::lost;
use crate::api::{
    AxisView, CornerView, ExpectedLandmark, LostChangeView, Notice, Proposal as ProposalView,
    ReadingView, Severity, SidesView, VertebraView, Wire, WithdrawalView,
};
use crate::problem::{Answer, Failure};
use crate::user::User;
use crate::words;

/// A reading as this user may see it, after its recorded events and the given unrecorded ones.
pub fn view(
    store: &Store,
    user: &User,
    seen: &SeenReading,
    pending: &[Event],
) -> Answer<ReadingView> {
    let conflicts = lost::of_reading(store, seen.record.id)?;
    view_of(store, user, seen, &seen.state(pending)?, conflicts)
}

/// A reading after a stale change of this user, with only this conflict and later ones.
pub fn view_after_loss(
    store: &Store,
    user: &User,
    seen: &SeenReading,
    first_conflict: i64,
) -> Answer<ReadingView> {
    let conflicts = lost::of_reading_from(store, seen.record.id, first_conflict)?;
    view_of(store, user, seen, &seen.state(&[])?, conflicts)
}

fn view_of(
    store: &Store,
    user: &User,
    seen: &SeenReading,
    state: &ReadingState,
    conflicts: Vec<LostChangeView>,
) -> Answer<ReadingView> {
    let (record, film) = (&seen.record, &seen.film);
    let image = film.geometry()?;
    let view = film.view;
    let is_lateral = view == FilmView::Lateral;
    let landmarks = landmarks(state, view);
    let is_blinded = seen.code.is_some();
    let proposes = seen.proposals && has_shape();
    let posture = (!is_blinded).then_some(Wire(view));
    let crest = |side| state.iliac_crests_px.get(&side).copied();
    let erect = erect_of(store, user, seen)?;
    let prior = erect.as_ref().map(|erect| &erect.film);
    let order = PartialReading::order(prior);
    let widths = prior.map(|erect| erect.width_ratios(&image, &landmarks)).unwrap_or_default();
    Ok(ReadingView {
        reading: record.id.0,
        study: (!is_blinded).then(|| seen.study.id.to_string()),
        film: (!is_blinded).then_some(film.id.0),
        posture,
        code: seen.code.as_ref().map(ToString::to_string),
        observer: record.observer.to_string(),
        repeat: (!is_blinded).then_some(record.repeat),
        mine: record.observer == user.name,
        finished: state.finished,
        withdrawn: record.withdrawn.as_ref().map(withdrawal_view),
        corrects: record.corrects.map(|corrected| corrected.0),
        synthetic: seen.study.synthetic,
        image: words::image_of(&image, is_lateral, state.inverted.unwrap_or(film.inverted)),
        revision: state.revision,
        undoable: state.undoable,
        redoable: state.redoable,
        vertebrae: landmarks
            .vertebrae
            .iter()
            .map(|(&level, landmark)| {
                let pedicles = state.vertebrae.get(&level).map(|known| &known.pedicles);
                let width_ratio = widths.get(&level).copied();
                vertebra(&image, view, level, landmark, pedicles, width_ratio)
            })
            .collect(),
        crests: SidesView { left_px: crest(Side::Left), right_px: crest(Side::Right) },
        notes: state.notes.clone(),
        order: order.iter().map(ToString::to_string).collect(),
        next: landmarks.next(&order).and_then(|next| next_landmark(next, view)),
        next_by_walls: landmarks
            .next_by_walls(&order)
            .filter(|_| proposes && !is_lateral)
            .and_then(|next| next_landmark(next, view)),
        proposals_allowed: proposes,
        // Proposals use sizes from frontal views.
        proposals: if proposes && !is_lateral {
            let posture = view.posture().filter(|_| !is_blinded);
            landmarks.propose(&image, posture, prior).iter().map(proposal_view).collect()
        } else {
            Vec::new()
        },
        faults: faults(&landmarks, &image, view, is_blinded),
        conflicts,
        erect: erect.map(|erect| erect.reading.0),
    })
}

pub fn withdrawal_view(withdrawal: &Withdrawal) -> WithdrawalView {
    WithdrawalView {
        who: withdrawal.who.to_string(),
        at_ms: withdrawal.at.unix_ms(),
        reason: match &withdrawal.cause {
            WithdrawalCause::Reason(reason) => Some(reason.clone()),
            WithdrawalCause::CorrectedBy(_) => None,
        },
    }
}

fn vertebra(
    image: &ImageGeometry,
    view: FilmView,
    level: Level,
    landmark: &PartialLandmarks,
    pedicles: Option<&BTreeMap<Side, [f64; 2]>>,
    width_ratio: Option<f64>,
) -> VertebraView {
    let corners = CornerName::ORDER.into_iter().filter_map(|name| {
        let place = name.of(&landmark.corners)?;
        let origin = name.of(&landmark.origins);
        Some(CornerView { corner: corner(name, view), px: place.into(), origin })
    });
    let body = landmark.body(image);
    let axis = body.map(|body| AxisView {
        from_px: body.axis[0].into(),
        to_px: body.axis[1].into(),
        axis_deg: spineline_files::written_axis_deg(body.axis_clockwise),
        by_hand: landmark.axis_clockwise.is_some(),
        text: axis_text(body.tilt, view),
    });
    let pedicle = |side| pedicles.and_then(|known| known.get(&side).copied());
    VertebraView {
        level: level.to_string(),
        corners: corners.collect(),
        walls: SidesView {
            left_px: landmark.walls[0].map(Into::into),
            right_px: landmark.walls[1].map(Into::into),
        },
        pedicles: SidesView { left_px: pedicle(Side::Left), right_px: pedicle(Side::Right) },
        complete: landmark.complete().is_some(),
        midpoint_px: body.map(|body| body.midpoint.into()),
        axis,
        erect_width_percent: width_ratio.map(|ratio| (100.0 * ratio).round()),
    }
}

/// The tilt of an axis on a frontal film, or its pitch on the lateral one.
fn axis_text(tilt: Angle, view: FilmView) -> String {
    if view == FilmView::Lateral {
        return format!("pitch {}", -tilt);
    }
    match tilt.shown_side() {
        Some(side) => format!("tilt {} to {}", tilt.abs(), words::patients(side)),
        None => "tilt 0.0°".to_owned(),
    }
}

/// The next landmark on a film of this view; the lateral film has no crests.
fn next_landmark(next: NextLandmark, view: FilmView) -> Option<ExpectedLandmark> {
    Some(match next {
        NextLandmark::Corner(level, name) => {
            ExpectedLandmark::Corner { level: level.to_string(), corner: corner(name, view) }
        }
        NextLandmark::Wall(level, side) => {
            ExpectedLandmark::Wall { level: level.to_string(), side }
        }
        NextLandmark::Crest(_) if view == FilmView::Lateral => return None,
        NextLandmark::Crest(side) => ExpectedLandmark::Crest { side },
    })
}

/// A corner that the program proposes on a frontal film; corners are placed to 0.01 px at best.
pub(super) fn corner_view(name: CornerName, place: Pixel, origin: Origin) -> CornerView {
    let px = <[f64; 2]>::from(place).map(|px| (px * 100.0).round() / 100.0);
    CornerView { corner: name.of(&Corner::FRONTAL), px, origin }
}

fn proposal_view(proposal: &ProposedVertebra) -> ProposalView {
    let corners = CornerName::ORDER
        .into_iter()
        .map(|name| corner_view(name, name.of(&proposal.corners), Origin::Completed));
    ProposalView {
        level: proposal.level.to_string(),
        corners: corners.collect(),
        sd_percent: (100.0 * proposal.sd_share).round(),
        sd_share: None,
        is_sure: proposal.is_sure,
    }
}

fn faults(
    landmarks: &PartialReading,
    image: &ImageGeometry,
    view: FilmView,
    is_blinded: bool,
) -> Vec<Notice> {
    let posture = view.posture().filter(|_| !is_blinded).map(Wire);
    let notices = landmarks.faults(image).into_iter().map(|fault| Notice {
        severity: if fault.is_error() { Severity::Error } else { Severity::Warning },
        code: fault.code().to_owned(),
        posture,
        level: fault.level().map(|level| level.to_string()),
        line: None,
        text: fault.words(view),
    });
    notices.collect()
}

/// Refuses the end of a planned reading with an open error, or without vertebrae on a film that shows some: it cannot be corrected
/// afterwards.
pub fn need_sound(seen: &SeenReading, state: &ReadingState, nothing_to_mark: bool) -> Answer<()> {
    if seen.code.is_none() {
        return Ok(());
    }
    let refused = |code, text: String| Failure::new(StatusCode::UNPROCESSABLE_ENTITY, code, text);
    if state.vertebrae.is_empty() && !nothing_to_mark {
        let text = "no vertebra is marked in this reading".to_owned();
        return Err(refused("no_landmarks", text)
            .help("mark a vertebra, or confirm that the film shows none that can be marked"));
    }
    let view = seen.film.view;
    let faults = landmarks(state, view).faults(&seen.film.geometry()?);
    let errors = faults.iter().filter(|fault| fault.is_error()).map(|fault| fault.words(view));
    let errors = errors.collect::<Vec<_>>().join("; ");
    if errors.is_empty() {
        return Ok(());
    }
    Err(refused("landmark_errors", format!("errors of landmarks are open: {errors}"))
        .help("correct them first: a planned reading cannot be changed after its end"))
}

fn corner(name: CornerName, view: FilmView) -> Corner {
    name.of(&Corner::of_view(view))
}
