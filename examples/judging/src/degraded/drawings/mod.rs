//! Drawings as people make them, other ones for each seed. Each is 1000 x 1400 px, by one or two pens of 2 to
//! 7 px.

mod cartoon;
mod circuit;
mod handwriting;
mod hatching;
mod lettering;
mod map;
mod music;
mod plan;
mod smooth;

use crate::corpus::Picture;
use crate::corpus::random::Random;
use crate::corpus::strokes::Look;

/// Size of every drawing, px: a sheet of about A4's proportions at 120 dots per inch.
pub(crate) const SIZE: (u32, u32) = (1000, 1400);

/// What is drawn at a drawing's number, in turn.
const FAMILIES: [fn(&mut Random) -> Picture; 8] = [
    plan::plan,
    circuit::circuit,
    handwriting::handwriting,
    music::music,
    cartoon::cartoon,
    map::map,
    hatching::hatching,
    lettering::lettering,
];

/// The drawing of this number for a seed. Every eighth is of the same kind; no two are alike.
#[must_use]
pub fn drawing(seed: u64, number: u32) -> Picture {
    let mut random = Random::new(mixed(seed, u64::from(number)));
    let mut families = FAMILIES.iter().cycle().skip(usize::try_from(number % 8).unwrap_or(0));
    families.next().map_or_else(|| sheet("empty", 3.0), |draw| draw(&mut random))
}

/// A seed of several: neighbouring ones lead to streams that have nothing in common.
pub(crate) fn mixed(seed: u64, other: u64) -> u64 {
    Random::new(seed).bits()
        ^ Random::new(other.wrapping_mul(0x9E37_79B9).wrapping_add(17)).bits().rotate_left(23)
}

fn sheet(name: &'static str, pen_px: f64) -> Picture {
    Picture::new(name, SIZE, Look::Smooth, pen_px)
}

/// A word for a drawing. (The stencil has no J, Q and W.)
fn word(random: &mut Random) -> &'static str {
    const WORDS: [&str; 24] = [
        "HALL", "KITCHEN", "BATH", "STAIR", "OFFICE", "STORE", "GARAGE", "LAKE", "HILL", "MILL", "STONE",
        "BRIDGE", "CHAPEL", "PUMP", "VALVE", "FRAME", "PLOTTER", "DRAFT", "SECTION", "PART 7", "SHEET 2",
        "NORTH", "MOTOR", "PAPER",
    ];
    random.pick(&WORDS).copied().unwrap_or("PART")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::Truth;

    #[test]
    fn every_drawing_lies_on_its_sheet_and_has_something_to_find() {
        for seed in [1, 2, 77] {
            for number in 0..8 {
                let picture = drawing(seed, number);
                let name = format!("{} of seed {seed}", picture.name);
                assert!((picture.width, picture.height) == SIZE && picture.strokes.len() >= 12, "{name}");
                for stroke in &picture.strokes {
                    assert!(
                        (2.0..=7.0).contains(&stroke.width_px),
                        "{name}: a pen of {} px",
                        stroke.width_px
                    );
                    for (x, y) in &stroke.points {
                        assert!(
                            (12.0..988.0).contains(x) && (12.0..1388.0).contains(y),
                            "{name}: ({x}, {y})"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_seed_draws_the_same_again_and_another_seed_something_else() {
        for number in [0, 7] {
            let points = |seed| Truth::of(&drawing(seed, number)).polylines;
            assert!(points(3) == points(3) && points(3) != points(4));
        }
        assert_ne!(drawing(3, 1).strokes.len(), drawing(3, 9).strokes.len());
    }
}
