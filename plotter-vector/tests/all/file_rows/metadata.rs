//! Metadata of picture files: how they are turned, how large they are, which of their pages, and
//! what is seen through them.

use super::pictures::{
    Exif, Png, Tiff, exif_segment, jfif, jpeg, jpeg_with, noise, others, webp_with, with_metadata,
};
use super::{by_rows, rows};
use plotter_vector::picture::{
    Depth, FileFormat, FileNotes, Ground, Resolution, ResolutionDoubt, ResolutionSource, RowSource,
    decode_page_in_colour,
};
use plotter_vector::{DecodeError, FileRows, decode, decode_colour};
use std::io::Cursor;

fn notes(bytes: &[u8]) -> FileNotes {
    FileNotes::read(Cursor::new(bytes), 1).unwrap()
}

/// The letter F, upright, and as each orientation stores it: 0 is ink.
const STORED: [(u32, [&str; 4]); 8] = [
    (1, ["###", "#..", "##.", "#.."]),
    (2, ["###", "..#", ".##", "..#"]),
    (3, ["..#", ".##", "..#", "###"]),
    (4, ["#..", "##.", "#..", "###"]),
    (5, ["####", "#.#.", "#...", ""]),
    (6, ["#...", "#.#.", "####", ""]),
    (7, ["...#", ".#.#", "####", ""]),
    (8, ["####", ".#.#", "...#", ""]),
];

/// The levels of a letter, each ink pixel another, so that none is taken for another one.
fn letter(rows: &[&str; 4]) -> ((u32, u32), Vec<bool>) {
    let rows: Vec<&str> = rows.iter().copied().filter(|row| !row.is_empty()).collect();
    let size = (rows[0].len(), rows.len());
    let ink = rows.concat().chars().map(|mark| mark == '#').collect();
    ((u32::try_from(size.0).unwrap(), u32::try_from(size.1).unwrap()), ink)
}

/// The letter as packed bits, 1 ink.
fn packed(width: u32, ink: &[bool]) -> Vec<u8> {
    let row =
        |row: &[bool]| row.iter().enumerate().fold(0, |byte, (x, ink)| byte | u8::from(*ink) << (7 - x));
    ink.chunks(width as usize).map(row).collect()
}

#[test]
fn every_format_is_turned_upright_in_grey_by_rows_and_in_colour() {
    let (upright_size, upright) = letter(&STORED[0].1);
    let wanted: Vec<u8> = upright.iter().map(|ink| if *ink { 0 } else { 255 }).collect();
    for (orientation, stored) in STORED {
        let (size @ (width, height), ink) = letter(&stored);
        let exif = Exif { orientation: u16::try_from(orientation).unwrap(), ..Exif::default() };
        let levels: Vec<u8> = ink.iter().map(|ink| if *ink { 0 } else { 255 }).collect();
        let rgba: Vec<u8> = levels.iter().flat_map(|level| [*level, *level, *level, 255]).collect();
        let png = |bits, colour| Png { width, height, bits, colour };
        let chunk: (&[u8; 4], &[u8]) = (b"eXIf", &exif.bytes());
        let mut webp = Cursor::new(Vec::new());
        image::RgbaImage::from_raw(width, height, rgba.clone())
            .unwrap()
            .write_to(&mut webp, image::ImageFormat::WebP)
            .unwrap();
        let white_is_zero = Tiff::strips(size, 1, 1, 0, &packed(width, &ink)).with(274, vec![orientation]);
        let grey_tiff = Tiff::strips(size, 8, 1, 1, &levels).with(274, vec![orientation]);
        let files = [
            ("png, grey", png(8, 0).file(&[chunk], &levels)),
            ("png, alpha", png(8, 6).file(&[chunk], &rgba)),
            ("png, interlaced", png(8, 0).interlaced(&[chunk], &levels)),
            ("webp", webp_with(&webp.into_inner(), size, exif)),
            ("tiff, bits", white_is_zero.clone().file()),
            ("tiff, group 4", white_is_zero.group4(width).file()),
            ("tiff, grey", grey_tiff.file()),
        ];
        for (name, bytes) in files {
            let name = format!("{name}, orientation {orientation}");
            let mut scan = FileRows::new(Cursor::new(&bytes)).unwrap();
            let said = scan.notes().clone();
            assert_eq!((said.width_px, said.height_px), upright_size, "{name}");
            assert_eq!(u32::from(said.orientation.number()), orientation, "{name}");
            assert_eq!(
                scan.depth() == Depth::Bits1,
                name.contains("bits") || name.contains("group"),
                "{name}"
            );
            for _ in 0..2 {
                let (read, error) = rows(&mut scan);
                assert_eq!((read.levels, error), (wanted.clone(), None), "{name}");
                scan.rewind().unwrap();
            }
            assert_eq!(decode(&bytes).unwrap().pixels(), wanted, "{name}");
            let colours: Vec<[u8; 3]> = wanted.iter().map(|level| [*level; 3]).collect();
            assert_eq!(decode_colour(&bytes).unwrap().pixels(), colours, "{name}");
        }
    }
}

