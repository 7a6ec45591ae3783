//! [`Rewritten`]: a file in words that the parser knows.
//!
//! The parser leaves out without a word what it does not know: a paint, a transform with units, a layer
//! without an `id`. What such a place holds is written anew before it reads the file, in attributes, `style`
//! and style sheets alike; all lines stay where they were. What has no other words is told.

use super::blank_nodes::moved_by;
use super::css_transform::{self, Plain};
use super::font_size;
use super::layers::SvgLayer;
use super::moves::{self, Added, Moves, after_name};
use super::paint::{self, Known};
use super::survey::{TEMPLATES, huge_number, shortened};
use super::{SvgError, SvgOptions, SvgProblem};
use core::ops::Range;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use usvg::roxmltree::{Document, Node};

/// Most problems that are told.
pub(super) const MAX_PROBLEMS: usize = 64;
/// Most references to variables in a value that are followed, one in the other.
const MAX_VARIABLES: usize = 16;
/// Longest value with variables in it, bytes.
const MAX_VALUE_BYTES: usize = 4096;

/// Properties that are paints, or the colours of paints.
const PAINTS: [&str; 4] = ["fill", "stroke", "color", "stop-color"];
/// Properties of single words: CSS does not mind capitals, the parser does.
const WORDS: [&str; 9] = [
    "display",
    "visibility",
    "overflow",
    "fill-rule",
    "clip-rule",
    "stroke-linecap",
    "stroke-linejoin",
    "text-anchor",
    "mask-type",
];
/// Attributes that hold one number, or a few.
const NUMBERS: [&str; 16] =
    ["viewBox", "x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "x1", "y1", "x2", "y2", "dx", "dy"];

/// Elements that draw something, by themselves or by what is in them.
const DRAWN: [&str; 17] = [
    "a",
    "circle",
    "ellipse",
    "foreignObject",
    "g",
    "image",
    "line",
    "path",
    "polygon",
    "polyline",
    "rect",
    "svg",
    "switch",
    "text",
    "textPath",
    "tspan",
    "use",
];
/// A name that no element has: the parser passes over what has it, and all that is in it.
const NO_ELEMENT: &str = "x";

const SVG_NAMESPACE: &str = "http://www.w3.org/2000/svg";

/// What became of a file.
#[derive(Debug, Default)]
pub(super) struct Rewritten {
    /// Its text in words that the parser knows; `None` where it was so.
    pub(super) text: Option<String>,
    /// What has no such words, and is not done.
    pub(super) problems: Vec<SvgProblem>,
    /// Filters, which are taken out.
    pub(super) filters: usize,
    /// Its layers by their `id`, in order.
    pub(super) layers: Vec<(String, SvgLayer)>,
}

/// A file being rewritten.
struct Rewriter<'a> {
    text: &'a str,
    document: &'a Document<'a>,
    options: &'a SvgOptions,
    /// What the variables of its style sheets hold.
    variables: BTreeMap<&'a str, &'a str>,
    /// The size that percentages are of, px.
    sheet: (f64, f64),
    edits: Vec<(Range<usize>, String)>,
    /// Attributes that elements get.
    added: Added,
    /// Whether elements are moved otherwise than the parser knows: then what moves them is taken out of style
    /// sheets and `style`s, and put together for each.
    has_moves: bool,
    /// Byte in the file and text of each.
    problems: Vec<(usize, String)>,
    filters: usize,
}

