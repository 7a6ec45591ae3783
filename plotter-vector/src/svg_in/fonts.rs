//! [`SvgFonts`]: the fonts that the texts of an SVG file are set in, and [`read_svg_with_fonts`].
//!
//! They are those that the caller gives, never those of the host: a file becomes the same strokes everywhere.

use super::{SvgDrawing, SvgError, SvgOptions, on_own_stack, parse, parser_options, single_stroke};
use core::fmt;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use usvg::fontdb::{self, Database, ID, Query, Source};
use usvg::{FontFamily, FontResolver, FontStretch, FontStyle};

/// Most fonts in one file: collections have some dozen.
const MAX_COLLECTED: u32 = 1024;
/// Most families and most letters that are told of what is missing.
const MAX_TOLD: usize = 16;
/// What stands for the family of a text that names none.
const ANY_FAMILY: &str = "";

/// The fonts that the texts of an SVG file may be set in.
///
/// ```no_run
/// # use plotter_vector::{SvgOptions, svg_in::{SvgFonts, read_svg_with_fonts}};
/// let mut fonts = SvgFonts::default();
/// fonts.add(std::fs::read("DejaVuSans.ttf")?)?;
/// let read = read_svg_with_fonts(&std::fs::read("plan.svg")?, &SvgOptions::default(), &fonts)?;
/// assert_eq!(read.left_out.texts, 0, "missing: {:?}", read.missing_fonts);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SvgFonts {
    database: Arc<Database>,
    /// The name of each family, by its small letters: style sheets do not tell capitals from them.
    names: BTreeMap<String, String>,
    first: Option<String>,
    first_monospaced: Option<String>,
    /// Whether the first fonts are the letters of one line, which stand for all that are not given.
    is_single_stroke: bool,
}

/// Why a file is no font.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SvgFontError {
    /// It is one for web pages, which are compressed.
    WebFont,
    /// It is something else, or damaged, or without a name.
    NoFont,
}

impl fmt::Display for SvgFontError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::WebFont => "a web font (WOFF), which is compressed; give its .ttf or .otf file",
            Self::NoFont => "no font with a name; give a TrueType or OpenType file (.ttf, .otf, .ttc)",
        })
    }
}

impl core::error::Error for SvgFontError {}

impl SvgFonts {
    /// The letters of HPGL's labels, which are lines for a pen and not outlines, for all texts: they are set
    /// in these whatever font they ask for, with anchors, spacing, `textPath` and all else as in other fonts.
    /// A dot of a letter is a dot, a line below letters one line. Capitals are 0.7 em high, and letters about
    /// as wide as in Helvetica, or all equally wide where a text asks for `monospace`. There are those of
    /// Latin-1, and for common quotation marks and dashes those that look nearly so.
    ///
    /// Of fonts that are added, texts are set in those that they name, and letters taken that Latin-1 does
    /// not have: who gives a font wants it used.
    ///
    /// ```
    /// # use plotter_vector::{SvgOptions, svg_in::{SvgFonts, read_svg_with_fonts}};
    /// let file = r#"<svg xmlns="http://www.w3.org/2000/svg" width="100" height="50">
    ///     <text x="10" y="40" font-size="24">L</text></svg>"#;
    /// let read = read_svg_with_fonts(file.as_bytes(), &SvgOptions::default(), &SvgFonts::single_stroke())?;
    /// let letter = read.drawing.stroke(0); // down, and to the right
    /// assert_eq!(letter.len(), 3);
    /// assert!((letter[1].y - letter[0].y - 0.7 * 24.0).abs() < 1e-3);
    /// # Ok::<(), plotter_vector::svg_in::SvgError>(())
    /// ```
    #[must_use]
    pub fn single_stroke() -> Self {
        let mut fonts = Self { is_single_stroke: true, ..Self::default() };
        for is_monospaced in [false, true] {
            let added = fonts.add(single_stroke::font_file(is_monospaced));
            debug_assert_eq!(added, Ok(()), "the font made here is one");
        }
        fonts
    }

