//! [`aligned`]: a line that a window shows beside its place in the map is moved to where it is.
//!
//! Along a straight line nothing tells how far the camera went; so where a loop closes, a line may be seen some pixels beside where
//! the map has it. There is no ink at the map's place then, and a line beside it that the map does not have: it is the same one.

use super::flat::Flat;
use super::line_map::{LineMap, State};
use super::lines::{Piece, cosine};
use super::paper::nearest;
use crate::stroke::PxPoint;

/// Farther than this a line is another one, px.
const FARTHEST_PX: f64 = 7.0;

/// Lines whose directions differ by more are not the same: cosine of 30 degrees.
const SAME_COS: f64 = 0.866;

/// Less than this share of a line's darkness is no line.
const VACANT: f32 = 0.45;

/// Moves nodes without ink to the pieces beside them that have no nodes; all places are on the paper but for those of the window,
/// whose middle is at `camera`.
pub(super) fn aligned(
    map: &mut LineMap,
    flat: &Flat,
    pieces: &[Piece],
    middle: PxPoint,
    camera: PxPoint,
    margin_px: f64,
) {
    let dark_at = |at: PxPoint| flat.at(middle + (at - camera));
    let mut darks: Vec<f32> =
        pieces.iter().flat_map(|piece| &piece.places).step_by(7).map(|at| dark_at(*at)).collect();
    darks.sort_by(f32::total_cmp);
    let Some(typical) = darks.get(darks.len() / 2).copied() else { return };
    let near = map.near(camera, libm::hypot(middle.x, middle.y));
    let inside = |id: &u32| flat.holds(middle + (map.at(*id) - camera), margin_px + 2.0);
    let vacant: Vec<u32> =
        near.into_iter().filter(inside).filter(|id| dark_at(map.at(*id)) < VACANT * typical).collect();
    let mut moves = Vec::new();
    for id in vacant {
        let Some(direction) =
            map.direction(id).filter(|_| map.links_of(id).any(|(_, link, _)| link.state != State::Ghost))
        else {
            continue;
        };
        let at = map.at(id);
        let beside = pieces.iter().flat_map(|piece| piece.places.windows(2)).filter_map(|pair| {
            let [a, b] = pair else { return None };
            if a.distance(at) > FARTHEST_PX + 3.0 || cosine(*b - *a, direction).abs() < SAME_COS {
                return None;
            }
            let foot = nearest(at, *a, *b);
            Some((foot.distance(at), foot))
        });
        let Some((distance, to)) = beside.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        let is_taken = |other: &u32| {
            dark_at(map.at(*other)) >= VACANT * typical
                && map.direction(*other).is_some_and(|way| cosine(way, direction).abs() > SAME_COS)
        };
        if distance <= FARTHEST_PX && !map.near(to, 2.0).iter().any(is_taken) {
            moves.push((id, to));
        }
    }
    // A few nodes are noise, many a line.
    if moves.len() >= 3 {
        moves.into_iter().for_each(|(id, to)| map.shift(id, to));
    }
}
