//! [`ShortText`]: names of machines and files, without allocation.

/// Up to `MOST` bytes of text, 255 at most. Empty for none.
///
/// ```
/// # use plotter_motion::config::{FileName, MachineName};
/// assert_eq!(FileName::new("pens.toml").unwrap().as_str(), "pens.toml");
/// assert!(FileName::new("").unwrap().is_none() && FileName::new(&"x".repeat(128)).is_none());
/// assert_eq!((MachineName::MAX_BYTES, FileName::MAX_BYTES), (31, 127));
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct ShortText<const MOST: usize> {
    bytes: [u8; MOST],
    length: u8,
}

/// The name of a machine.
pub type MachineName = ShortText<31>;

/// The path of a file that a machine's description speaks of.
pub type FileName = ShortText<127>;

impl MachineName {
    /// The first documented machine.
    pub const SEMI_VIRTUAL_GANTRY: Self = Self::literal("semi-virtual-gantry");
    /// The documented machine with stepper motors.
    pub const STEPPER_PLOTTER: Self = Self::literal("stepper-plotter");

    /// The documented machine with one belt.
    pub const MARKING_BOARD: Self = Self::literal("marking-board");
    /// The documented machine that draws sheets longer than its table.
    pub const TEXTILE_PLOTTER: Self = Self::literal("textile-plotter");
}

impl<const MOST: usize> ShortText<MOST> {
    /// The most that it can hold, bytes.
    pub const MAX_BYTES: usize = MOST;

    /// Nothing.
    pub const NONE: Self = Self::literal("");

    const fn literal(text: &str) -> Self {
        let source = text.as_bytes();
        const { assert!(MOST <= u8::MAX as usize, "a text has at most 255 bytes") };
        let mut bytes = [0; MOST];
        let mut i = 0;
        while i < source.len() && i < bytes.len() {
            bytes[i] = source[i];
            i += 1;
        }
        #[expect(clippy::cast_possible_truncation, reason = "at most 255")]
        Self { bytes, length: i as u8 }
    }

    /// The text; `None` if it has more bytes.
    #[must_use]
    pub fn new(text: &str) -> Option<Self> {
        (text.len() <= MOST).then(|| Self::literal(text))
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        self.bytes
            .get(..usize::from(self.length))
            .and_then(|b| core::str::from_utf8(b).ok())
            .unwrap_or_default()
    }

    /// Whether it is empty.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        self.length == 0
    }
}
impl<const MOST: usize> Default for ShortText<MOST> {
    fn default() -> Self {
        Self::NONE
    }
}
impl<const MOST: usize> core::fmt::Debug for ShortText<MOST> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}
impl<const MOST: usize> core::fmt::Display for ShortText<MOST> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.as_str())
    }
}
#[cfg(feature = "serde")]
impl<const MOST: usize> serde::Serialize for ShortText<MOST> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}
#[cfg(feature = "serde")]
impl<'de, const MOST: usize> serde::Deserialize<'de> for ShortText<MOST> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor<const MOST: usize>;
        impl<const MOST: usize> serde::de::Visitor<'_> for Visitor<MOST> {
            type Value = ShortText<MOST>;
            fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                write!(f, "a text of at most {MOST} bytes")
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<ShortText<MOST>, E> {
                ShortText::new(text).ok_or_else(|| E::invalid_length(text.len(), &self))
            }
        }
        deserializer.deserialize_str(Visitor::<MOST>)
    }
}
