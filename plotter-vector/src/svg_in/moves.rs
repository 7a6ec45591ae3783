//! [`Moves`]: what moves an element, of all that CSS knows.
//!
//! The parser knows `transform` and `transform-origin` of the view box. CSS Transforms Levels 1 and 2 have
//! more: the properties `translate`, `rotate` and `scale`, done before it in this order, and boxes of the
//! element itself, which origins and shares are of:
//!
//! ```text
//!   origin · translate · rotate · scale · transform · back from the origin
//!   ┌───────────────────────────────┐ view-box: begins at (0, 0), as large as the view
//!   │      ┌─────────┐ stroke-box   │
//!   │      │ fill-box│              │
//! ```
//!
//! Where a file says any of it, the cascade is followed here, and each element that is moved gets one matrix.
//! The boxes are those that the parser finds, the inner ones first: what is within a box has been moved then.

use super::css_transform::{self, Matrix, times};
use super::rewrite::{declarations, sound};
use super::survey::{Survey, TEMPLATES};
use super::{SvgError, document_of};
use core::ops::Range;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::str::FromStr;
use usvg::roxmltree::{Document, Node, NodeId};
use usvg::tiny_skia_path::Rect;

/// Ranges of a file, and what stands in their place.
type Replaced = Vec<(Range<usize>, String)>;

/// The properties that move an element, or say how it is moved.
pub(super) const PROPERTIES: [&str; 6] =
    ["transform", "transform-origin", "transform-box", "translate", "rotate", "scale"];
/// Most boxes within each other that are found, one after the other: for each the parser reads the file once.
const MAX_LEVELS: usize = 8;
/// Most pairs of a box and one around it.
const MAX_PAIRS: usize = 100_000;

/// Which box origins and shares are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reference {
    View,
    Fill,
    Stroke,
}

/// Corner and size of a box, in the element's own unit.
#[derive(Clone, Copy, Debug, Default)]
struct Area {
    corner: (f64, f64),
    size: (f64, f64),
}

/// An element that is moved.
#[derive(Debug)]
struct Moved {
    node: NodeId,
    values: [Option<String>; 6],
    reference: Reference,
    area: Area,
    /// By which it is found in the parser's tree.
    id: Option<String>,
    /// How many boxes lie in each other within its own.
    level: usize,
}

/// The elements of a file that are moved otherwise than the parser knows.
#[derive(Debug)]
pub(super) struct Moves {
    moved: Vec<Moved>,
    px_per_inch: f64,
}

/// Attributes that elements get, by the place in the file where they are added.
pub(super) type Added = BTreeMap<usize, BTreeMap<&'static str, String>>;

impl Moves {
    /// `resolved` puts in what variables hold; `view` is the size of the root's view.
    pub(super) fn new(
        document: &Document<'_>,
        px_per_inch: f64,
        view: (f64, f64),
        resolved: &dyn Fn(&str) -> String,
    ) -> Self {
        let styles = document.descendants().filter(|node| node.tag_name().name() == "style");
        let styles = styles.filter(|node| matches!(node.attribute("type"), None | Some("text/css")));
        let texts: Vec<Cow<'_, str>> =
            styles.filter_map(|style| style.text()).map(|text| sound(text, true)).collect();
        let mut sheet = simplecss::StyleSheet::new();
        texts.iter().for_each(|text| sheet.parse_more(text));
        let mut moved: Vec<Moved> = Vec::new();
        let mut held: BTreeMap<usize, usize> = BTreeMap::new();
        let root = document.root_element();
        for node in document.descendants().filter(Node::is_element) {
            let Some(mut values) = declared(node, &sheet, resolved) else { continue };
            let parent = node.parent().and_then(|parent| held.get(&number(parent)));
            let parent = parent.and_then(|parent| moved.get(*parent));
            for (property, value) in values.iter_mut().enumerate() {
                if value.as_ref().is_some_and(|value| value.eq_ignore_ascii_case("inherit")) {
                    *value = parent.and_then(|parent| parent.values.get(property)?.clone());
                }
            }
            let is_root = node == root;
            if let (true, [_, origin, ..]) = (is_root, &mut values) {
                // As that of other boxes of CSS; of all elements in the sheet it is its corner.
                origin.get_or_insert("center".to_owned());
            }
            let bare = |property: usize| values.get(property).and_then(Option::as_deref).unwrap_or("none");
            let moves = [0, 3, 4, 5].into_iter().any(|property| !css_transform::is_none(bare(property)));
            let reference = match bare(2).to_ascii_lowercase().as_str() {
                "fill-box" | "content-box" if moves && !is_root => Reference::Fill,
                "stroke-box" | "border-box" if moves && !is_root => Reference::Stroke,
                _ => Reference::View,
            };
            let size = if is_root { size_of(node, view, px_per_inch) } else { view_of(node, view) };
            let area = Area { corner: (0.0, 0.0), size };
            held.insert(number(node), moved.len());
            moved.push(Moved { node: node.id(), values, reference, area, id: None, level: 0 });
        }
        let mut moves = Self { moved, px_per_inch };
        moves.find_levels(document);
        moves
    }

