//! Indexed triangles and a tree over them from anywhere: refused by name, or hit exactly as their list is. And a tree that
//! the core builds itself is always accepted.

#![no_main]

use arbitrary::Arbitrary;
use libfuzzer_sys::fuzz_target;
use microlux::bvh::{Node, build_mesh, check_mesh, closest, closest_linear, max_nodes};
use microlux::geom::{Octahedral, Point};
use microlux::shape::{Attributes, Grid, Slopes, TriangleMesh, Triangles};
use microlux_fuzz::Rays;
use zerocopy::FromBytes;

const RAYS: usize = 8;

#[derive(Arbitrary, Debug)]
struct Input {
    origin: [i32; 3],
    shift: u8,
    vertices: Vec<[u16; 3]>,
    triangles: Vec<[u8; 3]>,
    normals: Vec<[i8; 2]>,
    /// A tree of these bytes, 40 a node; or one that the core builds.
    nodes: Option<Vec<[u8; 40]>>,
}

fuzz_target!(|input: Input| {
    let Some(grid) = Grid::new(Point(input.origin), input.shift) else {
        return;
    };
    // Inside the margin, where the core may build; as they are, where the border must say so.
    let inside = |v: [u16; 3]| v.map(|c| c.clamp(Grid::MARGIN, u16::MAX - Grid::MARGIN));
    let built = input.nodes.is_none();
    let vertices: Vec<[u16; 3]> = match built {
        true => input.vertices.iter().copied().map(inside).collect(),
        false => input.vertices,
    };
    let count = vertices.len().max(1) as u16;
    let name = |i: u8| if built { u16::from(i) % count } else { u16::from(i) };
    let mut triangles: Vec<[u16; 3]> = input.triangles.iter().map(|t| t.map(name)).collect();
    if built && vertices.is_empty() {
        return;
    }
    let nodes: Vec<Node> = match input.nodes {
        Some(bytes) => bytes
            .iter()
            .map(|node| Node::read_from_bytes(node).expect("40 bytes are a node"))
            .collect(),
        None => {
            let mut nodes = vec![Node::EMPTY; max_nodes(triangles.len())];
            let used = build_mesh(&vertices, &mut triangles, &mut nodes).expect("there is room");
            nodes.truncate(used);
            nodes
        }
    };
    let normals: Vec<Octahedral> = match built {
        true => Vec::new(),
        false => input.normals.into_iter().map(Octahedral).collect(),
    };
    let mesh = Triangles::Plain(TriangleMesh {
        grid,
        vertices: &vertices,
        triangles: &triangles,
        attributes: Attributes {
            normals: &normals,
            ..Attributes::NONE
        },
    });
    if let Err(error) = check_mesh(&mesh, &nodes) {
        assert!(!built, "the core's own tree is refused: {error}");
        return;
    }
    let seed: Vec<u8> = vertices.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
    for ray in Rays::new(&grid, &seed).take(RAYS) {
        let slopes = Slopes::new(ray.dir);
        let hit = closest(&mesh, &nodes, &ray, &slopes, i32::MAX);
        assert_eq!(hit, closest_linear(&mesh, &ray, &slopes, i32::MAX));
        let _ = hit.and_then(|hit| mesh.shading_normal(&hit));
    }
});
