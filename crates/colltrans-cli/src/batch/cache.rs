//! A cache of bodies that several queries use. It evicts the least recently used ones.
//!
//! Invariant: after a body is built, the bytes of all entries, as computed at their last use, do not exceed the
//! capacity, or there are at most two entries, because one query needs two bodies. Bodies are built outside the lock. A
//! thread that needs a body which another thread is building waits only for this body.

use std::collections::{BTreeMap, HashMap};
use std::mem::size_of;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use crate::body::Part;
use crate::solid;

/// The source of a body.
#[derive(Debug, PartialEq, Eq, Hash)]
pub(crate) enum Key {
    /// A mesh file that becomes a convex body, whether its hull is taken, and the bits of its scale and radius.
    Mesh { path: PathBuf, hull: bool, scale: u64, radius: u64 },
    /// A mesh file that need not be convex, the bits of its scale and radius, and whether it may be open.
    Solid { path: PathBuf, scale: u64, open: bool, radius: u64 },
    /// Points, by the exact bits of their coordinates, and the bits of the radius.
    Points { points: Vec<[u64; 3]>, radius: u64 },
}

/// A body of either kind.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "each is behind a pointer of its own")]
pub(crate) enum Shape {
    Convex(Part),
    Solid(solid::Body),
}

impl Shape {
    /// Returns the memory of the body.
    fn memory_bytes(&self) -> usize {
        match self {
            Self::Convex(part) => part.body.memory_bytes(),
            Self::Solid(body) => body.memory_bytes(),
        }
    }

    /// Returns notes about repairs of the mesh.
    pub(crate) fn notes(&self) -> &[String] {
        match self {
            Self::Convex(part) => &part.notes,
            Self::Solid(body) => &body.notes,
        }
    }
}

/// A body, or the message of an error.
pub(crate) type BuildResult = Result<Arc<Shape>, String>;

/// Memory of an entry beyond its body and its points, in bytes.
const ENTRY_BYTES: usize = 512;

/// Number of bodies of one query. These are stored even if they exceed the capacity.
const MIN_ENTRIES: usize = 2;

/// The most recently used bodies.
pub(crate) struct Cache {
    capacity: usize,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    entries: HashMap<Arc<Key>, Entry>,
    by_last_use: BTreeMap<u64, Arc<Key>>,
    clock: u64,
    total: usize,
}

struct Entry {
    body: Arc<OnceLock<BuildResult>>,
    last_use: u64,
    weight: usize,
}

impl Cache {
    /// Returns an empty cache with a capacity in bytes.
    pub(crate) fn new(capacity: usize) -> Self {
        Self { capacity, state: Mutex::default() }
    }

    /// Returns the body of `key`. Calls `build` if it is not in the cache. Errors are stored, too.
    pub(crate) fn get_or_build(
        &self,
        key: Key,
        build: impl FnOnce(&Key) -> BuildResult,
    ) -> BuildResult {
        let key = Arc::new(key);
        let cell = self.lock().use_entry(&key);
        let mut is_new = false;
        let body = cell.get_or_init(|| {
            is_new = true;
            build(&key)
        });
        if is_new {
            self.lock().set_weight(&key, entry_bytes(&key, body), self.capacity);
        }
        body.clone()
    }

    /// Locks the state, also if the lock is poisoned.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the memory of an entry in bytes.
fn entry_bytes(key: &Key, body: &BuildResult) -> usize {
    let key = match key {
        Key::Points { points, .. } => points.len() * size_of::<[u64; 3]>(),
        Key::Mesh { path, .. } | Key::Solid { path, .. } => path.as_os_str().len(),
    };
    key + body.as_ref().map_or(0, |shape| shape.memory_bytes()) + ENTRY_BYTES
}

impl State {
    /// Returns the cell of a body, new or known, and marks it as most recently used.
    fn use_entry(&mut self, key: &Arc<Key>) -> Arc<OnceLock<BuildResult>> {
        self.clock += 1;
        if let Some(entry) = self.entries.get_mut(key) {
            if let Some(key) = self.by_last_use.remove(&entry.last_use) {
                self.by_last_use.insert(self.clock, key);
            }
            entry.last_use = self.clock;
            if let Some(body) = entry.body.get() {
                // The body may have grown since, by lazily computed sections or offsets.
                let weight = entry_bytes(key, body);
                self.total = self.total - entry.weight + weight;
                entry.weight = weight;
            }
            return Arc::clone(&entry.body);
        }
        let body = Arc::new(OnceLock::new());
        let entry = Entry { body: Arc::clone(&body), last_use: self.clock, weight: 0 };
        self.entries.insert(Arc::clone(key), entry);
        self.by_last_use.insert(self.clock, Arc::clone(key));
        body
    }

