//! One definition per table names, explains and fills every column, so that the dictionary always agrees with the tables.

use std::ops::Deref;

use spineline::analysis::Analysis;

use crate::Patient;
use crate::table::{NumberFormat, REFUSED, Series, Table, Values};

/// Ends of the names of numbers, and the units that they state.
const UNITS: [(&str, &str); 7] = [
    ("_mm", "mm"),
    ("_px", "px"),
    ("_deg", "deg"),
    ("_nm_per_rad", "N·m/rad"),
    ("_rad", "rad"),
    ("_segments", "segments"),
    ("_years", "years"),
];

/// The unit of a number without a unit.
pub(crate) const ONE: &str = "1";

/// The unit of a number whose row states it in another column.
pub(crate) const STATED: &str = "given in `unit`";

/// A text of a cell.
pub(crate) trait Text {
    fn shown(self) -> Option<String>;
}

impl Text for &str {
    fn shown(self) -> Option<String> {
        Some(self.to_owned())
    }
}

impl Text for String {
    fn shown(self) -> Option<String> {
        Some(self)
    }
}

impl<T: Text> Text for Option<T> {
    fn shown(self) -> Option<String> {
        self.and_then(Text::shown)
    }
}

/// Columns of a table whose rows are made from `R`: each call names, explains and fills the next one.
pub(crate) struct Columns<'a, R> {
    rows: &'a [R],
    all: Vec<Series>,
    /// Unit of the next numbers whose names end in no unit.
    pub unit: &'static str,
}

impl<R> Columns<'_, R> {
    fn add(
        &mut self,
        name: &str,
        unit: &'static str,
        meaning: &'static str,
        values: Values,
    ) -> &mut Series {
        let (name, format) = (name.to_owned(), NumberFormat::Shortest);
        self.all.push_mut(Series { name, unit, meaning, values, format })
    }

    /// A text.
    pub fn text<T: Text>(&mut self, name: &str, meaning: &'static str, cell: impl Fn(&R) -> T) {
        let values = self.rows.iter().map(|row| cell(row).shown()).collect();
        self.add(name, "", meaning, Values::Text(values));
    }

    /// A measured or computed number, whose name ends in its unit. A number without a finite value is empty, so that columns of numbers
    /// contain no words.
    pub fn number<T: Into<Option<f64>>>(
        &mut self,
        name: &str,
        meaning: &'static str,
        cell: impl Fn(&R) -> T,
    ) -> &mut Series {
        let finite = |row| cell(row).into().filter(|value| value.is_finite());
        let values = Values::Number(self.rows.iter().map(finite).collect());
        let stated = UNITS.iter().find(|(end, _)| name.ends_with(*end));
        let unit = stated.map_or(self.unit, |(_, unit)| *unit);
        self.add(name, unit, meaning, values)
    }

    /// The two ends of an interval.
    pub fn interval<T: Copy + Into<Option<f64>>>(
        &mut self,
        names: [&str; 2],
        meanings: [&'static str; 2],
        ends: impl Fn(&R) -> Option<[T; 2]>,
    ) {
        for (end, (name, meaning)) in names.into_iter().zip(meanings).enumerate() {
            self.number(name, meaning, |row| -> Option<f64> { ends(row)?[end].into() });
        }
    }

    /// A count.
    pub fn count<T: Into<Option<usize>>>(
        &mut self,
        name: &str,
        meaning: &'static str,
        cell: impl Fn(&R) -> T,
    ) {
        let values =
            self.rows.iter().map(|row| cell(row).into().map(|count| count as i64)).collect();
        self.add(name, ONE, meaning, Values::Count(values));
    }

    /// True or false.
    pub fn truth<T: Into<Option<bool>>>(
        &mut self,
        name: &str,
        meaning: &'static str,
        cell: impl Fn(&R) -> T,
    ) {
        let values = self.rows.iter().map(|row| cell(row).into()).collect();
        self.add(name, "", meaning, Values::Truth(values));
    }

    /// The reason why a case has no result; filled only by [`Table::refused`].
    pub fn refused(&mut self) {
        let meaning = "why the case was refused and has no result; empty for all others";
        self.text(REFUSED, meaning, |_| None::<String>);
    }
}

/// Meanings of the ends of a 95 % interval.
pub(crate) const ENDS_95: [&str; 2] =
    ["lower end of its 95 % interval", "upper end of its 95 % interval"];

/// Meaning of the columns `lengths`.
pub(crate) const LENGTHS: &str = "plane of the lengths of this film: `patient`, `detector`, `unknown`, or `pixels` without a spacing";

/// A row of a patient.
pub(crate) struct Row<'a, T> {
    pub analysis: &'a Analysis,
    pub item: T,
}

impl<T> Deref for Row<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.item
    }
}

/// Rows of patients, in their order.
pub(crate) fn rows<'a, T, I: IntoIterator<Item = T>>(
    patients: &[Patient<'a>],
    items: impl Fn(Patient<'a>) -> I,
) -> Vec<Row<'a, T>> {
    let of_patient = |&patient: &Patient<'a>| {
        let analysis = patient.analysis;
        items(patient).into_iter().map(move |item| Row { analysis, item })
    };
    patients.iter().flat_map(of_patient).collect()
}

/// A table of these rows.
pub(crate) fn table<R>(
    name: &'static str,
    row: &'static str,
    rows: &[R],
    columns: impl FnOnce(&mut Columns<'_, R>),
) -> Table {
    let mut add = Columns { rows, all: Vec::new(), unit: ONE };
    columns(&mut add);
    Table { name, row, columns: add.all }
}

/// A table of rows of patients: the columns that every one of them begins with, and these.
pub(crate) fn keyed<'a, T>(
    name: &'static str,
    row: &'static str,
    rows: &[Row<'a, T>],
    columns: impl FnOnce(&mut Columns<'_, Row<'a, T>>),
) -> Table {
    table(name, row, rows, |add| {
        add.text("case_id", "patient", |row| row.analysis.case_id.clone());
        add.truth(
            "synthetic",
            "whether the films are synthetic; then every number of the row is synthetic",
            |row| row.analysis.synthetic,
        );
        columns(add);
    })
}
