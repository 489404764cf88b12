//! The removal map of a part or group: its free travel (*room*) over the whole sphere of directions.
//!
//! What is free is the proven [`Cover`], with exact borders, where parts are closed and meet by rule; how far the
//! group goes elsewhere is sampled on an icosahedron. Without a cover free directions are sampled too, and the map
//! says so. Then samples are refined: triangles between a free corner and one that is
//! not, until the border is known to the angle asked for; the surroundings of directions that go
//! farthest, where a thin free region may hide; and the surroundings of candidate directions that are
//! free. A candidate that is free though none of the samples around it is, is *isolated*: a tight
//! fit. With a cover only the second is done.

mod cover;
#[cfg(feature = "report")]
mod draw;
mod regions;
#[cfg(feature = "report")]
mod trace;
mod way;

use std::collections::BTreeSet;

use colltrans::Aabb;
use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;
use rayon::prelude::*;

use crate::bodies::Bodies;
use crate::error::AssemblyError;
use crate::rooms::{PartRoom, room_of};
use crate::sphere::{Sphere, angle};
use crate::watch::{Stage, Watch};

pub use cover::Cover;
#[cfg(feature = "report")]
pub use draw::{png, svg};
pub use regions::Region;
pub(crate) use way::way_out;

/// Choices for a map.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MapOptions {
    /// At least so many samples before anything is refined.
    pub samples: usize,
    /// The border of free regions is known to this angle, in radians.
    pub border: f64,
    /// What overlaps at the start mean.
    pub start: StartOverlap,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self { samples: 2_562, border: 0.01, start: StartOverlap::Refuse }
    }
}

impl MapOptions {
    /// The same with another [`samples`](Self::samples).
    #[must_use]
    pub fn with_samples(self, samples: usize) -> Self {
        Self { samples, ..self }
    }

    /// The same with another [`border`](Self::border).
    #[must_use]
    pub fn with_border(self, border: f64) -> Self {
        Self { border, ..self }
    }

    /// The same with another [`start`](Self::start).
    #[must_use]
    pub fn with_start(self, start: StartOverlap) -> Self {
        Self { start, ..self }
    }
}

/// The rooms of a group over the sphere.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RemovalMap {
    /// Positions of the parts of the group.
    pub group: Vec<usize>,
    /// Directions and triangles.
    pub sphere: Sphere,
    /// The room in each direction of the sphere.
    pub rooms: Vec<PartRoom>,
    /// What is free, exactly; or why there are samples alone.
    pub cover: Result<Cover, String>,
    /// Connected sets of free directions, largest first: of the cover, if there is one, or sampled.
    pub regions: Vec<Region>,
    /// Free directions that lie in no region that can be seen: all around them is blocked but for less than a disc of
    /// [`MapOptions::border`], or as far as was looked.
    pub isolated: Vec<DVec3>,
    /// The size of the assembly, for a scale.
    pub size: f64,
}

impl RemovalMap {
    /// Maps the room of a group against all parts that are not in it. The cover is of all closed parts that meet by
    /// rule: of parts that are open, ignored, to be kept apart or overlap where they are there is none.
    ///
    /// # Errors
    /// Cancelled.
    pub fn new(
        bodies: &Bodies,
        group: &[usize],
        candidates: &[DVec3],
        options: MapOptions,
        watch: Watch,
    ) -> Result<Self, AssemblyError> {
        let cover = Cover::new(bodies, group, options.start, watch)?;
        let mut mapper = Mapper::new(bodies, group, vec![true; bodies.len()], options, watch);
        mapper.ask()?;
        mapper.refine_farthest()?;
        let Aabb { low, high } = bodies.assembly().bounds();
        let size = (high - low).length();
        // Smaller than the border is known: single directions.
        let smallest = std::f64::consts::PI * options.border * options.border;
        let group = group.to_vec();
        if let Ok(exact) = &cover {
            let (regions, isolated) = exact.told(smallest);
            let Mapper { sphere, rooms, .. } = mapper;
            return Ok(Self { group, sphere, rooms, cover, regions, isolated, size });
        }
        let free = mapper.free_candidates(candidates)?;
        mapper.refine_around(&free)?;
        mapper.refine_border()?;
        let Mapper { sphere, rooms, .. } = mapper;
        let mut regions = regions::regions(&sphere, &rooms);
        let single: Vec<DVec3> =
            regions.iter().filter(|r| r.solid_angle < smallest).map(|r| r.center).collect();
        regions.retain(|r| r.solid_angle >= smallest);
        let open = |d: &DVec3| {
            let corners = sphere.triangles[sphere.locate(*d).0].corners;
            corners.iter().all(|&k| !rooms[k as usize].is_free())
        };
        let mut isolated: Vec<DVec3> = free.into_iter().filter(open).collect();
        for d in single {
            if isolated.iter().all(|known| angle(*known, d) > options.border) {
                isolated.push(d);
            }
        }
        Ok(Self { group, sphere, rooms, cover, regions, isolated, size })
    }

