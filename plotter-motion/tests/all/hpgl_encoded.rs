//! Where the data of `PE` end: at their `;`, at the next command where that is missing, at the end of the
//! text, and at an escape sequence that leaves the language.
//!
//! Source: *The HP-GL/2 and HP RTL Reference Guide*, on `PE`, which must be ended by a `;`. AutoCAD's driver
//! leaves it out before `PU`.

use crate::shown::ops;
use plotter_motion::hpgl::plot_ops;

/// A line by (1, 1) in six bits: 2 is the byte 191 + 2, and 0, 191; each byte here is one letter of Latin-1.
fn shown(text: &str) -> String {
    let bytes: Vec<u8> = text.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap()).collect();
    let all = plot_ops(&bytes).map(|op| match op {
        Ok(op) => op.target().map_or(format!("{op:?}"), |to| {
            let letter = if matches!(op, plotter_motion::PlotOp::Travel { .. }) { 'U' } else { 'D' };
            format!("{letter}{},{}", to.x * 40.0, to.y * 40.0)
        }),
        Err(error) => format!("<{error}>"),
    });
    all.collect::<Vec<_>>()
        .join(" ")
        .replace("SelectPen { pen: ", "S")
        .replace(" }", "")
        .replace("NewPage", "N")
}

const AT_THE_NEXT: [(&str, &str); 19] = [
    // legal
    ("PE\u{c1}\u{c1};PUSP0;", "D1,1 S0"),
    ("PE7aa;PU;", "D1,1 U1,1"),
    ("PE;PD5,5", "D5,5"),
    // as AutoCAD writes it, with all that may follow
    ("PE\u{c1}\u{c1}PUSP0;PG;", "D1,1 S0 N"),
    ("PE7aaPUSP0;PG;", "D1,1 S0 N"),
    ("PE\u{c1}\u{c1}PU;PA5,5", "D1,1 U5,5"),
    ("PE\u{c1}\u{c1}PU5,5;PD6,6", "D1,1 U5,5 D6,6"),
    ("PE\u{c1}\u{c1}PU-5,5", "D1,1 U-5,5"),
    ("PE\u{c1}\u{c1}PA5,5PD6,6", "D1,1 D5,5 D6,6"),
    ("PE\u{c1}\u{c1}PUPA5,5", "D1,1 U5,5"),
    ("PE\u{c1}\u{c1}PUPE<=\u{c1}\u{c1}\u{c1}\u{c1};", "D1,1 U1,1 D2,2"),
    ("PE7aaPUPE7<aaaa;", "D1,1 U2,2 D3,3"),
    ("PE\u{c1}\u{c1}PUSPPUPUSPPA5,5", "D1,1 S0 S0 U5,5"),
    ("PE\u{c1}\u{c1}PUPUPUPUPUPUPA5,5", "D1,1 U5,5"),
    ("PE\u{c1}\u{c1}pu5,5;", "D1,1 U5,5"),
    ("PE\u{c1}\u{c1}PM0;PE\u{c1}\u{c1};PM2;PU7,7", "D1,1 U7,7"),
    ("PE\u{c1}\u{c1}PU", "D1,1 U1,1"),
    // the numbers of the data are not complete: that is said, and what follows is read
    (
        "PE\u{c1}PU5,5;",
        "<line 1, column 1 (byte 0): PE has an x of 1 without a y, which is left out: give coordinates in pairs> U5,5",
    ),
    // digits, not commands: a number of letters alone may be one, and its last digit decides
    ("PEPU\u{bf}\u{bf};", "D-712,0"),
];

#[test]
fn data_end_where_the_next_command_begins() {
    for (text, expected) in AT_THE_NEXT {
        assert_eq!(shown(text), expected, "{text:?}");
    }
}

#[test]
fn data_end_with_the_text_if_their_numbers_are_complete() {
    assert_eq!(shown("PE\u{c1}\u{c1}"), "D1,1");
    assert_eq!(shown("PE7aa"), "D1,1");
    assert_eq!(shown("PE"), "");
    // The first byte of what might be two counts as a digit after all.
    assert_eq!(shown("PE\u{c1}\u{c3}"), "D1,2");
    assert_eq!(
        shown("PE\u{c1}\u{c1}\u{c1}"),
        "D1,1 <line 1, column 1 (byte 0): PE has an x of 1 without a y, which is left out: give coordinates in pairs>"
    );
    assert_eq!(
        shown("PE\u{c1}\u{c1}?"),
        "D1,1 <line 1, column 1 (byte 0): PE lacks the last byte of its last number and is left out>"
    );
}

#[test]
fn data_end_where_the_language_does() {
    assert_eq!(shown("PE\u{c1}\u{c1}\u{1b}%0APD9,9;\u{1b}%0BPU5,5"), "D1,1 U5,5");
    assert_eq!(shown("PE\u{c1}\u{c1}\u{1b}EPD5,5;"), "D1,1 D5,5");
    // Device control stands anywhere, and ends nothing.
    assert_eq!(shown("PE\u{c1}\u{1b}.O\u{c1};PU5,5"), "D1,1 U5,5");
}

#[test]
fn what_does_not_belong_into_data_has_a_remedy_for_data() {
    assert_eq!(
        ops("PE=7aa,1;PU5,5"),
        "D1,1 <line 1, column 7 (byte 6): `,` does not belong into PE, whose rest is left out: its data are digits from `?` on \
         and the flags `<`, `=`, `>`, `:` and `7`; end them with `;`> U5,5"
    );
}
