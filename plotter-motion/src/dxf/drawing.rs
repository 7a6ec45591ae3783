//! [`Drawing`]: a text in memory, as tables, blocks and entities.

use super::entity::{Block, Colour, Entity, Layer, LineKind, LineType, Shape, Vertex};
use super::frame::Vec3;
use super::pairs::{Pair, Pairs};
use super::plot_ops::PlotOps;
use super::record::Record;
use super::{Error, Problem, ReadOptions};
use alloc::collections::BTreeMap;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

/// The layer on which dimensions keep their points.
pub(super) const NEVER_PLOTTED: &str = "Defpoints";

/// Most that is told of what is wrong with single entities; the rest is counted.
const MOST_TOLD: usize = 100;

/// A drawing of a CAD program, as its DXF file has it.
///
/// ```
/// use plotter_motion::{PlotOp, Point, dxf};
///
/// let text = b"0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n1\n20\n2\n11\n5\n21\n2\n0\nENDSEC\n0\nEOF\n";
/// let drawing = dxf::Drawing::read(text.iter().copied())?;
/// let options = dxf::ReadOptions { unit_mm: Some(25.4), ..dxf::ReadOptions::default() };
/// let ops: Vec<PlotOp> = drawing.plot_ops(options).flatten().collect();
/// assert_eq!(ops[0], PlotOp::SelectPen { pen: 1 });
/// assert_eq!(ops[1], PlotOp::Travel { to: Point::new(25.4, 50.8) });
/// assert_eq!(ops[2], PlotOp::Draw { to: Point::new(127.0, 50.8), feed_mm_s: None });
/// # Ok::<(), dxf::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    pub(super) layers: Vec<Layer>,
    pub(super) line_types: Vec<LineType>,
    pub(super) blocks: BTreeMap<String, Block>,
    pub(super) entities: Vec<Entity>,
    /// What the header says of lengths: `$INSUNITS`, and the scale of line types.
    pub(super) unit: Option<i64>,
    pub(super) line_scale: f64,
    pub(super) said: Vec<Error>,
}

/// What reading keeps in mind.
#[derive(Default)]
struct Reading {
    drawing: Drawing,
    /// Where each name of a layer and of a line type is in its table, in capital letters.
    layers: BTreeMap<String, usize>,
    line_types: BTreeMap<String, usize>,
    section: Section,
    /// Name of the block that is being read, and what it holds so far.
    block: Option<(String, Block)>,
    /// The polyline whose corners follow.
    polyline: Option<(Record, Vec<Record>)>,
    /// Kinds that are not drawn: the first line, and how many.
    not_drawn: BTreeMap<String, (u32, u32)>,
    bad: u32,
    has_ended: bool,
    /// The variable of the header whose value follows.
    variable: String,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Section {
    #[default]
    None,
    Header,
    Tables,
    Blocks,
    Entities,
    Other,
}

impl Drawing {
    /// Reads a text from its bytes. What is wrong with single entities is told by
    /// [`plot_ops`](Self::plot_ops); they are left out.
    ///
    /// Memory is in proportion to the text.
    ///
    /// # Errors
    ///
    /// [`Problem::OtherFormat`] for a file that is no DXF in text.
    pub fn read(bytes: impl IntoIterator<Item = u8>) -> Result<Self, Error> {
        let mut bytes = bytes.into_iter();
        let head: Vec<u8> = bytes.by_ref().take(22).collect();
        if let Some(what) = other_format(&head) {
            return Err(Error { line: 0, problem: Problem::OtherFormat { what } });
        }
        let mut pairs = Pairs::new(head.into_iter().chain(bytes));
        let mut reading = Reading::default();
        reading.drawing.line_scale = 1.0;
        reading.layer("0");
        let mut record = Record::default();
        while let Some(pair) = pairs.next() {
            match pair {
                Ok(pair) if pair.code == 0 => {
                    let next = Record {
                        kind: pair.value.trim().to_uppercase(),
                        line: pair.line.saturating_sub(1),
                        pairs: Vec::new(),
                    };
                    reading.take(core::mem::replace(&mut record, next));
                }
                // Comments, and data of other programs, whose codes mean what these programs want.
                Ok(pair) if pair.code == 999 || pair.code >= 1000 || pair.code < 0 => {}
                Ok(pair) => reading.pair(pair, &mut record),
                Err(error) => reading.say(error),
            }
        }
        reading.take(record);
        Ok(reading.finish(pairs.line()))
    }

