//! A written log is read again unchanged, and a cut costs one line.

use crate::law_cases::cases;
use plotter_motion::{Axis, Direction, Pen};
use plotter_replay::log::{DamageKind, Event, Header, ReadError, Reader, Record, SwitchName, Writer};
use proptest::prelude::*;

fn axis() -> impl Strategy<Value = Axis> {
    prop_oneof![Just(Axis::X), Just(Axis::Y)]
}

fn event() -> impl Strategy<Value = Event> {
    let bytes = || prop::collection::vec(any::<u8>(), 1..80);
    let sign = prop_oneof![Just(Direction::Plus), Just(Direction::Minus)];
    prop_oneof![
        bytes().prop_map(Event::Host),
        bytes().prop_map(Event::Controller),
        (axis(), sign).prop_map(|(axis, sign)| Event::Edge { axis, sign }),
        (axis(), any::<i32>()).prop_map(|(axis, duty)| Event::Drive { axis, duty }),
        ("[!-~]{1,32}", any::<bool>())
            .prop_map(|(name, pressed)| { Event::Switch { name: SwitchName::new(&name).unwrap(), pressed } }),
        any::<bool>().prop_map(Event::Estop),
        prop_oneof![Just(Event::Pen(Pen::Up)), Just(Event::Pen(Pen::Down))],
        (any::<i32>(), any::<i32>()).prop_map(|(x, y)| Event::Target { x, y }),
        any::<String>().prop_map(Event::Note),
        "[ *\\\\\r\n]{0,5}".prop_map(Event::Note),
    ]
}

fn records() -> impl Strategy<Value = Vec<Record>> {
    prop::collection::vec((any::<u32>(), event()), 0..20).prop_map(|steps| {
        let mut time_us = 0;
        steps
            .into_iter()
            .map(|(step, event)| {
                time_us += u64::from(step);
                Record::at_us(time_us, event)
            })
            .collect()
    })
}

fn write(header: &Header, records: &[Record]) -> Vec<u8> {
    let mut writer = Writer::new(Vec::new(), header).unwrap();
    records.iter().for_each(|record| writer.write(record).unwrap());
    writer.finish().unwrap()
}

fn good(log: &[u8]) -> Vec<Record> {
    Reader::new(log).unwrap().filter_map(Result::ok).collect()
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn what_was_written_is_read(records in records(), name in any::<String>(), number in any::<f64>()) {
        let header = Header::new().with_text(&name, &name).with_decimal("number", number);
        let log = write(&header, &records);
        let mut reader = Reader::new(&log[..]).unwrap();
        prop_assert_eq!(reader.header(), &header);
        let read: Vec<_> = reader.by_ref().collect();
        prop_assert_eq!(read, records.into_iter().map(Ok).collect::<Vec<_>>());
        prop_assert!(reader.summary().is_clean());
    }

    #[test]
    fn a_log_cut_anywhere_gives_all_complete_records(records in records()) {
        let log = write(&Header::new().with_number("baud", 256_000), &records);
        let header_end = log.iter().position(|&b| b == b'\n').unwrap();
        for cut in 0..log.len() {
            let part = &log[..cut];
            match Reader::new(part) {
                Err(error) => {
                    prop_assert!(cut < header_end);
                    let kinds = matches!(error, ReadError::Empty | ReadError::NotALog | ReadError::Version { .. });
                    prop_assert!(kinds);
                }
                Ok(mut reader) => {
                    // A record is complete when only its line end is missing.
                    let ends = log.iter().enumerate().filter(|&(at, &b)| b == b'\n' && at <= cut).count();
                    let complete = ends.saturating_sub(1);
                    let mut read = Vec::new();
                    let mut damage = Vec::new();
                    for item in reader.by_ref() {
                        match item {
                            Ok(record) => read.push(record),
                            Err(one) => damage.push(one),
                        }
                    }
                    prop_assert_eq!(&read[..], &records[..complete]);
                    prop_assert!(damage.len() <= 1);
                    let kinds = |kind: &DamageKind| matches!(kind, DamageKind::CutEnd | DamageKind::Header { .. });
                    prop_assert!(damage.iter().all(|one| kinds(&one.kind)));
                }
            }
        }
    }

    #[test]
    fn a_changed_byte_costs_at_most_the_record_it_hits_and_is_told(
        records in records(),
        at in any::<prop::sample::Index>(),
        to in any::<u8>(),
    ) {
        let log = write(&Header::new(), &records);
        let at = at.index(log.len());
        let mut hit = log.clone();
        hit[at] = to;
        let before = log[..at].iter().filter(|&&byte| byte == b'\n').count();
        match Reader::new(&hit[..]) {
            // A log of nothing but its first line.
            Err(_) => prop_assert!(before == 0 && records.len() <= 1),
            Ok(mut reader) => {
                let read: Vec<Record> = reader.by_ref().filter_map(Result::ok).collect();
                prop_assert!(to == log[at] || !reader.summary().is_clean(), "{} is now {to}", log[at]);
                let mut left = records.clone();
                if before > 0 {
                    left.remove(before - 1);
                }
                // What was read is all, or all but the record that was hit.
                let is_record = read == records || read == left;
                prop_assert!(is_record, "{read:?}");
            }
        }
    }

    #[test]
    fn no_garbage_stops_the_reader(garbage in prop::collection::vec(any::<u8>(), 0..400)) {
        let mut log = b"plotter-log 1 {}\n".to_vec();
        log.extend(&garbage);
        log.extend(b"\n10312 < 31 33 31 *87\n");
        prop_assert_eq!(good(&log).len(), 1);
    }
}

#[test]
fn a_carriage_return_in_the_place_of_the_first_line_end_is_told() {
    let log = write(&Header::new(), &[]);
    let mut hit = log.clone();
    *hit.last_mut().unwrap() = b'\r';
    let mut reader = Reader::new(&hit[..]).unwrap();
    let damage = reader.next().unwrap().unwrap_err();
    assert_eq!((damage.kind, damage.byte_offset), (DamageKind::LineEnd, log.len() as u64 - 1));
    assert_eq!(reader.next(), None);
    assert_eq!(reader.summary().damaged_bytes, 1);
    // Cut in front of it nothing is lost.
    assert!(Reader::new(&log[..log.len() - 1]).unwrap().summary().is_clean());
}
