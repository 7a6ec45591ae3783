//! Laws of the line followers on random drawings, cameras and tables.

use plotter_vector::follow::{
    CameraSettings, End, LineFollower, Lost, MappingFollower, MappingSettings, Paper, SimulatedCamera,
    SimulatedTable, Step, TableError,
};
use plotter_vector::{Gray, PxPoint};
use proptest::prelude::*;

fn place() -> impl Strategy<Value = PxPoint> {
    (0.0..240.0, 0.0..200.0).prop_map(|(x, y)| PxPoint::new(x, y))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Whatever is drawn, it ends within a bound of its lines' length, and no command leaves the area.
    #[test]
    #[ignore = "long: .ci/run has it in release"]
    fn it_ends_and_never_leaves_the_area(
        lines in prop::collection::vec((prop::collection::vec(place(), 2..5), 1.0..9.0), 0..4),
        blur in 0.0..3.0,
        random_px in 0.0..3.0,
        play_px in 0.0..5.0,
        seed in 0_u64..1000,
        start in place(),
    ) {
        let length: f64 = lines.iter().flat_map(|(line, _)| line.windows(2)).map(|pair| pair[0].distance(pair[1])).sum();
        let paper = Paper::drawn(240, 200, &lines).unwrap();
        let settings = CameraSettings::default().with_width_px(120).with_height_px(120).with_blur_px(blur).with_seed(seed);
        let mut camera = SimulatedCamera::new(&paper, settings);
        let mut table = SimulatedTable::new(start, TableError { random_px, play_px, seed });
        let area = [PxPoint::new(10.0, 10.0), PxPoint::new(230.0, 190.0)];
        let mut follower = MappingFollower::new(MappingSettings::default().with_area(Some(area)).with_max_windows(30_000));
        let bound = 2000.0 + 12.0 * length;
        let mut windows = 0.0;
        loop {
            windows += 1.0;
            prop_assert!(windows < bound, "{windows} windows for {length} px");
            match follower.observe(&camera.window(table.place()), table.commanded()) {
                Step::Move { path, tool } => {
                    for to in path {
                        let inside = (10.0..=230.0).contains(&to.x) && (10.0..=190.0).contains(&to.y);
                        prop_assert!(inside, "{to:?}");
                        table.go(to, tool);
                    }
                }
                Step::LineLost { tries, .. } => prop_assert!(tries <= 8),
                Step::Done(end) => {
                    let limited = matches!(end, End::WindowLimit { .. });
                    prop_assert!(!limited);
                    break;
                }
            }
        }
        let report = follower.report();
        let rest = report.seen_px - report.followed_px - report.given_up_px - report.outside_px;
        prop_assert!(rest > -1e-6, "{report:?}");
    }

    /// Any picture at all gets an answer, and the same one again.
    #[test]
    fn noise_is_answered(levels in prop::collection::vec(any::<u8>(), 40 * 40), x in -1e6..1e6, y in -1e6..1e6) {
        let window = Gray::new(40, 40, levels).unwrap();
        let pose = PxPoint::new(x, y);
        let run = || {
            let mut follower = MappingFollower::new(MappingSettings::default());
            (0..5).map(|_| follower.observe(&window, pose)).collect::<Vec<_>>()
        };
        prop_assert_eq!(run(), run());
    }
}

fn ends(window: &Gray) -> (Vec<Step>, End) {
    let mut follower = MappingFollower::new(MappingSettings::default());
    let mut steps = Vec::new();
    for _ in 0..2000 {
        match follower.observe(window, PxPoint::new(5.0, 6.0)) {
            Step::Done(end) => {
                assert_eq!(follower.observe(window, PxPoint::default()), Step::Done(end), "it stays so");
                return (steps, end);
            }
            step => steps.push(step),
        }
    }
    panic!("no end");
}

#[test]
fn a_window_of_one_colour_ends_with_its_place() {
    for level in [0, 128, 255] {
        let (steps, end) = ends(&Gray::new(80, 80, vec![level; 80 * 80]).unwrap());
        assert_eq!(steps.len(), 8, "retried with new pictures");
        assert!(matches!(end, End::NoLine { at, .. } if at == PxPoint::new(5.0, 6.0)), "{end:?}");
        assert!(end.to_string().starts_with("no line in view at (5.0, 6.0) px"), "{end}");
    }
}

#[test]
fn a_window_too_small_is_refused() {
    let (_, end) = ends(&Gray::new(79, 200, vec![255; 79 * 200]).unwrap());
    assert!(matches!(end, End::NoLine { why: Lost::WindowSize, .. }), "{end:?}");
    assert!(end.to_string().contains("too few px a side"), "{end}");
}
