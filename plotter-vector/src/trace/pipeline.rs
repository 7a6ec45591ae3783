//! [`Vectorizer`]: the whole way from grey levels to pen strokes.

use crate::areas::Opening;
use crate::ink::hairlines::Hairlines;
use crate::ink::mark_sizes::MarkSizes;
use crate::ink::pen::Pen;
use crate::ink::row_threshold::has_rims;
use crate::raster::continuity::{Joined, join, link};
use crate::raster::cut_at_turns::cut_at_turns;
use crate::raster::raster_corner::{put_back, take_out};
use crate::raster::straight_on::{GoneOn, straight_on};
use crate::report::coverage::{AreaPen, Beyond, Faults, Spots, add_coverage, with_widths};
use crate::report::covered_figures::Covered;
use crate::stroke::clip_to_picture::within;
use crate::stroke::join_gaps::{join_gaps, without_short};
use crate::stroke::{Bounded, Drawing, DynamicThreshold, Pieces, PxPoint, Simplify};
use crate::trace::ours::{Ours, Prefer};
use crate::{
    ink::{Despeckled, Evened, Look, Split, Threshold, told},
    picture::{Bitmap, Figures, Gray, Pixel},
    raster::OrderedTracking,
    report::{ErrorReport, ErrorTally},
    trace::{Doubt, SheetErrors, VectorizeError, doubt::Dirt},
};
use std::collections::BTreeSet;

/// Which vectorization, with the settings that it alone has.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Algorithm {
    /// Ordered tracking, pre-elimination and [`DynamicThreshold`], drawn in tracking order: as published.
    Published(Published),
    /// The middle of each line, its crossings and corners where they are, [`Bounded`], strokes ordered for
    /// little travel.
    Ours(Ours),
}

impl Default for Algorithm {
    /// Ours, to half a pixel.
    fn default() -> Self {
        Self::Ours(Ours::default())
    }
}

/// Settings of the published vectorization.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct Published {
    /// Which pixels of a figure become vertices.
    pub simplification: DynamicThreshold,
}

impl Published {
    /// The same with another choice of vertices.
    #[must_use]
    pub const fn with_simplification(self, simplification: DynamicThreshold) -> Self {
        Self { simplification }
    }
}

/// Settings of the whole way from a picture to strokes.
///
/// ```
/// use plotter_vector::{Bitmap, PxPoint, Vectorizer};
/// let ink = Bitmap::from_picture("#####\n#...#\n#...#\n#####\n")?;
/// let traced = Vectorizer::default().trace(&ink)?;
/// let corners = [(0.5, 0.5), (4.5, 0.5), (4.5, 3.5), (0.5, 3.5), (0.5, 0.5)];
/// assert_eq!(traced.drawing.stroke(0), corners.map(|(x, y)| PxPoint::new(x, y)));
/// assert_eq!(traced.error.max_px, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct Vectorizer {
    /// How ink is told from paper.
    pub threshold: Threshold,
    /// How ink becomes figures: published, and by ours on lines one pixel wide.
    pub tracking: OrderedTracking,
    /// Which vectorization. The default is ours.
    pub algorithm: Algorithm,
}

impl From<Algorithm> for Vectorizer {
    fn from(algorithm: Algorithm) -> Self {
        Self { algorithm, ..Self::default() }
    }
}

impl From<Published> for Vectorizer {
    fn from(published: Published) -> Self {
        Algorithm::Published(published).into()
    }
}

impl From<Ours> for Vectorizer {
    fn from(ours: Ours) -> Self {
        Algorithm::Ours(ours).into()
    }
}

