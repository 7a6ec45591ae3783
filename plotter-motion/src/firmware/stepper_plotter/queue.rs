//! [`Queue`]: what joins the two tasks.

/// A row of at most `N` things, first in, first out, without allocation.
///
/// ```
/// # use plotter_motion::firmware::stepper_plotter::Queue;
/// let mut queue = Queue::<u8, 2>::new();
/// assert_eq!((queue.push(1), queue.push(2)), (Ok(()), Ok(())));
/// assert_eq!(queue.push(3), Err(3)); // full: it is given back
/// assert_eq!((queue.pop(), queue.pop(), queue.pop()), (Some(1), Some(2), None));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Queue<T, const N: usize> {
    slots: [Option<T>; N],
    first: usize,
    len: usize,
}

impl<T: Copy, const N: usize> Default for Queue<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Copy, const N: usize> Queue<T, N> {
    /// An empty queue.
    #[must_use]
    pub const fn new() -> Self {
        Self { slots: [None; N], first: 0, len: 0 }
    }

    /// Appends `item`.
    ///
    /// # Errors
    ///
    /// `item` itself when the queue is full.
    pub fn push(&mut self, item: T) -> Result<(), T> {
        if self.len == N {
            return Err(item);
        }
        let place = (self.first + self.len) % N;
        let Some(slot) = self.slots.get_mut(place) else { return Err(item) };
        *slot = Some(item);
        self.len += 1;
        Ok(())
    }

    /// The first item, which stays.
    #[must_use]
    pub fn first(&self) -> Option<T> {
        self.slots.get(self.first).copied().flatten()
    }

    /// Takes the first item out.
    pub fn pop(&mut self) -> Option<T> {
        let item = self.slots.get_mut(self.first)?.take()?;
        self.first = (self.first + 1) % N;
        self.len -= 1;
        Some(item)
    }

    /// How many more it takes.
    #[must_use]
    pub const fn room(&self) -> usize {
        N - self.len
    }

    /// Whether there is nothing in it.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::new();
    }
}
