//! [`Setting`]: one number of a machine's settings, as Grbl numbers them.

use super::StepperPlotterSettings;
use crate::extremes::greatest;
use crate::geom::single;
use crate::whole::{is_whole, nearest, whole};
use core::ops::RangeInclusive;

/// Greatest rate of a motor, pulses/s: ten ticks of the clock a step.
const MOST_HZ: f32 = 1e5;
/// Sides of the area, mm: as they are kept.
const SIDES_MM: RangeInclusive<f64> = 1.0..=65_535.0;

/// One setting of the machine with its value, in Grbl's numbers and units (`$n=value`): see
/// [`StepperPlotterSettings`](super::StepperPlotterSettings) for what it changes.
///
/// | number | meaning | range |
/// |---|---|---|
/// | 3 | directions of the motors: 1 turns x round, 2 y; they hold after the next start | 0 to 3 |
/// | 11 | junction deviation, mm | 0 to 10 |
/// | 22 | homing: 1 answers `$H`, and locks the machine at the next start until `$H` or `$X` | 0 or 1 |
/// | 24, 25, 27 | homing: slow and fast, mm/min; from the switch to the origin, mm | up to 100,000 pulses/s; 0.01 to 100 |
/// | 100, 101 | steps/mm of x and y | 0.01 to 10,000 |
/// | 110, 111 | greatest speed along the path, mm/min: one for both axes | 0.1 to 600,000; up to 100,000 pulses/s |
/// | 120, 121 | greatest acceleration, mm/s²: that of each axis with
/// [`AccelLimit::Axes`](crate::planner::AccelLimit::Axes), of each motor with
/// [`AccelLimit::Belts`](crate::planner::AccelLimit::Belts) (of the sum, of the difference), else of the pen:
/// one for both | 1 to 1,000,000 |
/// | 102, 112, 122, 132 | of a third axis: steps/mm, greatest speed, mm/min, and acceleration, mm/s²,
/// travel, mm | as of the others |
/// | 130, 131 | width and height of the area, whole mm | 1 to 65,535 |
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Setting {
    /// Grbl's number of it.
    pub number: u8,
    /// Its value.
    pub value: f64,
}

/// Why a setting is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingProblem {
    /// There is no such setting, or it cannot be changed.
    Fixed,
    /// It is below 0.
    Negative,
    /// It lies outside its range.
    OutOfRange,
    /// A motor would have to make more than 100,000 steps/s, or more steps would be averaged than there is
    /// room for.
    StepRate,
}

