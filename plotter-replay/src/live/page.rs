//! [`LivePage`]: the page of a session.

use super::Plan;
use crate::PlotterSettings;
use crate::draw::page::{DRAWN, Desired, Trail, TrailPoint, along, document, pen_bits};
use core::time::Duration;
use plotter_motion::toolpath::chords;
use plotter_motion::{Pen, PenMove, PlotOp, Point};
use serde_json::json;
use std::collections::HashMap;

const BODY: &str = include_str!("../draw/page/assets/live.html");
const PROGRAM: &str = include_str!("../draw/page/assets/live.js");

/// How far a shown chord is from its arc, mm: less than a pixel of the screen at four times the size.
const CHORD_MM: f64 = 0.05;
/// Points of the drawing that the page shows, at most.
const MOST_DESIRED_POINTS: usize = 30_000;

/// What a page shows that does not change: the drawing, and words about the machine. The moves go in one by
/// one, in bounded memory.
///
/// ```
/// # use plotter_motion::{Pen, PenMove, StepPoint};
/// # use plotter_replay::{PlotterSettings, live::LivePage};
/// let mut page = LivePage::new("gantry", PlotterSettings::default());
/// page.push(PenMove { pen: Pen::Up, target: StepPoint::new(400, 0) });
/// page.push(PenMove { pen: Pen::Down, target: StepPoint::new(400, 800) });
/// assert_eq!((page.plan().targets, page.plan().way_mm), (2, 30.0));
/// assert_eq!(page.area_mm(), Some([0.0, 0.0, 10.0, 20.0]));
/// ```
#[derive(Debug)]
pub struct LivePage {
    /// Name of the machine.
    pub title: String,
    /// Whether it is simulated.
    pub is_simulated: bool,
    /// A sentence about what is on the other end of the line.
    pub about: String,
    /// What the emergency stop does to this machine.
    pub stops: String,
    /// Names and values.
    pub facts: Vec<(String, String)>,
    /// Whether the machine is led by hand, too: the page has a panel for it.
    pub has_hand: bool,
    /// Whether the machine is led by lines of text; else it takes targets.
    pub is_lines: bool,
    /// Whether a held key is one long move on which the drive grows.
    pub ramps: bool,
    /// Volts that full duty puts on the motors, where that is known.
    pub supply_v: Option<[f64; 2]>,
    /// Names of pens by their numbers, such as their colours.
    pub pens: Vec<(u8, String)>,
    /// Whether nothing on the line tells where the pen is on its way: the page shows what is known to be
    /// done.
    pub shows_done: bool,
    settings: PlotterSettings,
    meant: Desired,
    /// The drawing in its order, with its pens and travels, along its way.
    order: Trail,
    takes: Option<Duration>,
    plan: Plan,
    at: plotter_motion::Point,
    pen: u8,
    area_mm: Option<[f64; 4]>,
}

impl LivePage {
    /// The page of a machine of this name and scale, without a drawing yet.
    #[must_use]
    pub fn new(title: &str, settings: PlotterSettings) -> Self {
        Self {
            title: title.to_owned(),
            is_simulated: false,
            about: String::new(),
            stops: String::new(),
            facts: Vec::new(),
            has_hand: false,
            is_lines: false,
            ramps: false,
            supply_v: None,
            pens: Vec::new(),
            shows_done: false,
            settings,
            meant: Desired::new(0.5 * settings.x_mm_per_pulse, MOST_DESIRED_POINTS),
            order: Trail::new(0.5 * settings.x_mm_per_pulse, MOST_DESIRED_POINTS),
            takes: None,
            plan: Plan::default(),
            at: settings.p1,
            pen: 1,
            area_mm: None,
        }
    }

    /// Takes the next move of the drawing.
    pub fn push(&mut self, next: PenMove) {
        let to = self.settings.to_sheet(next.target);
        self.plan.targets = self.plan.targets.saturating_add(1);
        self.plan.way_mm += self.at.distance(to);
        if next.pen == Pen::Down {
            self.meant.line(self.at, to);
        }
        self.covers(self.at, to);
        self.at = to;
        self.goes(to, next.pen == Pen::Down, self.pen);
    }

    /// What follows is drawn with this pen.
    pub fn take_pen(&mut self, pen: u8) {
        self.pen = pen;
    }

    fn covers(&mut self, from: Point, to: Point) {
        for at in [from, to] {
            let [x0, y0, x1, y1] = self.area_mm.unwrap_or([at.x, at.y, at.x, at.y]);
            self.area_mm = Some([x0.min(at.x), y0.min(at.y), x1.max(at.x), y1.max(at.y)]);
        }
    }

    /// The next of the drawing in its order, whose way so far is known.
    fn goes(&mut self, to: Point, draws: bool, pen: u8) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let at_us = (self.plan.way_mm * 1e3) as u64;
        let state = if draws { DRAWN | pen_bits(pen) } else { 0 };
        self.order.push(TrailPoint { at_us, x_mm: to.x, y_mm: to.y, state });
    }

    /// Takes the next operation of the drawing, drawn from here with this pen.
    pub fn push_op(&mut self, from: Point, op: PlotOp, pen: u8) {
        let is_travel = matches!(op, PlotOp::Travel { .. });
        let mut at = from;
        let start = PlotOp::Travel { to: from };
        for to in chords([start, op], CHORD_MM).skip(1).filter_map(PlotOp::target) {
            self.plan.way_mm += at.distance(to);
            if !is_travel {
                self.meant.line(at, to);
            }
            self.covers(at, to);
            at = to;
            self.goes(to, !is_travel, pen);
        }
        self.plan.targets = self.plan.targets.saturating_add(1);
    }

    /// How long the drawing takes, by the limits of the machine.
    pub fn takes(&mut self, time: Duration) {
        self.takes = Some(time);
    }

    /// How much the drawing is.
    #[must_use]
    pub fn plan(&self) -> Plan {
        self.plan
    }

    /// What the moves cover, lower left and upper right, mm.
    #[must_use]
    pub fn area_mm(&self) -> Option<[f64; 4]> {
        self.area_mm
    }

    /// The page, which shows `area_mm`, and may open its socket at `sources`.
    #[must_use]
    pub fn finish(self, area_mm: [f64; 4], sources: &str) -> String {
        let (meant, _) = self.meant.finish();
        let (order, _) = self.order.finish();
        let um = |mm: f64| libm::round(mm * 1e3);
        let data = json!({
            "hand": self.has_hand,
            "lines": self.is_lines,
            "ramps": self.ramps,
            "supply_v": self.supply_v,
            "p1": [self.settings.p1.x, self.settings.p1.y],
            "pens": self.pens.iter().map(|(number, name)| (number.to_string(), name)).collect::<HashMap<_, _>>(),
            "by_done": self.shows_done,
            "takes_s": self.takes.map(|time| time.as_secs_f64()),
            "order": {
                "x": order.iter().map(|point| um(point.x_mm)).collect::<Vec<_>>(),
                "y": order.iter().map(|point| um(point.y_mm)).collect::<Vec<_>>(),
                "s": order.iter().map(|point| point.state).collect::<Vec<_>>(),
                "way": order.iter().map(|point| point.at_us).collect::<Vec<_>>(),
            },
            "title": self.title,
            "simulated": self.is_simulated,
            "about": self.about,
            "stops": self.stops,
            "facts": self.facts,
            "box": area_mm,
            "meant": along(&meant),
        });
        document(&format!("{} - live", self.title), BODY, PROGRAM, &data.to_string(), sources)
    }
}
