//! [`Detection`]: by which words a text lifts its pen, found out from the text.

use super::code::{Code, Group};
use super::line::Line;
use super::lines::Lines;
use super::machine::spindle_number;
use super::modes::MM_PER_INCH;
use super::{Block, DwellUnit, Error, LaserCommand, PenConvention, ReadOptions, ServoCommand, Words};

/// Greatest angle of a servo, degrees: what is more is a tone, or switches the servo off.
const MOST_DEG: f64 = 180.0;

/// A `G4 P` of this or more that is a whole number counts milliseconds: no pen waits for 20 s.
const LEAST_MILLIS: f64 = 20.0;

/// Most decimals that are looked for: millionths of a millimetre are below all that moves.
const MOST_DECIMALS: u8 = 6;

/// The places that a servo or an axis is told, and which of them it has when the pen must be up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Places {
    first: Option<f64>,
    now: Option<f64>,
    least: f64,
    most: f64,
    changes: u32,
    /// Where it was at the first `G0` across the sheet, and the least of all these places.
    at_rapid: Option<f64>,
    least_at_rapid: f64,
    /// Where it was when the pen first moved at all; not set if it had not been told a place then.
    at_move: Option<f64>,
    moved: bool,
}

impl Places {
    fn put(&mut self, place: f64) {
        if self.first.is_none() {
            (self.first, self.least, self.most) = (Some(place), place, place);
        }
        (self.least, self.most) = (self.least.min(place), self.most.max(place));
        if self.now != Some(place) {
            self.changes = self.changes.saturating_add(1);
        }
        self.now = Some(place);
    }

    fn go(&mut self, is_rapid: bool) {
        if !core::mem::replace(&mut self.moved, true) {
            self.at_move = self.now;
        }
        if let (true, Some(now)) = (is_rapid, self.now) {
            let least = if self.at_rapid.is_some() { self.least_at_rapid } else { now };
            self.least_at_rapid = least.min(now);
            self.at_rapid = self.at_rapid.or(self.now);
        }
    }

    /// The places up and down; `None` if it has always been in one place.
    fn up_and_down(&self) -> Option<(f64, f64)> {
        let farthest = |from: f64| if from - self.least > self.most - from { self.least } else { self.most };
        if self.least == self.most {
            return None;
        }
        match (self.at_rapid.or(self.at_move), self.first) {
            (Some(up), _) => Some((up, farthest(up))),
            (None, Some(down)) => Some((farthest(down), down)),
            (None, None) => None,
        }
    }
}

/// Movements across the sheet after each of `M3`, `M4` and `M5`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spindles {
    rapids: [u32; 3],
    others: [u32; 3],
    /// What was in force at the first movement, and what is now, counted from `M3`.
    first: Option<usize>,
    now: usize,
}

impl Spindles {
    /// Before the first word it is as after `M5`.
    const NONE: Self = Self { rapids: [0; 3], others: [0; 3], first: None, now: 2 };

    fn go(&mut self, is_rapid: bool) {
        self.first = self.first.or(Some(self.now));
        let counts = if is_rapid { &mut self.rapids } else { &mut self.others };
        if let Some(count) = counts.get_mut(self.now) {
            *count = count.saturating_add(1);
        }
    }

    /// Which of them lifts and which lowers, where it is not `M5` that lifts.
    fn up_and_down(&self) -> Option<PenConvention> {
        let most = |counts: [u32; 3]| (0..3).rev().max_by_key(|at| counts.get(*at).copied());
        let has_rapids = self.rapids.iter().any(|count| *count > 0);
        let others_but = |up: usize| {
            let mut others = self.others;
            if let Some(count) = others.get_mut(up) {
                *count = 0;
            }
            others
        };
        let (up, down) = if has_rapids {
            let (up, down) = (most(self.rapids)?, most(self.others)?);
            let is_clear = self.rapids.get(up) > self.rapids.get(down);
            (is_clear && self.others.get(down) > self.others.get(up)).then_some((up, down))?
        } else {
            // All of it by G1: a drawing begins and ends with the pen up.
            let up = self.first.filter(|first| *first == self.now)?;
            (up, most(others_but(up))?)
        };
        let number = |at: usize| u8::try_from(3 + at).unwrap_or(5);
        let draws = others_but(up).get(down).is_some_and(|count| *count > 0);
        (up != 2 && up != down && draws)
            .then(|| PenConvention::SpindleWords { up: number(up), down: number(down) })
    }
}

