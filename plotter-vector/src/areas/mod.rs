//! Areas: ink wider than a line, to be outlined or hatched.

mod clump;
mod disc;
mod hatch;
mod inset;
mod islands;
mod opening;
mod outline;
mod split;

pub use hatch::{Hatch, MIN_PITCH_PX};
pub use inset::inset_outlines;
pub(crate) use islands::Islands;
pub(crate) use opening::Opening;
pub use outline::{Outline, Outlines};
pub use split::{MAX_LINE_PX, WidthSplit, split_by_width};

use crate::{picture::Bitmap, stroke::PxPoint};
use core::fmt;

/// What is drawn of an area.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum AreaStyle {
    /// Its borders.
    #[default]
    Outline,
    /// Parallel lines in it.
    Hatch(Hatch),
    /// Its borders, then parallel lines that end on them.
    OutlineAndHatch(Hatch),
}

/// Draws areas with a pen that has a width.
///
/// ```
/// # use plotter_vector::{Bitmap, areas::{AreaStyle, Areas, Hatch}};
/// let square = Bitmap::from_picture(&"############\n".repeat(12))?;
/// let hatch = Hatch::default().with_pitch_px(2.0).with_angle_rad(0.0);
/// let areas = Areas::default().with_style(AreaStyle::OutlineAndHatch(hatch)).with_pen_px(2.0);
/// let paths: Vec<_> = areas.paths(&square)?.collect();
/// assert_eq!(paths.iter().map(|path| path.closed).collect::<Vec<_>>(), [true, false]); // the zigzag needs one stroke
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct Areas {
    /// What is drawn.
    pub style: AreaStyle,
    /// Width of the pen, px: borders are drawn half of it inside the area, so that its ink ends at the edge.
    /// 0 draws the edge itself. Of parts narrower than the pen nothing is drawn: split lines off at the pen's
    /// width at least.
    pub pen_px: f64,
}

impl Areas {
    /// The same with another [`Areas::style`].
    #[must_use]
    pub const fn with_style(self, style: AreaStyle) -> Self {
        Self { style, ..self }
    }

    /// The same with another [`Areas::pen_px`].
    #[must_use]
    pub const fn with_pen_px(self, pen_px: f64) -> Self {
        Self { pen_px, ..self }
    }
}

impl Default for Areas {
    /// Outlines with a pen of 8 px, 0.34 mm at 600 dots per inch.
    fn default() -> Self {
        Self { style: AreaStyle::Outline, pen_px: 8.0 }
    }
}

/// A path of the pen's centre.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaPath {
    /// Sites in order: about a pixel apart along borders, the ends only of straight lines.
    pub sites: Vec<PxPoint>,
    /// Whether the path goes back from the last site to the first, which is not repeated.
    pub closed: bool,
}

/// Widest pen, px.
const MAX_PEN_PX: f64 = inset::MAX_INSET_PX;

/// Why areas cannot be drawn as asked.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AreaError {
    /// The pen has no width that a pen can have.
    Pen {
        /// Asked width.
        pen_px: f64,
    },
    /// The hatching's lines lie too close, or have no distance.
    Pitch {
        /// Asked distance.
        pitch_px: f64,
    },
    /// The hatching has no direction.
    Angle {
        /// Asked angle.
        angle_rad: f64,
    },
}

impl fmt::Display for AreaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pen { pen_px } => {
                write!(f, "pen: {pen_px} px lies outside 0..={MAX_PEN_PX} px; 0 draws the edge itself")
            }
            Self::Pitch { pitch_px } => write!(
                f,
                "hatching: a pitch of {pitch_px} px is not a number from {MIN_PITCH_PX} px up; the pen's width \
                 covers the area"
            ),
            Self::Angle { angle_rad } => {
                write!(f, "hatching: an angle of {angle_rad} rad is not a number; 0.785 is 45 degrees")
            }
        }
    }
}

impl core::error::Error for AreaError {}

impl Areas {
    /// Lines up to this width have to be split off so that the pen finds a path inside of all areas, px.
    pub(crate) fn narrowest_px(&self) -> u32 {
        if self.pen_px > 0.0 {
            // Even, so that the disc that is wider than such lines and that around the pen have one centre.
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most MAX_PEN_PX")]
            let half = libm::ceil((self.pen_px.min(MAX_PEN_PX) + 1.0) / 2.0) as u32;
            2 * half
        } else {
            0
        }
    }

