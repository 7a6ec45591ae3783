//! [`Record`]: the groups of one entity, and what they say.

use super::entity::{Insert, Shape, Vertex};
use super::frame::{Frame, Vec3};
use super::hatch::{Edge, Family, Hatch};
use super::pairs::Pair;
use super::path::{Bow, rad, sweep};
use super::spline::{Spline, through};
use super::text::{Across, Along, Text, lines, plain};
use crate::Point;
use alloc::boxed::Box;
use alloc::string::String;
use alloc::vec::Vec;
use core::f64::consts::TAU;

/// Farthest that a place may be, in units of the drawing: beyond it single steps of a motor are lost in the
/// rounding.
const MOST_UNITS: f64 = 1e9;
/// Most rows or columns of a block.
const MOST_ROWS: i64 = 32_767;

/// The groups of one entity.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    /// Its kind, in capital letters.
    pub(super) kind: String,
    /// Line where it begins.
    pub(super) line: u32,
    pub(super) pairs: Vec<Pair>,
}

/// What is wrong with an entity, and what would be right.
pub(super) type Complaint = &'static str;

const NO_NUMBER: Complaint = "one of its numbers is none, or beyond 1e9";

impl Record {
    pub(super) fn first(&self, code: i32) -> Option<&Pair> {
        self.pairs.iter().find(|pair| pair.code == code)
    }

    pub(super) fn text(&self, code: i32) -> Option<&str> {
        self.first(code).map(|pair| pair.value.as_str())
    }

    pub(super) fn whole(&self, code: i32) -> Option<i64> {
        self.first(code)?.whole()
    }

    fn flag(&self, code: i32, bit: i64) -> bool {
        self.whole(code).unwrap_or(0) & bit != 0
    }

    /// A number, or what holds without it.
    pub(super) fn number_or(&self, code: i32, usual: f64) -> Result<f64, Complaint> {
        self.first(code).map_or(Ok(usual), number)
    }

    fn number(&self, code: i32) -> Result<f64, Complaint> {
        self.first(code).ok_or("a number that it needs is missing").and_then(number)
    }

    /// The place whose x has this code; y and z have those 10 and 20 above.
    fn place(&self, code: i32) -> Result<Vec3, Complaint> {
        if self.first(code).is_none() || self.first(code + 10).is_none() {
            return Err("a place that it needs is missing");
        }
        self.place_or(code, Vec3::ZERO)
    }

    pub(super) fn place_or(&self, code: i32, usual: Vec3) -> Result<Vec3, Complaint> {
        Ok(Vec3::new(
            self.number_or(code, usual.x)?,
            self.number_or(code + 10, usual.y)?,
            self.number_or(code + 20, usual.z)?,
        ))
    }

    fn angle_or(&self, code: i32, usual: f64) -> Result<f64, Complaint> {
        Ok(rad(self.number_or(code, usual)?))
    }

    pub(super) fn normal(&self) -> Result<Vec3, Complaint> {
        self.place_or(210, Vec3::UP)
    }

