//! The scene: borrowed, checked once at [`Scene::new`], then safe to render.
//!
//! What its words mean, here as in Mitsuba 3: right-handed coordinates. A path of n segments meets n − 1 surfaces before
//! the one it ends on: depth 1 is emission, 2 direct light. Pixel (x, y) covers [x, x + 1) × [y, y + 1), y down. An
//! area light emits on the side of its normal, spheres outwards; a dielectric's inside is where its normal does not
//! point. Light is W·sr⁻¹·m⁻² a channel, linear sRGB; a point light's intensity falls off by 1/d², d in metres; a
//! directional light is irradiance on a plane that faces it.

mod ahead;
mod arrange;
mod baked;
mod builder;
pub mod builtin;
mod check;
mod distant;
mod emit;
mod power;
mod prospect;
mod query;

use crate::bvh::Node;
use crate::color::{Albedo, Radiance};
use crate::geom::{Dir, FAR, Point, Ray, Unit};
use crate::light::{self, Emitter, Environment, Light, LightSample};
use crate::material::{BsdfSample, Drawn, Local, Material, Texture};
use crate::num::{Uniform, Wide};
use crate::shape::{Blob, Geometry, Grid, Instance, MeshHit, Surface, Triangles};

use distant::Ball;

pub use ahead::{Ahead, ShapeSet};
pub use arrange::{Arrangement, Boxed, arrange};
pub use baked::{
    Background, Baked, BakedError, BlobRecord, Entry as BakedEntry, Field as BakedField, Head as BakedHead,
    LightRecord, MapRecord, MaterialRecord, Records, Room, ShapeRecord, Shot, SkyRecord, Technique,
    TextureRecord, Whole, WholeHead,
};
pub use builder::{Borrowed, MaterialId, SceneBuilder};
pub use check::SceneError;
pub use prospect::Prospect;
pub use query::Seen;

/// A shape with what it is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    pub geometry: Geometry,
    /// Index into the scene's materials.
    pub material: u16,
    /// Index of the area light that the shape is.
    pub light: Option<u16>,
    pub tint: Tint,
    /// The user's number for it: what errors and the `id` layer name.
    pub id: u16,
}

/// What the material's own colour is multiplied by ([`Material::tinted`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tint {
    #[default]
    None,
    /// The colours of the mesh's vertices.
    Vertices,
    /// Index into the scene's textures; the mesh's vertices say where in it they are.
    Texture(u16),
}

/// A triangle mesh with the tree over it.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    pub triangles: Triangles<'a>,
    pub nodes: &'a [Node],
}

/// What a scene is made of; [`Scene::new`] checks it.
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a> {
    pub unit: Unit,
    /// Finite ones first, in the order of the tree over them ([`arrange`]), then infinite planes.
    pub shapes: &'a [Shape],
    /// How many shapes are finite.
    pub bounded: u16,
    pub materials: &'a [Material],
    /// A constant environment, if there is one, last.
    pub lights: &'a [Light],
    /// Any other environment: the last of the lights to choose from.
    pub environment: Environment<'a>,
    /// How lights are chosen: bounds between them, in 2^-32 and rising, one fewer than there are lights to choose from
    /// ([`Scene::choose_by_power`] makes them); evenly if there are none.
    pub choice: &'a [u32],
    pub meshes: &'a [Mesh<'a>],
    pub textures: &'a [Texture<'a>],
    /// What metaballs and smooth unions are made of.
    pub blobs: &'a [Blob],
    /// Around the finite shapes.
    pub grid: Grid,
    /// The tree over the finite shapes.
    pub nodes: &'a [Node],
}

/// A scene that can be rendered: everything in it was checked.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    parts: Parts<'a>,
    /// How many lights are drawn from; a constant environment stands after them.
    light_count: u32,
    environment: Environment<'a>,
    depth: usize,
    /// Around the finite shapes.
    ball: Option<Ball>,
}

/// Where a ray met something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hit {
    /// Distance along the ray, units.
    pub t: i32,
    /// Index into the scene's shapes.
    pub shape: u16,
    /// Number of the triangle, in a mesh.
    pub triangle: u32,
    /// Weights of the triangle's second and third corner, Q16.
    pub barycentric: [i32; 2],
}

