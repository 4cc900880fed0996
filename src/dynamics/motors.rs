//! Linear motors: which part of each cart's plate lies over them (design: chain model, linear motors).

use super::model::Model;

/// Fills `share` with the length of each cart's plate over motors, in motor lengths. A plate reaches from the cart's
/// front joint to its follower's; `cursor` remembers which cart each motor's begin was under.
pub fn share(model: &Model, station: &[f64], share: &mut [f64], cursor: &mut [usize]) {
    let (carts, lap, length) = (model.carts, model.segments.line.length, model.motors.length);
    share.fill(0.0);
    // From a motor's begin ahead to a cart's front joint, m in [0, S).
    let ahead = |cart: usize, begin: f64| {
        let d = station[cart] - begin;
        if d < 0.0 {
            d + lap
        } else if d >= lap {
            d - lap
        } else {
            d
        }
    };
    for (motor, (begin, cursor)) in model.motors.s.iter().zip(cursor).enumerate() {
        // The cart whose front joint is the next ahead of the motor's begin: its follower has almost a lap to go.
        let mut cart = *cursor % carts;
        for _ in 0..carts {
            let follower = if cart + 1 == carts { 0 } else { cart + 1 };
            if ahead(follower, *begin) >= ahead(cart, *begin) {
                break;
            }
            cart = follower;
        }
        *cursor = cart;
        let mut covered = 0.0;
        for _ in 0..carts {
            let reach = ahead(cart, *begin).min(length);
            let own = (reach - covered) / length;
            // Deviations cost nothing where there are none.
            share[cart] += if model.even { own } else { own * model.deviations.factor(motor, ahead(cart, *begin)) };
            covered = reach;
            if covered >= length {
                break;
            }
            cart = if cart == 0 { carts - 1 } else { cart - 1 };
        }
    }
}
