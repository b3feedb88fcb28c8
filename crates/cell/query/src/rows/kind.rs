//! The kinds of queries.

use std::str::FromStr;

/// A query about one state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum QueryKind {
    /// Collision or not.
    Collision,
    /// Distance of the nearest pair.
    Distance,
    /// Whether the distance of any pair is at most this, m.
    Tolerance(f64),
    /// The collision point: of the pair in contact that is nearest to a base.
    Point,
    /// All triangles that touch.
    Contacts,
    /// The first contact of the motion to the next state.
    Time,
    /// The joint that is farthest beyond its limits.
    Limits,
}

/// A text that is not a query kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownQueryKind(String);

impl std::fmt::Display for UnknownQueryKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}; write collision, distance, tolerance=0.02 (metres), point, contacts, time or limits", self.0)
    }
}

impl std::error::Error for UnknownQueryKind {}

impl FromStr for QueryKind {
    type Err = UnknownQueryKind;

    /// `collision`, `distance`, `tolerance=METRES`, `point`, `contacts`, `time` or `limits`.
    ///
    /// ```
    /// use elbowroom_query::QueryKind;
    /// assert_eq!("tolerance=0.02".parse(), Ok(QueryKind::Tolerance(0.02)));
    /// assert!("tolerance".parse::<QueryKind>().is_err());
    /// ```
    fn from_str(word: &str) -> Result<Self, UnknownQueryKind> {
        match word {
            "collision" => return Ok(Self::Collision),
            "distance" => return Ok(Self::Distance),
            "point" => return Ok(Self::Point),
            "contacts" => return Ok(Self::Contacts),
            "time" => return Ok(Self::Time),
            "limits" => return Ok(Self::Limits),
            _ => {}
        }
        let Some(number) = word.strip_prefix("tolerance") else {
            return Err(UnknownQueryKind(format!("`{word}` is not a query kind")));
        };
        let Some(number) = number.strip_prefix('=') else {
            return Err(UnknownQueryKind("a tolerance needs a number".into()));
        };
        match number.trim().parse::<f64>() {
            Ok(t) if t >= 0.0 && t.is_finite() => Ok(Self::Tolerance(t)),
            _ => Err(UnknownQueryKind(format!("`{number}` is not a tolerance: a finite number of metres, 0 or more"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_query_kinds_are_errors_with_a_hint() {
        for word in
            ["", "touch", "tolerance", "tolerance=", "tolerance=-1", "tolerance=nan", "tolerance=inf", "tolerance:1"]
        {
            let message = word.parse::<QueryKind>().unwrap_err().to_string();
            assert!(message.contains("tolerance=0.02"), "{word}: {message}");
        }
        assert_eq!("tolerance=1e-3".parse(), Ok(QueryKind::Tolerance(0.001)));
    }
}
