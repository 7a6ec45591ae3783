//! [`JudgedDrawing`]: a vectorization by any program, read from SVG or HPGL, in the picture's pixels.

use crate::StraightenedPaper;
use crate::corpus::View;
use plotter_examples::shared::usual_colour;
use plotter_motion::{PlotOp, Point, hpgl, toolpath::chords};
use plotter_vector::{
    Drawing, PxPoint, Rgb, SvgOptions, Vectorizer, decode, decode_colour,
    ink::{PalettePen, Pens},
    read_svg,
};

/// Greatest distance of curves from their chords, px.
const CHORD_PX: f64 = 0.1;

/// Offset from coordinates counted from a pixel's centre to [`PxPoint`], px.
pub(crate) const CENTRE_PX: f64 = 0.5;

/// What an SVG can be read to, mm.
const TOLERANCES_MM: core::ops::RangeInclusive<f64> = 0.001..=10.0;

/// How far a scale of HPGL may be off a sensible one, mm a pixel: 0.25 and 25,400 dots per inch.
const MM_PER_PX: core::ops::RangeInclusive<f64> = 0.001..=100.0;

/// Strokes of straight lines in a picture's pixels, and the pens that they are drawn by.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JudgedDrawing {
    /// The strokes; curves as lines within 0.1 px.
    pub drawing: Drawing,
    /// The pens with their colours.
    pub pens: Vec<PalettePen>,
}

impl JudgedDrawing {
    /// From an SVG file whose sheet is the whole picture, whatever its unit.
    ///
    /// # Errors
    ///
    /// What is wrong with the file.
    pub fn from_svg(bytes: &[u8], (width_px, height_px): (u32, u32)) -> Result<Self, String> {
        let read = |tolerance_mm: f64| {
            let options = SvgOptions::default().with_tolerance_mm(tolerance_mm);
            read_svg(bytes, &options).map_err(|error| error.to_string())
        };
        // The size of a pixel is known when the file has been read.
        let usual = SvgOptions::default().tolerance_mm;
        let found = read(usual)?;
        let mm_per_px = found.width_mm / f64::from(width_px);
        let svg = read((CHORD_PX * mm_per_px).clamp(*TOLERANCES_MM.start(), *TOLERANCES_MM.end()))?;
        let px = [
            svg.scale.mm_per_px() * f64::from(width_px) / svg.width_mm,
            svg.scale.mm_per_px() * f64::from(height_px) / svg.height_mm,
        ];
        let mut drawing = Drawing::new(width_px, height_px);
        for (index, stroke) in svg.drawing.strokes().enumerate() {
            let places = stroke.iter().map(|at| PxPoint::new(at.x * px[0], at.y * px[1]));
            drawing.push_with_pen(svg.drawing.pen(index), places);
        }
        Ok(Self { drawing, pens: svg.pens })
    }

    /// From HPGL whose origin is the centre of the picture's lower left pixel, y up, as `trace` writes it.
    /// Pens have the usual colours.
    ///
    /// # Errors
    ///
    /// A size of pixels outside of 0.001 to 100 mm.
    pub fn from_hpgl(
        bytes: &[u8],
        (width_px, height_px): (u32, u32),
        mm_per_px: f64,
    ) -> Result<Self, String> {
        if !MM_PER_PX.contains(&mm_per_px) {
            return Err(format!(
                "{mm_per_px} mm a pixel lie outside {} to {} mm; 0.1 are 254 dots per inch",
                MM_PER_PX.start(),
                MM_PER_PX.end()
            ));
        }
        let place =
            |at: Point| PxPoint::new(at.x / mm_per_px + 0.5, f64::from(height_px) - 0.5 - at.y / mm_per_px);
        let mut drawing = Drawing::new(width_px, height_px);
        let (mut pen, mut at, mut stroke) = (1, Point::ORIGIN, Vec::new());
        for op in chords(hpgl::plot_ops(bytes).filter_map(Result::ok), CHORD_PX * mm_per_px) {
            if let PlotOp::Draw { to, .. } = op {
                if stroke.is_empty() {
                    stroke.push(place(at));
                }
                if to != at || stroke.len() > 1 {
                    stroke.push(place(to));
                }
            } else {
                drawing.push_with_pen(pen, stroke.drain(..));
            }
            match op {
                PlotOp::SelectPen { pen: 0 } => {}
                PlotOp::SelectPen { pen: other } => pen = other,
                _ => {}
            }
            at = op.target().unwrap_or(at);
        }
        drawing.push_with_pen(pen, stroke);
        let usual = |number| PalettePen {
            number,
            name: String::new(),
            colour: Rgb(usual_colour(number)),
            width_mm: None,
        };
        let pens = drawing.pens().into_iter().map(usual).collect();
        Ok(Self { drawing, pens })
    }

