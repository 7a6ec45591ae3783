//! [`TestBed`]: a controller on simulated motors, and how far from the line the pen truly was.

use super::{Figures, HandlingTimes, LateLoop, misjudged};
use crate::config::DcConfig;
use crate::control::LineController;
use crate::plant::{AxisPlant, DriveDelay};
use crate::{
    Axis, ConfigError, Demand, Direction, Drive, LimitSwitches, Machine, Pen, PenMove, Point, SafetyGate,
    Segment, StepPoint, config::MachineKind,
};
use core::time::Duration;

/// How a run on the test bed is made and measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct TestBedSettings {
    /// Time step of the motors; the nearest of 1 us to 1 ms counts.
    pub time_step: Duration,
    /// How long a controller may take for a target before it is given the next one, and the line counts as
    /// never finished.
    pub limit: Duration,
    /// How long the pen is watched after the last arrival.
    pub watch_on: Duration,
    /// How near to the target the pen must stay to have settled, mm.
    pub settled_mm: f64,
    /// By which share the description that controllers are given is wrong ([`misjudged`]).
    pub wrong_share: f64,
    /// By how much the runs of the controller's loop are late.
    pub late_loop: LateLoop,
    /// How long the controller's processor works on each thing: what comes meanwhile waits.
    pub handling: HandlingTimes,
}

impl Default for TestBedSettings {
    /// Steps of 10 us; 5 s a target; settled within 0.05 mm, two counts of the gantry's encoder, watched for
    /// 0.1 s; a description that is a quarter wrong.
    fn default() -> Self {
        Self {
            time_step: Duration::from_micros(10),
            limit: Duration::from_secs(5),
            watch_on: Duration::from_millis(100),
            settled_mm: 0.05,
            wrong_share: 0.25,
            late_loop: LateLoop::default(),
            handling: HandlingTimes::default(),
        }
    }
}

/// State of a run at one time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time since the start.
    pub time: Duration,
    /// Where the pen is to go, mm.
    pub target: Point,
    /// Where the controller wants it to be now, mm; the nearest place of the line for a controller that does
    /// not say.
    pub desired: Point,
    /// Where it truly is, mm.
    pub pen: Point,
    /// The place of the line that is nearest to it, mm.
    pub nearest: Point,
    /// Distance of the pen from the line, mm.
    pub error_mm: f64,
    /// Whether this is part of the drawing, and measured: the pen is down and has not arrived.
    pub is_measured: bool,
}

/// Simulated motors on a bench, and the description of them that controllers are given: wrong on purpose.
///
/// ```
/// # use plotter_motion::control::LineTracking;
/// # use plotter_motion::testbed::{TestBed, TestBedSettings};
/// # use plotter_motion::{Machine, MachineConfig, Pen, PenMove, StepPoint};
/// let bed = TestBed::new(&Machine::new(MachineConfig::default())?, TestBedSettings::default())?;
/// let line = [PenMove { pen: Pen::Down, target: StepPoint::new(400, 0) }]; // 10 mm to the right
/// let figures = bed.run(&mut LineTracking::new(bed.described()), line, |_moment| ());
/// assert!(figures.is_finished());
/// assert!(figures.max_mm < 0.5); // one motor alone cannot leave its line, but go beyond its end
/// # Ok::<(), plotter_motion::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TestBed {
    machine: Machine,
    described: Machine,
    settings: TestBedSettings,
}

impl TestBed {
    /// A bench with the motors, loads and encoders of a machine.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] where no machine can be as wrongly described as the settings ask, and for one whose DC
    /// motors do not each move an axis.
    pub fn new(machine: &Machine, settings: TestBedSettings) -> Result<Self, ConfigError> {
        machine.require(MachineKind::Gantry, "the control test bed")?;
        let described = misjudged(machine, settings.wrong_share)?;
        Ok(Self::with_description(machine, &described, settings))
    }

    /// A bench with a description of one's own, wrong in whichever way; `settings.wrong_share` is not used.
    #[must_use]
    pub fn with_description(machine: &Machine, described: &Machine, settings: TestBedSettings) -> Self {
        /// Bounds of the time step, as for `plant::Bench`: the resolution of its times, and a few runs of the
        /// position loop.
        const SHORTEST: Duration = Duration::from_micros(1);
        const LONGEST: Duration = Duration::from_millis(1);
        let time_step = settings.time_step.clamp(SHORTEST, LONGEST);
        let settings = TestBedSettings { time_step, ..settings };
        Self { machine: *machine, described: *described, settings }
    }

    /// The machine as it is.
    #[must_use]
    pub const fn machine(&self) -> &Machine {
        &self.machine
    }

