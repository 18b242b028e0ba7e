//! Texts of warnings and contradictions.

use spineline::analysis::Analysis;
use spineline::anatomy::Posture;
use spineline::measure::{LengthScale, SpacingPlane, judge_landmarks};
use spineline::warning::{Severity as Kind, Warning, Warnings};
use spineline_store::CurrentCase;

use crate::api::{Notice, Severity, Wire};
use crate::result_cache::{Outcome, StudyResult};
use crate::words::listed;

/// All notices beside the results of a study, worst first.
pub fn of_result(result: &StudyResult) -> Vec<Notice> {
    let mut notices = left_out(&result.current);
    match &result.outcome {
        Outcome::Waiting => {}
        Outcome::Refused { code, text, help } => {
            notices.push(Notice::new(Severity::Error, code, format!("{text}: {help}")));
        }
        Outcome::Analysed(analysis) => notices.extend(of_analysis(analysis)),
    }
    // The analysis lacks incomplete films, or does not exist.
    for film in &result.current.case.films {
        add_new(&mut notices, &judge_landmarks(film));
    }
    notices.extend(synthetic(result.current.case.synthetic));
    sorted(notices)
}

/// The same with notices of the fits without a bend, which take one more fit per line and bend.
pub fn with_comparison(result: &StudyResult) -> Vec<Notice> {
    let mut notices = of_result(result);
    if let Some(analysis) = result.analysis().filter(|analysis| !analysis.models.is_empty()) {
        add_new(&mut notices, &analysis.comparison().warnings);
    }
    sorted(notices)
}

/// Adds warnings that are not included yet.
pub fn add_new(notices: &mut Vec<Notice>, warnings: &Warnings) {
    for notice in warnings.all().iter().map(of_warning) {
        if !notices.contains(&notice) {
            notices.push(notice);
        }
    }
}

/// Sorts by severity, worst first, otherwise stable.
pub fn sorted(mut notices: Vec<Notice>) -> Vec<Notice> {
    notices.sort_by_key(|notice| std::cmp::Reverse(notice.severity));
    notices
}

/// Warnings of an analysis and of its scale.
pub fn of_analysis(analysis: &Analysis) -> Vec<Notice> {
    let mut notices: Vec<Notice> = analysis.warnings.all().iter().map(of_warning).collect();
    notices.extend(of_scale(analysis.movement.scale()));
    notices
}

pub fn of_warning(warning: &Warning) -> Notice {
    let line = warning.line.map(Wire);
    Notice {
        severity: match warning.code.severity() {
            Kind::Note => Severity::Note,
            Kind::Warning => Severity::Warning,
            Kind::Contradiction => Severity::Contradiction,
        },
        code: warning.code.key().to_owned(),
        posture: warning.posture.map(Wire),
        level: warning.level.map(|level| level.to_string()),
        line,
        text: if line.is_some() { warning.message.clone() } else { warning.text() },
    }
}

/// Warning that lengths are not the patient's. A film without spacing has a separate warning.
pub fn of_scale(scale: &LengthScale) -> Option<Notice> {
    let text = match scale.plane {
        SpacingPlane::Patient | SpacingPlane::Pixels => return None,
        SpacingPlane::Detector => {
            "lengths are in millimetres on the detector; they exceed the patient's lengths by the magnification of the set-up"
        }
        SpacingPlane::Unknown => {
            "the plane of the millimetres is unknown; lengths may exceed the patient's lengths by the magnification of the set-up"
        }
    };
    Some(Notice::new(Severity::Warning, "scale_not_the_patients", text))
}

pub fn synthetic(is_synthetic: bool) -> Option<Notice> {
    is_synthetic.then(|| {
        let text = "synthetic films: made by the program, not measured";
        Notice::new(Severity::Note, "synthetic", text)
    })
}

/// Excluded films.
fn left_out(current: &CurrentCase) -> Vec<Notice> {
    let notices = current.films.iter().filter_map(|(&posture, film)| {
        let missing = film.missing();
        let (severity, text) = match film.readings {
            _ if film.is_usable() => return None,
            // Work to do, and no doubt.
            0 => (
                Severity::Note,
                format!("the {posture} film is left out: it has no finished reading"),
            ),
            _ => {
                let missing = listed(&missing, "is", "are");
                let text = format!("the {posture} film is left out: {missing} without landmarks");
                (Severity::Warning, text)
            }
        };
        let mut notice = Notice::new(severity, "film_left_out", text);
        notice.posture = Some(Wire(posture));
        Some(notice)
    });
    let no_erect = (!current.films.contains_key(&Posture::Erect)).then(|| {
        Notice::new(
            Severity::Warning,
            "no_erect_film",
            "the erect film is missing; it is the reference of all other films",
        )
    });
    // The sagittal profile is then taken from a population.
    let unread = current.lateral.as_ref().filter(|film| film.readings == 0).map(|_| {
        let text = "the lateral film is left out: it has no finished reading";
        Notice::new(Severity::Note, "film_left_out", text)
    });
    notices.chain(no_erect).chain(unread).collect()
}

#[cfg(test)]
mod tests {
    use spineline::action::LineKind;
    use spineline::warning::WarningCode;

    use super::*;

    #[test]
    fn the_line_of_a_notice_is_not_repeated_in_its_text() {
        let mut warnings = Warnings::default();
        for kind in [LineKind::Iliac, LineKind::Given] {
            let posture = Some(Posture::LeftBending);
            warnings.line(WarningCode::ForceNotFound, kind, posture, "no force");
        }
        assert_eq!(warnings.all()[0].text(), "iliac line: no force");
        let [iliac, given] = warnings.all() else { panic!("two lines, two warnings") };
        let [iliac, given] = [of_warning(iliac), of_warning(given)];
        assert_eq!((iliac.line, iliac.text.as_str()), (Some(Wire(LineKind::Iliac)), "no force"));
        assert_eq!((given.line, given.text.as_str()), (Some(Wire(LineKind::Given)), "no force"));
        assert_eq!(iliac.severity, Severity::Contradiction);
    }
}