impl Rewritten {
    /// `parser` finds the boxes of elements, which may be nested this deep; `has_moved_blanks` says that ends
    /// of elements stand where [`without_blank_nodes`](super::blank_nodes::without_blank_nodes) puts them.
    ///
    /// # Errors
    /// Where a box is asked for, and the references in the file are not safe to follow.
    pub(super) fn new(
        text: &str,
        document: &Document<'_>,
        options: &SvgOptions,
        parser: &usvg::Options<'_>,
        max_depth: usize,
        has_moved_blanks: bool,
    ) -> Result<Self, SvgError> {
        let mut rewriter = Rewriter {
            text,
            document,
            options,
            variables: variables(document),
            sheet: sheet(document),
            edits: Vec::new(),
            added: Added::new(),
            has_moves: moves::has_any(document),
            problems: Vec::new(),
            filters: 0,
        };
        let layers = rewriter.layers();
        for node in document.descendants() {
            if node.is_element() {
                rewriter.element(node);
            } else if node.is_text()
                && node.parent().is_some_and(|parent| parent.tag_name().name() == "style")
            {
                rewriter.style_sheet(node.range());
            }
        }
        if rewriter.has_moves {
            let resolved = |value: &str| rewriter.without_variables(value).into_owned();
            let mut moves = Moves::new(document, options.px_per_inch, rewriter.sheet, &resolved);
            moves.find_boxes(document, text, parser, max_depth, &|mut added, mut edits| {
                for (at, attributes) in &rewriter.added {
                    let own = added.entry(*at).or_default();
                    for (name, value) in attributes {
                        own.entry(name).or_insert_with(|| value.clone());
                    }
                }
                edits.extend(rewriter.edits.iter().cloned());
                applied(text, edits, added)
            })?;
            moves.write(document, text, &mut rewriter.added, &mut rewriter.edits);
        }
        let Rewriter { edits, added, mut problems, filters, .. } = rewriter;
        problems.sort();
        problems.dedup();
        let problems = problems
            .into_iter()
            .map(|(byte, problem)| {
                let place = document.text_pos_at(byte);
                let moved = if has_moved_blanks { moved_by(text, byte) } else { 0 };
                SvgProblem { line: place.row, column: place.col.saturating_sub(moved), text: problem }
            })
            .collect();
        Ok(Self { text: applied(text, edits, added), problems, filters, layers })
    }
}

/// The text with its edits and what its elements get; `None` without any.
fn applied(text: &str, mut edits: Vec<(Range<usize>, String)>, added: Added) -> Option<String> {
    edits.extend(added.into_iter().map(|(at, attributes)| {
        let attributes = attributes.iter().map(|(name, value)| format!(" {name}=\"{value}\""));
        (at..at, attributes.collect())
    }));
    // What an entity stands for is met wherever it stands.
    edits.sort_by_key(|(range, _)| (range.start, range.end));
    edits.dedup_by_key(|(range, _)| range.start);
    written(text, &edits)
}

/// The text with its edits, all lines where they were; `None` without any.
fn written(text: &str, edits: &[(Range<usize>, String)]) -> Option<String> {
    let (mut new, mut done) = (String::new(), 0);
    for (range, value) in edits {
        // One within another is done with it.
        let Some(before) = text.get(done..range.start) else { continue };
        new.push_str(before);
        new.push_str(value);
        let lines = |text: &str| text.bytes().filter(|byte| *byte == b'\n').count();
        let lost = lines(text.get(range.clone()).unwrap_or_default()).saturating_sub(lines(value));
        new.extend(core::iter::repeat_n('\n', lost));
        done = range.end;
    }
    new.push_str(text.get(done..)?);
    (!edits.is_empty()).then_some(new)
}

/// The size of the root's `viewBox`, or of the sheet where both are given in px.
fn sheet(document: &Document<'_>) -> (f64, f64) {
    let root = document.root_element();
    let numbers = |text: &str| -> Vec<f64> {
        text.split([' ', ',']).filter(|word| !word.is_empty()).filter_map(|word| word.parse().ok()).collect()
    };
    if let Some([_, _, width, height]) = root.attribute("viewBox").map(numbers).as_deref() {
        return (*width, *height);
    }
    let side = |name| {
        root.attribute(name).and_then(|text| text.trim().trim_end_matches("px").parse().ok()).unwrap_or(0.0)
    };
    (side("width"), side("height"))
}

/// What the variables hold, of all style sheets and `style`s; what is declared last counts, for all elements.
fn variables<'a>(document: &'a Document<'a>) -> BTreeMap<&'a str, &'a str> {
    let mut variables = BTreeMap::new();
    for node in document.descendants() {
        let is_sheet =
            node.is_text() && node.parent().is_some_and(|parent| parent.tag_name().name() == "style");
        let Some(text) = (if is_sheet { node.text() } else { node.attribute("style") }) else { continue };
        if text.contains("--") {
            declarations(text, is_sheet, |name, value| {
                if let (Some(name), Some(value)) = (text.get(name), value.and_then(|value| text.get(value)))
                    && name.starts_with("--")
                {
                    variables.insert(name, value);
                }
            });
        }
    }
    variables
}

