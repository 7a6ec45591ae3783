//! Drawings of other kinds than the thesis' figures, with lines of several widths.
#![allow(unreachable_pub, reason = "of a test, not an interface")]

use plotter_vector::PxPoint;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A drawing: its size, and each line with its width, px.
#[derive(Clone, Debug)]
pub struct Drawing {
    pub name: &'static str,
    pub size: (u32, u32),
    pub strokes: Vec<(Vec<PxPoint>, f64)>,
}

fn at(x: f64, y: f64) -> PxPoint {
    PxPoint::new(x, y)
}

fn line(places: &[(f64, f64)]) -> Vec<PxPoint> {
    places.iter().map(|(x, y)| at(*x, *y)).collect()
}

/// `count` pieces of a curve over 0 to 1.
fn curve(count: u32, of: impl Fn(f64) -> (f64, f64)) -> Vec<PxPoint> {
    (0..=count).map(|i| of(f64::from(i) / f64::from(count))).map(|(x, y)| at(x, y)).collect()
}

fn arc(x: f64, y: f64, radius: f64, from: f64, to: f64) -> Vec<PxPoint> {
    curve(120, |s| {
        let angle = from + s * (to - from);
        (x + radius * angle.cos(), y + radius * angle.sin())
    })
}

fn of_width(lines: Vec<Vec<PxPoint>>, width_px: f64) -> Vec<(Vec<PxPoint>, f64)> {
    lines.into_iter().map(|line| (line, width_px)).collect()
}

fn drawing(name: &'static str, size: (u32, u32), strokes: Vec<(Vec<PxPoint>, f64)>) -> Drawing {
    Drawing { name, size, strokes }
}

/// Boughs and twigs, each thinner than that which it grows from; the crown's twigs cross.
fn tree() -> Drawing {
    fn grow(from: PxPoint, angle: f64, length: f64, level: usize, strokes: &mut Vec<(Vec<PxPoint>, f64)>) {
        let Some(width) = [10.0, 7.0, 5.0, 4.0, 3.0].get(level) else { return };
        let to = at(from.x + length * angle.cos(), from.y + length * angle.sin());
        strokes.push((vec![from, to], *width));
        for turn in [-0.55, 0.12, 0.5] {
            grow(to, angle + turn, 0.68 * length, level + 1, strokes);
        }
    }
    let mut strokes = Vec::new();
    grow(at(300.2, 560.7), -FRAC_PI_2 + 0.03, 170.0, 0, &mut strokes);
    drawing("tree", (600, 620), strokes)
}

fn house() -> Drawing {
    let thick = [
        &[(90.3, 500.2), (90.3, 250.6), (410.8, 250.6), (410.8, 500.2), (90.3, 500.2)][..],
        &[(90.3, 250.6), (250.2, 110.3), (410.8, 250.6)],
    ];
    let thin = [
        &[(410.8, 250.6), (560.4, 200.2), (400.1, 70.3), (250.2, 110.3)][..],
        &[(560.4, 200.2), (560.4, 440.9), (410.8, 500.2)],
        &[(210.3, 500.2), (210.3, 380.4), (280.6, 380.4), (280.6, 500.2)],
        &[(120.3, 300.2), (180.7, 300.2), (180.7, 350.4), (120.3, 350.4), (120.3, 300.2)],
        &[(150.5, 300.2), (150.5, 350.4)],
        &[(120.3, 325.3), (180.7, 325.3)],
        &[(320.3, 300.2), (380.7, 300.2), (380.7, 350.4), (320.3, 350.4), (320.3, 300.2)],
        &[(350.5, 300.2), (350.5, 350.4)],
        &[(320.3, 325.3), (380.7, 325.3)],
    ];
    let strokes = thick.map(|places| (line(places), 6.0)).into_iter();
    drawing("house", (640, 560), strokes.chain(thin.map(|places| (line(places), 4.0))).collect())
}

fn rings() -> Drawing {
    let ring = |x: f64, y: f64| arc(x, y, 90.0, 0.0, TAU);
    let rings = vec![
        ring(150.2, 170.4),
        ring(300.4, 170.3),
        ring(450.7, 170.1),
        ring(225.1, 260.8),
        ring(375.3, 260.6),
    ];
    drawing("rings", (600, 420), of_width(rings, 8.0))
}

