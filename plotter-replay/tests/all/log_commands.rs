//! `import`, `export`, `compare`, `replay` and `info` as a user runs them.
#![cfg(feature = "cli")]

use plotter_replay::log::{self, Event, Header, Record, Writer};
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

struct Ran {
    status: i32,
    out: String,
    err: String,
}

fn run(arguments: &[&str], directory: &Path) -> Ran {
    run_with(arguments, directory, "")
}

fn run_with(arguments: &[&str], directory: &Path, keys: &str) -> Ran {
    let mut child = Command::new(env!("CARGO_BIN_EXE_plotter-replay"))
        .args(arguments)
        .current_dir(directory)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // It may have ended before it reads.
    let _ = child.stdin.take().unwrap().write_all(keys.as_bytes());
    let output = child.wait_with_output().unwrap();
    Ran {
        status: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

fn write(path: &Path, records: &[Record]) {
    let header = Header::new().with_number("baud", 256_000);
    let mut writer = log::create(path, &header).unwrap();
    records.iter().for_each(|record| writer.write(record).unwrap());
    writer.finish().unwrap();
}

fn host(time_us: u64, bytes: &[u8]) -> Record {
    Record::at_us(time_us, Event::Host(bytes.to_vec()))
}

fn said(time_us: u64, bytes: &[u8]) -> Record {
    Record::at_us(time_us, Event::Controller(bytes.to_vec()))
}

/// To (3, 1) and back: two seconds of silence between.
fn session() -> Vec<Record> {
    vec![
        host(0, &[3, 0, 0, 0, 0]),
        host(400, &[1, 0, 0, 0, 0]),
        said(1_000, b"11"),
        said(2_000, b"31+"),
        host(2_100_000, &[0; 10]),
        said(2_101_000, b"2242+"),
    ]
}

#[test]
fn a_recording_of_another_tool_is_found_out_imported_and_read() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let socat = "> 2026/01/15 10:00:18.000938437  length=10 from=0 to=9\n 03 00 00 00 00 01 00 00 00 00   ..........\n--\n\
        < 2026/01/15 10:00:18.000940000  length=5 from=0 to=4\n 31 31 33 31 2b   1131+\n--\n";
    std::fs::write(here.join("capture.txt"), socat).unwrap();
    let ran = run(&["import", "capture.txt", "-o", "session.plog"], here);
    assert_eq!(ran.status, 0, "{}{}", ran.out, ran.err);
    assert!(ran.out.contains("socat: 10 bytes of the host, 5 of the controller"), "{}", ran.out);
    let info = run(&["info", "session.plog"], here);
    assert_eq!(info.status, 0);
    assert!(
        info.out.contains("targets: 1 sent, 1 reached") && info.out.contains("anomalies: 0"),
        "{}",
        info.out
    );
    // Not over what is there, and not twice.
    let again = run(&["import", "capture.txt", "-o", "session.plog"], here);
    assert_eq!((again.status, again.err.lines().count()), (2, 1));
    assert!(again.err.contains("--force"), "{}", again.err);
    assert_eq!(run(&["import", "capture.txt", "-o", "session.plog", "--force"], here).status, 0);
    let log = run(&["import", "session.plog", "-o", "x.plog"], here);
    assert!(log.status == 2 && log.err.contains("session.plog: is a log already"), "{}", log.err);

    std::fs::write(here.join("cut.txt"), &socat[..socat.len() - 32]).unwrap();
    let cut = run(&["import", "cut.txt", "-o", "cut.plog"], here);
    assert_eq!(cut.status, 1, "{}{}", cut.out, cut.err);
    assert!(cut.out.contains("not read as it stands: 1\n  cut.txt line"), "{}", cut.out);

    std::fs::write(here.join("tx"), [3_u8, 0, 0, 0, 0, 1, 0, 0, 0, 0]).unwrap();
    std::fs::write(here.join("rx"), b"1131+").unwrap();
    let unknown = run(&["import", "rx", "-o", "raw.plog"], here);
    assert!(unknown.status == 2 && unknown.err.contains("say --from (socat,"), "{}", unknown.err);
    let raw = run(&["import", "--from", "raw", "--host", "tx", "--controller", "rx", "-o", "raw.plog"], here);
    assert_eq!(raw.status, 0, "{}{}", raw.out, raw.err);
    let nothing = run(&["import", "nowhere.txt", "-o", "raw2.plog"], here);
    assert!(nothing.status == 2 && nothing.err.starts_with("plotter-replay: nowhere.txt: cannot be read"));
}

#[test]
fn a_log_is_exported_as_table_and_text() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    write(&here.join("session.plog"), &session());
    let csv = run(&["export", "session.plog", "--to", "csv"], here);
    assert_eq!(csv.status, 0, "{}", csv.err);
    insta::assert_snapshot!(csv.out, @r#"
    time_us,from,kind,value,words
    0,host,bytes,0300000000,digits 3 0 0 0 0
    400,host,bytes,0100000000,"digits 1 0 0 0 0, target 3 1"
    1000,controller,bytes,3131,pulse x+ x+
    2000,controller,bytes,33312b,"pulse y+ x+, reached"
    2100000,host,bytes,00000000000000000000,"digits 0 0 0 0 0 0 0 0 0 0, target 0 0"
    2101000,controller,bytes,323234322b,"pulse x- x- y- x-, reached"
    "#);
    let text = run(&["export", "session.plog", "--to", "text", "-o", "session.txt"], here);
    assert_eq!(text.status, 0, "{}", text.err);
    let text = std::fs::read_to_string(here.join("session.txt")).unwrap();
    assert!(text.contains("2000 < 33 31 2b    pulse y+ x+, reached\n"), "{text}");
    let full = run(&["export", "session.plog", "--to", "csv", "-o", "/dev/full", "--force"], here);
    assert_eq!((full.status, full.err.lines().count()), (2, 1), "{}", full.err);
}

#[test]
#[cfg(feature = "mcap")]
fn mcap_holds_positions_and_bytes_with_their_schemas() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    write(&here.join("session.plog"), &session());
    let ran = run(&["export", "session.plog", "--to", "mcap", "-o", "session.mcap"], here);
    assert_eq!(ran.status, 0, "{}{}", ran.out, ran.err);
    let file = std::fs::read(here.join("session.mcap")).unwrap();
    let messages: Vec<_> = mcap::MessageStream::new(&file).unwrap().map(Result::unwrap).collect();
    let of = |topic: &str| -> Vec<serde_json::Value> {
        let messages = messages.iter().filter(|message| message.channel.topic == topic);
        messages.map(|message| serde_json::from_slice(&message.data).unwrap()).collect()
    };
    // Two batches: what came within 10 ms is together.
    let positions = of("/plotter/position");
    assert_eq!(positions.len(), 2);
    assert_eq!(positions[0]["x_counts"], 3);
    assert!((positions[0]["x_mm"].as_f64().unwrap() - 0.075).abs() < 1e-12);
    assert_eq!(positions[1]["targets_reached"], 2);
    let bytes = of("/plotter/bytes");
    assert_eq!(bytes.len(), 4);
    assert_eq!((&bytes[1]["from"], &bytes[1]["hex"]), (&"controller".into(), &"313133312b".into()));
    let schema = messages[0].channel.schema.as_ref().unwrap();
    assert_eq!(schema.encoding, "jsonschema");
    serde_json::from_slice::<serde_json::Value>(&schema.data).unwrap();
}