/// Hands the places of name and value of each declaration of a style sheet, or of a `style`, to `visit`;
/// without blanks around them. What has no colon is a name without a value.
pub(super) fn declarations(
    text: &str,
    is_sheet: bool,
    mut visit: impl FnMut(Range<usize>, Option<Range<usize>>),
) {
    let bytes = text.as_bytes();
    let (mut start, mut colon, mut depth, mut at) = (0, None, 0_usize, 0);
    let mut blocks = usize::from(!is_sheet);
    let trimmed = |range: Range<usize>| {
        let part = text.get(range.clone()).unwrap_or_default();
        let start = range.start + (part.len() - part.trim_start().len());
        start..start + part.trim().len()
    };
    while at <= bytes.len() {
        let byte = bytes.get(at).copied();
        match byte {
            Some(b'/') if bytes.get(at + 1) == Some(&b'*') => {
                let rest = text.get(at + 2..).unwrap_or_default();
                let end = rest.find("*/").map_or(bytes.len(), |end| at + end + 4);
                if colon.is_none() && text.get(start..at).is_some_and(|before| before.trim().is_empty()) {
                    start = end;
                }
                at = end;
                continue;
            }
            Some(quote @ (b'"' | b'\'')) => {
                at += 1;
                while bytes.get(at).is_some_and(|byte| *byte != quote) {
                    at += if bytes.get(at) == Some(&b'\\') { 2 } else { 1 };
                }
            }
            Some(b'(') => depth += 1,
            // A `style` has no blocks.
            Some(b'{') if !is_sheet => depth += 1,
            Some(b'}') if !is_sheet => depth = depth.saturating_sub(1),
            Some(b')') => depth = depth.saturating_sub(1),
            Some(b':') if depth == 0 => colon = colon.or(Some(at)),
            Some(b'{') => {
                (start, colon, depth) = (at + 1, None, 0);
                blocks += 1;
            }
            Some(b';' | b'}') | None if depth == 0 || byte != Some(b';') => {
                let end = at.min(bytes.len());
                let name = trimmed(start..colon.unwrap_or(end));
                if blocks > 0 && (colon.is_some() || !name.is_empty()) {
                    visit(name, colon.map(|colon| trimmed(colon + 1..end)));
                }
                (start, colon, depth) = (at + 1, None, 0);
                blocks -= usize::from(byte == Some(b'}') && blocks > 0);
            }
            _ => {}
        }
        at += 1;
    }
}

/// Whether this is the name of a property, not of a variable or of nothing.
fn is_property(name: &str) -> bool {
    let letters = name.strip_prefix('-').unwrap_or(name);
    letters.starts_with(|letter: char| letter.is_ascii_alphabetic())
        && letters.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_')
}

/// What stands instead of something that is no declaration of a property: one of none.
fn instead(name: Range<usize>, value: Option<Range<usize>>, name_text: &str) -> Vec<(Range<usize>, String)> {
    match value {
        _ if name_text.starts_with('@') => Vec::new(),
        Some(value) => vec![(name, "x".to_owned()), (value, "0".to_owned())],
        None => vec![(name, "x:0".to_owned())],
    }
}

/// A style sheet or a `style` of declarations alone, for readers that stop at what is none.
pub(super) fn sound(text: &str, is_sheet: bool) -> Cow<'_, str> {
    let mut edits = Vec::new();
    declarations(text, is_sheet, |name, value| {
        let name_text = text.get(name.clone()).unwrap_or_default();
        let is_empty = value.as_ref().is_none_or(Range::is_empty);
        if is_empty || !is_property(name_text) {
            edits.extend(instead(name, value, name_text));
        }
    });
    written(text, &edits).map_or(Cow::Borrowed(text), Cow::Owned)
}

impl<'a> Rewriter<'a> {
    /// Finds the layers, and gives each an `id` that is its own.
    fn layers(&mut self) -> Vec<(String, SvgLayer)> {
        let root = self.document.root_element();
        let own = |node: &Node<'a, 'a>, name: &str| {
            node.attributes().find(|attribute| attribute.name() == name).map(|attribute| attribute.value())
        };
        let is_layer = |node: &Node<'a, 'a>| {
            let named =
                node.parent() == Some(root) && (node.has_attribute("id") || own(node, "label").is_some());
            let drawn = || !node.ancestors().any(|up| TEMPLATES.contains(&up.tag_name().name()));
            node.tag_name().name() == "g" && (named || own(node, "groupmode") == Some("layer")) && drawn()
        };
        let mut prefix = String::from("layer_");
        while self.text.contains(&prefix) {
            prefix.push('_');
        }
        let (mut layers, mut ids, mut within) = (Vec::new(), BTreeSet::new(), 0);
        for node in self.document.descendants().filter(Node::is_element).filter(is_layer) {
            // A layer of a layer is of that one.
            if node.range().start < within {
                continue;
            }
            within = node.range().end;
            let id = node.attribute("id");
            let name = own(&node, "label").or_else(|| own(&node, "data-name")).or(id).unwrap_or_default();
            let layer = SvgLayer::of_name(name);
            let id = match id {
                Some(id) if ids.insert(id.to_owned()) => id.to_owned(),
                known => {
                    let new = format!("{prefix}{}", layers.len());
                    let attribute = node.attribute_node("id").filter(|_| known.is_some());
                    match attribute {
                        Some(attribute) => self.edits.push((attribute.range_value(), new.clone())),
                        None => {
                            let at = after_name(self.text, node.range());
                            self.added.entry(at).or_default().insert("id", new.clone());
                        }
                    }
                    new
                }
            };
            layers.push((id, layer));
        }
        layers
    }

