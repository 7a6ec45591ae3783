//! Draws a square with each firmware in simavr and checks the pulses.
//!
//! ```text
//! avr-host SIMULATOR gantry.elf steps.elf
//! ```
//!
//! The gantry draws the square of its targets with encoders; what it tells is never more than the count of this millisecond away
//! from where the simulated shafts stand, every reached target is a corner, and the way between them lies within the published
//! allowed deviation of 10 |m| + 10 counts. The step
//! firmware draws a square that is turned by 30 degrees; its pulses must be those of Bresenham's line here, step by step.

use plotter_motion::protocol::digits::{Reply, Sender};
use plotter_motion::{Axis, Bresenham, StepPair, StepPoint};
use std::error::Error;
use std::io::{Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

/// The simulator, which answers a millisecond at a time.
struct Simulator {
    child: Child,
    to: ChildStdin,
    from: ChildStdout,
    ms: u64,
}

/// What came of a millisecond.
struct Millisecond {
    sent: Vec<u8>,
    /// Clock cycle and new value of port C.
    port: Vec<(u32, u8)>,
    shafts: StepPoint,
    /// Most bytes of stack up to now.
    stack: i32,
}

impl Simulator {
    fn start(program: &str, firmware: &str) -> Result<Self, Box<dyn Error>> {
        let mut child =
            Command::new(program).arg(firmware).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let (to, from) = child.stdin.take().zip(child.stdout.take()).ok_or("no pipes")?;
        let mut simulator = Self { child, to, from, ms: 0 };
        simulator.run(None)?; // what comes before the firmware has set up its line is lost
        Ok(simulator)
    }

    fn now(&self) -> Duration {
        Duration::from_millis(self.ms)
    }

    fn run(&mut self, byte: Option<u8>) -> Result<Millisecond, Box<dyn Error>> {
        match byte {
            Some(byte) => self.to.write_all(&[1, byte])?,
            None => self.to.write_all(&[0])?,
        }
        self.ms += 1;
        let sent = self.read_counted(1)?;
        let port = self.read_counted(5)?;
        let port = port
            .chunks_exact(5)
            .map(|change| (u32::from_le_bytes([change[0], change[1], change[2], change[3]]), change[4]))
            .collect();
        let shafts = StepPoint::new(self.read_number()?, self.read_number()?);
        Ok(Millisecond { sent, port, shafts, stack: self.read_number()? })
    }

    fn read_number(&mut self) -> Result<i32, Box<dyn Error>> {
        let mut bytes = [0; 4];
        self.from.read_exact(&mut bytes)?;
        Ok(i32::from_le_bytes(bytes))
    }

    fn read_counted(&mut self, size: usize) -> Result<Vec<u8>, Box<dyn Error>> {
        let mut count = [0];
        self.from.read_exact(&mut count)?;
        let mut bytes = vec![0; usize::from(count[0]) * size];
        self.from.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    /// Sends a target digit by digit and runs until the firmware has reached it.
    fn go(
        &mut self,
        target: StepPoint,
        mut each: impl FnMut(&Millisecond) -> Result<(), Box<dyn Error>>,
    ) -> Result<(), Box<dyn Error>> {
        const LONGEST_MS: u64 = 20_000;
        let mut sender = Sender::new(Duration::from_millis(10));
        sender.start(self.now(), target)?;
        let started = self.ms;
        while self.ms < started + LONGEST_MS {
            let byte = sender.next_byte(self.now());
            let came = self.run(byte)?;
            each(&came)?;
            if came.sent.contains(&Reply::Reached.byte()) {
                return Ok(());
            }
        }
        Err(format!("({}, {}) was not reached in {LONGEST_MS} ms", target.x, target.y).into())
    }
}

impl Drop for Simulator {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The square that the gantry draws, in encoder counts.
const SQUARE: [StepPoint; 5] = [
    StepPoint::new(100, 100),
    StepPoint::new(300, 100),
    StepPoint::new(300, 300),
    StepPoint::new(100, 300),
    StepPoint::new(100, 100),
];

/// What the gantry has told of its motion.
#[derive(Default)]
struct Told {
    at: StepPoint,
    pulses: u32,
    /// Farthest from a line, counts.
    farthest: f64,
    /// Farthest from where the shaft stood, counts.
    behind: i32,
}

impl Told {
    /// Takes a millisecond on the way from one place to another.
    fn take(&mut self, came: &Millisecond, from: StepPoint, to: StepPoint) -> Result<(), Box<dyn Error>> {
        for &byte in &came.sent {
            match Reply::from_byte(byte) {
                Some(Reply::Pulse(Axis::X, direction)) => self.at.x += direction.sign(),
                Some(Reply::Pulse(Axis::Y, direction)) => self.at.y += direction.sign(),
                Some(Reply::Reached) if self.at == to => continue,
                _ => return Err(format!("byte {byte} at ({}, {})", self.at.x, self.at.y).into()),
            }
            self.pulses += 1;
            let (off, allowed) = off_line(from, to, self.at);
            self.farthest = self.farthest.max(off);
            if off > allowed {
                return Err(format!("({}, {}) is {off} counts off the line", self.at.x, self.at.y).into());
            }
        }
        let behind = (self.at.x - came.shafts.x).abs().max((self.at.y - came.shafts.y).abs());
        self.behind = self.behind.max(behind);
        if behind > 1 {
            return Err(format!("told {:?}, but the shafts stand at {:?}", self.at, came.shafts).into());
        }
        Ok(())
    }
}

fn gantry(program: &str, firmware: &str) -> Result<(), Box<dyn Error>> {
    let mut simulator = Simulator::start(program, firmware)?;
    let mut told = Told::default();
    let mut from = StepPoint::default();
    for corner in SQUARE {
        simulator.go(corner, |came| told.take(came, from, corner))?;
        from = corner;
        println!("gantry: ({}, {}) reached after {} ms", corner.x, corner.y, simulator.ms);
    }
    println!("gantry: {} bytes of stack", simulator.run(None)?.stack);
    let Told { pulses, farthest, behind, .. } = told;
    println!(
        "gantry: {pulses} pulses, at most {farthest:.1} counts off the lines, {behind} behind the shafts"
    );
    Ok(())
}

/// How far a place is from a line, measured along y (along x on a vertical one), and how far it may be.
fn off_line(from: StepPoint, to: StepPoint, at: StepPoint) -> (f64, f64) {
    let (dx, dy) = (f64::from(to.x - from.x), f64::from(to.y - from.y));
    let (x, y) = (f64::from(at.x - from.x), f64::from(at.y - from.y));
    if dx == 0.0 {
        return (x.abs(), 10.0);
    }
    let slope = dy / dx;
    ((y - slope * x).abs(), 10.0 * slope.abs() + 10.0)
}

/// Side 400 steps, turned by 30 degrees, its lowest corner at (300, 100).
fn turned_square() -> Vec<StepPoint> {
    let turned = |x: f64, y: f64| {
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        StepPoint::new((300.0 + x * cos - y * sin).round() as i32, (100.0 + x * sin + y * cos).round() as i32)
    };
    [(0.0, 0.0), (400.0, 0.0), (400.0, 400.0), (0.0, 400.0), (0.0, 0.0)].map(|(x, y)| turned(x, y)).into()
}

/// STEP and DIR of x and y on port C.
const STEP_X: u8 = 1;
const DIR_X: u8 = 2;
const STEP_Y: u8 = 4;
const DIR_Y: u8 = 8;
/// The A4988's least times at the STEP pin, 1 us high and 1 us low, and 200 ns from DIR to STEP (Allegro A4988, table
/// "Logic Interface"), at 16 MHz.
const LEAST_PULSE_CYCLES: u32 = 16;
const LEAST_SETUP_CYCLES: u32 = 4;

fn steps(program: &str, firmware: &str) -> Result<(), Box<dyn Error>> {
    let mut simulator = Simulator::start(program, firmware)?;
    let mut at = StepPoint::default();
    let (mut port, mut risen, mut fallen, mut turned) = (0_u8, 0_u32, 0_u32, 0_u32);
    let (mut count, mut shortest) = (0, u32::MAX);
    for corner in turned_square() {
        let mut made = Vec::new();
        simulator.go(corner, |came| {
            for &(cycle, now) in &came.port {
                let changed = port ^ now;
                if changed & (DIR_X | DIR_Y) != 0 {
                    if now & (STEP_X | STEP_Y) != 0 {
                        return Err("DIR changes during a pulse".into());
                    }
                    turned = cycle;
                }
                let rises = changed & now & (STEP_X | STEP_Y);
                if rises != 0 {
                    if cycle - turned < LEAST_SETUP_CYCLES
                        || (count > 0 && cycle - fallen < LEAST_PULSE_CYCLES)
                    {
                        return Err(format!("STEP rises too early, at cycle {cycle}").into());
                    }
                    let sign = |step, dir| i8::from(rises & step != 0) * if now & dir == 0 { 1 } else { -1 };
                    made.push(StepPair { x: sign(STEP_X, DIR_X), y: sign(STEP_Y, DIR_Y) });
                    (risen, count) = (cycle, count + 1);
                }
                if changed & !now & (STEP_X | STEP_Y) != 0 {
                    shortest = shortest.min(cycle - risen);
                    if cycle - risen < LEAST_PULSE_CYCLES {
                        return Err(format!("a pulse of {} cycles", cycle - risen).into());
                    }
                    fallen = cycle;
                }
                port = now;
            }
            Ok(())
        })?;
        let asked: Vec<StepPair> = Bresenham::new(at, corner).collect();
        if made != asked {
            return Err(format!("{} steps to {corner:?} instead of these {}", made.len(), asked.len()).into());
        }
        at = corner;
        println!("steps: ({}, {}) reached by {} steps", at.x, at.y, made.len());
    }
    println!("steps: {} bytes of stack", simulator.run(None)?.stack);
    println!("steps: {count} pulses, the shortest {:.2} us", f64::from(shortest) / 16.0);
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [program, gantry_elf, steps_elf] = arguments.as_slice() else {
        return Err("usage: avr-host SIMULATOR gantry.elf steps.elf".into());
    };
    gantry(program, gantry_elf)?;
    steps(program, steps_elf)
}
