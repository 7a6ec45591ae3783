//! [`font_file`]: the letters of HPGL's labels as a TrueType font, so that texts are set in them as in any
//! other.
//!
//! A font's contours are closed, the strokes of these letters are not: each becomes a contour that goes along
//! the stroke and comes back a hair beside it. Whoever draws the text takes such contours for strokes again
//! (see [`one_line`](super::one_line)).
//!
//! ```text
//!   p0 ●───────● p1      forth by the stroke's own places, back beside them:
//!      ○─────┐ │         a letter as the hyphen has a height then, and a text
//!            │ │         of nothing else is not taken for empty
//!            ○ ● p2
//! ```
//!
//! Source: OpenType specification 1.9, chapters of the tables by their names.

use plotter_motion::Point;
use plotter_motion::hpgl::letter_strokes;

/// Name of the family whose letters are as wide as they are.
pub(super) const FAMILY: &str = "Single Stroke";
/// Name of the family whose letters are equally wide.
pub(super) const MONOSPACED: &str = "Single Stroke Mono";

/// Units to the em. Capitals, 12 steps high, have 0.7 em, as those of common fonts for drawings have: texts
/// keep their size.
const EM_UNITS: i16 = 12_000;
/// Units to a step of the letters' grid.
const STEP_UNITS: i16 = 700;
/// How far beside a stroke its contour comes back, both ways, units: a 6000th of an em. Less than
/// [`SLACK_EM`](super::one_line::SLACK_EM), and more than single precision loses some hundred ems from the
/// origin.
const BESIDE_UNITS: i16 = 2;
/// Room between the ink of two letters, steps: with it words are about as long as in Helvetica.
const GAP_STEPS: f64 = 3.0;
/// Widths of the ink that digits have room for, so that columns of them stand in line, and of a blank less
/// the gap, steps.
const DIGIT_STEPS: f64 = 7.0;
const BLANK_STEPS: f64 = 2.0;
/// Width of the grid, which all letters have room for where they are equally wide, steps.
const GRID_STEPS: f64 = 8.0;
/// Highest and lowest places of the grid, steps.
const ASCENT_STEPS: i16 = 16;
const DESCENT_STEPS: i16 = -4;
/// Heights of capitals and of small letters, steps.
const CAPITAL_STEPS: i16 = 12;
const SMALL_STEPS: i16 = 8;

/// Letters of texts that Latin-1 does not have, and those of it that look nearly so: what programs write for
/// quotation marks, dashes and blanks.
const LOOKS: [(char, char); 22] = [
    ('\u{2002}', ' '),
    ('\u{2003}', ' '),
    ('\u{2007}', ' '),
    ('\u{2009}', ' '),
    ('\u{200a}', ' '),
    ('\u{2010}', '-'),
    ('\u{2011}', '-'),
    ('\u{2012}', '-'),
    ('\u{2013}', '-'),
    ('\u{2014}', '-'),
    ('\u{2018}', '\''),
    ('\u{2019}', '\''),
    ('\u{201a}', ','),
    ('\u{201c}', '"'),
    ('\u{201d}', '"'),
    ('\u{2022}', '·'),
    ('\u{202f}', ' '),
    ('\u{2032}', '\''),
    ('\u{2033}', '"'),
    ('\u{2044}', '/'),
    ('\u{2212}', '-'),
    ('\u{3bc}', 'µ'),
];

/// A letter as the font has it.
struct Glyph {
    strokes: Vec<Vec<Point>>,
    /// Left end of what it has room for, and its width, steps.
    left: f64,
    width: f64,
}

impl Glyph {
    fn new(letter: char, is_monospaced: bool) -> Option<Self> {
        let strokes: Vec<Vec<Point>> = letter_strokes(letter)?.map(Iterator::collect).collect();
        let ink = || strokes.iter().flatten().map(|at| at.x);
        let (left, right) = (ink().fold(f64::INFINITY, f64::min), ink().fold(f64::NEG_INFINITY, f64::max));
        let (left, width) = match letter {
            _ if is_monospaced => (0.0, GRID_STEPS),
            '0'..='9' => (0.0, DIGIT_STEPS),
            _ if left <= right => (left, right - left),
            _ => (0.0, BLANK_STEPS),
        };
        Some(Self { strokes, left, width })
    }

    /// What stands for letters that the font lacks: a box. Texts with it are not drawn.
    fn missing() -> Self {
        let corners = [(0.0, 0.0), (0.0, 12.0), (8.0, 12.0), (8.0, 0.0), (0.0, 0.0)];
        let stroke = corners.map(|(x, y)| Point::new(x, y)).to_vec();
        Self { strokes: vec![stroke], left: 0.0, width: GRID_STEPS }
    }

