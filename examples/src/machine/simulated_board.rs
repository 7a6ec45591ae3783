//! A drawing on a simulated marking board: its controller, two motors on one belt, and everything that they
//! did recorded.

use crate::machine::{PlotOutcome, Recorded};
use core::time::Duration;
use plotter_motion::config::{DcConfig, OneBeltConfig};
use plotter_motion::control::ChosenController;
use plotter_motion::firmware::{MarkingBoard, MarkingBoardSettings};
use plotter_motion::kinematics::Kinematics as _;
use plotter_motion::plant::{MarkingBoardPlant, MarkingBoardPlantSettings};
use plotter_motion::{
    Axis, Drive, LimitSwitches, Machine, Pen, PenMove, Point, SafetyGate, Segment, StepPoint,
    config::ControllerChoice,
};
use plotter_replay::BenchRecorder;
use plotter_replay::log::{Event, Header};
use std::io::Write;

/// Time step of motors and rails.
const TIME_STEP: Duration = Duration::from_micros(100);

/// A move that is not done by then never is: the longest one across the documented board takes some 17 s.
const PATIENCE: Duration = Duration::from_secs(60);

/// A marking board's controller and its simulated motors in one time.
#[derive(Debug)]
pub struct SimulatedBoard {
    now: Duration,
    board: MarkingBoard<ChosenController>,
    plant: MarkingBoardPlant,
    settings: MarkingBoardSettings,
}

impl SimulatedBoard {
    /// The board of a machine's file.
    #[must_use]
    pub fn new(machine: &Machine) -> Self {
        Self::with_plant(machine, &MarkingBoardPlantSettings::of(machine))
    }

    /// Its controller on another board.
    #[must_use]
    pub fn with_plant(machine: &Machine, plant: &MarkingBoardPlantSettings) -> Self {
        Self {
            now: Duration::ZERO,
            board: MarkingBoard::of(machine, SafetyGate::new(LimitSwitches::RELEASED, false)),
            plant: MarkingBoardPlant::new(plant, TIME_STEP.as_secs_f64()),
            settings: MarkingBoardSettings::of(machine),
        }
    }

    /// Goes on by one time step; `counted` is told of every pulse that was counted.
    pub fn step(&mut self, mut counted: impl FnMut(Duration, Axis, plotter_motion::Direction)) {
        self.now += TIME_STEP;
        let (now, board) = (self.now, &mut self.board);
        self.plant.step(board.drive().duties(), |motor| {
            board.pulse(now, motor);
            if let Some(direction) = board.counting(motor) {
                counted(now, motor, direction);
            }
        });
        board.limit_switches(now, self.plant.limit_switches());
        while board.next_tick() <= now {
            board.tick(now);
        }
    }

    /// Begins a move.
    pub fn start(&mut self, next: PenMove) {
        self.board.start(self.now, next);
    }

    /// Whether it is done.
    #[must_use]
    pub fn has_arrived(&self) -> bool {
        self.board.has_arrived()
    }

    /// Time since the start.
    #[must_use]
    pub fn now(&self) -> Duration {
        self.now
    }

    /// What both motors get.
    #[must_use]
    pub fn drive(&self) -> Drive<'_> {
        self.board.drive()
    }

    /// Where the pen truly is, mm.
    #[must_use]
    pub fn position_mm(&self) -> Point {
        self.plant.position_mm()
    }

    /// Where counts of both motors lie on the board, mm.
    #[must_use]
    pub fn on_sheet(&self, counts: StepPoint) -> Point {
        self.settings.start + (self.settings.belt.point_at(counts.into()) - Point::ORIGIN)
    }
}

/// What a log of a marking board says of itself, beside its machine and controller.
#[must_use]
pub fn board_header(machine: &Machine) -> Header {
    let belt = OneBeltConfig::of(machine);
    let dc = DcConfig::of(machine);
    let settings = MarkingBoardSettings::of(machine);
    let mm_per_pulse = 1.0 / settings.belt.steps_per_mm();
    let signs = match settings.belt.signs() {
        plotter_motion::kinematics::BeltSigns::DirectionTable => "direction-table",
        plotter_motion::kinematics::BeltSigns::TrackingEquations => "tracking-equations",
    };
    let tolerance = match dc.control.controller {
        // Within the allowed error along both axes, one motor may be off by both.
        ControllerChoice::Published => (2.0 * belt.point_to_point.allowed_error_mm / mm_per_pulse).ceil(),
        _ => 0.0,
    };
    Header::new()
        .with_text("protocol", "counts")
        .with_text("belt_signs", signs)
        .with_decimal("x_mm_per_pulse", mm_per_pulse)
        .with_decimal("y_mm_per_pulse", mm_per_pulse)
        .with_decimal("p1_x_mm", settings.start.x)
        .with_decimal("p1_y_mm", settings.start.y)
        .with_decimal("reached_tolerance_counts", tolerance)
}

/// Draws `moves` on the simulated board until all are done, or one is not within a minute. What happens goes to
/// `recorder`; `progress` learns how many targets are reached.
pub fn simulate_board<W: Write>(
    machine: &Machine,
    moves: Vec<PenMove>,
    recorded: Recorded,
    recorder: &mut BenchRecorder<W>,
    mut progress: impl FnMut(u32),
) -> PlotOutcome {
    let dc = DcConfig::of(machine);
    let pwm_steps = [&dc.x, &dc.y].map(|axis| u16::try_from(axis.motor.pwm_steps).unwrap_or(u16::MAX));
    let mut board = SimulatedBoard::new(machine);
    let mut outcome =
        PlotOutcome { targets: u32::try_from(moves.len()).unwrap_or(u32::MAX), ..PlotOutcome::default() };
    let (mut from, mut pen, mut duty) = (StepPoint::default(), None, [0; 2]);
    let (mut square_mm2, mut max_mm, mut samples) = (0.0, 0.0_f64, 0_u32);
    for next in moves {
        let (now, PenMove { target, .. }) = (board.now(), next);
        if pen.replace(next.pen) != Some(next.pen) {
            recorder.write(now, Event::Pen(next.pen));
        }
        recorder.write(now, Event::Target { x: target.x, y: target.y });
        board.start(next);
        let line = Segment::new(board.on_sheet(from), board.on_sheet(target));
        while !board.has_arrived() && board.now() < now + PATIENCE {
            board.step(|at, axis, sign| recorder.write(at, Event::Edge { axis, sign }));
            if recorded.drive {
                for ((axis, before), steps) in Axis::BOTH.into_iter().zip(&mut duty).zip(pwm_steps) {
                    let steps = board.drive().axis(axis).steps(steps);
                    if std::mem::replace(before, steps) != steps {
                        recorder.write(board.now(), Event::Drive { axis, duty: steps });
                    }
                }
            }
            if next.pen == Pen::Down {
                let error_mm = line.distance(board.position_mm());
                square_mm2 += error_mm * error_mm;
                samples += 1;
                max_mm = max_mm.max(error_mm);
            }
        }
        if !board.has_arrived() {
            let notice = format!("no arrival within {} s: stopped", PATIENCE.as_secs());
            outcome.note(board.now(), "board", &notice);
            recorder.write(board.now(), Event::Note(format!("board: {notice}")));
            break;
        }
        recorder.write(board.now(), Event::Controller(b"+".to_vec()));
        from = target;
        outcome.reached += 1;
        progress(outcome.reached);
    }
    outcome.true_rms_mm = Some((square_mm2 / f64::from(samples.max(1))).sqrt());
    outcome.true_max_mm = Some(max_mm);
    outcome.duration = board.now();
    outcome
}
