//! Corners in which three lines end, under a camera's blur: it takes the ink away from the outside of the
//! corner and fills the inside.

use crate::off_lines;

use off_lines::off_px;
use plotter_vector::follow::{CameraSettings, Paper, SimulatedCamera};
use plotter_vector::{PxPoint, Vectorizer};

/// Half of the side of the window, px.
const HALF_PX: f64 = 100.0;

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
#[allow(clippy::unwrap_used, reason = "a failure shows")]
fn three_lines_end_where_their_courses_meet() {
    for seed in 0..8_u8 {
        let turn = 0.01 + f64::from(seed) * core::f64::consts::FRAC_PI_4;
        let corner = PxPoint::new(100.0 + 0.37 * f64::from(seed), 100.0 - 0.23 * f64::from(seed));
        let lines = [0.0, 0.785, 1.571].map(|angle| {
            let (sin, cos) = libm::sincos(turn + angle);
            [corner, PxPoint::new(corner.x + 70.0 * cos, corner.y + 70.0 * sin)]
        });
        let strokes: Vec<_> = lines.iter().map(|line| (line.to_vec(), 5.0)).collect();
        let paper = Paper::drawn(200, 200, &strokes).unwrap();
        let settings = CameraSettings::default()
            .with_width_px(200)
            .with_height_px(200)
            .with_rim_light(1.0)
            .with_seed(seed.into());
        let window = SimulatedCamera::new(&paper, settings).window(PxPoint::new(HALF_PX, HALF_PX));
        let found = Vectorizer::default().vectorize(&window).unwrap().drawing;
        let off_px = off_px(&lines, &found);
        assert!(off_px < 1.2, "{seed}: {off_px} px {found:?}");
    }
}