#[test]
fn a_jpeg_is_turned_upright() {
    // Black above, white below; on its right side what orientation 6 stores.
    let stored = image::GrayImage::from_fn(16, 32, |x, _| image::Luma([if x < 8 { 0 } else { 255 }]));
    let mut bytes = Cursor::new(Vec::new());
    stored.write_to(&mut bytes, image::ImageFormat::Jpeg).unwrap();
    let exif = exif_segment(Exif { orientation: 6, ..Exif::default() });
    let bytes = jpeg_with(&bytes.into_inner(), &[exif]);
    let gray = decode(&bytes).unwrap();
    assert_eq!((gray.width(), gray.height()), (32, 16));
    let (above, below) = gray.pixels().split_at(8 * 32);
    assert!(above.iter().all(|level| *level < 20) && below.iter().all(|level| *level > 235));
    let colour = decode_colour(&bytes).unwrap();
    assert_eq!((colour.width(), colour.height()), (32, 16));
    assert!(colour.pixels()[0][0] < 20 && colour.pixels()[31 * 16][0] > 235);
}

#[test]
fn a_picture_that_is_too_large_to_be_turned_is_refused_with_the_remedy() {
    let large = Tiff::strips((40_000, 40_000), 1, 1, 0, &[0; 64]);
    assert!(FileRows::new(Cursor::new(large.file())).is_ok());
    let error = FileRows::new(Cursor::new(large.with(274, vec![3]).file())).err().unwrap();
    assert!(matches!(error, DecodeError::TurnedTooLarge(_)));
    assert!(error.to_string().contains("save it upright"), "{error}");
}

/// Dots per inch of a file and where they stand; none where it says nothing.
fn dpi(bytes: &[u8]) -> Option<([i64; 2], ResolutionSource)> {
    #[expect(clippy::cast_possible_truncation, reason = "small")]
    let whole =
        |Resolution { source, .. }: Resolution, dpi: [f64; 2]| (dpi.map(|dpi| dpi.round() as i64), source);
    notes(bytes).resolution.map(|resolution| whole(resolution, resolution.dpi()))
}

