//! What cannot be read, and how it is said.

use super::*;

#[test]
fn errors_name_file_line_and_way_out() {
    let cases = [
        // Tags, plugins and parameters.
        (
            "<bsdf type=\"plastic\"/>",
            "s.xml:3: <bsdf type=\"plastic\"> is not supported; use diffuse, conductor",
        ),
        (
            "\n\n<shape type=\"shpere\"/>",
            "s.xml:5: <shape type=\"shpere\"> is not supported; did you mean \"sphere\"?",
        ),
        (
            "<shap type=\"sphere\"/>",
            "s.xml:3: <shap> is not supported; did you mean \"shape\"?",
        ),
        (
            "<bsdf type=\"diffuse\">\n<rgb name=\"reflectence\" value=\"0.1\"/></bsdf>",
            "s.xml:4: <bsdf type=\"diffuse\"> has no parameter \"reflectence\"; did you mean \"reflectance\"?",
        ),
        (
            "<shape typ=\"sphere\"/>",
            "s.xml:3: <shape> has no attribute \"typ\"; did you mean \"type\"?",
        ),
        ("<shape/>", "s.xml:3: <shape> lacks type=\"...\"; add it"),
        (
            "<emitter type=\"area\"/>",
            "s.xml:3: an area emitter is part of a shape",
        ),
        (
            "<emitter type=\"spot\"/>",
            "s.xml:3: <emitter type=\"spot\"> is not supported; use point",
        ),
        (
            "<float name=\"x\" value=\"1\"/>",
            "s.xml:3: <scene> has no parameter \"x\"",
        ),
        (
            "<shape type=\"disk\"><film type=\"hdrfilm\"/></shape>",
            "s.xml:3: <film type=\"hdrfilm\"> cannot stand in",
        ),
        ("hello", "s.xml:3: text \"hello\" in <scene>; remove it"),
        ("<texture type=\"bitmap\"/>", "s.xml:3: bitmap names no file"),
        (
            "<sensor type=\"perspective\"/>",
            "s.xml:3: a second <sensor> in <scene>; keep one",
        ),
        // Values.
        (
            "<bsdf type=\"diffuse\"><rgb name=\"reflectance\"\n value=\"1.5, 0, 0\"/></bsdf>",
            "s.xml:3: reflectance 1.5, 0, 0 is out of range; each channel must be 0 to 1",
        ),
        (
            "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1, 0\"/></bsdf>",
            "s.xml:3: rgb has 2 numbers",
        ),
        (
            "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"#12345\"/></bsdf>",
            "s.xml:3: \"#12345\" is not #rrggbb",
        ),
        (
            "<shape type=\"sphere\"><float name=\"radius\" value=\"1,5\"/></shape>",
            "s.xml:3: \"1,5\" is not a number",
        ),
        (
            "<shape type=\"sphere\"><float name=\"radius\" value=\"inf\"/></shape>",
            "s.xml:3: \"inf\" is not a finite number",
        ),
        (
            "<shape type=\"sphere\"><float name=\"radius\" value=\"0\"/></shape>",
            "s.xml:3: radius 0 is out of range",
        ),
        (
            "<shape type=\"sphere\"><string name=\"radius\" value=\"1\"/></shape>",
            "s.xml:3: radius is given as <string>",
        ),
        (
            "<shape type=\"disk\"><boolean name=\"flip_normals\" value=\"yes\"/></shape>",
            "s.xml:3: \"yes\" is neither",
        ),
        (
            "<shape type=\"sphere\"><float name=\"radius\" value=\"1\"/>\n<float name=\"radius\" value=\"2\"/></shape>",
            "s.xml:4: radius is already set by line 3; keep one",
        ),
        (
            "<emitter type=\"point\"><spectrum name=\"intensity\" value=\"400:1, 700:2\"/></emitter>",
            "s.xml:3: a spectrum of wavelengths",
        ),
        // Names and references.
        (
            "<shape type=\"disk\"><ref id=\"gren\"/></shape><bsdf id=\"green\" type=\"diffuse\"/>",
            "s.xml:3: nothing has the id \"gren\"; did you mean \"green\"?",
        ),
        (
            "<bsdf id=\"a\" type=\"diffuse\"/>\n<bsdf id=\"a\" type=\"diffuse\"/>",
            "s.xml:4: id \"a\" is taken by line 3",
        ),
        (
            "<shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/></shape>",
            "s.xml:3: $r is not defined",
        ),
        (
            "<include filename=\"none.xml\"/>",
            "s.xml:3: no file none.xml to include",
        ),
        ("<include filename=\"s.xml\"/>", "s.xml:3: 15 includes deep"),
        // Materials.
        (
            "<bsdf type=\"twosided\"><bsdf type=\"dielectric\"/></bsdf>",
            "s.xml:3: <bsdf type=\"dielectric\"> lets light through",
        ),
        ("<bsdf type=\"twosided\"/>", "s.xml:3: twosided holds no <bsdf>"),
        (
            "<bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/></bsdf>",
            "s.xml:3: material \"Au\" is not supported",
        ),
        (
            "<bsdf type=\"roughconductor\"/>",
            "s.xml:3: Mitsuba's default distribution, beckmann, is not supported",
        ),
        (
            "<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"watr\"/></bsdf>",
            "s.xml:3: int_ior \"watr\" is not known; did you mean \"water\"?",
        ),
        (
            "<bsdf type=\"orennayar\"/>",
            "s.xml:3: orennayar needs its roughness",
        ),
        // Shapes and transforms.
        (
            "<shape type=\"sphere\"><transform name=\"to_world\"><scale x=\"2\"/></transform></shape>",
            "s.xml:3: a sphere scaled differently",
        ),
        (
            "<shape type=\"disk\"><transform name=\"to_world\"><scale x=\"2\"/></transform></shape>",
            "s.xml:3: an elliptic disk",
        ),
        (
            "<shape type=\"disk\">\n<transform name=\"to_world\"><scale z=\"0\"/></transform></shape>",
            "s.xml:4: the transform flattens space",
        ),
        (
            "<shape type=\"disk\"><transform name=\"to_world\"><rotate angle=\"9\"/></transform></shape>",
            "s.xml:3: the axis of rotation is zero",
        ),
        (
            "<shape type=\"disk\"><transform name=\"to_world\"><rotate x=\"1\" y=\"1\" angle=\"9\"/></transform></shape>",
            "s.xml:3: the axis is not of length 1, with which Mitsuba distorts; write x=\"0.707106781\"",
        ),
        (
            "<shape type=\"disk\"><transform name=\"to_world\"><matrix value=\"1 2\"/></transform></shape>",
            "s.xml:3: matrix has 2 numbers",
        ),
        (
            "<shape type=\"disk\"><transform name=\"to_world\"><lookat origin=\"0,1,0\" target=\"0,0,0\" up=\"0,1,0\"/></transform></shape>",
            "s.xml:3: lookat's up points along",
        ),
        (
            "<shape type=\"obj\"/>",
            "s.xml:3: <shape type=\"obj\"> names no file",
        ),
        (
            "<shape type=\"obj\"><string name=\"filename\" value=\"no.obj\"/></shape>",
            "s.xml:3: no file no.obj; check the name",
        ),
        (
            "<shape type=\"sphere\"><boolean name=\"flip_normals\" value=\"true\"/><emitter type=\"area\"/></shape>",
            "s.xml:3: a sphere turned inside out",
        ),
        // Lights.
        (
            "<emitter type=\"constant\"/>\n<emitter type=\"constant\"/>",
            "s.xml:4: a second emitter that surrounds",
        ),
        (
            "<emitter type=\"point\"><point name=\"position\" value=\"1\"/><transform name=\"to_world\"/></emitter>",
            "s.xml:3: both position and to_world",
        ),
    ];
    for (body, expected) in cases {
        // An included file is named with its folder.
        let found = error(body);
        assert!(
            found.starts_with(expected),
            "{body}\n  said {found:?}\n  not  {expected:?}"
        );
        assert!(!found.contains('\n'));
    }
}

