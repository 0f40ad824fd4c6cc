//! glTF 2.0 files as scenes.
//!
//! Source: *glTF 2.0 Specification*, Khronos Group 2021, and the extensions that `document.rs` lists.
//!
//! ```text
//! container ─► document ─► buffers, views, accessors ─► primitives ─► morph, skin ─► placement ─► Scene
//!                 └─► animation ─► nodes ──────────────────────────────────┴─► cameras, lights
//! ```
//!
//! A file is untrusted. Every index and range is checked where it is used, allocations that can exceed the file's size
//! draw on a budget ([`limits`]), nothing recurses over the file's structure, and no file outside the scene's folder is
//! opened ([`uri`]). A contradiction of the specification is an error that gives its place. Bad numbers and missing
//! images are left out or repaired, with a line in [`Scene::warnings`].

mod accessors;
mod animation;
mod cameras;
mod container;
mod deform;
mod document;
mod extras;
mod fault;
mod geometry;
mod images;
mod instancing;
mod lights;
mod limits;
mod materials;
#[cfg_attr(not(feature = "meshopt"), path = "meshopt_absent.rs")]
mod meshopt_codec;
mod meshopt_decode;
mod meshopt_view;
mod nodes;
mod numbers;
mod placement;
mod primitives;
mod source;
mod uri;

#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use glam::Mat4;
use gltf::json::mesh::Semantic;

use crate::closed::is_closed;
use crate::{Material, Mesh, Scene, SceneError};
use animation::{Driven, Sampled};
use deform::Skeleton;
use fault::{Fault, Result};
use images::Images;
pub(crate) use limits::Limits;
use materials::{Surface, UvSource};
use nodes::Graph;
use placement::Placement;
use primitives::Wanted;
use source::Source;

/// Time at which a scene is loaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Pose {
    /// As modelled, without animation.
    #[cfg_attr(not(test), expect(dead_code, reason = "the tests compare with figures of the resting pose"))]
    Rest,
    /// Animations sampled at this time, seconds.
    At(f32),
}

/// Scene of a file, and its animations.
pub(crate) struct Loaded {
    /// Scene at the requested time; it may be empty.
    pub scene: Scene,
    /// `None` if nothing in the file is animated.
    pub animations: Option<Animations>,
}

/// Animations of a file, which stays in memory: give its scene at any time, without decoding its images again.
#[derive(Debug)]
pub struct Animations {
    bytes: Vec<u8>,
    /// Folder of the scene and the files beside it; `None` if the scene was loaded from memory.
    folder: Option<PathBuf>,
    name: String,
    /// Name of the file in messages.
    origin: String,
    limits: Limits,
    /// Known images, without texels.
    images: Images,
    ends_s: [f32; 2],
}

impl Animations {
    /// First and last time of all animations, seconds. Times outside clamp to these.
    pub fn ends_s(&self) -> [f32; 2] {
        self.ends_s
    }

    /// Scene at `time_s` seconds, as [`load`](crate::load()) returns it at that time, but with empty [`Scene::images`]: use
    /// the images of the scene with which these animations were loaded.
    ///
    /// # Errors
    /// One line, if the scene cannot be loaded at that time.
    pub fn scene_at(&self, time_s: f32) -> std::result::Result<Scene, SceneError> {
        let folder = self.folder.as_deref();
        let pose = Pose::At(time_s);
        let (scene, _) = load_slice(&self.bytes, folder, &self.name, pose, self.limits, self.images.clone())
            .map_err(|fault| fault.within(&self.origin))?;
        if scene.images.is_empty() {
            return Ok(scene);
        }
        // Only a node whose transform was not finite before can bring a new image.
        let problem = format!("shows an image at {time_s} s that was not loaded when the file was opened");
        Err(Fault::new("the file", problem, "open the file at that time").within(&self.origin))
    }
}

/// Loads a `.glb` or `.gltf` file.
pub(crate) fn load_file(path: &Path, pose: Pose, limits: Limits) -> std::result::Result<Loaded, SceneError> {
    let origin = path.display().to_string();
    let unreadable = |source| SceneError::Read { path: path.to_owned(), source };
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() {
        return Err(unreadable(std::io::Error::other("it is not a file")));
    }
    if metadata.len() > limits.file_bytes {
        let problem = format!("has {} bytes", metadata.len());
        let remedy = format!("at most {} bytes are supported", limits.file_bytes);
        return Err(Fault::new("the file", problem, remedy).within(&origin));
    }
    let bytes = std::fs::read(path).map_err(unreadable)?;
    let folder = path.parent().map(|p| if p.as_os_str().is_empty() { Path::new(".") } else { p });
    let name = path.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned());
    load_owned(bytes, folder.map(Path::to_owned), name, origin, pose, limits)
}