    /// The paths for all ink of a picture: its areas, as [`split_by_width`] finds them, or all of it.
    ///
    /// Outlines come first, one at a time as they are asked for; the hatching of all areas follows, in the
    /// order of its lines. With [`AreaStyle::Hatch`] and a pitch up to the pen's width, the pen's ink covers
    /// every place where its centre may be, to within a pixel; with [`AreaStyle::OutlineAndHatch`] also the
    /// rim. Memory: for outlines 1 byte per pixel of the longest, for hatching 16 bytes per pixel of all of
    /// them.
    ///
    /// # Errors
    /// [`AreaError`], before anything is drawn.
    pub fn paths<'a>(
        &self,
        thick: &'a Bitmap,
    ) -> Result<impl Iterator<Item = AreaPath> + use<'a>, AreaError> {
        let Self { style, pen_px } = *self;
        if !(0.0..=MAX_PEN_PX).contains(&pen_px) {
            return Err(AreaError::Pen { pen_px });
        }
        let half_pen_px = pen_px / 2.0;
        // Lines that end on an outline end in the middle between its centre and its inner edge.
        let (outline, hatch) = match style {
            AreaStyle::Outline => (true, None),
            AreaStyle::Hatch(hatch) => (false, Some((hatch, half_pen_px))),
            AreaStyle::OutlineAndHatch(hatch) => (true, Some((hatch, pen_px))),
        };
        if let Some((Hatch { pitch_px, angle_rad, .. }, _)) = hatch {
            if !(pitch_px.is_finite() && pitch_px >= MIN_PITCH_PX) {
                return Err(AreaError::Pitch { pitch_px });
            }
            if !angle_rad.is_finite() {
                return Err(AreaError::Angle { angle_rad });
            }
        }
        let outlines = outline.then(|| inset_outlines(thick, half_pen_px)).into_iter().flatten();
        let outlines = outlines.map(|sites| AreaPath { sites, closed: true });
        // Made when the outlines have been taken.
        let hatching = core::iter::once(hatch).flatten().flat_map(move |(hatch, inset_px)| {
            let borders: Vec<_> = inset_outlines(thick, inset_px).collect();
            hatch.strokes(&borders, pen_px)
        });
        let hatching = hatching.map(|stroke| AreaPath { sites: stroke.sites, closed: stroke.closed });
        Ok(outlines.chain(hatching))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_drawn_is_refused_with_its_value() {
        let dot = Bitmap::from_picture("#").unwrap();
        let error = |areas: Areas| areas.paths(&dot).map(Iterator::count).unwrap_err().to_string();
        assert_eq!(
            error(Areas { pen_px: -1.0, ..Areas::default() }),
            "pen: -1 px lies outside 0..=512 px; 0 draws the edge itself"
        );
        let hatched = |hatch| Areas { style: AreaStyle::Hatch(hatch), pen_px: 1.0 };
        let text = error(hatched(Hatch { pitch_px: 0.1, ..Hatch::default() }));
        assert!(text.starts_with("hatching: a pitch of 0.1 px is not a number from 0.5 px up"), "{text}");
        let text = error(hatched(Hatch { angle_rad: f64::NAN, ..Hatch::default() }));
        assert!(text.starts_with("hatching: an angle of NaN rad"), "{text}");
        assert!(Areas { pen_px: f64::NAN, ..Areas::default() }.paths(&dot).is_err());
    }

    #[test]
    fn what_is_wider_than_the_narrowest_area_has_a_path_inside() {
        for pen_px in [0.5, 1.0, 2.0, 2.5, 5.0, 8.0, 11.3] {
            let areas = Areas { pen_px, ..Areas::default() };
            let side = areas.narrowest_px() as usize + 1;
            let square = Bitmap::from_picture(&("#".repeat(side) + "\n").repeat(side)).unwrap();
            assert_eq!(split_by_width(&square, areas.narrowest_px()).thick, square);
            assert_eq!(areas.paths(&square).unwrap().count(), 1, "{pen_px}");
        }
    }

    #[test]
    fn hatching_ends_half_a_pen_inside_of_what_goes_around_it() {
        let square = Bitmap::from_picture(&("#".repeat(60) + "\n").repeat(60)).unwrap();
        let hatch = Hatch { pitch_px: 12.0, angle_rad: 0.0, ..Hatch::default() };
        let leftmost = |style| {
            let paths: Vec<_> = Areas { style, pen_px: 8.0 }.paths(&square).unwrap().collect();
            let left = |path: &AreaPath| path.sites.iter().map(|at| at.x).fold(60.0, f64::min);
            paths.iter().map(left).collect::<Vec<_>>()
        };
        // The pen's centre, 8 px wide: at half its width, and at all of it where a border is drawn, too.
        assert_eq!(leftmost(AreaStyle::Hatch(hatch)), [4.0]);
        assert_eq!(leftmost(AreaStyle::OutlineAndHatch(hatch)), [4.0, 8.0]);
    }

    #[test]
    fn a_positive_angle_turns_the_hatching_counter_clockwise() {
        let square = Bitmap::from_picture(&("#".repeat(60) + "\n").repeat(60)).unwrap();
        let hatch = Hatch { angle_rad: 0.5, max_join_px: 0.0, ..Hatch::default() };
        let areas = Areas { style: AreaStyle::Hatch(hatch), pen_px: 2.0 };
        for path in areas.paths(&square).unwrap().filter(|path| path.sites.len() == 2) {
            let way = path.sites[1] - path.sites[0];
            // Up is where y falls.
            assert!((libm::tan(0.5) * way.x + way.y).abs() < 1e-6, "{way:?}");
        }
    }

    #[test]
    fn the_edge_itself_is_drawn_by_a_pen_without_width() {
        let dot = Bitmap::from_picture("#").unwrap();
        let paths: Vec<_> = Areas { pen_px: 0.0, ..Areas::default() }.paths(&dot).unwrap().collect();
        assert_eq!(paths.iter().map(|path| (path.sites.len(), path.closed)).collect::<Vec<_>>(), [(4, true)]);
    }
}
