//! Removal maps: the free travel of a part or group over the whole sphere of directions.
//!
//! For closed parts without exceptions, the free directions are the proven [`Cover`] with exact borders. Travel along
//! blocked directions is sampled on a subdivided icosahedron. Without a cover, free directions are sampled as well,
//! and [`RemovalMap::cover`] contains the reason.
//!
//! Samples are refined in three places: around the directions of farthest travel, where a narrow free region may
//! hide; around free candidate directions; and on triangles with free and blocked corners, until the border is known
//! to the requested angle. With a cover only the first refinement is needed. A free candidate whose surrounding
//! samples are all blocked is *isolated*, as for a tight fit.

mod cover;
#[cfg(feature = "report")]
mod draw;
#[cfg(feature = "report")]
mod outline;
mod regions;
mod removal_direction;

use std::collections::BTreeSet;

use colltrans::Aabb;
use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;
use rayon::prelude::*;

use crate::bodies::Bodies;
use crate::error::AssemblyError;
use crate::sphere::{Sphere, angle_between};
use crate::travel::{PartTravel, travel_of_group};
use crate::watch::{Stage, Watch};

pub use cover::Cover;
#[cfg(feature = "report")]
pub use draw::{render_png, render_svg};
pub use regions::Region;
pub(crate) use removal_direction::find_removal_direction;

/// Options of a removal map.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MapOptions {
    /// Minimum number of samples before refinement.
    pub samples: usize,
    /// Angle to which the border of free regions is refined, in radians.
    pub border: f64,
    /// Treatment of overlaps at the start.
    pub start: StartOverlap,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self { samples: 2_562, border: 0.01, start: StartOverlap::Refuse }
    }
}

impl MapOptions {
    /// Returns the options with another number of [`samples`](Self::samples).
    #[must_use]
    pub fn with_samples(self, samples: usize) -> Self {
        Self { samples, ..self }
    }

    /// Returns the options with another [`border`](Self::border) angle.
    #[must_use]
    pub fn with_border(self, border: f64) -> Self {
        Self { border, ..self }
    }

    /// Returns the options with another treatment of overlaps at the [`start`](Self::start).
    #[must_use]
    pub fn with_start(self, start: StartOverlap) -> Self {
        Self { start, ..self }
    }
}

/// The free travel of a group over the sphere of directions.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RemovalMap {
    /// Indices of the parts of the group.
    pub group: Vec<usize>,
    /// The sampled directions and their triangles.
    pub sphere: Sphere,
    /// The free travel along each direction of the sphere.
    pub travels: Vec<PartTravel>,
    /// The exact free directions, or the reason why there are only samples.
    pub cover: Result<Cover, String>,
    /// Connected sets of free directions, largest first; those of the cover if it exists, otherwise sampled.
    pub regions: Vec<Region>,
    /// Free directions outside of all listed regions. Regions smaller than a disc of radius [`MapOptions::border`]
    /// are listed here by their centre.
    pub isolated: Vec<DVec3>,
    /// The diagonal of the assembly's bounding box, as a scale for pictures.
    pub size: f64,
}

impl RemovalMap {
    /// Computes the removal map of a group against all parts outside of it.
    ///
    /// The cover requires closed parts. There is none with a minimum gap, or if a pair is ignored, has a fit of its
    /// own, or overlaps at the start. `candidates` are directions that are tested in addition if there is no cover.
    ///
    /// # Errors
    /// Returns an error if the run is cancelled.
    pub fn new(
        bodies: &Bodies,
        group: &[usize],
        candidates: &[DVec3],
        options: MapOptions,
        watch: Watch,
    ) -> Result<Self, AssemblyError> {
        let cover = Cover::new(bodies, group, options.start, watch)?;
        let mut mapper = Mapper::new(bodies, group, vec![true; bodies.len()], options, watch);
        mapper.sample_pending()?;
        mapper.refine_farthest()?;
        let Aabb { low, high } = bodies.assembly().bounds();
        let size = (high - low).length();
        // Regions smaller than the resolution of the border are listed as single directions.
        let smallest = std::f64::consts::PI * options.border * options.border;
        let group = group.to_vec();
        if let Ok(exact) = &cover {
            let (regions, isolated) = exact.report_regions(smallest);
            let Mapper { sphere, rooms, .. } = mapper;
            return Ok(Self { group, sphere, travels: rooms, cover, regions, isolated, size });
        }
        let free = mapper.test_candidates(candidates)?;
        mapper.refine_around(&free)?;
        mapper.refine_border()?;
        let Mapper { sphere, rooms, .. } = mapper;
        let mut regions = regions::connected_regions(&sphere, &rooms);
        let single: Vec<DVec3> =
            regions.iter().filter(|r| r.solid_angle < smallest).map(|r| r.center).collect();
        regions.retain(|r| r.solid_angle >= smallest);
        let open = |d: &DVec3| {
            let corners = sphere.triangles[sphere.locate(*d).0].corners;
            corners.iter().all(|&k| !rooms[k as usize].is_free())
        };
        let mut isolated: Vec<DVec3> = free.into_iter().filter(open).collect();
        for d in single {
            if isolated.iter().all(|known| angle_between(*known, d) > options.border) {
                isolated.push(d);
            }
        }
        Ok(Self { group, sphere, travels: rooms, cover, regions, isolated, size })
    }

