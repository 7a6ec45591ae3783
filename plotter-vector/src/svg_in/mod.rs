//! [`read_svg`]: a drawing from an SVG file.
//!
//! `usvg` resolves what the format allows (styles, units, `use`, shapes, arcs) into paths with one matrix each; here
//! they become strokes: curves are cut into chords, dashes into strokes, and colours or layers become pens.

mod arc;
mod curve;
mod dash;
mod font_size;
#[cfg(feature = "svg-text")]
mod fonts;
mod ink;
mod survey;

use crate::{Drawing, PalettePen, Rgb, Scale};
use core::fmt;
#[cfg(feature = "svg-text")]
pub use fonts::{SvgFontError, SvgFonts, read_svg_with_fonts};
use ink::Ink;
use plotter_motion::Point;
use survey::Survey;
use usvg::roxmltree;

/// Size of an SVG pixel, mm: 1/96 inch (CSS Values and Units Level 3, section 5.2, "Absolute lengths").
const MM_PER_PX: f64 = 25.4 / 96.0;
/// Farthest place from the origin, px: 277 m. Single precision, in which paths are parsed, still tells 0.1 px there.
const MAX_PX: f64 = 1_048_576.0;
/// Chords finer or coarser than this are not for pens, mm.
const TOLERANCES_MM: core::ops::RangeInclusive<f64> = 0.001..=10.0;
/// Size of letters, and with it the length of an em, where the file gives none, px: `medium` of CSS Fonts Level 4, section 2.5, as
/// browsers have it.
const FONT_SIZE_PX: f32 = 16.0;
/// Stack of the parser, which recurses into nested elements: reserved, used as far as it is needed.
const STACK_BYTES: usize = 128 << 20;

/// Which strokes are of one pen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SvgPens {
    /// Those of one colour. Pens are numbered in the order in which they draw first; when there are more than
    /// [`MAX_PENS`](crate::MAX_PENS) colours, the others are drawn by the pen of the nearest one.
    #[default]
    ByColour,
    /// Those of one layer: of one group with an `id` at the top of the file, named by its `label` (that of Inkscape)
    /// or its `id`. What is in none of them is of one pen, too, whose name is empty. When there are more than
    /// [`MAX_PENS`](crate::MAX_PENS), the others are drawn by the pen of the nearest colour.
    ByLayer,
    /// All.
    One,
}

/// How an SVG file is read. The default keeps curves within 0.025 mm, the unit of HPGL, and takes white for the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SvgOptions {
    /// Greatest distance of a curve from its chords, both ways, mm; 0.001 to 10.
    pub tolerance_mm: f64,
    /// Curves that are arcs of a circle, within the tolerance or what a file's own arcs are parsed to, stay arcs instead of
    /// chords; not in dashes.
    pub arcs: bool,
    /// Which strokes are of one pen.
    pub pens: SvgPens,
    /// What has this colour leaves no ink: a background, say. `None` draws all.
    pub paper: Option<Rgb>,
    /// More vertices than this are refused.
    pub max_vertices: usize,
}

impl Default for SvgOptions {
    fn default() -> Self {
        Self {
            tolerance_mm: 0.025,
            arcs: false,
            pens: SvgPens::ByColour,
            paper: Some(Rgb::WHITE),
            max_vertices: 10_000_000,
        }
    }
}

/// What an SVG file holds and a pen does not draw, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SvgLeftOut {
    /// Texts: they have no outlines without their fonts. Give them (`read_svg_with_fonts`, feature `svg-text`), or make them paths
    /// in the editor.
    pub texts: usize,
    /// Line of the first of them in the file, from 1, where it can be told.
    pub text_line: Option<u32>,
    /// Pictures: [`Vectorizer`](crate::Vectorizer) traces them.
    pub images: usize,
    /// Line of the first of them in the file, from 1.
    pub image_line: Option<u32>,
    /// Clip paths: what they would cut off is drawn. Those of nested `svg` and `symbol` elements count too.
    pub clip_paths: usize,
    /// Masks: what they would hide is drawn.
    pub masks: usize,
    /// Filters: what they would change is drawn as it is.
    pub filters: usize,
    /// Shapes in the colour of the paper.
    pub paper: usize,
}