    /// How many boxes lie within each: those around come after those in them, also where these are drawn by a
    /// reference.
    fn find_levels(&mut self, document: &Document<'_>) {
        let boxed: BTreeMap<usize, usize> = self
            .moved
            .iter()
            .enumerate()
            .filter(|(_, moved)| moved.reference != Reference::View)
            .map(|(index, moved)| (moved.node.get_usize(), index))
            .collect();
        if boxed.is_empty() {
            return;
        }
        let mut ids: BTreeMap<&str, usize> = BTreeMap::new();
        for (id, node) in
            document.descendants().filter_map(|node| node.attribute("id").zip(Some(number(node))))
        {
            ids.entry(id).or_insert(node);
        }
        // The elements that refer to each.
        let mut users: BTreeMap<usize, Vec<Node<'_, '_>>> = BTreeMap::new();
        for node in document.descendants().filter(|node| node.tag_name().name() == "use") {
            let href = node.attributes().find(|attribute| attribute.name() == "href");
            if let Some(target) = href.and_then(|href| ids.get(href.value().trim().strip_prefix('#')?)) {
                users.entry(*target).or_default().push(node);
            }
        }
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for inner in boxed.values() {
            let Some(node) = self.moved.get(*inner).and_then(|moved| document.get_node(moved.node)) else {
                continue;
            };
            let mut around: Vec<Node<'_, '_>> = node.ancestors().skip(1).collect();
            let users = node.ancestors().filter_map(|up| users.get(&number(up))).flatten();
            around.extend(users.flat_map(|user| user.ancestors()));
            pairs.extend(around.iter().filter_map(|up| Some((*inner, *boxed.get(&number(*up))?))));
            if pairs.len() > MAX_PAIRS {
                break;
            }
        }
        // The inner ones stand later in the file, mostly.
        for _ in 0..MAX_LEVELS {
            let mut has_changed = false;
            for (inner, outer) in pairs.iter().rev() {
                let least = self.moved.get(*inner).map_or(0, |moved| moved.level + 1).min(MAX_LEVELS - 1);
                if let Some(outer) = self.moved.get_mut(*outer).filter(|outer| outer.level < least) {
                    outer.level = least;
                    has_changed = true;
                }
            }
            if !has_changed {
                break;
            }
        }
    }

    /// Finds the boxes: `text_with` is the file with these attributes added, for the parser.
    ///
    /// # Errors
    /// Where a reference in the file is not safe to follow.
    pub(super) fn find_boxes(
        &mut self,
        document: &Document<'_>,
        text: &str,
        parser: &usvg::Options<'_>,
        max_depth: usize,
        text_with: &dyn Fn(Added, Replaced) -> Option<String>,
    ) -> Result<(), SvgError> {
        let Some(levels) = self
            .moved
            .iter()
            .filter(|moved| moved.reference != Reference::View)
            .map(|moved| moved.level)
            .max()
        else {
            return Ok(());
        };
        let mut prefix = String::from("box_");
        while text.contains(&prefix) {
            prefix.push('_');
        }
        let mut uses: BTreeMap<&str, usize> = BTreeMap::new();
        for id in document.descendants().filter_map(|node| node.attribute("id")) {
            *uses.entry(id).or_default() += 1;
        }
        for (number, moved) in self.moved.iter_mut().enumerate() {
            let own = document.get_node(moved.node).and_then(|node| node.attribute("id"));
            moved.id = match own {
                Some(id) if uses.get(id) == Some(&1) => Some(id.to_owned()),
                _ => Some(format!("{prefix}{number}")),
            };
        }
        for level in 0..=levels {
            let (mut added, mut edits) = (Added::new(), Vec::new());
            // What is drawn only by references has no name in the tree: it is drawn once more.
            let mut drawn = String::new();
            let root = document.root_element().range();
            let tag = text.get(root.start + 1..after_name(text, root.clone())).unwrap_or_default();
            let namespace =
                tag.rsplit_once(':').map_or(String::new(), |(namespace, _)| format!("{namespace}:"));
            for moved in &self.moved {
                let Some(node) = document.get_node(moved.node) else { continue };
                let is_known = moved.reference == Reference::View || moved.level < level;
                let matrix = if is_known { moved.matrix(self.px_per_inch) } else { css_transform::IDENTITY };
                set(text, node, "transform", css_transform::written(matrix), &mut added, &mut edits);
                if moved.level != level || moved.reference == Reference::View {
                    continue;
                }
                let Some(id) = &moved.id else { continue };
                if node.attribute("id") != Some(id) {
                    set(text, node, "id", id.clone(), &mut added, &mut edits);
                }
                if node.ancestors().any(|up| TEMPLATES.contains(&up.tag_name().name())) {
                    let (open, close) =
                        (format!("<{namespace}g id=\"{prefix}of_{id}\">"), format!("</{namespace}g>"));
                    let _ = write!(drawn, "{open}<{namespace}use href=\"#{id}\"/>{close}");
                }
            }
            // Marks along a path belong to no box.
            let _ = write!(drawn, "<{namespace}style>*{{marker:none!important}}</{namespace}style>");
            let end = text.get(root.clone()).and_then(|inner| inner.rfind("</")).map(|end| root.start + end);
            edits.extend(end.map(|end| (end..end, drawn)));
            let Some(text) = text_with(added, edits) else { return Ok(()) };
            let probe = document_of(&text)?;
            Survey::new(&probe, true, max_depth)?;
            let Ok(tree) = usvg::Tree::from_xmltree(&probe, parser) else { return Ok(()) };
            let mut boxes = BTreeMap::new();
            find(tree.root(), &mut boxes);
            for moved in self.moved.iter_mut().filter(|moved| moved.level == level) {
                let Some(id) = &moved.id else { continue };
                let found = boxes.get(&format!("{prefix}of_{id}")).or_else(|| boxes.get(id));
                let found = found.map_or_else(Area::default, |(fill, stroke)| {
                    if moved.reference == Reference::Fill { *fill } else { *stroke }
                });
                if moved.reference != Reference::View {
                    moved.area = found;
                }
            }
        }
        Ok(())
    }

