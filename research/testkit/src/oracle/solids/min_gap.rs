//! Judges casts of solids with a minimum gap, at the reported positions and over all pairs of facets.
//!
//! The distance of the surfaces is computed in rational arithmetic at both bounds, at the start and on the way.
//! To check that nothing is nearer before, each pair of facets is cast as two flat convex bodies, and the casts
//! are judged by [`min_gap`](crate::oracle::min_gap).

use colltrans::solid::{SolidCast, SolidCertificate, SolidNear};
use colltrans::{Cast, Clearance, ConvexPolyhedron, Outcome, Pair, Solid};
use glam::DVec3;

use super::facets::{Triangle, triangles};
use super::nearest::{Setting, surfaces};
use crate::oracle::exact::{Dyadic, Ratio, Vector};
use crate::oracle::scene::size;
use crate::random::Random;

/// Number of noises by which facets may pass each other below the gap, including the errors of this module.
const GRAZE: f64 = 9.0;
/// Minimum number of noises below the gap by which two facets count as clearly nearer.
const CLEARLY: f64 = 64.0;
/// Maximum number of pairs of facets that are cast one by one.
const MOST_PAIRS: usize = 1_500;
/// Number of positions on the way that are checked.
const SAMPLES: u32 = 3;

/// The outcome, for statistics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum GapOutcome {
    /// The bodies are nearer than the gap at the start.
    Nearer,
    /// The bodies never come as near as the gap.
    Free,
    /// The bodies come as near as the gap.
    Blocked,
}

/// Casts the solids of a setting with a gap, and judges the answers. With `rounded`, parts of the gap are radii of
/// the solids. `None` for bodies that are not solids.
///
/// # Errors
/// A description of the first disagreement.
pub fn examine(family: &str, seed: u64, rounded: bool) -> Result<Option<GapOutcome>, String> {
    let Some(setting) = Setting::draw(family, seed)? else { return Ok(None) };
    let random = &mut Random::stream(seed, &[family.len() as u64, 0x6a9]);
    let size =
        setting.solids.iter().map(|s| s.bounds().side_lengths().length()).fold(0.0, f64::max);
    let gap = match random.index(6) {
        0 => size * 1e-9,
        1 => size * random.range(1.0, 10.0),
        2 => random.pick(&[0.25, 0.5, 1.0, 2.0]),
        3 => size * 10.0_f64.powf(random.range(-6.0, 0.0)),
        4 => setting.pair()?.distance().map_err(|e| e.to_string())?.upper,
        _ => size * random.range(0.0, 0.3),
    };
    // A few noises do not count as a gap.
    let gap = if gap < 1e-12 * (size + setting.reach()) { 1e-3 * size } else { gap };
    let toward = setting.poses[1].translation() - setting.poses[0].translation();
    let way = match random.index(3) {
        0 => random.pick(&DVec3::AXES),
        1 => random.direction(),
        _ => toward.normalize_or(DVec3::X) + random.direction() * 0.3,
    };
    // Of rounded bodies, the radii are parts of the gap of their cores.
    let unit = [random.unit(), random.unit()];
    let shares = if rounded { [unit[0], random.pick(&[0.0, unit[1]])] } else { [0.0; 2] };
    let radii = [gap * shares[0], gap * (1.0 - shares[0]) * shares[1]];
    let gap = if rounded { random.pick(&[0.0, gap - radii[0] - radii[1]]).max(0.0) } else { gap };
    let [a, b] = &round(setting.solids, radii)?;
    let cast = Cast::new(a.at(setting.poses[0]), b.at(setting.poses[1]), way * 2.0)
        .and_then(|cast| cast.with_tolerance(0.0))
        .and_then(|cast| cast.with_min_gap(gap))
        .map_err(|e| e.to_string())?;
    judge(&cast).map(Some).map_err(|e| format!("gap {gap:e}, radii {radii:?}: {e}"))
}

