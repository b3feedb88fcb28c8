//! Six equations, symmetric and positive definite.

/// Solves `a·x = b` by Cholesky decomposition; `None` where a pivot is not positive.
pub fn solve_spd(mut a: [[f64; 6]; 6], mut b: [f64; 6]) -> Option<[f64; 6]> {
    for j in 0..6 {
        for k in 0..j {
            a[j][j] -= a[j][k] * a[j][k];
        }
        if a[j][j].is_nan() || a[j][j] <= 0.0 {
            return None;
        }
        a[j][j] = a[j][j].sqrt();
        for i in j + 1..6 {
            for k in 0..j {
                a[i][j] -= a[i][k] * a[j][k];
            }
            a[i][j] /= a[j][j];
        }
    }
    for i in 0..6 {
        for k in 0..i {
            b[i] -= a[i][k] * b[k];
        }
        b[i] /= a[i][i];
    }
    for i in (0..6).rev() {
        for k in i + 1..6 {
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
        let got = solve_spd(a, b).unwrap();
        for i in 0..6 {
            assert!((got[i] - x[i]).abs() < 1e-12);
        }
        a[3][3] = -1.0;
        assert_eq!(solve_spd(a, b), None);
        a[3][3] = f64::NAN;
        assert_eq!(solve_spd(a, b), None);
    }
}
