//! [`LongSheetRun`]: a drawing divided into frames, and each frame drawn on a simulated sheet.

use crate::long_sheet::FrameChange;
use plotter_motion::config::SteppersConfig;
use plotter_motion::stepgen::{PlotTimer, StepGenSettings};
use plotter_motion::{Axis, Machine, Planner, PlannerSettings, PlotOp, Point, Vec2};
use plotter_stitch::{
    Crossing, Field, FoldTest, Frame, FrameLayout, FrameTransform, LongSheet, Optics, PaperSearch,
    ReferenceLines, SheetSettings, StripJoin,
    paper::{PaperSettings, SensedPaper},
    sense::SearchSettings,
    sheet::{FoldCheck, JoinFrames, JointReport, PublishedJoin, SheetConfig},
};

/// Most fits by hand at one frame change; then something else is wrong.
const MOST_FITS: u32 = 3;
/// The paper's edges lie this far beside the field, mm.
const PAPER_BESIDE_MM: f64 = 55.0;
/// The pen that draws the marks: the first one.
const MARK_PEN: u8 = 1;
/// Blocks of look-ahead.
const BLOCKS: usize = 64;
/// Half of the side of what is shown around a break point, mm.
pub(crate) const HALF_VIEW_MM: f64 = 4.0;
/// Most break points of a joint around which the lines are kept.
const MOST_VIEWS: usize = 24;

/// A machine's file as the sheet, the frames and the marks need it.
#[derive(Clone, Debug)]
pub struct LongSheetMachine {
    /// How drawings are divided.
    pub layout: FrameLayout,
    /// How the sheet is simulated.
    pub sheet: SheetSettings,
    /// Ours.
    pub strip: ReferenceLines,
    search: SearchSettings,
    planner: PlannerSettings,
    area: Vec2,
    /// How far beyond the area the head reaches, mm.
    beyond_mm: f64,
}

impl LongSheetMachine {
    /// What a machine's file says.
    ///
    /// # Errors
    ///
    /// That the machine moves no sheet, or that its head does not reach the marks.
    pub fn new(machine: &Machine, sheet: &SheetConfig) -> Result<Self, String> {
        /// From the table's sides to the widest field, mm: the head must see the paper's edges beside it.
        const BESIDE_MM: f64 = 10.0;
        let config = machine.config();
        let steppers = SteppersConfig::of(machine);
        if sheet.frame_mm <= 0.0 {
            return Err(
                "sheet.frame_mm is 0: this machine moves no sheet; machines/textile-plotter.toml does".into(),
            );
        }
        let area = Vec2::new(config.area.width_mm, config.area.height_mm);
        let field = Field {
            left_mm: BESIDE_MM,
            width_mm: area.x - 2.0 * BESIDE_MM,
            begin_mm: sheet.begin_mm,
            frame_mm: sheet.frame_mm,
        };
        let strip = ReferenceLines::strip16_on(&field);
        let search = SearchSettings::default().with_fast_mm_s(sheet.sensing_mm_s);
        // Marks are drawn with the frame before, and looked for after it has been moved.
        let beyond_mm = steppers.homing.pull_off_mm;
        let y_marks_mm =
            || strip.marks.iter().filter(|group| group.axis == Axis::Y).flat_map(|group| &group.at_mm);
        let least_mm = y_marks_mm().fold(f64::INFINITY, |least, mm| least.min(*mm)) - search.window_mm;
        let most_mm = y_marks_mm().fold(f64::NEG_INFINITY, |most, mm| most.max(*mm)) + sheet.frame_mm;
        if least_mm < -beyond_mm || most_mm > area.y + beyond_mm {
            return Err(format!(
                "the marks need the head from y = {least_mm} to {most_mm} mm, it reaches {} to {}; change sheet.begin_mm or \
                 sheet.frame_mm",
                -beyond_mm,
                area.y + beyond_mm
            ));
        }
        Ok(Self {
            layout: FrameLayout {
                begin_mm: 0.0,
                frame_mm: sheet.frame_mm,
                width_mm: field.width_mm,
                window_mm: sheet.cut_window_mm,
                clear_mm: sheet.cut_clear_mm,
            },
            sheet: SheetSettings::default().with_field(field).with_anchor_mm(sheet.anchor_mm),
            strip,
            search,
            planner: PlannerSettings::of(machine),
            area,
            beyond_mm,
        })
    }

