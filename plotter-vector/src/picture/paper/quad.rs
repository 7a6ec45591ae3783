//! [`SheetQuad`]: the four sides of a sheet in a photograph.

use super::coarse::Coarse;
use super::edge_lines::{EdgeLine, edge_lines};
use super::proportion::proportion;
use super::side_fit::fitted_side;
use super::straight::StraightSheet;
use crate::picture::{Gray, PxPoint};
use core::fmt;

/// Smaller pictures have no sides to speak of, coarse px.
const LEAST_PICTURE_PX: usize = 48;

/// The sheet covers at least this part of the picture.
const LEAST_AREA: f64 = 0.2;

/// Corners may lie outside of the picture by this part of its sides: what is seen of the two sides tells them.
const OUTSIDE: f64 = 0.25;

/// Neighbouring sides make 40 to 140 degrees: as the cosine.
const MOST_COS: f64 = 0.766;

/// Each side is at least this part of the picture's shorter one.
const LEAST_SIDE: f64 = 0.15;

/// The table is darker than the sheet beside it by at least this part of the sheet's level, and so many
/// levels.
const LEAST_STEP: f32 = 0.07;
const LEAST_LEVELS: f32 = 10.0;

/// Inside and outside of a side, coarse px.
const BESIDE_PX: f64 = 3.5;

/// A table is dark farther out as well, and a sheet light farther in, which tells them from wide lines drawn
/// about something: at half of the places this far apart, so many of them or fewer up to the picture's edge,
/// coarse px.
const FARTHER_PX: f64 = 7.0;
const FARTHER_PLACES: u8 = 14;

/// Places along a side at which that is asked.
const PLACES: u32 = 48;

/// Of the places in the picture, so many of each side and of all sides must show the step; a hand or something
/// else may lie over the rest.
const MOST_OF_SIDE: f32 = 0.4;
const MOST_OF_ALL: f32 = 0.65;

/// And so much of each side lies in the picture.
const SEEN_OF_SIDE: f32 = 0.4;

/// Of several outlines the lighter one is the sheet, and a light cloth below it is not: a level counts by this
/// power.
const LIGHTNESS: i32 = 3;

/// The four corners of a light sheet on something darker, in a picture.
///
/// ```
/// # use plotter_vector::{Gray, PxPoint, picture::SheetQuad};
/// // A light sheet of 200 x 300 px on a dark table, 50 px from its left and 40 px from its upper edge.
/// let is_sheet = |x: u32, y: u32| (50..250).contains(&x) && (40..340).contains(&y);
/// let level = |at: u32| if is_sheet(at % 300, at / 300) { 230 } else { 90 };
/// let picture = Gray::new(300, 400, (0..300 * 400).map(level).collect())?;
/// let quad = SheetQuad::find(&picture)?;
/// assert!(quad.corners[0].distance(PxPoint::new(50.0, 40.0)) < 0.25);
/// assert!(quad.corners[2].distance(PxPoint::new(250.0, 340.0)) < 0.25);
/// let sheet = quad.straightened(quad.proportion(300, 400)).unwrap();
/// assert_eq!((sheet.width_px(), sheet.height_px()), (200, 300));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SheetQuad {
    /// The corners, px, clockwise as seen, from the one at the left end of the uppermost side.
    pub corners: [PxPoint; 4],
    /// How far the edges lie from straight lines between the corners, standard deviation, px; 0 where nobody
    /// measured it.
    pub error_px: f64,
}

/// Why no sheet was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NoSheetQuad {
    /// The picture shows nothing darker beside something light: it is a scan, or it is filled.
    NothingBeside,
    /// Edges of something light, but not four that go around it.
    NoFourSides,
}

impl fmt::Display for NoSheetQuad {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NothingBeside => "no edge of a light sheet on something darker is seen",
            Self::NoFourSides => {
                "edges are seen, but no four that go around a light sheet on something darker"
            }
        })
    }
}

impl core::error::Error for NoSheetQuad {}

