//! Places for running requests. A request takes one when its body has arrived, or waits for it briefly. Each user has a
//! limited share, and clicks have their own places.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use axum::http::StatusCode;
use spineline_store::Name;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

use crate::limits::{Places, RequestPlaces};
use crate::problem::{Answer, Failure};

/// How long a request waits for a place.
const WAIT: Duration = Duration::from_secs(5);

/// Owner of a share of places.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Whose {
    /// An account, or an observer with the token.
    Account(Name),
    /// Everybody at an address.
    Address(Option<IpAddr>),
}

/// What a request is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Work {
    /// Recording landmarks.
    Click,
    /// Everything else of somebody who is signed in.
    Other,
    /// Signing in from a browser that signed in lately.
    KnownSignIn,
    /// Everything of strangers.
    Stranger,
}

pub struct Rooms {
    clicks: Room,
    users: Room,
    known: Room,
    strangers: Room,
}

/// A place, until it is dropped.
pub struct Place {
    _of_share: OwnedSemaphorePermit,
    _of_all: OwnedSemaphorePermit,
}

struct Room {
    each: usize,
    all: Arc<Semaphore>,
    shares: Mutex<BTreeMap<Whose, Arc<Semaphore>>>,
}

impl Rooms {
    pub fn new(places: RequestPlaces) -> Self {
        let RequestPlaces { clicks, users, known, strangers } = places;
        let [clicks, users, known, strangers] = [clicks, users, known, strangers].map(Room::new);
        Self { clicks, users, known, strangers }
    }

    /// Waits for a free place and takes it.
    ///
    /// # Errors
    /// 503 if all places stay taken for some seconds.
    pub async fn take(&self, work: Work, whose: Whose) -> Answer<Place> {
        let room = match work {
            Work::Click => &self.clicks,
            Work::Other => &self.users,
            Work::KnownSignIn => &self.known,
            Work::Stranger => &self.strangers,
        };
        room.take(whose).await.ok_or_else(|| {
            Failure::new(StatusCode::SERVICE_UNAVAILABLE, "busy", "too many requests at once")
                .help("wait a moment and try again")
                .retry_after(1)
        })
    }
}

impl Room {
    fn new(places: Places) -> Self {
        let all = Arc::new(Semaphore::new(places.all));
        Self { each: places.each, all, shares: Mutex::default() }
    }

    async fn take(&self, whose: Whose) -> Option<Place> {
        let share = self.share(whose);
        let both = async {
            // The share first, so that a waiting user takes no place from others.
            let of_share = share.acquire_owned().await.ok()?;
            let of_all = Arc::clone(&self.all).acquire_owned().await.ok()?;
            Some(Place { _of_share: of_share, _of_all: of_all })
        };
        timeout(WAIT, both).await.ok().flatten()
    }

    fn share(&self, whose: Whose) -> Arc<Semaphore> {
        let mut shares = self.shares.lock().unwrap_or_else(PoisonError::into_inner);
        // An unused share is removed, and made again when it is needed.
        shares.retain(|_, share| Arc::strong_count(share) > 1);
        let whole = || Arc::new(Semaphore::new(self.each));
        Arc::clone(shares.entry(whose).or_insert_with(whole))
    }
}

#[cfg(test)]
mod tests {
    use super::{Name, Place, Places, Room, Whose};

    fn account(name: &str) -> Whose {
        Whose::Account(Name::new(name).expect("a name"))
    }

    #[tokio::test(start_paused = true)]
    async fn one_user_takes_at_most_a_share() {
        let room = Room::new(Places { all: 5, each: 2 });
        let mut taken: Vec<Place> = Vec::new();
        for _ in 0..2 {
            taken.push(room.take(account("A")).await.expect("a place"));
        }
        assert!(room.take(account("A")).await.is_none(), "a third one of A");
        for name in ["B", "B", "C"] {
            taken.push(room.take(account(name)).await.expect("places of others"));
        }
        assert!(room.take(account("C")).await.is_none(), "the room is full");
        assert!(room.take(Whose::Address(None)).await.is_none());
        taken.remove(0);
        taken.push(room.take(account("A")).await.expect("a place came free"));
        drop(taken);
        assert!(room.take(account("D")).await.is_some());
        assert_eq!(room.shares.lock().expect("unlocked").len(), 1, "idle shares are forgotten");
    }

    #[tokio::test(start_paused = true)]
    async fn who_waits_gets_the_place_that_comes_free() {
        let room = Room::new(Places { all: 1, each: 1 });
        let first = room.take(account("A")).await.expect("a place");
        let later = async {
            tokio::time::sleep(std::time::Duration::from_secs(3)).await;
            drop(first);
        };
        let (second, ()) = tokio::join!(room.take(account("B")), later);
        assert!(second.is_some());
    }
}
