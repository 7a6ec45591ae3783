//! Ways in which a telephone sees a drawing.

use super::kind::Strength;
use super::parameters as p;
use super::plane::Plane;
use super::sheet::Sheet;
use super::texture::{grain, step, streaks};
use crate::corpus::random::Random;
use crate::corpus::strokes::turned;
use core::f64::consts::TAU;
use plotter_vector::{PxPoint, picture::Homography};

/// Paper under a lamp and the pen on it, levels in red, green and blue.
const PAPER: [f64; 3] = [238.0, 232.0, 220.0];
const INK: [f64; 3] = [40.0, 42.0, 52.0];
/// A camera's noise resembles over this, sd, px: it is smoothed before it is saved.
const NOISE_SIZE_PX: f64 = 0.6;
/// From one line of a squared sheet to the next and their width, px: 5 mm and 0.25 mm at 200 dots per inch.
const SQUARE_PX: f64 = 39.4;
const RULE_PX: f64 = 2.0;

/// Least table beside a sheet, as a share of the sheet's width.
const EDGE: f64 = 0.015;

/// Light from one side, less towards the corners as through a lens: from 1 down to `least`.
pub(crate) fn light((width, height): (usize, usize), least: f64, random: &mut Random) -> Plane {
    let angle = random.between(0.0, TAU);
    let (sin, cos) = libm::sincos(angle);
    let (half_x, half_y) = (width as f64 / 2.0, height as f64 / 2.0);
    let vignette = random.between(0.15, 0.35);
    let bend = random.between(0.6, 1.6);
    let light = Plane::from_fn(width, height, |x, y| {
        let (x, y) = (x / half_x - 1.0, y / half_y - 1.0);
        let side = f64::midpoint(1.0, (x * cos + y * sin) / (libm::fabs(cos) + libm::fabs(sin)));
        (1.0 - vignette) * (1.0 - libm::pow(side.clamp(0.0, 1.0), bend))
            + vignette * (1.0 - (x * x + y * y) / 2.0)
    });
    let (low, high) = light
        .values
        .iter()
        .fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(*value), high.max(*value)));
    light.map(|value| least + (1.0 - least) * (value - low) / (high - low).max(f64::MIN_POSITIVE))
}

fn paper_and_ink(cover: &Plane, random: &mut Random) -> Sheet {
    let paper = grain(cover.width, cover.height, 1.5, random).map(|value| 1.5 * value);
    Sheet::inked(PAPER, INK, cover).plus(&paper)
}

/// In shade.
pub(crate) fn photo(cover: &Plane, strength: Strength, random: &mut Random) -> Sheet {
    let light = light((cover.width, cover.height), p::PHOTO_LEAST.at(strength), random);
    paper_and_ink(cover, random).lit(&light).blurred(p::PHOTO_BLUR.at(strength)).noisy(
        p::PHOTO_NOISE.at(strength),
        NOISE_SIZE_PX,
        random,
    )
}

/// Windows or lamps that are mirrored: soft patches of light over paper and ink alike.
pub(crate) fn reflections(cover: &Plane, strength: Strength, random: &mut Random) -> Sheet {
    let (width, height) = (cover.width, cover.height);
    let shade = light((width, height), p::GLARE_LEAST.at(strength), random);
    let mut glare = Plane::even(width, height, 0.0);
    let mut patch = 0.0;
    while patch < p::GLARE_COUNT.at(strength) {
        let at = (random.between(0.15, 0.85) * width as f64, random.between(0.12, 0.88) * height as f64);
        let half = (random.between(0.07, 0.16) * width as f64, random.between(0.06, 0.14) * width as f64);
        let (angle, soft) = (random.between(0.0, TAU), random.between(20.0, 60.0));
        let square = random.chance(0.5);
        let level = p::GLARE_LEVEL.at(strength) * random.between(0.85, 1.1);
        let one = Plane::from_fn(width, height, |x, y| {
            let (x, y) = turned((x - at.0, y - at.1), angle, (0.0, 0.0));
            // By the distance from the edge, px: a window, or a lamp.
            let rim = |inside: f64| step(-soft, soft, inside);
            level
                * if square {
                    rim(half.0 - libm::fabs(x)) * rim(half.1 - libm::fabs(y))
                } else {
                    rim((1.0 - libm::hypot(x / half.0, y / half.1)) * half.0.min(half.1))
                }
        });
        glare = glare.with(&one, f64::max);
        patch += 1.0;
    }
    // Paper that is not dazzled lies in the middle of the range, as an exposure by the patches makes it.
    paper_and_ink(cover, random).lit(&shade.map(|light| 0.62 * light)).plus(&glare).blurred(0.8).noisy(
        3.5,
        NOISE_SIZE_PX,
        random,
    )
}

/// How much of each pixel the lines of a squared paper cover.
pub(crate) fn rules((width, height): (usize, usize), random: &mut Random) -> Plane {
    let angle = random.between(-0.012, 0.012);
    let start = (random.between(0.0, SQUARE_PX), random.between(0.0, SQUARE_PX));
    let rule = |place: f64| {
        let away = libm::fabs(place - SQUARE_PX * libm::round(place / SQUARE_PX));
        (RULE_PX / 2.0 + 0.5 - away).clamp(0.0, 1.0)
    };
    Plane::from_fn(width, height, |x, y| {
        let (x, y) = turned((x, y), angle, start);
        rule(x).max(rule(y))
    })
}

