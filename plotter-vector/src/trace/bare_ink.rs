//! [`BareInk`]: strokes for the ink that the pen has left bare.
//!
//! ```text
//!   ██████████▄▄▄▄▄▄▄▄                  two lines that run into one: a stroke along the middle of both
//!   ────────╲▀▀▀▀▀▀▀▀▀▀▀▄▄▄▄            leaves their outer edges bare. The pen can cover these from
//!            ╲───────────────           where it just fits into the ink, half its width inside of them:
//!   ────────╱▄▄▄▄▄▄▄▄▄▄▄▀▀▀▀            there a stroke is drawn along the edge, as long as is needed
//!   ██████████▀▀▀▀▀▀▀▀
//! ```
//!
//! The picture is looked at in squares that lie where they lie, so that what is found depends on no band.

use crate::ink::speckle::fill_holes;
use crate::picture::runs::ink_runs;
use crate::report::coverage::{Index, JUMP_PX};
use crate::stroke::Pieces;
use crate::{
    areas::inset_outlines,
    picture::{Bitmap, Pixel},
    raster::OrderedTracking,
    stroke::{Bounded, Curve, PxPoint},
};
use core::ops::Range;

/// Side of the squares, px: some letters fit into it, and its pixels are few enough to be looked at one by
/// one.
const SQUARE_PX: u32 = 128;

/// Pixels of bare ink that are no farther from each other belong together, px.
const TOGETHER_PX: u32 = 2;

/// The pen may go so far beyond the ink where its line is no wider than itself, px: the raster says no more
/// of where the edge is.
const RASTER_PX: f64 = 0.5;

/// Pixels that the raster may add to those that a round pen leaves bare in square corners: four a corner,
/// which are its tip and what a slope's steps leave beside it.
const CORNER_PIXELS: f64 = 8.0;

/// Part of the promise that is left for what simplifying moves the new strokes by, and part that is used for
/// it.
const LEFT_SHARE: f64 = 0.5;

/// Rows of the pen, one inside of the other, that are drawn at most in a place: as wide as a line may be.
const MOST_ROWS: u32 = 8;

/// Parts of the promise by which the pen goes beyond the ink: the less the better.
const BEYOND: [f64; 3] = [0.0, 0.5, 1.0];

/// A line of a pen whose half is a smaller part of that of most lines is a thinner one.
const MUCH_THINNER: f64 = 0.75;

/// Pens as parts of that of the line, where that is too wide.
const THINNER: [f64; 3] = [0.75, 0.5, 0.25];

/// How far from what is drawn ink must be to have been drawn by such a pen, px, and as a part of half the
/// pen's width: nearer it is what runs together between two lines.
const LEAST_PX: f64 = 1.5;
const LEAST_OF_HALF: f64 = 0.5;

/// Ink is hardly worth a stroke that is shorter than its pen is wide if no farther from what is covered than
/// this part of half the pen's width: what sticks out farther a draughtsman sees.
const HAIR_OF_HALF: f64 = 0.75;

/// A way around so many sites is one around a dot.
const DOT_SITES: usize = 12;

/// Widest pen that is drawn with, half of it, px: as wide a context has each square.
const WIDEST_PX: f64 = 48.0;

/// Ink that the strokes of a drawing leave bare.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BareInk<'a> {
    /// The strokes' segments with how far their pens cover.
    pub(crate) drawn: &'a Index,
    /// How far from what they cover ink is covered enough, px.
    pub(crate) within_px: f64,
    pub(crate) pieces: Pieces,
    /// Whether spots get strokes, too.
    pub(crate) spots: bool,
}

