//! The inside of the tools, by rooms.
//!
//! [`shared`], [`drawings`] and [`machine`] are what several tools use, each of them those before it alone.
//! Every other room belongs to one tool and uses these three, never another tool's.
//!
//! | room | what is in it |
//! |---|---|
//! | [`shared`] | errors in one line, files, pages with pictures, pens' colours, how pictures are traced |
//! | [`drawings`] | a drawing in any language: read, arranged, written |
//! | [`machine`] | a drawing on a machine: simulated, emulated, step by step; all that `stream` and `bad_day` do |
//! | [`plot`], [`trace`], [`convert`], [`stepper`] | the tools of these names |
//! | [`tune`], [`max_error`], [`long_sheet`] | the tools of these names |
//! | [`follow`] | `follow` and `follow_sweep` |
//! | [`compare`] | `compare_controllers` and `my_controller` |

pub mod compare;
pub mod convert;
pub mod drawings;
pub mod follow;
pub mod long_sheet;
pub mod machine;
pub mod max_error;
pub mod plot;
pub mod shared;
pub mod stepper;
pub mod trace;
pub mod tune;
