//! Tests of the CPU reference against the definition, and of the GPU against the CPU reference.

use antumbra_light::{hash_u32, unit_f32};
use glam::UVec2;

use super::{DOUBLING_READS, Doubling, Scan, Source, SummedAreaTable, Sums, TableDesign, Tiling, cpu};
use crate::gpu::{Gpu, Recorder, Stage};
use crate::testing::{gpu, read_storage, read_texture};

/// Sizes around blocks and workgroups; the largest are tested once, because software adapters are slow.
const SIZES: [u32; 12] = [1, 2, 3, 15, 16, 17, 63, 64, 65, 255, 256, 1000];

fn random(i: u32, channel: u32) -> u32 {
    hash_u32(hash_u32(i) ^ (channel << 7))
}

fn integers(size: UVec2, bits: u32) -> Vec<[u32; 4]> {
    (0..size.x * size.y).map(|i| [0, 1, 2, 3].map(|c| random(i, c) >> (32 - bits))).collect()
}

fn texture(gpu: &Gpu, size: UVec2, format: wgpu::TextureFormat, texels: &[u8]) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test source"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(size.x * 16), rows_per_image: None };
    gpu.queue().write_texture(texture.as_image_copy(), texels, layout, texture.size());
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Returns the table of a source, computed by the GPU.
fn table(gpu: &Gpu, made: &mut SummedAreaTable, source: &[u8], size: UVec2, side: u32) -> Vec<u8> {
    made.prepare(&Stage::at_once(gpu), &texture(gpu, size, made.design.sums.format(), source), size, side);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    made.record(&mut Recorder::new(&mut encoder, None), "table", |_| ());
    gpu.queue().submit([encoder.finish()]);
    read_texture(gpu, &made.made.as_ref().expect("prepared").memory.texture, 0, size)
}

#[test]
fn cpu_reference_matches_the_definition() {
    let size = UVec2::new(7, 5);
    let values: Vec<u32> = (0..35).map(|i| random(i, 0) >> 20).collect();
    for tile in [2, 4, 8] {
        let table = cpu::build(&values, size, tile);
        for y in 0..size.y {
            for x in 0..size.x {
                let (left, top) = (x / tile * tile, y / tile * tile);
                let inside = (top..=y).flat_map(|v| (left..=x).map(move |u| (v * size.x + u) as usize));
                assert_eq!(table[(y * size.x + x) as usize], inside.map(|i| values[i]).sum::<u32>());
            }
        }
    }
}

#[test]
fn cpu_reference_chooses_the_largest_tile_that_holds() {
    // 2^20 per texel: 64² texels sum to exactly 2^32, one too many.
    let size = UVec2::splat(128);
    let mut values = vec![[1 << 20, 0, 0, 0]; 128 * 128];
    assert_eq!(cpu::chosen_tile(&values, size), 32);
    for value in values.iter_mut().step_by(64) {
        value[0] -= 1;
    }
    assert_eq!(cpu::chosen_tile(&values, size), 64);
    assert_eq!(cpu::chosen_tile(&vec![[1; 4]; 128 * 128], size), 128);
}

/// Sums that wrap: `Add` of plain integers panics on overflow in debug builds.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
struct Wrapping4([u32; 4]);

impl std::ops::Add for Wrapping4 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].wrapping_add(other.0[i])))
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sum4([f64; 4]);

impl std::ops::Add for Sum4 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

fn of(gpu: &Gpu, sums: Sums, scan: Scan, tiling: Tiling) -> SummedAreaTable {
    SummedAreaTable::new(gpu, TableDesign { sums, scan, tiling }, 0, &Source::Texture)
}

fn check_integer(gpu: &Gpu, made: &mut SummedAreaTable, size: UVec2, side: u32) {
    let values: Vec<Wrapping4> = integers(size, 22).into_iter().map(Wrapping4).collect();
    let had = table(gpu, made, bytemuck::cast_slice(&values), size, side);
    let want = cpu::build(&values, size, side);
    assert!(bytemuck::cast_slice::<u8, Wrapping4>(&had) == want, "{:?}, {side}, {size}", made.design);
}

#[test]
fn integer_tables_equal_the_cpu_reference_exactly() {
    let Some(gpu) = gpu() else { return };
    let sizes = || SIZES.map(UVec2::splat).into_iter().chain([UVec2::new(1, 40), UVec2::new(129, 16)]);
    for scan in [Scan::Blocks, Scan::Doubling] {
        let mut whole = of(gpu, Sums::Integer, scan, Tiling::Whole);
        let mut tiles = of(gpu, Sums::Integer, scan, Tiling::Tiles);
        for size in sizes() {
            check_integer(gpu, &mut whole, size, 1 << 30);
            check_integer(gpu, &mut tiles, size, 32);
        }
        for side in [16, 64, 128, 256] {
            check_integer(gpu, &mut tiles, UVec2::new(100, 77), side);
            check_integer(gpu, &mut tiles, UVec2::new(300, 513), side);
        }
    }
    check_integer(gpu, &mut of(gpu, Sums::Integer, Scan::Blocks, Tiling::Whole), UVec2::splat(4096), 1 << 30);
}

