//! `info`: what a log holds.

use super::beginning::{Beginning, beginning, place};
use super::commands::{Done, Verdict, read, say, say_damage, say_first};
use crate::log::{Event, Record};
use crate::virtual_plotter::{CountedBy, LineCounts};
use crate::{
    PlotterSettings, VirtualPlotter,
    compare::{ContourTally, Ways},
};
use clap::Args;
use plotter_motion::Point;
use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Debug, Args)]
pub(crate) struct Info {
    /// The log; packed if its name ends in .gz.
    log: PathBuf,
    /// Position of the pen when the log begins, mm [default: the first that the machine reports, else
    /// the origin].
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    origin: Option<Point>,
}

/// Points of the path that are kept before they are measured: a log may be longer than the memory.
const POINTS: usize = 200_000;
/// Anomalies and targets that are kept.
const ENTRIES: usize = 1_000;
/// Window over which the greatest rate is measured.
const WINDOW: Duration = Duration::from_millis(100);
/// Most gaps that are reported.
const MOST_GAPS: usize = 5;
/// Shortest silence that counts as a gap.
const GAP: Duration = Duration::from_millis(500);

/// Bytes of one direction over time.
#[derive(Debug, Default)]
struct Rate {
    bytes: u64,
    window: u64,
    in_window: u64,
    most_in_window: u64,
}

impl Rate {
    fn take(&mut self, time: Duration, bytes: u64) {
        let window = u64::try_from(time.as_micros() / WINDOW.as_micros()).unwrap_or(u64::MAX);
        if window != self.window {
            self.window = window;
            self.in_window = 0;
        }
        self.bytes = self.bytes.saturating_add(bytes);
        self.in_window = self.in_window.saturating_add(bytes);
        self.most_in_window = self.most_in_window.max(self.in_window);
    }

    fn words(&self, name: &str, seconds: f64, baud: u32) -> String {
        #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
        let (mean, most) =
            (self.bytes as f64 / seconds.max(1e-6), self.most_in_window as f64 / WINDOW.as_secs_f64());
        let share = 100.0 * most * 10.0 / f64::from(baud.max(1));
        format!(
            "{name}: {mean:.0} bytes/s, {most:.0} bytes/s in the fullest 0.1 s ({share:.0} % of the line)"
        )
    }
}

/// The longest silences of the line.
#[derive(Debug, Default)]
struct Gaps {
    last: Option<Duration>,
    count: u64,
    longest: Vec<(Duration, Duration)>,
}

impl Gaps {
    fn take(&mut self, time: Duration) {
        let silence = self.last.map_or(Duration::ZERO, |last| time.saturating_sub(last));
        if let Some(last) = self.last.replace(time).filter(|_| silence > GAP) {
            self.count = self.count.saturating_add(1);
            let at = self.longest.partition_point(|&(longer, _)| longer >= silence);
            self.longest.insert(at, (silence, last));
            self.longest.truncate(MOST_GAPS);
        }
    }
}

