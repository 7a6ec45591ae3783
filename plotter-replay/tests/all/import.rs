//! Recordings of other tools become logs with the same bytes in the same order at the same times.

use crate::real_files::{name_of, other, ours};
use plotter_replay::import::{ImportError, ImportSettings, Imported, Side, Source, Tool, detect, import};
use plotter_replay::log::{Event, Header, Reader, Record, Writer};

struct Came {
    records: Vec<Record>,
    troubles: Vec<String>,
    imported: Imported,
}

fn source<'a>(name: &str, tool: Tool, side: Option<Side>, text: &'a [u8]) -> Source<'a> {
    Source { name: name.to_owned(), tool, side, open: Box::new(move || Ok(Box::new(text))) }
}

fn run(sources: Vec<Source<'_>>, settings: &ImportSettings) -> Result<Came, ImportError> {
    let mut log = Writer::new(Vec::new(), &Header::new()).unwrap();
    let mut troubles = Vec::new();
    let imported = import(sources, settings, &mut log, |trouble| troubles.push(trouble.to_string()))?;
    let log = log.finish().unwrap();
    let records = Reader::new(&log[..]).unwrap().map(Result::unwrap).collect();
    assert_eq!(imported.troubles, troubles.len() as u64);
    Ok(Came { records, troubles, imported })
}

fn one(tool: Tool, text: &str) -> Came {
    if tool != Tool::Raw {
        assert_eq!(detect(text.as_bytes()), Some(tool), "{text}");
    }
    run(vec![source("file", tool, None, text.as_bytes())], &ImportSettings::default()).unwrap()
}

/// A record as `100 > 02 00`.
fn shown(records: &[Record]) -> Vec<String> {
    let line = |record: &Record| {
        let (channel, bytes) = match &record.event {
            Event::Host(bytes) => ('>', bytes),
            Event::Controller(bytes) => ('<', bytes),
            event => panic!("{event:?}"),
        };
        let bytes: Vec<String> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        format!("{} {channel} {}", record.time.as_micros(), bytes.join(" "))
    };
    records.iter().map(line).collect()
}

#[test]
fn socat_with_microseconds_padded_to_nine_digits() {
    let text = "2026/11/21 00:11:01 socat[812] N starting data transfer loop\n\
        > 2026/11/21 23:59:59.000998169  length=10 from=0 to=9\n 00 02 00 00 00 00 02 00 00 00                    ..........\n--\n\
        < 2026/11/22 00:00:00.000000389  length=2 from=0 to=1\n 31 33                                            13\n--\n";
    let came = one(Tool::Socat, text);
    // It begins nine bytes of 39.0625 us before the tenth was through; midnight is a second like any other.
    assert_eq!(shown(&came.records), ["352 > 00 02 00 00 00 00 02 00 00 00", "2572 < 31 33"]);
    assert!(came.troubles.is_empty(), "{:?}", came.troubles);
}

#[test]
fn socat_with_six_digits_and_with_nanoseconds() {
    let text = |fraction: &str| {
        format!(
            "> 2020/02/29 10:00:00.500000  length=1 from=0 to=0\n 05\n--\n< 2020/02/29 10:00:00.{fraction}  length=1 from=0 to=0\n 2b   +\n--\n"
        )
    };
    assert_eq!(shown(&one(Tool::Socat, &text("500250")).records), ["0 > 05", "250 < 2b"]);
    assert_eq!(shown(&one(Tool::Socat, &text("500250499")).records), ["0 > 05", "250 < 2b"]);
}

#[test]
fn socat_whose_characters_look_like_bytes_and_lines_that_are_cut() {
    let text = "< 2026/01/15 10:00:00.000002620  length=18 from=0 to=17\n \
        31 33 20 33 31 20 32 20 31 31 20 33 33 20 31 31  13 31 2 11 33 11\n 20 31                                             1\n--\n\
        < 2026/01/15 10:00:00.000003620  length=4 from=18 to=21\n 31 33\n--\n\
        > 2026/01/15 10:00:00.000003000  length=1 from=0 to=0\n 00  .\n--\n\
        nonsense\n";
    let came = one(Tool::Socat, text);
    assert_eq!(came.imported.controller_bytes, 20);
    assert_eq!(
        came.troubles,
        [
            "file line 7: the record before has 2 of 4 bytes",
            "file line 9: its time is 620 us before that of the one before: taken as the same",
            "file line 11: expected > or <, date, time and length=: is this of `socat -x`?",
        ]
    );
}