    /// The share of the sphere that is free: at least, of a cover, or as sampled.
    pub fn free_share(&self) -> f64 {
        if let Ok(cover) = &self.cover {
            return cover.free_share();
        }
        let area: f64 = self.regions.iter().map(|r| r.solid_angle).sum();
        (area / (4.0 * std::f64::consts::PI)).max(0.0)
    }
}

/// Local farthest directions whose surroundings are refined, at most.
const MOST_PEAKS: usize = 24;
/// Rounds of refinement around each.
const PEAK_ROUNDS: usize = 3;

struct Mapper<'a> {
    bodies: &'a Bodies<'a>,
    group: &'a [usize],
    others: Vec<bool>,
    options: MapOptions,
    watch: Watch<'a>,
    sphere: Sphere,
    rooms: Vec<PartRoom>,
}

impl<'a> Mapper<'a> {
    fn new(
        bodies: &'a Bodies<'a>,
        group: &'a [usize],
        others: Vec<bool>,
        options: MapOptions,
        watch: Watch<'a>,
    ) -> Self {
        let sphere = Sphere::with_directions(options.samples);
        Self { bodies, group, others, options, watch, sphere, rooms: Vec::new() }
    }

    /// Asks the directions that have no room yet.
    fn ask(&mut self) -> Result<(), AssemblyError> {
        let fresh = self.rooms_of(&self.sphere.directions[self.rooms.len()..])?;
        self.rooms.extend(fresh);
        Ok(())
    }

    fn rooms_of(&self, directions: &[DVec3]) -> Result<Vec<PartRoom>, AssemblyError> {
        let tally = self.watch.stage(Stage::Map, directions.len());
        let look = |workspace: &mut Workspace, d: &DVec3| {
            let start = self.options.start;
            let room = room_of(self.bodies, self.group, &self.others, *d, start, workspace);
            tally.step().map(|()| room)
        };
        directions.par_iter().map_init(Workspace::default, look).collect()
    }

    fn free_candidates(&self, candidates: &[DVec3]) -> Result<Vec<DVec3>, AssemblyError> {
        let rooms = self.rooms_of(candidates)?;
        let free = candidates.iter().zip(rooms).filter(|(_, room)| room.is_free());
        Ok(free.map(|(d, _)| *d).collect())
    }

    /// Cuts around the directions that go farther than all around them, if none of those is free.
    fn refine_farthest(&mut self) -> Result<(), AssemblyError> {
        for _ in 0..PEAK_ROUNDS {
            let mut highest = vec![0.0_f64; self.rooms.len()];
            for t in self.sphere.leaves() {
                let corners = self.sphere.triangles[t].corners.map(|k| k as usize);
                let best = corners
                    .map(|k| self.rooms[k].displaced_distance())
                    .into_iter()
                    .fold(0.0, f64::max);
                for k in corners {
                    highest[k] = highest[k].max(best);
                }
            }
            let peak = |k: &usize| {
                let distance = self.rooms[*k].displaced_distance();
                distance.is_finite() && distance > 0.0 && distance >= highest[*k]
            };
            let mut peaks: Vec<usize> = (0..self.rooms.len()).filter(peak).collect();
            let far = |k: usize| self.rooms[k].displaced_distance();
            peaks.sort_by(|a, b| far(*b).total_cmp(&far(*a)).then(a.cmp(b)));
            peaks.truncate(MOST_PEAKS);
            let peaks: BTreeSet<u32> = peaks.into_iter().map(|k| k as u32).collect();
            let around =
                |t: &usize| self.sphere.triangles[*t].corners.iter().any(|k| peaks.contains(k));
            let cuts: Vec<usize> = self.sphere.leaves().filter(around).collect();
            self.cut(cuts)?;
        }
        Ok(())
    }

    /// Cuts towards free directions until the samples around them are free too, or as close as the
    /// border is to be known.
    fn refine_around(&mut self, free: &[DVec3]) -> Result<(), AssemblyError> {
        loop {
            let wanted = |d: &DVec3| {
                let t = self.sphere.locate(*d).0;
                let corners = self.sphere.triangles[t].corners;
                let shut = corners.iter().all(|&k| !self.rooms[k as usize].is_free());
                (shut && self.sphere.widest(t) > self.options.border).then_some(t)
            };
            let cuts: BTreeSet<usize> = free.iter().filter_map(wanted).collect();
            if cuts.is_empty() {
                return Ok(());
            }
            self.cut(cuts)?;
        }
    }

    /// Cuts the triangles on the border of free regions.
    fn refine_border(&mut self) -> Result<(), AssemblyError> {
        loop {
            let mixed = |t: &usize| {
                let [a, b, c] =
                    self.sphere.triangles[*t].corners.map(|k| self.rooms[k as usize].is_free());
                (a != b || b != c) && self.sphere.widest(*t) > self.options.border
            };
            let cuts: Vec<usize> = self.sphere.leaves().filter(mixed).collect();
            if cuts.is_empty() {
                return Ok(());
            }
            self.cut(cuts)?;
        }
    }

    fn cut(&mut self, triangles: impl IntoIterator<Item = usize>) -> Result<(), AssemblyError> {
        triangles.into_iter().for_each(|t| self.sphere.cut(t));
        self.ask()
    }
}
