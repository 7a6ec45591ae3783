//! From the table `[vectorize]` of a machine's file to a [`Vectorizer`].

use plotter_motion::config::{PiecesChoice, StrokeOrder, ThresholdChoice, VectorizeConfig, VectorizeMode};
use plotter_vector::{
    Mode, Order, Ours, Threshold, ThresholdMethod, Vectorizer,
    areas::{AreaStyle, Areas, Hatch, MIN_PITCH_PX},
    order::OrderEffort,
    stroke::Pieces,
};

/// The vectorizer, ours, that a machine's file asks for; `mm_per_px` is the size of the picture's pixels on
/// the sheet.
///
/// # Errors
///
/// Hatching closer than the picture's pixels.
pub fn vectorizer(config: &VectorizeConfig, mm_per_px: f64) -> Result<Vectorizer, String> {
    Ok(Vectorizer::from(ours(config, mm_per_px)?).with_threshold(threshold(config.threshold)))
}

/// How ink is told from paper.
pub(crate) fn threshold(choice: ThresholdChoice) -> Threshold {
    let method = match choice {
        ThresholdChoice::Adaptive => ThresholdMethod::Adaptive,
        ThresholdChoice::Level(level) => ThresholdMethod::Level(level),
        ThresholdChoice::Otsu => ThresholdMethod::Otsu,
        _ => ThresholdMethod::Auto,
    };
    Threshold { method, ..Threshold::default() }
}

/// Ours; `mm_per_px` and errors as for [`vectorizer`].
///
/// # Errors
///
/// Hatching closer than the picture's pixels.
pub(crate) fn ours(config: &VectorizeConfig, mm_per_px: f64) -> Result<Ours, String> {
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
    let usual = Ours::default();
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
    let mut ours = usual
        .with_mode(mode)
        .with_tolerance_px(config.max_error_px)
        .with_pieces(pieces)
        .with_order(Order { effort, ..usual.order })
        .with_areas(areas);
    ours.max_line_px = (config.max_line_px > 0).then_some(config.max_line_px);
    Ok(ours)
}
