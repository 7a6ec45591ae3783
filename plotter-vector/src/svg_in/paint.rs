//! [`known`]: paints as the parser knows them. For a plotter any paint but `none` is ink: one that is not
//! understood draws the line all the same, in black.

use crate::picture::Rgb;
use std::str::FromStr;
use svgtypes::Color;

impl Rgb {
    /// A colour as CSS writes it: by its name, or as `#f80`, `rgb(255 136 0)`, `hsl(32 100% 50%)`,
    /// `oklch(0.75 0.18 60)`; without its alpha. `None` where it is not understood.
    ///
    /// ```
    /// # use plotter_vector::Rgb;
    /// assert_eq!(Rgb::from_css("rebeccapurple"), Some(Rgb([0x66, 0x33, 0x99])));
    /// assert_eq!(Rgb::from_css("none"), None);
    /// ```
    #[must_use]
    pub fn from_css(text: &str) -> Option<Self> {
        let [red, green, blue, _] = colour(&text.trim().to_ascii_lowercase())?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 0..=255")]
        let byte = |part: f64| libm::round(part.clamp(0.0, 1.0) * 255.0) as u8;
        Some(Self([red, green, blue].map(byte)))
    }
}

/// What a paint is rewritten to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Known {
    /// It is understood as it stands.
    AsItIs,
    /// The same in other words.
    So(String),
    /// Nobody knows its colour.
    Black,
}

/// A paint in words that the parser knows; `property` is the property's name.
pub(super) fn known(value: &str, property: &str) -> Known {
    let (bare, important) = without_important(value);
    match bare_known(bare, property) {
        Known::So(new) => Known::So(format!("{new}{important}")),
        other => other,
    }
}

/// A value, and the `!important` behind it.
pub(super) fn without_important(value: &str) -> (&str, &str) {
    let value = value.trim();
    match value.rfind('!') {
        Some(at) if value.get(at + 1..).is_some_and(|word| word.trim().eq_ignore_ascii_case("important")) => {
            let (bare, important) = value.split_at(at);
            (bare.trim_end(), important)
        }
        _ => (value, ""),
    }
}

fn bare_known(value: &str, property: &str) -> Known {
    let lower = value.to_ascii_lowercase();
    let word = match lower.as_str() {
        "none" | "inherit" | "context-fill" | "context-stroke" | "transparent" => Some(lower.as_str()),
        "currentcolor" if property == "color" => Some("inherit"),
        "currentcolor" => Some("currentColor"),
        "initial" => Some(if property == "stroke" { "none" } else { "black" }),
        "unset" | "revert" | "revert-layer" => Some("inherit"),
        _ => None,
    };
    if let Some(word) = word {
        return if word == value { Known::AsItIs } else { Known::So(word.to_owned()) };
    }
    if lower.starts_with("url(") {
        let end = value.find(')').map_or(value.len(), |end| end + 1);
        let (link, fallback) = value.split_at(end);
        let inner = link.get(4..).unwrap_or_default().trim_start_matches([' ', '"', '\'']);
        let fallback = fallback.trim();
        let fallback = match bare_known(if fallback.is_empty() { "black" } else { fallback }, property) {
            Known::AsItIs if fallback.is_empty() => "black".to_owned(),
            Known::AsItIs => fallback.to_owned(),
            Known::So(new) => new,
            Known::Black => "black".to_owned(),
        };
        // A paint of another file is never seen.
        return Known::So(if inner.starts_with('#') { format!("{link} {fallback}") } else { fallback });
    }
    if Color::from_str(value).is_ok() {
        return Known::AsItIs;
    }
    match colour(&lower) {
        Some([red, green, blue, alpha]) if alpha > 0.0 => {
            let byte = |part: f64| libm::round(part.clamp(0.0, 1.0) * 255.0);
            let [red, green, blue] = [red, green, blue].map(byte);
            Known::So(format!("rgba({red},{green},{blue},{})", alpha.min(1.0)))
        }
        Some(_) => Known::So("none".to_owned()),
        None => Known::Black,
    }
}

/// Red, green, blue and alpha, 0 to 1, of a colour in small letters.
fn colour(text: &str) -> Option<[f64; 4]> {
    if let Ok(Color { red, green, blue, alpha }) = Color::from_str(text) {
        return Some([red, green, blue, alpha].map(|byte| f64::from(byte) / 255.0));
    }
    // The one name of CSS that SVG has not.
    if text == "rebeccapurple" {
        return colour("#663399");
    }
    let (name, rest) = text.split_once('(')?;
    let arguments = rest.strip_suffix(')').unwrap_or(rest);
    // An ICC colour stands behind the one for screens.
    if let Some((screen, "icc-color")) = name.trim_end().rsplit_once([' ', ',']) {
        return colour(screen.trim_end_matches([' ', ',']));
    }
    if name == "light-dark" {
        return colour(arguments.split(',').next()?.trim());
    }
    let (parts, alpha) =
        arguments.split_once('/').map_or((arguments, None), |(parts, alpha)| (parts, Some(alpha)));
    let mut words = parts.split([' ', ',', '\t', '\n']).filter(|word| !word.is_empty());
    let space = if name == "color" { words.next()? } else { "" };
    let words: Vec<&str> = words.collect();
    let number = |index: usize, whole: f64| number(words.get(index).copied()?, whole);
    let alpha = alpha.map_or(Some(1.0), |alpha| self::number(alpha.trim(), 1.0))?;
    let hue = |index: usize| angle(words.get(index).copied()?);
    let polar = |chroma: f64, hue: f64| {
        let (sin, cos) = libm::sincos(hue.to_radians());
        (chroma * cos, chroma * sin)
    };
    let [red, green, blue] = match name {
        "oklab" => from_oklab(number(0, 1.0)?, number(1, 0.4)?, number(2, 0.4)?),
        "oklch" => {
            let (a, b) = polar(number(1, 0.4)?, hue(2)?);
            from_oklab(number(0, 1.0)?, a, b)
        }
        "lab" => from_lab(number(0, 100.0)?, number(1, 125.0)?, number(2, 125.0)?),
        "lch" => {
            let (a, b) = polar(number(1, 150.0)?, hue(2)?);
            from_lab(number(0, 100.0)?, a, b)
        }
        "device-cmyk" | "cmyk" => {
            let black = 1.0 - number(3, 1.0)?;
            [0, 1, 2]
                .map(|ink| number(ink, 1.0).map(|ink| (1.0 - ink) * black))
                .into_iter()
                .collect::<Option<Vec<f64>>>()?
                .try_into()
                .ok()?
        }
        "color" => {
            let parts = [number(0, 1.0)?, number(1, 1.0)?, number(2, 1.0)?];
            // Wider spaces are cut to what screens show; a pen has no finer colours.
            if space.contains("linear") {
                parts.map(gamma)
            } else if space.starts_with("xyz") {
                from_xyz(parts)
            } else {
                parts
            }
        }
        _ => return None,
    };
    Some([red, green, blue, alpha])
}

