//! Every kind of picture gives the levels it should.

use super::pictures::{Png, Tiff, noise, pngs, pnm, tiffs};
use super::{Levels, by_image, by_rows, pictures, rows};
use plotter_vector::{
    FileRows, decode,
    picture::{Depth, RowSource},
};
use std::io::Cursor;

/// Within a byte, a word, and beyond them.
const SIZES: [(u32, u32); 5] = [(1, 1), (3, 9), (8, 2), (64, 3), (133, 7)];

/// The picture read whole; asserts that it is the same by rows.
fn both_ways(name: &str, bytes: &[u8]) -> Levels {
    let by_rows = by_rows(bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    let whole = decode(bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!((whole.width(), whole.height()), (by_rows.width, by_rows.height), "{name}");
    assert_eq!(whole.pixels(), by_rows.levels, "{name}");
    by_rows
}

#[test]
fn everything_but_tiff_is_read_as_by_another_decoder() {
    for (width, height) in SIZES {
        let mut files = pngs(width, height);
        files.extend(pnm(width, height));
        files.push(("jpeg".into(), pictures::jpeg(width, height)));
        files.extend(pictures::others(width, height));
        for (name, bytes) in files {
            let expected = by_image(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(both_ways(&name, &bytes) == expected, "{name}, {width} x {height}");
        }
    }
}

/// The same samples as PNG, where there is such a kind.
fn as_png(size: (u32, u32), bits: u32, samples: u32, rows: &[u8]) -> Vec<u8> {
    let colour = [0, 4, 2, 6][samples as usize - 1];
    let png = Png { width: size.0, height: size.1, bits: u8::try_from(bits).unwrap(), colour };
    png.file(&[], rows)
}

#[test]
fn every_tiff_is_read_as_the_png_of_its_samples() {
    for (width, height) in SIZES {
        let size = (width, height);
        for (bits, samples, meaning) in [
            (1, 1, 1),
            (2, 1, 1),
            (4, 1, 1),
            (8, 1, 1),
            (16, 1, 1),
            (8, 2, 1),
            (8, 3, 2),
            (16, 3, 2),
            (8, 4, 2),
        ] {
            let row_bytes = ((bits * samples) as usize * width as usize).div_ceil(8);
            let samples_bytes = noise(row_bytes * height as usize, 23);
            let expected = by_image(&as_png(size, bits, samples, &samples_bytes)).unwrap();
            let mut plain = Tiff::strips(size, bits, samples, meaning, &samples_bytes);
            plain.big_endian = true;
            if samples % 2 == 0 {
                plain = plain.with(338, vec![2]);
            }
            let one_strip = plain.clone().compressed(1);
            let tiles = plain.clone().tiles(size, (bits * samples) as usize, 16);
            for (cut, tiff) in
                [("one strip", one_strip), ("strips", plain.cut(row_bytes, 2)), ("tiles", tiles)]
            {
                for compression in Tiff::COMPRESSIONS {
                    let name = format!("{samples} x {bits} bits, {cut}, compression {compression}");
                    let read = both_ways(&name, &tiff.clone().compressed(compression).file());
                    assert!(read == expected, "{name}, {width} x {height}");
                }
            }
        }
    }
}

#[test]
fn white_is_zero_turns_the_levels_around() {
    let rows = noise(20, 1);
    for bits in [1, 4, 8] {
        let width = 40 / bits;
        let tiff = |meaning| both_ways("", &Tiff::strips((width, 4), bits, 1, meaning, &rows).file());
        let (zero, one) = (tiff(0), tiff(1));
        assert!(zero.levels.iter().zip(&one.levels).all(|(a, b)| a + b == 255));
    }
}

#[test]
fn group_4_gives_the_bits_that_were_encoded() {
    for (width, height) in SIZES.into_iter().chain([(2000, 40)]) {
        let row_bytes = width.div_ceil(8) as usize;
        // Noise, and long runs with a few edges.
        let noisy = noise(row_bytes * height as usize, 4);
        let lines: Vec<u8> = noisy.iter().map(|byte| if *byte > 240 { 0x18 } else { 0 }).collect();
        for rows in [noisy, lines] {
            let plain = Tiff::strips((width, height), 1, 1, 0, &rows);
            let expected = both_ways("plain", &plain.file());
            let cut = plain.clone().cut(row_bytes, 3).group4(width);
            assert!(both_ways("strips", &cut.file()) == expected);
            let reversed = plain.clone().with(266, vec![2]).group4(width);
            let mut turned = reversed.clone();
            turned.blocks.iter_mut().flatten().for_each(|byte| *byte = byte.reverse_bits());
            assert!(both_ways("bits reversed", &turned.file()) == expected);
            let tiles = plain.tiles((width, height), 1, 16).group4(16);
            assert!(both_ways("tiles", &tiles.file()) == expected);
        }
    }
}

#[test]
fn differences_to_the_left_are_added_up() {
    for (bits, samples, meaning) in [(8, 1, 1), (8, 3, 2), (16, 1, 1), (16, 3, 2)] {
        let (width, stride) = (9, samples as usize);
        let rows = noise(width * stride * (bits as usize / 8), 31);
        let mut stored = rows.clone();
        if bits == 8 {
            (stride..rows.len()).for_each(|i| stored[i] = rows[i].wrapping_sub(rows[i - stride]));
        } else {
            let sample = |i: usize| u16::from_le_bytes([rows[2 * i], rows[2 * i + 1]]);
            for i in stride..rows.len() / 2 {
                let step = sample(i).wrapping_sub(sample(i - stride)).to_le_bytes();
                stored[2 * i..2 * i + 2].copy_from_slice(&step);
            }
        }
        let tiff = |rows: &[u8]| Tiff::strips((9, 1), bits, samples, meaning, rows);
        let expected = both_ways("plain", &tiff(&rows).file());
        let read = both_ways("differences", &tiff(&stored).with(317, vec![2]).compressed(5).file());
        assert_eq!(read, expected, "{samples} x {bits} bits");
    }
}

#[test]
fn a_palette_of_16_bits_is_read_from_either_writer() {
    for factor in [1, 256, 257] {
        let map = [0, 255, 200, 255, 0, 255].map(|value: u32| value * factor).to_vec();
        let tiff = Tiff::strips((2, 1), 1, 1, 3, &[0x40]).with(320, map);
        // (0, 200, 0) is 0.587 · 200 = 117.4 and (255, 255, 255) is white.
        assert_eq!(both_ways("palette", &tiff.file()).levels, [117, 255], "{factor}");
    }
}

#[test]
fn black_and_white_comes_as_bits_and_all_else_as_grey() {
    let black_and_white = [0, 0, 0, 255, 255, 255];
    let red_and_white = [255, 0, 0, 255, 255, 255];
    let png = Png { width: 9, height: 1, bits: 1, colour: 3 };
    let grey_png = Png { colour: 0, ..png };
    let cases = [
        (Depth::Bits1, b"P4 9 1\n\x00\x80".to_vec()),
        (Depth::Bits1, b"P1 9 1\n000000001".to_vec()),
        (Depth::Bits1, grey_png.file(&[], &[0xff, 0])),
        (Depth::Bits1, png.file(&[(b"PLTE", &black_and_white)], &[0xff, 0])),
        (Depth::Bits1, Tiff::strips((9, 1), 1, 1, 0, &[0, 0x80]).file()),
        (Depth::Grey8, png.file(&[(b"PLTE", &red_and_white)], &[0xff, 0])),
        (Depth::Grey8, Png { bits: 2, ..grey_png }.file(&[], &[0xff, 0xff, 0])),
        (Depth::Grey8, b"P5 9 1 1\n\x01\x01\x01\x01\x01\x01\x01\x01\x00".to_vec()),
    ];
    for (depth, bytes) in cases {
        let mut scan = FileRows::new(Cursor::new(&bytes)).unwrap();
        assert_eq!(scan.depth(), depth);
        let (read, error) = rows(&mut scan);
        assert_eq!(error, None);
        assert_eq!(read.levels[..8], [255; 8]);
        assert!(read.levels[8] < 100);
    }
}

#[test]
fn every_kind_can_be_read_again_from_anywhere() {
    let mut files = pngs(21, 5);
    files.extend(pnm(21, 5));
    files.extend(tiffs(21, 5));
    files.push(("jpeg".into(), pictures::jpeg(21, 5)));
    files.extend(pictures::others(21, 5));
    files.extend(pictures::with_metadata(21, 5));
    for (name, bytes) in files {
        let mut scan = FileRows::new(Cursor::new(&bytes)).unwrap();
        let once = rows(&mut scan);
        assert_eq!(once.1, None, "{name}");
        for stop in [0, 1, 3] {
            scan.rewind().unwrap();
            (0..stop).for_each(|_| assert!(scan.next_row().unwrap().is_some()));
            scan.rewind().unwrap();
            assert!(rows(&mut scan) == once, "{name}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn long_thin_pictures_are_read() {
    for (width, height) in [(100_000, 1), (1, 100_000)] {
        for (name, bytes) in pnm(width, height).into_iter().take(4) {
            assert!(both_ways(&name, &bytes) == by_image(&bytes).unwrap(), "{name}");
        }
        let png = Png { width, height, bits: 1, colour: 0 }.of_noise(false, false);
        assert!(both_ways("png", &png) == by_image(&png).unwrap());
        let row_bytes = width.div_ceil(8) as usize;
        let rows = noise(row_bytes * height as usize, 1);
        let plain = Tiff::strips((width, height), 1, 1, 1, &rows);
        let expected = both_ways("tiff", &plain.file());
        let cut = plain.cut(row_bytes, 1).compressed(32773);
        assert!(both_ways("tiff, a strip a row", &cut.file()) == expected);
    }
}
