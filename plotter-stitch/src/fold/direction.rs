//! [`FoldDirection`]: along which diagonal a fold would lie.

use plotter_motion::Vec2;

/// The diagonal of a frame along which the ridge of a fold would lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum FoldDirection {
    /// From the lower left corner to the upper right one.
    Rising,
    /// From the upper left corner to the lower right one.
    Falling,
}

impl FoldDirection {
    /// From where the right border was found at this frame change and at the one before, mm; `None` if it has
    /// not moved, and nothing pulls the paper askew.
    ///
    /// What the border has moved is how far the paper has walked sideways. It is scanned at the frame's
    /// beginning, towards the receiving roll; at the frame's end the paper still comes straight from its
    /// source. If the border lies farther right now, the beginning has gone to the right of the end: the
    /// sheet is sheared, shortened along the rising diagonal and stretched along the falling one. Folds stand
    /// across the direction in which the paper is shortened, so their ridges fall.
    ///
    /// Source: Ivanov, Gueorguiev, Georgieva, Nenova, "Sketch drawing on infinite paper sheets", section IV,
    /// for the use of the sign; it does not say which sign means which diagonal.
    ///
    /// ```
    /// # use plotter_stitch::fold::FoldDirection;
    /// assert_eq!(FoldDirection::from_borders(1990.0, 1991.5), Some(FoldDirection::Falling));
    /// assert_eq!(FoldDirection::from_borders(1990.0, 1989.0), Some(FoldDirection::Rising));
    /// assert_eq!(FoldDirection::from_borders(1990.0, 1990.0), None);
    /// ```
    #[must_use]
    pub fn from_borders(before_mm: f64, now_mm: f64) -> Option<Self> {
        match now_mm - before_mm {
            change if change > 0.0 => Some(Self::Falling),
            change if change < 0.0 => Some(Self::Rising),
            _ => None,
        }
    }

    /// The way along the ridge in a frame of that size, of length 1; towards larger x.
    #[must_use]
    pub fn along(self, width_mm: f64, length_mm: f64) -> Vec2 {
        let up_mm = match self {
            Self::Rising => length_mm,
            Self::Falling => -length_mm,
        };
        Vec2::new(width_mm, up_mm).normalized().unwrap_or(Vec2::new(1.0, 0.0))
    }
}
