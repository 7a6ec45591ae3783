//! [`Survey`]: what a file holds, and whether it is safe to follow its references.
//!
//! A few lines of `<use>` can stand for more elements than there is memory for, and a chain of patterns for
//! more nesting than there is stack. Both are counted here before anything is built, each element once.

use super::SvgError;
use core::ops::Range;
use std::collections::BTreeMap;
use usvg::roxmltree::{Document, Node, NodeId};

/// Most elements, when each reference is followed.
pub(super) const MAX_ELEMENTS: usize = 2_000_000;
/// Most elements that the parser takes at a time: all, where a file cannot be divided.
pub(super) const MAX_PARSED: usize = 1_000_000;
/// Deepest nesting, when each reference is followed: what the parser and its stack are made for.
pub(super) const MAX_DEPTH: usize = 1000;
/// Most steps that setting the texts may take, when each reference is followed: some ten seconds.
const MAX_TEXT_STEPS: usize = 20_000_000;
/// Greatest number that an attribute may hold: single precision loses figures long before.
const MAX_NUMBER: f64 = 1e12;

/// Attributes that hold coordinates.
const COORDINATES: [&str; 17] = [
    "d",
    "points",
    "transform",
    "viewBox",
    "x",
    "y",
    "width",
    "height",
    "cx",
    "cy",
    "r",
    "rx",
    "ry",
    "x1",
    "y1",
    "x2",
    "y2",
];
/// Elements whose content is drawn only where something refers to them, if at all.
pub(super) const TEMPLATES: [&str; 6] = ["defs", "symbol", "clipPath", "mask", "pattern", "marker"];

/// What a file holds that the parser does not tell.
#[derive(Debug)]
pub(super) struct Survey {
    /// Letters, without spaces, and line of each text that is not empty.
    pub(super) texts: Vec<(String, u32)>,
    /// Pictures.
    pub(super) images: usize,
    /// Line of the first of them.
    pub(super) image_line: Option<u32>,
}

impl Survey {
    /// `sets_texts` says whether texts are more than counted; `max_depth` how deep elements may be nested.
    pub(super) fn new(document: &Document<'_>, sets_texts: bool, max_depth: usize) -> Result<Self, SvgError> {
        for node in document.descendants().filter(Node::is_element) {
            check_numbers(document, node)?;
        }
        check_references(document, sets_texts, max_depth)?;
        let drawn = |name: &str| {
            let templates =
                |node: &Node<'_, '_>| node.ancestors().any(|up| TEMPLATES.contains(&up.tag_name().name()));
            document
                .descendants()
                .filter(|node| node.has_tag_name(name_of(node, name)) && !templates(node))
                .collect()
        };
        let texts: Vec<Node<'_, '_>> = drawn("text");
        let images: Vec<Node<'_, '_>> = drawn("image");
        let line = |node: &Node<'_, '_>| document.text_pos_at(node.range().start).row;
        let written = |node: &Node<'_, '_>| {
            let letters =
                without_spaces(node.descendants().filter(Node::is_text).filter_map(|part| part.text()));
            (!letters.is_empty()).then(|| (letters, line(node)))
        };
        Ok(Self {
            texts: texts.iter().filter_map(written).collect(),
            images: images.len(),
            image_line: images.first().map(line),
        })
    }
}

/// The name in the node's own namespace: files without one are read too.
fn name_of<'a>(node: &Node<'a, '_>, name: &'a str) -> usvg::roxmltree::ExpandedName<'a, 'a> {
    match node.tag_name().namespace() {
        Some(namespace) => (namespace, name).into(),
        None => name.into(),
    }
}

/// A text by its letters alone: however it is laid out, it is known by them.
pub(super) fn without_spaces<'a>(parts: impl Iterator<Item = &'a str>) -> String {
    parts.flat_map(str::chars).filter(|letter| !letter.is_whitespace()).collect()
}

