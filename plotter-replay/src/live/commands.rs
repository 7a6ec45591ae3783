//! [`Command`] and [`State`]: what a person may ask of a session, and what it is doing.

use super::Shape;
use plotter_motion::{Axis, Direction, Pen, Point, StepPoint, Vec2};

/// What a person asks of a session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Begin with the drawing.
    Start,
    /// Send no further target; the one under way is finished.
    Pause,
    /// Go on, after a pause or an emergency stop.
    Resume,
    /// Emergency stop.
    Stop,
    /// Forget what was drawn so far, on the screen only.
    Clear,
    /// Something by hand.
    Hand(Hand),
}

/// What a person does to a machine by hand, while nothing is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Hand {
    /// Draw the next operation of the drawing, and wait.
    Next,
    /// Move by so much, mm, at this speed, mm/s.
    Jog(Vec2, f64),
    /// End a movement by hand on its way.
    EndJog,
    /// Move to this place with the pen lifted.
    GoTo(Point),
    /// Draw a line to this place from where the pen is, which stays lowered behind it, at this speed, mm/s; 0
    /// leaves it to the machine.
    DrawTo(Point, f64),
    /// Lift or lower the pen where it is.
    Pen(Pen),
    /// The number that lowers the pen.
    PenDownAt(u16),
    /// Search for the limit switches.
    Home,
    /// Take off a lock.
    Unlock,
    /// Where the pen is now is this place.
    StandsAt(Point),
    /// Speed of the drawing, per cent of what it asks for.
    Feed(u8),
    /// A shape by its numbers.
    Shape {
        /// Which one, and where.
        shape: Shape,
        /// Speed, mm/s; 0 leaves it to the machine.
        speed_mm_s: f64,
        /// How far from where it was led the machine may come to rest, mm: what is more is said.
        allowed_mm: Option<f64>,
    },
    /// On and on that way, as long as this is said again, ten times a second: a machine of targets whose
    /// drive has a ramp.
    Hold(Vec2),
    /// One count that way: a machine of targets.
    Pulse(Axis, Direction),
    /// The origin P1 of the drawing, encoder counts: a machine of targets.
    Origin(StepPoint),
}

impl Hand {
    /// The command of these words: `next`, `jog X Y F`, `end-jog`, `go X Y`, `draw X Y F`, `pen up`, `pen down`, `pen-down
    /// S`, `home`, `unlock`, `origin X Y`, `feed P`, `line X Y X Y F`, `rectangle X Y W H F`, `circle X Y R N
    /// F`, `hold X Y`, `p1 X Y`, and `pulse N` with the digit that tells it: 1 and 2 for x, 3 and 4 for y. The
    /// shapes may have a sixth number, the error that is allowed, mm; a circle of 0 points has as many as that
    /// asks for.
    fn from_words(words: &str) -> Option<Self> {
        let mut words = words.split_ascii_whitespace();
        let name = words.next()?;
        if name == "pen" {
            return Some(Self::Pen(match words.next()? {
                "up" => Pen::Up,
                "down" => Pen::Down,
                _ => return None,
            }));
        }
        let mut numbers = [0.0; 6];
        let mut count = 0;
        for word in words {
            *numbers.get_mut(count)? = word.parse::<f64>().ok().filter(|number| number.abs() <= 1e6)?;
            count += 1;
        }
        let [a, b, c, d, speed_mm_s, allowed] = numbers;
        let whole = |number: f64, most: f64| -> Option<u16> {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "0 to 65535, as checked"
            )]
            (0.0..=most).contains(&number).then_some(number as u16)
        };
        Some(match (name, count) {
            ("next", 0) => Self::Next,
            ("jog", 3) => Self::Jog(Vec2::new(a, b), c),
            ("end-jog", 0) => Self::EndJog,
            ("go", 2) => Self::GoTo(Point::new(a, b)),
            ("draw", 3) => Self::DrawTo(Point::new(a, b), c),
            ("pen-down", 1) => Self::PenDownAt(whole(a, 65_535.0)?),
            ("home", 0) => Self::Home,
            ("unlock", 0) => Self::Unlock,
            ("origin", 2) => Self::StandsAt(Point::new(a, b)),
            ("feed", 1) => Self::Feed(u8::try_from(whole(a, 200.0)?).ok()?),
            ("hold", 2) => Self::Hold(Vec2::new(a, b)),
            ("p1", 2) => Self::Origin(StepPoint::new(
                i32::from(whole(a.abs(), 65_535.0)?) * if a < 0.0 { -1 } else { 1 },
                i32::from(whole(b.abs(), 65_535.0)?) * if b < 0.0 { -1 } else { 1 },
            )),
            ("pulse", 1) => match whole(a, 4.0)? {
                1 => Self::Pulse(Axis::X, Direction::Plus),
                2 => Self::Pulse(Axis::X, Direction::Minus),
                3 => Self::Pulse(Axis::Y, Direction::Plus),
                4 => Self::Pulse(Axis::Y, Direction::Minus),
                _ => return None,
            },
            (name, 5 | 6) => {
                let allowed_mm = (count == 6 && allowed > 0.0).then_some(allowed);
                let at = Point::new(a, b);
                let shape = match name {
                    "line" => Shape::Line(at, Point::new(c, d)),
                    "rectangle" => Shape::Rectangle(at, Vec2::new(c, d)),
                    "circle" if d == 0.0 => Shape::Circle(at, c, Shape::points(c, allowed_mm?)),
                    "circle" => Shape::Circle(at, c, whole(d, 10_000.0).filter(|&n| n > 2)?),
                    _ => return None,
                };
                Self::Shape { shape, speed_mm_s, allowed_mm }
            }
            _ => return None,
        })
    }
}