impl SheetQuad {
    /// The sheet with these corners, clockwise as seen; none where they are not those of a convex
    /// quadrilateral.
    #[must_use]
    pub fn of_corners(corners: [PxPoint; 4]) -> Option<Self> {
        let [a, b, c, d] = corners;
        let turns = [(b - a).cross(c - b), (c - b).cross(d - c), (d - c).cross(a - d), (a - d).cross(b - a)];
        turns.iter().all(|turn| *turn > 0.0 && turn.is_finite()).then_some(Self { corners, error_px: 0.0 })
    }

    /// Looks for the sheet: for four straight edges, light inside and darker outside, that go around.
    ///
    /// Part of a side may be covered, or lie outside of the picture with the corner at its end. A sheet of
    /// which a whole side lies outside is not found: three sides do not tell how it is seen.
    ///
    /// # Errors
    ///
    /// [`NoSheetQuad`] where there is none.
    pub fn find(picture: &Gray) -> Result<Self, NoSheetQuad> {
        let coarse = Coarse::of(picture).without_lines();
        if coarse.width.min(coarse.height) < LEAST_PICTURE_PX {
            return Err(NoSheetQuad::NothingBeside);
        }
        let lines = edge_lines(&coarse);
        if lines.is_empty() {
            return Err(NoSheetQuad::NothingBeside);
        }
        let outline = best_outline(&coarse, lines).ok_or(NoSheetQuad::NoFourSides)?;
        Ok(outline.fitted(picture, coarse.factor as f64))
    }

    /// How wide the sheet is for its height, from how it is seen in a picture of this size: without its
    /// perspective.
    ///
    /// The principal point is taken for the picture's middle, so a part that was cut out of a photograph tells
    /// it less well.
    #[must_use]
    pub fn proportion(&self, width_px: u32, height_px: u32) -> f64 {
        let size = (f64::from(width_px), f64::from(height_px));
        proportion(self.corners, size).unwrap_or_else(|| {
            let [a, b, c, d] = self.corners;
            (a.distance(b) + c.distance(d)) / (b.distance(c) + d.distance(a)).max(f64::MIN_POSITIVE)
        })
    }

    /// The sheet as if it were looked at from straight above, so wide for its height, with as many pixels as
    /// the picture shows of it; none where that is no picture.
    #[must_use]
    pub fn straightened(&self, proportion: f64) -> Option<StraightSheet> {
        StraightSheet::new(self, proportion)
    }

    /// What the corners enclose, px².
    #[must_use]
    pub fn area_px(&self) -> f64 {
        let [a, b, c, d] = self.corners;
        (c - a).cross(d - b) / 2.0
    }
}

/// Four lines that go around something light.
#[derive(Clone, Copy, Debug)]
struct Outline {
    /// Clockwise as seen, from the uppermost.
    sides: [EdgeLine; 4],
    /// Where each crosses the one before.
    corners: [PxPoint; 4],
}

impl Outline {
    /// Four lines in the order of their directions, if they go around something.
    fn new(sides: [EdgeLine; 4], coarse: &Coarse) -> Option<Self> {
        let [a, b, c, d] = sides;
        let is_corner = |one: EdgeLine, other: EdgeLine| {
            one.out.cross(other.out) > 0.0 && libm::fabs(one.out.dot(other.out)) < MOST_COS
        };
        if !(is_corner(a, b) && is_corner(b, c) && is_corner(c, d) && is_corner(d, a)) {
            return None;
        }
        let corners = [d.crossing(a)?, a.crossing(b)?, b.crossing(c)?, c.crossing(d)?];
        let (width, height) = (coarse.width as f64, coarse.height as f64);
        let near = |at: f64, length: f64| (-OUTSIDE * length..=(1.0 + OUTSIDE) * length).contains(&at);
        if !corners.iter().all(|at| near(at.x, width) && near(at.y, height)) {
            return None;
        }
        let outline = Self { sides, corners };
        // The sides run the right way around, and are long enough.
        let least = LEAST_SIDE * width.min(height);
        let runs =
            |(side, [from, to]): (EdgeLine, [PxPoint; 2])| (to - from).dot(side.out.perpendicular()) > least;
        let quad = SheetQuad { corners, error_px: 0.0 };
        (outline.each_side().into_iter().all(runs) && quad.area_px() > LEAST_AREA * width * height)
            .then_some(outline)
    }

