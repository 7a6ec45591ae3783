//! [`EbbHost`]: the host of an AxiDraw, an EggBot, or what else has an EBB.

mod answer;
mod asking;
mod hand_way;
mod hearing;
mod sending;

use self::answer::Said;
use self::hand_way::HandWay;
use super::ring::Ring;
use super::trail::Trail;
use super::{HostState, HostStatus, MachineHost, MachineLimits, MachineNotice, NotNow, Request, Words};
use crate::kinematics::Kinematics;
use crate::planner::PlanError;
use crate::protocol::ebb::{EbbCommand, EbbMotion, EbbMotionSettings};
use crate::{Pen, Planner, PlannerSettings, PlotOp, Point, StepPoint};
use core::fmt::Write as _;
use core::time::Duration;

/// Blocks that are planned ahead.
const BLOCKS: usize = 64;
/// Longest line of the board that is read: its version has 44 bytes.
const MOST_ANSWER: usize = 96;
/// Longest line to the board: the documentation allows 64 bytes with the end of the line; a move with the
/// greatest numbers has 72 and is never made, as no motor makes 2³¹ steps in 64 ms.
const MOST_LINE: usize = 64;
const MOST_NOTICES: usize = 16;
/// So often a line that was refused is sent again.
const MOST_TRIES: u8 = 3;
/// Settings that are sent before the first move.
const SETTINGS: u8 = 9;
/// The one that switches the motors on, and the one behind what takes its place for a host that goes on.
const ENABLING: u8 = 5;
const BEHIND_WHERE: u8 = 8;
/// With a shorter rest of the pen nobody asks where the machine is before it moves on: the question has to be
/// there within it.
const LEAST_REST: Duration = Duration::from_millis(20);
/// A pen that is farther from the start of an operation than this travels there first, mm.
const BESIDE_MM: f64 = 1e-6;
/// Steps/s of a move that takes back what a damaged line did.
const CORRECTION_HZ: u32 = 400;

/// How a host of an EBB goes about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EbbHostSettings {
    /// Limits of the motion.
    pub planner: PlannerSettings,
    /// How it becomes commands. The dialect is what the board's version allows.
    pub motion: EbbMotionSettings,
    /// Step mode: 1 for sixteenths, which the kinematics counts, to 5 for full steps.
    pub step_mode: u8,
    /// Pulses of the pen's servo with the pen up and down, in units of 1/12 µs: SC,4 and SC,5.
    pub servo: [u16; 2],
    /// What the pulse changes by every 24 ms on the way up and down: SC,11 and SC,12.
    pub servo_rates: [u16; 2],
    /// Silence after which an answer counts as lost.
    pub silence: Duration,
    /// By how many steps the board may count otherwise at a rest.
    pub rest_within_steps: u16,
}

impl Default for EbbHostSettings {
    /// The servo's documented positions, at the rates of firmware 2.8.1; 2 s of silence.
    fn default() -> Self {
        Self {
            planner: PlannerSettings::default(),
            motion: EbbMotionSettings::default(),
            step_mode: 1,
            servo: [12_000, 16_000],
            servo_rates: [400, 400],
            silence: Duration::from_secs(2),
            rest_within_steps: 0,
        }
    }
}

/// What a line is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Purpose {
    /// V, which is answered without an `OK`.
    Version,
    Setting,
    /// A command of the drawing; where the motors stand behind it.
    Motion(StepPoint),
    /// QS at a rest of the drawing; where the motors were led.
    Rest(StepPoint),
    /// QS after a stop, or at the start of a host that goes on.
    Where,
    ByHand,
}

