//! What a scene is, once loaded: meshes, materials, instances. Plain data on the CPU.

use glam::{Mat4, Vec2, Vec3, Vec4};

use crate::Camera;
use antumbra_light::{Aabb, Light};

/// A scene: casters and receivers are all its triangles.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// A name for reports: the file's stem or the built-in's name.
    pub name: String,
    /// Geometry in object space, one material each.
    pub meshes: Vec<Mesh>,
    /// Surfaces, by index from [`Mesh::material`].
    pub materials: Vec<Material>,
    /// Pictures, by index from [`Material::base_color_image`].
    pub images: Vec<Image>,
    /// Meshes placed in the world. A mesh without an instance is not in the scene.
    pub instances: Vec<Instance>,
    /// Cameras that the asset brings, the preferred first.
    pub cameras: Vec<Camera>,
    /// Lights that the asset brings.
    pub lights: Vec<Light>,
    /// What the loader had to leave out or repair, one line each, for the user to read.
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
    /// Three a triangle, counter-clockwise seen from the front, each below `positions.len()`.
    pub indices: Vec<u32>,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// Every edge is shared by exactly two triangles that wind consistently: the mesh bounds a solid.
    pub closed: bool,
}

/// A mesh placed in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// Affine and finite.
    pub world_from_object: Mat4,
}

/// How a surface's alpha is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Present where alpha ≥ cutoff.
    Mask {
        /// The asset's `alphaCutoff`.
        cutoff: f32,
    },
    /// Alpha is opacity.
    Blend,
}

/// A surface: metallic-roughness, reduced to what shadows and their shading need.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// A name for messages.
    pub name: String,
    /// Linear RGB and alpha; multiplies the image and the vertex colour.
    pub base_color: Vec4,
    /// Index into [`Scene::images`]; its RGB is sRGB-encoded, its alpha linear.
    pub base_color_image: Option<usize>,
    /// How alpha is meant.
    pub alpha: AlphaMode,
    /// Fraction of light that the surface transmits, tinted by the base colour (KHR_materials_transmission); 0 for
    /// most.
    pub transmission: f32,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
    /// Perceptual roughness.
    pub roughness: f32,
    /// Linear RGB emission.
    pub emissive: Vec3,
    /// Shade both sides. Shadows are cast by both sides in any case.
    pub double_sided: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: "default".into(),
            base_color: Vec4::ONE,
            base_color_image: None,
            alpha: AlphaMode::Opaque,
            transmission: 0.0,
            metallic: 0.0,
            roughness: 0.8,
            emissive: Vec3::ZERO,
            double_sided: false,
        }
    }
}

/// How an image is continued outside [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Tiled.
    #[default]
    Repeat,
    /// Tiled, every other tile mirrored.
    Mirror,
    /// The edge texel goes on.
    Clamp,
}

/// A picture of 8-bit texels.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` texels: sRGB-encoded RGB, linear alpha; the first row is the top.
    pub rgba8: Vec<[u8; 4]>,
    /// Continuation along u and v.
    pub wrap: [Wrap; 2],
}

/// What a surface does to light that meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Occluder {
    /// Blocks all.
    Opaque,
    /// Blocks all where the filtered alpha reaches the cutoff, nothing elsewhere.
    Masked {
        /// The asset's `alphaCutoff`.
        cutoff: f32,
    },
    /// Lets pass `1 − opacity · (1 − tint)` per channel, both sampled from the surface.
    Tinted,
}

impl Material {
    /// What the surface does to light. A mask that no texture, factor or vertex colour can bring below its cutoff is
    /// still reported as masked: the mesh decides.
    pub fn occluder(&self) -> Occluder {
        match self.alpha {
            AlphaMode::Mask { cutoff } => Occluder::Masked { cutoff },
            AlphaMode::Blend => Occluder::Tinted,
            AlphaMode::Opaque if self.transmission > 0.0 => Occluder::Tinted,
            AlphaMode::Opaque => Occluder::Opaque,
        }
    }

    /// The light that passes a tinted surface whose linear base colour (factor, texture and vertex colour multiplied)
    /// is `base_color`: `1 − opacity · (1 − tint)` (`docs/formats.md`, Visibility).
    ///
    /// Blended surfaces have opacity = alpha and tint = base colour; transmitting ones opacity 1 (or alpha, where they
    /// blend too) and tint = transmission · base colour.
    pub fn transmittance(&self, base_color: Vec4) -> Vec3 {
        let (opacity, tint) = match self.alpha {
            AlphaMode::Blend if self.transmission > 0.0 => (base_color.w, base_color.truncate() * self.transmission),
            AlphaMode::Blend => (base_color.w, base_color.truncate()),
            _ => (1.0, base_color.truncate() * self.transmission),
        };
        Vec3::ONE - opacity.clamp(0.0, 1.0) * (Vec3::ONE - tint.clamp(Vec3::ZERO, Vec3::ONE))
    }
}

impl Image {
    /// Bilinear, linear RGBA at `uv` (v runs down, as glTF); texel (i, j) has its centre at ((i + ½)/w, (j + ½)/h).
    /// Colours are decoded before they are blended, as a GPU does with an sRGB format.
    pub fn sample(&self, uv: Vec2) -> Vec4 {
        let pos = uv * Vec2::new(self.width as f32, self.height as f32) - 0.5;
        let base = pos.floor();
        let t = pos - base;
        let texel = |dx: i64, dy: i64| {
            let x = wrapped(base.x as i64 + dx, self.width, self.wrap[0]);
            let y = wrapped(base.y as i64 + dy, self.height, self.wrap[1]);
            let [r, g, b, a] = self.rgba8[y * self.width as usize + x];
            Vec4::new(linear_from_srgb(r), linear_from_srgb(g), linear_from_srgb(b), f32::from(a) / 255.0)
        };
        let top = texel(0, 0).lerp(texel(1, 0), t.x);
        let bottom = texel(0, 1).lerp(texel(1, 1), t.x);
        top.lerp(bottom, t.y)
    }

    /// [`Self::sample`], alpha alone.
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

/// A triangle in world space, with where it came from.
#[derive(Clone, Copy, Debug)]
pub struct WorldTriangle {
    /// World positions, counter-clockwise seen from the front.
    pub positions: [Vec3; 3],
    /// Index into [`Scene::instances`].
    pub instance: u32,
    /// Which triangle of the instance's mesh.
    pub triangle: u32,
}

impl Scene {
    /// Triangles as drawn: every instance included.
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

    /// The box of all triangles in world space.
    pub fn bounds(&self) -> Aabb {
        self.bounds_of(&self.instances)
    }

    /// The box of some instances' triangles in world space.
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

    #[test]
    fn tint_follows_the_definition() {
        let glass = Material { alpha: AlphaMode::Blend, ..Material::default() };
        let t = glass.transmittance(Vec4::new(1.0, 0.5, 0.0, 0.8));
        assert!(t.abs_diff_eq(Vec3::new(1.0, 0.6, 0.2), 1e-6));
    }
}
