//! From the table `[vectorize]` of a machine's file to a [`Vectorizer`].

use plotter_motion::config::{PiecesChoice, StrokeOrder, ThresholdChoice, VectorizeConfig, VectorizeMode};
use plotter_vector::{
    Mode, Order, Threshold, ThresholdMethod, Vectorizer,
    areas::{AreaStyle, Areas, Hatch, MIN_PITCH_PX},
    order::OrderEffort,
    stroke::{Bounded, Pieces},
};

/// The vectorizer, ours, that a machine's file asks for; `mm_per_px` is the size of the picture's pixels on
/// the sheet.
///
/// # Errors
///
/// Hatching closer than the picture's pixels.
pub fn vectorizer(config: &VectorizeConfig, mm_per_px: f64) -> Result<Vectorizer, String> {
    let method = match config.threshold {
        ThresholdChoice::Adaptive => ThresholdMethod::Adaptive,
        ThresholdChoice::Level(level) => ThresholdMethod::Level(level),
        ThresholdChoice::Otsu => ThresholdMethod::Otsu,
        _ => ThresholdMethod::Auto,
    };
    let mode = match config.mode {
        VectorizeMode::Outline => Mode::Outline,
        VectorizeMode::Mixed => Mode::Mixed,
        _ => Mode::Centreline,
    };
    let effort = match config.order {
        StrokeOrder::None => OrderEffort::None,
        StrokeOrder::Fast => OrderEffort::Fast,
        _ => OrderEffort::Best,
    };
    let pieces = match config.pieces {
        PiecesChoice::Arcs => Pieces::Arcs,
        PiecesChoice::Cubics => Pieces::Cubics,
        _ => Pieces::Lines,
    };
    let usual = Vectorizer::default();
    let mut areas = usual.areas;
    if config.pen_mm > 0.0 {
        areas.pen_px = config.pen_mm / mm_per_px;
    }
    if config.hatch_mm > 0.0 {
        let pitch_px = config.hatch_mm / mm_per_px;
        if !(pitch_px.is_finite() && pitch_px >= MIN_PITCH_PX) {
            return Err(format!(
                "hatching: {} mm are {pitch_px:.3} px of {mm_per_px} mm; give {} mm or more",
                config.hatch_mm,
                MIN_PITCH_PX * mm_per_px
            ));
        }
        areas = Areas { style: AreaStyle::OutlineAndHatch(Hatch { pitch_px, ..Hatch::default() }), ..areas };
    }
    Ok(Vectorizer {
        mode,
        threshold: Threshold { method, ..usual.threshold },
        ours: Bounded { tolerance_px: config.max_error_px },
        pieces,
        max_line_px: (config.max_line_px > 0).then_some(config.max_line_px),
        order: Order { effort, ..usual.order },
        areas,
        ..usual
    })
}
