//! Accounts, and permissions per study.

use rusqlite::{Connection, Row, params};
use serde::Serialize;
use utoipa::ToSchema;

use crate::audit::{self, Ledger, next_id};
use crate::connection::Store;
use crate::error::StoreError;
use crate::films;
use crate::names::{self, Name, Signature};
use crate::password_hash::PasswordHash;
use crate::sessions;
use crate::wire::Wire;

spineline::named! {
    /// Permissions in increasing order; each includes those before it.
    pub enum Role {
        /// May view.
        Reader = "reader",
        /// May place landmarks and create studies.
        Editor = "editor",
        /// May manage accounts, grants, plans and every study.
        Admin = "admin",
    }
}

/// Highest permission of an account; a study may grant less.
pub type RoleName = Wire<Role>;

/// A local account.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = AccountView)]
pub struct Account {
    /// Its name, which is also the observer's.
    #[schema(value_type = String)]
    pub name: Name,
    /// Highest permission.
    #[schema(value_type = RoleName)]
    pub role: Role,
    /// Whether it may sign in.
    pub enabled: bool,
}

/// A change of an account; absent values do not change.
#[derive(Debug, Clone, Default)]
pub struct AccountChange {
    /// Role.
    pub role: Option<Role>,
    /// Password.
    pub password: Option<PasswordHash>,
    /// Whether it may sign in.
    pub enabled: Option<bool>,
}

/// Permission of an account in a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StudyGrant {
    /// Study.
    pub study: Name,
    /// Account or observer.
    pub name: Name,
    /// Reader or editor.
    pub role: Role,
}

impl Store {
    /// Adds an account.
    ///
    /// # Errors
    /// [`StoreError::Exists`].
    pub fn add_account(
        &mut self,
        account: &Account,
        password: &PasswordHash,
        by: &Signature,
    ) -> Result<(), StoreError> {
        self.write(by, |ledger| {
            let name = account.name.as_str();
            if !accounts(ledger.transaction, Some(&account.name))?.is_empty() {
                return Err(StoreError::Exists { object: format!("account/{name}") });
            }
            ledger.transaction.execute(
                "INSERT INTO accounts VALUES (?1, ?2, ?3, ?4)",
                params![name, account.role.key(), password.0, account.enabled],
            )?;
            ledger.seal("add", "accounts", &name).map(drop)
        })
    }

    /// Changes an account. A new password or a disabled account ends its sessions.
    ///
    /// # Errors
    /// [`StoreError::Unknown`]; [`StoreError::LastAdmin`] where no enabled admin would remain.
    pub fn edit_account(
        &mut self,
        name: &Name,
        change: &AccountChange,
        by: &Signature,
    ) -> Result<Account, StoreError> {
        self.write(by, |ledger| {
            let before = account(ledger.transaction, name)?;
            let after = Account {
                name: name.clone(),
                role: change.role.unwrap_or(before.role),
                enabled: change.enabled.unwrap_or(before.enabled),
            };
            ledger.transaction.execute(
                "UPDATE accounts SET role = ?2, enabled = ?3, password = coalesce(?4, password) WHERE name = ?1",
                params![
                    name.as_str(),
                    after.role.key(),
                    after.enabled,
                    change.password.as_ref().map(|password| &password.0)
                ],
            )?;
            ledger.seal("edit", "accounts", &name.as_str())?;
            if leads(&before) && !accounts(ledger.transaction, None)?.iter().any(leads) {
                return Err(StoreError::LastAdmin { name: name.clone() });
            }
            if change.password.is_some() || !after.enabled {
                sessions::end_all(ledger.transaction, name)?;
            }
            Ok(after)
        })
    }

    /// All accounts, by name.
    pub fn accounts(&self) -> Result<Vec<Account>, StoreError> {
        accounts(&self.connection, None)
    }

    /// An account.
    ///
    /// # Errors
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn account(&self, name: &Name) -> Result<Account, StoreError> {
        account(&self.connection, name)
    }

    /// Replaces the grants of a study. Admins need no grant.
    ///
    /// # Errors
    /// [`StoreError::Unknown`] for the study or an account; [`StoreError::NameTwice`] for two grants of one account.
    pub fn set_grants(
        &mut self,
        study: &Name,
        wanted: &[(Name, Role)],
        by: &Signature,
    ) -> Result<(), StoreError> {
        if let Some(name) = names::repeated(wanted.iter().map(|(name, _)| name)) {
            return Err(StoreError::NameTwice { name: name.clone() });
        }
        self.write(by, |ledger| {
            let transaction = ledger.transaction;
            films::study(transaction, study)?;
            for grant in grants(transaction, "study", study)? {
                if !wanted.iter().any(|(name, _)| *name == grant.name) {
                    set_grant(ledger, study, &grant.name, None)?;
                }
            }
            for (name, role) in wanted {
                granted_before_or_account(transaction, study, name)?;
                set_grant(ledger, study, name, Some(*role))?;
            }
            Ok(())
        })
    }

