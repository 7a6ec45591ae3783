//! [`Vectorizer::vectorize_colour`]: the whole way from a picture in colour to the strokes of each pen.

use crate::report::coverage::{Faults, add_coverage};
use crate::trace::pipeline::Unordered;
use crate::{
    ink::{Despeckled, Palette, Pens, Threshold, ThresholdMethod, Unassigned},
    picture::{Bitmap, Colour, Gray, Pixel, Rgb},
    report::ErrorTally,
    stroke::Drawing,
    trace::{Algorithm, Progress, VectorizeError, Vectorized, Vectorizer},
};

/// Where the work has come to when the pens are told apart, when they have their strokes, and when these are
/// ordered, on a scan of three pens; the rest are the errors.
const TOLD_APART: f64 = 0.3;
const TRACED: f64 = 0.8;
const ORDERED: f64 = 0.9;

/// What the vectorization found on a picture in colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VectorizedColour {
    /// The strokes of all pens and the errors of all their ink. No split: pens are told by colour, not by a
    /// level.
    pub traced: Vectorized,
    /// The pens, given or found; the numbers of the strokes' pens are theirs.
    pub palette: Palette,
    /// The ink of each pen as it was vectorized, in the order of the palette: whole where other pens have
    /// crossed it, and without dirt.
    pub inks: Vec<Bitmap>,
    /// The pixel with the greatest error and its error, px; none without ink.
    pub worst: Option<(Pixel, f64)>,
    /// Ink that one pen alone would draw, and that none of these pens got. It is not drawn.
    pub unassigned: Option<Unassigned>,
    /// The colour of the ruling of squared or ruled paper. It is left out where pens are found, unless the
    /// threshold keeps what is pale.
    pub ruling: Option<Rgb>,
}

impl Vectorizer {
    /// Vectorizes a picture in colour, pen by pen; then all strokes are ordered, each pen's together. The
    /// threshold's level is not asked. Where one pen crosses another, its lines go on under it.
    ///
    /// ```
    /// # use plotter_vector::{Colour, Vectorizer, ink::Pens};
    /// let [paper, black, red] = [[255, 255, 255], [0, 0, 0], [208, 24, 24]];
    /// let mut pixels = vec![paper; 40 * 20];
    /// pixels[40 * 4 + 3..40 * 4 + 33].fill(black);
    /// pixels[40 * 9 + 3..40 * 9 + 33].fill(red);
    /// let picture = Colour::new(40, 20, pixels.as_flattened().to_vec())?;
    /// let found = Vectorizer::default().vectorize_colour(&picture, &Pens::Found)?;
    /// assert_eq!(found.palette.pens().len(), 2);
    /// assert_eq!((found.traced.drawing.pens(), found.traced.drawing.vertices()), (vec![1, 2], 4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`VectorizeError`].
    pub fn vectorize_colour(
        &self,
        picture: &Colour,
        pens: &Pens,
    ) -> Result<VectorizedColour, VectorizeError> {
        self.vectorize_colour_with_progress(picture, pens, &mut Progress::silent())
    }

