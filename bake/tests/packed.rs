//! A packed mesh answers what the list of its triangles answers; what is wrong with one is named, or harmless.

#[path = "../../tests/meshes/mod.rs"]
#[allow(dead_code)]
mod meshes;

use meshes::{Model, Random};
use microlux::bvh::{CheckError, Node, check_mesh, closest, closest_linear, occluded, occluded_linear};
use microlux::color::{Albedo, Radiance};
use microlux::geom::{Dir, Octahedral, Point};
use microlux::material::Material;
use microlux::num::{Uniform, Wide};
use microlux::scene::SceneBuilder;
use microlux::shape::{
    Attributes, Geometry, MeshError, MeshHit, PackedMesh, Slopes, Surface, Treelet, TriangleMesh, Triangles,
};
use microlux_bake::{self as bake, Packed};

fn pack(model: &Model) -> Packed {
    Packed::new(&model.plain(), &model.nodes).unwrap()
}

fn made() -> Vec<Model> {
    vec![
        meshes::room(7),
        meshes::icosphere(1, 0),
        meshes::icosphere(3, 4),
        meshes::soup(300, 5),
        meshes::torus_knot(96, 12, 8),
    ]
}

/// Corners of all triangles, each beginning with its lowest.
fn sorted(triangles: impl Iterator<Item = [[u16; 3]; 3]>) -> Vec<[[u16; 3]; 3]> {
    let mut all: Vec<_> = triangles
        .map(|[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap())
        .collect();
    all.sort();
    all
}

/// The packed mesh's tree, its stream, and the plain list of its triangles in the order of their numbers: one answer.
fn compare(model: &Model, rays: u64, seed: u32) {
    let packed = pack(model);
    let mesh = packed.mesh();
    assert_eq!(
        check_mesh(&mesh.triangles, mesh.nodes),
        check_mesh(&model.mesh(), &model.nodes)
    );
    let numbers: Vec<u32> = mesh.triangles.numbers().collect();
    let corners: Vec<_> = numbers
        .iter()
        .map(|&n| mesh.triangles.corners(n).unwrap())
        .collect();
    let plain = model.mesh();
    let before = plain.numbers().map(|n| plain.corners(n).unwrap());
    assert_eq!(
        sorted(corners.iter().copied()),
        sorted(before),
        "{}: lossless",
        model.name
    );
    assert_eq!(mesh.triangles.count(), corners.len());
    let mut vertices: Vec<[u16; 3]> = corners.iter().flatten().copied().collect();
    vertices.sort();
    vertices.dedup();
    let place = |v: [u16; 3]| vertices.binary_search(&v).unwrap() as u16;
    let triangles: Vec<[u16; 3]> = corners.iter().map(|c| c.map(place)).collect();
    let list = Triangles::Plain(TriangleMesh {
        grid: model.grid,
        vertices: &vertices,
        triangles: &triangles,
        attributes: Attributes::NONE,
    });
    assert_eq!(mesh.triangles.bounds(), list.bounds());
    let mut random = Random(seed);
    let mut hits = 0;
    for i in 0..rays {
        let ray = random.ray(model);
        let slopes = Slopes::new(ray.dir);
        let tell = || format!("{} ray {i}: {ray:?}", model.name);
        let want = closest_linear(&list, &ray, &slopes, i32::MAX).map(|mut hit| {
            let index = hit.triangle;
            hit.triangle = numbers[index as usize];
            let packed = mesh.triangles;
            assert_eq!(packed.normal(hit.triangle), list.normal(index));
            assert_eq!(
                packed.point(&hit),
                list.point(&microlux::shape::MeshHit {
                    triangle: index,
                    ..hit
                })
            );
            hit
        });
        hits += u64::from(want.is_some());
        assert_eq!(
            closest(&mesh.triangles, mesh.nodes, &ray, &slopes, i32::MAX),
            want,
            "{}",
            tell()
        );
        assert_eq!(
            closest_linear(&mesh.triangles, &ray, &slopes, i32::MAX),
            want,
            "{}",
            tell()
        );
        let near = want.map_or(1 << 20, |hit| hit.t);
        for t_max in [near, near.saturating_add(1), i32::MAX] {
            let within = want.filter(|hit| hit.t < t_max);
            assert_eq!(
                closest(&mesh.triangles, mesh.nodes, &ray, &slopes, t_max),
                within,
                "{}",
                tell()
            );
            let blocked = occluded(&mesh.triangles, mesh.nodes, &ray, &slopes, t_max);
            assert_eq!(blocked, within.is_some(), "{}", tell());
        }
        if i % 16 == 0 {
            let blocked = occluded_linear(&mesh.triangles, &ray, &slopes, near.saturating_add(1));
            assert_eq!(blocked, want.is_some(), "{}", tell());
        }
    }
    let each = |bytes: usize| bytes as f64 / numbers.len() as f64;
    println!(
        "{}: {:.2} bytes a triangle: {} treelets {:.2}, vertices {:.2}, leaves {:.2}, nodes {:.2}",
        model.name,
        each(mesh.triangles.bytes() + size_of_val(mesh.nodes)),
        packed.treelets.len(),
        each(size_of_val(&*packed.treelets)),
        each(packed.vertices.len()),
        each(packed.leaves.len()),
        each(size_of_val(mesh.nodes)),
    );
    assert!(hits > rays / 20, "too few hits to mean something");
}

/// Every mesh gets an equal amount of work. `MICROLUX_RAYS` is the sum of rays.
#[test]
fn same_hit_as_the_list() {
    let mut models = made();
    models.extend(meshes::files());
    let total: u64 = std::env::var("MICROLUX_RAYS").map_or(20_000, |n| n.parse().unwrap());
    let share: f64 = models.iter().map(|m| 1.0 / m.triangles.len() as f64).sum();
    for (i, model) in models.iter().enumerate() {
        let rays = total as f64 / (share * model.triangles.len() as f64);
        compare(model, (rays as u64).max(100), i as u32 + 1);
    }
    // The same as the host builds it.
    for (i, model) in models.iter_mut().enumerate() {
        model.nodes = bake::build(&model.vertices, &mut model.triangles).unwrap();
        compare(model, 100, i as u32 + 101);
    }
}

#[test]
fn each_fault_is_named() {
    let model = meshes::icosphere(3, 4);
    let packed = pack(&model);
    let faulty = |change: &dyn Fn(&mut Packed)| {
        let mut packed = packed.clone();
        change(&mut packed);
        let mesh = packed.mesh();
        check_mesh(&mesh.triangles, mesh.nodes).unwrap_err()
    };
    let head = u16::from_le_bytes([packed.leaves[0], packed.leaves[1]]);
    let first = packed.treelets[0].to_le_bytes();
    let treelet = |at: usize, value: u8| {
        let mut bytes = first;
        bytes[at] = value;
        Treelet::from_le_bytes(bytes)
    };
    assert!(packed.treelets.len() > 1 && packed.treelets.len() < 64);
    assert_eq!(head >> 2, 0);
    assert_eq!(
        faulty(&|p| p.leaves[0] |= 0xfc),
        CheckError::Mesh(MeshError::Treelet { triangle: 0 })
    );
    assert_eq!(
        faulty(&|p| p.treelets[0] = treelet(6, first[6] | 31)),
        CheckError::Mesh(MeshError::Width { treelet: 0 })
    );
    assert_eq!(
        faulty(&|p| p.treelets[0] = treelet(7, first[7] | 0x80)),
        CheckError::Mesh(MeshError::Width { treelet: 0 })
    );
    assert_eq!(
        faulty(&|p| p.treelets[0] = treelet(11, 1)),
        CheckError::Mesh(MeshError::Index { triangle: 0 })
    );
    assert_eq!(
        faulty(&|p| p.treelets[0] = treelet(10, 0xff)),
        CheckError::Mesh(MeshError::Vertices { treelet: 0 })
    );
    assert_eq!(
        faulty(&|p| p.vertices.truncate(p.vertices.len() - 2 * PackedMesh::TAIL)),
        CheckError::Mesh(MeshError::Vertices {
            treelet: packed.treelets.len() as u16 - 1
        })
    );
    assert!(matches!(
        faulty(&|p| p.bounds.high[1] -= 1000),
        CheckError::Mesh(MeshError::Bounds { .. })
    ));
    assert_eq!(
        faulty(&|p| p.treelets[0] = Treelet::new([0; 3], [0; 3], 0, 256)),
        CheckError::Mesh(MeshError::Corner { triangle: 0 })
    );
    assert_eq!(
        faulty(&|p| p.leaves[2] ^= 1),
        CheckError::Malformed { node: node(&packed) }
    );
    assert!(matches!(
        faulty(&|p| p.leaves.truncate(p.leaves.len() - 1)),
        CheckError::Mesh(MeshError::Cut { .. })
    ));
    assert_eq!(
        faulty(&|p| p.leaves.push(0)),
        CheckError::Unreached {
            primitive: (packed.leaves.len() as u32) << 4
        }
    );
    assert!(matches!(
        faulty(&|p| p.leaves.extend_from_within(..)),
        CheckError::Unreached { .. }
    ));
    assert!(matches!(
        faulty(&|p| p.leaves.clear()),
        CheckError::Order { expected: 0, .. }
    ));
    // The bases of two nodes with leaves, exchanged.
    assert!(matches!(
        faulty(&|p| {
            let last = p.nodes.len() - 1;
            p.nodes[last] = p.nodes[last - 1];
        }),
        CheckError::Order { .. }
    ));
    assert!(matches!(
        faulty(&|p| {
            let at = p.vertices.len() / 2;
            p.vertices[at] ^= 0xff;
        }),
        CheckError::Outside { .. } | CheckError::Mesh(_)
    ));
}

/// The node of the first block.
fn node(packed: &Packed) -> u32 {
    let is_first = |node: &&Node| {
        let bytes = node.to_le_bytes();
        let leaves = bytes[24..28].iter().any(|meta| (0x10..0x80).contains(meta));
        leaves && [bytes[38], bytes[39], bytes[35]] == [0; 3]
    };
    let node = packed.nodes.iter().find(is_first).unwrap();
    packed.nodes.iter().position(|other| other == node).unwrap() as u32
}

/// Bytes changed at random: refused, or rays still find what the list finds.
#[test]
fn flipped_bytes_are_refused_or_harmless() {
    let model = meshes::icosphere(2, 4);
    let whole = pack(&model);
    let mut random = Random(17);
    let (mut refused, rounds) = (0, 20_000);
    for round in 0..rounds {
        let mut packed = whole.clone();
        for _ in 0..=random.below(3) {
            let bit = 1 << random.below(8);
            match random.below(8) {
                0 | 1 => {
                    let at = random.below(whole.treelets.len() as u32) as usize;
                    let mut bytes = packed.treelets[at].to_le_bytes();
                    bytes[random.below(12) as usize] ^= bit;
                    packed.treelets[at] = Treelet::from_le_bytes(bytes);
                }
                2 | 3 => {
                    let at = random.below(whole.vertices.len() as u32) as usize;
                    if let Some(byte) = packed.vertices.get_mut(at) {
                        *byte ^= bit;
                    }
                }
                4 | 5 => {
                    let at = random.below(whole.leaves.len() as u32) as usize;
                    if let Some(byte) = packed.leaves.get_mut(at) {
                        *byte ^= bit;
                    }
                }
                6 => {
                    let at = random.below(packed.nodes.len() as u32) as usize;
                    let mut bytes = packed.nodes[at].to_le_bytes();
                    bytes[random.below(40) as usize] ^= bit;
                    packed.nodes[at] = Node::from_le_bytes(bytes);
                }
                _ => {
                    let cut = |bytes: &mut Vec<u8>, keep: u32| bytes.truncate(keep as usize);
                    let (v, l) = (packed.vertices.len() as u32, packed.leaves.len() as u32);
                    match random.below(2) {
                        0 => cut(&mut packed.vertices, random.below(v + 1)),
                        _ => cut(&mut packed.leaves, random.below(l + 1)),
                    }
                }
            }
        }
        let mesh = packed.mesh();
        if check_mesh(&mesh.triangles, mesh.nodes).is_err() {
            refused += 1;
            // Read without the tree, it is no more than wrong.
            let ray = random.ray(&model);
            let _ = closest_linear(&mesh.triangles, &ray, &Slopes::new(ray.dir), i32::MAX);
            let _ = mesh.triangles.corners(random.bits());
            continue;
        }
        for _ in 0..4 {
            let ray = random.ray(&model);
            let slopes = Slopes::new(ray.dir);
            let want = closest_linear(&mesh.triangles, &ray, &slopes, i32::MAX);
            let found = closest(&mesh.triangles, mesh.nodes, &ray, &slopes, i32::MAX);
            assert_eq!(found, want, "round {round}");
        }
    }
    println!("{refused} of {rounds} refused");
    assert!(refused > rounds / 4 && refused < rounds);
}

/// As a shape that emits: seen where the list is, and found by BSDF sampling alone.
#[test]
fn a_scene_sees_it_as_any_mesh() {
    let model = meshes::torus_knot(96, 12, 4);
    let packed = pack(&model);
    let mut builder = SceneBuilder::<1, 1, 1>::new();
    let glow = Radiance::from_bits([3 << 16; 3], -16);
    let grey = builder.material(Material::Lambert {
        albedo: Albedo::WHITE,
        two_sided: false,
    });
    builder.emitter(Geometry::Mesh(0), grey.unwrap(), glow).unwrap();
    let meshes = [packed.mesh()];
    let mut nodes = [Node::EMPTY; 1];
    let scene = builder.build_with(&meshes, &mut nodes).unwrap();
    let mut random = Random(3);
    let (mut hits, mut bright) = (0, 0);
    for _ in 0..20_000 {
        let ray = random.ray(&model);
        let hit = scene.closest(&ray);
        assert_eq!(hit, scene.closest_linear(&ray));
        let Some(hit) = hit else { continue };
        hits += 1;
        let vertex = scene.vertex(&ray, &hit);
        assert_eq!(
            meshes[0].triangles.normal(hit.triangle),
            Some(vertex.surface.normal)
        );
        assert_eq!(vertex.light.is_some(), vertex.emission == glow);
        if let Some(light) = vertex.light {
            bright += 1;
            assert_eq!(scene.light_pdf(light, ray.origin, ray.dir, &hit), Wide::ZERO);
        }
    }
    println!("{hits} hits, {bright} on the bright side");
    assert!(bright > 1000 && bright < hits);
    let any = Uniform::from_bits(1 << 31);
    let from = Surface {
        point: Point([0; 3]),
        normal: Dir::Y,
        lift: 0,
    };
    assert!(scene.sample_light(0, &from, [any; 2]).is_none());
    assert!(scene.emit(0, [any; 2], [any; 2]).is_none());
}

/// Each vertex's own normal, any of those there are.
fn any_normals(model: &Model) -> Vec<Octahedral> {
    let mut random = Random(11);
    let mut byte = || random.below(255) as i32 - 127;
    model
        .vertices
        .iter()
        .map(|_| Octahedral([byte() as i8, byte() as i8]))
        .collect()
}

#[test]
fn what_vertices_say_comes_back() {
    for model in made() {
        let normals = any_normals(&model);
        let mut random = Random(12);
        let colors: Vec<[u8; 3]> = normals
            .iter()
            .map(|_| [0; 3].map(|_| random.bits() as u8))
            .collect();
        let uvs: Vec<[i16; 2]> = normals
            .iter()
            .map(|_| [0; 2].map(|_| random.bits() as i16))
            .collect();
        let all_of = Attributes {
            normals: &normals,
            colors: &colors,
            uvs: &uvs,
        };
        let told = TriangleMesh {
            attributes: all_of,
            ..model.plain()
        };
        let (told, packed) = (Triangles::from(told), Packed::new(&told, &model.nodes).unwrap());
        let said = |triangles: &Triangles| {
            let mut said: Vec<_> = triangles
                .numbers()
                .map(|number| {
                    let (corners, normals) = (triangles.corners(number), triangles.normals(number));
                    let (colors, uvs) = (triangles.colors(number), triangles.uvs(number));
                    let corner = |i: usize| {
                        let i = i % 3;
                        (
                            corners.unwrap()[i],
                            normals.unwrap()[i],
                            colors.unwrap()[i],
                            uvs.unwrap()[i],
                        )
                    };
                    let turned = |i: usize| [corner(i), corner(i + 1), corner(i + 2)];
                    (0..3).map(turned).min().unwrap()
                })
                .collect();
            said.sort();
            said
        };
        assert_eq!(said(&packed.mesh().triangles), said(&told), "{}", model.name);
        let smooth = TriangleMesh {
            attributes: Attributes {
                normals: &normals,
                ..Attributes::NONE
            },
            ..model.plain()
        };
        let packed = Packed::new(&smooth, &model.nodes).unwrap();
        let (mesh, before) = (packed.mesh(), Triangles::from(smooth));
        assert_eq!(
            check_mesh(&mesh.triangles, mesh.nodes),
            check_mesh(&before, &model.nodes),
            "{}",
            model.name
        );
        let all = |triangles: &Triangles| {
            let mut all: Vec<_> = triangles
                .numbers()
                .map(|number| {
                    let (corners, normals) = (
                        triangles.corners(number).unwrap(),
                        triangles.normals(number).unwrap(),
                    );
                    let corner = |i: usize| (corners[i % 3], normals[i % 3]);
                    let turned = |i: usize| [corner(i), corner(i + 1), corner(i + 2)];
                    (0..3).map(turned).min().unwrap()
                })
                .collect();
            all.sort();
            all
        };
        assert_eq!(all(&mesh.triangles), all(&before), "{}", model.name);
        let flat = pack(&model);
        assert!(flat.mesh().triangles.normals(0).is_none());
        let vertices: usize = packed.vertices.len() - flat.vertices.len();
        assert!(vertices >= 2 * model.vertices.len(), "{}: {vertices}", model.name);

        // Without the last normal.
        let Triangles::Packed(whole) = mesh.triangles else {
            panic!("it is packed")
        };
        let end = whole.vertices.len() - PackedMesh::TAIL - 1;
        let cut = Triangles::Packed(PackedMesh {
            vertices: &whole.vertices[..end],
            ..whole
        });
        let last = (packed.treelets.len() - 1) as u16;
        let fault = MeshError::Vertices { treelet: last };
        assert_eq!(
            check_mesh(&cut, mesh.nodes),
            Err(CheckError::Mesh(fault)),
            "{}",
            model.name
        );
        let few = Triangles::from(TriangleMesh {
            attributes: Attributes {
                normals: &normals[1..],
                ..Attributes::NONE
            },
            ..model.plain()
        });
        assert_eq!(
            check_mesh(&few, &model.nodes),
            Err(CheckError::Mesh(MeshError::Attributes)),
            "{}",
            model.name
        );
    }
}

/// Between a corner's normal and its neighbours', by the weights.
#[test]
fn normals_between() {
    let model = meshes::icosphere(2, 3);
    let normals: Vec<Octahedral> = model
        .vertices
        .iter()
        .map(|v| Octahedral::encode(Dir::new(v.map(|c| i32::from(c) - 32768)).unwrap()))
        .collect();
    let smooth = TriangleMesh {
        attributes: Attributes {
            normals: &normals,
            ..Attributes::NONE
        },
        ..model.plain()
    };
    let packed = Packed::new(&smooth, &model.nodes).unwrap();
    let mut random = Random(3);
    for triangles in [Triangles::from(smooth), packed.mesh().triangles] {
        for triangle in triangles.numbers() {
            let [a, b, c] = triangles.normals(triangle).unwrap().map(|normal| {
                let [x, y] = normal.0.map(|b| f64::from(b) / 127.0);
                let z = 1.0 - x.abs() - y.abs();
                let v = match z < 0.0 {
                    true => [(1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y), z],
                    false => [x, y, z],
                };
                let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
                v.map(|c| c / length)
            });
            let b1 = random.below(65537) as i32;
            let hit = MeshHit {
                t: 1,
                triangle,
                b1,
                b2: random.below((65537 - b1) as u32) as i32,
            };
            let [w1, w2] = [hit.b1, hit.b2].map(|w| f64::from(w) / 65536.0);
            let sum = [0, 1, 2].map(|i| a[i] * (1.0 - w1 - w2) + b[i] * w1 + c[i] * w2);
            let length = sum.iter().map(|c| c * c).sum::<f64>().sqrt();
            let found = triangles.shading_normal(&hit).unwrap().0;
            for i in 0..3 {
                let error = f64::from(found[i]) / 65536.0 - sum[i] / length;
                assert!(error.abs() < 1e-4, "{triangle} {hit:?}: {error}");
            }
        }
    }
}
