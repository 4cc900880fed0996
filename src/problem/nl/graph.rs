//! Expressions as a graph in which equal parts are one node.

use super::super::affine::Affine;
use std::collections::{BTreeMap, BTreeSet};

/// A node of a [`Graph`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Id(usize);

/// A point or vector of the plane.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    pub x: Id,
    pub y: Id,
}

/// An operator, by its `.nl` opcode (Gay 2005, "Writing .nl files", table 6).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Operator {
    Add = 0,
    Subtract = 1,
    Multiply = 2,
    Divide = 3,
    Least = 11,
    Greatest = 12,
    Absolute = 15,
    Negate = 16,
    Tangent = 38,
    SquareRoot = 39,
    /// Of (y, x).
    ArcTangent = 48,
    Sum = 54,
}

impl Operator {
    /// Whether the number of operands is written with it.
    pub fn takes_a_list(self) -> bool {
        matches!(self, Operator::Least | Operator::Greatest | Operator::Sum)
    }
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Node {
    /// By its bits, which have an order.
    Number(u64),
    Variable(usize),
    Apply(Operator, Vec<Id>),
}

#[derive(Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    known: BTreeMap<Node, Id>,
}

impl Graph {
    pub fn node(&self, id: Id) -> &Node {
        &self.nodes[id.0]
    }

    fn intern(&mut self, node: Node) -> Id {
        if let Some(&id) = self.known.get(&node) {
            return id;
        }
        let id = Id(self.nodes.len());
        self.nodes.push(node.clone());
        self.known.insert(node, id);
        id
    }

    pub fn number(&mut self, value: f64) -> Id {
        self.intern(Node::Number(crate::base::number::normal(value).to_bits()))
    }

    pub fn variable(&mut self, index: usize) -> Id {
        self.intern(Node::Variable(index))
    }

    pub fn apply<const N: usize>(&mut self, operator: Operator, operands: [Id; N]) -> Id {
        self.intern(Node::Apply(operator, operands.to_vec()))
    }

    /// A sum, or the least or greatest of a list; of an empty one it is 0.
    pub fn list(&mut self, operator: Operator, terms: Vec<Id>) -> Id {
        match terms[..] {
            [] => self.number(0.0),
            [only] => only,
            // The format's sum of a list wants three.
            [a, b] if operator == Operator::Sum => self.add(a, b),
            _ => self.intern(Node::Apply(operator, terms)),
        }
    }

    pub fn add(&mut self, a: Id, b: Id) -> Id {
        self.apply(Operator::Add, [a, b])
    }

    pub fn subtract(&mut self, a: Id, b: Id) -> Id {
        self.apply(Operator::Subtract, [a, b])
    }

    pub fn multiply(&mut self, a: Id, b: Id) -> Id {
        self.apply(Operator::Multiply, [a, b])
    }

    pub fn scale(&mut self, k: f64, a: Id) -> Id {
        if k == 1.0 {
            a
        } else if k == -1.0 {
            self.apply(Operator::Negate, [a])
        } else {
            let k = self.number(k);
            self.multiply(k, a)
        }
    }

    pub fn between(&mut self, from: Plane, to: Plane) -> Plane {
        Plane { x: self.subtract(to.x, from.x), y: self.subtract(to.y, from.y) }
    }

    pub fn dot(&mut self, a: Plane, b: Plane) -> Id {
        let (x, y) = (self.multiply(a.x, b.x), self.multiply(a.y, b.y));
        self.add(x, y)
    }

    pub fn cross(&mut self, a: Plane, b: Plane) -> Id {
        let (p, q) = (self.multiply(a.x, b.y), self.multiply(a.y, b.x));
        self.subtract(p, q)
    }

    pub fn norm(&mut self, a: Plane) -> Id {
        let square = self.dot(a, a);
        self.apply(Operator::SquareRoot, [square])
    }

    /// The parts a node is made of.
    pub fn operands(&self, id: Id) -> &[Id] {
        match self.node(id) {
            Node::Apply(_, operands) => operands,
            Node::Number(_) | Node::Variable(_) => &[],
        }
    }

    /// The nodes that each of `roots` reaches, itself among them; ascending, so parts come before what they are part
    /// of.
    pub fn reach(&self, roots: &[Id]) -> BTreeSet<Id> {
        let mut seen = BTreeSet::new();
        let mut open = roots.to_vec();
        while let Some(id) = open.pop() {
            if seen.insert(id) {
                open.extend_from_slice(self.operands(id));
            }
        }
        seen
    }

    /// The variables an expression depends on.
    pub fn variables(&self, id: Id) -> BTreeSet<usize> {
        let variable = |id: Id| if let Node::Variable(k) = self.node(id) { Some(*k) } else { None };
        self.reach(&[id]).into_iter().filter_map(variable).collect()
    }

    /// The expression as a linear one, if it is made of sums and multiples only.
    pub fn affine(&self, id: Id) -> Option<Affine> {
        let parts = || self.operands(id).iter().map(|&part| self.affine(part)).collect::<Option<Vec<_>>>();
        match self.node(id) {
            Node::Number(bits) => Some(Affine { constant: f64::from_bits(*bits), ..Affine::default() }),
            Node::Variable(k) => Some(Affine { terms: BTreeMap::from([(*k, 1.0)]), constant: 0.0 }),
            Node::Apply(Operator::Add | Operator::Sum, _) => {
                Some(parts()?.iter().fold(Affine::default(), |sum, part| sum.plus(1.0, part)))
            }
            Node::Apply(Operator::Negate, _) => Some(Affine::default().plus(-1.0, &parts()?[0])),
            Node::Apply(Operator::Subtract, _) => {
                let parts = parts()?;
                Some(parts[0].clone().plus(-1.0, &parts[1]))
            }
            Node::Apply(Operator::Multiply, _) => {
                let parts = parts()?;
                let (k, of) = if parts[0].terms.is_empty() { (&parts[0], &parts[1]) } else { (&parts[1], &parts[0]) };
                k.terms.is_empty().then(|| Affine::default().plus(k.constant, of))
            }
            Node::Apply(..) => None,
        }
    }
}
