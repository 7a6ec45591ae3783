//! [`MappingFollower`]: a map of the lines, and each of them followed once.

mod seeing;

use self::seeing::Seen;
use super::axes::Axes;
use super::explored::Explored;
use super::flat::Flat;
use super::keyframe::Keyframes;
use super::line_map::{LineMap, State};
use super::lines::{Lines, cosine};
use super::paper::nearest;
use super::prior::Information;
use super::registration::sure;
use super::search::Search;
use super::seated::Seats;
use super::trail::{self, Start};
use super::{End, FollowReport, LineFollower, Lost, MappingSettings, Step, Tool};
use crate::{PxVec, picture::Gray, stroke::PxPoint};

/// Half of the side of what a glance looks at, px.
const GLANCE_PX: usize = 100;

/// A line farther than this from the tool is gone back to before it is followed on, px.
const OFF_PX: f64 = 0.45;

/// The tool is lowered when it is as near, px.
const ARRIVED_PX: f64 = 0.35;

/// Places of two lines that are as near are one on the way, px.
const TOUCHING_PX: f64 = 1.0;

/// And are no corner that the tool would cut by more, px.
const CUT_PX: f64 = 0.3;

/// The camera goes so much of its window at once to where no window has been: what tells places along a line, its corners and what
/// crosses it, is then in both.
const NEW_SHARE: f64 = 0.25;

/// A line goes straight on whose pieces' directions have this cosine at least.
const STRAIGHT_ON: f64 = 0.9;

/// How the play of an axis is felt: to and fro twice, in moves so small that no other line is taken for this one, px.
const FEELING_PX: [f64; 16] =
    [2.0, 4.0, 6.0, 8.0, 6.0, 4.0, 2.0, 0.0, 2.0, 4.0, 6.0, 8.0, 6.0, 4.0, 2.0, 0.0];

/// Lines before which the play is felt, at most: where it is not seen it does not matter as much.
const MOST_FELT: u32 = 4;

/// Most pictures in one place.
const MOST_FIXES: u32 = 14;

/// Most pictures without anything new.
const MOST_IDLE: u32 = 120;

/// How far from the middle a glance and a whole look compare places of the map, px.
const GLANCE_REACH_PX: f64 = 92.0;
const REACH_PX: f64 = 140.0;

#[derive(Clone, Copy, Debug)]
enum Doing {
    /// Nothing yet.
    Starting,
    /// On the way to a node, with the tool lifted.
    Going(u32),
    /// At a node, with the tool lifted: moves to and fro to feel the play of the axes.
    Feeling { node: u32, turn: usize },
    /// On a line: the last node, the link that is being followed and the node at its end, and the way that it came.
    Following { node: u32, link: Option<(u32, u32)>, heading: PxVec },
    /// On the way to a place that no window has shown.
    Searching(PxPoint),
}

/// Ours: follows each line once, through crossings and tips, with a table that misses.
///
/// From each window come the middles of its lines, to a fraction of a pixel, junctions as they truly are. They go into a map.
/// Where the camera truly is comes from the table, from windows kept about every 45 px, and from the map, each weighed by how well it
/// tells which direction; what the table cannot have done, a step to the next of many lines, is excluded. So the table's error never
/// adds up where lines end, turn or cross, and the play of its axes is learned. The tool goes along the map's lines: straight on at crossings, into the very tips of corners, to every branch; it is lifted
/// only to go to a line that is not joined to this one. Only lines that are connected in the ink are joined in the map, so those that come near
/// do not matter. The width of the lines is found from each window.
///
/// ```
/// # use plotter_vector::{PxPoint, follow::*};
/// let ring: Vec<PxPoint> = (0..=60).map(|i| f64::from(i) * 0.10471975511965977).map(|a| PxPoint::new(100.0 + 25.0 * a.cos(), 100.0 + 25.0 * a.sin())).collect();
/// let paper = Paper::drawn(200, 200, &[(ring.clone(), 5.0)])?;
/// let window = CameraSettings::default().with_width_px(120).with_height_px(120);
/// let mut camera = SimulatedCamera::new(&paper, window);
/// let mut table = SimulatedTable::new(PxPoint::new(100.0, 90.0), TableError { random_px: 1.0, play_px: 3.0, seed: 1 });
/// let mut follower = MappingFollower::new(MappingSettings::default());
/// let end = loop {
///     match follower.observe(&camera.window(table.place()), table.commanded()) {
///         Step::Move { path, tool } => path.into_iter().for_each(|to| table.go(to, tool)),
///         Step::LineLost { .. } => {}
///         Step::Done(end) => break end,
///     }
/// };
/// assert_eq!((end, follower.report().lifts), (End::Complete, 0));
/// let judged = judge(&[ring], table.strokes(), 2.0);
/// assert!(judged.coverage > 0.995 && judged.rms_px < 0.4, "{judged:?}");
/// # Ok::<(), plotter_vector::picture::GrayError>(())
/// ```
#[derive(Clone, Debug)]
pub struct MappingFollower {
    settings: MappingSettings,
    map: LineMap,
    axes: Axes,
    doing: Doing,
    search: Option<Search>,
    /// Where the camera truly is.
    place: PxPoint,
    /// Where all of a window was looked at last.
    looked_at: Option<PxPoint>,
    seats: Seats,
    /// Windows in a row that were looked at wholly since something was elsewhere.
    looks_again: u32,
    keyframes: Keyframes,
    last_pose: Option<PxPoint>,
    /// How well it is known, and what of that the last window told.
    known: Information,
    told: Information,
    window_px: Option<(u32, u32)>,
    width_px: f64,
    thin_looks: u32,
    margin_px: f64,
    tool: Tool,
    tries: u32,
    fixes: u32,
    idle: u32,
    felt: u32,
    explored: Explored,
    last_seen: Lost,
    report: FollowReport,
    ended: Option<End>,
}

