//! `<shape>`: spheres, disks, rectangles, cubes and mesh files, with their material and what they emit; `implicit` reads
//! the rest.

use super::super::math::{
    Affine, add, alike, cross, dot, length, perpendicular, perpendicular_enough, scaled, unit,
};
use super::super::mesh::Placement;
use super::super::{ImportError, read_mesh};
use super::bsdf::Materials;
use super::color::Quantity;
use super::implicit;
use super::instance::{self, Groups};
use super::params::{Context, Params};
use super::tree::Element;
use crate::desc::{GeometryDesc, MeshDesc, ShapeDesc, TintDesc, Vec3};

const KINDS: [&str; 14] = [
    "sphere",
    "rectangle",
    "disk",
    "cube",
    "obj",
    "ply",
    "torus",
    "capsule",
    "roundedbox",
    "gyroid",
    "metaballs",
    "smoothunion",
    "shapegroup",
    "instance",
];

/// What all kinds of shape have.
struct Common<'a> {
    element: &'a Element,
    to_world: Affine,
    flip_normals: bool,
}

/// The shapes of one `<shape>`: a cube is six, a group none until an instance of it stands somewhere.
pub(super) fn read<'a>(
    element: &'a Element,
    context: &Context<'a>,
    materials: &mut Materials<'a>,
    groups: &mut Groups<'a>,
) -> Result<Vec<ShapeDesc>, ImportError> {
    match element.kind() {
        "shapegroup" => groups.of(element, context, materials).map(|_| Vec::new()),
        "instance" => instance::read(element, context, materials, groups),
        _ => read_one(element, context, materials),
    }
}

/// One that is neither a group nor an instance of one.
pub(super) fn read_one<'a>(
    element: &'a Element,
    context: &Context<'a>,
    materials: &mut Materials<'a>,
) -> Result<Vec<ShapeDesc>, ImportError> {
    if !KINDS.contains(&element.kind()) {
        context.refuse_kind(element, &KINDS)?;
        return Ok(Vec::new());
    }
    let params = Params::new(context, element);
    let common = Common {
        element,
        to_world: params.transform("to_world")?.unwrap_or(Affine::IDENTITY),
        flip_normals: params.boolean("flip_normals")?.unwrap_or(false),
    };
    let bsdf = params.object("bsdf")?;
    let emission = match params.object("emitter")? {
        Some(emitter) => area(emitter, context)?,
        None => None,
    };
    let mut material = match bsdf {
        Some(bsdf) => materials.of(bsdf, context)?,
        None => materials.fallback(emission.is_some()),
    };
    let geometry = match element.kind() {
        "sphere" => {
            let (sphere, inside_out) = sphere(&common, &params)?;
            if inside_out {
                material = turn_inside_out(&common, material, emission, materials)?;
            }
            vec![(String::new(), sphere)]
        }
        "rectangle" => vec![(String::new(), rectangle(&common))],
        "disk" => vec![(String::new(), disk(&common)?)],
        "cube" => cube(&common),
        kind if implicit::KINDS.contains(&kind) => {
            let solid = implicit::read(element, &common.to_world, &params, context)?;
            if common.flip_normals {
                material = turn_inside_out(&common, material, emission, materials)?;
            }
            vec![(String::new(), GeometryDesc::Implicit(solid))]
        }
        _ => vec![(String::new(), mesh(&common, &params, context)?)],
    };
    params.finish()?;
    let geometry = match &materials.list[material].tint {
        Some(tint) => textured(&common, geometry, tint, context)?,
        None => geometry,
    };
    let named = |(face, geometry)| ShapeDesc {
        name: element.name() + face,
        geometry,
        material,
        emission,
    };
    Ok(geometry
        .iter()
        .map(|(face, geometry)| named((face, geometry.clone())))
        .collect())
}

