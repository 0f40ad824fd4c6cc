use crate::contract::{MapSize, params};

params! {
    /// Parameters of [`Hard`](super::Hard).
    pub struct HardParams {
        shared map_size, more "Finer edges; memory and fill cost grow with the square of the size.";
        shared bias_scale;
    }
    Fast { map_size: MapSize::Texels(512), }
    High { map_size: MapSize::Texels(2048), }
    Best { map_size: MapSize::Texels(4096), }
}
