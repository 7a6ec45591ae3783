//! Work on all cores with the feature `rayon`, and on one without it: the results are the same.

use std::sync::Mutex;

/// How many threads work at a time.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "rayon")]
    return rayon::current_num_threads().max(1);
    #[cfg(not(feature = "rayon"))]
    1
}

/// An item, then its result.
enum Place<T, R> {
    Waits(T),
    Done(R),
    Empty,
}

/// The results for all items in their order.
///
/// Each has a place of its own, so that the scheduler need not know its type: built for each kind of work
/// anew, it would be a seventh of this crate's code.
pub(crate) fn each<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync) -> Vec<R> {
    let places: Vec<Mutex<Place<T, R>>> =
        items.into_iter().map(|item| Mutex::new(Place::Waits(item))).collect();
    for_all(places.len(), &|index| {
        // Nobody else has this index, so the lock is free; work that panics ends all.
        if let Some(Ok(mut place)) = places.get(index).map(Mutex::lock)
            && let Place::Waits(item) = std::mem::replace(&mut *place, Place::Empty)
        {
            *place = Place::Done(work(item));
        }
    });
    let done = |place: Mutex<Place<T, R>>| match place.into_inner() {
        Ok(Place::Done(result)) => Some(result),
        Ok(Place::Waits(_) | Place::Empty) | Err(_) => None,
    };
    places.into_iter().filter_map(done).collect()
}

fn for_all(count: usize, work: &(dyn Fn(usize) + Sync)) {
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        (0..count).into_par_iter().for_each(work);
    }
    #[cfg(not(feature = "rayon"))]
    (0..count).for_each(work);
}
