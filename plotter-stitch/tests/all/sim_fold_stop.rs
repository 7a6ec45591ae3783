//! A frame change at which the paper folds: the run stops, asks for a fit by hand, measures anew and goes on.

use plotter_motion::{Axis, PlotOp, Point, Segment, Vec2};
use plotter_stitch::{
    Crossing, Field, FitError, FoldTest, FoldVerdict, FrameTransform, JoinError, LongSheet, MarkSearch,
    Optics, ReferenceLines, RigidFit, SheetSettings, StripJoin,
    sense::SearchSettings,
    sheet::{FeedSettings, FoldCheck, JoinFrames, PublishedJoin, SensedJoint, SensorNoise},
};

fn ours() -> StripJoin {
    StripJoin::new(&ReferenceLines::strip16(), SearchSettings::default())
}

fn folding(share: f64) -> SheetSettings {
    let feed = FeedSettings::default().with_folds(share);
    SheetSettings::default().with_feed(feed)
}

/// A frame with a line on both diagonals' middle: the square must lie beside it.
fn frame() -> impl Iterator<Item = PlotOp> {
    let line = |x: f64| {
        [
            PlotOp::Travel { to: Point::new(x, 0.0) },
            PlotOp::Draw { to: Point::new(x, 950.0), feed_mm_s: None },
        ]
    };
    [900.0, 990.0, 1_030.0].into_iter().flat_map(line)
}

fn stops_and_goes_on<M: JoinFrames>(method: M, within_mm: f64) {
    let mut sheet = LongSheet::new(folding(1.0), method, 11).unwrap();
    for number in 1..=12 {
        sheet.draw(Some(1), frame).unwrap().for_each(drop);
        let first = sheet.next_joint().unwrap();
        assert!(first.fold_mm.is_some());
        let check = sheet.check_fold(&FoldTest::default(), frame).unwrap();
        let FoldCheck::Probed { probe, verdict: FoldVerdict::Fold { .. } } = check else { panic!("{check}") };
        assert!(check.stops() && check.to_string().contains("fit the paper by hand"), "{check}");
        // The probe lies in an empty place, and is drawn where the paper is.
        let [forth, back] = sheet.probe_ops(&probe);
        assert_eq!(forth[1].target(), back[0].target());
        for [from, to] in probe.strokes().map(|ops| ops.map(|op| op.target().unwrap())) {
            let probe = Segment::new(from, to);
            for x in [900.0, 990.0, 1_030.0] {
                let off_mm = (probe.from.x - x).abs().min((probe.to.x - x).abs());
                // The square ends 10 mm beside its middle, the stroke at most 9.
                assert!(off_mm > 1.0, "{probe:?} beside x = {x}");
                assert!((probe.from.x < x) == (probe.to.x < x));
            }
        }
        // Nothing is drawn and nothing moved before somebody has fitted the paper.
        assert_eq!(sheet.draw(Some(1), frame).map(|_| ()), Err(JoinError::Stopped));
        assert_eq!(sheet.next_joint().map(|_| ()), Err(JoinError::Stopped));
        assert_eq!(sheet.check_fold(&FoldTest::default(), frame).map(|_| ()), Err(JoinError::Stopped));
        let anew = sheet.fitted().unwrap();
        assert_eq!((anew.frame, anew.fold_mm), (number, None));
        assert_ne!(anew.truth, first.truth);
        let again = sheet.check_fold(&FoldTest::default(), frame).unwrap();
        let FoldCheck::Probed { probe: other, verdict: FoldVerdict::Flat { .. } } = again else {
            panic!("{again}")
        };
        // Not over the ink of the first probe.
        assert_ne!(probe, other);
        for place in sheet.joint() {
            assert!(anew.discrepancy(place).length() < within_mm, "{:?}", anew.discrepancy(place));
        }
    }
}

#[test]
fn on_a_fold_the_run_stops_and_goes_on_after_a_fit() {
    stops_and_goes_on(ours(), 0.1);
    stops_and_goes_on(PublishedJoin::default(), 1.2);
}

#[test]
fn without_a_fold_a_sheet_is_checked_and_drawn() {
    let mut sheet = LongSheet::new(folding(0.0), ours(), 3).unwrap();
    for _ in 0..30 {
        sheet.draw(None, frame).unwrap().for_each(drop);
        sheet.next_joint().unwrap();
        assert!(!sheet.check_fold(&FoldTest::default(), frame).unwrap().stops());
    }
    assert_eq!(
        LongSheet::new(folding(0.0), ours(), 3).unwrap().fitted().map(|_| ()),
        Err(JoinError::NoJoint)
    );
}

