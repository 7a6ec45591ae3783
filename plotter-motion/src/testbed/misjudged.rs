//! [`misjudged`]: a description of a machine that is wrong.

use crate::{ConfigError, Machine};

/// The description of a machine by somebody who is off by `share` in every figure of its motors and loads,
/// and each time in the direction that adds up.
///
/// Of x everything is taken too lightly, of y the other way round:
///
/// | | x | y |
/// |---|---|---|
/// | moment of inertia, with load and carriage | 1 - share | 1 + share |
/// | friction, of all kinds | 1 - 1.2 share | 1 + 1.2 share |
/// | torque constant | 1 + 0.8 share | 1 - 0.8 share |
/// | back EMF constant | 1 - 0.8 share | 1 + 0.8 share |
///
/// With a quarter: inertia 25 %, friction 30 %, motor constants 20 %. What is reckoned with them adds up to
/// more: the voltage for an acceleration, R J / Kt, comes out at 0.63 of the right one for x and at 1.56 for
/// y. Encoders, gears and supplies are known.
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig, config::DcConfig, testbed::misjudged};
/// let described = misjudged(&Machine::new(MachineConfig::default())?, 0.25)?;
/// let config = DcConfig::of(&described);
/// assert!((config.x.motor.torque_n_m_per_a / 13.4e-3 - 1.2).abs() < 1e-12);
/// assert!((config.y.load.coulomb_n_m / 1.3e-3 - 1.3).abs() < 1e-12);
/// # Ok::<(), plotter_motion::ConfigError>(())
/// ```
///
/// # Errors
///
/// [`ConfigError`] where such a machine could not be: a share far below 0 or above 0.8, or a motor that would
/// not be strong enough.
pub fn misjudged(machine: &Machine, share: f64) -> Result<Machine, ConfigError> {
    let mut config = *machine.config();
    // Stepper motors are not judged.
    let Some(dc) = config.dc_mut() else { return Machine::new(config) };
    for (axis, sign) in [(&mut dc.x, -share), (&mut dc.y, share)] {
        let (motor, load, transmission) = (&mut axis.motor, &mut axis.load, &mut axis.transmission);
        transmission.carriage_kg *= 1.0 + sign;
        transmission.rail_friction_n *= 1.0 + 1.2 * sign;
        motor.inertia_kg_m2 *= 1.0 + sign;
        load.inertia_kg_m2 *= 1.0 + sign;
        load.coulomb_n_m *= 1.0 + 1.2 * sign;
        load.static_n_m *= 1.0 + 1.2 * sign;
        load.viscous_n_m_s *= 1.0 + 1.2 * sign;
        motor.torque_n_m_per_a *= 1.0 - 0.8 * sign;
        motor.back_emf_v_s *= 1.0 + 0.8 * sign;
    }
    Machine::new(config)
}
