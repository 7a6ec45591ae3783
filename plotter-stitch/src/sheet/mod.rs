//! The simulated sheet: how it moves, what its edge is like, and what the optical head sees on it.

mod edge;
mod feed;
mod fold_check;
mod long_sheet;
mod method;
pub(crate) mod noise;
mod probe;
mod sensor;
mod sheet_config;

pub use edge::PaperEdge;
pub use feed::{Feed, FeedSettings, PaperMove};
pub use fold_check::FoldCheck;
pub use long_sheet::{JointReport, LongSheet, SheetSettings};
pub use method::{JoinError, JoinFrames, Joined, PublishedJoin, StripJoin};
pub use probe::SensedProbe;
pub use sensor::{SensedJoint, SensorNoise};
pub use sheet_config::SheetConfig;
