//! Faces of many corners and materials: `ngons.obj` and `shelf.obj` of `tests/models`.

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

#[test]
fn each_material_of_an_obj_is_a_mesh_of_its_own() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/shelf.obj");
    let loaded = load(&path, &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    let scene = &loaded.scene;
    let of = |name: &str| {
        let shape = scene
            .shapes
            .iter()
            .find(|shape| shape.name == format!("shelf, {name}"));
        let shape = shape.unwrap_or_else(|| panic!("no {name}"));
        let GeometryDesc::Mesh(mesh) = &shape.geometry else {
            panic!()
        };
        (&scene.materials[shape.material], mesh, shape.emission)
    };
    assert_eq!(scene.shapes.len(), 7);
    let (wall, mesh, _) = of("Red wall");
    assert!(
        matches!(
            wall.bsdf,
            BsdfDesc::Diffuse {
                reflectance: [0.8, 0.1, 0.1]
            }
        ) && wall.two_sided
    );
    assert_eq!(mesh.triangles.len(), 4);
    assert!(matches!(
        of("Gloss").0.bsdf,
        BsdfDesc::BlinnPhong { exponent: 200.0, .. }
    ));
    assert!(matches!(
        of("Mirror").0.bsdf,
        BsdfDesc::Conductor { eta_k: None, .. }
    ));
    assert!(
        matches!(of("Glass").0.bsdf, BsdfDesc::Dielectric { int_ior: 1.5, .. }) && !of("Glass").0.two_sided
    );
    assert!(matches!(
        of("Gold").0.bsdf,
        BsdfDesc::RoughConductor { eta_k: Some(_), .. }
    ));
    assert!(matches!(
        of("Unknown").0.bsdf,
        BsdfDesc::Diffuse {
            reflectance: [0.7, 0.7, 0.7]
        }
    ));
    assert_eq!(of("Lamp").2, Some([8.0, 4.0, 2.0]));
    // It has a lamp, so that no daylight is added.
    assert!(scene.lights.is_empty());
    let told =
        |lines: &[String], what: &str| assert!(lines.iter().any(|l| l.contains(what)), "{what}: {lines:?}");
    told(&loaded.warnings, "shelf.obj:2: mtllib: no file");
    told(&loaded.warnings, "missing.mtl");
    told(&loaded.warnings, "material \"Unknown\" is in no mtllib");
    told(
        &loaded.warnings,
        "shelf.mtl: material \"Gloss\": map_Bump is left out",
    );
    told(&loaded.notes, "shelf.mtl: material \"Lamp\": Lambert, emits");
}

#[test]
fn a_missing_library_is_named_and_the_mesh_is_grey() {
    let text = "mtllib my colours.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
    let folder = Folder::with(&[("m.obj", text)]);
    let grey = folder.load("m.obj", &Options::default()).unwrap();
    assert!(matches!(
        grey.scene.materials[0].bsdf,
        BsdfDesc::Diffuse {
            reflectance: [0.7, 0.7, 0.7]
        }
    ));
    assert!(
        grey.warnings[0].contains("m.obj:1: mtllib: no file"),
        "{:?}",
        grey.warnings
    );
    assert!(grey.warnings[0].contains("my colours.mtl: its materials are grey"));
    let found = Folder::with(&[("m.obj", text), ("my colours.mtl", "newmtl a\nKd 0.5 0 0\n")]);
    let red = found.load("m.obj", &Options::default()).unwrap();
    assert!(matches!(
        red.scene.materials[0].bsdf,
        BsdfDesc::Diffuse {
            reflectance: [0.5, 0.0, 0.0]
        }
    ));
    assert!(red.warnings.is_empty(), "{:?}", red.warnings);
    let broken = Folder::with(&[("m.obj", text), ("my colours.mtl", "newmtl a\nKd 0.5 0\n")]);
    assert!(
        broken
            .error("m.obj")
            .starts_with("my colours.mtl:2: Kd: has 2 of 3 numbers")
    );
}
