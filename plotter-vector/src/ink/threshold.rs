//! [`Threshold`]: which pixels are ink.
//!
//! A scan is dark lines on light paper, or light lines on a dark ground (a blueprint, a photograph's
//! negative). A level splits the 256 grey levels in two, one for the whole sheet or, in uneven light, another
//! in each place; the *searched colour* is the one that covers less, for lines are always the minority.

use crate::parallel::each;
use crate::{
    ink::{Evened, Look, RowThreshold, Survey},
    picture::{Bitmap, Gray, Histogram, histogram::otsu},
};
use core::{fmt, str};

/// Which side of the level is ink.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Polarity {
    /// The side that covers fewer pixels; dark when both cover the same. In uneven light the side of the
    /// local median on which more pixels lie.
    #[default]
    Minority,
    /// Dark lines on light paper.
    DarkInk,
    /// Light lines on a dark ground.
    LightInk,
}

/// Where the level comes from. In text, and with the feature `serde`, `auto`, `otsu`, `adaptive`, or the
/// number of a level.
///
/// ```
/// # use plotter_vector::ThresholdMethod;
/// assert_eq!("adaptive".parse(), Ok(ThresholdMethod::Adaptive));
/// assert_eq!("128".parse(), Ok(ThresholdMethod::Level(128)));
/// assert_eq!(
///     "256".parse::<ThresholdMethod>().unwrap_err().to_string(),
///     "threshold: 256 is neither auto, otsu, adaptive nor a level from 0 to 255"
/// );
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ThresholdMethod {
    /// [`ThresholdMethod::Otsu`] where one level tells ink from paper all over the picture. Else, as in a
    /// photograph, of pencil, of faint lines or on ruled paper, the picture is evened first: the paper is
    /// measured around each place, ink is half as dark as the darkest there and stands out of the noise, and
    /// what is much paler than the lines, or a speck, is left out. [`Look`](crate::ink::Look) tells what was
    /// found. Pictures of more than 64 megapixels get [`ThresholdMethod::Adaptive`] instead.
    #[default]
    Auto,
    /// One level for the whole sheet, [`Histogram::otsu`](crate::picture::Histogram::otsu).
    Otsu,
    /// For uneven light, such as a photographed sheet: each level is divided by that of the paper in the same
    /// place, and Otsu's level taken there. Where the paper's level comes from is measured in tiles of
    /// [`Threshold::window_px`].
    ///
    /// Ink may fill an area up to two tiles wide; a larger one comes out hollow, for it is taken as paper in
    /// a shadow. A shadow narrower than two tiles is taken as ink when it is as dark.
    ///
    /// Source: S. Lu, B. Su, C. L. Tan, "Document image binarization using background estimation and stroke
    /// edges" (2010), section 3.1.
    Adaptive,
    /// Levels up to this one are dark.
    Level(u8),
}

/// A text that names no [`ThresholdMethod`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ThresholdMethodError {
    /// What was given.
    pub text: String,
}

impl fmt::Display for ThresholdMethodError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "threshold: {} is neither auto, otsu, adaptive nor a level from 0 to 255", self.text)
    }
}

impl core::error::Error for ThresholdMethodError {}

impl fmt::Display for ThresholdMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Otsu => f.write_str("otsu"),
            Self::Adaptive => f.write_str("adaptive"),
            Self::Level(level) => level.fmt(f),
        }
    }
}

