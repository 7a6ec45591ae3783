//! One text for each kind of G-code that real files hold: what it draws, and what is told of the rest.

use plotter_motion::PlotOp;
use plotter_motion::gcode::{Detection, PenWords, PlotOps, plot_ops};

/// Strokes as the places they go through, `~` before the end of an arc, and what is told in `<>`.
pub(crate) fn drawn(text: &str) -> String {
    strokes(plot_ops(text.as_bytes()).collect())
}

fn strokes(ops: Vec<Result<PlotOp, plotter_motion::gcode::Error>>) -> String {
    // To the µm, and never -0.
    let number = |mm: f64| (mm * 1e3).round() / 1e3 + 0.0;
    let mut strokes = Vec::new();
    let (mut at, mut down) = ((0.0, 0.0), false);
    for op in ops {
        match op {
            Ok(PlotOp::SelectPen { pen }) => strokes.push(format!("pen {pen}")),
            Ok(op) => {
                let Some(to) = op.target() else { continue };
                let place = (number(to.x), number(to.y));
                let draws = matches!(op, PlotOp::Draw { .. } | PlotOp::DrawArc { .. });
                if draws && !down {
                    strokes.push(format!("[{} {}]", at.0, at.1));
                }
                if draws {
                    let line = if matches!(op, PlotOp::DrawArc { .. }) { "~" } else { "" };
                    strokes.push(format!("{line}{},{}", place.0, place.1));
                }
                (at, down) = (place, draws);
            }
            Err(error) => strokes.push(format!("<{}: {}>", error.at.line, error.problem)),
        }
    }
    strokes.join(" ")
}

/// Each text draws what stands beside it.
fn draw(rows: &[(&str, &str)]) {
    for (text, expected) in rows {
        assert_eq!(drawn(text), *expected, "{text}");
    }
}

#[test]
fn which_of_two_words_lifts_is_found_from_what_is_drawn_between_them() {
    draw(&[
        // M3 lifts and M5 lowers, with angles and without; by G1 alone.
        (
            "M3 S80\nG0 X1 Y1\nM5 S0\nG1 X4\nG1 Y3\nM3 S80\nG0 X1 Y4\nM5 S0\nG1 X4\nM3 S80\nG0 X0 Y0",
            "[1 1] 4,1 4,3 [1 4] 4,4",
        ),
        ("M3\nG0 X1\nM5\nG1 X4\nM3\nG0 X0", "[1 0] 4,0"),
        ("M3\nG1 X1\nM5\nG1 X4\nM3\nG1 X6\nM5\nG1 X7\nM3", "[1 0] 4,0 [6 0] 7,0"),
        // M4 lifts, M3 lowers, M5 rests; and the other way round.
        ("M4\nG0 X1\nM3\nG1 X4\nM4\nG0 X6\nM3\nG1 X7\nM4\nM5", "[1 0] 4,0 [6 0] 7,0"),
        ("M3\nG0 X1\nM4\nG1 X4\nM3\nG0 X6\nM4\nG1 X7\nM3\nM5", "[1 0] 4,0 [6 0] 7,0"),
        // The usual sense, by G1 alone too.
        ("M5\nG0 X1\nM3\nG1 X4\nM5\nG0 X0", "[1 0] 4,0"),
        ("M5\nG1 X1\nM3\nG1 X4\nM5\nG1 X0", "[1 0] 4,0"),
        ("M3\nG1 X1\nM5\nG1 X4\nM3\nG1 X6\nM5", "[0 0] 1,0 [4 0] 6,0"),
    ]);
}

#[test]
fn blanks_stand_within_numbers() {
    draw(&[
        ("G0X +1 0. 12 34Y 7\nM3\ng 1 X 2 0 . 5 Y 1 7 F 10 00\nM5", "[10.123 7] 20.5,17"),
        ("M3\nG1 X1 5 ; fifteen\nM5", "[0 0] 15,0"),
        ("M3\nG1 X1 E5\nM5", "[0 0] 1,0 <2: E5 means nothing to the commands of its line and is left out>"),
    ]);
}

#[test]
fn a_comment_in_a_comment_has_a_word_of_its_own() {
    let nested = "a comment begins within a comment, of which controllers end the outer one with the inner one: take the \
                  inner parentheses away";
    draw(&[
        ("(tool change to T1 (end mill) )\nM3\nG1 X1\nM5", "[0 0] 1,0"),
        ("M3 (pen (blue) down)\nG1 X1\n", &format!("<1: {nested}> [0 0] 1,0")),
        ("(a (b) G1 X5\nG1 X1", &format!("<1: {nested}> [0 0] 1,0")),
        ("; a (b (c)\nM3 ; (d (e\nG1 X1", "[0 0] 1,0"),
    ]);
}

