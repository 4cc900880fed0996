//! Layouts of any size as text: combs, combs with columns in and between their teeth, and meanders of a seed.

#![allow(dead_code)]

use lss::base::trig::TAU;
use lss::geometry::Point;
use std::fmt::Write;

const HEAD: &str = "use std.carts.tilt_tray\nuse std.tracks.thesis\n\nlayout LAYOUT {\n  catalog thesis\n  \
                    cart tilt_tray(length: 1250 mm)\n  speed 2 m/s\n  width 1.2 m\n\n";

fn head(name: &str) -> String {
    HEAD.replace("LAYOUT", name)
}

/// A rectangle that stands along the axes, m.
fn block(text: &mut String, name: &str, (x, y): (f64, f64), (width, height): (f64, f64)) {
    let (r, t) = (x + width, y + height);
    let _ = writeln!(text, "  obstacle {name} [({x} m, {y} m), ({r} m, {y} m), ({r} m, {t} m), ({x} m, {t} m)]");
}

/// The four vertices of a tooth that hangs from y = 60 m to 30 m, and the frame around the teeth.
fn teeth(text: &mut String, n: usize, held: bool) -> f64 {
    let teeth = (n - 4) / 4;
    for i in 0..teeth {
        let x = 40.0 * i as f64;
        for (k, (dx, y)) in [(0.0, 60.0), (14.0, 60.0), (14.0, 30.0), (26.0, 30.0)].into_iter().enumerate() {
            let _ = writeln!(text, "  vertex P{i}_{k} ({} m, {y} m) radius 4 m", x + dx);
        }
        if held && i > 0 {
            let _ = writeln!(text, "  fix P{i}_0");
        }
    }
    let end = 40.0 * teeth as f64;
    let _ = writeln!(text, "  vertex E0 ({end} m, 60 m) radius 4 m\n  vertex E1 ({end} m, 90 m) radius 4 m");
    let _ = writeln!(text, "  vertex E2 (-20 m, 90 m) radius 4 m\n  vertex E3 (-20 m, 66 m) radius 4 m");
    let _ = writeln!(text, "  fix E1\n  fix E2");
    end
}

/// A comb of `n` vertices (a multiple of 4), the first vertex of each tooth fixed, with `obstacles` columns in a row
/// between its teeth and its back.
pub fn comb(n: usize, obstacles: usize) -> String {
    let mut text = head("comb");
    let end = teeth(&mut text, n, true);
    for i in 0..obstacles {
        let x = end * (i as f64 + 0.5) / obstacles as f64 - 10.0;
        block(&mut text, &format!("c{i}"), (x, 75.0), (1.0, 1.0));
    }
    text + "\n  optimise length\n}\n"
}

/// A comb of `n` vertices (a multiple of 4) of which only the two of its back are fixed: a column stands in each tooth,
/// and further ones between teeth, `obstacles` in all.
pub fn columns(n: usize, obstacles: usize) -> String {
    let mut text = head("columns");
    let end = teeth(&mut text, n, false);
    let count = (n - 4) / 4;
    for i in 0..obstacles.min(count) {
        let deep = 36.0 + 3.0 * (i % 4) as f64;
        block(&mut text, &format!("in{i}"), (40.0 * i as f64 + 18.5, deep), (3.0, 6.0));
    }
    let between = obstacles.saturating_sub(count);
    for i in 0..between {
        let x = (end - 40.0) * (i as f64 + 0.5) / between as f64;
        // On the axis between two teeth: below the track.
        let tooth = (x / 40.0).floor();
        block(&mut text, &format!("out{i}"), (40.0 * tooth + 34.0 + (x - 40.0 * tooth) / 8.0, 40.0), (2.0, 3.0));
    }
    text + "\n  optimise length\n}\n"
}

