//! Whatever a file holds, the reader says what is wrong and goes on.

use plotter_replay::log::{self, DamageKind, Event, Header, ReadError, Reader, Record, SyntaxError};
use std::io::{self, BufReader, Read, Write};

const HEADER: &str = "plotter-log 1 {\"baud\":256000}\n";
const GOOD: &str = "10312 < 31 33 31 *87\n";

/// Damage as text, and the number of good records.
fn read(log: &[u8]) -> (Vec<String>, u64) {
    let mut reader = Reader::new(log).unwrap();
    let damage = reader.by_ref().filter_map(Result::err).map(|damage| damage.to_string()).collect();
    (damage, reader.summary().records)
}

#[test]
fn what_is_no_log_is_refused_with_the_reason() {
    let refused = |log: &[u8]| Reader::new(log).unwrap_err();
    assert_eq!(refused(b""), ReadError::Empty);
    assert_eq!(refused(b"\n"), ReadError::NotALog);
    assert_eq!(refused(b"plotter-logs 1 {}\n"), ReadError::NotALog);
    assert_eq!(refused(b"\x89PNG\r\n\x1a\n\0\0\xff"), ReadError::NotALog);
    assert_eq!(refused(&[0; 100_000]), ReadError::NotALog);
    assert_eq!(refused(b"plotter-log 2 {}\n"), ReadError::Version { found: "2".into() });
    assert_eq!(
        refused(b"plotter-log -1 {}\n").to_string(),
        "log format version \"-1\": this program reads version 1"
    );
    let long = format!("plotter-log {}\n", "9".repeat(1_000));
    assert_eq!(refused(long.as_bytes()), ReadError::Version { found: "9".repeat(16) });
}

#[test]
fn a_header_without_settings_is_damage_but_readable() {
    for header in
        ["plotter-log 1\n", "plotter-log 1 \n", "plotter-log 1 [1]\n", "plotter-log 1 {\"baud\":25\n"]
    {
        if header == "plotter-log 1\n" {
            let mut reader = Reader::new(header.as_bytes()).unwrap();
            assert!(
                matches!(reader.next(), Some(Err(damage)) if matches!(damage.kind, DamageKind::Header { .. }))
            );
            continue;
        }
        let (damage, records) = read(format!("{header}{GOOD}").as_bytes());
        assert_eq!((damage.len(), records), (1, 1), "{header}");
        assert!(
            damage[0]
                .starts_with("line 1 (byte 0): the first line is damaged: its settings are no JSON object"),
            "{damage:?}"
        );
    }
}

#[test]
fn a_flipped_bit_in_the_first_line_is_told_and_costs_no_record() {
    let mut writer = log::Writer::new(Vec::new(), &Header::new().with_number("baud", 256_000)).unwrap();
    notes(3).for_each(|note| writer.write(&note).unwrap());
    let log = writer.finish().unwrap();
    let first = log.iter().position(|&byte| byte == b'\n').unwrap();
    for at in 0..=first {
        for bit in 0..8 {
            let mut hit = log.clone();
            hit[at] ^= 1 << bit;
            let (damage, records) = read(&hit);
            assert!(!damage.is_empty(), "byte {at} bit {bit}: {}", String::from_utf8_lossy(&hit[..=first]));
            assert_eq!(records, 3, "byte {at} bit {bit}: {damage:?}");
        }
    }
    // Before a log of another version, nothing is guessed.
    assert!(matches!(Reader::new(&b"plotter-log 2 {}\n0 < 31 *00\n"[..]), Err(ReadError::Version { .. })));
}