    /// The same machine with paper on it whose edges lie there at y = 0, mm, which the head has to find: the
    /// widest field on it, in whole millimetres, is taken.
    ///
    /// # Errors
    ///
    /// There is no paper under the head, or it reaches beyond, or it is too narrow for any drawing.
    pub fn on_paper(self, edges_mm: [f64; 2], turn_rad: f64, seed: u64) -> Result<Self, String> {
        let Self { layout, sheet, beyond_mm, area, .. } = self;
        let Field { begin_mm, frame_mm, .. } = sheet.field;
        let settings = PaperSettings::default()
            .with_reach_mm([-beyond_mm, area.x + beyond_mm])
            .with_rows_mm([begin_mm, begin_mm + frame_mm]);
        let mut search = PaperSearch::new(settings);
        SensedPaper::new(edges_mm, turn_rad, seed).run(&mut search).map_err(|error| error.to_string())?;
        let paper = search.paper().map_err(|error| error.to_string())?;
        let field =
            paper.field(paper.widest_mm().floor(), begin_mm, frame_mm).map_err(|error| error.to_string())?;
        Ok(Self {
            layout: FrameLayout { width_mm: field.width_mm, ..layout },
            sheet: sheet.with_field(field),
            strip: ReferenceLines::strip16_on(&field),
            ..self
        })
    }

    /// The published procedure on this machine.
    #[must_use]
    pub fn published_join(&self) -> PublishedJoin {
        PublishedJoin::on(&self.sheet.field, Optics::default())
    }

    /// Ours.
    #[must_use]
    pub fn strip_join(&self) -> StripJoin {
        StripJoin::new(&self.strip, self.search)
    }
}

/// Lines around a break point, in the coordinates in which their frame has its own place on the table.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The break point, there.
    pub place: Point,
    /// Pieces of lines, each a polyline.
    pub lines: Vec<Vec<Point>>,
}

/// A joint as it came out.
#[derive(Clone, Debug)]
pub struct JointFigures {
    /// What the simulation says.
    pub report: JointReport,
    /// How many lines go over the joint.
    pub breaks: usize,
    /// The greatest distance between the two ends of a line, mm; at the ends of the joint where no line goes
    /// over it.
    pub worst_mm: f64,
    /// Root of the mean square, mm.
    pub rms_mm: f64,
    /// Around the worst break point: the lines of the frame before, and of the frame after, in the machine's
    /// coordinates.
    pub view: Option<(Point, [Vec<Vec<Point>>; 2])>,
    /// What the first look for a fold said.
    pub fold: FoldCheck,
    /// How often the run stopped, and the paper was fitted by hand.
    pub fits: u32,
}

/// What the frames themselves are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameFigures {
    /// Lines and arcs, those of the marks among them.
    pub segments: u64,
    /// Time of the machine for them, s, without the pen.
    pub motion_s: f64,
    /// Places that lie outside of the machine's area.
    pub outside: u64,
}

/// Draws frame after frame.
#[derive(Debug)]
pub struct LongSheetRun<M> {
    machine: LongSheetMachine,
    sheet: LongSheet<M>,
    /// Around break points at the end of the last frame.
    ends: Vec<View>,
    /// How many frames have been drawn.
    drawn: u64,
    /// Sums over all frames.
    pub frames: FrameFigures,
    /// The frame whose change is to be shown, and the picture once it has been drawn.
    pub shown: (u32, Option<FrameChange>),
    /// The lines of the frame before that one, in its coordinates.
    kept: Vec<PlotOp>,
}

