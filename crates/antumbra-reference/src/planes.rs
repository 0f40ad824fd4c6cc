//! Triangle test with four planes through the rays' common origin.
//!
//! All shadow rays of a receiver start at one point `o`, so the part of the test that depends on the triangle is computed
//! once and used for every light point. With the corners relative to the origin, `a, b, c`, the segment `o + t·d` meets
//! the triangle's interior where `d` has the same sign against the three planes through `o` and an edge (Plücker
//! coordinates with a shared origin; Davidovič, Engelhardt, Georgiev, Slusallek and Dachsbacher, "3D Rasterization: A
//! Bridge between Rasterization and Ray Tracing", Graphics Interface 2012, sec. 3):
//!
//! ```text
//! n_a = 2 b×c = (b−c)×(b+c)      n_b = 2 c×a = (c−a)×(c+a)      n_c = 2 a×b = (a−b)×(a+b)
//! n   = (b−a)×(c−a)              T   = a·n                      t   = T / (d·n)
//! hit ⟺ s n_a·d ≥ 0,  s n_b·d ≥ 0,  s n_c·d ≥ 0,  s d·n > s T / t_max,        s = sign T
//! ```
//!
//! Multiplying by `s` makes the test two-sided: a segment is blocked whichever way a triangle faces (`docs/formats.md`).
//!
//! A light point is `d = d₀ + α·e₁ + β·e₂ + γ·e₃` in the light's frame about its centre. Each plane thus becomes four
//! numbers, `n·d₀, n·e₁, n·e₂, n·e₃`, and a test of one light point takes two fused multiply-adds per plane (three for a
//! light with volume).
//!
//! **Precision.** The planes are computed in double precision from single-precision corners and then rounded. The sign of
//! `T`, the receiver's side of the triangle, is therefore right to 2⁻⁵⁰ of the corners' distance, and the start of a
//! segment need only exceed the rounding of its own position (see `receivers.rs`).
//!
//! **Watertightness.** The form `(b−c)×(b+c)` changes its sign exactly when `b` and `c` are swapped, whatever the
//! rounding, and so do all sums after it. Two triangles that share an edge therefore get opposite values for every
//! light point, and at least one of them counts it: no light leaks between them. (Davidovič et al. sec. 3.2; Woop,
//! Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2013, argue the same for their scaled form.)

use crate::lanes::{Doubles, Lanes};

/// Number of triangles tested together, one per lane.
pub(crate) const LANES: usize = 8;

/// Block of up to eight triangles.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Block {
    /// World positions, `[corner][axis][lane]`, metres. Unused lanes repeat the first.
    pub(crate) corners: [[[f32; LANES]; 3]; 3],
    /// Index of the triangle in the geometry that the blocks were made from; unused lanes repeat the first.
    pub(crate) triangle: [u32; LANES],
    /// Largest absolute coordinate of any edge of the triangle, metres.
    pub(crate) extent: [f32; LANES],
    /// Number of lanes used, from the first.
    pub(crate) count: u32,
}

