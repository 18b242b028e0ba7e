//! Places of connections. Nobody knows whose a connection is before its first request, so that strangers cannot be turned
//! away at the door: where their places are taken, the oldest of their connections is closed for the newest.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use crate::limits::Shares;

/// All places.
#[derive(Clone)]
pub struct Seats {
    shares: Shares,
    taken: Arc<Mutex<Taken>>,
}

#[derive(Default)]
struct Taken {
    next: u64,
    /// Connections on which nobody has been signed in, oldest first.
    strangers: BTreeMap<u64, Arc<Notify>>,
    users: BTreeSet<u64>,
}

/// The place of one connection, until it is dropped.
pub struct Seat {
    seats: Seats,
    number: u64,
    closed: Arc<Notify>,
}

/// What the requests of a connection know of its place.
#[derive(Clone)]
pub struct SeatOf {
    seats: Seats,
    number: u64,
}

impl Seats {
    pub fn new(shares: Shares) -> Self {
        Self { shares, taken: Arc::default() }
    }

    fn taken(&self) -> MutexGuard<'_, Taken> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A place for a new connection.
    pub fn take(&self) -> Seat {
        let mut taken = self.taken();
        while taken.strangers.len() >= self.shares.strangers.max(1) {
            if let Some((_, oldest)) = taken.strangers.pop_first() {
                oldest.notify_one();
            }
        }
        let (number, closed) = (taken.next, Arc::new(Notify::new()));
        taken.next += 1;
        taken.strangers.insert(number, Arc::clone(&closed));
        Seat { seats: self.clone(), number, closed }
    }
}

impl Seat {
    /// Ends when the place is needed for another connection.
    pub async fn closed(&self) {
        self.closed.notified().await;
    }

    pub fn for_requests(&self) -> SeatOf {
        SeatOf { seats: self.seats.clone(), number: self.number }
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        let mut taken = self.seats.taken();
        taken.strangers.remove(&self.number);
        taken.users.remove(&self.number);
    }
}

impl SeatOf {
    /// Somebody who is signed in uses this connection: it is closed for no stranger, while there are places for users.
    pub fn keep(&self) {
        let mut taken = self.seats.taken();
        if taken.users.len() < self.seats.shares.users
            && taken.strangers.remove(&self.number).is_some()
        {
            taken.users.insert(self.number);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Seat, Seats, Shares};

    async fn is_closed(seat: &Seat) -> bool {
        tokio::select! {
            biased;
            () = seat.closed() => true,
            () = std::future::ready(()) => false,
        }
    }

    #[tokio::test]
    async fn the_oldest_stranger_goes_and_no_user_does() {
        let seats = Seats::new(Shares { users: 1, strangers: 2 });
        let user = seats.take();
        user.for_requests().keep();
        let strangers: Vec<Seat> = (0..4).map(|_| seats.take()).collect();
        assert!(!is_closed(&user).await);
        let mut closed = Vec::new();
        for seat in &strangers {
            closed.push(is_closed(seat).await);
        }
        assert_eq!(closed, [true, true, false, false]);
        drop(strangers);
        let (first, second) = (seats.take(), seats.take());
        assert!(!is_closed(&first).await && !is_closed(&second).await, "places come free");
        first.for_requests().keep();
        assert_eq!(seats.taken().users.len(), 1, "users have a limit too");
    }
}
