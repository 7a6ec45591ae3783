//! [`Forest`]: things that belong together.

/// Trees over numbered things: those that belong together share a root (B. A. Galler and M. J. Fischer, "An improved
/// equivalence algorithm", 1964).
#[derive(Debug)]
pub(crate) struct Forest(Vec<usize>);

impl Forest {
    /// So many things, each by itself.
    pub(crate) fn new(things: usize) -> Self {
        Self((0..things).collect())
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_joined_shares_a_root_and_nothing_else_does() {
        let mut forest = Forest::new(5);
        forest.join(0, 1);
        forest.join(3, 4);
        forest.join(1, 4);
        let roots: Vec<usize> = (0..5).map(|thing| forest.root(thing)).collect();
        assert_eq!(roots, [4, 4, 2, 4, 4]);
    }
}
