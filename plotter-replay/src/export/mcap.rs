//! Logs as MCAP, with schemas, so that Foxglove shows positions as plots and bytes as a table.
//!
//! A message a byte would take 24 to 48 bytes and show nothing: all that came within a batch is one message.

use super::table::hex;
use crate::log::{Event, Header, Record};
use crate::{PlotterSettings, VirtualPlotter, compare::Decoder};
use ::mcap::records::MessageHeader;
use ::mcap::{WriteOptions, Writer};
use core::fmt;
use core::time::Duration;
use plotter_motion::Pen;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{Seek, Write};

/// How a log becomes MCAP.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct McapSettings {
    /// Window of time whose records become one message per topic.
    pub batch: Duration,
    /// Time of the log's beginning, ns since 1970: Foxglove shows times of day.
    pub began_ns: u64,
}

impl McapSettings {
    /// The same with another [`McapSettings::batch`].
    #[must_use]
    pub const fn with_batch(self, batch: Duration) -> Self {
        Self { batch, ..self }
    }

    /// The same with another [`McapSettings::began_ns`].
    #[must_use]
    pub const fn with_began_ns(self, began_ns: u64) -> Self {
        Self { began_ns, ..self }
    }
}

impl Default for McapSettings {
    /// 100 messages a second at most, from 1970.
    fn default() -> Self {
        Self { batch: Duration::from_millis(10), began_ns: 0 }
    }
}

/// Why a log cannot become MCAP.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct McapError {
    /// The error message.
    pub message: String,
}

impl fmt::Display for McapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl core::error::Error for McapError {}

fn error(error: impl fmt::Display) -> McapError {
    McapError { message: error.to_string() }
}

fn schema(title: &str, properties: Value) -> Vec<u8> {
    json!({ "title": title, "type": "object", "properties": properties }).to_string().into_bytes()
}

/// Writes records as MCAP with four topics: `/plotter/position` (mm, counts, pen, next target),
/// `/plotter/bytes` (direction, hex, words), `/plotter/drive` (duty cycles) and `/plotter/events` (switches,
/// emergency stop, notes).
///
/// # Errors
///
/// [`McapError`] if `out` cannot be written, or the header's scale makes no sense.
pub fn mcap<W: Write + Seek>(
    header: &Header,
    records: impl IntoIterator<Item = Record>,
    settings: McapSettings,
    out: W,
) -> Result<(), McapError> {
    let number = || json!({ "type": "number" });
    let integer = || json!({ "type": "integer" });
    let text = || json!({ "type": "string" });
    let mut writer = WriteOptions::new()
        .compression(None)
        .profile("plotter")
        .library(concat!("plotter-replay ", env!("CARGO_PKG_VERSION")))
        .create(out)
        .map_err(error)?;
    let mut topic = |name: &str, properties: Value| -> Result<u16, McapError> {
        let title = format!("plotter.{name}");
        let id = writer.add_schema(&title, "jsonschema", &schema(&title, properties)).map_err(error)?;
        writer.add_channel(id, &format!("/plotter/{name}"), "json", &BTreeMap::new()).map_err(error)
    };
    let position = topic(
        "position",
        json!({
            "x_mm": number(), "y_mm": number(), "x_counts": integer(), "y_counts": integer(),
            "next_x_mm": number(), "next_y_mm": number(), "pen_down": { "type": "boolean" },
            "targets_sent": integer(), "targets_reached": integer(),
        }),
    )?;
    let bytes =
        topic("bytes", json!({ "from": text(), "count": integer(), "hex": text(), "words": text() }))?;
    let drive = topic("drive", json!({ "x": integer(), "y": integer() }))?;
    let events = topic("events", json!({ "kind": text(), "value": text() }))?;
    let plotter = PlotterSettings::from_header(header).map_err(error)?;
    // What was drawn is not needed, only where the pen is.
    let plotter = PlotterSettings { max_points: 0, max_entries: 0, ..plotter };
    let mut batches = Batches {
        writer,
        settings,
        plotter: VirtualPlotter::new(plotter),
        decoder: Decoder::new(header),
        ids: [position, bytes, drive, events],
        sequence: 0,
        began: None,
        last: Duration::ZERO,
        open: Open::default(),
        duties: [0; 2],
    };
    for record in records {
        batches.take(&record)?;
    }
    batches.close()?;
    batches.writer.finish().map_err(error).map(drop)
}

