//! Small rules of inputs: names, lists, labels, repeats, and what a person states about a film.

use spineline::anatomy::ImageSide;
use spineline::measure::{Spacing, SpacingPlane};
use spineline_store::{
    Account, FilmEdit, FilmId, Name, PasswordHash, PlanDesign, Role, StoreError, StudyGrant,
};

use crate::plan::random;
use crate::session::{by, folder_with_store, name};

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
