//! [`speed_trial`]: how far a machine's pen leaves what it should follow, found by drawing a test figure.

use crate::machine::PathDeviation;
use crate::max_error::{FollowedPath, follow};
use core::f64::consts::TAU;
use plotter_motion::{Machine, PlotOp, Point, Vec2};

/// Directions of the star; with lines there and back it has all that a motor can be asked to do.
const HEADINGS: u32 = 16;

/// Size of the figure, mm, where the machine has the room.
const REACH_MM: f64 = 10.0;

/// The test figure: three lines as long as the drawing, `length_mm` or what the area has room for; lines of
/// two lengths in all directions there and back, a circle of short chords both ways round, and a staircase
/// whose steps shrink, in the middle of the machine's area.
#[must_use]
pub fn test_figure(machine: &Machine, length_mm: f64) -> Vec<PlotOp> {
    let area = machine.config().area;
    let centre = Point::new(0.5 * area.width_mm, 0.5 * area.height_mm);
    let reach_mm = REACH_MM.min(0.4 * area.width_mm.min(area.height_mm));
    let draw = |to| PlotOp::Draw { to, feed_mm_s: None };
    let towards = |turns: f64, length_mm: f64| centre + Vec2::new(length_mm, 0.0).rotated(turns * TAU);
    let mut ops = Vec::new();
    let half_mm = 0.5 * length_mm.clamp(reach_mm, 0.8 * area.width_mm.min(area.height_mm));
    // A little off an axis, and far from any.
    for turns in [0.02, 0.21, 0.38] {
        ops.extend([PlotOp::Travel { to: towards(turns, half_mm) }, draw(towards(turns, -half_mm))]);
    }
    for share in [1.0, 0.1] {
        for heading in 0..HEADINGS {
            // Not along the axes alone, nor evenly: no two lines are alike to the motors.
            let turns = (f64::from(heading) + 0.13 * share) / f64::from(HEADINGS);
            ops.extend([PlotOp::Travel { to: centre }, draw(towards(turns, share * reach_mm)), draw(centre)]);
        }
    }
    for (radius_mm, sense) in [(0.5 * reach_mm, 1.0), (0.1 * reach_mm, -1.0)] {
        const CHORDS: u32 = 24;
        ops.push(PlotOp::Travel { to: towards(0.0, radius_mm) });
        ops.extend((1..=CHORDS).map(|i| draw(towards(sense * f64::from(i) / f64::from(CHORDS), radius_mm))));
    }
    let mut at = towards(0.375, 0.9 * reach_mm);
    ops.push(PlotOp::Travel { to: at });
    let mut step_mm = 0.2 * reach_mm;
    for _ in 0..12 {
        for way in [Vec2::new(step_mm, 0.0), Vec2::new(0.0, -step_mm)] {
            at += way;
            ops.push(draw(at));
        }
        step_mm *= 0.8;
    }
    ops
}

/// Greatest distance between what was drawn and what was to be followed, both ways, mm.
#[must_use]
pub fn deviation_mm(path: &FollowedPath) -> f64 {
    let mut most_mm = 0.0_f64;
    for (drawn, commanded) in path.drawn.iter().zip(&path.commanded) {
        let mut deviation = PathDeviation::new(0.25);
        for pair in commanded.windows(2) {
            if let &[from, to] = pair {
                deviation.draw(from, to);
            }
        }
        deviation.lift();
        // Along the drawn path as finely as it was seen: a vertex is compared with places, not with lines.
        for pair in drawn.windows(2) {
            if let &[from, to] = pair {
                let steps = (from.distance(to) / 0.01).ceil().clamp(1.0, 1e6);
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
                (0..=steps as u32).for_each(|i| deviation.step(from.lerp(to, f64::from(i) / steps)));
            }
        }
        if let &[place] = drawn.as_slice() {
            deviation.step(place);
        }
        deviation.lifted();
        let (from_path_mm, from_steps_mm) = deviation.most_mm();
        most_mm = most_mm.max(from_path_mm).max(from_steps_mm);
    }
    most_mm
}

/// Draws the test figure for a drawing `length_mm` long on the simulated machine; how far the pen left it,
/// mm: infinite if the machine does not finish it.
///
/// # Errors
///
/// It cannot be planned.
pub fn speed_trial(machine: &Machine, length_mm: f64, blend_mm: f64) -> Result<f64, String> {
    // The pauses of a serial line are no motion.
    let serial = machine.config().serial.with_byte_gap_ms(0.0);
    let machine = Machine::new(machine.config().with_serial(serial)).map_err(|error| error.to_string())?;
    let path = follow(&machine, &test_figure(&machine, length_mm), blend_mm)?;
    if !path.is_done || path.drawn.len() != path.commanded.len() {
        return Ok(f64::INFINITY);
    }
    Ok(deviation_mm(&path))
}
