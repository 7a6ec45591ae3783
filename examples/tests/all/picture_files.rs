//! What picture files say of themselves, in the tools: true size, upright, pages, a ground.

use crate::built_example;
use crate::real_files::other;

use built_example::{Folder, complaint, run_example};
use plotter_motion::{Point, hpgl};
use plotter_vector::{SvgOptions, read_svg};
use std::io::Cursor;

/// What stands in a file beside its pixels.
#[derive(Default)]
struct Beside {
    /// Pixels a metre.
    phys: Option<[u32; 2]>,
    orientation: Option<u8>,
}

/// A PNG of 8-bit grey, or grey and alpha.
fn png(width: u32, height: u32, levels: &[u8], beside: &Beside) -> Vec<u8> {
    let mut bytes = Vec::new();
    let has_alpha = levels.len() > width as usize * height as usize;
    let mut info = png::Info::with_size(width, height);
    info.color_type = if has_alpha { png::ColorType::GrayscaleAlpha } else { png::ColorType::Grayscale };
    info.bit_depth = png::BitDepth::Eight;
    info.pixel_dims =
        beside.phys.map(|[xppu, yppu]| png::PixelDimensions { xppu, yppu, unit: png::Unit::Meter });
    info.exif_metadata = beside.orientation.map(|number| {
        [&b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0"[..], &[number, 0, 0, 0, 0, 0, 0]].concat().into()
    });
    let mut writer = png::Encoder::with_info(&mut bytes, info).unwrap().write_header().unwrap();
    writer.write_image_data(levels).unwrap();
    writer.finish().unwrap();
    bytes
}

/// Levels of a frame 3 px wide on white paper, `inset` px from the rim.
fn frame(width: u32, height: u32, inset: u32) -> Vec<u8> {
    let at = |i: u32| {
        let (x, y) = (i % width, i / width);
        let inside = |by: u32| (by..width - by).contains(&x) && (by..height - by).contains(&y);
        if inside(inset) && !inside(inset + 3) { 0 } else { 255 }
    };
    (0..width * height).map(at).collect()
}

/// Width and height of what an HPGL file draws, mm.
pub(crate) fn extent_mm(plt: &str) -> [f64; 2] {
    let text = std::fs::read(plt).unwrap();
    let places: Vec<Point> = hpgl::plot_ops(&text[..])
        .filter_map(|op| op.ok()?.target())
        .filter(|at| *at != Point::ORIGIN)
        .collect();
    let span = |of: fn(&Point) -> f64| {
        let values = places.iter().map(of);
        values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
    };
    [span(|at| at.x), span(|at| at.y)]
}

/// The same in units.
fn extent(plt: &str) -> [f64; 2] {
    extent_mm(plt).map(|mm| (mm * 40.0).round())
}

/// 300 dots per inch, px a metre.
const DPI_300: [u32; 2] = [11_811, 11_811];

#[test]
fn a_hundred_millimetres_are_a_hundred_in_every_file() {
    let folder = Folder::new();
    // Between the middles of its lines 600 x 300 px: 50.8 x 25.4 mm, 2032 x 1016 units.
    let levels = frame(643, 343, 20);
    let picture =
        folder.write("a.png", png(643, 343, &levels, &Beside { phys: Some(DPI_300), orientation: None }));
    let (svg, plt, gcode, back) =
        (folder.file("a.svg"), folder.file("a.plt"), folder.file("a.gcode"), folder.file("b.plt"));
    let report = folder.trace_report(&picture, &["--svg", &svg, "--hpgl", &plt, "--gcode", &gcode]);
    assert_eq!(extent(&plt), [2032.0, 1016.0]);
    let text = std::fs::read_to_string(&svg).unwrap();
    assert!(text.contains("viewBox=\"0 0 643 343\""), "{text}");
    let read = read_svg(text.as_bytes(), &SvgOptions::default()).unwrap();
    assert!((read.width_mm - 643.0 * 25.4 / 300.0).abs() < 1e-3, "{}", read.width_mm);
    // Read back, it is as large as it was.
    assert!(run_example("convert", &[&svg, &back]).status.success());
    assert_eq!(extent(&back), [2032.0, 1016.0]);
    let gcode = std::fs::read_to_string(&gcode).unwrap();
    let xs = gcode.split_whitespace().filter_map(|word| word.strip_prefix('X')?.parse::<f64>().ok());
    let width = xs.clone().fold(f64::MIN, f64::max) - xs.fold(f64::MAX, f64::min);
    assert!((width - 50.8).abs() < 0.01, "{width}");
    assert!((report["picture"]["width_mm"].as_f64().unwrap() - 54.441).abs() < 1e-3, "{report}");
    assert!(report["assumed"][0].as_str().unwrap().contains("300 dots per inch"), "{report}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_file_is_overruled_and_what_it_says_wrongly_is_not_used() {
    let folder = Folder::new();
    let levels = frame(140, 90, 10);
    let plt = folder.file("a.plt");
    // Between the middles of the lines 117 x 67 px.
    let at = |mm_per_px: f64| [117.0, 67.0].map(|px: f64| (px * mm_per_px * 40.0).round());
    let scan = |phys| folder.write("a.png", png(140, 90, &levels, &Beside { phys, orientation: None }));
    for (phys, options, mm_per_px, said) in [
        (Some(DPI_300), &[][..], 25.4 / 300.0, "300 dots per inch (pHYs of the PNG)"),
        (Some(DPI_300), &["--dpi", "600"], 25.4 / 600.0, "as asked by --dpi"),
        (Some(DPI_300), &["--width-mm", "70"], 0.5, "as asked by --width-mm"),
        (Some(DPI_300), &["--height-mm", "45"], 0.5, "as asked by --height-mm"),
        (Some(DPI_300), &["--mm-per-px", "0.2"], 0.2, "as asked by --mm-per-px"),
        (None, &[], 0.1, "for the file says no size; give --width-mm, --height-mm, --dpi or --mm-per-px"),
        (Some([2_835; 2]), &[], 0.1, "its 72 dots per inch are those of a screen"),
        (Some([3_780; 2]), &[], 0.1, "its 96 dots per inch are those of a screen"),
        (Some([40; 2]), &[], 0.1, "its 1.02 dots per inch lie outside"),
        (Some([8_000, 3_937]), &[], 0.1, "its pixels are not square (203.2 x 100 dots per inch)"),
    ] {
        let picture = scan(phys);
        let output = run_example("trace", &[&[picture.as_str(), "--hpgl", &plt][..], options].concat());
        let table = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success() && table.contains(said), "{said}: {table}");
        assert_eq!(extent(&plt), at(mm_per_px), "{said}");
    }
    let both = run_example("trace", &["--dpi", "300", "--width-mm", "10"]);
    assert_eq!(both.status.code(), Some(2));
    for (options, remedy) in [
        (["--dpi", "0"], "scanners have 100 to 1200"),
        (["--width-mm", "-1"], "give a width above 0 mm"),
        (["--height-mm", "nan"], "give a height above 0 mm"),
    ] {
        let said = complaint("trace", &options);
        assert!(said.contains(remedy), "{said}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_was_taken_from_the_file_is_said_by_every_tool() {
    let folder = Folder::new();
    let levels = frame(140, 90, 10);
    let beside = Beside { phys: Some(DPI_300), orientation: Some(6) };
    let picture = folder.write("a.png", png(140, 90, &levels, &beside));
    let out = folder.file("out");
    for (tool, options) in [
        ("trace", &[][..]),
        ("plot", &["--out", out.as_str()]),
        ("max_error", &["--max-error-mm", "0.5"]),
        ("follow", &["--start", "45,70"]),
    ] {
        let output = run_example(tool, &[&[picture.as_str()][..], options].concat());
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success(), "{tool}: {}", String::from_utf8_lossy(&output.stderr));
        for said in ["7.62 x 11.85 mm", "300 dots per inch", "turned to the right by 90 degrees"] {
            assert!(text.contains(said), "{tool}, {said}: {text}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_machine_draws_in_true_size_as_far_as_it_reaches() {
    let folder = Folder::new();
    let levels = frame(140, 90, 10);
    let drawn = |phys, options: &[&str]| {
        let picture = folder.write("a.png", png(140, 90, &levels, &Beside { phys, orientation: None }));
        let out = folder.file("out");
        let output = run_example("plot", &[&[picture.as_str(), "--out", &out][..], options].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        (extent(&format!("{out}/drawing.hpgl")), text)
    };
    // 100 dots per inch: 117 px are 29.72 mm.
    assert_eq!(drawn(Some([3_937; 2]), &[]).0, [1189.0, 681.0]);
    let usual = drawn(None, &[]);
    assert_eq!(usual.0, [1672.0, 957.0]);
    assert!(usual.1.contains("50 mm in width, for the file says no size"), "{}", usual.1);
    assert_eq!(drawn(Some([3_937; 2]), &["--width-mm", "50"]).0, usual.0);
    let far = drawn(None, &["--width-mm", "5000"]);
    assert!(far.1.contains("for the machine is smaller"), "{}", far.1);
}

#[test]
fn pages_are_told_and_chosen() {
    let folder = Folder::new();
    let mut bytes = Cursor::new(Vec::new());
    {
        let mut encoder = tiff::encoder::TiffEncoder::new(&mut bytes).unwrap();
        for (width, inset) in [(60, 10), (80, 20)] {
            let levels = frame(width, 70, inset);
            encoder.write_image::<tiff::encoder::colortype::Gray8>(width, 70, &levels).unwrap();
        }
    }
    let picture = folder.write("a.tif", bytes.into_inner());
    let table = |options: &[&str]| {
        let output = run_example("trace", &[&[picture.as_str()], options].concat());
        String::from_utf8(output.stdout).unwrap()
    };
    let first = table(&[]);
    assert!(first.contains("60 x 70 px") && first.contains("1 of 2; --page 2 for the other"), "{first}");
    for options in [&["--page", "2"][..], &["--page", "2", "--pens", "2"]] {
        let second = table(options);
        assert!(second.contains("80 x 70 px") && second.contains("2 of 2; --page 1"), "{second}");
    }
    let none = complaint("trace", &[&picture, "--page", "3"]);
    assert!(none.contains("no page 3: the file has 2"), "{none}");
}

#[test]
fn white_lines_on_a_clear_ground_are_drawn() {
    let folder = Folder::new();
    let clear: Vec<u8> = frame(140, 90, 10).iter().flat_map(|level| [255, 255 - level]).collect();
    let dark: Vec<u8> = frame(140, 90, 10).iter().flat_map(|level| [0, 255 - level]).collect();
    for (levels, ground) in [(clear, "black"), (dark, "white")] {
        let picture = folder.write("a.png", png(140, 90, &levels, &Beside::default()));
        for options in [&[][..], &["--pens", "1"]] {
            let report = folder.trace_report(&picture, options);
            assert_eq!(report["picture"]["ground"], ground);
            assert_eq!(report["strokes"], 1, "{ground}: {report}");
        }
    }
}

#[test]
fn files_of_other_kinds_are_named_with_what_reads_them() {
    let folder = Folder::new();
    let svg = folder.write("a.png", "<?xml version=\"1.0\"?><svg xmlns=\"http://www.w3.org/2000/svg\"/>");
    for tool in ["trace", "plot", "max_error", "follow"] {
        let said = complaint(tool, &[&svg]);
        assert!(said.contains("an SVG drawing") && said.contains("`convert`"), "{tool}: {said}");
    }
    let pdf = folder.write("a.pdf", "%PDF-1.4\n");
    assert!(complaint("trace", &[&pdf]).contains("pdftoppm"));
}

/// Pictures as people have them: those of which only the file's own words make what is right.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn others_pictures_come_as_their_files_say() {
    let folder = Folder::new();
    let plt = folder.file("a.plt");
    let Some(picture) = other("cases", "pictures/dpi300.png") else { return };
    folder.trace_report(picture.to_str().unwrap(), &["--hpgl", &plt]);
    // 1181 px are 99.99 mm, and each end is rounded to a unit.
    let [width, height] = extent(&plt);
    assert!((width - 4000.0).abs() <= 1.0 && (height - 2000.0).abs() <= 1.0, "{width} x {height}");
    let of = |name: &str| {
        let picture = other("cases", &format!("pictures/{name}")).unwrap();
        folder.trace_report(picture.to_str().unwrap(), &[])
    };
    let turned = of("exif6.jpg");
    assert_eq!(turned["picture"]["orientation"], 6);
    assert_eq!([&turned["picture"]["width_px"], &turned["picture"]["height_px"]], [420, 360]);
    assert_eq!(of("two_pages.tif")["picture"]["pages"], 2);
    let clear = of("white_on_clear.png");
    assert_eq!(clear["picture"]["ground"], "black");
    assert!(clear["strokes"].as_u64().unwrap() > 0, "{clear}");
}
