//! Spacing and view by files, and scales by a ball or a ruler: faults F10, F11, and the sides of a film.

use spineline::anatomy::{ImageSide, Posture};
use spineline::measure::{SpacingPlane, SpacingSource};
use spineline::spatial::Pixel;
use spineline_marking::{
    Calibration, CalibrationError, CalibrationType, Calibrator, PatientDirection, SpacingEvidence,
    SpacingRemark, Stance, View, ViewEvidence, ViewPosition, ViewQuestion, judge_spacing,
    judge_view,
};

/// Distances of rows and columns, their plane and source.
type Found = (f64, f64, SpacingPlane, SpacingSource);

fn judged(evidence: SpacingEvidence) -> (Option<Found>, Vec<SpacingRemark>) {
    let judgement = judge_spacing(&evidence);
    let spacing = judgement.spacing.map(|s| (s.row_mm, s.column_mm, s.plane, s.source));
    (spacing, judgement.remarks)
}

#[test]
fn the_first_value_is_the_distance_between_rows() {
    // DICOM PS3.3, 10.7.1.3: row spacing first. Eight programs had the opposite order.
    let (spacing, remarks) = judged(SpacingEvidence {
        pixel_mm: Some([0.2, 0.1]),
        calibration: Some(CalibrationType::Fiducial),
        ..Default::default()
    });
    assert_eq!(spacing, Some((0.2, 0.1, SpacingPlane::Patient, SpacingSource::Fiducial)));
    assert_eq!(remarks, [SpacingRemark::NotSquare { aspect: 2.0 }]);
}

#[test]
fn pixel_spacing_is_in_the_patient_plane_with_a_calibration_type_only() {
    let (spacing, remarks) =
        judged(SpacingEvidence { pixel_mm: Some([0.14; 2]), ..Default::default() });
    assert_eq!(spacing, Some((0.14, 0.14, SpacingPlane::Unknown, SpacingSource::PixelSpacing)));
    assert_eq!(remarks, [SpacingRemark::PlaneNotStated]);
    // Equal values: the spacing was not corrected.
    let (spacing, remarks) = judged(SpacingEvidence {
        pixel_mm: Some([0.15; 2]),
        imager_mm: Some([0.15; 2]),
        ..Default::default()
    });
    assert_eq!(spacing, Some((0.15, 0.15, SpacingPlane::Detector, SpacingSource::Imager)));
    assert_eq!(remarks, [SpacingRemark::DetectorPlane]);
    // Different values, without a stated reason.
    let (spacing, remarks) = judged(SpacingEvidence {
        pixel_mm: Some([0.125; 2]),
        imager_mm: Some([0.15; 2]),
        ..Default::default()
    });
    assert_eq!(spacing, Some((0.125, 0.125, SpacingPlane::Unknown, SpacingSource::Uncalibrated)));
    assert!(matches!(remarks[..], [SpacingRemark::CorrectionNotStated { .. }]), "{remarks:?}");
}

#[test]
fn implausible_spacings_are_not_used() {
    for bad in [[0.0; 2], [-0.1, 0.1], [0.1, f64::NAN], [f64::INFINITY, 0.1], [1e-5, 0.1]] {
        let (spacing, remarks) =
            judged(SpacingEvidence { pixel_mm: Some(bad), ..Default::default() });
        assert_eq!(spacing, None, "{bad:?}");
        assert!(
            matches!(
                remarks[..],
                [SpacingRemark::Unusable { attribute: "Pixel Spacing", .. }, SpacingRemark::None]
            ),
            "{remarks:?}"
        );
        // The next best evidence is taken instead.
        let (spacing, _) = judged(SpacingEvidence {
            pixel_mm: Some(bad),
            imager_mm: Some([0.1; 2]),
            ..Default::default()
        });
        assert_eq!(spacing, Some((0.1, 0.1, SpacingPlane::Detector, SpacingSource::Imager)));
    }
}

#[test]
fn the_imagers_spacing_is_divided_by_the_magnification() {
    let imager_mm = Some([0.2, 0.1]);
    let (spacing, _) = judged(SpacingEvidence {
        imager_mm,
        source_to_detector_mm: Some(1800.0),
        source_to_patient_mm: Some(1500.0),
        ..Default::default()
    });
    // 1800 / 1500 = 1.2.
    let (row, column, plane, source) = spacing.expect("two distances");
    assert!((row - 0.2 / 1.2).abs() < 1e-15 && (column - 0.1 / 1.2).abs() < 1e-15);
    assert_eq!((plane, source), (SpacingPlane::Unknown, SpacingSource::Distances));
}

