//! The flag, by the proportions of the Turkish flag law (no. 2893 of 1983) and its regulation.
//!
//! With G the width (at the hoist): length 3/2 G; centre of the outer circle of the crescent G/2 from the
//! hoist's seam, its diameter G/2; centre of the inner circle G/16 further to the fly, its diameter 2/5 G;
//! the star's circle begins G/3 from the inner circle's edge, its diameter G/4, and one point of the star
//! looks to the hoist; white hem at the hoist G/30.

use crate::canvas::{At, circle, line, lines, paper};
use image::GrayImage;

/// Width of the flag, px.
const G: f64 = 640.0;
/// Paper round the flag, px.
const MARGIN: f64 = 16.0;
const HEM: f64 = G / 30.0;

/// Cosine and sine of 36 and 72 degrees, from the golden section.
const COS_36: f64 = 0.809_016_994_374_947_5;
const SIN_36: f64 = 0.587_785_252_292_473_1;
const COS_72: f64 = 0.309_016_994_374_947_45;
const SIN_72: f64 = 0.951_056_516_295_153_5;

pub(crate) fn draw() -> GrayImage {
    // 3/2 · 640 + 640/30 + twice the margin, and one pixel for the last line.
    let mut sheet = paper(1014, 673);
    let (top, bottom) = (MARGIN, MARGIN + G);
    let (left, seam) = (MARGIN, MARGIN + HEM);
    let right = seam + 1.5 * G;
    lines(&mut sheet, &[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)]);
    line(&mut sheet, (seam, top), (seam, bottom));

    let axis = f64::midpoint(top, bottom);
    let (outer, outer_radius) = ((seam + G / 2.0, axis), G / 4.0);
    let (inner, inner_radius) = ((outer.0 + G / 16.0, axis), G / 5.0);
    let apart = |a: At, (x, y): At| libm::sqrt((a.0 - x) * (a.0 - x) + (a.1 - y) * (a.1 - y));
    // The horns: where the circles cross, d apart, the outer one reaches (d² + R² - r²) / 2d from its centre.
    let d = inner.0 - outer.0;
    let horns = outer.0 + (d * d + outer_radius * outer_radius - inner_radius * inner_radius) / (2.0 * d);
    circle(&mut sheet, outer, outer_radius, |x, _| x <= horns);
    circle(&mut sheet, inner, inner_radius, |x, y| x <= horns && apart(outer, (x, y)) < outer_radius - 0.5);

    let radius = G / 8.0;
    let star = (inner.0 - inner_radius + G / 3.0 + radius, axis);
    let point = |cos: f64, sin: f64| (star.0 + radius * cos, star.1 + radius * sin);
    let points = [
        point(-1.0, 0.0),
        point(-COS_72, SIN_72),
        point(COS_36, SIN_36),
        point(COS_36, -SIN_36),
        point(-COS_72, -SIN_72),
    ];
    // The outline: the inner corners lie on a circle smaller by cos 72 / cos 36.
    let small = radius * COS_72 / COS_36;
    let corner = |cos: f64, sin: f64| (star.0 + small * cos, star.1 + small * sin);
    let corners = [
        corner(-COS_36, SIN_36),
        corner(COS_72, SIN_72),
        corner(1.0, 0.0),
        corner(COS_72, -SIN_72),
        corner(-COS_36, -SIN_36),
    ];
    let mut outline: Vec<At> =
        points.iter().zip(&corners).flat_map(|(point, corner)| [*point, *corner]).collect();
    outline.push(points[0]);
    lines(&mut sheet, &outline);
    sheet
}
