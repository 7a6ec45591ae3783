//! A session in a terminal, for who is logged in from elsewhere.

use super::view::View;
use super::{Command, Hand, Session};
use core::time::Duration;
use plotter_motion::{Axis as MotorAxis, Direction, Pen, Point, Vec2};
use ratatui::Frame;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::canvas::{Canvas, Circle, Line as Stroke};
use ratatui::widgets::{Axis, Block, Chart, Dataset, Gauge, GraphType, Paragraph};
use std::io;

/// Time between two pictures in the terminal: twenty a second look like motion.
const UPDATE_EVERY: Duration = Duration::from_millis(50);
/// Seconds that the charts show.
const CHART_S: f64 = 20.0;

/// What stands above the numbers and never changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Heading {
    /// Which machine: shown behind `SIMULATED` or `REAL MACHINE`.
    pub machine: String,
    /// Whether it is simulated.
    pub is_simulated: bool,
    /// Lower left and upper right of the drawing or the machine's area, mm.
    pub area_mm: [f64; 4],
}

/// Shows a session in the terminal until it ends or the user quits; says whether he did. Enter starts, space
/// pauses and resumes, Esc stops, c clears, q quits. By hand the arrows move the machine by the step that 1, 2
/// and 3 choose (0.1, 1, 10 mm), u and d lift and lower its pen, h leads it home, l unlocks it, n or + draws
/// the next operation only, o says that it is at the origin. Behind a colon all else is typed that the page
/// can ask for, in its words and numbers ([`Command::from_name`]): `:jog 1 -1 30`, `:go 10 20`, `:feed 80`,
/// `:circle 50 50 20 0 30 0.05`. On a machine of targets the space bar gives a pulse in a direction of chance
/// before the drawing begins, as the published program has it.
///
/// # Errors
///
/// The terminal cannot be read or written.
pub fn run(session: &Session, heading: &Heading) -> io::Result<bool> {
    let mut terminal = ratatui::try_init()?;
    let is_lines = session.look(|view| view.hosted.is_some());
    let mut step_mm = 10.0;
    let mut typed = Typed::default();
    let result = (|| {
        loop {
            session.look(|view| terminal.draw(|frame| draw(frame, view, heading, &typed)).map(|_| ()))?;
            if session.state().is_final() {
                return Ok(false);
            }
            if !event::poll(UPDATE_EVERY)? {
                continue;
            }
            let Event::Key(key) = event::read()? else { continue };
            if key.kind != KeyEventKind::Press {
                continue;
            }
            let interrupted = key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL);
            match key.code {
                _ if interrupted => return Ok(true),
                KeyCode::Esc => session.command(Command::Stop),
                code if typed.takes(code) => typed.take(code).into_iter().for_each(|it| session.command(it)),
                KeyCode::Enter => session.command(Command::Start),
                KeyCode::Char('c') => session.command(Command::Clear),
                KeyCode::Char('q') => return Ok(true),
                KeyCode::Char(' ') if !is_lines && matches!(session.state().name(), "ready" | "watching") => {
                    session.command(Command::Hand(random_pulse()));
                }
                KeyCode::Char(' ') => {
                    let running = session.state().name() == "running";
                    session.command(if running { Command::Pause } else { Command::Resume });
                }
                code => {
                    if let Some(hand) = by_hand(code, &mut step_mm) {
                        session.command(Command::Hand(hand));
                    }
                }
            }
        }
    })();
    ratatui::try_restore()?;
    result
}

/// Most bytes of what is typed: a name of 9 letters and six numbers of ten characters need 75.
const MOST_TYPED: usize = 80;

/// What is typed behind a colon.
#[derive(Clone, Debug, Default, PartialEq)]
struct Typed {
    words: Option<String>,
    /// What was entered and is no command.
    unknown: Option<String>,
}

impl Typed {
    /// Whether a key is for it: a colon begins, and all up to the end of the line belongs to it.
    const fn takes(&self, key: KeyCode) -> bool {
        self.words.is_some() || matches!(key, KeyCode::Char(':'))
    }

