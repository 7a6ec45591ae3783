//! Any bytes read as a log: no panic, every byte is in a record or told as damage, time never goes back, and
//! what was read is written and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_replay::log::{Reader, Record, Writer};
use plotter_replay::{CompareSettings, PlotterSettings, VirtualPlotter, export, compare::compare};

fuzz_target!(|bytes: &[u8]| {
    let Ok(mut reader) = Reader::new(bytes) else { return };
    let mut records: Vec<Record> = Vec::new();
    for item in reader.by_ref() {
        match item {
            Ok(record) => {
                assert!(records.last().is_none_or(|last| last.time <= record.time));
                records.push(record);
            }
            Err(damage) => {
                assert!(damage.byte_offset <= bytes.len() as u64 && !damage.to_string().is_empty());
            }
        }
    }
    let summary = reader.summary();
    assert_eq!(summary.records, records.len() as u64);
    assert!(summary.damaged_bytes <= bytes.len() as u64);
    let header = reader.header().clone();
    let mut writer = Writer::new(Vec::new(), &header).expect("it was read");
    for record in &records {
        writer.write(record).expect("it was read");
    }
    let written = writer.finish().expect("memory takes all");
    let again: Vec<Record> =
        Reader::new(&written[..]).expect("it was written").map(|r| r.expect("it was written")).collect();
    assert_eq!(again, records);
    if let Ok(settings) = PlotterSettings::from_header(&header) {
        let mut plotter = VirtualPlotter::new(settings);
        records.iter().for_each(|record| plotter.push(record));
        plotter.finish();
    }
    let same = compare(&header, || records.clone(), || again.clone(), CompareSettings::default());
    assert!(same.is_equal());
    export::csv(&header, records, &mut Vec::new()).expect("memory takes all");
});
