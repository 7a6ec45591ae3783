//! The floor plan of a flat: walls, doors, dimensions.

use super::{sheet, word};
use crate::corpus::Picture;
use crate::corpus::random::Random;
use crate::corpus::strokes::{At, arc};
use core::f64::consts::FRAC_PI_2;

/// Smallest room, px: it must hold a door, its swing and a word.
const ROOM_PX: f64 = 210.0;
/// Least distance of a door from the next wall, px.
const JAMB_PX: f64 = 28.0;

#[derive(Clone, Copy)]
struct Room {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

/// Walls that end on another from both sides are at least so far apart, px: nearer, they would be one line
/// with a step.
const APART_PX: f64 = 40.0;

/// A door's gap: its ends.
type Gap = (At, At);

/// What a further wall must keep clear of.
#[derive(Default)]
struct Taken {
    gaps: Vec<Gap>,
    ends: Vec<At>,
}

pub(super) fn plan(random: &mut Random) -> Picture {
    let (broad, thin) = (random.between(4.5, 7.0), random.between(2.0, 3.2));
    let mut picture = sheet("plan", broad);
    let house = Room {
        left: random.between(130.0, 190.0),
        top: random.between(130.0, 210.0),
        right: random.between(860.0, 930.0),
        bottom: random.between(1100.0, 1230.0),
    };
    picture.rectangle((house.left, house.top), (house.right, house.bottom));
    let (mut taken, mut rooms) = (Taken::default(), Vec::new());
    split(house, 3, random, &mut picture, &mut taken, &mut rooms);
    picture.pen(thin);
    for gap in &taken.gaps {
        door(*gap, random, &mut picture);
    }
    let stairs = random.below(u32::try_from(rooms.len()).unwrap_or(1));
    for (number, room) in (0_u32..).zip(&rooms) {
        if number == stairs {
            flight(room, random, &mut picture);
        } else {
            let high = random.between(28.0, 34.0);
            let name = if room.right - room.left > 300.0 { word(random) } else { "ROOM" };
            picture.text((room.left + 36.0, room.bottom - 84.0), high, 0.0, name);
        }
    }
    dimensions(&house, random, &mut picture);
    picture
}

fn split(
    room: Room,
    depth: u32,
    random: &mut Random,
    picture: &mut Picture,
    taken: &mut Taken,
    rooms: &mut Vec<Room>,
) {
    let (wide, high) = (room.right - room.left, room.bottom - room.top);
    let upright = wide > high;
    let length = wide.max(high);
    let (low, top) = if upright { (room.top, room.bottom) } else { (room.left, room.right) };
    let point = |at: f64, along: f64| if upright { (at, along) } else { (along, at) };
    let clear = |at: f64, taken: &Taken| {
        // The wall must not end in a door, nor beside another wall's end.
        let no_door = taken.gaps.iter().all(|(from, to)| {
            let in_walls = if upright {
                (from.1 - to.1).abs() < 1.0 && [room.top, room.bottom].contains(&from.1)
            } else {
                (from.0 - to.0).abs() < 1.0 && [room.left, room.right].contains(&from.0)
            };
            let (low, top) = if upright { (from.0, to.0) } else { (from.1, to.1) };
            !in_walls || at < low - JAMB_PX || at > top + JAMB_PX
        });
        no_door
            && [low, top]
                .map(|along| point(at, along))
                .iter()
                .all(|new| taken.ends.iter().all(|old| libm::hypot(new.0 - old.0, new.1 - old.1) >= APART_PX))
    };
    let start = if upright { room.left } else { room.top };
    let place = (0..20)
        .map(|_| start + length * random.between(0.35, 0.65))
        .find(|at| at - start >= ROOM_PX && start + length - at >= ROOM_PX && clear(*at, taken));
    let Some(at) = place.filter(|_| depth > 0) else {
        rooms.push(room);
        return;
    };
    let width = random.between(72.0, 92.0);
    let from = random.between(low + JAMB_PX, top - JAMB_PX - width);
    picture.line(&[point(at, low), point(at, from)]);
    picture.line(&[point(at, from + width), point(at, top)]);
    taken.gaps.push((point(at, from), point(at, from + width)));
    taken.ends.extend([point(at, low), point(at, top)]);
    let (one, other) = if upright {
        (Room { right: at, ..room }, Room { left: at, ..room })
    } else {
        (Room { bottom: at, ..room }, Room { top: at, ..room })
    };
    split(one, depth - 1, random, picture, taken, rooms);
    split(other, depth - 1, random, picture, taken, rooms);
}

/// The open leaf and its way.
fn door((from, to): Gap, random: &mut Random, picture: &mut Picture) {
    let (hinge, latch) = if random.chance(0.5) { (from, to) } else { (to, from) };
    let shut = libm::atan2(latch.1 - hinge.1, latch.0 - hinge.0);
    let open = shut + if random.chance(0.5) { FRAC_PI_2 } else { -FRAC_PI_2 };
    let way = arc(hinge, libm::hypot(latch.0 - hinge.0, latch.1 - hinge.1), open, shut);
    picture.line(&[&[hinge], way.as_slice()].concat());
}

/// Steps of a stair along a room's upper wall.
fn flight(room: &Room, random: &mut Random, picture: &mut Picture) {
    let pitch = random.between(20.0, 26.0);
    let (left, top) = (room.left + 40.0, room.top + 34.0);
    let deep = (room.bottom - room.top - 120.0).min(90.0);
    let mut x = left;
    while x < room.right - 60.0 && x < left + 12.0 * pitch {
        picture.line(&[(x, top), (x, top + deep)]);
        x += pitch;
    }
    let end = x - pitch;
    picture.line(&[(left, top), (end, top)]);
    picture.line(&[(left, top + deep), (end, top + deep)]);
}

/// A dimension line with oblique ticks above the house, and one beside it.
fn dimensions(house: &Room, random: &mut Random, picture: &mut Picture) {
    let high = random.between(26.0, 32.0);
    let off = random.between(46.0, 60.0);
    let middle = random.between(0.4, 0.6);
    let y = house.top - off;
    let across = [house.left, house.left + middle * (house.right - house.left), house.right];
    picture.line(&[(house.left - 12.0, y), (house.right + 12.0, y)]);
    for x in across {
        picture.line(&[(x, y - 16.0), (x, y + 20.0)]);
    }
    for pair in across.windows(2) {
        let number = format!("{:.0}", (pair[1] - pair[0]) * 1.25);
        picture.text((f64::midpoint(pair[0], pair[1]) - high, y - high - 12.0), high, 0.0, &number);
    }
    let x = house.left - off;
    picture.line(&[(x, house.top - 10.0), (x, house.bottom + 10.0)]);
    for y in [house.top, house.bottom] {
        picture.line(&[(x - 11.0, y + 11.0), (x + 11.0, y - 11.0)]);
    }
    let number = format!("{:.0}", (house.bottom - house.top) * 1.25);
    let middle = f64::midpoint(house.top, house.bottom);
    picture.text((x - high - 12.0, middle + high), high, -FRAC_PI_2, &number);
    picture.text((house.left, house.bottom + 44.0), 1.3 * high, 0.0, &format!("{} 1:50", word(random)));
}
