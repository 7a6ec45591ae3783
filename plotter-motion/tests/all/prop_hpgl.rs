//! Laws of HPGL: what is written is read back, whatever the layout; and no text, however broken, does harm.

use crate::figure::Figure;
use crate::law_cases::cases;
use plotter_motion::hpgl::{
    Coordinates, Error, Event, Interpreter, Opening, PlotOps, Reader, WriteError, WriteOptions, Writer,
    plot_ops, write_ops,
};
use plotter_motion::{PlotOp, Point, Vec2, toolpath::chords};
use proptest::prelude::*;

static OFF: Figure = Figure::of("mm off");

/// Half a plotter unit, mm, and the rounding of a coordinate near 1000 mm.
const HALF_UNIT_MM: f64 = 0.0125 + 1e-12;
/// Half a step of the written speed, mm/s, and the rounding of a speed near 100 mm/s.
const HALF_SPEED_STEP_MM_S: f64 = 0.005 + 1e-12;

/// A drawing with coordinates from `coordinate`, mm, and speeds from `feed`, mm/s.
fn drawing(
    coordinate: impl Strategy<Value = f64> + Clone + 'static,
    feed: impl Strategy<Value = f64> + Clone + 'static,
) -> impl Strategy<Value = Vec<PlotOp>> {
    let point = (coordinate.clone(), coordinate).prop_map(|(x, y)| Point::new(x, y)).boxed();
    let draw = (point.clone(), proptest::option::of(feed))
        .prop_map(|(to, feed_mm_s)| PlotOp::Draw { to, feed_mm_s });
    let op = prop_oneof![
        3 => point.prop_map(|to| PlotOp::Travel { to }),
        6 => draw,
        1 => any::<u8>().prop_map(|pen| PlotOp::SelectPen { pen }),
        1 => Just(PlotOp::NewPage),
    ];
    // An operation is now and then repeated, which makes dots.
    proptest::collection::vec((op, 1..3_usize), 0..60)
        .prop_map(|ops| ops.into_iter().flat_map(|(op, times)| std::iter::repeat_n(op, times)).collect())
}

fn on_the_grid() -> impl Strategy<Value = Vec<PlotOp>> {
    drawing(
        // Few places, so that the pen often stays where it is; and among them the origin.
        prop_oneof![0..2_i32, -60..60_i32].prop_map(|units| f64::from(units) / 40.0),
        (1..5000_i32).prop_map(|hundredths| f64::from(hundredths) / 100.0),
    )
}

/// The drawing as it is read back: the writer has added a pen, a start and an end.
fn with_frame(ops: &[PlotOp]) -> Vec<PlotOp> {
    let mut framed = Vec::new();
    let (mut pen, mut moved) = (false, false);
    for op in ops {
        if op.target().is_some() && !pen {
            framed.push(PlotOp::SelectPen { pen: 1 });
        }
        pen |= op.target().is_some() || matches!(op, PlotOp::SelectPen { .. });
        if matches!(op, PlotOp::Draw { .. }) && !moved {
            framed.push(PlotOp::Travel { to: Point::ORIGIN });
        }
        moved |= op.target().is_some();
        framed.push(*op);
    }
    framed.push(PlotOp::SelectPen { pen: 0 });
    framed
}

fn written(ops: &[PlotOp]) -> Result<String, WriteError> {
    let mut text = String::new();
    write_ops(ops.iter().copied(), &mut text)?;
    Ok(text)
}

fn near(read: &PlotOp, meant: &PlotOp, tolerance_mm: f64, tolerance_mm_s: f64) -> bool {
    let same_place = match (read.target(), meant.target()) {
        (Some(a), Some(b)) => (a.x - b.x).abs() <= tolerance_mm && (a.y - b.y).abs() <= tolerance_mm,
        _ => read == meant,
    };
    let same_kind = match (read, meant) {
        (PlotOp::Draw { feed_mm_s: Some(a), .. }, PlotOp::Draw { feed_mm_s: Some(b), .. }) => {
            (a - b).abs() <= tolerance_mm_s
        }
        (PlotOp::Draw { feed_mm_s: a, .. }, PlotOp::Draw { feed_mm_s: b, .. }) => a == b,
        (a, b) => std::mem::discriminant(a) == std::mem::discriminant(b),
    };
    same_place && same_kind
}

