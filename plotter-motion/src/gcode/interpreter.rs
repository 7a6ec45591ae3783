//! [`Interpreter`]: lines in, plot operations out; [`LineInterpreter`]: the same without a memory for what a
//! line has given.

#[cfg(feature = "alloc")]
use super::PenConvention;
use super::error::Complaint;
use super::expansion::{Expansion, ends};
use super::line::Line;
use super::machine::Machine;
use super::{Block, BlockDelete, Error, Modes, Problem, ReadOptions, Text, Undrained, Words};
use crate::{PlotOp, Point, Vec2};

/// Most that one line gives.
const MOST_OUTCOMES: usize = 10;

/// What a line has given, in its order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Outcomes<C> {
    slots: [Option<Result<PlotOp, C>>; MOST_OUTCOMES],
    count: u8,
    taken: u8,
}

impl<C: Complaint> Outcomes<C> {
    // By itself, and written slot by slot: as a constant it is there as often as it is used, 648 bytes each.
    #[inline(never)]
    pub(crate) fn none() -> Self {
        Self { slots: core::array::from_fn(|_| None), count: 0, taken: 0 }
    }

    #[inline(never)] // for the sake of small processors
    pub(super) fn give(&mut self, outcome: Result<PlotOp, C>) {
        match self.slots.get_mut(usize::from(self.count)) {
            Some(slot) => {
                *slot = Some(outcome);
                self.count += 1;
            }
            None => debug_assert!(false, "a line gives at most {MOST_OUTCOMES} outcomes"),
        }
    }

    /// Puts something before what has been given.
    pub(super) fn give_first(&mut self, outcome: Result<PlotOp, C>) {
        let count = usize::from(self.count);
        self.give(outcome);
        if let Some(slots) = self.slots.get_mut(..=count) {
            slots.rotate_right(1);
        }
    }

    /// What has not been taken, in its order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Result<PlotOp, C>> {
        self.slots.iter().take(self.count.into()).flatten()
    }

    pub(crate) fn take(&mut self) -> Option<Result<PlotOp, C>> {
        if self.taken == self.count {
            (self.count, self.taken) = (0, 0);
            return None;
        }
        let slot = self.slots.get_mut(usize::from(self.taken));
        self.taken += 1;
        slot.and_then(Option::take)
    }
}

impl Outcomes<Error> {
    /// Adds what a pause asks for.
    fn put_text(&mut self, text: Text) {
        for outcome in self.slots.iter_mut().flatten() {
            if let Err(Error { problem, .. }) = outcome
                && let Problem::Unsupported { command, .. } = *problem
                && command.letter == b'M'
                && matches!(command.tenths(), Some(0 | 10))
            {
                *problem = Problem::Pause { command, text };
            }
        }
    }
}

/// Carries lines out: knows the pen, where it stands, and what coordinates mean.
///
/// Feed it what a [`Reader`](super::Reader) gives and take the operations after each line:
///
/// ```
/// # use plotter_motion::{PlotOp, Point, gcode};
/// let (mut reader, mut interpreter) = (gcode::Reader::new(), gcode::Interpreter::new());
/// let mut ops = Vec::new();
/// for byte in *b"G0 X1 Y2\nM3\nG91 G1 X10 F600\n" {
///     if let Some(block) = reader.push(byte) {
///         interpreter.push(block)?;
///     }
///     while let Some(op) = interpreter.next_op() {
///         ops.push(op?);
///     }
/// }
/// assert_eq!(
///     ops,
///     [
///         PlotOp::Travel { to: Point::new(1.0, 2.0) },
///         PlotOp::Draw { to: Point::new(11.0, 2.0), feed_mm_s: Some(10.0) },
///     ]
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// - A line is carried out whole or not at all; but the end of an arc that is none is gone to, with the pen
///   up. Within it speed, tool and pen come first, then `G4`, `G28` or `G92`, then the movement, then `M0` or
///   `M2`: the order of the standard.
/// - A pen that is lowered and lifted again without a movement leaves a dot, a line to where it stands.
/// - A pen that is lifted goes up with the travel that follows. Where a dwell, a pause or the end of the text
///   or program follows instead, a travel to where it stands lifts it.
/// - A line drawn by `G0`, and one before the first `F`, leaves its speed to the machine.
/// - The power of a laser is told before the first line that needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpreter {
    options: ReadOptions,
    line: LineInterpreter,
    expansion: Expansion,
    outcomes: Outcomes<Error>,
    /// The line in which the program has ended.
    ended: Option<u32>,
}

/// What of an [`Interpreter`] holds from one line to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LineInterpreter {
    machine: Machine,
}

