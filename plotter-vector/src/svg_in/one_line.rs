//! [`parted`]: contours of letters that go along a line and back on it: the letters of fonts for pens, which
//! are lines, and not areas.
//!
//! A font has closed contours only, so one for pens and cutters goes back where it came, and a pen that
//! follows it draws every line twice. Each segment that the next one, or what is left of those before it,
//! takes back again is one line:
//!
//! ```text
//!   a ──▶ b ──▶ c ──▶ b ──▶ d ──▶ b ──▶ a        lines: a b c, b d
//!               └─ back ─┘     └── back ──┘
//! ```
//!
//! When nothing is left at the end, the contour has no area, wherever it begins.

use usvg::tiny_skia_path::{Path, PathBuilder, PathSegment, Point};

/// How far the way back may be from the way forth, and how large a dot may be, ems. The thinnest stems of
/// letters that are areas are some ten times as wide.
#[cfg(feature = "svg-text")]
pub(super) const SLACK_EM: f32 = 0.001;

/// A segment of a contour: its ends and handles.
#[derive(Clone, Copy)]
struct ContourSegment {
    from: Point,
    handles: [Option<Point>; 2],
    to: Point,
}

impl ContourSegment {
    /// Whether it is the other one backwards.
    fn takes_back(&self, other: &Self, slack: f32) -> bool {
        let near = |a: Option<Point>, b: Option<Point>| match (a, b) {
            (Some(a), Some(b)) => a.distance(b) <= slack,
            (a, b) => a.is_none() && b.is_none(),
        };
        let [first, second] = self.handles;
        // Of one handle, which is the first, the way back has the same.
        let [last, before] =
            if other.handles[1].is_some() { [other.handles[1], other.handles[0]] } else { other.handles };
        near(Some(self.from), Some(other.to))
            && near(Some(self.to), Some(other.from))
            && near(first, last)
            && near(second, before)
    }

    fn is_short(&self, slack: f32) -> bool {
        let near = |at: Point| at.distance(self.from) <= slack;
        near(self.to) && self.handles.iter().flatten().all(|handle| near(*handle))
    }

    fn add_to(&self, path: &mut PathBuilder) {
        let to = self.to;
        match self.handles {
            [None, _] => path.line_to(to.x, to.y),
            [Some(handle), None] => path.quad_to(handle.x, handle.y, to.x, to.y),
            [Some(first), Some(second)] => path.cubic_to(first.x, first.y, second.x, second.y, to.x, to.y),
        }
    }
}

/// The outlines and the lines of a text's path, where it has any lines; a dot is a line from its place to its
/// place. `slack` is a length in the path's own unit.
pub(super) fn parted(path: &Path, slack: f32) -> Option<(Option<Path>, Path)> {
    let (mut outlines, mut lines) = (PathBuilder::new(), PathBuilder::new());
    let mut contour: Vec<ContourSegment> = Vec::new();
    let mut start = None;
    let mut end = |contour: &mut Vec<ContourSegment>| {
        let Some(first) = contour.first().map(|segment| segment.from) else { return };
        if let Some(closing) =
            contour.last().map(|last| ContourSegment { from: last.to, handles: [None; 2], to: first })
        {
            contour.push(closing);
        }
        if !add_lines(contour, slack, &mut lines) {
            outlines.move_to(first.x, first.y);
            contour.pop();
            contour.iter().for_each(|segment| segment.add_to(&mut outlines));
            outlines.close();
        }
        contour.clear();
    };
    for segment in path.segments() {
        let from = contour.last().map(|segment| segment.to).or(start);
        let segment = match (segment, from) {
            (PathSegment::MoveTo(to), _) => {
                end(&mut contour);
                start = Some(to);
                continue;
            }
            (PathSegment::Close, _) | (_, None) => {
                end(&mut contour);
                continue;
            }
            (PathSegment::LineTo(to), Some(from)) => ContourSegment { from, handles: [None; 2], to },
            (PathSegment::QuadTo(handle, to), Some(from)) => {
                ContourSegment { from, handles: [Some(handle), None], to }
            }
            (PathSegment::CubicTo(first, second, to), Some(from)) => {
                ContourSegment { from, handles: [Some(first), Some(second)], to }
            }
        };
        contour.push(segment);
    }
    end(&mut contour);
    Some((outlines.finish(), lines.finish()?))
}

