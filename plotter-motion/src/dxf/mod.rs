//! DXF, in which CAD programs give away their drawings: read, from release 12 on, as text.
//!
//! # The format in short
//!
//! A text is a row of groups of two lines: a code, and a value that the code gives its meaning. A group of
//! code 0 begins something:
//!
//! ```text
//!   0            a section begins,
//! SECTION
//!   2            that of what is drawn:
//! ENTITIES
//!   0            a line
//! LINE
//!   8            on the layer "cut"
//! cut
//!  10            from x = 1,
//! 1.0
//!  20            y = 2
//! 2.0
//!  11            to (5, 2)
//! 5.0
//!  21
//! 2.0
//!   0
//! ENDSEC
//!   0
//! EOF
//! ```
//!
//! Source: Autodesk, *DXF Reference* (AutoCAD 2012), and that of release 12.
//!
//! # What is drawn
//!
//! | entities | how |
//! |---|---|
//! | `LINE` `LWPOLYLINE` `POLYLINE` `ARC` `CIRCLE` | lines and arcs; bulges are arcs; in space they are seen from above |
//! | `ELLIPSE` `SPLINE` `HELIX` | lines within [`ReadOptions::tolerance_mm`]; a circle that is seen askew too |
//! | `INSERT` `DIMENSION` `ACAD_TABLE` | their blocks, in rows and columns, turned, mirrored, stretched, in each other |
//! | `TEXT` `MTEXT` `ATTRIB` | by the single-line font of HPGL's labels, as high as they say; formats within a text are without effect |
//! | `HATCH` | its lines, with dashes; a filled area as its outline, which is told |
//! | `SOLID` `TRACE` `3DFACE` `LEADER`, nets and faces of polylines | their outlines and edges |
//! | `POINT` | a dot |
//!
//! Layers that are off, frozen or not for plots are left out, told with their number of entities; so is the
//! paper space where the model has something. Line types are drawn as dashes. Other entities (splines of
//! solids, pictures, lines without an end) are counted by their kind and told with what helps.
//!
//! Attributes, texts and blocks of programs (codes from 1000 on) are passed over.
//!
//! It is read here and not by the crate `dxf` (0.6), which brings some thirty crates along and gives up a
//! whole file at the first number that is wrong.
//!
//! # Bad input
//!
//! An [`Error`] says the line, what is wrong and what would be right. An entity without what it needs is left
//! out, and reading goes on with the next one. Blocks that hold themselves end 32 deep, and all together
//! after 4 million entities.

mod drawing;
mod entity;
mod error;
mod frame;
mod hatch;
mod pairs;
mod path;
mod plot_ops;
mod read_options;
mod record;
mod spline;
mod text;

pub use drawing::Drawing;
pub use error::{Error, Problem};
pub use plot_ops::PlotOps;
pub use read_options::{Pens, ReadOptions};
