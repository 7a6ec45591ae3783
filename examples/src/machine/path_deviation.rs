//! [`PathDeviation`]: how far the places of a pen are from the strokes that it should draw, and they from it.

use plotter_motion::{Point, Segment};
use std::collections::{HashMap, VecDeque};

/// Strokes of fewer segments are searched without a grid.
const FEW: usize = 16;

/// Most segments of a stroke that are held: when there are more, the older half has long been passed.
const MOST: usize = 1 << 16;

type Cell = (i64, i64);

/// Compares strokes with the places that were stepped for them, while both come in. The strokes must be ahead
/// of the steps.
#[derive(Clone, Debug)]
pub struct PathDeviation {
    cell_mm: f64,
    /// The stroke that steps are compared with, and those after it; the last may be still growing.
    strokes: VecDeque<Stroke>,
    is_open: bool,
    from_path_mm: f64,
    from_steps_mm: f64,
}

#[derive(Clone, Debug, Default)]
struct Stroke {
    segments: Vec<Segment>,
    /// For the end of each segment, the nearest that a step has come.
    nearest_mm: Vec<f64>,
    /// Segments by cell; only those up to `sorted`.
    cells: HashMap<Cell, Vec<u32>>,
    sorted: usize,
}

impl PathDeviation {
    /// Looks for distances up to `reach_mm`; what is farther is measured too, slowly.
    #[must_use]
    pub fn new(reach_mm: f64) -> Self {
        Self {
            cell_mm: reach_mm.max(0.25),
            strokes: VecDeque::new(),
            is_open: false,
            from_path_mm: 0.0,
            from_steps_mm: 0.0,
        }
    }

    /// The path draws a line.
    pub fn draw(&mut self, from: Point, to: Point) {
        if !self.is_open {
            self.is_open = true;
            self.strokes.push_back(Stroke::default());
            self.add(Segment::new(from, from));
        }
        if from != to {
            self.add(Segment::new(from, to));
        }
    }

    /// The path lifts the pen.
    pub fn lift(&mut self) {
        self.is_open = false;
    }

    /// The pen is at a place, while it draws.
    pub fn step(&mut self, place: Point) {
        let Some(stroke) = self.strokes.front_mut() else { return };
        self.from_path_mm = self.from_path_mm.max(stroke.distance(place, self.cell_mm));
    }

    /// The pen has been lifted: the stroke is done.
    pub fn lifted(&mut self) {
        if let Some(stroke) = self.strokes.pop_front() {
            self.from_steps_mm = self.from_steps_mm.max(stroke.farthest_mm(stroke.segments.len()));
        }
        self.is_open &= !self.strokes.is_empty();
    }

    /// Farthest of a step from the path, and of a vertex of the path from the steps, mm; without the strokes
    /// in progress.
    #[must_use]
    pub fn most_mm(&self) -> (f64, f64) {
        (self.from_path_mm, self.from_steps_mm)
    }

    fn add(&mut self, segment: Segment) {
        let Some(stroke) = self.strokes.back_mut() else { return };
        if stroke.segments.len() >= MOST {
            self.from_steps_mm = self.from_steps_mm.max(stroke.farthest_mm(MOST / 2));
            stroke.segments.drain(..MOST / 2);
            stroke.nearest_mm.drain(..MOST / 2);
            stroke.cells.clear();
            stroke.sorted = 0;
        }
        stroke.segments.push(segment);
        stroke.nearest_mm.push(f64::INFINITY);
    }
}

impl Stroke {
    fn farthest_mm(&self, count: usize) -> f64 {
        self.nearest_mm.iter().take(count).copied().fold(0.0, f64::max)
    }

