//! `shapegroup` and `instance`: meshes that stand in several places.

use std::sync::Arc;

use super::super::ImportError;
use super::super::math::Affine;
use super::super::mesh::placed;
use super::bsdf::Materials;
use super::params::{Context, Params};
use super::shape;
use super::tree::Element;
use crate::desc::{GeometryDesc, MeshDesc, ShapeDesc};

/// A mesh of a group.
struct Member {
    name: String,
    mesh: Arc<MeshDesc>,
    material: usize,
}

/// The groups that were read.
#[derive(Default)]
pub(super) struct Groups<'a>(Vec<(&'a Element, Vec<Member>)>);

impl<'a> Groups<'a> {
    /// The members of a group, read once.
    fn members(
        &mut self,
        group: &'a Element,
        context: &Context<'a>,
        materials: &mut Materials<'a>,
    ) -> Result<&[Member], ImportError> {
        let known = self
            .0
            .iter()
            .position(|(element, _)| std::ptr::eq(*element, group));
        let at = match known {
            Some(at) => at,
            None => {
                let members = read_group(group, context, materials)?;
                self.0.push((group, members));
                self.0.len() - 1
            }
        };
        Ok(&self.0[at].1)
    }

    /// Reads a group, for its errors.
    pub fn of(
        &mut self,
        group: &'a Element,
        context: &Context<'a>,
        materials: &mut Materials<'a>,
    ) -> Result<(), ImportError> {
        self.members(group, context, materials).map(|_| ())
    }
}

fn read_group<'a>(
    group: &'a Element,
    context: &Context<'a>,
    materials: &mut Materials<'a>,
) -> Result<Vec<Member>, ImportError> {
    let params = Params::new(context, group);
    let mut members = Vec::new();
    for element in params.objects("shape")? {
        for shape in shape::read_one(element, context, materials)? {
            let GeometryDesc::Mesh(mesh) = shape.geometry else {
                let message = format!(
                    "{} is no mesh; only meshes can stand in a shapegroup, place it by itself",
                    element.describe()
                );
                context.refuse(element, message)?;
                continue;
            };
            if shape.emission.is_some() {
                let message = "what stands in a shapegroup cannot emit light; place it by itself";
                context.refuse(element, message)?;
                continue;
            }
            members.push(Member {
                name: shape.name,
                mesh: Arc::new(mesh),
                material: shape.material,
            });
        }
    }
    params.finish()?;
    Ok(members)
}

/// All members of an instance's group, in its place. Where the transform is none of an instance of ours (it mirrors, shears
/// or scales unevenly) each is a mesh of its own.
pub(super) fn read<'a>(
    element: &'a Element,
    context: &Context<'a>,
    materials: &mut Materials<'a>,
    groups: &mut Groups<'a>,
) -> Result<Vec<ShapeDesc>, ImportError> {
    let params = Params::new(context, element);
    let to_world = params.transform("to_world")?.unwrap_or(Affine::IDENTITY);
    let Some(group) = params.object("shape")? else {
        let message = format!(
            "{} names no shapegroup; add <ref id=\"...\"/> to one",
            element.describe()
        );
        return Err(element.error(message));
    };
    if group.kind() != "shapegroup" {
        let message = format!(
            "{} is no shapegroup; only groups have instances",
            group.describe()
        );
        return Err(element.error(message));
    }
    params.finish()?;
    let name = element.name();
    let place = |member: &Member| ShapeDesc {
        name: format!("{name} of {}", member.name),
        geometry: placed(&member.mesh, &to_world),
        material: member.material,
        emission: None,
    };
    let members = groups.members(group, context, materials)?;
    Ok(members.iter().map(place).collect())
}
