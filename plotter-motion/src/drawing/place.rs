//! [`Placement`]: where a drawing goes on a page, and how large.

use super::{Affine, Bounds, Drawing};
use crate::Point;
use core::f64::consts::PI;
use core::fmt;

/// How a drawing is put on a page: mirrored, then turned, then scaled, then moved.
///
/// ```
/// use plotter_motion::{Point, drawing::{Drawing, Placement, Stroke}};
///
/// let line = Stroke::through([Point::new(5.0, 5.0), Point::new(15.0, 10.0)]).unwrap();
/// let mut drawing = Drawing { strokes: vec![line], ..Drawing::default() };
/// // 10 x 5 mm into 100 x 100 mm with a margin of 10 mm: 80 x 40 mm, in the middle.
/// let placement = Placement { page_mm: Some((100.0, 100.0)), fits: true, margin_mm: 10.0, ..Placement::default() };
/// placement.put(&mut drawing)?;
/// assert_eq!((drawing.strokes[0].from, drawing.strokes[0].to()), (Point::new(10.0, 30.0), Point::new(90.0, 70.0)));
/// # Ok::<(), plotter_motion::drawing::PlacementError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Turns left into right.
    pub mirror_x: bool,
    /// Turns above into below.
    pub mirror_y: bool,
    /// Turns it counter-clockwise, degrees.
    pub rotate_deg: f64,
    /// How much larger it becomes; above 0.
    pub scale: f64,
    /// Width and height of the page, mm, whose lower left corner is the origin.
    pub page_mm: Option<(f64, f64)>,
    /// Whether it is made as large as the page allows.
    pub fits: bool,
    /// Whether it is put in the middle of the page; what fits is.
    pub centres: bool,
    /// What stays free along each side of the page, mm.
    pub margin_mm: f64,
}

impl Default for Placement {
    /// Where it is, as large as it is.
    fn default() -> Self {
        Self {
            mirror_x: false,
            mirror_y: false,
            rotate_deg: 0.0,
            scale: 1.0,
            page_mm: None,
            fits: false,
            centres: false,
            margin_mm: 0.0,
        }
    }
}

/// Why a drawing cannot be put so.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PlacementError {
    /// A number that is none, or a scale that is not above 0.
    BadNumber,
    /// There is no page to fit into or to be in the middle of.
    NoPage,
    /// Nothing is left of the page within its margins.
    NoRoom {
        /// Width within the margins, mm.
        width_mm: f64,
        /// Height within the margins, mm.
        height_mm: f64,
    },
}

impl fmt::Display for PlacementError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadNumber => {
                f.write_str("a scale, an angle or a margin is no number, or the scale is not above 0")
            }
            Self::NoPage => f.write_str("there is no page to fit or to be centred on: say its size"),
            Self::NoRoom { width_mm, height_mm } => write!(
                f,
                "{width_mm:.1} x {height_mm:.1} mm are left of the page within its margins: take a larger page or a smaller margin"
            ),
        }
    }
}

impl core::error::Error for PlacementError {}

impl Placement {
    /// Puts a drawing so. One without strokes stays as it is.
    ///
    /// # Errors
    ///
    /// [`PlacementError`]; the drawing is then as it was.
    pub fn put(&self, drawing: &mut Drawing) -> Result<(), PlacementError> {
        let map = self.map(&drawing.bounds(), |turn| {
            let mut turned = drawing.clone();
            turned.map(turn);
            turned.bounds()
        })?;
        if map != Affine::IDENTITY {
            drawing.map(&map);
        }
        Ok(())
    }

