//! The reader of G-code: words, numbers, comments, checksums, and what is wrong with them.

use plotter_motion::gcode::{Block, Error, Reader, Remark, Spacing, Word};

fn blocks(text: &[u8], spacing: Spacing) -> Vec<Result<Block, Error>> {
    let mut reader = Reader::with_spacing(spacing);
    let mut blocks: Vec<_> = text.iter().filter_map(|byte| reader.push(*byte)).collect();
    blocks.extend(reader.finish());
    blocks
}

/// The words of each line; a number without a letter after `#`.
fn words_by(text: impl AsRef<[u8]>, spacing: Spacing) -> String {
    let shown = |block: Result<Block, Error>| match block {
        Ok(block) => {
            let word =
                |word: &Word| if word.letter == Word::BARE { format!("#{word}") } else { word.to_string() };
            block.words().iter().map(word).collect::<Vec<_>>().join(" ")
        }
        Err(error) => format!("<{error}>"),
    };
    blocks(text.as_ref(), spacing).into_iter().map(shown).collect::<Vec<_>>().join("\n")
}

fn words(text: impl AsRef<[u8]>) -> String {
    words_by(text, Spacing::Free)
}

#[test]
fn words_need_no_blanks_and_no_case() {
    assert_eq!(words("N10G01X1.5Y-.5f+300"), "N10 G1 X1.5 Y-0.5 F300");
    assert_eq!(words("g 1 x 1.5\ty -2."), "G1 X1.5 Y-2");
    assert_eq!(words("G28 X Y\nG28X"), "G28 X Y\nG28 X");
    assert_eq!(words("G92.1\nG00\nM03"), "G92.1\nG0\nM3");
    assert_eq!(words("M1 90\nM4 127\nM2 U160 D90"), "M1 #90\nM4 #127\nM2 U160 D90");
}

#[test]
fn lines_end_in_every_way_and_empty_ones_are_none() {
    assert_eq!(words("G0\nG1\r\nG2\rG3"), "G0\nG1\nG2\nG3");
    assert_eq!(words("\n \r\n;\n()\n%\n(a)(b)\n/\nG0"), "G0");
    assert_eq!(words("\u{feff}G0 X1\n%\n"), "G0 X1");
    assert_eq!(words(b"G0\0X1\x1a"), "G0 X1");
    let lines = blocks(b"\n\nG0\r\nG1", Spacing::Free);
    let lines: Vec<u32> = lines.iter().map(|block| block.unwrap().position().line).collect();
    assert_eq!(lines, [3, 4]);
}

#[test]
fn comments_are_anywhere_and_end_with_their_line() {
    assert_eq!(words("(a)G0(b)X1(c)Y2;d (e) G9\nG1 (never ended\nG2"), "G0 X1 Y2\nG1\nG2");
    assert_eq!(words("M117 Hello, world!\nG1"), "M117\nG1");
    let remark = |text: &str| blocks(text.as_bytes(), Spacing::Free)[0].unwrap().remark();
    assert_eq!(remark("M0 (New Sheet)"), Some(Remark::NewSheet));
    assert_eq!(remark("M0 ; pen 3"), Some(Remark::Pen(3)));
    assert_eq!(remark("M0 (pen 3) (and so on)"), Some(Remark::Pen(3)));
    assert_eq!(remark("M0 (pen three)"), None);
    let alone = blocks(b"(new sheet)\n  (pen 3)\n", Spacing::Free);
    assert_eq!(alone.len(), 1);
    let block = alone[0].unwrap();
    assert_eq!((block.words(), block.remark()), (&[][..], Some(Remark::Pen(3))));
    assert_eq!(block.position().to_string(), "line 2, column 3 (byte 14)");
}

#[test]
fn a_line_with_a_checksum_has_to_be_right() {
    // The bytes of `N3 T0` by exclusive or are 57: the example of the RepRap wiki.
    let block = blocks(b"N3 T0*57\n", Spacing::Free)[0].unwrap();
    assert!(block.is_checked() && block.line_number() == Some(3));
    assert_eq!(words("N3 T0*57 ; right\nN3 T0* 57\n"), "N3 T0\nN3 T0");
    insta::assert_snapshot!(words("N3 T0*56\nN3 T1*57\nN3 T0*\nN3 T0*5x\n*57\nN3 T0*57"), @r#"
    <line 1, column 6 (byte 5): checksum *56 of a line whose bytes make *57: send it again>
    <line 2, column 6 (byte 14): checksum *57 of a line whose bytes make *56: send it again>
    <line 3, column 6 (byte 23): a checksum without its number: the bytes make *57>
    <line 4, column 8 (byte 32): `x` begins no word: a word is a letter and a number>
    <line 5, column 1 (byte 34): `*` begins no word: a word is a letter and a number>
    N3 T0
    "#);
}

#[test]
fn what_is_wrong_is_named_and_costs_its_line() {
    let many = (0..17).map(|number| format!("N{number}")).collect::<String>();
    let text = format!(
        "10 G1\nG1 X-\nG1 X1.2.3 Y1\nG1 X1e3\nG1 X#1\nG1 X--1\nX1000000001\n{many}\n$H\n10 20\nG1 X1\u{e4}\nG1X{}\nG1 X1\nG1 X1,5\nO10 sub\nO20 (a)\nG1 X[1+2]",
        "9".repeat(400)
    );
    insta::assert_snapshot!(words(text), @r#"
    <line 1, column 1 (byte 0): a number without its letter: a word is like `X10`>
    <line 2, column 4 (byte 9): X has a malformed number: a number is like `-12` or `0.5`>
    <line 3, column 4 (byte 15): X has a malformed number: a number is like `-12` or `0.5`>
    <line 4, column 4 (byte 28): X has a number with an exponent: write `1500`, not `1.5e3`>
    <line 5, column 5 (byte 37): `#` begins a variable, which is not reckoned here: have the numbers written out>
    <line 6, column 4 (byte 43): X has a malformed number: a number is like `-12` or `0.5`>
    <line 7, column 1 (byte 48): X with 1000000001: numbers reach from -1000000000 to 1000000000>
    <line 8, column 39 (byte 98): more than 16 words: divide the line>
    <line 9, column 1 (byte 102): $ speaks to the controller, not the plotter, and is left out>
    <line 10, column 1 (byte 105): a number without its letter: a word is like `X10`>
    <line 11, column 6 (byte 116): byte 0xC3 begins no word: a word is a letter and a number>
    <line 12, column 3 (byte 121): X with 999999999999999999…: numbers reach from -1000000000 to 1000000000>
    G1 X1
    <line 14, column 4 (byte 532): X has a malformed number: a number is like `-12` or `0.5`>
    <line 15, column 1 (byte 537): O10 controls a loop or a subprogram, which is not done here: have it written out>
    O20
    <line 17, column 5 (byte 557): `[` begins an expression, which is not reckoned here: have the numbers written out>
    "#);
}

#[test]
fn words_at_blanks_only_lose_what_follows_their_number() {
    let spaced = |text: &str| words_by(text, Spacing::Required);
    assert_eq!(spaced("G1X10 Y5"), "G1 Y5");
    assert_eq!(spaced("M1 90\r\nM2 U160 D90\nP\nM10"), "M1 #90\nM2 U160 D90\nP\nM10");
    assert_eq!(spaced("(G1 X5) ;G2 *71 $ G1.5.5 X- Y"), "X5 G1.5 X Y");
}
