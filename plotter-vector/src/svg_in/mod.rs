//! [`read_svg`]: a drawing from an SVG file.
//!
//! `usvg` resolves what the format allows (styles, units, `use`, shapes, arcs) into paths with one matrix
//! each; here they become strokes: curves are cut into chords, dashes into strokes, and colours or layers
//! become pens. What `usvg` would leave out without a word is put into its words before (`rewrite`), and clip
//! paths and masks cut the strokes (`region`).

mod arc;
mod blank_nodes;
mod box_tree;
mod chunks;
mod clip;
mod css_transform;
mod curve;
mod cut_far;
mod dash;
mod font_size;
#[cfg(feature = "svg-text")]
mod fonts;
mod ink;
mod layers;
mod mask;
mod moves;
mod one_line;
mod paint;
mod pens;
mod region;
mod rewrite;
#[cfg(feature = "svg-text")]
mod single_stroke;
mod survey;

use crate::{
    ink::PalettePen,
    picture::Rgb,
    stroke::{Drawing, Scale},
};
use blank_nodes::without_blank_nodes;
use core::fmt;
#[cfg(feature = "svg-text")]
pub use fonts::{SvgFontError, SvgFonts, read_svg_with_fonts};
use ink::Ink;
pub use layers::SvgLayer;
use plotter_motion::Point;
use plotter_motion::drawing::{HatchError, Hatching};
use rewrite::Rewritten;
use std::borrow::Cow;
use survey::Survey;
use usvg::roxmltree;

/// Pixels to the inch of CSS (CSS Values and Units Level 3, section 5.2, "Absolute lengths").
const PX_PER_INCH: f64 = 96.0;
/// Pixels to the inch that a file may have: 72 and 90 are those of older programs.
const PX_PER_INCHES: core::ops::RangeInclusive<f64> = 10.0..=10_000.0;
/// Millimetres to the inch.
const MM_PER_INCH: f64 = 25.4;
/// Farthest place from the origin, px: 277 m. Single precision, in which paths are parsed, still tells 0.1 px
/// there.
const MAX_PX: f64 = 1_048_576.0;
/// Chords finer or coarser than this are not for pens, mm.
const TOLERANCES_MM: core::ops::RangeInclusive<f64> = 0.001..=10.0;
/// Size of letters, and with it the length of an em, where the file gives none, px: `medium` of CSS Fonts
/// Level 4, section 2.5, as browsers have it.
const FONT_SIZE_PX: f32 = 16.0;
/// Stack of the parser, which recurses into nested elements: reserved, used as far as it is needed.
const STACK_BYTES: usize = 128 << 20;
/// Deepest nesting where no thread can be had, as on wasm32, and the caller's stack has to do: that is 1 MB
/// there, of which a level takes some 10 kB.
const MAX_DEPTH_ON_CALLERS_STACK: usize = 48;

/// Which strokes are of one pen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum SvgPens {
    /// Those of one colour. Pens are numbered in the order in which they draw first; when there are more than
    /// [`MAX_PENS`](crate::ink::MAX_PENS) colours, the others are drawn by the pen of the nearest one, and
    /// counted ([`SvgWithoutPen`]).
    #[default]
    ByColour,
    /// Those of one [`SvgLayer`]: the pen is the number that its name begins with. Layers without a number
    /// have the next free one each, in the order of the file, and so has what is in no layer: its pen has no
    /// name. When there are more than 255, the others are drawn by the pen of the nearest colour, and counted
    /// ([`SvgWithoutPen`]).
    ByLayer,
    /// Those of one layer, whatever its name: the first that draws something is pen 1.
    ByOrder,
    /// All.
    One,
}

