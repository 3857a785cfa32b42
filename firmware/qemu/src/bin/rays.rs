//! Rays to a mesh in a room, as it is indexed and packed, asked of the mesh alone and of a scene that it is all of:
//! regions 0 to 3. Then paths of up to five segments in the Cornell box: region 4. Prints
//! `rays FORM rays=N hits=N crc32=89abcdef` for each form and `paths rays=N crc32=89abcdef`.

#![no_std]
#![no_main]

#[path = "../console.rs"]
mod console;

use core::hint::black_box;
use core::panic::PanicInfo;

#[cfg(target_arch = "arm")]
use cortex_m_rt::entry;
use firmware_common::{fingerprint, region, stage::Cornell};
use microlux::{
    bvh::{self, Node, max_nodes},
    camera::{Camera, FilmPlane},
    color::Radiance,
    geom::{FAR, Point, Ray},
    integrator::Path,
    light::Light,
    material::Material,
    num::{Crc, Turn, Uniform},
    q,
    sampler::{Independent, Sampler},
    scene::{Baked, Mesh, SceneBuilder},
    shape::{Attributes, Geometry, Slopes, TriangleMesh, Triangles},
};
#[cfg(target_arch = "riscv32")]
use riscv_rt::entry;
use semihosting::process;
use zerocopy::FromBytes;

/// As `firmware_bake::Room` made it.
static ROOM: &[u8] = microlux::include_baked!(concat!(env!("OUT_DIR"), "/room.bin"));

/// The room's middle, and how far from it the eye is: 1.1 times the mesh's longest side.
const MIDDLE: Point = Point([0, 2 * 27_914, 0]);
const DISTANCE: i32 = 49_016;
/// Where from: directions of length 1, Q16.
const EYES: [[i32; 3]; 2] = [[32_259, 18_818, 53_765], [-57_702, 28_851, 11_540]];
const WIDTH: u16 = 96;
const HEIGHT: u16 = 80;

/// Longest path, in segments.
const MAX_DEPTH: u16 = 5;

#[entry]
fn main() -> ! {
    region::count(region::EMPTY, || ());
    let Some([plain, packed]) = meshes() else { refuse() };
    look(0, "plain", plain);
    look(2, "packed", packed);
    paths(4);
    process::exit(0)
}

fn meshes() -> Option<[Mesh<'static>; 2]> {
    let (counts, rest) = <[u32; 3]>::ref_from_prefix(ROOM).ok()?;
    let [nodes, triangles, vertices] = counts.map(|count| count as usize);
    let (nodes, rest) = <[Node]>::ref_from_prefix_with_elems(rest, nodes).ok()?;
    let (triangles, rest) = <[[u16; 3]]>::ref_from_prefix_with_elems(rest, triangles).ok()?;
    let (vertices, rest) = <[[u16; 3]]>::ref_from_prefix_with_elems(rest, vertices).ok()?;
    let blob = ROOM.get((ROOM.len() - rest.len()).next_multiple_of(4)..)?;
    let packed = Baked::open(blob).ok()?.mesh(0).ok()?;
    let plain = TriangleMesh {
        grid: *packed.triangles.grid(),
        vertices,
        triangles,
        attributes: Attributes::NONE,
    };
    Some([
        Mesh {
            triangles: Triangles::Plain(plain),
            nodes,
        },
        packed,
    ])
}

/// Counts what each ray takes: regions `id` and `id` + 1.
#[inline(never)]
fn look(id: u32, form: &str, mesh: Mesh) {
    let meshes = [mesh];
    let mut nodes = [Node::EMPTY; max_nodes(1)];
    let mut builder = SceneBuilder::<1, 1, 1>::new();
    let Ok(black) = builder.material(Material::Black) else {
        refuse()
    };
    let light = Light::Environment {
        radiance: Radiance::WHITE,
    };
    if builder.shape(Geometry::Mesh(0), black).is_err() || builder.light(light).is_err() {
        refuse();
    }
    let Ok(scene) = builder.build_with(&meshes, &mut nodes) else {
        refuse()
    };
    let (mut crc, mut rays, mut hits) = (Crc::new(), 0, 0);
    each_ray(|ray| {
        let alone = region::count(id, || {
            let ray = black_box(ray);
            let slopes = Slopes::new(ray.dir);
            black_box(bvh::closest(
                &meshes[0].triangles,
                meshes[0].nodes,
                &ray,
                &slopes,
                FAR,
            ))
        });
        let hit = region::count(id + 1, || black_box(scene.closest(&black_box(ray))));
        let distance = |t: Option<i32>| t.map_or(u32::MAX, |t| t as u32);
        crc.word(distance(alone.map(|hit| hit.t)));
        crc.word(distance(hit.map(|hit| hit.t)));
        rays += 1;
        hits += u32::from(hit.is_some());
    });
    console::print(&["rays ", form, " rays="]);
    console::decimal(rays);
    console::print(&[" hits="]);
    console::decimal(hits);
    end(crc);
}

/// Through the middles of both pictures' pixels.
fn each_ray(mut each: impl FnMut(Ray)) {
    let middle = [Uniform::from_bits(1 << 31); 2];
    for eye in EYES {
        let eye = Point([0, 1, 2].map(|axis| MIDDLE.0[axis] + (eye[axis] >> 4) * (DISTANCE >> 4) / (1 << 8)));
        // 0.6 to each side at distance 1.
        let tan_half = Camera::tan_half(q!(0.172, Turn));
        let Some(camera) = Camera::look_at(eye, MIDDLE, [0, 1, 0], tan_half) else {
            refuse()
        };
        let film: FilmPlane = camera.film(WIDTH, HEIGHT);
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                if let Some(ray) = film.ray(x, y, middle, middle) {
                    each(ray);
                }
            }
        }
    }
}

#[inline(never)]
fn paths(id: u32) {
    let Ok(mut cornell) = Cornell::new() else { refuse() };
    let Ok((scene, camera)) = cornell.scene() else {
        refuse()
    };
    let film = camera.film(WIDTH, HEIGHT);
    let mut sampler: Independent = Independent::new(1);
    let (mut crc, mut rays) = (Crc::new(), 0);
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            sampler.start(x, y, 0);
            let [place, lens] = [sampler.next_2d(), sampler.next_2d()];
            let Some(ray) = film.ray(x, y, place, lens) else {
                continue;
            };
            let radiance = region::count(id, || {
                let path = Path::new(MAX_DEPTH);
                black_box(path.radiance(&scene, black_box(ray), &mut sampler, &mut rays))
            });
            fingerprint::pixel(&mut crc, radiance);
        }
    }
    console::print(&["paths rays="]);
    console::decimal(rays);
    end(crc);
}

fn end(crc: Crc) {
    console::print(&[" crc32="]);
    console::hexadecimal(crc.value());
    console::print(&["\n"]);
}

fn refuse() -> ! {
    console::print(&[env!("MACHINE"), ": the room is refused\n"]);
    process::exit(1)
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    console::print(&[env!("MACHINE"), ": panic\n"]);
    process::exit(1)
}
