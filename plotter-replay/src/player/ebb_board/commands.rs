//! What each command of the board does, and what it answers.

use super::EbbBoard;
use super::motion::{Queued, Work};
use super::parameters::{Kind, Parameters, Wrong};
use plotter_motion::Pen;
use plotter_motion::protocol::ebb::{LowLevelMove, MotorRate};

/// Greatest duration, ms, and number of steps of SM and XM: 24 bits.
const MOST: u32 = 0xFF_FFFF;
/// A motor with less than a step in so many ms is refused by SM and XM: 1.31 steps/s.
const SLOWEST_MS: u32 = 1_311;
/// Steps in a ms at most.
const FASTEST: u32 = 25;
/// Shortest move of HM, ms.
const SHORTEST_HOME_MS: u32 = 10;
/// The servo output of the pen: RP4, which is the pin B1.
const PEN_OUTPUT: u8 = 4;
/// Servo outputs there are.
const MOST_OUTPUT: u8 = 24;
/// Longest nickname, bytes.
const MOST_NICKNAME: usize = 16;
/// What the converter reads of the motors' current, and of a supply of 9 V, of 1023: the documentation's
/// example.
const CURRENT_READING: u16 = 394;
const SUPPLY_READING: u16 = 300;

/// What is left to be done of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Left {
    /// A command enters the motion queue as soon as that has room.
    Queue(Queued),
    /// The motors go to these counts, once all before is done: rate, steps/s, and counts.
    Home(u32, [i32; 2]),
    /// An answer.
    Say(Vec<u8>),
    /// `OK`, if that is answered at all.
    Ok,
}

/// Why a line comes to nothing.
enum Refusal {
    Wrong(Wrong),
    /// With the board's words.
    Said(String),
    Unknown,
}

impl From<Wrong> for Refusal {
    fn from(wrong: Wrong) -> Self {
        Self::Wrong(wrong)
    }
}

impl EbbBoard {
    /// Does what a line says, or leaves it to be done.
    pub(super) fn obey(&mut self, line: &[u8]) {
        let Some((&first, rest)) = line.split_first() else { return };
        let first = first.to_ascii_uppercase();
        let (second, rest) = match rest.split_first() {
            Some((&second, rest)) if second != b',' => (Some(second.to_ascii_uppercase()), rest),
            _ => (None, rest),
        };
        let mut parameters = Parameters(rest);
        let name: &[u8] = &match second {
            Some(second) => vec![first, second],
            None => vec![first],
        };
        match self.command(name, &mut parameters) {
            Ok(()) => {
                // (a reset forgets what was left of its line)
                if !parameters.0.is_empty() && name != b"R" {
                    self.say("!7 Err: Extra parameter\r\n");
                }
            }
            Err(Refusal::Wrong(Wrong::Missing)) => self.say("!4 Err: Missing parameter(s)\r\n"),
            Err(Refusal::Wrong(Wrong::Value)) => self.say("!6 Err: Invalid parameter value\r\n"),
            Err(Refusal::Wrong(Wrong::NoComma(found))) => {
                self.say(&format!("!5 Err: Need comma next, found: '{}'\r\n", char::from(found)));
            }
            Err(Refusal::Said(words)) => self.say(&format!("!0 Err: {words}\n\r")),
            Err(Refusal::Unknown) => {
                let word: String = name.iter().copied().map(char::from).collect();
                let code: String = name.iter().map(|byte| format!("{byte:2X}")).collect();
                self.say(&format!("!8 Err: Unknown command '{word}:{code}'\r\n"));
            }
        }
    }