/// Rounds two solids.
fn round([a, b]: [Solid; 2], [r, s]: [f64; 2]) -> Result<[Solid; 2], String> {
    let rounded = |solid: Solid, radius| solid.rounded(radius).map_err(|e| e.to_string());
    Ok([rounded(a, r)?, rounded(b, s)?])
}

/// Judges the answers of a cast with a minimum gap.
///
/// # Errors
/// A description of the first disagreement.
pub fn judge(cast: &Cast<Solid>) -> Result<GapOutcome, String> {
    Judge::new(cast).examine()
}

struct Judge<'a> {
    cast: Cast<'a, Solid>,
    /// The gap of the cores: that of the bodies plus their radii.
    gap: f64,
    noise: f64,
    placed: [Vec<Triangle>; 2],
}

impl<'a> Judge<'a> {
    fn new(cast: &Cast<'a, Solid>) -> Self {
        let bodies = [(cast.moving(), cast.moving_pose()), (cast.fixed(), cast.fixed_pose())];
        let placed = bodies.map(|(solid, pose)| {
            triangles(solid.vertices(), solid.triangles(), (pose.matrix(), pose.translation()))
        });
        let gap = cast.options().min_gap + cast.moving().radius() + cast.fixed().radius();
        let poses = [&cast.moving_pose(), &cast.fixed_pose()];
        let size = size([cast.moving().vertices(), cast.fixed().vertices()], poses) + gap;
        Self { cast: *cast, gap, noise: 16.0 * f64::EPSILON * size, placed }
    }

    /// Returns the squared distance of the surfaces after a translation.
    fn at(&self, t: f64) -> Ratio {
        let by = Vector::new(self.cast.direction()).times(&Dyadic::new(t));
        let moved = |t: &Triangle| t.each_ref().map(|corner| corner.plus(&by));
        surfaces(&[self.placed[0].iter().map(moved).collect(), self.placed[1].clone()])
    }

    /// Checks that nothing is nearer than the gap after a translation, except for grazing facets.
    fn kept(&self, t: f64) -> Result<(), String> {
        let least = (self.gap - GRAZE * self.noise).max(0.0);
        let found = self.at(t);
        let is_kept = found >= exact_square(least);
        is_kept.then_some(()).ok_or_else(|| format!("{:e} apart after {t:e}", found.sqrt_to_f64()))
    }

    fn examine(&self) -> Result<GapOutcome, String> {
        let cast = &self.cast;
        let plain = cast.clearance().map_err(|e| e.to_string())?;
        let (clearance, proof) = cast.certified_clearance().map_err(|e| e.to_string())?;
        if plain.distance() != clearance.distance() {
            return Err(format!("{plain:?}, and certified {clearance:?}"));
        }
        cast.verify(&proof).map_err(|e| format!("{clearance:?}: {e}"))?;
        let seen = match &clearance {
            Clearance::Overlapping(_) => {
                // The surfaces of nested cores may be far apart.
                let pair = Pair::new(
                    cast.moving().at(cast.moving_pose()),
                    cast.fixed().at(cast.fixed_pose()),
                );
                let found = pair.and_then(|pair| pair.distance()).map_err(|e| e.to_string())?;
                let nested = matches!(found.near, SolidNear::Meeting(_));
                let nearer = self.at(0.0) < exact_square(self.gap) || nested;
                return nearer.then_some(GapOutcome::Nearer).ok_or_else(|| "not nearer".into());
            }
            Clearance::Free(free) => {
                if let Some(plane) = &free.separation {
                    cast.verify(plane).map_err(|e| e.to_string())?;
                }
                self.on_the_way(
                    4.0 * (self.noise / (16.0 * f64::EPSILON)) / cast.direction().length(),
                )?;
                GapOutcome::Free
            }
            Clearance::Blocked { distance, contact } => {
                self.on_the_way(*distance)?;
                let upper = contact.translation.upper;
                if self.at(upper) > exact_square(self.gap) && upper > 0.0 {
                    return Err(format!("not as near after {upper:e}: {contact:?}"));
                }
                let apart = (contact.point_on_fixed
                    - contact.point_on_moving
                    - cast.direction() * contact.translation.value)
                    .length();
                let off = 1e4 * self.noise + 1e-6 * self.gap;
                if upper > 0.0 && (apart - cast.options().min_gap).abs() > off {
                    return Err(format!("points {apart:e} apart: {contact:?}"));
                }
                self.changed(&proof)?;
                GapOutcome::Blocked
            }
        };
        self.pairs(clearance.distance().unwrap_or(0.0))?;
        Ok(seen)
    }