/// Adds the lines of a closed contour that has no area; of one that has, nothing.
fn add_lines(contour: &[ContourSegment], slack: f32, lines: &mut PathBuilder) -> bool {
    let mut forth: Vec<ContourSegment> = Vec::new();
    // The segments that are lines, and whether each goes on where the one before it ended.
    let mut found: Vec<(ContourSegment, bool)> = Vec::new();
    let mut goes_on = false;
    for segment in contour.iter().filter(|segment| !segment.is_short(slack)) {
        if forth.last().is_some_and(|last| segment.takes_back(last, slack)) {
            forth.pop();
            goes_on = false;
        } else {
            forth.push(*segment);
            found.push((*segment, goes_on));
            goes_on = true;
        }
    }
    if !forth.is_empty() {
        return false;
    }
    for (segment, goes_on) in &found {
        if !goes_on {
            lines.move_to(segment.from.x, segment.from.y);
        }
        segment.add_to(lines);
    }
    if let (true, Some(dot)) = (found.is_empty(), contour.first().map(|segment| segment.from)) {
        lines.move_to(dot.x, dot.y);
        lines.line_to(dot.x, dot.y);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Paths as they are written, by places of whole numbers.
    fn path(text: &str) -> Path {
        let mut path = PathBuilder::new();
        for word in text.split(' ') {
            let numbers: Vec<f32> =
                word.get(1..).unwrap().split(',').filter_map(|word| word.parse().ok()).collect();
            match (word.as_bytes()[0], &numbers[..]) {
                (b'M', [x, y]) => path.move_to(*x, *y),
                (b'L', [x, y]) => path.line_to(*x, *y),
                (b'Q', [a, b, x, y]) => path.quad_to(*a, *b, *x, *y),
                (b'C', [a, b, c, d, x, y]) => path.cubic_to(*a, *b, *c, *d, *x, *y),
                _ => path.close(),
            }
        }
        path.finish().unwrap()
    }

    fn written(path: &Path) -> String {
        let at = |at: Point| format!("{},{}", at.x, at.y);
        let word = |segment| match segment {
            PathSegment::MoveTo(to) => format!("M{}", at(to)),
            PathSegment::LineTo(to) => format!("L{}", at(to)),
            PathSegment::QuadTo(handle, to) => format!("Q{},{}", at(handle), at(to)),
            PathSegment::CubicTo(first, second, to) => format!("C{},{},{}", at(first), at(second), at(to)),
            PathSegment::Close => "Z".to_owned(),
        };
        path.segments().map(word).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn what_is_taken_back_is_a_line() {
        let rows = [
            // Forth and back, as it is written and beside it.
            ("M0,0 L9,0 L9,9 L9,0 Z", "M0,0 L9,0 L9,9"),
            ("M0,0 L9,0 L9,9 L9.1,9.1 L9.1,0.1 L0.1,0.1 Z", "M0,0 L9,0 L9,9"),
            ("M0,0 L9,0 L9,9 L9,0 L0,0", "M0,0 L9,0 L9,9"),
            // Begun in the middle; with an arm.
            ("M5,0 L9,0 L5,0 L0,0 Z", "M5,0 L9,0 M5,0 L0,0"),
            ("M0,0 L5,0 L9,0 L5,0 L5,7 L5,0 Z", "M0,0 L5,0 L9,0 M5,0 L5,7"),
            // Round and round again the other way.
            ("M0,0 L9,0 L9,9 L0,0 L9,9 L9,0 Z", "M0,0 L9,0 L9,9 L0,0"),
            ("M0,0 Q4,4,8,0 Q4,4,0,0 Z", "M0,0 Q4,4,8,0"),
            ("M0,0 C1,4,7,5,8,0 C7,5,1,4,0,0 Z", "M0,0 C1,4,7,5,8,0"),
            // Dots.
            ("M3,4 L3,4 Z", "M3,4 L3,4"),
            ("M3,4 L3.1,4.1 Z", "M3,4 L3,4"),
        ];
        for (text, expected) in rows {
            let (outlines, lines) = parted(&path(text), 0.2).unwrap();
            assert_eq!((outlines, written(&lines).as_str()), (None, expected), "{text}");
        }
    }

    #[test]
    fn what_has_an_area_stays_an_outline() {
        for text in [
            "M0,0 L9,0 L9,9 Z",
            "M0,0 L9,0 L9,0.5 L0,0.5 Z",
            "M0,0 Q4,4,8,0 Q4,-4,0,0 Z",
            "M0,0 Q4,4,8,0 Z",
            "M0,0 C1,4,7,5,8,0 C1,4,7,5,0,0 Z",
            "M0,0 L9,0 L9,9 L0,0 L9,0 L9,9 Z",
        ] {
            assert_eq!(parted(&path(text), 0.2), None, "{text}");
        }
        let (outlines, lines) =
            parted(&path("M0,0 L9,0 L9,9 Z M20,0 L30,0 Z M40,0 L50,0 L50,5 Z"), 0.2).unwrap();
        assert_eq!(written(&outlines.unwrap()), "M0,0 L9,0 L9,9 Z M40,0 L50,0 L50,5 Z");
        assert_eq!(written(&lines), "M20,0 L30,0");
    }
}
