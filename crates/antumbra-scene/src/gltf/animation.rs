//! Animations sampled at one time.
//!
//! Source: glTF 2.0, section 3.11 and appendix C (interpolation). Times outside a clip clamp to its ends.

use glam::{Quat, Vec3};
use gltf::json::animation::{Channel, Interpolation, Property, Sampler};
use gltf::json::validation::Checked;

use super::accessors::Allowed;
use super::fault::{Fault, Result};
use super::numbers::unit_quaternion;
use super::source::Source;

/// Animated values of a node, which replace its resting values.
#[derive(Clone, Debug, Default)]
pub(super) struct Driven {
    pub translation: Option<Vec3>,
    pub rotation: Option<Quat>,
    pub scale: Option<Vec3>,
    pub weights: Option<Vec<f32>>,
}

impl Driven {
    /// Whether the node's transform is animated.
    pub(super) fn moves(&self) -> bool {
        self.translation.is_some() || self.rotation.is_some() || self.scale.is_some()
    }
}

/// Animations sampled at one time.
pub(super) struct Sampled {
    /// Animated values of all nodes, by node index.
    pub driven: Vec<Driven>,
    /// First and last time of all channels in use, seconds; `None` if nothing is animated.
    pub ends_s: Option<[f32; 2]>,
}

/// Samples the animations of all nodes at `time_s`.
///
/// A file with several clips gives no order of play. The first clip plays, and later ones drive the properties that no
/// earlier clip drives. Files with one clip per object thus play whole; of a character's walk, run and jump, the first
/// plays.
pub(super) fn sample(source: &Source, time_s: f32) -> Result<Sampled> {
    let mut driven = vec![Driven::default(); source.root.nodes.len()];
    let mut ends: Option<[f32; 2]> = None;
    for (clip, animation) in source.root.animations.iter().enumerate() {
        for (k, channel) in animation.channels.iter().enumerate() {
            let place = format!("animations[{clip}].channels[{k}]");
            let node = channel.target.node.value();
            let Some(slot) = driven.get_mut(node) else {
                return Err(Fault::unresolved(place, "nodes", node, source.root.nodes.len()));
            };
            let Some(sampler) = animation.samplers.get(channel.sampler.value()) else {
                let list = "samplers";
                return Err(Fault::unresolved(place, list, channel.sampler.value(), animation.samplers.len()));
            };
            // Nodes and samplers that do not exist make the file invalid; unreadable values only cost the channel.
            if let Err(fault) = drive(source, slot, channel, sampler, time_s, &mut ends, &place) {
                source.warn(fault.as_warning("the channel is ignored"));
            }
        }
    }
    if let Some(line) = beyond(time_s, ends) {
        source.warn(line);
    }
    Ok(Sampled { driven, ends_s: ends })
}

/// Message about a time outside the clips; `None` for a time inside, or for the default time.
fn beyond(time_s: f32, ends: Option<[f32; 2]>) -> Option<String> {
    let taken = |why: String| Some(format!("--time {time_s}: {why}"));
    match ends {
        _ if time_s == 0.0 => None,
        None => taken("nothing in the scene is animated, so the time is ignored".into()),
        Some([first, last]) if time_s < first || time_s > last => {
            taken(format!("the animations run from {first} s to {last} s; {} s is used", time_s.clamp(first, last)))
        }
        Some(_) => None,
    }
}

/// Samples one channel into `slot` unless an earlier clip drives the property. `ends` is extended by the channel's first and last time.
fn drive(
    source: &Source,
    slot: &mut Driven,
    channel: &Channel,
    sampler: &Sampler,
    time_s: f32,
    ends: &mut Option<[f32; 2]>,
    place: &str,
) -> Result<()> {
    let Checked::Valid(property) = channel.target.path else {
        source.warn(format!("{place}: its target path is unknown; it is ignored"));
        return Ok(());
    };
    let taken = match property {
        Property::Translation => slot.translation.is_some(),
        Property::Rotation => slot.rotation.is_some(),
        Property::Scale => slot.scale.is_some(),
        Property::MorphTargetWeights => slot.weights.is_some(),
    };
    if taken {
        return Ok(());
    }
    let Some(moment) = Moment::find(source, sampler, time_s, place)? else { return Ok(()) };
    let [first, last] = moment.ends_s;
    *ends = Some(ends.map_or([first, last], |[a, b]| [a.min(first), b.max(last)]));
    let output = sampler.output.value();
    match property {
        Property::Translation | Property::Scale => {
            let keys = source.read_floats::<3>(output, Allowed::SignedFractions, place)?;
            let value = moment.value(&keys, 1, place)?.first().map(|v| Vec3::from_array(*v)).filter(|v| v.is_finite());
            match property {
                Property::Translation => slot.translation = value,
                _ => slot.scale = value,
            }
        }
        Property::Rotation => {
            let keys = source.read_floats::<4>(output, Allowed::SignedFractions, place)?;
            slot.rotation = moment.rotation(&keys, place)?;
            if slot.rotation.is_none() {
                source.warn(format!("{place}: a rotation is a quaternion of zero length; the rest pose is kept"));
            }
        }
        Property::MorphTargetWeights => {
            let keys = source.read_floats::<1>(output, Allowed::SignedFractions, place)?;
            let width = keys.len() / (moment.key_count * moment.elements_per_key()).max(1);
            slot.weights = Some(moment.value(&keys, width, place)?.into_iter().map(|[w]| w).collect());
        }
    }
    Ok(())
}

