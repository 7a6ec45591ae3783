//! [`along_lines`]: darkness along the line through each place, for strokes with gaps and grain.

use super::plane::{Plane, rounded, whole};

/// Directions that are tried, in half a turn.
const DIRECTIONS: u8 = 16;

/// A window along a line: its standard deviations along and across, as parts of the lines' width.
const ALONG: f32 = 0.8;
const ACROSS: f32 = 0.2;

/// Across a line a window of twice the width is taken away, with this weight of its own: what smoothing across
/// had widened is narrow again, and lines that lie close stay apart.
const TAKEN: f32 = 1.0;
const WIDER: f32 = 2.0;

/// Where a window ends, in standard deviations.
const REACH: f32 = 2.2;

/// The direction of a line is seen in darkness smoothed so much, a part of the lines' width, and not less than
/// this, px: gaps are bridged, and a line three widths away has no say.
const SEEN: f32 = 0.6;
const LEAST_SEEN_PX: f32 = 0.8;

/// The mean darkness in a long narrow window that lies along the line there: it bridges gaps of the grain, and
/// goes over a line's edge and end no farther than it is narrow.
///
/// The direction is the one in which smoothed darkness is curved least, on a line and beside it. Asked only
/// where something is darker than `least`, or close to it; what is elsewhere is paper.
///
/// Source: lines along the eigenvector of the second derivatives with the smaller eigenvalue, C. Steger, "An
/// unbiased detector of curvilinear structures" (1998), section 3.
pub(super) fn along_lines(darkness: &Plane, width_px: f32, least: f32) -> Plane {
    let windows = windows(width_px);
    // In half the size: it only says where to ask.
    let reach = whole(libm::ceilf(REACH * ALONG * width_px).max(1.0));
    let near = darkness.halved(u16::max).extreme(reach.div_ceil(2), false);
    let seen_px = (SEEN * width_px).max(LEAST_SEEN_PX);
    let soft = darkness.blurred(seen_px);
    let step = isize::try_from(whole(seen_px).max(1)).unwrap_or(1);
    let mut out = Plane::new(darkness.width, darkness.height);
    out.in_rows(|y, row| {
        for (x, out) in row.iter_mut().enumerate() {
            *out = if f32::from(near.near(x / 2, y / 2, 0, 0)) < least {
                darkness.row(y).get(x).copied().unwrap_or(0)
            } else {
                let window = windows.get(direction(&soft, x, y, step)).map_or(&[][..], Vec::as_slice);
                let tap = |(dx, dy, weight): &(isize, isize, f32)| {
                    weight * f32::from(darkness.near(x, y, *dx, *dy))
                };
                rounded(window.iter().map(tap).sum())
            };
        }
    });
    out
}

/// The number of the direction in which a plane is curved least at a place, by differences over `step` px.
fn direction(plane: &Plane, x: usize, y: usize, step: isize) -> usize {
    let at = |dx: isize, dy: isize| f32::from(plane.near(x, y, dx * step, dy * step));
    let own = at(0, 0);
    let xx = at(1, 0) + at(-1, 0) - 2.0 * own;
    let yy = at(0, 1) + at(0, -1) - 2.0 * own;
    let xy = (at(1, 1) + at(-1, -1) - at(1, -1) - at(-1, 1)) / 4.0;
    // The direction of the greater of the two curvatures, with its sign: on a ridge that is along it, and
    // across it in the valley beside.
    let of_greater = 0.5 * libm::atan2f(2.0 * xy, xx - yy);
    let across = if xx + yy > 0.0 { 0.5 } else { 0.0 };
    let turns = (of_greater / core::f32::consts::PI + across + 1.0) * f32::from(DIRECTIONS);
    whole(turns + 0.5) % usize::from(DIRECTIONS)
}

