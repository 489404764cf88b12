//! Line drawings of bodies as SVG, for the command line and for reports.
//!
//! [`View`] projects the scene; a [`Raster`] of depths tells which surfaces are seen, and which pieces of
//! which [`edges`]; [`Page`] writes areas, lines and text. [`Paint`] has the colours of the moving and of
//! the fixed body.

mod edges;
mod page;
mod paint;
mod raster;
mod view;

pub use edges::{Edge, edges};
pub use page::{Frame, Page, Stroke, escaped};
pub use paint::{FIXED, FIXED_MARK, MOVING, MOVING_MARK, Paint, SHADES, SMOOTH};
pub use raster::Raster;
pub use view::View;
