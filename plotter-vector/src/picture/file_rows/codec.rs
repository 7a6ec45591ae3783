//! [`Codec`]: a block of a TIFF, decompressed as it is read.

use super::fax_lines::FaxLines;
use flate2::bufread::ZlibDecoder;
use std::io::{BufRead, Error, ErrorKind, Read, Result};
use weezl::{BitOrder, LzwStatus, decode};

/// How the blocks of a TIFF are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compression {
    None,
    PackBits,
    Lzw,
    Deflate,
    Group4,
}

/// A block, decompressed as it is read: the memory is that of the codec, however much comes out.
#[derive(Debug)]
pub(super) enum Codec<B> {
    None(B),
    PackBits(PackBits<B>),
    Lzw(Box<Lzw<B>>),
    Deflate(Box<ZlibDecoder<B>>),
    Group4(FaxLines<B>),
}

impl<B: BufRead> Codec<B> {
    /// A block of pixels `width` px wide.
    pub(super) fn new(compression: Compression, block: B, width: u32) -> Result<Self> {
        Ok(match compression {
            Compression::None => Self::None(block),
            Compression::PackBits => Self::PackBits(PackBits { block, run: Run::Over }),
            Compression::Lzw => Self::Lzw(Box::new(Lzw::new(block))),
            Compression::Deflate => Self::Deflate(Box::new(ZlibDecoder::new(block))),
            Compression::Group4 => Self::Group4(FaxLines::new(block, width)?),
        })
    }
}

impl<B: BufRead> Read for Codec<B> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        match self {
            Self::None(block) => block.read(buffer),
            Self::PackBits(block) => block.read(buffer),
            Self::Lzw(block) => block.read(buffer),
            Self::Deflate(block) => block.read(buffer),
            Self::Group4(block) => block.read(buffer),
        }
    }
}

/// The run-length code of the Macintosh: a count n, then n + 1 bytes for 0 to 127, 1 − n times one byte for
/// −127 to −1; −128 is nothing.
///
/// Source: TIFF revision 6.0 (1992), section 9.
#[derive(Debug)]
pub(super) struct PackBits<B> {
    block: B,
    run: Run,
}

#[derive(Debug)]
enum Run {
    Over,
    Copy { left: usize },
    Repeat { left: usize, byte: u8 },
}

impl<B: BufRead> PackBits<B> {
    fn next_byte(&mut self) -> Result<Option<u8>> {
        let byte = self.block.fill_buf()?.first().copied();
        self.block.consume(usize::from(byte.is_some()));
        Ok(byte)
    }
}

impl<B: BufRead> Read for PackBits<B> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        while let Run::Over = self.run {
            let Some(count) = self.next_byte()? else { return Ok(0) };
            self.run = match count.cast_signed() {
                copied @ 0.. => Run::Copy { left: usize::from(copied.unsigned_abs()) + 1 },
                i8::MIN => Run::Over,
                repeated => {
                    let Some(byte) = self.next_byte()? else { return Ok(0) };
                    Run::Repeat { left: usize::from(repeated.unsigned_abs()) + 1, byte }
                }
            };
        }
        let (read, left) = match &mut self.run {
            Run::Over => return Ok(0),
            Run::Copy { left } => {
                let length = buffer.len().min(*left);
                let read = self.block.read(buffer.get_mut(..length).unwrap_or(&mut []))?;
                // The file ends within a run: the reader of the row sees that it is short.
                if read == 0 && length > 0 {
                    *left = 1;
                    return Ok(0);
                }
                (read, left)
            }
            Run::Repeat { left, byte } => {
                let length = buffer.len().min(*left);
                buffer.get_mut(..length).unwrap_or(&mut []).fill(*byte);
                (length, left)
            }
        };
        *left -= read;
        if *left == 0 {
            self.run = Run::Over;
        }
        Ok(read)
    }
}

/// The LZW of TIFF: highest bit first, codes lengthened one early.
///
/// Source: TIFF revision 6.0 (1992), section 13.
pub(super) struct Lzw<B> {
    block: B,
    decoder: decode::Decoder,
}

impl<B> core::fmt::Debug for Lzw<B> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Lzw").finish_non_exhaustive()
    }
}

impl<B> Lzw<B> {
    fn new(block: B) -> Self {
        let settings = decode::Configuration::with_tiff_size_switch(BitOrder::Msb, 8);
        Self { block, decoder: settings.with_yield_on_full_buffer(true).build() }
    }
}

impl<B: BufRead> Read for Lzw<B> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        loop {
            let result = self.decoder.decode_bytes(self.block.fill_buf()?, buffer);
            self.block.consume(result.consumed_in);
            match result.status {
                Ok(LzwStatus::Ok) if result.consumed_out == 0 && !buffer.is_empty() => {}
                Ok(LzwStatus::Ok | LzwStatus::Done) => return Ok(result.consumed_out),
                Ok(LzwStatus::NoProgress) => return Ok(0),
                Err(error) => return Err(Error::new(ErrorKind::InvalidData, error)),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    /// What comes out when the block is read a few bytes at a time, as from a slow disk.
    fn decoded(compression: Compression, block: &[u8], length: usize) -> Result<Vec<u8>> {
        let block = std::io::BufReader::with_capacity(3, block);
        let mut codec = Codec::new(compression, block, 8)?;
        let mut out = vec![0; length];
        for part in out.chunks_mut(5) {
            codec.read_exact(part)?;
        }
        Ok(out)
    }

    #[test]
    fn packbits_of_the_specification_are_unpacked() {
        // The example of TIFF 6.0, section 9.
        let packed =
            [0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0xfd, 0xaa, 0x03, 0x80, 0x00, 0x2a, 0x22, 0xf7, 0xaa];
        let mut plain =
            vec![0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0x22];
        plain.extend([0xaa; 10]);
        assert_eq!(decoded(Compression::PackBits, &packed, 24).unwrap(), plain);
        assert_eq!(decoded(Compression::PackBits, &[0x80, 0x80, 0x00, 7], 1).unwrap(), [7]);
    }

    #[test]
    fn every_compression_comes_back_and_cut_off_is_an_error() {
        let plain: Vec<u8> = (0..5000_u32).map(|n| (n * n / 700).to_le_bytes()[0]).collect();
        let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        zlib.write_all(&plain).unwrap();
        let lzw = weezl::encode::Encoder::with_tiff_size_switch(BitOrder::Msb, 8).encode(&plain).unwrap();
        let packed: Vec<u8> = plain
            .chunks(128)
            .flat_map(|run| [&[u8::try_from(run.len() - 1).unwrap()], run].concat())
            .collect();
        let blocks = [
            (Compression::None, plain.clone()),
            (Compression::PackBits, packed),
            (Compression::Lzw, lzw),
            (Compression::Deflate, zlib.finish().unwrap()),
        ];
        for (compression, block) in blocks {
            assert_eq!(decoded(compression, &block, plain.len()).unwrap(), plain, "{compression:?}");
            for length in [0, 1, 2, block.len() / 2, block.len() - 20] {
                let cut = decoded(compression, &block[..length], plain.len());
                assert!(cut.is_err(), "{compression:?}, {length} bytes");
            }
        }
    }
}
