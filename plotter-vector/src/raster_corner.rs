//! [`take_in`]: pixels in the corners of a staircase become part of the line beside them.
//!
//! ```text
//!   # # .            the walk goes from a to b; the pixel c beside both was left
//!   . a c            alone, and would be a dot: now the walk goes a, c, b
//!   . . b # #
//! ```

use crate::{Bitmap, Figures, Pixel};

/// Puts each figure of a single pixel that lies in the corner of another figure's diagonal step into that figure.
pub(crate) fn take_in(figures: Figures, width: u32, height: u32) -> Figures {
    let Ok(mut single) = Bitmap::new(width, height) else { return figures };
    let mut any = false;
    for figure in figures.iter() {
        if let [pixel] = figure {
            single.set(*pixel, true);
            any = true;
        }
    }
    if !any {
        return figures;
    }
    let mut whole = Figures::default();
    for figure in figures.iter().filter(|figure| figure.len() > 1) {
        let next = figure.iter().skip(1).map(Some).chain([None]);
        whole.push(figure.iter().zip(next).flat_map(|(at, next)| {
            let corner = next.and_then(|next| corner(&single, *at, *next));
            if let Some(corner) = corner {
                single.set(corner, false);
            }
            [Some(*at), corner].into_iter().flatten()
        }));
    }
    for figure in figures.iter() {
        if let [pixel] = figure
            && single.get(*pixel)
        {
            whole.push([*pixel]);
        }
    }
    whole
}

/// The pixel of a picture in one of the two corners of a diagonal step.
fn corner(picture: &Bitmap, from: Pixel, to: Pixel) -> Option<Pixel> {
    let diagonal = from.x.abs_diff(to.x) == 1 && from.y.abs_diff(to.y) == 1;
    let corners = [Pixel::new(from.x, to.y), Pixel::new(to.x, from.y)];
    corners.into_iter().find(|at| diagonal && picture.get(*at))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(figures: &[&[(u32, u32)]]) -> Vec<Vec<(u32, u32)>> {
        let mut all = Figures::default();
        for figure in figures {
            all.push(figure.iter().map(|(x, y)| Pixel::new(*x, *y)));
        }
        let taken = take_in(all, 9, 9);
        taken.iter().map(|figure| figure.iter().map(|at| (at.x, at.y)).collect()).collect()
    }

    #[test]
    fn a_pixel_in_a_corner_becomes_part_of_the_line() {
        let line: &[(u32, u32)] = &[(0, 0), (1, 0), (2, 1), (3, 1)];
        assert_eq!(taken(&[&[(2, 0)], line]), [[(0, 0), (1, 0), (2, 0), (2, 1), (3, 1)]]);
        // On the other side too, but only one for each step: the other one is a dot.
        assert_eq!(
            taken(&[line, &[(1, 1)], &[(2, 0)]]),
            [vec![(0, 0), (1, 0), (1, 1), (2, 1), (3, 1)], vec![(2, 0)]]
        );
    }

    #[test]
    fn other_dots_stay() {
        let line: &[(u32, u32)] = &[(0, 0), (1, 0), (2, 0)];
        assert_eq!(taken(&[line, &[(1, 1)], &[(7, 7)]]), [line, &[(1, 1)], &[(7, 7)]]);
    }
}