    /// Checks the start, the end and positions in between.
    fn on_the_way(&self, end: f64) -> Result<(), String> {
        (0..=SAMPLES + 1).try_for_each(|k| self.kept(end * f64::from(k) / f64::from(SAMPLES + 1)))
    }

    /// Checks that a proof is rejected for a larger bound and for a larger gap.
    fn changed(&self, proof: &SolidCertificate) -> Result<(), String> {
        let much = 1e8 * self.noise;
        let lower = proof.lower + 2.0 * much / self.cast.direction().length();
        let more = SolidCertificate { lower, ..proof.clone() };
        let min_gap = self.cast.options().min_gap + much;
        let other = self.cast.with_min_gap(min_gap).map_err(|e| e.to_string())?;
        if self.cast.verify(&more).is_ok() {
            return Err("a larger bound is accepted".into());
        }
        if proof.lower > 0.0 && other.verify(proof).is_ok() {
            return Err("a larger gap is accepted".into());
        }
        Ok(())
    }

    /// Checks that no pair of facets comes nearer before the bound, and that the bound is not much earlier than
    /// the first pair.
    fn pairs(&self, distance: f64) -> Result<(), String> {
        let [p, q] = &self.placed;
        if p.len() * q.len() > MOST_PAIRS {
            return Ok(());
        }
        let bodies = |cast: &Cast<Solid>, moving: bool| -> Vec<Option<ConvexPolyhedron>> {
            let solid = if moving { cast.moving() } else { cast.fixed() };
            let facet = |t: &[u32; 3]| {
                let corners = t.map(|v| solid.vertices()[v as usize]);
                ConvexPolyhedron::from_points(&corners).ok()
            };
            solid.triangles().iter().map(facet).collect()
        };
        let cast = &self.cast;
        let (moving, fixed) = (bodies(cast, true), bodies(cast, false));
        let mut first = f64::INFINITY;
        for f in moving.iter().flatten() {
            for g in fixed.iter().flatten() {
                first = first.min(self.pair(f, g)?);
            }
        }
        // A relative tolerance, because the last digits of a graze correspond to a long distance.
        let slack = 1e-5 * (first + self.gap / cast.direction().length());
        if distance > first + slack || distance.is_infinite() && first.is_finite() {
            return Err(format!("{distance:e}, and facets are as near after {first:e}"));
        }
        Ok(())
    }

    /// Returns the translation at which two facets are first clearly nearer than the gap; infinity if there is
    /// none.
    fn pair(&self, f: &ConvexPolyhedron, g: &ConvexPolyhedron) -> Result<f64, String> {
        let cast = Cast::new(
            f.at(self.cast.moving_pose()),
            g.at(self.cast.fixed_pose()),
            self.cast.direction(),
        );
        let gap = (self.gap - CLEARLY * self.noise).max(0.0);
        let cast = cast.and_then(|cast| cast.with_min_gap(gap)).map_err(|e| e.to_string())?;
        let outcome = cast.first_contact().map_err(|e| e.to_string())?;
        let Outcome::Contact(contact) = outcome else { return Ok(f64::INFINITY) };
        let last = cast.reversed().first_contact().map_err(|e| e.to_string())?;
        let Outcome::Contact(last) = last else { return Ok(f64::INFINITY) };
        let ahead = last.exit().upper > CLEARLY * self.noise / self.cast.direction().length();
        Ok(if ahead { contact.certificate.upper.max(0.0) } else { f64::INFINITY })
    }
}

fn exact_square(x: f64) -> Ratio {
    Ratio::from_f64(x).times(&Ratio::from_f64(x))
}
