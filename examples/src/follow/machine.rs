//! [`FollowMachine`]: the machine under a line follower: its planner and its steps.

use crate::machine::{PlotEvent, SteppedFigures, SteppedPlot};
use plotter_motion::config::SteppersConfig;
use plotter_motion::kinematics::MotorScale;
use plotter_motion::{Machine, Pen, PlannerSettings, PlotOp, Point, stepgen::StepGenSettings};
use plotter_vector::PxPoint;
use plotter_vector::follow::Tool;

/// A drawing lies so far inside of the machine's area where there is room, px: a table that misses could not
/// go to its rim otherwise.
const AROUND_PX: f64 = 40.0;

/// Steps are told in ways of this length, px: less than what a picture shows.
const TOLD_PX: f64 = 0.5;

/// A machine that makes a line follower's moves, each planned from rest to rest, since the next picture
/// decides what comes then. Places are in pixels on the paper, y down; the machine has its origin at the
/// lower left, a little outside of the drawing.
#[derive(Debug)]
pub struct FollowMachine {
    plot: SteppedPlot,
    mm_per_px: f64,
    height_px: f64,
    area_px: [f64; 2],
    around_px: [f64; 2],
    speed_mm_s: f64,
    at: PxPoint,
}

impl FollowMachine {
    /// A machine whose camera has gone from the origin to `start`, over a drawing of `size_px`, or over all
    /// of its area.
    ///
    /// # Errors
    ///
    /// A setting out of range, or a start that the machine cannot reach.
    pub fn new(
        machine: &Machine,
        mm_per_px: f64,
        size_px: Option<[f64; 2]>,
        start: Option<[f64; 2]>,
    ) -> Result<Self, String> {
        let config = machine.config();
        let steppers = SteppersConfig::of(machine);
        let motor = |steps_per_mm| MotorScale { steps_per_mm, inverted: false };
        let motors = [motor(steppers.x.steps_per_mm), motor(steppers.y.steps_per_mm)];
        let finest = motors[0].steps_per_mm.max(motors[1].steps_per_mm);
        // Places come from a picture, and no file has rounded them.
        let settings = PlannerSettings {
            resolution_mm: 0.5 / finest,
            allowance_mm: 0.0,
            ..PlannerSettings::of(machine)
        };
        let reach = [config.area.width_mm, config.area.height_mm].map(|mm| mm / mm_per_px);
        let size = size_px.unwrap_or(reach);
        let area_px = [size[0].min(reach[0]), size[1].min(reach[1])];
        let around = |reach: f64, area: f64| (0.5 * (reach - area)).clamp(0.0, AROUND_PX);
        let around_px = [around(reach[0], area_px[0]), around(reach[1], area_px[1])];
        let [x, y] = start.unwrap_or([0.5 * area_px[0], 0.5 * area_px[1]]);
        if !(0.0..=area_px[0]).contains(&x) || !(0.0..=area_px[1]).contains(&y) {
            return Err(format!(
                "--start {x},{y}: the machine reaches 0..={:.0}, 0..={:.0} px of it",
                area_px[0], area_px[1]
            ));
        }
        let mut started = Self {
            plot: SteppedPlot::new(settings, StepGenSettings::of(machine), motors)?,
            mm_per_px,
            height_px: area_px[1] + around_px[1],
            area_px,
            around_px,
            speed_mm_s: settings.speed_mm_s,
            at: PxPoint::new(-around_px[0], area_px[1] + around_px[1]),
        };
        started.make(&[PxPoint::new(x, y)], Tool::Up, &mut |_, _| {})?;
        Ok(started)
    }

    /// The upper left and the lower right corner of what the tool reaches, px.
    #[must_use]
    pub fn area(&self) -> [PxPoint; 2] {
        let ([width, height], [x, y]) = (self.area_px, self.around_px);
        [PxPoint::new(-x, -y), PxPoint::new(width + x, height + y)]
    }

    /// Where the motors stand.
    #[must_use]
    pub const fn at(&self) -> PxPoint {
        self.at
    }

    /// Seconds since the machine left the origin.
    #[must_use]
    pub fn now_s(&self) -> f64 {
        self.plot.now_s()
    }

    /// A place on the sheet, mm.
    #[must_use]
    pub fn on_sheet(&self, place: PxPoint) -> Point {
        Point {
            x: (place.x + self.around_px[0]) * self.mm_per_px,
            y: (self.height_px - place.y) * self.mm_per_px,
        }
    }

