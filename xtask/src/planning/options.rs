//! Options of `cargo xtask planning`.

use std::path::PathBuf;

/// Options of the command line.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Options {
    pub problems: Option<PathBuf>,
    pub urdf: Option<PathBuf>,
    pub srdf: Option<PathBuf>,
    pub validity: bool,
    pub anytime: bool,
    pub json: bool,
}

impl Options {
    /// Parses the words after `planning`.
    pub fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self::default();
        let mut words = words.iter();
        while let Some(&word) = words.next() {
            let file = match word {
                "--json" => {
                    options.json = true;
                    continue;
                }
                "--validity" => {
                    options.validity = true;
                    continue;
                }
                "--anytime" => {
                    options.anytime = true;
                    continue;
                }
                "--problems" => &mut options.problems,
                "--urdf" => &mut options.urdf,
                "--srdf" => &mut options.srdf,
                _ => {
                    let known =
                        "`--problems FILE`, `--urdf FILE`, `--srdf FILE`, `--validity`, `--anytime` and `--json`";
                    return Err(format!("`planning {word}`: the options are {known}"));
                }
            };
            *file = Some(words.next().ok_or_else(|| format!("`{word}` needs a file: `{word} FILE`"))?.into());
        }
        if options.validity && options.anytime {
            return Err("`--validity` and `--anytime` are two measurements: give one of them".into());
        }
        Ok(options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_mistakes_named() {
        let problems = Some(PathBuf::from("p.json"));
        let expected = Options { problems, json: true, ..Options::default() };
        assert_eq!(Options::parse(&["--json", "--problems", "p.json"]).unwrap(), expected);
        assert!(Options::parse(&["--validity"]).unwrap().validity);
        assert_eq!(Options::parse(&["--anytime"]).unwrap(), Options { anytime: true, ..Options::default() });
        assert!(Options::parse(&["--anytime", "--validity"]).unwrap_err().contains("one of them"));
        assert!(Options::parse(&["--urdf"]).unwrap_err().contains("--urdf FILE"));
        assert!(Options::parse(&["--udf"]).unwrap_err().contains("`planning --udf`"));
    }
}