fn waves() -> Drawing {
    let wave = |y: f64, high: f64, long: f64, width: f64| {
        (curve(300, |s| (40.3 + 560.0 * s, y + high * (TAU * 560.0 * s / long).sin())), width)
    };
    let strokes = vec![
        wave(120.2, 60.0, 280.0, 3.0),
        wave(160.4, 70.0, 190.0, 5.0),
        wave(220.7, 80.0, 373.0, 7.0),
        wave(260.1, 50.0, 140.0, 4.0),
        wave(330.6, 60.0, 280.0, 10.0),
    ];
    drawing("waves", (640, 460), strokes)
}

fn rosette() -> Drawing {
    let rose = curve(600, |s| {
        let angle = TAU * s;
        let radius = 220.0 * (5.0 * angle).cos();
        (260.3 + radius * angle.cos(), 260.8 + radius * angle.sin())
    });
    drawing("rosette", (520, 520), of_width(vec![rose[..=300].to_vec()], 4.0))
}

fn hatched() -> Drawing {
    let mut lines = vec![line(&[(80.3, 80.2), (420.6, 80.2), (420.6, 420.7), (80.3, 420.7), (80.3, 80.2)])];
    for i in 1..24 {
        let c = 28.0 * f64::from(i);
        // x + y = c inside of the square.
        let side = 340.4;
        if c < side {
            lines.push(line(&[(80.3 + c, 80.2), (80.3, 80.2 + c)]));
        } else {
            lines.push(line(&[(420.6, 80.2 + c - side), (80.3 + c - side, 420.7)]));
        }
    }
    drawing("hatched square", (500, 500), of_width(lines, 4.0))
}

fn floor_plan() -> Drawing {
    let walls = [&[(60.3, 60.2), (560.6, 60.2), (560.6, 420.8), (60.3, 420.8), (60.3, 60.2)][..]];
    let inner = [
        &[(260.2, 60.2), (260.2, 230.4), (60.3, 230.4)][..],
        &[(260.2, 290.3), (260.2, 420.8)],
        &[(380.7, 420.8), (380.7, 230.4), (560.6, 230.4)],
        &[(380.7, 60.2), (380.7, 150.1)],
    ];
    let thin = vec![
        arc(260.2, 290.3, 60.0, -FRAC_PI_2, 0.0),
        line(&[(260.2, 290.3), (320.2, 290.3)]),
        arc(380.7, 150.1, 60.0, 0.0, FRAC_PI_2),
        line(&[(380.7, 150.1), (440.7, 150.1)]),
        line(&[(100.2, 100.4), (180.4, 100.4), (180.4, 160.7), (100.2, 160.7), (100.2, 100.4)]),
        arc(470.4, 330.2, 40.0, 0.0, TAU),
    ];
    let mut strokes: Vec<_> = walls.map(|places| (line(places), 10.0)).into();
    strokes.extend(inner.map(|places| (line(places), 7.0)));
    strokes.extend(of_width(thin, 3.0));
    drawing("floor plan", (620, 480), strokes)
}

fn snake() -> Drawing {
    let mut places = Vec::new();
    for i in 0..10 {
        let y = 80.3 + 28.0 * f64::from(i);
        let ends = [(70.2, y), (400.6, y)];
        places.extend(if i % 2 == 0 { ends } else { [ends[1], ends[0]] });
    }
    drawing("snake", (480, 420), of_width(vec![line(&places)], 5.0))
}

fn through_one_point() -> Drawing {
    let rays = (0..8).map(|i| {
        let angle = 0.1 + PI * f64::from(i) / 8.0;
        let (x, y) = (200.0 * angle.cos(), 200.0 * angle.sin());
        line(&[(250.3 - x, 250.6 - y), (250.3 + x, 250.6 + y)])
    });
    drawing("rays through a point", (500, 500), of_width(rays.collect(), 4.0))
}

fn rays_from_one_point() -> Drawing {
    let rays = (0..7).map(|i| {
        let angle = 0.1 + TAU * f64::from(i) / 7.0;
        line(&[(250.3, 250.6), (250.3 + 190.0 * angle.cos(), 250.6 + 190.0 * angle.sin())])
    });
    drawing("rays from a point", (500, 500), of_width(rays.collect(), 5.0))
}

fn five_star() -> Drawing {
    let corner = |i: u32| {
        let angle = -FRAC_PI_2 + TAU * f64::from(2 * i) / 5.0;
        at(250.3 + 200.0 * angle.cos(), 250.6 + 200.0 * angle.sin())
    };
    drawing("five-pointed star", (500, 500), of_width(vec![(0..=5).map(corner).collect()], 5.0))
}

