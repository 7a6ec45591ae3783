//! [`numbered`]: sizes of letters that are named, as numbers. The parser takes `x-small` for a part of the
//! size around it, as `smaller` is; it is a size of its own.

use super::FONT_SIZE_PX;

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

/// A value with a number for the first word that names a size; `None` where none does.
pub(super) fn numbered(value: &str) -> Option<String> {
    let mut start = 0;
    for word in value.split(|letter: char| letter.is_ascii_whitespace() || letter == '/') {
        let end = start + word.len();
        if let Some((_, parts)) = NAMED.iter().find(|(name, _)| name.eq_ignore_ascii_case(word)) {
            let (before, after) = (value.get(..start)?, value.get(end..)?);
            return Some(format!("{before}{}px{after}", parts * FONT_SIZE_PX));
        }
        start = end + 1;
    }
    None
}