    /// The same, told and stopped between its steps: the telling apart, each pen's strokes, the order, each
    /// pen's errors.
    ///
    /// # Errors
    /// [`VectorizeError`].
    pub fn vectorize_colour_with_progress(
        &self,
        picture: &Colour,
        pens: &Pens,
        progress: &mut Progress<'_>,
    ) -> Result<VectorizedColour, VectorizeError> {
        progress.at(0, 1)?;
        let layers = pens.shared_out(picture, self.threshold.keep_pale).map_err(VectorizeError::Pens)?;
        progress.part(TOLD_APART).at(1, 1)?;
        let of = layers.palette().pens().len() as u64;
        let mut drawing = Drawing::new(picture.width(), picture.height());
        let mut inks = Vec::with_capacity(layers.palette().pens().len());
        let mut openings = Vec::with_capacity(inks.capacity());
        let mut tracing = progress.part(TRACED);
        let (mut removed, mut thinnest_px) = (Despeckled::default(), u32::MAX);
        for (done, (index, (pen, own))) in (1..).zip(layers.iter().enumerate()) {
            let mut ink = layers.bridged(index).unwrap_or_else(|| own.clone());
            let grey = layers.coverage(index, &ink, picture);
            let Unordered { drawing: strokes, errors, areas, thinnest_px: own_px, removed: dirt } =
                self.unordered(&mut ink, grey.as_ref().map(|levels| (levels, true)))?;
            let (strokes, _) = self.completed(strokes, errors, &ink, areas.as_ref());
            removed = removed.and(dirt);
            thinnest_px = thinnest_px.min(own_px);
            for stroke in 0..strokes.strokes().len() {
                drawing.push_curve(pen.number, strokes.curve(stroke));
            }
            inks.push(ink);
            openings.push(areas);
            tracing.at(done, of)?;
        }
        (drawing, _) = self.in_order(drawing, None, thinnest_px);
        progress.part(ORDERED).at(1, 1)?;
        let (mut tally, mut faults) = (ErrorTally::default(), Faults::default());
        let mut measuring = progress.part(1.0);
        for (done, (pen, (ink, areas))) in
            (1..).zip(layers.palette().pens().iter().zip(inks.iter().zip(&openings)))
        {
            let areas = self.area_pen(areas.as_ref());
            let (drawn, within) = (drawing.of_pen(pen.number), (areas, self.within_px()));
            faults = faults.and(add_coverage(ink, &drawn, within, &mut tally));
            measuring.at(done, of)?;
        }
        let mut doubt = None;
        for (pen, ink) in layers.palette().pens().iter().zip(&inks) {
            doubt = doubt.or(self.doubt(&drawing.of_pen(pen.number), ink, Despeckled::default(), 0)?);
        }
        let error = tally.report();
        let Faults { beyond, bare, insides } = faults;
        let traced =
            Vectorized { drawing, error, beyond, bare, insides, split: None, look: None, removed, doubt };
        let unassigned = match self.algorithm {
            Algorithm::Ours(_) => {
                // A level that was chosen for one pen says nothing of several.
                let threshold = Threshold { method: ThresholdMethod::Auto, ..self.threshold };
                layers.unassigned(&Self { threshold, ..*self }.ink(&Gray::from(picture)))
            }
            Algorithm::Published(_) => None,
        };
        Ok(VectorizedColour {
            traced,
            palette: layers.palette().clone(),
            inks,
            worst: tally.worst(),
            unassigned,
            ruling: layers.ruling(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ink::PensError, report::ErrorReport};

    /// A black bar across, a red one down over it, both 3 px wide.
    fn cross() -> Colour {
        let pixel = |x: u32, y: u32| match (x, y) {
            (29..32, 5..55) => [208, 24, 24],
            (5..55, 29..32) => [0, 0, 0],
            _ => [255, 255, 255],
        };
        let pixels: Vec<[u8; 3]> = (0..60).flat_map(|y| (0..60).map(move |x| pixel(x, y))).collect();
        Colour::new(60, 60, pixels.as_flattened().to_vec()).unwrap()
    }

    #[test]
    fn a_line_goes_on_under_the_pen_that_crosses_it() {
        let found = Vectorizer::default().vectorize_colour(&cross(), &Pens::Count(2)).unwrap();
        let drawing = &found.traced.drawing;
        assert_eq!((drawing.strokes().len(), drawing.vertices(), drawing.pens()), (2, 4, vec![1, 2]));
        let counts: Vec<u64> = found.inks.iter().map(Bitmap::count).collect();
        assert_eq!(counts, [150, 150]); // the black one with the 9 px that are red
        assert_eq!(found.traced.error.pixels, 300);
        // A round pen leaves the corners of square ends bare.
        assert!(found.traced.error.max_px < 0.75, "{}", found.traced.error.max_px);
    }

    #[test]
    fn work_on_colours_is_told_and_stopped() {
        use core::ops::ControlFlow;
        let mut told = Vec::new();
        let mut report = |done: f64| {
            told.push(done);
            ControlFlow::Continue(())
        };
        let vectorizer = Vectorizer::default();
        let pens = Pens::Count(2);
        let found = vectorizer
            .vectorize_colour_with_progress(&cross(), &pens, &mut Progress::new(&mut report))
            .unwrap();
        assert_eq!(found, vectorizer.vectorize_colour(&cross(), &pens).unwrap());
        assert!(told.windows(2).all(|pair| pair[0] < pair[1]), "{told:?}");
        // Begun, told apart, two pens, ordered, two pens.
        assert_eq!((told.len(), told.first(), told.last()), (7, Some(&0.0), Some(&1.0)));
        let mut stop =
            |done: f64| if done > 0.4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let stopped =
            vectorizer.vectorize_colour_with_progress(&cross(), &pens, &mut Progress::new(&mut stop));
        assert_eq!(stopped.unwrap_err().to_string(), "cancelled after 55 % of the work");
    }

    #[test]
    fn a_sheet_without_ink_has_one_pen_and_no_strokes() {
        let white = Colour::new(3, 2, vec![255; 18]).unwrap();
        let found = Vectorizer::default().vectorize_colour(&white, &Pens::Found).unwrap();
        assert_eq!((found.palette.pens().len(), found.traced.drawing.vertices()), (1, 0));
        assert_eq!(found.traced.error, ErrorReport::default());
    }

    #[test]
    fn pens_that_cannot_be_are_refused() {
        let error = Vectorizer::default().vectorize_colour(&cross(), &Pens::Count(0)).unwrap_err();
        assert_eq!(error, VectorizeError::Pens(PensError::Count { count: 0 }));
    }
}
