//! Postures and numbers as text.

use spineline::anatomy::Posture;

/// A posture by its key, with `-` or `_`.
///
/// # Errors
/// If there is no such posture.
pub fn posture(text: &str) -> Result<Posture, String> {
    let wanted = text.replace('-', "_");
    wanted.parse().map_err(|_| {
        format!(
            "unknown posture `{text}`; expected one of {}",
            Posture::ALL.map(Posture::key).join(", ")
        )
    })
}

/// A finite number.
///
/// # Errors
/// If the text is none.
pub fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a number")),
    }
}
