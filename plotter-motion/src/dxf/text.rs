//! [`Text`]: texts of a drawing, set in the single-line font of HPGL's labels.

use super::frame::{Frame, Vec3};
use crate::drawing::affine::sin_cos;
use crate::hpgl::{LETTER_ADVANCE, LETTER_HEIGHT, LETTER_WIDTH, letter_strokes};
use crate::{Point, Vec2};
use alloc::string::String;
use alloc::vec::Vec;

/// From line to line of a text of several, in heights of a letter.
///
/// Source: Autodesk, *DXF Reference*, MTEXT, group 44: three to five is the default.
const LINE_PITCH: f64 = 5.0 / 3.0;
/// Most letters of one text.
const MOST_LETTERS: usize = 1 << 20;

/// Where a text stands along its line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Along {
    #[default]
    Left,
    Middle,
    Right,
    /// Between two places, as high as it then is.
    Aligned,
    /// Between two places, as high as it says.
    Fit,
}

/// Where a text stands across its line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Across {
    #[default]
    Baseline,
    Bottom,
    Middle,
    Top,
}

/// One or more lines of letters.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Text {
    /// In the axes of its plane.
    pub(super) at: Vec3,
    /// The other end of a text between two places.
    pub(super) to: Option<Vec3>,
    pub(super) height: f64,
    pub(super) turned_rad: f64,
    /// How much wider letters are.
    pub(super) width_factor: f64,
    pub(super) slant_rad: f64,
    pub(super) is_backward: bool,
    pub(super) is_upside_down: bool,
    pub(super) along: Along,
    pub(super) across: Across,
    /// From line to line, as a share of what is usual.
    pub(super) pitch: f64,
    pub(super) lines: Vec<String>,
}

impl Text {
    /// Its strokes as places in its plane, and the letters that the font does not have.
    pub(super) fn strokes(&self, missing: &mut impl FnMut(char)) -> Vec<Vec<Point>> {
        let step = self.height / LETTER_HEIGHT;
        let pitch_steps = LETTER_HEIGHT * LINE_PITCH * self.pitch;
        let count = self.lines.len();
        #[expect(clippy::cast_precision_loss, reason = "lines of a text")]
        let high = LETTER_HEIGHT + pitch_steps * count.saturating_sub(1) as f64;
        let first_y = match self.across {
            Across::Baseline => 0.0,
            // Below the line lie the descenders, a third of a capital letter.
            Across::Bottom => high - LETTER_HEIGHT,
            Across::Middle => 0.5 * high - LETTER_HEIGHT,
            Across::Top => -LETTER_HEIGHT,
        };
        let mut turn = self.turned_rad;
        let (mut across, mut along) = (step, step * self.width_factor);
        if let (Along::Aligned | Along::Fit, Some(to)) = (self.along, self.to) {
            let way = Vec2::new(to.x - self.at.x, to.y - self.at.y);
            let width = self.lines.first().map_or(0.0, |line| width_steps(line));
            if way.length() > 0.0 && width > 0.0 {
                turn = libm::atan2(way.y, way.x);
                along = way.length() / width;
                if self.along == Along::Aligned {
                    across = along / self.width_factor;
                }
            }
        }
        let sign = |is_turned: bool| if is_turned { -1.0 } else { 1.0 };
        along *= sign(self.is_backward);
        across *= sign(self.is_upside_down);
        let (sin, cos) = sin_cos(turn);
        let tangent = libm::tan(self.slant_rad);
        let origin = Point::new(self.at.x, self.at.y);
        let place = |x: f64, y: f64| {
            let way = Vec2::new(x * along + y * across * tangent, y * across);
            origin + Vec2::new(way.x * cos - way.y * sin, way.x * sin + way.y * cos)
        };
        let mut strokes = Vec::new();
        let mut y = first_y;
        let mut letters = 0;
        for line in &self.lines {
            let mut x = match self.along {
                Along::Middle => -0.5 * width_steps(line),
                Along::Right => -width_steps(line),
                _ => 0.0,
            };
            for letter in line.chars() {
                letters += 1;
                if letters > MOST_LETTERS {
                    return strokes;
                }
                match letter_strokes(letter).or_else(|| letter_strokes(similar(letter)?)) {
                    Some(letter) => strokes.extend(
                        letter.map(|stroke| stroke.map(|at| place(x + at.x, y + at.y)).collect::<Vec<_>>()),
                    ),
                    None => missing(letter),
                }
                x += LETTER_ADVANCE;
            }
            y -= pitch_steps;
        }
        strokes
    }

