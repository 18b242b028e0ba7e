//! Deterministic unique identifiers of DICOM.

use sha2::{Digest, Sha256};

/// A UID from a name of this program.
pub(super) fn from_name(name: &str) -> String {
    from_bytes(format!("spineline\n{name}").as_bytes())
}

/// A UID below `2.25.`, from a UUID of version 8 that is made of the hash of bytes (DICOM PS3.5 B.2, RFC 9562).
#[must_use]
pub fn from_bytes(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    let mut first = [0; 16];
    first.copy_from_slice(&digest[..16]);
    let hash = u128::from_be_bytes(first);
    // Four bits say the version and two the variant.
    let version = (hash & !(0xF << 76)) | (0x8 << 76);
    let uuid = (version & !(0x3 << 62)) | (0x2 << 62);
    format!("2.25.{uuid}")
}

#[cfg(test)]
mod tests {
    use super::from_name;

    #[test]
    fn equal_names_have_equal_uids_and_different_names_different_ones() {
        assert_eq!(from_name("study a"), from_name("study a"));
        assert_ne!(from_name("study a"), from_name("study b"));
    }

    #[test]
    fn a_uid_is_short_enough_and_a_uuid_of_version_8() {
        for name in ["", "a", "phantom-rod-01 erect"] {
            let uid = from_name(name);
            assert!(uid.len() <= 64);
            let digits = uid.strip_prefix("2.25.").expect("the root");
            let number: u128 = digits.parse().expect("decimal digits");
            assert_eq!(number >> 76 & 0xF, 8);
            assert_eq!(number >> 62 & 0x3, 2);
        }
    }
}
