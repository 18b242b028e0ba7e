use spineline::cohort::RefusedCase;

use crate::error::TableError;

/// Name of the column with the reason why a case has no result.
pub(crate) const REFUSED: &str = "refused";

/// A table: columns of the same length.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name, which is the name of its file.
    pub name: &'static str,
    /// Meaning of one row.
    pub row: &'static str,
    /// Columns, the keys first.
    pub columns: Vec<Series>,
}

impl Table {
    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Removes all rows.
    pub fn clear(&mut self) {
        for column in &mut self.columns {
            column.values.clear();
        }
    }

    /// Adds a row for a case without a result: its identifier or file, and why it was refused; all else is empty.
    #[must_use]
    pub fn refused(mut self, case: &RefusedCase) -> Self {
        for column in &mut self.columns {
            let text = match column.name.as_str() {
                "case_id" => Some(case.name().to_owned()),
                REFUSED => Some(format!("{}: {}", case.step, case.reason)),
                _ => None,
            };
            column.values.push_text(text);
        }
        self
    }

    /// Adds the rows of the same table for other patients.
    ///
    /// # Errors
    /// [`TableError::Columns`] if it is another table.
    pub fn append(&mut self, other: Self) -> Result<(), TableError> {
        let same = |(own, other): (&Series, &Series)| {
            own.name == other.name && own.values.kind() == other.values.kind()
        };
        let is_same = self.columns.len() == other.columns.len()
            && self.columns.iter().zip(&other.columns).all(same);
        if !is_same {
            return Err(TableError::Columns { table: self.name });
        }
        for (column, more) in self.columns.iter_mut().zip(other.columns) {
            column.values.append(more.values);
        }
        Ok(())
    }
}

/// A column with its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name, which ends in the unit if it has one.
    pub name: String,
    /// Unit; empty where the values are not numbers.
    pub unit: &'static str,
    /// Meaning.
    pub meaning: &'static str,
    /// One per row; `None` without a value.
    pub values: Values,
    /// How its numbers are written as text.
    pub format: NumberFormat,
}

impl Series {
    /// One value as text; empty without a value.
    #[must_use]
    pub fn shown(&self, row: usize) -> String {
        match &self.values {
            Values::Text(all) => all[row].clone(),
            Values::Number(all) => all[row].map(|number| self.format.shown(number)),
            Values::Count(all) => all[row].map(|count| count.to_string()),
            Values::Truth(all) => all[row].map(|truth| truth.to_string()),
        }
        .unwrap_or_default()
    }
}

/// How a number is written as text. Parquet holds the number itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberFormat {
    /// With every digit that is needed to read the same number back.
    Shortest,
    /// The same, with `.0` after a whole number and an exponent where a number is very small or very large.
    ShortestDecimal,
    /// The same, always with an exponent.
    ShortestScientific,
    /// With this number of decimal places.
    Places(usize),
    /// With an exponent and this number of decimal places.
    Scientific(usize),
}

impl NumberFormat {
    fn shown(self, number: f64) -> String {
        match self {
            Self::Shortest => number.to_string(),
            Self::ShortestDecimal => ryu::Buffer::new().format(number).to_owned(),
            Self::ShortestScientific => format!("{number:e}"),
            Self::Places(places) => format!("{number:.places$}"),
            Self::Scientific(places) => format!("{number:.places$e}"),
        }
    }
}

/// Values of one kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Texts.
    Text(Vec<Option<String>>),
    /// Numbers, which are finite.
    Number(Vec<Option<f64>>),
    /// Whole numbers.
    Count(Vec<Option<i64>>),
    /// True or false.
    Truth(Vec<Option<bool>>),
}

impl Values {
    /// Adds a text to texts, and an empty value to all others.
    fn push_text(&mut self, text: Option<String>) {
        match self {
            Self::Text(all) => all.push(text),
            Self::Number(all) => all.push(None),
            Self::Count(all) => all.push(None),
            Self::Truth(all) => all.push(None),
        }
    }

    fn clear(&mut self) {
        match self {
            Self::Text(all) => all.clear(),
            Self::Number(all) => all.clear(),
            Self::Count(all) => all.clear(),
            Self::Truth(all) => all.clear(),
        }
    }

    fn append(&mut self, other: Self) {
        match (self, other) {
            (Self::Text(all), Self::Text(more)) => all.extend(more),
            (Self::Number(all), Self::Number(more)) => all.extend(more),
            (Self::Count(all), Self::Count(more)) => all.extend(more),
            (Self::Truth(all), Self::Truth(more)) => all.extend(more),
            // Columns of another kind belong to another table.
            _ => {}
        }
    }

    /// Number of values.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Text(all) => all.len(),
            Self::Number(all) => all.len(),
            Self::Count(all) => all.len(),
            Self::Truth(all) => all.len(),
        }
    }

    /// Whether it lacks values.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The name of their kind in the dictionary.
    #[must_use]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Text(_) => "text",
            Self::Number(_) => "number",
            Self::Count(_) => "integer",
            Self::Truth(_) => "boolean",
        }
    }
}