#[test]
fn logs_are_compared_to_the_byte() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    write(&here.join("a.plog"), &session());
    // The same bytes in other groups.
    let mut other = session();
    other.splice(2..4, [said(1_000, b"1"), said(1_000, b"1"), said(2_000, b"3"), said(2_000, b"1+")]);
    write(&here.join("b.plog"), &other);
    let same = run(&["compare", "a.plog", "b.plog"], here);
    assert_eq!(same.status, 0, "{}{}", same.out, same.err);
    assert!(same.out.contains("equal\n  host bytes: 20 equal\n  controller bytes: 10 equal"), "{}", same.out);
    // A pulse lost, another late.
    other.remove(3);
    other[2] = said(1_040, b"1");
    write(&here.join("c.plog"), &other);
    let ran = run(&["compare", "a.plog", "c.plog"], here);
    assert_eq!(ran.status, 1, "{}{}", ran.out, ran.err);
    insta::assert_snapshot!(ran.out, @r"
    a.plog
    6 records, nothing lost
    c.plog
    7 records, nothing lost
    first difference at 1000 us: controller bytes, index 0
      first:  byte 0x31 '1' at 1000 us
      second: byte 0x31 '1' at 1040 us
    round it in the first:
             0  0 > 03 00 00 00 00    digits 3 0 0 0 0
             1  400 > 01 00 00 00 00    digits 1 0 0 0 0, target 3 1
      >      2  1000 < 31 31    pulse x+ x+
             3  2000 < 33 31 2b    pulse y+ x+, reached
             4  2100000 > 00 00 00 00 00 00 00 00 00 00    digits 0 0 0 0 0 0 0 0 0 0, target 0 0
             5  2101000 < 32 32 34 32 2b    pulse x- x- y- x-, reached
    round it in the second:
             0  0 > 03 00 00 00 00    digits 3 0 0 0 0
             1  400 > 01 00 00 00 00    digits 1 0 0 0 0, target 3 1
      >      2  1040 < 31    pulse x+
             3  2000 < 33    pulse y+
             4  2000 < 31 2b    pulse x+, reached
             5  2100000 > 00 00 00 00 00 00 00 00 00 00    digits 0 0 0 0 0 0 0 0 0 0, target 0 0
             6  2101000 < 32 32 34 32 2b    pulse x- x- y- x-, reached
    in all:
      host bytes: 20 equal
      controller bytes: 8 equal, 1 at another time, up to 40 us apart, different in 1 place: 1 only in the first, 0 only in the second
    ");
    let tolerant = run(&["compare", "a.plog", "c.plog", "--tolerance-us", "50", "--context", "1"], here);
    assert!(
        tolerant.out.contains("first difference at 1000 us: controller bytes, index 1"),
        "{}",
        tolerant.out
    );
    let nowhere = run(&["compare", "a.plog", "nowhere.plog"], here);
    assert_eq!((nowhere.status, nowhere.out.as_str(), nowhere.err.lines().count()), (2, "", 1));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_recording_is_played_in_part_in_steps_and_as_a_new_log() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    write(&here.join("session.plog"), &session());
    let all = run(&["replay", "session.plog", "--recorded"], here);
    assert_eq!((all.status, all.out.lines().count()), (0, 6), "{}{}", all.out, all.err);
    let part = run(&["replay", "session.plog", "--recorded", "--from", "0.001", "--to", "2.1"], here);
    assert_eq!(part.out.lines().next(), Some("1000 < 31 31    pulse x+ x+"), "{}", part.out);
    assert_eq!(part.out.lines().count(), 3, "{}", part.out);
    let steps = run_with(&["replay", "session.plog", "--recorded", "--step"], here, "\n\nq\n");
    assert_eq!(steps.out.lines().count(), 3, "{}", steps.out);

    // As fast as it was, with a pause of 2.1 s cut to 0.2 s.
    let began = std::time::Instant::now();
    let paced = run(&["replay", "session.plog", "--recorded", "--speed", "1", "--skip-gaps", "0.2"], here);
    assert_eq!((paced.status, paced.out.lines().count()), (0, 6));
    assert!(began.elapsed().as_millis() >= 200);

    // The controller says other things; twice the same.
    for name in ["one.plog", "two.plog"] {
        let ran = run(&["replay", "session.plog", "-o", name], here);
        assert_eq!((ran.status, ran.out.as_str()), (0, &*format!("wrote {name}\n")), "{}", ran.err);
    }
    let read = |name: &str| std::fs::read(here.join(name)).unwrap();
    assert_eq!(read("one.plog"), read("two.plog"));
    for (arguments, word) in [
        (&["--speed", "0"][..], "factor"),
        (&["--from", "-1"], "seconds"),
        (&["--to", "soon"], "seconds"),
        (&["--machine", "nowhere.toml"], "cannot be read"),
    ] {
        let ran = run(&[&["replay", "session.plog"], arguments].concat(), here);
        assert!(ran.status == 2 && ran.err.contains(word), "{arguments:?}: {}", ran.err);
    }
}

