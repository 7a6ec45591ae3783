//! [`PenSheet`]: strokes of several pens, of which every one is known.

use crate::corpus::random::Random;
use crate::corpus::strokes::{At, Look, Picture, Stroke, arc, curve, polar};
use core::f64::consts::TAU;

/// The pens that a sheet takes some of: neighbours in hue, pale ones, and a pencil beside black.
const INKS: [(&str, [u8; 3]); 12] = [
    ("black", [26, 26, 26]),
    ("pencil", [160, 160, 160]),
    ("red", [208, 24, 24]),
    ("orange", [232, 128, 32]),
    ("brown", [122, 68, 32]),
    ("blue", [24, 64, 200]),
    ("violet", [120, 40, 168]),
    ("green", [20, 130, 50]),
    ("pale green", [150, 204, 120]),
    ("yellow", [245, 225, 80]),
    ("pink", [235, 120, 160]),
    ("cyan", [20, 160, 180]),
];

/// Pens on the sheets of a seed, in turn.
const PENS: [usize; 5] = [8, 3, 8, 5, 8];

/// Strokes of each pen, and how often a place is looked for before a stroke is given up.
const STROKES: u32 = 3;
const TRIES: u32 = 40;

/// Width of the pens, px.
const WIDTH_PX: core::ops::Range<f64> = 3.0..4.6;

/// Free margin of the sheet, px.
const MARGIN_PX: f64 = 14.0;

/// Strokes nearer than this to each other cross by at least this angle, so that people see two of them, px
/// and degrees.
const NEAR_PX: f64 = 12.0;
const LEAST_ANGLE: f64 = 25.0;

/// Distance between the places of a stroke that are compared, px.
const STEP_PX: f64 = 4.0;

/// A sheet with strokes of several pens.
#[derive(Debug)]
pub struct PenSheet {
    pub(super) picture: Picture,
    pub(super) pens: Vec<[u8; 3]>,
}

impl PenSheet {
    /// The sheet of this seed and number.
    #[must_use]
    pub fn new(seed: u64, number: u32) -> Self {
        let random = &mut Random::new(seed.wrapping_mul(1000).wrapping_add(u64::from(number)));
        let mut inks = INKS.map(|(_, colour)| colour).to_vec();
        let turn = usize::try_from(number).unwrap_or(0) % PENS.len();
        let of_turn = PENS.get(turn).copied().unwrap_or(1);
        // Every fifth sheet is for the pencil beside black.
        let first = if of_turn == 3 { 2 } else { 0 };
        for place in first..of_turn {
            let rest = u32::try_from(inks.len() - place).unwrap_or(1);
            let other = place + usize::try_from(random.below(rest)).unwrap_or(0);
            inks.swap(place, other);
        }
        inks.truncate(of_turn);
        let mut picture = Picture::new("pens", (800, 600), Look::Smooth, 3.0);
        let mut order: Vec<[u8; 3]> = (0..STROKES).flat_map(|_| inks.iter().copied()).collect();
        let widths: Vec<f64> = inks.iter().map(|_| random.between(WIDTH_PX.start, WIDTH_PX.end)).collect();
        for place in (1..order.len()).rev() {
            let other = random.below(u32::try_from(place + 1).unwrap_or(1));
            order.swap(place, usize::try_from(other).unwrap_or(0));
        }
        for ink in order {
            let width =
                inks.iter().zip(&widths).find(|(one, _)| **one == ink).map_or(3.0, |(_, width)| *width);
            for _ in 0..TRIES {
                let points = shape(random, (f64::from(picture.width), f64::from(picture.height)));
                if fits(&points, &picture) {
                    picture.pen(width).ink(ink).line(&points);
                    break;
                }
            }
        }
        inks.retain(|ink| picture.strokes.iter().any(|stroke| stroke.colour == *ink));
        Self { picture, pens: inks }
    }

    /// How many pens drew it.
    #[must_use]
    pub fn pens(&self) -> usize {
        self.pens.len()
    }

