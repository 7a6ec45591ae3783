//! [`Frames`] and [`FramePasses`]: the frames of a drawing, one after the other.

use super::gather::Gatherer;
use super::{Frame, FrameLayout, SplitError};
use plotter_motion::PlotOp;

/// The frames of a drawing whose strokes come in the order of the sheet, in one pass.
///
/// A frame is given out as soon as something is drawn beyond the one after it, so that two frames at most are
/// held, however long the drawing: a stroke may always go back by a frame's length from the farthest place
/// yet. One that goes back to a frame that is gone is an error, which names it. For drawings in any other
/// order there is [`FramePasses`].
///
/// Lines that cross a border are cut into two pieces that meet in one place, the *break point*; arcs are cut
/// into arcs. Within [`FrameLayout::window_mm`] of the border a line that begins, ends or turns back is not
/// cut at all, and one that goes through is cut where the least is spoilt if the frames do not meet
/// perfectly: away from corners and other lines, and where it is not shallow to the border.
///
/// ```
/// use plotter_motion::{PlotOp, Point};
/// use plotter_stitch::{FrameLayout, Frames};
///
/// // A line of 25 mm over frames of 10 mm.
/// let layout = FrameLayout { frame_mm: 10.0, window_mm: 0.0, ..FrameLayout::default() };
/// let line = [PlotOp::Draw { to: Point::new(5.0, 25.0), feed_mm_s: None }];
/// let frames: Vec<_> = Frames::new(line, layout).collect::<Result<_, _>>()?;
/// assert_eq!(frames.len(), 3);
///
/// // It is at x = 2 where it crosses y = 10; the second frame has its own coordinates.
/// let ops: Vec<PlotOp> = frames[1].ops().collect();
/// assert_eq!(ops[0], PlotOp::Travel { to: Point::new(2.0, 0.0) });
/// assert_eq!(ops[1], PlotOp::Draw { to: Point::new(4.0, 10.0), feed_mm_s: None });
/// assert_eq!(frames[0].end_breaks(), frames[1].begin_breaks());
/// # Ok::<(), plotter_stitch::SplitError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Frames<I> {
    ops: I,
    gatherer: Gatherer,
    next: u32,
    state: State,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// The layout has not been looked at.
    New,
    Reading,
    /// Everything has been read.
    Read,
    Over,
}

impl<I: Iterator<Item = PlotOp>> Frames<I> {
    /// The frames of a drawing, from the pen lifted at the origin.
    pub fn new(ops: impl IntoIterator<IntoIter = I>, layout: FrameLayout) -> Self {
        Self { ops: ops.into_iter(), gatherer: Gatherer::all(layout), next: 0, state: State::New }
    }

    fn advance(&mut self) -> Result<Option<Frame>, SplitError> {
        if self.state == State::New {
            self.gatherer.layout().check()?;
            self.state = State::Reading;
        }
        while self.state == State::Reading {
            if self.gatherer.is_beyond() {
                let frame = self.close();
                self.gatherer.go_on()?;
                return Ok(Some(frame));
            }
            match self.ops.next() {
                Some(op) => self.gatherer.push(op)?,
                None => self.state = State::Read,
            }
        }
        if self.gatherer.last().is_none() {
            return Err(SplitError::Empty);
        }
        Ok(self.gatherer.holds_from(self.next).then(|| self.close()))
    }

    fn close(&mut self) -> Frame {
        let frame = self.gatherer.close(self.next);
        self.next = self.next.saturating_add(1);
        frame
    }
}

impl<I: Iterator<Item = PlotOp>> Iterator for Frames<I> {
    type Item = Result<Frame, SplitError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.state == State::Over {
            return None;
        }
        let frame = self.advance().transpose();
        if !matches!(frame, Some(Ok(_))) {
            self.state = State::Over;
        }
        frame
    }
}

/// The frames of a drawing in any order, read once for each frame.
///
/// The drawing is a function that gives its operations from the start: `|| file_again()`, or
/// `|| ops.iter().copied()`. One frame is held at a time. The frames are those of [`Frames`], to the last
/// bit, where strokes go back by no more than a frame's length; and any frame can be had by itself: after a
/// stop the work goes on with [`FramePasses::frame`].
///
/// ```
/// use plotter_motion::{PlotOp, Point};
/// use plotter_stitch::{FrameLayout, split::FramePasses};
///
/// // From the third frame back into the first: no order to stream in.
/// let layout = FrameLayout { frame_mm: 10.0, window_mm: 0.0, ..FrameLayout::default() };
/// let ops = [PlotOp::Travel { to: Point::new(5.0, 25.0) }, PlotOp::Draw { to: Point::new(1.0, 5.0), feed_mm_s: None }];
/// let passes = FramePasses::new(|| ops, layout);
/// let lengths: Vec<usize> = passes.map(|frame| Ok(frame?.ops().count())).collect::<Result<_, plotter_stitch::SplitError>>()?;
/// assert_eq!(lengths, [2, 2, 2]); // in each a travel and a line
/// # Ok::<(), plotter_stitch::SplitError>(())
/// ```
#[derive(Clone, Debug)]
pub struct FramePasses<F> {
    drawing: F,
    layout: FrameLayout,
    next: Option<u32>,
}

impl<F, I> FramePasses<F>
where
    F: FnMut() -> I,
    I: IntoIterator<Item = PlotOp>,
{
    /// The frames of the drawing that `drawing` gives anew at each call, from the pen lifted at the origin.
    pub fn new(drawing: F, layout: FrameLayout) -> Self {
        Self { drawing, layout, next: Some(0) }
    }

    /// One frame by itself; `None` beyond the end of the drawing.
    ///
    /// # Errors
    ///
    /// [`SplitError`] for an operation that cannot be divided, wherever it lies; never
    /// [`SplitError::OutOfOrder`].
    pub fn frame(&mut self, index: u32) -> Result<Option<Frame>, SplitError> {
        self.layout.check()?;
        let mut gatherer = Gatherer::only(self.layout, index);
        for op in (self.drawing)() {
            gatherer.push(op)?;
        }
        let last = gatherer.last().ok_or(SplitError::Empty)?;
        let frame = gatherer.close(index);
        // What reaches into the window at the last border may all belong to the frame before it.
        Ok((index < last || (index == last && !frame.is_empty())).then_some(frame))
    }
}

impl<F, I> Iterator for FramePasses<F>
where
    F: FnMut() -> I,
    I: IntoIterator<Item = PlotOp>,
{
    type Item = Result<Frame, SplitError>;

    fn next(&mut self) -> Option<Self::Item> {
        let index = self.next?;
        let frame = self.frame(index).transpose();
        self.next = if matches!(frame, Some(Ok(_))) { index.checked_add(1) } else { None };
        frame
    }
}