    /// The matrices as attributes.
    pub(super) fn write(
        &self,
        document: &Document<'_>,
        text: &str,
        added: &mut Added,
        edits: &mut Vec<(Range<usize>, String)>,
    ) {
        for moved in &self.moved {
            if let Some(node) = document.get_node(moved.node) {
                let matrix = css_transform::written(moved.matrix(self.px_per_inch));
                set(text, node, "transform", matrix, added, edits);
                if node.has_attribute("transform-origin") || node == document.root_element() {
                    set(text, node, "transform-origin", "0 0".to_owned(), added, edits);
                }
            }
        }
    }
}

impl Moved {
    /// All that moves it. What is not understood, which has been told, moves nothing.
    fn matrix(&self, px_per_inch: f64) -> Matrix {
        let Area { corner, size } = self.area;
        let value = |property: usize| self.values.get(property).and_then(Option::as_deref).unwrap_or("none");
        let (x, y) = css_transform::origin(value(1), size, px_per_inch).unwrap_or_default();
        let (x, y) = (corner.0 + x, corner.1 + y);
        let own = |property: usize| {
            let name = PROPERTIES.get(property).copied().unwrap_or_default();
            css_transform::property(name, value(property), size, px_per_inch)
                .unwrap_or(css_transform::IDENTITY)
        };
        let transform =
            css_transform::transform(value(0), size, px_per_inch).unwrap_or(css_transform::IDENTITY);
        let steps = [own(3), own(4), own(5), transform, [1.0, 0.0, 0.0, 1.0, -x, -y]];
        steps.into_iter().fold([1.0, 0.0, 0.0, 1.0, x, y], times)
    }
}

/// Whether a file has any of it.
pub(super) fn has_any(document: &Document<'_>) -> bool {
    let is_one = |name: &str| PROPERTIES.iter().skip(2).any(|known| known.eq_ignore_ascii_case(name));
    document.descendants().any(|node| {
        let is_sheet =
            node.is_text() && node.parent().is_some_and(|parent| parent.tag_name().name() == "style");
        let Some(text) = (if is_sheet { node.text() } else { node.attribute("style") }) else { return false };
        let mut has = false;
        let lower = text.to_ascii_lowercase();
        if PROPERTIES.iter().skip(2).any(|known| lower.contains(known)) {
            declarations(text, is_sheet, |name, _| has |= text.get(name).is_some_and(is_one));
        }
        has
    })
}

