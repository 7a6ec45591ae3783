//! [`VectorizeConfig`]: what a machine's file says of how pictures become strokes.

use crate::areas::{AreaStyle, Areas, Hatch, MIN_PITCH_PX};
use crate::ink::{Threshold, ThresholdMethod};
use crate::order::{Order, OrderEffort};
use crate::stroke::Pieces;
use crate::trace::{Mode, Ours, Vectorizer};
use core::fmt;
use plotter_motion::config::{FileName, Key, Section};

/// How pictures become strokes for a machine: the table `[vectorize]` of its file.
///
/// With the feature `toml`, `plotter_motion::Machine::from_toml_with` reads it beside the machine.
///
/// ```
/// use plotter_vector::{Mode, trace::VectorizeConfig};
/// let mut config = VectorizeConfig::default();
/// config.mode = Mode::Mixed;
/// config.hatch_mm = 0.5;
/// let vectorizer = config.vectorizer(0.1)?; // of a picture whose pixels are 0.1 mm
/// assert!(vectorizer.ours().is_some_and(|ours| ours.mode == Mode::Mixed));
/// assert_eq!(
///     config.vectorizer(10.0).unwrap_err().to_string(),
///     "hatching: 0.5 mm are 0.050 px of 10 mm; give 5 mm or more"
/// );
/// # Ok::<(), plotter_vector::trace::TooCloseError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct VectorizeConfig {
    /// Whether lines are drawn by their middle or their outline.
    pub mode: Mode,
    /// Greatest distance of the ink from the strokes, px of the picture, 0.01 to 100.
    pub max_error_px: f64,
    /// What strokes are made of.
    pub pieces: Pieces,
    /// How ink is told from paper.
    pub threshold: ThresholdMethod,
    /// Pens that are told apart by their colours.
    pub pens: PensChoice,
    /// How hard an order with little travel is searched for.
    pub order: OrderEffort,
    /// From line to line of the hatching of areas, mm on the sheet; 0 for none.
    pub hatch_mm: f64,
    /// Width of the pen that areas are outlined and hatched with, mm on the sheet: its ink ends at their
    /// edge. 0 for that of a pixel.
    pub pen_mm: f64,
    /// Ink wider than this is an area, px of the picture; 0 finds it from the picture.
    pub max_line_px: u32,
    /// Threads to work with; 0 for one a core. The strokes are the same with any number.
    pub threads: u32,
    /// Picture of the strokes on the pale original that is written, from where the program runs.
    pub overlay: FileName,
}

impl VectorizeConfig {
    /// The same with another [`VectorizeConfig::mode`].
    #[must_use]
    pub const fn with_mode(self, mode: Mode) -> Self {
        Self { mode, ..self }
    }

    /// The same with another [`VectorizeConfig::max_error_px`].
    #[must_use]
    pub const fn with_max_error_px(self, max_error_px: f64) -> Self {
        Self { max_error_px, ..self }
    }

    /// The same with another [`VectorizeConfig::pieces`].
    #[must_use]
    pub const fn with_pieces(self, pieces: Pieces) -> Self {
        Self { pieces, ..self }
    }

    /// The same with another [`VectorizeConfig::threshold`].
    #[must_use]
    pub const fn with_threshold(self, threshold: ThresholdMethod) -> Self {
        Self { threshold, ..self }
    }

    /// The same with another [`VectorizeConfig::pens`].
    #[must_use]
    pub const fn with_pens(self, pens: PensChoice) -> Self {
        Self { pens, ..self }
    }

    /// The same with another [`VectorizeConfig::order`].
    #[must_use]
    pub const fn with_order(self, order: OrderEffort) -> Self {
        Self { order, ..self }
    }

    /// The same with another [`VectorizeConfig::hatch_mm`].
    #[must_use]
    pub const fn with_hatch_mm(self, hatch_mm: f64) -> Self {
        Self { hatch_mm, ..self }
    }

    /// The same with another [`VectorizeConfig::pen_mm`].
    #[must_use]
    pub const fn with_pen_mm(self, pen_mm: f64) -> Self {
        Self { pen_mm, ..self }
    }

