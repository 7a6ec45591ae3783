//! The interpreter of G-code: command by command.

use plotter_motion::PlotOp;
use plotter_motion::gcode::{
    BlockDelete, DwellUnit, Interpreter, LaserCommand, PenConvention, PlotOps, ReadOptions, Reader,
    ServoCommand, Undrained,
};

fn shown(op: Result<PlotOp, plotter_motion::gcode::Error>) -> String {
    let speed = |feed: Option<f64>| feed.map_or_else(String::new, |feed| format!("@{feed}"));
    // To the nm, and never -0.
    let number = |mm: f64| (mm * 1e6).round() / 1e6 + 0.0;
    match op {
        Ok(PlotOp::Travel { to }) => format!("U{},{}", number(to.x), number(to.y)),
        Ok(PlotOp::Draw { to, feed_mm_s }) => {
            format!("D{},{}{}", number(to.x), number(to.y), speed(feed_mm_s))
        }
        Ok(PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s }) => format!(
            "A{},{}about{},{}by{}{}",
            number(to.x),
            number(to.y),
            number(centre.x),
            number(centre.y),
            (sweep_rad.to_degrees() * 100.0).round() / 100.0,
            speed(feed_mm_s)
        ),
        Ok(PlotOp::LaserPower { share }) => format!("L{share}"),
        Ok(PlotOp::SelectPen { pen }) => format!("S{pen}"),
        Ok(PlotOp::Dwell { duration }) => format!("W{duration:?}"),
        Ok(PlotOp::NewPage) => "N".to_string(),
        Ok(other) => format!("{other:?}"),
        Err(error) => format!("<{error}>"),
    }
}

/// Operations in short: `U` travel, `D` draw, `A` arc, `L` laser, `S` pen, `W` wait, `N` page; errors in
/// `<>`.
fn by(options: ReadOptions, text: &str) -> String {
    PlotOps::with_options(text.bytes(), options).map(shown).collect::<Vec<_>>().join(" ")
}

fn pen(pen: PenConvention) -> ReadOptions {
    ReadOptions { pen, ..ReadOptions::default() }
}

/// `G0` travels and `G1` draws.
fn ops(text: &str) -> String {
    by(pen(PenConvention::Motion), text)
}

#[test]
fn motion_units_and_the_kind_of_coordinates_last_from_line_to_line() {
    assert_eq!(ops("G0 X1 Y2\nX3\ng1y4F600\nX5"), "U1,2 U3,2 D3,4@10 D5,4@10");
    assert_eq!(ops("G1 X1 Y1 F60\nG91\nX2 Y2\nX-1\nG90 X1"), "D1,1@1 D3,3@1 D2,3@1 D1,3@1");
    assert_eq!(ops("G20 G1 X1 F60\nG21 X1\nF120 X2"), "D25.4,0@25.4 D1,0@25.4 D2,0@2");
    // Units count for the whole line, wherever they stand in it.
    assert_eq!(ops("G1 X1 G20 Y2"), "D25.4,50.8");
    assert_eq!(ops("G1 F600\nG1 X5\nG93\nG1 X6 F30\nG94\nG1 X7 F60"), "D5,0@10 D6,0@0.5 D7,0@1");
    // By the turn of a spindle no speed is told, in this line and in later ones.
    assert_eq!(
        ops("G1 X5 F600\nG95 X6 F0.1\nX7 F0.2\nG94 X8 F60"),
        "D5,0@10 D6,0 <line 2, column 1 (byte 11): G95 (feed rate per revolution) is not supported and is left out> D7,0 D8,0@1"
    );
}

#[test]
fn zero_can_be_moved() {
    assert_eq!(ops("G0 X10 Y10\nG92 X0 Y0\nG1 X1 Y1\nG92.1\nX1 Y1"), "U10,10 D11,11 D1,1");
    assert_eq!(ops("G0 X10 Y10\nG92 X0\nG1 X1 Y1\nG53 X1 Y1"), "U10,10 D11,1 D1,1");
    assert_eq!(ops("G20\nG0 X1\nG92 X0.5\nX0.5 Y1"), "U25.4,0 U25.4,25.4");
    assert_eq!(ops("G0 X5 Y6\nG92\nG0 X1"), "U5,6 U6,6");
}

