//! [`Keyframe`]: how far the camera went since a window, from the two windows alone.
//!
//! Corners, crossings and the ends of lines tell both directions, a bundle of straight lines only the one across it. Where the
//! darkness rises or falls in the first window, the second one shows at first order
//!
//! ```text
//!   second(q) = first(q) + g · d         g: gradient of the first window, d: how far the guess of the camera's place is off
//! ```
//!
//! Least squares over these places give d and the information on it; the darkness is resampled at the new guess until d is small.
//!
//! Source: B. D. Lucas, T. Kanade, "An iterative image registration technique with an application to stereo vision" (1981), with
//! the gradient taken once, from the first window (S. Baker, I. Matthews, "Lucas-Kanade 20 years on", 2004).

use super::flat::Flat;
use super::poses::Poses;
use super::prior::{Information, Prior, moved};
use crate::stroke::{PxPoint, PxVec};

/// Most places that are compared.
const MOST_PLACES: usize = 2000;

/// Least gradient of such a place, darkness per px, and in standard deviations of the noise.
const LEAST_GRADIENT: f32 = 0.03;
const LEAST_GRADIENT_NOISES: f32 = 5.0;

/// A rim belongs to the end of a line, or to another one, if the darkness rises by more than this share of what is usual along the line.
const ACROSS_SHARE: f64 = 0.3;

/// Distances from the border of a window that are not compared, px.
const MARGIN_PX: f64 = 4.0;

/// Darkness may differ by so much before a place weighs less.
const HUBER: f64 = 0.08;

/// Squared gradients that one half of a line's end has: less tells nothing.
const LEAST_TOLD: f64 = 0.15;

/// Standard deviation of what noise and the light make of the shift where it is told well, px.
const SYSTEMATIC_PX: f64 = 0.06;

/// Windows that differ by more do not show the same.
const MOST_MISFIT: f64 = 0.08;

/// Fewer places in common tell nothing.
const LEAST_PLACES: f64 = 60.0;

/// A step beyond half of a line's width would lead to another rim, px.
const MOST_SHIFT_PX: f64 = 1.5;

/// A place known better needs no second guess, px.
const SURE_PX: f64 = 1.2;

/// From guess to guess, px, and most of them to either side.
const GUESS_PX: f64 = 2.0;
const MOST_GUESSES: i32 = 4;

/// By so much more must a guess fit that is a standard deviation farther off.
const DOUBT: f64 = 0.05;

/// A place from the camera, its darkness, and the gradient of that.
type Place = ([f32; 2], f32, [f32; 2]);

/// A window to compare others with.
#[derive(Clone, Debug, Default)]
pub(super) struct Keyframe {
    /// The camera's place.
    camera: PxPoint,
    /// Places from there: 20 bytes each.
    places: Vec<Place>,
    /// Mean squared gradient that is mere noise, in each axis.
    noise: f64,
}

impl Keyframe {
    /// A window whose middle is at `camera`.
    pub(super) fn of(flat: &Flat, middle: PxPoint, camera: PxPoint) -> Self {
        let (width, height) = flat.size();
        let rows: Vec<&[f32]> = flat.rows().collect();
        let noise = flat.noise;
        let least = LEAST_GRADIENT.max(LEAST_GRADIENT_NOISES * noise * 0.48);
        let mut places = Vec::new();
        let [left, top] = flat.origin();
        for y in 3..height.saturating_sub(3) {
            let (Some(above), Some(row), Some(below)) = (rows.get(y - 1), rows.get(y), rows.get(y + 1))
            else {
                break;
            };
            let triples = above.windows(3).zip(row.windows(3)).zip(below.windows(3)).enumerate();
            for (x, ((a, b), c)) in triples.skip(3).take(width.saturating_sub(8)) {
                let (&[a0, a1, a2], &[b0, b1, b2], &[c0, c1, c2]) = (a, b, c) else { continue };
                // Scharr's gradient: its direction is true to a degree.
                let gx = (3.0 * (a2 - a0 + c2 - c0) + 10.0 * (b2 - b0)) / 32.0;
                let gy = (3.0 * (c0 - a0 + c2 - a2) + 10.0 * (c1 - a1)) / 32.0;
                if gx * gx + gy * gy < least * least {
                    continue;
                }
                let mean = 0.25 * b1 + 0.125 * (a1 + b0 + b2 + c1) + 0.0625 * (a0 + a2 + c0 + c2);
                #[expect(clippy::cast_precision_loss, reason = "a window is small")]
                let seen = PxPoint::new((left + x + 1) as f64 + 0.5, (top + y) as f64 + 0.5);
                let PxVec { x: dx, y: dy } = seen - middle;
                #[expect(clippy::cast_possible_truncation, reason = "a window is small")]
                places.push(([dx as f32, dy as f32], mean, [gx, gy]));
            }
        }
        let places = chosen(places);
        // Sum of the squares of Scharr's coefficients: 4 * (3 / 32)² + 2 * (10 / 32)².
        Self { camera, places, noise: 0.23 * f64::from(noise) * f64::from(noise) }
    }