    /// Adds or changes a grant.
    ///
    /// # Errors
    /// [`StoreError::Unknown`] for the study or the account.
    pub fn grant(
        &mut self,
        study: &Name,
        name: &Name,
        role: Role,
        by: &Signature,
    ) -> Result<(), StoreError> {
        self.write(by, |ledger| {
            films::study(ledger.transaction, study)?;
            granted_before_or_account(ledger.transaction, study, name)?;
            set_grant(ledger, study, name, Some(role))
        })
    }

    /// Removes a grant.
    ///
    /// # Errors
    /// [`StoreError::Unknown`] for a missing grant.
    pub fn revoke(&mut self, study: &Name, name: &Name, by: &Signature) -> Result<(), StoreError> {
        self.write(by, |ledger| {
            if !grants(ledger.transaction, "study", study)?.iter().any(|grant| grant.name == *name)
            {
                let object = format!("grant of account/{name} to study/{study}");
                return Err(StoreError::Unknown { object });
            }
            set_grant(ledger, study, name, None)
        })
    }

    /// The grants of a study, by name.
    pub fn grants(&self, study: &Name) -> Result<Vec<StudyGrant>, StoreError> {
        grants(&self.connection, "study", study)
    }

    /// The grant of an account in a study.
    ///
    /// # Errors
    /// [`StoreError::Unknown`] for the study, [`StoreError::Damaged`].
    pub fn granted(&self, study: &Name, name: &Name) -> Result<Option<Role>, StoreError> {
        films::study(&self.connection, study)?;
        let grants = grants(&self.connection, "study", study)?;
        Ok(grants.into_iter().find(|grant| grant.name == *name).map(|grant| grant.role))
    }

    /// The grants of an account, by study.
    pub fn grants_of(&self, name: &Name) -> Result<Vec<StudyGrant>, StoreError> {
        grants(&self.connection, "name", name)
    }
}

fn leads(account: &Account) -> bool {
    account.enabled && account.role == Role::Admin
}

pub(crate) fn read(row: &Row<'_>) -> Result<Account, StoreError> {
    let role: String = row.get("role")?;
    Ok(Account {
        name: Name::new(&row.get::<_, String>("name")?)?,
        role: role.parse().map_err(|_| StoreError::damaged("account"))?,
        enabled: row.get("enabled")?,
    })
}

fn accounts(connection: &Connection, name: Option<&Name>) -> Result<Vec<Account>, StoreError> {
    let condition = "WHERE ?1 IS NULL OR name = ?1 ORDER BY name";
    audit::load(connection, "accounts", condition, [name.map(Name::as_str)], read)
}

pub(crate) fn account(connection: &Connection, name: &Name) -> Result<Account, StoreError> {
    let unknown = || StoreError::Unknown { object: format!("account/{name}") };
    accounts(connection, Some(name))?.pop().ok_or_else(unknown)
}

/// A grant needs an account; names of the terminal's token keep their permissions.
fn granted_before_or_account(
    connection: &Connection,
    study: &Name,
    name: &Name,
) -> Result<(), StoreError> {
    if grants(connection, "study", study)?.iter().any(|grant| grant.name == *name) {
        return Ok(());
    }
    account(connection, name).map(drop)
}

fn grants(
    connection: &Connection,
    column: &str,
    value: &Name,
) -> Result<Vec<StudyGrant>, StoreError> {
    let condition = format!("WHERE {column} = ?1 AND role IS NOT NULL ORDER BY study, name");
    audit::load(connection, "grants", &condition, [value.as_str()], |row| {
        let role: String = row.get("role")?;
        Ok(StudyGrant {
            study: Name::new(&row.get::<_, String>("study")?)?,
            name: Name::new(&row.get::<_, String>("name")?)?,
            role: role.parse().map_err(|_| StoreError::damaged("grant"))?,
        })
    })
}

/// Writes or removes a grant; no effect if it is unchanged.
pub(crate) fn set_grant(
    ledger: &Ledger<'_>,
    study: &Name,
    name: &Name,
    role: Option<Role>,
) -> Result<(), StoreError> {
    let transaction = ledger.transaction;
    let role = role.map(|role| role.min(Role::Editor).key());
    let rows = audit::load(
        transaction,
        "grants",
        "WHERE study = ?1 AND name = ?2",
        [study.as_str(), name.as_str()],
        |row| Ok((row.get::<_, i64>("id")?, row.get::<_, Option<String>>("role")?)),
    )?;
    let (id, action) = match rows.first() {
        Some((_, now)) if now.as_deref() == role => return Ok(()),
        Some(&(id, _)) => {
            transaction.execute("UPDATE grants SET role = ?2 WHERE id = ?1", params![id, role])?;
            (id, if role.is_some() { "edit" } else { "revoke" })
        }
        None => {
            let id = next_id(transaction, "grants", "id")?;
            transaction.execute(
                "INSERT INTO grants VALUES (?1, ?2, ?3, ?4)",
                params![id, study.as_str(), name.as_str(), role],
            )?;
            (id, "add")
        }
    };
    ledger.seal(action, "grants", &id).map(drop)
}
