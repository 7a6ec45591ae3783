//! [`told_spots`]: ink that is not drawn as promised, in one line.

use plotter_vector::report::Spots;

/// How many spots there are, how large they are, and where the largest one is: `3 spots farther off than
/// promised: 40 px, the largest 21 px at (12, 34) to (15, 40)`; none where there are none.
pub(crate) fn told_spots(spots: &Spots, (one, many): (&str, &str), what: &str) -> Option<String> {
    let largest = spots.largest.first()?;
    let Spots { number, pixels, .. } = spots;
    let of = if *number == 1 { one } else { many };
    Some(format!(
        "{number} {of} {what}: {pixels} px, the largest {} px at ({}, {}) to ({}, {})",
        largest.pixels, largest.from.x, largest.from.y, largest.to.x, largest.to.y
    ))
}

/// Ink beyond the tolerance, as [`told_spots`] says it.
pub(crate) fn told_bare(bare: &Spots) -> Option<String> {
    told_spots(bare, ("spot", "spots"), "farther off than promised")
}

/// Ink of areas that is not drawn, as [`told_spots`] says it.
pub(crate) fn told_insides(insides: &Spots) -> Option<String> {
    told_spots(insides, ("inside", "insides"), "of areas not drawn")
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_vector::{Pixel, report::Spot};

    #[test]
    fn spots_are_told_with_their_number_and_the_place_of_the_largest() {
        let spot = Spot { from: Pixel::new(12, 34), to: Pixel::new(15, 40), pixels: 21, max_px: 1.0 };
        let spots = |number| Spots { number, pixels: 40, largest: vec![spot] };
        assert_eq!(told_bare(&Spots::default()), None);
        let said = "3 spots farther off than promised: 40 px, the largest 21 px at (12, 34) to (15, 40)";
        assert_eq!(told_bare(&spots(3)).as_deref(), Some(said));
        assert!(told_insides(&spots(1)).unwrap().starts_with("1 inside of areas not drawn: 40 px"));
    }
}
