//! Work of hulls, casts and offsets of convex bodies, and its growth with the input.

use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{even_rings, random_hull, ring, ring_points};
use glam::{DQuat, DVec3};

use crate::{Cast, ConvexPolyhedron, Pose};
use colltrans_kernel::visit_counter::{assert_growth, visits_during};

fn hull(points: &[DVec3]) -> ConvexPolyhedron {
    ConvexPolyhedron::from_points(points).expect("points")
}

fn faces(body: &ConvexPolyhedron) -> Vec<Vec<u32>> {
    (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect()).collect()
}

fn rotation() -> DQuat {
    Random::new(5).rotation()
}

#[test]
fn hull_work_on_spheres_is_subquadratic() {
    let random = |count: usize| {
        let mut random = Random::new(7);
        (0..count).map(|_| random.direction()).collect::<Vec<_>>()
    };
    let in_rings = |count: usize| {
        let [around, rings] = even_rings(count);
        ring_points(around, rings, 0.0).into_iter().map(|v| rotation() * v).collect()
    };
    let of_points = |points: Vec<DVec3>| {
        let body = hull(&points);
        assert!(body.vertices().len() > points.len() * 9 / 10);
    };
    let of_meshes = |points: Vec<DVec3>| {
        let body = hull(&points);
        ConvexPolyhedron::from_mesh(body.vertices(), &faces(&body), 0.0).expect("its own");
    };
    assert_growth("sphere", 2_000, |count| of_points(random(count)));
    assert_growth("sphere's mesh", 2_000, |count| of_meshes(random(count)));
    assert_growth("rings", 2_000, |count| of_points(in_rings(count)));
    assert_growth("rings' mesh", 2_000, |count| of_meshes(in_rings(count)));
}

#[test]
fn hull_work_on_flat_circles_is_subquadratic() {
    assert_growth("circle", 4_000, |count| {
        let points: Vec<DVec3> = ring(count, 1.0, 0.0).map(|p| rotation() * p).collect();
        let body = hull(&points);
        assert_eq!((body.dimension(), body.vertices().len()), (2, count));
    });
}

/// Prisms over stars have two large faces that are adjacent to all others. The stars are regular or have random
/// depths. Their convexity defect is measured.
#[test]
fn convexity_defect_work_on_stars_is_subquadratic() {
    let mut random = Random::new(9);
    let depths: Vec<f64> = (0..10_000).map(|_| random.range(0.2, 0.9)).collect();
    for (what, depth) in [("regular", None), ("any depth", Some(depths))] {
        let radius = |k: usize| match &depth {
            _ if k.is_multiple_of(2) => 1.0,
            Some(depths) => depths[k],
            None => 0.8,
        };
        let star = |count: usize, high: f64| -> Vec<DVec3> {
            let rim = || ring(count, 1.0, 0.0).enumerate().map(|(k, v)| v * radius(k));
            let top = rim().map(|v| v + DVec3::Z * high);
            rim().chain(top).map(|v| rotation() * v).collect()
        };
        assert_growth(&format!("star, {what}"), 1_000, |count| {
            let n = count as u32;
            let mut faces: Vec<Vec<u32>> = vec![(0..n).rev().collect(), (n..2 * n).collect()];
            faces.extend((0..n).map(|i| [i, (i + 1) % n, (i + 1) % n + n, i + n].into()));
            let defect = crate::convexity_defect(&star(count, 1.0), &faces).expect("a prism");
            assert!(defect.depth > 0.05, "{defect:?}");
        });
        assert_growth(&format!("flat star, {what}"), 1_000, |count| {
            let n = count as u32;
            let faces: [Vec<u32>; 2] = [(0..n).rev().collect(), (0..n).collect()];
            let defect = crate::convexity_defect(&star(count, 1.0), &faces).expect("a polygon");
            assert!(defect.depth > 0.05, "{defect:?}");
        });
    }
}

/// Two rings, as in a prism, a frustum or a bottle. The work would be quadratic if one ring were completed before
/// the other one is begun.
#[test]
fn hull_work_on_large_rings_is_subquadratic() {
    let apex = DVec3::Z * 1.5;
    for (what, top, apex) in
        [("prism", 1.0, None), ("frustum", 0.7, None), ("bottle", 0.9, Some(apex))]
    {
        for (how, turn) in [("upright", DQuat::IDENTITY), ("turned", rotation())] {
            assert_growth(&format!("{what}, {how}"), 2_000, |sides| {
                let points = ring(sides, 1.0, 0.0).chain(ring(sides, top, 1.0)).chain(apex);
                let points: Vec<DVec3> = points.map(|p| turn * p).collect();
                assert_eq!(hull(&points).vertices().len(), points.len());
            });
        }
    }
}

