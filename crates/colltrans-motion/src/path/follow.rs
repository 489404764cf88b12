//! Two convex pieces along a path: planes between them, from a place to another one or to where they meet.
//!
//! Far from each other they are looked at from time to time, over many rows; near each other the search for two
//! bodies that move evenly goes from row to row.

use super::super::look::{ConvexLooker, Looker};
use super::super::proof::{Met, PlaneAt};
use super::super::search::{Advanced, End, advance};
use super::couple::Couple;
use super::mechanism::Place;
use super::proof::Stretch;
use colltrans_convex::body::ConvexPolyhedron;

/// The next look is where both may have moved by so much of the gap; and, if that is too far, by so much.
const FAR: [f64; 2] = [1.5, 0.9];

/// What has become of two pieces.
#[derive(Debug)]
pub(super) enum Fate {
    /// They are apart up to the end.
    Apart,
    /// They meet.
    Met(Place, Met),
    /// They come nearer than rounding can tell.
    Blurred,
    /// Too many steps.
    Stalled,
}

/// Planes up to a place.
#[derive(Debug, Default)]
pub(super) struct Way {
    pub(super) stretches: Vec<Stretch>,
}

impl Way {
    pub(super) fn note(&mut self, row: usize, plane: PlaneAt) {
        match self.stretches.last_mut() {
            Some(last) if last.row == row => {
                if last.planes.last() != Some(&plane) {
                    last.planes.push(plane);
                }
            }
            _ => self.stretches.push(Stretch { row, planes: vec![plane] }),
        }
    }

    /// A plane to which gaps alone lead.
    pub(super) fn leap_to(&mut self, row: usize, plane: PlaneAt) {
        self.stretches.push(Stretch { row, planes: vec![plane] });
    }

    /// Where the last plane is, and its gap.
    pub(super) fn end(&self) -> Option<(Place, f64)> {
        let last = self.stretches.last()?;
        let plane = last.planes.last()?;
        Some((Place { row: last.row, share: plane.time }, plane.gap))
    }
}

/// Two pieces of two bodies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pieces<'p> {
    pub(super) couple: &'p Couple<'p>,
    pub(super) pieces: [&'p ConvexPolyhedron; 2],
}

impl Pieces<'_> {
    /// A plane at a place.
    pub(super) fn plane(&self, looker: &mut ConvexLooker, place: Place) -> Option<PlaneAt> {
        let course = self.couple.course(self.pieces, place.row, [place.share; 2]);
        let look = looker.look(&course, place.share);
        let (time, normal, gap) = (place.share, look.normal, look.gap);
        look.is_apart().then_some(PlaneAt { time, normal, gap, alone: false })
    }

    /// What proves that they meet at a place.
    pub(super) fn met(&self, looker: &mut ConvexLooker, place: Place) -> Option<Met> {
        let course = self.couple.course(self.pieces, place.row, [place.share; 2]);
        looker.met(&course, place.share)
    }

    /// From a place with a plane to one as far as gaps alone prove, if that is not before `least`: the plane there.
    pub(super) fn leap(
        &self,
        looker: &mut ConvexLooker,
        (from, gap): (Place, f64),
        least: Place,
        until: Place,
    ) -> Option<(Place, PlaneAt)> {
        let mut tried = None;
        for share in FAR {
            let place = self.couple.within(from, until, share * gap);
            if place < least || place <= from || tried == Some(place) {
                break;
            }
            tried = Some(place);
            if let Some(plane) = self.plane(looker, place)
                && self.couple.is_near([from, place], [gap, plane.gap])
            {
                return Some((place, plane));
            }
        }
        None
    }

    /// From a place to another one, or to where they meet.
    pub(super) fn follow(
        &self,
        looker: &mut ConvexLooker,
        from: Place,
        until: Place,
    ) -> (Way, Fate) {
        let mut way = Way::default();
        if let Some(plane) = self.plane(looker, from) {
            way.note(from.row, plane);
        }
        loop {
            let here = match way.end() {
                Some((place, _)) if place.settled() >= until.settled() => {
                    return (way, Fate::Apart);
                }
                Some((place, gap)) => (place.settled(), gap),
                None => (from, 0.0),
            };
            // Near each other the search within a row leads farther.
            let next = Place::at_row(here.0.row + 1).min_of(until);
            if here.1 > 0.0
                && let Some((place, plane)) = self.leap(looker, here, next, until)
            {
                way.leap_to(place.row, plane);
                continue;
            }
            match self.step(looker, here.0, until, &mut way) {
                Fate::Apart => {}
                other => return (way, other),
            }
        }
    }

    /// To the end of a row, or to where they meet.
    fn step(&self, looker: &mut ConvexLooker, from: Place, until: Place, way: &mut Way) -> Fate {
        let row = from.row;
        let to = if until.row == row { until.share } else { 1.0 };
        let course = self.couple.course(self.pieces, row, [from.share, to]);
        let Advanced { planes, end } = advance(&course, looker);
        for plane in &planes {
            way.note(row, *plane);
        }
        match end {
            End::Free => Fate::Apart,
            End::Met(share, met) => Fate::Met(Place { row, share }, met),
            End::Stalled => Fate::Stalled,
            // What is not told apart at the end of a row may meet at the beginning of the next one.
            End::Blurred if to == 1.0 && row + 1 < self.couple.path.last() && until.row > row => {
                let next = self.couple.course(self.pieces, row + 1, [0.0, 1.0]);
                match advance(&next, looker) {
                    Advanced { planes, end: End::Met(share, met) } if planes.is_empty() => {
                        Fate::Met(Place { row: row + 1, share }, met)
                    }
                    _ => Fate::Blurred,
                }
            }
            End::Blurred => Fate::Blurred,
        }
    }
}
