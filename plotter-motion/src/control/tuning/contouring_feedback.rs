//! [`ContouringFeedback`]: an axis of the contouring controller as a linear filter.

use super::Complex;
use super::sample_point::SamplePoint;
use crate::control::{PositionGains, ShaftModel};

/// The feedback of one axis of [`Contouring`](crate::control::Contouring): its estimator, which finds position, speed and
/// drag from the encoder and the duty, and the position loop that acts on them.
///
/// It is taken to be corrected by an edge in every run, as it is when a line is drawn: at the gantry's 150 mm/s there are
/// 2.4 edges in a run. Below one edge a run the estimator rests more on its model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContouringFeedback {
    /// Model of motor and load in the controller.
    pub model: ShaftModel,
    /// Gains of the position loop.
    pub gains: PositionGains,
    /// Natural frequency of the estimator, rad/s.
    pub observer_rad_s: f64,
}

type Matrix = [[f64; 3]; 3];

impl ContouringFeedback {
    /// Its response, and the denominator of that.
    ///
    /// With the states position, speed and drag, x, of which a run makes `x' = A x + B a` and which the measured position y
    /// corrects by `g (y - x1')`, and the acceleration `a = -F x`, it is `C = F (1 - M z^-1)^-1 g` with `M = (1 - g c)(A - B F)`.
    pub(super) fn sampled(&self, at: &SamplePoint) -> (Complex, Complex) {
        let (m, g, f) = self.matrices(at.tick_s);
        let mut columns = [[Complex::ZERO; 3]; 3];
        for (i, (column, row)) in columns.iter_mut().zip(transposed(&m)).enumerate() {
            for (j, (entry, v)) in column.iter_mut().zip(row).enumerate() {
                *entry = (if i == j { Complex::ONE } else { Complex::ZERO }) - at.delay * v;
            }
        }
        // Cramer's rule: a column at a time gives way to g.
        let [c0, c1, c2] = columns;
        let right = g.map(Complex::real);
        let whole = determinant(&[c0, c1, c2]);
        let states =
            [determinant(&[right, c1, c2]), determinant(&[c0, right, c2]), determinant(&[c0, c1, right])];
        let accel = states.iter().zip(f).fold(Complex::ZERO, |sum, (&state, gain)| sum + state * gain);
        let per_duty = f64::from(self.model.accel_per_volt) * f64::from(self.model.supply_v);
        (accel / whole * (1.0 / per_duty), whole)
    }

    /// M, g and F.
    fn matrices(&self, tick_s: f64) -> (Matrix, [f64; 3], [f64; 3]) {
        let damping = f64::from(self.model.damping_per_s);
        let decay = libm::exp(-damping * tick_s);
        // what a speed and an acceleration make of the position in a run, and the acceleration of the speed
        let way = -libm::expm1(-damping * tick_s) / damping;
        let push = (tick_s - way) / damping;
        let f = [f64::from(self.gains.position), f64::from(self.gains.speed), -1.0];
        let fading = -libm::expm1(-self.observer_rad_s * tick_s);
        let z = 1.0 - fading;
        let g = [
            1.0 - z * z * z,
            1.5 * fading * fading * (1.0 + z) / tick_s,
            -fading * fading * fading / (tick_s * tick_s),
        ];
        // A - B F: the drag works against the acceleration
        let [f0, f1, f2] = f;
        let next = [
            [1.0 - push * f0, way - push * f1, -push - push * f2],
            [-way * f0, decay - way * f1, -way - way * f2],
            [0.0, 0.0, 1.0],
        ];
        let [predicted, ..] = next;
        let mut m = next;
        for (row, gain) in m.iter_mut().zip(g) {
            for (entry, place) in row.iter_mut().zip(predicted) {
                *entry -= gain * place;
            }
        }
        (m, g, f)
    }
}

fn transposed(m: &Matrix) -> Matrix {
    let [[a, b, c], [d, e, f], [g, h, i]] = *m;
    [[a, d, g], [b, e, h], [c, f, i]]
}

fn determinant(columns: &[[Complex; 3]; 3]) -> Complex {
    let [[a, d, g], [b, e, h], [c, f, i]] = *columns;
    a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::ContouringSettings;
    use crate::{Machine, MachineConfig};

    /// Taken as the program does it: predict, correct, act; the drag changes sign with the speed, here it runs forwards.
    #[test]
    fn it_answers_a_sine_as_the_estimator_and_the_gains_do() {
        const TICKS_A_PERIOD: u32 = 50;
        let settings = ContouringSettings::of(&Machine::new(MachineConfig::default()).unwrap());
        let observer_rad_s = f64::from(settings.x.observer_rad_s);
        let feedback = ContouringFeedback { model: settings.x.model, gains: settings.along, observer_rad_s };
        let h = f64::from(settings.period_us) * 1e-6;
        let model = settings.x.model;
        let (damping, gains) = (f64::from(model.damping_per_s), settings.along);
        let (mut p, mut v, mut d, mut a) = (0.0, 0.0, 0.0, 0.0);
        let angle =
            |tick: u32| core::f64::consts::TAU * f64::from(tick % TICKS_A_PERIOD) / f64::from(TICKS_A_PERIOD);
        let (mut sum, mut before) = (Complex::ZERO, 0.0);
        for tick in 0..40 * TICKS_A_PERIOD {
            let decay = libm::exp(-damping * h);
            let last = (a - d) / damping;
            p += last * h + (v - last) * ((1.0 - decay) / damping);
            v = last + (v - last) * decay;
            let z = libm::exp(-observer_rad_s * h);
            let off = libm::cos(angle(tick)) - p;
            p += off * (1.0 - z * z * z);
            v += off * 1.5 * (1.0 - z) * (1.0 - z) * (1.0 + z) / h;
            d -= off * (1.0 - z) * (1.0 - z) * (1.0 - z) / (h * h);
            a = -f64::from(gains.position) * p - f64::from(gains.speed) * v + d;
            if tick >= 39 * TICKS_A_PERIOD {
                sum = sum + Complex::polar(-a - before, -angle(tick));
            } else if tick % TICKS_A_PERIOD == 0 {
                before = -a;
            }
        }
        let per_duty = f64::from(model.accel_per_volt) * f64::from(model.supply_v);
        let measured = sum * (2.0 / f64::from(TICKS_A_PERIOD) / per_duty);
        let at = SamplePoint::new(core::f64::consts::TAU / (f64::from(TICKS_A_PERIOD) * h), h);
        let (expected, _) = feedback.sampled(&at);
        assert!((measured - expected).size() < 1e-6 * expected.size(), "{measured:?} {expected:?}");
    }
}