/// The taps of each window, with weights that are 1 together.
fn windows(width_px: f32) -> Vec<Vec<(isize, isize, f32)>> {
    let (along, across) = ((ALONG * width_px).max(0.6), (ACROSS * width_px).max(0.5));
    #[expect(clippy::cast_possible_truncation, reason = "some pixels")]
    let reach = libm::ceilf(REACH * along.max(WIDER * across)) as i16;
    let window = |direction: u8| {
        let (sin, cos) = libm::sincosf(core::f32::consts::PI * f32::from(direction) / f32::from(DIRECTIONS));
        let tap = |x: i16, y: i16| {
            let (x, y) = (f32::from(x), f32::from(y));
            let (u, v) = ((x * cos + y * sin) / along, (y * cos - x * sin) / across);
            let wide = v / WIDER;
            let bell = |of: f32| libm::expf(-0.5 * of * of);
            let profile = (1.0 + TAKEN) * bell(v) - TAKEN / WIDER * bell(wide);
            (u * u + wide * wide < REACH * REACH).then_some(bell(u) * profile)
        };
        let taps: Vec<_> = (-reach..=reach)
            .flat_map(|y| (-reach..=reach).map(move |x| (x, y)))
            .filter_map(|(x, y)| Some((isize::from(x), isize::from(y), tap(x, y)?)))
            .collect();
        let sum: f32 = taps.iter().map(|(_, _, weight)| weight).sum();
        taps.into_iter().map(|(x, y, weight)| (x, y, weight / sum)).collect()
    };
    (0..DIRECTIONS).map(window).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line of `width_px` through the middle of 60 x 60 px, at `turn_rad`, and where it has gaps.
    fn line(turn_rad: f32, width_px: f32, is_gap: impl Fn(f32) -> bool) -> Plane {
        let mut plane = Plane::new(60, 60);
        let (sin, cos) = libm::sincosf(turn_rad);
        for (index, value) in plane.values.iter_mut().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "60 px")]
            let (x, y) = ((index % 60) as f32 - 30.0, (index / 60) as f32 - 30.0);
            let (u, v) = (x * cos + y * sin, y * cos - x * sin);
            *value = if v.abs() < width_px / 2.0 && !is_gap(u) { 40_000 } else { 0 };
        }
        plane
    }

    #[test]
    fn a_line_is_seen_in_its_direction_on_it_and_beside_it() {
        for number in 0..16_u8 {
            let turn_rad = core::f32::consts::PI * f32::from(number) / 16.0;
            let soft = line(turn_rad, 4.0, |_| false).blurred(2.4);
            let (sin, cos) = libm::sincosf(turn_rad);
            for beside_px in [-4.0, 0.0, 4.0] {
                let (x, y) = (whole(30.5 - beside_px * sin), whole(30.5 + beside_px * cos));
                let seen = direction(&soft, x, y, 2);
                let apart = (seen + 16 - usize::from(number)) % 16;
                assert!([0, 1, 15].contains(&apart), "{number} {beside_px}: {seen}");
            }
        }
    }

    #[test]
    fn gaps_are_bridged_and_close_lines_stay_apart() {
        let gaps = along_lines(&line(0.4, 4.0, |u| u.rem_euclid(12.0) < 2.0), 4.0, 1.0);
        let along = |at: f32| (whole(30.5 + at * libm::cosf(0.4)), whole(30.5 + at * libm::sinf(0.4)));
        let darkest = gaps.values.iter().copied().max().unwrap_or(0);
        for at in -15..=15_i8 {
            let (x, y) = along(f32::from(at));
            assert!(gaps.near(x, y, 0, 0) > darkest / 2, "{at}: {} of {darkest}", gaps.near(x, y, 0, 0));
        }
        // Two lines of 4 px with a way of 3 px between them.
        let mut two = Plane::new(60, 60);
        two.in_rows(|y, row| {
            row.fill(if (25..29).contains(&y) || (32..36).contains(&y) { 40_000 } else { 0 })
        });
        let two = along_lines(&two, 4.0, 1.0);
        assert!(two.near(30, 30, 0, 0) < 10_000, "{}", two.near(30, 30, 0, 0));
        assert!(two.near(30, 27, 0, 0) > 30_000);
    }
}
