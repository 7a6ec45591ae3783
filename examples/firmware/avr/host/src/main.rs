//! Draws a square with each firmware in simavr and checks the pulses.
//!
//! ```text
//! avr-host SIMULATOR gantry.elf steps.elf
//! ```
//!
//! Both draw a square and one that is turned by 30 degrees. What the gantry tells is never more than the
//! counts of this millisecond away from where the simulated shafts stand, and at rest one at most; every
//! reached target is a corner, and the way between them lies within 3 counts of the line. The step firmware
//! makes one step of the longer side at a time, and stands within half a step of the line after each: that
//! says all of Bresenham's line but which way halves are rounded, without his algorithm.

use plotter_motion::protocol::digits::{Reply, Sender};
use plotter_motion::{Axis, StepPoint};
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

/// Farthest from the line, counts: the published rule holds one motor where a place is more than 10 |m| + 10
/// off, measured along y, and speeds in the ratio of the sides keep far within that.
const MOST_OFF: f64 = 3.0;

/// Farthest that the shafts are ahead of what is told, counts: at full duty a motor makes two in a
/// millisecond, and one more is on the line. At rest one: the shaft may stand on the border of two.
const MOST_BEHIND: i32 = 3;
const MOST_BEHIND_AT_REST: i32 = 1;
/// Long enough for what is on the line, ms.
const REST_MS: u32 = 5;

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
            let off = off_line(from, to, self.at);
            self.farthest = self.farthest.max(off);
            if off > MOST_OFF {
                return Err(format!("({}, {}) is {off} counts off the line", self.at.x, self.at.y).into());
            }
        }
        let behind = (self.at.x - came.shafts.x).abs().max((self.at.y - came.shafts.y).abs());
        self.behind = self.behind.max(behind);
        if behind > MOST_BEHIND {
            return Err(format!("told {:?}, but the shafts stand at {:?}", self.at, came.shafts).into());
        }
        Ok(())
    }
}

fn gantry(program: &str, firmware: &str) -> Result<(), Box<dyn Error>> {
    let mut simulator = Simulator::start(program, firmware)?;
    let mut told = Told::default();
    let mut from = StepPoint::default();
    for corner in [square(200.0, 0.0), square(200.0, 30.0)].concat() {
        simulator.go(corner, |came| told.take(came, from, corner))?;
        let mut shafts = told.at;
        for _ in 0..REST_MS {
            let came = simulator.run(None)?;
            shafts = came.shafts;
            told.take(&came, from, corner)?;
        }
        if (told.at.x - shafts.x).abs().max((told.at.y - shafts.y).abs()) > MOST_BEHIND_AT_REST {
            return Err(format!("told {:?} at rest, but the shafts stand at {shafts:?}", told.at).into());
        }
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

/// How far a place is from a line.
fn off_line(from: StepPoint, to: StepPoint, at: StepPoint) -> f64 {
    let (dx, dy) = (f64::from(to.x - from.x), f64::from(to.y - from.y));
    let (x, y) = (f64::from(at.x - from.x), f64::from(at.y - from.y));
    let length = dx.hypot(dy);
    if length > 0.0 { (dx * y - dy * x).abs() / length } else { x.hypot(y) }
}

/// The corners of a square, back to the first one, which is its lowest: (300, 100).
fn square(side: f64, turned_deg: f64) -> Vec<StepPoint> {
    let turned = |x: f64, y: f64| {
        let (sin, cos) = turned_deg.to_radians().sin_cos();
        StepPoint::new((300.0 + x * cos - y * sin).round() as i32, (100.0 + x * sin + y * cos).round() as i32)
    };
    [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side), (0.0, 0.0)].map(|(x, y)| turned(x, y)).into()
}

/// The first step after which a motor is not where the line asks for: as many steps as the longer side, after
/// each within half a step of it. The count of the steps where there are too few or too many.
fn wrong_step(from: StepPoint, to: StepPoint, made: &[[i64; 2]]) -> Option<usize> {
    let sides = [i64::from(to.x) - i64::from(from.x), i64::from(to.y) - i64::from(from.y)];
    let longer = sides.map(i64::abs).into_iter().max().unwrap_or_default();
    let mut at = [0_i64; 2];
    for (count, step) in (1..).zip(made) {
        for ((at, step), side) in at.iter_mut().zip(step).zip(sides) {
            *at += step;
            // After `count` of `longer` steps: at most half a step off, in whole numbers.
            if 2 * (longer * *at - count * side).abs() > longer {
                return usize::try_from(count).ok();
            }
        }
    }
    (i64::try_from(made.len()) != Ok(longer)).then_some(made.len())
}

/// STEP and DIR of x and y on port C.
const STEP_X: u8 = 1;
const DIR_X: u8 = 2;
const STEP_Y: u8 = 4;
const DIR_Y: u8 = 8;
/// The A4988's least times at the STEP pin, 1 us high and 1 us low, and 200 ns from DIR to STEP (Allegro
/// A4988, table "Logic Interface"), at 16 MHz.
const LEAST_PULSE_CYCLES: u32 = 16;
const LEAST_SETUP_CYCLES: u32 = 4;

fn steps(program: &str, firmware: &str) -> Result<(), Box<dyn Error>> {
    let mut simulator = Simulator::start(program, firmware)?;
    let mut at = StepPoint::default();
    let (mut port, mut risen, mut fallen, mut turned) = (0_u8, 0_u32, 0_u32, 0_u32);
    let (mut count, mut shortest) = (0, u32::MAX);
    for corner in [square(400.0, 0.0), square(400.0, 30.0)].concat() {
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
                    let sign = |step, dir| i64::from(rises & step != 0) * if now & dir == 0 { 1 } else { -1 };
                    made.push([sign(STEP_X, DIR_X), sign(STEP_Y, DIR_Y)]);
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
        if let Some(count) = wrong_step(at, corner, &made) {
            return Err(format!("step {count} of {} to {corner:?} is off the line", made.len()).into());
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