impl str::FromStr for ThresholdMethod {
    type Err = ThresholdMethodError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "auto" => Ok(Self::Auto),
            "otsu" => Ok(Self::Otsu),
            "adaptive" => Ok(Self::Adaptive),
            _ => text.parse().map(Self::Level).map_err(|_| ThresholdMethodError { text: text.to_owned() }),
        }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for ThresholdMethod {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Level(level) => serializer.serialize_u8(*level),
            named => serializer.collect_str(named),
        }
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for ThresholdMethod {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Method;
        impl serde::de::Visitor<'_> for Method {
            type Value = ThresholdMethod;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("auto, otsu, adaptive or a level from 0 to 255")
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Self::Value, E> {
                text.parse().map_err(E::custom)
            }

            fn visit_u64<E: serde::de::Error>(self, level: u64) -> Result<Self::Value, E> {
                u8::try_from(level)
                    .map(ThresholdMethod::Level)
                    .map_err(|_| E::custom(ThresholdMethodError { text: level.to_string() }))
            }

            fn visit_i64<E: serde::de::Error>(self, level: i64) -> Result<Self::Value, E> {
                u8::try_from(level)
                    .map(ThresholdMethod::Level)
                    .map_err(|_| E::custom(ThresholdMethodError { text: level.to_string() }))
            }
        }
        deserializer.deserialize_any(Method)
    }
}

/// How ink is told from paper. The default finds everything from the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct Threshold {
    /// Which side of the level is ink.
    pub polarity: Polarity,
    /// Where the level comes from.
    pub method: ThresholdMethod,
    /// Side of the tiles in which [`ThresholdMethod::Adaptive`] measures the paper, px, 8 to 1024. Larger
    /// than the lines are wide, and smaller than the edge of a shadow is soft.
    pub window_px: u32,
    /// Least distance between the mean dark and the mean light level, in levels: below it the picture is an
    /// empty sheet with noise, and nothing is ink. Not asked when the level is given. In uneven light ink is
    /// at least half as far from the paper, too.
    pub min_contrast: u8,
    /// Whether [`ThresholdMethod::Auto`] takes what is much paler than the lines for ink, too: the ruling of
    /// paper, and what shines through it.
    pub keep_pale: bool,
}

impl Threshold {
    /// The same with another [`Threshold::polarity`].
    #[must_use]
    pub const fn with_polarity(self, polarity: Polarity) -> Self {
        Self { polarity, ..self }
    }

    /// The same with another [`Threshold::method`].
    #[must_use]
    pub const fn with_method(self, method: ThresholdMethod) -> Self {
        Self { method, ..self }
    }

    /// The same with another [`Threshold::window_px`].
    #[must_use]
    pub const fn with_window_px(self, window_px: u32) -> Self {
        Self { window_px, ..self }
    }

    /// The same with another [`Threshold::min_contrast`].
    #[must_use]
    pub const fn with_min_contrast(self, min_contrast: u8) -> Self {
        Self { min_contrast, ..self }
    }

    /// The same with another [`Threshold::keep_pale`].
    #[must_use]
    pub const fn with_keep_pale(self, keep_pale: bool) -> Self {
        Self { keep_pale, ..self }
    }
}

impl Default for Threshold {
    /// The method by itself; 24 levels of contrast, a hard pencil's faintest line, where a scanner's noise
    /// has 2 to 8. Tiles of 32 px: 1.4 mm at 600 dots per inch, wide enough for lines of 1 mm, for half of a
    /// tile may be ink, and the tiles around serve where it is more.
    fn default() -> Self {
        Self {
            polarity: Polarity::Minority,
            method: ThresholdMethod::Auto,
            window_px: 32,
            min_contrast: 24,
            keep_pale: false,
        }
    }
}

/// What was decided about a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Split {
    /// Levels up to this one are dark; in uneven light, as it were in a place where the light is full: paper
    /// white, or the dark ground black.
    pub level: u8,
    /// Whether the dark side is ink.
    pub ink_is_dark: bool,
    /// Whether there are more than two levels: then the rims of lines tell where these lie to a fraction of a
    /// pixel.
    pub has_greys: bool,
    /// Number of ink pixels.
    pub ink_pixels: u64,
}

