//! Laws of settings in files: what is written is read back, a misspelt key and a number that no machine has
//! are refused.

use plotter_motion::control::{
    ContouringSettings, CrossCoupledSettings, EqualizerSettings, LearningSettings, LineTrackingSettings,
    PointToPointSettings,
};
use plotter_motion::firmware::{
    GantrySettings, MarkingBoardSettings, stepper_plotter::StepperPlotterSettings,
};
use plotter_motion::kinematics::{BeltSigns, CoreXy};
use plotter_motion::plant::{BenchSettings, MarkingBoardPlantSettings};
use plotter_motion::protocol::{HostSettings, LinkSettings};
use plotter_motion::stepgen::StepGenSettings;
use plotter_motion::testbed::TestBedSettings;
use plotter_motion::{Machine, MachineConfig, PlannerSettings, dxf, gcode, hpgl};
use std::fmt::Debug;

fn kept<T>(settings: &T)
where
    T: Debug + PartialEq + serde::Serialize + for<'de> serde::Deserialize<'de>,
{
    let text = serde_json::to_string(settings).unwrap();
    assert_eq!(&serde_json::from_str::<T>(&text).unwrap(), settings, "{text}");
    let misspelt = format!("{}, \"sped\": 1}}", text.strip_suffix('}').unwrap());
    let refused = serde_json::from_str::<T>(&misspelt).unwrap_err().to_string();
    assert!(refused.contains("unknown field `sped`"), "{refused}");
}

/// The same for settings with a default: an empty file is that.
fn kept_with_default<T>()
where
    T: Default + Debug + PartialEq + serde::Serialize + for<'de> serde::Deserialize<'de>,
{
    kept(&T::default());
    assert_eq!(serde_json::from_str::<T>("{}").unwrap(), T::default());
}

#[test]
fn settings_are_read_as_they_were_written() {
    kept_with_default::<gcode::ReadOptions>();
    kept_with_default::<hpgl::ReadOptions>();
    kept_with_default::<hpgl::WriteOptions>();
    kept_with_default::<dxf::ReadOptions>();
    kept_with_default::<StepGenSettings>();
    kept_with_default::<PlannerSettings>();
    kept_with_default::<StepperPlotterSettings>();
    kept_with_default::<HostSettings>();
    kept_with_default::<LinkSettings>();
    kept_with_default::<BenchSettings>();
    kept_with_default::<PointToPointSettings>();
    kept_with_default::<EqualizerSettings>();
    kept_with_default::<TestBedSettings>();

    let gantry = Machine::new(MachineConfig::default()).unwrap();
    kept(&LineTrackingSettings::of(&gantry));
    kept(&ContouringSettings::of(&gantry));
    kept(&CrossCoupledSettings::of(&gantry));
    kept(&LearningSettings::of(&gantry));
    kept(&GantrySettings::of(&gantry));
    let board = Machine::new(MachineConfig::marking_board()).unwrap();
    kept(&MarkingBoardSettings::of(&board));
    kept(&MarkingBoardPlantSettings::of(&board));
    kept(&PointToPointSettings::of(&board));

    let pen = gcode::PenControl::Commands { up: "M1 160", down: "M1 90" };
    let options = gcode::WriteOptions { pen, ..gcode::WriteOptions::default() };
    let text = serde_json::to_string(&options).unwrap();
    assert_eq!(serde_json::from_str::<gcode::WriteOptions<'_>>(&text).unwrap(), options);
}

#[test]
fn what_no_machine_can_be_driven_with_is_refused() {
    let refused = |text: &str| serde_json::from_str::<PlannerSettings>(text).unwrap_err().to_string();
    assert!(
        refused("{\"accel_mm_s2\": -1000.0}").contains("accel_mm_s2"),
        "{}",
        refused("{\"accel_mm_s2\": -1000.0}")
    );
    assert!(serde_json::from_str::<PlannerSettings>("{\"accel_mm_s2\": 1000.0}").is_ok());

    let plotter = "{\"x_steps_per_mm\": 0.0}";
    assert!(serde_json::from_str::<StepperPlotterSettings>(plotter).is_err());

    let belt = CoreXy::new(BeltSigns::DirectionTable, 46.3).unwrap();
    let text = serde_json::to_string(&belt).unwrap();
    assert_eq!(serde_json::from_str::<CoreXy>(&text).unwrap(), belt);
    assert!(serde_json::from_str::<CoreXy>(&text.replace("46.3", "-46.3")).is_err());
}
