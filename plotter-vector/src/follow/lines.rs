//! [`Lines`]: the middle of each line that a window shows.

use super::centred::{centred, turns, widths_px};
use super::corners::runs;
use super::ends::straight_ends;
use super::flat::Flat;
use super::loops::{begun_straight, joined};
use super::ribbons::fitted;
use super::tips::{sharpened, without_crumbs, without_rungs};
use crate::{
    areas::split_by_width,
    ink::{despeckle, pen_width_px},
    picture::{Bitmap, Gray, Pixel},
    stroke::{PxPoint, PxVec},
    trace::Ours,
};

/// Side of the blocks in which the darkest and the lightest place are found, px.
const BLOCK_PX: usize = 4;

/// Least darkness of ink.
const LEAST_DARK: f32 = 0.12;

/// Of places along a line, px from one to the next.
pub(super) const SPACING_PX: f64 = 2.0;

/// From the window's border to the trusted part: a tip is drawn truly only when its arms are seen. In widths of a line, and at most as
/// a share of the window's side.
const MARGIN_WIDTHS: f64 = 9.0;
const MARGIN_SHARE: f64 = 0.15;

/// The same for sharp turns, whose arms are one piece of ink for a while.
const TURN_MARGIN_WIDTHS: f64 = 16.0;
const TURN_MARGIN_SHARE: f64 = 0.27;

/// A sharper turn is a corner, which stays: cosine of 25 degrees, and a little. Of places that a camera's
/// blur has moved a turn of just that is a curve.
pub(super) const CORNER_COS: f64 = 0.906;

/// A piece of a line's middle.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Places in order, about 2 px from each other; in pixels of the window, then of the paper.
    pub(super) places: Vec<PxPoint>,
    /// Whether the last place is joined to the first.
    pub(super) closed: bool,
    /// Whether the line goes on behind its first and its last place, where the window ends.
    pub(super) open: [bool; 2],
}

/// What a window shows.
#[derive(Clone, Debug, Default)]
pub(super) struct Lines {
    /// Pieces of lines inside of the trusted part of the window.
    pub(super) pieces: Vec<Piece>,
    /// Width of the lines, px; 0 without ink.
    pub(super) width_px: f64,
    /// From the window's border to the trusted part, px.
    pub(super) margin_px: f64,
    /// The middle of ink that is too thick for a line, if there is any.
    pub(super) area: Option<PxPoint>,
    /// Whether there is any ink.
    pub(super) has_ink: bool,
}

/// The darkness of the faintest line in a window.
fn least_dark(flat: &Flat) -> f32 {
    LEAST_DARK.max(8.0 * flat.noise)
}

/// Whether a piece is as dark along its middle as a line; the grain of the paper and what is left of uneven light are not.
fn is_dark(flat: &Flat, places: &[PxPoint]) -> bool {
    let mut darks: Vec<f32> = places.iter().map(|at| flat.at(*at)).collect();
    darks.sort_by(f32::total_cmp);
    darks.get(darks.len() / 2).is_some_and(|median| *median >= least_dark(flat))
}

