//! Laws of the gate of a belt machine, and of the marking board's controller under any sequence of inputs.

use crate::law_cases::cases;
use crate::switches::stands_in_the_way;
use core::time::Duration;
use plotter_motion::control::{EqualizerSettings, LineController, PointToPoint, PointToPointSettings};
use plotter_motion::firmware::{MarkingBoard, MarkingBoardSettings};
use plotter_motion::kinematics::{BeltSigns, CoreXy};
use plotter_motion::{
    Axis, Demand, Direction, Drive, Duty, LimitSwitches, Machine, MachineConfig, Pen, PenMove, SafetyGate,
    StepPoint,
};
use proptest::prelude::*;

/// Roundings of sums of numbers up to 1 in 24 bits.
const ROUNDING: f32 = 1e-6;

fn signs() -> impl Strategy<Value = BeltSigns> {
    prop_oneof![Just(BeltSigns::DirectionTable), Just(BeltSigns::TrackingEquations)]
}

fn duty() -> impl Strategy<Value = Duty> {
    prop_oneof![4 => -1.0..=1.0_f32, 1 => Just(0.0), 1 => Just(1.0), 1 => Just(-1.0)]
        .prop_map(Duty::saturating)
}

fn demand() -> impl Strategy<Value = Demand> {
    (duty(), duty()).prop_map(|(x, y)| Demand { x, y })
}

fn switches() -> impl Strategy<Value = LimitSwitches> {
    prop::array::uniform4(any::<bool>()).prop_map(|[x_min, x_max, y_min, y_max]| LimitSwitches {
        x_min,
        x_max,
        y_min,
        y_max,
    })
}

/// How fast the carriage goes into a pressed switch when both motors turn at `speeds` for a full drive.
fn into_switches(drive: Drive, signs: BeltSigns, pressed: LimitSwitches, speeds: [f32; 2]) -> f32 {
    let (x, y) = signs.twice_axes(drive.x().value() * speeds[0], drive.y().value() * speeds[1]);
    let mut worst = 0.0_f32;
    for (axis, speed) in [(Axis::X, x), (Axis::Y, y)] {
        if stands_in_the_way(pressed, axis, Direction::Plus) {
            worst = worst.max(speed);
        }
        if stands_in_the_way(pressed, axis, Direction::Minus) {
            worst = worst.max(-speed);
        }
    }
    worst
}

#[derive(Clone, Copy, Debug)]
enum Input {
    Start(i32, i32),
    Pulse(Axis),
    Wait(u64),
    Limits(LimitSwitches),
    EmergencyStop(bool),
    Reset,
}

fn input() -> impl Strategy<Value = Input> {
    let counts = || prop_oneof![8 => -5_000..5_000_i32, 1 => any::<i32>()];
    prop_oneof![
        2 => (counts(), counts()).prop_map(|(x, y)| Input::Start(x, y)),
        8 => prop_oneof![Just(Axis::X), Just(Axis::Y)].prop_map(Input::Pulse),
        8 => (0..40_000_u64).prop_map(Input::Wait),
        3 => switches().prop_map(Input::Limits),
        1 => any::<bool>().prop_map(Input::EmergencyStop),
        1 => Just(Input::Reset),
    ]
}

/// A controller that asks for anything, one demand after the other.
struct Restless(Vec<Demand>, usize);

impl LineController for Restless {
    fn period(&self) -> Option<Duration> {
        Some(Duration::from_millis(1))
    }
    fn start(&mut self, now: Duration, _target: StepPoint) -> Demand {
        self.tick(now)
    }
    fn edge(&mut self, now: Duration, _axis: Axis, _direction: Direction) -> Demand {
        self.tick(now)
    }
    fn tick(&mut self, _now: Duration) -> Demand {
        self.1 += 1;
        self.0[self.1 % self.0.len()]
    }
    fn applied(&mut self, _drive: Drive) {}
    fn position(&self) -> StepPoint {
        StepPoint::default()
    }
    fn has_arrived(&self) -> bool {
        false
    }
}