    fn command(&mut self, name: &[u8], of: &mut Parameters<'_>) -> Result<(), Refusal> {
        match name {
            b"V" => self.say("EBBv13_and_above EB Firmware Version 2.8.1\r\n"),
            b"R" => {
                let input = core::mem::take(&mut self.input);
                self.restart();
                self.input = input;
                self.ok();
            }
            b"RB" => self.restart(),
            b"BL" => {
                self.ok();
                self.is_in_bootloader = true;
            }
            b"CU" => self.configure(of)?,
            b"EM" => {
                let first = of.byte()?;
                // Without the second one the command does nothing, and says so neither.
                let Some(second) = of.optional(Kind::U8)? else { return Ok(()) };
                let second = u8::try_from(second).unwrap_or(u8::MAX);
                self.queue(Queued { work: Work::Enable([first, second]), delay_ticks: 0 });
            }
            b"SM" => {
                let duration_ms = of.long()?;
                let first = of.signed()?;
                let second = optional_steps(of)?;
                let clear = optional_clear(of)?;
                if self.checks_limits {
                    check_duration(duration_ms)?;
                    check_rate(1, duration_ms, first)?;
                    check_rate(2, duration_ms, second)?;
                }
                self.queue(constant(duration_ms, [first, second], clear));
            }
            b"XM" => {
                let duration_ms = of.long()?;
                let (a, b) = (of.signed()?, of.signed()?);
                let clear = optional_clear(of)?;
                check_duration(duration_ms)?;
                let motors = [a.saturating_add(b), a.saturating_sub(b)];
                let [first, second] = motors;
                check_rate(1, duration_ms, first)?;
                check_rate(2, duration_ms, second)?;
                self.queue(constant(duration_ms, motors, clear));
            }
            b"LM" => {
                let motors = [low_level(of)?, low_level(of)?];
                let clear = optional_clear(of)?;
                if motors.iter().all(MotorRate::is_at_rest) {
                    return Err(Wrong::Value.into());
                }
                self.queue(Queued { work: Work::Steps(LowLevelMove { motors, clear }), delay_ticks: 0 });
            }
            b"LT" => {
                let ticks = of.long()?;
                let motors = [timed(of)?, timed(of)?];
                let clear = optional_clear(of)?;
                if ticks == 0 || motors.iter().all(|motor| motor.rate == 0) {
                    return Err(Wrong::Value.into());
                }
                let work = Work::TimedSteps(ticks, LowLevelMove { motors, clear });
                self.queue(Queued { work, delay_ticks: 0 });
            }
            b"HM" => {
                let rate = of.long()?;
                let to = [optional_steps(of)?, optional_steps(of)?];
                if rate == 0 {
                    return Err(Wrong::Value.into());
                }
                self.left.extend([Left::Home(rate, to), Left::Ok]);
            }
            b"ES" => {
                let switches_off = of.optional(Kind::U8)? == Some(1);
                let found = self.motion.stop();
                if switches_off {
                    self.motion.enabled = [false; 2];
                }
                let ([waiting1, waiting2], [left1, left2]) = (found.waiting, found.left);
                let any = u8::from(found.any);
                self.say(&format!("{any},{waiting1},{waiting2},{left1},{left2}\n\r"));
                self.ok();
            }
            b"CS" => {
                self.motion.count_from_zero();
                self.ok();
            }
            b"SP" => {
                let up = of.byte()? > 0;
                let duration_ms = optional_ms(of)?;
                of.optional(Kind::U8)?; // the pin: there is one servo here
                self.queue_pen(if up { Pen::Up } else { Pen::Down }, duration_ms);
            }
            b"TP" => {
                let duration_ms = optional_ms(of)?;
                self.queue_pen(
                    if self.motion.servo.asked == Pen::Up { Pen::Down } else { Pen::Up },
                    duration_ms,
                );
            }
            b"S2" => self.servo_output(of)?,
            b"SC" => {
                let parameter = of.byte()?;
                let value = of.short()?;
                self.motion.servo.set(parameter.into(), value);
                self.ok();
            }
            b"SR" => {
                of.long()?;
                if let Some(state) = of.optional(Kind::U8)? {
                    self.servo_has_power = state > 0;
                }
                self.ok();
            }
            b"SE" => {
                of.byte()?;
                of.optional(Kind::U16)?;
                if of.optional(Kind::U8)?.is_some_and(|queued| queued > 0) {
                    self.queue(Queued::default());
                } else {
                    self.ok();
                }
            }
            b"PD" | b"PO" => self.pin(name, of)?,
            b"PI" => self.pin(name, of)?,
            b"ST" => {
                let text = of.text()?;
                self.nickname = text.iter().copied().take(MOST_NICKNAME).collect();
                self.ok();
            }
            b"SL" => {
                self.layer = of.byte()?;
                self.ok();
            }
            b"SN" => {
                self.nodes = of.long()?;
                self.ok();
            }
            b"NI" => {
                self.nodes = self.nodes.saturating_add(1).min(u32::MAX - 1);
                self.ok();
            }
            b"ND" => {
                self.nodes = self.nodes.saturating_sub(1);
                self.ok();
            }
            _ => self.query(name)?,
        }
        Ok(())
    }

