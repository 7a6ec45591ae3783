//! [`Rgb`]: a colour of 8 bits a channel, and [`Oklab`], where distances are those that an eye sees.

use core::fmt;
use core::str::FromStr;

/// A colour: red, green, blue, 0..=255 each, encoded as sRGB. Written and read as `#rrggbb`.
///
/// ```
/// # use plotter_vector::Rgb;
/// let blue: Rgb = "#1840c8".parse()?;
/// assert_eq!(blue, Rgb([24, 64, 200]));
/// assert_eq!(blue.to_string(), "#1840c8");
/// # Ok::<(), plotter_vector::picture::RgbError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Rgb(pub [u8; 3]);

/// A text that is no colour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbError {
    /// The text, cut off after 32 characters.
    pub text: String,
}

impl fmt::Display for RgbError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"{}\" is no colour: write `#` and six hexadecimal digits, as \"#d01818\"", self.text)
    }
}

impl core::error::Error for RgbError {}

impl fmt::Display for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self([red, green, blue]) = self;
        write!(f, "#{red:02x}{green:02x}{blue:02x}")
    }
}

impl FromStr for Rgb {
    type Err = RgbError;

    fn from_str(text: &str) -> Result<Self, RgbError> {
        let refused = || RgbError { text: text.chars().take(32).flat_map(char::escape_debug).collect() };
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6).ok_or_else(refused)?;
        if !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
            return Err(refused());
        }
        let number = u32::from_str_radix(digits, 16).map_err(|_| refused())?;
        let [_, red, green, blue] = number.to_be_bytes();
        Ok(Self([red, green, blue]))
    }
}

/// As a text, `"#1840c8"`.
#[cfg(feature = "serde")]
impl serde::Serialize for Rgb {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Rgb {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

impl Rgb {
    /// Black.
    pub const BLACK: Self = Self([0, 0, 0]);
    /// White.
    pub const WHITE: Self = Self([255, 255, 255]);

    /// The colour in [`Oklab`].
    #[must_use]
    pub fn oklab(self) -> Oklab {
        Oklab::from_linear(self.0.map(linear))
    }
}

/// The share of full light, 0..=1, of an encoded channel.
///
/// Source: IEC 61966-2-1 (sRGB), 5.2.
fn linear(channel: u8) -> f64 {
    let encoded = f64::from(channel) / 255.0;
    if encoded <= 0.04045 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
}

/// A colour as lightness `l` (0 black, 1 white), and `a` (green to red) and `b` (blue to yellow), both 0 for
/// greys.
///
/// Equal distances look about equally different; between two inks on paper they are 0.1 to 0.6.
///
/// Source: B. Ottosson, "A perceptual color space for image processing" (2020), the matrices from linear sRGB
/// to cone responses and from their cube roots to L, a, b.
///
/// ```
/// # use plotter_vector::Rgb;
/// let red = Rgb([255, 0, 0]).oklab();
/// assert!((red.l - 0.62796).abs() < 1e-5 && (red.a - 0.22486).abs() < 1e-5 && (red.b - 0.12585).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Oklab {
    /// Lightness.
    pub l: f64,
    /// From green (below 0) to red.
    pub a: f64,
    /// From blue (below 0) to yellow.
    pub b: f64,
}

impl Oklab {
    fn from_linear([red, green, blue]: [f64; 3]) -> Self {
        let long = libm::cbrt(0.412_221_470_8 * red + 0.536_332_536_3 * green + 0.051_445_992_9 * blue);
        let middle = libm::cbrt(0.211_903_498_2 * red + 0.680_699_545_1 * green + 0.107_396_956_6 * blue);
        let short = libm::cbrt(0.088_302_461_9 * red + 0.281_718_837_6 * green + 0.629_978_700_5 * blue);
        Self {
            l: 0.210_454_255_3 * long + 0.793_617_785_0 * middle - 0.004_072_046_8 * short,
            a: 1.977_998_495_1 * long - 2.428_592_205_0 * middle + 0.450_593_709_9 * short,
            b: 0.025_904_037_1 * long + 0.782_771_766_2 * middle - 0.808_675_766_0 * short,
        }
    }

    /// Straight distance.
    ///
    /// ```
    /// # use plotter_vector::Rgb;
    /// assert!((Rgb::WHITE.oklab().distance(Rgb::BLACK.oklab()) - 1.0).abs() < 1e-6);
    /// ```
    #[must_use]
    pub fn distance(self, other: Self) -> f64 {
        libm::sqrt(self.squared(other))
    }

    /// The square of the distance.
    pub(crate) fn squared(self, other: Self) -> f64 {
        let (l, a, b) = (self.l - other.l, self.a - other.a, self.b - other.b);
        l * l + a * a + b * b
    }

    /// The place `share` of the way from here to `to`.
    pub(crate) fn towards(self, to: Self, share: f64) -> Self {
        Self {
            l: self.l + (to.l - self.l) * share,
            a: self.a + (to.a - self.a) * share,
            b: self.b + (to.b - self.b) * share,
        }
    }
}

/// [`Rgb::oklab`] for many colours: the powers are taken once.
#[derive(Clone, Debug)]
pub(crate) struct OklabTable([f64; 256]);

impl OklabTable {
    pub(crate) fn new() -> Self {
        let mut table = [0.0; 256];
        for (slot, channel) in table.iter_mut().zip(0..=u8::MAX) {
            *slot = linear(channel);
        }
        Self(table)
    }

    /// As [`Rgb::oklab`], to the last bit.
    pub(crate) fn oklab(&self, Rgb(channels): Rgb) -> Oklab {
        Oklab::from_linear(channels.map(|channel| self.0.get(usize::from(channel)).copied().unwrap_or(1.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published values have five decimals.
    const PUBLISHED: f64 = 1e-5;

    #[test]
    fn known_colours_have_their_published_values() {
        let known = [
            ([255, 255, 255], (1.0, 0.0, 0.0)),
            ([255, 0, 0], (0.62796, 0.22486, 0.12585)),
            ([0, 255, 0], (0.86644, -0.23389, 0.17950)),
            ([0, 0, 255], (0.45201, -0.03246, -0.31153)),
            ([0, 0, 0], (0.0, 0.0, 0.0)),
        ];
        for (rgb, (l, a, b)) in known {
            let found = Rgb(rgb).oklab();
            assert!(found.distance(Oklab { l, a, b }) < 2.0 * PUBLISHED, "{rgb:?}: {found:?}");
        }
    }

    #[test]
    fn greys_have_no_colour() {
        for level in 0..=255 {
            let grey = Rgb([level; 3]).oklab();
            assert!(libm::hypot(grey.a, grey.b) < 1e-6, "{level}: {grey:?}");
        }
    }

    #[test]
    fn the_table_gives_the_same_bits() {
        let table = OklabTable::new();
        for rgb in [[0, 0, 0], [1, 2, 3], [208, 24, 24], [255, 254, 10]].map(Rgb) {
            assert_eq!(table.oklab(rgb), rgb.oklab());
        }
    }

    #[test]
    fn a_text_that_is_no_colour_is_named() {
        for bad in ["", "d01818", "#d0181", "#d018181", "#+01818", "#d0181g", "#ä0018"] {
            let error = bad.parse::<Rgb>().unwrap_err();
            assert!(error.to_string().starts_with(&format!("\"{bad}\" is no colour")), "{error}");
        }
    }
}
