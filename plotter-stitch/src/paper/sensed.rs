//! [`SensedPaper`]: what the optical head would see of a paper's edges.

use super::Side;
use crate::sheet::noise::Noise;
use crate::{
    Optics, Search,
    sense::{Ask, SearchError, Tact, disc_over_line},
    sheet::PaperEdge,
};
use alloc::vec::Vec;
use plotter_motion::Point;

/// Standard deviation of the head's place in a tact, mm: as in the simulated joint.
const SERVO_MM: f64 = 0.01;
/// Standard deviation of the bends of an edge, mm: bends of rolls are some tenths.
const EDGE_MM: f64 = 0.1;

/// Simulated paper under the head: two wavy edges, torn places and stains. The same seed gives the same
/// paper.
#[derive(Clone, Debug, PartialEq)]
pub struct SensedPaper {
    optics: Optics,
    edges_mm: [f64; 2],
    slope: f64,
    waves: [PaperEdge; 2],
    /// Side, from where to where along the paper, and how far in the paper is missing.
    tears: Vec<(Side, [f64; 2], f64)>,
    /// Dark rectangles: least and greatest coordinates.
    stains: Vec<[Point; 2]>,
    random: Noise,
}

impl SensedPaper {
    /// Paper whose edges lie there at y = 0, turned by a small angle.
    #[must_use]
    pub fn new(edges_mm: [f64; 2], turn_rad: f64, seed: u64) -> Self {
        let mut random = Noise::new(seed);
        let waves = [0, 1].map(|_| PaperEdge::new(EDGE_MM, random.bits()));
        Self {
            optics: Optics::default(),
            edges_mm,
            slope: -libm::tan(turn_rad),
            waves,
            tears: Vec::new(),
            stains: Vec::new(),
            random,
        }
    }

    /// A piece of the edge is missing, between two places along the paper and so far in, mm.
    #[must_use]
    pub fn torn(mut self, side: Side, along_mm: [f64; 2], deep_mm: f64) -> Self {
        self.tears.push((side, along_mm, deep_mm));
        self
    }

    /// A dark stain: a rectangle, by its least and greatest coordinates, mm.
    #[must_use]
    pub fn stained(mut self, least: Point, most: Point) -> Self {
        self.stains.push([least, most]);
        self
    }

    /// Does what a search asks for until it is done.
    ///
    /// # Errors
    ///
    /// What the search says.
    pub fn run(&mut self, search: &mut impl Search) -> Result<(), SearchError> {
        let phase = self.random.unit();
        loop {
            let ask = search.ask();
            let Ask::Scan { from, to_mm, velocity_mm_s, .. } = ask else {
                if ask == Ask::Done {
                    return Ok(());
                }
                search.arrived()?;
                continue;
            };
            let step_mm = velocity_mm_s * self.optics.tact_s;
            let mut position_mm = from.x + phase * step_mm;
            while search.ask() == ask && (to_mm - position_mm) * step_mm > 0.0 {
                search.tact(self.tact(position_mm, from.y, velocity_mm_s))?;
                position_mm += step_mm;
            }
            if search.ask() == ask {
                search.arrived()?;
            }
        }
    }

    fn tact(&mut self, position_mm: f64, y_mm: f64, velocity_mm_s: f64) -> Tact {
        let [servo_mm, _] = self.random.normals(SERVO_MM);
        let dark = self.optics.led_offset_s.map(|offset_s| {
            let at_mm = position_mm + servo_mm + velocity_mm_s * (offset_s - self.optics.latency_s);
            self.covered(at_mm, y_mm) > self.optics.seen_above
        });
        Tact { position_mm, hits: dark.into_iter().map(u8::from).sum(), covered: None }
    }

    /// Share of the disc over glass or stain.
    fn covered(&self, x_mm: f64, y_mm: f64) -> f64 {
        let edge_mm = |side: Side| {
            let index = side as usize;
            let inwards = if side == Side::Left { 1.0 } else { -1.0 };
            let is_torn =
                |tear: &&(Side, [f64; 2], f64)| tear.0 == side && (tear.1[0]..=tear.1[1]).contains(&y_mm);
            let deep_mm = self.tears.iter().find(is_torn).map_or(0.0, |tear| tear.2);
            self.edges_mm[index] + self.slope * y_mm + self.waves[index].off_mm(y_mm) + inwards * deep_mm
        };
        let dark =
            |from_mm: f64, to_mm: f64| disc_over_line(self.optics.disc_mm, from_mm - x_mm, to_mm - x_mm);
        let glass = dark(f64::NEG_INFINITY, edge_mm(Side::Left)) + dark(edge_mm(Side::Right), f64::INFINITY);
        let is_over = |[least, most]: &&[Point; 2]| (least.y..=most.y).contains(&y_mm);
        let stains: f64 = self.stains.iter().filter(is_over).map(|[least, most]| dark(least.x, most.x)).sum();
        (glass + stains).min(1.0)
    }
}
