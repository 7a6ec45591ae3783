//! [`VectorizeConfig`]: how pictures become strokes for a machine.
//!
//! Only what the machine's file says: this crate knows no pictures. Who vectorizes makes settings of it.

use super::FileName;

/// How pictures become strokes: the table `[vectorize]` of a machine's file.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct VectorizeConfig {
    /// What is drawn of the ink.
    pub mode: VectorizeMode,
    /// Greatest distance of the ink from the strokes, px of the picture.
    pub max_error_px: f64,
    /// What strokes are made of.
    pub pieces: PiecesChoice,
    /// How ink is told from paper.
    pub threshold: ThresholdChoice,
    /// Which pens are told apart by their colours.
    pub pens: PensChoice,
    /// How hard an order with little travel is searched for.
    pub order: StrokeOrder,
    /// From line to line of the hatching of areas, mm on the sheet; 0 for none.
    pub hatch_mm: f64,
    /// Width of the pen that areas are outlined and hatched with, mm on the sheet: its ink ends at their
    /// edge. 0 for that of a pixel.
    pub pen_mm: f64,
    /// What is wider is an area, px of the picture; 0 finds it.
    pub max_line_px: u32,
    /// Threads to work with; 0 for one a core. The strokes are the same with any number.
    pub threads: u32,
    /// Picture of the strokes on the pale original that is written, from where the program runs.
    pub overlay: FileName,
}

impl Default for VectorizeConfig {
    fn default() -> Self {
        Self {
            mode: VectorizeMode::Centreline,
            max_error_px: 0.5,
            pieces: PiecesChoice::Lines,
            threshold: ThresholdChoice::Auto,
            pens: PensChoice::Count(1),
            order: StrokeOrder::Best,
            hatch_mm: 0.0,
            pen_mm: 0.0,
            max_line_px: 0,
            threads: 0,
            overlay: FileName::NONE,
        }
    }
}

/// What is drawn of the ink.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum VectorizeMode {
    /// The middle of lines.
    #[default]
    Centreline,
    /// The outlines of everything.
    Outline,
    /// The middle of lines, and areas in their own style.
    Mixed,
}

/// What strokes are made of, where more than straight lines saves vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum PiecesChoice {
    /// Straight lines.
    #[default]
    Lines,
    /// Straight lines, circular arcs and circles.
    Arcs,
    /// Straight lines and cubic curves.
    Cubics,
}

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
    /// # use plotter_motion::config::PensChoice;
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
    pub(super) const fn count(self) -> u32 {
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
            fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
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

/// How hard an order of the strokes is searched for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum StrokeOrder {
    /// As they are found.
    None,
    /// From each end to the nearest stroke.
    Fast,
    /// With all improvements.
    #[default]
    Best,
}

/// How ink is told from paper. In a file `"auto"`, `"otsu"`, `"adaptive"`, or a level: `"128"` or `128`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ThresholdChoice {
    /// As the picture asks for: one level where that serves, else as photographs need it.
    #[default]
    Auto,
    /// One level for the whole sheet, found from the picture.
    Otsu,
    /// Another level in each place, for uneven light.
    Adaptive,
    /// Levels up to this one are dark.
    Level(u8),
}

impl ThresholdChoice {
    /// The choice that a text names; `None` if it names none.
    ///
    /// ```
    /// # use plotter_motion::config::ThresholdChoice;
    /// assert_eq!(ThresholdChoice::from_text("128"), Some(ThresholdChoice::Level(128)));
    /// assert_eq!(ThresholdChoice::from_text("256"), None);
    /// ```
    #[must_use]
    pub fn from_text(text: &str) -> Option<Self> {
        match text {
            "auto" => Some(Self::Auto),
            "otsu" => Some(Self::Otsu),
            "adaptive" => Some(Self::Adaptive),
            level => level.parse().ok().map(Self::Level),
        }
    }
}

impl core::fmt::Display for ThresholdChoice {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Otsu => f.write_str("otsu"),
            Self::Adaptive => f.write_str("adaptive"),
            Self::Level(level) => level.fmt(f),
        }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for ThresholdChoice {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for ThresholdChoice {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        use serde::de::{Error, Unexpected};
        struct Visitor;
        impl serde::de::Visitor<'_> for Visitor {
            type Value = ThresholdChoice;
            fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str("auto, otsu, adaptive or a level from 0 to 255")
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<ThresholdChoice, E> {
                ThresholdChoice::from_text(text).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
            }
            fn visit_u64<E: Error>(self, level: u64) -> Result<ThresholdChoice, E> {
                let fits = u8::try_from(level).map(ThresholdChoice::Level);
                fits.map_err(|_| E::invalid_value(Unexpected::Unsigned(level), &self))
            }
            fn visit_i64<E: Error>(self, level: i64) -> Result<ThresholdChoice, E> {
                let fits = u8::try_from(level).map(ThresholdChoice::Level);
                fits.map_err(|_| E::invalid_value(Unexpected::Signed(level), &self))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}
