//! [`Drawing`]: pen strokes in pixel coordinates, and [`Scale`], the only road from there to the sheet.

use crate::stroke::curve::{CHORD_ERROR_PX, Course, are_handles, is_bulge};
use crate::stroke::stroke_op::stroke_ops;
use crate::stroke::{Curve, PxPoint};
use core::fmt;
use plotter_motion::{PlotOp, Point};
use std::borrow::Cow;

/// Pen strokes in the order in which they are drawn, in pixel coordinates. A stroke of one vertex is a dot.
/// Each stroke has a pen, a number in the carousel from 1. Vertices are joined by straight lines, arcs or
/// cubic curves: see [`Curve`].
///
/// ```
/// # use plotter_vector::{Drawing, PxPoint};
/// let mut drawing = Drawing::new(10, 10);
/// drawing.push([PxPoint::new(0.5, 0.5), PxPoint::new(3.5, 4.5)]);
/// drawing.push([PxPoint::new(3.5, 6.5), PxPoint::new(9.5, 6.5)]);
/// assert_eq!(drawing.vertices(), 4);
/// assert_eq!((drawing.pen_down_px(), drawing.pen_up_px()), (11.0, 2.0));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Drawing {
    width_px: u32,
    height_px: u32,
    vertices: Vec<PxPoint>,
    /// One past the last vertex of each stroke.
    ends: Vec<usize>,
    /// The pen of each stroke.
    #[cfg_attr(feature = "serde", serde(default))]
    pens: Vec<u8>,
    /// The bulge of the piece that begins at each vertex; empty as long as nothing is an arc.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    bulges: Vec<f64>,
    /// The handles of the piece that begins at each vertex; empty as long as nothing is a cubic curve.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    handles: Vec<Option<[PxPoint; 2]>>,
}

/// The pen of a stroke of which nothing else is said.
const FIRST_PEN: u8 = 1;

impl Drawing {
    /// An empty drawing on a picture of this size.
    #[must_use]
    pub const fn new(width_px: u32, height_px: u32) -> Self {
        Self {
            width_px,
            height_px,
            vertices: Vec::new(),
            ends: Vec::new(),
            pens: Vec::new(),
            bulges: Vec::new(),
            handles: Vec::new(),
        }
    }

    /// Width of the picture.
    #[must_use]
    pub const fn width_px(&self) -> u32 {
        self.width_px
    }

    /// Height of the picture.
    #[must_use]
    pub const fn height_px(&self) -> u32 {
        self.height_px
    }

    /// Adds a stroke of pen 1; one without vertices is left out.
    pub fn push(&mut self, stroke: impl IntoIterator<Item = PxPoint>) {
        self.push_with_pen(FIRST_PEN, stroke);
    }

    /// Adds a stroke of another pen; one without vertices is left out. Pen 0, which is no pen, is taken as 1.
    ///
    /// ```
    /// # use plotter_vector::{Drawing, PxPoint};
    /// let mut drawing = Drawing::new(4, 4);
    /// drawing.push_with_pen(3, [PxPoint::new(0.5, 0.5), PxPoint::new(3.5, 0.5)]);
    /// assert_eq!(drawing.pen(0), 3);
    /// ```
    pub fn push_with_pen(&mut self, pen: u8, stroke: impl IntoIterator<Item = PxPoint>) {
        let before = self.vertices.len();
        self.vertices.extend(stroke);
        if self.vertices.len() > before {
            self.ends.push(self.vertices.len());
            self.pens.push(pen.max(FIRST_PEN));
            if !self.bulges.is_empty() {
                self.bulges.resize(self.vertices.len(), 0.0);
            }
            if !self.handles.is_empty() {
                self.handles.resize(self.vertices.len(), None);
            }
        }
    }

