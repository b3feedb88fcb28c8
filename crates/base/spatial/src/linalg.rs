//! Small dense linear algebra: Cholesky decomposition and eigenvalues of symmetric matrices.

/// Solves the leading `n` equations of `a·x = b` for a symmetric positive definite `a` by Cholesky decomposition.
///
/// Reads the lower triangle only; entries of `b` beyond `n` are returned unchanged. Returns `None` if a pivot is not
/// positive.
///
/// # Panics
/// Panics if `n` is larger than `N`.
///
/// ```
/// use elbowroom_spatial::linalg::solve_spd;
/// let a = [[4.0, 0.0], [2.0, 2.0]]; // the upper triangle is not read
/// assert_eq!(solve_spd(a, [8.0, 6.0], 2), Some([1.0, 2.0]));
/// assert_eq!(solve_spd([[-1.0]], [1.0], 1), None);
/// ```
#[inline]
pub fn solve_spd<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N], n: usize) -> Option<[f64; N]> {
    solve_spd_in_place(a.as_flattened_mut(), N, &mut b[..n]).then_some(b)
}

/// Solves `a·x = b` in place for a symmetric positive definite `a` by Cholesky decomposition.
///
/// The number of equations is the length of `b`. Row `i` of `a` begins at `i·stride`; only its lower triangle is
/// read. On return `a` holds the factor and `b` the solution. Returns false if a pivot is not positive; then `a` and
/// `b` are undefined.
///
/// # Panics
/// Panics if `a` is too short.
#[inline]
pub fn solve_spd_in_place(a: &mut [f64], stride: usize, b: &mut [f64]) -> bool {
    let n = b.len();
    for j in 0..n {
        let row = j * stride;
        for k in 0..j {
            a[row + j] -= a[row + k] * a[row + k];
        }
        let pivot = a[row + j];
        if pivot.is_nan() || pivot <= 0.0 {
            return false;
        }
        a[row + j] = pivot.sqrt();
        for i in j + 1..n {
            for k in 0..j {
                a[i * stride + j] -= a[i * stride + k] * a[row + k];
            }
            a[i * stride + j] /= a[row + j];
        }
    }
    for i in 0..n {
        for k in 0..i {
            b[i] -= a[i * stride + k] * b[k];
        }
        b[i] /= a[i * stride + i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            b[i] -= a[k * stride + i] * b[k];
        }
        b[i] /= a[i * stride + i];
    }
    true
}

/// Eigenvalues and eigenvectors (columns) of a symmetric matrix, in arbitrary order.
///
/// Performs 30 sweeps of cyclic Jacobi rotations (Golub and Van Loan, "Matrix Computations", 8.5).
///
/// ```
/// use elbowroom_spatial::linalg::symmetric_eigen;
/// let (mut values, _) = symmetric_eigen([[2.0, 1.0], [1.0, 2.0]]);
/// values.sort_by(f64::total_cmp);
/// assert!((values[0] - 1.0).abs() < 1e-15 && (values[1] - 3.0).abs() < 1e-15);
/// ```
pub fn symmetric_eigen<const N: usize>(mut a: [[f64; N]; N]) -> ([f64; N], [[f64; N]; N]) {
    let mut v = [[0.0; N]; N];
    for i in 0..N {
        v[i][i] = 1.0;
    }
    for _sweep in 0..30 {
        for p in 0..N {
            for q in p + 1..N {
                rotate(&mut a, &mut v, p, q);
            }
        }
    }
    (std::array::from_fn(|i| a[i][i]), v)
}

/// Applies the Jacobi rotation that zeroes entry (p, q).
fn rotate<const N: usize>(a: &mut [[f64; N]; N], v: &mut [[f64; N]; N], p: usize, q: usize) {
    if a[p][q].abs() < 1e-300 {
        return;
    }
    let tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = tau.signum() / (tau.abs() + tau.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for k in 0..N {
        (a[k][p], a[k][q]) = (c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]);
        (v[k][p], v[k][q]) = (c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]);
    }
    for k in 0..N {
        (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A Hilbert matrix, which is badly conditioned, with a stronger diagonal.
    fn hilbert() -> [[f64; 6]; 6] {
        let mut a = [[0.0; 6]; 6];
        for i in 0..6 {
            for j in 0..6 {
                a[i][j] = 1.0 / (1.0 + i as f64 + j as f64);
            }
            a[i][i] += 0.1;
        }
        a
    }

    #[test]
    fn positive_definite_systems_are_solved_and_others_refused() {
        let mut a = hilbert();
        let x = [1.0, -2.0, 3.0, -4.0, 5.0, -6.0];
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

    #[test]
    fn eigenvectors_are_orthonormal_and_rebuild_the_matrix() {
        let a = hilbert();
        let (values, v) = symmetric_eigen(a);
        for i in 0..6 {
            for j in 0..6 {
                let dot: f64 = (0..6).map(|k| v[k][i] * v[k][j]).sum();
                assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-14);
                let rebuilt: f64 = (0..6).map(|k| values[k] * v[i][k] * v[j][k]).sum();
                assert!((rebuilt - a[i][j]).abs() < 1e-14);
            }
        }
    }
}
