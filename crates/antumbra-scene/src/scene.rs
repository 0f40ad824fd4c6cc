//! Scene data: meshes, materials, instances. Plain data on the CPU.

use glam::{Mat4, Vec2, Vec3, Vec4};

use crate::Camera;
use antumbra_light::{Aabb, Light};

/// Scene. All its triangles are both casters and receivers.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// A name for reports: the file's stem or the built-in's name.
    pub name: String,
    /// Geometry in object space, one material each.
    pub meshes: Vec<Mesh>,
    /// Materials, indexed by [`Mesh::material`].
    pub materials: Vec<Material>,
    /// Images, indexed by [`Material`].
    pub images: Vec<Image>,
    /// Meshes placed in the world. A mesh without an instance is not in the scene.
    pub instances: Vec<Instance>,
    /// Cameras of the asset, the preferred one first.
    pub cameras: Vec<Camera>,
    /// Lights of the asset.
    pub lights: Vec<Light>,
    /// Index into `instances` of the ground that [`Scene::add_ground`] added; `None` without one.
    pub ground: Option<usize>,
    /// Loader warnings for the user, one line for each thing that was left out or repaired.
    pub warnings: Vec<String>,
}

/// Indexed triangles of one material.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// A name for messages.
    pub name: String,
    /// Object-space positions, metres, all finite.
    pub positions: Vec<Vec3>,
    /// Unit shading normals, as many as positions.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, as many as positions, or none; texture transforms are already applied.
    pub uvs: Vec<Vec2>,
    /// Linear vertex colours that multiply the base colour, as many as positions, or none.
    pub colors: Vec<Vec4>,
    /// Vertex indices, three per triangle, counter-clockwise seen from the front, each below `positions.len()`.
    pub indices: Vec<u32>,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// Whether every edge is shared by exactly two triangles that wind consistently: the mesh bounds a solid.
    pub closed: bool,
}

/// A mesh placed in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// Object-to-world transform, affine and finite.
    pub world_from_object: Mat4,
}

/// Interpretation of a surface's alpha.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Alpha-tested: the surface exists where alpha ≥ cutoff.
    Mask {
        /// The asset's `alphaCutoff`.
        cutoff: f32,
    },
    /// Alpha is opacity.
    Blend,
}

/// Metallic-roughness material, reduced to what shadows and their shading need.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// A name for messages.
    pub name: String,
    /// Base colour, linear RGB and alpha; multiplies the image and the vertex colour.
    pub base_color: Vec4,
    /// Base colour image, an index into [`Scene::images`]; RGB is sRGB-encoded, alpha linear.
    pub base_color_image: Option<usize>,
    /// Interpretation of alpha.
    pub alpha: AlphaMode,
    /// Fraction of light that the surface transmits, tinted by the base colour (KHR_materials_transmission); usually 0.
    /// Metals transmit none of it.
    pub transmission: f32,
    /// Transmission image, an index into [`Scene::images`]; its red, as stored, multiplies `transmission`. All images of
    /// a material have the base colour image's texture coordinates and address modes.
    pub transmission_image: Option<usize>,
    /// Metalness: 0 dielectric, 1 metal.
    pub metallic: f32,
    /// Perceptual roughness.
    pub roughness: f32,
    /// Metallic-roughness image, an index into [`Scene::images`]; green, as stored, multiplies `roughness`, blue `metallic`.
    /// `None` unless transmission depends on it; the factors then include the image's means.
    pub metallic_roughness_image: Option<usize>,
    /// Volume beneath a transmitting surface; `None` if the surface is thin.
    pub volume: Option<Volume>,
    /// Linear RGB emission.
    pub emissive: Vec3,
    /// Whether both sides are shaded. Both sides cast shadows in any case.
    pub double_sided: bool,
}

impl Material {
    /// Indices into [`Scene::images`] of the material's images.
    pub fn images(&self) -> impl Iterator<Item = usize> {
        let thickness = self.volume.as_ref().and_then(|volume| volume.thickness_image);
        [self.base_color_image, self.transmission_image, self.metallic_roughness_image, thickness].into_iter().flatten()
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: "default".into(),
            base_color: Vec4::ONE,
            base_color_image: None,
            alpha: AlphaMode::Opaque,
            transmission: 0.0,
            transmission_image: None,
            metallic: 0.0,
            roughness: 0.8,
            metallic_roughness_image: None,
            volume: None,
            emissive: Vec3::ZERO,
            double_sided: false,
        }
    }
}

