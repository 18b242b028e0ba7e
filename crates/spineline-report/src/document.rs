//! A report without format: texts, notices, tables and figures in their order.
//!
//! All text is plain, without markup; every writer escapes it.

use serde::Serialize;
use spineline::warning::{Severity, Warning};

/// A whole report.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// Kind of report.
    pub title: String,
    /// Subject: the case's identifier, or the size of the cohort.
    pub subject: String,
    /// Program that made it.
    pub generator: String,
    /// Notices before all sections.
    pub banners: Vec<Notice>,
    /// The report.
    pub sections: Vec<Section>,
    /// The analysis behind it as JSON, which every writer embeds: one object, or an array for a cohort.
    pub analysis: String,
}

/// A part of a report.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "api", derive(utoipa::ToSchema), schema(as = SectionView))]
pub struct Section {
    /// Name for links, equal in every report.
    pub id: &'static str,
    /// Its heading.
    pub title: String,
    /// Content.
    pub blocks: Vec<Block>,
}

/// A block of a section.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", content = "of", rename_all = "snake_case")]
#[cfg_attr(feature = "api", derive(utoipa::ToSchema), schema(as = BlockView))]
pub enum Block {
    /// A heading within the section.
    Heading(String),
    /// Running text.
    Paragraph(String),
    /// A notice.
    Notice(Notice),
    /// Rows and columns.
    Table(Table),
    /// A picture.
    Figure(Box<Figure>),
}

spineline::named! {
    /// Severity of a notice.
    pub enum NoticeKind {
        /// What applies to the whole report: synthetic data, or no medical device.
        Banner = "banner",
        /// The data contradict the model, or a number is not a result.
        Contradiction = "contradiction",
        /// A value is doubtful.
        Warning = "warning",
        /// Information.
        Note = "note",
    }
}

impl NoticeKind {
    /// The word in front of a notice.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Banner => "Read first",
            Self::Contradiction => "Contradiction",
            Self::Warning => "Warning",
            Self::Note => "Note",
        }
    }
}

#[cfg(feature = "api")]
impl utoipa::PartialSchema for NoticeKind {
    fn schema() -> utoipa::openapi::RefOr<utoipa::openapi::Schema> {
        utoipa::openapi::ObjectBuilder::new()
            .schema_type(utoipa::openapi::Type::String)
            .description(Some(<Self as spineline::anatomy::Named>::description()))
            .enum_values(Some(Self::ALL.map(Self::key)))
            .into()
    }
}

#[cfg(feature = "api")]
impl utoipa::ToSchema for NoticeKind {
    fn name() -> std::borrow::Cow<'static, str> {
        "ReportNoticeKind".into()
    }
}

impl From<Severity> for NoticeKind {
    fn from(severity: Severity) -> Self {
        match severity {
            Severity::Contradiction => Self::Contradiction,
            Severity::Warning => Self::Warning,
            Severity::Note => Self::Note,
        }
    }
}

/// A notice.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "api", derive(utoipa::ToSchema), schema(as = ReportNotice))]
pub struct Notice {
    /// Severity.
    pub kind: NoticeKind,
    /// Subject, such as `left bending film, T9`; may be empty.
    pub place: String,
    /// What happened, and what to do.
    pub text: String,
    /// Its stable name; may be empty.
    pub code: String,
}

impl Notice {
    /// A notice about the whole report.
    #[must_use]
    pub fn new(kind: NoticeKind, text: impl Into<String>) -> Self {
        Self { kind, place: String::new(), text: text.into(), code: String::new() }
    }
}

impl From<&Warning> for Notice {
    fn from(warning: &Warning) -> Self {
        let posture = warning.posture.map(|posture| format!("{posture} film"));
        let level = warning.level.map(|level| level.to_string());
        Self {
            kind: warning.code.severity().into(),
            place: posture.into_iter().chain(level).collect::<Vec<_>>().join(", "),
            text: warning.text(),
            code: warning.code.key().to_owned(),
        }
    }
}

/// One column of a table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "api", derive(utoipa::ToSchema), schema(as = ColumnView))]
pub struct Column {
    /// Its head, with the unit where it has one.
    pub head: String,
    /// Whether it contains numbers, which are aligned right.
    pub numeric: bool,
}

impl Column {
    /// A column of words.
    #[must_use]
    pub fn words(head: impl Into<String>) -> Self {
        Self { head: head.into(), numeric: false }
    }

    /// A column of numbers.
    #[must_use]
    pub fn numbers(head: impl Into<String>) -> Self {
        Self { head: head.into(), numeric: true }
    }
}

/// Rows and columns.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "api", derive(utoipa::ToSchema), schema(as = TableView))]
pub struct Table {
    /// What it shows.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows, each with one cell per column.
    pub rows: Vec<Vec<String>>,
    /// Note on the table; may be empty.
    pub note: String,
}

impl Table {
    /// A table without rows. Use it where rows come from several sources, or where one step makes several cells.
    #[must_use]
    pub fn new(caption: impl Into<String>, columns: Vec<Column>) -> Self {
        Self { caption: caption.into(), columns, rows: Vec::new(), note: String::new() }
    }

    /// A table with one row per item. `columns` adds the columns, one per call. Use it where a cell needs only its item; else use [`Table::new`].
    #[must_use]
    pub fn of<R>(
        caption: impl Into<String>,
        items: impl IntoIterator<Item = R>,
        columns: impl FnOnce(&mut RowColumns<R>),
    ) -> Self {
        let items: Vec<R> = items.into_iter().collect();
        let table = Self { rows: vec![Vec::new(); items.len()], ..Self::new(caption, Vec::new()) };
        let mut add = RowColumns { items, table };
        columns(&mut add);
        add.table
    }

