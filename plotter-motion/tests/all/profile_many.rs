//! Planned speeds on very many inputs: drawn over all decades, and at the borders where a phase begins to
//! have a length.
//!
//! `PROFILE_CASES` sets how many (200,000 by default, ten million in `.ci/run`).

use plotter_motion::{
    MotionLimits,
    profile::{Ramp, SCurve, Trapezoid, TrapezoidMove},
};

/// How far a limit may be passed and a length or an end missed, as a share: rounding, and nothing else.
const ROUNDING: f64 = 1e-9;
/// Below this length, mm, the last bits of a distance have no place in a double.
const SHORTEST_MM: f64 = 1e-290;

fn cases() -> u64 {
    std::env::var("PROFILE_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(200_000)
}

/// SplitMix64 (G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number generators", 2014).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        #[expect(clippy::cast_possible_truncation, reason = "taken modulo n right away")]
        let bits = self.bits() as usize;
        bits % n
    }

    /// 0 to 1.
    fn share(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A limit: over all decades that are allowed, over those of machines, a round number, or an end of the
    /// range.
    fn limit(&mut self) -> f64 {
        match self.below(8) {
            0 => 1e-18,
            1 => 1e18,
            2 | 3 => [1.0, 2.0, 4.0, 5.0][self.below(4)] * [0.1, 1.0, 1e1, 1e2, 1e3, 1e4, 1e5][self.below(7)],
            4 | 5 => 10_f64.powf(-1.0 + 7.0 * self.share()),
            _ => 10_f64.powf(-17.9 + 35.8 * self.share()),
        }
    }

    /// A number at most four places of the last bit from `value`.
    fn near(&mut self, value: f64) -> f64 {
        f64::from_bits((value.to_bits() + self.bits() % 9).saturating_sub(4))
    }

    /// A length: none, tiny, huge, any, or next to one of `borders`.
    fn length(&mut self, borders: &[f64]) -> f64 {
        let length = match self.below(8) {
            0 => [0.0, 5e-324, 1e-300, SHORTEST_MM, 1e18][self.below(5)],
            1 => 10_f64.powf(-290.0 + 308.0 * self.share()),
            2 => 10_f64.powf(-3.0 + 6.0 * self.share()),
            3 => borders[self.below(borders.len())] * (2.0 * self.share()),
            _ => {
                let border = borders[self.below(borders.len())];
                self.near(border)
            }
        };
        length.clamp(0.0, 1e18)
    }
}

/// `a` and `b` are the same up to rounding of numbers as large as `size`.
fn close(a: f64, b: f64, size: f64) -> bool {
    (a - b).abs() <= ROUNDING * size
}

