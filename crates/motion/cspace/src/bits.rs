//! Rows of cells as bits of 64-bit words.

/// Sets bits `first..=last` of a row.
#[inline]
pub(crate) fn set_range(words: &mut [u64], first: u16, last: u16) {
    if first > last {
        return;
    }
    let (from, to) = (usize::from(first / 64), usize::from(last / 64));
    let (head, tail) = (!0 << (first % 64), !0 >> (63 - last % 64));
    if from == to {
        words[from] |= head & tail;
        return;
    }
    words[from] |= head;
    words[from + 1..to].fill(!0);
    words[to] |= tail;
}

/// Positions of the set bits, ascending.
pub(crate) fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (word != 0).then(|| word.trailing_zeros() as usize)?;
        word &= word - 1;
        Some(bit)
    })
}

/// Calls `found(first, last)` for every run of set bits.
pub(crate) fn for_each_run(words: &[u64], mut found: impl FnMut(u16, u16)) {
    let end = words.len() * 64;
    let mut k = 0;
    while k < end {
        let rest = words[k / 64] >> (k % 64);
        if rest == 0 {
            k = (k / 64 + 1) * 64;
            continue;
        }
        k += rest.trailing_zeros() as usize;
        let first = k;
        while k < end {
            let clear = !words[k / 64] >> (k % 64);
            if clear != 0 {
                k += clear.trailing_zeros() as usize;
                break;
            }
            k = (k / 64 + 1) * 64;
        }
        found(first as u16, (k - 1) as u16);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_found_as_bit_by_bit() {
        let mut state = 9;
        for round in 0..500 {
            let random = |state: &mut u64| elbowroom_testkit::random::linear_congruential(state);
            let words: [u64; 3] = [0; 3].map(|_| match round % 3 {
                0 => random(&mut state),
                1 => random(&mut state) | random(&mut state) << 1 | random(&mut state) >> 3 | !0 << (round % 64),
                _ => [0, !0][round / 3 % 2],
            });
            let bit = |k: usize| words[k / 64] >> (k % 64) & 1 == 1;
            let mut found = Vec::new();
            for_each_run(&words, |first, last| {
                assert!(first <= last && (last == 191 || !bit(usize::from(last) + 1)));
                found.extend(usize::from(first)..=usize::from(last));
            });
            assert_eq!(found, (0..192).filter(|&k| bit(k)).collect::<Vec<_>>());
        }
    }

    #[test]
    fn every_range_of_a_row_is_set_as_bit_by_bit() {
        for first in 0..150u16 {
            for last in 0..150u16 {
                let mut words = [0u64; 3];
                set_range(&mut words, first, last);
                for k in 0..192 {
                    assert_eq!(
                        words[k / 64] >> (k % 64) & 1 == 1,
                        (usize::from(first)..=usize::from(last)).contains(&k)
                    );
                }
            }
        }
    }
}
