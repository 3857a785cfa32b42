//! The mesh that the firmware carries in flash, as `build.rs` baked it: a torus knot if nothing else was asked for.

use microlux::{
    bvh::Node,
    geom::point,
    q,
    scene::Mesh,
    shape::{Grid, TriangleMesh},
};

include!(concat!(env!("OUT_DIR"), "/counts.rs"));

static VERTICES: [[u16; 3]; VERTEX_COUNT] =
    triples(include_bytes!(concat!(env!("OUT_DIR"), "/vertices.bin")));
static TRIANGLES: [[u16; 3]; TRIANGLE_COUNT] =
    triples(include_bytes!(concat!(env!("OUT_DIR"), "/triangles.bin")));
static NODES: [Node; NODE_COUNT] = nodes(include_bytes!(concat!(env!("OUT_DIR"), "/nodes.bin")));

/// 2 m: 65,536 steps of two units, from (-1, 0, -1) m.
pub fn grid() -> Grid {
    Grid::new(point(q!(-1), q!(0), q!(-1)), 1).unwrap_or(Grid::UNIT)
}

/// Borrowed from flash.
pub fn mesh() -> Mesh<'static> {
    Mesh {
        triangles: TriangleMesh {
            grid: grid(),
            vertices: &VERTICES,
            triangles: &TRIANGLES,
        }
        .into(),
        nodes: &NODES,
    }
}

const fn triples<const N: usize>(bytes: &[u8]) -> [[u16; 3]; N] {
    assert!(bytes.len() == 6 * N);
    let mut all = [[0; 3]; N];
    let mut i = 0;
    while i < 3 * N {
        all[i / 3][i % 3] = u16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]);
        i += 1;
    }
    all
}

const fn nodes<const N: usize>(bytes: &[u8]) -> [Node; N] {
    assert!(bytes.len() == 40 * N);
    let mut all = [Node::EMPTY; N];
    let (chunks, _) = bytes.as_chunks();
    let mut i = 0;
    while i < N {
        all[i] = Node::from_le_bytes(chunks[i]);
        i += 1;
    }
    all
}
