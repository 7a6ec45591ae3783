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

    /// The bytes of the file: header, then the page.
    pub(crate) fn file(&self) -> Vec<u8> {
        Self::pages(std::slice::from_ref(self))
    }

    /// The bytes of a file of several pages, all in the byte order of the first.
    pub(crate) fn pages(pages: &[Self]) -> Vec<u8> {
        const HEADER: usize = 8;
        let big_endian = pages.first().is_some_and(|page| page.big_endian);
        let long = |number: u32| if big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
        let mut file = if big_endian { b"MM\0*".to_vec() } else { b"II*\0".to_vec() };
        let length = |of: usize| u32::try_from(of).expect("short");
        let blocks = |page: &Self| page.blocks.iter().map(Vec::len).sum::<usize>();
        file.extend(long(length(HEADER + pages.first().map_or(0, blocks))));
        for (index, page) in pages.iter().enumerate() {
            let start = file.len();
            let end = start + page.part(start, 0).len();
            let next = pages.get(index + 1).map_or(0, |next| length(end + blocks(next)));
            file.extend(page.part(start, next));
        }
        file
    }

    /// A page that begins at `start`: blocks, directory, longer values; `next` is where the next directory
    /// lies.
    fn part(&self, start: usize, next: u32) -> Vec<u8> {
        let long = |number: u32| if self.big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
        let short = |number: u16| if self.big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
        let length = |of: usize| u32::try_from(of).expect("short");
        let mut file = Vec::new();
        let (mut offsets, mut counts) = (Vec::new(), Vec::new());
        for block in &self.blocks {
            offsets.push(length(start + file.len()));
            counts.push(length(block.len()));
            file.extend(block);
        }
        let mut tags = self.tags.clone();
        tags.push((if self.tiled { 324 } else { 273 }, offsets));
        tags.push((if self.tiled { 325 } else { 279 }, counts));
        tags.sort();
        file.extend(short(u16::try_from(tags.len()).expect("few")));
        let mut values = Vec::new();
        let place = start + file.len() + 12 * tags.len() + 4;
        for (tag, numbers) in &tags {
            let ratio = matches!(tag, 282 | 283);
            let wide = ratio || matches!(tag, 256 | 257 | 273 | 278 | 279 | 322..=325);
            let number = |number: &u32| {
                if wide {
                    long(*number).to_vec()
                } else {
                    short(u16::try_from(*number).expect("16 bits")).to_vec()
                }
            };
            let mut bytes: Vec<u8> = numbers.iter().flat_map(number).collect();
            file.extend(short(*tag));
            file.extend(short(match (ratio, wide) {
                (true, _) => 5,
                (_, true) => 4,
                _ => 3,
            }));
            file.extend(long(length(numbers.len() / if ratio { 2 } else { 1 })));
            if bytes.len() <= 4 {
                bytes.resize(4, 0);
                file.extend(bytes);
            } else {
                file.extend(long(length(place + values.len())));
                values.extend(bytes);
            }
        }
        file.extend(long(next));
        file.extend(values);
        file
    }
}

/// What EXIF may say of a picture.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Exif {
    /// 1 to 8; what is 0 is not written.
    pub(crate) orientation: u16,
    /// Numerator and denominator of both resolutions, and their unit: 2 an inch, 3 a centimetre.
    pub(crate) resolution: Option<([(u32, u32); 2], u16)>,
    /// Whether it says which aperture the lens had.
    pub(crate) lens: bool,
}

impl Exif {
    /// Its bytes, big endian.
    pub(crate) fn bytes(self) -> Vec<u8> {
        const HEADER: usize = 8;
        let mut entries: Vec<(u16, u16, [u8; 4])> = Vec::new();
        let short = |number: u16| [number.to_be_bytes(), [0; 2]].concat().try_into().expect("four bytes");
        if self.orientation > 0 {
            entries.push((0x0112, 3, short(self.orientation)));
        }
        let count = entries.len() + if self.resolution.is_some() { 3 } else { 0 } + usize::from(self.lens);
        let behind = HEADER + 2 + 12 * count + 4;
        let place = |at: usize| u32::try_from(at).expect("short").to_be_bytes();
        let mut values = Vec::new();
        let mut ratio = |(above, below): (u32, u32)| {
            values.extend(above.to_be_bytes());
            values.extend(below.to_be_bytes());
            place(behind + values.len() - 8)
        };
        if let Some(([across, down], unit)) = self.resolution {
            entries.push((0x011a, 5, ratio(across)));
            entries.push((0x011b, 5, ratio(down)));
            entries.push((0x0128, 3, short(unit)));
        }
        let aperture = self.lens.then(|| ratio((28, 10)));
        if aperture.is_some() {
            entries.push((0x8769, 4, place(behind + values.len())));
        }
        let directory = |entries: &[(u16, u16, [u8; 4])]| {
            let mut bytes = u16::try_from(entries.len()).expect("few").to_be_bytes().to_vec();
            for (tag, kind, value) in entries {
                bytes.extend(tag.to_be_bytes());
                bytes.extend(kind.to_be_bytes());
                bytes.extend([0, 0, 0, 1]);
                bytes.extend(value);
            }
            bytes.extend([0; 4]);
            bytes
        };
        let mut bytes = [b"MM\0*".to_vec(), place(HEADER).to_vec(), directory(&entries), values].concat();
        if let Some(aperture) = aperture {
            bytes.extend(directory(&[(0x829d, 5, aperture)]));
        }
        bytes
    }
}

