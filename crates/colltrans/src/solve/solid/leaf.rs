//! Two facets: whether their pair counts, and for how much.
//!
//! `f` is a front facet of the moving body (its shadow runs counter-clockwise), `g` a back facet of
//! the fixed one, its corners listed backwards so that its shadow runs counter-clockwise too. The
//! interiors of the shadows overlap unless a side of one separates them. Over the common shadow the
//! gap `h_g - h_f` is linear; its corners are corners of `f` under `g`, corners of `g` over `f`, and
//! crossings of sides. The pair *counts* if the largest gap is positive, or zero all over. A facet of an
//! open shell has no side: it is both a front and a back facet, unless it is [on edge](super::rim).
//!
//! All that is decided is decided exactly: rounded values are used where their error bounds allow,
//! and else the signs are those of
//! `outside(g, f_i)` (corner of `f` under `g`), `outside(f, g_j)` (corner of `g` over `f`) and
//! `-outside(p, q, r, s) turn(p, q, s)` (side `p q` of `f` under side `r s` of `g`).

use std::cmp::Ordering;

use glam::DVec3;

use super::scene::{Corner, Scene, Side};
use super::sign::rough_turn;
use crate::number::integer::{Integer, LARGE, SMALL, determinant, difference};

/// Rounded gaps are used while their error is below so many times the noise of coordinates, `2e-10 S`;
/// the one that decides is taken again exactly if its error is not below [`FINE`] times the noise.
pub(crate) const SHARP: f64 = 65_536.0;
pub(crate) const FINE: f64 = 256.0;

/// A facet, its shadow running counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facet {
    pub(crate) triangle: u32,
    pub(crate) corners: [Corner; 3],
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    /// Its plane.
    slope: Slope,
}

impl Facet {
    /// The facet if it is a front (`Greater`) or back (`Less`) facet of its body; without a side, it is
    /// both.
    pub(crate) fn facing(
        scene: &Scene,
        moving: bool,
        triangle: usize,
        wanted: Ordering,
    ) -> Option<Self> {
        let side = scene.side(moving);
        let (corners, turn) = listed(scene, side, triangle);
        if turn != wanted && (turn == Ordering::Equal || !side.solid.is_open(triangle)) {
            return None;
        }
        let places = corners.map(|c| c.at);
        let [a, b, c] = places;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let slope = Slope::new(scene, places);
        Some(Self { triangle: triangle as u32, corners, low, high, slope })
    }

    /// At least so far all corners of another facet lie below the plane, for a `sign` of 1, or above it,
    /// for -1.
    fn least_off(&self, other: &Self, sign: f64) -> f64 {
        let off = |c: &Corner| self.slope.height_above(c.at);
        other
            .corners
            .iter()
            .map(off)
            .map(|(h, error)| sign * h - error)
            .fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn side(&self, k: usize) -> [&Corner; 2] {
        [&self.corners[k], &self.corners[(k + 1) % 3]]
    }
}

/// The corners of a triangle, listed so that its shadow runs counter-clockwise if it has an area, and
/// which way it runs as it is.
pub(crate) fn listed(scene: &Scene, side: &Side, triangle: usize) -> ([Corner; 3], Ordering) {
    let mut corners = side.corners(triangle);
    let turn = scene.turn(&corners[0], &corners[1], &corners[2]);
    if turn == Ordering::Less {
        corners.swap(1, 2);
    }
    (corners, turn)
}

/// What meets what at a corner of the common shadow; numbers are positions among the [`listed`] corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Meeting {
    /// A corner of the moving facet and the fixed facet.
    Corner(u8),
    /// The moving facet and a corner of the fixed one.
    Under(u8),
    /// Two sides, each named by its first corner.
    Sides(u8, u8),
    /// A corner of the moving facet and a side of the fixed one.
    OnSide(u8, u8),
    /// A side of the moving facet and a corner of the fixed one.
    UnderSide(u8, u8),
}

/// The range of the gap over the common shadow.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap {
    /// The least gap, as a length.
    pub(crate) least: f64,
    pub(crate) largest: f64,
    /// Their signs, exactly.
    pub(crate) signs: [Ordering; 2],
    /// Where the gap is least.
    pub(crate) at: Meeting,
    /// Bound of the error of its values.
    pub(crate) error: f64,
}

