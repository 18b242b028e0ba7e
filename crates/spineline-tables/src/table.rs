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
}

/// A column with its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name, which ends in the unit where there is one.
    pub name: String,
    /// Unit; empty where the values are no numbers.
    pub unit: &'static str,
    /// Meaning.
    pub meaning: &'static str,
    /// One per row; `None` where there is none.
    pub values: Values,
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

    /// Whether there are no values.
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

    /// One value as text, with every digit that is needed to read the same number back; empty where there is none.
    #[must_use]
    pub fn shown(&self, row: usize) -> String {
        fn of<T: ToString>(value: &Option<T>) -> String {
            value.as_ref().map_or_else(String::new, T::to_string)
        }
        match self {
            Self::Text(all) => of(&all[row]),
            Self::Number(all) => of(&all[row]),
            Self::Count(all) => of(&all[row]),
            Self::Truth(all) => of(&all[row]),
        }
    }
}