#[test]
fn a_frame_without_an_empty_square_is_told() {
    let hatching = || {
        (0..=198).flat_map(|n| {
            let x = 10.0 * f64::from(n);
            [
                PlotOp::Travel { to: Point::new(x, 0.0) },
                PlotOp::Draw { to: Point::new(x, 950.0), feed_mm_s: None },
            ]
        })
    };
    let mut sheet = LongSheet::new(folding(1.0), ours(), 5).unwrap();
    sheet.next_joint().unwrap();
    let check = sheet.check_fold(&FoldTest::default(), hatching).unwrap();
    assert!(!check.stops());
    let said = check.to_string();
    assert!(
        said.starts_with("no empty square of 20 mm on the ") && said.contains("marks lie up to 0.0"),
        "{said}"
    );
}

/// Paper that walks to the right is sheared so that folds fall, to the left so that they rise.
#[test]
fn the_diagonal_follows_the_walk() {
    for (walk_mm, along_y) in [(1.0, -1.0), (-1.0, 1.0)] {
        let feed = FeedSettings::default().with_walk_mm([walk_mm, 0.0]).with_turn_rad([0.0; 2]).with_led(0.0);
        let settings = SheetSettings::default().with_feed(feed).with_anchor_mm(0.0);
        let mut ours = LongSheet::new(settings, ours(), 7).unwrap();
        let mut published = LongSheet::new(settings, PublishedJoin::default(), 7).unwrap();
        for _ in 0..5 {
            ours.next_joint().unwrap();
            published.next_joint().unwrap();
            for check in [
                ours.check_fold(&FoldTest::default(), std::iter::empty),
                published.check_fold(&FoldTest::default(), std::iter::empty),
            ] {
                let Ok(FoldCheck::Probed { probe, .. }) = check else { panic!("{check:?}") };
                let [from, to] = probe.strokes()[0].map(|op| op.target().unwrap());
                assert!((to.y - from.y) * along_y > 0.0, "{walk_mm}: {from:?} {to:?}");
            }
        }
    }
}

/// A fold between both sides' marks takes up paper: ours tells nothing, and the published residual shows it.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn marks_that_fold_with_the_paper_are_refused() {
    let crossings: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
    let right_mm = Field::default().right_mm();
    let folded = |crossing: &Crossing, by: Vec2| match crossing.axis {
        Axis::X if crossing.mark_mm > 1_000.0 => Crossing { mark_mm: crossing.mark_mm + by.x, ..*crossing },
        Axis::Y if crossing.scan_at_mm > right_mm => {
            Crossing { mark_mm: crossing.mark_mm + by.y, ..*crossing }
        }
        _ => *crossing,
    };
    for seed in 0..200 {
        // From half a millimetre on the marks must not be believed.
        let taken_mm = 0.5 + 0.01 * seed as f64;
        let by = Vec2::new(-taken_mm, 0.5 * taken_mm);
        let lie: Vec<Crossing> = crossings.iter().map(|crossing| folded(crossing, by)).collect();
        let mut sensed = SensedJoint::new(
            &lie,
            &FrameTransform::IDENTITY,
            Optics::default(),
            SensorNoise::default(),
            seed,
        );
        let mut search = MarkSearch::new(&crossings, SearchSettings::default());
        sensed.run(&mut search).unwrap();
        let told = RigidFit::default().estimate(&crossings, search.found().unwrap());
        assert!(told.is_err(), "{taken_mm} mm: {told:?}");
        let method = PublishedJoin::default();
        let lie: Vec<Crossing> = method.crossings().iter().map(|crossing| folded(crossing, by)).collect();
        let mut sensed = SensedJoint::new(
            &lie,
            &FrameTransform::IDENTITY,
            Optics::default(),
            SensorNoise::default(),
            seed,
        );
        let told = method.join(&mut sensed);
        // Two tacts' ways hide what is less.
        assert!(taken_mm < 1.9 || matches!(told, Err(JoinError::Residual { .. })), "{taken_mm} mm: {told:?}");
    }
}

