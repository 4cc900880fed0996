//! Small random loops as text, and every choice of turns and radii that they have.

use lss::base::trig;
use lss::geometry::Point;
use lss::model::Layout;
use lss::semantics::analyse;
use lss::solve::{Effort, Options, Stage, solve};
use lss::source::{Loader, SourceMap};
use std::fmt::Write;

pub const STEP: f64 = 15.0;
pub const RADII: [f64; 2] = [2.0, 5.0];
pub const SHORTEST: f64 = 0.2;
/// Length of a cart and what a closed chain may be off, m.
pub const PITCH: f64 = 0.55;
pub const WITHIN: f64 = 0.04;
/// Least and most steps of a turn.
pub const TURNS: (i32, i32) = (1, 8);

pub fn layout(text: &str) -> Layout {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("small.lss", text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    analysis.chosen().ok().flatten().unwrap_or_else(|| panic!("{:?}\n{text}", analysis.diagnostics)).clone()
}

/// A linear congruential generator (Knuth 1997, §3.3.4).
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) as usize) % n
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.below(1 << 20) as f64 / f64::from(1 << 20)
    }
}

/// Turns, radii and straights of a closed loop. Section i runs from vertex i to the next.
#[derive(Clone, Debug)]
pub struct Small {
    /// Signed steps by vertex.
    pub turns: Vec<i32>,
    pub radii: Vec<f64>,
    pub straights: Vec<f64>,
}

impl Small {
    pub fn tangent(&self, i: usize) -> f64 {
        self.radii[i] * trig::tan((f64::from(self.turns[i].abs()) * STEP / 2.0).to_radians())
    }

    /// Unit vectors along sections; the first one along +x.
    pub fn units(&self) -> Vec<Point> {
        let mut heading = 0;
        (0..self.turns.len())
            .map(|i| {
                heading += if i == 0 { 0 } else { self.turns[i] };
                let angle = (f64::from(heading) * STEP).to_radians();
                Point::new(trig::cos(angle), trig::sin(angle))
            })
            .collect()
    }

    pub fn section(&self, i: usize) -> f64 {
        self.straights[i] + self.tangent(i) + self.tangent((i + 1) % self.turns.len())
    }

    pub fn points(&self) -> Vec<Point> {
        let mut at = Point::new(0.0, 0.0);
        let units = self.units();
        (0..self.turns.len())
            .map(|i| {
                let here = at;
                at = at + units[i] * self.section(i);
                here
            })
            .collect()
    }

    pub fn length(&self) -> f64 {
        let arc = |i: usize| self.radii[i] * (f64::from(self.turns[i].abs()) * STEP).to_radians();
        self.straights.iter().sum::<f64>() + (0..self.turns.len()).map(arc).sum::<f64>()
    }

    /// Sets the straights `a` and `b` so that the loop closes; whether that is possible.
    pub fn close(&mut self, a: usize, b: usize) -> bool {
        (self.straights[a], self.straights[b]) = (0.0, 0.0);
        let units = self.units();
        let open = (0..self.turns.len()).fold(Point::default(), |sum, i| sum + units[i] * self.section(i));
        let det = units[a].cross(units[b]);
        if det.abs() < 1e-9 {
            return false;
        }
        self.straights[a] = -open.cross(units[b]) / det;
        self.straights[b] = -units[a].cross(open) / det;
        true
    }
}

/// A random loop, closed, with straights that are long enough.
pub fn random(random: &mut Random, n: usize) -> Small {
    loop {
        let right = if n > 4 && random.below(2) == 0 { 1 + random.below(n - 1) } else { n };
        let mut turns: Vec<i32> = (0..n).map(|_| 1 + random.below(8) as i32).collect();
        if right < n {
            turns[right] = -(1 + random.below(4) as i32);
        }
        let others: i32 = turns[1..].iter().sum();
        turns[0] = 24 - others;
        if turns[0] < TURNS.0 || turns[0] > TURNS.1 {
            continue;
        }
        let radii = (0..n).map(|_| RADII[random.below(RADII.len())]).collect();
        let straights = (0..n).map(|_| random.between(0.5, 12.0)).collect();
        let mut small = Small { turns, radii, straights };
        if small.close(n - 2, n - 1) && small.straights.iter().all(|&s| s > 0.5 && s < 40.0) {
            return small;
        }
    }
}

