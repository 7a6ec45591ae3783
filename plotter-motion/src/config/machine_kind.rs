//! [`MachineKind`]: which motors a machine has, and how they move its pen.

use super::{ConfigError, Machine};
use core::fmt;

/// Which motors a machine has, and how they move its pen: what a program must know before it leads, simulates
/// or speaks with one.
///
/// A new kind is a breaking change on purpose: whoever matches on it must say what becomes of such a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MachineKind {
    /// Two DC motors with encoders, each of which moves an axis.
    Gantry,
    /// Two DC motors with encoders on one belt (`CoreXY`), each of which moves the pen along a diagonal.
    Belt,
    /// Two stepper motors, each of which moves an axis.
    Steppers,
}

impl MachineKind {
    /// The key of a machine's file that tells this kind from the others.
    const fn key(self) -> &'static str {
        match self {
            Self::Belt => "kinematics.type",
            Self::Gantry | Self::Steppers => "drive",
        }
    }

    /// What a machine's file says of this kind, and a preset that does.
    const fn in_a_file(self) -> (&'static str, &'static str) {
        match self {
            Self::Gantry => ("drive = \"dc\", kinematics.type = \"cartesian\"", "semi-virtual-gantry.toml"),
            Self::Belt => ("drive = \"dc\", kinematics.type = \"corexy\"", "marking-board.toml"),
            Self::Steppers => ("drive = \"stepper\"", "stepper-plotter.toml"),
        }
    }

    pub(super) const fn key_beside(self, wanted: Self) -> &'static str {
        match (self, wanted) {
            (Self::Gantry, Self::Belt) => Self::Belt.key(),
            _ => self.key(),
        }
    }

    pub(super) fn write_refusal(self, wanted: Self, user: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((found_keys, _), (wanted_keys, preset)) = (self.in_a_file(), wanted.in_a_file());
        write!(
            f,
            "this machine has {self} ({found_keys}), and {user} needs {wanted}: take one with {wanted_keys}, as \
             examples/machines/{preset}"
        )
    }
}

impl fmt::Display for MachineKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Gantry => "DC motors that each move an axis",
            Self::Belt => "DC motors on one belt",
            Self::Steppers => "stepper motors",
        })
    }
}

impl Machine {
    /// Kind of the machine, by its motors and how they move the pen.
    #[must_use]
    pub const fn kind(&self) -> MachineKind {
        self.config().drive.kind()
    }

    /// Refuses a machine of another kind than `wanted`. Whoever builds on one kind asks this first, or for
    /// its motors by [`Machine::gantry`], [`Machine::belt`] or [`Machine::steppers`]: settings that are made
    /// `of` a machine of another kind are those of the documented machine of their own.
    ///
    /// `user` is what needs that kind, for the message.
    ///
    /// # Errors
    ///
    /// [`ConfigError::OtherKind`].
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig, config::MachineKind};
    /// let board = Machine::new(MachineConfig::marking_board())?;
    /// assert_eq!(board.kind(), MachineKind::Belt);
    /// let refused = board.require(MachineKind::Gantry, "live").unwrap_err();
    /// assert_eq!(
    ///     refused.to_string(),
    ///     "this machine has DC motors on one belt (drive = \"dc\", kinematics.type = \"corexy\"), and live needs DC motors that \
    ///      each move an axis: take one with drive = \"dc\", kinematics.type = \"cartesian\", as \
    ///      examples/machines/semi-virtual-gantry.toml"
    /// );
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    pub fn require(&self, wanted: MachineKind, user: &'static str) -> Result<(), ConfigError> {
        match self.kind() {
            found if found == wanted => Ok(()),
            found => Err(ConfigError::OtherKind { found, wanted, user }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MachineConfig;
    use std::string::ToString;

    fn refused(config: MachineConfig, wanted: MachineKind) -> Option<(&'static str, std::string::String)> {
        let machine = Machine::new(config).unwrap();
        machine.require(wanted, "this test").err().map(|error| (error.key(), error.to_string()))
    }

    #[test]
    fn each_preset_is_of_one_kind_and_refused_as_any_other() {
        let presets = [
            (MachineConfig::default(), MachineKind::Gantry),
            (MachineConfig::marking_board(), MachineKind::Belt),
            (MachineConfig::stepper_plotter(), MachineKind::Steppers),
            (MachineConfig::textile_plotter(), MachineKind::Steppers),
        ];
        for (config, kind) in presets {
            for wanted in [MachineKind::Gantry, MachineKind::Belt, MachineKind::Steppers] {
                assert_eq!(refused(config, wanted).is_none(), wanted == kind, "{kind:?} {wanted:?}");
            }
        }
    }

    #[test]
    fn a_refusal_says_what_there_is_what_is_needed_and_where_to_get_it() {
        let (key, text) = refused(MachineConfig::stepper_plotter(), MachineKind::Belt).unwrap();
        assert_eq!(key, "drive");
        assert_eq!(
            text,
            "this machine has stepper motors (drive = \"stepper\"), and this test needs DC motors on one belt: take one with \
             drive = \"dc\", kinematics.type = \"corexy\", as examples/machines/marking-board.toml"
        );
        assert_eq!(refused(MachineConfig::default(), MachineKind::Belt).unwrap().0, "kinematics.type");
        assert_eq!(
            refused(MachineConfig::marking_board(), MachineKind::Gantry).unwrap().0,
            "kinematics.type"
        );
        assert_eq!(refused(MachineConfig::default(), MachineKind::Steppers).unwrap().0, "drive");
    }
}
