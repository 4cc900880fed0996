//! `track.glb`: the layout in space as glTF 2.0 in one binary file (Khronos Group 2021), for CAD and viewers: a node a
//! piece of track with its article, supports, motors, stations, conveyors, the clearance volume, building and obstacles.
//!
//! glTF has y up: x is x, y is the height, and z points against the layout's y. Lengths are metres.

mod mesh;
#[cfg(test)]
mod tests;

use crate::base::number::tidy;
use crate::base::trig;
use crate::compiled::{Compiled, Station};
use crate::geometry::Point;
use crate::model::Chutes;
use crate::placement::Placed;
use mesh::{Mesh, Section};
use nalgebra::Vector3;
use serde_json::{Value, json};

/// Beams of a track: as wide as the running wheels stand apart, with this on either side, and this deep, m.
const RAIL: f64 = 0.05;
const DEPTH: f64 = 0.16;
/// Sides of a support's post, m.
const POST: f64 = 0.10;
/// What stands along the track is drawn as deep and as high as this, m; layouts do not give its size.
const STATION: [f64; 3] = [0.8, 1.2, 1.0];
/// A conveyor is drawn as wide and as high as this, m; layouts give neither.
const CONVEYOR: [f64; 2] = [0.6, 0.1];
/// Height of walls, m; layouts do not give it.
const WALLS: f64 = 3.0;

/// Looks: name, colour and opacity.
const LOOKS: [(&str, [f64; 4]); 8] = [
    ("track", [0.55, 0.58, 0.62, 1.0]),
    ("support", [0.30, 0.33, 0.38, 1.0]),
    ("motor", [0.85, 0.45, 0.10, 1.0]),
    ("station", [0.15, 0.45, 0.75, 1.0]),
    ("conveyor", [0.45, 0.60, 0.30, 1.0]),
    ("clearance", [0.20, 0.65, 0.35, 0.18]),
    ("building", [0.75, 0.75, 0.75, 0.25]),
    ("obstacle", [0.75, 0.25, 0.25, 0.6]),
];

/// The file. The same layout gives the same bytes.
pub fn scene(compiled: &Compiled) -> Vec<u8> {
    let mut scene = Scene::default();
    let groups = [
        scene.group("track", track(compiled)),
        scene.group("supports", supports(compiled)),
        scene.group("motors", motors(compiled)),
        scene.group("stations", stations(compiled)),
        scene.group("conveyors", conveyors(compiled)),
        scene.group("clearance volume", clearance(compiled)),
        scene.group("hall", hall(compiled)),
    ];
    scene.file(&compiled.layout.name, groups.into_iter().flatten().collect())
}

/// A thing of the scene.
struct Thing {
    name: String,
    look: &'static str,
    mesh: Mesh,
    /// What a reader may ask of it.
    extras: Value,
}

impl Thing {
    fn new(name: impl Into<String>, look: &'static str, mesh: Mesh) -> Self {
        Thing { name: name.into(), look, mesh, extras: Value::Null }
    }
}

/// Half the width of the track's beams, m.
fn half_width(compiled: &Compiled) -> f64 {
    compiled.layout.cart.running.half_spacing + RAIL
}

/// How far below the centre line the rails lie that the wheels run on, m.
fn below(compiled: &Compiled) -> f64 {
    let wheel = &compiled.layout.cart.running;
    wheel.height + wheel.radius
}

fn track(compiled: &Compiled) -> Vec<Thing> {
    let top = -below(compiled);
    let section = Section { half_width: half_width(compiled), low: top - DEPTH, high: top };
    let piece = |(i, piece): (usize, &crate::elements::OrderedPiece)| {
        let (begin, length) = (compiled.space.from_plan(piece.place.s), piece.part.length());
        let mesh = Mesh::along(&compiled.space.line, begin, length, section);
        let s = compiled.past_start(piece.place.s);
        let extras = json!({ "article": piece.article, "s_m": s, "length_m": tidy(length) });
        Thing { extras, ..Thing::new(format!("{} {}", i + 1, piece.article), "track", mesh) }
    };
    compiled.pieces.iter().enumerate().map(piece).collect()
}

/// Posts from the floor to the track; none where the track lies on the floor, as in a layout without levels.
fn supports(compiled: &Compiled) -> Vec<Thing> {
    let under = below(compiled) + DEPTH;
    let post = |(i, station): (usize, Station)| {
        let height = station.z - under;
        let foot = Vector3::new(station.point.x, station.point.y, 0.0);
        (height > 0.0).then(|| {
            let mesh = Mesh::block(foot, station.heading, [POST, 2.0 * half_width(compiled), height]);
            let extras = json!({ "s_m": station.s, "height_m": tidy(height) });
            Thing { extras, ..Thing::new(format!("support {}", i + 1), "support", mesh) }
        })
    };
    compiled.supports().into_iter().enumerate().filter_map(post).collect()
}