    /// A result on a picture in which the drawing is seen from askew, in pixels of the drawing itself.
    ///
    /// # Errors
    ///
    /// A stroke lies beyond the horizon, where no drawing is.
    pub fn flattened(&self, view: &View, size_px: (u32, u32)) -> Result<Self, String> {
        let back = view.homography.inverse().ok_or("the view has no inverse")?;
        self.moved(size_px, |at| {
            // The view counts from pixel centres.
            let flat = back.apply(PxPoint::new(at.x - CENTRE_PX, at.y - CENTRE_PX))?;
            Some(PxPoint::new(flat.x + CENTRE_PX, flat.y + CENTRE_PX))
        })
    }

    /// A result on a sheet that was straightened out of a picture of this size, in the picture's own pixels.
    ///
    /// # Errors
    ///
    /// The sheet is of another picture, or a stroke lies beyond its horizon.
    pub fn on_picture(&self, paper: &StraightenedPaper, size_px: (u32, u32)) -> Result<Self, String> {
        if paper.picture_px != size_px {
            let ((width, height), (true_width, true_height)) = (paper.picture_px, size_px);
            return Err(format!(
                "is of a sheet out of a picture of {width} x {height} px, but the truth is of one of \
                 {true_width} x {true_height} px"
            ));
        }
        self.moved(size_px, |at| paper.homography.apply(at))
    }

    fn moved(
        &self,
        (width_px, height_px): (u32, u32),
        to: impl Fn(PxPoint) -> Option<PxPoint>,
    ) -> Result<Self, String> {
        let mut drawing = Drawing::new(width_px, height_px);
        for (index, stroke) in self.drawing.strokes().enumerate() {
            let places: Option<Vec<PxPoint>> = stroke.iter().map(|at| to(*at)).collect();
            let places = places.ok_or_else(|| {
                format!("stroke {index} lies beyond the horizon of the sheet that the picture shows")
            })?;
            drawing.push_with_pen(self.drawing.pen(index), places);
        }
        Ok(Self { drawing, pens: self.pens.clone() })
    }

