//! [`OwnCharacters`]: characters that a text draws once and uses in its labels: `DL`.

/// In the place of an x: the pen is lifted on the way to the next place.
const LIFT: i8 = -128;
/// Steps of the grid of `DL` in a capital letter's width and height.
///
/// Source: *HP 7550A Interfacing and Programming Manual*, chapter 11: a cell of 48 by 64 steps, half again as
/// wide and twice as high as a capital letter.
pub(super) const GRID: f64 = 32.0;

/// Characters of the text's own, one after the other in `BYTES` bytes: its byte, how many numbers it has, the
/// numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OwnCharacters<const BYTES: usize> {
    store: [i8; BYTES],
    used: usize,
    /// Where the character begins that is being told, if one is.
    open: Option<usize>,
}

/// The next place of a character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OwnPlace {
    pub(super) x: i8,
    pub(super) y: i8,
    /// Whether the pen is lifted on the way to it.
    pub(super) lifted: bool,
}

impl<const BYTES: usize> OwnCharacters<BYTES> {
    pub(super) const fn new() -> Self {
        Self { store: [0; BYTES], used: 0, open: None }
    }

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        (self.used, self.open) = (0, None);
    }

    /// A character is being told anew; says whether there is room.
    pub(super) fn begin(&mut self, byte: u8) -> bool {
        self.forget(byte);
        let begin = self.used;
        let Some([head, count]) = self.store.get_mut(begin..).and_then(<[i8]>::first_chunk_mut) else {
            return false;
        };
        (*head, *count) = (byte.cast_signed(), 0);
        self.used += 2;
        self.open = Some(begin);
        true
    }

    /// One more of its numbers; says whether there was room.
    pub(super) fn push(&mut self, number: i8) -> bool {
        let Some(begin) = self.open else { return true };
        let count = self.store.get(begin + 1).copied().map_or(0, i8::cast_unsigned);
        let (Some(more), Some(slot)) = (count.checked_add(1), self.store.get_mut(self.used)) else {
            // Half a character is none.
            self.give_up();
            return false;
        };
        *slot = number;
        self.used += 1;
        if let Some(slot) = self.store.get_mut(begin + 1) {
            *slot = more.cast_signed();
        }
        true
    }

    /// The character that is being told is none.
    pub(super) fn give_up(&mut self) {
        if let Some(begin) = self.open.take() {
            self.used = begin;
        }
    }

    /// The character has been told; one without places is forgotten.
    pub(super) fn end(&mut self) {
        if let Some(begin) = self.open.take()
            && self.used == begin + 2
        {
            self.used = begin;
        }
    }

    /// Place `index` of a character and the index after it; none after the last.
    pub(super) fn place(&self, byte: u8, index: usize) -> Option<(OwnPlace, usize)> {
        let numbers = self.numbers(byte)?;
        let lifted = index == 0 || numbers.get(index) == Some(&LIFT);
        let mut at = index;
        while numbers.get(at) == Some(&LIFT) {
            at += 1;
        }
        let &[x, y, ..] = numbers.get(at..)? else { return None };
        Some((OwnPlace { x, y, lifted }, at + 2))
    }

    fn numbers(&self, byte: u8) -> Option<&[i8]> {
        let begin = self.find(byte)?;
        let count = usize::from(self.store.get(begin + 1)?.cast_unsigned());
        self.store.get(begin + 2..begin + 2 + count)
    }

    fn find(&self, byte: u8) -> Option<usize> {
        let mut begin = 0;
        while begin < self.used {
            let &[head, count] = self.store.get(begin..)?.first_chunk()?;
            if head.cast_unsigned() == byte {
                return Some(begin);
            }
            begin += 2 + usize::from(count.cast_unsigned());
        }
        None
    }

    fn forget(&mut self, byte: u8) {
        let Some(begin) = self.find(byte) else { return };
        let end = begin + 2 + self.numbers(byte).map_or(0, <[i8]>::len);
        self.store.copy_within(end..self.used, begin);
        self.used -= end - begin;
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    type OwnCharacters = super::OwnCharacters<1024>;

    fn told(characters: &mut OwnCharacters, byte: u8, numbers: &[i8]) -> bool {
        let room = characters.begin(byte) && numbers.iter().all(|number| characters.push(*number));
        characters.end();
        room
    }

    fn places(characters: &OwnCharacters, byte: u8) -> Vec<(i8, i8, bool)> {
        let mut index = 0;
        core::iter::from_fn(|| {
            let (place, next) = characters.place(byte, index)?;
            index = next;
            Some((place.x, place.y, place.lifted))
        })
        .collect()
    }

    #[test]
    fn a_character_is_told_again_and_forgotten() {
        let mut characters = OwnCharacters::new();
        assert!(told(&mut characters, b'A', &[0, 0, 8, 8, -128, 1, 2]));
        assert!(told(&mut characters, b'B', &[5, 5]));
        assert_eq!(places(&characters, b'A'), [(0, 0, true), (8, 8, false), (1, 2, true)]);
        assert!(told(&mut characters, b'A', &[-128, 3, 3, 4, 4, 9]));
        assert_eq!(places(&characters, b'A'), [(3, 3, true), (4, 4, false)], "an x without a y is left out");
        assert_eq!(places(&characters, b'B'), [(5, 5, true)]);
        assert!(told(&mut characters, b'A', &[]));
        assert_eq!(places(&characters, b'A'), []);
        assert_eq!(places(&characters, b'B'), [(5, 5, true)]);
    }

    #[test]
    fn what_does_not_fit_is_no_character() {
        let mut characters = OwnCharacters::new();
        assert!(!told(&mut characters, b'A', &[1; 256]), "more than 255 numbers");
        for byte in b'a'..b'a' + 5 {
            told(&mut characters, byte, &[1; 200]);
        }
        assert!(!told(&mut characters, b'z', &[1; 200]));
        assert_eq!(places(&characters, b'z'), []);
        assert_eq!(places(&characters, b'a').len(), 100);
    }
}
