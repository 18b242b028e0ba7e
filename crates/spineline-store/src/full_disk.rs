//! Disks that are full at any page of a session. SQLite's limit of pages belongs to a connection, so the test is inside the
//! crate.

use crate::{Store, StoreError, schema, session};

fn limit_pages(store: &Store, pages: i64) {
    let pragma = "max_page_count";
    store.connection.pragma_update_and_check(None, pragma, pages, |_| Ok(())).expect("a pragma");
}

#[test]
fn a_full_disk_loses_no_acknowledged_change_and_work_continues_with_room() {
    let folder = tempfile::tempdir().expect("a folder");
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
    assert!(refusals > 5, "only {refusals} limits were felt");
}
