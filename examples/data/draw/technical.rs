//! A bearing bracket in two views, with dimensions, centre lines, frame and title block.

use crate::canvas::{At, circle, line, lines, paper, thick};
use image::GrayImage;

pub(crate) fn draw() -> GrayImage {
    let mut sheet = paper(1040, 720);
    frame(&mut sheet);
    front_view(&mut sheet);
    side_view(&mut sheet);
    title_block(&mut sheet);
    sheet
}

fn rectangle(sheet: &mut GrayImage, (left, top): At, (right, bottom): At) {
    lines(sheet, &[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)]);
}

fn frame(sheet: &mut GrayImage) {
    rectangle(sheet, (12.0, 12.0), (1027.0, 707.0));
    // The inner frame is the thick one.
    thick(sheet, (30.0, 30.0), (1009.0, 30.0), 3);
    thick(sheet, (30.0, 687.0), (1009.0, 687.0), 3);
    thick(sheet, (30.0, 33.0), (30.0, 686.0), 3);
    thick(sheet, (1007.0, 33.0), (1007.0, 686.0), 3);
}

/// Base with two bolt holes, and on it the web with slanted sides, chamfers and the bore.
fn front_view(sheet: &mut GrayImage) {
    let outline = [
        (120.0, 470.0),
        (120.0, 420.0),
        (130.0, 420.0),
        (230.0, 270.0),
        (230.0, 180.0),
        (260.0, 150.0),
        (500.0, 150.0),
        (530.0, 180.0),
        (530.0, 270.0),
        (630.0, 420.0),
        (640.0, 420.0),
        (640.0, 470.0),
        (120.0, 470.0),
    ];
    lines(sheet, &outline);
    circle(sheet, (380.0, 260.0), 18.0, |_, _| true);
    // Hidden edges of the bolt holes, and centre lines.
    for x in [150.0, 170.0, 590.0, 610.0] {
        dashed(sheet, (x, 421.0), (x, 469.0), &[8.0], 4.0);
    }
    for x in [160.0, 600.0] {
        dashed(sheet, (x, 404.0), (x, 486.0), &[22.0, 4.0], 4.0);
    }
    dashed(sheet, (380.0, 128.0), (380.0, 494.0), &[26.0, 4.0], 5.0);
    dashed(sheet, (346.0, 260.0), (414.0, 260.0), &[26.0, 4.0], 5.0);
    across(sheet, (120.0, 640.0), 560.0, 474.0, "520");
    across(sheet, (160.0, 600.0), 525.0, 490.0, "440");
    upright(sheet, 92.0, (150.0, 470.0), 254.0, "320");
    // Leader of the bore at 45 degrees.
    lines(sheet, &[(393.0, 247.0), (544.0, 96.0), (600.0, 96.0)]);
    text(sheet, (548.0, 78.0), "R18");
}

/// The same part from the right: web, base, hidden bore.
fn side_view(sheet: &mut GrayImage) {
    let outline = [
        (760.0, 470.0),
        (760.0, 420.0),
        (800.0, 420.0),
        (800.0, 150.0),
        (860.0, 150.0),
        (860.0, 360.0),
        (920.0, 420.0),
        (960.0, 420.0),
        (960.0, 470.0),
        (760.0, 470.0),
    ];
    lines(sheet, &outline);
    for y in [242.0, 278.0] {
        dashed(sheet, (801.0, y), (859.0, y), &[8.0], 4.0);
    }
    dashed(sheet, (784.0, 260.0), (876.0, 260.0), &[26.0, 4.0], 5.0);
    // Section hatching at 45 degrees.
    let mut x = 768.0;
    while x <= 912.0 {
        line(sheet, (x, 466.0), (x + 38.0, 428.0));
        x += 16.0;
    }
    across(sheet, (760.0, 960.0), 560.0, 474.0, "200");
    across(sheet, (800.0, 860.0), 104.0, 146.0, "60");
    upright(sheet, 996.0, (420.0, 470.0), 964.0, "50");
}

fn title_block(sheet: &mut GrayImage) {
    rectangle(sheet, (620.0, 590.0), (1000.0, 680.0));
    line(sheet, (621.0, 620.0), (999.0, 620.0));
    line(sheet, (621.0, 650.0), (999.0, 650.0));
    line(sheet, (860.0, 621.0), (860.0, 679.0));
    text(sheet, (632.0, 599.0), "BEARING BRACKET");
    text(sheet, (632.0, 629.0), "SCALE 1:2");
    text(sheet, (632.0, 659.0), "UNIT MM");
    text(sheet, (872.0, 629.0), "SHEET 1");
    text(sheet, (872.0, 659.0), "A3");
    text(sheet, (60.0, 655.0), "ALL EDGES 1X45");
    thick(sheet, (60.0, 676.0), (228.0, 676.0), 2);
}