    /// Its strokes as plot operations, mm, and in their place what there is to say. What the reading of it
    /// has found comes first.
    ///
    /// Entities come in the order of the file, and blocks where they stand; a layer that draws is a pen,
    /// unless the options say otherwise. Arcs and circles stay arcs where they are not seen askew.
    #[must_use]
    pub fn plot_ops(&self, options: ReadOptions) -> PlotOps<'_> {
        PlotOps::new(self, options)
    }

    /// Names of its layers.
    pub fn layers(&self) -> impl Iterator<Item = &str> {
        self.layers.iter().map(|layer| layer.name.as_str())
    }

    /// Size of its unit, mm; `None` where the file does not say it.
    #[must_use]
    pub fn unit_mm(&self) -> Option<f64> {
        Some(match self.unit? {
            1 => 25.4,
            2 => 304.8,
            3 => 1_609_344.0,
            4 => 1.0,
            5 => 10.0,
            6 => 1000.0,
            7 => 1e6,
            8 => 2.54e-5,
            9 => 0.0254,
            10 => 914.4,
            11 => 1e-7,
            12 => 1e-6,
            13 => 1e-3,
            14 => 100.0,
            15 => 10_000.0,
            16 => 100_000.0,
            // A US survey foot is 1200/3937 m.
            21 => 1_200_000.0 / 3937.0,
            _ => return None,
        })
    }
}

/// What a file is that is no DXF in text.
fn other_format(head: &[u8]) -> Option<&'static str> {
    if head.starts_with(b"AutoCAD Binary DXF") {
        return Some("this is a binary DXF, which is not read: save it as ASCII DXF");
    }
    if matches!(head, [b'A', b'C', b'1', b'0', digit, ..] if digit.is_ascii_digit()) {
        return Some("this is a DWG, which is not read: save it as ASCII DXF (AutoCAD R12 or later)");
    }
    None
}

impl Reading {
    fn say(&mut self, error: Error) {
        if self.drawing.said.len() < MOST_TOLD {
            self.drawing.said.push(error);
        } else {
            self.bad = self.bad.saturating_add(1);
        }
    }

    /// A group that is not the first of a record.
    fn pair(&mut self, pair: Pair, record: &mut Record) {
        if record.kind == "SECTION" && self.section == Section::None && pair.code == 2 {
            self.section = match pair.value.trim() {
                "HEADER" => Section::Header,
                "TABLES" => Section::Tables,
                "BLOCKS" => Section::Blocks,
                "ENTITIES" => Section::Entities,
                _ => Section::Other,
            };
        }
        match self.section {
            Section::Header => self.variable(&pair),
            Section::Tables | Section::Blocks | Section::Entities => record.pairs.push(pair),
            Section::None | Section::Other => {}
        }
    }

    fn variable(&mut self, pair: &Pair) {
        if pair.code == 9 {
            self.variable.clone_from(&pair.value);
            return;
        }
        match (self.variable.trim(), pair.code) {
            ("$INSUNITS", 70) => self.drawing.unit = pair.whole().filter(|unit| *unit != 0),
            ("$LTSCALE", 40) => {
                self.drawing.line_scale = pair.number().filter(|scale| *scale > 0.0).unwrap_or(1.0);
            }
            _ => {}
        }
    }

