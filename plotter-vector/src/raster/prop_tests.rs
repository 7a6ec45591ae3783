//! Laws of linking and joining figures.
#![allow(clippy::indexing_slicing, reason = "a failure shows")]

use super::OrderedTracking;
use super::continuity::{join, link};
use crate::picture::{Bitmap, Figures, Pixel};
use proptest::prelude::*;

fn pictures() -> impl Strategy<Value = Bitmap> {
    (1_u32..90, 1_u32..24, 0.02..0.98_f64).prop_flat_map(|(width, height, ink)| {
        let count = (width * height) as usize;
        proptest::collection::vec(proptest::bool::weighted(ink), count).prop_map(move |marks| {
            let mut bitmap = Bitmap::new(width, height).unwrap();
            for (index, _) in (0..).zip(&marks).filter(|(_, mark)| **mark) {
                bitmap.set(Pixel::new(index % width, index / width), true);
            }
            bitmap
        })
    })
}

fn sorted(figures: &Figures) -> Vec<Pixel> {
    let mut pixels: Vec<Pixel> = figures.iter().flatten().copied().collect();
    pixels.sort_unstable();
    pixels
}

proptest! {
    #[test]
    fn linking_keeps_every_pixel_and_never_adds_figures(ink in pictures()) {
        let figures = OrderedTracking::default().track(&ink).unwrap();
        let linked = link(&figures);
        for figure in linked.iter() {
            prop_assert!(figure.windows(2).all(|pair| pair[0].touches(pair[1])));
        }
        prop_assert_eq!(sorted(&linked), sorted(&figures));
        prop_assert!(linked.len() <= figures.len());
    }

    #[test]
    fn joining_only_borrows_ink_that_touches(ink in pictures()) {
        let figures = link(&OrderedTracking::default().track(&ink).unwrap());
        let joined = join(&figures, &ink);
        for ((figure, whole), (head, tail)) in figures.iter().zip(joined.figures.iter()).zip(&joined.borrowed) {
            let own = usize::from(*head)..whole.len() - usize::from(*tail);
            prop_assert_eq!(&whole[own], figure);
            prop_assert!(whole.windows(2).all(|pair| pair[0].touches(pair[1])));
            prop_assert!(whole.iter().all(|pixel| ink.get(*pixel)));
        }
    }
}
