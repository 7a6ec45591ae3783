//! Files and standard streams as tools read and write them: an error names the file.

use super::command::{at, print_bytes};
use std::io::Read;
use std::path::Path;

/// Largest file that is read, bytes: an uncompressed picture of the greatest size has half of this.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// What stands for the standard input and output in place of a file.
pub fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}

/// Reads a file; an error names it.
///
/// # Errors
///
/// The file and why it could not be read, or that it is longer than 1 GiB.
pub fn read_file(path: &Path) -> Result<Vec<u8>, String> {
    if path.is_dir() {
        return Err(at(path, &"this is a folder: name a file in it"));
    }
    let file = std::fs::File::open(path).map_err(|error| at(path, &format!("cannot be read: {error}")))?;
    read_all(file).map_err(|error| at(path, &error))
}

/// Reads the standard input to its end.
///
/// # Errors
///
/// Why it could not be read, or that it is longer than 1 GiB.
pub fn read_input() -> Result<Vec<u8>, String> {
    read_all(std::io::stdin().lock())
}

fn read_all(reader: impl Read) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    // One byte more than allowed tells a file that is too long, even one without an end.
    let read = reader.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(|error| format!("cannot be read: {error}"))?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(format!("more than {} MiB; save it as PNG", MAX_FILE_BYTES >> 20));
    }
    Ok(bytes)
}

/// Writes a file, or the standard output for `-`; an error names it.
///
/// # Errors
///
/// The file and why it could not be written.
pub fn write_output(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), String> {
    if is_standard(path) { print_bytes(contents.as_ref()) } else { write_file(path, contents) }
}

/// Writes a file; an error names it.
///
/// # Errors
///
/// The file and why it could not be written; `-`, which would be a file of that name.
pub fn write_file(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), String> {
    if is_standard(path) {
        return Err(
            "-: the standard output has the figures already; name a file, as ./- for one of that name".into(),
        );
    }
    std::fs::write(path, contents).map_err(|error| at(path, &format!("cannot be written: {error}")))
}
