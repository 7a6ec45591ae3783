//! Published and ours on the two drawings, beside the published figures.

use crate::papers::{assert_in, row_of};
use plotter_vector::{
    Ours, Pixel, Threshold, Vectorized, Vectorizer, decode,
    raster::OrderedTracking,
    report::ErrorTally,
    stroke::{Bounded, DynamicThreshold, Simplify},
};

/// Mean, greatest error and standard deviation, px.
type Figures = [f64; 3];

/// Öcal's thesis, table 7-1.
const PAPER_FLAG: Figures = [0.0991, 2.0392, 0.2435];
const PAPER_TECHNICAL: Figures = [0.0042, 0.5547, 0.0386];

/// The same order as the paper's: what its algorithm may have on drawings of the same kind.
const ORDER_FLAG: Figures = [0.12, 2.1, 0.25];
const ORDER_TECHNICAL: Figures = [0.01, 0.6, 0.04];

fn trace(picture: &[u8], vectorizer: Vectorizer) -> Vectorized {
    vectorizer.vectorize(&decode(picture).unwrap()).unwrap()
}

fn figures(traced: &Vectorized) -> Figures {
    [traced.error.mean_px, traced.error.max_px, traced.error.sd_px]
}

fn row(name: &str, figures: Figures, traced: Option<&Vectorized>) {
    let [mean, max, sd] = figures;
    let counts = traced.map_or(String::new(), |traced| {
        let drawing = &traced.drawing;
        let (vertices, strokes) = (drawing.vertices(), drawing.strokes().len());
        format!("{vertices:>9} {strokes:>8} {:>10.0} {:>8.0}", drawing.pen_down_px(), drawing.pen_up_px())
    });
    println!("{name:<24} {mean:>8.4} {max:>8.4} {sd:>8.4} {counts}");
}

fn compare(name: &str, picture: &[u8], paper: Figures, order: Figures) {
    let (published, ours) = (trace(picture, Vectorizer::published()), trace(picture, Vectorizer::default()));
    println!("{name:<24} mean px   max px    sd px  vertices  strokes  pen down   pen up");
    row("  the paper's drawing", paper, None);
    row("  published", figures(&published), Some(&published));
    row("  ours", figures(&ours), Some(&ours));
    for ((published, ours), limit) in figures(&published).into_iter().zip(figures(&ours)).zip(order) {
        assert!(published <= limit, "published: {published} px where the paper's order is {limit} px");
        assert!(ours < published, "ours: {ours} px, published: {published} px");
    }
    assert!(ours.drawing.vertices() <= published.drawing.vertices());
    assert!(ours.drawing.pen_up_px() <= published.drawing.pen_up_px());
    assert_eq!(ours.error.pixels, published.error.pixels);
    for (who, traced) in [("published", &published), ("ours", &ours)] {
        let [mean, max, sd] = figures(traced).map(|px| format!("{px:.4}"));
        let drawing = &traced.drawing;
        let counts = [drawing.vertices(), drawing.strokes().len()].map(|count| count.to_string());
        let cells = [mean, max, sd].into_iter().chain(counts).chain([format!("{:.0}", drawing.pen_up_px())]);
        let cells: Vec<String> = cells.collect();
        for paper in ["docs/results/vectorization.md", "plotter-vector/README.md"] {
            assert_in(paper, &format!("{name}, {who}"), &cells);
        }
        if name == "flag" {
            let row = row_of("README.md", "vectorization error of a flag: mean, max").unwrap();
            let found = row.iter().any(|cell| cell.starts_with(&format!("{}, {} px", cells[0], cells[1])));
            assert!(found, "README.md: {row:?}, measured {cells:?}");
            assert_in("README.md", "its vertices", &cells[3..4]);
        }
    }
}

#[test]
fn on_the_flag_ours_is_better_in_all_figures_with_no_more_vertices() {
    compare("flag", include_bytes!("../../data/flag.png"), PAPER_FLAG, ORDER_FLAG);
}

#[test]
fn on_the_technical_drawing_ours_is_better_in_all_figures_with_no_more_vertices() {
    compare(
        "technical drawing",
        include_bytes!("../../data/technical.png"),
        PAPER_TECHNICAL,
        ORDER_TECHNICAL,
    );
}

#[test]
fn the_flags_outline_is_closed_and_the_seam_ends_on_it() {
    let flag = trace(include_bytes!("../../data/flag.png"), Vectorizer::default()).drawing;
    let outline = flag.strokes().find(|stroke| stroke.len() == 5).unwrap();
    assert_eq!(outline.first(), outline.last());
    let seam = flag.strokes().find(|stroke| stroke.len() == 2).unwrap();
    // Whichever corner the outline begins with, and whichever end the seam.
    let [mut sides, mut ends] = [[outline[0].y, outline[2].y], [seam[0].y, seam[1].y]];
    [&mut sides, &mut ends].into_iter().for_each(|pair| pair.sort_by(f64::total_cmp));
    assert_eq!(ends, sides);
}

/// Greatest distance of a pixel from the segment that replaced it, px.
fn greatest_error_px(figure: &[Pixel], kept: &[usize]) -> f64 {
    let mut tally = ErrorTally::default();
    tally.add(figure, kept, (false, false));
    tally.report().max_px
}

/// Ours, given the greatest error of the published algorithm on the same: figure by figure, and all in one.
fn compare_at_the_published_greatest_error(picture: &[u8]) {
    /// What ours adds to a tolerance so that a pixel exactly on it passes, px.
    const ROUNDING_PX: f64 = 1e-8;
    let gray = decode(picture).unwrap();
    let (ink, _) = Threshold::default().apply(&gray);
    let figures = OrderedTracking::default().track(&ink).unwrap();
    assert!(figures.len() > 1);
    for figure in figures.iter() {
        let published = DynamicThreshold::default().keep(figure);
        let tolerance_px = greatest_error_px(figure, &published);
        let ours = Bounded::default().with_tolerance_px(tolerance_px).keep(figure);
        assert!(ours.len() <= published.len(), "at {:?}, {tolerance_px} px", figure[0]);
        assert!(greatest_error_px(figure, &ours) <= tolerance_px + ROUNDING_PX, "at {:?}", figure[0]);
    }

    let published = trace(picture, Vectorizer::published());
    let ours = Ours::default().with_tolerance_px(published.error.max_px);
    let ours = Vectorizer::from(ours).vectorize(&gray).unwrap();
    println!(
        "at {:.4} px: published {} vertices, ours {}",
        published.error.max_px,
        published.drawing.vertices(),
        ours.drawing.vertices()
    );
    assert!(ours.error.max_px <= published.error.max_px + ROUNDING_PX);
    assert!(ours.drawing.vertices() <= published.drawing.vertices());
}

#[test]
fn on_the_flag_ours_has_no_more_vertices_at_the_published_greatest_error() {
    compare_at_the_published_greatest_error(include_bytes!("../../data/flag.png"));
}

#[test]
fn on_the_technical_drawing_ours_has_no_more_vertices_at_the_published_greatest_error() {
    compare_at_the_published_greatest_error(include_bytes!("../../data/technical.png"));
}
