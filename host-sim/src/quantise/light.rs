//! Lights that are no shapes, and what surrounds the scene.

use microlux::light::{Light, Sky};
use microlux::num::Turn;

use super::rounding::{Rounding, dir, radiance};
use crate::desc::{LightDesc, SceneDesc};
use crate::envmap::BakedMap;

/// What surrounds the scene and is no constant.
#[derive(Debug)]
pub(super) enum Background {
    None,
    Sky(Sky),
    Map(BakedMap),
}

/// Puts them behind `lights`; a constant environment is the last.
pub(super) fn lights(round: &Rounding, desc: &SceneDesc, lights: &mut Vec<Light>) -> Background {
    let mut environment = None;
    let mut background = Background::None;
    for light in &desc.lights {
        match light {
            LightDesc::Point { position, intensity } => {
                lights.push(Light::Point {
                    position: round.point(*position),
                    intensity: radiance(*intensity),
                });
            }
            LightDesc::Directional {
                direction,
                irradiance,
            } => {
                lights.push(Light::Directional {
                    direction: dir(*direction),
                    irradiance: radiance(*irradiance),
                });
            }
            LightDesc::Constant { radiance: r } => {
                environment = Some(Light::Environment {
                    radiance: radiance(*r),
                });
            }
            LightDesc::Gradient {
                zenith,
                horizon,
                ground,
                up,
                sun,
            } => {
                let sky = Sky::new(dir(*up), radiance(*zenith), radiance(*horizon), radiance(*ground));
                background = Background::Sky(match sun {
                    Some(sun) => sky.with_sun(
                        dir(sun.direction),
                        Turn::saturating_from_num(sun.angle / 360.0),
                        radiance(sun.radiance),
                    ),
                    None => sky,
                });
            }
            LightDesc::EnvMap {
                width,
                height,
                pixels,
                to_world,
            } => {
                let axes = to_world.map(dir);
                let map = BakedMap::new(*width as usize, *height as usize, pixels, axes);
                background = Background::Map(map);
            }
        }
    }
    lights.extend(environment);
    background
}
