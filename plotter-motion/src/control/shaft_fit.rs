//! [`ShaftFit`]: what motor and load truly are, found while they draw.

use super::ShaftModel;

/// Finds acceleration by voltage, damping and friction of a shaft from the times of its edges while it turns
/// one way.
///
/// Edges cut the time into windows. The mean speed of a window is exact: a whole number of counts in a
/// measured time. The difference between those of two windows that follow one another, of lengths `A` and
/// `B`, is the acceleration weighed by a triangle `w` that grows over the first and falls over the second,
/// whatever happens in between:
///
/// ```text
///   mean_b - mean_a = ∫ w a dt        a = K u - D v - F sign(v)        w = t/A, then 1 - t/B
/// ```
///
/// That is one linear equation for K, D and F, and a Kalman filter of constants takes it in (recursive least
/// squares). Each is found as a multiple of what the description says. What no window tells stays as
/// described, and none goes farther from it than a description can be wrong.
///
/// Source: L. Ljung, "System Identification" (2nd edition, 1999), section 11.2 (recursive least squares as a
/// Kalman filter).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ShaftFit {
    described: ShaftModel,
    /// K, D and F as multiples of the described ones; the last of `friction_unit`.
    shares: [f32; 3],
    /// Upper half of the covariance of `shares`: KK, KD, KF, DD, DF, FF.
    covariance: [f32; 6],
    friction_unit: f32,
    window: Window,
    /// The last window, and one that ended since it was asked for.
    before: Option<Window>,
    ended: Option<Window>,
    doubt: f32,
    /// How many windows in a row told of another motor.
    strange: u8,
}

/// What happened between two edges some counts apart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Window {
    time_s: f32,
    /// How far the shaft went, counts; below 0 backwards.
    counts: f32,
    /// Whether it has not begun yet: it does with the next edge.
    is_ahead: bool,
    /// Integral of the voltage, and of the voltage times the time since the window began, V s and V s^2.
    volts: f32,
    volt_times: f32,
    /// How long it may have stood, s: friction is then what holds it, not what brakes it.
    unsure_s: f32,
}

/// A window is at least so long, and has so many counts: then its mean speed is known to better than a
/// thousandth, and a window of a coarse encoder is not longer than a line.
const WINDOW_S: f32 = 3e-3;
const WINDOW_COUNTS: f32 = 2.0;

/// How far a description may be wrong, as a share: inertia, torque and resistance each by a quarter make
/// 1.25^2 / 0.75 - 1 = 1.1.
const DESCRIBED_DOUBT: f32 = 1.0;

/// How far from the description a constant may be found.
const FARTHEST: f32 = 3.0;

/// What an equation does not know: the motor's inductance, an uneven friction. A share of what it adds up.
const UNKNOWN_SHARE: f32 = 0.02;

/// Constants drift: by so much of themselves in the square root of a second.
const DRIFT_PER_S: f32 = 0.01;

impl ShaftFit {
    pub(super) fn new(described: ShaftModel) -> Self {
        // Friction may be described as none: its unit is then a small share of what the supply can push.
        const LEAST_FRICTION_SHARE: f32 = 0.01;
        let friction_unit =
            described.dry_friction.max(LEAST_FRICTION_SHARE * described.accel_per_volt * described.supply_v);
        let variance = DESCRIBED_DOUBT * DESCRIBED_DOUBT;
        Self {
            described,
            shares: [1.0, 1.0, described.dry_friction / friction_unit],
            covariance: [variance, 0.0, 0.0, variance, 0.0, variance],
            friction_unit,
            window: Window { is_ahead: true, ..Window::default() },
            before: None,
            ended: None,
            strange: 0,
            doubt: doubt(DESCRIBED_DOUBT * DESCRIBED_DOUBT),
        }
    }

    /// The model as found so far.
    pub(super) fn model(&self) -> ShaftModel {
        let [k, d, f] = self.shares;
        ShaftModel {
            accel_per_volt: k * self.described.accel_per_volt,
            damping_per_s: d * self.described.damping_per_s,
            dry_friction: f * self.friction_unit,
            supply_v: self.described.supply_v,
        }
    }

    /// The model of the description.
    pub(super) const fn described(&self) -> &ShaftModel {
        &self.described
    }

    /// How far an acceleration by this model may be wrong, as a share of its terms.
    pub(super) const fn doubt(&self) -> f32 {
        self.doubt
    }

    /// Time passes under a voltage.
    pub(super) fn pass(&mut self, dt_s: f32, voltage_v: f32, surely_turns: bool) {
        let window = &mut self.window;
        window.volts += voltage_v * dt_s;
        window.volt_times += voltage_v * dt_s * (window.time_s + 0.5 * dt_s);
        window.time_s += dt_s;
        if !surely_turns {
            window.unsure_s += dt_s;
        }
    }

