//! The follower on drawings of many kinds, as the example `follow` does it.

use crate::follow_drawings;
use crate::follow_figures;

use follow_drawings::drawings;
use follow_figures::follow_paper;
use plotter_vector::PxPoint;
use plotter_vector::follow::{CameraSettings, End, MappingSettings, Paper, TableError};

/// With an exact table: the least coverage (a tree whose twigs have several widths, and dots, which are no
/// lines: .974), and the greatest rms (the tree again: .72 px).
const LEAST_COVERAGE: f64 = 0.97;
const MOST_RMS_PX: f64 = 0.75;

/// The table of `docs/results/line-following.md`. `TABLE` is the table's error in px, `DRAWING` a drawing's
/// name; `INTO` a folder into which the drawings are written as pictures.
#[test]
#[ignore = "ten minutes in release: cargo test --release -p plotter-vector --test all follow_kinds:: -- --ignored --nocapture"]
fn drawings_of_many_kinds() {
    let random_px: f64 = std::env::var("TABLE").map_or(0.0, |text| text.parse().unwrap());
    let only = std::env::var("DRAWING").unwrap_or_default();
    let into = std::env::var("INTO").ok();
    println!("| drawing | coverage | followed twice | rms, px | greatest, px | lifts | windows | end |");
    for drawing in drawings().iter().filter(|drawing| only.is_empty() || only == drawing.name) {
        let (width, height) = drawing.size;
        let paper = Paper::drawn(width, height, &drawing.strokes).unwrap();
        if let Some(folder) = &into {
            let mut file = format!("P5 {width} {height} 255\n").into_bytes();
            file.extend(paper.picture().unwrap().pixels());
            std::fs::write(format!("{folder}/{}.pgm", drawing.name.replace(' ', "-")), file).unwrap();
        }
        let far = PxPoint::new(f64::from(width), f64::from(height));
        let settings = MappingSettings::default()
            .with_area(Some([PxPoint::new(0.0, 0.0), far]))
            .with_max_windows(20_000);
        let camera = CameraSettings::default().with_seed(1);
        let error = TableError { random_px, play_px: 3.0 * random_px, seed: 1 };
        let lines: Vec<_> = drawing.strokes.iter().map(|(line, _)| line.clone()).collect();
        let start = PxPoint::new(0.5 * far.x, 0.5 * far.y);
        let run = follow_paper(&paper, &lines, start, camera, error, settings);
        println!("| {} | {}", drawing.name, run.cells());
        assert_eq!(run.end, End::Complete, "{}", drawing.name);
        let judged = run.judged;
        if random_px == 0.0 {
            let (coverage, rms_px) = (judged.coverage, judged.rms_px);
            assert!(
                coverage >= LEAST_COVERAGE && rms_px <= MOST_RMS_PX,
                "{}: {coverage}, {rms_px}",
                drawing.name
            );
        }
    }
}
