//! Long straight lines take as much memory on a long sheet as on a short one.
#![cfg(target_os = "linux")]

use crate::own_process::{is_alone, peak_kib};
use plotter_vector::{
    DecodeError, Progress, Vectorizer,
    picture::{Depth, Row, RowSource},
};

/// Width of the sheets, px, and from one line to the next; the pen is 4 px wide.
const WIDTH_PX: u32 = 1024;
const PITCH_PX: u32 = 32;

/// Most memory that a sheet ten times as long may add, KiB: 32 lines of 144 000 places more would take 54 MB.
/// How the allocator packs what it is given makes some MB of difference from run to run, and with the number
/// of threads.
const MOST_KIB: u64 = 16 << 10;

/// Upright lines from the first row to the last.
struct Lines {
    height: u32,
    next: u32,
    row: Vec<u64>,
}

impl Lines {
    fn new(height: u32) -> Self {
        Self { height, next: 0, row: vec![0; WIDTH_PX as usize / 64] }
    }
}

impl RowSource for Lines {
    fn width(&self) -> u32 {
        WIDTH_PX
    }

    fn height(&self) -> u32 {
        self.height
    }

    fn depth(&self) -> Depth {
        Depth::Bits1
    }

    fn next_row(&mut self) -> Result<Option<Row<'_>>, DecodeError> {
        if self.next >= self.height {
            return Ok(None);
        }
        self.row.fill(0x0000_00f0_0000_00f0);
        self.next += 1;
        Ok(Some(Row::Bits(&self.row)))
    }

    fn rewind(&mut self) -> Result<(), DecodeError> {
        self.next = 0;
        Ok(())
    }
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn memory_does_not_grow_with_the_length_of_the_sheet() -> Result<(), Box<dyn std::error::Error>> {
    if !is_alone("sheet_memory::memory_does_not_grow_with_the_length_of_the_sheet") {
        return Ok(());
    }
    let mut peaks = Vec::new();
    for height in [16_000, 160_000] {
        let sheet = Vectorizer::default().vectorize_rows(&mut Lines::new(height), &mut Progress::silent())?;
        let lines = (WIDTH_PX / PITCH_PX) as usize;
        assert_eq!((sheet.drawing.strokes().len(), sheet.drawing.vertices()), (lines, 2 * lines));
        peaks.push(peak_kib());
    }
    assert!(peaks[0] > 0, "the system does not tell");
    assert!(peaks[1] - peaks[0] < MOST_KIB, "{peaks:?} KiB");
    Ok(())
}
