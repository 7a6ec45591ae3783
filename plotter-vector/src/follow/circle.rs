//! [`ring`]: the pixels on a circle, in order.

/// Offsets of the pixels of a circle about a pixel, once around, clockwise on a picture from the right: each touches the next
/// one, none comes twice. Radius 0 is the pixel itself.
///
/// Source: J. Bresenham, "A linear algorithm for incremental digital display of circular arcs" (1977), here by the
/// pixel of each column, or row, that is nearest to the circle.
pub(super) fn ring(radius: i32) -> Vec<(i32, i32)> {
    if radius <= 0 {
        return vec![(0, 0)];
    }
    // From the right to the diagonal: a pixel a row.
    let nearest = |y: i32| {
        let square = f64::from(radius) * f64::from(radius) - f64::from(y) * f64::from(y);
        super::whole::floor(libm::sqrt(square.max(0.0)) + 0.5)
    };
    let octant: Vec<(i32, i32)> = (0..=radius).map(|y| (nearest(y), y)).take_while(|(x, y)| y <= x).collect();
    let mirrored = octant.iter().rev().map(|(x, y)| (*y, *x)).filter(|(x, y)| x < y);
    let quarter: Vec<(i32, i32)> = octant.iter().copied().chain(mirrored).filter(|(x, _)| *x > 0).collect();
    let mut ring = Vec::with_capacity(4 * quarter.len());
    let mut turned = quarter;
    for _ in 0..4 {
        ring.extend_from_slice(&turned);
        turned = turned.iter().map(|(x, y)| (-y, *x)).collect();
    }
    ring
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_circle_of_the_thesis_has_radius_2() {
        // Table 1 of the thesis, and the pixels between.
        assert_eq!(
            ring(2),
            [
                (2, 0),
                (2, 1),
                (1, 2),
                (0, 2),
                (-1, 2),
                (-2, 1),
                (-2, 0),
                (-2, -1),
                (-1, -2),
                (0, -2),
                (1, -2),
                (2, -1)
            ]
        );
    }

    #[test]
    fn a_ring_is_closed_and_has_no_pixel_twice() {
        for radius in 1..60 {
            let ring = ring(radius);
            for (i, (x, y)) in ring.iter().enumerate() {
                let (u, v) = ring[(i + 1) % ring.len()];
                assert!((x - u).abs() <= 1 && (y - v).abs() <= 1, "{radius}: {x} {y} to {u} {v}");
                assert!((f64::from(x * x + y * y).sqrt() - f64::from(radius)).abs() < 0.75);
            }
            let mut sorted = ring.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), ring.len(), "{radius}");
        }
    }
}