/// All that an integrator wants to know about a hit.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<'a> {
    pub surface: Surface,
    /// What a mesh's vertices say of it.
    pub told: Told,
    /// Back along the ray.
    pub wo: Dir,
    pub material: &'a Material,
    /// The light that the surface is, seen from its bright side.
    pub light: Option<u16>,
    pub emission: Radiance,
    /// Whether the shape emits light, on this side or the other.
    pub is_emitter: bool,
    /// The user's number for the shape.
    pub id: u16,
}

/// What the vertices of a mesh say of a hit beside where it is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Told {
    /// The normal for shading between theirs.
    pub shading: Option<Dir>,
    /// What the material's own colour is multiplied by.
    pub tint: Option<Albedo>,
}

/// Out of the way of all that have none, and without the vertex, which then can stay in registers.
impl Told {
    /// As seen along `wo`.
    #[inline]
    fn local(&self, geometric: Dir, wo: Dir) -> Local {
        let normal = match self.shading {
            Some(shading) if are_one_side(shading, geometric, wo) => shading,
            _ => geometric,
        };
        Local { normal, wo }
    }

    fn leaks(&self, local: &Local, geometric: Dir, wi: Dir) -> bool {
        self.shading.is_some() && !are_one_side(local.normal, geometric, wi)
    }

    fn tinted(&self, material: &Material) -> Material {
        match self.tint {
            None => *material,
            Some(tint) => material.tinted(tint),
        }
    }

    #[cold]
    #[inline(never)]
    fn eval(&self, material: &Material, geometric: Dir, wo: Dir, wi: Dir) -> Option<(Radiance, Wide)> {
        let local = self.local(geometric, wo);
        if self.leaks(&local, geometric, wi) {
            return None;
        }
        self.tinted(material).eval(&local, wi)
    }

    #[cold]
    #[inline(never)]
    fn pdf(&self, material: &Material, geometric: Dir, wo: Dir, wi: Dir) -> Wide {
        let local = self.local(geometric, wo);
        if self.leaks(&local, geometric, wi) {
            return Wide::ZERO;
        }
        material.pdf(&local, wi)
    }

    #[cold]
    #[inline(never)]
    fn draw(
        &self,
        material: &Material,
        geometric: Dir,
        wo: Dir,
        (u, lobe): ([Uniform; 2], Uniform),
    ) -> Option<Drawn> {
        let local = self.local(geometric, wo);
        let drawn = self.tinted(material).draw(&local, u, lobe)?;
        (!self.leaks(&local, geometric, drawn.wi)).then_some(drawn)
    }
}

