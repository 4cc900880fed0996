//! Sections of a drawing: its unit, its blocks, and the entities of model space with inserted blocks in their places.

use std::collections::{BTreeMap, BTreeSet};

use super::shapes::{self, Items, Placement, Raw};
use super::tags::{self, Tag};
use super::unit::LengthUnit;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::Point;
use crate::source::{FileId, Span};

/// Blocks in blocks are followed so far.
const DEEPEST: usize = 16;
/// Entities, inserted ones counted each time.
const MOST: usize = 200_000;

/// What of a drawing matters here, in its own unit.
#[derive(Clone, Debug)]
pub struct Drawing {
    pub unit: Option<LengthUnit>,
    /// Where the unit stands, or would.
    pub unit_span: Span,
    pub begin: Span,
    /// Layers with lines or arcs, in alphabetical order.
    pub layers: Vec<String>,
    items: Items,
}

struct Block<'a> {
    base: Point,
    entities: Vec<Raw<'a>>,
}

/// Where entities are put and what there was room for.
struct Reader<'a, 'b> {
    blocks: BTreeMap<String, Block<'a>>,
    wanted: &'b [&'b str],
    items: Items,
    layers: BTreeSet<String>,
    count: usize,
    said: &'b mut Vec<Diagnostic>,
}

impl Drawing {
    /// Reads the shapes on the `wanted` layers, and points and texts on all; `None` with a diagnostic when the text
    /// is no drawing.
    pub fn read(file: FileId, text: &str, wanted: &[&str], said: &mut Vec<Diagnostic>) -> Option<Drawing> {
        let begin = Span::new(file, 0, text.lines().next().map_or(0, |line| line.trim_end().len()));
        if let Some(found) = tags::other_format(text) {
            said.push(
                Diagnostic::new(Code::E0801, "this is not a DXF text file", begin, "begins like this")
                    .expected("DXF as ASCII text", found)
                    .help("save the drawing as DXF, as ASCII text"),
            );
            return None;
        }
        let tags = match tags::tags(file, text) {
            Ok(tags) => tags,
            Err(why) => {
                said.push(*why);
                return None;
            }
        };
        let sections = sections(&tags);
        let (unit, unit_span) = sections.get("HEADER").map_or((None, begin), |header| unit(header, begin));
        let Some(entities) = sections.get("ENTITIES") else {
            said.push(
                Diagnostic::new(Code::E0801, "the drawing has no entities", begin, "in this file")
                    .expected("a section `ENTITIES`", "none")
                    .help("save the drawing as DXF again, as ASCII text"),
            );
            return None;
        };
        let blocks = sections.get("BLOCKS").map(|tags| blocks(tags)).unwrap_or_default();
        let mut reader = Reader { blocks, wanted, items: Items::default(), layers: BTreeSet::new(), count: 0, said };
        let entities = raw(entities);
        reader.place(&entities, &Placement::default(), None, 0);
        let layers = reader.layers.into_iter().collect();
        Some(Drawing { unit, unit_span, begin, layers, items: reader.items })
    }

    /// The shapes with lengths multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Items {
        self.items.scaled(factor)
    }
}

/// The tags of each section by its name; of two of one name, the first.
fn sections<'t, 'a>(tags: &'t [Tag<'a>]) -> BTreeMap<&'a str, &'t [Tag<'a>]> {
    let mut found = BTreeMap::new();
    let mut open: Option<(&str, usize)> = None;
    for (i, tag) in tags.iter().enumerate() {
        if tag.is(0, "SECTION") {
            open = tags.get(i + 1).filter(|name| name.code == 2).map(|name| (name.value, i + 2));
        } else if tag.is(0, "ENDSEC")
            && let Some((name, from)) = open.take()
            && let Some(inside) = tags.get(from..i)
        {
            found.entry(name).or_insert(inside);
        }
    }
    if let Some((name, from)) = open
        && let Some(inside) = tags.get(from..)
    {
        found.entry(name).or_insert(inside);
    }
    found
}

fn unit(header: &[Tag], begin: Span) -> (Option<LengthUnit>, Span) {
    let stated = header.iter().position(|tag| tag.is(9, "$INSUNITS")).and_then(|i| header.get(i + 1));
    stated.map_or((None, begin), |tag| (tag.int().ok().and_then(LengthUnit::from_header), tag.span))
}

