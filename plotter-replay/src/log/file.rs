//! Logs as files; packed with gzip if the name ends in `.gz`.

use super::{Header, ReadError, Reader, WriteError, Writer};
use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

/// A [`Reader`] of a file.
pub type FileReader = Reader<Box<dyn BufRead>>;
/// A [`Writer`] of a file.
pub type FileWriter = Writer<LogFile>;

/// A file that a log is written to.
#[derive(Debug)]
pub enum LogFile {
    /// Text as it is.
    Plain(File),
    /// Packed; what was flushed can be unpacked even if the end is missing.
    Gzip(GzEncoder<File>),
}

impl Write for LogFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Plain(file) => file.write(bytes),
            Self::Gzip(packer) => packer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Plain(file) => file.flush(),
            Self::Gzip(packer) => packer.flush(),
        }
    }
}

/// Creates a log file, or empties it; a name that ends in `.gz` is packed.
///
/// # Errors
///
/// [`WriteError::Sink`] if the file cannot be written.
pub fn create(path: &Path, header: &Header) -> Result<FileWriter, WriteError> {
    let file = File::create(path).map_err(|error| WriteError::Sink { message: error.to_string() })?;
    let file = if is_packed(path) {
        LogFile::Gzip(GzEncoder::new(file, Compression::default()))
    } else {
        LogFile::Plain(file)
    };
    Writer::new(file, header)
}

/// Opens a log file; a name that ends in `.gz` is unpacked on the way.
///
/// # Errors
///
/// [`ReadError`] if the file cannot be read or is no log.
pub fn open(path: &Path) -> Result<FileReader, ReadError> {
    let file = File::open(path).map_err(|error| ReadError::Source { message: error.to_string() })?;
    Reader::new(if is_packed(path) {
        Box::new(BufReader::new(MultiGzDecoder::new(BufReader::new(file))))
    } else {
        Box::new(BufReader::new(file))
    })
}

fn is_packed(path: &Path) -> bool {
    path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("gz"))
}
