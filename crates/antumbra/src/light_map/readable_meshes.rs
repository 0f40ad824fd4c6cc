//! Check that compute shaders can read the casters' triangles.

use crate::contract::{Error, MeshCaster, PreparedFrame};

/// Returns the casters' meshes if compute shaders can read them, else an error with the remedy; `or` names an alternative.
pub(crate) fn readable_meshes<'a>(
    technique: &'static str,
    frame: &PreparedFrame<'a>,
    or: Option<&'static str>,
) -> Result<&'a [MeshCaster<'a>], Error> {
    let or = or.map_or(String::new(), |or| format!(", or {or}"));
    let meshes = frame.casters.meshes(technique, &format!("each triangle is tested{or}"))?;
    for mesh in meshes {
        let mut buffers = vec![("positions", mesh.positions), ("indices", mesh.indices), ("instances", mesh.instances)];
        if let Some(texture) = mesh.opacity.texture() {
            buffers.push(("uvs", texture.uvs));
        }
        if let Some((what, _)) = buffers.into_iter().find(|(_, b)| !b.usage().contains(wgpu::BufferUsages::STORAGE)) {
            return Err(Error::BadFrame {
                technique,
                what: "a caster's buffer",
                had: format!("`{what}`, created without the usage STORAGE"),
                needed: format!(
                    "readable in compute shaders: add BufferUsages::STORAGE to positions, indices, instances and uvs{or}"
                ),
            });
        }
    }
    Ok(meshes)
}
