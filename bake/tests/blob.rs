//! Baked meshes come back as they were; what is wrong with their bytes is named, or harmless.

#[path = "../../tests/meshes/mod.rs"]
#[allow(dead_code)]
mod meshes;

use meshes::{Model, Random};
use microlux::bvh::{check_mesh, closest, closest_linear};
use microlux::geom::Unit;
use microlux::scene::{Baked, BakedError, BakedField};
use microlux::shape::{Slopes, Triangles};
use microlux_bake::{Aligned, Packed, blob, rust};

fn pack(model: &Model) -> Packed {
    Packed::new(&model.plain(), &model.nodes).unwrap()
}

const UNIT: Unit = Unit::new(18);

fn two() -> (Vec<Packed>, Vec<u8>) {
    let packed = vec![
        pack(&meshes::icosphere(2, 3)),
        pack(&meshes::torus_knot(24, 6, 8)),
    ];
    let bytes = blob(&packed, UNIT).unwrap();
    (packed, bytes)
}

/// With a checksum that fits again.
fn summed(mut bytes: Vec<u8>) -> Vec<u8> {
    let crc = crc32fast::hash(&bytes[20..]);
    bytes[16..20].copy_from_slice(&crc.to_le_bytes());
    bytes
}

#[test]
fn meshes_come_back() {
    let (packed, bytes) = two();
    let aligned = Aligned::new(&bytes);
    let baked = Baked::open(aligned.bytes()).unwrap();
    assert_eq!(baked.count(), 2);
    for (i, before) in (0..).zip(&packed) {
        let (before, after) = (before.mesh(), baked.mesh(i).unwrap());
        assert_eq!(baked.unit(i), Ok(UNIT));
        assert_eq!(after.nodes, before.nodes);
        let (Triangles::Packed(after), Triangles::Packed(before)) = (after.triangles, before.triangles)
        else {
            panic!("they are packed")
        };
        assert_eq!((after.grid, after.bounds), (before.grid, before.bounds));
        assert_eq!(after.treelets, before.treelets);
        assert_eq!((after.vertices, after.leaves), (before.vertices, before.leaves));
    }
    assert_eq!(
        baked.mesh(2).unwrap_err(),
        BakedError::NoMesh { mesh: 2, meshes: 2 }
    );
    let none = blob(&[], UNIT).unwrap();
    assert_eq!(Baked::open(Aligned::new(&none).bytes()).unwrap().count(), 0);
}

#[test]
fn each_fault_is_named() {
    let (_, good) = two();
    let length = good.len();
    let fault = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = good.clone();
        change(&mut bytes);
        Baked::open(Aligned::new(&bytes).bytes()).unwrap_err()
    };
    let fitting = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = good.clone();
        change(&mut bytes);
        Baked::open(Aligned::new(&summed(bytes)).bytes()).unwrap_err()
    };
    let shifted = Aligned::new(&[&[0, 0][..], &good].concat());
    assert_eq!(
        Baked::open(&shifted.bytes()[2..]).unwrap_err(),
        BakedError::Unaligned
    );
    assert_eq!(fault(&|b| b[3] = b'X'), BakedError::Magic);
    assert_eq!(fault(&|b| b[8] = 1), BakedError::Version { found: 1 });
    let wrong = |expected, found| BakedError::Length { expected, found };
    assert_eq!(fault(&|b| b.truncate(19)), wrong(20, 19));
    assert_eq!(fault(&|b| b.truncate(length - 4)), wrong(length, length - 4));
    assert_eq!(fault(&|b| b.push(0)), wrong(length, length + 1));
    assert_eq!(fault(&|b| b[12] ^= 4), wrong(length ^ 4, length));
    assert!(matches!(
        fault(&|b| b[length - 1] ^= 1),
        BakedError::Checksum { .. }
    ));
    assert!(matches!(fault(&|b| b[17] ^= 1), BakedError::Checksum { .. }));
    // The table: first entry at 20, the second at 64.
    let entry = |mesh, field| BakedError::Entry { mesh, field };
    assert_eq!(fitting(&|b| b[20 + 3] = 0x7f), entry(0, BakedField::Grid));
    assert_eq!(fitting(&|b| b[64 + 24] = 9), entry(1, BakedField::Grid));
    assert_eq!(fitting(&|b| b[64 + 25] = 0x80), entry(1, BakedField::Unit));
    assert_eq!(fitting(&|b| b[64 + 26] = 8), entry(1, BakedField::Layers));
    assert_eq!(fitting(&|b| b[20 + 27] = 1), entry(0, BakedField::Zero));
    assert_eq!(fitting(&|b| b[20 + 28] ^= 4), entry(0, BakedField::Nodes));
    assert_eq!(fitting(&|b| b[20 + 32] ^= 4), entry(0, BakedField::Treelets));
    assert_eq!(
        fitting(&|b| b[20 + 38] ^= 1),
        wrong(good.len() + (1 << 16), length),
        "vertices"
    );
    assert_eq!(
        fitting(&|b| b[10] = 3),
        entry(2, BakedField::Nodes),
        "a mesh too many"
    );
    assert_eq!(
        fitting(&|b| b[11] = 0xff),
        wrong(20 + 44 * 0xff02, length),
        "a table too long"
    );
    for error in [
        BakedError::Magic,
        BakedError::Unaligned,
        entry(3, BakedField::Bytes),
        wrong(1, 2),
    ] {
        assert!(error.to_string().lines().count() == 1);
    }
}