    /// The sides with their ends.
    fn each_side(&self) -> [(EdgeLine, [PxPoint; 2]); 4] {
        let [a, b, c, d] = self.corners;
        let [one, two, three, four] = self.sides;
        [(one, [a, b]), (two, [b, c]), (three, [c, d]), (four, [d, a])]
    }

    /// How much of it is seen as the edge of something light, the lighter the better; none where too little
    /// is.
    fn quality(&self, coarse: &Coarse) -> Option<f64> {
        let (mut quality, mut light, mut lights) = (0.0, 0.0_f32, 0.0_f32);
        let (mut seen_of_all, mut steps_of_all) = (0.0, 0.0);
        for (line, [from, to]) in self.each_side() {
            let (mut seen, mut steps) = (0.0_f32, 0.0_f32);
            for place in 0..PLACES {
                let at = from + (to - from) * ((f64::from(place) + 0.5) / f64::from(PLACES));
                let level = |away: f64| {
                    let at = at + line.out * away;
                    coarse.at(at.x, at.y)
                };
                let (Some(inside), Some(outside)) = (level(-BESIDE_PX), level(BESIDE_PX)) else { continue };
                seen += 1.0;
                light += inside;
                lights += 1.0;
                let step = (LEAST_STEP * inside).max(LEAST_LEVELS);
                // Whether most of what lies farther to that side is as it is beside the edge.
                let goes_on = |way: f64, is_so: &dyn Fn(f32) -> bool| {
                    let farther = (1..=FARTHER_PLACES).map_while(|n| level(way * FARTHER_PX * f64::from(n)));
                    let (so, all) = farther
                        .fold((0_u32, 0_u32), |(so, all), level| (so + u32::from(is_so(level)), all + 1));
                    2 * so >= all
                };
                let is_step = inside - outside > step
                    && goes_on(1.0, &|level| inside - level > step / 2.0)
                    && goes_on(-1.0, &|level| level - outside > step / 2.0);
                steps += f32::from(u8::from(is_step));
            }
            if steps < MOST_OF_SIDE * seen || seen < SEEN_OF_SIDE * PLACES as f32 {
                return None;
            }
            seen_of_all += seen;
            steps_of_all += steps;
            quality += from.distance(to) * f64::from(2.0 * steps - seen) / f64::from(PLACES);
        }
        let light = f64::from(light / lights.max(1.0)) / 255.0;
        (steps_of_all > MOST_OF_ALL * seen_of_all).then(|| quality * light.powi(LIGHTNESS))
    }

    /// The same on the picture itself, to parts of a pixel.
    fn fitted(&self, picture: &Gray, factor: f64) -> SheetQuad {
        let mut outline = *self;
        outline.sides = outline.sides.map(|side| EdgeLine { away: side.away * factor, ..side });
        outline.corners = outline.corners.map(|at| PxPoint::new(at.x * factor, at.y * factor));
        let mut errors = [factor; 4];
        // From what a coarse line is known to, to some pixels.
        for (reach_px, blur_px) in
            [(3.0 * factor, (factor / 2.0).max(1.0)), (3.0 + factor, (factor / 4.0).max(1.0))]
        {
            let mut sides = outline.sides;
            for (((line, ends), side), error) in
                outline.each_side().into_iter().zip(&mut sides).zip(&mut errors)
            {
                if let Some(fitted) = fitted_side(picture, line, ends, reach_px, blur_px) {
                    *side = fitted.line;
                    *error = fitted.error_px;
                }
            }
            let [a, b, c, d] = sides;
            // Lines that moved by some pixels still cross.
            let corners = [d.crossing(a), a.crossing(b), b.crossing(c), c.crossing(d)];
            let [Some(a), Some(b), Some(c), Some(d)] = corners else { break };
            outline = Self { sides, corners: [a, b, c, d] };
        }
        let squares: f64 = errors.iter().map(|error| error * error).sum();
        SheetQuad { corners: outline.corners, error_px: libm::sqrt(squares / 4.0) }
    }
}