/// What is asked of a layout beside its first section, which is fixed.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// Fix length and rotation of the third section.
    pub third: bool,
    pub obstacles: Vec<Vec<Point>>,
    /// `cost`; the length when nothing is said.
    pub goal: Option<&'static str>,
    /// A chain of carts of [`PITCH`] closes within [`WITHIN`].
    pub closes: bool,
}

pub fn text(small: &Small, asked: &Asked) -> String {
    let mut out = String::from(
        "use std.carts.tilt_tray\nuse std.tracks.standard\n\ncatalog coarse from standard {\n  straight {\n    \
         cut = 200 mm .. 3 m\n    \
         shortest = 200 mm\n  }\n  curve {\n    radii = [2 m, 5 m]\n    angle_step = 15 deg\n    largest = 45 deg\n    \
         turns = 15 deg .. 120 deg\n  }\n}\n\nlayout small {\n  catalog coarse\n  cart tilt_tray(length: 550 mm)\n  \
         speed 2 m/s\n  width 0.6 m\n",
    );
    for (i, p) in small.points().iter().enumerate() {
        let _ = writeln!(out, "  vertex P{i} ({:?} m, {:?} m) radius {:?} m", p.x, p.y, small.radii[i]);
    }
    for (i, corners) in asked.obstacles.iter().enumerate() {
        let corners: Vec<String> = corners.iter().map(|p| format!("({:?} m, {:?} m)", p.x, p.y)).collect();
        let _ = writeln!(out, "  obstacle O{i} [{}]", corners.join(", "));
    }
    out += "  fix all P0..P1\n";
    if asked.third {
        out += "  fix length, rotation P2..P3\n";
    }
    if asked.closes {
        let _ = writeln!(out, "  chain closes within {WITHIN:?} m");
    }
    let _ = write!(out, "  optimise {}\n}}\n", asked.goal.unwrap_or("length"));
    out
}

/// Every choice of turns (in their written directions) and radii.
pub fn choices(small: &Small, asked: &Asked, each: &mut dyn FnMut(Small)) {
    let n = small.turns.len();
    let third: i32 = small.turns[1..3].iter().sum();
    let mut turns = vec![0; n];
    fn go(k: usize, turns: &mut Vec<i32>, small: &Small, asked: &Asked, third: i32, done: &mut dyn FnMut(&[i32])) {
        let n = turns.len();
        if k == n {
            turns[0] = 24 - turns[1..].iter().sum::<i32>();
            if (TURNS.0..=TURNS.1).contains(&(turns[0] * small.turns[0].signum())) {
                done(turns);
            }
            return;
        }
        for steps in TURNS.0..=TURNS.1 {
            turns[k] = steps * small.turns[k].signum();
            let heading: i32 = turns[1..=k].iter().sum();
            if !(asked.third && k == 2 && heading != third) {
                go(k + 1, turns, small, asked, third, done);
            }
        }
    }
    go(1, &mut turns, small, asked, third, &mut |turns| {
        for code in 0..RADII.len().pow(n as u32) {
            let radii = (0..n).map(|i| RADII[code / RADII.len().pow(i as u32) % RADII.len()]).collect();
            let mut choice = Small { turns: turns.to_vec(), radii, straights: vec![SHORTEST; n] };
            let fixed: &[usize] = if asked.third { &[0, 2] } else { &[0] };
            for &i in fixed {
                choice.straights[i] = small.section(i) - choice.tangent(i) - choice.tangent((i + 1) % n);
            }
            if fixed.iter().all(|&i| choice.straights[i] >= SHORTEST - 1e-9) {
                each(choice);
            }
        }
    });
}

pub fn last(small: &Small, asked: &Asked, effort: Effort) -> Option<Stage> {
    let layout = layout(&text(small, asked));
    let stages = solve(&layout, &Options { threads: 1, effort, ..Options::default() }, &|_| {});
    let last = stages.last().expect("a stage").clone();
    (last.name == "stage3" && last.violations.is_empty()).then_some(last)
}
