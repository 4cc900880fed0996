//! Colours and line styles of the drawings, as one style sheet. Line widths and letter heights follow ISO 128 and
//! ISO 3098, in mm on paper; the colours of the stages are Okabe and Ito's (2008), which colour-blind readers tell
//! apart, and their darker or lighter kin where the ground asks for more contrast.

use std::fmt::Write;

/// For whom a drawing is styled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Theme {
    /// Colours as CSS variables that follow the reader's light or dark preference.
    Adaptive,
    /// Light colours only, without variables: for paper and rasters.
    Light,
}

/// Name, on light ground, on dark ground.
const COLOURS: [(&str, &str, &str); 15] = [
    ("paper", "#ffffff", "#14181d"),
    ("ink", "#16191d", "#e9ecef"),
    ("muted", "#59636e", "#9ba7b3"),
    ("faint", "#c9d0d8", "#39434e"),
    ("band", "#e4edf6", "#20303f"),
    ("edge", "#1d3f66", "#a9c9ec"),
    ("centre", "#b3261e", "#ff8f85"),
    ("solid", "#7a4d00", "#e3b45c"),
    ("motor", "#0072b2", "#56b4e9"),
    ("chute", "#00795a", "#35c9a0"),
    ("induction", "#c24e00", "#ff9c54"),
    ("sensor", "#7b3294", "#d7a1ea"),
    ("fixed", "#a3246f", "#f08fc6"),
    ("warn", "#b00020", "#ff6b7a"),
    ("gold", "#9a6b00", "#f0c24b"),
];

/// Selector and declarations; `{name}` stands for a colour.
const RULES: [(&str, &str); 53] = [
    ("path,circle,rect", "fill:none;stroke-linejoin:round"),
    ("text", "font-family:'DejaVu Sans',Verdana,Arial,sans-serif;fill:{ink};stroke:none"),
    (".halo", "stroke:{paper};stroke-width:.7;stroke-linejoin:round;paint-order:stroke"),
    (".ground", "fill:{paper}"),
    (".h18", "font-size:2.5px"),
    (".h25", "font-size:3.4px"),
    (".h35", "font-size:4.8px"),
    (".h50", "font-size:6.8px"),
    (".bold", "font-weight:bold"),
    (".middle", "text-anchor:middle"),
    (".quiet", "fill:{muted}"),
    (".frame", "stroke:{ink};stroke-width:.7"),
    (".rule", "stroke:{ink};stroke-width:.25"),
    (".wall", "stroke:{ink};stroke-width:.7"),
    (".wall-hatch", "fill:url(#wall-hatch)"),
    (".wall-line", "stroke:{ink};stroke-width:.18"),
    (".obstacle", "stroke:{solid};stroke-width:.5"),
    (".obstacle-hatch", "fill:url(#obstacle-hatch);fill-rule:evenodd"),
    (".obstacle-line", "stroke:{solid};stroke-width:.25"),
    (".clearance", "stroke:{solid};stroke-width:.25;stroke-dasharray:2 1"),
    (".band", "fill:{band};fill-rule:evenodd"),
    (".climb", "fill:{gold};fill-opacity:.22"),
    (".climb-text", "fill:{gold}"),
    (".edge", "stroke:{edge};stroke-width:.5"),
    (".centre", "stroke:{centre};stroke-width:.25;stroke-dasharray:6 1.2 .6 1.2"),
    (".arrow", "fill:{centre}"),
    (".joint", "stroke:{edge};stroke-width:.25"),
    (".change", "stroke:{edge};stroke-width:.5"),
    (".fixed", "stroke:{fixed};stroke-width:.9;stroke-linecap:round"),
    (".fixed-text", "fill:{fixed}"),
    (".vertex", "stroke:{ink};stroke-width:.35"),
    (".tangent", "stroke:{muted};stroke-width:.18;stroke-dasharray:2.4 .8 .4 .8"),
    (".dimension", "stroke:{ink};stroke-width:.18"),
    (".conveyor-line", "stroke:{ink};stroke-width:.5;stroke-dasharray:3 1.2"),
    (".dimension-arrow", "fill:{ink}"),
    (".grid-axis", "stroke:{muted};stroke-width:.25;stroke-dasharray:8 1.5 1 1.5"),
    (".bubble", "stroke:{ink};stroke-width:.35;fill:{paper}"),
    (".datum-ground", "fill:{paper}"),
    (".leader", "stroke:{muted};stroke-width:.18"),
    (".motor", "fill:{motor}"),
    (".motor-text", "fill:{motor}"),
    (".chute", "stroke:{chute};stroke-width:.35;fill:{paper}"),
    (".chute-text", "fill:{chute}"),
    (".induction", "fill:{induction}"),
    (".induction-footprint", "fill:{induction};fill-opacity:.25;stroke:{induction};stroke-width:.25"),
    (".induction-text", "fill:{induction}"),
    (".support", "stroke:{ink};stroke-width:.25;fill:{paper}"),
    (".photocell", "stroke:{sensor};stroke-width:.35;fill:{paper}"),
    (".photocell-text", "fill:{sensor}"),
    (".start", "stroke:{ink};stroke-width:.7"),
    (".warn", "fill:{warn}"),
    (".watermark", "fill:{warn};fill-opacity:.16;font-weight:bold;text-anchor:middle;letter-spacing:.04em"),
    (".warn-box", "stroke:{warn};stroke-width:.5"),
];

