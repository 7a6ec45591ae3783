//! Decides whether two lines are near each other in order: the check of the promise, independent of the
//! library's.

use plotter_vector::PxPoint;

/// Whether the Fréchet distance of two polylines is at most `limit_px`: the free space diagram, cell by cell.
///
/// H. Alt, M. Godau, "Computing the Fréchet distance between two polygonal curves" (1995).
pub(crate) fn within(p: &[PxPoint], q: &[PxPoint], limit_px: f64) -> bool {
    // The part of the segment a-b near the point, as parameters.
    let free = |at: PxPoint, a: PxPoint, b: PxPoint| -> Option<(f64, f64)> {
        let (wx, wy, vx, vy) = (b.x - a.x, b.y - a.y, at.x - a.x, at.y - a.y);
        let (ww, wv, vv) = (wx * wx + wy * wy, wx * vx + wy * vy, vx * vx + vy * vy);
        if ww == 0.0 {
            return (vv <= limit_px * limit_px).then_some((0.0, 1.0));
        }
        // Over the distance from the line: the discriminant itself would lose half of the digits.
        let off = (wx * vy - wy * vx) / ww.sqrt();
        let half = ((limit_px * limit_px - off * off) / ww).sqrt();
        if half.is_nan() {
            return None;
        }
        let (low, high) = (wv / ww - half, wv / ww + half);
        (high >= 0.0 && low <= 1.0).then_some((low.max(0.0), high.min(1.0)))
    };
    let near = |a: PxPoint, b: PxPoint| a.distance(b) <= limit_px;
    if !near(p[0], q[0]) || !near(*p.last().unwrap(), *q.last().unwrap()) {
        return false;
    }
    if p.len() == 1 {
        return q.iter().all(|at| near(*at, p[0]));
    }
    // left[i]: what is reachable on the border "p's segment i, q's present vertex".
    let mut left: Vec<Option<(f64, f64)>> = vec![None; p.len() - 1];
    let mut open = true;
    for i in 0..p.len() - 1 {
        left[i] = free(q[0], p[i], p[i + 1]).filter(|(low, _)| open && *low <= 0.0);
        open = left[i].is_some_and(|(_, high)| high >= 1.0);
    }
    let mut first_open = true;
    for j in 0..q.len() - 1 {
        let mut bottom = free(p[0], q[j], q[j + 1]).filter(|(low, _)| first_open && *low <= 0.0);
        first_open = bottom.is_some_and(|(_, high)| high >= 1.0);
        for i in 0..p.len() - 1 {
            let top = free(p[i + 1], q[j], q[j + 1]);
            let right = free(q[j + 1], p[i], p[i + 1]);
            let from = |free: Option<(f64, f64)>, along: Option<(f64, f64)>, across: Option<(f64, f64)>| {
                let (low, high) = free?;
                let start = if across.is_some() { low } else { low.max(along?.0) };
                (start <= high).then_some((start, high))
            };
            let (new_right, new_top) = (from(right, left[i], bottom), from(top, bottom, left[i]));
            left[i] = new_right;
            bottom = new_top;
        }
    }
    left.last().unwrap().is_some_and(|(_, high)| high >= 1.0 - 1e-9)
}

/// The sites of a ring from the one nearest to a place on, all ways round: where the two pens may have
/// started.
pub(crate) fn some_start_is_within(sites: &[PxPoint], line: &[PxPoint], limit_px: f64) -> bool {
    (0..sites.len()).any(|start| {
        // The pen may start between two sites: at the place nearest to the first vertex.
        let (a, b) = (sites[start], sites[(start + 1) % sites.len()]);
        let (wx, wy) = (b.x - a.x, b.y - a.y);
        let ww = wx * wx + wy * wy;
        let dot = (line[0].x - a.x) * wx + (line[0].y - a.y) * wy;
        let part = if ww > 0.0 { (dot / ww).clamp(0.0, 1.0) } else { 0.0 };
        let seam = PxPoint::new(a.x + part * wx, a.y + part * wy);
        let mut turned = vec![seam];
        turned.extend((1..=sites.len()).map(|i| sites[(start + i) % sites.len()]));
        turned.push(seam);
        within(&turned, line, limit_px)
    })
}
