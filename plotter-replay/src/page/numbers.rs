//! Numbers as short JSON: differences, in whole micrometres and microseconds.

use super::envelope::whole;
use super::trail::TrailPoint;
use serde_json::{Value, json};

pub(crate) fn signed(time_us: u64) -> i64 {
    i64::try_from(time_us).unwrap_or(i64::MAX)
}

/// Each value as its difference from the one before: shorter.
pub(crate) fn steps(values: impl Iterator<Item = i64>) -> Vec<i64> {
    let mut before = 0_i64;
    values.map(|value| value.saturating_sub(core::mem::replace(&mut before, value))).collect()
}

/// A trail as differences, micrometres and microseconds; the states as one digit each.
pub(crate) fn along(points: &[TrailPoint], with_time: bool) -> Value {
    let state = |point: &TrailPoint| char::from(b'0'.saturating_add(point.state.min(9)));
    json!({
        "t": if with_time { steps(points.iter().map(|p| signed(p.at_us))) } else { Vec::new() },
        "x": steps(points.iter().map(|p| whole(p.x_mm * 1e3))),
        "y": steps(points.iter().map(|p| whole(p.y_mm * 1e3))),
        "s": points.iter().map(state).collect::<String>(),
    })
}
