//! Rays against a scene: the tree over its finite shapes, then its infinite planes.

use super::{Hit, Mesh, Scene, ShapeSet};
use crate::bvh::{self, Order, Visitor, traverse};
use crate::geom::{FAR, Ray};
use crate::light::{Environment, Light};
use crate::shape::{Geometry, GridRay, Instance, LAST, MeshHit, Sight, Slopes};
use core::ops::ControlFlow;

/// Closed forms that are tested in turn without a tree.
///
/// A node's four boxes cost about what two spheres do, and the quantised ray one more.
const FEW: u16 = 8;

/// Lights that are asked one by one in [`Scene::closest_light`].
const FEW_LIGHTS: u32 = 4;

/// The light at the end of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seen {
    /// A shape that emits light, from whichever side it is seen.
    Emitter(Hit),
    /// Nothing stands in the way of what comes from all around.
    Environment,
}

impl Scene<'_> {
    /// The first thing the ray meets; of several at the same distance, the first in the scene's order.
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        if self.is_small() {
            return self.closest_of_few(ray);
        }
        let slopes = Slopes::new(ray.dir);
        let mut nearest = Nearest::none(self, ray, &slopes);
        for index in self.bounded()..self.parts.shapes.len() {
            nearest.test(index);
        }
        if let Some(grid_ray) = GridRay::enter_here(&self.parts.grid, ray, &slopes) {
            if nearest.hit.is_some() {
                nearest.limit = depth_limit(&grid_ray, nearest.t_max + 1);
            }
            traverse(self.parts.nodes, &grid_ray, &mut nearest);
        }
        nearest.hit
    }

    /// [`Self::closest`] of a ray that leaves shape number `from`: from cell to cell, if they are told ([`Self::foresee`]).
    #[cfg_attr(narrow_mul, inline(never))]
    pub fn closest_from(&self, ray: &Ray, from: u16) -> Option<Hit> {
        match self.closest_in_cells(ray, from) {
            Some(found) => found,
            None => self.closest(ray),
        }
    }

    /// [`Self::closest`] of a ray that meets nothing but what is in `among`.
    #[inline]
    pub fn closest_among(&self, ray: &Ray, among: ShapeSet) -> Option<Hit> {
        if among.is_all() {
            return self.closest(ray);
        }
        self.closest_named(ray, among)
    }

    #[cfg_attr(narrow_mul, inline(never))]
    fn closest_named(&self, ray: &Ray, among: ShapeSet) -> Option<Hit> {
        if among.has_mesh() {
            let slopes = Slopes::new(ray.dir);
            let mut nearest = Nearest::none(self, ray, &slopes);
            for index in among.named() {
                nearest.test(index);
            }
            return nearest.hit;
        }
        let (mut nearest, mut t_max) = (usize::MAX, FAR + 1);
        for index in among.named() {
            let Some(shape) = self.parts.shapes.get(index) else {
                continue;
            };
            // As far as the nearest is for one that stands before it in the scene's order.
            if let Some(t) = self.form(&shape.geometry, ray, t_max + (index < nearest) as i32) {
                (nearest, t_max) = (index, t);
            }
        }
        (nearest != usize::MAX).then(|| Hit::of_form(nearest, t_max))
    }

    /// The same answer from all shapes and triangles in turn.
    pub fn closest_linear(&self, ray: &Ray) -> Option<Hit> {
        let slopes = Slopes::new(ray.dir);
        let mut nearest = Nearest::none(self, ray, &slopes);
        for index in 0..self.parts.shapes.len() {
            nearest.accept(
                index,
                self.intersect_linear(index, ray, &slopes, nearest.t_max + 1),
            );
        }
        nearest.hit
    }

    /// Whether anything but shape number `except` stands nearer than `distance` along the ray.
    pub fn occluded(&self, ray: &Ray, distance: i32, except: Option<u16>) -> bool {
        let except = except.map_or(usize::MAX, usize::from);
        if self.is_small() {
            return self.any_of(0, ray, distance, except);
        }
        if self.planes_occlude(ray, distance, except) {
            return true;
        }
        let slopes = Slopes::new(ray.dir);
        let Some(grid_ray) = GridRay::enter_here(&self.parts.grid, ray, &slopes) else {
            return false;
        };
        let limit = depth_limit(&grid_ray, distance);
        let mut any = Any {
            scene: self,
            ray,
            slopes: &slopes,
            distance,
            except,
            limit,
            found: false,
        };
        traverse(self.parts.nodes, &grid_ray, &mut any);
        any.found
    }

    /// [`Self::occluded`] where nothing but what is in `among` can be in the way.
    #[inline]
    pub fn occluded_by(&self, among: ShapeSet, ray: &Ray, distance: i32, except: Option<u16>) -> bool {
        if among.is_all() {
            return self.occluded(ray, distance, except);
        }
        let except = except.map_or(usize::MAX, usize::from);
        if among.has_mesh() {
            let slopes = Slopes::new(ray.dir);
            return among
                .named()
                .any(|index| index != except && self.blocks(index, ray, &slopes, distance));
        }
        among.named().filter(|index| *index != except).any(|index| {
            let shape = self.parts.shapes.get(index);
            shape.is_some_and(|shape| self.form(&shape.geometry, ray, distance).is_some())
        })
    }

    /// Whether a shape stands nearer than `distance` along the ray.
    #[inline]
    fn blocks(&self, index: usize, ray: &Ray, slopes: &Slopes, distance: i32) -> bool {
        let parts = &self.parts;
        let Some(shape) = parts.shapes.get(index) else {
            return false;
        };
        match shape.geometry {
            Geometry::Mesh(mesh) => parts
                .meshes
                .get(mesh as usize)
                .is_some_and(|mesh| bvh::occluded(&mesh.triangles, mesh.nodes, ray, slopes, distance)),
            Geometry::Instance(ref instance) => self.instance_occludes(instance, ray, distance),
            ref geometry => self.form(geometry, ray, distance).is_some(),
        }
    }

    /// What of the scene's lights the ray meets first: the last segment of a path asks for nothing else.
    ///
    /// With a few emitters they are asked first, and what may stand before the nearest of them after, which is cheaper
    /// than the nearest of all; a hit on an emitter at the very distance of another shape counts.
    #[cfg_attr(narrow_mul, inline(never))]
    pub fn closest_light(&self, ray: &Ray) -> Option<Seen> {
        if self.light_count - u32::from(self.environment.is_sampled()) > FEW_LIGHTS {
            return match self.closest(ray) {
                Some(hit) => self.is_emitter(hit.shape).then_some(Seen::Emitter(hit)),
                None => Some(Seen::Environment),
            };
        }
        let mut nearest: Option<Hit> = None;
        for light in self.parts.lights {
            let Light::Area { shape, .. } = *light else {
                continue;
            };
            let t_max = nearest.map_or(FAR + 1, |hit| hit.t);
            let found = match self.parts.shapes.get(shape as usize).map(|shape| &shape.geometry) {
                Some(Geometry::Mesh(_)) => self.intersect(shape as usize, ray, &Slopes::new(ray.dir), t_max),
                Some(form) => self.form(form, ray, t_max).map(|t| Hit::of_form(shape.into(), t)),
                None => None,
            };
            nearest = found.or(nearest);
        }
        match nearest {
            Some(hit) => (!self.occluded(ray, hit.t, Some(hit.shape))).then_some(Seen::Emitter(hit)),
            None if matches!(self.environment, Environment::None) => None,
            None => (!self.occluded(ray, FAR + 1, None)).then_some(Seen::Environment),
        }
    }

    fn is_emitter(&self, shape: u16) -> bool {
        self.parts
            .shapes
            .get(shape as usize)
            .is_some_and(|shape| shape.light.is_some())
    }

    /// Whether asking each shape in turn is cheaper than the tree: a few closed forms.
    fn is_small(&self) -> bool {
        self.parts.bounded <= FEW && self.parts.meshes.is_empty()
    }

    /// Whether an infinite plane stands nearer than `distance`.
    #[inline]
    pub(super) fn planes_occlude(&self, ray: &Ray, distance: i32, except: usize) -> bool {
        self.bounded() < self.parts.shapes.len() && self.any_of(self.bounded(), ray, distance, except)
    }

    /// Whether a closed form from place `first` on is met within `distance`.
    #[inline]
    fn any_of(&self, first: usize, ray: &Ray, distance: i32, except: usize) -> bool {
        let sight = Sight::new(ray.dir);
        match sight.axis {
            0 => self.any_seen::<0>(first, ray, &sight, distance, except),
            1 => self.any_seen::<1>(first, ray, &sight, distance, except),
            _ => self.any_seen::<2>(first, ray, &sight, distance, except),
        }
    }

    fn any_seen<const K: usize>(
        &self,
        first: usize,
        ray: &Ray,
        sight: &Sight,
        distance: i32,
        except: usize,
    ) -> bool {
        for (index, shape) in self.parts.shapes.iter().enumerate().skip(first) {
            if index != except
                && self
                    .form_next::<K>(&shape.geometry, ray, sight, distance)
                    .is_some()
            {
                return true;
            }
        }
        false
    }

    #[inline]
    fn closest_of_few(&self, ray: &Ray) -> Option<Hit> {
        let sight = Sight::new(ray.dir);
        match sight.axis {
            0 => self.closest_seen::<0>(ray, &sight),
            1 => self.closest_seen::<1>(ray, &sight),
            _ => self.closest_seen::<2>(ray, &sight),
        }
    }

    fn closest_seen<const K: usize>(&self, ray: &Ray, sight: &Sight) -> Option<Hit> {
        let mut t_max = FAR + 1;
        let mut nearest = None;
        for (index, shape) in self.parts.shapes.iter().enumerate() {
            if let Some(t) = self.form_next::<K>(&shape.geometry, ray, sight, t_max) {
                t_max = t;
                nearest = Some(index);
            }
        }
        nearest.map(|shape| Hit::of_form(shape, t_max))
    }

    /// Distance to the first crossing with anything but a mesh.
    #[inline]
    pub(super) fn form(&self, geometry: &Geometry, ray: &Ray, t_max: i32) -> Option<i32> {
        match geometry {
            Geometry::Implicit(solid) => solid.intersect(self.parts.blobs, ray, t_max),
            form => form.intersect(ray, t_max),
        }
    }

    /// The same for loops that ask shape after shape; `K` is the ray's dominant axis.
    #[inline(always)]
    fn form_next<const K: usize>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        sight: &Sight,
        t_max: i32,
    ) -> Option<i32> {
        match geometry {
            Geometry::Implicit(solid) => solid.intersect(self.parts.blobs, ray, t_max),
            form => form.intersect_next::<K>(ray, sight, t_max),
        }
    }

    fn bounded(&self) -> usize {
        self.parts.bounded as usize
    }

    /// The nearest hit on one shape, at a distance under `t_max`.
    #[inline]
    fn intersect(&self, index: usize, ray: &Ray, slopes: &Slopes, t_max: i32) -> Option<Hit> {
        let found = match &self.parts.shapes.get(index)?.geometry {
            Geometry::Mesh(mesh) => {
                let mesh = self.mesh(*mesh)?;
                bvh::closest(&mesh.triangles, mesh.nodes, ray, slopes, t_max)?
            }
            Geometry::Instance(instance) => self.closest_of_instance(instance, ray, t_max)?,
            form => return Some(Hit::of_form(index, self.form(form, ray, t_max)?)),
        };
        Some(Hit::of_mesh(index, found))
    }

    #[cold]
    #[inline(never)]
    fn closest_of_instance(&self, instance: &Instance, ray: &Ray, t_max: i32) -> Option<MeshHit> {
        self.instance(instance, ray, t_max, |mesh, ray, slopes, t_max| {
            bvh::closest(&mesh.triangles, mesh.nodes, ray, slopes, t_max)
        })
    }

    fn intersect_linear(&self, index: usize, ray: &Ray, slopes: &Slopes, t_max: i32) -> Option<Hit> {
        let list = |mesh: &Mesh, ray: &Ray, slopes: &Slopes, t_max| {
            bvh::closest_linear(&mesh.triangles, ray, slopes, t_max)
        };
        let found = match self.parts.shapes.get(index)?.geometry {
            Geometry::Mesh(mesh) => list(self.mesh(mesh)?, ray, slopes, t_max)?,
            Geometry::Instance(ref instance) => self.instance(instance, ray, t_max, list)?,
            _ => return self.intersect(index, ray, slopes, t_max),
        };
        Some(Hit::of_mesh(index, found))
    }

    #[inline]
    fn mesh(&self, mesh: u16) -> Option<&Mesh<'_>> {
        self.parts.meshes.get(mesh as usize)
    }

    /// A hit in an instance's mesh, in its frame but for the distance.
    fn instance(
        &self,
        instance: &Instance,
        ray: &Ray,
        t_max: i32,
        closest: impl Fn(&Mesh, &Ray, &Slopes, i32) -> Option<MeshHit>,
    ) -> Option<MeshHit> {
        let mesh = self.mesh(instance.mesh)?;
        let local = instance.enter(ray)?;
        let hit = closest(mesh, &local.ray, &local.slopes, instance.limit(t_max))?;
        Some(MeshHit {
            t: instance.distance(hit.t),
            ..hit
        })
    }

    /// Whether anything of an instance is nearer than `distance`.
    #[cold]
    #[inline(never)]
    fn instance_occludes(&self, instance: &Instance, ray: &Ray, distance: i32) -> bool {
        let (Some(mesh), Some(local)) = (self.mesh(instance.mesh), instance.enter(ray)) else {
            return false;
        };
        let limit = instance.limit(distance);
        bvh::occluded(&mesh.triangles, mesh.nodes, &local.ray, &local.slopes, limit)
    }
}

