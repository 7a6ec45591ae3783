//! [`SessionSettings`]: how a session goes.

use super::progress::Plan;
use crate::PlotterSettings;
use core::time::Duration;
use plotter_motion::StepPoint;
use plotter_motion::protocol::{HostSettings, Resume};

/// What is spoken with the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
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
#[non_exhaustive]
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

impl SessionSettings {
    /// The same with another [`SessionSettings::plotter`].
    #[must_use]
    pub fn with_plotter(self, plotter: PlotterSettings) -> Self {
        Self { plotter, ..self }
    }

    /// The same with another [`SessionSettings::byte_gap`].
    #[must_use]
    pub fn with_byte_gap(self, byte_gap: Duration) -> Self {
        Self { byte_gap, ..self }
    }

    /// The same with another [`SessionSettings::host`].
    #[must_use]
    pub fn with_host(self, host: HostSettings) -> Self {
        Self { host, ..self }
    }

    /// The same with another [`SessionSettings::plan`].
    #[must_use]
    pub fn with_plan(self, plan: Option<Plan>) -> Self {
        Self { plan, ..self }
    }

    /// The same with another [`SessionSettings::pwm_steps`].
    #[must_use]
    pub fn with_pwm_steps(self, pwm_steps: [u32; 2]) -> Self {
        Self { pwm_steps, ..self }
    }

    /// The same with another [`SessionSettings::link`].
    #[must_use]
    pub fn with_link(self, link: LinkChoice) -> Self {
        Self { link, ..self }
    }

    /// The same with another [`SessionSettings::nonce`].
    #[must_use]
    pub fn with_nonce(self, nonce: u16) -> Self {
        Self { nonce, ..self }
    }

    /// The same with another [`SessionSettings::baud`].
    #[must_use]
    pub fn with_baud(self, baud: u32) -> Self {
        Self { baud, ..self }
    }

    /// The same with another [`SessionSettings::resume`].
    #[must_use]
    pub fn with_resume(self, resume: Option<Resume>) -> Self {
        Self { resume, ..self }
    }

    /// The same with another [`SessionSettings::most`].
    #[must_use]
    pub fn with_most(self, most: Option<StepPoint>) -> Self {
        Self { most, ..self }
    }

    /// The same with another [`SessionSettings::bounds`].
    #[must_use]
    pub fn with_bounds(self, bounds: Option<(StepPoint, StepPoint)>) -> Self {
        Self { bounds, ..self }
    }

    /// The same with another [`SessionSettings::stands_at`].
    #[must_use]
    pub fn with_stands_at(self, stands_at: StepPoint) -> Self {
        Self { stands_at, ..self }
    }

    /// The same with another [`SessionSettings::ramps`].
    #[must_use]
    pub fn with_ramps(self, ramps: bool) -> Self {
        Self { ramps, ..self }
    }

    /// The same with another [`SessionSettings::pens`].
    #[must_use]
    pub fn with_pens(self, pens: Vec<(u8, String)>) -> Self {
        Self { pens, ..self }
    }
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
