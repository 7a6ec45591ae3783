//! Pictures of a run of a line follower: the path over the drawing as SVG, and a page that plays it.

use base64::Engine as _;
use plotter_vector::follow::Tool;
use plotter_vector::{Gray, PxPoint};
use std::fmt::Write as _;

/// A moment of a run.
#[derive(Clone, Copy, Debug)]
pub struct FollowFrame {
    /// Where camera and tool truly were, px.
    pub at: PxPoint,
    /// Whether the tool worked.
    pub tool: Tool,
}

/// The path over the drawing, with some of the windows, and dashed the ways with the tool lifted.
///
/// # Errors
///
/// A picture that cannot be held.
pub fn follow_svg(
    picture: &Gray,
    strokes: &[Vec<PxPoint>],
    frames: &[FollowFrame],
    window_px: u32,
) -> Result<String, String> {
    let (width, height) = (picture.width(), picture.height());
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\">\n\
         <image href=\"{}\" width=\"{width}\" height=\"{height}\" opacity=\"0.35\"/>\n",
        embedded(picture)?
    );
    let side = f64::from(window_px);
    let mut shown = PxPoint::new(f64::MAX, f64::MAX);
    for frame in frames {
        // As many windows as can be told apart.
        if frame.at.distance(shown) > 0.5 * side {
            shown = frame.at;
            let (left, top) = (shown.x - 0.5 * side, shown.y - 0.5 * side);
            let _ = writeln!(
                text,
                "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{side}\" height=\"{side}\" fill=\"none\" stroke=\"#2a6fb0\" \
                 stroke-opacity=\"0.25\"/>"
            );
        }
    }
    for (i, stroke) in strokes.iter().enumerate() {
        let places: Vec<String> = stroke.iter().map(|at| format!("{:.2},{:.2}", at.x, at.y)).collect();
        let _ = writeln!(
            text,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"#d01818\" stroke-width=\"1\" stroke-linejoin=\"round\"/>",
            places.join(" ")
        );
        let next = strokes.get(i + 1).and_then(|next| next.first());
        if let (Some(from), Some(to)) = (stroke.last(), next) {
            let _ = writeln!(
                text,
                "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"#18a018\" stroke-width=\"0.7\" \
                 stroke-dasharray=\"3 3\"/>",
                from.x, from.y, to.x, to.y
            );
        }
    }
    text.push_str("</svg>\n");
    Ok(text)
}

/// A page that plays the run, with some text below.
///
/// # Errors
///
/// A picture that cannot be held.
pub fn follow_page(
    picture: &Gray,
    frames: &[FollowFrame],
    window_px: u32,
    text: &str,
) -> Result<String, String> {
    let places: Vec<[f64; 3]> = frames
        .iter()
        .map(|frame| {
            let round = |v: f64| libm::round(10.0 * v) / 10.0;
            [round(frame.at.x), round(frame.at.y), if frame.tool == Tool::Down { 1.0 } else { 0.0 }]
        })
        .collect();
    let places = serde_json::to_string(&places).map_err(|error| error.to_string())?;
    let escaped = text.replace('&', "&amp;").replace('<', "&lt;");
    Ok(format!(
        r##"<!doctype html><meta charset="utf-8"><title>follow</title>
<style>body{{font:14px sans-serif;margin:1em}}canvas{{max-width:100%;border:1px solid #ccc}}</style>
<canvas id="c" width="{width}" height="{height}"></canvas>
<p><button id="play">pause</button> <input id="t" type="range" min="0" value="0" style="width:60%"></p>
<pre>{escaped}</pre>
<script>
const places={places},side={window_px};
const c=document.getElementById("c"),g=c.getContext("2d"),t=document.getElementById("t"),b=document.getElementById("play");
t.max=places.length;let n=0,on=true;const image=new Image();image.src="{image}";
function draw(){{
  g.clearRect(0,0,c.width,c.height);g.globalAlpha=.4;g.drawImage(image,0,0);g.globalAlpha=1;
  g.lineWidth=1.2;
  for(let i=1;i<n;i++){{g.beginPath();g.strokeStyle=places[i][2]?"#d01818":"#9c9";g.moveTo(places[i-1][0],places[i-1][1]);g.lineTo(places[i][0],places[i][1]);g.stroke();}}
  const p=places[Math.max(0,n-1)];if(p){{g.strokeStyle="#2a6fb0";g.strokeRect(p[0]-side/2,p[1]-side/2,side,side);g.fillStyle="#2a6fb0";g.fillRect(p[0]-2,p[1]-2,4,4);}}
}}
function tick(){{if(on&&n<places.length){{n=Math.min(places.length,n+Math.max(1,places.length/900));n=Math.floor(n);t.value=n;draw();}}requestAnimationFrame(tick);}}
b.onclick=()=>{{if(n>=places.length)n=0;on=!on||n==0;b.textContent=on?"pause":"play";}};
t.oninput=()=>{{n=+t.value;on=false;b.textContent="play";draw();}};
image.onload=()=>{{draw();tick();}};
</script>
"##,
        width = picture.width(),
        height = picture.height(),
        image = embedded(picture)?,
    ))
}

/// The picture as the source of an image.
fn embedded(picture: &Gray) -> Result<String, String> {
    let mut png = std::io::Cursor::new(Vec::new());
    let image = image::GrayImage::from_raw(picture.width(), picture.height(), picture.pixels().to_vec());
    let image = image.ok_or("the picture cannot be held")?;
    image.write_to(&mut png, image::ImageFormat::Png).map_err(|error| error.to_string())?;
    Ok(format!(
        "data:image/png;base64,{}",
        base64::engine::general_purpose::STANDARD.encode(png.into_inner())
    ))
}
