//! The simulated motor and belt against a solver that is not ours: nalgebra's matrix exponential (Padé
//! approximants; ours is a Taylor series, scaled and squared).

use crate::law_cases::cases;
use nalgebra::{SMatrix, SVector};
use plotter_motion::config::{AxisConfig, LoadConfig, MotorConfig, TransmissionConfig};
use plotter_motion::plant::{BeltDrive, BeltDriveState, DcMotor, DcMotorState};
use proptest::prelude::*;

/// Share of the greatest value that each state takes for the given inputs: rounding of some ten products.
const RELATIVE_ERROR: f64 = 1e-10;
/// The same for a belt: its matrix over 0.4 ms is up to 1e5 in size, so that its exponential is squared 18
/// times, and each time rounding doubles.
const STIFF_ERROR: f64 = 1e-8;
/// Share of the greatest entry times the greatest input: some units in the last place.
const UNITS_ERROR: f64 = 1e-14;

const FREE: LoadConfig =
    LoadConfig { inertia_kg_m2: 0.0, coulomb_n_m: 0.0, static_n_m: 0.0, viscous_n_m_s: 0.0 };

/// (current, speed, angle, voltage, torque) one step later: the last two are held, so their rows are empty.
fn motor_exponential(motor: &MotorConfig, load: &LoadConfig, dt_s: f64) -> SMatrix<f64, 5, 5> {
    let (l, j) = (motor.inductance_h, motor.inertia_kg_m2 + load.inertia_kg_m2);
    let mut a = SMatrix::<f64, 5, 5>::zeros();
    a[(0, 0)] = -motor.resistance_ohm / l;
    a[(0, 1)] = -motor.back_emf_v_s / l;
    a[(0, 3)] = 1.0 / l;
    a[(1, 0)] = motor.torque_n_m_per_a / j;
    a[(1, 1)] = -load.viscous_n_m_s / j;
    a[(1, 4)] = -1.0 / j;
    a[(2, 1)] = 1.0;
    (a * dt_s).exp()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(256) })]

    /// Any motor that a machine's file may describe within reason, any state, any step from a microsecond to
    /// a tenth of a second.
    #[test]
    fn a_step_of_the_motor_is_the_matrix_exponential(
        resistance_ohm in 0.5..20.0_f64, inductance_h in 1e-5..1e-2_f64, constant in 1e-3..0.1_f64,
        inertia_kg_m2 in 1e-7..1e-4_f64, viscous_n_m_s in 0.0..1e-4_f64,
        dt_s in prop_oneof![Just(1e-6), Just(1e-5), Just(4e-4), Just(1e-2), Just(0.1)],
        current_a in -5.0..5.0_f64, speed_rad_s in -500.0..500.0_f64, angle_rad in -100.0..100.0_f64,
        voltage_v in -24.0..24.0_f64, torque_n_m in -0.01..0.01_f64,
    ) {
        let motor = MotorConfig {
            resistance_ohm, inductance_h, back_emf_v_s: constant, torque_n_m_per_a: constant, inertia_kg_m2,
            ..MotorConfig::default()
        };
        let load = LoadConfig { viscous_n_m_s, ..FREE };
        let state = DcMotorState { current_a, speed_rad_s, angle_rad };
        let next = DcMotor::new(&motor, &load, dt_s).step(state, voltage_v, torque_n_m);
        let matrix = motor_exponential(&motor, &load, dt_s);
        let input = SVector::<f64, 5>::new(current_a, speed_rad_s, angle_rad, voltage_v, torque_n_m);
        let expected = matrix * input;
        // what each row sums up, without signs: the size that its rounding is a share of
        let size = matrix.abs() * input.abs();
        for (row, found) in [next.current_a, next.speed_rad_s, next.angle_rad].into_iter().enumerate() {
            let error = (found - expected[row]).abs();
            prop_assert!(error <= RELATIVE_ERROR * size[row], "row {row}: {found} {}", expected[row]);
        }
    }

    /// The same with a belt that stretches, without friction and play.
    #[test]
    fn a_step_of_the_belt_drive_is_the_matrix_exponential(
        stiffness_n_per_mm in 1.0..1e4_f64, damping_n_s_per_mm in 0.0..1.0_f64, carriage_kg in 0.05..5.0_f64,
        dt_s in prop_oneof![Just(1e-6), Just(1e-5), Just(4e-4)],
        speed_rad_s in -100.0..100.0_f64, stretch_mm in -0.5..0.5_f64, carriage_mm_s in -200.0..200.0_f64,
        voltage_v in -12.0..12.0_f64,
    ) {
        let belt = TransmissionConfig {
            stiffness_n_per_mm, damping_n_s_per_mm, carriage_kg, ..TransmissionConfig::default()
        };
        let axis = AxisConfig { load: FREE, transmission: belt, ..AxisConfig::default() };
        let motor = DcMotorState { current_a: 0.3, speed_rad_s, angle_rad: 0.0 };
        let state = BeltDriveState { motor, carriage_mm_s, carriage_mm: -stretch_mm };
        let next = BeltDrive::new(&axis, dt_s).step(state, voltage_v);

        // states: current, speed, angle, carriage's speed and place; input: voltage
        let MotorConfig { inductance_h: l, resistance_ohm: r, inertia_kg_m2: j, .. } = axis.motor;
        let (radius, k, c) = (axis.mm_per_rad(), stiffness_n_per_mm, damping_n_s_per_mm);
        let mut a = SMatrix::<f64, 6, 6>::zeros();
        a[(0, 0)] = -r / l;
        a[(0, 1)] = -axis.motor.back_emf_v_s / l;
        a[(0, 5)] = 1.0 / l;
        a[(2, 1)] = 1.0;
        a[(4, 3)] = 1.0;
        a[(1, 0)] = axis.motor.torque_n_m_per_a / j;
        // force = k (radius angle - place) + c (radius speed - carriage speed), N
        for (column, force) in [(1, c * radius), (2, k * radius), (3, -c), (4, -k)] {
            a[(1, column)] -= force * radius / 1e3 / j;
            a[(3, column)] += force * 1e3 / carriage_kg;
        }
        let matrix = (a * dt_s).exp();
        let input = SVector::<f64, 6>::new(0.3, speed_rad_s, 0.0, carriage_mm_s, -stretch_mm, voltage_v);
        let (expected, size) = (matrix * input, matrix.abs() * input.abs());
        // Amperes, radians and millimetres are of different sizes, and a matrix is as exact as its largest
        // entry.
        let rounding = UNITS_ERROR * matrix.abs().max() * input.abs().max();
        let found =
            [next.motor.current_a, next.motor.speed_rad_s, next.motor.angle_rad, next.carriage_mm_s, next.carriage_mm];
        for (row, found) in found.into_iter().enumerate() {
            let error = (found - expected[row]).abs();
            prop_assert!(error <= STIFF_ERROR * size[row] + rounding, "row {row}: {found} {}", expected[row]);
        }
    }
}
