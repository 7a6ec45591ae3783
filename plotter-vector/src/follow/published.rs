//! [`PublishedFollower`]: circles around the current place, and always the same hand.

use super::circle::ring;
use super::exits::{circumference, connected, low_pass, middles, offset};
use super::{End, LineFollower, Lost, Step, Tool};
use crate::{
    PxVec,
    picture::{Bitmap, Gray, Pixel},
    stroke::PxPoint,
};

/// The hand on which a follower turns off at a junction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Hand {
    /// Always the leftmost way.
    Left,
    /// Always the rightmost way.
    #[default]
    Right,
}

/// The parameters of the published follower.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct PublishedSettings {
    /// Darker levels are line (section 4.8).
    pub level: u8,
    /// Least share of background on the circle of a step: 0.65 (section 4.6).
    pub background: f64,
    /// Shortest run of line or background on a circle: 4 (section 4.7).
    pub min_run: usize,
    /// Least radius of a step, px: the thinnest allowed line, which the user gives; three values were enough in practice.
    pub thinnest_px: u32,
    /// Greatest number of places in a window (section 4.1).
    pub max_points: usize,
    /// On which side it turns off.
    pub hand: Hand,
    /// The way that it came before the first window.
    pub heading: PxVec,
    /// Whether only exits count that ink inside of the circle joins to the current place: proposed in section 4.12, and not built
    /// there, so not as published. See [`connected_exits`](super::connected_exits).
    pub only_connected: bool,
    /// What the machine can reach: the upper left and the lower right corner. Lines outside are not seen. Not as published,
    /// where nothing keeps it from moving anywhere.
    pub area: Option<[PxPoint; 2]>,
    /// How many pictures in a row may show no line, or none that it can take a step on.
    pub max_tries: u32,
}

impl PublishedSettings {
    /// The same with another [`PublishedSettings::level`].
    #[must_use]
    pub const fn with_level(self, level: u8) -> Self {
        Self { level, ..self }
    }

    /// The same with another [`PublishedSettings::background`].
    #[must_use]
    pub const fn with_background(self, background: f64) -> Self {
        Self { background, ..self }
    }

    /// The same with another [`PublishedSettings::min_run`].
    #[must_use]
    pub const fn with_min_run(self, min_run: usize) -> Self {
        Self { min_run, ..self }
    }

    /// The same with another [`PublishedSettings::thinnest_px`].
    #[must_use]
    pub const fn with_thinnest_px(self, thinnest_px: u32) -> Self {
        Self { thinnest_px, ..self }
    }

    /// The same with another [`PublishedSettings::max_points`].
    #[must_use]
    pub const fn with_max_points(self, max_points: usize) -> Self {
        Self { max_points, ..self }
    }

    /// The same with another [`PublishedSettings::hand`].
    #[must_use]
    pub const fn with_hand(self, hand: Hand) -> Self {
        Self { hand, ..self }
    }

    /// The same with another [`PublishedSettings::heading`].
    #[must_use]
    pub const fn with_heading(self, heading: PxVec) -> Self {
        Self { heading, ..self }
    }

    /// The same with another [`PublishedSettings::only_connected`].
    #[must_use]
    pub const fn with_only_connected(self, only_connected: bool) -> Self {
        Self { only_connected, ..self }
    }

    /// The same with another [`PublishedSettings::area`].
    #[must_use]
    pub const fn with_area(self, area: Option<[PxPoint; 2]>) -> Self {
        Self { area, ..self }
    }

    /// The same with another [`PublishedSettings::max_tries`].
    #[must_use]
    pub const fn with_max_tries(self, max_tries: u32) -> Self {
        Self { max_tries, ..self }
    }
}

impl Default for PublishedSettings {
    /// The thesis' own figures; for what it does not give: a level half way, lines from 4 px on, 40 places a window, and a first
    /// way to the right; all exits count, no area bounds it, and 8 pictures may show no line.
    fn default() -> Self {
        Self {
            level: 100,
            background: 0.65,
            min_run: 4,
            thinnest_px: 4,
            max_points: 40,
            hand: Hand::Right,
            heading: PxVec::new(1.0, 0.0),
            only_connected: false,
            area: None,
            max_tries: 8,
        }
    }
}

