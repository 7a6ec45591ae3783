//! Error messages for a machine's file that is wrong.
#![cfg(feature = "toml")]

use insta::assert_snapshot;
use plotter_motion::{Machine, config::TomlError};

/// The refusal of a file with `schema = 1` in line 1 and `rest` below.
fn message(rest: &str) -> String {
    message_of_file(&format!("schema = 1\n{rest}\n"))
}

/// The refusal of a whole file.
fn message_of_file(text: &str) -> String {
    Machine::from_toml(text).map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
}

#[test]
fn a_missing_schema_is_asked_for() {
    let asked = "schema: missing; write `schema = 1` at the top of the file, above all tables";
    assert_eq!(message_of_file(""), asked);
    assert_eq!(message_of_file("[area]\nschema = 1\n"), asked);
}

#[test]
fn a_newer_schema_is_named_before_its_unknown_keys() {
    assert_snapshot!(message_of_file("pens = 8\nschema = 2\n"), @"line 2, column 10: schema: version 2 is not known; this program reads version 1: write `schema = 1`");
}

#[test]
fn a_schema_that_is_no_version_is_refused() {
    assert_snapshot!(message_of_file("schema = \"1\"\n"), @r#"line 1, column 10: schema: the text "1"; write a whole number, without fraction and quotes"#);
    assert_snapshot!(message_of_file("schema = -1\n"), @"line 1, column 10: schema: -1 is not 1; write `schema = 1`");
}

#[test]
fn a_slip_of_the_pen_is_understood() {
    assert_snapshot!(message("[serial]\nbuad = 9600"), @"line 3, column 1: unknown key `serial.buad`; did you mean `baud`?");
    assert_snapshot!(message("[contrl.published]\nkp = 1"), @"line 2, column 2: unknown key `contrl`; did you mean `control`?");
}

#[test]
fn a_section_of_another_crate_is_taken_unread_by_its_name_alone() {
    for section in ["vectorize", "sheet", "follower"] {
        assert_eq!(message(&format!("[{section}]\nsped = -1")), "accepted");
    }
    assert_snapshot!(message("[vektorize]"), @"line 2, column 2: unknown key `vektorize`; did you mean `vectorize`?");
    assert_snapshot!(message("sheet = 3"), @"line 2, column 9: sheet: a whole number; it is a table: write [sheet], and its keys on the lines below");
}

#[test]
fn a_wrong_unit_is_converted() {
    assert_snapshot!(message("[control.contouring]\nfeed_mm_min = 3600"), @"line 3, column 1: unknown key `control.contouring.feed_mm_min`; the unit here is mm/s: write `feed_mm_s = 60`");
    assert_snapshot!(message("x.motor.inertia_g_cm2 = 5.7"), @"line 2, column 9: unknown key `x.motor.inertia_g_cm2`; the unit here is kg m^2: write `inertia_kg_m2 = 0.00000057`");
    assert_snapshot!(message("area.width = 300"), @"line 2, column 6: unknown key `area.width`; did you mean `width_mm`? The unit here is mm");
}

#[test]
fn a_key_in_the_wrong_table_is_shown_its_place() {
    assert_snapshot!(message("feed_mm_s = 60"), @"line 2, column 1: unknown key `feed_mm_s`; `feed_mm_s` belongs under [control.contouring]");
}

#[test]
fn a_value_of_the_wrong_kind_is_refused_with_the_right_one() {
    let width = |value: &str| message(&format!("[area]\nwidth_mm = {value}"));
    assert_snapshot!(width("\"594 mm\""), @r#"line 3, column 12: area.width_mm: the text "594 mm"; write the number alone, without quotes or unit: `width_mm = 594`"#);
    assert_snapshot!(width("\"wide\""), @r#"line 3, column 12: area.width_mm: the text "wide"; write a number in mm"#);
    assert_snapshot!(width("true"), @"line 3, column 12: area.width_mm: true; write a number in mm");
    assert_snapshot!(width("[594]"), @"line 3, column 12: area.width_mm: a list; write a number in mm");
    assert_snapshot!(width("2024-01-01"), @"line 3, column 12: area.width_mm: a date; write a number in mm");
    assert_snapshot!(message("serial.baud = 9600.0"), @"line 2, column 15: serial.baud: a number with fraction; write a whole number in baud, without fraction and quotes");
    assert_snapshot!(message("x = 40"), @"line 2, column 5: x: a whole number; it is a table: write [x], and its keys on the lines below");
    assert_snapshot!(message("[x.encoder]\ndecoding = \"x3\""), @r#"line 3, column 12: x.encoder.decoding: the text "x3"; write "x1" or "x2" or "x4": did you mean "x1"?"#);
    assert_snapshot!(message("name = \"a name that does not fit on its plate\""), @r#"line 2, column 8: name: the text "a name that does not fit on its plate"; 37 bytes are too long, at most 31 fit"#);
}

#[test]
fn a_value_out_of_range_is_named_with_its_line() {
    assert_snapshot!(message("\n[x.motor]\n# it was measured\nresistance_ohm = -1.9"), @"line 5, column 18: x.motor.resistance_ohm: -1.9 ohm lies outside 0.001..=100000 ohm; measure between the motor's terminals: a small motor has 1 to 20");
    assert_snapshot!(message("serial.baud = 99999999999999999999"), @"line 2, column 15: serial.baud: 1e20 baud lies outside 300..=4000000 baud; the documented gantry uses 256000");
    assert_snapshot!(message("control.published.kp = nan"), @"line 2, column 24: control.published.kp: NaN steps/count lies outside 0..=10000 steps/count; for a motor that runs away swap its wires, not the sign");
    assert_snapshot!(message("control.published.kp = 1e300"), @"line 2, column 24: control.published.kp: 1e300 steps/count lies outside 0..=10000 steps/count; for a motor that runs away swap its wires, not the sign");
}

#[test]
fn two_values_that_contradict_each_other_are_named_by_the_one_to_change() {
    assert_snapshot!(message("[y.load]\nstatic_n_m = 1e-4"), @"line 3, column 14: y.load.static_n_m: 0.0001 N m must be at least 0.0013 N m; friction at rest is never less than coulomb_n_m, the friction in motion");
    assert_snapshot!(message("x.counts_per_mm = 200"), @"area.width_mm: 594 mm must be at most 499.995 mm; the serial protocol carries coordinates up to 99999 counts: make the area smaller or x.counts_per_mm less (not in the file: the default holds)");
    assert_snapshot!(message("serial.byte_gap_ms = 100"), @"serial.resync_gap_ms: 100 ms must be more than 100.03906 ms; or every target would be dropped between two bytes: that is serial.byte_gap_ms and one byte's time (not in the file: the default holds)");
}

#[test]
fn what_does_not_go_with_a_belt_is_named_with_its_line() {
    let belt = |rest: &str| message(&format!("[kinematics]\ntype = \"corexy\"\n{rest}"));
    assert_snapshot!(message("[kinematics]\ntype = \"core-xy\""), @r#"line 3, column 8: kinematics.type: the text "core-xy"; write "cartesian" or "corexy": did you mean "corexy"?"#);
    assert_snapshot!(message("[kinematics]\nsign = 1"), @"line 3, column 1: unknown key `kinematics.sign`; did you mean `signs`?");
    assert_snapshot!(belt("[x.encoder]\ndecoding = \"x4\""), @r#"line 5, column 12: x.encoder.decoding: "x4" does not go with kinematics.type = "corexy", whose encoders have one phase and count both its edges: write "x2", and half the pulses of a turn as lines_per_turn"#);
    assert_snapshot!(belt("[x.encoder]\ndecoding = \"x2\"\n[y.encoder]\ndecoding = \"x2\"\n[y]\ncounts_per_mm = 41"), @"line 9, column 17: y.counts_per_mm: 41 counts/mm must be at most 40 counts/mm; both motors drive the same belt: write what x has");
    assert_snapshot!(message("drive = \"stepper\"\n[kinematics]\ntype = \"corexy\""), @r#"line 4, column 8: kinematics.type: "corexy" does not go with drive = "stepper", whose controller moves each axis by its own motor: write "cartesian", or drive = "dc" for the motors of a belt"#);
    assert_snapshot!(message("[belt]\nstart_x_cm = 15"), @"line 3, column 1: unknown key `belt.start_x_cm`; the unit here is mm: write `start_x_mm = 150`");
    assert_snapshot!(message("[point_to_point]\nallowed_error_mm = 0"), @"line 3, column 20: point_to_point.allowed_error_mm: 0 mm lies outside 0.001..=100 mm; the documented marking board has 0.45");
    assert_snapshot!(message("belt.x_rail_coulomb_kn = 1"), @"line 2, column 6: unknown key `belt.x_rail_coulomb_kn`; did you mean `x_rail_coulomb_n`?");
}

#[test]
fn a_machine_is_checked_by_its_kind_of_motor_only() {
    let stepper = "drive = \"stepper\"\narea = { width_mm = 380, height_mm = 310 }\n";
    // No DC motor would do.
    let motor = "y.load.static_n_m = 0.0";
    assert_eq!(message(&format!("{stepper}{motor}")), "accepted");
    assert_snapshot!(message(motor), @"line 2, column 21: y.load.static_n_m: 0 N m must be at least 0.0013 N m; friction at rest is never less than coulomb_n_m, the friction in motion");
    assert_eq!(message("planner.speed_mm_s = 10000.0"), "accepted");
    // A cartesian machine reads no belt.
    assert_eq!(message("belt.start_x_mm = 1000\ny.counts_per_mm = 20"), "accepted");
    // What is not read lies in its range all the same.
    assert!(message(&format!("{stepper}belt.start_x_mm = -1")).contains("lies outside 0..=100000 mm"));
}

#[test]
fn what_a_machine_does_not_read_is_checked_before_it_is_left_out() {
    let read = |rest: &str| plotter_motion::MachineConfig::from_toml(&format!("schema = 1\n{rest}\n"));
    assert_eq!(read("pen.up_deg = 120"), Ok(plotter_motion::MachineConfig::default()));
    assert_snapshot!(read("pen.up_deg = 271").unwrap_err(), @"line 2, column 14: pen.up_deg: 271 deg lies outside 0..=270 deg; a common servo turns from 0 to 180");
}

#[test]
fn text_that_is_not_toml_is_refused_with_its_line() {
    assert_snapshot!(message("[area"), @"line 2, column 6: unclosed table, expected `]`");
    assert_snapshot!(message("serial.baud = 9600 baud"), @"line 2, column 15: string values must be quoted, expected literal string");
}

#[test]
fn a_key_written_twice_is_refused() {
    assert_snapshot!(message("[area]\nwidth_mm = 1\nwidth_mm = 2"), @"line 4, column 1: duplicate key");
}

#[test]
fn the_first_error_of_the_file_is_told_first() {
    let refused = Machine::from_toml("schema = 1\n[y]\nzzz = 1\n[area]\naaa = 1\n").expect_err("refused");
    assert!(matches!(refused, TomlError::UnknownKey { at, .. } if at.line == 3), "{refused}");
}

#[test]
fn a_quoted_key_with_a_dot_is_not_the_key_it_spells() {
    assert_snapshot!(message("\"area.width_mm\" = 1"), @"line 2, column 1: unknown key `area.width_mm`; known here: `schema`, `name`, `drive`, `area`, `serial`, `control`, `sync_stop`, `planner`, `pen`, `laser`, `homing`, `stepper_motor`, `vectorize`, `z`, `second_motor`, `kinematics`, `belt`, `point_to_point`, `sheet`, `follower`, `x`, `y`");
}

#[test]
fn a_message_repeats_no_more_than_a_line_of_a_stranger_s_text() {
    assert!(message(&format!("{} = 1", "a".repeat(100_000))).len() < 400);
    assert!(message(&format!("name = \"{}\"", "a".repeat(100_000))).len() < 400);
    let control = message("\"a\\u001B[31m\" = 1");
    assert!(control.chars().all(|letter| !letter.is_control()), "{control:?}");
}

#[test]
fn a_text_longer_than_any_machine_s_file_is_not_read() {
    assert_snapshot!(message_of_file(&"#".repeat((1 << 20) + 1)), @"1048577 bytes are no machine's file: at most 1048576 are read");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn deep_nesting_is_refused_and_not_followed() {
    for text in [
        format!("schema = 1\n{}a = 1\n", "a.".repeat(300_000)),
        format!("schema = 1\na = {}\n", "[".repeat(500_000)),
        format!("schema = 1\na = {}\n", "{a=".repeat(300_000)),
    ] {
        assert!(matches!(Machine::from_toml(&text), Err(TomlError::Syntax { .. })));
    }
}

#[test]
fn a_jerk_that_cannot_be_limited_as_a_vector_says_why() {
    let refused = |rest: &str| {
        message(&format!("drive = \"stepper\"\narea = {{ width_mm = 380, height_mm = 310 }}\n{rest}"))
    };
    assert_snapshot!(refused("planner.jerk_limit = \"axes\""), @r#"line 4, column 22: planner.jerk_limit: the text "axes"; write "vector" or "path""#);
    assert_snapshot!(refused("[planner]\njerk_limit = \"vector\""), @r#"line 5, column 14: planner.jerk_limit: "vector" goes with planner.mode = "tolerance" only: a corner that is passed through its vertex is a jump of the velocity; write "path", or leave it out"#);
    let averaged = "[planner]\nmode = \"tolerance\"\ns_curve = true\n";
    assert_eq!(refused(averaged), "accepted");
    assert_snapshot!(refused(&format!("{averaged}[laser]\nenabled = true")), @r#"planner.jerk_limit: "vector" does not go with laser.enabled: the steps are averaged, and the laser's power would not follow; write "path" (not in the file: the default holds)"#);
    assert_snapshot!(refused(&format!("{averaged}jerk_limit = \"vector\"\n[z]\nenabled = true")), @r#"line 7, column 14: planner.jerk_limit: "vector" does not go with z.enabled: the steps are averaged, and the third axis would not follow; write "path""#);
    assert_snapshot!(refused(&format!("{averaged}jerk_mm_s3 = 30")), @r#"line 7, column 14: planner.jerk_mm_s3: 30 mm/s^3 must be at least 83 mm/s^3; or more steps are averaged than there is room for: allow more jerk, lower planner.speed_mm_s and planner.travel_speed_mm_s, or write planner.jerk_limit = "path""#);
    for remedy in ["jerk_limit = \"path\"", "jerk_limit = \"path\"\n[laser]\nenabled = true"] {
        assert_eq!(refused(&format!("{averaged}{remedy}")), "accepted");
    }
    assert_eq!(refused(&format!("{averaged}jerk_mm_s3 = 30\njerk_limit = \"path\"")), "accepted");
}

#[test]
fn within_a_tolerance_the_jerk_is_limited_as_a_vector_unless_the_file_says_otherwise() {
    use plotter_motion::planner::JerkLimit::{Path, Vector};
    let limit = |rest: &str| {
        let text = format!(
            "schema = 1\ndrive = \"stepper\"\narea = {{ width_mm = 380, height_mm = 310 }}\nplanner.s_curve = true\n{rest}"
        );
        plotter_motion::PlannerSettings::of(&Machine::from_toml(&text).unwrap()).jerk_limit
    };
    assert_eq!(limit(""), Path);
    assert_eq!(limit("planner.mode = \"exact\"\nplanner.jerk_limit = \"path\""), Path);
    assert_eq!(limit("planner.mode = \"tolerance\""), Vector);
    assert_eq!(limit("planner.mode = \"tolerance\"\nplanner.jerk_limit = \"vector\""), Vector);
    assert_eq!(limit("planner.mode = \"tolerance\"\nplanner.jerk_limit = \"path\""), Path);
}
