//! Ten thousand frames in a row, against arithmetic with twice the digits: `f64` is enough.

use plotter_motion::{Point, Vec2};
use plotter_stitch::{Chain, FrameTransform};

/// A number as an unevaluated sum of two, good to 106 bits.
///
/// Source: T. J. Dekker, "A floating-point technique for extending the available precision" (1971); the
/// products use the fused multiply-add.
#[derive(Clone, Copy, Debug)]
struct Double {
    high: f64,
    low: f64,
}

impl Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }

    fn plus(self, other: Self) -> Self {
        let high = self.high + other.high;
        let part = high - self.high;
        let error = (self.high - (high - part)) + (other.high - part);
        Self::normal(high, error + self.low + other.low)
    }

    fn minus(self, other: Self) -> Self {
        self.plus(Self { high: -other.high, low: -other.low })
    }

    fn times(self, other: Self) -> Self {
        let high = self.high * other.high;
        let error = libm::fma(self.high, other.high, -high);
        Self::normal(high, error + self.high * other.low + self.low * other.high)
    }

    fn over(self, divisor: f64) -> Self {
        let first = self.high / divisor;
        let rest = self.minus(Self::from(first).times(Self::from(divisor)));
        Self::normal(first, rest.high / divisor)
    }

    fn normal(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self { high: sum, low: low - (sum - high) }
    }

    /// Cosine and sine by their series.
    fn cos_sin(self) -> [Self; 2] {
        let square = self.times(self);
        let series = |first: Self, from: f64| {
            let (mut term, mut sum, mut n) = (first, first, from);
            while term.high.abs() > 1e-40 {
                term = term.times(square).over(-n * (n + 1.0));
                sum = sum.plus(term);
                n += 2.0;
            }
            sum
        };
        [series(Self::from(1.0), 1.0), series(self, 2.0)]
    }
}

/// The exact product of the steps, as a chain would have it: angle and place of the last frame's origin.
#[derive(Clone, Copy, Debug)]
struct Exact {
    angle: Double,
    x: Double,
    y: Double,
}

impl Exact {
    const FIRST: Self = {
        let zero = Double { high: 0.0, low: 0.0 };
        Self { angle: zero, x: zero, y: zero }
    };

    fn to_sheet(self, x: f64, y: f64) -> [Double; 2] {
        let [cos, sin] = self.angle.cos_sin();
        let (px, py) = (Double::from(x), Double::from(y));
        let by = [cos.times(px).minus(sin.times(py)), sin.times(px).plus(cos.times(py))];
        [self.x.plus(by[0]), self.y.plus(by[1])]
    }

    fn push(&mut self, step: &FrameTransform) {
        [self.x, self.y] = self.to_sheet(step.shift().x, step.shift().y);
        self.angle = self.angle.plus(Double::from(step.angle_rad()));
    }
}

/// Turns of up to 0.002 rad and shifts of up to 5 mm, as they come; the same each time.
fn steps() -> impl Iterator<Item = FrameTransform> {
    let mut state = 1_u64;
    let mut unit = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    std::iter::repeat_with(move || {
        FrameTransform::new(0.002 * unit(), Vec2::new(5.0 * unit(), 950.0 + 5.0 * unit())).unwrap()
    })
}

#[test]
fn ten_thousand_frames_end_within_a_millionth_of_a_millimetre() {
    const ALLOWED_MM: f64 = 1e-6;
    let corner = Point::new(1_980.0, 950.0);
    let (mut chain, mut exact) = (Chain::new(), Exact::FIRST);
    let mut plain = FrameTransform::IDENTITY;
    let (mut worst_mm, mut worst_plain_mm) = (0.0_f64, 0.0_f64);
    for step in steps().take(10_000) {
        chain.push(&step);
        plain = plain.after(&step);
        exact.push(&step);
        let [x, y] = exact.to_sheet(corner.x, corner.y);
        let off_mm = |place: Point| {
            let (dx, dy) = (Double::from(place.x).minus(x), Double::from(place.y).minus(y));
            libm::hypot(dx.high, dy.high)
        };
        worst_mm = worst_mm.max(off_mm(chain.to_sheet(corner)));
        worst_plain_mm = worst_plain_mm.max(off_mm(plain.to_machine(corner)));
    }
    println!("after 10000 frames (9.5 km): chain {worst_mm:.2e} mm, plain products {worst_plain_mm:.2e} mm");
    assert!(worst_mm < ALLOWED_MM, "{worst_mm:e} mm");
    // The yardstick itself tells more than f64 does: the plain products are seen to be off.
    assert!(worst_plain_mm > worst_mm);
}

#[test]
fn the_yardstick_knows_a_sixth_of_a_turn() {
    // cos 60° = 1/2, with the angle as near as f64 has it: the rest is that rounding times the sine.
    let angle = core::f64::consts::FRAC_PI_3;
    let [cos, sin] = Double::from(angle).cos_sin();
    let square = cos.times(cos).plus(sin.times(sin)).minus(Double::from(1.0));
    assert!(square.high.abs() < 1e-31, "{square:?}");
    assert!((cos.high - 0.5).abs() < 1e-15);
}
