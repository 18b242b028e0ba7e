//! The text of the tables of other commands than `analyze --tables`, cell by cell.

use spineline::anatomy::Region;
use spineline::clinical::EndAngles;
use spineline::cohort::Claims;
use spineline::evaluate::statistics::{Share, Summary};
use spineline::multibody::{Deformed, ForceSign, PathPoint, Timing};
use spineline::response::{CurveAngles, SpineAngles};
use spineline::spatial::{Angle, Vec3};
use spineline_tables::{
    LoadedShape, NoisePoint, ReproducedNumber, RowVerdict, csv_case_ids, noise_study_table,
    parquet_case_ids, path_table, reproduction_table, verdicts_table,
};

#[test]
fn verdicts_of_imported_rows() {
    let verdicts = [
        RowVerdict {
            line: 1,
            case_id: "training-0001".to_owned(),
            found: Ok(Angle::from_deg(-12.345_67)),
        },
        RowVerdict {
            line: 2,
            case_id: "training-0002".to_owned(),
            found: Err("T5: corners are swapped; T6, T7: they overlap".to_owned()),
        },
    ];
    assert_eq!(
        verdicts_table(&verdicts).to_csv().expect("a table"),
        "line,case_id,verdict,main_angle_deg,faults\n\
         1,training-0001,clean,-12.3457,\n\
         2,training-0002,faults,,\"T5: corners are swapped; T6, T7: they overlap\"\n"
    );
}

#[test]
fn a_text_that_a_spreadsheet_would_run_is_guarded_in_csv_and_reads_back() {
    for text in ["=cmd|' /C calc'!A0", "-A1", "+1", "@SUM(A1)", "\t=1", " =1", "'=1", "＝1"] {
        let verdict =
            RowVerdict { line: 1, case_id: text.to_owned(), found: Ok(Angle::from_deg(-1.0)) };
        let table = verdicts_table(&[verdict]);
        let csv_text = table.to_csv().expect("a table");
        let mut reader = csv::Reader::from_reader(csv_text.as_bytes());
        let row = reader.records().next().expect("a row").expect("CSV");
        assert_eq!(row[1], format!("'{text}"));
        assert_eq!(&row[3], "-1.0000", "a number is not text");
        assert_eq!(csv_case_ids(&csv_text).expect("a table"), [text.to_owned()].into());
        let parquet = table.to_parquet(&[]).expect("a table");
        assert_eq!(parquet_case_ids(parquet).expect("a table"), [text.to_owned()].into());
    }
}

#[test]
fn numbers_of_a_reproduction() {
    let number = |mean, sd, n| ReproducedNumber {
        section: "3.2, all films".to_owned(),
        support: Some("free"),
        quantity: "mean location error".to_owned(),
        unit: "mm",
        paper: Some("3.45 ± 1.97".to_owned()),
        group: "rod",
        mean,
        sd,
        n,
        text: "4.00 ± 0.12".to_owned(),
        verdict: "same for rod and bend; none for pull".to_owned(),
    };
    // Numbers of all sizes, since a p value can be very small.
    let numbers = [
        number(Some(4.0), Some(0.123_456_789), 24),
        number(Some(0.000_012_3), None, 0),
        number(Some(1.5e-9), Some(-0.5), 1),
        ReproducedNumber { support: None, unit: "", paper: None, ..number(None, Some(1e16), 3) },
    ];
    let start = "\"3.2, all films\",free,mean location error,mm,3.45 ± 1.97,rod";
    let end = "4.00 ± 0.12,same for rod and bend; none for pull";
    let expected = format!(
        "section,support,quantity,unit,paper,group,mean,sd,n,text,verdict\n\
         {start},4.0,0.123456789,24,{end}\n\
         {start},0.0000123,,0,{end}\n\
         {start},1.5e-9,-0.5,1,{end}\n\
         \"3.2, all films\",,mean location error,,,rod,,1e16,3,{end}\n"
    );
    assert_eq!(reproduction_table(&numbers).to_csv().expect("a table"), expected);
}

