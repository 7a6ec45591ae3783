//! Exits: where lines leave a circle.

use super::circle::ring;
use crate::picture::{Bitmap, Pixel};

/// The pixel at an offset, if it is in the picture.
pub(super) fn offset(at: Pixel, (dx, dy): (i32, i32), ink: &Bitmap) -> Option<Pixel> {
    let pixel = Pixel::new(at.x.checked_add_signed(dx)?, at.y.checked_add_signed(dy)?);
    (pixel.x < ink.width() && pixel.y < ink.height()).then_some(pixel)
}

/// The circumference of a circle, none where it leaves the picture.
pub(super) fn circumference(ink: &Bitmap, at: Pixel, radius: i32) -> Option<Vec<(Pixel, bool)>> {
    ring(radius).into_iter().map(|way| offset(at, way, ink).map(|pixel| (pixel, ink.get(pixel)))).collect()
}

/// Flips runs of line or background that are shorter than `min_run`, around a circle.
pub(super) fn low_pass(values: &mut [bool], min_run: usize) {
    let count = values.len();
    let at = |values: &[bool], i: usize| values.get(i % count.max(1)).copied().unwrap_or(false);
    // Begin behind the first run that is long enough.
    let run = |values: &[bool], from: usize| {
        (0..count).take_while(|i| at(values, from + i) == at(values, from)).count()
    };
    let begins = |i: usize| at(values, i) != at(values, i + count.saturating_sub(1));
    let Some(first) = (0..count).find(|i| begins(*i) && run(values, *i) >= min_run) else {
        // All is one run, or none is long enough: then the majority stays.
        let lines = values.iter().filter(|line| **line).count();
        values.fill(2 * lines > count);
        return;
    };
    let mut state = at(values, first);
    let mut i = first;
    while i < first + count {
        let length = run(values, i).max(1).min(first + count - i);
        if length >= min_run {
            state = at(values, i);
        }
        for place in i..i + length {
            if let Some(value) = values.get_mut(place % count) {
                *value = state;
            }
        }
        i += length;
    }
}

/// The middle of each run of line on a circumference, in its order.
pub(super) fn middles(ring: &[Pixel], lines: &[bool]) -> Vec<Pixel> {
    let count = ring.len().min(lines.len());
    let line = |i: usize| lines.get(i % count.max(1)).copied().unwrap_or(false);
    let starts = (0..count).filter(|i| line(*i) && !line(i + count - 1));
    let middle = |start: usize| {
        let length = (0..count).take_while(|i| line(start + i)).count();
        ring.get((start + (length - 1) / 2) % count).copied()
    };
    starts.filter_map(middle).collect()
}

/// The exits of a circle about a place on a line that are *connected* to that place inside the circle: the middles of the runs of
/// line on the circumference that the line's own ink reaches. Lines that only come near do not count.
///
/// The thesis proposes it in section 4.12 (figure 14), by following the line's edge from the place to the circle; its author had
/// no time to build it. Here the ink within the circle is flooded from the place (over four neighbours, so that lines that
/// touch at corners of pixels stay apart), which reaches the same runs. Empty when the place is paper, or the circle
/// leaves the picture.
///
/// ```
/// # use plotter_vector::{Bitmap, Pixel, follow::connected_exits};
/// let corner = "........#\n".repeat(3);
/// let lines = Bitmap::from_picture(&[&corner, ".........\n", "#########\n", &".........\n".repeat(4)].concat())?;
/// let exits = connected_exits(&lines, Pixel::new(4, 4), 4);
/// assert_eq!(exits, [Pixel::new(8, 4), Pixel::new(0, 4)]);
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
#[must_use]
pub fn connected_exits(ink: &Bitmap, at: Pixel, radius_px: u32) -> Vec<Pixel> {
    let radius = i32::try_from(radius_px.min(1 << 14)).unwrap_or(0);
    let around = connected(ink, at, radius).unwrap_or_default();
    let (ring, lines): (Vec<Pixel>, Vec<bool>) = around.into_iter().unzip();
    middles(&ring, &lines)
}

/// The circumference of a circle, where only line that the ink in the circle joins to its middle counts as line; none where
/// the circle leaves the picture.
pub(super) fn connected(ink: &Bitmap, at: Pixel, radius: i32) -> Option<Vec<(Pixel, bool)>> {
    let around = circumference(ink, at, radius)?;
    let side = 2 * radius + 1;
    let limit = (f64::from(radius) + 0.5) * (f64::from(radius) + 0.5);
    let index =
        |(dx, dy): (i32, i32)| usize::try_from((dy + radius) * side + dx + radius).unwrap_or(usize::MAX);
    let cells = usize::try_from(side).unwrap_or(0);
    let mut seen = vec![false; cells * cells];
    let mut open = vec![(0, 0)];
    while let Some((dx, dy)) = open.pop() {
        let inside = f64::from(dx) * f64::from(dx) + f64::from(dy) * f64::from(dy) <= limit;
        let Some(cell) = seen.get_mut(index((dx, dy))).filter(|seen| inside && !**seen) else { continue };
        if !offset(at, (dx, dy), ink).is_some_and(|pixel| ink.get(pixel)) {
            continue;
        }
        *cell = true;
        open.extend([(dx + 1, dy), (dx - 1, dy), (dx, dy + 1), (dx, dy - 1)]);
    }
    let reached = |pixel: &Pixel| {
        let (dx, dy) = (i64::from(pixel.x) - i64::from(at.x), i64::from(pixel.y) - i64::from(at.y));
        let way = (i32::try_from(dx).unwrap_or(0), i32::try_from(dy).unwrap_or(0));
        // A pixel of the ring may be reached from inside over its corner only.
        [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)].iter().any(|(x, y)| {
            let near = (way.0 + x, way.1 + y);
            near.0.abs() <= radius
                && near.1.abs() <= radius
                && seen.get(index(near)).copied().unwrap_or(false)
        })
    };
    Some(around.into_iter().map(|(pixel, line)| (pixel, line && reached(&pixel))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<bool> {
        text.chars().map(|mark| mark == '#').collect()
    }

    #[test]
    fn the_low_pass_of_table_3() {
        // Rows 1 to 22 of the thesis' table 3 with background around them, minimum 4: the lonely line in row 16 goes.
        let mut circle = values("...########....#..####....");
        low_pass(&mut circle, 4);
        assert_eq!(circle, values("...########.......####...."));
    }

    #[test]
    fn runs_go_on_over_the_end_of_the_list() {
        let mut circle = values("##........##");
        low_pass(&mut circle, 4);
        assert_eq!(circle, values("##........##"));
        let ring: Vec<Pixel> = (0..12).map(|x| Pixel::new(x, 0)).collect();
        assert_eq!(middles(&ring, &circle), [Pixel::new(11, 0)]);
    }
}
