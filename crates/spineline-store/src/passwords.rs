//! Passwords: which are refused, their stored form, and browsers that have proved to know one.

use std::fmt;
use std::sync::OnceLock;

use argon2::Argon2;
use argon2::password_hash::phc;
use argon2::password_hash::{PasswordHasher, PasswordVerifier};
use rusqlite::params;

use crate::accounts::{self, Account};
use crate::audit;
use crate::connection::Store;
use crate::error::StoreError;
use crate::guessing;
use crate::names::{Hash, Name, Signature, Timestamp};
use crate::sessions;

/// Minimum number of characters of a password.
const MIN_CHARACTERS: usize = 12;
/// Maximum number of bytes of a password.
const MAX_BYTES: usize = 1024;
/// Minimum number of different characters, without blanks.
const MIN_DIFFERENT: usize = 5;
/// Minimum number of characters that nothing before them foretells.
const MIN_UNFORESEEN: usize = 8;
/// How long a browser that signed in is known, in milliseconds: 30 days.
const DEVICE_MS: i64 = 30 * 24 * 60 * 60 * 1000;

/// Why a password is refused. It does not repeat the password.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PasswordFault {
    /// Too few characters.
    #[error("the password has {found} characters; it needs at least {MIN_CHARACTERS} characters")]
    Short {
        /// Its characters.
        found: usize,
    },
    /// Too many bytes.
    #[error("the password has {found} bytes; the limit is {MAX_BYTES} bytes")]
    Long {
        /// Its bytes.
        found: usize,
    },
    /// Few different characters.
    #[error(
        "the password has {found} different characters, not counting blanks; it needs at least {MIN_DIFFERENT}"
    )]
    Uniform {
        /// Its different characters.
        found: usize,
    },
    /// Runs, repetitions, common words or the account's name.
    #[error(
        "the password has {found} characters outside of runs (such as abcd or qwertz), repetitions, common words and the account's name; it needs at least {MIN_UNFORESEEN}"
    )]
    Foreseen {
        /// Its other characters.
        found: usize,
    },
}

impl PasswordFault {
    fn of(password: &str, account: &Name) -> Option<Self> {
        let characters = password.chars().count();
        if characters < MIN_CHARACTERS {
            return Some(Self::Short { found: characters });
        }
        if password.len() > MAX_BYTES {
            return Some(Self::Long { found: password.len() });
        }
        let different = guessing::different(password);
        if different < MIN_DIFFERENT {
            return Some(Self::Uniform { found: different });
        }
        let unforeseen = guessing::unforeseen(password, account);
        (unforeseen < MIN_UNFORESEEN).then_some(Self::Foreseen { found: unforeseen })
    }
}

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
    /// If the system has no random numbers.
    pub fn new(password: &str, account: &Name) -> Result<Self, StoreError> {
        match PasswordFault::of(password, account) {
            Some(fault) => Err(StoreError::BadPassword(fault)),
            None => Ok(Self::of_any(password)),
        }
    }

    fn of_any(password: &str) -> Self {
        let mut salt = [0_u8; 16];
        getrandom::fill(&mut salt).expect("the system has random numbers");
        let hash: phc::PasswordHash = Argon2::default()
            .hash_password_with_salt(password.as_bytes(), &salt)
            .expect("the default parameters and a salt of 16 bytes are allowed");
        Self(hash.to_string())
    }

    fn is_of(&self, password: &str) -> bool {
        let hash = phc::PasswordHash::new(&self.0);
        hash.is_ok_and(|hash| Argon2::default().verify_password(password.as_bytes(), &hash).is_ok())
    }
}

/// Hash with which a password is compared. The comparison takes time and memory by design, so compare after the store is
/// released.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Credential {
    account: Option<Account>,
    password: PasswordHash,
}

impl Credential {
    /// The account, if the password is its own and it may sign in. An unknown name takes as long as a wrong password.
    #[must_use]
    pub fn check(&self, password: &str) -> Option<&Account> {
        let right = password.len() <= MAX_BYTES && self.password.is_of(password);
        self.account.as_ref().filter(|account| right && account.enabled)
    }

    /// Proof that a browser signed in to this account at this time. It signs nobody in; a new password ends it.
    #[must_use]
    pub fn device(&self, at: Timestamp) -> Option<String> {
        let account = self.account.as_ref()?;
        Some(self.proof(&account.name, at.unix_ms()))
    }

    fn proof(&self, name: &Name, at_ms: i64) -> String {
        let proof =
            Hash::of(format!("spineline device {name} {at_ms} {}", self.password.0).as_bytes());
        format!("{name}/{at_ms}/{proof}")
    }

    fn has_made(&self, device: &str, name: &Name, at_ms: i64) -> bool {
        // Equal hashes, not the proofs themselves: the time of the comparison tells nothing of the proof.
        self.account.is_some()
            && Hash::of(self.proof(name, at_ms).as_bytes()) == Hash::of(device.as_bytes())
    }
}

