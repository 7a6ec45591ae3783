//! [`told_ink`]: how ink was told from paper, in words, and [`assumed`]: all that was, alike in all tools.

use plotter_vector::ink::{Look, Split};

/// How ink was told from paper, each line with its subject: as was found of an uneven picture, or by one
/// level. A picture without ink is said to be an empty sheet.
#[must_use]
pub fn told_ink(look: Option<Look>, split: Option<Split>) -> Vec<(&'static str, String)> {
    let mut told = look.map(|look| look.told()).unwrap_or_default();
    match split {
        Some(split) if look.is_none_or(|look| look.line_px <= 0.0) => {
            let (side, way) = if split.ink_is_dark { ("dark", "up to") } else { ("light", "above") };
            told.insert(0, ("ink", format!("{side}: levels {way} {}", split.level)));
        }
        None => told.insert(0, ("ink", "none: the sheet is empty".into())),
        Some(_) => {}
    }
    told
}

/// What was assumed as lines of JSON, each with its subject.
#[must_use]
pub fn assumed(told: &[(&'static str, String)]) -> Vec<String> {
    told.iter().map(|(subject, text)| format!("{subject}: {text}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_a_look_and_an_empty_sheet_are_told_with_their_subjects() {
        let split = Split { level: 127, ink_is_dark: false, has_greys: true, ink_pixels: 9 };
        assert_eq!(told_ink(None, Some(split)), [("ink", "light: levels above 127".into())]);
        let look = Look { ink_levels: 140.0, noise_levels: 2.5, line_px: 5.0, ..Look::default() };
        let told = told_ink(Some(look), Some(split));
        assert_eq!(told, look.told());
        assert_eq!(told_ink(None, None), [("ink", "none: the sheet is empty".into())]);
        let specks = Look { left_out: 3, ..Look::default() };
        let told = told_ink(Some(specks), None);
        assert_eq!(told.first().map(|(subject, _)| *subject), Some("ink"));
        assert!(told.iter().any(|(_, text)| text == "3 specks"), "{told:?}");
    }
}
