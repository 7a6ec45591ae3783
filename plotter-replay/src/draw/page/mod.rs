//! Pages for a browser: a recording to look at, and a machine to watch.
//!
//! A page is one file: style, program and data are in it, and it asks nothing of any network. `assets/` holds
//! what does not change; [`document`] puts it together.

mod desired;
mod envelope;
mod few;
mod ink_map;
mod numbers;
mod recording;
mod silence;
mod spread;
mod trail;

#[cfg(feature = "live")]
pub(crate) use desired::Desired;
pub(crate) use numbers::{along, signed, steps};
pub use recording::{PageSettings, RecordingPage};
pub(crate) use spread::pulse_times;
#[cfg(feature = "live")]
pub(crate) use trail::{DRAWN, Trail, TrailPoint, pen_bits};

const STYLE: &str = include_str!("assets/style.css");
const COMMON: &str = include_str!("assets/common.js");

/// One page: `body` and `program` of its own, and `data` for the program, which is JSON.
///
/// A browser is told to load nothing from anywhere, and to connect to nothing but `connect`.
pub(crate) fn document(title: &str, body: &str, program: &str, data: &str, connect: &str) -> String {
    let title = escape(title);
    // In a script element nothing but its end, and what looks like a comment, needs care: JSON may write `<`
    // otherwise.
    let data = data.replace('<', "\\u003c");
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; \
         script-src 'unsafe-inline'; img-src data:; connect-src {connect}\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <link rel=\"icon\" href=\"data:,\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}\
         <script type=\"application/json\" id=\"data\">{data}</script>\n\
         <script>\n\"use strict\";\n{COMMON}{program}</script>\n</body>\n</html>\n"
    )
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_the_data_ends_the_script() {
        let page = document("a <b> & \"c\"", "", "", "{\"text\":\"</script><!--\"}", "'none'");
        assert_eq!(page.matches("</script>").count(), 2);
        assert!(page.contains("<title>a &lt;b&gt; &amp; &quot;c&quot;</title>"));
        assert!(page.contains("\\u003c/script>\\u003c!--"));
    }
}