    /// What it looks like; `None` for a kind that is not drawn.
    pub(super) fn shape(&self) -> Result<Option<Shape>, Complaint> {
        Ok(Some(match &*self.kind {
            "LINE" => Shape::Lines(alloc::vec![[self.place(10)?, self.place(11)?]]),
            "POINT" => Shape::Point { at: self.place(10)? },
            "CIRCLE" => Shape::Arc {
                centre: self.place(10)?,
                radius: self.above_zero(40)?,
                from_rad: 0.0,
                sweep_rad: TAU,
            },
            "ARC" => {
                let (from_rad, to_rad) = (rad(self.number(50)?), rad(self.number(51)?));
                Shape::Arc {
                    centre: self.place(10)?,
                    radius: self.above_zero(40)?,
                    from_rad,
                    sweep_rad: sweep(from_rad, to_rad),
                }
            }
            "ELLIPSE" => {
                let from_rad = self.number_or(41, 0.0)?;
                let major = self.place(11)?;
                if major.length() <= 0.0 {
                    return Err("its longer axis (11, 21) has no length");
                }
                Shape::Ellipse {
                    centre: self.place(10)?,
                    major,
                    ratio: self.above_zero(40)?,
                    from_rad,
                    sweep_rad: sweep(from_rad, self.number_or(42, TAU)?),
                }
            }
            "LWPOLYLINE" => self.light_polyline()?,
            "LEADER" => Shape::Polyline { vertices: self.corners()?, is_closed: false },
            "SPLINE" | "HELIX" => Shape::Spline(Box::new(self.spline()?)),
            "SOLID" | "TRACE" => self.solid()?,
            "3DFACE" => self.face()?,
            "TEXT" | "ATTRIB" => Shape::Text(Box::new(self.line_of_text()?)),
            "MTEXT" => Shape::Text(Box::new(self.lines_of_text()?)),
            "HATCH" => {
                let height = self.number_or(30, 0.0)?;
                Shape::Hatch(Box::new(self.hatch()?), height)
            }
            "INSERT" | "DIMENSION" | "ARC_DIMENSION" | "LARGE_RADIAL_DIMENSION" | "ACAD_TABLE" => {
                Shape::Insert(Box::new(self.insert()?))
            }
            _ => return Ok(None),
        }))
    }

    fn above_zero(&self, code: i32) -> Result<f64, Complaint> {
        let value = self.number(code)?;
        if value > 0.0 { Ok(value) } else { Err("a size that ought to be above 0 is not (group 40)") }
    }

    /// All places whose x has the code 10, with the bulges after them.
    fn corners(&self) -> Result<Vec<Vertex>, Complaint> {
        let mut vertices: Vec<Vertex> = Vec::new();
        for pair in &self.pairs {
            match pair.code {
                10 => vertices.push(Vertex { at: Vec3::new(number(pair)?, 0.0, 0.0), bulge: 0.0 }),
                20 | 30 | 42 => {
                    let Some(vertex) = vertices.last_mut() else { continue };
                    match pair.code {
                        20 => vertex.at.y = number(pair)?,
                        30 => vertex.at.z = number(pair)?,
                        _ => vertex.bulge = number(pair)?,
                    }
                }
                _ => {}
            }
        }
        if vertices.is_empty() { Err("it has no place (10, 20)") } else { Ok(vertices) }
    }

    fn light_polyline(&self) -> Result<Shape, Complaint> {
        let height = self.number_or(38, 0.0)?;
        let mut vertices = self.corners()?;
        for vertex in &mut vertices {
            vertex.at.z = height;
        }
        Ok(Shape::Polyline { vertices, is_closed: self.flag(70, 1) })
    }

    fn spline(&self) -> Result<Spline, Complaint> {
        let degree = usize::try_from(self.whole(71).unwrap_or(3)).unwrap_or(0);
        let mut spline = Spline { degree, ..Spline::default() };
        let mut fitted: Vec<Vec3> = Vec::new();
        for pair in &self.pairs {
            match pair.code {
                // A helix goes on with numbers of its own.
                100 if pair.value == "AcDbHelix" => break,
                40 => spline.knots.push(number(pair)?),
                41 => spline.weights.push(number(pair)?),
                10 => spline.points.push(Vec3::new(number(pair)?, 0.0, 0.0)),
                11 => fitted.push(Vec3::new(number(pair)?, 0.0, 0.0)),
                20 | 30 | 21 | 31 => {
                    let places = if pair.code % 10 == 0 { &mut spline.points } else { &mut fitted };
                    let Some(place) = places.last_mut() else { continue };
                    if pair.code / 10 == 2 {
                        place.y = number(pair)?;
                    } else {
                        place.z = number(pair)?;
                    }
                }
                _ => {}
            }
        }
        if spline.points.is_empty() {
            spline = through(&fitted, self.flag(70, 1))
                .ok_or("it has neither control points (10, 20) nor two places that it passes (11, 21)")?;
        }
        spline.complaint().map_or(Ok(spline), Err)
    }

