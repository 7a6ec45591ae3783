//! [`Correction`]: what a lens does to straight lines, measured on a printed grid.
//!
//! The camera looks straight down on a square grid. Its crossings are found in the picture; near the middle, where no lens bends much, they tell
//! where all others would be without distortion. A smooth map between both, a polynomial of the third degree in each
//! coordinate by least squares, corrects every later window. It takes radial distortion, a lens off its axis, and a
//! camera that is tilted a little.

use super::flat::Flat;
use super::lines::Lines;
use super::whole::floor;
use crate::{PxVec, picture::Gray, stroke::PxPoint};
use core::fmt;

/// Terms of a polynomial of the third degree in two variables.
const TERMS: usize = 10;

/// Fewest crossings.
const FEWEST: usize = 25;

/// Why a picture calibrates nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CalibrationError {
    /// Too few crossings of lines.
    FewCrossings {
        /// Crossings found.
        found: usize,
    },
    /// The crossings are those of no square grid, or of one that is turned by more than 30 degrees.
    NoGrid {
        /// Crossings found.
        found: usize,
        /// Of them in rows and columns.
        in_grid: usize,
    },
}

impl fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FewCrossings { found } => write!(
                f,
                "{found} crossings of lines where a grid needs {FEWEST}: print a finer one, all over the window, in focus"
            ),
            Self::NoGrid { found, in_grid } => write!(
                f,
                "only {in_grid} of {found} crossings lie in rows and columns: lay a square grid straight under the camera"
            ),
        }
    }
}

impl core::error::Error for CalibrationError {}

/// From where something is in a window without distortion to where the camera shows it.
///
/// ```
/// # use plotter_vector::{PxPoint, follow::*};
/// let rows = (0..21).map(|i| f64::from(i) * 20.0);
/// let grid: Vec<_> = rows.flat_map(|at| [
///     (vec![PxPoint::new(0.0, at), PxPoint::new(400.0, at)], 3.0),
///     (vec![PxPoint::new(at, 0.0), PxPoint::new(at, 400.0)], 3.0),
/// ]).collect();
/// let lens = Lens { barrel: 0.05 };
/// let mut camera = SimulatedCamera::new(&Paper::drawn(400, 400, &grid)?, CameraSettings::default().with_lens(lens));
/// let correction = Correction::measured(&camera.window(PxPoint::new(200.0, 200.0)))?;
/// // What lies 105 px right of the middle is shown where the lens has it.
/// let shown = correction.shown(PxPoint::new(255.0, 150.0));
/// let back = lens.straightened(PxPoint::new(shown.x - 150.0, shown.y - 150.0), 150.0 * 2.0_f64.sqrt());
/// assert!((back.x - 105.0).abs() < 1.0 && back.y.abs() < 1.0, "{back:?}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Correction {
    /// Size of the window, px.
    size_px: (u32, u32),
    /// Coefficients for x and y shown, of places from the middle as shares of the half width.
    x: [f64; TERMS],
    y: [f64; TERMS],
    /// Root of the mean square of what the grid's crossings are off after the correction, px.
    rms_px: f64,
    /// The farthest that the lens moves a crossing, px.
    most_px: f64,
    /// Pitch of the grid, px.
    pitch_px: f64,
}

/// The terms at a place.
fn terms(u: f64, v: f64) -> [f64; TERMS] {
    [1.0, u, v, u * u, u * v, v * v, u * u * u, u * u * v, u * v * v, v * v * v]
}

fn dot(coefficients: &[f64; TERMS], terms: &[f64; TERMS]) -> f64 {
    coefficients.iter().zip(terms).map(|(a, b)| a * b).sum()
}