/// A piece of the file that fits into a message.
pub(super) fn shortened(text: &str) -> String {
    let mut short: String = text.chars().take(24).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

/// Refuses coordinates that are beyond the parser's precision.
fn check_numbers(document: &Document<'_>, node: Node<'_, '_>) -> Result<(), SvgError> {
    let own = |name: &str, namespace: Option<&str>| namespace.is_none() && COORDINATES.contains(&name);
    for attribute in node.attributes().filter(|attribute| own(attribute.name(), attribute.namespace())) {
        if let Some(word) = huge_number(attribute.value()) {
            return Err(SvgError::Number {
                line: document.text_pos_at(node.range().start).row,
                attribute: attribute.name().to_owned(),
                value: shortened(attribute.value().get(word).unwrap_or_default()),
            });
        }
    }
    Ok(())
}

/// Where the first number stands that is beyond the parser's precision, without its sign.
pub(super) fn huge_number(text: &str) -> Option<Range<usize>> {
    // A minus begins a number, or an exponent that makes it small.
    let in_number = |letter: char| letter.is_ascii_digit() || matches!(letter, '.' | '+' | 'e' | 'E');
    let mut at = 0;
    for word in text.split_inclusive(|letter| !in_number(letter)) {
        let number = word.trim_end_matches(|letter| !in_number(letter));
        if number.parse::<f64>().is_ok_and(|number| number.abs() > MAX_NUMBER) {
            return Some(at..at + number.len());
        }
        at += word.len();
    }
    None
}

/// An element whose references are being followed.
struct Open {
    id: NodeId,
    next: Vec<NodeId>,
    total: Total,
}

/// What an element comes to, all that it refers to included.
#[derive(Clone, Copy)]
struct Total {
    elements: usize,
    depth: usize,
    text_steps: usize,
}

#[derive(Clone, Copy)]
enum Cost {
    Unknown,
    Open,
    Known(Total),
}

/// Counts elements and nesting as if each reference were its target.
fn check_references(document: &Document<'_>, sets_texts: bool, max_depth: usize) -> Result<(), SvgError> {
    let mut ids: BTreeMap<&str, NodeId> = BTreeMap::new();
    let elements = || document.descendants().filter(Node::is_element);
    for (id, node) in elements().filter_map(|node| node.attribute("id").zip(Some(node.id()))) {
        ids.entry(id).or_insert(node);
    }
    let links = Links { ids, rules: rules(document), sets_texts, max_depth };
    let mut costs = vec![Cost::Unknown; document.descendants().count()];
    let root = document.root_element().id();
    follow(document, root, &links, &mut costs)
}

/// Elements and nesting of one element with all that it refers to. A loop rather than a recursion: the stack
/// is what is being checked.
fn follow(
    document: &Document<'_>,
    root: NodeId,
    links: &Links<'_>,
    costs: &mut [Cost],
) -> Result<(), SvgError> {
    let mut open = vec![Open::new(document, root, links)];
    while let Some(top) = open.last_mut() {
        let Some(id) = top.next.pop() else {
            let done = top.total;
            if let Some(cost) = costs.get_mut(top.id.get_usize()) {
                *cost = Cost::Known(done);
            }
            open.pop();
            if let Some(parent) = open.last_mut() {
                parent.add(done, links.max_depth)?;
            }
            continue;
        };
        match costs.get(id.get_usize()).copied().unwrap_or(Cost::Unknown) {
            Cost::Known(total) => top.add(total, links.max_depth)?,
            Cost::Open => {
                let name = document.get_node(id).and_then(|node| node.attribute("id")).unwrap_or_default();
                return Err(SvgError::Circular { id: shortened(name) });
            }
            Cost::Unknown => {
                if let Some(cost) = costs.get_mut(id.get_usize()) {
                    *cost = Cost::Open;
                }
                if open.len() >= links.max_depth {
                    return Err(SvgError::TooDeep { limit: links.max_depth });
                }
                open.push(Open::new(document, id, links));
            }
        }
    }
    Ok(())
}

impl Open {
    fn new(document: &Document<'_>, id: NodeId, links: &Links<'_>) -> Self {
        let text_steps = if links.sets_texts { text_steps(document, id, links) } else { 0 };
        Self { id, next: next(document, id, links), total: Total { elements: 1, depth: 1, text_steps } }
    }

    fn add(&mut self, more: Total, max_depth: usize) -> Result<(), SvgError> {
        let total = &mut self.total;
        total.elements = total.elements.saturating_add(more.elements);
        total.depth = total.depth.max(more.depth.saturating_add(1));
        total.text_steps = total.text_steps.saturating_add(more.text_steps);
        if total.elements > MAX_ELEMENTS {
            return Err(SvgError::TooManyElements { limit: MAX_ELEMENTS });
        }
        if total.text_steps > MAX_TEXT_STEPS {
            return Err(SvgError::TooMuchText);
        }
        if total.depth > max_depth { Err(SvgError::TooDeep { limit: max_depth }) } else { Ok(()) }
    }
}

/// Steps that setting a text takes; none for other elements. Of letters that follow each other without a
/// place of their own the parser shapes all for each piece, and searches from the first for each letter.
fn text_steps(document: &Document<'_>, id: NodeId, links: &Links<'_>) -> usize {
    /// Letters that are passed over in the time in which one is shaped.
    const PASSED: usize = 256;
    let Some(node) = document.get_node(id).filter(|node| node.tag_name().name() == "text") else { return 0 };
    let count = |node: Node<'_, '_>| {
        node.descendants()
            .filter(Node::is_text)
            .filter_map(|part| part.text())
            .map(|text| text.chars().count())
            .sum()
    };
    let (mut steps, mut letters, mut pieces) = (0_usize, 0_usize, 0_usize);
    let row = |letters: usize, pieces: usize| letters.saturating_mul(pieces.saturating_add(letters / PASSED));
    for part in node.descendants() {
        let is_placed = ["x", "y"].iter().any(|name| part.has_attribute(*name));
        if is_placed || part.tag_name().name() == "textPath" {
            steps = steps.saturating_add(row(letters, pieces));
            (letters, pieces) = (0, 0);
        }
        // The letters of another element.
        let named = part.attributes().find(|attribute| attribute.name() == "href");
        let named =
            named.filter(|_| part.tag_name().name() == "tref").map(|attribute| attribute.value().trim());
        let other = named.and_then(|link| document.get_node(*links.ids.get(link.strip_prefix('#')?)?));
        let own: usize = if part.is_text() { count(part) } else { other.map_or(0, count) };
        if own > 0 {
            letters = letters.saturating_add(own);
            pieces += 1;
        }
    }
    steps.saturating_add(row(letters, pieces))
}

/// The elements in an element, and those that it refers to.
fn next(document: &Document<'_>, id: NodeId, links: &Links<'_>) -> Vec<NodeId> {
    let Some(node) = document.get_node(id) else { return Vec::new() };
    let mut next: Vec<NodeId> = node.children().filter(Node::is_element).map(|child| child.id()).collect();
    for attribute in node.attributes() {
        // A link to elsewhere in the file draws nothing there.
        let link = attribute.name() == "href" && node.tag_name().name() != "a";
        let whole = link.then(|| attribute.value().trim().strip_prefix('#')).flatten();
        let known = |id: &str| links.ids.get(id).copied();
        next.extend(targets(attribute.value()).chain(whole).filter_map(known));
    }
    for rule in links.rules.iter().filter(|rule| rule.may_select(node)) {
        next.extend(targets(rule.body).filter_map(|id| links.ids.get(id).copied()));
    }
    next
}

/// Where references lead.
struct Links<'a> {
    ids: BTreeMap<&'a str, NodeId>,
    rules: Vec<Rule<'a>>,
    sets_texts: bool,
    max_depth: usize,
}

