//! Real HPGL files, where a collection of them lies beside the checkout: each is read to its end.

use plotter_motion::PlotOp;
use plotter_motion::hpgl::{Event, Reader, plot_ops};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::{fs, io};

fn collection() -> Option<PathBuf> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/real/hpgl"));
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: there is no collection of real files beside the checkout");
    None
}

/// Number of commands in a text, by mnemonic.
fn commands(text: &[u8]) -> BTreeMap<String, usize> {
    let mut reader = Reader::new();
    let mut counts = BTreeMap::new();
    for event in text.iter().filter_map(|byte| reader.push(*byte)) {
        if let Ok(Event::Command { command, .. }) = event {
            *counts.entry(command.to_string()).or_default() += 1;
        }
    }
    counts
}

#[test]
fn every_real_file_is_read_to_its_end() -> io::Result<()> {
    let Some(folder) = collection() else { return Ok(()) };
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    files.sort();
    for file in files {
        let text = fs::read(&file)?;
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (mut lines, mut unsupported, mut errors) = (0, BTreeMap::<String, usize>::new(), Vec::new());
        for op in plot_ops(&text) {
            match op {
                Ok(PlotOp::Draw { .. }) => lines += 1,
                Ok(_) => {}
                Err(notice) if notice.is_notice() => {
                    *unsupported
                        .entry(notice.command().map(|name| name.to_string()).unwrap_or_default())
                        .or_default() += 1;
                }
                Err(error) => errors.push(error.to_string()),
            }
        }
        let found = commands(&text);
        println!(
            "{name}: {} commands, {lines} lines, unsupported {unsupported:?}, errors {errors:#?}",
            found.values().sum::<usize>()
        );
        // All that these files hold is well formed but for one `PD:`.
        let expected_errors = usize::from(name == "hp2xx_bz.hp");
        assert_eq!(errors.len(), expected_errors, "{name}: {errors:#?}");
        let known: usize = ["IN", "DF", "SP", "VS", "PU", "PD", "PA", "PR", "CI", "AA", "PG", "DT", "CO"]
            .iter()
            .filter_map(|known| found.get(*known))
            .sum();
        assert_eq!(
            known + unsupported.values().sum::<usize>(),
            found.values().sum::<usize>(),
            "{name}: every command is done or reported"
        );
    }
    Ok(())
}

/// Lines of the files, as two readers that share no code with this one find them: one in another language, written
/// for this comparison, and hp2xx 3.4.4, whose coordinates agree too, to the 0.014 units that its output resolves.
const LINES: [(&str, usize); 9] = [
    ("hp2xx_acad.hp", 1987),
    ("hp2xx_la.hp", 36),
    ("hpgl_buddy_demo-g.hpgl", 1481),
    ("prod_gnuplot.hpgl", 242),
    ("prod_plotutils_hpgl2.hpgl", 1219),
    ("prod_vpype_hp7475a.hpgl", 193),
    ("vk2bea_Cassini.hpgl", 3239),
    ("vk2bea_HP8595E-FM.hpgl", 431),
    ("vk2bea_tektronix.hpgl", 2248),
];

#[test]
fn real_files_have_the_lines_that_other_readers_find() -> io::Result<()> {
    let Some(folder) = collection() else { return Ok(()) };
    for (name, expected) in LINES {
        let text = fs::read(folder.join(name))?;
        let lines = plot_ops(&text).filter(|op| matches!(op, Ok(PlotOp::Draw { .. }))).count();
        assert_eq!(lines, expected, "{name}");
    }
    Ok(())
}

#[test]
fn a_relative_drawing_ends_where_its_sums_say() -> io::Result<()> {
    let Some(folder) = collection() else { return Ok(()) };
    let text = fs::read(folder.join("prod_vpype_hp7475a.hpgl"))?;
    let last = plot_ops(&text).flatten().filter_map(PlotOp::target).last();
    // PU11040,7721 after PA: the parking place of the HP 7475A's pen.
    assert_eq!(last.map(|to| (to.x * 40.0, to.y * 40.0)), Some((11040.0, 7721.0)));
    Ok(())
}