#[test]
fn errors_of_whole_files() {
    for (content, expected) in [
        (
            "<scene/>",
            "s.xml:1: <scene> has no version; add version=\"3.0.0\"",
        ),
        (
            "<scene version=\"3.0\"/>",
            "s.xml:1: version \"3.0\" is not three numbers",
        ),
        (
            "<scene version=\"0.6.0\"/>",
            "s.xml:1: version 0.6.0 is not supported",
        ),
        (
            "<scene version=\"3.0.0\">\n<shape>\n</scene>",
            "s.xml:3: not well-formed XML",
        ),
        (
            "<bsdf version=\"3.0.0\" type=\"diffuse\"/>",
            "s.xml:1: the root is <bsdf type=\"diffuse\">",
        ),
        ("<scene version=\"3.0.0\"/>", "s.xml:1: the scene has no <sensor>"),
    ] {
        let found = Folder::with(&[("s.xml", content)]).error("s.xml");
        assert!(found.starts_with(expected), "{found:?} is not {expected:?}");
    }
    let folder = Folder::with(&[("a.txt", "")]);
    assert!(folder.error("a.txt").starts_with("a.txt: not a kind of scene"));
    assert!(folder.error("b.xml").starts_with("b.xml: no such file"));
    assert!(folder.error("b").starts_with("b: no such file"));
}