impl Default for Interpreter {
    fn default() -> Self {
        Self::new()
    }
}

impl Interpreter {
    /// A machine that has just been switched on, with the default options: pen up at the origin, `G0`, `G17`,
    /// `G21`, `G90`, `G91.1`, `G94`.
    #[must_use]
    pub fn new() -> Self {
        Self::with_options(ReadOptions::default())
    }

    /// A machine that has just been switched on.
    #[must_use]
    pub fn with_options(options: ReadOptions) -> Self {
        Self {
            options,
            line: LineInterpreter::new(),
            expansion: Expansion::new(),
            outcomes: Outcomes::none(),
            ended: None,
        }
    }

    /// The same, with the pen lifted by `M5` and lowered by `M3`.
    #[cfg(feature = "alloc")]
    pub(super) fn with_spindle(self) -> Self {
        Self { options: ReadOptions { pen: PenConvention::Spindle, ..self.options }, ..self }
    }

    /// Takes the next line, or the error that the reader gave instead.
    ///
    /// # Errors
    ///
    /// [`Undrained`] when [`Interpreter::next_op`] still has something to give; the line is not taken.
    pub fn push(&mut self, block: Result<Block, Error>) -> Result<(), Undrained> {
        self.push_line(block.as_ref().map_err(|error| *error), Text::default())
    }

    /// The same, with a line that stays where it is.
    pub(super) fn push_line(&mut self, block: Result<&Block, Error>, text: Text) -> Result<(), Undrained> {
        self.drained()?;
        let before = (self.line, self.expansion);
        if let Err(error) = block.and_then(|block| self.carry_out(block)) {
            (self.line, self.expansion) = before;
            self.refuse(block.ok(), error);
        }
        self.outcomes.put_text(text);
        Ok(())
    }

    fn carry_out(&mut self, block: &Block) -> Result<(), Error> {
        let (line, options, out) = (&mut self.line, &self.options, &mut self.outcomes);
        if options.words.is_grbl() {
            return line.carry_out(block, options, out);
        }
        if block.is_deleted() && options.block_delete == BlockDelete::LeaveOut {
            return Ok(());
        }
        if ends(block) {
            self.ended = self.ended.or(Some(block.position().line));
        }
        self.expansion.carry_out(block, line, options, out)
    }

    /// Leaves a line out, or what is left of it. The end of an arc that is none is gone to with the pen up:
    /// what follows begins there.
    fn refuse(&mut self, block: Option<&Block>, error: Error) {
        self.outcomes = Outcomes::none();
        self.expansion.forget();
        let is_arc = matches!(
            error.problem,
            Problem::ArcForm | Problem::ArcWithoutEnd | Problem::ArcRadii { .. } | Problem::ArcRadius { .. }
        );
        if let (true, Some(block)) = (is_arc && self.options.words == Words::Any, block) {
            let before = self.line;
            if self.line.leave_out(block, &self.options, &mut self.outcomes).is_err() {
                (self.line, self.outcomes) = (before, Outcomes::none());
            }
        }
        self.outcomes.give_first(Err(error));
    }

    /// The line in which the program has ended, by `M2` or `M30`.
    pub(super) const fn ended(&self) -> Option<u32> {
        self.ended
    }

    /// Ends the drawing: a pen that has been lowered and never moved leaves its dot, one that has been lifted
    /// since its last line is lifted.
    ///
    /// # Errors
    ///
    /// As [`Interpreter::push`].
    pub fn finish(&mut self) -> Result<(), Undrained> {
        self.drained()?;
        if let Some(error) = self.expansion.cut_off() {
            self.outcomes.give(Err(error));
        }
        self.line.machine.leave_dot(&self.options, &mut self.outcomes);
        self.line.machine.lift(&mut self.outcomes);
        Ok(())
    }

    /// The next operation, or what could not be carried out; `None` when the next line is wanted.
    pub fn next_op(&mut self) -> Option<Result<PlotOp, Error>> {
        loop {
            if let Some(op) = self.expansion.next_of_arc() {
                return Some(Ok(op));
            }
            if let Some(outcome) = self.outcomes.take() {
                match outcome.map(|op| self.expansion.placed(op)) {
                    Ok(Some(op)) => return Some(Ok(op)),
                    Ok(None) => continue,
                    Err(error) => return Some(Err(error)),
                }
            }
            let block = self.expansion.next_block(&self.line, &self.options)?;
            let before = self.line;
            if let Err(error) = self.line.carry_out(&block, &self.options, &mut self.outcomes) {
                self.line = before;
                self.refuse(Some(&block), error);
            }
        }
    }

