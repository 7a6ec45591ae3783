//! [`SheetConfig`]: how drawings longer than the table are drawn frame by frame.
//!
//! Only what the machine's file says: who divides drawings and joins frames makes settings of it.

use super::rules::{Rule, number};

/// How drawings longer than the table are drawn: the table `[sheet]` of a machine's file.
///
/// The defaults are a machine that moves no sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct SheetConfig {
    /// By how much the sheet is moved along y at a time, mm; 0 if the machine cannot move it.
    pub frame_mm: f64,
    /// The machine's y at which every frame begins, mm: the sheet is moved along y, towards smaller y.
    pub begin_mm: f64,
    /// How far from the border between two frames a line may be cut, mm.
    pub cut_window_mm: f64,
    /// A cut nearer than this to a corner or to another line does harm, mm.
    pub cut_clear_mm: f64,
    /// The most that lines may be moved at a joint to keep the drawing parallel to the paper's edge, mm; 0
    /// for not at all.
    pub anchor_mm: f64,
    /// Speed at which the optical head looks for reference lines, mm/s.
    pub sensing_mm_s: f64,
}

impl SheetConfig {
    /// The documented textile plotter: frames of 950 mm on a table that takes 1000 mm of the paper's length.
    pub(super) const TEXTILE_PLOTTER: Self = Self {
        frame_mm: 950.0,
        begin_mm: 20.0,
        cut_window_mm: 5.0,
        cut_clear_mm: 1.0,
        anchor_mm: 0.01,
        sensing_mm_s: 300.0,
    };
}

impl Default for SheetConfig {
    /// No frames; all else as the documented textile plotter has it.
    fn default() -> Self {
        Self { frame_mm: 0.0, ..Self::TEXTILE_PLOTTER }
    }
}

/// Keys of the table.
pub(super) static RULES: [Rule; 6] = [
    number(
        "sheet.frame_mm",
        |c| c.sheet.frame_mm,
        (0.0, 100_000.0),
        "mm",
        "the documented textile plotter takes 900 to 1000, along y; 0 if the sheet cannot be moved",
    ),
    number(
        "sheet.begin_mm",
        |c| c.sheet.begin_mm,
        (0.0, 100_000.0),
        "mm",
        "the documented textile plotter has 20",
    ),
    number(
        "sheet.cut_window_mm",
        |c| c.sheet.cut_window_mm,
        (0.0, 1_000.0),
        "mm",
        "5 finds a good place for most cuts; 0 cuts at the border",
    ),
    number(
        "sheet.cut_clear_mm",
        |c| c.sheet.cut_clear_mm,
        (0.0, 100.0),
        "mm",
        "twice the pen's width is a good choice",
    ),
    number("sheet.anchor_mm", |c| c.sheet.anchor_mm, (0.0, 1.0), "mm", "0.01 cannot be seen at a joint"),
    number(
        "sheet.sensing_mm_s",
        |c| c.sheet.sensing_mm_s,
        (1.0, 10_000.0),
        "mm/s",
        "the documented textile plotter senses at 300",
    ),
];