/// Time between two keys of a sampler.
struct Moment {
    key_count: usize,
    before: usize,
    after: usize,
    /// 0 at `before`, 1 at `after`.
    t: f32,
    /// Seconds from `before` to `after`.
    span_s: f32,
    /// Times of the first and last key, seconds.
    ends_s: [f32; 2],
    interpolation: Interpolation,
}

impl Moment {
    /// Finds the keys around a time; `None`, with a warning, if the sampler's times are unusable.
    fn find(source: &Source, sampler: &Sampler, time_s: f32, place: &str) -> Result<Option<Self>> {
        let times: Vec<f32> =
            source.read_floats::<1>(sampler.input.value(), Allowed::Floats, place)?.into_iter().map(|[t]| t).collect();
        if times.is_empty() || !times.iter().all(|t| t.is_finite()) || times.windows(2).any(|w| w[0] > w[1]) {
            source.warn(format!("{place}: its times are not finite and ascending; it is ignored"));
            return Ok(None);
        }
        let interpolation = match sampler.interpolation {
            Checked::Valid(interpolation) => interpolation,
            Checked::Invalid => {
                source.warn(format!("{place}: its interpolation is unknown; LINEAR is used"));
                Interpolation::Linear
            }
        };
        let later = times.partition_point(|t| *t <= time_s);
        let (before, after) = (later.saturating_sub(1), later.min(times.len() - 1));
        let span_s = times[after] - times[before];
        let t = if span_s > 0.0 { ((time_s - times[before]) / span_s).clamp(0.0, 1.0) } else { 0.0 };
        let ends_s = [times[0], times[times.len() - 1]];
        Ok(Some(Self { key_count: times.len(), before, after, t, span_s, ends_s, interpolation }))
    }

    /// Number of elements per key: a cubic key holds an in-tangent, a value and an out-tangent.
    fn elements_per_key(&self) -> usize {
        if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 }
    }

    /// Interpolated value, of `width` elements.
    fn value<const N: usize>(&self, keys: &[[f32; N]], width: usize, place: &str) -> Result<Vec<[f32; N]>> {
        if keys.len() != self.key_count * self.elements_per_key() * width {
            return Err(Fault::new(
                place,
                format!("{} values for {} times", keys.len(), self.key_count),
                "LINEAR and STEP have one value per time, CUBICSPLINE three",
            ));
        }
        let part = |key: usize, part: usize, k: usize| keys[(key * self.elements_per_key() + part) * width + k];
        let mix = |a: [f32; N], b: [f32; N], f: &dyn Fn(f32, f32) -> f32| std::array::from_fn(|c| f(a[c], b[c]));
        let t = self.t;
        Ok((0..width)
            .map(|k| match self.interpolation {
                Interpolation::Step => part(self.before, 0, k),
                Interpolation::Linear => mix(part(self.before, 0, k), part(self.after, 0, k), &|a, b| a + (b - a) * t),
                // Appendix C.4: the cubic Hermite spline; tangents are per second.
                Interpolation::CubicSpline => {
                    let (t2, t3) = (t * t, t * t * t);
                    let values = mix(part(self.before, 1, k), part(self.after, 1, k), &|a, b| {
                        (2.0 * t3 - 3.0 * t2 + 1.0) * a + (3.0 * t2 - 2.0 * t3) * b
                    });
                    let tangents = mix(part(self.before, 2, k), part(self.after, 0, k), &|a, b| {
                        self.span_s * ((t3 - 2.0 * t2 + t) * a + (t3 - t2) * b)
                    });
                    mix(values, tangents, &|a, b| a + b)
                }
            })
            .collect())
    }

    /// Interpolated rotation, at a constant rate along the shorter arc (appendix C.3); `None` if a key has no direction.
    fn rotation(&self, keys: &[[f32; 4]], place: &str) -> Result<Option<Quat>> {
        let mixed = self.value(keys, 1, place)?;
        if self.interpolation != Interpolation::Linear {
            return Ok(mixed.first().and_then(|q| unit_quaternion(Quat::from_array(*q))));
        }
        let unit = |key: usize| unit_quaternion(Quat::from_array(keys[key]));
        Ok(match (unit(self.before), unit(self.after)) {
            (Some(a), Some(b)) => unit_quaternion(a.slerp(b, self.t)),
            _ => None,
        })
    }
}
