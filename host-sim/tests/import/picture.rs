//! Parameters, lights, camera, integrator, and the scenes beside the repository.

use std::path::Path;

use super::*;

#[test]
fn parameters_are_substituted_and_overridden() {
    let text = scene(
        "<default name=\"r\" value=\"2\"/><default name=\"ra\" value=\"7\"/>\n<shape type=\"sphere\" id=\"\\$x\"><float name=\"radius\" value=\"$r\"/><point name=\"center\" value=\"$ra, 0, $r.5\"/></shape>",
    );
    let folder = Folder::with(&[("s.xml", &text)]);
    let read = |parameters: &[(&str, &str)]| {
        let parameters = parameters
            .iter()
            .map(|(a, b)| (a.to_string(), b.to_string()))
            .collect();
        folder.load(
            "s.xml",
            &Options {
                parameters,
                lenient: false,
            },
        )
    };
    let sphere = |loaded: Loaded| match loaded.scene.shapes[0].geometry {
        GeometryDesc::Sphere { center, radius } => (center, radius),
        ref other => panic!("{other:?}"),
    };
    let plain = read(&[]).unwrap();
    assert_eq!(plain.scene.shapes[0].name, "$x");
    assert_eq!(sphere(plain), ([7.0, 0.0, 2.5], 2.0));
    assert_eq!(sphere(read(&[("r", "3")]).unwrap()), ([7.0, 0.0, 3.5], 3.0));
    let error = read(&[("rr", "3")]).unwrap_err().to_string();
    assert!(
        error.contains("no $rr in the scene to set; did you mean \"r\"?"),
        "{error}"
    );
}