/// Loads a `.glb` or `.gltf` file from memory; references to files beside it are refused.
pub(crate) fn load_bytes(
    bytes: &[u8],
    name: &str,
    pose: Pose,
    limits: Limits,
) -> std::result::Result<Loaded, SceneError> {
    load_owned(bytes.to_vec(), None, name.to_owned(), name.to_owned(), pose, limits)
}

fn load_owned(
    bytes: Vec<u8>,
    folder: Option<PathBuf>,
    name: String,
    origin: String,
    pose: Pose,
    limits: Limits,
) -> std::result::Result<Loaded, SceneError> {
    let (scene, found) = load_slice(&bytes, folder.as_deref(), &name, pose, limits, Images::default())
        .map_err(|fault| fault.within(&origin))?;
    let Found { images, ends_s } = found;
    let animations = ends_s.map(|ends_s| Animations { bytes, folder, name, origin, limits, images, ends_s });
    Ok(Loaded { scene, animations })
}

/// Images and times found while loading a scene.
struct Found {
    /// Known images of the scene, without their texels.
    images: Images,
    ends_s: Option<[f32; 2]>,
}

/// Loads a scene. `images` are the images known already; only new ones are decoded into the scene.
fn load_slice(
    bytes: &[u8],
    folder: Option<&Path>,
    name: &str,
    pose: Pose,
    limits: Limits,
    images: Images,
) -> Result<(Scene, Found)> {
    let source = Source::new(container::split(bytes)?, folder, limits)?;
    let Sampled { driven, ends_s } = match pose {
        Pose::Rest => Sampled { driven: vec![Driven::default(); source.root.nodes.len()], ends_s: None },
        Pose::At(time_s) => animation::sample(&source, time_s)?,
    };
    let graph = Graph::new(&source, &driven)?;
    let mut loader = Loader {
        source: &source,
        driven: &driven,
        graph: &graph,
        images,
        surfaces: HashMap::new(),
        shared: HashMap::new(),
        skeletons: HashMap::new(),
        placement: Placement::new(Scene { name: name.to_owned(), ..Scene::default() }),
        lights: Vec::new(),
    };
    for &node in &graph.reached {
        if let Some(world_from_node) = graph.world_from_node[node] {
            loader.node(node, world_from_node)?;
        }
    }
    let Loader { mut images, placement, lights, .. } = loader;
    let mut scene = placement.finish();
    scene.images = images.take_loaded();
    let bounds = scene.bounds();
    scene.lights = lights::finish(lights, (!bounds.is_empty()).then(|| bounds.center()));
    scene.warnings = source.into_warnings();
    Ok((scene, Found { images, ends_s }))
}

/// Scene builder.
struct Loader<'s, 'a> {
    source: &'s Source<'a>,
    driven: &'s [Driven],
    graph: &'s Graph,
    images: Images,
    /// Scene material and texture coordinates by the document's material; `None` is the default material.
    surfaces: HashMap<Option<usize>, (usize, Option<UvSource>)>,
    /// Scene mesh by the document's mesh and primitive, for those that no node deforms.
    shared: HashMap<(usize, usize), Option<usize>>,
    /// Skeleton by the document's skin.
    skeletons: HashMap<usize, Rc<Skeleton>>,
    placement: Placement,
    lights: Vec<lights::Found>,
}

impl Loader<'_, '_> {
    fn node(&mut self, index: usize, world_from_node: Mat4) -> Result<()> {
        self.camera(index, world_from_node)?;
        // A camera is used even if its node is invisible.
        if !self.graph.is_visible[index] {
            return Ok(());
        }
        self.light(index, world_from_node)?;
        self.primitives(index, world_from_node)
    }

    /// Adds the node's camera, if it has one.
    fn camera(&mut self, index: usize, world_from_node: Mat4) -> Result<()> {
        let source = self.source;
        if let Some(camera) = source.root.nodes[index].camera
            && !source.is_full(self.placement.scene.cameras.len(), "cameras")
        {
            self.placement.scene.cameras.extend(cameras::read(source, camera.value(), world_from_node)?);
        }
        Ok(())
    }

