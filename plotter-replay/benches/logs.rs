//! Reading and writing of logs, in events a second, beside JSON lines read and written with `serde_json`.
//!
//! ```text
//! cargo bench -p plotter-replay --bench logs
//! ```
//!
//! On Linux it is the time on the processor that is measured, so that other programs beside it count little.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    missing_docs,
    reason = "a benchmark that fails says so by a panic"
)]

use criterion::measurement::{Measurement, ValueFormatter, WallTime};
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use plotter_motion::Point;
use plotter_motion::protocol::digits::Reply;
use plotter_replay::log::{EventRef, Header, Reader, RecordRef, Writer};
use plotter_replay::{PlotterSettings, VirtualPlotter};
use serde_json::Value;
use std::hint::black_box;
use std::io::Write as _;
use std::time::Duration;

/// Events of each log: 5 MB to 27 MB of text.
const EVENTS: u64 = 1_000_000;

/// The `n`th byte of a session: pulses in both directions, and a `+` now and then.
fn byte(n: u64) -> u8 {
    if n.is_multiple_of(997) { b'+' } else { [b'1', b'3', b'1', b'2'][usize::try_from(n % 4).unwrap()] }
}

/// The session written with so many bytes a record.
fn write(group: usize, out: Vec<u8>) -> Vec<u8> {
    let mut writer = Writer::new(out, &Header::new().with_number("baud", 256_000)).unwrap();
    let mut bytes = Vec::with_capacity(group);
    for n in 0..EVENTS {
        bytes.push(byte(n));
        if bytes.len() == group || n + 1 == EVENTS {
            let time = Duration::from_micros(n * 39);
            writer.write_ref(&RecordRef { time, event: EventRef::Controller(&bytes) }).unwrap();
            bytes.clear();
        }
    }
    writer.finish().unwrap()
}

/// Reads a session and decodes it into a position: the sum of all that it says.
fn read(log: &[u8]) -> (i32, i32, u64) {
    let mut reader = Reader::new(log).unwrap();
    let (mut x, mut y, mut reached) = (0_i32, 0_i32, 0_u64);
    while let Some(record) = reader.next_ref() {
        let EventRef::Controller(bytes) = record.unwrap().event else { panic!("not written") };
        for &byte in bytes {
            count(byte, &mut x, &mut y, &mut reached);
        }
    }
    (x, y, reached)
}

fn count(byte: u8, x: &mut i32, y: &mut i32, reached: &mut u64) {
    match Reply::from_byte(byte) {
        Some(Reply::Pulse(plotter_motion::Axis::X, sign)) => *x += sign.sign(),
        Some(Reply::Pulse(plotter_motion::Axis::Y, sign)) => *y += sign.sign(),
        Some(Reply::Reached) => *reached += 1,
        _ => {}
    }
}

/// The same as JSON lines, one a byte: `{"t_us":39,"from":"D","byte":49}`.
fn write_jsonl(mut out: Vec<u8>) -> Vec<u8> {
    for n in 0..EVENTS {
        let line = serde_json::json!({ "t_us": n * 39, "from": "D", "byte": byte(n) });
        serde_json::to_writer(&mut out, &line).unwrap();
        out.write_all(b"\n").unwrap();
    }
    out
}

fn read_jsonl(text: &[u8]) -> (i32, i32, u64) {
    let (mut x, mut y, mut reached) = (0_i32, 0_i32, 0_u64);
    let mut last = 0;
    for line in text.split(|&byte| byte == b'\n').filter(|line| !line.is_empty()) {
        let value: Value = serde_json::from_slice(line).unwrap();
        let time = value["t_us"].as_u64().unwrap();
        assert!(time >= last && value["from"] == "D");
        last = time;
        count(u8::try_from(value["byte"].as_u64().unwrap()).unwrap(), &mut x, &mut y, &mut reached);
    }
    (x, y, reached)
}

/// The same into a struct, as a careful user does.
#[derive(serde::Deserialize, serde::Serialize)]
struct Line<'a> {
    t_us: u64,
    from: &'a str,
    byte: u8,
}

fn read_jsonl_struct(text: &[u8]) -> (i32, i32, u64) {
    let (mut x, mut y, mut reached) = (0_i32, 0_i32, 0_u64);
    let mut last = 0;
    for line in text.split(|&byte| byte == b'\n').filter(|line| !line.is_empty()) {
        let line: Line<'_> = serde_json::from_slice(line).unwrap();
        assert!(line.t_us >= last && line.from == "D");
        last = line.t_us;
        count(line.byte, &mut x, &mut y, &mut reached);
    }
    (x, y, reached)
}

fn write_jsonl_struct(mut out: Vec<u8>) -> Vec<u8> {
    for n in 0..EVENTS {
        serde_json::to_writer(&mut out, &Line { t_us: n * 39, from: "D", byte: byte(n) }).unwrap();
        out.push(b'\n');
    }
    out
}