/// What an element's attributes, the style sheets and its `style` say of each property, the last word of
/// these; `None` where it is nothing, or nothing that the parser does not know.
fn declared(
    node: Node<'_, '_>,
    sheet: &simplecss::StyleSheet<'_>,
    resolved: &dyn Fn(&str) -> String,
) -> Option<[Option<String>; 6]> {
    let mut held: [Option<(Cow<'_, str>, bool)>; 6] = Default::default();
    let mut is_of_css = false;
    for attribute in node.attributes().filter(|attribute| attribute.namespace().is_none()) {
        // The others are properties only, and `rotate` is another thing in texts.
        let property = PROPERTIES.iter().take(2).position(|known| *known == attribute.name());
        if let Some(held) = property.and_then(|property| held.get_mut(property)) {
            is_of_css |= property == Some(1) || svgtypes::Transform::from_str(attribute.value()).is_err();
            *held = Some((attribute.value().into(), false));
        }
    }
    let mut declare = |declaration: &simplecss::Declaration<'_>| {
        let name = declaration.name.to_ascii_lowercase();
        let property = PROPERTIES.iter().position(|known| *known == name);
        if let Some(held) = property.and_then(|property| held.get_mut(property))
            && (declaration.important || held.as_ref().is_none_or(|(_, important)| !important))
        {
            is_of_css = true;
            *held = Some((declaration.value.to_owned().into(), declaration.important));
        }
    };
    for rule in sheet.rules.iter().filter(|rule| rule.selector.matches(&Selected(node))) {
        rule.declarations.iter().for_each(&mut declare);
    }
    let style = sound(node.attribute("style").unwrap_or_default(), false);
    simplecss::DeclarationTokenizer::from(style.as_ref()).for_each(|declaration| declare(&declaration));
    is_of_css.then(|| held.map(|held| held.map(|(value, _)| resolved(&value).trim().to_owned())))
}

/// An element that selectors are matched with.
struct Selected<'a, 'input>(Node<'a, 'input>);

impl simplecss::Element for Selected<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Selected)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Selected)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: simplecss::AttributeOperator<'_>) -> bool {
        self.0.attribute(name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: simplecss::PseudoClass<'_>) -> bool {
        matches!(class, simplecss::PseudoClass::FirstChild) && self.0.prev_sibling_element().is_none()
    }
}

/// The size of the view that an element lies in: that of the nearest sheet around it which has one.
fn view_of(node: Node<'_, '_>, of_root: (f64, f64)) -> (f64, f64) {
    let view = |node: Node<'_, '_>| {
        let numbers: Vec<f64> = node
            .attribute("viewBox")?
            .split([' ', ','])
            .filter(|word| !word.is_empty())
            .filter_map(|word| word.parse().ok())
            .collect();
        if let [_, _, width, height] = numbers[..] { Some((width, height)) } else { None }
    };
    node.ancestors().skip(1).find_map(view).unwrap_or(of_root)
}

/// The size of the sheet, px, where it is said; else that of its view.
fn size_of(root: Node<'_, '_>, view: (f64, f64), px_per_inch: f64) -> (f64, f64) {
    let side = |name: &str, whole: f64| {
        let length = root.attribute(name).map(|text| text.trim().to_ascii_lowercase());
        length.and_then(|text| css_transform::length_px(&text, whole, px_per_inch)).unwrap_or(whole)
    };
    (side("width", view.0), side("height", view.1))
}

fn number(node: Node<'_, '_>) -> usize {
    node.id().get_usize()
}

/// Sets an attribute of an element, whether it has one or not.
fn set(
    text: &str,
    node: Node<'_, '_>,
    name: &'static str,
    value: String,
    added: &mut Added,
    edits: &mut Vec<(Range<usize>, String)>,
) {
    let own = node.attributes().find(|attribute| attribute.namespace().is_none() && attribute.name() == name);
    match own {
        Some(attribute) => edits.push((attribute.range_value(), value)),
        None => {
            added.entry(after_name(text, node.range())).or_default().insert(name, value);
        }
    }
}

/// Where the name of an element's tag ends.
pub(super) fn after_name(text: &str, range: Range<usize>) -> usize {
    let tag = text.get(range.clone()).unwrap_or_default();
    let end = tag.find(|letter: char| letter.is_whitespace() || matches!(letter, '>' | '/'));
    range.start + end.unwrap_or(0)
}

/// The boxes of all elements with names, each without and with its stroke, in the unit of what they hold; a
/// clone's without its `x` and `y`, as browsers have it.
fn find(group: &usvg::Group, boxes: &mut BTreeMap<String, (Area, Area)>) {
    for node in group.children() {
        if !node.id().is_empty() {
            let areas = (area(node.bounding_box()), area(node.stroke_bounding_box()));
            boxes.entry(node.id().to_owned()).or_insert(areas);
        }
        if let usvg::Node::Group(group) = node {
            find(group, boxes);
        }
    }
}

fn area(rect: Rect) -> Area {
    let [x, y, width, height] = [rect.x(), rect.y(), rect.width(), rect.height()].map(f64::from);
    Area { corner: (x, y), size: (width, height) }
}