/// A number, or a percentage of `whole`; `none` is 0.
fn number(word: &str, whole: f64) -> Option<f64> {
    let number = match word.strip_suffix('%') {
        Some(share) => share.parse::<f64>().ok()? / 100.0 * whole,
        None if word == "none" => 0.0,
        None => word.parse().ok()?,
    };
    number.is_finite().then_some(number)
}

/// An angle, degrees.
fn angle(word: &str) -> Option<f64> {
    if word == "none" { Some(0.0) } else { super::css_transform::angle_deg(word) }
}

/// The curve of sRGB (IEC 61966-2-1).
fn gamma(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 }
}

/// CSS Color Level 4, section 9.2, after B. Ottosson, "A perceptual color space for image processing" (2020).
fn from_oklab(lightness: f64, a: f64, b: f64) -> [f64; 3] {
    let cubed = |root: f64| root * root * root;
    let l = cubed(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let m = cubed(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let s = cubed(lightness - 0.089_484_177_5 * a - 1.291_485_548 * b);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701 * s,
    ]
    .map(gamma)
}

/// CSS Color Level 4, section 9.1: CIE Lab under D50, brought to D65 by Bradford's matrix.
fn from_lab(lightness: f64, a: f64, b: f64) -> [f64; 3] {
    let fy = (lightness + 16.0) / 116.0;
    let back = |f: f64| {
        if f > 6.0 / 29.0 { f * f * f } else { 3.0 * (6.0 / 29.0) * (6.0 / 29.0) * (f - 4.0 / 29.0) }
    };
    let (x, y, z) = (0.964_22 * back(fy + a / 500.0), back(fy), 0.825_21 * back(fy - b / 200.0));
    from_xyz([
        0.955_576_6 * x - 0.023_039_3 * y + 0.063_163_6 * z,
        -0.028_289_5 * x + 1.009_941_6 * y + 0.021_007_7 * z,
        0.012_298_2 * x - 0.020_483 * y + 1.329_909_8 * z,
    ])
}

/// From CIE XYZ under D65 (IEC 61966-2-1).
fn from_xyz([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ]
    .map(gamma)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn so(value: &str) -> String {
        match known(value, "stroke") {
            Known::So(new) => new,
            Known::AsItIs => "as it is".to_owned(),
            Known::Black => "black".to_owned(),
        }
    }

    #[test]
    fn each_kind_of_paint_is_ink_unless_it_is_none() {
        let rows = [
            ("none", "as it is"),
            ("NONE", "none"),
            ("currentcolor", "currentColor"),
            ("CURRENTCOLOR !important", "currentColor!important"),
            ("red", "as it is"),
            ("#12ab", "as it is"),
            ("initial", "none"),
            ("unset", "inherit"),
            ("#CD853F icc-color(acmecmyk, 0.11, 0.48, 0.83, 0.00)", "rgba(205,133,63,1)"),
            ("device-cmyk(0 1 1 0)", "rgba(255,0,0,1)"),
            // From the examples of CSS Color Level 4, sections 7 to 9: all of them green, rgb(0, 128, 0).
            ("hwb(120deg 0% 49.8039% / 1)", "as it is"),
            ("lab(46.2775% -47.5621 48.5837)", "rgba(0,128,0,1)"),
            ("lch(46.2775% 67.9892 134.3912)", "rgba(0,128,0,1)"),
            ("oklab(51.975% -0.1403 0.10768)", "rgba(0,128,0,1)"),
            ("oklch(51.975% 0.17686 142.495)", "rgba(0,128,0,1)"),
            ("color(srgb 0 0.50196 0)", "rgba(0,128,0,1)"),
            ("color(xyz 0.07719 0.15438 0.02573)", "rgba(0,128,0,1)"),
            ("color(srgb-linear 0 0.21586 0)", "rgba(0,128,0,1)"),
            ("oklch(50% 0.1 20 / 0)", "none"),
            ("color-mix(in lab, red, blue)", "black"),
            ("CanvasText", "black"),
            ("url(#a)", "url(#a) black"),
            ("url(#a) none", "url(#a) none"),
            ("url('#a') oklab(0 0 0)", "url('#a') rgba(0,0,0,1)"),
            ("url(other.svg#a)", "black"),
        ];
        for (value, expected) in rows {
            assert_eq!(so(value), expected, "{value}");
        }
    }
}
