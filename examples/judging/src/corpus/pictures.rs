//! The pictures, by what they try.

use super::strokes::{At, BLACK, Look, Picture, arc, curve, polar, turned};
use super::{marks, technical};
use core::f64::consts::{PI, TAU};

const RED: [u8; 3] = [204, 26, 26];
const BLUE: [u8; 3] = [26, 64, 204];

/// All of them.
#[must_use]
pub fn all() -> Vec<Picture> {
    vec![
        rectangle(),
        flag(),
        technical::drawing("techdraw_w3", 5.0, 2.5),
        technical::drawing("techdraw_w1", 1.0, 1.0),
        circles(),
        spiral(),
        grid("grid_w3", 0.0),
        grid("grid_rot_w3", 0.05),
        junctions(),
        acute(),
        handwriting(),
        grey(),
        scan(),
        colours(),
        marks::small(),
        marks::needles(),
    ]
}

fn rectangle() -> Picture {
    let mut picture = Picture::new("rect_1px", (400, 300), Look::Ink, 1.0);
    picture.rectangle((30.0, 20.0), (370.0, 280.0));
    picture.rectangle((90.0, 70.0), (310.0, 230.0));
    picture
}

/// Crescent and star in a frame, by the proportions of the Turkish flag law (no. 2893 of 1983), G = 600 px.
fn flag() -> Picture {
    const G: f64 = 600.0;
    let mut picture = Picture::new("flag_1px", (1000, 700), Look::Ink, 1.0);
    picture.rectangle((50.0, 50.0), (50.0 + 1.5 * G, 50.0 + G));

    let (outer, outer_radius) = ((50.0 + G / 2.0, 50.0 + G / 2.0), G / 4.0);
    let (inner, inner_radius) = ((outer.0 + G / 16.0, outer.1), G / 5.0);
    // The horns: where the circles cross, d apart.
    let d = inner.0 - outer.0;
    let x = (d * d + outer_radius * outer_radius - inner_radius * inner_radius) / (2.0 * d);
    let y = libm::sqrt(outer_radius * outer_radius - x * x);
    let (horn, horn_inside) = (libm::atan2(y, x), libm::atan2(y, x - d));
    let mut crescent = arc(outer, outer_radius, horn, TAU - horn);
    crescent.pop();
    crescent.extend(arc(inner, inner_radius, TAU - horn_inside, horn_inside));
    if let Some(first) = crescent.first().copied() {
        crescent.pop();
        crescent.push(first);
    }
    picture.line(&crescent);

    let radius = G / 8.0;
    let star = (inner.0 - inner_radius + G / 3.0 + radius, outer.1);
    let small = radius * libm::cos(TAU / 5.0) / libm::cos(TAU / 10.0);
    let corner =
        |k: u32| polar(star, if k.is_multiple_of(2) { radius } else { small }, PI + f64::from(k) * PI / 5.0);
    let mut outline: Vec<At> = (0..10).map(corner).collect();
    outline.push(corner(0));
    picture.line(&outline);
    picture
}

fn circles() -> Picture {
    let mut picture = Picture::new("circles_w3", (500, 500), Look::Ink, 3.0);
    for radius in [8.3, 20.0, 60.4, 120.0, 200.7] {
        picture.circle((250.3, 249.6), radius);
    }
    picture
}

fn spiral() -> Picture {
    let mut picture = Picture::new("spiral_w3", (500, 500), Look::Ink, 3.0);
    // 22 px from turn to turn.
    picture.line(&curve(TAU * 0.4, TAU * 10.4, |angle| polar((249.4, 250.8), 22.0 * angle / TAU, angle)));
    picture
}

fn grid(name: &'static str, angle_rad: f64) -> Picture {
    let mut picture = Picture::new(name, (600, 600), Look::Ink, 3.0);
    let centre = if angle_rad == 0.0 { (300.0, 300.0) } else { (299.7, 300.2) };
    for line in -6..=6 {
        let at = 42.0 * f64::from(line);
        for ends in [[(-252.0, at), (252.0, at)], [(at, -252.0), (at, 252.0)]] {
            picture.line(&ends.map(|end| turned(end, angle_rad, centre)));
        }
    }
    picture
}