/// The four layouts of a stages drawing, in their order.
const STAGES: [(&str, &str); 4] = [
    (".stage-0", "stroke:{muted};stroke-width:.5;stroke-dasharray:.6 1.4;stroke-linecap:round"),
    (".stage-1", "stroke:{gold};stroke-width:.6;stroke-dasharray:5 1.6"),
    (".stage-2", "stroke:{motor};stroke-width:.6;stroke-dasharray:7 1.4 1 1.4"),
    (".stage-3", "stroke:{induction};stroke-width:.7"),
];

/// The style sheet of a drawing.
pub fn sheet(theme: Theme) -> String {
    let mut out = String::new();
    if theme == Theme::Adaptive {
        let colours = |pick: fn(&(&str, &str, &str)) -> String| COLOURS.iter().map(pick).collect::<String>();
        let light = colours(|c| format!("--{}:{};", c.0, c.1));
        let dark = colours(|c| format!("--{}:{};", c.0, c.2));
        let _ = writeln!(out, ".drawing{{color-scheme:light dark;{light}}}");
        let _ = writeln!(out, "@media(prefers-color-scheme:dark){{.drawing{{{dark}}}}}");
        let _ = writeln!(out, "@media print{{.drawing{{{light}}}}}");
    }
    for (selector, declarations) in RULES.iter().chain(&STAGES) {
        let mut declarations = (*declarations).to_owned();
        for (name, light, _) in COLOURS {
            let colour = match theme {
                Theme::Adaptive => format!("var(--{name})"),
                Theme::Light => light.to_owned(),
            };
            declarations = declarations.replace(&format!("{{{name}}}"), &colour);
        }
        let _ = writeln!(out, "{selector}{{{declarations}}}");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_colour_is_defined() {
        for theme in [Theme::Adaptive, Theme::Light] {
            let rules = sheet(theme);
            assert!(!rules.contains(":{") && !rules.contains("{}"), "{rules}");
            assert_eq!(rules.contains("var("), theme == Theme::Adaptive);
        }
    }

    /// Relative luminance contrast, WCAG 2.1.
    fn contrast(a: &str, b: &str) -> f64 {
        let luminance = |hex: &str| {
            let channel = |i: usize| {
                let c = f64::from(u8::from_str_radix(&hex[i..i + 2], 16).expect("hex")) / 255.0;
                if c <= 0.03928 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
            };
            0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn every_text_and_line_stands_out_from_its_ground() {
        let (_, light, dark) = COLOURS[0];
        for (name, on_light, on_dark) in COLOURS.iter().filter(|c| !["paper", "faint", "band"].contains(&c.0)) {
            assert!(contrast(light, on_light) > 4.5, "{name}");
            assert!(contrast(dark, on_dark) > 4.5, "{name}");
        }
    }
}
