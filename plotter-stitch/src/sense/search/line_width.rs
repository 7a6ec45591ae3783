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

/// What the length of a line varies by where nothing is smeared, mm: two edges by 0.02 mm each.
const VARIES_MM: f64 = 0.0283;

/// From here on a line that is seen longer than the others is smeared, mm: three times what it varies by.
const SMEARED_MM: f64 = 3.0 * VARIES_MM;

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
        let share = smeared_share(&spans_mm, usual_mm);
        // The median of those that are not smeared: smeared ones are the longest.
        let usual_mm = quantile(&spans_mm, 0.5 * (1.0 - share)).unwrap_or(usual_mm);
        for pass in passed.iter_mut().flatten().filter(|pass| is_of(pass)) {
            let longer_mm = pass.sighting.span_mm - usual_mm;
            let most_mm = if is_slow { LONGEST_SMEAR_MM } else { LONGEST_SMEAR_MM + spacing_mm };
            pass.sighting.like_a_line = (-ROUGH_MM - spacing_mm..=most_mm).contains(&longer_mm);
            if is_slow && longer_mm > 0.0 {
                // The middle of what is seen is off by half of the smear, to the side that nobody knows; the
                // mean of two passes is too, while the deviation of a mean is taken for less by a root of 2.
                let off_mm = longer_mm * core::f64::consts::FRAC_1_SQRT_2;
                pass.sighting.sigma_mm =
                    libm::hypot(pass.sighting.sigma_mm, libm::sqrt(smeared(longer_mm, share)) * off_mm);
            }
        }
    }
}

/// What so great a share of sorted numbers is below, between the two nearest of them.
#[expect(clippy::cast_precision_loss, reason = "a few hundred passes")]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "an index within the numbers, rounded down"
)]
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let at = share.clamp(0.0, 1.0) * sorted.len().saturating_sub(1) as f64;
    let lower = sorted.get(at as usize)?;
    let upper = sorted.get(at as usize + 1).unwrap_or(lower);
    Some(lower + (at - libm::floor(at)) * (upper - lower))
}

/// Which share of the lines is smeared: those that are seen longer than any clean one is, and as many again
/// as are smeared by less, if smears are as long as a smear can be.
fn smeared_share(spans_mm: &[f64], usual_mm: f64) -> f64 {
    let count =
        |of: &dyn Fn(f64) -> bool| spans_mm.iter().fold(0.0, |sum, mm| sum + f64::from(u8::from(of(*mm))));
    let (longer, all) = (count(&|mm| mm - usual_mm > SMEARED_MM), count(&|_| true));
    longer / f64::max(all, 1.0) / (1.0 - SMEARED_MM / LONGEST_SMEAR_MM)
}

/// How likely a line is smeared that is seen longer by so much, if that share of the lines is (Bayes): clean
/// lines vary normally, and smears are of any length.
fn smeared(longer_mm: f64, share: f64) -> f64 {
    if longer_mm > SMEARED_MM {
        return 1.0;
    }
    let varies = longer_mm / VARIES_MM;
    let clean = (1.0 - share).max(0.0) * libm::exp(-0.5 * varies * varies)
        / (VARIES_MM * libm::sqrt(core::f64::consts::TAU));
    let smeared = share / LONGEST_SMEAR_MM;
    if smeared > 0.0 { smeared / (smeared + clean) } else { 0.0 }
}