/// A session of Grbl in records of 64 bytes: lines of a drawing, an `ok` for each, a report now and then.
fn write_lines() -> (Vec<u8>, u64) {
    let header = Header::new().with_number("baud", 115_200).with_text("protocol", "grbl");
    let mut writer = Writer::new(Vec::new(), &header).unwrap();
    let (mut text, mut answers, mut events, mut time) = (Vec::new(), Vec::new(), 0, Duration::ZERO);
    let mut line = 0_u32;
    while events < EVENTS {
        // A spiral of chords of a millimetre or so, as drawings are.
        let (angle, radius) = (f64::from(line % 4_000) * 0.05, f64::from(line % 4_000) * 0.02);
        let (x, y) = (100.0 + radius * angle.cos(), 100.0 + radius * angle.sin());
        writeln!(text, "G1 X{x:.3} Y{y:.3}").unwrap();
        answers.extend_from_slice(b"ok\r\n");
        if line.is_multiple_of(200) {
            answers.extend_from_slice(b"[MSG:of no place]\r\n");
        }
        line += 1;
        while text.len() >= 64 {
            time += Duration::from_micros(5_556);
            events += 64;
            let event = EventRef::Host(&text[..64]);
            writer.write_ref(&RecordRef { time, event }).unwrap();
            text.drain(..64);
        }
        if answers.len() >= 16 {
            events += answers.len() as u64;
            writer.write_ref(&RecordRef { time, event: EventRef::Controller(&answers) }).unwrap();
            answers.clear();
        }
    }
    (writer.finish().unwrap(), events)
}

/// Reads and draws it: lines, answers, and the way that they make. How many moves, and where it ends.
fn read_lines(log: &[u8]) -> (u64, Point) {
    let mut reader = Reader::new(log).unwrap();
    let mut plotter = VirtualPlotter::new(PlotterSettings::from_header(reader.header()).unwrap());
    for record in reader.by_ref() {
        plotter.push(&record.unwrap());
        if plotter.legs().len() >= 1_000 {
            black_box(plotter.take_noted());
        }
    }
    plotter.finish();
    assert_eq!(plotter.line_counts().unwrap().refused, 0);
    (plotter.target_count(), plotter.position())
}

/// Time of this thread on the processor; where the system does not tell it, time on the clock.
struct ProcessorTime(WallTime);

fn on_processor_ns() -> Option<u64> {
    std::fs::read_to_string("/proc/thread-self/schedstat").ok()?.split(' ').next()?.parse().ok()
}

impl Measurement for ProcessorTime {
    type Intermediate = (Option<u64>, std::time::Instant);
    type Value = Duration;

    fn start(&self) -> Self::Intermediate {
        // What has run is counted when a thread lets go of the processor.
        std::thread::yield_now();
        (on_processor_ns(), self.0.start())
    }
    fn end(&self, (began, clock): Self::Intermediate) -> Duration {
        std::thread::yield_now();
        match began.zip(on_processor_ns()) {
            Some((began, now)) => Duration::from_nanos(now - began),
            None => self.0.end(clock),
        }
    }
    fn add(&self, one: &Duration, other: &Duration) -> Duration {
        *one + *other
    }
    fn zero(&self) -> Duration {
        Duration::ZERO
    }
    fn to_f64(&self, value: &Duration) -> f64 {
        self.0.to_f64(value)
    }
    fn formatter(&self) -> &dyn ValueFormatter {
        self.0.formatter()
    }
}

fn group<'a>(criterion: &'a mut Criterion<ProcessorTime>, name: &str) -> BenchmarkGroup<'a, ProcessorTime> {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(EVENTS)).sample_size(10).measurement_time(Duration::from_secs(3));
    group
}

fn logs(criterion: &mut Criterion<ProcessorTime>) {
    let (single, grouped, jsonl) = (write(1, Vec::new()), write(64, Vec::new()), write_jsonl(Vec::new()));
    assert_eq!(read(&single), read(&grouped));
    assert_eq!(read(&single), read_jsonl(&jsonl));
    assert_eq!(read(&single), read_jsonl_struct(&jsonl));
    println!(
        "bytes an event: {:.1} one by one, {:.1} in groups of 64, {:.1} as JSON lines",
        single.len() as f64 / EVENTS as f64,
        grouped.len() as f64 / EVENTS as f64,
        jsonl.len() as f64 / EVENTS as f64
    );
    let mut reading = group(criterion, "read");
    reading.bench_function("one byte a record", |bencher| bencher.iter(|| read(black_box(&single))));
    reading.bench_function("64 bytes a record", |bencher| bencher.iter(|| read(black_box(&grouped))));
    reading.bench_function("JSON lines", |bencher| bencher.iter(|| read_jsonl(black_box(&jsonl))));
    reading.bench_function("JSON lines into a struct", |bencher| {
        bencher.iter(|| read_jsonl_struct(black_box(&jsonl)))
    });
    let (lines, events) = write_lines();
    println!("a session of Grbl: {events} bytes of both sides, {:?}", read_lines(&lines));
    reading.throughput(Throughput::Elements(events));
    reading.bench_function("Grbl's lines, 64 bytes a record, drawn", |bencher| {
        bencher.iter(|| read_lines(black_box(&lines)))
    });
    reading.finish();
    let mut writing = group(criterion, "write");
    let room = || Vec::with_capacity(jsonl.len());
    writing.bench_function("one byte a record", |bencher| bencher.iter(|| write(1, room())));
    writing.bench_function("64 bytes a record", |bencher| bencher.iter(|| write(64, room())));
    writing.bench_function("JSON lines", |bencher| bencher.iter(|| write_jsonl(room())));
    writing.bench_function("JSON lines from a struct", |bencher| bencher.iter(|| write_jsonl_struct(room())));
    writing.finish();
}

criterion_group!(
    name = benches;
    config = Criterion::default().with_measurement(ProcessorTime(WallTime));
    targets = logs
);
criterion_main!(benches);
