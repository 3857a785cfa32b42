//! glTF and GLB as Blender, trimesh and pygltflib write them (`tests/models/make.py`): place, size, colour, light.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use host_sim::run;

use super::*;

fn model(name: &str) -> Loaded {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/models")
        .join(name);
    load(&path, &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The picture of the fixed-point core, 64 pixels wide.
fn rendered(scene: &SceneDesc) -> impl Fn(usize, usize) -> [f32; 3] + use<> {
    let options = run::Options {
        width: 64,
        height: 64,
        spp: 64,
        ..run::Options::for_scene(scene)
    };
    let (picture, _) = run::render_fixed(scene, &options, &(), &AtomicBool::new(false)).unwrap();
    move |x, y| picture.rgb[64 * y + x]
}

fn assert_color(found: [f32; 3], wanted: [f64; 3], share: f64) {
    for (f, w) in found.iter().zip(wanted) {
        assert!(
            (f64::from(*f) - w).abs() <= share * w + 1e-3,
            "{found:?} is not {wanted:?}"
        );
    }
}

fn mesh<'a>(scene: &'a SceneDesc, name: &str) -> &'a MeshDesc {
    let shape = scene.shapes.iter().find(|shape| shape.name == name).unwrap();
    match &shape.geometry {
        GeometryDesc::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

fn extent(mesh: &MeshDesc) -> [Vec3; 2] {
    let of = |pick: fn(f64, f64) -> f64| {
        mesh.vertices
            .iter()
            .copied()
            .reduce(|a, b| [0, 1, 2].map(|i| pick(a[i], b[i])))
            .unwrap()
    };
    [of(f64::min), of(f64::max)]
}

fn material<'a>(scene: &'a SceneDesc, name: &str) -> &'a BsdfDesc {
    let name = format!("material \"{name}\"");
    &scene
        .materials
        .iter()
        .find(|material| material.name == name)
        .unwrap()
        .bsdf
}

#[test]
fn nested_transforms_end_where_they_should() {
    let scene = model("nested.gltf").scene;
    let [low, high] = extent(mesh(&scene, "node \"Red\""));
    assert!(
        near(low, [0.5, -0.25, -1.0]) && near(high, [1.5, 0.25, 1.0]),
        "{low:?} {high:?}"
    );
    let [low, high] = extent(mesh(&scene, "node \"Green\""));
    assert!(
        near(low, [-2.0, -0.5, -0.5]) && near(high, [-1.0, 0.5, 0.5]),
        "{low:?} {high:?}"
    );
    assert!(volume(mesh(&scene, "node \"Red\"")) > 0.99);
    assert!(near(scene.camera.origin, [0.0, 8.0, 0.0]) && near(scene.camera.forward, [0.0, -1.0, 0.0]));
    assert!((scene.camera.fov_x - 1.0_f64.to_degrees()).abs() < 1e-4);
    // From 7.75 m the red top is pixels 35.8 to 43.3 across and 24.4 to 39.6 down; the sun's 3 W/m² fall straight on it.
    let at = rendered(&scene);
    let (red, green) = ([0.8, 0.05, 0.05], [0.05, 0.8, 0.05]);
    let lit = |c: [f64; 3]| c.map(|c| 3.0 * c / std::f64::consts::PI);
    for (x, y) in [(36, 25), (42, 25), (36, 38), (42, 38)] {
        assert_color(at(x, y), lit(red), 0.01);
    }
    assert_color(at(20, 32), lit(green), 0.01);
    for (x, y) in [(34, 32), (44, 32), (40, 22), (40, 41), (32, 32)] {
        assert_color(at(x, y), [0.0; 3], 0.0);
    }
}

#[test]
fn lights_have_their_place_colour_and_unit() {
    let loaded = model("lights.glb");
    let at = rendered(&loaded.scene);
    // About the red point of 40 W/sr, 1 m above a floor of 0.5; the blue sun gives 0.5 W/m² everywhere. One light is
    // chosen for each sample, so that a mean over many is what has little noise: 1 % of the red, 3 % of the blue.
    let pi = std::f64::consts::PI;
    let (mut found, mut wanted) = ([0.0; 3], 0.0);
    for (x, y) in (15..26).flat_map(|x| (27..38).map(move |y| (x, y))) {
        (0..3).for_each(|i| found[i] += f64::from(at(x, y)[i]) / 121.0);
        let metres = |pixel: usize| (pixel as f64 - 31.5) / 32.0 * 0.5_f64.tan() * 5.0;
        let (dx, dz) = (metres(x) + 1.0, metres(y));
        wanted += 20.0 / pi * (1.0 + dx * dx + dz * dz).powf(-1.5) / 121.0;
    }
    let [red, green, blue] = found;
    assert!((red / wanted - 1.0).abs() < 0.04, "{red} is not {wanted}");
    assert!((blue * pi / 0.25 - 1.0).abs() < 0.12, "{blue}");
    assert!(green < 0.2 * red, "{green}");
    assert!(
        loaded
            .warnings
            .iter()
            .any(|w| w.contains("\"Spot\": its cone is left out")),
        "{:?}",
        loaded.warnings
    );
}