    fn advance_units(&self) -> i16 {
        units(self.width + GAP_STEPS)
    }

    /// Its contours, each along a stroke and back.
    fn contours(&self) -> Vec<Vec<(i16, i16)>> {
        let shift = GAP_STEPS / 2.0 - self.left;
        let place = |at: &Point| (units(at.x + shift), units(at.y));
        let contour = |stroke: &Vec<Point>| {
            let forth: Vec<(i16, i16)> = stroke.iter().map(place).collect();
            let back = forth.iter().rev().map(|(x, y)| (x + BESIDE_UNITS, y + BESIDE_UNITS));
            forth.iter().copied().chain(back).collect()
        };
        self.strokes.iter().map(contour).collect()
    }
}

/// A length in units of the font.
fn units(steps: f64) -> i16 {
    #[expect(clippy::cast_possible_truncation, reason = "some 20 steps at most, and whole halves of them")]
    let units = libm::round(steps * f64::from(STEP_UNITS)) as i16;
    units
}

/// Bytes in the order of the format: the greatest first.
#[derive(Clone, Debug, Default)]
struct Table(Vec<u8>);

impl Table {
    fn shorts(mut self, numbers: &[i16]) -> Self {
        self.0.extend(numbers.iter().flat_map(|number| number.to_be_bytes()));
        self
    }

    fn longs(mut self, numbers: &[u32]) -> Self {
        self.0.extend(numbers.iter().flat_map(|number| number.to_be_bytes()));
        self
    }

    fn bytes(mut self, bytes: &[u8]) -> Self {
        self.0.extend_from_slice(bytes);
        self
    }

    fn padded(mut self) -> Self {
        self.0.resize(self.0.len().next_multiple_of(4), 0);
        self
    }
}

/// The font's file: the same bytes always.
pub(super) fn font_file(is_monospaced: bool) -> Vec<u8> {
    let mut glyphs = vec![Glyph::missing()];
    let mut codes: Vec<(char, u32)> = Vec::new();
    for letter in '\0'..='\u{ff}' {
        if let Some(glyph) = Glyph::new(letter, is_monospaced) {
            codes.push((letter, long(glyphs.len())));
            glyphs.push(glyph);
        }
    }
    for (letter, looks_like) in LOOKS {
        let known = codes.iter().find(|(known, _)| *known == looks_like).map(|(_, glyph)| *glyph);
        codes.extend(known.map(|glyph| (letter, glyph)));
    }
    codes.sort_unstable();

    let (mut glyf, mut loca, mut hmtx) = (Table::default(), Table::default().longs(&[0]), Table::default());
    let (mut most_places, mut most_contours, mut widest) = (0, 0, 0);
    for glyph in &glyphs {
        let contours = glyph.contours();
        most_places = most_places.max(contours.iter().map(Vec::len).sum());
        most_contours = most_contours.max(contours.len());
        widest = widest.max(glyph.advance_units());
        glyf = outline(glyf, &contours);
        loca = loca.longs(&[long(glyf.0.len())]);
        let left = contours.iter().flatten().map(|at| at.0).min().unwrap_or(0);
        hmtx = hmtx.shorts(&[glyph.advance_units(), left]);
    }
    let count = short(glyphs.len());
    let (top, bottom) = (ASCENT_STEPS * STEP_UNITS, DESCENT_STEPS * STEP_UNITS);
    // Version 1.0, revision, no checksum, the magic number; flags, the em; created and modified; the least
    // and greatest x and y; no style, 8 px at least; mixed direction, long offsets, the usual format.
    let head = Table::default().longs(&[0x0001_0000, 0, 0, 0x5f0f_3cf5]).shorts(&[0, EM_UNITS]);
    let head = head.longs(&[0; 4]).shorts(&[0, bottom, widest, top, 0, 8, 2, 1, 0]);
    // Ascender, descender, gap, the greatest advance; the rest is for slanted carets.
    let hhea = Table::default().longs(&[0x0001_0000]).shorts(&[top, bottom, 0, widest]);
    let hhea = hhea.shorts(&[0; 11]).shorts(&[count]);
    let maxp = Table::default().longs(&[0x0001_0000]);
    let maxp =
        maxp.shorts(&[count, short(most_places), short(most_contours), 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0]);
    // No names of glyphs, upright, the line below letters two steps down and as thin as a stroke's contour,
    // for it is one line, too.
    let post = Table::default().longs(&[0x0003_0000, 0]).shorts(&[-2 * STEP_UNITS, BESIDE_UNITS]);
    let post = post.longs(&[u32::from(is_monospaced), 0, 0, 0, 0]);
    let family = if is_monospaced { MONOSPACED } else { FAMILY };
    let tables = [
        (*b"OS/2", metrics(widest)),
        (*b"cmap", code_map(&codes)),
        (*b"glyf", glyf),
        (*b"head", head),
        (*b"hhea", hhea),
        (*b"hmtx", hmtx),
        (*b"loca", loca),
        (*b"maxp", maxp),
        (*b"name", names(family)),
        (*b"post", post),
    ];
    // How many tables, and what helps to search among them: 8 is the power of two below, of 16 bytes each.
    let entries = tables.len();
    let mut directory = Table::default().longs(&[0x0001_0000]);
    directory = directory.shorts(&[short(entries), 8 * 16, 3, short(16 * (entries - 8))]);
    let mut bodies = Table::default();
    for (tag, table) in tables {
        let start = 12 + 16 * entries + bodies.0.len();
        directory = directory.bytes(&tag).longs(&[0, long(start), long(table.0.len())]);
        bodies = bodies.bytes(&table.0).padded();
    }
    directory.bytes(&bodies.0).0
}

