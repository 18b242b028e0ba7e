//! One definition per table names, explains and fills every column, so that the dictionary always agrees with the tables.

use spineline::analysis::Analysis;

use crate::Patient;
use crate::table::{NumberFormat, REFUSED, Series, Table, Values};

/// Unit of a number; its name ends the name of the column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unit {
    Millimetres,
    Pixels,
    Degrees,
    Radians,
    NewtonMetresPerRadian,
    Segments,
    Years,
    /// Newtons where a force is known.
    Force,
    /// A number without a unit.
    One,
    /// Given in another column of the same row.
    Stated,
}

impl Unit {
    const fn suffix(self) -> &'static str {
        match self {
            Self::Millimetres => "_mm",
            Self::Pixels => "_px",
            Self::Degrees => "_deg",
            Self::Radians => "_rad",
            Self::NewtonMetresPerRadian => "_nm_per_rad",
            Self::Segments => "_segments",
            Self::Years => "_years",
            Self::Force | Self::One | Self::Stated => "",
        }
    }

    const fn words(self) -> &'static str {
        match self {
            Self::Millimetres => "mm",
            Self::Pixels => "px",
            Self::Degrees => "deg",
            Self::Radians => "rad",
            Self::NewtonMetresPerRadian => "N·m/rad",
            Self::Segments => "segments",
            Self::Years => "years",
            Self::Force => "N where `absolute`, else relative",
            Self::One => "1",
            Self::Stated => "given in `unit`",
        }
    }
}

/// Function from a row to the value of a column.
enum Cell<R> {
    Text(fn(&R) -> Option<String>),
    Number(fn(&R) -> Option<f64>),
    Element(fn(&R, usize) -> Option<f64>, usize),
    Count(fn(&R) -> Option<i64>),
    Truth(fn(&R) -> Option<bool>),
}

/// A column of a table whose rows are made from `R`.
pub(crate) struct Column<R> {
    name: String,
    unit: &'static str,
    meaning: &'static str,
    cell: Cell<R>,
    format: NumberFormat,
}

impl<R> Column<R> {
    fn new(name: String, unit: &'static str, meaning: &'static str, cell: Cell<R>) -> Self {
        Self { name, unit, meaning, cell, format: NumberFormat::Shortest }
    }
}

/// A text.
pub(crate) fn text<R>(
    name: &str,
    meaning: &'static str,
    cell: fn(&R) -> Option<String>,
) -> Column<R> {
    Column::new(name.to_owned(), "", meaning, Cell::Text(cell))
}

/// A measured or computed number; the unit is added to the name.
pub(crate) fn number<R>(
    name: &str,
    unit: Unit,
    meaning: &'static str,
    cell: fn(&R) -> Option<f64>,
) -> Column<R> {
    Column::new(format!("{name}{}", unit.suffix()), unit.words(), meaning, Cell::Number(cell))
}

/// A number at one index of a list, for columns that are named after the elements of the list.
pub(crate) fn element<R>(
    name: &str,
    unit: Unit,
    meaning: &'static str,
    index: usize,
    cell: fn(&R, usize) -> Option<f64>,
) -> Column<R> {
    let name = format!("{name}{}", unit.suffix());
    Column::new(name, unit.words(), meaning, Cell::Element(cell, index))
}

/// A number with this number of decimal places.
pub(crate) fn places<R>(
    name: &str,
    unit: Unit,
    meaning: &'static str,
    places: usize,
    cell: fn(&R) -> Option<f64>,
) -> Column<R> {
    written(NumberFormat::Places(places), number(name, unit, meaning, cell))
}

/// The column with its numbers written in this format.
pub(crate) fn written<R>(format: NumberFormat, column: Column<R>) -> Column<R> {
    Column { format, ..column }
}

/// A count.
pub(crate) fn count<R>(
    name: &str,
    meaning: &'static str,
    cell: fn(&R) -> Option<i64>,
) -> Column<R> {
    Column::new(name.to_owned(), "1", meaning, Cell::Count(cell))
}

/// True or false.
pub(crate) fn truth<R>(
    name: &str,
    meaning: &'static str,
    cell: fn(&R) -> Option<bool>,
) -> Column<R> {
    Column::new(name.to_owned(), "", meaning, Cell::Truth(cell))
}

/// Meaning of the columns `lengths`.
pub(crate) const LENGTHS: &str = "plane of the lengths of this film: `patient`, `detector`, `unknown`, or `pixels` without a spacing";

/// A row of a patient.
pub(crate) struct Row<'a, T> {
    pub analysis: &'a Analysis,
    pub item: T,
}

impl<'a> Patient<'a> {
    pub(crate) fn row<T>(&self, item: T) -> Row<'a, T> {
        Row { analysis: self.analysis, item }
    }
}

/// The columns that every table begins with.
fn keys<'a, T>() -> Vec<Column<Row<'a, T>>> {
    vec![
        text("case_id", "patient", |row| Some(row.analysis.case_id.clone())),
        truth(
            "synthetic",
            "whether the films are synthetic; then every number of the row is synthetic",
            |row| Some(row.analysis.synthetic),
        ),
    ]
}

/// The reason why a case has no result; filled only by [`Table::refused`].
pub(crate) fn refused<R>() -> Column<R> {
    text(REFUSED, "why the case was refused and has no result; empty for all others", |_| None)
}

/// The columns with these names, in the order of the names.
pub(crate) fn chosen<R>(mut columns: Vec<Column<R>>, names: &[&str]) -> Vec<Column<R>> {
    let take = |name: &&str| {
        let place = columns.iter().position(|column| column.name == *name)?;
        Some(columns.swap_remove(place))
    };
    names.iter().filter_map(take).collect()
}

/// A table before it has rows.
pub(crate) struct Definition<R> {
    pub name: &'static str,
    /// Meaning of one row.
    pub row: &'static str,
    pub columns: Vec<Column<R>>,
}

/// A table with these groups of columns.
pub(crate) fn grouped<R, const N: usize>(
    name: &'static str,
    row: &'static str,
    groups: [Vec<Column<R>>; N],
) -> Definition<R> {
    Definition { name, row, columns: groups.into_iter().flatten().collect() }
}

/// A table of rows of patients: the columns that every one of them begins with, and these groups.
pub(crate) fn keyed<'a, T, const N: usize>(
    name: &'static str,
    row: &'static str,
    groups: [Vec<Column<Row<'a, T>>>; N],
) -> Definition<Row<'a, T>> {
    let mut columns = keys();
    columns.extend(groups.into_iter().flatten());
    Definition { name, row, columns }
}

impl<R> Definition<R> {
    /// The table of these rows.
    pub fn fill(self, rows: &[R]) -> Table {
        let columns = self.columns.into_iter().map(|column| Series {
            name: column.name,
            unit: column.unit,
            meaning: column.meaning,
            format: column.format,
            values: match column.cell {
                Cell::Text(cell) => Values::Text(rows.iter().map(cell).collect()),
                Cell::Number(cell) => Values::Number(rows.iter().map(cell).map(finite).collect()),
                Cell::Element(cell, index) => {
                    Values::Number(rows.iter().map(|row| finite(cell(row, index))).collect())
                }
                Cell::Count(cell) => Values::Count(rows.iter().map(cell).collect()),
                Cell::Truth(cell) => Values::Truth(rows.iter().map(cell).collect()),
            },
        });
        Table { name: self.name, row: self.row, columns: columns.collect() }
    }
}

/// A number without a value is empty, so that columns of numbers contain no words.
fn finite(value: Option<f64>) -> Option<f64> {
    value.filter(|value| value.is_finite())
}