    /// The camera's place by a new window, with what is known before; it may be off by `sound_px` whatever
    /// the prior says. `None` where the windows do not fit each other.
    ///
    /// Where little is known, several guesses are tried, and of what they lead to that which fits best.
    pub(super) fn place(&self, flat: &Flat, middle: PxPoint, prior: &Prior, sound_px: f64) -> Option<Prior> {
        let [(one, one_sd_px), (other, other_sd_px)] = prior.information.known();
        let guesses = |sd_px: f64| {
            let most = super::whole::floor(2.5 * sd_px / GUESS_PX).min(MOST_GUESSES);
            let most = if sd_px > SURE_PX { most } else { 0 };
            (-most..=most).map(|i| GUESS_PX * f64::from(i))
        };
        let from = guesses(one_sd_px).flat_map(|along| {
            let from = prior.place + one * along;
            guesses(other_sd_px).map(move |across| from + other * across)
        });
        let found = from.filter_map(|from| {
            let fit = self.fit(flat, middle, from)?;
            let sound = prior.allows(fit.camera) || fit.camera.distance(prior.place) < sound_px;
            let doubt = prior.off(fit.camera);
            (sound && fit.misfit < MOST_MISFIT).then_some((fit.misfit * (1.0 + DOUBT * doubt), fit))
        });
        let (_, fit) = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(prior.fused(&Prior { place: fit.camera, information: fit.told }))
    }

    /// What a guess of the camera's place leads to; `None` without enough in common.
    fn fit(&self, flat: &Flat, middle: PxPoint, guess: PxPoint) -> Option<Fit> {
        let mut fit = Fit { camera: guess, ..Fit::default() };
        for _ in 0..12 {
            let (mut xx, mut xy, mut yy, mut bx, mut by) = (0.0, 0.0, 0.0, 0.0, 0.0);
            let (mut count, mut squares) = (0.0, 0.0);
            let from = middle + (self.camera - fit.camera);
            for ([dx, dy], dark, [gx, gy]) in &self.places {
                let seen = from + PxVec::new(f64::from(*dx), f64::from(*dy));
                if !flat.holds(seen, MARGIN_PX) {
                    continue;
                }
                let rest = f64::from(flat.at(seen) - dark);
                let (gx, gy) = (f64::from(*gx), f64::from(*gy));
                let weight = if rest.abs() > HUBER { HUBER / rest.abs() } else { 1.0 };
                xx += weight * gx * gx;
                xy += weight * gx * gy;
                yy += weight * gy * gy;
                bx += weight * gx * rest;
                by += weight * gy * rest;
                count += 1.0;
                squares += (rest * rest).min(4.0 * HUBER * HUBER);
            }
            if count < LEAST_PLACES {
                return None;
            }
            fit.misfit = libm::sqrt(squares / count);
            let seen = Information { xx: xx - count * self.noise, xy, yy: yy - count * self.noise };
            let shift;
            (shift, fit.told) = seen.told(PxVec::new(bx, by), LEAST_TOLD, SYSTEMATIC_PX);
            let length = shift.length();
            fit.camera += shift * (if length > MOST_SHIFT_PX { MOST_SHIFT_PX / length } else { 1.0 });
            if length < 0.01 {
                break;
            }
        }
        Some(fit)
    }
}

