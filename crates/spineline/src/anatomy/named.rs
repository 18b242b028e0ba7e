use std::fmt;
use std::str::FromStr;

use serde::de::{DeserializeSeed, Deserializer, EnumAccess, Error, VariantAccess, Visitor};

/// A closed set of values, each with one name that is the same in files, over the network and on the command line.
///
/// [`named!`](crate::named) defines such a type; this trait lets one piece of code read and write all of them.
///
/// ```
/// use spineline::anatomy::{Named, Posture};
/// assert_eq!("left_bending".parse(), Ok(Posture::LeftBending));
/// assert_eq!(Posture::LeftBending.help(), "Bending to the patient's left.");
/// ```
pub trait Named: Copy + Eq + FromStr<Err = UnknownKey> + fmt::Display + 'static {
    /// Name of the type.
    const TYPE: &'static str;

    /// Documentation of the type.
    const DOC: &'static str;

    /// Every value, in order.
    const ALL: &'static [Self];

    /// The name of this value.
    fn key(self) -> &'static str;

    /// Documentation of this value.
    fn doc(self) -> &'static str;

    /// What the type is, in one paragraph.
    #[must_use]
    fn description() -> String {
        first_paragraph(Self::DOC)
    }

    /// What this value means, in one paragraph.
    #[must_use]
    fn help(self) -> String {
        first_paragraph(self.doc())
    }
}

