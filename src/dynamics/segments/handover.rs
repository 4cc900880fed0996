//! What is rare: feet on another segment than their cart's, and carts that go on to the next one.

use super::{Foot, Home, Local, Segments, foot};
use crate::dynamics::lanes::{Lane, Lane3, Mask};
use crate::dynamics::state::PACK;
use pulp::{Simd, WithSimd};

/// Feet that lie beyond their segment's ends or on a spiral, each on the segment of its own.
pub struct Handover<'a, S: Simd, const LEVEL: bool> {
    pub simd: S,
    pub segments: &'a Segments,
    pub home: &'a Home,
    pub part: usize,
    pub point: Lane3<S>,
    /// Where it is to be sought; the others are on their home segment.
    pub outside: Mask<S>,
}

impl<S: Simd, const LEVEL: bool> WithSimd for Handover<'_, S, LEVEL> {
    /// The feet and their arc lengths, m.
    type Output = (Foot<S>, Lane<S>);

    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) -> Self::Output {
        let simd = self.simd;
        let local = Local::load(simd, self.home, self.part);
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
                let point = [points[0][lane], points[1][lane], points[2][lane]];
                let own = self.segments.footing(point, self.home.segment[self.part * S::F64_LANES + lane] as usize);
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

/// Sends the carts whose front joint has left its segment to the one where it is now.
pub struct Rehome<'a, S: Simd, const LEVEL: bool> {
    pub simd: S,
    pub segments: &'a Segments,
    pub home: &'a mut Home,
    pub part: usize,
    pub point: Lane3<S>,
}

impl<S: Simd, const LEVEL: bool> WithSimd for Rehome<'_, S, LEVEL> {
    type Output = ();

    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) {
        let local = Local::load(self.simd, self.home, self.part);
        let foot = foot::<S, LEVEL>(&local, self.point);
        let zero = [0.0; PACK];
        let (mut points, mut sigma) = ([zero; 3], zero);
        self.point.put(&mut points, 0);
        foot.sigma.store(&mut sigma);
        for lane in 0..S::F64_LANES {
            let place = self.part * S::F64_LANES + lane;
            if sigma[lane].abs() > self.home.reach[place] {
                let from = self.home.segment[place] as usize;
                let point = [points[0][lane], points[1][lane], points[2][lane]];
                let own = self.segments.footing(point, from);
                if own.segment != from {
                    self.home.set(place, own.segment, &self.segments.list[own.segment]);
                }
            }
        }
    }
}