    /// What ours makes of a picture with its default settings; in colour, with the pens that it finds.
    ///
    /// # Errors
    ///
    /// The picture cannot be read or traced.
    pub fn traced(picture: &[u8], in_colour: bool) -> Result<Self, String> {
        let vectorizer = Vectorizer::default();
        let (traced, palette) = if in_colour {
            let colour = decode_colour(picture).map_err(|error| error.to_string())?;
            let found =
                vectorizer.vectorize_colour(&colour, &Pens::Found).map_err(|error| error.to_string())?;
            (found.traced, found.palette)
        } else {
            let gray = decode(picture).map_err(|error| error.to_string())?;
            let found = vectorizer.vectorize(&gray).map_err(|error| error.to_string())?;
            (found, plotter_vector::Palette::default())
        };
        Ok(Self { drawing: traced.drawing, pens: palette.pens().to_vec() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_vector::{Scale, hpgl, picture::Homography, svg};

    /// Three decimals of SVG, in single precision.
    const SVG_PX: f64 = 1e-3;
    /// A plotter unit of 0.025 mm on pixels of 0.1 mm.
    const HPGL_PX: f64 = 0.13;

    fn example() -> Drawing {
        let mut drawing = Drawing::new(60, 40);
        drawing.push([PxPoint::new(3.25, 4.5), PxPoint::new(50.5, 30.0), PxPoint::new(3.25, 30.0)]);
        drawing.push([PxPoint::new(20.5, 10.25), PxPoint::new(40.0, 10.25)]);
        drawing
    }

    fn assert_same(found: &Drawing, within_px: f64) {
        let example = example();
        assert_eq!((found.strokes().len(), found.vertices()), (2, 5));
        for (found, wanted) in found.strokes().flatten().zip(example.strokes().flatten()) {
            assert!(found.distance(*wanted) < within_px, "{found:?} in place of {wanted:?}");
        }
    }

    #[test]
    fn what_is_written_is_read_where_it_was() {
        let (mut as_svg, mut as_hpgl) = (String::new(), String::new());
        svg(&example(), 1.0, &mut as_svg).unwrap();
        let scale = Scale::new(40, 0.1, Point::new(-0.05, -0.05)).unwrap();
        hpgl(&example(), scale, &mut as_hpgl).unwrap();
        assert_same(&JudgedDrawing::from_svg(as_svg.as_bytes(), (60, 40)).unwrap().drawing, SVG_PX);
        assert_same(&JudgedDrawing::from_hpgl(as_hpgl.as_bytes(), (60, 40), 0.1).unwrap().drawing, HPGL_PX);
    }

    #[test]
    fn the_unit_of_an_svg_does_not_matter() {
        let file = "<svg xmlns='http://www.w3.org/2000/svg' width='60pt' height='40pt' viewBox='0 0 600 400'>\
            <path d='M32.5 45L505 300H32.5M205 102.5H400' stroke='black' fill='none'/></svg>";
        assert_same(&JudgedDrawing::from_svg(file.as_bytes(), (60, 40)).unwrap().drawing, SVG_PX);
    }

    #[test]
    fn what_is_seen_askew_lies_where_it_was_drawn() {
        // By hand: w = 1 + x / 100, so that (20, 10) is seen at (20 / 1.2, 10 / 1.2) and (60, 30) at (37.5,
        // 18.75).
        let homography = Homography([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.01, 0.0, 1.0]]);
        let view = View { width: 50, height: 30, homography };
        let mut seen = Drawing::new(50, 30);
        seen.push_with_pen(3, [PxPoint::new(20.0 / 1.2 + 0.5, 10.0 / 1.2 + 0.5), PxPoint::new(38.0, 19.25)]);
        let flat = JudgedDrawing { drawing: seen, pens: Vec::new() }.flattened(&view, (100, 80)).unwrap();
        assert_eq!((flat.drawing.width_px(), flat.drawing.height_px(), flat.drawing.pen(0)), (100, 80, 3));
        for (found, wanted) in flat.drawing.stroke(0).iter().zip([(20.5, 10.5), (60.5, 30.5)]) {
            assert!(found.distance(PxPoint::new(wanted.0, wanted.1)) < 1e-9, "{found:?}");
        }
        // Its horizon is seen at the column 100: all that lies left of it is on the sheet.
        let mut beyond = Drawing::new(50, 30);
        beyond.push([PxPoint::new(10.0, 10.0), PxPoint::new(101.0, 10.0)]);
        let found = JudgedDrawing { drawing: beyond, pens: Vec::new() }.flattened(&view, (100, 80));
        assert!(found.unwrap_err().contains("stroke 0"));
    }

    #[test]
    fn a_dot_of_hpgl_is_one_vertex_and_each_pen_has_its_strokes() {
        let read =
            JudgedDrawing::from_hpgl(b"IN;SP2;PU40,40;PD40,40;SP3;PU80,40;PD80,80;PU;SP0;", (60, 40), 1.0);
        let JudgedDrawing { drawing, pens } = read.unwrap();
        assert_eq!((drawing.stroke(0), drawing.pen(0)), (&[PxPoint::new(1.5, 38.5)][..], 2));
        assert_eq!((drawing.stroke(1).len(), drawing.pen(1), drawing.strokes().len()), (2, 3, 2));
        assert_eq!(pens.iter().map(|pen| pen.number).collect::<Vec<_>>(), [2, 3]);
        assert!(JudgedDrawing::from_hpgl(b"", (60, 40), 0.0).is_err());
    }
}