#[test]
fn each_format_says_its_resolution() {
    use ResolutionSource as From;
    let png = Png { width: 3, height: 2, bits: 8, colour: 0 };
    let with_chunk = |name: &[u8; 4], body: &[u8]| png.file(&[(name, body)], &[9; 6]);
    let phys = |across: u32, down: u32, unit: u8| {
        with_chunk(b"pHYs", &[&across.to_be_bytes()[..], &down.to_be_bytes(), &[unit]].concat())
    };
    let exif = |across, down, unit| Exif { resolution: Some(([across, down], unit)), ..Exif::default() };
    let plain_jpeg = jpeg(8, 8);
    let tiff = |across: Vec<u32>, down: Vec<u32>| {
        Tiff::strips((3, 2), 8, 1, 1, &[9; 6]).with(282, across).with(283, down)
    };
    let mut bmp = others(4, 4).swap_remove(2).1;
    bmp[38..46].copy_from_slice(&[11_811_u32.to_le_bytes(), 11_811_u32.to_le_bytes()].concat());
    let webp = others(4, 4).swap_remove(1).1;
    let cases = [
        ("png", phys(11_811, 11_811, 1), Some(([300, 300], From::PngPhys))),
        ("png, a ratio of 1", phys(1, 1, 0), None),
        ("png, a ratio of 2", phys(20_000, 10_000, 0), Some(([508, 254], From::PngPhys))),
        ("png, without", png.file(&[], &[9; 6]), None),
        (
            "png, exif",
            with_chunk(b"eXIf", &exif((600, 1), (600, 1), 2).bytes()),
            Some(([600, 600], From::Exif)),
        ),
        ("jpeg, inch", jpeg_with(&plain_jpeg, &[jfif(1, [200, 200])]), Some(([200, 200], From::Jfif))),
        ("jpeg, cm", jpeg_with(&plain_jpeg, &[jfif(2, [100, 100])]), Some(([254, 254], From::Jfif))),
        ("jpeg, a ratio", jpeg_with(&plain_jpeg, &[jfif(0, [1, 1])]), None),
        (
            "jpeg, exif",
            jpeg_with(&plain_jpeg, &[exif_segment(exif((3000, 10), (3000, 10), 2))]),
            Some(([300, 300], From::Exif)),
        ),
        (
            "jpeg, a screen's and a scanner's",
            jpeg_with(&plain_jpeg, &[jfif(1, [96, 96]), exif_segment(exif((300, 1), (300, 1), 2))]),
            Some(([300, 300], From::Exif)),
        ),
        (
            "jpeg, two scanners'",
            jpeg_with(&plain_jpeg, &[jfif(1, [150, 150]), exif_segment(exif((300, 1), (300, 1), 2))]),
            Some(([150, 150], From::Jfif)),
        ),
        ("tiff, inch by default", tiff(vec![600, 1], vec![600, 1]).file(), Some(([600, 600], From::Tiff))),
        (
            "tiff, cm",
            tiff(vec![200, 1], vec![100, 1]).with(296, vec![3]).file(),
            Some(([508, 254], From::Tiff)),
        ),
        ("tiff, no unit", tiff(vec![1, 1], vec![1, 1]).with(296, vec![1]).file(), None),
        (
            "tiff, on its side",
            tiff(vec![204, 1], vec![98, 1]).with(274, vec![6]).file(),
            Some(([98, 204], From::Tiff)),
        ),
        ("bmp", bmp, Some(([300, 300], From::Bmp))),
        ("webp", webp_with(&webp, (4, 4), exif((118, 1), (118, 1), 3)), Some(([300, 300], From::Exif))),
        ("pnm", b"P5 1 1 255\n\0".to_vec(), None),
    ];
    for (name, bytes, expected) in cases {
        assert_eq!(dpi(&bytes), expected, "{name}");
    }
}

