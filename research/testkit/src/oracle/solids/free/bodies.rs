//! Draws bodies for free directions: bodies of cubes, most of them with ties, and convex bodies of up to 100
//! facets.

use colltrans::{ConvexPolyhedron, Pose, Solid};
use glam::DVec3;

use crate::oracle::solids::settings::Setting;
use crate::random::Random;

/// The families: bodies of cubes, and convex bodies.
pub const FAMILIES: [&str; 9] =
    ["grid", "sheared", "quarter", "rotated", "mould", "halves", "boxes", "tetrahedra", "hulls"];

/// Two solids and their poses.
pub(super) struct Bodies {
    pub(super) solids: [Solid; 2],
    pub(super) poses: [Pose; 2],
}

/// Draws two solids; `None` for an unknown family.
pub(super) fn draw(family: &str, seed: u64) -> Result<Option<Bodies>, String> {
    let mut rng = Random::new(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ 0x29);
    let rng = &mut rng;
    // Half of the convex bodies have corners and positions in a grid.
    let tied = rng.one_in(2);
    let points = match family {
        "boxes" => [0, 1].map(|_| cuboid(tied, rng)),
        "tetrahedra" => [0, 1].map(|_| draw_cloud(4, tied, rng)),
        "hulls" => [0, 1].map(|_| draw_cloud(rng.int(5, 52) as usize, tied, rng)),
        _ => return of_cubes(family, seed),
    };
    let solids = [solid(&points[0])?, solid(&points[1])?];
    let apart = rng.direction() * rng.range(1.0, 4.0);
    let place = if tied { rng.grid(-3, 3) } else { apart };
    let poses = [place, DVec3::ZERO].map(Pose::from_translation);
    let [Ok(p), Ok(q)] = poses else { return Err("a place".to_owned()) };
    Ok(Some(Bodies { solids, poses: [p, q] }))
}

/// Returns the hull of points, or a cube if they are coplanar.
fn solid(points: &[DVec3]) -> Result<Solid, String> {
    let hull = ConvexPolyhedron::from_points(points);
    if let Ok(Ok(solid)) = hull.map(|hull| Solid::from_convex(&hull)) {
        return Ok(solid);
    }
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).map_err(|e| e.to_string())?;
    Solid::from_convex(&cube).map_err(|e| e.to_string())
}

fn of_cubes(family: &str, seed: u64) -> Result<Option<Bodies>, String> {
    let Some(setting) = Setting::draw(family, seed) else { return Ok(None) };
    let solid = |k: usize| {
        let (vertices, facets) = &setting.surfaces[k];
        Solid::from_mesh(vertices, facets).map_err(|e| format!("body {k}: {e}"))
    };
    Ok(Some(Bodies { solids: [solid(0)?, solid(1)?], poses: setting.poses }))
}

fn cuboid(tied: bool, rng: &mut Random) -> Vec<DVec3> {
    let size =
        DVec3::from([0; 3].map(|_| if tied { rng.whole(1, 3) } else { rng.range(0.1, 3.0) }));
    let turn = if tied || rng.one_in(2) { glam::DQuat::IDENTITY } else { rng.rotation() };
    let corner = |k: u32| DVec3::from([0, 1, 2].map(|axis| f64::from(k >> axis & 1)));
    (0..8).map(|k| turn * (size * corner(k))).collect()
}

fn draw_cloud(count: usize, tied: bool, rng: &mut Random) -> Vec<DVec3> {
    // On a sphere, so that many points are vertices, or in a grid.
    let point = |_| if tied { rng.grid(-2, 2) } else { rng.direction() };
    (0..count).map(point).collect()
}
