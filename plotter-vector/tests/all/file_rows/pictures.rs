//! Small synthetic picture files of every kind, built byte by byte, so that damaged and odd ones can be built
//! too.

use flate2::{Compression, Crc, write::ZlibEncoder};
use std::io::Write;

/// Noise that is the same each time: the 64-bit linear congruential generator of Knuth's MMIX.
pub(crate) fn noise(length: usize, seed: u64) -> Vec<u8> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state.to_be_bytes()[0]
    };
    (0..length).map(|_| next()).collect()
}

pub(crate) fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).expect("a vector takes all");
    encoder.finish().expect("a vector takes all")
}

/// What the header of a PNG says.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Png {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) bits: u8,
    /// 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGB and alpha.
    pub(crate) colour: u8,
}

impl Png {
    /// All kinds that there are.
    pub(crate) const KINDS: [(u8, u8); 15] = [
        (1, 0),
        (2, 0),
        (4, 0),
        (8, 0),
        (16, 0),
        (8, 2),
        (16, 2),
        (1, 3),
        (2, 3),
        (4, 3),
        (8, 3),
        (8, 4),
        (16, 4),
        (8, 6),
        (16, 6),
    ];

    pub(crate) fn samples(self) -> usize {
        [1, 0, 3, 1, 2, 0, 4][usize::from(self.colour)]
    }

    /// Bytes of a row of `width` pixels.
    pub(crate) fn row_bytes(self, width: u32) -> usize {
        (width as usize * self.samples() * usize::from(self.bits)).div_ceil(8)
    }

    /// The file with chunks before the pixels; `rows` are packed, without filter bytes.
    pub(crate) fn file(self, chunks: &[(&[u8; 4], &[u8])], rows: &[u8]) -> Vec<u8> {
        let row_bytes = self.row_bytes(self.width).max(1);
        let filtered: Vec<u8> = rows.chunks(row_bytes).flat_map(|row| [&[0], row].concat()).collect();
        self.file_of(0, chunks, &zlib(&filtered))
    }

    /// The file stored in seven passes; for pixels of whole bytes.
    pub(crate) fn interlaced(self, chunks: &[(&[u8; 4], &[u8])], rows: &[u8]) -> Vec<u8> {
        let pixel_bytes = self.samples() * usize::from(self.bits) / 8;
        let mut passes = Vec::new();
        // First column and row, steps (PNG, section 8.2).
        for (x, y, dx, dy) in
            [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]
        {
            if x >= self.width {
                continue;
            }
            for y in (y..self.height).step_by(dy) {
                passes.push(0);
                for x in (x..self.width).step_by(dx) {
                    let start = y as usize * self.row_bytes(self.width) + x as usize * pixel_bytes;
                    passes.extend_from_slice(&rows[start..start + pixel_bytes]);
                }
            }
        }
        self.file_of(1, chunks, &zlib(&passes))
    }

    /// The file from compressed data.
    pub(crate) fn file_of(self, interlace: u8, chunks: &[(&[u8; 4], &[u8])], data: &[u8]) -> Vec<u8> {
        let mut header = Vec::new();
        header.extend(self.width.to_be_bytes());
        header.extend(self.height.to_be_bytes());
        header.extend([self.bits, self.colour, 0, 0, interlace]);
        let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
        let all = [&[(b"IHDR", &header[..])], chunks, &[(b"IDAT", data), (b"IEND", &[])]].concat();
        for (kind, body) in all {
            let mut crc = Crc::new();
            crc.update(kind);
            crc.update(body);
            file.extend(u32::try_from(body.len()).expect("short").to_be_bytes());
            file.extend(kind);
            file.extend(body);
            file.extend(crc.sum().to_be_bytes());
        }
        file
    }

