//! Transforms and shapes.

use super::*;

/// Where the rectangle's centre and axes go. Numbers from Mitsuba 3.9.1 (`scalar_rgb`):
/// `np.array(mi.traverse(mi.load_string(scene).shapes()[0])['to_world'].matrix)`, columns x, y and translation.
#[test]
fn transforms_are_mitsubas() {
    let cases: [(&str, Vec3, Vec3, Vec3); 6] = [
        (
            "<scale value=\"0.3, 0.6, 0.3\"/><rotate y=\"1\" angle=\"18\"/><translate value=\"-0.33, -0.4, -0.28\"/>",
            [0.285316944, 0.0, -0.0927051008],
            [0.0, 0.600000024, 0.0],
            [-0.330000013, -0.400000006, -0.280000001],
        ),
        (
            "<rotate x=\"1\" angle=\"-90\"/><translate y=\"-1\"/>",
            [1.0, 0.0, 0.0],
            [0.0, 0.0, -1.0],
            [0.0, -1.0, 0.0],
        ),
        (
            "<lookat origin=\"1.4, 1.0, -2.6\" target=\"0, 0.05, 0\" up=\"0, 1, 0\"/>",
            [0.88047111, 0.0, 0.474099815],
            [-0.145194262, 0.951950312, 0.269646466],
            [1.4, 1.0, -2.6],
        ),
        (
            "<lookat origin=\"1,2,3\" target=\"-1,0.5,2\"/>",
            [-0.301732481, 0.773700655, -0.557085991],
            [0.597690046, -0.301732481, -0.742781341],
            [1.0, 2.0, 3.0],
        ),
        (
            "<translate x=\"1\"/><matrix value=\"0 -1 0 1 0 0 0 0 2\"/>",
            [0.0, 1.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
        ),
        (
            "<matrix value=\"0 -2 0 5 3 0 0 6 0 0 1 7 0 0 0 1\"/><translate x=\"1\" y=\"1\" z=\"1\"/>",
            [0.0, 3.0, 0.0],
            [-2.0, 0.0, 0.0],
            [6.0, 7.0, 8.0],
        ),
    ];
    for (steps, x, y, translation) in cases {
        let scene = read(&format!(
            "<shape type=\"rectangle\"><transform name=\"to_world\">{steps}</transform></shape>"
        ));
        let GeometryDesc::Rectangle { center, u, v } = scene.shapes[0].geometry else {
            panic!("{steps}")
        };
        assert!(
            near(u, x) && near(v, y) && near(center, translation),
            "{steps}: {u:?} {v:?} {center:?}"
        );
    }
}

/// `(unit normal, area)` of the first shape.
fn flat(body: &str) -> (Vec3, f64) {
    match read(body).shapes[0].geometry {
        GeometryDesc::Rectangle { u, v, .. } => {
            let n = cross(u, v);
            let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
            (n.map(|x| x / length), 4.0 * length)
        }
        GeometryDesc::Disk { normal, radius, .. } => (normal, std::f64::consts::PI * radius * radius),
        ref other => panic!("{other:?}"),
    }
}

/// Sides as Mitsuba 3.9.1 shades them: `scene.ray_intersect(...).sh_frame.n` on these very shapes.
#[test]
fn normals_are_on_mitsubas_side() {
    for kind in ["rectangle", "disk"] {
        for (scale, flip, z) in [
            ("", false, 1.0),
            ("", true, -1.0),
            ("<scale x=\"-1\"/>", false, 1.0),
            ("<scale x=\"-1\"/>", true, -1.0),
            ("<scale z=\"-1\"/>", false, -1.0),
            ("<scale z=\"-1\"/>", true, 1.0),
        ] {
            let body = format!(
                "<shape type=\"{kind}\"><boolean name=\"flip_normals\" value=\"{flip}\"/><transform name=\"to_world\">{scale}</transform></shape>"
            );
            let (normal, _) = flat(&body);
            assert!(near(normal, [0.0, 0.0, z]), "{body}: {normal:?}");
        }
    }
}

#[test]
fn a_sheared_rectangle_is_two_triangles() {
    let scene = read(
        "<shape type=\"rectangle\"><transform name=\"to_world\"><matrix value=\"1 0.5 0 0 1 0 0 0 1\"/></transform></shape>",
    );
    let GeometryDesc::Mesh(mesh) = &scene.shapes[0].geometry else {
        panic!()
    };
    assert_eq!((mesh.triangles.len(), mesh.vertices.len()), (2, 4));
    assert!(near(mesh.vertices[2], [1.5, 1.0, 0.0]));
}

#[test]
fn a_cube_is_six_rectangles_facing_out() {
    for (steps, outwards) in [
        ("<scale value=\"1, 2, 3\"/><rotate y=\"1\" angle=\"30\"/>", 1.0),
        ("<scale value=\"-1, 2, 3\"/>", 1.0),
    ] {
        for (flip, sign) in [(false, outwards), (true, -outwards)] {
            let scene = read(&format!(
                "<shape type=\"cube\"><boolean name=\"flip_normals\" value=\"{flip}\"/><transform name=\"to_world\">{steps}<translate x=\"9\"/></transform></shape>"
            ));
            assert_eq!(scene.shapes.len(), 6);
            let mut area = 0.0;
            for shape in &scene.shapes {
                let GeometryDesc::Rectangle { center, u, v } = shape.geometry else {
                    panic!()
                };
                let n = cross(u, v);
                let out = [center[0] - 9.0, center[1], center[2]];
                let towards: f64 = n.iter().zip(out).map(|(a, b)| a * b).sum();
                assert!(towards * sign > 0.0, "{} faces the wrong way", shape.name);
                area += 4.0 * n.iter().map(|x| x * x).sum::<f64>().sqrt();
            }
            // 2 (2·4 + 4·6 + 6·2) for the box 2 × 4 × 6.
            assert!((area - 88.0).abs() < 1e-9, "{area}");
        }
    }
}

#[test]
fn a_skewed_cube_is_a_closed_mesh() {
    for (matrix, flip, expected) in [
        ("1 0.5 0 0 1 0 0 0 1", false, 8.0),
        ("1 0.5 0 0 1 0 0 0 1", true, -8.0),
        ("-1 0.5 0 0 1 0 0 0 1", false, 8.0),
    ] {
        let scene = read(&format!(
            "<shape type=\"cube\"><boolean name=\"flip_normals\" value=\"{flip}\"/><transform name=\"to_world\"><matrix value=\"{matrix}\"/></transform></shape>"
        ));
        let GeometryDesc::Mesh(mesh) = &scene.shapes[0].geometry else {
            panic!()
        };
        assert_eq!(mesh.triangles.len(), 12);
        assert!(
            (volume(mesh) - expected).abs() < 1e-9,
            "{matrix} {flip}: {}",
            volume(mesh)
        );
    }
}

#[test]
fn spheres_scale_and_turn_inside_out() {
    let place = "<transform name=\"to_world\"><scale value=\"2\"/><translate y=\"1\"/></transform>";
    let sphere = "<point name=\"center\" value=\"1,0,0\"/><float name=\"radius\" value=\"2\"/>";
    let scene = read(&format!("<shape type=\"sphere\">{sphere}{place}</shape>"));
    let GeometryDesc::Sphere { center, radius } = scene.shapes[0].geometry else {
        panic!()
    };
    assert!(near(center, [2.0, 1.0, 0.0]) && (radius - 4.0).abs() < 1e-12);
    // A flipped glass ball is air in glass.
    let glass = "<bsdf type=\"dielectric\"><float name=\"int_ior\" value=\"1.5\"/><float name=\"ext_ior\" value=\"1\"/></bsdf>";
    for turned in [
        "<boolean name=\"flip_normals\" value=\"true\"/>",
        "<float name=\"radius\" value=\"-1\"/>",
    ] {
        let scene = read(&format!("<shape type=\"sphere\">{turned}{glass}</shape>"));
        let material = &scene.materials[scene.shapes[0].material];
        assert!(
            matches!(
                material.bsdf,
                BsdfDesc::Dielectric {
                    int_ior: 1.0,
                    ext_ior: 1.5,
                    ..
                }
            ),
            "{turned}"
        );
    }
}

/// A pyramid without its base.
const TENT: &str = "v 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nf 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 2\n";

fn camp(body: &str) -> Folder {
    let group = "<shape type=\"shapegroup\" id=\"camp\"><shape type=\"obj\"><string name=\"filename\" value=\"tent.obj\"/>\
                 <transform name=\"to_world\"><translate z=\"1\"/></transform></shape></shape>\n";
    Folder::with(&[("tent.obj", TENT), ("s.xml", &scene(&format!("{group}{body}")))])
}

#[test]
fn instances_share_their_mesh() {
    let place = |steps: &str| {
        format!(
            "<shape type=\"instance\"><ref id=\"camp\"/><transform name=\"to_world\">{steps}</transform></shape>"
        )
    };
    let turned = place("<scale value=\"2\"/><rotate z=\"1\" angle=\"90\"/><translate x=\"5\"/>");
    let uneven = place("<scale x=\"2\" y=\"3\" z=\"1\"/>");
    let mirrored = place("<scale x=\"-1\"/>");
    let body = turned + &place("<translate y=\"-3\"/>") + &uneven + &mirrored;
    let loaded = camp(&body).load("s.xml", &Options::default()).unwrap();
    let shapes = &loaded.scene.shapes;
    assert_eq!(shapes.len(), 4);
    let (GeometryDesc::Instance(first), GeometryDesc::Instance(second)) =
        (&shapes[0].geometry, &shapes[1].geometry)
    else {
        panic!("{shapes:?}")
    };
    assert!(std::sync::Arc::ptr_eq(&first.mesh, &second.mesh));
    // The top, at (0, 0, 2) in the group: doubled, and moved by 5.
    let top = first.placed().vertices[0];
    assert!(near(top, [5.0, 0.0, 4.0]), "{top:?}");
    // A foot at (1, 0, 1): turned to y.
    let foot = first.placed().vertices[1];
    assert!(near(foot, [5.0, 2.0, 2.0]), "{foot:?}");
    assert!(near(second.placed().vertices[0], [0.0, -3.0, 2.0]));
    for (shape, foot, factor) in [(2, [2.0, 0.0, 1.0], 6.0), (3, [-1.0, 0.0, 1.0], 1.0)] {
        let GeometryDesc::Mesh(mesh) = &shapes[shape].geometry else {
            panic!("{:?}", shapes[shape])
        };
        assert!(near(mesh.vertices[1], foot), "{:?}", mesh.vertices);
        // The sides still face outwards: the same sign, and so much of the volume over the origin.
        assert!((volume(mesh) / volume(&first.mesh) - factor).abs() < 1e-9);
    }
}

#[test]
fn what_no_instance_can_be_is_told() {
    let told = |body: &str| camp(body).error("s.xml");
    let none = told("<shape type=\"instance\"/>");
    assert!(none.contains("names no shapegroup"), "{none}");
    let ball = told("<shape type=\"sphere\" id=\"b\"/><shape type=\"instance\"><ref id=\"b\"/></shape>");
    assert!(ball.contains("is no shapegroup"), "{ball}");
    let round = error("<shape type=\"shapegroup\" id=\"g\"><shape type=\"sphere\"/></shape>");
    assert!(round.contains("only meshes can stand in a shapegroup"), "{round}");
    let lamp = error(
        "<shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"><transform name=\"to_world\"><matrix value=\"1 1 0 0 1 0 0 0 1\"/>\
         </transform><emitter type=\"area\"/></shape></shape>",
    );
    assert!(lamp.contains("cannot emit light"), "{lamp}");
}
