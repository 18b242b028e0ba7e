use std::fmt;

/// A closed set of values, each with one name that is the same in files, over the network and on the command line.
///
/// The values and names are those of the type itself; this trait lets one piece of code read and write all such types.
///
/// ```
/// use spineline::anatomy::{Named, Posture};
/// assert_eq!(<Posture as Named>::from_key("left_bending"), Some(Posture::LeftBending));
/// ```
pub trait Named: Copy + Eq + 'static {
    /// Every value, in order.
    const ALL: &'static [Self];

    /// The name of this value.
    fn key(self) -> &'static str;

    /// The value of a name.
    #[must_use]
    fn from_key(key: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|value| value.key() == key)
    }
}

/// Implements [`Named`] for types that have `ALL` and `key` of their own.
macro_rules! named {
    ($($name:ty),+ $(,)?) => {$(
        impl $crate::anatomy::Named for $name {
            const ALL: &'static [Self] = &<$name>::ALL;

            fn key(self) -> &'static str {
                <$name>::key(self)
            }
        }
    )+};
}

pub(crate) use named;

/// Text that is not the name of any allowed value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownKey {
    /// The text.
    pub text: String,
    /// The allowed names.
    pub allowed: Vec<&'static str>,
}

impl UnknownKey {
    /// The text, and the names of the values that are allowed.
    #[must_use]
    pub fn new<T: Named>(text: &str, allowed: &[T]) -> Self {
        Self { text: text.to_owned(), allowed: allowed.iter().map(|value| value.key()).collect() }
    }
}

impl fmt::Display for UnknownKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "unknown variant `{}`, expected ", self.text)?;
        match self.allowed[..] {
            [first, second] => write!(f, "`{first}` or `{second}`"),
            _ => write!(f, "one of `{}`", self.allowed.join("`, `")),
        }
    }
}

impl std::error::Error for UnknownKey {}
