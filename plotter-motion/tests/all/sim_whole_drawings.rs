//! Whole drawings on motors that nobody measured: every constant of the description is wrong by a share, up
//! or down by chance.
//!
//! `cargo test --release -p plotter-motion --test all sim_whole_drawings:: -- --ignored --nocapture` prints
//! the tables of docs/results/whole-drawings.md, with all controllers and twenty seeds.

#![cfg(all(feature = "alloc", feature = "toml"))]

use crate::figure::Figure;
use crate::papers::row_of;
use crate::sampled::sampled;
use core::time::Duration;
use plotter_motion::testbed::{Drawing, Entry, Figures, HandlingTimes, LateLoop, TestBed, TestBedSettings};
use plotter_motion::{Machine, MachineConfig, Pen, PenMove, Point, config::AxisConfig};

/// Numbers by chance, the same on every machine (xorshift64*).
struct Chance(u64);

impl Chance {
    #[expect(clippy::cast_precision_loss, reason = "53 bits")]
    fn share(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.share()
    }
}

fn machine(name: &str) -> Machine {
    let file = format!("{}/../examples/machines/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}"));
    Machine::new(MachineConfig::from_toml(&text).unwrap()).unwrap()
}

/// The description of a machine with every constant of motor and load wrong by `share`, each up or down by
/// chance.
fn misdescribed(machine: &Machine, share: f64, seed: u64) -> Machine {
    let mut chance = Chance(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    for _ in 0..8 {
        chance.share();
    }
    let mut config = *machine.config();
    let mut wrong = |axis: &mut AxisConfig| {
        let mut by = || if chance.share() < 0.5 { 1.0 - share } else { 1.0 + share };
        axis.motor.inertia_kg_m2 *= by();
        axis.motor.resistance_ohm *= by();
        axis.motor.torque_n_m_per_a *= by();
        axis.motor.back_emf_v_s *= by();
        let load = by();
        axis.load.inertia_kg_m2 *= load;
        axis.transmission.carriage_kg *= load;
        axis.load.viscous_n_m_s *= by();
        let friction = by();
        axis.load.coulomb_n_m *= friction;
        axis.load.static_n_m *= friction;
        axis.transmission.rail_friction_n *= friction;
    };
    wrong(&mut config.dc_mut().unwrap().x);
    wrong(&mut config.dc_mut().unwrap().y);
    Machine::new(config).unwrap()
}

/// A drawing of places in mm; the pen is up on the way to those that say so.
fn drawing(bed: &TestBed, name: &str, places: impl IntoIterator<Item = (f64, f64, Pen)>) -> Drawing {
    let target = |(x, y, pen)| PenMove { pen, target: bed.counts(Point::new(x, y)) };
    Drawing { name: name.into(), moves: places.into_iter().map(target).collect() }
}

const UP: Pen = Pen::Up;
const DOWN: Pen = Pen::Down;

/// Five turns of a spiral in 160 chords.
fn spiral(bed: &TestBed) -> Drawing {
    let place = |index: u32| {
        let along = f64::from(index) / 160.0;
        let (sin, cos) = (along * 5.0 * std::f64::consts::TAU).sin_cos();
        let radius = 2.0 + 20.0 * along;
        (40.0 + radius * cos, 40.0 + radius * sin, if index == 0 { UP } else { DOWN })
    };
    drawing(bed, "spiral", (0..=160).map(place))
}

/// 150 strokes of 0.2 to 10 mm in any direction.
fn strokes(bed: &TestBed, seed: u64) -> Drawing {
    let mut chance = Chance(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let (mut x, mut y): (f64, f64) = (20.0, 20.0);
    let mut places = vec![(x, y, UP)];
    for _ in 0..150 {
        let length = 10.0_f64.powf(chance.between(-0.7, 1.0));
        let (sin, cos) = chance.between(0.0, std::f64::consts::TAU).sin_cos();
        (x, y) = ((x + length * cos).clamp(2.0, 90.0), (y + length * sin).clamp(2.0, 90.0));
        places.push((x, y, if chance.share() < 0.85 { DOWN } else { UP }));
    }
    drawing(bed, "strokes by chance", places)
}

/// Loops of 2 mm in a row, as a hand writes them.
fn handwriting(bed: &TestBed) -> Drawing {
    let place = |index: u32| {
        let t = f64::from(index) * 0.37;
        let (x, y) = (0.7 * t + 1.6 * t.sin(), 2.2 * (1.13 * t + 0.4).cos() + 0.8 * (2.3 * t).sin());
        (5.0 + x, 50.0 + y, if index.is_multiple_of(23) { UP } else { DOWN })
    };
    drawing(bed, "handwriting", (0..260).map(place))
}

/// Frames, lines nearly along the axes, circles of 24 chords, short ticks.
fn technical(bed: &TestBed) -> Drawing {
    let mut places = vec![(10.0, 10.0, UP), (60.0, 10.0, DOWN), (60.0, 40.0, DOWN), (10.0, 40.0, DOWN)];
    places.extend([(10.0, 10.0, DOWN), (12.0, 12.3, UP), (58.0, 12.8, DOWN), (58.3, 38.0, DOWN)]);
    places.push((11.5, 37.4, DOWN));
    for circle in 0..4 {
        let middle = 18.0 + 10.0 * f64::from(circle);
        places.push((middle + 3.0, 25.0, UP));
        for chord in 1..=24 {
            let (sin, cos) = (f64::from(chord) / 24.0 * std::f64::consts::TAU).sin_cos();
            places.push((middle + 3.0 * cos, 25.0 + 3.0 * sin, DOWN));
        }
    }
    for tick in 0..10 {
        let x = 12.0 + 4.0 * f64::from(tick);
        places.extend([
            (x, 14.0, UP),
            (x + 1.0, 14.0 + 0.05 * f64::from(tick), DOWN),
            (x + 1.07, 20.0, DOWN),
        ]);
    }
    drawing(bed, "technical", places)
}

fn drawings(bed: &TestBed, seed: u64) -> [Drawing; 4] {
    [spiral(bed), strokes(bed, seed), handwriting(bed), technical(bed)]
}

/// A machine, what is unlike the others in how it is driven, and what is promised of it: rms and greatest
/// distance, mm.
struct Bench {
    name: &'static str,
    drive: Drive,
    promised_mm: Option<[f64; 2]>,
}

#[derive(Clone, Copy)]
enum Drive {
    /// As its file says, and each run of the loop when it should come.
    AsDescribed,
    /// The PWM is on the bridge's enable pin, at so many Hz: the motor coasts between its pulses.
    OnEnablePin(f64),
    /// Each run of the loop is late by up to half a period, and one in 500 by a millisecond.
    Late,
    /// On a processor whose instructions take their time.
    Counted,
}

/// Instructions of an edge and of a run of the loop, the most of them that `examples/firmware/counts/check`
/// lets through, and how many a Cortex-M4 at 100 MHz does a second: one a cycle, two for what it loads.
const COUNTED: [u32; 3] = [900, 10_300, 100_000_000];

impl Bench {
    const fn new(name: &'static str, drive: Drive, promised_mm: [f64; 2]) -> Self {
        Self { name, drive, promised_mm: Some(promised_mm) }
    }

    fn machine(&self) -> Machine {
        let mut config = *machine(self.name).config();
        if let Drive::OnEnablePin(hz) = self.drive {
            (
                config.dc_mut().unwrap().x.motor.enable_pwm_hz,
                config.dc_mut().unwrap().y.motor.enable_pwm_hz,
            ) = (hz, hz);
        }
        Machine::new(config).unwrap()
    }

    /// With every constant of the description wrong by `share`.
    fn bed(&self, share: f64, seed: u64) -> TestBed {
        self.bed_with(share, seed, TestBedSettings::default())
    }

    fn bed_with(&self, share: f64, seed: u64, settings: TestBedSettings) -> TestBed {
        let machine = self.machine();
        let late_loop = match self.drive {
            Drive::Late => LateLoop {
                jitter: Duration::from_secs_f64(
                    0.5 / machine.config().dc().unwrap().control.contouring.loop_hz,
                ),
                late: Duration::from_millis(1),
                one_in: 500,
                seed,
            },
            Drive::AsDescribed | Drive::OnEnablePin(_) | Drive::Counted => LateLoop::default(),
        };
        let handling = if matches!(self.drive, Drive::Counted) {
            let [edge, run, per_s] = COUNTED;
            HandlingTimes::of_instructions(edge, run, per_s)
        } else {
            HandlingTimes::default()
        };
        let settings = TestBedSettings { late_loop, handling, ..settings };
        TestBed::with_description(&machine, &misdescribed(&machine, share, seed), settings)
    }

    fn about(&self) -> String {
        let name = self.name;
        match self.drive {
            Drive::AsDescribed => name.into(),
            Drive::OnEnablePin(hz) => format!("{name}, PWM of {hz} Hz on the enable pin"),
            Drive::Late => format!("{name}, late loop"),
            Drive::Counted => format!("{name}, counted instructions"),
        }
    }
}

fn entry(name: &str) -> Entry {
    Entry::standard().into_iter().find(|entry| entry.name() == name).unwrap()
}

/// What is promised of machines whose pen is where the shaft is: rms and greatest distance, mm.
const X1_MM: [f64; 2] = [0.03, 0.1];
const X4_MM: [f64; 2] = [0.005, 0.1];

static RMS: Figure = Figure::of("mm rms");
static FARTHEST: Figure = Figure::of("mm at most");

fn assert_kept(figures: &Figures, promised_mm: Option<[f64; 2]>, about: &str) {
    let Some([rms_mm, max_mm]) = promised_mm else { return };
    RMS.note(figures.rms_mm());
    FARTHEST.note(figures.max_mm);
    assert!(figures.is_finished() && figures.settled.is_some(), "{about}: {figures:?}");
    assert_eq!(figures.lost_counts, 0, "{about}: {figures:?}");
    assert!(figures.rms_mm() <= rms_mm && figures.max_mm <= max_mm, "{about}: {figures:?}");
}

const BENCHES: [Bench; 13] = [
    Bench::new("loaded-gantry", Drive::AsDescribed, X1_MM),
    Bench::new("semi-virtual-gantry", Drive::AsDescribed, X1_MM),
    Bench::new("marking-board-motors", Drive::AsDescribed, X1_MM),
    Bench::new("loaded-gantry-x4", Drive::AsDescribed, X4_MM),
    Bench::new("loaded-gantry", Drive::OnEnablePin(10_000.0), X1_MM),
    Bench::new("semi-virtual-gantry", Drive::OnEnablePin(2_500.0), X1_MM),
    Bench::new("loaded-gantry-x4", Drive::OnEnablePin(10_000.0), X4_MM),
    Bench::new("loaded-gantry", Drive::Late, X1_MM),
    Bench::new("semi-virtual-gantry", Drive::Late, X1_MM),
    Bench::new("loaded-gantry-x4", Drive::Late, X4_MM),
    Bench::new("loaded-gantry", Drive::Counted, X1_MM),
    Bench::new("semi-virtual-gantry", Drive::Counted, X1_MM),
    Bench::new("loaded-gantry-x4", Drive::Counted, X4_MM),
];

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn whole_drawings_lose_no_count_on_motors_a_quarter_off() {
    let seed = seed_of_the_day();
    if let Some(row) =
        row_of("README.md", "[whole drawings](docs/results/whole-drawings.md) on four machines")
    {
        let [rms_mm, max_mm] = X1_MM;
        assert!(row.iter().any(|cell| cell.contains(&format!("within {rms_mm}, {max_mm} mm"))), "{row:?}");
    }
    for (bench, index) in BENCHES.iter().zip(seed..) {
        // each bench with another drawing of the four, the next commit with the next one
        draws(bench, "contouring", index, 1);
        draws(bench, "cross-coupled", index.wrapping_add(2), 1);
    }
}

#[test]
#[ignore = "a minute in a release build; run by .ci/run"]
fn all_drawings_lose_no_count_on_motors_a_quarter_off() {
    for bench in sampled(&BENCHES) {
        draws(bench, "contouring", seed_of_the_day(), 4);
        draws(bench, "cross-coupled", seed_of_the_day().wrapping_add(1), 4);
    }
}

/// As many drawings as asked for on motors a quarter off, from that of the seed on: each as promised.
fn draws(bench: &Bench, controller: &str, seed: u64, number: usize) {
    let bed = bench.bed(0.25, seed);
    let first = usize::try_from(seed % 4).unwrap_or_default();
    for drawing in drawings(&bed, seed).iter().cycle().skip(first).take(number) {
        let figures = entry(controller).run(&bed, drawing, |_| ());
        let about = format!("{}, {controller}, {}, seed {seed}", bench.about(), drawing.name);
        assert_kept(&figures, bench.promised_mm, &about);
    }
}

/// Other wrong descriptions with every commit, as the property tests have other cases.
fn seed_of_the_day() -> u64 {
    std::env::var("PROPTEST_RNG_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1)
}

/// How many of many drawings lose counts on every bench, which all promise that none does, and how far they
/// go astray.
#[test]
#[ignore = "a minute a seed in a release build, by hand: PROFILE_SEEDS of them, from PROPTEST_RNG_SEED on"]
fn survey_of_lost_counts() {
    let seeds: u64 = std::env::var("PROFILE_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(10);
    for bench in BENCHES.iter().filter(|bench| is_asked_for(&bench.about())) {
        for controller in ["contouring", "cross-coupled"] {
            let (mut drawn, mut failed, mut worst) = (0, 0, Worst::default());
            for seed in (seed_of_the_day()..).take(usize::try_from(seeds).unwrap()) {
                let bed = bench.bed(0.25, seed);
                for drawing in &drawings(&bed, seed) {
                    let figures = entry(controller).run(&bed, drawing, |_| ());
                    drawn += 1;
                    worst.take(&figures);
                    if figures.lost_counts > 0 || figures.settled.is_none() || !figures.is_finished() {
                        failed += 1;
                        println!(
                            "{}, {controller}, {}, seed {seed}: {figures:?}",
                            bench.about(),
                            drawing.name
                        );
                    }
                }
            }
            println!(
                "{}, {controller}: {failed} of {drawn} lost counts; rms {:.1} um, {:.1} um at most",
                bench.about(),
                1e3 * worst.rms_mm,
                1e3 * worst.max_mm
            );
        }
    }
}

/// The worst of several seeds that nothing was tuned with.
#[derive(Default)]
struct Worst {
    rms_mm: f64,
    max_mm: f64,
    lost_counts: u32,
    settled: usize,
    time_s: f64,
    energy_j: f64,
}

impl Worst {
    fn take(&mut self, figures: &Figures) {
        self.rms_mm = self.rms_mm.max(figures.rms_mm());
        self.max_mm = self.max_mm.max(figures.max_mm);
        self.lost_counts = self.lost_counts.max(figures.lost_counts);
        self.settled += usize::from(figures.settled.is_some() && figures.is_finished());
        self.time_s = self.time_s.max(figures.time.as_secs_f64());
        self.energy_j = self.energy_j.max(figures.energy_j);
    }
}

/// How many seeds a controller is tried with: it takes its time, and what does not finish its second a
/// target.
fn seeds(name: &str, share: f64) -> usize {
    match name {
        _ if share == 0.0 => 1,
        "contouring" | "cross-coupled" if share > 0.2 => 20,
        "contouring" | "cross-coupled" => 5,
        "feed-forward" | "planned-pid" => 3,
        _ => 1,
    }
}

/// Whether a row of the table is one of those that `PROFILE_ROWS` asks for, by their beginnings with `|`
/// between them (`worn-gantry; 25 %; learning|loaded-gantry, late loop`); without it all are.
fn is_asked_for(row: &str) -> bool {
    let Ok(rows) = std::env::var("PROFILE_ROWS") else { return true };
    rows.split('|').any(|asked| row.starts_with(asked.trim()))
}

/// The tables of docs/results/whole-drawings.md.
#[test]
#[ignore = "a quarter of an hour in a release build, by hand: the tables of docs/results/whole-drawings.md, with the command that stands there"]
fn table_of_whole_drawings() {
    const FIRST_SEED: u64 = 7001;
    let ours = ["contouring", "feed-forward", "cross-coupled", "learning"];
    println!(
        "| machine | wrong by | controller | drawing | rms, um | at most, um | lost | settled | s | J |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let worn = Bench { name: "worn-gantry", drive: Drive::AsDescribed, promised_mm: None };
    for bench in BENCHES.iter().chain([&worn]) {
        let name = bench.about();
        for share in [0.0, 0.1, 0.25] {
            for entry in Entry::standard() {
                let is_ours = ours.contains(&entry.name());
                let row = format!("{name}; {:.0} %; {}", share * 100.0, entry.name());
                if share < 0.2 && !is_ours || !is_asked_for(&row) {
                    continue;
                }
                let limit =
                    Duration::from_secs(if entry.name().starts_with("p") && entry.name() != "planned-pid" {
                        1
                    } else {
                        5
                    });
                let settings = TestBedSettings { limit, ..TestBedSettings::default() };
                let seeds = seeds(entry.name(), share);
                for index in 0..4 {
                    let (mut worst, mut drawn) = (Worst::default(), String::new());
                    for seed in (FIRST_SEED..).take(seeds) {
                        let bed = bench.bed_with(share, seed, settings);
                        let drawing = &drawings(&bed, seed)[index];
                        let figures = entry.run(&bed, drawing, |_| ());
                        drawn.clone_from(&drawing.name);
                        worst.take(&figures);
                        let is_promised = matches!(bench.drive, Drive::AsDescribed)
                            || ["contouring", "cross-coupled"].contains(&entry.name());
                        if is_ours && is_promised {
                            let about = format!("{name}, {share}, {}, {drawn}, seed {seed}", entry.name());
                            assert_kept(&figures, bench.promised_mm, &about);
                        }
                    }
                    println!(
                        "| {name} | {:.0} % | {} | {drawn} | {:.2} | {:.1} | {} | {} of {seeds} | {:.1} | {:.1} |",
                        share * 100.0,
                        entry.name(),
                        worst.rms_mm * 1e3,
                        worst.max_mm * 1e3,
                        worst.lost_counts,
                        worst.settled,
                        worst.time_s,
                        worst.energy_j,
                    );
                }
            }
        }
    }
}