/// Entities one after the other; the vertices of an old polyline belong to it.
fn raw<'t, 'a>(tags: &'t [Tag<'a>]) -> Vec<Raw<'a>>
where
    't: 'a,
{
    let starts: Vec<usize> = (0..tags.len()).filter(|&i| tags[i].code == 0).collect();
    let mut list: Vec<Raw> = Vec::new();
    for (k, &start) in starts.iter().enumerate() {
        let end = starts.get(k + 1).copied().unwrap_or(tags.len());
        let (kind, inside) = (&tags[start], &tags[start + 1..end]);
        let entity = Raw { kind: kind.value, span: kind.span, tags: inside, vertices: Vec::new() };
        match list.last_mut() {
            Some(polyline) if kind.is(0, "VERTEX") && polyline.kind.eq_ignore_ascii_case("POLYLINE") => {
                polyline.vertices.push(entity);
            }
            _ => list.push(entity),
        }
    }
    list
}

fn blocks<'t, 'a>(tags: &'t [Tag<'a>]) -> BTreeMap<String, Block<'a>>
where
    't: 'a,
{
    let mut found = BTreeMap::new();
    let mut open: Option<(String, Block)> = None;
    for entity in raw(tags) {
        match entity.kind {
            "BLOCK" => {
                let name = entity.text(2).unwrap_or_default().to_ascii_uppercase();
                let base = Point::new(entity.real_or(10, 0.0), entity.real_or(20, 0.0));
                open = Some((name, Block { base, entities: Vec::new() }));
            }
            "ENDBLK" => found.extend(open.take()),
            _ => {
                if let Some((_, block)) = &mut open {
                    block.entities.push(entity);
                }
            }
        }
    }
    found
}

impl<'a> Reader<'a, '_> {
    /// Takes over entities at a place. `outer` is the layer of the insert: what a block has on layer 0 lies on it.
    fn place(&mut self, entities: &[Raw<'a>], placement: &Placement, outer: Option<&str>, depth: usize) {
        for entity in entities {
            self.count += 1;
            if self.count > MOST {
                if self.count == MOST + 1 {
                    self.said.push(
                        Diagnostic::new(Code::E0309, "the drawing is too large", entity.span, "no further")
                            .expected(format!("at most {MOST} entities, with blocks counted each time"), "more"),
                    );
                }
                return;
            }
            if entity.hidden() {
                continue;
            }
            let own = entity.text(8).unwrap_or("0");
            let layer = outer.filter(|_| own == "0").unwrap_or(own);
            if entity.kind.eq_ignore_ascii_case("INSERT") {
                self.insert(entity, placement, layer, depth);
                continue;
            }
            if matches!(entity.kind, "LINE" | "ARC" | "LWPOLYLINE" | "POLYLINE" | "CIRCLE") {
                self.layers.insert(layer.to_string());
            }
            let wanted = self.wanted.iter().any(|name| name.eq_ignore_ascii_case(layer));
            if let Err(why) = shapes::read(entity, layer, placement, wanted, &mut self.items) {
                self.said.push(*why);
            }
        }
    }

    fn insert(&mut self, entity: &Raw<'a>, placement: &Placement, layer: &str, depth: usize) {
        let name = entity.text(2).unwrap_or_default().to_ascii_uppercase();
        if depth >= DEEPEST {
            self.items.refuse(entity, layer, "a block in a block in a block, too deep to follow");
            return;
        }
        // Taken out while it is placed, so that a block which inserts itself ends there.
        let Some(block) = self.blocks.remove(&name) else { return };
        let count = |code| entity.real_or(code, 1.0).clamp(1.0, 1000.0) as usize;
        for (column, row) in (0..count(70)).flat_map(|c| (0..count(71)).map(move |r| (c, r))) {
            if self.count > MOST {
                break;
            }
            let inserted = placement.insert(entity, block.base, column, row);
            self.place(&block.entities, &inserted, Some(layer), depth + 1);
            self.count += 1;
        }
        self.blocks.insert(name, block);
    }
}
