//! Comparison and change of passwords, and proofs of browsers that signed in before.

use std::sync::OnceLock;

use rusqlite::params;

use crate::accounts::{self, Account};
use crate::audit;
use crate::connection::Store;
use crate::error::StoreError;
use crate::guessing::MAX_BYTES;
use crate::names::{Hash, Name, Signature, Timestamp};
use crate::password_hash::PasswordHash;
use crate::sessions;

/// How long a browser that signed in is known, in milliseconds: 30 days.
const DEVICE_MS: i64 = 30 * 24 * 60 * 60 * 1000;

/// Hash with which a password is compared. The comparison takes time and memory by design, so compare after the store is
/// released.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Credential {
    account: Option<Account>,
    password: PasswordHash,
}

impl Credential {
    /// The account, if the password is right and the account enabled. An unknown name takes as long.
    #[must_use]
    pub fn check(&self, password: &str) -> Option<&Account> {
        let right = password.len() <= MAX_BYTES && self.password.is_of(password);
        self.account.as_ref().filter(|account| right && account.enabled)
    }

    /// Proof that a browser signed in to this account at this time. It does not sign in; a new password ends it.
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
        // Compares hashes: the time of the comparison reveals nothing about the proof.
        self.account.is_some()
            && Hash::of(self.proof(name, at_ms).as_bytes()) == Hash::of(device.as_bytes())
    }
}

impl Store {
    /// Hash with which a password for this name is compared, whether or not the account exists.
    pub fn credential(&self, name: &Name) -> Result<Credential, StoreError> {
        static UNKNOWN: OnceLock<PasswordHash> = OnceLock::new();
        let condition = "WHERE name = ?1";
        let found = audit::load(&self.connection, "accounts", condition, [name.as_str()], |row| {
            let (account, password) = (accounts::read(row)?, PasswordHash(row.get("password")?));
            Ok(Credential { account: Some(account), password })
        })?;
        Ok(found.into_iter().next().unwrap_or_else(|| Credential {
            account: None,
            password: UNKNOWN.get_or_init(|| PasswordHash::of_any("unknown")).clone(),
        }))
    }

    /// The account to which a browser signed in during the last 30 days, by the proof that it got then
    /// ([`Credential::device`]).
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
