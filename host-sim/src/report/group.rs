//! Which integrators look for the same light, and what one of them cannot see.

use crate::desc::{BsdfDesc, IntegratorKind, LightDesc, SceneDesc};

/// The integrator whose picture this one has in the mean; that one is what the reference renders.
pub fn of(integrator: IntegratorKind) -> IntegratorKind {
    match integrator {
        IntegratorKind::Bdpt | IntegratorKind::Light => IntegratorKind::Path,
        other => other,
    }
}

/// What kind of light the integrators of a group look for.
pub fn title(group: IntegratorKind) -> &'static str {
    match group {
        IntegratorKind::Path | IntegratorKind::Bdpt | IntegratorKind::Light => "All of the light",
        IntegratorKind::Direct => "Direct light",
        IntegratorKind::Ao => "Ambient occlusion",
    }
}

/// What an integrator leaves out of the picture of this scene; its mean is not that of the reference then.
pub fn caveat(integrator: IntegratorKind, desc: &SceneDesc) -> Option<&'static str> {
    let light_tracer = integrator == IntegratorKind::Light;
    let specular = desc.shapes.iter().any(|shape| is_specular(desc, shape.material));
    let background = desc.lights.iter().any(is_background);
    match (light_tracer, specular, background) {
        (false, _, _) | (true, false, false) => None,
        (true, true, false) => Some("does not see what the camera sees by mirrors or glass alone"),
        (true, false, true) => Some("does not see the background"),
        (true, true, true) => {
            Some("sees neither the background nor what the camera sees by mirrors or glass alone")
        }
    }
}

fn is_specular(desc: &SceneDesc, material: usize) -> bool {
    let bsdf = desc.materials.get(material).map(|material| &material.bsdf);
    matches!(
        bsdf,
        Some(BsdfDesc::Conductor { .. } | BsdfDesc::Dielectric { .. })
    )
}

/// Whether the camera may see it without anything between.
fn is_background(light: &LightDesc) -> bool {
    !matches!(light, LightDesc::Point { .. } | LightDesc::Directional { .. })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;

    #[test]
    fn light_tracers_do_not_see_into_mirrors_nor_the_sky() {
        let of = |kind, name| caveat(kind, &builtin::scene(name).unwrap());
        assert!(
            of(IntegratorKind::Light, "spheres")
                .unwrap()
                .starts_with("sees neither")
        );
        assert!(
            of(IntegratorKind::Light, "furnace")
                .unwrap()
                .ends_with("the background")
        );
        assert_eq!(of(IntegratorKind::Light, "cornell"), None);
        assert_eq!(of(IntegratorKind::Bdpt, "spheres"), None);
    }

    #[test]
    fn all_that_see_everything_are_one_group() {
        use IntegratorKind::{Ao, Bdpt, Direct, Light, Path};
        assert_eq!(
            [Path, Bdpt, Light, Direct, Ao].map(of),
            [Path, Path, Path, Direct, Ao]
        );
    }
}
