//! Plot operations as text, for programs that keep drawings in files of their own.

#![cfg(feature = "toml")]

use plotter_motion::{Direction, PlotOp, Point};

#[derive(serde::Deserialize)]
struct Page {
    ops: Vec<PlotOp>,
    home: Direction,
}

#[test]
fn plot_operations_are_read_by_their_names() {
    let page: Page = toml::from_str(
        "home = \"minus\"\n\
         ops = [\"new_page\", { travel = { to = { x = 1.0, y = 2.0 } } }, { draw = { to = { x = 3.0, y = 2.0 } } }]",
    )
    .unwrap();
    assert_eq!(page.home, Direction::Minus);
    let (from, to) = (Point::new(1.0, 2.0), Point::new(3.0, 2.0));
    assert_eq!(
        page.ops,
        [PlotOp::NewPage, PlotOp::Travel { to: from }, PlotOp::Draw { to, feed_mm_s: None }]
    );
}
