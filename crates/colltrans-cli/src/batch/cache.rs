//! Bodies that occur again are built once.
//!
//! Invariant: the bytes of all entries, as weighed when they were last used, sum to no more than the
//! capacity when one is added, or there are only as many as one query needs. Entries leave in the order of their last use. Building happens outside the lock; whoever
//! wants a body that another thread is building waits for that body only.

use std::collections::{BTreeMap, HashMap};
use std::mem::size_of;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use crate::body::Part;
use crate::solid;

/// What a body is made from.
#[derive(Debug, PartialEq, Eq, Hash)]
pub(crate) enum Key {
    /// A mesh file, whether its hull is taken, and the bits of its scale.
    Mesh { path: PathBuf, hull: bool, scale: u64 },
    /// A mesh file that need not be convex, and the bits of its scale.
    Solid { path: PathBuf, scale: u64, open: bool },
    /// Points, by the exact bits of their coordinates.
    Points(Vec<[u64; 3]>),
}

/// What is built.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "each is behind a pointer of its own")]
pub(crate) enum Shape {
    Convex(Part),
    Solid(solid::Body),
}

impl Shape {
    fn memory_bytes(&self) -> usize {
        match self {
            Self::Convex(part) => part.body.memory_bytes(),
            Self::Solid(body) => body.memory_bytes(),
        }
    }

    /// Returns the notes on how the body was made of its file.
    pub(crate) fn notes(&self) -> &[String] {
        match self {
            Self::Convex(part) => &part.notes,
            Self::Solid(body) => &body.notes,
        }
    }
}

/// A body, or why there is none.
pub(crate) type Built = Result<Arc<Shape>, String>;

/// Bytes that an entry takes beyond its body and its points.
const OVERHEAD: usize = 512;

/// Bodies of one query, which are kept whatever they weigh.
const KEPT: usize = 2;

/// Keeps the bodies that were used last.
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
    body: Arc<OnceLock<Built>>,
    last_use: u64,
    weight: usize,
}

impl Cache {
    /// A cache of bodies of `capacity` bytes together.
    pub(crate) fn new(capacity: usize) -> Self {
        Self { capacity, state: Mutex::default() }
    }

    /// The body of `key`, from `build` if it is not here.
    pub(crate) fn get(&self, key: Key, build: impl FnOnce(&Key) -> Built) -> Built {
        let key = Arc::new(key);
        let cell = self.lock().enter(&key);
        let mut is_new = false;
        let body = cell.get_or_init(|| {
            is_new = true;
            build(&key)
        });
        if is_new {
            self.lock().weigh(&key, weight(&key, body), self.capacity);
        }
        body.clone()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn weight(key: &Key, body: &Built) -> usize {
    let key = match key {
        Key::Points(points) => points.len() * size_of::<[u64; 3]>(),
        Key::Mesh { path, .. } | Key::Solid { path, .. } => path.as_os_str().len(),
    };
    key + body.as_ref().map_or(0, |shape| shape.memory_bytes()) + OVERHEAD
}

impl State {
    /// The place of a body, new or known, as the one used last.
    fn enter(&mut self, key: &Arc<Key>) -> Arc<OnceLock<Built>> {
        self.clock += 1;
        if let Some(entry) = self.entries.get_mut(key) {
            if let Some(kept) = self.by_last_use.remove(&entry.last_use) {
                self.by_last_use.insert(self.clock, kept);
            }
            entry.last_use = self.clock;
            if let Some(body) = entry.body.get() {
                // It may have made its sections, or been shrunk, since.
                let weight = weight(key, body);
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

    /// Notes what a body weighs now that it is built, and drops others that are too much.
    fn weigh(&mut self, key: &Arc<Key>, weight: usize, capacity: usize) {
        // It may have left while it was built.
        if let Some(entry) = self.entries.get_mut(key) {
            self.total = self.total - entry.weight + weight;
            entry.weight = weight;
        }
        while self.total > capacity && self.entries.len() > KEPT {
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
        Key::Points(vec![[x.to_bits(), 0, 0]])
    }

    /// How often bodies of one vertex were built after each of these uses.
    fn builds(capacity: usize, uses: &[f64]) -> Vec<u32> {
        let body = ConvexPolyhedron::from_points(&[DVec3::ONE]).unwrap();
        let one: Built = Ok(Arc::new(Shape::Convex(Part::of(body))));
        let cache = Cache::new(capacity);
        let mut builds = 0;
        let count = |&x: &f64| {
            let _ = cache.get(key(x), |_| {
                builds += 1;
                one.clone()
            });
            builds
        };
        let counts = uses.iter().map(count).collect();
        let state = cache.lock();
        assert_eq!(state.by_last_use.len(), state.entries.len());
        assert_eq!(state.total, state.entries.len() * weight(&key(0.0), &one));
        counts
    }

    /// Sections, for one, are made by a query and not when a body is built.
    #[test]
    fn a_body_that_has_grown_weighs_more_when_it_is_used_next() {
        let body = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).unwrap();
        let shape = Arc::new(Shape::Convex(Part::of(body)));
        let cache = Cache::new(1 << 20);
        let total = || {
            let _ = cache.get(key(1.0), |_| Ok(Arc::clone(&shape)));
            cache.lock().total
        };
        let built = total();
        let Shape::Convex(part) = &*shape else { unreachable!("it is convex") };
        part.body.prepare_sections();
        assert_eq!(total(), weight(&key(1.0), &Ok(Arc::clone(&shape))));
        assert!(total() > built);
    }

    #[test]
    fn bodies_are_built_once_while_they_fit() {
        let body = ConvexPolyhedron::from_points(&[DVec3::ONE]).unwrap();
        let bytes = body.memory_bytes() + size_of::<[u64; 3]>() + OVERHEAD;
        let uses = [1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 4.0, 2.0, 1.0];
        // The fourth takes the place of the first, which takes that of the third.
        assert_eq!(builds(3 * bytes, &uses), [1, 2, 3, 3, 3, 3, 4, 4, 5]);
        assert_eq!(builds(4 * bytes, &uses), [1, 2, 3, 3, 3, 3, 4, 4, 4]);
        assert_eq!(builds(3 * bytes - 1, &uses[..4]), [1, 2, 3, 4]);
    }

    #[test]
    fn bodies_that_never_come_again_take_no_more_than_the_capacity() {
        let (capacity, mut most) = (64 << 10, 0);
        let cache = Cache::new(capacity);
        for k in 0..2_000 {
            let point = DVec3::splat(f64::from(k));
            let built = cache.get(key(point.x), |_| {
                let body = ConvexPolyhedron::from_points(&[point]).unwrap();
                Ok(Arc::new(Shape::Convex(Part::of(body))))
            });
            drop(built.unwrap());
            let state = cache.lock();
            let kept: usize =
                state.entries.iter().map(|(key, e)| weight(key, e.body.get().unwrap())).sum();
            assert_eq!(kept, state.total);
            most = most.max(kept);
        }
        assert!(most <= capacity && most > capacity / 2, "{most} of {capacity} bytes");
    }

    #[test]
    fn the_two_bodies_of_a_query_are_kept_however_large() {
        assert_eq!(builds(0, &[1.0, 2.0, 1.0, 2.0, 1.0]), [1, 2, 2, 2, 2]);
        assert_eq!(builds(0, &[1.0, 2.0, 3.0, 2.0, 1.0]), [1, 2, 3, 3, 4]);
    }
}
