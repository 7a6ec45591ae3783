//! Laws of the conversion from millimetres to motor steps and back.

use plotter_motion::kinematics::{
    Backlash, BacklashState, BeltSigns, Cartesian, CoreXy, Kinematics, MotorScale,
};
use plotter_motion::{Axis, Direction, Point, StepPoint};
use proptest::prelude::*;

/// Greatest relative error of two roundings, of a product and of a quotient.
const LAST_BITS: f64 = 2.0 * f64::EPSILON;

/// From 1.3e-9 to 7.9e8 steps per millimetre: the range that is accepted.
fn scale() -> impl Strategy<Value = MotorScale> {
    (-8.9..8.9_f64, any::<bool>())
        .prop_map(|(decade, inverted)| MotorScale { steps_per_mm: 10.0_f64.powf(decade), inverted })
}

fn direction() -> impl Strategy<Value = Direction> {
    prop_oneof![Just(Direction::Plus), Just(Direction::Minus)]
}

fn signs() -> impl Strategy<Value = BeltSigns> {
    prop_oneof![Just(BeltSigns::DirectionTable), Just(BeltSigns::TrackingEquations)]
}

/// A simulated axis with play: the motor moves a gap, and the carriage lies between its two flanks.
struct AxisWithPlay {
    motor: i32,
    carriage: i32,
    /// The carriage lies at `motor - behind`..=`motor + ahead`.
    behind: i32,
    ahead: i32,
}

impl AxisWithPlay {
    /// Motor and carriage are at `at`, and the motor presses on the carriage in the direction `driven`.
    fn new(at: i32, driven: Direction, play: u16) -> Self {
        let play = i32::from(play);
        // Driven forwards, the carriage touches the rear flank, so all of the gap lies ahead of it.
        let (behind, ahead) = if driven == Direction::Plus { (0, play) } else { (play, 0) };
        Self { motor: at, carriage: at, behind, ahead }
    }

    fn step_to(&mut self, motor: i32) {
        while self.motor != motor {
            self.motor += (motor - self.motor).signum();
            self.carriage = self.carriage.clamp(self.motor - self.behind, self.motor + self.ahead);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_point_survives_conversion_to_motors_and_back(scales in (scale(), scale()), x in -1e6..1e6_f64, y in -1e6..1e6_f64) {
        let machine = Cartesian::new(scales.0, scales.1).unwrap();
        let back = machine.point_at(machine.motors_at(Point::new(x, y)));
        prop_assert!((back.x - x).abs() <= LAST_BITS * x.abs() && (back.y - y).abs() <= LAST_BITS * y.abs());
    }

    #[test]
    fn steps_survive_conversion_to_the_sheet_and_back(scales in (scale(), scale()), x in any::<i32>(), y in any::<i32>()) {
        let machine = Cartesian::new(scales.0, scales.1).unwrap();
        let steps = StepPoint::new(x, y);
        prop_assert_eq!(machine.steps_at(machine.point_at(steps.into())), steps);
    }

    #[test]
    fn a_point_survives_conversion_by_a_belt(signs in signs(), scale in scale(), x in -1e6..1e6_f64, y in -1e6..1e6_f64) {
        let machine = CoreXy::new(signs, scale.steps_per_mm).unwrap();
        let back = machine.point_at(machine.motors_at(Point::new(x, y)));
        // The sums of both coordinates are rounded by the size of the larger one.
        let rounding = 2.0 * LAST_BITS * x.abs().max(y.abs());
        prop_assert!((back.x - x).abs() <= rounding && (back.y - y).abs() <= rounding, "{:?}", back);
    }

    #[test]
    fn steps_survive_conversion_by_a_belt(signs in signs(), scale in scale(), first in any::<i32>(), second in any::<i32>()) {
        let machine = CoreXy::new(signs, scale.steps_per_mm).unwrap();
        let steps = StepPoint::new(first, second);
        prop_assert_eq!(machine.steps_at(machine.point_at(steps.into())), steps);
        let (first, second) = (i64::from(first), i64::from(second));
        let (x2, y2) = signs.twice_axes(first, second);
        prop_assert_eq!(signs.motors(x2, y2), (2 * first, 2 * second));
    }

    #[test]
    fn the_carriage_of_an_axis_with_play_ends_on_its_target(
        start in -1_000..1_000_i32, x in 0..200_u16, y in 0..200_u16, driven in (direction(), direction()),
        targets in prop::collection::vec((-1_500..1_500_i32, -1_500..1_500_i32), 1..40),
    ) {
        let (dx, dy) = driven;
        let play = Backlash { x_steps: x, y_steps: y };
        let mut state = BacklashState::at(StepPoint::new(start, start), dx, dy);
        let mut axes = [AxisWithPlay::new(start, dx, x), AxisWithPlay::new(start, dy, y)];
        for (x, y) in targets {
            let before = [axes[0].carriage, axes[1].carriage];
            let takeup = play.next(&mut state, StepPoint::new(x, y));
            for (axis, extra) in axes.iter_mut().zip([takeup.extra.x, takeup.extra.y]) {
                axis.step_to(axis.motor + extra);
            }
            prop_assert_eq!([axes[0].carriage, axes[1].carriage], before, "extra steps move no carriage");
            // Play is taken up: from here on each step of a motor moves its carriage.
            let motor = takeup.motor;
            prop_assert_eq!((motor.x - axes[0].motor, motor.y - axes[1].motor), (x - before[0], y - before[1]));
            axes[0].step_to(motor.x);
            axes[1].step_to(motor.y);
            prop_assert_eq!((axes[0].carriage, axes[1].carriage), (x, y));
            prop_assert_eq!(state.logical(motor), StepPoint::new(x, y));
        }
    }

    /// Targets may lie at the ends of the range of 32 bits.
    #[test]
    fn no_target_overflows(targets in prop::collection::vec(any::<(i32, i32)>(), 1..20), play in any::<u16>()) {
        let settings = Backlash { x_steps: play, y_steps: play };
        let mut state = BacklashState::default();
        for (x, y) in targets {
            let takeup = settings.next(&mut state, StepPoint::new(x, y));
            prop_assert!([0, i32::from(play)].contains(&takeup.extra.x.abs()));
            prop_assert!(takeup.motor.x.abs_diff(x) <= u32::from(play));
        }
    }
}

#[test]
fn a_bad_scale_is_refused_with_its_axis() {
    let (good, bad) = (MotorScale::default(), MotorScale { steps_per_mm: 0.0, inverted: true });
    assert_eq!(Cartesian::new(bad, bad).unwrap_err().axis, Axis::X);
    assert_eq!(Cartesian::new(good, bad).unwrap_err().axis, Axis::Y);
}