impl Info {
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let path = &self.log;
        let Beginning { settings, words: begins } = match beginning(path, self.origin) {
            Ok(beginning) => beginning,
            Err(error) => {
                // What it holds is told all the same, but for what it means.
                let contents = read(path, |_| {})?;
                say(out, &path.display().to_string());
                for (key, value) in contents.header.entries() {
                    say(out, &format!("  {key}: {value}"));
                }
                say_damage(out, &contents);
                return Err(error);
            }
        };
        let settings = PlotterSettings { max_points: POINTS, max_entries: ENTRIES, ..settings };
        let mut plotter = VirtualPlotter::new(settings);
        let mut contour = ContourTally::default();
        let mut points = 0_usize;
        let (mut host, mut controller) = (Rate::default(), Rate::default());
        let mut gaps = Gaps::default();
        let mut counts: [(&str, u64); 9] = [
            ("host bytes", 0),
            ("controller bytes", 0),
            ("edges", 0),
            ("duty cycles", 0),
            ("switches", 0),
            ("emergency stops", 0),
            ("pen", 0),
            ("targets taken", 0),
            ("notes", 0),
        ];
        let mut notes = Vec::new();
        let contents = read(path, |record: &Record| {
            let (place, amount) = match &record.event {
                Event::Host(bytes) => {
                    host.take(record.time, bytes.len() as u64);
                    gaps.take(record.time);
                    (0, bytes.len())
                }
                Event::Controller(bytes) => {
                    controller.take(record.time, bytes.len() as u64);
                    gaps.take(record.time);
                    points = points.saturating_add(bytes.len());
                    (1, bytes.len())
                }
                Event::Edge { .. } => {
                    points = points.saturating_add(1);
                    (2, 1)
                }
                Event::Drive { .. } => (3, 1),
                Event::Switch { .. } => (4, 1),
                Event::Estop(_) => (5, 1),
                Event::Pen(_) => (6, 1),
                Event::Target { .. } => (7, 1),
                Event::Note(text) => {
                    if notes.len() < MOST_GAPS {
                        notes.push(format!("{} us: {text}", record.time.as_micros()));
                    }
                    (8, 1)
                }
            };
            if let Some((_, count)) = counts.get_mut(place) {
                *count = count.saturating_add(amount as u64);
            }
            plotter.push(record);
            if points > POINTS / 2 || plotter.legs().len() >= ENTRIES / 2 {
                points = 0;
                contour.extend(&plotter.take_legs(), &settings, Ways::Drawn);
            }
        })?;
        plotter.finish();
        contour.extend(&plotter.take_legs(), &settings, Ways::Drawn);
        say(out, &path.display().to_string());
        for (key, value) in contents.header.entries() {
            say(out, &format!("  {key}: {value}"));
        }
        if let Some(date) = contents.header.number("began_unix_us").and_then(crate::date::of_unix_us) {
            say(out, &format!("began {date}"));
        }
        say_damage(out, &contents);
        let mut seconds = 0.0;
        if let (Some(first), Some(last)) = (contents.summary.first, contents.summary.last) {
            seconds = last.saturating_sub(first).as_secs_f64();
            say(out, &format!("duration: {seconds:.6} s, from {} us", first.as_micros()));
        }
        for (name, count) in counts.iter().filter(|&&(_, count)| count > 0) {
            say(out, &format!("{name}: {count}"));
        }
        let baud = contents.header.baud().unwrap_or(256_000);
        for (name, rate) in [("rate of the host", &host), ("rate of the controller", &controller)] {
            if rate.bytes > 0 {
                say(out, &rate.words(name, seconds, baud));
            }
        }
        say(out, &format!("gaps above {} s: {}", GAP.as_secs_f64(), gaps.count));
        for (silence, from) in &gaps.longest {
            say(out, &format!("  {:.3} s from {} us", silence.as_secs_f64(), from.as_micros()));
        }
        if let Some(words) = begins {
            say(out, &words);
        }
        if let Some(lines) = plotter.line_counts() {
            say_lines(out, &lines);
            if !contents.header.has("x_mm_per_pulse") {
                let (x, _) = plotter.resolution_per_mm();
                say(
                    out,
                    &format!("the log does not say how long a step is: taken for one of {x:.2} to the mm"),
                );
            }
        }
        say(out, &format!("targets: {} sent, {} reached", plotter.target_count(), plotter.reached_count()));
        if plotter.stop_count() > 0 {
            say(out, &format!("stopped over the line: {}", plotter.stop_count()));
        }
        let (at, counted) = (plotter.position(), plotter.raw_counts());
        say(out, &format!("ends at ({:.3}, {:.3}) mm, counted ({}, {})", at.x, at.y, counted.x, counted.y));
        let error = contour.error();
        if error.samples > 0 {
            let told =
                if plotter.is_linked() { " (where the machine told its place: every 20 ms)" } else { "" };
            say(out, &format!("contour error: rms {:.4} mm, max {:.4} mm{told}", error.rms_mm, error.max_mm));
        }
        let is_text = plotter.line_counts().is_some() || plotter.settings().counted_by == CountedBy::Ebb;
        if !is_text
            && controller.bytes > 0
            && counts.iter().any(|&(name, count)| name == "edges" && count == 0)
        {
            say(
                out,
                if plotter.is_linked() {
                    "no edges recorded: `check` cannot run the controller again on this"
                } else {
                    "no edges recorded: `check` takes them from the pulses"
                },
            );
        }
        notes.iter().for_each(|note| say(out, &format!("note at {note}")));
        say(out, &format!("anomalies: {}", plotter.anomaly_count()));
        say_first(out, plotter.anomalies(), plotter.anomaly_count());
        Ok(Verdict::of(contents.summary))
    }
}

/// Facts about a session of text lines.
fn say_lines(out: &mut impl Write, lines: &LineCounts) {
    let LineCounts { sent, accepted, refused, told_until, assumed } = *lines;
    say(out, &format!("lines: {sent} sent, {accepted} taken by the machine, {refused} refused"));
    match told_until {
        Some(until) => say(out, &format!("place: told by the machine up to {:.6} s", until.as_secs_f64())),
        None => say(out, "place: never told by the machine"),
    }
    if assumed > 0 {
        say(
            out,
            &format!(
                "the last {assumed} moves were taken, and nothing says that they were made: drawn as they were sent"
            ),
        );
    }
}