    /// Adds a stroke that may have arcs and cubic curves; one without vertices is left out. Pens as with
    /// [`Drawing::push_with_pen`].
    ///
    /// ```
    /// # use plotter_vector::{Curve, Drawing, PxPoint};
    /// let (left, right) = (PxPoint::new(1.0, 3.0), PxPoint::new(5.0, 3.0));
    /// let mut drawing = Drawing::new(6, 6);
    /// let vertices = vec![left, right, left];
    /// drawing.push_curve(1, Curve { vertices, bulges: vec![1.0, 1.0], ..Curve::default() });
    /// assert!((drawing.pen_down_px() - 4.0 * std::f64::consts::PI).abs() < 1e-12); // a circle 4 px wide
    /// ```
    pub fn push_curve(&mut self, pen: u8, curve: Curve) {
        let before = self.vertices.len();
        let Curve { vertices, bulges, handles } = curve;
        self.push_with_pen(pen, vertices);
        // The last vertex begins nothing.
        let pieces = (self.vertices.len() - before).saturating_sub(1);
        let bulges = bulges.into_iter().take(pieces).map(|bulge| if is_bulge(bulge) { bulge } else { 0.0 });
        let handles = handles.into_iter().take(pieces).map(|handles| handles.filter(|at| are_handles(*at)));
        add(&mut self.bulges, before, bulges.collect(), self.vertices.len());
        add(&mut self.handles, before, handles.collect(), self.vertices.len());
    }

    /// Adds a stroke of another drawing.
    pub(crate) fn push_again(&mut self, other: &Self, index: usize) {
        if (other.bulges.is_empty() && other.handles.is_empty()) || other.course(index).is_straight() {
            self.push_with_pen(other.pen(index), other.stroke(index).iter().copied());
        } else {
            self.push_curve(other.pen(index), other.curve(index));
        }
    }

    /// The pen of a stroke, from 1; 1 when there is no such stroke.
    #[must_use]
    pub fn pen(&self, index: usize) -> u8 {
        self.pens.get(index).copied().unwrap_or(FIRST_PEN).max(FIRST_PEN)
    }

    /// The pens that draw something, each once, in ascending order.
    #[must_use]
    pub fn pens(&self) -> Vec<u8> {
        let mut pens: Vec<u8> = (0..self.ends.len()).map(|index| self.pen(index)).collect();
        pens.sort_unstable();
        pens.dedup();
        pens
    }

    /// The vertices of one stroke; empty when there is no such stroke. What lies between them:
    /// [`Drawing::bulges`].
    #[must_use]
    pub fn stroke(&self, index: usize) -> &[PxPoint] {
        self.range(index).and_then(|range| self.vertices.get(range)).unwrap_or(&[])
    }

    fn range(&self, index: usize) -> Option<core::ops::Range<usize>> {
        let start = index.checked_sub(1).map_or(Some(0), |before| self.ends.get(before).copied());
        start.zip(self.ends.get(index).copied()).map(|(start, end)| start..end)
    }

    /// The vertices of all strokes, one stroke after the other.
    pub(crate) fn all_vertices(&self) -> &[PxPoint] {
        &self.vertices
    }

    /// The numbers of a stroke's vertices among those of all strokes.
    pub(crate) fn vertices_of(&self, index: usize) -> core::ops::Range<usize> {
        self.range(index).unwrap_or_default()
    }

    /// Makes room for as many strokes and vertices as another drawing has.
    pub(crate) fn reserve_for(&mut self, other: &Self) {
        self.vertices.reserve_exact(other.vertices.len());
        self.ends.reserve_exact(other.ends.len());
        self.pens.reserve_exact(other.pens.len());
    }

    /// The bulges of one stroke, one for each vertex as in [`Curve::bulges`]; empty when all of it is
    /// straight.
    #[must_use]
    pub fn bulges(&self, index: usize) -> &[f64] {
        let bulges = self.range(index).and_then(|range| self.bulges.get(range)).unwrap_or(&[]);
        if bulges.iter().any(|bulge| is_bulge(*bulge)) { bulges } else { &[] }
    }

