//! [`despeckle`]: no marks and no holes that a pen cannot have made.
//!
//! Dust, salt and pepper leave marks smaller than the pen's smallest, which is a dot; and holes as small in
//! its lines. Marks hang together over eight neighbours, holes over four, so that a line one pixel wide
//! closes a hole.
//!
//! The runs of a row are joined to those of the row above as long as the mark is small; once it has enough
//! pixels it is only known to be large. A mark of fewer than A pixels spans fewer than A rows, so what
//! becomes of a pixel depends on no row farther than [`context_rows`].

use crate::disjoint_sets::DisjointSets;
use crate::parallel::{each, threads};
use crate::picture::Bitmap;
use crate::picture::runs::{ink_runs, paper_runs, set_run};
use core::ops::Range;

/// What [`despeckle`] changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Despeckled {
    /// Marks that were removed.
    pub removed_marks: u64,
    /// Their ink, px.
    pub removed_px: u64,
    /// Ink of the largest of them, px.
    pub largest_removed_px: u64,
    /// Paper of holes that were filled, px.
    pub filled_px: u64,
}

/// Number of pixels that a mark needs to be one of a pen of this width: half of its dot, π/8·w² rounded up; 0
/// (all marks are the pen's) for a pen of 1 px.
///
/// ```
/// # use plotter_vector::ink::smallest_mark_px;
/// assert_eq!(smallest_mark_px(1), 0);
/// assert_eq!(smallest_mark_px(3), 4); // 3.53
/// assert_eq!(smallest_mark_px(4), 7); // 6.28
/// ```
#[must_use]
pub fn smallest_mark_px(pen_width_px: u32) -> u32 {
    let area = u64::from(pen_width_px).pow(2) * 392_699;
    let marks = u32::try_from(area.div_ceil(1_000_000)).unwrap_or(u32::MAX);
    if marks > 1 { marks } else { 0 }
}

/// How many rows above and below a row decide what [`despeckle`] does in it: a band of a picture with so many
/// rows more on each side comes out the same as in the whole picture.
#[must_use]
pub(crate) const fn context_rows(smallest_px: u32) -> u32 {
    // Once for marks, and once for the holes between those that stay.
    smallest_px.saturating_sub(1).saturating_mul(2)
}

/// Removes marks of fewer than `smallest_px` pixels, then fills holes of fewer; 0 and 1 change nothing. Paper
/// that reaches the border of the picture is no hole.
///
/// ```
/// # use plotter_vector::{Bitmap, ink::despeckle};
/// let mut ink = Bitmap::from_picture("#.......\n...####.\n...#.##.\n...####.\n")?;
/// let changed = despeckle(&mut ink, 4);
/// assert_eq!(ink.to_string(), "........\n...####.\n...####.\n...####.\n");
/// assert_eq!((changed.removed_marks, changed.removed_px, changed.largest_removed_px, changed.filled_px), (1, 1, 1, 1));
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
pub fn despeckle(ink: &mut Bitmap, smallest_px: u32) -> Despeckled {
    if smallest_px < 2 {
        return Despeckled::default();
    }
    all_bands(ink, smallest_px)
}

/// As [`despeckle`], on the thread that calls; only what changed in some of the rows is counted.
pub(crate) fn despeckle_here(ink: &mut Bitmap, smallest_px: u32, counted: Range<u32>) -> Despeckled {
    if smallest_px < 2 {
        return Despeckled::default();
    }
    band(ink, smallest_px, counted)
}

/// Fills holes of fewer pixels, on the thread that calls.
pub(crate) fn fill_holes(ink: &mut Bitmap, smallest_px: u32) {
    let _ = Sweep::new(Colour::Paper, smallest_px, 0..0).over(ink);
}

impl Despeckled {
    /// With what changed in other rows.
    #[must_use]
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            removed_marks: self.removed_marks + other.removed_marks,
            removed_px: self.removed_px + other.removed_px,
            largest_removed_px: self.largest_removed_px.max(other.largest_removed_px),
            filled_px: self.filled_px + other.filled_px,
        }
    }
}

