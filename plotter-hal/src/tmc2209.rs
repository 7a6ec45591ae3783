//! The registers of a TMC2209 over its UART: current, microsteps, and the load by which it homes without
//! switches.
//!
//! ```text
//!  write    05   address   register + 80   data, high byte first   CRC      8 bytes
//!  read     05   address   register        CRC                              4 bytes
//!  reply    05   FF        register        data, high byte first   CRC      8 bytes
//! ```
//!
//! The motor steps by STEP and DIR as before: [`A4988`](crate::A4988) with
//! [`Timing::TMC2209`](crate::a4988::Timing::TMC2209), which takes nothing but what passed the gate. Nothing
//! here turns a motor; the chip's own generator of steps (`VACTUAL`) is not offered.
//!
//! On the single wire the chip hears its own replies and the host its own words: [`Replies`] skips what is
//! not a reply to the question.
//!
//! **Homing without switches.** In stealthChop the chip measures the load, and its pin DIAG goes high when
//! the motor is held (`SG_RESULT` not above twice `SGTHRS`). A [`LimitSwitch`](crate::LimitSwitch) on DIAG
//! with `pressed_at: PinState::High` is, while the axis is driven towards an end, the switch of that end.
//! Below [`Settings::stall_from_hz`] DIAG says nothing, so home faster than that; and leave the end with the
//! switch of the other one in view.
//!
//! Source: Trinamic, *TMC2209 Datasheet*, Rev. 1.09: section 4.1 "Datagram Structure", 4.2 "CRC Calculation",
//! 5 "Register Map" (5.1 `GCONF`, `IFCNT`; 5.2 `IHOLD_IRUN`; 5.3 `SGTHRS`; 5.5.1 `CHOPCONF`), 9 "Selecting
//! Sense Resistors", 11 "`StallGuard4` Load Measurement".

use crate::serial_line::Fault;
use core::fmt;
use embedded_hal::delay::DelayNs;
use embedded_io::{Error as _, Read, ReadReady, Write};

/// First byte of every datagram.
const SYNC: u8 = 0x05;
/// The host's address, in replies.
const MASTER: u8 = 0xFF;
/// Set in the register's byte of a write.
const WRITE: u8 = 0x80;
/// The internal clock, Hz (section 13.1, `f_CLKOSC`).
const CLOCK_HZ: u64 = 12_000_000;
/// Full scale of the sense resistor, mV, with `vsense` 0 and 1 (section 9).
const FULL_SCALE_MV: [f32; 2] = [325.0, 180.0];
/// What the chip's own bond wires add to the sense resistor, mOhm (section 9).
const BOND_MOHM: f32 = 20.0;
/// `CHOPCONF` after a reset: TOFF 3, HSTRT 5, interpolation (section 5.5.1).
const CHOPCONF_RESET: u32 = 0x1000_0053;
/// Longest that a reply may take, and how often it is looked for. At 9600 baud 12 bytes take 12.5 ms, and the
/// chip answers after 8 bit times.
const REPLY_US: u32 = 20_000;
const LOOK_US: u32 = 50;
/// Most bytes that are taken between two looks: more than a question and its reply, so that a line that is
/// never quiet does not keep its reader.
const MOST_AT_ONCE: u32 = 32;
/// How often a port may take nothing: one that is busy and does not wait takes a byte at 9600 baud in 1 ms.
const MOST_TRIES: u32 = 1_000_000;

/// A register that is written or read here, by its address (section 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
#[non_exhaustive]
pub enum Register {
    /// General configuration.
    Gconf = 0x00,
    /// Events since the last reading: reset, error, undervoltage.
    Gstat = 0x01,
    /// How many writes have been taken, of 256.
    Ifcnt = 0x02,
    /// Currents.
    IholdIrun = 0x10,
    /// Speed from which on the load is measured and told.
    Tcoolthrs = 0x14,
    /// Half of the load value that is a stall.
    Sgthrs = 0x40,
    /// The load value: lower is more load.
    SgResult = 0x41,
    /// Chopper, microsteps, range of the current.
    Chopconf = 0x6C,
    /// Temperature, shorts, open load.
    DrvStatus = 0x6F,
}

