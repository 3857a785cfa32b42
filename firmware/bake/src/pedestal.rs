//! What the mesh stands in: a floor, a lamp, a dim sky. A board without room for what opens whole scenes has this file, too.

use microlux::{
    camera::Camera,
    color::{Radiance, albedo},
    geom::{Dir, point},
    light::Light,
    material::Material,
    num::{Share, Turn},
    q,
    scene::{SceneBuilder, SceneError},
    shape::{Geometry, Rectangle},
};

/// Room for it: shapes, materials, lights.
pub type Builder = SceneBuilder<3, 3, 2>;

/// Mesh 0 among the rest, and who looks at it.
pub fn pedestal() -> Result<(Builder, Camera), SceneError> {
    let mut b = SceneBuilder::new();
    let unit = b.unit();
    let gray = albedo(q!(0.5, Share), q!(0.5, Share), q!(0.5, Share));
    let floor = b.material(Material::lambert(gray))?;
    let clay = albedo(q!(0.66, Share), q!(0.40, Share), q!(0.24, Share));
    let clay = b.material(Material::lambert(clay))?;
    let black = b.material(Material::Black)?;
    let ground = Rectangle {
        center: point(q!(0), q!(0), q!(0)),
        u: Dir::Z,
        v: Dir::X,
        normal: Dir::Y,
        half: [unit.length(q!(4)); 2],
    };
    let lamp = Rectangle {
        center: point(q!(0.4), q!(3.2), q!(1.2)),
        u: Dir::X,
        v: Dir::Z,
        normal: -Dir::Y,
        half: [unit.length(q!(0.5)); 2],
    };
    b.shape(ground, floor)?;
    b.shape(Geometry::Mesh(0), clay)?;
    b.emitter(lamp, black, Radiance::new(q!(17), q!(15.5), q!(13)))?;
    b.light(Light::Environment {
        radiance: Radiance::new(q!(0.1), q!(0.12), q!(0.15)),
    })?;
    let camera = Camera::from_frame(
        point(q!(0), q!(0.95), q!(4.4)),
        [Dir::X, Dir::Y, -Dir::Z],
        Camera::tan_half(q!(0.09, Turn)),
    );
    Ok((b, camera))
}
