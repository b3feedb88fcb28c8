//! Fuzzy rules.

use super::Variable;

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
    /// The sentence has another form or contains an unknown name; the message lists the known names.
    pub fn parse(sentence: &str, inputs: &[Variable], outputs: &[Variable]) -> Result<Self, String> {
        let words: Vec<&str> = sentence.split_whitespace().collect();
        let then = words.iter().position(|w| *w == "then");
        let (Some(&"if"), Some(then)) = (words.first(), then) else {
            return Err(
                "a rule has the form: if INPUT is SET and INPUT is SET then OUTPUT is SET and OUTPUT is SET".into()
            );
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

fn clauses(words: &[&str], variables: &[Variable], role: &str) -> Result<Vec<(usize, usize)>, String> {
    let mut list = Vec::new();
    for clause in words.split(|w| *w == "and") {
        let &[name, "is", set] = clause else {
            return Err(format!("`{}` is no clause: write NAME is SET, joined by `and`", clause.join(" ")));
        };
        let Some(variable) = variables.iter().position(|v| v.name == name) else {
            let known: Vec<&str> = variables.iter().map(|v| v.name.as_str()).collect();
            return Err(format!("there is no {role} `{name}`: write one of {}", known.join(", ")));
        };
        let Some(number) = variables[variable].set(set) else {
            let known: Vec<&str> = variables[variable].sets.iter().map(|(n, _)| n.as_str()).collect();
            return Err(format!("{name} has no set `{set}`: write one of {}", known.join(", ")));
        };
        if list.iter().any(|(v, _)| *v == variable) {
            return Err(format!("`{name}` is named twice: give each {role} one set"));
        }
        list.push((variable, number));
    }
    Ok(list)
}