/// What the texts that are left out need. Without fonts, and without feature `svg-text`, it is not looked into which letters.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct SvgMissingFonts {
    /// Families that are asked for, of each text the first of its list; up to 16.
    pub families: Vec<String>,
    /// Letters that no given font has; up to 16.
    pub letters: String,
}

/// A drawing read from an SVG file.
#[derive(Clone, Debug, PartialEq)]
pub struct SvgDrawing {
    /// The strokes in the order of the file, px of SVG: 96 an inch, the sheet's upper left corner at (0, 0).
    /// Its size is the sheet's, rounded up to whole px; strokes may lie outside of it.
    pub drawing: Drawing,
    /// True to size, with the sheet's **lower left** corner at the origin. Another place or size:
    /// [`Scale::fit`] on the drawing's px.
    pub scale: Scale,
    /// Width of the sheet, mm.
    pub width_mm: f64,
    /// Height of the sheet, mm.
    pub height_mm: f64,
    /// The pens that draw something, from 1, with the colour of their first stroke. By colour, they are a
    /// [`Palette`](crate::Palette).
    pub pens: Vec<PalettePen>,
    /// What is not drawn.
    pub left_out: SvgLeftOut,
    /// The fonts for the texts among it.
    pub missing_fonts: SvgMissingFonts,
}

/// Why an SVG file cannot be read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SvgError {
    /// The tolerance is no tolerance.
    Tolerance {
        /// Asked tolerance, mm.
        tolerance_mm: f64,
    },
    /// There is nothing in the file.
    Empty,
    /// The file is compressed (`.svgz`).
    Compressed,
    /// The text is not UTF-8.
    Encoding {
        /// Bytes before the first wrong one.
        byte: usize,
    },
    /// The text is not XML, or it is cut off.
    Xml {
        /// What is wrong, and where.
        reason: String,
    },
    /// The root element is another one.
    NotSvg {
        /// Its name.
        root: String,
    },
    /// Width and height are missing or not positive.
    NoSize,
    /// The sheet is larger than any plotter's.
    Sheet {
        /// Its width, mm.
        width_mm: f64,
        /// Its height, mm.
        height_mm: f64,
    },
    /// A coordinate that is no number, or a huge one.
    Number {
        /// The element's line, from 1.
        line: u32,
        /// The attribute.
        attribute: String,
        /// What it holds.
        value: String,
    },
    /// A place far outside of any sheet.
    TooFar {
        /// To the right, mm.
        x_mm: f64,
        /// Down, mm.
        y_mm: f64,
    },
    /// An element refers to itself.
    Circular {
        /// Its id.
        id: String,
    },
    /// Elements are nested too deep, references followed.
    TooDeep {
        /// Greatest depth.
        limit: usize,
    },
    /// Too many elements, references followed.
    TooManyElements {
        /// Most elements.
        limit: usize,
    },
    /// The texts are longer than can be set, references followed.
    TooMuchText,
    /// More vertices than [`SvgOptions::max_vertices`].
    TooManyVertices {
        /// That limit.
        limit: usize,
    },
    /// The parser gave up without a reason, or had no room to begin.
    Parser,
}

