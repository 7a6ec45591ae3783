//! [`Front`] makes blocks of plot operations. It finds the corners, and rounds them in tolerance mode.

#[cfg(feature = "third-motor")]
mod rising;

use super::block::{Bend, Block, Kind};
use super::fit::{Fitter, Piece};
use super::junction::corner_speed2;
use super::limits::{Limits, Share, Shares};
use super::merge::{Merged, Pace};
use super::modes::{Keep as _, Modes};
use super::ring::{Ring, narrow};
#[cfg(feature = "third-motor")]
use super::rise::Rise;
use super::rounding::{CHORD_SHARE, MERGED_SHARE, PutOff, SHORTEST_MM, Vertex, Waiting as _};
use super::stretch::{Stretch, Way, direction};
use super::{PathMode, PlanError, PlannerSettings, Shape};
use crate::extremes::least;
use crate::geom::{Vec2Single, single};
use crate::toolpath::chords::DividedArc;
use crate::whole::nearest;
use crate::{Pen, PlotOp, Point};
use core::f32::consts::TAU;

/// Farthest place that is accepted, mm: 10 km, far beyond any sheet, while squares of lengths within it stay
/// far from the greatest `f32`.
const FARTHEST_MM: f32 = 1e7;
/// Greatest relative rounding of an arc's radius and of a product with it: four last bits of `f32`.
const RADIUS_ROUNDING: f32 = 5e-7;

/// The end of the last block of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Exit {
    direction: [f32; 2],
    length_mm: f32,
    cruise2: f32,
}

/// Lines and arcs with the same pen, which the machine passes without a stop unless a corner asks for one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Run {
    pen: Pen,
    /// The end of the blocks that were given out.
    at: Point,
    exit: Option<Exit>,
}

/// Makes blocks of plot operations, with the next segments held back until it is known what follows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Front<M: Modes> {
    position: Point,
    pen: Pen,
    power: u16,
    run: Option<Run>,
    /// Square of the greatest speed on a segment that is too short for a block and is held back; 0 if none
    /// is.
    short_cruise2: f32,
    put_off: M::Kept<PutOff>,
    shares: M::Kept<Shares>,
    /// Whether lines are jogs.
    jogs: bool,
    #[cfg(feature = "third-motor")]
    pub(super) rise: M::Rise<Rise>,
}

impl<M: Modes> Front<M> {
    pub(super) fn new() -> Self {
        Self::at(Point::ORIGIN)
    }

    fn at(position: Point) -> Self {
        Self {
            position,
            pen: Pen::Up,
            power: u16::MAX,
            run: None,
            short_cruise2: 0.0,
            put_off: M::Kept::default(),
            shares: M::Kept::default(),
            jogs: false,
            #[cfg(feature = "third-motor")]
            rise: M::Rise::default(),
        }
    }

    /// The end of the path that was pushed.
    pub(super) fn position(&self) -> Point {
        self.arc_end().unwrap_or(self.position)
    }

    /// The end of an arc whose chords have not all been given out.
    fn arc_end(&self) -> Option<Point> {
        self.put_off.rounding().and_then(|rounding| rounding.arc).map(|arc| arc.to)
    }

    /// Whether an arc has chords left. They come before anything else is taken.
    pub(super) fn has_chords(&self) -> bool {
        M::ALL && self.arc_end().is_some()
    }

    /// Takes chords of the arc as long as there is room. Says whether there were any.
    pub(super) fn take_chords<const N: usize>(&mut self, limits: &Limits, ring: &mut Ring<N>) -> bool {
        let mut any = false;
        while ring.room() >= Self::most_blocks(&limits.settings)
            && let Some(arc) = self.put_off.rounding_mut().and_then(|rounding| rounding.arc.as_mut())
        {
            let (place, cruise2) = (arc.next_place(), arc.cruise2);
            if arc.is_over()
                && let Some(rounding) = self.put_off.rounding_mut()
            {
                rounding.arc = None;
            }
            if let Some(to) = place {
                self.line(&to, Pen::Down, cruise2, limits, ring);
                any = true;
            }
        }
        any
    }

