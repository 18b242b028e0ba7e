//! Tables of readings: valid ones are read, and errors name the line.

use spineline::reliability::{StatisticKind, Undefined, assess};
use spineline_files::{FileError, parse_readings};

const HEADING: &str = "quantity,unit,subject,observer,repeat,value\n";

fn table(rows: &str) -> Result<spineline_files::ReadingsTable, FileError> {
    parse_readings(&format!("{HEADING}{rows}"))
}

#[test]
fn byte_order_marks_line_ends_and_any_order_of_columns_are_read() {
    let plain = table("a,mm,1,A,1,2.5\na,mm,1,B,1,3\na,mm,2,A,1,4\na,mm,2,B,1,4.5\n");
    let plain = plain.expect("a table");
    let odd = "\u{feff}value,subject,repeat,observer,unit,quantity\r\n2.5,1,1,A,mm,a\r\n3,1,1,B,mm,a\r\n4,2,1,A,mm,a\r\n4.5,2,1,B,mm,a\r\n";
    assert_eq!(parse_readings(odd).expect("a table"), plain);
    assert!(!plain.synthetic);
    let made_up = "quantity,unit,subject,observer,repeat,value,synthetic\na,mm,1,A,1,2.5,true\n";
    assert!(parse_readings(made_up).expect("a table").synthetic);
    let found = assess(&plain.quantities[0]);
    // Row means 2.75 and 4.25, differences 0.5 both: no scatter is left beside the offset.
    let icc = found.designs[0].statistic(StatisticKind::IccConsistency);
    assert_eq!(icc.map(|estimate| estimate.value), Ok(1.0));
    assert_eq!(found.designs[1].statistic(StatisticKind::Pearson), Err(Undefined::OneRepeat));
}

#[test]
fn every_error_of_a_row_names_its_line() {
    let good = "a,mm,1,A,1,2.5\n";
    for (row, words) in [
        ("a,mm,1,B,1,1e999\n", "`value` is"),
        ("a,mm,1,B,1,\"2,5\"\n", "`value` is `2,5`, which is not a number"),
        ("a,mm,1,B,0,2.5\n", "whole number from 1"),
        ("a,mm,1,B,-1,2.5\n", "whole number from 1"),
        ("a,mm,,B,1,2.5\n", "`subject` is empty"),
        ("a,mm,1,=cmd|x,1,2.5\n", "formula"),
        ("a,mm,1,Dr. Smith,1,2.5\n", "`observer` is `Dr. Smith`, and must be 1 to 64 letters"),
        ("a,mm,Jane Doe,B,1,2.5\n", "`subject` is `Jane Doe`, and must be 1 to 64 letters"),
        ("a,mm,1,B,1,-inf\n", "`value` is `-inf`, which is not a number"),
        ("a,deg,1,B,1,2.5\n", "`a` is in deg, but in mm above"),
        ("a,mm,1,A,1,7\n", "is given twice"),
        ("a,mm,1,B,1\n", "5 cells, but the heading has 6"),
    ] {
        let text = format!("{HEADING}{good}{row}");
        for text in [text.replace('\n', "\r\n"), text] {
            let error = parse_readings(&text).expect_err(words).to_string();
            assert!(error.starts_with("line 3: ") && error.contains(words), "{error}");
        }
    }
    assert!(table("").expect_err("nothing").to_string().contains("no reading"));
    let named = table("a,mm,Jane Doe,B,1,2.5\n").expect_err("a name");
    assert!(named.help().contains("a code such as A, and no name of a person"));
}

#[test]
fn tables_of_spreadsheets_are_read_as_plain_ones() {
    let plain = table("a,mm,1,A,1,2.5\na,mm,1,B,1,3\na,mm,2,A,1,4\na,mm,2,B,1,4.5\n");
    let plain = plain.expect("a table");
    for (text, what) in [
        (
            "sep=;\r\nQuantity;Unit;Subject;Observer;Repeat;Value\r\na;mm;1;A;1;2,5\r\na;mm;1;B;1,0;3\r\na;mm;2;A;1;4\r\na;mm;2;B;1;4,5\r\n",
            "a stated separator, capitals, decimal commas",
        ),
        (
            "quantity\tunit\tsubject\tobserver\trepeat\tvalue\t\na\tmm\t1\tA\t1\t2.5\t\na\tmm\t1\tB\t1\t3\t\na\tmm\t2\tA\t1\t4\t\na\tmm\t2\tB\t1\t4.5\t\n",
            "tabs, an empty column",
        ),
        (
            "quantity,unit,subject,observer,repeat,value\na,mm,1,A,1.0,2.5\na,mm,1,B,1.0,3\na,mm,2,A,1.0,4\na,mm,2,B,1.0,4.5\na,mm,3,A,1,NA\na,mm,3,B,1,\na,mm,4,A,1,NaN\n,,,,,\n",
            "repeats with decimals, subjects without a value, an empty row",
        ),
    ] {
        assert_eq!(parse_readings(text).expect(what), plain, "{what}");
    }
}

#[test]
fn unknown_repeated_and_missing_columns_are_refused() {
    for (heading, words) in [
        ("quantity,unit,subject,observer,repeat,values", "did you mean `value`?"),
        ("quantity;unit;subject;observer;repeat;wert", "unknown column `wert`"),
        ("quantity,unit,subject,observer,repeat", "column `value` is missing"),
        ("quantity,unit,subject,observer,repeat,value,value", "twice"),
        ("", "column `quantity` is missing"),
    ] {
        let error = parse_readings(&format!("{heading}\n")).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
}