    /// Breaks its lines where they are wider than `width`, at blanks.
    pub(super) fn wrap(&mut self, width: f64) {
        let step = self.height / LETTER_HEIGHT * self.width_factor;
        if width <= 0.0 || step <= 0.0 {
            return;
        }
        let mut wrapped = Vec::new();
        for line in &self.lines {
            let mut row = String::new();
            for word in line.split(' ') {
                let longer = if row.is_empty() { String::from(word) } else { alloc::format!("{row} {word}") };
                if width_steps(&longer) * step > width && !row.is_empty() {
                    wrapped.push(core::mem::replace(&mut row, String::from(word)));
                } else {
                    row = longer;
                }
            }
            wrapped.push(row);
        }
        self.lines = wrapped;
    }

    /// Its axes, for one whose x axis is said as a direction.
    pub(super) fn turned_to(&mut self, direction: Vec3, axes: &Frame) {
        let dot = |a: Vec3| a.x * direction.x + a.y * direction.y + a.z * direction.z;
        self.turned_rad = libm::atan2(dot(axes.y), dot(axes.x));
    }
}

/// From the left of the first letter to the right of the last, in steps.
fn width_steps(line: &str) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "letters of a line")]
    let count = line.chars().count() as f64;
    if count > 0.0 { count * LETTER_ADVANCE - (LETTER_ADVANCE - LETTER_WIDTH) } else { 0.0 }
}

/// What stands for letters of typographers that the font does not have.
fn similar(letter: char) -> Option<char> {
    Some(match letter {
        '‘' | '’' | '‚' | '′' => '\'',
        '“' | '”' | '„' | '″' => '"',
        '–' | '—' | '−' | '‐' | '‑' => '-',
        '•' | '∙' => '·',
        '⌀' | '∅' | 'Ф' => 'Ø',
        '\t' | '\u{2003}' | '\u{2009}' | '\u{202f}' => ' ',
        '×' => '×',
        'Ω' => 'O',
        _ => return None,
    })
}

/// The letters of a text of one line: `%%d`, `%%p`, `%%c`, `%%nnn`, `\U+nnnn`; lines under and over it
/// (`%%u`, `%%o`, `%%k`) are left out.
pub(super) fn plain(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some(letter) = rest.chars().next() {
        if let Some(code) = rest.strip_prefix("%%") {
            let digits: String = code.chars().take(3).take_while(char::is_ascii_digit).collect();
            if digits.len() == 3 {
                plain.extend(digits.parse().ok().and_then(char::from_u32));
                rest = code.get(3..).unwrap_or("");
                continue;
            }
            if let Some(kind) = code.chars().next() {
                match kind.to_ascii_lowercase() {
                    'd' => plain.push('°'),
                    'p' => plain.push('±'),
                    'c' => plain.push('Ø'),
                    '%' => plain.push('%'),
                    'u' | 'o' | 'k' => {}
                    _ => plain.push(kind),
                }
                rest = code.get(kind.len_utf8()..).unwrap_or("");
                continue;
            }
        }
        if let Some((letter, after)) = unicode(rest) {
            plain.push(letter);
            rest = after;
            continue;
        }
        plain.push(letter);
        rest = rest.get(letter.len_utf8()..).unwrap_or("");
    }
    plain
}

/// `\U+nnnn` and what follows it.
fn unicode(text: &str) -> Option<(char, &str)> {
    let code = text.strip_prefix("\\U+").or_else(|| text.strip_prefix("\\u+"))?;
    let letter = char::from_u32(u32::from_str_radix(code.get(..4)?, 16).ok()?)?;
    Some((letter, code.get(4..)?))
}