/// The ink of a window: darker than half way between the darkest and the lightest place around.
fn ink(flat: &Flat) -> Option<Bitmap> {
    let (width, height) = flat.size();
    let (columns, rows) = (width.div_ceil(BLOCK_PX), height.div_ceil(BLOCK_PX));
    let mut ends = vec![(0.0_f32, 1.0_f32); columns * rows];
    for (y, row) in flat.rows().enumerate() {
        for (block, part) in row.chunks(BLOCK_PX).enumerate() {
            if let Some((most, least)) = ends.get_mut(y / BLOCK_PX * columns + block) {
                for dark in part {
                    *most = most.max(*dark);
                    *least = least.min(*dark);
                }
            }
        }
    }
    let least_dark = least_dark(flat);
    let level = |x: usize, y: usize| {
        let (mut most, mut least) = (0.0_f32, 1.0_f32);
        for v in y.saturating_sub(1)..=(y + 1).min(rows - 1) {
            for u in x.saturating_sub(1)..=(x + 1).min(columns - 1) {
                if let Some((high, low)) = ends.get(v * columns + u) {
                    most = most.max(*high);
                    least = least.min(*low);
                }
            }
        }
        // Ink all around: no rim is near.
        let base = if most - least > 0.25 * most { least.max(0.0) } else { 0.0 };
        if most < least_dark { f32::INFINITY } else { (0.5 * (most + base)).max(0.6 * least_dark) }
    };
    let levels: Vec<f32> =
        (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).map(|(x, y)| level(x, y)).collect();
    let mut ink = Bitmap::new(u32::try_from(width).ok()?, u32::try_from(height).ok()?).ok()?;
    for (y, row) in flat.rows().enumerate() {
        for (block, part) in row.chunks(BLOCK_PX).enumerate() {
            let level = levels.get(y / BLOCK_PX * columns + block).copied().unwrap_or(f32::INFINITY);
            for (i, _) in part.iter().enumerate().filter(|(_, dark)| **dark > level) {
                let x = u32::try_from(block * BLOCK_PX + i).ok()?;
                ink.set(Pixel::new(x, u32::try_from(y).ok()?), true);
            }
        }
    }
    Some(ink)
}

/// Whether a block of 16 x 16 px is all ink.
fn has_solid_block(ink: &Bitmap) -> bool {
    (0..ink.height() / 16).any(|row| {
        let mut all = ink.row(16 * row).to_vec();
        for y in 16 * row + 1..16 * row + 16 {
            all.iter_mut().zip(ink.row(y)).for_each(|(word, more)| *word &= more);
        }
        all.iter().any(|word| (0..4).any(|part| word >> (16 * part) & 0xffff == 0xffff))
    })
}

impl Lines {
    /// The lines of a whole window; what is wider than `max_line_px` is an area.
    pub(super) fn of(flat: &Flat, max_line_px: u32) -> Self {
        let Some(mut ink) = ink(flat) else { return Self::default() };
        let pen_px = pen_width_px(&ink).unwrap_or(max_line_px).max(1);
        despeckle(&mut ink, 4 + crate::ink::smallest_mark_px(pen_px) / 2);
        if ink.count() == 0 {
            return Self::default();
        }
        let mut area = None;
        if has_solid_block(&ink) {
            let split = split_by_width(&ink, max_line_px);
            area = middle_of(&split.thick);
            ink = split.thin;
        }
        let width_px = f64::from(pen_width_px(&ink).unwrap_or(pen_px));
        let side_px = count_f64(flat.size().0.min(flat.size().1));
        let margin_px = (5.0 + 1.5 * width_px).max((MARGIN_WIDTHS * width_px).min(MARGIN_SHARE * side_px));
        let levels = flat.rows().flatten().map(|dark| super::whole::level(255.0 * (1.0 - dark))).collect();
        let grey = Gray::of_checked_size(ink.width(), ink.height(), levels);
        let ours = Ours { tolerance_px: 0.25, band_rows: ink.height().max(1), ..Ours::default() };
        let strokes = ours.centring(max_line_px).strokes(&ink, Some((&grey, true)));
        let (width, height) = (f64::from(ink.width()), f64::from(ink.height()));
        let window = Window {
            width,
            height,
            margin_px,
            turn_px: (TURN_MARGIN_WIDTHS * width_px).min(TURN_MARGIN_SHARE * side_px),
        };
        let mut fine: Vec<_> = strokes.iter().map(|stroke| resampled(&stroke.vertices, 1.0)).collect();
        without_rungs(flat, &mut fine, width_px);
        let places = |stroke: &Vec<PxPoint>| begun_straight(resampled(stroke, SPACING_PX));
        let mut middles: Vec<Vec<PxPoint>> =
            joined(sharpened(flat, fine, width_px), width_px).iter().map(places).collect();
        let widths_px = widths_px(flat, &middles, width_px);
        centred(flat, &mut middles, &widths_px);
        straight_ends(flat, &mut middles, &widths_px, width_px, false);
        // Beside an area its ink would be taken for that of lines.
        if area.is_none() {
            fitted(flat, &mut middles, &widths_px);
            straight_ends(flat, &mut middles, &widths_px, width_px, true);
        }
        without_crumbs(&mut middles, &widths_px, width_px);
        let pieces = middles
            .iter()
            .flat_map(|places| clipped(places, &window.trusted(places, &turns(places, width_px))))
            .filter(|piece| is_dark(flat, &piece.places))
            .collect();
        Self { pieces, width_px, margin_px, area, has_ink: true }
    }
}

