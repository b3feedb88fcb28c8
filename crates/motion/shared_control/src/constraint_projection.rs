//! The vector nearest to a desired one that keeps a set of linear constraints.

use elbowroom_spatial::Vec3;

/// A constraint on a velocity or a displacement: its part along `normal` is at least `least`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearConstraint {
    /// Unit vector.
    pub normal: Vec3,
    /// Least part along the normal, m/s or metres. Not above 0 if standing still keeps the constraint.
    pub least: f64,
}

/// The constraints exclude every vector of a usable length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("no vector of a usable length keeps all constraints")]
pub struct Contradiction;

/// Violation up to which a row counts as kept, relative to the largest number of the problem.
const TOLERANCE: f64 = 1e-12;
/// Length, relative to that number, beyond which a result is not usable: constraints that nearly contradict each other.
const LONGEST: f64 = 1e3;
/// Length below which a unit normal counts as a combination of the active ones.
const DEPENDENT: f64 = 1e-9;

/// The vector nearest to `desired` that keeps all constraints, and the number of constraints that decide it.
///
/// Dual active-set method (Goldfarb and Idnani, 1983) for three unknowns: from the desired vector, the most violated
/// constraint is added until none is left, and those that would pull are dropped. The result minus the desired vector is
/// a sum of normals with factors that are not negative: what is tangential to every active constraint is kept. It never
/// allocates.
///
/// # Errors
/// [`Contradiction`] if no vector keeps all constraints, or only one a thousand times longer than every number given, or
/// a number is not finite.
///
/// ```
/// use elbowroom_shared_control::{LinearConstraint, project_onto_constraints};
/// use elbowroom_spatial::Vec3;
/// // A floor and a wall; the hand pushes into both and along their edge.
/// let rows = [LinearConstraint { normal: Vec3::Z, least: 0.0 }, LinearConstraint { normal: Vec3::X, least: 0.0 }];
/// let (velocity, active) = project_onto_constraints(Vec3::new(-0.2, 0.1, -0.3), &rows)?;
/// assert_eq!((velocity, active), (Vec3::new(0.0, 0.1, 0.0), 2));
/// # Ok::<(), elbowroom_shared_control::Contradiction>(())
/// ```
pub fn project_onto_constraints(
    desired: Vec3,
    constraints: &[LinearConstraint],
) -> Result<(Vec3, usize), Contradiction> {
    let scale = constraints.iter().map(|r| r.least.abs()).fold(desired.length(), f64::max);
    if !(desired.is_finite()
        && scale.is_finite()
        && constraints.iter().all(|r| r.normal.is_finite() && r.least.is_finite()))
    {
        return Err(Contradiction);
    }
    let mut search =
        Search { vector: desired, constraints, active: ActiveSet::default(), tolerance: scale * TOLERANCE };
    // Every addition makes the distance from the desired vector larger, so no active set comes twice; the bound is for
    // rounding.
    for _ in 0..(16 + 4 * constraints.len()) {
        match search.most_violated() {
            None if search.vector.length() > LONGEST * scale => return Err(Contradiction),
            None => return Ok((search.vector, search.active.len)),
            Some(index) => search.add(index)?,
        }
    }
    Err(Contradiction)
}

struct Search<'a> {
    vector: Vec3,
    constraints: &'a [LinearConstraint],
    active: ActiveSet,
    tolerance: f64,
}

impl Search<'_> {
    fn violation(&self, index: usize) -> f64 {
        self.constraints[index].least - self.constraints[index].normal.dot(self.vector)
    }

    /// The constraint that is violated most; of equal ones the first.
    fn most_violated(&self) -> Option<usize> {
        let mut most = (self.tolerance, None);
        for index in 0..self.constraints.len() {
            let violation = self.violation(index);
            if violation > most.0 && !self.active.contains(index) {
                most = (violation, Some(index));
            }
        }
        most.1
    }

    /// Adds a violated constraint, and drops those that would pull.
    fn add(&mut self, index: usize) -> Result<(), Contradiction> {
        let normal = self.constraints[index].normal;
        let mut factor = 0.0;
        for _ in 0..=ActiveSet::CAPACITY {
            let (along, shares) = self.active.decompose(normal, self.constraints);
            let free = along.length_squared() > DEPENDENT * DEPENDENT && self.active.len < ActiveSet::CAPACITY;
            let full = if free { self.violation(index) / along.dot(normal) } else { f64::INFINITY };
            let first = self.active.first_to_pull(&shares);
            let step = first.map_or(f64::INFINITY, |(_, step)| step).min(full);
            if step == f64::INFINITY {
                return Err(Contradiction);
            }
            if free {
                self.vector += along * step;
            }
            factor += step;
            self.active.relax(&shares, step);
            match first {
                Some((dropped, at)) if at <= full => self.active.remove(dropped),
                _ => {
                    self.active.push(index, factor);
                    return Ok(());
                }
            }
        }
        Err(Contradiction)
    }
}

/// The constraints that decide, with their factors.
#[derive(Default)]
struct ActiveSet {
    indices: [usize; 3],
    factors: [f64; 3],
    len: usize,
}

impl ActiveSet {
    const CAPACITY: usize = 3;

    fn contains(&self, index: usize) -> bool {
        self.indices[..self.len].contains(&index)
    }

    fn push(&mut self, index: usize, factor: f64) {
        (self.indices[self.len], self.factors[self.len]) = (index, factor);
        self.len += 1;
    }

    fn remove(&mut self, at: usize) {
        self.indices.copy_within(at + 1..self.len, at);
        self.factors.copy_within(at + 1..self.len, at);
        self.len -= 1;
    }

    /// Reduces the factors by their shares of a step.
    fn relax(&mut self, shares: &[f64; 3], step: f64) {
        for (factor, share) in self.factors.iter_mut().zip(shares) {
            *factor = (*factor - share * step).max(0.0);
        }
    }

    /// The active constraint whose factor is the first to become negative, and after which step.
    fn first_to_pull(&self, shares: &[f64; 3]) -> Option<(usize, f64)> {
        let at = |k: usize| (k, self.factors[k] / shares[k]);
        (0..self.len).filter(|&k| shares[k] > 0.0).map(at).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Splits a normal into what is orthogonal to the active normals and shares of these (Gram-Schmidt, each twice).
    fn decompose(&self, normal: Vec3, constraints: &[LinearConstraint]) -> (Vec3, [f64; 3]) {
        let mut basis = [Vec3::ZERO; 3];
        let mut upper = [[0.0; 3]; 3];
        for k in 0..self.len {
            let mut rest = constraints[self.indices[k]].normal;
            for _ in 0..2 {
                for j in 0..k {
                    let part = basis[j].dot(rest);
                    upper[j][k] += part;
                    rest -= basis[j] * part;
                }
            }
            upper[k][k] = rest.length();
            basis[k] = rest / upper[k][k];
        }
        let (mut rest, mut parts) = (normal, [0.0; 3]);
        for _ in 0..2 {
            for k in 0..self.len {
                let part = basis[k].dot(rest);
                parts[k] += part;
                rest -= basis[k] * part;
            }
        }
        let mut shares = [0.0; 3];
        for k in (0..self.len).rev() {
            let known: f64 = (k + 1..self.len).map(|j| upper[k][j] * shares[j]).sum();
            shares[k] = (parts[k] - known) / upper[k][k];
        }
        (rest, shares)
    }
}
