//! The factors by which one unit taken for another is off.

/// A unit taken for another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mistake {
    /// How many times too large things become.
    pub factor: f64,
    /// What the numbers are.
    pub looks_like: &'static str,
    /// What they were read as.
    pub read_as: &'static str,
    /// In words.
    pub words: &'static str,
}

const fn mistake(factor: f64, looks_like: &'static str, read_as: &'static str, words: &'static str) -> Mistake {
    Mistake { factor, looks_like, read_as, words }
}

/// Largest first. 39.37 and 25.4 are too near to each other to be told apart by sizes: both are a matter of inches.
const ALL: [Mistake; 9] = [
    mistake(1000.0, "mm", "m", "its numbers look like mm, read as metres"),
    mistake(100.0, "cm", "m", "its numbers look like cm, read as metres"),
    mistake(1.0 / 0.0254, "in", "m", "its numbers look like inches (in), read as metres"),
    mistake(25.4, "in", "m", "its numbers look like inches (in) read as metres, or mm read as inches"),
    mistake(10.0, "mm", "cm", "its numbers look like mm, read as cm"),
    mistake(0.1, "cm", "mm", "its numbers look like cm, read as mm"),
    mistake(0.0254, "applied twice", "in", "looks like inches (in) applied twice: metres, read as inches"),
    mistake(0.01, "applied twice", "cm", "looks like cm applied twice: metres, read as cm"),
    mistake(0.001, "applied twice", "mm", "looks like mm applied twice: metres, read as mm"),
];

/// Beyond this factor either way a size is in doubt: half way to the least mistake, as ratios go.
const IN_DOUBT: f64 = 3.162;

/// The mistake that explains a size `times` too large, as ratios go; `None` where there is none to explain.
pub(super) fn nearest(times: f64) -> Option<Mistake> {
    if !(times > 0.0 && times.is_finite()) || (1.0 / IN_DOUBT..=IN_DOUBT).contains(&times) {
        return None;
    }
    let off = |m: &Mistake| (times / m.factor).ln().abs();
    ALL.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))
}

impl Mistake {
    /// What undoes it in a URDF, as a factor on what is there.
    pub fn remedy(&self) -> String {
        let digits = |v: f64| format!("{}", (v * 1e6).round() / 1e6);
        digits(1.0 / self.factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_is_named_though_the_size_is_not_known_well() {
        for of in [1.0 / 1.5, 1.0, 1.5] {
            let named = |factor: f64| nearest(factor * of).map(|m| (m.looks_like, m.read_as));
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
