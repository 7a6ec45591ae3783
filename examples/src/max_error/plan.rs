//! The split of the error with which the drawing is done soonest, or why there is none.

use super::command::MaxErrorCommand;
use super::scan::{Scan, Traced, candidates};
use crate::max_error::{TruePath, predicted_s, rounding_mm, slowed, speed_trial};
use crate::shared::WorkShown;
use plotter_motion::{
    Machine, PlotOp,
    budget::{Budget, BudgetError, BudgetLimits},
    config::MachineKind,
};
use plotter_vector::report::FollowedLines;

/// How much worse a drawing may be than the test figure, which was drawn with the same motors but other
/// lines.
pub(super) const SAFETY: f64 = 1.5;

/// Share of the speed at which the machine is tried a second time, and which is the least that is proposed: a
/// quarter of the speed and a sixteenth of the acceleration. Far below that a motor is no more exact, since
/// its encoder is seldom heard of.
const SLOW_SHARE: f64 = 0.25;

/// What is drawn, and how.
pub(super) struct Plan {
    pub(super) budget: Budget,
    pub(super) traced: Traced,
    pub(super) machine: Machine,
    pub(super) ops: Vec<PlotOp>,
    pub(super) control: Control,
}

/// What control makes of the error, by the test figure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Control {
    pub(super) rounding_mm: f64,
    /// Greatest share of the machine's speed at which it finishes the figure.
    most_share: f64,
    /// Measured at that share, and at a quarter of it.
    pub(super) fast_mm: f64,
    pub(super) slow_mm: f64,
}

impl Control {
    pub(super) fn measured(machine: &Machine, length_mm: f64) -> Result<Self, String> {
        /// A machine that does not move at a hundredth of its speed never does.
        const LEAST_SHARE: f64 = 0.01;
        let trial_mm = |speed_share| {
            let slower = Budget { vectorization_mm: 0.0, blend_mm: 0.0, control_mm: 0.0, speed_share };
            speed_trial(&slowed(machine, &slower)?, length_mm, 0.0)
        };
        let mut most_share = 1.0;
        let mut fast_mm = trial_mm(most_share)?;
        while fast_mm.is_infinite() && most_share > LEAST_SHARE {
            most_share *= 0.5;
            fast_mm = trial_mm(most_share)?;
        }
        if fast_mm.is_infinite() {
            return Err(String::from(
                "control: the machine does not finish its test figure at any speed, so no error can be promised",
            ));
        }
        let slow_mm = trial_mm(SLOW_SHARE * most_share)?;
        Ok(Self { rounding_mm: rounding_mm(machine), most_share, fast_mm, slow_mm })
    }

    /// What is promised when the test figure is `trial_mm` off. The places of the pen are kept within a
    /// micrometre.
    pub(super) fn promised_mm(&self, trial_mm: f64) -> f64 {
        self.rounding_mm + SAFETY * (trial_mm + TruePath::TOLERANCE_MM)
    }

    fn limits(&self) -> BudgetLimits {
        // A machine that is less exact when it is slow has nothing to gain from slowness.
        let grows_mm = SAFETY * (self.fast_mm - self.slow_mm).max(0.0);
        let moving_mm = grows_mm / (1.0 - SLOW_SHARE * SLOW_SHARE);
        BudgetLimits {
            standing_mm: (self.promised_mm(self.fast_mm) - moving_mm).max(0.0),
            moving_mm,
            least_speed_share: SLOW_SHARE,
            ..BudgetLimits::default()
        }
    }
}

/// Why there is no plan.
#[derive(Clone, Debug)]
pub(super) enum Refusal {
    Budget(BudgetError),
    Other(String),
}

impl From<String> for Refusal {
    fn from(text: String) -> Self {
        Self::Other(text)
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Budget(error) => error.fmt(f),
            Self::Other(text) => f.write_str(text),
        }
    }
}

