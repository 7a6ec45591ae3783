//! Laws of the fit of a sheet to many crossings.

use plotter_motion::{Axis, Point, Vec2};
use plotter_stitch::{
    Crossing, FindLine, FitError, FrameTransform, MarkGroup, Optics, ReferenceLines, RigidFit,
    sense::{BothEdges, Found, PublishedRule, Tact},
};
use proptest::prelude::*;

/// Rounding in some thousand operations on coordinates up to 1 m, mm.
const ROUNDING_MM: f64 = 1e-9;

/// Greatest distance of two poses over a frame of 2000 x 1000 mm, mm: it lies at a corner.
fn apart_mm(one: &FrameTransform, other: &FrameTransform) -> f64 {
    [(0.0, 0.0), (2000.0, 0.0), (0.0, 1000.0), (2000.0, 1000.0)]
        .map(|(x, y)| one.to_machine(Point::new(x, y)).distance(other.to_machine(Point::new(x, y))))
        .into_iter()
        .fold(0.0, f64::max)
}

fn sheets() -> impl Strategy<Value = FrameTransform> {
    (-0.005..=0.005_f64, -8.0..=8.0_f64, -8.0..=8.0_f64)
        .prop_filter_map("finite", |(angle_rad, x, y)| FrameTransform::new(angle_rad, Vec2::new(x, y)).ok())
}

fn layouts() -> impl Strategy<Value = Vec<Crossing>> {
    prop_oneof![
        Just(ReferenceLines::strip16()),
        Just(ReferenceLines::strip24()),
        Just(ReferenceLines::strip32())
    ]
    .prop_map(|lines| lines.crossings().collect())
}

fn exact(crossings: &[Crossing], sheet: &FrameTransform) -> Vec<Found> {
    let found =
        |(crossing, mark): (usize, &Crossing)| Found { crossing, at_mm: mark.place_mm(sheet), sigma_mm: 0.0 };
    crossings.iter().enumerate().map(found).collect()
}

