//! Draws settings of bodies made of cubes, most of them with ties, and judges the answers.

use colltrans::solid::{SolidCast, SolidFree};
use colltrans::{Bounded, Cast, Clearance, ContactRange, Pose, Solid};
use glam::{DMat3, DQuat, DVec3};

use super::cells::{Cells, Motion, motion};
use super::proof::{MOST_PAIRS, approve};
use super::{encloses, exactly};
use crate::oracle::exact::{Ratio, Vector};
use crate::oracle::scene::size;
use crate::random::Random;

/// The families.
pub const FAMILIES: [&str; 6] = ["grid", "sheared", "quarter", "rotated", "mould", "halves"];

/// Maximum difference of agreeing distances, in noises of the setting.
pub(super) const AGREEMENT: f64 = 512.0;

/// The outcome, for statistics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MotionOutcome {
    /// The bodies overlap.
    Overlapping,
    /// The moving body is free.
    Free,
    /// The bodies touch and block.
    BlockedNow,
    /// The moving body is blocked later.
    Blocked,
}

/// Two placed bodies of cubes.
#[derive(Debug, Clone)]
pub struct Setting {
    /// The moving and the fixed body, in the grid.
    pub cells: [Cells; 2],
    /// The linear map of both grids in the body frames.
    pub shear: DMat3,
    /// The surfaces in the body frames.
    pub surfaces: [(Vec<DVec3>, Vec<Vec<u32>>); 2],
    /// The poses.
    pub poses: [Pose; 2],
    /// The direction.
    pub direction: DVec3,
    /// The rotations that the poses apply to the cubes.
    turns: [DMat3; 2],
}

impl Setting {
    /// Draws the setting of a family with a seed; `None` for an unknown family.
    ///
    /// # Panics
    /// Never, because the poses are rotations.
    pub fn draw(family: &str, seed: u64) -> Option<Self> {
        let mut rng = Random::new(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ 0x51);
        let rng = &mut rng;
        let count = |rng: &mut Random| rng.int(1, 7) as usize;
        let mut cells = [Cells::random(count(rng), rng), Cells::random(count(rng), rng)];
        let mut shear = DMat3::IDENTITY;
        let mut turns = [DMat3::IDENTITY; 2];
        let mut rotation = DQuat::IDENTITY;
        let mut translations = [rng.grid(-3, 3), rng.grid(-3, 3)];
        let mut direction = way(rng);
        match family {
            "grid" => {}
            "halves" => {
                translations = translations.map(|t| t * 0.5);
                direction *= [1.0, 0.25, 3.0][rng.int(0, 2) as usize];
            }
            "sheared" => shear = sheared(rng),
            "quarter" => turns = [draw_axis_rotation(rng), draw_axis_rotation(rng)],
            "rotated" => {
                shear = if rng.one_in(2) { sheared(rng) } else { shear };
                rotation = any_rotation(rng);
                let map = DMat3::from_quat(rotation) * shear;
                // Translations and directions in the grid, rounded, or zero.
                let zero = rng.one_in(2);
                translations = translations.map(|t| if zero { DVec3::ZERO } else { map * t });
                direction = map * direction;
                if zero {
                    cells[1] = displaced_cells(&cells[1], rng.grid(-2, 2));
                }
            }
            "mould" => {
                let axis = rng.int(0, 2) as usize;
                cells[0] = Cells::random(rng.int(1, 3) as usize, rng);
                cells[1] = cells[0].mould((!rng.one_in(4)).then_some(axis));
                shear = if rng.one_in(2) { sheared(rng) } else { shear };
                translations = [DVec3::ZERO; 2];
                if rng.one_in(2) {
                    direction = shear * DVec3::AXES[axis];
                    rotation = if rng.one_in(2) { any_rotation(rng) } else { rotation };
                    // The exact direction of the rounded matrix.
                    let matrix = Pose::new(rotation, DVec3::ZERO).expect("a rotation").matrix();
                    direction = matrix * direction;
                }
            }
            _ => return None,
        }
        let surfaces = [0, 1].map(|k| cells[k].surface(shear, rng));
        let pose = |k: usize| {
            // Quarter turns are set as matrices, because their quaternions may be rounded.
            if turns[k] == DMat3::IDENTITY {
                Pose::new(rotation, translations[k]).expect("a rotation")
            } else {
                Pose::from_matrix(turns[k], translations[k]).expect("a rotation")
            }
        };
        let poses = [pose(0), pose(1)];
        Some(Self { cells, shear, surfaces, poses, direction, turns })
    }

    /// Returns the exact result.
    pub fn expected(&self) -> Motion {
        self.expected_along(self.direction)
    }

    fn expected_along(&self, direction: DVec3) -> Motion {
        let offset = Vector::new(self.poses[1].translation())
            .minus(&Vector::new(self.poses[0].translation()));
        let identity = DMat3::IDENTITY;
        if self.turns == [identity; 2] {
            let cells = (&self.cells[0], &self.cells[1]);
            return motion(cells, [self.poses[0].matrix(), self.shear], &offset, direction);
        }
        let [a, b] = [0, 1].map(|k| self.cells[k].turned(self.turns[k]));
        motion((&a, &b), [identity; 2], &offset, direction)
    }