impl Gap {
    /// Whether the largest gap is positive, or the gap zero all over.
    pub(crate) fn counts(&self) -> bool {
        matches!(self.signs, [_, Ordering::Greater] | [Ordering::Equal, Ordering::Equal])
    }
}

/// On which side of a side a corner lies: rounded, the error of that, and exactly once resolved.
#[derive(Clone, Copy)]
struct Turn {
    value: f64,
    error: f64,
    sign: Ordering,
}

/// The turns of each side of one facet with each corner of the other.
struct Turns([[Turn; 3]; 3]);

impl Turns {
    /// With exact signs.
    fn exact(scene: &Scene, sides: &Facet, corners: &Facet) -> Self {
        let mut turns = Self([0, 1, 2].map(|k| Self::about(scene, sides, k, corners)));
        turns.resolve(scene, sides, corners);
        turns
    }

    /// `None` if a side certainly has all corners on its outer side.
    fn unless_apart(scene: &Scene, sides: &Facet, corners: &Facet) -> Option<Self> {
        let mut turns = [[Turn { value: 0.0, error: 0.0, sign: Ordering::Equal }; 3]; 3];
        for (k, row) in turns.iter_mut().enumerate() {
            *row = Self::about(scene, sides, k, corners);
            if row.iter().all(|t| t.value < -t.error) {
                return None;
            }
        }
        Some(Self(turns))
    }

    /// Those of side `k`.
    fn about(scene: &Scene, sides: &Facet, k: usize, corners: &Facet) -> [Turn; 3] {
        let (a, b) = (sides.corners[k].at, sides.corners[(k + 1) % 3].at);
        corners.corners.each_ref().map(|corner| {
            let (value, error) = rough_turn(scene, a, b, corner.at);
            let sign = if value > 0.0 { Ordering::Greater } else { Ordering::Less };
            Turn { value, error, sign }
        })
    }

    /// Makes all signs exact.
    fn resolve(&mut self, scene: &Scene, sides: &Facet, corners: &Facet) {
        for k in 0..3 {
            let [a, b] = sides.side(k);
            for j in 0..3 {
                let turn = &mut self.0[k][j];
                if turn.value.abs() <= turn.error {
                    turn.sign = scene.turn(a, b, &corners.corners[j]);
                }
            }
        }
    }

    /// Whether rounding leaves no sign in doubt.
    fn are_certain(&self) -> bool {
        self.0.iter().flatten().all(|turn| turn.value.abs() > turn.error)
    }

    /// Whether side `k` certainly has a corner on its inner side.
    fn admits(&self, k: usize) -> bool {
        self.0[k].iter().any(|t| t.value > t.error)
    }

    /// Whether rounding cannot tell that corner `j` lies outside the shadow of the facet of the sides.
    fn may_contain(&self, j: usize) -> bool {
        self.0.iter().all(|side| side[j].value >= -side[j].error)
    }

    /// Whether corner `j` lies in the shadow of the facet of the sides, or on its rim.
    fn contain(&self, j: usize) -> bool {
        self.0.iter().all(|side| side[j].sign != Ordering::Less)
    }
}

/// Which pairs are of interest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    All,
    /// The largest gap is not negative; the sign of the least one is not needed.
    NotParting,
    /// Nor is the least.
    NotCrossing,
}

