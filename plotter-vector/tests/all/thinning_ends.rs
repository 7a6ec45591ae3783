//! Where skeletons end: straight strokes with square and round ends, and wedges that taper to a point, at
//! many angles. `cargo test --release -p plotter-vector --test all thinning_ends:: -- --nocapture` prints the
//! tables.

use plotter_vector::{
    Bitmap, Pixel, PxPoint,
    raster::{Thinning, ThinningMethod},
};
use std::collections::BTreeSet;

const METHODS: [ThinningMethod; 2] = [ThinningMethod::GuoHall, ThinningMethod::ZhangSuen];

/// Between the angles of strokes, degrees.
const STEP_DEG: u32 = 3;

/// A line of `length` px through the middle of a picture of `side` px, under `angle_deg`.
struct Axis {
    start: (f64, f64),
    direction: (f64, f64),
}

impl Axis {
    fn new(side: u32, length: f64, angle_deg: u32, shift_px: f64) -> Self {
        // A fifth of a degree off the raster's own angles, a third of a pixel off its own places.
        let angle = (f64::from(angle_deg) + 0.2).to_radians();
        let direction = (libm::cos(angle), libm::sin(angle));
        let middle = f64::from(side) / 2.0 + shift_px;
        Self { start: (middle - direction.0 * length / 2.0, middle - direction.1 * length / 2.0), direction }
    }

    /// Along and across.
    fn of(&self, pixel: Pixel) -> (f64, f64) {
        let centre = PxPoint::from(pixel);
        let (dx, dy) = (centre.x - self.start.0, centre.y - self.start.1);
        (dx * self.direction.0 + dy * self.direction.1, dy * self.direction.0 - dx * self.direction.1)
    }

    fn draw(&self, side: u32, inside: impl Fn(f64, f64) -> bool) -> Bitmap {
        let mut ink = Bitmap::new(side, side).unwrap();
        for y in 0..side {
            for x in 0..side {
                let (along, across) = self.of(Pixel::new(x, y));
                ink.set(Pixel::new(x, y), inside(along, across));
            }
        }
        ink
    }

    fn extent(&self, ink: impl Iterator<Item = Pixel>) -> (f64, f64) {
        ink.map(|pixel| self.of(pixel).0)
            .fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(at), high.max(at)))
    }
}

fn ends(skeleton: &Bitmap) -> usize {
    let pixels: Vec<Pixel> = skeleton.ink().collect();
    pixels.iter().filter(|at| pixels.iter().filter(|other| at.touches(**other)).count() <= 2).count()
}

/// The pixels of the largest component: a tip narrower than a pixel falls into dots.
fn largest_component(ink: &Bitmap) -> BTreeSet<Pixel> {
    let mut left: BTreeSet<Pixel> = ink.ink().collect();
    let mut largest = BTreeSet::new();
    while let Some(first) = left.pop_first() {
        let mut component = BTreeSet::from([first]);
        let mut front = vec![first];
        while let Some(at) = front.pop() {
            for y in at.y.saturating_sub(1)..=at.y + 1 {
                for x in at.x.saturating_sub(1)..=at.x + 1 {
                    if left.remove(&Pixel::new(x, y)) {
                        component.insert(Pixel::new(x, y));
                        front.push(Pixel::new(x, y));
                    }
                }
            }
        }
        if component.len() > largest.len() {
            largest = component;
        }
    }
    largest
}

