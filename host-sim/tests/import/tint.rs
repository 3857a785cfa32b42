//! Textures and vertex colours: pictures, checkerboards, and where meshes say that they are in them.

use host_sim::quantise::CoreScene;

use super::*;

/// The sRGB code 188 as light: ((188/255 + 0.055) / 1.055)^2.4.
const CODE_188: f64 = 0.502_886;
/// A square of four corners, each with its place in a picture.
const SQUARE: &str =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 0.75\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
const TRIANGLE: &str = "v 0 0 0 1 0 0\nv 1 0 0 0 2 0\nv 0 1 0 0 0 0.25\nf 1 2 3\n";

/// Two pixels beside each other, of codes (255, 0, 0) and (188, 188, 188), in `p.png`.
fn folder(files: &[(&str, &str)]) -> Folder {
    let folder = Folder::with(files);
    let mut picture = image::RgbImage::new(2, 1);
    picture.put_pixel(0, 0, image::Rgb([255, 0, 0]));
    picture.put_pixel(1, 0, image::Rgb([188; 3]));
    picture.save(folder.path("p.png")).unwrap();
    folder
}

fn diffuse(texture: &str) -> String {
    format!("<shape type=\"rectangle\"><bsdf type=\"diffuse\">{texture}</bsdf></shape>")
}

fn bitmap(inside: &str) -> String {
    let texture = "<texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" value=\"p.png\"/>";
    diffuse(&format!("{texture}{inside}</texture>"))
}

fn texture(scene: &SceneDesc, material: usize) -> (&TextureDesc, [[f64; 3]; 2]) {
    match &scene.materials[material].tint {
        Some(TintDesc::Texture { texture, to_uv }) => (texture, *to_uv),
        other => panic!("{other:?}"),
    }
}

