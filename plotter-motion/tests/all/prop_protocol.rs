//! Laws of host, line and targets under any answers, pauses and drawings.

use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::protocol::digits::{GREATEST, Receiver};
use plotter_motion::protocol::{Host, HostEvent, HostNotice, HostSettings, Wire};
use plotter_motion::{
    Machine, MachineConfig, Pen, PenMove, PlotOp, Point, StepPoint,
    profile::SCurve,
    toolpath::{from_mm, targets},
};
use proptest::prelude::*;

fn moves() -> impl Strategy<Value = Vec<PenMove>> {
    let coordinate = || prop_oneof![8 => 0..=GREATEST, 1 => any::<i32>()];
    prop::collection::vec(
        (coordinate(), coordinate())
            .prop_map(|(x, y)| PenMove { pen: Pen::Down, target: StepPoint::new(x, y) }),
        0..6,
    )
}

fn duration() -> impl Strategy<Value = Duration> {
    prop_oneof![
        1 => Just(Duration::ZERO),
        8 => (0..3_000_000_u64).prop_map(Duration::from_micros),
        1 => Just(Duration::MAX),
    ]
}

fn settings() -> impl Strategy<Value = HostSettings> {
    (duration(), duration(), any::<u8>(), 1..20_u8, prop_oneof![0..3_u32, any::<u32>()]).prop_map(
        |(silence, patience, most_retries, most_given_up, tolerance_counts)| HostSettings {
            silence,
            patience,
            most_retries,
            most_given_up,
            tolerance_counts,
        },
    )
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn a_host_keeps_its_pauses_and_sends_whole_digits_whatever_is_answered(
        moves in moves(),
        settings in settings(),
        byte_gap in duration(),
        looks in prop::collection::vec((duration(), any::<bool>(), prop_oneof![Just(b'+'), Just(b'1'), any::<u8>()]), 1..300),
    ) {
        let mut host = Host::new(byte_gap, settings, moves.clone().into_iter());
        let (mut now, mut last) = (Duration::ZERO, None::<Duration>);
        let mut begun = Vec::new();
        for (pause, answers, answer) in looks {
            // half of the looks come when the host asks for it, the others at any time
            now = match host.next_wake() {
                Some(wake) if pause.subsec_micros() % 2 == 0 => now.max(wake),
                _ => now.saturating_add(pause),
            };
            if let Some(HostEvent::Begun(next)) = host.poll(now) {
                begun.push(next);
            }
            if let Some(byte) = host.next_byte(now) {
                prop_assert!(byte <= 9);
                if let Some(last) = last {
                    prop_assert!(now >= last.saturating_add(byte_gap), "{byte_gap:?} after {last:?}, at {now:?}");
                }
                last = Some(now);
            }
            if answers {
                host.receive(now, answer);
            }
            let (sent, reached) = host.progress();
            prop_assert!(reached <= sent && sent as usize == begun.len());
        }
        let good = |m: &&PenMove| [m.target.x, m.target.y].iter().all(|v| (0..=GREATEST).contains(v));
        prop_assert!(begun.iter().eq(moves.iter().filter(good).take(begun.len())), "in order, none twice");
    }

    /// Woken when it asks for it, and never answered, a host comes to its end after as many looks as its
    /// settings say, and at none of them without anything to do.
    #[test]
    fn a_host_that_nobody_answers_comes_to_its_end(
        moves in moves(), retries in 0..4_u8, byte_gap_ms in 0..1_000_u64, most_given_up in 1..4_u8,
    ) {
        let settings = HostSettings { most_retries: retries, most_given_up, ..HostSettings::default() };
        let gap = Duration::from_millis(byte_gap_ms);
        let mut host = Host::new(gap, settings, moves.clone().into_iter());
        let mut receiver = Receiver::new(gap + Duration::from_millis(1));
        let (mut whole, mut given_up) = (Vec::new(), 0_u32);
        let most_looks = 3 + moves.len() * (2 + 11 * (usize::from(retries) + 1));
        let mut looks = 0;
        while let Some(now) = host.next_wake() {
            looks += 1;
            prop_assert!(looks <= most_looks, "{looks} looks");
            let event = host.poll(now);
            given_up += u32::from(matches!(event, Some(HostEvent::Notice(HostNotice::GaveUp { .. }))));
            let byte = host.next_byte(now);
            whole.extend(byte.and_then(|byte| receiver.push(now, byte).target));
        }
        prop_assert!(host.is_done());
        let (sent, reached) = host.progress();
        prop_assert_eq!((given_up, reached), (sent, 0));
        prop_assert!(sent <= u32::from(most_given_up));
        prop_assert!(sent == 0 || whole.len() >= sent as usize, "each target was out before it was given up");
    }

    #[test]
    fn a_line_gives_bytes_through_in_order_and_no_faster_than_it_is(
        baud in prop_oneof![300..4_000_000_u32, any::<u32>()],
        offers in prop::collection::vec(duration(), 1..100),
    ) {
        let mut wire = Wire::new(baud);
        let (mut now, mut last) = (Duration::ZERO, Duration::ZERO);
        let byte = Duration::from_nanos(10_000_000_000 / u64::from(baud.max(1)));
        let mut sent = 0;
        for pause in offers.iter().filter(|&&pause| pause < Duration::MAX) {
            now += *pause;
            let through = wire.send(now);
            sent += 1;
            prop_assert!(through >= last && through >= now + byte, "{through:?}");
            prop_assert!(through >= byte * sent);
            last = through;
        }
        let _ = wire.send(Duration::MAX);
        prop_assert!(wire.send(Duration::ZERO) >= last); // an offer out of order waits
    }

    /// Any points: every move lies in the machine's area, every refusal names a point that does not, and no
    /// line is drawn but those of the tool path.
    #[test]
    fn targets_hold_nothing_but_what_the_machine_reaches(
        path in prop::collection::vec(
            (any::<bool>(), prop_oneof![-100.0..700.0, any::<f64>()], prop_oneof![-100.0..700.0, any::<f64>()]),
            0..30,
        ),
    ) {
        let machine = Machine::new(MachineConfig::default()).unwrap();
        let ops = path.iter().map(|&(draw, x, y)| {
            let to = Point::new(x, y);
            if draw { PlotOp::Draw { to, feed_mm_s: None } } else { PlotOp::Travel { to } }
        });
        let counts = |to: Point| StepPoint::new(from_mm(to.x, 40.0), from_mm(to.y, 40.0));
        let most = StepPoint::new(23_760, 16_800); // 594 and 420 mm
        let lines: Vec<_> = [Point::ORIGIN].into_iter().chain(ops.clone().filter_map(PlotOp::target)).collect();
        let mut position = StepPoint::default();
        for item in targets(&machine, ops) {
            match item {
                Ok(PenMove { pen, target }) => {
                    prop_assert!((0..=most.x).contains(&target.x) && (0..=most.y).contains(&target.y));
                    let is_line = lines.windows(2).any(|w| counts(w[0]) == position && counts(w[1]) == target);
                    prop_assert!(pen == Pen::Up || is_line, "{position:?} to {target:?}");
                    position = target;
                }
                Err(error) => {
                    let Point { x, y } = error.point;
                    let inside = x.is_finite() && y.is_finite() && x >= 0.0 && y >= 0.0 && x <= 594.0 && y <= 420.0;
                    prop_assert!(!inside, "{error}");
                }
            }
        }
    }

    #[test]
    fn a_planned_motion_is_finite_or_refused(
        length_mm in any::<f64>(), speed_mm_s in any::<f64>(), accel_mm_s2 in any::<f64>(), jerk_mm_s3 in any::<f64>(),
        time_s in any::<f64>(),
    ) {
        let limits = plotter_motion::MotionLimits { speed_mm_s, accel_mm_s2, jerk_mm_s3 };
        // and within the bounds, to their corners
        let within = |v: f64| 1e-18 * 1e36_f64.powf((v.abs().log10().abs() / 400.0).min(1.0));
        let squeezed = plotter_motion::MotionLimits {
            speed_mm_s: within(speed_mm_s), accel_mm_s2: within(accel_mm_s2), jerk_mm_s3: within(jerk_mm_s3),
        };
        for motion in [SCurve::plan(length_mm, limits), SCurve::plan(within(length_mm), squeezed)].into_iter().flatten() {
            prop_assert!(motion.duration_s().is_finite() && motion.duration_s() >= 0.0);
            for t in [time_s, f64::NAN, motion.duration_s() * 0.3, motion.duration_s()] {
                let point = motion.at(t);
                prop_assert!(
                    point.distance_mm.is_finite() && point.speed_mm_s.is_finite() && point.accel_mm_s2.is_finite(),
                    "{motion:?} at {t}: {point:?}"
                );
            }
        }
    }
}