/// At most [`MOST_PLACES`], half of them where the darkness rises in the direction that most places tell least of: so lines that are long
/// do not hide their ends.
///
/// After S. Rusinkiewicz, M. Levoy, "Efficient variants of the ICP algorithm" (2001), section 3.1.
fn chosen(places: Vec<Place>) -> Vec<Place> {
    if places.len() <= MOST_PLACES {
        return places;
    }
    let told = places.iter().fold(Information::default(), |sum, (_, _, [x, y])| {
        let (x, y) = (f64::from(*x), f64::from(*y));
        sum.plus(Information { xx: x * x, xy: x * y, yy: y * y })
    });
    let PxVec { x: u, y: v } = told.least_told();
    let rise =
        |(_, _, [x, y]): &Place, PxVec { x: u, y: v }: PxVec| (f64::from(*x) * u + f64::from(*y) * v).abs();
    let mut rises: Vec<f64> = places.iter().map(|place| rise(place, PxVec::new(-v, u))).collect();
    let middle = rises.len() / 2;
    let (_, usual, _) = rises.select_nth_unstable_by(middle, f64::total_cmp);
    let least = ACROSS_SHARE * *usual;
    let (ends, others): (Vec<Place>, Vec<Place>) =
        places.into_iter().partition(|place| rise(place, PxVec::new(u, v)) > least);
    let few = ends.len().min(MOST_PLACES / 2);
    let evenly = |places: Vec<Place>, most: usize| {
        let step = places.len().div_ceil(most.max(1)).max(1);
        places.into_iter().step_by(step)
    };
    evenly(ends, MOST_PLACES / 2).chain(evenly(others, MOST_PLACES - few)).collect()
}

/// Where a guess led.
#[derive(Clone, Copy, Debug, Default)]
struct Fit {
    camera: PxPoint,
    told: Information,
    /// Root of the mean square of what differs, darkness.
    misfit: f64,
}

/// A place nearer than this to that of a keyframe gets none of its own, px.
const NEAR_PX: f64 = 45.0;

/// Most keyframes that are kept: at about 40 kB each.
const MOST_KEYFRAMES: usize = 2048;

/// Standard deviation of how far the camera may be off in directions that the windows on the way did not tell, px.
const ASTRAY_PX: f64 = 3.0;

/// A window with fewer places is nearly empty.
const LEAST_KEPT: usize = 120;

/// A place known worse is looked for in the windows around, px; so many of them, so far away.
const LOST_PX: f64 = 2.0;
const MOST_TRIED: usize = 4;
const FARTHEST_PX: f64 = 160.0;

/// A window that tells both directions to this corrects a new keyframe, px.
const TOLD_PX: f64 = 0.3;

/// Where two keyframes have the camera as far apart, their places are settled anew, px.
const SETTLED_PX: f64 = 0.15;

/// Windows to compare others with, one about every [`NEAR_PX`]: coming back to one the camera's place is that of before.
#[derive(Clone, Debug, Default)]
pub(super) struct Keyframes {
    kept: Vec<Keyframe>,
    active: Option<usize>,
    /// Number of the first of them: of those that were forgotten.
    first: u32,
    poses: Poses,
    is_unsettled: bool,
}

/// How far the places of keyframes were found to be elsewhere.
#[derive(Clone, Debug, Default)]
pub(super) struct Shifts {
    /// Number of the first keyframe.
    first: u32,
    px: Vec<PxVec>,
}

impl Shifts {
    /// That of a keyframe by its number, px.
    pub(super) fn of(&self, number: u32) -> PxVec {
        let i = number.checked_sub(self.first).and_then(|i| self.px.get(i as usize));
        i.copied().unwrap_or_default()
    }
}

impl Keyframes {
    /// Where the camera is, by the keyframe that was chosen last; see [`Keyframe::place`].
    pub(super) fn place(
        &mut self,
        flat: &Flat,
        middle: PxPoint,
        prior: &Prior,
        sound_px: f64,
    ) -> Option<Prior> {
        let [(_, one_sd_px), (_, other_sd_px)] = prior.information.known();
        if f64::max(one_sd_px, other_sd_px) > LOST_PX {
            // After a way without lines: which of the windows around is this?
            let mut near: Vec<(f64, usize)> = self
                .kept
                .iter()
                .enumerate()
                .map(|(i, frame)| (frame.camera.distance(prior.place), i))
                .collect();
            near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for (_, i) in near.into_iter().take(MOST_TRIED).filter(|(distance, _)| *distance < FARTHEST_PX) {
                if let Some(found) =
                    self.kept.get(i).and_then(|frame| frame.place(flat, middle, prior, sound_px))
                {
                    self.active = Some(i);
                    return Some(found);
                }
            }
        }
        self.kept.get(self.active?)?.place(flat, middle, prior, sound_px)
    }

