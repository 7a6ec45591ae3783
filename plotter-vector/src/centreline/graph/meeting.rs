//! Where wide lines meet: the place, and which of them go on as one stroke.
//!
//! The junction's place is where the arms, continued from their undisturbed parts, come closest together, each
//! counted by how sure its continuation is there. Where they do not meet in one point (two branches that leave a
//! line opposite each other, a little apart) the lines that go through are bridged and each branch ends on one.

use super::End;
use super::arm::Arm;
use super::connection::{Junctions, Way};
use super::corner::direction;
use super::junction::{ArmOf, bend};
use super::site::{Scan, Site, slack_px, surely_px};
use crate::ink::hairlines::Hairlines;
use crate::stroke::{PxPoint, turn::GOES_ON_COS};
use crate::{PxVec, picture::Pixel};
use std::borrow::Cow;

/// What the raster takes of a pen's disc where lines meet, px.
const RASTER_PX: f64 = 0.6;

/// Where the lines of a junction may go through one point.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Meet {
    /// Nowhere.
    Apart,
    /// Where the ink is as a pen leaves it.
    WherePenWas,
    /// Where there is ink: blur takes some of it away from the outside of a corner.
    InInk,
}

/// The middle of a junction.
#[derive(Clone, Copy)]
pub(super) struct Heart<'a> {
    /// Its first node in reading order.
    pub(super) owner: Pixel,
    /// The middle of its nodes.
    pub(super) centre: PxPoint,
    /// Greatest radius of the ink around one of them, px.
    pub(super) radius_px: f64,
    /// What it is in.
    pub(super) scan: Scan<'a>,
}