/// The gap where the interiors of the shadows overlap and the pair is of interest; `limit` is what it
/// has to stay below.
pub(crate) fn gap(scene: &Scene, f: &Facet, g: &Facet, limit: f64, wanted: Wanted) -> Option<Gap> {
    let noise = 4.0 * scene.noise;
    let apart = |k: usize| g.low[k] - f.high[k] > noise || f.low[k] - g.high[k] > noise;
    if apart(0) || apart(1) || g.low.z - f.high.z - noise >= limit {
        return None;
    }
    // A gap is linear over either facet: nowhere less than at the corners of one.
    if f.least_off(g, -1.0).max(g.least_off(f, 1.0)) >= limit {
        return None;
    }
    let mut of_f = Turns::unless_apart(scene, f, g)?;
    let mut of_g = Turns::unless_apart(scene, g, f)?;
    let separated = (0..3).any(|k| !of_f.admits(k) && separates(scene, f, k, g))
        || (0..3).any(|k| !of_g.admits(k) && separates(scene, g, k, f));
    if separated {
        return None;
    }
    of_f.resolve(scene, f, g);
    of_g.resolve(scene, g, f);
    let range = rounded(scene, f, g, &of_f, &of_g);
    // Certain whatever the other corners are: nothing more needs to be known of slivers that cross.
    let parting = wanted != Wanted::All && range.bound[1] < 0.0;
    if parting || wanted == Wanted::NotCrossing && range.negative {
        return None;
    }
    match range.judge(SHARP * scene.noise, wanted == Wanted::NotCrossing) {
        Rounded::Known(gap) => Some(gap),
        Rounded::Beyond(least) if least >= limit => None,
        Rounded::Beyond(_) => Some(exact(scene, f, g, &of_f, &of_g, |_| true)),
    }
}

/// The least gap of two facets whose shadows overlap, exact but for its last roundings, and where.
/// Corners of the common shadow that rounding says are not the lowest are left out.
pub(crate) fn least_exactly(scene: &Scene, f: &Facet, g: &Facet) -> (f64, Meeting) {
    let (of_f, of_g) = (Turns::exact(scene, f, g), Turns::exact(scene, g, f));
    let mut least = f64::INFINITY;
    each_gap(scene, f, g, &of_f, &of_g, |(value, error), _| least = least.min(value + error));
    let low = |(value, error): (f64, f64)| value - error <= least;
    let mut near = [None; 15];
    let mut count = 0;
    each_gap(scene, f, g, &of_f, &of_g, |gap, at| {
        if low(gap) {
            near[count] = Some(at);
            count += 1;
        }
    });
    let keep = |at: Meeting| near[..count].contains(&Some(at));
    let gap = exact(scene, f, g, &of_f, &of_g, keep);
    (gap.least, gap.at)
}

/// The gap of two facets whose shadows overlap, exact but for its last roundings.
pub(crate) fn sharpened(scene: &Scene, f: &Facet, g: &Facet) -> Gap {
    let (of_f, of_g) = (Turns::exact(scene, f, g), Turns::exact(scene, g, f));
    exact(scene, f, g, &of_f, &of_g, |_| true)
}

/// The least gap of two triangles, the moving body's first, where they certainly block each other, and
/// its error; `None` as well where only whole numbers could tell that, which would take longer than a
/// search.
pub(crate) fn gap_of(scene: &Scene, [moving, fixed]: [u32; 2]) -> Option<(f64, f64)> {
    let f = Facet::facing(scene, true, moving as usize, Ordering::Greater)?;
    let g = Facet::facing(scene, false, fixed as usize, Ordering::Less)?;
    let mut of_f = Turns::unless_apart(scene, &f, &g)?;
    let mut of_g = Turns::unless_apart(scene, &g, &f)?;
    if scene.is_aligned() {
        // Coordinates are exact, and so are signs of them, at no cost.
        of_f.resolve(scene, &f, &g);
        of_g.resolve(scene, &g, &f);
        let separated = (0..3).any(|k| separates(scene, &f, k, &g) || separates(scene, &g, k, &f));
        if separated {
            return None;
        }
    } else if !of_f.are_certain() || !of_g.are_certain() {
        return None;
    }
    match rounded(scene, &f, &g, &of_f, &of_g).judge(SHARP * scene.noise, false) {
        Rounded::Known(gap) if !gap.counts() => None,
        Rounded::Known(gap) if gap.error <= FINE * scene.noise => Some((gap.least, gap.error)),
        // Slivers.
        Rounded::Known(_) => Some((least_exactly(scene, &f, &g).0, 0.0)),
        Rounded::Beyond(_) => None,
    }
}

