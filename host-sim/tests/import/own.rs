//! What is ours and not Mitsuba's: implicit surfaces, the gradient sky, more integrators.

use super::*;

fn solid(text: &str) -> ImplicitDesc {
    let scene = read(text);
    let GeometryDesc::Implicit(solid) = &scene.shapes[0].geometry else {
        panic!("{text} is no implicit surface")
    };
    solid.clone()
}

const PLACED: &str = "<transform name=\"to_world\"><scale value=\"2\"/><rotate y=\"1\" angle=\"90\"/><translate x=\"5\"/></transform>";
const MIRRORED: &str = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";

#[test]
fn implicit_surfaces_have_defaults() {
    assert_eq!(
        solid("<shape type=\"torus\"/>"),
        ImplicitDesc::Torus {
            center: [0.0; 3],
            axis: [0.0, 0.0, 1.0],
            major: 1.0,
            minor: 0.25
        }
    );
    let capsule = CapsuleDesc {
        a: [0.0; 3],
        b: [0.0, 0.0, 1.0],
        radius: 1.0,
    };
    assert_eq!(solid("<shape type=\"capsule\"/>"), ImplicitDesc::Capsule(capsule));
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(
        solid("<shape type=\"roundedbox\"/>"),
        ImplicitDesc::RoundedBox {
            center: [0.0; 3],
            axes,
            half: [1.0; 3],
            radius: 0.1
        }
    );
    assert_eq!(
        solid("<shape type=\"gyroid\"><float name=\"radius\" value=\"3\"/></shape>"),
        ImplicitDesc::Gyroid {
            center: [0.0; 3],
            axes,
            cell: 1.0,
            thickness: 0.1,
            bound: BoundDesc::Sphere { radius: 3.0 }
        }
    );
    let ball = BallDesc {
        center: [0.0; 3],
        radius: 1.0,
    };
    assert_eq!(
        solid("<shape type=\"metaballs\"><shape type=\"sphere\"/></shape>"),
        ImplicitDesc::Metaballs {
            balls: vec![ball],
            threshold: 0.5
        }
    );
    assert_eq!(
        solid(
            "<shape type=\"smoothunion\"><float name=\"smoothness\" value=\"0.2\"/><shape type=\"capsule\"/><shape type=\"sphere\"/></shape>"
        ),
        ImplicitDesc::SmoothUnion {
            parts: vec![PartDesc::Capsule(capsule), PartDesc::Ball(ball)],
            k: 0.2
        }
    );
}

#[test]
fn implicit_surfaces_are_placed_in_metres() {
    // Twice the size, x to -z and z to x, five metres along x.
    let ImplicitDesc::Torus {
        center,
        axis,
        major,
        minor,
    } = solid(&format!(
        "<shape type=\"torus\"><point name=\"center\" value=\"1, 2, 3\"/><vector name=\"axis\" value=\"3, 0, 0\"/>{PLACED}</shape>"
    ))
    else {
        panic!()
    };
    assert!(near(center, [11.0, 4.0, -2.0]) && near(axis, [0.0, 0.0, -1.0]));
    assert_eq!((major, minor), (2.0, 0.5));

    let ImplicitDesc::Capsule(capsule) = solid(&format!(
        "<shape type=\"capsule\"><point name=\"p0\" value=\"1, 0, 0\"/><float name=\"radius\" value=\"0.3\"/>{PLACED}</shape>"
    )) else {
        panic!()
    };
    assert!(near(capsule.a, [5.0, 0.0, -2.0]) && near(capsule.b, [7.0, 0.0, 0.0]));
    assert_eq!(capsule.radius, 0.6);

    let ImplicitDesc::Gyroid {
        axes,
        cell,
        thickness,
        bound,
        ..
    } = solid(&format!(
        "<shape type=\"gyroid\"><vector name=\"half_extents\" value=\"1, 2, 3\"/><float name=\"thickness\" value=\"0.25\"/>{PLACED}</shape>"
    ))
    else {
        panic!()
    };
    assert!(
        near(axes[0], [0.0, 0.0, -1.0]) && near(axes[1], [0.0, 1.0, 0.0]) && near(axes[2], [1.0, 0.0, 0.0])
    );
    assert_eq!((cell, thickness), (2.0, 0.5));
    assert_eq!(
        bound,
        BoundDesc::Box {
            half: [2.0, 4.0, 6.0]
        }
    );

    // The parts' own transform comes first.
    let ImplicitDesc::SmoothUnion { parts, k } = solid(&format!(
        "<shape type=\"smoothunion\"><float name=\"smoothness\" value=\"0.2\"/>{PLACED}<shape type=\"sphere\"><transform name=\"to_world\"><scale value=\"3\"/><translate z=\"1\"/></transform></shape></shape>"
    )) else {
        panic!()
    };
    let PartDesc::Ball(ball) = parts[0] else { panic!() };
    assert!(near(ball.center, [7.0, 0.0, 0.0]) && (ball.radius - 6.0).abs() < 1e-12 && k == 0.4);
}

