//! [`Pixels`]: what the bytes of a row mean, and the way from there to a [`Row`].

use crate::picture::colour::colour_on;
use crate::picture::gray::gray_on;
use crate::picture::ground::{Ground, GroundSurvey};
use crate::picture::{Depth, Row};

/// The row that is given out.
#[derive(Clone, Debug)]
pub(super) enum RowBuffer {
    Bits(Vec<u64>),
    Grey(Vec<u8>),
}

impl RowBuffer {
    pub(super) fn new(width: u32, depth: Depth) -> Self {
        match depth {
            Depth::Bits1 => Self::Bits(vec![0; width.div_ceil(64) as usize]),
            Depth::Grey8 => Self::Grey(vec![0; width as usize]),
        }
    }

    pub(super) fn depth(&self) -> Depth {
        match self {
            Self::Bits(_) => Depth::Bits1,
            Self::Grey(_) => Depth::Grey8,
        }
    }

    pub(super) fn row(&self) -> Row<'_> {
        match self {
            Self::Bits(words) => Row::Bits(words),
            Self::Grey(levels) => Row::Grey(levels),
        }
    }
}

/// What the samples of a pixel are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channels {
    Grey,
    GreyAlpha,
    Rgb,
    RgbAlpha,
    /// Grey and how much of the paper it covers, the grey already lessened by it.
    GreyCover,
    /// A colour and how much of the paper it covers, the colour already lessened by it.
    RgbCover,
}

/// How a sample is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sample {
    Byte,
    BigEndian16,
    LittleEndian16,
}

/// What the bytes of a row mean.
#[derive(Clone, Debug)]
pub(super) enum Pixels {
    /// A bit a pixel, the leftmost in the highest bit of its byte.
    Bits {
        /// Whether 0 is black; else it is white.
        zero_is_black: bool,
        /// Whether 1 is black; else it is white.
        one_is_black: bool,
    },
    /// A number a pixel, of 1, 2, 4 or 8 bits, the leftmost in the highest bits: an index into the levels
    /// and, for who asks for colours, into these.
    Table { bits: u8, levels: Box<[u8; 256]>, colours: Box<[[u8; 3]; 256]> },
    /// The same with colours and alphas, until it is known what they are laid on.
    ClearTable { bits: u8, colours: Box<[[u8; 4]; 256]> },
    /// Samples of 8 or 16 bits, `stride` of them a pixel; those behind the known channels mean nothing.
    Samples { channels: Channels, sample: Sample, stride: usize },
}

impl Pixels {
    /// Numbers of `bits` bits whose levels are given. Where they are only black and white, it is bits; where
    /// they are the levels already, they are copied.
    pub(super) fn table(bits: u8, levels: [u8; 256]) -> Self {
        if bits == 8 && levels == Self::even_levels(8) {
            return Self::Samples { channels: Channels::Grey, sample: Sample::Byte, stride: 1 };
        }
        if let (1, [zero @ (0 | 255), one @ (0 | 255), ..]) = (bits, levels) {
            return Self::Bits { zero_is_black: zero == 0, one_is_black: one == 0 };
        }
        Self::Table { bits, levels: Box::new(levels), colours: Box::new(levels.map(|level| [level; 3])) }
    }

    /// Numbers of `bits` bits whose colours and alphas are given.
    pub(super) fn palette(bits: u8, colours: [[u8; 4]; 256]) -> Self {
        if colours.iter().any(|[.., alpha]| *alpha < u8::MAX) {
            return Self::ClearTable { bits, colours: Box::new(colours) };
        }
        Self::palette_on(bits, &colours, Ground::White)
    }

    /// The same laid on a ground. Where all are grey, it is a table of levels.
    fn palette_on(bits: u8, colours: &[[u8; 4]; 256], ground: Ground) -> Self {
        let levels = colours.map(|colour| gray_on(ground.level(), colour));
        let colours = colours.map(|colour| colour_on(ground.level(), colour));
        // Colours may have the levels of a plain grey scale, or of black and white, and be neither.
        if colours == levels.map(|level| [level; 3]) {
            return Self::table(bits, levels);
        }
        Self::Table { bits, levels: Box::new(levels), colours: Box::new(colours) }
    }

