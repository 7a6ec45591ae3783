//! [`AxisController`] and [`ContourController`]: what a controller of one's own has to answer.

use crate::{Demand, Duty};

/// Input of a controller of one axis, in encoder counts from the start of the line, and seconds.
///
/// There are two answers to where the axis is. [`count`](Self::count) is the plain one: the middle of the
/// interval that the encoder shows, up to half a count wrong. [`position`](Self::position) and
/// [`speed`](Self::speed) are those of a [`ShaftEstimator`](super::ShaftEstimator), which knows from the
/// times of the edges where the shaft is between them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisState {
    /// Where the axis should be now, counts.
    pub reference: f32,
    /// How fast it should move, counts/s.
    pub reference_speed: f32,
    /// How it should gain speed, counts/s^2.
    pub reference_accel: f32,
    /// Where the line ends, counts.
    pub target: f32,
    /// Where the encoder says that the axis is, whole counts.
    pub count: f32,
    /// Where it is as far as the times of the edges tell, counts.
    pub position: f32,
    /// How fast it moves as far as they tell, counts/s.
    pub speed: f32,
    /// What moves it beyond what the machine's description says, as far as they tell, counts/s^2.
    pub disturbance: f32,
    /// How far the axis was behind its reference at the last edge since the last run, counts: the one thing
    /// that is measured exactly. `None` if there was no edge.
    pub edge_error: Option<f32>,
}

impl AxisState {
    /// How far the axis is behind its reference, counts.
    ///
    /// ```
    /// # use plotter_motion::control::AxisState;
    /// let state = AxisState { reference: 12.0, position: 11.5, ..AxisState::default() };
    /// assert_eq!(state.error(), 0.5);
    /// ```
    #[must_use]
    pub fn error(&self) -> f32 {
        self.reference - self.position
    }

    /// How much too slow it is, counts/s.
    #[must_use]
    pub fn speed_error(&self) -> f32 {
        self.reference_speed - self.speed
    }
}

/// Leads one axis along a reference: the place to begin with a controller of one's own.
///
/// ```
/// # use plotter_motion::control::{AxisController, AxisState};
/// # use plotter_motion::Duty;
/// /// An eighth of the supply for each count that the axis is behind.
/// struct Proportional;
///
/// impl AxisController for Proportional {
///     fn update(&mut self, state: &AxisState, _dt_s: f32) -> Duty {
///         Duty::saturating(0.125 * state.error())
///     }
/// }
///
/// let state = AxisState { reference: 12.0, position: 7.0, ..AxisState::default() };
/// assert_eq!(Proportional.update(&state, 1e-4).value(), 0.625);
/// ```
pub trait AxisController {
    /// A line begins: what belonged to the last one may be forgotten. `duration_s` is how long the reference
    /// takes.
    fn start(&mut self, duration_s: f32) {
        let _ = duration_s;
    }

    /// The duty from now on, `dt_s` seconds after the last call.
    fn update(&mut self, state: &AxisState, dt_s: f32) -> Duty;
}

/// Input of a controller of both axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContourState {
    /// The first axis.
    pub x: AxisState,
    /// The second axis.
    pub y: AxisState,
    /// Unit vector of the line, in counts.
    pub direction: [f32; 2],
    /// How far the reference has come along its plan, s; it goes slower than time while the pen lags far
    /// behind.
    pub plan_s: f32,
    /// Time since the last run, s.
    pub dt_s: f32,
}

impl ContourState {
    /// How far beside the line the pen is, counts: positive where it would have to go to the left of its
    /// direction.
    ///
    /// ```
    /// # use plotter_motion::control::{AxisState, ContourState};
    /// let behind = |error| AxisState { reference: error, ..AxisState::default() };
    /// let state = ContourState { x: behind(3.0), y: behind(2.0), direction: [1.0, 0.0], ..ContourState::default() };
    /// assert_eq!((state.across_error(), state.along_error()), (2.0, 3.0));
    /// ```
    #[must_use]
    pub fn across_error(&self) -> f32 {
        self.across(self.x.error(), self.y.error())
    }

    /// How far the pen is behind along the line, counts.
    #[must_use]
    pub fn along_error(&self) -> f32 {
        let [ux, uy] = self.direction;
        self.x.error() * ux + self.y.error() * uy
    }

    /// How fast it would have to go to the left, counts/s.
    #[must_use]
    pub fn across_speed_error(&self) -> f32 {
        self.across(self.x.speed_error(), self.y.speed_error())
    }

    fn across(&self, x: f32, y: f32) -> f32 {
        let [ux, uy] = self.direction;
        y * ux - x * uy
    }
}

/// Leads both axes along a line at once, and so can look at the distance from the line itself.
///
/// [`PlannedLine`](super::PlannedLine) makes a [`LineController`](super::LineController) of it.
pub trait ContourController {
    /// A line begins; `duration_s` is how long its reference takes.
    fn start(&mut self, duration_s: f32) {
        let _ = duration_s;
    }

    /// Both duties from now on.
    fn update(&mut self, state: &ContourState) -> Demand;
}

/// Two controllers of one axis each, which know nothing of each other.
///
/// ```
/// # use plotter_motion::control::{AxisController, AxisState, ContourController, ContourState, TwoAxes};
/// # use plotter_motion::Duty;
/// # #[derive(Clone)]
/// struct Fixed(f32);
/// impl AxisController for Fixed {
///     fn update(&mut self, _state: &AxisState, _dt_s: f32) -> Duty {
///         Duty::saturating(self.0)
///     }
/// }
/// let demand = TwoAxes { x: Fixed(0.25), y: Fixed(0.5) }.update(&ContourState::default());
/// assert_eq!((demand.x.value(), demand.y.value()), (0.25, 0.5));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwoAxes<X, Y = X> {
    /// The first axis' controller.
    pub x: X,
    /// The second axis' controller.
    pub y: Y,
}

impl<X: AxisController, Y: AxisController> ContourController for TwoAxes<X, Y> {
    fn start(&mut self, duration_s: f32) {
        self.x.start(duration_s);
        self.y.start(duration_s);
    }

    fn update(&mut self, state: &ContourState) -> Demand {
        Demand { x: self.x.update(&state.x, state.dt_s), y: self.y.update(&state.y, state.dt_s) }
    }
}
