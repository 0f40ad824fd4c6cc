//! Test whether a triangle mesh is closed.

use glam::Vec3;

/// Whether every edge is shared by exactly two triangles that wind consistently. Vertices at equal positions count as one.
///
/// `indices` has three indices per triangle, each below `positions.len()`. Triangles with fewer than three distinct
/// positions are ignored. A mesh without triangles is not closed. O(n log n).
pub(crate) fn is_closed(positions: &[Vec3], indices: &[u32]) -> bool {
    let place = places(positions);
    let mut edges: Vec<(u32, u32)> = Vec::with_capacity(indices.len());
    for triangle in indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|k| place[triangle[k] as usize]);
        if a != b && b != c && c != a {
            edges.extend([(a, b), (b, c), (c, a)]);
        }
    }
    edges.sort_unstable();
    // Every directed edge occurs once, and its reverse occurs.
    !edges.is_empty()
        && edges.windows(2).all(|pair| pair[0] != pair[1])
        && edges.iter().all(|&(a, b)| edges.binary_search(&(b, a)).is_ok())
}

/// Position index of each vertex: two vertices have the same index exactly if their positions are equal.
fn places(positions: &[Vec3]) -> Vec<u32> {
    // Adding zero turns −0 into 0, so that equal numbers have equal bits.
    let key = |i: u32| (positions[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&i| key(i));
    let mut place = vec![0; positions.len()];
    let mut count = 0;
    for (k, &i) in order.iter().enumerate() {
        if k > 0 && key(order[k - 1]) != key(i) {
            count += 1;
        }
        place[i as usize] = count;
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tetrahedron_is_closed_until_it_is_harmed() {
        let p = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let solid = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3];
        assert!(is_closed(&p, &solid));
        // Unshared vertices are joined by position, −0 and 0 alike.
        let apart: Vec<Vec3> = solid.iter().map(|&i| p[i as usize] * Vec3::new(1.0, 1.0, -1.0)).collect();
        let indices: Vec<u32> = (0..12).collect();
        assert!(is_closed(&apart, &indices));
        // A hole, a doubled face, a face wound the other way, nothing at all.
        assert!(!is_closed(&p, &solid[..9]));
        assert!(!is_closed(&p, &[&solid[..], &[0, 2, 1]].concat()));
        assert!(!is_closed(&p, &[0, 1, 2, 0, 1, 3, 1, 2, 3, 2, 0, 3]));
        assert!(!is_closed(&p, &[]));
        // A triangle without area has only two distinct positions.
        assert!(is_closed(&p, &[&solid[..], &[0, 0, 1]].concat()));
    }
}
