//! A query allocates nothing on the heap, whatever its outcome and however tied it is.

use colltrans::Solver;
use colltrans_oracle::settings::{FAMILIES, setting};

#[test]
fn queries_allocate_nothing() {
    for (family, ..) in FAMILIES {
        for seed in 0..200 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("a body");
            for solver in [Solver::Portal, Solver::Cta] {
                let mut answer = None;
                let count = allocation_counter::measure(|| {
                    answer = Some(setting.cast(&bodies, solver));
                });
                assert!(answer.is_some_and(|a| a.is_ok()), "{family}:{seed} {solver:?}");
                assert_eq!(count.count_total, 0, "{family}:{seed} {solver:?}");
            }
        }
    }
}
