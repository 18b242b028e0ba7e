//! The choice of end vertebrae.

use std::str::FromStr;

use spineline::anatomy::{Level, Region};
use spineline::clinical::{CobbEnds, EndChoice, EndRule};

/// Reads `erect`, `each-film`, or end vertebrae of regions such as `main-thoracic=T12/T5`.
pub fn end_vertebrae(text: &str) -> Result<EndChoice, String> {
    match text {
        "erect" => return Ok(EndChoice::default()),
        "each-film" => return Ok(EndChoice { rule: EndRule::EachFilm, ..EndChoice::default() }),
        _ => {}
    }
    let mut choice = EndChoice::default();
    for part in text.split(',') {
        let (region, ends) = part.split_once('=').ok_or_else(|| {
            "expected `erect`, `each-film`, or REGION=LEVEL/LEVEL, such as main-thoracic=T12/T5"
                .to_owned()
        })?;
        let region = region_of(region.trim())?;
        let given = &mut choice.given[region.index()];
        if given.is_some() {
            return Err(format!("the {region} curve has its end vertebrae twice"));
        }
        *given = Some(ends_of(ends)?);
    }
    Ok(choice)
}

fn region_of(text: &str) -> Result<Region, String> {
    text.replace('-', "_").parse().map_err(|_| {
        let known = Region::ALL.map(|region| region.key().replace('_', "-")).join(", ");
        format!("no region is called `{text}`: expected one of {known}")
    })
}

fn ends_of(text: &str) -> Result<CobbEnds, String> {
    let level = |name: &str| {
        let level = Level::from_str(name.trim()).map_err(|error| error.to_string())?;
        let of_model = level.model_index().map(|_| level);
        of_model.ok_or_else(|| format!("{level} is not between L4 and T2"))
    };
    let (a, b) = text
        .split_once('/')
        .ok_or_else(|| "expected two end vertebrae, such as T12/T5".to_owned())?;
    let (a, b) = (level(a)?, level(b)?);
    if a == b {
        return Err(format!("a curve needs two end vertebrae, and {a} is given twice"));
    }
    Ok(CobbEnds { inferior: a.min(b), superior: a.max(b) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn end_vertebrae_are_read_in_either_order_and_wrong_ones_are_explained() {
        let choice = end_vertebrae("main-thoracic=T5/T12, proximal_thoracic=T5/T2").expect("valid");
        let main = CobbEnds { inferior: Level::T12, superior: Level::T5 };
        assert_eq!(choice.given[Region::MainThoracic.index()], Some(main));
        assert!(choice.given[Region::ProximalThoracic.index()].is_some());
        assert_eq!(choice.given[Region::ThoracolumbarLumbar.index()], None);
        assert_eq!(end_vertebrae("each-film").map(|choice| choice.rule), Ok(EndRule::EachFilm));
        for (text, word) in [
            ("thoracic=T5/T12", "main-thoracic"),
            ("main-thoracic=T5", "two end vertebrae"),
            ("main-thoracic=T5/T5", "twice"),
            ("main-thoracic=T5/S1", "S1"),
            ("main-thoracic=T5/L5", "between L4 and T2"),
            ("every", "each-film"),
        ] {
            assert!(end_vertebrae(text).is_err_and(|error| error.contains(word)), "{text}");
        }
    }
}
