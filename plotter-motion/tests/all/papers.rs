//! Tables of papers, for the tests that measure whether they still hold.

/// The cells of the row of a paper that begins with these words, without the first; `None` in a package,
/// which has no papers of the family, with a word.
pub(crate) fn row_of(paper: &str, begins: &str) -> Option<Vec<String>> {
    let Ok(text) = std::fs::read_to_string(format!("{}/../{paper}", env!("CARGO_MANIFEST_DIR"))) else {
        println!("skipped: {paper} of the family is not here");
        return None;
    };
    let row = text.lines().find(|line| line.starts_with(&format!("| {begins}")));
    let row = row.unwrap_or_else(|| panic!("{paper} has no row that begins with: {begins}"));
    Some(row.split('|').skip(2).map(|cell| cell.trim().to_owned()).collect())
}

/// Asserts that a row of a paper has these cells, in this order, with others before and between them.
pub(crate) fn assert_in(paper: &str, begins: &str, cells: &[String]) {
    let Some(row) = row_of(paper, begins) else { return };
    let mut rest = row.iter();
    for cell in cells {
        assert!(rest.any(|found| found == cell), "{paper}, \"{begins}\": {row:?}, measured {cells:?}");
    }
}