#[test]
fn jpnevulator_with_two_ports_and_characters() {
    let text = "2006-05-30 13:23:49.461075: /dev/ttyS0\n\
        00 00 05 03 00 00 00 05 01 02                   ..........\n\
        2006-05-30 13:23:49.462113: /dev/ttyS1\n\
        31 33 31 33 31 33 31 33 31 33 31 33 31 33 31 33 1313131313131313\n31 2B                                           1+\n";
    let came = one(Tool::Jpnevulator, text);
    assert_eq!(
        shown(&came.records),
        [
            "352 > 00 00 05 03 00 00 00 05 01 02",
            "1390 < 31 33 31 33 31 33 31 33 31 33 31 33 31 33 31 33 31 2b"
        ]
    );
    let names = [("/dev/ttyS0".to_owned(), Side::Host), ("/dev/ttyS1".to_owned(), Side::Controller)];
    assert_eq!(came.imported.sides, names);
    let without =
        run(vec![source("f", Tool::Jpnevulator, None, b"00 01\n")], &ImportSettings::default()).unwrap();
    let plain = "2006-05-30 13:23:49.461075: a\n33 31 31\n";
    assert_eq!(shown(&one(Tool::Jpnevulator, plain).records), ["78 > 33 31 31"]);
    assert_eq!(without.troubles, ["f line 1: bytes without a time: was it run with --timing-print?"]);
}

#[test]
fn candump_in_its_ways_of_writing() {
    let text = "(1436509052.249713) host 02 00\n(1436509052.249813) plotter 3133\n\
        (1436509052.250713) host 044#0001\n(1436509052.251713)  plotter  RX - -  123   [2]  31 2B\n\
        (1436509052.252713) host\n(x) host 00\n";
    let came = one(Tool::Candump, text);
    assert_eq!(shown(&came.records), ["39 > 02 00", "139 < 31 33", "1039 > 00 01", "2039 < 31 2b"]);
    assert_eq!(came.troubles.len(), 2, "{:?}", came.troubles);
    let date = one(Tool::Candump, "(2026-01-15 10:00:00.000352) a 01\n(2026-01-15 10:00:01.000352) b 31\n");
    assert_eq!(shown(&date.records), ["0 > 01", "1000000 < 31"]);
}

#[test]
fn saleae_logic_1_one_file_a_direction() {
    let header = "Time [s],Value,Parity Error,Framing Error\n";
    let host = format!("{header}-0.000100000000000,'2',,\n0.000000000000000,'0',,\n");
    let controller = format!(
        "{header}0.000500000000000,1,,\n0.000600000000000,3,,Error\n0.000700000000000,+,,\n0.0008,,,,\n"
    );
    let sources = vec![
        source("capture tx.csv", Tool::Saleae, None, host.as_bytes()),
        source("capture rx.csv", Tool::Saleae, None, controller.as_bytes()),
    ];
    let came = run(sources, &ImportSettings::default()).unwrap();
    // Before the trigger, times are negative: the log begins there. A byte is through ten bits after its
    // start.
    assert_eq!(shown(&came.records), ["0 > 02", "100 > 00", "600 < 31", "700 < 33", "800 < 2b", "900 < 2c"]);
    assert_eq!(came.troubles, ["capture rx.csv line 3: the analyzer doubts this byte, 0x33: Error"]);
}

#[test]
fn saleae_values_as_decimal_numbers() {
    let host = "Time [s],Value,Parity Error,Framing Error\r\n0.001,2,,\r\n0.002,10,,\r\n";
    let came =
        run(vec![source("x", Tool::Saleae, Some(Side::Host), host.as_bytes())], &ImportSettings::default());
    assert_eq!(shown(&came.unwrap().records), ["1039 > 02", "2039 > 0a"]);
}

