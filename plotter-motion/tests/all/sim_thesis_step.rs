//! The thesis' claim for its motor under PID with Kp = 15, Kd = 10, Ki = 0.0001 (section 4.6.2): a unit step
//! of the position has settled after 0.001 s.

use plotter_motion::config::{LoadConfig, MotorConfig};
use plotter_motion::plant::{DcMotor, DcMotorState};

#[test]
fn the_linear_loop_of_the_thesis_settles_within_its_millisecond() {
    const DT_S: f64 = 1e-6;
    const DRIVER_GAIN: f64 = 2.4;
    const SETTLED_SHARE: f64 = 0.02;
    let unloaded = LoadConfig { inertia_kg_m2: 0.0, coulomb_n_m: 0.0, static_n_m: 0.0, viscous_n_m_s: 0.0 };
    let motor = DcMotor::new(&MotorConfig::default(), &unloaded, DT_S);
    let (mut state, mut sum, mut before) = (DcMotorState::default(), 0.0, 0.0);
    let mut settled_s = None;
    for step in 0..5_000 {
        let error = 1.0 - state.angle_rad;
        sum += error * DT_S;
        // linear as in the thesis' MATLAB model: no limit of the voltage, and the step itself is
        // differentiated
        let volts = DRIVER_GAIN * (15.0 * error + 0.0001 * sum + 10.0 * (error - before) / DT_S);
        before = error;
        state = motor.step(state, volts, 0.0);
        if (1.0 - state.angle_rad).abs() > SETTLED_SHARE {
            settled_s = None;
        } else if settled_s.is_none() {
            settled_s = Some(f64::from(step + 1) * DT_S);
        }
    }
    let settled_s = settled_s.unwrap();
    assert!(settled_s <= 0.001, "settled after {settled_s} s");
    // It takes 10 V s in the first instant: no battery gives that, which is why the table of sim_contour
    // looks different with 12 V.
}
