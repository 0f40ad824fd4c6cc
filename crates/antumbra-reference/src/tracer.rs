//! The tracer: built once per scene, then queried for receivers and visibility.

use std::cell::RefCell;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use antumbra_light::Light;
use antumbra_scene::{Camera, Scene};
use glam::{DVec3, UVec2, Vec2, Vec3};
use rayon::prelude::*;
use web_time::Instant;

use crate::geometry::{Geometry, Triangle};
use crate::lanes::Simd;
use crate::planes::RayFrame;
use crate::ray::{AnyHit, ClosestHit, Hit};
use crate::receivers::{ReceiverPoint, Receivers};
use crate::sampled_light::{BUNDLE, FAR, SampledLight, TILE};
use crate::shaft::Shaft;
use crate::tree::{Child, Tree};
use crate::visibility::{VisibilityImage, VisibilityOptions};
use crate::walk::{BlockedWalk, Scratch, TranslucentWalk};
use crate::{Progress, ReferenceError};

/// Ray tracer of a scene. It copies what it needs, so the scene may be dropped.
#[derive(Clone, Debug)]
pub struct Tracer {
    geometry: Geometry,
    blockers: Tree,
    translucents: Tree,
    homes: InstanceBlocks,
    simd: Simd,
}

/// Side of the pixel square that a worker takes at a time: its receivers share occluders and nodes.
const WORK_SQUARE_PX: u32 = 16;
/// Number of points of a list that a worker takes at a time.
const WORK_POINTS: usize = 256;

impl Tracer {
    /// Collects every triangle of the scene's instances and builds the trees.
    ///
    /// # Errors
    /// A mesh, material, image or vertex that the scene refers to is missing, or a world position is not finite.
    pub fn new(scene: &Scene) -> Result<Self, ReferenceError> {
        let geometry = Geometry::new(scene)?;
        let blockers = Tree::new(&geometry.blockers, true);
        // Each translucent triangle counts once, so none may be in two leaves.
        let translucents = Tree::new(&geometry.translucents, false);
        let homes = InstanceBlocks::new(&geometry.blockers, &blockers);
        Ok(Self { geometry, blockers, translucents, homes, simd: Simd::detect() })
    }

    /// Returns the tracer with the processor's baseline instructions.
    #[cfg(test)]
    pub(crate) fn portable(&self) -> Self {
        Self { simd: Simd::Portable, ..self.clone() }
    }

    #[cfg(test)]
    pub(crate) fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Number of triangles that can block light: those without area or fully masked away are not counted.
    pub fn triangle_count(&self) -> usize {
        self.geometry.blockers.len() + self.geometry.translucents.len()
    }

    /// Number of channels of visibility: 3 if occluders tint, else 1.
    pub fn channels(&self) -> u32 {
        if self.geometry.surfaces.tint { 3 } else { 1 }
    }

    /// Finds the first surface through each pixel's centre, beyond the camera's near plane. Rays pass through the holes of
    /// alpha masks; translucent surfaces count as surfaces, however clear.
    pub fn primary(&self, camera: &Camera, size_px: UVec2) -> Receivers {
        Receivers { size_px, points: self.primary_in_rows(camera, size_px, 0..size_px.y) }
    }