#[test]
fn saleae_logic_2_with_two_analyzers_in_one_file() {
    let text = "name,type,start_time,duration,\"data\",\"error\"\n\
        \"To plotter\",\"data\",0.0001,0.0000390625,0x02,\n\"From plotter\",\"data\",0.0002,0.0000390625,0x31,\n\
        \"From plotter\",\"other\",0.0002,0.0000390625,,\n\"To plotter\",\"data\",0.0003,0.00004,0x0,\"framing\"\n";
    let settings = ImportSettings::default().with_host(Some("To plotter".into()));
    let came =
        run(vec![source("x", detect(text.as_bytes()).unwrap(), None, text.as_bytes())], &settings).unwrap();
    assert_eq!(shown(&came.records), ["139 > 02", "239 < 31", "340 > 00"]);
    assert_eq!(came.troubles.len(), 1);
    let dates = "name,type,start_time,duration,data\nhost,data,2021-04-27T14:54:31.312123456+00:00,,0x05\n\
        plotter,data,2021-04-27T14:54:31.313123456+00:00,,\\x31\n";
    let came = one(Tool::Saleae, dates);
    assert_eq!(shown(&came.records), ["0 > 05", "1000 < 31"]);
}

#[test]
fn sigrok_with_bits_and_errors_among_the_bytes() {
    // 2 560 000 samples a second: found from the eight bits of a byte.
    let host = "libsigrok 0.5.2\n99-109 uart-1: Start bit\n109-119 uart-1: 0\n119-129 uart-1: 1\n109-189 uart-1: 02\n\
        189-199 uart-1: Stop bit\n209-289 uart-1: rx-data: 00\n300-310 uart-1: Frame error\n";
    let controller = "4095-4175 uart-1: 31\n4195-4275 uart-1: [0A]\nuart-1: 33\n";
    let sources = vec![
        source("H.txt", Tool::Sigrok, None, host.as_bytes()),
        source("D.txt", Tool::Sigrok, None, controller.as_bytes()),
    ];
    let came = run(sources, &ImportSettings::default()).unwrap();
    assert_eq!(shown(&came.records), ["78 > 02", "117 > 00", "1635 < 31", "1674 < 0a"]);
    assert_eq!(
        came.troubles,
        [
            "H.txt line 1: expected samples and `uart-1: ` with a byte in hex",
            "H.txt line 8: the decoder says: Frame error",
            "D.txt line 3: a byte without its samples: run with --protocol-decoder-samplenum",
        ]
    );
    let rate = ImportSettings::default().with_sample_rate_hz(Some(1e6));
    let came = run(vec![source("H.txt", Tool::Sigrok, None, b"92-172 uart-1: 02\n")], &rate).unwrap();
    assert_eq!(shown(&came.records), ["182 > 02"]);
}

#[test]
fn one_file_of_sigrok_with_both_directions() {
    // Two decoders: who speaks first is the host. One with two lines: its rows say who.
    let two = "109-189 uart-1: 02\n209-289 uart-1: 00\n4095-4175 uart-2: 31\n5000-5080 uart-1: 05\n";
    let rows = "109-189 uart-1: tx-data: 02\n209-289 uart-1: tx-data: 00\n4095-4175 uart-1: rx-data: 31\n\
        5000-5080 uart-1: tx-data: 05\n";
    for text in [two, rows] {
        let came =
            run(vec![source("both.txt", Tool::Sigrok, None, text.as_bytes())], &ImportSettings::default());
        let came = came.unwrap();
        assert_eq!(shown(&came.records), ["78 > 02", "117 > 00", "1635 < 31", "1988 > 05"]);
        assert_eq!(came.troubles, Vec::<String>::new());
    }
}

#[test]
fn bare_bytes_have_the_times_of_the_line() {
    let bytes = [b'1'; 100];
    let came = run(vec![source("dump", Tool::Raw, None, &bytes)], &ImportSettings::default()).unwrap();
    let times: Vec<_> = came.records.iter().map(|record| record.time.as_micros()).collect();
    assert_eq!(times, [2_500, 3_906]);
    assert_eq!(came.imported.sides, [("dump".to_owned(), Side::Controller)]);
    let nobody = run(vec![source("dump", Tool::Raw, None, b"\x01\xff\x31\x02")], &ImportSettings::default());
    assert_eq!(nobody.err(), Some(ImportError::WhoseBytes { file: "dump".into() }));
}