/// Four rings, in two close pairs. Where the sagitta of a patch is about the size of the chamfer, one ring of a
/// pair is completed before the other. Then each point of the other ring sees a fan over the patch.
#[test]
fn hull_work_on_chamfered_rims_is_bounded() {
    for chamfer in [1e-2, 1e-3, 1e-4] {
        for (how, turn) in [("upright", DQuat::IDENTITY), ("turned", rotation())] {
            let points = |count: usize| -> Vec<DVec3> {
                let rings = [(1.0 - chamfer, 0.0), (1.0, chamfer)];
                let both = rings.into_iter().chain(rings.map(|(r, z)| (r, 1.0 - z)));
                both.flat_map(|(r, z)| ring(count / 4, r, z)).map(|p| turn * p).collect()
            };
            let most = 400 * 20_000;
            let count =
                visits_during(|| assert_eq!(hull(&points(20_000)).vertices().len(), 20_000));
            println!("chamfer {chamfer}, {how}: {count} looks");
            assert!(count < most, "chamfer {chamfer}, {how}: {count} looks");
        }
    }
}

/// Neither a climb along a rim nor a search around an apex, for a climb, a rotation or a proof, visits each corner.
#[test]
fn cast_work_on_rims_does_not_scale_with_corners() {
    type Turned = (&'static str, &'static [[f64; 2]], &'static [f64]);
    let rims: [Turned; 4] = [
        ("cylinder", &[[1.0, -1.0], [1.0, 1.0]], &[]),
        ("chamfers", &[[0.99, -1.0], [1.0, -0.99], [1.0, 0.99], [0.99, 1.0]], &[]),
        ("cone", &[[1.0, -0.5]], &[1.0]),
        ("bicone", &[[1.0, 0.0]], &[-1.0, 1.0]),
    ];
    for (what, rings, tips) in rims {
        let [few, many] = [2_000, 20_000].map(|count| {
            let rings = rings.iter().flat_map(|&[r, z]| ring(count / rings.len(), r, z));
            let points: Vec<_> = rings.chain(tips.iter().map(|&z| DVec3::Z * z)).collect();
            let body = hull(&points);
            let mut random = Random::new(3);
            visits_during(|| {
                for _ in 0..200 {
                    let direction = random.direction();
                    let aside = random.direction() * random.range(0.0, 0.8);
                    let [start, target] = [aside - direction * 4.0, DVec3::ZERO]
                        .map(|at| Pose::new(random.rotation(), at).expect("a pose"));
                    let cast = Cast::new(body.at(start), body.at(target), direction);
                    cast.and_then(|cast| cast.first_contact()).expect("an answer");
                }
            }) / 200
        });
        println!("{what}: {few} looks a cast at 2,000 corners, {many} at 20,000");
        assert!(many < 2 * few && many < 60, "{what}: {few} and {many} looks");
    }
}

/// Points that are dropped because they lie on a face are measured by their distance from the body.
#[test]
fn hull_work_on_grid_faces_is_subquadratic() {
    assert_growth("faces of a grid", 2_000, |count| {
        let side = (count / 6).isqrt() as i32;
        let along = |k: i32| f64::from(k) / f64::from(side);
        let square = (0..=side).flat_map(|i| (0..=side).map(move |j| (along(i), along(j))));
        let points = square.flat_map(|(x, y)| {
            [0.0, 1.0]
                .into_iter()
                .flat_map(move |z| [DVec3::new(x, y, z), DVec3::new(y, z, x), DVec3::new(z, x, y)])
        });
        let points: Vec<DVec3> = points.map(|p| rotation() * p).collect();
        assert_eq!(hull(&points).vertices().len(), 8);
    });
}

#[test]
fn offset_work_is_subquadratic() {
    assert_growth("offset", 2_000, |count| {
        let body = hull(&random_hull(count, &mut Random::new(9)).vertices);
        body.shrunk(0.1).expect("it fits");
        body.grown(0.1).expect("an amount");
    });
}
