//! [`Hello`]: the first frame of either side of the reliable link.

/// Introduction of either side of the reliable link.
///
/// ```text
///   version   window   payload   reserved   session         capabilities
///   1         1        1         1 (0)      2, low first    4, low first
/// ```
///
/// Later versions may be longer; bytes after the first ten are skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Hello {
    /// Greatest version of the link that the speaker knows; 1 is the first.
    pub version: u8,
    /// How many frames it can keep that are not taken yet.
    pub window: u8,
    /// Most bytes of payload that it takes in a frame.
    pub payload: u8,
    /// The session that the host opens, or that the machine is in; 0 for none.
    pub session: u16,
    /// Further capabilities, a bit each; the link itself uses none of them.
    pub capabilities: u32,
}

impl Hello {
    /// Bytes of a hello.
    pub const BYTES: usize = 10;

    /// As payload of a frame.
    ///
    /// ```
    /// # use plotter_motion::protocol::Hello;
    /// let hello = Hello { version: 1, window: 4, payload: 128, session: 0x0102, capabilities: 1 };
    /// assert_eq!(hello.to_bytes(), [1, 4, 128, 0, 2, 1, 1, 0, 0, 0]);
    /// assert_eq!(Hello::from_bytes(&hello.to_bytes()), Some(hello));
    /// ```
    #[must_use]
    pub const fn to_bytes(self) -> [u8; Self::BYTES] {
        let [s0, s1] = self.session.to_le_bytes();
        let [c0, c1, c2, c3] = self.capabilities.to_le_bytes();
        [self.version, self.window, self.payload, 0, s0, s1, c0, c1, c2, c3]
    }

    /// From the payload of a frame; `None` if it is too short, or says what cannot be.
    #[must_use]
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let [version, window, payload, _, s0, s1, c0, c1, c2, c3] =
            *bytes.first_chunk::<{ Self::BYTES }>()?;
        let hello = Self {
            version,
            window,
            payload,
            session: u16::from_le_bytes([s0, s1]),
            capabilities: u32::from_le_bytes([c0, c1, c2, c3]),
        };
        (version > 0 && window > 0 && payload > 0).then_some(hello)
    }
}