#[derive(Clone, Copy, Debug)]
struct Line {
    words: Words<MOST_LINE>,
    purpose: Purpose,
    /// Bytes that are sent.
    sent: usize,
    tries: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// So many of the questions and settings are sent.
    Unheard(u8),
    Ready,
    /// So many operations more, if not all.
    Drawing(Option<u32>),
    /// The machine brakes along its path, or what is planned is drawn to its end; whether the pen was down.
    Ending(Then),
    /// The pen is lifted, and it is asked where the machine is.
    Lifted(Then),
    Paused,
    PenWanted(u8),
    SheetWanted,
    /// Stopped; then asked where it is.
    Stopped,
    Asking,
    Done,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Then {
    Pause,
    Done,
}

/// The host of a machine with an EBB: plans the motion, which the board does not, and sends it move by move,
/// each when the one before is taken.
///
/// - A pause brakes along the path and lifts the pen; to go on puts it back.
/// - A stop is ES, which the board looks at as soon as a move finds room in its queue: at most two moves of
///   64 ms later. Where the motors stand then is asked with QS, and the drawing goes on from there.
/// - No line has a checksum. At each lifting of the pen the board is asked for its count of steps, and what a
///   line did that came wrong is told ([`MachineNotice::Elsewhere`]), counted and taken back.
/// - A line that the board refuses is sent again. After [`EbbHostSettings::silence`] an answer counts as
///   lost.
/// - By hand the machine moves at a tenth of the travel speed, 20 mm/s at most, with ramps: in pieces of SM,
///   each at constant speed.
///
/// ```
/// # use plotter_motion::kinematics::{BeltSigns, CoreXy};
/// # use plotter_motion::protocol::hosts::{EbbHost, EbbHostSettings, HostState, MachineHost, Request};
/// # use plotter_motion::{PlotOp, Point};
/// # use core::time::Duration;
/// let axidraw = CoreXy::new(BeltSigns::TrackingEquations, 80.0)?;
/// let drawing = [PlotOp::Travel { to: Point::new(0.0, 0.05) }];
/// let mut host = EbbHost::new(axidraw, EbbHostSettings::default(), drawing.into_iter())?;
/// let now = Duration::ZERO;
/// let mut sent = String::new();
/// let mut answer = |host: &mut EbbHost<_, _>, with: &[u8]| {
///     host.poll(now);
///     sent.extend(core::iter::from_fn(|| host.next_byte(now)).map(char::from));
///     with.iter().for_each(|&byte| host.receive(now, byte));
/// };
/// answer(&mut host, b"EBBv13_and_above EB Firmware Version 2.8.1\r\n");
/// (0..6).for_each(|_| answer(&mut host, b"OK\r\n"));
/// assert_eq!(host.status().state, HostState::Ready);
/// host.ask(now, Request::GoOn)?;
/// (0..2).for_each(|_| answer(&mut host, b"OK\r\n"));
/// // 4 steps of both motors within 15 ms
/// assert!(sent.starts_with("V\rSC,4,12000\rSC,5,16000\rSC,11,400\rSC,12,400\rEM,1,1\rSP,1,200\rLM,"), "{sent}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct EbbHost<K, I> {
    settings: EbbHostSettings,
    planner: Planner<BLOCKS>,
    motion: EbbMotion<K>,
    trail: Trail,
    ops: I,
    index: u64,
    is_over: bool,
    line: Option<Line>,
    /// A line that waits for the one before.
    next: Option<(EbbCommand, StepPoint)>,
    phase: Phase,
    told: HostState,
    notices: Ring<MachineNotice, MOST_NOTICES>,
    answer: Words<MOST_ANSWER>,
    answer_is_cut: bool,
    is_heard: bool,
    is_silent: bool,
    spoke: Option<Duration>,
    /// Where the motors are led when the last lines are carried out: of the last, and of those before.
    led: [StepPoint; 3],
    /// What the board counts when our count is 0.
    zero: StepPoint,
    /// Asked at the next line: where the machine is, at the rest of this lifting.
    rest: Option<(StepPoint, bool)>,
    /// To be taken back at the next rest.
    correction: StepPoint,
    pen: Pen,
    /// How the pen was when the drawing was paused, and where.
    held: Option<(Pen, StepPoint)>,
    /// Where the motors are, moved by hand.
    by_hand: StepPoint,
    /// Where they go by hand once the pen is as it is to be.
    goes_to: Option<Point>,
    /// The way by hand that is under way.
    way: Option<HandWay>,
    /// What the board answered to the last QS.
    place: Option<StepPoint>,
    holder: Option<u8>,
    sent_ops: u64,
    feed_percent: u8,
    damaged: u64,
    earlier: Option<(u64, u64)>,
}

impl<K: Kinematics + Clone, I: Iterator<Item = PlotOp>> EbbHost<K, I> {
    /// A host with a drawing to send, which waits for [`Request::GoOn`].
    ///
    /// # Errors
    ///
    /// [`PlanError::Setting`] for a limit that no motion can be planned with; [`PlanError::Averaging`] for a
    /// jerk that is limited as a vector, because the board makes the steps.
    pub fn new(kinematics: K, settings: EbbHostSettings, ops: I) -> Result<Self, PlanError> {
        if settings.planner.vector_jerk().is_some() {
            return Err(PlanError::Averaging { quantity: "the moves of an EBB" });
        }
        Ok(Self {
            planner: Planner::new(settings.planner)?,
            motion: EbbMotion::new(kinematics, settings.motion),
            settings,
            trail: Trail::new(),
            ops,
            index: 0,
            is_over: false,
            line: None,
            next: None,
            phase: Phase::Unheard(0),
            told: HostState::Unheard,
            notices: Ring::new(),
            answer: Words::default(),
            answer_is_cut: false,
            is_heard: false,
            is_silent: false,
            spoke: None,
            led: [StepPoint::default(); 3],
            zero: StepPoint::default(),
            rest: None,
            correction: StepPoint::default(),
            pen: Pen::Up,
            held: None,
            by_hand: StepPoint::default(),
            goes_to: None,
            way: None,
            place: None,
            holder: None,
            sent_ops: 0,
            feed_percent: 100,
            damaged: 0,
            earlier: None,
        })
    }

    /// The same, which goes on where an earlier host has left the drawing: so many operations of it were
    /// known to be done, so many may have been sent. Where the board counts itself to be says which; its
    /// motors must have stayed switched on.
    #[must_use]
    pub fn resuming(mut self, done: u64, sent: u64) -> Self {
        self.earlier = Some((done, sent));
        self
    }

    /// How often the board was found elsewhere than it was led to.
    #[must_use]
    pub const fn damaged(&self) -> u64 {
        self.damaged
    }