impl Correction {
    /// Measures the lens on the picture of a square grid: lines of one width, 5 to 30 in each direction, along the window's
    /// sides within some degrees.
    ///
    /// # Errors
    /// [`CalibrationError`].
    pub fn measured(window: &Gray) -> Result<Self, CalibrationError> {
        let flat = Flat::of(window, None, None);
        let found = crossings(&Lines::of(&flat, 40));
        if found.len() < FEWEST {
            return Err(CalibrationError::FewCrossings { found: found.len() });
        }
        let middle = PxPoint::new(0.5 * f64::from(window.width()), 0.5 * f64::from(window.height()));
        let in_grid = numbered(&found, middle);
        let no_grid = CalibrationError::NoGrid { found: found.len(), in_grid: in_grid.len() };
        if in_grid.len() < FEWEST || 2 * in_grid.len() < found.len() {
            return Err(no_grid);
        }
        // The grid as it is in the middle: an affine map from numbers to places.
        let mut central = in_grid.clone();
        central.sort_by(|a, b| a.1.distance(middle).total_cmp(&b.1.distance(middle)));
        central.truncate(25);
        let affine = |part: &dyn Fn(PxPoint) -> f64| {
            solved::<3>(central.iter().map(|(PxVec { x: i, y: j }, at)| ([1.0, *i, *j], part(*at))))
        };
        let (Some(ax), Some(ay)) = (affine(&|at| at.x), affine(&|at| at.y)) else { return Err(no_grid) };
        let half = 0.5 * f64::from(window.width());
        let straight = |PxVec { x: i, y: j }: PxVec| {
            PxPoint::new(ax[0] + ax[1] * i + ax[2] * j, ay[0] + ay[1] * i + ay[2] * j)
        };
        let scaled = |at: PxPoint| terms((at.x - middle.x) / half, (at.y - middle.y) / half);
        let fit = |part: &dyn Fn(PxPoint) -> f64| {
            solved::<TERMS>(in_grid.iter().map(|(number, at)| (scaled(straight(*number)), part(*at))))
        };
        let (Some(x), Some(y)) = (fit(&|at| at.x), fit(&|at| at.y)) else { return Err(no_grid) };
        let mut correction = Self {
            size_px: (window.width(), window.height()),
            x,
            y,
            rms_px: 0.0,
            most_px: 0.0,
            pitch_px: 0.5 * (libm::hypot(ax[1], ay[1]) + libm::hypot(ax[2], ay[2])),
        };
        let mut squares = 0.0;
        for (number, at) in &in_grid {
            let meant = straight(*number);
            squares += correction.shown(meant).distance(*at) * correction.shown(meant).distance(*at);
            correction.most_px = correction.most_px.max(meant.distance(*at));
        }
        let crossings = f64::from(u32::try_from(in_grid.len()).unwrap_or(u32::MAX));
        correction.rms_px = libm::sqrt(squares / crossings);
        Ok(correction)
    }

    /// Where the camera shows what lies at a place of the window without distortion, px.
    #[must_use]
    pub fn shown(&self, place: PxPoint) -> PxPoint {
        let (width, height) = (f64::from(self.size_px.0), f64::from(self.size_px.1));
        let terms = terms((2.0 * place.x - width) / width, (2.0 * place.y - height) / width);
        PxPoint::new(dot(&self.x, &terms), dot(&self.y, &terms))
    }

    /// Root of the mean square of what the grid's crossings are off after the correction, px.
    #[must_use]
    pub const fn rms_px(&self) -> f64 {
        self.rms_px
    }

    /// How far the lens moves the crossing that it moves most, px.
    #[must_use]
    pub const fn most_px(&self) -> f64 {
        self.most_px
    }

    /// From line to line of the grid, in pixels of the middle: with the printed pitch it gives the camera's scale.
    #[must_use]
    pub const fn pitch_px(&self) -> f64 {
        self.pitch_px
    }

    /// Size of the windows that it corrects, px: that of the picture it was measured on.
    #[must_use]
    pub const fn size_px(&self) -> (u32, u32) {
        self.size_px
    }

