//! Small pictures with random changes: a picture or an error, and the same picture both ways.

use super::pictures::every_kind;
use super::{by_image, by_rows};
use crate::law_cases::cases;
use plotter_vector::{FileRows, Vectorizer, decode, picture::Ground};
use proptest::prelude::*;
use std::io::Cursor;
use std::sync::LazyLock;

static FILES: LazyLock<Vec<(String, Vec<u8>)>> = LazyLock::new(|| every_kind(9, 6));

/// A change; the place is counted from the start, and again from there behind the end.
#[derive(Clone, Debug)]
enum Change {
    Flip { at: usize, bits: u8 },
    Remove { at: usize, count: usize },
    Insert { at: usize, bytes: Vec<u8> },
    Repeat { at: usize, count: usize },
}

fn change() -> impl Strategy<Value = Change> {
    // The head of a file is where most can go wrong.
    let at = || prop_oneof![0_usize..64, any::<usize>()];
    prop_oneof![
        4 => (at(), 1_u8..).prop_map(|(at, bits)| Change::Flip { at, bits }),
        1 => (at(), 1_usize..20).prop_map(|(at, count)| Change::Remove { at, count }),
        1 => (at(), prop::collection::vec(any::<u8>(), 1..9)).prop_map(|(at, bytes)| Change::Insert { at, bytes }),
        1 => (at(), 1_usize..20).prop_map(|(at, count)| Change::Repeat { at, count }),
    ]
}

fn apply(bytes: &mut Vec<u8>, change: &Change) {
    let length = bytes.len();
    let place = |at: &usize| at % length.max(1);
    match change {
        Change::Flip { at, bits } => {
            if let Some(byte) = bytes.get_mut(place(at)) {
                *byte ^= bits;
            }
        }
        Change::Remove { at, count } => {
            let start = place(at);
            bytes.drain(start..(start + count).min(length));
        }
        Change::Insert { at, bytes: new } => {
            let start = place(at);
            bytes.splice(start..start, new.iter().copied());
        }
        Change::Repeat { at, count } => {
            let start = place(at);
            let again = bytes[start..(start + count).min(length)].to_vec();
            bytes.splice(start..start, again);
        }
    }
}

proptest! {
    #![proptest_config(cases(800))]

    #[test]
    fn changed_pictures_never_panic(kind in any::<prop::sample::Index>(), changes in prop::collection::vec(change(), 1..5)) {
        let (_, file) = kind.get(&FILES);
        let mut bytes = file.clone();
        changes.iter().for_each(|change| apply(&mut bytes, change));
        let read = by_rows(&bytes);
        match (&read, decode(&bytes)) {
            (Ok(levels), Ok(gray)) => {
                prop_assert_eq!(gray.pixels(), &levels.levels[..]);
                if gray.pixels().len() <= 1 << 16 {
                    let traced = Vectorizer::default().vectorize(&gray);
                    let (width, height) = (f64::from(gray.width()), f64::from(gray.height()));
                    let inside = |at: &plotter_vector::PxPoint| (0.0..=width).contains(&at.x) && (0.0..=height).contains(&at.y);
                    prop_assert!(traced.is_ok_and(|traced| traced.drawing.strokes().flatten().all(inside)));
                }
            }
            (Err(_), Err(_)) => {}
            // Too many pixels to be held whole, yet all of them there.
            (Ok(levels), Err(error)) => prop_assert!(levels.levels.len() > 1 << 28, "{error}"),
            (Err(error), Ok(_)) => prop_assert!(false, "only by rows: {error}"),
        }
        // What another decoder reads too, it reads the same: as it is stored, and on white.
        let as_stored = |scan: FileRows<Cursor<&Vec<u8>>>| {
            scan.notes().orientation.is_upright() && scan.notes().ground != Some(Ground::Black)
        };
        if !bytes.starts_with(b"II") && !bytes.starts_with(b"MM")
            && FileRows::new(Cursor::new(&bytes)).is_ok_and(as_stored)
            && let (Ok(levels), Ok(expected)) = (&read, by_image(&bytes))
        {
            prop_assert!(*levels == expected);
        }
    }
}
