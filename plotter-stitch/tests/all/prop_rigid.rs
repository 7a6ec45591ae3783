//! Laws of the fit of a sheet to many crossings.

use plotter_motion::{Axis, Point, Vec2};
use plotter_stitch::{
    BothEdges, Crossing, FindLine, FitError, Found, FrameTransform, Optics, PublishedRule, ReferenceLines,
    RigidFit, Tact,
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

    /// Up to four of sixteen wrong by anything, two of them along each axis: what is told is what the others tell.
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
            // Four of one line gone at once may leave too little to check the rest.
            Err(error) => prop_assert!(matches!(error, FitError::Unchecked { .. }), "{error}"),
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
        "along x only 4 of 10 found places agree with the others, more than half are needed; look for dust"
    );
    let mut broken = all.clone();
    broken[5].at_mm = f64::NAN;
    assert_eq!(refused(broken), "crossing 5: NaN is no place or deviation on a machine; scan it again");
    let turned = FrameTransform::new(0.02, Vec2::new(1.0, -2.0)).unwrap();
    assert!(RigidFit::default().estimate(&crossings, &exact(&crossings, &turned)).is_err());
}
