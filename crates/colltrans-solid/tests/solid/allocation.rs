//! A query between solids allocates its queue on the heap, and nothing else.

use colltrans_convex::Cast;
use colltrans_solid::{AsSolid, Solid, SolidCast, Workspace};
use colltrans_testkit::oracle::settings::setting;
use colltrans_testkit::oracle::solids::settings as solids;

/// A solid that a convex body is asked as counts as well.
#[test]
fn a_body_weighs_what_it_has_made() {
    let bodies = setting("random", 3).bodies().expect("a body");
    let before = bodies.moving.memory_bytes();
    let solid = bodies.moving.as_solid().expect("a solid").memory_bytes();
    assert!(bodies.moving.memory_bytes() >= before + solid);
}

/// A query between solids allocates nothing once its queue has grown, shells inside each other
/// included; without a queue that is kept it allocates that queue and nothing else.
#[test]
fn queries_between_solids_allocate_their_queue_only() {
    for family in solids::FAMILIES {
        for seed in 0..100 {
            let setting = solids::Setting::draw(family, seed).expect("a family");
            let [a, b] = [0, 1].map(|k| {
                let (vertices, facets) = &setting.surfaces[k];
                Solid::from_mesh(vertices, facets).expect("a closed mesh")
            });
            let cast = Cast::new(a.at(setting.poses[0]), b.at(setting.poses[1]), setting.direction)
                .expect("a direction");
            let mut workspace = Workspace::default();
            let first = (cast.clearance_in(&mut workspace), cast.exit_in(&mut workspace));
            let mut again = None;
            let count = allocation_counter::measure(|| {
                again = Some((cast.clearance_in(&mut workspace), cast.exit_in(&mut workspace)));
            });
            assert_eq!(again, Some(first), "{family}:{seed}");
            assert_eq!(count.count_total, 0, "{family}:{seed}");
            let count = allocation_counter::measure(|| {
                assert!(cast.intersects().expect("an answer").meets || !cast.overlaps());
            });
            assert_eq!(count.count_total, 0, "{family}:{seed}");
        }
    }
}
