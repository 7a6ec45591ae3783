//! [`Hatch`]: areas filled with parallel lines, joined to long zigzag strokes.
//!
//! ```text
//!    ┌──────────┐   The path of the pen's centre along the border is cut by equally spaced lines; between an odd
//!    │  ┌────┐  │   and the next even crossing a line lies inside (even-odd rule), and the pieces of the border
//!    └┐ └────┘ ┌┘   between neighbouring lines lead from one line to the next without leaving the area.
//! ```

use crate::stroke::PxPoint;

/// How an area is hatched. The lines' distance from the picture's corner is the same in all areas, so that
/// bands and neighbours fit together.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct Hatch {
    /// From line to line, px; at least [`MIN_PITCH_PX`]. Up to the pen's width the ink closes, and the whole
    /// area is covered.
    pub pitch_px: f64,
    /// Direction of the lines: 0 is along x, and positive angles turn counter-clockwise as seen on the sheet.
    pub angle_rad: f64,
    /// Whether a second set of lines crosses the first at a right angle.
    pub cross: bool,
    /// Longest way along the area's border from one line to the next with the pen down, px; 0 lifts it after
    /// every line.
    pub max_join_px: f64,
}

impl Hatch {
    /// The same with another [`Hatch::pitch_px`].
    #[must_use]
    pub const fn with_pitch_px(self, pitch_px: f64) -> Self {
        Self { pitch_px, ..self }
    }

    /// The same with another [`Hatch::angle_rad`].
    #[must_use]
    pub const fn with_angle_rad(self, angle_rad: f64) -> Self {
        Self { angle_rad, ..self }
    }

    /// The same with another [`Hatch::cross`].
    #[must_use]
    pub const fn with_cross(self, cross: bool) -> Self {
        Self { cross, ..self }
    }

    /// The same with another [`Hatch::max_join_px`].
    #[must_use]
    pub const fn with_max_join_px(self, max_join_px: f64) -> Self {
        Self { max_join_px, ..self }
    }
}

/// Least distance of hatching lines, px: closer ones are finer than the picture.
pub const MIN_PITCH_PX: f64 = 0.5;

impl Default for Hatch {
    /// Lines 8 px apart at 45°, 0.34 mm at 600 dots per inch: the width of a fine pen, so that areas are
    /// covered. Joins of up to 100 px, which are drawn sooner than a pen goes up and down.
    fn default() -> Self {
        Self { pitch_px: 8.0, angle_rad: core::f64::consts::FRAC_PI_4, cross: false, max_join_px: 100.0 }
    }
}

/// Slack of the test for coverage, px: half of what the raster itself rounds away.
const COVER_SLACK_PX: f64 = 0.25;

/// A stroke of the hatching.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HatchStroke {
    pub(super) sites: Vec<PxPoint>,
    pub(super) closed: bool,
}

/// Where a line crosses the border.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// Number of the line.
    line: i64,
    /// Place along the line, px.
    along: f64,
    /// Neighbours along the border's path: crossings, and this one's own piece of border, which leads to the
    /// next.
    previous: usize,
    next: usize,
    /// Sites of the border up to the next crossing.
    first_site: usize,
    end_site: usize,
}

impl Hatch {
    /// Strokes that fill the space inside the borders, closed paths of the pen's centre, by the even-odd
    /// rule.
    ///
    /// With a pitch up to the pen's width the pieces of border that no line comes near to are drawn as well.
    pub(super) fn strokes(&self, borders: &[Vec<PxPoint>], pen_px: f64) -> Vec<HatchStroke> {
        let right_angle = core::f64::consts::FRAC_PI_2;
        let angles = [Some(self.angle_rad), self.cross.then_some(self.angle_rad + right_angle)];
        let sets = angles.into_iter().flatten().map(|angle_rad| {
            let axes = Axes { sin: libm::sin(angle_rad), cos: libm::cos(angle_rad), pitch_px: self.pitch_px };
            HatchLines::new(axes, borders).strokes(self, pen_px)
        });
        sets.flatten().collect()
    }
}