#[test]
fn nonsense_is_said_and_not_believed() {
    let doubt = |bytes: &[u8]| notes(bytes).resolution.unwrap().mm_per_px().unwrap_err();
    let tiff = |across: [u32; 2]| {
        Tiff::strips((3, 2), 8, 1, 1, &[9; 6]).with(282, across.to_vec()).with(283, across.to_vec()).file()
    };
    assert_eq!(doubt(&tiff([0, 1])), ResolutionDoubt::NoNumber);
    assert_eq!(doubt(&tiff([1, 0])), ResolutionDoubt::NoNumber);
    assert_eq!(doubt(&tiff([0, 0])), ResolutionDoubt::NoNumber);
    assert!(matches!(doubt(&tiff([1, 1])), ResolutionDoubt::OutOfRange { .. }));
    assert!(matches!(doubt(&tiff([72, 1])), ResolutionDoubt::Screen { .. }));
    let lens = Exif { resolution: Some(([(300, 1); 2], 2)), lens: true, ..Exif::default() };
    let photo = jpeg_with(&jpeg(8, 8), &[jfif(1, [300, 300]), exif_segment(lens)]);
    assert!(matches!(doubt(&photo), ResolutionDoubt::Camera { .. }));
    // A damaged EXIF says nothing, and the picture is read.
    let mut exif = exif_segment(lens);
    exif.1.truncate(20);
    let damaged = jpeg_with(&jpeg(8, 8), &[exif]);
    assert_eq!(dpi(&damaged), None);
    assert!(decode(&damaged).is_ok());
}

#[test]
fn the_pages_of_a_tiff_are_counted_and_chosen() {
    let page = |level: u8| Tiff::strips((1, 1), 8, 1, 1, &[level]);
    let copy = page(99).with(254, vec![1]);
    let file = Tiff::pages(&[page(10), copy.clone(), page(20), page(30)]);
    for (number, level) in [(1, 10), (2, 20), (3, 30)] {
        let scan = FileRows::of_page(Cursor::new(&file), number).unwrap();
        assert_eq!((scan.notes().page, scan.notes().pages), (number, 3));
        assert_eq!(scan.into_gray().unwrap().pixels(), [level]);
        let (colour, said) = decode_page_in_colour(&file, number).unwrap();
        assert_eq!((colour.pixels(), said.page), (&[[level; 3]][..], number));
    }
    for page in [0, 4] {
        let error = FileRows::of_page(Cursor::new(&file), page).err().unwrap();
        assert_eq!(error, DecodeError::NoSuchPage { page, pages: 3 });
    }
    // A page is read again as itself.
    let mut scan = FileRows::of_page(Cursor::new(&file), 3).unwrap();
    assert_eq!(rows(&mut scan).0.levels, [30]);
    scan.rewind().unwrap();
    assert_eq!(rows(&mut scan).0.levels, [30]);
    assert_eq!(notes(&Tiff::pages(&[copy.clone(), copy])).pages, 1, "copies of nothing");
    let other = FileNotes::read(Cursor::new(b"P5 1 1 255\n\0"), 2);
    assert_eq!(other, Err(DecodeError::NoSuchPage { page: 2, pages: 1 }));
    // A last directory that is followed by the first ends the count.
    let mut endless = Tiff::pages(&[page(7), page(8)]);
    let first = usize::from(endless[4]);
    let entries = usize::from(endless[first]);
    let next = first + 2 + 12 * entries;
    let second = usize::from(endless[next]);
    endless[second + 2 + 12 * entries] = endless[4];
    assert_eq!(notes(&endless).pages, 2);
}

/// A picture of 40 x 40 px: what is drawn in its middle, and its colour; the rest is clear.
fn on_clear(drawn: [u8; 4], side: u32) -> Vec<[u8; 4]> {
    let is_in = |i: u32| (20 - side / 2..20 + side.div_ceil(2)).contains(&i);
    // Clear parts are black, as programs leave them.
    let at = |i: u32| if is_in(i % 40) && is_in(i / 40) { drawn } else { [0; 4] };
    (0..1600).map(at).collect()
}

