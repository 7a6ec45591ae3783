#![allow(dead_code, reason = "each test uses its part of this")]
#![allow(unreachable_pub, reason = "shared by tests, not an interface")]
//! The marking board's controller and its simulated board, in one time.

use core::time::Duration;
use plotter_motion::control::{ChosenController, Contouring, LineController};
use plotter_motion::firmware::{MarkingBoard, MarkingBoardSettings};
use plotter_motion::kinematics::CoreXy;
use plotter_motion::plant::{MarkingBoardPlant, MarkingBoardPlantSettings};
use plotter_motion::{
    LimitSwitches, Machine, MachineConfig, PenMove, PlotOp, Point, SafetyGate,
    config::{ControllerChoice, PointToPointConfig},
};

pub const TIME_STEP: Duration = Duration::from_micros(100);

/// The board of `examples/machines/marking-board.toml`: `tests/config_preset.rs` compares the two.
pub fn machine() -> Machine {
    Machine::new(MachineConfig::marking_board()).unwrap()
}

pub fn belt() -> CoreXy {
    CoreXy::of(&machine())
}

pub fn settings() -> MarkingBoardSettings {
    MarkingBoardSettings::of(&machine())
}

pub fn plant() -> MarkingBoardPlantSettings {
    MarkingBoardPlantSettings::of(&machine())
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
        Self::on(settings, controller, &MarkingBoardPlantSettings { phases, ..plant() })
    }

    /// On a board of which everything is said.
    pub fn on(settings: MarkingBoardSettings, controller: C, plant: &MarkingBoardPlantSettings) -> Self {
        let plant = MarkingBoardPlant::new(plant, TIME_STEP.as_secs_f64());
        Self {
            now: Duration::ZERO,
            board: MarkingBoard::new(settings, controller, SafetyGate::new(LimitSwitches::RELEASED, false)),
            plant,
        }
    }

    pub fn step(&mut self) {
        self.now += TIME_STEP;
        let (now, board) = (self.now, &mut self.board);
        self.plant.step(board.drive().duties(), |motor| board.pulse(now, motor));
        board.limit_switches(now, self.plant.limit_switches());
        while board.next_tick() <= now {
            board.tick(now);
        }
    }

    /// Makes a move and waits until it is done; `seen` is told of every place of the pen on the way. Says
    /// whether it was done within 20 s.
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

/// The board's published controller, changed.
fn point_to_point(change: impl FnOnce(&mut PointToPointConfig)) -> (MarkingBoardSettings, ChosenController) {
    let mut config = MachineConfig::marking_board();
    config.dc_mut().unwrap().control.controller = ControllerChoice::Published;
    change(&mut config.belt_mut().unwrap().point_to_point);
    let machine = Machine::new(config).unwrap();
    (MarkingBoardSettings::of(&machine), ChosenController::of(&machine))
}

/// As published, without the run-down being waited for and without care at the switches.
pub fn published() -> (MarkingBoardSettings, ChosenController) {
    point_to_point(|_| ())
}

/// The published directions with ramp and equalizer.
pub fn equalized() -> (MarkingBoardSettings, ChosenController) {
    point_to_point(|settings| {
        settings.equalize = true;
        (settings.drive_start, settings.drive_step, settings.drive_step_ms) = (0.15, 0.05, 100.0);
        settings.slow_mm = 2.16;
        (settings.run_down_ms, settings.unequal_share) = (30.0, 0.15);
    })
}

/// Ours: both motors led along a planned line. It takes both motors to be the mean of the two.
pub fn contouring() -> (MarkingBoardSettings, Contouring) {
    (settings(), Contouring::new(&machine()))
}
