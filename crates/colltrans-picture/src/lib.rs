//! Draws bodies and answers as SVG, for the command line and for reports.
//!
//! [`View`] projects the scene. A [`Raster`] of depths determines the visible surfaces, and the visible parts of the
//! edges that [`edges()`] finds. [`sort_back_to_front`] sorts facets so that they can be painted back to front.
//! [`Page`] writes areas, lines and text. [`Paint`] has the colours of the moving and of the fixed body.

mod edges;
mod grid;
mod order;
mod page;
mod paint;
mod raster;
mod view;

pub use edges::{Edge, edges};
pub use grid::Depth;
pub use order::{Facet, sort_back_to_front};
pub use page::{Frame, Page, Stroke, escape_xml};
pub use paint::{FIXED, FIXED_MARK, MOVING, MOVING_MARK, Paint, SHADES, SMOOTH_COSINE};
pub use raster::Raster;
pub use view::View;
