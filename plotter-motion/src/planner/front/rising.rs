//! The part of a [`Front`] for a third axis: operations that end at another height.

use super::{Front, RADIUS_ROUNDING, check};
use crate::extremes::least;
use crate::geom::{Vec2Single, single};
use crate::planner::block::Bend;
use crate::planner::limits::Limits;
use crate::planner::modes::{Keep as _, Modes};
use crate::planner::ring::Ring;
use crate::planner::stretch::{Stretch, Way};
use crate::planner::{PlanError, Shape};
use crate::{Pen, PlotOp, Point};
use core::f32::consts::TAU;

impl<M: Modes> Front<M> {
    /// Gives out what was held back: what comes next ends at another height.
    pub(in crate::planner) fn before_rise<const N: usize>(
        &mut self,
        op: &PlotOp,
        jogs: bool,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) {
        let pen = if matches!(op, PlotOp::Travel { .. }) { Pen::Up } else { Pen::Down };
        if jogs == self.jogs && self.run.is_some_and(|run| run.pen == pen) {
            self.flush(limits, ring);
        } else {
            self.end_run(limits, ring);
        }
        self.jogs = jogs;
    }

    /// Takes an operation that ends at another height: a line, an arc, or z alone where it names the place
    /// where the path has come to. It is given out as it is, whatever the way to follow a path.
    pub(in crate::planner) fn push_rising<const N: usize>(
        &mut self,
        op: PlotOp,
        height_mm: f64,
        feed2: f32,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) {
        let (pen, to, arc) = match op {
            PlotOp::DrawArc { centre, sweep_rad, to, .. } => {
                let (out, end) = (centre.way_to(&self.position), centre.way_to(&to));
                let (out_mm, end_mm) = (out.length_near(), end.length_near());
                let sweep_rad = single(sweep_rad);
                let length_mm = 0.5 * (out_mm + end_mm) * sweep_rad.abs();
                let near_mm = least(out_mm, end_mm);
                let is_arc = least(length_mm, near_mm) > limits.resolution_mm();
                (Pen::Down, to, is_arc.then_some((centre, sweep_rad, (out, end), near_mm, length_mm)))
            }
            PlotOp::Draw { to, .. } => (Pen::Down, to, None),
            _ => (Pen::Up, op.target().unwrap_or(self.position), None),
        };
        let from = self.position;
        self.run(pen, limits, ring);
        (self.pen, self.position) = (pen, to);
        let Some(rise) = self.rise.get_mut() else { return };
        rise.go_to(height_mm);
        let stretch = if let Some((centre, sweep_rad, (out, end), near_mm, length_mm)) = arc {
            let side = if sweep_rad > 0.0 { 1.0 } else { -1.0 };
            let ahead = |radius: Vec2Single| Way::new(radius.perpendicular().times(side)).direction;
            let form2 = limits.turning_round() * near_mm * (1.0 - RADIUS_ROUNDING);
            let bend = Bend::Arc { sweep_rad, form2 };
            let shape = Shape::Arc { centre, sweep_rad };
            Stretch { shape, to, length_mm, entry: ahead(out), exit: ahead(end), feed2, bend }
        } else {
            let Way { length_mm, direction } = Way::new(from.way_to(&to));
            let bend = Bend::Line { accel: if length_mm > 0.0 { limits.along(direction) } else { 0.0 } };
            Stretch { shape: Shape::Line, to, length_mm, entry: direction, exit: direction, feed2, bend }
        };
        self.emit(stretch, limits, ring);
    }

    /// What is asked of an operation that rises: the square of its speed.
    pub(in crate::planner) fn checked_rising(
        op: &PlotOp,
        height_mm: f64,
        jog_mm_s: Option<f64>,
        limits: &Limits,
    ) -> Result<f32, PlanError> {
        let Some(to) = op.target() else { return Err(PlanError::Unknown) };
        check(&to)?;
        check(&Point::new(0.0, height_mm))?;
        let (asked, most2) = match *op {
            PlotOp::Draw { feed_mm_s, .. } => (feed_mm_s, limits.speed2),
            PlotOp::DrawArc { centre, sweep_rad, feed_mm_s, .. } => {
                check(&centre)?;
                if !(-TAU..=TAU).contains(&single(sweep_rad)) {
                    return Err(PlanError::Sweep { sweep_rad });
                }
                (feed_mm_s, limits.speed2)
            }
            _ => (jog_mm_s, limits.travel2),
        };
        asked.map_or(Ok(most2), |feed_mm_s| {
            Limits::speed2(feed_mm_s, most2).ok_or(PlanError::Feed { feed_mm_s })
        })
    }
}
