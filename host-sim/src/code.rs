//! A whole scene as Rust source: what a board builds it from, without reading any file.

use std::fmt::{self, Write};

use microlux::color::{Albedo, Radiance};
use microlux::light::{Environment, Light};
use microlux::material::{Dielectric, Filter, Material, OrenNayarModel, Texels, Texture};
use microlux::scene::{Parts, Shape, Tint};
use microlux::shape::{Geometry, Implicit};

use crate::desc::SceneDesc;
use crate::quantise::CoreScene;
use crate::run::Error;

/// The source of a module that builds the scene: `scene` with its camera, and what it borrows beside its meshes.
pub fn rust(desc: &SceneDesc, core: &CoreScene) -> Result<String, Error> {
    let lent = core.lend();
    let scene = core.scene(&lent)?;
    let parts = scene.parts();
    if matches!(parts.environment, Environment::Map(_)) {
        let what = "an environment map is not written as source; take a sky, or a constant environment";
        return Err(Error::Scene(what.to_string()));
    }
    let mut text = String::new();
    Writer {
        out: &mut text,
        desc,
        core,
        parts,
    }
    .all()
    .map_err(|error| Error::Scene(error.to_string()))?;
    Ok(text)
}

struct Writer<'a, 'b> {
    out: &'a mut String,
    desc: &'a SceneDesc,
    core: &'a CoreScene,
    parts: &'a Parts<'b>,
}

impl Writer<'_, '_> {
    fn all(&mut self) -> fmt::Result {
        let parts = self.parts;
        let (shapes, materials, lights) = (parts.shapes.len(), parts.materials.len(), parts.lights.len());
        writeln!(
            self.out,
            "// {}, written by `host-sim bake`: `scene` fills a builder, whose `build_from` takes `borrowed`.\n",
            self.desc.name
        )?;
        self.out.push_str(
            "#[allow(unused_imports)]\nuse microlux::{\n    camera::Camera,\n    color::{Albedo, Radiance},\n    \
             geom::{Dir, Point, Rotation, Unit},\n    light::{Environment, Light, Sky},\n    material::*,\n    \
             num::{Metres, Share, Turn},\n    scene::{Borrowed, Mesh, SceneBuilder, SceneError, Tint},\n    \
             shape::*,\n};\n\n",
        );
        writeln!(
            self.out,
            "/// {shapes} shapes, {materials} materials, {lights} lights.\n\
             pub type Builder = SceneBuilder<{shapes}, {materials}, {lights}>;\n"
        )?;
        self.statics()?;
        self.borrowed()?;
        writeln!(
            self.out,
            "/// The scene, and its camera.\npub fn scene() -> Result<(Builder, Camera), SceneError> {{\n    \
             let mut b = Builder::with_unit(Unit::new({}));\n    let m = [",
            parts.unit.fraction_bits()
        )?;
        for material in parts.materials {
            writeln!(self.out, "        b.material({})?,", material_of(material))?;
        }
        self.out.push_str("    ];\n");
        // In the order of the file, which the builder numbers them by.
        let mut order: Vec<&Shape> = parts.shapes.iter().collect();
        order.sort_by_key(|shape| shape.id);
        for shape in order {
            self.shape(shape)?;
        }
        for light in parts.lights {
            match light {
                Light::Area { .. } => continue,
                Light::Point { position, intensity } => writeln!(
                    self.out,
                    "    b.light(Light::Point {{ position: {position:?}, intensity: {} }})?;",
                    light_of(*intensity)
                )?,
                Light::Directional {
                    direction,
                    irradiance,
                } => writeln!(
                    self.out,
                    "    b.light(Light::Directional {{ direction: {direction:?}, irradiance: {} }})?;",
                    light_of(*irradiance)
                )?,
                Light::Environment { radiance } => writeln!(
                    self.out,
                    "    b.light(Light::Environment {{ radiance: {} }})?;",
                    light_of(*radiance)
                )?,
            }
        }
        let camera = &self.core.camera;
        let [right, up, forward] = camera.frame();
        write!(
            self.out,
            "    let camera = Camera::from_frame({:?}, [{right:?}, {up:?}, {forward:?}], \
             fixed::types::I12F20::from_bits({}))",
            camera.origin(),
            camera.half_width().to_bits()
        )?;
        if camera.has_lens() {
            let (radius, focus) = camera.lens();
            write!(self.out, ".with_lens({radius}, {focus})")?;
        }
        self.out.push_str(";\n    Ok((b, camera))\n}\n");
        Ok(())
    }

