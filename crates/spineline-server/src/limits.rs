//! What the server takes at once, from whom, and how long it waits.

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
    pub body: Pace,
    /// How often an event stream asks whether it still may run: sessions end by time, and other programs change accounts.
    /// What this server changes ends a stream at once.
    pub recheck: Duration,
    /// Uploaded films that are not in a study.
    pub uploads: UploadLimits,
    /// How long and how large an answer of an image archive may be.
    pub archive: spineline_dicomweb::Limits,
}

/// Places for those who are signed in, and for everybody else: neither takes the other's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shares {
    /// For those who are signed in.
    pub users: Places,
    /// For everybody else.
    pub strangers: usize,
}

/// Places, and the most of them that one account or address takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Places {
    /// All.
    pub all: usize,
    /// Of one account or address.
    pub each: usize,
}

/// Places for requests, by what they are for: no work takes the places of another.
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

/// The least pace of a body: it has `grace`, and a second more for every `bytes_per_s` that arrived.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pace {
    /// Time that any body has.
    pub grace: Duration,
    /// Bytes that give it another second.
    pub bytes_per_s: u64,
}

/// How many uploaded films may wait for a study, and for how long.
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
    /// A request holds a body of at most some megabytes, and uploads have their own limit. The slowest body is that of a film
    /// over a poor line.
    fn default() -> Self {
        Self {
            connections: Shares { users: Places { all: 192, each: 64 }, strangers: 128 },
            requests: RequestPlaces {
                clicks: Places { all: 32, each: 6 },
                users: Places { all: 48, each: 8 },
                known: Places { all: 8, each: 2 },
                strangers: Places { all: 16, each: 8 },
            },
            body: Pace { grace: Duration::from_secs(30), bytes_per_s: 16 << 10 },
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