/// How an SVG file is read. The default keeps curves within 0.025 mm, the unit of HPGL, and takes white for
/// the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct SvgOptions {
    /// Greatest distance of a curve from its chords, both ways, mm; 0.001 to 10.
    pub tolerance_mm: f64,
    /// Curves that are arcs of a circle, within the tolerance or what a file's own arcs are parsed to, stay
    /// arcs instead of chords; not in dashes.
    pub arcs: bool,
    /// Which strokes are of one pen.
    pub pens: SvgPens,
    /// What has this colour leaves no ink: a background, say. `None` draws all.
    pub paper: Option<Rgb>,
    /// More vertices than this are refused; so many edges may clip paths and masks have, too.
    pub max_vertices: usize,
    /// Whether what clip paths, masks and the edges of nested `svg` elements cut off is drawn all the same.
    pub keeps_clipped: bool,
    /// Whether filled shapes hide what lies below them, also those in the colour of the paper; those that are
    /// less than half opaque do not.
    pub occludes: bool,
    /// Fills each closed shape with lines, which fills that are drawn later hide with
    /// [`occludes`](Self::occludes), and clip paths cut. The distance is in mm of the sheet, the angle
    /// counter-clockwise as on the sheet; the lines of all shapes lie at odd multiples of half the distance
    /// from the sheet's upper left corner. Dashed shapes are left as they are.
    pub hatch: Option<Hatching>,
    /// Pixels to the inch: 96 in the standard, 72 and 90 in files of older programs. Lengths in mm and inches
    /// are what they are.
    pub px_per_inch: f64,
}

impl SvgOptions {
    /// The same with another [`SvgOptions::tolerance_mm`].
    #[must_use]
    pub const fn with_tolerance_mm(self, tolerance_mm: f64) -> Self {
        Self { tolerance_mm, ..self }
    }

    /// The same with another [`SvgOptions::arcs`].
    #[must_use]
    pub const fn with_arcs(self, arcs: bool) -> Self {
        Self { arcs, ..self }
    }

    /// The same with another [`SvgOptions::pens`].
    #[must_use]
    pub const fn with_pens(self, pens: SvgPens) -> Self {
        Self { pens, ..self }
    }

    /// The same with another [`SvgOptions::paper`].
    #[must_use]
    pub const fn with_paper(self, paper: Option<Rgb>) -> Self {
        Self { paper, ..self }
    }

    /// The same with another [`SvgOptions::max_vertices`].
    #[must_use]
    pub const fn with_max_vertices(self, max_vertices: usize) -> Self {
        Self { max_vertices, ..self }
    }

    /// The same with another [`SvgOptions::keeps_clipped`].
    #[must_use]
    pub const fn with_keeps_clipped(self, keeps_clipped: bool) -> Self {
        Self { keeps_clipped, ..self }
    }

    /// The same with another [`SvgOptions::occludes`].
    #[must_use]
    pub const fn with_occludes(self, occludes: bool) -> Self {
        Self { occludes, ..self }
    }

    /// The same with another [`SvgOptions::hatch`].
    #[must_use]
    pub const fn with_hatch(self, hatch: Option<Hatching>) -> Self {
        Self { hatch, ..self }
    }

    /// The same with another [`SvgOptions::px_per_inch`].
    #[must_use]
    pub const fn with_px_per_inch(self, px_per_inch: f64) -> Self {
        Self { px_per_inch, ..self }
    }
}

impl SvgOptions {
    /// Size of a pixel, mm.
    fn mm_per_px(&self) -> f64 {
        MM_PER_INCH / self.px_per_inch
    }
}

impl Default for SvgOptions {
    fn default() -> Self {
        Self {
            tolerance_mm: 0.025,
            arcs: false,
            pens: SvgPens::ByColour,
            paper: Some(Rgb::WHITE),
            max_vertices: 10_000_000,
            keeps_clipped: false,
            occludes: false,
            hatch: None,
            px_per_inch: PX_PER_INCH,
        }
    }
}