#[test]
fn glass_and_emission_keep_their_numbers() {
    let loaded = model("glass.glb");
    let scene = &loaded.scene;
    assert!(
        matches!(material(scene, "Clear"), BsdfDesc::Dielectric { int_ior, .. } if (int_ior - 1.33).abs() < 1e-6)
    );
    let BsdfDesc::RoughDielectric {
        alpha,
        int_ior,
        specular_transmittance,
        ..
    } = material(scene, "Frosted")
    else {
        panic!()
    };
    assert!((alpha - 0.25).abs() < 1e-6 && (int_ior - 1.5).abs() < 1e-6);
    assert!(near(*specular_transmittance, [0.5, 0.9, 0.6]));
    // Between the panes the lamp itself is seen.
    assert_color(rendered(scene)(32, 32), [8.0, 4.0, 2.0], 0.001);
    assert!(loaded.warnings.iter().any(|w| w.contains("thin walls")));
}

#[test]
fn metals_are_metals_and_what_lacks_light_is_lit() {
    let loaded = model("metals.glb");
    let scene = &loaded.scene;
    assert!(matches!(
        material(scene, "Silver"),
        BsdfDesc::Conductor { eta_k: Some(_), .. }
    ));
    let BsdfDesc::RoughConductor {
        alpha,
        eta_k: Some((eta, k)),
        ..
    } = material(scene, "Gold")
    else {
        panic!()
    };
    assert!((alpha - 0.16).abs() < 1e-6);
    // Straight on, gold reflects its colour.
    for (i, wanted) in [1.0, 0.77, 0.34].into_iter().enumerate() {
        let (n, k2) = (eta[i], k[i] * k[i]);
        let straight = ((n - 1.0).powi(2) + k2) / ((n + 1.0).powi(2) + k2);
        assert!((straight - wanted).abs() < 1e-3, "{straight} is not {wanted}");
    }
    assert!(matches!(material(scene, "Half"), BsdfDesc::BlinnPhong { .. }));
    assert_eq!((scene.lights.len(), scene.shapes.len()), (2, 4));
    for told in ["no camera", "no light", "floor"] {
        assert!(
            loaded.notes.iter().any(|note| note.contains(told)),
            "{told}: {:?}",
            loaded.notes
        );
    }
}

#[test]
fn a_texture_lies_on_its_mesh() {
    let loaded = model("textured.glb");
    let board = loaded
        .scene
        .materials
        .iter()
        .find(|material| material.name == "material \"Board\"")
        .unwrap();
    let Some(TintDesc::Texture { texture, to_uv }) = &board.tint else {
        panic!("{board:?}")
    };
    assert_eq!(
        (texture.width, texture.height, *to_uv),
        (8, 8, TintDesc::IN_PLACE)
    );
    let orange = [1.0, 0.5029, 0.0];
    let near = |found: Vec3| found.iter().zip(orange).all(|(a, b)| (a - b).abs() < 1e-3);
    assert!(near(texture.texels[0]) && near(texture.texels[3]) && texture.texels[4] == [0.0; 3]);
    assert!(!loaded.warnings.iter().any(|warning| warning.contains("mean")));
    // Its left half is orange, its right one black.
    let pixel = rendered(&loaded.scene);
    let (left, right) = (pixel(22, 26), pixel(42, 26));
    assert!(left[0] > 0.2 && right[0] < 0.05 * left[0], "{left:?} {right:?}");
    assert!(
        (f64::from(left[1] / left[0]) - 0.5).abs() < 0.15 && left[2] < 0.3 * left[0],
        "{left:?}"
    );
}

/// The same material on a part that does not say where in the texture it is: there its mean.
#[test]
fn without_coordinates_a_texture_is_its_mean_light() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/textured.glb");
    let bytes = std::fs::read(path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let mut json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let parts = json["meshes"][0]["primitives"].as_array_mut().unwrap();
    let mut bare = parts[0].clone();
    bare["attributes"].as_object_mut().unwrap().remove("TEXCOORD_0");
    parts.push(bare);
    let mut text = json.to_string();
    text += &" ".repeat(text.len().next_multiple_of(4) - text.len());
    let whole = (20 + text.len() + bytes.len() - 20 - length) as u32;
    let glb = [
        &bytes[..8],
        &whole.to_le_bytes(),
        &(text.len() as u32).to_le_bytes(),
        &bytes[16..20],
        text.as_bytes(),
        &bytes[20 + length..],
    ]
    .concat();
    let folder = Folder::with(&[]);
    std::fs::write(folder.path("s.glb"), glb).unwrap();
    let scene = folder.load("s.glb", &Options::default()).unwrap().scene;
    let [there, bare] = ["part 0", "part 1"].map(|part| {
        let shape = scene.shapes.iter().find(|shape| shape.name.ends_with(part));
        &scene.materials[shape.unwrap().material]
    });
    assert!(matches!(there.tint, Some(TintDesc::Texture { .. })) && bare.tint.is_none());
    let BsdfDesc::Diffuse { reflectance } = bare.bsdf else {
        panic!("{bare:?}")
    };
    let wanted = [0.5, 0.2514, 0.0];
    assert!(
        reflectance.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-3),
        "{reflectance:?}"
    );
}