impl Block {
    /// Bit mask of the used lanes: bit k is lane k.
    #[inline(always)]
    pub(crate) fn present(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// Bit mask of the lanes that a single ray along `vector` may meet, by the signs of the edge planes in single precision.
    ///
    /// Triangles whose planes certainly differ in sign are left out; [`Planes`] decides about the rest. With `u = 2⁻²⁴`, edges
    /// no longer than `e` per axis, corners no further than `m`, and `|d| ≤ δ` per axis, the errors are: `u e` for an edge,
    /// `4 u m` for a sum of corners, `20 u e m` for a normal, and `100 u e m δ` for its product with `d`.
    #[inline(always)]
    pub(crate) fn may_meet<L: Lanes>(&self, origin: &[f32; 3], vector: &[f32; 3]) -> u32 {
        // Plain arrays and no closures, because code that is not inlined here is not compiled for the instruction set.
        let corner = [load3::<L>(&self.corners[0]), load3::<L>(&self.corners[1]), load3::<L>(&self.corners[2])];
        let o = splat3::<L>(origin);
        let from_origin = [sub3(corner[0], o), sub3(corner[1], o), sub3(corner[2], o)];
        let d = splat3::<L>(vector);
        let sides = [
            side(sub3(corner[1], corner[2]), add3(from_origin[1], from_origin[2]), d),
            side(sub3(corner[2], corner[0]), add3(from_origin[2], from_origin[0]), d),
            side(sub3(corner[0], corner[1]), add3(from_origin[0], from_origin[1]), d),
        ];
        let longest = vector[0].abs().max(vector[1].abs()).max(vector[2].abs());
        let extent = L::load(&self.extent);
        let [x, y, z] = from_origin[0];
        let error = x.abs().max(y.abs()).max(z.abs()).add(extent).mul(extent).mul(L::splat(longest * SIDE_ERROR));
        let least = sides[0].min(sides[1]).min(sides[2]).add(error);
        let most = error.sub(sides[0].max(sides[1]).max(sides[2]));
        // Negative `least`: some plane is certainly negative. Negative `most`: some plane is certainly positive.
        !(least.signs() & most.signs()) & self.present()
    }
}

/// Relative error of an edge plane's product: 100 · 2⁻²⁴, rounded up to a power of two.
const SIDE_ERROR: f32 = 1.0 / (1 << 17) as f32;

/// Start of segments, and the frame in which their ends are given: `d = to_center + α·e₁ + β·e₂ + γ·e₃`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayFrame {
    /// World position of the start, metres.
    pub(crate) origin: [f32; 3],
    /// Vector from the origin to the light's centre, metres; the direction towards it, for a distant light.
    pub(crate) to_center: [f64; 3],
    /// Axes of the light's frame: right, up and axis.
    pub(crate) axes: [[f64; 3]; 3],
    /// `1/t_max`, the factor of T that the segment must exceed. 0 for a distant light.
    pub(crate) inverse_end: f64,
}

/// Fraction by which segments end short of the light, so that a lamp's glowing panel in the plane of the light does not
/// block it. Light points and planes are rounded to 2⁻²⁴, and a dozen such errors are less than this.
pub(crate) const END_MARGIN: f64 = 1.0 / (1 << 20) as f64;

impl RayFrame {
    /// Frame of a single ray from `origin` along `vector`: the whole segment, or an endless ray if `distant`.
    pub(crate) fn single(origin: [f32; 3], vector: [f64; 3], distant: bool) -> Self {
        let inverse_end = if distant { 0.0 } else { 1.0 + END_MARGIN };
        Self { origin, to_center: vector, axes: [[0.0; 3]; 3], inverse_end }
    }
}

/// Planes of eight triangles, `[plane][term][lane]`. The first three planes are those of corners a, b, c: if they are not
/// negative, they are proportional to the barycentric weights. The last is `s (T/t_max − n·d)`, negative if the triangle's
/// plane lies within the segment. The terms are those of `d`: constant, α, β, γ.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Planes {
    /// Coefficients.
    pub(crate) coefficients: [[[f32; LANES]; 4]; 4],
}

impl Planes {
    pub(crate) const ZERO: Self = Self { coefficients: [[[0.0; LANES]; 4]; 4] };

    /// Sets the planes of `block` for rays of `frame`. The light extends along `AXES` of the frame's axes: 0 for a single ray,
    /// 2 for a flat light, 3 for one with volume. Further terms and lanes stay unchanged.
    #[inline(always)]
    pub(crate) fn set<L: Lanes, const AXES: usize>(&mut self, block: &Block, frame: &RayFrame) {
        self.set_half::<L::Doubles, AXES>(block, frame, 0);
        // Half a block fills one vector of doubles, which suffices for most blocks.
        if block.count as usize > LANES / 2 {
            self.set_half::<L::Doubles, AXES>(block, frame, 1);
        }
    }