impl<M: JoinFrames> LongSheetRun<M> {
    /// A sheet on which nothing is drawn.
    ///
    /// # Errors
    ///
    /// Settings that make no sheet.
    pub fn new(machine: LongSheetMachine, method: M, seed: u64) -> Result<Self, String> {
        let sheet = LongSheet::new(machine.sheet, method, seed).map_err(|error| error.to_string())?;
        Ok(Self {
            machine,
            sheet,
            ends: Vec::new(),
            drawn: 0,
            frames: FrameFigures::default(),
            shown: (0, None),
            kept: Vec::new(),
        })
    }

    /// From the frame's coordinates to its own place on the table.
    fn on_table(&self) -> Vec2 {
        self.machine.sheet.field.corner()
    }

    /// Draws the first frame.
    ///
    /// # Errors
    ///
    /// An operation that the machine cannot plan.
    pub fn first(&mut self, frame: Option<&Frame>) -> Result<(), String> {
        self.draw(frame)?;
        self.keep(0, frame);
        Ok(())
    }

    /// Moves the sheet on, joins the next frame and draws it; `None` is a frame without a drawing.
    ///
    /// # Errors
    ///
    /// Marks that were not found or do not agree, or an operation that the machine cannot plan.
    pub fn next(&mut self, frame: Option<&Frame>) -> Result<JointFigures, String> {
        let number = self.drawn;
        let failed = |error: plotter_stitch::JoinError| format!("frame {number} was not joined: {error}");
        let mut report = self.sheet.next_joint().map_err(failed)?;
        let fold_mm = report.fold_mm;
        let ops = || frame.into_iter().flat_map(Frame::ops);
        let test = FoldTest::default();
        let fold = self.sheet.check_fold(&test, ops).map_err(failed)?;
        let (mut last, mut fits, mut checks) = (fold, 0, vec![fold]);
        while last.stops() {
            if fits == MOST_FITS {
                return Err(format!(
                    "frame {number} was not drawn: fitted {fits} times by hand, and still: {last}"
                ));
            }
            fits += 1;
            report = self.sheet.fitted().map_err(failed)?;
            last = self.sheet.check_fold(&test, ops).map_err(failed)?;
            checks.push(last);
        }
        let before = (self.sheet.strokes(), self.sheet.crossings().to_vec());
        let by = self.on_table();
        let begin_mm = frame.map_or(0.0, Frame::begin_mm);
        let breaks: Vec<Point> = frame.map_or_else(Vec::new, |frame| {
            let local = Vec2::new(0.0, -begin_mm) + by;
            frame.begin_breaks().iter().map(|place| *place + local).collect()
        });
        let ends = self.sheet.joint();
        let places = if breaks.is_empty() { &ends[..] } else { &breaks[..] };
        let off_mm = |place: Point| report.discrepancy(place).length();
        let (mut worst_mm, mut squares) = (0.0_f64, 0.0);
        for place in places {
            worst_mm = worst_mm.max(off_mm(*place));
            squares += off_mm(*place) * off_mm(*place);
        }
        #[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
        let rms_mm = (squares / places.len() as f64).sqrt();
        let view = frame.and_then(|frame| self.view(&report, frame));
        self.draw(frame)?;
        self.show(&report, before, &checks, frame);
        let report = JointReport { fold_mm, ..report };
        Ok(JointFigures { report, breaks: breaks.len(), worst_mm, rms_mm, view, fold, fits })
    }