#[test]
fn unused_pixel_spacing_gives_a_remark() {
    let (spacing, remarks) = judged(SpacingEvidence {
        pixel_mm: Some([0.175; 2]),
        imager_mm: Some([0.2; 2]),
        magnification: Some(1.25),
        ..Default::default()
    });
    assert_eq!(spacing, Some((0.16, 0.16, SpacingPlane::Patient, SpacingSource::Magnification)));
    assert!(matches!(remarks[..], [SpacingRemark::PixelSpacingPassedOver { .. }]), "{remarks:?}");
}

#[test]
fn impossible_or_contradicting_magnifications_keep_the_detector_plane() {
    let imager_mm = Some([0.1; 2]);
    let detector = Some((0.1, 0.1, SpacingPlane::Detector, SpacingSource::Imager));
    for value in [1.0, 0.9, 0.0, -1.0, 2.5, f64::NAN] {
        let (spacing, remarks) =
            judged(SpacingEvidence { imager_mm, magnification: Some(value), ..Default::default() });
        assert_eq!(spacing, detector, "{value}");
        assert!(matches!(remarks[0], SpacingRemark::Magnification { stated: true, .. }));
    }
    let (spacing, remarks) = judged(SpacingEvidence {
        imager_mm,
        magnification: Some(1.05),
        source_to_detector_mm: Some(1800.0),
        source_to_patient_mm: Some(1500.0),
        ..Default::default()
    });
    assert_eq!(spacing, detector);
    assert!(matches!(remarks[0], SpacingRemark::MagnificationsDisagree { .. }), "{remarks:?}");
    // A calibrated spacing that contradicts the geometry is used, with a remark.
    let (spacing, remarks) = judged(SpacingEvidence {
        pixel_mm: Some([0.1; 2]),
        calibration: Some(CalibrationType::Geometry),
        imager_mm,
        magnification: Some(1.3),
        ..Default::default()
    });
    assert_eq!(spacing, Some((0.1, 0.1, SpacingPlane::Patient, SpacingSource::Geometry)));
    assert!(matches!(remarks[..], [SpacingRemark::SpacingsDisagree { .. }]), "{remarks:?}");
}

#[test]
fn pairs_of_distances_with_another_shape_of_a_pixel_are_asked_about() {
    // The true pixels are 0.35 mm high and 0.25 mm wide; at magnification 1.1 the detector's are 0.385 mm and 0.275 mm.
    let (tall, square) = ([0.35, 0.25], [0.25; 2]);
    let (tall_imager, square_imager) = ([0.385, 0.275], [0.275; 2]);
    let calibrated = Some(CalibrationType::Geometry);
    let with = |pixel, calibration, imager, magnification| SpacingEvidence {
        pixel_mm: Some(pixel),
        calibration,
        imager_mm: Some(imager),
        magnification,
        ..Default::default()
    };
    for (evidence, words) in [
        (with(square, calibrated, tall_imager, Some(1.1)), ["1.000", "1.400 times by Imager"]),
        (with(square, calibrated, tall_imager, None), ["1.000", "1.400 times by Imager"]),
        (with(tall, None, square_imager, Some(1.1)), ["1.000", "1.400 times by Pixel Spacing"]),
        (with(square, None, tall_imager, None), ["1.000", "1.400 times by Imager"]),
        (with(square, None, [0.35, 0.25], None), ["1.000", "1.400 times by Imager"]),
    ] {
        let judged = judge_spacing(&evidence);
        let asked = judged.question().map(ToString::to_string).unwrap_or_default();
        assert!(words.iter().all(|word| asked.contains(word)), "{evidence:?}: {asked}");
    }
    // A scanned film with another shape than its calibrated spacing.
    let scanned = SpacingEvidence {
        pixel_mm: Some(tall),
        calibration: Some(CalibrationType::Fiducial),
        scanned_mm: Some(square),
        ..Default::default()
    };
    let asked = judge_spacing(&scanned).question().map(ToString::to_string).unwrap_or_default();
    assert!(asked.contains("1.000 times by Nominal Scanned Pixel Spacing"), "{asked}");
    // Two scales of one shape agree, and so do distances with a rounded last digit.
    for (pixel, imager) in [(tall, tall_imager), (square, [0.275, 0.2755])] {
        for (calibration, magnification) in
            [(calibrated, Some(1.1)), (None, Some(1.1)), (None, None)]
        {
            let judged = judge_spacing(&with(pixel, calibration, imager, magnification));
            assert_eq!(judged.question(), None, "{pixel:?} {imager:?}");
        }
    }
}

