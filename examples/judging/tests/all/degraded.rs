//! The degraded drawings: the same for a seed on any machine, and truths that fit their pictures.

use crate::built_example;

use built_example::{Folder, complaint, run_example};
use image::GrayImage;
use plotter_judging::corpus::{Truth, all};
use plotter_judging::degraded::{Degraded, Drawn, Kind, Strength, parameter_table};
use plotter_vector::PxPoint;

/// Farthest that the ink of a stroke may lie from its place in the truth, median, px: a pixel that is counted
/// from its corner in place of its centre would be half a pixel off.
const OFF_PX: f64 = 0.1;

/// The sums of pixels of [`sample`] in each kind. A number that changes is another corpus: its tables are
/// measured anew.
const SUMS: [(Kind, u64); 14] = [
    (Kind::Clean, 0x4147_24CB_75E8_043B),
    (Kind::Pencil, 0x0D70_2AEA_43D6_2F1F),
    (Kind::Chalk, 0x96B4_0D6A_EBA1_EE2A),
    (Kind::Marker, 0x638C_5846_4A09_A166),
    (Kind::Photo, 0x8E6B_20E9_3537_615D),
    (Kind::Reflections, 0xF04F_3367_1123_81C3),
    (Kind::Squared, 0xD4BF_5567_A749_12F8),
    (Kind::Perspective, 0xAB23_8FF3_A462_035E),
    (Kind::Jpeg, 0x7B16_CBA0_3C6E_B437),
    (Kind::EnlargedNearest, 0x80BB_0415_6F60_F9AC),
    (Kind::EnlargedBicubic, 0x0083_676A_EAD4_75D4),
    (Kind::Faint, 0x4F73_FDCE_1C68_ADF2),
    (Kind::BleedThrough, 0x7AD3_C693_ED36_77FC),
    (Kind::Newsprint, 0x39B3_0ADF_2DEA_8F0D),
];

/// A picture of 400 x 300 px in place of a whole sheet.
fn sample() -> Drawn {
    let pictures = all();
    let back = pictures.iter().find(|picture| picture.name == "rect_1px").unwrap();
    let front = all().into_iter().find(|picture| picture.name == "small_marks").unwrap();
    Drawn::new(front, back)
}

fn pixels(degraded: &Degraded) -> image::DynamicImage {
    image::load_from_memory(&degraded.file).unwrap()
}

/// Fowler, Noll and Vo's hash 1a, 64 bits.
fn sum(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xCBF2_9CE4_8422_2325, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3))
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_kind_is_the_same_for_a_seed_everywhere() {
    let sample = sample();
    assert_eq!(SUMS.map(|(kind, _)| kind), Kind::ALL);
    let found = Kind::ALL.map(|kind| {
        // An odd number, so that the enlarged ones are compressed too.
        let degraded = sample.degraded(kind, Strength::Middle, 7, 3).unwrap();
        assert_eq!(degraded.truth.name, format!("{}_middle_03", kind.name()));
        (kind, sum(pixels(&degraded).as_bytes()))
    });
    assert_eq!(found, SUMS);
    let other = sample.degraded(Kind::Clean, Strength::Middle, 8, 3).unwrap();
    assert_ne!(sum(pixels(&other).as_bytes()), SUMS[0].1);
}