/// A number of things in the font, which has some hundred of them.
fn short(number: usize) -> i16 {
    i16::try_from(number).unwrap_or(i16::MAX)
}

/// A place in the file, which has some 30 kB.
fn long(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

/// A glyph: its box, the last place of each contour, no instructions, all places on the curve, each by its
/// way from the one before. One without contours has no bytes.
fn outline(glyf: Table, contours: &[Vec<(i16, i16)>]) -> Table {
    let places: Vec<(i16, i16)> = contours.iter().flatten().copied().collect();
    let bounds =
        |side: fn(&(i16, i16)) -> i16| places.iter().map(side).min().zip(places.iter().map(side).max());
    let (Some((left, right)), Some((low, high))) = (bounds(|at| at.0), bounds(|at| at.1)) else {
        return glyf;
    };
    let ways = |side: fn(&(i16, i16)) -> i16| -> Vec<i16> {
        let before = core::iter::once(0).chain(places.iter().map(side));
        places.iter().map(side).zip(before).map(|(to, from)| to - from).collect()
    };
    let ends = contours.iter().scan(0, |end, contour| {
        *end += contour.len();
        Some(short(*end - 1))
    });
    glyf.shorts(&[short(contours.len()), left, low, right, high])
        .shorts(&ends.collect::<Vec<_>>())
        .shorts(&[0])
        .bytes(&vec![1; places.len()])
        .shorts(&ways(|at| at.0))
        .shorts(&ways(|at| at.1))
        .padded()
}

/// Codes of Unicode to glyphs, format 12: a group for each letter.
fn code_map(codes: &[(char, u32)]) -> Table {
    let mut groups = Table::default();
    for (letter, glyph) in codes {
        groups = groups.longs(&[u32::from(*letter), u32::from(*letter), *glyph]);
    }
    let header = Table::default().shorts(&[0, 1, 3, 10]).longs(&[12]).shorts(&[12, 0]);
    header.longs(&[long(16 + groups.0.len()), 0, long(codes.len())]).bytes(&groups.0)
}

/// Table OS/2, version 4: where letters below and above the line stand, lines through them, how high they
/// are.
fn metrics(widest: i16) -> Table {
    let (half, above) = (EM_UNITS / 2, EM_UNITS / 3);
    let table = Table::default().shorts(&[4, widest, 400, 5, 0]);
    // Lowered and raised letters: size, way to the right, and way down or up; the line through letters, half
    // as high as small ones.
    let table = table.shorts(&[half, half, 0, EM_UNITS / 7, half, half, 0, above]);
    let table = table.shorts(&[BESIDE_UNITS, SMALL_STEPS * STEP_UNITS / 2, 0]);
    // No classification, all of Latin-1 (two blocks), no vendor; regular, the first and last of its letters.
    let table = table.bytes(&[0; 10]).longs(&[3, 0, 0, 0]).bytes(b"    ").shorts(&[0x40, 0x20, 0xff]);
    let (top, bottom) = (ASCENT_STEPS * STEP_UNITS, DESCENT_STEPS * STEP_UNITS);
    let table = table.shorts(&[top, bottom, 0, top, -bottom]).longs(&[1, 0]);
    table.shorts(&[SMALL_STEPS * STEP_UNITS, CAPITAL_STEPS * STEP_UNITS, 0, 0x20, 1])
}

/// The family (1) and the PostScript name (6), in English for Windows.
fn names(family: &str) -> Table {
    let text: Vec<u8> = family.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let record = |name: i16| [3, 1, 0x409, name, short(text.len()), 0];
    Table::default().shorts(&[0, 2, 6 + 2 * 12]).shorts(&record(1)).shorts(&record(6)).bytes(&text)
}
