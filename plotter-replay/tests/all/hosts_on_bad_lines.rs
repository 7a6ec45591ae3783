//! What hosts notice where bytes come wrong: a hundredth of all bytes, in both directions.
//!
//! ```text
//! cargo test --release -p plotter-replay --features cli,live --test all hosts_on_bad_lines:: -- --include-ignored --nocapture
//! ```

use crate::driven::{Desk, machine};
use crate::hosts_of_hpgl::machine as coarse;
use plotter_motion::gcode::{PenControl, WriteOptions};
use plotter_motion::kinematics::{BeltSigns, CoreXy};
use plotter_motion::protocol::ebb::EbbMotionSettings;
use plotter_motion::protocol::hosts::{
    EbbHost, EbbHostSettings, Grbl, HostState, Hpgl, LineHost, LineHostSettings, MDraw, MachineHost,
    MachineNotice, Marlin, Request,
};

use plotter_motion::{Machine, PlannerSettings, PlotOp, Point, SplitMix64};
use plotter_replay::live::Spoken;
use std::collections::BTreeSet;
use std::time::Duration;

/// Strokes of some lines each, at places of this seed.
fn drawing(seed: u64) -> Vec<PlotOp> {
    let mut random = SplitMix64::new(seed);
    let mut place = move || {
        let mut mm = |most: f64| (random.unit() * most * 100.0).round() / 100.0;
        Point::new(mm(60.0), mm(40.0))
    };
    let mut ops = Vec::new();
    for _ in 0..3 {
        ops.push(PlotOp::Travel { to: place() });
        ops.extend((0..4).map(|_| PlotOp::Draw { to: place(), feed_mm_s: Some(40.0) }));
    }
    ops
}

fn host(spoken: Spoken, seed: u64) -> Box<dyn MachineHost> {
    let (ops, settings) = (drawing(seed).into_iter(), LineHostSettings::default());
    let options = WriteOptions { settle: Duration::ZERO, ..WriteOptions::default() };
    match spoken {
        Spoken::Grbl => Box::new(LineHost::new(Grbl::new(options), settings, ops)),
        Spoken::Marlin => {
            let pen = PenControl::Commands { up: "G4 P0\nM280 P0 S160", down: "G4 P0\nM280 P0 S90" };
            Box::new(LineHost::new(Marlin::new(WriteOptions { pen, ..options }), settings, ops))
        }
        Spoken::Hpgl => Box::new(LineHost::new(Hpgl::new(), settings, ops)),
        Spoken::Ebb { .. } => {
            let belt = CoreXy::new(BeltSigns::TrackingEquations, 20.0).unwrap();
            let settings = EbbHostSettings {
                planner: PlannerSettings::of(&machine_of(spoken)),
                motion: EbbMotionSettings {
                    pen_settle: Duration::from_millis(100),
                    ..EbbMotionSettings::default()
                },
                ..EbbHostSettings::default()
            };
            Box::new(EbbHost::new(belt, settings, ops).unwrap())
        }
        _ => Box::new(LineHost::new(MDraw::new("M1 160", "M1 90"), settings, ops)),
    }
}

/// A step of the plotter with HPGL is two of its units; the other machines have steps of their own.
fn machine_of(spoken: Spoken) -> Machine {
    if matches!(spoken, Spoken::Hpgl | Spoken::Ebb { .. }) { coarse() } else { machine() }
}

/// All of which it is tried.
const SPOKEN: [Spoken; 5] =
    [Spoken::Grbl, Spoken::MDraw, Spoken::Marlin, Spoken::Hpgl, Spoken::Ebb { is_mixed: true }];

/// What became of a drawing.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
struct Ends {
    /// All of it as it should be, and nothing noticed that is not so.
    whole: u32,
    /// Not whole, and the host says that something is wrong.
    noticed: u32,
    /// Not whole, and nothing is said: a place on the way was wrong, and the next line led back.
    unnoticed: u32,
    /// Of these, drawings that end at a wrong place.
    ends_elsewhere: u32,
}