#[test]
fn a_cut_last_line_and_other_encodings_cost_their_line() {
    let came = one(Tool::PlotterRaw, "\u{feff}# plotter-raw/1 name=x\n0,H,00\n39,D,3132\n78,H,");
    assert_eq!(shown(&came.records), ["0 > 00", "39 < 31 32"]);
    assert_eq!(came.troubles, ["file line 4: expected t_us,H|D,hex"]);
    let mut text = b"0,H,00\n".to_vec();
    text.extend(b"\xff\xfe,H,00\n");
    text.extend([b'x'; 200_000]);
    text.extend(b"\n18446744073709551616,H,00\n78,H,01\n");
    let came = run(vec![source("f", Tool::PlotterRaw, None, &text)], &ImportSettings::default()).unwrap();
    assert_eq!((came.records.len(), came.troubles.len()), (2, 3), "{:?}", came.troubles);
}

/// A recording of ours, or one of others where it is at hand.
fn recording(name: &str) -> Option<String> {
    let of_ours = ours("logs").into_iter().find(|file| name_of(file) == name);
    of_ours.or_else(|| other("logs", name)).map(|file| std::fs::read_to_string(file).unwrap())
}

/// Bytes one by one with side and time.
fn bytes(records: &[Record]) -> Vec<(bool, u8, u64)> {
    let of = |record: &Record| {
        let time = u64::try_from(record.time.as_micros()).unwrap();
        let (host, bytes) = match &record.event {
            Event::Host(bytes) => (true, bytes.clone()),
            Event::Controller(bytes) => (false, bytes.clone()),
            event => panic!("{event:?}"),
        };
        bytes.into_iter().map(move |byte| (host, byte, time)).collect::<Vec<_>>()
    };
    records.iter().flat_map(of).collect()
}

#[test]
fn real_recordings_of_socat_have_the_bytes_of_the_line() {
    for (text, csv) in [
        ("whole.socat.txt", "whole.csv"),
        ("02_dropped_bytes.socat.txt", "02_dropped_bytes.csv"),
        ("socat_pty_session.txt", "socat_pty_session.csv"),
    ] {
        let (Some(text), Some(csv)) = (recording(text), recording(csv)) else { continue };
        let (came, expected) = (one(Tool::Socat, &text), one(Tool::PlotterRaw, &csv));
        assert_eq!((&came.troubles[..], &expected.troubles[..]), (&[][..], &[][..]));
        let (came, expected) = (bytes(&came.records), bytes(&expected.records));
        assert_eq!(came.len(), expected.len());
        // The times of the two recorders of a pty differ by what the scheduler did between them.
        let shift = i64::try_from(came[0].2).unwrap() - i64::try_from(expected[0].2).unwrap();
        let mut most = 0;
        for (at, (came, expected)) in came.iter().zip(&expected).enumerate() {
            assert_eq!((came.0, came.1), (expected.0, expected.1), "byte {at}");
            let off = i64::try_from(came.2).unwrap() - i64::try_from(expected.2).unwrap() - shift;
            most = most.max(off.abs());
        }
        println!("{} bytes, times within {most} us", came.len());
        assert!(most < 5_000, "{most} us");
    }
}

#[test]
fn a_real_recording_of_sigrok_has_the_bytes_of_the_line() {
    sigrok_has_the_bytes("whole.uart_H.txt", "whole.uart_D.txt", "whole.csv");
    sigrok_has_the_bytes("sigrok_uart_H.txt", "sigrok_uart_D.txt", "sigrok_uart.csv");
}

fn sigrok_has_the_bytes(host: &str, controller: &str, csv: &str) {
    let (Some(host), Some(controller)) = (recording(host), recording(controller)) else {
        return;
    };
    let csv = recording(csv).unwrap();
    let sources = vec![
        source("sigrok_uart_H.txt", Tool::Sigrok, None, host.as_bytes()),
        source("sigrok_uart_D.txt", Tool::Sigrok, None, controller.as_bytes()),
    ];
    let came = run(sources, &ImportSettings::default()).unwrap();
    assert!(came.troubles.is_empty(), "{:?}", came.troubles);
    let expected = bytes(&one(Tool::PlotterRaw, &csv).records);
    let came = bytes(&came.records);
    // The capture began inside the first byte, which is lost.
    assert_eq!(came.len() + 1, expected.len());
    for (at, (came, expected)) in came.iter().zip(&expected[1..]).enumerate() {
        assert_eq!((came.0, came.1), (expected.0, expected.1), "byte {at}");
        // The notes have the beginning of a byte, a log its end; rounded.
        let off = came.2.abs_diff(expected.2);
        assert!((38..=40).contains(&off), "byte {at}: {off} us");
    }
}
