//! Which vector instructions evaluate the forces: chosen when the program runs, and all with the same bits.

use pulp::{Scalar, Simd, WithSimd};
use std::fmt;

/// Vector instructions.
#[derive(Clone, Copy, Debug)]
pub struct Width(Kind);

#[derive(Clone, Copy, Debug)]
enum Kind {
    Scalar,
    /// One number at a time, too, with the processor's fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    ScalarFma(pulp::x86::V3),
    #[cfg(target_arch = "x86_64")]
    Avx2(pulp::x86::V3),
    #[cfg(target_arch = "x86_64")]
    Avx512(pulp::x86::V4),
    #[cfg(target_arch = "aarch64")]
    Neon(pulp::aarch64::Neon),
}

impl Width {
    /// The widest that this processor has.
    pub fn widest() -> Self {
        Width::all().pop().unwrap_or(Width(Kind::Scalar))
    }

    /// Every one that this processor has, from one number at a time to the widest.
    pub fn all() -> Vec<Self> {
        let mut all = vec![Width(Kind::Scalar)];
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(v) = pulp::x86::V3::try_new() {
                all = vec![Width(Kind::ScalarFma(v)), Width(Kind::Avx2(v))];
            }
            all.extend(pulp::x86::V4::try_new().map(|v| Width(Kind::Avx512(v))));
        }
        #[cfg(target_arch = "aarch64")]
        all.extend(pulp::aarch64::Neon::try_new().map(|v| Width(Kind::Neon(v))));
        all
    }

    /// `scalar`, `avx2`, `avx512` or `neon`.
    pub fn name(self) -> &'static str {
        match self.0 {
            Kind::Scalar => "scalar",
            #[cfg(target_arch = "x86_64")]
            Kind::ScalarFma(_) => "scalar",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(_) => "avx512",
            #[cfg(target_arch = "aarch64")]
            Kind::Neon(_) => "neon",
        }
    }

    /// Runs an operation with these instructions.
    pub fn run<Op: WithSimd>(self, operation: Op) -> Op::Output {
        match self.0 {
            Kind::Scalar => Simd::vectorize(Scalar::new(), operation),
            #[cfg(target_arch = "x86_64")]
            Kind::ScalarFma(simd) => Simd::vectorize(simd, OneByOne(operation)),
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2(simd) => Simd::vectorize(simd, operation),
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512(simd) => Simd::vectorize(simd, operation),
            #[cfg(target_arch = "aarch64")]
            Kind::Neon(simd) => Simd::vectorize(simd, operation),
        }
    }
}

/// An operation on one number at a time, compiled for whatever instructions it is called with.
struct OneByOne<Op>(Op);

impl<Op: WithSimd> WithSimd for OneByOne<Op> {
    type Output = Op::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Op::Output {
        self.0.with_simd(Scalar::new())
    }
}

impl fmt::Display for Width {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}