impl PublishedSettings {
    /// For lines from this width on, px: the least radius is that width, and the low-pass filter leaves what such a line crosses
    /// a circle with. On a diagonal that is only 1/√2 of its width in pixels, so that the thesis' 4 suits lines from 6 px on;
    /// with it a line of 5 px ends wherever it runs at 45 degrees.
    ///
    /// ```
    /// # use plotter_vector::follow::PublishedSettings;
    /// let runs = [1, 4, 5, 6, 20].map(|thinnest_px| PublishedSettings::for_lines(thinnest_px).min_run);
    /// assert_eq!(runs, [1, 2, 3, 4, 4]);
    /// ```
    #[must_use]
    pub fn for_lines(thinnest_px: u32) -> Self {
        let published = Self::default();
        let crossed = super::whole::floor(f64::from(thinnest_px) * core::f64::consts::FRAC_1_SQRT_2);
        let min_run = usize::try_from(crossed).unwrap_or(1).clamp(1, published.min_run);
        Self { thinnest_px, min_run, ..published }
    }
}

/// The line follower as published: C. Ekholm, "Automaattisen plasmaleikkurin ohjauslogiikan kehitys" (Kajaani, 2005).
///
/// In each window: [threshold](PublishedSettings::level); circles grow from the middle until one meets the line; from there step by
/// step, each to the middle of a run of line on the smallest circle with 65 % background, the low-pass filtered; of the exits
/// the way back goes, and of the rest the next on one side is taken, by the angle from cross and dot product. Ends at
/// the window's border, or after [`PublishedSettings::max_points`]. It never says that all is done: "the
/// user stops it"; only after [`PublishedSettings::max_tries`] pictures without a line it ends.
///
/// ```
/// # use plotter_vector::{Gray, PxPoint, follow::{LineFollower, PublishedFollower, PublishedSettings, Step}};
/// let row: Vec<u8> = vec![255; 100];
/// let line: Vec<u8> = vec![0; 100];
/// let levels: Vec<u8> = (0..100).flat_map(|y| if (48..53).contains(&y) { &line } else { &row }.clone()).collect();
/// let mut follower = PublishedFollower::new(PublishedSettings::default());
/// let Step::Move { path, .. } = follower.observe(&Gray::new(100, 100, levels)?, PxPoint::new(0.0, 0.0)) else { panic!() };
/// let end = path.last().unwrap();
/// assert!(end.x > 40.0 && end.y.abs() <= 1.0, "to the right, along the line: {end:?}");
/// # Ok::<(), plotter_vector::picture::GrayError>(())
/// ```
#[derive(Clone, Debug)]
pub struct PublishedFollower {
    settings: PublishedSettings,
    /// Direction of the last move along the line.
    heading: PxVec,
    tries: u32,
    ended: Option<End>,
}

impl PublishedFollower {
    /// Before the first window.
    #[must_use]
    pub const fn new(settings: PublishedSettings) -> Self {
        Self { settings, heading: settings.heading, tries: 0, ended: None }
    }

    /// The line's pixels, as far as the machine reaches.
    fn threshold(&self, window: &Gray, to_paper: impl Fn(Pixel) -> PxPoint) -> Option<Bitmap> {
        let mut ink = Bitmap::new(window.width(), window.height()).ok()?;
        let reached = |at: PxPoint| {
            self.settings
                .area
                .is_none_or(|[from, to]| at.x >= from.x && at.y >= from.y && at.x <= to.x && at.y <= to.y)
        };
        for (y, row) in (0..).zip(window.rows()) {
            for (x, level) in (0..).zip(row) {
                let pixel = Pixel::new(x, y);
                if *level < self.settings.level && reached(to_paper(pixel)) {
                    ink.set(pixel, true);
                }
            }
        }
        Some(ink)
    }

