//! A cohort's patient as bytes, so that it can be kept outside memory while a program runs. They are no file format: another version
//! of this library may not read them.

use super::DoubtedFilm;
use super::lines::NoResult;
use super::patient::{
    CohortPatient, FilmErrors, PatientFilm, PatientFilmUnderLines, PatientHypothesis, PatientModel,
    SimulatedFilm,
};
use crate::action::LineKind;
use crate::analysis::{ComparedLine, FilmRole, FreeNumbers, WRONG_FILM};
use crate::anatomy::{Level, Levels, Posture};
use crate::evaluate::statistics::Summary;
use crate::evaluate::{Baseline, FilmFromTop, Links};
use crate::hypothesis::{Base, Hypothesis, LoadShape};
use crate::measure::{FilmLength, FilmScale};
use crate::motion::SegmentEstimate;
use crate::personalize::{FitTarget, TestOutcome};
use crate::spatial::{Angle, Frontal};

impl CohortPatient {
    /// The patient as bytes, which this very program can read again.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write(&mut bytes);
        bytes
    }

    /// The patient of [`Self::to_bytes`]; `None` for other bytes.
    #[must_use]
    pub fn from_bytes(mut bytes: &[u8]) -> Option<Self> {
        let patient = Self::read(&mut bytes)?;
        bytes.is_empty().then_some(patient)
    }
}

/// A value that is written to bytes and read from them.
trait Bytes: Sized {
    fn write(&self, bytes: &mut Vec<u8>);

    /// Takes the value off the beginning; `None` where it is not there.
    fn read(bytes: &mut &[u8]) -> Option<Self>;
}

impl Bytes for u64 {
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&self.to_le_bytes());
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let (first, rest) = bytes.split_first_chunk()?;
        *bytes = rest;
        Some(Self::from_le_bytes(*first))
    }
}

impl Bytes for f64 {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.to_bits().write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        u64::read(bytes).map(Self::from_bits)
    }
}

impl Bytes for u8 {
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.push(*self);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let (&first, rest) = bytes.split_first()?;
        *bytes = rest;
        Some(first)
    }
}

impl Bytes for usize {
    fn write(&self, bytes: &mut Vec<u8>) {
        (*self as u64).write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Self::try_from(u64::read(bytes)?).ok()
    }
}

impl Bytes for bool {
    fn write(&self, bytes: &mut Vec<u8>) {
        u8::from(*self).write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Some(u8::read(bytes)? == 1)
    }
}

impl Bytes for String {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.len().write(bytes);
        bytes.extend_from_slice(self.as_bytes());
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let size = usize::read(bytes)?;
        let (text, rest) = bytes.split_at_checked(size)?;
        *bytes = rest;
        Self::from_utf8(text.to_vec()).ok()
    }
}

impl<T: Bytes> Bytes for Vec<T> {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.len().write(bytes);
        self.iter().for_each(|item| item.write(bytes));
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let count = usize::read(bytes)?;
        // Every item has a byte, so that damage cannot ask for more memory than there are bytes.
        (count <= bytes.len()).then_some(())?;
        (0..count).map(|_| T::read(bytes)).collect()
    }
}

impl<T: Bytes> Bytes for Option<T> {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.is_some().write(bytes);
        self.iter().for_each(|value| value.write(bytes));
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        if bool::read(bytes)? { T::read(bytes).map(Some) } else { Some(None) }
    }
}

impl<T: Bytes, E: Bytes> Bytes for Result<T, E> {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.is_ok().write(bytes);
        match self {
            Ok(value) => value.write(bytes),
            Err(error) => error.write(bytes),
        }
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        if bool::read(bytes)? { T::read(bytes).map(Ok) } else { E::read(bytes).map(Err) }
    }
}

impl<T: Bytes> Bytes for [T; 2] {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.iter().for_each(|value| value.write(bytes));
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Some([T::read(bytes)?, T::read(bytes)?])
    }
}

impl<A: Bytes, B: Bytes> Bytes for (A, B) {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.0.write(bytes);
        self.1.write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Some((A::read(bytes)?, B::read(bytes)?))
    }
}

impl<A: Bytes, B: Bytes, C: Bytes> Bytes for (A, B, C) {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.0.write(bytes);
        self.1.write(bytes);
        self.2.write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Some((A::read(bytes)?, B::read(bytes)?, C::read(bytes)?))
    }
}

impl Bytes for Angle {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.rad().write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        f64::read(bytes).map(Self::from_rad)
    }
}

impl Bytes for Levels {
    fn write(&self, bytes: &mut Vec<u8>) {
        (self.base(), self.top()).write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let (base, top) = Bytes::read(bytes)?;
        Self::between(base, top)
    }
}

impl Bytes for Links {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.0.write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Vec::read(bytes).map(Self)
    }
}

/// Values that are written as their place among all of them.
macro_rules! by_place {
    ($($type:ty: $all:expr;)*) => {$(
        impl Bytes for $type {
            fn write(&self, bytes: &mut Vec<u8>) {
                let place = $all.iter().position(|one| one == self);
                (place.expect("it is one of all") as u8).write(bytes);
            }

            fn read(bytes: &mut &[u8]) -> Option<Self> {
                $all.get(usize::from(u8::read(bytes)?)).copied()
            }
        }
    )*};
}

by_place! {
    Level: Level::ALL;
    Posture: Posture::ALL;
    LineKind: LineKind::ALL;
    FilmRole: FilmRole::ALL;
    FitTarget: FitTarget::ALL;
    Baseline: Baseline::ALL;
    LoadShape: LoadShape::ALL;
    Base: Base::ALL;
    NoResult: NoResult::ALL;
    TestOutcome: TestOutcome::ALL;
    &'static str: WRONG_FILM;
}

/// Records that are written field by field.
macro_rules! by_field {
    ($($type:ident { $($field:ident),* $(,)? })*) => {$(
        impl Bytes for $type {
            fn write(&self, bytes: &mut Vec<u8>) {
                let Self { $($field),* } = self;
                $($field.write(bytes);)*
            }

            fn read(bytes: &mut &[u8]) -> Option<Self> {
                Some(Self { $($field: Bytes::read(bytes)?),* })
            }
        }
    )*};
}

by_field! {
    CohortPatient {
        case_id, synthetic, levels, segments, segment_mm, rotation_deg, inflections, doubts, has_rotation_prior, films, links,
        from_top, bends, models, tested, lines, same_data, compared, hypotheses,
    }
    DoubtedFilm { case_id, posture, code, why }
    PatientFilm {
        posture, has_motion, rmse_mm, rmse_deg, least_rotations_deg, inflection_estimates, mean_least_estimates, tested,
    }
    FilmFromTop { posture, length, top, top_sd_mm, turn, shown }
    PatientModel { kind, films }
    SimulatedFilm { posture, fitted, is_usable, errors, contradicted, contradicted_weight }
    FilmErrors { location_mm, ferguson_deg }
    ComparedLine { kind, numbers, target }
    FreeNumbers { multipliers, forces, line, per_predicted_film }
    PatientFilmUnderLines { posture, role, by_line, baselines_mm }
    PatientHypothesis { hypothesis, films }
    Hypothesis { load, base }
    SegmentEstimate { segment, least, distance_segments, distance_mm, rotation }
    Summary { n, mean, sd }
    FilmLength { measured, prior_log_sd, scale }
    FilmScale { factor, log_sd }
    Frontal { y_mm, z_mm }
}
