#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod log;
mod virtual_plotter;

pub use virtual_plotter::{
    Anomaly, AnomalyKind, Leg, PlotterSettings, Reached, SettingsError, TrackPoint, VirtualPlotter,
};