impl Hit {
    #[inline]
    pub(super) fn of_form(shape: usize, t: i32) -> Hit {
        Hit {
            t,
            shape: shape as u16,
            triangle: 0,
            barycentric: [0; 2],
        }
    }

    #[inline]
    fn of_mesh(shape: usize, hit: MeshHit) -> Hit {
        Hit {
            t: hit.t,
            shape: shape as u16,
            triangle: hit.triangle,
            barycentric: [hit.b1, hit.b2],
        }
    }
}

/// A depth in steps that no box of a shape met nearer than `distance` begins beyond.
///
/// The grid's ray may start a step ahead of the true one, and a shape be met before it: such a shape's box, which is
/// [`crate::bvh::SCENE_PAD`] steps larger, still reaches to depth 0.
#[inline]
fn depth_limit(ray: &GridRay, distance: i32) -> i32 {
    ray.limit(distance).max(0)
}

/// The nearest hit so far, by distance and then by the shape's place.
struct Nearest<'a> {
    scene: &'a Scene<'a>,
    ray: &'a Ray,
    slopes: &'a Slopes,
    /// The distance of `hit`; beyond all there may be while there is none.
    t_max: i32,
    hit: Option<Hit>,
    /// `t_max` as a depth in the scene's grid.
    limit: i32,
}