    /// Takes a key; the command, once it is entered.
    fn take(&mut self, key: KeyCode) -> Option<Command> {
        let Some(words) = &mut self.words else {
            *self = Self { words: Some(String::new()), unknown: None };
            return None;
        };
        match key {
            KeyCode::Char(character) if words.len() < MOST_TYPED => words.push(character),
            KeyCode::Backspace if words.pop().is_none() => self.words = None,
            KeyCode::Enter => {
                let words = self.words.take().filter(|words| !words.trim().is_empty())?;
                let command = Command::from_name(words.trim());
                self.unknown = command.is_none().then_some(words);
                return command;
            }
            _ => {}
        }
        None
    }

    /// What stands in place of the keys.
    fn text(&self) -> String {
        match (&self.words, &self.unknown) {
            (Some(words), _) => format!(":{words}_"),
            (None, Some(words)) => format!(
                "`{words}` is no command: jog X Y F, go X Y, feed P, line X Y X Y F, circle X Y R N F"
            ),
            (None, None) => String::new(),
        }
    }
}

/// A count in a direction of chance.
fn random_pulse() -> Hand {
    let mut byte = [0];
    let _ = getrandom::fill(&mut byte); // (without chance it is always the same one)
    let [byte] = byte;
    let axis = if byte & 1 == 0 { MotorAxis::X } else { MotorAxis::Y };
    Hand::Pulse(axis, if byte & 2 == 0 { Direction::Plus } else { Direction::Minus })
}

/// Speed of a movement by hand, mm/s: slow enough for a hand at the switch.
const HAND_MM_S: f64 = 30.0;

/// What a key does to a machine by hand; some choose the step.
fn by_hand(key: KeyCode, step_mm: &mut f64) -> Option<Hand> {
    let jog = |x: f64, y: f64| Some(Hand::Jog(Vec2::new(x, y), HAND_MM_S));
    let step = *step_mm;
    match key {
        KeyCode::Left => jog(-step, 0.0),
        KeyCode::Right => jog(step, 0.0),
        KeyCode::Up => jog(0.0, step),
        KeyCode::Down => jog(0.0, -step),
        KeyCode::Char('u') => Some(Hand::Pen(Pen::Up)),
        KeyCode::Char('d') => Some(Hand::Pen(Pen::Down)),
        KeyCode::Char('h') => Some(Hand::Home),
        KeyCode::Char('l') => Some(Hand::Unlock),
        KeyCode::Char('n' | '+') => Some(Hand::Next),
        KeyCode::Char('o') => Some(Hand::StandsAt(Point::ORIGIN)),
        KeyCode::Char(number @ '1'..='3') => {
            *step_mm = match number {
                '1' => 0.1,
                '2' => 1.0,
                _ => 10.0,
            };
            None
        }
        _ => None,
    }
}

fn draw(frame: &mut Frame<'_>, view: &View, heading: &Heading, typed: &Typed) {
    let [top, middle, bottom] =
        Layout::vertical([Constraint::Length(3), Constraint::Min(10), Constraint::Length(10)])
            .areas(frame.area());
    let [sheet, numbers] = Layout::horizontal([Constraint::Min(30), Constraint::Length(34)]).areas(middle);
    let [x, y] = Layout::horizontal([Constraint::Fill(1), Constraint::Fill(1)]).areas(bottom);
    draw_heading(frame, top, view, heading, typed);
    draw_sheet(frame, sheet, view, heading);
    draw_numbers(frame, numbers, view);
    draw_response(frame, x, view, "X (mm)", |at| at.x);
    draw_response(frame, y, view, "Y (mm)", |at| at.y);
}

