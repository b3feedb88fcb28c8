//! Fuzzy rules.

use super::{FuzzyError, Variable};

/// Hint for a sentence of another form.
const EXAMPLE: &str = "a rule as: if INPUT is SET then OUTPUT is SET";

/// A rule: `if` all conditions hold, `then` all conclusions hold to the degree of the weakest condition.
///
/// Written as a sentence: `if proximity is near and speed is fast then size is large and direction is aside`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rule {
    /// Indices of input and set.
    pub conditions: Vec<(usize, usize)>,
    /// Indices of output and set.
    pub conclusions: Vec<(usize, usize)>,
}

impl Rule {
    /// Reads a sentence.
    ///
    /// # Errors
    /// [`FuzzyError`] without a line, if the sentence has another form or contains an unknown name; the hint lists the
    /// known names.
    pub fn parse(sentence: &str, inputs: &[Variable], outputs: &[Variable]) -> Result<Self, FuzzyError> {
        let words: Vec<&str> = sentence.split_whitespace().collect();
        let then = words.iter().position(|w| *w == "then");
        let (Some(&"if"), Some(then)) = (words.first(), then) else {
            let what = "a rule has the form: if INPUT is SET and INPUT is SET then OUTPUT is SET and OUTPUT is SET";
            return Err(FuzzyError::new(what, EXAMPLE));
        };
        let conditions = clauses(&words[1..then], inputs, "input")?;
        let conclusions = clauses(&words[then + 1..], outputs, "output")?;
        Ok(Self { conditions, conclusions })
    }

    /// Writes the rule as a sentence.
    pub fn to_sentence(&self, inputs: &[Variable], outputs: &[Variable]) -> String {
        let write = |variables: &[Variable], list: &[(usize, usize)]| {
            let clause = |&(v, s): &(usize, usize)| format!("{} is {}", variables[v].name, variables[v].sets[s].0);
            list.iter().map(clause).collect::<Vec<_>>().join(" and ")
        };
        format!("if {} then {}", write(inputs, &self.conditions), write(outputs, &self.conclusions))
    }
}

fn clauses(words: &[&str], variables: &[Variable], role: &str) -> Result<Vec<(usize, usize)>, FuzzyError> {
    let unknown = |what: String, known: Vec<&str>| FuzzyError::new(what, format!("one of {}", known.join(", ")));
    let mut list = Vec::new();
    for clause in words.split(|w| *w == "and") {
        let &[name, "is", set] = clause else {
            let what = format!("`{}` is no clause", clause.join(" "));
            return Err(FuzzyError::new(what, "NAME is SET, joined by `and`"));
        };
        let Some(variable) = variables.iter().position(|v| v.name == name) else {
            let known = variables.iter().map(|v| v.name.as_str()).collect();
            return Err(unknown(format!("there is no {role} `{name}`"), known));
        };
        let Some(number) = variables[variable].set(set) else {
            let known = variables[variable].sets.iter().map(|(n, _)| n.as_str()).collect();
            return Err(unknown(format!("{name} has no set `{set}`"), known));
        };
        if list.iter().any(|(v, _)| *v == variable) {
            return Err(FuzzyError::new(format!("`{name}` is named twice: give each {role} one set"), EXAMPLE));
        }
        list.push((variable, number));
    }
    Ok(list)
}
