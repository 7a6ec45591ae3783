//! All integration tests of the crate as one program, which is linked once; a module is a subject.
//!
//! `cargo test -p plotter-vector --test all SUBJECT::` runs those of one.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test fails by a panic, and prints its tables"
)]

mod bare_ink;
mod blurred_corners;
mod centrelines;
mod cut_lines;
mod doubt;
mod evened;
#[cfg(feature = "image")]
mod fewest_vertices;
#[path = "../../../plotter-motion/tests/all/figure.rs"]
mod figure;
mod file_rows;
mod file_rows_memory;
mod follow_drawings;
mod follow_figures;
mod follow_kinds;
mod frechet;
mod hairline_widths;
#[path = "../../../plotter-motion/tests/all/law_cases.rs"]
mod law_cases;
mod layers;
mod level_lines;
mod line_ends;
mod lines;
#[cfg(feature = "toml")]
mod machine_sections;
#[cfg(feature = "svg-text")]
mod made_font;
mod marks_on_lines;
mod off_lines;
#[cfg(feature = "image")]
mod order_against_vpype;
#[cfg(target_os = "linux")]
mod order_memory;
mod outline_mode;
#[cfg(target_os = "linux")]
mod own_process;
mod pen_ink;
mod prop_arcs;
mod prop_areas;
mod prop_bounded;
mod prop_cubics;
mod prop_follow;
mod prop_follow_bad_input;
mod prop_followed;
mod prop_inside;
mod prop_layers;
mod prop_order;
mod prop_order_on_sheet;
mod prop_polyline;
mod prop_sheet;
mod prop_svg;
mod prop_thinning;
mod prop_tracking;
mod random;
#[path = "../../../plotter-motion/tests/all/sampled.rs"]
mod sampled;
mod seams;
mod segment_distance;
#[cfg(all(feature = "serde", feature = "svg-in", feature = "toml"))]
mod serde_settings;
mod sharp_points;
mod sheet_cancelled;
mod sheet_memory;
mod sheet_of_hairlines;
mod sheet_of_many_rows;
mod sim_follow;
mod sim_follow_connected;
mod small_marks;
mod straight_lines;
mod svg_text;
mod thin_lines;
mod thinning_ends;
mod threads;
mod told_spots;
mod uneven_light;
