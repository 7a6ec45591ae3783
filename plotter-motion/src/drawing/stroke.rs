//! [`Stroke`]: what is drawn without lifting the pen.

use super::{Affine, Bounds, PathSegment};
use crate::Point;
use alloc::vec::Vec;
use core::time::Duration;

/// What happens between strokes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Mark {
    /// The machine stands still so long.
    Dwell(Duration),
    /// A new sheet.
    NewPage,
    /// The pen is put away.
    PutPenAway,
}

/// What is drawn without lifting the pen. A stroke of one line to where it begins is a dot.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stroke {
    /// Number of the pen in the carousel, from 1; 0 for the one that is there.
    #[cfg_attr(feature = "serde", serde(default))]
    pub pen: u8,
    /// Number of its layer, from 1, in [`Drawing::layers`](super::Drawing::layers); 0 for none.
    #[cfg_attr(feature = "serde", serde(default))]
    pub layer: u32,
    /// What happens before it is drawn.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub before: Vec<Mark>,
    /// Where it begins, mm.
    pub from: Point,
    /// What it is made of; at least one.
    pub segments: Vec<PathSegment>,
}

impl Stroke {
    /// Straight lines through places, of pen 0; `None` of no place. A single place is a dot.
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::Stroke};
    /// let stroke = Stroke::through([Point::new(0.0, 0.0), Point::new(3.0, 4.0)]).unwrap();
    /// assert_eq!((stroke.segments.len(), stroke.length_mm()), (1, 5.0));
    /// ```
    #[must_use]
    pub fn through(places: impl IntoIterator<Item = Point>) -> Option<Self> {
        let mut places = places.into_iter();
        let from = places.next()?;
        let mut segments: Vec<PathSegment> = places.map(PathSegment::line).collect();
        if segments.is_empty() {
            segments.push(PathSegment::line(from));
        }
        Some(Self { from, segments, ..Self::default() })
    }

    /// Where it ends.
    #[must_use]
    pub fn to(&self) -> Point {
        self.segments.last().map_or(self.from, |segment| segment.to)
    }

    /// Its segments, each with the place where it begins.
    pub fn segments(
        &self,
    ) -> impl DoubleEndedIterator<Item = (Point, &PathSegment)> + ExactSizeIterator + Clone {
        self.segments.iter().enumerate().map(|(index, segment)| {
            let before = index.checked_sub(1).and_then(|before| self.segments.get(before));
            (before.map_or(self.from, |before| before.to), segment)
        })
    }

    /// Its length, mm.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        self.segments().map(|(from, segment)| segment.length_mm(from)).sum()
    }

    /// Whether it ends where it begins and is more than a dot.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.to() == self.from && !self.is_dot()
    }

    /// Whether it is one place.
    #[must_use]
    pub fn is_dot(&self) -> bool {
        self.segments.iter().all(|segment| segment.is_dot(self.from))
    }

    /// The box round it.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::at(self.from);
        for (from, segment) in self.segments() {
            segment.extremes(from, &mut |at| bounds.grow(at));
        }
        bounds
    }

    /// The places of its lines, of which none is farther than `tolerance_mm` from it.
    pub fn places(&self, tolerance_mm: f64) -> impl Iterator<Item = Point> + '_ {
        let lines = self.segments().flat_map(move |(from, segment)| segment.places(from, tolerance_mm));
        core::iter::once(self.from).chain(lines)
    }

    /// Draws it from its end to its start.
    pub fn reverse(&mut self) {
        let mut at = self.from;
        for segment in &mut self.segments {
            let from = core::mem::replace(&mut at, segment.to);
            *segment = segment.reversed(from);
        }
        self.segments.reverse();
        self.from = at;
    }

    /// It as `map` shows it.
    #[must_use]
    pub fn mapped(&self, map: &Affine) -> Self {
        let mut segments = Vec::with_capacity(self.segments.len());
        for (from, segment) in self.segments() {
            segment.mapped(from, map, &mut segments);
        }
        Self { before: self.before.clone(), from: map.apply(self.from), segments, ..*self }
    }

    /// Another stroke of the same pen and layer.
    #[must_use]
    pub fn like(&self, from: Point, segments: Vec<PathSegment>) -> Self {
        Self { pen: self.pen, layer: self.layer, before: Vec::new(), from, segments }
    }

    /// Whether its numbers are finite, and it draws something.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.from.is_finite() && !self.segments.is_empty() && self.segments.iter().all(PathSegment::is_sound)
    }
}