/// The split with which the drawing is done soonest.
pub(super) fn plan(
    args: &MaxErrorCommand,
    machine: &Machine,
    scan: &Scan,
    bar: &WorkShown,
) -> Result<Plan, Refusal> {
    let asked_mm = args.max_error_mm;
    // Whether it is a length at all comes before all work.
    if let Err(error @ BudgetError::NoLength { .. }) = Budget::split(asked_mm, &BudgetLimits::default()) {
        return Err(Refusal::Other(format!("--max-error-mm: {error}")));
    }
    bar.say("trying the machine on its test figure");
    let control = Control::measured(machine, scan.diagonal_mm())?;
    let blends = machine.kind() == MachineKind::Steppers;
    bar.say("tracing");
    let mut best: Option<(f64, Budget, Traced)> = None;
    let mut refusal: Option<BudgetError> = None;
    // Of those with lines that run together, the one with the fewest.
    let mut broken: Option<FollowedLines> = None;
    for traced in candidates(scan, asked_mm)? {
        let limits = BudgetLimits {
            vectorization_least_mm: traced.error_mm,
            vectorization_most_mm: traced.error_mm,
            blend_most_mm: if blends { asked_mm } else { 0.0 },
            ..control.limits()
        };
        match Budget::split(asked_mm, &limits) {
            Ok(budget) => {
                let ops: Vec<PlotOp> = traced.drawing.plot_ops(scan.scale).collect();
                let budget = Budget { speed_share: control.most_share * budget.speed_share, ..budget };
                let time_s = predicted_s(&slowed(machine, &budget)?, &ops, budget.blend_mm)?;
                if best.as_ref().is_some_and(|(least_s, ..)| time_s >= *least_s) {
                    continue;
                }
                let followed = scan.followed(&traced.drawing, traced.error_mm);
                if args.allow_merged_lines || followed.broken() == 0 {
                    best = Some((time_s, budget, traced));
                } else if broken.as_ref().is_none_or(|least| followed.broken() < least.broken()) {
                    broken = Some(followed);
                }
            }
            Err(error) => refusal = Some(least(refusal, error)),
        }
    }
    let Some((_, budget, traced)) = best else {
        if let Some(broken) = broken {
            return Err(Refusal::Other(broken_lines(&broken)));
        }
        return Err(refusal.map_or_else(|| Refusal::Other("nothing to draw".into()), Refusal::Budget));
    };
    bar.say("trying the machine as it is to draw");
    let (budget, machine) = confirmed(machine, scan, budget, &control)?;
    let ops = traced.drawing.plot_ops(scan.scale).collect();
    Ok(Plan { budget, machine, traced, ops, control })
}

/// The budget with a speed at which the test figure keeps it: what was measured at two speeds says nothing
/// sure of those between, nor of rounded corners.
fn confirmed(
    machine: &Machine,
    scan: &Scan,
    mut budget: Budget,
    control: &Control,
) -> Result<(Budget, Machine), String> {
    const SLOWER: f64 = 0.85;
    const ROUNDING_MM: f64 = 1e-9;
    let allowed_mm = budget.control_mm + budget.blend_mm;
    loop {
        let slower = slowed(machine, &budget)?;
        if budget.speed_share >= control.most_share && budget.blend_mm == 0.0 {
            return Ok((budget, slower)); // as it was tried
        }
        let trial_mm = speed_trial(&slower, scan.diagonal_mm(), budget.blend_mm)?;
        // Rounded corners are planned, not found out: no safety is needed for them.
        let found_mm = control.promised_mm((trial_mm - budget.blend_mm).max(0.0)) + budget.blend_mm;
        if found_mm <= allowed_mm + ROUNDING_MM {
            return Ok((budget, slower));
        }
        if budget.speed_share <= SLOW_SHARE * control.most_share {
            return Err(format!(
                "control: the test figure is {trial_mm:.4} mm off at {:.0} % of the speed, more than was allowed",
                100.0 * budget.speed_share
            ));
        }
        budget.speed_share = (SLOWER * budget.speed_share).max(SLOW_SHARE * control.most_share);
    }
}

/// The one that could promise more.
fn least(before: Option<BudgetError>, error: BudgetError) -> BudgetError {
    let smallest = |error: &BudgetError| match error {
        BudgetError::TooSmall { smallest_mm, .. } => *smallest_mm,
        _ => f64::INFINITY,
    };
    before.filter(|before| smallest(before) <= smallest(&error)).unwrap_or(error)
}

/// Which lines of the scan nothing drawn follows, and what can be done, in words.
pub(super) fn broken_lines(followed: &FollowedLines) -> String {
    let at = followed.dropped.iter().chain(&followed.merged).next();
    let at = at.map_or_else(String::new, |at| format!(", the first at ({:.0}, {:.0}) px", at.x, at.y));
    format!(
        "{} of {} lines of the scan are not drawn as lines of their own ({} merged, {} dropped{at}); ask for another \
         error, or allow it with --allow-merged-lines",
        followed.broken(),
        followed.lines,
        followed.merged.len(),
        followed.dropped.len()
    )
}
