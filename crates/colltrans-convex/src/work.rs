//! How much is looked at, for tests of how it grows: nothing in ordinary builds.
//!
//! Loops whose length depends on the input call [`count`]. No clock, so no machine disturbs a test.

/// So many points, faces or pairs more have been looked at.
#[inline(always)]
#[expect(clippy::inline_always, reason = "it is nothing")]
pub(crate) fn count(looks: usize) {
    #[cfg(test)]
    tests::LOOKS.set(tests::LOOKS.get() + looks);
    #[cfg(not(test))]
    let _ = looks;
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::{Mesh, even_rings, extruded, random_hull, ring, ring_points};
    use colltrans_testkit::solids::{comb, comb_outline, slab, washer};
    use glam::{DQuat, DVec3};

    use crate::{Cast, ConvexPolyhedron, Pose, Solid};

    thread_local! {
        pub(super) static LOOKS: Cell<usize> = const { Cell::new(0) };
    }

    /// So many times as much may be looked at for five times the input: `n log n` is 6 to 7, the ears of
    /// jagged polygons 11, quadratic 25.
    const MOST: f64 = 15.0;

    fn looks(run: impl FnOnce()) -> usize {
        let before = LOOKS.get();
        run();
        LOOKS.get() - before
    }

    /// Holds the growth of what is looked at, from `few` to five times as many.
    fn assert_growth(what: &str, few: usize, run: impl Fn(usize)) {
        let [less, more] = [few, 5 * few].map(|count| looks(|| run(count)));
        assert!(less >= few, "{what}: {less} looks at {few} are not all that there is");
        let growth = more as f64 / less as f64;
        println!("{what}: {less} looks at {few}, {growth:.1} times as many at five times as many");
        assert!(growth < MOST, "{what}: {growth:.1} times as many looks");
    }

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
    fn hulls_of_spheres() {
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
    fn hulls_of_flat_circles() {
        assert_growth("circle", 4_000, |count| {
            let points: Vec<DVec3> = ring(count, 1.0, 0.0).map(|p| rotation() * p).collect();
            let body = hull(&points);
            assert_eq!((body.dimension(), body.vertices().len()), (2, count));
        });
    }

    /// Prisms over stars, whose two large faces have all others as neighbours; regular, and with points of any
    /// depth. The surface is measured against its hull, and refused or taken by the tolerance.
    #[test]
    fn convexity_of_stars() {
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

    /// Two rings, as of a prism, a frustum or a bottle: quadratic where one ring is finished before the
    /// other is begun.
    #[test]
    fn hulls_of_large_rings() {
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

    /// Four rings, two and two close together: where the sagitta of a patch is about the chamfer, one ring of
    /// a pair is finished before the other, and each point of that sees a fan over the patch.
    #[test]
    fn hulls_of_rims_with_chamfers() {
        for chamfer in [1e-2, 1e-3, 1e-4] {
            for (how, turn) in [("upright", DQuat::IDENTITY), ("turned", rotation())] {
                let points = |count: usize| -> Vec<DVec3> {
                    let rings = [(1.0 - chamfer, 0.0), (1.0, chamfer)];
                    let both = rings.into_iter().chain(rings.map(|(r, z)| (r, 1.0 - z)));
                    both.flat_map(|(r, z)| ring(count / 4, r, z)).map(|p| turn * p).collect()
                };
                let most = 400 * 20_000;
                let count = looks(|| assert_eq!(hull(&points(20_000)).vertices().len(), 20_000));
                println!("chamfer {chamfer}, {how}: {count} looks");
                assert!(count < most, "chamfer {chamfer}, {how}: {count} looks");
            }
        }
    }

    /// Neither a climb along a rim nor what is asked around an apex, for a climb, a turn or a proof, looks at each of its
    /// corners.
    #[test]
    fn casts_of_bodies_with_rims() {
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
                looks(|| {
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

    /// An answer and its proof are of one search, also about bodies that are made once more of the same facets.
    #[test]
    fn a_proof_takes_no_second_search() {
        use colltrans_testkit::solids::bumpy_ball;

        use crate::Pair;
        use crate::solid::SolidPairSearch;

        let made = |Mesh { vertices, faces }: &Mesh| Solid::from_mesh(vertices, faces).unwrap();
        let meshes = [bumpy_ball(1_000), slab(DVec3::ZERO, DVec3::ONE, [5, 5, 1])];
        let ([ball, plate], again) = (meshes.each_ref().map(made), meshes.each_ref().map(made));
        assert!(ball.has_tree_of(&again[0]) && plate.has_tree_of(&again[1]));
        for far in [0.0, 1.0, 3.0] {
            let pose = Pose::new(rotation(), DVec3::splat(far)).expect("a pose");
            let pair = Pair::new(ball.at(pose), plate.at(Pose::IDENTITY)).expect("a pair");
            let saved = Pair::new(again[0].at(pose), again[1].at(Pose::IDENTITY)).expect("a pair");
            let without = looks(|| drop(pair.distance()));
            let with = looks(|| {
                let (_, found) = pair.ask(true).expect("an answer");
                saved.prove(found).expect("a proof");
            });
            assert!(with == without && without > 0, "{with} and {without} looks, {far}");
            let length = 0.999 * pair.distance().expect("an answer").lower;
            let without = looks(|| drop(pair.within(length)));
            let with = looks(|| {
                let (_, found) = pair.decide(length, true).expect("an answer");
                saved.prove(found).expect("a proof");
            });
            assert_eq!(with, without, "{far}");
        }
    }

    /// Of what is dropped as lying on a face, how far it is from the body is measured.
    #[test]
    fn hulls_of_grids() {
        assert_growth("faces of a grid", 2_000, |count| {
            let side = (count / 6).isqrt() as i32;
            let along = |k: i32| f64::from(k) / f64::from(side);
            let square = (0..=side).flat_map(|i| (0..=side).map(move |j| (along(i), along(j))));
            let points = square.flat_map(|(x, y)| {
                [0.0, 1.0].into_iter().flat_map(move |z| {
                    [DVec3::new(x, y, z), DVec3::new(y, z, x), DVec3::new(z, x, y)]
                })
            });
            let points: Vec<DVec3> = points.map(|p| rotation() * p).collect();
            assert_eq!(hull(&points).vertices().len(), 8);
        });
    }

    #[test]
    fn bodies_that_shrink_and_grow() {
        assert_growth("offset", 2_000, |count| {
            let body = hull(&random_hull(count, &mut Random::new(9)).vertices);
            body.shrunk(0.1).expect("it fits");
            body.grown(0.1).expect("an amount");
        });
    }

    /// Boxes of thin triangles in one plane overlap by the thousand.
    #[test]
    fn thin_triangles_of_large_faces() {
        assert_growth("washer", 1_000, |sides| {
            let Mesh { vertices, faces } = washer([1.0, 2.0], [0.0, 1.0], sides);
            let ring = Solid::from_mesh(&vertices, &faces).expect("a washer");
            assert!(ring.shrink_report(1e-4).inverted.is_empty());
        });
    }

    /// Boxes of the long triangles of a comb's caps overlap those of the walls of all its teeth.
    #[test]
    fn long_triangles_beside_many_walls() {
        let by_ears = |teeth| extruded(&comb_outline(teeth), [0.0, 1.0]);
        let shrink_looks = |Mesh { vertices, faces }: Mesh| {
            let solid = Solid::from_mesh(&vertices, &faces).expect("a comb");
            looks(|| assert!(solid.shrink_report(1e-4).inverted.is_empty()))
        };
        for (what, counts) in [
            ("fans", [400, 2_000].map(|teeth| shrink_looks(comb(teeth)))),
            ("ears", [200, 1_000].map(|teeth| shrink_looks(by_ears(teeth)))),
        ] {
            let growth = counts[1] as f64 / counts[0] as f64;
            println!("comb of {what}: {counts:?} looks, {growth:.1} times as many");
            assert!(growth < 8.0, "comb of {what}: {growth:.1} times as many looks");
        }
    }

    #[test]
    fn solids_with_faces_of_many_corners() {
        for (what, radii) in [("round", [1.0, 1.0]), ("jagged", [1.0, 0.6])] {
            assert_growth(what, 2_000, |sides| {
                let outline = ring(sides, 1.0, 0.0).enumerate().map(|(k, p)| p * radii[k % 2]);
                let outline: Vec<DVec3> = outline.collect();
                let Mesh { vertices, faces } = extruded(&outline, [0.0, 1.0]);
                let prism = Solid::from_mesh(&vertices, &faces).expect("a prism");
                assert_eq!(prism.triangles().len(), 4 * sides - 4);
            });
        }
    }

    /// What rounding leaves in doubt of flat bodies that are turned, or of positions that are no round
    /// numbers, is told by twice the usual precision: no determinant of whole numbers.
    #[test]
    fn flat_bodies_need_no_whole_numbers() {
        let Mesh { vertices, faces } = slab(DVec3::new(-1.0, -1.0, 0.0), DVec3::ONE, [4, 4, 1]);
        let plate = Solid::from_mesh(&vertices, &faces).expect("a slab");
        for turn in [DQuat::IDENTITY, rotation()] {
            for (height, way) in [(1.0, DVec3::NEG_Z), (1.001, DVec3::NEG_Z), (2.0, DVec3::NEG_Z)] {
                let at = turn * DVec3::new(0.3, -0.17, height);
                let above = plate.at(Pose::new(turn, at).expect("a pose"));
                let below = plate.at(Pose::new(turn, DVec3::ZERO).expect("a pose"));
                let cast = Cast::new(above, below, turn * way).expect("a direction");
                let ask = || assert!(!cast.clearance().expect("an answer").is_free());
                // The first query makes the hull.
                ask();
                assert_eq!(looks(ask), 0, "{turn} from {height}");
            }
        }
    }
}
