//! [`Code`]: what `G` and `M` words ask for.

use super::{Word, Words};

/// What a `G` or `M` word asks for. The upper half is its group: of each of the first [`EXCLUSIVE`] groups a
/// line has one word at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Code {
    Rapid = 0x00,
    Straight,
    Clockwise,
    CounterClockwise,
    /// A motion that is not carried out, such as drilling; or none, after `G80`.
    NoMotion,
    Dwell = 0x10,
    Home,
    Offset,
    NoOffset,
    /// `G10 L2`: where the origin of the work lies.
    Origin,
    /// `G10 L20`: what the coordinates here are.
    OriginHere,
    /// `G28.1`, `G30.1`: what `G28` and `G30` go to from here on.
    KeepHome,
    /// A command that is not carried out, and takes the words of the line.
    Other,
    Inches = 0x20,
    Millimetres,
    Relative = 0x30,
    Absolute,
    AbsoluteCentres = 0x40,
    RelativeCentres,
    /// `G17` to `G19`: in which plane arcs lie.
    Plane = 0x50,
    InverseTime = 0x60,
    FeedPerMinute,
    /// `G95`, which is not carried out.
    FeedPerRevolution,
    SpindleOff = 0x70,
    /// `M3`: also while the machine stands.
    Constant,
    /// `M4`: in proportion to the speed.
    Dynamic,
    /// `M0`, `M1`.
    Pause = 0x80,
    /// `M2`, `M30`.
    End,
    FanOn = 0x90,
    FanOff,
    /// `M300 S…`.
    Beep,
    /// `M280 S…`.
    ServoAngle,
    /// mDraw's `M1 …`.
    Degrees,
    /// mDraw's `M4 …`.
    LaserPower,
    ToolChange = 0xA0,
    /// `G54` to `G59`: which coordinates.
    System = 0xB0,
    MachineCoordinates = 0xC0,
    /// Nothing for a pen plotter to do; the other words of the line belong to it.
    QuietWithWords = 0xD0,
    /// Nothing for a pen plotter to do.
    Quiet = 0xE0,
    /// `G43.1`: how long the tool is.
    Length = 0xF0,
    /// `G49`: as long as none.
    NoLength,
}

/// The groups that a line is asked for as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Group {
    /// A way of moving. It holds until another one is asked for.
    Motion,
    /// An action with the words of its own line.
    Action,
    /// In which plane arcs lie.
    Plane = 5,
    /// Unit of `F`.
    Feed = 6,
    Spindle = 7,
    Stop = 8,
    /// A servo or a laser that is told a number.
    Told = 9,
    /// A coordinate system.
    System = 11,
    /// The length of a tool.
    Length = 15,
}

/// How many groups there are, and how many of them allow one word only.
pub(super) const GROUPS: usize = Code::Length.group() + 1;
pub(super) const EXCLUSIVE: usize = Code::System.group() + 1;

/// Words whose numbers lie from `first` to `last`, and the digits behind the point within `tenths`.
#[derive(Clone, Copy, Debug)]
struct Range {
    first: u16,
    last: u16,
    /// The first digit, and how many more.
    tenths: (u8, u8),
    code: Code,
}

const fn words(first: u16, last: u16, code: Code) -> Range {
    Range { first, last, tenths: (0, 0), code }
}

const fn one(number: u16, code: Code) -> Range {
    words(number, number, code)
}

const fn tenths(number: u16, first: u8, more: u8, code: Code) -> Range {
    Range { first: number, last: number, tenths: (first, more), code }
}

/// `G` words that GRBL knows: what is done.
static GENERAL: &[Range] = &[
    one(0, Code::Rapid),
    one(1, Code::Straight),
    one(2, Code::Clockwise),
    one(3, Code::CounterClockwise),
    one(80, Code::NoMotion),
    one(4, Code::Dwell),
    one(28, Code::Home),
    one(30, Code::Home),
    tenths(28, 1, 0, Code::KeepHome),
    tenths(30, 1, 0, Code::KeepHome),
    one(92, Code::Offset),
    tenths(92, 1, 0, Code::NoOffset),
    one(53, Code::MachineCoordinates),
    one(17, Code::Plane),
    one(20, Code::Inches),
    one(21, Code::Millimetres),
    one(90, Code::Absolute),
    one(91, Code::Relative),
    tenths(91, 1, 0, Code::RelativeCentres),
    one(93, Code::InverseTime),
    one(94, Code::FeedPerMinute),
    words(54, 59, Code::System),
    one(10, Code::Other),
    // Cancelling what was never on; path control.
    one(40, Code::Quiet),
    one(49, Code::Quiet),
    one(61, Code::Quiet),
];

/// Those that a small program leaves out.
static GENERAL_FURTHER: &[Range] =
    &[words(18, 19, Code::Plane), tenths(43, 1, 0, Code::Length), one(49, Code::NoLength)];

/// `G` words of other machines: what is done.
static GENERAL_OTHERS: &[Range] = &[
    words(18, 19, Code::Plane),
    tenths(92, 2, 0, Code::NoOffset),
    tenths(90, 1, 0, Code::AbsoluteCentres),
    // Cancelling what was never on; path control; what machines and lathes differ in.
    one(15, Code::Quiet),
    one(50, Code::Quiet),
    tenths(61, 1, 0, Code::Quiet),
    one(64, Code::Quiet),
    one(69, Code::Quiet),
    words(97, 99, Code::Quiet),
];

