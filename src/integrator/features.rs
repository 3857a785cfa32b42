use super::View;
use crate::color::{Albedo, Radiance};
use crate::geom::{Dir, Ray};
use crate::material::Material;
use crate::num::{Share, Uniform};
use crate::scene::{Hit, Scene, ShapeSet, Vertex};

/// What is seen first that is no mirror or glass: the layers beside a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Features {
    pub albedo: Albedo,
    /// The one that shading sees, towards the eye's side.
    pub normal: Dir,
    /// Length of the way there, units; at most `i32::MAX`.
    pub depth: i32,
    /// The user's number for the shape.
    pub id: u16,
}

/// Mirrors and glass that a way may lead through before it is given up at the last.
const BOUNCES: usize = 8;

/// Follows a ray through mirrors and through glass (refracted, unless all is reflected); `None` where it meets nothing.
pub fn features(scene: &Scene, ray: Ray) -> Option<Features> {
    let mut last = Last { depth: 0, seen: None };
    follow(scene, ShapeSet::ALL, ray, &mut last, &mut 0);
    last.seen
}

/// What was met last on the way.
struct Last {
    depth: i32,
    seen: Option<Features>,
}

impl Witness for Last {
    fn surface(&mut self, _: &Scene, hit: &Hit, vertex: &Vertex, _: Radiance) {
        self.depth = self.depth.saturating_add(hit.t);
        self.seen = Some(Features {
            albedo: vertex.albedo(),
            normal: vertex.facing(),
            depth: self.depth,
            id: vertex.id,
        });
    }

    fn nothing(&mut self, _: &Ray, _: Radiance) {
        self.seen = None;
    }

    fn passed(&mut self, _: i32) {}
}

/// The same as a path's [`Witness`] would tell it: what shines and what is beyond everything has an answer, too.
///
/// `seen` is what the ray may meet itself; `rays` counts what was asked of the scene.
pub fn first(scene: &Scene, seen: ShapeSet, ray: Ray, rays: &mut u32) -> First {
    let mut first = First::new();
    follow(scene, seen, ray, &mut first, rays);
    first
}

/// Tells what the way meets that [`features`] follows.
fn follow(scene: &Scene, seen: ShapeSet, ray: Ray, witness: &mut impl Witness, rays: &mut u32) {
    let (mut ray, mut seen) = (ray, seen);
    let mut throughput = Radiance::WHITE;
    for bounce in 0..=BOUNCES {
        *rays = rays.wrapping_add(1);
        let Some(hit) = scene.closest_among(&ray, seen) else {
            return witness.nothing(&ray, throughput);
        };
        let vertex = scene.vertex(&ray, &hit);
        witness.surface(scene, &hit, &vertex, throughput);
        if is_end(&vertex) || bounce == BOUNCES {
            return;
        }
        // The last of the lobe's range: refraction, wherever there is any.
        let Some(onward) = vertex.sample([Uniform::ZERO; 2], Uniform::MAX) else {
            return;
        };
        throughput = throughput.mul(onward.weight);
        seen = ShapeSet::ALL;
        ray = Ray {
            origin: vertex.surface.leave(onward.wi),
            dir: onward.wi,
        };
    }
}

/// Neither mirror nor smooth glass.
fn is_end(vertex: &Vertex) -> bool {
    vertex.is_emitter || vertex.material.is_smooth()
}

/// Who wants to know what a camera path meets on its way.
pub trait Witness {
    /// The path met a surface at `hit`, with this throughput so far.
    fn surface(&mut self, scene: &Scene, hit: &Hit, vertex: &Vertex, throughput: Radiance);

    /// It met nothing.
    fn nothing(&mut self, ray: &Ray, throughput: Radiance);

    /// It went through a surface that the camera does not see.
    fn passed(&mut self, distance: i32);
}

impl<W: Witness> Witness for &mut W {
    #[inline(always)]
    fn surface(&mut self, scene: &Scene, hit: &Hit, vertex: &Vertex, throughput: Radiance) {
        W::surface(self, scene, hit, vertex, throughput);
    }

