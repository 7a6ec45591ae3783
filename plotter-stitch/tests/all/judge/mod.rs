//! The judge: a second simulator of sheet, ink and head, written from the physics.
//!
//! It shares no code, no noise and no constants with the one of the crate: the detector's spot is soft, its
//! threshold another, the servo sways slowly, ink may be smeared, paper swells and bows, pen and head lie
//! beside each other, delays differ between directions, and whatever was drawn near the marks lies under the
//! head too. Axes come from the layout's own joint.

#![allow(dead_code, unreachable_pub, reason = "each test takes what it needs")]

mod chance;
mod ink;
mod probe;
mod trials;

pub use chance::Chance;
pub use ink::Stroke;
pub use probe::{Stationery, probe};
pub use trials::{Pen, many, trial};

use ink::{Spot, Trace};
use plotter_motion::{Axis, Point, Vec2};
use plotter_stitch::{
    Crossing, ReferenceLines, Search,
    sense::{Ask, SearchError, Tact},
};

/// What is the matter with machine, pen and paper. Deviations are those from one joint to the next.
#[derive(Clone, Debug)]
pub struct World {
    /// Pen beside head, standard deviation in each direction, mm.
    pub pen_mm: f64,
    /// Greatest distance of the bowed joint from its chord, standard deviation, mm.
    pub bow_mm: f64,
    /// Swelling of the paper since the marks were drawn, standard deviation.
    pub swelling: f64,
    /// How much more it swells across the machine's feed than along it, as a factor.
    pub grain: f64,
    /// From a sample to the position that is noted for it, going up and going down, s.
    pub latency_s: [f64; 2],
    /// Width of the line, mm.
    pub line_mm: f64,
    /// Standard deviation of either edge of it, mm.
    pub texture_mm: f64,
    /// Standard deviation of the head's sway, mm.
    pub servo_mm: f64,
    /// Share of smeared marks, and from which to which length they are.
    pub smeared: f64,
    pub smear_mm: [f64; 2],
    /// Share of marks that are not there, and of crossings with a grain of dust.
    pub missed: f64,
    pub dust: f64,
    /// What else was drawn, in the coordinates of the marks.
    pub strokes: Vec<Stroke>,
}

impl Default for World {
    /// What the tables of the crate presume, as far as another world can be the same.
    fn default() -> Self {
        Self {
            pen_mm: 0.01,
            bow_mm: 0.0,
            swelling: 0.0,
            grain: 1.0,
            latency_s: [50e-6; 2],
            line_mm: 0.5,
            texture_mm: 0.02,
            servo_mm: 0.01,
            smeared: 0.0,
            smear_mm: [0.05, 0.4],
            missed: 0.0,
            dust: 0.0,
            strokes: Vec::new(),
        }
    }
}

/// How a sheet came to lie: each place of it, not only a turn and a shift.
#[derive(Clone, Copy, Debug)]
pub struct Sheet {
    angle_rad: f64,
    shift: Vec2,
    /// Along and across the joint.
    swelling: [f64; 2],
    bow_mm: f64,
    joint: [Point; 2],
}

impl Sheet {
    /// Where paper that was at a place of the frame lies on the machine.
    pub fn to_machine(self, place: Point) -> Point {
        let (along, across, length_mm) = self.directions();
        let from = place - self.joint[0];
        let (u, v) = (from.dot(along), from.dot(across));
        let share = u / length_mm;
        let swollen = along * (u * (1.0 + self.swelling[0]))
            + across * (v * (1.0 + self.swelling[1]) + 4.0 * self.bow_mm * share * (1.0 - share));
        let at = (self.joint[0] - Point::ORIGIN) + swollen;
        let (sin, cos) = self.angle_rad.sin_cos();
        Point::new(cos * at.x - sin * at.y + self.shift.x, sin * at.x + cos * at.y + self.shift.y)
    }

    fn directions(&self) -> (Vec2, Vec2, f64) {
        let way = self.joint[1] - self.joint[0];
        let length_mm = way.length();
        let along = way * (1.0 / length_mm);
        (along, Vec2::new(-along.y, along.x), length_mm)
    }

