//! A map: contours, roads, a river, houses and names.

use super::smooth::{Blob, through};
use super::{sheet, word};
use crate::corpus::Picture;
use crate::corpus::random::Random;
use crate::corpus::strokes::{At, turned};

pub(super) fn map(random: &mut Random) -> Picture {
    let (thin, broad) = (random.between(2.0, 3.0), random.between(4.5, 6.5));
    let mut picture = sheet("map", thin);
    picture.rectangle((40.0, 40.0), (960.0, 1360.0));
    for centre in [(270.0, 330.0), (735.0, 700.0), (280.0, 1060.0)] {
        let at = (centre.0 + random.between(-20.0, 20.0), centre.1 + random.between(-30.0, 30.0));
        let peak = Blob::new(at, (random.between(150.0, 180.0), random.between(170.0, 215.0)), 0.3, random);
        let rings = 3 + random.below(3);
        for ring in 0..=rings {
            picture.line(&peak.outline(0.3 + 0.7 * f64::from(ring) / f64::from(rings)));
        }
        picture.text((at.0 - 27.0, at.1 - 10.0), 20.0, 0.0, &format!("{}", 300 + random.below(600)));
    }
    roads(broad, random, &mut picture);
    picture.pen(thin);
    // A river that keeps to the right, then between the hills.
    let bend = |x: f64, y: f64, random: &mut Random| (x + random.between(-22.0, 22.0), y);
    let river = [
        (random.between(500.0, 560.0), 40.0),
        bend(560.0, 180.0, random),
        bend(520.0, 330.0, random),
        bend(510.0, 500.0, random),
        bend(500.0, 700.0, random),
        bend(515.0, 900.0, random),
        bend(560.0, 1100.0, random),
        (random.between(480.0, 620.0), 1360.0),
    ];
    picture.line(&through(&river));
    for place in 0..9 {
        let (column, row) = (f64::from(place % 3), f64::from(place / 3));
        if random.chance(0.7) {
            let at = (690.0 + 90.0 * column, 1100.0 + 90.0 * row);
            house((at.0 + random.between(-9.0, 9.0), at.1 + random.between(-9.0, 9.0)), random, &mut picture);
        }
    }
    let (left, right) = (random.between(640.0, 680.0), random.between(640.0, 700.0));
    picture.text((left, 110.0), random.between(34.0, 42.0), 0.0, word(random));
    picture.text((right, 250.0), random.between(26.0, 32.0), random.between(-0.2, 0.2), word(random));
    picture
}

/// A main road, a side road that leaves it, a path of dashes.
fn roads(broad: f64, random: &mut Random, picture: &mut Picture) {
    picture.pen(broad);
    let fork = (random.between(590.0, 640.0), random.between(395.0, 440.0));
    picture.line(&through(&[
        (40.0, random.between(590.0, 640.0)),
        (250.0, random.between(640.0, 690.0)),
        (430.0, random.between(560.0, 610.0)),
        fork,
        (800.0, random.between(330.0, 380.0)),
        (960.0, random.between(350.0, 420.0)),
    ]));
    picture.line(&through(&[
        fork,
        (fork.0 + 10.0, fork.1 - 120.0),
        (600.0, 200.0),
        (random.between(600.0, 640.0), 40.0),
    ]));
    let low = random.between(960.0, 1010.0);
    let dashes = [random.between(22.0, 30.0)];
    picture.dashed((620.0, low), (950.0, low - 60.0), &dashes, 18.0);
}

fn house(at: At, random: &mut Random, picture: &mut Picture) {
    let angle = random.between(-0.5, 0.5);
    let (wide, high) = (random.between(18.0, 30.0), random.between(14.0, 22.0));
    let corner = |x: f64, y: f64| turned((x, y), angle, at);
    picture.line(&[
        corner(-wide, -high),
        corner(wide, -high),
        corner(wide, high),
        corner(-wide, high),
        corner(-wide, -high),
    ]);
}