    /// Grey of 1, 2, 4 or 8 bits, 0 black: level = number · 255 / greatest, which is whole.
    pub(super) fn even_levels(bits: u8) -> [u8; 256] {
        let greatest = u8::MAX >> 8_u8.saturating_sub(bits);
        core::array::from_fn(|number| {
            u8::try_from(number).ok().filter(|number| *number <= greatest).map_or(0, |n| n * (255 / greatest))
        })
    }

    /// Whether some of it may be transparent.
    pub(super) fn may_be_clear(&self) -> bool {
        match self {
            Self::Bits { .. } | Self::Table { .. } => false,
            Self::ClearTable { .. } => true,
            Self::Samples { channels, .. } => !matches!(channels, Channels::Grey | Channels::Rgb),
        }
    }

    /// Lays it on a ground: from here on a table has no alphas. Samples are told at each row.
    pub(super) fn lay_on(&mut self, ground: Ground) {
        if let Self::ClearTable { bits, colours } = self {
            *self = Self::palette_on(*bits, colours, ground);
        }
    }

    /// Adds the `width` pixels that the bytes mean to what is known of a transparent picture.
    pub(super) fn survey(&self, bytes: &[u8], width: u32, survey: &mut GroundSurvey) {
        let width = width as usize;
        match self {
            Self::Bits { .. } | Self::Table { .. } => {}
            Self::ClearTable { bits, colours } => {
                let mut counts = [0_u64; 256];
                for number in numbers(bytes, (*bits).clamp(1, 8).into()).take(width) {
                    if let Some(count) = counts.get_mut(usize::from(number)) {
                        *count += 1;
                    }
                }
                for (colour, count) in colours.iter().zip(counts).filter(|(_, count)| *count > 0) {
                    survey.add_many(*colour, count);
                }
            }
            Self::Samples { channels, sample, stride } => {
                let stride = (*stride).max(1);
                match sample {
                    Sample::Byte => {
                        for pixel in bytes.chunks_exact(stride).take(width) {
                            survey.add(channels.colour_and_alpha(|index| pixel.get(index).copied()));
                        }
                    }
                    Sample::BigEndian16 | Sample::LittleEndian16 => {
                        for pixel in bytes.as_chunks().0.chunks_exact(stride).take(width) {
                            let value =
                                |index: usize| pixel.get(index).copied().map(|pair| sample.value(pair));
                            survey.add(channels.colour_and_alpha(value));
                        }
                    }
                }
            }
        }
    }

    pub(super) fn depth(&self) -> Depth {
        if matches!(self, Self::Bits { .. }) { Depth::Bits1 } else { Depth::Grey8 }
    }

    /// Bits of a pixel.
    pub(super) fn bits_per_pixel(&self) -> usize {
        match self {
            Self::Bits { .. } => 1,
            Self::Table { bits, .. } | Self::ClearTable { bits, .. } => usize::from(*bits),
            Self::Samples { sample: Sample::Byte, stride, .. } => 8 * stride,
            Self::Samples { stride, .. } => 16 * stride,
        }
    }

    /// Bytes of `width` pixels; a row begins with a byte.
    pub(super) fn row_bytes(&self, width: u32) -> usize {
        (width as usize * self.bits_per_pixel()).div_ceil(8)
    }