    /// The same with another [`VectorizeConfig::max_line_px`].
    #[must_use]
    pub const fn with_max_line_px(self, max_line_px: u32) -> Self {
        Self { max_line_px, ..self }
    }

    /// The same with another [`VectorizeConfig::threads`].
    #[must_use]
    pub const fn with_threads(self, threads: u32) -> Self {
        Self { threads, ..self }
    }

    /// The same with another [`VectorizeConfig::overlay`].
    #[must_use]
    pub const fn with_overlay(self, overlay: FileName) -> Self {
        Self { overlay, ..self }
    }
}

impl Default for VectorizeConfig {
    /// The middle of lines to half a pixel, one pen, everything else found from the picture.
    fn default() -> Self {
        Self {
            mode: Mode::Centreline,
            max_error_px: 0.5,
            pieces: Pieces::Lines,
            threshold: ThresholdMethod::Auto,
            pens: PensChoice::Count(1),
            order: OrderEffort::Best,
            hatch_mm: 0.0,
            pen_mm: 0.0,
            max_line_px: 0,
            threads: 0,
            overlay: FileName::NONE,
        }
    }
}

impl VectorizeConfig {
    /// Ours as this asks for it; `mm_per_px` is the size of the picture's pixels on the sheet, mm.
    ///
    /// # Errors
    ///
    /// Hatching closer than the picture's pixels.
    pub fn vectorizer(&self, mm_per_px: f64) -> Result<Vectorizer, TooCloseError> {
        Ok(Vectorizer::from(self.ours(mm_per_px)?).with_threshold(self.threshold()))
    }

    /// How ink is told from paper.
    #[must_use]
    pub fn threshold(&self) -> Threshold {
        Threshold { method: self.threshold, ..Threshold::default() }
    }

    /// The settings of ours; `mm_per_px` is the size of the picture's pixels on the sheet, mm.
    ///
    /// # Errors
    ///
    /// Hatching closer than the picture's pixels.
    pub fn ours(&self, mm_per_px: f64) -> Result<Ours, TooCloseError> {
        let usual = Ours::default();
        let max_line_px = (self.max_line_px > 0).then_some(self.max_line_px);
        Ok(Ours {
            mode: self.mode,
            tolerance_px: self.max_error_px,
            pieces: self.pieces,
            max_line_px,
            order: Order { effort: self.order, ..usual.order },
            areas: self.areas(mm_per_px)?,
            ..usual
        })
    }

    fn areas(&self, mm_per_px: f64) -> Result<Areas, TooCloseError> {
        let mut areas = Ours::default().areas;
        if self.pen_mm > 0.0 {
            areas.pen_px = self.pen_mm / mm_per_px;
        }
        if self.hatch_mm > 0.0 {
            let pitch_px = self.hatch_mm / mm_per_px;
            if !(pitch_px.is_finite() && pitch_px >= MIN_PITCH_PX) {
                return Err(TooCloseError { hatch_mm: self.hatch_mm, mm_per_px });
            }
            areas.style = AreaStyle::OutlineAndHatch(Hatch { pitch_px, ..Hatch::default() });
        }
        Ok(areas)
    }
}

/// Hatching that is closer than the picture's pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooCloseError {
    /// From line to line, mm.
    pub hatch_mm: f64,
    /// Size of the picture's pixels, mm.
    pub mm_per_px: f64,
}

impl fmt::Display for TooCloseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { hatch_mm, mm_per_px } = self;
        write!(
            f,
            "hatching: {hatch_mm} mm are {:.3} px of {mm_per_px} mm; give {} mm or more",
            hatch_mm / mm_per_px,
            MIN_PITCH_PX * mm_per_px
        )
    }
}

impl core::error::Error for TooCloseError {}

/// Which pens are told apart by their colours. In a file a number, `"auto"`, or the path of a palette's TOML
/// file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PensChoice {
    /// So many; 1 draws all ink with one, by its grey level.
    Count(u32),
    /// As many as are found in the picture.
    Auto,
    /// Those of a palette's file, from where the program runs.
    Palette(FileName),
}

