//! Cells of a table, and their numbers.

use csv::ByteRecord;
use spineline_files::is_no_number;

use crate::LandmarkError;
use crate::names::{coordinate, shown};

/// The decimal mark of a table and the cell that shows it; unknown until the first cell with a mark.
pub(super) struct DecimalMark(Option<(char, String)>);

impl DecimalMark {
    /// Beside commas the mark is a point.
    pub fn beside(separator: u8) -> Self {
        Self((separator == b',').then(|| ('.', "a table with commas between its cells".to_owned())))
    }

    /// A number with this mark.
    pub fn number(&mut self, cell: &str, line: u64, at: &str) -> Result<f64, LandmarkError> {
        for mark in ['.', ','].into_iter().filter(|mark| cell.contains(*mark)) {
            let own = || format!("`{}` on line {line}", shown(cell));
            let (first, of) = self.0.get_or_insert_with(|| (mark, own()));
            if *first != mark {
                let name = |mark| if mark == ',' { "comma" } else { "point" };
                return Err(LandmarkError::Ambiguous {
                    at: at.to_owned(),
                    reason: format!(
                        "`{}` has a decimal {}, and {of} a decimal {}",
                        shown(cell),
                        name(mark),
                        name(*first)
                    ),
                    help: "write all numbers with one decimal mark, without separators of thousands",
                });
            }
        }
        let value = cell.replacen(',', ".", 1).parse().map_err(|_| LandmarkError::Value {
            at: at.to_owned(),
            value: shown(cell),
            expected: "a number",
        })?;
        coordinate(value, at)
    }
}

/// The text of a cell.
pub(super) fn text<'a>(
    record: &'a ByteRecord,
    column: usize,
    line: u64,
    name: &str,
) -> Result<&'a str, LandmarkError> {
    std::str::from_utf8(&record[column]).map_err(|_| LandmarkError::Value {
        at: place(line, name),
        value: shown(&String::from_utf8_lossy(&record[column])),
        expected: "text in UTF-8",
    })
}

/// Whether a cell is empty or marks a missing number.
pub(super) fn is_blank(record: &ByteRecord, column: usize) -> bool {
    std::str::from_utf8(&record[column]).is_ok_and(is_no_number)
}

/// Where a cell is.
pub(super) fn place(line: u64, column: &str) -> String {
    format!("line {line}, column `{column}`")
}