/// What the vectorization found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vectorized {
    /// The strokes, all of them within the picture.
    pub drawing: Drawing,
    /// How far the pixels lie from them, but for dirt. Of areas, which are outlined or hatched, those at the
    /// edge count, and not what is inside.
    pub error: ErrorReport,
    /// What the pens draw beside the ink.
    pub beyond: Beyond,
    /// Ink that lies farther from the strokes than the tolerance of ours.
    pub bare: Spots,
    /// Ink inside of areas that no pen draws, because they are outlined or hatched with gaps: no error is
    /// told of it.
    pub insides: Spots,
    /// How ink was told from paper; `None` for an empty sheet, or for a picture that came as a bitmap.
    pub split: Option<Split>,
    /// What was found of a picture whose ink no single level tells from its paper.
    pub look: Option<Look>,
    /// What was taken for dirt, and is not drawn: no error is told of it.
    pub removed: Despeckled,
    /// Why it may be no drawing, of ours.
    pub doubt: Option<Doubt>,
}

/// Most ink of a picture that is vectorized: 2²⁵ px, five times the lines of a dense A0 sheet at 300 dots per
/// inch, take 6 s and 0.9 GB.
pub const MAX_INK_PIXELS: u64 = 1 << 25;

/// From end to end of a gap that is drawn over in a picture that is evened, in widths of the lines: in
/// strokes with grain, and in others, where a ball pen skips. A pen's dashes have more than a width of
/// paper between them, so their ends, half a width inside of the ink, are farther apart.
const GRAIN_GAP_WIDTHS: f64 = 3.0;
const SKIP_WIDTHS: f64 = 2.0;

impl Vectorizer {
    /// The published vectorization with its published settings.
    #[must_use]
    pub fn published() -> Self {
        Published::default().into()
    }

    /// The same with ink told from paper otherwise.
    #[must_use]
    pub const fn with_threshold(self, threshold: Threshold) -> Self {
        Self { threshold, ..self }
    }

    /// The same with another tracking.
    #[must_use]
    pub const fn with_tracking(self, tracking: OrderedTracking) -> Self {
        Self { tracking, ..self }
    }

    /// The settings of ours; `None` where the published vectorization is asked for.
    #[must_use]
    pub const fn ours(&self) -> Option<&Ours> {
        match &self.algorithm {
            Algorithm::Ours(ours) => Some(ours),
            Algorithm::Published(_) => None,
        }
    }

    /// The same, to be changed.
    ///
    /// ```
    /// # use plotter_vector::Vectorizer;
    /// let mut vectorizer = Vectorizer::default();
    /// if let Some(ours) = vectorizer.ours_mut() {
    ///     ours.tolerance_px = 1.0;
    /// }
    /// assert!(Vectorizer::published().ours_mut().is_none());
    /// ```
    #[must_use]
    pub const fn ours_mut(&mut self) -> Option<&mut Ours> {
        match &mut self.algorithm {
            Algorithm::Ours(ours) => Some(ours),
            Algorithm::Published(_) => None,
        }
    }

    /// How far ink may be from a stroke before it counts as bare, px: the promise of ours. The published
    /// vectorization promises nothing, so it is told by the default of that promise.
    pub(crate) fn within_px(&self) -> f64 {
        self.ours().map_or(Bounded::default().tolerance_px, |ours| ours.tolerance_px)
    }

