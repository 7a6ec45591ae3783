//! [`Act`]: what a person, or a mishap, does to a simulated machine.

use crate::log::SwitchName;
use core::fmt;
use core::str::FromStr;
use plotter_motion::Axis;

/// Something that is done to a simulated machine; as a text, the words that a script has.
///
/// | words | what happens |
/// |---|---|
/// | `press NAME`, `release NAME` | a switch is held pressed, and let go: `x-min` to `y-max`, or another that the log is to have |
/// | `cut x-min` | the wire of a limit switch is cut: it is never pressed again |
/// | `stop`, `free` | the emergency stop button is pressed, and released |
/// | `reset` | the button is pressed that lets the machine go on after an emergency stop |
/// | `restart` | the host opens the port anew |
/// | `hold x`, `let x` | the carriage is held, so that its motor loses every step; and let go |
/// | `lose x 64` | the carriage is pushed by so many steps |
/// | `paper 200 287` | a sheet of so many mm lies at the origin; `paper 0 0` takes it away |
///
/// ```
/// # use plotter_replay::simulation::Act;
/// # use plotter_motion::Axis;
/// assert_eq!("lose x -64".parse(), Ok(Act::Lose { axis: Axis::X, steps: -64 }));
/// assert!("explode".parse::<Act>().unwrap_err().to_string().contains("press NAME"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Act {
    /// A switch is held pressed.
    Press(SwitchName),
    /// It is let go: a limit switch is then as the carriage has it.
    Release(SwitchName),
    /// A limit switch is never pressed again.
    Cut(SwitchName),
    /// The emergency stop button.
    Button {
        /// Whether it is pressed.
        pressed: bool,
    },
    /// The button that lets the machine go on.
    Reset,
    /// The host opens the port anew.
    Restart,
    /// The carriage of an axis is held, or let go.
    Hold {
        /// Which.
        axis: Axis,
        /// Whether it is held.
        held: bool,
    },
    /// The carriage is pushed.
    Lose {
        /// Axis of the switch.
        axis: Axis,
        /// By so many steps.
        steps: i32,
    },
    /// A sheet of paper lies at the origin.
    Paper {
        /// To the right, mm.
        width_mm: f64,
        /// Up, mm.
        height_mm: f64,
    },
}

/// An act that is none, or not of this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ActError {
    /// The error message.
    pub message: String,
}

impl fmt::Display for ActError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl core::error::Error for ActError {}

const EXPECTED: &str = "expected press NAME, release NAME, cut NAME, stop, free, reset, restart, hold x, let x, \
                        lose x STEPS or paper WIDTH HEIGHT";

impl FromStr for Act {
    type Err = ActError;

    fn from_str(text: &str) -> Result<Self, ActError> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let wrong = || ActError { message: format!("{EXPECTED}, found {text:?}") };
        let name = |name: &str| SwitchName::new(name).map_err(|_| wrong());
        let axis = |axis: &str| match axis {
            "x" => Ok(Axis::X),
            "y" => Ok(Axis::Y),
            _ => Err(wrong()),
        };
        let length = |text: &str| text.parse().ok().filter(|mm| (0.0..=1e5).contains(mm)).ok_or_else(wrong);
        Ok(match *words {
            ["press", switch] => Self::Press(name(switch)?),
            ["release", switch] => Self::Release(name(switch)?),
            ["cut", switch] => Self::Cut(name(switch)?),
            ["stop"] => Self::Button { pressed: true },
            ["free"] => Self::Button { pressed: false },
            ["reset"] => Self::Reset,
            ["restart"] => Self::Restart,
            ["hold", which] => Self::Hold { axis: axis(which)?, held: true },
            ["let", which] => Self::Hold { axis: axis(which)?, held: false },
            ["lose", which, steps] => {
                let steps = steps.parse().ok().filter(|steps: &i32| steps.abs() <= 1_000_000);
                Self::Lose { axis: axis(which)?, steps: steps.ok_or_else(wrong)? }
            }
            ["paper", width, height] => Self::Paper { width_mm: length(width)?, height_mm: length(height)? },
            _ => return Err(wrong()),
        })
    }
}
