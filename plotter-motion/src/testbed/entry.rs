//! [`Entry`]: a controller in a contest, and the ones that are always there.

use super::{Drawing, Figures, Moment, TestBed};
use crate::Machine;
use crate::config::DcConfig;
use crate::control::{
    ContourController, Contouring, CrossCoupled, CrossCoupledSettings, DriveRamp, LearnedBin, Learning,
    LearningSettings, LineController, LineTracking, LineTrackingSettings, PerAxis, PlannedLine, PlannedPid,
    PointToPointSettings, ShaftModel, TwoAxes,
};
use alloc::boxed::Box;
use alloc::string::String;
use alloc::vec::Vec;
use alloc::{format, vec};
use core::fmt;
use core::time::Duration;

type Make = dyn for<'a> Fn(&Machine, &'a mut [LearnedBin]) -> Box<dyn LineController + 'a> + Send + Sync;

/// What a learning controller may remember of a drawing, bins: half a minute of it. What comes after is drawn
/// without.
const STORE: usize = 1 << 16;

/// A controller that takes part: a name, and how one is made for a machine's description.
pub struct Entry {
    name: String,
    practice: u32,
    make: Box<Make>,
}

impl fmt::Debug for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Entry")
            .field("name", &self.name)
            .field("practice", &self.practice)
            .finish_non_exhaustive()
    }
}

impl Entry {
    /// A whole controller of a line, which may know nothing of plans.
    #[must_use]
    pub fn line<C: LineController + 'static>(
        name: &str,
        make: impl Fn(&Machine) -> C + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), practice: 0, make: Box::new(move |machine, _| Box::new(make(machine))) }
    }

    /// A control law for both axes, under a [`PlannedLine`].
    #[must_use]
    pub fn contour<C: ContourController + 'static>(
        name: &str,
        make: impl Fn(&Machine) -> C + Send + Sync + 'static,
    ) -> Self {
        Self::line(name, move |machine| PlannedLine::new(machine, make(machine)))
    }

    /// A control law for both axes that [`Learning`] helps, after so many runs of the same drawing for
    /// practice.
    #[must_use]
    pub fn learning<C: ContourController + 'static>(
        name: &str,
        practice: u32,
        make: impl Fn(&Machine) -> C + Send + Sync + 'static,
    ) -> Self {
        let make: Box<Make> = Box::new(move |machine, store| {
            let learning = Learning::new(make(machine), LearningSettings::of(machine), store);
            Box::new(PlannedLine::new(machine, learning))
        });
        Self { name: name.into(), practice, make }
    }

    /// Name of the entry, as in tables.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Lets it make a drawing, after its practice; `watch` sees every time step of the run that counts.
    pub fn run(&self, bed: &TestBed, drawing: &Drawing, watch: impl FnMut(&Moment)) -> Figures {
        let mut store = vec![LearnedBin::default(); if self.practice > 0 { STORE } else { 0 }];
        let moves = || drawing.moves.iter().copied();
        for _ in 0..self.practice {
            let mut controller = (self.make)(bed.described(), &mut store);
            bed.run(&mut *controller, moves(), |_| ());
        }
        let mut controller = (self.make)(bed.described(), &mut store);
        bed.run(&mut *controller, moves(), watch)
    }

    /// The published controllers and ours, as the thesis and the marking board's report have them and from
    /// the plainest of ours to the best:
    ///
    /// | name | what |
    /// |---|---|
    /// | `published` | [`LineTracking`] |
    /// | `published-60` | the same with the duty of y limited to 60 of 255 |
    /// | `point-to-point` | [`PerAxis`]: one level of drive, for the machine's feed, until within 0.45 mm |
    /// | `contouring` | [`Contouring`], the firmware's |
    /// | `planned-pid` | [`PlannedPid`] on a planned reference |
    /// | `feed-forward` | the same with the duty that the plan needs |
    /// | `cross-coupled` | the same with [`CrossCoupled`] |
    /// | `learning` | the same after ten runs with [`Learning`] |
    #[must_use]
    pub fn standard() -> Vec<Self> {
        let feed_forward = |machine: &Machine| TwoAxes::<PlannedPid>::of(machine).with_feed_forward();
        let cross_coupled = move |machine: &Machine| {
            CrossCoupled::new(feed_forward(machine), CrossCoupledSettings::of(machine))
        };
        vec![
            Self::line("published", LineTracking::new),
            Self::line("published-60", |machine| {
                /// Greatest duty of y, in steps of 255, in place of the published 255: a weaker variant of
                /// the published controller for comparison.
                const LOWER_LIMIT: f32 = 60.0;
                let mut settings = LineTrackingSettings::of(machine);
                settings.published.duty_limit_y = settings.published.duty_limit_y.min(LOWER_LIMIT);
                LineTracking::with_settings(settings)
            }),
            Self::line("point-to-point", |machine| PerAxis::new(point_to_point(machine))),
            Self::line("contouring", Contouring::new),
            Self::contour("planned-pid", TwoAxes::<PlannedPid>::of),
            Self::contour("feed-forward", feed_forward),
            Self::contour("cross-coupled", cross_coupled),
            Self::learning("learning", 10, cross_coupled),
        ]
    }
}

