//! Written HPGL for people to look at.

use crate::figure::Figure;
use plotter_motion::hpgl::{Writer, plot_ops, write_ops};
use plotter_motion::{
    PlotOp, Point, Vec2,
    toolpath::{circle, rectangle},
};

#[test]
fn a_small_sheet_reads_like_a_drawing() {
    let dot = Point::new(12.5, 0.0);
    let slowly = |op| match op {
        PlotOp::Draw { to, .. } => PlotOp::Draw { to, feed_mm_s: Some(12.5) },
        other => other,
    };
    let frame = rectangle(Point::new(-5.0, -5.0), 35.0, 10.0);
    let wheel = circle(Point::new(10.0, 0.0), 2.5, 24).map(slowly);
    let hub = [PlotOp::Travel { to: dot }, PlotOp::Draw { to: dot, feed_mm_s: None }];
    let second_sheet = [PlotOp::NewPage, PlotOp::Travel { to: Point::ORIGIN }];
    let ops = frame.chain([PlotOp::SelectPen { pen: 2 }]).chain(wheel).chain(hub).chain(second_sheet);

    let mut text = String::new();
    write_ops(ops, &mut text).expect("every point is in range");
    insta::assert_snapshot!(text, @r"
    IN;
    SP1;
    PU-200,-200;
    PD-200,200,1200,200,1200,-200,-200,-200;
    PU;
    SP2;
    PU400,0;
    VS1.25;
    PD403,26,413,50,429,71,450,87,474,97,500,100,526,97,550,87,571,71,587,50,597,26,600,0,597,-26,587,-50,571,-71,550,-87,526,-97,500,-100,474,-97,450,-87;
    PD429,-71,413,-50,403,-26,400,0;
    PU500,0;
    VS;
    PD;
    PU;
    PG;
    PU0,0;
    PU;
    SP0;
    ");
}

static OFF: Figure = Figure::of("units off");

/// No centre in whole units is as far from where the pen stands as from where it should end, and a single
/// corner half way is 1.85 units off.
#[test]
fn a_short_arc_of_a_large_circle_that_no_centre_fits_is_chords() {
    let (from, to_centre) = (Point::new(101.4870, 35.2088), Vec2::new(83.0421, 114.0791));
    let (centre, sweep) = (from + to_centre, -0.113_13);
    let mut writer = Writer::new(String::new());
    writer.push(PlotOp::Travel { to: from }).unwrap();
    writer.arc(centre, sweep, centre + (-to_centre).rotated(sweep), None).unwrap();
    let text = writer.finish().unwrap();
    assert!(!text.contains("AA"), "{text}");
    let drawn: Vec<Point> =
        plot_ops(text.as_bytes()).map(Result::unwrap).filter_map(PlotOp::target).collect();
    for pair in drawn[1..].windows(2) {
        for place in [pair[1], pair[0] + (pair[1] - pair[0]) * 0.5] {
            // Half a unit for the chords, and the rounding of both directions.
            let off = (place.distance(centre) - to_centre.length()).abs() * 40.0;
            OFF.note(off);
            assert!(off <= 1.21, "{off} units off\n{text}");
        }
    }
}