    /// The handles of the cubic curves of one stroke, one entry for each vertex as in [`Curve::handles`];
    /// empty when it has none.
    #[must_use]
    pub fn handles(&self, index: usize) -> &[Option<[PxPoint; 2]>] {
        let handles = self.range(index).and_then(|range| self.handles.get(range)).unwrap_or(&[]);
        if handles.iter().any(Option::is_some) { handles } else { &[] }
    }

    /// One stroke with its arcs and cubic curves; empty when there is no such stroke.
    #[must_use]
    pub fn curve(&self, index: usize) -> Curve {
        self.course(index).into()
    }

    pub(crate) fn course(&self, index: usize) -> Course<'_> {
        Course { vertices: self.stroke(index), bulges: self.bulges(index), handles: self.handles(index) }
    }

    /// Whether all strokes are straight lines.
    #[must_use]
    pub fn is_straight(&self) -> bool {
        let all = Course { vertices: &self.vertices, bulges: &self.bulges, handles: &self.handles };
        all.is_straight()
    }

    /// Whether any stroke has an arc.
    #[must_use]
    pub fn has_arcs(&self) -> bool {
        self.bulges.iter().any(|bulge| is_bulge(*bulge))
    }

    /// The same drawing of straight lines: arcs and cubic curves replaced by chords that lie no farther than
    /// `chord_error_px` from them.
    ///
    /// ```
    /// # use plotter_vector::{Curve, Drawing, PxPoint};
    /// let mut drawing = Drawing::new(10, 6);
    /// let vertices = vec![PxPoint::new(1.0, 5.0), PxPoint::new(9.0, 5.0)];
    /// drawing.push_curve(1, Curve { vertices, bulges: vec![1.0], ..Curve::default() });
    /// assert_eq!((drawing.vertices(), drawing.chords(0.54).vertices()), (2, 4)); // of 60 degrees each
    /// ```
    #[must_use]
    pub fn chords(&self, chord_error_px: f64) -> Cow<'_, Self> {
        if self.is_straight() {
            return Cow::Borrowed(self);
        }
        let mut straight = Self::new(self.width_px, self.height_px);
        for index in 0..self.ends.len() {
            straight
                .push_with_pen(self.pen(index), self.stroke_chords(index, chord_error_px).iter().copied());
        }
        Cow::Owned(straight)
    }

    /// One stroke of straight lines.
    pub(crate) fn stroke_chords(&self, index: usize, chord_error_px: f64) -> Cow<'_, [PxPoint]> {
        let course = self.course(index);
        if course.is_straight() {
            Cow::Borrowed(course.vertices)
        } else {
            Cow::Owned(course.chords(chord_error_px))
        }
    }

    /// The vertices of the strokes in order.
    pub fn strokes(&self) -> impl ExactSizeIterator<Item = &[PxPoint]> + DoubleEndedIterator {
        (0..self.ends.len()).map(|index| self.stroke(index))
    }

    /// What one pen draws, in the same order.
    ///
    /// ```
    /// # use plotter_vector::{Drawing, PxPoint};
    /// let mut drawing = Drawing::new(4, 4);
    /// drawing.push([PxPoint::new(0.5, 0.5)]);
    /// drawing.push_with_pen(3, [PxPoint::new(2.5, 0.5)]);
    /// assert_eq!(drawing.of_pen(3).stroke(0), [PxPoint::new(2.5, 0.5)]);
    /// ```
    #[must_use]
    pub fn of_pen(&self, pen: u8) -> Self {
        let mut one = Self::new(self.width_px, self.height_px);
        for index in (0..self.ends.len()).filter(|index| self.pen(*index) == pen) {
            one.push_curve(pen, self.curve(index));
        }
        one
    }

    /// Number of vertices of all strokes, as they are written: a closed stroke's first one counts twice.
    #[must_use]
    pub fn vertices(&self) -> usize {
        self.vertices.len()
    }

    /// Length drawn, px.
    #[must_use]
    pub fn pen_down_px(&self) -> f64 {
        (0..self.ends.len()).map(|index| self.course(index).length_px()).fold(0.0, |sum, px| sum + px)
    }

    /// Length travelled with the pen up from each stroke's end to the next one's start, px. The ways from and
    /// to the machine's home are not in it: the drawing does not know where that is.
    #[must_use]
    pub fn pen_up_px(&self) -> f64 {
        let travel = |(from, to): (&[PxPoint], &[PxPoint])| Some(from.last()?.distance(*to.first()?));
        // A sum of no numbers is -0, which would be shown.
        self.strokes().zip(self.strokes().skip(1)).filter_map(travel).fold(0.0, |sum, px| sum + px)
    }

    /// What selects the pen of a stroke, where it is another one than before.
    pub(crate) fn select_pen(&self, index: usize) -> Option<PlotOp> {
        let pen = self.pen(index);
        let changes = match index.checked_sub(1) {
            Some(before) => self.pen(before) != pen,
            // Before the first stroke, unless the whole drawing is of the plotter's own.
            None => self.pens.iter().any(|pen| *pen > FIRST_PEN),
        };
        changes.then_some(PlotOp::SelectPen { pen })
    }

    /// The operations that draw it on the sheet: to each stroke's start with the pen up, along it with the
    /// pen down. A dot is drawn from its place to its place. The pen is selected where it changes, and before
    /// the first stroke unless the whole drawing is of pen 1: that is the plotter's own. Arcs and cubic
    /// curves come as chords no farther than 0.02 px from them.
    pub fn plot_ops(&self, scale: Scale) -> impl Iterator<Item = PlotOp> + '_ {
        (0..self.ends.len()).flat_map(move |index| {
            let stroke = self.stroke_chords(index, CHORD_ERROR_PX);
            let select = self.select_pen(index);
            let start = stroke.first().copied();
            let dot = if stroke.len() == 1 { start } else { None };
            let travel = start.map(|to| PlotOp::Travel { to: scale.to_sheet(to) });
            let draw = move |to| PlotOp::Draw { to: scale.to_sheet(to), feed_mm_s: None };
            let rest = (1..stroke.len()).filter_map(move |vertex| stroke.get(vertex).copied());
            select.into_iter().chain(travel).chain(rest.chain(dot).map(draw))
        })
    }

    /// The same, but that arcs stay arcs: [`PlotOp::DrawArc`].
    ///
    /// ```
    /// # use plotter_vector::{Curve, Drawing, PxPoint, Scale};
    /// use plotter_motion::{PlotOp, Point};
    /// let vertices = vec![PxPoint::new(2.0, 10.0), PxPoint::new(18.0, 10.0)];
    /// let mut drawing = Drawing::new(20, 10);
    /// drawing.push_curve(1, Curve { vertices, bulges: vec![1.0], ..Curve::default() }); // half a circle over the top
    /// let ops: Vec<PlotOp> = drawing.plot_ops_with_arcs(Scale::new(10, 0.5, Point::ORIGIN)?).collect();
    /// let (centre, to) = (Point::new(5.0, 0.0), Point::new(9.0, 0.0));
    /// assert_eq!(ops[1], PlotOp::DrawArc { centre, sweep_rad: -std::f64::consts::PI, to, feed_mm_s: None });
    /// # Ok::<(), plotter_vector::stroke::ScaleError>(())
    /// ```
    pub fn plot_ops_with_arcs(&self, scale: Scale) -> impl Iterator<Item = PlotOp> + '_ {
        (0..self.ends.len())
            .flat_map(move |index| self.select_pen(index).into_iter().chain(stroke_ops(self, index, scale)))
    }

    /// The same of a drawing that nobody else needs: a list of all operations takes some three times its
    /// memory.
    ///
    /// ```
    /// # use plotter_vector::{Drawing, PxPoint, Scale};
    /// # use plotter_motion::{PlotOp, Point};
    /// let mut drawing = Drawing::new(20, 10);
    /// drawing.push([PxPoint::new(2.0, 10.0), PxPoint::new(18.0, 10.0)]);
    /// let mut ops = drawing.into_plot_ops_with_arcs(Scale::new(10, 0.5, Point::ORIGIN)?);
    /// assert_eq!(ops.next(), Some(PlotOp::Travel { to: Point::new(1.0, 0.0) }));
    /// # Ok::<(), plotter_vector::stroke::ScaleError>(())
    /// ```
    pub fn into_plot_ops_with_arcs(self, scale: Scale) -> impl Iterator<Item = PlotOp> {
        (0..self.ends.len()).flat_map(move |index| {
            let select = self.select_pen(index);
            select.into_iter().chain(stroke_ops(&self, index, scale)).collect::<Vec<PlotOp>>()
        })
    }
}