/// What a shape becomes that a texture covers: a rectangle two triangles. Other closed forms have no places in it.
fn textured(
    common: &Common,
    parts: Vec<(String, GeometryDesc)>,
    tint: &TintDesc,
    context: &Context,
) -> Result<Vec<(String, GeometryDesc)>, ImportError> {
    let kind = common.element.kind();
    let mut all = Vec::new();
    for (name, part) in parts {
        let placed = match (part, tint) {
            (GeometryDesc::Rectangle { .. }, TintDesc::Texture { .. }) if kind == "rectangle" => {
                GeometryDesc::Mesh(square(common))
            }
            (mesh @ GeometryDesc::Mesh(_), _) => mesh,
            (other, _) => {
                let message = format!("a {kind} cannot have a texture; use a rectangle, or a mesh with uvs");
                context.refuse(common.element, message)?;
                other
            }
        };
        all.push((name, placed));
    }
    Ok(all)
}

/// A rectangle as triangles that know where in a texture they are: (0, 0) at (-1, -1), (1, 1) at (1, 1).
fn square(common: &Common) -> MeshDesc {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    if (common.to_world.determinant() < 0.0) != common.flip_normals {
        triangles.iter_mut().for_each(|t: &mut [u32; 3]| t.swap(1, 2));
    }
    MeshDesc {
        vertices: corners.map(|[x, y]| common.to_world.point([x, y, 0.0])).to_vec(),
        triangles,
        uvs: corners.map(|corner| corner.map(|c| (c + 1.0) / 2.0)).to_vec(),
        ..MeshDesc::default()
    }
}

/// Radiance of an area emitter.
fn area<'a>(emitter: &'a Element, context: &Context<'a>) -> Result<Option<Vec3>, ImportError> {
    if emitter.kind() != "area" {
        let message = format!(
            "{} cannot stand in a shape; use area, or move it out",
            emitter.describe()
        );
        context.refuse(emitter, message)?;
        return Ok(None);
    }
    let params = Params::new(context, emitter);
    let radiance = params.color("radiance", Quantity::Emission)?.unwrap_or([1.0; 3]);
    params.finish()?;
    Ok(Some(radiance))
}

/// The sphere, and whether its normals point inwards.
fn sphere(common: &Common, params: &Params) -> Result<(GeometryDesc, bool), ImportError> {
    let center = params.triple("center")?.unwrap_or([0.0; 3]);
    let radius = params
        .checked("radius", "other than 0", |r| r != 0.0)?
        .unwrap_or(1.0);
    let scale = common.to_world.uniform_scale().ok_or_else(|| {
        let message = "a sphere scaled differently along its axes is not supported; scale it uniformly";
        common.element.error(message)
    })?;
    let mirrored = (common.to_world.determinant() < 0.0) != (radius < 0.0);
    let geometry = GeometryDesc::Sphere {
        center: common.to_world.point(center),
        radius: radius.abs() * scale,
    };
    Ok((geometry, common.flip_normals != mirrored))
}

/// A solid's normals point outwards here; the other way round it can only be where the material says it all.
fn turn_inside_out(
    common: &Common,
    material: usize,
    emission: Option<Vec3>,
    materials: &mut Materials,
) -> Result<usize, ImportError> {
    materials.inside_out(material).filter(|_| emission.is_none()).ok_or_else(|| {
        let kind = common.element.kind();
        common.element.error(format!(
            "a {kind} turned inside out (flip_normals, or a mirroring scale) is supported only with a twosided or \
             dielectric bsdf and no emitter; turn it back"
        ))
    })
}

/// Unit normal of what lies in the xy plane: the inverse transpose of z.
fn normal_of_z(common: &Common) -> Vec3 {
    let normal = unit(common.to_world.normal([0.0, 0.0, 1.0])).unwrap_or([0.0, 0.0, 1.0]);
    if common.flip_normals {
        scaled(normal, -1.0)
    } else {
        normal
    }
}

fn rectangle(common: &Common) -> GeometryDesc {
    let [u, v, _] = common.to_world.columns;
    parallelogram(common.to_world.translation, u, v, normal_of_z(common))
}

