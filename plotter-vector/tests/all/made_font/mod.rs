//! A TrueType font made in memory, of a box and a triangle: what the tests set texts in.
//!
//! ```text
//!   700 ┌──┐     ╱╲      An em is 1000 units. Each letter is 500 wide and 700 high, stands on the base
//!       │  │    ╱  ╲     line, and the next one follows 600 from its start. B is the box, V the triangle.
//!     0 └──┘   ╱────╲
//! ```
//!
//! Source: OpenType specification 1.9, chapters of the tables by their names.

/// A glyph as the corners of its only contour, font units; none for a space.
type Corners = &'static [(i16, i16)];

/// What is drawn for letters that the font lacks.
const MISSING: Corners = &[(0, 0), (0, 1000), (100, 1000), (100, 0)];
const BOX: Corners = &[(0, 0), (0, 700), (500, 700), (500, 0)];
const TRIANGLE: Corners = &[(0, 0), (250, 700), (500, 0)];
/// Letters by their codes, in this order.
const LETTERS: [(char, Corners); 3] = [(' ', &[]), ('B', BOX), ('V', TRIANGLE)];
/// Way from the start of a letter to that of the next one.
const ADVANCE: u16 = 600;

/// Bytes in the order of the format: the greatest first.
#[derive(Default)]
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
}

/// The font's file, by the name of its family.
pub(crate) fn made_font(family: &str) -> Vec<u8> {
    font_of(family, MISSING)
}

/// The same, with nothing to be seen for letters that it lacks.
#[allow(dead_code, reason = "not every test needs it")]
pub(crate) fn font_with_blank(family: &str) -> Vec<u8> {
    font_of(family, &[])
}

fn font_of(family: &str, missing: Corners) -> Vec<u8> {
    let glyphs: Vec<Corners> = core::iter::once(missing).chain(LETTERS.map(|(_, corners)| corners)).collect();
    let (mut glyf, mut loca) = (Table::default(), Table::default().longs(&[0]));
    for corners in &glyphs {
        glyf = outline(glyf, corners);
        loca = loca.longs(&[u32::try_from(glyf.0.len()).unwrap()]);
    }
    let count = i16::try_from(glyphs.len()).unwrap();
    let mut hmtx = Table::default();
    for _ in &glyphs {
        hmtx = hmtx.shorts(&[ADVANCE.cast_signed(), 0]);
    }
    // Version 1.0, revision, no checksum, the magic number; flags, 1000 units an em; created and modified;
    // the least and greatest x and y; no style, 8 px at least; mixed direction, long offsets, the usual
    // format.
    let head = Table::default()
        .longs(&[0x0001_0000, 0, 0, 0x5f0f_3cf5])
        .shorts(&[0, 1000])
        .longs(&[0; 4])
        .shorts(&[0, 0, 500, 1000, 0, 8, 2, 1, 0]);
    // Ascender, descender and gap; the greatest advance; the rest is for slanted carets.
    let hhea = Table::default().longs(&[0x0001_0000]).shorts(&[800, -200, 0, ADVANCE.cast_signed()]);
    let hhea = hhea.shorts(&[0; 11]).shorts(&[count]);
    let maxp = Table::default().longs(&[0x0001_0000]).shorts(&[count, 4, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0]);
    let tables = [
        (*b"cmap", codes()),
        (*b"glyf", glyf),
        (*b"head", head),
        (*b"hhea", hhea),
        (*b"hmtx", hmtx),
        (*b"loca", loca),
        (*b"maxp", maxp),
        (*b"name", names(family)),
    ];
    let mut directory = Table::default().longs(&[0x0001_0000]).shorts(&[8, 128, 3, 0]);
    let mut start = u32::try_from(12 + 16 * tables.len()).unwrap();
    let mut bodies = Table::default();
    for (tag, table) in tables {
        let length = u32::try_from(table.0.len()).unwrap();
        directory = directory.bytes(&tag).longs(&[0, start, length]);
        bodies = bodies.bytes(&table.0);
        while !bodies.0.len().is_multiple_of(4) {
            bodies.0.push(0);
        }
        start = u32::try_from(12 + 16 * 8 + bodies.0.len()).unwrap();
    }
    directory.bytes(&bodies.0).0
}

/// One contour of straight lines: its box, the last corner, no instructions, all corners on the curve, each
/// by its way from the one before.
fn outline(glyf: Table, corners: &[(i16, i16)]) -> Table {
    let Some(last) = corners.len().checked_sub(1) else { return glyf };
    let range = |side: fn(&(i16, i16)) -> i16| {
        let sides = || corners.iter().map(side);
        (sides().min().unwrap(), sides().max().unwrap())
    };
    let ((left, right), (low, high)) = (range(|at| at.0), range(|at| at.1));
    let ways = |side: fn(&(i16, i16)) -> i16| -> Vec<i16> {
        let before = core::iter::once(0).chain(corners.iter().map(side));
        corners.iter().map(side).zip(before).map(|(to, from)| to - from).collect()
    };
    let mut glyf = glyf
        .shorts(&[1, left, low, right, high, i16::try_from(last).unwrap(), 0])
        .bytes(&vec![1; corners.len()])
        .shorts(&ways(|at| at.0))
        .shorts(&ways(|at| at.1));
    while !glyf.0.len().is_multiple_of(4) {
        glyf.0.push(0);
    }
    glyf
}

/// Codes of Unicode to glyphs, format 12: a group for each letter.
fn codes() -> Table {
    let mut groups = Table::default();
    for ((letter, _), glyph) in LETTERS.iter().zip(1..) {
        groups = groups.longs(&[u32::from(*letter), u32::from(*letter), glyph]);
    }
    let length = u32::try_from(16 + groups.0.len()).unwrap();
    let number = u32::try_from(LETTERS.len()).unwrap();
    let header = Table::default().shorts(&[0, 1, 3, 10]).longs(&[12]).shorts(&[12, 0]);
    header.longs(&[length, 0, number]).bytes(&groups.0)
}

/// The family (1) and the PostScript name (6), in English for Windows.
fn names(family: &str) -> Table {
    let text: Vec<u8> = family.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let length = i16::try_from(text.len()).unwrap();
    let record = |name: i16| [3, 1, 0x409, name, length, 0];
    Table::default().shorts(&[0, 2, 6 + 2 * 12]).shorts(&record(1)).shorts(&record(6)).bytes(&text)
}