/// Absorbing volume beneath a surface (KHR_materials_volume).
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// Path length through the volume, world-space metres. Each of the two crossings of a closed mesh counts half of it.
    pub thickness_m: f32,
    /// Thickness image, an index into [`Scene::images`]; its green, as stored, multiplies `thickness_m`.
    pub thickness_image: Option<usize>,
    /// Linear RGB that white light becomes over `attenuation_distance_m`.
    pub attenuation_color: Vec3,
    /// Distance over which light becomes `attenuation_color`, world-space metres.
    pub attenuation_distance_m: f32,
}

impl Volume {
    /// Transmittance of one crossing of the surface, per colour channel (Beer–Lambert). `thickness` is the green of the
    /// thickness image.
    pub fn attenuation(&self, thickness: f32, is_closed: bool) -> Vec3 {
        let crossings = if is_closed { 2.0 } else { 1.0 };
        self.attenuation_color.powf(thickness * self.thickness_m / (crossings * self.attenuation_distance_m))
    }
}

/// Address mode: how an image continues outside [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Tiled.
    #[default]
    Repeat,
    /// Tiled, every other tile mirrored.
    Mirror,
    /// The edge texel is repeated.
    Clamp,
}

/// Image of 8-bit RGBA texels.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// Width, texels.
    pub width: u32,
    /// Height, texels.
    pub height: u32,
    /// `width · height` texels, top row first. Colours are sRGB-encoded RGB with linear alpha; other quantities are as
    /// stored.
    pub rgba8: Vec<[u8; 4]>,
    /// Address modes along u and v.
    pub wrap: [Wrap; 2],
}

impl Image {
    /// Returns bilinearly filtered linear RGBA at `uv` (v runs down, as in glTF). Texel (i, j) has its centre at
    /// ((i + ½)/w, (j + ½)/h). Colours are decoded before they are filtered, as a GPU does with an sRGB format.
    pub fn sample(&self, uv: Vec2) -> Vec4 {
        self.sample_as(uv, |[r, g, b, a]| {
            Vec4::new(linear_from_srgb(r), linear_from_srgb(g), linear_from_srgb(b), fraction(a))
        })
    }

    /// [`Self::sample`] for quantities other than colour: filters the stored fractions without sRGB decoding.
    pub fn sample_stored(&self, uv: Vec2) -> Vec4 {
        self.sample_as(uv, |texel| Vec4::from_array(texel.map(fraction)))
    }

    #[inline]
    fn sample_as(&self, uv: Vec2, value: impl Fn([u8; 4]) -> Vec4) -> Vec4 {
        let pos = uv * Vec2::new(self.width as f32, self.height as f32) - 0.5;
        let base = pos.floor();
        let t = pos - base;
        let texel = |dx: i64, dy: i64| {
            let x = wrapped(base.x as i64 + dx, self.width, self.wrap[0]);
            let y = wrapped(base.y as i64 + dy, self.height, self.wrap[1]);
            value(self.rgba8[y * self.width as usize + x])
        };
        let top = texel(0, 0).lerp(texel(1, 0), t.x);
        let bottom = texel(0, 1).lerp(texel(1, 1), t.x);
        top.lerp(bottom, t.y)
    }

    /// Alpha of [`Self::sample`].
    pub fn sample_alpha(&self, uv: Vec2) -> f32 {
        let pos = uv * Vec2::new(self.width as f32, self.height as f32) - 0.5;
        let base = pos.floor();
        let t = pos - base;
        let texel = |dx: i64, dy: i64| {
            let x = wrapped(base.x as i64 + dx, self.width, self.wrap[0]);
            let y = wrapped(base.y as i64 + dy, self.height, self.wrap[1]);
            f32::from(self.rgba8[y * self.width as usize + x][3])
        };
        let top = texel(0, 0) + (texel(1, 0) - texel(0, 0)) * t.x;
        let bottom = texel(0, 1) + (texel(1, 1) - texel(0, 1)) * t.x;
        (top + (bottom - top) * t.y) / 255.0
    }
}

fn fraction(byte: u8) -> f32 {
    f32::from(byte) / 255.0
}