fn junctions() -> Picture {
    let mut picture = Picture::new("junctions_w5", (900, 600), Look::Ink, 5.0);
    let at = |column: u32, row: u32| (115.0 + 222.0 * f64::from(column), 103.0 + 195.0 * f64::from(row));
    for (column, angles) in (0_u32..).zip([[0.0, 90.0], [45.0, 135.0], [20.0, 100.0], [10.0, 55.0]]) {
        for angle in angles {
            picture.through(at(column, 0), 85.0, angle);
        }
    }
    picture.through(at(0, 1), 85.0, 0.0);
    picture.rays(at(0, 1), 85.0, &[90.0]);
    picture.through(at(1, 1), 85.0, 30.0);
    picture.rays(at(1, 1), 85.0, &[120.0]);
    picture.rays(at(2, 1), 85.0, &[90.0, 210.0, 330.0]);
    picture.rays(at(3, 1), 85.0, &[75.0, 105.0, 270.0]);
    picture.through(at(0, 2), 85.0, 0.0);
    picture.rays(at(0, 2), 85.0, &[60.0]);
    picture.rays(at(1, 2), 85.0, &[0.0, 72.0, 144.0, 216.0, 288.0]);
    picture.rays(at(2, 2), 85.0, &[0.0, 60.0, 120.0, 180.0, 240.0, 300.0]);
    picture.rays(at(3, 2), 80.0, &[9.0, 100.0, 189.0, 280.0]);
    picture
}

/// Lines that cross at 10 to 30 degrees: over a long way there is only one broad stripe of ink.
fn acute() -> Picture {
    let mut picture = Picture::new("acute_w7", (1000, 520), Look::Ink, 7.0);
    let crossings = [
        (10.0, 0.0),
        (10.0, 37.0),
        (15.0, 90.0),
        (15.0, 22.0),
        (20.0, 45.0),
        (20.0, 8.0),
        (25.0, 63.0),
        (30.0, 120.0),
    ];
    for (place, (between, direction)) in (0_u32..).zip(crossings) {
        let centre = (126.3 + 249.0 * f64::from(place % 4), 130.6 + 259.0 * f64::from(place / 4));
        picture.through(centre, 108.0, direction - between / 2.0);
        picture.through(centre, 108.0, direction + between / 2.0);
    }
    picture
}

/// Rows of loops, as one writes them to loosen the hand.
fn handwriting() -> Picture {
    let mut picture = Picture::new("handwriting_w4", (1000, 500), Look::Ink, 4.0);
    // A row leans by a third; `size` tells how high each loop is.
    let row = |picture: &mut Picture, line: f64, loops: f64, pitch: f64, size: &dyn Fn(f64) -> f64| {
        picture.line(&curve(0.0, TAU * loops, |angle| {
            let height = size(angle / TAU);
            let up = height * (1.0 - libm::cos(angle)) / 2.0;
            let across = pitch * angle / TAU - 0.42 * height * libm::sin(angle);
            (62.0 + across + up / 3.0, line - up)
        }));
    };
    row(&mut picture, 112.0, 13.0, 64.0, &|turn| 62.0 + 14.0 * libm::cos(PI * turn));
    row(&mut picture, 262.0, 12.0, 70.0, &|turn| 64.0 + 16.0 * libm::sin(2.1 * turn) + 6.0 * libm::cos(turn));
    row(&mut picture, 372.0, 6.0, 74.0, &|turn| -66.0 - 10.0 * libm::sin(1.7 * turn));
    // An eight on its side, and a knot.
    picture.line(&curve(-0.4, TAU - 0.8, |angle| {
        (620.0 + 74.0 * libm::sin(angle), 400.0 - 46.0 * libm::sin(2.0 * angle))
    }));
    picture.line(&curve(0.3, 2.0 * TAU - 0.2, |angle| {
        polar((830.0, 398.0), 46.0 + 24.0 * libm::cos(1.5 * angle), angle)
    }));
    for (from, to) in [((500.0, 32.0), (566.0, 26.0)), ((735.0, 234.0), (838.0, 216.0))] {
        picture.line(&[from, to]);
    }
    picture
}

/// Grey edges as a scanner sees them: the place of a line is known better than to a pixel.
fn grey() -> Picture {
    let mut picture = Picture::new("grey_aa", (800, 600), Look::Smooth, 2.5);
    for (place, degrees) in (0_u32..).zip([0.0, 3.0, 11.3, 26.6, 40.0, 45.0, 63.0, 78.0, 90.0]) {
        picture.rays((40.37, 40.62 + 14.0 * f64::from(place)), 330.0 - 12.0 * f64::from(place), &[degrees]);
    }
    for (centre, radius) in
        [((560.4, 130.7), 96.3), ((560.4, 130.7), 41.8), ((700.25, 128.5), 12.4), ((700.25, 128.5), 4.6)]
    {
        picture.circle(centre, radius);
    }
    picture.line(&curve(0.0, 700.0, |x| (50.3 + x, 470.2 + 58.0 * libm::sin(x * TAU / 233.0))));
    for (corners, centre, radius) in
        [(3, (440.6, 330.3), 70.0), (5, (600.2, 320.9), 62.0), (7, (730.8, 300.1), 48.0)]
    {
        let corner = |k: u32| polar(centre, radius, 0.31 + f64::from(k) * TAU / f64::from(corners));
        let mut outline: Vec<At> = (0..corners).map(corner).collect();
        outline.push(corner(0));
        picture.line(&outline);
    }
    picture.line(&[(60.2, 570.7), (742.9, 548.4)]);
    picture
}