/// On squared paper.
pub(crate) fn squared(cover: &Plane, strength: Strength, random: &mut Random) -> Sheet {
    let (width, height) = (cover.width, cover.height);
    let ruling = rules((width, height), random);
    let contrast = p::SQUARED_LEVEL.at(strength);
    // Pale blue: red goes most.
    let [red, green, blue] = PAPER;
    let ruled =
        Sheet::inked(PAPER, [red - 1.15 * contrast, green - 0.95 * contrast, blue - 0.7 * contrast], &ruling);
    let ink = Sheet::inked(INK, INK, cover);
    let mut inks = ink.channels.iter();
    let drawn = Sheet {
        channels: ruled.channels.each_ref().map(|paper| {
            let ink = inks.next().map_or(0.0, Plane::mean);
            paper.with(cover, |paper, share| paper + (ink - paper) * share)
        }),
    };
    let light = light((width, height), p::SQUARED_LEAST.at(strength), random);
    drawn.lit(&light).blurred(0.7).noisy(4.0, NOISE_SIZE_PX, random)
}

/// A sheet on a table from askew, with where it lies: the picture's places from the drawing's.
pub(crate) fn perspective(
    cover: &Plane,
    strength: Strength,
    random: &mut Random,
) -> Option<(Sheet, Plane, Homography)> {
    let (wide, high) = (cover.width as f64, cover.height as f64);
    let margin = 0.1 * wide;
    let tilt = p::TABLE_TILT.at(strength) * wide;
    let turn = random.between(-0.05, 0.05);
    // Each corner is moved, one more than the others; the far side is shorter.
    let far = random.between(0.6, 1.0) * tilt;
    let mut corner = |x: f64, y: f64, inwards: f64| {
        let slip = (random.between(-0.4, 0.4) * tilt, random.between(-0.4, 0.4) * tilt);
        let (cx, cy) = turned((x + inwards - wide / 2.0, y - high / 2.0), turn, (wide / 2.0, high / 2.0));
        // All of the sheet is in the picture.
        let inside = |at: f64, size: f64| at.clamp(EDGE * wide, size + 2.0 * margin - EDGE * wide);
        (inside(cx + margin + slip.0, wide), inside(cy + margin + slip.1, high))
    };
    let corners = [
        corner(0.0, 0.0, far),
        corner(wide, 0.0, -far),
        corner(wide, high, 0.3 * far),
        corner(0.0, high, -0.3 * far),
    ];
    let corners = corners.map(|(x, y)| PxPoint::new(x, y));
    let there = Homography::of_quadrilateral((wide, high), corners)?;
    let back = there.inverse()?;
    let (width, height) = (wider(cover.width), cover.height + wider(cover.width) - cover.width);
    let on_sheet = |x: f64, y: f64| {
        let on = back.apply(PxPoint::new(x, y))?;
        ((0.0..wide).contains(&on.x) && (0.0..high).contains(&on.y)).then_some((on.x, on.y))
    };
    // Four rays a pixel, so that edges are as smooth as through a lens: how many meet the sheet, how many its
    // ink.
    let rays = [-0.25, 0.25].map(|down| [-0.25, 0.25].map(|across| (across, down)));
    let mut ink = Plane::even(width, height, 0.0);
    let mut inks = ink.values.iter_mut();
    let sheet = Plane::from_fn(width, height, |x, y| {
        let mut met = 0.0;
        let mut covered = 0.0;
        for (across, down) in rays.as_flattened() {
            // The drawing's pixel centres are at whole numbers; so are the picture's.
            if let Some((x, y)) = on_sheet(x + across, y + down) {
                met += 0.25;
                covered += 0.25 * cover.at(x, y);
            }
        }
        if let Some(ink) = inks.next() {
            *ink = covered;
        }
        met
    });
    let table = wood((width, height), p::TABLE_LEVEL.at(strength), random);
    // A sheet throws a narrow shadow beside it.
    let shadow = sheet.blurred(9.0).map(|share| 1.0 - 0.35 * share);
    let paper = Sheet::inked(PAPER, INK, &ink);
    let mut papers = paper.channels.iter();
    let both = Sheet {
        channels: table.lit(&shadow).channels.map(|under| match papers.next() {
            Some(paper) => Plane {
                values: under
                    .values
                    .iter()
                    .zip(&paper.values)
                    .zip(&sheet.values)
                    .map(|((under, over), share)| under + (over - under) * share)
                    .collect(),
                ..*paper
            },
            None => under,
        }),
    };
    let light = light((width, height), p::TABLE_LEAST.at(strength), random);
    Some((both.lit(&light).blurred(0.7).noisy(3.5, NOISE_SIZE_PX, random), ink, there))
}

/// A fifth more, for the table about the sheet.
fn wider(size: usize) -> usize {
    size + size / 5
}

/// Boards with a grain of fibres along them, and joints.
fn wood((width, height): (usize, usize), level: f64, random: &mut Random) -> Sheet {
    let fibres = streaks((width, height), (90.0, 1.6), random);
    let rings = streaks((width, height), (200.0, 14.0), random);
    let board = random.between(170.0, 230.0);
    let start = random.between(0.0, board);
    let tone = Plane::from_fn(width, height, |_, y| {
        let place = (y + start) / board;
        let away = libm::fabs(place - libm::round(place)) * board;
        if away < 1.5 { -0.4 } else { 0.06 * libm::sin(7.0 * libm::floor(place)) }
    });
    let grain =
        fibres.with(&rings, |fibre, ring| 0.045 * fibre + 0.07 * ring).with(&tone, |one, other| one + other);
    Sheet {
        channels: [1.2 * level, 0.97 * level, 0.7 * level]
            .map(|value| grain.map(|grain| value * (1.0 + grain).max(0.1))),
    }
}