    /// Computes the answers, and judges them. Proofs of small bodies are judged in rational arithmetic if
    /// `in_fractions`.
    ///
    /// # Errors
    /// A description of the first disagreement.
    pub fn examine(&self, in_fractions: bool) -> Result<MotionOutcome, String> {
        let solid = |k: usize| {
            let (vertices, facets) = &self.surfaces[k];
            Solid::from_mesh(vertices, facets).map_err(|e| format!("body {k}: {e}"))
        };
        let (a, b) = (solid(0)?, solid(1)?);
        let cast = exactly([&a, &b], self.poses, self.direction)?;
        let back = self.expected_along(-self.direction).exit;
        judge_motion(&cast, &self.expected(), back.as_ref(), self.tolerance(), in_fractions)
    }

    fn tolerance(&self) -> f64 {
        let size = size(self.surfaces.each_ref().map(|s| &s.0[..]), self.poses.each_ref());
        AGREEMENT * 16.0 * f64::EPSILON * size / self.direction.length()
    }
}

/// Computes the answers of a cast, and judges them. `expected` is the exact motion, `back` the exit of the opposite one,
/// and `tolerance` the maximum difference of distances. Proofs of small bodies are judged in rational arithmetic if
/// `in_fractions`.
pub(super) fn judge_motion(
    cast: &Cast<'_, Solid>,
    expected: &Motion,
    back: Option<&Ratio>,
    tolerance: f64,
    in_fractions: bool,
) -> Result<MotionOutcome, String> {
    let near =
        |found: f64, right: &Ratio| right.minus(&Ratio::from_f64(found)).is_within(tolerance);
    let exit = cast.exit();
    match (&expected.exit, exit) {
        (None, None) => {}
        (Some(right), Some(found))
            if encloses(&found, &right.clone().max(Ratio::from_f64(0.0)))
                && (near(found.value, right)
                    || found.value == 0.0 && right.to_f64() <= tolerance) => {}
        (right, found) => {
            return Err(format!("exit {found:?}, not {:?}", right.as_ref().map(Ratio::to_f64)));
        }
    }
    let meets = |found: Bounded, right: &Ratio| encloses(&found, right) && near(found.value, right);
    match (cast.contact_range().map_err(|e| e.to_string())?, back, &expected.exit) {
        (ContactRange::Separated(_), None, None) => {}
        (ContactRange::Contact { first, last }, Some(back), Some(exit))
            if meets(first.exit(), back) && meets(last.exit(), exit) => {}
        (found, back, exit) => {
            let [back, exit] = [back, exit.as_ref()].map(|end| end.map(Ratio::to_f64));
            return Err(format!("{found:?}, not -{back:?} to {exit:?}"));
        }
    }
    let (found, certificate) = cast.certified_clearance().map_err(|e| e.to_string())?;
    cast.verify(&certificate).map_err(|e| format!("{found:?}: {e}: {certificate:?}"))?;
    let pairs = cast.moving().triangles().len() * cast.fixed().triangles().len();
    if in_fractions && pairs <= MOST_PAIRS {
        approve(cast, &certificate, tolerance)?;
    }
    if expected.overlaps && cast.overlaps() {
        let said = matches!(found, Clearance::Overlapping(_));
        return if said { Ok(MotionOutcome::Overlapping) } else { Err(format!("{found:?}")) };
    }
    if let Clearance::Free(SolidFree { separation: Some(separation), .. }) = &found {
        cast.verify(separation).map_err(|e| format!("{found:?}: {e}"))?;
    }
    match (found, expected.overlaps, &expected.stop) {
        (Clearance::Free(_), false, None) => Ok(MotionOutcome::Free),
        (Clearance::Blocked { distance, contact }, false, Some(stop))
            if near(distance, stop)
                && near(contact.translation.value, stop)
                && encloses(&contact.translation, stop) =>
        {
            Ok(if stop.is_zero() { MotionOutcome::BlockedNow } else { MotionOutcome::Blocked })
        }
        (found, overlaps, stop) => Err(format!(
            "{found:?}, but overlapping: {overlaps}, stop: {:?}",
            stop.as_ref().map(Ratio::to_f64)
        )),
    }
}

/// Draws a direction along an axis or a diagonal, or with small integer coordinates.
pub(super) fn way(rng: &mut Random) -> DVec3 {
    loop {
        let most = [1, 1, 3][rng.int(0, 2) as usize];
        let mut d = rng.grid(-most, most);
        if rng.one_in(3) {
            d = DVec3::AXES[rng.int(0, 2) as usize] * rng.whole(1, 3);
        }
        if d != DVec3::ZERO {
            return d;
        }
    }
}

pub(super) fn sheared(rng: &mut Random) -> DMat3 {
    loop {
        let m = DMat3::from_cols(rng.grid(-2, 2), rng.grid(-2, 2), rng.grid(-2, 2));
        if m.determinant() != 0.0 {
            return m;
        }
    }
}

/// Draws a rotation that permutes axes.
fn draw_axis_rotation(rng: &mut Random) -> DMat3 {
    loop {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let pick = |rng: &mut Random| {
            axes[rng.int(0, 2) as usize] * if rng.one_in(2) { 1.0 } else { -1.0 }
        };
        let (x, y) = (pick(rng), pick(rng));
        if x.dot(y) == 0.0 {
            return DMat3::from_cols(x, y, x.cross(y));
        }
    }
}

pub(super) fn any_rotation(rng: &mut Random) -> DQuat {
    loop {
        let q = [0; 4].map(|_| rng.range(-1.0, 1.0));
        let q = DQuat::from_array(q);
        if q.length() > 0.1 {
            return q.normalize();
        }
    }
}

fn displaced_cells(cells: &Cells, by: DVec3) -> Cells {
    let by = by.to_array().map(|c| c as i32);
    Cells(cells.0.iter().map(|c| [0, 1, 2].map(|k| c[k] + by[k])).collect())
}