    /// The next place, if the circle stays inside of the window.
    fn next(&self, ink: &Bitmap, at: Pixel, heading: PxVec) -> Option<Pixel> {
        let least = i32::try_from(self.settings.thinnest_px.clamp(1, 1 << 14)).ok()?;
        for radius in least.. {
            let around = if self.settings.only_connected {
                connected(ink, at, radius)?
            } else {
                circumference(ink, at, radius)?
            };
            let background = around.iter().filter(|(_, line)| !line).count();
            #[expect(clippy::cast_precision_loss, reason = "a circle in a window")]
            let share = background as f64 / around.len().max(1) as f64;
            if share < self.settings.background {
                continue;
            }
            let ring: Vec<Pixel> = around.iter().map(|(pixel, _)| *pixel).collect();
            let mut lines: Vec<bool> = around.iter().map(|(_, line)| *line).collect();
            low_pass(&mut lines, self.settings.min_run);
            let exits = middles(&ring, &lines);
            return Some(choose(at, heading, &exits, self.settings.hand).unwrap_or(at));
        }
        None
    }
}

/// Angle from the way back to an exit, 0 up to 360 degrees, growing to the right hand first (section 4.4).
fn angle_deg(back: PxVec, way: PxVec) -> f64 {
    let dot = back.dot(way);
    // On a picture, y down, this turns against the clock: from behind over the right hand.
    let cross = back.y * way.x - back.x * way.y;
    let angle = libm::atan2(cross, dot).to_degrees();
    if angle < 0.0 { angle + 360.0 } else { angle }
}

/// The exit on the wanted hand; the way back only when there is no other.
fn choose(at: Pixel, heading: PxVec, exits: &[Pixel], hand: Hand) -> Option<Pixel> {
    let back = -heading;
    let mut angles: Vec<(f64, Pixel)> =
        exits.iter().map(|exit| (angle_deg(back, *exit - at), *exit)).collect();
    if angles.len() < 2 {
        return exits.first().copied();
    }
    // The way back is the one nearest to 0, from either side.
    let near = |angle: f64| angle.min(360.0 - angle);
    let (way_back, _) = angles.iter().enumerate().min_by(|(_, a), (_, b)| near(a.0).total_cmp(&near(b.0)))?;
    angles.remove(way_back);
    let by_angle = |a: &&(f64, Pixel), b: &&(f64, Pixel)| a.0.total_cmp(&b.0);
    let chosen = match hand {
        Hand::Right => angles.iter().min_by(by_angle),
        Hand::Left => angles.iter().max_by(by_angle),
    };
    chosen.map(|(_, exit)| *exit)
}

impl PublishedFollower {
    /// Another picture, or the end when there were enough.
    fn lost(&mut self, at: PxPoint, why: Lost) -> Step {
        self.tries = self.tries.saturating_add(1);
        if self.tries > self.settings.max_tries {
            self.ended = Some(End::NoLine { at, why });
            return Step::Done(End::NoLine { at, why });
        }
        Step::LineLost { at, tries: self.tries, why }
    }
}

impl LineFollower for PublishedFollower {
    fn observe(&mut self, window: &Gray, pose: PxPoint) -> Step {
        if let Some(end) = self.ended {
            return Step::Done(end);
        }
        let centre = PxPoint::new(0.5 * f64::from(window.width()), 0.5 * f64::from(window.height()));
        let to_paper = |pixel: Pixel| pose + (PxPoint::from(pixel) - centre);
        let Some(ink) = self.threshold(window, to_paper) else { return self.lost(pose, Lost::WindowSize) };
        let middle = Pixel::new(window.width() / 2, window.height() / 2);
        // A circle larger than the picture means that there is no line.
        let largest = i32::try_from(window.width().max(window.height())).unwrap_or(i32::MAX);
        let meets = |radius: i32| {
            let on_line = |way| offset(middle, way, &ink).filter(|pixel| ink.get(*pixel));
            ring(radius).into_iter().find_map(on_line)
        };
        let Some(nearest) = (0..largest).find_map(meets) else { return self.lost(pose, Lost::OneColour) };

        let mut places = vec![nearest];
        let mut at = nearest;
        for _ in 0..self.settings.max_points {
            let Some(next) = self.next(&ink, at, self.heading) else { break };
            if next == at {
                // No exit at all: a dead end, where one turns round.
                self.heading = -self.heading;
                break;
            }
            self.heading = next - at;
            places.push(next);
            at = next;
        }
        if places.len() == 1 && nearest == middle {
            // Nowhere to go, though the line is in the middle.
            let is_dark = window.pixels().iter().all(|level| *level < self.settings.level);
            return self.lost(pose, if is_dark { Lost::OneColour } else { Lost::TooThick });
        }
        self.tries = 0;
        Step::Move { path: merged(&places.into_iter().map(to_paper).collect::<Vec<_>>()), tool: Tool::Down }
    }
}