    /// A record that is complete.
    fn take(&mut self, record: Record) {
        if let Some((polyline, vertices)) = &mut self.polyline {
            if record.kind == "VERTEX" {
                vertices.push(record);
                return;
            }
            let (polyline, vertices) = (core::mem::take(polyline), core::mem::take(vertices));
            self.polyline = None;
            let shape = polyline_shape(&polyline, &vertices);
            self.entity(&polyline, shape.map(Some));
        }
        match &*record.kind {
            "" | "SECTION" | "SEQEND" => {}
            "ENDSEC" => self.section = Section::None,
            "EOF" => self.has_ended = true,
            "LAYER" if self.section == Section::Tables => self.layer_of_table(&record),
            "LTYPE" if self.section == Section::Tables => self.line_type_of_table(&record),
            "BLOCK" if self.section == Section::Blocks => {
                let name = record.text(2).or(record.text(3)).unwrap_or("").to_uppercase();
                let base = record.place_or(10, Vec3::ZERO).unwrap_or(Vec3::ZERO);
                self.block = Some((name, Block { base, entities: Vec::new() }));
            }
            "ENDBLK" => {
                if let Some((name, block)) = self.block.take() {
                    self.drawing.blocks.insert(name, block);
                }
            }
            // What blocks are clipped with stands among the objects.
            "SPATIAL_FILTER" => {
                let (_, count) = self.not_drawn.entry("XCLIP".to_string()).or_insert((record.line, 0));
                *count = count.saturating_add(1);
            }
            _ if !matches!(self.section, Section::Blocks | Section::Entities) => {}
            "POLYLINE" => self.polyline = Some((record, Vec::new())),
            _ => {
                let shape = record.shape();
                self.entity(&record, shape);
            }
        }
    }

    fn entity(&mut self, record: &Record, shape: Result<Option<Shape>, &'static str>) {
        // Definitions of attributes stand for nothing but the attributes themselves; hidden ones are not
        // seen.
        let is_hidden = record.whole(60) == Some(1)
            || (record.kind == "ATTRIB" && record.whole(70).unwrap_or(0) & 1 != 0)
            || matches!(&*record.kind, "ATTDEF" | "VIEWPORT" | "VERTEX");
        if is_hidden {
            return;
        }
        let shape = match shape {
            Ok(Some(shape)) => shape,
            Ok(None) => {
                let (_, count) = self.not_drawn.entry(record.kind.clone()).or_insert((record.line, 0));
                *count = count.saturating_add(1);
                return;
            }
            Err(what) => {
                let kind = record.kind.clone();
                self.say(Error { line: record.line, problem: Problem::BadEntity { kind, what } });
                return;
            }
        };
        let line_kind = self.line_kind(record.text(6));
        let layer = self.layer(record.text(8).unwrap_or("0"));
        let entity = Entity {
            line: record.line,
            layer,
            colour: colour(record.whole(62), record.whole(420)),
            line_kind,
            line_scale: record.number_or(48, 1.0).unwrap_or(1.0),
            normal: record.normal().unwrap_or(Vec3::UP),
            is_on_paper: record.whole(67) == Some(1),
            shape,
        };
        match &mut self.block {
            Some((_, block)) => block.entities.push(entity),
            None if self.section == Section::Entities => self.drawing.entities.push(entity),
            None => {}
        }
    }

    /// Where a layer of that name is in the table.
    fn layer(&mut self, name: &str) -> usize {
        let layers = &mut self.drawing.layers;
        *self.layers.entry(name.trim().to_uppercase()).or_insert_with(|| {
            layers.push(Layer {
                name: name.trim().to_string(),
                colour: Colour::Index(7),
                line_kind: LineKind::OfLayer,
                is_off: false,
                is_frozen: false,
            });
            layers.len() - 1
        })
    }

    fn line_type(&mut self, name: &str) -> usize {
        let types = &mut self.drawing.line_types;
        *self.line_types.entry(name.trim().to_uppercase()).or_insert_with(|| {
            types.push(LineType { name: name.trim().to_string(), pattern: Vec::new() });
            types.len() - 1
        })
    }

