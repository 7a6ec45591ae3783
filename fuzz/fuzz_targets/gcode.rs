//! Any bytes read as G-code give places and speeds that are numbers; what is read can be written and read
//! again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_motion::PlotOp;
use plotter_motion::gcode::{
    Detection, LaserCommand, PenControl, PenConvention, PlotOps, ReadOptions, Reader, ServoCommand, Spacing,
    WriteOptions, Writer,
};

fuzz_target!(|bytes: &[u8]| {
    let Some((choice, text)) = bytes.split_first() else { return };
    let pen = match choice % 8 {
        0 => PenConvention::Spindle,
        1 => PenConvention::Height { threshold_mm: 0.0 },
        2 => PenConvention::UNICORN,
        3 => PenConvention::GRBL_LASER,
        4 => PenConvention::Laser { command: LaserCommand::M4, full: 255.0 },
        5 => PenConvention::Servo { command: ServoCommand::Z, up: 90.0, down: 130.0 },
        6 => PenConvention::Motion,
        _ => Detection::from_bytes(text.iter().copied()).pen(),
    };
    // Curves, turns and cycles are many operations, and loops repeat lines: `gcode_program` is for them.
    let is_plain = !text.iter().any(|byte| matches!(byte, b'O' | b'o' | b'P' | b'p' | b'5' | b'8' | b'7'));
    let lines = text.iter().filter(|byte| matches!(byte, b'\n' | b'\r')).count() + 1;
    let options = ReadOptions { pen, ..ReadOptions::default() };
    let laser =
        WriteOptions { pen: PenControl::Laser { full: 1000 }, decimals: 6, ..WriteOptions::default() };
    let mut writer = Writer::with_options(String::new(), laser);
    let mut count = 0;
    for op in PlotOps::with_options(text.iter().copied(), options).take(20_000) {
        count += 1;
        match op {
            Ok(op) => {
                check(op);
                let _ = writer.push(op); // what lies too far away is refused
            }
            Err(error) => assert!(error.at.offset <= text.len() as u64 && !error.to_string().is_empty()),
        }
    }
    assert!(!is_plain || count <= 11 * lines + 3);
    let again = writer.finish().expect("a string takes everything");
    let laser = ReadOptions { pen: PenConvention::GRBL_LASER, ..ReadOptions::default() };
    for op in PlotOps::with_options(again.bytes(), laser) {
        match op {
            Ok(op) => check(op),
            Err(error) => panic!("{error}\n{again}"),
        }
    }
    let mut spaced = Reader::with_spacing(Spacing::Required);
    let blocks = text.iter().filter_map(|byte| spaced.push(*byte)).count();
    assert!(blocks <= lines);
});

fn check(op: PlotOp) {
    assert!(op.target().is_none_or(|to| to.is_finite()), "{op:?}");
    match op {
        PlotOp::Draw { feed_mm_s: Some(feed), .. } => assert!(feed.is_finite() && feed > 0.0),
        PlotOp::DrawArc { centre, sweep_rad, .. } => {
            assert!(centre.is_finite() && sweep_rad != 0.0 && sweep_rad.abs() <= std::f64::consts::TAU);
        }
        PlotOp::LaserPower { share } => assert!(share > 0.0 && share <= 1.0),
        _ => {}
    }
}