/// The check of a datagram: x^8 + x^2 + x + 1, each byte with its low bit first (section 4.2).
///
/// ```
/// use plotter_hal::tmc2209::crc;
/// assert_eq!(crc(&[0x05, 0x00, 0x00]), 0x48); // reads GCONF of the chip with address 0
/// ```
#[must_use]
pub const fn crc(bytes: &[u8]) -> u8 {
    let mut crc = 0_u8;
    let mut rest = bytes;
    while let Some((&byte, after)) = rest.split_first() {
        let mut bit = 0;
        while bit < 8 {
            let carry = (crc >> 7) ^ (byte >> bit & 1);
            crc = crc << 1 ^ if carry != 0 { 0x07 } else { 0 };
            bit += 1;
        }
        rest = after;
    }
    crc
}

/// The datagram that writes a register of the chip with this address, 0 to 3 (its pins MS1 and MS2).
///
/// ```
/// # use plotter_hal::tmc2209::{Register, write_datagram};
/// // IRUN 31, IHOLD 16, IHOLDDELAY 1
/// assert_eq!(write_datagram(0, Register::IholdIrun, 0x0001_1F10)[..7], [0x05, 0, 0x90, 0, 0x01, 0x1F, 0x10]);
/// ```
#[must_use]
pub const fn write_datagram(address: u8, register: Register, value: u32) -> [u8; 8] {
    let [a, b, c, d] = value.to_be_bytes();
    let head = [SYNC, address, register as u8 | WRITE, a, b, c, d];
    let [sync, address, register, a, b, c, d] = head;
    [sync, address, register, a, b, c, d, crc(&head)]
}

/// The datagram that asks for a register.
#[must_use]
pub const fn read_datagram(address: u8, register: Register) -> [u8; 4] {
    let head = [SYNC, address, register as u8];
    [SYNC, address, register as u8, crc(&head)]
}

/// Finds the reply to a question among the bytes that come: skips the question itself, which comes back on a
/// single wire, and whatever is damaged.
///
/// ```
/// use plotter_hal::tmc2209::{Register, Replies, crc, read_datagram};
/// let mut replies = Replies::new(Register::Ifcnt);
/// let reply = [0x05, 0xFF, 0x02, 0, 0, 0, 7];
/// let came = [&read_datagram(0, Register::Ifcnt)[..], &reply, &[crc(&reply)]].concat();
/// assert_eq!(came.into_iter().find_map(|byte| replies.push(byte)), Some(7));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Replies {
    register: Register,
    /// The last eight bytes.
    last: [u8; 8],
}

impl Replies {
    /// Listens for this register.
    #[must_use]
    pub const fn new(register: Register) -> Self {
        Self { register, last: [0; 8] }
    }

    /// Takes a byte; gives the value once its reply is whole.
    pub fn push(&mut self, byte: u8) -> Option<u32> {
        let [_, a, b, c, d, e, f, g] = self.last;
        self.last = [a, b, c, d, e, f, g, byte];
        let is_reply = a == SYNC && b == MASTER && c == self.register as u8;
        (is_reply && crc(&[a, b, c, d, e, f, g]) == byte).then(|| u32::from_be_bytes([d, e, f, g]))
    }
}

/// How the coils are chopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Chopper {
    /// By voltage, without noise. The load is measured in it alone.
    StealthChop,
    /// By current, for more torque at high speed.
    SpreadCycle,
}

/// Settings of a motor: current, microsteps, chopper.
///
/// ```
/// # use plotter_hal::tmc2209::Settings;
/// let settings = Settings::default().with_run_ma(800).with_hold_ma(400).with_microsteps(32);
/// assert_eq!(settings.sense_mohm, 110);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Settings {
    /// Current while it steps, RMS, mA: that of the motor's data sheet, over the root of 2 if it is a peak
    /// there.
    pub run_ma: u16,
    /// Current at rest, mA; no more than `run_ma`.
    pub hold_ma: u16,
    /// The sense resistors of the board, mOhm.
    pub sense_mohm: u16,
    /// Microsteps to a full step on STEP: 1, 2, 4, …, 256.
    pub microsteps: u16,
    /// The chip makes 256 microsteps of each by itself.
    pub interpolates: bool,
    /// How the coils are chopped.
    pub chopper: Chopper,
    /// A stall is a load value not above twice this. 0 is never; higher is more sensitive. To be found out on
    /// the machine: read [`Register::SgResult`] while it runs freely, and begin at a quarter of it.
    pub stall_threshold: u8,
    /// Steps/s from which on a stall is told.
    pub stall_from_hz: u32,
}

