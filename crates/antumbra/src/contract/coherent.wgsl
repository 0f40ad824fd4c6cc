// Sintorn, Eisemann, Assarsson 2008, section 4.3: by the bent normals where they are dark, by the smooth one where the
// surface faces the light well; their c is 3.
fn coherent_cosine(smooth_cosine: f32, bent_cosine: f32) -> f32 {
    let alpha = clamp(3.0 * bent_cosine, 0.0, 1.0);
    return max(mix(bent_cosine, smooth_cosine, alpha), 0.0);
}