impl PensChoice {
    /// The choice that a text names: `"auto"`, or a path that ends in `.toml`; `None` for another.
    ///
    /// ```
    /// # use plotter_vector::trace::PensChoice;
    /// assert_eq!(PensChoice::from_text("auto"), Some(PensChoice::Auto));
    /// assert_eq!(PensChoice::from_text("three"), None);
    /// ```
    #[must_use]
    pub fn from_text(text: &str) -> Option<Self> {
        match text {
            "auto" => Some(Self::Auto),
            path if path.ends_with(".toml") => FileName::new(path).map(Self::Palette),
            _ => None,
        }
    }

    /// How many are asked for; 1 where the number is not known.
    const fn count(self) -> u32 {
        match self {
            Self::Count(pens) => pens,
            Self::Auto | Self::Palette(_) => 1,
        }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for PensChoice {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Count(pens) => serializer.serialize_u32(*pens),
            Self::Auto => serializer.serialize_str("auto"),
            Self::Palette(path) => serializer.serialize_str(path.as_str()),
        }
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for PensChoice {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        use serde::de::{Error, Unexpected};
        struct Visitor;
        impl serde::de::Visitor<'_> for Visitor {
            type Value = PensChoice;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number of pens, auto, or the path of a palette's TOML file")
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<PensChoice, E> {
                PensChoice::from_text(text).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
            }
            fn visit_u64<E: Error>(self, pens: u64) -> Result<PensChoice, E> {
                let fits = u32::try_from(pens).map(PensChoice::Count);
                fits.map_err(|_| E::invalid_value(Unexpected::Unsigned(pens), &self))
            }
            fn visit_i64<E: Error>(self, pens: i64) -> Result<PensChoice, E> {
                let fits = u32::try_from(pens).map(PensChoice::Count);
                fits.map_err(|_| E::invalid_value(Unexpected::Signed(pens), &self))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

/// Keys of the table.
static KEYS: [Key<VectorizeConfig>; 11] = [
    Key::choice("vectorize.mode", &["centreline", "outline", "mixed"]),
    Key::number("vectorize.max_error_px", |c| c.max_error_px, (0.01, 100.0), "px", "0.5 is half a pixel"),
    Key::choice("vectorize.pieces", &["lines", "arcs", "cubics"]),
    Key::whole_or_text(
        "vectorize.threshold",
        |c| if let ThresholdMethod::Level(level) = c.threshold { f64::from(level) } else { 0.0 },
        ((0.0, 255.0), "0 is black and 255 is white"),
        |text| text.parse::<ThresholdMethod>().is_ok(),
        "write \"auto\", \"otsu\", \"adaptive\" or a level from 0 to 255",
    ),
    Key::whole_or_text(
        "vectorize.pens",
        |c| f64::from(c.pens.count()),
        ((1.0, 16.0), "1 draws all ink with one pen"),
        |text| PensChoice::from_text(text).is_some(),
        "write a whole number from 1 to 16, \"auto\", or the path of a palette's file that ends in .toml and has at \
         most 127 bytes",
    ),
    Key::choice("vectorize.order", &["none", "fast", "best"]),
    Key::number(
        "vectorize.hatch_mm",
        |c| c.hatch_mm,
        (0.0, 1_000.0),
        "mm",
        "the pen's width closes the hatching, 0 is none",
    ),
    Key::number(
        "vectorize.pen_mm",
        |c| c.pen_mm,
        (0.0, 100.0),
        "mm",
        "a fineliner draws 0.3 to 0.8, 0 is a pixel of the picture",
    ),
    Key::whole("vectorize.threads", |c| f64::from(c.threads), (0.0, 1_024.0), "", "0 takes one a core"),
    Key::text("vectorize.overlay", FileName::MAX_BYTES),
    Key::whole(
        "vectorize.max_line_px",
        |c| f64::from(c.max_line_px),
        (0.0, 512.0),
        "px",
        "0 finds it from the picture",
    ),
];

impl Section for VectorizeConfig {
    const NAME: &'static str = "vectorize";

    fn keys() -> &'static [Key<Self>] {
        &KEYS
    }

    fn renamed() -> &'static [(&'static str, &'static str)] {
        &[
            ("arcs", "`pieces = \"arcs\"` for `arcs = true`, and nothing for `arcs = false`"),
            ("curves", "`pieces = \"cubics\"` for `curves = true`, and nothing for `curves = false`"),
        ]
    }
}