/// Dashes of the given lengths in turn with gaps between; level or upright.
fn dashed(sheet: &mut GrayImage, from: At, to: At, dashes: &[f64], gap: f64) {
    let length = (to.0 - from.0) + (to.1 - from.1);
    let unit = ((to.0 - from.0) / length, (to.1 - from.1) / length);
    let at = |s: f64| (from.0 + unit.0 * s, from.1 + unit.1 * s);
    let mut start = 0.0;
    for dash in dashes.iter().cycle() {
        if start >= length {
            break;
        }
        line(sheet, at(start), at((start + dash - 1.0).min(length)));
        start += dash + gap;
    }
}

/// A level dimension line at `y` between two edges, whose extension lines begin at `from_y`.
fn across(sheet: &mut GrayImage, (left, right): (f64, f64), y: f64, from_y: f64, label: &str) {
    let beyond = if from_y < y { 8.0 } else { -8.0 };
    for x in [left, right] {
        line(sheet, (x, from_y), (x, y + beyond));
    }
    line(sheet, (left, y), (right, y));
    arrow(sheet, (left, y), (1.0, 0.0));
    arrow(sheet, (right, y), (-1.0, 0.0));
    let width = 12.0 * f64::from(u32::try_from(label.len()).unwrap_or(0));
    text(sheet, (libm::floor(f64::midpoint(left, right) - width / 2.0), y - 19.0), label);
}

/// An upright dimension line at `x` between two edges, whose extension lines end at `to_x`.
fn upright(sheet: &mut GrayImage, x: f64, (top, bottom): (f64, f64), to_x: f64, label: &str) {
    let beyond = if to_x > x { -8.0 } else { 8.0 };
    line(sheet, (x + beyond, top), (to_x, top));
    line(sheet, (x + beyond, bottom), (if to_x > x { 116.0 } else { to_x }, bottom));
    line(sheet, (x, top), (x, bottom));
    arrow(sheet, (x, top), (0.0, 1.0));
    arrow(sheet, (x, bottom), (0.0, -1.0));
    let to_left = 12.0 * f64::from(u32::try_from(label.len()).unwrap_or(0)) + 6.0;
    text(sheet, (x - to_left, f64::midpoint(top, bottom) - 6.0), label);
}

/// An open arrow head of 45 degrees that looks against `direction`.
fn arrow(sheet: &mut GrayImage, tip: At, direction: At) {
    let side = (-direction.1, direction.0);
    for s in [1.0, -1.0] {
        let end = (tip.0 + 7.0 * (direction.0 + s * side.0), tip.1 + 7.0 * (direction.1 + s * side.1));
        line(sheet, tip, end);
    }
}

/// Lettering of straight strokes, 8 px wide and 12 px high, as drawn with a stencil.
fn text(sheet: &mut GrayImage, at: At, letters: &str) {
    for (place, letter) in (0_u32..).zip(letters.chars()) {
        let left = at.0 + 12.0 * f64::from(place);
        for stroke in strokes(letter) {
            let points: Vec<At> = stroke.iter().map(|(x, y)| (left + x, at.1 + y)).collect();
            lines(sheet, &points);
        }
    }
}

