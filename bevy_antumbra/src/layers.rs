//! Render layers as bits.

use bevy::camera::visibility::RenderLayers;

/// Bit of all layers from 31 on.
const LAST: usize = 31;

/// Returns the layers as bits: one for each of the first 31 layers; all others share the last bit.
pub fn layer_bits(layers: &RenderLayers) -> u32 {
    layers.iter().fold(0, |bits, layer| bits | 1 << layer.min(LAST))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_beyond_share_a_bit() {
        assert_eq!(layer_bits(&RenderLayers::default()), 1);
        assert_eq!(layer_bits(&RenderLayers::from_layers(&[0, 3])), 9);
        assert_eq!(layer_bits(&RenderLayers::from_layers(&[40, 70])), 1 << 31);
        assert_eq!(layer_bits(&RenderLayers::none()), 0);
    }
}
