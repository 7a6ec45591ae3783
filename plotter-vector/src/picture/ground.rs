//! [`Ground`]: what is seen through a transparent picture.

use crate::picture::gray::luma;

/// What a transparent picture is laid on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Ground {
    /// White paper: what is clear is not drawn.
    #[default]
    White,
    /// Black: what is drawn is light, as white lines on a clear ground, and would not be seen on white.
    Black,
}

impl Ground {
    pub(crate) const fn level(self) -> u8 {
        match self {
            Self::White => u8::MAX,
            Self::Black => 0,
        }
    }
}

/// What is as light as this is hardly seen on white: three quarters of the way from black.
const LIGHT: u8 = 192;

/// Share of what is drawn that may be darker and is not missed: the rims of light lines that some programs
/// darken.
const DARK_SHARE: u64 = 100;

/// Share of the picture that must be clear for it to be a ground: less is a rounded corner.
const CLEAR_SHARE: u64 = 100;

/// What covers more than half of the picture is a sheet with lines of its own, unless all its levels lie as
/// near to each other as this.
const ONE_LEVEL: u8 = 24;

/// What a sheet's darkest levels are taken without: a thousandth of it is dirt.
const DIRT_SHARE: u64 = 1000;

/// How light what a transparent picture shows is, pixel by pixel.
///
/// A picture goes on white, as paper is, unless nothing would be left of it there.
#[derive(Clone, Debug)]
pub(crate) struct GroundSurvey {
    /// Of each level how much is drawn: the sum of the pixels' alphas.
    weights: [u64; 256],
    /// The sum of the alphas of what is darker than light.
    dark: u64,
    clear: u64,
    /// The greatest sum that there may be.
    area: u64,
}

impl GroundSurvey {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let area = u64::from(width) * u64::from(height) * u64::from(u8::MAX);
        Self { weights: [0; 256], dark: 0, clear: 0, area }
    }

    /// Adds `count` pixels of a colour and an alpha.
    pub(crate) fn add_many(&mut self, [red, green, blue, alpha]: [u8; 4], count: u64) {
        let level = luma([red, green, blue]);
        let drawn = count * u64::from(alpha);
        if let Some(weight) = self.weights.get_mut(usize::from(level)) {
            *weight += drawn;
        }
        if level < LIGHT {
            self.dark += drawn;
        }
        self.clear += count * u64::from(u8::MAX - alpha);
    }

    pub(crate) fn add(&mut self, colour: [u8; 4]) {
        self.add_many(colour, 1);
    }

    /// Whether the rest of the picture changes nothing: so much of it is dark that it is seen on white.
    pub(crate) fn is_decided(&self) -> bool {
        self.dark > self.area / DARK_SHARE
    }

    pub(crate) fn ground(&self) -> Ground {
        let drawn: u64 = self.weights.iter().sum();
        if drawn == 0 || self.clear <= self.area / CLEAR_SHARE || self.dark > drawn / DARK_SHARE {
            return Ground::White;
        }
        if drawn <= self.area / 2 {
            return Ground::Black;
        }
        let mut below = 0;
        let of_share = |weight: &u64| {
            below += weight;
            below > drawn / DIRT_SHARE
        };
        let darkest = self.weights.iter().position(of_share).unwrap_or(0);
        let lightest = self.weights.iter().rposition(|weight| *weight > 0).unwrap_or(0);
        if darkest >= usize::from(LIGHT) && lightest - darkest.min(lightest) <= usize::from(ONE_LEVEL) {
            Ground::Black
        } else {
            Ground::White
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ground of a picture of 1000 pixels of these colours, the rest clear.
    fn ground(parts: &[([u8; 4], u64)]) -> Ground {
        let mut survey = GroundSurvey::new(1000, 1);
        let drawn: u64 = parts.iter().map(|(_, count)| count).sum();
        parts.iter().for_each(|(colour, count)| survey.add_many(*colour, *count));
        survey.add_many([0; 4], 1000 - drawn);
        if survey.is_decided() {
            assert_eq!(survey.ground(), Ground::White, "{parts:?}");
        }
        survey.ground()
    }

    #[test]
    fn light_lines_are_put_on_black() {
        let (white, grey) = ([255, 255, 255, 255], [200, 200, 200, 255]);
        assert_eq!(ground(&[(white, 50)]), Ground::Black);
        assert_eq!(ground(&[(white, 50), ([255, 255, 255, 90], 30)]), Ground::Black, "rims");
        assert_eq!(ground(&[(grey, 20), ([255, 255, 0, 255], 20)]), Ground::Black, "light colours");
        assert_eq!(ground(&[(white, 700)]), Ground::Black, "a silhouette");
        assert_eq!(ground(&[(white, 400), ([0, 0, 0, 255], 3)]), Ground::Black, "a little dirt");
    }

    #[test]
    fn what_is_seen_on_white_stays_there() {
        let (white, black) = ([255, 255, 255, 255], [0, 0, 0, 255]);
        assert_eq!(ground(&[]), Ground::White, "nothing at all");
        assert_eq!(ground(&[(black, 50)]), Ground::White);
        assert_eq!(ground(&[(white, 1000)]), Ground::White, "nothing clear");
        assert_eq!(ground(&[(white, 995)]), Ground::White, "rounded corners");
        assert_eq!(ground(&[(white, 100), (black, 20)]), Ground::White, "a sticker with outlines");
        assert_eq!(ground(&[(white, 850), (black, 4)]), Ground::White, "a cut-out sheet with few lines");
        assert_eq!(ground(&[(white, 800), ([210, 210, 210, 255], 50)]), Ground::White, "with faint ones");
        assert_eq!(ground(&[([255, 0, 0, 255], 50)]), Ground::White, "red");
    }
}