/// The picture in each format that can be transparent, all of which mean the same.
fn clear_files(pixels: &[[u8; 4]]) -> Vec<(&'static str, Vec<u8>)> {
    let size = (40, 40);
    let png = |bits, colour| Png { width: 40, height: 40, bits, colour };
    let rgba = pixels.concat();
    let grey_alpha: Vec<u8> = pixels.iter().flat_map(|[grey, .., alpha]| [*grey, *alpha]).collect();
    let deep: Vec<u8> = rgba.iter().flat_map(|byte| [*byte; 2]).collect();
    let cover: Vec<u8> = pixels
        .iter()
        .flat_map(|[r, g, b, a]| [*r, *g, *b].map(|c| c.min(*a)).into_iter().chain([*a]))
        .collect();
    let drawn = *pixels.iter().find(|[.., alpha]| *alpha > 0).unwrap();
    let numbers: Vec<u8> = pixels.iter().map(|[.., alpha]| u8::from(*alpha > 0)).collect();
    let bits: Vec<u8> =
        numbers.chunks(8).map(|eight| eight.iter().fold(0, |byte, bit| byte << 1 | bit)).collect();
    let palette = [&[0, 0, 0][..], &drawn[..3]].concat();
    let image = |format| {
        let mut bytes = Cursor::new(Vec::new());
        let picture = image::RgbaImage::from_raw(40, 40, rgba.clone()).unwrap();
        picture.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    };
    let mut files = vec![
        ("png, rgba", png(8, 6).file(&[], &rgba)),
        ("png, rgba, interlaced", png(8, 6).interlaced(&[], &rgba)),
        ("png, rgba of 16 bits", png(16, 6).file(&[], &deep)),
        ("tiff, alpha", Tiff::strips(size, 8, 4, 2, &rgba).with(338, vec![2]).file()),
        ("tiff, cover", Tiff::strips(size, 8, 4, 2, &cover).with(338, vec![1]).file()),
        ("webp", image(image::ImageFormat::WebP)),
        ("gif", image(image::ImageFormat::Gif)),
    ];
    if drawn[..3].iter().all(|channel| *channel == drawn[0]) {
        files.push(("png, grey and alpha", png(8, 4).file(&[], &grey_alpha)));
        let mut levels: Vec<u8> = pixels.iter().map(|[grey, ..]| *grey).collect();
        levels.iter_mut().zip(&numbers).filter(|(_, drawn)| **drawn == 0).for_each(|(level, _)| *level = 77);
        files.push(("png, one grey clear", png(8, 0).file(&[(b"tRNS", &[0, 77])], &levels)));
    }
    if drawn[3] == 255 {
        let chunks: [(&[u8; 4], &[u8]); 2] = [(b"PLTE", &palette), (b"tRNS", &[0])];
        files.push(("png, palette of 8 bits", png(8, 3).file(&chunks, &numbers)));
        files.push(("png, palette of 1 bit", png(1, 3).file(&chunks, &bits)));
    }
    files
}

#[test]
fn light_lines_on_a_clear_ground_are_put_on_black_and_dark_ones_on_white() {
    for (drawn, side, ground, outside, inside) in [
        ([255, 255, 255, 255], 6, Ground::Black, 0, 255),
        ([0, 0, 0, 255], 6, Ground::White, 255, 0),
        ([60, 60, 60, 255], 30, Ground::White, 255, 60),
        ([255, 255, 255, 255], 36, Ground::Black, 0, 255),
        ([255, 255, 0, 255], 6, Ground::Black, 0, 226),
        ([255, 0, 0, 255], 6, Ground::White, 255, 76),
    ] {
        for (name, bytes) in clear_files(&on_clear(drawn, side)) {
            let name = format!("{name}, {drawn:?}");
            let scan = FileRows::new(Cursor::new(&bytes)).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(scan.notes().ground, Some(ground), "{name}");
            let levels = by_rows(&bytes).unwrap().levels;
            assert_eq!(decode(&bytes).unwrap().pixels(), levels, "{name}");
            // A GIF's palette is rounded.
            let is_near = |level: u8, wanted: u8| level.abs_diff(wanted) <= 2;
            assert!(is_near(levels[0], outside) && is_near(levels[20 * 40 + 20], inside), "{name}");
            let (colour, said) = decode_page_in_colour(&bytes, 1).unwrap();
            assert_eq!(said.ground, Some(ground), "{name}");
            assert_eq!(colour.pixels()[0], [outside; 3], "{name}");
            let middle = colour.pixels()[20 * 40 + 20];
            assert!(middle.iter().zip(drawn).all(|(a, b)| is_near(*a, b)), "{name}: {middle:?}");
        }
    }
}