/// Adds what belongs to the pieces of a stroke that begins at the vertex `before`, the last of `count`;
/// nothing where it says nothing.
fn add<T: Clone + Default + PartialEq>(all: &mut Vec<T>, before: usize, own: Vec<T>, count: usize) {
    if own.iter().any(|one| *one != T::default()) {
        all.resize(before, T::default());
        all.extend(own);
        all.resize(count, T::default());
    }
}

/// From places on a picture (px, y down) to places on the sheet (mm, y up).
///
/// ```
/// # use plotter_vector::{PxPoint, Scale};
/// use plotter_motion::Point;
/// // A picture of 400 x 300 px into 100 x 100 mm with a margin of 10 mm: 80 mm for 400 px.
/// let scale = Scale::fit(400, 300, Point::ORIGIN, Point::new(100.0, 100.0), 10.0)?;
/// assert_eq!(scale.mm_per_px(), 0.2);
/// assert_eq!(scale.to_sheet(PxPoint::new(0.0, 300.0)), Point::new(10.0, 20.0)); // centred: (100 - 60) / 2
/// # Ok::<(), plotter_vector::stroke::ScaleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    mm_per_px: f64,
    /// Where the picture's upper left corner lies.
    upper_left: Point,
}

/// Why a picture cannot be brought onto a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ScaleError {
    /// The scale is not a positive number.
    NotPositive {
        /// Asked scale.
        mm_per_px: f64,
    },
    /// A corner of the area is not a number.
    NotFinite,
    /// Nothing is left of the area inside the margin.
    NoRoom {
        /// Width inside the margin, mm.
        width_mm: f64,
        /// Height inside the margin, mm.
        height_mm: f64,
    },
}

