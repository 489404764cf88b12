//! Two bodies along a path, by their pieces.
//!
//! Pieces that hold others, boxes, are only kept apart where that is cheap: by gaps, or from row to row by two
//! planes. Where they are not, for some rows, the larger one is taken apart, and its parts are followed for these
//! rows, and so on down to the bodies' own pieces.
//!
//! Invariant. Up to where a cover ends, no two points of the pieces meet; it ends where it is to, or where two of
//! the bodies' own pieces meet, or may.

use super::super::answer::{Met, PlaneAt};
use super::super::bend::Climbing;
use super::super::course::Course;
use super::super::look::ConvexLooker;
use super::answer::{Cover, Step};
use super::couple::Couple;
use super::follow::{Fate, Pieces, Way};
use super::mechanism::Place;
use super::shape::Shape;
use crate::body::ConvexPolyhedron;

/// What ends the search.
#[derive(Debug)]
pub(super) enum Stop {
    /// These pieces meet at a place.
    Met(Place, [usize; 2], Met),
    /// They may.
    Blurred,
    /// Too many steps.
    Stalled,
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
            Fate::Met(place, met) => Some((place, Stop::Met(place, numbers, met))),
            Fate::Blurred => Some((reached, Stop::Blurred)),
            Fate::Stalled => Some((reached, Stop::Stalled)),
        };
        if stop.is_some() {
            (self.stop, self.reached) = (stop, self.reached.min_of(reached));
        }
        Cover { steps: vec![Step::Planes(way.stretches)] }
    }

    fn by_parts(&mut self, numbers: [usize; 2], which: usize, from: Place, until: Place) -> Cover {
        let pieces = self.pieces(numbers);
        let (mut steps, mut here) = (Vec::new(), from);
        loop {
            self.looker.forget();
            let until = self.until(until);
            let way = self.coarsely(&pieces, here, until);
            if let Some((place, _)) = way.end() {
                here = place.settled();
                steps.push(Step::Planes(way.stretches));
            }
            if here >= until.settled() && !steps.is_empty() {
                break;
            }
            let next = self.apart_again(&pieces, here, until);
            let parts = self.shapes[which].parts(numbers[which]);
            let covers = parts.into_iter().map(|part| {
                let mut below = numbers;
                below[which] = part;
                let next = self.until(next);
                self.cover(below, here, next)
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

    /// As far as gaps lead, or two planes from row to row.
    fn coarsely(&mut self, pieces: &Pieces, from: Place, until: Place) -> Way {
        let mut way = Way::default();
        let Some(plane) = pieces.plane(&mut self.looker, from) else { return way };
        way.note(from.row, plane);
        while let Some((place, gap)) = way.end() {
            let here = place.settled();
            if here >= until.settled() {
                break;
            }
            if let Some((place, plane)) = pieces.leap(&mut self.looker, (here, gap), until) {
                way.leap_to(place.row, plane);
                continue;
            }
            let Some([first, last]) = self.across_row(pieces, here, until) else { break };
            way.note(here.row, first);
            way.note(here.row, last);
        }
        way
    }

    /// Planes at a place and at the end of its row that prove what is between them.
    fn across_row(&mut self, pieces: &Pieces, from: Place, until: Place) -> Option<[PlaneAt; 2]> {
        let to = if until.row == from.row { until.share } else { 1.0 };
        let end = Place { row: from.row, share: to };
        let planes = [from, end].map(|place| pieces.plane(&mut self.looker, place));
        let [Some(first), Some(last)] = planes else { return None };
        let course = pieces.couple.course(pieces.pieces, from.row, [from.share, to]);
        let ends = [from.share, to].map(|share| course.instant(share));
        course.joins([&first, &last], [&ends[0], &ends[1]], &Climbing).then_some([first, last])
    }

    /// The next row, or one of the next ones in growing steps, at which pieces are apart that are not before; or the
    /// end.
    fn apart_again(&mut self, pieces: &Pieces, from: Place, until: Place) -> Place {
        let mut rows = 1;
        loop {
            let place = Place::at_row(from.row + rows);
            if place >= until {
                return until;
            }
            if pieces.plane(&mut self.looker, place).is_some() {
                return place;
            }
            rows *= 2;
        }
    }
}

/// The larger piece of two, of those that hold others.
fn which_to_part(shapes: [&Shape; 2], pieces: [usize; 2]) -> Option<usize> {
    let holds = |which: usize| !shapes[which].parts(pieces[which]).is_empty();
    match [holds(0), holds(1)] {
        [false, false] => None,
        [true, false] => Some(0),
        [false, true] => Some(1),
        [true, true] => {
            let size = |which: usize| extent(shapes[which].piece(pieces[which]));
            Some(usize::from(size(1) > size(0)))
        }
    }
}

fn extent(piece: &ConvexPolyhedron) -> f64 {
    let corners = piece.vertices();
    corners.iter().map(|v| v.distance_squared(corners[0])).fold(0.0, f64::max)
}