impl MappingFollower {
    /// Fewest pixels of a window a side: in smaller ones light that falls off cannot be told from wide lines.
    pub const LEAST_WINDOW_PX: u32 = 80;

    /// Before the first window.
    #[must_use]
    pub fn new(settings: MappingSettings) -> Self {
        Self {
            settings,
            map: LineMap::default(),
            axes: Axes::default(),
            doing: Doing::Starting,
            search: None,
            place: PxPoint::default(),
            looked_at: None,
            seats: Seats::default(),
            looks_again: 0,
            keyframes: Keyframes::default(),
            last_pose: None,
            known: Information::of_axes([0.5; 2]),
            told: Information::default(),
            window_px: None,
            width_px: 4.0,
            thin_looks: 0,
            margin_px: 12.0,
            tool: Tool::Up,
            tries: 0,
            fixes: 0,
            idle: 0,
            felt: 0,
            explored: Explored::default(),
            last_seen: Lost::OneColour,
            report: FollowReport::default(),
            ended: None,
        }
    }

    /// What was seen and followed so far.
    #[must_use]
    pub fn report(&self) -> FollowReport {
        FollowReport {
            seen_px: [State::Ahead, State::Followed, State::Outside, State::GivenUp]
                .map(|state| self.map.length_of(state))
                .iter()
                .sum(),
            followed_px: self.map.length_of(State::Followed),
            given_up_px: self.map.length_of(State::GivenUp),
            outside_px: self.map.length_of(State::Outside),
            line_width_px: self.width_px,
            play_px: self.axes.play_px(),
            ..self.report.clone()
        }
    }

    /// Where the camera truly is, by the map.
    #[must_use]
    pub const fn place(&self) -> PxPoint {
        self.place
    }

    /// The pieces of lines that the map holds, and whether each was followed.
    pub fn seen_lines(&self) -> impl Iterator<Item = ([PxPoint; 2], bool)> {
        let is_line = |link: &&super::line_map::Link| !link.contact && link.state != State::Ghost;
        self.map
            .links
            .iter()
            .filter(is_line)
            .map(|link| (link.ends.map(|end| self.map.at(end)), link.state == State::Followed))
    }

    /// What a correct window is like, or what is wrong with it.
    fn check(&mut self, window: &Gray) -> bool {
        let size = (window.width(), window.height());
        let known = *self.window_px.get_or_insert(size);
        known == size && size.0.min(size.1) >= Self::LEAST_WINDOW_PX
    }

    fn lost(&mut self, at: PxPoint, why: Lost) -> Step {
        self.tries += 1;
        self.last_seen = why;
        if self.tries > self.settings.max_tries {
            // Where nothing can be made out on the way of the search, it goes on elsewhere: what is followed is done, and what
            // was seen can be begun.
            if let Doing::Searching(to) = self.doing
                && why != Lost::WindowSize
                && [State::Followed, State::Ahead].iter().any(|state| self.map.length_of(*state) > 0.0)
            {
                self.tries = 0;
                self.explored.give_up(to);
                return self.choose(at);
            }
            return self.end(End::NoLine { at, why });
        }
        Step::LineLost { at, tries: self.tries, why }
    }

