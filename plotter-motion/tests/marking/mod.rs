#![allow(dead_code, reason = "each test uses its part of this")]
#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![allow(unreachable_pub, reason = "shared by tests, not an interface")]
//! The marking board's controller and its simulated board, in one time.

use core::time::Duration;
use plotter_motion::control::{
    Contouring, DriveRamp, EqualizerSettings, LineController, PointToPoint, PointToPointSettings,
};
use plotter_motion::firmware::{MarkingBoard, MarkingBoardSettings};
use plotter_motion::kinematics::{BeltSigns, CoreXy};
use plotter_motion::plant::{MarkingBoardPlant, MarkingBoardPlantSettings};
use plotter_motion::{
    AreaConfig, AxisConfig, ContouringConfig, ControlConfig, Decoding, EncoderConfig, LoadConfig, Machine,
    MachineConfig, PenMove, PlotOp, Point,
};

pub const TIME_STEP: Duration = Duration::from_micros(100);

pub fn belt() -> CoreXy {
    CoreXy::new(BeltSigns::DirectionTable, 46.3).unwrap()
}

pub fn settings() -> MarkingBoardSettings {
    MarkingBoardSettings::new(belt())
}

pub struct Run<C> {
    pub now: Duration,
    pub board: MarkingBoard<C>,
    pub plant: MarkingBoardPlant,
}

impl<C: LineController> Run<C> {
    pub fn new(settings: MarkingBoardSettings, controller: C) -> Self {
        Self::with_phases(settings, controller, [0.5, 0.5])
    }

    /// With each encoder so far beyond a mark at first.
    pub fn with_phases(settings: MarkingBoardSettings, controller: C, phases: [f64; 2]) -> Self {
        let unequal = MarkingBoardPlantSettings::unequal(settings.belt);
        Self::on(settings, controller, &MarkingBoardPlantSettings { phases, ..unequal })
    }

    /// On a board of which everything is said.
    pub fn on(settings: MarkingBoardSettings, controller: C, plant: &MarkingBoardPlantSettings) -> Self {
        let plant = MarkingBoardPlant::new(plant, TIME_STEP.as_secs_f64());
        Self { now: Duration::ZERO, board: MarkingBoard::new(settings, controller), plant }
    }

    pub fn step(&mut self) {
        self.now += TIME_STEP;
        let (now, board) = (self.now, &mut self.board);
        self.plant.step(board.drive(), |motor| board.pulse(now, motor));
        board.limit_switches(now, self.plant.limit_switches());
        while board.next_tick() <= now {
            board.tick(now);
        }
    }

    /// Makes a move and waits until it is done; `seen` is told of every place of the pen on the way. Says whether it
    /// was done within 20 s.
    pub fn draw(&mut self, next: PenMove, mut seen: impl FnMut(Point)) -> bool {
        let limit = self.now + Duration::from_secs(20);
        self.board.start(self.now, next);
        while !self.board.has_arrived() && self.now < limit {
            self.step();
            seen(self.plant.position_mm());
        }
        self.board.has_arrived()
    }

    /// Waits.
    pub fn rest(&mut self, time: Duration) {
        let end = self.now + time;
        while self.now < end {
            self.step();
        }
    }

    /// Makes all moves of a tool path.
    pub fn draw_all(
        &mut self,
        settings: &MarkingBoardSettings,
        ops: impl IntoIterator<Item = PlotOp>,
        mut seen: impl FnMut(Point),
    ) -> bool {
        settings.moves(ops).all(|next| self.draw(next.unwrap(), &mut seen))
    }

    /// Distance between the counted and the true place, mm.
    pub fn miscounted_mm(&self) -> f64 {
        self.board.position_mm().distance(self.plant.position_mm())
    }
}

/// As published, without the run-down being waited for and without care at the switches.
pub fn published() -> (MarkingBoardSettings, PointToPoint) {
    let settings = MarkingBoardSettings { run_down: Duration::ZERO, unequal_share: 0.0, ..settings() };
    (settings, PointToPoint::new(PointToPointSettings::default()))
}

/// The published directions with ramp and equalizer.
pub fn equalized() -> (MarkingBoardSettings, PointToPoint) {
    let point_to_point = PointToPointSettings {
        equalizer: Some(EqualizerSettings::default()),
        ramp: DriveRamp { start: 0.15, step: 0.05, most: 0.45, period: Duration::from_millis(100) },
        slow_counts: 100.0,
        ..PointToPointSettings::default()
    };
    (settings(), PointToPoint::new(point_to_point))
}

/// The machine that ours believes in: two equal motors, friction between that of the real ones.
pub fn believed() -> MachineConfig {
    let motor = AxisConfig {
        counts_per_mm: 46.3,
        encoder: EncoderConfig { lines_per_turn: 12, decoding: Decoding::X2 },
        load: LoadConfig {
            inertia_kg_m2: 2.0e-6,
            coulomb_n_m: 1.6e-3,
            static_n_m: 1.6e-3,
            viscous_n_m_s: 1.0e-6,
        },
        ..AxisConfig::default()
    };
    let contouring = ContouringConfig {
        // along the line of both motors, √2 times that of the pen: 30 mm/s and 200 mm/s²
        feed_mm_s: 42.4,
        accel_mm_s2: 283.0,
        jerk_mm_s3: 5000.0,
        loop_hz: 1000.0,
        bandwidth_hz: 15.0,
        observer_hz: 30.0,
        arrival_tolerance_counts: 0.45,
        settle_ms: 20.0,
    };
    MachineConfig {
        area: AreaConfig { width_mm: 300.0, height_mm: 200.0 },
        x: motor,
        y: motor,
        control: ControlConfig { contouring, ..ControlConfig::default() },
        ..MachineConfig::default()
    }
}

/// Ours: both motors led along a planned line.
pub fn contouring() -> (MarkingBoardSettings, Contouring) {
    (settings(), Contouring::new(&Machine::new(believed()).unwrap()))
}
