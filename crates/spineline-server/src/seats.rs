//! Places of connections. Nobody knows whose a connection is before its first request, so that strangers cannot be turned
//! away at the door: where their places are taken, a connection of the address that has most of them is closed for the newest.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use spineline_store::Name;
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
    strangers: BTreeMap<u64, Stranger>,
    /// Who was signed in on the others.
    users: BTreeMap<u64, Name>,
}

struct Stranger {
    address: Option<IpAddr>,
    closed: Arc<Notify>,
}

impl Taken {
    /// Takes the oldest connection of the address that has most.
    fn pop_stranger(&mut self) -> Option<Stranger> {
        let mut counts: BTreeMap<Option<IpAddr>, usize> = BTreeMap::new();
        for stranger in self.strangers.values() {
            *counts.entry(stranger.address).or_default() += 1;
        }
        let most = counts.values().copied().max()?;
        let has_most = |stranger: &Stranger| counts.get(&stranger.address) == Some(&most);
        let oldest = self.strangers.iter().find(|(_, stranger)| has_most(stranger));
        let oldest = oldest.map(|(number, _)| *number)?;
        self.strangers.remove(&oldest)
    }
}

/// The place of one connection, until it is dropped.
pub struct Seat {
    seats: Seats,
    number: u64,
    address: Option<IpAddr>,
    closed: Arc<Notify>,
}

/// What the requests of a connection know of its place.
#[derive(Clone)]
pub struct SeatOf {
    seats: Seats,
    number: u64,
    address: Option<IpAddr>,
}

impl Seats {
    pub fn new(shares: Shares) -> Self {
        Self { shares, taken: Arc::default() }
    }

    fn taken(&self) -> MutexGuard<'_, Taken> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A place for a new connection from an address.
    pub fn take(&self, address: Option<IpAddr>) -> Seat {
        let mut taken = self.taken();
        while taken.strangers.len() >= self.shares.strangers.max(1) {
            if let Some(oldest) = taken.pop_stranger() {
                oldest.closed.notify_one();
            }
        }
        let (number, closed) = (taken.next, Arc::new(Notify::new()));
        taken.next += 1;
        taken.strangers.insert(number, Stranger { address, closed: Arc::clone(&closed) });
        Seat { seats: self.clone(), number, address, closed }
    }
}

impl Seat {
    /// Ends when the place is needed for another connection.
    pub async fn closed(&self) {
        self.closed.notified().await;
    }

    pub fn for_requests(&self) -> SeatOf {
        SeatOf { seats: self.seats.clone(), number: self.number, address: self.address }
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
    /// Where the connection comes from.
    pub fn address(&self) -> Option<IpAddr> {
        self.address
    }

    /// Somebody who is signed in uses this connection: it is closed for no stranger, while there are places for users and
    /// this one has not taken a share of them.
    pub fn keep(&self, who: &Name) {
        let mut taken = self.seats.taken();
        let room = self.seats.shares.users;
        let own = taken.users.values().filter(|user| *user == who).count();
        if taken.users.len() < room.all
            && own < room.each
            && taken.strangers.remove(&self.number).is_some()
        {
            taken.users.insert(self.number, who.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{IpAddr, Name, Seat, Seats, Shares};
    use crate::limits::Places;

    const USERS: Places = Places { all: 3, each: 1 };

    fn name(text: &str) -> Name {
        Name::new(text).expect("a name")
    }

    async fn is_closed(seat: &Seat) -> bool {
        tokio::select! {
            biased;
            () = seat.closed() => true,
            () = std::future::ready(()) => false,
        }
    }

    #[tokio::test]
    async fn the_oldest_stranger_goes_and_no_user_does() {
        let seats = Seats::new(Shares { users: USERS, strangers: 2 });
        let user = seats.take(None);
        user.for_requests().keep(&name("A"));
        let strangers: Vec<Seat> = (0..4).map(|_| seats.take(None)).collect();
        assert!(!is_closed(&user).await);
        let mut closed = Vec::new();
        for seat in &strangers {
            closed.push(is_closed(seat).await);
        }
        assert_eq!(closed, [true, true, false, false]);
        drop(strangers);
        let (first, second) = (seats.take(None), seats.take(None));
        assert!(!is_closed(&first).await && !is_closed(&second).await, "places come free");
        first.for_requests().keep(&name("A"));
        assert_eq!(seats.taken().users.len(), 1, "one account takes its share only");
        first.for_requests().keep(&name("B"));
        assert_eq!(seats.taken().users.len(), 2);
    }

    #[tokio::test]
    async fn a_crowd_at_one_address_closes_its_own_connections() {
        let seats = Seats::new(Shares { users: USERS, strangers: 3 });
        let address = |last: u8| Some(IpAddr::from([10, 0, 0, last]));
        let alone = seats.take(address(1));
        let crowd: Vec<Seat> = (0..6).map(|_| seats.take(address(2))).collect();
        assert!(!is_closed(&alone).await);
        assert!(is_closed(&crowd[0]).await && !is_closed(&crowd[5]).await);
    }
}
