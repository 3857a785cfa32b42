//! OBJ and PLY files.

use super::*;

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

#[test]
fn a_mesh_alone_is_framed_and_lit() {
    let folder = Folder::with(&[("t.obj", TETRAHEDRON)]);
    let loaded = folder.load("t.obj", &Options::default()).unwrap();
    let scene = loaded.scene;
    assert_eq!((scene.name.as_str(), scene.width, scene.height), ("t", 256, 256));
    assert_eq!(
        (scene.shapes.len(), scene.lights.len(), scene.integrator.max_depth),
        (2, 2, Some(5))
    );
    let GeometryDesc::Mesh(mesh) = &scene.shapes[0].geometry else {
        panic!()
    };
    let (camera, tan) = (&scene.camera, (scene.camera.fov_x.to_radians() / 2.0).tan());
    let dot = |a: Vec3, b: Vec3| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let reach = mesh.vertices.iter().map(|&v| {
        let d = [0, 1, 2].map(|i| v[i] - camera.origin[i]);
        assert!(dot(d, camera.forward) > 0.0);
        dot(d, camera.right).abs().max(dot(d, camera.up).abs()) / (dot(d, camera.forward) * tan)
    });
    // The mesh all but fills the picture.
    let widest = reach.fold(0.0, f64::max);
    assert!((0.8..0.85).contains(&widest), "{widest}");
    let GeometryDesc::Rectangle { center, u, v } = scene.shapes[1].geometry else {
        panic!()
    };
    assert!(center[1] == 0.0 && cross(u, v)[1] > 0.0);
}

fn binary(big_endian: bool) -> Vec<u8> {
    let order = if big_endian { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    for (x, y, z) in [
        (0.0_f32, 0.0_f64, 0.0_f32),
        (2.0, 0.0, 0.0),
        (2.0, 1.0, 0.0),
        (0.0, 1.0, 0.25),
    ] {
        if big_endian {
            bytes.extend(
                x.to_be_bytes()
                    .into_iter()
                    .chain(y.to_be_bytes())
                    .chain(z.to_be_bytes()),
            );
        } else {
            bytes.extend(
                x.to_le_bytes()
                    .into_iter()
                    .chain(y.to_le_bytes())
                    .chain(z.to_le_bytes()),
            );
        }
        bytes.push(200);
    }
    bytes.push(4);
    for index in [0_i32, 1, 2, 3] {
        bytes.extend(if big_endian {
            index.to_be_bytes()
        } else {
            index.to_le_bytes()
        });
    }
    bytes
}

fn mesh_of(folder: &Folder, name: &str) -> MeshDesc {
    let mut scene = folder
        .load(name, &Options::default())
        .unwrap_or_else(|e| panic!("{e}"))
        .scene;
    match scene.shapes.swap_remove(0).geometry {
        GeometryDesc::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

#[test]
fn ply_in_its_three_encodings() {
    let ascii = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n2 0 0\n2 1 0\n0 1 0.25\n4 0 1 2 3\n";
    let folder = Folder::with(&[("a.ply", ascii)]);
    std::fs::write(folder.path("b.ply"), binary(true)).unwrap();
    std::fs::write(folder.path("l.ply"), binary(false)).unwrap();
    for name in ["a.ply", "b.ply", "l.ply"] {
        let mesh = mesh_of(&folder, name);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]], "{name}");
        assert_eq!(mesh.vertices[3], [0.0, 1.0, 0.25], "{name}");
    }
}

#[test]
fn errors_of_ply_files() {
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (content, expected) in [
        (
            format!("{head}0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
            "m.ply: face 0: vertex 3 does not exist, the file has 3",
        ),
        (
            format!("{head}0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"),
            "m.ply: face 0: vertex -1 does not exist",
        ),
        (
            format!("{head}0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"),
            "m.ply:11: \"1 nan 0\" is not what the header promises",
        ),
        (
            format!("{head}0 0 0\n1 0 0\n0 1 0\n2 0 1\n"),
            "m.ply: face 0: a face needs 3 corners",
        ),
        (
            format!("{head}0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n"),
            "m.ply:11: \"1 x 0\" is not what the header promises",
        ),
        (format!("{head}0 0 0\n1 0 0\n"), "m.ply:12: "),
        (
            head.replace("element face 1", "element face 0") + "0 0 0\n1 0 0\n0 1 0\n",
            "m.ply: has no faces",
        ),
        (
            head.replace("property float z\n", "") + "0 0\n1 0\n0 1\n3 0 1 2\n",
            "m.ply: has no property z",
        ),
        (
            format!("{head}0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n"),
            "m.ply: no triangle has any area",
        ),
        ("plyx\n".to_string(), "m.ply:1: "),
    ] {
        let found = Folder::with(&[("m.ply", &content)]).error("m.ply");
        assert!(found.starts_with(expected), "{found:?} is not {expected:?}");
        assert!(found.contains("; "), "{found:?} does not say what to do");
    }
}

#[test]
fn a_binary_nan_is_found() {
    let folder = Folder::with(&[]);
    let mut bytes = binary(false);
    let header = bytes.len() - (4 * 17 + 17);
    bytes[header + 17..header + 21].copy_from_slice(&f32::NAN.to_le_bytes());
    std::fs::write(folder.path("m.ply"), bytes).unwrap();
    assert!(
        folder
            .error("m.ply")
            .starts_with("m.ply: vertex 1: not a finite number"),
        "{}",
        folder.error("m.ply")
    );
}

#[test]
fn degenerate_triangles_are_reported() {
    let folder = Folder::with(&[
        ("t.obj", &format!("{TETRAHEDRON}f 1 1 2\n")),
        (
            "s.xml",
            &scene("<shape type=\"obj\"><string name=\"filename\" value=\"t.obj\"/></shape>"),
        ),
    ]);
    for name in ["t.obj", "s.xml"] {
        let loaded = folder.load(name, &Options::default()).unwrap();
        assert_eq!(loaded.warnings.len(), 1);
        assert!(
            loaded.warnings[0].ends_with("t.obj: 1 triangles without area are left out"),
            "{:?}",
            loaded.warnings
        );
    }
}

#[test]
fn a_mesh_in_a_scene_is_placed_and_flipped() {
    let read = |extra: &str| {
        let body = format!(
            "<shape type=\"obj\"><string name=\"filename\" value=\"t.obj\"/><boolean name=\"face_normals\" value=\"true\"/>{extra}</shape>"
        );
        mesh_of(
            &Folder::with(&[("t.obj", TETRAHEDRON), ("s.xml", &scene(&body))]),
            "s.xml",
        )
    };
    assert!((volume(&read("")) - 1.0 / 6.0).abs() < 1e-12);
    let doubled = "<transform name=\"to_world\"><scale value=\"2\"/><translate x=\"4\"/></transform>";
    assert!((volume(&read(doubled)) - 8.0 / 6.0).abs() < 1e-9);
    assert!((volume(&read("<boolean name=\"flip_normals\" value=\"true\"/>")) + 1.0 / 6.0).abs() < 1e-12);
    assert!(read("").normals.is_empty());
}
