//! [`EbbHost`]: the host of an AxiDraw, an EggBot, or what else has an EBB.

mod answer;

use self::answer::Said;
use super::ring::Ring;
use super::trail::Trail;
use super::{HostState, HostStatus, MachineHost, MachineLimits, MachineNotice, NotNow, Request, Words};
use crate::kinematics::Kinematics;
use crate::planner::PlanError;
use crate::protocol::ebb::{EbbCommand, EbbDialect, EbbEvent, EbbMotion, EbbMotionSettings};
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
/// - A stop is ES, which the board looks at as soon as a move finds room in its queue: at most two moves of 64
///   ms later. Where the motors stand then is asked with QS, and the drawing goes on from there.
/// - No line has a checksum. At each lifting of the pen the board is asked for its count of steps, and what a
///   line did that came wrong is told ([`MachineNotice::Elsewhere`]), counted and taken back.
/// - A line that the board refuses is sent again. After [`EbbHostSettings::silence`] an answer counts as lost.
/// - By hand the machine moves at a tenth of the travel speed, 20 mm/s at most: at constant speed, as SM does.
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
    /// [`PlanError::Setting`] for a limit that no motion can be planned with.
    pub fn new(kinematics: K, settings: EbbHostSettings, ops: I) -> Result<Self, PlanError> {
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
            place: None,
            holder: None,
            sent_ops: 0,
            feed_percent: 100,
            damaged: 0,
            earlier: None,
        })
    }

    /// The same, which goes on where an earlier host has left the drawing: so many operations of it were known
    /// to be done, so many may have been sent. Where the board counts itself to be says which; its motors must
    /// have stayed switched on.
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

    /// The next line, if there is one for now.
    fn write(&mut self) {
        if self.line.is_some() {
            return;
        }
        match self.phase {
            Phase::Unheard(sent) => self.write_setting(sent),
            Phase::Drawing(_) | Phase::Ending(_) | Phase::Lifted(_) => self.write_motion(),
            Phase::Asking => self.send(Purpose::Where, format_args!("QS")),
            Phase::Ready
            | Phase::Paused
            | Phase::PenWanted(_)
            | Phase::SheetWanted
            | Phase::Stopped
            | Phase::Done => {}
        }
    }

    fn write_setting(&mut self, sent: u8) {
        let [up, down] = self.settings.servo;
        let [rate_up, rate_down] = self.settings.servo_rates;
        let setting = Purpose::Setting;
        match sent {
            0 => self.send(Purpose::Version, format_args!("V")),
            1 => self.send(setting, format_args!("SC,4,{up}")),
            2 => self.send(setting, format_args!("SC,5,{down}")),
            3 => self.send(setting, format_args!("SC,11,{rate_up}")),
            4 => self.send(setting, format_args!("SC,12,{rate_down}")),
            // Switching the motors on counts their steps from 0: not where an earlier host has left off.
            ENABLING if self.earlier.is_none() => {
                let mode = self.settings.step_mode.clamp(1, 5);
                self.send_command(setting, EbbCommand::Enable { mode });
            }
            // What the board has in its queue is drawn once the second wait is taken.
            5 | 6 => self.send(setting, format_args!("SM,1,0,0")),
            7 => self.send(Purpose::Where, format_args!("QS")),
            _ => self.send_command(setting, EbbCommand::Pen { pen: Pen::Up, duration_ms: self.settle_ms() }),
        }
    }

    fn settle_ms(&self) -> u16 {
        u16::try_from(self.settings.motion.pen_settle.as_millis()).unwrap_or(u16::MAX)
    }

    fn write_motion(&mut self) {
        if let Some((place, true)) = self.rest {
            self.rest = None;
            self.send(Purpose::Rest(place), format_args!("QS"));
            return;
        }
        let Some((command, made)) = self.next.take().or_else(|| self.next_command()) else { return };
        if matches!(command, EbbCommand::Pen { .. })
            && let Some(back) = self.correction()
        {
            // At a rest, before the pen moves.
            self.next = Some((command, made));
            self.send_command(Purpose::Motion(self.motion_led()), back);
            return;
        }
        let is_lifted = matches!(command, EbbCommand::Pen { pen: Pen::Up, .. });
        if is_lifted && self.settings.motion.pen_settle >= LEAST_REST {
            self.rest = Some((made, false));
        }
        self.send_command(Purpose::Motion(made), command);
    }

    /// What takes back what a damaged line did, if something is to be taken back.
    fn correction(&mut self) -> Option<EbbCommand> {
        let StepPoint { x, y } = core::mem::take(&mut self.correction);
        let steps = x.unsigned_abs().max(y.unsigned_abs());
        let duration_ms = (u64::from(steps) * 1_000 / u64::from(CORRECTION_HZ)).clamp(10, 1_000_000);
        let duration_ms = u32::try_from(duration_ms).unwrap_or(u32::MAX);
        (steps > 0).then_some(EbbCommand::Constant { duration_ms, steps: [x, y] })
    }

    /// Where the motors were led last.
    fn motion_led(&self) -> StepPoint {
        let [last, ..] = self.led;
        last
    }

    /// The next command of the drawing; what is no command changes the phase.
    fn next_command(&mut self) -> Option<(EbbCommand, StepPoint)> {
        loop {
            match self.motion.next_event() {
                Some(EbbEvent::Command(command)) => return Some((command, self.motion.made())),
                Some(EbbEvent::SelectPen(pen)) => {
                    // The pen that draws first is in the holder already.
                    if self.holder.replace(pen).is_some_and(|before| before != pen) {
                        self.phase = Phase::PenWanted(pen);
                        return None;
                    }
                    continue;
                }
                Some(EbbEvent::NewPage) => {
                    self.phase = Phase::SheetWanted;
                    return None;
                }
                None => {}
            }
            self.fill();
            match self.planner.next_action() {
                Some(action) => {
                    let _ = self.motion.push(action); // its events have all been taken
                }
                None if !self.rests() => return None,
                None => {}
            }
        }
    }

    /// Nothing more is planned: says whether another command comes of it at once.
    fn rests(&mut self) -> bool {
        self.motion.rest();
        if !self.motion.is_idle() {
            return true;
        }
        match self.phase {
            Phase::Drawing(_) if self.is_over => {
                self.phase = Phase::Ending(Then::Done);
                true
            }
            Phase::Ending(then) => {
                self.phase = Phase::Lifted(then);
                let made = self.motion.made();
                if then == Then::Pause {
                    self.held = Some((self.pen, made));
                }
                self.by_hand = made;
                if self.pen == Pen::Down {
                    let lift = EbbCommand::Pen { pen: Pen::Up, duration_ms: self.settle_ms() };
                    self.next = Some((lift, made));
                }
                false
            }
            Phase::Lifted(then) if self.next.is_none() => {
                if self.rest.is_some() {
                    // Another wait behind the pen's: once that is taken, the pen's runs, and the motors stand.
                    let wait = EbbCommand::Constant { duration_ms: 1, steps: [0; 2] };
                    self.next = Some((wait, self.motion.made()));
                    return false;
                }
                if let Some(back) = self.correction() {
                    self.next = Some((back, self.motion.made()));
                    return false;
                }
                self.phase = match then {
                    Then::Pause => Phase::Paused,
                    Then::Done => {
                        self.trail.finish_sent();
                        Phase::Done
                    }
                };
                false
            }
            _ => false,
        }
    }

    /// Operations into the planner.
    fn fill(&mut self) {
        while let Phase::Drawing(left) = self.phase
            && self.planner.has_room()
            && !self.is_over
        {
            if left == Some(0) {
                self.phase = Phase::Ending(Then::Pause);
                let _ = self.planner.rest(); // there is room
                return;
            }
            let given = match self.trail.next() {
                Some(given) => given,
                None => {
                    let Some(op) = self.ops.next() else {
                        self.is_over = true;
                        let _ = self.planner.finish(); // there is room
                        return;
                    };
                    let index = self.index;
                    self.index = self.index.saturating_add(1);
                    if !self.trail.push(index, op) {
                        return;
                    }
                    continue;
                }
            };
            // After a stop beside its way an operation begins anew.
            let is_drawn = matches!(given.op, PlotOp::Draw { .. } | PlotOp::DrawArc { .. });
            if is_drawn && self.planner.position().distance(given.from) > BESIDE_MM {
                let _ = self.planner.push(PlotOp::Travel { to: given.from }); // there is room
                if !self.planner.has_room() {
                    return;
                }
            }
            if self.planner.push(given.op).is_err() {
                self.notice(MachineNotice::LeftOut { op: given.index });
            }
            self.trail.send();
            self.sent_ops = given.index.saturating_add(1);
            if given.op.target().is_some() {
                self.phase = Phase::Drawing(left.map(|left| left - 1));
            }
        }
    }

    fn hear(&mut self, said: Said) {
        if !self.is_heard {
            self.is_heard = true;
        }
        if core::mem::take(&mut self.is_silent) {
            self.notice(MachineNotice::HeardAgain);
        }
        match (said, self.line.map(|line| line.purpose)) {
            (Said::Version(first, second), Some(Purpose::Version)) => {
                if (first, second) < (2, 7) {
                    self.motion.set_dialect(EbbDialect::Constant);
                }
                self.notice(MachineNotice::Greeted);
                self.taken();
            }
            // What an earlier host has asked for.
            (_, Some(Purpose::Version)) => {}
            (Said::Place(first, second), Some(Purpose::Rest(_) | Purpose::Where)) => {
                self.place = Some(StepPoint::new(first, second));
            }
            (Said::Ok, Some(_)) => self.taken(),
            (Said::Error(code), Some(_)) => self.refused(code),
            // A stop that somebody has written past us.
            (Said::Stopped(_), _) | (Said::Ok | Said::Error(_), None) => {}
            _ => self.notice(MachineNotice::Garbled),
        }
    }

    /// The line in flight is answered.
    fn taken(&mut self) {
        let Some(line) = self.line.take() else { return };
        match line.purpose {
            Purpose::Version | Purpose::Setting => self.next_setting(),
            Purpose::Motion(made) => {
                let [last, before, _] = self.led;
                self.led = [made, last, before];
                // With this one in the queue the last one runs, and the one before it is over.
                let at = self.point(before);
                self.trail.is_at(at);
                if let Some((_, asks)) = &mut self.rest {
                    // The pen's own line is the first that is taken; with another behind it the pen moves.
                    if !matches!(line.words.as_bytes(), [b'S', b'P', ..]) {
                        *asks = true;
                    }
                }
            }
            Purpose::Rest(wanted) => self.rested(wanted),
            Purpose::Where => self.found(),
            Purpose::ByHand => {}
        }
    }

    fn next_setting(&mut self) {
        if let Phase::Unheard(sent) = self.phase {
            let next = if sent == ENABLING && self.earlier.is_none() { BEHIND_WHERE } else { sent + 1 };
            self.phase = if next < SETTINGS { Phase::Unheard(next) } else { Phase::Ready };
        }
    }

    /// The board has said where it is at a rest.
    fn rested(&mut self, wanted: StepPoint) {
        let Some(told) = self.place.take() else { return };
        let told = StepPoint::new(told.x.wrapping_sub(self.zero.x), told.y.wrapping_sub(self.zero.y));
        let off = StepPoint::new(wanted.x.wrapping_sub(told.x), wanted.y.wrapping_sub(told.y));
        let most = u32::from(self.settings.rest_within_steps);
        if off.x.unsigned_abs() <= most && off.y.unsigned_abs() <= most {
            let at = self.point(wanted);
            self.trail.is_at(at);
            return;
        }
        self.damaged = self.damaged.saturating_add(1);
        self.correction = off;
        let (wanted, told) = (self.point(wanted), self.point(told));
        self.notice(MachineNotice::Elsewhere { wanted, told });
    }

    /// The board has said where it stands, of which nothing is known.
    fn found(&mut self) {
        let Some(told) = self.place.take() else { return };
        let at = StepPoint::new(told.x.wrapping_sub(self.zero.x), told.y.wrapping_sub(self.zero.y));
        if let (Phase::Unheard(_), Some((done, sent))) = (self.phase, self.earlier.take()) {
            while self.index < sent
                && let Some(op) = self.ops.next()
            {
                if !self.trail.push(self.index, op) {
                    break;
                }
                self.trail.send();
                self.index += 1;
                if self.index <= done {
                    self.trail.finish_first();
                }
            }
            self.sent_ops = self.index;
            let place = self.point(at);
            if self.trail.is_at(place) {
                self.trail.interrupted_at(place);
            } else if self.trail.under_way() > 0 {
                self.notice(MachineNotice::NotResumed { told: place });
            }
            self.restart_at(at);
            self.next_setting();
            return;
        }
        let place = self.point(at);
        self.trail.is_at(place);
        self.trail.interrupted_at(place);
        self.restart_at(at);
        self.phase = Phase::Lifted(Then::Pause);
        self.next = Some((EbbCommand::Pen { pen: Pen::Up, duration_ms: self.settle_ms() }, at));
    }

    /// How far a step moves the pen at most, mm.
    fn step_mm(&self) -> f64 {
        let [first, second] = [StepPoint::new(1, 0), StepPoint::new(0, 1)].map(|step| self.point(step));
        first.distance(Point::ORIGIN).max(second.distance(Point::ORIGIN))
    }

    /// The motors stand here with nothing under way.
    fn restart_at(&mut self, at: StepPoint) {
        self.motion.stand_at(at);
        self.planner.clear(self.point(at));
        self.led = [at; 3];
        self.by_hand = at;
        self.held = None;
        self.rest = None;
        self.next = None;
        self.correction = StepPoint::default();
        self.is_over = false;
    }

    fn refused(&mut self, code: u16) {
        let op =
            matches!(self.line.map(|line| line.purpose), Some(Purpose::Motion(_))).then(|| self.trail.done());
        match &mut self.line {
            Some(line) if line.tries < MOST_TRIES => {
                (line.sent, line.tries) = (0, line.tries + 1);
                self.notice(MachineNotice::SentAgain);
            }
            _ => {
                self.notice(MachineNotice::Refused { op, code });
                self.taken();
                if let Phase::Drawing(_) = self.phase {
                    self.pause();
                }
            }
        }
    }

    fn pause(&mut self) {
        self.planner.hold();
        self.phase = Phase::Ending(Then::Pause);
    }

    /// A straight move by hand at constant speed.
    fn move_by_hand(&mut self, to: Point, speed_mm_s: f64) -> Result<(), NotNow> {
        if !(to.x.abs() <= 1e4 && to.y.abs() <= 1e4) {
            return Err(NotNow::OutOfRange);
        }
        if self.line.is_some() {
            return Err(NotNow::Busy);
        }
        let from = self.by_hand;
        let to_steps = self.motion.kinematics().steps_at(to);
        let way = [to_steps.x.saturating_sub(from.x), to_steps.y.saturating_sub(from.y)];
        let ms = libm::ceil(1e3 * self.point(from).distance(to) / speed_mm_s.clamp(0.1, 1e3));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast saturates")]
        let duration_ms = (ms as u32).clamp(10, 1_000_000);
        self.send_command(Purpose::ByHand, EbbCommand::Constant { duration_ms, steps: way });
        self.by_hand = to_steps;
        Ok(())
    }

    /// Speed by hand: the motors start and stop at once.
    fn hand_mm_s(&self) -> f64 {
        (0.1 * self.settings.planner.travel_speed_mm_s).min(20.0)
    }

    fn go_on(&mut self, left: Option<u32>) -> Result<(), NotNow> {
        match self.phase {
            Phase::Ready | Phase::PenWanted(_) | Phase::SheetWanted => {}
            Phase::Paused => {
                if let Some((pen, at)) = self.held {
                    if self.by_hand != at {
                        let (place, speed) = (self.point(at), self.hand_mm_s());
                        self.move_by_hand(place, speed)?;
                    }
                    if pen == Pen::Down {
                        let lower = EbbCommand::Pen { pen, duration_ms: self.settle_ms() };
                        self.next = Some((lower, at));
                    }
                    self.held = None;
                }
                self.planner.resume();
            }
            Phase::Unheard(_) => return Err(NotNow::Unheard),
            Phase::Stopped | Phase::Asking => return Err(NotNow::Locked),
            Phase::Drawing(_) | Phase::Ending(_) | Phase::Lifted(_) => return Err(NotNow::Draws),
            Phase::Done => return Err(NotNow::Nothing),
        }
        self.phase = Phase::Drawing(left);
        Ok(())
    }

    fn is_free(&self) -> Result<(), NotNow> {
        match self.phase {
            Phase::Ready | Phase::Paused | Phase::PenWanted(_) | Phase::SheetWanted | Phase::Done => Ok(()),
            Phase::Unheard(_) => Err(NotNow::Unheard),
            Phase::Stopped | Phase::Asking => Err(NotNow::Locked),
            Phase::Drawing(_) | Phase::Ending(_) | Phase::Lifted(_) => Err(NotNow::Draws),
        }
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
                // The board has taken the line: it would have refused it, or waits for room, and answers then.
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
        match request {
            Request::GoOn => self.go_on(None),
            Request::Next => self.go_on(Some(1)),
            Request::Pause => match self.phase {
                Phase::Drawing(_) => {
                    self.pause();
                    Ok(())
                }
                Phase::Ending(_) | Phase::Lifted(_) => Ok(()),
                _ => Err(NotNow::Nothing),
            },
            Request::Stop => {
                self.line = None;
                self.next = None;
                if !matches!(self.phase, Phase::Unheard(_)) {
                    self.phase = Phase::Stopped;
                }
                Ok(())
            }
            Request::Unlock => match self.phase {
                Phase::Stopped => {
                    self.phase = Phase::Asking;
                    Ok(())
                }
                _ => Err(NotNow::Nothing),
            },
            Request::ByHand(op) => {
                self.is_free()?;
                let speed = self.hand_mm_s();
                match op {
                    PlotOp::Travel { to } if self.pen == Pen::Up => self.move_by_hand(to, speed),
                    PlotOp::Draw { to, .. } if self.pen == Pen::Down => self.move_by_hand(to, speed),
                    PlotOp::Travel { .. } | PlotOp::Draw { .. } => {
                        if self.line.is_some() {
                            return Err(NotNow::Busy);
                        }
                        let pen = if self.pen == Pen::Up { Pen::Down } else { Pen::Up };
                        let command = EbbCommand::Pen { pen, duration_ms: self.settle_ms() };
                        self.send_command(Purpose::ByHand, command);
                        Ok(())
                    }
                    _ => Err(NotNow::NoWord),
                }
            }
            Request::Jog { by, feed_mm_s } => {
                self.is_free()?;
                if !(by.length() <= 1e4 && feed_mm_s > 0.0) {
                    return Err(NotNow::OutOfRange);
                }
                let to = self.point(self.by_hand) + by;
                self.move_by_hand(to, feed_mm_s.min(2.0 * self.hand_mm_s()))
            }
            Request::StandsAt(place) => {
                self.is_free()?;
                if !(place.x.abs() <= 1e4 && place.y.abs() <= 1e4) {
                    return Err(NotNow::OutOfRange);
                }
                let at = self.motion.kinematics().steps_at(place);
                let board =
                    [self.by_hand.x.wrapping_add(self.zero.x), self.by_hand.y.wrapping_add(self.zero.y)];
                let [x, y] = board;
                self.zero = StepPoint::new(x.wrapping_sub(at.x), y.wrapping_sub(at.y));
                match &mut self.held {
                    // Where the pen was lifted, it is now said to be elsewhere: it is put back there.
                    Some(_) => self.by_hand = at,
                    None => self.restart_at(at),
                }
                Ok(())
            }
            Request::Feed { percent } => {
                let percent = percent.clamp(10, 200);
                self.planner.override_speeds(f64::from(percent) / 100.0, 1.0);
                self.feed_percent = percent;
                Ok(())
            }
            Request::PenDownAt(position) => {
                self.is_free()?;
                if self.line.is_some() {
                    return Err(NotNow::Busy);
                }
                let [_, down] = &mut self.settings.servo;
                *down = position;
                self.send(Purpose::ByHand, format_args!("SC,5,{position}"));
                Ok(())
            }
            Request::Home | Request::EndJog => Err(NotNow::NoWord),
        }
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
            feed_percent: self.feed_percent,
            limits: MachineLimits { steps_per_mm: [steps_per_mm; 2], ..MachineLimits::default() },
        }
    }
}
