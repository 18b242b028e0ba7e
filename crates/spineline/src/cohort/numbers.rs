//! Lists of numbers in one row.

/// Lists of numbers by key, one after the other in one row, so that a patient takes few pieces of memory.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Numbers<Key> {
    /// Keys with the ends of their lists.
    ends: Vec<(Key, u32)>,
    row: Vec<f64>,
}

impl<Key: PartialEq> Numbers<Key> {
    /// Without spare room.
    pub fn of<'a>(lists: impl IntoIterator<Item = (Key, &'a [f64])>) -> Self {
        let (mut ends, mut row) = (Vec::new(), Vec::new());
        for (key, list) in lists {
            row.extend_from_slice(list);
            ends.push((key, row.len() as u32));
        }
        ends.shrink_to_fit();
        row.shrink_to_fit();
        Self { ends, row }
    }

    /// The list of a key; `None` where the key has none.
    pub fn get(&self, key: &Key) -> Option<&[f64]> {
        let place = self.ends.iter().position(|(own, _)| own == key)?;
        let first = place.checked_sub(1).map_or(0, |before| self.ends[before].1);
        Some(&self.row[first as usize..self.ends[place].1 as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_has_its_own_list() {
        let numbers = Numbers::of([('a', &[1.0, 2.0][..]), ('b', &[]), ('c', &[3.0])]);
        assert_eq!(numbers.get(&'a'), Some(&[1.0, 2.0][..]));
        assert_eq!(numbers.get(&'b'), Some(&[][..]));
        assert_eq!(numbers.get(&'c'), Some(&[3.0][..]));
        assert_eq!(numbers.get(&'d'), None);
    }
}