#[test]
fn settings_of_the_wrong_type_are_as_if_they_were_not_there() {
    for settings in
        [r#"{"baud":"fast"}"#, r#"{"baud":-1}"#, r#"{"baud":1e99}"#, r#"{"baud":[1,2]}"#, "{\"baud\":null}"]
    {
        let log = format!("plotter-log 1 {settings}\n{GOOD}");
        let reader = Reader::new(log.as_bytes()).unwrap();
        assert_eq!(reader.header().baud(), None, "{settings}");
        assert_eq!(read(log.as_bytes()), (vec![], 1), "{settings}");
    }
}

/// A log that another program cuts short, and writes anew, while it is read.
#[test]
fn a_log_that_changes_while_it_is_read_is_read_to_some_end() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("session.plog");
    let write = |count| {
        let mut writer = log::create(&path, &Header::new()).unwrap();
        notes(count).for_each(|note| writer.write(&note).unwrap());
        writer.finish().unwrap();
    };
    write(10_000);
    let mut reader = log::open(&path).unwrap();
    assert_eq!(reader.by_ref().take(100).filter(Result::is_ok).count(), 100);
    let file = std::fs::OpenOptions::new().write(true).open(&path).unwrap();
    file.set_len(70_000).unwrap();
    let damage: Vec<_> = reader.by_ref().filter_map(Result::err).collect();
    assert!(damage.iter().all(|one| one.kind == DamageKind::CutEnd) && damage.len() <= 1, "{damage:?}");
    assert!(reader.summary().records > 1_000);

    let mut reader = log::open(&path).unwrap();
    assert!(reader.next().unwrap().is_ok());
    write(5); // shorter than what the reader has gone through
    assert!(reader.by_ref().count() < 10_000);
}

#[test]
fn each_damage_is_told_with_its_place() {
    let log = [
        HEADER,
        GOOD,
        "10312 < 31 33 32 *87\n",
        "nonsense\n",
        "\n",
        "10351 @ drive x 20 *04\n",
        "10350 @ edge x+ *5a\n",
        "10351 @ dri",
    ]
    .concat();
    let (damage, records) = read(log.as_bytes());
    insta::assert_snapshot!(damage.join("\n"), @r"
    line 3 (byte 51, after 10312 us): checksum *87 does not fit the line, whose bytes give *b8
    line 4 (byte 72, after 10312 us): no checksum: expected * and two hex digits at the end
    line 5 (byte 81, after 10312 us): no checksum: expected * and two hex digits at the end
    line 7 (byte 105, after 10351 us): time goes back to 10350 us after 10351 us
    line 8 (byte 125, after 10351 us): the log ends inside this line
    ");
    assert_eq!(records, 2);
}

/// Two records on one line, of which one is of another time, are no neighbours.
#[test]
fn two_records_on_a_line_that_do_not_follow_are_lost_once() {
    let second = "10350 @ edge x+ *5a";
    let log =
        format!("{HEADER}20000 @ estop 1 *{:02x}\n{}{second}\n", sum("20000 @ estop 1 "), GOOD.trim_end());
    let mut reader = Reader::new(log.as_bytes()).unwrap();
    assert_eq!(reader.by_ref().filter(Result::is_err).count(), 1);
    let summary = reader.summary();
    assert_eq!((summary.records, summary.damaged_lines), (1, 1));
    assert_eq!(summary.damaged_bytes, (GOOD.len() + second.len()) as u64);
}

/// CRC-8/SMBUS.
fn sum(text: &str) -> u8 {
    text.bytes().fold(0, |sum, byte| {
        (0..8).fold(sum ^ byte, |sum, _| if sum & 0x80 == 0 { sum << 1 } else { sum << 1 ^ 7 })
    })
}

#[test]
fn line_ends_of_either_kind_are_read() {
    let log = format!("{HEADER}{GOOD}{GOOD}").replace('\n', "\r\n");
    assert_eq!(read(log.as_bytes()), (vec![], 2));
}

#[test]
fn zeros_and_other_encodings_cost_their_line_only() {
    let mut log = format!("{HEADER}{GOOD}").into_bytes();
    log.extend([0; 50]);
    log.push(b'\n');
    log.extend(b"\xff\xfe1\x000\x00\n");
    log.extend(GOOD.bytes());
    let mut reader = Reader::new(&log[..]).unwrap();
    let kinds: Vec<_> = reader.by_ref().filter_map(Result::err).map(|damage| damage.kind).collect();
    assert_eq!(kinds, [DamageKind::Syntax(SyntaxError::NoChecksum), DamageKind::NotUtf8]);
    assert_eq!(reader.summary().records, 2);
}

/// 200 MB without a line end, then a good record; made while it is read.
struct LongLine {
    left: u64,
    tail: &'static [u8],
}

impl Read for LongLine {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            return self.tail.read(buffer);
        }
        let now = buffer.len().min(usize::try_from(self.left).unwrap());
        buffer[..now].fill(b'x');
        self.left -= now as u64;
        Ok(now)
    }
}