    /// The worst of the break points around which lines have been kept, with both frames' lines on the
    /// machine.
    fn view(&self, report: &JointReport, frame: &Frame) -> Option<(Point, [Vec<Vec<Point>>; 2])> {
        let off_mm = |view: &View| report.discrepancy(view.place).length();
        // The end of the frame before is a frame's length farther in its own coordinates.
        let by = Vec2::new(0.0, -self.machine.sheet.field.frame_mm);
        let before = self
            .ends
            .iter()
            .map(|view| View {
                place: view.place + by,
                lines: view.lines.iter().map(|line| line.iter().map(|place| *place + by).collect()).collect(),
            })
            .max_by(|a, b| off_mm(a).total_cmp(&off_mm(b)))?;
        let after = views(frame, &[before.place], self.on_table());
        let on_machine = |lines: &[Vec<Point>], transform: &plotter_stitch::FrameTransform| {
            lines.iter().map(|line| line.iter().map(|place| transform.to_machine(*place)).collect()).collect()
        };
        let lines = [
            on_machine(&before.lines, &report.truth),
            after.first().map_or_else(Vec::new, |after| on_machine(&after.lines, &report.drawn)),
        ];
        Some((report.truth.to_machine(before.place), lines))
    }

    /// Keeps the table as it is now, if this frame's change is to be shown.
    fn show(
        &mut self,
        report: &JointReport,
        (marks, scans): (Vec<[Point; 2]>, Vec<Crossing>),
        checks: &[FoldCheck],
        frame: Option<&Frame>,
    ) {
        let (by, field) = (self.on_table(), self.machine.sheet.field);
        if report.frame == self.shown.0 {
            let JointReport { truth, drawn, .. } = report;
            let [down, up] = [-1.0, 1.0].map(|sign| Vec2::new(0.0, sign * field.frame_mm));
            let lies = |ops: &[PlotOp], frame: &FrameTransform, by: Vec2| -> Vec<PlotOp> {
                ops.iter().map(|op| frame.op_to_machine(moved(*op, by))).collect()
            };
            let strokes = |strokes: &[[Point; 2]], frame: &FrameTransform, by: Vec2| -> Vec<[Point; 2]> {
                strokes.iter().map(|ends| ends.map(|end| frame.to_machine(end + by))).collect()
            };
            let after: Vec<PlotOp> = frame.into_iter().flat_map(Frame::ops).collect();
            let probes = checks.iter().filter_map(|check| match check {
                FoldCheck::Probed { probe, .. } => Some(probe),
                _ => None,
            });
            let probes = probes.flat_map(|probe| {
                let line = probe.strokes()[0].map(|op| op.target().unwrap_or(Point::ORIGIN));
                probe.scans().map(|scan| [scan.from, scan.to]).chain([line])
            });
            let probes: Vec<[Point; 2]> = probes.collect();
            let paper_mm = [field.left_mm - PAPER_BESIDE_MM, field.right_mm() + PAPER_BESIDE_MM];
            let area = self.machine.area;
            let beyond_mm = self.machine.beyond_mm;
            self.shown.1 = Some(FrameChange {
                frame: report.frame,
                edges: paper_mm
                    .map(|x| [-beyond_mm, area.y + beyond_mm].map(|y| truth.to_machine(Point::new(x, y)))),
                before: (lies(&self.kept, truth, by + down), strokes(&marks, truth, Vec2::default())),
                scans,
                probes: strokes(&probes, drawn, by),
                after: (lies(&after, drawn, by), strokes(&self.sheet.strokes(), drawn, up)),
                table_mm: [area.x, area.y],
                beyond_mm,
            });
        }
        self.keep(report.frame, frame);
    }

    /// Keeps the lines of the frame before the one that is to be shown.
    fn keep(&mut self, number: u32, frame: Option<&Frame>) {
        self.kept.clear();
        if number.checked_add(1) == Some(self.shown.0) {
            self.kept.extend(frame.into_iter().flat_map(Frame::ops));
        }
    }