#[test]
fn homing_travels_to_the_origin_by_the_axes_it_names() {
    assert_eq!(ops("G0 X5 Y6\nG28"), "U5,6 U0,0");
    assert_eq!(ops("G0 X5 Y6\nG28 X\nG28 Y0"), "U5,6 U0,6 U0,0");
    assert_eq!(ops("G0 X5 Y6\nG91 G28 Z0\nG30"), "U5,6 U0,0");
    let height = pen(PenConvention::Height { threshold_mm: 0.0 });
    assert_eq!(by(height, "G1 Z-1 X1\nX2\nG28 Z\nX3"), "U1,0 D2,0 U3,0");
}

#[test]
fn arcs_by_centre_and_by_radius() {
    assert_eq!(ops("G0 X10\nG3 X0 Y10 I-10 J0 F60"), "U10,0 A0,10about0,0by90@1");
    assert_eq!(ops("G0 X10\nG2 X0 Y10 I-10"), "U10,0 A0,10about0,0by-270");
    assert_eq!(ops("G0 X10\nG3 X0 Y10 R10"), "U10,0 A0,10about0,0by90");
    assert_eq!(ops("G0 X10\nG3 X0 Y10 R-10"), "U10,0 A0,10about10,10by270");
    assert_eq!(ops("G0 X10\nG2 X0 Y10 R10"), "U10,0 A0,10about10,10by-90");
    // A whole circle, with its end and without; and modal.
    assert_eq!(ops("G0 X10\nG2 X10 Y0 I-5\nI5"), "U10,0 A10,0about5,0by-360 A10,0about15,0by-360");
    assert_eq!(ops("G0 X10 Y5\nG90.1\nG3 X0 Y15 I0 J5"), "U10,5 A0,15about0,5by90");
    assert_eq!(ops("G20 G0 X1\nG3 X0 Y1 I-1"), "U25.4,0 A0,25.4about0,0by90");
    assert_eq!(ops("G92 X5\nG0 X10\nG90.1 G3 X0 Y10 I0 J0"), "U5,0 A-5,10about-5,0by90");
}

#[test]
fn arcs_that_are_none_are_named() {
    insta::assert_snapshot!(
        ops("G0 X10\nG3 X0 Y10 R7\nG0 X10 Y0\nG3 X0 Y10 I-9\nG0 X10 Y0\nG3 X0 Y10\nG3 X0 Y10 R5\nG3 X0 Y1 R5 I2")
            .replace("> ", ">\n"),
        @r#"
    U10,0 <line 2, column 1 (byte 7): an arc of a radius of 7.000 mm does not reach its end: it needs 7.071 mm or more>
    U0,10 U10,0 <line 4, column 1 (byte 30): an arc begins 9.000 mm from its centre and ends 10.050 mm from it: check I and J, which count from its beginning>
    U0,10 U10,0 <line 6, column 1 (byte 54): an arc needs its centre, I and J, or its radius, R, and not both>
    U0,10 <line 7, column 1 (byte 64): an arc that ends where it begins needs its centre, I and J: a radius does not tell it>
    U0,10 <line 8, column 1 (byte 77): an arc needs its centre, I and J, or its radius, R, and not both>
    U0,1
    "#
    );
}

#[test]
fn a_spindle_for_a_pen_marks_while_it_is_on() {
    let text = "M5\nG0 X1\nM3 S90\nG4 P0.15\nG1 X2 F60\nG0 X3\nM5\nG4 P0.15\nG0 X9\nM03\nM05\nG4 P2";
    assert_eq!(by(ReadOptions::default(), text), "U1,0 D2,0@1 D3,0 U9,0 D9,0@1 U9,0 W2s");
    // The first wait after the pen was moved is the pen's, if it is short; milliseconds where the text counts
    // them.
    let millis = ReadOptions { dwell_unit: DwellUnit::Milliseconds, ..ReadOptions::default() };
    assert_eq!(by(millis, "M3\nG4 P150\nG4 P150\nG1 X1\nG4 P20\nG4 S1"), "D0,0 W150ms D1,0 W20ms W1s");
}

