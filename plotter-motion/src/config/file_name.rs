//! The name of a file that a machine's description speaks of, without allocation.

/// Up to 127 bytes of text: the path of a file. Empty for none.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct FileName {
    bytes: [u8; FileName::MAX_BYTES],
    length: u8,
}
impl FileName {
    /// The most text a path can hold, bytes.
    pub const MAX_BYTES: usize = 127;

    /// No file.
    pub const NONE: Self = Self { bytes: [0; Self::MAX_BYTES], length: 0 };

    /// The path; `None` if it has more than 127 bytes.
    ///
    /// ```
    /// # use plotter_motion::FileName;
    /// assert_eq!(FileName::new("pens.toml").unwrap().as_str(), "pens.toml");
    /// assert!(FileName::new("").unwrap().is_none() && FileName::new(&"x".repeat(128)).is_none());
    /// ```
    #[must_use]
    pub fn new(text: &str) -> Option<Self> {
        let length = u8::try_from(text.len()).ok()?;
        let mut name = Self { length, ..Self::NONE };
        name.bytes.get_mut(..text.len())?.copy_from_slice(text.as_bytes());
        Some(name)
    }

    /// The path as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        self.bytes
            .get(..usize::from(self.length))
            .and_then(|b| core::str::from_utf8(b).ok())
            .unwrap_or_default()
    }

    /// Whether there is no file.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        self.length == 0
    }
}
impl Default for FileName {
    fn default() -> Self {
        Self::NONE
    }
}
impl core::fmt::Debug for FileName {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}
impl core::fmt::Display for FileName {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.as_str())
    }
}
#[cfg(feature = "serde")]
impl serde::Serialize for FileName {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}
#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for FileName {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl serde::de::Visitor<'_> for Visitor {
            type Value = FileName;
            fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str("a path of at most 127 bytes")
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<FileName, E> {
                FileName::new(text).ok_or_else(|| E::invalid_length(text.len(), &self))
            }
        }
        deserializer.deserialize_str(Visitor)
    }
}
