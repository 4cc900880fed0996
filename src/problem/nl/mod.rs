//! AMPL's `.nl` format, text form (Gay 2005, "Writing .nl files", SAND2005-7907P): the continuous stages for any solver
//! that reads it.
//!
//! The file holds every variable, the objective, and every row as an expression, exact and in closed form. Clearance
//! rows depend on where the track runs; those within [`REACH`](rows::REACH) of their limit at the point given are in
//! it, each about the same corner, edge and part of the track as there, for good. So the file is one smooth problem
//! that agrees with ours around that point, and a layout that a solver finds far from it must be checked again.

mod graph;
mod rows;
mod shapes;

use super::affine::Affine;
use super::{Problem, RowKey};
use graph::{Graph, Id, Node};
use rows::Frozen;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// A problem in three files with one stem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Nl {
    /// `.nl`
    pub model: String,
    /// `.row`: names of the constraints in the file's order, then the objective's.
    pub rows: String,
    /// `.col`: names of the variables in the file's order.
    pub columns: String,
}

/// Writes a problem with the variables `start` for a solver to begin at, its clearance rows chosen at `at`.
pub fn write(problem: &Problem, start: &[f64], at: &[f64]) -> Nl {
    let frozen = Frozen::new(problem, at);
    let file = File::new(problem, &frozen);
    let names = file.names();
    let columns: Vec<String> = (0..problem.start.len()).map(|k| problem.variable_name(k)).collect();
    Nl { model: file.text(&names, &columns, start), rows: lines(&names) + "length\n", columns: lines(&columns) }
}

fn lines(names: &[String]) -> String {
    names.iter().map(|name| format!("{name}\n")).collect()
}

/// A constraint in the file's terms.
struct Constraint {
    key: RowKey,
    low: f64,
    high: f64,
    /// `None` where the row is linear.
    body: Option<Id>,
    /// Every variable the row depends on, with its coefficient in the linear part.
    linear: BTreeMap<usize, f64>,
}

struct File<'p> {
    problem: &'p Problem,
    graph: &'p Graph,
    objective: Id,
    /// Nonlinear ones first, as the format wants.
    constraints: Vec<Constraint>,
    nonlinear: usize,
    /// Parts that several others use, in the order of their definition, and how many of them the objective uses, too.
    shared: Vec<Id>,
    shared_by_both: usize,
}

impl<'p> File<'p> {
    fn new(problem: &'p Problem, frozen: &'p Frozen) -> Self {
        let graph = &frozen.graph;
        let constraint = |row: &rows::Written| {
            let (body, linear) = match graph.affine(row.body) {
                Some(Affine { terms, constant: 0.0 }) => (None, terms),
                _ => (Some(row.body), graph.variables(row.body).into_iter().map(|k| (k, 0.0)).collect()),
            };
            Constraint { key: row.key, low: row.low, high: row.high, body, linear }
        };
        let (mut constraints, linear): (Vec<_>, Vec<_>) =
            frozen.rows.iter().map(constraint).partition(|c| c.body.is_some());
        let nonlinear = constraints.len();
        constraints.extend(linear);
        let bodies: Vec<Id> = constraints.iter().filter_map(|c| c.body).collect();
        let (shared, shared_by_both) = shared(graph, &bodies, frozen.objective);
        File { problem, graph, objective: frozen.objective, constraints, nonlinear, shared, shared_by_both }
    }

    /// Names as `--emit problem` says them, without spaces, each once.
    fn names(&self) -> Vec<String> {
        let mut taken: BTreeMap<String, usize> = BTreeMap::new();
        let name = |c: &Constraint| {
            let label = match c.key {
                RowKey::Listed(i) => self.problem.rows[i].label.clone(),
                key => self.problem.describe(key).0,
            };
            let plain = label.replace(' ', "_");
            let count = taken.entry(plain.clone()).or_insert(0);
            *count += 1;
            if *count == 1 { plain } else { format!("{plain}#{count}") }
        };
        self.constraints.iter().map(name).collect()
    }

    fn text(&self, names: &[String], columns: &[String], start: &[f64]) -> String {
        let mut out = self.header(names, columns);
        let variables = self.problem.start.len();
        for (k, &id) in self.shared.iter().enumerate() {
            let _ = writeln!(out, "V{} 0 0", variables + k);
            self.expression(id, true, &mut out);
        }
        // Some readers take remarks in the header only.
        for (i, constraint) in self.constraints.iter().enumerate() {
            let _ = writeln!(out, "C{i}");
            match constraint.body {
                Some(body) => self.expression(body, false, &mut out),
                None => out += "n0\n",
            }
        }
        out += "O0 0\n";
        self.expression(self.objective, false, &mut out);
        let _ = writeln!(out, "x{variables}");
        for (k, value) in start.iter().enumerate() {
            let _ = writeln!(out, "{k} {}", number(*value));
        }
        out += "r\n";
        self.constraints.iter().for_each(|c| limits(c.low, c.high, &mut out));
        out += "b\n";
        self.problem.bounds.iter().for_each(|b| limits(b.low, b.high, &mut out));
        self.jacobian(&mut out);
        let objective = self.graph.variables(self.objective);
        let _ = writeln!(out, "G0 {}", objective.len());
        objective.iter().for_each(|k| out += &format!("{k} 0\n"));
        out
    }