/// What an SVG file holds and a pen does not draw, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SvgLeftOut {
    /// Texts: they have no outlines without their fonts. Give them (`read_svg_with_fonts`, feature
    /// `svg-text`), or make them paths in the editor.
    pub texts: usize,
    /// Line of the first of them in the file, from 1, where it can be told.
    pub text_line: Option<u32>,
    /// Pictures: [`Vectorizer`](crate::trace::Vectorizer) traces them.
    pub images: usize,
    /// Line of the first of them in the file, from 1.
    pub image_line: Option<u32>,
    /// Groups of which a clip path cuts something off, or the edge of a nested `svg`, a `symbol` or a marker.
    /// With [`SvgOptions::keeps_clipped`], none.
    pub clip_paths: usize,
    /// Groups of which a mask hides something.
    pub masks: usize,
    /// Filters: what they would change is drawn as it is.
    pub filters: usize,
    /// Strokes that filled shapes hide, or a part of them, with [`SvgOptions::occludes`].
    pub occluded: usize,
    /// Shapes in the colour of the paper.
    pub paper: usize,
    /// Shapes of which a part lies farther than 277 m from the corner of the sheet, where it is cut off. They
    /// are not hatched.
    pub far: usize,
}

/// What is drawn by the pen of another colour, since all pens are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SvgWithoutPen {
    /// Colours without a pen of their own; layers, where these are what pens stand for.
    pub kinds: usize,
    /// Shapes of these colours, or in these layers.
    pub shapes: usize,
}

/// What the texts that are left out need. Without fonts, and without feature `svg-text`, it is not looked
/// into which letters.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct SvgMissingFonts {
    /// Families that are asked for, of each text the first of its list; up to 16.
    pub families: Vec<String>,
    /// Letters that no given font has; up to 16.
    pub letters: String,
}

/// Something of a file that is not done as it says, and where.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SvgProblem {
    /// Line of the file, from 1.
    pub line: u32,
    /// Letter in the line, from 1.
    pub column: u32,
    /// The part of the file, and what was done instead.
    pub text: String,
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
    /// [`Palette`](crate::ink::Palette).
    pub pens: Vec<PalettePen>,
    /// What none of them is for.
    pub without_pen: SvgWithoutPen,
    /// What is not drawn.
    pub left_out: SvgLeftOut,
    /// The fonts for the texts among it.
    pub missing_fonts: SvgMissingFonts,
    /// The layers, in the order of the file.
    pub layers: Vec<SvgLayer>,
    /// What is not done as the file says; up to 64.
    pub problems: Vec<SvgProblem>,
    /// Closed shapes that [`SvgOptions::hatch`] has filled.
    pub hatched: usize,
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
    /// The pixels to the inch are no such number.
    PxPerInch {
        /// Asked pixels to the inch.
        px_per_inch: f64,
    },
    /// The text is neither UTF-8 nor, with its mark, UTF-16.
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
    /// A number of the sheet itself, its size or its `viewBox`, that is huge.
    Number {
        /// The element's line, from 1.
        line: u32,
        /// The attribute.
        attribute: String,
        /// What it holds.
        value: String,
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
    /// Clip paths, masks or shapes that hide others take too long, or too much memory.
    TooMuchClipping,
    /// The texts are longer than can be set, references followed.
    TooMuchText,
    /// Shapes cannot be filled so.
    Hatch(HatchError),
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
            Self::PxPerInch { px_per_inch } => write!(
                f,
                "px per inch: {px_per_inch} lies outside {}..={}; 96 is that of the standard, 90 and 72 those of older programs",
                PX_PER_INCHES.start(),
                PX_PER_INCHES.end()
            ),
            Self::Empty => f.write_str("svg: the file is empty; export it again"),
            Self::Compressed => {
                f.write_str("svg: the file is compressed; unpack it with gunzip, or save it as .svg")
            }
            Self::Encoding { byte } => {
                write!(f, "svg: byte {byte} is neither UTF-8 nor UTF-16 with its mark; save the file as UTF-8")
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
                MAX_PX * MM_PER_INCH / PX_PER_INCH
            ),
            Self::Number { line, attribute, value } => write!(
                f,
                "svg, line {line}: {attribute} holds {value}, which is no place on a sheet; correct it"
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
            Self::TooMuchClipping => f.write_str(
                "svg: cutting along clip paths, masks or shapes takes too long; simplify them, or draw what they cut off",
            ),
            Self::Hatch(error) => write!(f, "svg: {error}"),
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

impl core::error::Error for SvgError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Hatch(error) => Some(error),
            _ => None,
        }
    }
}