    /// Its third corner is across from the second.
    fn solid(&self) -> Result<Shape, Complaint> {
        let [a, b, c] = [self.place(10)?, self.place(11)?, self.place(12)?];
        let d = self.place_or(13, c)?;
        let corners = if d == c { alloc::vec![a, b, c] } else { alloc::vec![a, b, d, c] };
        let vertices = corners.into_iter().map(|at| Vertex { at, bulge: 0.0 }).collect();
        Ok(Shape::Polyline { vertices, is_closed: true })
    }

    fn face(&self) -> Result<Shape, Complaint> {
        let [a, b, c] = [self.place(10)?, self.place(11)?, self.place(12)?];
        let d = self.place_or(13, c)?;
        let hidden = self.whole(70).unwrap_or(0);
        let edges = [[a, b], [b, c], [c, d], [d, a]];
        let seen = edges
            .into_iter()
            .enumerate()
            .filter(|(index, [from, to])| hidden & (1 << index) == 0 && from != to);
        Ok(Shape::Lines(seen.map(|(_, edge)| edge).collect()))
    }

    fn insert(&self) -> Result<Insert, Complaint> {
        let block = self.text(2).ok_or("the name of its block (2) is missing")?;
        let rows = |code| self.whole(code).unwrap_or(1).clamp(1, MOST_ROWS);
        let count = |code| u32::try_from(rows(code)).unwrap_or(1);
        let mut insert = Insert {
            block: block.to_uppercase(),
            at: Vec3::ZERO,
            scale: Vec3::new(1.0, 1.0, 1.0),
            turned_rad: 0.0,
            columns: 1,
            rows: 1,
            column_distance: 0.0,
            row_distance: 0.0,
        };
        // The block of a dimension lies where it is drawn, whatever the other numbers say.
        if self.kind == "INSERT" {
            insert = Insert {
                at: self.place(10)?,
                scale: Vec3::new(
                    self.number_or(41, 1.0)?,
                    self.number_or(42, 1.0)?,
                    self.number_or(43, 1.0)?,
                ),
                turned_rad: self.angle_or(50, 0.0)?,
                columns: count(70),
                rows: count(71),
                column_distance: self.number_or(44, 0.0)?,
                row_distance: self.number_or(45, 0.0)?,
                ..insert
            };
        } else if self.kind == "ACAD_TABLE" {
            insert.at = self.place(10)?;
        }
        Ok(insert)
    }

    fn line_of_text(&self) -> Result<Text, Complaint> {
        let first = self.place(10)?;
        let second = if self.first(11).is_some() { Some(self.place_or(11, first)?) } else { None };
        let along = match self.whole(72).unwrap_or(0) {
            1 | 4 => Along::Middle,
            2 => Along::Right,
            3 => Along::Aligned,
            5 => Along::Fit,
            _ => Along::Left,
        };
        let vertical = if self.kind == "ATTRIB" { 74 } else { 73 };
        let across = match self.whole(vertical).unwrap_or(0) {
            _ if self.whole(72) == Some(4) => Across::Middle,
            1 => Across::Bottom,
            2 => Across::Middle,
            3 => Across::Top,
            _ => Across::Baseline,
        };
        let is_between = matches!(along, Along::Aligned | Along::Fit);
        let is_usual = along == Along::Left && across == Across::Baseline;
        let at = if is_usual || is_between { first } else { second.unwrap_or(first) };
        Ok(Text {
            at,
            to: if is_between { second } else { None },
            height: self.above_zero(40)?,
            turned_rad: self.angle_or(50, 0.0)?,
            width_factor: nonzero(self.number_or(41, 1.0)?),
            slant_rad: self.angle_or(51, 0.0)?.clamp(-1.4, 1.4),
            is_backward: self.flag(71, 2),
            is_upside_down: self.flag(71, 4),
            along,
            across,
            pitch: 1.0,
            lines: alloc::vec![plain(self.text(1).unwrap_or(""))],
        })
    }