fn handwriting() -> Drawing {
    // Loops of a trochoid, high and low ones in turn.
    let row = |y: f64, width: f64| {
        let loops = curve(700, |s| {
            let angle = TAU * 9.0 * s;
            let high = if (angle / TAU).floor() % 3.0 == 1.0 { 62.0 } else { 30.0 };
            (
                60.3 + 480.0 * s - 24.0 * angle.sin(),
                y - 0.5 * high * (1.0 - angle.cos()) + 6.0 * (3.0 * s).sin(),
            )
        });
        (loops, width)
    };
    drawing("handwriting", (620, 420), vec![row(120.2, 3.0), row(230.4, 4.0), row(350.7, 5.0)])
}

fn chords() -> Drawing {
    let on = |angle: f64| (260.3 + 190.0 * angle.cos(), 260.6 + 190.0 * angle.sin());
    let mut lines = vec![arc(260.3, 260.6, 190.0, 0.0, TAU)];
    lines.extend((0..9).map(|i| {
        let angle = 0.2 + TAU * f64::from(i) / 9.0;
        line(&[on(angle), on(angle + 2.4)])
    }));
    drawing("circle with chords", (520, 520), of_width(lines, 4.0))
}

fn spiral() -> Drawing {
    let wound = curve(900, |s| {
        let (angle, radius) = (TAU * 8.0 * s, 12.0 + 190.0 * s);
        (250.3 + radius * angle.cos(), 250.6 + radius * angle.sin())
    });
    drawing("spiral", (500, 500), of_width(vec![wound], 5.0))
}

fn grid() -> Drawing {
    let lines = (0..8).flat_map(|i| {
        let way = 70.3 + 50.0 * f64::from(i);
        [line(&[(way, 70.3), (way, 420.3)]), line(&[(70.3, way), (420.3, way)])]
    });
    drawing("grid", (500, 500), of_width(lines.collect(), 4.0))
}

fn dashed() -> Drawing {
    let mut strokes = Vec::new();
    for (row, width) in [2.0, 3.0, 5.0, 8.0].into_iter().enumerate() {
        let y = 80.3 + 60.0 * f64::from(u8::try_from(row).unwrap());
        for i in 0..13 {
            let x = 60.2 + 36.0 * f64::from(i);
            strokes.push((line(&[(x, y + 0.05 * x), (x + 20.0, y + 0.05 * (x + 20.0))]), width));
        }
    }
    strokes.extend(
        (0..20).map(|i| (arc(300.2, 420.4, 90.0, 0.314 * f64::from(i), 0.314 * f64::from(i) + 0.18), 4.0)),
    );
    drawing("dashes", (600, 540), strokes)
}

fn dots() -> Drawing {
    let mut strokes = vec![(line(&[(60.3, 80.2), (500.4, 90.7)]), 4.0)];
    for i in 0..8 {
        for (j, size) in [5.0, 8.0, 11.0].into_iter().enumerate() {
            let (x, y) = (80.2 + 55.0 * f64::from(i), 150.4 + 50.0 * f64::from(u8::try_from(j).unwrap()));
            strokes.push((line(&[(x, y), (x + 0.01, y)]), size));
        }
    }
    drawing("dots", (560, 340), strokes)
}

