use spineline::analysis::Sex;

/// One patient of the paper's Table 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableRow {
    /// Number, from 1.
    pub number: usize,
    /// Sex.
    pub sex: Sex,
    /// Age.
    pub age_years: u32,
    /// Lenke class.
    pub lenke: &'static str,
    /// Cobb angle of the main curve.
    pub main_cobb_deg: f64,
}

/// Table 1 of [jalalian-loa].
pub const SUBJECTS: [TableRow; 18] = {
    use Sex::{Female as F, Male as M};
    const fn row(
        number: usize,
        sex: Sex,
        age_years: u32,
        lenke: &'static str,
        main_cobb_deg: f64,
    ) -> TableRow {
        TableRow { number, sex, age_years, lenke, main_cobb_deg }
    }
    [
        row(1, F, 13, "1A", 49.0),
        row(2, F, 15, "1B", 53.0),
        row(3, F, 16, "1C", 46.0),
        row(4, F, 12, "1C", 48.0),
        row(5, F, 13, "2A", 53.0),
        row(6, F, 16, "2B", 53.0),
        row(7, F, 19, "2C", 48.0),
        row(8, F, 14, "2C", 55.0),
        row(9, F, 15, "3A", 59.0),
        row(10, F, 13, "4C", 86.0),
        row(11, F, 12, "5C", 62.0),
        row(12, F, 14, "6C", 59.0),
        row(13, M, 14, "2A", 59.0),
        row(14, M, 19, "2B", 48.0),
        row(15, M, 18, "2B", 61.0),
        row(16, M, 18, "3B", 46.0),
        row(17, M, 14, "3C", 53.0),
        row(18, M, 19, "3C", 70.0),
    ]
};

impl TableRow {
    /// Cobb angles of the thoracolumbar/lumbar, main thoracic and proximal thoracic curve, in degrees.
    ///
    /// The ratios of minor to major curves follow upright films of surgical patients (proximal 0.48, lumbar 0.68 of the
    /// main thoracic curve [bekki-2018]) and the definition of structural curves in each Lenke type; they are
    /// assumptions.
    #[must_use]
    pub fn cobb_deg(&self) -> [f64; 3] {
        let of_main = match self.lenke.as_bytes()[0] {
            b'1' => [0.58, 1.0, 0.42],
            b'2' => [0.58, 1.0, 0.62],
            b'3' => [0.75, 1.0, 0.44],
            b'4' => [0.66, 1.0, 0.55],
            b'5' => [1.0, 0.68, 0.32],
            _ => [1.0, 0.90, 0.42],
        };
        of_main.map(|ratio| ratio * self.main_cobb_deg)
    }
}
