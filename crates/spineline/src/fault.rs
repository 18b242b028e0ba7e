//! Code, remedy and place of an error, beside its message.

use crate::anatomy::{FilmView, Level};

/// The film, the vertebra, the value and the limit that an error concerns.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ErrorPlace {
    /// The film.
    pub film: Option<FilmView>,
    /// The vertebra; of two, the upper one.
    pub level: Option<Level>,
    /// The value that cannot be used, in the unit of the message.
    pub value: Option<f64>,
    /// Its limit.
    pub limit: Option<f64>,
}

/// Defines an enum of faults. Each variant has its message, its code and its remedy. An `at` names the film, the vertebra, the value and the
/// limit that the fault concerns. The expressions see the fields of the variant; with `on film` the remedy sees the film too.
macro_rules! faults {
    (
        $(#[doc = $type_doc:literal])+
        $vis:vis enum $name:ident $(on $film:ident)? {
            $(
                $(#[doc = $doc:literal])+
                #[error($($message:tt)+)]
                #[code($code:expr)]
                #[help($help:expr)]
                $(#[at($($key:ident = $value:expr),+)])?
                $fault:ident $({ $($(#[doc = $field_doc:literal])+ $field:ident: $type:ty,)+ })?,
            )+
        }
    ) => {
        $(#[doc = $type_doc])+
        #[derive(Debug, Clone, PartialEq, thiserror::Error)]
        #[non_exhaustive]
        $vis enum $name {
            $(
                $(#[doc = $doc])+
                #[error($($message)+)]
                $fault $({ $($(#[doc = $field_doc])+ $field: $type,)+ })?,
            )+
        }

        #[allow(unused_variables)]
        impl $name {
            /// A stable name, for counts.
            #[must_use]
            $vis fn code(&self) -> &'static str {
                match self {
                    $(Self::$fault $({ $($field),+ })? => $code,)+
                }
            }

            /// What the user can do about it.
            #[must_use]
            $vis fn help(&self $(, $film: $crate::anatomy::FilmView)?) -> &'static str {
                match self {
                    $(Self::$fault $({ $($field),+ })? => $help,)+
                }
            }

            /// The place that the fault states.
            #[must_use]
            $vis fn place(&self) -> $crate::fault::ErrorPlace {
                match self {
                    $(Self::$fault $({ $($field),+ })? => $crate::fault::ErrorPlace {
                        $($($key: Option::from($value),)+)?
                        ..$crate::fault::ErrorPlace::default()
                    },)+
                }
            }
        }
    };
}

pub(crate) use faults;
