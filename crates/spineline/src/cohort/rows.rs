//! Numbers of every patient that a cohort sets aside until all patients were seen.

/// Rows of numbers that a cohort sets aside, one row per patient; they need not be in memory.
pub trait CohortRows<Error> {
    /// Sets a row aside.
    ///
    /// # Errors
    /// If there is no room for it.
    fn add(&mut self, row: &[f64]) -> Result<(), Error>;

    /// Shows all rows of so many numbers again, in the order in which they were added and to the bit.
    ///
    /// # Errors
    /// If they cannot be read again.
    fn each(&mut self, numbers: usize, take: &mut dyn FnMut(&[f64])) -> Result<(), Error>;
}

/// Rows in memory.
#[derive(Debug, Clone, Default)]
pub struct RowsInMemory(Vec<f64>);

impl<Error> CohortRows<Error> for RowsInMemory {
    fn add(&mut self, row: &[f64]) -> Result<(), Error> {
        self.0.extend_from_slice(row);
        Ok(())
    }

    fn each(&mut self, numbers: usize, take: &mut dyn FnMut(&[f64])) -> Result<(), Error> {
        // Rows without numbers are no rows.
        self.0.chunks_exact(numbers.max(1)).for_each(take);
        Ok(())
    }
}