    /// Adds a row.
    ///
    /// # Panics
    /// Without one cell per column.
    pub fn row(&mut self, cells: Vec<String>) {
        assert_eq!(cells.len(), self.columns.len(), "one cell per column of {}", self.caption);
        self.rows.push(cells);
    }
}

/// Columns of [`Table::of`]: each call heads and fills the next one.
pub struct RowColumns<R> {
    items: Vec<R>,
    table: Table,
}

impl<R> RowColumns<R> {
    fn add<C: Into<String>>(&mut self, column: Column, cell: impl Fn(&R) -> C) {
        self.table.columns.push(column);
        for (row, item) in self.table.rows.iter_mut().zip(&self.items) {
            row.push(cell(item).into());
        }
    }

    /// A column of words.
    pub fn words<C: Into<String>>(&mut self, head: impl Into<String>, cell: impl Fn(&R) -> C) {
        self.add(Column::words(head), cell);
    }

    /// A column of numbers.
    pub fn numbers<C: Into<String>>(&mut self, head: impl Into<String>, cell: impl Fn(&R) -> C) {
        self.add(Column::numbers(head), cell);
    }
}

/// A picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "api", derive(utoipa::ToSchema), schema(as = FigureView))]
pub struct Figure {
    /// Name of its file without ending, the same in every report of its kind.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// The picture as SVG text.
    pub svg: String,
    /// The same in 3D, for writers with rotatable views.
    #[serde(skip)]
    pub space: Option<Space>,
    /// Whether it may fill a whole page; two other figures fit on a page.
    #[serde(skip)]
    pub whole_page: bool,
}

impl Figure {
    /// The same, as large as a page.
    #[must_use]
    pub fn on_whole_page(self) -> Self {
        Self { whole_page: true, ..self }
    }

    /// A flat picture.
    #[must_use]
    pub fn new(name: impl Into<String>, caption: impl Into<String>, svg: String) -> Self {
        Self { name: name.into(), caption: caption.into(), svg, space: None, whole_page: false }
    }
}

/// Lines in space: in mm, `x` to the front, `y` to the patient's left, `z` up.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Space {
    /// What can be shown and hidden.
    pub layers: Vec<SpaceLayer>,
}

/// Lines in space that belong together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpaceLayer {
    /// What they are.
    pub name: String,
    /// Their colour, as in the flat figure.
    pub colour: &'static str,
    /// SVG dash array; empty for solid lines.
    pub dash: &'static str,
    /// Whether they are shown at first.
    pub shown: bool,
    /// Polygons through points.
    pub lines: Vec<Vec<[f64; 3]>>,
}

impl Section {
    /// A section without content.
    #[must_use]
    pub fn new(id: &'static str, title: impl Into<String>) -> Self {
        Self { id, title: title.into(), blocks: Vec::new() }
    }

    /// Adds running text, unless it is empty.
    pub fn paragraph(&mut self, text: impl Into<String>) {
        let text = text.into();
        if !text.is_empty() {
            self.blocks.push(Block::Paragraph(text));
        }
    }

    /// Adds a heading.
    pub fn heading(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Heading(text.into()));
    }

    /// Adds a notice.
    pub fn notice(&mut self, notice: Notice) {
        self.blocks.push(Block::Notice(notice));
    }

    /// Adds a table, unless it has no rows.
    pub fn table(&mut self, table: Table) {
        if !table.rows.is_empty() {
            self.blocks.push(Block::Table(table));
        }
    }

    /// Adds a figure.
    pub fn figure(&mut self, figure: Figure) {
        self.blocks.push(Block::Figure(Box::new(figure)));
    }
}

impl Document {
    /// A report without notices before its sections and without an embedded analysis.
    #[must_use]
    pub fn new(
        title: impl Into<String>,
        subject: impl Into<String>,
        generator: impl Into<String>,
        sections: Vec<Section>,
    ) -> Self {
        Self {
            title: title.into(),
            subject: subject.into(),
            generator: generator.into(),
            banners: Vec::new(),
            sections,
            analysis: String::new(),
        }
    }

    /// All figures in their order.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        self.sections.iter().flat_map(|section| &section.blocks).filter_map(|block| match block {
            Block::Figure(figure) => Some(&**figure),
            _ => None,
        })
    }
}

/// A file name from any text: characters other than ASCII letters, digits, `-`, `_` and inner dots become `_`. A changed name
/// also gets eight digits of a hash, so that different texts keep different names.
#[must_use]
pub fn file_stem(text: &str) -> String {
    const MAX_LENGTH: usize = 80;
    let mut plain: String = text
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' })
        .take(MAX_LENGTH)
        .collect();
    if plain.starts_with('.') || plain.is_empty() {
        plain.insert(0, '_');
    }
    if plain == text {
        return plain;
    }
    // FNV-1a, the same on every machine.
    let hash = text
        .bytes()
        .fold(0x811c_9dc5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    format!("{plain}-{hash:08x}")
}

#[cfg(test)]
mod tests {
    use super::file_stem;

    #[test]
    fn file_names_are_plain_and_unique() {
        assert_eq!(file_stem("phantom-rod-01"), "phantom-rod-01");
        for hostile in ["../../etc/passwd", "病例一", "病例二", "<script>", "", ".", "a/b", "a\\b"]
        {
            let name = file_stem(hostile);
            assert!(name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c)), "{name}");
            assert!(!name.starts_with('.'), "{name}");
        }
        assert_ne!(file_stem("病例一"), file_stem("病例二"));
        assert!(file_stem(&"x".repeat(500)).len() < 100);
    }
}
