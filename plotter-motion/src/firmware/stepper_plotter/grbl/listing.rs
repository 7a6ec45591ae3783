//! [`Listing`]: answers of many lines.

use super::super::output::Output;
use super::super::settings::FULL_POWER;
use super::super::{COMMANDS, Setting, StartupLines, StepperPlotterSettings};
use super::codes::{coordinates, placed};
#[cfg(feature = "third-motor")]
use super::heights::Heights;
use super::rx_buffer::RX_BYTES;
use super::{MOST_COMMANDS, OUTPUT};
use crate::decimal_text::{Plain, Thousandths, Whole};
use crate::extremes::greater;
use crate::gcode::{LineInterpreter, SYSTEMS};

/// What is being listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Listing {
    /// `$$`.
    Settings,
    /// `$#`.
    Offsets,
    /// `$I`.
    Build,
    /// `$N`.
    Startup,
}

/// What a listing tells about.
pub(super) struct About<'a> {
    pub(super) settings: &'a StepperPlotterSettings,
    pub(super) interpreter: &'a LineInterpreter,
    #[cfg(feature = "third-motor")]
    pub(super) heights: Option<&'a Heights>,
    pub(super) lines: Option<&'a StartupLines>,
    /// Whether settings can be restored.
    pub(super) restores: bool,
}

/// Number of free blocks that is reported when nothing is queued: all commands of the queue but those that
/// one line may need.
pub(super) const BLOCKS: usize = COMMANDS - MOST_COMMANDS;

impl Listing {
    /// Writes one line of the listing. Says whether there was one left.
    pub(super) fn line(self, index: u8, about: &About<'_>, out: &mut Output<OUTPUT>) -> bool {
        let &About { settings, interpreter, lines, restores, .. } = about;
        match self {
            Self::Settings => {
                let Some((number, value, is_whole)) = setting(index, settings) else { return false };
                let (number, value) = (Whole(number.into()), Thousandths::of(value));
                if is_whole {
                    out.line(format_args!("${number}={}", value.trimmed()));
                } else {
                    out.line(format_args!("${number}={value}"));
                }
            }
            Self::Build => match index {
                0 => out.line(format_args!("[VER:1.1h.20190830:plotter-motion]")),
                // Variable spindle, origin where it was homed, both ends with switches; no settings restored
                // by $RST, where it is so; nothing stored by $I=, no wait for it.
                1 => out.line(format_args!(
                    "[OPT:VZT{}IEW,{},{}]",
                    Plain(if restores { "" } else { "*$" }),
                    Whole(BLOCKS as u64),
                    Whole(RX_BYTES as u64)
                )),
                _ => return false,
            },
            Self::Startup => match index {
                0 | 1 => {
                    let line = lines.map_or("", |lines| lines.get(index));
                    out.line(format_args!("$N{}={}", Whole(index.into()), Plain(line)));
                }
                _ => return false,
            },
            Self::Offsets => match index {
                0..SYSTEMS => {
                    let origin = interpreter.origin(index);
                    #[cfg(not(feature = "third-motor"))]
                    let origin = coordinates(origin.x, origin.y);
                    #[cfg(feature = "third-motor")]
                    let origin =
                        coordinates(origin.x, origin.y, about.heights.map(|heights| heights.origin(index)));
                    out.line(placed!("[G{}:"(Whole(54 + u64::from(index))), origin, "]"()));
                }
                SYSTEMS | 7 => {
                    let home = interpreter.home_place(index == 7);
                    #[cfg(not(feature = "third-motor"))]
                    let home = coordinates(home.x, home.y);
                    #[cfg(feature = "third-motor")]
                    let home = coordinates(
                        home.x,
                        home.y,
                        about.heights.map(|heights| heights.home_place(index == 7)),
                    );
                    out.line(placed!("[G{}:"(Plain(if index == 7 { "30" } else { "28" })), home, "]"()));
                }
                8 => {
                    let shift = interpreter.shift();
                    #[cfg(not(feature = "third-motor"))]
                    let shift = coordinates(shift.x, shift.y);
                    #[cfg(feature = "third-motor")]
                    let shift = coordinates(shift.x, shift.y, about.heights.map(Heights::shift));
                    out.line(placed!("[G92:"(), shift, "]"()));
                }
                9 => {
                    out.line(format_args!("[TLO:{}]", Thousandths::of(interpreter.modes().length_mm)));
                }
                10 => out.line(format_args!("[PRB:0.000,0.000,0.000:0]")),
                _ => return false,
            },
        }
        true
    }
}

/// The numbers of Grbl's settings. Settings without a use on this machine have the value that Grbl is
/// delivered with; the others have 0 here.
static NUMBERS: [(u8, u8); 34] = [
    (0, 10),
    (1, 255), // the motors hold
    (2, 0),
    (3, 0),
    (4, 0),
    (5, 0),
    (6, 0),
    (10, 3), // MPos and Bf
    (11, 0),
    (12, 0),
    (13, 0),
    (20, 1),
    (21, 1),
    (22, 0),
    (23, 3), // towards smaller coordinates
    (24, 0),
    (25, 0),
    (26, 0),
    (27, 0),
    (30, 0),
    (31, 0),
    (32, 0),
    (100, 0),
    (101, 0),
    (102, 1),
    (110, 0),
    (111, 0),
    (112, 1),
    (120, 0),
    (121, 0),
    (122, 1),
    (130, 0),
    (131, 0),
    (132, 1),
];

/// A setting with its number, and whether it is written as a whole number.
fn setting(index: u8, settings: &StepperPlotterSettings) -> Option<(u8, f64, bool)> {
    let StepperPlotterSettings { planner, stored, home_x, .. } = settings;
    let &(number, fixed) = NUMBERS.get(usize::from(index))?;
    let per_step = |count: u32, of_one: f64| f64::from(count) / settings.x_steps_per_mm * of_one;
    let whole = match number {
        3 => u16::from(stored.x_direction & 1) | u16::from(stored.y_direction & 1) << 1,
        22 => settings.homing.into(),
        30 => FULL_POWER,
        32 => settings.laser.into(),
        130 => stored.width_mm,
        131 => stored.height_mm,
        _ => fixed.into(),
    };
    let value = match number {
        11 => planner.junction_deviation_mm,
        12 => 0.002,
        24 => per_step(home_x.slow_hz, 60.0),
        25 => per_step(home_x.fast_hz, 60.0),
        27 => per_step(home_x.pull_off_steps, 1.0),
        100 => settings.x_steps_per_mm,
        101 => settings.y_steps_per_mm,
        110 | 111 => greater(planner.travel_speed_mm_s, planner.speed_mm_s) * 60.0,
        120 | 121 => *planner.clone().accel_of_motor(number == 121),
        #[cfg(feature = "third-motor")]
        102 | 112 | 122 | 132 if let Some(z) = settings.z => match number {
            102 => z.steps_per_mm,
            112 => z.speed_mm_s * 60.0,
            122 => z.accel_mm_s2,
            _ => z.travel_mm,
        },
        _ => f64::from(whole),
    };
    Some((number, value, !matches!(number, 11 | 12 | 24 | 25 | 27 | 100..)))
}

/// Whether the settings already have this value.
pub(super) fn is_listed(setting: Setting, settings: &StepperPlotterSettings) -> bool {
    /// Values nearer than this are alike: half of the last digit of a listing, which has three decimals.
    const ALIKE: f64 = 5e-4;
    (0..)
        .map_while(|index| self::setting(index, settings))
        .any(|(number, value, _)| number == setting.number && libm::fabs(value - setting.value) <= ALIKE)
}