#[test]
fn a_pause_shows_its_text() {
    let told = |text: &str, shown: &str| assert_eq!(drawn(text), shown, "{text}");
    for (pause, text) in [
        ("M0 (change pen)", ": change pen"),
        ("M0 Load blue pen", ": Load blue pen"),
        ("M0 Change pen, then click X", ": Change pen, then click X"),
        ("M0 5 minutes", ": 5 minutes"),
        ("M0 'it's dry'", ": 'it's dry'"),
        ("M0 S5 Wait", ": Wait"),
        ("(MSG, wait)\nM0", ": MSG, wait"),
        ("M0", ""),
    ] {
        let line = 1 + pause.matches('\n').count();
        let shown = format!("<{line}: M0 (pause{text}) is not supported and is left out>");
        told(pause, &shown);
    }
    told("M1 put paper", "<1: M1 (pause: put paper) is not supported and is left out>");
    told("M0 Pen 2", "pen 2");
}

#[test]
fn the_end_of_the_program_ends_the_drawing() {
    draw(&[
        ("%\nM3\nG1 X1\nM5\nM30\n%\n", "[0 0] 1,0"),
        (
            "M3\nG1 X1\nM2\nM3\nG1 X2\nG1 X3",
            "[0 0] 1,0 <5: the program has ended in line 3 by M2 or M30, and what follows is not drawn: take that word away to draw it>",
        ),
    ]);
}

#[test]
fn an_arc_out_of_the_sheet_is_its_line_and_ends_at_its_height() {
    draw(&[
        (
            "%\nG90 G94\nG17\nG21\nG0 X50 Y10\nZ15\nG1 Z1 F300\nG18 G3 X48 Z-1 I-2 K0\nG1 X30\nX20 F900\nG17 G2 Y20 J5\nG1 X40\n\
             G18 G2 X42 Z1 I0 K2 F300\nG0 Z15\nG17\nM30\n%",
            "[48 10] 30,10 20,10 ~20,20 40,20",
        ),
        // Coordinates alone are an arc again, in the plane that holds.
        ("M3\nG19 G2 Y5 Z0 J2\nY8 K1\nG17 X2 Y8 I1\nG1 X0", "[0 0] 0,5 0,8 ~2,8 0,8"),
    ]);
}

#[test]
fn a_refused_arc_ends_at_its_end_with_the_pen_up() {
    draw(&[
        (
            "M3\nG1 X10\nG2 X20 Y0 I4\nG2 X30 I5\nM5",
            "[0 0] 10,0 <3: an arc begins 4.000 mm from its centre and ends 6.000 mm from it: check I and J, which count from its \
             beginning> [20 0] ~30,0",
        ),
        (
            "M3\nG91 G1 X10\nG3 X5 R1\nG1 X5\nM5",
            "[0 0] 10,0 <3: an arc of a radius of 1.000 mm does not reach its end: it needs 2.500 mm or more> [15 0] 20,0",
        ),
    ]);
}

#[test]
fn full_turns_are_drawn_as_often_as_p_says() {
    draw(&[
        ("M3\nG2 X10 I5 P3 F600\nG1 X20\nM5", "[0 0] ~0,0 ~0,0 ~10,0 20,0"),
        ("M3\nG3 I5 P2\nM5", "[0 0] ~0,0 ~0,0"),
    ]);
}

#[test]
fn splines_are_curves() {
    // Half way the curve is at an eighth of its ends and three eighths of its control points.
    for (text, middle, end) in [
        ("M3\nG5 I0 J30 P0 Q30 X40 Y0\nM5", (20.0, 22.5), (40.0, 0.0)),
        ("M3\nG5.1 I20 J40 X40 Y0\nM5", (20.0, 20.0), (40.0, 0.0)),
        ("G20 M3\nG91 G5.1 I1 J2 X2\nM5", (25.4, 25.4), (50.8, 0.0)),
    ] {
        let ops: Vec<_> = plot_ops(text.as_bytes()).collect::<Result<_, _>>().unwrap();
        let places: Vec<_> = ops.iter().filter_map(|op| op.target()).map(|to| (to.x, to.y)).collect();
        let near = |place: &(f64, f64), at: (f64, f64)| (place.0 - at.0).hypot(place.1 - at.1) < 1.5;
        assert!(places.iter().any(|place| near(place, middle)), "{text}: {places:?}");
        assert!(places.last().is_some_and(|place| (place.0 - end.0).hypot(place.1 - end.1) < 1e-9), "{text}");
        assert!(ops.len() > 20 && ops.len() < 200, "{text}: {}", ops.len());
    }
    // The second goes on as the first one ends; what follows is a line.
    assert!(drawn("M3\nG5 I0 J3 P0 Q3 X4 Y0\nG5 P0 Q3 X8 Y0\nG1 X9\nM5").ends_with(" 8,0 9,0"));
    assert_eq!(
        drawn("M3\nG5 X4 Y0\nM5").split('<').nth(1),
        Some("2: G5 needs I and J: the way to its first control point> [0 0] 0,0")
    );
}

