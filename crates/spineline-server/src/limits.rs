//! Limits of the server: concurrent work, shares and waiting times.

use std::time::Duration;

use spineline_films::FilmLimits;

/// Limits of a server. The default is for use; tests set others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ServeLimits {
    /// Connections at once.
    pub connections: Shares,
    /// Requests that are answered at once.
    pub requests: RequestPlaces,
    /// How fast a body must arrive.
    pub body: BodyRate,
    /// How often an event stream checks its rights: sessions expire, and other programs change accounts. Changes by
    /// this server end a stream at once.
    pub recheck: Duration,
    /// Uploaded films that are not in a study.
    pub uploads: UploadLimits,
    /// How long and how large an answer of an image archive may be.
    pub archive: spineline_dicomweb::Limits,
}

/// Places for signed-in users and for everybody else: neither takes the other's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shares {
    /// For those who are signed in.
    pub users: Places,
    /// For everybody else.
    pub strangers: usize,
}

/// Places in all, and the maximum for one account or address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Places {
    /// All.
    pub all: usize,
    /// Of one account or address.
    pub each: usize,
}

/// Places for requests by purpose: each purpose has its own places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RequestPlaces {
    /// Recording landmarks.
    pub clicks: Places,
    /// Everything else of those who are signed in.
    pub users: Places,
    /// Signing in from a browser that signed in lately.
    pub known: Places,
    /// Everybody else.
    pub strangers: Places,
}

/// The minimum rate of a body: it may take `grace`, and one second more per `bytes_per_s` received.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BodyRate {
    /// Time that every body has.
    pub grace: Duration,
    /// Bytes that add one second.
    pub bytes_per_s: u64,
}

/// Number of uploaded films that may wait for a study, and their time limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UploadLimits {
    /// How long each is kept.
    pub kept: Duration,
    /// Of one account.
    pub per_account: UploadRoom,
    /// Of all accounts.
    pub in_all: UploadRoom,
}

/// Room for uploads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UploadRoom {
    /// Films.
    pub films: usize,
    /// Bytes of their files.
    pub bytes: u64,
}

impl Default for ServeLimits {
    /// A request holds at most a few megabytes in memory, and uploads have their own limit. The slowest body is a film
    /// on a slow network.
    fn default() -> Self {
        Self {
            connections: Shares { users: Places { all: 192, each: 64 }, strangers: 128 },
            requests: RequestPlaces {
                clicks: Places { all: 32, each: 6 },
                users: Places { all: 48, each: 8 },
                known: Places { all: 8, each: 2 },
                strangers: Places { all: 16, each: 8 },
            },
            body: BodyRate { grace: Duration::from_secs(30), bytes_per_s: 16 << 10 },
            recheck: Duration::from_secs(5),
            uploads: UploadLimits {
                kept: Duration::from_secs(60 * 60),
                per_account: UploadRoom { films: 32, bytes: 400 << 20 },
                in_all: UploadRoom { films: 128, bytes: 800 << 20 },
            },
            archive: spineline_dicomweb::Limits {
                connect: Duration::from_secs(5),
                search: Duration::from_secs(20),
                search_bytes: 4 << 20,
                film: Duration::from_secs(180),
                film_bytes: FilmLimits::default().file_bytes,
            },
        }
    }
}
