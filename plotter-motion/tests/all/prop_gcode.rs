//! Laws of G-code: what is written is read back, whatever the layout; and no text, however broken, does harm.

use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::gcode::{
    Block, Detection, DwellUnit, Error, Interpreter, LaserCommand, PenChange, PenControl, PenConvention,
    PlotOps, ReadOptions, Reader, ServoCommand, Spacing, WriteError, WriteOptions, Writer, plot_ops,
};
use plotter_motion::{PlotOp, Point, Vec2};
use proptest::prelude::*;

/// What the sum of two written numbers may be rounded by, mm.
const ROUNDING_MM: f64 = 1e-9;

/// What a speed of whole hundredths of a mm/min may be rounded by on its way to mm/s and back.
const ROUNDING_MM_S: f64 = 1e-12;

const FULL: u32 = 1000;

/// A laser that is switched as a printer's fan.
const FAN: PenControl<'_> = PenControl::Commands { up: "M107", down: "M106" };

/// A way of lifting pens, as it is written and as it is read.
fn conventions() -> impl Strategy<Value = (PenControl<'static>, PenConvention)> {
    let servo = |command, up, down| PenConvention::Servo { command, up, down };
    prop::sample::select(vec![
        (PenControl::Spindle { down: 90 }, PenConvention::Spindle),
        (PenControl::Height { up_mm: 5.0, down_mm: -0.25 }, PenConvention::Height { threshold_mm: 0.0 }),
        (PenControl::Height { up_mm: 3.0, down_mm: 1.0 }, PenConvention::Height { threshold_mm: 2.0 }),
        (PenControl::Laser { full: FULL }, PenConvention::GRBL_LASER),
        (PenControl::Commands { up: "M300 S50", down: "M300 S30" }, PenConvention::UNICORN),
        (PenControl::Commands { up: "M1 160", down: "M1 90" }, PenConvention::MDRAW),
        (
            PenControl::Commands { up: "M280 P0 S90", down: "M280 P0 S10" },
            servo(ServoCommand::M280, 90.0, 10.0),
        ),
        (PenControl::Commands { up: "M3 S30", down: "M3 S90" }, servo(ServoCommand::M3, 30.0, 90.0)),
        (PenControl::Commands { up: "G1 Z90", down: "G1 Z130" }, servo(ServoCommand::Z, 90.0, 130.0)),
        (FAN, PenConvention::Laser { command: LaserCommand::Fan, full: 255.0 }),
    ])
}

fn options() -> impl Strategy<Value = (WriteOptions<'static>, ReadOptions)> {
    let settle = prop::sample::select(vec![0, 150, 400]).prop_map(Duration::from_millis);
    let unit = prop::sample::select(vec![DwellUnit::Seconds, DwellUnit::Milliseconds]);
    let change = prop::sample::select(vec![PenChange::Pause, PenChange::Tool]);
    (conventions(), settle, unit, change, 0..=6_u8).prop_map(
        |((pen, read), settle, dwell_unit, pen_change, decimals)| {
            // A fan that is a laser has no way to go.
            let settle = if pen == FAN { Duration::ZERO } else { settle };
            let write = WriteOptions { pen, pen_change, settle, dwell_unit, decimals, ..Default::default() };
            (write, ReadOptions { pen: read, dwell_unit, settle, ..Default::default() })
        },
    )
}