/// Two triangles, the moving body's first, have no smaller gap than this where the interiors of their
/// shadows overlap, whatever rounding leaves in doubt; infinite if they face away or certainly do not
/// overlap.
pub(crate) fn least_in_doubt(scene: &Scene, [moving, fixed]: [u32; 2]) -> f64 {
    let f = Facet::facing(scene, true, moving as usize, Ordering::Greater);
    let g = Facet::facing(scene, false, fixed as usize, Ordering::Less);
    let (Some(f), Some(g)) = (&f, &g) else { return f64::INFINITY };
    let of_f = Turns::unless_apart(scene, f, g);
    let of_g = Turns::unless_apart(scene, g, f);
    let (Some(of_f), Some(of_g)) = (of_f, of_g) else { return f64::INFINITY };
    // The gap is linear over either facet, so nowhere less than at the corners of one; and least at a
    // corner of the common shadow, which is one of those that may be.
    let anywhere = f.least_off(g, -1.0).max(g.least_off(f, 1.0));
    let mut least = f64::INFINITY;
    let mut add = |(value, error): (f64, f64)| least = least.min(value - error);
    for k in 0..3 {
        if of_g.may_contain(k) {
            add(g.slope.height_above(f.corners[k].at));
        }
        if of_f.may_contain(k) {
            let (height, error) = f.slope.height_above(g.corners[k].at);
            add((-height, error));
        }
        for j in (0..3).filter(|&j| may_cross(&of_f, &of_g, [k, j])) {
            add(crossing(scene, [f, g], [k, j], &of_f, &of_g));
        }
    }
    least.max(anywhere)
}

/// Whether side `k` of `f` and side `j` of `g` may cross.
fn may_cross(of_f: &Turns, of_g: &Turns, [k, j]: [usize; 2]) -> bool {
    let next = |k: usize| (k + 1) % 3;
    let one_side = |x: Turn, y: Turn| {
        (x.value > x.error && y.value > y.error) || (x.value < -x.error && y.value < -y.error)
    };
    !one_side(of_f.0[k][j], of_f.0[k][next(j)]) && !one_side(of_g.0[j][k], of_g.0[j][next(k)])
}

/// Whether side `k` of a facet has no corner of the other on its inner side, exactly.
fn separates(scene: &Scene, facet: &Facet, k: usize, other: &Facet) -> bool {
    let [a, b] = facet.side(k);
    other.corners.iter().all(|c| scene.turn(a, b, c) != Ordering::Greater)
}

/// The gap from rounded coordinates.
enum Rounded {
    /// Errors are small and the signs are certain.
    Known(Gap),
    /// The least gap is certainly not smaller than this.
    Beyond(f64),
}

/// Gathers gaps at the corners of the common shadow.
struct Range {
    least: f64,
    largest: f64,
    at: Meeting,
    negative: bool,
    positive: bool,
    /// Bounds of all gaps, and the largest error of one.
    bound: [f64; 2],
    worst: f64,
}

impl Range {
    fn add(&mut self, (value, error): (f64, f64), at: Meeting) {
        if value < self.least {
            (self.least, self.at) = (value, at);
        }
        self.largest = self.largest.max(value);
        self.worst = self.worst.max(error);
        self.bound = [self.bound[0].min(value - error), self.bound[1].max(value + error)];
        self.negative |= value < -error;
        self.positive |= value > error;
    }

    fn judge(self, sharp: f64, needed: bool) -> Rounded {
        let [low, high] = self.bound;
        let least = if low > 0.0 {
            Some(Ordering::Greater)
        } else {
            (self.negative || !needed).then_some(Ordering::Less)
        };
        let largest = if self.positive {
            Some(Ordering::Greater)
        } else {
            (high < 0.0).then_some(Ordering::Less)
        };
        match (least, largest) {
            (Some(a), Some(b)) if self.worst <= sharp => {
                let Self { least, largest, at, worst, .. } = self;
                Rounded::Known(Gap { least, largest, signs: [a, b], at, error: worst })
            }
            _ => Rounded::Beyond(low),
        }
    }
}

fn rounded(scene: &Scene, f: &Facet, g: &Facet, of_f: &Turns, of_g: &Turns) -> Range {
    let mut range = Range {
        least: f64::INFINITY,
        largest: f64::NEG_INFINITY,
        at: Meeting::Corner(0),
        negative: false,
        positive: false,
        bound: [f64::INFINITY, f64::NEG_INFINITY],
        worst: 0.0,
    };
    each_gap(scene, f, g, of_f, of_g, |gap, at| range.add(gap, at));
    range
}

