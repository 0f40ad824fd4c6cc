//! Emission that varies over a light.

use glam::{Vec2, Vec3};

/// Weights of linear RGB in luminance (Rec. ITU-R BT.709, whose primaries sRGB shares).
pub const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Emission that varies over a rectangle light; its luminance weights the area.
#[derive(Clone, Debug, PartialEq)]
pub struct EmissionTexture {
    /// Texels along the light's right axis.
    pub width: u32,
    /// Texels along the light's up axis.
    pub height: u32,
    /// `width · height` linear luminances ≥ 0; the first row is the top (+up), the first column is −right.
    pub luminance: Vec<f32>,
    /// Linear RGB of each texel at a luminance of 1; `None` is grey. Visibility depends on luminance alone; techniques that weight
    /// light points by colour read the tint.
    pub tint: Option<Vec<Vec3>>,
}

impl EmissionTexture {
    /// Creates a grey texture.
    pub fn gray(width: u32, height: u32, luminance: Vec<f32>) -> Self {
        Self { width, height, luminance, tint: None }
    }

    /// Creates a texture of `width · height` linear RGB values, without a tint if all are grey.
    pub fn from_rgb(width: u32, height: u32, rgb: &[Vec3]) -> Self {
        let luminance: Vec<f32> = rgb.iter().map(|c| c.dot(LUMINANCE)).collect();
        let is_gray = |c: &Vec3| c.max_element() - c.min_element() <= 1e-6 * c.max_element();
        let tint = |(c, l): (&Vec3, &f32)| if *l > 0.0 { *c / *l } else { Vec3::ONE };
        let tint = (!rgb.iter().all(is_gray)).then(|| rgb.iter().zip(&luminance).map(tint).collect());
        Self { width, height, luminance, tint }
    }

    /// Index of the texel at `u` in the unit square.
    fn texel(&self, u: Vec2) -> usize {
        let column = ((u.x * self.width as f32) as u32).min(self.width - 1);
        let row = (((1.0 - u.y) * self.height as f32) as u32).min(self.height - 1);
        (row * self.width + column) as usize
    }

    /// Linear RGB emission of the texel at `u` in the unit square.
    pub fn color_at(&self, u: Vec2) -> Vec3 {
        let texel = self.texel(u);
        self.luminance[texel] * self.tint.as_ref().map_or(Vec3::ONE, |tint| tint[texel])
    }

    /// Linear RGB emission of each texel, row after row.
    pub fn colors(&self) -> impl Iterator<Item = Vec3> + '_ {
        let tint = move |i: usize| self.tint.as_ref().map_or(Vec3::ONE, |tint| tint[i]);
        self.luminance.iter().enumerate().map(move |(i, l)| *l * tint(i))
    }

    /// Whether the texture has one value per texel, finite and not negative, and is not dark everywhere.
    pub(crate) fn is_usable(&self) -> bool {
        let texels = self.width as usize * self.height as usize;
        let is_color = |c: &Vec3| c.is_finite() && c.min_element() >= 0.0;
        texels > 0
            && self.luminance.len() == texels
            && self.luminance.iter().all(|l| l.is_finite() && *l >= 0.0)
            && self.luminance.iter().any(|l| *l > 0.0)
            && self.tint.as_ref().is_none_or(|tint| tint.len() == texels && tint.iter().all(is_color))
    }

    /// Luminance of the texel at `u` in the unit square, where `u.x` runs along right and `u.y` along up.
    pub fn luminance_at(&self, u: Vec2) -> f32 {
        self.luminance[self.texel(u)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_are_kept_and_weigh_by_luminance() {
        let rgb = [Vec3::X, Vec3::new(0.0, 0.5, 0.25), Vec3::ZERO, Vec3::splat(0.7)];
        let texture = EmissionTexture::from_rgb(2, 2, &rgb);
        // Rows run from the top.
        let at = [Vec2::new(0.2, 0.9), Vec2::new(0.9, 0.9), Vec2::new(0.2, 0.2), Vec2::new(0.9, 0.2)];
        for (u, want) in at.into_iter().zip(rgb) {
            assert!(texture.color_at(u).abs_diff_eq(want, 1e-6), "{u}");
            assert!((texture.luminance_at(u) - want.dot(LUMINANCE)).abs() < 1e-6);
        }
        assert!(texture.colors().zip(rgb).all(|(a, b)| a.abs_diff_eq(b, 1e-6)));
        let gray = EmissionTexture::from_rgb(1, 2, &[Vec3::ONE, Vec3::splat(0.3)]);
        assert!(gray.tint.is_none() && gray.color_at(Vec2::ZERO).abs_diff_eq(Vec3::splat(0.3), 1e-6));
    }

    #[test]
    fn unusable_textures_are_found() {
        let gray = |luminance: Vec<f32>| EmissionTexture::gray(2, 1, luminance);
        let tinted = |tint: Vec<Vec3>| EmissionTexture { tint: Some(tint), ..gray(vec![1.0, 0.5]) };
        assert!(gray(vec![0.0, 1.0]).is_usable() && tinted(vec![Vec3::X, Vec3::ONE]).is_usable());
        for luminance in [vec![], vec![1.0], vec![0.0, 0.0], vec![f32::NAN, 1.0], vec![-1.0, 1.0]] {
            assert!(!gray(luminance.clone()).is_usable(), "{luminance:?}");
        }
        for tint in [vec![Vec3::ONE], vec![Vec3::ONE, Vec3::NEG_X], vec![Vec3::ONE, Vec3::NAN]] {
            assert!(!tinted(tint.clone()).is_usable(), "{tint:?}");
        }
    }
}
