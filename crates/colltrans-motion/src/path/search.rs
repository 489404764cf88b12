//! Two bodies along a path, by their pieces.
//!
//! Pieces that hold others, boxes, are only kept apart where that is cheap: in steps that are not small beside them.
//! Where they are not, for a while, the larger one is taken apart, and its parts are followed for that while, and so
//! on down to the bodies' own pieces.
//!
//! Invariant. Up to where a cover ends, no two points of the pieces meet; it ends where it is to, or where two of
//! the bodies' own pieces meet, or may.

use super::super::bend::Climbing;
use super::super::course::Course;
use super::super::look::ConvexLooker;
use super::super::proof::PlaneAt;
use super::super::solid::inside::Guesses;
use super::super::soon::{Seen, soon};
use super::couple::Couple;
use super::follow::{Fate, Pieces, Way};
use super::mechanism::Place;
use super::proof::{Cover, How, Step};
use super::shape::Shape;
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::setting::TwoBodies;
use colltrans_kernel::descent::{node_to_split, replaced};
use colltrans_solid::body::Solid;

/// Steps of boxes are not smaller than such a share of their size.
const SMALL: f64 = 0.25;

/// Pairs of pieces that are looked at in one place, at most.
const MOST_SEEN: usize = 1 << 14;

/// What ends the search.
#[derive(Debug)]
pub(super) enum Stop {
    /// The bodies meet at a place.
    Met(Place, How),
    /// They may.
    Blurred,
    /// Too many steps.
    Stalled,
}

impl Stop {
    /// Whether this, found at a place before that of another stop, takes its place: but bodies that may meet here do so no
    /// later than where others are proven to.
    pub(super) fn tells_more(&self, before: &Self) -> bool {
        !matches!((self, before), (Self::Blurred, Self::Met(..)))
    }
}

/// A search between two bodies.
pub(super) struct Search<'p> {
    pub(super) couple: &'p Couple<'p>,
    pub(super) shapes: [&'p Shape<'p>; 2],
    pub(super) looker: ConvexLooker,
    /// The first stop that was found, and where: nothing is asked beyond.
    pub(super) stop: Option<(Place, Stop)>,
    /// Up to where pieces that stop are apart.
    pub(super) reached: Place,
}

impl<'p> Search<'p> {
    pub(super) fn new(couple: &'p Couple<'p>, shapes: [&'p Shape<'p>; 2], until: Place) -> Self {
        Self { couple, shapes, looker: ConvexLooker::default(), stop: None, reached: until }
    }

    /// The first stop, by two pieces that are proven to meet soon after it where there are some.
    pub(super) fn confirmed(&mut self) -> Option<(Place, Stop)> {
        let (until, stop) = self.stop.take()?;
        let Place { row, share } = self.reached.settled();
        let known = match &stop {
            Stop::Stalled => return Some((until, stop)),
            Stop::Met(place, ..) if place.row == row => Some(place.share),
            _ => None,
        };
        if row >= self.couple.path.last() {
            return Some((until, stop));
        }
        let found = soon(share, known, 1.0, |share| self.seen(Place { row, share }));
        Some(found.map_or((until, stop), |(share, how)| {
            let place = Place { row, share };
            (place, Stop::Met(place, how))
        }))
    }

    /// What the bodies are at one place.
    fn seen(&mut self, place: Place) -> Seen<How> {
        let (mut stack, mut count, mut seen) = (vec![[0, 0]], 0, Seen::Apart);
        let mut flush = Flush::new(self, place);
        while let Some(numbers) = stack.pop() {
            count += 1;
            if count > MOST_SEEN {
                return Seen::Open;
            }
            self.looker.forget();
            let pieces = self.pieces(numbers);
            if let Some(flush) = &mut flush {
                flush.take(numbers);
            }
            if pieces.plane(&mut self.looker, place).is_some() {
                continue;
            }
            let Some(which) = which_to_part(self.shapes, numbers) else {
                if let Some(met) = pieces.met(&mut self.looker, place) {
                    return Seen::Met(How::Pieces { pieces: numbers, met });
                }
                seen = Seen::Open;
                continue;
            };
            stack.extend(
                self.shapes[which]
                    .parts(numbers[which])
                    .into_iter()
                    .map(|part| replaced(numbers, which, part)),
            );
        }
        match flush.and_then(|flush| flush.holding()) {
            Some(how) if matches!(seen, Seen::Open) => Seen::Met(how),
            _ => seen,
        }
    }

    /// From a place to another one, or to the first stop.
    pub(super) fn cover(&mut self, pieces: [usize; 2], from: Place, until: Place) -> Cover {
        match which_to_part(self.shapes, pieces) {
            Some(which) => self.by_parts(pieces, which, from, until),
            None => self.directly(pieces, from, until),
        }
    }