fn draw_heading(frame: &mut Frame<'_>, area: Rect, view: &View, heading: &Heading, typed: &Typed) {
    let [words, progress] = Layout::vertical([Constraint::Length(2), Constraint::Length(1)]).areas(area);
    let colour = match view.state.name() {
        "stopped" | "locked" | "failed" => Color::Red,
        "paused" | "ready" | "connecting" => Color::Yellow,
        _ => Color::Green,
    };
    let kind = if heading.is_simulated { "SIMULATED " } else { "REAL MACHINE " };
    let state =
        Span::styled(view.state.name().to_uppercase(), Style::new().fg(colour).add_modifier(Modifier::BOLD));
    let first = Line::from(vec![
        Span::styled(kind, Style::new().fg(Color::Yellow)),
        Span::raw(heading.machine.clone()),
        Span::raw("   "),
        state,
    ]);
    let message = match &view.state {
        super::State::Failed(why) => why.clone(),
        _ => view.messages.back().map_or_else(String::new, |(_, text)| text.clone()),
    };
    let keys = if view.hosted.is_some() {
        "Esc EMERGENCY STOP  Enter start  Space pause/resume  arrows 1 2 3 u d h l n o : by hand  q quit"
    } else {
        "Esc EMERGENCY STOP  Enter start  Space pause/resume  arrows 1 2 3 u d n o : by hand  c clear  q quit"
    };
    // What a person types, and has to do, comes before what was said last.
    let wants = view.wants.clone();
    let second = [typed.text(), wants, message]
        .into_iter()
        .find(|words| !words.is_empty())
        .unwrap_or_else(|| keys.to_owned());
    frame.render_widget(Paragraph::new(vec![first, Line::raw(second)]), words);
    if let Some(plan) = view.plan {
        #[expect(clippy::cast_precision_loss, reason = "targets below 2^53")]
        let ratio = (view.done.targets as f64 / plan.targets.max(1) as f64).clamp(0.0, 1.0);
        let rest = view.remaining().map_or_else(|| String::from("-"), |rest| minutes(rest.as_secs_f64()));
        let label = format!("{} of {} targets, {rest} left", view.done.targets, plan.targets);
        frame.render_widget(Gauge::default().ratio(ratio).label(label).use_unicode(true), progress);
    }
}

fn minutes(seconds: f64) -> String {
    let whole = libm::round(seconds);
    let minutes = libm::floor(whole / 60.0);
    format!("{minutes:.0}:{:02.0}", whole - 60.0 * minutes)
}

fn draw_sheet(frame: &mut Frame<'_>, area: Rect, view: &View, heading: &Heading) {
    let [x0, y0, x1, y1] = heading.area_mm;
    // A letter's place is about twice as high as wide: the same mm both ways.
    let (wide, high) = (f64::from(area.width.max(3)) - 2.0, f64::from(area.height.max(3)) - 2.0);
    let per_place =
        ((x1 - x0).max(1.0) / wide.max(1.0)).max((y1 - y0).max(1.0) / (2.0 * high.max(1.0))) * 1.02;
    let (half_x, half_y) = (per_place * wide / 2.0, per_place * high);
    let (cx, cy) = (f64::midpoint(x0, x1), f64::midpoint(y0, y1));
    let at = view.position();
    let canvas = Canvas::default()
        .block(Block::bordered().title("sheet"))
        .marker(Marker::Braille)
        .x_bounds([cx - half_x, cx + half_x])
        .y_bounds([cy - half_y, cy + half_y])
        .paint(|context| {
            let points = view.way.settled().iter().copied().chain(view.way.last());
            let mut before = None;
            for point in points {
                if let Some((x1, y1)) = before
                    && point.state & crate::draw::page::DRAWN != 0
                {
                    context.draw(&Stroke { x1, y1, x2: point.x_mm, y2: point.y_mm, color: Color::White });
                }
                before = Some((point.x_mm, point.y_mm));
            }
            context.layer();
            let color = if view.is_down() { Color::Red } else { Color::Yellow };
            context.draw(&Circle { x: at.x, y: at.y, radius: per_place, color });
        });
    frame.render_widget(canvas, area);
}

