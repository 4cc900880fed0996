//! Stage 3 against every choice of turns and radii of small random layouts, each solved by another route: straights that close a
//! loop and cost least are a basic solution of their two equations, so all pairs are tried.

use lss::geometry::{Point, Polygon, Track, trig};
use lss::model::Layout;
use lss::semantics::analyse;
use lss::solve::{Effort, Options, Stage, solve};
use lss::source::{Loader, SourceMap};
use std::fmt::Write;

const STEP: f64 = 15.0;
const RADII: [f64; 2] = [2.0, 5.0];
const SHORTEST: f64 = 0.2;
/// Least and most steps of a turn.
const TURNS: (i32, i32) = (1, 8);
const HALF_WIDTH: f64 = 0.3;

fn layout(text: &str) -> Layout {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("small.lss", text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    analysis.chosen().ok().flatten().unwrap_or_else(|| panic!("{:?}\n{text}", analysis.diagnostics)).clone()
}

/// A linear congruential generator (Knuth 1997, §3.3.4).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) as usize) % n
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.below(1 << 20) as f64 / f64::from(1 << 20)
    }
}

/// Turns, radii and straights of a closed loop. Section i runs from vertex i to the next.
#[derive(Clone, Debug)]
struct Small {
    /// Signed steps by vertex.
    turns: Vec<i32>,
    radii: Vec<f64>,
    straights: Vec<f64>,
}

impl Small {
    fn tangent(&self, i: usize) -> f64 {
        self.radii[i] * trig::tan((f64::from(self.turns[i].abs()) * STEP / 2.0).to_radians())
    }

    /// Unit vectors along sections; the first one along +x.
    fn units(&self) -> Vec<Point> {
        let mut heading = 0;
        (0..self.turns.len())
            .map(|i| {
                heading += if i == 0 { 0 } else { self.turns[i] };
                let angle = (f64::from(heading) * STEP).to_radians();
                Point::new(trig::cos(angle), trig::sin(angle))
            })
            .collect()
    }

    fn section(&self, i: usize) -> f64 {
        self.straights[i] + self.tangent(i) + self.tangent((i + 1) % self.turns.len())
    }