/// `G5.2` takes a control point a line, weights them by `P`, and is drawn as far as they are known.
#[test]
fn a_nurbs_curve_is_drawn_from_its_control_points() {
    let places = |text: &str| -> Vec<(f64, f64)> {
        let ops: Vec<_> = plot_ops(text.as_bytes()).collect::<Result<_, _>>().unwrap();
        let drawn = ops.iter().filter(|op| matches!(op, PlotOp::Draw { .. }));
        drawn.filter_map(|op| op.target()).map(|to| (to.x, to.y)).collect()
    };
    let weight = std::f64::consts::FRAC_1_SQRT_2;
    // A quarter of a circle of 10 mm, as places, as ways in inches, and scaled to half.
    for (text, radius) in [
        (format!("G0 X10\nM3\nG5.2 P1 L3\nX10 Y10 P{weight}\nX0 Y10\nG5.3\nM5"), 10.0),
        (format!("G20\nG0 X1\nM3\nG91\nG5.2 X0 Y1 P{weight} L2\nX-1 Y1\nG5.3\nM5"), 25.4),
        (format!("G0 X10\nG51 X0 Y0 P0.5\nM3\nG5.2 X20 Y20 P{weight}\nX0 Y20\nG5.3\nG50\nM5"), 10.0),
    ] {
        let places = places(&text);
        assert!(places.len() > 10 && places.len() < 80, "{text}: {}", places.len());
        for (x, y) in &places {
            assert!((x.hypot(*y) - radius).abs() < 1e-9, "{text}: {x} {y}");
        }
        assert!(places.last().is_some_and(|end| (end.0.hypot(end.1 - radius)) < 1e-9), "{text}");
    }
    // Of many points most are drawn before the last one comes; coordinates alone are none afterwards.
    let many: String = (1..200).map(|at| format!("X{at} Y{}\n", at % 2)).collect();
    let text = format!("M3\nG5.2 L4\n{many}G5.3\nX300\nM5");
    assert_eq!(places(&text.replace("X300\n", "")).last(), Some(&(199.0, 1.0)));
    assert!(
        drawn(&text)
            .ends_with(" 199,1 <203: coordinates that no command asks for: put G0 or G1 before them>"),
        "{text}"
    );
    draw(&[
        (
            "M3\nG1 X1\nG5.2 X5 Y5\nG5.3\nG1 X7 Y5\nM5",
            "[0 0] 1,0 <4: G5.2 needs as many control points, with its beginning, as its order L says, 3 without L> [5 5] 7,5",
        ),
        (
            "M3\nG5.2 X5 Y5\nX6 Y6\nG1 X9 Y9\nM5",
            "<2: the curve of G5.2 needs a G5.3 behind its last point: what of it has not been drawn by then is left out> [6 6] 9,9",
        ),
        (
            "M3\nG1 X1\nG5.2 X5 Y5",
            "[0 0] 1,0 <3: the curve of G5.2 needs a G5.3 behind its last point: what of it has not been drawn by then is left out>",
        ),
        ("M3\nG1 X1\nG5.3\nM5", "[0 0] 1,0 <3: G5.3 needs the curve of a G5.2 before it>"),
        (
            "M3\nG1 X1\nG5.2 X5 Y5 P0\nM5",
            "[0 0] 1,0 <3: P0 is wrong: the weight of a control point is above 0>",
        ),
        ("M3\nG1 X1\nG5.2 X5 Y5 L7\nM5", "[0 0] 1,0 <3: L7 is wrong: the order of a curve is at most 6>"),
        ("M3\nG1 X1\nG5.2 X5\nM5", "[0 0] 1,0 <3: G5.2 is wrong: a control point of G5.2 has both X and Y>"),
    ]);
}