    fn notice(&mut self, notice: MachineNotice) {
        if self.notices.is_full() {
            self.notices.pop();
        }
        let _ = self.notices.push(notice); // there is room
    }

    fn send(&mut self, purpose: Purpose, words: core::fmt::Arguments<'_>) {
        let mut line = Words::default();
        // What finds no room is no line of ours.
        if line.write_fmt(words).is_ok() && line.push(b'\r') {
            self.line = Some(Line { words: line, purpose, sent: 0, tries: 0 });
        }
    }

    fn send_command(&mut self, purpose: Purpose, command: EbbCommand) {
        if let EbbCommand::Pen { pen, .. } = command {
            self.pen = pen;
        }
        self.send(purpose, format_args!("{command}"));
    }

    /// The place on the sheet of a count of ours.
    fn point(&self, steps: StepPoint) -> Point {
        self.motion.kinematics().point_at(steps.into())
    }

    fn settle_ms(&self) -> u16 {
        u16::try_from(self.settings.motion.pen_settle.as_millis()).unwrap_or(u16::MAX)
    }

    /// How far a step moves the pen at most, mm.
    fn step_mm(&self) -> f64 {
        let [first, second] = [StepPoint::new(1, 0), StepPoint::new(0, 1)].map(|step| self.point(step));
        first.distance(Point::ORIGIN).max(second.distance(Point::ORIGIN))
    }

    fn state(&self) -> HostState {
        match self.phase {
            Phase::Unheard(_) => HostState::Unheard,
            Phase::Ready => HostState::Ready,
            Phase::Drawing(_) => HostState::Drawing,
            Phase::Ending(_) | Phase::Lifted(_) => HostState::Ending,
            Phase::Paused => HostState::Paused,
            Phase::PenWanted(pen) => HostState::PenWanted(pen),
            Phase::SheetWanted => HostState::SheetWanted,
            Phase::Stopped | Phase::Asking => HostState::Stopped,
            Phase::Done => HostState::Done,
        }
    }
}

impl<K: Kinematics + Clone, I: Iterator<Item = PlotOp>> MachineHost for EbbHost<K, I> {
    fn poll(&mut self, now: Duration) -> Option<MachineNotice> {
        let since = *self.spoke.get_or_insert(now);
        let waits = self.line.is_some_and(|line| line.sent >= line.words.as_bytes().len());
        if waits && now.saturating_sub(since) >= self.settings.silence {
            self.spoke = Some(now);
            if self.is_heard && !self.is_silent {
                // The board has taken the line: it would have refused it, or waits for room, and answers
                // then.
                self.notice(MachineNotice::AnswerLost);
                self.is_silent = true;
                self.taken();
            } else {
                if !core::mem::replace(&mut self.is_silent, true) {
                    self.notice(MachineNotice::Silent);
                }
                if let Some(line) = &mut self.line {
                    line.sent = 0;
                }
            }
        }
        self.write();
        let state = self.state();
        if state != self.told {
            self.told = state;
            self.notice(MachineNotice::State(state));
        }
        self.notices.pop()
    }

    fn next_byte(&mut self, now: Duration) -> Option<u8> {
        self.write();
        let line = self.line.as_mut()?;
        let byte = line.words.as_bytes().get(line.sent).copied()?;
        line.sent += 1;
        self.spoke = Some(now);
        Some(byte)
    }

    fn receive(&mut self, now: Duration, byte: u8) {
        match byte {
            b'\n' | b'\r' => {
                let answer = core::mem::take(&mut self.answer);
                let is_cut = core::mem::take(&mut self.answer_is_cut);
                if !answer.as_bytes().is_empty() {
                    self.spoke = Some(now);
                    self.hear(if is_cut { Said::Unknown } else { Said::of(answer.as_bytes()) });
                    self.write();
                }
            }
            _ => self.answer_is_cut |= !self.answer.push(byte),
        }
    }

    fn next_wake(&self) -> Option<Duration> {
        if !self.notices.is_empty() {
            return Some(Duration::ZERO);
        }
        self.line.and(self.spoke).map(|spoke| spoke.saturating_add(self.settings.silence))
    }

    fn ask(&mut self, _: Duration, request: Request) -> Result<(), NotNow> {
        self.asked_for(request)
    }

    /// ES, behind the end of whatever line is cut by it.
    fn stop_bytes(&self) -> &'static [u8] {
        b"\rES\r"
    }

    fn status(&self) -> HostStatus {
        let steps_per_mm = Some(1.0 / self.step_mm().max(1e-9));
        let [_, passed, _] = self.led;
        HostStatus {
            state: self.state(),
            at: self.is_heard.then(|| self.point(if self.is_free().is_ok() { self.by_hand } else { passed })),
            pen: self.pen,
            sent: self.sent_ops,
            done: if self.phase == Phase::Done { self.index } else { self.trail.done() },
            is_led: self.way.is_some() || self.goes_to.is_some(),
            feed_percent: self.feed_percent,
            limits: MachineLimits { steps_per_mm: [steps_per_mm; 2], ..MachineLimits::default() },
        }
    }
}