/// Bytes that HPGL is made of, so that chance finds more than unknown letters.
fn likely_text() -> impl Strategy<Value = Vec<u8>> {
    let part = prop_oneof![
        prop::sample::select(vec![
            "PU",
            "PD",
            "PA",
            "PR",
            "IN",
            "DF",
            "SP",
            "VS",
            "CI",
            "PG",
            "LB",
            "DT",
            "SM",
            "PE",
            "BP",
            "CO",
            "SC",
            "pd",
            "AA",
            "AR",
            "AT",
            "RT",
            "CT",
            "IP",
            "IR",
            "RO",
            "PS",
            "IW",
            "LT",
            "UL",
            "PW",
            "PM0;",
            "PM1;",
            "PM2;",
            "EP",
            "FP",
            "EA",
            "RA",
            "ER",
            "RR",
            "EW",
            "WG",
            "FT",
            "AC",
            "UF",
            "SI",
            "SR",
            "DI",
            "DR",
            "SL",
            "LO",
            "DV",
            "ES",
            "CP",
            "UC",
            "TL",
            "XT",
            "YT",
            "BZ",
            "BR",
            "PE<=",
            "PE7",
            "\x1b",
            "\x1b.",
            "\x1b%0A",
            "\x1b%0B",
            "\x1b%-12345X",
            "\x1bE",
            "\x03",
            "\"",
            "-",
            ".",
            "@",
            "\r\n",
            ":",
        ])
        .prop_map(|part| part.as_bytes().to_vec()),
        (-9999..9999_i32).prop_map(|number| number.to_string().into_bytes()),
        prop::sample::select(vec![b';', b',', b' ', b'0', b'9']).prop_map(|byte| vec![byte]),
        any::<u8>().prop_map(|byte| vec![byte]),
    ];
    proptest::collection::vec(part, 0..120).prop_map(|parts| parts.concat())
}

/// Events without their places.
fn events(text: &[u8]) -> Vec<String> {
    let mut reader = Reader::new();
    let mut all: Vec<_> = text.iter().filter_map(|byte| reader.push(*byte)).collect();
    all.extend(reader.finish());
    // Where a number is known to be the last depends on the layout: its end is told apart here.
    let mut shown = Vec::new();
    for event in all {
        match event {
            Ok(Event::Command { command, .. }) => shown.push(command.to_string()),
            Ok(Event::Number { value, last, .. }) => {
                shown.push(value.to_string());
                shown.extend(last.then(|| "end".to_string()));
            }
            Ok(Event::End) => shown.push("end".to_string()),
            other => shown.push(format!("{other:?}")),
        }
    }
    shown
}

/// Operations after which a text has shown what it can do.
const MOST_LINES: u64 = 200_000;
/// A curve has 4096 lines, and the way to it.
const MOST_OF_A_CURVE: usize = 4097;
/// A rectangle that is filled crosswise with 16384 lines each way, each of them with a travel; and pens and
/// complaints.
const MOST_OF_A_COMMAND: usize = 2 * 2 * 16_384 + 100;

/// One command with a few numbers, great and small.
fn likely_command() -> impl Strategy<Value = String> {
    let letters = prop::sample::select(vec![
        "CI",
        "AA",
        "AR",
        "AT",
        "RT",
        "EA",
        "RA",
        "ER",
        "RR",
        "EW",
        "WG",
        "BZ",
        "BR",
        "FT3,1;RR",
        "FT4,2,30;RA",
        "FT4,0.01;WG",
        "PW0.01;RR",
        "PD;LT2,1;PA",
        "PD;LT4,0.0001,1;CI",
        "PD;LT1,1,1;AA",
        "PD;PR",
        "XT",
        "YT",
        "CP",
        "SM*;PA",
        "UC",
        "LB",
        "IW0,0,99,99;CI",
        "SC0,1,0,1;PD;AA",
        "SC0,1,0,10;CI",
        "RO90;EW",
    ]);
    let number = prop_oneof![-1000..1000_i32, -9..9_i32, Just(360), -1_000_000_000..1_000_000_000];
    let end = prop::sample::select(vec![";", "\x03;"]);
    (letters, proptest::collection::vec(number, 0..7), end).prop_map(|(letters, numbers, end)| {
        let numbers: Vec<String> = numbers.iter().map(ToString::to_string).collect();
        format!("{letters}{}{end}", numbers.join(","))
    })
}

/// Share of a speed that is lost on the way through a decimal number.
const DECIMAL_ROUNDING: f64 = 1e-12;

