//! The virtual plotter on a serial line with faults.

use plotter_motion::kinematics::BeltSigns;
use plotter_motion::protocol::digits;
use plotter_motion::{Axis, Direction, Pen, PlotOp, Point, StepPoint};
use plotter_replay::log::{Event, Record};
use plotter_replay::{
    Canvas, Chart, PlotterSettings, VirtualPlotter,
    compare::Ways,
    draw::Layer,
    virtual_plotter::{AnomalyKind, CountedBy},
};
use proptest::prelude::*;
use std::time::Duration;

/// A recording in the making; each byte comes 40 us after the one before.
#[derive(Default)]
struct Line {
    time: u64,
    records: Vec<Record>,
}

impl Line {
    fn host(mut self, bytes: &[u8]) -> Self {
        for &byte in bytes {
            self.time += 40;
            self.records.push(Record::at_us(self.time, Event::Host(vec![byte])));
        }
        self
    }
    fn target(self, x: i32, y: i32) -> Self {
        self.host(&digits::encode(StepPoint::new(x, y)).unwrap())
    }
    fn says(mut self, text: &str) -> Self {
        for byte in text.bytes() {
            self.time += 40;
            self.records.push(Record::at_us(self.time, Event::Controller(vec![byte])));
        }
        self
    }
    fn event(mut self, event: Event) -> Self {
        self.records.push(Record::at_us(self.time, event));
        self
    }
    fn wait_ms(mut self, ms: u64) -> Self {
        self.time += ms * 1_000;
        self
    }
    fn into(self, mut plotter: VirtualPlotter) -> VirtualPlotter {
        self.records.iter().for_each(|record| plotter.push(record));
        plotter.finish();
        plotter
    }
    fn plotter(self) -> VirtualPlotter {
        self.into(VirtualPlotter::new(PlotterSettings::default()))
    }
}

fn kinds(plotter: &VirtualPlotter) -> Vec<AnomalyKind> {
    plotter.anomalies().iter().map(|anomaly| anomaly.kind.clone()).collect()
}

fn targets(plotter: &VirtualPlotter) -> Vec<(i32, i32)> {
    plotter.targets().iter().map(|(_, target)| (target.x, target.y)).collect()
}

#[test]
fn letters_and_figures_both_count() {
    let plotter = Line::default().target(1, 1).says("1a3c24bd13+").plotter();
    assert_eq!(plotter.raw_counts(), StepPoint::new(1, 1));
    assert_eq!(plotter.anomalies(), []);
}

#[test]
fn a_recording_that_begins_inside_a_target_is_not_shifted() {
    let plotter = Line::default().host(&[7, 7, 7]).target(2, 0).says("11+").target(3, 0).says("1+").plotter();
    assert_eq!(targets(&plotter), [(2, 0), (3, 0)]);
    assert_eq!(kinds(&plotter), [AnomalyKind::BeganInsideTarget { digits: 3 }]);
    let after_an_answer = Line::default().says("+").target(0, 0).says("+").plotter();
    assert_eq!(targets(&after_an_answer), [(0, 0)]);
    assert_eq!(kinds(&after_an_answer), [AnomalyKind::ReachedNothing]);
}

#[test]
fn a_digit_that_the_recorder_lost_costs_one_target() {
    let nine = &digits::encode(StepPoint::new(2, 0)).unwrap()[..9];
    let plotter =
        Line::default().target(1, 0).says("1+").host(nine).says("1+").target(3, 0).says("1+").plotter();
    assert_eq!(targets(&plotter), [(1, 0), (3, 0)]);
    assert_eq!(kinds(&plotter), [AnomalyKind::ReachedInsideTarget { digits: 9 }]);
    assert_eq!(plotter.resynced_counts(), StepPoint::new(3, 0));
}

#[test]
fn noise_is_skipped_and_said() {
    let first = digits::encode(StepPoint::new(12, 0)).unwrap();
    let plotter = Line::default().host(&first[..4]).host(&[0xff]).host(&first[4..]).says("1?1").plotter();
    assert_eq!(targets(&plotter), [(12, 0)]);
    assert_eq!(
        kinds(&plotter),
        [AnomalyKind::NotADigit { byte: 0xff }, AnomalyKind::UnknownReply { byte: b'?' }]
    );
}

#[test]
fn clear_sets_the_position_to_zero_and_drops_a_partial_target() {
    let plotter =
        Line::default().target(2, 0).says("11+").host(&[9, 9]).says("C").target(1, 0).says("1+").plotter();
    assert_eq!(targets(&plotter), [(2, 0), (1, 0)]);
    assert_eq!(plotter.anomalies(), []);
    assert_eq!(plotter.raw_counts(), StepPoint::new(1, 0));
    assert_eq!(plotter.legs().last().unwrap().from, StepPoint::default());
}

