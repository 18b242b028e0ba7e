//! Limit of attempts to sign in.
//!
//! Rate limiters such as `governor` count requests of an address. This module counts only failures, per account and
//! source. Locks double, end after a quiet time, and use the caller's clock. Failures of one source do not lock others:
//! another address, or a browser that signed in lately, has a separate count.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Mutex, PoisonError};

use axum::http::StatusCode;
use spineline_store::Name;

use crate::problem::Failure;

/// Failures before a lock.
const FREE: u32 = 5;
/// The first lock; each further failure doubles it.
const FIRST_LOCK_MS: i64 = 60_000;
/// The longest lock, and the quiet after which failures are forgotten.
const MAX_LOCK_MS: i64 = 15 * 60_000;
/// Number of counts in memory; beyond it, the oldest are forgotten.
const MAX_COUNTS: usize = 2000;
/// Refused attempts per hour that get an entry in the log: strangers must not fill the disk.
const LOGGED_PER_HOUR: u64 = 300;
const HOUR_MS: i64 = 60 * 60_000;

/// Where an attempt comes from.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    /// A browser that signed in to this account lately, by its proof.
    Device(String),
    /// An address; a network of 2^64 addresses counts as one.
    Address(Option<IpAddr>),
    /// A signed-in user who gives the password again.
    Session,
}

#[derive(Debug, Default, Clone, Copy)]
struct Failures {
    count: u32,
    last_ms: i64,
    locked_until_ms: i64,
}

impl Failures {
    fn add(&mut self, now_ms: i64) {
        self.count = self.count.saturating_add(1);
        self.last_ms = now_ms;
        if let Some(above) = self.count.checked_sub(FREE) {
            let lock_ms = (FIRST_LOCK_MS << above.min(8)).min(MAX_LOCK_MS);
            self.locked_until_ms = now_ms.saturating_add(lock_ms);
        }
    }

    /// If the clock went back, failures are dropped too, so that no lock lasts longer than intended.
    fn is_over(&self, now_ms: i64) -> bool {
        now_ms < self.last_ms || now_ms - self.last_ms >= MAX_LOCK_MS
    }
}

/// Counts attempts to sign in. Every attempt counts as failed until it succeeds, so concurrent attempts gain nothing.
#[derive(Debug, Default)]
pub struct Attempts(Mutex<BTreeMap<(Source, Name), Failures>>);

impl Attempts {
    /// Counts an attempt, or refuses it.
    ///
    /// # Errors
    /// 429, with the time to wait.
    pub fn begin(&self, source: &Source, name: &Name, now_ms: i64) -> Result<(), Failure> {
        let mut counts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        counts.retain(|_, failures| !failures.is_over(now_ms));
        let key = (source.clone(), name.clone());
        if counts.len() >= MAX_COUNTS && !counts.contains_key(&key) {
            let oldest = counts.iter().min_by_key(|(_, failures)| failures.last_ms);
            if let Some(oldest) = oldest.map(|(key, _)| key.clone()) {
                counts.remove(&oldest);
            }
        }
        let failures = counts.entry(key).or_default();
        let wait_ms = failures.locked_until_ms - now_ms;
        if wait_ms > 0 {
            return Err(locked(wait_ms));
        }
        failures.add(now_ms);
        Ok(())
    }

    /// Records that the attempt succeeded.
    pub fn succeeded(&self, source: &Source, name: &Name) {
        let mut counts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        counts.remove(&(source.clone(), name.clone()));
    }
}

fn locked(wait_ms: i64) -> Failure {
    let wait_s = u32::try_from(wait_ms / 1000 + 1).unwrap_or(u32::MAX);
    Failure::new(
        StatusCode::TOO_MANY_REQUESTS,
        "too_many_attempts",
        format!(
            "too many wrong passwords for this account from here; the next attempt is allowed in {wait_s} s"
        ),
    )
    .help("wait, or sign in in a browser in which you signed in during the last 30 days")
    .retry_after(wait_s)
}

/// Which refused attempts get an entry in the log.
#[derive(Debug, Default)]
pub struct LoggedRefusals(Mutex<Hour>);

#[derive(Debug, Default)]
struct Hour {
    begun_ms: i64,
    logged: u64,
    unlogged: u64,
}

