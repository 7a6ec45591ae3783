//! Pens are told apart on drawn pictures with soft rims, on pale and noisy paper, and where they cross.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    reason = "a test fails by a panic, and its pictures are small"
)]

use plotter_vector::{
    Bitmap, Colour, Palette, Pixel, Rgb, Vectorizer,
    ink::{Layers, PalettePen, Pens},
};

const BLACK: Rgb = Rgb([0, 0, 0]);
const RED: Rgb = Rgb([208, 24, 24]);
const BLUE: Rgb = Rgb([24, 64, 200]);
const GREEN: Rgb = Rgb([20, 130, 50]);
const YELLOW: Rgb = Rgb([250, 225, 30]);

/// Rims are about a pixel wide: ink farther than this outside of its own stroke is on the wrong pen, px.
const RIM_PX: f64 = 0.75;

/// A straight stroke with round caps.
#[derive(Clone, Copy)]
struct Stroke {
    pen: Rgb,
    from: (f64, f64),
    to: (f64, f64),
    width_px: f64,
}

impl Stroke {
    fn new(pen: Rgb, from: (f64, f64), to: (f64, f64)) -> Self {
        Self { pen, from, to, width_px: 3.0 }
    }

    /// How far a place lies outside of the stroke, px.
    fn outside(&self, (x, y): (f64, f64)) -> f64 {
        let (dx, dy) = (self.to.0 - self.from.0, self.to.1 - self.from.1);
        let (px, py) = (x - self.from.0, y - self.from.1);
        let along = ((px * dx + py * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        libm::hypot(px - along * dx, py - along * dy) - self.width_px / 2.0
    }
}

/// What the strokes leave on paper, later ones over earlier ones, each with a rim of one pixel.
fn draw(width: u32, height: u32, paper: Rgb, strokes: &[Stroke]) -> Vec<[f64; 3]> {
    let mut pixels = vec![paper.0.map(f64::from); (width * height) as usize];
    for stroke in strokes {
        for (at, pixel) in (0..).zip(&mut pixels) {
            let centre = (f64::from(at % width) + 0.5, f64::from(at / width) + 0.5);
            let share = (0.5 - stroke.outside(centre)).clamp(0.0, 1.0);
            for (level, pen) in pixel.iter_mut().zip(stroke.pen.0) {
                *level += (f64::from(pen) - *level) * share;
            }
        }
    }
    pixels
}

fn scan(width: u32, pixels: &[[f64; 3]]) -> Colour {
    let height = u32::try_from(pixels.len()).unwrap() / width;
    let channels = pixels.as_flattened().iter().map(|level| level.round().clamp(0.0, 255.0) as u8).collect();
    Colour::new(width, height, channels).unwrap()
}

fn picture(width: u32, height: u32, strokes: &[Stroke]) -> Colour {
    scan(width, &draw(width, height, Rgb::WHITE, strokes))
}

/// Pen i of `pens`, however it is numbered: the layer whose colour is nearest.
fn layer(layers: &Layers, pen: Rgb) -> usize {
    let distance = |other: Rgb| other.oklab().distance(pen.oklab());
    let pens = layers.palette().pens().iter().enumerate();
    pens.min_by(|a, b| distance(a.1.colour).total_cmp(&distance(b.1.colour))).unwrap().0
}

/// Ink that lies on a stroke of its own pen, of all ink.
fn share_on_its_pen(layers: &Layers, strokes: &[Stroke]) -> f64 {
    let (mut right, mut all) = (0, 0);
    for (index, (_, ink)) in layers.iter().enumerate() {
        let own: Vec<_> = strokes.iter().filter(|stroke| layer(layers, stroke.pen) == index).collect();
        for at in ink.ink() {
            let centre = (f64::from(at.x) + 0.5, f64::from(at.y) + 0.5);
            right += u32::from(own.iter().any(|stroke| stroke.outside(centre) < RIM_PX));
            all += 1;
        }
    }
    f64::from(right) / f64::from(all)
}

/// How much of a stroke's middle line is ink, without the last pixels at both ends.
fn recall(ink: &Bitmap, stroke: &Stroke) -> f64 {
    let at = |step: u32| {
        let share = f64::from(step) / 1000.0;
        let mix = |from: f64, to: f64| from + (to - from) * share;
        let (x, y) = (mix(stroke.from.0, stroke.to.0), mix(stroke.from.1, stroke.to.1));
        ink.get(Pixel::new(x as u32, y as u32))
    };
    (20..=980).filter(|step| at(*step)).count() as f64 / 961.0
}

/// Black below, then red, blue and green: crossing each other at many angles.
fn four_pens() -> Vec<Stroke> {
    let mut strokes = Vec::new();
    for (pen, turn) in [(BLACK, 0.0), (RED, 0.45), (BLUE, 1.05), (GREEN, 1.9)] {
        for shift in [-60.0, 0.0, 55.0] {
            let (cos, sin) = (libm::cos(turn), libm::sin(turn));
            let middle = (130.0 - sin * shift, 130.0 + cos * shift);
            let end = |length: f64| (middle.0 + cos * length, middle.1 + sin * length);
            strokes.push(Stroke::new(pen, end(-105.0), end(105.0)));
        }
    }
    strokes
}

/// Numbers from -1 to 1 that repeat.
fn noise(seed: u32) -> impl Iterator<Item = f64> {
    let next = |state: &u32| Some(state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    std::iter::successors(Some(seed), next).map(|state| f64::from(state >> 8) / f64::from(1 << 23) - 1.0)
}

fn palette(colours: &[Rgb]) -> Palette {
    let pen = |(number, colour): (u8, &Rgb)| PalettePen {
        number,
        name: colour.to_string(),
        colour: *colour,
        width_mm: None,
    };
    Palette::new((1..).zip(colours).map(pen).collect()).unwrap()
}

#[test]
fn four_pens_are_found_with_their_colours_and_each_has_its_own_ink() {
    let strokes = four_pens();
    let layers = Pens::Found.separate(&picture(260, 260, &strokes)).unwrap();
    let mut colours: Vec<Rgb> = layers.palette().pens().iter().map(|pen| pen.colour).collect();
    assert_eq!(colours.first(), Some(&BLACK), "the darkest is the first");
    colours.sort_unstable();
    for (found, pen) in colours.iter().zip([BLACK, GREEN, BLUE, RED]) {
        assert!(found.oklab().distance(pen.oklab()) < 0.01, "{found} for {pen}");
    }
    assert_eq!(colours.len(), 4);
    assert!(share_on_its_pen(&layers, &strokes) > 0.999);
}

#[test]
fn grey_rims_of_black_are_black_and_give_its_width() {
    let strokes =
        [Stroke::new(BLACK, (10.0, 12.3), (190.0, 60.6)), Stroke::new(RED, (10.0, 80.0), (190.0, 80.0))];
    let layers = Pens::Found.separate(&picture(200, 100, &strokes)).unwrap();
    assert_eq!(layers.palette().pens().len(), 2);
    let ink = layers.ink(layer(&layers, BLACK)).unwrap();
    // Length times width, and two half circles.
    let area = 3.0 * libm::hypot(180.0, 48.3) + 1.5 * 1.5 * core::f64::consts::PI;
    assert!((ink.count() as f64 - area).abs() < 0.01 * area, "{} for {area}", ink.count());
}

#[test]
fn yellow_is_light_but_ink() {
    let strokes =
        [Stroke::new(YELLOW, (10.0, 12.3), (190.0, 60.6)), Stroke::new(BLACK, (10.0, 70.0), (150.0, 5.0))];
    let layers = Pens::Found.separate(&picture(200, 100, &strokes)).unwrap();
    assert_eq!(layers.palette().pens().len(), 2);
    assert_eq!(share_on_its_pen(&layers, &strokes), 1.0);
    let ink = layers.bridged(layer(&layers, YELLOW)).unwrap();
    assert!(recall(&ink, &strokes[0]) > 0.99);
}

#[test]
fn where_yellow_and_blue_mix_to_grey_nothing_is_black() {
    let strokes = [
        Stroke::new(YELLOW, (10.0, 12.3), (190.0, 60.6)),
        Stroke::new(BLUE, (15.0, 70.0), (150.0, 5.0)),
        Stroke::new(BLACK, (10.0, 90.0), (190.0, 90.0)),
    ];
    let layers = Pens::Found.separate(&picture(200, 100, &strokes)).unwrap();
    assert_eq!(layers.palette().pens().len(), 3);
    assert_eq!(share_on_its_pen(&layers, &strokes), 1.0);
}

#[test]
fn a_mixture_is_no_pen_even_when_a_pen_of_its_colour_is_near() {
    // Half yellow and half blue is (137, 145, 115); the green pen is on the sheet as well.
    let mut strokes = four_pens();
    strokes.retain(|stroke| stroke.pen != RED && stroke.pen != BLACK);
    for y in [20.0, 40.0, 60.0, 80.0] {
        strokes.push(Stroke::new(YELLOW, (20.0, y), (240.0, y + 100.0)));
    }
    let layers = Pens::Found.separate(&picture(260, 260, &strokes)).unwrap();
    assert_eq!(layers.palette().pens().len(), 3);
    assert!(share_on_its_pen(&layers, &strokes) > 0.999);
}

#[test]
fn near_hues_are_two_pens_and_one_that_wavers_is_one() {
    let found = |other: Rgb| {
        let strokes: Vec<Stroke> = [BLUE, other, BLUE, other]
            .into_iter()
            .zip([20.0, 60.0, 100.0, 140.0])
            .map(|(pen, y)| Stroke::new(pen, (20.0, y), (240.0, y + 30.0)))
            .collect();
        Pens::Found.separate(&picture(260, 200, &strokes)).unwrap().palette().pens().len()
    };
    assert_eq!((found(Rgb([90, 50, 200])), found(Rgb([60, 64, 200]))), (2, 1));
}

#[test]
fn a_short_word_is_a_pen_and_a_blot_is_none() {
    // 1600 px of black; the red is 1 and 0.25 per cent of it.
    let mut strokes: Vec<Stroke> = (0..8)
        .map(|row| {
            Stroke::new(BLACK, (10.0, 10.0 + 20.0 * f64::from(row)), (245.0, 16.0 + 20.0 * f64::from(row)))
        })
        .collect();
    let red = |from: f64, length: f64| Stroke::new(RED, (from, 180.0), (from + length, 180.0));
    let found = |strokes: &[Stroke]| {
        Pens::Found.separate(&picture(260, 190, strokes)).unwrap().palette().pens().len()
    };
    strokes.push(red(30.0, 18.0));
    assert_eq!(found(&strokes), 2);
    strokes.pop();
    strokes.push(red(30.0, 2.0));
    assert_eq!(found(&strokes), 1);
}

#[test]
fn a_pen_of_the_colour_of_a_mixture_is_one_where_it_has_strokes_of_its_own() {
    // Black over blue makes this dark blue; here it is drawn by itself.
    let dark_blue = Rgb([12, 32, 100]);
    let row = |pen, y| Stroke::new(pen, (20.0, y), (240.0, y + 12.0));
    let strokes =
        [row(BLACK, 20.0), row(BLUE, 60.0), row(dark_blue, 100.0), row(BLACK, 140.0), row(dark_blue, 180.0)];
    let layers = Pens::Found.separate(&picture(260, 220, &strokes)).unwrap();
    assert_eq!(layers.palette().pens().len(), 3);
    assert!(share_on_its_pen(&layers, &strokes) > 0.99);
}

#[test]
fn pale_paper_with_noise_is_paper() {
    let strokes = four_pens();
    let paper = Rgb([243, 234, 214]);
    let mut pixels = draw(260, 260, paper, &strokes);
    pixels.as_flattened_mut().iter_mut().zip(noise(7)).for_each(|(level, noise)| *level += 9.0 * noise);
    let layers = Pens::Found.separate(&scan(260, &pixels)).unwrap();
    assert!(layers.paper().oklab().distance(paper.oklab()) < 0.01, "{}", layers.paper());
    assert_eq!(layers.palette().pens().len(), 4);
    assert!(share_on_its_pen(&layers, &strokes) > 0.995);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn colours_smeared_as_jpeg_does_stay_on_their_strokes() {
    let strokes = four_pens();
    let mut pixels = draw(260, 260, Rgb::WHITE, &strokes);
    // Brightness stays, colour is the mean of blocks of 2 x 2 px.
    let luma = |[r, g, b]: [f64; 3]| 0.299 * r + 0.587 * g + 0.114 * b;
    let copy = pixels.clone();
    for (at, pixel) in pixels.iter_mut().enumerate() {
        let (x, y) = (at % 260 / 2 * 2, at / 260 / 2 * 2);
        let block = [0, 1, 260, 261].map(|step| copy[y * 260 + x + step]);
        let mean: [f64; 3] = std::array::from_fn(|i| block.iter().map(|pixel| pixel[i]).sum::<f64>() / 4.0);
        let own = luma(*pixel);
        *pixel = mean.map(|level| level - luma(mean) + own);
    }
    pixels.as_flattened_mut().iter_mut().zip(noise(3)).for_each(|(level, noise)| *level += 5.0 * noise);
    let layers = Pens::Found.separate(&scan(260, &pixels)).unwrap();
    let found: Vec<(String, u64)> = layers.iter().map(|(pen, ink)| (pen.name.clone(), ink.count())).collect();
    assert_eq!(found.len(), 4, "{found:?}");
    let right = share_on_its_pen(&layers, &strokes);
    assert!(right > 0.98, "{right}");
}

#[test]
fn a_grey_picture_has_one_pen() {
    let mut strokes = four_pens();
    for (stroke, level) in strokes.iter_mut().zip([0, 60, 110, 20].into_iter().cycle()) {
        stroke.pen = Rgb([level; 3]);
    }
    let mut pixels = draw(260, 260, Rgb([236; 3]), &strokes);
    for (pixel, noise) in pixels.iter_mut().zip(noise(5)) {
        *pixel = pixel.map(|level| level + 8.0 * noise);
    }
    let layers = Pens::Found.separate(&scan(260, &pixels)).unwrap();
    assert_eq!(layers.palette().pens().len(), 1);
}

#[test]
fn black_and_grey_are_told_apart_by_a_palette() {
    let grey = Rgb([128; 3]);
    let strokes =
        [Stroke::new(BLACK, (10.0, 12.3), (190.0, 30.6)), Stroke::new(grey, (10.0, 82.0), (190.0, 60.0))];
    let given = palette(&[grey, BLACK, GREEN]);
    let layers = Pens::Given(given.clone()).separate(&picture(200, 100, &strokes)).unwrap();
    assert_eq!(layers.palette(), &given);
    assert_eq!(share_on_its_pen(&layers, &strokes), 1.0);
    assert_eq!(layers.ink(2).map(Bitmap::count), Some(0), "no green on the sheet");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn given_pens_may_have_faded() {
    let strokes = four_pens();
    let given = palette(&[Rgb([255, 0, 0]), Rgb([0, 0, 255]), Rgb([40, 40, 40]), Rgb([0, 160, 70])]);
    let layers = Pens::Given(given).separate(&picture(260, 260, &strokes)).unwrap();
    assert!(share_on_its_pen(&layers, &strokes) > 0.999);
    let found = Pens::Found.separate(&picture(260, 260, &strokes)).unwrap();
    let ink = |layers: &Layers| layers.ink(layer(layers, RED)).unwrap().count();
    assert_eq!(ink(&layers), ink(&found), "as wide as with the colours that are there");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn as_many_pens_are_found_as_are_asked_for_and_there() {
    let strokes = four_pens();
    let picture = picture(260, 260, &strokes);
    let found = |count| Pens::Count(count).separate(&picture).map(|layers| layers.palette().pens().len());
    assert_eq!([found(1), found(3), found(4)], [Ok(1), Ok(3), Ok(4)]);
    for bad in [0, 17] {
        assert_eq!(
            found(bad).unwrap_err().to_string(),
            format!("{bad} pens cannot be found: ask for 1 to 16, or leave the number open")
        );
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn noise_of_four_colours_takes_a_bounded_time() {
    let colours = [Rgb::WHITE, BLACK, RED, BLUE];
    let place = |noise: f64| colours[(2.0 + 1.999 * noise) as usize].0.map(f64::from);
    let pixels: Vec<_> = noise(1).take(400 * 300).map(place).collect();
    let layers = Pens::Found.separate(&scan(400, &pixels)).unwrap();
    let ink: u64 = layers.iter().map(|(_, ink)| ink.count()).sum();
    assert_eq!(layers.iter().filter_map(|(_, ink)| (ink.count() > 0).then_some(())).count(), 3);
    assert!(ink > 80_000, "{ink}");
    assert!((0..3).all(|pen| layers.bridged(pen).is_some()));
}

#[test]
fn a_sheet_without_ink_has_one_pen_that_draws_nothing() {
    for (width, height, level) in [(0, 0, 0), (0, 3, 0), (1, 1, 0), (9, 7, 255), (9, 7, 0)] {
        let sheet = Colour::new(width, height, vec![level; (3 * width * height) as usize]).unwrap();
        for pens in [Pens::Found, Pens::Count(3)] {
            let layers = pens.separate(&sheet).unwrap();
            let ink: Vec<u64> = layers.iter().map(|(_, ink)| ink.count()).collect();
            assert_eq!(ink, [0]);
            let bridged = layers.bridged(0).unwrap();
            assert_eq!((bridged.width(), bridged.height()), (width, height));
            assert!(layers.coverage(0, &bridged, &sheet).unwrap().pixels().iter().all(|level| *level == 255));
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_stroke_crossed_at_any_angle_from_20_degrees_is_made_whole() {
    for degrees in (20..=90).step_by(7) {
        let turn = f64::from(degrees).to_radians();
        let (x, y) = (80.0 * libm::cos(turn), 80.0 * libm::sin(turn));
        let below = Stroke::new(BLUE, (15.0, 100.0), (185.0, 101.5));
        let above = Stroke::new(RED, (100.0 - x, 100.0 - y), (100.0 + x, 100.0 + y));
        let layers = Pens::Found.separate(&picture(200, 200, &[below, above])).unwrap();
        let (blue, red) = (layer(&layers, BLUE), layer(&layers, RED));
        assert!(recall(layers.ink(blue).unwrap(), &below) < 0.99, "{degrees}: there is a gap");
        assert_eq!(recall(&layers.bridged(blue).unwrap(), &below), 1.0, "{degrees}");
        assert_eq!(layers.bridged(red).as_ref(), layers.ink(red), "{degrees}: red was never crossed");
    }
}

#[test]
fn hatching_under_another_pen_is_not_linked_across() {
    // Blue lines as far apart as they are wide, crossed by red at 50 degrees.
    let mut strokes: Vec<Stroke> = (0..10)
        .map(|line| {
            let x = 20.0 + 6.0 * f64::from(line);
            Stroke::new(BLUE, (x, 10.0), (x, 140.0))
        })
        .collect();
    strokes.push(Stroke::new(RED, (5.0, 30.0), (95.0, 137.0)));
    let layers = Pens::Found.separate(&picture(100, 150, &strokes)).unwrap();
    let blue = layer(&layers, BLUE);
    let whole = layers.bridged(blue).unwrap();
    for at in whole.ink() {
        let centre = (f64::from(at.x) + 0.5, f64::from(at.y) + 0.5);
        let outside = strokes[..10].iter().map(|stroke| stroke.outside(centre)).fold(f64::INFINITY, f64::min);
        assert!(outside < RIM_PX, "{at:?} is between two lines");
    }
    let found: f64 = strokes[..10].iter().map(|stroke| recall(&whole, stroke)).sum();
    assert!(found > 9.99, "{found} of 10 lines");
}

#[test]
fn coverage_adds_up_to_the_width_of_the_stroke() {
    let strokes =
        [Stroke::new(BLUE, (0.0, 20.3), (100.0, 20.3)), Stroke::new(RED, (30.0, 0.0), (30.0, 40.0))];
    let picture = picture(100, 40, &strokes);
    let layers = Pens::Found.separate(&picture).unwrap();
    let blue = layer(&layers, BLUE);
    let coverage = layers.coverage(blue, &layers.bridged(blue).unwrap(), &picture).unwrap();
    for x in (5..95).filter(|x| !(27..33).contains(x)) {
        let covered: u32 = coverage.rows().map(|row| 255 - u32::from(row[x])).sum();
        assert!((f64::from(covered) / 255.0 - 3.0).abs() < 0.01, "column {x}: {covered}");
    }
    let crossing: u32 = coverage.rows().map(|row| 255 - u32::from(row[30])).sum();
    assert_eq!(crossing, 3 * 255, "below red the stroke goes on");
    assert_eq!(layers.coverage(9, &coverage_of_nothing(), &picture), None);
    assert_eq!(layers.coverage(blue, &coverage_of_nothing(), &picture), None);
}

/// A pencil, paler than black and of its hue.
const PENCIL: Rgb = Rgb([160, 160, 160]);

/// Black and pencil lines that cross each other.
fn pencil_and_black() -> Vec<Stroke> {
    let line = |pen, from, to| Stroke { width_px: 3.4, ..Stroke::new(pen, from, to) };
    vec![
        line(PENCIL, (20.0, 45.0), (240.0, 95.0)),
        line(BLACK, (20.0, 130.0), (240.0, 30.0)),
        line(BLACK, (60.0, 15.0), (100.0, 155.0)),
        line(PENCIL, (190.0, 15.0), (160.0, 155.0)),
    ]
}

#[test]
fn a_pencil_beside_black_is_a_pen_and_both_are_whole_where_they_cross() {
    let strokes = pencil_and_black();
    let picture = picture(260, 170, &strokes);
    for pens in [Pens::Found, Pens::Count(2), Pens::Given(palette(&[BLACK, PENCIL]))] {
        let layers = pens.separate(&picture).unwrap();
        assert_eq!(layers.palette().pens().len(), 2, "{pens:?}");
        let right = share_on_its_pen(&layers, &strokes);
        assert!(right > 0.99, "{pens:?}: {right}");
        for stroke in &strokes {
            let whole = recall(&layers.bridged(layer(&layers, stroke.pen)).unwrap(), stroke);
            assert!(whole > 0.99, "{pens:?}, {}: {whole}", stroke.pen);
        }
    }
}

#[test]
fn pens_in_uneven_light_are_those_of_an_even_one() {
    let mut strokes = four_pens();
    strokes.push(Stroke::new(YELLOW, (12.0, 200.0), (200.0, 250.0)));
    let mut pixels = draw(260, 260, Rgb([238, 232, 220]), &strokes);
    // The light falls off to a half.
    for (at, pixel) in pixels.iter_mut().enumerate() {
        let light = 1.0 - (at % 260 + at / 260) as f64 / 1040.0;
        *pixel = pixel.map(|level| level * light);
    }
    pixels.as_flattened_mut().iter_mut().zip(noise(9)).for_each(|(level, noise)| *level += 3.0 * noise);
    let layers = Pens::Found.separate(&scan(260, &pixels)).unwrap();
    let found: Vec<&str> = layers.iter().map(|(pen, _)| pen.name.as_str()).collect();
    assert_eq!(found.len(), 5, "{found:?}");
    let right = share_on_its_pen(&layers, &strokes);
    assert!(right > 0.99, "{right}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_ruling_of_squared_paper_is_no_pen() {
    let strokes = four_pens();
    let mut pixels = draw(260, 260, Rgb::WHITE, &strokes);
    let squares = |at: usize| (at % 260) % 20 < 2 || (at / 260) % 20 < 2;
    for (at, pixel) in pixels.iter_mut().enumerate() {
        if squares(at) && *pixel == [255.0; 3] {
            *pixel = [210.0, 220.0, 233.0];
        }
    }
    let picture = scan(260, &pixels);
    for pens in [Pens::Found, Pens::Count(4)] {
        let layers = pens.separate(&picture).unwrap();
        assert_eq!((layers.palette().pens().len(), layers.ruling()), (4, Some(Rgb([210, 220, 233]))));
        let right = share_on_its_pen(&layers, &strokes);
        assert!(right > 0.99, "{right}");
    }
}

#[test]
fn ink_that_no_given_pen_draws_is_told_with_its_place_and_length() {
    let strokes =
        [Stroke::new(BLACK, (10.0, 12.0), (190.0, 30.0)), Stroke::new(PENCIL, (10.0, 82.0), (190.0, 60.0))];
    let picture = picture(200, 100, &strokes);
    let left = |pens| Vectorizer::default().vectorize_colour(&picture, &pens).unwrap().unassigned;
    let lost = left(Pens::Given(palette(&[BLACK]))).unwrap();
    assert!((178..=186).contains(&lost.length_px) && (58..=84).contains(&lost.at.y), "{lost:?}");
    assert_eq!((lost.pieces, left(Pens::Found), left(Pens::Count(2))), (1, None, None));
}

/// Ink of another size.
fn coverage_of_nothing() -> Bitmap {
    Bitmap::new(1, 1).unwrap()
}