    /// The first keyframe that showed what this window shows, if it is farther away, and where the camera is by it: coming along a line
    /// to where others end or turn that were seen long before, a new keyframe would have them where the way along the line puts them.
    /// `prior` is what is known of the camera's place seen from a keyframe.
    fn closed(
        &self,
        flat: &Flat,
        middle: PxPoint,
        camera: PxPoint,
        prior: &dyn Fn(usize) -> Prior,
    ) -> Option<(usize, Prior)> {
        let near = |(_, frame): &(usize, &Keyframe)| frame.camera.distance(camera) < FARTHEST_PX;
        self.kept.iter().enumerate().filter(near).take(MOST_TRIED).find_map(|(i, frame)| {
            let found = frame.place(flat, middle, &prior(i), 0.0)?;
            let [(_, one_sd_px), (_, other_sd_px)] = found.information.known();
            (f64::max(one_sd_px, other_sd_px) < TOLD_PX).then_some((i, found))
        })
    }

    /// The way from the keyframe chosen last to another one, by a window that shows what both do: the camera's place by each.
    fn join(&mut self, camera: PxPoint, told: Information, to: usize, found: &Prior, prior: &Prior) {
        let Some((from, one)) = self.active.and_then(|i| Some((i, self.kept.get(i)?.camera))) else { return };
        let Some(other) = self.kept.get(to).map(|frame| frame.camera) else { return };
        let told = told.plus(moved(camera.distance(one)));
        let seen = (found.information.minus(prior.information)).plus(moved(camera.distance(other)));
        let PxVec { x, y } = camera - one;
        let PxVec { x: u, y: v } = found.place - other;
        self.poses.add([from, to], PxVec::new(x - u, y - v), told.inverse().plus(seen.inverse()).inverse());
        self.is_unsettled |= camera.distance(found.place) > SETTLED_PX;
    }