/// The rounded gap at each corner of the common shadow, and a bound of its error.
fn each_gap(
    scene: &Scene,
    f: &Facet,
    g: &Facet,
    of_f: &Turns,
    of_g: &Turns,
    mut add: impl FnMut((f64, f64), Meeting),
) {
    let (under, over) = (&g.slope, &f.slope);
    for k in 0..3 {
        if of_g.contain(k) {
            add(under.height_above(f.corners[k].at), Meeting::Corner(k as u8));
        }
        if of_f.contain(k) {
            let (height, error) = over.height_above(g.corners[k].at);
            add((-height, error), Meeting::Under(k as u8));
        }
    }
    for k in 0..3 {
        for j in 0..3 {
            if cross(of_f, of_g, [k, j]) {
                let gap = crossing(scene, [f, g], [k, j], of_f, of_g);
                add(gap, Meeting::Sides(k as u8, j as u8));
            }
        }
    }
}

/// Whether side `k` of `f` and side `j` of `g` cross in points that are no ends of them.
fn cross(of_f: &Turns, of_g: &Turns, [k, j]: [usize; 2]) -> bool {
    let next = |k: usize| (k + 1) % 3;
    let strictly = |x: Turn, y: Turn| x.sign != Ordering::Equal && x.sign == y.sign.reverse();
    strictly(of_f.0[k][j], of_f.0[k][next(j)]) && strictly(of_g.0[j][k], of_g.0[j][next(k)])
}

/// The gap where side `k` of `f` crosses side `j` of `g`, and a bound of its error.
fn crossing(
    scene: &Scene,
    [f, g]: [&Facet; 2],
    [k, j]: [usize; 2],
    of_f: &Turns,
    of_g: &Turns,
) -> (f64, f64) {
    let next = |k: usize| (k + 1) % 3;
    let (r, s) = (of_f.0[k][j], of_f.0[k][next(j)]);
    let (p, q) = (of_g.0[j][k], of_g.0[j][next(k)]);
    let ([a, b], [c, e]) = (f.side(k).map(|c| c.at), g.side(j).map(|c| c.at));
    let (across, back) = (p.value - q.value, r.value - s.value);
    let gap = c.z + (e.z - c.z) * (r.value / back) - a.z - (b.z - a.z) * (p.value / across);
    // Where on its side the crossing is, and what that makes of the height.
    let slide = |width: f64, x: Turn, y: Turn, rise: f64| {
        let share = (x.error + y.error) / width.abs();
        if share < 0.25 { 2.0 * share * rise.abs() } else { f64::INFINITY }
    };
    let error = 8.0 * scene.noise + slide(across, p, q, b.z - a.z) + slide(back, r, s, e.z - c.z);
    if gap.is_finite() && error.is_finite() { (gap, error) } else { (0.0, f64::INFINITY) }
}

/// The plane of a facet as heights over the shadow.
#[derive(Debug, Clone, Copy)]
struct Slope {
    origin: DVec3,
    normal: DVec3,
    /// Error of a height over a point at distance 1, and at the origin.
    tilt: f64,
    level: f64,
}

impl Slope {
    fn new(scene: &Scene, [a, b, c]: [DVec3; 3]) -> Self {
        // From the two shorter sides, which determine the plane best.
        let sides = [b - a, c - b, a - c];
        let lengths = sides.map(DVec3::length_squared);
        let longest = if lengths[0] >= lengths[1].max(lengths[2]) {
            0
        } else if lengths[1] >= lengths[2] {
            1
        } else {
            2
        };
        let (i, j) = ((longest + 1) % 3, (longest + 2) % 3);
        let normal = sides[i].cross(sides[j]);
        let size = sides[i].abs().max_element() + sides[j].abs().max_element();
        let noise = 8.0 * scene.noise * (size + scene.noise) + 4.0 * f64::EPSILON * size * size;
        let steep = normal.length() / normal.z;
        let upright = normal.z > 8.0 * noise;
        Self {
            origin: [a, b, c][j],
            normal,
            // A turned normal: its error over its upward part, and what that makes of the rest.
            tilt: if upright { 6.0 * noise / normal.z * steep } else { f64::INFINITY },
            level: if upright { 8.0 * scene.noise * steep } else { f64::INFINITY },
        }
    }