impl fmt::Display for ScaleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPositive { mm_per_px } => {
                write!(
                    f,
                    "scale: {mm_per_px} mm per px is not a positive number; 0.1 gives 254 dots per inch"
                )
            }
            Self::NotFinite => f.write_str("area: a corner or the margin is not a number; give mm"),
            Self::NoRoom { width_mm, height_mm } => write!(
                f,
                "area: {width_mm:.3} x {height_mm:.3} mm are left inside the margin; take a larger area or a \
                 smaller margin"
            ),
        }
    }
}

impl core::error::Error for ScaleError {}

impl Scale {
    /// A picture of `height_px` rows whose **lower left** corner lies at `origin`.
    ///
    /// # Errors
    /// [`ScaleError::NotPositive`] and [`ScaleError::NotFinite`].
    pub fn new(height_px: u32, mm_per_px: f64, origin: Point) -> Result<Self, ScaleError> {
        if !(mm_per_px > 0.0 && mm_per_px.is_finite()) {
            return Err(ScaleError::NotPositive { mm_per_px });
        }
        let upper_left = Point::new(origin.x, origin.y + f64::from(height_px) * mm_per_px);
        if !upper_left.is_finite() {
            return Err(ScaleError::NotFinite);
        }
        Ok(Self { mm_per_px, upper_left })
    }

