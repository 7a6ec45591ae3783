//! Strokes far outside any sheet are cut off, and the rest is drawn.

use super::*;
use crate::stroke::PxPoint;

/// Of a sheet of 100 x 100 mm, in mm.
fn read(content: &str) -> SvgDrawing {
    let text = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100'>\
         <g fill='none' stroke='#000'>{content}<path d='M1 1H2'/></g></svg>"
    );
    read_svg(text.as_bytes(), &SvgOptions::default()).unwrap_or_else(|error| panic!("{content}: {error}"))
}

/// Strokes but the last, which is there in each file, as places in whole mm; how many shapes are cut.
fn drawn(content: &str) -> (String, usize) {
    let read = read(content);
    let mm = |px: f64| libm::round(px * MM_PER_INCH / PX_PER_INCH) + 0.0;
    let mut strokes: Vec<String> = (read.drawing.strokes())
        .map(|stroke| {
            stroke.iter().map(|at| format!("{},{}", mm(at.x), mm(at.y))).collect::<Vec<_>>().join(" ")
        })
        .collect();
    assert_eq!(strokes.pop().as_deref(), Some("1,1 2,1"), "{content}");
    (strokes.join(" | "), read.left_out.far)
}

#[test]
fn lines_are_cut_277_m_from_the_corner_of_the_sheet() {
    for (content, expected, far) in [
        ("<path d='M0 50H1e9'/>", "0,50 277436,50", 1),
        ("<path d='M-1e12 50H1e12'/>", "-277436,50 277436,50", 1),
        ("<path d='M5 5H300000V7H5'/>", "5,5 277436,5 | 277436,7 5,7", 1),
        // Closed: it goes on over its beginning.
        ("<path d='M5 5H300000V7H5Z'/>", "277436,7 5,7 5,5 277436,5", 1),
        // All around the sheet, but for one side.
        ("<rect x='-1e8' y='50' width='2e8' height='1e8'/>", "-277436,50 277436,50", 1),
        ("<rect x='-1e8' y='-1e8' width='2e8' height='2e8'/>", "", 1),
        ("<path d='M1e9 5H1e10'/><path d='M3 3H4'/>", "3,3 4,3", 1),
        // Beyond any number, by its transforms.
        ("<g transform='scale(1e12)'><path transform='scale(1e12)' d='M0 0L1e12 0'/></g>", "0,0 277436,0", 1),
        ("<path transform='translate(5e5 0)' d='M0 0H5'/>", "", 1),
        ("<path d='M0 50H277000'/>", "0,50 277000,50", 0),
        ("<path stroke-dasharray='200000' d='M0 50H1e9'/>", "0,50 200000,50", 1),
    ] {
        assert_eq!(drawn(content), (expected.to_owned(), far), "{content}");
    }
}

/// A circle of a thousand kilometres passes the sheet as a line nearly straight, in few chords.
#[test]
fn curves_are_cut_as_well_and_keep_the_tolerance_where_they_are_drawn() {
    let radius_px = 1e9 * PX_PER_INCH / MM_PER_INCH;
    for content in
        ["<circle cx='1e9' cy='0' r='1e9'/>", "<circle cx='1e9' cy='0' r='1e9' stroke-dasharray='1e6'/>"]
    {
        let read = read(content);
        assert_eq!(read.left_out.far, 1);
        let places: Vec<PxPoint> =
            read.drawing.strokes().take(read.drawing.strokes().len() - 1).flatten().copied().collect();
        assert!(places.len() > 2 && places.len() < 5_000, "{}", places.len());
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for at in &places {
            // Cubic curves in single precision stand for the circle: 0.03 % of the radius is what they may be
            // off at most, and at its ends they are on it.
            assert!(at.x.abs() <= 2.0 * at.y * at.y / radius_px + 1.0, "{at:?}");
            (least, most) = (least.min(at.y), most.max(at.y));
        }
        assert!(least < -1_000_000.0 && most > 1_000_000.0, "{least} {most}");
    }
}