/// The picture turned so that the lines run along the first axis: line k lies at (k + ½) · pitch on the
/// second.
#[derive(Clone, Copy, Debug)]
struct Axes {
    sin: f64,
    cos: f64,
    pitch_px: f64,
}

impl Axes {
    fn turn(self, at: PxPoint) -> (f64, f64) {
        (at.x * self.cos - at.y * self.sin, at.x * self.sin + at.y * self.cos)
    }

    fn back(self, along: f64, across: f64) -> PxPoint {
        PxPoint::new(along * self.cos + across * self.sin, across * self.cos - along * self.sin)
    }

    #[expect(clippy::cast_precision_loss, reason = "a line's number is far below 2^53")]
    fn across(self, line: i64) -> f64 {
        (line as f64 + 0.5) * self.pitch_px
    }

    /// The first line at or beyond this place. A segment crosses the lines from its lower end's to before its
    /// upper end's: every vertex is on one side of every line, so closed paths cross each line an even number
    /// of times.
    #[expect(clippy::cast_possible_truncation, reason = "places on a picture, a few 10^4 px; `as` saturates")]
    fn line_from(self, across: f64) -> i64 {
        libm::ceil(across / self.pitch_px - 0.5) as i64
    }
}

/// All crossings of one set of lines with the borders.
struct HatchLines<'a> {
    axes: Axes,
    borders: &'a [Vec<PxPoint>],
    crossings: Vec<Crossing>,
    /// The crossings line by line, along each; the odd and the next even one are the ends of a line inside.
    sorted: Vec<usize>,
    /// Place of each crossing in `sorted`.
    ranks: Vec<usize>,
    /// For each crossing which border it is on.
    border_of: Vec<usize>,
    /// Borders that no line crosses.
    uncrossed: Vec<usize>,
}

impl<'a> HatchLines<'a> {
    fn new(axes: Axes, borders: &'a [Vec<PxPoint>]) -> Self {
        let mut crossings = Vec::new();
        let mut border_of = Vec::new();
        let mut uncrossed = Vec::new();
        for (border, sites) in borders.iter().enumerate() {
            let first = crossings.len();
            Self::cross(axes, sites, &mut crossings);
            border_of.resize(crossings.len(), border);
            if crossings.len() == first {
                uncrossed.push(border);
            }
        }
        let mut sorted: Vec<usize> = (0..crossings.len()).collect();
        sorted.sort_unstable_by(|a, b| {
            let key = |index: usize| crossings.get(index).map_or((0, 0.0), |c: &Crossing| (c.line, c.along));
            let (a_key, b_key) = (key(*a), key(*b));
            a_key.0.cmp(&b_key.0).then(a_key.1.total_cmp(&b_key.1)).then(a.cmp(b))
        });
        let mut ranks = vec![0; sorted.len()];
        for (rank, index) in sorted.iter().enumerate() {
            if let Some(slot) = ranks.get_mut(*index) {
                *slot = rank;
            }
        }
        Self { axes, borders, crossings, sorted, ranks, border_of, uncrossed }
    }