impl Store {
    /// Hash with which a password for this name is compared, whether or not the account exists.
    ///
    /// # Errors
    /// [`StoreError::Damaged`].
    pub fn credential(&self, name: &Name) -> Result<Credential, StoreError> {
        static NOBODY: OnceLock<PasswordHash> = OnceLock::new();
        let condition = "WHERE name = ?1";
        let found = audit::load(&self.connection, "accounts", condition, [name.as_str()], |row| {
            let (account, password) = (accounts::read(row)?, PasswordHash(row.get("password")?));
            Ok(Credential { account: Some(account), password })
        })?;
        Ok(found.into_iter().next().unwrap_or_else(|| Credential {
            account: None,
            password: NOBODY.get_or_init(|| PasswordHash::of_any("nobody")).clone(),
        }))
    }

    /// The account to which a browser signed in during the last 30 days, by the proof that it got then
    /// ([`Credential::device`]).
    ///
    /// # Errors
    /// [`StoreError::Damaged`].
    pub fn known_device(&self, device: &str, now: Timestamp) -> Result<Option<Name>, StoreError> {
        let mut parts = device.split('/');
        let (name, at_ms) = (parts.next().and_then(Name::checked), parts.next());
        let (Some(name), Some(Ok(at_ms))) = (name, at_ms.map(str::parse::<i64>)) else {
            return Ok(None);
        };
        let is_recent = (0..DEVICE_MS).contains(&now.unix_ms().saturating_sub(at_ms));
        let is_known = is_recent && self.credential(&name)?.has_made(device, &name, at_ms);
        Ok(is_known.then_some(name))
    }

    /// Gives an account another password, if it still has the one that was checked; all its sessions end.
    ///
    /// # Errors
    /// [`StoreError::Unknown`] where the password was changed meanwhile.
    pub fn change_password(
        &mut self,
        checked: &Credential,
        password: &PasswordHash,
        by: &Signature,
    ) -> Result<(), StoreError> {
        let name = by.who.clone();
        self.write(by, |ledger| {
            accounts::account(ledger.transaction, &name)?;
            let changed = ledger.transaction.execute(
                "UPDATE accounts SET password = ?3 WHERE name = ?1 AND password = ?2",
                params![name.as_str(), checked.password.0, password.0],
            )?;
            if changed == 0 {
                return Err(StoreError::Unknown { object: format!("account/{name}") });
            }
            ledger.seal("edit", "accounts", &name.as_str())?;
            sessions::end_all(ledger.transaction, &name)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::PasswordFault;
    use crate::names::Name;

    fn fault(password: &str, account: &str) -> Option<PasswordFault> {
        PasswordFault::of(password, &Name::new(account).expect("a name"))
    }

    #[test]
    fn short_and_long_passwords_are_refused() {
        assert_eq!(fault("elevenchars", "lead"), Some(PasswordFault::Short { found: 11 }));
        let long = "a long sentence ".repeat(65);
        assert_eq!(fault(&long, "lead"), Some(PasswordFault::Long { found: 1040 }));
    }

    #[test]
    fn passwords_of_few_different_characters_are_refused() {
        for (password, found) in [
            ("aaaaaaaaaaaa", 1),
            ("AaAaAaAaAaAa", 1),
            ("            ", 0),
            ("\u{a0}\u{2003}\u{3000}\t\u{a0}\u{2003}\u{3000}\t\u{a0}\u{2003}\u{3000}\t", 0),
            (
                "\u{200b}\u{200c}\u{200d}\u{2060}\u{feff}\u{200b}\u{200c}\u{200d}\u{2060}\u{feff}\u{200b}\u{200c}",
                0,
            ),
            ("ab ab  ab ab ab", 2),
            ("112211221122", 2),
            ("........,,,,;", 3),
            ("éeéeéeéeéeéeé", 2),
        ] {
            assert_eq!(
                fault(password, "lead"),
                Some(PasswordFault::Uniform { found }),
                "{password}"
            );
        }
    }

    #[test]
    fn runs_repetitions_common_words_and_the_accounts_name_are_refused() {
        for password in [
            "abcdefghijkl",
            "ABCDEFGHIJKLM",
            "lkjihgfedcba",
            "123456789012",
            "098765432109",
            "acegikmoqsuwy",
            "qwertyuiopasdf",
            "qwertzuiopasd",
            "azertyuiop123",
            "poiuytrewq123",
            "1q2w3e4r5t6z7u",
            "abcabcdabcde1",
            "xk4!zxk4!zxk4!z",
            "a1b2c3a1b2c3",
            "password1234",
            "PassWord 2024",
            "passwordpassword",
            "P@ssw0rd!1234",
            "passwort12345",
            "Spineline2026",
            "leadleadlead1",
            "Anna.Meier.12",
            "anna meier 1234",
            "1234 reiem anna",
            "aaaabbbbccccddddeeee",
            "a b c d e f g h",
        ] {
            let found = fault(password, "anna.meier");
            let found = if password.starts_with("lead") { fault(password, "lead") } else { found };
            assert!(matches!(found, Some(PasswordFault::Foreseen { .. })), "{password}: {found:?}");
        }
    }

    #[test]
    fn sentences_and_random_characters_are_accepted() {
        for password in [
            "a long pass phrase",
            "another pass phrase",
            "a long enough sentence",
            "correct horse battery staple",
            "lead singers drink tea",
            "k7#Qv9!mZ2xT",
            "839201746552",
            "Wirbelsäule im Stehen",
            "脊柱側彎症患者的放射影像檢查",
        ] {
            assert_eq!(fault(password, "lead"), None, "{password}");
        }
    }
}