/// Operations whose numbers have no more decimals than are written.
fn op(decimals: u8) -> impl Strategy<Value = PlotOp> {
    let scale = 10_f64.powi(decimals.into());
    // Few places, so that the pen often stays where it is; and far ones.
    let most = 99_999 * 10_i32.pow(decimals.min(3).into());
    let number =
        prop_oneof![0..3_i32, -60..60_i32, -most..most].prop_map(move |steps| f64::from(steps) / scale);
    let point = (number.clone(), number).prop_map(|(x, y)| Point::new(x, y));
    let feed =
        proptest::option::of((1..1_000_000_i32).prop_map(|hundredths| f64::from(hundredths) / 100.0 / 60.0));
    prop_oneof![
        4 => point.clone().prop_map(|to| PlotOp::Travel { to }),
        6 => (point, feed).prop_map(|(to, feed_mm_s)| PlotOp::Draw { to, feed_mm_s }),
        1 => (1..=FULL).prop_map(|s| PlotOp::LaserPower { share: f64::from(s) / f64::from(FULL) }),
        1 => any::<u8>().prop_map(|pen| PlotOp::SelectPen { pen }),
        1 => (0..5000_u64).prop_map(|ms| PlotOp::Dwell { duration: Duration::from_millis(ms) }),
        1 => Just(PlotOp::NewPage),
    ]
}

fn drawing(decimals: u8) -> impl Strategy<Value = Vec<PlotOp>> {
    proptest::collection::vec((op(decimals), 1..3_usize), 0..50)
        .prop_map(|ops| ops.into_iter().flat_map(|(op, times)| std::iter::repeat_n(op, times)).collect())
}

fn written(ops: &[PlotOp], options: WriteOptions<'_>) -> Result<String, WriteError> {
    let mut writer = Writer::with_options(String::new(), options);
    ops.iter().try_for_each(|op| writer.push(*op))?;
    writer.finish()
}

/// What a text says of a drawing: no line twice, no pen twice, and the power of a laser where it is first
/// needed.
fn meant(ops: &[PlotOp], write: &WriteOptions<'_>) -> Vec<PlotOp> {
    let mut meant = Vec::new();
    let (mut at, mut down, mut holder) = (None, false, 0);
    // What has been read leaves the pen there.
    let mut on_sheet = None;
    let (mut share, mut told) = (1.0, None);
    let laser = matches!(write.pen, PenControl::Laser { .. }) || write.pen == FAN;
    for op in ops {
        let said = meant.len();
        match *op {
            PlotOp::Travel { to } => {
                (at, down) = (Some(to), false);
                meant.push(*op);
            }
            PlotOp::Draw { to, feed_mm_s } => {
                if at.is_none() {
                    meant.push(PlotOp::Travel { to: Point::ORIGIN });
                }
                let here = at.unwrap_or(Point::ORIGIN);
                if laser && told != Some(share) && !(down && here == to) {
                    told = Some(share);
                    meant.push(PlotOp::LaserPower { share });
                }
                // A dot has no speed; within a stroke it is nothing. One at the beginning of a stroke shows
                // only where nothing follows it.
                if here != to || !down {
                    meant.push(PlotOp::Draw { to, feed_mm_s: feed_mm_s.or(Some(write.feed_mm_s)) });
                }
                (at, down) = (Some(to), true);
            }
            PlotOp::LaserPower { share: new } if matches!(write.pen, PenControl::Laser { .. }) => share = new,
            PlotOp::LaserPower { .. } => {}
            PlotOp::SelectPen { pen } => {
                down = false;
                if pen != 0 && pen != holder {
                    holder = pen;
                    meant.push(*op);
                }
            }
            PlotOp::NewPage => {
                down = false;
                meant.push(*op);
            }
            PlotOp::Dwell { duration } if duration.is_zero() => {}
            PlotOp::Dwell { .. } => {
                // Lifted for a pen that was not asked for: before it stands.
                if !down && let Some(to) = on_sheet {
                    meant.push(PlotOp::Travel { to });
                }
                meant.push(*op);
            }
            _ => meant.push(*op),
        }
        for op in meant.get(said..).unwrap_or_default() {
            on_sheet = match op {
                PlotOp::Draw { to, .. } => Some(*to),
                PlotOp::LaserPower { .. } | PlotOp::Dwell { .. } => on_sheet,
                _ => None,
            };
        }
    }
    // The text ends lifted.
    meant.extend(on_sheet.map(|to| PlotOp::Travel { to }));
    meant
}

