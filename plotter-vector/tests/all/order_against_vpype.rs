//! Travel with the pen up beside vpype (A. Beyeler; `PyPI`), on the drawings of the examples, where it is
//! installed.
//!
//! Both get the same strokes, as they are found; the way between what each of the two makes of them is
//! measured here.

use plotter_vector::{Drawing, Order, Ours, PxPoint, Vectorizer, decode, order::OrderEffort};
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

type Stroke = Vec<[f64; 2]>;

fn strokes_of(drawing: &Drawing) -> Vec<Stroke> {
    drawing.strokes().map(|stroke| stroke.iter().map(|PxPoint { x, y }| [*x, *y]).collect()).collect()
}

/// From the end of each stroke to the beginning of the next, px.
fn pen_up_px(strokes: &[Stroke]) -> f64 {
    let way = |pair: &[Stroke]| {
        let (from, to) = (pair[0][pair[0].len() - 1], pair[1][0]);
        ((from[0] - to[0]).powi(2) + (from[1] - to[1]).powi(2)).sqrt()
    };
    strokes.windows(2).map(way).sum()
}

fn pen_down_px(strokes: &[Stroke]) -> f64 {
    let length = |stroke: &Stroke| {
        stroke.windows(2).map(|of| (of[0][0] - of[1][0]).hypot(of[0][1] - of[1][1])).sum::<f64>()
    };
    strokes.iter().map(length).sum()
}

fn svg(strokes: &[Stroke], [width, height]: [u32; 2]) -> String {
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}px\" height=\"{height}px\" viewBox=\"0 0 {width} {height}\" \
         fill=\"none\" stroke=\"black\">\n"
    );
    for stroke in strokes {
        let places: Vec<String> = stroke.iter().map(|[x, y]| format!("{x},{y}")).collect();
        writeln!(text, "<polyline points=\"{}\"/>", places.join(" ")).unwrap();
    }
    text + "</svg>\n"
}

/// What vpype writes: lines, polylines and polygons, in their order.
fn read(svg: &str) -> Vec<Stroke> {
    let number = |text: &str| text.parse::<f64>().unwrap_or_else(|_| panic!("no number: {text}"));
    let elements = svg.split('<').filter_map(|element| element.split_once(' '));
    elements
        .filter_map(|(name, attributes)| {
            let value = |key: &str| {
                let (_, rest) = attributes.split_once(&format!("{key}=\""))?;
                rest.split('"').next()
            };
            match name {
                "line" => {
                    let of = |key| number(value(key).unwrap());
                    Some(vec![[of("x1"), of("y1")], [of("x2"), of("y2")]])
                }
                "polyline" | "polygon" => {
                    let places = value("points")?.split_whitespace();
                    let place =
                        |text: &str| text.split_once(',').map(|(x, y)| [number(x), number(y)]).unwrap();
                    let mut stroke: Stroke = places.map(place).collect();
                    if name == "polygon" {
                        stroke.extend(stroke.first().copied());
                    }
                    Some(stroke)
                }
                "path" => panic!("vpype wrote a path: {attributes}"),
                _ => None,
            }
        })
        .collect()
}

#[test]
fn the_pen_travels_no_farther_than_by_vpypes_two_commands() {
    /// vpype writes places to a hundredth of a pixel or better.
    const LENGTH_SHARE: f64 = 1e-3;
    if Command::new("vpype").arg("--version").output().is_err() {
        println!("skipped: vpype is not here, with which the way of the pen is compared");
        return;
    }
    for name in ["flag.png", "technical.png"] {
        let Ok(picture) = std::fs::read(format!("{}/../examples/data/{name}", env!("CARGO_MANIFEST_DIR")))
        else {
            println!("skipped: the drawing {name} of the examples is not here");
            return;
        };
        let gray = decode(&picture).unwrap();
        let by = |effort| {
            let order = Order::default().with_effort(effort);
            strokes_of(&Vectorizer::from(Ours::default().with_order(order)).vectorize(&gray).unwrap().drawing)
        };
        let (as_found, ours) = (by(OrderEffort::None), by(OrderEffort::Best));
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let [given, sorted] = ["given", "sorted"].map(|what| folder.join(format!("vpype-{name}-{what}.svg")));
        std::fs::write(&given, svg(&as_found, [gray.width(), gray.height()])).unwrap();
        let mut vpype = Command::new("vpype");
        vpype.args(["read", "--no-crop"]).arg(&given).args(["linemerge", "-t", "0.5px", "linesort", "write"]);
        let said = vpype.arg(&sorted).output().unwrap();
        assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
        let theirs = read(&std::fs::read_to_string(&sorted).unwrap());
        let drawn = [&as_found, &ours, &theirs].map(|strokes| pen_down_px(strokes));
        println!(
            "{name}: pen up {:.0} px as found, {:.0} ours, {:.0} vpype's; {}, {}, {} strokes",
            pen_up_px(&as_found),
            pen_up_px(&ours),
            pen_up_px(&theirs),
            as_found.len(),
            ours.len(),
            theirs.len()
        );
        // All three draw the same, but for what lies in gaps that are closed.
        assert!(drawn.iter().all(|px| (px / drawn[0] - 1.0).abs() < LENGTH_SHARE), "{name}: {drawn:?}");
        assert!(
            pen_up_px(&ours) <= pen_up_px(&theirs),
            "{name}: {} {}",
            pen_up_px(&ours),
            pen_up_px(&theirs)
        );
    }
}