#[test]
fn rims_of_light_lines_stay_between_them_and_the_ground() {
    let mut pixels = on_clear([255; 4], 6);
    pixels[20 * 40 + 10] = [255, 255, 255, 100];
    for (name, bytes) in clear_files(&pixels).into_iter().take(3) {
        let levels = decode(&bytes).unwrap();
        assert_eq!(levels.pixels()[20 * 40 + 10], 100, "{name}");
        assert_eq!(decode_colour(&bytes).unwrap().pixels()[20 * 40 + 10], [100; 3], "{name}");
    }
}

#[test]
fn what_is_solid_is_not_changed() {
    let rgba = noise(4 * 1600, 8).into_iter().enumerate();
    let rgba: Vec<u8> = rgba.map(|(i, byte)| if i % 4 == 3 { 255 } else { 200 + byte / 5 }).collect();
    let bytes = Png { width: 40, height: 40, bits: 8, colour: 6 }.file(&[], &rgba);
    let colours: Vec<[u8; 3]> = rgba.chunks(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    assert_eq!(decode_colour(&bytes).unwrap().pixels(), colours);
    let rgb = Png { width: 40, height: 40, bits: 8, colour: 2 }.file(&[], colours.as_flattened());
    assert_eq!(FileRows::new(Cursor::new(&rgb)).unwrap().notes().ground, None);
}

#[test]
fn what_moves_is_told() {
    let frames = |count: u32| {
        let mut bytes = Vec::new();
        let mut encoder = image::codecs::gif::GifEncoder::new(&mut bytes);
        for frame in 0..count {
            let level = if frame == 0 { 0 } else { 255 };
            let picture = image::RgbaImage::from_pixel(2, 1, image::Rgba([level, level, level, 255]));
            encoder.encode_frame(image::Frame::new(picture)).unwrap();
        }
        drop(encoder);
        bytes
    };
    assert!(!notes(&frames(1)).is_animated);
    assert!(notes(&frames(3)).is_animated);
    assert_eq!(decode(&frames(3)).unwrap().pixels(), [0, 0], "the first one");
}

#[test]
fn what_other_programs_read_is_named_with_the_remedy() {
    for (head, remedy) in [
        (&b"%PDF-1.7\n"[..], "pdftoppm"),
        (b"%!PS-Adobe-3.0", "pdftoppm"),
        (b"\0\0\0\x18ftypheic\0\0\0\0", "heif-convert"),
        (b"\0\0\0\x1cftypavif\0\0\0\0", "HEIC or AVIF"),
        (b"<svg width='1'/>", "`convert`"),
        (b"\xef\xbb\xbf<?xml version=\"1.0\"?>\n<!-- by hand -->\n<svg>", "`convert`"),
    ] {
        let error = decode(head).unwrap_err();
        assert!(matches!(error, DecodeError::ReadElsewhere(_)), "{error}");
        let text = error.to_string();
        assert!(text.contains(remedy) && !text.contains('\n'), "{text}");
    }
}

#[test]
fn notes_are_those_of_the_rows_but_for_the_ground() {
    for (name, bytes) in with_metadata(9, 6) {
        let rows = FileRows::new(Cursor::new(&bytes)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut read = notes(&bytes);
        read.ground = rows.notes().ground;
        // What is no number equals nothing.
        assert_eq!(format!("{read:?}"), format!("{:?}", rows.notes()), "{name}");
    }
    assert_eq!(notes(&jpeg(8, 8)).format, FileFormat::Jpeg);
}