#[test]
fn info_tells_rates_and_gaps() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    write(&here.join("session.plog"), &session());
    let info = run(&["info", "session.plog"], here);
    for line in [
        "rate of the host: 10 bytes/s, 100 bytes/s in the fullest 0.1 s (0 % of the line)",
        "gaps above 0.5 s: 1",
        "  2.098 s from 2000 us",
    ] {
        assert!(info.out.lines().any(|l| l == line), "{line}: {}", info.out);
    }
}

#[test]
fn no_file_makes_a_command_fall_over() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let mut noise = b"plotter-log 1 {\"baud\":\"x\",\"resync_gap_ms\":[]}\n".to_vec();
    noise.extend((0..100_000_u32).map(|n| n.wrapping_mul(2_654_435_761).to_le_bytes()[2]));
    std::fs::write(here.join("noise.plog"), &noise).unwrap();
    std::fs::write(here.join("noise.txt"), &noise[60..]).unwrap();
    let late = [Record::at_us(0, Event::Estop(true)), said(u64::MAX, b"1")];
    write(&here.join("late.plog"), &late);
    for log in ["noise.plog", "late.plog"] {
        for arguments in [
            &["info", log][..],
            &["check", log],
            &["compare", log, log],
            &["replay", log],
            &["export", log, "--to", "csv"],
        ] {
            let ran = run(arguments, here);
            assert!(
                (0..=2).contains(&ran.status) && !ran.err.contains("panicked"),
                "{arguments:?}: {}",
                ran.err
            );
            assert!(ran.err.lines().count() <= 1, "{arguments:?}: {}", ran.err);
        }
    }
    for tool in ["socat", "jpnevulator", "candump", "saleae", "sigrok", "raw", "plotter-raw"] {
        let ran = run(&["import", "--from", tool, "--host", "noise.txt", "-o", "out.plog", "--force"], here);
        assert!((0..=2).contains(&ran.status) && !ran.err.contains("panicked"), "{tool}: {}", ran.err);
    }
    let drawing = run(&["render", "late.plog", "--drawing", "late.plog", "--svg", "x.svg"], here);
    assert!((0..=2).contains(&drawing.status) && !drawing.err.contains("panicked"), "{}", drawing.err);
}