impl fmt::Display for SvgError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tolerance { tolerance_mm } => write!(
                f,
                "tolerance: {tolerance_mm} mm lies outside {}..={} mm; 0.025 mm is a unit of HPGL",
                TOLERANCES_MM.start(),
                TOLERANCES_MM.end()
            ),
            Self::Empty => f.write_str("svg: the file is empty; export it again"),
            Self::Compressed => {
                f.write_str("svg: the file is compressed; unpack it with gunzip, or save it as .svg")
            }
            Self::Encoding { byte } => {
                write!(f, "svg: byte {byte} is not UTF-8; save the file in this encoding")
            }
            Self::Xml { reason } => write!(f, "svg: {reason}; if the file is cut off, export it again"),
            Self::NotSvg { root } => {
                write!(f, "svg: the root element is <{root}>, not <svg>; give an SVG file")
            }
            Self::NoSize => f.write_str(
                "svg: the sheet has no positive size; give <svg> a width and a height, or a viewBox",
            ),
            Self::Sheet { width_mm, height_mm } => write!(
                f,
                "svg: a sheet of {width_mm:.0} x {height_mm:.0} mm is larger than {:.0} mm; correct width and height",
                MAX_PX * MM_PER_PX
            ),
            Self::Number { line, attribute, value } => write!(
                f,
                "svg, line {line}: {attribute} holds {value}, which is no place on a sheet; correct it"
            ),
            Self::TooFar { x_mm, y_mm } => write!(
                f,
                "svg: a place at ({x_mm:.0}, {y_mm:.0}) mm lies farther out than {:.0} mm; correct its transform",
                MAX_PX * MM_PER_PX
            ),
            Self::Circular { id } => {
                write!(f, "svg: element {id:?} refers to itself; unlink the clones in it")
            }
            Self::TooDeep { limit } => write!(
                f,
                "svg: elements are nested deeper than {limit}, references followed; ungroup them, or unlink clones"
            ),
            Self::TooManyElements { limit } => {
                write!(
                    f,
                    "svg: more than {limit} elements, references followed; unlink clones, or split the file"
                )
            }
            Self::TooMuchText => f.write_str(
                "svg: the texts are too long to be set, references followed; split them or the file, unlink clones, or \
                 convert texts to paths",
            ),
            Self::TooManyVertices { limit } => write!(
                f,
                "svg: more than {limit} vertices; take a larger tolerance, simplify dashes, or raise `max_vertices`"
            ),
            Self::Parser => {
                f.write_str("svg: the parser gave up; save the file as plain SVG with paths only")
            }
        }
    }
}

impl core::error::Error for SvgError {}

/// Reads a drawing from the text of an SVG file.
///
/// Shapes, paths, `use`, groups, nested `svg`, style sheets, transforms, `viewBox` and units (mm, in, pt, px at 96 an inch) are
/// resolved as the format says. A shape is drawn along its stroke, however wide; one without a stroke along the border of its
/// fill, once. Curves become chords, or arcs where [`SvgOptions::arcs`] asks for them, dashes strokes, markers shapes; a line of
/// no length with round or square caps is a dot. What is hidden (`display`, `visibility`, opacity 0, no paint) is not drawn, nor
/// is what has the colour of the paper. The colour of a gradient is that of its first visible stop, of a pattern black. What no
/// pen draws is counted in [`SvgLeftOut`]. Other files are never opened.
///
/// Coordinates are parsed in single precision: to 0.001 px or 0.0003 mm up to 4 m from the origin. Arcs are first
/// made into cubic curves that are 0.03 % of the radius off at most, and no more than 0.1 of the file's units; that
/// adds to the tolerance, which is kept between those curves and the chords. A path is read up to its first error.
///
/// # Errors
/// [`SvgError`].
///
/// ```
/// use plotter_vector::{SvgOptions, hpgl, read_svg};
/// let file = r#"<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="50mm" viewBox="0 0 100 50">
///     <path d="M10 40 h80" stroke="black"/></svg>"#;
/// let read = read_svg(file.as_bytes(), &SvgOptions::default())?;
/// let mut text = String::new();
/// hpgl(&read.drawing, read.scale, &mut text)?;
/// assert!(text.contains("PU400,400;\nPD3600,400;\n")); // 10 mm from the left and from below: 40 units a mm
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_svg(bytes: &[u8], options: &SvgOptions) -> Result<SvgDrawing, SvgError> {
    on_own_stack(bytes, options, |text| parse(text, *options, &parser_options(), None))
}

/// Reads the text of a file on a stack that is large enough.
fn on_own_stack(
    bytes: &[u8],
    options: &SvgOptions,
    parse: impl FnOnce(&str) -> Result<SvgDrawing, SvgError> + Send,
) -> Result<SvgDrawing, SvgError> {
    if !TOLERANCES_MM.contains(&options.tolerance_mm) {
        return Err(SvgError::Tolerance { tolerance_mm: options.tolerance_mm });
    }
    if bytes.starts_with(&[0x1f, 0x8b]) {
        return Err(SvgError::Compressed);
    }
    let text =
        core::str::from_utf8(bytes).map_err(|error| SvgError::Encoding { byte: error.valid_up_to() })?;
    if text.trim_start_matches('\u{feff}').trim().is_empty() {
        return Err(SvgError::Empty);
    }
    // The caller's stack may be short of what nested elements need.
    std::thread::scope(|scope| {
        let parser = std::thread::Builder::new().name("svg".to_owned()).stack_size(STACK_BYTES);
        let parsed = parser.spawn_scoped(scope, || parse(text)).map_err(|_| SvgError::Parser)?;
        parsed.join().unwrap_or(Err(SvgError::Parser))
    })
}

