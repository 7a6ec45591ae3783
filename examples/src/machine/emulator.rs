//! [`Emulator`]: QEMU with a firmware in it, its serial line on a pty, and the records of its bench.

use core::time::Duration;
use plotter_motion::{Axis, Direction};
use std::ffi::OsStr;
use std::io::{ErrorKind, Read, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};

/// The emulator; `QEMU_SYSTEM_ARM` names another.
const QEMU: &str = "qemu-system-arm";
/// How long the emulator may be silent, in the time of the wall: it computes some seconds of motion a second.
const PATIENCE: Duration = Duration::from_secs(30);
/// Where the bench's switches lie in the emulator's memory (`examples/firmware/src/board/qemu/registers.rs`).
const SWITCHES: usize = 0x2030_0000;

/// How the bench in the emulator is set up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BenchSwitches {
    /// Whether the emergency stop button is pressed when the machine is switched on.
    pub stop_pressed: bool,
    /// When the watchdog bites, us; 0 for never.
    pub bite_at_us: u32,
    /// Which byte of the host is lost in the receiver, from 1; 0 for none.
    pub overrun_at_byte: u32,
}

/// What the bench tells. Its records are described in `examples/firmware/src/board/qemu/bench.rs`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Told {
    /// Its time stands still until [`Emulator::go_on`].
    Ask,
    /// A byte of the host is through.
    HostByte(u8),
    /// A byte of the controller is through.
    ControllerByte(u8),
    /// An encoder counted.
    Edge(Axis, Direction),
    /// The duty on a motor's pins, steps.
    Duty(Axis, i32),
    /// The emergency stop button.
    Stop(bool),
    /// Something to read.
    Note(String),
    /// Steps so far, and their CRC.
    Steps {
        /// How many.
        count: u64,
        /// CRC-64/XZ.
        crc: u64,
    },
    /// Where the pulses have led a motor, steps.
    Position(Axis, i32),
    /// The processor starts.
    Start {
        /// Because its watchdog reset it.
        bitten: bool,
    },
}

/// A running emulator. Dropping it ends it.
#[derive(Debug)]
pub struct Emulator {
    child: Child,
    orders: ChildStdin,
    told: Receiver<Vec<u8>>,
    bytes: Vec<u8>,
    next: usize,
    now_us: u64,
    port: String,
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Where the firmware `name` lies when it was built as the README of `examples/firmware` says.
#[must_use]
pub fn built_firmware(name: &str) -> PathBuf {
    let target = std::env::var_os("FIRMWARE_TARGET_DIR")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("firmware/target"), PathBuf::from);
    target.join("thumbv7em-none-eabihf/release").join(name)
}