impl Heart<'_> {
    /// The two sides of a sharp point: the ink between them is filled near it, so that they seem to be a fork with a
    /// short stem. Whether that is what these arms are, each with its `sites`; then the stem goes and the sides meet in the point.
    pub(super) fn resolve_point<'a>(
        &self,
        arms: &[ArmOf],
        sites: impl Fn(End) -> Cow<'a, [Site]>,
        found: &mut Junctions,
    ) -> bool {
        /// Cosine of the widest angle between the sides of a point.
        const WIDEST_COS: f64 = 0.2;
        /// What an error across the sides is along them, px, from where on the ink's end tells more; and if both agree.
        const UNSURE_PX: f64 = 1.3;
        const AGREE_UNSURE_PX: f64 = 1.8;
        let [a, b, c] = arms else { return false };
        let Some((stem, one, other)) =
            [(a, b, c), (b, c, a), (c, a, b)].into_iter().find(|(stem, one, other)| {
                let (u, v) = (one.arm.direction, other.arm.direction);
                stem.point.is_some() && one.tip.is_none() && other.tip.is_none() && u.dot(v) > WIDEST_COS
            })
        else {
            return false;
        };
        let Some(tip) = stem.point else { return false };
        let sides = [*one, *other];
        let meeting = meeting_point(&sides, self.centre);
        let slack_px = (0.35 * one.arm.width_px).max(1.2);
        let beyond = meeting.distance(self.centre) > tip.distance(self.centre) + slack_px;
        let meets = beyond || meeting.distance(tip) <= slack_px;
        let least_px = if meets { AGREE_UNSURE_PX } else { UNSURE_PX };
        let point = if let Some(point) = self.acute_point(stem, [one, other], tip, &sites(stem.end), least_px)
        {
            point
        } else if meets && stem.tip.is_some() {
            if !beyond && self.pen_was_at(meeting, &sides) { meeting } else { tip }
        } else {
            return false;
        };
        found.pair(self.owner, one, other, vec![point]);
        found.drop_line(stem.end);
        true
    }

    /// The point of two sides at so acute an angle that they do not tell where along the ink between them they meet: half a width
    /// before its end, if that ink is filled to there; a stem that is a line is as narrow as the sides. `filled` are its sites.
    fn acute_point(
        &self,
        stem: &ArmOf,
        [one, other]: [&ArmOf; 2],
        tip: PxPoint,
        filled: &[Site],
        least_px: f64,
    ) -> Option<PxPoint> {
        /// Least width in the middle of the filled ink, in those of a side: it goes from two to one.
        const FILLED: f64 = 1.3;
        /// A stem of fewer px has no direction of its own.
        const DIRECTED_PX: f64 = 6.0;
        /// How far beside the line on which the point is thinning may end, px.
        const OFF_PX: f64 = 1.5;
        let (u, v) = (one.arm.direction, other.arm.direction);
        let into = direction(PxPoint::new(u.x + v.x, u.y + v.y), PxPoint::default())?;
        let half_sine = 0.5 * libm::hypot(u.x - v.x, u.y - v.y);
        let error_px = |side: &ArmOf| side.arm.error_px(side.arm.along(tip).min(0.0));
        let unsure_px = error_px(one).max(error_px(other)) * (1.0 / half_sine.max(0.01) - 1.0);
        let width_px = 0.5 * (one.arm.width_px + other.arm.width_px);
        let middle = filled.get(filled.len() / 4..filled.len() - filled.len() / 4)?;
        #[expect(clippy::cast_precision_loss, reason = "a few hundred sites")]
        let count = middle.len() as f64;
        let filled_px = middle.iter().map(|site| site.width_px).sum::<f64>() / count;
        if unsure_px < least_px || filled_px.is_nan() || filled_px < FILLED * width_px {
            return None;
        }
        let (origin, into) = if stem.arm.support_px >= DIRECTED_PX {
            (stem.arm.origin, stem.arm.direction)
        } else {
            (meeting_point(&[*one, *other], self.centre), into)
        };
        let PxVec { x, y } = tip - origin;
        if (y * into.x - x * into.y).abs() > OFF_PX {
            return None;
        }
        let PxVec { x, y } = self.centre - origin;
        let foot = origin + into * (x * into.x + y * into.y);
        let longest_px = foot.distance(tip) + width_px + 4.0;
        let reach_px = self.scan.reach_px(foot, into, longest_px);
        Some(foot + into * ((reach_px - 0.5 * width_px).max(0.0)))
    }

    /// How lines that meet go on, from the course of each where it is undisturbed: through one point if they agree on
    /// it and may, else each pair on a smooth curve.
    pub(super) fn plan(&self, arms: &[ArmOf], meet: Meet) -> Vec<Way> {
        let mut ways = Vec::new();
        let meeting = meeting_point(arms, self.centre);
        let along = |one: &ArmOf| one.arm.along(meeting).min(0.0);
        let tolerance_px = |one: &ArmOf| slack_px(one.arm.width_px) + 2.0 * one.arm.error_px(along(one));
        let near = if meet == Meet::InInk {
            let off_px = meeting.distance(self.centre);
            off_px <= 2.0 * self.radius_px && self.scan.is_ink_around(meeting)
        } else {
            self.pen_was_at(meeting, arms)
        };
        let concurrent = meet != Meet::Apart
            && near
            && arms.iter().all(|one| {
                let off_px = one.arm.at(one.arm.along(meeting)).distance(meeting);
                one.arm.support_px <= 0.0 || off_px <= tolerance_px(one)
            });
        let pairs = partners(arms, |one, other| {
            let (a, b) = (one.arm.direction_at(along(one)), other.arm.direction_at(along(other)));
            let straight = -a.dot(b);
            straight.min(self.in_line(&one.arm, &other.arm))
        });
        for (first, second) in &pairs {
            let (Some(one), Some(other)) = (arms.get(*first), arms.get(*second)) else { continue };
            let points = if concurrent {
                vec![meeting]
            } else if bend(&one.arm, &other.arm) < 1.0 {
                bridge(&one.arm, &other.arm)
            } else {
                // A smooth curve makes sense only where both arms look at each other.
                vec![self.centre]
            };
            ways.push(Way { one: *one, other: Some(*other), points });
        }
        let place = if near { meeting } else { self.centre };
        let ends = self.ends(arms, &pairs, &ways, place, concurrent);
        ways.extend(ends);
        ways
    }

    /// How far two arms of thin lines lie in one line, as the cosine of the bend between them; where several lines cross some go the
    /// same way beside each other. The raster puts each off by half a pixel.
    fn in_line(&self, one: &Arm, other: &Arm) -> f64 {
        /// Nearer origins lie in no direction from each other, px.
        const APART_PX: f64 = 2.0;
        let apart_px = one.origin.distance(other.origin);
        if self.scan.hairlines != Hairlines::Pen || apart_px <= APART_PX {
            return 1.0;
        }
        libm::cos((bend(one, other) - libm::atan2(1.0, apart_px)).max(0.0))
    }

    /// How lines go on that bend so much within the junction that their arms do not look like one line: `pairs` of them on
    /// smooth curves, the others up to these.
    pub(super) fn curves(&self, arms: &[ArmOf], pairs: &[(usize, usize)]) -> Vec<Way> {
        let pair = |(first, second): &(usize, usize)| {
            let (one, other) = (arms.get(*first)?, arms.get(*second)?);
            Some(Way { one: *one, other: Some(*other), points: bridge(&one.arm, &other.arm) })
        };
        let mut ways: Vec<Way> = pairs.iter().filter_map(pair).collect();
        let ends = self.ends(arms, pairs, &ways, self.centre, false);
        ways.extend(ends);
        ways
    }

    /// Where the arms that are in none of the pairs end: at `place`, or, unless all lines meet there, where they come to
    /// one of the ways of the pairs.
    fn ends(
        &self,
        arms: &[ArmOf],
        pairs: &[(usize, usize)],
        ways: &[Way],
        place: PxPoint,
        all_meet: bool,
    ) -> Vec<Way> {
        let single = |index: usize| pairs.iter().all(|(a, b)| *a != index && *b != index);
        let onto = |one: &ArmOf| {
            ways.iter()
                .filter_map(|way| foot(&one.arm, &way.points))
                .min_by(|a, b| a.distance(self.centre).total_cmp(&b.distance(self.centre)))
        };
        let end = |(_, one): (usize, &ArmOf)| {
            let onto = if all_meet { None } else { onto(one) };
            Way { one: *one, other: None, points: vec![onto.unwrap_or(place)] }
        };
        arms.iter().enumerate().filter(|(index, _)| single(*index)).map(end).collect()
    }

    /// Whether a meeting point far from the junction's middle has ink around it as a pen leaves it.
    fn pen_was_at(&self, place: PxPoint, arms: &[ArmOf]) -> bool {
        let half_px = 0.5 * arms.iter().map(|one| one.arm.width_px).fold(f64::INFINITY, f64::min);
        let off_px = place.distance(self.centre);
        off_px <= 0.5 * self.radius_px + 0.5
            || off_px <= 6.0 * self.radius_px + 2.0
                && self.scan.pen_was_at(place, surely_px(half_px, RASTER_PX))
    }
}

