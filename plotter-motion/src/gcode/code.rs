//! [`Code`]: what `G` and `M` words ask for.

/// A way of moving. It holds until another one is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    Rapid,
    Line,
    /// `left` is counter-clockwise.
    Arc {
        left: bool,
    },
    /// What is not carried out, as drilling; or nothing, after `G80`.
    None,
}

/// What is done once with the words of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Action {
    Dwell,
    Home,
    Offset,
    NoOffset,
    /// `G10`: where the origin of the work lies (`L2`), or what the coordinates here are (`L20`).
    Origin {
        here: bool,
    },
    /// What is not carried out, and takes the words of the line.
    Other,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spindle {
    Off,
    /// `M3`: also while the machine stands.
    Constant,
    /// `M4`: in proportion to the speed.
    Dynamic,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// `M0`, `M1`.
    Pause,
    /// `M2`, `M30`.
    End,
}

/// What a `G` or `M` word asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Code {
    Motion(Motion),
    Action(Action),
    MachineCoordinates,
    Inches(bool),
    Relative(bool),
    AbsoluteCentres(bool),
    Sheet(bool),
    InverseTime(bool),
    Spindle(Spindle),
    Fan(bool),
    Beep,
    ServoAngle,
    ToolChange,
    Stop(Stop),
    /// Nothing for a pen plotter to do.
    Quiet,
    /// Nothing for a pen plotter to do; the other words of the line belong to it.
    QuietWithWords,
    Unknown,
}

impl Code {
    /// What the `G` word with this number, times ten, asks for, and what that is called where it is not done.
    pub(super) fn general(tenths: u16) -> (Self, Option<&'static str>) {
        let done = match tenths {
            0 => Self::Motion(Motion::Rapid),
            10 => Self::Motion(Motion::Line),
            20 => Self::Motion(Motion::Arc { left: false }),
            30 => Self::Motion(Motion::Arc { left: true }),
            800 => Self::Motion(Motion::None),
            40 => Self::Action(Action::Dwell),
            280 | 300 => Self::Action(Action::Home),
            920 => Self::Action(Action::Offset),
            921 | 922 => Self::Action(Action::NoOffset),
            530 => Self::MachineCoordinates,
            170 => Self::Sheet(true),
            200 => Self::Inches(true),
            210 => Self::Inches(false),
            900 => Self::Relative(false),
            910 => Self::Relative(true),
            901 => Self::AbsoluteCentres(true),
            911 => Self::AbsoluteCentres(false),
            940 => Self::InverseTime(false),
            // Cancelling what was never on; work coordinates; path control; what machines and lathes differ in.
            150
            | 400
            | 490
            | 500
            | 540
            | 550
            | 560
            | 570
            | 580
            | 590..=593
            | 610
            | 611
            | 640
            | 690
            | 970
            | 980
            | 990 => Self::Quiet,
            _ => return Self::general_undone(tenths),
        };
        (done, None)
    }

    fn general_undone(tenths: u16) -> (Self, Option<&'static str>) {
        let (code, meaning) = match tenths {
            50..=53 => (Self::Motion(Motion::None), "spline"),
            330 | 331 => (Self::Motion(Motion::None), "synchronized motion"),
            382..=385 => (Self::Motion(Motion::None), "probe"),
            730 | 760 | 810 | 820 | 830 | 840 | 850 | 860 | 870 | 880 | 890 => {
                (Self::Motion(Motion::None), "canned cycle")
            }
            100 => (Self::Action(Action::Other), "another coordinate system"),
            281 | 301 => (Self::Action(Action::Other), "set the place of homing"),
            290 => (Self::Action(Action::Other), "bed levelling"),
            923 => (Self::Action(Action::Other), "restore the offset"),
            180 => (Self::Sheet(false), "plane XZ"),
            190 => (Self::Sheet(false), "plane YZ"),
            930 => (Self::InverseTime(true), "inverse time feed rate"),
            950 => (Self::InverseTime(true), "feed rate per revolution"),
            410 | 420 => (Self::Quiet, "cutter compensation"),
            430 => (Self::Quiet, "tool length"),
            431 => (Self::Action(Action::Other), "tool length"),
            510 => (Self::Action(Action::Other), "scaling"),
            680 => (Self::Action(Action::Other), "rotation"),
            _ => return (Self::Unknown, None),
        };
        (code, Some(meaning))
    }

    /// What the `M` word with this number, times ten, asks for, and what that is called where it is not done.
    pub(super) fn miscellaneous(tenths: u16) -> (Self, Option<&'static str>) {
        if !tenths.is_multiple_of(10) {
            return (Self::Unknown, None);
        }
        let done = match tenths / 10 {
            0 | 1 => Self::Stop(Stop::Pause),
            2 | 30 => Self::Stop(Stop::End),
            3 => Self::Spindle(Spindle::Constant),
            4 => Self::Spindle(Spindle::Dynamic),
            5 => Self::Spindle(Spindle::Off),
            6 => Self::ToolChange,
            106 => Self::Fan(true),
            107 => Self::Fan(false),
            280 => Self::ServoAngle,
            300 => Self::Beep,
            // Coolant, mDraw's questions, drives, overrides.
            7..=11 | 17 | 18 | 48 | 49 => Self::Quiet,
            // What printers are told and asked about themselves.
            23
            | 82..=85
            | 92
            | 105
            | 110
            | 111
            | 114
            | 115
            | 117..=119
            | 201..=206
            | 211
            | 220
            | 221
            | 400
            | 500..=503 => Self::QuietWithWords,
            19 => return (Self::Quiet, Some("spindle orientation")),
            42 | 62..=68 => return (Self::QuietWithWords, Some("output pin")),
            98 | 99 => return (Self::QuietWithWords, Some("subprogram")),
            104 | 109 | 140 | 190 => return (Self::QuietWithWords, Some("temperature")),
            226 => return (Self::QuietWithWords, Some("pause")),
            _ => Self::Unknown,
        };
        (done, None)
    }

    /// Commands of one number exclude each other within a line.
    pub(super) fn group(self) -> Option<usize> {
        match self {
            Self::Motion(_) => Some(0),
            Self::Action(_) => Some(1),
            Self::Inches(_) => Some(2),
            Self::Relative(_) => Some(3),
            Self::AbsoluteCentres(_) => Some(4),
            Self::Sheet(_) => Some(5),
            Self::InverseTime(_) => Some(6),
            Self::Spindle(_) => Some(7),
            Self::Stop(_) => Some(8),
            Self::Fan(_) | Self::Beep | Self::ServoAngle => Some(9),
            Self::ToolChange => Some(10),
            Self::MachineCoordinates | Self::Quiet | Self::QuietWithWords | Self::Unknown => None,
        }
    }
}
