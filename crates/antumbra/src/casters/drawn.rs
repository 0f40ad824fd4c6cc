//! Casters of a set as frames see them, and the cache key that changes with them.

use std::hash::{DefaultHasher, Hash, Hasher};

use super::surface::opacity_of;
use super::{Ball, CasterEntry, CasterId, CasterSet, bad};
use crate::contract::{CastersKey, Error, MaskChannels, MeshCaster};

impl CasterSet {
    fn is_updated(&self) -> bool {
        self.updated == Some(self.version)
    }

    /// Refuses a set with changes since its last update.
    pub(crate) fn check_updated(&self) -> Result<(), Error> {
        if self.is_updated() {
            return Ok(());
        }
        Err(bad(
            "the set of casters",
            "changed since its last `CasterSet::update`".into(),
            "up to date: call `CasterSet::update` before preparing lights".into(),
        ))
    }

    /// Casters of some layers, in drawing order; with a ball, only those that reach into it.
    fn entries(&self, layers: u32, within: Option<Ball>) -> impl Iterator<Item = (CasterId, &CasterEntry)> {
        let all = self.order.iter().filter_map(|id| Some((*id, self.casters.get(*id)?)));
        all.filter(move |(_, caster)| {
            caster.layers & layers != 0 && within.is_none_or(|ball| ball.touches(&caster.bounds))
        })
    }

    /// Casters of some layers as techniques receive them; with a ball, only those that reach into it.
    pub(crate) fn meshes(&self, layers: u32, within: Option<Ball>) -> Result<Vec<MeshCaster<'_>>, Error> {
        self.check_updated()?;
        let Some(((indices, instances), plain)) =
            self.indices.buffer().zip(self.instances.buffer()).zip(self.vertices[0].buffer())
        else {
            return Ok(Vec::new());
        };
        Ok(self
            .entries(layers, within)
            .map(|(_, caster)| {
                let mesh = &self.meshes[caster.mesh];
                let arena = &self.vertices[usize::from(mesh.source.has_uvs())];
                MeshCaster {
                    positions: arena.buffer().unwrap_or(plain),
                    indices,
                    first_triangle: mesh.indices.start,
                    index_count: mesh.source.index_count(),
                    instances,
                    first_instance: caster.places.start,
                    instance_count: caster.places.end - caster.places.start,
                    closed: mesh.closed && !caster.is_mirrored,
                    opacity: opacity_of(&caster.surface, arena.column(1)),
                    bounds: caster.bounds,
                    version: Some(mesh.version),
                }
            })
            .collect())
    }

    /// Cache key of the casters of some layers. With a ball, it depends only on the casters that reach into it.
    pub(crate) fn key(&self, layers: u32, within: Option<Ball>) -> CastersKey {
        // Before an update, `order` may not match the casters.
        let version = match within.filter(|_| self.is_updated()) {
            Some(_) => self.version_of(layers, within),
            None => self.version,
        };
        CastersKey::new(self.number, version, layers)
    }

    /// Hash of the selected casters and their versions.
    fn version_of(&self, layers: u32, within: Option<Ball>) -> u64 {
        let mut hasher = DefaultHasher::new();
        for (id, caster) in self.entries(layers, within) {
            (id, caster.version, self.meshes[caster.mesh].version).hash(&mut hasher);
        }
        hasher.finish()
    }

    /// Number of mask channels that casters in these layers need: three if any tints, otherwise one.
    pub fn mask_channels(&self, layers: u32) -> MaskChannels {
        if self.casters.values().any(|caster| caster.layers & layers != 0 && caster.surface.tints()) {
            MaskChannels::Three
        } else {
            MaskChannels::One
        }
    }
}
