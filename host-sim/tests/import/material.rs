//! Materials and colours.

use super::*;

#[test]
fn defaults_are_mitsubas() {
    let scene = read("<shape type=\"sphere\"/><shape type=\"sphere\"><emitter type=\"area\"/></shape>");
    let material = |i: usize| &scene.materials[scene.shapes[i].material];
    assert!(
        matches!(
            material(0).bsdf,
            BsdfDesc::Diffuse {
                reflectance: [0.5, 0.5, 0.5]
            }
        ) && !material(0).two_sided
    );
    assert!(matches!(
        material(1).bsdf,
        BsdfDesc::Diffuse {
            reflectance: [0.0, 0.0, 0.0]
        }
    ));
    assert_eq!(scene.shapes[1].emission, Some([1.0; 3]));

    let bsdf = |text: &str| {
        read(&format!("<shape type=\"disk\">{text}</shape>"))
            .materials
            .remove(0)
    };
    let glass = bsdf("<bsdf type=\"dielectric\"/>").bsdf;
    assert!(matches!(
        glass,
        BsdfDesc::Dielectric {
            int_ior: 1.5046,
            ext_ior: 1.000277,
            ..
        }
    ));
    let named = bsdf("<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"Diamond\"/><string name=\"ext_ior\" value=\"water\"/></bsdf>").bsdf;
    assert!(matches!(
        named,
        BsdfDesc::Dielectric {
            int_ior: 2.419,
            ext_ior: 1.333,
            ..
        }
    ));
    let metal =
        bsdf("<bsdf type=\"roughconductor\"><string name=\"distribution\" value=\"ggx\"/></bsdf>").bsdf;
    assert!(matches!(
        metal,
        BsdfDesc::RoughConductor {
            alpha: 0.1,
            eta_k: None,
            ..
        }
    ));
    let gold = bsdf("<bsdf type=\"conductor\"><rgb name=\"eta\" value=\"0.2, 0.9, 1.1\"/><float name=\"k\" value=\"3\"/></bsdf>").bsdf;
    let BsdfDesc::Conductor {
        eta_k: Some((eta, k)),
        ..
    } = gold
    else {
        panic!("{gold:?}")
    };
    assert_eq!((eta, k), ([0.2, 0.9, 1.1], [3.0; 3]));
    let rough = bsdf("<bsdf type=\"orennayar\"><float name=\"sigma\" value=\"20\"/></bsdf>").bsdf;
    assert!(matches!(
        rough,
        BsdfDesc::OrenNayar {
            sigma_degrees: 20.0,
            model: OrenNayarModel::Qualitative,
            ..
        }
    ));
    let phong = bsdf("<bsdf type=\"blinnphong\"><float name=\"exponent\" value=\"9\"/><boolean name=\"normalized\" value=\"false\"/></bsdf>").bsdf;
    assert!(matches!(
        phong,
        BsdfDesc::BlinnPhong {
            exponent: 9.0,
            normalized: false,
            ..
        }
    ));
}

#[test]
fn materials_are_shared_by_reference_and_unused_ones_are_left_out() {
    let scene = read(
        "<bsdf type=\"twosided\" id=\"white\"><bsdf type=\"diffuse\"/></bsdf><bsdf type=\"diffuse\" id=\"idle\"/>\n<shape type=\"disk\" id=\"a\"><ref id=\"white\"/></shape><shape type=\"disk\"><ref id=\"white\"/></shape>\n<shape type=\"disk\"><bsdf type=\"twosided\"><ref id=\"idle\"/></bsdf></shape>",
    );
    let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["white", "idle"]);
    assert!(scene.materials.iter().all(|m| m.two_sided));
    assert_eq!(
        scene.shapes.iter().map(|s| s.material).collect::<Vec<_>>(),
        [0, 0, 1]
    );
    assert_eq!(
        (scene.shapes[0].name.as_str(), scene.shapes[1].name.as_str()),
        ("a", "disk at line 4")
    );
}

#[test]
fn colours_in_all_their_ways() {
    let intensity = |color: &str| {
        let scene = read(&format!("<emitter type=\"point\">{color}</emitter>"));
        let LightDesc::Point { intensity, .. } = scene.lights[0] else {
            panic!()
        };
        intensity
    };
    assert_eq!(
        intensity("<rgb name=\"intensity\" value=\"9, 8 7.5\"/>"),
        [9.0, 8.0, 7.5]
    );
    assert_eq!(intensity("<rgb name=\"intensity\" value=\"4\"/>"), [4.0; 3]);
    assert_eq!(intensity("<float name=\"intensity\" value=\"3\"/>"), [3.0; 3]);
    assert!(near(
        intensity("<rgb name=\"intensity\" value=\"#ff8000\"/>"),
        [1.0, 0.21586050, 0.0]
    ));
    // Mitsuba 3.9.1: `mi.traverse(emitter)['intensity.value']` of <spectrum value="1"/>, an equal-energy white.
    assert!(near(
        intensity("<spectrum name=\"intensity\" value=\"1\"/>"),
        [1.20479393, 0.948291, 0.908916056]
    ));
    let scene = read(
        "<shape type=\"disk\"><bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"0.3\"/></bsdf></shape>",
    );
    assert!(matches!(
        scene.materials[0].bsdf,
        BsdfDesc::Diffuse {
            reflectance: [0.3, 0.3, 0.3]
        }
    ));
}
