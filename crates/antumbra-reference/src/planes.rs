//! The triangle test: four planes through the rays' common origin.
//!
//! All shadow rays of a receiver start at one point `o`, so a triangle's part in the test can be worked out once and
//! used for every light point. With the corners relative to the origin, `a, b, c`, the segment `o + t·d` meets the
//! triangle's interior where `d` has the same sign against the three planes through `o` and an edge (Plücker
//! coordinates with a shared origin; Davidovič, Engelhardt, Georgiev, Slusallek and Dachsbacher, "3D Rasterization: A
//! Bridge between Rasterization and Ray Tracing", Graphics Interface 2012, sec. 3):
//!
//! ```text
//! n_a = 2 b×c = (b−c)×(b+c)      n_b = 2 c×a = (c−a)×(c+a)      n_c = 2 a×b = (a−b)×(a+b)
//! n   = (b−a)×(c−a)              T   = a·n                      t   = T / (d·n)
//! hit ⟺ s n_a·d ≥ 0,  s n_b·d ≥ 0,  s n_c·d ≥ 0,  s d·n > s T / t_max,        s = sign T
//! ```
//!
//! Multiplying by `s` makes the test two-sided: FORMATS.md blocks whichever way a triangle faces.
//!
//! A light point is `d = d₀ + α·e₁ + β·e₂ + γ·e₃` in the light's frame about its centre, so each plane becomes four
//! numbers, `n·d₀, n·e₁, n·e₂, n·e₃`, and a test of one light point is two fused multiply-adds a plane (three for a
//! light with volume).
//!
//! **Precision.** The planes are made in double precision from single-precision corners and then rounded. So the sign
//! of `T`, which says on which side of the triangle the receiver lies, is right to 2⁻⁵⁰ of the corners' distance, and
//! the start of a segment need only clear the rounding of its own position (see `receivers.rs`).
//!
//! **Watertightness.** The form `(b−c)×(b+c)` changes its sign exactly when `b` and `c` change places, whatever the
//! rounding, and so do all sums after it. Two triangles that share an edge therefore see opposite values for every
//! light point, and at least one of them counts it: no light leaks between them. (Davidovič et al. sec. 3.2; Woop,
//! Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2013, argue the same for their scaled form.)

/// Triangles tested together: one per lane.
pub(crate) const LANES: usize = 8;

/// Eight triangles, corner by corner.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Block {
    /// World positions, `[corner][axis][lane]`, metres. Unused lanes repeat a single point, which nothing can hit.
    pub(crate) corners: [[[f32; LANES]; 3]; 3],
    /// Index of the triangle in the geometry that the blocks were made from.
    pub(crate) triangle: [u32; LANES],
}

/// Where segments start, and the frame in which their ends are given: `d = to_center + α·e₁ + β·e₂ + γ·e₃`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayFrame {
    /// World position, metres.
    pub(crate) origin: [f32; 3],
    /// From the origin to the light's centre, metres; towards it, for a distant light.
    pub(crate) to_center: [f64; 3],
    /// Right, up and axis.
    pub(crate) axes: [[f64; 3]; 3],
    /// `1/t_max`: how much of T the segment must exceed. 0 for a distant light.
    pub(crate) inverse_end: f64,
}

/// Segments end this fraction short of the light, so that a lamp's own glowing panel in the plane of the light is not
/// in its way: light points and planes are rounded to 2⁻²⁴, and a dozen such errors add up to less than this.
pub(crate) const END_MARGIN: f64 = 1.0 / (1 << 20) as f64;

impl RayFrame {
    /// A single segment from `origin` along `vector`, whole (`distant` false) or without end.
    pub(crate) fn single(origin: [f32; 3], vector: [f64; 3], distant: bool) -> Self {
        let inverse_end = if distant { 0.0 } else { 1.0 + END_MARGIN };
        Self { origin, to_center: vector, axes: [[0.0; 3]; 3], inverse_end }
    }
}

/// The planes of eight triangles, `[plane][term][lane]`. The first three planes are those of corners a, b, c: where
/// they are not negative, they are proportional to the barycentric weights. The last is `s (T/t_max − n·d)`: negative
/// where the triangle's plane lies within the segment. Terms are those of `d`: constant, α, β, γ.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Planes {
    /// The numbers.
    pub(crate) coefficients: [[[f32; LANES]; 4]; 4],
}

impl Planes {
    pub(crate) const ZERO: Self = Self { coefficients: [[[0.0; LANES]; 4]; 4] };

    /// The planes of `block` for rays of `frame`, whose light extends along `axes` of its axes: 0 for a single ray,
    /// 2 for a flat light, 3 for one with volume. Terms beyond are left as they are.
    #[inline(always)]
    pub(crate) fn set(&mut self, block: &Block, frame: &RayFrame, axes: usize) {
        let origin = frame.origin.map(f64::from);
        for lane in 0..LANES {
            let corner = |i: usize| {
                let at = &block.corners[i];
                [
                    f64::from(at[0][lane]) - origin[0],
                    f64::from(at[1][lane]) - origin[1],
                    f64::from(at[2][lane]) - origin[2],
                ]
            };
            let (a, b, c) = (corner(0), corner(1), corner(2));
            let n = cross(sub(b, a), sub(c, a));
            let t = dot(a, n);
            let s = if t > 0.0 { 1.0 } else { -1.0 };
            let normals = [cross(sub(b, c), add(b, c)), cross(sub(c, a), add(c, a)), cross(sub(a, b), add(a, b))];
            for (plane, normal) in normals.into_iter().enumerate() {
                self.coefficients[plane][0][lane] = (s * dot(normal, frame.to_center)) as f32;
                for axis in 0..axes {
                    self.coefficients[plane][1 + axis][lane] = (s * dot(normal, frame.axes[axis])) as f32;
                }
            }
            // An origin in the plane itself sees the triangle edge-on: no hit. 1 is positive, so nothing passes.
            let end = s * (t * frame.inverse_end - dot(n, frame.to_center));
            self.coefficients[3][0][lane] = if t == 0.0 { 1.0 } else { end as f32 };
            for axis in 0..axes {
                let slope = -s * dot(n, frame.axes[axis]);
                self.coefficients[3][1 + axis][lane] = if t == 0.0 { 0.0 } else { slope as f32 };
            }
        }
    }
}

#[inline(always)]
fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
