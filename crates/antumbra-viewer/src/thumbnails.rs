//! Thumbnails of the built-in scenes. They are traced in the background, one at a time, when first requested, and cached.

use std::collections::HashMap;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use antumbra_light::Light;
use antumbra_reference::{ReceiverPoint, Tracer, VisibilityOptions};
use antumbra_scene::{LoadOptions, Scene, Setup, load, srgb_from_linear};
use glam::{UVec2, Vec2, Vec3};

use crate::background::{Wake, run_in_background};

/// A thumbnail's size, pixels.
pub const SIZE_PX: UVec2 = UVec2::new(96, 60);
/// Light samples per pixel.
const POINTS: u32 = 4;
/// Ambient fraction of the brightest illumination.
const AMBIENT: f32 = 0.25;
/// Background colour, sRGB.
const BACKGROUND: [u8; 3] = [150, 158, 168];

/// State of a thumbnail.
enum Thumbnail {
    /// Requested, not started.
    Requested,
    Traced(egui::TextureHandle),
    /// Unavailable; the scene's name is shown alone.
    Missing,
}

/// Thumbnails by scene name.
#[derive(Default)]
pub struct Thumbnails {
    known: HashMap<&'static str, Thumbnail>,
    /// The thumbnail that is being traced.
    pending: Option<(&'static str, Receiver<Option<egui::ColorImage>>)>,
}

impl std::fmt::Debug for Thumbnails {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Thumbnails")
    }
}

impl Thumbnails {
    /// Returns a scene's thumbnail once it is traced. `wake` is called when asking again is worthwhile.
    pub fn of(&mut self, ctx: &egui::Context, name: &'static str, wake: &Wake) -> Option<&egui::TextureHandle> {
        self.take(ctx);
        let known = self.known.entry(name).or_insert(Thumbnail::Requested);
        if matches!(known, Thumbnail::Requested) && self.pending.is_none() {
            let (sender, traced) = channel();
            let wake = wake.clone();
            run_in_background(move || {
                // The receiver is gone if the window was closed meanwhile.
                let _ = sender.send(traced_picture(name));
                wake();
            });
            self.pending = Some((name, traced));
        }
        match self.known.get(name) {
            Some(Thumbnail::Traced(texture)) => Some(texture),
            _ => None,
        }
    }

    fn take(&mut self, ctx: &egui::Context) {
        let Some((name, traced)) = &self.pending else { return };
        let picture = match traced.try_recv() {
            Err(TryRecvError::Empty) => return,
            Err(TryRecvError::Disconnected) => None,
            Ok(picture) => picture,
        };
        let thumbnail = picture.map_or(Thumbnail::Missing, |picture| {
            Thumbnail::Traced(ctx.load_texture(*name, picture, egui::TextureOptions::LINEAR))
        });
        self.known.insert(name, thumbnail);
        self.pending = None;
    }
}

/// Renders the scene with its own camera and first light, in flat colours.
fn traced_picture(name: &str) -> Option<egui::ColorImage> {
    let scene = load(&format!("builtin:{name}"), &LoadOptions::default()).ok()?;
    let Setup { camera, lights } = Setup::for_scene(&scene);
    let tracer = Tracer::new(&scene).ok()?;
    let receivers = tracer.primary(&camera, SIZE_PX);
    let options = VisibilityOptions { samples: POINTS, ..VisibilityOptions::default() };
    let never = AtomicBool::new(false);
    let visibility = tracer.visibility(&receivers, &lights[0], &options, &|_| {}, &never).ok()?.mean_channel();
    let lit = receivers.points.iter().zip(&visibility);
    let irradiances: Vec<f32> =
        lit.map(|(point, v)| point.as_ref().map_or(0.0, |point| v * irradiance(&lights[0], point))).collect();
    // White is the 90th percentile, so a few bright pixels do not darken the rest.
    let mut sorted: Vec<f32> = irradiances.iter().copied().filter(|e| *e > 0.0).collect();
    sorted.sort_by(f32::total_cmp);
    let white = sorted.get(sorted.len() * 9 / 10).copied().unwrap_or(1.0);
    let color = |(point, e): (&Option<ReceiverPoint>, &f32)| match point {
        None => egui::Color32::from_rgb(BACKGROUND[0], BACKGROUND[1], BACKGROUND[2]),
        Some(point) => {
            let light = AMBIENT + (1.0 - AMBIENT) * (e / white).min(1.0);
            let [r, g, b] = (base_color(&scene, point) * light).to_array().map(|v| (255.0 * srgb_from_linear(v)) as u8);
            egui::Color32::from_rgb(r, g, b)
        }
    };
    let pixels = receivers.points.iter().zip(&irradiances).map(color).collect();
    Some(egui::ColorImage::new([SIZE_PX.x as usize, SIZE_PX.y as usize], pixels))
}