    /// Starts again at another place, with the pen up.
    pub(super) fn restart(&mut self, position: Point) {
        let shares = core::mem::take(&mut self.shares);
        #[cfg(feature = "third-motor")]
        let rise = {
            let mut rise = core::mem::take(&mut self.rise);
            if let Some(rise) = rise.get_mut() {
                *rise = rise.restarted();
            }
            rise
        };
        *self = Self {
            power: self.power,
            shares,
            #[cfg(feature = "third-motor")]
            rise,
            ..Self::at(position)
        };
    }

    /// Most blocks that one operation gives. In exact mode: a short segment that was held back, and the new
    /// one. With an allowance: two arcs, the rest of the way to the last vertex, and the new one. In
    /// tolerance mode: the end of a run (twice a line and a parabola, and the line held back), and the new
    /// one.
    pub(super) const fn most_blocks(settings: &PlannerSettings) -> usize {
        match settings.path_of::<M>() {
            PathMode::Exact if settings.allowance_of::<M>() > 0.0 => 4,
            PathMode::Exact => 2,
            PathMode::Tolerance { .. } => 6,
        }
    }

    pub(super) fn push<const N: usize>(
        &mut self,
        op: PlotOp,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) -> Result<(), PlanError> {
        if core::mem::take(&mut self.jogs) {
            self.end_run(limits, ring);
        }
        if let Some(to) = op.target() {
            check(&to)?;
        }
        let feed2 = |feed_mm_s: Option<f64>| match feed_mm_s {
            None => Ok(limits.speed2),
            Some(feed_mm_s) => Limits::speed2(feed_mm_s, limits.speed2).ok_or(PlanError::Feed { feed_mm_s }),
        };
        match op {
            PlotOp::Travel { to } => {
                self.line(&to, Pen::Up, limits.travel2, limits, ring);
            }
            PlotOp::Draw { to, feed_mm_s } => {
                self.line(&to, Pen::Down, feed2(feed_mm_s)?, limits, ring);
            }
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                check(&centre)?;
                let feed2 = feed2(feed_mm_s)?;
                let sweep_single = single(sweep_rad);
                // A sweep counts as a whole turn within its last bit, 5·10⁻⁷.
                if !(-TAU..=TAU).contains(&sweep_single) {
                    return Err(PlanError::Sweep { sweep_rad });
                }
                self.arc(&centre, sweep_single, &to, feed2, limits, ring);
            }
            PlotOp::LaserPower { .. } if !M::LASER => {}
            PlotOp::LaserPower { share } => {
                if !(0.0..=1.0).contains(&share) {
                    return Err(PlanError::Power { share });
                }
                let power = u16::try_from(nearest(share * f64::from(u16::MAX))).unwrap_or(u16::MAX);
                // The segment that was held back has the old power; in tolerance mode each line has its own.
                if limits.settings.path_of::<M>() == PathMode::Exact {
                    self.flush(limits, ring);
                }
                self.power = power;
            }
            PlotOp::Dwell { duration } => self.stand(Block::dwell(duration), limits, ring),
            PlotOp::SelectPen { pen } => self.stand(Block::select_pen(pen), limits, ring),
            PlotOp::NewPage => self.stand(Block::new_page(), limits, ring),
        }
        Ok(())
    }

    /// A travel at this speed, or at the travel speed if that is lower. Overrides do not change it.
    pub(super) fn jog<const N: usize>(
        &mut self,
        to: &Point,
        speed_mm_s: f64,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) -> Result<(), PlanError> {
        check(to)?;
        let speed2 = Limits::speed2(speed_mm_s, limits.travel2);
        let speed2 = speed2.ok_or(PlanError::Feed { feed_mm_s: speed_mm_s })?;
        if !self.jogs {
            self.end_run(limits, ring);
            self.jogs = true;
        }
        self.line(to, Pen::Up, speed2, limits, ring);
        Ok(())
    }

    /// Applies other overrides, to the blocks in the ring too. `under_way2` is the square of the greatest
    /// speed on the course under way.
    pub(super) fn rescale<const N: usize>(
        &mut self,
        shares: Shares,
        under_way2: f32,
        forced2: f32,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) {
        if let Some(kept) = self.shares.get_mut() {
            *kept = shares;
        }
        let last2 = ring.rescale(&shares, limits, under_way2, forced2);
        if let Some(exit) = self.run.as_mut().and_then(|run| run.exit.as_mut()) {
            exit.cruise2 = last2;
        }
    }

    /// Ends the run: segments that were held back are given out, and the machine stops.
    pub(super) fn end_run<const N: usize>(&mut self, limits: &Limits, ring: &mut Ring<N>) {
        self.flush(limits, ring);
        self.run = None;
        if let PathMode::Tolerance { .. } = limits.settings.path_of::<M>()
            && let Some(rounding) = self.put_off.rounding_mut()
        {
            rounding.merger.has_arcs = false;
        }
    }

    /// Lifts the pen where it stands, if it is down.
    pub(super) fn lift<const N: usize>(&mut self, limits: &Limits, ring: &mut Ring<N>) {
        if self.pen == Pen::Down {
            self.put_pen(Pen::Up, limits, ring);
        }
    }

    fn stand<const N: usize>(&mut self, block: Block, limits: &Limits, ring: &mut Ring<N>) {
        self.end_run(limits, ring);
        if matches!(block.kind, Kind::SelectPen | Kind::NewPage) {
            self.pen = Pen::Up;
        }
        ring.push(block);
    }

    /// The run with this pen: the current one, or a new one.
    fn run<const N: usize>(&mut self, pen: Pen, limits: &Limits, ring: &mut Ring<N>) -> Run {
        match self.run {
            Some(run) if run.pen == pen => run,
            _ => {
                self.end_run(limits, ring);
                let run = Run { pen, at: self.position, exit: None };
                self.run = Some(run);
                run
            }
        }
    }

    fn line<const N: usize>(
        &mut self,
        to: &Point,
        pen: Pen,
        cruise2: f32,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) {
        let from = self.position;
        if *to == from {
            if pen != self.pen {
                self.put_pen(pen, limits, ring);
            }
            return;
        }
        let run = self.run(pen, limits, ring);
        self.pen = pen;
        self.position = *to;
        match limits.settings.path_of::<M>() {
            PathMode::Exact if limits.settings.allowance_of::<M>() > 0.0 && !self.jogs => {
                self.fit(&from, to, cruise2, limits, ring);
            }
            PathMode::Exact => {
                let way = Way::new(run.at.way_to(to));
                if way.length_mm < limits.resolution_mm() {
                    self.short_cruise2 = cruise2;
                } else {
                    self.short_cruise2 = 0.0;
                    self.emit_way(to, way, cruise2, limits, ring);
                }
            }
            PathMode::Tolerance { path_tolerance_mm } => {
                let Some(rounding) = self.put_off.rounding_mut() else { return };
                let start = rounding.held.map_or(run.at, |held| held.to);
                let within_mm = MERGED_SHARE * rounding.within_mm(path_tolerance_mm);
                let pace = Pace { cruise2, power: self.power };
                let merged = rounding.merger.push(start, from, *to, pace, within_mm);
                if let Some(merged) = merged {
                    self.blend(merged, path_tolerance_mm, limits, ring);
                }
            }
        }
    }

    /// Takes the next vertex in exact mode with an allowance; `from` is the previous one. If no single arc
    /// fits with it, the piece in progress ends.
    fn fit<const N: usize>(
        &mut self,
        from: &Point,
        to: &Point,
        cruise2: f32,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) {
        let allowance_mm = narrow(limits.settings.allowance_of::<M>());
        let mut may_shorten = !self.put_off.fitter().is_some_and(|fitter| fitter.is_other(cruise2));
        if !may_shorten {
            self.end_fit(from, limits, ring);
        }
        loop {
            let (Some(run), Some(fitter)) = (self.run, self.put_off.fitter_mut()) else { return };
            let way = run.at.way_to(to);
            if fitter.take(way, cruise2, allowance_mm) {
                return;
            }
            let piece = if may_shorten { fitter.shorten(way, allowance_mm) } else { None };
            may_shorten = false;
            match piece {
                Some(piece) => {
                    let end = run.at + piece.way;
                    self.emit_piece(piece, &end, cruise2, limits, ring);
                }
                None if fitter.is_empty() => return,
                None => {
                    self.end_fit(from, limits, ring);
                }
            }
        }
    }

    /// Ends the piece in progress at its last vertex or within the allowance of it. Gives the square of the
    /// greatest speed on it.
    fn end_fit<const N: usize>(&mut self, at: &Point, limits: &Limits, ring: &mut Ring<N>) -> Option<f32> {
        let (run, fitter) = (self.run?, self.put_off.fitter_mut()?);
        if fitter.is_empty() {
            return None;
        }
        let cruise2 = fitter.cruise2();
        match fitter.end(narrow(limits.settings.allowance_of::<M>())) {
            Some(piece) => {
                let end = if piece.at_vertex { *at } else { run.at + piece.way };
                self.emit_piece(piece, &end, cruise2, limits, ring);
            }
            // A whole stroke may lie within the allowance of its start. It ends there.
            None if *at == run.at && run.exit.is_none() => self.dot(run.pen, ring),
            None => self.emit_line(at, cruise2, limits, ring),
        }
        Some(cruise2)
    }

    fn emit_piece<const N: usize>(
        &mut self,
        piece: Piece,
        end: &Point,
        cruise2: f32,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) {
        let Some(run) = self.run else { return };
        if piece.sweep_rad == 0.0 {
            return self.emit_line(end, cruise2, limits, ring);
        }
        let radius_mm = single(piece.radius_mm) * (1.0 - RADIUS_ROUNDING);
        let arc = Stretch {
            shape: Shape::Arc { centre: run.at + piece.to_centre, sweep_rad: single(piece.sweep_rad) },
            to: *end,
            length_mm: single(piece.length_mm),
            entry: direction(piece.entry),
            exit: direction(piece.exit),
            feed2: cruise2,
            bend: Bend::Arc { sweep_rad: single(piece.sweep_rad), form2: limits.turning_round() * radius_mm },
        };
        self.emit(arc, limits, ring);
    }

    /// The pen is lowered where it stands, which leaves a dot, or lifted.
    fn put_pen<const N: usize>(&mut self, pen: Pen, limits: &Limits, ring: &mut Ring<N>) {
        self.end_run(limits, ring);
        self.pen = pen;
        self.dot(pen, ring);
    }

    fn dot<const N: usize>(&self, pen: Pen, ring: &mut Ring<N>) {
        ring.push(Block::path(
            Shape::Line,
            self.position,
            0.0,
            (pen, self.power),
            0.0,
            Bend::Line { accel: 0.0 },
        ));
    }

    fn arc<const N: usize>(
        &mut self,
        centre: &Point,
        sweep_rad: f32,
        to: &Point,
        cruise2: f32,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) {
        let (out, end) = (centre.way_to(&self.position), centre.way_to(to));
        let (out_mm, end_mm) = (out.length_near(), end.length_near());
        let near_mm = least(out_mm, end_mm);
        let length_mm = 0.5 * (out_mm + end_mm) * sweep_rad.abs();
        if least(length_mm, near_mm) <= limits.resolution_mm() {
            return self.line(to, Pen::Down, cruise2, limits, ring);
        }
        self.run(Pen::Down, limits, ring);
        if let PathMode::Tolerance { path_tolerance_mm } = limits.settings.path_of::<M>()
            && let Some(rounding) = self.put_off.rounding_mut()
        {
            let chord_mm = CHORD_SHARE * path_tolerance_mm;
            let mut arc = DividedArc::new(self.position, *centre, sweep_rad.into(), *to, chord_mm);
            arc.cruise2 = cruise2;
            rounding.arc = Some(arc);
            rounding.merger.has_arcs = true;
            self.take_chords(limits, ring);
            return;
        }
        self.flush(limits, ring);
        self.pen = Pen::Down;
        self.position = *to;
        // The tangent: a quarter turn ahead of the radius, or behind it.
        let side = if sweep_rad > 0.0 { 1.0 } else { -1.0 };
        let ahead = |radius: Vec2Single| Way::new(radius.perpendicular().times(side)).direction;
        let shape = Shape::Arc { centre: *centre, sweep_rad };
        // Reduced by the rounding of the radius.
        let form2 = limits.turning_round() * near_mm * (1.0 - RADIUS_ROUNDING);
        let (entry, exit) = (ahead(out), ahead(end));
        let bend = Bend::Arc { sweep_rad, form2 };
        self.emit(Stretch { shape, to: *to, length_mm, entry, exit, feed2: cruise2, bend }, limits, ring);
    }

    /// Gives out the segments that were held back. The run goes on.
    fn flush<const N: usize>(&mut self, limits: &Limits, ring: &mut Ring<N>) {
        let cruise2 = core::mem::take(&mut self.short_cruise2);
        if cruise2 > 0.0 {
            let at = self.position;
            self.emit_line(&at, cruise2, limits, ring);
        }
        let at = self.position;
        let allowance_mm = narrow(limits.settings.allowance_of::<M>());
        if let (Some(run), Some(fitter)) = (self.run, self.put_off.fitter_mut())
            && let Some((piece, cruise2)) = fitter.shorten_to_end(allowance_mm)
        {
            let end = run.at + piece.way;
            self.emit_piece(piece, &end, cruise2, limits, ring);
        }
        if let Some(cruise2) = self.end_fit(&at, limits, ring) {
            // If no arc within the allowance ends there, the last bit is a line.
            self.emit_line(&at, cruise2, limits, ring);
            if let Some(fitter) = self.put_off.fitter_mut() {
                *fitter = Fitter::default();
            }
        }
        if let PathMode::Tolerance { path_tolerance_mm } = limits.settings.path_of::<M>() {
            if let Some(merged) = self.put_off.rounding_mut().and_then(|rounding| rounding.merger.end(at)) {
                self.blend(merged, path_tolerance_mm, limits, ring);
            }
            let last = self.put_off.rounding_mut().and_then(|rounding| rounding.held.take());
            if let Some(held) = last {
                self.round(&held.to, 0.0, held.pace, limits, ring);
                let power = core::mem::replace(&mut self.power, held.pace.power);
                self.emit_line(&held.to, held.pace.cruise2, limits, ring);
                self.power = power;
            }
        }
    }

    /// Takes the next segment in tolerance mode. The corner before it may now be moved, so the corner before
    /// that one is rounded.
    fn blend<const N: usize>(
        &mut self,
        next: Merged,
        path_tolerance_mm: f64,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) {
        let (Some(run), Some(rounding)) = (self.run, self.put_off.rounding_mut()) else { return };
        let Some(held) = rounding.held.replace(next) else { return };
        let within_mm = rounding.within_mm(path_tolerance_mm);
        let (asked, moved) = rounding.corner.map_or((run.at, run.at), |corner| (corner.asked, corner.moved));
        let before = rounding.corner;
        // Both the curve at this corner and the one before it need room.
        let may_be = |vertex: &Vertex| {
            let in_mm = (vertex.moved - moved).length_near();
            let tangent_mm = if before.is_some() { 0.5 * in_mm } else { in_mm };
            vertex.is_passed((&moved, &next.to), tangent_mm, next.pace, limits)
                && before.is_none_or(|before| {
                    let in_mm = (before.moved - run.at).length_near();
                    before.is_passed((&run.at, &vertex.moved), in_mm, held.pace, limits)
                })
        };
        let vertex = Vertex::new(&asked, (&held, &next), within_mm, limits, may_be);
        let next_mm = vertex.most_tangent_mm(&asked, &next.to);
        self.round(&vertex.moved, next_mm, held.pace, limits, ring);
        if let Some(rounding) = self.put_off.rounding_mut() {
            rounding.corner = Some(vertex);
        }
    }

    /// Rounds the last corner. From there the path goes on to `to`, the next corner, which can use no more
    /// than `next_mm` of the line between, at the pace `after`.
    fn round<const N: usize>(
        &mut self,
        to: &Point,
        next_mm: f64,
        after: Pace,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) {
        let corner = self.put_off.rounding_mut().and_then(|rounding| rounding.corner.take());
        let (Some(corner), Some(run)) = (corner, self.run) else { return };
        let power = core::mem::replace(&mut self.power, corner.before.power);
        // The blocks given out so far reach to the end of the curve at the previous corner.
        let (way_in, way_out) = (corner.moved - run.at, *to - corner.moved);
        let (in_mm, out_mm) = (way_in.length_near(), way_out.length_near());
        let ways = (way_in * (1.0 / in_mm), way_out * (1.0 / out_mm));
        let blend = if in_mm > 0.0 && out_mm > 0.0 {
            // The next corner keeps its half of the line between, or as much as it can use.
            corner.blend(ways, in_mm.min((0.5 * out_mm).max(out_mm - next_mm)), after, limits)
        } else {
            None
        };
        if let Some((tangent_mm, curve)) = blend {
            // Given out however short it is: the curve must begin exactly here.
            if in_mm - tangent_mm > SHORTEST_MM {
                let begin = corner.moved - ways.0 * tangent_mm;
                let way = Way { length_mm: single(in_mm - tangent_mm), direction: direction(ways.0) };
                self.emit_way(&begin, way, corner.before.cruise2, limits, ring);
            }
            self.emit(curve, limits, ring);
        } else {
            self.emit_line(&corner.moved, corner.before.cruise2, limits, ring);
        }
        self.power = power;
    }

    fn emit_line<const N: usize>(&mut self, to: &Point, cruise2: f32, limits: &Limits, ring: &mut Ring<N>) {
        if let Some(run) = self.run {
            self.emit_way(to, Way::new(run.at.way_to(to)), cruise2, limits, ring);
        }
    }

    /// Gives out a line unless its length is 0.
    fn emit_way<const N: usize>(
        &mut self,
        to: &Point,
        way: Way,
        cruise2: f32,
        limits: &Limits,
        ring: &mut Ring<N>,
    ) {
        let Way { length_mm, direction } = way;
        if length_mm > 0.0 {
            let line = Stretch {
                shape: Shape::Line,
                to: *to,
                length_mm,
                entry: direction,
                exit: direction,
                feed2: cruise2,
                bend: Bend::Line { accel: limits.along(direction) },
            };
            self.emit(line, limits, ring);
        }
    }

    /// Gives out a block with the speed that the corner at its start allows.
    fn emit<const N: usize>(&mut self, stretch: Stretch, limits: &Limits, ring: &mut Ring<N>) {
        let Some(run) = &mut self.run else { return };
        #[cfg(feature = "third-motor")]
        let (stretch, rising2) = match self.rise.get_mut() {
            Some(rise) => rise.take(stretch, limits),
            None => (stretch, f32::INFINITY),
        };
        let Stretch { shape, to, length_mm, entry, exit, feed2, bend } = stretch;
        let share = match run.pen {
            _ if self.jogs => Share::Jog,
            Pen::Up => Share::Travel,
            Pen::Down => Share::Draw,
        };
        let asked2 = self.shares.get().map_or(feed2, |shares| shares.of(share, feed2, limits));
        let mut block = Block::path(shape, to, length_mm, (run.pen, self.power), feed2, bend);
        let cruise2 = least(asked2, block.form2());
        block.cruise2 = cruise2;
        if self.jogs && block.kind == Kind::Line {
            block.kind = Kind::Jog;
        }
        if let Some(before) = run.exit {
            let shorter_mm = least(before.length_mm, length_mm);
            let ([x, y], [u, v]) = (before.direction, entry);
            // A path that turns nearly straight back has no room for a curve. In tolerance mode no velocity
            // may jump, so the machine stops there.
            let is_stop = limits.settings.path_of::<M>() != PathMode::Exact && x * u + y * v < 0.0;
            let corner2 = corner_speed2(before.direction, entry, shorter_mm, limits);
            block.corner2 = if is_stop { 0.0 } else { corner2 };
            #[cfg(feature = "third-motor")]
            if M::Z {
                block.corner2 = least(block.corner2, rising2);
            }
            block.max_entry2 = least(block.corner2, least(before.cruise2, cruise2));
        }
        run.at = to;
        run.exit = Some(Exit { direction: exit, length_mm, cruise2 });
        ring.push(block);
    }
}

/// Checks that a place is near enough.
#[cfg_attr(target_os = "none", inline(never))]
fn check(place: &Point) -> Result<(), PlanError> {
    let near = single(place.x).abs() <= FARTHEST_MM && single(place.y).abs() <= FARTHEST_MM;
    if near { Ok(()) } else { Err(PlanError::Place { place: *place }) }
}