/// Finds out by which words a text lifts its pen: takes the text's lines, one after the other, in constant
/// memory.
///
/// The first of these rules that fits holds:
///
/// | the text has | it is |
/// |---|---|
/// | `M300 S…` up to 180 | [`ServoCommand::M300`] |
/// | `M280 S…` up to 180 | [`ServoCommand::M280`] |
/// | `M4 …` without a letter, above 0 | [`LaserCommand::M4`] |
/// | `M1 …` without a letter | [`ServoCommand::M1`] |
/// | two changes of Z or more, and as many as there are of the spindle | [`PenConvention::Height`], or [`ServoCommand::Z`] where the pen is never lower than it travels |
/// | `M3`, `M4` and `M5`, no `S` in lines that move, most of `G0` after `M3` or `M4` and most other movements after another of the three; or no `G0`, and `M3` or `M4` before the first movement and at the end | [`PenConvention::SpindleWords`] |
/// | `M4`; or `M3`, and `S` in lines that move, `S0` among others, or three numbers after `S` | [`LaserCommand::Spindle`] |
/// | `M3` with two numbers after `S`, and at most one `M5` | [`ServoCommand::M3`] |
/// | `M3` | [`PenConvention::Spindle`] |
/// | `M106` | [`LaserCommand::Fan`] |
/// | none of them | [`PenConvention::Motion`] |
///
/// A servo or a Z axis is up where it is at the first `G0` across the sheet, or else at the first movement;
/// if it had not been told a place by then, the first place it is told is down, and of heights the highest is
/// up. The other place is the one farthest from that; of heights, the lowest. `G53` tells no height. Heights
/// above and below 0 are told apart there, others half way between the lowest and the lowest `G0`.
///
/// The full power of a laser is 1000, as GRBL has it, or the greatest `S` if that is more; 255 for a fan and
/// for mDraw. `G4 P` counts milliseconds if every P is a whole number from 20 up, or 0.
///
/// ```
/// # use plotter_motion::gcode::{PenConvention, detect};
/// let text = b"G0 Z5\nG0 X10 Y10\nG1 Z-0.5 F300\nG1 X20\nG0 Z5\n";
/// assert_eq!(detect(text.iter().copied()), PenConvention::Height { threshold_mm: 0.0 });
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    motion: Code,
    unit_mm: f64,
    relative: bool,
    beeps: Places,
    servo: Places,
    degrees: Places,
    z: Places,
    spindle: Places,
    /// Greatest number after mDraw's `M4`.
    laser: f64,
    spindles: Spindles,
    spindle_on: bool,
    spindle_changes: u32,
    offs: u32,
    dynamic: bool,
    constant: bool,
    power_in_move: bool,
    no_power: bool,
    /// Two numbers after the spindle's `S` other than 0, and whether there were more.
    powers: [f64; 2],
    many_powers: bool,
    most_power: f64,
    fan: bool,
    dwells: bool,
    short_dwells: bool,
    /// 10 to the power of the most decimals of a coordinate so far, and the least digit, mm; 0 for none.
    scale: f64,
    digit_mm: f64,
}

impl Default for Detection {
    fn default() -> Self {
        Self::new()
    }
}

impl Detection {
    /// Before the first line.
    #[must_use]
    pub fn new() -> Self {
        let none = Places::default();
        Self {
            motion: Code::Rapid,
            unit_mm: 1.0,
            relative: false,
            beeps: none,
            servo: none,
            degrees: none,
            z: none,
            spindle: none,
            laser: 0.0,
            spindles: Spindles::NONE,
            spindle_on: false,
            spindle_changes: 0,
            offs: 0,
            dynamic: false,
            constant: false,
            power_in_move: false,
            no_power: false,
            powers: [0.0; 2],
            many_powers: false,
            most_power: 0.0,
            fan: false,
            dwells: false,
            short_dwells: false,
            scale: 1.0,
            digit_mm: 0.0,
        }
    }

    /// Detection from a whole program.
    pub fn from_bytes(bytes: impl IntoIterator<Item = u8>) -> Self {
        let (mut lines, mut detection) = (Lines::new(bytes.into_iter()), Self::new());
        while let Some(line) = lines.advance() {
            if line.is_ok() {
                detection.push(lines.block());
            }
            lines.clear();
        }
        detection
    }

