//! The oracle: solves the linear programme that is equivalent to the problem by the simplex method.
//!
//! ```text
//! minimise    sum x_j h_j            over x >= 0, one x_j per difference m_j = q - p of vertices
//! subject to  sum x_j s_j = (0, 0)   (the shadow of the point is on the line)
//!             sum x_j     = 1
//! ```
//!
//! The method has two phases, Bland's rule, and a full tableau of integers. After each pivot all entries have
//! the pivot as their common denominator, and the division by the previous one has no remainder (Edmonds,
//! Bareiss). Nothing is rounded, and no code is shared with the library.

use dashu_int::IBig;

use crate::oracle::exact::{Dyadic, Ratio};
use crate::oracle::scene::{Scene, in_common_unit};

/// Returns the exact collision translation; `None` if the bodies never meet.
pub fn collision_translation(scene: &Scene) -> Option<Ratio> {
    let points = scene.differences();
    let (shadows, heights): (Vec<_>, Vec<_>) =
        points.iter().map(|m| (scene.shadow(m), scene.height(m))).unzip();
    let row =
        |i: usize| in_common_unit(&shadows.iter().map(|s| s[i].clone()).collect::<Vec<_>>()).0;
    let (costs, unit) = in_common_unit(&heights);
    let ones = vec![IBig::ONE; points.len()];
    let right_side = [IBig::ZERO, IBig::ZERO, IBig::ONE];
    let (value, denominator) = Tableau::new([row(0), row(1), ones], right_side, costs).solve()?;
    let denominator = &Dyadic::from_units(denominator, 0) * &scene.height_unit();
    Some(Ratio::new(Dyadic::from_units(value, unit), denominator))
}

/// Number of constraints.
const CONSTRAINTS: usize = 3;
/// Index of the objective of the first phase: the sum of the artificial variables.
const ARTIFICIAL: usize = 3;
/// Index of the objective.
const COST: usize = 4;

/// A tableau with the rows `[constraints; objectives]` and the columns `[variables; right side]`. Artificial
/// variables are numbered after the others. They have no columns, because they never enter the basis again.
struct Tableau {
    rows: [Vec<IBig>; 5],
    denominator: IBig,
    basis: [usize; CONSTRAINTS],
    variables: usize,
}

impl Tableau {
    /// Builds the initial tableau. The `right_side` must not be negative.
    fn new(mut a: [Vec<IBig>; 3], right_side: [IBig; 3], mut costs: Vec<IBig>) -> Self {
        let variables = costs.len();
        for (row, b) in a.iter_mut().zip(right_side) {
            row.push(b);
        }
        costs.push(IBig::ZERO);
        let artificial = (0..=variables).map(|j| -(&a[0][j] + &a[1][j] + &a[2][j])).collect();
        let [first, second, third] = a;
        Self {
            rows: [first, second, third, artificial, costs],
            denominator: IBig::ONE,
            basis: [variables, variables + 1, variables + 2],
            variables,
        }
    }

    /// Returns the minimum cost as a fraction; `None` if there is no solution.
    fn solve(mut self) -> Option<(IBig, IBig)> {
        self.minimise(ARTIFICIAL);
        if !self.rows[ARTIFICIAL][self.variables].is_zero() {
            return None;
        }
        self.drive_out_artificials();
        self.minimise(COST);
        Some((-self.rows[COST][self.variables].clone(), self.denominator))
    }

    /// Minimises an objective by pivoting.
    fn minimise(&mut self, objective: usize) {
        while let Some(column) = (0..self.variables).find(|&j| self.rows[objective][j] < IBig::ZERO)
        {
            let row = self.leaving_row(column).expect("weights that sum to 1 are bounded");
            self.pivot(row, column);
        }
    }

