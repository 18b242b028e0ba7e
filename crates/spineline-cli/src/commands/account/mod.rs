//! `spineline account`: user accounts of the browser app and their studies.

mod args;

pub use args::{AccountArgs, EXAMPLES};

use std::fmt::Display;
use std::io::{IsTerminal, Read, stdin};
use std::path::Path;

use spineline_report::document::{Column, Table};
use spineline_report::terminal::{self, Lines};
use spineline_store::{Account, AccountChange, Name, PasswordHash, Signature, Store, StoreError};

use args::AccountCommand;

use crate::options::values::author;
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{print, width};

/// More than the longest password.
const MAX_INPUT_BYTES: u64 = 4096;

pub fn run(args: &AccountArgs) -> Result<Ending, Failure> {
    let path = args.command.store();
    let fail = |error: StoreError| Failure::file(path, &error);
    let is_list = matches!(args.command, AccountCommand::List { .. });
    let author = author(args.by.as_ref(), !is_list)?;
    if is_list {
        return print(Lines::of_text(&list(&Store::view(path).map_err(fail)?).map_err(fail)?));
    }
    let mut store = Store::open(path).map_err(fail)?;
    let by = Signature::now(author);
    match &args.command {
        AccountCommand::Add { name: account, role, password_stdin, .. } => {
            let account = Account { name: account.clone(), role: *role, enabled: true };
            let password = password(path, &account.name, *password_stdin)?;
            store.add_account(&account, &password, &by).map_err(fail)?;
            print(format!("Account {} was added as {}.", account.name, role.key()))
        }
        AccountCommand::Edit { name: account, .. } => {
            // An unknown account must fail before the password is entered.
            store.account(account).map_err(fail)?;
            let change = change(&args.command, account)?;
            let account = store.edit_account(account, &change, &by).map_err(fail)?;
            let state = if account.enabled { "may sign in" } else { "may not sign in" };
            print(format!("Account {} is {} and {state}.", account.name, account.role.key()))
        }
        AccountCommand::Grant { name: account, study, role, .. } => {
            store.grant(study, account, *role, &by).map_err(fail)?;
            print(format!("Account {account} is {} of study {study}.", role.key()))
        }
        AccountCommand::Revoke { name: account, study, .. } => {
            store.revoke(study, account, &by).map_err(fail)?;
            print(format!("Account {account} does not see study {study}."))
        }
        AccountCommand::List { .. } => Ok(Ending::Done),
    }
}

fn change(command: &AccountCommand, account: &Name) -> Result<AccountChange, Failure> {
    let AccountCommand::Edit {
        store, role, password: ask, password_stdin, enable, disable, ..
    } = command
    else {
        return Ok(AccountChange::default());
    };
    let enabled = (*enable || *disable).then_some(*enable);
    let password = (*ask || *password_stdin).then(|| password(store, account, *password_stdin));
    let change = AccountChange { role: *role, password: password.transpose()?, enabled };
    if change.role.is_none() && change.password.is_none() && change.enabled.is_none() {
        let options = "--role, --password, --password-stdin, --enable or --disable";
        return Err(Failure::usage(format!("nothing to change; give {options}")));
    }
    Ok(change)
}

fn password(store: &Path, account: &Name, from_stdin: bool) -> Result<PasswordHash, Failure> {
    let text = if from_stdin { one_line()? } else { asked()? };
    PasswordHash::new(&text, account).map_err(|error| Failure::file(store, &error))
}

fn one_line() -> Result<String, Failure> {
    let mut text = String::new();
    let read = stdin().lock().take(MAX_INPUT_BYTES).read_to_string(&mut text);
    let refused = |error: &dyn Display| {
        let help = "write the password as one line of UTF-8 text";
        Failure::input("standard input", error, help)
    };
    read.map_err(|error| refused(&error))?;
    let mut lines = text.lines();
    let first = lines.next().unwrap_or_default().to_owned();
    if lines.any(|line| !line.is_empty()) {
        return Err(refused(&"more than one line, and a password is one line"));
    }
    Ok(first)
}

fn asked() -> Result<String, Failure> {
    if !stdin().is_terminal() {
        return Err(Failure::usage("no terminal to enter the password; use --password-stdin"));
    }
    let asked = dialoguer::Password::new()
        .with_prompt("Password (at least 12 characters)")
        .with_confirmation("Repeat password", "The passwords differ.")
        .interact();
    let dialoguer::Error::IO(error) = match asked {
        Ok(text) => return Ok(text),
        Err(error) => error,
    };
    Err(Failure::input("terminal", error, "give the password with --password-stdin"))
}

fn list(store: &Store) -> Result<String, StoreError> {
    let heads = ["Account", "Role", "May sign in", "Studies"];
    let mut table = Table::new("", heads.map(Column::words).to_vec());
    for account in store.accounts()? {
        let grants = store.grants_of(&account.name)?;
        let studies: Vec<String> =
            grants.iter().map(|grant| format!("{} ({})", grant.study, grant.role.key())).collect();
        table.row(vec![
            account.name.to_string(),
            account.role.key().to_owned(),
            if account.enabled { "yes" } else { "no" }.to_owned(),
            if studies.is_empty() { "-".to_owned() } else { studies.join(", ") },
        ]);
    }
    Ok(terminal::table(&table, width()))
}