    /// Where a scan meets a straight line of the frame, mm along the scan: halving, since nothing else holds
    /// for every sheet.
    fn meets(&self, scan: Axis, scan_at_mm: f64, line: &Stroke, about_mm: f64) -> Option<f64> {
        const REACH_MM: f64 = 60.0;
        // Which side of the line the paper under the head was drawn on; the sheet is undone by going to it
        // step by step.
        let side = |along_mm: f64| {
            let head = match scan {
                Axis::X => Point::new(along_mm, scan_at_mm),
                Axis::Y => Point::new(scan_at_mm, along_mm),
            };
            let drawn = self.undone(head);
            (line.side(drawn), drawn)
        };
        let (mut low, mut high) = (about_mm - REACH_MM, about_mm + REACH_MM);
        let (first, last) = (side(low).0, side(high).0);
        if first * last > 0.0 {
            return None;
        }
        // A line's side changes nearly evenly: a few steps of the rule of false position are enough.
        let (mut at_low, mut at_high) = (first, last);
        for _ in 0..6 {
            let middle = low + (high - low) * (at_low / (at_low - at_high)).clamp(0.0, 1.0);
            let (value, drawn) = side(middle);
            if value.abs() < 1e-7 {
                return line.covers(drawn).then_some(middle);
            }
            if value * at_low > 0.0 {
                (low, at_low) = (middle, value);
            } else {
                (high, at_high) = (middle, value);
            }
        }
        let middle = 0.5 * (low + high);
        line.covers(side(middle).1).then_some(middle)
    }

    fn undone(&self, machine: Point) -> Point {
        let mut drawn = machine;
        for _ in 0..4 {
            drawn = drawn + (machine - self.to_machine(drawn));
        }
        drawn
    }
}

/// One sheet under one head.
pub struct Bench {
    spot: Spot,
    sheet: Sheet,
    latency_s: [f64; 2],
    servo_mm: f64,
    sway_mm: f64,
    traces: Vec<Trace>,
    chance: Chance,
}

/// Period of the controller, s: the machine's, which both simulators have to keep.
const TACT_S: f64 = 0.002;
/// When the two flashes come, from its middle, s.
const FLASH_S: [f64; 2] = [-0.0005, 0.0005];
/// In which time the servo's sway is forgotten, s.
const SWAY_S: f64 = 0.008;

impl World {
    /// The marks of `lines` on a fresh sheet that did not move, and on the same sheet after it did: the pen
    /// is the same.
    pub fn benches(&self, lines: &ReferenceLines, seed: u64) -> [Bench; 2] {
        let mut chance = Chance::new(seed);
        let pen = Vec2::new(chance.normal(), chance.normal()) * self.pen_mm;
        let mut up_to = |most: f64| most * (2.0 * chance.unit() - 1.0);
        let (angle_rad, shift) = (up_to(0.002), Vec2::new(up_to(5.0), up_to(5.0)));
        let swelling = self.swelling * chance.normal();
        let sheet = Sheet {
            angle_rad,
            shift,
            swelling: [swelling, swelling * self.grain],
            bow_mm: self.bow_mm * chance.normal(),
            joint: lines.joint,
        };
        let still =
            Sheet { angle_rad: 0.0, shift: Vec2::default(), swelling: [0.0; 2], bow_mm: 0.0, ..sheet };
        [self.bench(lines, still, pen, &mut chance), self.bench(lines, sheet, pen, &mut chance)]
    }