    /// The largest scale at which the picture fits between two corners less a margin all round; centred. A
    /// picture without pixels is taken as one of 1 px.
    ///
    /// # Errors
    /// [`ScaleError::NotFinite`] and [`ScaleError::NoRoom`].
    pub fn fit(
        width_px: u32,
        height_px: u32,
        lower_left: Point,
        upper_right: Point,
        margin_mm: f64,
    ) -> Result<Self, ScaleError> {
        if !(lower_left.is_finite() && upper_right.is_finite() && margin_mm.is_finite()) {
            return Err(ScaleError::NotFinite);
        }
        let width_mm = upper_right.x - lower_left.x - 2.0 * margin_mm;
        let height_mm = upper_right.y - lower_left.y - 2.0 * margin_mm;
        if !(width_mm > 0.0 && height_mm > 0.0) {
            return Err(ScaleError::NoRoom { width_mm, height_mm });
        }
        let (width, height) = (f64::from(width_px.max(1)), f64::from(height_px.max(1)));
        let mm_per_px = (width_mm / width).min(height_mm / height);
        let left = (lower_left.x + upper_right.x - width * mm_per_px) / 2.0;
        let bottom = (lower_left.y + upper_right.y - height * mm_per_px) / 2.0;
        Self::new(height_px.max(1), mm_per_px, Point::new(left, bottom))
    }

    /// Size of a pixel on the sheet, mm.
    #[must_use]
    pub const fn mm_per_px(self) -> f64 {
        self.mm_per_px
    }

    /// Where a place on the picture lies on the sheet, mm.
    #[must_use]
    pub fn to_sheet(self, at: PxPoint) -> Point {
        Point::new(self.upper_left.x + at.x * self.mm_per_px, self.upper_left.y - at.y * self.mm_per_px)
    }

