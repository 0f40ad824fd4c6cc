use crate::contract::params;

params! {
    /// Parameters of [`Hard`](super::Hard).
    pub struct HardParams {
        shared map_size, more "Finer edges; memory and fill grow with the square.";
        shared bias_scale;
    }
    Fast { map_size: 512, }
    High { map_size: 2048, }
    Best { map_size: 4096, }
}