    /// The pen that draws areas.
    pub(crate) fn area_pen<'a>(&self, areas: Option<&'a Opening>) -> Option<AreaPen<'a>> {
        self.ours().zip(areas).map(|(ours, areas)| ours.area_pen(areas))
    }

    /// Vectorizes a picture. An empty sheet (one level, no contrast, no pixels) gives an empty drawing.
    ///
    /// # Errors
    /// [`VectorizeError`].
    pub fn vectorize(&self, gray: &Gray) -> Result<Vectorized, VectorizeError> {
        self.vectorized(gray, 0)
    }

    /// The same of a picture of which so many specks have been left out already.
    fn vectorized(&self, gray: &Gray, left_out: usize) -> Result<Vectorized, VectorizeError> {
        let survey = self.threshold.survey(gray);
        if survey.is_uneven() {
            let Some((evened, settings)) = self.evened(gray) else {
                return self.by_level().vectorized(gray, left_out);
            };
            let look = evened.look;
            let found = settings.vectorized(&evened.gray, look.left_out)?;
            let split = look.split(found.split);
            let doubt = if split.is_none() { Doubt::of_empty(&look) } else { found.doubt };
            return Ok(Vectorized { look: Some(look), split, doubt, ..found });
        }
        let (ink, split) = told(survey, gray);
        // Of two levels the ink says all: its rims are no more exact, and dirt that was taken out is no rim.
        let grey = split.filter(|split| split.has_greys).map(|split| (gray, split.ink_is_dark));
        Ok(Vectorized { split, ..self.trace_ink(ink, grey, left_out)? })
    }

    /// A picture that was found uneven as if its ink were black, and the settings that trace it.
    pub(crate) fn evened(&self, gray: &Gray) -> Option<(Evened, Self)> {
        let (evened, threshold) = self.threshold.evened(gray)?;
        let algorithm = match self.algorithm {
            Algorithm::Ours(ours) => {
                // The rims of what a camera or a pencil made are ragged: ink that is bare there is worth no
                // stroke.
                let prefer = if ours.prefer == Prefer::Both { Prefer::Strokes } else { ours.prefer };
                let widths = if evened.look.broken { GRAIN_GAP_WIDTHS } else { SKIP_WIDTHS };
                let gap_px = ours.gap_px.or(Some(widths * f64::from(evened.look.line_px)));
                Algorithm::Ours(Ours { prefer, gap_px, ..ours })
            }
            published @ Algorithm::Published(_) => published,
        };
        Some((evened, Self { threshold, algorithm, ..*self }))
    }

    /// The same settings with one level for all of the picture.
    pub(crate) fn by_level(&self) -> Self {
        Self { threshold: self.threshold.by_level(), ..*self }
    }

    /// The ink of a picture that is vectorized: told from the paper and, by ours, without dirt.
    ///
    /// ```
    /// # use plotter_vector::{Gray, Vectorizer};
    /// let line = [250, 250, 20, 20, 20, 20, 20, 20, 250, 250];
    /// let scan = Gray::new(10, 2, [line, [250; 10]].concat())?;
    /// assert_eq!(Vectorizer::default().ink(&scan).to_string(), "..######..\n..........\n");
    /// # Ok::<(), plotter_vector::picture::GrayError>(())
    /// ```
    #[must_use]
    pub fn ink(&self, gray: &Gray) -> Bitmap {
        let (mut ink, _) = self.threshold.apply(gray);
        if let Some(ours) = self.ours() {
            ours.clean(&mut ink);
        }
        ink
    }

    /// Vectorizes ink.
    ///
    /// # Errors
    /// [`VectorizeError`].
    pub fn trace(&self, ink: &Bitmap) -> Result<Vectorized, VectorizeError> {
        self.trace_ink(ink.clone(), None, 0)
    }

    fn trace_ink(
        &self,
        mut ink: Bitmap,
        grey: Option<(&Gray, bool)>,
        left_out: usize,
    ) -> Result<Vectorized, VectorizeError> {
        let Unordered { drawing, errors, areas, thinnest_px, removed } = self.unordered(&mut ink, grey)?;
        let (drawing, errors) = self.completed(drawing, errors, &ink, areas.as_ref());
        let (drawing, errors) = self.in_order(drawing, errors, thinnest_px);
        let errors = self.known_or_measured(errors, &ink, &drawing, areas.as_ref());
        Ok(Vectorized {
            error: errors.report,
            beyond: errors.beyond,
            bare: errors.bare,
            insides: errors.insides,
            split: None,
            look: None,
            doubt: self.doubt(&drawing, &ink, removed, left_out)?,
            removed,
            drawing,
        })
    }

    /// Why strokes of ink, from which dirt was taken, may be no drawing.
    pub(crate) fn doubt(
        &self,
        drawing: &Drawing,
        ink: &Bitmap,
        removed: Despeckled,
        left_out: usize,
    ) -> Result<Option<Doubt>, VectorizeError> {
        let Some(ours) = self.ours().filter(|_| drawing.strokes().len() > 0) else { return Ok(None) };
        let line_px = Pen::of(ink).width_px;
        let dirt = Dirt { least_px: ours.smallest_mark_px(line_px), removed, left_out };
        Doubt::of(drawing, line_px, dirt, || Ok(MarkSizes::of(ink)))
    }

    /// The strokes, with more for the ink that those of ours leave bare. The errors stay known only where
    /// none were added.
    pub(crate) fn completed(
        &self,
        mut drawing: Drawing,
        errors: Option<SheetErrors>,
        ink: &Bitmap,
        areas: Option<&Opening>,
    ) -> (Drawing, Option<SheetErrors>) {
        let Some(ours) = self.ours().filter(|ours| ours.adds_strokes()) else { return (drawing, errors) };
        let is_kept = errors.as_ref().is_some_and(|errors| errors.report.max_px <= ours.tolerance_px);
        let mut added = Vec::new();
        if !is_kept {
            let drawn = with_widths(ink, &drawing, areas.map(|areas| ours.area_pen(areas)));
            let lines = areas.map(|areas| areas.split_of(ink).thin);
            added = ours.bare_ink(&drawn).strokes(ink, lines.as_ref().unwrap_or(ink), 0, &(0..ink.height()));
        }
        let errors = errors.filter(|_| added.is_empty());
        added.into_iter().for_each(|stroke| drawing.push_curve(1, within(stroke, ink.width(), ink.height())));
        (drawing, errors)
    }

    /// The strokes of ours joined over gaps, without short ones, and in their order. What is left out makes
    /// errors that are no longer known. Strokes are one where a pen as wide as the thinnest line that ends
    /// the one overlaps with one that begins the other, or comes to it over what is drawn: there is no paper
    /// between.
    pub(crate) fn in_order(
        &self,
        mut drawing: Drawing,
        errors: Option<SheetErrors>,
        thinnest_px: u32,
    ) -> (Drawing, Option<SheetErrors>) {
        let Some(ours) = self.ours() else { return (drawing, errors) };
        if let Some(gap_px) = ours.gap_px.filter(|gap_px| *gap_px > 0.0) {
            drawing = join_gaps(drawing, gap_px);
        }
        let mut errors = errors;
        if ours.min_stroke_px > 0.0 {
            drawing = without_short(drawing, ours.min_stroke_px);
            errors = None;
        }
        let ordered = if thinnest_px > 1 {
            ours.order.apply_to_ink(&drawing, f64::from(thinnest_px))
        } else {
            ours.order.apply(&drawing)
        };
        (ordered, errors)
    }

    /// The errors of a drawing: what is known of lines one pixel wide from their figures, or measured.
    pub(crate) fn known_or_measured(
        &self,
        known: Option<SheetErrors>,
        ink: &Bitmap,
        drawing: &Drawing,
        areas: Option<&Opening>,
    ) -> SheetErrors {
        match known {
            Some(errors) => {
                let within_px = self.within_px();
                let has_bare = self.ours().is_some() && errors.report.max_px > within_px;
                let Faults { beyond, bare, insides } =
                    Faults::of_hairlines(ink, drawing, within_px, has_bare);
                SheetErrors { beyond, bare, insides, ..errors }
            }
            None => self.errors(ink, drawing, areas),
        }
    }

    /// The errors of a drawing, with the areas that were told from lines.
    fn errors(&self, ink: &Bitmap, drawing: &Drawing, areas: Option<&Opening>) -> SheetErrors {
        let mut tally = ErrorTally::default();
        let within = (self.area_pen(areas), self.within_px());
        let Faults { beyond, bare, insides } = add_coverage(ink, drawing, within, &mut tally);
        SheetErrors { report: tally.report(), worst: tally.worst(), beyond, bare, insides }
    }

    /// The strokes as they are found; takes the dirt out of `ink`.
    pub(crate) fn unordered(
        &self,
        ink: &mut Bitmap,
        grey: Option<(&Gray, bool)>,
    ) -> Result<Unordered, VectorizeError> {
        let ours = match &self.algorithm {
            Algorithm::Ours(ours) => ours,
            Algorithm::Published(published) => {
                let (drawing, errors) = self.as_published(published, ink)?;
                let removed = Despeckled::default();
                return Ok(Unordered { drawing, errors: Some(errors), areas: None, thinnest_px: 1, removed });
            }
        };
        ours.check()?;
        let ink_pixels = ink.count();
        let (pen, removed) = ours.clean(ink);
        if ours.keeps_pixels(pen, || grey.is_some_and(|(gray, _)| has_rims(gray, ink_pixels))) {
            let (drawing, errors) = self.tracked(ours, ink, pen.hairlines)?;
            // Of what is not straight the errors are not known from the figures.
            let errors = drawing.is_straight().then_some(errors);
            return Ok(Unordered { drawing, errors, areas: None, thinnest_px: 1, removed });
        }
        let strokes = ours.strokes(ink, grey, pen)?;
        let mut drawing = Drawing::new(ink.width(), ink.height());
        for stroke in strokes {
            drawing.push_curve(1, within(stroke, ink.width(), ink.height()));
        }
        let areas = Some(ours.opening(pen));
        Ok(Unordered { drawing, errors: None, areas, thinnest_px: pen.thinnest_px, removed })
    }

    /// Ours for lines one pixel wide.
    fn tracked(
        &self,
        ours: &Ours,
        ink: &Bitmap,
        hairlines: Hairlines,
    ) -> Result<(Drawing, SheetErrors), VectorizeError> {
        let mut bare = ink.clone();
        let corners = if hairlines == Hairlines::Stairs { take_out(&mut bare) } else { Vec::new() };
        let figures = put_back(&link(&self.figures(&bare)?), &corners, ink.width(), ink.height());
        drop(bare);
        let cut = cut_at_turns(&figures, ink);
        drop(figures);
        // Of a sheet full of ink each step's figures are large: none outlives its use.
        let GoneOn { figures: straight, shared } = straight_on(&cut, ink);
        drop(cut);
        let linked = link(&straight);
        drop(straight);
        let Joined { figures, borrowed } = join(&linked, ink);
        drop(linked);
        let lent = |index: usize| borrowed.get(index).copied().unwrap_or_default();
        // Arcs and curves do not pass where the straight segments do.
        let covered_px = (ours.pieces == Pieces::Lines).then_some(ours.tolerance_px);
        let (straight, errors) = simplify(ink, &figures, lent, &shared, &ours.bounded(), covered_px);
        let drawing = match ours.pieces {
            Pieces::Lines => straight,
            _ => ours.bent(&figures, &straight),
        };
        Ok((drawing, errors))
    }

    fn as_published(
        &self,
        published: &Published,
        ink: &Bitmap,
    ) -> Result<(Drawing, SheetErrors), VectorizeError> {
        let simplification = &published.simplification;
        Ok(simplify(ink, &self.figures(ink)?, |_| (false, false), &Bitmap::empty(), simplification, None))
    }

    fn figures(&self, ink: &Bitmap) -> Result<Figures, VectorizeError> {
        let ink_pixels = ink.count();
        if ink_pixels > MAX_INK_PIXELS {
            return Err(VectorizeError::TooMuchInk { ink_pixels });
        }
        self.tracking.track(ink).map_err(VectorizeError::TooManyFigures)
    }
}

