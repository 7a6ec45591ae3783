//! What stands in `results/*.toml`: a page in parts, and of each figure what it is, how it was made, when and
//! where.

use serde::Deserialize;

/// One file of the data, one page.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Topic {
    /// The name of the file.
    #[serde(skip)]
    pub(crate) name: String,
    pub(crate) title: String,
    /// Where `docs/limits.md` tells what does not work.
    pub(crate) limits: Option<String>,
    /// The page of `docs/notebook` that tells what was tried.
    pub(crate) tried: Option<String>,
    #[serde(rename = "part")]
    pub(crate) parts: Vec<Part>,
}

/// A part of a page; exactly one of these is there, and a level only with a heading.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Part {
    pub(crate) heading: Option<String>,
    /// 2 unless it is said.
    pub(crate) level: Option<usize>,
    /// Markdown.
    pub(crate) text: Option<String>,
    /// Commands of which no table is made.
    pub(crate) run: Option<Vec<String>>,
    pub(crate) table: Option<Table>,
}

/// Figures that one command gives.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Table {
    pub(crate) name: String,
    /// Gives the figures again.
    pub(crate) command: String,
    pub(crate) held: Held,
    /// A package and its tests that hold the figures, where the command does not.
    pub(crate) by: Option<String>,
    /// What a fresh clone has not, and how to get it.
    pub(crate) needs: Option<String>,
    pub(crate) machine: String,
    /// When it was measured, unless the row has a date of its own.
    pub(crate) date: String,
    pub(crate) columns: Vec<Column>,
    pub(crate) rows: Vec<Row>,
}

/// What runs the command, so that a figure which is not so any more is noticed.
#[derive(Clone, Copy, Deserialize, PartialEq, Eq, Debug)]
pub(crate) enum Held {
    #[serde(rename = "cargo test")]
    Tests,
    #[serde(rename = ".ci/run")]
    Ci,
    #[serde(rename = "by hand")]
    Hand,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Column {
    pub(crate) title: String,
    pub(crate) unit: Option<String>,
    #[serde(rename = "as", default)]
    pub(crate) role: Role,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Row {
    pub(crate) cells: Vec<String>,
    #[serde(rename = "as")]
    pub(crate) role: Option<Role>,
    pub(crate) date: Option<String>,
}

/// What a figure is.
#[derive(Clone, Copy, Default, Deserialize, PartialEq, Eq, Debug)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Role {
    /// No figure: what the row is of.
    Of,
    Asked,
    /// Of a paper, or of what it describes, built as described.
    Published,
    #[default]
    Ours,
    /// Of another program.
    Peer,
    /// Of an older version of ours.
    Before,
}

impl Role {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Role::Of => "of",
            Role::Asked => "asked",
            Role::Published => "published",
            Role::Ours => "ours",
            Role::Peer => "peer",
            Role::Before => "before",
        }
    }
}

impl Topic {
    pub(crate) fn read(name: &str, text: &str) -> Result<Topic, toml::de::Error> {
        let topic: Topic = toml::from_str(text)?;
        Ok(Topic { name: name.to_owned(), ..topic })
    }

    pub(crate) fn tables(&self) -> impl Iterator<Item = &Table> {
        self.parts.iter().filter_map(|part| part.table.as_ref())
    }

    /// What a file's form does not tell.
    pub(crate) fn problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        for (number, part) in self.parts.iter().enumerate() {
            let there =
                [part.heading.is_some(), part.text.is_some(), part.run.is_some(), part.table.is_some()];
            if there.iter().filter(|there| **there).count() != 1 {
                problems.push(format!("part {}: one of heading, text, run and table", number + 1));
            }
            if part.level.is_some_and(|level| part.heading.is_none() || !(2..=4).contains(&level)) {
                problems.push(format!("part {}: a level is a heading's, 2 to 4", number + 1));
            }
        }
        let mut names = Vec::new();
        for table in self.tables() {
            let name = &table.name;
            if names.contains(&name) {
                problems.push(format!("table {name}: there are two of this name"));
            }
            names.push(name);
            if table.columns.first().is_none_or(|first| first.role != Role::Of) {
                problems.push(format!("table {name}: the first column tells what a row is of"));
            }
            if !is_date(&table.date) {
                problems.push(format!("table {name}: {} is no date such as 2026-11-21", table.date));
            }
            for row in &table.rows {
                let begins = row.cells.first().map_or("", String::as_str);
                if row.cells.len() != table.columns.len() {
                    let [cells, columns] = [row.cells.len(), table.columns.len()];
                    problems.push(format!("table {name}, {begins}: {cells} cells in {columns} columns"));
                }
                if let Some(date) = row.date.as_ref().filter(|date| !is_date(date)) {
                    problems.push(format!("table {name}, {begins}: {date} is no date such as 2026-11-21"));
                }
            }
        }
        problems.into_iter().map(|problem| format!("results/{}.toml: {problem}", self.name)).collect()
    }
}