#[test]
fn a_silence_inside_a_target_drops_it_and_one_on_the_way_is_reported() {
    let plotter = Line::default()
        .target(1, 0)
        .says("1+")
        .host(&[5, 5])
        .wait_ms(150)
        .target(2, 0)
        .wait_ms(1_500)
        .says("1+")
        .plotter();
    assert_eq!(targets(&plotter), [(1, 0), (2, 0)]);
    let ms = |ms, us| Duration::from_millis(ms) + Duration::from_micros(us);
    assert_eq!(
        kinds(&plotter),
        [
            AnomalyKind::SilenceInsideTarget { silence: ms(150, 40), digits: 2 },
            AnomalyKind::Silence { silence: ms(1_500, 40) },
        ]
    );
}

#[test]
fn the_controllers_own_word_on_its_target_counts_more() {
    let plotter = Line::default().target(20, 0).event(Event::Target { x: 2, y: 0 }).says("11+").plotter();
    let (sent, taken) = (StepPoint::new(20, 0), StepPoint::new(2, 0));
    assert_eq!(kinds(&plotter), [AnomalyKind::TargetDiffers { sent, taken }]);
    assert_eq!(plotter.reached().next().unwrap().error, StepPoint::default());
    let no_digits = Line::default().event(Event::Target { x: 1, y: 0 }).says("1+").plotter();
    assert_eq!((no_digits.reached_count(), no_digits.anomalies().len()), (1, 0));
}

fn drawn_legs(plotter: &VirtualPlotter) -> Vec<Pen> {
    plotter.legs().iter().map(|leg| leg.pen).collect()
}

#[test]
fn the_drawing_or_the_log_tells_the_pen() {
    let line = || Line::default().target(2, 0).says("11+").target(4, 0).says("11+").target(4, 0).says("+");
    assert_eq!(drawn_legs(&line().plotter()), [Pen::Down; 3]);
    let mm = |x| Point::new(x, 0.0);
    let draw = |to| PlotOp::Draw { to, feed_mm_s: None };
    let drawing = [PlotOp::Travel { to: mm(0.05) }, draw(mm(0.1)), PlotOp::Travel { to: mm(0.1) }];
    let plotter = VirtualPlotter::new(PlotterSettings::default()).with_drawing(drawing);
    assert_eq!(drawn_legs(&line().into(plotter)), [Pen::Up, Pen::Down, Pen::Up]);
    let plotter = VirtualPlotter::new(PlotterSettings::default()).with_drawing([draw(mm(7.0))]);
    let strange = line().into(plotter);
    assert_eq!(drawn_legs(&strange), [Pen::Down; 3]);
    assert_eq!(strange.anomaly_count(), 3);

    let recorded = Line::default()
        .event(Event::Pen(Pen::Up))
        .target(2, 0)
        .says("11+")
        .event(Event::Pen(Pen::Down))
        .target(4, 0)
        .says("11+")
        .plotter();
    assert_eq!(drawn_legs(&recorded), [Pen::Up, Pen::Down]);
    let canvas = Canvas::from_plotter(&recorded, 0.0);
    let ink: Vec<_> = canvas.lines(Layer::Ink).collect();
    assert_eq!(ink, [&[Point::new(0.05, 0.0), Point::new(0.1, 0.0)][..]]);
}

#[test]
fn the_present_state_is_known_at_any_time() {
    let settings = PlotterSettings::default().with_p1(Point::new(100.0, 50.0));
    let mut plotter = VirtualPlotter::new(settings);
    let line = Line::default().target(40, 80).says("1333");
    line.records.iter().for_each(|record| plotter.push(record));
    assert_eq!(plotter.next_target(), Some(Point::new(101.0, 52.0)));
    assert_eq!(plotter.position(), Point::new(100.025, 50.075));
    assert_eq!(plotter.resolution_per_mm(), (40.0, 40.0));
    plotter.clear();
    plotter.finish();
    assert!(plotter.legs().is_empty());
    assert_eq!(plotter.position(), Point::new(100.025, 50.075));
}