    /// Takes the next line.
    pub fn push(&mut self, block: &Block) {
        let Ok(line) = Line::read::<Error>(block, Words::Any) else { return };
        if block.is_deleted() {
            return;
        }
        self.motion = line.of(Group::Motion).unwrap_or(self.motion);
        self.relative = line.chooses(Code::Relative, self.relative);
        self.unit_mm = if line.chooses(Code::Inches, self.unit_mm != 1.0) { MM_PER_INCH } else { 1.0 };
        let may_move = line.may_move() && self.motion != Code::NoMotion;
        let moves = may_move && line.has(b"XY");
        self.take_told(&line);
        if let (true, Some(z)) = (may_move && !line.is(Code::MachineCoordinates), line.number(b'Z')) {
            let z = z * self.unit_mm;
            self.z.put(if self.relative { self.z.now.unwrap_or_default() + z } else { z });
        }
        self.take_cycle(&line);
        self.take_spindle(&line, moves);
        if line.is(Code::Dwell)
            && let Some(time) = line.number(b'P').filter(|time| *time > 0.0)
        {
            self.dwells = true;
            self.short_dwells |= time < LEAST_MILLIS || libm::trunc(time) != time;
        }
        if moves {
            for number in [line.number(b'X'), line.number(b'Y')].into_iter().flatten() {
                self.take_digits(number);
            }
            let is_rapid = self.motion == Code::Rapid;
            self.spindles.go(is_rapid);
            for places in
                [&mut self.beeps, &mut self.servo, &mut self.degrees, &mut self.z, &mut self.spindle]
            {
                places.go(is_rapid);
            }
        }
    }

    /// A canned cycle goes down to Z and up to R in each place.
    fn take_cycle(&mut self, line: &Line<'_>) {
        let is_cycle = |word: &super::Word| {
            word.letter == b'G' && matches!(word.tenths(), Some(730 | 810 | 820 | 830 | 850..=890))
        };
        if self.motion == Code::NoMotion && line.undone.as_ref().is_some_and(is_cycle) {
            let now = self.z.now.unwrap_or_default();
            let from = |height: f64| if self.relative { height } else { 0.0 };
            let near = line.number(b'R').map_or(now, |number| from(now) + number * self.unit_mm);
            if let Some(number) = line.number(b'Z') {
                self.z.put(from(near) + number * self.unit_mm);
                self.z.put(near);
            }
        }
    }

    fn take_digits(&mut self, number: f64) {
        // The nearest float to a number of so many decimals is that whole number divided by the power of 10.
        let is_written = |scale: f64| libm::round(number * scale) / scale == number;
        let mut scale = self.scale;
        for _ in 0..MOST_DECIMALS {
            if is_written(scale) {
                break;
            }
            scale *= 10.0;
        }
        self.scale = scale.min(1e6);
        let digit_mm = self.unit_mm / self.scale;
        if self.scale > 1.0 && (self.digit_mm == 0.0 || digit_mm < self.digit_mm) {
            self.digit_mm = digit_mm;
        }
    }

    fn take_told(&mut self, line: &Line<'_>) {
        let angle = line.number(b'S').filter(|angle| (0.0..=MOST_DEG).contains(angle));
        match (line.of(Group::Told), angle) {
            (Some(Code::Beep), Some(angle)) => self.beeps.put(angle),
            (Some(Code::ServoAngle), Some(angle)) => self.servo.put(angle),
            (Some(Code::Degrees), _) => self.degrees.put(line.bare),
            (Some(Code::LaserPower), _) => self.laser = self.laser.max(line.bare),
            (Some(Code::FanOn), _) => self.fan = true,
            _ => {}
        }
    }

    fn take_spindle(&mut self, line: &Line<'_>, moves: bool) {
        if let Some(spindle) = line.of(Group::Spindle) {
            self.spindle_changes = self
                .spindle_changes
                .saturating_add(u32::from(self.spindle_on != (spindle != Code::SpindleOff)));
            self.spindle_on = spindle != Code::SpindleOff;
            self.spindles.now = usize::from(spindle_number(spindle).saturating_sub(3));
            self.dynamic |= spindle == Code::Dynamic;
            self.constant |= spindle == Code::Constant;
            self.offs = self.offs.saturating_add(u32::from(spindle == Code::SpindleOff));
        }
        let is_mine = line.of(Group::Told).is_none() && !line.is(Code::Dwell) && !line.owned();
        let Some(power) = line.number(b'S').filter(|_| is_mine) else { return };
        self.power_in_move |= moves;
        self.most_power = self.most_power.max(power);
        if power == 0.0 {
            self.no_power = true;
        } else {
            let [one, other] = self.powers;
            if one == 0.0 {
                self.powers = [power, other];
            } else if power != one && other == 0.0 {
                self.powers = [one, power];
            } else if power != one && power != other {
                self.many_powers = true;
            }
        }
        self.spindle.put(power);
    }