fn is_date(text: &str) -> bool {
    let form = "0000-00-00";
    text.len() == form.len()
        && text
            .bytes()
            .zip(form.bytes())
            .all(|(c, form)| if form == b'0' { c.is_ascii_digit() } else { c == form })
}

impl Table {
    /// What each row is of: the cells that say so. Where the first of several is empty it is that of the row
    /// above.
    pub(crate) fn labels(&self) -> Vec<String> {
        let places: Vec<usize> =
            (0..self.columns.len()).filter(|place| self.columns[*place].role == Role::Of).collect();
        let (mut labels, mut above) = (Vec::new(), String::new());
        for row in &self.rows {
            let mut cells: Vec<&str> =
                places.iter().map(|place| row.cells.get(*place).map_or("", String::as_str)).collect();
            if places.len() > 1 && cells[0].is_empty() {
                cells[0] = &above;
            }
            let label = cells.iter().copied().filter(|cell| !cell.is_empty()).collect::<Vec<_>>().join(" / ");
            above = cells.first().map_or_else(String::new, |first| (*first).to_owned());
            labels.push(label);
        }
        labels
    }

    /// What a figure is: its column says so, and where that says nothing its row.
    pub(crate) fn role(&self, column: &Column, row: &Row) -> Role {
        match column.role {
            Role::Ours => row.role.unwrap_or_default(),
            said => said,
        }
    }

    /// The first and the last day on which rows were measured.
    pub(crate) fn dates(&self) -> (&str, &str) {
        let dates = || self.rows.iter().map(|row| row.date.as_ref().unwrap_or(&self.date).as_str());
        (dates().min().unwrap_or(&self.date), dates().max().unwrap_or(&self.date))
    }
}

#[cfg(test)]
pub(crate) const SAMPLE: &str = r#"
title = "Lines"
[[part]]
text = "Some words."
[[part]]
[part.table]
name = "lines"
command = "cargo test -p plotter-motion --test all sim_contour::"
held = "cargo test"
machine = "any"
date = "2026-11-21"
columns = [
  { title = "", as = "of" }, { title = "by", as = "of" },
  { title = "mean", unit = "px" }, { title = "asked", as = "asked" },
]
rows = [
  { cells = ["flag", "the paper", "0.0991", "1"], as = "published", date = "2026-11-19" },
  { cells = ["", "ours", "0.0623", "1,000"] },
]
"#;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_without_its_first_word_has_that_of_the_row_above() {
        let topic = Topic::read("lines", SAMPLE).unwrap();
        assert!(topic.problems().is_empty());
        let table = topic.tables().next().unwrap();
        assert_eq!(table.labels(), ["flag / the paper", "flag / ours"]);
        assert_eq!(table.dates(), ("2026-11-19", "2026-11-21"));
        let role = |column: usize, row: usize| table.role(&table.columns[column], &table.rows[row]);
        assert_eq!(
            [role(0, 0), role(2, 0), role(3, 0), role(2, 1)],
            [Role::Of, Role::Published, Role::Asked, Role::Ours]
        );
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (right, wrong, said) in [
            ("\"0.0623\", ", "", "table lines, : 3 cells in 4 columns"),
            ("2026-11-19", "19 November", "table lines, flag: 19 November is no date"),
            ("text = \"Some words.\"", "", "part 1: one of heading"),
            ("{ title = \"\", as = \"of\" }", "{ title = \"\" }", "the first column tells"),
        ] {
            let text = SAMPLE.replace(right, wrong);
            let problems = Topic::read("lines", &text).unwrap().problems();
            assert!(problems.iter().any(|problem| problem.contains(said)), "{problems:?}");
        }
        let error =
            Topic::read("lines", &SAMPLE.replace("held = \"cargo test\"", "held = \"never\"")).err().unwrap();
        assert!(error.to_string().contains("line 9"), "{error}");
    }
}
