//! Laws of sharing ink out among pens, on any picture.

use crate::law_cases::cases;
use plotter_vector::{
    Bitmap, Colour, Palette, Pixel, Rgb,
    ink::{Layers, PalettePen, Pens},
};
use proptest::prelude::*;

/// Few colours, as on a drawing, or any, as in noise.
fn pictures() -> impl Strategy<Value = Colour> {
    let few = prop::collection::vec(any::<[u8; 3]>(), 1..6);
    let colour = prop_oneof![
        few.prop_flat_map(|few| (Just(few), 1_u32..70, 1_u32..12)).prop_flat_map(|(few, width, height)| {
            let pixels = prop::collection::vec(prop::sample::select(few), (width * height) as usize);
            (Just(width), pixels)
        }),
        (1_u32..70, 1_u32..12).prop_flat_map(|(width, height)| {
            (Just(width), prop::collection::vec(any::<[u8; 3]>(), (width * height) as usize))
        }),
    ];
    colour.prop_map(|(width, pixels)| {
        let height = u32::try_from(pixels.len()).unwrap() / width;
        Colour::new(width, height, pixels.as_flattened().to_vec()).unwrap()
    })
}

/// Lines of few colours on a sheet on one side of which a shade lies.
fn shaded() -> impl Strategy<Value = Colour> {
    let lines = prop::collection::vec((any::<[u8; 3]>(), 1_u32..60, 0_u32..60, 20_u32..90, 1_u32..5), 1..6);
    (lines, 64_u32..140, 64_u32..80, 0_u32..80).prop_map(|(lines, width, height, shade)| {
        let mut channels = Vec::new();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let is_on = |(_, across, down, period, wide): &&([u8; 3], u32, u32, u32, u32)| {
                (x * across + y * down) / 60 % period < *wide
            };
            let colour = lines.iter().find(is_on).map_or([250, 248, 240], |line| line.0);
            let light = 100 - shade * x / width;
            channels.extend(colour.map(|level| u8::try_from(u32::from(level) * light / 100).unwrap()));
        }
        Colour::new(width, height, channels).unwrap()
    })
}

fn pens() -> impl Strategy<Value = Pens> {
    let palette = prop::collection::hash_set(any::<[u8; 3]>(), 1..=16).prop_map(|colours| {
        let mut colours: Vec<_> = colours.into_iter().collect();
        colours.sort_unstable();
        let pen = |(number, colour)| PalettePen {
            number,
            name: String::new(),
            colour: Rgb(colour),
            width_mm: None,
        };
        Pens::Given(Palette::new((1..).zip(colours).map(pen).collect()).unwrap())
    });
    prop_oneof![Just(Pens::Found), (1_usize..=16).prop_map(Pens::Count), palette]
}

fn inks(layers: &Layers) -> Vec<&Bitmap> {
    layers.iter().map(|(_, ink)| ink).collect()
}

proptest! {
    #![proptest_config(cases(96))]

    #[test]
    fn every_ink_pixel_is_in_exactly_one_pen(picture in pictures(), pens in pens()) {
        let layers = pens.separate(&picture).unwrap();
        prop_assert!(!inks(&layers).is_empty());
        for y in 0..picture.height() {
            for x in 0..picture.width() {
                let at = Pixel::new(x, y);
                prop_assert!(inks(&layers).iter().filter(|ink| ink.get(at)).count() <= 1, "{at:?}");
            }
        }
    }

    #[test]
    fn bridging_adds_ink_of_other_pens_only(picture in pictures(), pens in pens()) {
        let layers = pens.separate(&picture).unwrap();
        for (index, own) in inks(&layers).into_iter().enumerate() {
            let bridged = layers.bridged(index).unwrap();
            prop_assert!(own.ink().all(|at| bridged.get(at)));
            let others = inks(&layers);
            prop_assert!(bridged.ink().all(|at| others.iter().any(|ink| ink.get(at))));
            let coverage = layers.coverage(index, &bridged, &picture).unwrap();
            prop_assert_eq!(coverage.pixels().len(), picture.pixels().len());
        }
    }

    #[test]
    fn a_mirrored_picture_gives_the_mirrored_layers(
        picture in prop_oneof![3 => pictures(), 1 => shaded()],
        pens in pens(),
        upside_down in any::<bool>(),
    ) {
        let (width, height) = (picture.width(), picture.height());
        let at = |Pixel { x, y }: Pixel| {
            if upside_down { Pixel::new(x, height - 1 - y) } else { Pixel::new(width - 1 - x, y) }
        };
        let places = (0..height).flat_map(|y| (0..width).map(move |x| Pixel::new(x, y)));
        let mirrored: Vec<[u8; 3]> =
            places.map(|place| picture.pixels()[(at(place).y * width + at(place).x) as usize]).collect();
        let mirrored = Colour::new(width, height, mirrored.as_flattened().to_vec()).unwrap();
        let (one, other) = (pens.separate(&picture).unwrap(), pens.separate(&mirrored).unwrap());
        prop_assert_eq!(one.palette(), other.palette());
        prop_assert_eq!(one.ruling(), other.ruling());
        for index in 0..one.palette().pens().len() {
            let whole = [one.bridged(index).unwrap(), other.bridged(index).unwrap()];
            let own = [one.ink(index).unwrap().clone(), other.ink(index).unwrap().clone()];
            for [ink, back] in [own, whole] {
                prop_assert_eq!(ink.count(), back.count());
                prop_assert!(ink.ink().all(|pixel| back.get(at(pixel))));
            }
        }
    }
}
