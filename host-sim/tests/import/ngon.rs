//! Faces of many corners, `tests/models/ngons.obj`.

use std::collections::HashMap;

use super::*;

#[test]
fn solids_of_ngons_are_closed_and_whole() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/ngons.obj");
    let loaded = load(&path, &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    let GeometryDesc::Mesh(mesh) = &loaded.scene.shapes[0].geometry else {
        panic!()
    };
    // 4 m² of an L, half a metre thick; the plate lies in y = 0 and adds nothing.
    assert!((volume(mesh) - 2.0).abs() < 1e-12, "{}", volume(mesh));
    assert_eq!(mesh.triangles.len(), 5 + 5 + 7 * 2 + 2);
    // Every edge has a twin but for the plate's four.
    let mut open: HashMap<[u32; 2], i32> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            *open.entry([p, q]).or_default() += 1;
            *open.entry([q, p]).or_default() -= 1;
        }
    }
    let alone: Vec<_> = open.iter().filter(|(_, count)| **count > 0).collect();
    assert_eq!(alone.len(), 4, "{alone:?}");
    assert!(
        loaded
            .warnings
            .iter()
            .any(|w| w.contains("2 triangles without area are left out")),
        "{:?}",
        loaded.warnings
    );
}

#[test]
fn a_ply_face_is_cut_as_an_obj_face() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n2 2 0\n1 0 0\n2 -2 0\n4 0 3 2 1\n";
    let folder = Folder::with(&[
        ("a.ply", ply),
        ("a.obj", "v 0 0 0\nv 2 2 0\nv 1 0 0\nv 2 -2 0\nf 1 4 3 2\n"),
        ("x.obj", "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nf 1 2 3 4\n"),
    ]);
    for name in ["a.ply", "a.obj"] {
        let scene = folder.load(name, &Options::default()).unwrap().scene;
        let GeometryDesc::Mesh(mesh) = &scene.shapes[0].geometry else {
            panic!()
        };
        let mut area = 0.0;
        for t in &mesh.triangles {
            let [p, q, r] = t.map(|i| mesh.vertices[i as usize]);
            let d = |q: Vec3| [0, 1, 2].map(|i| q[i] - p[i]);
            let twice = cross(d(q), d(r))[2];
            assert!(twice > 0.0, "{name}: {t:?} is turned over");
            area += twice / 2.0;
        }
        assert!((area - 2.0).abs() < 1e-12, "{name}: {area}");
    }
    let crossed = folder.load("x.obj", &Options::default()).unwrap();
    assert!(
        crossed
            .warnings
            .iter()
            .any(|w| w.contains("1 faces cross themselves"))
    );
}
