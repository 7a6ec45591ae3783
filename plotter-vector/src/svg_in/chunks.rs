//! [`chunks`]: a large file as several small ones, each with what all of them refer to.
//!
//! The parser makes some 400 bytes of a small element, all elements at a time. What is drawn by a part of
//! them does not depend on the others, so the parts are read one after the other, in their order; groups
//! around them are opened and closed in each:
//!
//! ```text
//!   svg ─ defs, g ─ a b c d        svg ─ defs, g ─ a b  and  svg ─ defs, g ─ c d
//! ```
//!
//! Only what says so itself is divided: not what clips, hides or names what is drawn elsewhere.

use super::survey::{TEMPLATES, targets};
use core::ops::Range;
use std::collections::BTreeSet;
use usvg::roxmltree::{Document, Node};

/// Elements and texts between them in a chunk: some 10 MB of the parser, little beside the text of a file
/// with so many.
const NODES: usize = 20_000;
/// Most nodes of what is in each chunk: a tenth, by which all takes longer.
const MAX_SHARED_NODES: usize = NODES / 10;
/// Deepest group that is divided.
const MAX_DEPTH: usize = 16;

/// Elements that draw nothing themselves, and that others refer to.
const SHARED: [&str; 4] = ["linearGradient", "radialGradient", "filter", "style"];

/// The parts of a file's text that make each chunk; `None` where it is small, or cannot be divided.
pub(super) fn chunks(document: &Document<'_>, text: &str) -> Option<Vec<Vec<Range<usize>>>> {
    let root = document.root_element();
    let count = document.descendants().count();
    if count < 2 * NODES || text.contains("<!ENTITY") || !has_size(root) || !can_be_divided(document) {
        return None;
    }
    let mut made = Chunks {
        text,
        shared: Vec::new(),
        around: Vec::new(),
        chunk: Vec::new(),
        nodes: 0,
        done: Vec::new(),
    };
    // The root's own tag comes first, and then what is shared.
    let open = tag(text, root)?;
    let mut shared_nodes = 0;
    made.shared.push(open);
    for child in root.children().filter(Node::is_element) {
        if is_shared(child) {
            shared_nodes += child.descendants().count();
            made.shared.push(child.range());
        }
    }
    if shared_nodes > MAX_SHARED_NODES {
        return None;
    }
    made.begin();
    made.add_children(root, count, 0)?;
    made.end(closing(text, root)?);
    Some(made.done)
}

/// Chunks in the making.
struct Chunks<'a> {
    text: &'a str,
    shared: Vec<Range<usize>>,
    /// The tags that open and close the groups around.
    around: Vec<(Range<usize>, Range<usize>)>,
    chunk: Vec<Range<usize>>,
    nodes: usize,
    done: Vec<Vec<Range<usize>>>,
}

impl Chunks<'_> {
    fn begin(&mut self) {
        self.nodes = 0;
        self.chunk.clone_from(&self.shared);
        self.chunk.extend(self.around.iter().map(|(open, _)| open.clone()));
    }

    fn end(&mut self, root: Range<usize>) {
        self.chunk.extend(self.around.iter().rev().map(|(_, close)| close.clone()));
        self.chunk.push(root);
        self.done.push(core::mem::take(&mut self.chunk));
    }

    /// Adds what is in a group whose nodes end at a number. As deep as groups are divided.
    fn add_children(&mut self, group: Node<'_, '_>, end: usize, depth: usize) -> Option<()> {
        let root = closing(self.text, group.document().root_element())?;
        // Where the last one that was added ended, if nothing was left out since.
        let mut last = None;
        for child in group.children() {
            if !child.is_element() {
                continue;
            }
            if depth == 0 && is_shared(child) {
                last = None;
                continue;
            }
            let next = child.next_sibling().map_or(end, |next| next.id().get_usize());
            let nodes = next.saturating_sub(child.id().get_usize());
            if nodes > NODES {
                if depth >= MAX_DEPTH || !is_plain(child) {
                    return None;
                }
                let around = (tag(self.text, child)?, closing(self.text, child)?);
                self.chunk.push(around.0.clone());
                self.around.push(around);
                self.add_children(child, next, depth + 1)?;
                self.chunk.extend(self.around.pop().map(|(_, close)| close));
                last = None;
                continue;
            }
            match (last, self.chunk.last_mut()) {
                (Some(end), Some(range)) if range.end == end => range.end = child.range().end,
                _ => self.chunk.push(child.range()),
            }
            last = Some(child.range().end);
            self.nodes += nodes;
            if self.nodes > NODES {
                self.end(root.clone());
                self.begin();
                last = None;
            }
        }
        Some(())
    }
}

fn is_shared(node: Node<'_, '_>) -> bool {
    let name = node.tag_name().name();
    TEMPLATES.contains(&name) || SHARED.contains(&name)
}

/// A group that does nothing to all that is in it but move and paint it.
fn is_plain(node: Node<'_, '_>) -> bool {
    let clips = |text: &str| text.contains("clip") || text.contains("mask");
    matches!(node.tag_name().name(), "g" | "a")
        && node.attributes().all(|attribute| {
            !clips(attribute.name()) && (attribute.name() != "style" || !clips(attribute.value()))
        })
}