    pub(super) fn strokes(&self) -> &[Stroke] {
        &self.picture.strokes
    }
}

/// A stroke as people draw them: straight, bent, waving, with corners or round.
fn shape(random: &mut Random, (width, height): At) -> Vec<At> {
    let (x, y) = (random.between(0.1, 0.9) * width, random.between(0.1, 0.9) * height);
    let angle = random.between(0.0, TAU);
    let length = random.between(150.0, 520.0);
    match random.below(5) {
        0 => vec![(x, y), polar((x, y), length, angle)],
        1 => arc((x, y), length / 3.0, angle, angle + random.between(1.5, 4.5)),
        2 => {
            let (height, waves) = (random.between(10.0, 35.0), random.between(1.0, 3.0));
            curve(0.0, 1.0, |share| {
                let along = polar((x, y), share * length, angle);
                polar(along, height * libm::sin(share * waves * TAU), angle + TAU / 4.0)
            })
        }
        3 => {
            let middle = polar((x, y), length / 2.0, angle);
            vec![(x, y), middle, polar(middle, length / 2.0, angle + random.between(0.8, 2.0))]
        }
        _ => {
            let mut round = arc((x, y), length / 6.0, 0.0, TAU);
            round.pop();
            round.extend(round.first().copied());
            round
        }
    }
}

/// Whether a stroke lies on the sheet, ends apart from the others, and crosses them clearly.
fn fits(points: &[At], picture: &Picture) -> bool {
    let places = along(points);
    let inside = |at: &At| {
        (MARGIN_PX..f64::from(picture.width) - MARGIN_PX).contains(&at.0)
            && (MARGIN_PX..f64::from(picture.height) - MARGIN_PX).contains(&at.1)
    };
    let closed = points.first() == points.last();
    let apart = |one: At, other: At| libm::hypot(one.0 - other.0, one.1 - other.1);
    let ends = |places: &[(At, f64)]| -> Vec<At> {
        places.first().into_iter().chain(places.last()).map(|(at, _)| *at).collect()
    };
    places.iter().all(|(at, _)| inside(at))
        && picture.strokes.iter().all(|stroke| {
            let others = along(&stroke.points);
            let is_end = |at: At, of: &[(At, f64)], closed: bool| {
                !closed && ends(of).iter().any(|end| apart(*end, at) < 0.5)
            };
            places.iter().all(|(at, way)| {
                others.iter().all(|(other, other_way)| {
                    let turn = libm::fabs(libm::remainder(way - other_way, TAU / 2.0)).to_degrees();
                    apart(*at, *other) > NEAR_PX
                        || (turn >= LEAST_ANGLE
                            && !is_end(*at, &places, closed)
                            && !is_end(*other, &others, stroke.closed()))
                })
            })
        })
}

/// Places along a stroke, and its direction there.
fn along(points: &[At]) -> Vec<(At, f64)> {
    let mut places = Vec::new();
    let mut rest = 0.0;
    for pair in points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let way = libm::atan2(to.1 - from.1, to.0 - from.0);
        let length = libm::hypot(to.0 - from.0, to.1 - from.1);
        let mut at = rest;
        while at < length {
            places.push((polar(from, at, way), way));
            at += STEP_PX;
        }
        rest = at - length;
    }
    if let [.., from, to] = points {
        places.push((*to, libm::atan2(to.1 - from.1, to.0 - from.0)));
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_has_sheets_of_up_to_eight_pens_that_cross() {
        let sheets: Vec<PenSheet> = (0..5).map(|number| PenSheet::new(1, number)).collect();
        let pens: Vec<usize> = sheets.iter().map(PenSheet::pens).collect();
        assert_eq!(pens, PENS);
        for sheet in &sheets {
            let crossings = crate::corpus::junctions_of(sheet.strokes()).len();
            assert!(crossings >= 4, "{crossings} crossings of {} strokes", sheet.strokes().len());
        }
        assert_eq!(format!("{:?}", PenSheet::new(1, 3)), format!("{:?}", sheets[3]));
    }
}
