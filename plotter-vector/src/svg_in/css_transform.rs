//! [`as_svg`]: transforms of CSS, with units, as those of SVG.
//!
//! CSS Transforms Level 1 writes `translate(10px, 2mm) rotate(0.1turn)`; the parser knows numbers only, px
//! and degrees.

use std::str::FromStr;

/// What becomes of a transform.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Plain {
    /// The parser knows it as it stands.
    AsItIs,
    /// The same in numbers.
    So(String),
    /// It has no such form: why.
    Not(&'static str),
}

/// A matrix as SVG writes it: a, b, c, d, e, f.
pub(super) type Matrix = [f64; 6];

pub(super) const IDENTITY: Matrix = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];

/// A transform in words that the parser knows. `sheet` is the size that percentages are of, px; `px_per_inch`
/// that of mm and inches.
pub(super) fn as_svg(value: &str, sheet: (f64, f64), px_per_inch: f64) -> Plain {
    let (bare, important) = super::paint::without_important(value);
    if is_none(&bare.to_ascii_lowercase()) {
        return Plain::So(format!("scale(1){important}"));
    }
    if svgtypes::Transform::from_str(bare).is_ok() {
        return Plain::AsItIs;
    }
    match transform(bare, sheet, px_per_inch) {
        Ok(matrix) => Plain::So(format!("{}{important}", written(matrix))),
        Err(why) => Plain::Not(why),
    }
}

/// A matrix as SVG writes it.
pub(super) fn written(matrix: Matrix) -> String {
    let numbers: Vec<String> = matrix.iter().map(f64::to_string).collect();
    format!("matrix({})", numbers.join(" "))
}

/// Whether a value in small letters says nothing.
pub(super) fn is_none(lower: &str) -> bool {
    matches!(lower, "none" | "initial" | "unset" | "inherit" | "revert" | "revert-layer")
}

/// A list of functions, of CSS or of SVG.
pub(super) fn transform(value: &str, whole: (f64, f64), px_per_inch: f64) -> Result<Matrix, &'static str> {
    if let Ok(svgtypes::Transform { a, b, c, d, e, f }) = svgtypes::Transform::from_str(value) {
        return Ok([a, b, c, d, e, f]);
    }
    let lower = value.to_ascii_lowercase();
    let mut matrix = IDENTITY;
    let mut rest = if is_none(&lower) { "" } else { lower.as_str() };
    loop {
        rest = rest.trim_start_matches([' ', ',', '\t', '\r', '\n']);
        if rest.is_empty() {
            return Ok(matrix);
        }
        let Some((name, after)) = rest.split_once('(') else {
            return Err("it is no list of functions");
        };
        let Some((arguments, after)) = after.split_once(')') else {
            return Err("a bracket is not closed");
        };
        rest = after;
        let arguments: Vec<&str> =
            arguments.split([' ', ',', '\t', '\r', '\n']).filter(|word| !word.is_empty()).collect();
        matrix = times(matrix, function(name.trim(), &arguments, whole, px_per_inch)?);
    }
}

/// What the properties `translate`, `rotate` and `scale` hold: as the functions of their names (CSS
/// Transforms Level 2, section 5).
pub(super) fn property(
    name: &str,
    value: &str,
    whole: (f64, f64),
    px_per_inch: f64,
) -> Result<Matrix, &'static str> {
    let lower = value.to_ascii_lowercase();
    if is_none(&lower) {
        return Ok(IDENTITY);
    }
    let words: Vec<&str> = lower.split_ascii_whitespace().collect();
    match (name, &words[..]) {
        // About the axis that stands on the sheet, before or behind the angle.
        ("rotate", ["z", angle] | [angle, "z"]) => function("rotate", &[angle], whole, px_per_inch),
        ("rotate", [x, y, z, angle] | [angle, x, y, z]) if share(x).is_some() && share(z).is_some() => {
            match [x, y, z].map(|word| share(word)) {
                [Some(0.0), Some(0.0), Some(z)] if z > 0.0 => {
                    function("rotate", &[angle], whole, px_per_inch)
                }
                _ => Err("it leaves the plane"),
            }
        }
        ("rotate", ["x" | "y", _] | [_, "x" | "y"]) => Err("it leaves the plane"),
        ("translate" | "scale", [_, _, _]) => function(&format!("{name}3d"), &words, whole, px_per_inch),
        ("translate" | "scale" | "rotate", words) if !words.is_empty() => {
            function(name, words, whole, px_per_inch)
        }
        _ => Err("it is not known"),
    }
}

