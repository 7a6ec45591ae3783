//! The command `long_sheet`: recorded scans in, poses or refusals out.

use crate::built_example;

use crate::real_files::{name_of, other, ours};
use built_example::{complaint, data, run_example};
use plotter_examples::long_sheet::{CrossingSet, JointAnswer, answer_traces};
use plotter_motion::{Axis, Vec2};
use plotter_stitch::{
    Crossing, FrameTransform, Optics, ReferenceLines,
    sense::Tact,
    sheet::{SensedJoint, SensorNoise},
};
use serde_json::{Value, json};

/// One scan of a simulated joint.
fn scan(
    sensed: &mut SensedJoint,
    crossing: usize,
    from_mm: f64,
    velocity_mm_s: f64,
    tacts: u32,
) -> Vec<Tact> {
    let place = |tact: u32| from_mm + velocity_mm_s * 0.002 * f64::from(tact);
    (0..tacts).map(|tact| sensed.tact(crossing, place(tact), velocity_mm_s)).collect()
}

fn hits(tacts: &[Tact]) -> String {
    tacts.iter().map(|tact| tact.hits.to_string()).collect()
}

fn as_trace(tacts: &[Tact], velocity_mm_s: f64) -> Value {
    let adc = |led: usize| -> Vec<f64> {
        tacts.iter().map(|tact| (1000.0 * tact.covered.unwrap()[led]).round()).collect()
    };
    json!({
        "dir": velocity_mm_s.signum(), "v_mm_s": velocity_mm_s.abs(), "hits": hits(tacts),
        "pos_mm": tacts.iter().map(|tact| tact.position_mm).collect::<Vec<_>>(), "adc_a": adc(0), "adc_b": adc(1),
    })
}

fn as_batch(tacts: &[Tact], velocity_mm_s: f64) -> Value {
    json!([tacts[0].position_mm, velocity_mm_s * 0.002, hits(tacts)])
}

/// Where something was seen for the first time.
fn first_seen(tacts: &[Tact]) -> Option<f64> {
    let first = tacts.iter().position(|tact| tact.hits > 0)?;
    let seen = tacts[first..].iter().take_while(|tact| tact.hits > 0).count();
    Some((tacts[first].position_mm + tacts[first + seen - 1].position_mm) / 2.0)
}

fn axis(crossing: &Crossing) -> &'static str {
    if crossing.axis == Axis::X { "x" } else { "y" }
}

/// A trace of a joint, and the same joint for a batch.
fn recorded(sheet: &FrameTransform, noise: SensorNoise, seed: u64) -> (Value, Value) {
    let noise = SensorNoise { gives_signal: true, ..noise };
    let sets = [
        ("paper", {
            let published: Vec<Crossing> = ReferenceLines::published().crossings().collect();
            vec![published[0], published[2], published[3]]
        }),
        ("strip16", ReferenceLines::strip16().crossings().collect()),
    ];
    let (mut crossings, mut batch) = (Vec::new(), serde_json::Map::new());
    for (set, marks) in sets {
        let mut sensed = SensedJoint::new(&marks, sheet, Optics::default(), noise, seed);
        let mut joint = Vec::new();
        for (index, mark) in marks.iter().enumerate() {
            let coarse = scan(&mut sensed, index, mark.mark_mm - 11.9, 300.0, 41);
            let fine: Vec<_> = first_seen(&coarse)
                .filter(|_| set == "strip16")
                .map(|about_mm| [(about_mm - 1.5, 30.0), (about_mm + 1.5, -30.0)])
                .into_iter()
                .flatten()
                .map(|(from_mm, velocity_mm_s)| {
                    (scan(&mut sensed, index, from_mm, velocity_mm_s, 51), velocity_mm_s)
                })
                .collect();
            let traced: Vec<Value> = fine.iter().map(|(tacts, v)| as_trace(tacts, *v)).collect();
            crossings.push(json!({
                "set": set, "line": "", "scan_axis": axis(mark), "mark_local_mm": mark.mark_mm,
                "scan_at_machine_mm": mark.scan_at_mm, "coarse": as_trace(&coarse, 300.0), "fine": traced,
            }));
            joint.push(if set == "paper" {
                as_batch(&coarse, 300.0)
            } else {
                fine.iter().map(|(tacts, v)| as_batch(tacts, *v)).collect()
            });
        }
        batch.insert(set.into(), joint.into());
    }
    let trace = json!({
        "format": "stitch-trace/1", "case": format!("seed {seed}"), "tact_s": 0.002, "led_offset_s": [-0.0005, 0.0005],
        "disc_mm": 0.6, "line_mm": 0.5, "threshold": 0.1, "adc_full_scale": 1000, "search_half_window_mm": 12.0,
        "feed_axis": "y", "crossings": crossings,
    });
    (trace, batch.into())
}

