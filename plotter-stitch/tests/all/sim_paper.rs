//! The start of a sketch: paper of any width, somewhere on the table, and what is wrong with some.

use crate::joints::sheet;
use plotter_motion::Point;
use plotter_stitch::{
    Field, Optics, Paper, PaperSearch, ReferenceLines, StripJoin,
    paper::{PaperError, PaperSettings, SensedPaper, Side},
    sense::SearchSettings,
    sheet::{JoinFrames, PublishedJoin, SensedJoint, SensorNoise},
};
use proptest::prelude::*;

fn found(mut paper: SensedPaper) -> Result<Paper, PaperError> {
    let mut search = PaperSearch::new(PaperSettings::default());
    paper.run(&mut search).unwrap();
    search.paper()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any width at any place: the edges are found, the widest field lies on the paper with its marks, and
    /// frames are joined on it.
    #[test]
    fn any_width_at_any_place_is_drawn_on(
        width_mm in 150.0..2_090.0_f64, place in 0.0..1.0_f64, turn_rad in -0.002..0.002_f64, seed in 0_u64..1_000,
    ) {
        // Wherever the head still sees both edges, turned as they are.
        let room_mm = 2_100.0 - width_mm - 2.0 * 2.5;
        let left_mm = -50.0 + 2.5 + room_mm * place;
        prop_assume!(room_mm > 0.0);
        let paper = found(SensedPaper::new([left_mm, left_mm + width_mm], turn_rad, seed)).unwrap();
        // What the turn adds over 970 mm, an edge's waves, and a tact's way.
        const OFF_MM: f64 = 0.97 * 2.0 + 0.4 + 0.3;
        prop_assert!((paper.left_mm - left_mm).abs() < OFF_MM && (paper.right_mm - left_mm - width_mm).abs() < OFF_MM);
        // The head's flashes are 0.3 mm apart and the edge's waves 0.1 mm high: that, and two waves, over
        // half of the rows' way.
        prop_assert!((paper.turn_rad - turn_rad).abs() < 1.05e-3, "{} rad", paper.turn_rad - turn_rad);

        let Field { begin_mm, frame_mm, .. } = Field::default();
        let field = paper.field(paper.widest_mm(), begin_mm, frame_mm).unwrap();
        let lines = ReferenceLines::strip16_on(&field);
        for place in lines.strokes(8.0).chain(PublishedJoin::on(&field, Optics::default()).strokes()).flatten() {
            prop_assert!(place.x > paper.left_mm && place.x < paper.right_mm);
            prop_assert!(place.x >= -50.0 && place.x <= 2_050.0);
        }
        let truth = sheet(seed);
        let told = |method: &dyn Fn(&mut SensedJoint) -> f64, crossings: &[plotter_stitch::Crossing]| {
            let mut sensed = SensedJoint::new(crossings, &truth, Optics::default(), SensorNoise::default(), seed);
            method(&mut sensed)
        };
        let worst_mm = |transform: &plotter_stitch::FrameTransform| {
            field.joint().map(|end| truth.to_machine(end).distance(transform.to_machine(end))).into_iter().fold(0.0, f64::max)
        };
        let ours = StripJoin::new(&lines, SearchSettings::default());
        let ours_mm = told(&|sensed| worst_mm(&ours.join(sensed).unwrap().transform), ours.crossings());
        prop_assert!(ours_mm < 0.075, "{} mm", ours_mm);
        let published = PublishedJoin::on(&field, Optics::default());
        let published_mm = told(&|sensed| worst_mm(&published.join(sensed).unwrap().transform), published.crossings());
        // A tact's way in each reading, whose errors a narrow paper magnifies no more than to its ends.
        prop_assert!(published_mm < 1.2, "{} mm", published_mm);
    }
}

fn said(paper: SensedPaper) -> String {
    found(paper).unwrap_err().to_string()
}

#[test]
fn what_is_wrong_with_the_paper_is_said() {
    let good = || SensedPaper::new([300.0, 1_500.0], 0.001, 3);
    assert!(found(good()).is_ok());
    assert_eq!(
        said(SensedPaper::new([3_000.0, 4_000.0], 0.0, 1)),
        "no paper was seen at y = 20 mm; look whether it is mounted and the lamps shine"
    );
    assert_eq!(
        said(SensedPaper::new([-70.0, 1_500.0], 0.0, 1)),
        "at y = 20 mm the paper's left edge lies beyond -50 mm, where the head does not come; move the rolls, or take narrower paper"
    );
    assert!(said(SensedPaper::new([300.0, 2_060.0], 0.0, 1)).contains("right edge lies beyond 2050 mm"));
    let torn = said(good().torn(Side::Right, [200.0, 300.0], 40.0));
    assert!(torn.starts_with("the paper's right edge is -40.") && torn.contains("at y = 257.5 mm"), "{torn}");
    // A stain over the edge is no edge; one inside the paper does no harm.
    let edge = said(good().stained(Point::new(290.0, 400.0), Point::new(315.0, 600.0)));
    assert!(edge.contains("left edge is 15.") && edge.contains("under a stain"), "{edge}");
    let inside = found(good().stained(Point::new(600.0, 0.0), Point::new(700.0, 1_000.0))).unwrap();
    assert_eq!(inside, found(good()).unwrap());
    assert!(said(SensedPaper::new([300.0, 1_500.0], 0.02, 1)).starts_with("the paper lies askew by 0.02"));
}

#[test]
fn a_drawing_that_is_wider_than_the_paper_is_refused() {
    let paper = found(SensedPaper::new([300.0, 1_500.0], 0.0, 3)).unwrap();
    assert!(matches!(
        paper.field(1_195.0, 20.0, 950.0),
        Err(PaperError::TooNarrow { width_mm: 1_195.0, .. })
    ));
    for width_mm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(paper.field(width_mm, 20.0, 950.0), Err(PaperError::NoWidth { .. })));
    }
    assert!(
        PaperSearch::new(PaperSettings::default()).paper().unwrap_err().to_string().contains("not over yet")
    );
}
