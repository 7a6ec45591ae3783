//! [`Pens`]: by which words hosts may lift the pen.

use super::super::StepperPlotterSettings;
use crate::gcode::{BlockDelete, DwellUnit, LaserCommand, PenConvention, ReadOptions, ServoCommand, Words};
use crate::planner::{Here, Keep, Nowhere, Part};
use core::time::Duration;

/// By which words hosts may lift the pen, and how much of Grbl is there: [`AnyPen`], or [`SpindlePen`] for a
/// small program. What both understand they carry out alike.
///
/// Nobody else implements it.
pub trait Pens: sealed::Sealed {
    /// Memory that only a whole Grbl needs: start-up lines, settings to go back to.
    #[doc(hidden)]
    type Kept<T: Part>: Keep<T>;

    /// Whether these settings ask for no other words.
    #[doc(hidden)]
    fn fit(settings: &StepperPlotterSettings) -> bool;

    /// Reads with the options that these settings ask for.
    #[doc(hidden)]
    fn read<R>(settings: &StepperPlotterSettings, read: impl FnOnce(&ReadOptions) -> R) -> R;
}

/// All words, and a laser: [`StepperPlotterSettings`] choose. All of Grbl that a plotter can do: start-up
/// lines, `$RST=$` and `$RST=*`, arcs in other planes, `G43.1`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct AnyPen;

/// `M3` and `M5` ([`PenConvention::Spindle`]), no laser, and none of what [`AnyPen`] has more of Grbl: a line
/// that needs it is `error:20` or `error:3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SpindlePen;

mod sealed {
    pub trait Sealed: Clone + core::fmt::Debug + PartialEq {}
    impl Sealed for super::AnyPen {}
    impl Sealed for super::SpindlePen {}
}

/// As Grbl reads: seconds, and `/` at the begin of a line means nothing. In one place, so that the compiler
/// sees that no others are read with.
static OPTIONS: ReadOptions = ReadOptions {
    pen: PenConvention::Spindle,
    dwell_unit: DwellUnit::Seconds,
    settle: Duration::from_millis(500),
    block_delete: BlockDelete::CarryOut,
    words: Words::GrblOnSheet,
};

/// Where the pen is lifted by words of another firmware, its drawings have others of its words, too.
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