    /// Adds the node's light, if it has one.
    fn light(&mut self, index: usize, world_from_node: Mat4) -> Result<()> {
        let source = self.source;
        let node = &source.root.nodes[index];
        if let Some(light) = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref())
            && !source.is_full(self.lights.len(), "lights")
        {
            let found = lights::read(source, light.light.value(), world_from_node, extras::of(&node.extras))?;
            self.lights.extend(found);
        }
        Ok(())
    }

    /// Places the primitives of the node's mesh, if it has one: once, or once per instance of the node.
    fn primitives(&mut self, index: usize, world_from_node: Mat4) -> Result<()> {
        let source = self.source;
        let node = &source.root.nodes[index];
        let Some(mesh) = node.mesh.map(|mesh| mesh.value()) else { return Ok(()) };
        let Some(json) = source.root.meshes.get(mesh) else {
            let place = format!("nodes[{index}].mesh");
            return Err(Fault::unresolved(place, "meshes", mesh, source.root.meshes.len()));
        };
        let skeleton = node.skin.map(|skin| self.skeleton(skin.value())).transpose()?;
        let weights = deform::morph_weights(
            self.driven[index].weights.as_deref(),
            node.weights.as_deref(),
            json.weights.as_deref(),
        );
        let label = Source::label(node.name.as_ref(), "nodes", index);
        let placed = instancing::transforms(source, node, index)?;

        for (k, primitive) in json.primitives.iter().enumerate() {
            let skinned = skeleton.as_deref().filter(|_| {
                primitives::attribute(primitive, Semantic::Joints(0)).is_some()
                    && primitives::attribute(primitive, Semantic::Weights(0)).is_some()
            });
            let morphed = !weights.is_empty() && primitive.targets.as_ref().is_some_and(|t| !t.is_empty());
            if let Some(skeleton) = skinned {
                // A skin places its vertices in the world; its node's transform has no effect.
                if let Some(mesh) = self.mesh((mesh, k), weights, Some(skeleton))? {
                    self.placement.place(source, mesh, Mat4::IDENTITY, &label)?;
                }
                continue;
            }
            let scene_mesh = if morphed {
                self.mesh((mesh, k), weights, None)?
            } else if let Some(known) = self.shared.get(&(mesh, k)) {
                *known
            } else {
                let made = self.mesh((mesh, k), &[], None)?;
                self.shared.insert((mesh, k), made);
                made
            };
            if let Some(scene_mesh) = scene_mesh {
                for object_from_node in &placed {
                    self.placement.place(source, scene_mesh, world_from_node * *object_from_node, &label)?;
                }
            }
        }
        Ok(())
    }

    fn skeleton(&mut self, skin: usize) -> Result<Rc<Skeleton>> {
        if let Some(known) = self.skeletons.get(&skin) {
            return Ok(Rc::clone(known));
        }
        let made = Rc::new(Skeleton::new(self.source, skin, self.graph)?);
        self.skeletons.insert(skin, Rc::clone(&made));
        Ok(made)
    }

    /// Reads a primitive, deforms it if asked, and adds it as a mesh; `None` if nothing of it can be drawn.
    fn mesh(
        &mut self,
        (mesh, primitive): (usize, usize),
        weights: &[f32],
        skeleton: Option<&Skeleton>,
    ) -> Result<Option<usize>> {
        let source = self.source;
        let json = &source.root.meshes[mesh];
        let place = format!("meshes[{mesh}].primitives[{primitive}]");
        let primitive_json = &json.primitives[primitive];
        let (material, uv) = self.surface(primitive_json.material.map(|m| m.value()), &place)?;
        let wanted = Wanted { uv, influences: skeleton.is_some(), targets: !weights.is_empty() };
        let geometry = match primitives::read(source, primitive_json, wanted, &place) {
            Err(fault) if fault.is_absent() => {
                source.warn(fault.as_warning(&format!("{place} is ignored")));
                None
            }
            read => read?,
        };
        let Some(mut geometry) = geometry else { return Ok(None) };
        // Tested before deformation: vertices that the file means to be one have exactly equal resting positions.
        let closed = is_closed(&geometry.positions, &geometry.indices);
        deform::morph(&mut geometry, weights);
        if let Some(skeleton) = skeleton {
            skeleton.skin(source, &mut geometry, &place);
        }
        let dropped = geometry.drop_unbounded();
        if dropped > 0 {
            source.warn(format!(
                "{place}: {dropped} triangles are deformed to positions that are not finite; they are ignored"
            ));
        }
        if geometry.indices.is_empty() {
            return Ok(None);
        }
        geometry.repair_normals();
        let name = match (&json.name, json.primitives.len()) {
            (Some(name), 1) => name.clone(),
            (Some(name), _) => format!("{name}.{primitive}"),
            (None, _) => format!("mesh {mesh}.{primitive}"),
        };
        Ok(Some(self.placement.add_mesh(Mesh {
            name,
            positions: geometry.positions,
            normals: geometry.normals,
            uvs: geometry.uvs,
            colors: geometry.colors,
            indices: geometry.indices,
            material,
            closed: closed && dropped == 0,
        })))
    }

    /// Scene material for a material of the document.
    fn surface(&mut self, material: Option<usize>, place: &str) -> Result<(usize, Option<UvSource>)> {
        if let Some(known) = self.surfaces.get(&material) {
            return Ok(*known);
        }
        let surface = match material {
            Some(index) if index >= self.source.root.materials.len() => {
                let place = format!("{place}.material");
                return Err(Fault::unresolved(place, "materials", index, self.source.root.materials.len()));
            }
            Some(index) => materials::read(self.source, index, &mut self.images)?,
            None => Surface { material: Material::default(), uv: None },
        };
        let materials = &mut self.placement.scene.materials;
        materials.push(surface.material);
        let known = (materials.len() - 1, surface.uv);
        self.surfaces.insert(material, known);
        Ok(known)
    }
}
