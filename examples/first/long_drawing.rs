//! A drawing of 9.5 m becomes frames for a table of 1 m, and it is told how the sheet lies after it was
//! moved.
//!
//! `cargo run --release --example long_drawing`

use plotter_motion::{PlotOp, Point, Vec2};
use plotter_stitch::sense::SearchSettings;
use plotter_stitch::sheet::{SensedJoint, SensorNoise};
use plotter_stitch::split::FramePasses;
use plotter_stitch::{FrameLayout, FrameTransform, MarkSearch, Optics, ReferenceLines, RigidFit};
use std::io::Write;

/// A zigzag across the sheet, 0.1 m of it with each line.
fn zigzag() -> impl Iterator<Item = PlotOp> {
    (0..=95_u32).map(|n| {
        let to = Point::new(if n % 2 == 0 { 200.0 } else { 800.0 }, 100.0 * f64::from(n));
        if n == 0 { PlotOp::Travel { to } } else { PlotOp::Draw { to, feed_mm_s: None } }
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = std::io::stdout();
    for (number, frame) in (1..).zip(FramePasses::new(zigzag, FrameLayout::default())) {
        let frame = frame?;
        let (ops, cut) = (frame.ops().count(), frame.begin_breaks().len());
        writeln!(out, "frame {number}: {ops} operations, {cut} lines go on from the frame before")?;
    }

    // The sheet was moved, and lies 3 mm too far to the left, 4 mm too far up, and turned: a simulated head
    // looks for 16 marks.
    let sheet = FrameTransform::new(0.0012, Vec2::new(-3.0, 4.0))?;
    let marks: Vec<_> = ReferenceLines::strip16().crossings().collect();
    let mut head = SensedJoint::new(&marks, &sheet, Optics::default(), SensorNoise::default(), 1);
    let mut search = MarkSearch::new(&marks, SearchSettings::default());
    head.run(&mut search)?; // on a machine: do what search.ask() says, tell search.tact(...)
    let joint = RigidFit::default().estimate(&marks, search.found()?)?;

    let (shift, sigma) = (joint.transform.shift(), joint.sigma_shift_mm());
    writeln!(
        out,
        "shift {:.3} mm and {:.3} mm, standard deviations {:.3} and {:.3}",
        shift.x, shift.y, sigma.x, sigma.y
    )?;
    let (turn, sigma) = (1e3 * joint.transform.angle_rad(), 1e3 * joint.sigma_angle_rad());
    writeln!(out, "turn {turn:.4} mrad, standard deviation {sigma:.4}")?;
    let corner = joint.to_machine(Point::new(100.0, 950.0));
    writeln!(out, "what is to be drawn at 100, 950 is drawn at {:.2}, {:.2}", corner.x, corner.y)?;
    Ok(())
}
