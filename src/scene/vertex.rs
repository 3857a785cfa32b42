//! What an integrator wants to know of a hit: the surface there, and what its material does.

use super::{Hit, Prospect, Scene, Shape, Tint};
use crate::color::{Albedo, Radiance};
use crate::geom::{Dir, Point, Ray};
use crate::light::Light;
use crate::material::{BsdfSample, Drawn, Local, Material};
use crate::num::{Uniform, Wide};
use crate::shape::{Geometry, Instance, MeshHit, Surface};

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

    /// The same, with less to ask where `prospect` knows the side that faces the eye.
    #[inline]
    pub fn eval_with(&self, prospect: &Prospect, wi: Dir) -> Option<(Radiance, Wide)> {
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
    pub(super) fn diffuse_normal(&self) -> Option<Dir> {
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