/// `draw_whole` tells the texts that the parser has all outlines of; without it, it has none.
fn parse(
    text: &str,
    options: SvgOptions,
    parser: &usvg::Options<'_>,
    draw_whole: Option<&dyn Fn(&usvg::Text) -> bool>,
) -> Result<SvgDrawing, SvgError> {
    let limit = survey::MAX_ELEMENTS;
    let mut document = document_of(text)?;
    let numbered = font_size::with_numbers(text, &document);
    if let Some(text) = &numbered {
        document = document_of(text)?;
    }
    let survey = Survey::new(&document, draw_whole.is_some())?;
    let tree = usvg::Tree::from_xmltree(&document, parser).map_err(|error| match error {
        usvg::Error::InvalidSize => SvgError::NoSize,
        usvg::Error::ElementsLimitReached => SvgError::TooManyElements { limit },
        usvg::Error::ParsingFailed(roxmltree::Error::NodesLimitReached) => {
            SvgError::TooDeep { limit: survey::MAX_DEPTH }
        }
        error => SvgError::Xml { reason: error.to_string() },
    })?;
    let (width_px, height_px) = (f64::from(tree.size().width()), f64::from(tree.size().height()));
    let (width_mm, height_mm) = (width_px * MM_PER_PX, height_px * MM_PER_PX);
    let too_large = SvgError::Sheet { width_mm, height_mm };
    let whole = |px: f64| whole_px(px).ok_or_else(|| too_large.clone());
    let drawing = Drawing::new(whole(width_px)?, whole(height_px)?);
    // The last row of pixels may stick out below the sheet.
    let below_mm = height_mm - f64::from(drawing.height_px()) * MM_PER_PX;
    let scale =
        Scale::new(drawing.height_px(), MM_PER_PX, Point::new(0.0, below_mm)).map_err(|_| too_large)?;
    let mut ink = Ink::new(drawing, options, &survey.layers, draw_whole);
    ink.group(tree.root(), "")?;
    let (texts, text_line) = match draw_whole {
        None => (survey.texts.len(), survey.texts.first().map(|(_, line)| *line)),
        Some(_) => {
            let same =
                |(letters, line): &(String, u32)| (Some(letters) == ink.text.as_ref()).then_some(*line);
            (ink.left_out.texts, survey.texts.iter().find_map(same))
        }
    };
    let left_out =
        SvgLeftOut { texts, text_line, images: survey.images, image_line: survey.image_line, ..ink.left_out };
    Ok(SvgDrawing {
        drawing: ink.drawing,
        scale,
        width_mm,
        height_mm,
        pens: ink.pens,
        left_out,
        missing_fonts: SvgMissingFonts::default(),
    })
}

/// The elements of a file. Document types are common: entities in them are resolved, within the limits of the XML parser, but not
/// those in other files.
fn document_of(text: &str) -> Result<roxmltree::Document<'_>, SvgError> {
    let limit = survey::MAX_ELEMENTS;
    let nodes_limit = u32::try_from(limit).unwrap_or(u32::MAX);
    let xml = roxmltree::ParsingOptions { allow_dtd: true, nodes_limit, ..Default::default() };
    roxmltree::Document::parse_with_options(text, xml).map_err(|error| match error {
        roxmltree::Error::NodesLimitReached => SvgError::TooManyElements { limit },
        error => SvgError::Xml { reason: error.to_string() },
    })
}

/// No files, no pictures: neither from a path in the file, nor from data in it.
fn parser_options() -> usvg::Options<'static> {
    usvg::Options {
        font_size: FONT_SIZE_PX,
        image_href_resolver: usvg::ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..Default::default()
    }
}

/// Rounded up; `None` when it is larger than any sheet, or no number.
fn whole_px(px: f64) -> Option<u32> {
    if !(0.0..=MAX_PX).contains(&px) {
        return None;
    }
    // Sizes in mm come to whole px only nearly.
    let px = libm::ceil(px - 1e-3).max(1.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "within 1..=2^20, checked above"
    )]
    let whole = px as u32;
    Some(whole)
}

#[cfg(test)]
mod tests;