impl Emulator {
    /// Starts the emulator with the firmware in `elf`, its time that of the host ([`Told::Ask`]).
    ///
    /// # Errors
    ///
    /// What is missing, and how to get it.
    pub fn start(elf: &Path, switches: BenchSwitches) -> Result<Self, String> {
        if !elf.is_file() {
            return Err(format!(
                "{}: the firmware is not built. Build it first: cd examples/firmware && cargo build --release \
                 (needs `rustup target add thumbv7em-none-eabihf`)",
                elf.display()
            ));
        }
        let qemu = std::env::var_os("QEMU_SYSTEM_ARM").unwrap_or_else(|| QEMU.into());
        let BenchSwitches { stop_pressed, bite_at_us, overrun_at_byte } = switches;
        let mut command = Command::new(&qemu);
        command.args(["-machine", "mps2-an386", "-display", "none", "-monitor", "none"]);
        command.args(["-serial", "pty", "-serial", "stdio"]);
        for (index, word) in [1, u32::from(stop_pressed), bite_at_us, overrun_at_byte].into_iter().enumerate()
        {
            let address = SWITCHES + 4 * index;
            command.args(["-device", &format!("loader,addr={address:#x},data={word},data-len=4")]);
        }
        command.args([OsStr::new("-kernel"), elf.as_os_str()]);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::inherit());
        let mut child = command.spawn().map_err(|error| match error.kind() {
            ErrorKind::NotFound => format!(
                "{}: QEMU is not installed; Debian and Ubuntu have it in the package qemu-system-arm, Homebrew in qemu",
                qemu.display()
            ),
            _ => format!("{}: {error}", qemu.display()),
        })?;
        let (Some(orders), Some(mut stdout)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(String::from("the emulator has no standard input or output"));
        };
        let (sender, told) = sync_channel(64);
        std::thread::spawn(move || {
            let mut chunk = vec![0; 1 << 16];
            while let Ok(count @ 1..) = stdout.read(&mut chunk) {
                if sender.send(chunk[..count].to_vec()).is_err() {
                    break;
                }
            }
        });
        let mut emulator =
            Self { child, orders, told, bytes: Vec::new(), next: 0, now_us: 0, port: String::new() };
        emulator.port = emulator.read_port()?;
        Ok(emulator)
    }

    /// The serial port on which the machine is.
    #[must_use]
    pub fn port(&self) -> &str {
        &self.port
    }

    /// QEMU's first line: `char device redirected to /dev/pts/3 (label serial0)`.
    fn read_port(&mut self) -> Result<String, String> {
        let mut line = Vec::new();
        loop {
            match self.byte()? {
                b'\n' => break,
                byte => line.push(byte),
            }
        }
        let line = String::from_utf8_lossy(&line);
        let port = line.split_whitespace().find(|word| word.starts_with("/dev/"));
        port.map(str::to_owned).ok_or_else(|| format!("the emulator names no pty: {line}"))
    }

    /// The next record and its time.
    ///
    /// # Errors
    ///
    /// The emulator ended, was silent for half a minute, or its firmware stopped.
    pub fn next_told(&mut self) -> Result<(Duration, Told), String> {
        let head = self.byte()?;
        let mut since_us = u64::from(head >> 4);
        if since_us == 15 {
            since_us += self.number()?;
        }
        self.now_us += since_us;
        let signed = |zigzag: u64| {
            let size = i32::try_from(zigzag / 2).unwrap_or(i32::MAX);
            if zigzag.is_multiple_of(2) { size } else { -size - 1 }
        };
        let told = match head & 0xf {
            0 => Told::Ask,
            1 => Told::HostByte(self.byte()?),
            2 => Told::ControllerByte(self.byte()?),
            3 => Told::Edge(Axis::X, Direction::Plus),
            4 => Told::Edge(Axis::X, Direction::Minus),
            5 => Told::Edge(Axis::Y, Direction::Plus),
            6 => Told::Edge(Axis::Y, Direction::Minus),
            7 => Told::Duty(Axis::X, signed(self.number()?)),
            8 => Told::Duty(Axis::Y, signed(self.number()?)),
            9 => Told::Stop(self.byte()? != 0),
            10 => Told::Note(self.text()?),
            11 => {
                let count = self.number()?;
                let mut crc = [0; 8];
                for byte in &mut crc {
                    *byte = self.byte()?;
                }
                Told::Steps { count, crc: u64::from_le_bytes(crc) }
            }
            12 => {
                let bitten = self.byte()? != 0;
                if !bitten {
                    self.now_us = 0;
                }
                Told::Start { bitten }
            }
            13 => return Err(format!("the firmware has stopped: {}", self.text()?)),
            14 => Told::Position(Axis::X, signed(self.number()?)),
            15 => Told::Position(Axis::Y, signed(self.number()?)),
            kind => return Err(format!("the emulator's bench says {kind}, which means nothing")),
        };
        Ok((Duration::from_micros(self.now_us), told))
    }

    /// After [`Told::Ask`]: `bytes` have been sent to the port now, and in `ask_after` the host is to be asked again;
    /// `None` for never.
    ///
    /// # Errors
    ///
    /// The emulator has ended.
    pub fn go_on(&mut self, bytes: usize, ask_after: Option<Duration>) -> Result<(), String> {
        let mut order = Vec::new();
        let after_us = ask_after.map_or(0, |after| u64::try_from(after.as_micros()).unwrap_or(u64::MAX));
        for mut number in [bytes as u64, after_us] {
            while number > 0x7f {
                order.push((number & 0x7f) as u8 | 0x80);
                number >>= 7;
            }
            order.push((number & 0x7f) as u8);
        }
        let written = self.orders.write_all(&order).and_then(|()| self.orders.flush());
        written.map_err(|error| format!("the emulator takes no orders: {error}"))
    }

    fn byte(&mut self) -> Result<u8, String> {
        loop {
            if let Some(&byte) = self.bytes.get(self.next) {
                self.next += 1;
                return Ok(byte);
            }
            self.bytes = self.told.recv_timeout(PATIENCE).map_err(|error| match error {
                RecvTimeoutError::Timeout => {
                    format!("the machine in the emulator was silent for {} s", PATIENCE.as_secs())
                }
                RecvTimeoutError::Disconnected => String::from("the emulator has ended"),
            })?;
            self.next = 0;
        }
    }

    fn number(&mut self) -> Result<u64, String> {
        let (mut number, mut shift) = (0, 0);
        loop {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            shift += 7;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
            if shift > 56 {
                return Err(String::from("the emulator's bench says a number that does not end"));
            }
        }
    }

    fn text(&mut self) -> Result<String, String> {
        let length = self.number()?.min(1000);
        let bytes = (0..length).map(|_| self.byte()).collect::<Result<Vec<u8>, String>>()?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}