impl BareInk<'_> {
    /// Rows above and below its own that a band needs: a square begins in it, and what is beside that decides
    /// where the pen fits.
    pub(crate) const CONTEXT_ROWS: u32 = SQUARE_PX + 104;

    /// Strokes for what is bare of `lines`, which are the ink without its areas, in the squares that begin in
    /// the rows `own`; the ink's first row is row `first_row` of the picture.
    pub(crate) fn strokes(
        &self,
        ink: &Bitmap,
        lines: &Bitmap,
        first_row: u32,
        own: &Range<u32>,
    ) -> Vec<Curve> {
        let mut strokes = Vec::new();
        let first = own.start.next_multiple_of(SQUARE_PX);
        for top in (first..own.end).step_by(SQUARE_PX as usize) {
            let mut squares: Vec<Vec<Pixel>> = vec![Vec::new(); ink.width().div_ceil(SQUARE_PX) as usize];
            let mut covering = 0;
            let rows = top.saturating_sub(first_row)..(top - first_row + SQUARE_PX).min(ink.height());
            for y in rows {
                for run in ink_runs(lines.row(y)) {
                    self.drawn.run_errors(run, y + first_row, &mut covering, |at, error_px| {
                        let square = squares.get_mut((at.x / SQUARE_PX) as usize);
                        if let Some(square) = square.filter(|_| error_px > self.within_px) {
                            square.push(at);
                        }
                    });
                }
            }
            for square in squares {
                let mut found = Vec::new();
                for bare in together(&square) {
                    self.cover(ink, first_row, bare, &mut found);
                }
                self.join(ink, first_row, &mut found);
                found.retain(|stroke| self.spots || !self.is_hair(stroke, &square));
                strokes.append(&mut found);
            }
        }
        strokes
    }

    /// Joins strokes where the pen goes from the end of one to that of another over ink, no farther than it
    /// is wide.
    fn join(&self, ink: &Bitmap, first_row: u32, strokes: &mut Vec<Curve>) {
        let mut one = 0;
        while let Some(stroke) = strokes.get(one) {
            let joined = (one + 1..strokes.len()).find_map(|other| {
                let joint = self.joint(ink, first_row, stroke, strokes.get(other)?)?;
                Some((other, joint))
            });
            let Some((other, [turn_one, turn_other])) = joined else {
                one += 1;
                continue;
            };
            let mut next = strokes.remove(other);
            if turn_other {
                next.reverse();
            }
            if let Some(stroke) = strokes.get_mut(one) {
                if turn_one {
                    stroke.reverse();
                }
                stroke.append(next);
            }
        }
    }

    /// Which of two strokes to turn, that the other begins where the one ends; none if they do not meet.
    fn joint(&self, ink: &Bitmap, first_row: u32, one: &Curve, other: &Curve) -> Option<[bool; 2]> {
        let ends = |curve: &Curve| {
            let ends = [*curve.vertices.first()?, *curve.vertices.last()?];
            (curve.vertices.len() == 1 || ends[0] != ends[1]).then_some(ends)
        };
        let ([a, b], [c, d]) = (ends(one)?, ends(other)?);
        let ways =
            [(b, c, [false, false]), (b, d, [false, true]), (a, c, [true, false]), (a, d, [true, true])];
        let shorter = |x: &(PxPoint, PxPoint, _), y: &(PxPoint, PxPoint, _)| {
            x.0.distance(x.1).total_cmp(&y.0.distance(y.1))
        };
        let (from, to, turns) = ways.into_iter().min_by(shorter)?;
        let far_px = from.distance(to);
        let is_ink = |part: f64| {
            let at = PxPoint::new(from.x + part * (to.x - from.x), from.y + part * (to.y - from.y));
            let at = at - PxPoint::new(0.0, f64::from(first_row));
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a float cast saturates"
            )]
            let pixel = Pixel::new(at.x as u32, at.y as u32);
            at.x >= 0.0 && at.y >= 0.0 && ink.get(pixel)
        };
        // Twice for each pixel of the way: none is left out.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a way within a square")]
        let parts = 2 * (far_px as u32 + 1);
        let meets = far_px <= 2.0 * self.drawn.slack_px(from) + 2.0 * RASTER_PX
            && (0..=parts).all(|part| is_ink(f64::from(part) / f64::from(parts)));
        meets.then_some(turns)
    }

    /// Whether a stroke is shorter than the pen that draws it is wide, and none of these bare pixels near it
    /// lies far from what is covered: lifting the pen costs more than that ink is worth.
    fn is_hair(&self, stroke: &Curve, bare: &[Pixel]) -> bool {
        let half_px = stroke.vertices.first().map_or(0.0, |at| self.drawn.slack_px(*at));
        let is_near = |at: &&Pixel| {
            stroke.vertices.iter().any(|vertex| vertex.distance((**at).into()) <= 2.0 * half_px)
        };
        let covered = |at: &Pixel| self.drawn.error_px((*at).into(), &mut 0) <= HAIR_OF_HALF * half_px;
        stroke.length_px() < 2.0 * half_px && bare.iter().filter(is_near).all(covered)
    }

    /// Whether pixels are a spot that is worth no stroke of its own: farther off than allowed by no more than
    /// the raster leaves open; or as small as what a round pen, so wide, leaves bare in square corners, and
    /// hardly farther; or on the rim of the picture, where a line that goes on beyond it would cover them.
    fn is_spot(&self, bare: &[Pixel], half_px: f64, last: Pixel) -> bool {
        let farthest_px = bare.iter().map(|at| self.drawn.error_px((*at).into(), &mut 0)).fold(0.0, f64::max);
        let corner_px = (core::f64::consts::SQRT_2 - 1.0) * half_px;
        // The two corners of a square end.
        let area_px = 2.0 * (1.0 - core::f64::consts::FRAC_PI_4) * half_px * half_px + CORNER_PIXELS;
        #[expect(clippy::cast_precision_loss, reason = "pixels of a square")]
        let is_small = bare.len() as f64 <= area_px;
        let is_on_rim = |at: &Pixel| at.x == 0 || at.y == 0 || at.x == last.x || at.y == last.y;
        let more_px = if bare.iter().any(is_on_rim) {
            half_px.max(JUMP_PX)
        } else if is_small {
            corner_px.min(RASTER_PX) + JUMP_PX
        } else {
            RASTER_PX
        };
        farthest_px <= self.within_px + more_px
    }

    /// Strokes for pixels that lie together.
    fn cover(&self, ink: &Bitmap, first_row: u32, mut bare: Vec<Pixel>, strokes: &mut Vec<Curve>) {
        let mut halves_px: Vec<f64> = bare.iter().map(|at| self.drawn.slack_px((*at).into())).collect();
        halves_px.sort_unstable_by(f64::total_cmp);
        let half_px = halves_px.get(halves_px.len() / 2).copied().unwrap_or(0.0);
        if !self.spots && self.is_spot(&bare, half_px, last_pixel(ink, first_row)) {
            return;
        }
        let pen_px = self.drawn.pen_half_px;
        let window = Window::around(&bare, half_px.max(pen_px).min(WIDEST_PX), ink, first_row);
        // With the pen of most lines, if that is not the one of the line beside.
        if half_px < MUCH_THINNER * pen_px {
            self.fill(&window, pen_px, &mut bare, strokes);
        }
        if half_px < RASTER_PX {
            self.follow(&bare, strokes);
            return;
        }
        self.fill(&window, half_px, &mut bare, strokes);
        // What is left and is no rest in a corner between lines was drawn by a thinner pen.
        let least_px = LEAST_PX.max(LEAST_OF_HALF * half_px);
        let is_rest =
            |bare: &[Pixel]| !bare.iter().any(|at| self.drawn.error_px((*at).into(), &mut 0) > least_px);
        let rests: Vec<Vec<Pixel>> = together(&bare).into_iter().filter(|bare| !is_rest(bare)).collect();
        for mut bare in rests {
            for share in THINNER {
                let thin_px = share * half_px;
                self.inside(&window, (thin_px - RASTER_PX.min(thin_px), thin_px), &mut bare, strokes);
            }
        }
    }

    /// Draws rows of a pen, one inside of the other; each as far inside of the ink as it fits, then as the
    /// promise allows.
    fn fill(&self, window: &Window, half_px: f64, bare: &mut Vec<Pixel>, strokes: &mut Vec<Curve>) {
        let half_px = half_px.min(WIDEST_PX);
        for row in 0..MOST_ROWS {
            let inner_px = half_px + 2.0 * half_px * f64::from(row);
            let mut found = false;
            for beyond in BEYOND {
                let inset_px = inner_px - RASTER_PX.min(self.within_px) - beyond * self.within_px;
                found |= self.inside(window, (inset_px, half_px), bare, strokes);
            }
            if bare.is_empty() || !found {
                break;
            }
        }
    }

    /// Draws so far inside of the ink, with a pen that covers so far; whether there is a place for it. What
    /// it covers is bare no more.
    fn inside(
        &self,
        window: &Window,
        (inset_px, half_px): (f64, f64),
        bare: &mut Vec<Pixel>,
        strokes: &mut Vec<Curve>,
    ) -> bool {
        let mut found = false;
        if !bare.is_empty() && inset_px > 0.0 {
            let reach_px = half_px + LEFT_SHARE * self.within_px;
            for border in inset_outlines(&window.ink, inset_px) {
                let border: Vec<PxPoint> = border.iter().map(|at| window.in_picture(*at)).collect();
                found = true;
                *bare = self.along(window, &border, core::mem::take(bare), (half_px, reach_px), strokes);
            }
        }
        found
    }

    /// Draws the parts of a border from which a pen covers something, and gives the pixels that it does not.
    fn along(
        &self,
        window: &Window,
        border: &[PxPoint],
        bare: Vec<Pixel>,
        (half_px, reach_px): (f64, f64),
        strokes: &mut Vec<Curve>,
    ) -> Vec<Pixel> {
        let mut needed = vec![Vec::new(); border.len()];
        let mut left = Vec::new();
        for at in bare {
            let squared = |site: &PxPoint| (*site - PxPoint::from(at)).length_squared();
            let nearest = border.iter().enumerate().min_by(|a, b| squared(a.1).total_cmp(&squared(b.1)));
            match nearest.filter(|(_, site)| site.distance(at.into()) <= reach_px) {
                Some((index, _)) => {
                    if let Some(needed) = needed.get_mut(index) {
                        needed.push(at);
                    }
                }
                None => left.push(at),
            }
        }
        for run in runs(&needed, reach_px) {
            let sites: Vec<PxPoint> =
                run.clone().filter_map(|index| border.get(index % border.len())).copied().collect();
            let covers: Vec<Pixel> =
                run.clone().filter_map(|index| needed.get(index % border.len())).flatten().copied().collect();
            if !self.spots && self.is_spot(&covers, half_px, window.last) {
                left.extend(covers);
                continue;
            }
            let closed = run.len() >= border.len().max(DOT_SITES);
            let sites = if closed { &sites[..] } else { shortest(&sites, &covers, reach_px) };
            self.draw(sites, closed, strokes);
        }
        left
    }

    /// Draws lines one pixel wide through their pixels.
    fn follow(&self, bare: &[Pixel], strokes: &mut Vec<Curve>) {
        let (Some(left), Some(top)) = (bare.iter().map(|at| at.x).min(), bare.iter().map(|at| at.y).min())
        else {
            return;
        };
        let Ok(mut lines) = Bitmap::new(SQUARE_PX, SQUARE_PX) else { return };
        bare.iter().for_each(|at| lines.set(Pixel::new(at.x - left, at.y - top), true));
        let Ok(figures) = OrderedTracking::default().track(&lines) else { return };
        for figure in figures.iter() {
            let site = |at: &Pixel| PxPoint::from(Pixel::new(at.x + left, at.y + top));
            let sites: Vec<PxPoint> = figure.iter().map(site).collect();
            self.draw(&sites, false, strokes);
        }
    }

    fn draw(&self, sites: &[PxPoint], closed: bool, strokes: &mut Vec<Curve>) {
        let bounded = Bounded { tolerance_px: LEFT_SHARE * self.within_px };
        let stroke = bounded.stroke(sites, closed, self.pieces);
        if !stroke.vertices.is_empty() {
            strokes.push(stroke);
        }
    }
}