    /// That place of the picture.
    #[must_use]
    pub fn of_sheet(&self, place: Point) -> PxPoint {
        PxPoint {
            x: place.x / self.mm_per_px - self.around_px[0],
            y: self.height_px - place.y / self.mm_per_px,
        }
    }

    /// What a move is for the planner.
    #[must_use]
    pub fn op(&self, to: PxPoint, tool: Tool) -> PlotOp {
        let to = self.on_sheet(to);
        match tool {
            Tool::Down => PlotOp::Draw { to, feed_mm_s: Some(self.speed_mm_s) },
            Tool::Up => PlotOp::Travel { to },
        }
    }

    /// Makes a move, from rest to rest, and tells where its steps lead; returns the seconds that it takes.
    ///
    /// # Errors
    ///
    /// A place that cannot be planned.
    pub fn make(
        &mut self,
        path: &[PxPoint],
        tool: Tool,
        each: &mut impl FnMut(PxPoint, Tool),
    ) -> Result<f64, String> {
        let before = self.plot.now_s();
        let (mm_per_px, left_px, height_px) = (self.mm_per_px, self.around_px[0], self.height_px);
        let mut told = self.at;
        let mut at = self.at;
        let mut is_down = tool;
        let mut take = |event: PlotEvent| match event {
            PlotEvent::Pen(pen) => is_down = if pen == Pen::Down { Tool::Down } else { Tool::Up },
            PlotEvent::Step { at: place, .. } => {
                at = PxPoint::new(place.x / mm_per_px - left_px, height_px - place.y / mm_per_px);
                if at.distance(told) >= TOLD_PX {
                    told = at;
                    each(at, is_down);
                }
            }
            _ => {}
        };
        for to in path {
            let op = self.op(*to, tool);
            self.plot.push(op, &mut take).map_err(|error| format!("the machine cannot do that: {error}"))?;
        }
        self.plot.rest(&mut take).map_err(|error| error.to_string())?;
        self.at = at;
        if at.distance(told) > 0.0 {
            each(at, tool);
        }
        Ok(self.plot.now_s() - before)
    }

    /// The machine has stopped for good.
    ///
    /// # Errors
    ///
    /// Never, as far as is known.
    pub fn finish(self) -> Result<SteppedFigures, String> {
        self.plot.finish(&mut |_| {}).map_err(|error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MACHINE: &str = include_str!("../../machines/plasma-follower.toml");

    #[test]
    fn a_move_ends_where_the_motors_stand() {
        let machine = Machine::from_toml(MACHINE).unwrap();
        let mut moved = FollowMachine::new(&machine, 0.1, Some([300.0, 200.0]), Some([10.0, 20.0])).unwrap();
        assert_eq!(moved.area(), [PxPoint::new(-40.0, -40.0), PxPoint::new(340.0, 240.0)]);
        let mut places = Vec::new();
        // 30.03 px to the right are 240.24 steps of an eighth of a pixel.
        let to = PxPoint::new(40.03, 20.0);
        let seconds = moved.make(&[to], Tool::Down, &mut |at, tool| places.push((at, tool))).unwrap();
        assert!((moved.at().x - 40.0).abs() < 1e-9 && (moved.at().y - 20.0).abs() < 1e-9, "{:?}", moved.at());
        assert!(places.len() > 40, "{}", places.len());
        assert!(places.iter().all(|(at, tool)| at.x < 40.0 + 1e-9 && *tool == Tool::Down), "{places:?}");
        // 3 mm at 18 mm/s, 250 mm/s²: 3 / 18 + 18 / 250, and 0.8 s for the torch.
        assert!((seconds - 0.8 - 3.0 / 18.0 - 18.0 / 250.0).abs() < 0.01, "{seconds}");
        assert_eq!(moved.on_sheet(moved.at()), Point { x: 8.0, y: 22.0 });
    }

    #[test]
    fn a_start_out_of_reach_is_told() {
        let machine = Machine::from_toml(MACHINE).unwrap();
        let refused = FollowMachine::new(&machine, 0.1, Some([300.0, 200.0]), Some([301.0, 20.0]));
        assert!(refused.unwrap_err().contains("reaches 0..=300"));
        // 1000 mm of the machine are 10,000 px of the drawing.
        let wide = FollowMachine::new(&machine, 0.1, Some([20_000.0, 200.0]), None).unwrap();
        assert_eq!(wide.area(), [PxPoint::new(0.0, -40.0), PxPoint::new(10_000.0, 240.0)]);
    }
}
