//! All integration tests of the crate as one program, which is linked once; a module is a subject.
//!
//! `cargo test -p plotter-motion --test all SUBJECT::` runs those of one.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test fails by a panic, and prints its tables"
)]

mod auditor;
mod closed_loop;
mod config_messages;
mod config_preset;
mod drawings;
#[cfg(all(feature = "alloc", feature = "font"))]
mod dxf_kinds;
mod estimate;
mod exact_discretization;
mod felt;
mod figure;
#[cfg(feature = "step-ahead")]
mod firmware_ahead;
#[cfg(feature = "averaged-steps")]
mod firmware_averaged;
mod firmware_by_hand;
mod firmware_grbl;
mod firmware_grbl_table;
mod firmware_grbl_waits;
mod firmware_mdraw;
mod firmware_two_tasks;
#[cfg(feature = "third-motor")]
mod firmware_z;
#[cfg(all(feature = "step-ahead", feature = "third-motor"))]
mod firmware_z_ahead;
mod gcode_interpreter;
#[cfg(feature = "alloc")]
mod gcode_kinds;
mod gcode_producers;
mod gcode_reader;
mod gcode_real_files;
mod host_of_hpgl;
mod host_of_marlin;
mod hpgl_against_hp2xx;
mod hpgl_characters;
mod hpgl_coordinates;
mod hpgl_cutters;
mod hpgl_encoded;
mod hpgl_interpreter;
mod hpgl_labels;
mod hpgl_lines;
mod hpgl_polygons;
mod hpgl_reader;
mod hpgl_real_files;
mod hpgl_turned_frame;
mod hpgl_writer;
mod law_cases;
mod link_session;
mod loaded_gantry;
#[cfg(feature = "build")]
mod machine_constants;
mod marking;
mod messages;
mod papers;
mod pen_ends_up;
mod planner_ends;
mod profile_many;
mod prop_belt_limits;
mod prop_bresenham;
mod prop_budget;
mod prop_config;
mod prop_control;
#[cfg(feature = "alloc")]
mod prop_cut;
#[cfg(feature = "alloc")]
mod prop_drawing;
mod prop_ebb;
mod prop_gcode;
mod prop_homing;
mod prop_hpgl;
mod prop_hpgl_thesis_text;
mod prop_kinematics;
#[cfg(feature = "alloc")]
mod prop_lines;
mod prop_link;
mod prop_marking_board;
mod prop_motion;
mod prop_planner;
mod prop_protocol;
mod prop_settings_bytes;
mod prop_stepper_plotter;
mod prop_testbed;
mod prop_tuning;
mod real_files;
mod sampled;
mod serde_plot_ops;
#[cfg(feature = "serde")]
mod serde_settings;
mod short_chords;
mod shown;
mod sim_averaged;
mod sim_backlash;
mod sim_bad_wiring;
mod sim_bench;
mod sim_contour;
mod sim_ebb;
mod sim_enable_pwm;
mod sim_every_line_ends;
mod sim_grbl;
mod sim_klipper;
#[cfg(feature = "third-motor")]
mod sim_lift;
mod sim_marking_board;
mod sim_planner;
mod sim_s_curve_bound;
mod sim_short_chords;
mod sim_stall;
mod sim_stepgen;
mod sim_stepper;
mod sim_stepper_plotter;
mod sim_stop;
mod sim_testbed;
mod sim_thesis_step;
mod sim_tuning;
mod sim_vector_optimum;
mod sim_whole_drawings;
mod stepper_bench;
mod switches;
mod tuning_bench;