fn mesh(scene: &SceneDesc, shape: usize) -> &MeshDesc {
    match &scene.shapes[shape].geometry {
        GeometryDesc::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_bitmap_is_light_unless_it_is_raw() {
    let read = |inside: &str| {
        let loaded = folder(&[("s.xml", &scene(&bitmap(inside)))]).load("s.xml", &Options::default());
        loaded.unwrap().scene
    };
    let plain = read("");
    let (picture, to_uv) = texture(&plain, 0);
    assert_eq!((picture.width, picture.height, picture.nearest), (2, 1, false));
    assert!(near(picture.texels[0], [1.0, 0.0, 0.0]) && near(picture.texels[1], [CODE_188; 3]));
    assert_eq!(to_uv, TintDesc::IN_PLACE);
    let BsdfDesc::Diffuse { reflectance } = plain.materials[0].bsdf else {
        panic!("{:?}", plain.materials)
    };
    assert_eq!(reflectance, [1.0; 3], "the picture multiplies it");
    // A corner at (-1, -1) is at (0, 0), and faces as the rectangle did.
    let square = mesh(&plain, 0);
    assert_eq!(square.uvs, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert!(near(square.vertices[2], [1.0, 1.0, 0.0]));
    let other = read(
        "<boolean name=\"raw\" value=\"true\"/><string name=\"filter_type\" value=\"nearest\"/>\
         <transform name=\"to_uv\"><scale x=\"2\" y=\"3\"/><translate x=\"0.5\" y=\"0.25\"/></transform>",
    );
    let (raw, to_uv) = texture(&other, 0);
    assert!(raw.nearest && near(raw.texels[1], [188.0 / 255.0; 3]), "{raw:?}");
    assert_eq!(to_uv, [[2.0, 0.0, 0.5], [0.0, 3.0, 0.25]]);
}

#[test]
fn a_texture_that_two_materials_name_is_in_flash_once() {
    let board = "<texture type=\"checkerboard\" id=\"board\"><rgb name=\"color0\" value=\"0.5, 0.25, 0.125\"/></texture>\n";
    let shape = "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><ref name=\"reflectance\" id=\"board\"/></bsdf></shape>";
    let other = diffuse("<texture type=\"checkerboard\" name=\"reflectance\"/>");
    let scene = read(&format!(
        "{board}{shape}{shape}{other}<emitter type=\"constant\"/>"
    ));
    assert_eq!(scene.materials.len(), 3);
    let (checks, _) = texture(&scene, 1);
    let (even, odd) = ([0.5, 0.25, 0.125], [0.2; 3]);
    assert_eq!(
        (checks.width, checks.height, checks.nearest),
        (2, 2, true),
        "{checks:?}"
    );
    assert_eq!(checks.texels, [even, odd, odd, even]);
    let core = CoreScene::new(&scene).unwrap();
    assert_eq!(core.owned_textures().len(), 2, "two of the three are one");
}

#[test]
fn what_no_texture_can_be_is_told() {
    let told = |body: &str| folder(&[("s.xml", &scene(body))]).error("s.xml");
    let clamped = told(&bitmap("<string name=\"wrap_mode\" value=\"clamp\"/>"));
    assert!(
        clamped.contains("s.xml:3: wrap_mode \"clamp\" is not supported"),
        "{clamped}"
    );
    let filter = told(&bitmap("<string name=\"filter_type\" value=\"cubic\"/>"));
    assert!(filter.contains("write bilinear or nearest"), "{filter}");
    let gone = told(&bitmap("").replace("p.png", "q.png"));
    assert!(gone.starts_with("q.png: "), "{gone}");
    let text = told(&bitmap("").replace("p.png", "s.xml"));
    assert!(text.starts_with("s.xml: is no picture"), "{text}");
    let ball = told(&bitmap("").replace("rectangle", "sphere"));
    assert!(ball.contains("a sphere cannot have a texture"), "{ball}");
    let normal = "<texture type=\"mesh_attribute\" name=\"reflectance\"><string name=\"name\" value=\"vertex_n\"/></texture>";
    assert!(told(&diffuse(normal)).contains("attribute \"vertex_n\" is not supported"));
    let noise = told(&diffuse("<texture type=\"noise\" name=\"reflectance\"/>"));
    assert!(noise.contains("checkerboard"), "{noise}");
}

#[test]
fn an_obj_says_where_in_the_picture_it_is() {
    let mtl = "newmtl a\nKd 0.5 1 1\nmap_Kd p.png\n";
    let with = |obj: &str| {
        let text = format!("mtllib m.mtl\nusemtl a\n{obj}");
        folder(&[("m.obj", &text), ("m.mtl", mtl)])
            .load("m.obj", &Options::default())
            .unwrap()
    };
    let loaded = with(SQUARE);
    assert!(
        loaded.warnings.iter().all(|warning| !warning.contains("map_Kd")),
        "{:?}",
        loaded.warnings
    );
    // v from the picture's last row up in the file, from its first row down here.
    let square = mesh(&loaded.scene, 0);
    assert_eq!(square.uvs, [[0.0, 1.0], [1.0, 1.0], [1.0, 0.25], [0.0, 0.0]]);
    let (picture, _) = texture(&loaded.scene, 0);
    assert!(near(picture.texels[1], [CODE_188; 3]));
    let BsdfDesc::Diffuse { reflectance } = loaded.scene.materials[0].bsdf else {
        panic!("{:?}", loaded.scene.materials)
    };
    assert_eq!(reflectance, [0.5, 1.0, 1.0]);
    // One corner that is nowhere: the mean, as for a mesh without any.
    let half = with(&SQUARE.replace("4/4", "4"));
    assert!(mesh(&half.scene, 0).uvs.is_empty() && half.scene.materials[0].tint.is_none());
    let BsdfDesc::Diffuse { reflectance } = half.scene.materials[0].bsdf else {
        panic!("{:?}", half.scene.materials)
    };
    let mean = [0.5 * (1.0 + CODE_188) / 2.0, CODE_188 / 2.0, CODE_188 / 2.0];
    assert!(near(reflectance, mean), "{reflectance:?} is not {mean:?}");
}

#[test]
fn colours_of_vertices_are_read_and_held_to_what_surfaces_can() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\nproperty float t\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n\
               0 0 0 255 0 51 0.25 0.5\n1 0 0 0 255 0 1 0\n0 1 0 0 0 255 0 -2\n3 0 1 2\n";
    let attribute = "<bsdf type=\"diffuse\"><texture type=\"mesh_attribute\" name=\"reflectance\">\
                     <string name=\"name\" value=\"vertex_color\"/></texture></bsdf>";
    let shape = |kind: &str, file: &str| {
        format!("<shape type=\"{kind}\"><string name=\"filename\" value=\"{file}\"/>{attribute}</shape>")
    };
    let body = shape("obj", "m.obj") + &shape("ply", "m.ply");
    let folder = Folder::with(&[("m.obj", TRIANGLE), ("m.ply", ply), ("s.xml", &scene(&body))]);
    let loaded = folder.load("s.xml", &Options::default()).unwrap().scene;
    let tints = loaded.materials.iter().map(|material| &material.tint);
    assert!(
        tints.clone().all(|tint| matches!(tint, Some(TintDesc::Vertices))),
        "{:?}",
        loaded.materials
    );
    // 2 is no reflectance.
    let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.25]];
    assert_eq!(mesh(&loaded, 0).colors, colors);
    let found = mesh(&loaded, 1);
    assert!(near(found.colors[0], [1.0, 0.0, 0.2]), "{:?}", found.colors);
    assert_eq!(found.uvs, [[0.25, 0.5], [1.0, 0.0], [0.0, -2.0]]);
    // By themselves, too: their colours are all they are of.
    for file in ["m.obj", "m.ply"] {
        let shown = folder.load(file, &Options::default()).unwrap().scene;
        let material = &shown.materials[shown.shapes[0].material];
        assert!(matches!(material.tint, Some(TintDesc::Vertices)), "{material:?}");
        assert_eq!(mesh(&shown, 0).colors.len(), 3);
    }
    // In a file that colours only some, the others are white.
    let some = Folder::with(&[("m.obj", &TRIANGLE.replace(" 1 0 0\nv", "\nv"))]);
    let some = some.load("m.obj", &Options::default()).unwrap().scene;
    assert_eq!(mesh(&some, 0).colors[0], [1.0; 3]);
}
