//! [`Command`]: the letters of a command, and what is done with it in either language.

use super::Dialect;
use core::fmt;

/// The one or two signs that name a command.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Command {
    letters: [u8; 2],
    meaning: &'static str,
}

impl Command {
    /// One that is in no table.
    pub(super) const fn unknown(first: u8, second: Option<u8>) -> Self {
        let second = match second {
            Some(second) => second,
            None => 0,
        };
        Self { letters: [first, second], meaning: "unknown" }
    }

    /// Effect of the command, in a few words.
    ///
    /// ```
    /// # use plotter_motion::hpgl::cutter::{Dialect, Problem, plot_ops};
    /// let said = plot_ops(b"N3\n", Dialect::CammGl).find_map(Result::err);
    /// let Some(Problem::LeftOut { command, .. }) = said.map(|said| said.problem) else { panic!() };
    /// assert_eq!((command.to_string(), command.meaning()), ("N".to_string(), "mark"));
    /// ```
    #[must_use]
    pub const fn meaning(&self) -> &'static str {
        self.meaning
    }
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.letters
            .iter()
            .filter(|letter| **letter != 0)
            .try_for_each(|letter| write!(f, "{}", char::from(*letter)))
    }
}

impl fmt::Debug for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Command({self})")
    }
}

/// What is done with a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// Goes to one place after the other.
    Path {
        draws: bool,
        relative: bool,
        polar: bool,
    },
    Home,
    Pen,
    /// The origin of what follows.
    Origin,
    /// The centre of what [`Form::ArcAbout`] draws.
    Centre,
    ArcAbout,
    /// Centre, radius or radii, angles.
    Circle,
    /// The same without its centre.
    CircleFrom,
    Bezier,
    LineType,
    /// Characters up to the end of the line.
    Text,
    LeftOut(&'static str),
    Setting,
    /// A command that begins with `!` or `^` in CAMM-GL, up to `;` or the end of the line.
    Rest(&'static str),
    /// Nothing of it would be seen.
    Quiet,
}

/// An entry of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) command: Command,
    pub(super) form: Form,
    /// Where it stands in the table, for what is said once.
    pub(super) index: usize,
}

/// The entry of these signs in upper case; the second one only for commands of two.
pub(super) fn entry(dialect: Dialect, first: u8, second: Option<u8>) -> Option<Entry> {
    let table = if dialect.is_gp_gl() { GP_GL } else { CAMM_GL };
    let letters = [first, second.unwrap_or(0)];
    let index = table.iter().position(|(of, ..)| of[..] == letters)?;
    let (letters, meaning, form) = *table.get(index)?;
    Some(Entry { command: Command { letters: *letters, meaning }, form, index })
}

const fn path(draws: bool, relative: bool, polar: bool) -> Form {
    Form::Path { draws, relative, polar }
}

const AS_LINES: &str = "have the program write it as lines (D)";
const AS_OUTLINES: &str = "have the program turn its letters into lines (D)";
const IN_PLACES: &str = "have the program write places as they are on the sheet";
const AS_HPGL: &str = "have the program write one language, HPGL or this";
const OF_SOME: &str =
    "its meaning depends on the model: if something is missing, have the program write HPGL";

type Row = (&'static [u8; 2], &'static str, Form);

/// Roland's CAMM-GL mode 1 (CAMM-1, CAMM-2 and CAMM-3) and DXY-GL.
const CAMM_GL: &[Row] = &[
    (b"D\0", "draw to places", path(true, false, false)),
    (b"M\0", "move to places", path(false, false, false)),
    (b"I\0", "draw along ways", path(true, true, false)),
    (b"R\0", "move along ways", path(false, true, false)),
    (b"H\0", "home", Form::Home),
    (b"J\0", "take a pen", Form::Pen),
    (b"C\0", "circle", Form::Circle),
    (b"E\0", "circle from where the pen is", Form::CircleFrom),
    (b"A\0", "centre of arcs", Form::Centre),
    (b"G\0", "arc about the centre", Form::ArcAbout),
    (b"L\0", "line type", Form::LineType),
    (b"B\0", "length of the line type", Form::Quiet),
    (b"P\0", "print letters", Form::Text),
    (b"S\0", "size of letters", Form::Quiet),
    (b"Q\0", "direction of letters", Form::Quiet),
    (b"N\0", "mark", Form::LeftOut(AS_LINES)),
    (b"X\0", "axis with ticks", Form::LeftOut(AS_LINES)),
    (b"K\0", "share of a circle", Form::LeftOut(AS_LINES)),
    (b"T\0", "hatching", Form::LeftOut(AS_LINES)),
    (b"Y\0", "curve through places", Form::LeftOut(AS_LINES)),
    (b"_\0", "curve along ways", Form::LeftOut(AS_LINES)),
    (b"Z\0", "move in three axes", Form::LeftOut("have the program write flat paths, M and D")),
    (b"U\0", "setting of some models", Form::LeftOut(OF_SOME)),
    (b"O\0", "setting of some models", Form::LeftOut(OF_SOME)),
    (b"F\0", "speed", Form::Setting),
    (b"V\0", "speed of the tool's axis", Form::Setting),
    (b"W\0", "wait", Form::Setting),
    (b"@\0", "heights of the tool", Form::Setting),
    (b"!\0", "setting of the machine, as force, tool or speed", Form::Rest("")),
    (b"^\0", "command of mode 2", Form::Rest(AS_HPGL)),
];

