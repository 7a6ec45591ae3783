//! Parameters of every kind of degradation, at each strength.

use super::kind::Strength;
use core::fmt::Write as _;

/// A number of a kind of degradation at its three strengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// The kinds that it belongs to.
    pub kinds: &'static str,
    /// Meaning.
    pub name: &'static str,
    /// Unit. A *level* is one of 256 steps from black to white.
    pub unit: &'static str,
    /// Weak, middle and strong.
    pub values: [f64; 3],
    /// Why these numbers.
    pub reason: &'static str,
}

impl Parameter {
    pub(crate) fn at(&self, strength: Strength) -> f64 {
        let [weak, middle, strong] = self.values;
        match strength {
            Strength::Weak => weak,
            Strength::Middle => middle,
            Strength::Strong => strong,
        }
    }
}

macro_rules! parameters {
    ($($id:ident: $kinds:literal, $name:literal, $unit:literal, $values:expr, $reason:literal;)*) => {
        $(pub(crate) const $id: Parameter =
            Parameter { kinds: $kinds, name: $name, unit: $unit, values: $values, reason: $reason };)*

        /// All of them.
        pub const PARAMETERS: &[Parameter] = &[$($id),*];
    };
}

parameters! {
    CLEAN_BLUR: "clean", "blur, sd", "px", [0.4, 0.6, 0.9], "lens of a scanner at its own resolution; at 0.9 enlarged a little";
    CLEAN_NOISE: "clean", "noise, sd", "level", [1.5, 2.5, 5.0], "sensor of a scanner, new to old";
    CLEAN_PAPER: "clean", "tone of the paper", "level", [247.0, 240.0, 226.0], "white, usual and recycled paper";
    CLEAN_INK: "clean", "tone of the ink", "level", [25.0, 40.0, 70.0], "fineliner to ball pen";
    PENCIL_INK: "pencil", "tone of graphite", "level", [85.0, 110.0, 140.0], "B, HB, H on a scanner";
    PENCIL_GAPS: "pencil", "share of the line that the tooth of the paper keeps free", "", [0.06, 0.14, 0.26], "smooth to drawing paper";
    PENCIL_BLUR: "pencil", "soft rim, sd", "px", [0.8, 1.0, 1.3], "a point that is worn";
    PENCIL_PRESS: "pencil", "change of the pressure, sd", "share", [0.06, 0.1, 0.15], "an even to a quick hand";
    CHALK_BOARD: "chalk", "tone of the board", "level", [45.0, 55.0, 75.0], "washed, wiped, wiped often";
    CHALK_INK: "chalk", "tone of chalk", "level", [225.0, 215.0, 195.0], "pressed firmly to lightly";
    CHALK_GAPS: "chalk", "share of the line that stays free", "", [0.06, 0.13, 0.24], "as pencil: the board's grain is coarser";
    CHALK_SMEAR: "chalk", "dust that wipes have left, greatest", "level", [10.0, 22.0, 40.0], "seen on boards; 40 is a fifth of the line's contrast";
    MARKER_BLUR: "marker", "soft rim, sd", "px", [0.8, 1.3, 2.0], "absorbing paper; a rim of about two, three and five pixels";
    MARKER_CREEP: "marker", "uneven rim, sd", "px", [0.2, 0.4, 0.7], "ink that follows fibres";
    MARKER_STREAKS: "marker", "streaks in the ink, sd", "level", [6.0, 12.0, 22.0], "full to nearly dry";
    PHOTO_LEAST: "photo", "light at the darkest place, of that at the brightest", "share", [0.65, 0.45, 0.30], "middle: measured on a sheet by a window; strong: one lamp beside it";
    PHOTO_NOISE: "photo", "noise, sd", "level", [2.5, 5.0, 9.0], "a telephone by day, in a room, in the evening";
    PHOTO_BLUR: "photo", "blur, sd", "px", [0.6, 0.8, 1.2], "in focus to a little out of it";
    GLARE_COUNT: "reflections", "bright patches", "", [1.0, 2.0, 3.0], "middle: a photograph with two windows in it";
    GLARE_LEVEL: "reflections", "brightness of a patch above the paper", "level", [50.0, 80.0, 115.0], "middle: measured on a photograph, 115 to 203; at 115 paper is all white";
    GLARE_LEAST: "reflections", "light at the darkest place, of that at the brightest", "share", [0.75, 0.6, 0.5], "a window is bright where the rest is dim";
    SQUARED_LEVEL: "squared", "contrast of the ruling", "level", [35.0, 70.0, 95.0], "middle: measured on a photograph, 230 to 160";
    SQUARED_LEAST: "squared", "light at the darkest place, of that at the brightest", "share", [0.8, 0.55, 0.45], "middle: measured on the same photograph";
    TABLE_TILT: "perspective", "how far a corner of the sheet is from that of a rectangle", "share of the width", [0.02, 0.06, 0.11], "by hand from above, usual, from a chair";
    TABLE_LEVEL: "perspective", "brightness of the table", "level", [85.0, 110.0, 140.0], "dark to light wood; paper has 235";
    TABLE_LEAST: "perspective", "light at the darkest place, of that at the brightest", "share", [0.85, 0.7, 0.55], "weaker than photo: this is about the sheet's place";
    JPEG_QUALITY: "jpeg", "quality", "", [50.0, 25.0, 12.0], "middle: pictures that were sent on twice; at 12 blocks are seen without looking for them";
    ENLARGED_FACTOR: "enlarged_nearest, enlarged_bicubic", "enlargement", "", [2.0, 3.0, 5.0], "a preview or an icon made as large as a drawing";
    ENLARGED_LEAST: "enlarged_nearest, enlarged_bicubic", "thinnest pen before the enlargement", "px", [1.2, 1.2, 1.2], "what small drawings are made with; thinner would be faint";
    ENLARGED_JPEG: "enlarged_nearest, enlarged_bicubic", "quality of JPEG afterwards, on every second drawing", "", [75.0, 75.0, 75.0], "the usual setting of programs that save pictures";
    FAINT_LEVEL: "faint", "contrast of the lines", "level", [32.0, 20.0, 12.0], "a hard pencil or a worn stamp; strong: four times the noise";
    FAINT_NOISE: "faint", "noise, sd", "level", [3.0, 3.0, 3.0], "a scanner whose contrast was raised";
    BLEED_SHARE: "bleed_through", "contrast of the back, of that of the front", "share", [0.08, 0.14, 0.20], "thick to thin paper";
    BLEED_BLUR: "bleed_through", "blur of the back, sd", "px", [2.0, 2.5, 3.0], "light scattered on its way through";
    NEWS_PAPER: "newsprint", "tone of the paper", "level", [215.0, 200.0, 180.0], "fresh to old";
    NEWS_INK: "newsprint", "tone of the ink", "level", [50.0, 65.0, 85.0], "ink that has sunk in";
    NEWS_SPECKS: "newsprint", "dark specks on 100 x 100 px", "", [3.0, 8.0, 16.0], "shives in wood pulp";
    NEWS_SPECK_LEVEL: "newsprint", "contrast of specks and fibres, greatest", "level", [40.0, 60.0, 85.0], "less than the ink's";
    NEWS_MOTTLE: "newsprint", "mottled tone, sd", "level", [4.0, 7.0, 11.0], "uneven pulp held against light";
    NEWS_SPREAD: "newsprint", "uneven rim, sd", "px", [0.3, 0.5, 0.8], "ink that follows fibres";
}

/// All parameters as a table, for the page about them.
#[must_use]
pub fn parameter_table() -> String {
    let mut table = String::from("| kind | parameter | weak, middle, strong | why |\n|---|---|---|---|\n");
    for Parameter { kinds, name, unit, values: [weak, middle, strong], reason } in PARAMETERS {
        let kinds: Vec<String> = kinds.split(", ").map(|kind| format!("`{kind}`")).collect();
        let unit = if unit.is_empty() { String::new() } else { format!(", {unit}") };
        let kinds = kinds.join(", ");
        // Writing to a string does not fail.
        let _ = writeln!(table, "| {kinds} | {name}{unit} | {weak}, {middle}, {strong} | {reason} |");
    }
    table
}
