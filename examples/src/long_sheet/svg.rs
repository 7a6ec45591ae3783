//! [`long_sheet_svg`]: the joints of a sheet, magnified, and what is left at each of them.

use crate::long_sheet::run::HALF_VIEW_MM;
use crate::long_sheet::{FrameFigures, JointFigures};
use crate::shared::escaped;
use plotter_motion::Point;
use std::fmt::Write as _;

/// Width of the picture, px.
const WIDTH_PX: f64 = 1_200.0;
/// Joints that are shown.
const MOST_VIEWS: usize = 6;
/// Side of a view, px, and from one to the next.
const VIEW_PX: f64 = 180.0;
const VIEW_STEP_PX: f64 = (WIDTH_PX - 2.0 * LEFT_PX - VIEW_PX) / 5.0;
/// Margin at both sides, px.
const LEFT_PX: f64 = 50.0;
/// Width of the pen's line, mm.
const PEN_MM: f64 = 0.5;
/// Accuracy that is asked for, and half of the pen's line: what joints are to be better than, mm.
const ASKED_MM: [(f64, &str); 2] = [(0.05, "asked: 0.05 mm"), (0.25, "half of the pen's line")];
/// Height of a chart, px.
const CHART_PX: f64 = 200.0;

/// A picture of a sheet: joints, discrepancies, drift.
#[must_use]
pub fn long_sheet_svg(title: &str, joints: &[JointFigures], frames: &FrameFigures) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH_PX}\" height=\"860\" viewBox=\"0 0 {WIDTH_PX} 860\" \
         font-family=\"sans-serif\" font-size=\"13\" fill=\"#333\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"{LEFT_PX}\" y=\"34\" font-size=\"20\">{}</text>\n\
         <text x=\"{LEFT_PX}\" y=\"58\">{} lines and arcs in {} frames, {:.1} s of motion. Blue: drawn with the frame before the \
         joint. Red: with the frame after it. Each view is {} mm wide.</text>\n",
        escaped(title),
        frames.segments,
        joints.len() + 1,
        frames.motion_s,
        2.0 * HALF_VIEW_MM,
    );
    for (column, joint) in chosen(joints).into_iter().enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "six at the most")]
        let left = LEFT_PX + VIEW_STEP_PX * column as f64;
        view(&mut svg, joint, left, 76.0);
    }
    let worst: Vec<f64> = joints.iter().map(|joint| joint.worst_mm).collect();
    let caption = "greatest distance between the two ends of a line at each joint, mm";
    chart(&mut svg, 330.0, caption, &worst, joints, &ASKED_MM);
    let drift: Vec<f64> = joints.iter().map(|joint| joint.report.drift.lateral_mm).collect();
    chart(&mut svg, 600.0, "drift of each frame across the sheet, mm", &drift, joints, &[]);
    svg.push_str("</svg>\n");
    svg
}

/// The joints that are shown: the worst one, and others evenly spread.
fn chosen(joints: &[JointFigures]) -> Vec<&JointFigures> {
    let shown: Vec<&JointFigures> = joints.iter().filter(|joint| joint.view.is_some()).collect();
    if shown.len() <= MOST_VIEWS {
        return shown;
    }
    let worst = shown.iter().copied().max_by(|a, b| a.worst_mm.total_cmp(&b.worst_mm));
    let frame_of = |joint: &JointFigures| joint.report.frame;
    let mut chosen: Vec<&JointFigures> = (0..MOST_VIEWS)
        .filter_map(|number| shown.get(number * (shown.len() - 1) / (MOST_VIEWS - 1)).copied())
        .collect();
    if let Some(worst) = worst.filter(|worst| chosen.iter().all(|other| frame_of(other) != frame_of(worst))) {
        // In the place of the one that is nearest to it.
        if let Some(nearest) = chosen.iter_mut().min_by_key(|other| frame_of(other).abs_diff(frame_of(worst)))
        {
            *nearest = worst;
        }
    }
    chosen
}

fn view(svg: &mut String, joint: &JointFigures, left: f64, top: f64) {
    let Some((place, [before, after])) = &joint.view else { return };
    let scale = VIEW_PX / (2.0 * HALF_VIEW_MM);
    let number = joint.report.frame;
    let _ = writeln!(
        svg,
        "<svg x=\"{left}\" y=\"{top}\" width=\"{VIEW_PX}\" height=\"{VIEW_PX}\" viewBox=\"0 0 {VIEW_PX} {VIEW_PX}\">\n\
         <rect width=\"{VIEW_PX}\" height=\"{VIEW_PX}\" fill=\"#f6f6f4\"/>",
    );
    for (lines, colour) in [(before, "#1565c0"), (after, "#c62828")] {
        let _ = writeln!(
            svg,
            "<g stroke=\"{colour}\" opacity=\"0.6\" stroke-width=\"{:.2}\" fill=\"none\" stroke-linecap=\"round\" \
             stroke-linejoin=\"round\">",
            PEN_MM * scale
        );
        for line in lines {
            polyline(svg, line, *place, scale);
        }
        svg.push_str("</g>\n");
    }
    let _ = writeln!(
        svg,
        "</svg>\n<rect x=\"{left}\" y=\"{top}\" width=\"{VIEW_PX}\" height=\"{VIEW_PX}\" fill=\"none\" \
         stroke=\"#bbb\"/>\n<text x=\"{left}\" y=\"{}\">joint {number}: {:.3} mm</text>",
        top + VIEW_PX + 18.0,
        joint.worst_mm
    );
}