    /// Adds the crossings of one border in their order along it.
    fn cross(axes: Axes, sites: &[PxPoint], crossings: &mut Vec<Crossing>) {
        let first = crossings.len();
        let next_sites = sites.iter().skip(1).chain(sites.first());
        for (index, (from, to)) in sites.iter().zip(next_sites).enumerate() {
            let (from, to) = (axes.turn(*from), axes.turn(*to));
            let (start, end) = (axes.line_from(from.1), axes.line_from(to.1));
            let mut add = |line: i64| {
                let share = ((axes.across(line) - from.1) / (to.1 - from.1)).clamp(0.0, 1.0);
                let along = from.0 + share * (to.0 - from.0);
                let here = crossings.len();
                // The piece of border begins at the end of this edge; where it ends the next crossing says.
                let piece = (index + 1, index + 1);
                let [previous, next] = [here.wrapping_sub(1), here + 1];
                crossings.push(Crossing {
                    line,
                    along,
                    previous,
                    next,
                    first_site: piece.0,
                    end_site: piece.1,
                });
            };
            if start < end {
                (start..end).for_each(&mut add);
            } else {
                (end..start).rev().for_each(&mut add);
            }
        }
        let own = crossings.get_mut(first..).unwrap_or(&mut []);
        let ends: Vec<usize> = own.iter().map(|crossing| crossing.first_site).collect();
        let Some(first_end) = ends.first() else { return };
        // The last piece goes on through the path's first sites.
        let wrapped = first_end + sites.len();
        for (crossing, end) in own.iter_mut().zip(ends.iter().skip(1).chain([&wrapped])) {
            crossing.end_site = *end;
        }
        let last = first + own.len() - 1;
        own.iter_mut().take(1).for_each(|crossing| crossing.previous = last);
        own.iter_mut().rev().take(1).for_each(|crossing| crossing.next = first);
    }

    fn crossing(&self, index: usize) -> Option<&Crossing> {
        self.crossings.get(index)
    }

    fn place(&self, index: usize) -> PxPoint {
        let place = |crossing: &Crossing| self.axes.back(crossing.along, self.axes.across(crossing.line));
        self.crossing(index).map_or_else(PxPoint::default, place)
    }

    /// The other end of the line inside the area.
    fn partner(&self, index: usize) -> usize {
        let rank = self.ranks.get(index).copied().unwrap_or(0);
        self.sorted.get(rank ^ 1).copied().unwrap_or(index)
    }

    /// The border from a crossing to the next, with both.
    fn piece(&self, index: usize) -> impl Iterator<Item = PxPoint> + Clone + '_ {
        let sites = self.border_of.get(index).and_then(|border| self.borders.get(*border));
        let sites = sites.map_or(&[] as &[PxPoint], Vec::as_slice);
        let range = self.crossing(index).map_or(0..0, |crossing| crossing.first_site..crossing.end_site);
        let between = range.filter_map(|site| sites.get(site % sites.len().max(1)).copied());
        let next = self.crossing(index).map(|crossing| self.place(crossing.next));
        core::iter::once(self.place(index)).chain(between).chain(next)
    }

    /// Whether the piece of border after a crossing leads to a neighbouring line, and is no longer than
    /// allowed.
    fn joins(&self, index: usize, max_join_px: f64) -> bool {
        let lines = self.crossing(index).and_then(|from| Some((from.line, self.crossing(from.next)?.line)));
        if lines.is_none_or(|(from, to)| from.abs_diff(to) != 1) {
            return false;
        }
        let mut length = 0.0;
        self.piece(index).zip(self.piece(index).skip(1)).all(|(from, to)| {
            length += from.distance(to);
            length <= max_join_px
        })
    }

    /// All strokes: first the joined lines in the order of their first ones, then what they leave open of the
    /// border.
    fn strokes(&self, hatch: &Hatch, pen_px: f64) -> Vec<HatchStroke> {
        let mut drawing = Zigzag {
            lines: self,
            max_join_px: hatch.max_join_px,
            is_drawn: vec![false; self.sorted.len() / 2],
            is_piece_drawn: vec![false; self.crossings.len()],
        };
        let mut strokes = Vec::new();
        for pair in 0..self.sorted.len() / 2 {
            strokes.extend(drawing.stroke(pair).map(|sites| HatchStroke { sites, closed: false }));
        }
        if hatch.pitch_px <= pen_px {
            let is_open = |at: PxPoint| !self.covers(at, pen_px / 2.0 + COVER_SLACK_PX);
            for (index, is_drawn) in drawing.is_piece_drawn.iter().enumerate() {
                if !is_drawn && self.piece(index).any(is_open) {
                    strokes.push(HatchStroke { sites: self.piece(index).collect(), closed: false });
                }
            }
            for sites in self.uncrossed.iter().filter_map(|border| self.borders.get(*border)) {
                if sites.iter().copied().any(is_open) {
                    strokes.push(HatchStroke { sites: sites.clone(), closed: true });
                }
            }
        }
        strokes
    }

    /// Whether a line next to this place comes within `reach_px` of it.
    fn covers(&self, at: PxPoint, reach_px: f64) -> bool {
        let (along, across) = self.axes.turn(at);
        let above = self.axes.line_from(across);
        [above, above - 1].into_iter().any(|line| {
            let distance_across = self.axes.across(line) - across;
            // The last line inside that begins at or before this place, and the next one.
            let is_before = |index: &usize| {
                let place = self.crossing(*index).map(|crossing| (crossing.line, crossing.along));
                place.is_some_and(|(other, start)| other < line || other == line && start <= along)
            };
            let rank = self.sorted.partition_point(is_before) & !1;
            [rank.checked_sub(2), Some(rank)].into_iter().flatten().any(|rank| {
                let end = |rank: usize| self.sorted.get(rank).and_then(|index| self.crossing(*index));
                let (Some(start), Some(end)) = (end(rank), end(rank + 1)) else { return false };
                let distance_along = (start.along - along).max(along - end.along).max(0.0);
                start.line == line && libm::hypot(distance_along, distance_across) <= reach_px
            })
        })
    }
}

