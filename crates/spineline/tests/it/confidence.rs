//! Landmarks that a program found: their confidences are noted, low ones are warnings, and no number changes.

use crate::common::{analyzed, exact_case, film_mut, landmarks, landmarks_mut, refused};
use spineline::analysis::AnalysisOptions;
use spineline::anatomy::{Level, Posture};
use spineline::measure::Corners;
use spineline::warning::{Severity, WarningCode};

#[test]
fn low_confidences_are_warnings_and_all_of_them_are_noted() {
    let mut case = exact_case(0);
    let (_, _, readings) = landmarks(film_mut(&mut case, Posture::Erect));
    for (&level, landmark) in &mut readings[0].vertebrae {
        let inferior_left = if level == Level::T5 { 0.31 } else { 0.95 };
        landmark.confidence = Some(Corners {
            superior_left: 0.95,
            superior_right: 0.95,
            inferior_left,
            inferior_right: 0.95,
        });
    }
    let analysis = analyzed(&case, &AnalysisOptions::default());
    let warnings = &analysis.warnings;
    let low: Vec<_> =
        warnings.all().iter().filter(|w| w.code == WarningCode::LowConfidence).collect();
    assert_eq!(
        (low.len(), low[0].level, low[0].posture),
        (1, Some(Level::T5), Some(Posture::Erect))
    );
    assert!(low[0].message.contains("inferior left") && low[0].message.contains("0.31"));
    let note =
        warnings.all().iter().find(|w| w.code == WarningCode::LandmarksByProgram).expect("a note");
    assert_eq!(note.code.severity(), Severity::Note);
    assert!(note.message.contains("0.31 (T5)"), "{}", note.message);
    // Confidences change no number.
    let plain = analyzed(&exact_case(0), &AnalysisOptions::default());
    assert_eq!(plain.movement.clinical, analysis.movement.clinical);
    // A value that is not a probability is refused.
    landmarks_mut(&mut case, Posture::Erect, Level::T9).confidence = Some(Corners {
        superior_left: 87.0,
        superior_right: 0.9,
        inferior_left: 0.9,
        inferior_right: 0.9,
    });
    let error = refused(&case);
    assert!(error.to_string().contains("87") && error.to_string().contains("T9"), "{error}");
}
