//! [`LongSheetRun`]: a drawing divided into frames, and each frame drawn on a simulated sheet.

use plotter_motion::{Action, Axis, Machine, Planner, PlannerSettings, PlotOp, Point, Vec2};
use plotter_stitch::{
    Crossing, EmptySquare, FoldDirection, FoldTest, FoldVerdict, Frame, FrameLayout, JoinFrames, JointReport,
    LongSheet, Optics, PublishedJoin, ReferenceLines, SearchSettings, SensedProbe, SheetSettings, StripJoin,
};

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
    /// The published marks.
    pub published: [Crossing; 4],
    /// Ours.
    pub strip: ReferenceLines,
    sensing_mm_s: f64,
    planner: PlannerSettings,
    area: Vec2,
}

impl LongSheetMachine {
    /// What a machine's file says.
    ///
    /// # Errors
    ///
    /// That the machine moves no sheet, or that no marks stay in reach.
    pub fn new(machine: &Machine) -> Result<Self, String> {
        /// Between two lines of marks there must be this much, or they tell too little.
        const LEAST_STRIP_MM: f64 = 20.0;
        let config = machine.config();
        let sheet = config.sheet;
        if sheet.frame_mm <= 0.0 {
            return Err(
                "sheet.frame_mm is 0: this machine moves no sheet; machines/textile-plotter.toml does".into(),
            );
        }
        let height_mm = config.area.height_mm;
        let left_mm = config.area.width_mm - sheet.begin_mm - sheet.frame_mm;
        if left_mm < 2.0 * LEAST_STRIP_MM {
            return Err(format!(
                "sheet.frame_mm: {left_mm} mm of the frame before stay in reach, at least {} mm are needed for its \
                 marks; move the sheet by less",
                2.0 * LEAST_STRIP_MM
            ));
        }
        // The documented layouts, moved and stretched onto this table.
        let documented = SheetSettings::default();
        let (to_x, to_y) = ((left_mm - LEAST_STRIP_MM) / 160.0, height_mm / documented.height_mm);
        let x = |mm: f64| sheet.begin_mm + (mm - documented.begin_mm) * to_x.min(1.0);
        let mut strip = ReferenceLines::strip16();
        strip.joint = strip.joint.map(|end| Point::new(x(end.x), end.y * to_y));
        for group in &mut strip.marks {
            let (marks, scans): (&dyn Fn(f64) -> f64, &dyn Fn(f64) -> f64) = match group.axis {
                Axis::X => (&x, &|mm| mm * to_y),
                Axis::Y => (&|mm| mm * to_y, &x),
            };
            group.at_mm.iter_mut().for_each(|mm| *mm = marks(*mm));
            group.scans_mm.iter_mut().for_each(|mm| *mm = scans(*mm));
        }
        let far = |mm: f64| sheet.begin_mm + sheet.frame_mm + (mm - 1_820.0);
        let near = |mm: f64| sheet.begin_mm + (mm - documented.begin_mm);
        let mark = |axis, mark_mm, scan_at_mm| Crossing { axis, mark_mm, scan_at_mm };
        let published = [
            mark(Axis::X, near(20.0), 520.0 * to_y),
            mark(Axis::X, far(1_820.0), 520.0 * to_y),
            mark(Axis::Y, 500.0 * to_y, near(25.0)),
            mark(Axis::Y, 500.0 * to_y, far(1_825.0)),
        ];
        Ok(Self {
            layout: FrameLayout {
                begin_mm: 0.0,
                frame_mm: sheet.frame_mm,
                height_mm,
                window_mm: sheet.cut_window_mm,
                clear_mm: sheet.cut_clear_mm,
            },
            sheet: SheetSettings {
                frame_mm: sheet.frame_mm,
                begin_mm: sheet.begin_mm,
                height_mm,
                anchor_mm: sheet.anchor_mm,
                ..documented
            },
            published,
            strip,
            sensing_mm_s: sheet.sensing_mm_s,
            planner: PlannerSettings::of(machine),
            area: Vec2::new(config.area.width_mm, height_mm),
        })
    }

    /// The published procedure on this machine.
    #[must_use]
    pub fn published_join(&self) -> PublishedJoin {
        PublishedJoin::new(self.published, Optics::default())
    }

    /// Ours.
    #[must_use]
    pub fn strip_join(&self) -> StripJoin {
        StripJoin::new(
            &self.strip,
            SearchSettings { fast_mm_s: self.sensing_mm_s, ..SearchSettings::default() },
        )
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
    /// The greatest distance between the two ends of a line, mm; at the ends of the joint where no line goes over it.
    pub worst_mm: f64,
    /// Root of the mean square, mm.
    pub rms_mm: f64,
    /// Around the worst break point: the lines of the frame before, and of the frame after, in the machine's coordinates.
    pub view: Option<(Point, [Vec<Vec<Point>>; 2])>,
    /// What the fold probe said: `None` where there was no empty square for it.
    pub fold: Option<FoldVerdict>,
}

/// What the frames themselves are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameFigures {
    /// Lines and arcs.
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
    seed: u64,
    /// Around break points at the end of the last frame.
    ends: Vec<View>,
    x_border2_mm: f64,
    /// How many frames have been drawn.
    drawn: u64,
    /// Sums over all frames.
    pub frames: FrameFigures,
}

impl<M: JoinFrames> LongSheetRun<M> {
    /// A sheet on which nothing is drawn.
    ///
    /// # Errors
    ///
    /// Settings that make no sheet.
    pub fn new(machine: LongSheetMachine, method: M, seed: u64) -> Result<Self, String> {
        let sheet = LongSheet::new(machine.sheet, method, seed).map_err(|error| error.to_string())?;
        let x_border2_mm = machine.sheet.begin_mm + machine.sheet.frame_mm;
        Ok(Self {
            machine,
            sheet,
            seed,
            ends: Vec::new(),
            x_border2_mm,
            drawn: 0,
            frames: FrameFigures::default(),
        })
    }

