//! Any bytes imported as the recording of any tool: no panic, and what comes out is a clean log.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_replay::import::{ImportSettings, Side, Source, Tool, detect, import};
use plotter_replay::log::{Header, Reader, Writer};

fuzz_target!(|bytes: &[u8]| {
    let Some((&first, rest)) = bytes.split_first() else { return };
    let tool = detect(rest).unwrap_or(Tool::ALL[usize::from(first) % Tool::ALL.len()]);
    let side = [None, Some(Side::Host), Some(Side::Controller)][usize::from(first >> 4) % 3];
    // Two files, as of a tool that writes one a direction.
    let (one, two) = rest.split_at(if first & 8 == 0 { rest.len() } else { rest.len() / 2 });
    let source = |name: &str, side, bytes| Source {
        name: name.to_owned(),
        tool,
        side,
        open: Box::new(move || Ok(Box::new(bytes) as Box<dyn std::io::BufRead>)),
    };
    let mut sources = vec![source("one", side, one)];
    if !two.is_empty() {
        sources.push(source("two", None, two));
    }
    let mut writer = Writer::new(Vec::new(), &Header::new()).expect("memory takes all");
    let mut troubles = 0;
    let done = import(sources, &ImportSettings::default(), &mut writer, |trouble| {
        assert!(!trouble.to_string().is_empty());
        troubles += 1;
    });
    if let Ok(imported) = done {
        assert_eq!(imported.troubles, troubles);
    }
    let log = writer.finish().expect("memory takes all");
    let mut reader = Reader::new(&log[..]).expect("it was written");
    assert!(reader.by_ref().all(|record| record.is_ok()));
});