/// The trusted part of a window.
struct Window {
    width: f64,
    height: f64,
    margin_px: f64,
    turn_px: f64,
}

impl Window {
    fn holds(&self, at: &PxPoint, margin_px: f64) -> bool {
        at.x >= margin_px
            && at.y >= margin_px
            && at.x <= self.width - margin_px
            && at.y <= self.height - margin_px
    }

    /// Which places are trusted: a sharp turn wholly or not at all, for from one arm alone the other one's ink is taken for its own.
    fn trusted(&self, places: &[PxPoint], in_turn: &[bool]) -> Vec<bool> {
        let mut trusted: Vec<bool> = places.iter().map(|at| self.holds(at, self.margin_px)).collect();
        for run in runs(in_turn) {
            let turn = places.get(run.clone()).unwrap_or(&[]);
            // One that is too long for the window is followed piece by piece.
            let length_px = 0.5 * SPACING_PX * count_f64(turn.len());
            let is_long = length_px > self.width.min(self.height) - 2.0 * self.turn_px;
            if !is_long && !turn.iter().all(|at| self.holds(at, self.turn_px)) {
                trusted.iter_mut().take(run.end).skip(run.start).for_each(|trusted| *trusted = false);
            }
        }
        trusted
    }
}

/// The middle of a picture's ink.
fn middle_of(ink: &Bitmap) -> Option<PxPoint> {
    let (mut x, mut y, mut count) = (0.0, 0.0, 0.0);
    for at in ink.ink() {
        x += f64::from(at.x) + 0.5;
        y += f64::from(at.y) + 0.5;
        count += 1.0;
    }
    (count > 0.0).then(|| PxPoint::new(x / count, y / count))
}

/// Places along a polyline, as far from each other as said or a little less, with its ends and corners among them.
pub(super) fn resampled(vertices: &[PxPoint], spacing_px: f64) -> Vec<PxPoint> {
    let Some(first) = vertices.first() else { return Vec::new() };
    let mut places = vec![*first];
    // A stretch from corner to corner is divided evenly.
    let mut stretch = vec![*first];
    for (i, vertex) in vertices.iter().enumerate().skip(1) {
        stretch.push(*vertex);
        let next = vertices.get(i + 1);
        let corner = next.is_none_or(|next| {
            let before = vertices.get(i - 1).copied().unwrap_or(*vertex);
            cosine(*vertex - before, *next - *vertex) < CORNER_COS
        });
        if corner {
            divide(&stretch, spacing_px, &mut places);
            stretch = vec![*vertex];
        }
    }
    places
}

fn divide(stretch: &[PxPoint], spacing_px: f64, places: &mut Vec<PxPoint>) {
    let length: f64 =
        stretch.windows(2).map(|pair| if let [a, b] = pair { a.distance(*b) } else { 0.0 }).sum();
    if length <= 0.0 {
        return;
    }
    let parts = super::whole::count(libm::ceil(length / spacing_px)).max(1);
    let step = length / f64::from(u32::try_from(parts).unwrap_or(1));
    let (mut next, mut passed) = (step, 0.0);
    for pair in stretch.windows(2) {
        let [a, b] = pair else { continue };
        let way = a.distance(*b);
        while next <= passed + way && next < length - 0.5 * step {
            places.push(*a + (*b - *a) * ((next - passed) / way));
            next += step;
        }
        passed += way;
    }
    places.extend(stretch.last());
}

/// Cosine of the angle between two ways; 1 where one has no length.
pub(super) fn cosine(one: PxVec, other: PxVec) -> f64 {
    let lengths = one.length() * other.length();
    if lengths > 0.0 { one.dot(other) / lengths } else { 1.0 }
}

/// A small number as a float.
pub(super) fn count_f64(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}

