//! [`as_svg`]: transforms of CSS, with units, as those of SVG.
//!
//! CSS Transforms Level 1 writes `translate(10px, 2mm) rotate(0.1turn)`; the parser knows numbers only, px and degrees.

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
type Matrix = [f64; 6];

const IDENTITY: Matrix = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];

/// A transform in words that the parser knows. `sheet` is the size that percentages are of, px; `px_per_inch` that of mm and inches.
pub(super) fn as_svg(value: &str, sheet: (f64, f64), px_per_inch: f64) -> Plain {
    let (bare, important) = super::paint::without_important(value);
    let lower = bare.to_ascii_lowercase();
    if matches!(lower.as_str(), "none" | "initial" | "unset" | "revert" | "revert-layer") {
        return Plain::So(format!("scale(1){important}"));
    }
    if svgtypes::Transform::from_str(bare).is_ok() {
        return Plain::AsItIs;
    }
    let mut matrix = IDENTITY;
    let mut rest = lower.as_str();
    loop {
        rest = rest.trim_start_matches([' ', ',', '\t', '\r', '\n']);
        if rest.is_empty() {
            break;
        }
        let Some((name, after)) = rest.split_once('(') else {
            return Plain::Not("it is no list of functions");
        };
        let Some((arguments, after)) = after.split_once(')') else {
            return Plain::Not("a bracket is not closed");
        };
        rest = after;
        let arguments: Vec<&str> =
            arguments.split([' ', ',', '\t', '\r', '\n']).filter(|word| !word.is_empty()).collect();
        match function(name.trim(), &arguments, sheet, px_per_inch) {
            Ok(next) => matrix = times(matrix, next),
            Err(why) => return Plain::Not(why),
        }
    }
    let numbers: Vec<String> = matrix.iter().map(f64::to_string).collect();
    Plain::So(format!("matrix({}){important}", numbers.join(" ")))
}

fn times([a, b, c, d, e, f]: Matrix, [g, h, i, j, k, l]: Matrix) -> Matrix {
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
fn length_px(word: &str, whole: f64, px_per_inch: f64) -> Option<f64> {
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
    fn angles_have_four_units() {
        for word in ["90deg", "100grad", "0.25turn", "1.5707963267948966rad", "90"] {
            assert!((angle_deg(word).unwrap() - 90.0).abs() < 1e-12, "{word}");
        }
    }
}