/// The place that a `transform-origin` names, from the corner of an area of this size.
pub(super) fn origin(value: &str, whole: (f64, f64), px_per_inch: f64) -> Result<(f64, f64), &'static str> {
    const WRONG: &str = "it is not understood";
    let lower = value.to_ascii_lowercase();
    if is_none(&lower) {
        return Ok((0.0, 0.0));
    }
    let words: Vec<&str> =
        lower.split([' ', ',', '\t', '\r', '\n']).filter(|word| !word.is_empty()).collect();
    let is_vertical = |word: &str| matches!(word, "top" | "bottom");
    let is_horizontal = |word: &str| matches!(word, "left" | "right");
    // A third says how high above the sheet, which moves nothing in it.
    let (x, y) = match words[..] {
        [y] if is_vertical(y) => ("center", y),
        [x] => (x, "center"),
        [y, x] | [y, x, _] if is_vertical(y) || is_horizontal(x) => (x, y),
        [x, y] | [x, y, _] => (x, y),
        _ => return Err(WRONG),
    };
    let along = |word: &str, whole: f64, [start, end]: [&str; 2]| match word {
        "center" => Some(whole / 2.0),
        word if word == start => Some(0.0),
        word if word == end => Some(whole),
        word => length_px(word, whole, px_per_inch),
    };
    let (x, y) = (along(x, whole.0, ["left", "right"]), along(y, whole.1, ["top", "bottom"]));
    x.zip(y).ok_or(WRONG)
}

pub(super) fn times([a, b, c, d, e, f]: Matrix, [g, h, i, j, k, l]: Matrix) -> Matrix {
    [a * g + c * h, b * g + d * h, a * i + c * j, b * i + d * j, a * k + c * l + e, b * k + d * l + f]
}

