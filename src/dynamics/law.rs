//! Damping of contacts: from a coefficient of restitution to the factor χ(e) of F = K δⁿ (1 + χ δ̇ / v₀) (thesis §2.3;
//! design: chain model, contact law).
//!
//! At equal K, n and v₀ the laws are reparametrisations of each other: with e free, their best fits coincide.

use crate::base::trig;
use crate::chain_input::ContactLaw;

/// χ(e), for e in (0, 1]; 0 for Kelvin-Voigt, which damps through [`viscosity`].
pub fn factor(law: ContactLaw, e: f64) -> f64 {
    match law {
        ContactLaw::HuntCrossley => 1.5 * (1.0 - e),
        ContactLaw::HerbertMcwhannell => 6.0 * (1.0 - e) / ((2.0 * e - 1.0) * (2.0 * e - 1.0) + 3.0),
        ContactLaw::LankaraniNikravesh => 0.75 * (1.0 - e * e),
        ContactLaw::LeeWang => 0.75 * (1.0 - e),
        ContactLaw::Gonthier => exact(e),
        ContactLaw::Flores => 8.0 * (1.0 - e) / (5.0 * e),
        ContactLaw::HuGuo => 1.5 * (1.0 - e) / e,
        ContactLaw::KelvinVoigt => 0.0,
    }
}

/// c of Kelvin-Voigt's linear damper, N s/m: 2ζ√(K_t m) with ζ = −ln e/√(π² + ln² e) and K_t = n K δ_sⁿ⁻¹, the
/// stiffness at the static load; 0 for the other laws.
pub fn viscosity(law: ContactLaw, e: f64, stiffness: f64, exponent: f64, load: f64, mass: f64) -> f64 {
    if law != ContactLaw::KelvinVoigt {
        return 0.0;
    }
    let ln = trig::ln(e);
    let ratio = -ln / (trig::PI * trig::PI + ln * ln).sqrt();
    2.0 * ratio * (tangent(stiffness, exponent, load) * mass).sqrt()
}

/// Stiffness of F = K δⁿ about a load, N/m: n K δⁿ⁻¹.
pub fn tangent(stiffness: f64, exponent: f64, load: f64) -> f64 {
    let indentation = trig::pow(load.abs() / stiffness, 1.0 / exponent);
    exponent * stiffness * trig::pow(indentation, exponent - 1.0)
}

/// The restitution that a free impact achieves under F = K δⁿ (1 + d δ̇/v₀): the e of d(1+e) = ln((1+d)/(1−e d)),
/// whatever K and n (Gonthier 2004).
pub fn achieved_restitution(d: f64) -> f64 {
    if d <= 0.0 {
        return 1.0;
    }
    // The left side less the right one is 0 at e = −1 (no root of interest), grows from e = 0 and falls to −∞ where e d
    // = 1.
    let residual = |e: f64| d * (1.0 + e) - trig::ln((1.0 + d) / (1.0 - e * d));
    bisect(residual, 0.0, (1.0 / d).min(1.0))
}

/// The d of d(1+e) = ln((1+d)/(1−e d)), by bisection below its pole at 1/e.
fn exact(e: f64) -> f64 {
    if e >= 1.0 {
        return 0.0;
    }
    let residual = |d: f64| d * (1.0 + e) - trig::ln((1.0 + d) / (1.0 - e * d));
    // Positive just above d = 0 while e < 1, negative near the pole.
    bisect(residual, 1e-12, (1.0 / e).min(1e12))
}

/// The sign change of a function that is positive at `low` and negative at `high`.
fn bisect(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if function(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// A contact's constants in one law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damped {
    /// K, N/mⁿ
    pub stiffness: f64,
    /// n
    pub exponent: f64,
    /// χ
    pub factor: f64,
    /// c, N s/m
    pub viscosity: f64,
}

impl Damped {
    /// K δⁿ, the force at rest under an indentation in m, N.
    pub fn at_rest(&self, indentation: f64) -> f64 {
        self.stiffness * trig::pow(indentation, self.exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAWS: [ContactLaw; 7] = [
        ContactLaw::HuntCrossley,
        ContactLaw::HerbertMcwhannell,
        ContactLaw::LankaraniNikravesh,
        ContactLaw::LeeWang,
        ContactLaw::Gonthier,
        ContactLaw::Flores,
        ContactLaw::HuGuo,
    ];

    /// A free mass meets a wall at speed 1; integrated by fine Runge-Kutta steps of order 4.
    fn impact(stiffness: f64, exponent: f64, d: f64) -> f64 {
        let rate = |x: f64, v: f64| {
            let force = stiffness * trig::pow(x.max(0.0), exponent) * (1.0 + d * v);
            (v, -force)
        };
        let (mut x, mut v, h) = (0.0, 1.0, 1e-5 / stiffness.sqrt() * 30.0);
        loop {
            let (a1, b1) = rate(x, v);
            let (a2, b2) = rate(x + 0.5 * h * a1, v + 0.5 * h * b1);
            let (a3, b3) = rate(x + 0.5 * h * a2, v + 0.5 * h * b2);
            let (a4, b4) = rate(x + h * a3, v + h * b3);
            x += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
            v += h / 6.0 * (b1 + 2.0 * b2 + 2.0 * b3 + b4);
            if x <= 0.0 {
                return -v;
            }
        }
    }

    #[test]
    fn a_free_impact_returns_the_closed_form_whatever_the_exponent() {
        for law in LAWS {
            for e in [0.45, 0.6, 0.9] {
                let d = factor(law, e);
                let expected = achieved_restitution(d);
                for exponent in [1.0, 1.5, 2.0] {
                    let got = impact(1e3, exponent, d);
                    assert!((got - expected).abs() < 1e-4, "{law:?} {e} {exponent}: {got} {expected}");
                }
            }
        }
    }

    #[test]
    fn the_exact_law_achieves_what_it_is_asked() {
        for e in [0.05, 0.3, 0.6, 0.95] {
            assert!((achieved_restitution(factor(ContactLaw::Gonthier, e)) - e).abs() < 1e-9, "{e}");
        }
        // Design, chain model: Herbert and McWhannell at 0.6 achieve 0.651.
        assert!((achieved_restitution(factor(ContactLaw::HerbertMcwhannell, 0.6)) - 0.651).abs() < 5e-4);
    }

    /// A linear spring and damper in closed form: e = exp(−πζ/√(1−ζ²)), the rebound of a full half wave.
    #[test]
    fn kelvin_voigt_damps_to_its_restitution() {
        let (k, m, e): (f64, f64, f64) = (4e6, 41.0, 0.6);
        let c = viscosity(ContactLaw::KelvinVoigt, e, k, 1.0, 500.0, m);
        let ratio = c / (2.0 * (k * m).sqrt());
        let rebound = libm::exp(-trig::PI * ratio / (1.0 - ratio * ratio).sqrt());
        assert!((rebound - e).abs() < 1e-12);
    }

    #[test]
    fn all_laws_are_elastic_at_one() {
        for law in LAWS {
            assert_eq!(factor(law, 1.0), 0.0, "{law:?}");
        }
    }
}
