//! Lines one pixel wide on a sheet too large for one bitmap.

use plotter_vector::{
    DecodeError, Progress, Vectorizer,
    picture::{Depth, MAX_PIXELS, Row, RowSource},
};

const WIDTH_PX: u32 = 1 << 17;
const HEIGHT_PX: u32 = 2100;

/// Level lines in rows 100, 700, 1300 and 1900, an upright one and a diagonal from the first row to the last.
struct Hairlines {
    next: u32,
    row: Vec<u64>,
}

impl Hairlines {
    fn ink(&mut self, from: u32, to: u32) {
        for x in from..to {
            if let Some(word) = self.row.get_mut((x / 64) as usize) {
                *word |= 1 << (x % 64);
            }
        }
    }
}

impl RowSource for Hairlines {
    fn width(&self) -> u32 {
        WIDTH_PX
    }

    fn height(&self) -> u32 {
        HEIGHT_PX
    }

    fn depth(&self) -> Depth {
        Depth::Bits1
    }

    fn next_row(&mut self) -> Result<Option<Row<'_>>, DecodeError> {
        let y = self.next;
        if y >= HEIGHT_PX {
            return Ok(None);
        }
        self.row.fill(0);
        if y % 600 == 100 {
            self.ink(1000, 120_000);
        }
        self.ink(60_000, 60_001);
        self.ink(2_000 + y, 2_001 + y);
        self.next += 1;
        Ok(Some(Row::Bits(&self.row)))
    }

    fn rewind(&mut self) -> Result<(), DecodeError> {
        self.next = 0;
        Ok(())
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn hairlines_of_a_huge_sheet_are_followed() -> Result<(), Box<dyn std::error::Error>> {
    assert!(u64::from(WIDTH_PX) * u64::from(HEIGHT_PX) > MAX_PIXELS);
    let mut sheet = Hairlines { next: 0, row: vec![0; (WIDTH_PX / 64) as usize] };
    let traced = Vectorizer::default().vectorize_rows_with_errors(&mut sheet, &mut Progress::silent())?;
    let errors = traced.errors.unwrap_or_default().report;
    assert_eq!(traced.pen_px, Some(1));
    // Four level lines, the upright one, the diagonal; where lines cross one of them may be drawn in two
    // strokes.
    assert!((6..=10).contains(&traced.drawing.strokes().len()), "{}", traced.drawing.strokes().len());
    let length_px = 4.0 * 118_999.0 + 2099.0 + 2099.0 * 2.0_f64.sqrt();
    assert!((traced.drawing.pen_down_px() - length_px).abs() < 20.0, "{}", traced.drawing.pen_down_px());
    assert!(errors.max_px <= 0.5 + 1e-9, "{} px", errors.max_px);
    Ok(())
}
