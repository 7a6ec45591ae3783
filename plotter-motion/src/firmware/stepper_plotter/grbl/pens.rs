//! [`Pens`]: by which words hosts may lift the pen.

use super::super::StepperPlotterSettings;
use crate::gcode::{BlockDelete, DwellUnit, LaserCommand, PenConvention, ReadOptions, ServoCommand, Words};
use crate::planner::{Here, Keep, Nowhere, Part};
use core::time::Duration;

/// The words by which hosts may lift the pen, and with them how much of Grbl is built in: [`AnyPen`], or
/// [`SpindlePen`] for a small program. A line that both understand is carried out alike.
///
/// No other crate can implement this trait.
pub trait Pens: sealed::Sealed {
    /// Memory that only a whole Grbl needs: start-up lines, and the settings to restore.
    #[doc(hidden)]
    type Kept<T: Part>: Keep<T>;

    /// Whether these settings ask for no other words.
    #[doc(hidden)]
    fn fit(settings: &StepperPlotterSettings) -> bool;

    /// Reads with the options that these settings ask for.
    #[doc(hidden)]
    fn read<R>(settings: &StepperPlotterSettings, read: impl FnOnce(&ReadOptions) -> R) -> R;
}

/// All words and a laser, as [`StepperPlotterSettings`] choose, and all of Grbl that a plotter can do:
/// start-up lines, `$RST=$` and `$RST=*`, arcs in other planes, `G43.1`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct AnyPen;

/// `M3` and `M5` ([`PenConvention::Spindle`]) and no laser. A line that needs more of Grbl, which only
/// [`AnyPen`] has, is answered by `error:20` or `error:3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SpindlePen;

mod sealed {
    pub trait Sealed: Clone + core::fmt::Debug + PartialEq {}
    impl Sealed for super::AnyPen {}
    impl Sealed for super::SpindlePen {}
}

/// Reads as Grbl does: dwells in seconds, and `/` at the beginning of a line means nothing. It stands in one
/// place, so that the compiler sees that no other options occur and leaves their code out.
static OPTIONS: ReadOptions = ReadOptions {
    pen: PenConvention::Spindle,
    dwell_unit: DwellUnit::Seconds,
    settle: Duration::from_millis(500),
    block_delete: BlockDelete::CarryOut,
    words: Words::GrblOnSheet,
};

/// Drawings that lift the pen by words of another firmware have more of its words, so all are read then.
const fn words(pen: PenConvention) -> Words {
    match pen {
        PenConvention::Servo {
            command: ServoCommand::M300 | ServoCommand::M280 | ServoCommand::M1, ..
        }
        | PenConvention::Laser { command: LaserCommand::Fan | LaserCommand::M4, .. } => Words::Any,
        _ => Words::Grbl,
    }
}

impl Pens for AnyPen {
    type Kept<T: Part> = Here<T>;

    fn fit(_: &StepperPlotterSettings) -> bool {
        true
    }

    fn read<R>(settings: &StepperPlotterSettings, read: impl FnOnce(&ReadOptions) -> R) -> R {
        let pen = settings.convention();
        read(&ReadOptions { pen, words: words(pen), ..OPTIONS })
    }
}

impl Pens for SpindlePen {
    type Kept<T: Part> = Nowhere<T>;

    fn fit(settings: &StepperPlotterSettings) -> bool {
        settings.convention() == PenConvention::Spindle
    }

    fn read<R>(_: &StepperPlotterSettings, read: impl FnOnce(&ReadOptions) -> R) -> R {
        read(&OPTIONS)
    }
}