/// `G` words that are known, and not carried out; [`meaning`] says what they are.
static GENERAL_UNDONE: &[Range] = &[
    tenths(5, 0, 3, Code::NoMotion),
    tenths(33, 0, 1, Code::NoMotion),
    tenths(38, 2, 3, Code::NoMotion),
    one(73, Code::NoMotion),
    one(76, Code::NoMotion),
    words(81, 89, Code::NoMotion),
    tenths(59, 1, 2, Code::Quiet),
    one(29, Code::Other),
    tenths(92, 3, 0, Code::Other),
    one(95, Code::FeedPerRevolution),
    words(41, 43, Code::Quiet),
    tenths(43, 1, 0, Code::Other),
    one(51, Code::Other),
    one(68, Code::Other),
];

/// `M` words that GRBL knows, and the change of a pen: what is done.
static MISCELLANEOUS: &[Range] = &[
    one(0, Code::Pause),
    one(2, Code::End),
    one(30, Code::End),
    one(3, Code::Constant),
    one(4, Code::Dynamic),
    one(5, Code::SpindleOff),
    one(6, Code::ToolChange),
    // A pause if a switch says so, which GRBL has not; coolant.
    one(1, Code::Quiet),
    words(8, 9, Code::Quiet),
];

/// `M` words of other machines: what is done.
static MISCELLANEOUS_OTHERS: &[Range] = &[
    one(1, Code::Pause),
    one(106, Code::FanOn),
    one(107, Code::FanOff),
    one(280, Code::ServoAngle),
    one(300, Code::Beep),
    // Coolant, mDraw's questions, drives, overrides.
    one(7, Code::Quiet),
    words(10, 11, Code::Quiet),
    words(17, 18, Code::Quiet),
    words(48, 49, Code::Quiet),
    // What printers are told and asked about themselves.
    one(23, Code::QuietWithWords),
    words(82, 85, Code::QuietWithWords),
    one(92, Code::QuietWithWords),
    one(105, Code::QuietWithWords),
    words(110, 111, Code::QuietWithWords),
    words(114, 115, Code::QuietWithWords),
    words(117, 119, Code::QuietWithWords),
    words(201, 206, Code::QuietWithWords),
    one(211, Code::QuietWithWords),
    words(220, 221, Code::QuietWithWords),
    one(400, Code::QuietWithWords),
    words(500, 503, Code::QuietWithWords),
];

/// `M` words that are known, and not carried out.
static MISCELLANEOUS_UNDONE: &[Range] = &[
    one(19, Code::Quiet),
    one(42, Code::QuietWithWords),
    words(62, 68, Code::QuietWithWords),
    words(98, 99, Code::QuietWithWords),
    one(104, Code::QuietWithWords),
    one(109, Code::QuietWithWords),
    one(140, Code::QuietWithWords),
    one(190, Code::QuietWithWords),
    one(226, Code::QuietWithWords),
];

impl Code {
    /// What a `G` or `M` word with this number, times ten, asks for, and whether that is done. As tables: for
    /// a small processor they are a third of the decisions.
    pub(super) fn of(letter: u8, tenths: u16, known: Words) -> Option<(Self, bool)> {
        let is_general = letter == b'G';
        let (number, tenth) = (tenths / 10, tenths % 10);
        let fits = |range: &&Range| {
            let (first, more) = range.tenths;
            (range.first..=range.last).contains(&number)
                && u8::try_from(tenth).is_ok_and(|tenth| tenth.wrapping_sub(first) <= more)
        };
        let find = |ranges: &[Range]| ranges.iter().find(fits).map(|range| range.code);
        let of_grbl =
            || find(if is_general { GENERAL } else { MISCELLANEOUS }).map(|code| (code, code != Self::Other));
        if known.is_grbl() {
            let knows_further = is_general && known == Words::Grbl;
            let further = if knows_further { find(GENERAL_FURTHER) } else { None };
            return further.map(|code| (code, true)).or_else(of_grbl);
        }
        let others = find(if is_general { GENERAL_OTHERS } else { MISCELLANEOUS_OTHERS });
        let undone =
            || find(if is_general { GENERAL_UNDONE } else { MISCELLANEOUS_UNDONE }).map(|code| (code, false));
        others.map(|code| (code, true)).or_else(of_grbl).or_else(undone)
    }

    /// Its group, a number below [`GROUPS`].
    pub(super) const fn group(self) -> usize {
        (self as u8 >> 4) as usize
    }
}

/// What a word asks for that is not carried out.
pub(super) fn meaning(command: Word) -> &'static str {
    let tenths = command.tenths().unwrap_or_default();
    if command.letter == b'M' {
        return match tenths / 10 {
            0 | 1 | 226 => "pause",
            19 => "spindle orientation",
            42 | 62..=68 => "output pin",
            98 | 99 => "subprogram",
            _ => "temperature",
        };
    }
    match tenths {
        50..=53 => "spline",
        330 | 331 => "synchronized motion",
        382..=385 => "probe",
        100 | 591..=593 => "another coordinate system",
        290 => "bed levelling",
        923 => "restore the offset",
        950 => "feed rate per revolution",
        410 | 420 => "cutter compensation",
        430 | 431 => "tool length",
        510 => "scaling",
        680 => "rotation",
        _ => "canned cycle",
    }
}
