//! [`Listing`]: answers of many lines.

use super::super::output::Output;
use super::super::settings::FULL_POWER;
use super::super::{COMMANDS, Setting, StepperPlotterSettings};
use super::codes::coordinate;
use super::rx_buffer::RX_BYTES;
use super::{MOST_COMMANDS, OUTPUT};
use crate::decimal_text::{Decimals, Whole};
use crate::extremes::greater;
use crate::gcode::Modes;

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

/// Blocks that are free when nothing is queued.
pub(super) const BLOCKS: usize = COMMANDS - MOST_COMMANDS;

impl Listing {
    /// Writes a line of it; says whether there was one left.
    pub(super) fn line(
        self,
        index: u8,
        settings: &StepperPlotterSettings,
        modes: &Modes,
        out: &mut Output<OUTPUT>,
    ) -> bool {
        match self {
            Self::Settings => {
                let Some((number, value, is_whole)) = setting(index, settings) else { return false };
                if is_whole {
                    out.line(format_args!("${}={}", Whole(number.into()), Decimals::<0>(value)));
                } else {
                    out.line(format_args!("${}={}", Whole(number.into()), Decimals::<3>(value)));
                }
            }
            Self::Build => match index {
                0 => out.line(format_args!("[VER:1.1h.20190830:plotter-motion]")),
                1 => out.line(format_args!("[OPT:V,{},{}]", Whole(BLOCKS as u64), Whole(RX_BYTES as u64))),
                _ => return false,
            },
            Self::Startup => match index {
                0 | 1 => out.line(format_args!("$N{}=", Whole(index.into()))),
                _ => return false,
            },
            Self::Offsets => match index {
                0 => {
                    let (x, y) = (coordinate(modes.origin.x), coordinate(modes.origin.y));
                    out.line(format_args!("[G54:{x},{y},0.000]"));
                }
                1..=5 => out.line(format_args!("[G{}:0.000,0.000,0.000]", Whole(54 + u64::from(index)))),
                6 => out.line(format_args!("[G28:0.000,0.000,0.000]")),
                7 => out.line(format_args!("[G30:0.000,0.000,0.000]")),
                8 => {
                    let own = modes.offset + -modes.origin;
                    let (x, y) = (coordinate(own.x), coordinate(own.y));
                    out.line(format_args!("[G92:{x},{y},0.000]"));
                }
                9 => out.line(format_args!("[TLO:0.000]")),
                10 => out.line(format_args!("[PRB:0.000,0.000,0.000:0]")),
                _ => return false,
            },
        }
        true
    }
}

/// The settings as Grbl numbers them; those that this machine has no use for are what Grbl comes with.
fn setting(index: u8, settings: &StepperPlotterSettings) -> Option<(u8, f64, bool)> {
    let StepperPlotterSettings { planner, stored, home_x, .. } = settings;
    let whole = |number: u8, value: u32| (number, f64::from(value), true);
    let direction_mask = u32::from(stored.x_direction & 1) | u32::from(stored.y_direction & 1) << 1;
    let pulses_mm_min = |rate_hz: u32| f64::from(rate_hz) / settings.x_steps_per_mm * 60.0;
    let travel_mm_min = greater(planner.travel_speed_mm_s, planner.speed_mm_s) * 60.0;
    let pull_off_mm = f64::from(home_x.pull_off_steps) / settings.x_steps_per_mm;
    Some(match index {
        0 => whole(0, 10),
        1 => whole(1, 255), // the motors hold
        2 => whole(2, 0),
        3 => whole(3, direction_mask),
        4 => whole(4, 0),
        5 => whole(5, 0),
        6 => whole(6, 0),
        7 => whole(10, 3), // MPos and Bf
        8 => (11, planner.junction_deviation_mm, false),
        9 => (12, 0.002, false),
        10 => whole(13, 0),
        11 => whole(20, 1),
        12 => whole(21, 1),
        13 => whole(22, 1),
        14 => whole(23, 3), // towards smaller coordinates
        15 => (24, pulses_mm_min(home_x.slow_hz), false),
        16 => (25, pulses_mm_min(home_x.fast_hz), false),
        17 => whole(26, 0),
        18 => (27, pull_off_mm, false),
        19 => (30, FULL_POWER, true),
        20 => whole(31, 0),
        21 => whole(32, settings.laser.into()),
        22 => (100, settings.x_steps_per_mm, false),
        23 => (101, settings.y_steps_per_mm, false),
        24 => (102, 1.0, false),
        25 => (110, travel_mm_min, false),
        26 => (111, travel_mm_min, false),
        27 => (112, 1.0, false),
        28 => (120, planner.accel_mm_s2, false),
        29 => (121, planner.accel_mm_s2, false),
        30 => (122, 1.0, false),
        31 => (130, f64::from(stored.width_mm), false),
        32 => (131, f64::from(stored.height_mm), false),
        33 => (132, 1.0, false),
        _ => return None,
    })
}

/// Whether this is what the settings already say.
pub(super) fn is_listed(setting: Setting, settings: &StepperPlotterSettings) -> bool {
    /// Half of the last digit that is told.
    const ALIKE: f64 = 5e-4;
    (0..)
        .map_while(|index| self::setting(index, settings))
        .any(|(number, value, _)| number == setting.number && libm::fabs(value - setting.value) <= ALIKE)
}