    /// How far the plane lies above a point.
    fn height_above(&self, p: DVec3) -> (f64, f64) {
        let to = self.origin - p;
        let error = self.level + self.tilt * to.abs().max_element();
        let height = self.normal.dot(to) / self.normal.z;
        // A facet on edge has no heights to speak of.
        if height.is_finite() && !error.is_nan() { (height, error) } else { (0.0, f64::INFINITY) }
    }
}

/// The gap from exact signs at those corners of the common shadow that are to be kept, its values
/// exact but for their last roundings.
fn exact(
    scene: &Scene,
    f: &Facet,
    g: &Facet,
    of_f: &Turns,
    of_g: &Turns,
    keep: impl Fn(Meeting) -> bool,
) -> Gap {
    let small = exact_in::<SMALL>(scene, f, g, of_f, of_g, &keep);
    let gap = small.or_else(|| exact_in::<LARGE>(scene, f, g, of_f, of_g, &keep));
    // Large numbers have room for all there are.
    gap.unwrap_or(NO_GAP)
}

/// Before any corner is looked at.
pub(crate) const NO_GAP: Gap = Gap {
    least: f64::INFINITY,
    largest: f64::NEG_INFINITY,
    signs: [Ordering::Greater, Ordering::Less],
    at: Meeting::Corner(0),
    error: 0.0,
};

/// The same in numbers of a size; `None` if one does not fit.
fn exact_in<const N: usize>(
    scene: &Scene,
    f: &Facet,
    g: &Facet,
    of_f: &Turns,
    of_g: &Turns,
    keep: &impl Fn(Meeting) -> bool,
) -> Option<Gap> {
    let direction = scene.setting.direction.to_array().map(Integer::<N>::number);
    let above = |facet: &Facet, corner: &Corner| above_facet(scene, &direction, facet, corner);
    let mut gap = NO_GAP;
    for k in 0..3 {
        if of_g.contain(k) && keep(Meeting::Corner(k as u8)) {
            gap.add(scene, above(g, &f.corners[k])?.reversed(), Meeting::Corner(k as u8));
        }
        if of_f.contain(k) && keep(Meeting::Under(k as u8)) {
            gap.add(scene, above(f, &g.corners[k])?, Meeting::Under(k as u8));
        }
    }
    for k in 0..3 {
        for j in 0..3 {
            if cross(of_f, of_g, [k, j]) && keep(Meeting::Sides(k as u8, j as u8)) {
                let above = above_side(scene, &direction, f.side(k), g.side(j))?;
                gap.add(scene, above, Meeting::Sides(k as u8, j as u8));
            }
        }
    }
    Some(gap)
}

/// How far a corner is above the plane through a facet, which turns counter-clockwise from below; `None`
/// if a number does not fit.
fn above_facet<const N: usize>(
    scene: &Scene,
    direction: &[Integer<N>; 3],
    facet: &Facet,
    corner: &Corner,
) -> Option<Above> {
    let [a, b, c] = facet.corners.each_ref();
    let [x, y, z] = scene.spans_wide(a, [b, c, corner]);
    Above::new(&determinant(&x, &y, &z), &determinant(&x, &y, direction))
}

/// How far side `c e` is above side `a b` where their shadows cross; `None` if a number does not fit.
fn above_side<const N: usize>(
    scene: &Scene,
    direction: &[Integer<N>; 3],
    [a, b]: [&Corner; 2],
    [c, e]: [&Corner; 2],
) -> Option<Above> {
    let [x, y, z] = scene.spans_wide(a, [b, c, e]);
    let plane = determinant(&x, &difference(&z, &y), direction);
    Some(Above::new(&determinant(&x, &y, &z), &plane)?.reversed())
}

/// How far a corner is above a facet whose shadow holds its own.
pub(crate) fn over_facet(scene: &Scene, facet: &Facet, corner: &Corner) -> Above {
    let d = scene.setting.direction.to_array();
    let small = above_facet::<SMALL>(scene, &d.map(Integer::number), facet, corner);
    let large = || above_facet::<LARGE>(scene, &d.map(Integer::number), facet, corner);
    small.or_else(large).unwrap_or(Above::LEVEL)
}

