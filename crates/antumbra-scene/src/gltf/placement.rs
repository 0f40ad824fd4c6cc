//! Placement of meshes in the world. Afterwards every instance is finite, invertible and not mirrored, and every mesh is
//! counter-clockwise seen from the front.

use std::collections::HashMap;

use antumbra_light::Aabb;
use glam::{DVec3, Mat4, Vec3};

use super::fault::Result;
use super::geometry::Geometry;
use super::numbers::LARGEST_COORDINATE_M;
use super::source::Source;
use crate::closed::is_closed;
use crate::{Instance, Material, Mesh, Scene, Volume};

/// Mirror along x, applied to both the mesh and the transform of a mirrored instance. The two cancel, so that the winding
/// has the same meaning in every mesh and instance.
const MIRROR: Vec3 = Vec3::new(-1.0, 1.0, 1.0);

/// Effect of a transform on a mesh.
#[derive(Debug, PartialEq)]
enum Kind {
    /// Invertible, keeps the winding.
    Regular,
    /// Invertible, reverses the winding.
    Mirror,
    /// Flattens to a sheet, or scales so much that an f32 cannot hold the inverse.
    Flat,
    /// Collapses to a line or a point.
    Vanishing,
}

/// The scene while meshes are being placed.
pub(super) struct Placement {
    pub scene: Scene,
    bounds: Vec<Aabb>,
    mirrored: HashMap<usize, usize>,
    /// Copies of meshes with a volume, by original mesh and scale.
    scaled: HashMap<(usize, i32), usize>,
}

impl Placement {
    pub(super) fn new(scene: Scene) -> Self {
        Self { scene, bounds: Vec::new(), mirrored: HashMap::new(), scaled: HashMap::new() }
    }

    /// Adds a mesh and returns its index.
    pub(super) fn add_mesh(&mut self, mesh: Mesh) -> usize {
        self.bounds.push(Aabb::of(mesh.positions.iter().copied()));
        self.scene.meshes.push(mesh);
        self.scene.meshes.len() - 1
    }

    /// Places a mesh. A mesh that would be invisible or exceed an f32 is left out with a warning.
    pub(super) fn place(&mut self, source: &Source, mesh: usize, world_from_object: Mat4, label: &str) -> Result<()> {
        let corners = self.bounds[mesh].corners().map(|p| world_from_object.transform_point3(p));
        // NaN fails the comparison.
        if !corners.iter().flat_map(|p| p.to_array()).all(|v| v.abs() <= LARGEST_COORDINATE_M) {
            source.warn(format!("{label}: its transform moves it beyond {LARGEST_COORDINATE_M:e} m; it is ignored"));
            return Ok(());
        }
        source.budget.take_instances(1, label)?;
        let mesh = self.with_thickness(source, mesh, world_from_object, label)?;
        let instance = match kind(world_from_object) {
            Kind::Regular => Instance { mesh, world_from_object },
            Kind::Mirror => Instance {
                mesh: self.mirror_of(source, mesh, label)?,
                world_from_object: world_from_object * Mat4::from_scale(MIRROR),
            },
            Kind::Flat => match self.baked(source, mesh, world_from_object, label)? {
                Some(mesh) => Instance { mesh, world_from_object: Mat4::IDENTITY },
                None => return Ok(()),
            },
            Kind::Vanishing => {
                source.warn(format!("{label}: its scale reduces it to a line or a point; it is ignored"));
                return Ok(());
            }
        };
        self.scene.instances.push(instance);
        Ok(())
    }

    /// Copy of a mesh whose volume has the thickness that the transform gives it: KHR_materials_volume measures thickness in
    /// mesh space, and attenuation distance in world space.
    fn with_thickness(&mut self, source: &Source, mesh: usize, world_from_object: Mat4, label: &str) -> Result<usize> {
        /// Number of steps per unit of the scale's logarithm: finer than the precision of a thickness of two digits, coarser than
        /// the effect of a rotation on a matrix's determinant.
        const STEPS: f32 = 1e3;
        let material = self.scene.meshes[mesh].material;
        let Some(volume) = &self.scene.materials[material].volume else { return Ok(mesh) };
        let scale = world_from_object.determinant().abs().cbrt();
        let step = (STEPS * scale.ln()).round() as i32;
        if step == 0 || !scale.is_normal() {
            return Ok(mesh);
        }
        if let Some(&known) = self.scaled.get(&(mesh, step)) {
            return Ok(known);
        }
        let volume = Volume { thickness_m: scale * volume.thickness_m, ..volume.clone() };
        let copy = self.scene.meshes[mesh].clone();
        source.budget.take_vertices(copy.positions.len(), label)?;
        source.budget.take_indices(copy.indices.len(), label)?;
        let materials = &mut self.scene.materials;
        materials.push(Material { volume: Some(volume), ..materials[material].clone() });
        let material = materials.len() - 1;
        let index = self.add_mesh(Mesh { material, ..copy });
        self.scaled.insert((mesh, step), index);
        Ok(index)
    }