/// Columns and rows of the picture.
const SIZE_PX: [u32; 2] = [1200, 800];

fn ruler(clicks: [Pixel; 2], pixel_aspect: f64) -> Calibration {
    Calibration {
        calibrator: Calibrator::Ruler,
        clicks,
        length_mm: 100.0,
        length_sd_mm: 0.5,
        click_sd_px: 0.5,
        pixel_aspect,
    }
}

#[test]
fn a_ruler_gives_the_same_scale_in_any_direction_of_pixels_that_are_not_square() {
    // Pixels of 0.1 mm by 0.2 mm: 100 mm are 1000 columns, 500 rows, or 600 columns and 400 rows (60 and 80 mm).
    let from = Pixel::new(50.0, 80.0);
    for (columns, rows) in [(1000.0, 0.0), (0.0, 500.0), (600.0, 400.0), (-600.0, 400.0)] {
        let from = Pixel::new(if columns < 0.0 { 700.0 } else { from.column_px }, from.row_px);
        let to = Pixel::new(from.column_px + columns, 80.0 + rows);
        let spacing = ruler([from, to], 2.0).spacing(SIZE_PX).expect("a good ruler");
        assert!((spacing.column_mm - 0.1).abs() < 1e-12, "{columns} {rows}: {spacing:?}");
        assert!((spacing.row_mm - 0.2).abs() < 1e-12);
        assert_eq!(spacing.plane, SpacingPlane::Patient);
    }
}

#[test]
fn the_error_of_a_scale_equals_that_of_perturbed_clicks() {
    // Oracle: 20,000 scattered pairs of clicks from a separate small generator.
    let mut state = 1u64;
    let mut uniform = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    // Twelve uniform numbers less six have mean 0 and variance 1.
    let mut normal = move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
    let truth = [Pixel::new(100.0, 100.0), Pixel::new(160.0, 140.0)];
    let stated =
        ruler(truth, 2.0).spacing(SIZE_PX).expect("a good ruler").relative_sd.expect("a scale");
    let scales: Vec<f64> = (0..20_000)
        .map(|_| {
            let clicks =
                truth.map(|p| Pixel::new(p.column_px + 0.5 * normal(), p.row_px + 0.5 * normal()));
            let mut scattered = ruler(clicks, 2.0);
            scattered.length_mm += 0.5 * normal();
            scattered.spacing(SIZE_PX).expect("a good ruler").column_mm
        })
        .collect();
    let mean = scales.iter().sum::<f64>() / scales.len() as f64;
    let variance = scales.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / scales.len() as f64;
    let found = variance.sqrt() / mean;
    // The deviation of a deviation from 20,000 values is 0.5 %.
    assert!((found / stated - 1.0).abs() < 0.03, "{found} against {stated}");
}

#[test]
fn implausible_clicks_and_lengths_are_refused() {
    let far = [Pixel::new(0.0, 0.0), Pixel::new(300.0, 0.0)];
    let near = [Pixel::new(0.0, 0.0), Pixel::new(3.0, 0.0)];
    assert!(matches!(ruler(near, 1.0).spacing(SIZE_PX), Err(CalibrationError::TooNear { .. })));
    for length_mm in [0.0, -25.0, f64::NAN, f64::INFINITY] {
        let bad = Calibration { length_mm, ..ruler(far, 1.0) };
        assert!(matches!(bad.spacing(SIZE_PX), Err(CalibrationError::Value { .. })), "{length_mm}");
    }
    for (calibrator, length_mm) in
        [(Calibrator::Ball, 254.0), (Calibrator::Ball, 0.5), (Calibrator::Ruler, 2001.0)]
    {
        let bad = Calibration { calibrator, length_mm, ..ruler(far, 1.0) };
        assert!(
            matches!(bad.spacing(SIZE_PX), Err(CalibrationError::Length { .. })),
            "{length_mm}"
        );
    }
    // 5.1 mm a pixel.
    let coarse = Calibration { length_mm: 1530.0, ..ruler(far, 1.0) };
    assert!(matches!(coarse.spacing(SIZE_PX), Err(CalibrationError::Value { .. })));
    let lost = ruler([Pixel::new(f64::NAN, 0.0), far[1]], 1.0);
    assert!(matches!(
        lost.spacing(SIZE_PX),
        Err(CalibrationError::Value { what: "coordinate of a point", .. })
    ));
}