    /// Adds the font of a TrueType or OpenType file, or all fonts of a collection, by the bytes of the file.
    ///
    /// # Errors
    /// [`SvgFontError`].
    pub fn add(&mut self, bytes: Vec<u8>) -> Result<(), SvgFontError> {
        if bytes.starts_with(b"wOF") {
            return Err(SvgFontError::WebFont);
        }
        // A collection says itself how many fonts it has, and room is made for them.
        let collected = match bytes.get(..12) {
            Some([b't', b't', b'c', b'f', _, _, _, _, number @ ..]) => {
                number.iter().fold(0, |number, byte| (number << 8) | u32::from(*byte))
            }
            _ => 1,
        };
        if collected > MAX_COLLECTED {
            return Err(SvgFontError::NoFont);
        }
        let database = Arc::make_mut(&mut self.database);
        let faces = database.load_font_source(Source::Binary(Arc::new(bytes)));
        if faces.is_empty() {
            return Err(SvgFontError::NoFont);
        }
        for face in faces.iter().filter_map(|id| database.face(*id)) {
            for (name, _) in &face.families {
                self.names.entry(name.to_lowercase()).or_insert_with(|| name.clone());
            }
            let name = face.families.first().map(|(name, _)| name);
            self.first = self.first.take().or_else(|| name.cloned());
            if face.monospaced {
                self.first_monospaced = self.first_monospaced.take().or_else(|| name.cloned());
            }
        }
        Ok(())
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.first.is_none()
    }

    /// Names of the families, by the alphabet.
    pub fn families(&self) -> impl Iterator<Item = &str> {
        self.names.values().map(String::as_str)
    }

    /// The first family of a text's list that is there. A kind of fonts (`serif`) is any: the first that was
    /// given, of those for `monospace` the first whose letters are equally wide. Letters of one line are for
    /// any.
    fn family_of(&self, font: &usvg::Font) -> Option<&str> {
        let first = self.first.as_deref();
        let named = font.families().iter().find_map(|family| match family {
            FontFamily::Named(name) if name == ANY_FAMILY => first,
            FontFamily::Named(name) => self.names.get(&name.to_lowercase()).map(String::as_str),
            FontFamily::Monospace => self.first_monospaced.as_deref().or(first),
            _ => first,
        });
        named.or(first.filter(|_| self.is_single_stroke))
    }

    /// The font of that family whose style is nearest.
    fn face_of(&self, font: &usvg::Font) -> Option<ID> {
        let families = [fontdb::Family::Name(self.family_of(font)?)];
        let stretch = match font.stretch() {
            FontStretch::UltraCondensed => fontdb::Stretch::UltraCondensed,
            FontStretch::ExtraCondensed => fontdb::Stretch::ExtraCondensed,
            FontStretch::Condensed => fontdb::Stretch::Condensed,
            FontStretch::SemiCondensed => fontdb::Stretch::SemiCondensed,
            FontStretch::Normal => fontdb::Stretch::Normal,
            FontStretch::SemiExpanded => fontdb::Stretch::SemiExpanded,
            FontStretch::Expanded => fontdb::Stretch::Expanded,
            FontStretch::ExtraExpanded => fontdb::Stretch::ExtraExpanded,
            FontStretch::UltraExpanded => fontdb::Stretch::UltraExpanded,
        };
        let style = match font.style() {
            FontStyle::Normal => fontdb::Style::Normal,
            FontStyle::Italic => fontdb::Style::Italic,
            FontStyle::Oblique => fontdb::Style::Oblique,
        };
        let weight = fontdb::Weight(font.weight());
        self.database.query(&Query { families: &families, weight, stretch, style })
    }

    /// Where a text is set in the fonts that it asks for, each letter of it with an outline: how far from
    /// each other two ways along one line of it may be.
    fn draw_whole(&self, text: &usvg::Text, wanted: &Mutex<Wanted>) -> Option<f32> {
        let mut spans = text.chunks().iter().flat_map(usvg::TextChunk::spans);
        // What the font does not have is its glyph 0.
        let glyphs = text.layouted().iter().flat_map(|span| &span.positioned_glyphs);
        let missing = glyphs.filter(|glyph| glyph.id.0 == 0).flat_map(|glyph| glyph.text.chars());
        let mut is_whole = true;
        for letter in missing {
            is_whole = false;
            locked(wanted).letter(letter);
        }
        let is_drawn = is_whole
            && spans.all(|span| self.family_of(span.font()).is_some())
            // Letters in several colours are groups, and pictures of letters images.
            && text.flattened().children().iter().all(|part| matches!(part, usvg::Node::Path(_)));
        is_drawn.then(|| slack(text))
    }
}

/// How far from each other two ways along one line of a text may be: of its largest letters, as they are
/// stretched.
fn slack(text: &usvg::Text) -> f32 {
    let sizes = text.layouted().iter().flat_map(|span| &span.positioned_glyphs).map(|glyph| {
        let (along, across) = glyph.transform().get_scale();
        glyph.font_size() * if along > across { along / across } else { 1.0 }
    });
    super::one_line::SLACK_EM * sizes.filter(|size| size.is_finite()).fold(0.0, f32::max)
}