    /// The machine as controllers believe it to be: build yours from this.
    #[must_use]
    pub const fn described(&self) -> &Machine {
        &self.described
    }

    /// The machine's place that is nearest to a place on the sheet, in encoder counts.
    #[must_use]
    pub fn counts(&self, at: Point) -> StepPoint {
        let config = DcConfig::of(&self.machine);
        StepPoint::new(
            crate::toolpath::from_mm(at.x, config.x.counts_per_mm),
            crate::toolpath::from_mm(at.y, config.y.counts_per_mm),
        )
    }

    /// Lets a controller that is at rest at the origin make `moves`, one after the other; `watch` sees every
    /// time step.
    ///
    /// A controller of the caller's own type and one behind `dyn` are run alike.
    pub fn run(
        &self,
        controller: &mut (impl LineController + ?Sized),
        moves: impl IntoIterator<Item = PenMove>,
        mut watch: impl FnMut(&Moment),
    ) -> Figures {
        let mut run = Run::new(self, controller);
        let mut figures = Figures::default();
        let mut from = self.on_sheet([0.0; 2]);
        for PenMove { pen, target } in moves {
            let to = self.on_sheet([f64::from(target.x), f64::from(target.y)]);
            run.start(target);
            let begun = run.now;
            figures.targets += 1;
            let mut arrived = false;
            let move_ = Move { line: Segment::new(from, to), is_drawn: pen == Pen::Down };
            while !arrived && run.now.saturating_sub(begun) < self.settings.limit {
                figures.energy_j += run.step();
                let moment = run.moment(&move_, true);
                figures.note(&moment, self.settings.settled_mm);
                watch(&moment);
                arrived = run.controller.has_arrived();
            }
            figures.reached += u32::from(arrived);
            from = to;
        }
        figures.time = run.now;
        let resting = Move { line: Segment::new(from, from), is_drawn: false };
        while run.now.saturating_sub(figures.time) < self.settings.watch_on && figures.targets > 0 {
            figures.energy_j += run.step();
            let moment = run.moment(&resting, false);
            figures.note(&moment, self.settings.settled_mm);
            watch(&moment);
        }
        figures.lost_counts = run.lost_counts();
        figures
    }

    fn on_sheet(&self, [x, y]: [f64; 2]) -> Point {
        let config = DcConfig::of(&self.machine);
        Point::new(x / config.x.counts_per_mm, y / config.y.counts_per_mm)
    }
}

struct Move {
    line: Segment,
    is_drawn: bool,
}

/// A run in progress.
struct Run<'a, C: ?Sized> {
    bed: &'a TestBed,
    controller: &'a mut C,
    axes: [AxisPlant; 2],
    gate: SafetyGate,
    /// What the motors are driven with, and from when on.
    drive: Drive<'static>,
    next_drive: Option<(Duration, Drive<'static>)>,
    delay: DriveDelay,
    now: Duration,
    /// The next run of the loop: when it should come, and when it does.
    next_tick: Option<(Duration, Duration)>,
    ticks: u64,
    /// Edges that came, the first first, which the processor has not worked on yet.
    edges: [Option<Edge>; MOST_EDGES],
    /// Until when the processor works on something.
    busy_until: Duration,
}

/// An edge of an encoder, and when it came.
#[derive(Clone, Copy)]
struct Edge {
    at: Duration,
    axis: Axis,
    direction: Direction,
}

/// Edges that wait at most, twice as many as in the firmware's queue: those of two motors in a longer time than any
/// run of a loop takes. One that finds no room is lost, and shows in [`Figures::lost_counts`].
const MOST_EDGES: usize = 64;

impl<'a, C: LineController + ?Sized> Run<'a, C> {
    fn new(bed: &'a TestBed, controller: &'a mut C) -> Self {
        let config = DcConfig::of(&bed.machine);
        let dt_s = bed.settings.time_step.as_secs_f64();
        Self {
            bed,
            next_tick: controller.period().map(|due| (due, due + bed.settings.late_loop.delay(0))),
            ticks: 0,
            controller,
            axes: [AxisPlant::new(&config.x, dt_s), AxisPlant::new(&config.y, dt_s)],
            gate: SafetyGate::new(LimitSwitches::RELEASED, false),
            drive: Drive::default(),
            next_drive: None,
            delay: DriveDelay::of(&bed.machine),
            now: Duration::ZERO,
            edges: [None; MOST_EDGES],
            busy_until: Duration::ZERO,
        }
    }

    fn start(&mut self, target: StepPoint) {
        let demand = self.controller.start(self.now, target);
        self.apply(self.now, self.busy_until.max(self.now), demand);
    }

