//! [`Mnemonic`]: the two letters of a command, and the table of how the bytes after them are read.

use core::fmt;

/// The two letters that name a command, in upper case.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Mnemonic([u8; 2]);

/// How the bytes after a mnemonic are to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Syntax {
    /// Numbers up to `;` or the next letter: `PD100,200`.
    Numbers,
    /// Any bytes up to the label terminator: `LBHello` and a byte 3.
    Label,
    /// One byte, the new label terminator, and maybe a number: `DT#,1`.
    Terminator,
    /// At most one byte: `SM*`.
    Symbol,
    /// Numbers and strings within double quotes: `BP1,"name"`.
    Quoted,
    /// A string within double quotes, or whatever comes before the next `;`: `CO"a remark"`.
    Comment,
    /// Any bytes up to `;`: `PE<=!!`.
    Encoded,
}

impl Mnemonic {
    /// The command with these two letters, in either case; `None` if one of them is not a letter.
    #[must_use]
    pub const fn new(first: u8, second: u8) -> Option<Self> {
        if first.is_ascii_alphabetic() && second.is_ascii_alphabetic() {
            Some(Self([first.to_ascii_uppercase(), second.to_ascii_uppercase()]))
        } else {
            None
        }
    }

    /// The two letters.
    ///
    /// ```
    /// # use plotter_motion::hpgl::Mnemonic;
    /// let command = Mnemonic::new(b'p', b'D').ok_or("not letters")?;
    /// assert_eq!(command.letters(), b"PD");
    /// assert_eq!(command.to_string(), "PD");
    /// # Ok::<(), &str>(())
    /// ```
    #[must_use]
    pub const fn letters(&self) -> &[u8; 2] {
        &self.0
    }

    /// What the command does, in a few words; `None` for one that neither HPGL nor HP-GL/2 knows, nor a
    /// cutter.
    ///
    /// ```
    /// # use plotter_motion::hpgl::Mnemonic;
    /// assert_eq!(Mnemonic::new(b'R', b'O').and_then(Mnemonic::meaning), Some("rotate the coordinates"));
    /// assert_eq!(Mnemonic::new(b'X', b'X').and_then(Mnemonic::meaning), None);
    /// ```
    #[must_use]
    pub fn meaning(self) -> Option<&'static str> {
        self.entry().map(|(_, _, meaning)| *meaning)
    }

    /// How the bytes after it are read; a command unknown to the table takes numbers.
    #[must_use]
    pub fn syntax(self) -> Syntax {
        self.entry().map_or(Syntax::Numbers, |(_, syntax, _)| *syntax)
    }

    fn entry(self) -> Option<&'static (&'static [u8; 2], Syntax, &'static str)> {
        let found = TABLE.binary_search_by(|(letters, _, _)| letters.cmp(&&self.0)).ok()?;
        TABLE.get(found)
    }
}

impl fmt::Display for Mnemonic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, second] = self.0;
        write!(f, "{}{}", char::from(first), char::from(second))
    }
}

impl fmt::Debug for Mnemonic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Mnemonic({self})")
    }
}

use Syntax::{Comment, Encoded, Label, Numbers, Quoted, Symbol, Terminator};

