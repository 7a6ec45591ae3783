//! [`Planner`]: the look-ahead as a whole.

use super::block::Kind;
use super::front::Front;
use super::limits::{Limits, Shares, Wish};
use super::modes::{AllModes, Keep as _, Modes};
use super::ring::{Ring, narrow};
#[cfg(feature = "third-motor")]
use super::rise::{Heights, ZLimits};

use super::time_law::TimeLaw;
use super::{Action, PlanError, PlannerSettings};
use crate::extremes::smaller;
use crate::seconds::duration;
use crate::{PlotOp, Point};

/// Least and greatest override, as shares of a speed: a hundredth to a hundredfold. They keep squares of
/// speeds finite and above 0; Grbl's own overrides are 0.1 to 2.
const LEAST_SHARE: f64 = 0.01;
const MOST_SHARE: f64 = 100.0;

/// Plans the motion along a tool path while it comes in: look-ahead over `N` blocks.
///
/// Push operations until it is full, and take actions when the motors want them; [`Planner::finish`] at the
/// end lifts the pen. An action that was taken cannot be changed. The more is known by then, the faster the
/// machine goes, so keep the planner full. The machine can always stop within the path that was pushed, and
/// does so if nothing more comes.
///
/// - Strokes and travels begin and end at rest. A travel of several lines is one.
/// - Corners and arcs obey the limits of [`PlannerSettings`]; see there for the ways to follow a path.
/// - A line to where the pen stands is a dot, if the pen was up; a travel to there lifts it.
///
/// Source of the look-ahead over squares of speeds, forwards and backwards: S. K. Jeon, documentation of the
/// grbl project's planner (2011).
///
/// ```
/// # use plotter_motion::{Planner, PlannerSettings, PlotOp, Point, planner::Action};
/// // 10 mm at 1000 mm/s²: 0.1 s up to 100 mm/s and 0.1 s down
/// let mut planner = Planner::<16>::new(PlannerSettings::default())?;
/// planner.push(PlotOp::Travel { to: Point::new(10.0, 0.0) })?;
/// planner.finish()?;
/// let mut time_s = 0.0;
/// while let Some(action) = planner.next_action() {
///     if let Action::Phase(phase) = action {
///         time_s += phase.duration_s;
///     }
/// }
/// assert!((time_s - 0.2).abs() < 1e-6);
/// # Ok::<(), plotter_motion::planner::PlanError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Planner<const N: usize, M: Modes = AllModes> {
    limits: Limits,
    front: Front<M>,
    ring: Ring<N>,
    /// Whether blocks were added since the ring was planned, or a phase of an S-curve was chosen.
    stale: bool,
    /// The rest of the course that was given out last.
    time_law: TimeLaw<M>,
    /// Whether the machine is to stop on the path.
    hold: bool,
    /// The course that was given out last, whose greatest speed changes with the overrides.
    under_way: M::Kept<Wish>,
    #[cfg(feature = "third-motor")]
    heights: M::Rise<Heights<N>>,
}

impl<const N: usize> Planner<N> {
    /// A planner of a machine that stands at the origin with its pen up.
    ///
    /// # Errors
    ///
    /// [`PlanError::Setting`] for a limit that no motion can be planned with.
    pub fn new(settings: PlannerSettings) -> Result<Self, PlanError> {
        Self::with_modes(settings)
    }
}

impl<const N: usize, M: Modes> Planner<N, M> {
    /// Room for all blocks that one operation can give, and no more than are counted.
    const ENOUGH: () = assert!(N >= 8 && N <= u16::MAX as usize, "a planner needs 8 to 65,535 blocks");