    /// The modes in force.
    #[must_use]
    pub fn modes(&self) -> Modes {
        let modes = self.line.modes();
        Modes { position: self.expansion.frame.apply(modes.position), ..modes }
    }

    /// The machine has been moved by something else, or stopped on its way: the pen stands at `point`, in mm
    /// on the sheet. What has been set by `G92` stays.
    pub fn stand_at(&mut self, point: Point) {
        self.line.stand_at(self.expansion.frame.inverse(point));
    }

    fn drained(&self) -> Result<(), Undrained> {
        if self.outcomes.taken == self.outcomes.count && !self.expansion.is_pending() {
            Ok(())
        } else {
            Err(Undrained)
        }
    }
}

impl LineInterpreter {
    /// A machine that has just been switched on.
    pub(crate) fn new() -> Self {
        Self { machine: Machine::new() }
    }

    /// Nothing of the line is left to come: a pen that it lifts goes up now, whatever the next line says and
    /// whenever it comes.
    pub(crate) fn lift<C: Complaint>(&mut self, out: &mut Outcomes<C>) {
        self.machine.lift(out);
    }

    /// As [`Interpreter::modes`].
    pub(crate) fn modes(&self) -> Modes {
        self.machine.modes()
    }

    /// As after a reset of the controller: the origins set by `G10` are kept, all else is not.
    pub(crate) fn reset(&mut self) {
        self.machine.reset();
    }

    /// Forgets what `G10`, `G28.1`, `G30.1` and `G92` have set.
    pub(crate) fn restore_origins(&mut self) {
        self.machine.restore_origins();
    }

    /// Where `G28`, or `G30`, goes, mm.
    pub(crate) const fn home_place(&self, second: bool) -> Point {
        self.machine.home_place(second)
    }

    /// Where `G10` has set the origin of a coordinate system, 0 for `G54` to 5 for `G59`, mm.
    pub(crate) fn origin(&self, system: u8) -> Vec2 {
        self.machine.origin(system)
    }

    /// What `G92` adds to that, mm.
    pub(crate) const fn shift(&self) -> Vec2 {
        self.machine.shift()
    }

    /// As [`Interpreter::stand_at`].
    pub(crate) fn stand_at(&mut self, point: Point) {
        self.machine.stand_at(point);
    }

    /// The number of the `G` that coordinates alone ask for.
    pub(super) const fn motion(&self) -> u8 {
        self.machine.motion_number()
    }

    /// The height that the text has told: mm, or what a servo makes of it.
    pub(super) const fn height(&self) -> f64 {
        self.machine.height_told()
    }

    pub(super) fn set_shift(&mut self, shift: Vec2) {
        self.machine.set_shift(shift);
    }

    /// Exchanges the origin of `G59` for another one.
    pub(super) fn exchange_last_origin(&mut self, origin: &mut Vec2) {
        self.machine.exchange_last_origin(origin);
    }

    /// The place where the pen stands has these coordinates from here on.
    pub(super) fn relocate(&mut self, point: Point) {
        self.machine.relocate(point);
    }

    /// Goes to the end of a movement that is left out, with the pen up.
    pub(super) fn leave_out(
        &mut self,
        block: &Block,
        options: &ReadOptions,
        out: &mut Outcomes<Error>,
    ) -> Result<(), Error> {
        self.machine.leave_out(&Line::read(block, options.words)?, options, out)
    }

    /// Puts a pen down that was told to go down and has not moved since: the operation that does so, and
    /// leaves its dot.
    pub(crate) fn put_down(&mut self) -> Option<PlotOp> {
        self.machine.put_down()
    }

    /// Where a line would have the pen travel, if it names a place, and its speed in mm/s: what a movement by
    /// hand is told. Nothing of it holds afterwards.
    pub(crate) fn travel<C: Complaint>(mut self, block: &Block) -> Result<(Option<Point>, Option<f64>), C> {
        let to = self.machine.travel(&Line::read(block, Words::GrblOnSheet)?)?;
        Ok((to, self.machine.modes().feed_mm_s))
    }

    /// Carries a line out. After an error neither the interpreter nor `out` is to be used: the line is left
    /// out as a whole.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn carry_out<C: Complaint>(
        &mut self,
        block: &Block,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) -> Result<(), C> {
        if block.is_deleted() && options.block_delete == BlockDelete::LeaveOut {
            return Ok(());
        }
        (out.count, out.taken) = (0, 0);
        self.machine.carry_out(&Line::read(block, options.words)?, options, out)
    }
}
