//! Small rules of inputs: names, lists, labels, repeats, and what a person states about a film.

use spineline::anatomy::ImageSide;
use spineline::measure::{Spacing, SpacingPlane};
use spineline_store::{
    Account, FilmEdit, FilmId, Name, PasswordHash, PlanDesign, Role, StoreError, Study, StudyEdit,
    StudyGrant,
};

use crate::plan::random;
use crate::session::{by, folder_with_new_store, folder_with_store, name};

#[test]
fn dots_alone_are_no_name_because_no_browser_opens_their_address() {
    for text in [".", "..", "...."] {
        let refused = Name::new(text);
        assert!(matches!(refused, Err(StoreError::BadName { .. })), "{refused:?}");
        let message = refused.expect_err("a refusal").to_string();
        assert!(message.contains("not dots alone"), "{message}");
    }
    for text in [".a", "S.1", "..-", "_"] {
        assert_eq!(Name::new(text).expect("a name").as_str(), text);
    }
}

#[test]
fn another_side_of_the_patient_ends_the_comparison_with_the_records_and_another_scale_does_not() {
    // A study with two films without readings.
    let (_folder, mut store) = folder_with_store(3);
    let film = FilmId(2);
    let mut checked_after = |revision: u64, edit: FilmEdit| {
        store.edit_film(film, edit, revision, &by("lead", 10)).expect("an edit");
        store.film(film).expect("a film").stated.checked
    };
    assert!(checked_after(0, FilmEdit::Checked(true)));
    let scale = Spacing::stated(0.3, 0.3, SpacingPlane::Patient);
    assert!(checked_after(1, FilmEdit::Spacing(scale)));
    assert!(!checked_after(2, FilmEdit::PatientLeft(ImageSide::Right)));
}

#[test]
fn one_person_twice_in_grants_or_in_a_plan_is_refused_and_changes_nothing() {
    let (_folder, mut store) = folder_with_store(3);
    let (study, lead) = (name("S-1"), by("lead", 10));
    let password = PasswordHash::new("a long enough sentence", &name("ann")).expect("a password");
    let account = Account { name: name("ann"), role: Role::Editor, enabled: true };
    store.add_account(&account, &password, &lead).expect("an account");
    let ann = (name("ann"), Role::Editor);
    let twice = [ann.clone(), (name("ann"), Role::Reader)];
    let refused = store.set_grants(&study, &twice, &lead);
    assert!(
        matches!(&refused, Err(StoreError::NameTwice { name }) if name.as_str() == "ann"),
        "{refused:?}"
    );
    assert_eq!(store.grants(&study).expect("grants"), []);
    store.set_grants(&study, &[ann], &lead).expect("a grant");
    let granted = StudyGrant { study: study.clone(), name: name("ann"), role: Role::Editor };
    assert_eq!(store.grants(&study).expect("grants"), [granted]);

    let design = PlanDesign { repeats: 1, washout_days: 0, proposals: false };
    let twice = [name("A"), name("B"), name("A")];
    let refused = store.reading_plan(&study, &twice, design, &mut random(1), &lead);
    assert!(
        matches!(&refused, Err(StoreError::NameTwice { name }) if name.as_str() == "A"),
        "{refused:?}"
    );
    assert!(!store.has_plan(&study).expect("readable"));
}

#[test]
fn a_repeat_that_leaves_a_number_out_is_refused_so_that_a_next_one_remains() {
    let (_folder, mut store) = folder_with_store(3);
    let (film, ann) = (FilmId(2), by("ann", 10));
    for repeat in [0, 2, u32::MAX] {
        let refused = store.begin_reading(film, repeat, &ann);
        let is_next = matches!(
            refused,
            Err(StoreError::BadRepeat { next: 1, repeat: found, .. }) if found == repeat
        );
        assert!(is_next, "{refused:?}");
    }
    let first = store.begin_reading(film, 1, &ann).expect("the first one");
    // A withdrawn reading keeps its number.
    store.withdraw_reading(first, "wrong film", &ann).expect("withdrawn");
    let refused = store.begin_reading(film, 3, &ann);
    assert!(matches!(refused, Err(StoreError::BadRepeat { next: 2, .. })), "{refused:?}");
    let again = store.begin_reading(film, 1, &ann);
    assert!(matches!(again, Err(StoreError::Exists { .. })), "{again:?}");
    store.begin_reading(film, 2, &ann).expect("the second one");
    // Another observer begins with the first one.
    store.begin_reading(film, 1, &by("ben", 11)).expect("the first one");
}

#[test]
fn a_label_that_hides_or_turns_text_is_refused_and_a_blank_one_is_none() {
    let (_folder, mut store) = folder_with_new_store();
    let lead = by("lead", 1);
    let labelled = |label: &str| Study::new(name("S-1"), Some(label.to_owned()), true);
    // A tab, a line, an escape, the end of a line, and marks of the direction of text.
    let bad = ["a\tb", "a\nb", "a\u{1b}[2Jb", "a\u{85}b", "a\u{2028}b", "a\u{202e}b", "\u{2067}a"];
    for label in bad {
        let refused = store.add_study(&labelled(label), &lead);
        assert!(matches!(refused, Err(StoreError::BadLabel)), "{label:?}: {refused:?}");
    }
    store.add_study(&labelled(" \u{a0}"), &lead).expect("a study");
    let label = |store: &spineline_store::Store| {
        store.study(&name("S-1")).expect("a study").label.unwrap_or_default()
    };
    assert_eq!(label(&store), "");
    let edit = |label: &str| StudyEdit::Label { label: Some(label.to_owned()) };
    let turned = store.edit_study(&name("S-1"), &edit("a\u{202e}b"), 0, &lead);
    assert!(matches!(turned, Err(StoreError::BadLabel)), "{turned:?}");
    // Other scripts are text.
    for (revision, text) in
        (0..).zip(["Größe vor Korsett", "\u{5d3}\u{5e0}\u{5d4}", "\u{810a}\u{67f1}", "  "])
    {
        store.edit_study(&name("S-1"), &edit(text), revision, &lead).expect("renamed");
        assert_eq!(label(&store), text.trim());
    }
    assert_eq!(store.study(&name("S-1")).expect("a study").label, None);
}