#[test]
fn includes_are_in_place_and_files_are_relative_to_their_own() {
    let folder = Folder::with(&[(
        "s.xml",
        &scene("<include filename=\"sub/part.xml\"/><shape type=\"disk\"><ref id=\"m\"/></shape>"),
    )]);
    std::fs::create_dir(folder.path("sub")).unwrap();
    let part = "<scene version=\"3.0.0\"><bsdf type=\"diffuse\" id=\"m\"/><shape type=\"obj\"><string name=\"filename\" value=\"t.obj\"/></shape></scene>";
    std::fs::write(folder.path("sub/part.xml"), part).unwrap();
    std::fs::write(folder.path("sub/t.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let scene = folder.load("s.xml", &Options::default()).unwrap().scene;
    assert_eq!(scene.shapes.len(), 2);
    assert_eq!(scene.materials[scene.shapes[1].material].name, "m");
}

#[test]
fn lights_by_place_or_by_transform() {
    let scene = read(
        "<emitter type=\"point\"><transform name=\"to_world\"><translate value=\"1, 2, 3\"/></transform></emitter><emitter type=\"directional\"><vector name=\"direction\" value=\"0, -2, 0\"/><rgb name=\"irradiance\" value=\"2\"/></emitter><emitter type=\"directional\"><transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/></transform></emitter>",
    );
    assert!(matches!(
        scene.lights[0],
        LightDesc::Point {
            position: [1.0, 2.0, 3.0],
            ..
        }
    ));
    assert!(matches!(
        scene.lights[1],
        LightDesc::Directional {
            direction: [0.0, -1.0, 0.0],
            irradiance: [2.0, 2.0, 2.0]
        }
    ));
    let LightDesc::Directional { direction, .. } = scene.lights[2] else {
        panic!()
    };
    assert!(near(direction, [0.0, -1.0, 0.0]));
}

#[test]
fn an_environment_keeps_its_pixels_in_place() {
    let folder = Folder::with(&[]);
    exr::prelude::write_rgb_file(folder.path("sky.exr"), 4, 2, |x, y| (x as f32, y as f32, 0.5_f32)).unwrap();
    let hdr = image::Rgb32FImage::from_fn(4, 2, |x, y| image::Rgb([x as f32, y as f32, 0.5]));
    image::DynamicImage::ImageRgb32F(hdr)
        .save(folder.path("sky.hdr"))
        .unwrap();
    for file in ["sky.exr", "sky.hdr"] {
        let text = scene(&format!(
            "<emitter type=\"envmap\"><string name=\"filename\" value=\"{file}\"/><float name=\"scale\" value=\"2\"/></emitter>"
        ));
        std::fs::write(folder.path("s.xml"), text).unwrap();
        let scene = folder.load("s.xml", &Options::default()).unwrap().scene;
        let LightDesc::EnvMap {
            width: 4,
            height: 2,
            ref pixels,
            to_world,
        } = scene.lights[0]
        else {
            panic!()
        };
        assert!(near(pixels[4 + 3], [6.0, 2.0, 1.0]), "{file}: {pixels:?}");
        assert_eq!(to_world[2], [0.0, 0.0, 1.0]);
    }
}

fn sensor(inside: &str) -> SceneDesc {
    sensor_of("perspective", 200, 100, inside)
}

fn sensor_of(kind: &str, width: u32, height: u32, inside: &str) -> SceneDesc {
    let text = format!(
        "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"{kind}\">{inside}<film type=\"hdrfilm\"><integer name=\"width\" value=\"{width}\"/><integer name=\"height\" value=\"{height}\"/><rfilter type=\"box\"/></film></sensor></scene>"
    );
    Folder::with(&[("s.xml", &text)])
        .load("s.xml", &Options::default())
        .unwrap_or_else(|e| panic!("{e}"))
        .scene
}

/// Mitsuba 3.9.1: `mi.traverse(sensor)['x_fov']` for these films.
#[test]
fn fields_of_view_are_mitsubas() {
    for (axis, wide, tall) in [
        ("x", 40.0, 40.0),
        ("y", 72.10477447509766, 20.628210067749023),
        ("smaller", 72.10477447509766, 40.0),
        ("larger", 40.0, 20.628210067749023),
        ("diagonal", 36.064788818359375, 18.49018669128418),
    ] {
        let inside =
            format!("<float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"{axis}\"/>");
        for (width, height, expected) in [(200, 100, wide), (100, 200, tall)] {
            let found = sensor_of("perspective", width, height, &inside).camera.fov_x;
            assert!((found - expected).abs() < 1e-5, "{axis} {width}: {found}");
        }
    }
    assert!((sensor("").camera.fov_x - 42.31171417236328).abs() < 1e-5);
    let long = sensor("<string name=\"focal_length\" value=\"85mm\"/>")
        .camera
        .fov_x;
    assert!((long - 25.64857292175293).abs() < 1e-5);
}

/// Mitsuba 3.9.1: `sensor.sample_ray(0, 0.5, [0.9, 0.2], [0.5, 0.5])[0].d`, 0.9 of the width from the left and 0.2 of
/// the height from the top.
#[test]
fn rays_are_mitsubas() {
    let inside = "<float name=\"fov\" value=\"36\"/><transform name=\"to_world\"><lookat origin=\"1.4, 1.0, -2.6\" target=\"0, 0.05, 0\" up=\"0, 1, 0\"/></transform>";
    let camera = sensor(inside).camera;
    let tan = (camera.fov_x.to_radians() / 2.0).tan();
    let (right, up) = (0.8 * tan, 0.6 * tan / 2.0);
    let along = [0, 1, 2].map(|i| camera.forward[i] + right * camera.right[i] + up * camera.up[i]);
    let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
    let expected = [-0.6690360307693481, -0.20568160712718964, 0.714202880859375];
    assert!(near(along.map(|x| x / length), expected), "{along:?}");
}

#[test]
fn the_camera_looks_along_z_with_x_to_the_left() {
    let camera = sensor("<transform name=\"to_world\"><lookat origin=\"0, 2, 5\" target=\"0, 2, 0\" up=\"0, 3, 0\"/></transform>").camera;
    assert!(near(camera.origin, [0.0, 2.0, 5.0]) && near(camera.forward, [0.0, 0.0, -1.0]));
    assert!(near(camera.right, [1.0, 0.0, 0.0]) && near(camera.up, [0.0, 1.0, 0.0]));
    let mirrored = sensor("<transform name=\"to_world\"><scale x=\"-1\"/></transform>").camera;
    assert!(near(mirrored.right, [1.0, 0.0, 0.0]) && near(mirrored.forward, [0.0, 0.0, 1.0]));
    let lens = "<float name=\"aperture_radius\" value=\"0.1\"/>";
    let camera = sensor_of(
        "thinlens",
        9,
        9,
        &format!("{lens}<float name=\"focus_distance\" value=\"3\"/>"),
    )
    .camera;
    let Some(LensDesc {
        aperture_radius,
        focus_distance,
    }) = camera.lens
    else {
        panic!()
    };
    assert_eq!((aperture_radius, focus_distance), (0.1, 3.0));
}

#[test]
fn integrators_and_samplers() {
    let read = |text: &str| {
        let text = format!(
            "<scene version=\"3.0.0\">{text}<sensor type=\"perspective\"><film type=\"hdrfilm\"><rfilter type=\"box\"/></film><sampler type=\"multijitter\"><integer name=\"sample_count\" value=\"9\"/></sampler></sensor></scene>"
        );
        Folder::with(&[("s.xml", &text)]).load("s.xml", &Options::default())
    };
    let path = read("<integrator type=\"path\"/>").unwrap().scene;
    assert_eq!((path.spp, path.sampler), (Some(9), Some(SamplerKind::Cmj)));
    assert_eq!((path.width, path.height), (768, 576));
    let expected = IntegratorDesc {
        kind: IntegratorKind::Path,
        max_depth: None,
        rr_depth: 5,
        hide_emitters: false,
        ao_radius: None,
    };
    assert_eq!(path.integrator, expected);
    let short = read("<integrator type=\"path\"><integer name=\"max_depth\" value=\"3\"/><integer name=\"rr_depth\" value=\"2\"/><boolean name=\"hide_emitters\" value=\"true\"/></integrator>").unwrap().scene;
    let expected = IntegratorDesc {
        kind: IntegratorKind::Path,
        max_depth: Some(3),
        rr_depth: 2,
        hide_emitters: true,
        ao_radius: None,
    };
    assert_eq!(short.integrator, expected);
    let direct = read("<integrator type=\"direct\"/>").unwrap().scene;
    assert_eq!(
        (direct.integrator.kind, direct.integrator.max_depth),
        (IntegratorKind::Direct, Some(2))
    );
    assert!(
        read("<integrator type=\"direct\"><integer name=\"max_depth\" value=\"3\"/></integrator>").is_err()
    );
    assert!(
        read("<integrator type=\"path\"><integer name=\"max_depth\" value=\"-2\"/></integrator>").is_err()
    );
    assert!(read("<integrator type=\"volpath\"/>").is_err());
    assert_eq!(read("").unwrap().warnings.len(), 1);
}

#[test]
fn all_shared_scenes_load() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("skipped: no {}", folder.display());
        return;
    };
    let paths = entries
        .map(|entry| entry.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "xml"));
    let mut shapes = Vec::new();
    for path in paths {
        let loaded = load(&path, &Options::default()).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(loaded.warnings, Vec::<String>::new(), "{}", path.display());
        assert_eq!(loaded.scene.spp, Some(64), "{}", path.display());
        shapes.push((loaded.scene.name.clone(), loaded.scene.shapes.len()));
    }
    shapes.sort();
    for (name, count) in [("cornell", 18), ("seed-scene", 8), ("spot-sun-sky", 2)] {
        assert!(shapes.contains(&(name.to_string(), count)), "{name}: {shapes:?}");
    }
}
