//! The stored form of passwords.

use std::fmt;

use argon2::Argon2;
use argon2::password_hash::phc;
use argon2::password_hash::{PasswordHasher, PasswordVerifier};

use crate::error::StoreError;
use crate::guessing::PasswordFault;
use crate::names::Name;

/// Stored form of a password: a salted Argon2id hash. Hashing takes time and memory by design, so hash before the store is
/// locked.
#[derive(Clone, PartialEq, Eq)]
pub struct PasswordHash(pub(crate) String);

impl fmt::Debug for PasswordHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("PasswordHash")
    }
}

impl PasswordHash {
    /// Hashes a password of an account: at least 12 characters and at most 1024 bytes, and not easy to guess.
    ///
    /// # Errors
    /// [`StoreError::BadPassword`].
    ///
    /// # Panics
    /// If the system's random numbers fail.
    pub fn new(password: &str, account: &Name) -> Result<Self, StoreError> {
        match PasswordFault::of(password, account) {
            Some(fault) => Err(StoreError::BadPassword(fault)),
            None => Ok(Self::of_any(password)),
        }
    }

    pub(crate) fn of_any(password: &str) -> Self {
        let mut salt = [0_u8; 16];
        getrandom::fill(&mut salt).expect("the system has random numbers");
        let hash: phc::PasswordHash = Argon2::default()
            .hash_password_with_salt(password.as_bytes(), &salt)
            .expect("the default parameters and a salt of 16 bytes are allowed");
        Self(hash.to_string())
    }

    pub(crate) fn is_of(&self, password: &str) -> bool {
        let hash = phc::PasswordHash::new(&self.0);
        hash.is_ok_and(|hash| Argon2::default().verify_password(password.as_bytes(), &hash).is_ok())
    }
}
