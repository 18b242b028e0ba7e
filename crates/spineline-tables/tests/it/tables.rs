//! Tables equal the analysis, in CSV and in Parquet, and the dictionary lists every column.

use std::collections::{BTreeMap, BTreeSet};

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::anatomy::{Level, Posture};
use spineline::hypothesis::{Hypothesis, LoadShape};
use spineline::measure::{Corners, Origin};
use spineline::spatial::Angle;
use spineline::uncertainty::{LandmarkNoise, MonteCarlo};
use spineline::warning::WarningCode;
use spineline_phantom::{Readers, Scenario, SpaceSetup, generate, generate_in_space};
use spineline_tables::{
    OptionalTables, Patient, Table, Values, dictionary, dictionary_markdown, tables,
};

fn case(subject: usize) -> Case {
    generate(subject, Scenario::Rod, &Readers::default(), 5).expect("a subject").case
}

/// The tables of a patient with all optional results.
fn everything(case: &Case) -> Vec<Table> {
    let options = AnalysisOptions {
        hypotheses: vec![Hypothesis::of(LoadShape::Couple)],
        ..AnalysisOptions::default()
    };
    let analysis = analyze(case, &options).expect("a phantom");
    let monte_carlo = MonteCarlo::new(case, &analysis, LandmarkNoise::Pixels(2.0), 1);
    let monte_carlo = monte_carlo.expect("sound noise");
    let mut tally = monte_carlo.tally();
    (0..2).for_each(|index| tally.add(&monte_carlo.replicate(index)));
    let spread = tally.finish(2);
    let identified: Vec<_> = analysis.models.iter().map(|m| analysis.identifiability(m)).collect();
    tables(&[Patient {
        analysis: &analysis,
        subject: &case.subject,
        identifiability: Some(&identified),
        uncertainty: Some(&spread),
    }])
}

/// The tables of a patient without optional results.
fn tables_of(case: &Case, analysis: &Analysis) -> Vec<Table> {
    let subject = &case.subject;
    tables(&[Patient { analysis, subject, identifiability: None, uncertainty: None }])
}

fn table<'a>(all: &'a [Table], name: &str) -> &'a Table {
    all.iter().find(|table| table.name == name).expect("a table")
}

fn numbers<'a>(table: &'a Table, column: &str) -> &'a [Option<f64>] {
    let found = table.columns.iter().find(|series| series.name == column);
    match &found.unwrap_or_else(|| panic!("no column {column}")).values {
        Values::Number(all) => all,
        other => panic!("{column} holds {}", other.kind()),
    }
}

fn texts(table: &Table, column: &str) -> Vec<String> {
    let found = table.columns.iter().find(|series| series.name == column);
    let found = found.unwrap_or_else(|| panic!("no column {column}"));
    (0..found.values.len()).map(|row| found.shown(row)).collect()
}

#[test]
fn rows_equal_the_analysis() {
    let case = case(2);
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let all = everything(&case);
    let vertebrae = table(&all, "vertebrae");
    let lines = analysis.models.len();
    // The erect film has no model.
    assert_eq!(vertebrae.rows(), 15 * (1 + 4 * lines));
    let keys = ["posture", "line", "level"].map(|key| texts(vertebrae, key));
    let errors = numbers(vertebrae, "location_error_mm");
    let mut seen = BTreeSet::new();
    for row in 0..vertebrae.rows() {
        assert!(seen.insert(keys.each_ref().map(|key| key[row].clone())), "a row stands twice");
        let model = analysis.models.iter().find(|model| model.kind.key() == keys[1][row]);
        let posture = Posture::ALL.into_iter().find(|p| p.key() == keys[0][row]).expect("a film");
        let level: Level = keys[2][row].parse().expect("a vertebra");
        let index = level.model_index().expect("of the model");
        let expected = model.and_then(|model| model.simulation(posture)).filter(|s| s.is_usable());
        let expected = expected
            .and_then(|s| index.checked_sub(1).map(|above| s.shape.location_errors_mm[above]));
        assert_eq!(errors[row], expected, "{posture} {level}");
    }
    let clinical = table(&all, "clinical");
    assert_eq!(clinical.rows(), 3 * 5);
    assert_eq!(
        numbers(clinical, "cobb_deg")[0],
        analysis.movement.clinical[0].cobb_in(Posture::Erect).map(Angle::deg)
    );
    let multipliers = table(&all, "multipliers");
    let low = numbers(multipliers, "interval_95_low");
    let high = numbers(multipliers, "interval_95_high");
    for (row, (low, high)) in low.iter().zip(high).enumerate() {
        assert!(high.is_none() || low < high, "row {row}");
    }
    assert_eq!(table(&all, "joints").rows(), 14 * 4 * lines);
    assert_eq!(table(&all, "springs").rows(), 14 * lines);
    assert!(table(&all, "uncertainty").rows() > 100);
    assert!(table(&all, "hypotheses").rows() >= 4);
    assert!(table(&all, "reliability").rows() > 50, "six readings per film");
}

