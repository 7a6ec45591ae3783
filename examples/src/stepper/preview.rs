//! [`SteppedPreview`]: the picture that stepped motors draw, at true scale.

use crate::shared::pen_colour;
use plotter_motion::{Pen, Point, Vec2, config::AreaConfig};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Line width of pens, mm.
const PEN_MM: f64 = 0.3;

/// Blank paper about the frame, mm.
const MARGIN_MM: f64 = 5.0;

/// Gathers the places of a pen, step by step, as paths of straight lines that are no farther than a tolerance
/// from them.
#[derive(Clone, Debug)]
pub struct SteppedPreview {
    tolerance_mm: f64,
    /// The path data of each pen, and of the ways between strokes.
    pens: BTreeMap<u8, String>,
    travels: String,
    pen: u8,
    down: Pen,
    at: Point,
    /// The line in progress: where it began, the directions that pass all its places, and the way to the
    /// farthest of them.
    from: Point,
    cone: Option<(Vec2, Vec2)>,
    reach_mm: f64,
    /// Whether the path in progress has its beginning.
    is_begun: bool,
    least: Point,
    most: Point,
}

impl SteppedPreview {
    /// A pen that is up at `at`.
    #[must_use]
    pub fn new(at: Point, tolerance_mm: f64) -> Self {
        Self {
            tolerance_mm,
            pens: BTreeMap::new(),
            travels: String::new(),
            pen: 1,
            down: Pen::Up,
            at,
            from: at,
            cone: None,
            reach_mm: 0.0,
            is_begun: false,
            least: at,
            most: at,
        }
    }

    /// From here on the pen is up or down.
    pub fn put(&mut self, pen: Pen) {
        if self.down != pen {
            self.end_path();
            self.down = pen;
            if pen == Pen::Down {
                self.vertex(self.at);
            }
        }
    }

    /// Another pen is taken.
    pub fn select(&mut self, pen: u8) {
        self.put(Pen::Up);
        self.pen = pen;
    }

    /// The pen goes to the next place.
    pub fn step(&mut self, to: Point) {
        if !self.is_begun {
            self.vertex(self.at);
        }
        let way = to - self.from;
        let length_mm = way.length();
        if length_mm > self.tolerance_mm {
            // Directions whose line passes no farther than the tolerance from the place.
            let half_rad = libm::asin(self.tolerance_mm / length_mm);
            let cone = (way.rotated(-half_rad), way.rotated(half_rad));
            let joint = match self.cone {
                None => Some(cone),
                Some((right, left)) => {
                    let right = if right.cross(cone.0) > 0.0 { cone.0 } else { right };
                    let left = if left.cross(cone.1) < 0.0 { cone.1 } else { left };
                    let within = right.cross(way) >= 0.0 && way.cross(left) >= 0.0 && right.dot(way) > 0.0;
                    (within && length_mm > self.reach_mm - self.tolerance_mm).then_some((right, left))
                }
            };
            self.reach_mm = self.reach_mm.max(length_mm);
            if joint.is_none() {
                self.vertex(self.at);
                self.at = to;
                return;
            }
            self.cone = joint;
        } else if self.reach_mm > 2.0 * self.tolerance_mm {
            self.vertex(self.at);
        }
        self.at = to;
    }

    fn vertex(&mut self, place: Point) {
        self.least = Point::new(self.least.x.min(place.x), self.least.y.min(place.y));
        self.most = Point::new(self.most.x.max(place.x), self.most.y.max(place.y));
        let path = match self.down {
            Pen::Up => &mut self.travels,
            Pen::Down => self.pens.entry(self.pen).or_default(),
        };
        let letter = if std::mem::replace(&mut self.is_begun, true) { 'L' } else { 'M' };
        // The picture's y runs down.
        let _ = write!(path, "{letter}{:.3} {:.3}", place.x, -place.y);
        self.from = place;
        self.cone = None;
        self.reach_mm = 0.0;
    }

