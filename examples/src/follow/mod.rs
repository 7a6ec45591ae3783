//! `follow` and `follow_sweep`: a tool that follows lines under a camera.

mod command;
mod course;
mod ended;
mod files;
mod follower;
mod gif;
mod kerf;
mod leader;
mod led;
mod machine;
mod moves;
mod outcome;
mod pictures;
mod sheet;
mod turned;
#[cfg(all(feature = "camera", target_os = "linux"))]
mod v4l_camera;
mod window_source;
mod wrong_choices;

pub use command::FollowCommand;
pub use gif::FollowGif;
pub use machine::FollowMachine;
pub use moves::MovesFile;
pub use outcome::FollowOutcome;
pub use pictures::{FollowFrame, follow_page, follow_svg};
pub use window_source::WindowSource;
pub use wrong_choices::{WrongChoices, wrong_choices};
