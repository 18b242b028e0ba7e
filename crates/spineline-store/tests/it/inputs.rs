//! Names, lists and labels that the store refuses.

use spineline_store::{Name, StoreError};

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
