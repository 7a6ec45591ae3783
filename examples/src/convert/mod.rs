//! `convert`: one language of plotters into another.

mod command;
mod writer;

pub use command::ConvertCommand;