fn function(
    name: &str,
    arguments: &[&str],
    (width, height): (f64, f64),
    px_per_inch: f64,
) -> Result<Matrix, &'static str> {
    const NUMBER: &str = "a number or a unit in it is not understood";
    let most = |count: usize| if arguments.len() <= count { Ok(()) } else { Err("it has too many numbers") };
    let word = |index: usize| arguments.get(index).copied();
    let length = |index: usize, whole: f64| {
        word(index).map_or(Ok(0.0), |word| length_px(word, whole, px_per_inch).ok_or(NUMBER))
    };
    let angle =
        |index: usize| word(index).map_or(Ok(0.0), |word| angle_deg(word).map(f64::to_radians).ok_or(NUMBER));
    let number = |index: usize| word(index).and_then(share).ok_or(NUMBER);
    let flat = |index: usize, value: f64| match word(index) {
        Some(word) if (share(word) != Some(value)) && length_px(word, 0.0, px_per_inch) != Some(value) => {
            Err("it leaves the plane")
        }
        _ => Ok(()),
    };
    Ok(match name {
        "translate" => {
            most(2)?;
            [1.0, 0.0, 0.0, 1.0, length(0, width)?, length(1, height)?]
        }
        "translate3d" => {
            flat(2, 0.0)?;
            [1.0, 0.0, 0.0, 1.0, length(0, width)?, length(1, height)?]
        }
        "translatex" => [1.0, 0.0, 0.0, 1.0, length(0, width)?, 0.0],
        "translatey" => [1.0, 0.0, 0.0, 1.0, 0.0, length(0, height)?],
        "translatez" => IDENTITY,
        "scale" | "scale3d" => {
            if name == "scale3d" {
                flat(2, 1.0)?;
            } else {
                most(2)?;
            }
            let x = number(0)?;
            [x, 0.0, 0.0, if arguments.len() > 1 { number(1)? } else { x }, 0.0, 0.0]
        }
        "scalex" => [number(0)?, 0.0, 0.0, 1.0, 0.0, 0.0],
        "scaley" => [1.0, 0.0, 0.0, number(0)?, 0.0, 0.0],
        "scalez" => IDENTITY,
        "rotate" | "rotatez" => {
            let (sin, cos) = libm::sincos(angle(0)?);
            let turned = [cos, sin, -sin, cos, 0.0, 0.0];
            if arguments.len() == 3 {
                // As SVG has it: about a place.
                let (x, y) = (length(1, width)?, length(2, height)?);
                times(times([1.0, 0.0, 0.0, 1.0, x, y], turned), [1.0, 0.0, 0.0, 1.0, -x, -y])
            } else {
                most(1)?;
                turned
            }
        }
        "skew" => [1.0, libm::tan(angle(1)?), libm::tan(angle(0)?), 1.0, 0.0, 0.0],
        "skewx" => [1.0, 0.0, libm::tan(angle(0)?), 1.0, 0.0, 0.0],
        "skewy" => [1.0, libm::tan(angle(0)?), 0.0, 1.0, 0.0, 0.0],
        "matrix" => {
            most(6)?;
            [number(0)?, number(1)?, number(2)?, number(3)?, length(4, width)?, length(5, height)?]
        }
        "matrix3d" | "rotatex" | "rotatey" | "rotate3d" | "perspective" => return Err("it leaves the plane"),
        _ => return Err("a function in it is not known"),
    })
}

/// A number, or a percentage as one.
fn share(word: &str) -> Option<f64> {
    let number = match word.strip_suffix('%') {
        Some(percent) => percent.parse::<f64>().ok()? / 100.0,
        None => word.parse().ok()?,
    };
    number.is_finite().then_some(number)
}

/// A length, px.
pub(super) fn length_px(word: &str, whole: f64, px_per_inch: f64) -> Option<f64> {
    let split = word.find(|letter: char| letter == '%' || letter.is_ascii_alphabetic() && letter != 'e');
    let (number, unit) = word.split_at(split.unwrap_or(word.len()));
    let px = match unit {
        "" | "px" => 1.0,
        "mm" => px_per_inch / 25.4,
        "cm" => px_per_inch / 2.54,
        "q" => px_per_inch / 101.6,
        "in" => px_per_inch,
        "pt" => px_per_inch / 72.0,
        "pc" => px_per_inch / 6.0,
        "%" => whole / 100.0,
        _ => return None,
    };
    let length = number.parse::<f64>().ok()? * px;
    length.is_finite().then_some(length)
}

