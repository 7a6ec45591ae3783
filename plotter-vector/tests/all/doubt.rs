//! Noise of many kinds is no drawing, and says so or stays empty; drawings full of dots, dashes and letters
//! are drawings.

use plotter_motion::SplitMix64;
use plotter_vector::{
    Gray, Vectorizer,
    picture::GrayRows,
    trace::{Doubt, Progress},
};

const WIDTH: u32 = 500;
const HEIGHT: u32 = 400;

fn picture(mut level: impl FnMut(u32, u32) -> f64) -> Gray {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is a level")]
    let at = |(x, y): (u32, u32)| level(x, y).round().clamp(0.0, 255.0) as u8;
    let places = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    Gray::new(WIDTH, HEIGHT, places.map(at).collect()).unwrap()
}

/// The doubt, the same of the whole picture and by rows, and the number of strokes.
fn doubt(gray: Gray) -> (Option<Doubt>, usize) {
    let found = Vectorizer::default().vectorize(&gray).unwrap();
    let by_rows =
        Vectorizer::default().vectorize_rows(&mut GrayRows::new(gray), &mut Progress::silent()).unwrap();
    assert_eq!((by_rows.doubt, &by_rows.drawing), (found.doubt, &found.drawing));
    (found.doubt, found.drawing.strokes().len())
}

/// About normal, of a standard deviation of 1.
fn normal(random: &mut SplitMix64) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

/// Noise whose grain is so large, px, of a standard deviation of 1.
fn grain(random: &mut SplitMix64, radius: usize) -> Vec<f64> {
    let (width, height) = (WIDTH as usize, HEIGHT as usize);
    let raw: Vec<f64> = (0..width * height).map(|_| normal(random)).collect();
    let mean = |at: usize| {
        let (x, y) = (at % width, at / width);
        let rows = y.saturating_sub(radius)..(y + radius + 1).min(height);
        let sum: f64 = rows
            .flat_map(|y| (x.saturating_sub(radius)..(x + radius + 1).min(width)).map(move |x| (x, y)))
            .filter_map(|(x, y)| raw.get(y * width + x))
            .sum();
        #[expect(clippy::cast_precision_loss, reason = "some pixels")]
        let side = (2 * radius + 1) as f64;
        sum / side
    };
    (0..width * height).map(mean).collect()
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn noise_is_doubted_or_blank() {
    let mut random = SplitMix64::new(3);
    for share in [0.03, 0.1, 0.3] {
        let pepper = picture(|_, _| if random.unit() < share { 0.0 } else { 255.0 });
        let found = doubt(pepper);
        assert!(matches!(found, (Some(Doubt::Thrown { .. }), 100..)), "{share}: {found:?}");
    }
    for radius in [1, 2] {
        let grains = grain(&mut random, radius);
        let at = |x: u32, y: u32| grains.get((y * WIDTH + x) as usize).copied().unwrap_or_default();
        let spots = doubt(picture(|x, y| if at(x, y) > 1.3 { 40.0 } else { 235.0 }));
        assert!(matches!(spots, (Some(Doubt::Specks { .. }), 150..)), "spots of {radius} px: {spots:?}");
        let paper = doubt(picture(|x, y| 215.0 + 25.0 * at(x, y)));
        assert!(matches!(paper, (Some(_), _)) || paper.1 == 0, "grain of {radius} px: {paper:?}");
    }
    let cloth = doubt(picture(|x, y| 150.0 + 40.0 * f64::from(x).sin() * f64::from(y).sin()));
    assert!(cloth.0.is_some() || cloth.1 == 0, "{cloth:?}");
    let rough = doubt(picture(|_, _| 128.0 + 60.0 * normal(&mut random)));
    assert!(matches!(rough, (Some(Doubt::Rough { .. }), 0)), "{rough:?}");
    let text = rough.0.map(|doubt| doubt.to_string()).unwrap_or_default();
    assert!(text.starts_with("no ink was found"), "{text}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_blank_sheet_is_no_doubt() {
    let mut random = SplitMix64::new(5);
    for noise in [0.0, 1.0, 4.0] {
        assert_eq!(doubt(picture(|_, _| 240.0 + noise * normal(&mut random))), (None, 0), "{noise}");
        assert_eq!(
            doubt(picture(|x, _| 240.0 - 0.2 * f64::from(x) + noise * normal(&mut random))),
            (None, 0)
        );
    }
}

/// Round dots at places, each with its diameter, px, as a pen draws them.
fn dots(dots: &[[f64; 3]]) -> Gray {
    let mut levels = vec![250.0_f64; (WIDTH * HEIGHT) as usize];
    for [x, y, diameter] in dots {
        for (u, v) in (-6..=6).flat_map(|v| (-6..=6).map(move |u| (u, v))) {
            let (column, row) = (x.floor() + f64::from(u), y.floor() + f64::from(v));
            let far = (column + 0.5 - x).hypot(row + 0.5 - y);
            let covered = (0.5 * diameter + 0.5 - far).clamp(0.0, 1.0);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside the picture")]
            if (0.0..f64::from(WIDTH)).contains(&column) && (0.0..f64::from(HEIGHT)).contains(&row) {
                let level = &mut levels[row as usize * WIDTH as usize + column as usize];
                *level = level.min(250.0 - 230.0 * covered);
            }
        }
    }
    picture(|x, y| levels.get((y * WIDTH + x) as usize).copied().unwrap_or_default())
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn dots_dashes_and_hatching_are_drawings() {
    let mut random = SplitMix64::new(8);
    let mut strewn = |diameter: f64, spread: f64| -> Vec<[f64; 3]> {
        let mut place = || [5.0 + 490.0 * random.unit(), 5.0 + 390.0 * random.unit()];
        let places: Vec<[f64; 2]> = (0..1000).map(|_| place()).collect();
        places.iter().map(|[x, y]| [*x, *y, diameter * (1.0 + spread * normal(&mut random))]).collect()
    };
    for (name, drawn) in [
        ("dots of 3 px", strewn(3.0, 0.1)),
        ("dots of 5 px", strewn(5.0, 0.12)),
        ("two pens", [strewn(3.0, 0.1), strewn(8.0, 0.1).split_off(800)].concat()),
    ] {
        let found = doubt(dots(&drawn));
        assert!(matches!(found, (None, 500..)), "{name}: {found:?}");
    }
    let dashes = picture(|x, y| if x % 12 < 7 && y % 9 < 3 { 20.0 } else { 250.0 });
    assert!(matches!(doubt(dashes), (None, 1000..)));
    // Hatching so dense that nothing of the paper is as wide as the lines and their rims.
    let hatching = |x: u32, y: u32| {
        let across = (0.7 * f64::from(x) - 0.7 * f64::from(y)).rem_euclid(6.4);
        250.0 - 230.0 * (1.75 - (across - 3.2).abs()).clamp(0.0, 1.0)
    };
    let mut noise = SplitMix64::new(2);
    let found = doubt(picture(|x, y| hatching(x, y) + 2.0 * normal(&mut noise)));
    assert!(matches!(found, (None, 60..)), "{found:?}");
}
