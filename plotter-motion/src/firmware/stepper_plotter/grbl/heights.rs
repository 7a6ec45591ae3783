//! [`Heights`]: what the words of a line make of a third axis.

use crate::gcode::{Block, Modes, SYSTEMS};
use crate::planner::Keep as _;

use super::super::area::SLACK_MM;
use super::super::{Command, Link, Status, StepperPlotterSettings, ZAxis};
use super::codes::Code;
use super::{Grbl, Pens};
use crate::PlotOp;

/// Where the third axis is to be, and the origins that it is told from. What is kept of a text's x and y, the
/// interpreter keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heights {
    pub(super) at_mm: f64,
    origins: [f64; SYSTEMS as usize],
    shift: f64,
    homes: [f64; 2],
    /// The machine stands where its motors are, not where the last line has said.
    is_stale: bool,
}

impl Default for Heights {
    fn default() -> Self {
        Self { at_mm: 0.0, origins: [0.0; SYSTEMS as usize], shift: 0.0, homes: [0.0; 2], is_stale: true }
    }
}

/// The heights to which a line goes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Targets {
    /// At the end of its movement, or half way home.
    first_mm: Option<f64>,
    /// Home.
    home_mm: Option<f64>,
    goes_home: bool,
}

impl Targets {
    pub(super) fn is_any(&self) -> bool {
        self.first_mm.is_some() || self.home_mm.is_some()
    }

    fn within(&self, z: &ZAxis) -> bool {
        let slack_mm = f64::from(SLACK_MM);
        let fits = |mm: Option<f64>| mm.is_none_or(|mm| (-slack_mm..=z.travel_mm + slack_mm).contains(&mm));
        fits(self.first_mm) && fits(self.home_mm)
    }

    /// The height for the next of so many operations that go somewhere.
    fn next(&mut self, left: usize) -> Option<f64> {
        if self.goes_home && left == 1 {
            return self.home_mm.take();
        }
        self.first_mm.take()
    }
}

impl Heights {
    /// Takes the place of the motors where the last line was not carried out.
    pub(super) fn look(&mut self, status: &Status) {
        if core::mem::take(&mut self.is_stale) {
            self.at_mm = status.z_mm.unwrap_or(0.0);
        }
    }

    pub(super) fn stand_still(&mut self) {
        self.is_stale = true;
    }

    /// As after a reset: what `G92` has set is forgotten.
    pub(super) fn reset(&mut self) {
        self.shift = 0.0;
    }

    /// Forgets what `G10`, `G28.1`, `G30.1` and `G92` have set.
    pub(super) fn restore_origins(&mut self) {
        *self = Self { at_mm: self.at_mm, is_stale: self.is_stale, ..Self::default() };
    }

    pub(super) fn origin(&self, system: u8) -> f64 {
        self.origins.get(usize::from(system)).copied().unwrap_or_default()
    }

    pub(super) const fn home_place(&self, second: bool) -> f64 {
        let [first, other] = self.homes;
        if second { other } else { first }
    }

    pub(super) const fn shift(&self) -> f64 {
        self.shift
    }

    /// What is added to a coordinate.
    pub(super) fn offset(&self, system: u8) -> f64 {
        self.origin(system) + self.shift
    }

    /// Where a movement by hand goes.
    pub(super) fn jog_target(&self, block: &Block, modes: &Modes) -> Option<f64> {
        let modes = Modes {
            relative: if asks(block, 910) { true } else { !asks(block, 900) && modes.relative },
            inches: if asks(block, 200) { true } else { !asks(block, 210) && modes.inches },
            ..*modes
        };
        self.target(block, &modes)
    }

    fn target(&self, block: &Block, modes: &Modes) -> Option<f64> {
        let way = block.number(b'Z')? * modes.unit_mm();
        Some(if asks(block, 530) {
            way
        } else if modes.relative {
            self.at_mm + way
        } else {
            way + self.offset(modes.system) + modes.length_mm
        })
    }

