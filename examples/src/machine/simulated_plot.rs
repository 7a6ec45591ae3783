//! A drawing, sent to a simulated gantry, with everything that happens on its serial line recorded.

use crate::machine::Recorded;
use core::time::Duration;
use plotter_motion::config::DcConfig;
use plotter_motion::plant::{Bench, BenchEvent, BenchSettings};
use plotter_motion::protocol::HostEvent;
use plotter_motion::{Machine, Pen, PenMove, Point, Segment, StepPoint};
use plotter_replay::BenchRecorder;
use std::fmt::Display;
use std::io::Write;

/// Result of a simulated plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlotOutcome {
    /// Targets of the drawing.
    pub targets: u32,
    /// Targets that were reached.
    pub reached: u32,
    /// Simulated time.
    pub duration: Duration,
    /// Root of the mean square of the true pen's distance from the lines that it drew, mm, over time.
    /// `None` where only the machine could know.
    pub true_rms_mm: Option<f64>,
    /// Greatest such distance, mm.
    pub true_max_mm: Option<f64>,
    /// What host and controller noticed, in their words, with the time.
    pub notices: Vec<String>,
}

/// Sends `moves` over the simulated line to the machine's controller and its simulated motors until all are
/// drawn or the host stops. What happens goes to `recorder`; `progress` learns how many targets are reached.
pub fn simulate<W: Write>(
    machine: &Machine,
    moves: Vec<PenMove>,
    recorded: Recorded,
    recorder: &mut BenchRecorder<W>,
    mut progress: impl FnMut(u32),
) -> PlotOutcome {
    let dc = DcConfig::of(machine);
    let on_sheet =
        |p: StepPoint| Point::new(f64::from(p.x) / dc.x.counts_per_mm, f64::from(p.y) / dc.y.counts_per_mm);
    let mut outcome =
        PlotOutcome { targets: u32::try_from(moves.len()).unwrap_or(u32::MAX), ..PlotOutcome::default() };
    let mut bench = Bench::new(machine, BenchSettings::default(), moves.into_iter());
    let (mut from, mut drawn) = (StepPoint::default(), None::<Segment>);
    let (mut square_mm2, mut max_mm, mut samples) = (0.0, 0.0_f64, 0_u32);
    while !bench.host().is_done() {
        bench.step(|time, event| {
            match event {
                BenchEvent::Drive(..) if !recorded.drive => return,
                BenchEvent::Host(HostEvent::Begun(PenMove { pen, target })) => {
                    let line = Segment::new(on_sheet(from), on_sheet(target));
                    drawn = (pen == Pen::Down).then_some(line);
                    from = target;
                }
                BenchEvent::Host(HostEvent::Reached(_)) => {
                    drawn = None;
                    outcome.reached += 1;
                    progress(outcome.reached);
                }
                BenchEvent::Host(HostEvent::Notice(notice)) => outcome.note(time, "host", &notice),
                BenchEvent::Controller(notice) => outcome.note(time, "controller", &notice),
                _ => {}
            }
            recorder.record(time, event);
        });
        if let Some(line) = drawn {
            let error_mm = line.distance(bench.position_mm());
            square_mm2 += error_mm * error_mm;
            samples += 1;
            max_mm = max_mm.max(error_mm);
        }
    }
    outcome.true_rms_mm = Some((square_mm2 / f64::from(samples.max(1))).sqrt());
    outcome.true_max_mm = Some(max_mm);
    outcome.duration = bench.now();
    outcome
}

impl PlotOutcome {
    pub(crate) fn note(&mut self, time: Duration, who: &str, notice: &impl Display) {
        self.notices.push(format!("{:.3} s: {who}: {notice}", time.as_secs_f64()));
    }
}
