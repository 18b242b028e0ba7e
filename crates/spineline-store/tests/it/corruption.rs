//! Changed bytes on the disk give an error or a finding, never other readings or a panic.

use std::fs;
use std::path::Path;

use spineline_store::{Account, Finding, Name, PasswordHash, Role, Store, StoreError};

use crate::session::{STEPS, by, create_after, folder, folder_with_store, name, try_fingerprint};

#[test]
fn a_changed_byte_in_any_page_is_reported_or_harmless() {
    let folder = folder();
    let path = folder.path().join("store");
    let store = full_store(&path);
    let sound = try_fingerprint(&store).expect("readable");
    drop(store);
    let bytes = fs::read(&path).expect("a file");
    let page = 4096;
    let damaged = folder.path().join("damaged");
    let (mut refused, mut found, mut harmless, mut unverified) = (0, 0, 0, 0);
    for start in (0..bytes.len()).step_by(page) {
        // The page's head, its end where rows grow from, and places between.
        let inside = [
            0, 1, 3, 5, 8, 9, 41, 59, 63, 100, 513, 1033, 1999, 2600, 3111, 3500, 3901, 4000, 4080,
            4095,
        ];
        for (turn, offset) in inside.into_iter().enumerate() {
            let place = start + offset;
            let mut changed = bytes.clone();
            changed[place] ^= 1 << (turn % 8);
            fs::write(&damaged, &changed).expect("a file");
            let store = match Store::open(&damaged) {
                Ok(store) => store,
                Err(error) => {
                    assert!(!error.to_string().contains("Doe"), "byte {place}: {error}");
                    refused += 1;
                    continue;
                }
            };
            let print = try_fingerprint(&store);
            let findings = store.verify(None).expect("verifiable").findings;
            unverified += usize::from(print.as_ref().is_ok_and(|print| *print != sound));
            if let Ok(print) = &print {
                assert!(*print == sound || !findings.is_empty(), "byte {place} changed silently");
            }
            if findings.is_empty() {
                assert_eq!(
                    print.ok().as_ref(),
                    Some(&sound),
                    "byte {place}: unreadable, and verified"
                );
                harmless += 1;
            } else {
                found += 1;
            }
        }
    }
    println!(
        "{refused} refused, {found} found, {harmless} harmless; {unverified} differ unless verified"
    );
    // Harmless changes are in unused space.
    assert!(found > 100 && refused > 0 && found + refused > harmless);
}

/// A store without nearly empty tables, so that most of its bytes are used.
fn full_store(path: &Path) -> Store {
    let mut store = create_after(path, STEPS);
    let password = PasswordHash::new("a sentence that all share", &account(0)).expect("a password");
    for number in 0..ACCOUNTS {
        let account = Account { name: account(number), role: Role::Reader, enabled: true };
        store.add_account(&account, &password, &by("lead", 100)).expect("an account");
        store.grant(&name("S-1"), &account.name, Role::Reader, &by("lead", 100)).expect("a grant");
    }
    store
}

/// Enough for several pages of accounts, of grants, and of their indexes.
const ACCOUNTS: usize = 60;

fn account(number: usize) -> Name {
    name(&format!("reader-with-a-long-name-{number}"))
}

#[test]
fn a_truncated_store_is_refused_or_reported_as_damaged() {
    let folder = folder();
    let path = folder.path().join("store");
    drop(create_after(&path, STEPS));
    let bytes = fs::read(&path).expect("a file");
    for length in (1..bytes.len()).step_by(4096 + 512) {
        fs::write(&path, &bytes[..length]).expect("a file");
        match Store::open(&path) {
            Err(error) => assert!(
                matches!(error, StoreError::NotAStore { .. } | StoreError::Damaged { .. }),
                "{length} bytes: {error:?}"
            ),
            Ok(store) => assert!(!store.verify(None).expect("verifiable").is_clean(), "{length}"),
        }
    }
}

#[test]
fn a_film_with_changed_bytes_is_not_returned() {
    let (folder, store) = folder_with_store(3);
    let path = folder.path().join("store");
    let content = store.films(&crate::session::name("S-1")).expect("films")[0].content.clone();
    drop(store);
    rusqlite::Connection::open(&path)
        .and_then(|raw| {
            raw.execute("UPDATE contents SET bytes = x'00' WHERE hash = ?1", [content.as_str()])
        })
        .expect("an edit");
    let store = Store::open(&path).expect("a store");
    refused!(store.content(&content), Damaged { .. });
    let findings = store.verify(None).expect("verifiable").findings;
    assert!(findings.contains(&Finding::ContentChanged { content }), "{findings:?}");
}
