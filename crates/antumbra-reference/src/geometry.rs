//! Scene representation of the tracer: flat lists of world-space triangles, sorted by their effect on light.

use antumbra_scene::Scene;
use glam::Vec3;

use crate::ReferenceError;
use crate::surface::{Surface, Surfaces};

/// A triangle in world space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// World positions, metres.
    pub(crate) corners: [Vec3; 3],
    /// Index into the scene's instances.
    pub(crate) instance: u32,
    /// Triangle index within the instance's mesh.
    pub(crate) index: u32,
    /// Effect on light.
    pub(crate) surface: Surface,
}

/// Triangles by their effect on light. Blocking and translucent ones have separate trees, because a blocked ray can stop
/// at the first hit, while a transmitted one must meet all translucent triangles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Geometry {
    /// Opaque and masked triangles, in the order of the scene.
    pub(crate) blockers: Vec<Triangle>,
    /// Translucent triangles, in the order of the scene.
    pub(crate) translucents: Vec<Triangle>,
    /// Data of surfaces that are not simply opaque.
    pub(crate) surfaces: Surfaces,
}

/// Largest number of triangles: far below the 31 bits of a block's index (see `tree.rs`).
const MAX_TRIANGLES: usize = 1 << 30;

impl Geometry {
    pub(crate) fn new(scene: &Scene) -> Result<Self, ReferenceError> {
        check(scene)?;
        let mut geometry = Self { surfaces: Surfaces::new(scene), ..Self::default() };
        for triangle in scene.world_triangles() {
            if !triangle.positions.iter().all(|p| p.is_finite()) {
                let instance = triangle.instance as usize;
                return Err(ReferenceError::NotFinite { scene: scene.name.clone(), instance });
            }
            // Triangles without area cast no shadow and would only cost time.
            let [a, b, c] = triangle.positions.map(Vec3::as_dvec3);
            if (b - a).cross(c - a).length_squared() == 0.0 {
                continue;
            }
            let mesh = scene.instances[triangle.instance as usize].mesh;
            let Some(surface) = geometry.surfaces.add(scene, mesh, triangle.triangle as usize) else { continue };
            let is_translucent = matches!(surface, Surface::Translucent(_));
            let list = if is_translucent { &mut geometry.translucents } else { &mut geometry.blockers };
            list.push(Triangle {
                corners: triangle.positions,
                instance: triangle.instance,
                index: triangle.triangle,
                surface,
            });
        }
        Ok(geometry)
    }
}

/// Checks that every index of a scene is in range.
fn check(scene: &Scene) -> Result<(), ReferenceError> {
    let within = |what: &'static str, index: usize, count: usize| {
        if index < count {
            Ok(())
        } else {
            Err(ReferenceError::OutOfRange { scene: scene.name.clone(), what, index, count })
        }
    };
    for instance in &scene.instances {
        within("mesh", instance.mesh, scene.meshes.len())?;
    }
    for mesh in &scene.meshes {
        within("material", mesh.material, scene.materials.len())?;
        let vertices = mesh.positions.len();
        for vertex in mesh.indices.iter().map(|i| *i as usize) {
            within("vertex", vertex, vertices)?;
        }
        if !mesh.uvs.is_empty() {
            within("texture coordinate", vertices.saturating_sub(1), mesh.uvs.len())?;
        }
        if !mesh.colors.is_empty() {
            within("vertex colour", vertices.saturating_sub(1), mesh.colors.len())?;
        }
    }
    for image in scene.materials.iter().flat_map(|material| material.images()) {
        within("image", image, scene.images.len())?;
        let image = &scene.images[image];
        within("texel", (image.width as usize * image.height as usize).saturating_sub(1), image.rgba8.len())?;
    }
    let count = scene.triangle_count();
    if count > MAX_TRIANGLES {
        return Err(ReferenceError::TooManyTriangles { scene: scene.name.clone(), count, most: MAX_TRIANGLES });
    }
    Ok(())
}