    fn points(&self) -> Vec<Point> {
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

    fn length(&self) -> f64 {
        let arc = |i: usize| self.radii[i] * (f64::from(self.turns[i].abs()) * STEP).to_radians();
        self.straights.iter().sum::<f64>() + (0..self.turns.len()).map(arc).sum::<f64>()
    }

    /// Sets the straights `a` and `b` so that the loop closes; whether that is possible.
    fn close(&mut self, a: usize, b: usize) -> bool {
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

    /// Points of the centre line, about `step` apart.
    fn line(&self, step: f64) -> Vec<Point> {
        let corners = self.points().into_iter().zip(&self.radii);
        let track =
            Track::new(&corners.map(|(point, &radius)| lss::geometry::Corner { point, radius }).collect::<Vec<_>>());
        let count = (track.length / step).ceil() as usize;
        (0..count).map(|k| track.at(track.length * k as f64 / count as f64).0).collect()
    }
}

/// A random loop, closed, with straights that are long enough.
fn random(random: &mut Random, n: usize) -> Small {
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
struct Asked {
    /// Fix length and rotation of the third section.
    third: bool,
    obstacles: Vec<Vec<Point>>,
}

fn text(small: &Small, asked: &Asked) -> String {
    let mut out = String::from(
        "use std.carts.tilt_tray\nuse std.tracks.standard\n\ncatalog coarse from standard {\n  straight {\n    cut = 200 mm .. 3 m\n    \
         shortest = 200 mm\n  }\n  curve {\n    radii = [2 m, 5 m]\n    angle_step = 15 deg\n    largest = 45 deg\n    \
         turns = 15 deg .. 120 deg\n  }\n}\n\nlayout small {\n  catalog coarse\n  cart tilt_tray(length: 1250 mm)\n  speed 2 m/s\n  \
         width 0.6 m\n",
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
    out + "  optimise length\n}\n"
}

/// Every choice of turns (in their written directions) and radii.
fn choices(small: &Small, asked: &Asked, each: &mut dyn FnMut(Small)) {
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

/// The length of the shortest, without obstacles.
fn shortest(small: &Small, asked: &Asked) -> f64 {
    let n = small.turns.len();
    let free: Vec<usize> = (1..n).filter(|&i| !(asked.third && i == 2)).collect();
    let mut best = f64::INFINITY;
    choices(small, asked, &mut |choice| {
        for (j, &a) in free.iter().enumerate() {
            for &b in &free[j + 1..] {
                let mut choice = choice.clone();
                if choice.close(a, b) && choice.straights.iter().all(|&s| s >= SHORTEST - 1e-9) {
                    best = best.min(choice.length());
                }
            }
        }
    });
    best
}

fn last(small: &Small, asked: &Asked, effort: Effort) -> Option<Stage> {
    let layout = layout(&text(small, asked));
    let stages = solve(&layout, &Options { threads: 1, effort, ..Options::default() }, &|_| {});
    let last = stages.last().expect("a stage").clone();
    (last.name == "stage3" && last.violations.is_empty()).then_some(last)
}

#[test]
fn no_choice_of_turns_and_radii_is_shorter() {
    let mut seeds = Random(7);
    let (mut proven, count) = (0, 100);
    for case in 0..count {
        let n = 4 + case % 2;
        let small = random(&mut seeds, n);
        let asked = Asked { third: case % 3 == 0 && n == 5, ..Asked::default() };
        let best = shortest(&small, &asked);
        let Some(stage) = last(&small, &asked, Effort::default()) else { continue };
        let certificate = stage.certificate.expect("a certificate");
        assert!(certificate.lower_bound <= best + 1e-9, "{case}: {certificate:?} {best}\n{}", text(&small, &asked));
        // Out of nodes, the bound is still one.
        if let Some(hasty) = last(&small, &asked, Effort { nodes: 2, gap: 0.0 }) {
            assert!(hasty.certificate.expect("a certificate").lower_bound <= best + 1e-9);
        }
        // A track's own width may forbid what is shortest without it.
        assert!(stage.length >= best - 1e-5, "{case}: {} {best}", stage.length);
        if certificate.proven && (stage.length - best).abs() < 1e-6 {
            proven += 1;
        }
    }
    assert!(proven * 10 >= count * 9, "{proven} of {count}");
}

/// The even-odd rule.
fn encloses(line: &[Point], p: Point) -> bool {
    let crosses =
        |(a, b): (&Point, &Point)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
    line.iter().zip(line.iter().cycle().skip(1)).filter(|&edge| crosses(edge)).count() % 2 == 1
}

/// Whether a layout keeps its distance from an obstacle and has it on the wanted side, by points of its centre line.
fn clear(small: &Small, obstacle: &[Point], inside: bool, distance: f64) -> bool {
    let line = small.line(0.1);
    let polygon = Polygon::new(obstacle.to_vec()).expect("a rectangle");
    let near = line.iter().map(|&p| polygon.distance_to_outline(p)).fold(f64::INFINITY, f64::min);
    near >= distance && line.iter().all(|&p| !polygon.contains(p)) && encloses(&line, obstacle[0]) == inside
}

#[test]
fn no_sampled_layout_beside_an_obstacle_is_shorter() {
    let mut seeds = Random(11);
    let (mut proven, mut cases) = (0, 0);
    while cases < 24 {
        let small = random(&mut seeds, 4);
        let (centre, size) = {
            let points = small.points();
            let at = points[seeds.below(4)].lerp(points[seeds.below(4)], seeds.between(-0.2, 1.2));
            (at, Point::new(seeds.between(0.4, 2.0), seeds.between(0.4, 2.0)))
        };
        let corner = |x: f64, y: f64| Point::new(centre.x + x * size.x, centre.y + y * size.y);
        let obstacle = vec![corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
        let inside = [true, false].into_iter().find(|&inside| clear(&small, &obstacle, inside, HALF_WIDTH + 0.05));
        let Some(inside) = inside else { continue };
        cases += 1;
        let asked = Asked { obstacles: vec![obstacle.clone()], ..Asked::default() };
        let Some(stage) = last(&small, &asked, Effort { nodes: 1_000, gap: 0.0 }) else { continue };
        let certificate = stage.certificate.expect("a certificate");
        proven += usize::from(certificate.proven);
        choices(&small, &asked, &mut |choice| {
            for k in 0..30 {
                let mut choice = choice.clone();
                choice.straights[1] = SHORTEST + 0.5 * f64::from(k);
                let closes = choice.close(2, 3) && choice.straights.iter().all(|&s| s >= SHORTEST);
                let length = choice.length();
                if closes && length < certificate.lower_bound - 1e-4 {
                    let found = clear(&choice, &obstacle, inside, HALF_WIDTH + 2e-3);
                    assert!(!found, "{certificate:?} {length} {choice:?}\n{}", text(&small, &asked));
                }
            }
        });
    }
    assert!(proven * 10 >= cases * 7, "{proven} of {cases}");
}