/// A line, as far as the view can show it.
fn polyline(svg: &mut String, line: &[Point], place: Point, scale: f64) {
    /// Beyond the view, so that cut ends are not seen, mm.
    const REACH_MM: f64 = 2.0 * HALF_VIEW_MM;
    for pair in line.windows(2) {
        let segment = plotter_motion::Segment::new(pair[0], pair[1]);
        let near = segment.nearest(place);
        if near.distance(place) > REACH_MM {
            continue;
        }
        svg.push_str("<path d=\"");
        for (command, end) in [('M', segment.from), ('L', segment.to)] {
            let off = end - near;
            // Far ends are drawn in to what is shown.
            let end = if off.length() > REACH_MM { near + off * (REACH_MM / off.length()) } else { end };
            let by = (end - place) * scale;
            let _ = write!(svg, "{command}{:.2} {:.2}", VIEW_PX / 2.0 + by.x, VIEW_PX / 2.0 - by.y);
        }
        svg.push_str("\"/>\n");
    }
}

fn chart(
    svg: &mut String,
    top: f64,
    caption: &str,
    values: &[f64],
    joints: &[JointFigures],
    limits: &[(f64, &str)],
) {
    let greatest = values.iter().copied().fold(0.0_f64, f64::max);
    let least = values.iter().copied().fold(0.0_f64, f64::min);
    // The first limit is always shown, the others where something comes near them.
    let shown: Vec<_> = limits
        .iter()
        .enumerate()
        .filter(|(n, (at, _))| *n == 0 || greatest > 0.3 * at)
        .map(|(_, l)| *l)
        .collect();
    let high = shown.iter().map(|(at, _)| *at).fold(greatest, f64::max).max(1e-3) * 1.08;
    let low = least * 1.08;
    let step = tick((high - low) / 5.0);
    let (left, right, bottom) = (LEFT_PX + 20.0, WIDTH_PX - LEFT_PX, top + CHART_PX);
    #[expect(clippy::cast_precision_loss, reason = "frames are counted in 32 bits")]
    let x = |index: usize| left + (right - left) * (index as f64 + 0.5) / values.len().max(1) as f64;
    let y = |value: f64| bottom - CHART_PX * (value - low) / (high - low);
    let _ = writeln!(svg, "<text x=\"{LEFT_PX}\" y=\"{}\" font-size=\"15\">{caption}</text>", top - 12.0);
    let mut at = (low / step).ceil() * step;
    while at <= high {
        let decimals = usize::from(step < 1.0) + usize::from(step < 0.1) + usize::from(step < 0.01);
        let zero = if at.abs() < 1e-9 { 0.0 } else { at };
        let _ = writeln!(
            svg,
            "<line x1=\"{left}\" x2=\"{right}\" y1=\"{0:.1}\" y2=\"{0:.1}\" stroke=\"#e2e2e2\"/><text x=\"{1}\" y=\"{2:.1}\" \
             text-anchor=\"end\">{zero:.decimals$}</text>",
            y(at),
            left - 6.0,
            y(at) + 4.0
        );
        at += step;
    }
    for (limit, name) in shown {
        let _ = writeln!(
            svg,
            "<line x1=\"{left}\" x2=\"{right}\" y1=\"{0:.1}\" y2=\"{0:.1}\" stroke=\"#c62828\" stroke-dasharray=\"6 4\"/>\
             <text x=\"{right}\" y=\"{1:.1}\" text-anchor=\"end\" fill=\"#c62828\">{name}</text>",
            y(limit),
            y(limit) - 5.0
        );
    }
    let mut points = String::new();
    for (index, value) in values.iter().enumerate() {
        let _ = write!(points, "{:.1},{:.1} ", x(index), y(*value));
    }
    let _ = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#1565c0\" stroke-width=\"1.5\"/>",
        points.trim_end()
    );
    for (index, (value, joint)) in values.iter().zip(joints).enumerate() {
        let has_folded = joint.fits > 0;
        if values.len() <= 60 || has_folded {
            let (radius, colour) = if has_folded { (5.0, "#c62828") } else { (3.0, "#1565c0") };
            let _ = writeln!(
                svg,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius}\" fill=\"{colour}\"/>",
                x(index),
                y(*value)
            );
        }
    }
    let every = joints.len().div_ceil(12).max(1);
    for (index, joint) in joints.iter().enumerate().step_by(every) {
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            x(index),
            bottom + 18.0,
            joint.report.frame
        );
    }
}

/// The round number next above.
fn tick(size: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(size)));
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|n| n * power).find(|step| *step >= size).unwrap_or(size)
}
