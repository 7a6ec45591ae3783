//! Words of stencil letters in many sizes, some askew, some in frames.

use super::{sheet, word};
use crate::corpus::Picture;
use crate::corpus::random::Random;
use crate::corpus::strokes::turned;

/// Width of a line of lettering by its height: the stencil's letters are 4 wide and 6 high, 6 apart.
fn wide(words: &str, high: f64) -> f64 {
    high * (words.len() as f64 - 1.0 / 3.0)
}

pub(super) fn lettering(random: &mut Random) -> Picture {
    let mut picture = sheet("lettering", 4.0);
    let mut y = random.between(70.0, 100.0);
    loop {
        let words = match random.below(3) {
            0 => format!("{} {}", word(random), 10 + random.below(90)),
            1 => format!("{}.{:02} + {}", 1 + random.below(9), random.below(100), 1 + random.below(9)),
            _ => word(random).to_owned(),
        };
        let most = 800.0 / wide(&words, 1.0);
        let high = random.between(36.0, 130.0).min(most);
        if y + high > 1300.0 {
            return picture;
        }
        picture.pen((high * random.between(0.06, 0.11)).clamp(2.0, 7.0));
        let long = wide(&words, high);
        let x = random.between(70.0, (930.0 - long).max(71.0));
        let angle = random.between(-0.04, 0.04);
        picture.text((x, y), high, angle, &words);
        let place = |px: f64, py: f64| turned((px, py), angle, (x, y));
        match random.below(3) {
            0 => picture.line(&[place(0.0, high + 20.0), place(long, high + 20.0)]),
            1 => {
                let gap = 24.0;
                picture.line(&[
                    place(-gap, -gap),
                    place(long + gap, -gap),
                    place(long + gap, high + gap),
                    place(-gap, high + gap),
                    place(-gap, -gap),
                ]);
            }
            _ => {}
        }
        y += high + random.between(78.0, 110.0);
    }
}
