//! The verbs of the command and their options, as `--help` prints them.

use std::fmt::Write as _;
use std::path::Path;

use xtask::shell;

/// Links to the guide of each verb.
const GUIDES: [(&str, &str); 19] = [
    ("run", "[cell file](cell-file.md#how-a-run-proceeds)"),
    ("check", "[laws](laws.md#2-what-the-warning-law-does-to-a-robot)"),
    ("query", "[queries](query.md)"),
    ("inspect", "[inspect](inspect.md)"),
    ("convert", "[models](models.md#writing), [recordings](recordings.md)"),
    ("map", "[map](map.md)"),
    ("plan", "[planning](plan.md)"),
    ("sweep", "[sweeps](python.md#sweeps)"),
    ("rules", "[avoidance](avoidance.md#the-rules)"),
    ("fixture", "[virtual fixtures](fixtures.md)"),
    ("teach", "[quickstart](quickstart.md#5-teach-a-region)"),
    ("watch", "[vision](vision.md#from-the-command-line)"),
    ("region", "[roles](roles.md), [controllers](controllers.md)"),
    ("example", "[the examples](#the-examples)"),
    ("live", "[live](live.md)"),
    ("control", "[control](control.md)"),
    ("view", "[view](view.md)"),
    ("replay", "[recordings](recordings.md#replay)"),
    ("completions", ""),
];

/// Columns to which help texts are wrapped, whatever the terminal.
const WIDTH: &str = "100";

/// A verb with what `--help` prints about it.
struct Verb {
    name: String,
    help: String,
    /// Verbs of this verb, such as `seal` of `region`.
    verbs: Vec<Verb>,
}

/// All verbs of the command.
pub struct Commands(Vec<Verb>);

impl Commands {
    /// Asks the program `elbowroom` beside this one.
    pub fn read(root: &Path) -> Result<Self, String> {
        let own = std::env::current_exe().map_err(|e| format!("the path of this program: {e}"))?;
        let program = own.with_file_name("elbowroom").to_string_lossy().into_owned();
        let help =
            |words: &[&str]| shell::output_with(root, &program, &[words, &["--help"]].concat(), &[("COLUMNS", WIDTH)]);
        Ok(Self(verbs(&[], &help(&[])?, &help)?))
    }

    /// The table of the verbs, in Markdown.
    ///
    /// # Errors
    /// A verb is not in [`GUIDES`].
    pub fn table(&self) -> Result<String, String> {
        // Writing to a String cannot fail.
        let mut table = "| verb | does | guide |\n| --- | --- | --- |\n".to_owned();
        for Verb { name, help, .. } in &self.0 {
            // The first paragraph.
            let about = help.lines().take_while(|line| !line.is_empty()).map(str::trim).collect::<Vec<_>>().join(" ");
            let guide = GUIDES.iter().find(|(verb, _)| verb == name);
            let (_, guide) = guide.ok_or_else(|| format!("the verb `{name}` has no guide in {}", file!()))?;
            let _ = writeln!(table, "| [`{name}`](options.md#{name}) | {about} | {guide} |");
        }
        Ok(table)
    }

    /// What `--help` prints for each verb, with a heading each, in Markdown.
    pub fn options(&self) -> String {
        let chapter = |verb: &Verb| {
            let own = format!("## {}\n\n{}", verb.name, block(&verb.help));
            let inner = |inner: &Verb| format!("\n### {} {}\n\n{}", verb.name, inner.name, block(&inner.help));
            verb.verbs.iter().map(inner).fold(own, |text, inner| text + &inner)
        };
        self.0.iter().map(chapter).collect::<Vec<_>>().join("\n")
    }
}

/// The verbs below `path` that `text`, its help, lists; `help` is the help of a verb.
fn verbs(path: &[&str], text: &str, help: &impl Fn(&[&str]) -> Result<String, String>) -> Result<Vec<Verb>, String> {
    let verb = |name: &str| {
        let path = [path, &[name]].concat();
        let help_text = help(&path)?;
        Ok(Verb { name: name.to_owned(), verbs: verbs(&path, &help_text, help)?, help: help_text })
    };
    listed(text).filter(|name| *name != "help").map(verb).collect()
}

/// Names of the verbs that a help lists.
fn listed(help: &str) -> impl Iterator<Item = &str> {
    let list = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    // Texts that are too long continue on lines without a name.
    let rows = list.take_while(|line| !line.is_empty()).filter_map(|line| line.trim().split_once("  "));
    rows.map(|(name, _)| name)
}

/// A text as a block of code, without spaces at the ends of lines.
fn block(text: &str) -> String {
    let lines = text.trim_end().lines().map(|line| line.trim_end().to_owned() + "\n");
    format!("```text\n{}```\n", lines.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verbs_of_verbs_are_found_and_help_is_not_one() {
        let help = |words: &[&str]| {
            Ok(match words {
                [] => "Top\n\nCommands:\n  region  Edit\n          regions\n  help    Print\n\nOptions:\n  -h\n",
                ["region"] => "Edit  \nregions\n\nCommands:\n  seal  Seal it\n",
                _ => "Seal\n\nOptions:\n  -h\n",
            }
            .to_owned())
        };
        let commands = Commands(verbs(&[], &help(&[]).unwrap(), &help).unwrap());
        let row =
            "| [`region`](options.md#region) | Edit regions | [roles](roles.md), [controllers](controllers.md) |\n";
        assert!(commands.table().unwrap().ends_with(row));
        let options = commands.options();
        assert!(
            options.starts_with("## region\n\n```text\nEdit\nregions\n\nCommands:\n  seal  Seal it\n```\n"),
            "{options}"
        );
        assert!(options.contains("\n### region seal\n\n```text\nSeal\n"), "{options}");
    }

    #[test]
    fn a_verb_without_a_guide_is_refused() {
        let verb = Verb { name: "dance".into(), help: String::new(), verbs: Vec::new() };
        assert!(Commands(vec![verb]).table().unwrap_err().contains("`dance`"));
    }
}