#[test]
fn shapes_on_a_path() {
    let angle = Angle::from_rad;
    let curve = |region, cobb: Option<f64>| CurveAngles {
        region,
        ends: EndAngles { tilt_range: angle(-0.25), cobb: cobb.map(angle) },
        ferguson: angle(0.125),
    };
    let point = PathPoint {
        timing: Timing::Proportional,
        factor: 1.0,
        arc_rad: 0.0625,
        limit_points: 0,
        branch_points: 0,
        iterations: 7,
        residual_rad: 2.5e-13,
        deformed: Deformed {
            midpoints_mm: vec![Vec3::new(0.0, 0.0, 0.0), Vec3::new(1.5, -20.0, 330.25)],
            axes: Vec::new(),
            hinges_rad: vec![[0.0, 0.0, 0.0], [0.0, 0.5, 0.0]],
        },
    };
    let shape = LoadedShape {
        case_id: "a,b",
        synthetic: true,
        absolute: false,
        status: "reached",
        sign: ForceSign::Negative,
        point: &point,
        angles: SpineAngles {
            lateral_tilt: angle(0.0),
            top_offset_mm: 0.0,
            curves: vec![
                curve(Region::ThoracolumbarLumbar, Some(0.75)),
                curve(Region::MainThoracic, None),
            ],
        },
    };
    let regions = [Region::ThoracolumbarLumbar, Region::MainThoracic];
    let degrees = |rad: f64| angle(rad).deg();
    let expected = format!(
        "case_id,synthetic,absolute,status,direction,timing,factor,arc_rad,lateral_tilt_right_deg,\
         t2_anterior_mm,t2_left_mm,t2_cranial_mm,\
         cobb_thoracolumbar_lumbar_convex_left_deg,cobb_main_thoracic_convex_left_deg,\
         tilt_range_thoracolumbar_lumbar_convex_left_deg,tilt_range_main_thoracic_convex_left_deg,\
         ferguson_thoracolumbar_lumbar_convex_left_deg,ferguson_main_thoracic_convex_left_deg,\
         largest_hinge_rad,residual_rad,iterations\n\
         \"a,b\",true,false,reached,against,{},1,0.0625,0,1.5,-20,330.25,{},,{tilt},{tilt},{f},{f},\
         0.5,2.5e-13,7\n",
        Timing::Proportional.key(),
        degrees(0.75),
        tilt = degrees(-0.25),
        f = degrees(0.125),
    );
    assert_eq!(path_table("t2", &regions, &[shape]).to_csv().expect("a table"), expected);
    assert_eq!(
        path_table("", &[], &[]).to_csv().expect("a table"),
        "case_id,synthetic,absolute,status,direction,timing,factor,arc_rad,lateral_tilt_right_deg,\
         _anterior_mm,_left_mm,_cranial_mm,largest_hinge_rad,residual_rad,iterations\n"
    );
}

const NOISE_STUDY_HEADING: &str = "synthetic,scenario,support,order_rule,noise_sd_mm,\
    phantoms,phantoms_lost,phantoms_with_inflections,near_share,near_share_low,near_share_high,\
    near_share_by_chance,near_verdict,median_distance_segments,\
    mean_rotation_deg,inflection_rotation_deg,\
    below_mean_share,below_mean_share_low,below_mean_share_high,below_mean_verdict,\
    phantoms_compared,inflection_line_error_mm,iliac_line_error_mm,\
    advantage_mm,advantage_low_mm,advantage_high_mm,advantage_p_one_sided,\
    better_share,better_share_low,better_share_high,better_verdict,phantoms_compared_held_out,\
    better_held_out_share,better_held_out_share_low,better_held_out_share_high,\
    rod_exceeds_near_share,rod_exceeds_near_share_low,rod_exceeds_near_share_high,\
    rod_exceeds_below_mean_share,rod_exceeds_below_mean_share_low,rod_exceeds_below_mean_share_high,\
    rod_exceeds_advantage_share,rod_exceeds_advantage_share_low,rod_exceeds_advantage_share_high,\
    curve_residual_mm,curve_residual_deg,mean_order";

fn share(share: f64, n: usize) -> Share {
    Share { share, n, interval: [share - 0.1, share + 0.012_34] }
}

fn claims() -> Claims {
    Claims {
        patients: 20,
        near: share(0.75, 19),
        near_by_chance: 0.333_33,
        median_distance_segments: 12.5,
        rotations_deg: [8.123_456_7, 2.0],
        below_mean: 0.95,
        below_mean_interval: Some([0.91, 0.99]),
        better: share(0.625, 18),
        better_held_out: share(0.5, 17),
        errors_mm: [3.25, 4.5],
        held_out_errors_mm: [1.25, 2.5],
        third_points: [2, 80],
        third_points_deg: Summary { n: 2, mean: 0.002, sd: 0.001 },
        against_force: Summary { n: 40, mean: 4.0, sd: 1.0 },
        advantage_mm: (1.25, Some([-0.5, 3.0])),
        advantage_p: Some(0.001_234_56),
        residuals: [0.43, 0.87],
        order: 9.1,
    }
}

#[test]
fn settings_of_the_noise_study() {
    let (whole, none) = (claims(), Claims::of(&[], 1));
    let points = [
        NoisePoint {
            scenario: "bend",
            support: Some("free"),
            order_rule: "order 6".to_owned(),
            noise_sd_mm: 0.35,
            claims: &whole,
            lost: 1,
            rod_exceeds: Some([share(0.25, 9), share(0.5, 9), share(0.75, 9)]),
        },
        NoisePoint {
            scenario: "rod",
            support: None,
            order_rule: "two-inflections".to_owned(),
            noise_sd_mm: 0.0,
            claims: &none,
            lost: 20,
            rod_exceeds: None,
        },
    ];
    let expected = format!(
        "{NOISE_STUDY_HEADING}\n\
         true,bend,free,order 6,0.35,20,1,19,0.7500,0.6500,0.7623,0.3333,fails,12.5,\
         8.12346,2.00000,0.9500,0.9100,0.9900,holds,18,3.250,4.500,1.250,-0.500,3.000,1.235e-3,\
         0.6250,0.5250,0.6373,holds,17,0.5000,0.4000,0.5123,\
         0.2500,0.1500,0.2623,0.5000,0.4000,0.5123,0.7500,0.6500,0.7623,0.4300,0.8700,9.10\n\
         true,rod,,two-inflections,0,0,20,0,,0.0000,1.0000,,,,,,,,,,\
         0,,,,,,,,0.0000,1.0000,,0,,0.0000,1.0000,,,,,,,,,,,,\n"
    );
    assert_eq!(noise_study_table(&points).to_csv().expect("a table"), expected);
}