    /// Plans the frame's operations where they lie on the machine, and keeps what its end looks like.
    fn draw(&mut self, frame: Option<&Frame>) -> Result<(), String> {
        self.drawn += 1;
        let by = self.on_table();
        let ops = self
            .sheet
            .draw(Some(MARK_PEN), || frame.into_iter().flat_map(Frame::ops))
            .map_err(|error| format!("frame {} cannot be drawn: {error}", self.drawn))?;
        let averaged = self.machine.planner.planned().map_err(|error| error.to_string())?;
        let mut planner = Planner::<BLOCKS>::new(averaged.settings).map_err(|error| error.to_string())?;
        let mut timer = PlotTimer::new(StepGenSettings::default()).averaged(&averaged);
        let LongSheetMachine { area, beyond_mm, .. } = self.machine;
        let mut figures = self.frames;
        let drain = |planner: &mut Planner<BLOCKS>, timer: &mut PlotTimer| {
            while let Some(action) = planner.next_action() {
                timer.push(&action);
            }
        };
        for op in ops {
            if let Some(Point { x, y }) = op.target() {
                let is_within = |at: f64, size: f64| (-beyond_mm..=size + beyond_mm).contains(&at);
                figures.outside += u64::from(!is_within(x, area.x) || !is_within(y, area.y));
            }
            figures.segments += u64::from(matches!(op, PlotOp::Draw { .. } | PlotOp::DrawArc { .. }));
            if !planner.has_room() {
                drain(&mut planner, &mut timer);
            }
            planner.push(op).map_err(|error| error.to_string())?;
        }
        drain(&mut planner, &mut timer);
        planner.finish().map_err(|error| error.to_string())?;
        drain(&mut planner, &mut timer);
        figures.motion_s += timer.time().motion.as_secs_f64();
        self.frames = figures;
        let Some(frame) = frame else {
            self.ends.clear();
            return Ok(());
        };
        let local = Vec2::new(0.0, -frame.begin_mm()) + by;
        let every = frame.end_breaks().len().div_ceil(MOST_VIEWS).max(1);
        let places: Vec<Point> =
            frame.end_breaks().iter().step_by(every).map(|place| *place + local).collect();
        self.ends = views(frame, &places, by);
        Ok(())
    }
}

/// The operation elsewhere.
fn moved(op: PlotOp, by: Vec2) -> PlotOp {
    plotter_stitch::FrameTransform::new(0.0, by).map_or(op, |shift| shift.op_to_machine(op))
}

/// The lines of a frame around some places.
fn views(frame: &Frame, places: &[Point], by: Vec2) -> Vec<View> {
    let mut views: Vec<View> = places.iter().map(|place| View { place: *place, lines: Vec::new() }).collect();
    if views.is_empty() {
        return views;
    }
    let reach_mm = 1.5 * HALF_VIEW_MM;
    let (low, high) = places
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| (low.min(place.y), high.max(place.y)));
    let mut at = Point::ORIGIN;
    for op in frame.ops().map(|op| moved(op, by)) {
        let from = at;
        at = op.target().unwrap_or(at);
        if !matches!(op, PlotOp::Draw { .. } | PlotOp::DrawArc { .. }) {
            continue;
        }
        let is_line = matches!(op, PlotOp::Draw { .. });
        if is_line && (from.y.max(at.y) < low - reach_mm || from.y.min(at.y) > high + reach_mm) {
            continue;
        }
        let path = [PlotOp::Travel { to: from }, op];
        let line: Vec<Point> =
            plotter_motion::toolpath::chords(path, 0.02).filter_map(PlotOp::target).collect();
        for view in &mut views {
            let is_near = line
                .windows(2)
                .any(|pair| plotter_motion::Segment::new(pair[0], pair[1]).distance(view.place) < reach_mm);
            if is_near {
                match view.lines.last_mut().filter(|last| last.last() == Some(&from)) {
                    Some(last) => last.extend(&line[1..]),
                    None => view.lines.push(line.clone()),
                }
            }
        }
    }
    views
}
