//! [`DisjointSets`]: sets of things that belong together (union-find).

/// Trees over numbered things: those that belong together share a root (B. A. Galler and M. J. Fischer, "An
/// improved equivalence algorithm", 1964).
#[derive(Clone, Debug, Default)]
pub(crate) struct DisjointSets(Vec<usize>);

impl DisjointSets {
    /// `things` things, each in a set of its own.
    pub(crate) fn new(things: usize) -> Self {
        Self((0..things).collect())
    }

    /// Adds a thing in a set of its own; returns its number.
    pub(crate) fn push(&mut self) -> usize {
        self.0.push(self.0.len());
        self.0.len() - 1
    }

    /// Begins again with `things` things, each in a set of its own.
    pub(crate) fn begin_again(&mut self, things: usize) {
        self.0.clear();
        self.0.extend(0..things);
    }

    /// The root of a thing's tree.
    pub(crate) fn root(&mut self, mut thing: usize) -> usize {
        while let Some(parent) = self.0.get(thing).copied().filter(|parent| *parent != thing) {
            // Halving the path keeps the trees flat.
            let above = self.0.get(parent).copied().unwrap_or(parent);
            if let Some(slot) = self.0.get_mut(thing) {
                *slot = above;
            }
            thing = above;
        }
        thing
    }

    /// Makes one tree of two; its root is the second one's.
    pub(crate) fn join(&mut self, child: usize, thing: usize) {
        let (child, thing) = (self.root(child), self.root(thing));
        if let Some(slot) = self.0.get_mut(child) {
            *slot = thing;
        }
    }

    /// Makes one tree of two; its root is the lower of theirs. Says whether they were two.
    pub(crate) fn join_to_lower(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.join(a.max(b), a.min(b));
        a != b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_joined_shares_a_root_and_nothing_else_does() {
        let mut sets = DisjointSets::new(5);
        sets.join(0, 1);
        sets.join(3, 4);
        sets.join(1, 4);
        let roots: Vec<usize> = (0..5).map(|thing| sets.root(thing)).collect();
        assert_eq!(roots, [4, 4, 2, 4, 4]);
        assert!(sets.join_to_lower(0, 2) && !sets.join_to_lower(2, 1));
        assert_eq!(sets.root(3), 2);
        assert_eq!((sets.push(), sets.root(5)), (5, 5));
        sets.begin_again(2);
        assert_eq!((sets.root(0), sets.root(1), sets.push()), (0, 1, 2));
    }
}
