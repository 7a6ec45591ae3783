//! Short lines at a junction that nothing needs: the corner of a flat end, a hair, what blur fills.

use super::junction::{ArmOf, Lines, Plan, as_one, is_sure};
use super::meeting::{Heart, Meet};
use super::site::Site;
use super::trial::Trial;
use crate::centreline::fit::prices::STROKE_PX2;
use crate::stroke::PxPoint;
use std::borrow::Cow;

impl Lines<'_> {
    /// The arms without a short one whose ink the pens of the others leave nearly as well, given what all of
    /// them cost.
    pub(super) fn without_short(
        &self,
        heart: &Heart<'_>,
        arms: &[ArmOf],
        sites: &[Cow<'_, [Site]>],
        trial: &Trial<'_>,
        cost: f64,
    ) -> Option<Plan> {
        if arms.len() < 3 {
            return None;
        }
        // No farther out than the widest line is wide: two curves that end in one tip leave little ink there,
        // and go on.
        let widest_px = arms.iter().map(|one| one.arm.width_px).fold(0.0, f64::max);
        let is_hair = |tip: PxPoint| tip.distance(heart.centre) <= widest_px;
        let is_short = |(_, one): &(usize, &ArmOf)| one.tip.is_some_and(is_hair) && !is_sure(one);
        for (index, short) in arms.iter().enumerate().filter(is_short) {
            let (mut arms, mut sites) = (arms.to_vec(), sites.to_vec());
            arms.remove(index);
            sites.remove(index);
            let Some(rest) = Trial::within(self.scan, heart.centre, trial.radius_px(), &arms, &sites) else {
                continue;
            };
            let ways = as_one(heart.plan(&arms, Meet::WherePenWas));
            let least = rest.cost(&ways, f64::INFINITY).unwrap_or(f64::INFINITY);
            let (ways, least) = rest.settle(ways, least);
            if least <= cost + STROKE_PX2 {
                return Some(Plan { ways, dropped: Some(short.end) });
            }
        }
        None
    }
}