    fn end(&mut self, end: End) -> Step {
        self.ended = Some(end);
        Step::Done(end)
    }

    fn go(&mut self, path: &[PxPoint], tool: Tool) -> Step {
        if tool == Tool::Down && self.tool == Tool::Up && self.report.followed_px > 0.0 {
            self.report.lifts += 1;
        }
        if tool == Tool::Down {
            // Only whether anything was followed; the length comes from the map.
            self.report.followed_px = 1.0;
        }
        self.tool = tool;
        self.report.moves += 1;
        Step::Move { path: self.axes.commands(path, self.settings.area), tool }
    }

    /// Some of the way to a place, with the tool lifted.
    fn travel(&mut self, to: PxPoint) -> Step {
        self.travel_by(to, 0.5)
    }

    /// Some of the way to a place, with the tool lifted: a share of the window at most.
    fn travel_by(&mut self, to: PxPoint, share: f64) -> Step {
        let most = self.window_px.map_or(100.0, |(width, height)| share * f64::from(width.min(height)));
        let way = self.place.distance(to);
        let part = if way > most { most / way } else { 1.0 };
        let next = self.place + (to - self.place) * part;
        self.go(&[next], Tool::Up)
    }

    /// What to do when the tool is on no line.
    fn choose(&mut self, at: PxPoint) -> Step {
        self.fixes = 0;
        trail::pass_drawn(&mut self.map, self.width_px);
        match trail::start(&mut self.map, self.place) {
            Some(Start::Unseen(node, _)) if self.explored.goes(self.place, self.map.at(node)) => {
                let to = self.map.at(node);
                self.doing = Doing::Searching(to);
                return self.travel_by(to, NEW_SHARE);
            }
            Some(Start::At(node) | Start::Unseen(_, node)) => {
                self.doing = Doing::Going(node);
                return self.travel(self.map.at(node));
            }
            None => {}
        }
        let next = if self.settings.search { self.search.as_mut().and_then(Search::next) } else { None };
        if let Some(to) = next {
            let to = self.settings.area.map_or(to, |[from, end]| {
                PxPoint::new(to.x.clamp(from.x, end.x.max(from.x)), to.y.clamp(from.y, end.y.max(from.y)))
            });
            self.doing = Doing::Searching(to);
            return self.travel(to);
        }
        // What is on the map for nothing to be followed was no line: the grain of the paper, the rim of a light.
        if [State::Followed, State::Outside].iter().all(|state| self.map.length_of(*state) == 0.0) {
            let why = if self.report.areas.is_empty() { self.last_seen } else { Lost::TooThick };
            if self.search.is_some() { self.end(End::NoLine { at, why }) } else { self.lost(at, why) }
        } else {
            self.end(End::Complete)
        }
    }

    /// Gives up what is ahead at a node.
    fn give_up(&mut self, node: u32) {
        let links: Vec<u32> = self
            .map
            .links_of(node)
            .filter(|(_, link, _)| !link.contact && link.state == State::Ahead)
            .map(|found| found.0)
            .collect();
        links.into_iter().for_each(|link| self.map.set_state(link, State::GivenUp));
    }

    /// The next step, or none if more of the window must be looked at first.
    fn decide(&mut self, at: PxPoint, looked: bool) -> Option<Step> {
        match self.doing {
            Doing::Starting => Some(self.choose(at)),
            Doing::Searching(to) => {
                // New lines come first; the place is reached as well as the table can without lines.
                let has_lines = trail::start(&mut self.map, self.place).is_some();
                let far = self.place.distance(to) > 10.0 && self.fixes < MOST_FIXES;
                if has_lines || !far {
                    return Some(self.choose(at));
                }
                if self.place.distance(to) < 20.0 {
                    self.fixes += 1;
                }
                Some(self.travel(to))
            }
            Doing::Going(node) => {
                let still =
                    self.map.links_of(node).any(|(_, link, _)| link.state == State::Ahead && !link.contact);
                if !still {
                    return Some(self.choose(at));
                }
                let way = self.place.distance(self.map.at(node));
                if way <= ARRIVED_PX || self.fixes >= MOST_FIXES {
                    if way > 3.0 {
                        self.give_up(node);
                        return Some(self.choose(at));
                    }
                    self.fixes = 0;
                    if self.axes.is_unknown() && self.felt < MOST_FELT {
                        self.felt += 1;
                        self.doing = Doing::Feeling { node, turn: 0 };
                        return self.decide(at, looked);
                    }
                    self.doing = Doing::Following { node, link: None, heading: PxVec::default() };
                    return self.decide(at, looked);
                }
                if way < 20.0 {
                    self.fixes += 1;
                }
                Some(self.travel(self.map.at(node)))
            }
            Doing::Feeling { node, turn } => {
                let home = self.map.at(node);
                let axis = turn / FEELING_PX.len();
                let Some(off_px) = FEELING_PX.get(turn % FEELING_PX.len()).filter(|_| axis < 2) else {
                    self.doing = Doing::Going(node);
                    return Some(self.travel(home));
                };
                self.doing = Doing::Feeling { node, turn: turn + 1 };
                let (dx, dy) = if axis == 0 { (*off_px, 0.0) } else { (0.0, *off_px) };
                Some(self.travel(PxPoint::new(home.x + dx, home.y + dy)))
            }
            Doing::Following { node, link, heading } => self.follow(at, node, link, heading, looked),
        }
    }