    fn query(&mut self, name: &[u8]) -> Result<(), Refusal> {
        let answer = match name {
            b"QB" => format!("{}\r\n", u8::from(core::mem::take(&mut self.button_was_pressed))),
            b"QC" => {
                let supply = if self.has_motor_power { SUPPLY_READING } else { 0 };
                format!("{CURRENT_READING:04},{supply:04}\r\n")
            }
            b"QE" => {
                // 16 for sixteenths of a step to 1 for full steps.
                let parts = 32_u8 >> self.motion.step_mode.clamp(1, 5);
                let [first, second] = self.motion.enabled.map(|on| if on { parts } else { 0 });
                format!("{first},{second}\n\r")
            }
            b"QG" => {
                let [runs, first, second, waits] = self.motion.status();
                let up = self.motion.servo.asked == Pen::Up;
                let pressed = core::mem::take(&mut self.button_was_pressed);
                // The pins B2 and B5, bits 6 and 7, are low.
                let bits = [pressed, up, runs, first, second, waits];
                let byte = bits.iter().fold(0_u8, |byte, &bit| byte << 1 | u8::from(bit));
                self.say(&format!("{byte:02X}\r\n"));
                return Ok(());
            }
            b"QL" => format!("{:03}\r\n", self.layer),
            b"QM" => {
                let [runs, first, second, waits] = self.motion.status().map(u8::from);
                self.say(&format!("QM,{runs},{first},{second},{waits}\n\r"));
                return Ok(());
            }
            b"QN" => format!("{:010}\r\n", self.nodes),
            b"QP" => format!("{}\n\r", u8::from(self.motion.servo.asked == Pen::Up)),
            b"QR" => format!("{}\r\n", u8::from(self.servo_has_power)),
            b"QS" => {
                let [first, second] = self.motion.counted;
                format!("{first},{second}\n\r")
            }
            b"QT" => {
                let nickname = self.nickname.clone();
                self.left.push_back(Left::Say(nickname));
                String::from("\r\n")
            }
            _ => return Err(Refusal::Unknown),
        };
        self.say(&answer);
        self.ok();
        Ok(())
    }

    fn configure(&mut self, of: &mut Parameters<'_>) -> Result<(), Refusal> {
        let parameter = of.byte()?;
        let value = of.number(Kind::I16)?;
        let flag = match (parameter, value) {
            (1..=3, 0) => false,
            (1..=3, 1) => true,
            (1..=3, _) => {
                self.ok();
                return Err(Wrong::Value.into());
            }
            _ => {
                self.ok();
                return Ok(());
            }
        };
        match parameter {
            1 => self.says_ok = flag,
            2 => self.checks_limits = flag,
            _ => {} // a light
        }
        self.ok();
        Ok(())
    }

    /// S2: a servo at any output.
    fn servo_output(&mut self, of: &mut Parameters<'_>) -> Result<(), Refusal> {
        let position = optional_u16(of)?;
        let output = of.optional(Kind::U8)?.and_then(|pin| u8::try_from(pin).ok()).unwrap_or_default();
        let rate = optional_u16(of)?;
        let delay_ms = optional_ms(of)?;
        if output > MOST_OUTPUT {
            return Err(Wrong::Value.into());
        }
        match (position, output) {
            (0, _) => self.ok(), // its pulses end at once
            (_, PEN_OUTPUT) => {
                self.servo_has_power = true;
                self.queue(Queued::after_ms(Work::Servo { position, rate }, delay_ms));
            }
            _ => self.queue(Queued::after_ms(Work::OtherServo, delay_ms)),
        }
        Ok(())
    }

    /// PD, PO and PI: pins, of ports A to E.
    fn pin(&mut self, name: &[u8], of: &mut Parameters<'_>) -> Result<(), Refusal> {
        let &[port] = of.text()? else { return Err(Wrong::Value.into()) };
        let pin = of.byte()?;
        let port = usize::from(port.to_ascii_uppercase().wrapping_sub(b'A'));
        let (Some(outputs), 0..=7) = (self.outputs.get_mut(port), pin) else {
            return Err(Wrong::Value.into());
        };
        let bit = 1_u8 << pin;
        if name == b"PI" {
            let is_high = u8::from(*outputs & bit != 0);
            self.say(&format!("PI,{is_high}\r\n"));
            return Ok(());
        }
        match of.byte()? {
            0 if name == b"PO" => *outputs &= !bit,
            1 if name == b"PO" => *outputs |= bit,
            0 | 1 => {}
            _ => return Err(Wrong::Value.into()),
        }
        self.ok();
        Ok(())
    }

    fn queue_pen(&mut self, pen: Pen, duration_ms: u32) {
        let (position, rate) = self.motion.servo.way(pen);
        self.servo_has_power = true;
        self.queue(Queued::after_ms(Work::Servo { position, rate }, duration_ms));
    }

