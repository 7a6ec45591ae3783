//! [`html_page`]: one self-contained HTML page with figures and pictures.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write as _;

/// A picture of the page.
#[derive(Clone, Copy, Debug)]
pub enum Figure<'a> {
    /// SVG text, with its caption.
    Svg(&'a str, &'a str),
    /// PNG bytes, with their caption.
    Png(&'a [u8], &'a str),
}

/// An HTML page that needs no other file: title, introduction, a table of (name, value) rows, and pictures in
/// two columns. Texts are escaped; SVG is taken as it is.
#[must_use]
pub fn html_page(
    title: &str,
    introduction: &str,
    table: &[(&str, String)],
    figures: &[Figure<'_>],
) -> String {
    let mut page = String::from("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n");
    let _ = writeln!(page, "<title>{}</title>", escaped(title));
    page.push_str(
        "<style>\n\
         body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; color: #222 }\n\
         table { border-collapse: collapse; margin: 1.5rem 0 } td { padding: .25rem 1.5rem .25rem 0; border-bottom: 1px solid #ddd }\n\
         td + td { font-variant-numeric: tabular-nums; text-align: right }\n\
         figure { margin: 2rem 0 } figure > svg, figure > img { width: 100%; height: auto; border: 1px solid #ddd; background: #fff }\n\
         figcaption { color: #555 }\n\
         .pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(24rem, 1fr)); gap: 1.5rem }\n\
         </style></head><body>\n",
    );
    let _ = writeln!(page, "<h1>{}</h1>\n<p>{}</p>\n<table>", escaped(title), escaped(introduction));
    for (name, value) in table {
        let _ = writeln!(page, "<tr><td>{}</td><td>{}</td></tr>", escaped(name), escaped(value));
    }
    page.push_str("</table>\n<div class=\"pair\">\n");
    for figure in figures {
        let (picture, caption) = match figure {
            Figure::Svg(svg, caption) => (inline_svg(svg).to_owned(), caption),
            Figure::Png(png, caption) => (
                format!(
                    "<img alt=\"{}\" src=\"data:image/png;base64,{}\">",
                    escaped(caption),
                    STANDARD.encode(png)
                ),
                caption,
            ),
        };
        let _ = writeln!(page, "<figure>{picture}<figcaption>{}</figcaption></figure>", escaped(caption));
    }
    page.push_str("</div>\n</body></html>\n");
    page
}

/// The part of an SVG file that may stand inside a page: everything from its `<svg`, without the XML
/// declaration.
fn inline_svg(svg: &str) -> &str {
    svg.find("<svg").map_or("", |start| svg.get(start..).unwrap_or_default())
}

/// A text with the characters that HTML reserves replaced.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_and_svg_loses_its_declaration() {
        let page = html_page(
            "a < b",
            "",
            &[("x & y", "1".into())],
            &[Figure::Svg("<?xml version=\"1.0\"?>\n<svg/>", "picture"), Figure::Png(&[1, 2, 3], "dots")],
        );
        assert!(page.contains("<h1>a &lt; b</h1>") && page.contains("x &amp; y"));
        assert!(page.contains("<figure><svg/>") && page.contains("base64,AQID") && !page.contains("<?xml"));
    }
}