fn scan() -> Picture {
    let mut picture = Picture::new("noisy_scan", (900, 700), Look::Scan, 3.0);
    let corner = |x: f64, y: f64| turned((x, y), 0.035, (88.4, 62.3));
    picture.line(&[
        corner(0.0, 0.0),
        corner(470.0, 0.0),
        corner(470.0, 320.0),
        corner(0.0, 320.0),
        corner(0.0, 0.0),
    ]);
    picture.line(&[corner(-14.0, 158.0), corner(484.0, 162.0)]);
    picture.line(&[corner(40.0, 30.0), corner(432.0, 296.0)]);
    picture.circle(corner(235.0, 160.0), 104.6);
    // A closed curve with three lobes, and a wave through it.
    let mut lobes =
        curve(0.0, TAU, |angle| polar((730.4, 240.8), 104.0 + 30.0 * libm::sin(3.0 * angle), angle));
    if let Some(first) = lobes.first().copied() {
        lobes.pop();
        lobes.push(first);
    }
    picture.line(&lobes);
    picture.line(&curve(0.0, 420.0, |y| (726.0 + 70.0 * libm::cos(y / 62.0), 46.0 + y)));
    picture
        .line(&curve(0.0, 760.0, |x| (52.0 + x, 560.0 - 74.0 * libm::sin(x / 61.0) * libm::exp(-x / 900.0))));
    picture.text((540.0, 642.0), 30.0, -0.05, "2893 R7.5");
    picture
}

fn colours() -> Picture {
    let mut picture = Picture::new("two_colour", (800, 600), Look::Smooth, 3.0);
    picture.ink(BLACK).rectangle((50.0, 50.0), (750.0, 550.0));
    picture.ink(BLUE).circle((310.4, 310.2), 150.3);
    for line in 0..6 {
        let left = 90.0 + 22.0 * f64::from(line);
        picture.line(&[(left, 92.0), (left + 104.0, 236.0)]);
    }
    picture.ink(RED).circle((480.7, 309.5), 150.3);
    picture.line(&curve(0.0, 660.0, |x| (70.0 + x, 310.0 - 182.0 * libm::cos((x - 130.0) * TAU / 410.0))));
    picture.ink(BLACK).text((520.0, 72.0), 34.0, 0.0, "PEN 47");
    picture.ink(BLUE).text((632.0, 494.0), 36.0, 0.0, "B2");
    picture.ink(RED).line(&[(92.0, 520.0), (520.0, 470.0)]);
    picture
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::junctions;

    #[test]
    fn every_picture_has_strokes_inside_its_sheet() {
        for picture in all() {
            assert!(!picture.strokes.is_empty());
            for (x, y) in picture.strokes.iter().flat_map(|stroke| &stroke.points) {
                let inside = (4.0..f64::from(picture.width) - 4.0).contains(x)
                    && (4.0..f64::from(picture.height) - 4.0).contains(y);
                assert!(inside, "{}: ({x}, {y}) lies outside", picture.name);
            }
        }
    }

    #[test]
    fn a_grid_of_thirteen_lines_each_way_has_its_crossings() {
        // 4 corners are none, 4 x 11 have three arms, 11 x 11 have four.
        for picture in [grid("grid", 0.0), grid("grid_rot", 0.05)] {
            let found = junctions::of(&picture.strokes);
            let with = |arms: u32| found.iter().filter(|(_, _, number)| *number == arms).count();
            assert_eq!((with(3), with(4), found.len()), (44, 121, 165));
        }
    }

    #[test]
    fn the_flag_and_the_circles_have_no_junctions() {
        for picture in [flag(), circles(), spiral(), rectangle()] {
            assert!(junctions::of(&picture.strokes).is_empty(), "{}", picture.name);
        }
    }

    #[test]
    fn crossings_at_small_angles_are_eight() {
        assert_eq!(junctions::of(&acute().strokes).len(), 8);
    }
}
