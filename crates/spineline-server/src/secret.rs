//! Random secrets.

use spineline_store::system_random;

/// 192 random bits for an address or a cookie.
pub fn secret() -> String {
    let mut bytes = [0_u8; 24];
    system_random(&mut bytes);
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
