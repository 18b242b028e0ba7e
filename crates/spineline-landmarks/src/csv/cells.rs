//! Cells of a table, and their numbers.

use csv::ByteRecord;
use spineline_files::is_no_number;

use crate::names::{coordinate, shown};
use crate::{ColumnHint, LandmarkError};

/// The decimal mark of a table and the cell that shows it; unknown until the first cell with a mark.
pub(super) struct DecimalMark(Option<(char, String)>);

impl DecimalMark {
    /// Beside commas the mark is a point.
    pub fn beside(separator: u8) -> Self {
        Self((separator == b',').then(|| ('.', "a table with commas between its cells".to_owned())))
    }

    /// The number of a cell with this mark.
    pub fn number(
        &mut self,
        row: Cells<'_>,
        column: usize,
        name: &str,
    ) -> Result<f64, LandmarkError> {
        let cell = row.text(column, name)?;
        let at = row.cell_place(name);
        for mark in ['.', ','].into_iter().filter(|mark| cell.contains(*mark)) {
            let own = || format!("`{}` on {}", shown(cell), row.row_place());
            let (first, of) = self.0.get_or_insert_with(|| (mark, own()));
            if *first != mark {
                let name = |mark| if mark == ',' { "comma" } else { "point" };
                return Err(LandmarkError::Ambiguous {
                    at,
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
            at: at.clone(),
            value: shown(cell),
            expected: "a number",
        })?;
        coordinate(value, &at)
    }
}

/// The cells of a row, with the line of the row.
#[derive(Clone, Copy)]
pub(super) struct Cells<'a> {
    pub record: &'a ByteRecord,
    pub line: u64,
    pub hint: &'a ColumnHint,
}

impl<'a> Cells<'a> {
    /// Where the row is.
    pub fn row_place(self) -> String {
        self.hint.line_place(self.line)
    }

    /// Where a cell is.
    pub fn cell_place(self, name: &str) -> String {
        format!("{}, column `{name}`", self.row_place())
    }

    /// The text of a cell.
    pub fn text(self, column: usize, name: &str) -> Result<&'a str, LandmarkError> {
        std::str::from_utf8(&self.record[column])
            .map_err(|_| LandmarkError::Encoding { at: self.cell_place(name) })
    }

    /// The beginning of a cell for display, whether it is UTF-8 or not.
    pub fn shown(self, column: usize) -> String {
        shown(&String::from_utf8_lossy(&self.record[column]))
    }

    /// Whether a cell is empty or marks a missing number.
    pub fn is_blank(self, column: usize) -> bool {
        std::str::from_utf8(&self.record[column]).is_ok_and(is_no_number)
    }
}
