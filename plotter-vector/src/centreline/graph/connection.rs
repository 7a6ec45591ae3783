//! [`Junctions`]: what was found out about the ends of all edges, and how lines go on there.

use super::End;
use super::junction::ArmOf;
use crate::picture::Pixel;
use crate::stroke::{PxPoint, turn::CORNER_COS};

/// What takes the place of the disturbed ends of one or two edges.
#[derive(Clone, Debug)]
pub(crate) struct Connection {
    /// The junction's first node in reading order.
    pub(crate) owner: Pixel,
    /// An edge's end.
    pub(crate) from: End,
    /// The edge end that continues the stroke; none where the line ends.
    pub(crate) to: Option<End>,
    /// Places between the last sites that stay, or from there to where the line ends.
    pub(crate) points: Vec<PxPoint>,
    /// Whether the stroke has a corner there.
    pub(crate) corner: bool,
    /// Whether the line ends where no other does.
    pub(crate) tip: Option<Tip>,
}

/// What is known of a line's end where no other one is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tip {
    /// It lies where the line leads.
    Ahead,
    /// Where it lies across the line its ink tells.
    Seated,
}

/// How one line goes on in a junction: to another arm, or to where it ends.
#[derive(Clone, Debug)]
pub(super) struct Way {
    pub(super) one: ArmOf,
    pub(super) other: Option<ArmOf>,
    /// Places between the undisturbed parts of both arms, or from there to the end.
    pub(super) points: Vec<PxPoint>,
}

/// What was found out about all edges.
#[derive(Clone, Debug, Default)]
pub(crate) struct Junctions {
    /// For each edge how many sites are replaced at its start and its end.
    pub(super) skips: Vec<[usize; 2]>,
    /// What replaces them.
    pub(crate) connections: Vec<Connection>,
    /// Edges that are inside a junction, no line of their own.
    pub(crate) inner: Vec<bool>,
    /// The edges that come near, but for those that are no lines of their own.
    pub(crate) lines: Vec<usize>,
}

impl Junctions {
    /// Sites at an edge's end that are replaced.
    pub(crate) fn skip(&self, end: End) -> usize {
        self.skips.get(end.edge).and_then(|skips| skips.get(usize::from(end.at_last))).copied().unwrap_or(0)
    }

    fn set_skip(&mut self, end: End, skip: usize) {
        if let Some(place) =
            self.skips.get_mut(end.edge).and_then(|skips| skips.get_mut(usize::from(end.at_last)))
        {
            *place = skip;
        }
    }

    /// What replaces the ends of edges that are lines of their own.
    pub(super) fn of_lines(&self) -> impl Iterator<Item = &Connection> {
        self.connections.iter().filter(|one| self.inner.get(one.from.edge) == Some(&false))
    }

    /// A line ends, at others or, at its `tip`, nowhere.
    pub(super) fn end(&mut self, owner: Pixel, one: &ArmOf, points: Vec<PxPoint>, tip: Option<Tip>) {
        self.set_skip(one.end, one.arm.skip);
        self.connections.push(Connection { owner, from: one.end, to: None, points, corner: false, tip });
    }

    /// An edge is no line of its own.
    pub(super) fn drop_line(&mut self, end: End) {
        if let Some(inner) = self.inner.get_mut(end.edge) {
            *inner = true;
        }
    }

    /// A line goes on.
    pub(super) fn pair(&mut self, owner: Pixel, one: &ArmOf, other: &ArmOf, points: Vec<PxPoint>) {
        self.set_skip(one.end, one.arm.skip);
        self.set_skip(other.end, other.arm.skip);
        let (a, b) = (one.arm.direction, other.arm.direction);
        let corner = points.len() == 1 && -a.dot(b) < CORNER_COS;
        self.connections.push(Connection {
            owner,
            from: one.end,
            to: Some(other.end),
            points,
            corner,
            tip: None,
        });
    }

    /// All lines of a junction go on.
    pub(super) fn take(&mut self, owner: Pixel, ways: Vec<Way>) {
        for Way { one, other, points } in ways {
            match other {
                Some(other) => self.pair(owner, &one, &other, points),
                None => self.end(owner, &one, points, None),
            }
        }
    }
}
