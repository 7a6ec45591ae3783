//! [`with_numbers`]: sizes of letters that are named, as numbers. The parser takes `x-small` for a part of the size around it, as
//! `smaller` is; it is a size of its own.

use super::FONT_SIZE_PX;
use core::ops::Range;
use usvg::roxmltree::Document;

/// The named sizes, in parts of `medium` (CSS Fonts Level 4, section 2.5, "Absolute-size scaling").
const NAMED: [(&str, f32); 8] = [
    ("xx-small", 3.0 / 5.0),
    ("x-small", 3.0 / 4.0),
    ("small", 8.0 / 9.0),
    ("medium", 1.0),
    ("large", 6.0 / 5.0),
    ("x-large", 3.0 / 2.0),
    ("xx-large", 2.0),
    ("xxx-large", 3.0),
];

/// The text of a file with a number for each named size, all lines where they were; `None` where there is nothing to change.
pub(super) fn with_numbers(text: &str, document: &Document<'_>) -> Option<String> {
    let mut named: Vec<(Range<usize>, f32)> = Vec::new();
    for node in document.descendants() {
        if node.is_text() && node.parent().is_some_and(|parent| parent.tag_name().name() == "style") {
            in_sheet(text, node.range(), &mut named);
        }
        for attribute in node.attributes() {
            match attribute.name() {
                "font-size" => in_value(text, attribute.range_value(), &mut named),
                "style" => in_sheet(text, attribute.range_value(), &mut named),
                _ => {}
            }
        }
    }
    // What an entity stands for is met wherever it stands.
    named.sort_by_key(|(range, _)| range.start);
    named.dedup_by_key(|(range, _)| range.start);
    let (mut numbered, mut done) = (String::new(), 0);
    for (range, parts) in &named {
        numbered.push_str(text.get(done..range.start)?);
        numbered.push_str(&format!("{}px", parts * FONT_SIZE_PX));
        done = range.end;
    }
    numbered.push_str(text.get(done..)?);
    (done > 0).then_some(numbered)
}

/// The named sizes of the declarations of a style sheet, or of a `style`.
fn in_sheet(text: &str, range: Range<usize>, named: &mut Vec<(Range<usize>, f32)>) {
    let mut start = range.start;
    for declaration in text.get(range).unwrap_or_default().split([';', '{', '}']) {
        let end = start + declaration.len();
        if let Some((name, value)) = declaration.split_once(':')
            && name.trim().eq_ignore_ascii_case("font-size")
        {
            in_value(text, end - value.len()..end, named);
        }
        start = end + 1;
    }
}

/// The first word of a value that names a size.
fn in_value(text: &str, range: Range<usize>, named: &mut Vec<(Range<usize>, f32)>) {
    let mut start = range.start;
    for word in text
        .get(range)
        .unwrap_or_default()
        .split(|letter: char| letter.is_ascii_whitespace() || letter == '/')
    {
        if let Some((_, parts)) = NAMED.iter().find(|(name, _)| name.eq_ignore_ascii_case(word)) {
            named.push((start..start + word.len(), *parts));
            return;
        }
        start += word.len() + 1;
    }
}
