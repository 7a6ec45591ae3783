//! [`AnyController`]: the controller of a machine, whichever it is.

use super::fronts::{Hpgl, Marlin};
use super::machine::gate;
use super::told::Told;
use super::{
    AnsweringBoard, Controller, EbbBoard, EdgeSource, LinkedController, LinkedMachine, MachineController,
    RecordingTraits,
};
use crate::log::{self, Header};
use core::fmt;
use core::time::Duration;
use plotter_motion::control::ChosenController;
use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
use plotter_motion::firmware::{Gantry, GantrySettings, LinkedGantry, MarkingBoard, StepperPlotter};
use plotter_motion::protocol::LinkSettings;
use plotter_motion::{
    Machine, MachineConfig,
    config::{ControllerChoice, MachineKind},
};
use std::path::Path;

/// The controllers of `plotter-motion`, as the header of a log and the description of a machine tell which.
///
/// | header | machine | controller |
/// |---|---|---|
/// | `controller` `marking-board` | none given | [`MarkingBoard`] with the published controller |
/// | other | with one belt | [`MarkingBoard`] as the machine's description says |
/// | `protocol` `grbl` | steppers | [`StepperPlotter`], Grbl's language |
/// | `protocol` `marlin` | steppers | the same behind a front that answers as Marlin 2.1 |
/// | `protocol` `hpgl` | steppers | the same behind a front that answers as a 7475A on a serial line |
/// | `protocol` `ebb` | steppers | [`EbbBoard`] |
/// | other | steppers | [`StepperPlotter`], mDraw's language |
/// | `controller` `published` or `contouring` | none given | [`MachineController`] with that one |
/// | other | DC motors | [`MachineController`] as the machine's description says |
/// | `boot` | as of [`MachineController`] | [`LinkedController`]: a machine that spoke frames ([`LinkedMachine`]) |
///
/// A machine that does not speak the header's `protocol` is refused: DC motors that each move an axis speak
/// `digits` and `link`, a belt `counts`, steppers `grbl`, `mdraw`, `marlin`, `hpgl` and `ebb`.
///
/// ```
/// # use plotter_replay::{AnyController, Controller};
/// # use plotter_replay::log::Header;
/// let header = Header::new().with_text("protocol", "grbl").with_text("controller", "stepper-plotter");
/// assert!(AnyController::for_header(&header, None)?.makes_steps());
/// # Ok::<(), plotter_replay::player::ControllerError>(())
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
    /// A new controller for the log of this name: of a machine that speaks frames in it, one that does so,
    /// too.
    ///
    /// # Errors
    ///
    /// [`ControllerError`] for a log that cannot be read, and as [`for_header`](Self::for_header).
    pub fn for_log(path: &Path, machine: Option<&Machine>) -> Result<Box<dyn Controller>, ControllerError> {
        let reader = log::open(path).map_err(error)?;
        let header = reader.header().clone();
        let mut traits = RecordingTraits::default();
        reader.filter_map(Result::ok).for_each(|record| traits.look(&record));
        Self::for_recording(&header, &traits, machine)
    }

    /// The same for a recording that was looked through. One of frames that has no edges is run on motors
    /// that were where it tells: how a controller leads them, it cannot show ([`EdgeSource::Messages`]).
    ///
    /// # Errors
    ///
    /// As [`for_header`](Self::for_header).
    pub fn for_recording(
        header: &Header,
        traits: &RecordingTraits,
        machine: Option<&Machine>,
    ) -> Result<Box<dyn Controller>, ControllerError> {
        let header = traits.header(header);
        if traits.settings(&header, false).edges != EdgeSource::Messages {
            let mut controller = Self::for_header(&header, machine)?;
            if header.text("protocol") == Some("grbl") && traits.is_greeted_before() {
                // It was on before the log began, and has said its greeting.
                while controller.transmit_at(Duration::ZERO).is_some() {}
            }
            return Ok(controller);
        }
        let machine = machine_of(&header, machine)?;
        let boot = LinkedMachine::of_header(&header).map_or(0, |linked| linked.boot);
        let gantry = Gantry::with_settings(GantrySettings::of(&machine), Told::default(), gate());
        Ok(Box::new(LinkedGantry::<4, 64, Told>::new(gantry, boot, LinkSettings::default())))
    }

    /// Which preset's controller a header means: the one that it names, or the one that speaks its protocol.
    ///
    /// ```
    /// # use plotter_replay::{AnyController, log::Header};
    /// let header = Header::new().with_text("protocol", "grbl");
    /// assert_eq!(AnyController::named(&header), Some("stepper-plotter"));
    /// assert_eq!(AnyController::named(&Header::new()), None); // the semi-virtual gantry as it is here
    /// ```
    #[must_use]
    pub fn named(header: &Header) -> Option<&str> {
        header.text("controller").or_else(|| match header.text("protocol") {
            Some("grbl" | "mdraw" | "marlin" | "hpgl" | "ebb") => Some("stepper-plotter"),
            Some("counts") => Some("marking-board"),
            _ => None,
        })
    }

    /// A new controller for a log with this header; without a machine, for the preset that the header names.
    ///
    /// # Errors
    ///
    /// [`ControllerError`] for a name that is none, or a machine that does not speak the log's protocol.
    pub fn for_header(
        header: &Header,
        machine: Option<&Machine>,
    ) -> Result<Box<dyn Controller>, ControllerError> {
        let machine = machine_of(header, machine)?;
        Ok(match machine.kind() {
            MachineKind::Belt if header.text("protocol") == Some("counts") => {
                Box::new(AnsweringBoard::new(&machine))
            }
            MachineKind::Belt => Box::new(MarkingBoard::<ChosenController>::of(&machine, gate())),
            MachineKind::Steppers if header.text("protocol") == Some("marlin") => {
                Box::new(Marlin::new(&machine)?)
            }
            MachineKind::Steppers if header.text("protocol") == Some("hpgl") => {
                Box::new(Hpgl::new(&machine)?)
            }
            MachineKind::Steppers if header.text("protocol") == Some("ebb") => {
                Box::new(EbbBoard::switched_on())
            }
            MachineKind::Steppers => {
                let dialect =
                    if header.text("protocol") == Some("grbl") { Dialect::Grbl } else { Dialect::MDraw };
                let settings = StepperPlotterSettings::of(&machine, dialect);
                Box::new(StepperPlotter::new(settings, gate()).map_err(error)?)
            }
            MachineKind::Gantry => match LinkedMachine::of_header(header) {
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

/// The machine whose controller made a log: as described, or the preset that the header names. One that does
/// not speak the log's protocol is refused.
fn machine_of(header: &Header, machine: Option<&Machine>) -> Result<Machine, ControllerError> {
    let machine = machine.map_or_else(|| preset(AnyController::named(header)), |machine| Ok(*machine))?;
    let spoken_by = match header.text("protocol") {
        Some("digits") => Some((MachineKind::Gantry, "a log of the protocol \"digits\"")),
        Some("link") => Some((MachineKind::Gantry, "a log of the protocol \"link\"")),
        Some("counts") => Some((MachineKind::Belt, "a log of the protocol \"counts\"")),
        Some("grbl") => Some((MachineKind::Steppers, "a log of the protocol \"grbl\"")),
        Some("mdraw") => Some((MachineKind::Steppers, "a log of the protocol \"mdraw\"")),
        Some("marlin") => Some((MachineKind::Steppers, "a log of the protocol \"marlin\"")),
        Some("hpgl") => Some((MachineKind::Steppers, "a log of the protocol \"hpgl\"")),
        Some("ebb") => Some((MachineKind::Steppers, "a log of the protocol \"ebb\"")),
        None | Some("messages") => None,
        Some(other) => {
            return Err(ControllerError {
                message: format!("its protocol is {other:?}, and no controller here speaks that"),
            });
        }
    };
    spoken_by.map_or(Ok(()), |(kind, log)| machine.require(kind, log)).map_err(error)?;
    Ok(machine)
}

fn preset(said: Option<&str>) -> Result<Machine, ControllerError> {
    let mut config = MachineConfig::default();
    let controller = match said {
        None => None,
        Some("published") => Some(ControllerChoice::Published),
        Some("contouring") => Some(ControllerChoice::Contouring),
        Some("stepper-plotter") => {
            config = MachineConfig::stepper_plotter();
            None
        }
        Some("marking-board") => {
            config = MachineConfig::marking_board();
            Some(ControllerChoice::Published)
        }
        Some(other) => {
            return Err(ControllerError {
                message: format!(
                    "header key controller: expected published, contouring, stepper-plotter or marking-board, found \
                     {other:?}; give the machine's description"
                ),
            });
        }
    };
    if let (Some(dc), Some(controller)) = (config.dc_mut(), controller) {
        dc.control.controller = controller;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(protocol: &str, config: MachineConfig) -> Option<String> {
        let header = Header::new().with_text("protocol", protocol);
        let machine = Machine::new(config).unwrap();
        AnyController::for_header(&header, Some(&machine)).err().map(|error| error.message)
    }

    #[test]
    fn a_machine_that_does_not_speak_the_protocol_of_a_log_is_not_run_on_it() {
        let (gantry, belt, steppers) =
            (MachineConfig::default(), MachineConfig::marking_board(), MachineConfig::stepper_plotter());
        for (protocol, speaks) in [
            ("digits", MachineKind::Gantry),
            ("link", MachineKind::Gantry),
            ("counts", MachineKind::Belt),
            ("grbl", MachineKind::Steppers),
            ("mdraw", MachineKind::Steppers),
            ("marlin", MachineKind::Steppers),
            ("hpgl", MachineKind::Steppers),
        ] {
            for config in [gantry, belt, steppers] {
                let kind = Machine::new(config).unwrap().kind();
                let said = refusal(protocol, config);
                assert_eq!(said.is_none(), kind == speaks, "{protocol} {kind}: {said:?}");
            }
        }
        assert_eq!(
            refusal("digits", belt).unwrap(),
            "this machine has DC motors on one belt (drive = \"dc\", kinematics.type = \"corexy\"), and a log of the protocol \
             \"digits\" needs DC motors that each move an axis: take one with drive = \"dc\", kinematics.type = \"cartesian\", as \
             examples/machines/semi-virtual-gantry.toml"
        );
        // Nor is one whose motors were where its messages tell, which reads nothing of the machine but its
        // area.
        let header = Header::new().with_text("protocol", "link");
        let belt = Machine::new(belt).unwrap();
        let refused = AnyController::for_recording(&header, &RecordingTraits::default(), Some(&belt));
        assert!(refused.is_err());
    }
}
