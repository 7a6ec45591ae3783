//! The command `trace`: what it writes, and what it says to bad input.

use crate::built_example;
use crate::real_files::other;
use plotter_vector::stroke::Pieces;

use built_example::{Folder, complaint, data, run_example, run_with_input};

#[test]
fn all_files_are_written_and_the_report_has_all_keys() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let (svg, plt, points, json, plot) =
        (file("a.svg"), file("a.plt"), file("a.txt"), file("a.json"), file("b.svg"));
    let options =
        ["--svg", &svg, "--hpgl", &plt, "--points", &points, "--report", &json, "--error-plot", &plot];
    assert!(run_example("trace", &options).status.success());
    let read = |path: &str| std::fs::read_to_string(path).unwrap();
    let report: serde_json::Value = serde_json::from_str(&read(&json)).unwrap();
    let keys = [
        "mode",
        "pens",
        "vertices",
        "strokes",
        "pen_px",
        "mean_px",
        "max_px",
        "sd_px",
        "histogram",
        "beyond_ink",
        "kept",
        "bare",
        "areas",
        "dirt",
        "pen_down_px",
        "pen_up_px",
        "time_ms",
        "peak_rss_mb",
    ];
    assert!(keys.iter().all(|key| report.get(key).is_some()), "{report}");
    let vertices = report["vertices"].as_u64().unwrap();
    assert_eq!(read(&points).lines().filter(|line| !line.is_empty()).count() as u64, vertices);
    assert!(read(&svg).contains("viewBox=\"0 0 1014 673\""));
    assert!(read(&plt).starts_with("IN;\nSP1;\nPU"));
    assert!(read(&plot).contains("distance of a pixel from its segment, px"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn arcs_reach_every_file() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let (picture, config) = (file("ring.pgm"), file("arcs.toml"));
    let level = |x: f64, y: f64| u8::from(((x - 60.0).hypot(y - 60.0) - 40.0).abs() > 1.5) * 255;
    let ring = (0..14_400_u32).map(|at| level(f64::from(at % 120) + 0.5, f64::from(at / 120) + 0.5));
    std::fs::write(&picture, [b"P5 120 120 255\n".to_vec(), ring.collect()].concat()).unwrap();
    std::fs::write(&config, "schema = 1\n[vectorize]\npieces = \"arcs\"\n").unwrap();
    for option in [&["--arcs"][..], &["--config", &config]] {
        let (svg, plt, gcode, points, look) =
            (file("a.svg"), file("a.plt"), file("a.gcode"), file("a.txt"), file("a.png"));
        let files =
            ["--svg", &svg, "--hpgl", &plt, "--gcode", &gcode, "--points", &points, "--overlay", &look];
        assert!(run_example("trace", &[&[picture.as_str()][..], option, &files].concat()).status.success());
        let read = |path: &str| std::fs::read_to_string(path).unwrap();
        assert_eq!(read(&svg).matches("<circle ").count(), 1, "{}", read(&svg));
        // 40 px are 4 mm are 160 units.
        assert!(read(&plt).contains(";\nCI160;\n"), "{}", read(&plt));
        assert_eq!(
            read(&gcode).lines().filter(|line| line.starts_with("G2 ") || line.starts_with("G3 ")).count(),
            2
        );
        assert_eq!(read(&points).lines().filter(|line| line.split(' ').count() == 3).count(), 2);
    }
    let mdraw = file("b.gcode");
    let options = [picture.as_str(), "--arcs", "--gcode", &mdraw, "--gcode-pen", "mdraw"];
    assert!(run_example("trace", &options).status.success());
    let text = std::fs::read_to_string(&mdraw).unwrap();
    assert!(
        text.contains("M1 90\nG1 ") && !text.contains("G2 ") && !text.contains("G3 ") && !text.contains("G4")
    );
    assert!(complaint("trace", &["--algorithm", "published", "--arcs"]).contains("draws straight lines"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn curves_reach_every_file() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let (picture, config) = (file("wave.pgm"), file("curves.toml"));
    // A wave 3 px wide and 40 px high.
    let level = |x: f64, y: f64| {
        let slope = 0.8 * (x / 25.0).cos();
        u8::from((y - 60.0 - 20.0 * (x / 25.0).sin()).abs() > 1.5 * slope.hypot(1.0)) * 255
    };
    let wave = (0..24_000_u32).map(|at| level(f64::from(at % 200) + 0.5, f64::from(at / 200) + 0.5));
    std::fs::write(&picture, [b"P5 200 120 255\n".to_vec(), wave.collect()].concat()).unwrap();
    std::fs::write(&config, "schema = 1\n[vectorize]\npieces = \"cubics\"\n").unwrap();
    for option in [&["--curves"][..], &["--config", &config]] {
        let (svg, plt, gcode, points, look) =
            (file("a.svg"), file("a.plt"), file("a.gcode"), file("a.txt"), file("a.png"));
        let files =
            ["--svg", &svg, "--hpgl", &plt, "--gcode", &gcode, "--points", &points, "--overlay", &look];
        assert!(run_example("trace", &[&[picture.as_str()][..], option, &files].concat()).status.success());
        let read = |path: &str| std::fs::read_to_string(path).unwrap();
        let curves = read(&svg).matches(" C").count();
        assert!((2..9).contains(&curves), "{}", read(&svg));
        assert_eq!(read(&points).lines().filter(|line| line.split(' ').count() == 6).count(), curves);
        // Chords there, of straight lines only.
        assert!(read(&plt).contains("PD") && !read(&plt).contains("AA"));
        assert!(read(&gcode).matches("\nG1 ").count() > 10 * curves && !read(&gcode).contains("G2 "));
    }
    assert!(complaint("trace", &["--algorithm", "published", "--curves"]).contains("draws straight lines"));
    let both = "'--arcs' cannot be used with '--curves'";
    let refused = run_example("trace", &[&picture, "--arcs", "--curves"]);
    assert!(!refused.status.success() && String::from_utf8_lossy(&refused.stderr).contains(both));
    std::fs::write(&config, "schema = 1\n[vectorize]\narcs = true\n").unwrap();
    assert!(
        complaint("trace", &[&picture, "--config", &config])
            .contains("unknown key `vectorize.arcs`; write `pieces = \"arcs\"` for `arcs = true`")
    );
}

#[test]
fn the_help_names_the_greatest_error_that_is_taken() {
    let help = String::from_utf8(run_example("trace", &["--help"]).stdout).unwrap();
    let default = plotter_vector::stroke::Bounded::default().tolerance_px;
    assert!(help.contains(&format!("(ours only) [default: {default}]")), "{help}");
}

#[test]
fn the_published_algorithm_refuses_a_greatest_error() {
    let said = complaint("trace", &["--algorithm", "published", "--max-error-px", "1"]);
    assert!(said.contains("has no error bound; take --algorithm ours"), "{said}");
}

#[test]
fn a_greatest_error_that_is_no_distance_is_refused() {
    for bad in ["0", "-1", "NaN", "inf"] {
        let said = complaint("trace", &[&data("flag.png"), "--max-error-px", bad]);
        assert!(said.contains("is not a positive number; 0.5 is half a pixel"), "{said}");
    }
}

#[test]
fn files_that_cannot_be_read_or_written_are_named() {
    assert!(
        complaint("trace", &["no/such/picture.png"])
            .starts_with("trace: no/such/picture.png: cannot be read")
    );
    assert!(
        complaint("trace", &[&data("flag.png"), "--svg", "/no/such/directory/a.svg"])
            .contains("a.svg: cannot be written")
    );
}

#[test]
fn bad_pictures_get_one_line_and_blank_ones_an_empty_drawing() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = directory.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let whole = std::fs::read(data("flag.png")).unwrap();
    assert!(complaint("trace", &[&file("empty.png", b"")]).contains("0 bytes"));
    assert!(
        complaint("trace", &[&file("cut.png", &whole[..whole.len() / 2])]).contains("damaged or cut off")
    );
    assert!(
        complaint("trace", &[&file("cut.pgm", b"P5 90000 90000 255\n")])
            .contains("cut off at row 1 of 90000: it ends here; no row of it is good")
    );
    let claims = "a picture of 1000000000 x 1000000000 px is too large: at most 131072 px wide and ";
    assert!(complaint("trace", &[&file("huge.pbm", b"P4 1000000000 1000000000\n")]).contains(claims));
    let folder = directory.path().to_str().unwrap();
    assert!(complaint("trace", &[folder]).contains("this is a folder: name a file in it"));
    assert!(complaint("trace", &[&data("flag.png"), "--svg", folder]).contains("cannot be written"));
    assert!(complaint("trace", &[&file("text.png", b"hello")]).contains("is not PNG"));
    for (name, blank) in [("dot", "P1 1 1\n1"), ("white", "P1 3 2\n000000"), ("black", "P1 3 2\n111111")] {
        let output = run_example("trace", &[&file(name, blank.as_bytes())]);
        assert!(output.status.success(), "{name}");
        assert!(String::from_utf8(output.stdout).unwrap().contains("(an empty sheet)"), "{name}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_file_cut_anywhere_is_told_in_one_line_and_a_wrong_suffix_does_not_matter() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("scan.jpg");
    let name = path.to_str().unwrap();
    let whole = std::fs::read(data("flag.png")).unwrap();
    for length in [1, 7, 8, 20, 33, whole.len() / 3, whole.len() - 20, whole.len() - 1] {
        std::fs::write(&path, &whole[..length]).unwrap();
        for pens in ["1", "2"] {
            let output = run_example("trace", &[name, "--pens", pens]);
            let said = String::from_utf8(output.stderr).unwrap();
            // Of the last few bytes nothing hangs.
            let is_told = output.status.code() == Some(1)
                && said.contains("scan.jpg: the picture")
                && said.lines().count() == 1;
            assert!(is_told || output.status.success() && length + 12 >= whole.len(), "{length}: {said}");
        }
    }
}

#[test]
fn a_few_bytes_that_claim_a_huge_sheet_take_little_memory() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("claims.pgm");
    std::fs::write(&path, [b"P5 60000 60000 255\n".as_slice(), &[0; 60_000]].concat()).unwrap();
    let name = path.to_str().unwrap();
    assert!(complaint("trace", &[name]).contains("cut off at row 2 of 60000"));
    assert!(
        complaint("trace", &[name, "--pens", "2"])
            .contains("take --pens 1, which is traced by rows at any size")
    );
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_pipe_that_takes_no_more_is_an_error() {
    let full = std::path::Path::new("/dev/full");
    if full.exists() {
        assert!(
            complaint("trace", &[&data("flag.png"), "--svg", "/dev/full"])
                .contains("/dev/full: cannot be written")
        );
        assert!(
            complaint("trace", &[&data("flag.png"), "--overlay", "/dev/full"])
                .contains("/dev/full: cannot be written")
        );
    }
}

#[test]
fn the_centre_of_the_lower_left_pixel_is_the_origin_of_the_plotter_file() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let (picture, plt) = (file("line.pbm"), file("line.plt"));
    std::fs::write(&picture, "P1 5 3\n1 1 1 1 1\n0 0 0 0 0\n0 0 0 0 0\n").unwrap();
    assert!(run_example("trace", &[&picture, "--hpgl", &plt]).status.success());
    let text = std::fs::read_to_string(&plt).unwrap();
    // four plotter units a pixel: four pixels to the right, two above the lowest row
    assert!(text.contains("PU0,8;\nPD16,8;\n") || text.contains("PU16,8;\nPD0,8;\n"), "{text}");
}

impl Folder {
    /// White paper, with rectangles (left, top, width, height) of these grey levels.
    fn gray(&self, (width, height): (usize, usize), marks: &[([usize; 4], u8)]) -> String {
        let mut levels = vec![255; width * height];
        for ([left, top, wide, high], level) in marks {
            (*top..top + high).for_each(|y| levels[y * width + left..y * width + left + wide].fill(*level));
        }
        self.write("gray.pgm", [format!("P5 {width} {height} 255\n").into_bytes(), levels].concat())
    }

    /// A black line across, a red one down over it.
    fn colour(&self) -> String {
        let pixel = |x: usize, y: usize| match (x, y) {
            (29..32, 5..55) => [208, 24, 24],
            (5..55, 29..32) => [0, 0, 0],
            _ => [255_u8; 3],
        };
        let pixels: Vec<u8> = (0..60).flat_map(|y| (0..60).flat_map(move |x| pixel(x, y))).collect();
        self.write("colour.ppm", [b"P6 60 60 255\n".to_vec(), pixels].concat())
    }

    pub(crate) fn trace_report(&self, picture: &str, options: &[&str]) -> serde_json::Value {
        let json = self.file("report.json");
        let output = run_example("trace", &[&[picture, "--report", &json], options].concat());
        assert!(output.status.success(), "{options:?}: {}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&std::fs::read(json).unwrap()).unwrap()
    }
}

#[test]
fn the_mode_decides_whether_a_line_is_followed_or_outlined() {
    let folder = Folder::new();
    let bar = folder.gray((60, 20), &[([10, 8, 40, 3], 0)]);
    let vertices = |mode| {
        let report = folder.trace_report(&bar, &["--mode", mode]);
        assert_eq!(report["mode"], mode);
        report["vertices"].as_u64().unwrap()
    };
    assert_eq!((vertices("centreline"), vertices("mixed")), (2, 2));
    assert!(vertices("outline") >= 5);
}

#[test]
fn outlines_lose_no_thin_line() {
    let folder = Folder::new();
    let report = folder.trace_report(&data("flag.png"), &["--mode", "outline"]);
    assert!(report["strokes"].as_u64().unwrap() > 0 && report["max_px"].as_f64().unwrap() < 1.5, "{report}");
}

#[test]
fn a_level_by_hand_decides_what_is_ink() {
    let folder = Folder::new();
    let picture = folder.gray((60, 30), &[([10, 5, 40, 3], 20), ([10, 20, 40, 3], 180)]);
    let strokes = |threshold| folder.trace_report(&picture, &["--threshold", threshold])["strokes"].clone();
    assert_eq!((strokes("100"), strokes("200")), (1.into(), 2.into()));
}

#[test]
fn a_shadow_needs_the_adaptive_threshold() {
    let folder = Folder::new();
    // Paper from 250 on the left to 111 on the right, and two lines with two thirds of its light.
    let paper = |x: usize| u8::try_from(250 - x * 140 / 256).unwrap();
    let column = |x| {
        [([x, 0, 1, 128], paper(x)), ([x, 40, 1, 3], paper(x) / 3 * 2), ([x, 80, 1, 3], paper(x) / 3 * 2)]
    };
    let marks: Vec<_> = (0..256).flat_map(column).collect();
    let picture = folder.gray((256, 128), &marks);
    let strokes = |threshold| folder.trace_report(&picture, &["--threshold", threshold])["strokes"].clone();
    assert_eq!(strokes("adaptive"), 2);
    assert_ne!(strokes("otsu"), 2);
}

#[test]
fn pens_are_told_apart_by_colour() {
    let folder = Folder::new();
    let picture = folder.colour();
    let palette = "schema = 1\n[[pen]]\nnumber = 4\nname = \"ink\"\ncolour = \"#000000\"\n[[pen]]\nnumber = 2\n\
                   colour = \"#d01818\"\n";
    let palette = folder.write("palette.toml", palette);
    let (svg, plt) = (folder.file("a.svg"), folder.file("a.plt"));
    for (pens, numbers) in [("2", [1, 2]), ("auto", [1, 2]), (palette.as_str(), [4, 2])] {
        let report = folder.trace_report(&picture, &["--pens", pens, "--svg", &svg, "--hpgl", &plt]);
        let found = report["pens"].as_array().unwrap();
        assert_eq!(found.iter().map(|pen| &pen["number"]).collect::<Vec<_>>(), numbers);
        assert_eq!(found.iter().map(|pen| &pen["strokes"]).collect::<Vec<_>>(), [1, 1], "--pens {pens}");
        assert_eq!(report["vertices"], 4);
        let svg = std::fs::read_to_string(&svg).unwrap();
        assert!(svg.contains("stroke=\"#d01818\"") && svg.contains("stroke=\"#000\""), "{svg}");
        let plt = std::fs::read_to_string(&plt).unwrap();
        assert!(numbers.iter().all(|number| plt.contains(&format!("SP{number};"))), "{plt}");
    }
    assert_eq!(folder.trace_report(&picture, &["--pens", "1"])["pens"].as_array().unwrap().len(), 1);
}

/// A line of 4 px in black ink and one of 3 px in pencil, both with soft rims, as a PPM of 400 x 200 px.
fn pencil_and_pen() -> Vec<u8> {
    let cover = |x: u32, y: u32, at: f64, width: f64| {
        if !(20..380).contains(&x) {
            return 0.0;
        }
        let middle = at + 20.0 * (f64::from(x) - 20.0) / 360.0;
        (width / 2.0 + 0.5 - (f64::from(y) - middle).abs()).clamp(0.0, 1.0)
    };
    let level = |(x, y): (u32, u32)| {
        let level = 255.0 - 229.0 * cover(x, y, 50.0, 4.0) - 95.0 * cover(x, y, 130.0, 3.0);
        // Written out as a number and read again, for there is no checked way from a fraction to a byte.
        [format!("{level:.0}").parse::<u8>().unwrap(); 3]
    };
    let levels = (0..200).flat_map(|y| (0..400).map(move |x| (x, y))).flat_map(level);
    [b"P6 400 200 255\n".to_vec(), levels.collect()].concat()
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_pencil_line_beside_ink_has_its_pen_or_is_said_to_be_left() {
    let folder = Folder::new();
    let picture = folder.write("pencil.ppm", pencil_and_pen());
    let shown = other("cases/pictures", "pencil_and_pen.png").map(|path| path.display().to_string());
    let black = folder.write("black.toml", "schema = 1\n[[pen]]\nnumber = 1\ncolour = \"#1a1a1a\"\n");
    let svg = folder.file("a.svg");
    for picture in [Some(picture), shown].into_iter().flatten() {
        for pens in ["auto", "2"] {
            let report = folder.trace_report(&picture, &["--pens", pens]);
            let strokes: Vec<_> =
                report["pens"].as_array().unwrap().iter().map(|pen| pen["strokes"].clone()).collect();
            assert_eq!(strokes, [1, 1], "{picture} --pens {pens}");
        }
        let output = run_example("trace", &[&picture, "--pens", &black, "--svg", &svg]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("no pen got 36") && said.contains("px of ink at ("), "{said}");
        assert!(std::fs::read_to_string(&svg).unwrap().contains("</svg>"), "what was traced is written");
    }
}

#[test]
fn the_best_order_travels_less_than_none() {
    let folder = Folder::new();
    let dashes: Vec<_> = (0..16).map(|i| ([10 + 80 * (i % 2), 6 + 10 * (i / 2), 12, 3], 0)).collect();
    let picture = folder.gray((120, 90), &dashes);
    let travel = |order| folder.trace_report(&picture, &["--order", order])["pen_up_px"].as_f64().unwrap();
    let (none, fast, best) = (travel("none"), travel("fast"), travel("best"));
    assert!(none > 2.0 * best && none > fast && fast >= best, "{none} {fast} {best}");
}

#[test]
fn hatching_fills_an_area_that_is_outlined_otherwise() {
    let folder = Folder::new();
    let blob = folder.gray((60, 60), &[([10, 10, 40, 40], 0)]);
    let outlined = folder.trace_report(&blob, &["--max-line-px", "8"]);
    let pen_down = |report: &serde_json::Value| report["pen_down_px"].as_f64().unwrap();
    let hatched = |options: &[&str]| {
        folder.trace_report(&blob, &[&["--max-line-px", "8", "--hatch", "0.5"], options].concat())
    };
    assert_eq!((&outlined["mode"], &hatched(&[])["mode"]), (&"centreline".into(), &"mixed".into()));
    assert_eq!(hatched(&["--mode", "centreline"])["mode"], "centreline");
    // 39 px square inside the pen's half width: lines 5 px apart are 304 px, 50 px apart one or none.
    let more = pen_down(&hatched(&[])) - pen_down(&outlined);
    assert!((200.0..500.0).contains(&more), "{more}");
    assert!(pen_down(&hatched(&["--mm-per-px", "0.01"])) - pen_down(&outlined) < 100.0);
}

#[test]
fn a_wide_pen_stays_inside_of_the_areas_it_hatches() {
    let folder = Folder::new();
    let blob = folder.gray((100, 100), &[([20, 20, 60, 60], 0)]);
    let config = folder.write(
        "pen.toml",
        "schema = 1\n[vectorize]\npen_mm = 1.0\nhatch_mm = 0.8\nmax_line_px = 8\nmode = \"mixed\"\n",
    );
    let points = folder.file("points.txt");
    for options in [&["--hatch", "0.8", "--pen-mm", "1", "--max-line-px", "8"][..], &["--config", &config]] {
        folder.trace_report(&blob, &[options, &["--points", &points]].concat());
        let text = std::fs::read_to_string(&points).unwrap();
        let places = text.split_whitespace().map(|number| number.parse::<f64>().unwrap());
        let (least, most) =
            places.fold((100.0_f64, 0.0_f64), |(least, most), at| (least.min(at), most.max(at)));
        // Half of 10 px inside of 20 and 80.
        assert!((least - 25.0).abs() < 0.6 && (most - 75.0).abs() < 0.6, "{least} {most}");
    }
    assert!(complaint("trace", &[&blob, "--pen-mm", "-1"]).contains("lies outside 0..=100 mm"));
}

#[test]
fn the_overlay_is_a_picture_four_times_as_large_in_the_pens_colours() {
    let folder = Folder::new();
    let png = folder.file("overlay.png");
    let output = run_example("trace", &[&folder.colour(), "--pens", "2", "--overlay", &png]);
    assert!(String::from_utf8(output.stdout).unwrap().contains("circled"));
    let image = image::open(&png).unwrap().to_rgb8();
    assert_eq!(image.dimensions(), (240, 240));
    assert_eq!(image.get_pixel(4, 4).0, [255; 3]);
    // On the middle of either line, away from its vertices and the crossing.
    let (red, black) = (image.get_pixel(122, 60).0, image.get_pixel(60, 122).0);
    assert!(red[0] > 150 && red[1] < 90, "{red:?}");
    assert!(black.iter().all(|level| *level < 90), "{black:?}");
    let bar = folder.gray((60, 20), &[([10, 8, 40, 3], 0)]);
    let output = run_example("trace", &[&bar, "--overlay", &png, "--no-errors"]);
    assert!(String::from_utf8(output.stdout).unwrap().contains("no pixel: --no-errors leaves out"));
    let output = run_example("trace", &[&bar, "--overlay", &png]);
    assert!(output.status.success());
    assert_eq!(image::open(&png).unwrap().to_rgb8().dimensions(), (240, 80));
}

#[test]
fn the_machines_file_is_asked_and_an_option_wins_over_it() {
    let folder = Folder::new();
    let bar = folder.gray((60, 30), &[([10, 5, 40, 3], 20), ([10, 20, 40, 3], 180)]);
    let file = folder.write(
        "machine.toml",
        "schema = 1\n[vectorize]\nmode = \"outline\"\nthreshold = \"100\"\nmax_error_px = 0.6\n",
    );
    let report = folder.trace_report(&bar, &["--config", &file]);
    assert_eq!((&report["mode"], &report["strokes"]), (&"outline".into(), &1.into()));
    let report =
        folder.trace_report(&bar, &["--config", &file, "--mode", "centreline", "--threshold", "200"]);
    assert_eq!((&report["mode"], &report["strokes"]), (&"centreline".into(), &2.into()));
    let pens = folder.write("pens.toml", "schema = 1\nvectorize.pens = 2\n");
    let colours = |options: &[&str]| {
        let report = folder.trace_report(&folder.colour(), &[&["--config", pens.as_str()], options].concat());
        report["pens"].as_array().unwrap().len()
    };
    assert_eq!((colours(&[]), colours(&["--pens", "1"])), (2, 1));
    let found = folder.write("auto.toml", "schema = 1\nvectorize.pens = \"auto\"\n");
    let named = |config: &str| folder.trace_report(&folder.colour(), &["--config", config])["pens"].clone();
    assert!(named(&found).as_array().unwrap().len() > 1);
    let palette = folder
        .write("palette.toml", "schema = 1\n[[pen]]\nnumber = 7\nname = \"fine\"\ncolour = \"#d01818\"\n");
    let look = folder.file("look.png");
    let text = format!("schema = 1\n[vectorize]\npens = {palette:?}\nthreads = 2\noverlay = {look:?}\n");
    let given = folder.write("given.toml", text);
    assert_eq!(named(&given)[0]["number"], 7);
    assert!(std::fs::exists(&look).unwrap());
    let missing = folder.write("missing.toml", "schema = 1\nvectorize.pens = \"no/such.toml\"\n");
    let said = complaint("trace", &[&bar, "--config", &missing]);
    assert!(said.contains("vectorize.pens: no/such.toml: cannot be read"), "{said}");
    let said = complaint("trace", &[&bar, "--max-error-px", "1e9"]);
    assert!(said.contains("lies outside 0.01..=100 px"), "{said}");
    let slip = folder.write("slip.toml", "schema = 1\n[vectorize]\nmode = \"outlines\"\n");
    let said = complaint("trace", &[&bar, "--config", &slip]);
    assert!(said.contains("slip.toml: line 3, column 8: vectorize.mode"), "{said}");
    assert!(said.contains("did you mean \"outline\"?"), "{said}");
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let folder = Folder::new();
    let strokes = |threads| {
        let points = folder.file("points.txt");
        assert!(run_example("trace", &["--threads", threads, "--points", &points]).status.success());
        std::fs::read(points).unwrap()
    };
    assert_eq!(strokes("1"), strokes("3"));
}

#[test]
fn bad_values_get_one_line_with_a_remedy() {
    let flag = data("flag.png");
    let said = [
        (
            ["--threshold", "300"],
            "--threshold: 300 is neither auto, otsu, adaptive nor a level from 0 to 255",
        ),
        (["--pens", "0"], "--pens: 0 pens cannot be found: ask for 1 to 16, or auto"),
        (["--pens", "-3"], "--pens: -3 pens cannot be found: ask for 1 to 16, or auto"),
        (["--pens", "missing.toml"], "give 1 to 16, auto, or a palette's TOML file"),
        (["--hatch", "-1"], "--hatch: -1 mm is no distance; give a pen's width, as 0.5, or 0 for none"),
        (["--hatch", "0.01"], "hatching: 0.01 mm are 0.100 px of 0.1 mm; give 0.05 mm or more"),
        (["--threads", "0"], "--threads: 0 lies outside 1..=1024; leave it out for one a core"),
        (["--max-line-px", "-1"], "--max-line-px: -1 px lies outside 0..=512 px; 0 finds it"),
        (["--mm-per-px", "0"], "--mm-per-px: 0 mm is not a positive number; 0.1 gives"),
        (["--config", "missing.toml"], "missing.toml: cannot be read"),
    ];
    for (options, expected) in said {
        let said = complaint("trace", &[&flag, options[0], options[1]]);
        assert!(said.contains(expected), "{said}");
    }
    let said = complaint("trace", &[&flag, "--pens", "2", "--threshold", "otsu"]);
    assert!(said.contains("leave it out, or take --pens 1"), "{said}");
}

#[test]
fn the_published_algorithm_refuses_what_only_ours_has() {
    let ours = [
        ["--mode", "outline"],
        ["--pens", "2"],
        ["--order", "none"],
        ["--hatch", "1"],
        ["--max-line-px", "9"],
    ];
    for [option, value] in ours {
        let said = complaint("trace", &["--algorithm", "published", option, value]);
        assert!(said.contains(&format!("{option}: the published algorithm")), "{said}");
        assert!(said.contains("take --algorithm ours, or leave the option out"), "{said}");
    }
    let folder = Folder::new();
    let picture = folder.gray((60, 30), &[([10, 5, 40, 1], 20), ([10, 20, 40, 1], 180)]);
    let report = folder.trace_report(&picture, &["--algorithm", "published", "--threshold", "100"]);
    assert_eq!((&report["mode"], &report["strokes"]), (&serde_json::Value::Null, &1.into()));
}

/// A PBM with this byte everywhere, eight pixels wide at a time.
fn pbm(width: usize, height: usize, byte: impl Fn(usize, usize) -> u8) -> Vec<u8> {
    let mut file = format!("P4 {width} {height}\n").into_bytes();
    let byte = &byte;
    file.extend((0..height).flat_map(|y| (0..width.div_ceil(8)).map(move |x| byte(x, y))));
    file
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_sheet_that_cannot_be_held_is_traced_by_rows() {
    let folder = Folder::new();
    // More than the 2²⁸ px of a picture in memory: a frame 8 px wide, black on white and the other way round.
    let (width, height) = (8192, 33_000);
    let frame = |x, y| {
        let inside = (101..923).contains(&x) && (1008..31_992).contains(&y);
        let outside = !(100..924).contains(&x) || !(1000..32_000).contains(&y);
        if inside || outside { 0 } else { 0xff_u8 }
    };
    let dark = folder.write("dark.pbm", pbm(width, height, frame));
    let svg = folder.file("a.svg");
    let plt = folder.file("a.plt");
    let report = folder.trace_report(&dark, &["--svg", &svg, "--hpgl", &plt]);
    assert_eq!((&report["strokes"], &report["pen_px"]), (&1.into(), &8.into()));
    let most_mb = report["peak_rss_mb"].as_f64().unwrap_or(0.0);
    assert!(most_mb < 120.0, "{most_mb} MB where the levels of the whole are 270");
    let strokes = std::fs::read(&svg).unwrap();
    let light = folder.write("light.pbm", pbm(width, height, |x, y| !frame(x, y)));
    let report = folder.trace_report(&light, &["--svg", &svg, "--no-errors"]);
    assert_eq!(std::fs::read(&svg).unwrap(), strokes);
    assert!(report["max_px"].is_null() && report["histogram"].is_null(), "{report}");
    let said = complaint("trace", &[&dark, "--pens", "2"]);
    assert!(
        said.contains("--pens: colours are told apart on the whole picture, but a picture of 8192 x"),
        "{said}"
    );
    assert!(said.contains("or take --pens 1, which is traced by rows at any size"), "{said}");
    let said = complaint("trace", &[&dark, "--algorithm", "published"]);
    assert!(said.contains("the published algorithm needs the whole sheet: a picture of 8192 x"), "{said}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_overlay_of_a_long_sheet_shows_its_worst_place() {
    let folder = Folder::new();
    // Longer than an overlay may be: every second row and column is shown.
    let line = |x, y| if x == 30 && (500..8500).contains(&y) { 0xff } else { 0 };
    let sheet = folder.write("long.pbm", pbm(400, 9000, line));
    let png = folder.file("look.png");
    let output = run_example("trace", &[&sheet, "--overlay", &png]);
    let said = String::from_utf8(output.stdout).unwrap();
    // The corners of the line's lower end lie farthest: it is drawn a quarter of a pixel less far.
    assert!(said.contains("circled") && said.contains("at 240, 8499"), "{said}");
    let image = image::open(&png).unwrap().to_rgb8();
    assert_eq!(image.dimensions(), (200, 4500));
    // The line is red in its middle; the ring is magenta beside the corner, at (120, 4249).
    let [red, green, _] = image.get_pixel(122, 2000).0;
    assert!(red > 150 && green < 100, "{:?}", image.get_pixel(122, 2000));
    let is_ring = |x| matches!(image.get_pixel(x, 4249).0, [200..=255, 0..=90, 150..=255]);
    assert!((125..140).any(is_ring), "{:?}", image.get_pixel(131, 4249));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn by_rows_and_whole_are_the_same_bytes() {
    let folder = Folder::new();
    let names = ["flag.png", "technical.png"].map(data);
    let inverted = |name: &str| {
        let mut picture = image::open(name).unwrap().to_luma8();
        picture.iter_mut().for_each(|level| *level = !*level);
        let path = folder.file("inverted.pgm");
        picture.save(&path).unwrap();
        path
    };
    for picture in [&names[0], &names[1], &inverted(&names[1])] {
        let whole = plotter_vector::decode(&std::fs::read(picture).unwrap()).unwrap();
        for (pieces, option) in [(Pieces::Lines, &[][..]), (Pieces::Arcs, &["--arcs"])] {
            let vectorizer =
                plotter_vector::Vectorizer::from(plotter_vector::Ours::default().with_pieces(pieces));
            let whole = vectorizer.vectorize(&whole).unwrap();
            let mut expected = String::new();
            let palette = plotter_vector::Palette::default();
            plotter_vector::write::svg_in_colour(&whole.drawing, &palette, Some(0.1), 1.0, &mut expected)
                .unwrap();
            let svg = folder.file("a.svg");
            let report = folder.trace_report(picture, &[&["--svg", svg.as_str()][..], option].concat());
            assert_eq!(std::fs::read_to_string(&svg).unwrap(), expected, "{picture}");
            assert_eq!(report["mean_px"].as_f64(), Some(whole.error.mean_px), "{picture}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn odd_pictures_are_drawn() {
    let folder = Folder::new();
    let strokes =
        |name: &str, bytes: &[u8]| folder.trace_report(&folder.write(name, bytes), &[])["strokes"].clone();
    // The suffix does not count; a narrow picture is one line; what is black or white all over is empty.
    assert_eq!(strokes("really.jpg", b"P1 5 3\n00000 11111 00000\n"), 1);
    assert_eq!(strokes("tall.pbm", &pbm(1, 100_000, |_, y| if y < 40_000 { 0x80 } else { 0 })), 1);
    assert_eq!(strokes("wide.pbm", &pbm(100_000, 1, |x, _| if x < 5000 { 0xff } else { 0 })), 1);
    // More than 2²⁸ px.
    assert_eq!(strokes("black.pbm", &pbm(32_768, 10_000, |_, _| 0xff)), 0);
    assert_eq!(strokes("white.pbm", &pbm(32_768, 10_000, |_, _| 0)), 0);
    let output = run_example("trace", &["--no-errors", "--error-plot", "a.svg"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("'--no-errors' cannot be used with '--error-plot"), "{said}");
}

#[test]
#[cfg(unix)]
fn a_pipe_is_read_as_a_file() {
    let flag = std::fs::File::open(data("flag.png")).unwrap();
    let mut cat =
        std::process::Command::new("cat").stdin(flag).stdout(std::process::Stdio::piped()).spawn().unwrap();
    let pipe = cat.stdout.take().unwrap();
    let output = run_with_input("trace", &["/dev/stdin"], pipe);
    assert!(cat.wait().unwrap().success());
    assert!(String::from_utf8(output.stdout).unwrap().starts_with("/dev/stdin: 1014 x 673 px\n"));
}

#[test]
fn the_standard_input_is_read_and_the_standard_output_written() {
    let folder = Folder::new();
    let picture = folder.gray((60, 30), &[([10, 5, 40, 3], 20), ([10, 20, 40, 3], 180)]);
    let piped = |options: &[&str]| {
        let file = std::fs::File::open(&picture).unwrap();
        let output = run_with_input("trace", &[&["-"], options].concat(), file);
        let (out, said) = (output.stdout, String::from_utf8(output.stderr).unwrap());
        assert!(output.status.success(), "{said}");
        (String::from_utf8_lossy(&out).into_owned(), said)
    };
    assert!(piped(&[]).0.starts_with("standard input: 60 x 30 px\n"));
    assert!(piped(&["--pens", "2"]).0.starts_with("standard input: 60 x 30 px\n"));
    for (option, begins) in [
        ("--svg", "<svg"),
        ("--hpgl", "IN;\nSP1;"),
        ("--gcode", "G21"),
        ("--points", "1"),
        ("--report", "{\n"),
        ("--error-plot", "<svg"),
        ("--overlay", "\u{fffd}PNG"),
    ] {
        let (out, said) = piped(&[option, "-"]);
        assert!(out.starts_with(begins), "{option}: {out}");
        // The figures go where they do not disturb.
        assert!(
            !out.contains("px\n  line width") && said.starts_with("standard input: 60 x 30 px\n"),
            "{said}"
        );
        let path = folder.file("a.out");
        assert!(run_example("trace", &[&picture, option, &path]).status.success());
        let file = std::fs::read(&path).unwrap();
        let same = String::from_utf8_lossy(&file) == out;
        // Name and time are of that run.
        assert!(same || ["--report", "--error-plot"].contains(&option), "{option}");
    }
    assert!(!std::path::Path::new("-").exists());
    let said = complaint("trace", &[&picture, "--svg", "-", "--hpgl", "-"]);
    assert!(said.contains("--svg and --hpgl: one file at most can go to the standard output"), "{said}");
    let nothing = run_with_input("trace", &["-"], std::process::Stdio::null());
    let said = String::from_utf8(nothing.stderr).unwrap();
    assert!(said.starts_with("trace: standard input: the picture is empty (0 bytes)"), "{said}");
}

#[test]
fn pixels_too_small_for_the_plotter_are_refused_or_told() {
    let folder = Folder::new();
    let picture = folder.gray((60, 30), &[([10, 5, 40, 3], 20)]);
    let plt = folder.file("a.plt");
    for option in ["--hpgl", "--gcode"] {
        let said = complaint("trace", &[&picture, "--mm-per-px", "1e-30", option, &plt]);
        assert!(
            said.contains("--mm-per-px: with 0.000000000000000000000000000001 mm the whole drawing is"),
            "{said}"
        );
        assert!(said.contains(&format!("that {option} tells apart; 0.1 gives")), "{said}");
        assert!(!std::path::Path::new(&plt).exists());
    }
    let said = |options: &[&str]| {
        let output = run_example("trace", &[&[picture.as_str()], options].concat());
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    let coarse = said(&["--mm-per-px", "0.001", "--hpgl", &plt]);
    assert!(
        coarse.contains("warning: --mm-per-px: with 0.001 mm the 0.025 mm that --hpgl tells apart are 25 px"),
        "{coarse}"
    );
    assert_eq!(said(&["--mm-per-px", "0.01", "--hpgl", &plt]), "");
    // In pixels it does not matter, and a dot is one at any size.
    assert_eq!(said(&["--mm-per-px", "1e-30", "--svg", &plt]), "");
    let dot = folder.gray((20, 20), &[([9, 9, 2, 2], 0)]);
    let output = run_example("trace", &[&dot, "--mm-per-px", "0.001", "--hpgl", &plt]);
    assert!(output.status.success() && output.stderr.is_empty());
}

/// Ctrl-C comes while the picture is still on its way through a pipe, so that no clock decides what is met.
#[cfg(target_os = "linux")]
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn ctrl_c_stops_it_and_nothing_is_written() {
    use std::io::{Read as _, Write as _};
    use std::process::{Command, Stdio};
    use std::time::Duration;
    /// Of the signals in `/proc`'s mask: SIGINT is the second.
    const SIGINT_BIT: u64 = 1 << 1;

    let directory = tempfile::tempdir().unwrap();
    let svg = directory.path().join("a.svg");
    let test = std::env::current_exe().unwrap();
    let built = test.parent().and_then(std::path::Path::parent).unwrap().join("examples/trace");
    let mut child = Command::new(built)
        .args(["-", "--svg", svg.to_str().unwrap()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    input.write_all(b"P1 8 6\n00000000\n01111110\n").unwrap();
    let status = format!("/proc/{}/status", child.id());
    let waits = || {
        let text = std::fs::read_to_string(&status).unwrap();
        let mask = text.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap().trim().to_owned();
        u64::from_str_radix(&mask, 16).unwrap() & SIGINT_BIT != 0
    };
    while !waits() {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    // The handler has a thread of its own.
    std::thread::sleep(Duration::from_millis(200));
    input.write_all(b"01000010\n01000010\n01111110\n00000000\n").unwrap();
    drop(input);
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{said}");
    assert!(said.contains("standard input: stopped; nothing is written"), "{said}");
    assert!(!svg.exists());
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn dirt_that_is_left_out_is_told() {
    let folder = Folder::new();
    // A frame 8 px wide, and nine dots of 5 x 5 px.
    let is_ink = |x: u32, y: u32| {
        let frame = (20..180).contains(&x)
            && (20..180).contains(&y)
            && !((28..172).contains(&x) && (28..172).contains(&y));
        let dot = |v: u32| (60..65).contains(&v) || (90..95).contains(&v) || (120..125).contains(&v);
        frame || dot(x) && dot(y)
    };
    let levels = (0..200).flat_map(|y| (0..200).map(move |x| if is_ink(x, y) { 0 } else { 255 }));
    let picture = folder.write("frame.pgm", [b"P5 200 200 255\n".to_vec(), levels.collect()].concat());
    let report = folder.trace_report(&picture, &[]);
    assert_eq!((&report["dirt"]["marks"], &report["dirt"]["px"]), (&9.into(), &225.into()));
    assert_eq!((&report["dirt"]["largest_px"], &report["kept"]), (&25.into(), &false.into()));
    let said = String::from_utf8(run_example("trace", &[&picture]).stdout).unwrap();
    assert!(said.contains("9 marks left out"), "{said}");
    let plan = ["--max-error-mm", "1", "--width-mm", "40"];
    let output = run_example("max_error", &[&[picture.as_str()][..], &plan].concat());
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("9 marks are left out, 225 px of ink (the largest 25 px)"), "{said}");
    let output = run_example("max_error", &[&[picture.as_str(), "--allow-dirt"][..], &plan].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn ink_inside_of_areas_that_is_left_out_is_told_by_every_tool() {
    let folder = Folder::new();
    // A square of 100 px, and a line 4 px wide.
    let is_ink = |x: u32, y: u32| {
        (20..120).contains(&x) && (20..120).contains(&y) || (20..280).contains(&x) && (150..154).contains(&y)
    };
    let levels = (0..200).flat_map(|y| (0..300).map(move |x| if is_ink(x, y) { 0 } else { 255 }));
    let picture = folder.write("area.pgm", [b"P5 300 200 255\n".to_vec(), levels.collect()].concat());
    let report = folder.trace_report(&picture, &[]);
    assert_eq!((&report["areas"]["number"], &report["kept"]), (&1.into(), &false.into()), "{report}");
    let told = report["areas"]["pixels"].as_u64().unwrap();
    assert!((8_000..10_000).contains(&told), "{told} px");
    assert_eq!(report["areas"]["largest"][0]["pixels"], told);
    let said = String::from_utf8(run_example("trace", &[&picture]).stdout).unwrap();
    assert!(
        said.contains(&format!("inside of areas not drawn: {told} px, the largest {told} px at (2")),
        "{said}"
    );
    let out = folder.file("plot");
    assert!(run_example("plot", &[&picture, "--out", &out]).status.success());
    let plotted: serde_json::Value =
        serde_json::from_slice(&std::fs::read(format!("{out}/report.json")).unwrap()).unwrap();
    assert_eq!((&plotted["areas"]["number"], &plotted["kept"]), (&1.into(), &false.into()), "{plotted}");
    let page = std::fs::read_to_string(format!("{out}/report.html")).unwrap();
    assert!(page.contains("inside of areas not drawn"), "{page}");
    // Its error is measured against all ink: the middle of the square is 50 px from what is drawn.
    let plan = ["--max-error-mm", "1", "--width-mm", "40"];
    let output = run_example("max_error", &[&[picture.as_str()][..], &plan].concat());
    let said =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    // Hatched without gaps there is nothing to tell.
    let hatched = folder.trace_report(&picture, &["--width-mm", "300", "--hatch", "2", "--pen-mm", "2"]);
    assert_eq!(hatched["areas"]["number"], 0, "{hatched}");
}

#[test]
fn spots_that_are_farther_off_than_promised_are_told_with_their_places() {
    let folder = Folder::new();
    // A square end of a line 12 px wide: a round pen leaves its corners bare.
    let is_ink = |x: u32, y: u32| (40..260).contains(&x) && (90..102).contains(&y);
    let levels = (0..200).flat_map(|y| (0..300).map(move |x| if is_ink(x, y) { 0 } else { 255 }));
    let picture = folder.write("end.pgm", [b"P5 300 200 255\n".to_vec(), levels.collect()].concat());
    let report = folder.trace_report(&picture, &["--prefer", "strokes"]);
    assert_eq!((&report["bare"]["number"], &report["kept"]), (&4.into(), &false.into()), "{report}");
    for spot in report["bare"]["largest"].as_array().unwrap() {
        let at = |end: &str, axis: &str| spot[end][axis].as_u64().unwrap();
        assert!(at("from", "x") == 40 || at("to", "x") == 259, "{spot}");
        assert!(at("from", "y") == 90 || at("to", "y") == 101, "{spot}");
        assert!(spot["max_px"].as_f64().unwrap() > 0.5, "{spot}");
    }
    let said = String::from_utf8(run_example("trace", &[&picture, "--prefer", "strokes"]).stdout).unwrap();
    assert!(said.contains("spots farther off than promised"), "{said}");
}