    /// A picture of noise with what its kind needs, and transparent parts if asked for.
    pub(crate) fn of_noise(self, clear: bool, interlace: bool) -> Vec<u8> {
        let rows = noise(self.row_bytes(self.width) * self.height as usize, u64::from(self.width));
        let palette = noise(3 << self.bits.min(8), 7);
        let clear_parts = match self.colour {
            0 => vec![0, 1],
            2 => vec![0, 7, 0, 7, 0, 7],
            _ => vec![0, 100, 255, 30][..(1 << self.bits.min(2))].to_vec(),
        };
        let mut chunks: Vec<(&[u8; 4], &[u8])> = Vec::new();
        if self.colour == 3 {
            chunks.push((b"PLTE", &palette));
        }
        if clear {
            chunks.push((b"tRNS", &clear_parts));
        }
        if interlace { self.interlaced(&chunks, &rows) } else { self.file(&chunks, &rows) }
    }
}

/// A TIFF, little endian, of blocks that have been compressed.
#[derive(Clone, Debug)]
pub(crate) struct Tiff {
    /// Tags and their numbers: sizes and places of 32 bits, others of 16.
    pub(crate) tags: Vec<(u16, Vec<u32>)>,
    pub(crate) blocks: Vec<Vec<u8>>,
    pub(crate) tiled: bool,
    pub(crate) big_endian: bool,
}

impl Tiff {
    pub(crate) const COMPRESSIONS: [u32; 4] = [1, 5, 8, 32773];

    /// A picture of strips from packed rows.
    pub(crate) fn strips(size: (u32, u32), bits: u32, samples: u32, meaning: u32, rows: &[u8]) -> Self {
        let tags = vec![
            (256, vec![size.0]),
            (257, vec![size.1]),
            (258, vec![bits; samples as usize]),
            (259, vec![1]),
            (262, vec![meaning]),
            (277, vec![samples]),
        ];
        Self { tags, blocks: vec![rows.to_vec()], tiled: false, big_endian: false }
    }

    /// Replaces or adds a tag.
    pub(crate) fn with(mut self, tag: u16, numbers: Vec<u32>) -> Self {
        self.tags.retain(|(old, _)| *old != tag);
        self.tags.push((tag, numbers));
        self
    }

    /// Cuts the one strip into strips of so many rows.
    pub(crate) fn cut(mut self, row_bytes: usize, rows: u32) -> Self {
        self.blocks = self.blocks.concat().chunks(row_bytes * rows as usize).map(<[u8]>::to_vec).collect();
        self.with(278, vec![rows])
    }

    /// Cuts the one strip into tiles of `side` px, for pixels of `bits` bits.
    pub(crate) fn tiles(mut self, size: (u32, u32), bits: usize, side: usize) -> Self {
        let (width, height) = (size.0 as usize, size.1 as usize);
        let row_bytes = (width * bits).div_ceil(8);
        let tile_bytes = side * bits / 8;
        let rows = self.blocks.concat();
        self.blocks.clear();
        for y in (0..height).step_by(side) {
            for x in 0..width.div_ceil(side) {
                let mut tile = Vec::new();
                for y in y..y + side {
                    let start = y * row_bytes + x * tile_bytes;
                    let end = (start + tile_bytes).min((y + 1) * row_bytes).min(rows.len());
                    tile.extend(rows.get(start..end).unwrap_or(&[]));
                    tile.resize(tile.len().next_multiple_of(tile_bytes), 0xa5);
                }
                tile.resize(side * tile_bytes, 0x5a);
                self.blocks.push(tile);
            }
        }
        self.tiled = true;
        let side = u32::try_from(side).expect("small");
        self.with(322, vec![side]).with(323, vec![side])
    }

