//! Cycles in chains of references.

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Visit {
    New,
    OnTrail,
    Done,
}

/// Returns one element of every cycle among `count` elements. Each element refers to at most one `next`.
pub(crate) fn find_cycles(count: usize, next: impl Fn(usize) -> Option<usize>) -> Vec<usize> {
    let mut cycles = Vec::new();
    let mut visits = vec![Visit::New; count];
    let mut trail = Vec::new();
    for start in 0..count {
        let mut element = Some(start);
        while let Some(i) = element {
            match visits[i] {
                Visit::New => {
                    visits[i] = Visit::OnTrail;
                    trail.push(i);
                    element = next(i);
                }
                Visit::OnTrail => {
                    cycles.push(i);
                    break;
                }
                Visit::Done => break,
            }
        }
        trail.drain(..).for_each(|i| visits[i] = Visit::Done);
    }
    cycles
}

#[cfg(test)]
mod tests {
    use super::find_cycles;

    #[test]
    fn every_cycle_is_found_once() {
        // 0 → 1 → 2 → 1, 3 → 3, 4 → 0, 5.
        let next = [Some(1), Some(2), Some(1), Some(3), Some(0), None];
        assert_eq!(find_cycles(next.len(), |i| next[i]), [1, 3]);
        assert!(find_cycles(3, |i| i.checked_sub(1)).is_empty());
    }
}
