//! Speed of reading a scan by rows: an A4 sheet at 600 dots per inch, 4960 x 7016 px, 35 million of them.
//!
//! `cargo bench -p plotter-vector --bench rows`; the throughput is in pixels, so Gelem/s are thousand
//! megapixels.

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use plotter_vector::{
    FileRows,
    picture::{Row, RowSource},
};
use std::hint::black_box;
use std::io::{Cursor, Write};
use std::time::Duration;

const WIDTH: u32 = 4960;
const HEIGHT: u32 = 7016;

/// The sheet: slanted lines 6 px wide, one in 100 px, as packed rows of bits, 1 black.
fn bits() -> Vec<u8> {
    let mut bytes = vec![0_u8; WIDTH.div_ceil(8) as usize * HEIGHT as usize];
    for (y, row) in (0..HEIGHT).zip(bytes.chunks_mut(WIDTH.div_ceil(8) as usize)) {
        for x in (0..WIDTH).filter(|x| (x + y / 3) % 100 < 6) {
            if let Some(byte) = row.get_mut(x as usize / 8) {
                *byte |= 0x80 >> (x % 8);
            }
        }
    }
    bytes
}

/// The same as levels, with the noise of a scanner in the lowest bits.
fn levels(bits: &[u8]) -> Vec<u8> {
    let row_bytes = WIDTH.div_ceil(8) as usize;
    let mut noise = 1_u32;
    let mut level = |black: bool| {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let grain = noise.to_be_bytes()[0] & 7;
        if black { 20 + grain } else { 240 + grain }
    };
    let rows = bits.chunks(row_bytes);
    rows.flat_map(|row| {
        (0..WIDTH).map(|x| row.get(x as usize / 8).is_some_and(|byte| byte << (x % 8) & 0x80 != 0))
    })
    .map(&mut level)
    .collect()
}

fn png(depth: png::BitDepth, colour: png::ColorType, rows: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, WIDTH, HEIGHT);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    if let Ok(mut writer) = encoder.write_header() {
        writer.write_image_data(rows).unwrap_or_default();
    }
    bytes
}

/// A TIFF of one strip.
fn tiff(bits_per_sample: u16, compression: u16, strip: &[u8]) -> Vec<u8> {
    let long = |number: usize| u32::try_from(number).unwrap_or_default();
    let tags: [(u16, u32); 8] = [
        (256, WIDTH),
        (257, HEIGHT),
        (258, bits_per_sample.into()),
        (259, compression.into()),
        (262, u32::from(bits_per_sample > 1)),
        (273, 8),
        (278, HEIGHT),
        (279, long(strip.len())),
    ];
    let mut file = b"II*\0".to_vec();
    file.extend(long(8 + strip.len()).to_le_bytes());
    file.extend(strip);
    file.extend([8, 0]);
    for (tag, number) in tags {
        file.extend(tag.to_le_bytes());
        file.extend([4, 0, 1, 0, 0, 0]);
        file.extend(number.to_le_bytes());
    }
    file.extend([0; 4]);
    file
}

fn group4(bits: &[u8]) -> Vec<u8> {
    let mut encoder = fax::encoder::Encoder::new(fax::VecWriter::new());
    for row in bits.chunks(WIDTH.div_ceil(8) as usize) {
        let black = |x: u32| row.get(x as usize / 8).is_some_and(|byte| byte << (x % 8) & 0x80 != 0);
        let pixels = (0..WIDTH).map(|x| if black(x) { fax::Color::Black } else { fax::Color::White });
        encoder.encode_line(pixels, WIDTH).unwrap_or_default();
    }
    encoder.finish().map(fax::VecWriter::finish).unwrap_or_default()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap_or_default();
    encoder.finish().unwrap_or_default()
}

/// Reads all rows; the sum is there so that they are wanted.
fn read(bytes: &[u8]) -> u64 {
    let Ok(mut scan) = FileRows::new(Cursor::new(bytes)) else { return 0 };
    let mut sum = 0;
    while let Ok(Some(row)) = scan.next_row() {
        sum += match row {
            Row::Bits(words) => words.first().copied().unwrap_or_default(),
            Row::Grey(levels) => levels.first().copied().unwrap_or_default().into(),
        };
    }
    sum
}

fn rows(criterion: &mut Criterion) {
    let bits = bits();
    let levels = levels(&bits);
    let colours: Vec<u8> = levels.iter().flat_map(|level| [*level; 3]).collect();
    let header = |letter: char, rest: &str| format!("P{letter} {WIDTH} {HEIGHT}{rest}\n").into_bytes();
    let lzw = |bytes: &[u8]| {
        weezl::encode::Encoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8)
            .encode(bytes)
            .unwrap_or_default()
    };
    let text: Vec<u8> = levels.iter().flat_map(|level| format!("{level} ").into_bytes()).collect();
    let files = [
        ("pbm", [header('4', ""), bits.clone()].concat()),
        ("pgm", [header('5', " 255"), levels.clone()].concat()),
        ("pgm in text", [header('2', " 255"), text].concat()),
        ("ppm", [header('6', " 255"), colours.clone()].concat()),
        ("png 1 bit", png(png::BitDepth::One, png::ColorType::Grayscale, &bits)),
        ("png 8 bits", png(png::BitDepth::Eight, png::ColorType::Grayscale, &levels)),
        ("png rgb", png(png::BitDepth::Eight, png::ColorType::Rgb, &colours)),
        ("tiff 1 bit", tiff(1, 1, &bits)),
        ("tiff group 4", tiff(1, 4, &group4(&bits))),
        ("tiff 1 bit lzw", tiff(1, 5, &lzw(&bits))),
        ("tiff 8 bits", tiff(8, 1, &levels)),
        ("tiff 8 bits lzw", tiff(8, 5, &lzw(&levels))),
        ("tiff 8 bits deflate", tiff(8, 8, &zlib(&levels))),
    ];
    let mut group = criterion.benchmark_group("rows");
    group.sampling_mode(SamplingMode::Flat).sample_size(10).measurement_time(Duration::from_secs(2));
    group.throughput(Throughput::Elements(u64::from(WIDTH) * u64::from(HEIGHT)));
    for (name, bytes) in &files {
        let megabytes = bytes.len() / 1_000_000;
        let id = BenchmarkId::new(*name, format!("{megabytes} MB"));
        group.bench_with_input(id, bytes, |bencher, bytes| bencher.iter(|| read(black_box(bytes))));
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().warm_up_time(Duration::from_millis(300));
    targets = rows
}
criterion_main!(benches);