fn batch(joints: &[Value]) -> Value {
    let layout = |lines: &[Crossing]| -> Value {
        lines.iter().map(|mark| json!([axis(mark), mark.mark_mm, mark.scan_at_mm])).collect()
    };
    let published: Vec<Crossing> = ReferenceLines::published().crossings().collect();
    let strip: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
    json!({
        "format": "stitch-batch/1", "feed_axis": "y", "tact_s": 0.002, "led_offset_s": [-0.0005, 0.0005], "threshold": 0.1,
        "layout_paper": layout(&[published[0], published[2], published[3]]), "layout_strip16": layout(&strip),
        "joints": joints,
    })
}

fn sheet(seed: u64) -> FrameTransform {
    let part = |factor: f64| (factor * (seed + 1) as f64).sin();
    FrameTransform::new(0.002 * part(1.3), Vec2::new(5.0 * part(2.7), 5.0 * part(4.1))).unwrap()
}

/// Mean of the squared errors over their variances, of what was told.
fn mean_normalized(answers: &[JointAnswer]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (seed, answer) in (0..).zip(answers) {
        let (Ok(pose), truth) = (&answer.pose, sheet(seed)) else { continue };
        let off = pose.transform.shift() - truth.shift();
        sum += ((pose.transform.angle_rad() - truth.angle_rad()) / pose.sigma_angle_rad).powi(2)
            + (off.x / pose.sigma_shift_mm[0]).powi(2)
            + (off.y / pose.sigma_shift_mm[1]).powi(2);
        count += 3.0;
    }
    sum / count
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn traces_and_batches_of_many_joints_are_told_with_honest_deviations() {
    const JOINTS: u64 = 150;
    let noise = SensorNoise { signal: 0.02, missed: 0.03, dust: 0.05, ..SensorNoise::default() };
    let (mut traced, mut joints) = (Vec::new(), Vec::new());
    for seed in 0..JOINTS {
        let (trace, joint) = recorded(&sheet(seed), noise, seed);
        traced.extend(answer_traces(&trace.to_string(), "trace", CrossingSet::Strip16).unwrap());
        joints.push(joint);
    }
    let batched = answer_traces(&batch(&joints).to_string(), "many", CrossingSet::Strip16).unwrap();
    assert_eq!(batched[7].to_json()["case"], "many#7");
    for (form, answers) in [("trace", &traced), ("batch", &batched)] {
        let silent = answers.iter().filter(|answer| answer.pose.is_err()).count();
        let normalized = mean_normalized(answers);
        println!("{form}: {silent} of {} refused, mean normalized square {normalized:.3}", answers.len());
        assert!(silent <= 2, "{form}: {silent}");
        // 450 squares of a normal number: their mean is 1 to 0.067, and four of these.
        assert!((0.73..1.27).contains(&normalized), "{form}: {normalized}");
        for (seed, pose) in
            (0..).zip(answers).filter_map(|(seed, answer)| Some((seed, answer.pose.as_ref().ok()?)))
        {
            let off_mm = (pose.transform.shift() - sheet(seed).shift()).length();
            assert!(off_mm < 0.1, "{form} {seed}: {off_mm} mm");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_published_crossings_are_told_by_the_published_method() {
    let (mut joints, noise) = (Vec::new(), SensorNoise::default());
    for seed in 0..300 {
        joints.push(recorded(&sheet(seed), noise, seed).1);
    }
    let answers = answer_traces(&batch(&joints).to_string(), "many", CrossingSet::Paper).unwrap();
    let normalized = mean_normalized(&answers);
    println!("published: mean normalized square {normalized:.3}");
    assert!(answers.iter().all(|answer| answer.pose.is_ok()));
    assert!((0.75..1.25).contains(&normalized), "{normalized}");
}

#[test]
fn one_bad_file_does_not_lose_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (good, bad, out) = (file("good.json"), file("bad.json"), file("out.json"));
    let trace = recorded(&sheet(1), SensorNoise::default(), 1).0;
    std::fs::write(&good, trace.to_string()).unwrap();
    let wrong_texts = [
        ("", "is no JSON"),
        ("[1", "is no JSON"),
        (
            "{\"format\": \"stitch-trace/9\"}",
            "format: `stitch-trace/9` is unknown; stitch-trace/1 and stitch-batch/1 are read",
        ),
        ("{\"format\": 3}", "format: a text is expected, found 3"),
        ("{\"crossings\": []}", "`format` is missing"),
        ("{\"format\": NaN}", "NaN in line 1, column 12 is no number of JSON"),
    ];
    for (text, why) in wrong_texts {
        std::fs::write(&bad, text).unwrap();
        let output = run_example("long_sheet", &["--traces", &bad, &good, "--out", &out]);
        assert_eq!(output.status.code(), Some(1), "{text}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains("bad.json") && said.contains(why), "{text}: {said}");
        let told: Value = serde_json::from_str(&std::fs::read_to_string(&out).unwrap()).unwrap();
        assert_eq!(told[0]["case"], "bad");
        assert!(told[0]["refused"].as_str().unwrap().contains(why), "{told}");
        assert_eq!(told[1]["case"], "seed 1");
        assert_eq!(told[1]["inliers"], 16);
    }
}

#[test]
fn files_that_are_none_are_named() {
    let said = complaint("long_sheet", &["--traces", "no-such.json"]);
    assert!(said.starts_with("long_sheet: no-such.json: cannot be read"), "{said}");
    let said = complaint("long_sheet", &["--traces", &data("flag.png")]);
    assert!(said.ends_with("flag.png: is no text, let alone JSON"), "{said}");
}

#[test]
fn what_is_wrong_in_a_trace_is_named() {
    let trace = recorded(&sheet(2), SensorNoise::default(), 2).0;
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut trace = trace.clone();
        change(&mut trace);
        let answers = answer_traces(&trace.to_string(), "trace", CrossingSet::Strip16).unwrap();
        answers[0].to_json()["refused"].as_str().map_or_else(|| format!("told {answers:?}"), str::to_owned)
    };
    assert_eq!(refused(&|t| t["crossings"] = json!([])), "the trace has no crossings of the set strip16");
    assert_eq!(refused(&|t| t["crossings"] = json!(7)), "crossings: a list is expected, found 7");
    assert_eq!(
        refused(&|t| t["crossings"][4]["coarse"]["pos_mm"][3] = json!("far")),
        "crossings[4].coarse.pos_mm[3]: a number is expected, found \"far\""
    );
    assert_eq!(
        refused(&|t| t["crossings"][4]["fine"][1]["hits"] = json!("01")),
        "crossings[4].fine[1]: hits has 2 tacts, the positions are 51"
    );
    assert_eq!(
        refused(&|t| t["crossings"][4]["coarse"]["hits"] = json!("0".repeat(40) + "7")),
        "crossings[4].coarse.hits: tact 40 has none of the digits 0, 1 and 2"
    );
    let out_of_order = refused(&|t| {
        let third = t["crossings"][4]["coarse"]["pos_mm"][2].clone();
        t["crossings"][4]["coarse"]["pos_mm"][3] = third;
    });
    assert!(out_of_order.starts_with("crossings[4].coarse: tact 3: the tact at"), "{out_of_order}");
    assert!(out_of_order.ends_with("give the tacts in the order of the scan"), "{out_of_order}");
    assert_eq!(refused(&|t| t["disc_mm"] = json!(0)), "disc_mm: 0 is out of 0.000001 to 1000");
    assert_eq!(
        refused(&|t| t["crossings"][4]["mark_local_mm"] = Value::Null),
        "crossings[4]: `mark_local_mm` is missing"
    );
    // Twelve marks missed.
    let missed = refused(&|t| {
        for crossing in t["crossings"].as_array_mut().unwrap().iter_mut().skip(7) {
            crossing["coarse"]["hits"] = json!("0".repeat(41));
            crossing["coarse"]["adc_a"] = json!(vec![0; 41]);
            crossing["coarse"]["adc_b"] = json!(vec![0; 41]);
            crossing["fine"] = json!([]);
        }
    });
    assert!(missed.starts_with("only 4 crossings found a line, at least 6 are needed"), "{missed}");
}

/// The lie of a sheet, as the notes beside a recording have it.
struct Truth {
    angle_rad: f64,
    shift_mm: Vec2,
}

/// Whether a recording is told as its notes say: within four of its own deviations, or refused where there are none.
fn is_told(case: &str, text: &str, truth: Option<&Truth>) {
    let answer = &answer_traces(text, case, CrossingSet::Strip16).unwrap()[0];
    match (&answer.pose, truth) {
        (Ok(pose), Some(truth)) => {
            let off = [
                (pose.transform.angle_rad() - truth.angle_rad) / pose.sigma_angle_rad,
                (pose.transform.shift().x - truth.shift_mm.x) / pose.sigma_shift_mm[0],
                (pose.transform.shift().y - truth.shift_mm.y) / pose.sigma_shift_mm[1],
            ];
            println!("{case}: off by {off:.2?} deviations, {} inliers", pose.inliers);
            assert!(off.iter().all(|off| off.abs() < 4.0), "{case}: {off:?}");
        }
        (Err(_), None) => {}
        (pose, _) => panic!("{case}: {pose:?}"),
    }
}

/// `UPDATE_GOLDEN=1` writes ours anew, from the simulated joint.
#[test]
fn a_recording_on_file_is_told() {
    let lie = sheet(7);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/stitch");
        std::fs::create_dir_all(&folder).unwrap();
        let trace = recorded(&lie, SensorNoise::default(), 7).0;
        std::fs::write(folder.join("simulated_along_y.json"), format!("{trace}\n")).unwrap();
    }
    let truth = Truth { angle_rad: lie.angle_rad(), shift_mm: lie.shift() };
    for file in ours("stitch") {
        is_told(&name_of(&file), &std::fs::read_to_string(&file).unwrap(), Some(&truth));
    }
    let Some(notes) = other("stitch", "truth.json") else { return };
    let notes: Value = serde_json::from_str(&std::fs::read_to_string(&notes).unwrap()).unwrap();
    for case in ["t01_ideal", "t05_dust", "t08_unusable"] {
        let text = std::fs::read_to_string(other("stitch", &format!("{case}.json")).unwrap()).unwrap();
        let number = |key: &str| notes[case][key].as_f64().unwrap();
        let truth = (case != "t08_unusable").then(|| Truth {
            angle_rad: number("theta"),
            shift_mm: Vec2 { x: number("tx"), y: number("ty") },
        });
        is_told(case, &text, truth.as_ref());
    }
}
