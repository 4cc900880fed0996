//! `lss identify stiffness`: a joint's K and n from a static test.

use crate::base::number::{fixed, shortest, trimmed};
use crate::cli::{Outcome, OutputFormat, could_not, report};
use crate::identify::static_test::{self, Direction, Points};
use crate::identify::stiffness::{Estimate, Fixed, Unfit, fit, fit_with};
use crate::source::{SIZE_LIMIT, disk, root, shown};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Fit a joint's stiffness to a static test: force = K deformation^n, axial and radial.
///
/// FILE has the columns direction (axial or radial), deformation (m) and force (N). The joint that is written takes
/// what a static test does not tell from std.joints.ball_joint, and its exponents are 1, 1.5 or 2, with K fitted anew.
#[derive(Debug, clap::Args)]
pub struct Stiffness {
    /// The test, .csv.
    file: PathBuf,
    /// Layout file to write the joint to.
    #[arg(short, long, value_name = "FILE.lss")]
    output: Option<PathBuf>,
    /// The direction of a test without that column, or the one to take of both.
    #[arg(long, value_enum, value_name = "NAME")]
    direction: Option<Direction>,
    /// How the fit is written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
}

/// The fits in JSON.
#[derive(Serialize)]
struct Report {
    joint: String,
    directions: BTreeMap<&'static str, Fit>,
}

#[derive(Serialize)]
struct Fit {
    points: usize,
    stiffness: Interval,
    exponent: Interval,
    correlation: f64,
    rms: f64,
    r_squared: f64,
    declared: Declared,
}

/// An estimate with its 90 % interval.
#[derive(Serialize)]
struct Interval {
    value: f64,
    low: f64,
    high: f64,
}

/// What stands in the joint.
#[derive(Serialize)]
struct Declared {
    stiffness: f64,
    exponent: f64,
    rms: f64,
}

impl Stiffness {
    pub fn run(&self) -> Outcome {
        let bytes = match root::read_given(&self.file, SIZE_LIMIT) {
            Ok(bytes) => bytes,
            Err(why) => return could_not("read", &self.file, why),
        };
        let test = match static_test::read(&bytes, &self.file, self.direction) {
            Ok(test) => test,
            Err(mistake) => {
                report::error(&mistake.to_string());
                return Outcome::Problems;
            }
        };
        let mut directions = BTreeMap::new();
        for (direction, points) in &test {
            match Fit::new(points) {
                Ok(fit) => {
                    directions.insert(direction.name(), fit);
                }
                Err(unfit) => {
                    report::error(&format!("{}, {}: {unfit}", shown(&self.file), direction.name()));
                    return Outcome::Problems;
                }
            }
        }
        let report = Report { joint: joint(&self.file), directions };
        let declaration = report.declaration();
        if let Some(path) = &self.output
            && let Err(error) = disk::replace(path, declaration.as_bytes())
        {
            return could_not("write", path, error.reason);
        }
        report::print(&match self.format {
            OutputFormat::Json => serde_json::to_string(&report).unwrap_or_default() + "\n",
            OutputFormat::Text => match &self.output {
                Some(path) => format!("{}\nwritten to {}\n", report.table(), shown(path)),
                None => format!("{}\n{declaration}", report.table()),
            },
        });
        Outcome::Clean
    }
}

impl Fit {
    fn new(points: &Points) -> Result<Fit, Unfit> {
        let (d, f) = (&points.deformation, &points.force);
        let found = fit(d, f)?;
        let declared = declared(d, f, found.exponent.value)?;
        Ok(Fit {
            points: found.points,
            stiffness: Interval::new(found.stiffness),
            exponent: Interval::new(found.exponent),
            correlation: found.correlation,
            rms: found.rms,
            r_squared: found.r_squared,
            declared: Declared { stiffness: declared.stiffness, exponent: declared.exponent, rms: declared.rms },
        })
    }
}

/// The better of the exponents beside n that the language has.
fn declared(deformation: &[f64], force: &[f64], exponent: f64) -> Result<Fixed, Unfit> {
    let below = (2.0 * exponent).floor() / 2.0;
    let [a, b] = [below, below + 0.5].map(|n| fit_with(deformation, force, n.clamp(LEAST, MOST)));
    let (a, b) = (a?, b?);
    Ok(if b.rms < a.rms { b } else { a })
}

/// Exponents that a contact of the language may have.
const LEAST: f64 = 1.0;
const MOST: f64 = 2.0;

impl Interval {
    fn new(of: Estimate) -> Self {
        Interval { value: of.value, low: of.low, high: of.high }
    }
}

impl Report {
    /// A row a direction, and what is declared of it.
    fn table(&self) -> String {
        let mut out = format!(
            "{:<9} {:>6} {:>13}  {:<26} {:>7}  {:<18} {:>11} {:>9} {:>8}\n",
            "direction", "points", "K, N/m^n", "90 % interval", "n", "90 % interval", "correlation", "RMS, N", "R²"
        );
        for (direction, fit) in &self.directions {
            let (k, n) = (&fit.stiffness, &fit.exponent);
            out += &format!(
                "{direction:<9} {:>6} {:>13}  {:<26} {:>7}  {:<18} {:>11} {:>9} {:>8}\n",
                fit.points,
                digits(k.value),
                format!("{} to {}", digits(k.low), digits(k.high)),
                fixed(n.value, 3),
                format!("{} to {}", fixed(n.low, 3), fixed(n.high, 3)),
                fixed(fit.correlation, 4),
                trimmed(fit.rms, 3),
                fixed(fit.r_squared, 5),
            );
        }
        out += "\nA layout's exponents are 1, 1.5 or 2. With the better one, and K fitted anew:\n";
        for (direction, fit) in &self.directions {
            let declared = &fit.declared;
            out += &format!(
                "{direction:<9} K = {} N/{}, RMS {} N instead of {} N\n",
                digits(declared.stiffness),
                metres(declared.exponent),
                trimmed(declared.rms, 3),
                trimmed(fit.rms, 3)
            );
        }
        out
    }

    /// The joint as a layout declares it.
    fn declaration(&self) -> String {
        let mut out =
            "// Fitted to a static test; restitution and approach floor are those of ball_joint.\n".to_owned();
        out += &format!("use std.joints.ball_joint\n\njoint {} from ball_joint {{\n", self.joint);
        for (direction, fit) in &self.directions {
            let Declared { stiffness, exponent, .. } = fit.declared;
            // Six digits are more than any test tells.
            let scale = 1e6 / tens(stiffness);
            let stiffness = shortest((stiffness * scale).round() / scale);
            out += &format!(
                "  {direction} {{\n    stiffness = {stiffness} N/{}\n    exponent = {}\n  }}\n",
                metres(exponent),
                shortest(exponent)
            );
        }
        out + "}\n"
    }
}

/// The power of ten above a number.
fn tens(value: f64) -> f64 {
    let mut ten = 1.0;
    while ten <= value && ten < 1e300 {
        ten *= 10.0;
    }
    ten
}

/// Four digits and a power of ten.
fn digits(value: f64) -> String {
    format!("{value:.3e}")
}

/// `m^1.5`
fn metres(exponent: f64) -> String {
    if exponent == 1.0 { "m".to_owned() } else { format!("m^{}", shortest(exponent)) }
}

/// The file's name as a name of the language, and not the one of the joint that it is made from.
fn joint(file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let name: String = stem.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if name == "ball_joint" || !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        format!("joint_{name}")
    } else {
        name
    }
}
