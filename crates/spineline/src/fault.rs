//! Code, remedy and place of an error, beside its message.

use std::fmt::Display;

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

impl ErrorPlace {
    /// The limit that a value misses, of two; `None` for a value that is not a number.
    #[must_use]
    pub fn limit(value: f64, least: f64, most: f64) -> Option<f64> {
        (!value.is_nan()).then_some(if value > most { most } else { least })
    }
}

/// An error that says what the user can do about it.
pub trait Remedy: Display {
    /// What the user can do about it.
    fn help(&self) -> &'static str;

    /// What it is about, for programs, where that is known.
    fn place(&self) -> ErrorPlace {
        ErrorPlace::default()
    }
}

/// Defines an enum of errors, each with its message and its remedy.
///
/// The remedy is an expression that sees the fields of its variant. Where a variant has parentheses, `as` names its field. An `at` names
/// the film, the vertebra, the value and the limit that the fault concerns, and sees the fields too. A field has a comment where its name
/// and the message leave something open.
///
/// ```
/// spineline::faults! {
///     /// A sheet that cannot be printed.
///     #[derive(Debug, thiserror::Error)]
///     pub enum SheetError {
///         /// The paper is too small.
///         #[error("the paper is {width_mm} mm wide")]
///         #[help(if *width_mm < 100 { "use larger paper" } else { "print fewer columns" })]
///         #[at(value = f64::from(*width_mm), limit = 100.0)]
///         Paper {
///             /// Its width.
///             width_mm: u32,
///         },
///         /// The case on it.
///         #[error(transparent)]
///         #[help(error.help())]
///         Case(#[from] spineline::error::Error as error),
///     }
/// }
/// let error = SheetError::Paper { width_mm: 90 };
/// assert_eq!((error.help(), error.place().limit), ("use larger paper", Some(100.0)));
/// ```
///
/// # Errors of the steps of an analysis
/// Where every variant also has a code, the enum takes no derives; with `on film` the remedy sees the film.
#[macro_export]
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
                $fault:ident $({ $($(#[doc = $field_doc:literal])* $field:ident: $type:ty,)+ })?,
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
                $fault $({ $($(#[doc = $field_doc])* #[allow(missing_docs)] $field: $type,)+ })?,
            )+
        }

        #[allow(unused_variables, clippy::needless_update)]
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
    (
        $(#[$meta:meta])+
        $vis:vis enum $name:ident {
            $(
                $(#[doc = $doc:literal])+
                #[error($($message:tt)+)]
                #[help($help:expr)]
                $(#[at($($key:ident = $value:expr),+)])?
                $fault:ident
                $({ $($(#[doc = $field_doc:literal])* $field:ident: $type:ty,)+ })?
                $(($(#[$from:ident])? $inner:ty $(as $cause:ident)?))?,
            )+
        }
    ) => {
        $(#[$meta])+
        $vis enum $name {
            $(
                $(#[doc = $doc])+
                #[error($($message)+)]
                $fault $({ $($(#[doc = $field_doc])* #[allow(missing_docs)] $field: $type,)+ })? $(($(#[$from])? $inner))?,
            )+
        }

        #[allow(unused_variables, clippy::needless_update)]
        impl $name {
            /// What the user can do about it.
            #[must_use]
            $vis fn help(&self) -> &'static str {
                match self {
                    $(Self::$fault { $($($field,)+)? $($(0: $cause,)?)? .. } => $help,)+
                }
            }

            /// The place that the fault states.
            #[must_use]
            $vis fn place(&self) -> $crate::fault::ErrorPlace {
                match self {
                    $(Self::$fault { $($($field,)+)? $($(0: $cause,)?)? .. } => $crate::fault::ErrorPlace {
                        $($($key: Option::from($value),)+)?
                        ..$crate::fault::ErrorPlace::default()
                    },)+
                }
            }
        }

        impl $crate::fault::Remedy for $name {
            fn help(&self) -> &'static str {
                <$name>::help(self)
            }

            fn place(&self) -> $crate::fault::ErrorPlace {
                <$name>::place(self)
            }
        }
    };
}

pub(crate) use faults;
