//! The rest of a step's path as a polyline in joint space.

/// Time (s) between samples of a path.
pub(crate) const SAMPLE_S: f64 = 0.01;
/// Largest distance (rad or m, Euclidean) from a sample to the polyline.
const CHORD: f64 = 5e-4;
/// Distance to a line (rad or m) up to which samples are on it: above rounding, below the deviation of a rounded
/// corner.
const ON_LINE: f64 = 1e-7;

/// The path from the present point to the end of a step.
#[derive(Debug, Clone)]
pub struct PathAhead {
    /// Times in the step (s, at override 1) and joint values.
    pub(super) samples: Vec<(f64, Vec<f64>)>,
    /// Indices of the samples that are corners of the polyline, including the first and the last.
    corners: Vec<usize>,
}

impl PathAhead {
    /// Of samples that are [`SAMPLE_S`] apart, from the present on: times in the step (s, at override 1) and joint values (rad or
    /// m); `None` without any.
    pub(crate) fn of(samples: Vec<(f64, Vec<f64>)>) -> Option<Self> {
        let last = samples.len().checked_sub(1)?;
        let mut corners = vec![0];
        while let Some(&start) = corners.last().filter(|&&start| start < last) {
            corners.push(end_of_chord(&samples, start));
        }
        Some(Self { samples, corners })
    }

    /// The corners of the polyline.
    pub(super) fn polyline(&self) -> Vec<&[f64]> {
        self.corners.iter().map(|i| &self.samples[*i].1[..]).collect()
    }

    /// Time in the step (s) of the last sample before the fraction `share` of the segment that ends at a corner.
    pub(super) fn time_before(&self, corner: usize, share: f64) -> f64 {
        let Some(first) = corner.checked_sub(1).map(|c| self.corners[c]) else { return self.samples[0].0 };
        let last = self.corners[corner];
        let (from, to) = (&self.samples[first].1, &self.samples[last].1);
        let is_before = |s: &&(f64, Vec<f64>)| share_along(&s.1, from, to) <= share;
        self.samples[first..=last].iter().take_while(is_before).last().map_or(self.samples[first].0, |s| s.0)
    }

    /// Time in the step (s) and joint values `length` (rad or m) ahead, if the path is straight up to there.
    pub(super) fn straight_ahead(&self, along: &[f64], length: f64) -> Option<(f64, Vec<f64>)> {
        let here = &self.samples.first()?.1;
        let beyond = self.samples.iter().find(|(_, q)| distance(q, here) >= length)?;
        let is_on_line = |q: &[f64]| {
            let far = distance(q, here);
            let on_line = here.iter().zip(along).map(|(h, a)| h + a * far);
            on_line.zip(q).all(|(a, b)| (a - b).abs() <= ON_LINE)
        };
        let passed = self.samples.iter().take_while(|(t_s, _)| *t_s <= beyond.0);
        let end = here.iter().zip(along).map(|(h, a)| h + a * length).collect();
        passed.into_iter().all(|(_, q)| is_on_line(q)).then_some((beyond.0, end))
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Fraction of the segment from `a` to `b` at its point nearest to `q`.
fn share_along(q: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let square: f64 = a.iter().zip(b).map(|(a, b)| (b - a).powi(2)).sum();
    let along: f64 = q.iter().zip(a).zip(b).map(|((q, a), b)| (q - a) * (b - a)).sum();
    if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 }
}

/// Finds a far sample, by doubling and halving, whose line to `start` is near all samples between.
///
/// The line to the next sample always is.
fn end_of_chord(samples: &[(f64, Vec<f64>)], start: usize) -> usize {
    let from = &samples[start].1;
    let is_chord = |end: usize| {
        samples[start + 1..end].iter().all(|(_, q)| distance_to_segment(q, from, &samples[end].1) <= CHORD)
    };
    let last = samples.len() - 1;
    let (mut good, mut bad) = (start + 1, last + 1);
    let mut length = 2;
    while good < last && bad > last {
        let end = (start + length).min(last);
        if is_chord(end) {
            good = end;
        } else {
            bad = end;
        }
        length *= 2;
    }
    while bad - good > 1 {
        let end = good.midpoint(bad);
        if is_chord(end) {
            good = end;
        } else {
            bad = end;
        }
    }
    good
}

fn distance_to_segment(q: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let share = share_along(q, a, b);
    let square = |((q, a), b): ((&f64, &f64), &f64)| (a + (b - a) * share - q).powi(2);
    q.iter().zip(a).zip(b).map(square).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_near_the_chords_and_straight_stretches_are_one() {
        // A straight line, a curve, and a stop at the end.
        let straight = (0..=300).map(|i| vec![f64::from(i) * 0.01, 0.0]);
        let curve = (1..=200).map(|i| f64::from(i) * 0.01).map(|a| vec![3.0 + a.sin(), 1.0 - a.cos()]);
        let end = vec![3.0 + 2.0_f64.sin(), 1.0 - 2.0_f64.cos()];
        let rest = std::iter::repeat_n(end, 20);
        let samples: Vec<_> =
            straight.chain(curve).chain(rest).enumerate().map(|(i, q)| (i as f64 * SAMPLE_S, q)).collect();
        let mut corners = vec![0];
        while corners[corners.len() - 1] < samples.len() - 1 {
            corners.push(end_of_chord(&samples, corners[corners.len() - 1]));
        }
        for pair in corners.windows(2) {
            let between = &samples[pair[0]..=pair[1]];
            let (from, to) = (&samples[pair[0]].1, &samples[pair[1]].1);
            assert!(pair[0] < pair[1] && between.iter().all(|(_, q)| distance_to_segment(q, from, to) <= CHORD));
        }
        // An arc of radius 1 leaves its chord of angle a by a²/8: at least 32 chords of 0.063 for 2 rad.
        assert!((300..=304).contains(&corners[1]) && (33..=45).contains(&corners.len()), "{corners:?}");
    }
}