    fn lines_of_text(&self) -> Result<Text, Complaint> {
        let letters: String = self
            .pairs
            .iter()
            .filter(|pair| matches!(pair.code, 1 | 3))
            .map(|pair| pair.value.as_str())
            .collect();
        let attachment = self.whole(71).unwrap_or(1).clamp(1, 9) - 1;
        let mut text = Text {
            height: self.above_zero(40)?,
            turned_rad: self.angle_or(50, 0.0)?,
            width_factor: 1.0,
            along: match attachment % 3 {
                0 => Along::Left,
                1 => Along::Middle,
                _ => Along::Right,
            },
            across: match attachment / 3 {
                0 => Across::Top,
                1 => Across::Middle,
                _ => Across::Bottom,
            },
            pitch: self.number_or(44, 1.0)?.clamp(0.25, 4.0),
            lines: lines(&letters),
            ..Text::default()
        };
        text.wrap(self.number_or(41, 0.0)?);
        // Its place and direction are those of the drawing, not of its plane: both are brought into it.
        let axes = Frame::across(self.normal()?);
        let place = self.place(10)?;
        let dot = |a: Vec3| a.x * place.x + a.y * place.y + a.z * place.z;
        text.at = Vec3::new(dot(axes.x), dot(axes.y), dot(axes.z));
        if self.first(11).is_some() {
            text.turned_to(self.place_or(11, axes.x)?, &axes);
        }
        Ok(text)
    }

    /// The groups of a hatch stand in an order: those of each edge behind its kind.
    fn hatch(&self) -> Result<Hatch, Complaint> {
        let mut hatch = Hatch { is_solid: self.flag(70, 1), ..Hatch::default() };
        let begin = self.pairs.iter().position(|pair| pair.code == 91).unwrap_or(self.pairs.len());
        let end = self.pairs.iter().position(|pair| pair.code == 75).unwrap_or(self.pairs.len()).max(begin);
        let (paths, pattern) =
            (self.pairs.get(begin..end).unwrap_or(&[]), self.pairs.get(end..).unwrap_or(&[]));
        let starts: Vec<usize> =
            paths.iter().enumerate().filter(|(_, pair)| pair.code == 92).map(|(index, _)| index).collect();
        for (number_of, start) in starts.iter().enumerate() {
            let stop = starts.get(number_of + 1).copied().unwrap_or(paths.len());
            let Some([kind, path @ ..]) = paths.get(*start..stop) else { continue };
            let is_polyline = kind.whole().unwrap_or(0) & 2 != 0;
            let edges = if is_polyline { polyline_edges(path)? } else { edges(path)? };
            if !edges.is_empty() {
                hatch.outlines.push(edges);
            }
        }
        if hatch.outlines.is_empty() {
            return Err("it has no outline");
        }
        for pair in pattern {
            let value = if matches!(pair.code, 43..=46 | 49 | 53) { number(pair)? } else { continue };
            if pair.code == 53 {
                hatch.families.push(Family { turned_rad: rad(value), ..Family::default() });
            }
            let Some(family) = hatch.families.last_mut() else { continue };
            match pair.code {
                43 => family.base.x = value,
                44 => family.base.y = value,
                45 => family.offset.x = value,
                46 => family.offset.y = value,
                49 => family.dashes.push(value),
                _ => {}
            }
        }
        Ok(hatch)
    }
}

