//! A few equations, symmetric and positive definite.

/// Solves the leading `n` equations of `a·x = b` by Cholesky decomposition; `None` where a pivot is not positive. Reads
/// the lower triangle alone; what lies beyond `n` is returned as it came.
///
/// # Panics
/// Where `n` is larger than `N`.
#[inline]
pub fn solve_spd<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N], n: usize) -> Option<[f64; N]> {
    for j in 0..n {
        for k in 0..j {
            a[j][j] -= a[j][k] * a[j][k];
        }
        if a[j][j].is_nan() || a[j][j] <= 0.0 {
            return None;
        }
        a[j][j] = a[j][j].sqrt();
        for i in j + 1..n {
            for k in 0..j {
                a[i][j] -= a[i][k] * a[j][k];
            }
            a[i][j] /= a[j][j];
        }
    }
    for i in 0..n {
        for k in 0..i {
            b[i] -= a[i][k] * b[k];
        }
        b[i] /= a[i][i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            b[i] -= a[k][i] * b[k];
        }
        b[i] /= a[i][i];
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_what_it_should_and_refuses_the_rest() {
        let mut a = [[0.0; 6]; 6];
        let x = [1.0, -2.0, 3.0, -4.0, 5.0, -6.0];
        for i in 0..6 {
            for j in 0..6 {
                a[i][j] = 1.0 / (1.0 + i as f64 + j as f64); // Hilbert: a hard one
            }
            a[i][i] += 0.1;
        }
        let b: [f64; 6] = std::array::from_fn(|i| (0..6).map(|j| a[i][j] * x[j]).sum());
        let got = solve_spd(a, b, 6).unwrap();
        for i in 0..6 {
            assert!((got[i] - x[i]).abs() < 1e-12);
        }
        let b: [f64; 6] = std::array::from_fn(|i| (0..3).map(|j| a[i][j] * x[j]).sum());
        let got = solve_spd(a, b, 3).unwrap();
        for i in 0..6 {
            let expected = if i < 3 { x[i] } else { b[i] };
            assert!((got[i] - expected).abs() < 1e-12);
        }
        a[3][3] = -1.0;
        assert_eq!(solve_spd(a, b, 6), None);
        a[3][3] = f64::NAN;
        assert_eq!(solve_spd(a, b, 6), None);
    }
}
