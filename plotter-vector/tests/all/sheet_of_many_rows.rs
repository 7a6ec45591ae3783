//! A banner far longer than a picture may be wide: what is drawn on it is the same wherever it lies.

use plotter_vector::{
    DecodeError, Order, Ours, Progress, PxPoint, Vectorizer,
    order::OrderEffort,
    picture::{Depth, MAX_SHEET_ROWS, MAX_SIDE_PX, Row, RowSource},
    trace::SheetError,
};

const WIDTH_PX: u32 = 64;
/// From one figure to the next: strokes are cut at every 4096th row.
const PITCH_PX: u32 = 4 * 4096;
/// Rows that each figure lies in.
const FIGURE: core::ops::Range<u32> = 900..1100;

/// How far the same vertex of two figures may be apart, px: coordinates of 400 000 px are rounded to 6e-11
/// px.
const ROUNDING_PX: f64 = 1e-6;

/// A line 3 px wide from the first row to the last, a slanted one and a frame at every `PITCH_PX` rows.
struct Banner {
    width: u32,
    height: u32,
    next: u32,
    row: [u64; 1],
}

impl Banner {
    fn new(height: u32) -> Self {
        Self { width: WIDTH_PX, height, next: 0, row: [0] }
    }
}

impl RowSource for Banner {
    fn width(&self) -> u32 {
        self.width
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
        let y = self.next % PITCH_PX;
        self.row = [0b111 << 4];
        if FIGURE.contains(&y) {
            let slanted = 14 + (y - FIGURE.start) / 12;
            let inner = (FIGURE.start + 3..FIGURE.end - 3).contains(&y);
            self.row[0] |= 0b111 << slanted | if inner { 0b111 << 40 | 0b111 << 58 } else { 0x1f_ffff << 40 };
        }
        self.next += 1;
        Ok(Some(Row::Bits(&self.row)))
    }

    fn rewind(&mut self) -> Result<(), DecodeError> {
        self.next = 0;
        Ok(())
    }
}

fn strokes(height: u32) -> Vec<Vec<PxPoint>> {
    let order = Order::default().with_effort(OrderEffort::None);
    let vectorizer = Vectorizer::from(Ours::default().with_order(order));
    let sheet = vectorizer.vectorize_rows(&mut Banner::new(height), &mut Progress::silent()).unwrap();
    assert_eq!(sheet.pen_px, Some(3));
    sheet.drawing.strokes().map(<[PxPoint]>::to_vec).collect()
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_banner_has_the_strokes_of_its_pieces() {
    let height = 24 * PITCH_PX + 7000;
    assert!(height > 3 * MAX_SIDE_PX);
    let piece = strokes(7000);
    let whole = strokes(height);
    let is_long = |stroke: &&Vec<PxPoint>| stroke.iter().all(|at| at.x < 10.0);
    let long: Vec<_> = whole.iter().filter(is_long).collect();
    assert_eq!((long.len(), long[0].len()), (1, 2));
    // Each end lies within the pen's width of the border.
    assert!(long[0][0].y < 3.0 && long[0][1].y > f64::from(height) - 3.0, "{long:?}");
    // In reading order.
    let figures = |all: &[Vec<PxPoint>]| {
        all.iter().filter(|stroke| !is_long(stroke)).cloned().collect::<Vec<Vec<PxPoint>>>()
    };
    let (own, all) = (figures(&piece), figures(&whole));
    assert_eq!((own.len(), all.len()), (2, 2 * 25));
    for (index, strokes) in (0..).zip(all.chunks(2)) {
        let down = f64::from(index * PITCH_PX);
        for (one, other) in own.iter().zip(strokes) {
            assert_eq!(one.len(), other.len(), "figure {index}");
            let far =
                |(one, other): (&PxPoint, &PxPoint)| one.distance(PxPoint::new(other.x, other.y - down));
            assert!(one.iter().zip(other).map(far).fold(0.0, f64::max) < ROUNDING_PX, "figure {index}");
        }
    }
}

#[test]
fn more_rows_or_columns_than_can_be_told_apart_are_refused() {
    let mut high = Banner::new(MAX_SHEET_ROWS + 1);
    let mut wide = Banner { width: MAX_SIDE_PX + 1, ..Banner::new(5) };
    for banner in [&mut high, &mut wide] {
        let (width, height) = (banner.width(), banner.height());
        let error = Vectorizer::default().vectorize_rows(banner, &mut Progress::silent()).unwrap_err();
        assert_eq!(error, SheetError::Source(DecodeError::TooLong { width, height }));
        assert_eq!(
            error.to_string(),
            format!(
                "a picture of {width} x {height} px is too large: at most 131072 px wide and 4194304 px high; \
                 turn a wide one by 90 degrees, scan with fewer dots per inch, or cut it into sheets"
            )
        );
    }
}
