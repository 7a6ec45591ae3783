//! [`SessionSettings`]: how a session goes.

use super::progress::Plan;
use crate::PlotterSettings;
use core::time::Duration;
use plotter_motion::StepPoint;
use plotter_motion::protocol::{HostSettings, Resume};

/// What is spoken with the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LinkChoice {
    /// Frames, if the machine knows them, else digits. It is called when the drawing begins, at the origin.
    #[default]
    Auto,
    /// Ten digits a target, as published. The machine is not called.
    Digits,
    /// Frames; a machine that does not know them is refused.
    Frames,
}

/// How a session goes.
#[derive(Clone, Debug)]
pub struct SessionSettings {
    /// Scale and origin of the machine.
    pub plotter: PlotterSettings,
    /// Pause after each byte, 10 ms as published.
    pub byte_gap: Duration,
    /// Patience with the machine.
    pub host: HostSettings,
    /// How much the drawing is, if there is one.
    pub plan: Option<Plan>,
    /// Duty steps that are the whole supply, of both motors.
    pub pwm_steps: [u32; 2],
    /// What is spoken.
    pub link: LinkChoice,
    /// Number of a session of frames: one that the last host is not likely to have taken, such as the low
    /// bits of a clock.
    pub nonce: u16,
    /// Bits a second of the line.
    pub baud: u32,
    /// Where another host has left the drawing; its moves are all of them, from the first.
    pub resume: Option<Resume>,
    /// Greatest counts that a machine of targets reaches, where that is known.
    pub most: Option<StepPoint>,
    /// Least and greatest counts of the drawing on both axes, where they are known.
    pub bounds: Option<(StepPoint, StepPoint)>,
    /// Where the motors stand as the session begins, encoder counts.
    pub stands_at: StepPoint,
    /// Whether a held key is one long move that is ended when the key is let go, so that the machine's own
    /// ramp grows on it; else it is one short move after the other. Only a machine of digits has it.
    pub ramps: bool,
    /// Names of pens by their numbers, such as their colours.
    pub pens: Vec<(u8, String)>,
}

impl Default for SessionSettings {
    /// The semi-virtual gantry as published, nothing to draw.
    fn default() -> Self {
        Self {
            plotter: PlotterSettings::default(),
            byte_gap: Duration::from_millis(10),
            host: HostSettings::default(),
            plan: None,
            pwm_steps: [255; 2],
            link: LinkChoice::Auto,
            nonce: 1,
            baud: 256_000,
            resume: None,
            most: None,
            bounds: None,
            stands_at: StepPoint::default(),
            ramps: false,
            pens: Vec::new(),
        }
    }
}

/// What a person is told who is to put in a pen.
pub(super) fn pen_wanted(pens: &[(u8, String)], pen: u8) -> String {
    let name = pens.iter().find(|(number, _)| *number == pen);
    let name = name.map_or_else(String::new, |(_, name)| format!(" ({name})"));
    format!("pen {pen} is wanted{name}: put it in, then go on")
}