/// Pairs of arms by a score from -1 to 1, the highest first, none below that of a 50° turn.
pub(super) fn partners(arms: &[ArmOf], score: impl Fn(&ArmOf, &ArmOf) -> f64) -> Vec<(usize, usize)> {
    /// More lines than meet in any drawing: beyond, on noise, the rest stays unpaired.
    const MOST: usize = 24;
    let mut scores = Vec::new();
    for (i, one) in arms.iter().enumerate().take(MOST) {
        for (j, other) in arms.iter().enumerate().take(MOST).skip(i + 1) {
            let score = score(one, other);
            if score > GOES_ON_COS {
                scores.push((score, i, j));
            }
        }
    }
    scores.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    for (_, i, j) in scores {
        if pairs.iter().all(|(a, b)| ![*a, *b].contains(&i) && ![*a, *b].contains(&j)) {
            pairs.push((i, j));
        }
    }
    pairs
}

/// The place with the least weighted squared distance from the arms' continuations, by Gauss and Newton; drawn a
/// little towards `centre`, which decides where the arms say nothing (all of one direction).
fn meeting_point(arms: &[ArmOf], centre: PxPoint) -> PxPoint {
    const STEPS: usize = 5;
    /// Weight of the centre, as that of an arm with an error of 8 px.
    const PRIOR: f64 = 1.0 / 64.0;
    let mut place = centre;
    for _ in 0..STEPS {
        let (mut xx, mut xy, mut yy) = (PRIOR, 0.0, PRIOR);
        let (mut x, mut y) = (PRIOR * (centre.x - place.x), PRIOR * (centre.y - place.y));
        for one in arms {
            let t = one.arm.along(place);
            let error_px = one.arm.error_px(t.min(0.0));
            let weight = if error_px.is_finite() { 1.0 / (error_px * error_px) } else { 0.25 };
            let PxVec { x: dx, y: dy } = one.arm.direction_at(t);
            let nearest = one.arm.at(t);
            let off = (nearest.x - place.x) * -dy + (nearest.y - place.y) * dx;
            xx += weight * dy * dy;
            xy -= weight * dx * dy;
            yy += weight * dx * dx;
            x -= weight * dy * off;
            y += weight * dx * off;
        }
        let determinant = xx * yy - xy * xy;
        if determinant <= 0.0 {
            break;
        }
        let step = ((x * yy - y * xy) / determinant, (y * xx - x * xy) / determinant);
        place = PxPoint::new(place.x + step.0, place.y + step.1);
    }
    place
}

/// Places about a pixel apart on the smooth curve from one arm's origin to the other's: Hermite's cubic.
fn bridge(from: &Arm, to: &Arm) -> Vec<PxPoint> {
    let length = from.origin.distance(to.origin);
    let (out, back) = (from.direction, to.direction);
    let steps = libm::ceil(length.clamp(1.0, 200.0));
    let mut places = Vec::new();
    let mut step = 1.0;
    while step < steps {
        let t = step / steps;
        let (t2, t3) = (t * t, t * t * t);
        let (h00, h10, h01, h11) =
            (2.0 * t3 - 3.0 * t2 + 1.0, t3 - 2.0 * t2 + t, 3.0 * t2 - 2.0 * t3, t3 - t2);
        places.push(PxPoint::new(
            h00 * from.origin.x - h10 * length * out.x + h01 * to.origin.x + h11 * length * back.x,
            h00 * from.origin.y - h10 * length * out.y + h01 * to.origin.y + h11 * length * back.y,
        ));
        step += 1.0;
    }
    places
}

/// Where an arm, continued into the junction, meets a bridge.
fn foot(arm: &Arm, bridge: &[PxPoint]) -> Option<PxPoint> {
    let side = |place: &PxPoint| {
        let on = arm.at(arm.along(*place));
        let PxVec { x: dx, y: dy } = arm.direction;
        (place.x - on.x) * -dy + (place.y - on.y) * dx
    };
    bridge.iter().zip(bridge.iter().skip(1)).find_map(|(from, to)| {
        let (a, b) = (side(from), side(to));
        (a * b <= 0.0 && a != b).then(|| {
            let t = a / (a - b);
            PxPoint::new(from.x + (to.x - from.x) * t, from.y + (to.y - from.y) * t)
        })
    })
}