    /// The map that puts a drawing in this box so; `turned` gives the box of the drawing as a map shows it.
    fn map(&self, bounds: &Bounds, turned: impl FnOnce(&Affine) -> Bounds) -> Result<Affine, PlacementError> {
        let is_number = self.rotate_deg.is_finite() && self.margin_mm.is_finite() && self.scale.is_finite();
        if !is_number || self.scale <= 0.0 {
            return Err(PlacementError::BadNumber);
        }
        if bounds.is_empty() {
            return Ok(Affine::IDENTITY);
        }
        let sign = |is_mirrored: bool| if is_mirrored { -1.0 } else { 1.0 };
        let middle = bounds.centre();
        // About its middle, so that what is turned by a quarter stays where it is.
        let turn = Affine::moved(-middle.x, -middle.y)
            .then(&Affine::scaled(sign(self.mirror_x), sign(self.mirror_y)))
            .then(&Affine::turned(self.rotate_deg * (PI / 180.0)))
            .then(&Affine::moved(middle.x, middle.y));
        let is_turned = self.mirror_x || self.mirror_y || self.rotate_deg != 0.0;
        let (turn, box_mm) = if is_turned { (turn, turned(&turn)) } else { (Affine::IDENTITY, *bounds) };
        if !self.fits && !self.centres {
            return Ok(turn.then(&Affine::scaled(self.scale, self.scale)));
        }
        let (page_x, page_y) = self.page_mm.ok_or(PlacementError::NoPage)?;
        let (width_mm, height_mm) = (page_x - 2.0 * self.margin_mm, page_y - 2.0 * self.margin_mm);
        if !(width_mm > 0.0 && height_mm > 0.0) {
            return Err(PlacementError::NoRoom { width_mm, height_mm });
        }
        let (x, y) = box_mm.size_mm();
        let times = |room: f64, size: f64| if size > 0.0 { room / size } else { f64::INFINITY };
        let fit = libm::fmin(times(width_mm, x), times(height_mm, y));
        // A dot is as large on every page.
        let scale = if self.fits && fit.is_finite() { fit } else { self.scale };
        let at = box_mm.centre();
        let to = Point::new(0.5 * page_x, 0.5 * page_y);
        Ok(turn
            .then(&Affine::moved(-at.x, -at.y))
            .then(&Affine::scaled(scale, scale))
            .then(&Affine::moved(to.x, to.y)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{PathSegment, Stroke};
    use super::*;
    use std::vec;

    fn circle() -> Drawing {
        let from = Point::new(12.0, 5.0);
        let round = PathSegment::arc(Point::new(10.0, 5.0), 2.0 * PI, from);
        Drawing {
            strokes: vec![Stroke { from, segments: vec![round], ..Stroke::default() }],
            ..Drawing::default()
        }
    }

    #[test]
    fn turned_by_an_eighth_a_circle_still_fits_exactly() {
        let mut drawing = circle();
        let placement = Placement {
            rotate_deg: 45.0,
            fits: true,
            page_mm: Some((50.0, 40.0)),
            margin_mm: 5.0,
            ..Placement::default()
        };
        placement.put(&mut drawing).unwrap();
        let bounds = drawing.bounds();
        assert!(bounds.least.distance(Point::new(10.0, 5.0)) < 1e-9, "{bounds:?}");
        assert!(bounds.most.distance(Point::new(40.0, 35.0)) < 1e-9, "{bounds:?}");
    }

    #[test]
    fn a_quarter_turn_stays_in_place_and_a_scale_counts_from_the_origin() {
        let mut drawing = circle();
        Placement { rotate_deg: 90.0, ..Placement::default() }.put(&mut drawing).unwrap();
        assert_eq!(drawing.strokes[0].from, Point::new(10.0, 7.0));
        let mut drawing = circle();
        Placement { scale: 2.0, mirror_x: true, ..Placement::default() }.put(&mut drawing).unwrap();
        assert_eq!(drawing.strokes[0].from, Point::new(16.0, 10.0));
    }

    #[test]
    fn what_cannot_be_done_is_said_and_nothing_is_moved() {
        let page =
            Placement { page_mm: Some((10.0, 10.0)), fits: true, margin_mm: 5.0, ..Placement::default() };
        for (placement, expected) in [
            (Placement { scale: 0.0, ..Placement::default() }, PlacementError::BadNumber),
            (Placement { rotate_deg: f64::NAN, ..Placement::default() }, PlacementError::BadNumber),
            (Placement { centres: true, ..Placement::default() }, PlacementError::NoPage),
            (page, PlacementError::NoRoom { width_mm: 0.0, height_mm: 0.0 }),
        ] {
            let mut drawing = circle();
            assert_eq!(placement.put(&mut drawing), Err(expected));
            assert_eq!(drawing, circle());
        }
        let mut empty = Drawing::new();
        Placement { margin_mm: 1.0, ..page }.put(&mut empty).unwrap();
        let dot = Stroke::through([Point::new(3.0, 3.0)]).unwrap();
        let mut dot = Drawing { strokes: vec![dot], ..Drawing::default() };
        Placement { margin_mm: 1.0, ..page }.put(&mut dot).unwrap();
        assert_eq!(dot.strokes[0].from, Point::new(5.0, 5.0));
    }
}