/// What the material does here. It sees the shading normal, but the geometric one decides sides (Veach 1997, section 5.3):
///
/// - where the two put the eye on different sides, at a smooth mesh's outline, the material sees the geometric one;
/// - light goes nowhere where they put its direction on different sides, or else it would leak through the surface.
impl Vertex<'_> {
    /// The normal that shading sees, on the eye's side.
    #[inline]
    pub fn facing(&self) -> Dir {
        let Local { normal, wo } = self.told.local(self.surface.normal, self.wo);
        if wo.dot_q24(normal) < 0 { -normal } else { normal }
    }

    /// [`Material::eval`] of light that comes from `wi`.
    #[inline]
    pub fn eval(&self, wi: Dir) -> Option<(Radiance, Wide)> {
        self.eval_towards(self.wo, wi)
    }

    /// The same of what the vertex has of a light.
    #[inline]
    pub fn eval_before(&self, prospect: &Prospect, wi: Dir) -> Option<(Radiance, Wide)> {
        match *prospect {
            Prospect::Ball { normal, .. } if self.is_plain() => self.material.eval_about(normal, self.wo, wi),
            _ => self.eval(wi),
        }
    }

    /// The same of light on its way to `wo`.
    #[inline]
    pub fn eval_towards(&self, wo: Dir, wi: Dir) -> Option<(Radiance, Wide)> {
        if self.is_plain() {
            let normal = self.surface.normal;
            return self.material.eval(&Local { normal, wo }, wi);
        }
        self.told.eval(self.material, self.surface.normal, wo, wi)
    }

    /// [`Material::pdf`] of `wi`, coming along `wo`.
    #[inline]
    pub fn pdf(&self, wo: Dir, wi: Dir) -> Wide {
        if self.is_plain() {
            let normal = self.surface.normal;
            return self.material.pdf(&Local { normal, wo }, wi);
        }
        self.told.pdf(self.material, self.surface.normal, wo, wi)
    }

    /// [`Material::sample`].
    #[inline]
    pub fn sample(&self, u: [Uniform; 2], lobe: Uniform) -> Option<BsdfSample> {
        self.draw(u, lobe).map(Drawn::weigh)
    }

    /// [`Material::draw`].
    #[cfg_attr(narrow_mul, inline(never))]
    #[cfg_attr(not(narrow_mul), inline)]
    pub fn draw(&self, u: [Uniform; 2], lobe: Uniform) -> Option<Drawn> {
        if self.is_plain() {
            let local = Local {
                normal: self.surface.normal,
                wo: self.wo,
            };
            return self.material.draw(&local, u, lobe);
        }
        self.told
            .draw(self.material, self.surface.normal, self.wo, (u, lobe))
    }

    /// The normal on the eye's side, if directions are drawn with the density of a cosine about it.
    #[inline]
    fn diffuse_normal(&self) -> Option<Dir> {
        self.material
            .diffuse_normal(&self.told.local(self.surface.normal, self.wo))
    }

    /// Neither smooth normals nor colours: most shapes, for which the rest shall not be in the way.
    #[inline]
    fn is_plain(&self) -> bool {
        self.told.shading.is_none() && self.told.tint.is_none()
    }

    /// [`Material::albedo`].
    pub fn albedo(&self) -> Albedo {
        self.told.tinted(self.material).albedo()
    }

    /// [`Material::eta_squared`].
    #[inline]
    pub fn eta_squared(&self, wi: Dir) -> Wide {
        self.material
            .eta_squared(&self.told.local(self.surface.normal, self.wo), wi)
    }

    /// Whether light is reflected as well one way as the other, but for [`Self::eta_squared`].
    #[inline]
    pub fn is_reciprocal(&self) -> bool {
        self.told.shading.is_none() && self.material.is_reciprocal()
    }

    /// What light that a mirror or glass sends from `wo` to `wi` gains over radiance that goes the other way: the squared
    /// ratio of refractive indices, and with a shading normal n_s beside n_g |n_s·wo| |n_g·wi| / (|n_g·wo| |n_s·wi|)
    /// (Veach 1997, equation 5.19).
    pub fn specular_light_gain(&self, sample: &BsdfSample) -> Wide {
        if self.told.shading.is_none() {
            return sample.eta_squared;
        }
        let (local, wi) = (self.told.local(self.surface.normal, self.wo), sample.wi);
        let cos = |a: Dir, b: Dir| Wide::new(a.dot_q24(b).unsigned_abs().max(1), -24);
        let (shading, geometric) = (local.normal, self.surface.normal);
        let gain =
            cos(shading, local.wo) * cos(geometric, wi) / (cos(geometric, local.wo) * cos(shading, wi));
        sample.eta_squared * gain
    }
}

/// Whether two normals put a direction on the same side.
#[inline]
fn are_one_side(a: Dir, b: Dir, dir: Dir) -> bool {
    (a.dot_q24(dir) > 0) == (b.dot_q24(dir) > 0)
}

/// What a shape's number says that is none, which no hit has: black, and facing the ray.
static NOTHING: Shape = Shape {
    geometry: Geometry::Mesh(u16::MAX),
    material: u16::MAX,
    light: None,
    tint: Tint::None,
    id: 0,
};

impl<'a> Scene<'a> {
    pub fn unit(&self) -> Unit {
        self.parts.unit
    }