fn all_bands(ink: &mut Bitmap, smallest_px: u32) -> Despeckled {
    let (height, context) = (ink.height(), context_rows(smallest_px));
    let rows_each = context.saturating_mul(8).max(512);
    if height <= rows_each || threads() == 1 {
        return band(ink, smallest_px, 0..height);
    }
    let starts: Vec<u32> = (0..height).step_by(rows_each as usize).collect();
    let bands = each(starts, |start| {
        let rows = start..height.min(start + rows_each);
        let from = rows.start.saturating_sub(context);
        let mut part = ink.band(from..height.min(rows.end.saturating_add(context)));
        let changed = band(&mut part, smallest_px, rows.start - from..rows.end - from);
        (part.band(rows.start - from..rows.end - from), changed)
    });
    let mut all = Despeckled::default();
    let mut rows = ink.rows_mut();
    for (part, changed) in bands {
        for y in 0..part.height() {
            if let Some(row) = rows.next() {
                row.copy_from_slice(part.row(y));
            }
        }
        all = all.and(changed);
    }
    all
}

/// Cleans a picture, and counts what changed in `rows` of it.
fn band(ink: &mut Bitmap, smallest_px: u32, rows: Range<u32>) -> Despeckled {
    let removed = Sweep::new(Colour::Ink, smallest_px, rows.clone()).over(ink);
    let filled = Sweep::new(Colour::Paper, smallest_px, rows).over(ink);
    Despeckled {
        removed_marks: removed.marks,
        removed_px: removed.pixels,
        largest_removed_px: removed.largest_px,
        filled_px: filled.pixels,
    }
}

/// Whose small components are painted over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Colour {
    Ink,
    Paper,
}

/// No stored run.
const NONE: usize = usize::MAX;

/// A component that reaches the row at hand.
#[derive(Clone, Copy, Debug)]
struct Component {
    /// Pixels so far; `u32::MAX` once there are enough.
    pixels: u32,
    /// First and last of its stored runs.
    first: usize,
    last: usize,
}

impl Component {
    const EMPTY: Self = Self { pixels: 0, first: NONE, last: NONE };
}

#[derive(Clone, Copy, Debug)]
struct Stored {
    y: u32,
    start: u32,
    end: u32,
    next: usize,
}

/// What was painted over.
#[derive(Clone, Copy, Debug, Default)]
struct Painted {
    marks: u64,
    pixels: u64,
    /// Pixels of the largest.
    largest_px: u64,
}

#[derive(Debug)]
struct Sweep {
    colour: Colour,
    smallest_px: u32,
    counted: Range<u32>,
    /// Runs of the last row, each with its component.
    above: Vec<(Range<u32>, usize)>,
    row: Vec<(Range<u32>, usize)>,
    /// Those that have met are one: the one with the lowest number stands for all.
    components: Vec<Component>,
    met: DisjointSets,
    /// Those of the next row.
    next: Vec<Component>,
    /// Runs of the components that are still small, linked; `free` links those no longer needed.
    stored: Vec<Stored>,
    free: usize,
    /// Number of each component in the next row.
    renumbered: Vec<usize>,
    painted: Painted,
}

impl Sweep {
    fn new(colour: Colour, smallest_px: u32, counted: Range<u32>) -> Self {
        Self {
            colour,
            smallest_px,
            counted,
            above: Vec::new(),
            row: Vec::new(),
            components: Vec::new(),
            met: DisjointSets::new(0),
            next: Vec::new(),
            stored: Vec::new(),
            free: NONE,
            renumbered: Vec::new(),
            painted: Painted::default(),
        }
    }

    /// Paints over the small components of a picture; says how much that was.
    fn over(mut self, ink: &mut Bitmap) -> Painted {
        let width = ink.width();
        for y in 0..ink.height() {
            let mut row = core::mem::take(&mut self.row);
            row.clear();
            match self.colour {
                Colour::Ink => row.extend(ink_runs(ink.row(y)).map(|run| (run, NONE))),
                Colour::Paper => row.extend(paper_runs(ink.row(y), width).map(|run| (run, NONE))),
            }
            self.join(y, width, &mut row);
            self.close(&row, ink);
            // The component of a run above is that of the new numbers.
            for (_, component) in &mut row {
                *component = self.renumbered.get(*component).copied().unwrap_or(0);
            }
            self.row = core::mem::replace(&mut self.above, row);
        }
        if self.colour == Colour::Ink {
            self.close(&[], ink);
        }
        self.painted
    }