/// Any number, the odd ones too.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(0.0),
        Just(1e6),
        -1000.0..1000.0_f64,
        -1.0..1.0_f64
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn exact_crossings_tell_the_exact_sheet(sheet in sheets(), crossings in layouts()) {
        let estimate = RigidFit::default().estimate(&crossings, &exact(&crossings, &sheet)).unwrap();
        prop_assert!(apart_mm(&sheet, &estimate.transform) < ROUNDING_MM);
        prop_assert_eq!(estimate.inlier_count() as usize, crossings.len());
    }

    /// Up to four of sixteen wrong by anything, two of them along each axis: what is told is what the others
    /// tell.
    #[test]
    fn outliers_change_nothing(
        sheet in sheets(),
        wrong_x in prop::collection::vec((0_usize..10, prop_oneof![-12.0..-1.0_f64, 1.0..12.0_f64]), 0..=2),
        wrong_y in prop::collection::vec((10_usize..16, prop_oneof![-12.0..-1.0_f64, 1.0..12.0_f64]), 0..=2),
        missed in prop::collection::vec(0_usize..10, 0..=2),
    ) {
        let crossings: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
        let mut found = exact(&crossings, &sheet);
        for (index, by_mm) in wrong_x.into_iter().chain(wrong_y) {
            found[index].at_mm = crossings[index].place_mm(&sheet) + by_mm;
        }
        found.retain(|place| !missed.contains(&place.crossing));
        match RigidFit::default().estimate(&crossings, &found) {
            Ok(estimate) => prop_assert!(apart_mm(&sheet, &estimate.transform) < ROUNDING_MM),
            // Four gone at once may leave too little to check the rest, or to tell swelling; two that are
            // wrong alike may be the marks.
            Err(error) => prop_assert!(
                matches!(
                    error,
                    FitError::Unchecked { .. }
                        | FitError::Unsure { .. }
                        | FitError::Shrunk { .. }
                        | FitError::Ambiguous { .. }
                        | FitError::Strokes { .. }
                        | FitError::Swollen { .. }
                ),
                "{error}"
            ),
        }
    }

    /// A grain of dust seen besides a mark never takes its place.
    #[test]
    fn of_two_places_at_a_crossing_the_mark_is_taken(sheet in sheets(), at in 0_usize..16, by_mm in 0.5..10.0_f64) {
        let crossings: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
        let mut found = exact(&crossings, &sheet);
        found.insert(0, Found { crossing: at, at_mm: found[at].at_mm + by_mm, sigma_mm: 0.0 });
        let estimate = RigidFit::default().estimate(&crossings, &found).unwrap();
        prop_assert!(apart_mm(&sheet, &estimate.transform) < ROUNDING_MM);
        prop_assert_eq!(estimate.inliers, 0x1_fffe);
    }

    /// The order in which places are given means nothing.
    #[test]
    fn the_order_does_not_matter(sheet in sheets(), noise in prop::collection::vec(-0.04..0.04_f64, 16), turn in 0_usize..16) {
        let crossings: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
        let mut found = exact(&crossings, &sheet);
        for (place, noise) in found.iter_mut().zip(noise) {
            place.at_mm += noise;
        }
        let one = RigidFit::default().estimate(&crossings, &found).unwrap();
        found.rotate_left(turn);
        let other = RigidFit::default().estimate(&crossings, &found).unwrap();
        prop_assert!(apart_mm(&one.transform, &other.transform) < ROUNDING_MM);
        // Swelling and bow are told in single precision: a millionth of a tenth of a millimetre, a few times.
        let place = Point::new(20.0, 250.0);
        prop_assert!(one.to_machine(place).distance(other.to_machine(place)) < 1e-6);
    }

    /// Any numbers at all: finite ones come out, or an error that says something.
    #[test]
    fn no_places_panic(
        crossings in prop::collection::vec((any::<bool>(), any_number(), any_number()), 0..20),
        places in prop::collection::vec((0_usize..20, any_number(), any_number()), 0..70),
    ) {
        let crossings: Vec<Crossing> = crossings
            .into_iter()
            .map(|(x, mark_mm, scan_at_mm)| Crossing { axis: if x { Axis::X } else { Axis::Y }, mark_mm, scan_at_mm })
            .collect();
        let found: Vec<Found> =
            places.into_iter().map(|(crossing, at_mm, sigma_mm)| Found { crossing, at_mm, sigma_mm }).collect();
        match RigidFit::default().estimate(&crossings, &found) {
            Ok(estimate) => {
                prop_assert!(estimate.transform.to_machine(Point::new(100.0, 100.0)).is_finite());
                prop_assert!(estimate.covariance.iter().flatten().all(|value| value.is_finite()));
                prop_assert!(estimate.sigma_angle_rad() >= 0.0 && estimate.scale.is_finite());
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }

    /// Any tacts at all: finite sightings, or an error.
    #[test]
    fn no_tacts_panic(
        velocity_mm_s in any_number(),
        tacts in prop::collection::vec((any_number(), 0_u8..4, prop::option::of((any_number(), any_number()))), 0..50),
    ) {
        let optics = Optics::default();
        let detectors: [&mut dyn FindLine; 2] =
            [&mut BothEdges::new(&optics, velocity_mm_s), &mut PublishedRule::new(&optics, velocity_mm_s)];
        for detector in detectors {
            let mut sightings = Vec::new();
            for &(position_mm, hits, covered) in &tacts {
                let covered = covered.map(|(a, b)| [a, b]);
                match detector.push(Tact { position_mm, hits, covered }) {
                    Ok(sighting) => sightings.extend(sighting),
                    Err(error) => prop_assert!(!error.to_string().is_empty()),
                }
            }
            sightings.extend(detector.finish());
            if velocity_mm_s.abs() < 1e9 {
                prop_assert!(sightings.iter().all(|sighting| sighting.at_mm.is_finite()));
            }
        }
    }
}

#[test]
fn what_cannot_be_told_is_refused_with_a_reason() {
    let crossings: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
    let sheet = FrameTransform::new(0.001, Vec2::new(1.0, -2.0)).unwrap();
    let all = exact(&crossings, &sheet);
    let refused =
        |found: Vec<Found>| RigidFit::default().estimate(&crossings, &found).unwrap_err().to_string();
    let only = |wanted: &[usize]| wanted.iter().map(|&index| all[index]).collect::<Vec<_>>();
    assert_eq!(
        refused(only(&[3, 8, 10, 11])),
        "only 4 crossings found a line, at least 6 are needed; look whether the marks were drawn and the sensor is clean"
    );
    assert_eq!(
        refused(only(&[0, 1, 2, 3, 4, 5, 6, 7])),
        "the 8 crossings that agree do not tell shift and rotation; marks along both axes and far apart are needed"
    );
    // One mark of constant y: nothing would show that it is dust.
    assert_eq!(
        refused(only(&[0, 1, 2, 3, 4, 5, 6, 10])),
        "nothing checks crossing 10, and without it the joint is not known; scan more marks"
    );
    let mut wild = all.clone();
    for (index, place) in wild.iter_mut().enumerate() {
        place.at_mm += (index * index % 7) as f64;
    }
    assert_eq!(
        refused(wild),
        "along y only 4 of 10 found places agree with the others, more than half are needed; look for dust"
    );
    let mut broken = all.clone();
    broken[5].at_mm = f64::NAN;
    assert_eq!(refused(broken), "crossing 5: NaN is no place or deviation on a machine; scan it again");
    let turned = FrameTransform::new(0.02, Vec2::new(1.0, -2.0)).unwrap();
    assert!(RigidFit::default().estimate(&crossings, &exact(&crossings, &turned)).is_err());
}

/// A sheet that swells, bows and is turned, and what is found on it without noise.
struct Warped {
    sheet: FrameTransform,
    joint: [Point; 2],
    swelling: f64,
    bow_mm: f64,
}

impl Warped {
    fn moved(&self, place: Point) -> Point {
        let [from, to] = self.joint;
        let share = (place.x - from.x) / (to.x - from.x);
        // The joint goes along x, to the left of it is up.
        let bow = Vec2::new(0.0, 4.0 * self.bow_mm * share * (1.0 - share));
        self.sheet.to_machine(place + (place - from.lerp(to, 0.5)) * self.swelling + bow)
    }

    fn found(&self, crossings: &[Crossing]) -> Vec<Found> {
        let shift = self.sheet.shift();
        let found = |(crossing, mark): (usize, &Crossing)| {
            let at_mm = match mark.axis {
                Axis::X => self.moved(Point::new(mark.mark_mm, mark.scan_at_mm - shift.y)).x,
                Axis::Y => self.moved(Point::new(mark.scan_at_mm - shift.x, mark.mark_mm)).y,
            };
            Found { crossing, at_mm, sigma_mm: 0.005 }
        };
        crossings.iter().enumerate().map(found).collect()
    }
}

fn warped() -> Warped {
    let sheet = FrameTransform::new(0.0005, Vec2::new(1.0, -2.0)).unwrap();
    Warped { sheet, joint: ReferenceLines::strip16().joint, swelling: 2e-4, bow_mm: -0.15 }
}

/// Swelling and bow that are there are told, with their size, where marks stand along the joint.
#[test]
fn a_sheet_that_swells_and_bows_is_told_so() {
    let mut lines = ReferenceLines::strip16();
    let scans_mm = [-32.0, 500.0, 1_000.0, 1_500.0, 2_032.0];
    lines.marks[0] = MarkGroup { axis: Axis::Y, at_mm: vec![-34.0, 70.0], scans_mm: scans_mm.into() };
    let crossings: Vec<Crossing> = lines.crossings().collect();
    let warped = warped();
    let found = warped.found(&crossings);
    let told = RigidFit::on(&lines).estimate(&crossings, &found).unwrap();
    assert!((told.swelling - warped.swelling).abs() < 2e-5, "{told:?}");
    assert!((told.bow_mm - warped.bow_mm).abs() < 0.01, "{told:?}");
    for x in [10.0, 400.0, 1_000.0, 1_990.0] {
        // What is not quite believed of both, and second-order parts of the turn.
        let place = Point::new(x, 20.0);
        assert!(told.to_machine(place).distance(warped.moved(place)) < 0.012, "{x}");
    }
    let neither = RigidFit { swelling: 0.0, bow_mm: 0.0, ..RigidFit::on(&lines) };
    assert!(neither.estimate(&crossings, &found).map_or(true, |told| told.scale > 2.0));
}

/// Marks beside the field show the swelling. The bow between them they do not: it moves no end of the joint,
/// and stays in the deviation that is told for its middle.
#[test]
fn marks_beside_the_field_tell_how_little_they_know_of_a_bow() {
    let crossings: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
    let warped = warped();
    let told = RigidFit::default().estimate(&crossings, &warped.found(&crossings)).unwrap();
    assert!((told.swelling - warped.swelling).abs() < 2e-5, "{told:?}");
    assert_eq!(told.bow_mm, 0.0);
    for end in warped.joint {
        // 0.15 mm bow the marks, 42 mm beyond the ends, by 0.013 mm.
        assert!(told.to_machine(end).distance(warped.moved(end)) < 0.02, "{told:?}");
        assert!(told.sigma_at_mm(end).y < 0.02, "{told:?}");
    }
    let middle = warped.joint[0].lerp(warped.joint[1], 0.5);
    let sigma_mm = told.sigma_at_mm(middle);
    assert!(sigma_mm.x < 0.02 && (0.1..0.12).contains(&sigma_mm.y), "{sigma_mm:?}");
}

/// Marks nearer to each other may be a fold between them: one of half a millimetre moves an end of the joint
/// by as much as is taken. Marks farther apart are none, and who has looked may say that there is none.
#[test]
fn what_may_be_a_fold_is_refused() {
    let crossings: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
    let told = |swelling: f64, fit: RigidFit| {
        let warped = Warped { swelling, bow_mm: 0.0, ..warped() };
        let told = fit.estimate(&crossings, &warped.found(&crossings))?;
        for end in warped.joint {
            assert!(told.to_machine(end).distance(warped.moved(end)) < 0.01, "{told:?}");
        }
        Ok(told.swelling)
    };
    let error: FitError = told(-3e-4, RigidFit::default()).unwrap_err();
    let FitError::Shrunk { shrunk, effect_mm, most_mm } = error else { panic!("{error}") };
    assert!(
        (3e-4..3.4e-4).contains(&shrunk) && (0.29..0.33).contains(&effect_mm) && most_mm == 0.25,
        "{error}"
    );
    assert!(error.to_string().contains("look at the paper, and measure anew as flat"), "{error}");
    assert!((told(-3e-4, RigidFit { is_flat: true, ..RigidFit::default() }).unwrap() + 3e-4).abs() < 1e-5);
    assert!((told(3e-4, RigidFit::default()).unwrap() - 3e-4).abs() < 1e-5);
}

/// What the default does not know: a stroke beside straight rows may be the marks.
#[test]
fn marks_and_a_copy_of_them_beside_are_refused() {
    let crossings: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
    let mut found = exact(&crossings, &FrameTransform::IDENTITY);
    let copies: Vec<Found> =
        found[..10].iter().map(|place| Found { at_mm: place.at_mm + 3.0, ..*place }).collect();
    found.extend(copies);
    let error = RigidFit::default().estimate(&crossings, &found).unwrap_err();
    assert_eq!(error, FitError::Ambiguous { axis: Axis::Y, crossings: 10 });
    assert_eq!(
        error.to_string(),
        "along y another place of the sheet explains what was seen at 10 crossings besides; keep strokes off the marks, or give \
         the marks a pattern"
    );
    // One crossing where something else was seen says nothing, and neither do two along one axis.
    found.truncate(18);
    assert!(RigidFit::default().estimate(&crossings, &found).is_ok());
    // Two along both axes that lie the same way are another sheet.
    let beside = |index: usize| Found { at_mm: found[index].at_mm + 4.0, ..found[index] };
    found.extend([beside(10), beside(14)]);
    let error = RigidFit::default().estimate(&crossings, &found).unwrap_err();
    assert_eq!(error, FitError::Ambiguous { axis: Axis::Y, crossings: 2 });
}

/// A pose that shares the marks at one side with the told one, and explains as many but for one.
#[test]
fn a_sheet_that_is_turned_otherwise_is_refused() {
    let crossings: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
    let mut found = exact(&crossings, &FrameTransform::IDENTITY);
    let left = |index: &usize| crossings[*index].axis == Axis::Y && crossings[*index].scan_at_mm < 0.0;
    let beside: Vec<Found> = (0..found.len())
        .filter(left)
        .map(|index| Found { at_mm: found[index].at_mm + 3.0, ..found[index] })
        .collect();
    // Three of five at the left were seen twice, 3 mm apart: eight of ten against all ten.
    found.extend(&beside[..2]);
    assert!(RigidFit::default().estimate(&crossings, &found).is_ok());
    // Two of the five were seen there alone.
    let gone: Vec<usize> = (0..16).filter(left).skip(2).take(2).collect();
    found.retain(|place| !gone.contains(&place.crossing));
    let error = RigidFit::default().estimate(&crossings, &found).unwrap_err();
    assert_eq!(error, FitError::Ambiguous { axis: Axis::Y, crossings: 7 });
}

/// Strokes of the drawing on many ways: of the marks at either side three must agree, and no swelling is
/// believed.
#[test]
fn among_strokes_more_marks_are_asked_for() {
    let crossings: Vec<Crossing> = ReferenceLines::strip16().crossings().collect();
    // 4 to 9 mm beside the marks, no two alike.
    let strokes = |found: &[Found], of: std::ops::Range<usize>| -> Vec<Found> {
        let by_mm = |index: usize| 4.0 + (index * index) as f64 * 0.37 % 5.0;
        of.map(|index| Found { at_mm: found[index].at_mm + by_mm(index), ..found[index] }).collect()
    };
    let told = |mut found: Vec<Found>, of: std::ops::Range<usize>, gone: &[usize]| {
        found.extend(strokes(&found, of));
        found.retain(|place| !(gone.contains(&place.crossing) && found_is_mark(&crossings, place)));
        RigidFit::default().estimate(&crossings, &found)
    };
    let still = exact(&crossings, &FrameTransform::IDENTITY);
    // Even ones of the first ten are at the left.
    assert!(told(still.clone(), 0..10, &[0, 2]).is_ok());
    let error = told(still.clone(), 0..10, &[0, 2, 4]).unwrap_err();
    assert_eq!(error, FitError::Strokes { axis: Axis::Y, agree: 2, least: 3 });
    assert!(error.to_string().contains("only 2 marks agree at one side of the field"), "{error}");
    // Without strokes the same two are enough.
    assert!(told(still.clone(), 0..0, &[0, 2, 4]).is_ok());
    // Marks of constant x: one side in full is enough.
    assert!(told(still.clone(), 10..16, &[10]).is_ok());
    let error = told(still, 10..16, &[10, 13]).unwrap_err();
    assert_eq!(error, FitError::Strokes { axis: Axis::X, agree: 2, least: 3 });

    let swollen = Warped { swelling: 3e-4, bow_mm: 0.0, ..warped() }.found(&crossings);
    assert!(told(swollen.clone(), 0..0, &[]).is_ok());
    let error = told(swollen, 0..10, &[]).unwrap_err();
    assert!(matches!(error, FitError::Swollen { .. }), "{error}");
    assert!(error.to_string().contains("as if the paper had swollen by 0.0"), "{error}");
}

/// Whether a place lies where its mark does on a sheet that has hardly moved.
fn found_is_mark(crossings: &[Crossing], place: &Found) -> bool {
    (place.at_mm - crossings[place.crossing].mark_mm).abs() < 3.5
}
