//! [`Chains`]: ends with their partners, put together to trails.

use super::plan::{Leg, Legs, Stroke, Trail};
use super::sites::{NONE, number};

/// Strokes and what each of their ends goes on in: all that is left when trails are put together.
pub(super) struct Chains<'a> {
    pub(super) strokes: &'a [Stroke<'a>],
    /// The vertex at which each stroke begins; empty if all do at their first.
    pub(super) starts: Vec<u32>,
    /// By end, two a stroke; [`NONE`] is free.
    pub(super) partners: Vec<u32>,
}

impl<'a> Chains<'a> {
    fn partner(&self, end: u32) -> Option<u32> {
        self.partners.get(end as usize).copied().filter(|partner| *partner != NONE)
    }

    /// The free end that is come to from the end of a stroke by going on; `None` where that goes round.
    fn free_end(&self, from: u32) -> Option<u32> {
        let mut end = from;
        // No trail has more strokes than there are.
        for _ in &self.partners {
            let Some(partner) = self.partner(end) else { return Some(end) };
            end = partner ^ 1;
            if end == from {
                break;
            }
        }
        None
    }

    /// The trails in the order of their first strokes: those with free ends from the lower of the two, the
    /// rings from their first stroke.
    pub(super) fn assemble(self) -> (Legs<'a>, Vec<Trail>) {
        let mut done = vec![false; self.strokes.len()];
        let mut legs = Legs::new(self.strokes);
        let mut trails: Vec<Trail> = Vec::with_capacity(self.strokes.len());
        for first in 0..number(self.strokes.len()) {
            if done.get(first as usize) == Some(&true) {
                continue;
            }
            let free = self.free_end(2 * first).zip(self.free_end(2 * first + 1));
            let entry = free.map_or(2 * first, |(one, other)| one.min(other));
            let mut next = Some(entry);
            let own = core::iter::from_fn(|| {
                let end = next?;
                let flag = done.get_mut(end as usize / 2).filter(|done| !**done)?;
                *flag = true;
                next = self.partner(end ^ 1);
                let start = self.starts.get(end as usize / 2).copied().unwrap_or(0);
                Some(Leg { stroke: end / 2, reversed: end % 2 == 1, start })
            });
            trails.push(legs.push(own, self.partner(entry).is_some()));
        }
        (legs, trails)
    }
}
