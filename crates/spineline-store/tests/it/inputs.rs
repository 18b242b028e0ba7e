//! Small rules of inputs: names, lists, labels, repeats, and what a person states about a film.

use spineline::anatomy::ImageSide;
use spineline::measure::{Spacing, SpacingPlane};
use spineline_store::{FilmEdit, FilmId, Name, StoreError};

use crate::session::{by, folder_with_store};

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
