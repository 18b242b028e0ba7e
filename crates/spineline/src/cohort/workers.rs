//! Work that a caller may do on several threads; the core has none.

use std::sync::OnceLock;

/// Does pieces of work that do not depend on each other. Results are the same in any order, on any number of threads.
pub trait Workers: Sync {
    /// Does all pieces, by their number.
    fn each(&self, pieces: usize, work: &(dyn Fn(usize) + Sync));
}

/// One piece after the other.
#[derive(Debug, Clone, Copy, Default)]
pub struct OneThread;

impl Workers for OneThread {
    fn each(&self, pieces: usize, work: &(dyn Fn(usize) + Sync)) {
        (0..pieces).for_each(work);
    }
}

/// The results of all pieces, in their order.
pub(super) fn results<T: Send + Sync>(
    workers: &dyn Workers,
    pieces: usize,
    work: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let found: Vec<OnceLock<T>> = (0..pieces).map(|_| OnceLock::new()).collect();
    workers.each(pieces, &|piece| {
        found[piece].get_or_init(|| work(piece));
    });
    // A piece that was not done is done here.
    let result =
        |(piece, one): (usize, OnceLock<T>)| one.into_inner().unwrap_or_else(|| work(piece));
    found.into_iter().enumerate().map(result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Does the pieces from the last to the first, the last twice, and one never.
    struct Careless;

    impl Workers for Careless {
        fn each(&self, pieces: usize, work: &(dyn Fn(usize) + Sync)) {
            work(pieces - 1);
            (1..pieces).rev().for_each(work);
        }
    }

    #[test]
    fn results_do_not_depend_on_who_does_the_work() {
        let of = |workers: &dyn Workers| results(workers, 5, |piece| piece * piece);
        assert_eq!(of(&OneThread), [0, 1, 4, 9, 16]);
        assert_eq!(of(&Careless), of(&OneThread));
    }
}
