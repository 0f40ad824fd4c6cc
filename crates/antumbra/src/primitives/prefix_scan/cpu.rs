//! CPU reference.

/// Exclusive prefix sums, and the total; both wrap as `u32` does.
pub(super) fn scan(items: &[u32]) -> (Vec<u32>, u32) {
    let mut total = 0_u32;
    let mut sums = Vec::with_capacity(items.len());
    for item in items {
        sums.push(total);
        total = total.wrapping_add(*item);
    }
    (sums, total)
}