    fn tell(&mut self, byte: usize, text: String) {
        if self.problems.len() < MAX_PROBLEMS {
            self.problems.push((byte, text));
        }
    }

    fn element(&mut self, node: Node<'a, 'a>) {
        // `fill` says another thing in animations, and other languages have their own words.
        let tag = node.tag_name();
        let is_moved = tag.name().starts_with("animate") || tag.name() == "set";
        if is_moved || !matches!(tag.namespace(), None | Some(SVG_NAMESPACE)) {
            return;
        }
        for attribute in node.attributes() {
            let (name, range) = (attribute.name(), attribute.range_value());
            if attribute.namespace().is_some() {
                continue;
            }
            if (name == "transform" || NUMBERS.contains(&name))
                && let Some(word) = huge_number(attribute.value())
                && node != self.document.root_element()
            {
                self.huge(node, name, attribute.value(), (range, word));
                continue;
            }
            match name {
                "style" => self.style(attribute.value(), range),
                "d" | "points" => self.places(name, attribute.value(), range),
                _ if NUMBERS.contains(&name) => self.number(name, attribute.value(), range),
                _ => {
                    if let Some(new) = self.value(name, attribute.value(), range.start, false) {
                        self.edits.push((range, escaped(&new)));
                    }
                }
            }
        }
    }

    /// An attribute with a number that is no place on a sheet: what draws something is left out, with all
    /// that is in it. Else it is as if the attribute were not there. The sheet's own are not asked for.
    fn huge(
        &mut self,
        node: Node<'a, 'a>,
        name: &str,
        value: &str,
        (range, word): (Range<usize>, Range<usize>),
    ) {
        let at = range.start + if stands_as(self.text, &range, value) { word.start } else { 0 };
        let tag = node.tag_name().name();
        let instead = if DRAWN.contains(&tag) {
            self.edits.extend(self.names_of(node).map(|range| (range, NO_ELEMENT.to_owned())));
            format!("the {tag} is left out")
        } else {
            "it is taken as if it were not there".to_owned()
        };
        self.edits.push((range, String::new()));
        let found = shortened(value.get(word).unwrap_or_default());
        self.tell(at, format!("{name} holds {found}, which is no place on a sheet: {instead}"));
    }

    /// Where the name of an element stands: at its start, and at its end if it has one, without a prefix.
    fn names_of(&self, node: Node<'a, 'a>) -> impl Iterator<Item = Range<usize>> + use<> {
        let (range, tag) = (node.range(), node.tag_name().name());
        let start = after_name(self.text, range.clone());
        let whole = self.text.get(range.clone()).unwrap_or_default();
        let end = whole.rfind("</").filter(|_| !whole.ends_with("/>")).and_then(|end| {
            let end = range.start + end;
            let name = end + self.text.get(end..range.end)?.rfind(tag)?;
            Some(name + tag.len())
        });
        let length = tag.len();
        [Some(start), end].into_iter().flatten().map(move |end| end.saturating_sub(length)..end)
    }

    /// A `style`, as the entities in it are resolved.
    fn style(&mut self, value: &str, range: Range<usize>) {
        let as_it_stands = stands_as(self.text, &range, value);
        let edits = self.declared(value, false, |byte| range.start + if as_it_stands { byte } else { 0 });
        if let Some(new) = written(value, &edits) {
            self.edits.push((range, escaped(&new)));
        }
    }

    fn style_sheet(&mut self, range: Range<usize>) {
        let text = self.text;
        let edits =
            self.declared(text.get(range.clone()).unwrap_or_default(), true, |byte| range.start + byte);
        let placed = |part: Range<usize>| range.start + part.start..range.start + part.end;
        self.edits.extend(edits.into_iter().map(|(part, new)| (placed(part), new)));
    }