/// Five million and a hundred million events, and a line of a gigabyte.
#[test]
#[ignore = "peak memory of long logs, two minutes: cargo test --release -p plotter-replay --features cli --test all log_commands:: -- --ignored"]
#[cfg(target_os = "linux")]
fn memory_does_not_grow_with_the_log() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let make = |name: &str, events: u64| {
        let file = std::io::BufWriter::new(std::fs::File::create(here.join(name)).unwrap());
        let mut writer = Writer::new(file, &Header::new()).unwrap();
        let mut time = 0;
        // Targets 500 to the right and back, in groups of 64 pulses.
        let mut done = 0;
        while done < events {
            let (target, pulse) =
                if done / 501 % 2 == 0 { ([0, 0, 5, 0, 0, 0, 0, 0, 0, 0], b'1') } else { ([0; 10], b'2') };
            writer.write(&host(time, &target)).unwrap();
            for group in [pulse; 500].chunks(64) {
                time += 2_500;
                writer.write(&said(time, group)).unwrap();
            }
            writer.write(&said(time, b"+")).unwrap();
            done += 501;
        }
        writer.finish().unwrap();
    };
    let peak_kib = |arguments: &[&str]| -> u64 {
        let program = env!("CARGO_BIN_EXE_plotter-replay");
        let script = "\"$@\" >/dev/null & pid=$!; most=0; \
            while read -r now 2>/dev/null < <(awk '/VmHWM/{print $2}' /proc/$pid/status 2>/dev/null) && [ -n \"$now\" ]; do \
            most=$now; sleep 0.02; done; wait $pid; echo $most";
        let output = Command::new("bash")
            .args([&["-c", script, "sh", program][..], arguments].concat())
            .current_dir(here)
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap().trim().parse().unwrap()
    };
    // A host of Grbl, and its machine: lines in groups of 64 bytes, each answered, a report now and then.
    let make_text = |name: &str, events: u64| {
        let file = std::io::BufWriter::new(std::fs::File::create(here.join(name)).unwrap());
        let header = Header::new().with_number("baud", 115_200).with_text("protocol", "grbl");
        let mut writer = Writer::new(file, &header).unwrap();
        let (mut time, mut done, mut lines) = (0, 0, 0_u64);
        let mut text = Vec::new();
        while done < events {
            let x = lines * 37 % 100_000;
            writeln!(text, "G1 X{}.{:03} Y{}.000", x / 1_000, x % 1_000, lines % 90).unwrap();
            lines += 1;
            if text.len() < 64 {
                continue;
            }
            for (group, answer) in text.chunks(64).zip([&b"ok\r\nok\r\nok\r\n"[..], b"ok\r\n"]) {
                time += 6_000;
                writer.write(&host(time, group)).unwrap();
                writer.write(&said(time + 500, answer)).unwrap();
                done += (group.len() + answer.len()) as u64;
            }
            text.clear();
        }
        writer.finish().unwrap();
    };
    make("short.plog", 5_000_000);
    make("long.plog", 100_000_000);
    make_text("short-text.plog", 5_000_000);
    make_text("long-text.plog", 100_000_000);
    let mut line = std::io::BufWriter::new(std::fs::File::create(here.join("line.plog")).unwrap());
    line.write_all(b"plotter-log 1 {}\n").unwrap();
    for _ in 0..1_000 {
        line.write_all(&[b'1'; 1_000_000]).unwrap();
    }
    line.flush().unwrap();
    // A log compared with itself; two that differ wait for one another.
    for (command, twice) in
        [(&["info"][..], false), (&["export", "--to", "csv"], false), (&["compare"], true)]
    {
        let [short, long, line] = ["short.plog", "long.plog", "line.plog"]
            .map(|log| peak_kib(&[command, &[log, log][..1 + usize::from(twice)]].concat()));
        println!(
            "{command:?}: {short} KiB for 5 million events, {long} for 100 million, {line} for a line of 1 GB"
        );
        assert!(short.abs_diff(long) < 2_048 && long < 32_768 && line < 32_768);
    }
    for command in [&["info"][..], &["export", "--to", "csv"], &["render", "--html", "page.html"]] {
        let [short, long] =
            ["short-text.plog", "long-text.plog"].map(|log| peak_kib(&[command, &[log]].concat()));
        println!("{command:?} of lines: {short} KiB for 5 million events, {long} for 100 million");
        // A page keeps as much of the way as it has room for.
        let is_page = command[0] == "render";
        assert!(long < 65_536 && (is_page || short.abs_diff(long) < 2_048));
    }
    let unlike = peak_kib(&["compare", "short.plog", "long.plog"]);
    println!("two logs of which one is twenty times as long: {unlike} KiB");
    assert!(unlike < 32_768);
}

