//! The catalogue, and what carts and drive are made of.

use super::{Printer, degrees, list, metres, number, quoted, range, unit};
use crate::model::*;

impl Printer {
    pub(super) fn catalog(&mut self, catalog: &Catalog) {
        self.block(format!("catalog {}", catalog.name), |out| {
            out.field("take_up", metres(catalog.take_up));
            out.field("headroom", metres(catalog.headroom));
            let straight = &catalog.straight;
            out.block("straight", |out| {
                out.field("article", quoted(&straight.article));
                out.field("stock", list(&straight.stock));
                if let Some(cut) = straight.cut {
                    out.field("cut", range(cut, metres));
                }
                out.field("cut_price", unit(straight.cut_price, "EUR"));
                out.field("shortest", metres(straight.shortest));
                out.rates(straight.price, straight.mass);
            });
            let curve = &catalog.curve;
            out.block("curve", |out| {
                out.field("article", quoted(&curve.article));
                out.field("radii", list(&curve.radii));
                out.field("angle_step", degrees(curve.angle_step));
                out.field("largest", degrees(curve.largest));
                out.field("turns", range(curve.turns, degrees));
                out.rates(curve.price, curve.mass);
            });
            if let Some(stock) = &catalog.vertical {
                out.block("vertical", |out| {
                    out.slopes(&stock.article, &stock.radii, stock.angle_step, stock.steepest);
                    out.rates(stock.price, stock.mass);
                });
            }
            if let Some(stock) = &catalog.spiral {
                out.block("spiral", |out| {
                    out.slopes(&stock.article, &stock.radii, stock.angle_step, stock.steepest);
                    out.rates(stock.price, stock.mass);
                });
            }
            if catalog.support != Article::default() {
                out.block("support", |out| out.article(&catalog.support));
            }
        });
        self.text.push('\n');
    }

    pub(super) fn article(&mut self, article: &Article) {
        if let Some(number) = &article.number {
            self.field("article", quoted(number));
        }
        if let Some(price) = article.price {
            self.field("price", unit(price, "EUR"));
        }
        if let Some(mass) = article.mass {
            self.field("mass", unit(mass, "kg"));
        }
    }

    fn slopes(&mut self, article: &str, radii: &[f64], step: f64, steepest: f64) {
        self.field("article", quoted(article));
        self.field("radii", list(radii));
        self.field("angle_step", degrees(step));
        self.field("steepest", number(steepest));
    }

    fn rates(&mut self, price: Rate, mass: Rate) {
        self.field("piece_price", unit(price.per_piece, "EUR"));
        self.field("metre_price", unit(price.per_metre, "EUR/m"));
        self.field("piece_mass", unit(mass.per_piece, "kg"));
        self.field("metre_mass", unit(mass.per_metre, "kg/m"));
    }

    pub(super) fn cart(&mut self, cart: &Cart, name: &str) {
        self.wheel(&cart.steering, &cart.steering.name);
        // One declaration may serve both with different arguments.
        let running = if cart.running.name == cart.steering.name && !same_wheel(&cart.running, &cart.steering) {
            format!("{}_running", cart.running.name)
        } else {
            cart.running.name.clone()
        };
        if running != cart.steering.name {
            self.wheel(&cart.running, &running);
        }
        self.joint(&cart.joint);
        self.block(format!("cart {name}"), |out| {
            out.field("length", metres(cart.length));
            if !cart.lengths.is_empty() {
                out.field("lengths", list(&cart.lengths));
            }
            out.field("mass", unit(cart.mass, "kg"));
            out.field("inertia", format!("({})", cart.inertia.map(|i| unit(i, "kg*m^2")).join(", ")));
            out.field("centre_of_mass", format!("({})", cart.centre_of_mass.map(metres).join(", ")));
            out.field("steering", &cart.steering.name);
            out.field("running", &running);
            out.field("joint", &cart.joint.name);
            out.field("motor_height", metres(cart.motor_height));
            if let Some(drag) = cart.drag {
                out.field("drag", unit(drag, "kg/m"));
            }
            if let Some(tension) = cart.tension {
                out.field("tension", unit(tension, "N"));
            }
            out.article(&cart.article);
        });
        self.text.push('\n');
    }

    fn joint(&mut self, joint: &Joint) {
        if !self.printed.insert(format!("joint {}", joint.name)) {
            return;
        }
        self.block(format!("joint {}", joint.name), |out| {
            out.field("approach_floor", unit(joint.approach_floor, "m/s"));
            out.block("axial", |out| out.contact(&joint.axial));
            out.block("radial", |out| out.contact(&joint.radial));
            out.strength(&joint.strength);
            out.article(&joint.article);
        });
        self.text.push('\n');
    }

    fn wheel(&mut self, wheel: &Wheel, name: &str) {
        if !self.printed.insert(format!("wheel {name}")) {
            return;
        }
        self.block(format!("wheel {name}"), |out| {
            out.field("radius", metres(wheel.radius));
            out.field("half_spacing", metres(wheel.half_spacing));
            out.field("height", metres(wheel.height));
            out.field("gap", metres(wheel.gap));
            out.contact(&wheel.contact);
            out.field("rolling_resistance", number(wheel.rolling_resistance));
            out.strength(&wheel.strength);
        });
        self.text.push('\n');
    }

    fn contact(&mut self, contact: &ContactParameters) {
        let exponent = if contact.exponent == 1.0 { String::new() } else { format!("^{}", contact.exponent) };
        self.field("stiffness", unit(contact.stiffness, &format!("N/m{exponent}")));
        self.field("exponent", number(contact.exponent));
        self.field("restitution", number(contact.restitution));
    }

    pub(super) fn drive(&mut self, layout: &Layout) {
        let (motor, controller, sensor) = (&layout.drive.motor, &layout.drive.controller, &layout.sensor);
        self.motor(motor);
        self.block(format!("controller {}", controller.name), |out| {
            out.field("proportional", unit(controller.proportional, "N*s/m"));
            out.field("integral", unit(controller.integral, "N/m"));
            out.field("derivative", unit(controller.derivative, "N*s^2/m"));
            out.field("period", unit(controller.period, "s"));
        });
        self.text.push('\n');
        self.sensor(sensor);
        layout.take_up.iter().for_each(|take_up| self.take_up(take_up));
    }
}

fn same_wheel(a: &Wheel, b: &Wheel) -> bool {
    let numbers = |w: &Wheel| [w.radius, w.half_spacing, w.height, w.gap, w.rolling_resistance];
    numbers(a) == numbers(b) && a.contact == b.contact
}
