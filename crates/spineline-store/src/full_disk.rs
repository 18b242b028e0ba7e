//! Disks that are full at any page of a session. SQLite's limit of pages belongs to a connection, so the test is inside the
//! crate.

use crate::{
    Access, Account, AccountChange, Name, PasswordHash, Role, Session, SessionLimits, Signature,
    Store, StoreError, Timestamp, schema, session,
};

fn limit_pages(store: &Store, pages: i64) {
    let pragma = "max_page_count";
    store.connection.pragma_update_and_check(None, pragma, pages, |_| Ok(())).expect("a pragma");
}

#[test]
fn a_full_disk_loses_no_acknowledged_change_and_work_continues_with_room() {
    let folder = session::folder();
    let reference = session::reference(&folder.path().join("reference"));
    let first = session::create(&folder.path().join("first"));
    let smallest = schema::number(&first.connection, "page_count").expect("a number");
    let mut refusals = 0;
    for pages in smallest.. {
        let path = folder.path().join(format!("limit-{pages}"));
        let mut store = session::create(&path);
        limit_pages(&store, pages);
        let outcome = (0..session::STEPS)
            .try_for_each(|step| session::run(&mut store, step).map_err(|error| (step, error)));
        let Err((step, error)) = outcome else { break };
        refusals += 1;
        assert!(matches!(error, StoreError::Full), "{pages} pages, step {step}: {error}");
        assert_eq!(session::fingerprint(&store), reference[step], "{pages} pages, step {step}");
        assert!(store.verify(None).expect("verifiable").is_clean());
        limit_pages(&store, 1 << 30);
        for rest in step..session::STEPS {
            session::run(&mut store, rest).expect("there is room now");
        }
        assert_eq!(session::fingerprint(&store), reference[session::STEPS]);
        assert!(store.verify(None).expect("verifiable").is_clean());
    }
    assert!(refusals > 5, "only {refusals} limits refused a change");
}

const LIMITS: SessionLimits = SessionLimits { idle_ms: 3_600_000, whole_ms: 36_000_000 };

fn by(who: &str, after_s: i64) -> Signature {
    let at = Timestamp::from_unix_ms(1_790_000_000_000 + 1000 * after_s).expect("a moment");
    Signature::new(Name::new(who).expect("a name"), at)
}

/// A store with the account `anna` whose disk takes no further page.
fn full_store(folder: &std::path::Path) -> Store {
    let mut store = session::create(&folder.join("store"));
    let anna = Account { name: by("anna", 0).who, role: Role::Reader, enabled: true };
    let password = PasswordHash::new("four words do not rhyme", &anna.name).expect("a password");
    store.add_account(&anna, &password, &by("lead", 0)).expect("an account");
    session::run(&mut store, 0).expect("a study");
    limit_pages(&store, schema::number(&store.connection, "page_count").expect("a number"));
    while store.write(&by("lead", 0), |ledger| ledger.note("fill")).is_ok() {}
    store
}

/// Signs in until no page has free space left.
fn sign_in(store: &mut Store, secret: &str) {
    let (by, access) = (by("anna", 0), Access::Accounts);
    for number in 0..200 {
        store.log_sign_in(&by).expect("logged later");
        let session = Session { name: by.who.clone(), access };
        let secret = format!("{secret} {number}");
        store.begin_session(&secret, &session, by.at, LIMITS).expect("a session");
    }
}

fn is_signed_in(store: &mut Store, secret: &str, number: usize) -> bool {
    let secret = format!("{secret} {number}");
    store.session(&secret, by("anna", 60).at, LIMITS).expect("readable").is_some()
}

fn actions(store: &Store) -> Vec<String> {
    store.audit_log().expect("a log").into_iter().map(|entry| entry.action).collect()
}

#[test]
fn a_full_disk_lets_people_sign_in_export_and_sign_out() {
    let folder = session::folder();
    let mut store = full_store(folder.path());
    sign_in(&mut store, "browser");
    assert!(!store.unsaved.begun.is_empty(), "the disk is full");
    assert!((0..200).all(|number| is_signed_in(&mut store, "browser", number)));
    let study = store.studies().expect("readable").remove(0).id;
    store.log_export(&study, "report", &by("anna", 1)).expect("logged later");
    for number in [0, 199] {
        store.end_session(&format!("browser {number}")).expect("ended");
        assert!(!is_signed_in(&mut store, "browser", number));
    }
    assert!(!actions(&store).contains(&"export_report_late".to_owned()));
    assert!(store.verify(None).expect("verifiable").is_clean());

    limit_pages(&store, 1 << 30);
    store.save_unsaved(&by("lead", 2)).expect("room");
    let log = actions(&store);
    for action in ["sign_in_late", "export_report_late"] {
        assert!(log.contains(&action.to_owned()), "{log:?}");
    }
    assert!(store.verify(None).expect("verifiable").is_clean());
    drop(store);
    let mut store = Store::open(&folder.path().join("store")).expect("the store");
    for number in 0..200 {
        let is_ended = [0, 199].contains(&number);
        assert_eq!(
            is_signed_in(&mut store, "browser", number),
            !is_ended,
            "{number}, after a restart"
        );
    }
}

#[test]
fn a_new_password_ends_sessions_that_are_not_on_the_disk() {
    let folder = session::folder();
    let mut store = full_store(folder.path());
    sign_in(&mut store, "thief");
    // Another program, which finds room.
    let mut other = Store::open(&folder.path().join("store")).expect("the store");
    let password =
        PasswordHash::new("five words rhyme even less", &by("anna", 0).who).expect("one");
    let change = AccountChange { password: Some(password), ..AccountChange::default() };
    other.edit_account(&by("anna", 0).who, &change, &by("lead", 3)).expect("edited");
    assert!((0..200).all(|number| !is_signed_in(&mut store, "thief", number)));
    limit_pages(&store, 1 << 30);
    store.save_unsaved(&by("lead", 4)).expect("room");
    assert!((0..200).all(|number| !is_signed_in(&mut store, "thief", number)));
}