#[test]
fn strips_fans_sparse_data_and_mirrors() {
    let scene = model("strips.gltf").scene;
    let [a, b] = ["node \"Pair\" part 0", "node \"Pair\" part 1"].map(|name| mesh(&scene, name));
    assert_eq!(extent(a), [[-2.0, 0.0, -1.0], [0.0, 1.0, -1.0]]);
    assert_eq!(extent(b), [[-6.0, 0.0, -1.0], [-4.0, 1.0, -0.5]]);
    for mesh in [a, b] {
        assert_eq!(mesh.triangles.len(), 2);
        for t in &mesh.triangles {
            let [p, q, r] = t.map(|i| mesh.vertices[i as usize]);
            let d = |q: Vec3| [0, 1, 2].map(|i| q[i] - p[i]);
            assert!(cross(d(q), d(r))[2] > 0.0, "{t:?} shows its back");
        }
    }
    assert_eq!(scene.shapes[1].emission, Some([4.0, 2.0, 0.0]));
}

/// A second node with the mesh of the first: one mesh in two places.
#[test]
fn nodes_of_one_mesh_share_it() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models");
    let text = std::fs::read_to_string(folder.join("nested.gltf")).unwrap();
    let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let nodes = json["nodes"].as_array_mut().unwrap();
    let first = nodes.len();
    for (name, height) in [("Again", 9), ("Twice", 18)] {
        nodes.push(serde_json::json!({"name": name, "mesh": 0, "scale": [0.5, 0.5, 0.5], "translation": [0, height, 0]}));
    }
    let roots = json["scenes"][0]["nodes"].as_array_mut().unwrap();
    roots.extend([first.into(), (first + 1).into()]);
    let here = Folder::with(&[("s.gltf", &json.to_string())]);
    std::fs::copy(folder.join("nested.bin"), here.path("nested.bin")).unwrap();
    let scene = here.load("s.gltf", &Options::default()).unwrap().scene;
    let shape = |name: &str| scene.shapes.iter().find(|shape| shape.name == name).unwrap();
    let [again, twice] = ["node \"Again\"", "node \"Twice\""].map(|name| match &shape(name).geometry {
        GeometryDesc::Instance(instance) => instance,
        other => panic!("{other:?}"),
    });
    assert!(std::sync::Arc::ptr_eq(&again.mesh, &twice.mesh));
    let [low, high] = extent(&again.placed());
    let middle = [0, 1, 2].map(|i| (low[i] + high[i]) / 2.0);
    assert!(near(middle, [0.0, 9.0, 0.0]), "{middle:?}");
    let whole = extent(&again.mesh);
    for i in 0..3 {
        assert!(((high[i] - low[i]) / (whole[1][i] - whole[0][i]) - 0.5).abs() < 1e-6);
    }
}

#[test]
fn broken_files_name_their_part() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models");
    let text = std::fs::read_to_string(folder.join("nested.gltf")).unwrap();
    let strips = std::fs::read_to_string(folder.join("strips.gltf")).unwrap();
    let tree = "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"children\":[1]},{\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]}";
    let draco = "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}";
    let empty = "{\"asset\":{\"version\":\"2.0\"}}";
    for (content, expected) in [
        (
            text.as_str(),
            "s.gltf: buffers[0]: no file nested.bin; put it beside the model",
        ),
        ("{\"asset\": oops", "s.gltf:1: is no glTF"),
        (tree, "s.gltf: nodes[0] is reached twice"),
        (draco, "s.gltf: needs the extension KHR_draco_mesh_compression"),
        (empty, "s.gltf: no triangle has any area"),
        (
            &strips.replace("\"count\": 8", "\"count\": 9"),
            "s.gltf: meshes[0], primitive 1: accessors[1] reaches beyond",
        ),
        (
            &strips.replace("base64,", "base64,!"),
            "s.gltf: buffers[0]: its data: uri is broken",
        ),
        (
            &strips.replace("\"mesh\": 0", "\"mesh\": 7"),
            "s.gltf: nodes[1].mesh: names what does not exist",
        ),
        (
            &strips.replace("\"POSITION\": 0", "\"POSITION\": 9"),
            "s.gltf: meshes[0] lacks what it must have",
        ),
        (
            &empty.replace("}}", "},\"images\":[{}]}"),
            "s.gltf: images[0] lacks what it must have",
        ),
        (
            "glTF\x02\0\0\0\x07\0\0\0",
            "s.gltf: is a broken GLB file: shorter than its own head",
        ),
    ] {
        let error = Folder::with(&[("s.gltf", content)]).error("s.gltf");
        assert!(
            error.starts_with(expected),
            "{error:?} does not start with {expected:?}"
        );
        assert_eq!(error.lines().count(), 1);
    }
}