    /// The declarations of a `style` or a style sheet that the parser does not know as they stand; `place` is
    /// where a byte stands in the file. One that is no declaration, or of a variable, gives way: the parser
    /// would leave out all that follows.
    fn declared(
        &mut self,
        text: &str,
        is_sheet: bool,
        place: impl Fn(usize) -> usize,
    ) -> Vec<(Range<usize>, String)> {
        let mut edits = Vec::new();
        declarations(text, is_sheet, |name, value| {
            let name_text = text.get(name.clone()).unwrap_or_default();
            let held = value.clone().and_then(|value| text.get(value)).unwrap_or_default();
            let lower = name_text.to_ascii_lowercase();
            match value {
                Some(value) if is_property(&lower) && !held.is_empty() => {
                    let changed = self.value(&lower, held, place(value.start), true);
                    if self.has_moves && moves::PROPERTIES.contains(&lower.as_str()) {
                        edits.extend([(name, "x".to_owned()), (value, "0".to_owned())]);
                        return;
                    }
                    if lower != name_text {
                        edits.push((name, lower.clone()));
                    }
                    if let Some(changed) = changed {
                        edits.push((value, changed));
                    }
                }
                value => edits.extend(instead(name, value, name_text)),
            }
        });
        edits
    }

    /// A property's value in words that the parser knows, where it is not so already. What is not done is
    /// told at the byte.
    fn value(&mut self, name: &str, value: &str, byte: usize, in_style: bool) -> Option<String> {
        let resolved = self.without_variables(value);
        let value = resolved.as_ref();
        let mut new = None;
        match name {
            _ if PAINTS.contains(&name) => match paint::known(value, name) {
                Known::So(text) => new = Some(text),
                Known::AsItIs => {}
                Known::Black => {
                    let text = format!(
                        "{name} holds {}, a paint that is not known: taken for black",
                        shortened(value)
                    );
                    self.tell(byte, text);
                    new = Some(format!("black{}", paint::without_important(value).1));
                }
            },
            "transform" | "gradientTransform" | "patternTransform" => {
                match css_transform::as_svg(value, self.sheet, self.options.px_per_inch) {
                    Plain::So(text) if !self.has_moves || name != "transform" => new = Some(text),
                    Plain::So(_) | Plain::AsItIs => {}
                    Plain::Not(why) => {
                        let text = format!("{name} holds {}, which is not done: {why}", shortened(value));
                        self.tell(byte, text);
                    }
                }
            }
            "transform-origin" => {
                let lower = paint::without_important(value).0.to_ascii_lowercase();
                if css_transform::origin(&lower, self.sheet, self.options.px_per_inch).is_err() {
                    let text =
                        format!("transform-origin holds {}, which is not understood", shortened(value));
                    self.tell(byte, text);
                } else if lower != value && !self.has_moves {
                    new = Some(lower);
                }
            }
            "transform-box" => {
                const BOXES: [&str; 8] = [
                    "view-box",
                    "fill-box",
                    "stroke-box",
                    "content-box",
                    "border-box",
                    "initial",
                    "unset",
                    "inherit",
                ];
                let bare = paint::without_important(value).0.to_ascii_lowercase();
                if !BOXES.contains(&bare.as_str()) {
                    let text = format!("transform-box: {} is not known: view-box is taken", shortened(value));
                    self.tell(byte, text);
                }
            }
            "translate" | "rotate" | "scale" if in_style => {
                let bare = paint::without_important(value).0;
                if let Err(why) = css_transform::property(name, bare, self.sheet, self.options.px_per_inch) {
                    let text = format!("{name} holds {}, which is not done: {why}", shortened(value));
                    self.tell(byte, text);
                }
            }
            "offset-path" if in_style && value.trim() != "none" => {
                let text = format!("offset-path: {} is not done: write it as transform", shortened(value));
                self.tell(byte, text);
            }
            "filter" => {
                let bare = paint::without_important(value).0;
                if !matches!(bare, "none" | "inherit" | "initial" | "unset") {
                    self.filters += 1;
                    new = Some("none".to_owned());
                }
            }
            "clip-path" | "mask" if self.options.keeps_clipped => new = Some("none".to_owned()),
            "font-size" | "font" => new = font_size::numbered(value),
            _ if WORDS.contains(&name) => {
                new = Some(value.to_ascii_lowercase()).filter(|lower| lower != value);
            }
            _ => {}
        }
        new.or(match resolved {
            Cow::Owned(text) => Some(text),
            Cow::Borrowed(_) => None,
        })
    }