    fn line_kind(&mut self, name: Option<&str>) -> LineKind {
        match name.map(|name| name.trim().to_uppercase()).as_deref() {
            None | Some("BYLAYER" | "") => LineKind::OfLayer,
            Some("BYBLOCK") => LineKind::OfBlock,
            Some(name) => LineKind::Named(self.line_type(name)),
        }
    }

    fn layer_of_table(&mut self, record: &Record) {
        let Some(name) = record.text(2) else { return };
        let place = self.layer(name);
        let line_kind = self.line_kind(record.text(6));
        let index = record.whole(62).unwrap_or(7);
        if let Some(layer) = self.drawing.layers.get_mut(place) {
            layer.colour = match colour(Some(index.saturating_abs()), record.whole(420)) {
                Colour::OfLayer | Colour::OfBlock => Colour::Index(7),
                colour => colour,
            };
            layer.line_kind = line_kind;
            layer.is_off =
                index < 0 || record.whole(290) == Some(0) || layer.name.eq_ignore_ascii_case(NEVER_PLOTTED);
            layer.is_frozen = record.whole(70).unwrap_or(0) & 1 != 0;
        }
    }

    fn line_type_of_table(&mut self, record: &Record) {
        let Some(name) = record.text(2) else { return };
        let place = self.line_type(name);
        let pattern = record.pairs.iter().filter(|pair| pair.code == 49).filter_map(Pair::number).collect();
        if let Some(line_type) = self.drawing.line_types.get_mut(place) {
            line_type.pattern = pattern;
        }
    }

    fn finish(mut self, line: u32) -> Drawing {
        // A file that stops before its end still has what it has.
        if let Some((name, block)) = self.block.take() {
            self.drawing.blocks.insert(name, block);
        }
        if let Some((polyline, vertices)) = self.polyline.take() {
            let shape = polyline_shape(&polyline, &vertices);
            self.entity(&polyline, shape.map(Some));
        }
        let is_told = self.drawing.said.iter().any(|error| error.problem == Problem::Cut);
        if !self.has_ended && !is_told {
            self.drawing.said.push(Error { line, problem: Problem::Cut });
        }
        if self.bad > 0 {
            self.drawing.said.push(Error {
                line: 0,
                problem: Problem::Otherwise {
                    what: "more complaints of these kinds are not shown",
                    count: self.bad,
                },
            });
        }
        for (kind, (line, count)) in self.not_drawn {
            let why = reason(&kind);
            self.drawing.said.push(Error { line, problem: Problem::NotDrawn { kind, count, why } });
        }
        self.drawing
    }
}

/// Why entities of a kind are not drawn, and what helps.
fn reason(kind: &str) -> &'static str {
    match kind {
        "XLINE" | "RAY" => "it has no end: draw a LINE",
        "IMAGE" | "OLE2FRAME" | "OLEFRAME" => "it is a picture: trace it by itself",
        "3DSOLID" | "BODY" | "REGION" | "SURFACE" | "EXTRUDEDSURFACE" | "LOFTEDSURFACE" | "PLANESURFACE"
        | "REVOLVEDSURFACE" | "SWEPTSURFACE" | "MESH" => {
            "it is a solid or a surface: make lines of it first (FLATSHOT, or EXPLODE for a region)"
        }
        "MLINE" | "MULTILEADER" | "MLEADER" | "TOLERANCE" | "SHAPE" => {
            "it is not read: EXPLODE it, and save again"
        }
        "XCLIP" => "the block is drawn whole: trim it, or explode it and trim it",
        "WIPEOUT" => "what lies below it is drawn: hide it by the layer or trim it",
        "PDFUNDERLAY" | "DWFUNDERLAY" | "DGNUNDERLAY" => "it is another file: import it",
        "LIGHT" | "SUN" | "CAMERA" | "SECTION" | "POINTCLOUD" => "no pen draws it",
        _ => "it is not read: EXPLODE it to lines, arcs and texts, and save again",
    }
}