    fn bench(&self, lines: &ReferenceLines, sheet: Sheet, pen: Vec2, chance: &mut Chance) -> Bench {
        let spot = Spot::default();
        // Ink leans to one side on a sheet: it was dragged there.
        let drag = if chance.unit() < 0.5 { -1.0 } else { 1.0 };
        let traces = lines.crossings().map(|crossing| {
            let mut trace = Trace::default();
            let is_there = chance.unit() >= self.missed;
            let smear_mm = if chance.unit() < self.smeared {
                drag * (self.smear_mm[0] + (self.smear_mm[1] - self.smear_mm[0]) * chance.unit())
            } else {
                0.0
            };
            if let Some(at_mm) =
                self.seen_at(&sheet, &crossing, &Stroke::mark(&crossing), pen).filter(|_| is_there)
            {
                self.ink(&mut trace, at_mm, self.line_mm, smear_mm, chance);
            }
            for stroke in &self.strokes {
                if let Some(at_mm) = self.seen_at(&sheet, &crossing, stroke, pen) {
                    self.ink(&mut trace, at_mm, self.line_mm * stroke.widened(crossing.axis), 0.0, chance);
                }
            }
            if chance.unit() < self.dust {
                let at_mm = crossing.mark_mm + 12.0 * (2.0 * chance.unit() - 1.0);
                let size_mm = 0.15 + 0.5 * chance.unit();
                trace.grain(at_mm, size_mm, 0.15 * (2.0 * chance.unit() - 1.0));
            }
            trace
        });
        let traces = traces.collect();
        let (latency_s, servo_mm) = (self.latency_s, self.servo_mm);
        Bench { spot, sheet, latency_s, servo_mm, sway_mm: 0.0, traces, chance: chance.split() }
    }

    /// Where the head is when a line is under it, mm along the scan; the pen put it beside the place that was
    /// meant.
    fn seen_at(&self, sheet: &Sheet, crossing: &Crossing, line: &Stroke, pen: Vec2) -> Option<f64> {
        let beside_mm = match crossing.axis {
            Axis::X => pen.x,
            Axis::Y => pen.y,
        };
        sheet.meets(crossing.axis, crossing.scan_at_mm, line, crossing.mark_mm).map(|at_mm| at_mm + beside_mm)
    }

    fn ink(&self, trace: &mut Trace, at_mm: f64, line_mm: f64, smear_mm: f64, chance: &mut Chance) {
        let mut edges = [at_mm - 0.5 * line_mm, at_mm + 0.5 * line_mm];
        for edge in &mut edges {
            *edge += self.texture_mm * chance.normal();
        }
        trace.line(edges, smear_mm);
    }
}

impl Bench {
    /// How its sheet lies.
    pub fn sheet(&self) -> &Sheet {
        &self.sheet
    }

    /// Does what a search asks for until it is done; the seconds that its scans took.
    pub fn run(&mut self, search: &mut impl Search) -> Result<f64, SearchError> {
        let mut tacts = 0.0;
        loop {
            let ask = search.ask();
            match ask {
                Ask::Done => return Ok(tacts * TACT_S),
                Ask::Travel { .. } => {}
                Ask::Scan { crossing, from, axis, to_mm, velocity_mm_s } => {
                    let from_mm = if axis == Axis::X { from.x } else { from.y };
                    let step_mm = velocity_mm_s * TACT_S;
                    let way_mm = (to_mm - from_mm).abs();
                    let mut gone_mm = self.chance.unit() * step_mm.abs();
                    while gone_mm < way_mm && search.ask() == ask {
                        let position_mm = from_mm + gone_mm.copysign(velocity_mm_s);
                        search.tact(self.tact(crossing, position_mm, velocity_mm_s))?;
                        gone_mm += step_mm.abs();
                        tacts += 1.0;
                    }
                }
            }
            search.arrived()?;
        }
    }

    fn tact(&mut self, crossing: usize, position_mm: f64, velocity_mm_s: f64) -> Tact {
        // A servo sways like a ball in honey that is pushed at random.
        let kept = (-TACT_S / SWAY_S).exp();
        self.sway_mm =
            kept * self.sway_mm + (1.0 - kept * kept).sqrt() * self.servo_mm * self.chance.normal();
        let latency_s = self.latency_s[usize::from(velocity_mm_s < 0.0)];
        let mut hits = 0;
        for flash_s in FLASH_S {
            let spot_mm = position_mm + self.sway_mm + velocity_mm_s * (flash_s - latency_s);
            hits += u8::from(self.spot.sees(&self.traces[crossing], spot_mm));
        }
        Tact { position_mm, hits, covered: None }
    }
}
