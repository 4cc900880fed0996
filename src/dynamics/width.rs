//! Which vector instructions evaluate the forces: chosen when the program runs, and all with the same bits.

use pulp::{Scalar, Simd, WithSimd};
use std::fmt;

/// The environment variable that chooses one by its name.
const VARIABLE: &str = "LSS_SIMD";
/// All that this program knows, on whatever processor.
const NAMES: [&str; 4] = ["scalar", "avx2", "avx512", "neon"];

/// Vector instructions.
#[derive(Clone, Copy, Debug)]
pub struct Width(WidthKind);

#[derive(Clone, Copy, Debug)]
enum WidthKind {
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

/// A name that is no width of this processor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoWidth(String);

impl Width {
    /// The one of this name.
    ///
    /// # Errors
    ///
    /// [`NoWidth`], where there is no such width or this processor does not have it.
    pub fn named(name: &str) -> Result<Self, NoWidth> {
        Width::all().into_iter().find(|width| width.name() == name).ok_or_else(|| NoWidth(name.to_owned()))
    }

    /// The one that `LSS_SIMD` names, the widest when it is not set.
    ///
    /// # Errors
    ///
    /// As [`Width::named`].
    pub fn asked() -> Result<Self, NoWidth> {
        match std::env::var_os(VARIABLE).filter(|name| !name.is_empty()) {
            Some(name) => Width::named(&name.to_string_lossy()),
            None => Ok(Width::widest()),
        }
    }

    /// The one to simulate with: [`Width::asked`], which the command line has refused before where it fails. Results do
    /// not depend on it.
    pub fn used() -> Self {
        Width::asked().unwrap_or_else(|_| Width::widest())
    }

    /// The widest that this processor has.
    pub fn widest() -> Self {
        Width::all().pop().unwrap_or(Width(WidthKind::Scalar))
    }

    /// Every one that this processor has, from one number at a time to the widest.
    pub fn all() -> Vec<Self> {
        let mut all = vec![Width(WidthKind::Scalar)];
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(v) = pulp::x86::V3::try_new() {
                all = vec![Width(WidthKind::ScalarFma(v)), Width(WidthKind::Avx2(v))];
            }
            all.extend(pulp::x86::V4::try_new().map(|v| Width(WidthKind::Avx512(v))));
        }
        #[cfg(target_arch = "aarch64")]
        all.extend(pulp::aarch64::Neon::try_new().map(|v| Width(WidthKind::Neon(v))));
        all
    }

    /// `scalar`, `avx2`, `avx512` or `neon`.
    pub fn name(self) -> &'static str {
        match self.0 {
            WidthKind::Scalar => "scalar",
            #[cfg(target_arch = "x86_64")]
            WidthKind::ScalarFma(_) => "scalar",
            #[cfg(target_arch = "x86_64")]
            WidthKind::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            WidthKind::Avx512(_) => "avx512",
            #[cfg(target_arch = "aarch64")]
            WidthKind::Neon(_) => "neon",
        }
    }

    /// Runs an operation with these instructions.
    pub fn run<Op: WithSimd>(self, operation: Op) -> Op::Output {
        match self.0 {
            WidthKind::Scalar => Simd::vectorize(Scalar::new(), operation),
            #[cfg(target_arch = "x86_64")]
            WidthKind::ScalarFma(simd) => Simd::vectorize(simd, OneByOne(operation)),
            #[cfg(target_arch = "x86_64")]
            WidthKind::Avx2(simd) => Simd::vectorize(simd, operation),
            #[cfg(target_arch = "x86_64")]
            WidthKind::Avx512(simd) => Simd::vectorize(simd, operation),
            #[cfg(target_arch = "aarch64")]
            WidthKind::Neon(simd) => Simd::vectorize(simd, operation),
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

impl fmt::Display for NoWidth {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let NoWidth(name) = self;
        // A name from outside may hold what moves a terminal's cursor.
        match NAMES.contains(&name.as_str()) {
            true => write!(f, "{VARIABLE}={name}: this processor does not have it"),
            false => write!(f, "{VARIABLE}={}: there is no such vector width", name.escape_debug()),
        }
    }
}

impl std::error::Error for NoWidth {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_width_is_found_by_its_name() {
        for width in Width::all() {
            assert_eq!(Width::named(width.name()).unwrap().name(), width.name());
        }
    }

    #[test]
    fn what_is_none_and_what_this_processor_lacks_are_told_apart() {
        assert_eq!(Width::named("AVX9\n").unwrap_err().to_string(), "LSS_SIMD=AVX9\\n: there is no such vector width");
        let all: Vec<&str> = Width::all().into_iter().map(Width::name).collect();
        for name in NAMES.into_iter().filter(|name| !all.contains(name)) {
            let told = Width::named(name).unwrap_err().to_string();
            assert_eq!(told, format!("LSS_SIMD={name}: this processor does not have it"));
        }
    }
}