#[test]
fn heights_mark_from_end_to_end_or_not_at_all() {
    let height = pen(PenConvention::Height { threshold_mm: 0.0 });
    assert_eq!(by(height, "G0 Z5\nG0 X1\nG1 Z-1\nX2\nX3 Z5\nX4 Z0\nX5"), "U1,0 D2,0 U3,0 U4,0 D5,0");
    assert_eq!(by(height, "G0 X1 Y1\nG1 Z0\nG0 Z2\nG20\nG1 Z-0.1\nX1"), "U1,1 D1,1 D25.4,1");
    assert_eq!(by(height, "G91\nZ1\nZ-2\nX1\nZ1\nX1\nZ0.5\nX1"), "D1,0 D2,0 U3,0");
}

#[test]
fn servos_go_where_they_are_told() {
    let servo = |command, up, down| pen(PenConvention::Servo { command, up, down });
    let unicorn = pen(PenConvention::UNICORN);
    assert_eq!(
        by(unicorn, "G1 X1\nM300 S30.00 (pen down)\nG1 X2\nM300 S50\nM300 S255\nX3"),
        "U1,0 D2,0 U3,0"
    );
    let marlin = servo(ServoCommand::M280, 90.0, 10.0);
    assert_eq!(by(marlin, "M280 P0 S10\nG1 X1\nM280 P0 S90\nG1 X2"), "D1,0 U2,0");
    let mdraw = pen(PenConvention::MDRAW);
    let text = "M2 U160 D90\nM1 160\nG1 X1.00 Y2.00 A0\nM1 90\nG1 X3.00 Y4.00\nM1 160\nM5 A0 B1 H310 W380 S50\nM3 0\nM10\nM11\nG28";
    assert_eq!(by(mdraw, text), "U1,2 D3,4 U0,0");
    let angle = servo(ServoCommand::M3, 30.0, 90.0);
    assert_eq!(by(angle, "M3 S30\nG1 X1\nM3 S90\nG1 X2\nS30\nG1 X3\nM5\nG1 X4"), "U1,0 D2,0 U3,0 U4,0");
    let makeblock = servo(ServoCommand::Z, 90.0, 130.0);
    assert_eq!(by(makeblock, "G1 Z90\nG1 X1\nG1 Z130\nG1 X2\nG1 Z90\nX3"), "U1,0 D2,0 U3,0");
}

#[test]
fn a_laser_draws_by_g1_while_it_has_power() {
    let laser = pen(PenConvention::GRBL_LASER);
    assert_eq!(
        by(laser, "M4 S0\nG0 X1\nG1 X2 S500 F60\nX3 S0\nX4 S1000\nX5\nG0 X6\nG1 X7\nM5\nG1 X8"),
        "U1,0 L0.5 D2,0@1 U3,0 L1 D4,0@1 D5,0@1 U6,0 D7,0@1 U8,0"
    );
    // By M3 it burns while it stands, by M4 it does not; and by G0 never.
    assert_eq!(by(laser, "G1 F60\nM3 S100\nG4 P0.2\nM5\nM4 S100\nM5\nG0\nM3 S9\nM5\nS2000 M3\nG1 X1"), {
        "L0.1 D0,0@1 L1 D1,0@1"
    });
    // What it burns while it stands has the power of that time.
    assert_eq!(by(laser, "G1 F60\nM3 S1000\nG4 P0.2\nS10\nG1 X1\nM5"), "L1 D0,0@1 L0.01 D1,0@1 U1,0");
    let fan = pen(PenConvention::Laser { command: LaserCommand::Fan, full: 255.0 });
    assert_eq!(
        by(fan, "G1 X1\nM106 S51\nG1 X2\nM107\nX3\nM106\nX4\nM106 S0\nX5"),
        "U1,0 L0.2 D2,0 U3,0 L1 D4,0 U5,0"
    );
    let mdraw = pen(PenConvention::Laser { command: LaserCommand::M4, full: 255.0 });
    assert_eq!(by(mdraw, "M4 0\nG1 X1\nM4 51\nG1 X2 A300\nM4 0"), "U1,0 L0.2 D2,0");
}