impl Threshold {
    /// The ink of a picture, and how it was told; no split, and no ink, for a picture of one level or below
    /// the least contrast. The same comes out row by row, and with any number of threads.
    ///
    /// ```
    /// # use plotter_vector::{Gray, Threshold};
    /// let scan = Gray::new(4, 1, vec![250, 20, 240, 251])?;
    /// let (ink, split) = Threshold::default().apply(&scan);
    /// assert_eq!(ink.to_string(), ".#..\n");
    /// assert!(split.unwrap().ink_is_dark);
    /// # Ok::<(), plotter_vector::picture::GrayError>(())
    /// ```
    #[must_use]
    pub fn apply(self, gray: &Gray) -> (Bitmap, Option<Split>) {
        let survey = self.survey(gray);
        if survey.is_uneven() {
            let Some((evened, settings)) = self.evened(gray) else { return self.by_level().apply(gray) };
            let (ink, split) = settings.apply(&evened.gray);
            return (ink, evened.look.split(split));
        }
        told(survey, gray)
    }
}

/// The ink of a picture that has been surveyed.
pub(crate) fn told(survey: Survey, gray: &Gray) -> (Bitmap, Option<Split>) {
    // A `Gray` has been checked against the same limits, so the empty picture below is never wrong.
    let Ok(mut ink) = Bitmap::new(gray.width(), gray.height()) else {
        return (Bitmap::empty(), None);
    };
    let Some(rows) = survey.finish() else {
        return (ink, None);
    };
    fill(&rows, gray, &mut ink);
    let split = rows.split(ink.count());
    (ink, Some(split))
}

impl Threshold {
    /// A picture whose ink no single level tells from its paper, as if the ink were black and the paper
    /// white, with what was found; none where [`ThresholdMethod::Auto`] takes a level, and for other methods.
    ///
    /// ```
    /// # use plotter_vector::{Gray, Threshold};
    /// // The light falls off to the right, and with it a line across: paper there is darker than ink here.
    /// let level = |x: u32, y: u32| (250 - 2 * x) * if (30..34).contains(&y) { 1 } else { 2 } / 2;
    /// let photo = Gray::new(100, 64, (0..6400).map(|i| level(i % 100, i / 100) as u8).collect())?;
    /// let (evened, look) = Threshold::default().look(&photo).unwrap();
    /// assert!((0..100).all(|x| evened.pixels()[100 * 31 + x] <= 127 && evened.pixels()[100 * 9 + x] > 127));
    /// assert!(!look.light_ink);
    /// # Ok::<(), plotter_vector::picture::GrayError>(())
    /// ```
    #[must_use]
    pub fn look(self, gray: &Gray) -> Option<(Gray, Look)> {
        if !self.survey(gray).is_uneven() {
            return None;
        }
        self.evened(gray).map(|(Evened { gray, look }, _)| (gray, look))
    }

    /// What must be known of all of a picture before its first pixel can be told.
    pub(crate) fn survey(self, gray: &Gray) -> Survey {
        let mut survey = Survey::checked(self, gray.width(), gray.height());
        survey.push_all(gray.pixels());
        survey
    }

    /// A picture that was found uneven as if its ink were black, and what tells the ink there; none where
    /// that leaves nothing, and one level tells two classes apart: a picture full of lines, which have no
    /// paper beside them.
    pub(crate) fn evened(self, gray: &Gray) -> Option<(Evened, Self)> {
        let evened = Evened::of(gray, self.polarity, self.keep_pale);
        if evened.is_empty() && has_two_classes(gray) {
            return None;
        }
        let method = ThresholdMethod::Level(Evened::LEVEL);
        Some((evened, Self { polarity: Polarity::DarkInk, method, ..self }))
    }

    /// By one level, whatever the picture is like.
    pub(crate) fn by_level(self) -> Self {
        Self { method: ThresholdMethod::Otsu, ..self }
    }
}