    pub fn parts(&self) -> &Parts<'a> {
        &self.parts
    }

    /// Levels of nodes on the longest way from the scene's root to a leaf, the mesh's own included.
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// How many lights [`Self::sample_light`] draws from.
    #[inline]
    pub fn light_count(&self) -> u32 {
        self.light_count
    }

    /// What comes from where nothing is: see [`Self::background`].
    #[inline]
    pub fn environment(&self) -> &Environment<'a> {
        &self.environment
    }

    /// The radiance from infinitely far away that is seen along a direction.
    #[inline]
    pub fn background(&self, dir: Dir) -> Radiance {
        self.environment.radiance(dir)
    }

    /// The density per solid angle with which choosing the environment and sampling it would have led to a direction; 0
    /// if it is not sampled.
    #[inline]
    pub fn background_pdf(&self, dir: Dir) -> Wide {
        if self.environment.is_sampled() {
            self.environment.pdf(dir) * self.light_chance(self.light_count - 1)
        } else {
            Wide::ZERO
        }
    }

    /// One of the lights by a number, and what is left of it as a new one.
    #[inline]
    pub fn choose_light(&self, u: Uniform) -> (u32, Uniform) {
        if self.parts.choice.is_empty() {
            light::choose(u, self.light_count)
        } else {
            light::choose_by(u, self.parts.choice)
        }
    }

    /// How often [`Self::choose_light`] takes a light; the environment, if it is sampled, is the last.
    #[inline]
    pub fn light_chance(&self, index: u32) -> Wide {
        if self.light_count == 1 {
            Wide::ONE
        } else if self.parts.choice.is_empty() {
            Wide::new(self.light_count, 0).recip()
        } else {
            light::chance_by(index as usize, self.parts.choice)
        }
    }

    /// The surface where the ray met it.
    #[inline]
    pub fn vertex(&self, ray: &Ray, hit: &Hit) -> Vertex<'a> {
        let near = ray.at(hit.t);
        let shape = self.parts.shapes.get(hit.shape as usize).unwrap_or(&NOTHING);
        match shape.geometry.surface(near) {
            Some(surface) => self.vertex_of(ray, shape, surface, Told::default()),
            None => self.vertex_of_other(ray, hit, shape, near),
        }
    }

    /// Of what is no closed form.
    #[cfg_attr(narrow_mul, inline(never))]
    #[cfg_attr(not(narrow_mul), inline)]
    fn vertex_of_other(&self, ray: &Ray, hit: &Hit, shape: &Shape, near: Point) -> Vertex<'a> {
        let mut told = Told::default();
        let surface = match &shape.geometry {
            Geometry::Mesh(mesh) => self.mesh_surface(*mesh, hit, shape.tint, &mut told),
            Geometry::Instance(instance) => self.instance_surface(instance, hit, shape.tint, &mut told),
            Geometry::Implicit(solid) => Some(solid.surface(self.parts.blobs, near)),
            _ => None,
        };
        let surface = surface.unwrap_or(Surface {
            point: near,
            normal: -ray.dir,
            lift: 0,
        });
        self.vertex_of(ray, shape, surface, told)
    }

    #[inline(always)]
    fn vertex_of(&self, ray: &Ray, shape: &Shape, surface: Surface, told: Told) -> Vertex<'a> {
        let wo = -ray.dir;
        let material = self.parts.materials.get(shape.material as usize);
        let light = shape.light.filter(|_| wo.dot_q24_normal(surface.normal) > 0);
        let emission = match light.and_then(|light| self.parts.lights.get(light as usize)) {
            Some(Light::Area { radiance, .. }) => *radiance,
            _ => Radiance::BLACK,
        };
        Vertex {
            surface,
            told,
            wo,
            material: material.unwrap_or(&Material::Black),
            light,
            emission,
            is_emitter: shape.light.is_some(),
            id: shape.id,
        }
    }

    /// Whether a mirror there shows things as flat ones do; a mesh is flat where its vertices have no normals.
    pub fn is_flat(&self, hit: &Hit, vertex: &Vertex) -> bool {
        let shape = self.parts.shapes.get(hit.shape as usize);
        match shape.map(|shape| &shape.geometry) {
            Some(Geometry::Sphere(_) | Geometry::Implicit(_)) => false,
            _ => vertex.told.shading.is_none(),
        }
    }

    /// A direction from a place towards light number `index`; `None` where it can send nothing. The shadow ray begins where
    /// [`Surface::leave`] says.
    #[inline]
    pub fn sample_light(&self, index: u32, from: &Surface, u: [Uniform; 2]) -> Option<LightSample> {
        let Some(light) = self.parts.lights.get(index as usize) else {
            return self.sample_background(index, u);
        };
        match *light {
            Light::Point { position, intensity } => {
                light::sample_point(position, intensity, from.point, self.parts.unit.fraction_bits())
            }
            Light::Directional {
                direction,
                irradiance,
            } => Some(light::sample_directional(direction, irradiance)),
            Light::Area { shape, radiance } => {
                let geometry = &self.parts.shapes.get(shape as usize)?.geometry;
                let Geometry::Mesh(mesh) = *geometry else {
                    let sample = light::sample_area(Emitter::Shape(geometry), radiance, from, u)?;
                    let is_sphere = matches!(geometry, Geometry::Sphere(_));
                    return Some(LightSample {
                        shape: is_sphere.then_some(shape),
                        ..sample
                    });
                };
                let count = self.drawn_triangles(mesh)?;
                let (triangle, rest) = light::choose(u[0], count);
                let sample =
                    light::sample_area(self.triangle(mesh, triangle)?, radiance, from, [rest, u[1]])?;
                Some(LightSample { triangle, ..sample })
            }
            Light::Environment { .. } => None,
        }
    }

    /// The environment, if it is light number `index`.
    fn environment_of(&self, index: u32) -> Option<&Environment<'a>> {
        (index == self.light_count.wrapping_sub(1)).then_some(&self.environment)
    }

    fn sample_background(&self, index: u32, u: [Uniform; 2]) -> Option<LightSample> {
        let sample = self.environment_of(index)?.sample(u)?;
        Some(LightSample {
            wi: sample.wi,
            distance: FAR + 1,
            radiance: sample.radiance,
            pdf: sample.pdf,
            shape: None,
            triangle: 0,
        })
    }

    /// The density per solid angle with which choosing a light and sampling it would have led to this hit.
    #[inline]
    pub fn light_pdf(&self, light: u16, from: Point, wi: Dir, hit: &Hit) -> Wide {
        let Some(shape) = self.parts.shapes.get(hit.shape as usize) else {
            return Wide::ZERO;
        };
        debug_assert_eq!(shape.light, Some(light));
        self.shape_pdf(from, wi, hit) * self.light_chance(u32::from(light))
    }

    /// The same if the light is chosen already.
    #[inline]
    fn shape_pdf(&self, from: Point, wi: Dir, hit: &Hit) -> Wide {
        let Some(shape) = self.parts.shapes.get(hit.shape as usize) else {
            return Wide::ZERO;
        };
        let emitter = match shape.geometry {
            Geometry::Mesh(mesh) => self.triangle(mesh, hit.triangle),
            _ => Some(Emitter::Shape(&shape.geometry)),
        };
        emitter.map_or(Wide::ZERO, |emitter| light::pdf_area(emitter, from, wi, hit.t))
    }

    /// How many triangles a mesh that emits light is drawn from. Those of a packed mesh are not: their numbers have gaps,
    /// and it is found by BSDF sampling alone, with weight 1.
    fn drawn_triangles(&self, mesh: u16) -> Option<u32> {
        let mesh = self.parts.meshes.get(mesh as usize)?;
        Some(mesh.triangles.plain()?.triangles.len() as u32)
    }

    /// A triangle as one of its mesh's, any of which may be drawn.
    fn triangle(&self, mesh: u16, triangle: u32) -> Option<Emitter<'a>> {
        let count = self.drawn_triangles(mesh)?;
        let mesh = &self.parts.meshes.get(mesh as usize)?.triangles;
        Some(Emitter::Triangle {
            corners: mesh.corners(triangle)?.map(|corner| mesh.grid().to_scene(corner)),
            normal: mesh.normal(triangle)?,
            lift: mesh.offset(),
            area: mesh.double_area(triangle).shl(-1),
            chance: Wide::new(count, 0).recip(),
        })
    }

    #[cold]
    #[inline(never)]
    fn instance_surface(
        &self,
        instance: &Instance,
        hit: &Hit,
        tint: Tint,
        told: &mut Told,
    ) -> Option<Surface> {
        let mesh = &self.parts.meshes.get(instance.mesh as usize)?.triangles;
        let local = self.mesh_surface(instance.mesh, hit, tint, told)?;
        told.shading = told.shading.map(|normal| instance.direction(normal));
        Some(Surface {
            point: instance.place(local.point),
            normal: instance.direction(local.normal),
            lift: instance.lift(mesh),
        })
    }

    fn mesh_surface(&self, mesh: u16, hit: &Hit, tint: Tint, told: &mut Told) -> Option<Surface> {
        let mesh = &self.parts.meshes.get(mesh as usize)?.triangles;
        let [b1, b2] = hit.barycentric;
        let hit = MeshHit {
            t: hit.t,
            triangle: hit.triangle,
            b1,
            b2,
        };
        if mesh.is_smooth() {
            told.shading = mesh.shading_normal(&hit);
        }
        told.tint = match tint {
            Tint::None => None,
            Tint::Vertices => mesh.color(&hit),
            Tint::Texture(texture) => {
                let texture = self.parts.textures.get(texture as usize);
                texture.and_then(|texture| Some(texture.at(mesh.uv(&hit)?)))
            }
        };
        let (point, normal) = mesh.place(&hit)?;
        Some(Surface {
            point,
            normal,
            lift: mesh.offset(),
        })
    }
}