#[test]
#[ignore = "long"]
fn large_integer_tables_in_tiles_equal_the_cpu_reference_exactly() {
    let Some(gpu) = gpu() else { return };
    let mut tiles = of(gpu, Sums::Integer, Scan::Blocks, Tiling::Tiles);
    check_integer(gpu, &mut tiles, UVec2::splat(4095), 64);
    check_integer(gpu, &mut tiles, UVec2::splat(4096), 256);
}

#[test]
fn float_tables_equal_the_cpu_reference_to_1e_5() {
    let Some(gpu) = gpu() else { return };
    for scan in [Scan::Blocks, Scan::Doubling] {
        let mut made = of(gpu, Sums::Float, scan, Tiling::Whole);
        let most = if scan == Scan::Blocks { 4096 } else { 512 };
        for size in SIZES.into_iter().chain([most]).map(UVec2::splat).chain([UVec2::new(1, 40), UVec2::new(129, 16)]) {
            let values: Vec<[f32; 4]> =
                (0..size.x * size.y).map(|i| [0, 1, 2, 3].map(|c| unit_f32(random(i, c)))).collect();
            let had = table(gpu, &mut made, bytemuck::cast_slice(&values), size, 0);
            let exact: Vec<Sum4> = values.iter().map(|v| Sum4(v.map(f64::from))).collect();
            let want = cpu::build(&exact, size, 1 << 30);
            for (had, want) in bytemuck::cast_slice::<u8, [f32; 4]>(&had).iter().zip(&want) {
                for (had, want) in had.iter().zip(&want.0) {
                    let error = (f64::from(*had) - want).abs();
                    assert!(error <= 1e-5 * want.abs() + 1e-7, "{scan:?} {size}: {had} against {want}");
                }
            }
        }
    }
}

#[test]
fn the_gpu_chooses_the_cpu_reference_s_tile() {
    let Some(gpu) = gpu() else { return };
    let mut seen = std::collections::BTreeSet::new();
    let mut counts = std::collections::BTreeSet::new();
    for scan in [Scan::Blocks, Scan::Doubling] {
        let mut made = of(gpu, Sums::Integer, scan, Tiling::Chosen);
        for (size, bits) in
            [(40, 20), (512, 24), (512, 22), (512, 20), (500, 18), (512, 15), (512, 13), (300, 8), (1024, 14)]
        {
            let size = UVec2::splat(size);
            // The mean is ½, so a tile may be larger than the worst case allows; one corner is heavier than the rest.
            let mut values = integers(size, bits);
            values[..16].fill([(1 << bits) - 1; 4]);
            let side = cpu::chosen_tile(&values, size);
            seen.insert(side);
            let values: Vec<Wrapping4> = values.into_iter().map(Wrapping4).collect();
            let had = table(gpu, &mut made, bytemuck::cast_slice(&values), size, 0);
            assert!(
                bytemuck::cast_slice::<u8, Wrapping4>(&had) == cpu::build(&values, size, side),
                "{scan:?}, {size}, {bits} bits: the twin's tile is {side}"
            );
            let largest: Vec<u32> = read_storage(gpu, made.largest().expect("prepared"));
            assert!(f32::from_bits(largest[0]) > 0.0);
            if scan == Scan::Doubling {
                let passes = 2 * side.ilog2().div_ceil(DOUBLING_READS.ilog2());
                assert_eq!(passes_done(gpu, &made), passes, "{size}, {bits} bits, tiles of {side}");
                counts.insert(passes);
            }
        }
    }
    assert!(seen.len() >= 4, "the cases differ too little: {seen:?}");
    assert_eq!(counts.into_iter().collect::<Vec<_>>(), [4, 6]);
}

/// Returns the number of doubling steps that the GPU has run.
fn passes_done(gpu: &Gpu, table: &SummedAreaTable) -> u32 {
    let made = table.made.as_ref().expect("prepared");
    let (Some(late), Some(dispatch)) = (&made.late, &made.memory.late_dispatch) else { return made.steps.len() as u32 };
    let groups: Vec<u32> = read_storage(gpu, dispatch);
    (if groups[0] * groups[1] > 0 { made.steps.len() } else { late.first }) as u32
}

/// Shen et al. 2013, table 2: passes for one table of 512² to 4096², and for tiles of 64².
#[test]
fn doubling_takes_the_paper_s_passes() {
    for (size, whole) in [(512, 6), (1024, 8), (2048, 8), (4096, 8)] {
        let size = UVec2::splat(size);
        let count = |side| Doubling::of(size, side).strides.len();
        assert_eq!((count(size.x), count(64)), (whole, 4), "{size}");
        let chosen = Doubling::of(size, 0);
        assert_eq!((chosen.strides.len(), chosen.late_count), (6, 2), "{size}");
    }
}