    /// The convention that the lines so far follow.
    #[must_use]
    pub fn pen(&self) -> PenConvention {
        let servo = |command, places: &Places, usual: (f64, f64)| {
            let (up, down) = places.up_and_down().unwrap_or(usual);
            PenConvention::Servo { command, up, down }
        };
        let [one, other] = self.powers;
        let spindle_laser = self.dynamic
            || (self.constant && (self.power_in_move || self.many_powers || (self.no_power && one != 0.0)));
        if self.beeps.first.is_some() {
            servo(ServoCommand::M300, &self.beeps, (50.0, 30.0))
        } else if self.servo.first.is_some() {
            servo(ServoCommand::M280, &self.servo, (90.0, 0.0))
        } else if self.laser > 0.0 {
            PenConvention::Laser { command: LaserCommand::M4, full: 255.0 }
        } else if self.degrees.first.is_some() {
            servo(ServoCommand::M1, &self.degrees, (160.0, 90.0))
        } else if self.z.changes >= 2 && self.z.changes >= self.spindle_changes {
            self.height()
        } else if let (Some(words), false) = (self.spindles.up_and_down(), self.power_in_move) {
            words
        } else if spindle_laser {
            PenConvention::Laser { command: LaserCommand::Spindle, full: self.most_power.max(1000.0) }
        } else if self.constant && other != 0.0 && self.offs <= 1 {
            servo(ServoCommand::M3, &self.spindle, (one, other))
        } else if self.constant {
            PenConvention::Spindle
        } else if self.fan {
            PenConvention::Laser { command: LaserCommand::Fan, full: 255.0 }
        } else {
            PenConvention::Motion
        }
    }

    /// The convention of a text that moves along Z.
    fn height(&self) -> PenConvention {
        let Places { least: down, most, .. } = self.z;
        let up = self.z.at_rapid.or(self.z.at_move).unwrap_or(most);
        if up <= down {
            // It never draws lower than it travels: these are no heights.
            let (up, down) = (up / self.unit_mm, most / self.unit_mm);
            return PenConvention::Servo { command: ServoCommand::Z, up, down };
        }
        let travel = if self.z.at_rapid.is_some() { self.z.least_at_rapid } else { up };
        let travel = if travel > down { travel } else { up };
        let threshold_mm = if travel > 0.0 && down <= 0.0 { 0.0 } else { 0.5 * (travel + down) };
        PenConvention::Height { threshold_mm }
    }

    /// What the last digit of its places is worth, mm: they are rounded to it. `None` if all are whole
    /// numbers, which say nothing of what was rounded.
    ///
    /// Zeros at the end do not count, so it is that of the place with most decimals.
    ///
    /// ```
    /// # use plotter_motion::gcode::Detection;
    /// let digit_mm = |text: &[u8]| Detection::from_bytes(text.iter().copied()).digit_mm();
    /// assert_eq!(digit_mm(b"G21\nG1 X10.5 Y20.123\nG1 X11 Y20.1\n"), Some(0.001));
    /// assert_eq!(digit_mm(b"G20\nG1 X1.25 Y2\n"), Some(0.254)); // hundredths of an inch
    /// assert_eq!(digit_mm(b"G1 X10 Y20 F1000.5\n"), None);
    /// ```
    #[must_use]
    pub fn digit_mm(&self) -> Option<f64> {
        (self.digit_mm > 0.0).then_some(self.digit_mm)
    }

    /// The options for reading the text again.
    #[must_use]
    pub fn options(&self) -> ReadOptions {
        let is_millis = self.dwells && !self.short_dwells;
        let dwell_unit = if is_millis { DwellUnit::Milliseconds } else { DwellUnit::Seconds };
        ReadOptions { pen: self.pen(), dwell_unit, ..ReadOptions::default() }
    }
}

/// By which words a text lifts its pen, by the rules of [`Detection`].
pub fn detect(bytes: impl IntoIterator<Item = u8>) -> PenConvention {
    Detection::from_bytes(bytes).pen()
}