impl<'a> Nearest<'a> {
    #[inline(always)]
    fn none(scene: &'a Scene<'a>, ray: &'a Ray, slopes: &'a Slopes) -> Nearest<'a> {
        Nearest {
            scene,
            ray,
            slopes,
            t_max: FAR + 1,
            hit: None,
            limit: LAST,
        }
    }

    #[inline]
    fn test(&mut self, index: usize) -> bool {
        // One unit more, so that an equal distance is seen and decided by place.
        self.accept(
            index,
            self.scene.intersect(index, self.ray, self.slopes, self.t_max + 1),
        )
    }

    #[inline]
    fn accept(&mut self, index: usize, found: Option<Hit>) -> bool {
        let Some(hit) = found else { return false };
        let first = self.hit.is_none_or(|best| index < best.shape as usize);
        if hit.t > self.t_max || (hit.t == self.t_max && !first) {
            return false;
        }
        (self.t_max, self.hit) = (hit.t, Some(hit));
        true
    }
}

impl Visitor for Nearest<'_> {
    const ORDER: Order = Order::Face;
    const BY_AXIS: bool = false;

    #[inline(always)]
    fn limit(&self) -> i32 {
        self.limit
    }

    #[inline]
    fn visit<const K: usize>(&mut self, ray: &GridRay, base: u32, leaf: u32) -> ControlFlow<()> {
        for index in bvh::primitives(base, leaf) {
            if self.test(index as usize) {
                self.limit = depth_limit(ray, self.t_max + 1);
            }
        }
        ControlFlow::Continue(())
    }
}

/// Whether anything is in the way.
struct Any<'a> {
    scene: &'a Scene<'a>,
    ray: &'a Ray,
    slopes: &'a Slopes,
    distance: i32,
    except: usize,
    limit: i32,
    found: bool,
}

impl Visitor for Any<'_> {
    const ORDER: Order = Order::Any;
    const BY_AXIS: bool = false;

    #[inline(always)]
    fn limit(&self) -> i32 {
        self.limit
    }

    #[inline]
    fn visit<const K: usize>(&mut self, _: &GridRay, base: u32, leaf: u32) -> ControlFlow<()> {
        for index in bvh::primitives(base, leaf).filter(|index| *index as usize != self.except) {
            self.found = self
                .scene
                .blocks(index as usize, self.ray, self.slopes, self.distance);
            if self.found {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    }
}
