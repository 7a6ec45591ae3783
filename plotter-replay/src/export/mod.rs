//! Logs for other programs: a table ([`csv`]), words for people ([`text`]), and MCAP for Foxglove (feature
//! `mcap`).

#[cfg(feature = "mcap")]
mod mcap;
mod table;

#[cfg(feature = "mcap")]
pub use mcap::{McapError, McapSettings, mcap};
pub use table::{csv, line, text};
