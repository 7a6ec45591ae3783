//! Figures of smooth curves: faces, bodies, plants, clouds.

use super::sheet;
use super::smooth::{Blob, through};
use crate::corpus::Picture;
use crate::corpus::random::Random;
use crate::corpus::strokes::{At, arc, curve, polar};
use core::f64::consts::{FRAC_PI_2, PI, TAU};

pub(super) fn cartoon(random: &mut Random) -> Picture {
    let mut picture = sheet("cartoon", random.between(4.0, 7.0));
    let places = [(270.0, 350.0), (720.0, 330.0), (280.0, 980.0), (730.0, 990.0)];
    let start = random.below(3);
    for (number, place) in (start..).zip(places) {
        let at = (place.0 + random.between(-20.0, 20.0), place.1 + random.between(-40.0, 40.0));
        let size = random.between(0.85, 1.08);
        match number % 3 {
            0 => figure(at, size, random, &mut picture),
            1 => flower(at, size, random, &mut picture),
            _ => cat(at, size, random, &mut picture),
        }
    }
    let ground = random.between(1335.0, 1355.0);
    picture.line(&curve(0.0, 880.0, |x| (60.0 + x, ground + 14.0 * libm::sin(x / 90.0))));
    cloud((random.between(400.0, 560.0), 80.0), &mut picture);
    picture
}

fn face(at: At, radius: f64, random: &mut Random, picture: &mut Picture) {
    for side in [-1.0, 1.0] {
        let eye = (at.0 + side * 0.38 * radius, at.1 - 0.2 * radius);
        picture.circle(eye, random.between(0.13, 0.19) * radius);
        let brow = random.between(0.24, 0.32) * radius;
        picture.line(&arc(eye, brow, -FRAC_PI_2 - 0.8, -FRAC_PI_2 + 0.8));
    }
    picture.line(&through(&[
        (at.0 - 0.02 * radius, at.1 - 0.08 * radius),
        (at.0 + 0.12 * radius, at.1 + 0.2 * radius),
        (at.0 - 0.08 * radius, at.1 + 0.22 * radius),
    ]));
    picture.line(&arc((at.0, at.1 + 0.2 * radius), random.between(0.4, 0.5) * radius, 0.5, PI - 0.5));
}

fn figure(at: At, size: f64, random: &mut Random, picture: &mut Picture) {
    let radius = 92.0 * size;
    let head = (at.0, at.1 - 120.0 * size);
    let skull = Blob::new(head, (radius, 1.1 * radius), 0.08, random);
    picture.line(&skull.outline(1.0));
    face(head, radius, random, picture);
    for lock in 0..5 {
        let root = skull.at(1.0, -FRAC_PI_2 + 0.28 * (f64::from(lock) - 2.0));
        let tip =
            polar(root, 40.0 * size, -FRAC_PI_2 + 0.3 * (f64::from(lock) - 2.0) + random.between(-0.2, 0.2));
        picture.line(&through(&[root, (root.0 + 6.0, f64::midpoint(root.1, tip.1)), tip]));
    }
    let neck = skull.at(1.0, FRAC_PI_2);
    let body = Blob::new((at.0, neck.1 + 118.0 * size), (88.0 * size, 116.0 * size), 0.12, random);
    picture.line(&body.outline(1.0));
    for side in [-1.0, 1.0] {
        let shoulder = body.at(1.0, if side > 0.0 { -0.7 } else { PI + 0.7 });
        let hand = (at.0 + side * 175.0 * size, shoulder.1 + random.between(-60.0, 90.0) * size);
        let elbow = (f64::midpoint(shoulder.0, hand.0), f64::midpoint(shoulder.1, hand.1) + 26.0 * size);
        picture.line(&through(&[shoulder, elbow, hand]));
        let hip = body.at(1.0, FRAC_PI_2 - side * 0.5);
        let foot = (hip.0 + side * 26.0 * size, hip.1 + 76.0 * size);
        picture.line(&through(&[
            hip,
            (hip.0 + 4.0 * side, hip.1 + 40.0 * size),
            foot,
            (foot.0 + side * 34.0, foot.1 + 4.0),
        ]));
    }
    for button in 0..3 {
        picture.circle((at.0, neck.1 + (60.0 + 50.0 * f64::from(button)) * size), 9.0 * size);
    }
}