    /// Chooses the keyframe near a place, or makes one of the window; gives the camera's place by it. `told` is what the window
    /// tells, and `across_px` the standard deviation in the direction told best: across lines nobody goes astray by more than what the
    /// ways from keyframe to keyframe leave in doubt, that would be the next line.
    pub(super) fn choose(
        &mut self,
        flat: &Flat,
        middle: PxPoint,
        camera: PxPoint,
        told: Information,
        across_px: f64,
    ) -> PxPoint {
        let near = self.kept.iter().enumerate().map(|(i, frame)| (frame.camera.distance(camera), i));
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(distance, _)| *distance < NEAR_PX);
        if nearest.is_some_and(|(_, i)| self.active == Some(i)) {
            return camera;
        }
        let doubts = self.active.map_or_else(Vec::new, |from| self.poses.doubts(from, self.kept.len()));
        let here = Prior { place: camera, information: told.astray(across_px, ASTRAY_PX) };
        let prior = |i: usize| here.with(doubts.get(i).copied().flatten());
        if let Some((_, i)) = nearest {
            let prior = prior(i);
            if let Some(found) = self.kept.get(i).and_then(|frame| frame.place(flat, middle, &prior, 0.0)) {
                self.join(camera, told, i, &found, &prior);
                self.active = Some(i);
                return found.place;
            }
        }
        let (mut camera, mut told) = (camera, told);
        if let Some((i, found)) = self.closed(flat, middle, camera, &prior) {
            let prior = prior(i);
            self.join(camera, told, i, &found, &prior);
            self.active = Some(i);
            (camera, told) = (found.place, found.information.minus(prior.information));
        }
        self.keep(Keyframe::of(flat, middle, camera), told);
        camera
    }

    /// Keeps a new keyframe, which is chosen then; a window that is nearly empty is none. `told` is what it tells of its place seen from the
    /// one chosen before.
    fn keep(&mut self, frame: Keyframe, told: Information) {
        if frame.places.len() < LEAST_KEPT {
            self.active = None;
            return;
        }
        if self.kept.len() == MOST_KEYFRAMES {
            // The oldest ones are the farthest, most likely.
            let old = self.kept.drain(..MOST_KEYFRAMES / 2).len();
            self.poses.forget(old);
            self.first = self.number_of(old);
            self.active = self.active.and_then(|i| i.checked_sub(old));
        }
        let new = self.kept.len();
        // After a way without lines, from the one before.
        let from = self.active.or(new.checked_sub(1));
        if let Some((i, before)) = from.and_then(|i| Some((i, self.kept.get(i)?.camera))) {
            let (way, told) = (frame.camera - before, told.plus(moved(frame.camera.distance(before))));
            self.poses.add([i, new], way, told);
        }
        self.kept.push(frame);
        self.active = Some(new);
    }

    /// Number of the keyframe that was chosen last.
    pub(super) fn number(&self) -> u32 {
        self.number_of(self.active.unwrap_or(self.kept.len().saturating_sub(1)))
    }

    fn number_of(&self, i: usize) -> u32 {
        self.first.saturating_add(u32::try_from(i).unwrap_or(u32::MAX))
    }

    /// Settles the places of all keyframes, if two of them did not agree.
    pub(super) fn settled(&mut self) -> Option<Shifts> {
        if !core::mem::take(&mut self.is_unsettled) {
            return None;
        }
        let places: Vec<PxPoint> = self.kept.iter().map(|frame| frame.camera).collect();
        let px = self.poses.shifts(&places);
        for (frame, shift) in self.kept.iter_mut().zip(&px) {
            frame.camera += *shift;
        }
        Some(Shifts { first: self.first, px })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::{CameraSettings, Paper, SimulatedCamera};

    fn line(from: (f64, f64), to: (f64, f64)) -> (Vec<PxPoint>, f64) {
        (vec![PxPoint::new(from.0, from.1), PxPoint::new(to.0, to.1)], 4.0)
    }

    /// The prior's standard deviation is 1 px in both axes.
    fn found(strokes: &[(Vec<PxPoint>, f64)], moved: PxVec) -> Option<Prior> {
        let paper = Paper::drawn(300, 300, strokes).unwrap();
        let settings = CameraSettings { width_px: 200, height_px: 200, ..CameraSettings::default() };
        let mut camera = SimulatedCamera::new(&paper, settings);
        let (at, middle) = (PxPoint::new(150.0, 150.0), PxPoint::new(100.0, 100.0));
        let mut flat = |at: PxPoint| Flat::of(&camera.window(at), None, None);
        let frame = Keyframe::of(&flat(at), middle, at);
        let next = flat(at + moved);
        frame.place(&next, middle, &Prior { place: at, information: Information::of_axes([1.0; 2]) }, 0.0)
    }

    /// Twelve lines of 4 px with 4 px between them: nothing but their ends tells the way along them.
    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn the_ends_of_hatching_tell_the_way_along_it() {
        let hatch: Vec<_> =
            (0..12).map(|i| 90.4 + 8.0 * f64::from(i)).map(|x| line((x, 300.1), (x + 60.0, 560.6))).collect();
        let paper = Paper::drawn(520, 620, &hatch).unwrap();
        let middle = PxPoint::new(150.0, 150.0);
        let mut squares = 0.0;
        for seed in 0..10_u8 {
            let way = f64::from(seed);
            let settings = CameraSettings { seed: seed.into(), ..CameraSettings::default() };
            let mut camera = SimulatedCamera::new(&paper, settings);
            let from = PxPoint::new(165.0 + 1.5 * way, 320.0 + 4.5 * way);
            let to = from + PxVec::new(-0.224, -0.974) * (5.0 + 4.0 * way);
            let frame = Keyframe::of(&Flat::of(&camera.window(from), None, None), middle, from);
            let flat = Flat::of(&camera.window(to), None, None);
            let prior =
                Prior { place: to + PxVec::new(-0.3, 0.35), information: Information::of_axes([0.5; 2]) };
            let PxVec { x, y } = frame.place(&flat, middle, &prior, 0.0).unwrap().place - to;
            let along = 0.224 * x + 0.974 * y;
            assert!(along.abs() < 0.25 && (0.974 * x - 0.224 * y).abs() < 0.06, "{seed}: {x} {y}");
            squares += along * along;
        }
        assert!(squares < 10.0 * 0.12 * 0.12, "{squares}");
    }

    #[test]
    fn the_end_of_a_line_tells_both_directions() {
        let place = found(&[line((100.0, 150.0), (400.0, 150.0))], PxVec::new(1.7, -1.2)).unwrap().place;
        assert!(place.distance(PxPoint::new(151.7, 148.8)) < 0.1, "{place:?}");
    }

    #[test]
    fn a_line_that_goes_on_tells_one_direction_only() {
        let found = found(&[line((-50.0, 150.0), (400.0, 150.0))], PxVec::new(1.7, -1.2)).unwrap();
        assert!((found.place.y - 148.8).abs() < 0.1 && (found.place.x - 150.0).abs() < 0.1, "{found:?}");
        assert!(found.information.xx < 1.1 && found.information.yy > 100.0, "{found:?}");
    }

    #[test]
    fn of_parallel_lines_the_nearest_is_the_same() {
        let rows = (0..12).map(|i| 100.0 + 8.0 * f64::from(i));
        let lines: Vec<_> = rows.map(|y| line((100.0, y), (200.0, y))).collect();
        let place = found(&lines, PxVec::new(0.0, 2.0)).unwrap().place;
        assert!(place.distance(PxPoint::new(150.0, 152.0)) < 0.1, "{place:?}");
    }
}