    fn shape(&mut self, shape: &Shape) -> fmt::Result {
        let geometry = geometry_of(&shape.geometry);
        let material = shape.material;
        let radiance = shape
            .light
            .and_then(|light| match self.parts.lights.get(usize::from(light)) {
                Some(Light::Area { radiance, .. }) => Some(*radiance),
                _ => None,
            });
        match (radiance, shape.tint) {
            (Some(radiance), _) => writeln!(
                self.out,
                "    b.emitter({geometry}, m[{material}], {})?;",
                light_of(radiance)
            ),
            (None, Tint::None) => writeln!(self.out, "    b.shape({geometry}, m[{material}])?;"),
            (None, tint) => writeln!(
                self.out,
                "    b.tinted({geometry}, m[{material}], Tint::{tint:?})?;"
            ),
        }
    }

    /// Constant memory: blobs, textures, the choice of lights.
    fn statics(&mut self) -> fmt::Result {
        let parts = self.parts;
        writeln!(
            self.out,
            "#[allow(dead_code)]\nstatic BLOBS: [Blob; {}] = {:?};\n",
            parts.blobs.len(),
            parts.blobs
        )?;
        writeln!(
            self.out,
            "static TEXTURES: [Texture; {}] = [",
            parts.textures.len()
        )?;
        for (texture, owned) in parts.textures.iter().zip(self.core.owned_textures()) {
            writeln!(self.out, "    // {}", owned.name)?;
            self.texture(texture)?;
        }
        writeln!(
            self.out,
            "];\n\nstatic CHOICE: [u32; {}] = {:?};\n",
            parts.choice.len(),
            parts.choice
        )
    }

    fn texture(&mut self, texture: &Texture) -> fmt::Result {
        let Texture {
            width,
            height,
            palette,
            texels,
            filter,
        } = texture;
        let (kind, bytes) = match texels {
            Texels::Half(bytes) => ("Half", bytes),
            Texels::Byte(bytes) => ("Byte", bytes),
        };
        let filter = match filter {
            Filter::Nearest => "Nearest",
            Filter::Bilinear => "Bilinear",
        };
        writeln!(
            self.out,
            "    Texture {{ width: {width}, height: {height}, palette: &{palette:?}, texels: Texels::{kind}(&{bytes:?}), \
             filter: Filter::{filter} }},"
        )
    }

    fn borrowed(&mut self) -> fmt::Result {
        let sky = match self.parts.environment {
            Environment::Sky(sky) => Some(sky),
            _ => None,
        };
        if let Some(sky) = sky {
            let [zenith, horizon, ground] = sky.colors().map(light_of);
            write!(
                self.out,
                "/// What is seen where nothing is.\npub fn sky() -> Sky {{\n    Sky::new({:?}, {zenith}, {horizon}, {ground})",
                sky.up()
            )?;
            if let Some(sun) = sky.sun() {
                write!(
                    self.out,
                    ".with_sun({:?}, Turn::from_bits({}), {})",
                    sun.direction,
                    sun.diameter.to_bits(),
                    light_of(sun.radiance)
                )?;
            }
            self.out.push_str("\n}\n\n");
        }
        let (argument, environment) = match sky {
            Some(_) => (", sky: &'a Sky", "Environment::Sky(sky)"),
            None => ("", "Environment::None"),
        };
        writeln!(
            self.out,
            "/// What the scene borrows: its meshes, in the order of the baked ones{}.\n\
             pub fn borrowed<'a>(meshes: &'a [Mesh<'a>]{argument}) -> Borrowed<'a> {{\n    \
             Borrowed {{ meshes, textures: &TEXTURES, blobs: &BLOBS, environment: {environment}, choice: &CHOICE }}\n}}\n",
            if sky.is_some() { ", and its `sky`" } else { "" }
        )
    }
}

fn geometry_of(geometry: &Geometry) -> String {
    match geometry {
        Geometry::Sphere(sphere) => format!("{sphere:?}"),
        Geometry::Plane(plane) => format!("{plane:?}"),
        Geometry::Disk(disk) => format!("{disk:?}"),
        Geometry::Rectangle(rectangle) => format!("{rectangle:?}"),
        Geometry::Mesh(mesh) => format!("Geometry::Mesh({mesh})"),
        Geometry::Instance(instance) => format!(
            "Instance::new({}).scaled(Metres::from_bits({})).turned(Rotation::from_rows({:?})).moved({:?})",
            instance.mesh,
            instance.scale(),
            instance.rotation.rows(),
            instance.at
        ),
        Geometry::Implicit(solid) => format!("Implicit::{}", solid_of(solid)),
    }
}

