//! Readings in which a user may place landmarks.

use spineline_store::{ClosedReading, ReadingId, Role, SeenReading, Store, StoreError};

use crate::access::seen_reading;
use crate::problem::Answer;
use crate::user::User;

/// A reading of a study in which this user may place landmarks.
pub enum Markable {
    /// It may be seen.
    Shown(Box<SeenReading>),
    /// It is finished and hidden by its plan.
    Closed(ClosedReading),
}

/// The reading, if this user may place landmarks in its study.
pub fn markable(store: &Store, user: &User, reading: ReadingId) -> Answer<Markable> {
    let closed = store.observer(&user.name).closed(reading)?;
    if let Some(closed) = closed {
        user.need_on_study(store, &closed.study, Role::Editor)?;
        return Ok(Markable::Closed(closed));
    }
    let seen = seen_reading(store, user, reading)?;
    user.need_on_study(store, &seen.study.id, Role::Editor)?;
    Ok(Markable::Shown(Box::new(seen)))
}

/// A reading of a study in which this user may place landmarks, planned or not.
pub fn may_mark(store: &Store, user: &User, reading: ReadingId) -> Answer<SeenReading> {
    match markable(store, user, reading)? {
        Markable::Shown(seen) => Ok(*seen),
        Markable::Closed(_) => Err(StoreError::Finished { reading }.into()),
    }
}
