//! [`StraightenedPaper`]: where a sheet that was straightened before it was traced lies in its picture.

use plotter_vector::picture::Homography;
use serde::Deserialize;

/// A sheet that `trace --paper` took out of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightenedPaper {
    /// Width and height of the straightened sheet, px.
    pub size_px: (u32, u32),
    /// Width and height of the picture that it was in, px.
    pub picture_px: (u32, u32),
    /// Places in that picture from places on the sheet, both counted from the upper left corner.
    pub homography: Homography,
}

/// What a report of `trace` says of it.
#[derive(Deserialize)]
struct Report {
    paper: Option<Reported>,
}

#[derive(Deserialize)]
struct Reported {
    width_px: u32,
    height_px: u32,
    picture_px: (u32, u32),
    homography: Homography,
}

impl StraightenedPaper {
    /// As an SVG says it in the attributes of its first element; none where it does not.
    ///
    /// # Errors
    ///
    /// Attributes that are no homography.
    pub fn in_svg(file: &[u8]) -> Result<Option<Self>, String> {
        let text = String::from_utf8_lossy(file);
        let start = text.split_once("<svg").map_or("", |(_, rest)| rest);
        let start = start.split_once('>').map_or(start, |(start, _)| start);
        let numbers = |name: &str| -> Option<Option<Vec<f64>>> {
            let (_, rest) = start.split_once(&format!(" {name}=\""))?;
            let (text, _) = rest.split_once('"')?;
            Some(text.split_ascii_whitespace().map(|number| number.parse().ok()).collect())
        };
        let Some(homography) = numbers("data-homography") else { return Ok(None) };
        let found = || {
            let [_, _, width, height] = numbers("viewBox")??.try_into().ok()?;
            let [of_width, of_height] = numbers("data-picture")??.try_into().ok()?;
            let [a, b, c, d, e, f, g, h, i]: [f64; 9] = homography?.try_into().ok()?;
            Some(Self {
                size_px: (side(width)?, side(height)?),
                picture_px: (side(of_width)?, side(of_height)?),
                homography: checked(Homography([[a, b, c], [d, e, f], [g, h, i]]))?,
            })
        };
        let what = "data-homography: is no map from the sheet to its picture, as `trace --paper` writes it";
        found().map(Some).ok_or_else(|| what.to_owned())
    }

    /// As the report of `trace` says it.
    ///
    /// # Errors
    ///
    /// It is no such report, or nothing was straightened.
    pub fn in_report(file: &[u8]) -> Result<Self, String> {
        let report: Report =
            serde_json::from_slice(file).map_err(|error| format!("is no report of `trace`: {error}"))?;
        let paper = report.paper.ok_or("tells of no sheet: it was traced without --paper")?;
        Ok(Self {
            size_px: (paper.width_px, paper.height_px),
            picture_px: paper.picture_px,
            homography: checked(paper.homography).ok_or("paper.homography: has no inverse")?,
        })
    }
}

fn checked(homography: Homography) -> Option<Homography> {
    homography.inverse().map(|_| homography)
}

/// A side in px.
fn side(px: f64) -> Option<u32> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole and in range")]
    let side = (px >= 1.0 && px <= f64::from(u32::MAX)).then_some(px as u32)?;
    (f64::from(side) == px).then_some(side)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_read_from_an_svg_and_from_a_report() {
        let svg = "<?xml version=\"1.0\"?>\n<svg data-picture=\"40 30\" data-homography=\"1 0 5 0 1 7 0 0.001 1\" \
            width=\"2mm\" height=\"1mm\" viewBox=\"0 0 20 10\"><g/></svg>";
        let wanted = StraightenedPaper {
            size_px: (20, 10),
            picture_px: (40, 30),
            homography: Homography([[1.0, 0.0, 5.0], [0.0, 1.0, 7.0], [0.0, 0.001, 1.0]]),
        };
        assert_eq!(StraightenedPaper::in_svg(svg.as_bytes()), Ok(Some(wanted)));
        let json = r#"{"strokes":1,"paper":{"width_px":20,"height_px":10,"picture_px":[40,30],
            "homography":[[1,0,5],[0,1,7],[0,0.001,1]]}}"#;
        assert_eq!(StraightenedPaper::in_report(json.as_bytes()), Ok(wanted));
        // What was not straightened says nothing; what is broken is refused.
        assert_eq!(StraightenedPaper::in_svg(b"<svg viewBox=\"0 0 1 1\"/>"), Ok(None));
        assert!(StraightenedPaper::in_svg(svg.replace("0 1 7", "0 1").as_bytes()).is_err());
        assert!(StraightenedPaper::in_svg(svg.replace("0 1 7", "0 0 0").as_bytes()).is_err());
        assert!(StraightenedPaper::in_report(b"{}").is_err());
    }
}
