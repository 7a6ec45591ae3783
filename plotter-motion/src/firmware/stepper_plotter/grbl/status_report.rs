//! The answer to `?`.

use super::super::{Activity, Link, Percents, Status, settings::FULL_POWER};
use super::codes::{coordinates, placed};
use super::listing::BLOCKS;
use super::{Grbl, MOST_COMMANDS, Mode, Pens, REPORTS_WITHOUT_OFFSET};
#[cfg(feature = "third-motor")]
use crate::Axis;
use crate::decimal_text::{Plain, Thousandths, Whole};
use core::fmt;

impl<P: Pens> Grbl<P> {
    pub(super) fn tell_status(&mut self, status: &Status, link: &Link) {
        let state = Plain(match status.activity {
            _ if self.mode == Mode::Sleep => "Sleep",
            _ if self.alarm.is_some() => "Alarm",
            _ if self.mode == Mode::Check => "Check",
            Activity::Idle if self.is_jogging(status, link) => "Jog",
            Activity::Idle if !link.commands.is_empty() => "Run",
            Activity::Idle | Activity::Stopped => "Idle",
            Activity::Run => "Run",
            Activity::Jog => "Jog",
            Activity::Hold { stands: true } => "Hold:0",
            Activity::Hold { stands: false } => "Hold:1",
            Activity::Home => "Home",
        });
        #[cfg(not(feature = "third-motor"))]
        let at = coordinates(status.at.x, status.at.y);
        #[cfg(feature = "third-motor")]
        let at = coordinates(status.at.x, status.at.y, status.z_mm);
        // As Grbl counts: blocks that are not over, of the number that it reports, even if there is room for
        // more.
        let queued = link.commands.room().saturating_sub(MOST_COMMANDS).min(BLOCKS);
        let blocks = Whole(queued.saturating_sub(status.planned.into()) as u64);
        let bytes = Whole(self.rx.room() as u64);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast saturates")]
        let feed_mm_min = Whole(u64::from((status.speed_mm_s * 60.0 + 0.5) as u32));
        let power =
            (u32::from(status.laser) * u32::from(FULL_POWER) + u32::from(u16::MAX / 2)) / u32::from(u16::MAX);
        let power = Whole(power.into());
        #[cfg(feature = "third-motor")]
        let second = {
            let is_pressed = status.second_switches.lower || status.second_switches.upper;
            self.settings.second.filter(|_| is_pressed).map(|second| second.axis)
        };
        let pins = Pins {
            x: status.limits.x_min || status.limits.x_max,
            y: status.limits.y_min || status.limits.y_max,
            #[cfg(feature = "third-motor")]
            second,
            #[cfg(feature = "third-motor")]
            z: status.z_switches.lower || status.z_switches.upper,
        };
        let offset = self.offset();
        let overrides = self.overrides_told(status.percents, offset.0.is_some());
        self.out.line(placed!(
            "<{}|MPos:"(state),
            at,
            "|Bf:{},{}|FS:{},{}{}{}{}>"(blocks, bytes, feed_mm_min, power, pins, offset, overrides)
        ));
    }

    /// Overrides are told when they have changed, and every few reports, but not together with the offset.
    fn overrides_told(&mut self, percents: Percents, with_offset: bool) -> Told {
        if with_offset || self.reports_to_overrides > 0 {
            self.reports_to_overrides = self.reports_to_overrides.saturating_sub(1);
            return Told(None);
        }
        self.reports_to_overrides = REPORTS_WITHOUT_OFFSET;
        Told(Some(percents))
    }

    /// Offsets change seldom and are told every few reports.
    fn offset(&mut self) -> Offset {
        if self.reports_to_offset > 0 {
            self.reports_to_offset -= 1;
            return Offset(None);
        }
        self.reports_to_offset = REPORTS_WITHOUT_OFFSET;
        let offset = self.interpreter.modes().offset;
        #[cfg(not(feature = "third-motor"))]
        let offset = coordinates(offset.x, offset.y);
        #[cfg(feature = "third-motor")]
        let offset = {
            let system = self.interpreter.modes().system;
            coordinates(offset.x, offset.y, self.told_heights().map(|heights| heights.offset(system)))
        };
        Offset(Some(offset))
    }
}

/// `|Ov:`.
struct Told(Option<Percents>);

impl fmt::Display for Told {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |Percents { draw, travel, laser }| {
            let [draw, travel, laser] = [draw, travel, laser].map(|percent| Whole(percent.into()));
            write!(f, "|Ov:{draw},{travel},{laser}")
        })
    }
}

/// `|Pn:` and the axes with a pressed limit switch.
struct Pins {
    x: bool,
    y: bool,
    #[cfg(feature = "third-motor")]
    second: Option<Axis>,
    #[cfg(feature = "third-motor")]
    z: bool,
}

impl fmt::Display for Pins {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = (self.x, self.y);
        #[cfg(feature = "third-motor")]
        let (x, y) = (x || self.second == Some(Axis::X), y || self.second == Some(Axis::Y));
        match (x, y) {
            (false, false) => Ok(()),
            (true, false) => f.write_str("|Pn:X"),
            (false, true) => f.write_str("|Pn:Y"),
            (true, true) => f.write_str("|Pn:XY"),
        }?;
        #[cfg(feature = "third-motor")]
        if self.z {
            return f.write_str(if x || y { "Z" } else { "|Pn:Z" });
        }
        Ok(())
    }
}

/// `|WCO:`.
#[cfg(not(feature = "third-motor"))]
struct Offset(Option<(Thousandths, Thousandths)>);
#[cfg(feature = "third-motor")]
struct Offset(Option<(Thousandths, Thousandths, Thousandths)>);

impl fmt::Display for Offset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |offset| f.write_fmt(placed!("|WCO:"(), offset, ""())))
    }
}
