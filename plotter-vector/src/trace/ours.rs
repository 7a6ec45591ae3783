//! [`Ours`]: what the vectorization of this crate asks for, and its steps.

use crate::areas::{AreaPath, AreaStyle, Areas, Islands, Opening};
use crate::centreline::centrelines::Centring;
use crate::ink::hairlines::Hairlines;
use crate::ink::pen::Pen;
use crate::ink::{Despeckled, despeckle, smallest_mark_px};
use crate::order::{Lettering, Order};
use crate::picture::{Bitmap, Figures, Gray};
use crate::raster::ThinningMethod;
use crate::report::coverage::{AreaPen, Index};
use crate::stroke::clip_to_picture::within;
use crate::stroke::{Bounded, Curve, Drawing, Pieces, PxPoint};
use crate::trace::VectorizeError;
use crate::trace::bare_ink::BareInk;

/// What of the ink is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Mode {
    /// A stroke down the middle of each line; what is far wider than the lines is outlined.
    #[default]
    Centreline,
    /// The outlines of everything. What a pen of [`Areas::pen_px`] cannot go around inside, as lines up to
    /// its width, is drawn along its middle.
    Outline,
    /// As `Centreline`, and areas begin already at three times the width of the lines; they are drawn in
    /// [`Ours::areas`]' style.
    Mixed,
}

/// What is given up where one stroke a line leaves ink bare: lines that run into one, corners, counters
/// that are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Prefer {
    /// No stroke is added: fewest strokes, and what is bare by more than the tolerance is told by the errors.
    Strokes,
    /// Strokes are added where lines run into one, and wherever else more than spots are bare and the pen
    /// fits into the ink. A spot is half a pixel off, which the raster leaves open, or no larger than what a
    /// round pen leaves bare in the corner of a square.
    #[default]
    Both,
    /// Strokes are added for spots too.
    Ink,
}

/// Settings of ours: the middle of each line, its crossings and corners where they are, few vertices within a
/// promised error, strokes ordered for little travel.
///
/// Drawings of lines one pixel wide are tracked pixel by pixel: there the raster is the line. Those with grey
/// rims are centred as wider ones are.
///
/// ```
/// use plotter_vector::{Bitmap, Mode, Ours, Vectorizer};
/// let ink = Bitmap::from_picture(&"############\n".repeat(12))?;
/// let outlined = Vectorizer::from(Ours::default().with_mode(Mode::Outline)).trace(&ink)?;
/// let stroke = outlined.drawing.stroke(0);
/// assert_eq!((stroke.len(), stroke.first()), (5, stroke.last()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct Ours {
    /// The promise that nothing lies farther from the segment that replaced it, px, more than 0: of lines one
    /// pixel wide each pixel, of wider ones each point of the line down their middle. Marks up to 32 px wide
    /// and high (lettering) are then drawn again as a whole, their vertices where a pen leaves the ink that
    /// is there.
    pub tolerance_px: f64,
    /// What strokes are made of, with the same promise.
    pub pieces: Pieces,
    /// What is drawn.
    pub mode: Mode,
    /// Whether ink that one stroke a line leaves bare is worth more strokes.
    pub prefer: Prefer,
    /// Smaller marks of ink are dirt, and smaller holes in it too, px; `None` for what a pen of the lines'
    /// width cannot have made.
    pub smallest_mark_px: Option<u32>,
    /// What is wider is no line but an area, px; `None` for 6 times the lines' width, in mixed mode 3 times.
    /// It is at least what the pen of [`Ours::areas`] needs to find its way inside.
    pub max_line_px: Option<u32>,
    /// How lines are thinned.
    pub thinning: ThinningMethod,
    /// How areas are drawn.
    pub areas: Areas,
    /// Strokes that go on in each other beyond a gap of so much become one, px; `None` for three widths of
    /// the lines where strokes have grain and gaps, two in other pictures whose ink no single level tells,
    /// and nothing in others.
    pub gap_px: Option<f64>,
    /// Strokes shorter than this are left out, px; 0 for none.
    pub min_stroke_px: f64,
    /// The order of the strokes. What it leaves apart becomes one where two ends are no farther from each
    /// other than the thinnest lines are wide.
    pub order: Order,
    /// Rows that are worked on at a time. A measure of memory alone: it changes no result.
    pub band_rows: u32,
}

