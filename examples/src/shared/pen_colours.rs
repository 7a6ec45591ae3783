//! The colours in which pens are shown.

/// Colours of the pens of a carousel, from 1 on.
const COLOURS: [[u8; 3]; 8] = [
    [0x1a, 0x1a, 0x1a],
    [0xc6, 0x28, 0x28],
    [0x15, 0x65, 0xc0],
    [0x2e, 0x7d, 0x32],
    [0x6a, 0x1b, 0x9a],
    [0x8d, 0x4b, 0x1f],
    [0x00, 0x83, 0x8f],
    [0xad, 0x14, 0x57],
];

/// Colour of a pen as an SVG has it: one that the drawing says, else one of a carousel of eight.
#[must_use]
pub fn pen_colour(pen: u8, colours: &[[u8; 3]]) -> String {
    let own = colours.get(usize::from(pen.saturating_sub(1))).copied();
    let [red, green, blue] = own.unwrap_or_else(|| usual_colour(pen));
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Colour of a pen of which none is known: red, green, blue.
#[must_use]
pub fn usual_colour(pen: u8) -> [u8; 3] {
    let index = usize::from(pen.saturating_sub(1));
    COLOURS.get(index % COLOURS.len()).copied().unwrap_or_default()
}