    /// Compresses the blocks.
    pub(crate) fn compressed(mut self, compression: u32) -> Self {
        for block in &mut self.blocks {
            *block = match compression {
                5 => weezl::encode::Encoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8)
                    .encode(block)
                    .expect("bytes"),
                8 => zlib(block),
                32773 => packbits(block),
                _ => block.clone(),
            };
        }
        self.with(259, vec![compression])
    }

    /// Compresses blocks of bits `width` px wide with CCITT group 4.
    pub(crate) fn group4(mut self, width: u32) -> Self {
        for block in &mut self.blocks {
            let mut encoder = fax::encoder::Encoder::new(fax::VecWriter::new());
            for row in block.chunks(width.div_ceil(8) as usize) {
                let black = |x: u32| row[x as usize / 8] >> (7 - x % 8) & 1 == 1;
                let pixels = (0..width).map(|x| if black(x) { fax::Color::Black } else { fax::Color::White });
                encoder.encode_line(pixels, width).expect("a vector takes all");
            }
            *block = encoder.finish().expect("a vector takes all").finish();
        }
        self.with(259, vec![4])
    }

    /// The bytes of the file: header, blocks, directory, longer values.
    pub(crate) fn file(&self) -> Vec<u8> {
        let long = |number: u32| if self.big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
        let short = |number: u16| if self.big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
        let length = |of: usize| u32::try_from(of).expect("short");
        let mut file = if self.big_endian { b"MM\0*".to_vec() } else { b"II*\0".to_vec() };
        let directory = 8 + self.blocks.iter().map(Vec::len).sum::<usize>();
        file.extend(long(length(directory)));
        let (mut offsets, mut counts) = (Vec::new(), Vec::new());
        for block in &self.blocks {
            offsets.push(length(file.len()));
            counts.push(length(block.len()));
            file.extend(block);
        }
        let mut tags = self.tags.clone();
        tags.push((if self.tiled { 324 } else { 273 }, offsets));
        tags.push((if self.tiled { 325 } else { 279 }, counts));
        tags.sort();
        file.extend(short(u16::try_from(tags.len()).expect("few")));
        let mut values = Vec::new();
        let place = file.len() + 12 * tags.len() + 4;
        for (tag, numbers) in &tags {
            let wide = matches!(tag, 256 | 257 | 273 | 278 | 279 | 322..=325);
            let number = |number: &u32| {
                if wide {
                    long(*number).to_vec()
                } else {
                    short(u16::try_from(*number).expect("16 bits")).to_vec()
                }
            };
            let mut bytes: Vec<u8> = numbers.iter().flat_map(number).collect();
            file.extend(short(*tag));
            file.extend(short(if wide { 4 } else { 3 }));
            file.extend(long(length(numbers.len())));
            if bytes.len() <= 4 {
                bytes.resize(4, 0);
                file.extend(bytes);
            } else {
                file.extend(long(length(place + values.len())));
                values.extend(bytes);
            }
        }
        file.extend([0; 4]);
        file.extend(values);
        file
    }
}

/// Runs of equal bytes as repeats, others one by one.
fn packbits(bytes: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    for run in bytes.chunk_by(|a, b| a == b).flat_map(|run| run.chunks(128)) {
        packed.push(if run.len() == 1 { 0 } else { u8::try_from(257 - run.len()).expect("2 to 128") });
        packed.push(run[0]);
    }
    packed
}

/// A JPEG of grey noise, as `image` writes it.
pub(crate) fn jpeg(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::GrayImage::from_raw(width, height, noise((width * height) as usize, 3))
        .expect("a level a pixel")
        .write_to(&mut bytes, image::ImageFormat::Jpeg)
        .expect("a vector takes all");
    bytes.into_inner()
}

