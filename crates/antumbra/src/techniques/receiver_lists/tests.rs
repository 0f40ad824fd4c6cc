//! Batches of triangles; the rest is tested through the techniques.

use super::batches::batches_of;

#[test]
fn no_casters_make_one_empty_batch() {
    let batches = batches_of(&[], 100);
    assert_eq!(batches.len(), 1);
    assert_eq!(batches[0].triangles(), 0);
}
