//! [`FrameLayout`]: where the borders of the frames lie, and how far a break point may lie from them.

use super::SplitError;

/// No sheet reaches farther, mm: a thousand kilometres.
const FARTHEST_MM: f64 = 1e9;

/// Shortest frame, mm: a shorter one is shorter than what is read at its change.
const SHORTEST_FRAME_MM: f64 = 10.0;

/// How a sheet is divided into frames along y, the way of the paper.
///
/// ```text
///  y ▲
///    │   frame 2
///    ├─────────────── begin_mm + 2 frame_mm
///    │░░░░░░░░░░░░░░░                          ░ the window around a border: here a break point may lie
///    │   frame 1
///    │░░░░░░░░░░░░░░░
///    ├─────────────── begin_mm + frame_mm
///    │░░░░░░░░░░░░░░░
///    │   frame 0
///    └─────────────── begin_mm        ▶ x, 0 to width_mm
/// ```
///
/// The default suits the documented textile plotter, whose table is 2000 mm wide and takes 1000 mm of the
/// paper's length: fields of 1980 x 950 mm. So the head still reaches the last 70 mm of the frame before.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FrameLayout {
    /// Where the first frame begins, mm along the sheet.
    pub begin_mm: f64,
    /// Length of each frame along the sheet, mm; 10 or more.
    pub frame_mm: f64,
    /// What is drawn lies between x = 0 and this, mm: any width that the paper has.
    pub width_mm: f64,
    /// How far from the border a line may be cut, mm, up to a quarter of the frame; 0 cuts at the border
    /// itself. The table must reach this far beyond the frame on both sides.
    pub window_mm: f64,
    /// A cut nearer than this to a corner or to another line does harm there, mm.
    pub clear_mm: f64,
}

impl Default for FrameLayout {
    fn default() -> Self {
        Self { begin_mm: 0.0, frame_mm: 950.0, width_mm: 1_980.0, window_mm: 5.0, clear_mm: 1.0 }
    }
}

impl FrameLayout {
    /// Where frame `index` begins, mm along the sheet.
    ///
    /// ```
    /// # use plotter_stitch::FrameLayout;
    /// assert_eq!(FrameLayout::default().border_mm(2000), 1_900_000.0); // 1.9 km
    /// ```
    #[must_use]
    pub fn border_mm(&self, index: u32) -> f64 {
        self.begin_mm + f64::from(index) * self.frame_mm
    }

    /// Refuses what is no division of a sheet, naming the number.
    pub(super) fn check(&self) -> Result<(), SplitError> {
        let quarter_mm = 0.25 * self.frame_mm;
        for (quantity, value, least, most) in [
            ("begin_mm", self.begin_mm, -FARTHEST_MM, FARTHEST_MM),
            ("frame_mm", self.frame_mm, SHORTEST_FRAME_MM, FARTHEST_MM),
            ("width_mm", self.width_mm, f64::MIN_POSITIVE, FARTHEST_MM),
            ("window_mm", self.window_mm, 0.0, quarter_mm),
            ("clear_mm", self.clear_mm, 0.0, quarter_mm),
        ] {
            // A NaN lies in no range.
            if !(least..=most).contains(&value) {
                return Err(SplitError::Layout { quantity, value, least, most });
            }
        }
        Ok(())
    }

    /// The greatest coordinate that is taken, mm.
    pub(super) fn farthest_mm(&self) -> f64 {
        FARTHEST_MM
    }

    /// The frame in which y lies without regard to the window; a border belongs to the frame that it begins.
    pub(super) fn frame_at(&self, y_mm: f64) -> u32 {
        let share = libm::floor((y_mm - self.begin_mm) / self.frame_mm);
        // What is divided rounds; the borders themselves decide.
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to what u32 holds"
        )]
        let guess = share.clamp(0.0, f64::from(u32::MAX - 1)) as u32;
        if guess > 0 && y_mm < self.border_mm(guess) {
            guess - 1
        } else if y_mm >= self.border_mm(guess + 1) {
            guess + 1
        } else {
            guess
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn a_border_belongs_to_the_frame_that_it_begins() {
        let layout = FrameLayout { frame_mm: 0.1 * 3_333.0, ..FrameLayout::default() };
        for index in 0..20_000 {
            assert_eq!(layout.frame_at(layout.border_mm(index)), index);
            assert_eq!(layout.frame_at(layout.border_mm(index + 1).next_down()), index);
        }
    }

    #[test]
    fn frames_without_length_are_refused_by_name() {
        for frame_mm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = FrameLayout { frame_mm, ..FrameLayout::default() }.check().unwrap_err();
            assert!(refused.to_string().starts_with("frame_mm"), "{refused}");
        }
    }

    #[test]
    fn a_window_reaches_no_farther_than_a_quarter_of_the_frame() {
        let layout = FrameLayout { frame_mm: 100.0, window_mm: 25.5, ..FrameLayout::default() };
        assert_eq!(layout.check().unwrap_err().to_string(), "window_mm is 25.5: it must lie in 0..=25 mm");
    }
}