proptest! {
    #[test]
    fn a_drawing_on_the_grid_is_read_back_exactly(ops in on_the_grid()) {
        let read: Vec<PlotOp> = plot_ops(written(&ops)?.as_bytes()).collect::<Result<_, Error>>()?;
        let meant = with_frame(&ops);
        prop_assert_eq!(read.len(), meant.len());
        for (read, meant) in read.iter().zip(&meant) {
            // Places to the bit; a speed goes through a decimal number of cm/s.
            prop_assert!(near(read, meant, 0.0, DECIMAL_ROUNDING), "{:?} for {:?}", read, meant);
        }
    }

    #[test]
    fn every_layout_reads_back_as_the_same_drawing(
        ops in on_the_grid(),
        points_per_command in 0..6_u16,
        coordinates in prop::sample::select(vec![Coordinates::Relative, Coordinates::Encoded]),
    ) {
        let options = WriteOptions {
            points_per_command,
            opening: Opening::Full,
            coordinates,
            ..WriteOptions::default()
        };
        let mut writer = Writer::with_options(String::new(), options);
        for op in &ops {
            writer.push(*op)?;
        }
        let text = writer.finish()?;
        prop_assert!(text.starts_with("IN;\nDF;\nPA;\n"));
        let read = |text: &str| plot_ops(text.as_bytes()).collect::<Result<Vec<_>, Error>>();
        prop_assert_eq!(read(&text)?, read(&written(&ops)?)?);
    }

    #[test]
    fn any_drawing_is_read_back_to_half_a_unit(ops in drawing(-1000.0..1000.0, 0.006..100.0)) {
        let read: Vec<PlotOp> = plot_ops(written(&ops)?.as_bytes()).collect::<Result<_, Error>>()?;
        let meant = with_frame(&ops);
        prop_assert_eq!(read.len(), meant.len());
        for (read, meant) in read.iter().zip(&meant) {
            if let (Some(at), Some(to)) = (read.target(), meant.target()) {
                OFF.note((at.x - to.x).abs().max((at.y - to.y).abs()));
            }
            prop_assert!(near(read, meant, HALF_UNIT_MM, HALF_SPEED_STEP_MM_S), "{:?} for {:?}", read, meant);
        }
    }

    #[test]
    fn writing_what_was_read_gives_the_same_text(ops in on_the_grid()) {
        let text = written(&ops)?;
        let read: Vec<PlotOp> = plot_ops(text.as_bytes()).collect::<Result<_, Error>>()?;
        // The pen put away at the end is the writer's own.
        prop_assert_eq!(written(&read[..read.len() - 1])?, text);
    }

    #[test]
    fn the_layout_of_a_command_does_not_matter(
        commands in proptest::collection::vec(
            (prop::sample::select(vec!["PU", "PD", "PA", "CI", "SC"]), proptest::collection::vec(-99_999..99_999_i32, 0..6)),
            1..20,
        ),
        layout in proptest::collection::vec(0..4_usize, 200),
    ) {
        let (mut plain, mut odd) = (String::new(), String::new());
        let mut choice = layout.iter().cycle().copied();
        for (command, numbers) in commands {
            plain += command;
            odd += &if choice.next() == Some(0) { command.to_lowercase() } else { command.to_string() };
            for (index, number) in numbers.iter().enumerate() {
                plain += &format!("{}{number}", if index > 0 { "," } else { "" });
                let gap = [",", " ", "\r\n", " , "][choice.next().unwrap_or(0)];
                let sign = if choice.next() == Some(0) && *number >= 0 { "+" } else { "" };
                let tail = [".0", ".", "", ".000"][choice.next().unwrap_or(0)];
                let glued = *number < 0 && choice.next() == Some(0);
                odd += &format!("{}{sign}{number}{tail}", if glued { "" } else { gap });
            }
            plain += ";";
            odd += [";", "", "\n", ";;\t"][choice.next().unwrap_or(0)];
        }
        prop_assert_eq!(events(plain.as_bytes()), events(odd.as_bytes()));
    }

    #[test]
    fn decimals_are_read_as_the_nearest_number(value in -1e9..1e9_f64, places in 0..6_usize) {
        let text = format!("{value:.places$}");
        let expected: f64 = text.parse()?;
        prop_assert_eq!(events(format!("PA{text}").as_bytes())[1].parse::<f64>()?, expected);
    }

    #[test]
    fn no_text_does_harm(text in likely_text()) {
        let (mut lines, mut reports) = (0_u64, 0);
        for outcome in PlotOps::with_interpreter(text.iter().copied(), Interpreter::<64>::with_options(Default::default())) {
            match outcome {
                Ok(op) => {
                    lines += 1;
                    prop_assert!(op.target().is_none_or(Point::is_finite), "{op:?}");
                    if let PlotOp::DrawArc { centre, sweep_rad, .. } = op {
                        prop_assert!(centre.is_finite() && sweep_rad.abs() <= std::f64::consts::TAU);
                    }
                }
                Err(error) => {
                    reports += 1;
                    prop_assert!(error.position().offset <= text.len() as u64);
                    prop_assert!(error.to_string().len() > 20);
                }
            }
            // There are texts that fill sheets with dots for a few bytes.
            if lines > MOST_LINES {
                break;
            }
        }
        prop_assert!(reports <= text.len() + 1);
    }

    #[test]
    fn what_a_command_gives_is_bounded(command in likely_command()) {
        let ops = PlotOps::with_interpreter(command.bytes(), Interpreter::<64>::with_options(Default::default()));
        prop_assert!(ops.count() <= MOST_OF_A_COMMAND);
    }

    #[test]
    fn noise_does_no_harm(text in proptest::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(plot_ops(&text).count() <= (text.len() + 1) * MOST_OF_A_CURVE);
    }

    #[test]
    fn a_damaged_byte_costs_what_it_touches_only(ops in on_the_grid(), place in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut text = written(&ops)?.into_bytes();
        let place = place.index(text.len());
        // These have a meaning that reaches beyond a command: an escape or a label that swallows the rest.
        prop_assume!(byte != 0x1b);
        text[place] = byte;
        // The stroke after the damage is drawn if it begins like a drawing of its own: the damage may have
        // made a command that holds for all that follows, such as a scale.
        text.extend_from_slice(b";\x03;\";IN;PU4000,4000;PD4040,4000;PU;");
        let last: Vec<PlotOp> = plot_ops(&text).flatten().collect();
        let stroke = PlotOp::Travel { to: Point::new(100.0, 100.0) };
        prop_assert_eq!(last[last.len() - 3], stroke, "{}", String::from_utf8_lossy(&text));
        let end = Point::new(101.0, 100.0);
        prop_assert_eq!(last[last.len() - 2].target(), Some(end));
        prop_assert_eq!(last[last.len() - 1], PlotOp::Travel { to: end });
    }

    #[test]
    fn garbage_between_commands_loses_nothing(ops in on_the_grid(), every in 1..5_usize) {
        let text = written(&ops)?;
        let mut dirty = String::new();
        let mut inserted = 0;
        for (index, line) in text.lines().enumerate() {
            dirty += line;
            if index % every == 0 {
                dirty += "=1?;\n";
                inserted += 1;
            }
        }
        let clean: Vec<_> = plot_ops(text.as_bytes()).flatten().collect();
        let (good, bad): (Vec<_>, Vec<_>) = plot_ops(dirty.as_bytes()).partition(Result::is_ok);
        prop_assert_eq!(good.into_iter().flatten().collect::<Vec<_>>(), clean);
        prop_assert_eq!(bad.len(), inserted);
    }

    #[test]
    fn a_text_may_arrive_in_any_pieces(text in likely_text(), cut in any::<prop::sample::Index>()) {
        let whole: Vec<_> = plot_ops(&text).collect();
        let (head, tail) = text.split_at(cut.index(text.len() + 1));
        let (mut reader, mut interpreter) = (Reader::new(), Interpreter::new());
        let mut pieces = Vec::new();
        for piece in [head, tail] {
            for event in piece.iter().filter_map(|byte| reader.push(*byte)) {
                interpreter.push(event)?;
                pieces.extend(std::iter::from_fn(|| interpreter.next_op()));
            }
            // Whatever there is to know is in these two: a copy goes on as well as the original.
            (reader, interpreter) = (reader, interpreter.clone());
        }
        if let Some(event) = reader.finish() {
            interpreter.push(event)?;
            pieces.extend(std::iter::from_fn(|| interpreter.next_op()));
        }
        interpreter.finish()?;
        pieces.extend(std::iter::from_fn(|| interpreter.next_op()));
        prop_assert_eq!(pieces, whole);
    }
}

