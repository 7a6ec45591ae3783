//! Selects the pixels that a thinning step may delete, by the eight neighbours of 64 pixels at a time.
//!
//! A pixel is *simple* when deleting it changes neither the 8-connected ink components nor the 4-connected
//! paper: C = 1 below. That holds for one pixel; for many at once it is enough, by C. Ronse, "Minimal test
//! patterns for connectivity preservation in parallel thinning algorithms for binary digital images",
//! Discrete Applied Mathematics 21 (1988), pp. 67-79, that
//!
//! 1. each deleted pixel is simple,
//! 2. of two deleted pixels side by side, or one above the other, each is still simple when the other has
//!    gone, and
//! 3. no component that fits in a square of 2 x 2 goes as a whole.
//!
//! These are finitely many cases, and the tests below go through all of them for every step.

/// The eight neighbours of 64 pixels in a row: bit i of each word is the neighbour of pixel i. The papers
/// call them P2 … P9, clockwise from the north.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Neighbours {
    pub(super) n: u64,
    pub(super) ne: u64,
    pub(super) e: u64,
    pub(super) se: u64,
    pub(super) s: u64,
    pub(super) sw: u64,
    pub(super) w: u64,
    pub(super) nw: u64,
}

impl Neighbours {
    /// The neighbours after half a turn of the picture.
    #[inline]
    pub(super) const fn half_turn(self) -> Self {
        let Self { n, ne, e, se, s, sw, w, nw } = self;
        Self { n: s, ne: sw, e: w, se: nw, s: n, sw: ne, w: e, nw: se }
    }

    /// The neighbours after a quarter turn of the picture to the left: the east comes to lie in the north.
    #[inline]
    pub(super) const fn quarter_turn(self) -> Self {
        let Self { n, ne, e, se, s, sw, w, nw } = self;
        Self { n: e, ne: se, e: s, se: sw, s: w, sw: nw, w: n, nw: ne }
    }

    /// C = 1 of Guo & Hall: `¬P2(P3∨P4) + ¬P4(P5∨P6) + ¬P6(P7∨P8) + ¬P8(P9∨P2)`, the number of 8-connected
    /// pieces of the ring, is one. The centre of solid ink has C = 0.
    #[inline]
    pub(super) const fn simple(self) -> u64 {
        let Self { n, ne, e, se, s, sw, w, nw } = self;
        let (a, b) = (!n & (ne | e), !e & (se | s));
        let (c, d) = (!s & (sw | w), !w & (nw | n));
        (a ^ b ^ c ^ d) & !(a & b | c & d)
    }

    /// First half of a pass of algorithm A1 of Z. Guo and R. W. Hall, "Parallel thinning with
    /// two-subiteration algorithms", Communications of the ACM 32 (1989), pp. 359-373; the second half is the
    /// same after half a turn.
    ///
    /// C = 1, 2 ≤ N ≤ 3 with N = min(N1, N2) the number of neighbours counted in pairs, and
    /// `(P2 ∨ P3 ∨ ¬P5) ∧ P4 = 0`: pixels of the north and east sides.
    #[inline]
    pub(super) const fn guo_hall(self) -> u64 {
        let Self { n, ne, e, se, s, sw, w, nw } = self;
        let (a, b, c, d) = (nw | n, ne | e, se | s, sw | w);
        let two_n1 = a & b | c & d | (a | b) & (c | d);
        let four_n1 = a & b & c & d;
        let (a, b, c, d) = (n | ne, e | se, s | sw, w | nw);
        let two_n2 = a & b | c & d | (a | b) & (c | d);
        let four_n2 = a & b & c & d;
        self.simple() & two_n1 & two_n2 & !(four_n1 & four_n2) & !((n | ne | !se) & e)
    }

    /// First half of a pass of T. Y. Zhang and C. Y. Suen, "A fast parallel algorithm for thinning digital
    /// patterns", Communications of the ACM 27 (1984), pp. 236-239, mended; the second half is the same after
    /// half a turn.
    ///
    /// As published: 2 ≤ B ≤ 6 neighbours, A = 1 change from paper to ink around the ring, P2·P4·P6 = 0 and
    /// P4·P6·P8 = 0. Mended twice:
    ///
    /// - 3 ≤ B (H. E. Lü and P. S. P. Wang, "A comment on …", Communications of the ACM 29 (1986), pp.
    ///   239-242): with two, diagonal lines two pixels wide are eaten up from their ends.
    /// - The north-west pixel of a square stays: a square of 2 x 2 would go as a whole, the only one of
    ///   Ronse's cases in which the step is wrong. On a larger corner the pixel goes in the other half.
    #[inline]
    pub(super) const fn zhang_suen(self) -> u64 {
        let Self { n, ne, e, se, s, sw, w, nw } = self;
        let ring = [n, ne, e, se, s, sw, w, nw, n, ne];
        let (mut once, mut twice, mut three, mut gap) = (0, 0, 0, 0);
        let mut rest: &[u64] = &ring;
        while let [this, tail @ ..] = rest {
            if let [next, third, ..] = tail {
                let rise = !*this & *next;
                twice |= once & rise;
                once |= rise;
                // With A = 1 the ink of the ring is one run: three in a row tell B ≥ 3, a gap of two B ≤ 6.
                three |= *this & *next & *third;
                gap |= !(*this | *next);
            }
            rest = tail;
        }
        let square = e & se & s & !(sw | w | nw | n | ne);
        once & !twice & three & gap & !(n & e & s) & !(e & s & w) & !square
    }

