//! Weights of networks and shape statistics that were learned from X-rays. The folder `data` holds them; `LICENSE` has their licence,
//! and `README.md` is their model card.

/// Weights of the networks that find vertebrae: half-precision numbers, little-endian.
pub const NETWORKS: &[u8] = include_bytes!("../data/landmarks.bin");

/// The layers of these networks.
pub const LAYERS: &str = include_str!("../data/landmarks.txt");

/// Mean and covariance of the shape of erect spines, which complete corners.
pub const ERECT_SPINES: &str = include_str!("../data/erect_spines.txt");

/// Names the origin where a program uses them.
pub const NOTE: &str = "note: landmarks are proposed by weights learned from X-rays; their licence is not confirmed (AASCE 2019); `spineline licences` has the details";

/// Licence and origin of all of these.
pub const LICENCE: &str = include_str!("../LICENSE");