impl Default for Ours {
    /// To half a pixel, everything found from the picture, straight lines only, areas outlined by a pen of
    /// one pixel.
    fn default() -> Self {
        Self {
            tolerance_px: Bounded::default().tolerance_px,
            pieces: Pieces::default(),
            mode: Mode::default(),
            prefer: Prefer::default(),
            smallest_mark_px: None,
            max_line_px: None,
            thinning: ThinningMethod::default(),
            areas: Areas { style: AreaStyle::Outline, pen_px: 1.0 },
            gap_px: None,
            min_stroke_px: 0.0,
            order: Order { lettering: Some(Lettering::default()), ..Order::default() },
            band_rows: 2048,
        }
    }
}

impl Ours {
    /// The same with another promise, px, more than 0: [`Ours::tolerance_px`].
    #[must_use]
    pub const fn with_tolerance_px(self, tolerance_px: f64) -> Self {
        Self { tolerance_px, ..self }
    }

    /// The same with strokes made of other pieces.
    #[must_use]
    pub const fn with_pieces(self, pieces: Pieces) -> Self {
        Self { pieces, ..self }
    }

    /// The same with another choice of what is drawn.
    #[must_use]
    pub const fn with_mode(self, mode: Mode) -> Self {
        Self { mode, ..self }
    }

    /// The same with another choice between fewer strokes and less bare ink.
    #[must_use]
    pub const fn with_prefer(self, prefer: Prefer) -> Self {
        Self { prefer, ..self }
    }

    /// The same with marks of fewer pixels as dirt; 0 for none.
    #[must_use]
    pub const fn with_smallest_mark_px(self, smallest_mark_px: u32) -> Self {
        Self { smallest_mark_px: Some(smallest_mark_px), ..self }
    }

    /// The same with the widest line, px.
    #[must_use]
    pub const fn with_max_line_px(self, max_line_px: u32) -> Self {
        Self { max_line_px: Some(max_line_px), ..self }
    }

    /// The same with another thinning.
    #[must_use]
    pub const fn with_thinning(self, thinning: ThinningMethod) -> Self {
        Self { thinning, ..self }
    }

    /// The same with areas drawn otherwise.
    #[must_use]
    pub const fn with_areas(self, areas: Areas) -> Self {
        Self { areas, ..self }
    }

    /// The same with strokes joined over gaps of so much, px; 0 for none.
    #[must_use]
    pub const fn with_gap_px(self, gap_px: f64) -> Self {
        Self { gap_px: Some(gap_px), ..self }
    }

    /// The same with strokes shorter than this left out, px; 0 for none.
    #[must_use]
    pub const fn with_min_stroke_px(self, min_stroke_px: f64) -> Self {
        Self { min_stroke_px, ..self }
    }

    /// The same with another order of the strokes.
    #[must_use]
    pub const fn with_order(self, order: Order) -> Self {
        Self { order, ..self }
    }

    /// The same with another number of rows that are worked on at a time.
    #[must_use]
    pub const fn with_band_rows(self, band_rows: u32) -> Self {
        Self { band_rows, ..self }
    }

    /// The simplification that keeps the promise.
    pub(crate) const fn bounded(&self) -> Bounded {
        Bounded { tolerance_px: self.tolerance_px }
    }

    /// Whether strokes are added for what is bare.
    pub(crate) fn adds_strokes(&self) -> bool {
        self.mode != Mode::Outline && self.prefer != Prefer::Strokes
    }