    /// Where a place on the sheet lies on the picture.
    #[must_use]
    pub fn to_picture(self, at: Point) -> PxPoint {
        PxPoint::new((at.x - self.upper_left.x) / self.mm_per_px, (self.upper_left.y - at.y) / self.mm_per_px)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_stroke_has_no_travel_and_no_sign() {
        let mut drawing = Drawing::new(2, 2);
        drawing.push([PxPoint::new(0.5, 0.5), PxPoint::new(1.5, 0.5)]);
        assert_eq!(format!("{:.1}", drawing.pen_up_px()), "0.0");
    }

    #[test]
    fn a_dot_is_drawn_from_its_place_to_its_place() {
        let mut drawing = Drawing::new(2, 2);
        drawing.push([PxPoint::new(0.5, 0.5)]);
        let ops: Vec<PlotOp> = drawing.plot_ops(Scale::new(2, 1.0, Point::ORIGIN).unwrap()).collect();
        let at = Point::new(0.5, 1.5);
        assert_eq!(ops, [PlotOp::Travel { to: at }, PlotOp::Draw { to: at, feed_mm_s: None }]);
    }

    /// Half a circle of radius 4 about (5, 5), clockwise as seen, over the top.
    fn half() -> Curve {
        let vertices = vec![PxPoint::new(1.0, 5.0), PxPoint::new(9.0, 5.0)];
        Curve { vertices, bulges: vec![1.0], ..Curve::default() }
    }

    #[test]
    fn arcs_cost_nothing_where_there_are_none() {
        let line = [PxPoint::new(0.5, 0.5), PxPoint::new(3.5, 0.5)];
        let (mut one, mut other) = (Drawing::new(4, 4), Drawing::new(4, 4));
        one.push(line);
        other.push_curve(
            1,
            Curve { vertices: line.to_vec(), bulges: vec![0.0, f64::NAN], handles: vec![None] },
        );
        assert_eq!(one, other);
        assert!(one.is_straight() && other.bulges.is_empty() && other.handles.is_empty());
    }

    #[test]
    fn each_stroke_keeps_its_own_bulges() {
        let mut drawing = Drawing::new(10, 10);
        let dot = [PxPoint::new(0.5, 0.5)];
        drawing.push(dot);
        drawing.push_curve(2, half());
        drawing.push([dot[0], PxPoint::new(2.5, 0.5)]);
        drawing.push_curve(3, half());
        let bulges: Vec<usize> = (0..5).map(|index| drawing.bulges(index).len()).collect();
        assert_eq!(bulges, [0, 2, 0, 2, 0]);
        assert_eq!(drawing.of_pen(3).curve(0), drawing.curve(3));
        assert!(!drawing.of_pen(1).has_arcs());
    }

    #[test]
    fn each_stroke_keeps_its_own_handles() {
        let mut drawing = Drawing::new(10, 10);
        let wave = Some([PxPoint::new(2.0, 1.0), PxPoint::new(7.0, 9.0)]);
        drawing.push([PxPoint::new(0.5, 0.5)]);
        drawing.push_curve(2, Curve { handles: vec![wave, wave], ..half() });
        drawing.push_curve(3, half());
        assert_eq!(drawing.handles(1), [wave, None]); // the last vertex begins nothing
        assert_eq!(drawing.curve(2), Curve { bulges: vec![1.0, 0.0], ..half() });
        assert!(drawing.of_pen(2).curve(0) == drawing.curve(1) && !drawing.of_pen(2).is_straight());
        // The handles win: three control places on each side of the chord, the middle is on it.
        assert!(drawing.stroke_chords(1, 0.01).iter().any(|at| at.distance(PxPoint::new(4.625, 5.0)) < 0.3));
    }

    #[test]
    fn arcs_are_drawn_as_chords_over_the_right_side() {
        let mut drawing = Drawing::new(10, 10);
        drawing.push_curve(1, half());
        let scale = Scale::new(10, 1.0, Point::ORIGIN).unwrap();
        let places: Vec<Point> = drawing.plot_ops(scale).filter_map(PlotOp::target).collect();
        assert_eq!(places.first(), Some(&Point::new(1.0, 5.0)));
        assert_eq!(places.last(), Some(&Point::new(9.0, 5.0)));
        let centre = Point::new(5.0, 5.0);
        assert!(places.iter().all(|at| (at.distance(centre) - 4.0).abs() < 1e-9 && at.y >= 5.0));
        assert!(places.len() > 10);
    }

    #[test]
    fn the_pen_is_selected_where_it_changes() {
        let dot = [PxPoint::new(0.5, 0.5)];
        let scale = Scale::new(2, 1.0, Point::ORIGIN).unwrap();
        let selected = |pens: &[u8]| -> Vec<(usize, u8)> {
            let mut drawing = Drawing::new(2, 2);
            pens.iter().for_each(|pen| drawing.push_with_pen(*pen, dot));
            let ops = drawing.plot_ops(scale).enumerate();
            ops.filter_map(|(at, op)| if let PlotOp::SelectPen { pen } = op { Some((at, pen)) } else { None })
                .collect()
        };
        assert_eq!(selected(&[1, 0, 1]), []);
        assert_eq!(selected(&[1, 2, 2, 1]), [(0, 1), (3, 2), (8, 1)]);
        assert_eq!(selected(&[3]), [(0, 3)]);
    }

    #[test]
    fn a_scale_that_is_no_scale_is_refused_with_its_value() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Scale::new(1, bad, Point::ORIGIN).is_err());
        }
        let error = Scale::fit(1, 1, Point::ORIGIN, Point::new(10.0, 30.0), 5.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "area: 0.000 x 20.000 mm are left inside the margin; take a larger area or a smaller margin"
        );
    }

    #[test]
    fn a_fitted_picture_stays_inside_the_margin() {
        let scale = Scale::fit(10, 40, Point::new(-5.0, 0.0), Point::new(95.0, 50.0), 5.0).unwrap();
        assert_eq!(scale.to_sheet(PxPoint::new(0.0, 0.0)), Point::new(40.0, 45.0));
        assert_eq!(scale.to_sheet(PxPoint::new(10.0, 40.0)), Point::new(50.0, 5.0));
    }
}