/// Numbers of a seed (Steele, Lea and Flood 2014, SplitMix64).
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A meandering ring of `n` vertices whose radii and steps are drawn from a seed, with `obstacles` columns of drawn
/// sizes beside its sections, on drawn sides. One vertex is fixed; columns hold the rest.
pub fn meander(n: usize, obstacles: usize, seed: u64) -> String {
    let mut random = Random(seed);
    let ring = 22.0 * n as f64 / TAU;
    let mut place = |i: usize| {
        let angle = TAU * (i as f64 + random.between(-0.15, 0.15)) / n as f64;
        Point::unit(angle) * (ring + random.between(-9.0, 9.0))
    };
    let mut points: Vec<Point> = (0..n).map(&mut place).collect();
    // No turn near 0° or beyond what the catalogue has: redrawn one by one, for all at once nearly never fit.
    for _ in 0..50 * n {
        let turn = |i: usize| {
            let (u, v) = (points[(i + 1) % n] - points[i], points[(i + 2) % n] - points[(i + 1) % n]);
            lss::base::trig::atan2(u.cross(v), u.dot(v)).to_degrees().abs()
        };
        let Some(bad) = (0..n).find(|&i| !(7.0..75.0).contains(&turn(i))) else { break };
        let i = (bad + 1) % n;
        points[i] = place(i);
    }
    let mut text = head("meander");
    for (i, Point { x, y }) in points.iter().enumerate() {
        let radius = random.between(3.0, 6.0).round();
        let _ = writeln!(text, "  vertex P{i} ({x:.3} m, {y:.3} m) radius {radius} m");
    }
    text += "  fix P0\n";
    for i in 0..obstacles {
        let k = i * n / obstacles;
        let (a, b) = (points[k], points[(k + 1) % n]);
        let along = (b - a) * (1.0 / a.distance(b));
        let side = if random.between(0.0, 1.0) < 0.75 { 1.0 } else { -1.0 };
        let (size, off) = (random.between(0.8, 2.0), random.between(0.2, 3.0));
        let away = side * (0.6 + off + size);
        let Point { x, y } = a.lerp(b, 0.5) + along.left() * away;
        // A diamond, so that it has no side along an axis.
        let corners = [(x + size, y), (x, y + size), (x - size, y), (x, y - size)];
        let corners = corners.map(|(x, y)| format!("({x:.3} m, {y:.3} m)")).join(", ");
        let _ = writeln!(text, "  obstacle c{i} [{corners}]");
    }
    text + "\n  optimise length\n}\n"
}

/// A loop with so many vertices, two of them a step of a staircase, that goes around an obstacle in each of its corners
/// and leaves another one in each notch outside. No section is fixed, or the direction of one.
pub fn staircase(n: usize, direction: bool) -> String {
    let steps = (n - 4) / 2;
    let (width, mut text) = (20.0 + 16.0 * steps as f64, String::new());
    text += "use std.carts.tilt_tray\nuse std.tracks.standard\nlayout staircase {\n  catalog standard\n";
    text += "  cart tilt_tray(length: 1250 mm)\n  speed 2 m/s\n  width 1.2 m\n";
    let at = |j: usize| (width - 16.0 * j as f64, 16.0 + 12.0 * j as f64);
    let mut corners = vec![(0.0, 0.0), (width, 0.0)];
    let mut obstacles = vec![((3.0, 3.0), "left"), ((width - 5.0, 3.0), "left")];
    for j in 0..=steps {
        let (x, y) = at(j);
        // Off the grid, so that no two are alike.
        let off = 0.37 * (1 + j % 3) as f64;
        corners.push((x, y));
        obstacles.push(((x - 5.0 - off, y - 5.0 + 0.5 * off), "left"));
        if j < steps {
            corners.push((at(j + 1).0, y));
            obstacles.push(((at(j + 1).0 + 3.0 + 0.5 * off, y + 3.0 + off), "right"));
        }
    }
    let top = at(steps).1;
    corners.push((0.0, top));
    obstacles.push(((3.0, top - 5.0), "left"));
    for (k, (x, y)) in corners.iter().enumerate() {
        let _ = writeln!(text, "  vertex P{k} ({x} m, {y} m) radius 4 m");
    }
    for (k, ((x, y), side)) in obstacles.iter().enumerate() {
        let (right, top) = (x + 2.0, y + 2.0);
        let _ = writeln!(
            text,
            "  obstacle O{k} [({x} m, {y} m), ({right} m, {y} m), ({right} m, {top} m), ({x} m, {top} m)]\n  pass O{k} \
             {side}"
        );
    }
    if direction {
        text += "  fix rotation P0..P1\n";
    }
    text + "  optimise length\n}\n"
}
