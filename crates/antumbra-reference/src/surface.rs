//! Effect of triangles on light: opaque, alpha-tested or translucent.
//!
//! A mask whose alpha cannot cross its cutoff anywhere on a triangle is resolved once, when the scene is loaded: the
//! triangle is then opaque or left out. (The idea of opacity micromaps: Gruen, Benthin and Woop, "Sub-triangle opacity
//! masks for faster ray tracing of transparent objects", HPG 2020; here without subdivision.)

use std::collections::HashMap;

use antumbra_scene::{Coverage, Image, Mesh, Occluder, Scene, SurfacePicture, Translucency, Wrap};
use glam::{Vec2, Vec3, Vec4};

/// Effect of one triangle on light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Surface {
    /// Blocks all light.
    Opaque,
    /// Blocks where [`Masked::is_solid_at`] holds; an index into the tracer's masked triangles.
    Masked(u32),
    /// Transmits [`Translucent::passes_at`]; an index into the tracer's translucent triangles.
    Translucent(u32),
}

/// Image with bounds of its alpha, for sampling.
#[derive(Clone, Debug)]
pub(crate) struct AlphaImage {
    image: Image,
    /// Smallest and largest alpha per block of [`BOUND_BLOCK`]² texels, row by row.
    bounds: Vec<[u8; 2]>,
    blocks: [u32; 2],
}

/// Side of a block of alpha bounds, texels: with 16, a 4096² image has 64 Ki bounds.
const BOUND_BLOCK: u32 = 16;

impl AlphaImage {
    pub(crate) fn new(image: &Image) -> Self {
        let blocks = [image.width.div_ceil(BOUND_BLOCK), image.height.div_ceil(BOUND_BLOCK)];
        let mut bounds = vec![[u8::MAX, 0]; (blocks[0] * blocks[1]) as usize];
        for (i, texel) in (0u32..).zip(&image.rgba8) {
            let (x, y) = (i % image.width, i / image.width);
            let bound = &mut bounds[(y / BOUND_BLOCK * blocks[0] + x / BOUND_BLOCK) as usize];
            *bound = [bound[0].min(texel[3]), bound[1].max(texel[3])];
        }
        Self { image: image.clone(), bounds, blocks }
    }

    /// Bounds of the bilinear alpha over a box of texture coordinates, in [0, 1].
    fn bounds_over(&self, min: Vec2, max: Vec2) -> [f32; 2] {
        let size = Vec2::new(self.image.width as f32, self.image.height as f32);
        // A sample at texel coordinate p reads texel ⌊p − ½⌋ and the next.
        let first = (min * size - 0.5).floor();
        let last = (max * size - 0.5).floor() + 1.0;
        let columns = self.blocks_between(0, first.x, last.x);
        let rows = self.blocks_between(1, first.y, last.y);
        let mut all = [u8::MAX, 0u8];
        for row in rows {
            for &column in &columns {
                let [low, high] = self.bounds[(row * self.blocks[0] + column) as usize];
                all = [all[0].min(low), all[1].max(high)];
            }
        }
        all.map(|v| f32::from(v) / 255.0)
    }

    /// Blocks that contain texels `first..=last` of an axis after wrapping.
    fn blocks_between(&self, axis: usize, first: f32, last: f32) -> Vec<u32> {
        let texels = if axis == 0 { self.image.width } else { self.image.height };
        let n = i64::from(texels);
        // NaN, more repetitions than real textures have, or a full period: all blocks.
        if !(first.abs() < 1e9 && last.abs() < 1e9) || last as i64 - first as i64 >= n {
            return (0..self.blocks[axis]).collect();
        }
        let mut blocks: Vec<u32> = (first as i64..=last as i64)
            .map(|i| {
                let wrapped = match self.image.wrap[axis] {
                    Wrap::Repeat => i.rem_euclid(n),
                    Wrap::Mirror => {
                        let m = i.rem_euclid(2 * n);
                        if m < n { m } else { 2 * n - 1 - m }
                    }
                    Wrap::Clamp => i.clamp(0, n - 1),
                };
                wrapped as u32 / BOUND_BLOCK
            })
            .collect();
        blocks.dedup();
        blocks
    }
}