/// What came since the batch began.
#[derive(Default)]
struct Open {
    host: (Vec<u8>, String),
    controller: (Vec<u8>, String),
    has_moved: bool,
    has_driven: bool,
}

struct Batches<W: Write + Seek> {
    writer: Writer<W>,
    settings: McapSettings,
    plotter: VirtualPlotter,
    decoder: Decoder,
    ids: [u16; 4],
    sequence: u32,
    began: Option<Duration>,
    last: Duration,
    open: Open,
    duties: [i32; 2],
}

/// Words of a batch that are kept.
const MOST_WORDS: usize = 2_000;

impl<W: Write + Seek> Batches<W> {
    fn take(&mut self, record: &Record) -> Result<(), McapError> {
        let began = *self.began.get_or_insert(record.time);
        if record.time.saturating_sub(began) >= self.settings.batch {
            self.close()?;
            self.began = Some(record.time);
        }
        self.last = record.time;
        self.plotter.push(record);
        let words = self.decoder.words(record);
        match &record.event {
            Event::Host(bytes) | Event::Controller(bytes) => {
                let is_host = matches!(record.event, Event::Host(_));
                let (all, said) = if is_host { &mut self.open.host } else { &mut self.open.controller };
                all.extend_from_slice(bytes);
                if said.len() < MOST_WORDS {
                    if !said.is_empty() {
                        said.push_str("; ");
                    }
                    said.push_str(&words);
                }
                self.open.has_moved = true;
            }
            Event::Pen(_) | Event::Target { .. } => self.open.has_moved = true,
            Event::Drive { axis, duty } => {
                if let Some(place) = self.duties.get_mut(usize::from(*axis == plotter_motion::Axis::Y)) {
                    *place = *duty;
                }
                self.open.has_driven = true;
            }
            Event::Switch { name, pressed } => {
                self.event("switch", &format!("{} {}", name.as_str(), u8::from(*pressed)))?;
            }
            Event::Estop(pressed) => self.event("estop", if *pressed { "pressed" } else { "free" })?,
            Event::Note(text) => self.event("note", text)?,
            Event::Edge { .. } => {}
        }
        Ok(())
    }

    fn event(&mut self, kind: &str, value: &str) -> Result<(), McapError> {
        let [.., events] = self.ids;
        self.write(events, &json!({ "kind": kind, "value": value }))
    }

    /// Writes what came since the batch began, with the time of the last of it.
    fn close(&mut self) -> Result<(), McapError> {
        let open = core::mem::take(&mut self.open);
        let [position, bytes, drive, _] = self.ids;
        for (from, (all, words)) in [("host", &open.host), ("controller", &open.controller)] {
            if !all.is_empty() {
                let message = json!({ "from": from, "count": all.len(), "hex": hex(all), "words": words });
                self.write(bytes, &message)?;
            }
        }
        if open.has_moved {
            let (at, counted) = (self.plotter.position(), self.plotter.raw_counts());
            let next = self.plotter.next_target().unwrap_or(at);
            let message = json!({
                "x_mm": at.x, "y_mm": at.y, "x_counts": counted.x, "y_counts": counted.y,
                "next_x_mm": next.x, "next_y_mm": next.y, "pen_down": self.plotter.pen() == Pen::Down,
                "targets_sent": self.plotter.target_count(), "targets_reached": self.plotter.reached_count(),
            });
            self.write(position, &message)?;
        }
        if open.has_driven {
            let [x, y] = self.duties;
            self.write(drive, &json!({ "x": x, "y": y }))?;
        }
        Ok(())
    }

    fn write(&mut self, channel_id: u16, message: &Value) -> Result<(), McapError> {
        let since_ns = u64::try_from(self.last.as_nanos()).unwrap_or(u64::MAX);
        let log_time = self.settings.began_ns.saturating_add(since_ns);
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time, publish_time: log_time };
        self.sequence = self.sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, message.to_string().as_bytes()).map_err(error)
    }
}
