//! The name of a machine, without allocation.

/// Up to 31 bytes of text.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct MachineName {
    bytes: [u8; MachineName::MAX_BYTES],
    length: u8,
}
impl MachineName {
    /// The most text a name can hold, bytes.
    pub const MAX_BYTES: usize = 31;

    /// The first documented machine.
    pub const SEMI_VIRTUAL_GANTRY: Self = Self::literal("semi-virtual-gantry");
    /// The documented machine with stepper motors.
    pub const STEPPER_PLOTTER: Self = Self::literal("stepper-plotter");

    /// The documented machine with one belt.
    pub const MARKING_BOARD: Self = Self::literal("marking-board");
    /// The documented machine that draws sheets longer than its table.
    pub const TEXTILE_PLOTTER: Self = Self::literal("textile-plotter");

    const fn literal(text: &str) -> Self {
        let source = text.as_bytes();
        let mut bytes = [0; Self::MAX_BYTES];
        let mut i = 0;
        while i < source.len() && i < bytes.len() {
            bytes[i] = source[i];
            i += 1;
        }
        #[expect(clippy::cast_possible_truncation, reason = "at most 31")]
        Self { bytes, length: i as u8 }
    }

    /// The text; `None` if it has more than 31 bytes.
    #[must_use]
    pub fn new(text: &str) -> Option<Self> {
        (text.len() <= Self::MAX_BYTES).then(|| Self::literal(text))
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        self.bytes
            .get(..usize::from(self.length))
            .and_then(|b| core::str::from_utf8(b).ok())
            .unwrap_or_default()
    }
}
impl core::fmt::Debug for MachineName {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}
impl core::fmt::Display for MachineName {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.as_str())
    }
}
#[cfg(feature = "serde")]
impl serde::Serialize for MachineName {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}
#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for MachineName {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl serde::de::Visitor<'_> for Visitor {
            type Value = MachineName;
            fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str("a name of at most 31 bytes")
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<MachineName, E> {
                MachineName::new(text).ok_or_else(|| E::invalid_length(text.len(), &self))
            }
        }
        deserializer.deserialize_str(Visitor)
    }
}