/// The best four of the lines.
fn best_outline(coarse: &Coarse, mut lines: Vec<EdgeLine>) -> Option<Outline> {
    // Clockwise as seen, from straight up.
    let turn = |line: &EdgeLine| libm::atan2(line.out.x, -line.out.y);
    lines.sort_by(|one, other| turn(one).total_cmp(&turn(other)));
    let mut best: Option<(f64, Outline)> = None;
    for (first, a) in lines.iter().enumerate() {
        for (second, b) in lines.iter().enumerate().skip(first + 1) {
            for (third, c) in lines.iter().enumerate().skip(second + 1) {
                for d in lines.iter().skip(third + 1) {
                    let Some(outline) = Outline::new([*a, *b, *c, *d], coarse) else { continue };
                    let Some(quality) = outline.quality(coarse) else { continue };
                    if best.as_ref().is_none_or(|(best, _)| quality > *best) {
                        best = Some((quality, outline));
                    }
                }
            }
        }
    }
    best.map(|(_, outline)| outline.uppermost_first())
}

impl Outline {
    /// The same with the side first that looks up most.
    fn uppermost_first(mut self) -> Self {
        let up = |side: &EdgeLine| -side.out.y;
        let (mut first, mut most) = (0, f64::MIN);
        for (index, side) in self.sides.iter().enumerate() {
            if up(side) > most {
                (first, most) = (index, up(side));
            }
        }
        self.sides.rotate_left(first);
        self.corners.rotate_left(first);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Homography, PxVec};

    /// How far a corner may be off that is seen with all of its two sides, px: the pictures here have nine
    /// rays a pixel, and noise.
    const CORNER_PX: f64 = 0.3;

    const WIDTH: u32 = 400;
    const HEIGHT: u32 = 520;

    /// A sheet of 210 x 297 mm with a frame and two lines on it, in light that falls off to the right.
    struct Scene {
        corners: [PxPoint; 4],
        /// The table's levels, and what lies over all.
        table: fn(f64, f64) -> f64,
        over: fn(f64, f64) -> Option<f64>,
    }

    impl Scene {
        fn new(corners: [(f64, f64); 4]) -> Self {
            let corners = corners.map(|(x, y)| PxPoint::new(x, y));
            Self { corners, table: |_, _| 110.0, over: |_, _| None }
        }

        fn picture(&self) -> Gray {
            let back = Homography::of_quadrilateral((210.0, 297.0), self.corners).unwrap().inverse().unwrap();
            let level = |x: f64, y: f64| {
                if let Some(level) = (self.over)(x, y) {
                    return level;
                }
                let on_sheet = back.apply(PxPoint::new(x, y));
                match on_sheet.filter(|at| (0.0..210.0).contains(&at.x) && (0.0..297.0).contains(&at.y)) {
                    Some(PxPoint { x, y }) => {
                        let frame = (x - 105.0).abs().max((y - 148.5).abs() - 43.5);
                        let is_ink =
                            (80.0..82.0).contains(&frame) || (x - 60.0).abs() < 1.0 || (y - x).abs() < 1.0;
                        if is_ink { 40.0 } else { 235.0 }
                    }
                    None => (self.table)(x, y),
                }
            };
            let mut levels = Vec::new();
            let mut random = 1_u32;
            for y in 0..HEIGHT {
                for x in 0..WIDTH {
                    let (x, y) = (f64::from(x), f64::from(y));
                    let thirds = [1.0, 3.0, 5.0].map(|part| part / 6.0);
                    let rays = thirds.iter().flat_map(|down| thirds.iter().map(move |across| (across, down)));
                    let sum: f64 = rays.map(|(across, down)| level(x + across, y + down)).sum();
                    let light = 1.0 - 0.4 * x / f64::from(WIDTH);
                    random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    let noise = f64::from(random >> 24) / 32.0 - 4.0;
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a level")]
                    levels.push((sum / 9.0 * light + noise).clamp(0.0, 255.0) as u8);
                }
            }
            Gray::new(WIDTH, HEIGHT, levels).unwrap()
        }

