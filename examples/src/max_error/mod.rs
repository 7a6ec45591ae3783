//! `max_error`: where a pen was, beside where it should have been.

mod command;
mod figures;
mod followed_path;
mod plan;
mod scan;
mod speed_trial;
mod true_path;

pub use command::MaxErrorCommand;
pub use followed_path::{FollowedPath, follow, predicted_s, rounding_mm, slowed};
pub use speed_trial::{deviation_mm, speed_trial, test_figure};
pub use true_path::TruePath;