/// Reads a drawing from the text of an SVG file.
///
/// Shapes, paths, `use`, groups, nested `svg`, style sheets, transforms, `viewBox` and units (mm, in, pt, px
/// at 96 an inch) are resolved as the format says. A shape is drawn along its stroke, however wide; one
/// without a stroke along the border of its fill, once. Curves become chords, or arcs where
/// [`SvgOptions::arcs`] asks for them, dashes strokes, markers shapes; a line of no length with round or
/// square caps is a dot. What is hidden (`display`, `visibility`, opacity 0, no paint) is not drawn, nor is
/// what has the colour of the paper, what clip paths, masks and nested `svg` elements cut off, or a layer
/// whose name begins with `%`. A mask shows where luminance times alpha is at least one half. The colour of a
/// gradient is that of its first visible stop, of a pattern or of a paint that is not known black. What no
/// pen draws is counted in [`SvgLeftOut`], what is done otherwise than the file says told in
/// [`SvgDrawing::problems`]. Other files are never opened.
///
/// Where no thread can be had, as on wasm32, elements may be nested 48 deep instead of 1000.
///
/// A text that is given away (`Vec<u8>`) is dropped as soon as it has been parsed: a large file takes less
/// memory then.
///
/// Coordinates are parsed in single precision: to 0.001 px or 0.0003 mm up to 4 m from the origin. Arcs are
/// first made into cubic curves that are 0.03 % of the radius off at most, and no more than 0.1 of the file's
/// units; that adds to the tolerance, which is kept between those curves and the chords. What lies farther
/// than 277 m from the corner of the sheet is cut off, and counted. A path is read up to its first error.
/// Another element with a number that is no place on a sheet, beyond 10¹², is left out.
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
pub fn read_svg<'a>(bytes: impl Into<Cow<'a, [u8]>>, options: &SvgOptions) -> Result<SvgDrawing, SvgError> {
    on_own_stack(bytes.into(), options, |text, max_depth| {
        let parser = parser_options(options);
        parse(text, options, max_depth, [&parser; 2], None)
    })
}

