//! Drawings through planner and step generator, audited by their steps.

mod auditor;
mod drawings;

use auditor::{Audit, Lens, audit};
use plotter_motion::{PathMode, PlannerSettings};

const FINE: Lens =
    Lens { steps_per_mm: 10_000.0, clock_hz: 1e8, bin_s: 0.000_05, window: 40, wide_window: 560 };

fn modes() -> [(&'static str, PlannerSettings); 4] {
    let exact = PlannerSettings::default();
    let tolerance = PlannerSettings { path: PathMode::Tolerance { path_tolerance_mm: 0.05 }, ..exact };
    let curved = |settings| PlannerSettings { jerk_mm_s3: Some(20_000.0), ..settings };
    [
        ("exact", exact),
        ("tolerance", tolerance),
        ("exact s-curve", curved(exact)),
        ("tolerance s-curve", curved(tolerance)),
    ]
}

#[test]
fn look() {
    for drawing in drawings::built() {
        for (mode, settings) in modes() {
            if let Ok(only) = std::env::var("ONLY")
                && only != format!("{} {mode}", drawing.name)
            {
                continue;
            }
            let lens = if settings.jerk_mm_s3.is_some() { Lens { window: 160, ..FINE } } else { FINE };
            let seen: Audit = audit::<16>(settings, lens, &drawing.ops);
            println!("{:8} {mode:18} {seen:.3?}", drawing.name);
        }
    }
}