/// Median distance, px, of the ink from the true strokes, to the right and down.
fn median_off_px(degraded: &Degraded) -> (f64, f64) {
    let picture = pixels(degraded).into_luma8();
    let (mut right, mut down) = (Vec::new(), Vec::new());
    for pair in degraded.truth.polylines.iter().flat_map(|line| line.points.windows(2)) {
        let (dx, dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
        let long = libm::hypot(dx, dy);
        let across = (-dy / long, dx / long);
        for place in 1..60 {
            let share = f64::from(place) / 60.0;
            let at = (pair[0].0 + share * dx, pair[0].1 + share * dy);
            if let Some(off) = off_px(&picture, &degraded.truth, at, across) {
                if libm::fabs(across.0) > 0.9 {
                    right.push(off * across.0.signum());
                } else if libm::fabs(across.1) > 0.9 {
                    down.push(off * across.1.signum());
                }
            }
        }
    }
    let median = |mut values: Vec<f64>| {
        assert!(values.len() > 20, "{}: {} places are too few", degraded.truth.name, values.len());
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    (median(right), median(down))
}

/// Where the darkness about a place has its centre, along a line across the stroke, px.
fn off_px(picture: &GrayImage, truth: &Truth, at: (f64, f64), across: (f64, f64)) -> Option<f64> {
    let level = |away: f64| {
        let place = (at.0 + away * across.0, at.1 + away * across.1);
        let (x, y) = truth.view.map_or(Some(place), |view| {
            let seen = view.homography.apply(PxPoint::new(place.0, place.1))?;
            Some((seen.x, seen.y))
        })?;
        #[expect(clippy::cast_possible_truncation, reason = "places on a picture of a few hundred pixels")]
        let (x, y) = (x as f32, y as f32);
        image::imageops::interpolate_bilinear(picture, x, y).map(|pixel| f64::from(pixel.0[0]))
    };
    let steps: Vec<f64> = (-16..=16).map(|step| f64::from(step) / 2.0).collect();
    let levels: Option<Vec<f64>> = steps.iter().map(|away| level(*away)).collect();
    let levels = levels?;
    let paper = levels.iter().copied().fold(0.0, f64::max);
    let dark: Vec<f64> = levels.iter().map(|level| (paper - level - 30.0).max(0.0)).collect();
    let weight: f64 = dark.iter().sum();
    (weight > 0.0).then(|| dark.iter().zip(&steps).map(|(dark, away)| dark * away).sum::<f64>() / weight)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn ink_lies_where_the_truth_says() {
    // A grid askew: every place of a line on its pixels.
    let grid = || all().into_iter().find(|picture| picture.name == "grid_rot_w3").unwrap();
    let sheet = Drawn::new(grid(), &grid());
    for (kind, strength) in [
        (Kind::Clean, Strength::Weak),
        (Kind::Perspective, Strength::Strong),
        (Kind::EnlargedNearest, Strength::Strong),
        (Kind::EnlargedBicubic, Strength::Middle),
    ] {
        let degraded = sheet.degraded(kind, strength, 11, 0).unwrap();
        let (right, down) = median_off_px(&degraded);
        let name = &degraded.truth.name;
        println!("{name}: {right:.3} px to the right, {down:.3} px down");
        assert!(libm::fabs(right) < OFF_PX && libm::fabs(down) < OFF_PX, "{name}: ({right}, {down}) px");
        // The ink is of the same pixels as the picture, and is the undegraded drawing's.
        let picture = pixels(&degraded);
        assert_eq!(degraded.ink.dimensions(), (picture.width(), picture.height()), "{name}");
        let black = degraded.ink.pixels().filter(|pixel| pixel.0[0] == 0).count() as f64;
        let drawn: f64 = degraded
            .truth
            .polylines
            .iter()
            .flat_map(|line| line.points.windows(2).map(|pair| (pair, line.width)))
            .map(|(pair, width)| width * libm::hypot(pair[1].0 - pair[0].0, pair[1].1 - pair[0].1))
            .sum();
        // Ends add to it, crossings and a view from afar take from it.
        assert!((0.6..1.2).contains(&(black / drawn)), "{name}: {black} of {drawn} px");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_command_writes_a_picture_its_truth_and_its_ink() {
    let folder = Folder::new();
    let out = folder.file("out");
    let words = ["--seed", "3", "--drawings", "1", "--kinds", "clean,jpeg", "--strength", "weak"];
    let output = run_example("degrade_corpus", &[&[out.as_str()][..], &words].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut names: Vec<_> = std::fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let stems = ["clean_weak_00", "jpeg_weak_00"];
    let wanted = stems.map(|stem| {
        let extension = if stem.starts_with("jpeg") { "jpg" } else { "png" };
        ["ink.png", "json", extension].map(|end| format!("{stem}.{end}"))
    });
    let mut wanted = wanted.concat();
    wanted.sort();
    assert_eq!(names, wanted);
    let truth = Truth::from_json(&std::fs::read(format!("{out}/clean_weak_00.json")).unwrap()).unwrap();
    assert_eq!((truth.name.as_str(), truth.width, truth.height), ("clean_weak_00", 1000, 1400));
    assert!(!run_example("degrade_corpus", &[&out, "--kinds", "water"]).status.success());
    let file = folder.write("file", "");
    assert!(complaint("degrade_corpus", &[&file]).contains("file"));
}

#[test]
fn the_page_has_the_table_of_parameters() {
    let page = include_str!("../../README.md");
    for row in parameter_table().lines() {
        assert!(
            page.contains(row),
            "README.md lacks, or `degrade_corpus --parameters` no longer prints:\n{row}"
        );
    }
}
