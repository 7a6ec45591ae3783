//! Damaged, odd and hostile files give a clear error or a picture, never a panic.

use super::pictures::{Png, Tiff, every_kind, jpeg, noise, zlib};
use super::{by_rows, rows};
use plotter_vector::{DecodeError, FileRows, Vectorizer, decode, picture::RowSource};
use std::io::Cursor;

/// Asserts what every message must be: one line, not empty, not ending in a full stop.
fn assert_readable(error: &DecodeError) {
    let text = error.to_string();
    assert!(!text.is_empty() && !text.contains('\n') && !text.ends_with('.'), "{text:?}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_picture_cut_off_anywhere_keeps_the_rows_before() {
    for (name, bytes) in every_kind(11, 7) {
        let whole = by_rows(&bytes).unwrap();
        // The last number of a text, cut off, is a number too.
        let text = name.starts_with("P2") || name.starts_with("P3");
        for length in 0..bytes.len() - if text { 6 } else { 0 } {
            let cut = &bytes[..length];
            match FileRows::new(Cursor::new(cut)) {
                Err(error) => assert_readable(&error),
                Ok(mut scan) => {
                    let (read, error) = rows(&mut scan);
                    let sure = &read.levels[..read.levels.len().saturating_sub(usize::from(text))];
                    assert!(whole.levels.starts_with(sure), "{name}, {length} bytes");
                    if let Some(error) = &error {
                        assert_readable(error);
                        assert_eq!(scan.next_row(), Err(error.clone()), "{name}, {length} bytes");
                    } else {
                        assert_eq!(read, whole, "{name}, {length} bytes");
                    }
                }
            }
            match decode(cut) {
                Err(error) => assert_readable(&error),
                Ok(gray) => assert_eq!(gray.pixels(), whole.levels, "{name}, {length} bytes"),
            }
        }
    }
}

#[test]
fn the_row_of_the_damage_is_named() {
    let bytes = b"P5 2 3 255\n\x01\x02\x03\x04\x05";
    let mut scan = FileRows::new(Cursor::new(bytes)).unwrap();
    let (read, error) = rows(&mut scan);
    assert_eq!(read.levels, [1, 2, 3, 4]);
    assert_eq!(error, Some(DecodeError::DamagedRow { row: 2, rows: 3, what: "it ends here".into() }));
    scan.rewind().unwrap();
    assert!(scan.next_row().is_ok());
}

#[test]
fn a_wrong_checksum_of_a_png_is_an_error_behind_the_last_row() {
    let mut bytes = Png { width: 5, height: 4, bits: 8, colour: 0 }.of_noise(false, false);
    let checksum = bytes.len() - 12 - 4;
    bytes[checksum] ^= 1;
    let (read, error) = rows(&mut FileRows::new(Cursor::new(&bytes)).unwrap());
    assert_eq!(read.levels.len(), 20);
    assert!(matches!(error, Some(DecodeError::DamagedRow { row: 4, rows: 4, .. })), "{error:?}");
    assert!(decode(&bytes).is_err());
}

#[test]
fn nothing_and_something_else_are_told_apart() {
    assert_eq!(decode(b""), Err(DecodeError::Empty));
    assert_eq!(FileRows::new(Cursor::new(b"")).err(), Some(DecodeError::Empty));
    for other in [
        &b"GIF"[..],
        b"P",
        b"P8 1 1",
        b"RIFF\0\0\0\0WAVE",
        b"II",
        b"<html></html>",
        b"\0\0\0\0\0\0\0\0\0\0\0\0",
    ] {
        let error = decode(other).unwrap_err();
        assert!(matches!(error, DecodeError::UnknownFormat { .. }), "{error}");
    }
    for cut_off in [&b"GIF89a\x01\0\x01\0"[..], b"BM", b"RIFF\0\0\0\0WEBP"] {
        let error = decode(cut_off).unwrap_err();
        assert!(matches!(error, DecodeError::Damaged { .. }), "{error}");
    }
}

#[test]
fn a_file_is_told_from_its_bytes_and_not_from_its_name() {
    let folder = std::env::temp_dir().join(format!("plotter-vector-scan-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("drawing.png");
    std::fs::write(&path, b"P4 3 1\n\xa0").unwrap();
    let (read, error) = rows(&mut FileRows::open(&path).unwrap());
    assert_eq!((read.levels, error), (vec![0, 255, 0], None));
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(matches!(FileRows::open(&path), Err(DecodeError::Unreadable { .. })));
    assert!(matches!(FileRows::open(std::env::temp_dir()), Err(DecodeError::Unreadable { .. })));
}

#[test]
fn sizes_beyond_the_limit_are_refused_from_the_header() {
    let png = |width, height| Png { width, height, bits: 1, colour: 0 }.file_of(0, &[], &zlib(&[0; 64]));
    let tiff = |width, height| Tiff::strips((width, height), 1, 1, 0, &[0; 64]).file();
    let huge = [
        png(131_073, 1),
        png(1, 4_194_305),
        png(0x7fff_ffff, 0x7fff_ffff),
        tiff(131_073, 1),
        tiff(u32::MAX, u32::MAX),
        b"P4 131073 1\n".to_vec(),
        b"P5 4294967295 4294967295 65535\n".to_vec(),
    ];
    for bytes in huge {
        let error = decode(&bytes).unwrap_err();
        assert!(matches!(error, DecodeError::TooLong { .. } | DecodeError::Damaged { .. }), "{error}");
        assert!(FileRows::new(Cursor::new(&bytes)).is_err());
    }
    // A0 at 1200 dots per inch is read by rows, but not held whole.
    for bytes in [png(39_732, 56_173), tiff(39_732, 56_173), b"P4 39732 56173\n\0".to_vec()] {
        assert!(matches!(decode(&bytes), Err(DecodeError::TooLarge(_))));
        let scan = FileRows::new(Cursor::new(&bytes)).unwrap();
        assert_eq!((scan.width(), scan.height()), (39_732, 56_173));
    }
}

#[test]
fn a_large_jpeg_of_few_bytes_is_refused_before_it_is_decoded() {
    let mut bytes = jpeg(8, 8);
    let frame = bytes.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    bytes[frame + 5..frame + 9].fill(0xff); // height and width: 65535 each
    assert!(matches!(decode(&bytes), Err(DecodeError::TooLarge(_))));
    assert!(FileRows::new(Cursor::new(&bytes)).is_err());
}

#[test]
fn a_header_that_promises_more_than_the_file_has_is_damage() {
    // 16384 x 16384 px, the largest that is held whole, of which nothing is there.
    for bytes in [
        Png { width: 16384, height: 16384, bits: 16, colour: 6 }.file_of(0, &[], &zlib(&[0; 64])),
        Tiff::strips((16384, 16384), 16, 4, 2, &[0; 64]).file(),
        b"P6 16384 16384 65535\n".to_vec(),
        b"P3 16384 16384 65535\n".to_vec(),
        b"P1 16384 16384\n".to_vec(),
    ] {
        assert!(matches!(decode(&bytes), Err(DecodeError::DamagedRow { row: 0, .. })));
    }
}

#[test]
fn kinds_of_tiff_that_are_not_read_are_named() {
    let plain = Tiff::strips((8, 1), 8, 1, 1, &[0; 8]);
    let cases = [
        ("CCITT group 3", plain.clone().with(259, vec![3])),
        ("JPEG", plain.clone().with(259, vec![7])),
        ("Zstandard", plain.clone().with(259, vec![50000])),
        ("not whole", plain.clone().with(339, vec![3])),
        ("4 samples of 8 bits", Tiff::strips((2, 1), 8, 4, 5, &[0; 8])),
        ("a plane for each colour", Tiff::strips((8, 1), 8, 3, 2, &[0; 24]).with(284, vec![2]).cut(8, 1)),
        ("predictor 3", plain.clone().with(317, vec![3]).compressed(5)),
    ];
    for (name, tiff) in cases {
        let error = decode(&tiff.file()).unwrap_err();
        assert!(error.to_string().contains(name), "{name}: {error}");
        assert!(matches!(error, DecodeError::Unsupported { .. }), "{error}");
    }
}

#[test]
fn tiles_that_would_take_much_memory_are_refused() {
    let wide = Tiff::strips((100_000, 100_000), 8, 3, 2, &[0; 24]);
    let tiles = Tiff { tiled: true, blocks: vec![Vec::new(); 4], ..wide };
    let tiles = tiles.with(322, vec![50_000]).with(323, vec![50_000]);
    let error = FileRows::new(Cursor::new(tiles.file())).err().unwrap();
    assert!(error.to_string().contains("of tiles 50000 px high"), "{error}");
    let tiny = Tiff { tiled: true, ..Tiff::strips((1, 1), 8, 1, 1, &[0]) };
    let error =
        FileRows::new(Cursor::new(tiny.with(322, vec![u32::MAX]).with(323, vec![1]).file())).err().unwrap();
    assert_eq!(error.to_string().lines().count(), 1);
}

#[test]
fn text_and_profiles_in_a_png_are_passed_over() {
    let png = Png { width: 4, height: 1, bits: 8, colour: 0 };
    let bomb = [b"name\0\0", &zlib(&vec![b'a'; 1 << 20])[..]].concat();
    let long = [b"name\0", &vec![b'a'; 1 << 20][..]].concat();
    for chunk in [(b"zTXt", &bomb), (b"iCCP", &bomb), (b"tEXt", &long), (b"anYt", &long)] {
        let bytes = png.file(&[(chunk.0, chunk.1)], &[1, 2, 3, 4]);
        assert_eq!(by_rows(&bytes).unwrap().levels, [1, 2, 3, 4]);
    }
}

#[test]
fn a_jpeg_of_four_inks_is_read() {
    // 16 x 8 px of cyan, magenta, yellow and black with Adobe's mark: black on the left, paper on the right.
    let gray = decode(include_bytes!("../../data/four_inks.jpg")).unwrap();
    assert_eq!((gray.width(), gray.height()), (16, 8));
    for row in gray.rows() {
        assert!(row[..6].iter().all(|level| *level < 40), "{row:?}");
        assert!(row[10..].iter().all(|level| *level > 215), "{row:?}");
    }
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn long_thin_pictures_make_long_thin_drawings() {
    // A line all along the middle of three rows; and the same standing.
    let length = 100_000;
    let line = [vec![255; length], vec![0; length], vec![255; length]].concat();
    let lying = [b"P5 100000 3 255\n", &line[..]].concat();
    let standing = [b"P5 3 100000 255\n", &[255, 0, 255].repeat(length)[..]].concat();
    for bytes in [lying, standing] {
        let traced = Vectorizer::default().vectorize(&decode(&bytes).unwrap()).unwrap();
        assert_eq!(traced.drawing.strokes().len(), 1);
        assert_eq!(traced.drawing.pen_down_px(), 99_999.0);
        assert_eq!(traced.error.max_px, 0.0);
    }
    // One row, wholly ink or wholly paper: nothing to tell ink from paper by, but no panic either.
    for (width, height) in [(length, 1), (1, length)] {
        let noisy = [format!("P5 {width} {height} 255\n").as_bytes(), &noise(length, 9)].concat();
        let traced = Vectorizer::default().vectorize(&decode(&noisy).unwrap()).unwrap();
        let inside = |at: &plotter_vector::PxPoint| {
            (0.0..=width as f64).contains(&at.x) && (0.0..=height as f64).contains(&at.y)
        };
        assert!(traced.drawing.strokes().flatten().all(inside));
    }
}
