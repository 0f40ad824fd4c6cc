//! Opacity and transmission of surfaces (`docs/formats.md`, Visibility).
//!
//! ```text
//! passes = (1 − coverage) + coverage · transmitted
//! transmitted = transmission · (1 − metalness) · base colour · attenuation of the volume
//! ```
//!
//! Coverage is alpha for blended surfaces, 0 or 1 for masked ones, 1 for opaque ones. A blended surface that transmits
//! nothing covers without tinting.
//!
//! A surface has one image for both: `transmitted` in RGB, alpha in alpha. If a material has more images than the base
//! colour's, they are multiplied texel by texel into one, which ray tracer and GPU then filter alike.

use glam::{UVec2, Vec2, Vec3, Vec4};

use crate::scene::srgb_from_linear;
use crate::{AlphaMode, Image, Material, Mesh, Scene};

/// Effect of a surface on light that meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Occluder {
    /// Blocks all light.
    Opaque,
    /// Alpha-tested: blocks all light where the filtered alpha reaches the cutoff, none elsewhere.
    Masked {
        /// The asset's `alphaCutoff`.
        cutoff: f32,
    },
    /// Lets some light through; see [`Scene::translucency`].
    Translucent,
}

/// Rule for a surface's coverage, from 0 to 1, as a function of its alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coverage {
    /// Coverage 1.
    Whole,
    /// Coverage is alpha.
    Alpha,
    /// Coverage 1 where alpha reaches the cutoff, 0 elsewhere.
    Cutoff(f32),
}

impl Coverage {
    fn of(self, alpha: f32) -> f32 {
        match self {
            Self::Whole => 1.0,
            Self::Alpha => alpha.clamp(0.0, 1.0),
            Self::Cutoff(cutoff) => f32::from(u8::from(alpha >= cutoff)),
        }
    }
}

/// Image that multiplies a surface's values: RGB a colour, alpha linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfacePicture {
    /// No image: white.
    White,
    /// Index into [`Scene::images`].
    Image(usize),
    /// The product of the material's images; see [`Scene::transmitted_picture`].
    Made,
}

/// Translucent surface. Its value at a point is `factor` × the vertex colour × the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Translucency {
    /// Coverage as a function of the value's alpha.
    pub coverage: Coverage,
    /// Linear colour that the covered part transmits, and alpha.
    pub factor: Vec4,
    /// Image that multiplies `factor`.
    pub picture: SurfacePicture,
}

impl Translucency {
    /// Fraction of light that passes per colour channel, where the surface has `value`.
    pub fn passes(&self, value: Vec4) -> Vec3 {
        let coverage = self.coverage.of(value.w);
        (1.0 - coverage) + coverage * value.truncate().clamp(Vec3::ZERO, Vec3::ONE)
    }

    /// Whether a ray from the eye hits the surface where it has `value`: rays pass through the holes of masked surfaces.
    pub fn is_there(&self, value: Vec4) -> bool {
        !matches!(self.coverage, Coverage::Cutoff(_)) || self.coverage.of(value.w) > 0.0
    }
}

impl Material {
    /// Whether the covered part of the surface may transmit light.
    fn transmits(&self) -> bool {
        // An image may lower the metalness below its factor.
        self.transmission > 0.0 && (self.metallic < 1.0 || self.metallic_roughness_image.is_some())
    }

    /// Effect of the surface on light, from the material alone; [`Scene::occluders`] also examines mesh and images.
    pub fn occluder(&self) -> Occluder {
        match self.alpha {
            AlphaMode::Blend => Occluder::Translucent,
            _ if self.transmits() => Occluder::Translucent,
            AlphaMode::Mask { cutoff } => Occluder::Masked { cutoff },
            AlphaMode::Opaque => Occluder::Opaque,
        }
    }

    /// Transmission times base colour in RGB, alpha in alpha.
    fn transmitted(&self) -> Vec4 {
        (self.base_color.truncate() * self.transmission).extend(self.base_color.w)
    }
}