fn motors(compiled: &Compiled) -> Vec<Thing> {
    let motor = &compiled.layout.drive.motor;
    let half = compiled.layout.cart.running.half_spacing / 2.0;
    let height = -compiled.layout.cart.motor_height;
    let section = Section { half_width: half, low: height - DEPTH / 2.0, high: height };
    let one = |(j, station): (usize, Station)| {
        let mesh = Mesh::along(&compiled.space.line, station.s + compiled.start(), motor.length, section);
        let extras = json!({ "s_m": station.s, "length_m": motor.length, "force_N": motor.force });
        Thing { extras, ..Thing::new(format!("M{}", j + 1), "motor", mesh) }
    };
    compiled.motors().into_iter().enumerate().map(one).collect()
}

/// Where a block of this height beside the track stands, m: under a raised track it hangs with its top at the track's
/// height, and nowhere does it reach below the hall's floor, which is at 0.
fn foot(z: f64, up: f64) -> f64 {
    (z - up).max(z.min(0.0))
}

/// Inductions, chutes and the photocell, as blocks beside the track: to the right, where layouts say nothing else.
fn stations(compiled: &Compiled) -> Vec<Thing> {
    let equipment = &compiled.layout.equipment;
    let own = |name: &str| equipment.declared.iter().all(|declared| declared.name != name);
    let up = STATION[2];
    let sized = |name: String, station: &Station, (along, across, side): (f64, f64, f64)| {
        let aside = Point::unit(station.heading).left() * (side * (compiled.layout.width.value / 2.0 + across / 2.0));
        let foot = Vector3::new(station.point.x + aside.x, station.point.y + aside.y, foot(station.z, up));
        let mesh = Mesh::block(foot, station.heading, [along, across, up]);
        Thing { extras: json!({ "s_m": station.s }), ..Thing::new(name, "station", mesh) }
    };
    let block = |name: String, station: &Station, along: f64| sized(name, station, (along, STATION[1], -1.0));
    let row = |name: &str, chutes: &Chutes| -> Vec<Thing> {
        let along = STATION[0].min(0.9 * chutes.row.every.max(0.1));
        let all = compiled.chutes(chutes);
        all.iter().enumerate().map(|(i, station)| block(format!("{name} {}", i + 1), station, along)).collect()
    };
    let mut things: Vec<Thing> = equipment
        .inductions
        .iter()
        .filter(|i| own(&i.name))
        .map(|i| block(format!("induction {}", i.name), &compiled.station(i.place), STATION[0]))
        .collect();
    things.extend(equipment.chutes.iter().filter(|c| own(&c.name)).flat_map(|c| row(&format!("chute {}", c.name), c)));
    for placed in &compiled.placement.placed {
        let declared = &equipment.declared[placed.declared];
        let name = format!("{} {}", declared.of.kind.word(), declared.one(placed.number));
        let station = compiled.station(placed.place);
        let size = |side: &f64| (declared.of.stretch, declared.of.depth.max(0.01), *side);
        things.extend(placed.sides.iter().map(|side| sized(name.clone(), &station, size(side))));
    }
    things.extend(equipment.photocell.map(|place| block("photocell".into(), &compiled.station(place), 0.1)));
    things
}

/// The conveyors that feed equipment, straight from where they begin, on top of the height of the block that they end at.
fn conveyors(compiled: &Compiled) -> Vec<Thing> {
    let declared = &compiled.layout.equipment.declared;
    let [across, up] = CONVEYOR;
    let one = |placed: &Placed| {
        let declared = &declared[placed.declared];
        let from = declared.fed?;
        let to = placed.footprint.conveyor_end(from)?;
        let length = from.distance(to);
        let top = foot(compiled.station(placed.place).z, STATION[2]) + STATION[2];
        (length > 1e-6).then(|| {
            let (middle, way) = (from.lerp(to, 0.5), to - from);
            let base = Vector3::new(middle.x, middle.y, top - up);
            let mesh = Mesh::block(base, trig::atan2(way.y, way.x), [length, across, up]);
            let name = format!("conveyor to {}", declared.one(placed.number));
            Thing { extras: json!({ "length_m": tidy(length) }), ..Thing::new(name, "conveyor", mesh) }
        })
    };
    compiled.placement.placed.iter().filter_map(one).collect()
}