#[test]
fn errors_of_the_sensor() {
    for (inside, expected) in [
        (
            "<float name=\"fov\" value=\"180\"/>",
            "s.xml:2: fov 180 is out of range",
        ),
        (
            "<string name=\"fov_axis\" value=\"z\"/>",
            "s.xml:2: fov_axis \"z\" is not known",
        ),
        (
            "<film type=\"hdrfilm\"><integer name=\"width\" value=\"0\"/></film>",
            "s.xml:2: width 0 is out of range",
        ),
        (
            "<film type=\"hdrfilm\"><float name=\"width\" value=\"9\"/></film>",
            "s.xml:2: width is given as <float>",
        ),
        (
            "<film type=\"hdrfilm\"><rfilter type=\"gaussian\"/></film>",
            "s.xml:2: <rfilter type=\"gaussian\"> is not",
        ),
        (
            "<sampler type=\"halton\"/>",
            "s.xml:2: <sampler type=\"halton\"> is not supported; use independent",
        ),
        (
            "<transform name=\"to_world\"><scale value=\"2\"/></transform>",
            "s.xml:2: a camera's to_world must not",
        ),
    ] {
        let text =
            format!("<scene version=\"3.0.0\">\n<sensor type=\"perspective\">{inside}</sensor></scene>");
        let found = Folder::with(&[("s.xml", &text)]).error("s.xml");
        assert!(found.starts_with(expected), "{found:?} is not {expected:?}");
    }
}

#[test]
fn errors_inside_an_include_name_the_included_file() {
    let folder = Folder::with(&[
        ("s.xml", &scene("<include filename=\"part.xml\"/>")),
        (
            "part.xml",
            "<scene version=\"3.0.0\">\n\n<bsdf type=\"plastic\"/></scene>",
        ),
    ]);
    assert!(
        folder
            .error("s.xml")
            .starts_with("part.xml:3: <bsdf type=\"plastic\">")
    );
}

#[test]
fn lenient_reading_warns_and_goes_on() {
    let loaded = lenient(
        "<shape type=\"sphere\"><bsdf type=\"plastic\"/></shape>\n<shape type=\"hair\"/>\n<shape type=\"disk\"><float name=\"wobble\" value=\"1\"/></shape>\n<medium/>",
    );
    assert_eq!(loaded.scene.shapes.len(), 2);
    assert_eq!(loaded.warnings.len(), 4, "{:?}", loaded.warnings);
    for line in [
        "s.xml:3: <bsdf",
        "s.xml:4: <shape",
        "s.xml:5: <shape",
        "s.xml:6: <medium>",
    ] {
        assert!(
            loaded.warnings.iter().any(|w| w.contains(line)),
            "no {line} in {:?}",
            loaded.warnings
        );
    }
    // What is wrong stays wrong.
    let folder = Folder::with(&[(
        "s.xml",
        &scene("<shape type=\"sphere\"><float name=\"radius\" value=\"a\"/></shape>"),
    )]);
    assert!(
        folder
            .load(
                "s.xml",
                &Options {
                    lenient: true,
                    ..Options::default()
                }
            )
            .is_err()
    );
}