/// Every command of HPGL (pen plotters of the 1980s) and HP-GL/2, in alphabetical order, and `FC`, `FD` and
/// `TB`, which programs take over into HPGL from GP-GL, the other language of Graphtec's cutters. Only the
/// reading depends on it: what a command *does* is the interpreter's business.
const TABLE: &[(&[u8; 2], Syntax, &str)] = &[
    (b"AA", Numbers, "arc about an absolute centre"),
    (b"AC", Numbers, "anchor corner of the fill"),
    (b"AD", Numbers, "alternate font definition"),
    (b"AF", Numbers, "advance a full page"),
    (b"AH", Numbers, "advance half a page"),
    (b"AP", Numbers, "automatic pen operations"),
    (b"AR", Numbers, "arc about a relative centre"),
    (b"AS", Numbers, "acceleration select"),
    (b"AT", Numbers, "arc through three points"),
    (b"BL", Label, "buffer a label"),
    (b"BP", Quoted, "begin a plot"),
    (b"BR", Numbers, "Bezier curve, relative"),
    (b"BZ", Numbers, "Bezier curve, absolute"),
    (b"CA", Numbers, "alternate character set"),
    (b"CC", Numbers, "chord angle of characters"),
    (b"CF", Numbers, "character fill"),
    (b"CI", Numbers, "circle"),
    (b"CM", Numbers, "character selection mode"),
    (b"CO", Comment, "comment"),
    (b"CP", Numbers, "move by characters"),
    (b"CR", Numbers, "colour range"),
    (b"CS", Numbers, "standard character set"),
    (b"CT", Numbers, "chord tolerance mode"),
    (b"CV", Numbers, "curved line generator"),
    (b"DC", Numbers, "digitize clear"),
    (b"DF", Numbers, "default values"),
    (b"DI", Numbers, "label direction, absolute"),
    (b"DL", Numbers, "download a character"),
    (b"DP", Numbers, "digitize a point"),
    (b"DR", Numbers, "label direction, relative"),
    (b"DS", Numbers, "designate a character set"),
    (b"DT", Terminator, "label terminator"),
    (b"DV", Numbers, "label path"),
    (b"EA", Numbers, "edge of a rectangle, absolute"),
    (b"EC", Numbers, "enable the cutter"),
    (b"EP", Numbers, "edge of the polygon"),
    (b"ER", Numbers, "edge of a rectangle, relative"),
    (b"ES", Numbers, "extra space of labels"),
    (b"EW", Numbers, "edge of a wedge"),
    (b"FC", Numbers, "blade offset of a cutter"),
    (b"FD", Numbers, "blade rotation of a cutter"),
    (b"FI", Numbers, "select the primary font"),
    (b"FN", Numbers, "select the secondary font"),
    (b"FP", Numbers, "fill the polygon"),
    (b"FR", Numbers, "advance a frame"),
    (b"FS", Numbers, "pen force select"),
    (b"FT", Numbers, "fill type"),
    (b"GC", Numbers, "group count"),
    (b"GM", Numbers, "graphics memory"),
    (b"GP", Numbers, "group of pens"),
    (b"IM", Numbers, "error mask"),
    (b"IN", Numbers, "initialize"),
    (b"IP", Numbers, "scaling points P1 and P2"),
    (b"IR", Numbers, "scaling points, relative"),
    (b"IV", Numbers, "invoke a character slot"),
    (b"IW", Numbers, "window"),
    (b"KY", Numbers, "define a key"),
    (b"LA", Numbers, "line ends and joins"),
    (b"LB", Label, "label"),
    (b"LM", Numbers, "label mode"),
    (b"LO", Numbers, "label origin"),
    (b"LT", Numbers, "line type"),
    (b"MC", Numbers, "merge control"),
    (b"MG", Quoted, "message"),
    (b"MT", Numbers, "media type"),
    (b"NP", Numbers, "number of pens"),
    (b"NR", Numbers, "not ready"),
    (b"OA", Numbers, "output the actual position"),
    (b"OC", Numbers, "output the commanded position"),
    (b"OD", Numbers, "output the digitized point"),
    (b"OE", Numbers, "output the error"),
    (b"OF", Numbers, "output the factors"),
    (b"OG", Numbers, "output the group count"),
    (b"OH", Numbers, "output the hard-clip limits"),
    (b"OI", Numbers, "output the identification"),
    (b"OK", Numbers, "output the key"),
    (b"OL", Numbers, "output the label length"),
    (b"OO", Numbers, "output the options"),
    (b"OP", Numbers, "output P1 and P2"),
    (b"OS", Numbers, "output the status"),
    (b"OT", Numbers, "output the carousel type"),
    (b"OW", Numbers, "output the window"),
    (b"PA", Numbers, "plot absolute"),
    (b"PB", Numbers, "print the buffered label"),
    (b"PC", Numbers, "pen colour"),
    (b"PD", Numbers, "pen down"),
    (b"PE", Encoded, "polyline, encoded"),
    (b"PG", Numbers, "page"),
    (b"PM", Numbers, "polygon mode"),
    (b"PP", Numbers, "pixel placement"),
    (b"PR", Numbers, "plot relative"),
    (b"PS", Numbers, "plot size"),
    (b"PT", Numbers, "pen thickness"),
    (b"PU", Numbers, "pen up"),
    (b"PW", Numbers, "pen width"),
    (b"QL", Numbers, "quality level"),
    (b"RA", Numbers, "filled rectangle, absolute"),
    (b"RF", Numbers, "raster fill definition"),
    (b"RO", Numbers, "rotate the coordinates"),
    (b"RP", Numbers, "replot"),
    (b"RR", Numbers, "filled rectangle, relative"),
    (b"RT", Numbers, "arc through three points, relative"),
    (b"SA", Numbers, "select the alternate font"),
    (b"SB", Numbers, "scalable or bitmap fonts"),
    (b"SC", Numbers, "scale"),
    (b"SD", Numbers, "standard font definition"),
    (b"SI", Numbers, "character size, absolute"),
    (b"SL", Numbers, "character slant"),
    (b"SM", Symbol, "symbol mode"),
    (b"SP", Numbers, "select a pen"),
    (b"SR", Numbers, "character size, relative"),
    (b"SS", Numbers, "select the standard font"),
    (b"ST", Numbers, "sort"),
    (b"SV", Numbers, "screened vectors"),
    (b"TB", Numbers, "registration marks of a cutter"),
    (b"TD", Numbers, "transparent data"),
    (b"TL", Numbers, "tick length"),
    (b"TR", Numbers, "transparency mode"),
    (b"UC", Numbers, "user-defined character"),
    (b"UF", Numbers, "user-defined fill"),
    (b"UL", Numbers, "user-defined line type"),
    (b"VA", Numbers, "adaptive velocity"),
    (b"VN", Numbers, "normal velocity"),
    (b"VS", Numbers, "velocity select"),
    (b"WD", Label, "write to the display"),
    (b"WG", Numbers, "filled wedge"),
    (b"WU", Numbers, "unit of the pen width"),
    (b"XT", Numbers, "tick on the x axis"),
    (b"YT", Numbers, "tick on the y axis"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_sorted_and_names_nothing_twice() {
        assert!(TABLE.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }

    #[test]
    fn an_unknown_command_takes_numbers() {
        let unknown = Mnemonic::new(b'Z', b'z').unwrap();
        assert_eq!((unknown.syntax(), unknown.meaning()), (Syntax::Numbers, None));
        assert_eq!(Mnemonic::new(b'P', b'1'), None);
    }
}