    fn end_path(&mut self) {
        if self.is_begun {
            self.vertex(self.at);
            self.is_begun = false;
            if self.down == Pen::Up {
                self.travels.push('\n');
            } else if let Some(path) = self.pens.get_mut(&self.pen) {
                path.push('\n');
            }
        }
    }

    /// The picture in mm, with the machine's area as its frame.
    #[must_use]
    pub fn to_svg(mut self, title: &str, area: AreaConfig, colours: &[[u8; 3]]) -> String {
        self.end_path();
        let left = self.least.x.min(0.0) - MARGIN_MM;
        let bottom = self.least.y.min(0.0) - MARGIN_MM;
        let width = self.most.x.max(area.width_mm) + MARGIN_MM - left;
        let top = self.most.y.max(area.height_mm) + MARGIN_MM;
        let height = top - bottom;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.3}mm\" height=\"{height:.3}mm\" \
             viewBox=\"{left:.3} {:.3} {width:.3} {height:.3}\">\n<title>{}</title>\n",
            -top,
            crate::shared::escaped(title)
        );
        let _ = writeln!(
            svg,
            "<rect x=\"{left:.3}\" y=\"{:.3}\" width=\"{width:.3}\" height=\"{height:.3}\" fill=\"#eceff1\"/>",
            -top
        );
        let _ = writeln!(
            svg,
            "<rect id=\"area\" x=\"0\" y=\"{:.3}\" width=\"{:.3}\" height=\"{:.3}\" fill=\"#fff\" stroke=\"#90a4ae\" \
             stroke-width=\"0.4\"/>",
            -area.height_mm, area.width_mm, area.height_mm
        );
        let _ = writeln!(
            svg,
            "<path id=\"travel\" fill=\"none\" stroke=\"#f57c00\" stroke-width=\"0.15\" stroke-dasharray=\"1.2 0.9\" \
             d=\"{}\"/>",
            self.travels
        );
        for (pen, path) in &self.pens {
            let _ = writeln!(
                svg,
                "<path id=\"pen-{pen}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{PEN_MM}\" stroke-linecap=\"round\" \
                 stroke-linejoin=\"round\" d=\"{path}\"/>",
                pen_colour(*pen, colours)
            );
        }
        svg.push_str("</svg>\n");
        svg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn preview(places: &[(i32, i32)]) -> String {
        let mut preview = SteppedPreview::new(Point::ORIGIN, 0.01);
        preview.put(Pen::Down);
        for &(x, y) in places {
            preview.step(Point::new(0.01 * f64::from(x), 0.01 * f64::from(y)));
        }
        preview.put(Pen::Up);
        preview.pens.get(&1).cloned().unwrap_or_default()
    }

    #[test]
    fn steps_become_lines_and_ways_back_stay() {
        let there: Vec<(i32, i32)> = (1..=100).map(|x| (x, 0)).collect();
        assert_eq!(preview(&there), "M0.000 -0.000L1.000 -0.000\n");
        let back: Vec<(i32, i32)> = there.iter().copied().chain((50..100).rev().map(|x| (x, 0))).collect();
        let text = preview(&back);
        assert!(text.contains("L1.000 ") || text.contains("L0.990 "), "{text}");
        assert!(text.ends_with("L0.500 -0.000\n"), "{text}");
        let stairs: Vec<(i32, i32)> = (1..=100).map(|x| (x, x / 3)).collect();
        assert!(preview(&stairs).matches('L').count() <= 2, "{}", preview(&stairs));
        assert_eq!(preview(&[]), "M0.000 -0.000L0.000 -0.000\n", "a dot");
    }

    #[test]
    fn corners_stay() {
        let corner: Vec<(i32, i32)> = (1..=100).map(|x| (x, 0)).chain((1..=100).map(|y| (100, y))).collect();
        // The corner may be missed by a step, which is the tolerance.
        assert_eq!(preview(&corner), "M0.000 -0.000L1.000 -0.010L1.000 -1.000\n");
    }
}
