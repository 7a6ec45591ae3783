//! [`AnyController`]: the controller of a machine, whichever it is.

use super::told::Told;
use super::{Controller, EdgeSource, LinkedController, LinkedMachine, MachineController, RecordingTraits};
use crate::log::{self, Header};
use core::fmt;
use plotter_motion::control::ChosenController;
use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
use plotter_motion::firmware::{
    Gantry, GantrySettings, LinkedGantry, MarkingBoard, MarkingBoardSettings, StepperPlotter,
};
use plotter_motion::protocol::LinkSettings;
use plotter_motion::{ControllerChoice, DriveChoice, KinematicsChoice, Machine, MachineConfig};
use std::path::Path;

/// The controllers of `plotter-motion`, as the header of a log and the description of a machine tell which.
///
/// | header | machine | controller |
/// |---|---|---|
/// | `controller` `marking-board` | none given | [`MarkingBoard`] with the published controller |
/// | `protocol` neither `digits` nor `link` | with one belt | [`MarkingBoard`] as the machine's description says |
/// | `protocol` `grbl` | steppers | [`StepperPlotter`], Grbl's language |
/// | other | steppers | [`StepperPlotter`], mDraw's language |
/// | `controller` `published` or `contouring` | none given | [`MachineController`] with that one |
/// | other | DC motors | [`MachineController`] as the machine's description says |
/// | `boot` | as of [`MachineController`] | [`LinkedController`]: a machine that spoke frames ([`LinkedMachine`]) |
///
/// ```
/// # use plotter_replay::{AnyController, Controller};
/// # use plotter_replay::log::Header;
/// let header = Header::new().with_text("protocol", "grbl").with_text("controller", "stepper-plotter");
/// assert!(AnyController::of(&header, None)?.makes_steps());
/// # Ok::<(), plotter_replay::ControllerError>(())
/// ```
#[derive(Debug)]
pub struct AnyController;

/// Why there is no controller for a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ControllerError {
    /// What is wrong.
    pub message: String,
}

impl AnyController {
    /// A new controller for the log of this name: of a machine that speaks frames in it, one that does so, too.
    ///
    /// # Errors
    ///
    /// [`ControllerError`] for a log that cannot be read, and as [`of`](Self::of).
    pub fn of_log(path: &Path, machine: Option<&Machine>) -> Result<Box<dyn Controller>, ControllerError> {
        let reader = log::open(path).map_err(error)?;
        let header = reader.header().clone();
        let mut traits = RecordingTraits::default();
        reader.filter_map(Result::ok).for_each(|record| traits.look(&record));
        Self::of_recording(&header, &traits, machine)
    }

    /// The same for a recording that was looked through. One of frames that has no edges is run on motors that were where it tells:
    /// how a controller leads them, it cannot show ([`EdgeSource::Messages`]).
    ///
    /// # Errors
    ///
    /// As [`of`](Self::of).
    pub fn of_recording(
        header: &Header,
        traits: &RecordingTraits,
        machine: Option<&Machine>,
    ) -> Result<Box<dyn Controller>, ControllerError> {
        let header = traits.header(header);
        if traits.settings(&header, false).edges != EdgeSource::Messages {
            return Self::of(&header, machine);
        }
        let machine = machine.map_or_else(|| preset(header.text("controller")), |machine| Ok(*machine))?;
        let boot = LinkedMachine::of_header(&header).map_or(0, |linked| linked.boot);
        let gantry = Gantry::with_settings(GantrySettings::of(&machine), Told::default());
        Ok(Box::new(LinkedGantry::<4, 64, Told>::new(gantry, boot, LinkSettings::default())))
    }

    /// A new controller for a log with this header; without a machine, for the preset that the header names.
    ///
    /// # Errors
    ///
    /// [`ControllerError`] for a name that is none.
    pub fn of(header: &Header, machine: Option<&Machine>) -> Result<Box<dyn Controller>, ControllerError> {
        let said = header.text("controller");
        let machine = match machine {
            Some(machine) => *machine,
            None => preset(said)?,
        };
        let has_line = matches!(header.text("protocol"), Some("digits" | "link"));
        if machine.config().kinematics.kind == KinematicsChoice::CoreXy && !has_line {
            let controller = ChosenController::of(&machine);
            return Ok(Box::new(MarkingBoard::new(MarkingBoardSettings::of(&machine), controller)));
        }
        Ok(match machine.config().drive {
            DriveChoice::Stepper => {
                let dialect =
                    if header.text("protocol") == Some("grbl") { Dialect::Grbl } else { Dialect::MDraw };
                let settings = StepperPlotterSettings::of(&machine, dialect);
                Box::new(StepperPlotter::new(settings).map_err(error)?)
            }
            _ => match LinkedMachine::of_header(header) {
                None => Box::new(MachineController::new(&machine)),
                Some(LinkedMachine { boot, window: 4, payload: 64 }) => {
                    Box::new(LinkedController::<4, 64>::new(&machine, boot))
                }
                Some(LinkedMachine { window, payload, .. }) => {
                    return Err(ControllerError {
                        message: format!(
                            "its machine takes {window} frames of {payload} bytes, and the one here takes 4 of 64: in a test, \
                             LinkedController::<{window}, {payload}> does what it did"
                        ),
                    });
                }
            },
        })
    }
}

fn preset(said: Option<&str>) -> Result<Machine, ControllerError> {
    let mut config = MachineConfig::default();
    match said {
        None => {}
        Some("published") => config.control.controller = ControllerChoice::Published,
        Some("contouring") => config.control.controller = ControllerChoice::Contouring,
        Some("stepper-plotter") => config = MachineConfig::stepper_plotter(),
        Some("marking-board") => {
            config = MachineConfig::marking_board();
            config.control.controller = ControllerChoice::Published;
        }
        Some(other) => {
            return Err(ControllerError {
                message: format!(
                    "header key controller: expected published, contouring, stepper-plotter or marking-board, found \
                     {other:?}; give the machine's description"
                ),
            });
        }
    }
    Machine::new(config).map_err(error)
}

fn error(error: impl fmt::Display) -> ControllerError {
    ControllerError { message: error.to_string() }
}

impl fmt::Display for ControllerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl core::error::Error for ControllerError {}