/// Every kind of PBM, PGM and PPM, of noise.
pub(crate) fn pnm(width: u32, height: u32) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    let rows = |row_bytes: usize| noise(row_bytes * height as usize, 5);
    let bits = rows(width.div_ceil(8) as usize);
    files.push(("P4".into(), [format!("P4 {width} {height}\n").as_bytes(), &bits].concat()));
    let text: String = rows(width as usize).iter().map(|byte| if *byte < 99 { "0 " } else { "1" }).collect();
    files.push(("P1".into(), format!("P1\n# bits\n{width} {height}\n{text}\n").into_bytes()));
    for (letter, plain, samples) in [('5', '2', 1), ('6', '3', 3)] {
        for maxval in [1_u32, 3, 100, 255, 256, 4095, 65535] {
            let deep = if maxval > 255 { 2 } else { 1 };
            // Samples above the greatest are met too.
            let bytes = rows(width as usize * samples * deep);
            let header = format!("{width} {height} {maxval}\n");
            let binary = [format!("P{letter} {header}").as_bytes(), &bytes].concat();
            files.push((format!("P{letter} {maxval}"), binary));
            let numbers =
                bytes.chunks(deep).map(|sample| sample.iter().fold(0, |n, byte| n << 8 | u32::from(*byte)));
            let text: String = numbers.map(|number| format!("{number}\n")).collect();
            files.push((format!("P{plain} {maxval}"), format!("P{plain} {header}{text}").into_bytes()));
        }
    }
    files
}

/// A TIFF of every kind, of noise.
pub(crate) fn tiffs(width: u32, height: u32) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    let size = (width, height);
    let palette: Vec<u32> = noise(3 * 256, 11).into_iter().map(|byte| u32::from(byte) * 257).collect();
    for (bits, samples, meaning) in [
        (1, 1, 0),
        (1, 1, 1),
        (1, 1, 3),
        (2, 1, 1),
        (4, 1, 0),
        (4, 1, 3),
        (8, 1, 0),
        (8, 1, 1),
        (8, 1, 3),
        (16, 1, 1),
        (8, 2, 1),
        (8, 3, 2),
        (8, 4, 2),
        (16, 3, 2),
        (16, 4, 2),
    ] {
        let row_bytes = ((bits * samples) as usize * width as usize).div_ceil(8);
        let rows = noise(row_bytes * height as usize, 13);
        let mut plain = Tiff::strips(size, bits, samples, meaning, &rows);
        if meaning == 3 {
            let count = 1 << bits;
            let map = palette.chunks(256).flat_map(|colour| &colour[..count]).copied().collect();
            plain = plain.with(320, map);
        }
        if samples % 2 == 0 {
            plain = plain.with(338, vec![2]);
        }
        for compression in Tiff::COMPRESSIONS {
            let name = format!("tiff {samples} x {bits}, {meaning}, compression {compression}");
            let cut = plain.clone().cut(row_bytes, 3).compressed(compression);
            files.push((name.clone() + ", strips", cut.file()));
            let tiles = plain.clone().tiles(size, (bits * samples) as usize, 16).compressed(compression);
            files.push((name + ", tiles", tiles.file()));
        }
        if bits == 1 {
            files.push(("tiff, group 4".into(), plain.clone().cut(row_bytes, 5).group4(width).file()));
            files.push(("tiff, group 4, tiles".into(), plain.tiles(size, 1, 16).group4(16).file()));
        }
    }
    files
}

/// A picture of every kind of PNG.
pub(crate) fn pngs(width: u32, height: u32) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for (bits, colour) in Png::KINDS {
        let png = Png { width, height, bits, colour };
        for clear in [false, true].into_iter().take(if colour < 4 { 2 } else { 1 }) {
            let name = format!("png {bits} bits, colour {colour}, clear {clear}");
            files.push((name.clone(), png.of_noise(clear, false)));
            if bits >= 8 {
                files.push((name + ", interlaced", png.of_noise(clear, true)));
            }
        }
    }
    files
}

/// A picture of every kind.
pub(crate) fn every_kind(width: u32, height: u32) -> Vec<(String, Vec<u8>)> {
    let mut files = pngs(width, height);
    files.extend(pnm(width, height));
    files.extend(tiffs(width, height));
    files.push(("jpeg".into(), jpeg(width, height)));
    files
}
