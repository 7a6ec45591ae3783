//! What the targets share.

/// Whether a picture is small enough to be tried many times a second, as far as its header can tell.
pub fn is_small(bytes: &[u8]) -> bool {
    const MOST_PIXELS: u64 = 1 << 16;
    let size = |(width, height): (u32, u32)| u64::from(width) * u64::from(height);
    // What is decoded whole is decoded when it is opened: its size must be known before.
    if bytes.starts_with(b"\xff\xd8") || bytes.starts_with(b"\x89PNG") || bytes.starts_with(b"P7") {
        let reader = image::ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format();
        let dimensions = reader.ok().and_then(|reader| reader.into_dimensions().ok());
        return dimensions.is_none_or(|dimensions| size(dimensions) <= MOST_PIXELS);
    }
    use plotter_vector::{FileRows, picture::RowSource};
    let scan = FileRows::new(std::io::Cursor::new(bytes));
    scan.map_or(true, |scan| size((scan.width(), scan.height())) <= MOST_PIXELS)
}