    /// Returns the fraction of the sphere that is free: a lower bound with a cover, an estimate from samples without
    /// one.
    pub fn free_share(&self) -> f64 {
        if let Ok(cover) = &self.cover {
            return cover.free_share();
        }
        let area: f64 = self.regions.iter().map(|r| r.solid_angle).sum();
        (area / (4.0 * std::f64::consts::PI)).max(0.0)
    }
}

/// Maximum number of local maxima of the travel that are refined in a round.
const MAX_PEAKS: usize = 24;
/// Number of rounds of this refinement.
const PEAK_ROUNDS: usize = 3;

struct Mapper<'a> {
    bodies: &'a Bodies<'a>,
    group: &'a [usize],
    others: Vec<bool>,
    options: MapOptions,
    watch: Watch<'a>,
    sphere: Sphere,
    rooms: Vec<PartTravel>,
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

    /// Computes the travel along the directions that have none yet.
    fn sample_pending(&mut self) -> Result<(), AssemblyError> {
        let fresh = self.sample_rooms(&self.sphere.directions[self.rooms.len()..])?;
        self.rooms.extend(fresh);
        Ok(())
    }

    fn sample_rooms(&self, directions: &[DVec3]) -> Result<Vec<PartTravel>, AssemblyError> {
        let tally = self.watch.start_stage(Stage::Map, directions.len());
        let examine = |workspace: &mut Workspace, d: &DVec3| {
            let start = self.options.start;
            let room = travel_of_group(self.bodies, self.group, &self.others, *d, start, workspace);
            tally.finish_item().map(|()| room)
        };
        directions.par_iter().map_init(Workspace::default, examine).collect()
    }

    fn test_candidates(&self, candidates: &[DVec3]) -> Result<Vec<DVec3>, AssemblyError> {
        let rooms = self.sample_rooms(candidates)?;
        let free = candidates.iter().zip(rooms).filter(|(_, room)| room.is_free());
        Ok(free.map(|(d, _)| *d).collect())
    }

    /// Subdivides the triangles around local maxima of the travel, unless a neighbouring direction is free.
    fn refine_farthest(&mut self) -> Result<(), AssemblyError> {
        for _ in 0..PEAK_ROUNDS {
            let mut highest = vec![0.0_f64; self.rooms.len()];
            for t in self.sphere.leaf_triangles() {
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
            peaks.truncate(MAX_PEAKS);
            let peaks: BTreeSet<u32> = peaks.into_iter().map(|k| k as u32).collect();
            let around =
                |t: &usize| self.sphere.triangles[*t].corners.iter().any(|k| peaks.contains(k));
            let cuts: Vec<usize> = self.sphere.leaf_triangles().filter(around).collect();
            self.cut_triangles(cuts)?;
        }
        Ok(())
    }

    /// Subdivides the triangles that contain free directions until a corner is free or the triangle is narrower than
    /// the border angle.
    fn refine_around(&mut self, free: &[DVec3]) -> Result<(), AssemblyError> {
        loop {
            let wanted = |d: &DVec3| {
                let t = self.sphere.locate(*d).0;
                let corners = self.sphere.triangles[t].corners;
                let shut = corners.iter().all(|&k| !self.rooms[k as usize].is_free());
                (shut && self.sphere.longest_side(t) > self.options.border).then_some(t)
            };
            let cuts: BTreeSet<usize> = free.iter().filter_map(wanted).collect();
            if cuts.is_empty() {
                return Ok(());
            }
            self.cut_triangles(cuts)?;
        }
    }

    /// Subdivides the triangles on the border of free regions down to the border angle.
    fn refine_border(&mut self) -> Result<(), AssemblyError> {
        loop {
            let mixed = |t: &usize| {
                let [a, b, c] =
                    self.sphere.triangles[*t].corners.map(|k| self.rooms[k as usize].is_free());
                (a != b || b != c) && self.sphere.longest_side(*t) > self.options.border
            };
            let cuts: Vec<usize> = self.sphere.leaf_triangles().filter(mixed).collect();
            if cuts.is_empty() {
                return Ok(());
            }
            self.cut_triangles(cuts)?;
        }
    }

    fn cut_triangles(
        &mut self,
        triangles: impl IntoIterator<Item = usize>,
    ) -> Result<(), AssemblyError> {
        triangles.into_iter().for_each(|t| self.sphere.subdivide(t));
        self.sample_pending()
    }
}
