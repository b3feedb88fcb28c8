//! Banded matrices: symmetric, with two diagonals beside the main one, as for quadratic splines.

/// The main diagonal and the two below it: `rows[i][k]` is the element (i, i − k).
#[derive(Debug, Default)]
pub(super) struct BandedMatrix {
    pub rows: Vec<[f64; 3]>,
}

impl BandedMatrix {
    pub fn clear(&mut self, order: usize) {
        self.rows.clear();
        self.rows.resize(order, [0.0; 3]);
    }

    /// Solves for a right-hand side in place by `LDLᵀ`, which overwrites the matrix. False if the matrix is not
    /// positive definite.
    pub fn solve(&mut self, x: &mut [f64]) -> bool {
        let rows = &mut self.rows;
        for i in 0..rows.len() {
            let second = if i > 1 { rows[i][2] } else { 0.0 };
            let mut first = if i > 0 { rows[i][1] } else { 0.0 };
            if i > 1 {
                first -= second * rows[i - 1][1];
            }
            let [mut l1, mut l2] = [0.0; 2];
            if i > 0 {
                l1 = first / rows[i - 1][0];
            }
            if i > 1 {
                l2 = second / rows[i - 2][0];
            }
            let pivot = rows[i][0] - l1 * first - l2 * second;
            if !(pivot > 0.0 && pivot.is_finite()) {
                return false;
            }
            rows[i] = [pivot, l1, l2];
            if i > 0 {
                x[i] -= l1 * x[i - 1];
            }
            if i > 1 {
                x[i] -= l2 * x[i - 2];
            }
        }
        for i in (0..rows.len()).rev() {
            x[i] /= rows[i][0];
            if i + 1 < rows.len() {
                x[i] -= rows[i + 1][1] * x[i + 1];
            }
            if i + 2 < rows.len() {
                x[i] -= rows[i + 2][2] * x[i + 2];
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::BandedMatrix;

    #[test]
    fn a_solution_satisfies_the_equations() {
        let matrix = BandedMatrix { rows: (0..9).map(|i| [5.0 + f64::from(i), -1.5, 0.7]).collect() };
        let right: Vec<f64> = (0..9).map(|i| f64::from(i * i) - 7.0).collect();
        let mut x = right.clone();
        assert!(BandedMatrix { rows: matrix.rows.clone() }.solve(&mut x));
        for i in 0..9_usize {
            let element = |j: usize| matrix.rows[i.max(j)].get(i.abs_diff(j)).copied().unwrap_or(0.0);
            let product: f64 = (0..9).map(|j| element(j) * x[j]).sum();
            assert!((product - right[i]).abs() < 1e-12, "row {i}: {product}");
        }
        assert!(!BandedMatrix { rows: vec![[1.0, 0.0, 0.0], [1.0, 2.0, 0.0]] }.solve(&mut [0.0; 2]));
    }
}