    /// What strokes leave bare.
    pub(crate) fn bare_ink<'a>(&self, drawn: &'a Index) -> BareInk<'a> {
        let spots = self.prefer == Prefer::Ink;
        BareInk { drawn, within_px: self.tolerance_px, pieces: self.pieces, spots }
    }

    /// The pen that draws areas.
    pub(crate) fn area_pen<'a>(&self, opening: &'a Opening) -> AreaPen<'a> {
        AreaPen { opening, pen_px: self.areas.pen_px, is_raster: false }
    }

    /// Takes the dirt out of ink; the pen that drew it, and what was taken.
    pub(crate) fn clean(&self, ink: &mut Bitmap) -> (Pen, Despeckled) {
        let pen = Pen::of(ink);
        (pen, despeckle(ink, self.smallest_mark_px(pen.width_px)))
    }

    /// Whether the pixels of the ink are followed as they are: lines one pixel wide. Where these are is
    /// better known of grey rims.
    pub(crate) fn keeps_pixels(&self, pen: Pen, has_rims: impl Fn() -> bool) -> bool {
        let is_raster = pen.width_px <= 1 && pen.hairlines != Hairlines::Pen;
        is_raster && self.mode != Mode::Outline && !has_rims()
    }

    /// Pixels of the smallest mark of ours that is no dirt.
    pub(crate) fn smallest_mark_px(&self, pen_px: u32) -> u32 {
        self.smallest_mark_px.unwrap_or(smallest_mark_px(pen_px))
    }

    /// The strokes of lines and areas.
    pub(crate) fn strokes(
        &self,
        ink: &Bitmap,
        grey: Option<(&Gray, bool)>,
        pen: Pen,
    ) -> Result<Vec<Curve>, VectorizeError> {
        let split = self.opening(pen).split_of(ink);
        let centring = self.centring_of(pen);
        let mut strokes = centring.strokes(&split.thin, grey);
        let areas = &split.thick;
        let mut islands = Islands::new(areas.width());
        for y in 0..areas.height() {
            if let Some((first_row, areas)) = islands.push(areas.row(y)) {
                strokes.extend(self.area_strokes(first_row, &areas)?);
            }
        }
        if let Some((first_row, areas)) = islands.finish() {
            strokes.extend(self.area_strokes(first_row, &areas)?);
        }
        Ok(strokes)
    }

    /// Whether ours can be done as asked.
    pub(crate) fn check(&self) -> Result<(), VectorizeError> {
        let tolerance_px = self.tolerance_px;
        if !(tolerance_px > 0.0 && tolerance_px.is_finite()) {
            return Err(VectorizeError::Tolerance { tolerance_px });
        }
        self.areas.paths(&Bitmap::empty()).map(drop).map_err(VectorizeError::Areas)
    }

    /// Widest line, px.
    pub(crate) fn max_line_px(&self, pen_px: u32) -> u32 {
        let lines = self.max_line_px.unwrap_or(match self.mode {
            Mode::Mixed => (3 * pen_px).max(6),
            Mode::Centreline | Mode::Outline => (6 * pen_px).max(12),
        });
        lines.max(self.areas.narrowest_px())
    }

    /// What tells areas from lines.
    pub(crate) fn opening(&self, pen: Pen) -> Opening {
        let outlines_all = self.mode == Mode::Outline || pen.is_silhouette && self.max_line_px.is_none();
        if outlines_all {
            Opening::of_pen(self.areas.pen_px)
        } else {
            Opening::of_drawing(self.max_line_px(pen.width_px), pen.width_px)
        }
    }

    /// How lines of a pen become strokes.
    pub(crate) fn centring_of(&self, pen: Pen) -> Centring {
        let centring = self.centring(self.max_line_px(pen.width_px));
        Centring { redraw: true, hairlines: pen.hairlines, ..centring }
    }

    /// How lines become strokes.
    pub(crate) fn centring(&self, max_line_px: u32) -> Centring {
        // The promise holds for the middle of the ink; part of it goes for the jumps of its edges from pixel
        // to pixel.
        let bounded = Bounded { tolerance_px: 0.85 * self.tolerance_px };
        // What is left of an area's rim may be as wide again.
        let centring = Centring::new(self.thinning, max_line_px, bounded, self.band_rows);
        Centring { pieces: self.pieces, ..centring }
    }

    /// The strokes of the areas in some rows, of which the first is row `first_row` of the picture.
    pub(crate) fn area_strokes(&self, first_row: u32, areas: &Bitmap) -> Result<Vec<Curve>, VectorizeError> {
        let paths = self.areas.paths(areas).map_err(VectorizeError::Areas)?;
        let top = f64::from(first_row);
        let stroke = |path: AreaPath| {
            let mut stroke = self.simplified(&path.sites, path.closed);
            stroke.move_down(top);
            stroke
        };
        Ok(paths.map(stroke).collect())
    }

    /// A stroke through sites, by ours.
    fn simplified(&self, sites: &[PxPoint], closed: bool) -> Curve {
        self.bounded().stroke(sites, closed, self.pieces)
    }

    /// The strokes of figures, with arcs or curves where they save vertices.
    pub(crate) fn bent(&self, figures: &Figures, straight: &Drawing) -> Drawing {
        let mut drawing = Drawing::new(straight.width_px(), straight.height_px());
        // Each figure has pixels, so each has its stroke.
        for (figure, stroke) in figures.iter().zip(straight.strokes()) {
            let sites: Vec<PxPoint> = figure.iter().map(|pixel| PxPoint::from(*pixel)).collect();
            let closed = sites.len() > 3 && sites.first() == sites.last();
            let curve = self.bounded().stroke(&sites, closed, self.pieces);
            let curve = within(curve, straight.width_px(), straight.height_px());
            let pays = !curve.is_straight() && curve.vertices.len() < stroke.len();
            drawing.push_curve(1, if pays { curve } else { stroke.to_vec().into() });
        }
        drawing
    }
}
