//! Lines as sites, about one a pixel: what the laws of the simplifications are tried on.
#![allow(dead_code, reason = "each test takes what it needs")]

use core::f64::consts::TAU;
use plotter_vector::PxPoint;
use proptest::prelude::*;

/// A line of straight runs and arcs, with noise.
pub(crate) fn arcs_and_lines() -> impl Strategy<Value = Vec<PxPoint>> {
    let piece = (prop_oneof![Just(0.0), -0.2_f64..0.2], 3_usize..60);
    let noise = (0.0_f64..0.35, any::<u64>());
    (proptest::collection::vec(piece, 1..7), noise).prop_map(|(pieces, (amount, seed))| {
        let (mut at, mut angle, mut state) = (PxPoint::new(200.0, 200.0), 0.3_f64, seed);
        let mut sites = Vec::new();
        for (turn, steps) in pieces {
            for _ in 0..steps {
                angle += turn;
                at = PxPoint::new(at.x + angle.cos(), at.y + angle.sin());
                sites.push(PxPoint::new(
                    at.x + amount * random(&mut state),
                    at.y + amount * random(&mut state),
                ));
            }
        }
        sites
    })
}

/// A line that turns as it likes, with noise.
pub(crate) fn turning() -> impl Strategy<Value = Vec<PxPoint>> {
    (proptest::collection::vec((-0.3_f64..0.3, -1.0_f64..1.0, -1.0_f64..1.0), 2..250), 0.0_f64..0.4).prop_map(
        |(steps, noise)| {
            let (mut x, mut y, mut angle) = (100.0, 100.0, 0.0_f64);
            let place = |(turn, u, v): (f64, f64, f64)| {
                angle += turn;
                (x, y) = (x + angle.cos(), y + angle.sin());
                PxPoint::new(x + noise * u, y + noise * v)
            };
            steps.into_iter().map(place).collect()
        },
    )
}

/// Sites that go anywhere, also back and by leaps.
pub(crate) fn wild() -> impl Strategy<Value = Vec<PxPoint>> {
    proptest::collection::vec((-4_i32..5, -4_i32..5, 1_u8..9), 1..120).prop_map(|steps| {
        let (mut x, mut y) = (0.0, 0.0);
        let place = |(dx, dy, parts): (i32, i32, u8)| {
            (x, y) = (x + f64::from(dx) / f64::from(parts), y + f64::from(dy) / f64::from(parts));
            PxPoint::new(x, y)
        };
        steps.into_iter().map(place).collect()
    })
}

/// Seeded, between −1 and 1.
pub(crate) fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    2.0 * ((*state >> 11) as f64 / (1_u64 << 53) as f64) - 1.0
}

/// A curve over 0 to 1 at about 1 px a site, each off by up to so much in x and in y.
pub(crate) fn sampled(at: impl Fn(f64) -> (f64, f64), amount_px: f64) -> Vec<PxPoint> {
    let mut state = 11;
    let (mut last, mut way, mut sites) = (at(0.0), 1.0, Vec::new());
    for i in 0..=100_000 {
        let now = at(f64::from(i) / 100_000.0);
        way += (now.0 - last.0).hypot(now.1 - last.1);
        last = now;
        if way >= 1.0 {
            way -= 1.0;
            sites.push(PxPoint::new(
                now.0 + amount_px * random(&mut state),
                now.1 + amount_px * random(&mut state),
            ));
        }
    }
    sites
}

/// A circle about (300, 300).
pub(crate) fn circle(radius_px: f64) -> impl Fn(f64) -> (f64, f64) {
    move |u: f64| (300.0 + radius_px * (TAU * u).cos(), 300.0 + radius_px * (TAU * u).sin())
}

/// Six turns, out to 155 px.
pub(crate) fn spiral(u: f64) -> (f64, f64) {
    (300.0 + (5.0 + 150.0 * u) * (40.0 * u).cos(), 300.0 + (5.0 + 150.0 * u) * (40.0 * u).sin())
}

/// A wave 100 px high.
pub(crate) fn sine(u: f64) -> (f64, f64) {
    (2000.0 * u, 300.0 + 100.0 * (10.0 * u).sin())
}

/// 200 by 120 px.
pub(crate) fn ellipse(u: f64) -> (f64, f64) {
    (300.0 + 100.0 * (TAU * u).cos(), 300.0 + 60.0 * (TAU * u).sin())
}

/// Loops like those of a hand, with cusps.
pub(crate) fn handwriting(u: f64) -> (f64, f64) {
    let x = 60.0 * u;
    (
        5.0 * x + 25.0 * (0.9 * x).sin() + 6.0 * (2.3 * x).cos(),
        20.0 * (0.9 * x).cos() + 12.0 * (0.37 * x).sin(),
    )
}