/// As published, at the level of drive that holds the machine's feed on the axis that needs more of it.
fn point_to_point(machine: &Machine) -> PointToPointSettings {
    /// Allowed error, mm. Source: Khan and McGinn, "2D Controlled Marking Board", which draws its circle with
    /// it.
    const ALLOWED_MM: f64 = 0.45;
    let config = DcConfig::of(machine);
    let counts_per_mm = config.x.counts_per_mm.min(config.y.counts_per_mm);
    #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
    let (allowed_counts, feed) =
        ((ALLOWED_MM * counts_per_mm) as f32, (config.control.contouring.feed_mm_s * counts_per_mm) as f32);
    let level = |model: ShaftModel| {
        (model.damping_per_s * feed + model.dry_friction) / (model.accel_per_volt * model.supply_v)
    };
    let most = level(ShaftModel::new(&config.x)).max(level(ShaftModel::new(&config.y))).clamp(0.0, 1.0);
    PointToPointSettings {
        allowed_counts,
        ramp: DriveRamp { start: most, step: 0.0, most, period: Duration::ZERO },
        ..PointToPointSettings::default()
    }
}

/// Results of an entry on a machine: each drawing with its figures.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// The entry's name.
    pub entry: String,
    /// The drawings' names and figures.
    pub drawings: Vec<(String, Figures)>,
}

impl Score {
    /// Lets an entry make all drawings.
    #[must_use]
    pub fn run(entry: &Entry, bed: &TestBed, drawings: &[Drawing]) -> Self {
        let run = |drawing: &Drawing| (drawing.name.clone(), entry.run(bed, drawing, |_| ()));
        Self { entry: entry.name().into(), drawings: drawings.iter().map(run).collect() }
    }

    /// All drawings as one.
    #[must_use]
    pub fn total(&self) -> Figures {
        self.drawings.iter().map(|(_, figures)| *figures).sum()
    }

    fn count(&self, which: impl Fn(&Figures) -> bool) -> usize {
        self.drawings.iter().filter(|(_, figures)| which(figures)).count()
    }

    /// How many drawings it finished.
    #[must_use]
    pub fn finished(&self) -> usize {
        self.count(Figures::is_finished)
    }

    /// After how many the pen settled at the target.
    #[must_use]
    pub fn settled(&self) -> usize {
        self.count(|figures| figures.settled.is_some())
    }
}

/// Entries by their place: who finished more drawings comes first, then who was nearer to the lines.
///
/// `{}` is a table with a line for each.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranking {
    scores: Vec<Score>,
}

impl Ranking {
    /// Ranks scores. An entry that is so far off that nothing can be measured comes last.
    #[must_use]
    pub fn new(mut scores: Vec<Score>) -> Self {
        let key = |score: &Score| (score.total().rms_mm(), score.drawings.len() - score.finished());
        scores.sort_by(|one, other| {
            let ((rms, unfinished), (other_rms, other_unfinished)) = (key(one), key(other));
            unfinished.cmp(&other_unfinished).then(rms.total_cmp(&other_rms))
        });
        Self { scores }
    }

    /// Lets all entries make all drawings on one machine, and ranks them.
    #[must_use]
    pub fn run(entries: &[Entry], bed: &TestBed, drawings: &[Drawing]) -> Self {
        Self::new(entries.iter().map(|entry| Score::run(entry, bed, drawings)).collect())
    }

    /// The scores, best first.
    #[must_use]
    pub fn scores(&self) -> &[Score] {
        &self.scores
    }

    /// The place of an entry, from 1.
    #[must_use]
    pub fn place(&self, entry: &str) -> Option<usize> {
        self.scores.iter().position(|score| score.entry == entry).map(|index| index + 1)
    }
}

impl fmt::Display for Ranking {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let published =
            self.scores.iter().find(|score| score.entry == "published").map(|s| s.total().rms_mm());
        let width = self.scores.iter().map(|score| score.entry.chars().count()).max().unwrap_or(0).max(10);
        writeln!(
            f,
            "   {:width$}  {:>9}  {:>9}  {:>8}  {:>8}  {:>8}  {:>7}  {:>9}",
            "controller", "rms um", "max um", "finished", "settled", "time s", "J", "better by"
        )?;
        for (place, score) in self.scores.iter().enumerate() {
            let total = score.total();
            let of = |count: usize| format!("{count}/{}", score.drawings.len());
            let times = match published {
                Some(published) if total.rms_mm() > 0.0 => format!("{:.1}", published / total.rms_mm()),
                _ => String::new(),
            };
            writeln!(
                f,
                "{:2} {:width$}  {:9.3}  {:9.2}  {:>8}  {:>8}  {:8.2}  {:7.2}  {:>9}",
                place + 1,
                score.entry,
                total.rms_mm() * 1e3,
                total.max_mm * 1e3,
                of(score.finished()),
                of(score.settled()),
                total.time.as_secs_f64(),
                total.energy_j,
                times
            )?;
        }
        Ok(())
    }
}