/// `center ± u ± v` with the normal on the side of `normal`; two triangles where u and v are askew.
fn parallelogram(center: Vec3, u: Vec3, v: Vec3, normal: Vec3) -> GeometryDesc {
    let (u, v) = if dot(cross(u, v), normal) < 0.0 {
        (v, u)
    } else {
        (u, v)
    };
    if perpendicular(u, v) {
        return GeometryDesc::Rectangle { center, u, v };
    }
    let corner = |a: f64, b: f64| add(center, add(scaled(u, a), scaled(v, b)));
    GeometryDesc::Mesh(MeshDesc {
        vertices: vec![
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshDesc::default()
    })
}

fn disk(common: &Common) -> Result<GeometryDesc, ImportError> {
    let [u, v, _] = common.to_world.columns;
    let radius = length(u);
    if !alike(radius, length(v)) || !perpendicular_enough(u, v) {
        let message = "an elliptic disk is not supported; scale x and y alike, without shear";
        return Err(common.element.error(message));
    }
    Ok(GeometryDesc::Disk {
        center: common.to_world.translation,
        normal: normal_of_z(common),
        radius,
    })
}

/// Six rectangles named after their axis, or one mesh where edges do not meet at right angles.
fn cube(common: &Common) -> Vec<(String, GeometryDesc)> {
    let [x, y, z] = common.to_world.columns;
    let center = common.to_world.translation;
    if !(perpendicular(x, y) && perpendicular(y, z) && perpendicular(z, x)) {
        return vec![(String::new(), GeometryDesc::Mesh(skewed_cube(common)))];
    }
    let faces = [
        ("-x", x, y, z),
        ("+x", x, y, z),
        ("-y", y, z, x),
        ("+y", y, z, x),
        ("-z", z, x, y),
        ("+z", z, x, y),
    ];
    let rectangle = |(name, out, u, v): (&str, Vec3, Vec3, Vec3)| {
        let outwards = if name.starts_with('-') {
            scaled(out, -1.0)
        } else {
            out
        };
        let normal = if common.flip_normals {
            scaled(outwards, -1.0)
        } else {
            outwards
        };
        (
            format!(" face {name}"),
            parallelogram(add(center, outwards), u, v, normal),
        )
    };
    faces.map(rectangle).to_vec()
}

/// The cube [-1, 1]³ as 12 triangles, counter-clockwise from outside.
fn skewed_cube(common: &Common) -> MeshDesc {
    let sign = |corner: u32, bit: u32| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
    let corner = |i| common.to_world.point([sign(i, 0), sign(i, 1), sign(i, 2)]);
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let mut triangles: Vec<[u32; 3]> = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    if (common.to_world.determinant() < 0.0) != common.flip_normals {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    MeshDesc {
        vertices: (0..8).map(corner).collect(),
        triangles,
        ..MeshDesc::default()
    }
}

fn mesh(common: &Common, params: &Params, context: &Context) -> Result<GeometryDesc, ImportError> {
    let element = common.element;
    let face_normals = params.boolean("face_normals")?.unwrap_or(false);
    let Some((at, filename)) = params.string("filename")? else {
        let message = format!(
            "{} names no file; add <string name=\"filename\" value=\"...\"/>",
            element.describe()
        );
        return Err(element.error(message));
    };
    let path = at.resolve(filename);
    if !path.is_file() {
        return Err(at.error(format!("no file {}; check the name", path.display())));
    }
    if !path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(element.kind()))
    {
        let message = format!(
            "\"{filename}\" does not end in .{}; make type and file agree",
            element.kind()
        );
        return Err(at.error(message));
    }
    let raw = read_mesh(&path)?;
    let placement = Placement {
        to_world: common.to_world,
        face_normals,
        flip_normals: common.flip_normals,
    };
    let (mesh, dropped) = raw.place(placement);
    for note in raw.notes.iter().filter(|_| !face_normals) {
        context.warn(&ImportError::new(&path, note.clone()));
    }
    if dropped > 0 {
        context.warn(&ImportError::new(
            &path,
            format!("{dropped} triangles without area are left out"),
        ));
    }
    if mesh.triangles.is_empty() {
        return Err(ImportError::new(
            &path,
            "no triangle has any area; check the mesh",
        ));
    }
    Ok(GeometryDesc::Mesh(mesh))
}