/// Alpha-tested triangle that is neither fully solid nor fully a hole.
#[derive(Clone, Debug)]
pub(crate) struct Masked {
    /// Index into the tracer's alpha images; `None` if vertex colours alone make the mask.
    image: Option<u32>,
    uv: [Vec2; 3],
    /// Factor · vertex alpha at the corners.
    alpha: [f32; 3],
    cutoff: f32,
}

impl Masked {
    /// Whether the surface exists at barycentric weights.
    #[inline]
    pub(crate) fn is_solid_at(&self, images: &[AlphaImage], weights: [f32; 3]) -> bool {
        let factor = if self.alpha[0] == self.alpha[1] && self.alpha[0] == self.alpha[2] {
            self.alpha[0]
        } else {
            mix(self.alpha, weights)
        };
        let texture = self.image.map_or(1.0, |image| images[image as usize].image.sample_alpha(mix(self.uv, weights)));
        texture * factor >= self.cutoff
    }
}

/// Translucent triangle.
#[derive(Clone, Debug)]
pub(crate) struct Translucent {
    /// Transmittance if it is constant over the triangle.
    constant: Option<Vec3>,
    surface: Translucency,
    uv: [Vec2; 3],
    /// Factor · vertex colour at the corners.
    color: [Vec4; 3],
    /// Index into the tracer's images of translucent surfaces.
    picture: Option<u32>,
}

impl Translucent {
    fn value_at(&self, pictures: &[Image], weights: [f32; 3]) -> Vec4 {
        let texel = self.picture.map_or(Vec4::ONE, |i| pictures[i as usize].sample(mix(self.uv, weights)));
        texel * mix(self.color, weights)
    }

    /// Fraction of light that passes at barycentric weights, per channel.
    pub(crate) fn passes_at(&self, pictures: &[Image], weights: [f32; 3]) -> Vec3 {
        self.constant.unwrap_or_else(|| self.surface.passes(self.value_at(pictures, weights)))
    }

    /// Whether a ray from the eye meets the surface at barycentric weights.
    pub(crate) fn is_there_at(&self, pictures: &[Image], weights: [f32; 3]) -> bool {
        match self.surface.coverage {
            Coverage::Cutoff(_) => self.surface.is_there(self.value_at(pictures, weights)),
            Coverage::Whole | Coverage::Alpha => true,
        }
    }
}

/// Image of translucent surfaces: one of the scene's, or the product of a material's images on closed or on open meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Picture {
    Image(usize),
    Made { material: usize, is_closed: bool },
}

/// Surfaces of a scene that are not simply opaque, with their images.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surfaces {
    pub(crate) masked: Vec<Masked>,
    pub(crate) translucent: Vec<Translucent>,
    pub(crate) alpha_images: Vec<AlphaImage>,
    pub(crate) pictures: Vec<Image>,
    /// Whether any translucent triangle may change the colour of light.
    pub(crate) tint: bool,
    /// Effect on light of each of the scene's meshes.
    occluders: Vec<Occluder>,
    /// Index of the alpha image of each of the scene's images.
    alpha_index: Vec<Option<u32>>,
    picture_index: HashMap<Picture, u32>,
}

impl Surfaces {
    pub(crate) fn new(scene: &Scene) -> Self {
        Self { occluders: scene.occluders(), alpha_index: vec![None; scene.images.len()], ..Self::default() }
    }