    /// As [`Planner::new`], with the modes of its type.
    ///
    /// ```
    /// # use plotter_motion::{Planner, PlannerSettings, planner::{ExactOnly, PlanError}};
    /// let settings = PlannerSettings { jerk_mm_s3: Some(20_000.0), ..PlannerSettings::default() };
    /// let refused = Planner::<16, ExactOnly>::with_modes(settings);
    /// assert_eq!(refused.err(), Some(PlanError::Mode { quantity: "jerk_mm_s3" }));
    /// assert!(Planner::<16>::new(settings).is_ok());
    /// ```
    ///
    /// # Errors
    ///
    /// [`PlanError::Mode`] for a mode that is not among them, and as [`Planner::new`].
    pub fn with_modes(settings: PlannerSettings) -> Result<Self, PlanError> {
        settings.check::<M>()?;
        if settings.vector_jerk().is_some() {
            return Err(PlanError::Averaging { quantity: "a planner by itself" });
        }
        Ok(Self::of_checked(&settings))
    }

    /// The same, with settings that have been checked.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn of_checked(settings: &PlannerSettings) -> Self {
        () = Self::ENOUGH;
        let limits = Limits::of(settings);
        Self {
            limits,
            front: Front::new(),
            ring: Ring::new(),
            stale: false,
            time_law: TimeLaw::over(&limits),
            hold: false,
            under_way: M::Kept::default(),
            #[cfg(feature = "third-motor")]
            heights: M::Rise::default(),
        }
    }

    /// The limits.
    #[must_use]
    pub const fn settings(&self) -> &PlannerSettings {
        &self.limits.settings
    }

    /// Whether [`Planner::push`] takes another operation now.
    #[must_use]
    pub fn has_room(&self) -> bool {
        // Where z lifts the pen, that is a block more.
        let most = Front::<M>::most_blocks(&self.limits.settings);
        #[cfg(feature = "third-motor")]
        let most = most + usize::from(self.front.rise.get().is_some_and(|rise| rise.pen_mm.is_some()));
        self.ring.room() >= most && !self.front.has_chords()
    }

    /// Whether no action is left, also after a feed hold. Operations that are held back come after
    /// [`Planner::rest`] or [`Planner::finish`].
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ring.len() == 0 && !self.front.has_chords() && self.time_law.is_over()
    }

    /// Number of blocks that are known and not begun.
    pub(crate) const fn blocks(&self) -> usize {
        self.ring.len()
    }

    /// The end of the path that was pushed, mm.
    #[must_use]
    pub fn position(&self) -> Point {
        self.front.position()
    }

    /// Takes the next operation.
    ///
    /// # Errors
    ///
    /// [`PlanError::Full`] when there is no room. Any other error says what is wrong with the operation,
    /// which is then left out.
    pub fn push(&mut self, op: PlotOp) -> Result<(), PlanError> {
        if !self.has_room() {
            return Err(PlanError::Full);
        }
        self.stale = true;
        #[cfg(feature = "third-motor")]
        if M::Z {
            self.lift_for(&op)?;
        }
        #[cfg(feature = "third-motor")]
        let before = self.ring.len();
        let pushed = self.front.push(op, &self.limits, &mut self.ring);
        #[cfg(feature = "third-motor")]
        self.note_heights(before);
        pushed
    }

    /// All blocks behind the first `before` end at the height that the path has come to.
    #[cfg(feature = "third-motor")]
    fn note_heights(&mut self, before: usize) {
        if let (Some(heights), Some(rise)) = (self.heights.get_mut(), self.front.rise.get()) {
            for _ in before..self.ring.len() {
                heights.push(rise.at_mm);
            }
        }
    }

    /// Takes a travel at this speed, mm/s, or at the travel speed if that is lower.
    /// [`Planner::override_speeds`] does not change it.
    ///
    /// # Errors
    ///
    /// As [`Planner::push`].
    pub fn push_jog(&mut self, to: Point, speed_mm_s: f64) -> Result<(), PlanError> {
        if !self.has_room() {
            return Err(PlanError::Full);
        }
        self.stale = true;
        #[cfg(feature = "third-motor")]
        let before = self.ring.len();
        let pushed = self.front.jog(&to, speed_mm_s, &self.limits, &mut self.ring);
        #[cfg(feature = "third-motor")]
        self.note_heights(before);
        pushed
    }

    /// Multiplies the requested speeds by these shares from now on, with the pen down and up: a person at the
    /// machine makes it slower or faster. The speed changes within the limits, along the path, from the end
    /// of the phase that was taken last (47 ms at most). No share makes the machine faster than the limits of
    /// [`PlannerSettings`]. Shares are clamped to 0.01 to 100.
    ///
    /// Without [`AllModes`] nothing changes.
    ///
    /// ```
    /// # use plotter_motion::{Planner, PlannerSettings, PlotOp, Point, planner::{Action, PlanError}};
    /// // 100 mm at 100 mm/s², 10 mm/s: 0.1 s up, 9.9 s, 0.1 s down
    /// let settings = PlannerSettings { speed_mm_s: 50.0, accel_mm_s2: 100.0, ..PlannerSettings::default() };
    /// let mut planner = Planner::<16>::new(settings)?;
    /// planner.push(PlotOp::Draw { to: Point::new(100.0, 0.0), feed_mm_s: Some(10.0) })?;
    /// planner.finish()?;
    /// planner.override_speeds(2.0, 1.0);
    /// let mut time_s = 0.0_f64;
    /// while let Some(action) = planner.next_action() {
    ///     if let Action::Phase(phase) = action {
    ///         time_s += f64::from(phase.duration_s);
    ///     }
    /// }
    /// assert!((time_s - 5.2).abs() < 1e-6); // 20 mm/s: 0.2 s and 2 mm up, 4.8 s for 96 mm, 0.2 s down
    /// # Ok::<(), PlanError>(())
    /// ```
    pub fn override_speeds(&mut self, draw_share: f64, travel_share: f64) {
        let Some(under_way) = self.under_way.get() else { return };
        let square = |share: f64| {
            let share = if share > LEAST_SHARE { smaller(share, MOST_SHARE) } else { LEAST_SHARE };
            narrow(share * share)
        };
        let shares = Shares { draw2: square(draw_share), travel2: square(travel_share) };
        let limits = self.limits;
        let under_way2 = under_way.cruise2(&shares, &limits);
        if self.time_law.choose_anew() {
            self.front.rescale(shares, f32::INFINITY, 0.0, &limits, &mut self.ring);
            return;
        }
        if self.stale {
            self.plan();
        }
        let (forced2, next2) = self.time_law.forced2(&self.ring);
        self.front.rescale(shares, under_way2, forced2, &limits, &mut self.ring);
        self.time_law.change_speed((under_way2, next2), self.hold, &mut self.ring, &limits);
    }

    /// Ends the drawing. Operations that were held back are planned, the machine stops at the end of the
    /// path, and the pen is lifted there. Another drawing may be pushed afterwards.
    ///
    /// ```
    /// # use plotter_motion::{Pen, Planner, PlannerSettings, PlotOp, Point, planner::{Action, PlanError}};
    /// let mut planner = Planner::<16>::new(PlannerSettings::default())?;
    /// planner.push(PlotOp::Draw { to: Point::new(10.0, 0.0), feed_mm_s: None })?;
    /// planner.finish()?;
    /// let mut pens = Vec::new();
    /// while let Some(action) = planner.next_action() {
    ///     if let Action::Course(course) = action {
    ///         pens.push(course.pen);
    ///     }
    /// }
    /// assert_eq!(pens, [Pen::Down, Pen::Up]);
    /// # Ok::<(), PlanError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`PlanError::Full`] when there is no room for it.
    pub fn finish(&mut self) -> Result<(), PlanError> {
        self.rest()?;
        #[cfg(feature = "third-motor")]
        if M::Z {
            self.lift_for(&PlotOp::Travel { to: self.position() })?;
        }
        #[cfg(feature = "third-motor")]
        let before = self.ring.len();
        self.front.lift(&self.limits, &mut self.ring);
        #[cfg(feature = "third-motor")]
        self.note_heights(before);
        Ok(())
    }

    /// Says that no operation comes for now. Operations that were held back are planned, and the machine
    /// stops at the end of the path with the pen as it is. More of the same drawing may be pushed afterwards.
    ///
    /// # Errors
    ///
    /// [`PlanError::Full`] when there is no room for it.
    pub fn rest(&mut self) -> Result<(), PlanError> {
        if !self.has_room() {
            return Err(PlanError::Full);
        }
        self.stale = true;
        #[cfg(feature = "third-motor")]
        let before = self.ring.len();
        self.front.end_run(&self.limits, &mut self.ring);
        #[cfg(feature = "third-motor")]
        self.note_heights(before);
        Ok(())
    }

    /// Forgets everything: the machine has been stopped and stands at `position`, its pen up. The laser's
    /// power stays chosen.
    pub fn clear(&mut self, position: Point) {
        self.front.restart(position);
        self.ring.clear();
        #[cfg(feature = "third-motor")]
        if let Some(heights) = self.heights.get_mut() {
            heights.clear();
        }
        self.time_law = TimeLaw::over(&self.limits);
        self.hold = false;
    }

    /// Feed hold: the machine brakes along the path within its limits and stops as soon as it can. Actions
    /// come until it stands; then there are none until [`Planner::resume`]. More may be pushed meanwhile.
    ///
    /// Phases that were taken are still carried out. A phase lasts 47 ms at most, or a little more on a line
    /// that takes six years.
    pub fn hold(&mut self) {
        self.hold = true;
        self.time_law.choose_again();
        self.time_law.brake(&mut self.ring, &self.limits);
    }

    /// Whether a feed hold is in force and the machine stands.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.hold && self.time_law.stands(&self.ring)
    }

    /// Ends a feed hold: the machine goes on from where it is.
    pub fn resume(&mut self) {
        if core::mem::take(&mut self.hold) {
            self.time_law.choose_again();
            self.time_law.go_on(&mut self.ring, &self.limits);
        }
    }

    /// Does a part of what [`next_action`](Self::next_action) has to do, and says whether there is more to do
    /// before that only has to give it out. For a main loop that has other things to do between: with a
    /// limited jerk a phase takes a search of up to some ten parts. Nothing depends on it but when the work
    /// is done.
    ///
    /// ```
    /// # use plotter_motion::{Planner, PlannerSettings, PlotOp, Point, planner::PlanError};
    /// let settings = PlannerSettings { jerk_mm_s3: Some(20_000.0), ..PlannerSettings::default() };
    /// let mut planner = Planner::<16>::new(settings)?;
    /// for (x, y) in [(5.0, 0.0), (9.0, 1.0), (20.0, 1.5), (30.0, 0.0)] {
    ///     planner.push(PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None })?;
    /// }
    /// planner.finish()?;
    /// let mut parts = 0;
    /// loop {
    ///     while planner.prepare() {
    ///         parts += 1; // bytes could be received here
    ///     }
    ///     if planner.next_action().is_none() {
    ///         break;
    ///     }
    /// }
    /// assert!(parts > 10);
    /// # Ok::<(), PlanError>(())
    /// ```
    pub fn prepare(&mut self) -> bool {
        self.time_law.choose_part(&self.ring, &self.limits, self.hold, &mut self.stale)
    }

    /// Plans the blocks that were added.
    fn plan(&mut self) {
        self.stale = false;
        self.ring.plan(&self.limits);
    }

    /// The next action for the motors; `None` when nothing is known, or the machine is held.
    pub fn next_action(&mut self) -> Option<Action> {
        if let Some(phase) = self.time_law.next_ramp() {
            return Some(Action::Phase(phase));
        }
        self.after_ramps()
    }

    /// As [`Planner::next_action`], for a caller that never holds the machine: a phase, and how many like it
    /// make the ramp.
    pub(crate) fn next_ramp(&mut self) -> Option<(Action, u32)> {
        if let Some((phase, count)) = self.time_law.next_whole_ramp() {
            return Some((Action::Phase(phase), count));
        }
        self.after_ramps().map(|action| (action, 1))
    }

    /// The next action other than a phase with constant acceleration.
    #[cfg_attr(target_os = "none", inline(never))] // most actions are phases
    fn after_ramps(&mut self) -> Option<Action> {
        if let Some(phase) =
            self.time_law.next_s_curve(&mut self.ring, &self.limits, self.hold, &mut self.stale)
        {
            return Some(Action::Phase(phase));
        }
        if self.is_held() {
            return None;
        }
        #[cfg(feature = "third-motor")]
        let before = self.ring.len();
        if self.front.has_chords() && self.front.take_chords(&self.limits, &mut self.ring) {
            self.stale = true;
        }
        #[cfg(feature = "third-motor")]
        self.note_heights(before);
        let head = self.ring.get(0)?;
        let action = match head.kind {
            Kind::Line | Kind::Jog | Kind::Arc | Kind::Parabola => Action::Course(head.course()),
            #[cfg(feature = "third-motor")]
            Kind::Helix => Action::Course(head.course()),
            Kind::Dwell => Action::Dwell(duration(f64::from(head.length())).unwrap_or_default()),
            Kind::SelectPen => Action::SelectPen(head.number()),
            Kind::NewPage => Action::NewPage,
        };
        #[cfg(feature = "third-motor")]
        let (action, head) = (self.rising(action), self.ring.get(0)?);
        if !self.time_law.begin_s_curve(head) {
            if let Some(under_way) = self.under_way.get_mut() {
                *under_way = head.wish();
            }
            // Blocks are planned only when an action needs it: once for many blocks, if they are short.
            if self.stale && head.is_path() && !self.ring.next_is_settled() {
                self.plan();
            }
            self.time_law.begin_ramps(&mut self.ring, &self.limits);
            if self.hold {
                self.time_law.brake(&mut self.ring, &self.limits);
            }
        }
        Some(action)
    }
}