/// Graphtec's GP-GL.
const GP_GL: &[Row] = &[
    (b"D\0", "draw to places", path(true, false, false)),
    (b"M\0", "move to places", path(false, false, false)),
    (b"E\0", "draw along ways", path(true, true, false)),
    (b"O\0", "move along ways", path(false, true, false)),
    (b"DP", "draw to places, polar", path(true, false, true)),
    (b"MP", "move to places, polar", path(false, false, true)),
    (b"EP", "draw along ways, polar", path(true, true, true)),
    (b"OP", "move along ways, polar", path(false, true, true)),
    (b"H\0", "home", Form::Home),
    (b"J\0", "take a pen", Form::Pen),
    (b"W\0", "circle", Form::Circle),
    (b"]\0", "circle from where the pen is", Form::CircleFrom),
    (b"BZ", "cubic curve", Form::Bezier),
    (b"^\0", "offset of the origin", Form::Origin),
    (b"L\0", "line type", Form::LineType),
    (b"B\0", "length of the line type", Form::Quiet),
    (b"P\0", "print letters", Form::Text),
    (b"K\0", "print letters of another alphabet", Form::Text),
    (b"N\0", "mark", Form::LeftOut(AS_LINES)),
    (b"SP", "mark at each place", Form::LeftOut(AS_LINES)),
    (b"RP", "rays", Form::LeftOut(AS_LINES)),
    (b"RC", "letters again at places", Form::LeftOut(AS_OUTLINES)),
    (b"(\0", "pattern", Form::LeftOut(AS_LINES)),
    (b"WP", "circle through three places", Form::LeftOut(AS_LINES)),
    (b"Y\0", "curve through places", Form::LeftOut(AS_LINES)),
    (b"_\0", "curve along ways", Form::LeftOut(AS_LINES)),
    (b")\0", "ellipse", Form::LeftOut(AS_LINES)),
    (b"^P", "offset of the origin, polar", Form::LeftOut(IN_PLACES)),
    (b"/\0", "rotation of the drawing", Form::LeftOut(IN_PLACES)),
    (b"&\0", "scale of the drawing", Form::LeftOut(IN_PLACES)),
    (b">\0", "area that is drawn on", Form::LeftOut(IN_PLACES)),
    (b"FN", "orientation of the sheet", Form::LeftOut("turn the drawing if it lies across")),
    (b"!\0", "speed", Form::Setting),
    (b"*\0", "acceleration and force", Form::Setting),
    (b"FX", "force", Form::Setting),
    (b"FC", "offset of the blade", Form::Setting),
    (b"FD", "rotation of the blade", Form::Setting),
    (b"TB", "registration marks", Form::Setting),
    (b"F\0", "feed of the sheet", Form::Setting),
    (b"$\0", "font", Form::Quiet),
    (b"S\0", "size of letters", Form::Quiet),
    (b"Q\0", "room between letters", Form::Quiet),
    (b"R\0", "direction of letters", Form::Quiet),
    (b"I\0", "slant of letters", Form::Quiet),
    (b"LP", "origin of letters", Form::Quiet),
    (b"A\0", "letters as at the start", Form::Quiet),
    (b"\\\0", "lower left corner", Form::Quiet),
    (b"Z\0", "upper right corner", Form::Quiet),
    (b"SO", "origin", Form::Quiet),
    (b"T\0", "buzzer", Form::Quiet),
    (b"G\0", "question", Form::Quiet),
    (b"C\0", "question", Form::Quiet),
    (b"U\0", "question", Form::Quiet),
    (b"V\0", "question", Form::Quiet),
    (b"?\0", "question", Form::Quiet),
    (b"[\0", "question", Form::Quiet),
    (b"@\0", "question", Form::Quiet),
    (b"#\0", "question", Form::Quiet),
    (b"=\0", "terminators of answers", Form::Quiet),
    (b"\"\0", "error mask", Form::Quiet),
    (b":\0", "clear", Form::Quiet),
    (b"FA", "page", Form::Quiet),
    (b"FE", "lift between paths", Form::Quiet),
    (b"FG", "question", Form::Quiet),
    (b"FM", "page", Form::Quiet),
    (b"FO", "feed of the sheet", Form::Quiet),
    (b"FQ", "question", Form::Quiet),
    (b"FU", "size of the page", Form::Quiet),
    (b"FW", "kind of sheet", Form::Quiet),
    (b"FY", "track enhancing", Form::Quiet),
    (b"TT", "home of the machine", Form::Quiet),
];

/// Most entries of a table: each has a bit in what has been said.
pub(super) const MOST_ENTRIES: usize = 128;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_name_nothing_twice_and_have_a_bit_for_each() {
        for table in [CAMM_GL, GP_GL] {
            assert!(table.len() <= MOST_ENTRIES);
            for (index, (letters, ..)) in table.iter().enumerate() {
                assert!(table.iter().skip(index + 1).all(|(other, ..)| other != letters), "{letters:?}");
            }
        }
    }
}
