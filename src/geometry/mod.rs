//! Plane geometry of a track: vertices with fillet radii become lines and true arcs (thesis §3.2).

mod centre_line;
pub mod clearance;
mod contact;
mod crossing;
mod fillet;
mod point;
mod polygon;
pub mod proximity;
mod side;

pub use centre_line::{CentreLine, Form, Frame, Nearest, Stretch};
pub use contact::{contact_area, outside_area};
pub use crossing::{band_overlaps, piece_distance, point_piece, self_crossings};
pub use fillet::{Corner, Fillet, Piece, PieceKind, Track};
pub use point::Point;
pub(crate) use polygon::segments_meet;
pub use polygon::{NotSimple, Polygon, bounds, distance_to_segment};
pub use side::{Curve, Hand, Outline};