/// Reads the text of a file on a stack that is large enough for the depth of nesting that is handed on.
fn on_own_stack(
    bytes: Cow<'_, [u8]>,
    options: &SvgOptions,
    parse: impl Fn(Cow<'_, str>, usize) -> Result<SvgDrawing, SvgError> + Sync,
) -> Result<SvgDrawing, SvgError> {
    if !TOLERANCES_MM.contains(&options.tolerance_mm) {
        return Err(SvgError::Tolerance { tolerance_mm: options.tolerance_mm });
    }
    if !PX_PER_INCHES.contains(&options.px_per_inch) {
        return Err(SvgError::PxPerInch { px_per_inch: options.px_per_inch });
    }
    if bytes.starts_with(&[0x1f, 0x8b]) {
        return Err(SvgError::Compressed);
    }
    let text = decoded(bytes)?;
    if text.trim_start_matches('\u{feff}').trim().is_empty() {
        return Err(SvgError::Empty);
    }
    // The caller's stack may be short of what nested elements need.
    let mut text = Some(text);
    let parsed = std::thread::scope(|scope| {
        let parser = std::thread::Builder::new().name("svg".to_owned()).stack_size(STACK_BYTES);
        let whole = || parse(text.take().unwrap_or_default(), survey::MAX_DEPTH);
        Some(parser.spawn_scoped(scope, whole).ok()?.join().unwrap_or(Err(SvgError::Parser)))
    });
    // Where there are no threads it has to do; nobody has taken the text then.
    parsed.unwrap_or_else(|| parse(text.unwrap_or_default(), MAX_DEPTH_ON_CALLERS_STACK))
}

/// The text of a file: UTF-8, or UTF-16 with its mark.
fn decoded(bytes: Cow<'_, [u8]>) -> Result<Cow<'_, str>, SvgError> {
    let unit: fn([u8; 2]) -> u16 = match bytes.as_ref() {
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        _ => {
            let text = match bytes {
                Cow::Borrowed(bytes) => core::str::from_utf8(bytes).map(Cow::Borrowed),
                Cow::Owned(bytes) => {
                    String::from_utf8(bytes).map(Cow::Owned).map_err(|error| error.utf8_error())
                }
            };
            return text.map_err(|error| SvgError::Encoding { byte: error.valid_up_to() });
        }
    };
    let mut text = String::new();
    let units = bytes.as_chunks().0.iter().skip(1).map(|pair| unit(*pair));
    for letter in char::decode_utf16(units) {
        match letter {
            Ok(letter) => text.push(letter),
            // How far it is good: letters beyond 16 bits are two units.
            Err(_) => return Err(SvgError::Encoding { byte: 2 + 2 * text.encode_utf16().count() }),
        }
    }
    if bytes.len() % 2 == 1 {
        return Err(SvgError::Encoding { byte: bytes.len() - 1 });
    }
    // It is UTF-8 from here on, whatever it says.
    Ok(Cow::Owned(text))
}

/// `probe` is a parser that finds the boxes of elements, `parser` the one that reads the file.
/// `draw_whole` tells the texts that the parser has all outlines of, and of these how far apart two ways
/// along one line may be; without it, it has none.
fn parse(
    mut text: Cow<'_, str>,
    options: &SvgOptions,
    max_depth: usize,
    [probe, parser]: [&usvg::Options<'_>; 2],
    draw_whole: Option<&DrawWhole<'_>>,
) -> Result<SvgDrawing, SvgError> {
    let moved = without_blank_nodes(&text);
    let has_moved = moved.is_some();
    if let Some(moved) = moved {
        text = Cow::Owned(moved);
    }
    let mut document = document_of(&text)?;
    let root = document.root_element().tag_name().name();
    if root != "svg" {
        return Err(SvgError::NotSvg { root: survey::shortened(root) });
    }
    let Rewritten { text: rewritten, problems, filters, layers } =
        Rewritten::new(&text, &document, options, probe, max_depth, has_moved)?;
    // Large files are long in memory: what has been read goes before the next is made.
    if let Some(rewritten) = rewritten {
        drop(document);
        text = Cow::Owned(rewritten);
        document = document_of(&text)?;
    }
    let survey = Survey::new(&document, draw_whole.is_some(), max_depth)?;
    let mut layers = Some(layers);
    let mut started = None;
    let mut draw = |tree: &usvg::Tree| {
        let (_, ink) = match &mut started {
            Some(started) => started,
            None => {
                let (drawing, sheet) = sheet_of(tree, options)?;
                let layers = layers.take().unwrap_or_default();
                started.insert((sheet, Ink::new(drawing, *options, layers, draw_whole)))
            }
        };
        ink.group(tree.root(), None)
    };
    match chunks::chunks(&document, &text) {
        None => {
            let tree = tree_of(&document, parser)?;
            drop(document);
            drop(text);
            draw(&tree)?;
        }
        Some(chunks) => {
            drop(document);
            for chunk in &chunks {
                let chunk = chunks::text_of(&text, chunk);
                draw(&tree_of(&document_of(&chunk)?, parser)?)?;
            }
            drop(text);
        }
    }
    let ((width_mm, height_mm, scale), mut ink) = started.ok_or(SvgError::Parser)?;
    ink.hide()?;
    let (texts, text_line) = match draw_whole {
        None => (survey.texts.len(), survey.texts.first().map(|(_, line)| *line)),
        Some(_) => {
            let same =
                |(letters, line): &(String, u32)| (Some(letters) == ink.text.as_ref()).then_some(*line);
            (ink.left_out.texts, survey.texts.iter().find_map(same))
        }
    };
    let (images, image_line) = (survey.images, survey.image_line);
    let left_out = SvgLeftOut { texts, text_line, images, image_line, filters, ..ink.left_out };
    let (pens, without_pen) = ink.pens.finish();
    Ok(SvgDrawing {
        drawing: ink.drawing,
        scale,
        width_mm,
        height_mm,
        pens,
        without_pen,
        left_out,
        missing_fonts: SvgMissingFonts::default(),
        layers: ink.layers,
        problems,
        hatched: ink.hatched,
    })
}

fn tree_of(document: &roxmltree::Document<'_>, parser: &usvg::Options<'_>) -> Result<usvg::Tree, SvgError> {
    let limit = survey::MAX_PARSED;
    usvg::Tree::from_xmltree(document, parser).map_err(|error| match error {
        usvg::Error::InvalidSize => SvgError::NoSize,
        // It says the same of what is nested too deep, but the survey has refused that.
        usvg::Error::ElementsLimitReached
        | usvg::Error::ParsingFailed(roxmltree::Error::NodesLimitReached) => {
            SvgError::TooManyElements { limit }
        }
        error => SvgError::Xml { reason: error.to_string() },
    })
}

/// Width and height of a sheet, mm, and where it lies.
type Sheet = (f64, f64, Scale);

/// An empty drawing on the sheet, and the sheet.
fn sheet_of(tree: &usvg::Tree, options: &SvgOptions) -> Result<(Drawing, Sheet), SvgError> {
    let mm_per_px = options.mm_per_px();
    let (width_px, height_px) = (f64::from(tree.size().width()), f64::from(tree.size().height()));
    let (width_mm, height_mm) = (width_px * mm_per_px, height_px * mm_per_px);
    let too_large = SvgError::Sheet { width_mm, height_mm };
    let whole = |px: f64| whole_px(px).ok_or_else(|| too_large.clone());
    let drawing = Drawing::new(whole(width_px)?, whole(height_px)?);
    // The last row of pixels may stick out below the sheet.
    let below_mm = height_mm - f64::from(drawing.height_px()) * mm_per_px;
    let scale =
        Scale::new(drawing.height_px(), mm_per_px, Point::new(0.0, below_mm)).map_err(|_| too_large)?;
    Ok((drawing, (width_mm, height_mm, scale)))
}

/// Whether a text is drawn, and then how far from each other two ways along one line of it may be, in the
/// text's own unit.
type DrawWhole<'a> = dyn Fn(&usvg::Text) -> Option<f32> + 'a;

/// The elements of a file. Document types are common: entities in them are resolved, within the limits of the
/// XML parser, but not those in other files.
fn document_of(text: &str) -> Result<roxmltree::Document<'_>, SvgError> {
    let limit = survey::MAX_ELEMENTS;
    // Between elements, the ends of lines are nodes too.
    let nodes_limit = u32::try_from(limit.saturating_mul(2)).unwrap_or(u32::MAX);
    let xml = roxmltree::ParsingOptions { allow_dtd: true, nodes_limit, ..Default::default() };
    roxmltree::Document::parse_with_options(text, xml).map_err(|error| match error {
        roxmltree::Error::NodesLimitReached => SvgError::TooManyElements { limit },
        error => SvgError::Xml { reason: error.to_string() },
    })
}

/// No files, no pictures: neither from a path in the file, nor from data in it.
fn parser_options(options: &SvgOptions) -> usvg::Options<'static> {
    #[expect(clippy::cast_possible_truncation, reason = "within 10..=10000, checked before")]
    let dpi = options.px_per_inch as f32;
    usvg::Options {
        dpi,
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

#[cfg(test)]
mod cut_far_tests;

#[cfg(test)]
mod clip_tests;

#[cfg(test)]
mod kind_tests;

#[cfg(test)]
mod move_tests;

#[cfg(test)]
#[cfg(feature = "svg-text")]
mod single_stroke_tests;