    /// A value with what its variables hold, or what it says for want of them.
    fn without_variables<'v>(&self, value: &'v str) -> Cow<'v, str> {
        let mut value = Cow::Borrowed(value);
        for _ in 0..MAX_VARIABLES {
            let Some(start) = value.find("var(") else { break };
            let Some(rest) = value.get(start + 4..) else { break };
            let mut depth = 1_usize;
            let end = rest.bytes().position(|byte| {
                match byte {
                    b'(' => depth += 1,
                    b')' => depth -= 1,
                    _ => {}
                }
                depth == 0
            });
            let end = end.unwrap_or(rest.len());
            let (inside, after) =
                (rest.get(..end).unwrap_or_default(), rest.get(end + 1..).unwrap_or_default());
            let (name, fallback) =
                inside.split_once(',').map_or((inside, None), |(name, other)| (name, Some(other.trim())));
            let held = self.variables.get(name.trim()).copied().or(fallback);
            // Without any, it is as if the declaration were not there; a paint is ink all the same.
            let Some(held) = held else { break };
            let new = format!("{}{held}{after}", value.get(..start).unwrap_or_default());
            if new.len() > MAX_VALUE_BYTES {
                break;
            }
            value = Cow::Owned(new);
        }
        value
    }

    /// A path or a list of places: what comes before an error is drawn, and the error told.
    fn places(&mut self, name: &str, value: &str, range: Range<usize>) {
        let wrong = if name == "d" {
            svgtypes::PathParser::from(value).find_map(Result::err).map(|error| (error, "path"))
        } else {
            svgtypes::NumberListParser::from(value)
                .find_map(Result::err)
                .map(|error| (error, "list of places"))
        };
        let at = wrong.as_ref().map(|(error, _)| {
            let letter = match error {
                svgtypes::Error::UnexpectedData(letter)
                | svgtypes::Error::InvalidChar(_, letter)
                | svgtypes::Error::InvalidString(_, letter)
                | svgtypes::Error::InvalidNumber(letter) => letter.saturating_sub(1),
                _ => value.trim_end().chars().count(),
            };
            value.char_indices().nth(letter).map_or(value.len(), |(at, _)| at)
        });
        // Where entities stand in it, only its beginning is known.
        let starts = if stands_as(self.text, &range, value) { usize::MAX } else { 0 };
        let byte = |at: usize| range.start + at.min(starts);
        if let Some(word) = huge_number(value) {
            let end = word.start.min(at.unwrap_or(usize::MAX));
            let before = value.get(..end).unwrap_or_default().trim_end_matches(['-', '+']);
            self.edits.push((range.clone(), escaped(before)));
            if end == word.start {
                let found = shortened(value.get(word).unwrap_or_default());
                let what = "is no place on a sheet: what comes before is drawn, the rest is left out";
                self.tell(byte(end), format!("{found} {what}"));
                return;
            }
        }
        let (Some((_, what)), Some(at)) = (wrong, at) else {
            if name == "points" && svgtypes::NumberListParser::from(value).count() % 2 == 1 {
                self.tell(range.start, "the last place has an x without a y: it is left out".to_owned());
            }
            return;
        };
        let found = value.get(at..).unwrap_or_default();
        let found = found.split([' ', ',', '\n', '\t']).next().unwrap_or_default();
        let found = if found.is_empty() { "its end".to_owned() } else { shortened(found) };
        self.tell(
            byte(at),
            format!("a {what} is wrong at {found}: what comes before is drawn, the rest is left out"),
        );
    }

    /// A number that is none: as if it were not given.
    fn number(&mut self, name: &str, value: &str, range: Range<usize>) {
        let mut words = value.split(|letter: char| !letter.is_ascii_alphabetic());
        if words.any(|word| ["nan", "inf", "infinity"].iter().any(|none| word.eq_ignore_ascii_case(none))) {
            let text = format!(
                "{name} holds {}, which is no number: it is taken as if it were not there",
                shortened(value)
            );
            self.tell(range.start, text);
        }
    }
}

/// Whether each byte of an attribute's value stands in the file as it is; only line ends have become blanks.
fn stands_as(text: &str, range: &Range<usize>, value: &str) -> bool {
    range.len() == value.len() && text.get(range.clone()).is_some_and(|text| !text.contains('&'))
}

/// As the value of an attribute.
fn escaped(value: &str) -> String {
    let mut escaped = String::with_capacity(value.len());
    for letter in value.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&apos;"),
            letter => escaped.push(letter),
        }
    }
    escaped
}
