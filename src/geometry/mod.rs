//! Plane geometry of a track: vertices with fillet radii become lines and true arcs (thesis §3.2).

pub mod clearance;
mod fillet;
mod point;
mod polygon;
pub mod trig;

pub use fillet::{Corner, Fillet, Piece, PieceKind, Track};
pub use point::Point;
pub use polygon::{Polygon, bounds};
