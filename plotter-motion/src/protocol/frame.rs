//! [`Frame`]: what the reliable link sends at once, and its bytes on the line.
//!
//! ```text
//!   kind   sequence   acknowledged   limit   length   payload ...   CRC-16     all of it in COBS, then 00
//!   1      1          1              1       1        0 to 240      2, low first
//! ```
//!
//! COBS (S. Cheshire, M. Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM Transactions on
//! Networking, 1999) leaves no zero in a frame, so a zero ends it whatever came before, and a damaged frame
//! costs no other. The check is CRC-16/X-25 (`crc` 3, catalogue name `CRC-16/IBM-SDLC`) over the session's
//! number and the frame up to the check: a frame of an earlier connection is as wrong as a damaged one. It
//! finds every burst of up to 16 bits; bytes lost or doubled show in the length too.

use core::fmt;
use crc::{CRC_16_IBM_SDLC, Crc, Table};

/// Most bytes of payload in a frame: with them a frame is one run of COBS.
pub const MOST_PAYLOAD: usize = 240;
/// Bytes before the payload.
const HEADER: usize = 5;
/// Bytes of the check.
const CHECK: usize = 2;
/// Bytes that a frame takes on the line besides its payload: header, check, one of COBS, and the zero at its
/// end.
pub const OVERHEAD: usize = HEADER + CHECK + 2;
/// Most bytes of a frame on the line.
pub const MOST_BYTES: usize = MOST_PAYLOAD + OVERHEAD;

static CRC: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_IBM_SDLC);

/// Kinds of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Kind {
    /// Introduces the sender, and begins a session.
    Hello = b'H',
    /// Payload in order.
    Data = b'D',
    /// Acknowledges payload up to a number; its own payload names what arrived out of order.
    Acknowledge = b'A',
    /// An order outside the streams, with a number of its own.
    Order = b'O',
}

impl Kind {
    const fn from_byte(byte: u8) -> Option<Self> {
        Some(match byte {
            b'H' => Self::Hello,
            b'D' => Self::Data,
            b'A' => Self::Acknowledge,
            b'O' => Self::Order,
            _ => return None,
        })
    }
}

/// A frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Kind of the frame.
    pub kind: Kind,
    /// Number of its payload, modulo 256; 0 where it has no number.
    pub sequence: u8,
    /// All payloads of the other side before this number have come.
    pub acknowledged: u8,
    /// The other side must not send this number or one after it yet.
    pub limit: u8,
    /// At most [`MOST_PAYLOAD`] bytes.
    pub payload: &'a [u8],
}

impl Frame<'_> {
    /// The frame's bytes on the line, with the zero at their end; `None` if its payload is too long.
    ///
    /// ```
    /// # use plotter_motion::protocol::frame::{Frame, Kind};
    /// let frame = Frame { kind: Kind::Data, sequence: 1, acknowledged: 0, limit: 4, payload: b"+" };
    /// let (bytes, length) = frame.encode(0x0102).ok_or("too long")?;
    /// // 44 01 00 04 01 2b and the check 98 eb; the zero in it becomes the length of the run after it
    /// assert_eq!(bytes[..length], [3, 0x44, 1, 6, 4, 1, 0x2b, 0x98, 0xeb, 0]);
    /// # Ok::<(), &str>(())
    /// ```
    #[must_use]
    pub fn encode(&self, session: u16) -> Option<([u8; MOST_BYTES], usize)> {
        let mut raw = [0; HEADER + MOST_PAYLOAD + CHECK];
        let length = u8::try_from(self.payload.len()).ok()?;
        let header = [self.kind as u8, self.sequence, self.acknowledged, self.limit, length];
        let checked = HEADER + self.payload.len();
        raw.get_mut(..HEADER)?.copy_from_slice(&header);
        raw.get_mut(HEADER..checked)
            .filter(|_| self.payload.len() <= MOST_PAYLOAD)?
            .copy_from_slice(self.payload);
        let check = check(session, raw.get(..checked)?);
        raw.get_mut(checked..checked + CHECK)?.copy_from_slice(&check.to_le_bytes());
        let mut bytes = [0; MOST_BYTES];
        // The last byte is left for the zero at the end, which `cobs` does not write.
        let (_, room) = bytes.split_last_mut()?;
        let length = cobs::try_encode(raw.get(..checked + CHECK)?, room).ok()?;
        Some((bytes, length + 1))
    }
}