/// Where both axes are scaled by other factors an arc is part of an ellipse, and drawn as one.
#[test]
fn arcs_that_are_scaled_unequally_are_parts_of_ellipses() {
    for (text, turned) in [
        ("G0 X20\nM3\nG51 X0 Y0 I2 J0.5\nG2 I-10\nG50\nM5", false),
        ("G0 X20\nM3\nG51 X0 Y0 I-2 J0.5\nG3 I10\nG50\nM5", false),
        ("G0 Y20\nM3\nG51 X0 Y0 I2 J0.5\nG68 X0 Y0 R90\nG3 I-10\nG69 G50\nM5", true),
    ] {
        let ops: Vec<_> = plot_ops(text.as_bytes()).collect::<Result<_, _>>().unwrap();
        let draws: Vec<_> = ops.iter().filter(|op| matches!(op, PlotOp::Draw { .. })).collect();
        assert!(draws.len() > 50 && draws.len() < 200, "{text}: {}", draws.len());
        let places: Vec<_> = draws.iter().filter_map(|op| op.target()).collect();
        let share =
            |x: f64, y: f64| if turned { (y / 20.0).hypot(x / 5.0) } else { (x / 20.0).hypot(y / 5.0) };
        for pair in places.windows(2) {
            assert!((share(pair[0].x, pair[0].y) - 1.0).abs() < 1e-9, "{text}: {:?}", pair[0]);
            // Half way a chord is no farther inside than 0.01 mm, which is most of 5 mm.
            let half = share((pair[0].x + pair[1].x) / 2.0, (pair[0].y + pair[1].y) / 2.0);
            assert!(half < 1.0 && half > 1.0 - 0.01 / 5.0, "{text}: {half}");
        }
    }
    draw(&[
        ("M3\nG51 X0 Y0 I2 J3\nG1 X1 Y1\nG50\nG1 X10 Y0\nM5", "[0 0] 2,3 10,0"),
        (
            "M3\nG1 X1\nG51 I0 J1\nG1 X2\nM5",
            "[0 0] 1,0 <3: I0 is wrong: an axis is scaled by a number from 0.000001 to 1000000, or by its negative> 2,0",
        ),
    ]);
}

/// What a formula comes to is told as a number, where it stands, however great it is.
#[test]
fn great_values_of_formulas_are_told_with_their_numbers_and_places() {
    for (text, told) in [
        (
            "G1 X[2 + 10 ** 999]",
            "line 1, column 13 (byte 12): `10 ** 999` is no number, or one beyond 1.8e308",
        ),
        ("#1 = [1e0]", "line 1, column 8 (byte 7): "),
        ("G1 X[10 ** 300]", "line 1, column 5 (byte 4): X with 1e300: numbers reach from -1000000000"),
        ("G1 X[-2000000000]", "line 1, column 5 (byte 4): X with -2000000000: numbers reach"),
        ("#2 = EXP[1000]", "line 1, column 9 (byte 8): EXP of 1000 is a number beyond 1.8e308"),
        ("G1 X[SQRT[0 - 10 ** 200]]", "line 1, column 10 (byte 9): SQRT of -1e200 is no number"),
        ("G1 X[[0 - 8] ** 0.5]", "line 1, column 14 (byte 13): `-8 ** 0.5` is no number"),
        ("G1 X[1 / [1 - 1]]", "line 1, column 8 (byte 7): a division by 0"),
    ] {
        let error = plot_ops(text.as_bytes()).find_map(Result::err).map(|error| error.to_string());
        assert!(error.as_ref().is_some_and(|error| error.starts_with(told)), "{text}: {error:?}");
    }
    let long = format!("G1 X[1{}]", "0".repeat(400));
    let error = plot_ops(long.as_bytes()).find_map(Result::err).unwrap().to_string();
    assert!(
        error.starts_with("line 1, column ") && error.contains("100000000000000000… lies beyond 1.8e308"),
        "{error}"
    );
}

#[test]
fn coordinates_are_scaled_turned_and_polar() {
    draw(&[
        ("M3\nG51 X0 Y0 P2\nG1 X1 Y2\nG50\nG1 X10\nM5", "[0 0] 2,4 10,4"),
        ("M3\nG51 X10 Y0 I-1 J1\nG1 X1\nG2 X2 I0.5\nG50\nM5", "[0 0] 19,0 ~18,0"),
        ("M3\nG51 P500\nG1 X10\nM5", "[0 0] 5,0"),
        ("M3\nG68 X0 Y0 R90\nG1 X10\nG2 X20 I5\nG69\nG1 X5\nM5", "[0 0] 0,10 ~0,20 5,20"),
        ("M3\nG16\nG1 X10 Y0\nY90\nX20\nG15\nG1 X1 Y1\nM5", "[0 0] 10,0 0,10 0,20 1,1"),
    ]);
}