/// Letters, 26 px high.
fn text() -> Drawing {
    let letters: [&[&[(f64, f64)]]; 10] = [
        &[&[(0.0, 1.0), (0.35, 0.0), (0.7, 1.0)], &[(0.13, 0.62), (0.57, 0.62)]],
        &[&[(0.0, 0.0), (0.0, 1.0)], &[(0.6, 0.0), (0.6, 1.0)], &[(0.0, 0.5), (0.6, 0.5)]],
        &[&[(0.6, 0.0), (0.0, 0.0), (0.0, 1.0), (0.6, 1.0)], &[(0.0, 0.5), (0.5, 0.5)]],
        &[&[(0.0, 1.0), (0.0, 0.0), (0.6, 1.0), (0.6, 0.0)]],
        &[&[(0.0, 0.0), (0.6, 0.0)], &[(0.3, 0.0), (0.3, 1.0)]],
        &[&[(0.0, 0.0), (0.6, 1.0)], &[(0.6, 0.0), (0.0, 1.0)]],
        &[&[(0.0, 0.0), (0.3, 0.5), (0.6, 0.0)], &[(0.3, 0.5), (0.3, 1.0)]],
        &[&[(0.0, 0.0), (0.6, 0.0), (0.0, 1.0), (0.6, 1.0)]],
        &[&[(0.0, 0.0), (0.0, 1.0)], &[(0.6, 0.0), (0.0, 0.55), (0.6, 1.0)]],
        &[&[(0.0, 1.0), (0.0, 0.0), (0.35, 0.6), (0.7, 0.0), (0.7, 1.0)]],
    ];
    let mut strokes = Vec::new();
    for row in 0..3_u8 {
        let high = [26.0, 36.0, 50.0][usize::from(row)];
        let y = [70.3, 130.6, 210.4][usize::from(row)];
        for (i, letter) in letters.iter().enumerate() {
            let x = 50.2 + (0.7 * high + 14.0) * f64::from(u8::try_from(i).unwrap());
            for part in *letter {
                let places: Vec<_> = part.iter().map(|(u, v)| at(x + high * u, y + high * v)).collect();
                strokes.push((places, [3.0, 4.0, 5.0][usize::from(row)]));
            }
            // And an O beside it, as round letters are.
            if i == 9 {
                strokes.push((
                    arc(x + 1.3 * high, y + 0.5 * high, 0.45 * high, 0.0, TAU),
                    [3.0, 4.0, 5.0][usize::from(row)],
                ));
            }
        }
    }
    drawing("text", (640, 320), strokes)
}

fn double_border() -> Drawing {
    let frame = |by: f64| {
        line(&[
            (70.3 + by, 70.2 + by),
            (480.6 - by, 70.2 + by),
            (480.6 - by, 390.7 - by),
            (70.3 + by, 390.7 - by),
            (70.3 + by, 70.2 + by),
        ])
    };
    // 6 px of paper between lines of 4 px, then 6 px from middle to middle of lines of 2 px.
    let strokes = vec![(frame(0.0), 4.0), (frame(10.0), 4.0), (frame(90.0), 2.0), (frame(96.0), 2.0)];
    drawing("double borders", (550, 460), strokes)
}

/// Lines that are 3 px wide at one end and 11 px at the other.
fn thick_thin() -> Drawing {
    let along = |of: &dyn Fn(f64) -> (f64, f64)| -> Vec<(Vec<PxPoint>, f64)> {
        let places = curve(80, of);
        let wide = |i: usize| 7.0 - 4.0 * (TAU * f64::from(u8::try_from(i).unwrap()) / 80.0).cos();
        places.windows(2).enumerate().map(|(i, pair)| (pair.to_vec(), wide(i))).collect()
    };
    let mut strokes = along(&|s| (60.2 + 460.0 * s, 90.3 + 20.0 * s));
    strokes.extend(along(&|s| (60.2 + 460.0 * s, 230.3 + 60.0 * (TAU * s).sin())));
    // A step in width.
    strokes.push((line(&[(60.3, 370.2), (290.2, 380.4)]), 3.0));
    strokes.push((line(&[(290.2, 380.4), (520.3, 390.6)]), 8.0));
    drawing("thick and thin", (580, 460), strokes)
}

fn leaving() -> Drawing {
    let strokes = vec![
        (line(&[(0.0, 100.3), (500.0, 140.6)]), 5.0),
        (line(&[(150.2, 0.0), (190.6, 400.0)]), 4.0),
        (arc(380.2, 380.4, 120.0, 3.0, TAU - 0.07), 6.0),
        (line(&[(20.3, 250.7), (330.4, 250.2), (303.9, 400.0)]), 4.0),
    ];
    drawing("leaving the picture", (500, 400), strokes)
}

fn tees() -> Drawing {
    let mut strokes =
        vec![(line(&[(60.3, 100.2), (520.6, 110.7)]), 8.0), (line(&[(60.3, 330.2), (520.6, 320.7)]), 6.0)];
    for i in 0..6 {
        let x = 90.2 + 75.0 * f64::from(i);
        let lean = 12.0 * f64::from(i);
        // Ends in the middle of the one, and before the rim of the other.
        strokes.push((line(&[(x, 100.2 + 10.5 * (x - 60.3) / 460.3), (x + lean, 210.4)]), 4.0));
        let low = 330.2 - 9.5 * (x + 20.0 - 60.3) / 460.3;
        strokes.push((line(&[(x + 20.0, low), (x + 20.0 - lean, low + 90.0)]), 3.0 + f64::from(i)));
    }
    drawing("tees", (600, 460), strokes)
}