fn first_paragraph(doc: &str) -> String {
    let lines = doc.lines().map(str::trim).take_while(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join(" ")
}

/// Defines an enum with [names](crate::anatomy::Named): each value has the key that files use and, behind `as`, the text that people
/// read where it differs from the key.
///
/// The type gets `ALL` and `key`, `FromStr`, `Serialize` and `Deserialize` by the key, `Display` by the text, and the usual derives.
/// `#[default(Value)]` names the default. Descriptions in schemas are the documentation of type and values.
///
/// ```
/// spineline::named! {
///     /// A colour of paper.
///     #[default(White)]
///     pub enum Paper {
///         /// Bleached.
///         White = "white",
///         /// As it comes from the mill.
///         OffWhite = "off_white" as "off-white",
///     }
/// }
/// assert_eq!("off_white".parse(), Ok(Paper::OffWhite));
/// assert_eq!(Paper::OffWhite.to_string(), "off-white");
/// assert_eq!(Paper::ALL.map(Paper::key), ["white", "off_white"]);
/// assert_eq!(Paper::default(), Paper::White);
/// ```
#[macro_export]
macro_rules! named {
    (
        $(#[doc = $type_doc:literal])+
        $(#[default($default:ident)])?
        $vis:vis enum $name:ident {
            $($(#[doc = $doc:literal])+ $value:ident = $key:literal $(as $text:literal)?,)+
        }
    ) => {
        $(#[doc = $type_doc])+
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        $vis enum $name {
            $($(#[doc = $doc])+ $value,)+
        }

        impl $name {
            /// Every value, in order.
            $vis const ALL: [Self; [$(Self::$value),+].len()] = [$(Self::$value),+];

            /// The name used in files.
            #[must_use]
            $vis const fn key(self) -> &'static str {
                match self {
                    $(Self::$value => $key,)+
                }
            }
        }

        $(impl Default for $name {
            fn default() -> Self {
                Self::$default
            }
        })?

        impl $crate::anatomy::Named for $name {
            const TYPE: &'static str = stringify!($name);
            const DOC: &'static str = concat!($($type_doc, "\n"),+);
            const ALL: &'static [Self] = &<$name>::ALL;

            fn key(self) -> &'static str {
                <$name>::key(self)
            }

            fn doc(self) -> &'static str {
                match self {
                    $(Self::$value => concat!($($doc, "\n"),+),)+
                }
            }
        }

        impl ::std::fmt::Display for $name {
            fn fmt(&self, f: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                f.pad(match self {
                    $($(Self::$value => $text,)?)+
                    #[allow(unreachable_patterns)]
                    _ => <$name>::key(*self),
                })
            }
        }

        $crate::named!(by_key $name);
    };
    (by_key $name:ident) => {
        impl ::std::str::FromStr for $name {
            type Err = $crate::anatomy::UnknownKey;

            fn from_str(key: &str) -> Result<Self, Self::Err> {
                $crate::anatomy::of_key(key)
            }
        }

        impl $crate::serde::Serialize for $name {
            fn serialize<S: $crate::serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                to.serialize_str($crate::anatomy::Named::key(*self))
            }
        }

        impl<'de> $crate::serde::Deserialize<'de> for $name {
            fn deserialize<D: $crate::serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                $crate::anatomy::deserialize_key(from)
            }
        }

        $crate::named_schema!($name);
    };
}

/// Implements `JsonSchema` for a named type.
#[cfg(feature = "schema")]
#[doc(hidden)]
#[macro_export]
macro_rules! named_schema {
    ($name:ident) => {
        impl $crate::schemars::JsonSchema for $name {
            fn schema_name() -> ::std::borrow::Cow<'static, str> {
                concat!(stringify!($name), "Key").into()
            }

            fn json_schema(_: &mut $crate::schemars::SchemaGenerator) -> $crate::schemars::Schema {
                $crate::anatomy::schema_of_keys::<Self>()
            }
        }
    };
}

/// Without schemas, a named type needs nothing more.
#[cfg(not(feature = "schema"))]
#[doc(hidden)]
#[macro_export]
macro_rules! named_schema {
    ($name:ident) => {};
}

/// The value of a key.
///
/// # Errors
/// If no value has this key; the error lists the keys.
pub fn of_key<T: Named>(key: &str) -> Result<T, UnknownKey> {
    T::ALL.iter().copied().find(|value| value.key() == key).ok_or_else(|| UnknownKey {
        text: key.to_owned(),
        allowed: T::ALL.iter().map(|value| value.key()).collect(),
    })
}

/// Reads a value by its key.
///
/// # Errors
/// If no value has this key; the message lists the keys.
pub fn deserialize_key<'de, T: Named, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
    // The type is an enum also for serde, as if it were derived: names and variants are only for formats without names.
    from.deserialize_enum("", &[], ByKey(std::marker::PhantomData))
}

/// Reads the key in place, so that an error carries the line of the key and not the end of the object.
struct ByKey<T>(std::marker::PhantomData<T>);

impl<'de, T: Named> Visitor<'de> for ByKey<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a value")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<T, A::Error> {
        let (value, content) = access.variant_seed(self)?;
        content.unit_variant()?;
        Ok(value)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        of_key(text).map_err(E::custom)
    }
}

impl<'de, T: Named> DeserializeSeed<'de> for ByKey<T> {
    type Value = T;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<T, D::Error> {
        from.deserialize_identifier(self)
    }
}

/// The keys, each with its meaning.
#[cfg(feature = "schema")]
#[must_use]
pub fn schema_of_keys<T: Named>() -> schemars::Schema {
    let one = |value: &T| schemars::json_schema!({ "type": "string", "const": value.key(), "description": value.help() });
    let values: Vec<_> = T::ALL.iter().map(one).collect();
    schemars::json_schema!({ "oneOf": values, "description": T::description() })
}

/// Text that is not the name of any allowed value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownKey {
    /// The text.
    pub text: String,
    /// The allowed names.
    pub allowed: Vec<&'static str>,
}

impl fmt::Display for UnknownKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "unknown name `{}`, expected ", self.text)?;
        match self.allowed[..] {
            [first, second] => write!(f, "`{first}` or `{second}`"),
            _ => write!(f, "one of `{}`", self.allowed.join("`, `")),
        }
    }
}

impl std::error::Error for UnknownKey {}
