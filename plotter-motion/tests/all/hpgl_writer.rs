//! Written HPGL for people to look at.

use plotter_motion::hpgl::write_ops;
use plotter_motion::{PlotOp, Point, circle, rectangle};

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
