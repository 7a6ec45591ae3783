//! [`Ring`]: a queue of a fixed size.

/// A queue of at most `N`, first in, first out.
#[derive(Clone, Debug)]
pub(super) struct Ring<T, const N: usize> {
    slots: [Option<T>; N],
    first: usize,
    count: usize,
}

impl<T: Copy, const N: usize> Ring<T, N> {
    pub(super) const fn new() -> Self {
        Self { slots: [None; N], first: 0, count: 0 }
    }

    pub(super) const fn len(&self) -> usize {
        self.count
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub(super) const fn is_full(&self) -> bool {
        self.count >= N
    }

    /// Gives it back where there is no room.
    pub(super) fn push(&mut self, item: T) -> Result<(), T> {
        if self.is_full() {
            return Err(item);
        }
        if let Some(slot) = self.slots.get_mut((self.first + self.count) % N.max(1)) {
            *slot = Some(item);
            self.count += 1;
        }
        Ok(())
    }

    pub(super) fn pop(&mut self) -> Option<T> {
        if self.count == 0 {
            return None;
        }
        let item = self.slots.get_mut(self.first).and_then(Option::take);
        self.first = (self.first + 1) % N.max(1);
        self.count -= 1;
        item
    }

    /// The last that came in.
    pub(super) fn pop_back(&mut self) -> Option<T> {
        let place = self.count.checked_sub(1)?;
        let item = self.slots.get_mut((self.first + place) % N.max(1)).and_then(Option::take);
        self.count = place;
        item
    }

    pub(super) fn get(&self, place: usize) -> Option<&T> {
        (place < self.count).then(|| self.slots.get((self.first + place) % N.max(1))).flatten()?.as_ref()
    }

    pub(super) fn get_mut(&mut self, place: usize) -> Option<&mut T> {
        if place >= self.count {
            return None;
        }
        self.slots.get_mut((self.first + place) % N.max(1)).and_then(Option::as_mut)
    }

    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_the_order_round_its_end_and_refuses_what_is_too_much() {
        let mut ring = Ring::<u8, 3>::new();
        for round in 0..7_u8 {
            assert_eq!((ring.push(round), ring.push(round + 100)), (Ok(()), Ok(())));
            assert_eq!(ring.get(1), Some(&(round + 100)));
            assert_eq!((ring.pop(), ring.pop(), ring.pop()), (Some(round), Some(round + 100), None));
        }
        (0..3).for_each(|item| assert_eq!(ring.push(item), Ok(())));
        assert_eq!((ring.push(9), ring.len(), ring.get(3)), (Err(9), 3, None));
        assert_eq!((ring.pop_back(), ring.pop(), ring.len()), (Some(2), Some(0), 1));
    }
}