    fn queue(&mut self, command: Queued) {
        self.left.extend([Left::Queue(command), Left::Ok]);
    }

    fn ok(&mut self) {
        self.left.push_back(Left::Ok);
    }

    pub(super) fn say(&mut self, words: &str) {
        self.left.push_back(Left::Say(words.as_bytes().to_vec()));
    }

    /// The moves of HM from where the motors stand.
    pub(super) fn home(&self, rate: u32, to: [i32; 2]) -> Result<Vec<Queued>, String> {
        let mut way = [0; 2];
        for ((way, to), at) in way.iter_mut().zip(to).zip(self.motion.counted) {
            *way = to.saturating_sub(at);
        }
        let [first, second] = way.map(i32::unsigned_abs);
        if first.max(second) > MOST {
            return Err(String::from("steps to home larger than 16,777,215."));
        }
        let longer = usize::from(first <= second);
        if rate / 1_000 > FASTEST {
            return Err(format!("HM <axis{}> step rate > 25K steps/second.", longer + 1));
        }
        let ms = |steps: u32| {
            u32::try_from(u64::from(steps) * 1_000 / u64::from(rate.max(1))).unwrap_or(MOST).min(MOST)
        };
        let (long, short) = (first.max(second), first.min(second));
        let mut moves = Vec::new();
        if short != 0 && ms(long) / SLOWEST_MS >= short {
            // One motor has so few steps that it would be too slow: both make these first.
            let diagonal = way.map(|steps| steps.signum().saturating_mul(i32::try_from(short).unwrap_or(0)));
            moves.push(constant(ms(short), diagonal, 3));
            for (way, made) in way.iter_mut().zip(diagonal) {
                *way = way.saturating_sub(made);
            }
        }
        moves.push(constant(ms(long).max(SHORTEST_HOME_MS), way, 3));
        Ok(moves)
    }
}

/// A move at constant speeds; without steps it only takes its time.
fn constant(duration_ms: u32, steps: [i32; 2], clear: u8) -> Queued {
    if steps == [0; 2] {
        return Queued::after_ms(Work::Wait, duration_ms);
    }
    let motors = steps.map(|steps| MotorRate::constant(duration_ms, steps));
    Queued { work: Work::Steps(LowLevelMove { motors, clear }), delay_ticks: 0 }
}

fn low_level(of: &mut Parameters<'_>) -> Result<MotorRate, Wrong> {
    Ok(MotorRate { rate: of.long()?, steps: of.signed()?, accel: of.signed()? })
}

/// A motor of LT: the sign of its rate is the direction.
fn timed(of: &mut Parameters<'_>) -> Result<MotorRate, Wrong> {
    let rate = of.signed()?;
    Ok(MotorRate { rate: rate.unsigned_abs(), steps: rate.signum(), accel: of.signed()? })
}

fn optional_steps(of: &mut Parameters<'_>) -> Result<i32, Wrong> {
    Ok(of.optional(Kind::I32)?.and_then(|steps| i32::try_from(steps).ok()).unwrap_or_default())
}

fn optional_clear(of: &mut Parameters<'_>) -> Result<u8, Wrong> {
    Ok(of.optional(Kind::U8)?.and_then(|clear| u8::try_from(clear).ok()).unwrap_or_default().min(3))
}

fn optional_u16(of: &mut Parameters<'_>) -> Result<u16, Wrong> {
    Ok(of.optional(Kind::U16)?.and_then(|number| u16::try_from(number).ok()).unwrap_or_default())
}

fn optional_ms(of: &mut Parameters<'_>) -> Result<u32, Wrong> {
    optional_u16(of).map(u32::from)
}

fn check_duration(duration_ms: u32) -> Result<(), Refusal> {
    match duration_ms {
        0 => Err(Wrong::Value.into()),
        1..=MOST => Ok(()),
        _ => Err(Refusal::Said(String::from("<move_duration> larger than 16777215 ms."))),
    }
}

fn check_rate(axis: u8, duration_ms: u32, steps: i32) -> Result<(), Refusal> {
    let steps = steps.unsigned_abs();
    let refused = |words: &str| Err(Refusal::Said(format!("<axis{axis}> {words}")));
    if steps > MOST {
        return refused("larger than 16777215 steps.");
    }
    if steps / duration_ms.max(1) > FASTEST {
        return refused("step rate > 25K steps/second.");
    }
    if steps != 0 && duration_ms / SLOWEST_MS >= steps {
        return refused("step rate < 1.31Hz.");
    }
    Ok(())
}
