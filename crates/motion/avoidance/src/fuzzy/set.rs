//! Fuzzy sets.

/// A fuzzy set with a trapezoidal membership function: it rises from 0 at `corners[0]` to 1 between `corners[1]` and
/// `corners[2]`, and falls to 0 at `corners[3]`. Equal corners are vertical sides; a triangle has equal inner corners.
///
/// ```
/// use elbowroom_avoidance::fuzzy::Set;
/// let near = Set::new([0.1, 0.2, 0.3, 0.5]).unwrap();
/// assert_eq!([0.1, 0.15, 0.25, 0.4, 9.0].map(|x| (near.degree(x) * 1e9).round() / 1e9), [0.0, 0.5, 1.0, 0.5, 0.0]);
/// assert_eq!(near.degree(f64::NAN), 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Set {
    corners: [f64; 4],
}

impl Set {
    /// Creates a set; `None` unless the corners are finite and ascending.
    pub fn new(corners: [f64; 4]) -> Option<Self> {
        let is_valid = corners.iter().all(|c| c.is_finite()) && corners.windows(2).all(|w| w[0] <= w[1]);
        is_valid.then_some(Self { corners })
    }

    /// The corners, in the unit of the variable.
    pub fn corners(&self) -> [f64; 4] {
        self.corners
    }

    /// The degree of membership of `x`, 0 to 1; 0 for NaN.
    pub fn degree(&self, x: f64) -> f64 {
        let [a, b, c, d] = self.corners;
        if x >= b && x <= c {
            1.0
        } else if x > a && x < b {
            (x - a) / (b - a)
        } else if x > c && x < d {
            (d - x) / (d - c)
        } else {
            0.0
        }
    }
}
