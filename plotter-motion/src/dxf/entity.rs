//! [`Entity`]: one thing of a drawing, as its file has it.

use super::frame::Vec3;
use super::hatch::Hatch;
use super::spline::Spline;
use super::text::Text;
use alloc::boxed::Box;
use alloc::string::String;
use alloc::vec::Vec;

/// Colour of an entity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Colour {
    #[default]
    OfLayer,
    OfBlock,
    /// By AutoCAD's colour index.
    Index(u8),
    Rgb([u8; 3]),
}

/// Line type of an entity: its place in the table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum LineKind {
    #[default]
    OfLayer,
    OfBlock,
    Named(usize),
}

/// One thing of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entity {
    /// Line where it begins.
    pub(super) line: u32,
    /// Its layer's place in the table.
    pub(super) layer: usize,
    pub(super) colour: Colour,
    pub(super) line_kind: LineKind,
    pub(super) line_scale: f64,
    /// Across its plane; what is given in space has it for what it turns about.
    pub(super) normal: Vec3,
    /// Whether it lies on a sheet of the paper space.
    pub(super) is_on_paper: bool,
    pub(super) shape: Shape,
}

/// A corner of a polyline, and how the stretch after it is bent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vertex {
    pub(super) at: Vec3,
    pub(super) bulge: f64,
}

/// What an entity looks like.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    Point {
        at: Vec3,
    },
    /// Lines of their own.
    Lines(Vec<[Vec3; 2]>),
    /// In its plane.
    Polyline {
        vertices: Vec<Vertex>,
        is_closed: bool,
    },
    /// In its plane.
    Arc {
        centre: Vec3,
        radius: f64,
        from_rad: f64,
        sweep_rad: f64,
    },
    Ellipse {
        centre: Vec3,
        major: Vec3,
        ratio: f64,
        from_rad: f64,
        sweep_rad: f64,
    },
    Spline(Box<Spline>),
    /// In its plane.
    Text(Box<Text>),
    /// In its plane, at this height.
    Hatch(Box<Hatch>, f64),
    Insert(Box<Insert>),
}

/// A block, drawn once or in rows and columns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Insert {
    pub(super) block: String,
    /// In its plane.
    pub(super) at: Vec3,
    pub(super) scale: Vec3,
    pub(super) turned_rad: f64,
    pub(super) columns: u32,
    pub(super) rows: u32,
    pub(super) column_distance: f64,
    pub(super) row_distance: f64,
}

/// Entities under a name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Block {
    pub(super) base: Vec3,
    pub(super) entities: Vec<Entity>,
}

/// A layer of the table.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layer {
    pub(super) name: String,
    pub(super) colour: Colour,
    pub(super) line_kind: LineKind,
    /// Off: its entities are not drawn.
    pub(super) is_off: bool,
    /// Frozen: nor are those of blocks on it.
    pub(super) is_frozen: bool,
}

/// A line type of the table.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct LineType {
    pub(super) name: String,
    /// Dashes, dots of 0 and gaps below 0, in units of the drawing.
    pub(super) pattern: Vec<f64>,
}

/// Red, green and blue of a colour of AutoCAD's index on white paper: 7 is black there.
///
/// The index is a rule: from 10 on each ten is a hue 15° further, of which each second one is darker and the
/// odd ones are paler.
pub(super) fn of_index(index: u8) -> [u8; 3] {
    const FIRST: [[u8; 3]; 10] = [
        [0, 0, 0],
        [255, 0, 0],
        [255, 255, 0],
        [0, 255, 0],
        [0, 255, 255],
        [0, 0, 255],
        [255, 0, 255],
        [0, 0, 0],
        [128, 128, 128],
        [192, 192, 192],
    ];
    const GREYS: [u8; 6] = [51, 91, 132, 173, 214, 255];
    const VALUES: [u8; 5] = [255, 165, 127, 76, 38];
    if let Some(colour) = FIRST.get(usize::from(index)) {
        return *colour;
    }
    if let Some(grey) = GREYS.get(usize::from(index).wrapping_sub(250)) {
        return [*grey; 3];
    }
    let hue = u16::from(index - 10) / 10 * 15;
    let value = u16::from(VALUES.get(usize::from(index % 10 / 2)).copied().unwrap_or(255));
    let least = if index % 2 == 1 { value / 2 } else { 0 };
    let (sixth, within) = (hue / 60, hue % 60);
    let part = least + (value - least) * (if sixth % 2 == 0 { within } else { 60 - within }) / 60;
    let [red, green, blue] = match sixth {
        0 => [value, part, least],
        1 => [part, value, least],
        2 => [least, value, part],
        3 => [least, part, value],
        4 => [part, least, value],
        _ => [value, least, part],
    };
    [red, green, blue].map(|part| u8::try_from(part).unwrap_or(u8::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_the_index() {
        let expected = [
            (1, [255, 0, 0]),
            (7, [0, 0, 0]),
            (10, [255, 0, 0]),
            (11, [255, 127, 127]),
            (30, [255, 127, 0]),
            (94, [0, 127, 0]),
            (170, [0, 0, 255]),
            (255, [255; 3]),
        ];
        for (index, colour) in expected {
            assert_eq!(of_index(index), colour, "{index}");
        }
    }
}
