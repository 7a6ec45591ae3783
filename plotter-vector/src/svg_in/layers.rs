//! [`SvgLayer`]: a layer of a drawing, and what its name asks for.

/// A layer: a group at the top of the file with an `id` or a label, or one that Inkscape calls a layer,
/// wherever it is.
///
/// Its name is Inkscape's label, else Illustrator's `data-name`, else the `id`. It may begin as those of the
/// `AxiDraw` do: `%` leaves the layer out, `!` asks for a pause before it, a number is its pen, and codes may
/// follow: `+D` with milliseconds of waiting before it, `+S` with a share of the speed and `+H` with a share
/// of the pen's height, both in percent.
///
/// ```
/// # use plotter_vector::svg_in::SvgLayer;
/// let layer = SvgLayer::of_name("!5+S50 +D300 contours");
/// assert_eq!((layer.number, layer.pauses, layer.is_left_out), (Some(5), true, false));
/// assert_eq!((layer.speed_percent, layer.delay_ms, layer.height_percent), (Some(50), Some(300), None));
/// assert!(SvgLayer::of_name("% notes").is_left_out);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SvgLayer {
    /// Name of the layer in the file, shortened to 64 bytes.
    pub name: String,
    /// The number that its name begins with, 1 to 255; also that of a name as `pen-3`.
    pub number: Option<u8>,
    /// Whether its name begins with `%`: it is not drawn.
    pub is_left_out: bool,
    /// Whether its name asks to pause before it.
    pub pauses: bool,
    /// Time to wait before it, ms.
    pub delay_ms: Option<u32>,
    /// Speed of the pen that draws, percent of the machine's.
    pub speed_percent: Option<u32>,
    /// Height of the pen that draws, percent of its way.
    pub height_percent: Option<u32>,
    /// Index of its first stroke in the drawing; `None` where it has none.
    pub first_stroke: Option<usize>,
}

impl SvgLayer {
    /// What a name asks for.
    #[must_use]
    pub fn of_name(name: &str) -> Self {
        let mut layer = Self { name: fitting(name), ..Self::default() };
        let mut rest = name.trim_start();
        if let Some(after) = rest.strip_prefix('%') {
            layer.is_left_out = true;
            rest = after.trim_start();
        }
        if let Some(after) = rest.strip_prefix('!') {
            layer.pauses = true;
            rest = after.trim_start();
        }
        rest = rest.strip_prefix("pen-").unwrap_or(rest);
        let (number, mut rest) = leading_number(rest);
        layer.number = number.and_then(|number| u8::try_from(number).ok()).filter(|number| *number > 0);
        while let Some(code) = rest.trim_start().strip_prefix('+') {
            let mut letters = code.chars();
            let Some(letter) = letters.next() else { break };
            let (Some(value), after) = leading_number(letters.as_str()) else { break };
            match letter.to_ascii_uppercase() {
                'D' => layer.delay_ms = Some(value),
                'S' => layer.speed_percent = Some(value),
                'H' => layer.height_percent = Some(value),
                _ => break,
            }
            rest = after;
        }
        layer
    }
}

/// The digits that a text begins with, as a number, and what follows them; no number where it is too large.
fn leading_number(text: &str) -> (Option<u32>, &str) {
    let end = text.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(text.len());
    let (digits, rest) = text.split_at(end);
    (digits.parse().ok(), rest)
}

/// A name that a pen may have: at most 64 bytes.
pub(super) fn fitting(name: &str) -> String {
    const MAX_NAME_BYTES: usize = 64;
    let mut fitting = String::new();
    for letter in name.chars().filter(|letter| !letter.is_control()) {
        if fitting.len() + letter.len_utf8() > MAX_NAME_BYTES {
            break;
        }
        fitting.push(letter);
    }
    fitting
}
