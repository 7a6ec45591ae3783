//! Any row of words of a G-code program, with its variables, formulas, loops, subprograms and curves, is read
//! to an end: places are numbers, errors have a place in the text. The first byte chooses; each other one is
//! a word, or itself.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_motion::PlotOp;
use plotter_motion::gcode::{PenConvention, PenWords, PlotOps, ReadOptions, detect};

const WORDS: [&str; 64] = [
    "\n",
    "\n",
    "#1",
    "#2",
    "#<a>",
    "#<_b>",
    "##1",
    "#[",
    "=",
    "[",
    "]",
    "+",
    "-",
    "*",
    "/",
    "**",
    " MOD ",
    " EQ ",
    " LT ",
    " AND ",
    "SQRT",
    "ATAN",
    "]/[",
    "EXISTS",
    "FIX",
    "O1 ",
    "O2 ",
    "o<s> ",
    "O[",
    "sub",
    "endsub",
    "call ",
    "return ",
    "if ",
    "elseif ",
    "else",
    "endif",
    "while ",
    "endwhile",
    "do",
    "repeat ",
    "endrepeat",
    "continue",
    "break",
    "M98 P",
    "M99",
    "L",
    "O3\n",
    "G1 X",
    "Y",
    "G2 I",
    "P",
    "G5 ",
    "G16",
    "G51 ",
    "G68 R",
    "G81 Z",
    "M0 ",
    "(",
    ")",
    "1",
    "2",
    "9.5",
    "PEN_UP",
];

/// A loop may repeat a million lines of curves: so many operations are enough.
const MOST: usize = 20_000;

fuzz_target!(|bytes: &[u8]| {
    let Some((choice, bytes)) = bytes.split_first() else { return };
    let mut text = Vec::new();
    for byte in bytes {
        match WORDS.get(usize::from(byte.wrapping_sub(128))) {
            Some(word) => text.extend_from_slice(word.as_bytes()),
            None => text.push(*byte),
        }
    }
    // Without an end to its loops the search for its pen takes as long.
    let pen = match choice % 4 {
        0 => PenConvention::Height { threshold_mm: 0.0 },
        1 if text.len() < 64 => detect(text.iter().copied()),
        _ => PenConvention::Motion,
    };
    let mut ops = PlotOps::with_options(text.iter().copied(), ReadOptions { pen, ..ReadOptions::default() });
    if choice % 4 == 3 {
        let words = PenWords::new(["PEN_UP", "M0"], ["M99"]).expect("three lines of G-code");
        ops = ops.with_pen_words(words);
    }
    for op in ops.take(MOST) {
        match op {
            Ok(PlotOp::DrawArc { centre, sweep_rad, to, .. }) => {
                assert!(centre.is_finite() && to.is_finite() && sweep_rad.abs() <= std::f64::consts::TAU);
            }
            Ok(op) => assert!(op.target().is_none_or(|to| to.is_finite()), "{op:?}"),
            Err(error) => assert!(error.at.offset <= text.len() as u64 && !error.to_string().is_empty()),
        }
    }
});