#[cfg(feature = "third-motor")]
impl<const N: usize, M: Modes> Planner<N, M> {
    /// What the third axis can do: nothing until this is told. Only with [`ThreeAxes`](super::ThreeAxes).
    ///
    /// # Errors
    ///
    /// [`PlanError::Setting`] for a limit that no motion can be planned with, [`PlanError::Mode`] where
    /// there is no third axis.
    pub fn set_z_limits(&mut self, limits: &ZLimits) -> Result<(), PlanError> {
        limits.check()?;
        if !M::Z {
            return Err(PlanError::Mode { quantity: "z" });
        }
        if let Some(rise) = self.front.rise.get_mut() {
            rise.set_limits(limits);
        }
        Ok(())
    }

    /// Takes an operation at whose end the tool stands at another height: a line, or an arc, along which z
    /// changes evenly, or z alone where the operation names the place that the path has come to. The speed
    /// that it asks for is one in space.
    ///
    /// The limits of [`Planner::set_z_limits`] hold on the way. Where the path goes on with another slope,
    /// z's speed jumps by no more than its acceleration makes within a step; before and after z alone, and
    /// with a limited jerk before and after all that rises, the machine stands. No vertex is rounded. With a
    /// limited jerk a [`Course`](super::Course) may be told in other units: see its length.
    ///
    /// ```
    /// # use plotter_motion::{Planner, PlannerSettings, PlotOp, Point};
    /// # use plotter_motion::planner::{Action, PlanError, ThreeAxes, ZLimits};
    /// let mut planner = Planner::<16, ThreeAxes>::with_modes(PlannerSettings::default())?;
    /// planner.set_z_limits(&ZLimits { speed_mm_s: 5.0, accel_mm_s2: 50.0, step_mm: 0.0025 })?;
    /// // 10 mm of z alone at 5 mm/s, with 0.1 s and 0.25 mm to speed up and to brake
    /// planner.push_rising(PlotOp::Travel { to: Point::ORIGIN }, 10.0)?;
    /// planner.finish()?;
    /// let mut time_s = 0.0;
    /// while let Some(action) = planner.next_action() {
    ///     match action {
    ///         Action::Course(course) => assert_eq!((course.to_z_mm, course.length_mm), (Some(10.0), 10.0)),
    ///         Action::Phase(phase) => time_s += phase.duration_s,
    ///         _ => {}
    ///     }
    /// }
    /// assert!((time_s - 2.1).abs() < 0.01, "{time_s}");
    /// # Ok::<(), PlanError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`PlanError::Mode`] where there is no third axis, [`PlanError::Unknown`] for an operation that goes
    /// nowhere, and as [`Planner::push`].
    pub fn push_rising(&mut self, op: PlotOp, to_z_mm: f64) -> Result<(), PlanError> {
        self.rise(op, to_z_mm, None)
    }