    /// A window as a lens without distortion shows it; one of another size than [`Correction::size_px`] as it is.
    ///
    /// For followers that do not correct windows themselves, as ours does.
    ///
    /// ```
    /// # use plotter_vector::{Pixel, PxPoint, follow::*};
    /// # let rows = (0..21).map(|i| f64::from(i) * 20.0);
    /// # let grid: Vec<_> = rows.flat_map(|at| [
    /// #     (vec![PxPoint::new(0.0, at), PxPoint::new(400.0, at)], 3.0),
    /// #     (vec![PxPoint::new(at, 0.0), PxPoint::new(at, 400.0)], 3.0),
    /// # ]).collect();
    /// // A grid with a line each 20 px, under a lens that bends it.
    /// let bad = CameraSettings::default().with_lens(Lens { barrel: 0.08 }).with_rim_light(1.0);
    /// let mut camera = SimulatedCamera::new(&Paper::drawn(400, 400, &grid)?, bad);
    /// let window = camera.window(PxPoint::new(200.0, 200.0));
    /// let straight = Correction::measured(&window)?.corrected(&window);
    /// // The line 120 px above the middle is straight again, from the left to the right.
    /// let dark = |picture: &plotter_vector::Gray| (0..10).filter(|i| picture.get(Pixel::new(15 + 30 * i, 30)).unwrap() < 110).count();
    /// assert_eq!((dark(&straight), dark(&window) < 6), (10, true));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn corrected(&self, window: &Gray) -> Gray {
        let (width, height) = self.size_px;
        if (window.width(), window.height()) != self.size_px {
            return window.clone();
        }
        let place = (0..height as usize).flat_map(|y| (0..width as usize).map(move |x| (x, y)));
        let levels = place.map(|(x, y)| super::whole::level(self.level(window, x, y))).collect();
        Gray::of_checked_size(width, height, levels)
    }

    /// The level of a corrected window's pixel.
    pub(super) fn level(&self, window: &Gray, x: usize, y: usize) -> f32 {
        #[expect(clippy::cast_precision_loss, reason = "a window is small")]
        let at = self.shown(PxPoint::new(x as f64 + 0.5, y as f64 + 0.5));
        let (left, top) = (floor(at.x - 0.5), floor(at.y - 0.5));
        let (u, v) = (at.x - 0.5 - f64::from(left), at.y - 0.5 - f64::from(top));
        let (width, height) = (window.width() as usize, window.height() as usize);
        let level = |x: i32, y: i32| {
            let clamp = |at: i32, side: usize| usize::try_from(at).unwrap_or(0).min(side.saturating_sub(1));
            window.pixels().get(clamp(y, height) * width + clamp(x, width)).copied().map_or(255.0, f64::from)
        };
        let above = level(left, top) * (1.0 - u) + level(left.saturating_add(1), top) * u;
        let below = level(left, top.saturating_add(1)) * (1.0 - u)
            + level(left.saturating_add(1), top.saturating_add(1)) * u;
        #[expect(clippy::cast_possible_truncation, reason = "a level")]
        let mixed = (above * (1.0 - v) + below * v) as f32;
        mixed
    }
}

/// Where the lines of a window cross.
fn crossings(lines: &Lines) -> Vec<PxPoint> {
    let segments: Vec<[PxPoint; 2]> = lines
        .pieces
        .iter()
        .flat_map(|piece| piece.places.windows(2))
        .filter_map(|pair| <[PxPoint; 2]>::try_from(pair).ok())
        .collect();
    let is_level = |[a, b]: &&[PxPoint; 2]| (b.x - a.x).abs() > (b.y - a.y).abs();
    let mut found: Vec<PxPoint> = Vec::new();
    let steep: Vec<&[PxPoint; 2]> = segments.iter().filter(|segment| !is_level(segment)).collect();
    for [a, b] in segments.iter().filter(is_level) {
        for [c, d] in steep.iter().filter(|[c, _]| c.distance(*a) < 10.0) {
            let (one, other) = (*b - *a, *d - *c);
            let cross = one.cross(other);
            let between = *c - *a;
            if cross.abs() < 1e-9 {
                continue;
            }
            let s = between.cross(other) / cross;
            let t = between.cross(one) / cross;
            let on = -0.01..=1.01;
            let at = *a + one * s;
            if on.contains(&s) && on.contains(&t) && found.iter().all(|known| known.distance(at) > 4.0) {
                found.push(at);
            }
        }
    }
    found
}

