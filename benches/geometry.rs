//! `cargo bench --bench geometry`: contact areas against the number of obstacles, crossings against that of vertices.

use divan::{Bencher, black_box};
use lss::base::trig::TAU;
use lss::geometry::{Corner, Hand, Outline, Point, Polygon, Track, band_overlaps, outside_area, self_crossings};

const HALF_WIDTH: f64 = 0.6;

fn main() {
    divan::main();
}

/// A wavy loop of `n` vertices, about 9 m apart, with left and right turns.
fn wavy(n: usize) -> Track {
    let radius = 9.0 * n as f64 / TAU;
    let corner = |i: usize| {
        let reach = if n > 10 && i.is_multiple_of(2) { radius + 3.0 } else { radius };
        Corner { point: Point::unit(TAU * i as f64 / n as f64) * reach, radius: 3.0 }
    };
    Track::new(&(0..n).map(corner).collect::<Vec<_>>())
}

/// Square columns of 1 m along the loop, some touched by it.
fn columns(n: usize, track: &Track) -> Vec<Polygon> {
    let column = |i: usize| {
        let (p, _) = track.at(track.length * i as f64 / n as f64);
        let corners = [(0.4, 0.4), (1.4, 0.4), (1.4, 1.4), (0.4, 1.4)];
        Polygon::new(corners.map(|(x, y)| p + Point::new(x, y)).to_vec()).ok()
    };
    (0..n).filter_map(column).collect()
}

/// Both sides of a loop of 50 vertices against that many columns.
#[divan::bench(args = [1, 10, 50, 200])]
fn contact_areas(bencher: Bencher, obstacles: usize) {
    let track = wavy(50);
    let columns = columns(obstacles, &track);
    bencher.bench(|| {
        let mut area = 0.0;
        for hand in [Hand::Left, Hand::Right] {
            let side = Outline::side(black_box(&track), HALF_WIDTH, hand);
            area += columns.iter().map(|c| side.contact(c, hand)).sum::<f64>();
        }
        area
    });
}

#[divan::bench(args = [10, 20, 50, 100, 200])]
fn area_outside_the_building(bencher: Bencher, vertices: usize) {
    let track = wavy(vertices);
    let (low, high) = (-9.0 * vertices as f64 / TAU, 9.0 * vertices as f64 / TAU);
    let corners = [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| Point::new(x, y));
    let Ok(building) = Polygon::new(corners.to_vec()) else { return };
    bencher.bench(|| outside_area(black_box(&track), HALF_WIDTH, Hand::Right, &building));
}

#[divan::bench(args = [10, 20, 50, 100, 200])]
fn crossings(bencher: Bencher, vertices: usize) {
    let track = wavy(vertices);
    bencher.bench(|| self_crossings(black_box(&track)));
}

#[divan::bench(args = [10, 20, 50, 100, 200])]
fn overlaps(bencher: Bencher, vertices: usize) {
    let track = wavy(vertices);
    bencher.bench(|| band_overlaps(black_box(&track), 2.0 * HALF_WIDTH));
}
