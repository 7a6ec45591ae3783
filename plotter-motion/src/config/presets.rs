//! The documented machines.

use super::{
    AreaConfig, AxisConfig, BeltConfig, ContouringConfig, ControlConfig, DcConfig, Decoding, DriveConfig,
    EncoderConfig, HomingConfig, LoadConfig, MachineConfig, MachineName, MotorConfig, OneBeltConfig,
    PenConfig, PlannerConfig, PointToPointConfig, SerialConfig, StepperConfig, SteppersConfig,
    SyncStopConfig,
};
use crate::kinematics::BeltSigns;
use crate::plant::StepperSettings;

impl MachineConfig {
    /// The documented stepper plotter: a Makeblock XY plotter of 380 x 310 mm, driven by mDraw over 115200
    /// baud.
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig, config::SteppersConfig};
    /// let machine = Machine::new(MachineConfig::stepper_plotter())?;
    /// assert_eq!(SteppersConfig::of(&machine).x.steps_per_mm, 87.58);
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn stepper_plotter() -> Self {
        Self {
            name: MachineName::STEPPER_PLOTTER,
            drive: DriveConfig::Steppers(SteppersConfig::default()),
            area: AreaConfig { width_mm: 380.0, height_mm: 310.0 },
            serial: SerialConfig { baud: 115_200, byte_gap_ms: 0.0, ..SerialConfig::default() },
            ..Self::default()
        }
    }

    /// The documented textile plotter: a flatbed of 2000 x 1000 mm (mechanically 2100 x 1100), over which the
    /// paper is moved from roll to roll, with drives that take step and direction, up to 10 m/s.
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig, config::SteppersConfig};
    /// let machine = Machine::new(MachineConfig::textile_plotter())?;
    /// assert_eq!(SteppersConfig::of(&machine).planner.travel_speed_mm_s, 10_000.0);
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn textile_plotter() -> Self {
        let stepper = StepperConfig {
            steps_per_mm: 50.0,
            start_rate_hz: 5_000.0,
            max_rate_hz: 500_000.0,
            ..StepperConfig::default()
        };
        let steppers = SteppersConfig {
            planner: PlannerConfig {
                speed_mm_s: 1_000.0,
                travel_speed_mm_s: 10_000.0,
                accel_mm_s2: 20_000.0,
                jerk_mm_s3: 1_000_000.0,
                ..PlannerConfig::default()
            },
            pen: PenConfig { settle_ms: 50.0, ..PenConfig::default() },
            homing: HomingConfig {
                fast_rate_hz: 25_000.0,
                slow_rate_hz: 2_500.0,
                pull_off_mm: 50.0,
                release_mm: 10.0,
                known_travel_mm: 1_050.0,
                max_travel_mm: 2_150.0,
            },
            stepper_motor: StepperSettings {
                microsteps: 10,
                holding_n_m: 10.0,
                corner_rate_hz: 500_000.0,
                max_rate_hz: 1_000_000.0,
                inertia_kg_m2: 0.005,
                coulomb_n_m: 0.5,
                viscous_n_m_s: 0.01,
                ..StepperSettings::default()
            },
            x: stepper,
            y: stepper,
            ..SteppersConfig::default()
        };
        Self {
            name: MachineName::TEXTILE_PLOTTER,
            area: AreaConfig { width_mm: 2_000.0, height_mm: 1_000.0 },
            drive: DriveConfig::Steppers(steppers),
            ..Self::stepper_plotter()
        }
    }
}

impl MachineConfig {
    /// The documented marking board: two DC motors on one belt, 46.3 pulses to the millimetre, 300 mm by 200
    /// mm.
    ///
    /// The report names no motor: both are the gantry's, which at 24 pulses a turn make 30 mm/s at 5 V, with
    /// 2e-6 kg m² of gear and pulley, so that a motor at 30 mm/s runs down for 0.6 mm. They differ as two of
    /// a kind may: the second has a tenth more field, as with weaker and stronger magnets, and half as much
    /// friction again.
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig, config::OneBeltConfig};
    /// let machine = Machine::new(MachineConfig::marking_board())?;
    /// assert_eq!(OneBeltConfig::of(&machine).dc.x.counts_per_mm, 46.3);
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn marking_board() -> Self {
        Self {
            name: MachineName::MARKING_BOARD,
            area: AreaConfig { width_mm: 300.0, height_mm: 200.0 },
            drive: DriveConfig::Belt(OneBeltConfig::default()),
            ..Self::default()
        }
    }
}

impl Default for MachineConfig {
    fn default() -> Self {
        Self {
            schema: 1,
            name: MachineName::SEMI_VIRTUAL_GANTRY,
            area: AreaConfig::default(),
            serial: SerialConfig::default(),
            drive: DriveConfig::default(),
        }
    }
}

impl Default for OneBeltConfig {
    fn default() -> Self {
        let motor = MotorConfig::default();
        let load = LoadConfig { inertia_kg_m2: 2.0e-6, ..LoadConfig::default() };
        let x = AxisConfig {
            counts_per_mm: 46.3,
            encoder: EncoderConfig { lines_per_turn: 12, decoding: Decoding::X2 },
            load,
            ..AxisConfig::default()
        };
        let y = AxisConfig {
            motor: MotorConfig { back_emf_v_s: 14.7059e-3, torque_n_m_per_a: 14.74e-3, ..motor },
            load: LoadConfig { coulomb_n_m: 1.95e-3, static_n_m: 2.08e-3, ..load },
            ..x
        };
        let contouring = ContouringConfig {
            feed_mm_s: 30.0,
            accel_mm_s2: 200.0,
            jerk_mm_s3: 3_500.0,
            loop_hz: 1_000.0,
            bandwidth_hz: 15.0,
            observer_hz: 30.0,
            arrival_tolerance_counts: 0.45,
            settle_ms: 20.0,
        };
        Self {
            dc: DcConfig {
                control: ControlConfig { contouring, ..ControlConfig::default() },
                sync_stop: SyncStopConfig::default(),
                x,
                y,
            },
            signs: BeltSigns::default(),
            belt: BeltConfig::default(),
            point_to_point: PointToPointConfig::default(),
        }
    }
}