impl Scene {
    /// Effect of each mesh on light. A blended surface that transmits nothing and whose alpha is 1 everywhere is opaque.
    /// A masked surface is reported as masked even if no texture, factor or vertex colour can lower alpha below its cutoff.
    pub fn occluders(&self) -> Vec<Occluder> {
        let mut is_solid_image: Vec<Option<bool>> = vec![None; self.images.len()];
        let mut is_solid = |mesh: &Mesh, material: &Material| {
            let image = material.base_color_image.filter(|_| !mesh.uvs.is_empty());
            material.base_color.w >= 1.0
                && mesh.colors.iter().all(|color| color.w >= 1.0)
                && image.is_none_or(|image| {
                    let mut texels = self.images[image].rgba8.iter();
                    *is_solid_image[image].get_or_insert_with(|| texels.all(|texel| texel[3] == u8::MAX))
                })
        };
        let occluder = |mesh: &Mesh| {
            let material = &self.materials[mesh.material];
            match material.occluder() {
                Occluder::Translucent if !material.transmits() && is_solid(mesh, material) => Occluder::Opaque,
                occluder => occluder,
            }
        };
        self.meshes.iter().map(occluder).collect()
    }

    /// Coverage and transmission of a mesh's surface.
    pub fn translucency(&self, mesh: &Mesh) -> Translucency {
        let material = &self.materials[mesh.material];
        let coverage = match material.alpha {
            AlphaMode::Opaque => Coverage::Whole,
            AlphaMode::Mask { cutoff } => Coverage::Cutoff(cutoff),
            AlphaMode::Blend => Coverage::Alpha,
        };
        let base_color = material
            .base_color_image
            .filter(|_| !mesh.uvs.is_empty())
            .map_or(SurfacePicture::White, SurfacePicture::Image);
        let (factor, picture) = if !material.transmits() {
            (Vec3::ZERO.extend(material.base_color.w), base_color)
        } else if !mesh.uvs.is_empty() && TransmittedImages::of(self, material).are_needed() {
            (material.transmitted(), SurfacePicture::Made)
        } else {
            (material.transmitted() * TransmittedImages::default().value(material, mesh.closed, Vec2::ZERO), base_color)
        };
        Translucency { coverage, factor, picture }
    }

    /// Image of a material that [`SurfacePicture::Made`] stands for, for closed or for open meshes. Its width and height are
    /// the largest of the material's images.
    pub fn transmitted_picture(&self, material: usize, is_closed: bool) -> Image {
        let material = &self.materials[material];
        let images = TransmittedImages::of(self, material);
        let all = images.all();
        let size = all.iter().flatten().fold(UVec2::ONE, |size, image| size.max(UVec2::new(image.width, image.height)));
        let byte = |v: f32| (255.0 * v).round() as u8;
        let texel = |i: u32| {
            let uv = (Vec2::new((i % size.x) as f32, (i / size.x) as f32) + 0.5) / size.as_vec2();
            let value = images.value(material, is_closed, uv);
            let [r, g, b] = value.truncate().to_array().map(|v| byte(srgb_from_linear(v)));
            [r, g, b, byte(value.w)]
        };
        Image {
            width: size.x,
            height: size.y,
            rgba8: (0..size.x * size.y).map(texel).collect(),
            wrap: all.iter().flatten().next().map_or_else(Default::default, |image| image.wrap),
        }
    }

    /// Whether a mesh's surface may change the colour of the light that passes.
    pub fn tints(&self, mesh: &Mesh) -> bool {
        let Translucency { factor, picture, .. } = self.translucency(mesh);
        let color = factor.truncate();
        let is_plain = picture == SurfacePicture::White && mesh.colors.is_empty();
        color != Vec3::ZERO && !(is_plain && color == Vec3::splat(color.x))
    }
}

/// Images on which a surface's transmission depends.
#[derive(Clone, Copy, Default)]
struct TransmittedImages<'a> {
    base_color: Option<&'a Image>,
    transmission: Option<&'a Image>,
    metallic_roughness: Option<&'a Image>,
    thickness: Option<&'a Image>,
}

impl<'a> TransmittedImages<'a> {
    fn of(scene: &'a Scene, material: &Material) -> Self {
        let image = |index: Option<usize>| index.map(|index| &scene.images[index]);
        Self {
            base_color: image(material.base_color_image),
            transmission: image(material.transmission_image),
            metallic_roughness: image(material.metallic_roughness_image),
            thickness: image(material.volume.as_ref().and_then(|volume| volume.thickness_image)),
        }
    }

