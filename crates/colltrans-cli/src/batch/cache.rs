//! Bodies that occur again are built once.
//!
//! Invariant: the weights of all entries but the last used one sum to no more than the capacity.
//! Entries leave in the order of their last use. Building happens outside the lock; whoever
//! wants a body that another thread is building waits for that body only.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use colltrans::ConvexPolyhedron;

/// What a body is made from.
#[derive(Debug, PartialEq, Eq, Hash)]
pub(crate) enum Key {
    /// A mesh file.
    Mesh(PathBuf),
    /// Points, by the exact bits of their coordinates.
    Points(Vec<[u64; 3]>),
}

/// A body, or why there is none.
pub(crate) type Built = Result<Arc<ConvexPolyhedron>, String>;

/// What an entry weighs beyond its vertices, as a number of vertices.
const OVERHEAD: usize = 16;

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
    /// A cache of bodies with `capacity` vertices together.
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
    let points = if let Key::Points(points) = key { points.len() } else { 0 };
    let vertices = body.as_ref().map_or(0, |b| b.vertices().len());
    points.max(vertices) + OVERHEAD
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
        while self.total > capacity && self.entries.len() > 1 {
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
    use colltrans::glam::DVec3;

    fn key(x: f64) -> Key {
        Key::Points(vec![[x.to_bits(), 0, 0]])
    }

    #[test]
    fn bodies_are_built_once_while_they_fit() {
        let one = ConvexPolyhedron::from_points(&[DVec3::ONE]).map(Arc::new);
        let one = one.map_err(|e| e.to_string());
        // Room for two entries of one vertex.
        let cache = Cache::new(2 * (OVERHEAD + 1));
        let builds = std::cell::Cell::new(0);
        let get = |x: f64| {
            let _ = cache.get(key(x), |_| {
                builds.set(builds.get() + 1);
                one.clone()
            });
            builds.get()
        };
        assert_eq!([get(1.0), get(2.0), get(1.0), get(2.0)], [1, 2, 2, 2]);
        assert_eq!([get(1.0), get(3.0)], [2, 3], "the third takes the place of the second");
        assert_eq!([get(1.0), get(2.0)], [3, 4]);
        let state = cache.lock();
        assert_eq!(state.entries.len(), 2);
        assert_eq!(state.by_last_use.len(), 2);
        assert_eq!(state.total, 2 * (OVERHEAD + 1));
    }
}
