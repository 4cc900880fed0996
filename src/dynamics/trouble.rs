//! Why a simulation had to stop, in the user's words.

use super::chain::Chain;
use super::forces::Fault;
use super::integrate::TooFine;
use std::fmt;

/// Numerical trouble: when, at which cart, and where on the track.
#[derive(Clone, Debug, PartialEq)]
pub struct Trouble {
    pub kind: TroubleKind,
    /// Since the start, s.
    pub time: f64,
    /// Number of the cart, from 1.
    pub cart: usize,
    /// Arc length of its front joint, m, if that is still a number.
    pub s: Option<f64>,
    /// The step it ran with, and the largest that stiffness and damping of the joints at rest allow, s.
    pub step: f64,
    pub largest_step: f64,
}

/// What went wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TroubleKind {
    /// A front joint is further from the centre line than any clearance allows.
    OffRail,
    /// A joint is stretched or compressed beyond what any chain survives.
    Broken,
    NotANumber,
    /// The adaptive integrator wanted steps this short, s.
    TooFine(f64),
}

impl Trouble {
    /// What ails a chain whose forces report trouble; the first cart that has any.
    pub fn of(chain: &Chain, step: f64) -> Trouble {
        let model = &chain.model;
        let found = (0..model.carts).find_map(|i| chain.forces.troubled(model, i).map(|fault| (i, fault)));
        let (cart, fault) = found.unwrap_or((0, Fault::NotANumber));
        let kind = match fault {
            Fault::OffRail => TroubleKind::OffRail,
            Fault::Broken => TroubleKind::Broken,
            Fault::NotANumber => TroubleKind::NotANumber,
        };
        Trouble::at(chain, cart, kind, step)
    }

    /// An adaptive integrator that gave up: at the cart with the largest acceleration.
    pub fn too_fine(chain: &Chain, too_fine: TooFine) -> Trouble {
        let force = |i: &usize| {
            let loads = &chain.forces.loads[i / super::PACK];
            loads.joint[0][i % super::PACK].abs()
        };
        let worst = (0..chain.model.carts).max_by(|a, b| force(a).total_cmp(&force(b))).unwrap_or(0);
        Trouble::at(chain, worst, TroubleKind::TooFine(too_fine.step), too_fine.step)
    }

    fn at(chain: &Chain, cart: usize, kind: TroubleKind, step: f64) -> Trouble {
        let s = chain.forces.station[cart];
        Trouble {
            kind,
            time: chain.time,
            cart: cart + 1,
            s: s.is_finite().then(|| s.rem_euclid(chain.model.segments.line.length)),
            step,
            largest_step: chain.model.rest_step(),
        }
    }

    /// A way out.
    pub fn advice(&self) -> String {
        if self.step > 1.001 * self.largest_step {
            format!(
                "the step of {:.3} ms is too large for these joints: try --step {:.3}ms, or leave it out",
                self.step * 1e3,
                self.largest_step * 1e3
            )
        } else {
            "look at tension, speed and the radii there; a shorter --step tells whether the model or the step is at \
             fault"
                .to_owned()
        }
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "at {:.4} s, cart {}", self.time, self.cart)?;
        if let Some(s) = self.s {
            write!(f, " at s = {s:.3} m")?;
        }
        match self.kind {
            TroubleKind::OffRail => write!(f, " has left the rail"),
            TroubleKind::Broken => write!(f, " has broken from its follower"),
            TroubleKind::NotANumber => write!(f, " moves beyond all numbers"),
            TroubleKind::TooFine(step) => write!(f, " needs steps below {step:.1e} s"),
        }
    }
}

impl std::error::Error for Trouble {}