/// Unshadowed irradiance of a surface point from the light's centre, up to a constant factor.
fn irradiance(light: &Light, point: &ReceiverPoint) -> f32 {
    let to_light = if light.is_distant() { -light.axis } else { light.center - point.position };
    let cosine = point.normal.dot(to_light.normalize_or_zero()).max(0.0);
    if light.is_distant() { cosine } else { cosine / to_light.length_squared().max(1e-6) }
}

/// Base colour of the surface at the point, linear.
fn base_color(scene: &Scene, point: &ReceiverPoint) -> Vec3 {
    let Some(instance) = scene.instances.get(point.instance as usize) else { return Vec3::splat(0.5) };
    let mesh = &scene.meshes[instance.mesh];
    let corners = [0, 1, 2].map(|k| {
        let vertex = mesh.indices[3 * point.triangle as usize + k] as usize;
        instance.world_from_object.transform_point3(mesh.positions[vertex])
    });
    let [ab, ac, ap] = [corners[1] - corners[0], corners[2] - corners[0], point.position - corners[0]];
    // Sub-triangle areas relative to the triangle's, projected on its normal.
    let normal = ab.cross(ac);
    let squared = normal.length_squared().max(f32::MIN_POSITIVE);
    let barycentric = Vec2::new(ap.cross(ac).dot(normal), ab.cross(ap).dot(normal)) / squared;
    scene.base_color_at(mesh, point.triangle, barycentric.clamp(Vec2::ZERO, Vec2::ONE)).truncate()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::{Duration, Instant};

    use super::*;

    #[test]
    fn a_scene_is_known_by_its_picture() {
        let overlap = traced_picture("overlap").unwrap();
        assert_eq!(overlap.size, [96, 60]);
        let levels = |picture: &egui::ColorImage| {
            picture.pixels.iter().map(|c| u32::from(c.r()) + u32::from(c.g()) + u32::from(c.b())).collect::<Vec<_>>()
        };
        let of = levels(&overlap);
        assert!(
            of.iter().max() > of.iter().min().map(|least| least + 200).as_ref(),
            "the thumbnail has no light and no shadow"
        );
        assert_ne!(of, levels(&traced_picture("stained-glass").unwrap()));
        assert!(traced_picture("nothing").is_none());
    }

    #[test]
    fn thumbnails_come_one_after_the_other_and_stay() {
        let (ctx, wake): (_, Wake) = (egui::Context::default(), Arc::new(|| {}));
        let mut thumbnails = Thumbnails::default();
        let began = Instant::now();
        for name in ["overlap", "lantern-wall"] {
            while thumbnails.of(&ctx, name, &wake).is_none() {
                assert!(began.elapsed() < Duration::from_secs(120));
                std::thread::sleep(Duration::from_millis(2));
            }
        }
        let first = thumbnails.of(&ctx, "overlap", &wake).unwrap().id();
        assert_eq!(thumbnails.of(&ctx, "overlap", &wake).unwrap().id(), first);
        assert!(thumbnails.pending.is_none());
    }
}