    /// Adds one triangle of a mesh; `None` if its mask lets all light pass.
    pub(crate) fn add(&mut self, scene: &Scene, mesh: usize, triangle: usize) -> Option<Surface> {
        let occluder = self.occluders[mesh];
        if occluder == Occluder::Opaque {
            return Some(Surface::Opaque);
        }
        let mesh = &scene.meshes[mesh];
        let material = &scene.materials[mesh.material];
        let corners = [0, 1, 2].map(|k| mesh.indices[3 * triangle + k] as usize);
        let uv = if mesh.uvs.is_empty() { [Vec2::ZERO; 3] } else { corners.map(|i| mesh.uvs[i]) };
        let vertex_color = if mesh.colors.is_empty() { [Vec4::ONE; 3] } else { corners.map(|i| mesh.colors[i]) };
        let alpha_image = material.base_color_image.filter(|_| !mesh.uvs.is_empty());
        let alpha = vertex_color.map(|color| color.w * material.base_color.w);
        match occluder {
            Occluder::Opaque => Some(Surface::Opaque),
            Occluder::Masked { cutoff } => self.add_masked(scene, alpha_image, uv, alpha, cutoff),
            Occluder::Translucent => {
                let surface = scene.translucency(mesh);
                // A surface that transmits nothing is opaque if its alpha is 1 everywhere.
                if surface.factor.truncate() == Vec3::ZERO {
                    let [low, _] = self.alpha_range(scene, alpha_image, uv, alpha);
                    if low >= 1.0 {
                        return Some(Surface::Opaque);
                    }
                }
                let color = vertex_color.map(|color| color * surface.factor);
                let picture = self.picture(scene, mesh, surface.picture);
                let is_constant = picture.is_none() && color[0] == color[1] && color[0] == color[2];
                let constant = is_constant.then(|| surface.passes(color[0]));
                self.tint |= scene.tints(mesh);
                self.translucent.push(Translucent { constant, surface, uv, color, picture });
                Some(Surface::Translucent(self.translucent.len() as u32 - 1))
            }
        }
    }

    /// Index of the image of a mesh's surface; `None` if it is white.
    fn picture(&mut self, scene: &Scene, mesh: &Mesh, picture: SurfacePicture) -> Option<u32> {
        let (material, is_closed) = (mesh.material, mesh.closed);
        let picture = match picture {
            SurfacePicture::White => return None,
            SurfacePicture::Image(image) => Picture::Image(image),
            SurfacePicture::Made => Picture::Made { material, is_closed },
        };
        Some(*self.picture_index.entry(picture).or_insert_with(|| {
            self.pictures.push(match picture {
                Picture::Image(image) => scene.images[image].clone(),
                Picture::Made { material, is_closed } => scene.transmitted_picture(material, is_closed),
            });
            self.pictures.len() as u32 - 1
        }))
    }

    /// Index of the alpha image of one of the scene's images.
    fn alpha_image(&mut self, scene: &Scene, image: usize) -> u32 {
        *self.alpha_index[image].get_or_insert_with(|| {
            self.alpha_images.push(AlphaImage::new(&scene.images[image]));
            self.alpha_images.len() as u32 - 1
        })
    }

    /// Bounds of image · `alpha` over a triangle.
    fn alpha_range(&mut self, scene: &Scene, image: Option<usize>, uv: [Vec2; 3], alpha: [f32; 3]) -> [f32; 2] {
        let texture = image.map_or([1.0; 2], |image| {
            let image = self.alpha_image(scene, image);
            let min = uv[0].min(uv[1]).min(uv[2]);
            let max = uv[0].max(uv[1]).max(uv[2]);
            // Widened by the rounding of interpolated coordinates in single precision.
            let slack = (min.abs().max(max.abs()) * 4.0 * f32::EPSILON).max(Vec2::splat(f32::EPSILON));
            self.alpha_images[image as usize].bounds_over(min - slack, max + slack)
        });
        let (low, high) = (alpha.into_iter().fold(f32::INFINITY, f32::min), alpha.into_iter().fold(0.0, f32::max));
        [texture[0] * low, texture[1] * high]
    }

    fn add_masked(
        &mut self,
        scene: &Scene,
        image: Option<usize>,
        uv: [Vec2; 3],
        alpha: [f32; 3],
        cutoff: f32,
    ) -> Option<Surface> {
        let [low, high] = self.alpha_range(scene, image, uv, alpha);
        let image = image.map(|image| self.alpha_image(scene, image));
        // Varying alpha may cross the cutoff by an ulp through rounding; constant alpha is exact.
        let margin = if low == high { 0.0 } else { 4.0 * f32::EPSILON };
        if low >= cutoff + margin {
            Some(Surface::Opaque)
        } else if high < cutoff - margin {
            None
        } else {
            self.masked.push(Masked { image, uv, alpha, cutoff });
            Some(Surface::Masked(self.masked.len() as u32 - 1))
        }
    }
}

/// Weighted sum of three corners' values.
#[inline]
fn mix<T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>>(corners: [T; 3], weights: [f32; 3]) -> T {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}