    /// Copy of a mesh, mirrored along x and wound counter-clockwise seen from the front again.
    fn mirror_of(&mut self, source: &Source, mesh: usize, label: &str) -> Result<usize> {
        if let Some(&known) = self.mirrored.get(&mesh) {
            return Ok(known);
        }
        let original = &self.scene.meshes[mesh];
        source.budget.take_vertices(original.positions.len(), label)?;
        source.budget.take_indices(original.indices.len(), label)?;
        let mut copy = original.clone();
        copy.positions.iter_mut().for_each(|p| *p *= MIRROR);
        copy.normals.iter_mut().for_each(|n| *n *= MIRROR);
        copy.indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
        let index = self.add_mesh(copy);
        self.mirrored.insert(mesh, index);
        Ok(index)
    }

    /// Copy of a mesh in world space; `None`, with a warning, if it has no area.
    fn baked(&mut self, source: &Source, mesh: usize, world_from_object: Mat4, label: &str) -> Result<Option<usize>> {
        let original = &self.scene.meshes[mesh];
        source.budget.take_vertices(original.positions.len(), label)?;
        source.budget.take_indices(original.indices.len(), label)?;
        let mut geometry = Geometry {
            positions: original.positions.clone(),
            normals: original.normals.clone(),
            indices: original.indices.clone(),
            ..Geometry::default()
        };
        geometry.transform(world_from_object);
        if !geometry.has_area() {
            source.warn(format!("{label}: its scale reduces its area to zero; it is ignored"));
            return Ok(None);
        }
        geometry.repair_normals();
        let closed = is_closed(&geometry.positions, &geometry.indices);
        let copy = Mesh { positions: geometry.positions, normals: geometry.normals, closed, ..original.clone() };
        Ok(Some(self.add_mesh(copy)))
    }

    /// Returns the scene without meshes that no instance uses.
    pub(super) fn finish(self) -> Scene {
        let mut scene = self.scene;
        let mut new_of_old: Vec<Option<usize>> = vec![None; scene.meshes.len()];
        scene.instances.iter().for_each(|i| new_of_old[i.mesh] = Some(0));
        new_of_old.iter_mut().flatten().enumerate().for_each(|(new, slot)| *slot = new);
        let mut old = 0;
        scene.meshes.retain(|_| {
            old += 1;
            new_of_old[old - 1].is_some()
        });
        scene.instances.iter_mut().for_each(|i| i.mesh = new_of_old[i.mesh].unwrap_or_default());
        scene
    }
}

/// Classifies a transform relative to the lengths of its columns, in double precision: a scale of a micrometre is not singular.
fn kind(matrix: Mat4) -> Kind {
    /// Largest relative thickness of a sheet that counts as flat: an f32 has seven digits.
    const FLATNESS: f64 = 1e-6;
    /// Range of determinants that are, like their reciprocals, ordinary f32 numbers.
    const ORDINARY: std::ops::RangeInclusive<f64> = 1e-36..=1e36;
    let [a, b, c] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.truncate().as_dvec3());
    let determinant = a.cross(b).dot(c);
    let volume = a.length() * b.length() * c.length();
    if determinant.abs() > FLATNESS * volume && ORDINARY.contains(&determinant.abs()) {
        return if determinant < 0.0 { Kind::Mirror } else { Kind::Regular };
    }
    let spans = |a: DVec3, b: DVec3| {
        let (area, sides) = (a.cross(b).length(), a.length() * b.length());
        sides > 0.0 && area > FLATNESS * sides
    };
    if spans(a, b) || spans(b, c) || spans(c, a) { Kind::Flat } else { Kind::Vanishing }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    #[test]
    fn transforms_are_told_apart_at_every_scale() {
        let turn = Quat::from_rotation_x(1.0);
        for scale in [1e-9, 1e-6, 1.0, 1e6, 1e9] {
            let of = |s: Vec3| kind(Mat4::from_scale_rotation_translation(s * scale, turn, Vec3::ONE));
            assert_eq!(of(Vec3::ONE), Kind::Regular);
            assert_eq!(of(Vec3::new(-1.0, 1.0, 1.0)), Kind::Mirror);
            assert_eq!(of(Vec3::new(1.0, 0.0, 1.0)), Kind::Flat);
            assert_eq!(of(Vec3::new(1.0, 0.0, 0.0)), Kind::Vanishing);
            assert_eq!(of(Vec3::ZERO), Kind::Vanishing);
        }
    }
}