/// A log of this protocol, with what was said.
fn lines_log(here: &Path, protocol: &str, said: &[(u64, bool, &str)]) {
    let header = Header::new().with_number("baud", 115_200).with_text("protocol", protocol);
    let mut writer = log::create(&here.join("lines.plog"), &header).unwrap();
    for &(time_us, is_host, text) in said {
        let bytes = text.as_bytes().to_vec();
        let event = if is_host { Event::Host(bytes) } else { Event::Controller(bytes) };
        writer.write(&Record::at_us(time_us, event)).unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn a_session_of_grbl_is_known_drawn_and_its_controller_named() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let said = [
        (0, true, "?"),
        (900, false, "<Idle|MPos:30.000,20.000,0.000|Bf:15,128|FS:0,0|WCO:0.000,0.000,0.000>\r\n"),
        (2_000_000, true, "G21\nM6 T2\nM3\nG1 X40 F600\n"),
        (2_002_000, false, "ok\r\nok\r\nok\r\nok\r\n"),
        (4_000_000, true, "?"),
        (4_000_900, false, "<Idle|MPos:40.000,20.000,0.000|Bf:15,128|FS:0,0>\r\n"),
    ];
    lines_log(here, "grbl", &said);
    let info = run(&["info", "lines.plog"], here);
    assert_eq!(info.status, 0, "{}{}", info.out, info.err);
    for words in [
        "lines: 4 sent, 4 taken by the machine, 0 refused",
        "place: told by the machine up to 4.000900 s",
        "ends at (39.998, 20.005) mm", // to the nearest step
        "anomalies: 0",
    ] {
        assert!(info.out.contains(words), "{words}: {}", info.out);
    }
    let render = run(&["render", "lines.plog", "-o", "out"], here);
    assert_eq!(render.status, 0, "{}{}", render.out, render.err);
    let svg = std::fs::read_to_string(here.join("out/plotted.svg")).unwrap();
    assert!(svg.contains("pen 2") && svg.contains("#1a7f37"), "{svg}");
    let check = run(&["check", "lines.plog"], here);
    let words = "controller: stepper-plotter (the preset for this protocol), grbl";
    assert!(check.out.contains(words), "{}", check.out);
    assert!(check.out.contains("the controller makes its own, which are not compared"), "{}", check.out);
    let text = run(&["export", "lines.plog", "--to", "text"], here);
    assert!(text.out.contains("\"G21\", \"M6 T2\", \"M3\", \"G1 X40 F600\""), "{}", text.out);
    assert!(text.out.contains("question"), "{}", text.out);
}

#[test]
fn an_unknown_protocol_is_said_and_taken_for_no_other() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    lines_log(here, "klipper", &[(0, true, "G28\n"), (900, false, "ok\n")]);
    for command in ["info", "render", "check", "replay"] {
        let ran = run(&[command, "lines.plog"], here);
        assert_eq!(ran.status, 2, "{command}: {}", ran.out);
        assert!(ran.err.contains("protocol") && !ran.out.contains("anomalies"), "{command}: {}", ran.err);
    }
    // What it holds can be read all the same.
    assert!(run(&["info", "lines.plog"], here).out.contains("2 records, nothing lost"));
    let text = run(&["export", "lines.plog", "--to", "text"], here);
    assert_eq!(text.status, 0, "{}", text.err);
    assert!(text.out.contains("\"G28\\n\""), "{}", text.out);
}

