//! Rays to random meshes as the core follows them: in assembly on a Cortex-M and RV32IM, by the portable code elsewhere.

use core::ops::ControlFlow;

use microlux::{
    bvh::{self, Node, Order, Visitor, max_nodes, traverse},
    geom::{Dir, Point, Ray},
    num::Crc,
    shape::{Attributes, Grid, GridRay, MeshHit, Slopes, TriangleMesh, Triangles},
};

use crate::random::Xorshift;

const VERTICES: usize = 48;
const TRIANGLES: usize = 64;
/// Of a mesh; 410 times as many are 65,190 steps.
const RAYS: usize = 160;

/// Meshes of triangles of every size, some through one vertex more than there are; rays from in and around them, half of
/// them to a vertex, some along an axis; the nearest hit, whether there is any, and the leaves on the way.
pub(crate) fn run() -> u32 {
    let mut random = Xorshift::new(0x2545_f491);
    let mut crc = Crc::new();
    for round in 0..8 {
        let mut vertices = [[0; 3]; VERTICES];
        let mut triangles = [[0; 3]; TRIANGLES];
        let mut nodes = [Node::EMPTY; max_nodes(TRIANGLES)];
        // From 1 << 9 steps to all of the grid.
        let spread = 23 - round;
        for vertex in &mut vertices {
            let middle = [random.u32(), random.u32(), random.u32()].map(|c| c >> 25 << 9);
            *vertex = middle.map(|c| (8 + ((c + (random.u32() >> spread)) & 0xffff).min(65_511)) as u16);
        }
        for (index, triangle) in triangles.iter_mut().enumerate() {
            let first = (index * 3 / 4) as u32;
            let near = |r: u32| ((first + (r >> 29)) % VERTICES as u32) as u16;
            *triangle = [first as u16, near(random.u32()), near(random.u32())];
        }
        let Ok(used) = bvh::build_mesh(&vertices, &mut triangles, &mut nodes) else {
            return 0;
        };
        if round % 4 == 3 {
            triangles[17][1] = VERTICES as u16;
        }
        let Some(grid) = Grid::new(Point([-1000, 500, 0]), round / 3) else {
            return 0;
        };
        let mesh = TriangleMesh {
            grid,
            vertices: &vertices,
            triangles: &triangles,
            attributes: Attributes::NONE,
        };
        for number in 0..RAYS {
            let Some(ray) = ray(&mut random, &mesh, number) else {
                continue;
            };
            look(&mut crc, &mesh, &nodes[..used], &ray, number);
        }
    }
    crc.value()
}

fn ray(random: &mut Xorshift, mesh: &TriangleMesh, number: usize) -> Option<Ray> {
    let mut place = || [0; 3].map(|_| (random.u32() >> 16) as u16);
    let (from, to) = (place(), place());
    let Point(mut origin) = mesh.grid.to_scene(from);
    if number.is_multiple_of(3) {
        origin[number % 2] -= 40_000;
    }
    let origin = Point(origin);
    let to = if number & 1 == 0 {
        mesh.vertices[number % VERTICES]
    } else {
        to
    };
    let dir = match number {
        0 => Dir::X,
        1 => -Dir::Y,
        2 => Dir::Z,
        3 => -Dir::X,
        _ => origin.to(mesh.grid.to_scene(to)).normalize()?.0,
    };
    Some(Ray { origin, dir })
}

const NONE: MeshHit = MeshHit {
    t: 0,
    triangle: 0,
    b1: 0,
    b2: 0,
};

#[inline(never)]
fn look(crc: &mut Crc, mesh: &TriangleMesh, nodes: &[Node], ray: &Ray, number: usize) {
    let slopes = Slopes::new(ray.dir);
    let plain = Triangles::Plain(*mesh);
    let t_max = if number & 4 == 0 { i32::MAX } else { 30_000 };
    let hit = bvh::closest(&plain, nodes, ray, &slopes, t_max);
    let MeshHit { t, triangle, b1, b2 } = hit.unwrap_or(NONE);
    for word in [t, triangle as i32, b1, b2] {
        crc.word(word as u32);
    }
    // Before the nearest and behind it, or anywhere.
    for distance in [t, t + 1, t_max] {
        crc.word(bvh::occluded(&plain, nodes, ray, &slopes, distance).into());
    }
    if let Some(ray) = GridRay::enter(&mesh.grid, ray, &slopes) {
        follow::<false>(crc, nodes, &ray, number as i32);
        follow::<true>(crc, nodes, &ray, number as i32);
    }
}

#[inline(never)]
fn follow<const FACE: bool>(crc: &mut Crc, nodes: &[Node], ray: &GridRay, step: i32) {
    let limit = step * 410;
    traverse(nodes, ray, &mut Leaves::<FACE> { crc, limit, step });
}

/// Takes down leaves, and comes a little nearer at each.
struct Leaves<'c, const FACE: bool> {
    crc: &'c mut Crc,
    limit: i32,
    step: i32,
}

impl<const FACE: bool> Visitor for Leaves<'_, FACE> {
    const ORDER: Order = if FACE { Order::Face } else { Order::Entry };
    const BY_AXIS: bool = false;

    fn limit(&self) -> i32 {
        self.limit
    }

    #[inline(never)]
    fn visit<const K: usize>(&mut self, _: &GridRay, base: u32, leaf: u32) -> ControlFlow<()> {
        self.crc.word(base << 8 | leaf);
        self.limit = (self.limit - self.step).max(0);
        ControlFlow::Continue(())
    }
}