impl Settings {
    /// The same with another [`Settings::chopper`].
    #[must_use]
    pub const fn with_chopper(self, chopper: Chopper) -> Self {
        Self { chopper, ..self }
    }

    /// The same with another [`Settings::hold_ma`].
    #[must_use]
    pub const fn with_hold_ma(self, hold_ma: u16) -> Self {
        Self { hold_ma, ..self }
    }

    /// The same with another [`Settings::interpolates`].
    #[must_use]
    pub const fn with_interpolates(self, interpolates: bool) -> Self {
        Self { interpolates, ..self }
    }

    /// The same with another [`Settings::microsteps`].
    #[must_use]
    pub const fn with_microsteps(self, microsteps: u16) -> Self {
        Self { microsteps, ..self }
    }

    /// The same with another [`Settings::run_ma`].
    #[must_use]
    pub const fn with_run_ma(self, run_ma: u16) -> Self {
        Self { run_ma, ..self }
    }

    /// The same with another [`Settings::sense_mohm`].
    #[must_use]
    pub const fn with_sense_mohm(self, sense_mohm: u16) -> Self {
        Self { sense_mohm, ..self }
    }

    /// The same with another [`Settings::stall_from_hz`].
    #[must_use]
    pub const fn with_stall_from_hz(self, stall_from_hz: u32) -> Self {
        Self { stall_from_hz, ..self }
    }

    /// The same with another [`Settings::stall_threshold`].
    #[must_use]
    pub const fn with_stall_threshold(self, stall_threshold: u8) -> Self {
        Self { stall_threshold, ..self }
    }
}

impl Default for Settings {
    /// 500 mA, 250 mA at rest, 110 mOhm as on common small boards, 16 microsteps with interpolation,
    /// stealthChop; no stall is told.
    fn default() -> Self {
        Self {
            run_ma: 500,
            hold_ma: 250,
            sense_mohm: 110,
            microsteps: 16,
            interpolates: true,
            chopper: Chopper::StealthChop,
            stall_threshold: 0,
            stall_from_hz: 1000,
        }
    }
}

impl Settings {
    /// The values of the registers, in the order in which they are to be written: the coils' current before
    /// they get any.
    ///
    /// # Errors
    ///
    /// [`SettingsError`] for a current or a resolution that the chip does not have.
    pub fn registers(&self) -> Result<[(Register, u32); 5], SettingsError> {
        let mres = match self.microsteps.checked_ilog2() {
            Some(power) if self.microsteps.is_power_of_two() && power <= 8 => 8 - power,
            _ => return Err(SettingsError::Microsteps(self.microsteps)),
        };
        let (run, vsense) = self.scale(self.run_ma, None)?;
        let (hold, _) = self.scale(self.hold_ma.min(self.run_ma), Some(vsense))?;
        // I_scale_analog off: the current is that of the registers. The UART instead of the pins sets the
        // power down and the microsteps; the filter of steps stays on.
        let spread = u32::from(self.chopper == Chopper::SpreadCycle);
        let gconf = spread << 2 | 1 << 6 | 1 << 7 | 1 << 8;
        let chopconf = (CHOPCONF_RESET & !(0xF << 24 | 1 << 28 | 1 << 17))
            | mres << 24
            | u32::from(self.interpolates) << 28
            | u32::from(vsense) << 17;
        // TSTEP is the time of a 256th of a full step; it is 20 bits.
        let per_s = u64::from(self.stall_from_hz.max(1)) * 256;
        let slowest =
            u32::try_from(CLOCK_HZ * u64::from(self.microsteps) / per_s).unwrap_or(u32::MAX).min(0xF_FFFF);
        Ok([
            (Register::Gconf, gconf),
            (Register::IholdIrun, 1 << 16 | u32::from(run) << 8 | u32::from(hold)),
            (Register::Sgthrs, self.stall_threshold.into()),
            (Register::Tcoolthrs, if self.stall_threshold > 0 { slowest } else { 0 }),
            (Register::Chopconf, chopconf),
        ])
    }

