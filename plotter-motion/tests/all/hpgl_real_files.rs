//! HPGL files in the manner of programs, and of programs where they are at hand: each is read to its end.

use crate::real_files::{all, name_of};
use plotter_motion::PlotOp;
use plotter_motion::hpgl::plot_ops;
use std::{fs, io};

/// What is said about a file, and why it has to be. About the others nothing is: whatever they ask for is
/// done, or means nothing to a machine with one pen.
#[cfg(feature = "font")]
const SAID: [(&str, &[&str]); 2] = [
    (
        // `PD:` for `PD;`, which hp2xx lets pass. A colon is no separator in any manual.
        "hp2xx_bz.hp",
        &[
            "line 5, column 3 (byte 37): `:` does not belong into PD, whose rest is left out: separate numbers by commas and \
       end the command with `;`",
        ],
    ),
    // HP's special symbols: the letters that stand for them are drawn.
    (
        "hp2xx_charsets.hp",
        &[
            "line 13, column 5 (byte 190): CS chooses character set 5, whose signs are not known here: labels are drawn in \
             ASCII; known are 0, 6, 7, 9, 30 to 39, and -1 for the characters of DL",
            "line 46, column 1 (byte 685): CS chooses character set 5, whose signs are not known here: labels are drawn in \
             ASCII; known are 0, 6, 7, 9, 30 to 39, and -1 for the characters of DL",
        ],
    ),
];

// Without the font, labels are reported.
#[cfg(feature = "font")]
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn nothing_is_said_about_good_files() -> io::Result<()> {
    for file in all("hpgl") {
        let text = fs::read(&file)?;
        let name = name_of(&file);
        let said: Vec<String> =
            plot_ops(&text).filter_map(Result::err).map(|error| error.to_string()).collect();
        let expected = SAID.iter().find(|(file, _)| *file == name).map_or(&[][..], |(_, said)| said);
        assert_eq!(said, expected, "{name}");
        let strict = plot_ops(&text).strict().flatten().count();
        // A notice stops nobody.
        let is_good = plot_ops(&text).filter_map(Result::err).all(|error| error.is_notice());
        assert_eq!(strict == plot_ops(&text).flatten().count(), is_good, "{name}, strictly");
        assert!(
            plot_ops(&text).flatten().filter_map(PlotOp::target).all(plotter_motion::Point::is_finite),
            "{name}"
        );
    }
    Ok(())
}

/// Lines of the files, as two readers that share no code with this one find them: one in another language,
/// written for this comparison, and hp2xx 3.4.4, whose coordinates agree too, to the 0.014 units that its
/// output resolves. Of ours the program that writes it counts them.
const LINES: [(&str, usize); 10] = [
    ("plan.plt", 80),
    ("hp2xx_acad.hp", 1987),
    ("hp2xx_la.hp", 36),
    ("hpgl_buddy_demo-g.hpgl", 1481),
    ("prod_gnuplot.hpgl", 242),
    // 1218 of them as they stand, the frame (EA), and two curves as dashes: counted by hp2xx alone
    ("prod_plotutils_hpgl2.hpgl", 1309),
    ("prod_vpype_hp7475a.hpgl", 193),
    ("vk2bea_Cassini.hpgl", 3239),
    ("vk2bea_HP8595E-FM.hpgl", 431),
    ("vk2bea_tektronix.hpgl", 2248),
];

/// The text without its labels: `LB` up to a byte 3, which all of these files end them with.
fn without_labels(text: &[u8]) -> Vec<u8> {
    let mut kept = Vec::new();
    let mut rest = text;
    while let Some(start) = rest.windows(2).position(|letters| letters == b"LB") {
        let (before, label) = rest.split_at(start);
        kept.extend_from_slice(before);
        let end = label.iter().position(|byte| *byte == 3).unwrap_or(label.len() - 1);
        rest = &label[end + 1..];
    }
    kept.extend_from_slice(rest);
    kept
}

#[test]
fn real_files_have_the_lines_that_other_readers_find() -> io::Result<()> {
    let files = all("hpgl").into_iter().map(|file| (name_of(&file), file));
    for (name, file) in files {
        let Some((_, expected)) = LINES.iter().find(|(of, _)| *of == name) else { continue };
        let text = fs::read(file)?;
        // Labels are left out: each reader draws its own letters.
        let lines =
            plot_ops(&without_labels(&text)).filter(|op| matches!(op, Ok(PlotOp::Draw { .. }))).count();
        assert_eq!(lines, *expected, "{name}");
    }
    Ok(())
}

#[test]
fn a_relative_drawing_ends_where_its_sums_say() -> io::Result<()> {
    for file in all("hpgl")
        .iter()
        .filter(|file| file.ends_with("plan.plt") || file.ends_with("prod_vpype_hp7475a.hpgl"))
    {
        let text = fs::read(file)?;
        let last = plot_ops(&text).flatten().filter_map(PlotOp::target).last();
        // PU11040,7721 after PA: the parking place of the HP 7475A's pen.
        assert_eq!(last.map(|to| (to.x * 40.0, to.y * 40.0)), Some((11040.0, 7721.0)));
    }
    Ok(())
}