/// The same without dots that a line goes on from: the pen is lowered there anyway.
fn without_first_dots(ops: Vec<PlotOp>) -> Vec<PlotOp> {
    let mut kept: Vec<PlotOp> = Vec::new();
    let mut at = Point::ORIGIN;
    for (index, op) in ops.iter().enumerate() {
        let dot = matches!(op, PlotOp::Draw { to, .. } if *to == at);
        let goes_on = matches!(ops.get(index + 1), Some(PlotOp::Draw { .. } | PlotOp::LaserPower { .. }));
        at = op.target().unwrap_or(at);
        if !(dot && goes_on) {
            kept.push(*op);
        }
    }
    kept
}

fn same(read: &PlotOp, meant: &PlotOp, is_dot: bool) -> bool {
    match (read, meant) {
        (PlotOp::Draw { to: a, feed_mm_s: one }, PlotOp::Draw { to: b, feed_mm_s: other }) => {
            let near = one
                .zip(*other)
                .is_some_and(|(one, other)| (one - other).abs() < ROUNDING_MM_S * other.max(1.0));
            a == b && (is_dot || near)
        }
        _ => read == meant,
    }
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn what_is_written_is_read_back(
        ((write, read), ops) in options().prop_flat_map(|both| (Just(both), drawing(both.0.decimals)))
    ) {
        let text = written(&ops, write).unwrap();
        let again: Vec<PlotOp> = PlotOps::with_options(text.bytes(), read)
            .collect::<Result<_, _>>()
            .map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
        let (again, meant) = (without_first_dots(again), without_first_dots(meant(&ops, &write)));
        let mut at = Point::ORIGIN;
        for (index, op) in meant.iter().enumerate() {
            let is_dot = op.target() == Some(at);
            at = op.target().unwrap_or(at);
            prop_assert!(again.get(index).is_some_and(|again| same(again, op, is_dot)),
                "{op:?} became {:?}, {write:?}\n{text}", again.get(index));
        }
        prop_assert_eq!(again.len(), meant.len(), "{:?}\n{}", write, text);
    }
}

/// Arcs one after the other: each begins where the one before ended, and is a centre's place from there, mm,
/// and a sweep.
fn arcs() -> impl Strategy<Value = Vec<(Vec2, f64)>> {
    let centre = (1.0..2000.0_f64, 0.0..std::f64::consts::TAU)
        .prop_map(|(far, angle)| Vec2::new(far, 0.0).rotated(angle));
    // Arcs of three quarters of a turn may be written in one or two; flat ones as lines.
    let sweep = prop_oneof![0.2..4.6_f64, 4.8..6.2_f64, Just(std::f64::consts::TAU)];
    let sweep = (sweep, any::<bool>()).prop_map(|(sweep, left)| if left { sweep } else { -sweep });
    proptest::collection::vec((centre, sweep), 1..12)
}