    /// Joins the runs of a row to the components above, or begins new ones.
    fn join(&mut self, y: u32, width: u32, row: &mut [(Range<u32>, usize)]) {
        // Ink touches over corners too.
        let reach = u32::from(self.colour == Colour::Ink);
        let above = core::mem::take(&mut self.above);
        let mut touching = above.as_slice();
        for (run, component) in row {
            // Runs that end left of this one touch no later one either; the last that touches may touch the
            // next.
            while let [(first, _), rest @ ..] = touching {
                if first.end + reach > run.start {
                    break;
                }
                touching = rest;
            }
            let mut here = NONE;
            for (_, other) in touching.iter().take_while(|(other, _)| other.start < run.end + reach) {
                let other = self.met.root(*other);
                here = if here == NONE { other } else { self.meet(here, other) };
            }
            if here == NONE {
                here = self.met.push();
                self.components.push(Component::EMPTY);
            }
            let outside = self.colour == Colour::Paper && (y == 0 || run.start == 0 || run.end == width);
            self.add(here, y, run, outside);
            *component = here;
        }
        self.above = above;
    }

    /// Paints over the small components that do not reach `row`, and numbers the others anew.
    fn close(&mut self, row: &[(Range<u32>, usize)], ink: &mut Bitmap) {
        self.renumbered.clear();
        self.renumbered.resize(self.components.len(), NONE);
        let mut kept = 0;
        for (_, component) in row {
            let root = self.met.root(*component);
            if let Some(number) = self.renumbered.get_mut(root)
                && *number == NONE
            {
                *number = kept;
                kept += 1;
            }
        }
        self.next.clear();
        self.next.resize(kept, Component::EMPTY);
        for i in 0..self.components.len() {
            let Some(component) = self.components.get(i).copied() else { break };
            let root = self.met.root(i);
            if root != i {
                self.renumbered[i] = self.renumbered.get(root).copied().unwrap_or(NONE);
            } else if let Some(next) = self.renumbered.get(i).and_then(|number| self.next.get_mut(*number)) {
                *next = component;
            } else if component.pixels < self.smallest_px {
                self.paint(component, ink);
            }
        }
        core::mem::swap(&mut self.components, &mut self.next);
        self.met.begin_again(kept);
    }

    fn paint(&mut self, component: Component, ink: &mut Bitmap) {
        let mut at = component.first;
        let mut top = u32::MAX;
        while let Some(&Stored { y, start, end, next }) = self.stored.get(at) {
            set_run(ink.row_mut(y), start..end, self.colour == Colour::Paper);
            if self.counted.contains(&y) {
                self.painted.pixels += u64::from(end - start);
            }
            top = top.min(y);
            at = next;
        }
        // Of a component in several bands that one tells in which it begins.
        if self.counted.contains(&top) {
            self.painted.marks += 1;
            self.painted.largest_px = self.painted.largest_px.max(component.pixels.into());
        }
        self.release(component);
    }

    /// Makes one of two components that have met; the number of both.
    fn meet(&mut self, a: usize, b: usize) -> usize {
        let (into, from) = (a.min(b), a.max(b));
        let (Some(&one), Some(&other)) = (self.components.get(into), self.components.get(from)) else {
            return into;
        };
        if into == from {
            return into;
        }
        let mut both = one;
        both.pixels = one.pixels.saturating_add(other.pixels);
        if let Some(last) = self.stored.get_mut(one.last) {
            last.next = other.first;
        } else {
            both.first = other.first;
        }
        if other.last != NONE {
            both.last = other.last;
        }
        self.met.join(from, into);
        self.components[into] = self.settled(both);
        into
    }

