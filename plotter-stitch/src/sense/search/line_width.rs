//! What is a line among all that was seen: most of it is, so their median tells how long one is seen.

use super::SearchSettings;
use super::shown_delays::median;
use crate::sense::Passed;
use alloc::vec::Vec;

/// A pen's line is seen for no less than this share of what its optics say, and for no more than this many
/// times it.
const NARROWEST: f64 = 0.5;
const WIDEST: f64 = 2.0;

/// How much longer or shorter than the others a rough line may be seen, mm: four times what two edges vary by
/// 0.02 mm each.
const ROUGH_MM: f64 = 0.12;

/// From here on a line that is seen longer than the others is smeared, mm: three times what two edges vary.
const SMEARED_MM: f64 = 0.085;

/// Longest smear, mm. What is seen longer is no mark: it is more than a line's own width.
const LONGEST_SMEAR_MM: f64 = 0.7;

/// Says anew of each pass whether it saw a line, and how well a smeared one is known. Fast and slow passes
/// each have their median, as a fast one knows a length only to the distance of its samples.
pub(super) fn judge(passed: &mut [Vec<Passed>], settings: &SearchSettings, expected_mm: f64) {
    for (speed_mm_s, is_slow) in [(settings.fast_mm_s, false), (settings.slow_mm_s, true)] {
        let is_of = |pass: &Passed| libm::fabs(pass.velocity_mm_s) == libm::fabs(speed_mm_s);
        let spacing_mm = libm::fabs(speed_mm_s * settings.optics.tact_s) / 2.0;
        let least_mm = NARROWEST * expected_mm - spacing_mm;
        let range_mm = least_mm..=WIDEST * expected_mm + spacing_mm;
        let all = passed.iter().flatten().filter(|pass| is_of(pass));
        let mut spans_mm: Vec<f64> =
            all.map(|pass| pass.sighting.span_mm).filter(|span_mm| range_mm.contains(span_mm)).collect();
        let usual_mm = median(&mut spans_mm).unwrap_or(expected_mm);
        for pass in passed.iter_mut().flatten().filter(|pass| is_of(pass)) {
            let longer_mm = pass.sighting.span_mm - usual_mm;
            let most_mm = if is_slow { LONGEST_SMEAR_MM } else { LONGEST_SMEAR_MM + spacing_mm };
            pass.sighting.like_a_line = (-ROUGH_MM - spacing_mm..=most_mm).contains(&longer_mm);
            if is_slow && longer_mm > SMEARED_MM {
                // The middle of what is seen is off by half of the smear, to the side that nobody knows; the
                // mean of two passes is too, while the deviation of a mean is taken for less by a root of 2.
                pass.sighting.sigma_mm =
                    libm::hypot(pass.sighting.sigma_mm, longer_mm * core::f64::consts::FRAC_1_SQRT_2);
            }
        }
    }
}
