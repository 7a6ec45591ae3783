//! [`Drawn`]: a drawing, how it covers its pixels, and what shows through from its back.

use super::cover::cover;
use super::plane::Plane;
use crate::corpus::Picture;

/// A drawing, ready to be degraded.
#[derive(Debug)]
pub struct Drawn {
    pub(crate) picture: Picture,
    pub(crate) cover: Plane,
    back: Plane,
}

impl Drawn {
    /// A drawing, and one of the same size on the back of its sheet.
    #[must_use]
    pub fn new(picture: Picture, back: &Picture) -> Self {
        let size = [picture.width, picture.height].map(|side| usize::try_from(side).unwrap_or(0));
        let right = f64::from(picture.width) - 1.0;
        let front = cover(&picture.strokes, size.into(), |at| at, |pen| pen);
        // From this side the back is seen as in a mirror.
        let back = cover(&back.strokes, size.into(), |(x, y)| (right - x, y), |pen| pen);
        Self { picture, cover: front, back }
    }

    pub(crate) fn back(&self) -> &Plane {
        &self.back
    }
}
