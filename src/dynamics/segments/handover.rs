//! What is rare: points that have left their segment, and points on a spiral, which takes iteration.

use super::{Foot, Home, Local, Segments, foot};
use crate::dynamics::lanes::{Lane, Lane3, Mask};
use crate::dynamics::state::PACK;
use pulp::{Simd, WithSimd};

/// The feet of points that each home knows the segment of, and their arc lengths, m.
#[inline(always)]
pub fn feet<S: Simd, const LEVEL: bool>(
    simd: S,
    segments: &Segments,
    home: &mut Home,
    part: usize,
    point: Lane3<S>,
) -> (Foot<S>, Lane<S>) {
    let local = Local::load(simd, home, part, segments.sharp);
    let here = foot::<S, LEVEL>(&local, point);
    let outside = here.outside(&local);
    let (mut tangent, mut normal, mut up) = (here.tangent, here.normal, here.up);
    let (mut y, mut z, mut station) = (here.y, here.z, here.station(&local));
    // Number by number, as what a call returns whole would be kept in memory in every case.
    if outside.any() {
        let (there, s) = simd.vectorize(Handover::<S, LEVEL> { simd, segments, home, part, point, outside });
        (tangent, normal, up) = (there.tangent, there.normal, there.up);
        (y, z, station) = (there.y, there.z, s);
    }
    (Foot { tangent, normal, up, y, z, ..here }, station)
}

/// Sends points that lie beyond their segment's ends to the segment where they are now, and takes their feet there.
pub struct Handover<'a, S: Simd, const LEVEL: bool> {
    pub simd: S,
    pub segments: &'a Segments,
    pub home: &'a mut Home,
    pub part: usize,
    pub point: Lane3<S>,
    /// Which points; the others stay on their segment.
    pub outside: Mask<S>,
}

impl<S: Simd, const LEVEL: bool> WithSimd for Handover<'_, S, LEVEL> {
    /// The feet and their arc lengths, m.
    type Output = (Foot<S>, Lane<S>);

    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) -> Self::Output {
        let simd = self.simd;
        let local = Local::load(simd, self.home, self.part, self.segments.sharp);
        let foot = foot::<S, LEVEL>(&local, self.point);
        let zero = [0.0; PACK];
        let (mut points, mut tangent, mut normal, mut up) = ([zero; 3], [zero; 3], [zero; 3], [zero; 3]);
        let (mut y, mut z, mut s) = (zero, zero, zero);
        self.point.put(&mut points, 0);
        foot.tangent.put(&mut tangent, 0);
        foot.normal.put(&mut normal, 0);
        foot.up.put(&mut up, 0);
        foot.y.store(&mut y);
        foot.z.store(&mut z);
        foot.station(&local).store(&mut s);
        let mut outside = zero;
        Lane::splat(simd, 1.0).select(self.outside, Lane::splat(simd, 0.0)).put(&mut outside, 0);
        for lane in 0..S::F64_LANES {
            if outside[lane] != 0.0 {
                let place = self.part * S::F64_LANES + lane;
                let from = self.home.segment[place] as usize;
                let own = self.segments.footing([points[0][lane], points[1][lane], points[2][lane]], from);
                if own.segment != from {
                    self.home.set(place, own.segment, &self.segments.list[own.segment]);
                }
                for k in 0..3 {
                    tangent[k][lane] = own.tangent[k];
                    normal[k][lane] = own.normal[k];
                    up[k][lane] = own.up[k];
                }
                (y[lane], z[lane], s[lane]) = (own.y, own.z, own.s);
            }
        }
        let handed_over = Foot {
            tangent: Lane3::of(simd, &tangent, 0),
            normal: Lane3::of(simd, &normal, 0),
            up: Lane3::of(simd, &up, 0),
            y: Lane::of(simd, &y, 0),
            z: Lane::of(simd, &z, 0),
            ..foot
        };
        (handed_over, Lane::of(simd, &s, 0))
    }
}