    /// The step of 32 for a current, rounded down, and the range: the finer one if the current lies within
    /// it.
    ///
    /// ```text
    /// I = (CS + 1) / 32 * V_FS / (R_sense + 20 mOhm) / sqrt(2)
    /// ```
    fn scale(&self, current_ma: u16, range: Option<bool>) -> Result<(u8, bool), SettingsError> {
        let steps = |fine: bool| {
            let [coarse_mv, fine_mv] = FULL_SCALE_MV;
            let ohm = (f32::from(self.sense_mohm) + BOND_MOHM) / 1000.0;
            32.0 * core::f32::consts::SQRT_2 * f32::from(current_ma) * ohm
                / if fine { fine_mv } else { coarse_mv }
        };
        let fine = range.unwrap_or(steps(true) <= 32.0);
        let steps = steps(fine);
        if self.sense_mohm == 0 || steps > 32.0 {
            return Err(SettingsError::Current { current_ma, sense_mohm: self.sense_mohm });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 32")]
        let whole = steps as u8;
        Ok((whole.saturating_sub(1), fine))
    }
}

/// Settings that a TMC2209 cannot be set to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingsError {
    /// The chip does not have this many microsteps to a full step.
    Microsteps(u16),
    /// The sense resistors do not let that much through.
    Current {
        /// The current asked for, mA.
        current_ma: u16,
        /// With these, mOhm.
        sense_mohm: u16,
    },
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Microsteps(asked) => {
                write!(f, "tmc2209: no {asked} microsteps to a full step; 1, 2, 4, 8, …, 256 are")
            }
            Self::Current { current_ma, sense_mohm } => {
                write!(f, "tmc2209: {current_ma} mA are too much for sense resistors of {sense_mohm} mohm")
            }
        }
    }
}

impl core::error::Error for SettingsError {}

/// A TMC2209 on a serial port of its own, or on one with up to three others.
///
/// ```
/// # use core::convert::Infallible;
/// # use embedded_hal_mock::eh1::delay::NoopDelay;
/// # use embedded_io::{ErrorType, Read, ReadReady, Write};
/// # use plotter_hal::tmc2209::crc;
/// # /// A chip: takes writes, counts them, and answers.
/// # #[derive(Default)]
/// # struct Chip { taken: u8, answer: Vec<u8> }
/// # impl ErrorType for Chip { type Error = Infallible; }
/// # impl Write for Chip {
/// #     fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
/// #         self.answer.extend(bytes);
/// #         if bytes.len() == 8 { self.taken += 1; } else {
/// #             let reply = [5, 0xFF, bytes[2], 0, 0, 0, self.taken];
/// #             self.answer.extend(reply);
/// #             self.answer.push(crc(&reply));
/// #         }
/// #         Ok(bytes.len())
/// #     }
/// #     fn flush(&mut self) -> Result<(), Infallible> { Ok(()) }
/// # }
/// # impl ReadReady for Chip { fn read_ready(&mut self) -> Result<bool, Infallible> { Ok(!self.answer.is_empty()) } }
/// # impl Read for Chip {
/// #     fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> { bytes[0] = self.answer.remove(0); Ok(1) }
/// # }
/// # let (port, mut delay) = (Chip::default(), NoopDelay);
/// use plotter_hal::tmc2209::{Register, Settings, Tmc2209};
///
/// let mut chip = Tmc2209::new(port, 0);
/// chip.configure(&Settings::default().with_run_ma(800), &mut delay)?; // before the motor is started
/// assert_eq!(chip.read(Register::Ifcnt, &mut delay)?, 5); // five writes were taken
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tmc2209<Port> {
    port: Port,
    address: u8,
}