/// What carts with their load may fill: as wide as the layout says, from the rails up to the beams of a section that
/// crosses above at the catalogue's headroom.
fn clearance(compiled: &Compiled) -> Vec<Thing> {
    let (half, top) = (compiled.layout.width.value / 2.0, compiled.layout.catalog.headroom);
    let section = Section { half_width: half, low: -below(compiled), high: top - below(compiled) - DEPTH };
    let line = &compiled.space.line;
    (top > 0.0)
        .then(|| Thing::new("swept by carts", "clearance", Mesh::along(line, 0.0, line.length, section)))
        .into_iter()
        .collect()
}

fn hall(compiled: &Compiled) -> Vec<Thing> {
    let layout = &compiled.layout;
    let building =
        layout.building.iter().map(|b| Thing::new("building", "building", Mesh::walls(b.polygon.points(), WALLS)));
    let obstacles = layout.obstacles.iter();
    let obstacles = obstacles.map(|o| Thing::new(o.name.clone(), "obstacle", Mesh::walls(o.polygon.points(), WALLS)));
    building.chain(obstacles).collect()
}

/// What is collected for the file.
#[derive(Default)]
struct Scene {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

/// glTF's words for numbers of 4 bytes and for arrays of vertices.
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;

impl Scene {
    /// A node with a child a thing; `None` without things.
    fn group(&mut self, name: &str, things: Vec<Thing>) -> Option<usize> {
        let children: Vec<usize> = things.into_iter().map(|thing| self.thing(thing)).collect();
        (!children.is_empty()).then(|| self.node(json!({ "name": name, "children": children })))
    }

    fn node(&mut self, node: Value) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    fn thing(&mut self, thing: Thing) -> usize {
        let position = self.vectors(&thing.mesh.positions, true);
        let normal = self.vectors(&thing.mesh.normals, false);
        let material = LOOKS.iter().position(|(name, _)| *name == thing.look).unwrap_or(0);
        let attributes = json!({ "POSITION": position, "NORMAL": normal });
        self.meshes.push(json!({ "primitives": [{ "attributes": attributes, "material": material }] }));
        let mut node = json!({ "name": thing.name, "mesh": self.meshes.len() - 1 });
        if !thing.extras.is_null() {
            node["extras"] = thing.extras;
        }
        self.node(node)
    }

    /// An accessor of vectors, turned so that y is up; with their limits where positions ask for them.
    fn vectors(&mut self, vectors: &[Vector3<f64>], limits: bool) -> usize {
        let begin = self.binary.len();
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for vector in vectors {
            let turned = [vector.x, vector.z, -vector.y].map(|value| value as f32 + 0.0);
            for k in 0..3 {
                (low[k], high[k]) = (low[k].min(turned[k]), high[k].max(turned[k]));
                self.binary.extend(turned[k].to_le_bytes());
            }
        }
        let length = self.binary.len() - begin;
        self.views.push(json!({ "buffer": 0, "byteOffset": begin, "byteLength": length, "target": ARRAY_BUFFER }));
        let view = self.views.len() - 1;
        let mut accessor = json!({
            "bufferView": view, "componentType": FLOAT, "count": vectors.len(), "type": "VEC3",
        });
        if limits {
            accessor["min"] = json!(low);
            accessor["max"] = json!(high);
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// The file: a header, the scene as JSON, and the numbers (glTF 2.0, 4.4).
    fn file(self, name: &str, roots: Vec<usize>) -> Vec<u8> {
        let material = |(name, colour): &(&str, [f64; 4])| {
            let solid = colour[3] == 1.0;
            json!({
                "name": name,
                "pbrMetallicRoughness": { "baseColorFactor": colour, "metallicFactor": 0.0, "roughnessFactor": 0.8 },
                "alphaMode": if solid { "OPAQUE" } else { "BLEND" },
                "doubleSided": !solid,
            })
        };
        let scene = json!({
            "asset": { "version": "2.0", "generator": "lss" },
            "scene": 0,
            "scenes": [{ "name": name, "nodes": roots }],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": LOOKS.iter().map(material).collect::<Vec<_>>(),
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{ "byteLength": self.binary.len() }],
        });
        let mut text = scene.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut file = Vec::new();
        let word = |file: &mut Vec<u8>, value: usize| file.extend((value as u32).to_le_bytes());
        file.extend(b"glTF");
        word(&mut file, 2);
        word(&mut file, 12 + 8 + text.len() + 8 + self.binary.len());
        word(&mut file, text.len());
        file.extend(b"JSON");
        file.extend(text);
        word(&mut file, self.binary.len());
        file.extend(b"BIN\0");
        file.extend(self.binary);
        file
    }
}