        fn assert_found(&self, within_px: f64) {
            let quad = SheetQuad::find(&self.picture()).unwrap();
            for (found, corner) in quad.corners.iter().zip(self.corners) {
                assert!(found.distance(corner) < within_px, "{found:?} in place of {corner:?}: {quad:?}");
            }
        }
    }

    const ASKEW: [(f64, f64); 4] = [(60.0, 55.0), (345.0, 70.0), (370.0, 470.0), (35.0, 455.0)];

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_sheet_on_a_table_is_found_to_parts_of_a_pixel() {
        Scene::new(ASKEW).assert_found(CORNER_PX);
        // Turned by a third of a right angle.
        let turned = PxVec::new(1.0, 0.0).rotated(0.55);
        let corner = |x: f64, y: f64| {
            let at = PxPoint::new(200.0, 260.0) + turned * x + turned.perpendicular() * y;
            (at.x, at.y)
        };
        let turned =
            [corner(-105.0, -148.0), corner(105.0, -148.0), corner(105.0, 148.0), corner(-105.0, 148.0)];
        Scene::new(turned).assert_found(CORNER_PX);
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn what_covers_a_corner_or_lies_beside_the_sheet_does_not_move_it() {
        // A hand as dark as the table over the lower left corner.
        let over = |x: f64, y: f64| (libm::hypot(x - 30.0, y - 470.0) < 90.0).then_some(120.0);
        Scene { over, ..Scene::new(ASKEW) }.assert_found(CORNER_PX);
        // The table ends beside the sheet: a light floor, still darker than paper.
        let table = |x: f64, y: f64| if x > 375.0 || y < 25.0 { 180.0 } else { 80.0 };
        Scene { table, ..Scene::new(ASKEW) }.assert_found(CORNER_PX);
        // A shadow falls on the table along the sheet, and dies away.
        let table = |x: f64, y: f64| {
            let away = (30.0 - x).max(40.0 - y).max(x - 375.0).max(y - 475.0).clamp(-30.0, 30.0);
            110.0 + 0.9 * away
        };
        Scene { table, ..Scene::new(ASKEW) }.assert_found(CORNER_PX);
    }

    #[test]
    fn a_corner_outside_of_the_picture_is_where_its_sides_meet() {
        Scene::new([(60.0, 55.0), (425.0, 70.0), (370.0, 470.0), (35.0, 455.0)]).assert_found(1.5);
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn what_is_no_sheet_is_not_found() {
        let even = Gray::new(WIDTH, HEIGHT, vec![230; (WIDTH * HEIGHT) as usize]).unwrap();
        assert_eq!(SheetQuad::find(&even), Err(NoSheetQuad::NothingBeside));
        let tiny = Gray::new(20, 20, vec![230; 400]).unwrap();
        assert_eq!(SheetQuad::find(&tiny), Err(NoSheetQuad::NothingBeside));
        // A side outside of the picture: three do not tell how it is seen.
        let scene = Scene::new([(60.0, 55.0), (345.0, 70.0), (370.0, 700.0), (35.0, 690.0)]);
        assert_eq!(SheetQuad::find(&scene.picture()), Err(NoSheetQuad::NoFourSides));
        // Walls 20 px wide are drawn about something: paper on both sides, dark or light.
        for (paper, wall) in [(230, 20), (30, 220)] {
            let level = |at: u32| {
                let (x, y) = (at % WIDTH, at / WIDTH);
                let inside = |by: u32| (by..WIDTH - by).contains(&x) && (by..HEIGHT - by).contains(&y);
                if inside(60) && !inside(80) { wall } else { paper }
            };
            let walls = Gray::new(WIDTH, HEIGHT, (0..WIDTH * HEIGHT).map(level).collect()).unwrap();
            assert_eq!(SheetQuad::find(&walls), Err(NoSheetQuad::NoFourSides), "{paper} {wall}");
        }
    }
}