/// How far a side is above another one where their shadows cross.
pub(crate) fn over_side(scene: &Scene, side: [&Corner; 2], above: [&Corner; 2]) -> Above {
    let d = scene.setting.direction.to_array();
    let small = above_side::<SMALL>(scene, &d.map(Integer::number), side, above);
    let large = || above_side::<LARGE>(scene, &d.map(Integer::number), side, above);
    small.or_else(large).unwrap_or(Above::LEVEL)
}

/// A quotient of two numbers: its sign, and its value to within a few roundings.
#[derive(Clone, Copy)]
pub(crate) struct Above {
    sign: Ordering,
    value: f64,
}

impl Above {
    /// For numbers that do not fit, of which there are none.
    pub(crate) const LEVEL: Self = Self { sign: Ordering::Equal, value: 0.0 };

    /// `None` if one of them did not fit.
    pub(crate) fn new<const N: usize>(volume: &Integer<N>, plane: &Integer<N>) -> Option<Self> {
        let sign = match plane.sign()? {
            Ordering::Less => volume.sign()?.reverse(),
            _ => volume.sign()?,
        };
        Some(Self { sign, value: volume.ratio(plane)? })
    }

    pub(crate) fn reversed(self) -> Self {
        Self { sign: self.sign.reverse(), value: -self.value }
    }
}

impl Gap {
    /// With one more corner of the common shadow, in multiples of the direction.
    pub(crate) fn add(&mut self, scene: &Scene, above: Above, at: Meeting) {
        let Above { sign, value } = above;
        let value = if sign == Ordering::Equal { 0.0 } else { value * scene.setting.length };
        if value < self.least {
            (self.least, self.at) = (value, at);
        }
        self.largest = self.largest.max(value);
        self.signs = [self.signs[0].min(sign), self.signs[1].max(sign)];
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;
    use proptest::prelude::*;

    use super::super::search::{Aim, exact_gap};
    use super::*;
    use crate::body::Pose;
    use crate::body::solid::Solid;
    use crate::cast::Cast;

    fn point() -> impl Strategy<Value = DVec3> {
        (-2_i8..=2, -2_i8..=2, -2_i8..=2)
            .prop_map(|(x, y, z)| DVec3::from([x, y, z].map(f64::from)))
    }

    fn triangle() -> impl Strategy<Value = Solid> {
        [point(), point(), point()].prop_filter_map("no area", |corners| {
            Solid::from_open_mesh(&corners, &[[0, 1, 2]]).ok()
        })
    }

    fn rotation() -> impl Strategy<Value = DQuat> {
        let turned = [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0, 0.25..1.0];
        let turned = turned.prop_map(|q| DQuat::from_array(q).normalize());
        prop_oneof![Just(DQuat::IDENTITY), turned]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4_000))]

        /// Corners over corners, sides over sides: in turned poses rounding leaves them in doubt.
        #[test]
        fn no_gap_is_less_than_the_least_possible_one(
            a in triangle(), b in triangle(), q in rotation(), d in point(), t in point(),
        ) {
            prop_assume!(d != DVec3::ZERO);
            let turned = |t| Pose::new(q, q * t).expect("a rotation");
            let cast = Cast::new(a.at(turned(DVec3::ZERO)), b.at(turned(t)), q * d).expect("a query");
            let cast = cast.with_tolerance(0.0).expect("a tolerance");
            let scene = cast.asked();
            let f = Facet::facing(&scene, true, 0, Ordering::Greater);
            let g = Facet::facing(&scene, false, 0, Ordering::Less);
            if let (Some(f), Some(g)) = (f, g)
                && gap(&scene, &f, &g, f64::INFINITY, Wanted::All).is_some()
            {
                let least = sharpened(&scene, &f, &g).least;
                let possible = least_in_doubt(&scene, [0, 0]);
                prop_assert!(possible <= least + scene.noise, "{possible}, but {least}");
                if let Some((exact, _)) = exact_gap(&scene, Aim::Stop, [0, 0]) {
                    prop_assert_eq!(exact, least);
                }
            }
        }
    }
}