fn polyline_edges(path: &[Pair]) -> Result<Vec<Edge>, Complaint> {
    let end = path.iter().position(|pair| pair.code == 97).unwrap_or(path.len());
    let record = Record { pairs: path.get(..end).unwrap_or(path).to_vec(), ..Record::default() };
    let vertices = record.corners()?;
    let next = vertices.iter().cycle().skip(1);
    Ok(vertices
        .iter()
        .zip(next)
        .map(|(vertex, next)| {
            let (from, to) = (vertex.at.flat(), next.at.flat());
            super::path::of_bulge(from, to, vertex.bulge).map_or(Edge::Line { from, to }, Edge::Bow)
        })
        .collect())
}

fn edges(path: &[Pair]) -> Result<Vec<Edge>, Complaint> {
    let end = path.iter().rposition(|pair| pair.code == 97).unwrap_or(path.len());
    let mut edges = Vec::new();
    // Each edge begins with its kind.
    let starts: Vec<usize> = path
        .iter()
        .enumerate()
        .filter(|(index, pair)| pair.code == 72 && *index < end)
        .map(|(index, _)| index)
        .collect();
    for (number_of, start) in starts.iter().enumerate() {
        let stop = starts.get(number_of + 1).copied().unwrap_or(end);
        let pairs = path.get(*start..stop).unwrap_or(&[]).to_vec();
        let edge = Record { pairs, kind: String::from("edge"), line: 0 };
        let place = |code| edge.place(code).map(Vec3::flat);
        edges.push(match edge.whole(72) {
            Some(1) => Edge::Line { from: place(10)?, to: place(11)? },
            Some(kind @ (2 | 3)) => {
                let (mut from_rad, mut to_rad) = (rad(edge.number(50)?), rad(edge.number(51)?));
                let centre = place(10)?;
                // Clockwise, angles count the other way.
                let sense = if edge.whole(73) == Some(0) { -1.0 } else { 1.0 };
                let mut bow = Bow::round(centre, 0.0, 0.0, 0.0);
                if kind == 2 {
                    bow = Bow::round(centre, edge.above_zero(40)?, 0.0, 0.0);
                } else {
                    let (major, ratio) = (place(11)? - Point::ORIGIN, edge.above_zero(40)?);
                    // Angles here, where an ELLIPSE has parameters: those of the circle that it is made of.
                    let parameter = |angle: f64| libm::atan2(libm::sin(angle), ratio * libm::cos(angle));
                    if sweep(from_rad, to_rad) < TAU {
                        (from_rad, to_rad) = (parameter(from_rad), parameter(to_rad));
                    }
                    bow.axes = (major, major.perpendicular() * ratio);
                }
                (bow.from_rad, bow.sweep_rad) = (sense * from_rad, sense * sweep(from_rad, to_rad));
                Edge::Bow(bow)
            }
            Some(4) => {
                let mut spline = Spline {
                    degree: usize::try_from(edge.whole(94).unwrap_or(3)).unwrap_or(0),
                    ..Spline::default()
                };
                for pair in &edge.pairs {
                    match pair.code {
                        97 => break,
                        40 => spline.knots.push(number(pair)?),
                        42 => spline.weights.push(number(pair)?),
                        10 => spline.points.push(Vec3::new(number(pair)?, 0.0, 0.0)),
                        20 => {
                            let y = number(pair)?;
                            if let Some(point) = spline.points.last_mut() {
                                point.y = y;
                            }
                        }
                        _ => {}
                    }
                }
                if let Some(complaint) = spline.complaint() {
                    return Err(complaint);
                }
                Edge::Spline(spline)
            }
            _ => return Err("an edge of its outline is of no known kind (72)"),
        });
    }
    Ok(edges)
}

fn number(pair: &Pair) -> Result<f64, Complaint> {
    pair.number().filter(|number| libm::fabs(*number) <= MOST_UNITS).ok_or(NO_NUMBER)
}

fn nonzero(factor: f64) -> f64 {
    if libm::fabs(factor) > 1e-6 { factor } else { 1.0 }
}