/// A rule of a style sheet that refers to something.
struct Rule<'a> {
    selector: &'a str,
    body: &'a str,
}

/// The rules that refer to something, of all style sheets.
fn rules<'a>(document: &'a Document<'_>) -> Vec<Rule<'a>> {
    let styles = document.descendants().filter(|node| node.tag_name().name() == "style");
    let texts =
        styles.flat_map(|style| style.descendants()).filter(Node::is_text).filter_map(|part| part.text());
    let blocks = texts.flat_map(|text| text.split('}')).filter(|block| block.contains("url("));
    // What stands before the last brace holds the selector, whatever it is nested in.
    blocks
        .map(|body| Rule { selector: body.rsplit_once('{').map_or(body, |(before, _)| before), body })
        .collect()
}

impl Rule<'_> {
    /// Whether the rule may be for this element: when its name, id or a class of it is in the selector, or
    /// the selector is beyond this reading. Too often is safe: the reference is counted where it is not.
    fn may_select(&self, node: Node<'_, '_>) -> bool {
        let beyond = |letter: char| matches!(letter, '*' | '[' | ':' | '\\') || !letter.is_ascii();
        let mut words =
            self.selector.split(|letter: char| !(letter.is_ascii_alphanumeric() || "-_".contains(letter)));
        let classes = node.attribute("class").unwrap_or_default();
        let named = |word: &str| {
            word == node.tag_name().name()
                || node.attribute("id") == Some(word)
                || classes.split_ascii_whitespace().any(|class| class == word)
        };
        self.selector.contains(beyond) || words.any(|word| !word.is_empty() && named(word))
    }
}

/// The ids in each `url(#id)` of a text.
pub(super) fn targets(text: &str) -> impl Iterator<Item = &str> {
    text.split("url(").skip(1).filter_map(|rest| {
        let rest = rest.trim_start_matches([' ', '\t', '\r', '\n', '"', '\'']).strip_prefix('#')?;
        rest.split([')', '"', '\'', ' ']).next()
    })
}