/// The lines while they are joined to strokes.
struct Zigzag<'a> {
    lines: &'a HatchLines<'a>,
    max_join_px: f64,
    /// By pair of crossings in sorted order.
    is_drawn: Vec<bool>,
    is_piece_drawn: Vec<bool>,
}

impl Zigzag<'_> {
    /// The stroke through a line, both ways as far as it goes; nothing when the line is drawn already.
    fn stroke(&mut self, pair: usize) -> Option<Vec<PxPoint>> {
        if self.is_drawn.get(pair) != Some(&false) {
            return None;
        }
        let start = *self.lines.sorted.get(2 * pair)?;
        self.mark(start);
        let mut sites = vec![self.lines.place(start)];
        self.extend(self.lines.partner(start), &mut sites);
        sites.reverse();
        // From the line's first end the stroke may go on as well: there it stands now at its last site.
        sites.pop();
        self.extend(start, &mut sites);
        Some(sites)
    }

    /// Goes to a crossing, and from there along pieces of border and lines not yet drawn.
    fn extend(&mut self, from: usize, sites: &mut Vec<PxPoint>) {
        let mut at = from;
        sites.push(self.lines.place(at));
        while let Some((piece, is_forward, to)) = self.join(at) {
            if let Some(drawn) = self.is_piece_drawn.get_mut(piece) {
                *drawn = true;
            }
            let first = sites.len();
            sites.extend(self.lines.piece(piece));
            if !is_forward {
                sites.get_mut(first..).unwrap_or(&mut []).reverse();
            }
            // The piece begins where the stroke stands.
            sites.remove(first);
            self.mark(to);
            at = self.lines.partner(to);
            sites.push(self.lines.place(at));
        }
    }

    /// The piece of border to take, whether along its own direction, and where it leads: to a line not yet
    /// drawn, rather to a later than to an earlier one.
    fn join(&self, at: usize) -> Option<(usize, bool, usize)> {
        let crossing = self.lines.crossing(at)?;
        let ways = [(at, true, crossing.next), (crossing.previous, false, crossing.previous)];
        let open = ways.into_iter().filter(|(piece, _, to)| {
            let rank = self.lines.ranks.get(*to).copied().unwrap_or(0);
            self.is_drawn.get(rank / 2) == Some(&false) && self.lines.joins(*piece, self.max_join_px)
        });
        open.max_by_key(|(_, is_forward, to)| (self.lines.crossing(*to).map(|to| to.line), *is_forward))
    }

    fn mark(&mut self, crossing: usize) {
        let rank = self.lines.ranks.get(crossing).copied().unwrap_or(0);
        if let Some(drawn) = self.is_drawn.get_mut(rank / 2) {
            *drawn = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(left: f64, top: f64, side: f64) -> Vec<PxPoint> {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(|(x, y)| PxPoint::new(left + x * side, top + y * side))
            .to_vec()
    }

    fn places(stroke: &HatchStroke) -> Vec<(f64, f64)> {
        stroke.sites.iter().map(|at| (at.x, at.y)).collect()
    }

    const LEVEL: Hatch = Hatch { pitch_px: 4.0, angle_rad: 0.0, cross: false, max_join_px: 10.0 };

    #[test]
    fn a_square_is_one_zigzag() {
        // Lines at 2, 6, 10 px.
        let strokes = LEVEL.strokes(&[square(1.0, 1.0, 10.0)], 1.0);
        let zigzag = [(1.0, 2.0), (11.0, 2.0), (11.0, 6.0), (1.0, 6.0), (1.0, 10.0), (11.0, 10.0)];
        assert_eq!(strokes.len(), 1);
        let mut found = strokes.first().map(places).unwrap();
        if found.first() != zigzag.first() {
            found.reverse();
        }
        assert_eq!(found, zigzag);
    }

    #[test]
    fn lines_stop_at_a_hole_and_lift_where_a_join_is_too_long() {
        let borders = [square(0.0, 0.0, 12.0), square(4.0, 4.0, 4.0).into_iter().rev().collect()];
        let hatch = Hatch { max_join_px: 0.0, ..LEVEL };
        let strokes: Vec<_> = hatch.strokes(&borders, 1.0).iter().map(places).collect();
        let lengths: Vec<_> = strokes.iter().map(|s| (s[0].1, (s[1].0 - s[0].0).abs())).collect();
        assert_eq!(lengths, [(2.0, 12.0), (6.0, 4.0), (6.0, 4.0), (10.0, 12.0)]);
    }

    #[test]
    fn a_vertex_on_a_line_crosses_it_once_or_not_at_all() {
        // A diamond with both side corners on the line at 6 px, tips on the lines at 2 and 10.
        let diamond = [(6.0, 2.0), (10.0, 6.0), (6.0, 10.0), (2.0, 6.0)].map(|(x, y)| PxPoint::new(x, y));
        let strokes = LEVEL.strokes(&[diamond.to_vec()], 1.0);
        let sites: Vec<_> = strokes.iter().flat_map(places).collect();
        assert!(sites.contains(&(2.0, 6.0)) && sites.contains(&(10.0, 6.0)));
        assert!(sites.iter().all(|(_, y)| *y >= 2.0 && *y <= 10.0));
    }

    #[test]
    fn what_lies_between_two_lines_is_drawn_by_its_border_when_the_area_is_to_be_covered() {
        let between = [square(20.0, 2.9, 2.2)];
        assert_eq!(LEVEL.strokes(&between, 1.0), []);
        assert_eq!(LEVEL.strokes(&between, 4.0).iter().map(|s| s.closed).collect::<Vec<_>>(), [true]);
    }

    #[test]
    fn crossed_lines_stand_at_a_right_angle() {
        let hatch = Hatch { cross: true, pitch_px: 10.0, ..LEVEL };
        let strokes = hatch.strokes(&[square(0.0, 0.0, 10.0)], 1.0);
        let [across, down] = strokes.try_into().unwrap();
        let turned = |s: &HatchStroke| (s.sites[1].x - s.sites[0].x, s.sites[1].y - s.sites[0].y);
        assert!(turned(&across).1.abs() < 1e-9 && turned(&down).0.abs() < 1e-9);
    }
}