#[test]
fn a_log_of_digits_that_begins_away_from_the_origin_begins_there() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    // At (700, 400) the first target is reached at once; the next is 3 to the right.
    let records = [
        host(0, &[0, 0, 7, 0, 0, 0, 0, 4, 0, 0]),
        said(900, b"+"),
        host(2_000, &[3, 0, 7, 0, 0, 0, 0, 4, 0, 0]),
        said(9_000, b"111+"),
    ];
    write(&here.join("away.plog"), &records);
    let info = run(&["info", "away.plog"], here);
    assert_eq!(info.status, 0, "{}", info.err);
    let words = "begins at (17.500, 10.000) mm: the first target that is reached tells";
    assert!(info.out.contains(words) && info.out.contains("anomalies: 0"), "{}", info.out);
    assert!(info.out.contains("ends at (17.575, 10.000) mm, counted (703, 400)"), "{}", info.out);
    // Who knows better says so.
    let info = run(&["info", "away.plog", "--origin", "0,0"], here);
    assert!(info.out.contains("as is said") && !info.out.contains("anomalies: 0"), "{}", info.out);
    assert_eq!(run(&["info", "away.plog", "--origin", "0"], here).status, 2);
}

#[test]
fn an_import_finds_out_which_protocol_it_is_of() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let dump = |said: &[(&str, &str)]| {
        let bytes = said.iter().flat_map(|(who, text)| text.bytes().map(move |byte| (who, byte)));
        let lines = bytes.enumerate().map(|(n, (who, byte))| format!("(5.{n:06}) {who} {byte:02X}\n"));
        std::fs::write(here.join("dump.txt"), lines.collect::<String>()).unwrap();
    };
    let import =
        |more: &[&str]| run(&[&["import", "dump.txt", "-o", "s.plog", "--force"], more].concat(), here);
    dump(&[("host", "G1 X4 F600\n"), ("plotter", "ok\r\n"), ("host", "G4 P0\n"), ("plotter", "ok\r\n")]);
    let ran = import(&[]);
    assert!(ran.status == 0 && ran.out.contains("protocol: grbl, by what is said"), "{}{}", ran.out, ran.err);
    let info = run(&["info", "s.plog"], here);
    assert!(info.out.contains("lines: 2 sent, 2 taken by the machine, 0 refused"), "{}", info.out);
    dump(&[("host", "HELLO\n"), ("plotter", "who is there\n")]);
    let ran = import(&[]);
    assert!(ran.status == 0 && ran.out.contains("none that is known here"), "{}{}", ran.out, ran.err);
    for command in ["info", "render", "check"] {
        assert_eq!(run(&[command, "s.plog"], here).status, 2, "{command}");
    }
    assert!(run(&["export", "s.plog", "--to", "text"], here).out.contains("# protocol: \"unknown\""));
    let said = import(&["--protocol", "mdraw"]);
    assert!(said.status == 0 && !said.out.contains("protocol"), "{}", said.out);
}