    #[inline(always)]
    fn nothing(&mut self, ray: &Ray, throughput: Radiance) {
        W::nothing(self, ray, throughput);
    }

    #[inline(always)]
    fn passed(&mut self, distance: i32) {
        W::passed(self, distance);
    }
}

/// Nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoWitness;

impl Witness for NoWitness {
    #[inline(always)]
    fn surface(&mut self, _: &Scene, _: &Hit, _: &Vertex, _: Radiance) {}

    #[inline(always)]
    fn nothing(&mut self, _: &Ray, _: Radiance) {}

    #[inline(always)]
    fn passed(&mut self, _: i32) {}
}

/// The first on a camera path that is no mirror or smooth glass; where a path ends before it, the last it met. Glass is
/// looked through, by refraction, wherever a ray gets through at all.
#[derive(Clone, Copy, Debug)]
pub struct First {
    /// Times what mirrors and glass before it let through; 1 for what shines.
    pub albedo: Albedo,
    /// As shading sees it, on the side the path came from; back along the path where it met nothing.
    pub normal: Dir,
    /// Units; `None` where what it shows is infinitely far.
    ///
    /// Where what is seen looks to be, so that it is found again when the camera has moved: behind flat mirrors and flat
    /// glass, at the length of the way; by way of what is curved, on that. (The image of what is far stands half a ball's
    /// radius behind its surface: nearer to that than to the length of the way.)
    pub distance: Option<i32>,
    /// The user's number for the shape; `None` where it met nothing.
    pub id: Option<u16>,
    /// Mirrors and glass on the way.
    pub bounces: u16,
    so_far: i32,
    /// Whether all was flat so far.
    is_flat: bool,
    is_found: bool,
    /// Whether the way went by chance: smooth glass reflects and refracts.
    is_drawn: bool,
}

impl First {
    /// What a path along `ray` met first, or, where glass drew lots for it, what [`first`] finds there: the same for all
    /// paths, so that chance is in their light alone.
    pub(super) fn settled(self, view: &View, ray: Ray, rays: &mut u32) -> First {
        if self.is_drawn {
            first(view.scene, view.ahead.seen, ray, rays)
        } else {
            self
        }
    }

    pub const fn new() -> First {
        First {
            albedo: Albedo::WHITE,
            normal: Dir::Z,
            distance: None,
            id: None,
            bounces: 0,
            so_far: 0,
            is_flat: true,
            is_found: false,
            is_drawn: false,
        }
    }
}

impl Default for First {
    fn default() -> First {
        First::new()
    }
}

impl Witness for First {
    fn surface(&mut self, scene: &Scene, hit: &Hit, vertex: &Vertex, throughput: Radiance) {
        if self.is_found {
            return;
        }
        self.bounces += u16::from(self.id.is_some());
        self.so_far = self.so_far.saturating_add(hit.t);
        if self.is_flat {
            self.distance = Some(self.so_far);
            self.is_flat = scene.is_flat(hit, vertex);
        }
        let own = if vertex.emission.is_black() {
            vertex.albedo()
        } else {
            Albedo::WHITE
        };
        self.albedo = shares(throughput).times(own);
        self.normal = vertex.facing();
        self.id = Some(vertex.id);
        self.is_found = is_end(vertex);
        self.is_drawn |= matches!(vertex.material, Material::Dielectric(_));
    }

    fn nothing(&mut self, ray: &Ray, throughput: Radiance) {
        if self.is_found {
            return;
        }
        self.bounces += u16::from(self.id.is_some());
        self.albedo = shares(throughput);
        self.normal = -ray.dir;
        if self.is_flat {
            self.distance = None;
        }
        self.id = None;
        self.is_found = true;
    }

    fn passed(&mut self, distance: i32) {
        self.so_far = self.so_far.saturating_add(distance);
    }
}

/// A throughput as shares, each 1 at most.
fn shares(throughput: Radiance) -> Albedo {
    // Most ways have been through nothing yet.
    if throughput == Radiance::WHITE {
        return Albedo::WHITE;
    }
    Albedo(
        throughput
            .to_q32()
            .map(|q| Share::from_bits((q >> 17).min(1 << 15) as u16)),
    )
}