proptest! {
    #[test]
    fn arcs_written_again_are_the_same_text((pen, read) in conventions(), arcs in arcs(), decimals in 3..=6_u8) {
        let settle = if pen == FAN { Duration::ZERO } else { Duration::from_millis(150) };
        let write = WriteOptions { pen, decimals, settle, ..Default::default() };
        let mut at = Point::new(50.0123, 47.0077);
        let mut ops = vec![PlotOp::Travel { to: at }];
        let mut ends = vec![at];
        for (to_centre, sweep_rad) in arcs {
            let centre = at + to_centre;
            at = centre + (-to_centre).rotated(sweep_rad);
            ends.push(at);
            ops.push(PlotOp::DrawArc { centre, sweep_rad, to: at, feed_mm_s: Some(10.0) });
        }
        let text = written(&ops, write).unwrap();
        let read = ReadOptions { pen: read, settle, ..Default::default() };
        let again: Vec<PlotOp> = PlotOps::with_options(text.bytes(), read)
            .collect::<Result<_, _>>()
            .map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
        // The writer itself lifts the pen at the end.
        let (lift, strokes) = again.split_last().unwrap();
        prop_assert_eq!(*lift, PlotOp::Travel { to: strokes.iter().filter_map(|op| op.target()).next_back().unwrap() });
        prop_assert_eq!(&written(strokes, write).unwrap(), &text);
        // And they are the arcs that were meant: their ends are reached in their order, to the last decimal.
        let half_step = 0.5 * 10_f64.powi(-i32::from(decimals)) + ROUNDING_MM;
        let mut reached = again.iter().filter_map(|op| op.target());
        for end in ends {
            prop_assert!(
                reached.any(|at| (at.x - end.x).abs() <= half_step && (at.y - end.y).abs() <= half_step),
                "{end:?}\n{text}"
            );
        }
    }

    #[test]
    fn what_is_written_is_recognized(
        (pen, read) in conventions(),
        strokes in proptest::collection::vec((-9..9_i32, -9..9_i32, 1..9_i32), 1..20),
    ) {
        let ops: Vec<PlotOp> = strokes.iter().flat_map(|(x, y, length)| {
            let from = Point::new(f64::from(*x), f64::from(*y));
            let to = from + Vec2::new(f64::from(*length), 0.5);
            [PlotOp::Travel { to: from }, PlotOp::Draw { to, feed_mm_s: None }]
        }).collect();
        let text = written(&ops, WriteOptions { pen, ..Default::default() }).unwrap();
        prop_assert_eq!(Detection::from_bytes(text.bytes()).options().dwell_unit, DwellUnit::Seconds);
        prop_assert_eq!(Detection::from_bytes(text.bytes()).pen(), read, "{}", text);
        prop_assert_eq!(plot_ops(text.as_bytes()).filter(|op| matches!(op, Ok(PlotOp::Draw { .. }))).count(), strokes.len());
    }
}

/// Words that G-code is made of, so that chance finds more than unknown letters.
fn likely_text() -> impl Strategy<Value = Vec<u8>> {
    let part = prop_oneof![
        6 => prop::sample::select(vec![
            "G0", "G1", "g2", "G3", "G4", "G17", "G18", "G20", "G21", "G28", "G53", "G80", "G90", "G91", "G90.1", "G91.1", "G92",
            "G92.1", "G93", "M0", "M1 ", "M2", "M3", "M4", "M4 ", "M5", "M6", "M30", "M106", "M107", "M117", "M280", "M300",
            "(new sheet)", "(pen 2)", "(", ")", ";", "%", "/", "$", "*", "*71", "-", ".", "e", "\u{e9}", "U", "A", "$H",
        ]).prop_map(|part| part.as_bytes().to_vec()),
        6 => (prop::sample::select(b"XYZIJRFSPTNKE".to_vec()), -9999..9999_i32, 0..4_u32)
            .prop_map(|(letter, number, places)| {
                let number = f64::from(number) / 10_f64.powi(places.cast_signed());
                format!("{}{number}", char::from(letter)).into_bytes()
            }),
        6 => prop::sample::select(vec![" ", "\n", "\n", "\r\n", "\r", "\t"]).prop_map(|part| part.as_bytes().to_vec()),
        1 => (0..400_usize).prop_map(|count| vec![b'9'; count]),
        1 => any::<u8>().prop_map(|byte| vec![byte]),
    ];
    proptest::collection::vec(part, 0..120).prop_map(|parts| parts.concat())
}

fn any_options() -> impl Strategy<Value = ReadOptions> {
    let motion = Just(PenConvention::Motion);
    prop_oneof![9 => conventions().prop_map(|(_, read)| read), 1 => motion]
        .prop_map(|pen| ReadOptions { pen, ..Default::default() })
}