#[test]
fn a_list_of_any_length_needs_no_more_memory() {
    // 18 bytes for each of 1024 places of a polygon, and the rest.
    const BYTES: usize = 1024 * 18 + 4 * 1024;
    const SMALL_BYTES: usize = 64 * 18 + 4 * 1024;
    let list = (0..100_000_u32)
        .flat_map(|i| format!("{},{}", i % 3000, i % 2000).into_bytes().into_iter().chain([b',']));
    let ops = PlotOps::new(b"PD".iter().copied().chain(list).chain(*b"7,7;"));
    assert!(std::mem::size_of::<(Reader, Interpreter)>() < BYTES);
    assert!(std::mem::size_of::<(Reader, Interpreter<64>)>() < SMALL_BYTES);
    assert_eq!(ops.count(), 100_001);
}

/// How far the lines that are compared are from the arcs that are read back, mm.
const CHORDS_MM: f64 = 0.1 / 40.0;
/// What the writer promises for an arc, mm: one unit, and half a one for the plotter's chords; a rounded
/// digit.
const ARC_MM: f64 = 1.5 / 40.0 + 1e-4;

/// Arcs one after the other: each begins where the one before ended, and is a centre's place from there, mm,
/// and a sweep.
fn arcs() -> impl Strategy<Value = Vec<(Vec2, f64)>> {
    let reach = prop_oneof![3 => 0.05..2.0_f64, 3 => 2.0..40.0_f64, 1 => 40.0..3000.0_f64];
    let centre =
        (reach, 0.0..std::f64::consts::TAU).prop_map(|(far, angle)| Vec2::new(far, 0.0).rotated(angle));
    let sweep = prop_oneof![-6.2..6.2_f64, -0.3..0.3_f64];
    proptest::collection::vec((centre, sweep), 1..12)
}

