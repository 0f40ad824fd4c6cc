//! Neighbours against those known from a mesh's construction.

use glam::{Vec2, Vec3};

use super::CasterTriangles;
use crate::contract::MeshCaster;
use crate::gpu::{Gpu, Recorder, Stage};
use crate::testing::{Mesh, gpu, read_storage};

const NO_NEIGHBOUR: u32 = u32::MAX;

/// Corners and neighbours, triangle by triangle.
struct Gathered {
    corners: Vec<[Vec3; 3]>,
    neighbours: Vec<[u32; 3]>,
}

fn gathered(gpu: &Gpu, casters: &[MeshCaster<'_>]) -> Gathered {
    let mut triangles = CasterTriangles::new(gpu);
    triangles.prepare(&Stage::at_once(gpu), "test", casters, "none").expect("few triangles");
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    triangles.record(&mut Recorder::new(&mut encoder, None), "test triangles");
    gpu.queue.submit([encoder.finish()]);
    let mut words: Vec<u32> = read_storage(gpu, triangles.buffer());
    words.truncate(12 * triangles.count() as usize);
    let corner = |w: &[u32]| Vec3::new(f32::from_bits(w[0]), f32::from_bits(w[1]), f32::from_bits(w[2]));
    Gathered {
        corners: words.chunks(12).map(|t| [corner(&t[0..]), corner(&t[4..]), corner(&t[8..])]).collect(),
        neighbours: words.chunks(12).map(|t| [t[3], t[7], t[11]]).collect(),
    }
}

/// Asserts that each neighbour shares the edge across which it is stored, and has this triangle as its own neighbour.
fn assert_mutual(all: &Gathered) {
    for (i, (corners, neighbours)) in all.corners.iter().zip(&all.neighbours).enumerate() {
        for (k, neighbour) in neighbours.iter().enumerate().filter(|(_, n)| **n != NO_NEIGHBOUR) {
            let other = *neighbour as usize;
            for end in [corners[(k + 1) % 3], corners[(k + 2) % 3]] {
                assert!(all.corners[other].contains(&end), "{i} and {other} do not share edge {k}");
            }
            assert!(all.neighbours[other].contains(&(i as u32)), "{other} does not know of {i}");
        }
    }
}

#[test]
fn a_grid_is_one_surface_with_an_edge() {
    let Some(gpu) = gpu() else { return };
    // 40 × 30 cells without shared vertices: edges are matched by position.
    let (across, along) = (40u32, 30u32);
    let mut positions = Vec::new();
    for (x, z) in (0..across).flat_map(|x| (0..along).map(move |z| (x, z))) {
        let at = |dx: u32, dz: u32| Vec3::new((x + dx) as f32 * 0.1, 0.3, (z + dz) as f32 * 0.1);
        positions.extend([at(0, 0), at(0, 1), at(1, 1), at(0, 0), at(1, 1), at(1, 0)]);
    }
    let indices: Vec<u32> = (0..positions.len() as u32).collect();
    let grid = Mesh::new(gpu, &positions, &indices);
    let apart = Mesh::horizontal(gpu, Vec2::splat(-9.0), Vec2::splat(-8.0), 0.0);
    let all = gathered(gpu, &[apart.caster(), grid.caster()]);
    assert_eq!(all.corners.len() as u32, 2 + 2 * across * along);
    assert_eq!(all.corners[2], positions[..3]);
    assert_mutual(&all);
    let without = |range: std::ops::Range<usize>| {
        all.neighbours[range].iter().flatten().filter(|n| **n == NO_NEIGHBOUR).count() as u32
    };
    assert_eq!(without(2..all.neighbours.len()), 2 * (across + along), "the grid's outline");
    assert_eq!(without(0..2), 4, "the square's");
}

#[test]
fn back_to_back_triangles_are_no_neighbours() {
    let Some(gpu) = gpu() else { return };
    // Two triangles, and the same two seen from behind.
    let positions = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let sheet = Mesh::new(gpu, &positions, &[0, 1, 2, 0, 2, 3, 2, 1, 0, 3, 2, 0]);
    let all = gathered(gpu, &[sheet.caster()]);
    assert_mutual(&all);
    // Across the diagonal, each neighbour is the other triangle of the same side.
    for (triangle, other) in [(0, 1), (1, 0), (2, 3), (3, 2)] {
        let known: Vec<u32> = all.neighbours[triangle].iter().copied().filter(|n| *n != NO_NEIGHBOUR).collect();
        assert_eq!(known, [other], "triangle {triangle}");
    }
}

#[test]
fn more_triangles_than_a_buffer_holds_are_told() {
    let Some(gpu) = gpu() else { return };
    let mesh = Mesh::horizontal(gpu, Vec2::ZERO, Vec2::ONE, 0.0);
    let many = MeshCaster { instance_count: u32::MAX / 4, ..mesh.caster() };
    let error =
        CasterTriangles::new(gpu).prepare(&Stage::at_once(gpu), "test", &[many], "do without").unwrap_err().to_string();
    assert!(error.contains("48 bytes for each of") && error.contains("do without"), "{error}");
    assert!(!error.contains('\n'), "{error}");
}