/// Whether the size of the sheet is said by itself, and not by all that is drawn.
fn has_size(root: Node<'_, '_>) -> bool {
    let is_length = |name: &str| root.attribute(name).is_some_and(|text| !text.contains('%'));
    root.has_attribute("viewBox") || (is_length("width") && is_length("height"))
}

/// Whether no element refers to one that is not shared, and no style sheet is anywhere else, asks what stands
/// before an element, or clips.
fn can_be_divided(document: &Document<'_>) -> bool {
    let mut named: BTreeSet<&str> = BTreeSet::new();
    for node in document.descendants() {
        if node.is_text() && node.parent().is_some_and(|parent| parent.tag_name().name() == "style") {
            let text = node.text().unwrap_or_default();
            if ["+", "~", "-child", "-of-type", "clip", "mask"].iter().any(|word| text.contains(word)) {
                return false;
            }
            named.extend(targets(text));
        }
        for attribute in node.attributes() {
            named.extend(targets(attribute.value()));
            if attribute.name() == "href" {
                named.extend(attribute.value().trim().strip_prefix('#'));
            }
        }
    }
    let root = document.root_element();
    let is_everywhere = |node: Node<'_, '_>| {
        node.attribute("id").is_some_and(|id| named.contains(id)) || node.tag_name().name() == "style"
    };
    let top =
        |node: Node<'_, '_>| node.ancestors().find(|up| up.parent() == Some(root)).is_some_and(is_shared);
    document.descendants().filter(Node::is_element).all(|node| !is_everywhere(node) || top(node))
}

/// The tag that opens an element with something in it.
fn tag(text: &str, node: Node<'_, '_>) -> Option<Range<usize>> {
    let range = node.range().start..node.first_child()?.range().start;
    text.get(range.clone())?.ends_with('>').then_some(range)
}

/// The tag that closes it.
fn closing(text: &str, node: Node<'_, '_>) -> Option<Range<usize>> {
    let range = node.range();
    let start = range.start + text.get(range.clone())?.rfind("</")?;
    Some(start..range.end)
}

/// A chunk as a text of its own.
pub(super) fn text_of(text: &str, parts: &[Range<usize>]) -> String {
    parts.iter().filter_map(|range| text.get(range.clone())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg_in::{SvgOptions, SvgPens, read_svg};

    /// A file of so many lines in groups, with things that all of them refer to.
    fn file(lines: usize, body: &str) -> String {
        let line = |y: usize| format!("<path d='M0 {}H9'/>", y % 90);
        let half = (0..lines / 2).map(line).collect::<String>();
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='100' height='100' fill='none'>\
             <defs><clipPath id='c'><rect width='5' height='99'/></clipPath><path id='p' d='M20 0V9' stroke='#00f'/></defs>\
             <g id='7 a' transform='translate(10)' stroke='red'>{half}<g clip-path='url(#c)'><path d='M0 95H9'/></g>{half}</g>\
             <g id='2 b' stroke='#000'><g transform='scale(2)'>{half}{body}</g><use href='#p'/></g></svg>"
        )
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn the_pieces_of_a_file_draw_what_it_draws() {
        let text = file(3 * NODES / 2, "<text>ink</text>");
        let document = Document::parse(&text).unwrap();
        assert_eq!(chunks(&document, &text).unwrap().len(), 3);
        // What may stand for anything is read as a whole.
        let whole = format!("<!DOCTYPE svg [<!ENTITY a 'b'>]>{text}");
        let options = SvgOptions { pens: SvgPens::ByLayer, ..SvgOptions::default() };
        let read = |text: &str| read_svg(text.as_bytes(), &options).unwrap();
        let (whole, chunks) = (read(&whole), read(&text));
        assert!(whole == chunks, "{:?}, {:?}", whole.left_out, chunks.left_out);
        assert_eq!((chunks.left_out.clip_paths, chunks.left_out.texts), (1, 1));
        assert_eq!(chunks.drawing.strokes().len(), 3 * (3 * NODES / 4) + 2);
    }

    #[test]
    fn what_depends_on_the_rest_is_not_divided() {
        let divided = |text: &str| {
            let options = usvg::roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
            chunks(&Document::parse_with_options(text, options).unwrap(), text).is_some()
        };
        let large = |body: &str| file(3 * NODES / 2, body);
        assert!(divided(&large("")));
        assert!(divided(&large("").replacen("<defs>", "<style>.a{stroke:red}</style><defs>", 1)));
        assert!(!divided(&file(100, "")));
        for body in [
            "<path id='q' d='M0 0H1'/><use href='#q'/>",
            "<linearGradient id='q'/><path d='M0 0H9' stroke='url(#q)'/>",
            "<style/>",
        ] {
            assert!(!divided(&large(body)), "{body}");
        }
        for (from, to) in [
            ("width='100' height='100'", "width='100%' height='100'"),
            ("<defs>", "<style>path:first-child{stroke:red}</style><defs>"),
            ("<defs>", "<style>g{clip-path:url(#c)}</style><defs>"),
            ("<g id='7 a'", "<g id='7 a' clip-path='url(#c)'"),
            ("<g id='7 a'", "<g id='7 a' style='mask:url(#c)'"),
        ] {
            assert!(!divided(&large("").replacen(from, to, 1)), "{to}");
        }
    }
}
