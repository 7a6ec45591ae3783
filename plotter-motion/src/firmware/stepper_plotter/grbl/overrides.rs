//! [`Overrides`]: shares of speeds and of the laser's power that a person sets while the machine draws, by
//! single bytes.

use super::super::{Percents, Signal};

/// The shares that a person has asked for.
///
/// Source: the Grbl project's wiki, "Grbl v1.1 Commands", on extended-ASCII realtime commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Overrides(Percents);

/// Least and greatest share of feeds and of the laser's power, in percent: those of Grbl 1.1.
const LEAST: u8 = 10;
const MOST: u8 = 200;

impl Overrides {
    /// Takes a byte. If it is an override, gives the signal for the motion side.
    pub(super) fn take(&mut self, byte: u8) -> Option<Signal> {
        let Percents { draw, travel, laser } = &mut self.0;
        match byte {
            0x90..=0x94 => *draw = changed(*draw, byte - 0x90),
            0x95 => *travel = 100,
            0x96 => *travel = 50,
            0x97 => *travel = 25,
            0x99..=0x9D => {
                *laser = changed(*laser, byte - 0x99);
                return Some(Signal::LaserPercent(*laser));
            }
            // 0x9E stops the laser while the machine is held. Here the laser is dark then anyway.
            _ => return None,
        }
        Some(Signal::Speeds { draw_percent: *draw, travel_percent: *travel })
    }
}

/// The share set back to 100, or changed by 10 or 1.
fn changed(percent: u8, how: u8) -> u8 {
    let percent = match how {
        0 => 100,
        1 => percent.saturating_add(10),
        2 => percent.saturating_sub(10),
        3 => percent.saturating_add(1),
        _ => percent.saturating_sub(1),
    };
    percent.clamp(LEAST, MOST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_stay_between_10_and_200_percent() {
        let mut overrides = Overrides::default();
        for _ in 0..20 {
            overrides.take(0x91);
            overrides.take(0x9B);
        }
        assert_eq!((overrides.0.draw, overrides.0.laser), (200, 10));
        overrides.take(0x94);
        assert_eq!(overrides.take(0x97), Some(Signal::Speeds { draw_percent: 199, travel_percent: 25 }));
        overrides.take(0x90);
        assert_eq!(overrides.take(0x99), Some(Signal::LaserPercent(100)));
        assert_eq!((overrides.0.draw, overrides.0.travel), (100, 25));
        assert_eq!(overrides.take(0x98), None);
    }
}