/// The strokes of a picture as they are found.
pub(crate) struct Unordered {
    pub(crate) drawing: Drawing,
    /// The errors, where they are known from the figures, but for what is drawn beside the ink.
    pub(crate) errors: Option<SheetErrors>,
    /// What told areas from lines, where something did.
    pub(crate) areas: Option<Opening>,
    /// Width of the thinnest lines, px; 1 where the strokes are the pixels.
    pub(crate) thinnest_px: u32,
    /// What was taken for dirt.
    pub(crate) removed: Despeckled,
}

/// A stroke of each figure, but for what others draw within `covered_px`, and the errors; of pixels that
/// figures share those of the first of them.
fn simplify(
    ink: &Bitmap,
    figures: &Figures,
    borrowed: impl Fn(usize) -> (bool, bool),
    shared: &Bitmap,
    algorithm: &impl Simplify,
    covered_px: Option<f64>,
) -> (Drawing, SheetErrors) {
    let kept: Vec<Vec<usize>> = figures.iter().map(|figure| algorithm.keep(figure)).collect();
    let covered = covered_px.map(|tolerance_px| Covered::of(figures, &kept, ink, tolerance_px));
    let is_covered = |index: usize| covered.as_ref().is_some_and(|covered| covered.has(index));
    let mut drawing = Drawing::new(ink.width(), ink.height());
    let mut tally = ErrorTally::default();
    let mut seen = BTreeSet::new();
    let mut counts = |at: Pixel| !shared.get(at) || seen.insert(at);
    for (index, (figure, kept)) in
        figures.iter().zip(&kept).enumerate().filter(|(index, _)| !is_covered(*index))
    {
        tally.add_those(figure, kept, borrowed(index), &mut counts);
        let vertex = |index: &usize| figure.get(*index).copied().map(|pixel: Pixel| PxPoint::from(pixel));
        drawing.push(kept.iter().filter_map(vertex));
    }
    for (index, figure) in figures.iter().enumerate().filter(|(index, _)| is_covered(*index)) {
        let (first, last) = borrowed(index);
        let own = usize::from(first)..figure.len() - usize::from(last);
        for at in figure.get(own).unwrap_or(&[]).iter().filter(|at| counts(**at)) {
            let off_px = covered.as_ref().and_then(|covered| covered.off_px(*at));
            tally.add_pixel(*at, off_px.unwrap_or_default());
        }
    }
    (drawing, SheetErrors { report: tally.report(), worst: tally.worst(), ..SheetErrors::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_that_is_no_distance_is_refused() {
        let dot = Bitmap::from_picture("#").unwrap();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = Vectorizer::from(Ours::default().with_tolerance_px(bad)).trace(&dot).unwrap_err();
            assert_eq!(
                error.to_string(),
                format!("tolerance: {bad} px is not a positive number; 0.5 is half a pixel")
            );
        }
    }

    #[test]
    fn a_large_black_area_is_refused_before_memory_is_taken_by_who_follows_it_pixel_by_pixel() {
        let (width, height) = (8192, 4097);
        let mut black = Bitmap::new(width, height).unwrap();
        (0..height).for_each(|y| black.row_mut(y).fill(u64::MAX));
        assert_eq!(
            Vectorizer::published().trace(&black).unwrap_err(),
            VectorizeError::TooMuchInk { ink_pixels: 8192 * 4097 }
        );
    }

    #[test]
    fn beside_a_large_area_a_line_is_centred_and_the_area_outlined() {
        let mut ink = Bitmap::new(400, 300).unwrap();
        for (x, y) in (0..300).flat_map(|y| (0..400).map(move |x| (x, y))) {
            let is_area = (50..250).contains(&x) && (40..260).contains(&y);
            let is_line = (260..390).contains(&x) && (100..105).contains(&y);
            ink.set(Pixel::new(x, y), is_area || is_line);
        }
        let traced = Vectorizer::default().trace(&ink).unwrap();
        let mut vertices: Vec<usize> = traced.drawing.strokes().map(<[PxPoint]>::len).collect();
        vertices.sort_unstable();
        assert_eq!(vertices, [2, 5]);
        // All of the line, and of the area its edge, where the pen goes.
        assert_eq!(traced.error.pixels, 130 * 5 + 2 * (200 + 218));
        // A round pen leaves the corners of the line's square end bare.
        assert!(traced.error.max_px < 1.1, "{:?}", traced.error);
    }

    #[test]
    fn a_sheet_without_ink_gives_an_empty_drawing_of_its_size() {
        for (width, height) in [(0, 0), (0, 3), (1, 1), (3, 2)] {
            for level in [0, 255] {
                let levels = vec![level; (width * height) as usize];
                let traced =
                    Vectorizer::default().vectorize(&Gray::new(width, height, levels).unwrap()).unwrap();
                assert_eq!((traced.drawing.width_px(), traced.drawing.height_px()), (width, height));
                assert_eq!((traced.drawing.vertices(), traced.error.pixels, traced.split), (0, 0, None));
            }
        }
    }
}