    /// From the frame's coordinates to its own place on the table.
    fn on_table(&self) -> Vec2 {
        Vec2::new(self.machine.sheet.begin_mm, 0.0)
    }

    /// Draws the first frame.
    ///
    /// # Errors
    ///
    /// An operation that the machine cannot plan.
    pub fn first(&mut self, frame: Option<&Frame>) -> Result<(), String> {
        self.draw(frame)
    }

    /// Moves the sheet on, joins the next frame and draws it; `None` is a frame without a drawing.
    ///
    /// # Errors
    ///
    /// Marks that were not found or do not agree, or an operation that the machine cannot plan.
    pub fn next(&mut self, frame: Option<&Frame>) -> Result<JointFigures, String> {
        let number = self.drawn;
        let report =
            self.sheet.next_joint().map_err(|error| format!("frame {number} was not joined: {error}"))?;
        let by = self.on_table();
        let begin_mm = frame.map_or(0.0, Frame::begin_mm);
        let breaks: Vec<Point> = frame.map_or_else(Vec::new, |frame| {
            let local = Vec2::new(-begin_mm, 0.0) + by;
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
        let fold = self.probe(&report, frame);
        self.draw(frame)?;
        Ok(JointFigures { report, breaks: breaks.len(), worst_mm, rms_mm, view, fold })
    }

    /// The worst of the break points around which lines have been kept, with both frames' lines on the machine.
    fn view(&self, report: &JointReport, frame: &Frame) -> Option<(Point, [Vec<Vec<Point>>; 2])> {
        let off_mm = |view: &View| report.discrepancy(view.place).length();
        // The end of the frame before is a frame's length farther in its own coordinates.
        let by = Vec2::new(-self.machine.sheet.frame_mm, 0.0);
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

    /// Looks for a fold in the coming frame.
    fn probe(&mut self, report: &JointReport, frame: Option<&Frame>) -> Option<FoldVerdict> {
        let FrameLayout { frame_mm, height_mm, .. } = self.machine.layout;
        // Where the border at the frame's end lies on the lower edge, by what the procedure told.
        let corner = Point::new(self.machine.sheet.begin_mm + frame_mm, 0.0);
        let now_mm =
            report.joined.x_border2_mm.unwrap_or_else(|| report.joined.transform.to_machine(corner).x);
        let before_mm = std::mem::replace(&mut self.x_border2_mm, now_mm);
        let direction = FoldDirection::from_borders(before_mm, now_mm).unwrap_or(FoldDirection::Rising);
        let mut square = EmptySquare::new(direction, frame_mm, height_mm);
        frame.into_iter().flat_map(Frame::ops).for_each(|op| square.push(op));
        square.find()?;
        let seed = self.seed ^ u64::from(report.frame).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let SheetSettings { optics, noise, .. } = self.machine.sheet;
        let (once, twice) = SensedProbe::new(report.fold_mm.unwrap_or(0.0), optics, noise, seed).scans();
        Some(FoldTest::default().judge(&once, &twice))
    }

    /// Plans the frame's operations where they lie on the machine, and keeps what its end looks like.
    fn draw(&mut self, frame: Option<&Frame>) -> Result<(), String> {
        self.drawn += 1;
        let Some(frame) = frame else {
            self.ends.clear();
            return Ok(());
        };
        let transform = self.sheet.drawn();
        let by = self.on_table();
        let mut planner = Planner::<BLOCKS>::new(self.machine.planner).map_err(|error| error.to_string())?;
        let area = self.machine.area;
        let mut figures = self.frames;
        let drain = |planner: &mut Planner<BLOCKS>, figures: &mut FrameFigures| {
            while let Some(action) = planner.next_action() {
                if let Action::Phase(phase) = action {
                    figures.motion_s += f64::from(phase.duration_s);
                }
            }
        };
        for op in frame.ops() {
            let op = transform.op_to_machine(moved(op, by));
            if let Some(Point { x, y }) = op.target() {
                figures.outside +=
                    u64::from(!(0.0..=area.x).contains(&x) || !(-50.0..=area.y + 50.0).contains(&y));
            }
            figures.segments += u64::from(matches!(op, PlotOp::Draw { .. } | PlotOp::DrawArc { .. }));
            if !planner.has_room() {
                drain(&mut planner, &mut figures);
            }
            planner.push(op).map_err(|error| error.to_string())?;
        }
        drain(&mut planner, &mut figures);
        planner.finish().map_err(|error| error.to_string())?;
        drain(&mut planner, &mut figures);
        self.frames = figures;
        let local = Vec2::new(-frame.begin_mm(), 0.0) + by;
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
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| (low.min(place.x), high.max(place.x)));
    let mut at = Point::ORIGIN;
    for op in frame.ops().map(|op| moved(op, by)) {
        let from = at;
        at = op.target().unwrap_or(at);
        if !matches!(op, PlotOp::Draw { .. } | PlotOp::DrawArc { .. }) {
            continue;
        }
        let is_line = matches!(op, PlotOp::Draw { .. });
        if is_line && (from.x.max(at.x) < low - reach_mm || from.x.min(at.x) > high + reach_mm) {
            continue;
        }
        let path = [PlotOp::Travel { to: from }, op];
        let line: Vec<Point> = plotter_motion::chords(path, 0.02).filter_map(PlotOp::target).collect();
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