impl LoggedRefusals {
    /// For an attempt that gets an entry, the number of earlier ones without.
    pub fn log(&self, now_ms: i64) -> Option<u64> {
        let mut hour = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !(0..HOUR_MS).contains(&now_ms.saturating_sub(hour.begun_ms)) {
            (hour.begun_ms, hour.logged) = (now_ms, 0);
        }
        if hour.logged >= LOGGED_PER_HOUR {
            hour.unlogged += 1;
            return None;
        }
        hour.logged += 1;
        Some(std::mem::take(&mut hour.unlogged))
    }
}

#[cfg(test)]
mod tests {
    use super::{
        Attempts, FREE, HOUR_MS, LOGGED_PER_HOUR, LoggedRefusals, MAX_COUNTS, MAX_LOCK_MS,
    };
    use super::{Name, Source};

    const NOW_MS: i64 = 1_760_000_000_000;

    fn name(text: &str) -> Name {
        Name::new(text).expect("a name")
    }

    fn from(last: u8) -> Source {
        Source::Address(Some([10, 0, 0, last].into()))
    }

    fn locked_out(attempts: &Attempts, source: &Source, account: &Name) {
        for _ in 0..FREE {
            attempts.begin(source, account, NOW_MS).expect("free");
        }
        attempts.begin(source, account, NOW_MS).expect_err("locked");
    }

    #[test]
    fn a_lock_doubles() {
        let (attempts, here, account) = (Attempts::default(), from(1), name("A"));
        let begin = |at_ms| attempts.begin(&here, &account, NOW_MS + at_ms);
        for _ in 0..FREE {
            begin(0).expect("free");
        }
        assert!(begin(59_999).is_err());
        begin(60_000).expect("after a minute");
        assert!(begin(60_000 + 119_999).is_err());
        begin(60_000 + 120_000).expect("after two");
        begin(180_000 + MAX_LOCK_MS).expect("forgotten");
        begin(180_000 + MAX_LOCK_MS).expect("and free again");
    }

    #[test]
    fn failures_lock_no_other_account_address_or_browser() {
        let attempts = Attempts::default();
        for guessed in 0..50 {
            locked_out(&attempts, &from(1), &name(&format!("N{guessed}")));
        }
        let account = name("N0");
        attempts.begin(&from(1), &name("A"), NOW_MS).expect("another account");
        attempts.begin(&from(2), &account, NOW_MS).expect("another address");
        attempts.begin(&Source::Session, &account, NOW_MS).expect("signed in");
        let device = Source::Device("proof".to_owned());
        attempts.begin(&device, &account, NOW_MS).expect("a browser that is known");
        attempts.succeeded(&device, &account);
        assert!(attempts.begin(&from(1), &account, NOW_MS).is_err(), "the lock stays");
    }

    #[test]
    fn names_beyond_the_limit_cause_no_lock() {
        let attempts = Attempts::default();
        for guess in 0..2 * MAX_COUNTS {
            attempts.begin(&from(1), &name(&format!("N{guess}")), NOW_MS).expect("free");
        }
        attempts.begin(&from(2), &name("A"), NOW_MS).expect("free");
        assert!(attempts.0.lock().expect("unlocked").len() <= MAX_COUNTS);
    }

    #[test]
    fn a_successful_attempt_does_not_count_as_a_failure() {
        let (attempts, account) = (Attempts::default(), name("A"));
        for _ in 0..FREE * 3 {
            attempts.begin(&from(1), &account, NOW_MS).expect("free");
            attempts.succeeded(&from(1), &account);
        }
    }

    #[test]
    fn a_clock_that_goes_back_keeps_no_lock() {
        let (attempts, account) = (Attempts::default(), name("A"));
        locked_out(&attempts, &from(1), &account);
        attempts.begin(&from(1), &account, NOW_MS - 1_000_000_000).expect("another time");
    }

    #[test]
    fn refusals_without_number_do_not_fill_the_log() {
        let refusals = LoggedRefusals::default();
        let logged = (0..10_000).filter(|_| refusals.log(NOW_MS) == Some(0)).count();
        assert_eq!(logged as u64, LOGGED_PER_HOUR);
        assert_eq!(refusals.log(NOW_MS + HOUR_MS), Some(10_000 - LOGGED_PER_HOUR));
        assert_eq!(refusals.log(NOW_MS + HOUR_MS), Some(0));
        assert_eq!(refusals.log(NOW_MS - HOUR_MS), Some(0), "a clock that goes back logs again");
    }
}