/// CRC-16 over the session's number, low byte first, and `bytes`.
fn check(session: u16, bytes: &[u8]) -> u16 {
    let mut digest = CRC.digest();
    digest.update(&session.to_le_bytes());
    digest.update(bytes);
    digest.finalize()
}

/// Why a frame was dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum DecodeError {
    /// The zero at its end is missing: more bytes have come than the longest frame has.
    TooLong,
    /// It is no COBS, too short, or not as long as it says.
    Malformed,
    /// The checksum is wrong: the frame is damaged, or of another session.
    Check,
    /// A kind that this version does not know.
    Kind(u8),
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong => write!(f, "more than {MOST_BYTES} bytes without the end of a frame"),
            Self::Malformed => f.write_str("a frame that is cut or torn"),
            Self::Check => f.write_str("a frame whose check is wrong"),
            Self::Kind(kind) => write!(f, "a frame of the unknown kind {kind:#04x}"),
        }
    }
}

impl core::error::Error for DecodeError {}

/// Finds frames in a stream of bytes, whatever comes between them; sans-IO.
///
/// ```
/// # use plotter_motion::protocol::frame::{Decoder, Frame, Kind};
/// let frame = Frame { kind: Kind::Data, sequence: 7, acknowledged: 0, limit: 4, payload: &[0, 1, 0] };
/// let (bytes, length) = frame.encode(5).ok_or("too long")?;
/// let mut decoder = Decoder::new();
/// for byte in b"noise\0" {
///     decoder.push(*byte, 5);
/// }
/// let (last, before) = bytes[..length].split_last().ok_or("empty")?;
/// assert!(before.iter().all(|&byte| decoder.push(byte, 5).is_none()));
/// assert_eq!(decoder.push(*last, 5), Some(Ok(frame)));
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decoder {
    bytes: [u8; MOST_BYTES],
    length: usize,
    overrun: bool,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder between two frames.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: [0; MOST_BYTES], length: 0, overrun: false }
    }

    /// Takes a byte; says what came to its end with it. A [`Kind::Hello`] is checked as of session 0, which
    /// is no other frame's.
    pub fn push(&mut self, byte: u8, session: u16) -> Option<Result<Frame<'_>, DecodeError>> {
        if byte != 0 {
            match self.bytes.get_mut(self.length) {
                Some(place) => {
                    *place = byte;
                    self.length += 1;
                }
                None => self.overrun = true,
            }
            return None;
        }
        let length = core::mem::take(&mut self.length);
        if core::mem::take(&mut self.overrun) {
            return Some(Err(DecodeError::TooLong));
        }
        // zeros between frames mean nothing
        (length > 0).then(|| Self::decoded(self.bytes.get_mut(..length).unwrap_or_default(), session))
    }

    fn decoded(bytes: &mut [u8], session: u16) -> Result<Frame<'_>, DecodeError> {
        const MALFORMED: DecodeError = DecodeError::Malformed;
        let length = cobs::decode_in_place(bytes).map_err(|_| MALFORMED)?;
        let raw = bytes.get(..length).ok_or(MALFORMED)?;
        let (checked, sum) = raw.split_last_chunk::<CHECK>().ok_or(MALFORMED)?;
        let (header, payload) = checked.split_first_chunk::<HEADER>().ok_or(MALFORMED)?;
        let [kind, sequence, acknowledged, limit, length] = *header;
        if payload.len() != usize::from(length) || payload.len() > MOST_PAYLOAD {
            return Err(MALFORMED);
        }
        let session = if kind == Kind::Hello as u8 { 0 } else { session };
        if check(session, checked) != u16::from_le_bytes(*sum) {
            return Err(DecodeError::Check);
        }
        let kind = Kind::from_byte(kind).ok_or(DecodeError::Kind(kind))?;
        Ok(Frame { kind, sequence, acknowledged, limit, payload })
    }
}