/// Crossings with their column and row in the grid, from the one nearest to the middle outwards.
fn numbered(found: &[PxPoint], middle: PxPoint) -> Vec<(PxVec, PxPoint)> {
    let nearest_to = |at: PxPoint, apart: f64| {
        let candidates = found.iter().enumerate().filter(|(_, other)| other.distance(at) > apart);
        candidates.min_by(|(_, a), (_, b)| a.distance(at).total_cmp(&b.distance(at)))
    };
    let Some((first, origin)) = nearest_to(middle, -1.0) else { return Vec::new() };
    let Some((_, neighbour)) = nearest_to(*origin, 1.0) else { return Vec::new() };
    let pitch = origin.distance(*neighbour);
    let mut numbers: Vec<Option<(i32, i32)>> = vec![None; found.len()];
    if let Some(number) = numbers.get_mut(first) {
        *number = Some((0, 0));
    }
    let mut open = std::collections::VecDeque::from([first]);
    while let Some(index) = open.pop_front() {
        let (Some(at), Some(Some((i, j)))) = (found.get(index), numbers.get(index).copied()) else {
            continue;
        };
        for (next, other) in found.iter().enumerate() {
            let PxVec { x: dx, y: dy } = *other - *at;
            let is_free = numbers.get(next).is_some_and(Option::is_none);
            let near = (0.65 * pitch..1.4 * pitch).contains(&libm::hypot(dx, dy));
            let straight = dx.abs().min(dy.abs()) < 0.5 * dx.abs().max(dy.abs());
            if !(is_free && near && straight) {
                continue;
            }
            let number = if dx.abs() > dy.abs() {
                (i + if dx > 0.0 { 1 } else { -1 }, j)
            } else {
                (i, j + if dy > 0.0 { 1 } else { -1 })
            };
            if !numbers.contains(&Some(number)) {
                if let Some(slot) = numbers.get_mut(next) {
                    *slot = Some(number);
                }
                open.push_back(next);
            }
        }
    }
    let pairs = numbers.into_iter().zip(found);
    pairs
        .filter_map(|(number, at)| number.map(|(i, j)| (PxVec::new(f64::from(i), f64::from(j)), *at)))
        .collect()
}

/// Least squares: the coefficients of rows of terms that come nearest to the values; none where the rows do not tell.
fn solved<const N: usize>(rows: impl Iterator<Item = ([f64; N], f64)>) -> Option<[f64; N]> {
    let mut matrix = vec![vec![0.0; N + 1]; N];
    for (terms, value) in rows {
        for (row, term) in matrix.iter_mut().zip(terms) {
            for (cell, other) in row.iter_mut().zip(terms.iter().chain([&value])) {
                *cell += term * other;
            }
        }
    }
    // Gauss and Jordan, the largest number first.
    for column in 0..N {
        let pivot = (column..N).max_by(|a, b| {
            let size =
                |row: &usize| matrix.get(*row).and_then(|row| row.get(column)).map_or(0.0, |cell| cell.abs());
            size(a).total_cmp(&size(b))
        })?;
        matrix.swap(column, pivot);
        let own = matrix.get(column)?.clone();
        let lead = *own.get(column)?;
        if lead.abs() < 1e-9 {
            return None;
        }
        for (index, row) in matrix.iter_mut().enumerate() {
            let factor = row.get(column)? / lead;
            if index != column {
                row.iter_mut().zip(&own).for_each(|(cell, more)| *cell -= factor * more);
            }
        }
    }
    let mut found = [0.0; N];
    for (index, (slot, row)) in found.iter_mut().zip(&matrix).enumerate() {
        *slot = row.get(N)? / row.get(index)?;
    }
    Some(found)
}
