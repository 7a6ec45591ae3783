//! Ink that no stroke draws: the commands say so and fail; on pictures that are drawn well they never do.

use crate::built_example;

use built_example::{Folder, data, run_example};
use plotter_examples::shared::{lost_ink, vectorized};
use plotter_vector::Vectorizer;

/// A disc of 60 px, which is too wide to be filled by a pen of the 3 px of the lines beside it.
fn blot_and_lines() -> Vec<u8> {
    let is_ink = |x: i32, y: i32| {
        let (away_x, away_y) = (x - 90, y - 100);
        let line = [30, 70, 110, 150].iter().any(|row| (y - row).abs() <= 1) && (180..310).contains(&x);
        line || away_x * away_x + away_y * away_y <= 60 * 60
    };
    let levels =
        (0..220).flat_map(|y| (0..320).map(move |x| (x, y))).map(|(x, y)| u8::from(!is_ink(x, y)) * 255);
    [b"P5 320 220 255\n".to_vec(), levels.collect()].concat()
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn lost_ink_is_said_with_its_place_after_the_files_are_written() {
    let folder = Folder::new();
    let picture = folder.write("blot.pgm", blot_and_lines());
    // The disc is a line by that, and no area.
    let machine =
        folder.write("machine.toml", "schema = 1\nname = \"wide\"\n[vectorize]\nmax_line_px = 192\n");
    let (svg, out) = (folder.file("a.svg"), folder.file("out"));
    for (name, options) in [
        ("trace", vec![picture.as_str(), "--config", &machine, "--svg", &svg]),
        ("plot", vec![picture.as_str(), "--machine", &machine, "--out", &out]),
        ("compare_controllers", vec!["--drawing", picture.as_str(), "--machine", &machine]),
    ] {
        let output = run_example(name, &options);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{name}: {said}");
        for part in ["blot.pgm: ink at (", "from the nearest stroke", "0.5 px were promised"] {
            assert!(said.contains(part), "{name}: {said}");
        }
    }
    assert!(std::fs::read_to_string(svg).unwrap().contains("</svg>"));
    assert!(std::fs::read_to_string(folder.file("out/report.json")).unwrap().contains("vertices"));
    // Nothing is known of the errors then.
    assert!(run_example("trace", &[&picture, "--config", &machine, "--no-errors"]).status.success());
    assert!(run_example("trace", &[&picture, "--algorithm", "published"]).status.success());
    // Usually it is an area.
    assert!(run_example("trace", &[&picture]).status.success());
}

#[test]
fn no_picture_of_the_examples_has_lost_ink() {
    for name in ["flag.png", "technical.png"] {
        let vectorizer = Vectorizer::default();
        let (traced, _) = vectorized(&vectorizer, std::fs::read(data(name)).unwrap(), 1).unwrap();
        let errors = traced.errors.unwrap();
        println!("{name:16} width {:?} px, greatest error {:.2} px", traced.pen_px, errors.report.max_px);
        assert_eq!(lost_ink(&vectorizer, &errors, traced.pen_px, traced.look.is_some()), Ok(()), "{name}");
    }
}