impl<Port> Tmc2209<Port> {
    /// The chip with this address, 0 to 3. Says nothing to it.
    pub const fn new(port: Port, address: u8) -> Self {
        Self { port, address: address & 3 }
    }

    /// Gives the port back.
    pub fn release(self) -> Port {
        self.port
    }
}

impl<Port: Read + ReadReady + Write> Tmc2209<Port> {
    /// Writes all settings, and makes sure that the chip has taken them: before the motor is started, and
    /// anew after a loss of its supply, which sets it back to its pins.
    ///
    /// # Errors
    ///
    /// [`Error::Settings`], before anything is written; otherwise the chip may have some of them, and the
    /// motor is not to be started.
    pub fn configure(&mut self, settings: &Settings, delay: &mut impl DelayNs) -> Result<(), Error> {
        for (register, value) in settings.registers().map_err(Error::Settings)? {
            self.write(register, value, delay)?;
        }
        Ok(())
    }

    /// Writes a register, and asks the chip whether it has taken it.
    ///
    /// # Errors
    ///
    /// [`Error::NotTaken`] if the chip's count of writes did not go on by one; [`Error::Silent`] if it does
    /// not answer; [`Error::Port`].
    pub fn write(&mut self, register: Register, value: u32, delay: &mut impl DelayNs) -> Result<(), Error> {
        let before = self.read(Register::Ifcnt, delay)?;
        self.send(&write_datagram(self.address, register, value))?;
        let after = self.read(Register::Ifcnt, delay)?;
        let [before, after] = [before, after].map(|count| count.to_le_bytes()[0]);
        if after == before.wrapping_add(1) { Ok(()) } else { Err(Error::NotTaken(register)) }
    }

    /// Reads a register.
    ///
    /// # Errors
    ///
    /// [`Error::Silent`] if no whole reply comes within 20 ms; [`Error::Port`] if nothing can be sent.
    pub fn read(&mut self, register: Register, delay: &mut impl DelayNs) -> Result<u32, Error> {
        // What came late, or broken, belongs to nothing.
        for _ in 0..MOST_AT_ONCE {
            if self.came().is_none() {
                break;
            }
        }
        self.send(&read_datagram(self.address, register))?;
        let mut replies = Replies::new(register);
        for _ in 0..REPLY_US / LOOK_US {
            for _ in 0..MOST_AT_ONCE {
                let Some(byte) = self.came() else { break };
                if let Some(value) = replies.push(byte) {
                    return Ok(value);
                }
            }
            delay.delay_us(LOOK_US);
        }
        Err(Error::Silent(register))
    }

    /// A byte, if one has come. One that is broken has not: its reply is not whole then.
    fn came(&mut self) -> Option<u8> {
        let mut byte = [0];
        match self.port.read_ready() {
            Ok(true) => self.port.read(&mut byte).ok().filter(|&bytes| bytes > 0).map(|_| byte[0]),
            Ok(false) | Err(_) => None,
        }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let mut rest = bytes;
        for _ in 0..MOST_TRIES {
            if rest.is_empty() {
                break;
            }
            let taken = self.port.write(rest).map_err(|error| Error::Port(Fault::of(error.kind())))?;
            rest = rest.get(taken..).unwrap_or_default();
        }
        if !rest.is_empty() {
            return Err(Error::Port(Fault::Other));
        }
        self.port.flush().map_err(|error| Error::Port(Fault::of(error.kind())))
    }
}

/// A TMC2209 does not do as it is told: do not start its motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// It cannot be set so.
    Settings(SettingsError),
    /// It does not answer: check supply, address, and the resistor between TX and RX.
    Silent(Register),
    /// It answers, but has not taken the write.
    NotTaken(Register),
    /// The serial port failed.
    Port(Fault),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Settings(error) => error.fmt(f),
            Self::Silent(register) => write!(
                f,
                "tmc2209: no answer to the question for {register:?}; check its supply, its address, and the resistor \
                 between tx and rx"
            ),
            Self::NotTaken(register) => write!(f, "tmc2209: it has not taken the write of {register:?}"),
            Self::Port(fault) => write!(f, "tmc2209: {fault}"),
        }
    }
}

impl core::error::Error for Error {}