/// A path without the places that lie straight between their neighbours.
///
/// ```
/// # use plotter_vector::{PxPoint, follow::merged};
/// let path = [(0.0, 0.0), (2.0, 1.0), (4.0, 2.0), (4.0, 5.0)].map(|(x, y)| PxPoint::new(x, y));
/// assert_eq!(merged(&path), [path[0], path[2], path[3]]);
/// ```
#[must_use]
pub fn merged(path: &[PxPoint]) -> Vec<PxPoint> {
    let mut kept: Vec<PxPoint> = Vec::new();
    for place in path {
        if let [.., before, last] = kept.as_slice() {
            let (one, other) = (*last - *before, *place - *last);
            let straight = one.cross(other) == 0.0 && one.dot(other) > 0.0;
            if straight {
                kept.pop();
            }
        }
        kept.push(*place);
    }
    kept
}

/// From pixels of the camera to steps of the motors: the thesis' multiplier (section 4.9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelScale {
    /// Steps of the motors for a pixel.
    pub steps_per_px: f64,
}

impl PixelScale {
    /// The moves of a path in steps, each from the place before; rounded so that no error adds up.
    ///
    /// ```
    /// # use plotter_vector::{PxPoint, follow::PixelScale};
    /// let path = [PxPoint::new(0.5, 0.0), PxPoint::new(1.0, 0.0), PxPoint::new(1.5, 2.0)];
    /// let moves = PixelScale { steps_per_px: 2.5 }.moves(PxPoint::new(0.0, 0.0), &path);
    /// assert_eq!(moves, [(1, 0), (2, 0), (1, 5)]); // 1.25, 2.5 and 3.75 steps in all
    /// ```
    #[must_use]
    pub fn moves(self, from: PxPoint, path: &[PxPoint]) -> Vec<(i32, i32)> {
        let steps = |px: f64| super::whole::floor(px * self.steps_per_px + 0.5);
        let mut at = (0, 0);
        let mut moves = Vec::with_capacity(path.len());
        for place in path {
            let to = (steps(place.x - from.x), steps(place.y - from.y));
            moves.push((to.0.saturating_sub(at.0), to.1.saturating_sub(at.1)));
            at = to;
        }
        moves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_ways_of_figure_8() {
        // The thesis' place: ways to (0, -3), (-1, -3) and (0, 3); it came along (0, 3), that is from below, y up.
        // On a picture y is down: came going up.
        let at = Pixel::new(10, 10);
        let exits = [Pixel::new(10, 13), Pixel::new(9, 7), Pixel::new(10, 7)];
        let going_up = PxVec::new(0.0, -3.0);
        assert_eq!(choose(at, going_up, &exits, Hand::Right), Some(Pixel::new(10, 7)));
        assert_eq!(choose(at, going_up, &exits, Hand::Left), Some(Pixel::new(9, 7)));
        assert_eq!(choose(at, going_up, &exits[..1], Hand::Left), Some(Pixel::new(10, 13)), "a dead end");
    }

    #[test]
    fn an_empty_window_is_an_error_that_counts() {
        let white = Gray::new(40, 40, vec![255; 1600]).unwrap();
        let mut follower = PublishedFollower::new(PublishedSettings::default());
        let at = PxPoint::new(3.0, 4.0);
        assert_eq!(follower.observe(&white, at), Step::LineLost { at, tries: 1, why: Lost::OneColour });
        assert_eq!(follower.observe(&white, at), Step::LineLost { at, tries: 2, why: Lost::OneColour });
    }
}