#[test]
fn tools_pauses_and_ends() {
    assert_eq!(ops("T2 M6\nT3\nG1 X1\nM6\nM0 (pen 4)\nM0 (New sheet)\nM6"), "S2 D1,0 S3 S4 N S3");
    // A pen is named in a line of its own too, or it is a remark.
    assert_eq!(ops("(pen 2)\nG1 X1 (pen 3)\n; pen 4\n(new sheet)\n(pen 5 is red)"), "S2 D1,0 S4");
    // The program ends, and what follows is told once.
    assert_eq!(
        by(ReadOptions::default(), "M3\nG91 G0 X1\nM2\n%\nM3\nX4\nX5"),
        "D1,0 U1,0 <line 6, column 1 (byte 21): the program has ended in line 3 by M2 or M30, and what follows is not drawn: take that \
         word away to draw it>"
    );
    assert_eq!(by(ReadOptions::default(), "M3\nX1\nM30\n%\n"), "D1,0 U1,0");
    let named =
        ops("M6\nT300\nT1.5\nM0\nM1 (pen down)\nG4\nG4 P-1\nM104 S200\nM117 X marks it\n$H\nM777\nG1 X1");
    insta::assert_snapshot!(named.replace("> ", ">\n"), @r#"
    <line 1, column 1 (byte 0): M6 needs a T before it: which pen>
    <line 2, column 1 (byte 3): T300 is wrong: a pen is a whole number from 0 to 255>
    <line 3, column 1 (byte 8): T1.5 is wrong: a pen is a whole number from 0 to 255>
    <line 4, column 1 (byte 13): M0 (pause) is not supported and is left out>
    <line 5, column 1 (byte 16): M1 (pause: pen down) is not supported and is left out>
    <line 6, column 1 (byte 30): G4 needs a P: how long>
    <line 7, column 4 (byte 36): P-1 is wrong: a time is not below 0>
    <line 8, column 1 (byte 40): M104 (temperature) is not supported and is left out>
    <line 10, column 1 (byte 66): $ speaks to the controller, not the plotter, and is left out>
    <line 11, column 1 (byte 69): M777 is no known command: check its number>
    D1,0
    "#);
}

#[test]
fn a_line_is_carried_out_whole_or_not_at_all() {
    let named = ops(
        "G91 G1 X1 F60 G0\nG1 X1 X2\nG1 F0 X1\nG21 G20\nG28 G1 X5\nG80\nX5\nG1 X\nG1 Y2 E5 K1\nG77\nG81 X1 Z-1\nX2\nG0 X3\nM3 4\nM3 M5",
    );
    insta::assert_snapshot!(named.replace("> ", ">\n"), @r#"
    <line 1, column 15 (byte 14): G0 excludes G1, which stands before it: divide the line>
    <line 2, column 7 (byte 23): X stands twice: divide the line>
    <line 3, column 4 (byte 29): F0 is wrong: a speed is above 0>
    <line 4, column 5 (byte 39): G20 excludes G21, which stands before it: divide the line>
    <line 5, column 5 (byte 47): G1 excludes G28, which stands before it: divide the line>
    <line 7, column 1 (byte 57): coordinates that no command asks for: put G0 or G1 before them>
    <line 8, column 4 (byte 63): X lacks its number: a word is like `X10`>
    D0,2 <line 9, column 7 (byte 71): E5 means nothing to the commands of its line and is left out>
    <line 10, column 1 (byte 77): G77 is no known command: check its number>
    U1,2 <line 11, column 1 (byte 81): G81 (canned cycle) is not supported and is left out>
    U2,2 U3,2 <line 15, column 4 (byte 109): M5 excludes M3, which stands before it: divide the line>
    "#);
}

#[test]
fn an_origin_is_set_there_or_here_and_g92_counts_from_it() {
    assert_eq!(ops("G10 L2 P1 X5 Y7\nG1 X1 Y1\nG53 X1 Y1"), "D6,8 D1,1");
    assert_eq!(ops("G0 X10 Y10\nG10 L20 P0 X0\nG1 X1 Y1\nG10 P1 L2 X0\nX1"), "U10,10 D11,1 D1,1");
    assert_eq!(ops("G0 X10\nG92 X0\nG10 L20 P1 X2\nG1 X3\nG92.1\nX0"), "U10,0 D11,0 D-2,0");
    assert_eq!(ops("G10 L2 P7 X5\nG59.1 G1 X1\nG59 X1\nG59.3 X2\nG59.1 X2"), "D6,0 D1,0 D2,0 D7,0");
    assert_eq!(ops("G10 L2 P7 X5\nG0 X9\nG59.2\nG10 L20 P0 X0\nG1 X1\nM2"), "U9,0 D10,0 U10,0");
    let other = ops("G10 L1 P1 R1\nG10 L20 X1\nG1 X1").replace("> ", ">\n");
    assert_eq!(other.matches("G10 (another coordinate system) is not supported").count(), 2, "{other}");
    assert!(other.contains("D1,0"), "{other}");
}

#[test]
fn each_coordinate_system_has_its_origin_and_g92_counts_in_all() {
    assert_eq!(ops("G10 L2 P2 X5 Y7\nG1 X1 Y1\nG55 X1 Y1\nG54 X2"), "D1,1 D6,8 D2,8");
    assert_eq!(ops("G10 L2 P6 X5\nG59 G92 X1\nG1 X0\nG54 X0\nG92.1\nX1"), "D-1,0 D-6,0 D1,0");
    assert_eq!(ops("G56\nG10 L20 P0 X-3\nG1 X0\nG54\nX0"), "D3,0 D0,0");
}

#[test]
fn what_follows_a_spline_begins_where_it_ends() {
    assert_eq!(
        ops("M3\nG1 X1\nG5.2 X5 Y5 P1 L3\nG1 Y9").replace("> ", ">\n"),
        "D1,0 <line 3, column 1 (byte 9): the curve of G5.2 needs a G5.3 behind its last point: what of it has not been drawn by \
         then is left out>\nU5,5 D5,9"
    );
}

#[test]
fn a_height_of_the_machine_is_above_the_sheet() {
    let z = ReadOptions { pen: PenConvention::Height { threshold_mm: 0.0 }, ..Default::default() };
    assert_eq!(by(z, "G53 G0 Z0\nG0 X1\nZ0\nG1 X2\nG53 G0 Z0\nG0 X3"), "U1,0 D2,0 U3,0");
}

#[test]
fn lines_after_a_slash_are_left_out_unless_they_are_wanted() {
    assert_eq!(ops("/G1 X1\nG1 X2"), "D2,0");
    let all =
        ReadOptions { block_delete: BlockDelete::CarryOut, pen: PenConvention::Motion, ..Default::default() };
    assert_eq!(by(all, "/G1 X1\n / G1 X2"), "D1,0 D2,0");
}

#[test]
fn a_line_is_refused_while_operations_wait() {
    let (mut reader, mut interpreter) = (Reader::new(), Interpreter::new());
    let blocks: Vec<_> = b"G0 X1\nG0 X2\n".iter().filter_map(|byte| reader.push(*byte)).collect();
    assert_eq!(interpreter.push(blocks[0]), Ok(()));
    assert_eq!(interpreter.push(blocks[1]), Err(Undrained));
    assert_eq!(interpreter.finish(), Err(Undrained));
    while interpreter.next_op().is_some() {}
    assert_eq!(interpreter.finish(), Ok(()));
}