fn draw_numbers(frame: &mut Frame<'_>, area: Rect, view: &View) {
    let at = view.position();
    let next = view.plotter.next_target();
    let [vx, vy] = view.speed_mm_s();
    let number = |value: Option<f64>, unit: &str| {
        value.map_or_else(|| String::from("-"), |value| format!("{value:.3} {unit}"))
    };
    let percent = |axis: usize| {
        let duty = view.duty.and_then(|duty| duty.get(axis).copied());
        duty.map_or_else(|| String::from("not told"), |duty| format!("{:.1} %", duty * 100.0))
    };
    let rows = [
        ("time", format!("{:.2} s", view.now.as_secs_f64())),
        ("pen", String::from(if view.is_down() { "down" } else { "up" })),
        ("position x", number(Some(at.x), "mm")),
        ("position y", number(Some(at.y), "mm")),
        ("next x", number(next.map(|next| next.x), "mm")),
        ("next y", number(next.map(|next| next.y), "mm")),
        ("speed x", format!("{vx:.1} mm/s")),
        ("speed y", format!("{vy:.1} mm/s")),
        ("duty x", percent(0)),
        ("duty y", percent(1)),
        ("contour error", number(Some(view.error_mm), "mm")),
        ("greatest, drawn", number(Some(view.worst_mm), "mm")),
        ("targets reached", view.reached.to_string()),
        ("anomalies", view.plotter.anomaly_count().to_string()),
        ("recording", view.recording.clone()),
    ];
    let lines: Vec<Line<'_>> =
        rows.into_iter().map(|(name, value)| Line::raw(format!("{name:16}{value:>15}"))).collect();
    frame.render_widget(Paragraph::new(lines).block(Block::bordered().title("now")), area);
}