    /// Carries out what a line says of z; `modes` hold with it.
    pub(super) fn carry_out(&mut self, block: &Block, modes: &Modes) -> Targets {
        let z = block.number(b'Z').map(|z| z * modes.unit_mm());
        let mut targets = Targets::default();
        if asks(block, 100) {
            let system = match block.number(b'P') {
                Some(number) if number >= 1.0 => crate::whole::whole(number - 1.0),
                _ => modes.system.into(),
            };
            let adds = block.number(b'L').is_some_and(|number| number > 2.0);
            let here = self.at_mm - self.shift - modes.length_mm;
            let slot = usize::try_from(system).ok().and_then(|system| self.origins.get_mut(system));
            if let (Some(z), Some(origin)) = (z, slot) {
                *origin = if adds { here - z } else { z };
            }
        } else if asks(block, 920) {
            if let Some(z) = z {
                self.shift = self.at_mm - self.origin(modes.system) - modes.length_mm - z;
            }
        } else if asks(block, 921) {
            self.shift = 0.0;
        } else if asks(block, 281) || asks(block, 301) {
            let [first, second] = &mut self.homes;
            *(if asks(block, 301) { second } else { first }) = self.at_mm;
        } else if asks(block, 280) || asks(block, 300) {
            let names_axes = block.words().iter().any(|word| matches!(word.letter, b'X' | b'Y' | b'Z'));
            targets.goes_home = true;
            targets.first_mm = self.target(block, modes);
            if z.is_some() || !names_axes {
                targets.home_mm = Some(self.home_place(asks(block, 300)));
            }
        } else if !asks(block, 431) {
            targets.first_mm = self.target(block, modes);
        }
        self.at_mm = targets.home_mm.or(targets.first_mm).unwrap_or(self.at_mm);
        targets
    }
}

/// The third axis, if the words of a line move it.
pub(super) fn told(settings: &StepperPlotterSettings) -> Option<ZAxis> {
    settings.z.filter(|z| z.pen.is_none())
}

fn asks(block: &Block, tenths: u16) -> bool {
    block.words().iter().any(|word| word.letter == b'G' && word.tenths() == Some(tenths))
}

impl<P: Pens> Grbl<P> {
    /// The third axis, if the words of a line move it.
    pub(super) fn z_axis(&self) -> Option<ZAxis> {
        told(&self.settings)
    }

    /// The height that a line has told last, where words move the axis.
    pub(super) fn told_heights(&self) -> Option<&Heights> {
        self.z_axis().and(self.heights.get())
    }

    /// Looks at what a line says of z.
    pub(super) fn targets(&mut self, block: &Block, before: &Modes, modes: &Modes) -> Result<Targets, Code> {
        if self.z_axis().is_none() {
            return Ok(Targets::default());
        }
        let Some(heights) = self.heights.get_mut() else { return Ok(Targets::default()) };
        let told_mm = heights.offset(before.system) + before.length_mm;
        let targets = heights.carry_out(block, modes);
        if (heights.offset(modes.system) + modes.length_mm).to_bits() != told_mm.to_bits() {
            self.reports_to_offset = 0; // the next report tells it
        }
        // The time of a line is reckoned from its way on the sheet.
        if targets.is_any() && modes.inverse_time && modes.motion != 0 {
            return Err(Code::UNSUPPORTED);
        }
        Ok(targets)
    }

    /// Whether all of them can be reached.
    pub(super) fn reaches(&self, targets: &Targets) -> bool {
        self.z_axis().is_none_or(|z| targets.within(&z))
    }

    /// Sends the height of an operation ahead of it; `left` operations that go somewhere are left.
    pub(super) fn send_height(&mut self, targets: &mut Targets, left: usize, link: &mut Link) {
        if let Some(height_mm) = targets.next(left) {
            self.command(link, Command::ToZ(height_mm));
        }
    }

    /// Sends what a line moves of z alone.
    pub(super) fn send_z_alone(&mut self, targets: Targets, modes: &Modes, link: &mut Link) {
        let to = modes.position;
        for height_mm in [targets.first_mm, targets.home_mm].into_iter().flatten() {
            let op = if modes.motion == 0 || targets.goes_home {
                PlotOp::Travel { to }
            } else {
                PlotOp::Draw { to, feed_mm_s: modes.feed_mm_s.map(super::block::no_slower) }
            };
            self.command(link, Command::ToZ(height_mm));
            self.command(link, Command::Plot(op));
        }
    }
}
