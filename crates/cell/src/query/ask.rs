//! What is asked.

use std::str::FromStr;

/// A question about one state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ask {
    /// Does anything touch?
    Collision,
    /// How far apart is the nearest pair?
    Distance,
    /// Is any pair not farther apart than this, m?
    Tolerance(f64),
}

/// A word that is no question.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownAsk(String);

impl std::fmt::Display for UnknownAsk {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}; write collision, distance, or tolerance=0.02 (metres)", self.0)
    }
}

impl std::error::Error for UnknownAsk {}

impl FromStr for Ask {
    type Err = UnknownAsk;

    /// `collision`, `distance` or `tolerance=METRES`.
    ///
    /// ```
    /// use elbowroom_cell::query::Ask;
    /// assert_eq!("tolerance=0.02".parse(), Ok(Ask::Tolerance(0.02)));
    /// assert!("tolerance".parse::<Ask>().is_err());
    /// ```
    fn from_str(word: &str) -> Result<Self, UnknownAsk> {
        match word {
            "collision" => return Ok(Self::Collision),
            "distance" => return Ok(Self::Distance),
            _ => {}
        }
        let Some(number) = word.strip_prefix("tolerance") else {
            return Err(UnknownAsk(format!("`{word}` is no question")));
        };
        let Some(number) = number.strip_prefix('=') else {
            return Err(UnknownAsk("a tolerance needs a number".into()));
        };
        match number.trim().parse::<f64>() {
            Ok(t) if t >= 0.0 && t.is_finite() => Ok(Self::Tolerance(t)),
            _ => Err(UnknownAsk(format!("`{number}` is no tolerance: a finite number of metres, 0 or more"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_that_are_no_question_say_what_to_write() {
        for word in
            ["", "touch", "tolerance", "tolerance=", "tolerance=-1", "tolerance=nan", "tolerance=inf", "tolerance:1"]
        {
            let message = word.parse::<Ask>().unwrap_err().to_string();
            assert!(message.contains("tolerance=0.02"), "{word}: {message}");
        }
        assert_eq!("tolerance=1e-3".parse(), Ok(Ask::Tolerance(0.001)));
    }
}
