//! Materials for shading, with the means of their images.

use antumbra_scene::{Material, Scene};
use glam::Vec3;

/// Returns a material with the means of its images in its factors, except for the base colour's image.
pub(super) fn shaded(scene: &Scene, material: &Material) -> Material {
    let mean = |image: Option<usize>, channel: usize| {
        image.map_or(1.0, |image| {
            let texels = &scene.images[image].rgba8;
            let sum: f64 = texels.iter().map(|texel| f64::from(texel[channel])).sum();
            (sum / (255.0 * texels.len().max(1) as f64)) as f32
        })
    };
    let metallic = material.metallic * mean(material.metallic_roughness_image, 2);
    let transmission = material.transmission * mean(material.transmission_image, 0) * (1.0 - metallic);
    let absorbed = material.volume.as_ref().map_or(Vec3::ONE, |volume| {
        Vec3::ONE.lerp(volume.attenuation(mean(volume.thickness_image, 1), false), transmission)
    });
    Material {
        base_color: material.base_color * absorbed.extend(1.0),
        transmission,
        transmission_image: None,
        metallic,
        roughness: material.roughness * mean(material.metallic_roughness_image, 1),
        metallic_roughness_image: None,
        volume: None,
        ..material.clone()
    }
}

#[cfg(test)]
mod tests {
    use antumbra_scene::{Image, Volume, Wrap};

    use super::*;

    #[test]
    fn shading_has_the_means_of_images() {
        let image =
            Image { width: 2, height: 1, rgba8: vec![[255, 255, 51, 0], [51, 0, 51, 0]], wrap: [Wrap::Clamp; 2] };
        let volume = Volume {
            thickness_m: 2.0,
            thickness_image: Some(0),
            attenuation_color: Vec3::new(1.0, 0.5, 0.25),
            attenuation_distance_m: 1.0,
        };
        let material = Material {
            transmission: 1.0,
            transmission_image: Some(0),
            metallic: 0.0,
            roughness: 0.5,
            metallic_roughness_image: Some(0),
            volume: Some(volume),
            ..Material::default()
        };
        let scene = Scene { images: vec![image], ..Scene::default() };
        let of = |material: &Material| {
            let Material { transmission, metallic, roughness, base_color, .. } = shaded(&scene, material);
            (transmission, metallic, roughness, base_color)
        };
        let near = |a: f32, b: f32| (a - b).abs() < 1e-6;
        let (transmission, metallic, roughness, base_color) = of(&material);
        assert!(near(transmission, 0.6) && metallic == 0.0 && near(roughness, 0.25));
        assert!(base_color.truncate().abs_diff_eq(Vec3::new(1.0, 0.7, 0.55), 1e-6), "{base_color}");
        let (transmission, metallic, ..) = of(&Material { metallic: 1.0, ..material });
        assert!(near(metallic, 0.2) && near(transmission, 0.48));
    }
}