/// Of strokes of one width: the farthest that a skeleton's end lies from the ink's beyond half the width, px,
/// and how many skeletons have more or fewer ends than two.
fn strokes(method: ThinningMethod, width: u32, round: bool) -> (f64, u32, u32) {
    const SIDE: u32 = 91;
    const LENGTH: f64 = 60.0;
    let half = f64::from(width) / 2.0;
    let (mut farthest, mut forked, mut total) = (f64::MIN, 0, 0);
    for angle_deg in (0..180).step_by(STEP_DEG as usize) {
        let axis = Axis::new(SIDE, LENGTH, angle_deg, f64::from(angle_deg % 7) / 7.0);
        let ink = axis.draw(SIDE, |along, across| {
            let beyond = (-along).max(along - LENGTH).max(0.0);
            if round { libm::hypot(beyond, across) <= half } else { beyond == 0.0 && across.abs() <= half }
        });
        let thinned = Thinning::default().with_method(method).thin(&ink);
        assert!(thinned.converged);
        let (low, high) = axis.extent(thinned.skeleton.ink());
        let cap = if round { half } else { 0.0 };
        farthest = farthest.max(low + cap - half).max(LENGTH + cap - high - half);
        forked += u32::from(ends(&thinned.skeleton) != 2);
        total += 1;
    }
    (farthest, forked, total)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn strokes_end_half_their_width_before_their_ink() {
    /// Beyond half the width, px: of the two pixels an end lies between, and of the octagon that stands for a
    /// circle.
    const SQUARE_PX: f64 = 2.5;
    const ROUND_PX: f64 = 2.5;
    /// Zhang & Suen's peels diagonal sides slower.
    const ROUND_ZHANG_SUEN_PX: f64 = 4.5;
    for method in METHODS {
        let mut all = [(f64::MIN, 0, 0); 2];
        println!("{method:?}\nwidth  square: beyond, forked   round: beyond, forked");
        for width in 2..=15 {
            let both = [false, true].map(|round| strokes(method, width, round));
            let [(square, square_forked, n), (round, round_forked, _)] = both;
            println!("{width:5} {square:14.1} {square_forked:3}/{n} {round:15.1} {round_forked:3}/{n}");
            for (sum, one) in all.iter_mut().zip(both) {
                *sum = (sum.0.max(one.0), sum.1 + one.1, sum.2 + one.2);
            }
        }
        println!(
            "  all {:14.1} {:3}/{} {:14.1} {:3}/{}\n",
            all[0].0, all[0].1, all[0].2, all[1].0, all[1].1, all[1].2
        );
        let round_px = if method == ThinningMethod::GuoHall { ROUND_PX } else { ROUND_ZHANG_SUEN_PX };
        assert!(all[0].0 <= SQUARE_PX && all[1].0 <= round_px, "{method:?}: {all:?}");
        // At a square end the centreline forks towards both corners; a twentieth may show a branch.
        assert!(all[0].1 * 20 <= all[0].2 && all[1].1 * 100 <= all[1].2, "{method:?}: {all:?}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_wedge_is_followed_to_its_point() {
    const SIDE: u32 = 221;
    const BASE_PX: f64 = 9.0;
    for method in METHODS {
        let (mut worst, mut total) = (0.0_f64, 0.0);
        let (mut forked, mut count) = (0, 0);
        for (length, angle_deg) in
            [200.0, 60.0].into_iter().flat_map(|l| (0..360).step_by(6).map(move |a| (l, a)))
        {
            let axis = Axis::new(SIDE, length, angle_deg, 0.3);
            let ink = axis.draw(SIDE, |along, across| {
                along >= 0.0 && across.abs() <= BASE_PX / 2.0 * (1.0 - along / length)
            });
            let mut wedge = Bitmap::new(SIDE, SIDE).unwrap();
            largest_component(&ink).into_iter().for_each(|at| wedge.set(at, true));
            let thinned = Thinning::default().with_method(method).thin(&wedge);
            let lost = axis.extent(wedge.ink()).1 - axis.extent(thinned.skeleton.ink()).1;
            worst = worst.max(lost);
            total += lost;
            forked += u32::from(ends(&thinned.skeleton) != 2);
            count += 1;
        }
        println!(
            "{method:?}: wedges lose {:.2} px on average, {worst:.2} at most; {forked}/{count} forked",
            total / f64::from(count)
        );
        assert!(worst <= 1.5, "{method:?}: {worst} px");
    }
}
