//! Stands in for the crate `stabby`: the one type that Zenoh names while plugins are off, without a stable layout.
//! Nothing here crosses a binary interface.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

/// Strings.
pub mod str {
    use std::fmt::{Display, Formatter, Result};
    use std::ops::Deref;

    /// A borrowed string.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub struct Str<'a>(&'a str);

    impl<'a> From<&'a str> for Str<'a> {
        fn from(text: &'a str) -> Self {
            Self(text)
        }
    }

    impl Deref for Str<'_> {
        type Target = str;

        fn deref(&self) -> &str {
            self.0
        }
    }

    impl Display for Str<'_> {
        fn fmt(&self, f: &mut Formatter<'_>) -> Result {
            f.write_str(self.0)
        }
    }
}