#[test]
fn a_lateral_film_adds_the_vertebrae_in_space() {
    let setup = SpaceSetup { pedicles: true, ..SpaceSetup::default() };
    let case = generate_in_space(&setup).case;
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let all = tables_of(&case, &analysis);
    let vertebrae = table(&all, "space_vertebrae");
    assert_eq!(vertebrae.rows(), Level::ALL.len());
    let [film, space] = ["pitch_2d_deg", "pitch_3d_deg"].map(|name| numbers(vertebrae, name));
    let larger =
        film.iter().zip(space).filter(|(film, space)| film.map(f64::abs) >= space.map(f64::abs));
    assert_eq!(larger.count(), Level::ALL.len(), "a film overstates pitch");
    assert_eq!(table(&all, "axial_rotation").rows(), Level::ALL.len());
    let assumed = numbers(vertebrae, "pitch_template_deg");
    assert_eq!(
        assumed.iter().flatten().count(),
        Level::MODEL.len(),
        "L5 and T1 are not of the model"
    );
    let measures = table(&all, "space_measures");
    let measured = analysis
        .movement
        .spatial_measures()
        .expect("both films")
        .numbers(analysis.movement.scale());
    assert_eq!(measures.rows(), measured.len());
    assert!(texts(measures, "dimension").iter().all(|text| text == "2-D" || text == "3-D"));
    let [value, low, high] =
        ["value", "interval_95_low", "interval_95_high"].map(|name| numbers(measures, name));
    assert!((0..measures.rows()).all(|row| low[row] < value[row] && value[row] < high[row]));
}

#[test]
fn a_vertebra_has_the_origin_of_its_corners() {
    let mut case = case(0);
    for film in &mut case.films {
        for reading in film.landmarks.corner_readings_mut() {
            for (level, landmark) in &mut reading.vertebrae {
                match level {
                    Level::T8 => landmark.origins = Corners::all(Origin::Adjusted),
                    Level::T9 => landmark.origins.inferior_left = Origin::Adjusted,
                    _ => {}
                }
            }
        }
    }
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let all = tables_of(&case, &analysis);
    let vertebrae = table(&all, "vertebrae");
    let origins = texts(vertebrae, "origin");
    let levels = texts(vertebrae, "level");
    assert!(!levels.is_empty());
    for (level, origin) in levels.iter().zip(origins) {
        let expected = match level.as_str() {
            "T8" => "adjusted",
            "T9" => "mixed",
            _ => "clicked",
        };
        assert_eq!(origin, expected, "{level}");
    }
}