impl Command {
    /// The command of a name: `start`, `pause`, `resume`, `stop`, `clear`, or of one by hand with its
    /// numbers: `jog 10 0 30`.
    ///
    /// ```
    /// # use plotter_replay::live::Command;
    /// assert_eq!(Command::from_name("stop"), Some(Command::Stop));
    /// assert_eq!(Command::from_name("explode"), None);
    /// ```
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "start" => Self::Start,
            "pause" => Self::Pause,
            "resume" => Self::Resume,
            "stop" => Self::Stop,
            "clear" => Self::Clear,
            _ => Self::Hand(Hand::from_words(name)?),
        })
    }
}

/// What a session is doing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// It waits for a word of the machine.
    Connecting,
    /// It has a drawing and waits for [`Command::Start`].
    Ready,
    /// It has no drawing and listens only.
    Watching,
    /// It draws.
    Running,
    /// It sends no further target.
    Paused,
    /// The emergency stop is pressed.
    Stopped,
    /// The machine has locked itself: it is led home or unlocked before anything moves.
    Locked,
    /// The machine searches for its limit switches.
    Homing,
    /// Every target is reached, or as many as could be.
    Done,
    /// The line failed: why.
    Failed(String),
}

impl State {
    /// One word for it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Connecting => "connecting",
            Self::Ready => "ready",
            Self::Watching => "watching",
            Self::Running => "running",
            Self::Paused => "paused",
            Self::Stopped => "stopped",
            Self::Locked => "locked",
            Self::Homing => "homing",
            Self::Done => "done",
            Self::Failed(_) => "failed",
        }
    }

    /// Whether it stays so for ever.
    #[must_use]
    pub fn is_final(&self) -> bool {
        matches!(self, Self::Done | Self::Failed(_))
    }

    /// The state after a command.
    pub(super) fn after(&self, command: Command) -> Option<Self> {
        match (command, self) {
            (Command::Start, Self::Ready) | (Command::Resume, Self::Paused | Self::Stopped) => {
                Some(Self::Running)
            }
            (Command::Pause, Self::Running) => Some(Self::Paused),
            (Command::Stop, Self::Running | Self::Paused | Self::Ready | Self::Watching) => {
                Some(Self::Stopped)
            }
            _ => None,
        }
    }
}