    /// The row that the bytes mean, laid on a ground; what a line lacks or has too much stays as it was.
    pub(super) fn read(&self, bytes: &[u8], width: u32, ground: Ground, line: &mut RowBuffer) {
        let paper = ground.level();
        match (self, line) {
            (Self::Bits { zero_is_black, one_is_black }, RowBuffer::Bits(words)) => {
                let all = |is: &bool| if *is { u64::MAX } else { 0 };
                pack(bytes, width, all(zero_is_black), all(one_is_black), words);
            }
            (Self::Table { bits: 8, levels: table, .. }, RowBuffer::Grey(levels)) => {
                for (level, byte) in levels.iter_mut().zip(bytes) {
                    *level = of(table, *byte);
                }
            }
            (Self::Table { bits, levels: table, .. }, RowBuffer::Grey(levels)) => {
                let bits = u32::from((*bits).clamp(1, 8));
                for (levels, byte) in levels.chunks_mut(8 / bits as usize).zip(bytes) {
                    let mut rest = *byte;
                    for level in levels {
                        rest = rest.rotate_left(bits);
                        *level = of(table, rest & u8::MAX >> (8 - bits));
                    }
                }
            }
            (
                Self::Samples { channels: Channels::Grey, sample: Sample::Byte, stride: 1 },
                RowBuffer::Grey(levels),
            ) => {
                let count = levels.len().min(bytes.len());
                if let (Some(levels), Some(bytes)) = (levels.get_mut(..count), bytes.get(..count)) {
                    levels.copy_from_slice(bytes);
                }
            }
            (Self::Samples { channels, sample, stride }, RowBuffer::Grey(levels)) => match sample {
                Sample::Byte => grey::<1>(bytes, *stride, *channels, paper, |[byte]| byte, levels),
                Sample::BigEndian16 => {
                    grey(
                        bytes,
                        *stride,
                        *channels,
                        paper,
                        |pair| to_8_bits(u16::from_be_bytes(pair)),
                        levels,
                    );
                }
                Sample::LittleEndian16 => {
                    grey(
                        bytes,
                        *stride,
                        *channels,
                        paper,
                        |pair| to_8_bits(u16::from_le_bytes(pair)),
                        levels,
                    );
                }
            },
            _ => debug_assert!(false, "a line of another depth, or a table that lies on no ground yet"),
        }
    }

    /// Adds the `width` pixels that the bytes mean in colour, laid on a ground; fewer when bytes are missing.
    pub(super) fn colours(&self, bytes: &[u8], width: u32, ground: Ground, to: &mut Vec<[u8; 3]>) {
        let (width, paper) = (width as usize, ground.level());
        match self {
            Self::Bits { zero_is_black, one_is_black } => {
                let level = |is_black: &bool| if *is_black { 0 } else { u8::MAX };
                let levels = [level(zero_is_black), level(one_is_black)];
                to.extend(numbers(bytes, 1).take(width).map(|bit| [levels[usize::from(bit & 1)]; 3]));
            }
            Self::Table { bits, colours, .. } => {
                let colour = |number: u8| colours.get(usize::from(number)).copied().unwrap_or_default();
                to.extend(numbers(bytes, (*bits).clamp(1, 8).into()).take(width).map(colour));
            }
            Self::ClearTable { .. } => debug_assert!(false, "a table that lies on no ground yet"),
            Self::Samples { channels, sample, stride } => match sample {
                Sample::Byte => {
                    let pixels = bytes.chunks_exact((*stride).max(1)).take(width);
                    to.extend(pixels.map(|pixel| channels.colour(paper, |index| pixel.get(index).copied())));
                }
                Sample::BigEndian16 | Sample::LittleEndian16 => {
                    let pixels = bytes.as_chunks().0.chunks_exact((*stride).max(1)).take(width);
                    to.extend(pixels.map(|pixel| {
                        channels
                            .colour(paper, |index| pixel.get(index).copied().map(|pair| sample.value(pair)))
                    }));
                }
            },
        }
    }
}

impl Sample {
    /// A sample of 16 bits as 8.
    fn value(self, pair: [u8; 2]) -> u8 {
        to_8_bits(match self {
            Self::LittleEndian16 => u16::from_le_bytes(pair),
            Self::BigEndian16 | Self::Byte => u16::from_be_bytes(pair),
        })
    }
}