    /// Returns the row with the smallest ratio. If ratios are equal, returns the row whose basic variable has
    /// the smallest index.
    fn leaving_row(&self, column: usize) -> Option<usize> {
        let b = self.variables;
        (0..CONSTRAINTS).filter(|&i| self.rows[i][column] > IBig::ZERO).min_by(|&i, &j| {
            let left = &self.rows[i][b] * &self.rows[j][column];
            let right = &self.rows[j][b] * &self.rows[i][column];
            left.cmp(&right).then(self.basis[i].cmp(&self.basis[j]))
        })
    }

    /// Removes artificial variables, which are zero, from the basis. One remains if its constraint is
    /// redundant.
    fn drive_out_artificials(&mut self) {
        for row in 0..CONSTRAINTS {
            if self.basis[row] < self.variables {
                continue;
            }
            if let Some(column) = (0..self.variables).find(|&j| !self.rows[row][j].is_zero()) {
                if self.rows[row][column] < IBig::ZERO {
                    // Because its right side is zero, the equation may be negated.
                    for entry in &mut self.rows[row] {
                        *entry = -std::mem::take(entry);
                    }
                }
                self.pivot(row, column);
            }
        }
    }

    /// Exchanges the basic variable of a row for that of a column.
    fn pivot(&mut self, row: usize, column: usize) {
        let pivot_row = std::mem::take(&mut self.rows[row]);
        let pivot = pivot_row[column].clone();
        for other in self.rows.iter_mut().filter(|r| !r.is_empty()) {
            let factor = other[column].clone();
            for (entry, p) in other.iter_mut().zip(&pivot_row) {
                *entry = (&*entry * &pivot - &factor * p) / &self.denominator;
            }
        }
        self.rows[row] = pivot_row;
        self.denominator = pivot;
        self.basis[row] = column;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::cuboid;
    use colltrans::Pose;
    use glam::DVec3;

    fn translation_of_cubes(at: DVec3, direction: DVec3) -> Option<Ratio> {
        let pose = Pose::from_translation(at).unwrap();
        let [p, q] = [0.5, 1.0].map(|half| cuboid(DVec3::splat(half)).vertices);
        collision_translation(&Scene::new((&p, &Pose::IDENTITY), (&q, &pose), direction))
    }

    #[test]
    fn boxes_meet_at_the_expected_translation() {
        let along =
            |x: f64, d| translation_of_cubes(DVec3::new(x, 0.25, 0.5), d).map(|t| t.to_f64());
        assert_eq!(along(5.0, DVec3::X), Some(3.5));
        assert_eq!(along(5.0, DVec3::NEG_X), Some(-6.5));
        assert_eq!(along(5.0, DVec3::new(0.25, 0.0, 0.0)), Some(14.0));
        assert_eq!(along(5.0, DVec3::Y), None);
    }

    #[test]
    fn touching_at_the_rim_is_contact_but_one_ulp_beyond_is_not() {
        let at = |y: f64| translation_of_cubes(DVec3::new(5.0, y, 0.0), DVec3::X);
        assert_eq!(at(1.5).unwrap().to_f64(), 3.5);
        assert!(at(1.5_f64.next_up()).is_none());
    }

    #[test]
    fn one_third_is_exact() {
        let (p, q) = ([DVec3::ZERO], [DVec3::new(1.0, 0.0, 1.0), DVec3::new(-2.0, 0.0, 0.0)]);
        let scene = Scene::new((&p, &Pose::IDENTITY), (&q, &Pose::IDENTITY), DVec3::Z);
        let two_thirds = Ratio::new(Dyadic::new(2.0), Dyadic::new(3.0));
        assert_eq!(collision_translation(&scene), Some(two_thirds));
    }

    #[test]
    fn degenerate_shadows() {
        let (p, q) = ([DVec3::ZERO], [DVec3::Z * 3.0, DVec3::Z * 2.0]);
        let scene = |d| Scene::new((&p, &Pose::IDENTITY), (&q, &Pose::IDENTITY), d);
        assert_eq!(collision_translation(&scene(DVec3::Z)).unwrap().to_f64(), 2.0);
        assert_eq!(collision_translation(&scene(DVec3::X)), None);
    }
}
