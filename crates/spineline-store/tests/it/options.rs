//! Model options of a study, and kept computations.

use spineline_files::method_text::{ChosenOption, ChosenOptions};
use spineline_store::{CaseReadings, ExportRemark, Finding, KeptComputation, Store, StudyOptions};

use crate::session::{STEPS, by, folder_with_new_store, folder_with_store, name, run};

pub fn option(name: &str, value: &str) -> ChosenOption {
    ChosenOption::word(name, value)
}

fn chosen(options: &[ChosenOption]) -> ChosenOptions {
    ChosenOptions::new(options).expect("valid")
}

#[test]
fn options_are_kept_logged_and_reset_and_a_stale_change_is_kept_beside_them() {
    let (folder, mut store) = folder_with_store(3);
    let path = folder.path().join("store");
    let (study, lead) = (name("S-1"), by("lead", 100));
    assert_eq!(store.study_options(&study).expect("a study"), StudyOptions::default());
    let free = chosen(&[option("support", "free")]);
    let first = store.set_study_options(&study, &free, 0, &lead).expect("a change");
    assert_eq!(first.revision, 1);
    for changed in [store.last_change(&study), store.last_result_change(&study)] {
        assert_eq!(changed.expect("a change").sequence as u64, first.sequence);
    }
    let refused = store.set_study_options(&study, &ChosenOptions::default(), 0, &lead);
    refused!(refused, Conflict { expected: 0, found: 1, .. });
    drop(store);

    let mut store = Store::open(&path).expect("a store");
    let kept = StudyOptions { chosen: free.clone(), revision: 1 };
    assert_eq!(store.study_options(&study).expect("options"), kept);
    let current = store.current_case(&study, CaseReadings::Finished).expect("a case");
    assert_eq!(current.options, free);
    let sequence = store.last_result_change(&study).expect("a change").sequence;
    assert_eq!(sequence as u64, first.sequence, "a lost change changes no results");
    store.set_study_options(&study, &ChosenOptions::default(), 1, &lead).expect("a reset");
    let last = store.audit_log().expect("a log").pop().expect("an entry");
    assert_eq!((last.action.as_str(), last.object.as_str()), ("reset", "options/S-1"));
    let reset = StudyOptions { chosen: ChosenOptions::default(), revision: 2 };
    assert_eq!(store.study_options(&study).expect("options"), reset);
    assert!(store.verify(None).expect("verifiable").is_clean());
    refused!(store.set_study_options(&name("S-2"), &free, 0, &lead), Unknown { .. });
}

#[test]
fn edited_options_are_damage_and_never_other_options() {
    let (folder, mut store) = folder_with_new_store();
    let path = folder.path().join("store");
    run(&mut store, 0).expect("a study");
    let study = name("S-1");
    let free = chosen(&[option("support", "free")]);
    store.set_study_options(&study, &free, 0, &by("lead", 100)).expect("a change");
    drop(store);
    let raw = rusqlite::Connection::open(&path).expect("a database");
    raw.execute("UPDATE options SET chosen = '[]'", []).expect("an edit by hand");
    drop(raw);
    let store = Store::view(&path).expect("a store");
    refused!(store.study_options(&study), Damaged { .. });
    let changed = Finding::RowChanged { object: "options/S-1".to_owned() };
    assert!(store.verify(None).expect("verifiable").findings.contains(&changed));
}

#[test]
fn a_kept_computation_is_that_of_its_inputs_only_and_damage_is_noticed() {
    let (folder, mut store) = folder_with_new_store();
    let path = folder.path().join("store");
    run(&mut store, 0).expect("a study");
    let study = name("S-1");
    let head = store.head().expect("a head");
    assert_eq!(store.computation(&study, "replicates").expect("readable"), None);
    for asked in [5, 7] {
        let kept = KeptComputation::new("inputs", asked, "found".to_owned());
        store.keep_computation(&study, "replicates", &kept).expect("kept");
    }
    let read = |store: &Store| {
        store.computation(&study, "replicates").expect("readable").expect("a computation")
    };
    let kept = read(&store);
    assert_eq!((kept.asked, kept.found.as_str()), (7, "found"));
    assert!(kept.is_of("inputs") && !kept.is_of("other inputs"));
    assert_eq!(store.head().expect("a head"), head, "the log does not cover it");
    assert!(store.verify(None).expect("verifiable").is_clean());
    refused!(store.keep_computation(&name("S-2"), "replicates", &kept), Unknown { .. });
    drop(store);
    let raw = rusqlite::Connection::open(&path).expect("a database");
    raw.execute("UPDATE computations SET found = 'other'", []).expect("an edit by hand");
    drop(raw);
    let store = Store::open(&path).expect("a store");
    assert!(!read(&store).is_of("inputs"), "an edited row is not used");
}

#[test]
fn an_exported_study_says_its_model_options() {
    let (_folder, mut store) = folder_with_store(STEPS);
    let study = name("S-1");
    let without = store.export_case(&study).expect("a case");
    let of_options = |remark: &&ExportRemark| matches!(remark, ExportRemark::ModelOptions { .. });
    assert!(!without.remarks.iter().any(|remark| of_options(&remark)));
    let wanted = chosen(&[option("min_curve", "7.5"), option("method", "paper")]);
    store.set_study_options(&study, &wanted, 0, &by("lead", 100)).expect("a change");
    let exported = store.export_case(&study).expect("a case");
    assert_eq!(exported.text, without.text);
    let said = exported.remarks.iter().find(of_options).expect("a remark").to_string();
    assert!(said.contains("analyze it with `--method paper --min-curve 7.5`"), "{said}");
}
