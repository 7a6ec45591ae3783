//! Which side is ink, where light is uneven: what the paper beside an edge is, dark or light.

use super::paper::Paper;
use super::plane::Plane;

/// Edges that count: those at least so steep, as a part of the steepest.
const STEEP: f32 = 0.4;

/// The share of pixels that are no steep edge in any drawing, of which the steepest of the rest is taken.
const NO_EDGE: f64 = 0.995;

/// Halfway between an edge's two sides is told from the levels so far around it, px.
const BESIDE_PX: usize = 2;

/// Whether the ink of a picture is light: on most of its steep edges the paper around, a tile's median, lies
/// on the dark side of the edge.
///
/// A line has paper on both sides, so the median around it is the paper's; the soft edges of shadows and of
/// reflections are not steep, whatever their contrast.
pub(super) fn ink_is_light(smooth: &Plane) -> bool {
    let steepness = |above: &[u16], row: &[u16], below: &[u16], x: usize| -> Option<u16> {
        let across = row.get(x + 1)?.abs_diff(*row.get(x.checked_sub(1)?)?);
        Some(across.max(below.get(x)?.abs_diff(*above.get(x)?)))
    };
    let mut counts = vec![0_u64; 65_536];
    let inner = 1..smooth.height.saturating_sub(1);
    for y in inner.clone() {
        let (above, row, below) = (smooth.row(y - 1), smooth.row(y), smooth.row(y + 1));
        for found in (0..smooth.width).filter_map(|x| steepness(above, row, below, x)) {
            if let Some(n) = counts.get_mut(usize::from(found)) {
                *n += 1;
            }
        }
    }
    let total: u64 = counts.iter().sum();
    let mut below = 0;
    #[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
    let top = counts.iter().position(|n| {
        below += n;
        below as f64 >= NO_EDGE * total as f64
    });
    let top = f32::from(u16::try_from(top.unwrap_or(0)).unwrap_or(u16::MAX));
    let medians = Paper::medians(smooth);
    let mut votes = [0.0_f64; 2];
    for y in inner {
        let (above, row, below) = (smooth.row(y - 1), smooth.row(y), smooth.row(y + 1));
        for x in 0..smooth.width {
            let Some(steep) =
                steepness(above, row, below, x).map(f32::from).filter(|steep| *steep > STEEP * top)
            else {
                continue;
            };
            let rows = y.saturating_sub(BESIDE_PX)..(y + BESIDE_PX + 1).min(smooth.height);
            let columns = x.saturating_sub(BESIDE_PX)..(x + BESIDE_PX + 1).min(smooth.width);
            let near = || rows.clone().flat_map(|y| smooth.row(y).get(columns.clone()).unwrap_or(&[]));
            let (least, most) = (near().min().copied().unwrap_or(0), near().max().copied().unwrap_or(0));
            let halfway = f32::from(least) / 2.0 + f32::from(most) / 2.0;
            let [dark, light] = &mut votes;
            let vote = if medians.at(x, y) < halfway { light } else { dark };
            *vote += f64::from(steep) * f64::from(steep);
        }
    }
    let [dark, light] = votes;
    light > dark
}
