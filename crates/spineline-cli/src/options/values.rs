//! Values that options take, parsed from text.

use spineline::anatomy::Posture;

pub fn posture(text: &str) -> Result<Posture, String> {
    let wanted = text.replace('-', "_");
    Posture::ALL.into_iter().find(|posture| posture.key() == wanted).ok_or_else(|| {
        format!(
            "unknown posture `{text}`; expected one of {}",
            Posture::ALL.map(Posture::key).join(", ")
        )
    })
}

pub fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a number")),
    }
}

pub fn threads(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(number @ 0..=1024) => Ok(number),
        _ => Err("expected 0 (all cores) to 1024".to_owned()),
    }
}
