//! An analysis file contains all its inputs.

use nalgebra::DMatrix;
use spineline::action::LineOfAction;
use spineline::analysis::{AnalysisOptions, Grouping, Reference, analyze};
use spineline::anatomy::{Level, Levels, Posture};
use spineline::clinical::{CobbEnds, EndChoice, EndRule};
use spineline::curve::{InflectionChoice, OrderRule, Site};
use spineline::evaluate::{PriorSource, RotationPrior};
use spineline::hypothesis::{Hypothesis, LoadShape};
use spineline::measure::{AmplitudeEnds, FilmLengthRule, TiltRule};
use spineline::multibody::{JointStiffness, StiffnessLibrary, Support};
use spineline::personalize::{Base, FitTarget, Gauge, LogNormalPrior};
use spineline::spatial::{Angle, Frontal};
use spineline::uncertainty::LandmarkNoise;
use spineline_files::{
    AnalysisFile, CaseFile, FileError, FilmOrigin, InputFile, ProgramRun, Provenance, Replicates,
    Request, parse_analysis, parse_case_within, parse_stiffness, to_text,
};
use spineline_phantom::{Readers, Scenario, generate};

pub(super) fn run() -> ProgramRun {
    ProgramRun {
        program: "spineline 0".to_owned(),
        command: ["spineline", "analyze", "case.json"].map(str::to_owned).to_vec(),
        date_utc: "2026-01-02T03:04:05Z".to_owned(),
    }
}

fn provenance(request: &Request) -> Provenance {
    let inputs = vec![InputFile::of("case.json", b"")];
    Provenance::new(run(), FilmOrigin::Synthetic, inputs).asking(request)
}

/// No choice is the default one, and no number is short.
fn odd_options() -> AnalysisOptions {
    let defaults = StiffnessLibrary::default();
    let rows = defaults.rows().iter().enumerate().map(|(i, row)| JointStiffness {
        axial_per_lateral: 0.1 - 0.03 * i as f64,
        nmm_per_rad: row
            .nmm_per_rad
            .map(|value| 1000.0 * (value / 1000.0 * (1.1 + i as f64 / 7.0))),
        source: format!("measured on the {i}th"),
        ..row.clone()
    });
    let site = |inferior, superior| Site { inferior, superior };
    let ends = CobbEnds { inferior: Level::T12, superior: Level::T5 };
    AnalysisOptions {
        film_lengths: FilmLengthRule::PerFilm { relative_sd: 0.02 },
        tilt: TiltRule::Axis,
        amplitude: AmplitudeEnds::T1L5,
        ends: EndChoice { rule: EndRule::Erect, given: [None, Some(ends), None] },
        order_rule: OrderRule::Fixed(7),
        inflections: InflectionChoice::ByHand([
            site(Level::L1, Level::T12),
            site(Level::T6, Level::T6),
        ]),
        min_curve: Angle::from_deg(4.1),
        library: StiffnessLibrary::from_rows(rows.collect()).expect("sound springs"),
        support: Support::Free,
        reference: Reference::Loaded { body_mass_kg: 47.5 },
        gauge: Gauge::KnownForce { posture: Posture::Traction, force_n: 117.3 },
        target: FitTarget::Ferguson,
        grouping: Grouping::PerJoint,
        prior: Some(LogNormalPrior { log_sd: 0.3 }),
        rotation_prior: Some(odd_rotation_prior()),
        given_lines: vec![(
            Posture::LeftBending,
            LineOfAction::leaning(Frontal::new(20.1, 150.7), Angle::from_deg(-5.3)),
        )],
        hypotheses: vec![
            Hypothesis::of(LoadShape::Couple),
            Hypothesis { load: LoadShape::FreeLine, base: Base::Noisy },
        ],
    }
}

/// A distribution as it is read from a file: its numbers are of degrees.
fn odd_rotation_prior() -> RotationPrior {
    let mean = (0..14).map(|joint| Angle::from_deg(f64::from(joint) / 9.7)).collect();
    let square = Angle::from_deg(1.0).rad().powi(2);
    let covariance = DMatrix::from_fn(14, 14, |i, j| {
        square * if i == j { 4.0 / (i as f64 + 3.0) } else { 0.03 / (i * j + i + j) as f64 }
    });
    let source = PriorSource::Learned { patients: 7, bends: 13, shrinkage: 0.123_456_789 };
    let prior = RotationPrior::new(Levels::COMPLETE, mean, covariance, source);
    prior.expect("a covariance").with_erect_coefficient(-0.384_615)
}