    /// The shaft stood, or may have turned round: what was seen of it before says nothing of what comes.
    pub(super) fn interrupted(&mut self) {
        (self.before, self.ended) = (None, None);
        self.window = Window { is_ahead: true, ..Window::default() };
    }

    /// An edge of a shaft that goes on one way: `sense` is 1 forwards, -1 backwards.
    pub(super) fn edge(&mut self, sense: f32) {
        if self.window.is_ahead {
            self.window = Window::default();
            return;
        }
        self.window.counts += sense;
        if self.window.time_s >= WINDOW_S && self.window.counts.abs() >= WINDOW_COUNTS {
            self.ended = Some(core::mem::take(&mut self.window));
        }
    }

    /// Takes in what was seen since the last call: the model, if it has become another one.
    pub(super) fn found(&mut self) -> Option<ShaftModel> {
        let ended = self.ended.take()?;
        let before = self.before.replace(ended)?;
        self.learn(&before, &ended).then(|| self.model())
    }

    /// Whether it has become another motor for certain: what was found is then as doubtful as the description
    /// is.
    pub(super) fn has_changed(&mut self) -> bool {
        // Two may be a hand; three are 9 ms at least.
        const CHANGED: u8 = 3;
        let changed = self.strange >= CHANGED;
        if changed {
            let variance = DESCRIBED_DOUBT * DESCRIBED_DOUBT;
            self.strange = 0;
            self.covariance = [variance, 0.0, 0.0, variance, 0.0, variance];
            self.doubt = doubt(variance);
        }
        changed
    }

    fn learn(&mut self, a: &Window, b: &Window) -> bool {
        // The tick in which edges are timed, s.
        const TIMER_S: f32 = 1e-6;
        let (mean_a, mean_b) = (a.counts / a.time_s, b.counts / b.time_s);
        let gained = mean_b - mean_a;
        let half = 0.5 * (a.time_s + b.time_s);
        let volts = a.volt_times / a.time_s + b.volts - b.volt_times / b.time_s;
        // the way under the triangle, for a speed that grows evenly
        let slope = gained / half;
        let way = 0.5 * (a.time_s * mean_a + b.time_s * mean_b)
            + slope * (a.time_s * a.time_s - b.time_s * b.time_s) / 12.0;
        let terms = [
            self.described.accel_per_volt * volts,
            -self.described.damping_per_s * way,
            -libm::copysignf(self.friction_unit * half, mean_b),
        ];
        let [k, d, f] = self.shares;
        let [tk, td, tf] = terms;
        let off = gained - (k * tk + d * td + f * tf);
        let timing = TIMER_S * (mean_a.abs() / a.time_s + mean_b.abs() / b.time_s);
        let noise = UNKNOWN_SHARE * (tk.abs() + td.abs() + tf.abs())
            + timing
            + self.friction_unit * 0.5 * (a.unsure_s + b.unsure_s);
        let drift = DRIFT_PER_S * DRIFT_PER_S * half;
        let [kk, kd, kf, dd, df, ff] = self.covariance;
        let (kk, dd, ff) = (kk + drift, dd + drift, ff + drift);
        let (gk, gd, gf) =
            (kk * tk + kd * td + kf * tf, kd * tk + dd * td + df * tf, kf * tk + df * td + ff * tf);
        let spread = gk * tk + gd * td + gf * tf + noise * noise;
        // What is far beyond what the constants can explain is no constant: a hand, a stop, a lost edge.
        const FAR: f32 = 9.0;
        if !(spread > 0.0 && spread.is_finite() && off * off <= FAR * spread) {
            self.strange = self.strange.saturating_add(1);
            return false;
        }
        self.strange = 0;
        let gain = off / spread;
        let within = |share: f32| share.clamp(1.0 / FARTHEST, FARTHEST);
        self.shares = [within(k + gk * gain), within(d + gd * gain), (f + gf * gain).clamp(0.0, FARTHEST)];
        let least = 1e-6;
        let most = DESCRIBED_DOUBT * DESCRIBED_DOUBT;
        self.covariance = [
            (kk - gk * gk / spread).clamp(least, most),
            kd - gk * gd / spread,
            kf - gk * gf / spread,
            (dd - gd * gd / spread).clamp(least, most),
            df - gd * gf / spread,
            (ff - gf * gf / spread).clamp(least, most),
        ];
        let [kk, _, _, _, _, ff] = self.covariance;
        self.doubt = doubt(kk.max(ff));
        true
    }
}

/// A share of which the true one is hardly beyond, for such a variance.
fn doubt(variance: f32) -> f32 {
    // What no constant says, however long it was measured.
    const LEAST: f32 = 0.03;
    (1.2 * libm::sqrtf(variance)).max(LEAST)
}
