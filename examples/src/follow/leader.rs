//! [`Leader`]: the machine that a line follower steers: its camera is led over the lines, then its tool.

use super::command::FollowCommand;
use super::kerf::beside;
use super::led::Led;
use crate::follow::FollowMachine;
use plotter_motion::config::SteppersConfig;
use plotter_motion::drawing::{Drawing, Stroke};
use plotter_motion::{Machine, Point, Vec2};
use plotter_vector::{PxPoint, follow::FollowerConfig};

/// So far outside of the area a place may lie by rounding, mm.
const ROUNDING_MM: f64 = 0.001;

/// A machine on its port, with a camera beside its tool.
#[derive(Debug)]
pub(super) struct Leader {
    led: Led,
    /// From the tool to where the camera looks, mm.
    camera: Vec2,
    kerf_mm: f64,
    area_mm: Vec2,
    /// The longer step of both axes, mm.
    step_mm: f64,
    speed_mm_s: f64,
}

impl Leader {
    /// Opens the machine's port; nothing moves.
    ///
    /// # Errors
    ///
    /// The port's, or that no machine is heard.
    pub(super) fn open(
        machine: &Machine,
        beside: &FollowerConfig,
        port: &str,
        arguments: &FollowCommand,
    ) -> Result<Self, String> {
        let config = machine.config();
        let steppers = SteppersConfig::of(machine);
        let step = |steps_per_mm: f64| 1.0 / steps_per_mm;
        Ok(Self {
            led: Led::open(machine, port, arguments)?,
            camera: Vec2::new(beside.camera_x_mm, beside.camera_y_mm),
            kerf_mm: beside.kerf_mm,
            area_mm: Vec2::new(config.area.width_mm, config.area.height_mm),
            step_mm: step(steppers.x.steps_per_mm).max(step(steppers.y.steps_per_mm)),
            speed_mm_s: steppers.planner.speed_mm_s,
        })
    }

    /// The upper left and the lower right corner, px, of where the camera can be led, and the tool behind it.
    ///
    /// # Errors
    ///
    /// There is no such place, or the start of the way is none.
    pub(super) fn area(
        machine: &Machine,
        beside: &FollowerConfig,
        follow: &FollowMachine,
    ) -> Result<[PxPoint; 2], String> {
        let config = machine.config();
        let half_kerf = 0.5 * beside.kerf_mm;
        let beside = [beside.camera_x_mm, beside.camera_y_mm];
        let size = [config.area.width_mm, config.area.height_mm];
        // The tool reaches 0 to the size, the camera that and its distance from the tool.
        let low = beside.map(|mm| mm.max(0.0) + half_kerf);
        let high = [0, 1].map(|axis| (size[axis] + beside[axis].min(0.0)) - half_kerf);
        let ([least, most], [x, y]) = (follow.area(), [low, high].map(|[x, y]| Point::new(x, y)));
        let (lower_left, upper_right) = (follow.of_sheet(x), follow.of_sheet(y));
        let area = [
            PxPoint::new(least.x.max(lower_left.x), least.y.max(upper_right.y)),
            PxPoint::new(most.x.min(upper_right.x), most.y.min(lower_left.y)),
        ];
        let at = follow.at();
        let holds =
            |at: PxPoint| (area[0].x..=area[1].x).contains(&at.x) && (area[0].y..=area[1].y).contains(&at.y);
        if holds(at) {
            return Ok(area);
        }
        Err(format!(
            "--start: the camera begins at ({:.0}, {:.0}) px, and camera and tool both reach ({:.0}, {:.0}) to ({:.0}, {:.0}) \
             px: see [follower] and [area] of the machine's file",
            at.x, at.y, area[0].x, area[0].y, area[1].x, area[1].y
        ))
    }

    /// Leads the camera to a place of the sheet with the tool lifted; where it is then, as the machine says.
    /// Within a step of that place it is that place: machines tell rounded ones.
    ///
    /// # Errors
    ///
    /// A place outside, or why the machine is not there.
    pub(super) fn look_at(&self, place: Point) -> Result<Point, String> {
        let to = place - self.camera;
        self.is_inside(to)?;
        let told = self.led.go(to)? + self.camera;
        let off = told - place;
        let is_there = off.x.abs().max(off.y.abs()) <= self.step_mm + ROUNDING_MM;
        Ok(if is_there { place } else { told })
    }

    /// Draws lines of the sheet with the tool, half its width beside them.
    ///
    /// # Errors
    ///
    /// A line that leads outside, before anything moves; or why the machine is not at its end.
    pub(super) fn draw(&self, lines: Vec<Vec<Point>>) -> Result<(), String> {
        let strokes = lines.into_iter().filter_map(Stroke::through).collect();
        let mut drawing = Drawing { strokes, ..Drawing::default() };
        drawing.simplify(self.step_mm);
        let places = |stroke: &Stroke| -> Vec<Point> {
            core::iter::once(stroke.from).chain(stroke.segments.iter().map(|segment| segment.to)).collect()
        };
        let lines: Vec<Vec<Point>> =
            drawing.strokes.iter().map(|stroke| beside(&places(stroke), 0.5 * self.kerf_mm)).collect();
        lines.iter().flatten().try_for_each(|place| self.is_inside(*place))?;
        lines.iter().try_for_each(|line| self.led.draw(line, self.speed_mm_s))
    }

    fn is_inside(&self, to: Point) -> Result<(), String> {
        let inside = |at: f64, size: f64| (-ROUNDING_MM..=size + ROUNDING_MM).contains(&at);
        if inside(to.x, self.area_mm.x) && inside(to.y, self.area_mm.y) {
            return Ok(());
        }
        Err(format!(
            "({:.3}, {:.3}) mm lies outside of the machine, which goes from (0, 0) to ({}, {}) mm: nothing has moved there",
            to.x, to.y, self.area_mm.x, self.area_mm.y
        ))
    }
}
