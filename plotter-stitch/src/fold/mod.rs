//! Whether the paper has folded: a line drawn twice, from either end, in an empty place on the diagonal along
//! which a fold would lie.
//!
//! ```text
//!    ┌────────────────────────┐      the ridge of a fold is held by the pen's friction to the side that the pen goes to:
//!    │ ╲╲                     │      the two strokes over it do not lie on each other
//!    │   ╲╲   ┌──┐            │
//!    │     ╲╲ │╲╲│ empty      │              ╲ ╲  with a fold      ╲╲  without
//!    │       ╲╲──┘            │               ╲ ╲                   ╲╲
//!    │         ╲╲             │
//!    └────────────────────────┘
//! ```

mod direction;
mod probe;
#[cfg(feature = "alloc")]
mod square;
mod verdict;

pub use direction::FoldDirection;
pub use probe::{FoldProbe, ProbeScan};
#[cfg(feature = "alloc")]
pub use square::EmptySquare;
pub use verdict::{FoldTest, FoldVerdict, Seen};