fn blocks(text: &[u8], spacing: Spacing) -> Vec<Result<Block, Error>> {
    let mut reader = Reader::with_spacing(spacing);
    let mut blocks: Vec<_> = text.iter().filter_map(|byte| reader.push(*byte)).collect();
    blocks.extend(reader.finish());
    blocks
}

proptest! {
    #[test]
    fn no_text_does_harm(text in prop_oneof![likely_text(), proptest::collection::vec(any::<u8>(), 0..300)], read in any_options()) {
        let lines = text.iter().filter(|byte| matches!(byte, b'\n' | b'\r')).count() + 1;
        for options in [read, Detection::from_bytes(text.iter().copied()).options()] {
            let ops: Vec<_> = PlotOps::with_options(text.iter().copied(), options).collect();
            // A line gives ten operations at most, besides the thousand turns that the P of an arc may ask
            // for, and the end a dot with its power.
            let turns = 1000 * text.iter().filter(|byte| byte.eq_ignore_ascii_case(&b'P')).count();
            prop_assert!(ops.len() <= 10 * lines + turns + 2);
            for op in &ops {
                match op {
                    Ok(PlotOp::LaserPower { share }) => prop_assert!(*share > 0.0 && *share <= 1.0),
                    Ok(PlotOp::DrawArc { centre, sweep_rad, to, .. }) => {
                        prop_assert!(centre.is_finite() && to.is_finite());
                        prop_assert!(sweep_rad.abs() <= std::f64::consts::TAU && *sweep_rad != 0.0);
                    }
                    Ok(op) => prop_assert!(op.target().is_none_or(Point::is_finite)),
                    Err(error) => prop_assert!(!error.to_string().is_empty() && error.at.offset <= text.len() as u64),
                }
                if let Ok(PlotOp::Draw { feed_mm_s: Some(feed), .. } | PlotOp::DrawArc { feed_mm_s: Some(feed), .. }) = op {
                    prop_assert!(feed.is_finite() && *feed > 0.0);
                }
            }
            let errors = ops.iter().filter(|op| op.is_err_and(|error| !error.is_notice())).count();
            let strict: Vec<_> = PlotOps::with_options(text.iter().copied(), options).strict().collect();
            prop_assert_eq!(strict.iter().filter(|op| op.is_err_and(|error| !error.is_notice())).count(), errors.min(1));
            prop_assert_eq!(&strict[..], &ops[..strict.len()]);
        }
        blocks(&text, Spacing::Required);
    }

    #[test]
    fn a_bad_line_costs_only_itself(before in likely_text(), bad in likely_text()) {
        let bad: Vec<u8> = bad.into_iter().filter(|byte| !matches!(byte, b'\n' | b'\r')).collect();
        let good = [&before[..], b"\nG1 X1\n"].concat();
        let with = [&before[..], b"\n", &bad, b"\nG1 X1\n"].concat();
        let (good, with) = (blocks(&good, Spacing::Free), blocks(&with, Spacing::Free));
        let words = |blocks: &[Result<Block, Error>]| blocks.last().map(|block| block.map(|block| block.words().to_vec()));
        prop_assert_eq!(words(&good), words(&with));
        prop_assert!(with.len() <= good.len() + 1);
    }

    #[test]
    fn layout_changes_nothing(
        lines in proptest::collection::vec(
            proptest::collection::vec((prop::sample::select(b"XYIJFSPZ".to_vec()), -999..999_i32), 0..5), 0..12),
        commands in proptest::collection::vec(prop::sample::select(vec!["G0", "G1", "G2", "M3", "M5", "G91", "G90", "M300"]), 12),
        read in any_options(),
    ) {
        let shown = |between: &str, after: &str, end: &str, tail: &str| -> String {
            lines.iter().zip(&commands).map(|(words, command)| {
                let words: Vec<String> = words.iter()
                    .map(|(letter, number)| format!("{}{after}{}", char::from(*letter), f64::from(*number) / 10.0))
                    .collect();
                format!("{command}{between}{}{tail}{end}", words.join(between))
            }).collect()
        };
        let kinds = |text: String| -> Vec<_> {
            PlotOps::with_options(text.bytes(), read).map(|op| op.map_err(|error| (error.problem, error.at.line))).collect()
        };
        let plain = kinds(shown(" ", "", "\n", ""));
        // Columns differ, and so does what a message says of them.
        let simple = |ops: &[Result<PlotOp, _>]| -> Vec<Option<PlotOp>> { ops.iter().map(|op| op.as_ref().ok().copied()).collect() };
        for text in [
            shown("", "", "\n", ""),
            shown(" ", " ", "\r\n", ""),
            shown("\t ", "", "\r\n", " ; and (that) is it"),
            shown(" (word) ", "", "\n", "(end)"),
            shown(" ", "", "\n", "").to_lowercase(),
            format!("%\n{}", shown(" ", "", "\n\n", "   ")),
        ] {
            prop_assert_eq!(simple(&kinds(text.clone())), simple(&plain), "{}", text);
        }
    }

    #[test]
    fn bytes_may_come_in_any_portions(text in likely_text(), read in any_options()) {
        // One byte at a time is all there is: a reader that is copied between any two bytes goes on as if it
        // had not been.
        let whole = by_bytes(&text, read, false);
        let pieces = by_bytes(&text, read, true);
        prop_assert_eq!(pieces, whole);
    }

    #[test]
    fn a_right_checksum_passes_and_a_wrong_one_does_not(x in -999..999_i32, number in 0..999_u32, flip in 1..=255_u8) {
        let line = format!("N{number} G1 X{x}");
        let sum = line.bytes().fold(0, |sum, byte| sum ^ byte);
        let right = blocks(format!("{line}*{sum}\n").as_bytes(), Spacing::Free);
        prop_assert!(right.len() == 1 && right[0].is_ok_and(|block| block.is_checked() && block.line_number() == Some(number)));
        let wrong = blocks(format!("{line}*{} ; comment\nG0", sum ^ flip).as_bytes(), Spacing::Free);
        prop_assert!(wrong.len() == 2 && wrong[0].is_err() && wrong[1].is_ok());
    }
}