    /// As [`Planner::push_jog`], to another height.
    ///
    /// # Errors
    ///
    /// As [`Planner::push_rising`].
    pub fn jog_rising(&mut self, to: Point, to_z_mm: f64, speed_mm_s: f64) -> Result<(), PlanError> {
        self.rise(PlotOp::Travel { to }, to_z_mm, Some(speed_mm_s))
    }

    fn rise(&mut self, op: PlotOp, to_z_mm: f64, jog_mm_s: Option<f64>) -> Result<(), PlanError> {
        if !self.has_room() {
            return Err(PlanError::Full);
        }
        self.rise_with_room(op, to_z_mm, jog_mm_s)
    }

    fn rise_with_room(&mut self, op: PlotOp, to_z_mm: f64, jog_mm_s: Option<f64>) -> Result<(), PlanError> {
        let Some(rise) = self.front.rise.get().filter(|rise| rise.has_limits()) else {
            return Err(PlanError::Mode { quantity: "z" });
        };
        #[expect(clippy::float_cmp, reason = "the same height, told again")]
        if rise.at_mm == to_z_mm {
            return match (op, jog_mm_s) {
                (PlotOp::Travel { to }, Some(speed_mm_s)) => self.push_jog(to, speed_mm_s),
                _ => self.push(op),
            };
        }
        let feed2 = Front::<M>::checked_rising(&op, to_z_mm, jog_mm_s, &self.limits)?;
        self.stale = true;
        let before = self.ring.len();
        self.front.before_rise(&op, jog_mm_s.is_some(), &self.limits, &mut self.ring);
        self.note_heights(before);
        let before = self.ring.len();
        self.front.push_rising(op, to_z_mm, feed2, &self.limits, &mut self.ring);
        self.note_heights(before);
        Ok(())
    }