fn solid_of(solid: &Implicit) -> String {
    match solid {
        Implicit::Torus(torus) => format!("Torus({torus:?})"),
        Implicit::Capsule(capsule) => {
            format!(
                "Capsule(Capsule::new({:?}, {:?}, {}))",
                capsule.a, capsule.b, capsule.radius
            )
        }
        Implicit::RoundedBox(block) => format!("RoundedBox({block:?})"),
        Implicit::Gyroid(gyroid) => {
            let bound = match gyroid.bound.radius() {
                Some(radius) => format!("Bound::ball({radius})"),
                None => format!("Bound::block({:?})", gyroid.bound.half()),
            };
            format!(
                "Gyroid(Gyroid {{ center: {:?}, x: {:?}, y: {:?}, cell: {}, thickness: {}, bound: {bound} }})",
                gyroid.center, gyroid.x, gyroid.y, gyroid.cell, gyroid.thickness
            )
        }
        Implicit::Metaballs(balls) => format!(
            "Metaballs(Metaballs::new(&BLOBS, {}, {}, {}))",
            balls.first,
            balls.count,
            balls.threshold()
        ),
        Implicit::SmoothUnion(union) => format!(
            "SmoothUnion(SmoothUnion::new(&BLOBS, {}, {}, {}))",
            union.first, union.count, union.k
        ),
    }
}

fn albedo_of(Albedo(color): Albedo) -> String {
    format!("Albedo::from_bits({:?})", color.map(|c| c.to_bits()))
}

/// The same bits: mantissas over 2^15.
fn light_of(light: Radiance) -> String {
    let (mantissa, exponent) = light.to_parts();
    format!("Radiance::from_bits({mantissa:?}, {})", i32::from(exponent) - 15)
}

fn material_of(material: &Material) -> String {
    let side = |two_sided: bool| if two_sided { "" } else { ".one_sided()" };
    let smooth = |glass: &Dielectric| {
        let (reflectance, transmittance) = glass.tints();
        format!(
            "Dielectric::new(Metres::from_bits({})).tinted({}, {})",
            glass.eta().to_bits(),
            albedo_of(reflectance),
            albedo_of(transmittance)
        )
    };
    match material {
        Material::Black => "Material::Black".to_string(),
        Material::Lambert { albedo, two_sided } => {
            format!(
                "Material::Lambert {{ albedo: {}, two_sided: {two_sided} }}",
                albedo_of(*albedo)
            )
        }
        Material::Mirror {
            reflectance,
            two_sided,
        } => format!(
            "Material::Mirror {{ reflectance: {}, two_sided: {two_sided} }}",
            albedo_of(*reflectance)
        ),
        Material::Dielectric(glass) => format!("Material::Dielectric({})", smooth(glass)),
        Material::RoughDielectric(glass) => {
            let (reflectance, transmittance) = glass.tints();
            let smooth = smooth(&Dielectric::new(glass.eta()).tinted(reflectance, transmittance));
            format!(
                "Material::RoughDielectric(RoughDielectric::new({smooth}, Share::from_bits({})))",
                glass.alpha().to_bits()
            )
        }
        Material::OrenNayar(diffuse) => {
            let model = match diffuse.model() {
                OrenNayarModel::Full => "Full",
                OrenNayarModel::Qualitative => "Qualitative",
                OrenNayarModel::EnergyPreserving => "EnergyPreserving",
            };
            format!(
                "Material::OrenNayar(OrenNayar::new(OrenNayarModel::{model}, {}, Turn::from_bits({})){})",
                albedo_of(diffuse.reflectance()),
                u32::from(diffuse.sigma().to_bits()) << 15,
                side(diffuse.is_two_sided())
            )
        }
        Material::BlinnPhong(phong) => format!(
            "Material::BlinnPhong(BlinnPhong::new({}, {}, Metres::from_bits({})){}{})",
            albedo_of(phong.diffuse()),
            albedo_of(phong.specular()),
            phong.exponent().to_bits(),
            if phong.is_normalized() {
                ""
            } else {
                ".unnormalized()"
            },
            side(phong.is_two_sided())
        ),
        Material::Conductor(metal) => {
            let index = metal.index().map_or_else(String::new, |index| {
                let [eta, k] = index.map(|of| {
                    of.map(|c| format!("Index::from_bits({})", c.to_bits()))
                        .join(", ")
                });
                format!(".with_index([{eta}], [{k}])")
            });
            let rough = match metal.is_rough() {
                true => format!(".rough(Share::from_bits({}))", metal.alpha().to_bits()),
                false => String::new(),
            };
            format!(
                "Material::Conductor(Conductor::new({}){index}{rough}{})",
                albedo_of(metal.reflectance()),
                side(metal.is_two_sided())
            )
        }
    }
}
