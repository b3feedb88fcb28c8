//! Factors between units that are mistaken for each other.

use super::UnitLabel;

/// A unit mistaken for another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UnitConfusion {
    /// Factor by which lengths are too large.
    pub factor: f64,
    /// The unit of the numbers.
    pub looks_like: UnitLabel,
    /// The unit as which they were read.
    pub read_as: UnitLabel,
    /// Description for messages.
    pub words: &'static str,
}

const fn confusion(factor: f64, looks_like: UnitLabel, read_as: UnitLabel, words: &'static str) -> UnitConfusion {
    UnitConfusion { factor, looks_like, read_as, words }
}

/// All confusions, largest factor first. Sizes cannot distinguish 39.37 and 25.4: both involve inches.
const ALL: [UnitConfusion; 9] = [
    confusion(1000.0, UnitLabel::Millimetre, UnitLabel::Metre, "its numbers look like mm, read as metres"),
    confusion(100.0, UnitLabel::Centimetre, UnitLabel::Metre, "its numbers look like cm, read as metres"),
    confusion(1.0 / 0.0254, UnitLabel::Inch, UnitLabel::Metre, "its numbers look like inches (in), read as metres"),
    confusion(
        25.4,
        UnitLabel::Inch,
        UnitLabel::Metre,
        "its numbers look like inches (in) read as metres, or mm read as inches",
    ),
    confusion(10.0, UnitLabel::Millimetre, UnitLabel::Centimetre, "its numbers look like mm, read as cm"),
    confusion(0.1, UnitLabel::Centimetre, UnitLabel::Millimetre, "its numbers look like cm, read as mm"),
    confusion(
        0.0254,
        UnitLabel::AppliedTwice,
        UnitLabel::Inch,
        "looks like inches (in) applied twice: metres, read as inches",
    ),
    confusion(0.01, UnitLabel::AppliedTwice, UnitLabel::Centimetre, "looks like cm applied twice: metres, read as cm"),
    confusion(0.001, UnitLabel::AppliedTwice, UnitLabel::Millimetre, "looks like mm applied twice: metres, read as mm"),
];

/// Factor beyond which sizes are suspect: the geometric mean of 1 and the smallest factor.
const SUSPECT_FACTOR: f64 = 3.162;

/// The confusion whose factor is closest to `times` on a logarithmic scale; `None` if `times` is not suspect.
pub(super) fn nearest(times: f64) -> Option<UnitConfusion> {
    if !(times > 0.0 && times.is_finite()) || (1.0 / SUSPECT_FACTOR..=SUSPECT_FACTOR).contains(&times) {
        return None;
    }
    let off = |m: &UnitConfusion| (times / m.factor).ln().abs();
    ALL.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))
}

impl UnitConfusion {
    /// The correction factor for a URDF.
    pub fn remedy(&self) -> String {
        let digits = |v: f64| format!("{}", (v * 1e6).round() / 1e6);
        digits(1.0 / self.factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_is_named_though_the_size_is_uncertain() {
        for of in [1.0 / 1.5, 1.0, 1.5] {
            let named = |factor: f64| nearest(factor * of).map(|m| (m.looks_like.symbol(), m.read_as.symbol()));
            assert_eq!(named(1.0), None);
            assert_eq!(named(1000.0), Some(("mm", "m")));
            assert_eq!(named(100.0), Some(("cm", "m")));
            assert_eq!(named(39.37), Some(("in", "m")));
            assert_eq!(named(25.4), Some(("in", "m")));
            assert_eq!(named(10.0), Some(("mm", "cm")));
            assert_eq!(named(0.1), Some(("cm", "mm")));
            assert_eq!(named(0.0254), Some(("applied twice", "in")));
            assert_eq!(named(0.001), Some(("applied twice", "mm")));
        }
        assert_eq!(nearest(f64::NAN), None);
        assert_eq!(nearest(0.0), None);
    }
}
