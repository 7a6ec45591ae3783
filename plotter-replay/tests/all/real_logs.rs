//! Decodes recordings as the notes beside them say: small ones of ours, and of others where they are at hand.

use crate::real_files::{name_of, other, ours};
use plotter_motion::StepPoint;
use plotter_replay::log::{Event, Record};
use plotter_replay::{PlotterSettings, Reached, VirtualPlotter, virtual_plotter::AnomalyKind};
use serde_json::Value;
use std::time::Duration;

/// A recording of ours, or one of others where it is at hand.
fn recording(name: &str) -> Option<String> {
    let of_ours = ours("logs").into_iter().find(|file| name_of(file) == name);
    of_ours.or_else(|| other("logs", name)).map(|file| std::fs::read_to_string(file).unwrap())
}

/// Events of `plotter-raw/1`: `t_us,H|D,hex`; the rest of a cut last line is left out.
fn events(csv: &str) -> Vec<Record> {
    csv.lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| {
            let mut cells = line.split(',');
            let time = cells.next()?.parse().ok()?;
            let side = cells.next()?;
            let byte = cells.next().filter(|hex| hex.len() == 2)?;
            let byte = u8::from_str_radix(byte, 16).ok()?;
            Some(Record::at_us(
                time,
                if side == "H" { Event::Host(vec![byte]) } else { Event::Controller(vec![byte]) },
            ))
        })
        .collect()
}

fn point(value: &Value) -> StepPoint {
    let n = |i: usize| i32::try_from(value[i].as_i64().unwrap()).unwrap();
    StepPoint::new(n(0), n(1))
}

fn points(value: &Value) -> Vec<StepPoint> {
    value.as_array().unwrap().iter().map(point).collect()
}

/// Every position on the way along a polyline of horizontal and vertical pieces.
fn every_step(corners: &[StepPoint]) -> Vec<StepPoint> {
    let mut out = corners[..1].to_vec();
    for &to in &corners[1..] {
        let mut at = *out.last().unwrap();
        while at != to {
            at.x += (to.x - at.x).signum();
            at.y += (to.y - at.y).signum();
            out.push(at);
        }
    }
    out
}

fn decodes_as_noted(name: &str) {
    let (Some(csv), Some(json)) = (recording(&format!("{name}.csv")), recording(&format!("{name}.json")))
    else {
        return;
    };
    let noted: Value = serde_json::from_str(&json).unwrap();
    let records = events(&csv);
    assert_eq!(records.len() as u64, noted["events"].as_u64().unwrap());

    let mut plotter = VirtualPlotter::new(PlotterSettings::default());
    records.iter().for_each(|record| plotter.push(record));
    plotter.finish();

    let targets: Vec<_> = plotter.targets().iter().map(|&(_, target)| target).collect();
    assert_eq!(targets, points(&noted["targets"]));
    assert_eq!(plotter.raw_counts(), point(&noted["final_actual"]));
    assert_eq!(plotter.resynced_counts(), point(&noted["final_resynced"]));

    let reached: Vec<_> = noted["reached"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| Reached {
            time: Duration::from_micros(r["t_us"].as_u64().unwrap()),
            desired: point(&r["desired"]),
            actual: point(&r["actual"]),
            error: point(&r["error"]),
            resync_error: point(&r["resync_error"]),
        })
        .collect();
    assert_eq!(plotter.reached().collect::<Vec<_>>(), reached);

    let path: Vec<_> =
        plotter.legs().iter().flat_map(|leg| leg.points.iter().skip(1).map(|p| p.at)).collect();
    let mut with_start = vec![StepPoint::default()];
    with_start.extend(path);
    assert_eq!(with_start, every_step(&points(&noted["actual_polyline"])));

    // The notes give the index of the event at which each oddity shows; ours have its time.
    let found: Vec<String> =
        plotter.anomalies().iter().map(|a| format!("{} {:?}", a.time.as_micros(), a.kind)).collect();
    let expected: Vec<String> = noted["anomalies"]
        .as_array()
        .unwrap()
        .iter()
        .map(|a| {
            let index = usize::try_from(a["i"].as_u64().unwrap()).unwrap();
            let time = records.get(index).or(records.last()).unwrap().time.as_micros();
            let kind = match a["kind"].as_str().unwrap() {
                "reached_mismatch" => AnomalyKind::ReachedElsewhere { off: point(&a["error"]) },
                "gap" => AnomalyKind::Silence { silence: Duration::from_micros(a["us"].as_u64().unwrap()) },
                "extra_targets_sent" => AnomalyKind::ExtraTargets { count: a["count"].as_u64().unwrap() },
                "partial_target_at_end" => AnomalyKind::PartialTargetAtEnd {
                    digits: a["digits"]
                        .as_array()
                        .unwrap()
                        .iter()
                        .map(|d| u8::try_from(d.as_u64().unwrap()).unwrap())
                        .collect(),
                },
                other => panic!("the notes have an oddity that this test does not know: {other}"),
            };
            format!("{time} {kind:?}")
        })
        .collect();
    assert_eq!(found, expected);
}

#[test]
fn a_recording_with_dropped_bytes_decodes_as_noted() {
    decodes_as_noted("lost");
    decodes_as_noted("02_dropped_bytes");
}

#[test]
fn a_cut_recording_decodes_as_noted() {
    decodes_as_noted("cut");
    decodes_as_noted("04_truncated");
}

#[test]
fn what_two_tools_recorded_has_every_target_reached() {
    for name in ["whole.csv", "socat_pty_session.csv", "sigrok_uart.csv"] {
        let Some(csv) = recording(name) else { continue };
        let mut plotter = VirtualPlotter::new(PlotterSettings::default());
        events(&csv).iter().for_each(|record| plotter.push(record));
        plotter.finish();
        assert!(plotter.target_count() >= 5, "{name}");
        assert_eq!(plotter.reached_count(), plotter.target_count(), "{name}");
        assert_eq!(plotter.anomalies(), [], "{name}");
    }
}