#[test]
fn csv_and_parquet_round_trip() {
    for table in everything(&case(2)) {
        let name = table.name;
        let text = table.to_csv().expect("texts and numbers");
        let mut csv = csv::Reader::from_reader(text.as_bytes());
        let heading: Vec<String> = csv.headers().expect("one").iter().map(str::to_owned).collect();
        assert_eq!(heading, table.columns.iter().map(|c| c.name.clone()).collect::<Vec<_>>());
        let csv_rows: Vec<csv::StringRecord> =
            csv.records().map(|row| row.expect("a row")).collect();
        let bytes = table.to_parquet(&[("spineline.provenance", "{\"a\": 1}")]).expect("a file");
        let file = SerializedFileReader::new(bytes::Bytes::from(bytes)).expect("Parquet");
        let rows: Vec<_> =
            file.get_row_iter(None).expect("rows").map(|r| r.expect("a row")).collect();
        assert_eq!((csv_rows.len(), rows.len()), (table.rows(), table.rows()), "{name}");
        for (i, (in_csv, in_parquet)) in csv_rows.iter().zip(&rows).enumerate() {
            for (c, (column, field)) in in_parquet.get_column_iter().enumerate() {
                assert_eq!(*column, heading[c]);
                assert_eq!(in_csv[c], table.columns[c].shown(i), "{name} {column}");
                let same = match (&table.columns[c].values, field) {
                    (Values::Number(all), Field::Double(value)) => all[i] == Some(*value),
                    (Values::Count(all), Field::Long(value)) => all[i] == Some(*value),
                    (Values::Truth(all), Field::Bool(value)) => all[i] == Some(*value),
                    (Values::Text(all), Field::Str(value)) => all[i].as_ref() == Some(value),
                    (_, Field::Null) => in_csv[c].is_empty(),
                    _ => false,
                };
                assert!(same, "{name} {column} row {i}: {field}");
                if let (Values::Number(_), Field::Double(value)) = (&table.columns[c].values, field)
                {
                    assert_eq!(in_csv[c].parse::<f64>().ok(), Some(*value), "no digit is lost");
                }
            }
        }
        let pairs = file.metadata().file_metadata().key_value_metadata().expect("pairs");
        let pairs: BTreeMap<&str, &str> =
            pairs.iter().filter_map(|p| Some((p.key.as_str(), p.value.as_deref()?))).collect();
        assert_eq!(pairs["spineline.provenance"], "{\"a\": 1}");
        assert_eq!(pairs["spineline.schema_version"], "1");
        let units: BTreeMap<String, String> =
            serde_json::from_str(pairs["spineline.units"]).expect("JSON");
        assert_eq!(units.len(), table.columns.len());
    }
}

#[test]
fn the_dictionary_lists_exactly_the_columns() {
    let all = everything(&case(2));
    // Phantoms of bends have no lateral film.
    let listed = dictionary(OptionalTables { space: false, axial: false, ..OptionalTables::ALL });
    let [tables, columns, units, kinds, meanings] =
        ["table", "column", "unit", "type", "meaning"].map(|column| texts(&listed, column));
    let listed: Vec<(&str, &str)> =
        tables.iter().zip(&columns).map(|(t, c)| (t.as_str(), c.as_str())).collect();
    let there: Vec<(&str, &str)> = all
        .iter()
        .flat_map(|table| table.columns.iter().map(|c| (table.name, c.name.as_str())))
        .collect();
    assert_eq!(listed, there);
    assert_eq!(listed.iter().collect::<BTreeSet<_>>().len(), listed.len(), "a name stands twice");
    for i in 0..listed.len() {
        assert!(!meanings[i].is_empty(), "{:?}", listed[i]);
        assert_eq!(
            kinds[i] == "number" || kinds[i] == "integer",
            !units[i].is_empty(),
            "{:?}",
            listed[i]
        );
        for (unit, end) in
            [("mm", "_mm"), ("px", "_px"), ("deg", "_deg"), ("N·m/rad", "_nm_per_rad")]
        {
            assert_eq!(units[i] == unit, columns[i].ends_with(end), "{:?}", listed[i]);
        }
    }
}

#[test]
fn the_dictionary_has_every_table_column_and_warning() {
    let page = dictionary_markdown();
    for table in tables(&[]) {
        let (_, rest) = page.split_once(&format!("\n## {}\n", table.name)).expect("a section");
        let section = rest.split("\n## ").next().expect("its rows");
        for column in &table.columns {
            assert!(
                section.contains(&format!("| `{}` | {} |", column.name, column.unit)),
                "{section}"
            );
        }
    }
    for code in WarningCode::ALL {
        assert_eq!(page.matches(&format!("| `{}` |", code.key())).count(), 1, "{code:?}");
    }
}

#[test]
fn no_patients_give_empty_tables_with_every_column() {
    let none = tables(&[]);
    assert!(none.iter().all(|table| table.rows() == 0 && table.columns.len() > 2));
    assert!(!none.iter().any(|table| table.name == "uncertainty"), "not requested");
    let text = none[0].to_csv().expect("a heading");
    assert_eq!(text.lines().count(), 1);
    none[0].to_parquet(&[]).expect("a file without rows");
}

#[test]
fn commas_quotes_and_other_scripts_round_trip() {
    let odd = "脊柱,\"عمود\"\nfقري";
    let case = Case { id: odd.to_owned(), ..case(2) };
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let all = tables_of(&case, &analysis);
    let text = all[0].to_csv().expect("text");
    let mut csv = csv::Reader::from_reader(text.as_bytes());
    let row = csv.records().next().expect("a row").expect("whole");
    assert_eq!(&row[0], odd);
}