/// The lines of a text with formats: paragraphs stay, fractions are written with a stroke, other formats are
/// without effect.
///
/// Source: Autodesk, *AutoCAD Customization Guide*, "Format codes for multiline text".
pub(super) fn lines(text: &str) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    let mut rest = text;
    while let Some(letter) = rest.chars().next() {
        if let Some((letter, after)) = unicode(rest) {
            line.push(letter);
            rest = after;
            continue;
        }
        let after = rest.get(letter.len_utf8()..).unwrap_or("");
        rest = after;
        match letter {
            '{' | '}' => {}
            '^' => {
                // Control characters: ^J is a new line, ^I a tabulator; "^ " is the sign itself.
                let control = after.chars().next();
                match control {
                    Some('J' | 'j') => lines.push(core::mem::take(&mut line)),
                    Some('I' | 'i') => line.push(' '),
                    Some(' ') | None => line.push('^'),
                    Some('M' | 'm') => {}
                    Some(other) => {
                        line.push('^');
                        line.push(other);
                    }
                }
                rest = control.and_then(|control| after.get(control.len_utf8()..)).unwrap_or("");
            }
            '\\' => {
                let Some(code) = after.chars().next() else { break };
                rest = after.get(code.len_utf8()..).unwrap_or("");
                match code {
                    'P' | 'N' | 'X' => lines.push(core::mem::take(&mut line)),
                    '~' => line.push(' '),
                    '\\' | '{' | '}' => line.push(code),
                    'S' => {
                        let (stack, behind) = rest.split_once(';').unwrap_or((rest, ""));
                        line.extend(stack.chars().filter_map(|sign| match sign {
                            '^' | '#' => Some('/'),
                            '\\' | ' ' => None,
                            sign => Some(sign),
                        }));
                        rest = behind;
                    }
                    'A' | 'C' | 'c' | 'F' | 'f' | 'H' | 'Q' | 'T' | 'W' | 'p' => {
                        rest = rest.split_once(';').map_or("", |(_, behind)| behind);
                    }
                    // Lines under, over and through it.
                    'L' | 'l' | 'O' | 'o' | 'K' | 'k' => {}
                    other => line.push(other),
                }
            }
            '\n' => lines.push(core::mem::take(&mut line)),
            letter => line.push(letter),
        }
    }
    lines.push(line);
    for line in &mut lines {
        *line = plain(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    #[test]
    fn signs_of_single_lines() {
        assert_eq!(plain("90%%d %%p0.1 %%c20 %%uA%%u 50%%% %%065 \\U+00E9"), "90° ±0.1 Ø20 A 50% A é");
        assert_eq!(plain("100%"), "100%");
    }

    #[test]
    fn formats_of_several_lines_leave_the_letters() {
        assert_eq!(lines("{\\fArial|b0;one}\\Ptwo\\~2"), ["one", "two 2"]);
        assert_eq!(lines("\\H2.5x;\\S1^ 2; \\A1;\\C1;x\\\\y %%d"), ["1/2 x\\y °"]);
        assert_eq!(lines(""), [""]);
        assert_eq!(lines("a\\"), ["a"]);
    }

    fn of(line: &str) -> Text {
        Text {
            height: 12.0,
            width_factor: 1.0,
            pitch: 1.0,
            lines: vec![String::from(line)],
            ..Text::default()
        }
    }

    #[test]
    fn a_text_is_as_high_as_it_says_and_stands_where_it_says() {
        let mut missing = vec![];
        let left = of("L").strokes(&mut |letter| missing.push(letter));
        assert_eq!(left, [[Point::new(0.0, 12.0), Point::new(0.0, 0.0), Point::new(8.0, 0.0)]]);
        let middle = Text { along: Along::Middle, across: Across::Middle, ..of("L") };
        assert_eq!(
            middle.strokes(&mut |_| {}),
            [[Point::new(-4.0, 6.0), Point::new(-4.0, -6.0), Point::new(4.0, -6.0)]]
        );
        // Two letters are 20 steps wide: between places 40 apart they are twice as large.
        let fit = Text { along: Along::Aligned, to: Some(Vec3::new(0.0, 40.0, 0.0)), ..of("LL") };
        let strokes = fit.strokes(&mut |_| {});
        assert!(strokes[1][2].distance(Point::new(0.0, 40.0)) < 1e-9, "{strokes:?}");
        assert!(strokes[0][0].distance(Point::new(-24.0, 0.0)) < 1e-9, "{strokes:?}");
        of("→").strokes(&mut |letter| missing.push(letter));
        assert_eq!(missing, ['→']);
    }

    #[test]
    fn long_lines_are_broken_at_blanks() {
        let mut text = of("one two three");
        text.wrap(90.0);
        assert_eq!(text.lines, ["one two", "three"]);
        text.wrap(0.0);
        assert_eq!(text.lines.len(), 2);
    }
}
