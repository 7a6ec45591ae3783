//! [`SvgReading`]: how SVG pictures are read, as options of the command line.

use crate::drawings::FontFiles;
use plotter_motion::dxf;
use plotter_vector::{Rgb, svg_in::SvgPens};
use std::str::FromStr;

/// The options for SVG pictures; other languages do not mind them.
#[derive(Clone, Debug, clap::Args)]
pub struct SvgReading {
    /// Fonts of its texts.
    #[command(flatten)]
    pub fonts: FontFiles,
    /// What is a pen in an SVG picture or a DXF: each colour, in the order in which they come; each layer, by
    /// the number that its name begins with; each layer, in their order [default: colour in SVG, where
    /// pictures written here have their own pens; order in DXF]
    #[arg(long, value_enum, value_name = "P")]
    pub pens: Option<PensBy>,
    /// Colour of the paper, which leaves no ink: what an SVG picture has in it is not drawn. As white, black
    /// or #ff8800; none draws all
    #[arg(long, value_name = "COLOUR", default_value = "white")]
    pub paper: Paper,
    /// Draws what clip paths, masks and the edges of nested sheets of an SVG picture cut off
    #[arg(long)]
    pub keep_clipped: bool,
    /// Hides what lies below filled shapes of an SVG picture, or below closed strokes of another drawing
    #[arg(long)]
    pub occlude: bool,
    /// Pixels to the inch of an SVG picture: 90 and 72 are those of older programs. Sizes in mm and inches
    /// stay what they are
    #[arg(long, value_name = "N", default_value = "96", value_parser = px_per_inch, allow_negative_numbers = true)]
    pub px_per_inch: f64,
}

impl Default for SvgReading {
    fn default() -> Self {
        Self {
            fonts: FontFiles::default(),
            pens: None,
            paper: Paper(Some(Rgb::WHITE)),
            keep_clipped: false,
            occlude: false,
            px_per_inch: 96.0,
        }
    }
}

/// What a pen stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum PensBy {
    /// Each colour
    Colour,
    /// Each layer, by the number that its name begins with
    Layer,
    /// Each layer, in their order
    Order,
}

impl From<PensBy> for SvgPens {
    fn from(by: PensBy) -> Self {
        match by {
            PensBy::Colour => Self::ByColour,
            PensBy::Layer => Self::ByLayer,
            PensBy::Order => Self::ByOrder,
        }
    }
}

impl From<PensBy> for dxf::Pens {
    fn from(by: PensBy) -> Self {
        match by {
            PensBy::Colour => Self::ByColour,
            PensBy::Layer => Self::ByLayerNumber,
            PensBy::Order => Self::ByLayer,
        }
    }
}

/// The colour of the paper, if it has one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Paper(pub Option<Rgb>);

impl FromStr for Paper {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lower = text.to_ascii_lowercase();
        if matches!(lower.as_str(), "none" | "transparent") {
            return Ok(Self(None));
        }
        Rgb::from_css(&lower).map(|colour| Self(Some(colour))).ok_or_else(|| {
            String::from("give a colour of CSS, as white, black, #ff8800 or rgb(255, 136, 0), or none")
        })
    }
}

fn px_per_inch(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| String::from("give a number, as 96, 90 or 72"))?;
    if (10.0..=10_000.0).contains(&number) {
        Ok(number)
    } else {
        Err("give a number from 10 to 10000".into())
    }
}