fn strokes(letter: char) -> &'static [&'static [At]] {
    match letter {
        '0' | 'O' => &[&[
            (2.0, 0.0),
            (6.0, 0.0),
            (8.0, 2.0),
            (8.0, 10.0),
            (6.0, 12.0),
            (2.0, 12.0),
            (0.0, 10.0),
            (0.0, 2.0),
            (2.0, 0.0),
        ]],
        '1' => &[&[(2.0, 2.0), (4.0, 0.0), (4.0, 12.0)]],
        '2' => &[&[(0.0, 2.0), (2.0, 0.0), (6.0, 0.0), (8.0, 2.0), (8.0, 4.0), (0.0, 12.0), (8.0, 12.0)]],
        '3' => &[&[
            (0.0, 0.0),
            (8.0, 0.0),
            (4.0, 4.0),
            (6.0, 4.0),
            (8.0, 6.0),
            (8.0, 10.0),
            (6.0, 12.0),
            (0.0, 12.0),
        ]],
        '4' => &[&[(6.0, 12.0), (6.0, 0.0), (0.0, 6.0), (0.0, 8.0), (8.0, 8.0)]],
        '5' => &[&[
            (8.0, 0.0),
            (0.0, 0.0),
            (0.0, 5.0),
            (6.0, 5.0),
            (8.0, 7.0),
            (8.0, 10.0),
            (6.0, 12.0),
            (0.0, 12.0),
        ]],
        '6' => &[&[
            (6.0, 0.0),
            (0.0, 6.0),
            (0.0, 10.0),
            (2.0, 12.0),
            (6.0, 12.0),
            (8.0, 10.0),
            (8.0, 8.0),
            (6.0, 6.0),
            (0.0, 6.0),
        ]],
        '8' => &[
            &[
                (2.0, 0.0),
                (6.0, 0.0),
                (8.0, 2.0),
                (8.0, 4.0),
                (6.0, 6.0),
                (8.0, 8.0),
                (8.0, 10.0),
                (6.0, 12.0),
                (2.0, 12.0),
                (0.0, 10.0),
                (0.0, 8.0),
                (2.0, 6.0),
                (0.0, 4.0),
                (0.0, 2.0),
                (2.0, 0.0),
            ],
            &[(2.0, 6.0), (6.0, 6.0)],
        ],
        'A' => &[&[(0.0, 12.0), (0.0, 4.0), (4.0, 0.0), (8.0, 4.0), (8.0, 12.0)], &[(0.0, 7.0), (8.0, 7.0)]],
        'B' => &[
            &[
                (0.0, 0.0),
                (6.0, 0.0),
                (8.0, 2.0),
                (8.0, 4.0),
                (6.0, 6.0),
                (8.0, 8.0),
                (8.0, 10.0),
                (6.0, 12.0),
                (0.0, 12.0),
                (0.0, 0.0),
            ],
            &[(0.0, 6.0), (6.0, 6.0)],
        ],
        'C' => &[&[
            (8.0, 2.0),
            (6.0, 0.0),
            (2.0, 0.0),
            (0.0, 2.0),
            (0.0, 10.0),
            (2.0, 12.0),
            (6.0, 12.0),
            (8.0, 10.0),
        ]],
        'D' => &[&[(0.0, 0.0), (5.0, 0.0), (8.0, 3.0), (8.0, 9.0), (5.0, 12.0), (0.0, 12.0), (0.0, 0.0)]],
        'E' => &[&[(8.0, 0.0), (0.0, 0.0), (0.0, 12.0), (8.0, 12.0)], &[(0.0, 6.0), (6.0, 6.0)]],
        'G' => &[&[
            (8.0, 2.0),
            (6.0, 0.0),
            (2.0, 0.0),
            (0.0, 2.0),
            (0.0, 10.0),
            (2.0, 12.0),
            (6.0, 12.0),
            (8.0, 10.0),
            (8.0, 7.0),
            (5.0, 7.0),
        ]],
        'H' => &[&[(0.0, 0.0), (0.0, 12.0)], &[(8.0, 0.0), (8.0, 12.0)], &[(0.0, 6.0), (8.0, 6.0)]],
        'I' => &[&[(4.0, 0.0), (4.0, 12.0)]],
        'K' => {
            &[&[(0.0, 0.0), (0.0, 12.0)], &[(8.0, 0.0), (2.0, 6.0), (8.0, 12.0)], &[(0.0, 6.0), (2.0, 6.0)]]
        }
        'L' => &[&[(0.0, 0.0), (0.0, 12.0), (8.0, 12.0)]],
        'M' => &[&[(0.0, 12.0), (0.0, 0.0), (4.0, 4.0), (8.0, 0.0), (8.0, 12.0)]],
        'N' => &[&[(0.0, 12.0), (0.0, 0.0), (8.0, 8.0), (8.0, 12.0)], &[(8.0, 0.0), (8.0, 8.0)]],
        'R' => &[
            &[(0.0, 12.0), (0.0, 0.0), (6.0, 0.0), (8.0, 2.0), (8.0, 4.0), (6.0, 6.0), (0.0, 6.0)],
            &[(2.0, 6.0), (8.0, 12.0)],
        ],
        'S' => &[&[
            (8.0, 2.0),
            (6.0, 0.0),
            (2.0, 0.0),
            (0.0, 2.0),
            (0.0, 4.0),
            (2.0, 6.0),
            (6.0, 6.0),
            (8.0, 8.0),
            (8.0, 10.0),
            (6.0, 12.0),
            (2.0, 12.0),
            (0.0, 10.0),
        ]],
        'T' => &[&[(0.0, 0.0), (8.0, 0.0)], &[(4.0, 0.0), (4.0, 12.0)]],
        'U' => &[&[(0.0, 0.0), (0.0, 10.0), (2.0, 12.0), (6.0, 12.0), (8.0, 10.0), (8.0, 0.0)]],
        'X' => &[&[(0.0, 2.0), (8.0, 10.0)], &[(8.0, 2.0), (0.0, 10.0)]],
        ':' => &[&[(4.0, 3.0), (4.0, 4.0)], &[(4.0, 8.0), (4.0, 9.0)]],
        _ => &[],
    }
}
