//! Log entries of steps that change nothing: signing in, exporting, querying an archive.

use crate::audit::WHOLE_STORE;
use crate::connection::Store;
use crate::error::StoreError;
use crate::names::{Name, Signature};

impl Store {
    /// Logs a step that does not change its object. On a full disk, the entry is written before the next change that finds room.
    pub(crate) fn log_step(
        &mut self,
        action: &str,
        object: &str,
        by: &Signature,
    ) -> Result<(), StoreError> {
        let logged = self.write(by, |ledger| ledger.mention(action, object));
        match logged {
            Err(error) if error.is_no_room() && self.unsaved.log(action, object, &by.who) => Ok(()),
            logged => logged,
        }
    }

    /// Writes into the log that somebody signed in; the object is `session/NAME`.
    ///
    /// # Errors
    /// Errors of writing, except of a full disk.
    pub fn log_sign_in(&mut self, by: &Signature) -> Result<(), StoreError> {
        self.log_step("sign_in", &format!("session/{}", by.who), by)
    }

    /// Logs a refused attempt to sign in. The object is `session/NAME` for an existing account, and the store for other names:
    /// the text typed as a name may be a password. `unlogged` earlier attempts have no entries.
    ///
    /// # Errors
    /// Errors of writing, except of a full disk.
    pub fn log_refused_sign_in(
        &mut self,
        account: Option<&Name>,
        unlogged: u64,
        by: &Signature,
    ) -> Result<(), StoreError> {
        if unlogged > 0 {
            self.log_step(&format!("{unlogged}_sign_ins_refused"), WHOLE_STORE, by)?;
        }
        let object =
            account.map_or_else(|| WHOLE_STORE.to_owned(), |name| format!("session/{name}"));
        self.log_step("sign_in_refused", &object, by)
    }

    /// Writes the entries that found no room before, if there is room now.
    ///
    /// # Errors
    /// Errors of writing.
    pub fn save_unsaved(&mut self, by: &Signature) -> Result<(), StoreError> {
        if self.unsaved.is_empty() {
            return Ok(());
        }
        self.write(by, |_| Ok(()))
    }
}