    fn header(&self, names: &[String], columns: &[String]) -> String {
        let (n, m) = (self.problem.start.len(), self.constraints.len());
        let count = |which: fn(&Constraint) -> bool| self.constraints.iter().filter(|c| which(c)).count();
        let equations = count(|c| c.low == c.high);
        let ranges = count(|c| c.low < c.high && c.low.is_finite() && c.high.is_finite());
        let entries: usize = self.constraints.iter().map(|c| c.linear.len()).sum();
        let gradient = self.graph.variables(self.objective).len();
        let longest = |names: &[String]| names.iter().map(|name| name.len()).max().unwrap_or(0);
        let (both, some) = (self.shared_by_both, self.shared.len() - self.shared_by_both);
        // Every coordinate and radius is in a turn or in a tangent length, and both are in rows and in the objective.
        format!(
            "g3 1 1 0\t# problem {}\n\
             {n} {m} 1 {ranges} {equations}\t# variables, constraints, objectives, ranges, equations\n\
             {} 1\t# nonlinear constraints, objectives\n\
             0 0\t# network constraints: nonlinear, linear\n\
             {n} {n} {n}\t# nonlinear variables in constraints, objectives, both\n\
             0 0 0 1\t# linear network variables; functions; arithmetic, flags\n\
             0 0 0 0 0\t# discrete variables: binary, integer, nonlinear (b, c, o)\n\
             {entries} {gradient}\t# nonzeros in Jacobian, gradients\n\
             {} {}\t# longest names: constraints, variables\n\
             {both} {some} 0 0 0\t# common expressions: b, c, o, c1, o1\n",
            self.problem.layout,
            self.nonlinear,
            longest(names),
            longest(columns),
        )
    }

    /// In prefix form, a part a line. A shared part stands as its variable except where it is defined.
    fn expression(&self, id: Id, define: bool, out: &mut String) {
        if let (false, Ok(k)) = (define, self.shared_index(id)) {
            let _ = writeln!(out, "v{}", self.problem.start.len() + k);
            return;
        }
        match self.graph.node(id) {
            Node::Number(bits) => *out += &format!("n{}\n", number(f64::from_bits(*bits))),
            Node::Variable(k) => *out += &format!("v{k}\n"),
            Node::Apply(operator, operands) => {
                let _ = writeln!(out, "o{}", *operator as u8);
                if operator.takes_a_list() {
                    let _ = writeln!(out, "{}", operands.len());
                }
                operands.iter().for_each(|&part| self.expression(part, false, out));
            }
        }
    }

    fn shared_index(&self, id: Id) -> Result<usize, usize> {
        let (both, some) = self.shared.split_at(self.shared_by_both);
        both.binary_search(&id).or_else(|_| some.binary_search(&id).map(|k| self.shared_by_both + k))
    }

    /// Column counts, then the linear parts row by row.
    fn jacobian(&self, out: &mut String) {
        let n = self.problem.start.len();
        let mut counts = vec![0; n];
        self.constraints.iter().flat_map(|c| c.linear.keys()).for_each(|&k| counts[k] += 1);
        let _ = writeln!(out, "k{}", n - 1);
        let mut before = 0;
        for count in &counts[..n - 1] {
            before += count;
            let _ = writeln!(out, "{before}");
        }
        for (i, constraint) in self.constraints.iter().enumerate().filter(|(_, c)| !c.linear.is_empty()) {
            let _ = writeln!(out, "J{i} {}", constraint.linear.len());
            for (k, coefficient) in &constraint.linear {
                let _ = writeln!(out, "{k} {}", number(*coefficient));
            }
        }
    }
}

/// Parts with several users: first those that both constraints and the objective use, then those of constraints only.
/// Parts come before what they are part of.
fn shared(graph: &Graph, bodies: &[Id], objective: Id) -> (Vec<Id>, usize) {
    let in_constraints = graph.reach(bodies);
    let in_objective = graph.reach(&[objective]);
    let all: BTreeSet<Id> = in_constraints.union(&in_objective).copied().collect();
    let mut users: BTreeMap<Id, usize> = BTreeMap::new();
    let roots = bodies.iter().chain([&objective]);
    for id in all.iter().flat_map(|&id| graph.operands(id)).chain(roots) {
        *users.entry(*id).or_insert(0) += 1;
    }
    let several = |id: &&Id| users.get(id).is_some_and(|&count| count > 1) && !graph.operands(**id).is_empty();
    let (both, some): (Vec<Id>, Vec<Id>) =
        in_constraints.iter().filter(several).partition(|id| in_objective.contains(id));
    let count = both.len();
    (both.into_iter().chain(some).collect(), count)
}

/// A line of bounds (Gay 2005, table 17).
fn limits(low: f64, high: f64, out: &mut String) {
    *out += &match (low.is_finite(), high.is_finite()) {
        _ if low == high => format!("4 {}\n", number(low)),
        (true, true) => format!("0 {} {}\n", number(low), number(high)),
        (false, true) => format!("1 {}\n", number(high)),
        (true, false) => format!("2 {}\n", number(low)),
        (false, false) => "3\n".to_owned(),
    };
}

fn number(value: f64) -> String {
    crate::base::number::shortest(value)
}