/// A JPEG with segments put behind its first mark in place of its JFIF header: the second bytes of their marks
/// and what they hold.
pub(crate) fn jpeg_with(jpeg: &[u8], segments: &[(u8, Vec<u8>)]) -> Vec<u8> {
    let header = if jpeg.get(3) == Some(&0xe0) { 4 + usize::from(jpeg[5]) } else { 2 };
    let mut file = jpeg[..2].to_vec();
    for (mark, bytes) in segments {
        file.extend([0xff, *mark]);
        file.extend(u16::try_from(bytes.len() + 2).expect("short").to_be_bytes());
        file.extend(bytes);
    }
    file.extend(&jpeg[header..]);
    file
}

/// A JFIF header of a density and its unit: 0 a ratio, 1 an inch, 2 a centimetre.
pub(crate) fn jfif(unit: u8, [across, down]: [u16; 2]) -> (u8, Vec<u8>) {
    let density = [across.to_be_bytes(), down.to_be_bytes()].concat();
    (0xe0, [b"JFIF\0\x01\x02".to_vec(), vec![unit], density, vec![0, 0]].concat())
}

/// The segment of a JPEG with EXIF.
pub(crate) fn exif_segment(exif: Exif) -> (u8, Vec<u8>) {
    (0xe1, [b"Exif\0\0".to_vec(), exif.bytes()].concat())
}

/// A WebP with EXIF, from a plain one of RGBA: the plain file's one chunk behind the header that says what
/// else there is.
pub(crate) fn webp_with(webp: &[u8], (width, height): (u32, u32), exif: Exif) -> Vec<u8> {
    const ALPHA_AND_EXIF: u8 = 0x18;
    let chunk = |name: &[u8; 4], body: &[u8]| {
        let mut bytes = name.to_vec();
        bytes.extend(u32::try_from(body.len()).expect("short").to_le_bytes());
        bytes.extend(body);
        bytes.resize(bytes.len().next_multiple_of(2), 0);
        bytes
    };
    let mut header = vec![ALPHA_AND_EXIF, 0, 0, 0];
    header.extend(&(width - 1).to_le_bytes()[..3]);
    header.extend(&(height - 1).to_le_bytes()[..3]);
    let body = [chunk(b"VP8X", &header), webp[12..].to_vec(), chunk(b"EXIF", &exif.bytes())].concat();
    chunk(b"RIFF", &[b"WEBP".to_vec(), body].concat())
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

/// WebP, BMP and GIF, as `image` writes them.
pub(crate) fn others(width: u32, height: u32) -> Vec<(String, Vec<u8>)> {
    use image::{DynamicImage, ImageFormat};
    let rgba = image::RgbaImage::from_raw(width, height, noise(4 * (width * height) as usize, 9));
    let clear = DynamicImage::from(rgba.expect("four channels a pixel"));
    let solid = DynamicImage::from(clear.to_rgb8());
    let grey = DynamicImage::from(clear.to_luma8());
    let file = |picture: &DynamicImage, format| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).expect("a vector takes all");
        bytes.into_inner()
    };
    vec![
        ("webp".into(), file(&solid, ImageFormat::WebP)),
        ("webp, clear".into(), file(&clear, ImageFormat::WebP)),
        ("bmp".into(), file(&solid, ImageFormat::Bmp)),
        ("bmp, clear".into(), file(&clear, ImageFormat::Bmp)),
        ("bmp, grey".into(), file(&grey, ImageFormat::Bmp)),
        ("gif".into(), file(&solid, ImageFormat::Gif)),
    ]
}

/// Pictures with much beside the pixels, right and wrong.
pub(crate) fn with_metadata(width: u32, height: u32) -> Vec<(String, Vec<u8>)> {
    let full = Exif { orientation: 6, resolution: Some(([(300, 1), (300, 1)], 2)), lens: true };
    let wrong = Exif { orientation: 77, resolution: Some(([(1, 0), (0, 0)], 9)), lens: false };
    let mut files = Vec::new();
    for (name, exif) in [("full", full), ("wrong", wrong)] {
        let png = Png { width, height, bits: 8, colour: 6 };
        let rows = noise(png.row_bytes(width) * height as usize, 2);
        let phys = [300_u32.to_be_bytes(), 300_u32.to_be_bytes()].concat();
        let phys = [phys, vec![1]].concat();
        files.push((format!("png, {name}"), png.file(&[(b"pHYs", &phys), (b"eXIf", &exif.bytes())], &rows)));
        let segments = [jfif(1, [300, 300]), exif_segment(exif)];
        files.push((format!("jpeg, {name}"), jpeg_with(&jpeg(width, height), &segments)));
        let webp = others(width, height).swap_remove(1).1;
        files.push((format!("webp, {name}"), webp_with(&webp, (width, height), exif)));
    }
    let rows = noise(width.div_ceil(8) as usize * height as usize, 6);
    let page = Tiff::strips((width, height), 1, 1, 0, &rows)
        .with(274, vec![5])
        .with(282, vec![300, 1])
        .with(283, vec![300, 1])
        .with(296, vec![2]);
    let copy = page.clone().with(254, vec![1]);
    files.push(("tiff, pages".into(), Tiff::pages(&[page.clone(), copy, page])));
    files
}

/// A picture of every kind.
pub(crate) fn every_kind(width: u32, height: u32) -> Vec<(String, Vec<u8>)> {
    let mut files = pngs(width, height);
    files.extend(pnm(width, height));
    files.extend(tiffs(width, height));
    files.push(("jpeg".into(), jpeg(width, height)));
    files.extend(others(width, height));
    files.extend(with_metadata(width, height));
    files
}