    fn pieces(&self, pieces: [usize; 2]) -> Pieces<'p> {
        let [p, q] = self.shapes;
        Pieces { couple: self.couple, pieces: [p.piece(pieces[0]), q.piece(pieces[1])] }
    }

    fn until(&self, until: Place) -> Place {
        self.stop.as_ref().map_or(until, |stop| until.min_of(stop.0))
    }

    fn directly(&mut self, numbers: [usize; 2], from: Place, until: Place) -> Cover {
        // Of another pair of pieces nothing is known yet.
        self.looker.forget();
        let (way, fate) = self.pieces(numbers).follow(&mut self.looker, from, until);
        let reached = way.end().map_or(from, |(place, _)| place);
        let stop = match fate {
            Fate::Apart => None,
            Fate::Met(place, met) => {
                Some((place, Stop::Met(place, How::Pieces { pieces: numbers, met })))
            }
            Fate::Blurred => Some((reached, Stop::Blurred)),
            Fate::Stalled => Some((reached, Stop::Stalled)),
        };
        if let Some((place, stop)) = stop {
            let before = self.stop.take().map(|(_, before)| before);
            let stop = before.filter(|before| !stop.tells_more(before)).unwrap_or(stop);
            self.stop = Some((place, stop));
            self.reached = self.reached.min_of(reached);
        }
        Cover { steps: vec![Step::Planes(way.stretches)] }
    }

    fn by_parts(&mut self, numbers: [usize; 2], which: usize, from: Place, until: Place) -> Cover {
        let pieces = self.pieces(numbers);
        let size = pieces.pieces.iter().map(|piece| extent(piece)).fold(0.0, f64::max);
        let (mut steps, mut here) = (Vec::new(), from);
        loop {
            self.looker.forget();
            let until = self.until(until);
            let way = self.coarsely(&pieces, size, here, until);
            if let Some((place, _)) = way.end() {
                here = place.settled();
                steps.push(Step::Planes(way.stretches));
            }
            if here >= until.settled() && !steps.is_empty() {
                break;
            }
            let next = self.apart_again(&pieces, size, here, until);
            let parts = self.shapes[which].parts(numbers[which]);
            let covers = parts.into_iter().map(|part| {
                let next = self.until(next);
                self.cover(replaced(numbers, which, part), here, next)
            });
            let covers = covers.collect();
            steps.push(Step::Parts { which, until: next, covers });
            here = next.settled();
            if here >= self.until(until).settled() {
                break;
            }
        }
        Cover { steps }
    }

    /// As far as gaps lead, in steps that are not small beside the pieces, or two planes for such a step.
    fn coarsely(&mut self, pieces: &Pieces, size: f64, from: Place, until: Place) -> Way {
        let mut way = Way::default();
        let Some(plane) = pieces.plane(&mut self.looker, from) else { return way };
        way.note(from.row, plane);
        while let Some((place, gap)) = way.end() {
            let here = place.settled();
            if here >= until.settled() {
                break;
            }
            let least = self.couple.within(here, until, SMALL * size);
            if let Some((place, plane)) = pieces.leap(&mut self.looker, (here, gap), least, until) {
                way.leap_to(place.row, plane);
                continue;
            }
            let next = self.couple.within(here, until, size);
            let next = if next.row == here.row { next.share } else { 1.0 };
            let Some([first, last]) = self.two_planes(pieces, here, next) else { break };
            way.note(here.row, first);
            way.note(here.row, last);
        }
        way
    }

    /// Planes at a place and at one in the same row that prove what is between them.
    fn two_planes(&mut self, pieces: &Pieces, from: Place, to: f64) -> Option<[PlaneAt; 2]> {
        if to <= from.share {
            return None;
        }
        let end = Place { row: from.row, share: to };
        let first = pieces.plane(&mut self.looker, from)?;
        let last = pieces.plane(&mut self.looker, end)?;
        let course = pieces.couple.course(pieces.pieces, from.row, [from.share, to]);
        let ends = [from.share, to].map(|share| course.instant(share));
        course.joins([&first, &last], [&ends[0], &ends[1]], &Climbing).then_some([first, last])
    }

    /// A place at which pieces are apart that are not before, in growing steps; or the end.
    fn apart_again(&mut self, pieces: &Pieces, size: f64, from: Place, until: Place) -> Place {
        let mut step = size;
        loop {
            let place = self.couple.within(from, until, step);
            let later = place > from;
            if place >= until || later && pieces.plane(&mut self.looker, place).is_some() {
                return place;
            }
            step *= 2.0;
        }
    }
}

/// Two solids at a place, of which a point that is inside both is guessed where facets lie above each other.
struct Flush<'p> {
    shapes: [&'p Shape<'p>; 2],
    bodies: TwoBodies<'p, Solid>,
    off: f64,
    guesses: Guesses,
}

impl<'p> Flush<'p> {
    /// Of nothing but solids, if no gap is to be kept.
    fn new(search: &Search<'p>, place: Place) -> Option<Self> {
        let (couple, shapes) = (search.couple, search.shapes);
        let solids = [shapes[0].solid()?, shapes[1].solid()?];
        let (bodies, off) = couple.solids(solids, place);
        let guesses = Guesses::default();
        (couple.keep == 0.0).then_some(Self { shapes, bodies, off, guesses })
    }

    /// Takes two pieces into account, if they are facets.
    fn take(&mut self, pieces: [usize; 2]) {
        let [p, q] = [0, 1].map(|k| self.shapes[k].facet(pieces[k]));
        if let (Some((own, f)), Some((other, g))) = (p, q) {
            let TwoBodies { moving_matrix, fixed_matrix, offset, .. } = self.bodies;
            let [f, g] = [f.map(|v| moving_matrix * v), g.map(|v| fixed_matrix * v + offset)];
            self.guesses.take([own, other], [&f, &g], self.off);
        }
    }

    /// A point that is inside both.
    fn holding(&self) -> Option<How> {
        let (facets, point) = self.guesses.holding(&self.bodies, self.off)?;
        let pieces = [0, 1].map(|k| self.shapes[k].piece_of(facets[k]));
        Some(How::Point { pieces, point: point.to_array() })
    }
}

/// The larger piece of two, of those that hold others.
fn which_to_part(shapes: [&Shape; 2], pieces: [usize; 2]) -> Option<usize> {
    let are_own = [0, 1].map(|k| shapes[k].parts(pieces[k]).is_empty());
    node_to_split(are_own, |k| extent(shapes[k].piece(pieces[k])))
}

fn extent(piece: &ConvexPolyhedron) -> f64 {
    let corners = piece.vertices();
    corners.iter().map(|v| v.distance(corners[0])).fold(0.0, f64::max)
}