/// All laws of a planned motion from rest to rest.
fn check_s_curve(length_mm: f64, limits: MotionLimits) -> Result<(), String> {
    let MotionLimits { speed_mm_s, accel_mm_s2, jerk_mm_s3 } = limits;
    let motion = SCurve::plan(length_mm, limits).map_err(|error| error.to_string())?;
    let must = |holds: bool, law: &str| if holds { Ok(()) } else { Err(format!("{law}: {motion:?}")) };
    let duration_s = motion.duration_s();
    let phases_s = motion.phases_s();
    must(duration_s.is_finite() && phases_s.iter().all(|phase_s| *phase_s >= 0.0), "times are times")?;

    // By hand through the seven phases, apart from the code that is tested.
    let jerks = [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0].map(|sign| sign * jerk_mm_s3);
    let (mut s, mut v, mut a, mut t) = (0.0, 0.0, 0.0, 0.0_f64);
    let (mut peak_v, mut peak_a) = (0.0_f64, 0.0_f64);
    for (phase_s, jerk) in phases_s.into_iter().zip(jerks) {
        s += phase_s * (v + phase_s * (a / 2.0 + phase_s * jerk / 6.0));
        v += phase_s * (a + phase_s * jerk / 2.0);
        a += phase_s * jerk;
        t += phase_s;
        peak_v = peak_v.max(v);
        peak_a = peak_a.max(a.abs());
        // What the motion says at the same time. Between the phases of an hour's cruise a double cannot tell
        // the milliseconds of the others apart: so much later or earlier it may be.
        let blur_s = 4.0 * f64::EPSILON * duration_s;
        let point = motion.at(t);
        let finite =
            point.distance_mm.is_finite() && point.speed_mm_s.is_finite() && point.accel_mm_s2.is_finite();
        must(finite, "all is finite")?;
        must(close(point.distance_mm, s, length_mm.max(SHORTEST_MM)), "distance at the end of a phase")?;
        must(
            (point.speed_mm_s - v).abs() <= ROUNDING * peak_v + blur_s * peak_a,
            "speed at the end of a phase",
        )?;
        must(
            (point.accel_mm_s2 - a).abs() <= ROUNDING * peak_a + blur_s * jerk_mm_s3,
            "acceleration at the end of a phase",
        )?;
        must(point.speed_mm_s <= speed_mm_s * (1.0 + ROUNDING), "speed limit")?;
        must(point.accel_mm_s2.abs() <= accel_mm_s2 * (1.0 + ROUNDING), "acceleration limit")?;
    }
    must(peak_v <= speed_mm_s * (1.0 + ROUNDING), "speed limit")?;
    must(peak_a <= accel_mm_s2 * (1.0 + ROUNDING), "acceleration limit")?;
    must(close(s, length_mm, length_mm.max(SHORTEST_MM)), "the phases go the length")?;
    must(v.abs() <= ROUNDING * peak_v && a.abs() <= ROUNDING * peak_a, "the phases end at rest")?;
    let end = motion.at(duration_s);
    must(
        (end.distance_mm, end.speed_mm_s, end.accel_mm_s2) == (length_mm, 0.0, 0.0),
        "the end is exactly the end",
    )?;

    // Quickest: whatever has a length does so at its limit.
    let [jerk_s, steady_s, _, cruise_s, ..] = phases_s;
    must(cruise_s == 0.0 || close(peak_v, speed_mm_s, speed_mm_s), "cruises at full speed")?;
    must(steady_s == 0.0 || close(peak_a, accel_mm_s2, accel_mm_s2), "steady at full acceleration")?;
    must(length_mm == 0.0 || jerk_s > 0.0, "no length without time")?;
    Ok(())
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn s_curves_keep_their_limits_and_end_at_rest_on_all_inputs() {
    let mut random = Random(1);
    for case in 0..cases() {
        let (mut speed_mm_s, accel_mm_s2, jerk_mm_s3) = (random.limit(), random.limit(), random.limit());
        let jerk_s = accel_mm_s2 / jerk_mm_s3;
        if random.below(4) == 0 {
            // where full acceleration is reached at full speed, and not before
            speed_mm_s = random.near(accel_mm_s2 * jerk_s).clamp(1e-18, 1e18);
        }
        let borders = [
            speed_mm_s * (speed_mm_s / accel_mm_s2 + jerk_s), // full speed, with full acceleration
            2.0 * speed_mm_s * (speed_mm_s / jerk_mm_s3).sqrt(), // full speed, without
            2.0 * accel_mm_s2 * jerk_s * jerk_s,              // full acceleration
        ];
        let length_mm = random.length(&borders);
        let limits = MotionLimits { speed_mm_s, accel_mm_s2, jerk_mm_s3 };
        if let Err(law) = check_s_curve(length_mm, limits) {
            panic!("case {case}, {length_mm:e} mm within {limits:?}: {law}");
        }
    }
}

/// Two published planners fail on this input (pantor/ruckig 0.19.4 and rsruckig 3.0.1): full acceleration is
/// reached at one place in the last bits.
#[test]
fn a_length_at_which_full_acceleration_is_just_reached_is_planned() {
    let limits = MotionLimits { speed_mm_s: 100.0, accel_mm_s2: 1_000.0, jerk_mm_s3: 20_000.0 };
    let length_mm = 5.000_000_000_000_012;
    check_s_curve(length_mm, limits).unwrap();
    // tj = 0.05 s four times, at 50 mm/s the peak
    let motion = SCurve::plan(length_mm, limits).unwrap();
    assert!(close(motion.duration_s(), 0.2, 0.2));
    assert!(close(motion.at(0.1).speed_mm_s, 50.0, 50.0));
}

/// All laws of a trapezoid.
fn check_trapezoid(asked: TrapezoidMove) -> Result<(), String> {
    let TrapezoidMove { length_mm, entry_mm_s, exit_mm_s, speed_mm_s, accel_mm_s2 } = asked;
    let motion = Trapezoid::plan(asked).map_err(|error| error.to_string())?;
    let must = |holds: bool, law: &str| if holds { Ok(()) } else { Err(format!("{law}: {motion:?}")) };
    let (duration_s, peak_mm_s, exit) = (motion.duration_s(), motion.peak_mm_s(), motion.exit_mm_s());
    must(duration_s.is_finite() && duration_s >= 0.0, "a time")?;
    must(peak_mm_s <= speed_mm_s && peak_mm_s >= entry_mm_s * (1.0 - ROUNDING), "speed limit")?;

    // v² - v0² = 2 a s: over the whole length no greater change is possible, and less than that is done
    // exactly.
    let most = 2.0 * accel_mm_s2 * length_mm;
    let square = |speed: f64| speed * speed;
    let wanted = square(exit_mm_s) - square(entry_mm_s);
    let size = square(entry_mm_s.max(exit_mm_s)) + 2.0 * accel_mm_s2 * length_mm.max(SHORTEST_MM);
    if wanted > most {
        must(close(square(exit) - square(entry_mm_s), most, size), "as fast as it can become")?;
    } else if wanted < -most {
        must(close(square(exit) - square(entry_mm_s), -most, size), "as slow as it can become")?;
    } else {
        must(close(square(exit), square(exit_mm_s), size), "the exit speed asked for")?;
        // Quickest: at full speed, or the ramps meet with nothing between: 2 v² = v0² + v1² + 2 a L.
        let full = close(peak_mm_s, speed_mm_s, speed_mm_s);
        let met = close(2.0 * square(peak_mm_s), square(entry_mm_s) + square(exit_mm_s) + most, size);
        must(full || met, "no slower than it must be")?;
        must(
            !full
                || 2.0 * square(peak_mm_s) <= square(entry_mm_s) + square(exit_mm_s) + most + ROUNDING * size,
            "room",
        )?;
    }

    let (start, end) = (motion.at(0.0), motion.at(duration_s));
    must(start.distance_mm.abs() <= ROUNDING * length_mm.max(SHORTEST_MM), "starts at the start")?;
    let slowest = (accel_mm_s2 * SHORTEST_MM).sqrt(); // no ramp over the shortest length reaches less
    let off = (start.speed_mm_s - entry_mm_s).abs();
    must(off <= ROUNDING * peak_mm_s + slowest, "starts with the entry speed")?;
    must(end.distance_mm == length_mm || length_mm < SHORTEST_MM, "ends exactly at the end")?;
    must(close(end.speed_mm_s, exit, peak_mm_s), "ends with the exit speed")?;
    let mut before = start;
    for eighth in 1..=8 {
        let t = duration_s * f64::from(eighth) / 8.0;
        let point = motion.at(t);
        let step_s = duration_s / 8.0;
        must(point.speed_mm_s <= speed_mm_s * (1.0 + ROUNDING) && point.speed_mm_s >= 0.0, "speed limit")?;
        must(point.accel_mm_s2.abs() <= accel_mm_s2, "acceleration limit")?;
        let change = (point.speed_mm_s - before.speed_mm_s).abs();
        must(
            change <= accel_mm_s2 * step_s * (1.0 + ROUNDING) + ROUNDING * peak_mm_s,
            "speed without jumps",
        )?;
        let gone_mm = point.distance_mm - before.distance_mm;
        let least_mm = ROUNDING * length_mm.max(SHORTEST_MM);
        must(gone_mm >= -least_mm && gone_mm <= peak_mm_s * step_s + least_mm, "place without jumps")?;
        // The time of a place is when the motion is there.
        let back_mm = motion.at(motion.time_at(point.distance_mm)).distance_mm;
        must(close(back_mm, point.distance_mm, length_mm.max(SHORTEST_MM)), "time of a place")?;
        before = point;
    }
    Ok(())
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn trapezoids_keep_their_limits_and_reach_their_end_on_all_inputs() {
    let mut random = Random(2);
    for case in 0..cases() {
        let (speed_mm_s, accel_mm_s2) = (random.limit(), random.limit());
        let mut end_speed = || match random.below(8) {
            0 | 1 => 0.0,
            2 => speed_mm_s,
            3 => speed_mm_s * 10_f64.powf(-20.0 * random.share()),
            4 => random.near(0.5 * speed_mm_s),
            _ => speed_mm_s * random.share(),
        };
        let (entry_mm_s, exit_mm_s) = (end_speed(), end_speed());
        let ramp_mm = |from: f64, to: f64| Ramp::between(from, to, accel_mm_s2).unwrap().length_mm();
        let borders = [
            ramp_mm(entry_mm_s, speed_mm_s) + ramp_mm(speed_mm_s, exit_mm_s), // full speed
            ramp_mm(entry_mm_s, exit_mm_s),                                   // the exit speed
        ];
        let length_mm = random.length(&borders);
        let asked = TrapezoidMove { length_mm, entry_mm_s, exit_mm_s, speed_mm_s, accel_mm_s2 };
        if let Err(law) = check_trapezoid(asked) {
            panic!("case {case}, {asked:?}: {law}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn ramps_change_the_speed_as_the_book_says_on_all_inputs() {
    let mut random = Random(3);
    for case in 0..cases() {
        let accel = random.limit();
        let mut speed = || if random.below(4) == 0 { 0.0 } else { random.limit() };
        let (from, to) = (speed(), speed());
        let ramp = Ramp::between(from, to, accel).unwrap();
        let (low, high) = (from.min(to), from.max(to));
        let case = format!("case {case}, {from:e} to {to:e} mm/s at {accel:e} mm/s2: {ramp:?}");
        assert!(close(ramp.duration_s() * accel, high - low, high - low), "{case}");
        assert!(
            close(2.0 * accel * ramp.length_mm(), (high - low) * (high + low), (high - low) * (high + low)),
            "{case}"
        );
        assert_eq!((ramp.entry_mm_s(), ramp.exit_mm_s()), (from, to), "{case}");
        let (start, end) = (ramp.at(0.0), ramp.at(ramp.duration_s()));
        assert!(close(start.speed_mm_s, from, high) && close(end.speed_mm_s, to, high), "{case}");
        assert!(
            close(start.distance_mm, 0.0, ramp.length_mm())
                && close(end.distance_mm, ramp.length_mm(), ramp.length_mm()),
            "{case}"
        );
        let middle = ramp.at(0.5 * ramp.duration_s());
        assert!(close(middle.speed_mm_s, 0.5 * (from + to), high), "{case}");
        assert!(
            close(ramp.time_at(middle.distance_mm), 0.5 * ramp.duration_s(), ramp.duration_s()),
            "{case}"
        );
    }
}