fn flower(at: At, size: f64, random: &mut Random, picture: &mut Picture) {
    let centre = (at.0, at.1 - 130.0 * size);
    let petals = 5 + random.below(3);
    let inner = 40.0 * size;
    picture.circle(centre, inner);
    for petal in 0..petals {
        let angle = TAU * f64::from(petal) / f64::from(petals) + 0.2;
        let half = 0.36 * TAU / f64::from(petals);
        let tip = random.between(118.0, 138.0) * size;
        picture.line(&through(&[
            polar(centre, inner, angle - half),
            polar(centre, 0.7 * tip, angle - 1.1 * half),
            polar(centre, tip, angle),
            polar(centre, 0.7 * tip, angle + 1.1 * half),
            polar(centre, inner, angle + half),
        ]));
    }
    // The stem begins below the petals.
    let foot = (at.0 + random.between(-40.0, 40.0), at.1 + 320.0 * size);
    let stem = [(at.0, centre.1 + 160.0 * size), (at.0 + 24.0, at.1 + 170.0 * size), foot];
    picture.line(&through(&stem));
    let [_, middle, _] = stem;
    for side in [-1.0, 1.0] {
        let tip = (middle.0 + side * 140.0 * size, middle.1 - 60.0 * size);
        let (above, below) = (
            (middle.0 + side * 60.0 * size, middle.1 - 76.0 * size),
            (middle.0 + side * 84.0 * size, middle.1 + 10.0 * size),
        );
        picture.line(&through(&[middle, above, tip, below, (middle.0, middle.1)]));
    }
}

fn cat(at: At, size: f64, random: &mut Random, picture: &mut Picture) {
    let radius = 96.0 * size;
    let head = (at.0, at.1 - 100.0 * size);
    let skull = Blob::new(head, (1.1 * radius, 0.95 * radius), 0.06, random);
    picture.line(&skull.outline(1.0));
    face(head, radius, random, picture);
    for side in [-1.0, 1.0] {
        let (near, far) = (-FRAC_PI_2 + side * 0.35, -FRAC_PI_2 + side * 0.95);
        let tip = polar(head, 1.55 * radius, -FRAC_PI_2 + side * 0.72);
        picture.line(&[skull.at(1.0, near), tip, skull.at(1.0, far)]);
        for hair in 0..3 {
            let y = head.1 + (26.0 + 17.0 * f64::from(hair)) * size;
            let fan = 14.0 * (f64::from(hair) - 1.0) * size;
            picture.line(&[(head.0 + side * 62.0 * size, y), (head.0 + side * 165.0 * size, y + fan)]);
        }
    }
    let body = Blob::new((at.0, at.1 + 150.0 * size), (118.0 * size, 152.0 * size), 0.1, random);
    picture.line(&body.outline(1.0));
    let root = body.at(1.0, 0.6);
    picture.line(&through(&[
        root,
        (root.0 + 70.0 * size, root.1 + 20.0 * size),
        (root.0 + 86.0 * size, root.1 - 80.0 * size),
        (root.0 + 50.0 * size, root.1 - 140.0 * size),
        (root.0 + 70.0 * size, root.1 - 178.0 * size),
    ]));
    for stripe in 0..4 {
        let y = at.1 + (90.0 + 38.0 * f64::from(stripe)) * size;
        let wide = random.between(30.0, 52.0) * size;
        picture.line(&curve(-wide, wide, |x| (at.0 + x, y + x * x / (2.4 * wide))));
    }
}

fn cloud((x, y): At, picture: &mut Picture) {
    // Bulges that meet in points.
    let mut points = vec![(x - 110.0, y + 40.0)];
    for (centre, radius) in [(-80.0, 34.0), (-14.0, 40.0), (58.0, 36.0)] {
        points.extend(arc((x + centre, y + 20.0), radius, PI + 0.3, TAU - 0.3));
    }
    points.push((x + 106.0, y + 40.0));
    points.push((x - 110.0, y + 40.0));
    picture.line(&points);
}