    #[inline(always)]
    fn set_half<D: Doubles, const AXES: usize>(&mut self, block: &Block, frame: &RayFrame, half: usize) {
        let o = &frame.origin;
        let origin = [D::splat(f64::from(o[0])), D::splat(f64::from(o[1])), D::splat(f64::from(o[2]))];
        let a = sub(corner::<D>(&block.corners[0], half), origin);
        let b = sub(corner::<D>(&block.corners[1], half), origin);
        let c = sub(corner::<D>(&block.corners[2], half), origin);
        let n = cross(sub(b, a), sub(c, a));
        let t = dot(a, n);
        let normals = [cross(sub(b, c), add(b, c)), cross(sub(c, a), add(c, a)), cross(sub(a, b), add(a, b))];
        let to_center = splat(&frame.to_center);
        for (plane, &normal) in normals.iter().enumerate() {
            dot(normal, to_center).flip(t).store(half_of(&mut self.coefficients[plane][0], half));
        }
        // An origin in the plane itself sees the triangle edge-on: no hit.
        let end = t.mul(D::splat(frame.inverse_end)).sub(dot(n, to_center)).flip(t).unless_zero(t, D::splat(NEVER));
        end.store(half_of(&mut self.coefficients[3][0], half));
        for axis in 0..AXES {
            let e = splat(&frame.axes[axis]);
            for (plane, &normal) in normals.iter().enumerate() {
                dot(normal, e).flip(t).store(half_of(&mut self.coefficients[plane][1 + axis], half));
            }
            D::splat(0.0).sub(dot(n, e)).flip(t).store(half_of(&mut self.coefficients[3][1 + axis], half));
        }
    }
}

/// Constant of the last plane that no other term outweighs: it is positive, so nothing is hit.
const NEVER: f64 = 1e30;

/// Returns four of eight lanes.
#[inline(always)]
fn half_of(values: &mut [f32; LANES], half: usize) -> &mut [f32; 4] {
    (&mut values[4 * half..4 * half + 4]).try_into().expect("half of eight")
}

#[inline(always)]
fn corner<D: Doubles>(axes: &[[f32; LANES]; 3], half: usize) -> [D; 3] {
    let load =
        |values: &[f32; LANES]| -> D { D::load(values[4 * half..4 * half + 4].try_into().expect("half of eight")) };
    [load(&axes[0]), load(&axes[1]), load(&axes[2])]
}

#[inline(always)]
fn splat<D: Doubles>(v: &[f64; 3]) -> [D; 3] {
    [D::splat(v[0]), D::splat(v[1]), D::splat(v[2])]
}

#[inline(always)]
fn load3<L: Lanes>(axes: &[[f32; LANES]; 3]) -> [L; 3] {
    [L::load(&axes[0]), L::load(&axes[1]), L::load(&axes[2])]
}

#[inline(always)]
fn splat3<L: Lanes>(v: &[f32; 3]) -> [L; 3] {
    [L::splat(v[0]), L::splat(v[1]), L::splat(v[2])]
}

#[inline(always)]
fn sub3<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0].sub(b[0]), a[1].sub(b[1]), a[2].sub(b[2])]
}

#[inline(always)]
fn add3<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0].add(b[0]), a[1].add(b[1]), a[2].add(b[2])]
}

/// `(e × s) · d`
#[inline(always)]
fn side<L: Lanes>(e: [L; 3], s: [L; 3], d: [L; 3]) -> L {
    let x = e[1].mul(s[2]).sub(e[2].mul(s[1]));
    let y = e[2].mul(s[0]).sub(e[0].mul(s[2]));
    let z = e[0].mul(s[1]).sub(e[1].mul(s[0]));
    x.mul_add(d[0], y.mul_add(d[1], z.mul(d[2])))
}

#[inline(always)]
fn sub<D: Doubles>(a: [D; 3], b: [D; 3]) -> [D; 3] {
    [a[0].sub(b[0]), a[1].sub(b[1]), a[2].sub(b[2])]
}

#[inline(always)]
fn add<D: Doubles>(a: [D; 3], b: [D; 3]) -> [D; 3] {
    [a[0].add(b[0]), a[1].add(b[1]), a[2].add(b[2])]
}

#[inline(always)]
fn dot<D: Doubles>(a: [D; 3], b: [D; 3]) -> D {
    a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2]))
}

#[inline(always)]
fn cross<D: Doubles>(a: [D; 3], b: [D; 3]) -> [D; 3] {
    [a[1].mul(b[2]).sub(a[2].mul(b[1])), a[2].mul(b[0]).sub(a[0].mul(b[2])), a[0].mul(b[1]).sub(a[1].mul(b[0]))]
}