/// The parts of a line inside of the trusted part of the window.
fn clipped(places: &[PxPoint], is_trusted: &[bool]) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut inside = false;
    for (i, (place, trusted)) in places.iter().zip(is_trusted).enumerate() {
        if !trusted {
            if inside && let Some(piece) = pieces.last_mut() {
                piece.open[1] = true;
            }
            inside = false;
            continue;
        }
        if !inside {
            pieces.push(Piece { places: Vec::new(), closed: false, open: [i > 0, false] });
            inside = true;
        }
        if let Some(piece) = pieces.last_mut() {
            piece.places.push(*place);
        }
    }
    let is_loop = places.len() > 3 && places.first() == places.last();
    if is_loop && is_trusted.iter().all(|trusted| *trusted) {
        if let Some(piece) = pieces.first_mut() {
            piece.places.pop();
            piece.closed = true;
        }
    } else if is_loop && is_trusted.first() == Some(&true) && pieces.len() > 1 {
        // The piece over the seam of the loop is one.
        if let Some(last) = pieces.pop()
            && let Some(first) = pieces.first_mut()
        {
            let mut whole = last.places;
            whole.pop();
            whole.append(&mut first.places);
            first.places = whole;
            first.open[0] = last.open[0];
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::{CameraSettings, Paper, Route, SimulatedCamera};

    fn at_angle(at: PxPoint, angle: f64, way_px: f64) -> PxPoint {
        PxPoint::new(at.x + way_px * angle.cos(), at.y + way_px * angle.sin())
    }

    /// How far places that are found lie beside the lines drawn, in twelve positions within 90 px: at most, and
    /// the mean of the positions' greatest distances; and how far a drawn place is from all that are found, at
    /// most.
    fn off(pen_px: f64, drawn: &dyn Fn(f64, PxPoint) -> Vec<Vec<PxPoint>>) -> [f64; 3] {
        off_of(&|turn, at| drawn(turn, at).into_iter().map(|line| (line, pen_px)).collect())
    }

    /// The same of lines with the width of each, px.
    fn off_of(drawn: &dyn Fn(f64, PxPoint) -> Vec<(Vec<PxPoint>, f64)>) -> [f64; 3] {
        let (mut worst, mut sum, mut missed) = (0.0_f64, 0.0, 0.0_f64);
        for k in 0..12_u8 {
            let at = PxPoint::new(150.3 + 0.13 * f64::from(k), 149.7 + 0.31 * f64::from(k));
            let strokes = drawn(0.37 + 0.523 * f64::from(k), at);
            let lines: Vec<_> = strokes.iter().map(|(line, _)| line.clone()).collect();
            let paper = Paper::drawn(300, 300, &strokes).unwrap();
            let settings = CameraSettings { seed: u64::from(k), ..CameraSettings::default() };
            let window = SimulatedCamera::new(&paper, settings).window(PxPoint::new(150.0, 150.0));
            let pieces = Lines::of(&Flat::of(&window, None, None), 40).pieces;
            let found: Vec<Vec<PxPoint>> = pieces.into_iter().map(|piece| piece.places).collect();
            let apart = |places: &[Vec<PxPoint>], route: &Route| {
                let near = places.iter().flatten().filter(|place| place.distance(at) < 90.0);
                near.map(|place| route.nearest(*place, 50.0).map_or(50.0, |found| found.0))
                    .fold(0.0, f64::max)
            };
            let greatest = apart(&found, &Route::of(&lines));
            let fine: Vec<_> = lines.iter().map(|line| resampled(line, 1.0)).collect();
            (worst, sum) = (worst.max(greatest), sum + greatest);
            missed = missed.max(apart(&fine, &Route::of(&found)));
        }
        [worst, sum / 12.0, missed]
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn tips_and_corners_are_where_they_are() {
        for (degrees, most) in
            [(12.0, 0.4), (18.0, 0.4), (26.0, 0.4), (35.0, 0.4), (50.0, 0.5), (90.0, 0.8), (120.0, 0.2)]
        {
            let half = 0.5 * f64::to_radians(degrees);
            let off = off(5.0, &|turn, at| {
                vec![vec![at_angle(at, turn + half, 120.0), at, at_angle(at, turn - half, 120.0)]]
            });
            assert!(off[0] < most && off[1] < 0.3 && off[2] < 1.8, "{degrees}: {off:?}");
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn crossings_and_tees_are_straight() {
        for degrees in [20.0, 30.0, 45.0, 60.0, 90.0] {
            let angle = f64::to_radians(degrees);
            let across = |turn: f64, at: PxPoint| vec![at_angle(at, turn, 120.0), at_angle(at, turn, -120.0)];
            let crossing = off(5.0, &|turn, at| vec![across(turn, at), across(turn + angle, at)]);
            assert!(crossing[0] < 0.3 && crossing[2] < 0.3, "{degrees}: {crossing:?}");
            let tee =
                off(5.0, &|turn, at| vec![across(turn, at), vec![at, at_angle(at, turn + angle, 120.0)]]);
            assert!(tee[0] < 0.7 && tee[1] < 0.3 && tee[2] < 1.0, "{degrees}: {tee:?}");
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_thick_curve_stays_round_where_thin_lines_cross_it() {
        for (thick_px, most_mean_px) in [(10.0, 0.5), (12.0, 0.9)] {
            let off = off_of(&|turn, at| {
                let middle = at_angle(at, turn, 150.0);
                let on_arc =
                    |angle: f64, radius: f64| at_angle(middle, turn + core::f64::consts::PI + angle, radius);
                let arc = (-32..=32_i8).map(|k| on_arc(0.025 * f64::from(k), 150.0)).collect();
                let thin =
                    [-0.4, 0.0, 0.4].map(|angle| (vec![on_arc(angle, 75.0), on_arc(angle, 225.0)], 4.0));
                [(arc, thick_px)].into_iter().chain(thin).collect()
            });
            assert!(off[0] < 2.2 && off[1] < most_mean_px, "{thick_px}: {off:?}");
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn curves_that_touch_stay_curves() {
        // Two circles of 70 px, side by side, and one on a straight line.
        let circle = |middle: PxPoint| -> Vec<PxPoint> {
            (0..=120_u8)
                .map(|k| at_angle(middle, core::f64::consts::TAU * f64::from(k) / 120.0, 70.0))
                .collect()
        };
        let circles =
            off(5.0, &|turn, at| vec![circle(at_angle(at, turn, 70.0)), circle(at_angle(at, turn, -70.0))]);
        assert!(circles[0] < 0.7 && circles[1] < 0.3 && circles[2] < 1.8, "{circles:?}");
        let on_line = off(5.0, &|turn, at| {
            let along = turn + core::f64::consts::FRAC_PI_2;
            vec![
                circle(at_angle(at, turn, 70.0)),
                vec![at_angle(at, along, 120.0), at_angle(at, along, -120.0)],
            ]
        });
        assert!(on_line[0] < 0.7 && on_line[1] < 0.3 && on_line[2] < 1.8, "{on_line:?}");
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn curves_that_end_in_one_tip_reach_it() {
        // Quarters of circles of 45 px, which touch where they end: straight lines along them meet 14 px before.
        let tip = off(4.0, &|turn, at| {
            let quarter = |side: f64| {
                let middle = at_angle(at, turn + side * core::f64::consts::FRAC_PI_2, 45.0);
                (0..=45_u8).map(move |k| {
                    at_angle(middle, turn - side * (90.0 - 2.0 * f64::from(k)).to_radians(), 45.0)
                })
            };
            vec![quarter(1.0).rev().chain(quarter(-1.0).skip(1)).collect()]
        });
        assert!(tip[0] < 1.6 && tip[1] < 1.1 && tip[2] < 2.0, "{tip:?}");
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_line_that_ends_a_little_behind_another_is_straight() {
        for degrees in [45.0, 70.0, 90.0] {
            let off = off(5.0, &|turn, at| {
                let way = turn + f64::to_radians(degrees);
                let across = vec![at_angle(at, turn, 120.0), at_angle(at, turn, -120.0)];
                vec![across, vec![at_angle(at, way, -3.4), at_angle(at, way, 120.0)]]
            });
            assert!(off[0] < 0.4 && off[2] < 2.6, "{degrees}: {off:?}");
        }
    }

    #[test]
    fn a_sharp_turn_is_trusted_wholly_or_not_at_all() {
        let window = Window { width: 300.0, height: 300.0, margin_px: 45.0, turn_px: 80.0 };
        let places: Vec<PxPoint> = (0..60).map(|i| PxPoint::new(20.0 + 2.0 * f64::from(i), 150.0)).collect();
        // A turn whose first place is 70 px from the border.
        let in_turn: Vec<bool> = (0..60).map(|i| (25..40).contains(&i)).collect();
        let trusted = window.trusted(&places, &in_turn);
        assert_eq!(trusted.iter().position(|trusted| *trusted), Some(13));
        assert_eq!(trusted.iter().skip(13).position(|trusted| !trusted), Some(12));
        assert_eq!(trusted.iter().filter(|trusted| **trusted).count(), 12 + 20);
        // All of it is 80 px and more from the border.
        let in_turn: Vec<bool> = (0..60).map(|i| (30..45).contains(&i)).collect();
        assert_eq!(window.trusted(&places, &in_turn).iter().filter(|trusted| **trusted).count(), 47);
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_line_that_bends_where_another_ends_has_its_corner() {
        // The line itself turns by 14 degrees.
        let off = off(5.0, &|turn, at| {
            let bent = vec![at_angle(at, turn, 120.0), at, at_angle(at, turn + 2.9, 120.0)];
            vec![bent, vec![at, at_angle(at, turn + 1.4, 120.0)]]
        });
        assert!(off[0] < 0.7, "{off:?}");
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn turns_to_the_next_line_are_square_or_round() {
        for pitch_px in [8.0, 10.0, 12.0] {
            let turn = |turn: f64, at: PxPoint, is_round: bool| {
                let beside = turn + core::f64::consts::FRAC_PI_2;
                let (next, middle) = (at_angle(at, beside, pitch_px), at_angle(at, beside, 0.5 * pitch_px));
                let mut line = vec![at_angle(at, turn, 100.0), at];
                // Half around the middle, away from the lines.
                let half = (1..12_u8).map(|k| beside + core::f64::consts::PI * (1.0 - f64::from(k) / 12.0));
                line.extend(half.filter(|_| is_round).map(|angle| at_angle(middle, angle, 0.5 * pitch_px)));
                line.extend([next, at_angle(next, turn, 100.0)]);
                vec![line]
            };
            let square = off(4.0, &|angle, at| turn(angle, at, false));
            let round = off(4.0, &|angle, at| turn(angle, at, true));
            assert!(square[0] < 0.8 && square[2] < 0.8, "{pitch_px}: {square:?}");
            assert!(round[0] < 1.6 && round[1] < 1.0, "{pitch_px}: {round:?}");
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn two_corners_after_each_other_are_where_they_are() {
        for pitch_px in [28.0, 40.0] {
            let off = off(5.0, &|turn, at| {
                let next = at_angle(at, turn + core::f64::consts::FRAC_PI_2, pitch_px);
                vec![vec![at_angle(at, turn, 100.0), at, next, at_angle(next, turn, 100.0)]]
            });
            assert!(off[0] < 0.5 && off[2] < 0.9, "{pitch_px}: {off:?}");
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn thick_rings_cross_without_corners() {
        // They meet at 56 degrees, and their ink is one for 17 px.
        let off = off(8.0, &|turn, at| {
            let ring = |side: f64| -> Vec<PxPoint> {
                let middle = at_angle(at, turn + side * 1.08, 150.0);
                let part =
                    (-25..=25_i8).map(|k| turn + side * 1.08 + core::f64::consts::PI + 0.02 * f64::from(k));
                part.map(|angle| at_angle(middle, angle, 150.0)).collect()
            };
            vec![ring(1.0), ring(-1.0)]
        });
        assert!(off[0] < 0.5, "{off:?}");
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_narrow_curve_of_a_thick_line_has_no_corners() {
        let off = off(10.0, &|turn, at| {
            let arm = |side: f64| {
                at_angle(at_angle(at, turn + side, 24.0), turn + side + 1.571 * side.signum(), 80.0)
            };
            let round = (-12..=12_i8).map(|k| at_angle(at, turn + 0.1 * f64::from(k), 24.0));
            vec![[arm(-1.2)].into_iter().chain(round).chain([arm(1.2)]).collect()]
        });
        assert!(off[0] < 0.8, "{off:?}");
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_line_ends_in_the_middle_of_a_wider_one() {
        for k in 0..12_u8 {
            let (at, turn) = (PxPoint::new(150.3, 149.7), 0.37 + 0.523 * f64::from(k));
            let wall = vec![at_angle(at, turn, 120.0), at_angle(at, turn, -120.0)];
            let line = vec![at, at_angle(at, turn + core::f64::consts::FRAC_PI_2, 120.0)];
            let paper = Paper::drawn(300, 300, &[(wall.clone(), 10.0), (line.clone(), 7.0)]).unwrap();
            let settings = CameraSettings { seed: u64::from(k), ..CameraSettings::default() };
            let window = SimulatedCamera::new(&paper, settings).window(PxPoint::new(150.0, 150.0));
            let pieces = Lines::of(&Flat::of(&window, None, None), 40).pieces;
            let route = Route::of(&[wall, line]);
            let places =
                pieces.iter().flat_map(|piece| &piece.places).filter(|place| place.distance(at) < 60.0);
            let off = places.map(|place| route.nearest(*place, 50.0).map_or(50.0, |found| found.0));
            let off = off.fold(0.0, f64::max);
            assert!(off < 1.0, "{k}: {off}");
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_line_that_ends_before_another_ends_there() {
        for k in 0..12_u8 {
            let (at, turn) = (PxPoint::new(150.3, 149.7), 0.37 + 0.523 * f64::from(k));
            let across = vec![at_angle(at, turn, 120.0), at_angle(at, turn, -120.0)];
            // Their ink is 4 px apart.
            let end = at_angle(at, turn + 1.2, 9.6);
            let line = vec![end, at_angle(end, turn + 1.2, 100.0)];
            let paper = Paper::drawn(300, 300, &[(across, 5.0), (line, 5.0)]).unwrap();
            let settings = CameraSettings { seed: u64::from(k), ..CameraSettings::default() };
            let window = SimulatedCamera::new(&paper, settings).window(PxPoint::new(150.0, 150.0));
            let pieces = Lines::of(&Flat::of(&window, None, None), 40).pieces;
            let middle = at_angle(at, turn + 1.2, 5.0);
            let places = pieces.iter().flat_map(|piece| &piece.places);
            let nearest = places.map(|place| place.distance(middle)).fold(f64::MAX, f64::min);
            assert!(nearest > 2.5, "{k}: {nearest}");
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_narrow_curve_has_no_corners() {
        let off = off(5.0, &|turn, at| {
            vec![(0..40_u8).map(|k| at_angle(at, turn + 0.1 * f64::from(k), 15.0)).collect()]
        });
        assert!(off[0] < 0.7, "{off:?}");
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_curve_goes_on_round_where_a_line_crosses_it() {
        for radius in [25.0, 40.0, 70.0, 110.0] {
            let off = off(4.0, &|turn, at| {
                let middle = at_angle(at, turn, radius);
                let arc = (-30..=30_i8)
                    .map(|k| {
                        at_angle(middle, turn + core::f64::consts::PI * (1.0 + f64::from(k) / 40.0), radius)
                    })
                    .collect();
                vec![arc, vec![at_angle(at, turn, -60.0), at_angle(at, turn, 0.9 * radius)]]
            });
            assert!(off[0] < 0.45 && off[1] < 0.35, "{radius}: {off:?}");
        }
    }

    #[test]
    fn corners_stay_and_the_rest_is_even() {
        let corner = [(0.0, 0.0), (5.0, 0.0), (5.0, 2.0)].map(|(x, y)| PxPoint::new(x, y));
        let places = resampled(&corner, 2.0);
        assert_eq!(places.len(), 5);
        assert_eq!((places[3], places[4]), (corner[1], corner[2]));
        assert!((places[1].x - 5.0 / 3.0).abs() < 1e-9);
    }
}