    fn add(&mut self, component: usize, y: u32, run: &Range<u32>, outside: bool) {
        let Some(mut here) = self.components.get(component).copied() else {
            return;
        };
        if here.pixels == u32::MAX {
            return;
        }
        let run_px = run.end - run.start;
        here.pixels = if outside { u32::MAX } else { here.pixels.saturating_add(run_px) };
        if here.pixels < self.smallest_px {
            let stored = Stored { y, start: run.start, end: run.end, next: NONE };
            let at = if let Some(free) = self.stored.get_mut(self.free) {
                let at = self.free;
                self.free = free.next;
                *free = stored;
                at
            } else {
                self.stored.push(stored);
                self.stored.len() - 1
            };
            match self.stored.get_mut(here.last) {
                Some(last) => last.next = at,
                None => here.first = at,
            }
            here.last = at;
        }
        self.components[component] = self.settled(here);
    }

    /// A component that has enough pixels needs its runs no more.
    fn settled(&mut self, component: Component) -> Component {
        if component.pixels < self.smallest_px {
            return component;
        }
        self.release(component);
        Component { pixels: u32::MAX, ..Component::EMPTY }
    }

    fn release(&mut self, component: Component) {
        if let Some(last) = self.stored.get_mut(component.last) {
            last.next = self.free;
            self.free = component.first;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(picture: &str, smallest_px: u32) -> String {
        let mut ink = Bitmap::from_picture(picture).unwrap();
        despeckle(&mut ink, smallest_px);
        ink.to_string()
    }

    #[test]
    fn a_mark_is_removed_whole_or_not_at_all() {
        let hook = "......\n.#..#.\n.#..#.\n..##..\n......\n";
        assert_eq!(after(hook, 6), hook);
        assert_eq!(after(hook, 7), "......\n".repeat(5));
    }

    #[test]
    fn marks_hang_together_over_corners_and_holes_do_not() {
        let diagonal = "#..\n.#.\n..#\n";
        assert_eq!(after(diagonal, 3), diagonal);
        let two_holes = ".###.\n.#.##\n.##.#\n..###\n";
        assert_eq!(after(two_holes, 2), ".###.\n.####\n.####\n..###\n");
    }

    #[test]
    fn paper_at_the_border_is_no_hole() {
        let open = "###\n..#\n###\n###\n#.#\n";
        assert_eq!(after(open, 4), open);
    }

    #[test]
    fn dots_of_the_pen_stay() {
        for (dot, pen_px) in
            [("###\n###\n###\n", 3), (".#.\n###\n.#.\n", 3), (".##.\n####\n####\n.##.\n", 4), ("#\n", 1)]
        {
            assert_eq!(after(dot, smallest_mark_px(pen_px)), dot);
        }
    }

    #[test]
    fn a_mark_in_a_hole_goes_before_the_hole_is_measured() {
        let ring = "#####\n#...#\n#.#.#\n#...#\n#####\n";
        assert_eq!(after(ring, 9), ring.replace("#.#.#", "#...#"));
        assert_eq!(after(ring, 10), "#####\n".repeat(5));
    }

    #[test]
    fn a_component_that_splits_and_meets_again_is_one() {
        let comb = "#.#.#.#\n#.#.#.#\n#######\n";
        assert_eq!(after(comb, 15), comb);
        assert_eq!(after(comb, 16), ".......\n".repeat(3));
        let fork = "#######\n#.#.#.#\n#.#.#.#\n";
        assert_eq!((after(fork, 15), after(fork, 16)), (fork.to_owned(), ".......\n".repeat(3)));
    }

    #[test]
    fn bands_for_threads_give_the_whole() {
        let mut whole = Bitmap::new(200, 1300).unwrap();
        let mut random = 1_u64;
        for row in whole.rows_mut() {
            for (word, mask) in row.iter_mut().zip([u64::MAX, u64::MAX, u64::MAX, 0xff]) {
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                *word = random & random.rotate_left(23) & mask;
            }
        }
        let mut bands = whole.clone();
        let changed = all_bands(&mut bands, 12);
        assert_eq!(band(&mut whole, 12, 0..1300), changed);
        assert!(changed.removed_px > 0 && changed.filled_px > 0);
        assert!(bands == whole, "the bands differ");
    }
}