/// The ink around some pixels.
struct Window {
    ink: Bitmap,
    left: u32,
    top: u32,
    /// The last pixel of the picture that is known: its last row is the picture's, if a square reaches it.
    last: Pixel,
}

impl Window {
    fn around(bare: &[Pixel], half_px: f64, ink: &Bitmap, first_row: u32) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 2 * WIDEST_PX")]
        let more = (2.0 * half_px) as u32 + 4;
        let range = |of: fn(&Pixel) -> u32, first: u32, end: u32| {
            let least = bare.iter().map(of).min().unwrap_or(first);
            let most = bare.iter().map(of).max().unwrap_or(first);
            least.saturating_sub(more).max(first)..most.saturating_add(more + 1).min(end)
        };
        let columns = range(|at| at.x, 0, ink.width());
        let rows = range(|at| at.y, first_row, first_row + ink.height());
        let mut window =
            Bitmap::new(columns.end - columns.start, rows.end - rows.start).unwrap_or(Bitmap::empty());
        for (y, row) in (0..).zip(rows.clone()) {
            for (x, column) in (0..).zip(columns.clone()) {
                if ink.get(Pixel::new(column, row - first_row)) {
                    window.set(Pixel::new(x, y), true);
                }
            }
        }
        // Between two lines that nearly run into one the raster leaves holes that no pen goes around.
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most (2 * WIDEST_PX)²"
        )]
        let hole_px = ((2.0 * half_px + 1.0) * (2.0 * half_px + 1.0)) as u32;
        fill_holes(&mut window, hole_px);
        Self { ink: window, left: columns.start, top: rows.start, last: last_pixel(ink, first_row) }
    }

    fn in_picture(&self, at: PxPoint) -> PxPoint {
        PxPoint::new(at.x + f64::from(self.left), at.y + f64::from(self.top))
    }
}