/// After every one of the inputs: no drive into a pressed switch, none while stopped, and no motor reversed
/// that may still turn.
fn holds<C: LineController>(
    settings: MarkingBoardSettings,
    controller: C,
    speeds: [f32; 2],
    inputs: &[Input],
) -> Result<(), TestCaseError> {
    let mut board = MarkingBoard::new(settings, controller, SafetyGate::new(LimitSwitches::RELEASED, false));
    let mut now = Duration::ZERO;
    let mut pressed = LimitSwitches::default();
    let mut stopped = false;
    let mut last_pulse = [None; 2];
    for &input in inputs {
        let counting = [Axis::X, Axis::Y].map(|motor| board.counting(motor));
        match input {
            Input::Start(x, y) => board.start(now, PenMove { pen: Pen::Down, target: StepPoint::new(x, y) }),
            Input::Pulse(motor) => {
                last_pulse[usize::from(motor == Axis::Y)] = Some(now);
                board.pulse(now, motor);
            }
            Input::Wait(us) => {
                now += Duration::from_micros(us);
                board.tick(now);
            }
            Input::Limits(next) => {
                pressed = next;
                board.limit_switches(now, pressed);
            }
            Input::EmergencyStop(button) => {
                stopped |= button;
                board.emergency_stop(now, button);
            }
            Input::Reset => {
                if board.reset_emergency_stop(now) {
                    stopped = false;
                }
            }
        }
        let drive = board.drive();
        prop_assert_eq!(board.gate().is_stopped(), stopped);
        prop_assert!(!stopped || drive == Drive::default(), "{:?} while stopped", drive);
        let into = into_switches(drive, settings.belt.signs(), pressed, speeds);
        prop_assert!(into <= ROUNDING, "{:?} goes into {:?} by {}", drive, pressed, into);
        for (motor, (before, pulse)) in
            [drive.x(), drive.y()].into_iter().zip(counting.into_iter().zip(last_pulse))
        {
            if let (Some(driven), Some(before), Some(pulse)) = (motor.direction(), before, pulse) {
                prop_assert!(driven == before || now - pulse >= settings.run_down, "reversed while it turns");
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(256) })]

    #[test]
    fn no_drive_leads_into_a_pressed_switch(
        signs in signs(), demand in demand(), pressed in switches(), share in 0.0..0.9_f32, differ in prop::array::uniform2(-1.0..=1.0_f32),
    ) {
        let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        gate.set_limits(pressed);
        // the motors differ by as much as the gate was told, or less
        let speeds = differ.map(|by| 1.0 + by * share);
        let drive = gate.pass_belt(demand, signs, share);
        prop_assert!(into_switches(drive, signs, pressed, speeds) <= ROUNDING, "{:?}", drive);
        prop_assert!(into_switches(gate.pass_belt(demand, signs, 0.0), signs, pressed, [1.0; 2]) <= ROUNDING);
        prop_assert_eq!(gate.pass_belt(demand, signs, f32::NAN), gate.pass_belt(demand, signs, 1.0));
        gate.emergency_stop(true);
        prop_assert_eq!(gate.pass_belt(demand, signs, share), Drive::default());
    }

    /// Without a switch the pen goes where it was asked to; what is too much is made smaller as a whole.
    #[test]
    fn a_demand_keeps_its_direction(signs in signs(), demand in demand(), share in 0.0..1.0_f32) {
        let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        let drive = gate.pass_belt(demand, signs, share);
        let (x2, y2) = signs.twice_axes(drive.x().value(), drive.y().value());
        let size = (demand.x.value().abs() + demand.y.value().abs()).max(1.0);
        prop_assert!((x2 / 2.0 * size - demand.x.value()).abs() <= ROUNDING);
        prop_assert!((y2 / 2.0 * size - demand.y.value()).abs() <= ROUNDING);
    }

    /// A switch takes nothing that leads away from it.
    #[test]
    fn what_leads_away_from_a_switch_is_let_through(signs in signs(), demand in demand()) {
        let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        let away = |duty: Duty| LimitSwitches { x_min: duty.value() > 0.0, x_max: duty.value() < 0.0, ..LimitSwitches::default() };
        let free = gate.pass_belt(Demand { y: Duty::ZERO, ..demand }, signs, 0.3).duties();
        gate.set_limits(away(demand.x));
        prop_assert_eq!(gate.pass_belt(Demand { y: Duty::ZERO, ..demand }, signs, 0.3).duties(), free);
    }

    #[test]
    fn the_board_is_safe_under_any_inputs(
        signs in signs(), inputs in prop::collection::vec(input(), 1..200), demands in prop::collection::vec(demand(), 1..20),
        differ in prop::array::uniform2(-1.0..=1.0_f32),
    ) {
        let machine = Machine::new(MachineConfig::marking_board()).unwrap();
        let settings = MarkingBoardSettings { belt: CoreXy::new(signs, 46.3).unwrap(), ..MarkingBoardSettings::of(&machine) };
        let speeds = differ.map(|by| 1.0 + by * settings.unequal_share);
        holds(settings, Restless(demands, 0), speeds, &inputs)?;
        let point_to_point = PointToPointSettings { signs, equalizer: Some(EqualizerSettings::default()), ..PointToPointSettings::default() };
        holds(settings, PointToPoint::new(point_to_point), speeds, &inputs)?;
    }
}