    /// From here on z lifts the pen: to these heights with the pen up and down, mm, at a standstill of the
    /// other two. The machine stands where the pen is up.
    pub fn set_pen_heights(&mut self, up_mm: f64, down_mm: f64) {
        if let Some(rise) = self.front.rise.get_mut() {
            rise.pen_mm = Some([up_mm, down_mm]);
        }
    }

    /// With the height at which it ends.
    fn rising(&mut self, action: Action) -> Action {
        let Some(heights) = self.heights.get_mut() else { return action };
        let to_z_mm = heights.first();
        heights.pop();
        match action {
            Action::Course(course) => Action::Course(super::Course { to_z_mm, ..course }),
            _ => action,
        }
    }

    /// Brings the pen to the height of an operation, where z lifts it.
    fn lift_for(&mut self, op: &PlotOp) -> Result<(), PlanError> {
        let Some([up_mm, down_mm]) = self.front.rise.get().and_then(|rise| rise.pen_mm) else {
            return Ok(());
        };
        let height_mm = match op {
            PlotOp::Travel { .. } | PlotOp::SelectPen { .. } | PlotOp::NewPage => up_mm,
            PlotOp::Draw { .. } | PlotOp::DrawArc { .. } => down_mm,
            _ => return Ok(()),
        };
        if self.height_mm().to_bits() == height_mm.to_bits() {
            return Ok(());
        }
        self.rise_with_room(PlotOp::Travel { to: self.position() }, height_mm, None)
    }