fn blobs() -> Drawing {
    let strokes = vec![
        (line(&[(120.3, 120.2), (400.6, 130.7)]), 4.0),
        (line(&[(100.3, 120.2), (100.31, 120.2)]), 50.0),
        (line(&[(120.2, 300.4), (420.4, 280.2)]), 6.0),
        (line(&[(445.2, 280.4), (445.21, 280.4)]), 64.0),
    ];
    drawing("blobs", (560, 400), strokes)
}

fn honeycomb() -> Drawing {
    let (side, mut lines) = (44.0, Vec::new());
    let high = side * 3.0_f64.sqrt();
    for i in 0..5 {
        for j in 0..4 {
            let x = 100.3 + 1.5 * side * f64::from(i);
            let y = 100.6 + high * (f64::from(j) + if i % 2 == 0 { 0.0 } else { 0.5 });
            let corner = |k: i32| {
                let angle = PI * f64::from(k) / 3.0;
                at(x + side * angle.cos(), y + side * angle.sin())
            };
            // Each side once: three of each cell, and the others at the rim.
            for k in 0..6 {
                let middle = |a: PxPoint, b: PxPoint| at(0.5 * (a.x + b.x), 0.5 * (a.y + b.y));
                let (a, b) = (corner(k), corner(k + 1));
                let known = |one: &Vec<PxPoint>| middle(one[0], one[1]).distance(middle(a, b)) < 2.0;
                if !lines.iter().any(known) {
                    lines.push(vec![a, b]);
                }
            }
        }
    }
    drawing("honeycomb", (480, 460), of_width(lines, 4.0))
}

fn cube() -> Drawing {
    let lines = vec![
        line(&[(90.3, 180.2), (290.6, 180.2), (290.6, 380.7), (90.3, 380.7), (90.3, 180.2)]),
        line(&[(90.3, 180.2), (190.4, 80.3), (390.7, 80.3), (290.6, 180.2)]),
        line(&[(390.7, 80.3), (390.7, 280.8), (290.6, 380.7)]),
        line(&[(190.4, 80.3), (190.4, 280.8), (390.7, 280.8)]),
        line(&[(190.4, 280.8), (90.3, 380.7)]),
    ];
    drawing("cube", (480, 460), of_width(lines, 5.0))
}

fn touching() -> Drawing {
    let lines = vec![
        arc(130.3, 150.2, 70.0, 0.0, TAU),
        arc(270.3, 150.2, 70.0, 0.0, TAU),
        arc(380.3, 150.2, 40.0, 0.0, TAU),
        line(&[(50.2, 220.2), (460.4, 220.2)]),
        arc(200.2, 280.2, 60.0, 0.0, TAU),
    ];
    drawing("touching circles", (510, 400), of_width(lines, 5.0))
}

fn lissajous() -> Drawing {
    let figure =
        curve(900, |s| (260.3 + 200.0 * (5.0 * TAU * s).sin(), 240.6 + 180.0 * (4.0 * TAU * s + 0.4).sin()));
    drawing("lissajous", (520, 480), of_width(vec![figure], 3.0))
}

fn bricks() -> Drawing {
    let mut lines: Vec<_> =
        (0..7).map(|i| 70.3 + 45.0 * f64::from(i)).map(|y| line(&[(60.2, y), (470.4, y)])).collect();
    for i in 0..6 {
        let y = 70.3 + 45.0 * f64::from(i);
        for j in 0..5 {
            let x = 60.2 + 82.04 * f64::from(j) + if i % 2 == 0 { 41.0 } else { 82.04 };
            if x < 470.0 {
                lines.push(line(&[(x, y), (x, y + 45.0)]));
            }
        }
    }
    drawing("bricks", (540, 420), of_width(lines, 4.0))
}

pub fn drawings() -> Vec<Drawing> {
    vec![
        tree(),
        house(),
        rings(),
        waves(),
        rosette(),
        hatched(),
        floor_plan(),
        snake(),
        through_one_point(),
        rays_from_one_point(),
        five_star(),
        handwriting(),
        chords(),
        spiral(),
        grid(),
        dashed(),
        dots(),
        text(),
        double_border(),
        thick_thin(),
        leaving(),
        tees(),
        blobs(),
        honeycomb(),
        cube(),
        touching(),
        lissajous(),
        bricks(),
    ]
}