/// Distance of a place from the arc about a centre, from the place `out` from it, by this angle, mm.
fn from_arc(at: Point, centre: Point, out: Vec2, sweep: f64) -> f64 {
    let here = at - centre;
    let angle = out.cross(here).atan2(out.dot(here)) * sweep.signum();
    let within = angle.rem_euclid(std::f64::consts::TAU) <= sweep.abs();
    let ends = at.distance(centre + out).min(at.distance(centre + out.rotated(sweep)));
    if within { (here.length() - out.length()).abs().min(ends) } else { ends }
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn written_arcs_are_read_back_within_a_unit_and_errors_do_not_add_up(
        arcs in arcs(),
        coordinates in prop::sample::select(vec![Coordinates::Absolute, Coordinates::Relative, Coordinates::Encoded]),
    ) {
        let mut writer = Writer::with_options(String::new(), WriteOptions { coordinates, ..Default::default() });
        let mut at = Point::new(50.0123, 47.0077);
        writer.push(PlotOp::Travel { to: at }).unwrap();
        let mut meant = Vec::new();
        for (to_centre, sweep) in &arcs {
            let (centre, out) = (at + *to_centre, -*to_centre);
            at = centre + out.rotated(*sweep);
            writer.arc(centre, *sweep, at, None).unwrap();
            meant.push((centre, out, *sweep, at));
        }
        let text = writer.finish().unwrap();
        let drawn: Vec<Point> = chords(plot_ops(text.as_bytes()).map(Result::unwrap), CHORDS_MM)
            .filter_map(PlotOp::target)
            .collect();
        // Every place drawn, and half way between two of them, is near an arc that is meant.
        for pair in drawn.windows(2) {
            for part in [0.5, 1.0] {
                let place = pair[0] + (pair[1] - pair[0]) * part;
                let off = meant.iter().map(|(centre, out, sweep, _)| from_arc(place, *centre, *out, *sweep));
                let off = off.fold(f64::INFINITY, f64::min);
                prop_assert!(off <= ARC_MM, "{off} mm off at {place:?}\n{text}");
            }
        }
        // Every arc that is meant is near what is drawn, and its end is reached to the half unit.
        for (centre, out, sweep, end) in meant {
            for part in 0..=20 {
                let place = centre + out.rotated(sweep * f64::from(part) / 20.0);
                let off = drawn.windows(2).map(|pair| from_line(place, pair[0], pair[1])).fold(f64::INFINITY, f64::min);
                prop_assert!(off <= ARC_MM, "{off} mm off at {place:?}\n{text}");
            }
            let near = |at: &&Point| (at.x - end.x).abs() <= HALF_UNIT_MM && (at.y - end.y).abs() <= HALF_UNIT_MM;
            prop_assert!(drawn.iter().find(near).is_some(), "{end:?} is not reached\n{text}");
        }
    }
}

fn from_line(at: Point, from: Point, to: Point) -> f64 {
    let way = to - from;
    let part = if way.length() > 0.0 { ((at - from).dot(way) / way.dot(way)).clamp(0.0, 1.0) } else { 0.0 };
    at.distance(from + way * part)
}

#[test]
fn a_circle_of_many_fine_dashes_ends_whole() {
    let text = "PD;LT4,0.0001,1;CI11,-6;";
    let ops = PlotOps::with_interpreter(text.bytes(), Interpreter::<64>::with_options(Default::default()));
    let ops = ops.count();
    assert!((50_000..=MOST_OF_A_COMMAND).contains(&ops), "{ops}");
}
