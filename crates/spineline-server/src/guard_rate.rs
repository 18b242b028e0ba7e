//! Limit of attempts to sign in.
//!
//! Rate limiters such as `governor` count requests of an address; here failures count alone, by account name, with locks that
//! double and end with quiet, and by the clock that the caller gives.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use crate::problem::Failure;
use axum::http::StatusCode;

/// Failures of one name before it is locked.
const FREE: u32 = 5;
/// Failures under all names before everybody is locked out.
const FREE_IN_ALL: u32 = 50;
/// The first lock; each further failure doubles it.
const FIRST_LOCK_MS: i64 = 60_000;
/// The longest lock, and the quiet after which failures are forgotten.
const MAX_LOCK_MS: i64 = 15 * 60_000;
/// Names that are remembered. Failures of further ones count for all of them together.
const MAX_NAMES: usize = 1000;

#[derive(Debug, Default, Clone, Copy)]
struct Failures {
    count: u32,
    last_ms: i64,
    locked_until_ms: i64,
}

impl Failures {
    fn add(&mut self, now_ms: i64, free: u32) {
        self.count = self.count.saturating_add(1);
        self.last_ms = now_ms;
        if let Some(above) = self.count.checked_sub(free) {
            let lock_ms = (FIRST_LOCK_MS << above.min(8)).min(MAX_LOCK_MS);
            self.locked_until_ms = now_ms.saturating_add(lock_ms);
        }
    }

    /// If the clock went back, failures are dropped too, so that no lock lasts longer than intended.
    fn is_over(&self, now_ms: i64) -> bool {
        now_ms < self.last_ms || now_ms - self.last_ms >= MAX_LOCK_MS
    }
}

#[derive(Debug, Default)]
struct Counted {
    names: BTreeMap<String, Failures>,
    others: Failures,
    all: Failures,
}

/// Counts attempts to sign in. Every attempt counts as failed until it has succeeded, so that many at once gain nothing.
#[derive(Debug, Default)]
pub struct Attempts(Mutex<Counted>);

impl Attempts {
    /// Counts an attempt, or refuses it.
    ///
    /// # Errors
    /// 429, with the time to wait.
    pub fn begin(&self, name: &str, now_ms: i64) -> Result<(), Failure> {
        let mut counted = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Counted { names, others, all } = &mut *counted;
        names.retain(|_, failures| !failures.is_over(now_ms));
        for failures in [&mut *others, &mut *all] {
            if failures.is_over(now_ms) {
                *failures = Failures::default();
            }
        }
        let is_full = names.len() >= MAX_NAMES && !names.contains_key(name);
        let own = if is_full { others } else { names.entry(name.to_owned()).or_default() };
        let wait_ms = own.locked_until_ms.max(all.locked_until_ms) - now_ms;
        if wait_ms > 0 {
            return Err(locked(wait_ms));
        }
        own.add(now_ms, FREE);
        all.add(now_ms, FREE_IN_ALL);
        Ok(())
    }

    /// Records that the attempt succeeded.
    pub fn succeeded(&self, name: &str) {
        let mut counted = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let failures = counted.names.remove(name).map_or(0, |failures| failures.count);
        counted.all.count = counted.all.count.saturating_sub(failures);
        if counted.all.count < FREE_IN_ALL {
            counted.all.locked_until_ms = 0;
        }
    }
}

fn locked(wait_ms: i64) -> Failure {
    let wait_s = u32::try_from(wait_ms / 1000 + 1).unwrap_or(u32::MAX);
    Failure::new(
        StatusCode::TOO_MANY_REQUESTS,
        "too_many_attempts",
        format!("too many attempts to sign in; the next one is allowed in {wait_s} s"),
    )
    .retry_after(wait_s)
}

#[cfg(test)]
mod tests {
    use super::{Attempts, FREE, FREE_IN_ALL, MAX_LOCK_MS};

    const NOW_MS: i64 = 1_760_000_000_000;

    #[test]
    fn the_lock_of_a_name_doubles() {
        let attempts = Attempts::default();
        for _ in 0..FREE {
            attempts.begin("A", NOW_MS).expect("free");
        }
        assert!(attempts.begin("A", NOW_MS + 59_999).is_err());
        attempts.begin("B", NOW_MS).expect("another name");
        attempts.begin("A", NOW_MS + 60_000).expect("after a minute");
        assert!(attempts.begin("A", NOW_MS + 60_000 + 119_999).is_err());
        attempts.begin("A", NOW_MS + 60_000 + 120_000).expect("after two");
        attempts.begin("A", NOW_MS + 180_000 + MAX_LOCK_MS).expect("forgotten");
        attempts.begin("A", NOW_MS + 180_000 + MAX_LOCK_MS).expect("and free again");
    }

    #[test]
    fn a_successful_attempt_does_not_count_as_a_failure() {
        let attempts = Attempts::default();
        for _ in 0..FREE_IN_ALL * 3 {
            attempts.begin("A", NOW_MS).expect("free");
            attempts.succeeded("A");
        }
    }

    #[test]
    fn failures_under_many_names_lock_all_names() {
        let attempts = Attempts::default();
        for guess in 0..FREE_IN_ALL {
            attempts.begin(&format!("N{guess}"), NOW_MS).expect("free");
        }
        assert!(attempts.begin("A", NOW_MS).is_err());
        attempts.begin("A", NOW_MS + 60_000).expect("after a minute");
    }

    #[test]
    fn a_clock_that_goes_back_keeps_no_lock() {
        let attempts = Attempts::default();
        for _ in 0..FREE {
            attempts.begin("A", NOW_MS).expect("free");
        }
        attempts.begin("A", NOW_MS - 1_000_000_000).expect("another time");
    }
}
