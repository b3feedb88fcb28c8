//! Controllers in TOML.

use std::fmt::Write;

use toml::de::{DeTable, DeValue};

use super::{Controller, FuzzyError, Rule, Set, Variable};

impl Controller {
    /// Reads variables and rules:
    ///
    /// ```toml
    /// [input.proximity]
    /// range = [0, 1]
    /// near = [0, 0, 0.2, 0.5]        # corners of a trapezoid
    /// far = [0.2, 0.5, 1, 1]
    ///
    /// [output.size]
    /// range = [0, 1]
    /// none = [-0.5, 0, 0, 0.5]
    /// large = [0.5, 1, 1, 1.5]
    ///
    /// [rules]
    /// list = ["if proximity is near then size is large", "if proximity is far then size is none"]
    /// ```
    ///
    /// # Errors
    /// [`FuzzyError`] with the line.
    pub fn from_toml(text: &str) -> Result<Self, FuzzyError> {
        let lines = Lines(text);
        let table = DeTable::parse(text).map_err(|e| {
            let what = format!("this is not TOML: {}", e.message().trim().replace('\n', ", "));
            FuzzyError::new(
                what,
                "tables as [input.NAME], sets as name = [a, b, c, d], rules in [rules] list = [\"…\"]",
            )
            .at(e.span().map(|s| lines.at(s.start)))
        })?;
        let (mut inputs, mut outputs, mut rules) = (Vec::new(), Vec::new(), None);
        for (key, value) in table.get_ref() {
            let line = lines.at(key.span().start);
            match (key.get_ref().as_ref(), value.get_ref()) {
                ("input", DeValue::Table(t)) => inputs = variables(t, &lines)?,
                ("output", DeValue::Table(t)) => outputs = variables(t, &lines)?,
                ("rules", DeValue::Table(t)) => rules = Some(sentences(t, &lines, line)?),
                (other, _) => {
                    return Err(FuzzyError::new(
                        format!("`{other}` is unknown here"),
                        "[input.NAME], [output.NAME] or [rules]",
                    )
                    .at(line));
                }
            }
        }
        let parse =
            |(line, sentence): (usize, String)| Rule::parse(&sentence, &inputs, &outputs).map_err(|e| e.at(line));
        let rules = rules.unwrap_or_default().into_iter().map(parse);
        let rules = rules.collect::<Result<_, _>>()?;
        Self::new(inputs, outputs, rules)
    }

    /// Writes the text that [`Controller::from_toml`] reads.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        for (role, list) in [("input", &self.inputs()), ("output", &self.outputs())] {
            for v in *list {
                _ = write!(text, "[{role}.{}]\nrange = [{}, {}]\n", v.name, v.range[0], v.range[1]);
                for (name, set) in &v.sets {
                    let [a, b, c, d] = set.corners();
                    _ = writeln!(text, "{name} = [{a}, {b}, {c}, {d}]");
                }
                text.push('\n');
            }
        }
        text += "[rules]\nlist = [\n";
        for rule in self.rules() {
            _ = writeln!(text, "  \"{}\",", rule.to_sentence(self.inputs(), self.outputs()));
        }
        text + "]\n"
    }
}

/// Line numbers of a text.
struct Lines<'a>(&'a str);

impl Lines<'_> {
    fn at(&self, offset: usize) -> usize {
        1 + self.0.bytes().take(offset).filter(|b| *b == b'\n').count()
    }
}

fn variables(table: &DeTable<'_>, lines: &Lines<'_>) -> Result<Vec<Variable>, FuzzyError> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    let mut list = Vec::new();
    for (key, value) in entries {
        let line = lines.at(key.span().start);
        let DeValue::Table(t) = value.get_ref() else {
            return Err(
                FuzzyError::new(format!("`{}` is no table", key.get_ref()), "[input.NAME] or [output.NAME]").at(line)
            );
        };
        list.push(variable(key.get_ref(), t, lines, line)?);
    }
    Ok(list)
}

fn variable(name: &str, table: &DeTable<'_>, lines: &Lines<'_>, line: usize) -> Result<Variable, FuzzyError> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    let mut range = None;
    let mut sets = Vec::new();
    for (key, value) in entries {
        let line = lines.at(key.span().start);
        let numbers = numbers(value.get_ref());
        if key.get_ref() == "range" {
            let Some([low, high]) = numbers.as_deref().and_then(|n| <[f64; 2]>::try_from(n).ok()) else {
                return Err(FuzzyError::new("`range` is not two numbers", "range = [low, high]").at(line));
            };
            range = Some([low, high]);
            continue;
        }
        let corners = numbers.as_deref().and_then(|n| <[f64; 4]>::try_from(n).ok());
        let Some(set) = corners.and_then(Set::new) else {
            let what = format!("the set `{}` is not four numbers that do not fall", key.get_ref());
            return Err(
                FuzzyError::new(what, format!("{} = [a, b, c, d] with a <= b <= c <= d", key.get_ref())).at(line)
            );
        };
        sets.push((key.get_ref().to_string(), set));
    }
    let range = range.ok_or_else(|| {
        FuzzyError::new(format!("`{name}` has no range"), "range = [low, high], in the variable's unit").at(line)
    })?;
    Ok(Variable { name: name.to_owned(), range, sets })
}

fn numbers(value: &DeValue<'_>) -> Option<Vec<f64>> {
    let DeValue::Array(list) = value else { return None };
    list.iter()
        .map(|v| match v.get_ref() {
            DeValue::Integer(i) => i.as_str().replace('_', "").parse().ok(),
            DeValue::Float(f) => f.as_str().replace('_', "").parse().ok(),
            _ => None,
        })
        .collect()
}

fn sentences(table: &DeTable<'_>, lines: &Lines<'_>, line: usize) -> Result<Vec<(usize, String)>, FuzzyError> {
    let wrong = |line: usize| FuzzyError::new("[rules] holds no list of texts", "list = [\"if … then …\", …]").at(line);
    let list = match table.iter().next() {
        Some((key, value)) if key.get_ref() == "list" && table.len() == 1 => value,
        _ => return Err(wrong(line)),
    };
    let DeValue::Array(list) = list.get_ref() else { return Err(wrong(lines.at(list.span().start))) };
    list.iter()
        .map(|v| {
            let line = lines.at(v.span().start);
            match v.get_ref() {
                DeValue::String(text) => Ok((line, text.to_string())),
                _ => Err(wrong(line)),
            }
        })
        .collect()
}