    /// The nearest place of the line at a node that was reached: before or behind it where the line goes straight on.
    fn on_line(&self, node: u32, heading: PxVec) -> PxPoint {
        let here = self.map.at(node);
        let next = trail::next(&self.map, node, heading).filter(|(_, near, _)| *near == node);
        let Some((_, _, far)) = next else { return here };
        let there = self.map.at(far);
        if cosine(heading, there - here) < STRAIGHT_ON {
            return here;
        }
        let places = [nearest(self.place, here - heading, here), nearest(self.place, here, there)];
        let distance = |at: &PxPoint| self.place.distance(*at);
        places.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(here)
    }

    fn follow(
        &mut self,
        at: PxPoint,
        node: u32,
        link: Option<(u32, u32)>,
        heading: PxVec,
        looked: bool,
    ) -> Option<Step> {
        // An axis that stands still at its limit would let the other one take the tool off the line.
        let ahead = link.or_else(|| trail::next(&self.map, node, heading).map(|(id, _, far)| (id, far)));
        if let Some((id, far)) = ahead.filter(|(_, far)| self.is_beyond(self.map.at(*far))) {
            self.map.set_state(id, State::Outside);
            self.leaves_at(self.map.at(far));
            return Some(self.choose(at));
        }
        // Back to the line first, if the table went off it.
        let on_line = match link {
            Some((_, far)) => nearest(self.place, self.map.at(node), self.map.at(far)),
            None => self.on_line(node, heading),
        };
        let is_off = self.tool == Tool::Down && self.place.distance(on_line) > OFF_PX;
        // An axis that has to cross its play does so by itself: what the table misses on that way is seen before the tool goes on.
        let next = match link {
            _ if is_off => Some(on_line),
            Some((_, far)) => Some(self.map.at(far)),
            None => trail::next(&self.map, node, heading)
                .map(|(_, near, far)| self.map.at(if near == node { far } else { near })),
        };
        if self.tool == Tool::Down
            && self.fixes < MOST_FIXES
            && let Some(command) = next.and_then(|next| self.axes.crossing(next, self.settings.area))
        {
            self.fixes += 1;
            self.report.moves += 1;
            return Some(Step::Move { path: vec![command], tool: Tool::Down });
        }
        if is_off && self.fixes < MOST_FIXES {
            self.fixes += 1;
            let share = self.axes.share(on_line);
            let part = self.place + (on_line - self.place) * share;
            return Some(self.go(&[part], Tool::Down));
        }
        let (mut node, mut link, mut heading) = (node, link, heading);
        let mut path: Vec<PxPoint> = Vec::new();
        let mut from = self.place;
        let mut length = 0.0;
        while length < self.settings.step_px {
            let (id, far) = match link {
                Some(chosen) => chosen,
                None => {
                    let Some((id, near, far)) = trail::next(&self.map, node, heading) else { break };
                    if near != node {
                        // Places of two lines that touch are hardly ever one. The tool goes over where the other line passes.
                        let [here, there, to] = [node, near, far].map(|id| self.map.at(id));
                        let over = nearest(here, there, to);
                        let is_passed = over.distance(there) > TOUCHING_PX;
                        let over = if is_passed { there } else { over };
                        // From the end of a line behind the one that it meets back to where they meet, not slantwise to what is ahead.
                        let behind = self
                            .map
                            .links_of(near)
                            .filter(|(_, link, other)| {
                                !link.contact && link.state != State::Ghost && *other != far
                            })
                            .map(|(_, _, other)| nearest(here, there, self.map.at(other)));
                        let over = behind
                            .chain([over])
                            .min_by(|a, b| here.distance(*a).total_cmp(&here.distance(*b)))
                            .unwrap_or(over);
                        node = near;
                        let cut_px = nearest(over, here, to).distance(over);
                        if is_passed || here.distance(over) > TOUCHING_PX || cut_px > CUT_PX {
                            if !path.is_empty() && self.axes.turns(from, over) {
                                link = Some((id, far));
                                break;
                            }
                            path.push(over);
                            from = over;
                        }
                    }
                    (id, far)
                }
            };
            let to = self.map.at(far);
            if !path.is_empty() && self.is_beyond(to) {
                link = Some((id, far));
                break;
            }
            // Where an axis turns round its play may do something else than is known: a look before.
            if !path.is_empty() && self.axes.turns(from, to) {
                link = Some((id, far));
                break;
            }
            let share = self.axes.share(to);
            if share < 1.0 && self.fixes < MOST_FIXES {
                // The play is not known yet: a small move, and a look.
                if path.is_empty() {
                    self.fixes += 1;
                    path.push(from + (to - from) * share);
                    link = Some((id, far));
                }
                break;
            }
            self.fixes = 0;
            self.idle = 0;
            self.map.set_state(id, State::Followed);
            length += from.distance(to);
            heading = to - self.map.at(node);
            path.push(to);
            (node, link, from) = (far, None, to);
        }
        if path.is_empty() {
            if !looked {
                return None;
            }
            return Some(self.choose(at));
        }
        self.doing = Doing::Following { node, link, heading };
        Some(self.go(&path, Tool::Down))
    }
}