    fn distance(&mut self, place: Point, cell_mm: f64) -> f64 {
        if self.segments.len() > FEW {
            self.sort(cell_mm);
            if let Some(list) = self.cells.get(&cell(cell_mm, place)) {
                let mut least_mm = f64::INFINITY;
                for &index in list {
                    least_mm =
                        least_mm.min(near(&self.segments, &mut self.nearest_mm, index as usize, place));
                }
                if least_mm <= cell_mm {
                    return least_mm;
                }
            }
        }
        let mut least_mm = f64::INFINITY;
        for index in 0..self.segments.len() {
            least_mm = least_mm.min(near(&self.segments, &mut self.nearest_mm, index, place));
        }
        least_mm
    }

    /// Puts the segments that have come into the cells that they pass, and those about them.
    fn sort(&mut self, cell_mm: f64) {
        for (index, segment) in self.segments.iter().enumerate().skip(self.sorted) {
            let Ok(index) = u32::try_from(index) else { continue };
            let mut before = None;
            let length_mm = segment.length();
            let mut along_mm = 0.0;
            loop {
                let share = if length_mm > 0.0 { (along_mm / length_mm).min(1.0) } else { 1.0 };
                let (x, y) = cell(cell_mm, segment.from.lerp(segment.to, share));
                if before != Some((x, y)) {
                    before = Some((x, y));
                    for cell in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy))) {
                        let list = self.cells.entry(cell).or_default();
                        if list.last() != Some(&index) {
                            list.push(index);
                        }
                    }
                }
                if share >= 1.0 {
                    break;
                }
                along_mm += 0.5 * cell_mm;
            }
        }
        self.sorted = self.segments.len();
    }
}

fn near(segments: &[Segment], nearest_mm: &mut [f64], index: usize, place: Point) -> f64 {
    let (Some(segment), Some(nearest)) = (segments.get(index), nearest_mm.get_mut(index)) else {
        return f64::INFINITY;
    };
    *nearest = nearest.min(segment.to.distance(place));
    segment.distance(place)
}

#[expect(clippy::cast_possible_truncation, reason = "a cast saturates, and so far out nothing is drawn")]
fn cell(cell_mm: f64, place: Point) -> Cell {
    ((place.x / cell_mm).floor() as i64, (place.y / cell_mm).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUNDING_MM: f64 = 1e-12;

    #[test]
    fn both_ways_are_measured() {
        let mut deviation = PathDeviation::new(0.1);
        let corner = [Point::ORIGIN, Point::new(10.0, 0.0), Point::new(10.0, 10.0)];
        deviation.draw(corner[0], corner[1]);
        deviation.draw(corner[1], corner[2]);
        deviation.lift();
        // Half a millimetre above the line, and the corner cut.
        for x in 0..=18 {
            deviation.step(Point::new(0.5 * f64::from(x), 0.5));
        }
        for y in 2..=20 {
            deviation.step(Point::new(10.0, 0.5 * f64::from(y)));
        }
        deviation.lifted();
        let (from_path, from_steps) = deviation.most_mm();
        assert!((from_path - 0.5).abs() < ROUNDING_MM, "{from_path}");
        assert!((from_steps - 1.0).abs() < ROUNDING_MM, "{from_steps}");
    }

    #[test]
    fn a_stroke_of_many_segments_is_searched_as_well() {
        // More than are held: the older half goes three times.
        const COUNT: i32 = 140_000;
        let mut deviation = PathDeviation::new(0.1);
        let at = |i: i32| Point::new(0.3 * f64::from(i), 0.0);
        for i in 0..COUNT {
            deviation.draw(at(i), at(i + 1));
            deviation.step(Point::new(0.3 * f64::from(i) + 0.3, 0.02));
        }
        deviation.lift();
        deviation.step(Point::new(f64::from(COUNT) * 0.3, 7.0));
        deviation.lifted();
        let (from_path, from_steps) = deviation.most_mm();
        assert!((from_path - 7.0).abs() < 1e-6, "{from_path}");
        // The very start has had no step on it.
        assert!((from_steps - 0.3_f64.hypot(0.02)).abs() < 1e-6, "{from_steps}");
    }
}