/// The last pixel of ink whose first row is row `first_row` of the picture.
fn last_pixel(ink: &Bitmap, first_row: u32) -> Pixel {
    Pixel::new(ink.width() - 1, first_row + ink.height() - 1)
}

/// Pixels in groups of those that lie near each other.
fn together(pixels: &[Pixel]) -> Vec<Vec<Pixel>> {
    let mut open: std::collections::BTreeSet<(u32, u32)> = pixels.iter().map(|at| (at.y, at.x)).collect();
    let mut groups = Vec::new();
    while let Some((y, x)) = open.pop_first() {
        let mut group = vec![Pixel::new(x, y)];
        let mut next = 0;
        while let Some(at) = group.get(next).copied() {
            next += 1;
            for y in at.y.saturating_sub(TOGETHER_PX)..=at.y.saturating_add(TOGETHER_PX) {
                let columns = (y, at.x.saturating_sub(TOGETHER_PX))..=(y, at.x.saturating_add(TOGETHER_PX));
                let near: Vec<_> = open.range(columns).copied().collect();
                for (y, x) in near {
                    open.remove(&(y, x));
                    group.push(Pixel::new(x, y));
                }
            }
        }
        groups.push(group);
    }
    groups
}

/// The runs of sites, round and round, from the first that is needed to the last, with gaps of up to twice
/// the reach.
fn runs(needed: &[Vec<Pixel>], reach_px: f64) -> Vec<Range<usize>> {
    let count = needed.len();
    let marked: Vec<usize> =
        (0..count).filter(|index| needed.get(*index).is_some_and(|of| !of.is_empty())).collect();
    let Some(first) = marked.first().copied() else { return Vec::new() };
    // Sites are about a pixel apart.
    let is_gap = |from: usize, to: usize| {
        f64::from(u32::try_from(to - from).unwrap_or(u32::MAX)) > 2.0 * reach_px + 2.0
    };
    let next = |at: usize| marked.get(at + 1).copied().unwrap_or(first + count);
    let gaps: Vec<usize> =
        (0..marked.len()).filter(|at| is_gap(marked.get(*at).copied().unwrap_or(first), next(*at))).collect();
    if gaps.is_empty() {
        // All around.
        return core::iter::once(first..first + count).collect();
    }
    let mut found = Vec::new();
    for (nth, gap) in gaps.iter().enumerate() {
        let (from, turn) = match nth.checked_sub(1).and_then(|before| gaps.get(before)) {
            Some(before) => (before + 1, 0),
            // It may begin before the first site, behind the last gap.
            None => gaps
                .last()
                .map_or((0, 0), |last| if last + 1 < marked.len() { (last + 1, count) } else { (0, 0) }),
        };
        if let (Some(from), Some(to)) = (marked.get(from), marked.get(*gap)) {
            found.push(*from..to + turn + 1);
        }
    }
    found
}

/// The part of a way from which all pixels are still covered.
fn shortest<'a>(sites: &'a [PxPoint], covers: &[Pixel], reach_px: f64) -> &'a [PxPoint] {
    let is_covered =
        |sites: &[PxPoint], at: &Pixel| sites.iter().any(|site| site.distance((*at).into()) <= reach_px);
    let mut sites = sites;
    loop {
        let shorter = [sites.get(1..), sites.get(..sites.len().saturating_sub(1))];
        let fits = |some: &&[PxPoint]| !some.is_empty() && covers.iter().all(|at| is_covered(some, at));
        match shorter.into_iter().flatten().find(fits) {
            Some(shorter) => sites = shorter,
            None => return sites,
        }
    }
}