#[test]
fn an_import_that_fails_leaves_no_log_and_the_old_one_as_it_was() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("old.plog"), "precious").unwrap();
    // Half of them could be digits of a host: nobody knows whose bytes they are.
    std::fs::write(here.join("capture.txt"), "109-189 uart-1: 02\n209-289 uart-1: 41\n").unwrap();
    let files = || {
        let mut names: Vec<_> =
            std::fs::read_dir(here).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let before = files();
    for out in ["new.plog", "old.plog"] {
        let ran = run(&["import", "capture.txt", "-o", out, "--force"], here);
        assert_eq!(ran.status, 2, "{}{}", ran.out, ran.err);
        assert_eq!(files(), before);
    }
    assert_eq!(std::fs::read_to_string(here.join("old.plog")).unwrap(), "precious");
}

#[test]
fn a_log_of_which_nobody_said_the_protocol_is_told_by_its_beginning() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let grbl = [&b"\r\nGrbl 1.1h ['$' for help]\r\n"[..], b"G1 X1 F600\n", b"ok\r\n"];
    let other = [&b"hello\r\n"[..], b"QUIT\r\n", b"goodbye\r\n"];
    for ([greeting, order, answer], told) in [(grbl, Some("lines: 1 sent, 1 taken")), (other, None)] {
        write(&here.join("s.plog"), &[said(0, greeting), host(900, order), said(2_000, answer)]);
        let ran = run(&["info", "s.plog"], here);
        match told {
            Some(told) => assert!(ran.status == 0 && ran.out.contains(told), "{}{}", ran.out, ran.err),
            // Never taken for digits.
            None => {
                assert_eq!(ran.status, 2, "{}{}", ran.out, ran.err);
                assert!(
                    ran.err.contains("protocol") && !ran.out.contains("targets"),
                    "{}{}",
                    ran.out,
                    ran.err
                );
            }
        }
    }
    write(&here.join("s.plog"), &session());
    let ran = run(&["info", "s.plog"], here);
    assert!(ran.status == 0 && ran.out.contains("targets: 2 sent, 2 reached"), "{}{}", ran.out, ran.err);
}