impl Channels {
    /// The colour, on paper of that level, of a pixel whose samples are given by their index.
    fn colour(self, paper: u8, sample: impl Fn(usize) -> Option<u8>) -> [u8; 3] {
        let value = |index: usize| sample(index).unwrap_or(0);
        let grey = [value(0); 3];
        let rgb = || [value(0), value(1), value(2)];
        let on_paper = |[red, green, blue]: [u8; 3], alpha| colour_on(paper, [red, green, blue, alpha]);
        let covering = |colour: [u8; 3], cover: u8| colour.map(|level| uncovered(level, cover, paper));
        match self {
            Self::Grey => grey,
            Self::GreyAlpha => on_paper(grey, value(1)),
            Self::Rgb => rgb(),
            Self::RgbAlpha => on_paper(rgb(), value(3)),
            Self::GreyCover => covering(grey, value(1)),
            Self::RgbCover => covering(rgb(), value(3)),
        }
    }

    /// Colour and alpha of a pixel whose samples are given by their index.
    fn colour_and_alpha(self, sample: impl Fn(usize) -> Option<u8>) -> [u8; 4] {
        let value = |index: usize| sample(index).unwrap_or(0);
        // What was lessened by the cover before it was.
        let whole = |level: u8, cover: u8| {
            let whole = u32::from(level) * 255 / u32::from(cover.max(1));
            u8::try_from(whole).unwrap_or(u8::MAX)
        };
        let ([red, green, blue], alpha) = match self {
            Self::Grey => ([value(0); 3], u8::MAX),
            Self::GreyAlpha => ([value(0); 3], value(1)),
            Self::Rgb => ([value(0), value(1), value(2)], u8::MAX),
            Self::RgbAlpha => ([value(0), value(1), value(2)], value(3)),
            Self::GreyCover => ([whole(value(0), value(1)); 3], value(1)),
            Self::RgbCover => {
                let cover = value(3);
                ([whole(value(0), cover), whole(value(1), cover), whole(value(2), cover)], cover)
            }
        };
        [red, green, blue, alpha]
    }
}

/// A level that was lessened by a cover, with what the cover leaves of paper of that level.
fn uncovered(level: u8, cover: u8, paper: u8) -> u8 {
    // All of white or none: black paper adds nothing.
    level.saturating_add((u8::MAX - cover).min(paper))
}

/// The numbers of `bits` bits, 1, 2, 4 or 8, the leftmost in the highest bits of its byte.
fn numbers(bytes: &[u8], bits: u32) -> impl Iterator<Item = u8> {
    let of_byte = move |byte: &u8| {
        let byte = *byte;
        (1..=8 / bits).map(move |place| byte.rotate_left(place * bits) & u8::MAX >> (8 - bits))
    };
    bytes.iter().flat_map(of_byte)
}

fn of(table: &[u8; 256], index: u8) -> u8 {
    table.get(usize::from(index)).copied().unwrap_or(0)
}

/// 16 bits as 8, to nearest: 65535 / 255 = 257.
fn to_8_bits(sample: u16) -> u8 {
    u8::try_from((u32::from(sample) + 128) / 257).unwrap_or(u8::MAX)
}

/// Bits, the leftmost in the highest bit of its byte, as words, the leftmost in the lowest; `zero` and `one`
/// are what 64 pixels of the value become. The bits right of the picture are cleared.
fn pack(bytes: &[u8], width: u32, zero: u64, one: u64, words: &mut [u64]) {
    let black = |eight: [u8; 8]| {
        let bits = u64::from_be_bytes(eight).reverse_bits();
        bits & one | !bits & zero
    };
    let (whole, rest) = bytes.as_chunks::<8>();
    for (word, eight) in words.iter_mut().zip(whole) {
        *word = black(*eight);
    }
    if let Some(word) = words.get_mut(whole.len()) {
        let mut eight = [0; 8];
        eight.iter_mut().zip(rest).for_each(|(to, from)| *to = *from);
        *word = black(eight);
    }
    let beyond = words.len() * 64 - (width as usize).min(words.len() * 64);
    if let Some(last) = words.last_mut().filter(|_| beyond < 64) {
        *last &= u64::MAX >> beyond;
    }
}