    /// A demand that is made `now` drives the motors from a later time on.
    fn apply(&mut self, now: Duration, from: Duration, demand: Demand) {
        self.take_drive(now);
        let drive = self.gate.pass(demand).kept();
        self.next_drive = Some((from, drive));
        self.controller.applied(drive);
    }

    /// Takes what the motors are to be driven with from a time up to this one on.
    fn take_drive(&mut self, now: Duration) {
        if let Some((_, drive)) = self.next_drive.take_if(|(from, _)| *from <= now) {
            self.drive = drive;
        }
    }

    /// Goes on by one time step; the electrical energy that was taken in it, J.
    fn step(&mut self) -> f64 {
        let time_step = self.bed.settings.time_step;
        let mut energy_j = 0.0;
        let start = self.now;
        self.take_drive(start);
        let duties = self.delay.pass(start, self.drive);
        for ((plant, duty), axis) in self.axes.iter_mut().zip(duties).zip(Axis::BOTH) {
            plant.step(duty, |edge| {
                let at = start + time_step.mul_f64(edge.share_of_step);
                put(&mut self.edges, Edge { at, axis, direction: edge.direction });
            });
            // What flows back while a motor brakes warms the bridge; no supply takes it.
            energy_j += plant.power_w(duty).max(0.0) * time_step.as_secs_f64();
        }
        self.now = start + time_step;
        while self.handle() {}
        energy_j
    }

    /// Begins with what the processor is to do next, an edge before a run of the loop where both wait; says
    /// whether there was something by now.
    fn handle(&mut self) -> bool {
        let next_edge = self.edges.first().copied().flatten();
        // An edge is known to the microsecond, as a timer has it.
        let told = |edge: Edge| Duration::from_micros(u64::try_from(edge.at.as_micros()).unwrap_or(u64::MAX));
        let edge = next_edge.map(|edge| (told(edge).max(self.busy_until), edge));
        let tick = self.next_tick.map(|(due, at)| (at.max(self.busy_until), due));
        match (edge, tick, self.controller.period()) {
            (edge, Some((at, due)), Some(period))
                if at <= self.now
                    && edge
                        .is_none_or(|(edge_at, _)| at < edge_at || at == edge_at && at > self.busy_until) =>
            {
                let demand = self.controller.tick(at);
                self.worked(at, self.bed.settings.handling.run, demand);
                self.ticks += 1;
                let period = period.max(Duration::from_micros(1));
                let missed = u32::try_from(at.saturating_sub(due).as_micros() / period.as_micros())
                    .unwrap_or(u32::MAX);
                let due = due.saturating_add(period.saturating_mul(missed.saturating_add(1)));
                self.next_tick = Some((due, (due + self.bed.settings.late_loop.delay(self.ticks)).max(at)));
                true
            }
            (Some((at, edge)), ..) if at <= self.now => {
                self.edges.rotate_left(1);
                if let Some(last) = self.edges.last_mut() {
                    *last = None;
                }
                let demand = self.controller.edge(told(edge), edge.axis, edge.direction);
                self.worked(at, self.bed.settings.handling.edge, demand);
                true
            }
            _ => false,
        }
    }

    /// The processor has begun with something at a time, and works on it so long.
    fn worked(&mut self, at: Duration, takes: Duration, demand: Demand) {
        self.busy_until = at.saturating_add(takes);
        self.apply(at, self.busy_until, demand);
    }

    /// By how many whole counts the controller is wrong about where the worse shaft is.
    fn lost_counts(&self) -> u32 {
        let told = self.controller.position();
        let [x, y] = &self.axes;
        x.counts_from(told.x).max(y.counts_from(told.y))
    }

    fn moment(&self, moved: &Move, is_under_way: bool) -> Moment {
        let [x, y] = &self.axes;
        let pen = Point::new(x.position_mm(), y.position_mm());
        let nearest = moved.line.nearest(pen);
        let desired = self.controller.reference().map_or(nearest, |counts| self.bed.on_sheet(counts));
        Moment {
            time: self.now,
            target: moved.line.to,
            desired,
            pen,
            nearest,
            error_mm: pen.distance(nearest),
            is_measured: is_under_way && moved.is_drawn,
        }
    }
}

/// Puts an edge in its place among those that wait; without a room for it it is lost.
fn put(edges: &mut [Option<Edge>; MOST_EDGES], edge: Edge) {
    let place = edges.iter().position(|other| other.is_none_or(|other| edge.at < other.at));
    if let Some(rest) = place.and_then(|place| edges.get_mut(place..)) {
        rest.rotate_right(1);
        if let Some(place) = rest.first_mut() {
            *place = Some(edge);
        }
    }
}