#[test]
fn a_line_of_200_megabytes_is_skipped_in_constant_memory() {
    let long = LongLine { left: 200_000_000, tail: b"\n10312 < 31 33 31 *87\n" };
    let source = HEADER.as_bytes().chain(long);
    let mut reader = Reader::new(BufReader::with_capacity(1 << 16, source)).unwrap();
    let damage = reader.next().unwrap().unwrap_err();
    assert_eq!((damage.kind, damage.line, damage.bytes), (DamageKind::TooLong, 2, 200_000_001));
    assert!(reader.next().unwrap().is_ok());
    assert!(reader.next().is_none());
    assert_eq!(reader.summary().to_string(), "1 record, lost 1 line (200000001 bytes)");
}

#[test]
fn a_source_that_fails_ends_the_log_with_a_word() {
    struct Broken;
    impl Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(io::Error::other("cable pulled"))
        }
    }
    let log = [HEADER, GOOD].concat();
    let mut reader = Reader::new(BufReader::new(log.as_bytes().chain(Broken))).unwrap();
    assert!(reader.next().unwrap().is_ok());
    let damage = reader.next().unwrap().unwrap_err();
    assert_eq!(
        damage.to_string(),
        "line 3 (byte 51, after 10312 us): cannot be read any further: cable pulled"
    );
    assert!(reader.next().is_none());
}

fn notes(count: u64) -> impl Iterator<Item = Record> {
    (0..count).map(|n| Record::at_us(n * 1_000, Event::Note(format!("note {n}"))))
}

#[test]
fn a_packed_log_is_read_again_and_a_cut_one_up_to_the_cut() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.plog.gz");
    let mut writer = log::create(&path, &Header::new()).unwrap();
    notes(2_000).for_each(|note| writer.write(&note).unwrap());
    writer.finish().unwrap();
    let mut reader = log::open(&path).unwrap();
    assert!(reader.by_ref().eq(notes(2_000).map(Ok)));
    assert!(reader.summary().is_clean());

    let packed = std::fs::read(&path).unwrap();
    assert!(packed.len() < 20_000, "{} bytes: packed?", packed.len());
    let cut = dir.path().join("cut.plog.gz");
    std::fs::write(&cut, &packed[..packed.len() * 3 / 4]).unwrap();
    let mut reader = log::open(&cut).unwrap();
    let damage: Vec<_> = reader.by_ref().filter_map(Result::err).collect();
    // Written through each half second, so three of the four are there.
    assert!(reader.summary().records >= 1_000, "{}", reader.summary());
    assert!(matches!(damage.last().unwrap().kind, DamageKind::Source { .. }), "{damage:?}");
}

#[test]
fn a_packed_log_that_is_not_packed_is_unreadable() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("plain.gz");
    std::fs::File::create(&path).unwrap().write_all(HEADER.as_bytes()).unwrap();
    assert!(matches!(log::open(&path), Err(ReadError::Source { .. })));
    assert!(matches!(log::open(&dir.path().join("nowhere.plog")), Err(ReadError::Source { .. })));
}
