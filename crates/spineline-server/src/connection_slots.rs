//! Slots for connections. The user of a connection is unknown before its first request, so strangers cannot be refused
//! at once: if their slots are full, the oldest connection of the address with most connections is closed for a new
//! one.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use spineline_store::Name;
use tokio::sync::Notify;

use crate::limits::Shares;

/// All places.
#[derive(Clone)]
pub struct ConnectionSlots {
    shares: Shares,
    taken: Arc<Mutex<Taken>>,
}

#[derive(Default)]
struct Taken {
    next: u64,
    /// Connections without a signed-in user, oldest first.
    strangers: BTreeMap<u64, Stranger>,
    /// Users of the other connections.
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
pub struct ConnectionSlot {
    slots: ConnectionSlots,
    number: u64,
    address: Option<IpAddr>,
    closed: Arc<Notify>,
}

/// The slot, for the requests of its connection.
#[derive(Clone)]
pub struct RequestSlot {
    slots: ConnectionSlots,
    number: u64,
    address: Option<IpAddr>,
}

impl ConnectionSlots {
    pub fn new(shares: Shares) -> Self {
        Self { shares, taken: Arc::default() }
    }

    fn taken(&self) -> MutexGuard<'_, Taken> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A slot for a new connection from an address.
    pub fn take(&self, address: Option<IpAddr>) -> ConnectionSlot {
        let mut taken = self.taken();
        while taken.strangers.len() >= self.shares.strangers.max(1) {
            if let Some(oldest) = taken.pop_stranger() {
                oldest.closed.notify_one();
            }
        }
        let (number, closed) = (taken.next, Arc::new(Notify::new()));
        taken.next += 1;
        taken.strangers.insert(number, Stranger { address, closed: Arc::clone(&closed) });
        ConnectionSlot { slots: self.clone(), number, address, closed }
    }
}

impl ConnectionSlot {
    /// Ends when the slot is needed for another connection.
    pub async fn closed(&self) {
        self.closed.notified().await;
    }

    pub fn for_requests(&self) -> RequestSlot {
        RequestSlot { slots: self.slots.clone(), number: self.number, address: self.address }
    }
}

impl Drop for ConnectionSlot {
    fn drop(&mut self) {
        let mut taken = self.slots.taken();
        taken.strangers.remove(&self.number);
        taken.users.remove(&self.number);
    }
}

impl RequestSlot {
    /// The address of the connection.
    pub fn address(&self) -> Option<IpAddr> {
        self.address
    }

    /// Marks this connection as a signed-in user's: it is not closed for strangers, as long as slots for users and the
    /// user's share allow it.
    pub fn keep(&self, who: &Name) {
        let mut taken = self.slots.taken();
        let room = self.slots.shares.users;
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
    use super::{ConnectionSlot, ConnectionSlots, IpAddr, Name, Shares};
    use crate::limits::Places;

    const USERS: Places = Places { all: 3, each: 1 };

    fn name(text: &str) -> Name {
        Name::new(text).expect("a name")
    }

    async fn is_closed(slot: &ConnectionSlot) -> bool {
        tokio::select! {
            biased;
            () = slot.closed() => true,
            () = std::future::ready(()) => false,
        }
    }

    #[tokio::test]
    async fn the_oldest_stranger_goes_and_no_user_does() {
        let slots = ConnectionSlots::new(Shares { users: USERS, strangers: 2 });
        let user = slots.take(None);
        user.for_requests().keep(&name("A"));
        let strangers: Vec<ConnectionSlot> = (0..4).map(|_| slots.take(None)).collect();
        assert!(!is_closed(&user).await);
        let mut closed = Vec::new();
        for slot in &strangers {
            closed.push(is_closed(slot).await);
        }
        assert_eq!(closed, [true, true, false, false]);
        drop(strangers);
        let (first, second) = (slots.take(None), slots.take(None));
        assert!(!is_closed(&first).await && !is_closed(&second).await, "places come free");
        first.for_requests().keep(&name("A"));
        assert_eq!(slots.taken().users.len(), 1, "one account takes its share only");
        first.for_requests().keep(&name("B"));
        assert_eq!(slots.taken().users.len(), 2);
    }

    #[tokio::test]
    async fn a_crowd_at_one_address_closes_its_own_connections() {
        let slots = ConnectionSlots::new(Shares { users: USERS, strangers: 3 });
        let address = |last: u8| Some(IpAddr::from([10, 0, 0, last]));
        let alone = slots.take(address(1));
        let crowd: Vec<ConnectionSlot> = (0..6).map(|_| slots.take(address(2))).collect();
        assert!(!is_closed(&alone).await);
        assert!(is_closed(&crowd[0]).await && !is_closed(&crowd[5]).await);
    }
}