    /// The height at the end of what was pushed, mm.
    #[must_use]
    pub fn height_mm(&self) -> f64 {
        self.front.rise.get().map_or(0.0, |rise| rise.at_mm)
    }

    /// The tool stands at this height: after [`Planner::clear`], or before anything is pushed.
    pub fn stand_at_height(&mut self, height_mm: f64) {
        if let Some(rise) = self.front.rise.get_mut() {
            rise.at_mm = height_mm;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planner(jerk_mm_s3: Option<f64>) -> Planner<16> {
        Planner::new(PlannerSettings { jerk_mm_s3, ..PlannerSettings::default() }).unwrap()
    }

    #[test]
    fn a_path_that_is_held_is_not_empty() {
        for jerk_mm_s3 in [None, Some(20_000.0)] {
            let mut planner = planner(jerk_mm_s3);
            planner.push(PlotOp::Draw { to: Point::new(100.0, 0.0), feed_mm_s: None }).unwrap();
            planner.finish().unwrap();
            assert!(matches!(planner.next_action(), Some(Action::Course(_))));
            assert!(matches!(planner.next_action(), Some(Action::Phase(_))));
            planner.hold();
            while planner.next_action().is_some() {}
            assert!(planner.is_held() && !planner.is_empty(), "{jerk_mm_s3:?}");
            planner.resume();
            while planner.next_action().is_some() {}
            assert!(planner.is_empty(), "{jerk_mm_s3:?}");
        }
    }

    #[test]
    fn after_a_stop_the_pen_is_up_and_a_dot_lowers_it() {
        let mut planner = planner(None);
        let at = Point::new(5.0, 0.0);
        planner.push(PlotOp::Draw { to: Point::new(10.0, 0.0), feed_mm_s: None }).unwrap();
        planner.clear(at);
        planner.push(PlotOp::Draw { to: at, feed_mm_s: None }).unwrap();
        let course = planner.next_action();
        assert!(
            matches!(course, Some(Action::Course(course)) if course.pen == crate::Pen::Down),
            "{course:?}"
        );
    }

    #[test]
    fn no_speed_is_too_slow_or_too_fast_for_its_square() {
        let length_mm = 1e-3;
        for feed_mm_s in [0.0, 1e-30, 1e-23, 9e-17, 1e39, f64::INFINITY, f64::NAN, -1.0] {
            let refused = planner(None)
                .push(PlotOp::Draw { to: Point::new(length_mm, 0.0), feed_mm_s: Some(feed_mm_s) });
            assert!(matches!(refused, Err(PlanError::Feed { .. })), "{feed_mm_s}");
        }
        for (feed_mm_s, share) in [(1.1e-16, 1.0), (1.1e-16, 0.01), (1e38, 1.0)] {
            let mut planner = planner(None);
            planner.override_speeds(share, 1.0);
            let to = Point::new(1.0, 0.0);
            planner.push(PlotOp::Draw { to, feed_mm_s: Some(feed_mm_s) }).unwrap();
            planner.finish().unwrap();
            let mut fastest = 0.0_f64;
            for action in core::iter::from_fn(|| planner.next_action()).take(100) {
                if let Action::Phase(phase) = action {
                    fastest = fastest.max(phase.speed_mm_s.into());
                }
            }
            // 1 mm at 1000 mm/s²: up to the root of 1000 mm/s.
            let most = (feed_mm_s * share).min(libm::sqrt(1000.0));
            assert!((fastest / most - 1.0).abs() < 1e-5, "{feed_mm_s}, {share}: {fastest}");
        }
    }

    #[test]
    fn sixteen_blocks_take_at_most_1600_bytes() {
        use super::super::{ExactOnly, ExactPen};
        let sizes = [
            size_of::<Planner<16, ExactPen>>(),
            size_of::<Planner<16, ExactOnly>>(),
            size_of::<Planner<16>>(),
        ];
        assert!(sizes.iter().all(|&size| size <= 1600), "{sizes:?}");
    }
}