#[test]
fn every_option_round_trips_to_the_last_bit() {
    let case = generate(2, Scenario::Rod, &Readers::exact(), 5).expect("subject 3 exists").case;
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let replicates =
        Some(Replicates { count: 300, noise: LandmarkNoise::Pixels(2.7), seed: u64::MAX });
    for request in [
        Request::default(),
        Request { options: odd_options(), replicates, identifiability: true },
        Request {
            options: AnalysisOptions {
                order_rule: OrderRule::Paper,
                gauge: Gauge::FrozenForce,
                ..AnalysisOptions::default()
            },
            replicates: replicates.map(|r| Replicates { noise: LandmarkNoise::Measured, ..r }),
            identifiability: false,
        },
    ] {
        let file = AnalysisFile::new(&analysis, CaseFile::from_case(&case), provenance(&request));
        let text = to_text(&file);
        let stored = parse_analysis(&text).expect("our own file");
        assert_eq!(stored.request, request);
        assert_eq!(stored.case, case);
        assert_eq!(stored.provenance, provenance(&request));
        let (within, asked) = parse_case_within(&text).expect("a case is within");
        assert_eq!((within, asked), (stored.case_file, Some(request)));
    }
}

#[test]
fn a_stiffness_table_round_trips_to_the_last_bit() {
    let table = to_text(&spineline_files::StiffnessFile::from(&StiffnessLibrary::default()));
    for written in ["131.9", "1.234567890123", "97.30000000000001", "5120.007"] {
        let text = table.replacen("132.0", written, 1);
        assert_ne!(text, table);
        let library = parse_stiffness(&text).expect("sound springs");
        let again = to_text(&spineline_files::StiffnessFile::from(&library));
        assert_eq!(parse_stiffness(&again).expect("our own file"), library, "{written}");
    }
}

#[test]
fn an_analysis_that_cannot_be_repeated_says_what_is_missing() {
    let case = generate(2, Scenario::Rod, &Readers::exact(), 5).expect("subject 3 exists").case;
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let request = Request {
        options: odd_options(),
        replicates: Some(Replicates { count: 3, noise: LandmarkNoise::Measured, seed: 1 }),
        identifiability: false,
    };
    let file = AnalysisFile::new(&analysis, CaseFile::from_case(&case), provenance(&request));
    let whole: serde_json::Value = serde_json::from_str(&to_text(&file)).expect("JSON");
    let without = |pointer: &str, key: &str| {
        let mut json = whole.clone();
        let parent = json.pointer_mut(pointer).and_then(|value| value.as_object_mut());
        assert!(parent.expect("an object").remove(key).is_some(), "{key}");
        parse_analysis(&json.to_string()).expect_err("a part is missing")
    };
    assert!(matches!(without("", "case"), FileError::NotRepeatable { part: "case" }));
    assert!(matches!(without("", "provenance"), FileError::NotRepeatable { part: "provenance" }));
    let options = without("/provenance", "options");
    assert!(matches!(options, FileError::NotRepeatable { part: "provenance.options" }));
    assert!(options.help().contains("analyze"));
    assert!(matches!(without("/provenance", "seed"), FileError::NoSeed));
    for key in ["tilt", "film_lengths", "end_vertebrae", "inflections", "prior"] {
        let error = without("/provenance/options", key).to_string();
        assert!(error.contains(&format!("option `{key}` is missing")), "{error}");
    }
    let unknown = to_text(&file).replace("\"couple,", "\"copule,");
    let error = parse_analysis(&unknown).expect_err("an unknown load").to_string();
    assert!(error.contains("copule") && error.contains("compare_models"), "{error}");
    let case = to_text(&CaseFile::from_case(&case));
    assert!(matches!(parse_analysis(&case), Err(FileError::Format { .. })));
}

#[test]
fn synthetic_films_among_real_ones_are_reported() {
    assert_eq!(FilmOrigin::of([true, true]), FilmOrigin::Synthetic);
    assert_eq!(FilmOrigin::of([true, false]), FilmOrigin::SyntheticAndReal);
    assert_eq!(FilmOrigin::of([false]), FilmOrigin::Real);
}