/// The steps with the pen down, and the place at the end.
fn draw(spoken: Spoken, seed: u64, damaged: Option<u64>) -> (BTreeSet<(i32, i32)>, bool, Option<Point>) {
    let mut desk = Desk::new(host(spoken, seed), &machine_of(spoken), spoken, "");
    if let Some(seed) = damaged {
        let mut random = SplitMix64::new(seed);
        desk.damage =
            Some(Box::new(
                move |_, byte| {
                    if random.unit() < 0.01 { byte ^ (1 << (random.below(8))) } else { byte }
                },
            ));
    }
    let end = Duration::from_secs(180);
    let mut is_wrong = false;
    let mut is_begun = false;
    let mut is_over = false;
    while desk.now() < end {
        desk.round();
        let state = desk.host.status().state;
        is_wrong |= desk.notices.iter().any(|notice| {
            !matches!(notice, MachineNotice::State(_) | MachineNotice::Greeted | MachineNotice::Garbled)
        });
        desk.notices.clear();
        if is_over {
            break; // what it noticed of the end is told
        }
        match state {
            HostState::Ready if !is_begun => {
                desk.ask(Request::GoOn);
                is_begun = true;
            }
            // What it stops at, it says.
            HostState::Done | HostState::Paused | HostState::Stopped | HostState::Locked(_) => is_over = true,
            _ => {}
        }
    }
    let is_done = desk.host.status().state == HostState::Done;
    (desk.ink(), is_wrong || !is_done, is_done.then(|| desk.host.status().at).flatten())
}

fn ends(spoken: Spoken, seeds: std::ops::Range<u64>) -> Ends {
    let mut ends = Ends::default();
    for seed in seeds {
        let (plain, wrong, at) = draw(spoken, seed, None);
        assert!(!wrong && !plain.is_empty(), "{seed}");
        let (ink, is_noticed, told) = draw(spoken, seed, Some(seed ^ 0x5eed));
        let near = |set: &BTreeSet<(i32, i32)>, (x, y): (i32, i32)| {
            (-1..=1).any(|dx| (-1..=1).any(|dy| set.contains(&(x + dx, y + dy))))
        };
        let is_whole = ink.iter().all(|at| near(&plain, *at)) && plain.iter().all(|at| near(&ink, *at));
        match (is_whole, is_noticed) {
            (true, _) => ends.whole += 1,
            (false, true) => ends.noticed += 1,
            (false, false) => {
                ends.unnoticed += 1;
                ends.ends_elsewhere +=
                    u32::from(told.zip(at).is_none_or(|(told, at)| told.distance(at) > 0.06));
            }
        }
    }
    println!("{spoken:?}: {ends:?}");
    ends
}

#[test]
fn damage_to_the_place_is_seen_at_the_next_rest() {
    for spoken in SPOKEN {
        let ends = ends(spoken, 0..6);
        assert_eq!(ends.ends_elsewhere, 0, "{spoken:?}: {ends:?}");
        // Marlin's lines are sent again where they come wrong, EBB's where the board refuses them.
        assert!(ends.noticed > 0 || ends.whole == 6, "{spoken:?}: {ends:?}");
    }
}

#[test]
#[ignore = "a thousand drawings in each language, minutes: cargo test --release -p plotter-replay --features cli,live --test all hosts_on_bad_lines:: -- --ignored --nocapture"]
fn of_a_thousand_drawings() {
    for spoken in SPOKEN {
        let ends = ends(spoken, 1_000..2_000);
        assert_eq!(ends.ends_elsewhere, 0, "{spoken:?}: {ends:?}");
        if spoken == Spoken::Marlin {
            assert_eq!(ends.unnoticed, 0, "{spoken:?}: {ends:?}");
        }
    }
}
