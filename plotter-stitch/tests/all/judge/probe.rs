//! The two strokes of the probe for folds, with other pens on other papers.

use super::ink::{Spot, Trace};
use super::{Chance, FLASH_S, SWAY_S, TACT_S};
use plotter_stitch::{
    FindLine, FoldProbe, Optics, Sighting,
    fold::Seen,
    sense::{BothEdges, Tact},
};

/// Speed of the scans, mm/s, and how far they reach to both sides, mm: those of the procedure.
const SPEED_MM_S: f64 = 15.0;
const REACH_MM: f64 = 3.0;

/// Pens and papers from which each probe draws its own.
#[derive(Clone, Copy, Debug)]
pub struct Stationery {
    /// Width of the line, mm.
    pub line_mm: [f64; 2],
    /// Standard deviation of either edge, mm.
    pub texture_mm: [f64; 2],
    /// Standard deviation of where the pen comes back to, mm.
    pub back_mm: [f64; 2],
    /// Share of scans with a grain of dust.
    pub dust: f64,
}

/// What the scans over a line saw.
pub type Scans = Vec<Option<Seen>>;

/// The scans over one stroke and over both, the second one so far beside the first.
pub fn probe(stationery: &Stationery, apart_mm: f64, seed: u64) -> (Scans, Scans) {
    let mut chance = Chance::new(seed);
    let mut of = |[least, most]: [f64; 2]| least + (most - least) * chance.unit();
    let (line_mm, texture_mm, back_mm) =
        (of(stationery.line_mm), of(stationery.texture_mm), of(stationery.back_mm));
    let second_mm = apart_mm + back_mm * chance.normal();
    let pairs = (0..FoldProbe::SCANS).map(|_| {
        let mut edges = |at_mm: f64| {
            [at_mm - 0.5 * line_mm, at_mm + 0.5 * line_mm].map(|edge| edge + texture_mm * chance.normal())
        };
        let (first, second) = (edges(0.0), edges(second_mm));
        let (mut once, mut twice) = (Trace::default(), Trace::default());
        once.line(first, 0.0);
        // Ink on ink is no darker.
        if first[0].max(second[0]) < first[1].min(second[1]) {
            twice.line([first[0].min(second[0]), first[1].max(second[1])], 0.0);
        } else {
            twice.line(first, 0.0);
            twice.line(second, 0.0);
        }
        if chance.unit() < stationery.dust {
            let at_mm = REACH_MM * (2.0 * chance.unit() - 1.0);
            let (size_mm, beside_mm) = (0.15 + 0.5 * chance.unit(), 0.15 * (2.0 * chance.unit() - 1.0));
            once.grain(at_mm, size_mm, beside_mm);
            twice.grain(at_mm, size_mm, beside_mm);
        }
        (scan(&once, &mut chance), scan(&twice, &mut chance))
    });
    pairs.unzip()
}

fn scan(trace: &Trace, chance: &mut Chance) -> Option<Seen> {
    const SERVO_MM: f64 = 0.01;
    let spot = Spot::default();
    let mut finder = BothEdges::new(&Optics::default(), SPEED_MM_S);
    let mut seen: Option<Seen> = None;
    let mut see = |sighting: Option<Sighting>| {
        if let Some(Sighting { at_mm, span_mm, .. }) = sighting {
            let all = seen.unwrap_or(Seen { from_mm: f64::INFINITY, to_mm: f64::NEG_INFINITY });
            seen = Some(Seen {
                from_mm: all.from_mm.min(at_mm - 0.5 * span_mm),
                to_mm: all.to_mm.max(at_mm + 0.5 * span_mm),
            });
        }
    };
    let (mut position_mm, mut sway_mm) = (-REACH_MM - SPEED_MM_S * TACT_S * chance.unit(), 0.0);
    let kept = (-TACT_S / SWAY_S).exp();
    while position_mm < REACH_MM {
        sway_mm = kept * sway_mm + (1.0 - kept * kept).sqrt() * SERVO_MM * chance.normal();
        let sees = |flash_s: f64| u8::from(spot.sees(trace, position_mm + sway_mm + SPEED_MM_S * flash_s));
        let hits = FLASH_S.map(sees);
        see(finder.push(Tact { position_mm, hits: hits[0] + hits[1], covered: None }).unwrap());
        position_mm += SPEED_MM_S * TACT_S;
    }
    see(finder.finish());
    seen
}
