use std::fmt;

use dicom_core::Tag;
use dicom_core::dictionary::{DataDictionary, DataDictionaryEntry};
use dicom_dictionary_std::StandardDataDictionary;
use serde::{Deserialize, Serialize};

/// A DICOM attribute by its tag; prints its name in the standard beside it. Never holds a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Attribute(
    /// Group.
    pub u16,
    /// Element.
    pub u16,
);

impl Attribute {
    /// Whether the group is odd: the meaning is the vendor's.
    const fn is_private(self) -> bool {
        self.0 % 2 == 1
    }
}

impl From<Tag> for Attribute {
    fn from(tag: Tag) -> Self {
        Self(tag.group(), tag.element())
    }
}

impl From<Attribute> for Tag {
    fn from(Attribute(group, element): Attribute) -> Self {
        Self(group, element)
    }
}

impl fmt::Display for Attribute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(group, element) = *self;
        match StandardDataDictionary.by_tag((*self).into()) {
            Some(entry) if !self.is_private() => {
                write!(f, "{} ({group:04X},{element:04X})", entry.alias())
            }
            _ => write!(f, "({group:04X},{element:04X})"),
        }
    }
}