#[test]
fn coordinate_systems_and_offsets() {
    draw(&[
        (
            "G10 L2 P2 X50 Y40\nG54\nG0 X10 Y10\nM3\nG1 X20\nM5\nG55\nG0 X10 Y10\nM3\nG1 X20\nM5\nM2",
            "[10 10] 20,10 [60 50] 70,50",
        ),
        ("G10 L2 P9 X5\nG59.3\nM3\nG1 X1\nG59\nG1 X2\nM5", "[0 0] 6,0 2,0"),
        ("G52 X5 Y1\nM3\nG1 X1 Y0\nG52 X0 Y0\nG1 X1 Y0\nM5", "[0 0] 6,1 1,0"),
        ("G92 X-5\nM3\nG1 X1\nG92.2\nG1 X1\nG92.3\nG1 X2\nM5", "[0 0] 6,0 1,0 7,0"),
    ]);
}

#[test]
fn drilling_leaves_dots() {
    draw(&[
        (
            "G21 G90 G94\nG0 Z5\nG0 X0 Y0\nG98 G81 X10 Y10 Z-1 R2 F200\nX20 Y10\nX30 Y10\nG80\nG0 Z5\nM30",
            "[10 10] 10,10 [20 10] 20,10 [30 10] 30,10",
        ),
        ("G0 Z5\nG0 X1\nG91 G99 G83 X9 Z-3 R-4 Q1\nX5\nG80 G90\nG1 X0", "[10 0] 10,0 [15 0] 15,0"),
        // By a servo it is told, and gone to.
        (
            "M5\nG0 X1\nM3\nG1 X2\nM5\nG81 X5 Z-1 R2\nX6\nM3\nG1 X7\nM5",
            "[1 0] 2,0 <6: G81 (canned cycle) is not supported and is left out> [6 0] 7,0",
        ),
    ]);
}