#[test]
fn a_path_longer_than_the_limit_still_counts() {
    let settings = PlotterSettings::default().with_max_points(100).with_max_entries(5);
    let mut line = Line::default();
    for n in 1..=50 {
        line = line.target(10 * n, 0).says(&"1".repeat(10)).says("+");
    }
    let plotter = line.into(VirtualPlotter::new(settings));
    assert_eq!((plotter.target_count(), plotter.reached_count()), (50, 50));
    assert_eq!(plotter.raw_counts(), StepPoint::new(500, 0));
    assert!(plotter.legs().len() <= 5 && plotter.targets().len() <= 5);
    assert_eq!(kinds(&plotter), [AnomalyKind::PathTooLong]);

    let noise = Line::default().says("????????").into(VirtualPlotter::new(settings));
    assert_eq!((noise.anomalies().len(), noise.anomaly_count()), (5, 8));
}

proptest! {
    #[test]
    fn any_bytes_are_drawn_and_nothing_stops_it(
        bytes in prop::collection::vec((any::<bool>(), any::<u8>(), 0..200_000_u64), 0..300),
    ) {
        let mut time = 0;
        let mut plotter = VirtualPlotter::new(PlotterSettings::default());
        for (host, byte, step) in bytes {
            time += step;
            // Mostly bytes that mean something.
            let byte = if byte < 200 { b"123456+C1324"[usize::from(byte) % 12] } else { byte };
            let event = if host { Event::Host(vec![byte % 12]) } else { Event::Controller(vec![byte]) };
            plotter.push(&Record::at_us(time, event));
        }
        plotter.finish();
        let canvas = Canvas::from_plotter(&plotter, 0.02);
        prop_assert!(canvas.to_svg(&canvas.fitted_style()).ends_with("</svg>\n"));
        prop_assert!(Chart::response("any", &plotter).to_svg().ends_with("</svg>\n"));
        prop_assert!(plotter.contour_error(Ways::All).max_mm.is_finite());
        prop_assert!(plotter.reached_count() <= plotter.target_count());
    }
}

/// A marking board: no digits and no pulses on a line, but targets and edges of the two motors of its belt.
#[test]
fn a_belt_is_drawn_from_its_edges() {
    let settings = PlotterSettings::default()
        .with_belt(Some(BeltSigns::DirectionTable))
        .with_counted_by(CountedBy::Edges)
        .with_x_mm_per_pulse(0.1)
        .with_y_mm_per_pulse(0.1)
        .with_p1(Point::new(150.0, 100.0))
        .with_reached_tolerance_counts(1);
    let edge = |axis| Event::Edge { axis, sign: Direction::Plus };
    let mut line = Line::default().event(Event::Pen(Pen::Down)).event(Event::Target { x: 0, y: 4 });
    for _ in 0..3 {
        line = line.wait_ms(600).event(edge(Axis::Y));
    }
    let plotter = line.says("+").wait_ms(5_000).event(Event::Target { x: 2, y: 4 });
    let plotter = plotter.wait_ms(600).event(edge(Axis::X)).into(VirtualPlotter::new(settings));
    // Motor 2 alone goes right and up; three of four counts are near enough, and from there the counts go on.
    assert_eq!(plotter.position(), Point::new(150.2, 100.1));
    assert_eq!(plotter.anomalies(), []);
    assert_eq!((plotter.target_count(), plotter.reached_count()), (2, 1));
    // The line from (0, 0) to (0, 4) counts is the diagonal, and so is the way.
    assert!(plotter.legs()[0].points.iter().all(|point| point.at.x == 0));
    assert_eq!(plotter.legs()[0].reached.unwrap().error, StepPoint::new(0, -1));
}

#[test]
fn what_was_drawn_is_not_undrawn_though_the_recording_says_the_pen() {
    let draw = |x, y| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
    let drawing = [PlotOp::Travel { to: Point::new(0.025, 0.0) }, draw(0.05, 0.0), draw(0.05, 0.05)];
    let mut plotter = VirtualPlotter::new(PlotterSettings::default()).with_drawing(drawing);
    plotter.push(&Record::at_us(0, Event::Pen(Pen::Up)));
    for (n, x) in [(1, 1), (2, 2)] {
        plotter.push(&Record::at_us(
            n * 1_000,
            Event::Host(digits::encode(StepPoint::new(x, 0)).unwrap().to_vec()),
        ));
        plotter.push(&Record::at_us(n * 1_000 + 500, Event::Controller(b"1+".to_vec())));
        plotter.push(&Record::at_us(n * 1_000 + 600, Event::Pen(Pen::Down)));
    }
    let undrawn: Vec<_> = plotter.undrawn().collect();
    assert_eq!(undrawn, [(Point::new(0.05, 0.0), Point::new(0.05, 0.05))]);
}
