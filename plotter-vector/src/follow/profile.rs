//! [`across`]: where a line's two rims are, to a fraction of a pixel.

use super::flat::Flat;
use crate::stroke::{PxPoint, PxVec};

/// Distance of the samples, px.
const STEP_PX: f64 = 0.5;

/// Least darkness of a line over what is beside it.
const LEAST_CONTRAST: f32 = 0.1;

/// A darkness that rises by this much again, as a share, is the next line.
const NEXT_LINE: f32 = 0.12;

/// Sides that differ by more, as a share of the line's darkness, are not alike.
const LOPSIDED: f32 = 0.15;

/// A cut through a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    /// Middle between both rims, px from the place along the cut.
    pub(super) middle_px: f64,
    /// From rim to rim, px.
    pub(super) width_px: f64,
    /// Whether it is darker on one side than on the other: another line is near, and moves the rim on its side.
    pub(super) is_lopsided: bool,
}

/// Cuts through the line at a place, along a direction of length 1: both rims are where the darkness is half way between the
/// line's and that beside it. `None` where there is no line within half of its width, or no end of it within a width and 8 px.
pub(super) fn across(flat: &Flat, at: PxPoint, normal: PxVec, width_px: f64) -> Option<Cut> {
    let reach = super::whole::count((width_px + 8.0) / STEP_PX).min(300);
    let samples: Vec<f32> = (0..=2 * reach)
        .map(|i| {
            #[expect(clippy::cast_precision_loss, reason = "a few samples")]
            let along = (i as f64 - reach as f64) * STEP_PX;
            flat.at(at + normal * along)
        })
        .collect();
    let near = super::whole::count((0.5 * width_px).max(1.5) / STEP_PX).min(reach);
    let (peak_at, peak) = samples
        .iter()
        .copied()
        .enumerate()
        .skip(reach - near)
        .take(2 * near + 1)
        .max_by(|(i, a), (j, b)| a.total_cmp(b).then(j.abs_diff(reach).cmp(&i.abs_diff(reach))))?;
    // The darkness beside the line, up to the next one.
    let valley = |side: &mut dyn Iterator<Item = f32>| {
        let mut least = peak;
        for sample in side {
            if sample > least + NEXT_LINE * peak && least < 0.8 * peak {
                break;
            }
            least = least.min(sample);
        }
        least
    };
    let before = valley(&mut samples.iter().take(peak_at).rev().copied());
    let behind = valley(&mut samples.iter().skip(peak_at).copied());
    let level = 0.5 * (peak + before.max(behind).max(0.0));
    if peak - level < 0.5 * LEAST_CONTRAST.max(5.0 * flat.noise) {
        return None;
    }
    let crossing = |from: usize, to: Option<usize>| {
        let (inner, outer) = (samples.get(from)?, samples.get(to?)?);
        (*outer < level).then(|| f64::from((inner - level) / (inner - outer)))
    };
    let count = |i: usize| f64::from(u32::try_from(i).unwrap_or(0));
    let low = (0..=peak_at).rev().find_map(|i| Some(count(i) - crossing(i, i.checked_sub(1))?))?;
    let high = (peak_at..samples.len()).find_map(|i| Some(count(i) + crossing(i, Some(i + 1))?))?;
    let place = |sample: f64| (sample - count(reach)) * STEP_PX;
    Some(Cut {
        middle_px: 0.5 * (place(low) + place(high)),
        width_px: place(high) - place(low),
        is_lopsided: (before - behind).abs() > LOPSIDED * peak,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::{CameraSettings, Paper, SimulatedCamera};

    #[test]
    fn a_blurred_line_is_found_to_a_tenth_of_a_pixel() {
        let line = vec![PxPoint::new(-50.0, 30.3), PxPoint::new(400.0, 30.3)];
        let paper = Paper::drawn(300, 60, &[(line, 5.0)]).unwrap();
        let mut camera = SimulatedCamera::new(&paper, CameraSettings::default());
        let flat = Flat::of(&camera.window(PxPoint::new(150.0, 30.0)), None, None);
        for x in [100.0, 150.0, 200.0] {
            let cut = across(&flat, PxPoint::new(x, 151.5), PxVec::new(0.0, 1.0), 4.0).unwrap();
            assert!((cut.middle_px - (150.3 - 151.5)).abs() < 0.15, "{cut:?}");
            assert!((cut.width_px - 5.0).abs() < 0.6, "{cut:?}");
        }
        assert_eq!(across(&flat, PxPoint::new(150.0, 100.0), PxVec::new(0.0, 1.0), 4.0), None);
    }
}