fn draw_response(
    frame: &mut Frame<'_>,
    area: Rect,
    view: &View,
    title: &str,
    pick: impl Fn(plotter_motion::Point) -> f64,
) {
    let from = (view.now.as_secs_f64() - CHART_S).max(0.0);
    let to = view.now.as_secs_f64().max(from + 1.0);
    let samples = || view.samples.iter().filter(|sample| sample.time.as_secs_f64() >= from);
    let time = |sample: &super::view::Sample| sample.time.as_secs_f64();
    let desired: Vec<(f64, f64)> = samples().filter_map(|s| Some((time(s), pick(s.line?)))).collect();
    let actual: Vec<(f64, f64)> = samples().map(|s| (time(s), pick(s.at))).collect();
    let all = || desired.iter().chain(&actual).map(|&(_, value)| value);
    let (low, high) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let (low, high) = if high - low > 1e-3 { (low, high) } else { (low.min(0.0), low.max(0.0) + 1.0) };
    let dataset = |name, data, color| {
        Dataset::default()
            .name(name)
            .marker(Marker::Braille)
            .graph_type(GraphType::Line)
            .style(Style::new().fg(color))
            .data(data)
    };
    let chart =
        Chart::new(vec![dataset("desired", &desired, Color::Blue), dataset("actual", &actual, Color::White)])
            .block(Block::bordered().title(title.to_owned()))
            .x_axis(Axis::default().bounds([from, to]).labels([format!("{from:.0} s"), format!("{to:.0} s")]))
            .y_axis(Axis::default().bounds([low, high]).labels([format!("{low:.1}"), format!("{high:.1}")]));
    frame.render_widget(chart, area);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PlotterSettings;
    use crate::live::{Plan, State};
    use crate::log::{Event, Record};
    use plotter_motion::StepPoint;
    use plotter_motion::protocol::digits;
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    /// A square of 10 mm, three sides of which are drawn and half of the fourth.
    fn view() -> View {
        let plan = Plan { targets: 4, way_mm: 40.0 };
        let mut view = View::new(PlotterSettings::default(), State::Running, Some(plan));
        let mut us = 0;
        let corners = [(400, 0, b'1', 400), (400, 400, b'3', 400), (0, 400, b'2', 400), (0, 0, b'4', 200)];
        view.push(&Record::at_us(0, Event::Pen(Pen::Down)));
        for (x, y, pulse, count) in corners {
            let digits = digits::encode(StepPoint::new(x, y)).unwrap();
            view.push(&Record::at_us(us, Event::Host(digits.to_vec())));
            for n in 0..count {
                us += 2_500;
                view.push(&Record::at_us(us, Event::Controller(vec![pulse])));
                if n % 8 == 0 {
                    view.sample(Duration::from_micros(us));
                }
            }
            if count == 400 {
                view.push(&Record::at_us(us, Event::Controller(vec![b'+'])));
                view.pace.target(10.0, Duration::from_secs(1));
                view.done = Plan { targets: view.done.targets + 1, way_mm: view.done.way_mm + 10.0 };
                view.reached += 1;
            }
        }
        view.duty = Some([0.0, -0.25]);
        view.recording = String::from("square.plog");
        view
    }

    #[test]
    fn what_is_typed_behind_a_colon_is_a_command_of_the_page() {
        let mut typed = Typed::default();
        assert!(!typed.takes(KeyCode::Char('u')) && typed.takes(KeyCode::Char(':')));
        let mut enter = |words: &str| {
            let mut command = None;
            for key in words.chars().map(KeyCode::Char).chain([KeyCode::Enter]) {
                assert!(typed.takes(key), "{words}");
                command = typed.take(key);
            }
            (command, typed.text())
        };
        let jog = Hand::Jog(Vec2::new(1.0, -1.0), 30.0);
        assert_eq!(enter(":jog 1 -1 30"), (Some(Command::Hand(jog)), String::new()));
        assert_eq!(enter(":  "), (None, String::new()));
        assert_eq!(enter(":pause"), (Some(Command::Pause), String::new()));
        let (command, told) = enter(":circle 50 50 20");
        assert!(command.is_none() && told.starts_with("`circle 50 50 20` is no command"), "{told}");
        // The word is forgotten with the next one, and a line that is taken back is left.
        for key in [':', 'u'] {
            assert_eq!(typed.take(KeyCode::Char(key)), None);
        }
        assert_eq!(typed.text(), ":u_");
        for key in [KeyCode::Backspace; 2] {
            assert_eq!(typed.take(key), None);
        }
        assert_eq!(typed, Typed::default());
        for key in [':'; 1].into_iter().chain(['x'; 1_000]) {
            assert_eq!(typed.take(KeyCode::Char(key)), None);
        }
        assert_eq!(typed.words.map(|words| words.len()), Some(MOST_TYPED));
    }

    #[test]
    fn the_terminal_shows_sheet_numbers_and_response() {
        let mut terminal = Terminal::new(TestBackend::new(110, 36)).unwrap();
        let heading = Heading {
            machine: String::from("semi-virtual-gantry"),
            is_simulated: true,
            area_mm: [0.0, 0.0, 10.0, 10.0],
        };
        let view = view();
        terminal.draw(|frame| draw(frame, &view, &heading, &Typed::default())).unwrap();
        insta::assert_snapshot!(terminal.backend());
    }

    #[test]
    fn keys_lead_a_machine_by_hand() {
        let mut step_mm = 10.0;
        assert_eq!(by_hand(KeyCode::Left, &mut step_mm), Some(Hand::Jog(Vec2::new(-10.0, 0.0), 30.0)));
        assert_eq!(by_hand(KeyCode::Char('1'), &mut step_mm), None);
        assert_eq!(by_hand(KeyCode::Up, &mut step_mm), Some(Hand::Jog(Vec2::new(0.0, 0.1), 30.0)));
        assert_eq!(by_hand(KeyCode::Char('u'), &mut step_mm), Some(Hand::Pen(Pen::Up)));
        assert_eq!(by_hand(KeyCode::Char('x'), &mut step_mm), None);
    }

    #[test]
    fn the_pen_is_up_before_the_start() {
        let mut terminal = Terminal::new(TestBackend::new(110, 36)).unwrap();
        let view = View::new(PlotterSettings::default(), State::Ready, None);
        terminal.draw(|frame| draw(frame, &view, &Heading::default(), &Typed::default())).unwrap();
        let shown = terminal.backend().to_string();
        let pen = shown.lines().find_map(|line| line.split_once("pen ")).unwrap().1;
        assert!(pen.trim_start().starts_with("up "), "{pen}");
    }

    #[test]
    fn a_tiny_terminal_does_no_harm() {
        let view = view();
        for (wide, high) in [(1, 1), (20, 5), (40, 12)] {
            let mut terminal = Terminal::new(TestBackend::new(wide, high)).unwrap();
            terminal.draw(|frame| draw(frame, &view, &Heading::default(), &Typed::default())).unwrap();
        }
    }
}