/// An angle, degrees.
pub(super) fn angle_deg(word: &str) -> Option<f64> {
    // The longer names end as shorter ones do.
    const UNITS: [(&str, f64); 4] =
        [("deg", 1.0), ("grad", 0.9), ("rad", 180.0 / core::f64::consts::PI), ("turn", 360.0)];
    let unit = UNITS.iter().find_map(|(unit, deg)| Some((word.strip_suffix(unit)?, *deg)));
    let (number, deg) = unit.unwrap_or((word, 1.0));
    let angle = number.parse::<f64>().ok()? * deg;
    angle.is_finite().then_some(angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_function_of_the_plane_has_a_form_in_svg() {
        let rows = [
            ("translate(10px,70px)", "matrix(1 0 0 1 10 70)"),
            ("translate(1in)", "matrix(1 0 0 1 96 0)"),
            ("translateX(25.4mm) translateY(-1pc)", "matrix(1 0 0 1 96 -16)"),
            ("translate(50%, 10%)", "matrix(1 0 0 1 100 10)"),
            ("TRANSLATE(1PX)", "matrix(1 0 0 1 1 0)"),
            ("translate3d(1px, 2px, 0)", "matrix(1 0 0 1 1 2)"),
            ("scale(50%)", "matrix(0.5 0 0 0.5 0 0)"),
            ("scaleX(2) scaleY(3)", "matrix(2 0 0 3 0 0)"),
            ("none", "scale(1)"),
            ("translate(1px) !important", "matrix(1 0 0 1 1 0)!important"),
        ];
        for (css, svg) in rows {
            assert_eq!(as_svg(css, (200.0, 100.0), 96.0), Plain::So(svg.to_owned()), "{css}");
        }
        for same in ["translate(10 70)", "rotate(5)", "matrix(1 0 0 1 2 3)"] {
            assert_eq!(as_svg(same, (200.0, 100.0), 96.0), Plain::AsItIs, "{same}");
        }
        for not in ["rotateX(3deg)", "translate(1em)", "scale3d(1,1,2)", "translate(1px", "spin(3)", "nan"] {
            assert!(matches!(as_svg(not, (200.0, 100.0), 96.0), Plain::Not(_)), "{not}");
        }
    }

    #[test]
    fn properties_are_as_the_functions_of_their_names() {
        let rows = [
            ("translate", "10px", "matrix(1 0 0 1 10 0)"),
            ("translate", "50% 10%", "matrix(1 0 0 1 100 10)"),
            ("translate", "1px 2px 0", "matrix(1 0 0 1 1 2)"),
            ("scale", "2", "matrix(2 0 0 2 0 0)"),
            ("scale", "2 50%", "matrix(2 0 0 0.5 0 0)"),
            ("scale", "-1 1 1", "matrix(-1 0 0 1 0 0)"),
            ("rotate", "none", "matrix(1 0 0 1 0 0)"),
            ("rotate", "0deg", "matrix(1 0 -0 1 0 0)"),
            ("rotate", "z 0turn", "matrix(1 0 -0 1 0 0)"),
            ("rotate", "0 0 1 0rad", "matrix(1 0 -0 1 0 0)"),
        ];
        for (name, value, expected) in rows {
            let found = property(name, value, (200.0, 100.0), 96.0).map(written);
            assert_eq!(found.as_deref(), Ok(expected), "{name}: {value}");
        }
        for (name, value) in [
            ("rotate", "x 3deg"),
            ("rotate", "1 0 0 3deg"),
            ("scale", "1 1 2"),
            ("scale", "big"),
            ("rotate", ""),
        ] {
            assert!(property(name, value, (200.0, 100.0), 96.0).is_err(), "{name}: {value}");
        }
    }

    #[test]
    fn an_origin_is_named_by_words_lengths_and_shares() {
        let rows = [
            ("center", (100.0, 50.0)),
            ("left", (0.0, 50.0)),
            ("bottom", (100.0, 100.0)),
            ("top right", (200.0, 0.0)),
            ("right top", (200.0, 0.0)),
            ("25% 75%", (50.0, 75.0)),
            ("10px", (10.0, 50.0)),
            ("1in 0 5px", (96.0, 0.0)),
            ("center 10px", (100.0, 10.0)),
            ("-10px bottom", (-10.0, 100.0)),
        ];
        for (value, expected) in rows {
            assert_eq!(origin(value, (200.0, 100.0), 96.0), Ok(expected), "{value}");
        }
        for wrong in ["", "middle", "left right", "1em 2px", "1 2 3 4"] {
            assert!(origin(wrong, (200.0, 100.0), 96.0).is_err(), "{wrong}");
        }
    }

    #[test]
    fn angles_have_four_units() {
        for word in ["90deg", "100grad", "0.25turn", "1.5707963267948966rad", "90"] {
            assert!((angle_deg(word).unwrap() - 90.0).abs() < 1e-12, "{word}");
        }
    }
}
