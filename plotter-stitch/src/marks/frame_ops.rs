//! [`frame_ops`]: what the machine does for a frame, in order.

use crate::{Field, FrameTransform};
use alloc::vec::Vec;
use plotter_motion::{PlotOp, Point, Vec2};

/// The marks of a frame with their pen, then its drawing, all where they must be drawn on the machine.
///
/// `drawn` is how the frame lies, from its own place on the table; `strokes` are the marks as they are looked
/// for at the next frame change, as [`JoinFrames::strokes`](crate::sheet::JoinFrames::strokes) gives them;
/// `frame` are the operations of the frame in its own coordinates, as [`Frame::ops`](crate::Frame::ops) gives
/// them. With `pen` marks are drawn with that pen; the drawing then has to choose its own, as that of `Frame`
/// does wherever the whole drawing chose one.
///
/// Source: Ivanov, Gueorguiev, Georgieva, Nenova, "Sketch drawing on infinite paper sheets", section IV: the
/// new lines' coordinates are computed, "these lines are drawn and after that the system starts to draw the
/// all frame".
///
/// ```
/// use plotter_motion::{PlotOp, Point, Vec2};
/// use plotter_stitch::{Field, FrameTransform, marks::frame_ops};
///
/// let field = Field::default();
/// let drawn = FrameTransform::new(0.0, Vec2::new(1.0, 2.0))?; // the paper lies 1 mm to the right and 2 mm too far up
/// // A Y marker at the frame's end; that is where the next frame begins, at y = 20.
/// let strokes = vec![[Point::new(-40.0, 20.0), Point::new(-24.0, 20.0)]];
/// let line = [PlotOp::SelectPen { pen: 1 }, PlotOp::Draw { to: Point::new(100.0, 0.0), feed_mm_s: None }];
/// let ops: Vec<_> = frame_ops(&field, &drawn, strokes, Some(3), line).collect();
/// assert_eq!(ops, [
///     PlotOp::SelectPen { pen: 3 },
///     PlotOp::Travel { to: Point::new(-39.0, 972.0) },
///     PlotOp::Draw { to: Point::new(-23.0, 972.0), feed_mm_s: None },
///     PlotOp::SelectPen { pen: 1 },
///     PlotOp::Draw { to: Point::new(111.0, 22.0), feed_mm_s: None },
/// ]);
/// # Ok::<(), plotter_stitch::joint::TransformError>(())
/// ```
pub fn frame_ops<I: IntoIterator<Item = PlotOp>>(
    field: &Field,
    drawn: &FrameTransform,
    strokes: Vec<[Point; 2]>,
    pen: Option<u8>,
    frame: I,
) -> impl Iterator<Item = PlotOp> + use<I> {
    let (drawn, corner, frame_mm) = (*drawn, field.corner(), field.frame_mm);
    // Marks at a frame's end lie a frame's length farther now than when they are looked for.
    let mark = move |place: Point| drawn.to_machine(place + Vec2::new(0.0, frame_mm));
    let select = pen.filter(|_| !strokes.is_empty()).map(|pen| PlotOp::SelectPen { pen });
    let marks = strokes.into_iter().flat_map(move |[from, to]| {
        [PlotOp::Travel { to: mark(from) }, PlotOp::Draw { to: mark(to), feed_mm_s: None }]
    });
    let on_table = FrameTransform::new(0.0, corner).map_or(drawn, |corner| drawn.after(&corner));
    select.into_iter().chain(marks).chain(frame.into_iter().map(move |op| on_table.op_to_machine(op)))
}