/// A frame change that is broken off, or at which too few marks are found: nothing is drawn or moved until
/// the marks were found.
#[test]
fn a_broken_frame_change_draws_nothing() {
    let noise = SensorNoise { missed: 0.6, ..SensorNoise::default() };
    let settings = SheetSettings::default().with_noise(noise);
    let mut broken = 0;
    let mut sheet = LongSheet::new(settings, ours(), 2).unwrap();
    for number in 1..=20 {
        sheet.draw(None, frame).unwrap().for_each(drop);
        let before = sheet.drawn();
        let mut told = sheet.next_joint();
        while let Err(error) = told {
            broken += 1;
            assert!(matches!(error, JoinError::Search(_) | JoinError::Fit(_)), "{error}");
            assert_eq!(sheet.drawn(), before);
            assert_eq!(sheet.draw(None, frame).map(|_| ()), Err(JoinError::Unjoined));
            assert_eq!(sheet.next_joint().map(|_| ()), Err(JoinError::Unjoined));
            assert_eq!(sheet.check_fold(&FoldTest::default(), frame).map(|_| ()), Err(JoinError::Unjoined));
            told = sheet.measure_anew();
        }
        let report = told.unwrap();
        assert_eq!(report.frame, number);
        assert!(sheet.joint().into_iter().all(|place| report.discrepancy(place).length() < 0.15));
    }
    assert!(broken >= 5, "{broken}");
    // A search that was not finished tells nothing.
    let crossings: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
    let search = MarkSearch::new(&crossings, SearchSettings::default());
    assert!(search.found().unwrap_err().to_string().contains("not over yet"));
}

/// Paper that has shrunk looks as if it had folded between the marks: the run stops until somebody has
/// looked. Paper that has swollen does not.
#[test]
fn who_has_seen_flat_paper_may_say_so() {
    let feed = FeedSettings::default().with_swelling(2e-4);
    let settings = SheetSettings::default().with_feed(feed).with_anchor_mm(0.0);
    let (mut doubted, mut told) = (0, 0);
    for seed in 0..80 {
        let mut sheet = LongSheet::new(settings, ours(), seed).unwrap();
        let report = match sheet.next_joint() {
            Ok(report) => report,
            Err(JoinError::Fit(FitError::Shrunk { shrunk, effect_mm, .. })) => {
                doubted += 1;
                assert!(effect_mm > 0.25 && shrunk > 2.4e-4, "{shrunk}");
                assert_eq!(sheet.draw(None, frame).map(|_| ()), Err(JoinError::Unjoined));
                let report = sheet.seen_flat().unwrap();
                // It is said of this joint alone.
                assert!(!format!("{sheet:?}").contains("is_flat: true"));
                report
            }
            Err(error) => panic!("{error}"),
        };
        told += 1;
        // Where the middle lies; the ends swell away from it.
        let [left, right] = sheet.joint();
        let off_mm = report.discrepancy(left.lerp(right, 0.5)).length();
        assert!(off_mm < 0.06, "{off_mm}");
        sheet.draw(None, frame).unwrap().for_each(drop);
    }
    // An eighth of normal numbers lies 1.15 deviations below their mean: 10 of 80, known to 3.
    assert!((1..=19).contains(&doubted) && told == 80, "{doubted}, {told}");
}

/// A stain over any one mark of ours is left out; over the left border of the published ones it is refused.
#[test]
fn a_stain_over_a_mark_does_no_harm() {
    // 8 mm of dark: lines closer to each other than they are wide.
    let stain = |middle: Point| -> Vec<Segment> {
        let line = |n: u32| {
            let y = middle.y - 4.0 + 0.25 * f64::from(n);
            Segment::new(Point::new(middle.x - 4.0, y), Point::new(middle.x + 4.0, y))
        };
        (0..=32).map(line).collect()
    };
    let place = |crossing: &Crossing| match crossing.axis {
        Axis::X => Point::new(crossing.mark_mm, crossing.scan_at_mm),
        Axis::Y => Point::new(crossing.scan_at_mm, crossing.mark_mm),
    };
    let lies = FrameTransform::new(0.0005, Vec2::new(0.4, -1.0)).unwrap();
    let sensed = |crossings: &[Crossing], at: Point| {
        SensedJoint::new(crossings, &lies, Optics::default(), SensorNoise::default(), 4).with_drawing(
            crossings,
            &lies,
            &stain(at),
        )
    };
    let method = ours();
    for crossing in method.crossings() {
        let told = method.join(&mut sensed(method.crossings(), place(crossing))).unwrap();
        assert!((14..=15).contains(&told.marks), "{crossing}: {}", told.marks);
        for end in Field::default().joint() {
            assert!(told.transform.to_machine(end).distance(lies.to_machine(end)) < 0.075, "{crossing}");
        }
    }
    let method = PublishedJoin::default();
    let said = method.join(&mut sensed(method.crossings(), place(&method.crossings()[0]))).unwrap_err();
    assert!(
        matches!(said, JoinError::Residual { .. }) && said.to_string().contains("look for a stain"),
        "{said}"
    );
}