impl LineFollower for MappingFollower {
    fn observe(&mut self, window: &Gray, pose: PxPoint) -> Step {
        if let Some(end) = self.ended {
            return Step::Done(end);
        }
        self.report.windows += 1;
        if self.report.windows > self.settings.max_windows {
            return self.end(End::WindowLimit { at: pose });
        }
        if !self.check(window) {
            return self.lost(pose, Lost::WindowSize);
        }
        let (width, height) = (f64::from(window.width()), f64::from(window.height()));
        let middle = PxPoint::new(0.5 * width, 0.5 * height);
        if self.search.is_none()
            && let (Some(area), true) = (self.settings.area, self.settings.search)
        {
            self.search = Some(Search::new(area, width.min(height) - 2.0 * self.margin_px));
        }
        if let Doing::Starting = self.doing {
            self.axes.forget(pose);
        }
        let prior = self.prior(pose);
        let far_from_look =
            self.looked_at.is_none_or(|at| at.distance(prior.place) > (0.14 * width.min(height)).min(40.0));
        let glance = matches!(self.doing, Doing::Following { .. }) && !far_from_look;
        let mut flat = Flat::of(window, self.settings.correction.as_ref(), glance.then_some(GLANCE_PX));
        let mut is_whole = !glance;
        let mut seen =
            self.registered(&flat, middle, &prior, if glance { GLANCE_REACH_PX } else { REACH_PX });
        if glance && seen.is_lost {
            flat = Flat::of(window, self.settings.correction.as_ref(), None);
            is_whole = true;
            seen = self.registered(&flat, middle, &prior, REACH_PX);
        }
        if seen.is_lost {
            let lines = Lines::of(&flat, self.settings.max_line_px);
            let why = match (lines.has_ink, lines.pieces.is_empty()) {
                (false, _) => Lost::OneColour,
                (true, true) => Lost::TooThick,
                (true, false) => Lost::Elsewhere,
            };
            return self.lost(pose, why);
        }
        let Seen { place, told, known, .. } = seen;
        self.axes.measure(pose, place, sure(told));
        (self.place, self.known, self.told) = (place, known, told);
        self.last_pose = Some(pose);
        if !self.map.nodes.is_empty() {
            self.tries = 0;
        }

        self.idle += 1;
        if is_whole && self.knows_place(middle) && self.look(&flat, middle) > 0 {
            self.idle = 0;
        }
        if self.idle > MOST_IDLE {
            self.idle = 0;
            if let Doing::Going(node) | Doing::Following { node, .. } = self.doing {
                self.give_up(node);
            }
            return self.choose(pose);
        }
        if let Some(step) = self.decide(pose, is_whole) {
            return step;
        }
        let whole = Flat::of(window, self.settings.correction.as_ref(), None);
        if self.look(&whole, middle) > 0 {
            self.idle = 0;
        }
        match self.decide(pose, true) {
            Some(step) => step,
            None => self.choose(pose),
        }
    }
}
