//! [`FileView`]: several places in one file at once.

use super::one_line;
use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom};
use std::sync::{Arc, Mutex, MutexGuard};

/// A reader with a place of its own in a file that is shared: the decoders keep their reader for themselves,
/// and this way the next pass has one too.
#[derive(Debug)]
pub(super) struct FileView<R> {
    file: Arc<Mutex<R>>,
    at: u64,
}

impl<R> Clone for FileView<R> {
    fn clone(&self) -> Self {
        Self { file: Arc::clone(&self.file), at: self.at }
    }
}

impl<R> FileView<R> {
    /// The start of a file.
    pub(super) fn new(file: R) -> Self {
        Self { file: Arc::new(Mutex::new(file)), at: 0 }
    }

    /// The same file at another place.
    pub(super) fn at(&self, at: u64) -> Self {
        Self { file: Arc::clone(&self.file), at }
    }

    fn lock(&self) -> Result<MutexGuard<'_, R>> {
        self.file.lock().map_err(|_| Error::other("another reader of the file has failed"))
    }
}

impl<R: Read + Seek> Read for FileView<R> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let count = {
            let mut file = self.lock()?;
            file.seek(SeekFrom::Start(self.at))?;
            file.read(buffer)?
        };
        self.at = self.at.saturating_add(count as u64);
        Ok(count)
    }
}

/// Fills `buffer` from a reader, or says why not.
pub(super) fn fill(reader: &mut impl Read, buffer: &mut [u8]) -> core::result::Result<(), String> {
    reader.read_exact(buffer).map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => "it ends here".into(),
        _ => one_line(&error),
    })
}

impl<R: Seek> Seek for FileView<R> {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        let at = match to {
            SeekFrom::Start(at) => Some(at),
            SeekFrom::Current(by) => self.at.checked_add_signed(by),
            SeekFrom::End(by) => {
                let at = self.lock()?.seek(SeekFrom::End(by))?;
                Some(at)
            }
        };
        self.at = at.ok_or_else(|| Error::other("a place before the start of the file"))?;
        Ok(self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn each_view_keeps_its_place() {
        let mut one = FileView::new(Cursor::new(b"abcdef"));
        let mut two = one.at(3);
        let read = |view: &mut FileView<_>| {
            let mut byte = [0];
            view.read_exact(&mut byte).unwrap();
            char::from(byte[0])
        };
        let letters: String = (0..3).flat_map(|_| [read(&mut one), read(&mut two)]).collect();
        assert_eq!(letters, "adbecf");
        assert_eq!(one.seek(SeekFrom::End(-1)).unwrap(), 5);
        assert_eq!(read(&mut one), 'f');
        assert!(one.seek(SeekFrom::Current(-7)).is_err());
    }
}