fn orientation(columns: &str, rows: &str) -> ViewEvidence {
    let direction = |text| PatientDirection::from_dicom(text).expect("a direction");
    ViewEvidence { orientation: Some([direction(columns), direction(rows)]), ..Default::default() }
}

#[test]
fn patient_orientation_gives_the_side_of_frontal_and_lateral_films() {
    for (columns, side) in
        [("L", ImageSide::Right), ("R", ImageSide::Left), ("LF", ImageSide::Right)]
    {
        let judged = judge_view(&orientation(columns, "F"), None);
        assert_eq!((judged.view, judged.patient_left), (Some(View::Frontal), Some(side)));
        assert!(judged.questions.is_empty(), "{:?}", judged.questions);
    }
    for (columns, side) in [("A", ImageSide::Right), ("P", ImageSide::Left)] {
        let judged = judge_view(&orientation(columns, "F"), None);
        assert_eq!((judged.view, judged.patient_anterior), (Some(View::Lateral), Some(side)));
        assert_eq!(judged.patient_left, None);
        assert!(judged.questions.is_empty(), "{:?}", judged.questions);
    }
}

#[test]
fn absent_or_contradicting_values_are_asked_for_and_never_assumed() {
    let nothing = judge_view(&ViewEvidence::default(), None);
    assert_eq!((nothing.view, nothing.patient_left), (None, None));
    assert_eq!(nothing.questions, [ViewQuestion::View, ViewQuestion::PatientLeft]);
    // The direction of the beam does not give the orientation of the picture.
    for word in ["AP", "PA", "pa "] {
        let view_position = Some(ViewPosition::from_dicom(word));
        let judged = judge_view(&ViewEvidence { view_position, ..Default::default() }, None);
        assert_eq!((judged.view, judged.patient_left), (Some(View::Frontal), None));
        assert_eq!(judged.questions, [ViewQuestion::PatientLeft]);
    }
    let lateral = Some(ViewPosition::from_dicom("LL"));
    let both = ViewEvidence { view_position: lateral, ..orientation("L", "F") };
    let judged = judge_view(&both, None);
    assert_eq!((judged.view, judged.patient_left), (None, None));
    assert!(judged.questions.contains(&ViewQuestion::ViewsDisagree));
    // A film that is upside down is not evidence for an upright one.
    let judged = judge_view(&orientation("L", "H"), None);
    assert_eq!(judged.patient_left, None);
    assert!(judged.questions.contains(&ViewQuestion::NotUpright { rows: PatientDirection::Head }));
}

#[test]
fn a_patient_lying_on_a_side_does_not_give_the_view() {
    for word in ["LLD", "RLD", "LEFT LATERAL DECUBITUS", "POSTERO-LATERAL"] {
        assert_eq!(ViewPosition::from_dicom(word), ViewPosition::Other, "{word}");
    }
    for word in ["LL", "RL", "LATERAL", "left lateral"] {
        assert_eq!(ViewPosition::from_dicom(word), ViewPosition::Lateral, "{word}");
    }
}

#[test]
fn a_stance_that_contradicts_the_posture_is_asked_about() {
    let evidence = |stance| ViewEvidence { stance: Some(stance), ..orientation("L", "F") };
    let asked =
        |stance, posture| !judge_view(&evidence(stance), Some(posture)).questions.is_empty();
    assert!(asked(Stance::Recumbent, Posture::Erect));
    assert!(asked(Stance::Erect, Posture::Neutral));
    assert!(!asked(Stance::Erect, Posture::Erect));
    // Bends are taken lying, as in the paper, and standing.
    assert!(!asked(Stance::Erect, Posture::LeftBending));
    assert!(!asked(Stance::Recumbent, Posture::RightBending));
}

#[test]
fn points_of_a_ball_outside_of_the_picture_are_refused_with_the_size_of_the_picture() {
    let ball = Calibration {
        calibrator: Calibrator::Ball,
        clicks: [Pixel::new(700.0, 1100.0), Pixel::new(750.0, 1100.0)],
        length_mm: 25.0,
        length_sd_mm: 0.0,
        click_sd_px: 0.5,
        pixel_aspect: 1.0,
    };
    let error = ball.spacing([400, 600]).expect_err("a copy of half the size");
    assert_eq!(error.to_string(), "the point 700.0, 1100.0 lies outside of the 400 × 600 picture");
    assert_eq!(ball.spacing([800, 1200]).map(|spacing| spacing.column_mm), Ok(0.5));
    let percent = Calibration { length_sd_mm: 25.0, ..ball };
    assert!(matches!(percent.spacing([800, 1200]), Err(CalibrationError::Value { .. })));
}
