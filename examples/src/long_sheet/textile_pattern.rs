//! [`TextilePattern`]: a draft for cloth of any length, to draw where no file is given.

use plotter_motion::{PlotOp, Point, Vec2};
use std::f64::consts::{PI, TAU};

/// The pattern repeats after this length, mm: no divisor of any frame that comes to mind.
const REPEAT_MM: f64 = 310.0;
/// Each wave is drawn in strokes of this many repeats, one row begun one repeat after the other.
const STROKE_REPEATS: u32 = 3;
/// Rows of waves.
const ROWS: u32 = 10;
/// The narrowest table it is made for, mm.
const LEAST_WIDTH_MM: f64 = 100.0;

/// Waves that run on through the whole length, flowers of arcs between them, and rows of dots.
///
/// ```text
///     ∿∿∿∿∿∿∿∿∿∿∿∿∿∿∿
///      ✿  ·  ·  ✿  ·
///     ∿∿∿∿∿∿∿∿∿∿∿∿∿∿∿       turned by a quarter: the length lies along y, as the paper goes
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextilePattern {
    /// How long it is, mm.
    pub length_mm: f64,
    /// How wide, mm.
    pub width_mm: f64,
    /// Length of the lines that the waves are made of, mm.
    pub chord_mm: f64,
}

impl TextilePattern {
    /// The operations, in the order of the sheet: each stroke begins at most three repeats behind the
    /// farthest place before it.
    pub fn ops(self) -> impl Iterator<Item = PlotOp> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped, and whole")]
        let repeats = (self.length_mm / REPEAT_MM).ceil().clamp(1.0, 1e7) as u32;
        std::iter::once(PlotOp::SelectPen { pen: 1 })
            .chain((0..repeats).flat_map(move |repeat| {
                (0..ROWS).flat_map(move |row| {
                    let begins = repeat % STROKE_REPEATS == row % STROKE_REPEATS || repeat == 0;
                    let wave = begins.then(|| self.wave(repeat, row));
                    wave.into_iter().flatten().chain(self.flower(repeat, row)).chain(self.dots(repeat, row))
                })
            }))
            .map(move |op| self.turned(op))
    }

    /// An operation of the pattern that lies along x, turned by a quarter: to the last bit, as no rotation by
    /// an angle is.
    fn turned(self, op: PlotOp) -> PlotOp {
        let turned = |place: Point| Point::new(self.row_mm() * f64::from(ROWS) - place.y, place.x);
        match op {
            PlotOp::Travel { to } => PlotOp::Travel { to: turned(to) },
            PlotOp::Draw { to, feed_mm_s } => PlotOp::Draw { to: turned(to), feed_mm_s },
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                PlotOp::DrawArc { centre: turned(centre), sweep_rad, to: turned(to), feed_mm_s }
            }
            other => other,
        }
    }

    fn row_mm(self) -> f64 {
        self.width_mm.max(LEAST_WIDTH_MM) / f64::from(ROWS)
    }

    fn wave_at(self, row: u32, x: f64) -> Point {
        let row_mm = self.row_mm();
        let phase = TAU * x / (REPEAT_MM / f64::from(1 + row % 3)) + f64::from(row);
        Point::new(x, row_mm * (f64::from(row) + 0.4 + 0.25 * libm::sin(phase)))
    }

    /// A wave up to where the next stroke of its row begins.
    fn wave(self, repeat: u32, row: u32) -> impl Iterator<Item = PlotOp> {
        let ahead =
            (row % STROKE_REPEATS + 2 * STROKE_REPEATS - repeat % STROKE_REPEATS - 1) % STROKE_REPEATS + 1;
        let begin_mm = f64::from(repeat) * REPEAT_MM;
        let end_mm = (begin_mm + f64::from(ahead) * REPEAT_MM).min(self.length_mm);
        let way_mm = (end_mm - begin_mm).max(0.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped, and whole")]
        let chords = (way_mm / self.chord_mm).ceil().clamp(1.0, 1e7) as u32;
        (0..=chords).map(move |number| {
            let to = self.wave_at(row, begin_mm + way_mm * f64::from(number) / f64::from(chords));
            if number == 0 { PlotOp::Travel { to } } else { PlotOp::Draw { to, feed_mm_s: None } }
        })
    }

    /// Six petals of two arcs each, around a ring.
    fn flower(self, repeat: u32, row: u32) -> impl Iterator<Item = PlotOp> {
        const PETALS: u32 = 6;
        let x = (f64::from(repeat) + 0.2 + 0.31 * f64::from(row % 3)) * REPEAT_MM;
        let centre = Point::new(x, self.row_mm() * (f64::from(row) + 0.85));
        let size_mm = 0.13 * self.row_mm();
        let petals = (0..PETALS).flat_map(move |petal| {
            let out = Vec2::new(size_mm, 0.0).rotated(TAU * f64::from(petal) / f64::from(PETALS));
            let (root, tip) = (centre + out * 0.4, centre + out);
            // Two arcs of 120 degrees over the way from root to tip: their centres lie beside its middle.
            let beside = (tip - root).perpendicular() * (0.5 / libm::tan(PI / 3.0));
            let middle = root.lerp(tip, 0.5);
            let arc = |centre: Point, to: Point| PlotOp::DrawArc {
                centre,
                sweep_rad: TAU / 3.0,
                to,
                feed_mm_s: None,
            };
            [PlotOp::Travel { to: root }, arc(middle + beside, tip), arc(middle + -beside, root)]
        });
        let ring = Point::new(centre.x + 0.3 * size_mm, centre.y);
        let circle = PlotOp::DrawArc { centre, sweep_rad: TAU, to: ring, feed_mm_s: None };
        let is_within = x + size_mm <= self.length_mm;
        petals.chain([PlotOp::Travel { to: ring }, circle]).filter(move |_| is_within)
    }

    fn dots(self, repeat: u32, row: u32) -> impl Iterator<Item = PlotOp> {
        (0..8_u32).flat_map(move |dot| {
            let x = (f64::from(repeat) + f64::from(dot) / 8.0) * REPEAT_MM;
            let to = Point::new(x, self.row_mm() * (f64::from(row) + 0.06));
            let is_within = x <= self.length_mm;
            [PlotOp::Travel { to }, PlotOp::Draw { to, feed_mm_s: None }]
                .into_iter()
                .filter(move |_| is_within)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_stitch::{FrameLayout, Frames};

    #[test]
    fn it_lies_on_the_table_in_the_order_of_the_sheet_and_its_waves_run_on() {
        let pattern = TextilePattern { length_mm: 6_000.0, width_mm: 1_980.0, chord_mm: 5.0 };
        let frames: Vec<_> =
            Frames::new(pattern.ops(), FrameLayout::default()).collect::<Result<_, _>>().unwrap();
        assert_eq!(frames.len(), 7);
        // Each wave, and perhaps a flower.
        assert!(frames.iter().skip(1).all(|frame| frame.begin_breaks().len() >= ROWS as usize));
    }

    #[test]
    fn arcs_end_where_they_say() {
        let pattern = TextilePattern { length_mm: 400.0, width_mm: 1_980.0, chord_mm: 5.0 };
        let mut at = Point::ORIGIN;
        for op in pattern.ops() {
            if let PlotOp::DrawArc { centre, sweep_rad, to, .. } = op {
                assert!((centre + (at - centre).rotated(sweep_rad)).distance(to) < 1e-9);
            }
            at = op.target().unwrap_or(at);
        }
    }
}
