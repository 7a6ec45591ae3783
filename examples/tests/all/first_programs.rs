//! The first programs of a stranger do what their first lines say, by figures that can be checked by hand.

use crate::built_example;

use built_example::{Folder, complaint, data, run_example};
use plotter_motion::MachineConfig;

fn said(name: &str, arguments: &[&str]) -> String {
    let output = run_example(name, arguments);
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn numbers(line: &str) -> Vec<f64> {
    line.split([' ', ',']).filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn a_png_becomes_gcode_within_the_margins_of_a_sheet() {
    let folder = Folder::new();
    let file = folder.file("flag.gcode");
    let told = String::from_utf8(run_example("png_to_gcode", &[&data("flag.png"), &file]).stderr).unwrap();
    assert_eq!(told, "5 strokes, 120 vertices\n"); // as the published table has it for ours at 0.5 px
    let text = std::fs::read_to_string(&file).unwrap();
    let moves: Vec<_> =
        text.lines().filter(|line| line.starts_with("G0 ") || line.starts_with("G1 ")).collect();
    assert_eq!(moves.len(), 120);
    for line in moves {
        let place = |letter: char| -> Option<f64> {
            line.split(' ').find_map(|word| word.strip_prefix(letter))?.parse().ok()
        };
        assert!(place('X').is_none_or(|x| (10.0..=200.0).contains(&x)), "{line}");
        assert!(place('Y').is_none_or(|y| (10.0..=287.0).contains(&y)), "{line}");
    }
    assert!(complaint("png_to_gcode", &[]).contains("which picture?"));
    assert!(complaint("png_to_gcode", &["no/such.png", &file]).contains("No such file"));
}

#[test]
fn steps_have_the_times_of_the_law_of_free_fall_and_come_to_their_place() {
    let told = said("step_times", &[]);
    let steps: Vec<_> = told.lines().map(numbers).collect();
    // 87.58 steps a mm: 10 mm are 876 steps from the origin, 30 mm are 2627, 20 mm are 1752. The way there is
    // one of both motors.
    assert_eq!(steps.len(), 876 + 876 + 1751 + 876 + 1751);
    let sum = |column: usize| -> f64 { steps.iter().map(|step| step[column]).sum() };
    assert_eq!([sum(1), sum(2)], [876.0, 876.0]);
    assert!(steps.is_sorted_by(|a, b| a[0] < b[0]));
    // The first is due after half a step of either motor, from rest.
    let planner = MachineConfig::stepper_plotter().steppers().unwrap().planner;
    let way_mm = 0.5 / 87.58 * f64::sqrt(2.0);
    let time_us = 1e6 * f64::sqrt(2.0 * way_mm / planner.accel_mm_s2);
    assert!((steps[0][0] - time_us).abs() < 2.0, "{} us, by hand {time_us}", steps[0][0]);
}

#[test]
fn a_golden_test_of_an_own_protocol_holds_and_finds_a_change() {
    let folder = Folder::new();
    let file = folder.file("protocol.plog");
    let told = said("golden_protocol", &[&file]);
    assert!(told.starts_with("it answers as recorded\nchanged: "), "{told}");
    assert!(
        told.contains("recorded: byte 0x43 'C' at 1087 us\n  now:      byte 0x44 'D' at 1087 us"),
        "{told}"
    );
    // 2, 3, 5, 7 have the sums 2, 5, 10, 17: C, F, K, R, ten bits of 115200 a second after each.
    let recording = std::fs::read_to_string(file).unwrap();
    for answer in ["1087 < 43", "2087 < 46", "3087 < 4b", "4087 < 52"] {
        assert!(recording.contains(answer), "{recording}");
    }
    assert!(complaint("golden_protocol", &[]).contains("which file"));
}

#[test]
fn a_long_drawing_becomes_frames_and_a_joint_is_told() {
    let told = said("long_drawing", &[]);
    let lines: Vec<_> = told.lines().collect();
    assert_eq!(lines.len(), 13);
    // 9.5 m in frames of 0.95 m: a line of the zigzag goes over each of nine borders.
    let cut: Vec<_> = lines[..10].iter().map(|line| numbers(line)[1]).collect();
    assert_eq!(cut, [0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
    let [shift, turn] = [numbers(lines[10]), numbers(lines[11])];
    assert!((shift[0] + 3.0).abs() < 4.0 * shift[2] && (shift[1] - 4.0).abs() < 4.0 * shift[3], "{told}");
    assert!((turn[0] - 1.2).abs() < 4.0 * turn[1] && turn[1] < 0.01, "{told}");
    // By hand: 100 - 3 - 0.0012 * 950 and 950 + 4 + 0.0012 * 100.
    let corner = numbers(lines[12]);
    assert!((corner[2] - 95.86).abs() < 0.05 && (corner[3] - 954.12).abs() < 0.05, "{told}");
}