/// A host with a pause of a second after each byte, which the machine's file allows, waits for ten of them.
#[test]
fn a_slow_line_does_not_use_up_the_patience() {
    let target = PenMove { pen: Pen::Down, target: StepPoint::new(1, 0) };
    let mut host = Host::new(Duration::from_secs(1), HostSettings::default(), [target].into_iter());
    let mut bytes = 0;
    let mut silent_at = None;
    while silent_at.is_none() {
        let now = host.next_wake().unwrap();
        match host.poll(now) {
            Some(HostEvent::Notice(HostNotice::Silent { .. })) => silent_at = Some(now),
            event => assert!(matches!(event, None | Some(HostEvent::Begun(_))), "{event:?}"),
        }
        bytes += u32::from(silent_at.is_none() && host.next_byte(now).is_some());
    }
    // 9 s of pauses, 2 s of silence.
    assert_eq!((bytes, silent_at), (10, Some(Duration::from_micros(11_000_001))));
}

#[test]
fn a_line_from_a_point_out_of_reach_is_not_drawn() {
    let machine = Machine::new(MachineConfig::default()).unwrap();
    let draw = |x, y| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
    let pens: Vec<_> = targets(&machine, [draw(1.0, 1.0), draw(-1.0, 1.0), draw(5.0, 5.0), draw(6.0, 5.0)])
        .map(|item| item.map(|m| m.pen).ok())
        .collect();
    assert_eq!(pens, [Some(Pen::Down), None, Some(Pen::Up), Some(Pen::Down)]);
}
