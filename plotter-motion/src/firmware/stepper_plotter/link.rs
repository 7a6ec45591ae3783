//! [`Link`]: both queues between the two sides.

use super::{CommandQueue, Queue, Report};

/// Reports on their way back; the receive side waits for at most one, and a machine is not stopped twice
/// before that is told.
pub const REPORTS: usize = 3;

/// Both queues between the receive side and the motion side. In two tasks they are the queues of the
/// operating system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Link {
    /// To the motion side.
    pub commands: CommandQueue,
    /// To the receive side.
    pub reports: Queue<Report, REPORTS>,
}
