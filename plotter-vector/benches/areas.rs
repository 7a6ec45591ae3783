//! Time to split, outline and hatch areas, on a sheet of fine lines without areas, with a few, and all areas.
#![allow(missing_docs, reason = "criterion's macros make undocumented items")]
#![allow(clippy::unwrap_used, reason = "a benchmark may stop at once")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use plotter_vector::{
    Bitmap, Pixel,
    areas::{AreaStyle, Areas, Hatch, Outlines, split_by_width},
};

/// Width and height of the sheet, px: 4 megapixels of an A1 sheet at 600 dots per inch.
const SIDE_PX: u32 = 2048;

/// Lines of 6 px, every 256 px across and every 512 px down (about 5 % ink with the slopes between them), and
/// `discs` discs of 120 px a row and column.
fn sheet(discs: u32) -> Bitmap {
    let mut sheet = Bitmap::new(SIDE_PX, SIDE_PX).unwrap();
    for y in 0..SIDE_PX {
        for x in 0..SIDE_PX {
            let line = y % 256 < 6 || x % 512 < 6 || (x + y / 3) % 700 < 6;
            let cell = SIDE_PX / discs.max(1);
            let (dx, dy) = ((x % cell).abs_diff(cell / 2), (y % cell).abs_diff(cell / 2));
            let disc = discs > 0 && dx * dx + dy * dy < 60 * 60;
            sheet.set(Pixel::new(x, y), line || disc);
        }
    }
    sheet
}

fn areas(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("areas");
    group.throughput(Throughput::Elements(u64::from(SIDE_PX) * u64::from(SIDE_PX)));
    group.sample_size(20);
    for (name, discs) in [("no areas", 0), ("16 areas", 4), ("196 areas", 14)] {
        let ink = sheet(discs);
        group.bench_function(format!("split, {name}"), |bench| bench.iter(|| split_by_width(&ink, 24)));
        let thick = split_by_width(&ink, 24).thick;
        let count = || Outlines::new(&thick).map(|path| path.cracks()).sum::<usize>();
        group.bench_function(format!("outlines, {name}"), |bench| bench.iter(count));
        let hatched =
            Areas::default().with_style(AreaStyle::OutlineAndHatch(Hatch::default())).with_pen_px(8.0);
        let count = || hatched.paths(&thick).unwrap().map(|path| path.sites.len()).sum::<usize>();
        group.bench_function(format!("outline and hatch, {name}"), |bench| bench.iter(count));
    }
    let mut black = Bitmap::new(SIDE_PX, SIDE_PX).unwrap();
    (0..SIDE_PX).for_each(|y| (0..SIDE_PX).for_each(|x| black.set(Pixel::new(x, y), true)));
    group.bench_function("split, all black", |bench| bench.iter(|| split_by_width(&black, 24)));
    group.finish();
}

criterion_group!(benches, areas);
criterion_main!(benches);
