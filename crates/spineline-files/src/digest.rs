//! Names for bytes.

use sha2::{Digest, Sha256};

/// SHA-256 of bytes, in 64 lower-case hexadecimal digits.
///
/// ```
/// assert!(spineline_files::sha256_hex(b"").starts_with("e3b0c44298fc1c14"));
/// ```
#[must_use]
pub fn sha256_hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