/// Samples of N bytes as levels.
fn grey<const N: usize>(
    bytes: &[u8],
    stride: usize,
    channels: Channels,
    paper: u8,
    value: impl Fn([u8; N]) -> u8,
    levels: &mut [u8],
) {
    let (samples, _) = bytes.as_chunks::<N>();
    let pixels = levels.iter_mut().zip(samples.chunks_exact(stride.max(1)));
    match channels {
        Channels::Grey => pixels.for_each(|(level, pixel)| {
            if let [grey, ..] = pixel {
                *level = value(*grey);
            }
        }),
        Channels::GreyAlpha => pixels.for_each(|(level, pixel)| {
            if let [grey, alpha, ..] = pixel {
                let grey = value(*grey);
                *level = gray_on(paper, [grey, grey, grey, value(*alpha)]);
            }
        }),
        Channels::Rgb => pixels.for_each(|(level, pixel)| {
            if let [red, green, blue, ..] = pixel {
                *level = gray_on(paper, [value(*red), value(*green), value(*blue), 255]);
            }
        }),
        Channels::RgbAlpha => pixels.for_each(|(level, pixel)| {
            if let [red, green, blue, alpha, ..] = pixel {
                *level = gray_on(paper, [value(*red), value(*green), value(*blue), value(*alpha)]);
            }
        }),
        Channels::GreyCover => pixels.for_each(|(level, pixel)| {
            if let [grey, cover, ..] = pixel {
                *level = uncovered(value(*grey), value(*cover), paper);
            }
        }),
        Channels::RgbCover => pixels.for_each(|(level, pixel)| {
            if let [red, green, blue, cover, ..] = pixel {
                let colour = gray_on(paper, [value(*red), value(*green), value(*blue), 255]);
                *level = uncovered(colour, value(*cover), paper);
            }
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::gray_on_white;

    fn levels(pixels: &Pixels, bytes: &[u8], width: u32) -> Vec<u8> {
        let mut line = RowBuffer::new(width, Depth::Grey8);
        pixels.read(bytes, width, Ground::White, &mut line);
        let RowBuffer::Grey(levels) = line else { panic!("grey") };
        levels
    }

    #[test]
    fn bits_change_sides_and_end_at_the_last_column() {
        let mut words = [u64::MAX; 2];
        let bytes = [0x80, 0, 0, 0, 0, 0, 0, 0x01, 0x7f];
        pack(&bytes, 67, 0, u64::MAX, &mut words);
        assert_eq!(words, [1 | 1 << 63, 0b110]);
        pack(&bytes, 67, u64::MAX, 0, &mut words);
        assert_eq!(words, [!(1 | 1 << 63), 0b001]);
        pack(&bytes, 64, 0, u64::MAX, &mut words[..1]);
        assert_eq!(words[0], 1 | 1 << 63);
    }

    #[test]
    fn a_palette_of_black_and_white_is_bits() {
        let mut table = [0; 256];
        table[..2].copy_from_slice(&[255, 0]);
        assert!(matches!(Pixels::table(1, table), Pixels::Bits { zero_is_black: false, one_is_black: true }));
        table[1] = 3;
        let pixels = Pixels::table(1, table);
        assert_eq!(pixels.depth(), Depth::Grey8);
        assert_eq!(
            levels(&pixels, &[0b0100_0000, 0b1000_0000], 9),
            [255, 3, 255, 255, 255, 255, 255, 255, 3]
        );
    }

    #[test]
    fn numbers_of_2_and_4_bits_are_spread_over_the_levels() {
        let two = Pixels::table(2, Pixels::even_levels(2));
        assert_eq!(levels(&two, &[0b00_01_10_11, 0b11_00_00_00], 5), [0, 85, 170, 255, 255]);
        let four = Pixels::table(4, Pixels::even_levels(4));
        assert_eq!(levels(&four, &[0x0f, 0x30], 3), [0, 255, 51]);
        assert_eq!(Pixels::even_levels(8)[200], 200);
    }

    fn colours(pixels: &Pixels, bytes: &[u8], width: u32) -> Vec<[u8; 3]> {
        let mut colours = Vec::new();
        pixels.colours(bytes, width, Ground::White, &mut colours);
        colours
    }

    #[test]
    fn every_kind_of_pixel_has_a_colour() {
        let byte =
            |channels| Pixels::Samples { channels, sample: Sample::Byte, stride: 1 + channels as usize % 4 };
        assert_eq!(colours(&byte(Channels::Grey), &[7, 9], 2), [[7; 3], [9; 3]]);
        assert_eq!(colours(&byte(Channels::GreyAlpha), &[0, 51], 1), [[204; 3]]);
        let rgb = Pixels::Samples { channels: Channels::Rgb, sample: Sample::Byte, stride: 4 };
        assert_eq!(colours(&rgb, &[1, 2, 3, 9, 4, 5, 6, 9], 2), [[1, 2, 3], [4, 5, 6]]);
        let alpha =
            Pixels::Samples { channels: Channels::RgbAlpha, sample: Sample::LittleEndian16, stride: 4 };
        assert_eq!(colours(&alpha, &[255, 255, 0, 0, 0, 0, 51, 51], 1), [[255, 204, 204]]);
        let cover = Pixels::Samples { channels: Channels::RgbCover, sample: Sample::Byte, stride: 4 };
        assert_eq!(colours(&cover, &[51, 0, 0, 51], 1), [[255, 204, 204]]);
        let bits = Pixels::Bits { zero_is_black: false, one_is_black: true };
        assert_eq!(colours(&bits, &[0b0100_0000], 3), [[255; 3], [0; 3], [255; 3]]);
        let mut palette = [[0, 0, 0, 255]; 256];
        palette[1] = [200, 30, 40, 255];
        palette[2] = [255, 0, 0, 51];
        let mut two = Pixels::palette(2, palette);
        two.lay_on(Ground::White);
        assert_eq!(colours(&two, &[0b00_01_10_00, 0b01_00_00_00], 5)[1..3], [[200, 30, 40], [255, 204, 204]]);
        assert_eq!(colours(&two, &[0b00_01_10_00, 0b01_00_00_00], 5)[4], [200, 30, 40]);
    }

    #[test]
    fn colours_with_the_levels_of_a_grey_scale_stay_colours() {
        // Red one lighter and blue three darker: 299 − 3 · 114 = −43, less than half a level.
        let scale: [u8; 256] = Pixels::even_levels(8);
        let tinted = scale.map(|level| match level {
            3..=254 => [level + 1, level, level - 3, 255],
            grey => [grey, grey, grey, 255],
        });
        assert_eq!(tinted.map(gray_on_white), scale);
        assert_eq!(colours(&Pixels::palette(8, tinted), &[100, 0], 2), [[101, 100, 97], [0, 0, 0]]);
        let grey = Pixels::palette(8, scale.map(|level| [level, level, level, 255]));
        assert!(matches!(grey, Pixels::Samples { .. }));
    }

    #[test]
    fn a_cover_is_not_applied_twice() {
        // Half covered black: as alpha 0.5 of black, as cover black lessened to black; both show level 127.
        let alpha = Pixels::Samples { channels: Channels::RgbAlpha, sample: Sample::Byte, stride: 4 };
        let cover = Pixels::Samples { channels: Channels::RgbCover, sample: Sample::Byte, stride: 4 };
        assert_eq!(levels(&alpha, &[0, 0, 0, 128], 1), [127]);
        assert_eq!(levels(&cover, &[0, 0, 0, 128], 1), [127]);
        // Half covered white is white: 128 are left of the 255.
        assert_eq!(levels(&alpha, &[255, 255, 255, 128], 1), [255]);
        assert_eq!(levels(&cover, &[128, 128, 128, 128], 1), [255]);
    }

    #[test]
    fn samples_of_16_bits_are_read_in_either_order() {
        let big = Pixels::Samples { channels: Channels::Grey, sample: Sample::BigEndian16, stride: 1 };
        let little = Pixels::Samples { channels: Channels::Grey, sample: Sample::LittleEndian16, stride: 2 };
        assert_eq!(levels(&big, &[0xc8, 0xc8, 0xff, 0xff], 2), [200, 255]); // 200 · 257 = 0xc8c8
        // 51200 / 257 = 199.2.
        assert_eq!(levels(&little, &[0x00, 0xc8, 9, 9, 0xff, 0xff, 9, 9], 2), [199, 255]);
    }
}