fn colour(index: Option<i64>, rgb: Option<i64>) -> Colour {
    if let Some(rgb) = rgb.and_then(|rgb| u32::try_from(rgb).ok()) {
        let [_, red, green, blue] = rgb.to_be_bytes();
        return Colour::Rgb([red, green, blue]);
    }
    match index {
        Some(0) => Colour::OfBlock,
        Some(index @ 1..=255) => Colour::Index(u8::try_from(index).unwrap_or(7)),
        _ => Colour::OfLayer,
    }
}

/// What a polyline of R12 looks like, whose corners are records of their own.
fn polyline_shape(polyline: &Record, vertices: &[Record]) -> Result<Shape, &'static str> {
    let flags = polyline.whole(70).unwrap_or(0);
    let has = |bit| flags & bit != 0;
    let height = polyline.number_or(30, 0.0)?;
    let count = |code| usize::try_from(polyline.whole(code).unwrap_or(0)).unwrap_or(0);
    let flag = |vertex: &Record| vertex.whole(70).unwrap_or(0);
    if has(64) {
        return faces(vertices);
    }
    let mut corners = Vec::new();
    // Points that only shape a fitted curve are no part of it.
    for vertex in vertices.iter().filter(|vertex| flag(vertex) & 16 == 0 || has(16) && !has(4)) {
        let mut at = vertex.place_or(10, Vec3::ZERO)?;
        if !has(8) && !has(16) {
            at.z = height;
        }
        corners.push(Vertex { at, bulge: vertex.number_or(42, 0.0)? });
    }
    if corners.is_empty() {
        return Err("it has no corner (VERTEX)");
    }
    if has(16) {
        let (rows, columns) = if has(4) { (count(73), count(74)) } else { (count(71), count(72)) };
        return mesh(&corners, rows, columns, (has(1), has(32)));
    }
    Ok(Shape::Polyline { vertices: corners, is_closed: has(1) })
}

/// The lines between the points of a net, row by row and column by column.
fn mesh(
    corners: &[Vertex],
    rows: usize,
    columns: usize,
    is_closed: (bool, bool),
) -> Result<Shape, &'static str> {
    if rows < 2 || columns < 2 || rows.checked_mul(columns) != Some(corners.len()) {
        return Err("it has not as many corners as its rows and columns need (71, 72)");
    }
    let at = |row: usize, column: usize| corners.get(row * columns + column).map(|corner| corner.at);
    let mut lines = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let Some(from) = at(row, column) else { continue };
            if row + 1 < rows || is_closed.0 {
                lines.extend(at((row + 1) % rows, column).map(|to| [from, to]));
            }
            if column + 1 < columns || is_closed.1 {
                lines.extend(at(row, (column + 1) % columns).map(|to| [from, to]));
            }
        }
    }
    Ok(Shape::Lines(lines))
}

/// The edges of faces, whose corners are the points of a list.
fn faces(vertices: &[Record]) -> Result<Shape, &'static str> {
    let mut places = Vec::new();
    let mut lines = Vec::new();
    for vertex in vertices {
        if vertex.whole(70).unwrap_or(0) & 64 != 0 {
            places.push(vertex.place_or(10, Vec3::ZERO)?);
            continue;
        }
        let corners: Vec<i64> =
            (71..=74).filter_map(|code| vertex.whole(code)).filter(|corner| *corner != 0).collect();
        for (index, from) in corners.iter().enumerate() {
            let Some(to) = corners.get((index + 1) % corners.len()) else { continue };
            let place = |corner: i64| {
                let number = usize::try_from(corner.unsigned_abs()).ok()?;
                places.get(number.checked_sub(1)?).copied()
            };
            // An edge that is not to be seen has a corner below 0 where it begins.
            if let (true, Some(from), Some(to)) = (*from > 0, place(*from), place(*to)) {
                lines.push([from, to]);
            }
        }
    }
    if lines.is_empty() { Err("it has no face that is seen") } else { Ok(Shape::Lines(lines)) }
}
