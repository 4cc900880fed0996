//! A layout of as many lines as one likes, for the front end and the editor.

use std::fmt::Write;

/// Values, comments, a comb of `teeth` teeth (four vertices each and four around them), obstacles and requirements on the
/// first vertices.
pub fn large(values: usize, teeth: usize, racks: usize, requirements: usize) -> String {
    let mut text = String::from("use std.carts.tilt_tray\nuse std.tracks.thesis\n");
    for i in 0..values {
        let _ = writeln!(text, "let aisle_{i} = {} * 1.2 m + {i} mm // between racks", i % 7 + 1);
    }
    text += "layout large {\n  catalog thesis\n  cart tilt_tray(length: 1250 mm)\n  speed 2 m/s\n  width 1.2 m\n";
    for i in 0..teeth {
        let x = 40.0 * i as f64;
        for (k, (dx, y)) in [(0.0, 0.0), (12.0, 0.0), (12.0, 30.0), (28.0, 30.0)].into_iter().enumerate() {
            let _ = writeln!(text, "  vertex P{i}_{k} ({} m, {} m) radius 4 m", x + dx, 100.0 - y);
        }
    }
    let end = 40.0 * teeth as f64;
    let _ = writeln!(text, "  vertex E0 ({end} m, 100 m) radius 4 m\n  vertex E1 ({end} m, 200 m) radius 4 m");
    text += "  vertex E2 (-40 m, 200 m) radius 4 m\n  vertex E3 (-40 m, 112 m) radius 4 m\n";
    for i in 0..racks {
        let _ = writeln!(text, "  // rack {i}");
        let x = 1.5 * i as f64;
        let (a, b) = (format!("{x} m"), format!("{} m", x + 1.0));
        let _ = writeln!(text, "  obstacle rack_{i} [({a}, 150 m), ({b}, 150 m), ({b}, 151 m), ({a}, 151 m)]");
    }
    for i in 0..requirements {
        let _ = writeln!(text, "  require radius(P{}_{}) <= 8 m \"row {i}\"", i / 4, i % 4);
    }
    text += "  optimise length\n}\n";
    text
}