    /// [`Self::primary`] for a range of rows, counted from the top: `size_px.x · rows.len()` points. For callers with little
    /// time per call.
    pub fn primary_in_rows(&self, camera: &Camera, size_px: UVec2, rows: Range<u32>) -> Vec<Option<ReceiverPoint>> {
        let forward = (camera.target - camera.eye).normalize();
        let rows: Vec<Vec<Option<ReceiverPoint>>> = rows
            .into_par_iter()
            .map(|y| {
                let pixel = |x: u32| {
                    let direction = camera.ray_direction(size_px, Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                    let t_min = f64::from(camera.near_m) / f64::from(direction.dot(forward));
                    self.first_hit(camera.eye, direction, t_min)
                };
                (0..size_px.x).map(pixel).collect()
            })
            .collect();
        rows.into_iter().flatten().collect()
    }

    /// Finds the first surface from the world position `origin` along `direction` (unit), at least `t_min_m` metres away.
    pub fn first_hit(&self, origin: Vec3, direction: Vec3, t_min_m: f64) -> Option<ReceiverPoint> {
        let frame = RayFrame::single(origin.to_array(), direction.as_dvec3().to_array(), true);
        let shaft = Shaft::single(origin.to_array(), direction.to_array(), FAR);
        let mut best = None;
        STACK.with_borrow_mut(|stack| {
            let geometry = &self.geometry;
            let lists = [(&geometry.blockers, &self.blockers), (&geometry.translucents, &self.translucents)];
            for (triangles, tree) in lists {
                best =
                    self.simd.run(ClosestHit { geometry, triangles, tree, frame, shaft, t_min: t_min_m, best, stack });
            }
        });
        best.map(|hit| self.receiver_of(&hit, direction))
    }

    fn receiver_of(&self, hit: &Hit, direction: Vec3) -> ReceiverPoint {
        let list = if hit.translucent { &self.geometry.translucents } else { &self.geometry.blockers };
        let triangle = &list[hit.triangle as usize];
        let corners = triangle.corners.map(Vec3::as_dvec3);
        let position = (0..3).map(|k| corners[k] * hit.weights[k]).sum::<DVec3>();
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        let normal = if normal.dot(direction.as_dvec3()) > 0.0 { -normal } else { normal };
        let largest = corners.iter().map(|c| c.length()).fold(0.0, f64::max);
        let point = ReceiverPoint::on_triangle(position.as_vec3(), normal.as_vec3(), largest as f32);
        ReceiverPoint { instance: triangle.instance, triangle: triangle.index, ..point }
    }

    /// Whether an opaque or masked triangle lies between two world positions. Translucent ones do not block.
    ///
    /// The segment starts exactly at `origin`: for a start on a surface, use [`ReceiverPoint::origin`].
    pub fn occluded(&self, origin: Vec3, target: Vec3) -> bool {
        let vector = (target.as_dvec3() - origin.as_dvec3()).to_array();
        self.any_hit(origin, vector, false)
    }

    /// Whether an opaque or masked triangle lies along `direction` from `origin`, at any distance.
    pub fn occluded_towards(&self, origin: Vec3, direction: Vec3) -> bool {
        self.any_hit(origin, direction.as_dvec3().to_array(), true)
    }

    fn any_hit(&self, origin: Vec3, vector: [f64; 3], distant: bool) -> bool {
        let frame = RayFrame::single(origin.to_array(), vector, distant);
        let shaft = Shaft::single(origin.to_array(), vector.map(|v| v as f32), if distant { FAR } else { 1.0 });
        let (geometry, tree) = (&self.geometry, &self.blockers);
        STACK.with_borrow_mut(|stack| self.simd.run(AnyHit { geometry, tree, frame, shaft, stack }))
    }

    /// Traces the visibility of a light from each pixel, as `docs/formats.md` defines it.
    ///
    /// The result is deterministic: the same on every machine and for any number of threads. `progress` is called with
    /// rising fractions up to 1, from any thread but never concurrently.
    ///
    /// # Errors
    /// The light or the options are invalid, or `cancel` was set.
    pub fn visibility(
        &self,
        receivers: &Receivers,
        light: &Light,
        options: &VisibilityOptions,
        progress: Progress<'_>,
        cancel: &AtomicBool,
    ) -> Result<VisibilityImage, ReferenceError> {
        let start = Instant::now();
        let light = SampledLight::new(light, options)?;
        self.visibility_of_rows(receivers, 0..receivers.size_px.y, &light, progress, cancel, start)
    }

    /// [`Self::visibility`] for a range of rows, counted from the top, and a light that is already sampled: an image of
    /// `rows.len()` rows. For callers with little time per call.
    ///
    /// # Errors
    /// `cancel` was set.
    pub fn visibility_in_rows(
        &self,
        receivers: &Receivers,
        rows: Range<u32>,
        light: &SampledLight,
        cancel: &AtomicBool,
    ) -> Result<VisibilityImage, ReferenceError> {
        self.visibility_of_rows(receivers, rows, light, &|_| {}, cancel, Instant::now())
    }

    fn visibility_of_rows(
        &self,
        receivers: &Receivers,
        rows: Range<u32>,
        light: &SampledLight,
        progress: Progress<'_>,
        cancel: &AtomicBool,
        start: Instant,
    ) -> Result<VisibilityImage, ReferenceError> {
        let width = receivers.size_px.x;
        let rows = rows.start..rows.end.min(receivers.size_px.y);
        let size = UVec2::new(width, rows.len() as u32);
        let squares = size.map(|n| n.div_ceil(WORK_SQUARE_PX));
        let first_row = rows.start;
        let work = (0..(squares.x * squares.y) as usize).map(|square| {
            let corner = UVec2::new(square as u32 % squares.x, square as u32 / squares.x) * WORK_SQUARE_PX;
            let end = (corner + WORK_SQUARE_PX).min(size);
            let pixels = move |y: u32| (corner.x..end.x).map(move |x| ((first_row + y) * width + x) as usize);
            (corner.y..end.y).flat_map(pixels)
        });
        let all = &receivers.points;
        self.visibility_of(all, (first_row * width) as usize, size, light, work.collect(), progress, cancel, start)
    }

    /// Traces the visibility of a light from each of a list of points. Point i uses the light points of pixel i.
    ///
    /// # Errors
    /// As [`Self::visibility`].
    pub fn visibility_at(
        &self,
        points: &[ReceiverPoint],
        light: &Light,
        options: &VisibilityOptions,
        progress: Progress<'_>,
        cancel: &AtomicBool,
    ) -> Result<VisibilityImage, ReferenceError> {
        let start = Instant::now();
        let light = SampledLight::new(light, options)?;
        let points: Vec<Option<ReceiverPoint>> = points.iter().copied().map(Some).collect();
        let size = UVec2::new(points.len() as u32, 1);
        let work = (0..points.len()).step_by(WORK_POINTS).map(|i| i..(i + WORK_POINTS).min(points.len()));
        self.visibility_of(&points, 0, size, &light, work.collect(), progress, cancel, start)
    }

    /// Traces the visibility of the light's centre, a hard shadow: 0, 1, or a transmittance.
    ///
    /// # Errors
    /// As [`Self::visibility`].
    pub fn hard_visibility(
        &self,
        receivers: &Receivers,
        light: &Light,
        progress: Progress<'_>,
        cancel: &AtomicBool,
    ) -> Result<VisibilityImage, ReferenceError> {
        // A light of no size, whose points are all its centre, so that the emission texture has no effect.
        let mut center = Light { emission: None, ..light.scaled(0.0) };
        if let antumbra_light::LightShape::Points { positions_m } = &mut center.shape {
            positions_m.truncate(1);
        }
        let options = VisibilityOptions { samples: 1, same_set_for_all_pixels: true, ..VisibilityOptions::default() };
        self.visibility(receivers, &center, &options, progress, cancel)
    }

    /// Bit mask of the light points of receiver `index` that `point` sees: bit `i % 64` of word `i / 64` is point `i` of
    /// [`SampledLight::points_for`]. Only opaque and masked triangles hide a light point here. All bits are 0 if the light
    /// does not reach the receiver.
    pub fn visible_mask(&self, light: &SampledLight, index: usize, point: &ReceiverPoint) -> Vec<u64> {
        let mut words = vec![0u64; (light.points as usize).div_ceil(64)];
        if !light.light.reaches(&light.frame, point.position) {
            return words;
        }
        let pattern = &light.patterns[light.pattern_index(index)];
        let mut scratch = Scratch::default();
        let frame = light.ray_frame(point.origin(), point.position);
        for (bundle, slots) in pattern.bundles.iter().zip(pattern.order.chunks(TILE * BUNDLE)) {
            let (geometry, tree) = (&self.geometry, &self.blockers);
            let walk =
                BlockedWalk { geometry, tree, frame, bundle, axes: light.axes, first: None, scratch: &mut scratch };
            let blocked = self.simd.run(walk).bits;
            for (slot, &i) in slots.iter().enumerate() {
                let visible = !blocked[slot / TILE] >> (slot % TILE) & 1;
                words[i as usize / 64] |= visible << (i % 64);
            }
        }
        words
    }

    /// Traces the pixels that `work` lists. The result has `size_px` pixels, of which the first has index `first` in `points`.
    fn visibility_of<W: Iterator<Item = usize> + Clone + Send + Sync>(
        &self,
        points: &[Option<ReceiverPoint>],
        first: usize,
        size_px: UVec2,
        light: &SampledLight,
        work: Vec<W>,
        progress: Progress<'_>,
        cancel: &AtomicBool,
        start: Instant,
    ) -> Result<VisibilityImage, ReferenceError> {
        let done = Mutex::new(0usize);
        let parts: Vec<Vec<Resolved>> = work
            .par_iter()
            .map_init(Scratch::default, |scratch, indices| {
                let mut part = Vec::new();
                for i in indices.clone() {
                    if cancel.load(Ordering::Relaxed) {
                        return Err(ReferenceError::Cancelled);
                    }
                    part.push(points[i].map_or(Resolved::BACKGROUND, |point| self.resolve(light, i, &point, scratch)));
                }
                let mut done = done.lock().expect("no holder of the lock panics but by the caller's own hand");
                *done += 1;
                progress(*done as f32 / work.len() as f32);
                Ok(part)
            })
            .collect::<Result<_, _>>()?;

        let mut image = VisibilityImage {
            size_px,
            channels: self.channels(),
            values: vec![[1.0; 3]; (size_px.x * size_px.y) as usize],
            faces_light_center: vec![false; (size_px.x * size_px.y) as usize],
            ..VisibilityImage::default()
        };
        for (indices, part) in work.into_iter().zip(parts) {
            for (i, resolved) in indices.zip(part) {
                image.values[i - first] = resolved.value;
                image.faces_light_center[i - first] = resolved.faces_light_center;
                image.rays += u64::from(resolved.rays);
                image.rays_without_walk += u64::from(resolved.rays_without_walk);
            }
        }
        image.seconds = start.elapsed().as_secs_f64();
        Ok(image)
    }

    fn resolve(&self, light: &SampledLight, index: usize, point: &ReceiverPoint, scratch: &mut Scratch) -> Resolved {
        if !light.light.reaches(&light.frame, point.position) {
            return Resolved { value: [0.0; 3], ..Resolved::BACKGROUND };
        }
        let pattern = &light.patterns[light.pattern_index(index)];
        let frame = light.ray_frame(point.origin(), point.position);
        let cosine = point.normal.as_dvec3().dot(DVec3::from(frame.to_center));
        // A surface that faces away shadows itself: its own triangle is the likeliest occluder.
        let first = if cosine < 0.0 { self.homes.block_of(point) } else { None };
        let mut resolved = Resolved { faces_light_center: cosine > 0.0, rays: light.points, ..Resolved::BACKGROUND };
        let mut sum = DVec3::ZERO;
        for bundle in &pattern.bundles {
            let geometry = &self.geometry;
            let axes = light.axes;
            let walk = BlockedWalk { geometry, tree: &self.blockers, frame, bundle, axes, first, scratch };
            let blocked = self.simd.run(walk);
            if blocked.without_walk {
                resolved.rays_without_walk += bundle.valid.iter().map(|bits| bits.count_ones()).sum::<u32>();
            }
            let open: [u64; BUNDLE] = std::array::from_fn(|i| bundle.valid[i] & !blocked.bits[i]);
            if self.geometry.translucents.is_empty() {
                sum += DVec3::splat(weight_of(light, bundle, &open));
            } else if open != [0; BUNDLE] {
                let mut transmittance = vec![Vec3::ONE; TILE * bundle.tiles.len()];
                let tree = &self.translucents;
                let transmittance = &mut transmittance[..];
                self.simd.run(TranslucentWalk { geometry, tree, frame, bundle, axes, scratch, open, transmittance });
                for (i, (bits, tile)) in open.iter().zip(&bundle.tiles).enumerate() {
                    for k in (0..TILE).filter(|k| bits >> k & 1 == 1) {
                        sum += transmittance[TILE * i + k].as_dvec3() * f64::from(tile.weight[k]);
                    }
                }
            }
        }
        if pattern.total_weight > 0.0 {
            resolved.value = (sum / pattern.total_weight).as_vec3().to_array();
        } else {
            resolved.value = [0.0; 3];
        }
        resolved
    }
}

thread_local! {
    static STACK: RefCell<Vec<(f32, Child)>> = const { RefCell::new(Vec::new()) };
}

/// Sum of the weights of a bundle's visible light points.
fn weight_of(light: &SampledLight, bundle: &crate::sampled_light::Bundle, open: &[u64; BUNDLE]) -> f64 {
    if !light.weighted {
        return f64::from(open.iter().map(|bits| bits.count_ones()).sum::<u32>());
    }
    let tile_weight = |(bits, tile): (&u64, &crate::sampled_light::Tile)| {
        (0..TILE).filter(|k| bits >> k & 1 == 1).map(|k| f64::from(tile.weight[k])).sum::<f64>()
    };
    open.iter().zip(&bundle.tiles).map(tile_weight).sum()
}

/// Result for one receiver.
#[derive(Clone, Copy, Debug)]
struct Resolved {
    value: [f32; 3],
    faces_light_center: bool,
    rays: u32,
    rays_without_walk: u32,
}

impl Resolved {
    const BACKGROUND: Self = Self { value: [1.0; 3], faces_light_center: false, rays: 0, rays_without_walk: 0 };
}

/// Map from an instance's triangle to its block.
#[derive(Clone, Debug, Default)]
struct InstanceBlocks {
    /// `(instance, triangle)` of each blocker, sorted, with its block.
    entries: Vec<(u32, u32, u32)>,
}

impl InstanceBlocks {
    fn new(triangles: &[Triangle], tree: &Tree) -> Self {
        let mut block_of = vec![u32::MAX; triangles.len()];
        for (block, i) in tree.blocks.iter().zip(0u32..) {
            for triangle in block.triangles() {
                block_of[*triangle as usize] = i;
            }
        }
        let mut entries: Vec<_> =
            triangles.iter().zip(block_of).map(|(t, block)| (t.instance, t.index, block)).collect();
        entries.sort_unstable();
        Self { entries }
    }

    fn block_of(&self, point: &ReceiverPoint) -> Option<u32> {
        let key = (point.instance, point.triangle);
        let found = self.entries.binary_search_by_key(&key, |e| (e.0, e.1)).ok()?;
        Some(self.entries[found].2)
    }
}
