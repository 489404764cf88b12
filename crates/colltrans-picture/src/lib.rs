//! Draws bodies and answers as SVG, for the command line and for reports.
//!
//! [`View`] projects the scene. A [`Raster`] of depths determines the visible surfaces, and the visible parts of the
//! edges that [`edges()`] finds. [`sort_back_to_front`] sorts facets so that they can be painted back to front.
//! [`Page`] writes areas, lines and text. [`Paint`] has the colours of a body; the module `style` has those of both
//! bodies, and the font, the other colours and the widths of lines of all pictures.

mod edges;
mod grid;
mod order;
mod page;
mod raster;
mod style;
mod view;

pub use edges::{Edge, edges};
pub use grid::Depth;
pub use order::{Facet, sort_back_to_front};
pub use page::{Frame, Page, Stroke, escape_xml};
pub use raster::Raster;
pub use style::{
    ARROW_WIDTH, CONTACT, EDGE_WIDTH, FINE_WIDTH, FIXED, FIXED_MARK, FONT, GUIDE_WIDTH, HAIR_WIDTH,
    INK, MARK_WIDTH, MOVING, MOVING_MARK, OUTLINE_WIDTH, PLANE, Paint, QUIET, SHADES,
    SMOOTH_COSINE,
};
pub use view::View;

/// Compiles and runs the example of the README as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