/// A text by its reader and interpreter, which are copied before each byte or not.
fn by_bytes(text: &[u8], read: ReadOptions, copies: bool) -> Vec<Result<PlotOp, Error>> {
    let (mut reader, mut interpreter) = (Reader::new(), Interpreter::with_options(read));
    let mut ops = Vec::new();
    for byte in text {
        let mut copy = reader;
        let block = if copies { copy.push(*byte) } else { reader.push(*byte) };
        if copies {
            reader = copy;
        }
        if let Some(block) = block {
            interpreter.push(block).unwrap();
            ops.extend(std::iter::from_fn(|| interpreter.next_op()));
        }
    }
    if let Some(block) = reader.finish() {
        interpreter.push(block).unwrap();
        ops.extend(std::iter::from_fn(|| interpreter.next_op()));
    }
    interpreter.finish().unwrap();
    ops.extend(std::iter::from_fn(|| interpreter.next_op()));
    ops
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_text_of_any_length_needs_no_more_memory() {
    // Most of it is what the longest line gives, and the texts of its complaints.
    const BYTES: usize = 4096;
    let size = std::mem::size_of::<(Reader, Interpreter)>();
    println!(
        "reader {} bytes, interpreter {} bytes, detection {} bytes",
        size_of::<Reader>(),
        size_of::<Interpreter>(),
        size_of::<Detection>()
    );
    assert!(size < BYTES);
    let lines = (0..100_000_u32).flat_map(|i| format!("G1 X{} Y{}\n", i % 3000, i % 2000).into_bytes());
    assert_eq!(PlotOps::new(lines).count(), 100_000);
    // A line without end is not kept either.
    assert_eq!(PlotOps::new(std::iter::repeat_n(b'1', 10_000_000)).count(), 1);
}