    /// North-east corners of ink: what makes a diagonal edge. Paper on that side, ink on the other.
    #[inline]
    pub(super) const fn corner(self) -> u64 {
        let Self { n, ne, e, se: _, s, sw, w, nw: _ } = self;
        w & sw & s & !(n | ne | e)
    }

    /// Tips among the pixels `here`: one neighbour, or two side by side.
    #[inline]
    pub(super) const fn tip(self, here: u64) -> u64 {
        let Self { n, ne, e, se, s, sw, w, nw } = self;
        // None has ink on two opposite sides, and in most words all ink has.
        let here = here & !(n & s | e & w | ne & sw | nw & se);
        if here == 0 {
            return 0;
        }
        let (ones, twos, threes) = at_least([n, ne, e, se, s, sw, w, nw]);
        let pair = n & ne | ne & e | e & se | se & s | s & sw | sw & w | w & nw | nw & n;
        here & ones & !threes & (!twos | pair)
    }

    /// Clean-up: simple pixels with ink above and paper below, unless they are the last pixel of a line.
    #[inline]
    pub(super) const fn bare_below(self) -> u64 {
        let Self { n, ne, e, se, s, sw, w, nw } = self;
        self.simple() & n & !s & (ne | e | se | sw | w | nw)
    }
}

/// Where at least one, two and three of the words are set.
#[inline]
const fn at_least(words: [u64; 8]) -> (u64, u64, u64) {
    let (mut ones, mut twos, mut threes) = (0, 0, 0);
    let mut rest: &[u64] = &words;
    while let [word, tail @ ..] = rest {
        threes |= twos & *word;
        twos |= ones & *word;
        ones |= *word;
        rest = tail;
    }
    (ones, twos, threes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ring of 8 bits, clockwise from the north, at pixel 0.
    fn ring(bits: u32) -> Neighbours {
        let at = |i: u32| u64::from(bits >> i & 1);
        Neighbours { n: at(0), ne: at(1), e: at(2), se: at(3), s: at(4), sw: at(5), w: at(6), nw: at(7) }
    }

    /// A picture of 8 x 8 in a word, row by row.
    fn ring_at(picture: u64, x: u32, y: u32) -> u32 {
        const CLOCKWISE: [(u32, u32); 8] = [(1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1), (0, 0)];
        (0..8).zip(CLOCKWISE).fold(0, |bits, (i, (dx, dy))| {
            let bit = picture >> ((y + dy - 1) * 8 + x + dx - 1) & 1;
            bits | u32::from(bit == 1) << i
        })
    }

    const fn pixel(x: u32, y: u32) -> u64 {
        1 << (y * 8 + x)
    }

    type Rule = (&'static str, fn(Neighbours) -> u64);

    fn rules() -> [Rule; 13] {
        [
            ("guo-hall, first", Neighbours::guo_hall),
            ("guo-hall, second", |n| n.half_turn().guo_hall()),
            ("zhang-suen, first", Neighbours::zhang_suen),
            ("zhang-suen, second", |n| n.half_turn().zhang_suen()),
            ("corners, rising", |n| n.corner() | n.half_turn().corner()),
            ("corners, falling", |n| {
                let n = n.quarter_turn();
                n.corner() | n.half_turn().corner()
            }),
            ("bare below", Neighbours::bare_below),
            ("bare above", |n| n.half_turn().bare_below()),
            ("bare to the left", |n| n.quarter_turn().bare_below()),
            ("bare to the right", |n| n.quarter_turn().half_turn().bare_below()),
            ("tips", |n| n.tip(u64::MAX)),
            ("tips, turned", |n| n.quarter_turn().tip(u64::MAX)),
            ("nothing", |_| 0),
        ]
    }

    fn takes(rule: Rule, bits: u32) -> bool {
        rule.1(ring(bits)) & 1 == 1
    }

    fn simple(bits: u32) -> bool {
        ring(bits).simple() & 1 == 1
    }

    /// Number of 8-connected components of ink and of 4-connected components of paper in a ring with its
    /// centre.
    fn pieces(bits: u32, centre: bool) -> (u32, u32) {
        const PLACES: [(i32, i32); 8] =
            [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)];
        let mut cells: Vec<((i32, i32), bool)> =
            (0..8).zip(PLACES).map(|(i, place)| (place, bits >> i & 1 == 1)).collect();
        cells.push(((0, 0), centre));
        let mut counts = (0, 0);
        let mut label = vec![false; cells.len()];
        for start in 0..cells.len() {
            if label[start] {
                continue;
            }
            let ink = cells[start].1;
            // Paper of the ring that touches the centre only by a corner is connected outside the ring.
            let mut stack = vec![start];
            let mut near = ink;
            while let Some(at) = stack.pop() {
                if core::mem::replace(&mut label[at], true) {
                    continue;
                }
                let ((x, y), _) = cells[at];
                near |= x == 0 || y == 0;
                for (other, ((u, v), same)) in cells.iter().enumerate() {
                    let (dx, dy) = ((x - u).abs(), (y - v).abs());
                    let joined = if ink { dx.max(dy) == 1 } else { dx + dy == 1 };
                    if *same == ink && joined && !label[other] {
                        stack.push(other);
                    }
                }
            }
            *(if ink { &mut counts.0 } else { &mut counts.1 }) += u32::from(near);
        }
        counts
    }

    #[test]
    fn simple_is_what_keeps_ink_and_paper_connected() {
        for bits in 0..256 {
            assert_eq!(simple(bits), pieces(bits, true) == pieces(bits, false), "{bits:08b}");
        }
    }

    #[test]
    fn every_deleted_pixel_is_simple() {
        for rule in rules() {
            for bits in 0..256 {
                assert!(!takes(rule, bits) || simple(bits), "{} deletes {bits:08b}", rule.0);
            }
        }
    }

    #[test]
    fn of_two_deleted_neighbours_each_may_go_first() {
        // The 12 cells of two pixels side by side and around, and the same upright.
        for (right, down) in [(1, 0), (0, 1)] {
            let (a, b) = ((1, 1), (1 + right, 1 + down));
            let cells: Vec<u64> = (0..=2 + down)
                .flat_map(|y| (0..=2 + right).map(move |x| (x, y)))
                .filter(|cell| *cell != a && *cell != b)
                .map(|(x, y)| pixel(x, y))
                .collect();
            assert_eq!(cells.len(), 10);
            for mask in 0..1_u32 << 10 {
                let around: u64 =
                    (0..10).zip(&cells).filter(|(i, _)| mask >> i & 1 == 1).map(|(_, cell)| cell).sum();
                let both = around | pixel(a.0, a.1) | pixel(b.0, b.1);
                let (of_a, of_b) = (ring_at(both, a.0, a.1), ring_at(both, b.0, b.1));
                let without_b = ring_at(both ^ pixel(b.0, b.1), a.0, a.1);
                for rule in rules() {
                    // Two tips that have only each other are kept by `shrinks`.
                    let alone =
                        rule.0.starts_with("tips") && of_a.count_ones() == 1 && of_b.count_ones() == 1;
                    if takes(rule, of_a) && takes(rule, of_b) && !alone {
                        assert!(simple(of_b) && simple(without_b), "{}: {both:064b}", rule.0);
                    }
                }
            }
        }
    }

    #[test]
    fn no_component_within_two_by_two_goes_as_a_whole() {
        let square = [(3, 3), (4, 3), (3, 4), (4, 4)];
        for mask in 1..16_u32 {
            let part: Vec<(u32, u32)> =
                (0..4).zip(square).filter(|(i, _)| mask >> i & 1 == 1).map(|(_, place)| place).collect();
            let picture = part.iter().map(|(x, y)| pixel(*x, *y)).sum();
            for rule in rules() {
                let all = part.iter().all(|(x, y)| takes(rule, ring_at(picture, *x, *y)));
                let pair_of_tips = rule.0.starts_with("tips") && part.len() == 2;
                assert!(!all || pair_of_tips, "{} deletes {part:?}", rule.0);
            }
        }
    }

    #[test]
    fn a_pixel_that_no_clean_up_takes_is_an_end_or_not_simple() {
        let sides = &rules()[6..10];
        for bits in 0..256_u32 {
            let taken = sides.iter().any(|rule| takes(*rule, bits));
            assert_eq!(taken, simple(bits) && bits.count_ones() > 1, "{bits:08b}");
        }
    }

    #[test]
    fn corners_are_what_guo_and_hall_delete() {
        for bits in 0..256 {
            let corner = rules()[4..6].iter().any(|rule| takes(*rule, bits));
            assert!(!corner || rules()[..2].iter().any(|rule| takes(*rule, bits)), "{bits:08b}");
        }
    }

    #[test]
    fn sixty_four_pixels_are_judged_each_by_itself() {
        let spread = |i: u32| (0..64).fold(0, |word, x: u32| word | u64::from((x * 37 + 11) >> i & 1) << x);
        let many = Neighbours {
            n: spread(0),
            ne: spread(1),
            e: spread(2),
            se: spread(3),
            s: spread(4),
            sw: spread(5),
            w: spread(6),
            nw: spread(7),
        };
        for rule in rules() {
            for x in 0..64 {
                assert_eq!(rule.1(many) >> x & 1 == 1, takes(rule, (x * 37 + 11) & 255), "{} {x}", rule.0);
            }
        }
    }
}