/// Bytes changed at random, with a checksum that fits: refused by name, or rendered without harm as the list is.
#[test]
fn changed_bytes_are_refused_or_harmless() {
    let (_, good) = two();
    let model = meshes::icosphere(2, 3);
    let rounds = std::env::var("MICROLUX_FLIPS").map_or(4000, |n| n.parse().unwrap());
    let mut random = Random(1);
    let (mut refused, mut unchecked, mut accepted) = (0, 0, 0);
    for _ in 0..rounds {
        let mut bytes = good.clone();
        for _ in 0..=random.below(3) {
            // Head and table as often as all the rest.
            let reach = if random.below(2) == 0 { 108 } else { bytes.len() };
            let at = random.below(reach as u32) as usize;
            bytes[at] = match random.below(3) {
                0 => random.bits() as u8,
                1 => bytes[at] ^ 1 << random.below(8),
                _ => [0, 0xff, 0x7f, 0x80][random.below(4) as usize],
            };
        }
        if random.below(8) != 0 {
            bytes = summed(bytes);
        }
        let aligned = Aligned::new(&bytes);
        let Ok(baked) = Baked::open(aligned.bytes()) else {
            refused += 1;
            continue;
        };
        for mesh in 0..baked.count() {
            let Ok(mesh) = baked.mesh(mesh) else {
                refused += 1;
                continue;
            };
            if check_mesh(&mesh.triangles, mesh.nodes).is_err() {
                unchecked += 1;
                continue;
            }
            accepted += 1;
            for _ in 0..4 {
                let ray = random.ray(&model);
                let slopes = Slopes::new(ray.dir);
                assert_eq!(
                    closest(&mesh.triangles, mesh.nodes, &ray, &slopes, i32::MAX),
                    closest_linear(&mesh.triangles, &ray, &slopes, i32::MAX)
                );
            }
        }
    }
    println!("{refused} refused, {unchecked} refused with their scene, {accepted} accepted");
    assert!(refused > 0 && unchecked > 0 && accepted > 0);
}

#[test]
fn rust_source_has_the_bytes() {
    let (_, bytes) = two();
    let text = rust(&bytes, "TWO");
    let (_, list) = text.split_once("Aligned([\n").unwrap();
    let numbers: Vec<u8> = list
        .trim_end_matches("]);\n")
        .split(',')
        .filter_map(|word| word.trim().parse().ok())
        .collect();
    assert_eq!(numbers, bytes);
    assert!(text.contains("pub static TWO: &[u8]") && text.contains("align(4)"));
}