#[test]
fn a_mirrored_frame_is_turned_to_a_right_handed_one() {
    let ImplicitDesc::Gyroid { axes, .. } = solid(&format!(
        "<shape type=\"gyroid\"><float name=\"radius\" value=\"1\"/>{MIRRORED}</shape>"
    )) else {
        panic!()
    };
    assert_eq!(axes, [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);
}

#[test]
fn implicit_surfaces_have_materials_and_emit() {
    let scene = read(
        "<shape type=\"torus\" id=\"ring\"><bsdf type=\"dielectric\" id=\"glass\"/><boolean name=\"flip_normals\" value=\"true\"/></shape>\n<shape type=\"capsule\"><emitter type=\"area\"><rgb name=\"radiance\" value=\"3\"/></emitter></shape>",
    );
    assert_eq!(scene.shapes[0].name, "ring");
    assert_eq!(
        scene.materials[scene.shapes[0].material].name,
        "glass (inside out)"
    );
    assert_eq!(scene.shapes[1].emission, Some([3.0; 3]));
    assert_eq!(scene.shapes[1].name, "capsule at line 4");
}

#[test]
fn the_boxes_of_implicit_surfaces_hold_them() {
    let cases = [
        (
            "<shape type=\"torus\"><vector name=\"axis\" value=\"0, 0.6, 0.8\"/></shape>",
            [1.25, 1.05, 0.85],
        ),
        (
            "<shape type=\"roundedbox\"><transform name=\"to_world\"><rotate z=\"1\" angle=\"45\"/></transform></shape>",
            [1.8 / 2f64.sqrt() + 0.1, 1.8 / 2f64.sqrt() + 0.1, 1.0],
        ),
        (
            "<shape type=\"gyroid\"><vector name=\"half_extents\" value=\"1, 2, 3\"/><transform name=\"to_world\"><rotate z=\"1\" angle=\"90\"/></transform></shape>",
            [2.0, 1.0, 3.0],
        ),
        (
            "<shape type=\"metaballs\"><shape type=\"sphere\"/></shape>",
            [1.0, 1.0, 1.0],
        ),
    ];
    for (text, half) in cases {
        let [low, high] = solid(text).bounds();
        assert!(
            near(high, half) && near(low, half.map(|c| -c)),
            "{text}: {low:?} {high:?}"
        );
    }
    let [low, high] = solid(
        "<shape type=\"smoothunion\"><float name=\"smoothness\" value=\"0.4\"/><shape type=\"sphere\"/><shape type=\"capsule\"/></shape>",
    )
    .bounds();
    assert!(near(low, [-1.1; 3]) && near(high, [1.1, 1.1, 2.1]));
}

#[test]
fn a_gradient_sky_with_a_sun() {
    let sky = |body: &str| {
        let scene = read(&format!(
            "<emitter type=\"gradient\"><rgb name=\"zenith\" value=\"1, 2, 3\"/><rgb name=\"horizon\" value=\"4\"/>{body}</emitter>"
        ));
        let LightDesc::Gradient {
            zenith,
            horizon,
            ground,
            up,
            sun,
        } = scene.lights[0]
        else {
            panic!()
        };
        assert_eq!((zenith, horizon), ([1.0, 2.0, 3.0], [4.0; 3]));
        (ground, up, sun)
    };
    assert_eq!(sky(""), ([4.0; 3], [0.0, 1.0, 0.0], None));
    let (ground, up, sun) = sky(
        "<rgb name=\"ground\" value=\"0.5\"/><vector name=\"up\" value=\"0, 0, 2\"/><vector name=\"sun_direction\" value=\"0, 3, 4\"/><rgb name=\"sun_radiance\" value=\"9, 8, 7\"/>",
    );
    let radiance = [9.0, 8.0, 7.0];
    assert_eq!((ground, up), ([0.5; 3], [0.0, 0.0, 1.0]));
    let sun = sun.unwrap();
    assert!(near(sun.direction, [0.0, 0.6, 0.8]));
    assert_eq!((sun.radiance, sun.angle), (radiance, 0.533));
    // By irradiance: a sun of 60° across takes sin² 30° = 1/4 of the sky's π. The transform turns it with the sky.
    let (_, up, sun) = sky(
        "<transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/></transform><vector name=\"sun_direction\" value=\"0, 1, 0\"/><rgb name=\"sun_irradiance\" value=\"5\"/><float name=\"sun_angle\" value=\"60\"/>",
    );
    let sun = sun.unwrap();
    assert!(near(up, [0.0, 0.0, 1.0]) && near(sun.direction, up) && sun.angle == 60.0);
    assert!(near(sun.radiance, [20.0 / std::f64::consts::PI; 3]));
}

#[test]
fn integrators_by_name() {
    let integrator = |text: &str| {
        let text = scene("").replace("<integrator type=\"path\"/>", text);
        let loaded = Folder::with(&[("s.xml", &text)]).load("s.xml", &Options::default());
        loaded.unwrap_or_else(|error| panic!("{error}")).scene.integrator
    };
    let path = integrator("<integrator type=\"path\"/>");
    assert_eq!(
        (path.kind, path.max_depth, path.ao_radius),
        (IntegratorKind::Path, None, None)
    );
    let bdpt = integrator("<integrator type=\"bdpt\"><integer name=\"max_depth\" value=\"7\"/></integrator>");
    assert_eq!(
        (bdpt.kind, bdpt.max_depth, bdpt.rr_depth),
        (IntegratorKind::Bdpt, Some(7), 5)
    );
    let light = integrator(
        "<integrator type=\"light\"><integer name=\"max_depth\" value=\"-1\"/><integer name=\"rr_depth\" value=\"3\"/></integrator>",
    );
    assert_eq!(
        (light.kind, light.max_depth, light.rr_depth),
        (IntegratorKind::Light, None, 3)
    );
    let ao = integrator("<integrator type=\"ao\"><float name=\"radius\" value=\"0.5\"/></integrator>");
    assert_eq!((ao.kind, ao.ao_radius), (IntegratorKind::Ao, Some(0.5)));
    assert_eq!(integrator("<integrator type=\"ao\"/>").ao_radius, None);

    for (text, expected) in [
        (
            "<integrator type=\"ao\"><float name=\"radius\" value=\"0\"/></integrator>",
            "s.xml:1: radius 0 is out of range; it must be above 0",
        ),
        (
            "<integrator type=\"ao\">\n<integer name=\"max_depth\" value=\"2\"/></integrator>",
            "s.xml:2: <integrator type=\"ao\"> has no parameter \"max_depth\"",
        ),
        (
            "<integrator type=\"direct\"><integer name=\"max_depth\" value=\"2\"/></integrator>",
            "s.xml:1: <integrator type=\"direct\"> has no parameter \"max_depth\"",
        ),
        (
            "<integrator type=\"bdtp\"/>",
            "s.xml:1: <integrator type=\"bdtp\"> is not supported; did you mean \"bdpt\"?",
        ),
        (
            "<integrator type=\"volpath\"/>",
            "s.xml:1: <integrator type=\"volpath\"> is not supported",
        ),
        (
            "<integrator type=\"light\"><float name=\"max_depth\" value=\"2\"/></integrator>",
            "s.xml:1: max_depth is given as <float>; write it as <integer>",
        ),
    ] {
        let text = scene("").replace("<integrator type=\"path\"/>", text);
        let found = Folder::with(&[("s.xml", &text)]).error("s.xml");
        assert!(
            found.starts_with(expected),
            "{text}\n  said {found:?}\n  not  {expected:?}"
        );
    }
}

#[test]
fn what_is_wrong_with_them_is_said() {
    let cases = [
        (
            "<shape type=\"torus\">\n<float name=\"major_radius\" value=\"-1\"/></shape>",
            "s.xml:4: major_radius -1 is out of range; it must be above 0",
        ),
        (
            "<shape type=\"torus\"><float name=\"minor_radius\" value=\"1\"/></shape>",
            "s.xml:3: minor_radius 1 closes the hole of a torus of major_radius 1",
        ),
        (
            "<shape type=\"torus\"><vector name=\"axis\" value=\"0\"/></shape>",
            "s.xml:3: the torus's axis is zero",
        ),
        (
            "<shape type=\"torus\"><float name=\"radius\" value=\"1\"/></shape>",
            "s.xml:3: <shape type=\"torus\"> has no parameter \"radius\"; use to_world, flip_normals, center, axis",
        ),
        (
            "<shape type=\"torus\"><transform name=\"to_world\"><scale x=\"2\"/></transform></shape>",
            "s.xml:3: a torus scaled differently along its axes is not supported",
        ),
        (
            "<shape type=\"torus\"><boolean name=\"flip_normals\" value=\"true\"/></shape>",
            "s.xml:3: a torus turned inside out",
        ),
        (
            "<shape type=\"capsule\"><point name=\"p0\" value=\"0, 0, 1\"/></shape>",
            "s.xml:3: p0 and p1 are the same point",
        ),
        (
            "<shape type=\"roundedbox\"><float name=\"radius\" value=\"2\"/></shape>",
            "s.xml:3: radius 2 is more than the least of half_extents, 1",
        ),
        (
            "<shape type=\"roundedbox\"><vector name=\"half_extents\" value=\"1, 0, 1\"/></shape>",
            "s.xml:3: half_extents 1, 0, 1 is out of range; each must be above 0",
        ),
        (
            "<shape type=\"gyroid\"/>",
            "s.xml:3: a gyroid goes on for ever; bound it",
        ),
        (
            "<shape type=\"gyroid\"><float name=\"radius\" value=\"1\"/><vector name=\"half_extents\" value=\"1\"/></shape>",
            "s.xml:3: both radius and half_extents bound the gyroid",
        ),
        (
            "<shape type=\"gyroid\"><float name=\"radius\" value=\"1\"/><float name=\"thickness\" value=\"0.4\"/></shape>",
            "s.xml:3: thickness 0.4 leaves no holes; at most 0.3",
        ),
        (
            "<shape type=\"metaballs\"/>",
            "s.xml:3: metaballs holds no <shape>; put a sphere in it",
        ),
        (
            "<shape type=\"metaballs\">\n<shape type=\"capsule\"/></shape>",
            "s.xml:4: <shape type=\"capsule\"> is not supported; use sphere",
        ),
        (
            "<shape type=\"metaballs\"><float name=\"threshold\" value=\"1\"/><shape type=\"sphere\"/></shape>",
            "s.xml:3: threshold 1 is out of range; it must be above 0 and below 1",
        ),
        (
            "<shape type=\"metaballs\"><shape type=\"sphere\"><bsdf type=\"diffuse\"/></shape></shape>",
            "s.xml:3: <bsdf type=\"diffuse\"> cannot stand in <shape type=\"sphere\">; move it out",
        ),
        (
            "<shape type=\"smoothunion\"><shape type=\"sphere\"/></shape>",
            "s.xml:3: smoothunion needs <float name=\"smoothness\"",
        ),
        (
            "<shape type=\"smoothunion\"><shape type=\"torus\"/></shape>",
            "s.xml:3: <shape type=\"torus\"> is not supported; use sphere",
        ),
        (
            "<shape type=\"sphere\"><shape type=\"sphere\"/></shape>",
            "s.xml:3: <shape type=\"sphere\"> cannot stand in <shape type=\"sphere\">; move it out",
        ),
        // The sky.
        (
            "<emitter type=\"gradient\"><rgb name=\"zenith\" value=\"1\"/></emitter>",
            "s.xml:3: gradient needs its horizon; add <rgb name=\"horizon\"",
        ),
        (
            "<emitter type=\"gradient\"><rgb name=\"zenith\" value=\"1\"/><rgb name=\"horizon\" value=\"-1\"/></emitter>",
            "s.xml:3: horizon -1 is out of range; each channel must be 0 or more",
        ),
        (
            "<emitter type=\"constant\"/>\n<emitter type=\"gradient\"><rgb name=\"zenith\" value=\"1\"/><rgb name=\"horizon\" value=\"1\"/></emitter>",
            "s.xml:4: a second emitter that surrounds",
        ),
    ];
    for (body, expected) in cases {
        let found = error(body);
        assert!(
            found.starts_with(expected),
            "{body}\n  said {found:?}\n  not  {expected:?}"
        );
    }
    for (inside, expected) in [
        (
            "<vector name=\"up\" value=\"0\"/>",
            "s.xml:3: up is zero; point it somewhere",
        ),
        (
            "<vector name=\"up\" value=\"0, 1, 0\"/><transform name=\"to_world\"/>",
            "s.xml:3: both up and to_world",
        ),
        (
            "<transform name=\"to_world\"><scale value=\"2\"/></transform>",
            "s.xml:3: a gradient can be turned but not scaled",
        ),
        (
            "<rgb name=\"sun_radiance\" value=\"1\"/>",
            "s.xml:3: the sun has no direction",
        ),
        (
            "<vector name=\"sun_direction\" value=\"0, 1, 0\"/>",
            "s.xml:3: the sun gives no light",
        ),
        (
            "<vector name=\"sun_direction\" value=\"0\"/><rgb name=\"sun_radiance\" value=\"1\"/>",
            "s.xml:3: sun_direction is zero",
        ),
        (
            "<vector name=\"sun_direction\" value=\"0, 1, 0\"/><rgb name=\"sun_radiance\" value=\"1\"/><rgb name=\"sun_irradiance\" value=\"1\"/>",
            "s.xml:3: both sun_radiance and sun_irradiance",
        ),
        (
            "<float name=\"sun_angle\" value=\"91\"/>",
            "s.xml:3: sun_angle 91 is out of range; it must be above 0 and at most 90 degrees",
        ),
    ] {
        let found = error(&format!(
            "<emitter type=\"gradient\"><rgb name=\"zenith\" value=\"1\"/><rgb name=\"horizon\" value=\"1\"/>{inside}</emitter>"
        ));
        assert!(
            found.starts_with(expected),
            "{inside}\n  said {found:?}\n  not  {expected:?}"
        );
    }
}

#[test]
fn a_picture_too_small_for_a_sky_is_refused() {
    let folder = Folder::with(&[(
        "s.xml",
        &scene("<emitter type=\"envmap\">\n<string name=\"filename\" value=\"line.exr\"/></emitter>"),
    )]);
    exr::prelude::write_rgb_file(folder.path("line.exr"), 4, 1, |_, _| (1.0_f32, 1.0, 1.0)).unwrap();
    let found = folder.error("s.xml");
    assert!(
        found.starts_with("s.xml:4: a picture of 4 x 1 has no sky in it"),
        "{found}"
    );
}