fn wrapped(i: i64, n: u32, wrap: Wrap) -> usize {
    let n = i64::from(n);
    let i = match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Mirror => {
            let m = i.rem_euclid(2 * n);
            if m < n { m } else { 2 * n - 1 - m }
        }
        Wrap::Clamp => i.clamp(0, n - 1),
    };
    i as usize
}

/// Decodes an 8-bit sRGB value (IEC 61966-2-1).
pub fn linear_from_srgb(byte: u8) -> f32 {
    static TABLE: std::sync::LazyLock<[f32; 256]> = std::sync::LazyLock::new(|| {
        std::array::from_fn(|i| {
            let v = i as f32 / 255.0;
            if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        })
    });
    TABLE[byte as usize]
}

/// Encodes a linear value as sRGB in `[0, 1]` (IEC 61966-2-1).
pub fn srgb_from_linear(v: f32) -> f32 {
    let v = v.clamp(0.0, 1.0);
    if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// World-space triangle, with the instance and triangle index that it comes from.
#[derive(Clone, Copy, Debug)]
pub struct WorldTriangle {
    /// World positions, counter-clockwise seen from the front.
    pub positions: [Vec3; 3],
    /// Index into [`Scene::instances`].
    pub instance: u32,
    /// Triangle index within the instance's mesh.
    pub triangle: u32,
}

impl Scene {
    /// Number of triangles of all instances.
    pub fn triangle_count(&self) -> usize {
        self.instances.iter().map(|i| self.meshes[i.mesh].indices.len() / 3).sum()
    }

    /// Every triangle in world space, instance by instance.
    pub fn world_triangles(&self) -> impl Iterator<Item = WorldTriangle> + '_ {
        self.instances.iter().zip(0u32..).flat_map(move |(instance, instance_index)| {
            let mesh = &self.meshes[instance.mesh];
            let to_world = instance.world_from_object;
            mesh.indices.chunks_exact(3).zip(0u32..).map(move |(t, triangle)| WorldTriangle {
                positions: [0, 1, 2].map(|k| to_world.transform_point3(mesh.positions[t[k] as usize])),
                instance: instance_index,
                triangle,
            })
        })
    }

    /// World-space bounding box of all instances.
    pub fn bounds(&self) -> Aabb {
        self.bounds_of(&self.instances)
    }

    /// World-space bounding box of the given instances.
    pub fn bounds_of(&self, instances: &[Instance]) -> Aabb {
        instances.iter().fold(Aabb::EMPTY, |bounds, instance| {
            let mesh = &self.meshes[instance.mesh];
            let points = mesh.positions.iter().map(|p| instance.world_from_object.transform_point3(*p));
            bounds.union(Aabb::of(points))
        })
    }

    /// The linear base colour (factor, texture, vertex colour) at barycentric coordinates `(1 − u − v, u, v)` of a
    /// triangle of a mesh.
    pub fn base_color_at(&self, mesh: &Mesh, triangle: u32, barycentric: Vec2) -> Vec4 {
        let material = &self.materials[mesh.material];
        let corner = |k: usize| mesh.indices[3 * triangle as usize + k] as usize;
        let weights = [1.0 - barycentric.x - barycentric.y, barycentric.x, barycentric.y];
        let mut color = material.base_color;
        if let (Some(image), false) = (material.base_color_image, mesh.uvs.is_empty()) {
            let uv = (0..3).map(|k| weights[k] * mesh.uvs[corner(k)]).sum();
            color *= self.images[image].sample(uv);
        }
        if !mesh.colors.is_empty() {
            color *= (0..3).map(|k| weights[k] * mesh.colors[corner(k)]).sum::<Vec4>();
        }
        color
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bilinear_hits_texel_centres_and_wraps() {
        let image = Image {
            width: 2,
            height: 1,
            rgba8: vec![[0, 0, 0, 0], [255, 255, 255, 255]],
            wrap: [Wrap::Repeat, Wrap::Clamp],
        };
        assert_eq!(image.sample(Vec2::new(0.25, 0.5)).w, 0.0);
        assert_eq!(image.sample(Vec2::new(0.75, 0.1)).w, 1.0);
        assert_eq!(image.sample_alpha(Vec2::new(0.5, 0.9)), 0.5);
        assert_eq!(image.sample_alpha(Vec2::new(1.0, 0.5)), 0.5);
        assert_eq!([-1, 0, 1, 2, 3, 4].map(|i| wrapped(i, 2, Wrap::Mirror)), [0, 0, 1, 1, 0, 0]);
    }
}