#[test]
fn variables_formulas_and_loops_are_reckoned() {
    draw(&[
        ("#1=10\n#<far> = [#1 * 2]\nM3\nG1 X#1 Y-[#1/4]\nG1 X#<far> Y-#1\nM5", "[0 0] 10,-2.5 20,-10"),
        (
            "M3\n#3=15 G1 X#3\nG1 X#3 (all values of a line come before it sets one: #9=1)\nG1 XSQRT[16] Y[2**3 MOD 5]\nM5",
            "[0 0] 0,0 15,0 4,3",
        ),
        ("M3\n#1=0\nO1 while [#1 LT 3]\n#1=[#1+1]\nG1 X[#1*5]\nO1 endwhile\nM5", "[0 0] 5,0 10,0 15,0"),
        ("M3\no<l> repeat [3]\nG91 G1 X1\no<l> endrepeat\nM5", "[0 0] 1,0 2,0 3,0"),
        (
            "M3\n#1=0\nO5 do\n#1=[#1+1]\nO6 if [#1 EQ 2]\nO5 continue\nO6 endif\nG1 X#1\nO5 while [#1 LT 4]\nM5",
            "[0 0] 1,0 3,0 4,0",
        ),
        ("M3\nO1 if [1 GT 2]\nG1 X1\nO1 elseif [2 GT 1]\nG1 X2\nO1 else\nG1 X3\nO1 endif\nM5", "[0 0] 2,0"),
        (
            "O<box> sub\nG91 G1 X#1\nY#2\nX-#1\nY-#2\nG90\nO<box> endsub\n#1=7\nM3\nO<box> call [3] [2]\nG1 X#1\nM5",
            "[0 0] 3,0 3,2 0,2 0,0 7,0",
        ),
        ("O1 sub\nO1 return [#1*2]\nG1 X99\nO1 endsub\nO1 call [4]\nM3\nG1 X#<_value>\nM5", "[0 0] 8,0"),
        (
            "O9 sub\nO1 while [1]\nO2 if [#1 GT 2]\nO1 break\nO2 endif\nG1 X#1\n#1=[#1+1]\nO1 endwhile\nO9 endsub\nM3\nO9 call [1]\nM5",
            "[0 0] 1,0 2,0",
        ),
        // Fanuc's, behind the end of the program.
        ("O0001 (main)\nM3\nM98 P20 L2\nG90 G1 X9\nM5\nM30\nO20\nG91 G1 X1\nM99\n%", "[0 0] 1,0 2,0 9,0"),
        ("M3\nM98 P30020\nM5\nM30\nO20\nG91 G1 X1\nM99\n", "[0 0] 1,0 2,0 3,0"),
    ]);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_a_program_cannot_do_is_told_at_its_place() {
    draw(&[
        ("M3\nG1 X#<far>\nG1 X1", "<2: #<far> has no value: set it before, as in `#<far> = 5`> [0 0] 1,0"),
        ("G1 X[1/0]", "<1: a division by 0>"),
        ("G1 X[1+]", "<1: a value lacks: a number, a variable such as `#1`, or `[…]`>"),
        ("G1 XSQRT[-4]", "<1: SQRT of -4 is no number: it takes a number not below 0>"),
        (
            "#5420=1\nG1 X#5420",
            "<2: #5061 to #5070 and #5420 to #5428 are states of a machine: write the number out>",
        ),
        (
            "O7 call",
            "<1: there is no subprogram `7`: LinuxCNC's begins with `O7 sub`, before its call, and Fanuc's with `O7` in a line of its own, in the same file>",
        ),
        (
            "O1 sub\nO1 call\nO1 endsub\nO1 call",
            "<2: more than 10 subprograms in each other: one of them calls itself>",
        ),
        (
            "O1 if [0]\nG1 X1",
            "<1: its end lacks: every `sub`, `if` and loop has one, with the same number or name>",
        ),
        ("O1 endwhile", "<1: its loop has not begun: its number or name is that of the loop>"),
        (
            "O1 while [1]\nO1 endwhile\nG1 X1",
            "<1: more than a million lines by loops and subprograms, and the program is ended here: check the condition of its loop, or write it out>",
        ),
    ]);
}

/// What follows is searched once, not for each of them: that would be half a billion lines.
#[test]
fn calls_of_what_is_not_there_cost_no_more_than_others() {
    const CALLS: usize = 30_000;
    let text = "M98 P5\n".repeat(CALLS);
    assert_eq!(plot_ops(text.as_bytes()).filter(Result::is_err).count(), CALLS);
}

#[test]
fn a_person_says_which_lines_move_the_pen() {
    let words = |up: &[&str], down: &[&str], text: &str| {
        let words = PenWords::new(up.iter().copied(), down.iter().copied()).unwrap();
        let options = Detection::from_bytes(text.bytes()).options();
        strokes(PlotOps::with_options(text.bytes(), options).with_pen_words(words).collect())
    };
    let klipper = "START_PLOT PEN=1\nG28\nG21\nG90\nPEN_UP\nG1 X10 Y10 F6000\nPEN_DOWN\nG1 X40 Y10 F3000\npen_up\nG1 X10 Y20\n\
                   SET_SERVO  SERVO=pen ANGLE=30\nG1 X40 Y20\nSET_SERVO SERVO=pen ANGLE=90 ; up\nEND_PLOT";
    let named = |name| {
        format!(
            "`{name}` is a command of the controller's own, by its name, and is left out; if it lifts or lowers the pen, say so"
        )
    };
    assert_eq!(
        words(
            &["PEN_UP", "SET_SERVO SERVO=pen ANGLE=90"],
            &["PEN_DOWN", "SET_SERVO SERVO=pen ANGLE=30"],
            klipper
        ),
        format!("<1: {}> [10 10] 40,10 [10 20] 40,20 <14: {}>", named("START_PLOT PEN=1"), named("END_PLOT"))
    );
    for (up, down) in [
        ("M42 P4 S0", "M42 P4 S255"),
        ("M9", "M8"),
        ("M107", "M106"),
        ("M106 S0", "M106"),
        ("M63 P1", "M62 P1"),
        ("M65 P0", "M64 P0"),
        ("M5", "M3"),
        ("M3", "M5"),
        ("M3 S80", "M3 S10"),
        ("G0 Z5", "G1 Z0"),
        ("M10", "M11"),
    ] {
        let text = format!("{up}\nG0 X1 M4\n{down}\nG1 X4\nG1 Y3\n{up}\nG0 X0\n");
        assert_eq!(words(&[up], &[down], &text), "[1 0] 4,0 4,3", "{text}");
    }
    assert!(PenWords::new(["M5"], [""]).is_err());
}
