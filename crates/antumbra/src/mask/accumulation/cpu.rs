//! CPU reference of `fingerprint.wesl`.

use antumbra_light::hash_u32;

/// Returns the sum of hashes of words and their positions.
pub(super) fn fingerprint(words: &[u32]) -> u32 {
    (0..).zip(words).map(|(i, word)| hash_u32(word ^ hash_u32(i))).fold(0, u32::wrapping_add)
}
