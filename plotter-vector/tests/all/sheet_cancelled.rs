//! Tracing of a sheet by rows stops where it is asked to, and leaves its source fit to begin again.

use core::ops::ControlFlow;
use plotter_vector::{
    Bitmap, DecodeError, Ours, Progress, TracedSheet, Vectorizer,
    picture::{BitmapRows, Depth, Row, RowSource},
    trace::SheetError,
};

/// Rows of the sheet; a band has 40 of them, so that there are many bands.
const HEIGHT_PX: u32 = 1600;
const BAND_ROWS: u32 = 40;

/// A source that counts what it gives.
struct Counted<'a> {
    rows: BitmapRows<'a>,
    given: u32,
}

impl RowSource for Counted<'_> {
    fn width(&self) -> u32 {
        self.rows.width()
    }

    fn height(&self) -> u32 {
        self.rows.height()
    }

    fn depth(&self) -> Depth {
        self.rows.depth()
    }

    fn next_row(&mut self) -> Result<Option<Row<'_>>, DecodeError> {
        self.given += 1;
        self.rows.next_row()
    }

    fn rewind(&mut self) -> Result<(), DecodeError> {
        self.rows.rewind()
    }
}

fn ladder() -> Bitmap {
    let line =
        |y: u32| if y % 50 < 4 { ".########################.\n" } else { ".####................####.\n" };
    Bitmap::from_picture(&(0..HEIGHT_PX).map(line).collect::<String>()).unwrap()
}

/// Traces, with errors, up to a part of the work; how many rows were read, and what came of it.
fn traced_to(source: &mut Counted<'_>, most: f64) -> (u32, Result<TracedSheet, SheetError>) {
    source.given = 0;
    let mut stop = |done: f64| if done > most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let vectorizer = Vectorizer::from(Ours::default().with_band_rows(BAND_ROWS));
    let sheet = vectorizer.vectorize_rows_with_errors(source, &mut Progress::new(&mut stop));
    (source.given, sheet)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_sheet_is_stopped_between_any_two_bands() {
    let ink = ladder();
    let mut source = Counted { rows: BitmapRows::new(&ink), given: 0 };
    let (all_rows, whole) = traced_to(&mut source, 2.0);
    let whole = whole.unwrap();
    assert!(whole.drawing.strokes().len() > 20);
    let mut before = 0;
    // In the survey, in the strokes (0.1 to 0.7 of the work) and in the measuring of the errors.
    for part in [0.0, 0.05, 0.12, 0.2, 0.3, 0.4, 0.5, 0.6, 0.69, 0.75, 0.9, 0.99] {
        let (rows, stopped) = traced_to(&mut source, part);
        let Err(SheetError::Cancelled(cancelled)) = stopped else { panic!("{part}: {stopped:?}") };
        assert!(cancelled.done > part && cancelled.done < part + 0.02, "{part}: {}", cancelled.done);
        // Not a row more was read than up to there: each further part reads more.
        assert!(rows > before && rows < all_rows, "{part}: {rows} of {all_rows} rows");
        before = rows;
    }
    // The same source again, as if nothing had been.
    let (rows, again) = traced_to(&mut source, 2.0);
    assert_eq!((rows, again.unwrap()), (all_rows, whole));
}
