//! [`error_chart`]: the distribution of the errors as a bar chart.

use crate::report::ErrorReport;
use crate::write::svg::Short;
use core::fmt::{self, Write};

/// The sheet and the field of the bars in it, px of the chart.
const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 400.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 70.0;
const BOTTOM: f64 = 60.0;

/// Most marks with a number on the lower axis.
const MAX_MARKS: usize = 9;

/// Writes the distribution of the errors as an SVG bar chart: percent of the pixels over the error in px,
/// with mean, maximum and standard deviation above.
///
/// `notes` are further lines of text under them, such as published figures to compare with.
///
/// # Errors
/// Those of the writer.
pub fn error_chart(report: &ErrorReport, title: &str, notes: &[&str], out: &mut impl Write) -> fmt::Result {
    let field_width = WIDTH - LEFT - RIGHT;
    let height = HEIGHT + 18.0 * notes.iter().map(|_| 1.0).sum::<f64>();
    let field_height = HEIGHT - TOP - BOTTOM;
    let top = height - BOTTOM - field_height;
    let bottom = height - BOTTOM;
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
         font-family=\"sans-serif\" font-size=\"13\" fill=\"#222\">\n<rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>",
        w = Short(WIDTH),
        h = Short(height)
    )?;
    let middle = Short(LEFT + field_width / 2.0);
    writeln!(
        out,
        "<text x=\"{middle}\" y=\"24\" text-anchor=\"middle\" font-size=\"16\">{}</text>",
        Escaped(title)
    )?;
    let mut y = 46.0;
    let figures = format!(
        "mean {:.4} px, maximum {:.4} px, standard deviation {:.4} px, {} pixels",
        report.mean_px, report.max_px, report.sd_px, report.pixels
    );
    for line in core::iter::once(figures.as_str()).chain(notes.iter().copied()) {
        writeln!(
            out,
            "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            Short(y),
            Escaped(line)
        )?;
        y += 18.0;
    }
    // Percent upwards: from 0 to 100 in steps of 20, so that charts can be compared.
    for percent in [0.0, 20.0, 40.0, 60.0, 80.0, 100.0] {
        let y = bottom - field_height * percent / 100.0;
        writeln!(
            out,
            "<path d=\"M{} {y}H{}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{}\" text-anchor=\"end\">{percent}</text>",
            Short(LEFT),
            Short(WIDTH - RIGHT),
            Short(LEFT - 8.0),
            Short(y + 4.0),
            y = Short(y)
        )?;
    }
    bars(report, field_width, field_height, bottom, out)?;
    writeln!(
        out,
        "<path d=\"M{l} {t}V{b}H{r}\" fill=\"none\" stroke=\"#222\"/>",
        l = Short(LEFT),
        t = Short(top),
        b = Short(bottom),
        r = Short(WIDTH - RIGHT)
    )?;
    writeln!(
        out,
        "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">distance of a pixel from its segment, px</text>",
        Short(bottom + 44.0)
    )?;
    let centre = Short(f64::midpoint(top, bottom));
    writeln!(
        out,
        "<text transform=\"translate(20 {centre}) rotate(-90)\" text-anchor=\"middle\">share of the pixels, percent</text>"
    )?;
    out.write_str("</svg>\n")
}

fn bars(report: &ErrorReport, width: f64, height: f64, bottom: f64, out: &mut impl Write) -> fmt::Result {
    let span_px = report.histogram.last().map_or(1.0, |bin| bin.to_px);
    let x = |error_px: f64| LEFT + width * error_px / span_px;
    let every = report.histogram.len().div_ceil(MAX_MARKS).max(1);
    for (index, bin) in report.histogram.iter().enumerate() {
        let (from, to) = (x(bin.from_px), x(bin.to_px));
        let tall = height * bin.percent / 100.0;
        writeln!(
            out,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#4477aa\"/>",
            Short(from + 0.5),
            Short(bottom - tall),
            Short((to - from - 1.0).max(0.5)),
            Short(tall)
        )?;
        if index.is_multiple_of(every) {
            mark(from, bin.from_px, bottom, out)?;
        }
        if bin.percent >= 0.05 && to - from > 34.0 {
            writeln!(
                out,
                "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" font-size=\"11\">{:.1}</text>",
                Short(f64::midpoint(from, to)),
                Short(bottom - tall - 4.0),
                bin.percent
            )?;
        }
    }
    if report.histogram.len().is_multiple_of(every) {
        mark(x(span_px), span_px, bottom, out)?;
    }
    Ok(())
}

fn mark(x: f64, error_px: f64, bottom: f64, out: &mut impl Write) -> fmt::Result {
    let (x, error_px) = (Short(x), Short(error_px));
    writeln!(
        out,
        "<path d=\"M{x} {}v5\" stroke=\"#222\"/><text x=\"{x}\" y=\"{}\" text-anchor=\"middle\">{error_px}</text>",
        Short(bottom),
        Short(bottom + 20.0)
    )
}

/// Text with the characters escaped that mean something in XML.
struct Escaped<'a>(&'a str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in self.0.chars() {
            match character {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                other => f.write_char(other)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Bin;

    #[test]
    fn the_chart_names_its_axes_and_escapes_its_title() {
        let bar = |from_px, percent| Bin { from_px, to_px: from_px + 0.125, pixels: 1, percent };
        let histogram = vec![bar(0.0, 75.0), bar(0.125, 25.0)];
        let report = ErrorReport { pixels: 4, mean_px: 0.05, max_px: 0.2, sd_px: 0.08, histogram };
        let mut text = String::new();
        error_chart(&report, "A & B <1 px", &["published: mean 0.0991 px"], &mut text).unwrap();
        insta::assert_snapshot!(text);
    }

    #[test]
    fn a_report_of_nothing_is_an_empty_chart() {
        let mut text = String::new();
        error_chart(&ErrorReport::default(), "nothing", &[], &mut text).unwrap();
        assert!(!text.contains("NaN") && text.ends_with("</svg>\n"));
    }
}