    /// Sets the memory of a body that was built, and evicts entries beyond the capacity.
    fn set_weight(&mut self, key: &Arc<Key>, weight: usize, capacity: usize) {
        // The entry may have been evicted while its body was built.
        if let Some(entry) = self.entries.get_mut(key) {
            self.total = self.total - entry.weight + weight;
            entry.weight = weight;
        }
        while self.total > capacity && self.entries.len() > MIN_ENTRIES {
            let Some((_, oldest)) = self.by_last_use.pop_first() else { break };
            if let Some(entry) = self.entries.remove(&oldest) {
                self.total -= entry.weight;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans::ConvexPolyhedron;
    use colltrans::glam::DVec3;

    fn key(x: f64) -> Key {
        Key::Points { points: vec![[x.to_bits(), 0, 0]], radius: 0 }
    }

    /// Returns the number of bodies that were built after each of these uses.
    fn build_counts(capacity: usize, uses: &[f64]) -> Vec<u32> {
        let body = ConvexPolyhedron::from_points(&[DVec3::ONE]).unwrap();
        let body: BuildResult = Ok(Arc::new(Shape::Convex(Part::from_body(body))));
        let cache = Cache::new(capacity);
        let mut builds = 0;
        let count = |&x: &f64| {
            let _ = cache.get_or_build(key(x), |_| {
                builds += 1;
                body.clone()
            });
            builds
        };
        let counts = uses.iter().map(count).collect();
        let state = cache.lock();
        assert_eq!(state.by_last_use.len(), state.entries.len());
        assert_eq!(state.total, state.entries.len() * entry_bytes(&key(0.0), &body));
        counts
    }

    /// Sections are computed by a query, not when a body is built.
    #[test]
    fn memory_of_a_grown_body_is_updated_at_its_next_use() {
        let body = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).unwrap();
        let shape = Arc::new(Shape::Convex(Part::from_body(body)));
        let cache = Cache::new(1 << 20);
        let total = || {
            let _ = cache.get_or_build(key(1.0), |_| Ok(Arc::clone(&shape)));
            cache.lock().total
        };
        let built = total();
        let Shape::Convex(part) = &*shape else { unreachable!("it is convex") };
        part.body.prepare_sections();
        assert_eq!(total(), entry_bytes(&key(1.0), &Ok(Arc::clone(&shape))));
        assert!(total() > built);
    }

    #[test]
    fn cache_within_budget_builds_each_body_once() {
        let body = ConvexPolyhedron::from_points(&[DVec3::ONE]).unwrap();
        let bytes = body.memory_bytes() + size_of::<[u64; 3]>() + ENTRY_BYTES;
        let uses = [1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 4.0, 2.0, 1.0];
        // The fourth body evicts the first, which then evicts the third.
        assert_eq!(build_counts(3 * bytes, &uses), [1, 2, 3, 3, 3, 3, 4, 4, 5]);
        assert_eq!(build_counts(4 * bytes, &uses), [1, 2, 3, 3, 3, 3, 4, 4, 4]);
        assert_eq!(build_counts(3 * bytes - 1, &uses[..4]), [1, 2, 3, 4]);
    }

    #[test]
    fn distinct_bodies_do_not_exceed_the_capacity() {
        let (capacity, mut most) = (64 << 10, 0);
        let cache = Cache::new(capacity);
        for k in 0..2_000 {
            let point = DVec3::splat(f64::from(k));
            let built = cache.get_or_build(key(point.x), |_| {
                let body = ConvexPolyhedron::from_points(&[point]).unwrap();
                Ok(Arc::new(Shape::Convex(Part::from_body(body))))
            });
            drop(built.unwrap());
            let state = cache.lock();
            let bytes_in_use: usize =
                state.entries.iter().map(|(key, e)| entry_bytes(key, e.body.get().unwrap())).sum();
            assert_eq!(bytes_in_use, state.total);
            most = most.max(bytes_in_use);
        }
        assert!(most <= capacity && most > capacity / 2, "{most} of {capacity} bytes");
    }

    #[test]
    fn two_bodies_of_a_query_stay_beyond_the_capacity() {
        assert_eq!(build_counts(0, &[1.0, 2.0, 1.0, 2.0, 1.0]), [1, 2, 2, 2, 2]);
        assert_eq!(build_counts(0, &[1.0, 2.0, 3.0, 2.0, 1.0]), [1, 2, 3, 3, 4]);
    }
}