impl Setting {
    /// The settings with this one changed.
    ///
    /// ```
    /// # use plotter_motion::firmware::stepper_plotter::{Setting, SettingProblem, StepperPlotterSettings};
    /// let settings = StepperPlotterSettings::default();
    /// let slower = Setting { number: 110, value: 3000.0 }.checked(&settings)?; // mm/min
    /// assert_eq!(slower.planner.speed_mm_s, 50.0);
    /// let wrong = Setting { number: 110, value: 1e5 }; // 1667 mm/s of 87.58 steps
    /// assert_eq!(wrong.checked(&settings), Err(SettingProblem::StepRate));
    /// # Ok::<(), SettingProblem>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`SettingProblem`]; then nothing is to be changed.
    pub fn checked(
        self,
        settings: &StepperPlotterSettings,
    ) -> Result<StepperPlotterSettings, SettingProblem> {
        let Self { number, value } = self;
        let range = match number {
            3 => 0.0..=3.0,
            11 => 0.0..=10.0,
            22 => 0.0..=1.0,
            24 | 25 => 0.1..=f64::MAX,
            27 => 0.01..=100.0,
            100 | 101 => 0.01..=10_000.0,
            110 | 111 => 0.1..=600_000.0,
            120 | 121 => 1.0..=1e6,
            130 | 131 => SIDES_MM,
            #[cfg(feature = "third-motor")]
            102 | 112 | 122 | 132 if settings.z.is_some() => match number {
                102 => 0.01..=10_000.0,
                112 => 0.1..=600_000.0,
                122 => 1.0..=1e6,
                _ => 0.01..=65_535.0,
            },
            _ => return Err(SettingProblem::Fixed),
        };
        if value < 0.0 {
            return Err(SettingProblem::Negative);
        }
        if !range.contains(&value) || (matches!(number, 3 | 22) && !is_whole(value)) {
            return Err(SettingProblem::OutOfRange);
        }
        let settings = self.applied(*settings);
        let StepperPlotterSettings { x_steps_per_mm, y_steps_per_mm, planner, home_x, home_y, .. } = settings;
        let speed_mm_s = greatest(single(planner.speed_mm_s), single(planner.travel_speed_mm_s));
        let steps_per_mm = greatest(single(x_steps_per_mm), single(y_steps_per_mm));
        let homing_hz = home_x.fast_hz.max(home_y.fast_hz).max(home_x.slow_hz).max(home_y.slow_hz);
        if speed_mm_s * steps_per_mm > MOST_HZ || homing_hz > 100_000 {
            return Err(SettingProblem::StepRate);
        }
        #[cfg(feature = "averaged-steps")]
        if settings.check_average().is_err() {
            return Err(SettingProblem::StepRate);
        }
        #[cfg(feature = "third-motor")]
        if let Some(z) = settings.z {
            if single(z.speed_mm_s * z.steps_per_mm) > MOST_HZ {
                return Err(SettingProblem::StepRate);
            }
            // A travel that no longer reaches the heights of the pen.
            if z.check(true).is_err() {
                return Err(SettingProblem::OutOfRange);
            }
        }
        Ok(settings)
    }

    /// The settings with this one changed, which has been checked.
    fn applied(self, mut settings: StepperPlotterSettings) -> StepperPlotterSettings {
        let near = |value: f64| u32::try_from(nearest(value)).unwrap_or(u32::MAX);
        let whole = |value: f64| u32::try_from(whole(value)).unwrap_or(u32::MAX);
        let Self { number, value } = self;
        let side_mm = || u16::try_from(whole(value)).unwrap_or(u16::MAX);
        match number {
            3 => {
                let mask = whole(value);
                settings.stored.x_direction = u8::from(mask & 1 != 0);
                settings.stored.y_direction = u8::from(mask & 2 != 0);
            }
            22 => settings.homing = value > 0.0,
            11 => settings.planner.junction_deviation_mm = value,
            24 | 25 | 27 => {
                let StepperPlotterSettings { home_x, home_y, x_steps_per_mm, y_steps_per_mm, .. } =
                    &mut settings;
                let each = if number == 27 { value } else { value / 60.0 };
                for (axis, scale) in [(home_x, *x_steps_per_mm), (home_y, *y_steps_per_mm)] {
                    let field = match number {
                        24 => &mut axis.slow_hz,
                        25 => &mut axis.fast_hz,
                        _ => &mut axis.pull_off_steps,
                    };
                    *field = near(each * scale).max(1);
                }
            }
            100 => settings.x_steps_per_mm = value,
            101 => settings.y_steps_per_mm = value,
            110 | 111 => {
                settings.planner.speed_mm_s = value / 60.0;
                settings.planner.travel_speed_mm_s = value / 60.0;
            }
            120 | 121 => *settings.planner.accel_of_motor(number == 121) = value,
            130 => settings.stored.width_mm = side_mm(),
            131 => settings.stored.height_mm = side_mm(),
            #[cfg(feature = "third-motor")]
            102 | 112 | 122 | 132 => {
                if let Some(z) = &mut settings.z {
                    match number {
                        102 => z.steps_per_mm = value,
                        112 => z.speed_mm_s = value / 60.0,
                        122 => z.accel_mm_s2 = value,
                        _ => z.travel_mm = value,
                    }
                }
            }
            _ => {}
        }
        settings
    }
}