    fn all(&self) -> [Option<&'a Image>; 4] {
        [self.base_color, self.transmission, self.metallic_roughness, self.thickness]
    }

    /// Whether there are images other than the base colour's.
    fn are_needed(&self) -> bool {
        self.all()[1..].iter().any(Option::is_some)
    }

    /// Factor of [`Material::transmitted`] at `uv`.
    fn value(&self, material: &Material, is_closed: bool, uv: Vec2) -> Vec4 {
        let stored = |image: Option<&Image>| image.map_or(Vec4::ONE, |image| image.sample_stored(uv));
        let color = self.base_color.map_or(Vec4::ONE, |image| image.sample(uv));
        let share = stored(self.transmission).x * (1.0 - material.metallic * stored(self.metallic_roughness).z);
        let thickness = stored(self.thickness).y;
        let attenuation = material.volume.as_ref().map_or(Vec3::ONE, |volume| volume.attenuation(thickness, is_closed));
        color * (share * attenuation).extend(1.0)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{Volume, Wrap};

    fn mesh() -> Mesh {
        Mesh { positions: vec![Vec3::ZERO; 3], uvs: vec![Vec2::ZERO; 3], indices: vec![0, 1, 2], ..Mesh::default() }
    }

    fn scene(material: Material, images: Vec<Image>) -> Scene {
        Scene { meshes: vec![mesh()], materials: vec![material], images, ..Scene::default() }
    }

    fn image(texels: &[[u8; 4]]) -> Image {
        Image { width: texels.len() as u32, height: 1, rgba8: texels.to_vec(), wrap: [Wrap::Clamp; 2] }
    }

    /// Light that passes at the centre of texel `i` of `n`, where the images are `n` texels wide.
    pub(crate) fn passes(scene: &Scene, i: u32, n: u32) -> Vec3 {
        let mesh = &scene.meshes[0];
        let translucency = scene.translucency(mesh);
        let uv = Vec2::new((i as f32 + 0.5) / n as f32, 0.5);
        let texel = match translucency.picture {
            SurfacePicture::White => Vec4::ONE,
            SurfacePicture::Image(image) => scene.images[image].sample(uv),
            SurfacePicture::Made => scene.transmitted_picture(mesh.material, mesh.closed).sample(uv),
        };
        translucency.passes(translucency.factor * texel)
    }

    #[test]
    fn blended_surfaces_cover_and_never_tint() {
        let red = |alpha: f32| Material {
            base_color: Vec4::new(1.0, 0.0, 0.0, alpha),
            alpha: AlphaMode::Blend,
            ..Material::default()
        };
        for alpha in [0.0, 0.25, 1.0] {
            let scene = scene(red(alpha), Vec::new());
            assert_eq!(passes(&scene, 0, 1), Vec3::splat(1.0 - alpha));
            assert!(!scene.tints(&scene.meshes[0]));
        }
        let image = image(&[[255, 0, 0, 255], [0, 255, 0, 51]]);
        let scene = scene(Material { base_color_image: Some(0), ..red(0.5) }, vec![image]);
        assert_eq!(passes(&scene, 0, 2), Vec3::splat(0.5));
        assert!(passes(&scene, 1, 2).abs_diff_eq(Vec3::splat(0.9), 1e-6));
    }

    #[test]
    fn transmission_tints_what_is_covered() {
        let glass = Material { base_color: Vec4::new(1.0, 0.5, 0.0, 0.8), transmission: 0.5, ..Material::default() };
        let whole = scene(glass.clone(), Vec::new());
        assert_eq!(passes(&whole, 0, 1), Vec3::new(0.5, 0.25, 0.0));
        assert!(whole.tints(&whole.meshes[0]));
        let blended = scene(Material { alpha: AlphaMode::Blend, ..glass.clone() }, Vec::new());
        assert!(passes(&blended, 0, 1).abs_diff_eq(0.2 + 0.8 * Vec3::new(0.5, 0.25, 0.0), 1e-6));
        let masked = |cutoff| scene(Material { alpha: AlphaMode::Mask { cutoff }, ..glass.clone() }, Vec::new());
        assert_eq!(passes(&masked(0.5), 0, 1), Vec3::new(0.5, 0.25, 0.0));
        assert_eq!(passes(&masked(0.9), 0, 1), Vec3::ONE);
        let metal = scene(Material { metallic: 0.5, ..glass.clone() }, Vec::new());
        assert_eq!(passes(&metal, 0, 1), Vec3::new(0.25, 0.125, 0.0));
        let grey = scene(Material { base_color: Vec4::ONE, ..glass }, Vec::new());
        assert!(!grey.tints(&grey.meshes[0]));
    }

    #[test]
    fn images_of_transmission_metalness_and_thickness_count_texel_by_texel() {
        let colors = image(&[[255, 255, 255, 255], [255, 255, 255, 102], [255, 0, 0, 255], [255, 255, 255, 255]]);
        let transmission = image(&[[255, 0, 0, 0], [255, 0, 0, 0], [255, 9, 9, 9], [0, 255, 255, 255]]);
        let metallic = image(&[[0, 0, 255, 0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]);
        let thickness = image(&[[0; 4], [0, 255, 0, 0], [0; 4], [0; 4]]);
        let material = Material {
            alpha: AlphaMode::Blend,
            transmission: 1.0,
            metallic: 1.0,
            base_color_image: Some(0),
            transmission_image: Some(1),
            metallic_roughness_image: Some(2),
            volume: Some(Volume {
                thickness_m: 0.2,
                thickness_image: Some(3),
                attenuation_color: Vec3::new(1.0, 0.25, 0.25),
                attenuation_distance_m: 0.1,
            }),
            ..Material::default()
        };
        let mut scene = scene(material, vec![colors, transmission, metallic, thickness]);
        let close = |a: Vec3, b: Vec3| assert!(a.abs_diff_eq(b, 4e-3), "{a} {b}");
        close(passes(&scene, 0, 4), Vec3::ZERO);
        close(passes(&scene, 1, 4), 0.6 + 0.4 * Vec3::new(1.0, 0.0625, 0.0625));
        close(passes(&scene, 2, 4), Vec3::X);
        close(passes(&scene, 3, 4), Vec3::ZERO);
        // A closed mesh is crossed twice.
        scene.meshes[0].closed = true;
        close(passes(&scene, 1, 4), 0.6 + 0.4 * Vec3::new(1.0, 0.25, 0.25));
        // Without texture coordinates, only the factors apply.
        scene.meshes[0].uvs.clear();
        scene.materials[0].metallic = 0.0;
        close(passes(&scene, 0, 4), Vec3::new(1.0, 0.25, 0.25));
    }

    #[test]
    fn solid_blended_surfaces_are_opaque() {
        let blend = Material { alpha: AlphaMode::Blend, ..Material::default() };
        let textured = Material { base_color_image: Some(0), ..blend.clone() };
        let solid = image(&[[1, 2, 3, 255]]);
        let occluder = |material: &Material, image: &Image| scene(material.clone(), vec![image.clone()]).occluders()[0];
        assert_eq!(occluder(&blend, &solid), Occluder::Opaque);
        assert_eq!(occluder(&textured, &solid), Occluder::Opaque);
        assert_eq!(occluder(&textured, &image(&[[0, 0, 0, 255], [0, 0, 0, 254]])), Occluder::Translucent);
        let faint = Material { base_color: Vec4::new(1.0, 1.0, 1.0, 0.999), ..blend.clone() };
        assert_eq!(occluder(&faint, &solid), Occluder::Translucent);
        assert_eq!(occluder(&Material { transmission: 0.1, ..blend.clone() }, &solid), Occluder::Translucent);
        let metal = Material { transmission: 1.0, metallic: 1.0, ..Material::default() };
        assert_eq!(occluder(&metal, &solid), Occluder::Opaque);
        let mut faded = scene(blend, Vec::new());
        faded.meshes[0].colors = vec![Vec4::ONE, Vec4::ONE, Vec4::new(1.0, 1.0, 1.0, 0.5)];
        assert_eq!(faded.occluders(), [Occluder::Translucent]);
    }
}