/// What the texts of a file need and no given font has: why they are left out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Wanted {
    missing: super::SvgMissingFonts,
    /// Texts with letters that are missing, and whether the one at hand is counted.
    texts: usize,
    is_counted: bool,
}

impl Wanted {
    fn family(&mut self, name: &str) {
        let (families, name) = (&mut self.missing.families, super::survey::shortened(name));
        if families.len() < MAX_TOLD && !families.contains(&name) {
            families.push(name);
        }
    }

    fn letter(&mut self, letter: char) {
        let letters = &mut self.missing.letters;
        if letters.chars().count() < MAX_TOLD && !letters.contains(letter) {
            letters.push(letter);
        }
    }
}

fn locked(wanted: &Mutex<Wanted>) -> MutexGuard<'_, Wanted> {
    wanted.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Looks fonts up in those that are given, and notes what is not there.
fn resolver<'a>(fonts: &'a SvgFonts, wanted: &'a Mutex<Wanted>) -> FontResolver<'a> {
    let fallback = FontResolver::default_fallback_selector();
    FontResolver {
        select_font: Box::new(move |font, _| {
            // Each text begins with its fonts.
            locked(wanted).is_counted = false;
            let found = fonts.face_of(font);
            let named = font.families().iter().find_map(|family| match family {
                FontFamily::Named(name) if name == ANY_FAMILY => None,
                FontFamily::Named(name) => Some(name.clone()),
                kind => Some(kind.to_string()),
            });
            if let (None, Some(name)) = (found, named) {
                locked(wanted).family(&name);
            }
            // In any font it is found in the tree again, to be counted.
            found.or_else(|| fonts.database.faces().next().map(|face| face.id))
        }),
        select_fallback: Box::new(move |letter, used, database| {
            let found = fallback(letter, used, database);
            if found.is_none() {
                let mut wanted = locked(wanted);
                wanted.letter(letter);
                wanted.texts += usize::from(!core::mem::replace(&mut wanted.is_counted, true));
            }
            found
        }),
    }
}

/// Reads a drawing from the text of an SVG file as [`read_svg`](crate::svg_in::read_svg) does, and draws its
/// texts, too: along the outlines of their letters, or along their strokes. Letters that are lines and not
/// areas, as those of [`SvgFonts::single_stroke`] and of fonts for pens are, are drawn once.
///
/// A text is set in the first family of its list that is among `fonts`, in the weight and style that are
/// nearest; a kind of fonts as `sans-serif`, or none at all, takes the first font. Letters that this one
/// lacks are taken from the others. A text is drawn whole or not at all: where its families or one of its
/// letters are in no font, or a letter is a picture or has several colours, it is counted in
/// [`SvgLeftOut::texts`](crate::svg_in::SvgLeftOut::texts), and [`SvgDrawing::missing_fonts`] tells what it
/// needs. Anchors, `tspan`, `textPath`, spacing, decoration, kerning and ligatures are done as the format and
/// the font say.
///
/// # Errors
/// [`SvgError`].
pub fn read_svg_with_fonts<'a>(
    bytes: impl Into<Cow<'a, [u8]>>,
    options: &SvgOptions,
    fonts: &SvgFonts,
) -> Result<SvgDrawing, SvgError> {
    on_own_stack(bytes.into(), options, |text, max_depth| {
        let (wanted, unminded) = (Mutex::new(Wanted::default()), Mutex::new(Wanted::default()));
        let parser = |wanted| usvg::Options {
            font_family: ANY_FAMILY.to_owned(),
            font_resolver: resolver(fonts, wanted),
            fontdb: Arc::clone(&fonts.database),
            ..parser_options(options)
        };
        let (probe, parser) = (parser(&unminded), parser(&wanted));
        let draw_whole = |text: &usvg::Text| fonts.draw_whole(text, &wanted);
        let draw_whole: Option<&super::DrawWhole<'_>> =
            if fonts.is_empty() { None } else { Some(&draw_whole) };
        let mut read = parse(text, options, max_depth, [&probe, &parser], draw_whole)?;
        drop((probe, parser));
        let wanted = wanted.into_inner().unwrap_or_else(PoisonError::into_inner);
        // Where all letters of a text are missing, it may have no outline to be counted by.
        read.left_out.texts = read.left_out.texts.max(wanted.texts);
        if read.left_out.texts > 0 {
            read.missing_fonts = wanted.missing;
        }
        Ok(read)
    })
}