/// Whether one level explains nearly all differences between levels, which are those of black and white: of
/// noise, which has one class, it explains 64 to 81 %.
#[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
fn has_two_classes(gray: &Gray) -> bool {
    const EXPLAINED: f64 = 0.86; // a share of the variance, just above what noise has
    const CONTRAST: f64 = 100.0; // levels: two fifths of all, where a shadow on paper has less
    let mut histogram = Histogram::default();
    histogram.push(gray.pixels());
    let counts = histogram.counts();
    let Some(level) = otsu(&counts, 0) else { return false };
    // Pixels, and the sums of their levels and of the squares.
    let sums = |dark: Option<bool>| {
        let levels = (0_u16..).zip(counts);
        let own = levels.filter(|(at, _)| dark.is_none_or(|dark| dark == (*at <= u16::from(level))));
        own.fold([0.0; 3], |[n, sum, squares], (at, pixels)| {
            let (at, pixels) = (f64::from(at), pixels as f64);
            [n + pixels, sum + pixels * at, squares + pixels * at * at]
        })
    };
    let spread = |[n, sum, squares]: [f64; 3]| squares - sum * sum / n.max(1.0);
    let mean = |[n, sum, _]: [f64; 3]| sum / n.max(1.0);
    let (dark, light) = (sums(Some(true)), sums(Some(false)));
    let explained = 1.0 - (spread(dark) + spread(light)) / spread(sums(None)).max(1.0);
    explained > EXPLAINED && mean(light) - mean(dark) > CONTRAST
}

fn fill(threshold: &RowThreshold, gray: &Gray, ink: &mut Bitmap) {
    const ROWS_TOGETHER: usize = 64; // enough work for a thread to begin
    let mut rows: Vec<_> = (0..).zip(gray.rows()).zip(ink.rows_mut()).collect();
    each(rows.chunks_mut(ROWS_TOGETHER).collect(), |some| {
        for ((y, levels), words) in some {
            threshold.row(*y, levels, words);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Pixel;

    fn gray(width: u32, levels: &[u8]) -> Gray {
        let height = u32::try_from(levels.len()).unwrap() / width;
        Gray::new(width, height, levels.to_vec()).unwrap()
    }

    #[test]
    fn one_level_is_an_empty_sheet() {
        for level in [0, 127, 255] {
            let (ink, split) = Threshold::default().apply(&gray(3, &[level; 9]));
            assert_eq!((ink.count(), split), (0, None));
        }
    }

    #[test]
    fn the_minority_is_ink_on_either_ground() {
        let dark = gray(4, &[9, 200, 200, 200]);
        let light = gray(4, &[246, 55, 55, 55]);
        for (scan, ink_is_dark) in [(dark, true), (light, false)] {
            let (ink, split) = Threshold::default().apply(&scan);
            assert_eq!(ink.to_string(), "#...\n");
            assert_eq!(split.unwrap().ink_is_dark, ink_is_dark);
        }
    }

    #[test]
    fn dark_is_ink_when_both_cover_the_same() {
        let (ink, _) = Threshold::default().apply(&gray(4, &[9, 9, 200, 200]));
        assert_eq!(ink.to_string(), "##..\n");
    }

    #[test]
    fn otsu_splits_two_peaks_in_the_middle_of_the_gap() {
        let (_, split) = Threshold::default().apply(&gray(4, &[10, 10, 20, 201]));
        assert_eq!(split.unwrap().level, (20 + 200) / 2);
    }

    #[test]
    fn noise_on_an_empty_sheet_is_not_ink() {
        let (ink, split) = Threshold::default().apply(&gray(4, &[250, 255, 252, 248]));
        assert_eq!((ink.count(), split), (0, None));
    }

    #[test]
    fn light_ink_does_not_leak_past_the_last_column() {
        let mut levels = vec![255; 70];
        levels[3] = 0;
        let light = Threshold { polarity: Polarity::LightInk, ..Threshold::default() };
        let (ink, split) = light.apply(&gray(70, &levels));
        assert_eq!((ink.count(), split.unwrap().ink_pixels), (69, 69));
        assert_eq!(ink.ink().last(), Some(Pixel::new(69, 0)));
    }
}
