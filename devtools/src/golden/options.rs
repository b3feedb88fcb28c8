//! Options of `cargo xtask golden`.

use std::path::PathBuf;

use super::part::Part;

/// Options of `cargo xtask golden`.
#[derive(Debug, PartialEq)]
pub struct Options {
    pub data: Option<PathBuf>,
    /// Number of random states over all robots.
    pub rows: usize,
    /// Number of random cells.
    pub cells: usize,
    /// Number of seeds per planning problem, from 0.
    pub seeds: usize,
    /// The only part to hash.
    only: Option<Part>,
    /// The record to write.
    pub out: Option<PathBuf>,
    /// The record to compare with.
    pub against: Option<PathBuf>,
    pub json: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { data: None, rows: 1_000_000, cells: 1000, seeds: 5, only: None, out: None, against: None, json: false }
    }
}

impl Options {
    pub fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self::default();
        let mut words = words.iter();
        while let Some(word) = words.next() {
            let mut value = || words.next().copied().ok_or(format!("`golden {word}` needs a value"));
            let mut count = || xtask::call::count(&format!("golden {word}"), value()?);
            match *word {
                "--rows" => options.rows = count()?,
                "--cells" => options.cells = count()?,
                "--seeds" => options.seeds = count()?,
                "--data" => options.data = Some(value()?.into()),
                "--out" => options.out = Some(value()?.into()),
                "--against" => options.against = Some(value()?.into()),
                "--only" => options.only = Some(part(value()?)?),
                "--json" => options.json = true,
                other => return Err(format!("`golden` does not know `{other}`")),
            }
        }
        Ok(options)
    }

    /// Returns the parts to hash.
    pub fn parts(&self) -> impl Iterator<Item = Part> {
        Part::ALL.into_iter().filter(|part| self.only.is_none_or(|only| only == *part))
    }
}

fn part(word: &str) -> Result<Part, String> {
    let known = Part::ALL.into_iter().find(|part| part.name() == word);
    known.ok_or_else(|| format!("`golden --only {word}`: write queries, overrides or plans"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_nonsense_is_refused() {
        let words = ["--data", "d", "--rows", "7", "--cells", "8", "--seeds", "9", "--only", "plans", "--json"];
        let options = Options::parse(&words).unwrap();
        let (rows, cells, seeds, only) = (7, 8, 9, Some(Part::Plans));
        let expected = Options { data: Some("d".into()), rows, cells, seeds, only, json: true, ..Options::default() };
        assert_eq!(options, expected);
        assert_eq!(options.parts().collect::<Vec<_>>(), [Part::Plans]);
        assert_eq!(Options::default().parts().count(), 3);
        for words in [&["--rows"][..], &["--rows", "0"], &["--only", "all"], &["--out"], &["--fast"]] {
            assert!(Options::parse(words).is_err(), "{words:?}");
        }
    }
}
